//! Floor 6: one readable file per user job.

pub mod approximate;
pub mod cones;
pub mod cover;
pub mod cut;
pub mod fit;
pub mod info;
pub mod loft;
pub mod outcome;
pub mod presentation;
mod seams;
pub mod sheets;
pub mod sweep;
