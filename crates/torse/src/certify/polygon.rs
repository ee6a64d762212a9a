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

/// Sides of closed polygons, found by the second parameter.
pub(super) struct Sides<'a> {
    polygons: &'a [Vec<[f64; 2]>],
    low: f64,
    scale: f64,
    rows: Vec<Vec<(u32, u32)>>,
    turn: f64,
}

/// Sides that run along a line of the box within this share of their coordinates are not cut there: the cut would be uncertain.
const ALONG: f64 = 1e-6;

/// Share of the coordinates of a segment by which rounding may move the ends of [`clipped`], at most: ten digits are lost where a
/// line of the box crosses it as askew as [`ALONG`] allows, of some sixteen, and others add nothing to that.
pub(super) const ROUNDED: f64 = 1e-9;

/// What of a segment that meets a box lies in it, or a little more, up to rounding.
pub(super) fn clipped([p, q]: [[f64; 2]; 2], box_: &[Interval; 2]) -> [[f64; 2]; 2] {
    let (mut s, mut t) = (0.0f64, 1.0f64);
    for d in 0..2 {
        let way = q[d] - p[d];
        if way.abs() > ALONG * p[d].abs().max(q[d].abs()) {
            let (a, b) = ((box_[d].lo - p[d]) / way, (box_[d].hi - p[d]) / way);
            s = s.max(a.min(b));
            t = t.min(a.max(b));
        }
    }
    let at = |x: f64| match x {
        x if x <= 0.0 => p,
        x if x >= 1.0 => q,
        x => [0, 1].map(|d: usize| p[d] + (q[d] - p[d]) * x),
    };
    // A segment that meets the box by rounding only.
    if s > t {
        return [p, q];
    }
    [at(s), at(t)]
}

/// Rows in which sides are looked up.
const ROWS: usize = 512;

impl<'a> Sides<'a> {
    /// The sides of some polygons.
    pub fn of(polygons: &'a [Vec<[f64; 2]>]) -> Self {
        let all = || polygons.iter().flatten().map(|p| p[1]);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let scale = if high > low { ROWS as f64 / (high - low) } else { 0.0 };
        let doubled = |p: &Vec<[f64; 2]>| -> f64 {
            (0..p.len()).map(|k| (p[k], p[(k + 1) % p.len()])).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
        };
        let turn = if polygons.iter().map(doubled).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
        let mut out = Self { polygons, low, scale, rows: vec![Vec::new(); ROWS], turn };
        for (l, polygon) in polygons.iter().enumerate() {
            for k in 0..polygon.len() {
                let (a, b) = (out.row(polygon[k][1]), out.row(polygon[(k + 1) % polygon.len()][1]));
                (a.min(b)..=a.max(b)).for_each(|r| out.rows[r].push((l as u32, k as u32)));
            }
        }
        out
    }

    /// Monotone: what lies between two parameters is in one of the rows between theirs.
    fn row(&self, y: f64) -> usize {
        (((y - self.low) * self.scale).max(0.0) as usize).min(ROWS - 1)
    }

    fn side(&self, (l, k): (u32, u32)) -> [[f64; 2]; 2] {
        let polygon = &self.polygons[l as usize];
        [polygon[k as usize], polygon[(k as usize + 1) % polygon.len()]]
    }

    /// What of the sides may lie in a box, and a little more.
    pub fn inside(&self, box_: &[Interval; 2]) -> Vec<[[f64; 2]; 2]> {
        let rows = self.row(box_[1].lo)..=self.row(box_[1].hi);
        let mut own: Vec<(u32, u32)> = self.rows[rows].iter().flatten().copied().collect();
        own.sort_unstable();
        own.dedup();
        own.into_iter().map(|s| self.side(s)).filter(|[p, q]| meets(*p, *q, box_)).map(|s| clipped(s, box_)).collect()
    }

    /// 1 if the polygons wind about what is in them counter-clockwise, −1 if clockwise.
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// Whether a side may meet a box, see [`meets`].
    pub fn may_meet(&self, box_: &[Interval; 2]) -> bool {
        let rows = self.row(box_[1].lo)..=self.row(box_[1].hi);
        self.rows[rows].iter().flatten().any(|s| {
            let [p, q] = self.side(*s);
            meets(p, q, box_)
        })
    }

    /// Winding number of all polygons about a point that is on none of them.
    pub fn winding(&self, at: [f64; 2]) -> i32 {
        let own = |s: &(u32, u32)| {
            let [a, b] = self.side(*s);
            crossing(a, b, at)
        };
        self.rows[self.row(at[1])].iter().map(own).sum()
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
        let hole: Vec<_> = square.iter().rev().map(|p| [0.5 + 0.25 * p[0], 0.5 + 0.25 * p[1]]).collect();
        let both = [square.to_vec(), hole];
        let sides = Sides::of(&both);
        for at in [[0.2, 0.2], [0.7, 0.7], [3.0, 1.0], [1.9, 1.9], [0.7, -1.0], [0.7, 5.0]] {
            assert_eq!(sides.winding(at), both.iter().map(|p| winding(p, at)).sum::<i32>(), "{at:?}");
        }
        let at = |x: f64, y: f64| [Interval::new(x, x + 0.1), Interval::new(y, y + 0.1)];
        assert!(sides.may_meet(&at(0.45, 0.7)) && sides.may_meet(&at(-0.05, 1.9)) && !sides.may_meet(&at(0.6, 0.6)));
    }

    #[test]
    fn segments_meet_boxes_unless_a_line_parts_them() {
        let square = [Interval::new(0.0, 1.0); 2];
        assert!(meets([-1.0, 0.5], [2.0, 0.5], &square) && meets([0.2, 0.2], [0.3, 0.3], &square));
        assert!(!meets([-1.0, 0.5], [0.5, 2.1], &square) && !meets([2.0, 0.0], [2.0, 1.0], &square));
    }
}
