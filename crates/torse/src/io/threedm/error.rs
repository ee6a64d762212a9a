//! What is said where nothing could be read.

use crate::io::model::first_of;

/// Why nothing could be read at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// No bytes.
    #[error("the file is empty")]
    Empty,
    /// Something else than an archive of Rhino.
    #[error("this is not a 3DM file: {0}")]
    NotThreeDm(String),
    /// An archive of the first version.
    #[error("this is a 3DM file of version {0}; open it in Rhino and save it as version 4 or later")]
    TooOld(u32),
    /// An archive of a version that is not known, or did not exist when this was written.
    #[error("this is a 3DM file of version {0}, which is not known; save it as version 8 in Rhino")]
    TooNew(u32),
    /// The tables of the archive are damaged or cut off.
    #[error("the 3DM file is damaged at byte {at}: {reason}; save it again in Rhino")]
    Damaged {
        /// Place in the file.
        at: usize,
        /// What is wrong.
        reason: String,
    },
    /// Objects, but no face among them.
    #[error("the 3DM file holds no surfaces ({objects} objects read{}); save surfaces or polysurfaces, not curves, meshes or SubD", first_of(.reason))]
    NoFaces {
        /// Number of objects.
        objects: usize,
        /// The first object that could not be used, with the reason; empty if there is none.
        reason: String,
    },
    /// Nothing of what was asked for besides faces.
    #[error("the 3DM file holds no {what} that can be read ({objects} objects read{})", first_of(.reason))]
    Nothing {
        /// What was asked for: curves or meshes.
        what: &'static str,
        /// Number of objects.
        objects: usize,
        /// The first object that could not be used, with the reason; empty if there is none.
        reason: String,
    },
    /// Every face was refused.
    #[error("none of the {count} faces could be read; the first: {reason}")]
    NoUsableFaces {
        /// Number of faces.
        count: usize,
        /// The first, and what is wrong with it.
        reason: String,
    },
}
