//! Why a part of a face has no ruled strips \[W15, 2C\].

use crate::fit::panels::boundary::BoundaryError;
use crate::geom::{place_in_words, Vec3};

/// A part of a face, by a place in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Around {
    /// Entity number of the face.
    pub entity: u64,
    /// A place in the middle, mm.
    pub middle: Vec3,
}

impl std::fmt::Display for Around {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a piece of face #{} around {}", self.entity, place_in_words(&self.middle))
    }
}

/// Why a part of a face has no strips.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum LeftOut {
    /// It bends to one side.
    #[error(
        "{percent:.1} % of face #{entity} bend to one side (positive curvature), where no straight lines lie \
         near: cover it with developable panels (torse approximate), or allow a larger tolerance"
    )]
    Domed {
        /// Entity number of the face.
        entity: u64,
        /// Share of its area.
        percent: f64,
    },
    /// Next to nothing.
    #[error("a sliver of face #{entity} beside the change of curvature")]
    Sliver {
        /// Entity number of the face.
        entity: u64,
    },
    /// No directions for rulings.
    #[error("{around}: no net of curves for rulings was found (they turn too far); cut it there into several faces")]
    NoNet {
        /// Which piece.
        around: Around,
    },
    /// More strips than are tried.
    #[error("{around}: {most} strips are not enough; allow a larger tolerance or width, or cut it into several faces")]
    Many {
        /// Which piece.
        around: Around,
        /// Most strips that are tried.
        most: usize,
    },
    /// A strip that does not lie near the face as one sheet.
    #[error("{around}: a strip has no map to its face")]
    NoMap {
        /// Which piece.
        around: Around,
    },
    /// A panel without a border.
    #[error("{around}: {source}")]
    Border {
        /// Which piece.
        around: Around,
        /// Why.
        source: BoundaryError,
    },
    /// Strips of which nothing is known.
    #[error(
        "{around}: strips were found, but nothing bounds how far they are from the face; cut it there into several faces, or \
         allow a larger tolerance"
    )]
    Unbounded {
        /// Which piece.
        around: Around,
    },
    /// Time ran out.
    #[error("{around}: ended early, before it had strips")]
    Stopped {
        /// Which piece.
        around: Around,
    },
}
