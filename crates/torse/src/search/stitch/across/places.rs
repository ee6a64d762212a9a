//! Where faces meet: their borders in space, cut at the same places on both sides, side by side.

use crate::brep::face::Face;
use crate::fit::panels::boundary::{Borders, TrimChain};
use crate::geom::{BBox, Vec3};
use crate::patchwork::partition::Partition;
use crate::search::build::borders_cut_at;
use std::collections::{BTreeMap, BTreeSet};

/// Borders of two faces within this share of the tolerance are one edge of the model.
const SAME: f64 = 0.25;
/// Parts of each edge of a border where it is compared with others.
const FINE: usize = 4;
/// Where a vertex is this near (share of the tolerance) to where one is wanted it does.
const AT_VERTEX: f64 = 1e-3;

/// A face whose panels may meet those of others.
#[derive(Clone)]
pub(super) struct Ground<'a> {
    pub face: &'a Face,
    pub partition: Partition,
    /// Vertices in which borders are cut besides.
    pub cuts: BTreeSet<u32>,
}

impl Ground<'_> {
    pub fn borders(&self) -> Borders<'_> {
        borders_cut_at(self.face, &self.partition, &self.cuts)
    }

    /// Places along a border, `parts` to each of its edges, in the face.
    pub fn places(&self, vertices: &[u32], parts: usize) -> Vec<Vec3> {
        let at = |v: u32| self.partition.vertices[v as usize];
        let place = |p: [f64; 2]| self.face.surface.point(p[0], p[1]);
        let mut out = vec![place(at(vertices[0]))];
        for w in vertices.windows(2) {
            let (p, q) = (at(w[0]), at(w[1]));
            out.extend((1..=parts).map(|i| {
                let share = i as f64 / parts as f64;
                if i == parts {
                    place(q)
                } else {
                    place([p[0] + (q[0] - p[0]) * share, p[1] + (q[1] - p[1]) * share])
                }
            }));
        }
        out
    }

    /// Puts a vertex on an edge of the border of the face; result: its number.
    fn insert(&mut self, [a, b]: [u32; 2], share: f64) -> Option<u32> {
        let (p, q) = (self.partition.vertices[a as usize], self.partition.vertices[b as usize]);
        let between = |d: usize| if p[d].to_bits() == q[d].to_bits() { p[d] } else { p[d] + (q[d] - p[d]) * share };
        let edges = |t: &[u32; 3]| [[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[2], t[0], t[1]]];
        let found = self.partition.triangles.iter().position(|t| edges(t).iter().any(|e| e[..2] == [a, b]))?;
        let c = edges(&self.partition.triangles[found]).into_iter().find(|e| e[..2] == [a, b])?[2];
        let new = self.partition.vertices.len() as u32;
        self.partition.vertices.push([between(0), between(1)]);
        self.partition.triangles[found] = [a, new, c];
        self.partition.triangles.push([new, b, c]);
        self.partition.labels.push(self.partition.labels[found]);
        if let Some(edge) = self.partition.trim_edges.remove(&(a, b)) {
            self.partition.trim_edges.insert((a, new), edge);
            self.partition.trim_edges.insert((new, b), edge);
        }
        Some(new)
    }
}

/// A border as a polyline in space.
struct Course {
    face: usize,
    chain: TrimChain,
    points: Vec<Vec3>,
    bbox: BBox,
}

/// The place on a polyline nearest to a point: distance, number of the stretch, share of it.
fn nearest(points: &[Vec3], x: &Vec3) -> (f64, usize, f64) {
    let mut best = (f64::INFINITY, 0, 0.0);
    for (i, w) in points.windows(2).enumerate() {
        let d = w[1] - w[0];
        let share = ((x - w[0]).dot(&d) / d.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let far = (w[0] + d * share - x).norm();
        if far < best.0 {
            best = (far, i, share);
        }
    }
    best
}

fn courses(grounds: &[Ground], reach: f64) -> Vec<Course> {
    let mut out = Vec::new();
    for (face, ground) in grounds.iter().enumerate() {
        for chain in ground.borders().trim_chains() {
            let points = ground.places(&chain.vertices, FINE);
            let mut bbox = BBox::empty();
            for p in &points {
                bbox.include(&p.add_scalar(reach));
                bbox.include(&p.add_scalar(-reach));
            }
            out.push(Course { face, chain, points, bbox });
        }
    }
    out
}

fn meet(a: &BBox, b: &BBox) -> bool {
    (0..3).all(|d| a.min[d] <= b.max[d] && b.min[d] <= a.max[d])
}

/// Cuts the borders of faces at the ends of those of others along the same edge of the model.
pub(super) fn cut(grounds: &mut [Ground], tolerance: f64) {
    let reach = SAME * tolerance;
    let all = courses(grounds, reach);
    // By face and edge of its border, where it is to be cut.
    let mut wanted: BTreeMap<(usize, [u32; 2]), Vec<f64>> = BTreeMap::new();
    for a in &all {
        for b in all.iter().filter(|b| b.face != a.face && meet(&a.bbox, &b.bbox)) {
            let ends = [a.points[0], a.points[a.points.len() - 1]];
            let along = a.points.iter().filter(|x| nearest(&b.points, x).0 <= reach).count();
            for x in ends {
                let (far, i, share) = nearest(&b.points, &x);
                let last = b.points.len() - 1;
                let apart = |end: &Vec3| (end - x).norm() > 2.0 * reach;
                // More than the end alone lies along the other border.
                if far <= reach && along > FINE && apart(&b.points[0]) && apart(&b.points[last]) {
                    let (edge, within) = (i / FINE, ((i % FINE) as f64 + share) / FINE as f64);
                    let of = [b.chain.vertices[edge], b.chain.vertices[edge + 1]];
                    wanted.entry((b.face, of)).or_default().push(within);
                }
            }
        }
    }
    for ((face, [a, b]), mut shares) in wanted {
        let ground = &mut grounds[face];
        shares.sort_by(f64::total_cmp);
        let length = {
            let p = ground.places(&[a, b], 1);
            (p[1] - p[0]).norm()
        };
        let (mut from, mut done) = (a, 0.0);
        for share in shares {
            if (share - done) * length <= AT_VERTEX * tolerance {
                ground.cuts.insert(from);
                continue;
            }
            if (1.0 - share) * length <= AT_VERTEX * tolerance {
                ground.cuts.insert(b);
                continue;
            }
            let Some(new) = ground.insert([from, b], (share - done) / (1.0 - done)) else { continue };
            ground.cuts.insert(new);
            (from, done) = (new, share);
        }
    }
}

/// A border that two faces have in common.
#[derive(Clone, Debug)]
pub(super) struct Common {
    /// Faces on both sides.
    pub faces: [usize; 2],
    /// Their borders.
    pub chains: [TrimChain; 2],
    /// Whether the second runs against the first.
    pub turned: bool,
}

/// Borders of faces that lie along each other from end to end, each with one partner.
pub(super) fn common(grounds: &[Ground], tolerance: f64) -> Vec<Common> {
    let reach = SAME * tolerance;
    let all = courses(grounds, reach);
    let mut found: Vec<(usize, usize, bool)> = Vec::new();
    let mut uses = vec![0; all.len()];
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1).filter(|(_, b)| b.face != a.face && meet(&a.bbox, &b.bbox)) {
            let ends = |c: &Course| [c.points[0], c.points[c.points.len() - 1]];
            let ([p, q], [r, s]) = (ends(a), ends(b));
            let near = |x: &Vec3, y: &Vec3| (x - y).norm() <= 2.0 * reach;
            let turned = near(&p, &s) && near(&q, &r);
            if !(turned || (near(&p, &r) && near(&q, &s))) || a.chain.length <= 4.0 * reach {
                continue;
            }
            let along = |x: &Course, y: &Course| x.points.iter().all(|p| nearest(&y.points, p).0 <= reach);
            if along(a, b) && along(b, a) {
                found.push((i, j, turned));
                uses[i] += 1;
                uses[j] += 1;
            }
        }
    }
    let of = |&(i, j, turned): &(usize, usize, bool)| {
        let (a, b) = (&all[i], &all[j]);
        let alone = uses[i] == 1 && uses[j] == 1;
        alone.then(|| Common { faces: [a.face, b.face], chains: [a.chain.clone(), b.chain.clone()], turned })
    };
    found.iter().filter_map(of).collect()
}

/// For each of the places of a border the share of the way along another polyline, from its number of places less one; the
/// first and last exactly.
pub(super) fn shares_along(points: &[Vec3], places: &[Vec3]) -> Vec<f64> {
    let (n, last) = (places.len(), (points.len() - 1) as f64);
    let of = |(k, x): (usize, &Vec3)| match k {
        0 => 0.0,
        k if k + 1 == n => last,
        _ => {
            let (_, i, share) = nearest(points, x);
            i as f64 + share
        }
    };
    places.iter().enumerate().map(of).collect()
}
