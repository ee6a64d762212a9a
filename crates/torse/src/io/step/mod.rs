//! STEP files, ISO 10303-21 with the application protocols AP203, AP214 and AP242.

pub mod read;
//! STEP files: exchange structure of ISO 10303-21, shapes of AP203, AP214 and AP242.

pub mod write;
