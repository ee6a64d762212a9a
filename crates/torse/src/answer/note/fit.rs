//! Notes of fits.

use crate::certify::claim::Counted;
pub use crate::search::strips::ruled_face::SplineSize;
pub use crate::search::strips::scan::Between;
pub(crate) use crate::search::strips::scan_outline::Outlines;

/// Something that people should know of strips fitted to what was given.
#[derive(Clone, Debug, PartialEq)]
pub enum FitNote {
    /// Strips and flat patterns cut back to the border of the measured points.
    Ends {
        /// What is known of outlines that follow points; `None` if there are none.
        outlines: Option<Outlines>,
        /// Names of parts that are not cut back.
        whole: Vec<String>,
        /// Whether a coarse mesh was measured, of which no part is cut back.
        mesh: bool,
    },
    /// Points too far from others to belong to a surface.
    Lonely {
        /// How many.
        count: usize,
    },
    /// The file is a coarse mesh, of which the corners are judged.
    CoarseMesh {
        /// Its corners.
        corners: usize,
        /// Its triangles.
        triangles: usize,
        /// What is known between its corners.
        between: Between,
    },
    /// A face that was to become simpler.
    Face(FaceNote),
    /// Points of a mesh that none of its triangles uses: they are left out, unless they are most of the points.
    Unused {
        /// How many.
        count: usize,
        /// Whether they count all the same.
        kept: bool,
    },
    /// Planes at the ends of their row are left out as outliers: the strips end before them.
    Shortened {
        /// How many at both ends.
        count: usize,
        /// How far it is from the outermost ones to the next that are kept, at both ends together, mm.
        by: f64,
        /// How long the row is, mm.
        of: f64,
    },
    /// Distances are proven at these, not between them.
    At(Counted),
}

/// A face and the strips in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceNote {
    /// Name of the face.
    pub face: String,
    /// What it was given with.
    pub given: SplineSize,
    /// What it became.
    pub became: Became,
}

/// What became of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum Became {
    /// Nothing.
    Nothing,
    /// A strip of this name, as it was: nothing simpler was found.
    Itself(String),
    /// Strips, by name.
    Strips(Vec<(String, SplineSize)>),
}
