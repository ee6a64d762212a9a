//! Points and curves carried between parts in space and their flat patterns, by the map of the panels' patches \[DC76\].
//!
//! A point in space goes to its nearest place on a panel within its edges and from there to the drawing by the isometric map
//! that made it, laid onto the outline as written; the way back is the same map inverted by Newton's method.

use super::atlas::Atlas;
use super::drawn::{distance, inside, FlatPart};
use crate::geom::{BBox, Vec2, Vec3};
use crate::torse::rail::Rail;
use rayon::prelude::*;

/// Where artwork is carried to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// To the flat patterns.
    Flat,
    /// To the parts in space.
    Space,
}

/// A part ready to carry artwork.
#[derive(Clone, Debug)]
pub struct MapPart {
    /// Name.
    pub name: String,
    /// Its drawing.
    pub(crate) flat: FlatPart,
    /// Its panels in space and laid flat.
    pub(crate) atlas: Atlas,
    /// Box around its panels.
    pub(crate) bounds: BBox,
    /// Distance (mm) of the panels' corners from the outline drawn: what places in the drawing may be off.
    pub alignment: f64,
}

/// The parts of a result.
#[derive(Clone, Debug)]
pub struct ArtworkMap {
    /// Parts that can be used.
    pub parts: Vec<MapPart>,
    /// Parts that cannot, with the reason.
    pub left: Vec<(String, String)>,
    /// Distance (mm) within which a point is on a part.
    pub within: f64,
}

/// Curves carried over: pieces on parts, and how long what lies on no part is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurvePieces {
    /// Name of the part and points, mm.
    pub pieces: Vec<(String, Vec<Vec3>)>,
    /// Length of the curve on no part, mm, about.
    pub off: f64,
    /// Largest distance (mm) of what lies on no part.
    pub farthest: f64,
}

/// Parts of a curve's extent from point to point.
const POINTS: f64 = 400.0;
/// Points on every smooth piece of a curve at least, and at most.
const PER_PIECE: (usize, usize) = (2, 4000);
/// Halvings with which the end of a piece on a part is found.
const HALVINGS: usize = 40;

/// A point that was carried over, or what keeps it from being.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRow {
    /// Line of the input.
    pub line: usize,
    /// Name of the part.
    pub part: String,
    /// Its place on the other side, mm; `None` for points on no part.
    pub place: Option<Vec3>,
    /// Distance from the part, mm.
    pub distance: f64,
}

/// A place found.
struct Found {
    part: usize,
    place: Vec3,
    off: f64,
}

impl ArtworkMap {
    /// The nearest part of a point, its place on the other side, and how far off the point is.
    fn nearest(&self, x: &Vec3, to: Side) -> Option<Found> {
        match to {
            Side::Flat => self.in_plane(x),
            Side::Space => self.in_space(&x.xy()),
        }
    }

    fn in_plane(&self, x: &Vec3) -> Option<Found> {
        let mut best: Option<Found> = None;
        let away = |b: &BBox| (b.min - x).sup(&(x - b.max)).sup(&Vec3::zeros()).norm();
        let mut order: Vec<(f64, usize)> = self.parts.iter().map(|p| away(&p.bounds)).zip(0..).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (least, part) in order {
            if best.as_ref().is_some_and(|b| b.off <= least) {
                break;
            }
            let atlas = &self.parts[part].atlas;
            let Some(on) = atlas.from_space(x) else { continue };
            if best.as_ref().is_none_or(|b| on.off < b.off) {
                let q = atlas.flat(&on);
                best = Some(Found { part, place: Vec3::new(q.x, q.y, 0.0), off: on.off });
            }
        }
        best
    }

    fn in_space(&self, q: &Vec2) -> Option<Found> {
        let off = |p: &MapPart| if inside(&p.flat.loops, q) { 0.0 } else { distance(&p.flat.loops, q) };
        let (off, part) = self.parts.iter().map(off).zip(0..).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let atlas = &self.parts[part].atlas;
        let on = atlas.from_flat(q)?;
        Some(Found { part, place: atlas.space(&on), off: off.max(on.off) })
    }

    /// Carries points over, each with its line.
    pub fn points(&self, points: &[(usize, Vec3)], to: Side) -> Vec<PointRow> {
        let row = |(line, x): &(usize, Vec3)| match self.nearest(x, to) {
            Some(f) => {
                let on = f.off <= self.within;
                let part = if on { self.parts[f.part].name.clone() } else { String::new() };
                PointRow { line: *line, part, place: on.then_some(f.place), distance: f.off }
            }
            None => PointRow { line: *line, part: String::new(), place: None, distance: f64::INFINITY },
        };
        points.par_iter().map(row).collect()
    }

    /// Carries a curve over as polylines, one for every stretch on a part; ends of stretches are on the edge of the part as
    /// near as numbers tell.
    pub fn curve(&self, rail: &Rail, to: Side) -> CurvePieces {
        let step = rail.bbox().diagonal() / POINTS;
        let mut at: Vec<f64> = Vec::new();
        for k in 0..rail.pieces.len() {
            let length = rail.piece_length(k, rail.pieces[k].knots.domain().1);
            let n = ((length / step).ceil() as usize).clamp(PER_PIECE.0, PER_PIECE.1);
            at.extend((0..n).map(|i| k as f64 + i as f64 / n as f64));
        }
        at.push(rail.pieces.len() as f64);
        let found: Vec<Option<Found>> = at.par_iter().map(|s| self.nearest(&point(rail, *s), to)).collect();
        let on = |f: &Option<Found>| f.as_ref().filter(|f| f.off <= self.within).map(|f| f.part);
        let mut out = CurvePieces::default();
        let mut open: Option<(usize, Vec<Vec3>)> = None;
        for k in 0..at.len() {
            let part = on(&found[k]);
            if let Some(f) = found[k].as_ref().filter(|_| part.is_none()) {
                out.farthest = out.farthest.max(f.off);
            }
            if k > 0 && on(&found[k - 1]) != part {
                let (leave, enter) = self.crossing(rail, [at[k - 1], at[k]], [on(&found[k - 1]), part], to);
                if let Some((p, mut line)) = open.take() {
                    line.extend(leave);
                    out.pieces.push((self.parts[p].name.clone(), line));
                }
                open = part.map(|p| (p, enter.into_iter().collect()));
            } else if k > 0 && part.is_none() {
                out.off += (point(rail, at[k]) - point(rail, at[k - 1])).norm();
            }
            if let (Some(p), Some(f)) = (part, &found[k]) {
                open.get_or_insert_with(|| (p, Vec::new())).1.push(f.place);
            }
        }
        if let Some((p, line)) = open {
            out.pieces.push((self.parts[p].name.clone(), line));
        }
        out.pieces.retain(|p| p.1.len() > 1);
        out
    }

    /// Last place on the part that a curve leaves and first place on the one that it enters.
    fn crossing(
        &self,
        rail: &Rail,
        ends: [f64; 2],
        parts: [Option<usize>; 2],
        to: Side,
    ) -> (Option<Vec3>, Option<Vec3>) {
        let edge = |from: f64, beyond: f64, part: Option<usize>| {
            let part = part?;
            let (mut a, mut b, mut last) = (from, beyond, None);
            for _ in 0..HALVINGS {
                let m = 0.5 * (a + b);
                match self.nearest(&point(rail, m), to).filter(|f| f.off <= self.within && f.part == part) {
                    Some(f) => (a, last) = (m, Some(f.place)),
                    None => b = m,
                }
            }
            last
        };
        (edge(ends[0], ends[1], parts[0]), edge(ends[1], ends[0], parts[1]))
    }
}

/// The point of a rail at piece number and share of its domain.
fn point(rail: &Rail, s: f64) -> Vec3 {
    let k = (s.floor() as usize).min(rail.pieces.len() - 1);
    let c = &rail.pieces[k];
    let (a, b) = c.knots.domain();
    crate::torse::rail::jet(c, a + (b - a) * (s - k as f64).clamp(0.0, 1.0))[0]
}
