//! What the job of cones is asked.

use crate::develop::view::Drawn;

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct ConesOptions {
    /// Distance allowed between surface and cones, both ways, mm.
    pub tolerance: f64,
    /// Name of the input, for the files.
    pub input: String,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl ConesOptions {
    /// A tolerance (mm) and the name of the input; the rest as by default.
    pub fn new(tolerance: f64, input: impl Into<String>) -> Self {
        Self { tolerance, input: input.into(), drawn: Drawn::default() }
    }
}
