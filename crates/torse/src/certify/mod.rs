//! Floor 5: the independent judge. Imports nothing from `fit`; only this module can make a [`Certificate`].

mod boundary;
mod cell;
mod developable;
pub mod distance;
mod family;
pub mod prepared;
mod quadratic;
mod rounding;
mod ruled;
#[cfg(test)]
mod specimens;
mod vector;

pub use distance::{distance, DistanceOptions, Judgement};
pub use prepared::Prepared;

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
        reason: Resistance,
    },
}

/// Why a box could not be decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resistance {
    /// No unique foot point could be shown: the regression curve is near, or rulings leave the patch.
    Foot,
    /// The foot map may fold over.
    Fold,
    /// The surface's parametrisation degenerates.
    Degenerate,
    /// The bound stays above the tolerance down to the smallest box.
    Bound,
    /// Too many boxes.
    Budget,
    /// Cancelled or out of time.
    Stopped,
}

/// What was proven about one panel. Lengths in mm.
#[derive(Clone, Debug)]
pub struct PanelCertificate {
    /// Whether everything below is proven and within the tolerance.
    pub certified: bool,
    /// Why not, and where; empty when certified.
    pub reason: String,
    /// Witness: parameters on the face, and the distance there, when the tolerance is exceeded.
    pub witness: Option<([f64; 2], f64)>,
    /// Two-sided bound between the panel as exported and its part of the face; infinite if none was shown.
    pub deviation_bound: f64,
    /// Part of the bound: face to (untrimmed) torse along normals.
    pub distance_bound: f64,
    /// Part of the bound: exported trim curves against the images of the region's boundary.
    pub boundary_bound: f64,
    /// Part of the bound: exported patch against the exact torse.
    pub rounding_bound: f64,
    /// Largest angle (rad) between the tangent planes at both ends of any ruling of the exported patch.
    pub developability_bound: f64,
    /// Lower bound of the distance along rulings between panel and regression curve; infinite for cylinders.
    pub regression_clearance: f64,
    /// Lower bound of the radius of curvature of the panel; infinite for planes.
    pub min_bend_radius: f64,
    /// Boxes or triangles accepted.
    pub cells: usize,
    sealed: (),
}

/// What was proven about a whole patchwork. Lengths in mm.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// The tolerance asked for.
    pub tolerance: f64,
    /// Whether every panel is certified, the faces are covered, and the bound is within the tolerance.
    pub certified: bool,
    /// Hausdorff bound between the trimmed faces and the union of the exported panels.
    pub deviation_bound: f64,
    /// Largest distance between the two sides of any seam at equal parameters.
    pub seam_gap_bound: f64,
    /// Whether the panels' regions add up to the faces exactly.
    pub covered: bool,
    /// One record per panel, in order.
    pub panels: Vec<PanelCertificate>,
    /// Parts of the proof that are missing, in plain words; empty when certified.
    pub missing: Vec<String>,
    sealed: (),
}
