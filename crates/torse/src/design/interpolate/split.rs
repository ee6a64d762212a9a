//! Two nets joined along a ruling that is left free: the curve is cut, and a direction is sought for which both parts
//! have regular answers. The tangent plane along that ruling is spanned by it and the curve's tangent, on both sides,
//! so the join is smooth.
//!
//! *Method.* A fixed fan of directions around the mean of the given ones; each part by \[FJ07\], section 4.

use super::problem::{Options, Problem};
use super::solution::Solution;
use super::{polynomial, rational};
use crate::geom::Vec3;

/// Where the curve is cut, as shares of its domain, in the order tried.
const CUTS: [f64; 3] = [0.5, 0.35, 0.65];
/// Share of the domain within which a knot is where the curve is cut: rounding of lengths, from which knots come.
const ON_KNOT: f64 = 1e-9;
/// Inclinations of the fan: tangents of the angles against the mean direction.
const INCLINATIONS: [f64; 7] = [0.15, 0.35, 0.6, 1.0, 1.7, 3.0, 6.0];
/// Directions per inclination.
const ROUND: usize = 18;
/// Sum of two unit directions below which they are opposite (to 0.06°) and have no mean.
const OPPOSITE: f64 = 1e-3;

/// The two parts with the most even reaches, at the first cut that has any; polynomial parts before rational ones.
pub(super) fn best(problem: &Problem) -> Option<Vec<Solution>> {
    let way = |rational: bool| CUTS.iter().find_map(move |&share| at(problem, share, rational));
    way(false).or_else(|| if problem.options.rational { way(true) } else { None })
}

fn at(problem: &Problem, share: f64, by_rational: bool) -> Option<Vec<Solution>> {
    let (a, b) = problem.curve.domain();
    let at = a + share * (b - a);
    // At a knot where one is all but there: both would leave a piece without length.
    let knots = problem.curve.knots.breaks();
    let cut = knots.into_iter().find(|k| (k - at).abs() <= ON_KNOT * (b - a)).unwrap_or(at);
    let (left, right) = problem.curve.split(cut).ok()?;
    let size = 0.5 * (problem.v.norm() + problem.w.norm());
    let mut best: Option<(f64, Vec<Solution>)> = None;
    for direction in fan(&problem.v, &problem.w) {
        let x = direction * size;
        let options = Options { end_reach: None, ..problem.options };
        let Some(first) = solved(&problem.part(left.clone(), problem.v, x, options), by_rational) else { continue };
        let options = Options { reach: first.end_reach, ..problem.options };
        let Some(second) = solved(&problem.part(right.clone(), x, problem.w, options), by_rational) else { continue };
        let uneven =
            |p: &Vec3, q: &Vec3, r: &Solution| (r.end_reach * q.norm() / (r.start_reach * p.norm())).ln().abs();
        let score = uneven(&problem.v, &x, &first).max(uneven(&x, &problem.w, &second));
        if best.as_ref().is_none_or(|b| score < b.0) {
            best = Some((score, vec![first, second]));
        }
    }
    best.map(|b| b.1)
}

/// A regular answer for one part.
fn solved(part: &Problem, by_rational: bool) -> Option<Solution> {
    if by_rational {
        return if part.coplanar() { None } else { rational::best(part, part.options.reach) };
    }
    let (_, candidates, _) = polynomial::candidates(part);
    candidates.into_iter().find(Solution::is_good)
}

/// Unit directions around the mean of two.
fn fan(v: &Vec3, w: &Vec3) -> Vec<Vec3> {
    let (v, w) = (v.normalize(), w.normalize());
    // Opposite directions have no mean; any direction across them serves.
    let sum = v + w;
    let mean = if sum.norm() > OPPOSITE { sum.normalize() } else { across(&v) };
    let p = across(&mean);
    let q = mean.cross(&p);
    let mut out = vec![mean];
    for (k, slope) in INCLINATIONS.iter().enumerate() {
        for i in 0..ROUND {
            // Rings are turned against each other, so that the fan covers directions evenly.
            let angle = (i as f64 + 0.5 * (k % 2) as f64) * std::f64::consts::TAU / ROUND as f64;
            out.push((mean + (p * angle.cos() + q * angle.sin()) * *slope).normalize());
        }
    }
    out
}

/// A unit vector perpendicular to a unit vector.
fn across(x: &Vec3) -> Vec3 {
    let other = if x.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
    x.cross(&other).normalize()
}
