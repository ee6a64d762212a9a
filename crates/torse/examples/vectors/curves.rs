//! Kinds of cases about developables between curves, ruled surfaces, discrete torses.

use super::value::{number, numbers, vector, Case, Checks};
use serde_json::Value;
use std::f64::consts::TAU;
use torse::brep::space_curve::SpaceCurve;
use torse::control::Control;
use torse::design::hull::hull;
use torse::design::hull::strips::{strips, HullPart};
use torse::design::loft::branches::{branches, self_coplanarity, Branch, BranchOptions, BranchType};
use torse::design::loft::build::{follow, BuildOptions, BuiltStrip};
use torse::design::loft::least_twist::{least_twist, LeastTwistOptions};
use torse::design::loft::track::{LineElement, Track};
use torse::geom::{Frame, Vec3};
use torse::spline::bezier::Bezier;
use torse::spline::curve::{bezier_pieces, Curve};
use torse::torse::form::PanelKind;
use torse::torse::rail::Rail;
use torse::torse::strip::Strip;

/// Runs the case if its kind belongs here.
pub fn run(case: &Case) -> Option<Result<Checks, String>> {
    match case.kind.as_str() {
        "bridge_circle_ellipse" => Some(circle_ellipse(case)),
        "bridge_circle_square" => Some(circle_square(case)),
        "bridge_two_circles" => Some(two_circles(case)),
        "diag_factor" => Some(diagonal(case)),
        "saddle_loop" => Some(saddle_loop(case)),
        _ => None,
    }
}

fn ellipse(origin: Vec3, a: f64, b: f64) -> Result<Rail, String> {
    let frame = Frame { origin, ..Frame::world() };
    let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).map_err(|e| e.to_string())?;
    Rail::new("ellipse", &[c]).map_err(|e| e.to_string())
}

fn followed(a: &Rail, b: &Rail, branch: &Branch) -> Result<Vec<BuiltStrip>, String> {
    follow([a, b], branch, &BuildOptions::new(1e-6), &Control::default()).map_err(|e| e.to_string())
}

/// Share of a turn at which a point of an axis-parallel ellipse about the z-axis lies.
fn turn(p: &Vec3, a: f64, b: f64) -> f64 {
    ((p.y / b).atan2(p.x / a) / TAU).rem_euclid(1.0)
}

fn circle_ellipse(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let ([x, y], height) = (vector::<2>(&case.input, "axes_b")?, number(&case.input, "height_b")?);
    let (a, b) = (ellipse(Vec3::zeros(), 1.0, 1.0)?, ellipse(Vec3::z() * height, x, y)?);
    let found = branches(&a, &b, &BranchOptions::default());
    let closed = found.iter().filter(|f| f.closed).count();
    checks.close("closed branches", closed as f64, number(&case.output, "n_closed_branches")?, 0.0);
    let kinds = [BranchType::Regular, BranchType::DoubleCone];
    checks.holds("one branch of each type", found.iter().map(|f| f.kind).eq(kinds));
    let best = found.first().ok_or("no branch")?;
    let (ta, tb) = (Track::new(&a), Track::new(&b));
    let allowed = number(&case.tol, "abs")?;
    // Stations against the closed form, which the table is checked against too.
    let exact = |s: f64| ((TAU * s).sin() * y).atan2((TAU * s).cos() * x).rem_euclid(TAU) / TAU;
    for (s, t) in numbers(&case.input, "s")?.iter().zip(numbers(&case.output, "t_convex_branch")?) {
        checks.close("closed form", exact(*s), t, allowed);
    }
    for p in &best.stations {
        let (s, t) = (turn(&ta.at(p[0]).point, 1.0, 1.0), turn(&tb.at(p[1]).point, x, y));
        let off = (t - exact(s)).rem_euclid(1.0);
        checks.at_most("t of a station", off.min(1.0 - off), allowed);
    }
    Ok(checks)
}

fn circle_square(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let (r, h, z) =
        (number(&case.input, "circle_R")?, number(&case.input, "square_half")?, number(&case.input, "height")?);
    let points = [(h, 0.0), (h, h), (-h, h), (-h, -h), (h, -h), (h, 0.0)].map(|(x, y)| Vec3::new(x, y, z));
    let square = Rail::polyline("square", &points).map_err(|e| e.to_string())?;
    let circle = ellipse(Vec3::zeros(), r, r)?;
    let found = branches(&circle, &square, &BranchOptions::default());
    let made = followed(&circle, &square, found.first().ok_or("no branch")?)?;
    let area = number(&case.output, "lateral_area")?;
    checks.close("area", made.iter().map(|s| s.strip.area_estimate()).sum(), area, 1e-9);
    // The edge that the rail starts on counts as two facets of one plane.
    let of = |kind: PanelKind| made.iter().filter(move |s| s.strip.kind == kind);
    let facets: f64 = of(PanelKind::Plane).map(|s| s.strip.area_estimate()).sum();
    checks.close("facets", facets, 4.0 * number(&case.output, "facet_area")?, 1e-9);
    checks.close("cones", of(PanelKind::Cone).count() as f64, number(&case.output, "n_cone_pieces")?, 0.0);
    let options = LeastTwistOptions { chords: 128, ..LeastTwistOptions::default() };
    let path = least_twist(&circle, &square, &options).map_err(|e| e.to_string())?;
    checks.close("area of least twist", path.area, area, number(&case.tol, "rel_area_at_N128_samples")?);
    Ok(checks)
}

fn two_circles(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let circle = |v: &Value| -> Result<Rail, String> {
        let (c, r): ([f64; 3], f64) = (vector(v, "center")?, number(v, "R")?);
        ellipse(Vec3::from(c), r, r)
    };
    let (a, b) = (circle(&case.input["circle_a"])?, circle(&case.input["circle_b"])?);
    let allowed = number(&case.tol, "abs")?;
    let found = branches(&a, &b, &BranchOptions::default());
    let (ta, tb) = (Track::new(&a), Track::new(&b));
    for (kind, key) in [(BranchType::Regular, "cone_apex_regular"), (BranchType::DoubleCone, "cone_apex_double")] {
        let branch = found.iter().find(|f| f.kind == kind && f.closed).ok_or(format!("no {kind:?} branch"))?;
        let apex = Vec3::from(vector::<3>(&case.output, key)?);
        for p in &branch.stations {
            let (p, q) = (ta.at(p[0]).point, tb.at(p[1]).point);
            checks.at_most(
                "distance of the apex from a ruling",
                (apex - p).cross(&(q - p).normalize()).norm(),
                allowed,
            );
        }
    }
    Ok(checks)
}

/// `(a cos t, b sin t, c cos 2t)` from the quarters of a circle: quartic in homogeneous coordinates.
fn saddle(a: f64, b: f64, c: f64) -> Result<Rail, String> {
    let (circle, _) =
        SpaceCurve::Ellipse { frame: Frame::world(), a: 1.0, b: 1.0 }.to_spline(0.0, TAU).map_err(|e| e.to_string())?;
    let mut quarters = Vec::new();
    for (_, _, net) in bezier_pieces(&circle) {
        let net = Bezier::new(net);
        let (x, y, w) = (net.component(0), net.component(1), net.component(3));
        // cos 2t = x² − y².
        let parts = [x.times(&w), y.times(&w), x.times(&x).minus(&y.times(&y)), w.times(&w)];
        let scale = [a, b, c, 1.0];
        let control = (0..5).map(|k| [0, 1, 2, 3].map(|d: usize| scale[d] * parts[d].control()[k][0])).collect();
        let knots = [vec![0.0; 5], vec![1.0; 5]].concat();
        quarters.push(Curve::new(4, knots, control).map_err(|e| e.to_string())?);
    }
    Rail::new("saddle", &quarters).map_err(|e| e.to_string())
}

fn saddle_loop(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let (a, b, c) = (number(&case.input, "a")?, number(&case.input, "b")?, number(&case.input, "c")?);
    let rails = [saddle(a, b, c)?];
    let found = hull(&rails, 128, &Control::default()).map_err(|e| e.to_string())?;
    let allowed = number(&case.tol, "rel")?;
    let parts =
        strips(&rails, &found, 1e-3, &BuildOptions::new(1e-9), &Control::default()).map_err(|e| e.to_string())?;
    checks.close("developables", parts.len() as f64, number(&case.output, "n_developables")?, 0.0);
    // Branch A joins points of equal x, branch B points of equal y.
    for (axis, key) in [(0, "area_A"), (1, "area_B")] {
        let along = |p: &HullPart| {
            let ends = p.strips.iter().map(|s| s.built.strip.ruling(0.5));
            ends.fold(0.0, |m: f64, [p, q]| m.max((p[axis] - q[axis]).abs()))
        };
        let part = parts.iter().find(|p| along(p) < 1e-9).ok_or(format!("no part for {key}"))?;
        let area: f64 = part.strips.iter().map(|s| s.built.strip.area_estimate()).sum();
        checks.close(key, area, number(&case.output, key)?, allowed);
        let cylinders = part.strips.iter().filter(|s| s.built.strip.kind == PanelKind::Cylinder).count();
        checks.close("cylinders", cylinders as f64, part.strips.len() as f64, 0.0);
    }
    // Volume: of cones from the origin over the strips.
    let volume: f64 = parts.iter().flat_map(|p| &p.strips).map(|s| cone_volume(&s.built.strip)).sum();
    checks.close("volume", volume, number(&case.output, "convex_hull_volume")?, allowed);
    Ok(checks)
}

/// Volume between the origin and a strip, by the midpoint rule over the rulings.
fn cone_volume(strip: &Strip) -> f64 {
    const CELLS: usize = 400;
    let (u0, u1) = strip.domain();
    let row = |i: usize| {
        let j = strip.patch.jet(u0 + (u1 - u0) * (i as f64 + 0.5) / CELLS as f64, 0.5);
        // det(x, x_u, x_v) is linear in v: its mean is the value in the middle.
        j.p.dot(&j.du.cross(&j.dv)).abs() / 3.0
    };
    (0..CELLS).map(row).sum::<f64>() * (u1 - u0) / CELLS as f64
}

fn diagonal(case: &Case) -> Result<Checks, String> {
    let mut checks = Checks::default();
    let (p, t) = (number(&case.input, "p")?, number(&case.input, "t")?);
    let speed = (1.0 + p * p).sqrt();
    let at = |t: f64| LineElement {
        point: Vec3::new(t.cos(), t.sin(), p * t),
        tangent: Vec3::new(-t.sin(), t.cos(), p) / speed,
    };
    // Unit tangents and chords instead of derivatives and parameters: six factors of the speed. Two steps
    // extrapolated, since the error is even in h about the middle.
    let value = |h: f64| self_coplanarity(&at(t - 0.5 * h), &at(t + 0.5 * h)) * speed.powi(6);
    let limit = (4.0 * value(0.02) - value(0.04)) / 3.0;
    checks.close("limit", limit, number(&case.output, "limit_det_over_h4")?, number(&case.tol, "abs")?);
    Ok(checks)
}
