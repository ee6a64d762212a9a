//! Edges between parts of one body: where marks stand on both sides of them, how long both are in the plane, and at what angle the
//! faces meet (docs/algorithms/unroll.md, "Marks and bevels").

use super::tree::UnfoldedPiece;
use crate::brep::body::Body;
use crate::develop::joints::mark_count;
use crate::develop::shop::bevel::{BevelStation, PARTS};
use crate::geom::{Vec2, Vec3};
use std::collections::HashMap;

/// A place on one side of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgePlace {
    /// In the plane.
    pub point: Vec2,
    /// Unit vector into the part.
    pub inward: Vec2,
    /// In space.
    pub place: Vec3,
}

/// An edge that is on the outlines of two parts, or twice on that of one which is cut open there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SharedEdge {
    /// Numbers of the parts on both sides; twice the same where a part is cut open.
    pub parts: [usize; 2],
    /// Length of each side in the plane, mm.
    pub lengths: [f64; 2],
    /// Places on both sides that belong together, at equal steps of length.
    pub places: Vec<[EdgePlace; 2]>,
    /// How the faces meet along it.
    pub stations: Vec<BevelStation>,
}

/// A joint of parts, as its marks name it.
#[derive(Clone, Debug, PartialEq)]
pub struct PartJoint {
    /// What its marks have in common: J3 of J3.1, J3.2, …
    pub name: String,
    /// Numbers of the parts on both sides; twice the same where a part is joined to itself.
    pub parts: [usize; 2],
    /// Length of each side in the plane, mm.
    pub lengths: [f64; 2],
    /// How the faces meet along it.
    pub stations: Vec<BevelStation>,
}

/// Edges shorter than so many tolerances are corners.
const LEAST_EDGE: f64 = 8.0;
/// Steps along an edge; an even number.
const STEPS: usize = 128;
/// Share of an edge by which its direction in the plane is taken on both sides of a place.
const BESIDE: f64 = 1e-4;
/// Share of an edge at its end where the angle is that just before it.
const LAST: f64 = 1.0 - 1e-3;

/// The edges between pieces of a body, or within one that is cut open; `pieces` are numbered as they come. Measured, not proven.
pub(super) fn shared_edges(body: &Body, pieces: &[&UnfoldedPiece], tolerance: f64) -> Vec<SharedEdge> {
    let of_face: HashMap<usize, usize> =
        pieces.iter().enumerate().flat_map(|(k, p)| p.faces.iter().map(move |f| (f.face, k))).collect();
    let diagonal = of_face.keys().map(|f| body.faces[*f].surface.bbox().diagonal()).fold(0.0, f64::max);
    let edge = |h: usize| -> Option<SharedEdge> {
        let half = &body.halves[h];
        let twin = half.twin.filter(|t| *t > h)?;
        let parts = [*of_face.get(&half.face)?, *of_face.get(&body.halves[twin].face)?];
        let is_short = half.length <= LEAST_EDGE * tolerance;
        (!is_short && !pieces[parts[0]].inner.contains(&h)).then(|| of_edge(body, pieces, ([h, twin], parts), diagonal))
    };
    (0..body.halves.len()).filter_map(edge).collect()
}

/// An edge by its two runs and their pieces.
fn of_edge(
    body: &Body,
    pieces: &[&UnfoldedPiece],
    (halves, parts): ([usize; 2], [usize; 2]),
    diagonal: f64,
) -> SharedEdge {
    let [h, twin] = halves;
    let (near, far) = (&body.halves[h], &body.halves[twin]);
    let at = |s: f64| near.stretch.at(body.faces[near.face], s).0;
    let along = Along::new(at);
    let place = |side: usize, s: f64| {
        let (piece, half) = (pieces[parts[side]], halves[side]);
        let [lo, hi] = [(s - BESIDE).max(0.0), (s + BESIDE).min(1.0)].map(|s| piece.place(body, half, s));
        // Seen from outside, material is on the left of a run.
        let way = (hi - lo).try_normalize(0.0).unwrap_or_else(Vec2::x);
        let run = &body.halves[half];
        let place = run.stretch.at(body.faces[run.face], s).0;
        EdgePlace { point: piece.place(body, half, s), inward: Vec2::new(-way.y, way.x), place }
    };
    let count = mark_count(along.length(), diagonal);
    let places = (1..=count).map(|k| {
        let s = along.share(k as f64 / (count + 1) as f64);
        [place(0, s), place(1, far.stretch.nearest(body.faces[far.face], &at(s)).0)]
    });
    let station = |k: usize| {
        let s = along.share(k as f64 / PARTS as f64);
        let meeting = body.meeting_at(h, s.min(LAST));
        let kink = meeting.map_or(f64::NAN, |m| if m.convex { m.angle } else { -m.angle });
        BevelStation { position: along.length() * k as f64 / PARTS as f64, kink }
    };
    SharedEdge {
        parts,
        lengths: [0, 1].map(|side: usize| length(&|s| pieces[parts[side]].place(body, halves[side], s))),
        places: places.collect(),
        stations: (0..=PARTS).map(station).collect(),
    }
}

/// Length of a curve over [0, 1] by chords, extrapolated from two numbers of them: its error falls with the fourth power of the step.
fn length(at: &dyn Fn(f64) -> Vec2) -> f64 {
    let points: Vec<Vec2> = (0..=STEPS).map(|k| at(k as f64 / STEPS as f64)).collect();
    let by = |step: usize| -> f64 {
        let chosen: Vec<Vec2> = points.iter().step_by(step).copied().collect();
        chosen.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
    };
    by(1) + (by(1) - by(2)) / 3.0
}

/// Shares of an edge by its length.
struct Along {
    /// Length up to every step, mm.
    lengths: Vec<f64>,
}

impl Along {
    fn new(at: impl Fn(f64) -> Vec3) -> Self {
        let mut lengths = vec![0.0];
        let mut before = at(0.0);
        for k in 1..=STEPS {
            let here = at(k as f64 / STEPS as f64);
            lengths.push(lengths[k - 1] + (here - before).norm());
            before = here;
        }
        Self { lengths }
    }

    fn length(&self) -> f64 {
        self.lengths[STEPS]
    }

    /// The parameter at a share of the length.
    fn share(&self, part: f64) -> f64 {
        let wanted = part * self.length();
        let k = self.lengths.partition_point(|l| *l <= wanted).clamp(1, STEPS);
        let (a, b) = (self.lengths[k - 1], self.lengths[k]);
        (k as f64 - 1.0 + ((wanted - a) / (b - a)).clamp(0.0, 1.0)) / STEPS as f64
    }
}
