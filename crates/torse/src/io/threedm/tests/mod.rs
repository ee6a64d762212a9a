//! Archives made by hand: what is read of them, and what is said of those that cannot be.

mod damage;
mod kinds;
mod more;
mod specimens;
mod written;

use super::{read_with, Model, ReadError, ReadOptions};
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::geom::{BBox, Vec3};

/// Areas agree to what quadrature of smooth faces leaves.
const SAME: f64 = 1e-9;

fn read(bytes: &[u8]) -> Result<Model, ReadError> {
    read_with(bytes, &ReadOptions::default())
}

fn model(bytes: &[u8]) -> Model {
    read(bytes).expect("a model")
}

fn area(faces: &[Face]) -> f64 {
    faces.iter().map(area_estimate).sum()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * b.abs()
}

/// The box around the corners of the trims.
fn corners(faces: &[Face]) -> BBox {
    let points =
        faces.iter().flat_map(|f| f.loops.iter().flat_map(|l| l.points.iter().map(|p| f.surface.point(p[0], p[1]))));
    BBox::of(&points.collect::<Vec<Vec3>>())
}

/// The normal of a face at the middle of its domain.
fn normal(f: &Face) -> Vec3 {
    let ((u0, u1), (v0, v1)) = f.surface.domain();
    let n = f.surface.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1)).normal().normalize();
    if f.reversed {
        -n
    } else {
        n
    }
}
