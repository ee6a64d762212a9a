//! `planarise`: plane quadrilaterals from a strip that nearly has them, refined level by level.
//!
//! Reads like the page that describes it: planarise, refine and planarise again, judge every quadrilateral, develop.

#[cfg(test)]
mod tests;

use crate::answer::note::Note;
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Subject, UpperBound, What};
use crate::certify::quads::gap_bound;
use crate::control::Control;
use crate::design::discrete::planarise::{DiscreteError, Hold, PlanariseStatus};
use crate::design::discrete::subdivide::{subdivide, SubdivideOptions, Subdivided};
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::draw::field::{FieldMeaning, PanelField};
use crate::geom::box_tree::{nearest_on_triangle, BoxTree};
use crate::geom::coarse::{is_tolerance, Loose};
use crate::geom::unit::SQUARE_METRES;
use crate::geom::{BBox, Vec3};
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::reason::{JobReason, Reason, Stalled};
use crate::search::strips::cut::laid;
use crate::spline::SplineError;
use crate::torse::quad_strip::QuadStrip;
use std::time::Instant;

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between the diagonals of a quadrilateral, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// Levels of subdivision; default 0.
    pub levels: usize,
    /// Points that keep their places; default none.
    pub hold: Hold,
    /// Displacement allowed for given points by the first planarisation, and their distance allowed from the strip that comes
    /// out, mm; default none: any.
    pub most_move: Option<f64>,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            input: "strip".into(),
            levels: 0,
            hold: Hold::Nothing,
            most_move: None,
            drawn: Drawn::default(),
        }
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanariseError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A tolerance that is none.
    #[error("the tolerance {0} is not a positive finite length")]
    Tolerance(f64),
    /// Too much asked.
    #[error(transparent)]
    Discrete(#[from] DiscreteError),
    /// More parts than a report can show.
    #[error(
        "{levels} levels give {quads} quadrilaterals; files are written for at most {MOST_QUADS}: ask for fewer levels"
    )]
    Many {
        /// Levels asked for.
        levels: usize,
        /// Quadrilaterals there would be.
        quads: usize,
    },
    /// A quadrilateral that is no patch.
    #[error("a quadrilateral could not be made: {0}")]
    Patch(#[from] SplineError),
}

/// Most quadrilaterals for which files are written.
const MOST_QUADS: usize = 5000;
/// Bend (degrees) at which the scale of colours ends at least: what flat strips bend by is rounding.
const LEAST_BEND: f64 = 1e-6;

/// Plane quadrilaterals near a strip, judged and developed.
///
/// *Guarantee.* `Certified` only if the diagonals of every quadrilateral are proven to come within the tolerance of each
/// other ([`gap_bound`]), no regression point lies on the strip, given points moved no further than allowed, and every
/// part has a pattern. Everything else is `Uncertified` with the reason.
///
/// # Errors
/// A tolerance that is not positive, more levels than can be written.
///
/// # Example
/// ```
/// use torse::geom::Vec3;
/// use torse::torse::quad_strip::QuadStrip;
/// let side = |y: f64| (0..6).map(|k| Vec3::new(f64::from(k), y, 0.01 * y * f64::from(k))).collect();
/// let strip = QuadStrip::new(side(0.0), side(2.0))?;
/// let answer = torse::planarise(&strip, &torse::Planarise::new(1e-6), &torse::Control::default())?;
/// assert_eq!(answer.status(), torse::Status::Certified);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn planarise(strip: &QuadStrip, options: &Options, control: &Control) -> Result<Answer, PlanariseError> {
    let start = Instant::now();
    if !is_tolerance(options.tolerance) {
        return Err(PlanariseError::Tolerance(options.tolerance));
    }
    Loose::check(BBox::of(strip.a().iter().chain(strip.b())).diagonal(), options.tolerance)?;
    let shift = u32::try_from(options.levels).unwrap_or(u32::MAX);
    let quads = strip.quads().saturating_mul(1usize.checked_shl(shift).unwrap_or(usize::MAX));
    if quads > MOST_QUADS {
        return Err(PlanariseError::Many { levels: options.levels, quads });
    }
    control.report("planarising", 0.2, "");
    let done = subdivide(strip, &SubdivideOptions::new(options.levels, options.hold), control)?;
    control.report("developing", 0.6, "");
    assessed(strip, done, options, start)
}

fn assessed(given: &QuadStrip, done: Subdivided, options: &Options, start: Instant) -> Result<Answer, PlanariseError> {
    let result = &done.strip;
    let mut missing = Vec::new();
    let (mut each, mut fields, mut gaps) = (Vec::new(), Vec::new(), Vec::new());
    let strips = result.faces("A")?;
    for (i, s) in strips.iter().enumerate() {
        let gap = gap_bound(result, i);
        gaps.push(gap);
        let bends = [result.bend(i).to_degrees(), result.bend(i + 1).to_degrees()];
        let subject = Subject::Panel(i);
        each.extend([
            Claim::at_most(What::DiagonalGap, subject, gap),
            Claim::measured(What::RegressionClearance, subject, result.regression_clearance(i)),
            Claim::measured(What::BendBefore, subject, bends[0]),
            Claim::measured(What::Area, subject, s.area_estimate() * SQUARE_METRES),
        ]);
        // The ends have no neighbour to bend against; they show the bend of the other side.
        let (first, last) = (i == 0, i + 1 == strips.len());
        let before = if first { bends[1] } else { bends[0] };
        let after = if last { bends[0] } else { bends[1] };
        fields.push(PanelField { u: vec![0.0, 1.0], v: vec![0.0, 1.0], values: vec![before, before, after, after] });
    }
    if let Some(i) = result.crossing() {
        missing.push(JobReason::Crossing(i + 1));
    }
    let moved = done.levels.first().map_or(0.0, |l| l.largest_move);
    let given_distance = distance(given, result);
    let far = moved.max(given_distance);
    if let Some(most) = options.most_move.filter(|m| far > *m) {
        missing.push(JobReason::Moved(far, most));
    }
    if done.levels.len() <= options.levels {
        missing.push(JobReason::Levels(done.levels.len() - 1, options.levels));
    }
    let notes = done.levels.iter().enumerate().map(|(level, l)| Note::Level { level, report: *l }).collect();
    let flat = StripOptions::of_job(options.tolerance, [None; 2], options.drawn);
    let chain = Part::new("A", 0, strips.len());
    let laid = laid(&strips, &[chain], &flat, options.tolerance);
    let clearance = (0..result.quads()).map(|i| result.regression_clearance(i)).fold(f64::INFINITY, f64::min);
    let largest_bend = (1..result.quads()).map(|i| result.bend(i).abs().to_degrees()).fold(0.0, f64::max);
    let whole = Subject::Whole;
    let gap = UpperBound::largest(gaps);
    let mut claims = vec![
        Claim::at_most(What::DiagonalGap, whole, gap)
            .within(options.tolerance)
            .because(Reason::from(JobReason::Diagonals(gap.value(), stalled(&done, options.hold)))),
        Claim::measured(What::PointsMoved, whole, moved),
        Claim::measured(What::GivenDistance, whole, given_distance),
        Claim::measured(What::RegressionClearance, whole, clearance),
        Claim::measured(What::LargestBend, whole, largest_bend),
        Claim::count(Counted::Quadrilaterals, whole, strips.len()),
    ];
    claims.extend(laid.claims());
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(each);
    let guide = |name: &str, points: &[Vec3]| Guide { name: name.into(), points: points.to_vec() };
    Ok(Answer {
        claims,
        patchwork: Patchwork::of_strips(strips),
        fields,
        meaning: FieldMeaning { name: "bend".into(), unit: "°".into(), limit: largest_bend.max(LEAST_BEND) },
        guides: vec![guide("first polyline", given.a()), guide("second polyline", given.b())],
        notes,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::of_flat(Job::Planarise, &options.input, options.tolerance, laid)
    })
}

/// Largest distance of the given points from a strip of plane quadrilaterals, mm.
fn distance(given: &QuadStrip, strip: &QuadStrip) -> f64 {
    let triangle = |k: usize| {
        let ([a, b], [c, d]) = (strip.ruling(k / 2), strip.ruling(k / 2 + 1));
        if k.is_multiple_of(2) {
            [a, b, c]
        } else {
            [d, c, b]
        }
    };
    let off = |x: &Vec3, k: usize| {
        let (corners, at) = (triangle(k), nearest_on_triangle(x, triangle(k)));
        (corners[0] * at[0] + corners[1] * at[1] + corners[2] * at[2] - x).norm_squared()
    };
    let tree = BoxTree::new(2 * strip.quads(), &|k| BBox::of(&triangle(k)));
    let nearest = |x: &Vec3| tree.nearest(x, &|k| off(x, k)).map_or(0.0, |found| found.1.sqrt());
    given.a().iter().chain(given.b()).map(nearest).fold(0.0, f64::max)
}

/// Why planarisation did not end with plane quadrilaterals.
fn stalled(done: &Subdivided, hold: Hold) -> Option<Stalled> {
    match (done.levels.iter().find(|l| l.status != PlanariseStatus::Plane).map(|l| l.status), hold) {
        (Some(PlanariseStatus::Stalled), Hold::Nothing) => Some(Stalled::Rulings),
        (Some(PlanariseStatus::Stalled), _) => Some(Stalled::Held),
        (Some(PlanariseStatus::StepLimit), _) => Some(Stalled::Steps),
        _ => None,
    }
}
