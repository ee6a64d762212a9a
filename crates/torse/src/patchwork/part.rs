//! Parts: what is cut in one piece.

use crate::reason::Unlaid;
use crate::torse::strip::Strip;

/// Consecutive panels that share rulings and are cut as one piece, or one panel alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Name of the part.
    pub name: String,
    /// First panel.
    pub first: usize,
    /// Number of panels.
    pub count: usize,
    /// Why the part has no pattern; nothing if it has one.
    pub missing: Option<Unlaid>,
}

impl Part {
    /// A part of `count` panels from the panel `first` on.
    pub(crate) fn new(name: impl Into<String>, first: usize, count: usize) -> Self {
        Self { name: name.into(), first, count, missing: None }
    }

    /// Every strip as a part of its own.
    pub(crate) fn of_each(strips: &[Strip]) -> Vec<Self> {
        strips.iter().enumerate().map(|(k, s)| Self::new(&s.name, k, 1)).collect()
    }
}
