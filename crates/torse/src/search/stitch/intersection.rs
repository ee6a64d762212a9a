//! Seams along which strips intersect: neighbours that are not equally far from the face along their border are so
//! beside it. Strips stay as they are, the border between their regions moves there. Nothing is judged here.
//!
//! *Method*: both strips as heights over the face [`Height`]; regions are cut where the difference of heights vanishes,
//! which lies by difference over slope beside the border to first order. Ill posed where strips hardly cross
//! (parabolic lines).

use super::seams::{settle, SharedSeam};
use crate::brep::face::Face;
use crate::fit::height::Height;
use crate::fit::panels::boundary::{Borders, SeamChain};
use crate::geom::Vec3;
use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;
use crate::patchwork::partition::Partition;
use crate::search::build::borders as borders_of;
use crate::search::cover::Cover;
use crate::search::joint::{turning, whole_borders};
use crate::spline::curve::Curve;
use crate::spline::lsq;
use crate::torse::form::Torse;
use std::collections::{BTreeMap, BTreeSet};

/// Borders move by at most this share of the width of the region that they move into: to where strips of their own intersect;
/// under edges that are known, as the borders on the other sides go along.
const REACH: (f64, f64) = (0.4, 1.0);
/// Vertices are asked on which side they are within this multiple of the way that the border is expected to move.
const ASKED: f64 = 2.0;
/// Vertices of the border on both sides whose ways count for a place.
const BESIDE: usize = 2;
/// Least angle (rad) at which strips must cross all along a seam.
const LEAST_ANGLE: f64 = 0.002;
/// Places on every edge of a border at which its curve is taken at least, and on all edges.
const PLACES: (usize, usize) = (6, 1500);
/// Distance between the edge in space and the intersection as a share of its length, wanted and allowed.
pub(super) const EDGE: (f64, f64) = (1e-8, 1e-6);
/// Distance of a cut through one torse from the border as a share of its length, wanted and allowed, and spans of it at most.
const SMOOTH: (f64, f64, usize) = (1e-4, 1e-3, 16);
/// Degree of edges, and spans at most.
pub(super) const CURVE: (usize, usize) = (5, 480);

/// Labels of two neighbours, in order.
pub(crate) fn pair([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Strips that intersect, by label.
pub(crate) struct Intersections<'a> {
    face: &'a Face,
    heights: BTreeMap<u32, Height<'a>>,
    /// Edges of two strips that are known, for their borders to lie under.
    known: BTreeMap<[u32; 2], KnownEdge>,
    /// Points in which the edges of three labels end.
    vertices: BTreeMap<Vec<u32>, Vec3>,
}

/// An edge of two strips in space, and places on it.
struct KnownEdge {
    curve: Curve<3>,
    places: Vec<(f64, Vec3)>,
}

/// Newton steps to a place on an edge, under a point, or between heights: some more than are taken.
const STEPS: usize = 20;
/// Rounds of moving a vertex, the shares of the way that are tried in each, and what a triangle beside it keeps of its area.
const VERTEX_ROUNDS: usize = 20;
/// See [`VERTEX_ROUNDS`].
const VERTEX_SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// See [`VERTEX_ROUNDS`].
const LEAST_TRIANGLE: f64 = 0.2;
/// Distance (share of the edge's length) of the point in which edges end from each.
const COMMON: f64 = 1e-6;
/// Places on a known edge from which its nearest point is looked for.
const KNOWN: usize = 400;

impl KnownEdge {
    fn new(curve: Curve<3>) -> Self {
        let (a, b) = curve.domain();
        let at = |i: usize| a + (b - a) * i as f64 / KNOWN as f64;
        let places = (0..=KNOWN).map(|i| (at(i), Vec3::from(curve.point(at(i))))).collect();
        Self { curve, places }
    }

    /// The parameter of the point that lies beside `x`, not along the edge, as seen along the unit normal `n`, and how far
    /// (mm) `x` is to the left of it.
    fn beside(&self, x: &Vec3, n: &Vec3) -> Option<(f64, f64)> {
        const SETTLED: f64 = 1e-15;
        let off = |p: &(f64, Vec3)| (p.1 - x).norm_squared();
        let mut s = self.places.iter().min_by(|p, q| off(p).total_cmp(&off(q)))?.0;
        let (a, b) = self.curve.domain();
        for _ in 0..STEPS {
            let j = self.curve.jet(s).map(Vec3::from);
            let along = j[1] - n * j[1].dot(n);
            let step = (x - j[0]).dot(&along) / j[1].dot(&along);
            if !step.is_finite() {
                return None;
            }
            let next = (s + step).clamp(a, b);
            let settled = (next - s).abs() <= SETTLED * (b - a);
            s = next;
            if settled {
                break;
            }
        }
        let j = self.curve.jet(s).map(Vec3::from);
        Some((s, (x - j[0]).dot(&n.cross(&j[1]).try_normalize(0.0)?)))
    }
}

impl<'a> Intersections<'a> {
    pub fn new(face: &'a Face, torses: &BTreeMap<u32, &'a Torse>) -> Self {
        let heights = torses.iter().filter_map(|(&l, t)| Some((l, Height::of(t)?))).collect();
        Self { face, heights, known: BTreeMap::new(), vertices: BTreeMap::new() }
    }

    /// The same with edges that are known, which need not cross at any angle, and the points in which those of three
    /// labels end.
    pub fn with_known_edges(mut self, edges: Vec<([u32; 2], Curve<3>)>, vertices: Vec<(Vec<u32>, Vec3)>) -> Self {
        self.known = edges.into_iter().map(|(labels, curve)| (pair(labels), KnownEdge::new(curve))).collect();
        self.vertices = vertices.into_iter().collect();
        self
    }

    /// Largest difference (mm) of the heights of two strips at a vertex of their border; `None` where there is no border, or a strip
    /// has no height.
    pub fn largest_gap(&self, cover: &Cover) -> Option<f64> {
        let borders = cover.borders();
        let gaps = borders.seam_chains().into_iter().map(|c| self.gap(&borders, &c, cover));
        gaps.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
    }

    /// The same along one border.
    fn gap(&self, borders: &Borders, chain: &SeamChain, cover: &Cover) -> Option<f64> {
        let strips = self.pair(borders, chain.labels)?;
        let at = |v: &u32| strips.difference(cover.partition.vertices[*v as usize]).map(f64::abs);
        chain.vertices.iter().map(at).try_fold(0.0_f64, |most, gap| Some(most.max(gap?)))
    }

    /// Whether a border lies where two strips are equally high already.
    fn is_level(&self, borders: &Borders, chain: &SeamChain, cover: &Cover) -> bool {
        self.gap(borders, chain, cover).is_some_and(|gap| gap <= EDGE.1 * chain.length)
    }

    /// Whether two strips are parts of one torse, which do not intersect: any border between them is an edge of both.
    fn is_one_torse(&self, [a, b]: [u32; 2]) -> bool {
        let [a, b] = [a, b].map(|l| self.heights.get(&l));
        a.zip(b).is_some_and(|(a, b)| a.is_of_the_torse_of(b))
    }

    /// The vertices in which borders end inside the face, with the point that their labels have in common.
    fn common_points(&self, chains: &[SeamChain]) -> BTreeMap<u32, Vec3> {
        let mut labels: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for c in chains {
            for &v in c.vertices.first().into_iter().chain(c.vertices.last()) {
                labels.entry(v).or_default().extend(c.labels);
            }
        }
        let point = |(v, l): (u32, BTreeSet<u32>)| Some((v, *self.vertices.get(&l.into_iter().collect::<Vec<_>>())?));
        labels.into_iter().filter_map(point).collect()
    }

    /// The cover with the vertices in which borders end inside the face under the points that their labels have in common;
    /// others make way. Vertices that cannot go there stay where they get to.
    pub fn with_vertices(&self, cover: &Cover) -> Cover {
        let borders = cover.borders();
        let surface = &self.face.surface;
        let mut partition = cover.partition.clone();
        let lines = [surface.knots_u.breaks(), surface.knots_v.breaks()];
        let points = self.common_points(&borders.seam_chains());
        for (v, x) in points {
            let Some(target) = self.under(&x, partition.vertices[v as usize], &borders) else { continue };
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
        cover.with_partition(partition)
    }

    /// Parameters of the place on the face whose normal goes through a point.
    fn under(&self, x: &Vec3, mut p: [f64; 2], borders: &Borders) -> Option<[f64; 2]> {
        for _ in 0..STEPS {
            let j = self.face.surface.jet(p[0], p[1]);
            let n = borders.normal(p).try_normalize(0.0)?;
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
        let ((u0, u1), (v0, v1)) = self.face.surface.domain();
        ((u0..=u1).contains(&p[0]) && (v0..=v1).contains(&p[1])).then_some(p)
    }

    /// The cover with the borders between pairs of labels about where their strips intersect; second result: the pairs
    /// whose borders were moved.
    pub fn cut(&self, cover: &Cover, pairs: &[[u32; 2]]) -> (Cover, Vec<[u32; 2]>) {
        let mut now = cover.clone();
        let (mut moved, mut left) = (Vec::new(), pairs.to_vec());
        // Where a border must wait until the next one has made room it is tried again.
        loop {
            let partition = now.partition.clone();
            let borders = borders_of(self.face, &partition);
            let chains = whole_borders(borders.seam_chains());
            let before = left.len();
            left.retain(|&p| {
                let of: Vec<&SeamChain> = chains.iter().filter(|c| pair(c.labels) == p).collect();
                let lies_there = of.len() > 1 || self.is_one_torse(p);
                if lies_there && of.iter().all(|c| self.is_level(&borders, c, &now)) {
                    // As around a hole it has several parts, or it parts one torse, and lies where it should.
                    moved.push(p);
                    return false;
                }
                let [chain] = of[..] else { return true };
                let next = self.pair(&borders, chain.labels).and_then(|strips| strips.cut(&now, chain));
                let Some(next) = next else { return true };
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
    pub fn settled(&self, cover: &Cover, pairs: &[[u32; 2]]) -> Cover {
        let borders = cover.borders();
        let chains = borders.seam_chains();
        let (along, strips): (Vec<&SeamChain>, Vec<Pair>) = chains
            .iter()
            .filter(|c| pairs.contains(&pair(c.labels)))
            .filter_map(|c| Some((c, self.pair(&borders, c.labels)?)))
            .unzip();
        let mut partition = cover.partition.clone();
        let staying = settle(self.face, &mut partition, &along, |k, p, fixed| strips[k].onto(p, fixed));
        for chain in along {
            for corner in chain.vertices.windows(3).filter(|w| staying.contains(&w[1])) {
                let is_cut_off = |t: &[u32; 3]| corner.iter().all(|v| t.contains(v));
                let Some(t) = partition.triangles.iter().position(is_cut_off) else { continue };
                let [a, b] = chain.labels;
                partition.labels[t] = if partition.labels[t] == a { b } else { a };
            }
        }
        cover.with_partition(partition)
    }

    /// Edges of these borders, and the pairs for which there is none.
    pub fn edges(&self, cover: &Cover, borders: &Borders, pairs: &[[u32; 2]]) -> (Vec<SharedSeam>, Vec<[u32; 2]>) {
        self.edges_through(&self.common_points(&borders.seam_chains()), cover, borders, pairs)
    }

    /// The same, with the points in which edges must end at vertices.
    pub fn edges_through(
        &self,
        points: &BTreeMap<u32, Vec3>,
        cover: &Cover,
        borders: &Borders,
        pairs: &[[u32; 2]],
    ) -> (Vec<SharedSeam>, Vec<[u32; 2]>) {
        let chains = borders.seam_chains();
        let (mut edges, mut spoilt) = (Vec::new(), Vec::new());
        let mut ends =
            Ends { points: HashMap::default(), reach: EDGE.1 * chains.iter().map(|c| c.length).fold(0.0, f64::max) };
        let mut pairs: Vec<(bool, [u32; 2])> = pairs.iter().map(|p| (self.known.contains_key(p), *p)).collect();
        pairs.sort_by_key(|p| !p.0);
        for (is_known, p) in pairs {
            let mut edge = |c: &SeamChain| {
                let strips = self.pair(borders, c.labels)?;
                let Some(known) = strips.known else { return strips.edge(cover, c, &mut ends) };
                let edge = strips.known_edge(known, cover, c, points)?;
                for (v, x) in
                    [(c.vertices.first(), edge.edge.control.first()), (c.vertices.last(), edge.edge.control.last())]
                {
                    ends.points.insert(*v?, Vec3::from(*x?));
                }
                Some(edge)
            };
            // A border with corners has several chains, one around a hole too.
            let parts = chains.iter().filter(|c| pair(c.labels) == p).map(&mut edge);
            match parts.collect::<Option<Vec<SharedSeam>>>().filter(|parts| is_known || !parts.is_empty()) {
                Some(parts) => edges.extend(parts),
                None => spoilt.push(p),
            }
        }
        (edges, spoilt)
    }

    fn pair<'b>(&'b self, borders: &'b Borders<'b>, labels: [u32; 2]) -> Option<Pair<'b>> {
        let [a, b] = labels.map(|l| self.heights.get(&l));
        Some(Pair { face: self.face, borders, heights: [a?, b?], known: self.known.get(&pair(labels)) })
    }
}

/// Points in which edges end, by vertex.
struct Ends {
    points: HashMap<u32, Vec3>,
    /// Edges that would end within this distance (mm) of such a point end in it: edges on two strips are within that of both.
    reach: f64,
}

/// Two strips beside a border.
struct Pair<'a> {
    face: &'a Face,
    borders: &'a Borders<'a>,
    heights: [&'a Height<'a>; 2],
    known: Option<&'a KnownEdge>,
}

impl Pair<'_> {
    /// Point of the face, unit normal, heights of both strips (mm).
    fn at(&self, p: [f64; 2]) -> Option<(Vec3, Vec3, [f64; 2])> {
        let x = self.face.surface.point(p[0], p[1]);
        let n = self.borders.normal(p).try_normalize(0.0)?;
        Some((x, n, [self.heights[0].at(&x, &n)?, self.heights[1].at(&x, &n)?]))
    }

    /// First height less second, mm; how far the edge is to the right where it is known.
    fn difference(&self, p: [f64; 2]) -> Option<f64> {
        if let Some(known) = self.known {
            let x = self.face.surface.point(p[0], p[1]);
            return known.beside(&x, &self.borders.normal(p).try_normalize(0.0)?).map(|b| b.1);
        }
        self.at(p).map(|(_, _, [a, b])| a - b)
    }

    /// Derivatives of the difference by the parameters, as differences; zero for fixed parameters.
    fn slope(&self, p: [f64; 2], fixed: [bool; 2]) -> Option<[f64; 2]> {
        // Share of the domain: small against the mesh, large against rounding.
        const STEP: f64 = 1e-5;
        let (du, dv) = self.face.surface.domain();
        let mut slope = [0.0; 2];
        for (d, (lo, hi)) in [du, dv].into_iter().enumerate().filter(|(d, _)| !fixed[*d]) {
            let (mut a, mut b) = (p, p);
            a[d] = (p[d] - STEP * (hi - lo)).max(lo);
            b[d] = (p[d] + STEP * (hi - lo)).min(hi);
            slope[d] = (self.difference(b)? - self.difference(a)?) / (b[d] - a[d]);
        }
        Some(slope)
    }

    /// The difference (mm), and how it grows with the way to the left of the direction `tangent`.
    fn across(&self, p: [f64; 2], tangent: &Vec3) -> Option<[f64; 2]> {
        let slope = self.slope(p, [false; 2])?;
        let j = self.face.surface.jet(p[0], p[1]);
        let left = j.normal().cross(tangent).try_normalize(0.0)?;
        // Parameters of the way: S_u du + S_v dv = left.
        let (uu, uv, vv) = (j.du.dot(&j.du), j.du.dot(&j.dv), j.dv.dot(&j.dv));
        let (a, b) = (j.du.dot(&left), j.dv.dot(&left));
        let det = uu * vv - uv * uv;
        let (du, dv) = ((a * vv - b * uv) / det, (b * uu - a * uv) / det);
        Some([self.difference(p)?, slope[0] * du + slope[1] * dv]).filter(|s| s[1].is_finite())
    }

    /// The place near `p` where both heights are equal, by Newton steps; fixed parameters stay.
    fn onto(&self, mut p: [f64; 2], fixed: [bool; 2]) -> Option<[f64; 2]> {
        const SETTLED: f64 = 1e-13;
        let (du, dv) = self.face.surface.domain();
        let size = [du, dv].map(|(lo, hi)| hi - lo);
        for _ in 0..STEPS {
            let g = self.difference(p)?;
            let slope = self.slope(p, fixed)?;
            // The shortest way in shares of the domain.
            let square = (slope[0] * size[0]).powi(2) + (slope[1] * size[1]).powi(2);
            let step = [0, 1].map(|d: usize| -g * slope[d] * size[d] * size[d] / square);
            if !step.iter().all(|s| s.is_finite()) {
                return None;
            }
            p = [(p[0] + step[0]).clamp(du.0, du.1), (p[1] + step[1]).clamp(dv.0, dv.1)];
            if (step[0] / size[0]).hypot(step[1] / size[1]) <= SETTLED {
                break;
            }
        }
        Some(p)
    }

    /// The cover with the regions beside a border cut where the strips intersect. `None` where they cross at too small an
    /// angle or too far away, or regions would come out in pieces.
    fn cut(&self, cover: &Cover, chain: &SeamChain) -> Option<Cover> {
        let labels = chain.labels;
        let line = &chain.vertices;
        let last = line.len() - 1;
        let at = |v: u32| cover.partition.vertices[v as usize];
        let place = |v: u32| cover.point(v);
        // 1. Ways from the border to the intersection, positive towards the first label, which is on the left.
        let across: Vec<[f64; 2]> = parallel::map(0..=last, |i| {
            let tangent = place(line[(i + 1).min(last)]) - place(line[i.saturating_sub(1)]);
            self.across(at(line[i]), &tangent)
        })
        .into_iter()
        .collect::<Option<_>>()?;
        let sign = across[last / 2][1].signum();
        let ways: Vec<f64> = across.iter().map(|[difference, slope]| -difference / slope).collect();
        let reach = if self.known.is_some() { REACH.1 } else { REACH.0 };
        let most = labels.map(|l| reach * cover.region(l).area() / chain.length);
        let crossing = across.iter().all(|[_, slope]| slope * sign > LEAST_ANGLE);
        if !crossing || ways.iter().any(|w| w.abs() > most[usize::from(*w < 0.0)]) {
            return None;
        }
        let reach: Vec<f64> = (0..=last)
            .map(|i| {
                ways[i.saturating_sub(BESIDE)..=(i + BESIDE).min(last)].iter().fold(0.0, |m: f64, w| m.max(w.abs()))
            })
            .collect();
        // 2. Vertices near the border know their side; all others keep it.
        let on_line: HashSet<u32> = line.iter().copied().collect();
        let triangles = || cover.partition.triangles.iter();
        let beside: HashSet<u32> =
            triangles().filter(|t| t.iter().any(|v| on_line.contains(v))).flatten().copied().collect();
        let vertices: Vec<(u32, f64)> = [(labels[0], 1.0), (labels[1], -1.0)]
            .into_iter()
            .flat_map(|(l, side)| cover.region(l).vertices().into_iter().map(move |v| (v, side)))
            .collect();
        let asked: Vec<(u32, f64, Option<f64>)> = parallel::map(vertices.iter(), |&(v, side)| {
            let near = |i: usize| (place(line[i]) - place(v)).norm() <= ASKED * reach[i];
            let is_asked = beside.contains(&v) || (0..=last).any(near);
            (v, side, if is_asked { self.difference(at(v)) } else { None })
        });
        // 3. The cut.
        let bits = |p: [f64; 2]| p.map(f64::to_bits);
        let known: HashMap<[u64; 2], f64> =
            asked.iter().map(|&(v, side, found)| (bits(at(v)), -found.map_or(side, |d| sign * d))).collect();
        let value = |p: [f64; 2]| known.get(&bits(p)).copied().or_else(|| Some(-sign * self.difference(p)?));
        let mut out = cover.region(labels[1]).joined_to(labels[0]);
        out.cut(labels[0], labels[1], |p| value(p).unwrap_or(0.0));
        let single = |l: &u32| out.partition.components(&out.region(*l).cells(), |_, _| true).len() == 1;
        let far: HashMap<u32, f64> = asked.iter().filter(|a| a.2.is_none()).map(|a| (a.0, a.1)).collect();
        let keeps = |(t, l): (&[u32; 3], &u32)| {
            let side = if *l == labels[0] { 1.0 } else { -1.0 };
            !labels.contains(l) || t.iter().all(|v| far.get(v).is_none_or(|s| *s == side))
        };
        let kept = out.partition.triangles.iter().zip(&out.partition.labels).all(keeps);
        (kept && labels.iter().all(single)).then_some(out)
    }

    /// The curve in space along which the strips intersect, over a border whose vertices lie there. Inside, places are
    /// looked for anew: vertices on crossings of knot lines cannot be moved; the border between parts of one torse lies anywhere on
    /// it. Edges that end in one vertex end in one point, of those in `ends`, which grow.
    fn edge(&self, cover: &Cover, chain: &SeamChain, ends: &mut Ends) -> Option<SharedSeam> {
        let line = &chain.vertices;
        let at = |v: u32| cover.partition.vertices[v as usize];
        let lifted = |p: [f64; 2]| self.at(p).map(|(x, n, [a, b])| x + n * (0.5 * (a + b)));
        let parts = PLACES.0.max(PLACES.1 / line.len());
        let count = parts * (line.len() - 1);
        let places: Vec<[f64; 2]> = (0..=count)
            .map(|i| {
                let (k, share) = (i / parts, (i % parts) as f64 / parts as f64);
                let (p, q) = (at(line[k]), at(line[(k + 1).min(line.len() - 1)]));
                [0, 1].map(|d: usize| p[d] + (q[d] - p[d]) * share)
            })
            .collect();
        let is_one_torse = self.heights[0].is_of_the_torse_of(self.heights[1]);
        let places = if is_one_torse { self.smoothed(places, chain.length)? } else { places };
        let mut points: Vec<[f64; 3]> = parallel::map(places.into_iter().enumerate(), |(i, here)| {
            let stays = is_one_torse || i == 0 || i == count;
            lifted(if stays { here } else { self.onto(here, [false; 2])? }).map(Into::into)
        })
        .into_iter()
        .collect::<Option<_>>()?;
        for (v, is_last) in [(*line.first()?, false), (*line.last()?, true)] {
            let at = if is_last { count } else { 0 };
            let here = Vec3::from(points[at]);
            let end = *ends.points.entry(v).or_insert(here);
            let off = end - here;
            if off.norm() <= ends.reach {
                let way = |i: usize| (if is_last { count - i } else { i }) as f64 / count as f64;
                for (i, x) in points.iter_mut().enumerate() {
                    *x = (Vec3::from(*x) + off * turning(way(i))).into();
                }
                points[at] = end.into();
            }
        }
        let parameters = lsq::chord_parameters(&points);
        let fit = lsq::fit_within(&points, &parameters, CURVE.0, EDGE.0 * chain.length, CURVE.1).ok()?;
        let parameters = parameters.into_iter().step_by(parts).collect();
        let edge = SharedSeam { chain: chain.chain, labels: chain.labels, edge: fit.curve, parameters };
        (fit.error <= EDGE.1 * chain.length).then_some(edge)
    }
}

impl Pair<'_> {
    /// Places along a border of this length (mm) on a smooth line beside it: the border has the corners of the triangulation.
    fn smoothed(&self, mut places: Vec<[f64; 2]>, length: f64) -> Option<Vec<[f64; 2]>> {
        let [u, v] = *places.get(places.len() / 2)?;
        let jet = self.face.surface.jet(u, v);
        let scale = [jet.du.norm(), jet.dv.norm()];
        let scaled: Vec<[f64; 2]> = places.iter().map(|p| [p[0] * scale[0], p[1] * scale[1]]).collect();
        let parameters = lsq::chord_parameters(&scaled);
        let fit = lsq::fit_within(&scaled, &parameters, CURVE.0, SMOOTH.0 * length, SMOOTH.2).ok()?;
        if fit.error > SMOOTH.1 * length {
            return Some(places);
        }
        let line = fit.curve;
        let last = places.len() - 1;
        for (p, s) in places[1..last].iter_mut().zip(&parameters[1..last]) {
            let x = line.point(*s);
            *p = [x[0] / scale[0], x[1] / scale[1]];
        }
        places.iter().flatten().all(|x| x.is_finite()).then_some(places)
    }

    /// The part of a known edge over a border, from and to the points in common.
    fn known_edge(
        &self,
        known: &KnownEdge,
        cover: &Cover,
        chain: &SeamChain,
        points: &BTreeMap<u32, Vec3>,
    ) -> Option<SharedSeam> {
        let beside = |&v: &u32| {
            let p = cover.partition.vertices[v as usize];
            let n = self.borders.normal(p).try_normalize(0.0)?;
            known.beside(&self.face.surface.point(p[0], p[1]), &n).map(|b| b.0)
        };
        let s: Vec<f64> = chain.vertices.iter().map(beside).collect::<Option<_>>()?;
        let forward = s.last()? > s.first()?;
        if s.windows(2).any(|w| (w[0] < w[1]) != forward || w[0] == w[1]) {
            return None;
        }
        // Anew over [0, 1] with knots that are mirrored without rounding.
        let (edges, parts) = (s.len() - 1, PLACES.0.max(PLACES.1 / s.len()));
        let at = |i: usize| {
            let (k, share) = (i / parts, (i % parts) as f64 / parts as f64);
            s[k] + (s[(k + 1).min(edges)] - s[k]) * share
        };
        let mut places: Vec<[f64; 3]> = (0..=parts * edges).map(|i| known.curve.point(at(i))).collect();
        let last = places.len() - 1;
        for (i, v) in [(0, chain.vertices.first()?), (last, chain.vertices.last()?)] {
            let Some(x) = points.get(v) else { continue };
            if (x - Vec3::from(places[i])).norm() > COMMON * chain.length {
                return None;
            }
            places[i] = (*x).into();
        }
        let parameters = lsq::chord_parameters(&places);
        let edge = lsq::fit_within(&places, &parameters, CURVE.0, EDGE.0 * chain.length, CURVE.1).ok()?.curve;
        let parameters = parameters.into_iter().step_by(parts).collect();
        Some(SharedSeam { chain: chain.chain, labels: chain.labels, edge, parameters })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::curve::Curve;
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
        let intersections = Intersections::new(&face, &torses);
        let (cut, moved) = intersections.cut(&cover, &[[0, 1]]);
        assert_eq!(moved, [[0, 1]]);
        let settled = intersections.settled(&cut, &moved);
        assert!((settled.region(0).area() - 5500.0).abs() < 1e-6 && (settled.region(1).area() - 4500.0).abs() < 1e-6);
        let borders = settled.borders();
        let (edges, spoilt) = intersections.edges(&settled, &borders, &moved);
        assert!(edges.len() == 1 && spoilt.is_empty());
        for k in 0..=10 {
            let [x, y, z] = edges[0].edge.point(f64::from(k) / 10.0);
            assert!((x - 53.0 - y / 25.0).abs() < 1e-9 && z.abs() < 1e-9, "({x}, {y}, {z})");
        }
        for (s, &v) in edges[0].parameters.iter().zip(&borders.seam_chains()[0].vertices) {
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
            let (same, moved) = Intersections::new(&face, &torses).cut(&cover, &[[0, 1]]);
            assert!(moved.is_empty());
            assert_eq!(same.partition.labels, cover.partition.labels);
        }
    }
}
