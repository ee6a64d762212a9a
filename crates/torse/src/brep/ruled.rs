//! Ruled surfaces: straight lines between two curves (docs/algorithms/reading.md).

use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::unroll;
use crate::geom::Vec3;
use crate::num::quadrature::GAUSS_8;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::lsq;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// Rails that are reparametrised keep to the given curves within this share of their extent.
const NEAR: f64 = 1e-7;
/// The worst share that is still accepted.
const ACCEPTED: f64 = 1e-4;
/// Samples of a rail that is reparametrised.
const SAMPLES: usize = 4000;
/// Spans of such a rail at most.
const MOST_SPANS: usize = 400;
/// Numbers that differ by less than this share are one.
const SAME: f64 = 1e-12;
/// Ranges that leave a spline's domain by less than this share end with it.
const ON_END: f64 = 1e-9;

/// A surface of straight lines between two curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Ruled {
    /// Rails over `[0, 1]` with common knots, homogeneous.
    pub rails: [Curve<4>; 2],
    /// The vector by which the second rail is the first one moved, if it is: the surface is a cylinder then.
    pub translation: Option<Vec3>,
    /// Distance (in the unit of the curves) between rails and curves at samples; 0 where they are the same.
    pub deviation_estimate: f64,
}

impl Ruled {
    /// The surface between two curves. Points that belong together have equal shares of the lengths of the curves if
    /// `by_length`, else of their parameters. *Exact* on splines and lines with equal shares of parameters, on two
    /// lines, and on two arcs of the same angle; otherwise both curves are fitted by cubics.
    ///
    /// # Errors
    /// Curves that are points, or cannot be fitted.
    pub fn between(first: &Arc, second: &Arc, by_length: bool) -> Result<Self, SplineError> {
        let (rails, deviation_estimate) = if alike(first, second, by_length) {
            ([spline_of(first)?, spline_of(second)?], 0.0)
        } else {
            fitted(first, second, by_length).ok_or_else(|| SplineError::Control {
                index: 0,
                reason: "its rails cannot be fitted with equal shares of their lengths".into(),
            })?
        };
        let rails = compatible(rails)?;
        let translation = translation(&rails[0], &rails[1]);
        Ok(Self { rails, translation, deviation_estimate })
    }

    /// The surface: u along the rails, v from the first to the second.
    ///
    /// # Errors
    /// None for rails as [`Ruled::between`] makes them.
    pub fn surface(&self) -> Result<Surface, SplineError> {
        let knots_v = Knots::new(1, vec![0.0, 0.0, 1.0, 1.0], 2)?;
        let [a, b] = &self.rails;
        let control: Vec<[f64; 4]> = a.control.iter().zip(&b.control).flat_map(|(p, q)| [*p, *q]).collect();
        let rational = control.iter().any(|c| c[3] != 1.0);
        Ok(Surface { knots_u: a.knots.clone(), knots_v, control, rational })
    }
}

/// A piece of a curve as a spline in the direction of travel.
///
/// # Errors
/// An empty or endless piece.
pub(crate) fn spline_of(arc: &Arc) -> Result<Curve<4>, SplineError> {
    let (lo, hi) = (arc.from.min(arc.to), arc.from.max(arc.to));
    let spline = match &arc.curve {
        SpaceCurve::Spline(c) => {
            let (a, b) = c.domain();
            let hair = ON_END * (b - a);
            if lo >= a - hair && hi <= b + hair {
                c.restricted(lo.max(a), hi.min(b))?
            } else {
                unroll::curve(c, (lo, hi))?
            }
        }
        other => other.to_spline(lo, hi)?.0,
    };
    Ok(if arc.to < arc.from { spline.reversed() } else { spline })
}

/// Whether equal shares of the parameters of both splines belong together.
fn alike(a: &Arc, b: &Arc, by_length: bool) -> bool {
    match (&a.curve, &b.curve) {
        (SpaceCurve::Line { .. }, SpaceCurve::Line { .. }) => true,
        (SpaceCurve::Ellipse { a: ra, b: rb, .. }, SpaceCurve::Ellipse { a: sa, b: sb, .. }) => {
            let circles = (ra - rb).abs() <= SAME * ra && (sa - sb).abs() <= SAME * sa;
            let (way, other) = ((a.to - a.from).abs(), (b.to - b.from).abs());
            (circles || !by_length) && (way - other).abs() <= SAME * way
        }
        (SpaceCurve::Line { .. } | SpaceCurve::Spline(_), SpaceCurve::Line { .. } | SpaceCurve::Spline(_)) => {
            let degree_one = |x: &Arc| match &x.curve {
                SpaceCurve::Spline(c) => c.control.len() == 2,
                _ => true,
            };
            !by_length || (degree_one(a) && degree_one(b))
        }
        _ => false,
    }
}

/// Both rails as cubics whose points at equal parameters belong together, with the distance from the file's curves at
/// samples.
fn fitted(a: &Arc, b: &Arc, by_length: bool) -> Option<([Curve<4>; 2], f64)> {
    let mut worst = 0.0_f64;
    let mut rail = |arc: &Arc| -> Option<Curve<4>> {
        let shares: Vec<f64> = (0..=SAMPLES).map(|i| i as f64 / SAMPLES as f64).collect();
        let at = if by_length { by_arc_length(arc, &shares)? } else { shares.clone() };
        let points: Vec<[f64; 3]> =
            at.iter().map(|s| arc.curve.point(arc.from + s * (arc.to - arc.from)).into()).collect();
        let size = points.iter().fold(0.0, |m: f64, p| m.max((Vec3::from(*p) - Vec3::from(points[0])).norm()));
        let fit = lsq::fit_within(&points, &shares, 3, NEAR * size, MOST_SPANS).ok()?;
        worst = worst.max(fit.error);
        let control = fit.curve.control.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
        (fit.error <= ACCEPTED * size).then_some(Curve { knots: fit.curve.knots, control })
    };
    Some(([rail(a)?, rail(b)?], worst))
}

/// Shares of the parameter at which the length of the curve has the given shares.
fn by_arc_length(arc: &Arc, shares: &[f64]) -> Option<Vec<f64>> {
    let way = arc.to - arc.from;
    let speed = |s: f64| (arc.curve.jet(arc.from + s * way)[1] * way).norm();
    let mut length = vec![0.0];
    for w in shares.windows(2) {
        length.push(length[length.len() - 1] + GAUSS_8.integrate(w[0], w[1], speed));
    }
    let total = *length.last()?;
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let mut k = 0;
    let inverse = |wanted: f64| {
        while k + 2 < length.len() && length[k + 1] < wanted {
            k += 1;
        }
        let mut s = shares[k]
            + (shares[k + 1] - shares[k]) * (wanted - length[k]) / (length[k + 1] - length[k]).max(f64::MIN_POSITIVE);
        // Two steps of Newton's method: the table is near already.
        for _ in 0..2 {
            let v = speed(s);
            if v > 0.0 {
                let here = length[k] + GAUSS_8.integrate(shares[k], s, speed);
                s = (s + (wanted - here) / v).clamp(shares[k], shares[k + 1]);
            }
        }
        s
    };
    Some(shares.iter().map(|x| x * total).map(inverse).collect())
}

/// Both splines over `[0, 1]` with one degree and the same knots.
fn compatible(rails: [Curve<4>; 2]) -> Result<[Curve<4>; 2], SplineError> {
    let degree = rails.iter().map(|c| c.knots.degree()).fold(1, usize::max);
    let mut out = Vec::with_capacity(2);
    for c in rails {
        let c = c.elevated_to(degree)?;
        let (a, b) = c.domain();
        let knots: Vec<f64> = c.knots.values().iter().map(|t| ((t - a) / (b - a)).clamp(0.0, 1.0)).collect();
        out.push(Curve::new(degree, knots, c.control)?);
    }
    let missing = |from: &Knots, to: &Knots| -> Vec<f64> {
        let has = |t: f64| to.distinct().iter().find(|d| (d.0 - t).abs() <= SAME).map_or(0, |d| d.1);
        let (a, b) = from.domain();
        let inner = from.distinct().into_iter().filter(|d| d.0 > a + SAME && d.0 < b - SAME);
        inner.flat_map(|(t, m)| std::iter::repeat_n(t, m.saturating_sub(has(t)))).collect()
    };
    let (more_a, more_b) = (missing(&out[1].knots, &out[0].knots), missing(&out[0].knots, &out[1].knots));
    let a = out[0].with_knots(&more_a)?;
    let mut b = out[1].with_knots(&more_b)?;
    b.knots = a.knots.clone();
    Ok([a, b])
}

/// The vector by which the second rail is the first one moved, if it is.
fn translation(a: &Curve<4>, b: &Curve<4>) -> Option<Vec3> {
    let point = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
    let way = point(&b.control[0]) - point(&a.control[0]);
    let size = a.control.iter().chain(&b.control).fold(0.0, |m: f64, h| m.max(point(h).amax()));
    let same = |p: &[f64; 4], q: &[f64; 4]| {
        (p[3] - q[3]).abs() <= SAME * p[3] && (point(q) - point(p) - way).amax() <= SAME * size
    };
    (a.control.iter().zip(&b.control).all(|(p, q)| same(p, q)) && way.norm() > SAME * size).then_some(way)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use std::f64::consts::PI;

    #[test]
    fn lines_join_equal_shares_of_length() {
        // A parabola, whose speed is not constant, and a half circle.
        let c = Curve::new(2, vec![0., 0., 0., 1., 1., 1.], vec![[0., 0., 0., 1.], [1., 0., 0., 1.], [4., 3., 0., 1.]]);
        let first = Arc { curve: SpaceCurve::Spline(c.expect("curve")), from: 0.0, to: 1.0 };
        let curve = SpaceCurve::Ellipse { frame: Frame { origin: Vec3::z(), ..Frame::world() }, a: 2.0, b: 2.0 };
        let second = Arc { curve, from: PI, to: 0.0 };
        let r = Ruled::between(&first, &second, true).expect("a surface");
        let point = |c: &Curve<4>, t: f64| {
            let h = c.point(t);
            Vec3::new(h[0], h[1], h[2]) / h[3]
        };
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            let angle = PI * (1.0 - t);
            let q = Vec3::new(2.0 * angle.cos(), 2.0 * angle.sin(), 1.0);
            assert!((point(&r.rails[1], t) - q).norm() < 1e-5, "{t}");
        }
        // Half of the length is half way.
        let length = |a: f64, b: f64| -> f64 {
            let at = |k: i32| first.curve.point(a + (b - a) * f64::from(k) / 2000.0);
            (0..2000).map(|k| (at(k + 1) - at(k)).norm()).sum()
        };
        let half = first.curve.nearest(&point(&r.rails[0], 0.5));
        assert!((length(0.0, half) / length(0.0, 1.0) - 0.5).abs() < 1e-4);
        assert!(r.translation.is_none() && r.deviation_estimate < 1e-5);
    }

    #[test]
    fn equal_parameters_of_splines_are_exact() {
        let line = |z: f64, y: f64| Arc {
            curve: SpaceCurve::Line { origin: Vec3::new(0.0, y, z), direction: Vec3::new(2.0, 0.0, 0.0) },
            from: 0.0,
            to: 1.0,
        };
        let r = Ruled::between(&line(0.0, 0.0), &line(5.0, 1.0), false).expect("a surface");
        assert_eq!(r.translation, Some(Vec3::new(0.0, 1.0, 5.0)));
        assert_eq!(r.deviation_estimate, 0.0);
        assert!((r.surface().expect("surface").point(0.5, 0.5) - Vec3::new(1.0, 0.5, 2.5)).norm() < 1e-15);
    }
}
