//! The piece of a curve that an edge is: parameters of its end points and the way round.

use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::geom::Vec3;

/// Parameters within this share of a period or domain are one.
const SAME_PARAMETER: f64 = 1e-9;
/// Share of the distance of two vertices within which both are at the ends of a curve: beside its seam a piece that is shorter
/// than [`SAME_PARAMETER`] misses the far end by all of that distance.
const AT_ENDS: f64 = 0.5;

/// The piece of `curve` from `start` to `end`, which lie on it (nearly): with the curve's direction if `along`,
/// else against it. `closed` says that both are one vertex: the piece is the whole closed curve.
pub fn between(curve: &SpaceCurve, start: &Vec3, end: &Vec3, closed: bool, along: bool) -> Arc {
    // Find a piece of increasing parameter, then turn it.
    let (first, last) = if along { (start, end) } else { (end, start) };
    let (mut a, mut b) = (curve.nearest(first), curve.nearest(last));
    if let Some(period) = curve.period() {
        let origin = curve.domain().map_or(0.0, |d| d.0);
        a = origin + (a - origin).rem_euclid(period);
        if a - origin > (1.0 - SAME_PARAMETER) * period {
            a = origin;
        }
        if closed {
            b = a + period;
        } else {
            b = a + (b - a).rem_euclid(period);
            let coincide =
                (start - end).norm() <= SAME_PARAMETER * (curve.point(a) - curve.point(a + 0.5 * period)).norm();
            // A curve whose ends are a little apart, each at its vertex, is meant as a whole.
            let whole = |(t0, t1): (f64, f64)| {
                (curve.point(t0) - first).norm() + (curve.point(t1) - last).norm() < AT_ENDS * (first - last).norm()
            };
            // Distinct vertices in one place on a closed curve bound all of it.
            if b - a <= SAME_PARAMETER * period && (coincide || curve.domain().is_some_and(whole)) {
                b = a + period;
            }
        }
    } else if let Some((t0, t1)) = curve.domain() {
        if closed {
            (a, b) = (t0, t1);
        }
        let hair = SAME_PARAMETER * (t1 - t0);
        for t in [&mut a, &mut b] {
            for limit in [t0, t1] {
                if (*t - limit).abs() <= hair {
                    *t = limit;
                }
            }
        }
    }
    let (from, to) = if along { (a, b) } else { (b, a) };
    Arc { curve: curve.clone(), from, to }
}

/// A path whose ends lie nearest to `start` and `end`: as given, or turned round.
pub(crate) fn oriented(path: Vec<Arc>, start: &Vec3, end: &Vec3) -> Vec<Arc> {
    let (Some(first), Some(last)) = (path.first(), path.last()) else { return path };
    let (p, q) = (first.ends().0, last.ends().1);
    if (p - start).norm() + (q - end).norm() <= (q - start).norm() + (p - end).norm() {
        path
    } else {
        path.iter().rev().map(Arc::reversed).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    #[test]
    fn the_way_round_a_circle_follows_the_sense() {
        let c = SpaceCurve::Ellipse { frame: Frame::world(), a: 2.0, b: 2.0 };
        let (p, q) = (c.point(FRAC_PI_2), c.point(PI));
        let length = |a: Arc| a.to - a.from;
        assert!((length(between(&c, &p, &q, false, true)) - FRAC_PI_2).abs() < 1e-12);
        assert!((length(between(&c, &q, &p, false, true)) - 1.5 * PI).abs() < 1e-12);
        assert!((length(between(&c, &p, &q, false, false)) + 1.5 * PI).abs() < 1e-12);
        assert!((length(between(&c, &p, &p, true, false)) + TAU).abs() < 1e-12);
        let back = between(&c, &p, &q, false, false);
        assert!((back.ends().0 - p).norm() < 1e-12 && (back.ends().1 - q).norm() < 1e-12);
    }

    /// A circle of 85 mm radius whose ends are 2e-7 mm apart, as that of a pipe which is cut along a slit.
    #[test]
    fn a_curve_that_nearly_closes_is_run_from_end_to_end() {
        let c = SpaceCurve::Ellipse { frame: Frame::world(), a: 85.0, b: 85.0 };
        let (mut spline, _) = c.to_spline(0.0, TAU).expect("a spline");
        let last = spline.control.last_mut().expect("control points");
        last[1] -= 2e-7 * last[3];
        let s = SpaceCurve::Spline(spline);
        let (t0, t1) = s.domain().expect("a domain");
        assert!(s.period().is_some());
        let (p, q) = (s.point(t0), s.point(t1));
        let length = |a: Arc| (a.to - a.from) / (t1 - t0);
        assert!((length(between(&s, &p, &q, false, true)) - 1.0).abs() < 1e-8);
        assert!((length(between(&s, &q, &p, false, false)) + 1.0).abs() < 1e-8);
        // A piece as short as that is one.
        let beside = s.point(t0 + 1e-9 * (t1 - t0));
        assert!(length(between(&s, &p, &beside, false, true)).abs() < 1e-8);
    }
}
