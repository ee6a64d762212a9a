//! What the job is asked for, and why there is no answer.

use crate::design::composite::{At, CompositeError};
use crate::develop::view::Drawn;
use crate::geom::coarse::Loose;
use crate::search::strips::assessment::TWIST_TOLERANCE;
use crate::spline::SplineError;

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between held places and their targets, and between fixed curves and strips, mm; no default.
    pub tolerance: f64,
    /// Name of the input for reports.
    pub input: String,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
    /// Angle between tangent planes that counts as none where strips should go on smoothly, rad; default 0.1°.
    pub smooth_angle: f64,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the rails, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

/// Angle (rad) that counts as none at smooth joins: 0.1°, what car makers allow between patches of their visible surfaces.
const SMOOTH_ANGLE: f64 = 0.1 * std::f64::consts::PI / 180.0;

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            input: "shape".into(),
            twist_tolerance: TWIST_TOLERANCE,
            smooth_angle: SMOOTH_ANGLE,
            ruling_spacing: None,
            mark_spacing: None,
            drawn: Drawn::default(),
        }
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A tolerance that is none.
    #[error("the tolerance {0} is not a positive finite length")]
    Tolerance(f64),
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A composite that cannot be set up.
    #[error("{}{source}", .source.at().map(At::path).map_or(String::new(), |p| p + ": "))]
    Composite {
        /// Why.
        source: CompositeError,
    },
    /// Strips of another file that cannot be taken.
    #[error("$.from[{index}]: {reason}")]
    From {
        /// Its index.
        index: usize,
        /// Why, and what would help.
        reason: String,
    },
    /// A target that cannot be read.
    #[error("$.targets[{index}]: {reason}")]
    Target {
        /// Its index.
        index: usize,
        /// Why.
        reason: String,
    },
    /// A move that cannot be made.
    #[error("$.moves[{index}]: {source}")]
    Move {
        /// Its index.
        index: usize,
        /// Why.
        source: CompositeError,
    },
    /// A move from one direction to the opposite one.
    #[error(
        "$.moves[{index}]: the tangent is to turn to the opposite direction, and there is no telling which way round; make it \
         two moves, the first to a direction between them"
    )]
    Opposite {
        /// Its index.
        index: usize,
    },
    /// A strip without a spline.
    #[error("a strip could not be made: {0}")]
    Spline(#[from] SplineError),
}

impl From<CompositeError> for ShapeError {
    fn from(source: CompositeError) -> Self {
        Self::Composite { source }
    }
}
