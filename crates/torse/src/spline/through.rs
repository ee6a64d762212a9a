//! The twice continuously differentiable cubic through points, with chord lengths as parameters \[PT97, 9.2.3\].

use super::curve::Curve;
use super::knots::Knots;
use super::lsq::{self, LsqError};
use super::SplineError;
use crate::geom::Vec3;

/// Sweeps of the iteration for the slopes. Every equation weighs its own unknown twice as much as its neighbours
/// together, so that errors halve with each sweep: after so many, nothing but rounding is left.
const SWEEPS: usize = 64;

/// The cubic that interpolates `points` (mm), as a curve of degree 3 with double knots.
///
/// *Input*: at least two different points; points that repeat the one before are passed over. `ends` are the directions
/// (of any length) at both ends; where there is none, the curvature is zero there (the natural end). `closed` joins
/// the last point to the first with the same smoothness; `ends` do not count then.
/// *Guarantees*: the points are on the curve, which is C² up to rounding; its parameter is the length of the chords, from
/// 0 on, and its derivative where a direction is given has length 1. *Cost*: linear.
///
/// # Errors
/// Fewer than two different points, coordinates that are not finite.
pub fn cubic(points: &[Vec3], ends: [Option<Vec3>; 2], closed: bool) -> Result<Curve<4>, SplineError> {
    if let Some(index) = points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(SplineError::Control { index, reason: "the point is not finite".into() });
    }
    let mut points = points.to_vec();
    points.dedup();
    if closed && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    let n = points.len().saturating_sub(1);
    if n == 0 || (closed && n < 2) {
        let reason = format!("{} different points are too few for a spline", n + usize::from(!closed));
        return Err(SplineError::Control { index: 0, reason });
    }
    let h: Vec<f64> = points.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    let slopes = slopes(&points, &h, ends, closed);
    let mut knots = vec![0.0; 4];
    let mut control = vec![points[0]];
    let mut t = 0.0;
    for i in 0..n {
        t += h[i];
        knots.extend(if i + 1 < n { vec![t; 2] } else { vec![t; 4] });
        control.push(points[i] + slopes[i] * (h[i] / 3.0));
        control.push(points[i + 1] - slopes[i + 1] * (h[i] / 3.0));
    }
    control.push(points[n]);
    Curve::new(3, knots, control.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect())
}

/// The spline over clamped `knots` on [0, 1] that is nearest in the sense of least squares to the cubic through `points` (mm) at
/// `count` + 1 even parameters; through the first and the last point.
///
/// # Errors
/// Fewer than two different points, coordinates that are not finite, fewer parameters than the knots need.
pub fn on_knots(points: &[Vec3], knots: &Knots, count: usize) -> Result<Curve<3>, LsqError> {
    let cubic = cubic(points, [None, None], false)?;
    let (a, b) = cubic.domain();
    let parameters: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
    let at = |t: &f64| {
        let h = cubic.point(a + (b - a) * t);
        [h[0] / h[3], h[1] / h[3], h[2] / h[3]]
    };
    let samples: Vec<[f64; 3]> = parameters.iter().map(at).collect();
    Ok(lsq::fit(&samples, &parameters, knots)?.curve)
}

/// Derivatives at the points that make the second derivatives equal on both sides.
fn slopes(points: &[Vec3], h: &[f64], ends: [Option<Vec3>; 2], closed: bool) -> Vec<Vec3> {
    let n = h.len();
    let chord: Vec<Vec3> = (0..n).map(|i| (points[i + 1] - points[i]) / h[i]).collect();
    let unit = |d: Option<Vec3>| d.and_then(|d| d.try_normalize(0.0));
    let [first, last] = ends.map(unit);
    let mut m: Vec<Vec3> = (0..=n).map(|i| chord[i.min(n - 1)]).collect();
    // Slope at a point from those before and after, over the spans `a` and `b`.
    let inner = |before: Vec3, after: Vec3, a: usize, b: usize| {
        let sum = (chord[a] * h[b] + chord[b] * h[a]) * 3.0 - before * h[b] - after * h[a];
        sum / (2.0 * (h[a] + h[b]))
    };
    for _ in 0..SWEEPS {
        for i in 1..n {
            m[i] = inner(m[i - 1], m[i + 1], i - 1, i);
        }
        if closed {
            m[0] = inner(m[n - 1], m[1], n - 1, 0);
            m[n] = m[0];
        } else {
            m[0] = first.unwrap_or((chord[0] * 3.0 - m[1]) / 2.0);
            m[n] = last.unwrap_or((chord[n - 1] * 3.0 - m[n - 1]) / 2.0);
        }
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn second(c: &Curve<4>, t: f64) -> Vec3 {
        let d = c.jet(t)[2];
        Vec3::new(d[0], d[1], d[2])
    }

    #[test]
    fn on_given_knots_it_stays_near_the_cubic() {
        let p = [[0.0, 0.0, 0.0], [5.0, 0.0, 1.0], [10.0, 0.0, 0.0]].map(Vec3::from);
        let mut values = vec![0.0; 4];
        (1..4).for_each(|k| values.extend([f64::from(k) / 4.0; 2]));
        values.extend([1.0; 4]);
        let knots = Knots::new(3, values, 10).expect("knots");
        let c = on_knots(&p, &knots, 48).expect("a spline");
        for (t, x) in [(0.0, p[0]), (0.5, p[1]), (1.0, p[2])] {
            assert!((Vec3::from(c.point(t)) - x).norm() < 1e-3, "{t}");
        }
        assert!(on_knots(&p, &knots, 2).is_err() && on_knots(&p[..1], &knots, 48).is_err());
    }

    #[test]
    fn it_runs_through_the_points_with_continuous_curvature() {
        let p = [[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 12.0], [8.0, 4.0, 12.0]].map(Vec3::from);
        let c = cubic(&p, [None, Some(Vec3::new(0.0, -7.0, 0.0))], false).expect("a spline");
        for (t, x) in [(0.0, p[0]), (5.0, p[1]), (17.0, p[2]), (22.0, p[3])] {
            let q = c.point(t);
            assert!((Vec3::new(q[0], q[1], q[2]) - x).norm() < 1e-12);
        }
        const STEP: f64 = 1e-9;
        for t in [5.0, 17.0] {
            assert!((second(&c, t - STEP) - second(&c, t + STEP)).norm() < 1e-7, "{t}");
        }
        assert!(second(&c, 0.0).norm() < 1e-12);
        let end = c.jet(22.0)[1];
        assert!((Vec3::new(end[0], end[1], end[2]) - Vec3::new(0.0, -1.0, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn two_points_are_joined_by_a_line_and_a_closed_row_goes_on_smoothly() {
        let p = [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0]].map(Vec3::from);
        let line = cubic(&p, [None; 2], false).expect("a line");
        assert!((line.point(2.0)[0] - 2.0).abs() < 1e-12 && line.point(2.0)[1].abs() < 1e-12);
        let ring = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]].map(Vec3::from);
        let c = cubic(&ring, [None; 2], true).expect("a ring");
        let (a, b) = c.domain();
        assert!((second(&c, a) - second(&c, b)).norm() < 1e-9);
        assert!((c.point(0.5 * 2.0_f64.sqrt())[0].hypot(c.point(0.5 * 2.0_f64.sqrt())[1]) - 1.0).abs() < 0.03);
        assert!(cubic(&[Vec3::zeros(); 3], [None; 2], false).is_err());
        assert!(cubic(&[Vec3::repeat(f64::NAN), Vec3::zeros()], [None; 2], false).is_err());
    }
}
