//! Floor 5: triangles and pixels for pictures and meshes.

pub mod camera;
pub mod colour;
pub mod coverage;
pub mod flat;
pub mod label;
pub mod picture;
pub mod raster;
pub mod scene;
pub mod stroke_font;
//! Floor 5: triangles for pictures and meshes.

pub mod panel;
pub mod colour;
pub mod drawing;
pub mod flat;
pub mod scene;
pub mod stroke_font;
