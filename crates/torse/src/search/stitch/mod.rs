//! Neighbouring panels that meet: all strips changed together, borders under their edges or where strips intersect, and parts of them.

pub(crate) mod across;
mod as_built;
pub(crate) mod attempts;
mod bordering;
pub(crate) mod faces_together;
pub(crate) mod intersection;
mod known_edge;
pub(crate) mod openness;
pub(crate) mod parts;
pub(crate) mod seams;
mod stitching;
mod strip_pair;
mod together;
