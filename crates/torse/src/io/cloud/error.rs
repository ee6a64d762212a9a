//! Why a file of points cannot be read.

use crate::io::threedm;

/// Why a file of points cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CloudReadError {
    /// A 3DM file without meshes, or none at all.
    #[error(transparent)]
    ThreeDm(#[from] threedm::ReadError),
    /// The ending of the name is not known.
    #[error("'{0}' is no known kind of point file: give .ply, .csv, .xyz, .txt, .obj, .stl or .3dm")]
    Kind(String),
    /// A drawing whose unit is not known, or not that which is given.
    #[error("{0}")]
    Drawing(String),
    /// Not what the ending says.
    #[error("not a {format} file: {reason}")]
    Format {
        /// Name of the format.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A line that cannot be read.
    #[error("{format} line {line}: {reason}")]
    Line {
        /// Name of the format.
        format: &'static str,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// The data end too early.
    #[error("the {format} file ends after {read} of {promised} {what}: it was cut off")]
    Short {
        /// Name of the format.
        format: &'static str,
        /// Things read.
        read: usize,
        /// Things promised by the header.
        promised: usize,
        /// What they are.
        what: &'static str,
    },
    /// A coordinate that is not finite.
    #[error("point {index} has a coordinate that is not a finite number; remove it")]
    NotFinite {
        /// Index of the point.
        index: usize,
    },
    /// No points.
    #[error("the file holds no points")]
    Empty,
}
