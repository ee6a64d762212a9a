//! Neighbouring panels that meet: seams between strips, strips that agree about them, and borders where strips
//! intersect.

pub(crate) mod attempts;
pub(crate) mod consensus;
pub(crate) mod intersection;
pub(crate) mod relevel;
pub(crate) mod seams;
