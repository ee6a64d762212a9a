//! The tables of a polysurface, as archives have them.

use crate::geom::Vec3;
use crate::io::threedm::bytes::Reading;
use crate::io::threedm::curves::FileCurve;
use crate::io::threedm::surfaces::Patch;

/// The tables of a polysurface.
#[derive(Debug, Default)]
pub(in crate::io::threedm) struct Brep {
    /// Curves in the parameter planes of surfaces.
    pub(super) plane_curves: Vec<Reading<FileCurve>>,
    pub(super) curves: Vec<Reading<FileCurve>>,
    pub(super) surfaces: Vec<Reading<Patch>>,
    pub(super) vertices: Vec<Vertex>,
    pub(super) edges: Vec<Edge>,
    pub(super) trims: Vec<Trim>,
    pub(super) loops: Vec<Loop>,
    pub(super) faces: Vec<Face>,
}

#[derive(Debug)]
pub(super) struct Vertex {
    pub(super) point: Vec3,
    pub(super) tolerance: f64,
}

#[derive(Debug)]
pub(super) struct Edge {
    pub(super) curve: i32,
    pub(super) reversed: bool,
    pub(super) part: [f64; 2],
    pub(super) ends: [i32; 2],
    pub(super) tolerance: f64,
}

#[derive(Debug)]
pub(super) struct Trim {
    pub(super) curve: i32,
    pub(super) part: [f64; 2],
    pub(super) backwards: bool,
    pub(super) edge: i32,
    pub(super) reversed: bool,
    pub(super) kind: i32,
}

#[derive(Debug)]
pub(super) struct Loop {
    pub(super) trims: Vec<i32>,
    pub(super) kind: i32,
}

#[derive(Debug)]
pub(super) struct Face {
    pub(super) loops: Vec<i32>,
    pub(super) surface: i32,
    pub(super) reversed: bool,
}

/// Kind of trims that are points of the surface.
pub(super) const SINGULAR: i32 = 4;
/// Kind of the loop around a face.
pub(super) const OUTER: i32 = 1;
