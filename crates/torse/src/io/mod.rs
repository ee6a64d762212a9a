//! Floor 6: files in and out; computes nothing.

pub mod dxf;
pub mod glb;
pub mod step;
pub mod svg;
