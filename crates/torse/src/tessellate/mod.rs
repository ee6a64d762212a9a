//! Floor 5: triangles for pictures and meshes.

pub mod panel;
