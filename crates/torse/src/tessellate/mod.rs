//! Floor 5: triangles for pictures and meshes.
