//! Two strips beside a border: how much higher one is than the other over the face, the border cut to where they intersect, and the
//! edge there. Nothing is judged here.
//!
//! *Method*: both strips as heights over the face [`Height`]; regions are cut where the difference of heights vanishes,
//! which lies by difference over slope beside the border to first order. Ill posed where strips hardly cross
//! (parabolic lines).

use super::known_edge::{KnownEdge, STEPS};
use super::seams::SharedSeam;
use crate::fit::height::Height;
use crate::fit::panels::boundary::{Borders, SeamChain};
use crate::geom::Vec3;
use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;
use crate::search::cover::Cover;
use crate::search::joint::turning;
use crate::spline::curve::Curve;
use crate::spline::lsq;
use std::collections::BTreeMap;

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
/// Distance (share of the edge's length) of the point in which edges end from each.
const COMMON: f64 = 1e-6;

/// Points in which edges end, by vertex.
pub(super) struct EdgeEnds<'a> {
    /// Those in which edges that are known must end.
    given: &'a BTreeMap<u32, Vec3>,
    /// Those of the edges that have been found.
    found: HashMap<u32, Vec3>,
    /// Edges that would end within this distance (mm) of such a point end in it: edges on two strips are within that of both.
    reach: f64,
}

impl<'a> EdgeEnds<'a> {
    /// None are found yet, along these borders.
    pub fn new(given: &'a BTreeMap<u32, Vec3>, chains: &[SeamChain]) -> Self {
        let longest = chains.iter().map(|c| c.length).fold(0.0, f64::max);
        Self { given, found: HashMap::default(), reach: EDGE.1 * longest }
    }
}

/// Two strips beside a border.
pub(super) struct StripPair<'a> {
    /// The cover whose border it is.
    pub cover: &'a Cover,
    /// All its borders.
    pub borders: &'a Borders<'a>,
    /// The border.
    pub chain: &'a SeamChain,
    /// Heights of the strips on its left and on its right.
    pub heights: [&'a Height<'a>; 2],
    /// Their edge, where it is known.
    pub known: Option<&'a KnownEdge>,
}

impl StripPair<'_> {
    /// Largest difference (mm) of the heights at a vertex of the border.
    pub fn gap(&self) -> Option<f64> {
        let at = |v: &u32| self.difference(self.place(*v)).map(f64::abs);
        self.chain.vertices.iter().map(at).try_fold(0.0_f64, |most, gap| Some(most.max(gap?)))
    }

    /// Parameters of a vertex.
    fn place(&self, v: u32) -> [f64; 2] {
        self.cover.partition.vertices[v as usize]
    }

    /// Point of the face, unit normal, heights of both strips (mm).
    fn at(&self, p: [f64; 2]) -> Option<(Vec3, Vec3, [f64; 2])> {
        let x = self.cover.face.surface.point(p[0], p[1]);
        let n = self.borders.normal(p).try_normalize(0.0)?;
        Some((x, n, [self.heights[0].at(&x, &n)?, self.heights[1].at(&x, &n)?]))
    }

    /// First height less second, mm; how far the edge is to the right where it is known.
    fn difference(&self, p: [f64; 2]) -> Option<f64> {
        if let Some(known) = self.known {
            let x = self.cover.face.surface.point(p[0], p[1]);
            return known.beside(&x, &self.borders.normal(p).try_normalize(0.0)?).map(|b| b.1);
        }
        self.at(p).map(|(_, _, [a, b])| a - b)
    }

    /// Derivatives of the difference by the parameters, as differences; zero for fixed parameters.
    fn slope(&self, p: [f64; 2], fixed: [bool; 2]) -> Option<[f64; 2]> {
        // Share of the domain: small against the mesh, large against rounding.
        const STEP: f64 = 1e-5;
        let (du, dv) = self.cover.face.surface.domain();
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
        let j = self.cover.face.surface.jet(p[0], p[1]);
        let left = j.normal().cross(tangent).try_normalize(0.0)?;
        // Parameters of the way: S_u du + S_v dv = left.
        let (uu, uv, vv) = (j.du.dot(&j.du), j.du.dot(&j.dv), j.dv.dot(&j.dv));
        let (a, b) = (j.du.dot(&left), j.dv.dot(&left));
        let det = uu * vv - uv * uv;
        let (du, dv) = ((a * vv - b * uv) / det, (b * uu - a * uv) / det);
        Some([self.difference(p)?, slope[0] * du + slope[1] * dv]).filter(|s| s[1].is_finite())
    }

    /// The place near `p` where both heights are equal, by Newton steps; fixed parameters stay.
    pub fn onto(&self, mut p: [f64; 2], fixed: [bool; 2]) -> Option<[f64; 2]> {
        const SETTLED: f64 = 1e-13;
        let (du, dv) = self.cover.face.surface.domain();
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

    /// The cover, some of whose other regions may have been cut since its borders were traced, with those beside this border cut
    /// where the strips intersect. `None` where they cross at too small an angle or too far away, or regions would come out in
    /// pieces.
    pub fn cut(&self, cover: &Cover) -> Option<Cover> {
        let labels = self.chain.labels;
        let line = &self.chain.vertices;
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
        let most = labels.map(|l| reach * cover.region(l).area() / self.chain.length);
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

    /// The edge over the border, whose vertices lie under it: the part of a known one, or where the strips intersect.
    pub fn edge(&self, ends: &mut EdgeEnds) -> Option<SharedSeam> {
        let Some(known) = self.known else { return self.intersection(ends) };
        let found = self.known_part(known, ends.given)?;
        let (first, last) = (self.chain.vertices.first(), self.chain.vertices.last());
        for (v, x) in [(first, found.edge.control.first()), (last, found.edge.control.last())] {
            ends.found.insert(*v?, Vec3::from(*x?));
        }
        Some(found)
    }

    /// The curve in space along which the strips intersect, over a border whose vertices lie there. Inside, places are
    /// looked for anew: vertices on crossings of knot lines cannot be moved; the border between parts of one torse lies anywhere on
    /// it. Edges that end in one vertex end in one point, of those in `ends`, which grow.
    fn intersection(&self, ends: &mut EdgeEnds) -> Option<SharedSeam> {
        let line = &self.chain.vertices;
        let lifted = |p: [f64; 2]| self.at(p).map(|(x, n, [a, b])| x + n * (0.5 * (a + b)));
        let parts = PLACES.0.max(PLACES.1 / line.len());
        let count = parts * (line.len() - 1);
        let places: Vec<[f64; 2]> = (0..=count)
            .map(|i| {
                let (k, share) = (i / parts, (i % parts) as f64 / parts as f64);
                let (p, q) = (self.place(line[k]), self.place(line[(k + 1).min(line.len() - 1)]));
                [0, 1].map(|d: usize| p[d] + (q[d] - p[d]) * share)
            })
            .collect();
        let is_one_torse = self.heights[0].is_of_the_torse_of(self.heights[1]);
        let places = if is_one_torse { self.smoothed(places)? } else { places };
        let mut points: Vec<[f64; 3]> = parallel::map(places.into_iter().enumerate(), |(i, here)| {
            let stays = is_one_torse || i == 0 || i == count;
            lifted(if stays { here } else { self.onto(here, [false; 2])? }).map(Into::into)
        })
        .into_iter()
        .collect::<Option<_>>()?;
        for (v, is_last) in [(*line.first()?, false), (*line.last()?, true)] {
            let at = if is_last { count } else { 0 };
            let here = Vec3::from(points[at]);
            let end = *ends.found.entry(v).or_insert(here);
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
        let fit = lsq::fit_within(&points, &parameters, CURVE.0, EDGE.0 * self.chain.length, CURVE.1).ok()?;
        let parameters = parameters.into_iter().step_by(parts).collect();
        (fit.error <= EDGE.1 * self.chain.length).then(|| self.shared(fit.curve, parameters))
    }

    /// Places along the border on a smooth line beside it: the border has the corners of the triangulation.
    fn smoothed(&self, mut places: Vec<[f64; 2]>) -> Option<Vec<[f64; 2]>> {
        let [u, v] = *places.get(places.len() / 2)?;
        let jet = self.cover.face.surface.jet(u, v);
        let scale = [jet.du.norm(), jet.dv.norm()];
        let scaled: Vec<[f64; 2]> = places.iter().map(|p| [p[0] * scale[0], p[1] * scale[1]]).collect();
        let parameters = lsq::chord_parameters(&scaled);
        let fit = lsq::fit_within(&scaled, &parameters, CURVE.0, SMOOTH.0 * self.chain.length, SMOOTH.2).ok()?;
        if fit.error > SMOOTH.1 * self.chain.length {
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

    /// The part of a known edge over the border, from and to the points that are given.
    fn known_part(&self, known: &KnownEdge, points: &BTreeMap<u32, Vec3>) -> Option<SharedSeam> {
        let (chain, surface) = (self.chain, &self.cover.face.surface);
        let beside = |&v: &u32| {
            let p = self.place(v);
            let n = self.borders.normal(p).try_normalize(0.0)?;
            known.beside(&surface.point(p[0], p[1]), &n).map(|b| b.0)
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
        Some(self.shared(edge, parameters))
    }

    fn shared(&self, edge: Curve<3>, parameters: Vec<f64>) -> SharedSeam {
        SharedSeam { chain: self.chain.chain, labels: self.chain.labels, edge, parameters }
    }
}
