//! Results into files: what holds geometry is written, read back and compared with what was judged; then pictures and
//! reports, which tell what came of it.

use crate::answer::marks::Marks;
use crate::answer::outcome::Outcome;
use crate::answer::presentation::present_marked;
use crate::certify::claim::{Claim, Subject};
use crate::certify::written::{self, WrittenCertificate};
use crate::io::bundle::{self, BundleError, File};
use crate::io::{drawings, step};
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
