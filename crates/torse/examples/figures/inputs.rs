//! Measured things for the gallery, made up.
//!
//! `scan.csv` holds points of a bent sheet with a fold and a hole, scattered as scanners do.
//! `loop.csv` holds a closed curve that rises and falls three times. All in mm.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;
use torse::geom::{Vec2, Vec3};

/// Writes them into a folder.
pub fn draw(folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::write(folder.join("scan.csv"), table(&scan())?)?;
    let ring = (0..=96).map(|k| TAU * f64::from(k % 96) / 96.0);
    let ring: Vec<Vec3> = ring.map(|t| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 35.0 * (3.0 * t).cos())).collect();
    std::fs::write(folder.join("loop.csv"), table(&ring)?)?;
    Ok(())
}

fn table(points: &[Vec3]) -> Result<String, std::fmt::Error> {
    let mut text = String::from("x,y,z\n");
    for p in points {
        writeln!(text, "{:.6},{:.6},{:.6}", p.x, p.y, p.z)?;
    }
    Ok(text)
}

/// Points of the sheet: a piece of a cone, and beyond its last ruling a plane wing that rises from it.
fn scan() -> Vec<Vec3> {
    /// Distances from the apex between which the sheet lies.
    const REACH: [f64; 2] = [500.0, 900.0];
    /// Turn of the flat sheet about the apex up to the fold, and of all.
    const FOLD: f64 = 0.75;
    const WHOLE: f64 = 1.15;
    /// The cone's rulings against its axis.
    const OPENING: f64 = 0.5;
    /// Angle of the fold.
    const WING: f64 = 0.7;
    const SCATTER: f64 = 0.1;
    let (sin, cos) = OPENING.sin_cos();
    let ruling = |turn: f64| {
        let (s, c) = (turn / sin).sin_cos();
        Vec3::new(sin * c, sin * s, -cos)
    };
    let edge = ruling(FOLD);
    let along = (ruling(FOLD + 1e-6) - edge).normalize();
    let up = edge.cross(&along);
    let side = along * WING.cos() - up * WING.sin();
    let mut random = Random(20_240_607);
    let mut points = Vec::new();
    const ROWS: u32 = 50;
    const COLUMNS: u32 = 88;
    for i in 0..COLUMNS {
        for j in 0..ROWS {
            let turn = WHOLE * (f64::from(i) + random.share()) / f64::from(COLUMNS);
            let far = REACH[0] + (REACH[1] - REACH[0]) * (f64::from(j) + random.share()) / f64::from(ROWS);
            let flat = Vec2::new(turn.cos(), turn.sin()) * far;
            if (flat - Vec2::new(0.35_f64.cos(), 0.35_f64.sin()) * 690.0).norm() < 75.0 {
                continue;
            }
            let direction =
                if turn < FOLD { ruling(turn) } else { edge * (turn - FOLD).cos() + side * (turn - FOLD).sin() };
            let off = SCATTER * (2.0 * random.share() - 1.0);
            let bent =
                if turn < FOLD { ruling(turn).cross(&(ruling(turn + 1e-6) - ruling(turn))) } else { edge.cross(&side) };
            points.push(direction * far + bent.normalize() * off);
        }
    }
    points
}

/// The same numbers between 0 and 1 on every machine (a linear congruence).
struct Random(u64);

impl Random {
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}
