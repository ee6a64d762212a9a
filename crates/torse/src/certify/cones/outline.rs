//! Proof that a cone spline cut along an outline and the region that it stands for lie within a distance of each other,
//! in both directions, edges as they stand in files.
//!
//! *Method* (docs/algorithms/cones.md): feet on the chain map the region's boundary to a closed curve in the plane of
//! (turn, r). It is joined to the edges of the pieces by paths along the cones, whose lengths are enclosed for every
//! point of the boundary. A point of the part off these paths is enclosed by the feet as often as by the edges, so it is
//! a foot of the region; a foot off the paths is enclosed by the edges, because the map does not fold \[LP98\].

use super::matching::{matched, Passed, Ring};
use super::side::{off_ruling, side, speed, ConeSegment, EdgeCurve, Ground, Side, SidePiece};
use super::{ConeProof, Prepared, ROUNDING};
use crate::certify::boundary::clamped;
use crate::certify::claim::UpperBound;
use crate::certify::vector::length_bound;
use crate::geom::Vec3;
use crate::num::interval::Interval;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use crate::torse::cone::part::{ConePart, PartCurve};
use crate::torse::cone::spline::ConeSpline;
use crate::torse::ruled_patch::RuledPatch;

/// A region of a ruled patch.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// The patch, of degree 1 in v.
    pub patch: &'a Surface,
    /// The strip of it that the chain was judged against; it holds the region.
    pub strip: &'a RuledPatch,
    /// Closed loops of curves in the parameter plane, each beginning where the one before ends, bit by bit.
    pub loops: &'a [Vec<Curve<2>>],
}

/// What was proven of a trimmed chain; only [`outline`] makes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineProof {
    bound: UpperBound,
    path: UpperBound,
    edges: UpperBound,
}

impl OutlineProof {
    /// Every point of the region is within this distance (mm) of the part, and every point of the part of the region.
    pub fn bound(&self) -> UpperBound {
        self.bound
    }

    /// Length (mm) along the cones between the foot of any point of the outline and the part's edge there.
    pub fn path_bound(&self) -> UpperBound {
        self.path
    }

    /// Every point of an edge as it stands in files is within this distance (mm) of the exact surfaces that it bounds.
    pub fn edge_bound(&self) -> UpperBound {
        self.edges
    }
}

/// Why nothing was proven.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OutlineFault {
    /// The loops of the part are not those of the region.
    #[error("the part has {found} closed edges, its outline {wanted}")]
    Loops {
        /// Loops of the part.
        found: usize,
        /// Loops of the region.
        wanted: usize,
    },
    /// A loop that does not close, or an edge that does not belong to one piece or to both sides of a joint.
    #[error("the edges of piece {piece} do not bound it")]
    Open {
        /// Number of the piece.
        piece: usize,
    },
    /// A stretch of the outline that the edges do not follow.
    #[error("the edges of piece {piece} do not follow the outline near ({:.3}, {:.3}, {:.3})", .place[0], .place[1], .place[2])]
    Strays {
        /// Number of the piece.
        piece: usize,
        /// Where, mm.
        place: [f64; 3],
    },
}

/// Pieces are halved until their bounds exceed what is reached at their ends by less than this share of the tolerance.
const EXCESS: f64 = 5e-3;
/// Halvings of a piece at most.
const DEPTH: usize = 14;

/// The proof for a chain cut along the outline of a region.
///
/// *Input*: `proof` is that of the chain against the region's strip; `part` is cut from `spline`, whose cones are
/// those of that proof. *Guarantee*: as documented at [`OutlineProof`], for the exact cones and for the edges as
/// curves of numbers, rounding included. *Not guaranteed*: that edges do not cross each other within the distance proven.
///
/// # Errors
/// See [`OutlineFault`].
/// *Cost*: some 50 µs for a piece of an edge.
pub fn outline(
    region: &Region,
    part: &ConePart,
    spline: &ConeSpline,
    proof: &ConeProof,
    tolerance: f64,
) -> Result<OutlineProof, OutlineFault> {
    let faces = owners(part)?;
    let nothing = UpperBound::shown(0.0);
    let joints = UpperBound::shown(joints_off(part, spline, &faces)?);
    let mut out = OutlineProof { bound: proof.lines_bound(), path: nothing, edges: joints };
    let cones: Vec<ConeSegment> = part.faces.iter().map(|f| cone(f.segment, spline, &f.blank.segment)).collect();
    let loops = part.outline();
    if loops.len() != region.loops.len() {
        return Err(OutlineFault::Loops { found: loops.len(), wanted: region.loops.len() });
    }
    let mut rings: Vec<Ring> = Vec::with_capacity(loops.len());
    for curves in region.loops {
        if !closed(curves) {
            return Err(OutlineFault::Open { piece: 0 });
        }
        rings.push(Ring::new(region.patch, curves));
    }
    let ground = Ground { patch: region.patch, strip: region.strip };
    for uses in &loops {
        let piece_of = |k: usize| faces[uses[k % uses.len()].0][0].unwrap_or(0);
        let passed = passed(part, spline, uses, &|k| piece_of(k)).ok_or(OutlineFault::Open { piece: piece_of(0) })?;
        let points = part.polyline(uses);
        let points = &points[..points.len().saturating_sub(1)];
        // The ring that lies nearest to all of the loop, each once.
        let far = |r: &Ring| points.iter().map(|x| r.far(x)).fold(0.0, f64::max);
        let nearest = (0..rings.len()).min_by(|&a, &b| far(&rings[a]).total_cmp(&far(&rings[b])));
        let mut ring = rings.swap_remove(nearest.unwrap_or(0));
        ring.follow(points);
        out.edges = out.edges.max(UpperBound::shown(gaps(part, uses, &passed)));
        let pieces = matched(&mut ring, &passed).ok_or(OutlineFault::Open { piece: piece_of(0) })?;
        let mut waiting: Vec<_> = pieces.into_iter().rev().map(|m| (m, 0)).collect();
        while let Some((m, depth)) = waiting.pop() {
            let piece = piece_of(m.edge);
            let edge = &passed[m.edge].curve;
            let found = side(&ground, &cones[piece], &SidePiece { border: ring.stretch(m.tau), edge: (edge, m.s) });
            let fine = found.as_ref().is_some_and(|f| f.bound <= out.bound.value().max(f.at_ends + EXCESS * tolerance));
            if !fine && depth < DEPTH {
                let s = 0.5 * (m.s[0] + m.s[1]);
                let tau = ring.between(&edge.point(s), m.tau);
                waiting
                    .push((super::matching::Matched { edge: m.edge, s: [s, m.s[1]], tau: [tau, m.tau[1]] }, depth + 1));
                waiting
                    .push((super::matching::Matched { edge: m.edge, s: [m.s[0], s], tau: [m.tau[0], tau] }, depth + 1));
                continue;
            }
            let Some(Side { bound, path, off, .. }) = found else {
                return Err(OutlineFault::Strays { piece, place: edge.point(m.s[0]).into() });
            };
            out.bound = out.bound.max(UpperBound::shown(bound));
            out.path = out.path.max(UpperBound::shown(path));
            out.edges = out.edges.max(UpperBound::shown(off));
        }
    }
    let reach = part.vertices.iter().map(|p| p.norm()).fold(0.0, f64::max);
    out.edges = out.edges.plus(UpperBound::shown(ROUNDING * reach));
    out.bound = out.bound.plus(out.edges);
    Ok(out)
}

/// Distance (mm) that a boundary which strays from that of a rectangle by a share of its parameters may be off in space.
pub(crate) fn astray_bound(patch: &Surface, share: f64) -> UpperBound {
    let breaks = patch.knots_u.breaks();
    let whole = breaks[breaks.len() - 1] - breaks[0];
    let span = |w: &[f64]| speed(patch, patch.knots_u.span(0.5 * (w[0] + w[1]))) * (1.0 + whole / (w[1] - w[0]));
    UpperBound::largest(breaks.windows(2).map(|w| UpperBound::shown(share * span(w))))
}

/// The pieces that use each edge: one for outlines, two of neighbouring segments, in opposite senses, for joints.
fn owners(part: &ConePart) -> Result<Vec<[Option<usize>; 2]>, OutlineFault> {
    let mut uses: Vec<Vec<(usize, bool)>> = vec![Vec::new(); part.edges.len()];
    for (k, face) in part.faces.iter().enumerate() {
        for cycle in &face.loops {
            let ends = |&(e, forward): &(usize, bool)| {
                let e = part.edges.get(e)?;
                Some(if forward { (e.start, e.end) } else { (e.end, e.start) })
            };
            let closes = (0..cycle.len()).all(|i| {
                let (a, b) = (ends(&cycle[i]), ends(&cycle[(i + 1) % cycle.len()]));
                a.zip(b).is_some_and(|(a, b)| a.1 == b.0)
            });
            if !closes || cycle.is_empty() {
                return Err(OutlineFault::Open { piece: k });
            }
            for &(e, forward) in cycle {
                uses[e].push((k, forward));
            }
        }
    }
    uses.iter()
        .zip(&part.edges)
        .map(|(u, e)| match u[..] {
            [] => Ok([None, None]),
            [(a, _)] => Ok([Some(a), None]),
            [(a, sense), (b, other)] => {
                let apart = part.faces[a].segment.abs_diff(part.faces[b].segment);
                let joint = sense != other && apart == 1 && matches!(e.curve, PartCurve::Ruling);
                joint.then_some([Some(a), Some(b)]).ok_or(OutlineFault::Open { piece: a })
            }
            [(a, _), ..] => Err(OutlineFault::Open { piece: a }),
        })
        .collect()
}

/// Distance of joints from the last ruling of the segment before and the first of the one behind.
fn joints_off(part: &ConePart, spline: &ConeSpline, faces: &[[Option<usize>; 2]]) -> Result<f64, OutlineFault> {
    let mut worst = 0.0_f64;
    for (owners, edge) in faces.iter().zip(&part.edges) {
        let [Some(a), Some(b)] = owners else { continue };
        let first = part.faces[*a].segment.min(part.faces[*b].segment);
        let open = || OutlineFault::Open { piece: *a };
        let (before, behind) = (spline.segments.get(first), spline.segments.get(first + 1));
        let (before, behind) = before.zip(behind).ok_or_else(open)?;
        let ends = [edge.start, edge.end].map(|v| part.vertices.get(v).copied());
        let [Some(p), Some(q)] = ends else { return Err(open()) };
        worst = worst.max(off_ruling(&before.end(), &[p, q])).max(off_ruling(&behind.start, &[p, q]));
    }
    Ok(worst)
}

/// What a piece is cut from: the cone of its blank between the joints of its segment.
fn cone(segment: usize, spline: &ConeSpline, blank: &crate::torse::cone::spline::Segment) -> ConeSegment {
    let front = (segment > 0).then_some(blank.start);
    let back = spline.segments.get(segment + 1).map(|s| s.start);
    ConeSegment { prepared: Prepared::new(blank), front, back }
}

/// The edges of a loop with their senses and the joints at which they end. `None` for edges that do not exist, or whose
/// curve is none of files.
fn passed(
    part: &ConePart,
    spline: &ConeSpline,
    uses: &[(usize, bool)],
    piece_of: &dyn Fn(usize) -> usize,
) -> Option<Vec<Passed>> {
    let segment = |k: usize| part.faces.get(piece_of(k)).map(|f| f.segment);
    (0..uses.len())
        .map(|k| {
            let (e, forward) = uses[k];
            let edge = part.edges.get(e)?;
            let ends: [Vec3; 2] = [*part.vertices.get(edge.start)?, *part.vertices.get(edge.end)?];
            let curve = match &edge.curve {
                PartCurve::Ruling => EdgeCurve::Line(ends),
                PartCurve::Free { space, .. } => {
                    if !clamped(space) {
                        return None;
                    }
                    EdgeCurve::Spline(space.clone())
                }
            };
            let (here, next) = (segment(k)?, segment(k + 1)?);
            let joint = (here != next).then(|| spline.segments.get(here.max(next)).map(|s| s.start)).flatten();
            Some(Passed { curve, forward, joint })
        })
        .collect()
}

/// Distance of the ends of edges from the vertices that files name.
fn gaps(part: &ConePart, uses: &[(usize, bool)], passed: &[Passed]) -> f64 {
    let mut worst = 0.0_f64;
    for ((e, _), p) in uses.iter().zip(passed) {
        let EdgeCurve::Spline(c) = &p.curve else { continue };
        let (edge, last) = (&part.edges[*e], c.control.len() - 1);
        for (v, end) in [(edge.start, 0), (edge.end, last)] {
            let d = std::array::from_fn(|k| Interval::point(c.control[end][k]) - Interval::point(part.vertices[v][k]));
            worst = worst.max(length_bound(&d));
        }
    }
    worst
}

/// Whether curves make a closed loop, bit by bit, each from its first to its last control point.
fn closed(curves: &[Curve<2>]) -> bool {
    let ends = |c: &Curve<2>| Some((*c.control.first()?, *c.control.last()?));
    !curves.is_empty()
        && curves.iter().all(|c| {
            let (v, p) = (c.knots.values(), c.knots.degree());
            let n = v.len();
            v[..=p].iter().all(|x| *x == v[0]) && v[n - 1 - p..].iter().all(|x| *x == v[n - 1])
        })
        && (0..curves.len()).all(|i| {
            let (a, b) = (ends(&curves[i]), ends(&curves[(i + 1) % curves.len()]));
            a.zip(b).is_some_and(|(a, b)| a.1 == b.0)
        })
}
