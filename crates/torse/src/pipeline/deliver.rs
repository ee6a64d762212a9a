//! Results into files: what holds geometry is written, read back and compared with what was judged; then pictures and
//! reports, which tell what came of it.

use super::cone_shapes;
use super::cones::ConesOutcome;
use crate::answer::marks::Marks;
use crate::answer::outcome::Outcome;
use crate::answer::presentation::{present_marked, present_sheets_marked};
use crate::answer::sheets::Sheets;
use crate::certify::claim::{Claim, Demand, Evidence, Subject, UpperBound, What};
use crate::certify::written::{self, WrittenCertificate};
use crate::certify::written_strips;
use crate::io::bundle::{self, BundleError, File};
use crate::io::{cones, drawings, sheets, step};
use crate::patchwork::pattern::Pattern;
use rayon::prelude::*;

/// All files of the main job's answer. `time` stamps the STEP header: `2026-11-21T14:30:00`.
///
/// *Guarantee*: the answer stays certified only if the bytes of the files, read back, are what was judged.
///
/// # Errors
/// Data that a format cannot hold.
pub fn files(outcome: &mut Outcome, time: &str) -> Result<Vec<File>, BundleError> {
    // Marks are no part of what is judged: first as if there were none, then with those that came of it.
    let mut shown = present_marked(outcome, Marks::none(outcome));
    let mut geometry = bundle::geometry(outcome, &shown, time)?;
    judge(outcome, &geometry);
    let marks = Marks::of(outcome);
    if marks.any() {
        shown = present_marked(outcome, marks);
        geometry = bundle::geometry(outcome, &shown, time)?;
    }
    bundle::with_reports(outcome, &shown, geometry)
}

/// Compares files with what was judged; what does not agree, or is off by more than the tolerance leaves, ends the
/// certificate.
pub fn judge(outcome: &mut Outcome, files: &[File]) {
    outcome.written = files
        .par_iter()
        .filter_map(|(name, bytes)| {
            let found = if name.ends_with(".step") {
                let faces = step::read::own::faces(bytes);
                written::of(faces, |faces| written::panels(&outcome.patchwork, faces))
            } else {
                drawing(name, bytes, &outcome.patterns)?
            };
            Some((name.clone(), found))
        })
        .collect();
    outcome.claims.extend(outcome.written.iter().map(|(_, found)| found.claim()));
    // What the patterns are off already; panels have what writing moves among their bounds.
    let drawn = outcome.flat.iter().map(|f| f.drawing_bound()).fold(0.0, f64::max);
    for (name, found) in &outcome.written {
        let reason = if !found.reason().is_empty() {
            format!("{name}: {}", found.reason())
        } else if !name.ends_with(".step") && drawn + found.bound() > outcome.tolerance {
            format!("{name} is {:.3e} mm from the patterns that were judged", found.bound())
        } else {
            continue;
        };
        outcome.claims.push(Claim::objection(Subject::Whole, reason));
    }
}

/// All files of the answer of a job that makes strips. `time` stamps the STEP header.
///
/// *Guarantee*: the answer stays certified only if the bytes of the files, read back, are what was judged.
///
/// # Errors
/// Data that a format cannot hold.
pub fn strip_files(answer: &mut Sheets, time: &str) -> Result<Vec<File>, BundleError> {
    let mut shown = present_sheets_marked(answer, Marks::none_of_sheets(answer));
    let mut geometry = sheets::geometry(answer, &shown, time)?;
    judge_strips(answer, &geometry);
    let marks = Marks::of_sheets(answer);
    if marks.any() {
        shown = present_sheets_marked(answer, marks);
        geometry = sheets::geometry(answer, &shown, time)?;
    }
    sheets::with_reports(answer, &shown, geometry)
}

/// All files of cones; as [`strip_files`], but that the faces of the CAD file, cones and cylinders by their axes, are not
/// read back.
///
/// # Errors
/// Data that a format cannot hold.
pub fn cone_files(answer: &mut ConesOutcome, time: &str) -> Result<Vec<File>, BundleError> {
    let mut shown = cone_shapes::present_marked(answer, Marks::none_of_sheets(&answer.sheets));
    let mut geometry = cones::geometry(&answer.sheets, &answer.bodies, &shown, time)?;
    judge_strips(&mut answer.sheets, &geometry);
    let marks = Marks::of_sheets(&answer.sheets);
    if marks.any() {
        shown = cone_shapes::present_marked(answer, marks);
        geometry = cones::geometry(&answer.sheets, &answer.bodies, &shown, time)?;
    }
    sheets::with_reports(&answer.sheets, &shown, geometry)
}

/// What a drawing may be off its patterns, which are measured, as a share of the tolerance.
const DRAWN_SHARE: f64 = 1e-3;

/// Compares files of strips with what was judged; what does not agree, or takes a proven distance beyond its limit, ends
/// the certificate.
pub fn judge_strips(answer: &mut Sheets, files: &[File]) {
    let judged: Vec<(&str, WrittenCertificate)> = files
        .par_iter()
        .filter_map(|(name, bytes)| {
            let found = if name == sheets::STRIPS {
                let faces = step::read::own::strips(bytes);
                written::of(faces, |faces| written_strips::strips(&answer.strips, faces))
            } else {
                drawing(name, bytes, &answer.patterns)?
            };
            Some((name.as_str(), found))
        })
        .collect();
    let worst = UpperBound::largest(judged.iter().map(|(_, found)| found.proven()));
    let mut objections = Vec::new();
    for (name, found) in &judged {
        let off = format!("{name} is {:.3e} mm from what was judged", found.bound());
        let reason = if !found.reason().is_empty() {
            Some(format!("{name}: {}", found.reason()))
        } else if *name == sheets::STRIPS {
            answer.claims.iter().any(|c| breaks(c, found.bound())).then_some(off)
        } else {
            (found.bound() > DRAWN_SHARE * answer.tolerance).then_some(off)
        };
        objections.extend(reason.map(|r| Claim::objection(Subject::Whole, r)));
    }
    answer.claims.push(Claim::at_most(What::WrittenDistance, Subject::Whole, worst));
    answer.claims.extend(objections);
}

/// Whether a proven distance that keeps to its limit would not any more if the strips moved by `off` (mm).
fn breaks(claim: &Claim, off: f64) -> bool {
    let distance = matches!(
        claim.what(),
        What::FromCurve(_) | What::FromSide(_) | What::FromCurves | What::PointDistance | What::ElementDistance
    );
    match claim.demand() {
        Demand::AtMost(limit) if distance && claim.evidence() == Evidence::Proven && !claim.is_broken() => {
            claim.value() + off > limit
        }
        _ => false,
    }
}

/// A cutting drawing against its patterns; `None` for files that are none. For every job that writes drawings.
pub fn drawing(name: &str, bytes: &[u8], patterns: &[Pattern]) -> Option<WrittenCertificate> {
    let pieces = if name.ends_with(".dxf") {
        drawings::dxf(bytes)
    } else if name.ends_with(".svg") {
        drawings::svg(bytes)
    } else {
        return None;
    };
    Some(written::of(pieces, |pieces| written::drawing(patterns, pieces)))
}
