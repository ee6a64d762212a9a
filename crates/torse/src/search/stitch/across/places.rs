//! Where faces meet: their borders in space, cut at the same places on both sides, side by side.

use crate::brep::face::Face;
use crate::fit::panels::boundary::{Borders, TrimChain};
use crate::geom::segment::share;
use crate::geom::{BBox, Vec3};
use crate::num::parallel;
use crate::patchwork::partition::Partition;
use crate::search::build::borders_cut_at;
use std::collections::{BTreeMap, BTreeSet};

/// Borders of two faces within this share of the tolerance are one edge of the model.
const SAME: f64 = 0.25;
/// Their ends are one within this share of the tolerance: where seams of both faces end nearer to each other than that, panels
/// have no common point.
const ONE_END: f64 = 0.1;
/// Parts of each edge of a border where it is compared with others, and at whose ends heights are looked at.
pub(super) const FINE: usize = 4;
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
        let place = |p: [f64; 2]| self.face.surface.point(p[0], p[1]);
        self.parameters(vertices, parts).into_iter().map(place).collect()
    }

    /// Their parameters.
    fn parameters(&self, vertices: &[u32], parts: usize) -> Vec<[f64; 2]> {
        let at = |v: u32| self.partition.vertices[v as usize];
        let mut out = vec![at(vertices[0])];
        for w in vertices.windows(2) {
            let (p, q) = (at(w[0]), at(w[1]));
            let between = |share: f64| [p[0] + (q[0] - p[0]) * share, p[1] + (q[1] - p[1]) * share];
            out.extend((1..parts).map(|i| between(i as f64 / parts as f64)));
            out.push(q);
        }
        out
    }

    /// Unit normals of the surface at the same places; zero where there is none.
    pub fn normals(&self, vertices: &[u32], parts: usize) -> Vec<Vec3> {
        let normal = |p: [f64; 2]| {
            let normal = self.face.surface.jet(p[0], p[1]).normal();
            normal.try_normalize(0.0).unwrap_or_else(Vec3::zeros)
        };
        self.parameters(vertices, parts).into_iter().map(normal).collect()
    }

    /// Whether a border lies where the surface closes: at one end of its domain, with the other end in the same place within
    /// `reach` (mm).
    fn closes_along(&self, vertices: &[u32], reach: f64) -> bool {
        let surface = &self.face.surface;
        let (u, v) = surface.domain();
        let domain = [u, v];
        let places: Vec<[f64; 2]> = vertices.iter().map(|&v| self.partition.vertices[v as usize]).collect();
        let other_end = |d: usize, x: f64| [domain[d].1, domain[d].0][usize::from(x == domain[d].1)];
        (0..2).any(|d| {
            let at_end = places.iter().all(|p| p[d] == domain[d].0) || places.iter().all(|p| p[d] == domain[d].1);
            at_end
                && places.iter().all(|p| {
                    let mut q = *p;
                    q[d] = other_end(d, p[d]);
                    (surface.point(p[0], p[1]) - surface.point(q[0], q[1])).norm() <= reach
                })
        })
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
struct BorderPolyline {
    face: usize,
    /// Body of the face: what only touches another body is no edge of it.
    body: u32,
    chain: TrimChain,
    /// Whether its face closes there.
    closes: bool,
    points: Vec<Vec3>,
    bbox: BBox,
}

impl BorderPolyline {
    /// Whether two may be both sides of an edge of the model: of two faces of one body, or where a face closes.
    fn may_lie_along(&self, other: &Self) -> bool {
        self.body == other.body && (self.face != other.face || self.closes && other.closes)
    }
}

/// The place on a polyline nearest to a point, beside the nearest of its points: distance, number of the stretch, share of it.
fn nearest(points: &[Vec3], x: &Vec3) -> (f64, usize, f64) {
    let off = |k: &usize| (points[*k] - x).norm_squared();
    let k = (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    let mut best = (f64::INFINITY, 0, 0.0);
    for i in k.saturating_sub(1)..=k.min(points.len() - 2) {
        let (p, q) = (&points[i], &points[i + 1]);
        let share = share(p, q, x);
        let far = (p + (q - p) * share - x).norm();
        if far < best.0 {
            best = (far, i, share);
        }
    }
    best
}

/// Whether some place inside one of two borders, of a few, lies on the other.
fn touch(a: &BorderPolyline, b: &BorderPolyline, reach: f64) -> bool {
    const PROBES: usize = 12;
    let on = |a: &BorderPolyline, b: &BorderPolyline| {
        let last = a.points.len() - 1;
        (1..PROBES).any(|k| nearest(&b.points, &a.points[k * last / PROBES]).0 <= reach)
    };
    (0..3).all(|d| a.bbox.min[d] <= b.bbox.max[d] && b.bbox.min[d] <= a.bbox.max[d]) && (on(a, b) || on(b, a))
}

fn border_polylines(grounds: &[Ground], tolerance: f64) -> Vec<BorderPolyline> {
    let reach = SAME * tolerance;
    let of = |(face, ground): (usize, &Ground)| {
        let mut out = Vec::new();
        for chain in ground.borders().trim_chains() {
            let points = ground.places(&chain.vertices, FINE);
            let mut bbox = BBox::empty();
            for p in &points {
                bbox.include(&p.add_scalar(reach));
                bbox.include(&p.add_scalar(-reach));
            }
            let closes = ground.closes_along(&chain.vertices, AT_VERTEX * tolerance);
            out.push(BorderPolyline { face, body: ground.face.body, chain, closes, points, bbox });
        }
        out
    };
    parallel::map(grounds.iter().enumerate(), of).into_iter().flatten().collect()
}

/// Cuts the borders of faces at the ends of those of others along the same edge of the model.
pub(super) fn cut(grounds: &mut [Ground], tolerance: f64) {
    let reach = SAME * tolerance;
    let all = border_polylines(grounds, tolerance);
    // Borders that close are cut somewhere: these places stay when others are cut in.
    for c in &all {
        let v = &c.chain.vertices;
        grounds[c.face].cuts.extend([v[0], v[v.len() - 1]]);
    }
    // By face and edge of its border, where it is to be cut.
    let mut wanted: BTreeMap<(usize, [u32; 2]), Vec<f64>> = BTreeMap::new();
    let ends_on = |a: &BorderPolyline, b: &BorderPolyline| -> Vec<((usize, [u32; 2]), f64)> {
        let ends = [a.points[0], a.points[a.points.len() - 1]];
        let found = ends.iter().filter_map(|x| {
            let (far, i, share) = nearest(&b.points, x);
            let foot = b.points[i] + (b.points[i + 1] - b.points[i]) * share;
            let apart = |end: &Vec3| (end - foot).norm() > (ONE_END * tolerance).max(2.0 * far);
            let inside = far <= reach && apart(&b.points[0]) && apart(&b.points[b.points.len() - 1]);
            let (edge, within) = (i / FINE, ((i % FINE) as f64 + share) / FINE as f64);
            inside.then(|| ((b.face, [b.chain.vertices[edge], b.chain.vertices[edge + 1]]), within))
        });
        found.collect()
    };
    let found: Vec<_> = parallel::map(all.iter().enumerate(), |(i, a)| {
        let beside = all.iter().enumerate().filter(|(j, b)| *j != i && a.may_lie_along(b) && touch(a, b, reach));
        beside.flat_map(|(_, b)| ends_on(a, b)).collect::<Vec<_>>()
    })
    .into_iter()
    .flatten()
    .collect();
    for (at, share) in found {
        wanted.entry(at).or_default().push(share);
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

/// Borders of panels that lie along each other from end to end where faces meet or one closes, each with one partner.
pub(super) fn common(grounds: &[Ground], tolerance: f64) -> Vec<Common> {
    let reach = SAME * tolerance;
    let all = border_polylines(grounds, tolerance);
    let with_later = |i: usize| -> Vec<(usize, usize, bool)> {
        let a = &all[i];
        let of = |(j, b): (usize, &BorderPolyline)| {
            let ends = |c: &BorderPolyline| [c.points[0], c.points[c.points.len() - 1]];
            let ([p, q], [r, s]) = (ends(a), ends(b));
            let turned = (p - s).norm() + (q - r).norm() < (p - r).norm() + (q - s).norm();
            let [r, s] = if turned { [s, r] } else { [r, s] };
            let near = (p - r).norm() <= reach && (q - s).norm() <= reach;
            let long = a.chain.length > ONE_END * tolerance;
            let along =
                |x: &BorderPolyline, y: &BorderPolyline| x.points.iter().all(|p| nearest(&y.points, p).0 <= reach);
            (a.may_lie_along(b) && near && long && along(a, b) && along(b, a)).then_some((i, j, turned))
        };
        all.iter().enumerate().skip(i + 1).filter_map(of).collect()
    };
    let found: Vec<(usize, usize, bool)> = parallel::map(0..all.len(), with_later).into_iter().flatten().collect();
    let mut uses = vec![0; all.len()];
    for &(i, j, _) in &found {
        uses[i] += 1;
        uses[j] += 1;
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
