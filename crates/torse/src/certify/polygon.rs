//! Polygons of a parameter plane, with exact predicates \[S97\].

use crate::num::interval::Interval;

/// Whether a segment may meet a box: not on one side of it, and not with the box on one side of itself.
pub(super) fn meets(p: [f64; 2], q: [f64; 2], box_: &[Interval; 2]) -> bool {
    for d in 0..2 {
        if p[d].max(q[d]) < box_[d].lo || p[d].min(q[d]) > box_[d].hi {
            return false;
        }
    }
    let coord = |x: f64, y: f64| robust::Coord { x, y };
    let side = |x: f64, y: f64| robust::orient2d(coord(p[0], p[1]), coord(q[0], q[1]), coord(x, y));
    let [x, y] = box_;
    let sides = [side(x.lo, y.lo), side(x.lo, y.hi), side(x.hi, y.lo), side(x.hi, y.hi)];
    !(sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0))
}

/// Winding number of a closed polygon about a point that is not on it.
pub(super) fn winding(polygon: &[[f64; 2]], at: [f64; 2]) -> i32 {
    (0..polygon.len()).map(|k| crossing(polygon[k], polygon[(k + 1) % polygon.len()], at)).sum()
}

/// What a side of a polygon adds to its winding number about a point.
pub(super) fn crossing(a: [f64; 2], b: [f64; 2], at: [f64; 2]) -> i32 {
    let coord = |p: [f64; 2]| robust::Coord { x: p[0], y: p[1] };
    let side = || robust::orient2d(coord(a), coord(b), coord(at));
    match (a[1] <= at[1], b[1] <= at[1]) {
        (true, false) if side() > 0.0 => 1,
        (false, true) if side() < 0.0 => -1,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_wind_about_what_is_in_them() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let back: Vec<_> = square.iter().rev().copied().collect();
        assert_eq!((winding(&square, [1.0, 1.0]), winding(&back, [1.0, 1.0])), (1, -1));
        assert_eq!((winding(&square, [3.0, 1.0]), winding(&square, [-1.0, 0.0])), (0, 0));
    }

    #[test]
    fn segments_meet_boxes_unless_a_line_parts_them() {
        let square = [Interval::new(0.0, 1.0); 2];
        assert!(meets([-1.0, 0.5], [2.0, 0.5], &square) && meets([0.2, 0.2], [0.3, 0.3], &square));
        assert!(!meets([-1.0, 0.5], [0.5, 2.1], &square) && !meets([2.0, 0.0], [2.0, 1.0], &square));
    }
}
