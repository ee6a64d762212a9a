//! Rational nets through a curve and two lines that do not meet: possible for every M*, so that M* is left to choose.
//!
//! *Method.* The recursion of \[FJ07\] in homogeneous coordinates, the case that paper leaves open. With
//! `T = T_0 C_0 + T_v (v, 0) + T_L C_L + T_w (w, 0)` the first and last ruling vectors are combinations of the given
//! points and directions for `κ = σ w_0 π/(σ w_0 T_0 − T_v)`. Of the values of M* on a grid that give positive weights
//! and a regular surface with both ends on the sides given, the one with the most even reaches is taken.

use super::candidate::measured;
use super::problem::{affine, Problem};
use super::solution::Solution;
use crate::geom::Vec3;
use crate::torse::net::{paper_knots, Net, Shape};

/// Values of M* tried on each side of the curve.
const GRID: usize = 60;
/// Values of `m (b − a)/2` nearer to 0 than this are left out: polynomial curves have no such nets at 0, and weights
/// vary without bound next to it.
const LEAST_X: f64 = 0.02;
/// Least weight of the opposite boundary as a share of its largest one: beyond it other programs lose digits.
const LEAST_WEIGHT: f64 = 1e-2;
/// Golden-section steps around the best value of the grid.
const REFINEMENTS: usize = 24;

/// The rational net with the first reach `reach` whose reaches differ least.
pub(super) fn best(problem: &Problem, reach: f64) -> Option<Solution> {
    let step = (1.0 - LEAST_X) / (GRID as f64 + 0.5);
    let one_side = (0..GRID).map(|k| LEAST_X + step * (k as f64 + 0.5));
    let grid: Vec<f64> = one_side.flat_map(|x| [x, -x]).collect();
    let mut found: Vec<(f64, f64)> = grid.iter().filter_map(|&x| Some((trial(problem, x, reach)?.0, x))).collect();
    found.sort_by(|p, q| p.0.total_cmp(&q.0));
    let tangent_free = |x: f64| trial(problem, x, reach).filter(|t| t.1.tangent_ruling().is_none());
    let (mut score, mut x, mut net) = found.iter().find_map(|&(s, x)| tangent_free(x).map(|t| (s, x, t.1)))?;
    // Refined between the neighbours of the grid. A prescribed last reach is a zero of the score, and met exactly if
    // it is reached there.
    let (mut low, mut high) = (x - step, x + step);
    for _ in 0..REFINEMENTS {
        let next = if x - low > high - x { x - 0.382 * (x - low) } else { x + 0.382 * (high - x) };
        let better = tangent_free(next).filter(|t| t.0 < score);
        let (inner, outer) = if better.is_some() { (next, x) } else { (x, next) };
        if outer < inner {
            low = outer;
        } else {
            high = outer;
        }
        if let Some(t) = better {
            (score, net) = t;
        }
        x = inner;
    }
    let found = measured(problem, net)?;
    found.is_good().then_some(found)
}

/// Score and net for `m = 2x/(b − a)`; `None` unless weights are positive, the regression curve stays off the strip and
/// both ends lie on the sides given.
fn trial(problem: &Problem, x: f64, reach: f64) -> Option<(f64, Net)> {
    if !(x.abs() > 0.5 * LEAST_X && x.abs() < 1.0) {
        return None;
    }
    let (a, b) = problem.curve.domain();
    let net = net(problem, 2.0 * x / (b - a), reach)?;
    if net.shape().regression_within((0.0, 1.0)).is_some() {
        return None;
    }
    let weights = net.opposite_points();
    let (least, most) = weights.iter().fold((f64::INFINITY, 0.0f64), |(l, m), p| (l.min(p[3]), m.max(p[3])));
    if least.is_nan() || least <= LEAST_WEIGHT * most {
        return None;
    }
    let end = affine(&weights[weights.len() - 1]) - problem.end();
    let tau = end.dot(&problem.w) / problem.w.norm_squared();
    let wanted = problem.options.end_reach.map_or(reach * problem.v.norm(), |tau| tau * problem.w.norm());
    (tau > 0.0).then(|| ((tau * problem.w.norm() / wanted).ln().abs(), net))
}

/// The net for `m`, with first reach `reach`, whatever it is like.
pub(super) fn net(problem: &Problem, m: f64, reach: f64) -> Option<Net> {
    let curve = &problem.curve;
    let (n, u) = (curve.knots.degree(), paper_knots(&curve.knots));
    let shape = Shape::new(curve.domain(), m, 0.0);
    let (mut t, mut pi) = ([0.0; 4], 1.0);
    for (i, w) in curve.control.windows(2).enumerate() {
        let (above, below) = (shape.g(u[i + n]), shape.g(u[i]));
        for d in 0..4 {
            t[d] = (t[d] * above + w[1][d] - w[0][d]) / below;
        }
        pi *= above / below;
    }
    let coordinates = Coordinates::of(problem, &t)?;
    let w_0 = curve.control[0][3];
    let kappa = reach * w_0 * pi / (reach * w_0 * coordinates.first - coordinates.v);
    let e = combination(problem, -kappa * coordinates.first / pi, -kappa * coordinates.v / pi);
    Net::from_first(curve.clone(), e, Shape { kappa, ..shape }).ok()
}

/// `x C_0 + y (v, 0)`.
fn combination(problem: &Problem, x: f64, y: f64) -> [f64; 4] {
    let c = problem.curve.control[0];
    [x * c[0] + y * problem.v.x, x * c[1] + y * problem.v.y, x * c[2] + y * problem.v.z, x * c[3]]
}

/// Coordinates of a homogeneous vector in `C_0`, `(v, 0)`, `C_L`, `(w, 0)`; the last two are not needed.
struct Coordinates {
    first: f64,
    v: f64,
}

impl Coordinates {
    fn of(problem: &Problem, t: &[f64; 4]) -> Option<Self> {
        // Weight and component along v × w settle the two points; what is left lies in the plane of v and w.
        let (p, q, n) = (problem.start(), problem.end(), &problem.normal);
        let x = Vec3::new(t[0], t[1], t[2]);
        let last = (x.dot(n) - t[3] * p.dot(n)) / (q - p).dot(n);
        let first = t[3] - last;
        let rest = x - p * first - q * last;
        let v = rest.cross(&problem.w).dot(n) / n.norm_squared();
        let w_0 = problem.curve.control[0][3];
        (last.is_finite() && v.is_finite()).then_some(Self { first: first / w_0, v })
    }
}
