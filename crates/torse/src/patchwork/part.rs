//! Parts: what is cut in one piece.

/// Consecutive panels that share rulings and are cut as one piece, or one panel alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Name of the part.
    pub name: String,
    /// First panel.
    pub first: usize,
    /// Number of panels.
    pub count: usize,
    /// Why the part has no pattern; empty if it has one.
    pub missing: String,
}
