//! Floor 6: files in and out; computes nothing.

pub mod bends;
pub mod bundle;
pub mod cad;
pub mod cloud;
pub mod curves;
pub mod drawings;
pub mod dxf;
pub mod elements;
pub mod glb;
pub mod html;
pub mod iges;
pub mod json;
pub mod marks;
mod markup;
pub mod model;
pub mod net;
pub mod parts;
pub mod pictures;
pub mod png;
pub mod quads;
pub mod step;
pub mod svg;
pub mod sweep;
mod table;
pub mod threedm;
pub mod words;
