//! Writes a facade of many singly curved panels of 1.5 m by 3 m, for measuring how long they take to unroll:
//! `cargo run --release --example facade -- 11000 facade.step`.
//!
//! No two panels are the same: circular cylinders, cut from cones, and general cylinders, each with a curvature of its own,
//! stand in rows of 100. Lengths in mm.

use std::error::Error;

use torse::geom::Vec3;
use torse::io::step::write::{self, Header, Shell};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;

/// Width and height of a panel, mm.
const SIZE: [f64; 2] = [1500.0, 3000.0];
/// Panels in a row.
const ROW: usize = 100;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(count), Some(path)) = (arguments.next(), arguments.next()) else {
        return Err(
            "say how many panels and name a file: cargo run --release --example facade -- 11000 facade.step".into()
        );
    };
    let count: usize = count.parse()?;
    let sheets: Vec<Shell> = (0..count)
        .map(|k| panel(k, count).map(|s| Shell::untrimmed(&format!("P-{:05}", k + 1), &s)))
        .collect::<Result<_, _>>()?;
    let header = Header { name: "facade".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-4 };
    std::fs::write(path, write::shells(&header, &sheets)?)?;
    Ok(())
}

/// A panel of its own: its rail is an arc, or a cubic, and its other rail the same at another size.
fn panel(k: usize, count: usize) -> Result<Surface, Box<dyn Error>> {
    let share = k as f64 / count.max(2) as f64;
    let corner = Vec3::new((k % ROW) as f64, 0.0, (k / ROW) as f64).component_mul(&Vec3::new(1700.0, 0.0, 3200.0));
    let radius = 1500.0 + 6000.0 * share;
    // Half of the angle over which the width is an arc.
    let half = 0.5 * SIZE[0] / radius;
    let arc = |r: f64, z: f64| {
        let (s, c) = half.sin_cos();
        [(-r * s, r * c), (0.0, r / c), (r * s, r * c)].map(|(x, y)| corner + Vec3::new(x, y - radius, z))
    };
    let up = Knots::clamped(1, &[0.0, 1.0])?;
    if k % 3 == 2 {
        let at = |x: f64, y: f64| [Vec3::new(x, y, 0.0), Vec3::new(x, y, SIZE[1])].map(|p| corner + p);
        let bulge = 20.0 + 120.0 * share;
        let rail = [at(0.0, 0.0), at(500.0, bulge), at(1000.0, 1.5 * bulge), at(SIZE[0], 0.0)];
        return Ok(Surface::new(Knots::clamped(3, &[0.0, 1.0])?, up, &rail.concat(), None)?);
    }
    // A circular cylinder, or a cone that grows narrower upwards.
    let top = if k.is_multiple_of(3) { radius } else { 0.8 * radius };
    let (low, high) = (arc(radius, 0.0), arc(top, SIZE[1]));
    let points: Vec<Vec3> = low.iter().zip(&high).flat_map(|(a, b)| [*a, *b]).collect();
    let weights = [1.0, 1.0, half.cos(), half.cos(), 1.0, 1.0];
    Ok(Surface::new(Knots::clamped(2, &[0.0, 1.0])?, up, &points, Some(&weights))?)
}
