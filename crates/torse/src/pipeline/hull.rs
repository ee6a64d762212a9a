//! `hull`: developables on the boundary of the convex hull of curves.
//!
//! Reads like the page that describes it: find the rulings on which the hull rests, make exact strips along them, have
//! rails and twist judged, develop.

#[cfg(test)]
mod tests;

use crate::answer::note::Note;
use crate::answer::skipped::Skipped;
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Subject, UpperBound};
use crate::control::Control;
use crate::design::hull::needless::needless;
use crate::design::hull::HullError;
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::geom::coarse::{is_tolerance, Loose};
use crate::patchwork::panel::Patchwork;
use crate::reason::{JobReason, StripReason};
use crate::search::strips::assessment::TWIST_TOLERANCE;
use crate::search::strips::cut::laid_until;
use crate::search::strips::hull_followed::{judged, Asked, Judged};
use crate::search::strips::hull_kept::Kept;
use crate::torse::rail::Rail;
use std::time::Instant;

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between strips and curves, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// Points per curve with which the search begins; default 256.
    pub samples: usize,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the curves, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            input: "hull".into(),
            samples: 256,
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: TWIST_TOLERANCE,
            drawn: Drawn::default(),
        }
    }
}

/// Strips of one span each that are written within a second; more are not written once the job was asked to stop.
const SOON: usize = 2000;
/// Share of the tolerance by which a curve that is left out, since it lies on the hull of its neighbours, may come out of that
/// hull of samples, and by which these may miss it.
const NEEDLESS_SHARE: f64 = 0.05;

/// The developables on the boundary of the convex hull of curves, judged and developed. Planar pieces bounded by a
/// single planar curve are left open, and named.
///
/// *Guarantee.* `Certified` only if every strip's rails are proven to lie within the tolerance of the curves, and curves
/// beyond the last rulings before tips within it of these, its twist
/// is proven to stay below `twist_tolerance`, no ruling meets the regression curve between its ends (proven), and every
/// part has a pattern, and only if strips and the hull of points on the curves are near each other, which is measured.
/// *Not guaranteed*: that features finer than the samples are seen.
///
/// # Errors
/// No curves, curves in one plane, a tolerance that is not positive.
///
/// # Example
/// ```
/// use torse::io::curves::CurveOptions;
/// let square = include_bytes!("../../../../data/duct_square.dxf");
/// let round = include_bytes!("../../../../data/duct_round.dxf");
/// let curves = [
///     torse::read_curve(square, &CurveOptions::new("square"))?.0,
///     torse::read_curve(round, &CurveOptions::new("round"))?.0,
/// ];
/// let answer = torse::hull(&curves, &torse::Hull::new(0.1), &torse::Control::default())?;
/// assert_eq!(answer.status(), torse::Status::Certified);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hull(curves: &[Rail], options: &Options, control: &Control) -> Result<Answer, HullError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !is_tolerance(tolerance) {
        return Err(HullError::Tolerance(tolerance));
    }
    Loose::check(Rail::extent(&curves.iter().collect::<Vec<_>>()), tolerance)?;
    let needless = needless(curves, NEEDLESS_SHARE * tolerance);
    let needed = |k: &usize| !needless.contains(k);
    let kept: Vec<Rail> = (0..curves.len()).filter(needed).map(|k| curves[k].clone()).collect();
    let mut answer = of_needed(&kept, options, control)?;
    for curve in needless.into_iter().map(|k| &curves[k]) {
        answer.guides.push(Guide::of(curve));
        answer.notes.push(Note::Inside { curve: curve.name.clone() });
    }
    Ok(Answer { seconds: start.elapsed().as_secs_f64(), ..answer })
}

/// The same of curves of which none lies on the hull of others.
fn of_needed(curves: &[Rail], options: &Options, control: &Control) -> Result<Answer, HullError> {
    let tolerance = options.tolerance;
    let asked = Asked { samples: options.samples, tolerance, twist: options.twist_tolerance };
    let Judged { lids, used, mut kept, apart } = judged(curves, &asked, control)?;
    let mut notes = notes(curves, &lids, &used);
    if !kept.tips.is_empty() {
        let within = UpperBound::largest(kept.tips.iter().copied()).value();
        notes.push(Note::Tips { count: kept.tips.len(), within });
    }
    notes.extend(kept.closed.iter().map(|part| Note::CutOpen { part: Some(part.clone()) }));
    let flat = StripOptions::of_job(options.tolerance, [options.ruling_spacing, options.mark_spacing], options.drawn);
    let lay = |kept: &Kept| laid_until(&kept.strips, &kept.parts, &flat, tolerance, control);
    let mut laid = (!is_too_long(&kept, control)).then(|| lay(&kept));
    // Asked to stop before parts are laid flat, or meanwhile.
    if is_too_long(&kept, control) {
        let found = kept.strips.len();
        kept = Kept { skipped: kept.skipped, ..Kept::default() };
        kept.missing.push(StripReason::TooMany(found).into());
        laid = None;
    }
    let laid = laid.unwrap_or_else(|| lay(&kept));
    notes.extend(laid.crowded.iter().copied().map(Note::Crowded));
    let whole = Subject::Whole;
    let mut claims = kept.claims;
    claims.push(Claim::count(Counted::Strips, whole, kept.strips.len()));
    claims.extend(laid.claims());
    let stopped = control.stopped().then(|| JobReason::Stopped.into());
    let apart = apart.map(|(by, at)| StripReason::NotTheHull { by, at }.into());
    claims.extend(kept.missing.into_iter().chain(apart).chain(stopped).map(|reason| Claim::objection(whole, reason)));
    claims.extend(kept.of_strips);
    Ok(Answer {
        claims,
        patchwork: Patchwork::of_strips(kept.strips),
        fields: kept.fields,
        meaning: kept.meaning,
        guides: curves.iter().map(Guide::of).collect(),
        notes,
        skipped: kept.skipped.into_iter().map(Skipped::from).collect(),
        ..Answer::of_flat(Job::Hull, &options.input, options.tolerance, laid)
    })
}

/// Whether the job was asked to stop and has more strips than are written soon.
fn is_too_long(kept: &Kept, control: &Control) -> bool {
    // A span costs about a tenth of a strip.
    let spans: usize = kept.strips.iter().map(|s| s.patch.knots_u.breaks().len() - 1).sum();
    control.stopped() && kept.strips.len() + spans / 10 > SOON
}

/// What people should know of the search: curves with planar pieces, and those that no strip lies along.
fn notes(curves: &[Rail], lids: &[(usize, bool)], used: &[bool]) -> Vec<Note> {
    let lid = |&(r, whole): &(usize, bool)| Note::Lid { curve: curves[r].name.clone(), whole };
    let inside =
        curves.iter().zip(used).filter(|(_, used)| !**used).map(|(c, _)| Note::Inside { curve: c.name.clone() });
    lids.iter().map(lid).chain(inside).collect()
}
