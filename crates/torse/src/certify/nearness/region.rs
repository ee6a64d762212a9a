//! What of a surface counts: the part of its parameter plane that closed polygons wind about, with exact predicates \[S97\].

use crate::certify::polygon::{Sides, ROUNDED};
use crate::geom::box_tree::BoxTree;
use crate::geom::{BBox, Vec3};
use crate::num::interval::Interval;
use crate::spline::surface::Surface;

/// A place on a side of a polygon: the polygon, the side, and the share of the way along it.
pub(super) type BorderPlace = (usize, usize, f64);

/// A stretch of a side, straight in space as far as looking for nearest places goes.
struct Stretch {
    polygon: usize,
    side: usize,
    shares: [f64; 2],
    ends: [Vec3; 2],
}

/// A part of a parameter plane.
pub(super) struct Region<'a> {
    polygons: &'a [Vec<[f64; 2]>],
    sides: Sides<'a>,
    /// Largest extent of the domain.
    reach: f64,
    stretches: Vec<Stretch>,
    tree: BoxTree,
}

/// Sides are cut so that no stretch is longer than this share of the domain.
const STRETCH: f64 = 1.0 / 64.0;
/// Share of its extent by which a box is made wider on each side, to find what counts near it.
const WIDER: f64 = 0.5;
/// Steps to the nearest place of a side from that of its stretch.
const STEPS: usize = 3;

impl<'a> Region<'a> {
    /// What polygons wind about; `None` without any.
    pub fn new(surface: &Surface, polygons: &'a [Vec<[f64; 2]>]) -> Option<Self> {
        let ((u0, u1), (v0, v1)) = surface.domain();
        let mut stretches = Vec::new();
        for (k, points) in polygons.iter().enumerate() {
            for side in 0..points.len() {
                let (a, b) = (points[side], points[(side + 1) % points.len()]);
                let share = ((b[0] - a[0]).abs() / (u1 - u0)).max((b[1] - a[1]).abs() / (v1 - v0)) / STRETCH;
                let parts = if share > 1.0 { (share.ceil() as usize).min(MOST_PARTS) } else { 1 };
                let at = |i: usize| i as f64 / parts as f64;
                let place = |i: usize| on(surface, a, b, at(i));
                stretches.extend((0..parts).map(|i| Stretch {
                    polygon: k,
                    side,
                    shares: [at(i), at(i + 1)],
                    ends: [place(i), place(i + 1)],
                }));
            }
        }
        let tree = BoxTree::new(stretches.len(), &|k| BBox::of(stretches[k].ends.iter()));
        (!stretches.is_empty()).then(|| Self {
            polygons,
            sides: Sides::of(polygons),
            reach: (u1 - u0).max(v1 - v0),
            stretches,
            tree,
        })
    }

    /// Whether all of a box is surely inside.
    pub fn contains(&self, box_: &[Interval; 2]) -> bool {
        !self.sides.may_meet(box_) && self.sides.winding(box_.map(Interval::mid)) != 0
    }

    /// How far places of a box near the border are from what counts, by both parameters: `places` are the corners of a polygon in
    /// the box that holds them, `speeds` the lengths of both derivatives about there. `None` where the border bends too much in the
    /// box.
    ///
    /// A half-plane is taken that no side enters within a wider box. If that part of it counts anywhere, it counts everywhere, and
    /// the way to it is no longer than that square to its line, as long as this ends in the box.
    pub fn beside(&self, box_: &[Interval; 2], places: &[[f64; 2]], speeds: [f64; 2]) -> Option<[f64; 2]> {
        let [m, n] = [0, 1].map(|d: usize| WIDER * (box_[d].hi - box_[d].lo));
        let wide = [Interval::new(box_[0].lo - m, box_[0].hi + m), Interval::new(box_[1].lo - n, box_[1].hi + n)];
        let sides = self.sides.inside(&wide);
        let scaled = |p: &[f64; 2]| [p[0] * speeds[0], p[1] * speeds[1]];
        let turn = self.sides.turn();
        let outward = sides.iter().fold([0.0; 2], |sum, [p, q]| {
            let (p, q) = (scaled(p), scaled(q));
            [sum[0] + turn * (q[1] - p[1]), sum[1] - turn * (q[0] - p[0])]
        });
        let size = outward[0].hypot(outward[1]);
        let normal = outward.map(|x| x / size);
        if !normal.iter().all(|x| x.is_finite()) {
            return None;
        }
        let height = |p: &[f64; 2]| {
            let p = scaled(p);
            normal[0] * p[0] + normal[1] * p[1]
        };
        let largest = wide.iter().zip(speeds).map(|(x, s)| x.lo.abs().max(x.hi.abs()) * s).fold(0.0, f64::max);
        let side = self.reach * speeds[0].max(speeds[1]);
        let slack = ROUNDED * (largest + side);
        let line = sides.iter().flatten().map(height).fold(f64::INFINITY, f64::min) - slack;
        let corners = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|k| [0, 1].map(|d: usize| [wide[d].lo, wide[d].hi][k[d]]));
        let lowest = corners.iter().min_by(|a, b| height(a).total_cmp(&height(b)))?;
        if height(lowest) + slack >= line || self.sides.winding(*lowest) == 0 {
            return None;
        }
        let off = places.iter().map(height).fold(f64::NEG_INFINITY, f64::max) + slack - line;
        let way = [0, 1].map(|d: usize| off.max(0.0) * normal[d].abs() / speeds[d]);
        (way[0] <= m && way[1] <= n).then_some(way)
    }

    /// The place of the border near a point, with its parameters and its distance (mm).
    pub fn nearest(&self, surface: &Surface, x: &Vec3) -> Option<(BorderPlace, [f64; 2], f64)> {
        let share = |k: usize| {
            let [p, q] = self.stretches[k].ends;
            let d = q - p;
            let dd = d.norm_squared();
            if dd > 0.0 {
                (d.dot(&(x - p)) / dd).clamp(0.0, 1.0)
            } else {
                0.0
            }
        };
        let off = |k: usize| {
            let [p, q] = self.stretches[k].ends;
            (p + (q - p) * share(k) - x).norm_squared()
        };
        let (k, _) = self.tree.nearest(x, &off)?;
        let Stretch { polygon, side, shares: [from, to], .. } = self.stretches[k];
        let [a, b] = self.ends(polygon, side);
        let mut t = from + (to - from) * share(k);
        for _ in 0..STEPS {
            let [u, v] = between(a, b, t);
            let j = surface.extended_jet(u, v);
            let along = j.du * (b[0] - a[0]) + j.dv * (b[1] - a[1]);
            let step = (x - j.p).dot(&along) / along.norm_squared();
            if !step.is_finite() {
                break;
            }
            t = (t + step).clamp(0.0, 1.0);
        }
        let place = |t: f64| (on(surface, a, b, t) - x).norm();
        let begun = from + (to - from) * share(k);
        let t = if place(t) <= place(begun) { t } else { begun };
        Some(((polygon, side, t), between(a, b, t), place(t)))
    }

    /// Encloses a place of the border.
    pub fn enclosure(&self, (polygon, side, t): BorderPlace) -> [Interval; 2] {
        let [a, b] = self.ends(polygon, side);
        [0, 1].map(|d: usize| {
            let (a, b) = (Interval::point(a[d]), Interval::point(b[d]));
            // Corners are what they are.
            match t {
                t if t <= 0.0 => a,
                t if t >= 1.0 => b,
                t => a + (b - a) * Interval::point(t),
            }
        })
    }

    fn ends(&self, polygon: usize, side: usize) -> [[f64; 2]; 2] {
        let p = &self.polygons[polygon];
        [p[side], p[(side + 1) % p.len()]]
    }
}

/// Parts of a side at most.
const MOST_PARTS: usize = 256;

fn between(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    [0, 1].map(|d: usize| a[d] + (b[d] - a[d]) * t)
}

fn on(surface: &Surface, a: [f64; 2], b: [f64; 2], t: f64) -> Vec3 {
    let [u, v] = between(a, b, t);
    surface.point(u, v)
}
