//! Images of edges in the plane of their map and after its motion, enclosed: docs/algorithms/unroll.md.

use crate::geom::{Frame, Vec3};
use crate::num::interval::Interval;
use crate::patchwork::image::EdgeImage;
use std::f64::consts::TAU;

/// Whole turns by which an angle about the axis is short of that of the point at `t`.
pub(super) fn turns(image: &EdgeImage, angle: f64, t: f64) -> f64 {
    let share = (t - image.part[0]) / (image.part[1] - image.part[0]);
    let near = image.angles[0] + (image.angles[1] - image.angles[0]) * share;
    ((near - angle) / TAU).round()
}

/// A place in the plane of a map after its motion.
pub(super) fn placed(image: &EdgeImage, p: [Interval; 2]) -> [Interval; 2] {
    let [c, s] = image.turn.map(Interval::point);
    [c * p[0] - s * p[1] + Interval::point(image.shift.x), s * p[0] + c * p[1] + Interval::point(image.shift.y)]
}

pub(super) fn local(f: &Frame, v: [Interval; 3]) -> [Interval; 3] {
    let dot = |a: &Vec3| v[0] * a.x + v[1] * a.y + v[2] * a.z;
    [dot(&f.x), dot(&f.y), dot(&f.z)]
}

pub(super) fn hull(all: impl Iterator<Item = Interval>) -> Interval {
    all.reduce(Interval::hull).unwrap_or(Interval::EVERYTHING)
}
