//! How far the file's boundary of a face is from the polygon that trims it: the judge of what was read.
//!
//! *Method.* Every side of the polygon follows a stretch of one of the file's edges, as the reader says. Side and stretch
//! are compared at equal places, `D(x) = C(t(x)) − S(p(x))`, with `p` linear in the parameter plane and `t` quadratic, so
//! that both run at the same speed: the chord between the enclosed ends, and what the enclosed derivatives allow beside
//! it \[certificate, 6\]. Both curves are polynomials in Bernstein form on every piece, computed with intervals
//! \[R89, MKC09\]. Pieces that may be worse than the worst place seen are halved. What no side follows (edges that were
//! dropped, ends that were cut off) is compared with the corner where it is missing.
//! *Guarantee.* Run round both boundaries at once: corresponding points are within the bound of each other all the way,
//! so that the face of the file and the region of the polygons differ by points within the bound of both boundaries
//! (docs/algorithms/reading.md says when). *Not guaranteed*: that the bound is small.

use super::claim::UpperBound;
use super::vector::{length_bound, V3};
use crate::brep::face::{Face, FileBoundary, FileEdge, FilePiece};
use crate::geom::Vec3;
use crate::num::bernstein::{from_spline_over, Scalar};
use crate::num::binomial::binomial;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// What was proven of the trim of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimProof {
    /// Bound (mm) of the distance between the face of the file and the region of the polygons; infinite if none was
    /// shown.
    bound: f64,
    /// Number of the file's edge where the bound is reached; 0 if there is none.
    edge: u64,
}

impl TrimProof {
    /// Bound (mm) of the distance between the face of the file and the region of the polygons.
    pub fn bound(&self) -> UpperBound {
        UpperBound::shown(self.bound)
    }

    /// Number of the file's edge where the bound is reached; 0 if there is none.
    pub fn edge(&self) -> u64 {
        self.edge
    }
}

/// Pieces are halved until their enclosures exceed the greatest distance seen by less than this share of it.
const EXCESS: f64 = 0.1;
/// Halvings of a piece at most; a knot cut off beside leaves long pieces to be halved.
const DEPTH: u32 = 24;
/// Pieces of one edge at most: an edge that needs more is not worth the time.
const MOST_PIECES: usize = 40_000;
/// Share of the coordinates by which stored splines may miss the curves of the file: conics are converted, closed splines
/// unrolled, places on knot lines rounded, each with some units in the last place.
const STORED: f64 = 1e-13;
/// Largest bend of the correspondence `t(x) = x + κ x(1 − x)`: below 1 it stays monotone.
const MOST_BEND: f64 = 0.9;

/// Bound of the distance between the face as its file has it and the region of its polygons: what these miss of its edges, and
/// what its surface is off. Distances below `aim` (mm) are not told apart.
pub fn trim_proof(face: &Face, aim: f64) -> TrimProof {
    let Some(boundary) = &face.boundary else {
        return TrimProof { bound: face.trim_bound().max(face.surface_bound()), edge: 0 };
    };
    let mut out = TrimProof { bound: 0.0, edge: 0 };
    let size = face.surface.control.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let stored = STORED * size;
    let judge = Judge { face, boundary, aim };
    for l in &boundary.loops {
        for (k, edge) in l.iter().enumerate() {
            let bound = judge.edge(l, k, out.bound.max(aim)) + stored;
            // NaN is no bound.
            let bound = if bound.is_nan() { f64::INFINITY } else { bound };
            if bound > out.bound {
                out = TrimProof { bound, edge: edge.entity };
            }
        }
    }
    if boundary.along.len() != face.loops.len() || boundary.loops.is_empty() {
        out.bound = f64::INFINITY;
    }
    // Edges are compared on the surface that was read.
    let off = face.surface_bound();
    if off != 0.0 {
        out.bound = (out.bound + off).next_up();
    }
    out
}

struct Judge<'a> {
    face: &'a Face,
    boundary: &'a FileBoundary,
    aim: f64,
}

/// A side of the polygon and the places along its edge where it begins and ends.
#[derive(Clone, Copy)]
struct Side {
    corners: [[f64; 2]; 2],
    along: [f64; 2],
}

/// A polynomial piece of an edge, by places.
struct Element<'a> {
    curve: &'a Curve<4>,
    span: usize,
    /// Parameters where it begins and ends, in the direction of the loop.
    ends: [f64; 2],
    /// Places of these.
    places: [f64; 2],
}

impl Element<'_> {
    /// The parameter at a place.
    fn parameter(&self, place: f64) -> f64 {
        let share = (place - self.places[0]) / (self.places[1] - self.places[0]);
        self.ends[0] + share.clamp(0.0, 1.0) * (self.ends[1] - self.ends[0])
    }
}

impl Judge<'_> {
    /// Bound along edge `k` of a loop of the file; `seen` is a distance that is known to be reached, or does not matter.
    fn edge(&self, l: &[FileEdge], k: usize, seen: f64) -> f64 {
        let edge = &l[k];
        let sides = self.sides(edge.label);
        let Some(elements) = elements(edge) else { return f64::INFINITY };
        let Some(last) = elements.last() else { return f64::INFINITY };
        let mut bound = 0.0_f64;
        let mut queue: Vec<ChordPart> = Vec::new();
        // 1. What sides follow.
        for s in &sides {
            queue.extend(self.pieces(s, &elements));
        }
        bound = bound.max(self.refined(queue, &elements, seen));
        // 2. What none follows.
        let mut covered: Vec<&Side> = sides.iter().collect();
        covered.sort_by(|a, b| a.along[0].min(a.along[1]).total_cmp(&b.along[0].min(b.along[1])));
        let mut reached = elements[0].places[0];
        let mut corner = covered.first().map(|s| s.corners[usize::from(s.along[0] > s.along[1])]);
        for s in covered {
            let turned = s.along[0] > s.along[1];
            let (lo, hi) = (s.along[usize::from(turned)], s.along[usize::from(!turned)]);
            let (before, after) = (s.corners[usize::from(turned)], s.corners[usize::from(!turned)]);
            if lo > reached {
                bound = bound.max(self.missed(&elements, [reached, lo], before));
            }
            if hi >= reached {
                (reached, corner) = (hi, Some(after));
            }
        }
        let end = last.places[1];
        if reached < end || sides.is_empty() {
            let corner = corner.or_else(|| self.corner_before(l, k));
            bound = bound.max(match corner {
                Some(c) => self.missed(&elements, [reached.min(end), end], c),
                // A loop without a single side: what it bounds is no farther away than it is wide.
                None => self.width(l),
            });
        }
        bound
    }

    /// The sides of a label, in no particular order.
    fn sides(&self, label: u32) -> Vec<Side> {
        let mut out = Vec::new();
        for (l, along) in self.face.loops.iter().zip(&self.boundary.along) {
            let n = l.points.len();
            for i in (0..n).filter(|&i| l.edge[i] == label) {
                let corners = [l.points[i], l.points[(i + 1) % n]];
                out.push(Side { corners, along: along.get(i).copied().unwrap_or([0.0; 2]) });
            }
        }
        out
    }

    /// The corner where the nearest edge before `k` that has sides ends.
    fn corner_before(&self, l: &[FileEdge], k: usize) -> Option<[f64; 2]> {
        (1..l.len()).find_map(|back| {
            let sides = self.sides(l[(k + l.len() - back) % l.len()].label);
            let last = sides.iter().max_by(|a, b| a.along[1].max(a.along[0]).total_cmp(&b.along[1].max(b.along[0])))?;
            Some(last.corners[usize::from(last.along[1] >= last.along[0])])
        })
    }

    /// Bound of the distance between a corner and the stretch of an edge between two places. Control points are counted from
    /// the corner, since hulls of points and weights apart are as wide as weights differ; what that rounds counts.
    fn missed(&self, elements: &[Element], [from, to]: [f64; 2], corner: [f64; 2]) -> f64 {
        let (u, v) = (corner[0], corner[1]);
        let (origin, at) = (self.face.surface.point(u, v), self.face.surface.bounds((u, u), (v, v)));
        let mut bound = 0.0_f64;
        for e in elements.iter().filter(|e| e.places[0] <= to && e.places[1] >= from) {
            let from_origin = |h: &[f64; 4]| {
                let [x, y, z] = [0, 1, 2].map(|k: usize| h[k] - origin[k] * h[3]);
                [x, y, z, h[3]]
            };
            let curve =
                Curve { knots: e.curve.knots.clone(), control: e.curve.control.iter().map(from_origin).collect() };
            let h = curve.bounds(e.parameter(from), e.parameter(to));
            let d = [0, 1, 2].map(|k: usize| h[k] / h[3] - (at[k] - Interval::point(origin[k])));
            // A product and a difference, each by half a unit in the last place; twice for three coordinates.
            let size = |h: &[f64; 4]| (0..3).map(|k| h[k].abs() + (origin[k] * h[3]).abs()).fold(0.0, f64::max);
            let rounded = e.curve.control.iter().map(size).fold(0.0, f64::max) * (2.0 * f64::EPSILON);
            bound = bound.max((length_bound(&d) + rounded / h[3].lo).next_up());
        }
        bound
    }

    /// Diagonal of a box around a loop of the file.
    fn width(&self, l: &[FileEdge]) -> f64 {
        let mut hull: Option<V3<Interval>> = None;
        for e in l {
            let Some(elements) = elements(e) else { return f64::INFINITY };
            for e in &elements {
                let h = e.curve.bounds(e.ends[0], e.ends[1]);
                let x = [0, 1, 2].map(|k: usize| h[k] / h[3]);
                hull = Some(hull.map_or(x, |b| [0, 1, 2].map(|k: usize| b[k].hull(x[k]))));
            }
        }
        hull.map_or(f64::INFINITY, |b| length_bound(&b.map(|i| Interval { lo: 0.0, hi: i.width() })))
    }

    /// A side cut where the edge has knots and where the surface has.
    fn pieces(&self, side: &Side, elements: &[Element]) -> Vec<ChordPart> {
        let surface = &self.face.surface;
        let [a, b] = side.corners;
        let at = |s: f64| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
        // Shares of the side with what is exact there: a knot of the edge (place), or a knot of the surface.
        let mut cuts: Vec<(f64, Option<f64>, [f64; 2])> = Vec::new();
        let [from, to] = side.along;
        for e in elements {
            let place = e.places[1];
            if (place - from) * (place - to) < 0.0 {
                let x = point(e.curve, e.ends[1]).0;
                let guess = (place - from) / (to - from);
                cuts.push((foot_on_side(surface, side.corners, &x, guess), Some(place), [0.0; 2]));
            }
        }
        for (d, knots) in [&surface.knots_u, &surface.knots_v].into_iter().enumerate() {
            for k in knots.breaks() {
                if (k - a[d]) * (k - b[d]) < 0.0 {
                    let s = (k - a[d]) / (b[d] - a[d]);
                    let mut p = at(s);
                    p[d] = k;
                    cuts.push((s, None, p));
                }
            }
        }
        cuts.sort_by(|p, q| p.0.total_cmp(&q.0));
        // Places must not run back; feet are no better than the curve.
        let mut out = Vec::new();
        let (mut p, mut place) = (a, from);
        let mut ends: Vec<([f64; 2], f64)> = Vec::new();
        for (s, exact, q) in cuts {
            let q = if exact.is_some() { at(s) } else { q };
            let guess = from + s * (to - from);
            let there = exact.unwrap_or_else(|| place_near(elements, guess, &surface.point(q[0], q[1])));
            ends.push((q, there));
        }
        ends.push((b, to));
        let up = to >= from;
        for (q, there) in ends {
            let there = if up { there.clamp(place.min(to), to) } else { there.clamp(to, place.max(to)) };
            out.extend(across(elements, [p, q], [place, there]));
            (p, place) = (q, there);
        }
        out
    }

    /// The greatest distance on pieces, halved while they may hold more than was seen.
    fn refined(&self, mut open: Vec<ChordPart>, elements: &[Element], seen: f64) -> f64 {
        let (mut bound, mut seen, mut count) = (0.0_f64, seen, open.len());
        while let Some(p) = open.pop() {
            let Some(e) = elements.get(p.element) else { return f64::INFINITY };
            let (all, ends, middle) = self.piece(&p, e);
            seen = seen.max(ends);
            let good = all <= self.aim.max(seen * (1.0 + EXCESS));
            if good || p.depth == DEPTH || count > MOST_PIECES {
                if all.is_nan() {
                    return f64::INFINITY;
                }
                bound = bound.max(all);
                continue;
            }
            count += 1;
            let (m, t) = middle;
            open.push(ChordPart { corners: [p.corners[0], m], t: [p.t[0], t], depth: p.depth + 1, ..p });
            open.push(ChordPart { corners: [m, p.corners[1]], t: [t, p.t[1]], depth: p.depth + 1, ..p });
        }
        bound
    }

    /// Bounds of the distance over a piece and at its ends, and where to halve it.
    fn piece(&self, p: &ChordPart, e: &Element) -> (f64, f64, ([f64; 2], f64)) {
        let surface = &self.face.surface;
        let [a, b] = p.corners;
        let m = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let inner = [p.t[0] + APART * (p.t[1] - p.t[0]), p.t[1] - APART * (p.t[1] - p.t[0])];
        let t = nearest(e.curve, inner, 0.5 * (p.t[0] + p.t[1]), &surface.point(m[0], m[1]));
        let width = p.t[1] - p.t[0];
        let share = if width.abs() > 0.0 { (t - p.t[0]) / width } else { 0.5 };
        let bend = (4.0 * (share - 0.5)).clamp(-MOST_BEND, MOST_BEND);
        let centre = surface.point(a[0], a[1]);
        let c = on_curve(e.curve, e.span, p.t, &centre);
        let f = on_chord(surface, p.corners, &centre);
        let speed = Interval::new(1.0 - bend.abs(), 1.0 + bend.abs());
        let turn = Interval::point(-2.0 * bend);
        let mut spread = [Interval::ZERO; 3];
        let mut ends = [[Interval::ZERO; 3]; 2];
        for d in 0..3 {
            let along =
                Jet { v: c.jets[d].v, d: c.jets[d].d * speed, dd: c.jets[d].dd * speed.sqr() + c.jets[d].d * turn };
            let difference = along - f.jets[d];
            for k in 0..2 {
                ends[k][d] = c.ends[k][d] - f.ends[k][d];
            }
            spread[d] = ends[0][d].hull(ends[1][d]).widen(difference.chord_deviation(0.0));
        }
        let at_ends = length_bound(&ends[0]).max(length_bound(&ends[1]));
        (length_bound(&spread), at_ends, (m, t))
    }
}

/// A part of a side over which edge and surface are one polynomial each.
#[derive(Clone, Copy)]
struct ChordPart {
    corners: [[f64; 2]; 2],
    element: usize,
    /// Parameters of the edge at the corners.
    t: [f64; 2],
    depth: u32,
}

/// The parts of a chord between two places, one for each element that they meet.
fn across(elements: &[Element], corners: [[f64; 2]; 2], places: [f64; 2]) -> Vec<ChordPart> {
    let (lo, hi) = (places[0].min(places[1]), places[0].max(places[1]));
    let meets = |e: &&(usize, &Element)| e.1.places[0] < hi && e.1.places[1] > lo;
    let all: Vec<(usize, &Element)> = elements.iter().enumerate().collect();
    let mut found: Vec<(usize, &Element)> = all.iter().filter(meets).copied().collect();
    if found.is_empty() {
        // A single place: the element that holds it.
        let holds = |e: &&(usize, &Element)| e.1.places[0] <= lo && lo <= e.1.places[1];
        found.extend(all.iter().find(holds).or(all.last()).copied());
    }
    if places[0] > places[1] {
        found.reverse();
    }
    let place = |e: &Element, p: f64| p.clamp(e.places[0], e.places[1]);
    let mut out = Vec::new();
    for (k, (element, e)) in found.into_iter().enumerate() {
        let t = places.map(|p| e.parameter(place(e, p)));
        // Where the feet of several knots fell together the chord stays at its last corner.
        out.push(ChordPart { corners: [corners[usize::from(k > 0)], corners[1]], element, t, depth: 0 });
    }
    out
}

/// The polynomial pieces of an edge in order; `None` if it has no spline form.
fn elements(edge: &FileEdge) -> Option<Vec<Element<'_>>> {
    let mut out = Vec::new();
    for (k, FilePiece { curve, from, to }) in edge.pieces.as_ref()?.iter().enumerate() {
        let (lo, hi) = (from.min(*to), from.max(*to));
        let mut ts = vec![lo];
        ts.extend(curve.knots.breaks().into_iter().filter(|t| *t > lo && *t < hi));
        ts.push(hi);
        if to < from {
            ts.reverse();
        }
        let place = |t: f64| k as f64 + if to == from { 0.0 } else { (t - from) / (to - from) };
        for w in ts.windows(2) {
            let span = curve.knots.span(0.5 * (w[0] + w[1]));
            out.push(Element { curve, span, ends: [w[0], w[1]], places: [place(w[0]), place(w[1])] });
        }
    }
    Some(out)
}

/// A curve over a piece: derivatives by the share of the piece, and its ends; relative to a centre.
struct PieceJets {
    jets: V3<Jet>,
    ends: [V3<Interval>; 2],
}

impl PieceJets {
    /// From Bernstein coefficients of homogeneous components.
    fn of(h: &[Vec<Interval>; 4], rational: bool) -> Self {
        let last = h[0].len() - 1;
        let jets = [0, 1, 2].map(|d: usize| Jet::of_bernstein(&h[d]));
        let end = |k: usize| [0, 1, 2].map(|d: usize| if rational { h[d][k] / h[3][k] } else { h[d][k] });
        let ends = [end(0), end(last)];
        if !rational {
            return Self { jets, ends };
        }
        let w = Jet::of_bernstein(&h[3]);
        Self { jets: jets.map(|j| j.over(w)), ends }
    }
}

/// Components relative to a centre: `x − w c` and w.
fn moved(h: &[f64; 4], centre: &Vec3, d: usize) -> Interval {
    if d == 3 {
        Interval::point(h[3])
    } else {
        Interval::point(h[d]) - Interval::point(h[3]) * Interval::point(centre[d])
    }
}

/// The knots that the piece on `span` depends on.
fn local(knots: &Knots, span: usize) -> &[f64] {
    let p = knots.degree();
    &knots.values()[span + 1 - p..=span + p]
}

fn on_curve(curve: &Curve<4>, span: usize, t: [f64; 2], centre: &Vec3) -> PieceJets {
    let p = curve.knots.degree();
    let control = &curve.control[span - p..=span];
    let h = [0, 1, 2, 3].map(|d: usize| {
        let net: Vec<Interval> = control.iter().map(|c| moved(c, centre, d)).collect();
        from_spline_over(&net, local(&curve.knots, span), t[0], t[1])
    });
    let rational = control.iter().any(|c| c[3].total_cmp(&1.0).is_ne());
    PieceJets::of(&h, rational)
}

/// The image of a chord that crosses no knot line.
fn on_chord(surface: &Surface, [a, b]: [[f64; 2]; 2], centre: &Vec3) -> PieceJets {
    let (p, q, row) = (surface.knots_u.degree(), surface.knots_v.degree(), surface.row());
    let (su, sv) = (surface.knots_u.span(0.5 * (a[0] + b[0])), surface.knots_v.span(0.5 * (a[1] + b[1])));
    let (ku, kv) = (local(&surface.knots_u, su), local(&surface.knots_v, sv));
    let h = [0, 1, 2, 3].map(|d: usize| {
        if d == 3 && !surface.rational {
            return vec![Interval::ONE; p + q + 1];
        }
        // Tensor product over the box with the chord as diagonal, then the diagonal.
        let lines: Vec<Vec<Interval>> = (su - p..=su)
            .map(|i| {
                let line = &surface.control[i * row + sv - q..=i * row + sv];
                let net: Vec<Interval> = line.iter().map(|c| moved(c, centre, d)).collect();
                from_spline_over(&net, kv, a[1], b[1])
            })
            .collect();
        let mut out = vec![Interval::ZERO; p + q + 1];
        for l in 0..=q {
            let net: Vec<Interval> = lines.iter().map(|line| line[l]).collect();
            for (k, c) in from_spline_over(&net, ku, a[0], b[0]).into_iter().enumerate() {
                out[k + l] += c * Interval::point(binomial(p, k) * binomial(q, l));
            }
        }
        (0..=p + q).map(|k| out[k] * <Interval as Scalar>::ratio(1.0, binomial(p + q, k))).collect()
    });
    PieceJets::of(&h, surface.rational)
}

/// Point and derivative of a homogeneous curve.
fn point(curve: &Curve<4>, t: f64) -> (Vec3, Vec3) {
    let [h, d, _] = curve.jet(t);
    let p = Vec3::new(h[0], h[1], h[2]) / h[3];
    (p, (Vec3::new(d[0], d[1], d[2]) - p * d[3]) / h[3])
}

/// Newton steps of the searches for corresponding places; any place is valid, good ones make bounds small.
const STEPS: usize = 3;
/// Share of a range that searches keep away from its ends, so that halves do not become empty.
const APART: f64 = 0.01;

/// Parameter between `t[0]` and `t[1]` near which the curve is nearest to `x`, sought from a start.
fn nearest(curve: &Curve<4>, t: [f64; 2], start: f64, x: &Vec3) -> f64 {
    let (lo, hi) = (t[0].min(t[1]), t[0].max(t[1]));
    let mut s = start.clamp(lo, hi);
    for _ in 0..STEPS {
        let (p, d) = point(curve, s);
        let speed = d.norm_squared();
        if speed <= 0.0 || speed.is_nan() {
            break;
        }
        s = (s + (x - p).dot(&d) / speed).clamp(lo, hi);
    }
    s
}

/// Share of a side near which its image is nearest to `x`.
fn foot_on_side(surface: &Surface, [a, b]: [[f64; 2]; 2], x: &Vec3, guess: f64) -> f64 {
    let mut s = guess.clamp(0.0, 1.0);
    for _ in 0..STEPS {
        let j = surface.jet(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]));
        let d = j.du * (b[0] - a[0]) + j.dv * (b[1] - a[1]);
        let speed = d.norm_squared();
        if speed <= 0.0 || speed.is_nan() {
            break;
        }
        s = (s + (x - j.p).dot(&d) / speed).clamp(0.0, 1.0);
    }
    s
}

/// The place along an edge nearest to `x`, found from a guess: a search that runs against the end of an element goes on
/// in the next.
fn place_near(elements: &[Element], guess: f64, x: &Vec3) -> f64 {
    let Some(mut k) = elements.iter().position(|e| e.places[0] <= guess && guess <= e.places[1]) else { return guess };
    let mut place = guess;
    let mut before = 0_i32;
    loop {
        let e = &elements[k];
        let t = nearest(e.curve, e.ends, e.parameter(place), x);
        let share = (t - e.ends[0]) / (e.ends[1] - e.ends[0]);
        if !share.is_finite() {
            return guess;
        }
        place = e.places[0] + share * (e.places[1] - e.places[0]);
        let step = i32::from(share >= 1.0) - i32::from(share <= 0.0);
        let next = k.checked_add_signed(step as isize).filter(|n| *n < elements.len());
        // Sent back to where it came from, the search has found the end between both.
        match next {
            Some(n) if step != 0 && step != -before => (k, before) = (n, step),
            _ => return place,
        }
    }
}
