//! Neighbouring panels that meet: all strips changed together, borders under their edges or where strips intersect, and parts of them.

pub(crate) mod across;
pub(crate) mod attempts;
pub(crate) mod intersection;
pub(crate) mod parts;
pub(crate) mod seams;
