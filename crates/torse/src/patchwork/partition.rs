//! A polygonal region of a parameter plane, cut into triangles that carry labels: the one record of which part
//! of a face belongs to which panel. All cuts are shared by both sides, so coverage is a matter of counting.

use crate::num::hash::{HashMap, HashSet};
use std::collections::BTreeMap;

/// Label of triangles that belong to no panel yet.
pub(crate) const UNASSIGNED: u32 = u32::MAX;

/// A cut that would pass this close to a vertex (share of the edge) goes through the vertex instead; keeps slivers
/// away, and is far below any drawing accuracy since edges are about a hundredth of the face.
const SNAP: f64 = 2e-3;
/// Share of an edge to which the place of a cut on it is found: far below [`SNAP`].
const NEAR: f64 = 1e-6;

/// A conforming triangulation with labels. Triangles are counter-clockwise and never cross a knot line of the
/// surface that the plane parametrises.
#[derive(Clone, Debug, Default)]
pub struct Partition {
    /// Corner points (u, v).
    pub vertices: Vec<[f64; 2]>,
    /// Corners of each triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Label of each triangle.
    pub labels: Vec<u32>,
    /// For every edge `(a, b)` on the border of the region, directed with the region on its left: number of the
    /// trimming edge that it lies on.
    pub trim_edges: HashMap<(u32, u32), u32>,
}

/// The three directed edges of a triangle.
#[inline]
pub(crate) fn edges(t: [u32; 3]) -> [(u32, u32); 3] {
    [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
}

#[inline]
fn undirected(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Partition {
    /// Coordinates of a triangle's corners.
    #[inline]
    pub fn corners(&self, t: usize) -> [[f64; 2]; 3] {
        self.triangles[t].map(|v| self.vertices[v as usize])
    }

    /// Indices of the triangles with a label.
    pub fn region(&self, label: u32) -> Vec<usize> {
        (0..self.triangles.len()).filter(|&t| self.labels[t] == label).collect()
    }

    /// Distinct labels in increasing order.
    pub fn distinct_labels(&self) -> Vec<u32> {
        let mut l = self.labels.clone();
        l.sort_unstable();
        l.dedup();
        l
    }

    /// A label that is not in use.
    pub(crate) fn fresh_label(&self) -> u32 {
        self.labels.iter().filter(|&&l| l != UNASSIGNED).max().map_or(0, |m| m + 1)
    }

    /// Map from directed edge to the triangle on its left.
    pub fn adjacency(&self) -> HashMap<(u32, u32), u32> {
        let mut map = HashMap::with_capacity_and_hasher(3 * self.triangles.len(), Default::default());
        for (i, &t) in self.triangles.iter().enumerate() {
            for e in edges(t) {
                map.insert(e, i as u32);
            }
        }
        map
    }

    /// Distinct vertices of the triangles with a label, in order of first use.
    pub fn region_vertices(&self, label: u32) -> Vec<u32> {
        let mut seen = vec![false; self.vertices.len()];
        let mut out = Vec::new();
        for (t, &l) in self.triangles.iter().zip(&self.labels) {
            if l == label {
                for &v in t {
                    if !std::mem::replace(&mut seen[v as usize], true) {
                        out.push(v);
                    }
                }
            }
        }
        out
    }

    /// Vertices in which the border of a label touches itself, in order.
    pub fn touching(&self, label: u32) -> Vec<u32> {
        let inner: HashSet<(u32, u32)> =
            self.region(label).into_iter().flat_map(|t| edges(self.triangles[t])).collect();
        let mut leaving: BTreeMap<u32, usize> = BTreeMap::new();
        for &(a, _) in inner.iter().filter(|&&(a, b)| !inner.contains(&(b, a))) {
            *leaving.entry(a).or_insert(0) += 1;
        }
        leaving.into_iter().filter(|&(_, count)| count > 1).map(|(vertex, _)| vertex).collect()
    }

    /// Gives every edge-connected component of a label but the largest (by triangle count) a fresh label. Returns
    /// the labels of all components, the kept one first.
    pub(crate) fn split_components(&mut self, label: u32) -> Vec<u32> {
        let mut groups = self.components(&self.region(label), |_, _| true);
        groups.sort_by_key(|g| (std::cmp::Reverse(g.len()), g[0]));
        let mut out = vec![label];
        for (g, fresh) in groups.iter().skip(1).zip(self.fresh_label()..) {
            for &t in g {
                self.labels[t] = fresh;
            }
            out.push(fresh);
        }
        out
    }

    /// Groups of triangles that hang together across edges between triangles that `join` (asked with indices).
    pub fn components(&self, triangles: &[usize], join: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
        let mut of_edge: HashMap<(u32, u32), usize> =
            HashMap::with_capacity_and_hasher(3 * triangles.len(), Default::default());
        let mut parent: Vec<usize> = (0..triangles.len()).collect();
        for (k, &t) in triangles.iter().enumerate() {
            for (a, b) in edges(self.triangles[t]) {
                if let Some(o) = of_edge.insert(undirected(a, b), k) {
                    if join(triangles[o], t) {
                        let (x, y) = (root(&mut parent, o), root(&mut parent, k));
                        parent[x] = y;
                    }
                }
            }
        }
        let mut groups: HashMap<usize, Vec<usize>> = HashMap::default();
        for (k, &t) in triangles.iter().enumerate() {
            groups.entry(root(&mut parent, k)).or_default().push(t);
        }
        groups.into_values().collect()
    }

    /// Cuts the triangles labelled `label` along the zero line of `value` and gives the part where it is positive
    /// the label `positive`. Neighbours across the label's border are split too, so that the triangulation stays
    /// conforming. `value` should be continuous; along an edge its zero is found by the secant rule.
    pub(crate) fn cut(&mut self, label: u32, positive: u32, value: impl Fn([f64; 2]) -> f64) {
        let tris = self.region(label);
        let mut val: HashMap<u32, f64> = HashMap::default();
        for &t in &tris {
            for v in self.triangles[t] {
                val.entry(v).or_insert_with(|| value(self.vertices[v as usize]));
            }
        }
        // Zeros on edges, snapping to vertices first.
        let mut crossing: HashMap<(u32, u32), f64> = HashMap::default();
        for &t in &tris {
            for (a, b) in edges(self.triangles[t]) {
                let key = undirected(a, b);
                let (fa, fb) = (val[&key.0], val[&key.1]);
                if fa * fb < 0.0 {
                    crossing.entry(key).or_insert_with(|| self.zero_on_edge(key, fa, fb, &value));
                }
            }
        }
        let mut keys: Vec<_> = crossing.iter().map(|(&k, &s)| (k, s)).collect();
        keys.sort_unstable_by_key(|k| k.0);
        for &((a, b), s) in &keys {
            if s < SNAP {
                val.insert(a, 0.0);
            } else if s > 1.0 - SNAP {
                val.insert(b, 0.0);
            }
        }
        let mut middle: HashMap<(u32, u32), u32> = HashMap::default();
        for &((a, b), s) in &keys {
            if val[&a] * val[&b] < 0.0 {
                let (p, q) = (self.vertices[a as usize], self.vertices[b as usize]);
                let m = self.vertices.len() as u32;
                self.vertices.push([lerp(p[0], q[0], s), lerp(p[1], q[1], s)]);
                middle.insert((a, b), m);
                val.insert(m, 0.0);
            }
        }
        self.split_edges(&middle);
        for t in 0..self.triangles.len() {
            if self.labels[t] == label {
                let side =
                    self.triangles[t].iter().map(|v| val.get(v).copied().unwrap_or(0.0)).fold(0.0, |m: f64, x| {
                        if x.abs() > m.abs() {
                            x
                        } else {
                            m
                        }
                    });
                let all_zero = side == 0.0;
                let positive_side = if all_zero { value(centroid(self.corners(t))) > 0.0 } else { side > 0.0 };
                if positive_side {
                    self.labels[t] = positive;
                }
            }
        }
    }

    /// Share along the edge (lower index first) at which `value` vanishes.
    fn zero_on_edge(&self, (a, b): (u32, u32), fa: f64, fb: f64, value: impl Fn([f64; 2]) -> f64) -> f64 {
        let (p, q) = (self.vertices[a as usize], self.vertices[b as usize]);
        let (mut lo, mut hi, mut flo, mut fhi) = (0.0, 1.0, fa, fb);
        for _ in 0..8 {
            let s = lo + (hi - lo) * (flo / (flo - fhi)).clamp(0.05, 0.95);
            let f = value([lerp(p[0], q[0], s), lerp(p[1], q[1], s)]);
            if f == 0.0 || hi - lo < NEAR {
                return s;
            }
            if f * flo < 0.0 {
                (hi, fhi) = (s, f);
            } else {
                (lo, flo) = (s, f);
            }
        }
        lo + (hi - lo) * (flo / (flo - fhi)).clamp(0.0, 1.0)
    }

    /// Splits every triangle that has edges in `middle` (undirected edge → vertex on it); labels are inherited.
    pub(crate) fn split_edges(&mut self, middle: &HashMap<(u32, u32), u32>) {
        if middle.is_empty() {
            return;
        }
        for t in 0..self.triangles.len() {
            let tri = self.triangles[t];
            let mid = edges(tri).map(|(a, b)| middle.get(&undirected(a, b)).copied());
            let count = mid.iter().flatten().count();
            if count == 0 {
                continue;
            }
            for ((a, b), m) in edges(tri).into_iter().zip(mid) {
                let Some(m) = m else { continue };
                if let Some(e) = self.trim_edges.remove(&(a, b)) {
                    self.trim_edges.insert((a, m), e);
                    self.trim_edges.insert((m, b), e);
                }
            }
            let label = self.labels[t];
            let mut pieces: Vec<[u32; 3]> = Vec::with_capacity(4);
            match count {
                1 => {
                    let k = (0..3).find(|&k| mid[k].is_some()).unwrap_or(0);
                    let (a, b, c) = (tri[k], tri[(k + 1) % 3], tri[(k + 2) % 3]);
                    let m = mid[k].unwrap_or(a);
                    pieces.extend([[a, m, c], [m, b, c]]);
                }
                2 => {
                    let k = (0..3).find(|&k| mid[k].is_none()).unwrap_or(0);
                    // Edge k = (a, b) is whole; the other two meet in c.
                    let (a, b, c) = (tri[k], tri[(k + 1) % 3], tri[(k + 2) % 3]);
                    let (bc, ca) = (mid[(k + 1) % 3].unwrap_or(c), mid[(k + 2) % 3].unwrap_or(c));
                    pieces.push([c, ca, bc]);
                    if self.distance_sq(a, bc) < self.distance_sq(b, ca) {
                        pieces.extend([[a, b, bc], [a, bc, ca]]);
                    } else {
                        pieces.extend([[a, b, ca], [b, bc, ca]]);
                    }
                }
                _ => {
                    let m = mid.map(|m| m.unwrap_or(0));
                    pieces.extend([
                        [tri[0], m[0], m[2]],
                        [tri[1], m[1], m[0]],
                        [tri[2], m[2], m[1]],
                        [m[0], m[1], m[2]],
                    ]);
                }
            }
            self.triangles[t] = pieces[0];
            for p in &pieces[1..] {
                self.triangles.push(*p);
                self.labels.push(label);
            }
        }
    }

    fn distance_sq(&self, a: u32, b: u32) -> f64 {
        let (p, q) = (self.vertices[a as usize], self.vertices[b as usize]);
        (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
    }

    /// The triangles with a label as a partition of their own, with the same labels; second result: for each of
    /// its vertices the vertex here. Border edges of the part are not classified.
    pub(crate) fn extract(&self, label: u32) -> (Self, Vec<u32>) {
        let mut map: HashMap<u32, u32> = HashMap::default();
        let mut old = Vec::new();
        let mut part = Self::default();
        for t in self.region(label) {
            let tri = self.triangles[t].map(|v| {
                *map.entry(v).or_insert_with(|| {
                    old.push(v);
                    part.vertices.push(self.vertices[v as usize]);
                    part.vertices.len() as u32 - 1
                })
            });
            part.triangles.push(tri);
            part.labels.push(label);
        }
        (part, old)
    }

    /// Pairs of labels that share edges, with the number of edges shared; lower label first.
    pub fn neighbours(&self) -> HashMap<(u32, u32), usize> {
        let mut first: HashMap<(u32, u32), u32> =
            HashMap::with_capacity_and_hasher(2 * self.triangles.len(), Default::default());
        let mut out = HashMap::default();
        for (t, &l) in self.triangles.iter().zip(&self.labels) {
            for (a, b) in edges(*t) {
                if let Some(o) = first.insert(undirected(a, b), l) {
                    if o != l {
                        *out.entry(undirected(o, l)).or_insert(0) += 1;
                    }
                }
            }
        }
        out
    }

    /// Box `[u0, u1, v0, v1]` of the triangles with a label; infinite and reversed if there are none.
    pub fn bounds(&self, label: u32) -> [f64; 4] {
        let mut b = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for (t, &l) in self.triangles.iter().zip(&self.labels) {
            if l == label {
                for &v in t {
                    let [u, w] = self.vertices[v as usize];
                    b = [b[0].min(u), b[1].max(u), b[2].min(w), b[3].max(w)];
                }
            }
        }
        b
    }
}

#[inline]
fn lerp(a: f64, b: f64, s: f64) -> f64 {
    // Exact when both ends agree: vertices of cuts stay on straight borders and knot lines.
    a + (b - a) * s
}

/// Mean of three corners.
#[inline]
pub(crate) fn centroid(c: [[f64; 2]; 3]) -> [f64; 2] {
    [(c[0][0] + c[1][0] + c[2][0]) / 3.0, (c[0][1] + c[1][1] + c[2][1]) / 3.0]
}

fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patchwork::triangulate::triangulate;

    fn area(p: &Partition, label: u32) -> f64 {
        p.region(label)
            .into_iter()
            .map(|t| {
                let [a, b, c] = p.corners(t);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            })
            .sum()
    }

    #[test]
    fn cuts_keep_the_area_and_the_conformity() {
        let grid: Vec<f64> = (0..=10).map(|i| i as f64 / 10.0).collect();
        let square = vec![(vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]], vec![0, 1, 2, 3])];
        let mut p = triangulate(&square, &grid, &grid).expect("a square");
        p.cut(0, 1, |[u, v]| u * u + v * v - 0.36);
        p.cut(1, 2, |[u, v]| u - v + 0.013);
        assert!((area(&p, 0) - 0.09 * std::f64::consts::PI).abs() < 2e-3);
        let total: f64 = p.distinct_labels().into_iter().map(|l| area(&p, l)).sum();
        assert!((total - 1.0).abs() < 1e-12);
        let map = p.adjacency();
        assert_eq!(map.len(), 3 * p.triangles.len());
        for &(a, b) in map.keys() {
            assert_eq!(map.contains_key(&(b, a)), !p.trim_edges.contains_key(&(a, b)));
        }
        for t in 0..p.triangles.len() {
            let [a, b, c] = p.corners(t).map(|p| robust::Coord { x: p[0], y: p[1] });
            assert!(robust::orient2d(a, b, c) > 0.0);
        }
    }

    #[test]
    fn components_get_labels_of_their_own() {
        let grid: Vec<f64> = (0..=8).map(|i| i as f64 / 8.0).collect();
        let square = vec![(vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]], vec![0, 1, 2, 3])];
        let mut p = triangulate(&square, &grid, &grid).expect("a square");
        p.cut(0, 1, |[u, _]| 0.3 - (u - 0.5).abs());
        assert_eq!(p.split_components(0).len(), 2);
        assert_eq!(p.split_components(1), vec![1]);
        assert_eq!(p.neighbours().len(), 2);
    }
}
