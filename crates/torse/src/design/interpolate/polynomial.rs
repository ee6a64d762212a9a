//! Polynomial nets for the roots of the solvability polynomial, and the cylinders and cones beside them.
//!
//! *Method.* \[FJ07\], (20) and (21) in stable form: with `T ← (g(u_{i+n}) T + c_{i+1} − c_i)/g(u_i)` from 0 and
//! `π = Π g(u_{i+n})/g(u_i)`, a root has `T = A v + B w`, and `σ = −κ A/π`, `τ = κ B`.

use super::candidate::measured;
use super::problem::Problem;
use super::solution::{Route, Solution};
use super::solvability::{of, Solvability};
use crate::geom::Vec3;
use crate::torse::net::{paper_knots, Net, Regularity, Shape};

/// Share of the way to the regression curve that a shortened strip keeps: not quite up to it, where nothing is
/// regular.
const KEPT: f64 = 0.9;

/// Nets that hold both lines with M* outside the domain, best first, and what they are.
pub(super) fn candidates(problem: &Problem) -> (Option<Solvability>, Vec<Solution>, Route) {
    let solvability = problem.polynomial.then(|| of(problem, false));
    if problem.parallel() {
        return (solvability, cylinder(problem).into_iter().collect(), Route::Cylinder);
    }
    let mut found: Vec<Solution> = match &solvability {
        Some(s) => s.regular.iter().filter_map(|&m| net_for(problem, m)).filter_map(|n| measured(problem, n)).collect(),
        None if problem.coplanar() => rational_cone(problem).and_then(|n| measured(problem, n)).into_iter().collect(),
        None => vec![],
    };
    found.sort_by(|x, y| {
        let key = |s: &Solution| (!s.is_good(), !same_side(s), tangent(s));
        key(x)
            .cmp(&key(y))
            .then(y.clearance_estimate.total_cmp(&x.clearance_estimate))
            .then_with(|| x.strip.net.shape().m.abs().total_cmp(&y.strip.net.shape().m.abs()))
    });
    let cone = found.first().is_some_and(|s| s.strip.net.shape().m == 0.0 || s.strip.net.shape().kappa == 0.0);
    (solvability, found, if cone { Route::Cone } else { Route::Polynomial })
}

fn same_side(s: &Solution) -> bool {
    s.start_reach > 0.0 && s.end_reach > 0.0
}

fn tangent(s: &Solution) -> bool {
    matches!(s.regularity, Regularity::TangentRuling { .. })
}

/// The net with this m and the wanted first reach.
fn net_for(problem: &Problem, m: f64) -> Option<Net> {
    let curve = &problem.curve;
    let (n, u) = (curve.knots.degree(), paper_knots(&curve.knots));
    let shape = Shape::new(curve.domain(), m, 0.0);
    let points = problem.points();
    let (mut t, mut pi) = (Vec3::zeros(), 1.0);
    for i in 0..points.len() - 1 {
        let (above, below) = (shape.g(u[i + n]), shape.g(u[i]));
        t = (t * above + points[i + 1] - points[i]) / below;
        pi *= above / below;
    }
    let square = problem.normal.norm_squared();
    let along = t.cross(&problem.w).dot(&problem.normal) / square;
    let across = problem.v.cross(&t).dot(&problem.normal) / square;
    let sigma = problem.options.reach;
    let kappa = -sigma * pi / along;
    if !kappa.is_finite() {
        return None;
    }
    let shape = Shape { kappa, ..shape };
    // Errors shrink where g falls along the recursion. The ruling it starts from is met exactly, the other one by
    // the root.
    let net = if m >= 0.0 {
        let e = problem.v * sigma;
        Net::from_first(curve.clone(), [e.x, e.y, e.z, 0.0], shape)
    } else {
        let e = problem.w * (kappa * across);
        Net::from_last(curve.clone(), [e.x, e.y, e.z, 0.0], shape)
    };
    net.ok()
}

/// The cylinder in the direction of both end rulings; where the last reach is prescribed, the rulings' lengths change
/// as `g(u)ⁿ`.
fn cylinder(problem: &Problem) -> Option<Solution> {
    if problem.v.dot(&problem.w) <= 0.0 {
        return None;
    }
    let curve = &problem.curve;
    let (a, b) = curve.domain();
    let (first, last) = (curve.control[0][3], curve.control[curve.control.len() - 1][3]);
    let sigma = problem.options.reach;
    let ratio =
        problem.options.end_reach.map_or(1.0, |tau| tau * problem.w.norm() * last / (sigma * problem.v.norm() * first));
    let e = problem.v * (sigma * first);
    let shape = Shape::new((a, b), power_shape(ratio, curve.knots.degree(), (a, b)), 0.0);
    measured(problem, Net::from_first(curve.clone(), [e.x, e.y, e.z, 0.0], shape).ok()?)
}

/// `m` with `(g(b)/g(a))ⁿ = ratio`.
fn power_shape(ratio: f64, n: usize, (a, b): (f64, f64)) -> f64 {
    let root = ratio.powf(1.0 / n as f64);
    2.0 * (1.0 - root) / ((1.0 + root) * (b - a))
}

/// The cone over a rational curve whose vertex is the meeting point of the end rulings; `κ = 0`, the vertex carries
/// the weights.
fn rational_cone(problem: &Problem) -> Option<Net> {
    let curve = &problem.curve;
    let (p, q) = (problem.start(), problem.end());
    // p + s v = q + r w.
    let square = problem.normal.norm_squared();
    let s = (q - p).cross(&problem.w).dot(&problem.normal) / square;
    let r = (q - p).cross(&problem.v).dot(&problem.normal) / square;
    let vertex = (p + problem.v * s + q + problem.w * r) * 0.5;
    // The weight β of the vertex that puts the end at `reach`: reach = s β/(w + β).
    let weight = |reach: f64, to_vertex: f64, w: f64| w * reach / (to_vertex - reach);
    let beta = weight(problem.options.reach, s, curve.control[0][3]);
    let m = match problem.options.end_reach {
        Some(tau) => {
            let ratio = weight(tau, r, curve.control[curve.control.len() - 1][3]) / beta;
            if ratio > 0.0 {
                power_shape(ratio, curve.knots.degree(), curve.domain())
            } else {
                0.0
            }
        }
        None => 0.0,
    };
    let e = [vertex.x * beta, vertex.y * beta, vertex.z * beta, beta];
    Net::from_first(curve.clone(), e, Shape::new(curve.domain(), m, 0.0)).ok()
}

/// The same surface, shorter, so that it stays clear of the regression curve; `None` if that is not what ails it, or
/// if the last reach is prescribed.
pub(super) fn shortened(problem: &Problem, s: &Solution) -> Option<Solution> {
    if problem.options.end_reach.is_some() || !matches!(s.regularity, Regularity::Regression { .. }) {
        return None;
    }
    let shape = s.strip.net.shape();
    let share = KEPT * shape.least_g() / shape.kappa.abs();
    if !(share > 0.0 && share < 1.0) {
        return None;
    }
    let found = measured(problem, s.strip.net.between(0.0, share).ok()?)?;
    found.is_good().then_some(found)
}
