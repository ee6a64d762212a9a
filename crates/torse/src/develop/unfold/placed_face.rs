//! A face of a part where it lies in the part: its map, and its own region of the pattern.

use super::chart::Chart;
use super::region::Motion;
use super::tree::{Placed, UnfoldedPiece};
use crate::brep::body::Body;
use crate::geom::{Vec2, Vec3};

/// The map of a face, and where its image lies in the part.
#[derive(Clone, Debug)]
pub struct PlacedChart {
    /// The map.
    pub chart: Chart,
    /// The motion after it.
    pub motion: Motion,
}

/// The region of a face in the pattern of its part.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceRegion {
    /// Outline and holes as polygons within a share of the tolerance, edges inside the part among them.
    pub loops: Vec<Vec<Vec2>>,
    /// Between which places (mm) along its rulings a circular face lies.
    pub reach: [f64; 2],
    /// Thickness (mm) of the sheet whose skin it is; 0 for surfaces.
    pub thickness: f64,
}

/// A face of a part with its map and its region.
#[derive(Clone, Debug)]
pub struct PlacedFace {
    /// Its map, and where the image lies.
    pub placed: PlacedChart,
    /// Its region in the pattern.
    pub region: FaceRegion,
}

/// Share of the tolerance within which chords keep to the border of a face.
const NEAR: f64 = 0.02;
/// Equal stretches of every run at least: shares at which nothing is seen of a bend otherwise.
const LEAST: usize = 4;
/// Halvings of a stretch at most.
const DEEPEST: usize = 12;
/// Shares of a stretch at which it is compared with its chord: the same from either end, so that faces on both sides of an edge have
/// the same points of it.
const LOOKS: [f64; 3] = [0.3, 0.5, 0.7];

/// The region of a face of a piece; `thickness` as of [`FaceRegion`].
pub(super) fn region(
    body: &Body,
    piece: &UnfoldedPiece,
    placed: &Placed,
    thickness: f64,
    tolerance: f64,
) -> FaceRegion {
    let mut loops: Vec<Vec<Vec2>> = Vec::new();
    let mut border: Vec<Vec3> = Vec::new();
    for h in body.of_face(placed.face) {
        let half = &body.halves[h];
        if loops.len() <= half.lap {
            loops.resize(half.lap + 1, Vec::new());
        }
        let place = |s: f64| piece.place(body, h, s);
        for s in shares(&place, NEAR * tolerance) {
            border.push(half.stretch.at(body.faces[placed.face], s).0);
            loops[half.lap].push(place(s));
        }
    }
    loops.retain(|l| l.len() > 2);
    FaceRegion { loops, reach: placed.chart.reach(border.into_iter()), thickness }
}

/// Shares of a curve over [0, 1], rising from 0 and without the last, between which chords keep within `near` (mm) of it; of a
/// straight line 0 alone.
fn shares(place: &dyn Fn(f64) -> Vec2, near: f64) -> Vec<f64> {
    let off = |a: f64, b: f64| {
        let (p, q) = (place(a), place(b));
        let way = (q - p).try_normalize(0.0);
        let far = |x: f64| {
            let d = place(a + (b - a) * x) - p;
            way.map_or(d.norm(), |w| w.perp(&d).abs())
        };
        LOOKS.map(far).into_iter().fold(0.0, f64::max)
    };
    let part = |k: usize| k as f64 / LEAST as f64;
    let mut out = Vec::new();
    let mut open: Vec<(f64, f64, usize)> = (0..LEAST).rev().map(|k| (part(k), part(k + 1), 0)).collect();
    while let Some((a, b, depth)) = open.pop() {
        if depth < DEEPEST && off(a, b) > near {
            let m = 0.5 * (a + b);
            open.push((m, b, depth + 1));
            open.push((a, m, depth + 1));
        } else {
            out.push(a);
        }
    }
    // What is straight throughout is one chord.
    let straight = out.len() == LEAST && (1..LEAST).all(|k| distance(place, part(k)) <= near);
    if straight {
        out.truncate(1);
    }
    out
}

/// Distance of a place of a curve from the line between its ends.
fn distance(place: &dyn Fn(f64) -> Vec2, share: f64) -> f64 {
    let (p, d) = (place(0.0), place(share) - place(0.0));
    (place(1.0) - p).try_normalize(0.0).map_or(d.norm(), |w| w.perp(&d).abs())
}
