//! Floor 6: one readable file per user job.

pub mod info;
pub mod outcome;
