//! Floor 6: pictures, drawings and charts: scenes of meshes and lines, cameras, pixels and strokes.

pub mod camera;
pub mod chart;
pub mod colour;
pub(crate) mod dots;
pub mod drawing;
pub mod field;
pub mod flat;
pub(crate) mod label;
pub(crate) mod labels;
pub(crate) mod names;
mod outside;
pub mod picture;
pub mod raster;
pub mod reflection;
pub mod scene;
pub mod sequence;
pub mod stroke_font;

#[cfg(test)]
mod laws;
