//! A face in the plane as polygons: inside or not, parallel lines through it, overlaps.

use super::chart::{Chart, FlatRuling};
use crate::brep::body::Body;
use crate::geom::polygon::{area, bounds, crossings, distance, inside, sides};
use crate::geom::Vec2;

/// Sampled loops of a face in the plane.
#[derive(Clone, Debug, Default)]
pub(crate) struct FlatRegion {
    /// Closed polygons; the outer one counter-clockwise, holes clockwise.
    pub loops: Vec<Vec<Vec2>>,
    /// Corner of the box around them with the smallest coordinates.
    pub min: Vec2,
    /// The opposite corner.
    pub max: Vec2,
}

/// A rotation of the plane and a move after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Cosine and sine of the angle.
    pub turn: [f64; 2],
    /// The move, mm.
    pub shift: Vec2,
}

impl Motion {
    /// Nothing moves.
    pub fn identity() -> Self {
        Self { turn: [1.0, 0.0], shift: Vec2::zeros() }
    }

    /// The motion that brings the segment `from` onto `to`, first end on first end; `None` where `from` is a point.
    pub fn between(from: [Vec2; 2], to: [Vec2; 2]) -> Option<Self> {
        let a = (from[1] - from[0]).try_normalize(0.0)?;
        let b = (to[1] - to[0]).try_normalize(0.0)?;
        let turn = [a.dot(&b), a.perp(&b)];
        let only = Self { turn, shift: Vec2::zeros() };
        // Middles meet: a difference of lengths is shared by both ends.
        Some(Self { turn, shift: (to[0] + to[1]) * 0.5 - only.apply(&((from[0] + from[1]) * 0.5)) })
    }

    /// The image of a point.
    pub fn apply(&self, p: &Vec2) -> Vec2 {
        self.direction(p) + self.shift
    }

    /// The image of a direction.
    pub fn direction(&self, v: &Vec2) -> Vec2 {
        let [c, s] = self.turn;
        Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y)
    }

    /// The point whose image is given.
    pub fn back(&self, q: &Vec2) -> Vec2 {
        let [c, s] = self.turn;
        let p = q - self.shift;
        Vec2::new(c * p.x + s * p.y, c * p.y - s * p.x)
    }
}

/// Runs shorter than this share of the body are points.
pub(super) const POINT: f64 = 1e-9;
/// Points on every run of a boundary.
const POINTS: usize = 48;
/// Stretches of lines below this share of a region are none: sides without length, as at an apex, are met by chance.
const SHORT: f64 = 1e-6;

impl FlatRegion {
    /// The region of a face of a body under its chart.
    pub(crate) fn of(body: &Body, face: usize, chart: &Chart) -> Self {
        let mut loops: Vec<Vec<Vec2>> = Vec::new();
        for h in body.of_face(face) {
            let half = &body.halves[h];
            if loops.len() <= half.lap {
                loops.resize(half.lap + 1, Vec::new());
            }
            loops[half.lap].extend((0..POINTS).map(|k| {
                let (x, uv) = half.stretch.at(body.faces[face], k as f64 / POINTS as f64);
                chart.flat(&x, Some(uv))
            }));
        }
        loops.retain(|l| l.len() > 2);
        Self::from_loops(loops)
    }

    /// The region inside loops.
    pub(crate) fn from_loops(loops: Vec<Vec<Vec2>>) -> Self {
        let (min, max) = bounds(&loops);
        Self { loops, min, max }
    }

    /// The region moved.
    pub(crate) fn moved(&self, m: &Motion) -> Self {
        Self::from_loops(self.loops.iter().map(|l| l.iter().map(|p| m.apply(p)).collect()).collect())
    }

    /// Area, mm²; negative if the loops run the wrong way.
    pub(crate) fn area(&self) -> f64 {
        self.loops.iter().map(|l| area(l)).sum()
    }

    /// Whether a point lies inside.
    pub(crate) fn contains(&self, x: &Vec2) -> bool {
        inside(&self.loops, x)
    }

    /// The stretches inside of a line through `at` along the unit vector `way`.
    pub(crate) fn line(&self, at: &Vec2, way: &Vec2) -> Vec<[Vec2; 2]> {
        let cuts = crossings(&self.loops, at, way);
        let short = SHORT * (self.max - self.min).norm();
        let long = cuts.chunks_exact(2).filter(|c| c[1] - c[0] > short);
        long.map(|c| [at + way * c[0], at + way * c[1]]).collect()
    }

    /// The stretches inside of a ruling.
    pub(crate) fn own_lines(&self, ruling: &FlatRuling) -> Vec<[Vec2; 2]> {
        self.line(&ruling.at, &ruling.way).into_iter().filter_map(|l| ruling.on_own_side(l)).collect()
    }

    /// Points inside, spread over the region: at least one unless it has no area.
    pub(crate) fn inner_points(&self) -> Vec<Vec2> {
        /// Heights of lines, irrational shares so that symmetric shapes are not met at their corners.
        const HEIGHTS: [f64; 5] = [0.493_1, 0.171_3, 0.829_7, 0.037_9, 0.962_3];
        let mut out = Vec::new();
        for share in HEIGHTS {
            let at = Vec2::new(self.min.x, self.min.y + (self.max.y - self.min.y) * share);
            for [a, b] in self.line(&at, &Vec2::x()) {
                out.extend([0.5, 0.13, 0.87].map(|s| a + (b - a) * s));
            }
        }
        out
    }

    /// Whether this region and another overlap by more than `depth` (mm), as far as samples tell.
    pub(crate) fn overlaps(&self, other: &Self, depth: f64) -> bool {
        let apart = |k: usize| self.max[k] <= other.min[k] + depth || other.max[k] <= self.min[k] + depth;
        if apart(0) || apart(1) {
            return false;
        }
        let deep = |region: &Self, x: &Vec2| region.contains(x) && distance(&region.loops, x) > depth;
        if self.inner_points().iter().any(|x| deep(other, x)) || other.inner_points().iter().any(|x| deep(self, x)) {
            return true;
        }
        let crossing = |(a, b): &(Vec2, Vec2), (c, d): &(Vec2, Vec2)| {
            let across = |p: &Vec2, q: &Vec2, x: &Vec2, y: &Vec2| {
                let n = (q - p).try_normalize(0.0).unwrap_or_else(Vec2::zeros);
                let (s, t) = (n.perp(&(x - p)), n.perp(&(y - p)));
                s.min(t) < -depth && s.max(t) > depth
            };
            across(a, b, c, d) && across(c, d, a, b)
        };
        sides(&self.loops).any(|s| sides(&other.loops).any(|t| crossing(&s, &t)))
    }
}
