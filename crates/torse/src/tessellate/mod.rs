//! Floor 5: triangles and pixels for pictures and meshes.

pub mod colour;
pub mod drawing;
pub mod flat;
pub mod scene;
pub mod stroke_font;
