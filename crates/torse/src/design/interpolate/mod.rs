//! The developable through a curve with given first and last ruling.
//!
//! *Method.* \[FJ07\], section 4, with the existence question closed. A polynomial net exists exactly for the roots of
//! the solvability polynomial ([`solvability`]); those with a regular surface are isolated with certainty, and the best
//! is chosen. Where there is none: a rational net, which meets the two lines for every M* (`rational`); then two nets
//! that share a ruling in between (`split`); then the reasons (`Reasons`).

mod candidate;
mod polynomial;
mod problem;
mod rational;
mod reasons;
mod solution;
mod solvability;
mod split;

#[cfg(test)]
mod tests;

use problem::Problem;
pub use problem::{EndRulings, InterpolateError, Options};
pub use reasons::Quality;
pub(crate) use reasons::Reasons;
pub use reasons::Turn;
pub use solution::{Route, Solution};
pub use solvability::solvability;
pub(crate) use solvability::Solvability;

use crate::spline::curve::Curve;

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
