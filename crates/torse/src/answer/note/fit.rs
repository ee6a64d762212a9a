//! Notes of fits.

use crate::certify::claim::Counted;
pub use crate::search::strips::ruled_face::SplineSize;

/// Something that people should know of strips fitted to what was given.
#[derive(Clone, Debug, PartialEq)]
pub enum FitNote {
    /// Flat patterns cut back to the border of the measured points, and the names of parts that are not.
    Outlined {
        /// What is known of outlines that follow points; `None` if there are none.
        outlines: Option<Outlines>,
        /// Names of parts that are not cut back.
        whole: Vec<String>,
    },
    /// Flat patterns are those of whole strips.
    WholePatterns,
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
        /// How far a smooth sheet through the corners may lie off the triangles, mm, estimated.
        bulge_estimate: f64,
        /// How far triangles lie from the strips at most, mm, sampled.
        off_estimate: f64,
        /// Places at which that was sampled.
        places: usize,
    },
    /// A face that was to become simpler.
    Face(FaceNote),
    /// Distances are proven at these, not between them.
    At(Counted),
}

/// Outlines that follow measured points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlines {
    /// Largest distance of a place on them from a point, mm.
    pub off_estimate: f64,
    /// Spacing of the points, mm.
    pub spacing: f64,
    /// Holes that are cut out.
    pub holes: usize,
    /// Holes of a few spacings that are not.
    pub closed: usize,
    /// Points that lie apart.
    pub stray: usize,
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
