//! The question that \[FJ07\], section 4, answers: a curve, the lines of its first and last ruling, and what is wanted beyond them.

use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use crate::torse::net::NetError;

/// Sine of the angle between the end rulings below which they count as parallel: beyond the digits that directions
/// are given with.
pub(super) const PARALLEL: f64 = 1e-12;
/// Distance between the lines of the end rulings, as a share of the curve's size, below which they count as meeting.
pub(super) const MEETING: f64 = 1e-12;
/// Sine of the angle between a given ruling and the curve's tangent below which the ruling is refused.
pub(super) const TANGENT: f64 = 1e-8;

/// The lines given at both ends of the curve: directions that point to the side on which the surface is wanted. Their
/// lengths, mm, are the units of the reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndRulings {
    /// At the start of the curve.
    pub start: Vec3,
    /// At its end.
    pub end: Vec3,
}

/// What is wanted beyond the two lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Length of the first ruling as a multiple of the given vector; default 1.
    pub reach: f64,
    /// Length of the last ruling as a multiple of the given vector; default none: it follows from the surface.
    pub end_reach: Option<f64>,
    /// Whether the strip may be made shorter along its rulings to stay clear of the regression curve; default true.
    pub shorten: bool,
    /// Whether rational nets are tried where no polynomial one exists; default true.
    pub rational: bool,
    /// Whether the curve may be split, with a free ruling in between; default true.
    pub split: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { reach: 1.0, end_reach: None, shorten: true, rational: true, split: true }
    }
}

/// A question that cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InterpolateError {
    /// A ruling without direction.
    #[error("the {which} ruling ({}, {}, {}) has no direction; give a vector that is not zero", .vector[0], .vector[1], .vector[2])]
    Direction {
        /// "first" or "last".
        which: &'static str,
        /// Coordinates as given.
        vector: [f64; 3],
    },
    /// A ruling along the curve.
    #[error("the {which} ruling is tangent to the curve at u = {u} (angle {angle:e} rad); turn it out of the tangent")]
    Tangent {
        /// "first" or "last".
        which: &'static str,
        /// Parameter of the end.
        u: f64,
        /// Angle, radians.
        angle: f64,
    },
    /// The curve stands still at an end.
    #[error("the curve has no tangent at u = {u}: its control points coincide there")]
    NoTangent {
        /// Parameter of the end.
        u: f64,
    },
    /// A reach that is not positive.
    #[error("the reach {reach} of the {which} ruling must be a positive number")]
    Reach {
        /// "first" or "last".
        which: &'static str,
        /// As given.
        reach: f64,
    },
    /// Not a valid curve.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// Not a valid net.
    #[error(transparent)]
    Net(#[from] NetError),
}

/// A question that can be asked: curve clamped, weights of a polynomial curve 1.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub(super) curve: Curve<4>,
    pub(super) polynomial: bool,
    /// Directions as given.
    pub(super) v: Vec3,
    pub(super) w: Vec3,
    /// `v × w`.
    pub(super) normal: Vec3,
    pub(super) options: Options,
}

impl Problem {
    pub(super) fn new(curve: &Curve<4>, rulings: &EndRulings, options: &Options) -> Result<Self, InterpolateError> {
        let (a, b) = curve.domain();
        for (index, c) in curve.control.iter().enumerate() {
            if c[3] <= 0.0 || c.iter().any(|x| !x.is_finite()) {
                return Err(NetError::Weight { index, weight: c[3] }.into());
            }
        }
        let mut curve = curve.restricted(a, b)?;
        let first = curve.control[0][3];
        let polynomial = curve.control.iter().all(|c| (c[3] - first).abs() <= 4.0 * f64::EPSILON * first);
        if polynomial {
            for c in &mut curve.control {
                *c = [c[0] / c[3], c[1] / c[3], c[2] / c[3], 1.0];
            }
        }
        for (which, x) in [("first", &rulings.start), ("last", &rulings.end)] {
            let length = x.norm();
            if !(length > 0.0 && length.is_finite()) {
                return Err(InterpolateError::Direction { which, vector: [x.x, x.y, x.z] });
            }
        }
        let reaches = [("first", options.reach), ("last", options.end_reach.unwrap_or(1.0))];
        for (which, reach) in reaches {
            if !(reach > 0.0 && reach.is_finite()) {
                return Err(InterpolateError::Reach { which, reach });
            }
        }
        let points: Vec<Vec3> = curve.control.iter().map(affine).collect();
        let last = points.len() - 1;
        let ends = [
            ("first", a, points[1] - points[0], rulings.start),
            ("last", b, points[last] - points[last - 1], rulings.end),
        ];
        for (which, u, tangent, ruling) in ends {
            if tangent.norm() == 0.0 {
                return Err(InterpolateError::NoTangent { u });
            }
            let angle = tangent.cross(&ruling).norm().atan2(tangent.dot(&ruling).abs());
            if angle <= TANGENT {
                return Err(InterpolateError::Tangent { which, u, angle });
            }
        }
        let (v, w) = (rulings.start, rulings.end);
        Ok(Self { curve, polynomial, v, w, normal: v.cross(&w), options: *options })
    }

    /// The same curve part with other rulings; the checks are left to the caller.
    pub(super) fn part(&self, curve: Curve<4>, v: Vec3, w: Vec3, options: Options) -> Self {
        Self { curve, polynomial: self.polynomial, v, w, normal: v.cross(&w), options }
    }

    pub(super) fn points(&self) -> Vec<Vec3> {
        self.curve.control.iter().map(affine).collect()
    }

    pub(super) fn start(&self) -> Vec3 {
        affine(&self.curve.control[0])
    }

    pub(super) fn end(&self) -> Vec3 {
        affine(&self.curve.control[self.curve.control.len() - 1])
    }

    pub(super) fn parallel(&self) -> bool {
        self.normal.norm() <= PARALLEL * self.v.norm() * self.w.norm()
    }

    /// Whether the lines of the end rulings lie in a plane.
    pub(super) fn coplanar(&self) -> bool {
        let chord = self.end() - self.start();
        self.parallel() || chord.dot(&self.normal).abs() <= MEETING * chord.norm() * self.normal.norm()
    }

    /// `(v × w)·(c_{i+1} − c_i)`, enclosed.
    pub(super) fn deltas(&self) -> Vec<Interval> {
        let enclosed = |x: &Vec3| [x.x, x.y, x.z].map(Interval::point);
        let (v, w) = (enclosed(&self.v), enclosed(&self.w));
        let n: [Interval; 3] =
            std::array::from_fn(|d| v[(d + 1) % 3] * w[(d + 2) % 3] - v[(d + 2) % 3] * w[(d + 1) % 3]);
        let points = self.points();
        points
            .windows(2)
            .map(|p| {
                let (x, y) = (enclosed(&p[0]), enclosed(&p[1]));
                (0..3).map(|d| n[d] * (y[d] - x[d])).fold(Interval::ZERO, |s, t| s + t)
            })
            .collect()
    }
}

/// The point of space.
pub(super) fn affine(x: &[f64; 4]) -> Vec3 {
    Vec3::new(x[0], x[1], x[2]) / x[3]
}
