//! Notes of fits.

use crate::certify::claim::Counted;
use crate::geom::Vec3;
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
    /// Strips of rulings and faces end where these end.
    Given {
        /// Whether faces are given.
        faces: bool,
        /// Names of strips that are whole, though they should be cut.
        whole: Vec<String>,
    },
    /// Neighbouring rulings that are much farther apart than others.
    Gap {
        /// Their distance, mm.
        apart: f64,
        /// The usual distance, mm.
        usual: f64,
        /// Places of their middles.
        at: [Vec3; 2],
        /// How many such stretches there are.
        count: usize,
        /// How far the strip bulges from straight lines between the two, mm, estimated; `None` if no strip lies there.
        bulge_estimate: Option<f64>,
    },
    /// Stretches between rulings that come one after the other which no strip covers as it is cut.
    NoStrip {
        /// How many.
        count: usize,
        /// The middle of the one that is farthest from the strips.
        at: Vec3,
        /// No larger is its distance from them, mm; infinite where nothing is known.
        off: f64,
    },
    /// Rulings that go around a ring and end before the first of them.
    OpenRing {
        /// How far apart the first and the last one are, mm.
        apart: f64,
        /// The middle between both.
        at: Vec3,
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
