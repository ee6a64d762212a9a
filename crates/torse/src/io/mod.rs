//! Floor 6: files in and out; computes nothing.

pub mod bends;
pub mod bundle;
pub mod cloud;
pub mod cones;
pub mod curves;
pub mod drawings;
pub mod dxf;
pub mod elements;
pub mod glb;
pub mod html;
pub mod json;
pub mod marks;
pub mod net;
pub mod png;
pub mod quads;
pub mod sheets;
pub mod step;
pub mod svg;
pub mod sweep;
mod table;
pub mod words;
