//! A region whose labels get other borders: the triangulation is made anew along lines that are given.

use super::partition::{edges, Partition};
use super::triangulate::{crossings, snap, Points, SNAP};
use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};
use std::collections::{BTreeSet, VecDeque};

/// Vertices of the old triangulation this close to a new border (share of a mean edge) give way.
const CLEAR: f64 = 0.3;
/// Points of lines this close to their crossings with knot lines (in mean edges) are left out.
const APART: f64 = 0.02;
/// Ends of lines this close (share of the region's extent) to a vertex or an edge of borders that stay lie there.
const ON: f64 = 1e-7;

/// A new border between two labels.
pub(crate) struct NewBorder<'a> {
    /// Labels on the left and on the right.
    pub labels: [u32; 2],
    /// Its points (u, v) in order. It ends on the border of the region, on a border that stays, or where others end.
    pub uv: &'a [[f64; 2]],
}

/// What a directed edge that must be there means: a border of the region on whose inner side one looks, or labels.
#[derive(Clone, Copy)]
enum ConstrainedEdge {
    Trim(u32),
    Between([u32; 2]),
}

/// What lies on one side.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Outside,
    Label(u32),
}

impl Partition {
    /// The same region with new borders in place of all that lie between the labels of some line; the others stay. `knots` are
    /// lines of constant u and v that no triangle may cross.
    ///
    /// # Errors
    /// Where the lines do not part the region, since they cross each other or what stays, end nowhere, or leave a label in
    /// pieces: the labels beside lines that cross something, if it is that.
    pub(crate) fn redrawn(&self, lines: &[NewBorder], knots: [&[f64]; 2]) -> Result<Self, Vec<[u32; 2]>> {
        let mut drawing = Drawing::of(self, lines, knots).ok_or_else(Vec::new)?;
        for line in lines {
            drawing.add(line).ok_or_else(|| vec![line.labels])?;
        }
        let out = drawing.filled()?;
        let whole = |l: &u32| out.components(&out.region(*l), |_, _| true).len() == 1;
        let labels = out.distinct_labels();
        if labels != self.distinct_labels() || !labels.iter().all(whole) {
            return Err(Vec::new());
        }
        Ok(out)
    }
}

/// Points and edges of the new triangulation.
struct Drawing<'a> {
    knots: [&'a [f64]; 2],
    /// Width and height of the region.
    extent: [f64; 2],
    /// Mean edge of the old triangulation along both axes.
    cell: [f64; 2],
    points: Points,
    /// Directed edges: borders of the region have it on the left.
    constrained: HashMap<(u32, u32), ConstrainedEdge>,
}

impl<'a> Drawing<'a> {
    fn of(from: &Partition, lines: &[NewBorder], knots: [&'a [f64]; 2]) -> Option<Self> {
        let going: HashSet<[u32; 2]> = lines.iter().flat_map(|l| [l.labels, [l.labels[1], l.labels[0]]]).collect();
        let of = from.adjacency();
        let label = |e: (u32, u32)| of.get(&e).map(|&t| from.labels[t as usize]);
        let mut constrained = HashMap::default();
        let (mut sums, mut kept, mut gone) = ([0.0; 2], BTreeSet::new(), HashSet::default());
        let mut points = Points::default();
        let mut count = 0.0_f64;
        for (&t, &l) in from.triangles.iter().zip(&from.labels) {
            for (a, b) in edges(t) {
                let [p, q] = [a, b].map(|v| from.vertices[v as usize]);
                sums = [sums[0] + (p[0] - q[0]).abs(), sums[1] + (p[1] - q[1]).abs()];
                count += 1.0;
                let edge_meaning = match (from.trim_edges.get(&(a, b)), label((b, a))) {
                    (Some(&number), _) => ConstrainedEdge::Trim(number),
                    (None, Some(m)) if m != l && !going.contains(&[l, m]) => ConstrainedEdge::Between([l, m]),
                    (None, Some(m)) => {
                        if m != l {
                            gone.extend([a, b]);
                        }
                        continue;
                    }
                    (None, None) => return None,
                };
                kept.extend([a, b]);
                // Both sides of a border that stays are seen; it is noted once.
                if matches!(edge_meaning, ConstrainedEdge::Trim(_)) || a < b {
                    constrained.insert((points.index(p), points.index(q)), edge_meaning);
                }
            }
        }
        let bounds = from.vertices.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[lo, hi], p| {
            [[lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])]]
        });
        let extent = [0, 1].map(|d: usize| bounds[1][d] - bounds[0][d]);
        let cell = sums.map(|s| s / count.max(1.0));
        if ![extent, cell].as_flattened().iter().all(|x| *x > 0.0 && x.is_finite()) {
            return None;
        }
        // Vertices inside stay, but those of borders that go and those in the way; crossings of knot lines always do.
        let on_knots = |p: &[f64; 2]| [0, 1].map(|d: usize| knots[d].contains(&p[d]));
        let near = Near::of(lines, cell);
        let inside = parallel::map((0..from.vertices.len() as u32).filter(|v| !kept.contains(v)), |v| {
            let p = from.vertices[v as usize];
            (on_knots(&p) == [true; 2] || (!gone.contains(&v) && !near.is_near(&p))).then_some(p)
        });
        inside.into_iter().flatten().for_each(|p| {
            points.index(p);
        });
        Some(Self { knots, extent, cell, points, constrained })
    }

    /// Adds a line, cut at the knot lines, its ends on what is there.
    fn add(&mut self, line: &NewBorder) -> Option<()> {
        let slack = self.extent.map(|e| SNAP * e);
        let mut uv: Vec<[f64; 2]> = line
            .uv
            .iter()
            .map(|p| [snap(p[0], self.knots[0], slack[0]), snap(p[1], self.knots[1], slack[1])])
            .collect();
        let last = uv.len().checked_sub(1).filter(|l| *l > 0)?;
        for k in [0, last] {
            uv[k] = self.end(uv[k]);
        }
        // Points of the line, and whether they are crossings.
        let mut places = vec![(uv[0], true)];
        for w in uv.windows(2) {
            let (a, b) = (w[0], w[1]);
            let mut between: Vec<(f64, [f64; 2])> = Vec::new();
            let at = |s: f64, d: usize| a[d] + (b[d] - a[d]) * s;
            between.extend(crossings(a[0], b[0], self.knots[0], slack[0]).into_iter().map(|(s, u)| (s, [u, at(s, 1)])));
            between.extend(crossings(a[1], b[1], self.knots[1], slack[1]).into_iter().map(|(s, v)| (s, [at(s, 0), v])));
            between.sort_by(|x, y| x.0.total_cmp(&y.0));
            let snapped = |p: [f64; 2]| [snap(p[0], self.knots[0], slack[0]), snap(p[1], self.knots[1], slack[1])];
            places.extend(between.into_iter().map(|(_, p)| (snapped(p), true)));
            places.push((b, false));
        }
        if let Some(end) = places.last_mut() {
            end.1 = true;
        }
        // Short edges beside crossings would turn round where vertices move along knot lines.
        let near =
            |p: &[f64; 2], q: &[f64; 2]| ((p[0] - q[0]) / self.cell[0]).hypot((p[1] - q[1]) / self.cell[1]) < APART;
        let goes = |k: usize| {
            let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|i| places.get(i));
            !places[k].1 && beside.into_iter().any(|q| q.1 && near(&places[k].0, &q.0))
        };
        let left: Vec<[f64; 2]> = (0..places.len()).filter(|k| !goes(*k)).map(|k| places[k].0).collect();
        let mut chain: Vec<u32> = left.into_iter().map(|p| self.points.index(p)).collect();
        chain.dedup();
        for w in chain.windows(2) {
            let taken = self.constrained.contains_key(&(w[0], w[1])) || self.constrained.contains_key(&(w[1], w[0]));
            if taken {
                return None;
            }
            self.constrained.insert((w[0], w[1]), ConstrainedEdge::Between(line.labels));
        }
        Some(())
    }

    /// Where a line ends: at a vertex of what is there, or on an edge of it, which is cut there.
    fn end(&mut self, p: [f64; 2]) -> [f64; 2] {
        let scaled = |p: [f64; 2], q: [f64; 2]| [(q[0] - p[0]) / self.extent[0], (q[1] - p[1]) / self.extent[1]];
        let mut best: Option<(f64, (u32, u32), f64)> = None;
        for &(a, b) in self.constrained.keys() {
            let [x, y] = [a, b].map(|v| self.points.list[v as usize]);
            let (d, off) = (scaled(x, y), scaled(x, p));
            let share = ((off[0] * d[0] + off[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
            let distance = (off[0] - share * d[0]).hypot(off[1] - share * d[1]);
            if distance <= ON && best.is_none_or(|b| distance < b.0) {
                best = Some((distance, (a, b), share));
            }
        }
        let Some((_, (a, b), share)) = best else { return p };
        let [x, y] = [a, b].map(|v| self.points.list[v as usize]);
        for q in [x, y] {
            let off = scaled(q, p);
            if off[0].hypot(off[1]) <= ON {
                return q;
            }
        }
        let q = [0, 1].map(|d: usize| if x[d] == y[d] { x[d] } else { x[d] + (y[d] - x[d]) * share });
        let Some(edge_meaning) = self.constrained.remove(&(a, b)) else { return p };
        let m = self.points.index(q);
        self.constrained.insert((a, m), edge_meaning);
        self.constrained.insert((m, b), edge_meaning);
        q
    }

    /// The triangles, with the labels that the borders tell.
    fn filled(self) -> Result<Partition, Vec<[u32; 2]>> {
        let scale = self.cell.map(f64::recip);
        let mut cdt: ConstrainedDelaunayTriangulation<Point2<f64>> = ConstrainedDelaunayTriangulation::new();
        let mut handle = Vec::with_capacity(self.points.list.len());
        for (k, p) in self.points.list.iter().enumerate() {
            let h = cdt.insert(Point2::new(p[0] * scale[0], p[1] * scale[1])).map_err(|_| Vec::new())?;
            // Points that are one in the scaled plane would share a handle.
            if h.index() != k {
                return Err(Vec::new());
            }
            handle.push(h);
        }
        let mut constrained: Vec<(u32, u32)> = self.constrained.keys().copied().collect();
        constrained.sort_unstable();
        let mut crossing = BTreeSet::new();
        for e in constrained {
            let [a, b] = [e.0, e.1].map(|v| handle[v as usize]);
            if cdt.can_add_constraint(a, b) {
                cdt.add_constraint(a, b);
            } else if let ConstrainedEdge::Between(labels) = self.constrained[&e] {
                crossing.insert(labels);
            } else {
                return Err(Vec::new());
            }
        }
        if !crossing.is_empty() {
            return Err(crossing.into_iter().collect());
        }
        for (axis, lines) in self.knots.iter().enumerate() {
            for chain in self.points.on_lines(lines, axis) {
                for w in chain.windows(2) {
                    let [a, b] = [w[0], w[1]].map(|v| handle[v as usize]);
                    if cdt.can_add_constraint(a, b) {
                        cdt.add_constraint(a, b);
                    }
                }
            }
        }
        let faces: Vec<[u32; 3]> = cdt.inner_faces().map(|f| f.vertices().map(|v| v.index() as u32)).collect();
        let sides = self.sides(&faces).ok_or_else(Vec::new)?;
        let mut out = Partition { vertices: self.points.list.clone(), ..Partition::default() };
        for (&f, side) in faces.iter().zip(sides) {
            let Side::Label(label) = side else { continue };
            let corners = f.map(|v| self.points.list[v as usize]);
            let [p, q, r] = corners.map(|p| robust::Coord { x: p[0], y: p[1] });
            if robust::orient2d(p, q, r) <= 0.0 || self.crosses_knots(&corners) {
                return Err(Vec::new());
            }
            out.triangles.push(f);
            out.labels.push(label);
            for e in edges(f) {
                if let Some(ConstrainedEdge::Trim(number)) = self.constrained.get(&e) {
                    out.trim_edges.insert(e, *number);
                }
            }
        }
        Ok(without_unused(out))
    }

    /// On which side of the constrained edges every triangle lies. `None` where these contradict each other, or say nothing.
    fn sides(&self, faces: &[[u32; 3]]) -> Option<Vec<Side>> {
        let mut left: HashMap<(u32, u32), usize> =
            HashMap::with_capacity_and_hasher(3 * faces.len(), Default::default());
        for (k, &f) in faces.iter().enumerate() {
            left.extend(edges(f).map(|e| (e, k)));
        }
        let mut sides: Vec<Option<Side>> = vec![None; faces.len()];
        let mut queue = VecDeque::new();
        for (&(a, b), edge_meaning) in &self.constrained {
            let seeds = match *edge_meaning {
                // What is inside other constrained edges tell.
                ConstrainedEdge::Trim(_) => [None, Some(Side::Outside)],
                ConstrainedEdge::Between(labels) => labels.map(|l| Some(Side::Label(l))),
            };
            for (e, seed) in [(a, b), (b, a)].into_iter().zip(seeds) {
                let (Some(&k), Some(seed)) = (left.get(&e), seed) else { continue };
                if sides[k].is_some_and(|s| s != seed) {
                    return None;
                }
                sides[k] = Some(seed);
                queue.push_back(k);
            }
        }
        while let Some(k) = queue.pop_front() {
            for (a, b) in edges(faces[k]) {
                let Some(&next) = left.get(&(b, a)) else { continue };
                if self.constrained.contains_key(&(a, b)) || self.constrained.contains_key(&(b, a)) {
                    continue;
                }
                match sides[next] {
                    None => {
                        sides[next] = sides[k];
                        queue.push_back(next);
                    }
                    found if found != sides[k] => return None,
                    _ => {}
                }
            }
        }
        sides.into_iter().collect()
    }

    fn crosses_knots(&self, corners: &[[f64; 2]; 3]) -> bool {
        (0..2).any(|d| {
            let lo = corners.iter().fold(f64::INFINITY, |m, p| m.min(p[d]));
            let hi = corners.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p[d]));
            self.knots[d].iter().any(|k| *k > lo && *k < hi)
        })
    }
}

fn without_unused(mut all: Partition) -> Partition {
    let mut place = vec![u32::MAX; all.vertices.len()];
    let mut vertices = Vec::new();
    for v in all.triangles.iter().flatten() {
        if place[*v as usize] == u32::MAX {
            place[*v as usize] = vertices.len() as u32;
            vertices.push(all.vertices[*v as usize]);
        }
    }
    let placed = |v: u32| place[v as usize];
    all.triangles.iter_mut().for_each(|t| *t = t.map(placed));
    all.trim_edges = all.trim_edges.into_iter().map(|((a, b), n)| ((placed(a), placed(b)), n)).collect();
    Partition { vertices, ..all }
}

/// Lines in the plane in which cells are squares of size 1.
struct Near {
    cell: [f64; 2],
    /// Cells that lines come near, with the pieces of line there.
    pieces: HashMap<[i64; 2], Vec<[[f64; 2]; 2]>>,
}

impl Near {
    fn of(lines: &[NewBorder], cell: [f64; 2]) -> Self {
        let mut out = Self { cell, pieces: HashMap::default() };
        for w in lines.iter().flat_map(|l| l.uv.windows(2)) {
            let piece = [w[0], w[1]].map(|p| out.scaled(&p));
            let range = |d: usize| {
                let (a, b) = (piece[0][d].min(piece[1][d]), piece[0][d].max(piece[1][d]));
                (a - CLEAR).floor() as i64..=(b + CLEAR).floor() as i64
            };
            for i in range(0) {
                for j in range(1) {
                    out.pieces.entry([i, j]).or_default().push(piece);
                }
            }
        }
        out
    }

    fn scaled(&self, p: &[f64; 2]) -> [f64; 2] {
        [p[0] / self.cell[0], p[1] / self.cell[1]]
    }

    fn is_near(&self, p: &[f64; 2]) -> bool {
        let p = self.scaled(p);
        let distance = |[a, b]: &[[f64; 2]; 2]| {
            let (d, off) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
            let square = (d[0] * d[0] + d[1] * d[1]).max(f64::MIN_POSITIVE);
            let share = ((off[0] * d[0] + off[1] * d[1]) / square).clamp(0.0, 1.0);
            (off[0] - share * d[0]).hypot(off[1] - share * d[1])
        };
        let cell = [p[0].floor() as i64, p[1].floor() as i64];
        self.pieces.get(&cell).is_some_and(|pieces| pieces.iter().any(|q| distance(q) < CLEAR))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patchwork::triangulate::triangulate;

    /// The unit square in cells, with the label 1 where u > 1/2 and 2 where u > 3/4.
    fn square() -> Partition {
        let grid: Vec<f64> = (0..=12).map(|i| f64::from(i) / 12.0).collect();
        let corners = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut out = triangulate(&[(corners, vec![5, 6, 7, 8])], &grid, &grid).expect("a square");
        out.cut(0, 1, |p| p[0] - 0.5);
        out.cut(1, 2, |p| p[0] - 0.75);
        out
    }

    fn area(p: &Partition, label: u32) -> f64 {
        let of = |[a, b, c]: [[f64; 2]; 3]| 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        p.region(label).into_iter().map(|t| of(p.corners(t))).sum()
    }

    const KNOTS: [f64; 3] = [0.0, 0.5, 1.0];

    #[test]
    fn borders_go_to_new_lines_and_others_stay() {
        // Upwards, with 0 on the left; through u = 1/2 at v = 1/2.
        let uv: Vec<[f64; 2]> = (0..=20).map(|i| f64::from(i) / 20.0).map(|v| [0.4 + 0.2 * v, v]).collect();
        let lines = [NewBorder { labels: [0, 1], uv: &uv }];
        let out = square().redrawn(&lines, [&KNOTS, &KNOTS]).expect("redrawn");
        let found = [0, 1, 2].map(|l| area(&out, l));
        let want = [0.5, 0.25, 0.25];
        assert!(found.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        let of = |number: u32| {
            let of = out.trim_edges.iter().filter(|(_, n)| **n == number);
            of.map(|((a, b), _)| {
                let [p, q] = [*a, *b].map(|v| out.vertices[v as usize]);
                (q[0] - p[0]).hypot(q[1] - p[1])
            })
            .sum::<f64>()
        };
        assert!([5, 6, 7, 8].iter().all(|n| (of(*n) - 1.0).abs() < 1e-12));
        let crossed = |t: usize| {
            let u = out.corners(t).map(|p| p[0]);
            u.iter().any(|u| *u < 0.5) && u.iter().any(|u| *u > 0.5)
        };
        assert!(!(0..out.triangles.len()).any(crossed), "a triangle crosses the knot line");
    }

    #[test]
    fn lines_that_do_not_part_the_region_are_refused() {
        let redrawn = |uv: &[[f64; 2]]| square().redrawn(&[NewBorder { labels: [0, 1], uv }], [&KNOTS, &KNOTS]);
        assert!(redrawn(&[[0.4, 0.0], [0.4, 1.0]]).is_ok());
        // Through a border that stays, ending inside, the wrong way round.
        assert!(redrawn(&[[0.4, 0.0], [0.9, 0.5], [0.4, 1.0]]).is_err());
        assert!(redrawn(&[[0.4, 0.0], [0.4, 0.7]]).is_err());
        assert!(redrawn(&[[0.4, 1.0], [0.4, 0.0]]).is_err());
    }

    #[test]
    fn three_lines_may_meet_inside() {
        let mut three = square();
        three.cut(0, 3, |p| p[1] - 0.5);
        let m = [0.3, 0.4];
        // 0 below and 3 above on the left, 1 on the right.
        let lines = [
            NewBorder { labels: [0, 1], uv: &[[0.45, 0.0], m] },
            NewBorder { labels: [3, 1], uv: &[m, [0.6, 1.0]] },
            NewBorder { labels: [3, 0], uv: &[[0.0, 0.45], m] },
        ];
        let out = three.redrawn(&lines, [&KNOTS, &KNOTS]).expect("redrawn");
        let shoelace = |c: &[[f64; 2]]| {
            let n = c.len();
            (0..n).map(|i| 0.5 * (c[i][0] * c[(i + 1) % n][1] - c[i][1] * c[(i + 1) % n][0])).sum::<f64>()
        };
        assert!((area(&out, 0) - shoelace(&[[0.0, 0.0], [0.45, 0.0], m, [0.0, 0.45]])).abs() < 1e-12);
        assert!((area(&out, 3) - shoelace(&[[0.0, 0.45], m, [0.6, 1.0], [0.0, 1.0]])).abs() < 1e-12);
        assert!((area(&out, 2) - 0.25).abs() < 1e-12);
    }
}
