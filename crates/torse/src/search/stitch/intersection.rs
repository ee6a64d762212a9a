//! Seams along which strips intersect: neighbours that are not equally far from the face along their border are so
//! beside it. Strips stay as they are, the borders between their regions move there ([`StripPair`]). Nothing is judged here.

use super::known_edge::{KnownEdge, STEPS};
use super::seams::{pair, settle, SharedSeam};
use super::strip_pair::{EdgeEnds, StripPair, EDGE};
use crate::fit::height::Height;
use crate::fit::panels::boundary::{Borders, SeamChain};
use crate::geom::Vec3;
use crate::patchwork::partition::Partition;
use crate::search::cover::Cover;
use crate::search::joint::whole_borders;
use crate::spline::curve::Curve;
use crate::torse::form::Torse;
use std::collections::{BTreeMap, BTreeSet};

/// Rounds of moving a vertex, the shares of the way that are tried in each, and what a triangle beside it keeps of its area.
const VERTEX_ROUNDS: usize = 20;
/// See [`VERTEX_ROUNDS`].
const VERTEX_SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// See [`VERTEX_ROUNDS`].
const LEAST_TRIANGLE: f64 = 0.2;

/// Strips that intersect, by label.
pub(crate) struct Intersections<'a> {
    heights: BTreeMap<u32, Height<'a>>,
    /// Edges of two strips that are known, for their borders to lie under.
    known: BTreeMap<[u32; 2], KnownEdge>,
    /// Points in which the edges of three labels end.
    vertices: BTreeMap<Vec<u32>, Vec3>,
}

impl<'a> Intersections<'a> {
    /// Strips without known edges. Those of which no heights can be told are left out.
    pub fn new(torses: &BTreeMap<u32, &'a Torse>) -> Self {
        let heights = torses.iter().filter_map(|(&l, t)| Some((l, Height::of(t)?))).collect();
        Self { heights, known: BTreeMap::new(), vertices: BTreeMap::new() }
    }

    /// The same with edges that are known, which need not cross at any angle, and the points in which those of three
    /// labels end.
    pub fn with_known_edges(mut self, edges: Vec<([u32; 2], Curve<3>)>, vertices: Vec<(Vec<u32>, Vec3)>) -> Self {
        self.known = edges.into_iter().map(|(labels, curve)| (pair(labels), KnownEdge::new(curve))).collect();
        self.vertices = vertices.into_iter().collect();
        self
    }

    /// The borders of a cover by these strips.
    pub fn on(&'a self, cover: &'a Cover) -> StripBorders<'a> {
        let borders = cover.borders();
        let chains = borders.seam_chains();
        StripBorders { strips: self, cover, borders, chains }
    }

    /// Whether two strips are parts of one torse, which do not intersect: any border between them is an edge of both.
    fn is_one_torse(&self, [a, b]: [u32; 2]) -> bool {
        let [a, b] = [a, b].map(|l| self.heights.get(&l));
        a.zip(b).is_some_and(|(a, b)| a.is_of_the_torse_of(b))
    }
}

/// The borders of a cover, with strips on both sides.
pub(crate) struct StripBorders<'a> {
    strips: &'a Intersections<'a>,
    cover: &'a Cover,
    /// All borders.
    pub borders: Borders<'a>,
    /// Those between labels.
    chains: Vec<SeamChain>,
}

impl StripBorders<'_> {
    /// Largest difference (mm) of the heights of two strips at a vertex of their border; `None` where there is no border, or a strip
    /// has no height.
    pub fn largest_gap(&self) -> Option<f64> {
        let gaps = self.chains.iter().map(|c| self.pair(c)?.gap());
        gaps.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
    }

    /// Whether a border lies where two strips are equally high already.
    fn is_level(&self, chain: &SeamChain) -> bool {
        self.pair(chain).and_then(|strips| strips.gap()).is_some_and(|gap| gap <= EDGE.1 * chain.length)
    }

    /// The vertices in which borders end inside the face, with the point that their labels have in common.
    fn common_points(&self) -> BTreeMap<u32, Vec3> {
        let mut labels: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for c in &self.chains {
            for &v in c.vertices.first().into_iter().chain(c.vertices.last()) {
                labels.entry(v).or_default().extend(c.labels);
            }
        }
        let point =
            |(v, l): (u32, BTreeSet<u32>)| Some((v, *self.strips.vertices.get(&l.into_iter().collect::<Vec<_>>())?));
        labels.into_iter().filter_map(point).collect()
    }

    /// The cover with the vertices in which borders end inside the face under the points that their labels have in common;
    /// others make way. Vertices that cannot go there stay where they get to.
    pub fn with_vertices(&self) -> Cover {
        let surface = &self.cover.face.surface;
        let mut partition = self.cover.partition.clone();
        let lines = [surface.knots_u.breaks(), surface.knots_v.breaks()];
        for (v, x) in self.common_points() {
            let Some(target) = self.under(&x, partition.vertices[v as usize]) else { continue };
            let around: Vec<usize> =
                (0..partition.triangles.len()).filter(|&t| partition.triangles[t].contains(&v)).collect();
            for _ in 0..VERTEX_ROUNDS {
                let old = partition.vertices[v as usize];
                if old == target {
                    break;
                }
                // No triangle may cross a knot line.
                let crosses = |d: usize| {
                    let (a, b) = (old[d].min(target[d]), old[d].max(target[d]));
                    a < b && lines[d].iter().any(|k| (a..=b).contains(k))
                };
                if crosses(0) || crosses(1) {
                    break;
                }
                let area = |p: &Partition, t: usize| {
                    let [a, b, c] = p.corners(t);
                    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
                };
                let before: Vec<f64> = around.iter().map(|&t| area(&partition, t)).collect();
                for share in VERTEX_SHARES {
                    let to = |d: usize| if share < 1.0 { old[d] + (target[d] - old[d]) * share } else { target[d] };
                    partition.vertices[v as usize] = [to(0), to(1)];
                    if around.iter().zip(&before).all(|(&t, b)| area(&partition, t) > LEAST_TRIANGLE * b) {
                        break;
                    }
                    partition.vertices[v as usize] = old;
                }
                partition.relax([&lines[0], &lines[1]]);
            }
        }
        self.cover.with_partition(partition)
    }

    /// Parameters of the place on the face whose normal goes through a point.
    fn under(&self, x: &Vec3, mut p: [f64; 2]) -> Option<[f64; 2]> {
        let surface = &self.cover.face.surface;
        for _ in 0..STEPS {
            let j = surface.jet(p[0], p[1]);
            let n = self.borders.normal(p).try_normalize(0.0)?;
            let off = x - j.p;
            let off = off - n * off.dot(&n);
            let (e, f, g) = (j.du.dot(&j.du), j.du.dot(&j.dv), j.dv.dot(&j.dv));
            let (a, b, det) = (j.du.dot(&off), j.dv.dot(&off), e * g - f * f);
            let next = [p[0] + (a * g - b * f) / det, p[1] + (b * e - a * f) / det];
            if !next.iter().all(|x| x.is_finite()) {
                return None;
            }
            p = next;
        }
        let ((u0, u1), (v0, v1)) = surface.domain();
        ((u0..=u1).contains(&p[0]) && (v0..=v1).contains(&p[1])).then_some(p)
    }

    /// The cover with the borders between pairs of labels about where their strips intersect; second result: the pairs
    /// whose borders were moved.
    pub fn cut(&self, pairs: &[[u32; 2]]) -> (Cover, Vec<[u32; 2]>) {
        let mut now = self.cover.clone();
        let (mut moved, mut left) = (Vec::new(), pairs.to_vec());
        // Where a border must wait until the next one has made room it is tried again.
        loop {
            let traced = now.clone();
            let borders = self.strips.on(&traced);
            let chains = whole_borders(borders.chains.clone());
            let before = left.len();
            left.retain(|&p| {
                let of: Vec<&SeamChain> = chains.iter().filter(|c| pair(c.labels) == p).collect();
                let lies_there = of.len() > 1 || self.strips.is_one_torse(p);
                if lies_there && of.iter().all(|c| borders.is_level(c)) {
                    // As around a hole it has several parts, or it parts one torse, and lies where it should.
                    moved.push(p);
                    return false;
                }
                let [chain] = of[..] else { return true };
                let Some(next) = borders.pair(chain).and_then(|strips| strips.cut(&now)) else { return true };
                now = next;
                moved.push(p);
                false
            });
            if left.is_empty() || left.len() == before {
                break;
            }
        }
        (now, moved)
    }

    /// The cover with the vertices of these borders where the strips intersect. A corner of a border that cannot go there,
    /// since its triangle lies between its neighbours, is left to the other side.
    pub fn settled(&self, pairs: &[[u32; 2]]) -> Cover {
        let along = self.chains.iter().filter(|c| pairs.contains(&pair(c.labels)));
        let (along, strips): (Vec<&SeamChain>, Vec<StripPair>) = along.filter_map(|c| Some((c, self.pair(c)?))).unzip();
        let mut partition = self.cover.partition.clone();
        let staying = settle(&self.cover.face, &mut partition, &along, |k, p, fixed| strips[k].onto(p, fixed));
        for chain in along {
            for corner in chain.vertices.windows(3).filter(|w| staying.contains(&w[1])) {
                let is_cut_off = |t: &[u32; 3]| corner.iter().all(|v| t.contains(v));
                let Some(t) = partition.triangles.iter().position(is_cut_off) else { continue };
                let [a, b] = chain.labels;
                partition.labels[t] = if partition.labels[t] == a { b } else { a };
            }
        }
        self.cover.with_partition(partition)
    }

    /// Edges of these borders, and the pairs for which there is none.
    pub fn edges(&self, pairs: &[[u32; 2]]) -> (Vec<SharedSeam>, Vec<[u32; 2]>) {
        self.edges_through(&self.common_points(), pairs)
    }

    /// The same, with the points in which edges must end at vertices.
    pub fn edges_through(&self, points: &BTreeMap<u32, Vec3>, pairs: &[[u32; 2]]) -> (Vec<SharedSeam>, Vec<[u32; 2]>) {
        let (mut edges, mut spoilt) = (Vec::new(), Vec::new());
        let mut ends = EdgeEnds::new(points, &self.chains);
        let mut pairs: Vec<(bool, [u32; 2])> = pairs.iter().map(|p| (self.strips.known.contains_key(p), *p)).collect();
        pairs.sort_by_key(|p| !p.0);
        for (is_known, p) in pairs {
            // A border with corners has several chains, one around a hole too.
            let of = self.chains.iter().filter(|c| pair(c.labels) == p);
            let parts = of.map(|c| self.pair(c)?.edge(&mut ends)).collect::<Option<Vec<SharedSeam>>>();
            match parts.filter(|parts| is_known || !parts.is_empty()) {
                Some(parts) => edges.extend(parts),
                None => spoilt.push(p),
            }
        }
        (edges, spoilt)
    }

    /// The strips beside a border.
    fn pair<'b>(&'b self, chain: &'b SeamChain) -> Option<StripPair<'b>> {
        let [a, b] = chain.labels.map(|l| self.strips.heights.get(&l));
        let known = self.strips.known.get(&pair(chain.labels));
        Some(StripPair { cover: self.cover, borders: &self.borders, chain, heights: [a?, b?], known })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::Face;
    use crate::geom::Frame;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use crate::torse::form::PrimalTorse;

    /// The plane z = d + x·c + y·g.
    fn plane(d: f64, c: f64, g: f64) -> Torse {
        let at = |x: f64| [d + c * x, 0.0];
        let knots = vec![-50., -50., -50., -50., 150., 150., 150., 150.];
        let control = [-50.0, 50.0 / 3.0, 250.0 / 3.0, 150.0].map(at).to_vec();
        let profile = Curve::new(3, knots, control).expect("a profile");
        Torse::Primal(PrimalTorse::new(Frame::world(), profile, g))
    }

    fn square() -> Face {
        let k = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let points = [(0.0, 0.0), (0.0, 100.0), (100.0, 0.0), (100.0, 100.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        Face::untrimmed(Surface::new(k.clone(), k, &points, None).expect("a square"))
    }

    /// The square, cut at x = 50 into the labels 0 and 1.
    fn halves(face: &Face) -> Cover {
        let mut cover = Cover::of_face(face, 20.0).expect("a cover");
        cover.partition.labels.fill(0);
        cover.cut(0, 1, |p| p[0] - 0.5);
        cover
    }

    #[test]
    fn borders_move_to_where_strips_intersect() {
        let face = square();
        let cover = halves(&face);
        // Equal at x = 53 + y/25, which is 1.0 to 5.0 beside the border.
        let (left, right) = (plane(-5.3, 0.1, -0.004), plane(5.3, -0.1, 0.004));
        let torses = BTreeMap::from([(0, &left), (1, &right)]);
        let intersections = Intersections::new(&torses);
        let (cut, moved) = intersections.on(&cover).cut(&[[0, 1]]);
        assert_eq!(moved, [[0, 1]]);
        let settled = intersections.on(&cut).settled(&moved);
        assert!((settled.region(0).area() - 5500.0).abs() < 1e-6 && (settled.region(1).area() - 4500.0).abs() < 1e-6);
        let borders = intersections.on(&settled);
        let (edges, spoilt) = borders.edges(&moved);
        assert!(edges.len() == 1 && spoilt.is_empty());
        for k in 0..=10 {
            let [x, y, z] = edges[0].edge.point(f64::from(k) / 10.0);
            assert!((x - 53.0 - y / 25.0).abs() < 1e-9 && z.abs() < 1e-9, "({x}, {y}, {z})");
        }
        for (s, &v) in edges[0].parameters.iter().zip(&borders.chains[0].vertices) {
            let off = Vec3::from(edges[0].edge.point(*s)) - settled.point(v);
            assert!(off.norm() < 1e-9, "{off}");
        }
    }

    #[test]
    fn borders_stay_where_strips_hardly_cross_or_cross_far_away() {
        let face = square();
        let cover = halves(&face);
        // At an angle of 0.001 rad; at x = 90, beyond 0.4 of the right half; one above the other.
        for (left, right) in [
            (plane(-0.025, 0.0005, 0.0), plane(0.025, -0.0005, 0.0)),
            (plane(-9.0, 0.1, 0.0), plane(9.0, -0.1, 0.0)),
            (plane(1.0, 0.0, 0.0), plane(-1.0, 0.0, 0.0)),
        ] {
            let torses = BTreeMap::from([(0, &left), (1, &right)]);
            let (same, moved) = Intersections::new(&torses).on(&cover).cut(&[[0, 1]]);
            assert!(moved.is_empty());
            assert_eq!(same.partition.labels, cover.partition.labels);
        }
    }
}
