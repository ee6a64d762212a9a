//! Floor 6: files in and out; computes nothing.

pub mod step;
