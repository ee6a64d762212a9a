//! Why the panels of a part cannot be laid onto its drawing.

use crate::develop::refold::atlas::AtlasError;

/// Why the panels of a part cannot be laid onto its drawing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PartAtlasError {
    /// A file is not there.
    #[error("{0} is missing")]
    NoFile(&'static str),
    /// A file that cannot be read.
    #[error("{file}: {reason}")]
    File {
        /// Its name.
        file: &'static str,
        /// What the reader says.
        reason: String,
    },
    /// A panel that the file does not hold.
    #[error("its panel {0} is not in the file of panels")]
    NoPanel(String),
    /// A report that does not say what was drawn.
    #[error("report.json does not say where the neutral fibre of its sheet lies; lay it flat anew")]
    Neutral,
    /// Panels that cannot be laid flat, or not so.
    #[error(transparent)]
    Atlas(#[from] AtlasError),
}
