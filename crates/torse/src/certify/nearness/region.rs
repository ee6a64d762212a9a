//! What of a surface counts: the part of its parameter plane that closed polygons wind about, with exact predicates \[S97\].

use crate::certify::polygon::{meets, winding};
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
    stretches: Vec<Stretch>,
    tree: BoxTree,
}

/// Sides are cut so that no stretch is longer than this share of the domain.
const STRETCH: f64 = 1.0 / 64.0;
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
        (!stretches.is_empty()).then_some(Self { polygons, stretches, tree })
    }

    /// Whether all of a box is surely inside.
    pub fn contains(&self, box_: &[Interval; 2]) -> bool {
        let crossed = self.polygons.iter().any(|p| (0..p.len()).any(|k| meets(p[k], p[(k + 1) % p.len()], box_)));
        !crossed && self.polygons.iter().map(|p| winding(p, box_.map(Interval::mid))).sum::<i32>() != 0
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
