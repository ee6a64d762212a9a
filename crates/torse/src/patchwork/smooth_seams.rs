//! Finer borders between labels: new vertices on a smooth curve through the old ones.
//!
//! Cuts are found edge by edge of a triangulation, hence polylines as coarse as the triangles. A four-point rule puts
//! a vertex beside the middle of every border edge: on the cubic through the edge's ends and their neighbours over
//! chord lengths, since the vertices of cuts are unevenly spaced.

use super::partition::{edges, Partition};
use crate::num::hash::HashMap;
use robust::{orient2d, Coord};

/// Border edges that turn by more than this against each other (cosine, in scaled parameters) form a corner.
const CORNER: f64 = 0.8;

/// A vertex beside a border goes at most this often as far as the smooth curve asks for, halved each time.
const SHORTER: [f64; 3] = [1.0, 0.5, 0.25];

impl Partition {
    /// Moves vertices away from borders that they nearly touch: every vertex inside a label, opposite a border edge,
    /// goes to the mean of its neighbours where that makes the worst of its triangles better. Coordinates on `lines`
    /// (knot lines in u and v) stay.
    pub(crate) fn relax(&mut self, lines: [&[f64]; 2]) {
        let left = self.adjacency();
        let mut beside: Vec<u32> = Vec::new();
        let mut bordering = vec![false; self.vertices.len()];
        for (&(a, b), &t) in &left {
            let other = left.get(&(b, a)).map(|&o| self.labels[o as usize]);
            if other != Some(self.labels[t as usize]) {
                (bordering[a as usize], bordering[b as usize]) = (true, true);
                beside.extend(self.triangles[t as usize].into_iter().filter(|&v| v != a && v != b));
            }
        }
        beside.retain(|&v| !bordering[v as usize]);
        beside.sort_unstable();
        beside.dedup();
        let mut star: HashMap<u32, Vec<usize>> = beside.iter().map(|&v| (v, Vec::new())).collect();
        for (t, corners) in self.triangles.iter().enumerate() {
            for v in corners {
                if let Some(s) = star.get_mut(v) {
                    s.push(t);
                }
            }
        }
        for v in beside {
            let old = self.vertices[v as usize];
            let worst = |p: &Self| star[&v].iter().map(|&t| p.shape(t)).fold(f64::INFINITY, f64::min);
            let before = worst(self);
            let (mut mean, mut count) = ([0.0; 2], 0.0);
            for w in star[&v].iter().flat_map(|&t| self.triangles[t]).filter(|&w| w != v) {
                let p = self.vertices[w as usize];
                mean = [mean[0] + p[0], mean[1] + p[1]];
                count += 1.0;
            }
            let place = |k: usize| if lines[k].contains(&old[k]) { old[k] } else { mean[k] / count };
            self.vertices[v as usize] = [place(0), place(1)];
            if worst(self) <= before {
                self.vertices[v as usize] = old;
            }
        }
    }

    /// Twice the area of a triangle over the sum of its squared sides; not positive where it is turned over.
    fn shape(&self, t: usize) -> f64 {
        let c = self.corners(t);
        let [x, y, z] = c.map(|p| Coord { x: p[0], y: p[1] });
        let sides: f64 = (0..3)
            .map(|k| {
                let (p, q) = (c[k], c[(k + 1) % 3]);
                (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
            })
            .sum();
        orient2d(x, y, z) / sides.max(f64::MIN_POSITIVE)
    }

    /// Inserts a vertex on every border edge between two labels (in order) that `among` names at which the border bends by more than `bend(a, b)`
    /// allows (both in units of `distance`), moved to a smooth curve where that keeps the triangulation valid and the
    /// vertex within its cell of `lines` (knot lines in u and v). Returns the number of new vertices.
    ///
    /// `distance(p, q)` measures from `p` to `q` near both, in any unit; `allowed` is in the same unit.
    #[expect(clippy::too_many_lines, reason = "one walk over all joints with its state")]
    pub(crate) fn smooth_seams(
        &mut self,
        lines: [&[f64]; 2],
        allowed: f64,
        distance: impl Fn([f64; 2], [f64; 2]) -> f64,
        among: impl Fn([u32; 2]) -> bool,
    ) -> usize {
        // Border edges by pair of labels, and for every vertex its neighbours along each such border.
        let left = self.adjacency();
        let mut along: HashMap<(u32, (u32, u32)), Vec<u32>> = HashMap::default();
        let mut seams: Vec<(u32, u32, (u32, u32))> = Vec::new();
        for (&(a, b), &t) in &left {
            if a < b {
                let Some(&o) = left.get(&(b, a)) else { continue };
                let (l, r) = (self.labels[t as usize], self.labels[o as usize]);
                if l != r {
                    let pair = (l.min(r), l.max(r));
                    along.entry((a, pair)).or_default().push(b);
                    along.entry((b, pair)).or_default().push(a);
                    if among([pair.0, pair.1]) {
                        seams.push((a, b, pair));
                    }
                }
            }
        }
        seams.sort_unstable();
        let at = |v: u32| self.vertices[v as usize];
        // The vertex before `a` on the border that goes on to `b`, unless it ends or has a corner there.
        let before = |a: u32, b: u32, pair: (u32, u32)| -> Option<[f64; 2]> {
            let around = along.get(&(a, pair))?;
            let [x, y] = around[..] else { return None };
            let p = at(if x == b { y } else { x });
            let (d, e, f) = (distance(p, at(a)), distance(at(a), at(b)), distance(p, at(b)));
            // Law of cosines for the turn.
            let turn = (f * f - d * d - e * e) / (2.0 * d * e);
            (turn > CORNER).then_some(p)
        };
        let mut middle: HashMap<(u32, u32), u32> = HashMap::default();
        let mut places = Vec::new();
        for &(a, b, pair) in &seams {
            let (p, q) = (at(a), at(b));
            let straight = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
            // Lagrange interpolation over chord lengths from `a`, at the middle of the edge.
            let length = distance(p, q);
            let mut nodes = vec![(0.0, p), (length, q)];
            nodes.extend(before(a, b, pair).map(|o| (-distance(o, p), o)));
            nodes.extend(before(b, a, pair).map(|r| (length + distance(q, r), r)));
            if nodes.len() < 3 {
                continue;
            }
            let mut moved = [0.0; 2];
            for (i, (x, place)) in nodes.iter().enumerate() {
                let weight: f64 = nodes
                    .iter()
                    .enumerate()
                    .filter(|(j, _)| *j != i)
                    .map(|(_, (y, _))| (0.5 * length - y) / (x - y))
                    .product();
                moved[0] += weight * place[0];
                moved[1] += weight * place[1];
            }
            if !(moved[0].is_finite() && moved[1].is_finite()) {
                continue;
            }
            if distance(straight, moved) <= allowed {
                continue;
            }
            let opposite = |e: (u32, u32)| -> Option<[f64; 2]> {
                let t = self.triangles[*left.get(&e)? as usize];
                t.into_iter().find(|&x| x != e.0 && x != e.1).map(at)
            };
            let (Some(c), Some(d)) = (opposite((a, b)), opposite((b, a))) else { continue };
            let turns = |x: [f64; 2], y: [f64; 2], z: [f64; 2]| {
                let [x, y, z] = [x, y, z].map(|p| Coord { x: p[0], y: p[1] });
                orient2d(x, y, z) > 0.0
            };
            let fits = |m: [f64; 2]| {
                (0..2).all(|k| {
                    let (lo, hi) = (p[k].min(q[k]).min(c[k]).min(d[k]), p[k].max(q[k]).max(c[k]).max(d[k]));
                    // On a knot line all the way, or strictly between the same two lines as the triangles.
                    let on_line = lines[k].contains(&p[k]) && lines[k].contains(&q[k]);
                    !on_line && !lines[k].iter().any(|&l| l > lo && l < hi) && m[k] >= lo && m[k] <= hi
                }) && turns(p, m, c)
                    && turns(m, q, c)
                    && turns(q, m, d)
                    && turns(m, p, d)
            };
            let place = SHORTER
                .iter()
                .map(|&f| [straight[0] + f * (moved[0] - straight[0]), straight[1] + f * (moved[1] - straight[1])])
                .find(|&m| fits(m));
            if let Some(place) = place {
                middle.insert((a, b), self.vertices.len() as u32 + places.len() as u32);
                places.push(place);
            }
        }
        let count = places.len();
        let first = self.vertices.len();
        self.vertices.extend(places);
        let kept: Vec<[u32; 3]> = self.triangles.clone();
        let labels = self.labels.clone();
        let trims = self.trim_edges.clone();
        self.split_edges(&middle);
        // A triangle with several moved edges may still turn over: then nothing is gained by insisting.
        let valid = (0..self.triangles.len()).all(|t| {
            let [x, y, z] = self.corners(t).map(|p| Coord { x: p[0], y: p[1] });
            !edges(self.triangles[t]).iter().any(|e| e.0 as usize >= first || e.1 as usize >= first)
                || orient2d(x, y, z) > 0.0
        });
        if !valid {
            self.vertices.truncate(first);
            (self.triangles, self.labels, self.trim_edges) = (kept, labels, trims);
            return 0;
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use crate::patchwork::triangulate::triangulate;

    #[test]
    fn a_coarse_circle_becomes_a_fine_one() {
        let grid: Vec<f64> = (0..=8).map(|i| i as f64 / 8.0).collect();
        let square = vec![(vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]], vec![0, 1, 2, 3])];
        let mut p = triangulate(&square, &grid, &grid).expect("a square");
        p.cut(0, 1, |[u, v]| 0.35 - (u - 0.52).hypot(v - 0.47));
        let area = |p: &super::Partition| -> f64 {
            p.region(1)
                .into_iter()
                .map(|t| {
                    let [a, b, c] = p.corners(t);
                    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
                })
                .sum()
        };
        let exact = std::f64::consts::PI * 0.35 * 0.35;
        let coarse = (area(&p) - exact).abs();
        let distance = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        for _ in 0..2 {
            assert!(p.smooth_seams([&[0.0, 1.0], &[0.0, 1.0]], 1e-4, distance, |_| true) > 0);
        }
        // Edges beside slivers stay straight, hence not a sixteenth of the error.
        assert!((area(&p) - exact).abs() < 0.5 * coarse);
        let total: f64 = (0..p.triangles.len()).filter(|&t| p.labels[t] == 0).count() as f64;
        assert!(total > 0.0);
    }
}
