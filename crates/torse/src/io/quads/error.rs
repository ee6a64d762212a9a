//! Why there is no strip in a file.

use crate::io::threedm;
use crate::torse::quad_strip::QuadStripError;

/// Why there is no strip in a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuadReadError {
    /// A line that cannot be understood.
    #[error("line {line}: {reason}")]
    Line {
        /// Line number from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// Not a text file.
    #[error("this is not a text file; a strip is a table (.csv), a Wavefront OBJ file (.obj) or a Rhino file (.3dm)")]
    NotText,
    /// A file of surfaces.
    #[error("this is a STEP or IGES file, which holds surfaces; a strip is a mesh of quadrilaterals (.obj, .3dm) or a table (.csv)")]
    Surfaces,
    /// A Rhino archive without meshes, or damaged.
    #[error(transparent)]
    ThreeDm(#[from] threedm::ReadError),
    /// Nothing in it.
    #[error("the file holds no rulings; a table has six numbers on each line, both ends of a ruling")]
    Empty,
    /// A mesh that is no strip.
    #[error("the mesh is no open strip of quadrilaterals: {0}")]
    NoStrip(String),
    /// The points make no strip.
    #[error(transparent)]
    Strip(#[from] QuadStripError),
}
