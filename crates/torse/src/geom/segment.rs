//! Segments of space and of the plane.

use super::{Vec2, Vec3};
use nalgebra::SVector;

/// Share of the product of both squared lengths below which the determinant of two directions is rounding: they are
/// parallel.
const PARALLEL: f64 = 1e-14;

/// Distance (mm) between the segments from `a` to `b` and from `c` to `d`; either may be a point.
pub(crate) fn segment_distance([a, b]: [&Vec3; 2], [c, d]: [&Vec3; 2]) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let det = uu * vv - uv * uv;
    let s = if det > PARALLEL * uu * vv { ((uv * vw - vv * uw) / det).clamp(0.0, 1.0) } else { 0.0 };
    let t = if vv > 0.0 { ((uv * s + vw) / vv).clamp(0.0, 1.0) } else { 0.0 };
    let s = if uu > 0.0 { ((uv * t - uw) / uu).clamp(0.0, 1.0) } else { 0.0 };
    (w + u * s - v * t).norm()
}

/// Nearest point of the segment from `p` to `q`; its first end where it is a point.
pub(crate) fn foot<const D: usize>(p: &SVector<f64, D>, q: &SVector<f64, D>, x: &SVector<f64, D>) -> SVector<f64, D> {
    p + (q - p) * share(p, q, x)
}

/// Share of the way from `p` to `q` at which the segment is nearest to `x`; 0 where it is a point.
pub(crate) fn share<const D: usize>(p: &SVector<f64, D>, q: &SVector<f64, D>, x: &SVector<f64, D>) -> f64 {
    let d = q - p;
    let s = d.dot(&(x - p)) / d.norm_squared();
    if s.is_finite() {
        s.clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Whether two segments of the plane have the same ends within `near`, in either direction; `Some(true)` where they run against
/// each other.
pub(crate) fn same_segment(a: &[Vec2; 2], b: &[Vec2; 2], near: f64) -> Option<bool> {
    let off = |k: usize| (a[k] - b[0]).norm().max((a[1 - k] - b[1]).norm());
    [0, 1].into_iter().find(|k| off(*k) <= near).map(|k| k == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_that_cross_over_lie_side_by_side_or_are_points() {
        let p = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let along = [&p(-1.0, 0.0, 0.0), &p(1.0, 0.0, 0.0)];
        assert_eq!(segment_distance(along, [&p(0.5, -1.0, 2.0), &p(0.5, 1.0, 2.0)]), 2.0);
        assert_eq!(segment_distance(along, [&p(0.0, 3.0, 0.0), &p(4.0, 3.0, 0.0)]), 3.0);
        assert_eq!(segment_distance(along, [&p(4.0, 4.0, 0.0), &p(4.0, 4.0, 0.0)]), 5.0);
        assert_eq!(segment_distance([along[0], along[0]], along), 0.0);
    }

    #[test]
    fn the_nearest_point_stays_on_the_segment_and_on_a_point() {
        let (p, q) = (Vec2::new(1.0, 1.0), Vec2::new(5.0, 1.0));
        assert_eq!(share(&p, &q, &Vec2::new(2.0, 7.0)), 0.25);
        assert_eq!(foot(&p, &q, &Vec2::new(2.0, 7.0)), Vec2::new(2.0, 1.0));
        assert_eq!([-3.0, 9.0].map(|x| share(&p, &q, &Vec2::new(x, 0.0))), [0.0, 1.0]);
        assert_eq!(foot(&p, &p, &q), p);
    }
}
