//! How a question about a region ends: the words that all proofs share \[certificate\].

pub use crate::reason::Obstruction;

/// Whether a statement was proven, or how it failed.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The distance stays below `bound` (mm) at every point.
    Holds {
        /// Proven bound, mm.
        bound: f64,
    },
    /// At the witness the distance is proven to exceed the tolerance.
    Fails {
        /// Parameters on the face.
        uv: [f64; 2],
        /// Signed distance there, mm.
        distance: f64,
    },
    /// Neither could be shown within the budget.
    Undecided {
        /// Parameters of the place that resisted.
        uv: [f64; 2],
        /// Why.
        reason: Obstruction,
    },
}
