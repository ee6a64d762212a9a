//! What a loft is asked for.

use crate::develop::view::Drawn;
use crate::search::strips::assessment::TWIST_TOLERANCE;
pub use crate::search::strips::loft_ends::{Ends, Extension};

/// How rulings are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// An exact branch where one covers enough of the rails, else least twist.
    #[default]
    Auto,
    /// An exact branch, or an error.
    Exact,
    /// The strip of least twist.
    LeastTwist,
}

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between strips and rails, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// See [`Ends`]; default fan: both rails are used whole.
    pub ends: Ends,
    /// See [`Extension`]; default curve.
    pub extension: Extension,
    /// See [`Choice`]; default auto.
    pub choice: Choice,
    /// Which of the branches found, or of the strips of least twist where there is none or these are asked for, best
    /// first, from 1; default 1.
    pub alternative: usize,
    /// Rulings to be used, as shares of both rails' lengths; default none. With any, the strip of least twist is made.
    pub fixed: Vec<[f64; 2]>,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the rails, mm; default none: 8 over the length.
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
            input: "loft".into(),
            ends: Ends::Fan,
            extension: Extension::Curve,
            choice: Choice::Auto,
            alternative: 1,
            fixed: Vec::new(),
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: TWIST_TOLERANCE,
            drawn: Drawn::default(),
        }
    }
}
