//! Curves through points, followed by splines with few knots and many continuous derivatives: every knot of a curve
//! becomes a span of a strip, and near tips rulings depend on derivatives that cubics do not have.
//!
//! *Method.* Least squares \[PT97, 9.4.1\] at places of the given curve, with its parameters; closed ones more than once round.

use crate::control::Control;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq::fit;
use crate::torse::rail::{tangent, Rail};

/// Spans from which on a piece is worth following: fewer are no trouble.
const LONG: usize = 8;
/// Degree of the splines. At a tip the torsion vanishes, which has the third derivative; where the middles of short rulings
/// lie depends on its second derivative, the fifth; these are to have a continuous derivative more.
const DEGREE: usize = 7;
/// Spans with which the search begins.
const FEWEST: usize = 8;
/// Spans that are few, even of a curve with fewer.
const SPARSE: usize = 64;
/// Places per span at which the given curve is met; a spline has one unknown per span.
const PLACES: usize = 4;
/// Spans by which a closed piece is gone round on both sides. What happens at the far ends falls with every span to less
/// than two thirds at this degree, so that the seam is smooth up to rounding.
const WRAP: usize = 80;
/// Turn (rad) above which pieces meet at a corner, as for [`Rail::new`]: there tangents may change a little.
const CORNER: f64 = 1e-4;

/// The rail with its pieces of many spans replaced by splines of degree 7 with equal spans, as few as keep within
/// `tolerance` (mm) at equal parameters; pieces that would need more spans than they have, and more than a few, stay as
/// they are, and so do those that join others smoothly.
///
/// *Measured, not proven*: the distance is looked at twice per span of the given curve.
pub(crate) fn sparse(rail: &Rail, tolerance: f64, control: &Control) -> Rail {
    let count = rail.pieces.len();
    let turn = |k: usize| tangent(&rail.pieces[k % count], 1.0).angle(&tangent(&rail.pieces[(k + 1) % count], 0.0));
    let wraps = count == 1 && rail.closed && turn(0) <= CORNER;
    let free = |k: usize| {
        let joins = |k: usize| (rail.closed || k + 1 < count) && turn(k) <= CORNER;
        wraps || !(joins(k) || (k > 0 || rail.closed) && joins((k + count - 1) % count))
    };
    let piece = |k: usize| {
        let given = &rail.pieces[k];
        let found = if free(k) { followed(given, tolerance, wraps, control) } else { None };
        found.unwrap_or_else(|| given.clone())
    };
    Rail { name: rail.name.clone(), pieces: (0..count).map(piece).collect(), closed: rail.closed }
}

/// The spline with fewest spans found, by doubling.
fn followed(given: &Curve<4>, tolerance: f64, wraps: bool, control: &Control) -> Option<Curve<4>> {
    let breaks = given.knots.breaks();
    let spans = breaks.len() - 1;
    let smooth = given.knots.distinct().iter().all(|(t, m)| *t <= 0.0 || *t >= 1.0 || m + 2 <= given.knots.degree());
    let plain = given.control.iter().all(|c| c[3] == 1.0);
    if spans < LONG || !smooth || !plain {
        return None;
    }
    let place = |t: f64| Vec3::from_column_slice(&given.point(t)[..3]);
    let places: Vec<f64> = breaks.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]).collect();
    let mut count = FEWEST;
    while count <= spans.max(SPARSE) && !control.stopped() {
        let found = with_spans(&place, count, wraps)?;
        let near = |t: &f64| (Vec3::from_column_slice(&found.point(*t)[..3]) - place(*t)).norm() <= tolerance;
        if places.iter().all(near) {
            return Some(found);
        }
        count *= 2;
    }
    None
}

/// The spline with equal spans nearest to a curve over [0, 1].
fn with_spans(place: &dyn Fn(f64) -> Vec3, count: usize, wraps: bool) -> Option<Curve<4>> {
    let beyond = if wraps { WRAP as i64 } else { 0 };
    let (first, last) = (-beyond, count as i64 + beyond);
    let breaks: Vec<f64> = (first..=last).map(|k| k as f64 / count as f64).collect();
    let parts = PLACES as i64;
    let parameters: Vec<f64> = (parts * first..=parts * last).map(|k| k as f64 / (PLACES * count) as f64).collect();
    let once = |t: f64| if wraps { t.rem_euclid(1.0) } else { t };
    let points: Vec<[f64; 3]> = parameters.iter().map(|t| place(once(*t)).into()).collect();
    let knots = Knots::clamped(DEGREE, &breaks).ok()?;
    let mut curve = fit(&points, &parameters, &knots).ok()?.curve;
    if wraps {
        curve = curve.restricted(0.0, 1.0).ok()?;
        let end = curve.control.len() - 1;
        // The same up to rounding.
        let (a, b) = (curve.control[0], curve.control[end]);
        let middle = [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]));
        (curve.control[0], curve.control[end]) = (middle, middle);
    }
    let control = curve.control.iter().map(|c| [c[0], c[1], c[2], 1.0]).collect();
    Some(Curve { knots: curve.knots, control })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn round(n: usize) -> Rail {
        let at = |k: usize| {
            let t = TAU * (k % n) as f64 / n as f64;
            Vec3::new(300.0 * t.cos(), 200.0 * t.sin(), 60.0 * (2.0 * t).cos())
        };
        Rail::through("round", &(0..=n).map(at).collect::<Vec<_>>()).expect("rail")
    }

    #[test]
    fn a_loop_through_many_points_keeps_its_course_and_its_smooth_seam() {
        let rail = round(1500);
        let found = sparse(&rail, 0.01, &Control::default());
        let spans = |r: &Rail| r.pieces[0].knots.breaks().len() - 1;
        assert!(spans(&rail) > 1000 && spans(&found) <= 128, "{} {}", spans(&rail), spans(&found));
        for k in 0..=3000 {
            let t = f64::from(k) / 3000.0;
            assert!((rail.point(t) - found.point(t)).norm() < 0.0101);
        }
        let piece = &found.pieces[0];
        assert!(found.closed && tangent(piece, 1.0).angle(&tangent(piece, 0.0)) < 1e-9);
        assert!((found.point(0.0) - found.point(1.0)).norm() == 0.0);
    }

    #[test]
    fn short_pieces_and_a_stopped_job_leave_the_curve_as_it_is() {
        let arc = |k: i32| Vec3::new(f64::from(k), (f64::from(k) * 0.2).sin(), f64::from(k * k) * 0.01) * 100.0;
        let few = Rail::through("arc", &(0..7).map(arc).collect::<Vec<_>>()).expect("rail");
        assert_eq!(sparse(&few, 1.0, &Control::default()), few);
        let stopped = Control::default();
        stopped.cancel();
        let many = round(300);
        assert_eq!(sparse(&many, 0.01, &stopped), many);
    }
}
