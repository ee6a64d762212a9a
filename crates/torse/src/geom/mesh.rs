//! Triangle meshes for pictures and mesh files. Nothing is proven about them.

use super::Vec3;

/// Triangles with a normal and a value at every vertex.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices, mm.
    pub positions: Vec<Vec3>,
    /// Unit normal at each vertex.
    pub normals: Vec<Vec3>,
    /// Corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// A value at each vertex: the signed deviation, mm. Empty where there is none.
    pub values: Vec<f64>,
}
