//! Neighbouring panels that meet: seams between strips, strips that agree about them, and borders where strips
//! intersect.

pub mod attempts;
pub mod consensus;
pub mod intersection;
pub mod relevel;
pub mod seams;
