//! Neighbouring panels that meet: all strips changed together, and borders under their edges or where strips intersect.

pub(crate) mod across;
pub(crate) mod attempts;
pub(crate) mod intersection;
pub(crate) mod parts;
pub(crate) mod seams;
