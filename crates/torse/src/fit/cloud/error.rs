//! Why points cannot be fitted at all.

use crate::geom::coarse::{Coarse, Loose};
use crate::torse::zone::LimitsError;

/// Points without which no surface is looked for.
pub(crate) const FEWEST: usize = 30;

/// Why points cannot be fitted at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CloudError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// Too few points.
    #[error("{0} points: at least {least} are needed", least = FEWEST)]
    Few(usize),
    /// Points that fill space instead of covering a surface.
    #[error(
        "the {points} points do not look like a surface at any of {places} places: they fill space, or are too sparse"
    )]
    NoSurface {
        /// Number of points.
        points: usize,
        /// Places looked at.
        places: usize,
    },
    /// A coordinate that is not finite.
    #[error("point {index} has the coordinate {value}, which is not a finite number")]
    NotFinite {
        /// Index of the point.
        index: usize,
        /// The value.
        value: f64,
    },
    /// All points coincide or lie in a line.
    #[error("all points lie in one {what} (within {within:.1e} mm; they reach over {size:.1e} mm): a surface is not determined")]
    Thin {
        /// Place or line.
        what: &'static str,
        /// Mean distance from it, mm.
        within: f64,
        /// Extent of the points, mm.
        size: f64,
    },
    /// Coordinates so large that their last digits are coarser than the tolerance.
    #[error(transparent)]
    Coarse(#[from] Coarse),
    /// Limits of the regression curve that cannot be kept by anything.
    #[error(transparent)]
    Limits(#[from] LimitsError),
    /// A tolerance that is not a positive number.
    #[error("the tolerance {0} is not a positive length")]
    Tolerance(f64),
}
