//! Notes of flat parts.

use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::tree::CutReason;

/// Something that people should know of parts laid flat.
#[derive(Clone, Debug, PartialEq)]
pub enum UnrollNote {
    /// Where the neutral fibre of bends lies.
    NeutralFibre(KFactor),
    /// A part of sheet.
    Sheet {
        /// Name of the part.
        part: String,
        /// Thickness, mm.
        thickness: f64,
        /// Number of bends.
        bends: usize,
    },
    /// A side of the sheet was asked for, but bodies of sheet have both.
    SideOfBodies,
    /// Faces of a part of sheet where this is of another thickness.
    Thinned {
        /// Name of the part.
        part: String,
        /// Their number.
        faces: usize,
        /// The number of all its faces.
        of: usize,
        /// The thickness (mm) of theirs that differs most.
        local: f64,
        /// Thickness of the sheet, mm.
        thickness: f64,
    },
    /// A part is cut along an edge of the file.
    Cut {
        /// Name of the part.
        part: String,
        /// Entity number of the edge.
        edge: u64,
        /// Why.
        reason: CutReason,
    },
    /// A part is cut along edges of the file where faces meet at an angle and no bend was asked for.
    NotBent {
        /// Name of the part.
        part: String,
        /// Entity numbers of the edges.
        edges: Vec<u64>,
    },
    /// Parts of which it is not proven that they do not lie over themselves.
    Touching {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// Faces of a part that lie flat in its pattern, but are missing from models and pictures.
    NotInSpace {
        /// Name of the part.
        part: String,
        /// Entity numbers of the faces.
        faces: Vec<u64>,
    },
    /// Sides of a part that are not square to the sheet.
    Slanting {
        /// Name of the part.
        part: String,
        /// Entity numbers of the sides.
        faces: Vec<u64>,
    },
    /// Curves and points of the model that lie on faces are drawn on the flat patterns.
    Carried {
        /// How many curves.
        curves: usize,
        /// How many points and texts.
        points: usize,
        /// Greatest distance (mm) of them from the faces, measured.
        distance: f64,
        /// Greatest distance (mm) of the lines drawn from the images, measured.
        deviation: f64,
    },
    /// Curves and points that lie on the other side of the sheet than that from which parts are seen.
    OtherSide {
        /// What they are called.
        curves: Vec<String>,
    },
    /// Curves and points that lie on faces which panels cover: they are drawn at the nearest places of the panels.
    OnPanels {
        /// What they are called.
        curves: Vec<String>,
    },
    /// Curves that run along outlines of parts, which are cut anyway.
    AlongEdges {
        /// What they are called.
        curves: Vec<String>,
    },
    /// Curves and points that lie on no face that was laid flat, in whole or in part.
    OffFaces {
        /// Which.
        curves: Vec<OffFaces>,
    },
    /// Outlines of formed features that are not cut.
    Formed {
        /// Name of the part.
        part: String,
        /// How many.
        count: usize,
    },
}

/// A curve or a point that lies on no face, in whole or in part.
#[derive(Clone, Debug, PartialEq)]
pub struct OffFaces {
    /// What it is called.
    pub curve: String,
    /// Length (mm) of what lies on no face, and of the whole, measured; 0 of points.
    pub off: f64,
    /// See `off`.
    pub length: f64,
    /// Greatest distance (mm) from the faces, measured.
    pub farthest: f64,
}
