//! What of a face can have ruled strips: the pieces where it is saddle-shaped, or so nearly flat in one direction that
//! straight lines keep to the tolerance \[W15, 2C\].

use super::left_out::{Around, LeftOut};
use crate::brep::face::{Face, TrimLoop};
use crate::fit::panels::chains;
use crate::fit::ruled::directions::Curvatures;
use crate::geom::Vec3;
use crate::num::hash::HashMap;
use crate::patchwork::partition::{edges, Partition};
use crate::search::cover::Cover;
use crate::spline::surface::SurfaceJet;
use std::sync::Arc;

/// A piece of a face.
pub(crate) struct FacePiece {
    /// The face, bounded by the piece.
    pub face: Face,
    /// Its triangles, all with the label 0.
    pub partition: Partition,
    /// Surface at its vertices.
    pub jets: Vec<SurfaceJet>,
    /// Area, mm².
    pub area: f64,
}

impl FacePiece {
    /// Which piece it is.
    pub(super) fn around(&self) -> Around {
        let middle = self.jets.iter().map(|j| j.p).sum::<Vec3>() / self.jets.len().max(1) as f64;
        Around { entity: self.face.entity, middle }
    }

    /// The piece cut in two or more where its directions have no order: through its flattest point if it has a planar one,
    /// else in the middle of its longer side. `None` if nothing is cut.
    pub(super) fn divided(&self, depth: usize) -> Option<Vec<Self>> {
        let bend = |j: &SurfaceJet| Curvatures::of(j).map_or(0.0, |c| c.principal[0] - c.principal[1]);
        let mean = self.jets.iter().map(bend).sum::<f64>() / self.jets.len().max(1) as f64;
        let flattest = (0..self.jets.len()).min_by(|&a, &b| bend(&self.jets[a]).total_cmp(&bend(&self.jets[b])))?;
        let b = self.partition.bounds(0);
        let at = self.partition.vertices[flattest];
        let inner = |d: usize| {
            at[d] > b[2 * d] + MARGIN * (b[2 * d + 1] - b[2 * d])
                && at[d] < b[2 * d + 1] - MARGIN * (b[2 * d + 1] - b[2 * d])
        };
        let planar = bend(&self.jets[flattest]) < PLANAR * mean;
        let long = [0, 1].map(|d: usize| {
            let pace = self.jets.iter().map(|j| if d == 0 { j.du.norm() } else { j.dv.norm() }).sum::<f64>();
            pace * (b[2 * d + 1] - b[2 * d])
        });
        let longer = usize::from(long[1] > long[0]);
        let (d, place) = if planar && inner(depth % 2) {
            (depth % 2, at[depth % 2])
        } else {
            (longer, 0.5 * (b[2 * longer] + b[2 * longer + 1]))
        };
        let mut partition = self.partition.clone();
        partition.cut(0, 1, |p| p[d] - place);
        let mut jets = self.jets.clone();
        jets.extend(partition.vertices[jets.len()..].iter().map(|p| self.face.surface.jet(p[0], p[1])));
        let new = partition.trim_edges.values().copied().max().unwrap_or(0) + 1;
        let mut out = Vec::new();
        for side in [0, 1] {
            if partition.region(side).is_empty() {
                return None;
            }
            for label in partition.split_components(side) {
                out.push(part(&self.face, (&partition, &jets), label, new));
            }
        }
        Some(out)
    }
}

/// The triangles of a label as a piece.
fn part(face: &Face, (whole, all): (&Partition, &[SurfaceJet]), label: u32, new: u32) -> FacePiece {
    let (mut partition, old) = whole.extract(label);
    partition.labels.iter_mut().for_each(|l| *l = 0);
    partition.trim_edges = border_numbers(&partition, &old, whole, new);
    let jets: Vec<SurfaceJet> = old.iter().map(|&v| all[v as usize]).collect();
    let triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| jets[v as usize].p);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    let area = partition.triangles.iter().map(triangle).sum();
    FacePiece { face: bounded_by(face, &partition), partition, jets, area }
}

/// Difference of principal curvatures, share of the mean, below which a point counts as planar.
const PLANAR: f64 = 0.05;
/// Share of a piece's box beside its border where it is not cut.
const MARGIN: f64 = 0.1;
/// Triangles across a face at least and at most.
const CELLS: [f64; 2] = [32.0, 150.0];
/// Share of the tolerance that chords of strip boundaries may keep from these.
const CHORDS: f64 = 0.03;
/// Pieces below this share of the face's area are left out.
const SLIVER: f64 = 1e-4;
/// Curvature times size at which the map is half way to a full colour.
const SHADE: f64 = 0.05;

/// Lines of triangles in u (0) or v (1).
pub(super) fn lines(face: &Face, d: usize, tolerance: f64) -> Vec<f64> {
    let all = face.loops.iter().flat_map(|l| &l.points).map(|p| p[d]);
    let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
    let size = face.surface.bbox().diagonal();
    // Chords of curves about as bent as a circle of the model's size.
    let count = (size / (8.0 * CHORDS * tolerance * 0.5 * size).sqrt()).clamp(CELLS[0], CELLS[1]).round() as usize;
    (0..=count).map(|k| lo + (hi - lo) * k as f64 / count as f64).collect()
}

/// A number from −1 to 1 with the sign of the Gauss curvature.
pub(super) fn shade(c: &Curvatures, size: f64) -> f64 {
    let bend = c.gauss().signum() * (c.principal[0].abs() * c.principal[1].abs()).sqrt() * size;
    bend / (bend.abs() + SHADE)
}

/// The pieces of a face that can have strips, and what cannot, with its area in mm².
pub(super) fn pieces(mut cover: Cover, tolerance: f64) -> (Vec<FacePiece>, Vec<(LeftOut, f64)>) {
    let face = Arc::clone(&cover.face);
    let size = face.surface.bbox().diagonal();
    // Rulings of half the face's size keep to half the tolerance up to this curvature, where it is positive: what bends more
    // would need strips with kinks between them.
    let allowed = 16.0 * tolerance / size.powi(2);
    let bend =
        |p: [f64; 2]| Curvatures::of(&face.surface.jet(p[0], p[1])).map_or(allowed, |c| c.least_bend() - allowed);
    let domed = 1;
    let before = cover.partition.triangles.len();
    cover.cut(0, domed, bend);
    let whole = cover.region(0).area() + cover.region(domed).area();
    let mut left = Vec::new();
    let area = cover.region(domed).area();
    if area > 0.0 {
        left.push((LeftOut::Domed { entity: face.entity, percent: 100.0 * area / whole }, area));
    }
    let labels = if cover.region(0).cells().is_empty() { Vec::new() } else { cover.partition.split_components(0) };
    let alone = area <= 0.0 && labels.len() == 1 && cover.partition.triangles.len() == before;
    let jets: Vec<SurfaceJet> = cover.jets.iter().map(|j| j.jet).collect();
    let mut out = Vec::new();
    for label in labels {
        let area = cover.region(label).area();
        if area < SLIVER * whole {
            left.push((LeftOut::Sliver { entity: face.entity }, area));
            continue;
        }
        let new = cover.partition.trim_edges.values().copied().max().unwrap_or(0) + 1;
        let mut piece = part(&face, (&cover.partition, &jets), label, new);
        if alone {
            piece.face = (*face).clone();
        }
        out.push(piece);
    }
    (out, left)
}

/// Numbers of the trimming edges under the border of a part; `new` where it is cut.
fn border_numbers(part: &Partition, old: &[u32], whole: &Partition, new: u32) -> HashMap<(u32, u32), u32> {
    let known = part.adjacency();
    let all = part.triangles.iter().flat_map(|t| edges(*t));
    all.filter(|(a, b)| !known.contains_key(&(*b, *a)))
        .map(|(a, b)| {
            let number = whole.trim_edges.get(&(old[a as usize], old[b as usize])).copied().unwrap_or(new);
            ((a, b), number)
        })
        .collect()
}

/// The face inside the border of a partition.
fn bounded_by(face: &Face, partition: &Partition) -> Face {
    let mut loops: Vec<(f64, TrimLoop)> = chains::loops(partition, 0)
        .into_iter()
        .map(|cycle| {
            let n = cycle.len();
            let points: Vec<[f64; 2]> = cycle.iter().map(|&v| partition.vertices[v as usize]).collect();
            let number = |k: usize| partition.trim_edges.get(&(cycle[k], cycle[(k + 1) % n])).copied().unwrap_or(0);
            let edge = (0..n).map(number).collect();
            let area: f64 = (0..n)
                .map(|k| {
                    let (p, q) = (points[k], points[(k + 1) % n]);
                    p[0] * q[1] - p[1] * q[0]
                })
                .sum();
            (area, TrimLoop { points, edge })
        })
        .collect();
    loops.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut out = face.clone();
    out.loops = loops.into_iter().map(|l| l.1).collect();
    out.boundary = None;
    out
}
