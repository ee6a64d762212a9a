//! Curves of space as CAD files hold them: lines, conics and splines, with exact conversion to rational splines.

use super::nearest_on_curve::{nearest, refine};
use super::parameter_map::{quarter_pieces, unit_arc, ParameterMap};
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use std::f64::consts::{PI, TAU};

/// Ends of curves and sides of patches coincide, or a side is a point, when they agree to this share of the whole: ten
/// printed digits.
pub(crate) const COINCIDENT: f64 = 1e-9;
/// Stations nearer than this share of the piece are one: rounding of knots shifted by whole periods, with a margin.
const SAME_STATION: f64 = 1e-12;
/// Step of the difference for a second derivative, a share of the parameter (of one, near zero): about the cube root
/// of the precision, where rounding and the third derivative cost equally much.
const DIFFERENCE: f64 = 1e-6;

/// A curve of space with its natural parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum SpaceCurve {
    /// `origin + t direction`; the direction need not have unit length.
    Line {
        /// Point at t = 0.
        origin: Vec3,
        /// Derivative.
        direction: Vec3,
    },
    /// `a cos t x + b sin t y`; a circle when a = b.
    Ellipse {
        /// Centre and axes.
        frame: Frame,
        /// Semi-axis along x.
        a: f64,
        /// Semi-axis along y.
        b: f64,
    },
    /// `focal (t² x + 2 t y)`.
    Parabola {
        /// Apex and axes.
        frame: Frame,
        /// Focal distance.
        focal: f64,
    },
    /// `a cosh t x + b sinh t y`.
    Hyperbola {
        /// Centre and axes.
        frame: Frame,
        /// Semi-axis along x.
        a: f64,
        /// Semi-axis along y.
        b: f64,
    },
    /// Homogeneous B-spline `(w x, w y, w z, w)`; parameters outside the domain wrap around if it is closed.
    Spline(Curve<4>),
    /// A curve given in the parameter plane of a surface.
    Traced(Box<TracedCurve>),
}

/// A surface that carries curves given in its parameter plane.
pub trait Support: std::fmt::Debug + Send + Sync {
    /// Point and derivatives along u and v at natural parameters.
    fn tangent_jet(&self, at: [f64; 2]) -> [Vec3; 3];

    /// Natural parameters of a nearest point.
    fn nearest(&self, x: &Vec3) -> [f64; 2];
}

/// The image of a parameter-plane curve (third coordinate 0) on a support.
#[derive(Clone, Debug)]
pub struct TracedCurve {
    plane_curve: SpaceCurve,
    support: std::sync::Arc<dyn Support>,
    scale: [f64; 2],
}

impl SpaceCurve {
    /// The point at `t`.
    pub fn point(&self, t: f64) -> Vec3 {
        self.jet(t)[0]
    }

    /// Point and first two derivatives at `t`.
    pub fn jet(&self, t: f64) -> [Vec3; 3] {
        match self {
            Self::Line { origin, direction } => [origin + direction * t, *direction, Vec3::zeros()],
            Self::Ellipse { frame, a, b } => {
                let (s, c) = t.sin_cos();
                let radius = frame.x * (a * c) + frame.y * (b * s);
                [frame.origin + radius, frame.y * (b * c) - frame.x * (a * s), -radius]
            }
            Self::Parabola { frame, focal } => [
                frame.origin + (frame.x * (t * t) + frame.y * (2.0 * t)) * *focal,
                (frame.x * (2.0 * t) + frame.y * 2.0) * *focal,
                frame.x * (2.0 * focal),
            ],
            Self::Hyperbola { frame, a, b } => {
                let radius = frame.x * (a * t.cosh()) + frame.y * (b * t.sinh());
                [frame.origin + radius, frame.x * (a * t.sinh()) + frame.y * (b * t.cosh()), radius]
            }
            Self::Spline(c) => affine_jet(c, self.wrap(t)),
            Self::Traced(c) => c.jet(t),
        }
    }

    /// The curve `scale · plane_curve(t)` in the natural parameters of a support.
    pub fn traced(plane_curve: SpaceCurve, support: impl Support + 'static, scale: [f64; 2]) -> Self {
        Self::Traced(Box::new(TracedCurve { plane_curve, support: std::sync::Arc::new(support), scale }))
    }

    /// The parameter inside the domain of a closed spline; `t` itself for everything else.
    fn wrap(&self, t: f64) -> f64 {
        let Self::Spline(c) = self else { return t };
        let (a, b) = c.domain();
        if t >= a && t <= b {
            return t;
        }
        // Asked only outside the domain: whether the curve is closed takes a look at its ends.
        match self.period() {
            Some(period) => a + (t - a).rem_euclid(period),
            None => t,
        }
    }

    /// Domain of the natural parameter where it is bounded.
    pub fn domain(&self) -> Option<(f64, f64)> {
        match self {
            Self::Spline(c) => Some(c.domain()),
            Self::Ellipse { .. } => Some((0.0, TAU)),
            Self::Traced(c) => c.plane_curve.domain(),
            _ => None,
        }
    }

    /// Period of the natural parameter of a closed curve.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Ellipse { .. } => Some(TAU),
            Self::Spline(c) => {
                let (a, b) = c.domain();
                let (p, q) = (affine_jet(c, a)[0], affine_jet(c, b)[0]);
                // Ends are one point when they agree to what ten printed digits give.
                (p - q).norm().le(&(COINCIDENT * extent(c))).then_some(b - a)
            }
            Self::Traced(c) => c.plane_curve.period(),
            _ => None,
        }
    }

    /// Parameters at which smoothness may end or samples should be placed, between `from` and `to` inclusive, in
    /// the direction of travel.
    pub fn stations(&self, from: f64, to: f64) -> Vec<f64> {
        let (lo, hi) = (from.min(to), from.max(to));
        let mut out = vec![lo];
        match self {
            Self::Line { .. } => {}
            Self::Traced(c) => {
                let mut inner = c.plane_curve.stations(lo, hi);
                // A straight trace may be a whole turn in space.
                let n = inner.len();
                inner = (0..n - 1)
                    .flat_map(|i| (0..8).map(move |k| (i, f64::from(k) / 8.0)))
                    .map(|(i, s)| inner[i] + s * (inner[i + 1] - inner[i]))
                    .collect();
                out.extend(inner.into_iter().filter(|&t| t > lo && t < hi));
            }
            Self::Ellipse { .. } => {
                let n = ((hi - lo) / (PI / 8.0)).ceil().clamp(1.0, 400.0) as usize;
                out.extend((1..n).map(|i| lo + (hi - lo) * i as f64 / n as f64));
            }
            Self::Parabola { .. } | Self::Hyperbola { .. } => {
                out.extend((1..8).map(|i| lo + (hi - lo) * i as f64 / 8.0));
            }
            Self::Spline(c) => {
                let (a, b) = c.domain();
                let shifts: &[f64] = if self.period().is_some() { &[-1.0, 0.0, 1.0] } else { &[0.0] };
                for k in shifts {
                    out.extend(c.knots.breaks().iter().map(|t| t + k * (b - a)).filter(|&t| t > lo && t < hi));
                }
            }
        }
        out.push(hi);
        out.dedup_by(|b, a| *b - *a <= SAME_STATION * (hi - lo));
        if let Some(last) = out.last_mut() {
            *last = hi;
        }
        if to < from {
            out.reverse();
        }
        out
    }

    /// Parameter of a nearest point of the (whole) curve to `x`.
    pub fn nearest(&self, x: &Vec3) -> f64 {
        match self {
            Self::Line { origin, direction } => (x - origin).dot(direction) / direction.norm_squared(),
            Self::Ellipse { frame, a, b } => {
                let q = frame.to_local(x);
                if (a - b).abs() <= f64::EPSILON * a {
                    return q.y.atan2(q.x).rem_euclid(TAU);
                }
                let guess = (q.y / b).atan2(q.x / a);
                let best = [guess, q.y.atan2(q.x), guess + 0.5 * PI, guess - 0.5 * PI]
                    .map(|g| refine(|t| self.jet(t), x, g, None))
                    .into_iter()
                    .min_by(|p, q| p.1.total_cmp(&q.1));
                best.map_or(guess, |b| b.0).rem_euclid(TAU)
            }
            Self::Parabola { frame, focal } => {
                let q = frame.to_local(x);
                refine(|t| self.jet(t), x, 0.5 * q.y / focal, None).0
            }
            Self::Hyperbola { frame, b, .. } => {
                let q = frame.to_local(x);
                refine(|t| self.jet(t), x, (q.y / b).asinh(), None).0
            }
            Self::Spline(c) => nearest(|t| self.jet(t), &c.knots, x),
            Self::Traced(c) => {
                let flat = c.flat_foot(x);
                refine(|t| self.jet(t), x, c.plane_curve.nearest(&flat), None).0
            }
        }
    }

    /// The piece between the natural parameters `from < to` as an exact rational B-spline, and how parameters map.
    ///
    /// # Errors
    /// An empty or endless piece, or more than 16 turns.
    pub fn to_spline(&self, from: f64, to: f64) -> Result<(Curve<4>, ParameterMap), SplineError> {
        if !(to > from && (to - from).is_finite()) {
            return Err(SplineError::KnotOrder { index: 0, value: to });
        }
        let homogeneous = |p: Vec3, w: f64| [p.x, p.y, p.z, w];
        match self {
            Self::Line { .. } => {
                let ends = [homogeneous(self.point(from), 1.0), homogeneous(self.point(to), 1.0)];
                Ok((Curve::new(1, vec![from, from, to, to], ends.to_vec())?, ParameterMap::Same))
            }
            Self::Ellipse { frame, a, b } => {
                let pieces = quarter_pieces(to - from);
                let sweep = (to - from) / pieces as f64;
                let (knots, arc) = unit_arc(from, sweep, pieces);
                let control = arc
                    .iter()
                    .map(|c| homogeneous(frame.origin * c[2] + frame.x * (a * c[0]) + frame.y * (b * c[1]), c[2]))
                    .collect();
                Ok((Curve::new(2, knots, control)?, ParameterMap::Angle { start: from, sweep }))
            }
            Self::Parabola { frame, focal } => {
                let middle = frame.origin + (frame.x * (from * to) + frame.y * (from + to)) * *focal;
                let control = [self.point(from), middle, self.point(to)].map(|p| homogeneous(p, 1.0)).to_vec();
                Ok((Curve::new(2, vec![from, from, from, to, to, to], control)?, ParameterMap::Same))
            }
            Self::Hyperbola { frame, a, b } => {
                let (m, h) = (0.5 * (from + to), 0.5 * (to - from));
                let w = h.cosh();
                let middle = frame.origin * w + frame.x * (a * m.cosh()) + frame.y * (b * m.sinh());
                let control =
                    vec![homogeneous(self.point(from), 1.0), homogeneous(middle, w), homogeneous(self.point(to), 1.0)];
                let map = ParameterMap::Hyperbolic { middle: m, half: h };
                Ok((Curve::new(2, vec![from, from, from, to, to, to], control)?, map))
            }
            Self::Spline(c) => Ok((c.clone(), ParameterMap::Same)),
            // Its image in space is a spline of high degree at best.
            Self::Traced(_) => Err(SplineError::Degree(0)),
        }
    }
}

/// Curves are the same where they are the same in the plane and on one and the same support.
impl PartialEq for TracedCurve {
    fn eq(&self, other: &Self) -> bool {
        std::sync::Arc::ptr_eq(&self.support, &other.support)
            && self.plane_curve == other.plane_curve
            && self.scale == other.scale
    }
}

impl TracedCurve {
    fn plane_point(&self, t: f64) -> [f64; 2] {
        let q = self.plane_curve.point(t);
        [q.x * self.scale[0], q.y * self.scale[1]]
    }

    /// Point and derivatives; the second derivative by differences, which serves searches.
    fn jet(&self, t: f64) -> [Vec3; 3] {
        let first = |t: f64| {
            let d = self.plane_curve.jet(t)[1];
            let [p, du, dv] = self.support.tangent_jet(self.plane_point(t));
            (p, du * (d.x * self.scale[0]) + dv * (d.y * self.scale[1]))
        };
        let (p, d) = first(t);
        let h = DIFFERENCE * (1.0 + t.abs());
        [p, d, (first(t + h).1 - first(t - h).1) / (2.0 * h)]
    }

    /// The foot of `x` in the coordinates of the plane curve.
    fn flat_foot(&self, x: &Vec3) -> Vec3 {
        let q = self.support.nearest(x);
        Vec3::new(q[0] / self.scale[0], q[1] / self.scale[1], 0.0)
    }
}

/// A piece of a curve in the direction of travel: `from` may exceed `to`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arc {
    /// The curve.
    pub curve: SpaceCurve,
    /// Parameter at the start.
    pub from: f64,
    /// Parameter at the end.
    pub to: f64,
}

impl Arc {
    /// The same piece, travelled the other way.
    pub(crate) fn reversed(&self) -> Self {
        Self { curve: self.curve.clone(), from: self.to, to: self.from }
    }

    /// First and last point.
    pub(crate) fn ends(&self) -> (Vec3, Vec3) {
        (self.curve.point(self.from), self.curve.point(self.to))
    }
}

/// Affine point and two derivatives of a homogeneous curve.
fn affine_jet(c: &Curve<4>, t: f64) -> [Vec3; 3] {
    let h = c.jet(t);
    let v = h.map(|r| Vec3::new(r[0], r[1], r[2]));
    let w = h.map(|r| r[3]);
    let r = 1.0 / w[0];
    let p = v[0] * r;
    let d = (v[1] - p * w[1]) * r;
    [p, d, (v[2] - d * (2.0 * w[1]) - p * w[2]) * r]
}

/// Diagonal of the box around the control points.
fn extent(c: &Curve<4>) -> f64 {
    crate::geom::BBox::of(c.control.iter().map(|p| Vec3::new(p[0], p[1], p[2]) / p[3]).collect::<Vec<_>>().iter())
        .diagonal()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        let z = Vec3::new(1.0, 2.0, 2.0) / 3.0;
        let x = Vec3::new(2.0, 1.0, -2.0) / 3.0;
        Frame { origin: Vec3::new(1.0, -2.0, 3.0), x, y: z.cross(&x), z }
    }

    #[test]
    fn conics_are_exact_splines_under_the_map() {
        let curves = [
            (SpaceCurve::Ellipse { frame: frame(), a: 3.0, b: 1.0 }, 0.4, 5.9),
            (SpaceCurve::Ellipse { frame: frame(), a: 2.0, b: 2.0 }, -1.0, -1.0 + TAU),
            (SpaceCurve::Parabola { frame: frame(), focal: 0.7 }, -1.0, 2.0),
            (SpaceCurve::Hyperbola { frame: frame(), a: 1.0, b: 0.5 }, -0.3, 1.4),
            (SpaceCurve::Line { origin: Vec3::zeros(), direction: Vec3::new(1.0, 2.0, 0.0) }, -1.0, 2.0),
        ];
        for (curve, from, to) in curves {
            let (spline, map) = curve.to_spline(from, to).expect("a spline");
            let h = SpaceCurve::Spline(spline);
            for i in 0..=40 {
                let t = from + (to - from) * i as f64 / 40.0;
                let u = map.forward(t);
                assert!((h.point(u) - curve.point(t)).norm() < 1e-13, "{curve:?} at {t}");
                let (back, slope) = map.inverse(u);
                assert!((back - t).abs() < 1e-12);
                let difference = (map.inverse(u + 1e-6).0 - map.inverse(u - 1e-6).0) / 2e-6;
                assert!((difference - slope).abs() < 1e-6 || i % 40 == 0);
            }
        }
    }

    #[test]
    fn nearest_points_are_found() {
        let e = SpaceCurve::Ellipse { frame: frame(), a: 3.0, b: 1.0 };
        for t in [0.2, 1.7, 3.0, 4.4, 6.0] {
            assert!((e.nearest(&e.point(t)) - t).abs() < 1e-9);
        }
        let (spline, map) = e.to_spline(0.0, TAU).expect("a spline");
        let s = SpaceCurve::Spline(spline);
        assert!(s.period().is_some());
        for t in [0.2, 1.7, 3.0, 4.4, 6.0] {
            assert!((s.nearest(&e.point(t)) - map.forward(t)).abs() < 1e-9);
        }
    }
}
