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
    /// Outlines of formed features that are not cut.
    Formed {
        /// Name of the part.
        part: String,
        /// How many.
        count: usize,
    },
}
