//! What a fit of points is asked for.

use crate::develop::view::Drawn;
use crate::torse::zone::RegressionLimits;

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// Largest distance of a measured point from the strips, mm.
    pub tolerance: f64,
    /// Name of the input, for files.
    pub input: String,
    /// Places at which the surface is estimated; 3000.
    pub places: usize,
    /// Strips at most; 64.
    pub max_strips: usize,
    /// What is asked of regression curves; nothing beyond regular strips.
    pub limits: Option<RegressionLimits>,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl FitOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64, input: &str) -> Self {
        Self { tolerance, input: input.into(), places: 3000, max_strips: 64, limits: None, drawn: Drawn::default() }
    }
}
