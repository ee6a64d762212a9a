//! One region of a cover, and what is asked of it: where it is, how large, how it is curved, what lies beside it.

use super::covered_face::{unit_normal, Cover};
use crate::fit::near::samples::{Fit, Sample};
use crate::fit::panels::boundary::has_patch;
use crate::fit::strip_potential::Forms;
use crate::geom::{BBox, Vec3};
use crate::num::hash::HashSet;
use crate::patchwork::partition::edges;
use crate::spline::field::Field;
use crate::torse::form::Torse;
use nalgebra as na;
use std::collections::BTreeMap;
use std::sync::Arc;

/// How dense a region is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// For a first opinion: what is between the samples is left to the proof.
    Usual,
    /// Errors of bands peak between their borders: denser across them, so that these peaks are seen.
    Band,
    /// Twice as dense in every direction, for what a proof has refused.
    Peaks,
}

/// The triangles with one label.
#[derive(Clone, Copy, Debug)]
pub struct Region<'a> {
    /// The cover that it is a part of.
    pub(super) cover: &'a Cover,
    /// Its label.
    pub(super) label: u32,
}

impl Cover {
    /// The region with a label.
    pub fn region(&self, label: u32) -> Region<'_> {
        Region { cover: self, label }
    }

    /// All regions, in the order of their labels.
    pub(super) fn regions(&self) -> impl Iterator<Item = Region<'_>> {
        self.partition.distinct_labels().into_iter().map(|label| self.region(label))
    }
}

impl<'a> Region<'a> {
    /// Its torse, if one was found.
    pub(in crate::search) fn fit(&self) -> Option<&'a Arc<Fit>> {
        self.cover.panels.get(&self.label)
    }

    /// The strip potential of which it was laid as a band.
    pub(super) fn band(&self) -> Option<&'a Arc<Field>> {
        self.cover.bands.get(&self.label)
    }

    /// Indices of its triangles.
    pub(in crate::search) fn cells(&self) -> Vec<usize> {
        self.cover.partition.region(self.label)
    }

    /// Corner parameters of its triangles.
    pub(super) fn triangles(&self) -> Vec<[[f64; 2]; 3]> {
        self.cells().into_iter().map(|t| self.cover.partition.corners(t)).collect()
    }

    /// Its vertices.
    pub(in crate::search) fn vertices(&self) -> Vec<u32> {
        self.cover.partition.region_vertices(self.label)
    }

    /// Parameters of its vertices.
    pub fn places(&self) -> Vec<[f64; 2]> {
        self.vertices().into_iter().map(|v| self.cover.partition.vertices[v as usize]).collect()
    }

    /// Its vertices in space.
    pub(in crate::search) fn points(&self) -> Vec<Vec3> {
        self.vertices().into_iter().map(|v| self.cover.point(v)).collect()
    }

    /// Box in the parameter plane: least and greatest u, least and greatest v.
    pub(super) fn bounds(&self) -> [f64; 4] {
        self.cover.partition.bounds(self.label)
    }

    /// Box in space.
    pub(super) fn bbox(&self) -> BBox {
        BBox::of(self.points().iter())
    }

    /// Area, mm².
    pub(in crate::search) fn area(&self) -> f64 {
        self.cells().into_iter().map(|t| self.cover.triangle_area(t)).sum()
    }

    /// Mean width: area over the diagonal of the box, mm.
    pub(super) fn width(&self) -> f64 {
        self.area() / self.bbox().diagonal().max(f64::MIN_POSITIVE)
    }

    /// Smallest and largest value of a field over the vertices.
    pub(super) fn range(&self, field: &Field) -> (f64, f64) {
        let values = self.places().into_iter().map(|p| field.value(p));
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    }

    /// How far the vertices reach in a direction from a point, mm.
    pub(super) fn extent(&self, from: &Vec3, direction: &Vec3) -> (f64, f64) {
        let along = self.points().into_iter().map(|x| direction.dot(&(x - from)));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    }

    /// Mean point and principal axes (longest first) of the vertices.
    pub(super) fn axes(&self) -> (Vec3, [Vec3; 3]) {
        axes_of(&self.samples().iter().map(|s| (s.x, s.weight)).collect::<Vec<_>>())
    }

    /// Edges of triangles on the border, with the region on their left.
    pub(super) fn border(&self) -> Vec<(u32, u32)> {
        let partition = &self.cover.partition;
        let beside = partition.adjacency();
        let is_own = |e: &(u32, u32)| beside.get(e).is_some_and(|&t| partition.labels[t as usize] == self.label);
        let sides = self.cells().into_iter().flat_map(|t| edges(partition.triangles[t]));
        sides.filter(|&(a, b)| !is_own(&(b, a))).collect()
    }

    /// Labels of the regions beside it, those with the longest common border first.
    pub(super) fn neighbours(&self) -> Vec<u32> {
        let pairs = self.cover.partition.neighbours().into_iter();
        let mut around: Vec<(usize, u32)> = pairs
            .filter(|((a, b), _)| *a == self.label || *b == self.label)
            .map(|((a, b), shared)| (shared, if a == self.label { b } else { a }))
            .collect();
        around.sort_unstable_by(|x, y| y.cmp(x));
        around.into_iter().map(|a| a.1).collect()
    }

    /// The cover with this region as a part of another.
    pub(in crate::search) fn joined_to(&self, label: u32) -> Cover {
        let mut next = self.cover.clone();
        next.partition.labels.iter_mut().filter(|l| **l == self.label).for_each(|l| *l = label);
        next
    }

    /// Whether a patch of a torse can be laid around it.
    pub(super) fn has_patch(&self, torse: &Torse) -> bool {
        has_patch(&self.cover.face, &self.cover.partition, self.label, torse)
    }

    /// Samples at the vertices, weighted by area.
    pub(in crate::search) fn samples(&self) -> Vec<Sample> {
        let mut weight: BTreeMap<u32, f64> = BTreeMap::new();
        for t in self.cells() {
            let a = self.cover.triangle_area(t) / 3.0;
            for v in self.cover.partition.triangles[t] {
                *weight.entry(v).or_insert(0.0) += a;
            }
        }
        weight
            .into_iter()
            .map(|(v, weight)| {
                let j = &self.cover.jets[v as usize];
                Sample { x: j.jet.p, n: j.normal, weight }
            })
            .collect()
    }

    /// As [`Region::samples`], with further samples (of no weight) inside the triangles of thin regions, which have few
    /// vertices across, and of small ones.
    pub(super) fn dense_samples(&self, density: Density) -> Vec<Sample> {
        let (across, finer) = match density {
            Density::Usual => (2, 1),
            Density::Band => (3, 1),
            Density::Peaks => (3, 2),
        };
        // Regions of fewer than about five cells across have more vertices than this share of their triangles.
        const THIN: f64 = 0.6;
        // Samples that a region has at least.
        const FEWEST_SAMPLES: usize = 300;
        let (surface, partition) = (&self.cover.face.surface, &self.cover.partition);
        let cells = self.cells();
        let mut out = self.samples();
        let thin = out.len() as f64 > THIN * cells.len() as f64;
        let enough = (1..FEWEST_SAMPLES).find(|m| cells.len() * m * m / 2 >= FEWEST_SAMPLES).unwrap_or(1);
        let parts = if thin { enough.max(across) } else { enough } * finer;
        let mut add = |u: f64, v: f64| {
            let jet = surface.jet(u, v);
            out.push(Sample { x: jet.p, n: unit_normal(&jet), weight: 0.0 });
        };
        let mut sides: Vec<(u32, u32)> =
            cells.iter().flat_map(|&t| edges(partition.triangles[t])).map(|(a, b)| (a.min(b), a.max(b))).collect();
        sides.sort_unstable();
        sides.dedup();
        for (a, b) in sides {
            let [p, q] = [a, b].map(|v| partition.vertices[v as usize]);
            for k in 1..parts {
                let s = k as f64 / parts as f64;
                add(p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]));
            }
        }
        for &t in &cells {
            let [p, q, r] = partition.corners(t);
            for (i, j) in (1..parts).flat_map(|i| (1..parts - i).map(move |j| (i, j))) {
                let (s, t) = (i as f64 / parts as f64, j as f64 / parts as f64);
                let at = |d: usize| p[d] + s * (q[d] - p[d]) + t * (r[d] - p[d]);
                add(at(0), at(1));
            }
        }
        out
    }

    /// Fundamental forms at up to `count` vertices, poles left out.
    pub fn forms(&self, count: usize) -> Vec<Forms> {
        let usable: Vec<u32> = self.vertices().into_iter().filter(|&v| self.cover.is_regular(v)).collect();
        let picked = spread(&usable, count, |v| self.cover.point(v));
        picked.into_iter().map(|v| self.cover.forms_at(v)).collect()
    }

    /// The parameter (0: u, 1: v) in which it goes from one side of a face that closes to the other, and its middle.
    pub(in crate::search) fn meets_itself(&self) -> Option<(usize, f64)> {
        let b = self.bounds();
        let surface = &self.cover.face.surface;
        let near = CLOSED * self.bbox().diagonal();
        let places = self.places();
        let closes = |d: usize| {
            let at_end = |p: &[f64; 2], end: f64| if d == 0 { [end, p[1]] } else { [p[0], end] };
            let side: Vec<Vec3> =
                places.iter().filter(|p| p[d] == b[2 * d]).map(|p| surface.point(p[0], p[1])).collect();
            let other = places.iter().filter(|p| p[d] == b[2 * d]).map(|p| at_end(p, b[2 * d + 1]));
            let meets = side.iter().zip(other).all(|(x, p)| (surface.point(p[0], p[1]) - x).norm() <= near);
            meets && side.iter().any(|x| (x - side[0]).norm() > near)
        };
        let d = (0..2).find(|&d| closes(d))?;
        Some((d, 0.5 * (b[2 * d] + b[2 * d + 1])))
    }
}

/// Sides of a region within this share of its size are one line of a face that closes.
const CLOSED: f64 = 1e-9;

/// At most `count` of the items, spread evenly in space: one per voxel, voxels growing until few enough are left.
fn spread(items: &[u32], count: usize, place: impl Fn(u32) -> Vec3) -> Vec<u32> {
    if items.len() <= count {
        return items.to_vec();
    }
    let bbox = BBox::of(items.iter().map(|&v| place(v)).collect::<Vec<_>>().iter());
    let mut size = bbox.diagonal() / (count as f64).sqrt() * 0.5;
    loop {
        let mut taken = HashSet::default();
        let picked: Vec<u32> = items
            .iter()
            .copied()
            .filter(|&v| {
                let q = (place(v) - bbox.min) / size;
                taken.insert((q.x as i64, q.y as i64, q.z as i64))
            })
            .collect();
        if picked.len() <= count || !(size.is_finite() && size > 0.0) {
            return picked;
        }
        size *= 1.15;
    }
}

/// Mean point and principal axes (longest first) of weighted points.
pub(super) fn axes_of(points: &[(Vec3, f64)]) -> (Vec3, [Vec3; 3]) {
    let total: f64 = points.iter().map(|p| p.1).sum::<f64>().max(f64::MIN_POSITIVE);
    let mean = points.iter().fold(Vec3::zeros(), |m, (x, w)| m + x * *w) / total;
    let mut c = na::Matrix3::zeros();
    for (x, w) in points {
        let d = x - mean;
        c += d * d.transpose() * *w;
    }
    let e = na::SymmetricEigen::new(c);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| e.eigenvalues[b].total_cmp(&e.eigenvalues[a]));
    (mean, order.map(|k| e.eigenvectors.column(k).into_owned()))
}
