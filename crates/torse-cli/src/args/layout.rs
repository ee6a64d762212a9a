//! Kinds of layouts of `torse approximate`.

/// How panels are laid.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// As few panels as can be
    Auto,
    /// Strips from side to side, even where other cuts would need fewer panels
    Strips,
    /// Strips around the middle of every face
    Rings,
}
