//! STEP files: exchange structure of ISO 10303-21, shapes of AP203, AP214 and AP242.

pub mod read;
pub mod write;
