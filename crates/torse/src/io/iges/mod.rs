//! IGES files (versions 3 to 5.3, fixed format): surfaces, faces and curves in, panels out.

pub mod read;
pub mod write;
