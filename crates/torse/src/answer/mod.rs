//! Floor 8: what a job answers with: the nouns that files and reports are made from.

pub mod marks;
pub mod outcome;
pub mod presentation;
pub mod shapes;
pub mod sheets;
