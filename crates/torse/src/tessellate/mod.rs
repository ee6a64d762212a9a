//! Floor 5: triangles and pixels for pictures and meshes.

pub mod camera;
pub mod chart;
pub mod colour;
pub mod coverage;
pub mod flat;
pub mod label;
pub mod picture;
pub mod raster;
pub mod scene;
pub mod sequence;
pub mod stroke_font;

pub mod dots;
pub mod drawing;
pub mod panel;
pub mod strip;
