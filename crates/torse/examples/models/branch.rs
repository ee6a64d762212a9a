//! A conical branch that leaves a pipe at 45°: both bodies end in one edge, their intersection.

use std::f64::consts::PI;

use super::{smooth_spline, uses, Outcome};
use torse::geom::{Frame, Vec3};
use torse::io::step::write::{Shell, ShellCurve, ShellEdge, ShellFace, ShellSurface};

/// Radius of the pipe and the heights where it begins and ends; the axes meet at height 0. Lengths in mm.
const PIPE: f64 = 250.0;
const HEIGHTS: [f64; 2] = [-1000.0, 1500.0];
/// Radius of the cone where the axes meet and at its end, and how far the end is from there.
const ROOT: f64 = 240.0;
const END: f64 = 150.0;
const REACH: f64 = 1000.0;
/// Spans of the intersection: the spline is within 2·10⁻⁷ mm of both bodies.
const SPANS: usize = 192;

/// The pipe closes at the back of the branch, the branch along its shortest ruling.
pub fn branch() -> Outcome<Shell> {
    let half = 0.5f64.sqrt();
    let along = Vec3::new(half, 0.0, half);
    // The cone widens from its end towards the pipe.
    let cone = Frame { origin: along * REACH, x: Vec3::new(-half, 0.0, half), y: Vec3::y(), z: -along };
    let seam = smooth_spline(SPANS, |s| meeting(&cone, 2.0 * PI * s))?;
    let pipe = |z: f64| Frame { origin: Vec3::new(0.0, 0.0, z), x: -Vec3::x(), y: -Vec3::y(), z: Vec3::z() };
    let mut sheet = Shell { name: "branch".into(), ..Shell::default() };
    sheet.vertices = HEIGHTS.iter().map(|&z| Vec3::new(-PIPE, 0.0, z)).collect();
    sheet.vertices.extend([cone.origin + cone.x * END, Vec3::from(seam.control[0])]);
    let mut edge = |start, end, curve| sheet.edges.push(ShellEdge { start, end, curve });
    edge(0, 0, ShellCurve::Circle { frame: pipe(HEIGHTS[0]), radius: PIPE });
    edge(0, 1, ShellCurve::Line);
    edge(1, 1, ShellCurve::Circle { frame: pipe(HEIGHTS[1]), radius: PIPE });
    edge(2, 2, ShellCurve::Circle { frame: cone, radius: END });
    edge(2, 3, ShellCurve::Line);
    edge(3, 3, ShellCurve::Spline(seam));
    // Seen from outside the seam is run clockwise, as a hole is.
    let hole = uses(&[(5, true)]);
    let mut face = |name: &str, surface, loops| {
        sheet.faces.push(ShellFace { name: name.into(), surface, reversed: false, loops });
    };
    let rim = uses(&[(0, true), (1, true), (2, false), (1, false)]);
    face("pipe", ShellSurface::Cylinder { frame: pipe(0.0), radius: PIPE }, vec![rim, hole]);
    let half_angle = ((ROOT - END) / REACH).atan();
    let rim = uses(&[(3, true), (4, true), (5, false), (4, false)]);
    face("branch", ShellSurface::Cone { frame: cone, radius: END, half_angle }, vec![rim]);
    Ok(sheet)
}

/// Where the ruling at an angle about the cone's axis leaves the pipe.
fn meeting(cone: &Frame, angle: f64) -> Vec3 {
    let out = cone.x * angle.cos() + cone.y * angle.sin();
    let (root, ahead) = (out * ROOT, -cone.z - out * ((ROOT - END) / REACH));
    let level = |a: &Vec3, b: &Vec3| a.x * b.x + a.y * b.y;
    let (a, b, c) = (level(&ahead, &ahead), level(&root, &ahead), level(&root, &root) - PIPE * PIPE);
    root + ahead * (((b * b - a * c).sqrt() - b) / a)
}
