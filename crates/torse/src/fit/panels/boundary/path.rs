//! The places that the trimming curve of a run passes: feet of the border, points on common lines, or a shared edge
//! (certificate specification, section 5).

use super::borders::{Borders, BoundaryOptions};
use crate::fit::panels::line_intersection::on_leaning;
use crate::fit::panels::trim::Waypoint;
use crate::geom::Vec3;
use crate::num::hash::HashMap;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use crate::torse::convert;
use crate::torse::form::Torse;

/// Kinks that the polyline keeps are smoothed over by at most this multiple of the trim tolerance: what the curve
/// strays there counts against the panel.
const KINKED: f64 = 8.0;
/// Shares of the trim tolerance and of its length that trimming curves may stray from a shared edge: it is smooth, and
/// both sides' edges in the flat are to be equally long.
const SHARED: (f64, f64) = (0.02, 3e-8);
/// Share of the bend of the border polyline that a trimming curve may smooth over: the polyline's own chords are
/// off a smooth border by a quarter of the bend.
const SMOOTHED: f64 = 0.5;

/// How far (mm) a trimming curve may stray from a border polyline that bends by `bend`.
pub(super) fn smoothed(bend: f64, trim_tolerance: f64) -> f64 {
    (SMOOTHED * bend).clamp(trim_tolerance, KINKED * trim_tolerance)
}

/// What a run aims at.
pub(super) enum Aim<'a> {
    /// The feet of the border's points.
    Feet,
    /// The places where the torse meets the lines on which panels end, moved to given ends by so much.
    Normals([[f64; 2]; 2]),
    /// A curve on the torse, and its length, mm.
    Edge(&'a Curve<3>, f64),
}

/// What the trimming curve of a run should follow: the feet of the border's points on the torse.
pub(super) struct Path<'a> {
    pub(super) aim: Aim<'a>,
    pub(super) borders: &'a Borders<'a>,
    pub(super) torse: &'a Torse,
    pub(super) patch: &'a Surface,
    pub(super) vertices: &'a [u32],
    pub(super) parameters: &'a [f64],
    pub(super) places: &'a HashMap<u32, [f64; 2]>,
    pub(super) options: &'a BoundaryOptions,
}

impl Path<'_> {
    /// Vertices and points of the edges between them.
    pub(super) fn waypoints(&self) -> Vec<Waypoint> {
        /// Waypoints wanted on a run at least, and on each span of the torse: the feet move unevenly there.
        const WANTED: (usize, f64) = (48, 6.0);
        let edges = self.vertices.len() - 1;
        let (breaks, domain) = (self.torse.breaks(), self.torse.domain());
        let span = (domain.1 - domain.0) / (breaks.len() - 1) as f64;
        let mut out = Vec::with_capacity(4 * edges);
        for k in 0..=edges {
            let here = self.places[&self.vertices[k]];
            let allowance = self.allowance(self.bend(k));
            out.push(Waypoint { s: self.parameters[k], place: here, allowance });
            if k == edges {
                break;
            }
            let next = self.places[&self.vertices[k + 1]];
            let spans = (next[0] - here[0]).abs() / span;
            let inner = (WANTED.0 / edges).max((WANTED.1 * spans).ceil() as usize).clamp(1, 40);
            out.extend((1..=inner).filter_map(|i| {
                let l = i as f64 / (inner + 1) as f64;
                self.inside(k, l, here[0] + (next[0] - here[0]) * l)
            }));
        }
        out
    }

    /// A waypoint between two others.
    pub(super) fn between(&self, a: &Waypoint, b: &Waypoint) -> Option<Waypoint> {
        let s = 0.5 * (a.s + b.s);
        if !(s > a.s && s < b.s) {
            return None;
        }
        let k = self.parameters.partition_point(|p| *p <= s).clamp(1, self.parameters.len() - 1) - 1;
        let l = (s - self.parameters[k]) / (self.parameters[k + 1] - self.parameters[k]);
        self.inside(k, l, 0.5 * (a.place[0] + b.place[0]))
    }

    /// Point at the fraction `l` of the edge that leaves vertex `k`.
    fn inside(&self, k: usize, l: f64, guess: f64) -> Option<Waypoint> {
        let face = self.borders.face;
        let [p, q] = [k, k + 1].map(|k| self.borders.partition.vertices[self.vertices[k] as usize]);
        let uv = [p[0] + (q[0] - p[0]) * l, p[1] + (q[1] - p[1]) * l];
        let s = self.parameters[k] + (self.parameters[k + 1] - self.parameters[k]) * l;
        let mut shift = [0.0; 2];
        let (t, x) = match &self.aim {
            Aim::Feet => {
                let x = face.surface.point(uv[0], uv[1]);
                (self.torse.foot(&x, guess)?, x)
            }
            Aim::Normals([a, b]) => {
                shift = [0, 1].map(|d: usize| a[d] * (1.0 - s) + b[d] * s);
                let normal = self.borders.lean_between(self.vertices[k], self.vertices[k + 1], l);
                on_leaning(&face.surface.point(uv[0], uv[1]), &normal, self.torse, guess)?
            }
            Aim::Edge(edge, _) => {
                let x = Vec3::from(edge.point(s));
                (self.torse.foot(&x, guess)?, x)
            }
        };
        Some(Waypoint {
            s,
            place: [t + shift[0], convert::parameters(self.patch, t, &x) + shift[1]],
            allowance: self.allowance(self.bend(k).max(self.bend(k + 1))),
        })
    }

    /// How far (mm) the curve may stray where the border bends by `bend`.
    fn allowance(&self, bend: f64) -> f64 {
        if let Aim::Edge(_, length) = self.aim {
            return (SHARED.0 * self.options.trim_tolerance).min(SHARED.1 * length);
        }
        smoothed(bend, self.options.trim_tolerance)
    }

    /// How far the border bends away from a smooth one at the `k`-th vertex; its ends are corners anyway.
    fn bend(&self, k: usize) -> f64 {
        if k == 0 || k + 1 == self.vertices.len() {
            0.0
        } else {
            self.borders.bend.get(&self.vertices[k]).copied().unwrap_or(0.0)
        }
    }
}
