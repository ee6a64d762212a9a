//! What the job is asked, and why there is no answer at all.

use crate::develop::view::Drawn;
use crate::fit::elements::given::FEWEST;
use crate::fit::planes::estimates::EstimateError;
use crate::geom::coarse::{Coarse, Loose};
use crate::search::strips::sequences::StripsAsked;
use crate::torse::zone::{LimitsError, RegressionLimits};

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementFitOptions {
    /// Largest distance of a ruling, or of a plane over its region of interest, from the strips, mm.
    pub tolerance: f64,
    /// Name of the input, for files.
    pub input: String,
    /// Strips at most; 64.
    pub max_strips: usize,
    /// Rulings taken from each face; 160.
    pub rulings_of_face: usize,
    /// What is asked of regression curves; nothing beyond regular strips.
    pub limits: Option<RegressionLimits>,
    /// Whether the first and the last element of each strip are kept exactly; false.
    pub fix_ends: bool,
    /// Weight of bending against the data as a share; none: strips follow the data.
    pub smoothing: Option<f64>,
    /// Whether elements far from a surface that most of the others agree on are left out and named; false.
    pub robust: bool,
    /// Largest angle between tangent planes that are given with rulings and those of the strips, rad; 5°: planes of
    /// measured rulings are known to a few degrees, and others that are farther off belong to another surface.
    pub plane_angle: f64,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

/// Angle (rad) between given and fitted tangent planes that is allowed where nothing else is said: 5°.
const ASIDE: f64 = 5.0 * std::f64::consts::PI / 180.0;

impl ElementFitOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64, input: &str) -> Self {
        Self {
            tolerance,
            input: input.into(),
            max_strips: 64,
            rulings_of_face: 160,
            limits: None,
            fix_ends: false,
            smoothing: None,
            robust: false,
            plane_angle: ASIDE,
            drawn: Drawn::default(),
        }
    }

    /// What strips of sequences must be like.
    pub(super) fn asked(&self) -> StripsAsked {
        let Self { tolerance, fix_ends, smoothing, .. } = *self;
        StripsAsked { tolerance, limits: self.limits.clone(), fix_ends, smoothing }
    }
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementFitError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive length")]
    Tolerance(f64),
    /// Limits of the regression curve that cannot be kept by anything.
    #[error(transparent)]
    Limits(#[from] LimitsError),
    /// Too few elements.
    #[error("{0} {1}: at least {FEWEST} are needed")]
    Few(usize, &'static str),
    /// An element that cannot be used.
    #[error("plane {index} has a coordinate that is not finite, no normal, no region of interest, or a weight that is not positive")]
    Element {
        /// Its index.
        index: usize,
    },
    /// Two neighbours are the same.
    #[error("{what} {index} repeats the one before: remove it")]
    Repeated {
        /// Rulings or planes.
        what: &'static str,
        /// Index of the second one.
        index: usize,
    },
    /// Coordinates so large that their last digits are coarser than the tolerance.
    #[error(transparent)]
    Coarse(#[from] Coarse),
    /// Tangent planes of rulings cannot be estimated.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// No face can be used.
    #[error("none of the {count} faces is a ruled developable surface; the first: {reason}")]
    NoFace {
        /// Number of faces.
        count: usize,
        /// Why the first is not.
        reason: String,
    },
}
