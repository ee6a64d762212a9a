//! What the main job answers with: everything that files and reports are made from.

use crate::certify::claim::{Claim, Status};
use crate::certify::flat::FlatCertificate;
use crate::certify::written::WrittenCertificate;
use crate::certify::Certificate;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::pattern::Pattern;

/// A face of the input, or an item that may hold faces, that is missing from the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// Entity number in the file.
    pub entity: u64,
    /// Why, and what would help.
    pub reason: String,
    /// Area (mm²) of all its occurrences, as far as surface or edges tell; `None` if unknown.
    pub area_estimate: Option<f64>,
}

/// What is missing from an answer, as an objection: such an answer is never certified, however good the rest is. `None`
/// if nothing is missing.
pub fn left_out(skipped: &[Skipped]) -> Option<Claim> {
    let first = skipped.first()?;
    let (what, more) = match skipped.len() {
        1 => ("1 face or item of the file is".to_string(), ""),
        n => (format!("{n} faces or items of the file are"), ", the first"),
    };
    let known: f64 = skipped.iter().filter_map(|s| s.area_estimate).sum();
    let known = if known < 100.0 { format!("{known:.4}") } else { format!("{known:.0}") };
    let area = match skipped.iter().filter(|s| s.area_estimate.is_none()).count() {
        0 => format!("about {known} mm²"),
        n if n == skipped.len() => "of unknown area".to_string(),
        n => format!("about {known} mm², {n} of them of unknown area"),
    };
    let words = format!("{what} left out ({area}){more} #{}: {}", first.entity, first.reason);
    Some(Claim::left_out(words))
}

/// The answer to `approximate`: panels, proof, flat patterns.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of the input, without folder.
    pub input: String,
    /// Tolerance asked for, mm.
    pub tolerance: f64,
    /// What is said of the result; the status is computed from these.
    pub claims: Vec<Claim>,
    /// Faces, panels and seams.
    pub patchwork: Patchwork,
    /// The proof.
    pub certificate: Certificate,
    /// Flat patterns, one per panel in order, not yet laid out side by side (each near its own origin).
    pub patterns: Vec<Pattern>,
    /// What was proven about the flat patterns, in the same order.
    pub flat: Vec<FlatCertificate>,
    /// Files that were read back, by name, and whether they hold what was judged; empty before anything is written.
    pub written: Vec<(String, WrittenCertificate)>,
    /// Faces that could not be read or used.
    pub skipped: Vec<Skipped>,
    /// What people should know of the file and the job, in plain words.
    pub notes: Vec<String>,
    /// Panels that were laid along curves, in order of the panels.
    pub along: Vec<AlongCurve>,
    /// Panels that do not keep the limits of sheet and material, in order.
    pub beyond_limits: Vec<usize>,
    /// Wall time of reading, fitting and proving, seconds.
    pub seconds: f64,
}

impl Outcome {
    /// How the job ended.
    pub fn status(&self) -> Status {
        Status::of(&self.claims)
    }
}

/// A panel that was laid along a curve of the user, or on the front that set out from it.
#[derive(Clone, Debug, PartialEq)]
pub struct AlongCurve {
    /// Index of the panel.
    pub panel: usize,
    /// Name of the curve.
    pub curve: String,
    /// Strips between the curve and the panel: 0 for the panel along the curve itself.
    pub step: usize,
    /// Distance found by the comparison of the paper on curves (matching points at equal parameters), mm. Sampled.
    pub paper_estimate: f64,
}

/// What one tolerance costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepRow {
    /// Tolerance, mm.
    pub tolerance: f64,
    /// Number of panels.
    pub panels: usize,
    /// Length of all seams (each counted once, mean of its two sides), mm.
    pub seam_length: f64,
    /// Estimate of the fewest bands, where a level function covers every face; covers can have fewer.
    pub limit: Option<f64>,
    /// Whether the result is certified.
    pub certified: bool,
    /// Wall time, seconds.
    pub seconds: f64,
}
