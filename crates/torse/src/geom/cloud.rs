//! Measured points.

use super::Vec3;

/// Points as measured, in no order, perhaps joined to a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Positions, mm.
    pub points: Vec<Vec3>,
    /// Corners of the flat triangles between them, if the file has any.
    pub triangles: Vec<[u32; 3]>,
}
