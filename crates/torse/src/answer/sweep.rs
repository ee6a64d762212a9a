//! What one tolerance costs.

/// Result of the main job at one tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepRow {
    /// Tolerance, mm.
    pub tolerance: f64,
    /// Number of panels.
    pub panels: usize,
    /// Length of all seams (each counted once, mean of its two sides), mm.
    pub seam_length: f64,
    /// Estimate of the fewest bands, where a strip potential covers every face; covers can have fewer.
    pub theory_estimate: Option<f64>,
    /// Whether the result is certified.
    pub certified: bool,
    /// Wall time, seconds.
    pub seconds: f64,
}
