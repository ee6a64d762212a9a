//! A polygonal region of a parameter plane, cut into triangles that carry labels: the one record of which part
//! of a face belongs to which panel. All cuts are shared by both sides, so coverage is a matter of counting.

/// Label of triangles that belong to no panel yet.
pub const UNASSIGNED: u32 = u32::MAX;

/// A conforming triangulation with labels. Triangles are counter-clockwise and never cross a knot line of the
/// surface that the plane parametrises.
#[derive(Clone, Debug, Default)]
pub struct Partition {
    /// Corner points (u, v).
    pub vertices: Vec<[f64; 2]>,
    /// Corners of each triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Label of each triangle.
    pub labels: Vec<u32>,
}
