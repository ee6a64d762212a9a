//! Images of edges in the plane of their map and after its motion, enclosed: docs/algorithms/unroll.md.

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

/// What a motion makes of all lengths, all but 1; `None` where it is none.
pub(super) fn scale(image: &EdgeImage) -> Option<Interval> {
    let [c, s] = image.turn.map(Interval::point);
    let scale = (c.sqr() + s.sqr()).sqrt();
    (scale.lo > 0.0).then_some(scale)
}

/// A way in the plane before the motion of an image, of which it makes the way `v`.
pub(super) fn before(image: &EdgeImage, v: [Interval; 2]) -> [Interval; 2] {
    let [c, s] = image.turn.map(Interval::point);
    let square = c.sqr() + s.sqr();
    [(c * v[0] + s * v[1]) / square, (c * v[1] - s * v[0]) / square]
}

pub(super) fn hull(all: impl Iterator<Item = Interval>) -> Interval {
    all.reduce(Interval::hull).unwrap_or(Interval::EVERYTHING)
}
