//! A trough over a spline through seven points, with round holes bored upright across its bends.

use std::f64::consts::PI;

use super::{greville, rounded, smooth_spline, solved, uses, Outcome};
use nalgebra::DMatrix;
use torse::geom::Vec3;
use torse::io::step::write::{EdgeUse, Shell, ShellCurve, ShellEdge};
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;

/// The points lie at even distances over the length; along the width the sheet is straight. Lengths in mm.
const HEIGHTS: [f64; 7] = [0.0, -120.0, -180.0, -60.0, -200.0, -120.0, 0.0];
const LENGTH: f64 = 1200.0;
const WIDTH: f64 = 800.0;
/// Axis (from the beginning, from the side) and radius of every hole.
const HOLES: [[f64; 3]; 6] = [
    [380.0, 170.0, 60.0],
    [620.0, 220.0, 70.0],
    [800.0, 250.0, 55.0],
    [410.0, 600.0, 80.0],
    [590.0, 560.0, 50.0],
    [810.0, 610.0, 75.0],
];
/// Spans of a whole hole: its edge is within 2·10⁻⁶ mm of both the sheet and the bore.
const SPANS: f64 = 42.0;

/// The parameters of the sheet are x and y, so that upright bores are circles there.
pub fn trough() -> Outcome<Shell> {
    let sites: Vec<f64> = (0..HEIGHTS.len()).map(|k| LENGTH * k as f64 / (HEIGHTS.len() - 1) as f64).collect();
    // The second and the last but one are no knots: so splines are drawn of which nothing is said about their ends.
    let knots = Knots::clamped(3, &[sites[0], sites[2], sites[3], sites[4], sites[6]])?;
    let heights = solved(&knots, &sites, DMatrix::from_column_slice(sites.len(), 1, &HEIGHTS))?;
    let control = greville(&knots).into_iter().zip(heights.iter()).map(|(x, z)| [x, rounded(*z)]).collect();
    let profile = Curve { knots, control };
    let net: Vec<Vec3> = profile.control.iter().flat_map(|c| [0.0, WIDTH].map(|y| Vec3::new(c[0], y, c[1]))).collect();
    let across = Knots::clamped(1, &[0.0, WIDTH])?;
    let mut sheet = Shell::untrimmed("trough", &Surface::new(profile.knots.clone(), across, &net, None)?);
    for hole in HOLES {
        let bored = bore(&mut sheet, &profile, hole)?;
        sheet.faces[0].loops.push(bored);
    }
    Ok(sheet)
}

/// Adds the edges of a hole and answers its loop. It is in pieces between the knots of the profile, within which it is smooth.
fn bore(sheet: &mut Shell, profile: &Curve<2>, [x, y, radius]: [f64; 3]) -> Outcome<Vec<EdgeUse>> {
    let crossed = profile.knots.breaks().into_iter().filter(|b| (b - x).abs() < radius);
    let turns = crossed.map(|b| ((b - x) / radius).acos() / (2.0 * PI));
    let mut cuts: Vec<f64> = turns.flat_map(|t| [t, 1.0 - t]).collect();
    cuts.sort_by(f64::total_cmp);
    if cuts.is_empty() {
        cuts.push(0.0);
    }
    cuts.push(cuts[0] + 1.0);
    let (vertex, edge, pieces) = (sheet.vertices.len(), sheet.edges.len(), cuts.len() - 1);
    let mut run = Vec::new();
    for (k, ends) in cuts.windows(2).enumerate() {
        let turn = ends[1] - ends[0];
        let curve = smooth_spline((SPANS * turn).ceil() as usize, |s| {
            let (sin, cos) = (2.0 * PI * (ends[0] + turn * s)).sin_cos();
            let [x, z] = profile.point(x + radius * cos);
            Vec3::new(x, y + radius * sin, z)
        })?;
        sheet.vertices.push(Vec3::from(curve.control[0]));
        let trim = Curve { knots: curve.knots.clone(), control: curve.control.iter().map(|c| [c[0], c[1]]).collect() };
        run.push(EdgeUse { trim: Some(trim), ..uses(&[(edge + k, false)]).remove(0) });
        let (start, end) = (vertex + k, vertex + (k + 1) % pieces);
        sheet.edges.push(ShellEdge { start, end, curve: ShellCurve::Spline(curve) });
    }
    // A hole is run clockwise.
    run.reverse();
    Ok(run)
}
