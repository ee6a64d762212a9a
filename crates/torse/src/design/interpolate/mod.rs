//! The developable through a curve with given first and last ruling.
//!
//! *Method.* \[FJ07\], section 4, with the existence question closed. A polynomial net exists exactly for the roots of
//! the solvability polynomial ([`solvability`]); those with a regular surface are isolated with certainty, and the best
//! is chosen. Where there is none: a rational net, which meets the two lines for every M* (`rational`); then two nets
//! that share a ruling in between (`split`); then the reasons (`Reasons`).

mod candidate;
mod polynomial;
mod rational;
mod reasons;
mod solvability;
mod split;

#[cfg(test)]
mod tests;

pub use reasons::Quality;
pub(crate) use reasons::Reasons;
pub use reasons::Turn;
pub use solvability::solvability;
pub(crate) use solvability::Solvability;

use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use crate::torse::net::{NetError, Regularity, TaperedNet};

/// Sine of the angle between the end rulings below which they count as parallel: beyond the digits that directions
/// are given with.
const PARALLEL: f64 = 1e-12;
/// Distance between the lines of the end rulings, as a share of the curve's size, below which they count as meeting.
const MEETING: f64 = 1e-12;
/// Sine of the angle between a given ruling and the curve's tangent below which the ruling is refused.
const TANGENT: f64 = 1e-8;

/// Ratio of the reaches beyond which a strip has no width at one end: its regression curve touches the curve there but
/// for rounding.
const LEAST_RATIO: f64 = 1e-6;
/// Angle between an end ruling and its line above which rounding has spoilt the answer, radians.
const LARGEST_END_ERROR: f64 = 1e-9;

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

/// One strip through a part of the curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The strip. Its curve is the given one, clamped; the taper is constant unless both reaches were prescribed.
    pub strip: TaperedNet,
    /// Length of the first ruling, in the given vector.
    pub start_reach: f64,
    /// Length of the last ruling, in the given vector; negative on the other side.
    pub end_reach: f64,
    /// Smallest distance found along a ruling from the curve to the regression curve, mm.
    pub clearance_estimate: f64,
    /// Whether the strip is a regular surface, or where it is not.
    pub regularity: Regularity,
    /// Larger of the angles between the end rulings and the lines given, radians: rounding.
    pub end_error: f64,
}

/// How the answer was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// A polynomial net, a tangent surface.
    Polynomial,
    /// Parallel end rulings.
    Cylinder,
    /// End rulings that meet.
    Cone,
    /// A rational net.
    Rational,
    /// Nets joined smoothly along rulings.
    Split,
}

/// What became of the question.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// The strips are regular and contain both lines.
    Solved(Route),
    /// As `Solved`, with a shorter first ruling than asked for.
    Shortened(Route),
    /// There is no regular answer among what was tried.
    Unsolved(Box<Reasons>),
}

impl Status {
    /// Whether there is a regular answer.
    pub fn is_solved(&self) -> bool {
        !matches!(self, Self::Unsolved(_))
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Interpolation {
    /// What became of the question.
    pub status: Status,
    /// The strips, in order along the curve: one, or several joined along rulings; none if unsolved.
    pub strips: Vec<Solution>,
    /// All polynomial nets whose M* lies outside the curve's domain, best first; also those that are not regular or
    /// lie on different sides.
    pub candidates: Vec<Solution>,
    /// The solvability of the polynomial problem; none for rational curves.
    pub solvability: Option<Solvability>,
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

/// Developable strips through `curve` whose first and last rulings lie on the given lines.
///
/// *Input*: the curve, homogeneous with positive weights (all equal for a polynomial one), mm; directions in mm.
/// *Guarantee*: strips of a solved answer are regular (see `Regularity`), hold both lines to 1e-9 rad, and both
/// first and last ruling point to the sides given. That no polynomial net exists is proven for the clamped control
/// points: also none of the same curve with more knots. *Not guaranteed*: that rational nets and splits, which are
/// searched on grids, are found whenever they exist, or are best.
/// *Departure*: strips that are regular with the wanted reach go before those with more clearance that are not.
/// *Cost*: cube of the number of control points for the polynomial; about 0.1 ms for 20 cubic pieces.
///
/// # Errors
/// See [`InterpolateError`].
pub fn interpolate(
    curve: &Curve<4>,
    rulings: &EndRulings,
    options: &Options,
) -> Result<Interpolation, InterpolateError> {
    let problem = Problem::new(curve, rulings, options)?;
    // 1. Polynomial nets, cylinders, cones.
    let (solvability, candidates, route) = polynomial::candidates(&problem);
    let mut answer = Interpolation { status: Status::Solved(route), strips: vec![], candidates, solvability };
    if let Some(best) = answer.candidates.iter().find(|s| s.is_good()) {
        answer.strips = vec![best.clone()];
        return Ok(answer);
    }
    // 2. A rational net.
    let by_rational = options.rational && !problem.coplanar();
    if by_rational {
        if let Some(found) = rational::best(&problem, options.reach) {
            answer.strips = vec![found];
            answer.status = Status::Solved(Route::Rational);
            return Ok(answer);
        }
    }
    // 3. The same, shorter.
    if options.shorten {
        let shorter = answer.candidates.iter().find_map(|s| polynomial::shortened(&problem, s));
        let shorter = shorter.map(|s| (s, route)).or_else(|| {
            let halves = (1..=SHORTENINGS).map(|k| options.reach * 0.5f64.powi(k));
            let found = halves.filter(|_| by_rational).find_map(|reach| rational::best(&problem, reach));
            found.map(|s| (s, Route::Rational))
        });
        if let Some((found, route)) = shorter {
            answer.strips = vec![found];
            answer.status = Status::Shortened(route);
            return Ok(answer);
        }
    }
    // 4. Two nets with a free ruling between them.
    if options.split {
        if let Some(parts) = split::best(&problem) {
            answer.strips = parts;
            answer.status = Status::Solved(Route::Split);
            return Ok(answer);
        }
    }
    if options.split && options.shorten {
        let shorter =
            Problem { options: Options { reach: SHORT_SPLIT * options.reach, ..*options }, ..problem.clone() };
        if let Some(parts) = split::best(&shorter) {
            answer.strips = parts;
            answer.status = Status::Shortened(Route::Split);
            return Ok(answer);
        }
    }
    // 5. The reasons.
    let reasons = reasons::reasons(&problem, answer.solvability.as_ref(), &answer.candidates);
    answer.status = Status::Unsolved(Box::new(reasons));
    Ok(answer)
}

/// The rational strip for one `m`, with the wanted first reach: what the choice of [`interpolate`] is made from. `None`
/// if the end rulings lie in a plane or the reach cannot be had.
///
/// *Not guaranteed*: regularity and positive weights, see [`Solution::regularity`]. A prescribed last reach is ignored.
///
/// # Errors
/// As [`interpolate`].
pub fn rational_for(
    curve: &Curve<4>,
    rulings: &EndRulings,
    options: &Options,
    m: f64,
) -> Result<Option<Solution>, InterpolateError> {
    let problem = Problem::new(curve, rulings, &Options { end_reach: None, ..*options })?;
    if problem.coplanar() {
        return Ok(None);
    }
    Ok(rational::net(&problem, m, options.reach).and_then(|net| candidate::measured(&problem, net)))
}

/// Share of the reach with which a split is tried once more.
const SHORT_SPLIT: f64 = 0.2;
/// How often the reach of a rational strip is halved.
const SHORTENINGS: i32 = 4;

impl Solution {
    /// Regular, with both end rulings on the sides given and of comparable lengths.
    pub fn is_good(&self) -> bool {
        let ratio = self.end_reach / self.start_reach;
        self.start_reach > 0.0
            && ratio > LEAST_RATIO
            && ratio < 1.0 / LEAST_RATIO
            && self.end_error < LARGEST_END_ERROR
            && self.regularity.holds()
    }
}

/// A question that can be asked: curve clamped, weights of a polynomial curve 1.
#[derive(Clone, Debug)]
struct Problem {
    curve: Curve<4>,
    polynomial: bool,
    /// Directions as given.
    v: Vec3,
    w: Vec3,
    /// `v × w`.
    normal: Vec3,
    options: Options,
}

impl Problem {
    fn new(curve: &Curve<4>, rulings: &EndRulings, options: &Options) -> Result<Self, InterpolateError> {
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
    fn part(&self, curve: Curve<4>, v: Vec3, w: Vec3, options: Options) -> Self {
        Self { curve, polynomial: self.polynomial, v, w, normal: v.cross(&w), options }
    }

    fn points(&self) -> Vec<Vec3> {
        self.curve.control.iter().map(affine).collect()
    }

    fn start(&self) -> Vec3 {
        affine(&self.curve.control[0])
    }

    fn end(&self) -> Vec3 {
        affine(&self.curve.control[self.curve.control.len() - 1])
    }

    fn parallel(&self) -> bool {
        self.normal.norm() <= PARALLEL * self.v.norm() * self.w.norm()
    }

    /// Whether the lines of the end rulings lie in a plane.
    fn coplanar(&self) -> bool {
        let chord = self.end() - self.start();
        self.parallel() || chord.dot(&self.normal).abs() <= MEETING * chord.norm() * self.normal.norm()
    }

    /// `(v × w)·(c_{i+1} − c_i)`, enclosed.
    fn deltas(&self) -> Vec<Interval> {
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
fn affine(x: &[f64; 4]) -> Vec3 {
    Vec3::new(x[0], x[1], x[2]) / x[3]
}
