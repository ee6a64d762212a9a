//! Writes the project's own STEP models: `cargo run --release --example models -- data`.
//!
//! Freeform shapes are smooth functions, interpolated by splines at the Greville points and rounded to 0.1 µm, so
//! that the files are small and come out the same on every machine. Lengths in mm.

mod bracket;
mod branch;
mod trough;

use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use nalgebra::DMatrix;
use torse::geom::{Frame, Vec3};
use torse::io::step::write::{
    self, EdgeUse, Header, Shell, ShellCurve, ShellEdge, ShellFace, ShellSurface, SurfaceForm,
};
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let Some(folder) = std::env::args().nth(1) else {
        return Err("name the folder to write to: cargo run --release --example models -- data".into());
    };
    for (name, sheet) in models()? {
        let header = Header { name: name.into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-4 };
        let text = write::shells(&header, &[sheet])?;
        fs::write(Path::new(&folder).join(format!("{name}.step")), text)?;
    }
    Ok(())
}

/// All models with their names.
fn models() -> Outcome<Vec<(&'static str, Shell)>> {
    let spline = |name, s: Surface| (name, Shell::untrimmed(name, &s));
    Ok(vec![
        spline("hull", freeform(3, [6, 4], hull)?),
        spline("half_bowl", freeform(3, [6, 4], half_bowl)?),
        spline("fuselage", freeform(2, [8, 6], fuselage)?),
        spline("wavy_roof", freeform(3, [9, 6], wavy_roof)?),
        spline("saddle", freeform(3, [4, 4], saddle)?),
        spline("torus_piece", torus_piece()?),
        ("dished_end", dished_end()?),
        ("cone_holes", cone_holes()?),
        ("cylinder_holes", cylinder_holes()?),
        ("bracket", bracket::bracket()?),
        ("branch", branch::branch()?),
        ("trough", trough::trough()?),
    ])
}

/// One side of a round-bilge boat, 6 m long: u from transom to stem, v from keel to sheer; x forward, y out, z up.
fn hull(u: f64, v: f64) -> Vec3 {
    let beam = bernstein(&[720., 930., 1120., 1120., 620., 20.], u);
    let sheer = bernstein(&[780., 700., 660., 700., 840., 1000.], u);
    let keel = bernstein(&[-60., -260., -370., -420., -430., -400.], u);
    // Sections between a quarter ellipse (the bilge) and a straight V that takes over towards the bow.
    let vee = 0.22 + 0.74 * u.powi(3);
    let (sin, cos) = (0.5 * PI * v).sin_cos();
    let rake = 700.0 * u.powi(4) * (1.0 - v);
    Vec3::new(
        6000.0 * u - rake,
        beam * ((1.0 - vee) * sin + vee * v),
        keel + (sheer - keel) * ((1.0 - vee) * (1.0 - cos) + vee * v),
    )
}

/// Half a fruit bowl in a cube of 1 m: oval, with a lip that turns outwards; u around, v from foot to rim.
fn half_bowl(u: f64, v: f64) -> Vec3 {
    let r = bernstein(&[0.24, 0.60, 0.86, 0.95, 0.95, 1.0], v);
    let z = bernstein(&[0.0, 0.0, 0.22, 0.56, 0.84, 1.0], v);
    let (sin, cos) = (PI * u).sin_cos();
    Vec3::new(500.0 - 500.0 * r * cos, 1000.0 * r * sin, 1000.0 * z)
}

/// Upper half of a fuselage, 4 m long; u from nose to tail, v from side to side.
fn fuselage(u: f64, v: f64) -> Vec3 {
    let r = bernstein(&[170., 440., 560., 520., 330., 130.], u);
    let rise = bernstein(&[-60., 0., 20., 40., 160., 220.], u);
    let (sin, cos) = (PI * v).sin_cos();
    Vec3::new(4000.0 * u, r * cos, rise + 1.1 * r * sin)
}

/// A roof of 6 m by 4 m with hills, valleys and saddles.
fn wavy_roof(u: f64, v: f64) -> Vec3 {
    let wave = 180.0 * (2.0 * PI * u).sin() * (1.2 * PI * v + 0.5).cos() + 120.0 * (PI * (u + 0.5 * v)).sin();
    Vec3::new(6000.0 * u, 4000.0 * v, 2500.0 + wave)
}

/// A roof of 6 m by 4 m that is a saddle all over, but no ruled surface.
fn saddle(u: f64, v: f64) -> Vec3 {
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let rise = 700.0 * x.powi(2) + 150.0 * x.powi(4) - 550.0 * y.powi(2) - 90.0 * y.powi(4);
    Vec3::new(3000.0 * x, 2000.0 * y, 3000.0 + rise)
}

/// Outer piece of a torus, 90° by 90°, radii 600 mm and 250 mm: exact, rational.
fn torus_piece() -> Outcome<Surface> {
    let half = 0.5f64.sqrt();
    let knots = Knots::clamped(2, &[0.0, 1.0])?;
    // Meridian from −45° to 45°: the middle control point lies where the end tangents meet.
    let meridian =
        [(600.0 + 250.0 * half, -250.0 * half), (600.0 + 250.0 / half, 0.0), (600.0 + 250.0 * half, 250.0 * half)];
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for (cos, sin, w) in [(1.0, 0.0, 1.0), (1.0, 1.0, half), (0.0, 1.0, 1.0)] {
        for (j, (r, z)) in meridian.iter().enumerate() {
            points.push(Vec3::new(r * cos, r * sin, *z));
            weights.push(w * if j == 1 { half } else { 1.0 });
        }
    }
    Ok(Surface::new(knots.clone(), knots, &points, Some(&weights))?)
}

/// The end of a vessel 1 m wide: half an ellipsoid, half as deep as its radius; one face with a pole, exact, rational.
fn dished_end() -> Outcome<Shell> {
    let (radius, depth, half) = (500.0, 250.0, 0.5f64.sqrt());
    // Quarters of circles between their ends: the middle control point lies where the end tangents meet.
    let quarters =
        [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0), (-1.0, 0.0), (-1.0, -1.0), (0.0, -1.0), (1.0, -1.0)];
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for k in 0..=8 {
        let (cos, sin) = quarters[k % 8];
        for (j, (r, z)) in [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().enumerate() {
            points.push(Vec3::new(radius * r * cos, radius * r * sin, depth * z));
            weights.push(if k % 2 == 1 { half } else { 1.0 } * if j == 1 { half } else { 1.0 });
        }
    }
    let around = [0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0];
    let around = Knots::new(2, around.to_vec(), 9)?;
    let surface = Surface::new(around, Knots::clamped(2, &[0.0, 1.0])?, &points, Some(&weights))?;
    let meridian = Curve { knots: surface.knots_v.clone(), control: surface.control[..3].to_vec() };
    let mut sheet = Shell { name: "dished_end".into(), ..Shell::default() };
    sheet.vertices = vec![Vec3::new(radius, 0.0, 0.0), Vec3::new(0.0, 0.0, depth)];
    sheet.edges = vec![
        ShellEdge { start: 0, end: 0, curve: ShellCurve::Circle { frame: Frame::world(), radius } },
        ShellEdge { start: 0, end: 1, curve: ShellCurve::Rational(meridian) },
    ];
    let loops = vec![uses(&[(0, true), (1, true), (1, false)])];
    let surface = ShellSurface::Spline { surface, form: SurfaceForm::Unspecified };
    sheet.faces.push(ShellFace { name: "dished end".into(), surface, reversed: false, loops });
    Ok(sheet)
}

/// A hopper: 200° of a cone between a circle and an oblique plane, with two holes.
fn cone_holes() -> Outcome<Shell> {
    let (radius, half_angle) = (300.0, 20.0f64.to_radians());
    let slope = half_angle.tan();
    let radius_at = |z: f64| radius + z * slope;
    let point = |phi: f64, z: f64| Vec3::new(radius_at(z) * phi.cos(), radius_at(z) * phi.sin(), z);
    // Plane z = 600 + 0.3 x.
    let top = |phi: f64| (600.0 + 0.3 * radius * phi.cos()) / (1.0 - 0.3 * slope * phi.cos());
    let (a, b) = (-100.0f64.to_radians(), 100.0f64.to_radians());
    let mut sheet = Shell { name: "cone_holes".into(), ..Shell::default() };
    sheet.vertices = [point(a, 0.0), point(b, 0.0), point(b, top(b)), point(a, top(a))].into();
    let arc = ShellCurve::Circle { frame: Frame::world(), radius };
    let rim = spline(40, |s| {
        let phi = a + (b - a) * s;
        point(phi, top(phi))
    })?;
    sheet.edges = vec![
        ShellEdge { start: 0, end: 1, curve: arc },
        ShellEdge { start: 1, end: 2, curve: ShellCurve::Line },
        ShellEdge { start: 3, end: 2, curve: ShellCurve::Spline(rim) },
        ShellEdge { start: 0, end: 3, curve: ShellCurve::Line },
    ];
    let mut loops = vec![uses(&[(0, true), (1, true), (2, false), (3, false)])];
    loops.push(hole(&mut sheet, &radius_at, 40.0, 330.0, [90.0, 90.0], 1)?);
    loops.push(hole(&mut sheet, &radius_at, -45.0, 300.0, [120.0, 60.0], 2)?);
    let surface = ShellSurface::Cone { frame: Frame::world(), radius, half_angle };
    sheet.faces.push(ShellFace { name: "hopper".into(), surface, reversed: false, loops });
    Ok(sheet)
}

/// A pipe, closed on itself, with a round and an oval hole.
fn cylinder_holes() -> Outcome<Shell> {
    let (radius, height) = (250.0, 800.0);
    let mut sheet = Shell { name: "cylinder_holes".into(), ..Shell::default() };
    sheet.vertices = vec![Vec3::new(radius, 0.0, 0.0), Vec3::new(radius, 0.0, height)];
    let circle =
        |z: f64| ShellCurve::Circle { frame: Frame { origin: Vec3::new(0.0, 0.0, z), ..Frame::world() }, radius };
    sheet.edges = vec![
        ShellEdge { start: 0, end: 0, curve: circle(0.0) },
        ShellEdge { start: 0, end: 1, curve: ShellCurve::Line },
        ShellEdge { start: 1, end: 1, curve: circle(height) },
    ];
    let mut loops = vec![uses(&[(0, true), (1, true), (2, false), (1, false)])];
    loops.push(hole(&mut sheet, &|_| radius, 90.0, 330.0, [110.0, 110.0], 1)?);
    loops.push(hole(&mut sheet, &|_| radius, 215.0, 480.0, [90.0, 160.0], 2)?);
    let surface = ShellSurface::Cylinder { frame: Frame::world(), radius };
    sheet.faces.push(ShellFace { name: "pipe".into(), surface, reversed: false, loops });
    Ok(sheet)
}

/// Cuts a surface of revolution with a horizontal elliptic pipe (half axes across and up) that meets the axis of
/// revolution at height `z` in the direction `phi_deg`: adds the cut as `parts` edges and answers the loop.
fn hole(
    sheet: &mut Shell,
    radius_at: &dyn Fn(f64) -> f64,
    phi_deg: f64,
    z: f64,
    half_axes: [f64; 2],
    parts: usize,
) -> Outcome<Vec<EdgeUse>> {
    let (sin, cos) = phi_deg.to_radians().sin_cos();
    let cut = |s: f64| {
        let (up, across) = (2.0 * PI * s).sin_cos();
        let (w, h) = (half_axes[0] * across, z + half_axes[1] * up);
        let depth = (radius_at(h).powi(2) - w * w).sqrt();
        Vec3::new(depth * cos - w * sin, depth * sin + w * cos, h)
    };
    let (vertex, edge) = (sheet.vertices.len(), sheet.edges.len());
    for k in 0..parts {
        let curve = spline(72 / parts, |s| cut((k as f64 + s) / parts as f64))?;
        sheet.vertices.push(Vec3::from(curve.control[0]));
        let (start, end) = (vertex + k, vertex + (k + 1) % parts);
        sheet.edges.push(ShellEdge { start, end, curve: ShellCurve::Spline(curve) });
    }
    // The pipe is run counter-clockwise seen from outside; a hole is run clockwise.
    Ok(uses(&(edge..edge + parts).rev().map(|e| (e, false)).collect::<Vec<_>>()))
}

fn uses(edges: &[(usize, bool)]) -> Vec<EdgeUse> {
    edges.iter().map(|&(edge, forward)| EdgeUse { edge, forward, trim: None }).collect()
}

/// Polynomial with Bernstein coefficients `c`, by de Casteljau's scheme.
fn bernstein(c: &[f64], t: f64) -> f64 {
    let mut c = c.to_vec();
    for n in (1..c.len()).rev() {
        for i in 0..n {
            c[i] += t * (c[i + 1] - c[i]);
        }
    }
    c[0]
}

/// Spline surface through the values of `f` at the Greville points, on uniform knots over the unit square.
fn freeform(degree: usize, spans: [usize; 2], f: fn(f64, f64) -> Vec3) -> Outcome<Surface> {
    let (ku, kv) = (Knots::uniform(degree, spans[0], 0.0, 1.0)?, Knots::uniform(degree, spans[1], 0.0, 1.0)?);
    let (gu, gv) = (greville(&ku), greville(&kv));
    let mut points = vec![Vec3::zeros(); gu.len() * gv.len()];
    for d in 0..3 {
        let values = DMatrix::from_fn(gu.len(), gv.len(), |i, j| f(gu[i], gv[j])[d]);
        let half = solved(&ku, &gu, values)?;
        let control = solved(&kv, &gv, half.transpose())?;
        for (n, p) in points.iter_mut().enumerate() {
            p[d] = rounded(control[(n % gv.len(), n / gv.len())]);
        }
    }
    Ok(Surface::new(ku, kv, &points, None)?)
}

/// Cubic spline through the values of `f` at the Greville points.
fn spline(spans: usize, f: impl Fn(f64) -> Vec3) -> Outcome<Curve<3>> {
    interpolated(3, spans, f, rounded)
}

/// As [`spline`], of degree 5 and rounded to 0.1 nm: where bodies meet in an edge, it lies on both.
fn smooth_spline(spans: usize, f: impl Fn(f64) -> Vec3) -> Outcome<Curve<3>> {
    interpolated(5, spans, f, |x| (x * 1e7).round() / 1e7)
}

/// Spline through the values of `f` at the Greville points, its control points rounded by `round`.
fn interpolated(degree: usize, spans: usize, f: impl Fn(f64) -> Vec3, round: fn(f64) -> f64) -> Outcome<Curve<3>> {
    let knots = Knots::uniform(degree, spans, 0.0, 1.0)?;
    let sites = greville(&knots);
    let control = solved(&knots, &sites, DMatrix::from_fn(sites.len(), 3, |i, d| f(sites[i])[d]))?;
    let control = control.row_iter().map(|r| [r[0], r[1], r[2]].map(round)).collect();
    Ok(Curve { knots, control })
}

/// Means of `degree` successive knots: the sites where interpolation is well posed.
fn greville(k: &Knots) -> Vec<f64> {
    let p = k.degree();
    (0..k.control_count()).map(|i| k.values()[i + 1..=i + p].iter().sum::<f64>() / p as f64).collect()
}

/// Control points (one row each) of the splines that take the values of the columns at the sites.
fn solved(k: &Knots, sites: &[f64], values: DMatrix<f64>) -> Outcome<DMatrix<f64>> {
    let mut collocation = DMatrix::zeros(sites.len(), sites.len());
    for (row, &t) in sites.iter().enumerate() {
        let b = k.basis(t, 0);
        for j in 0..=k.degree() {
            collocation[(row, b.first + j)] = b.rows[0][j];
        }
    }
    collocation.lu().solve(&values).ok_or_else(|| "the collocation matrix is singular".into())
}

/// To 0.1 µm: hides the last bits, in which machines differ.
fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}
