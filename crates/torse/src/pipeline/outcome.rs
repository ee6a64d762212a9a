//! What the main job answers with: everything that files and reports are made from.

use crate::certify::Certificate;
use crate::surface::panel::Patchwork;
use crate::surface::pattern::Pattern;

/// How the job ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Status {
    /// Everything proven within the tolerance.
    Certified,
    /// Finished, but something is not proven or exceeds the tolerance; the reason in plain words.
    Uncertified(String),
}

/// A face (or other item) of the input that could not be used.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// Entity number in the file.
    pub entity: u64,
    /// Why, and what would help.
    pub reason: String,
}

/// The answer to `approximate`: panels, proof, flat patterns.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of the input, without folder.
    pub input: String,
    /// Tolerance asked for, mm.
    pub tolerance: f64,
    /// How the job ended.
    pub status: Status,
    /// Faces, panels and seams.
    pub patchwork: Patchwork,
    /// The proof.
    pub certificate: Certificate,
    /// Flat patterns, one per panel in order, not yet laid out side by side (each near its own origin).
    pub patterns: Vec<Pattern>,
    /// Faces that could not be read or used.
    pub skipped: Vec<Skipped>,
    /// Panels that were laid along curves, in order of the panels.
    pub along: Vec<AlongCurve>,
    /// Wall time of reading, fitting and proving, seconds.
    pub seconds: f64,
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
    /// Fewest bands that theory allows, where a level function covers every face.
    pub limit: Option<f64>,
    /// Whether the result is certified.
    pub certified: bool,
    /// Wall time, seconds.
    pub seconds: f64,
}
