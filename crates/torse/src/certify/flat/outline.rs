//! Lines and arcs of a drawn outline against the flat image of the border.
//!
//! *Method* \[certificate, 6\]: an arc from P to Q of curvature k, in the frame of its tangent at P, has the signed
//! distance `w/(1 + √(1 + k w))`, `w = k |X − P|² − 2 y`, from its circle (also for k = 0). A stretch of the image that
//! begins near P and ends near Q, and never lies before P or behind Q, covers the whole arc with its projections; so the
//! distance from the circle over the stretch, and of its ends from P and Q, bound the distance of stretch and arc both
//! ways. Where a point may lie before P by o, it is within `c (1 + k c)`, `c = o + |distance| (1 + k |distance|)`, of P
//! as long as `k |X − P| ≤ 1`, and no farther from the arc than from P.
//!
//! Where the stretches begin is found by searching; any places are good for the proof, these make the bound small.

use super::super::boundary::trim_piece;
use super::rails::FlatRails;
use crate::certify::curve_model::cuts;
use crate::num::bernstein::Scalar;
use crate::num::greatest::greatest;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::num::taylor_model::TaylorModel;
use crate::patchwork::pattern::ContourVertex;
use crate::spline::curve::Curve;
use std::ops::{Add, Mul, Sub};

/// Enclosures end within this share of the tolerance of the greatest distance.
const EXCESS: f64 = 5e-4;

/// Arcs of greater bulge are taken in halves: tangents at both ends of what remains turn by much less than half a turn.
const STEEP: f64 = 0.5;

/// Rounding of the middle of an arc that is halved, as a share of its coordinates.
const MIDDLE: f64 = 32.0 * f64::EPSILON;

/// What is said of points behind an end holds for ways up to this share of the radius.
const SHORT: f64 = 0.25;

/// Halvings of an arc at most: a full circle has no bulge.
const SPLITS: usize = 8;

/// Newton steps towards the place nearest to a joint, at most.
const STEPS: usize = 8;

/// Steps shorter than this, mm, are the last.
const STILL: f64 = 1e-9;

/// A step that leads farther away is tried again shortened by this factor, and so many times in all.
const SHORTER: f64 = 0.25;
const TRIES: usize = 6;

/// A rigid motion of the plane: turn, then move. The turn need not be of unit length: its direction counts.
#[derive(Clone, Copy, Debug)]
pub(in crate::certify) struct Motion {
    pub turn: [f64; 2],
    pub from: [f64; 2],
    pub to: [f64; 2],
}

impl Motion {
    /// The motion that takes the first points to the second ones, nearly (least squares; Kabsch in the plane).
    pub fn between(pairs: &[([f64; 2], [f64; 2])]) -> Option<Self> {
        let n = pairs.len() as f64;
        let sum = pairs
            .iter()
            .fold([[0.0; 2]; 2], |s, (p, q)| [[s[0][0] + p[0], s[0][1] + p[1]], [s[1][0] + q[0], s[1][1] + q[1]]]);
        let [from, to] = sum.map(|s| s.map(|x: f64| x / n));
        let mut turn = [0.0; 2];
        for (p, q) in pairs {
            let (p, q) = ([p[0] - from[0], p[1] - from[1]], [q[0] - to[0], q[1] - to[1]]);
            turn[0] += p[0] * q[0] + p[1] * q[1];
            turn[1] += p[0] * q[1] - p[1] * q[0];
        }
        let size = turn[0].hypot(turn[1]);
        let motion = Self { turn: [turn[0] / size, turn[1] / size], from, to };
        (size > 0.0 && size.is_finite()).then_some(motion)
    }

    /// This motion and then another one, nearly: that which does the same to two points.
    pub fn then(&self, next: &Self) -> Option<Self> {
        let from = self.from;
        let size = self.to.iter().chain(&next.to).chain(&from).fold(1.0f64, |m, x| m.max(x.abs()));
        let pair = |p: [f64; 2]| (p, next.about(&self.about(&p)));
        Self::between(&[pair([from[0] - size, from[1]]), pair([from[0] + size, from[1]])])
    }

    /// Cosine and sine, exactly those of some turn.
    fn rotation(&self) -> [Interval; 2] {
        let [c, s] = self.turn.map(Interval::point);
        let size = (c.sqr() + s.sqr()).sqrt();
        [c / size, s / size]
    }

    /// About where a point goes.
    pub fn about(&self, p: &[f64; 2]) -> [f64; 2] {
        let ([c, s], p) = (self.turn, [0, 1].map(|d: usize| p[d] - self.from[d]));
        [c * p[0] - s * p[1] + self.to[0], s * p[0] + c * p[1] + self.to[1]]
    }

    /// Image of a point.
    pub fn point(&self, p: &[Interval; 2]) -> [Interval; 2] {
        self.image(p, |x| x)
    }

    /// Image of a moving point.
    pub(super) fn jet(&self, p: &[Jet; 2]) -> [Jet; 2] {
        self.image(p, Jet::constant)
    }

    fn image<S>(&self, p: &[S; 2], constant: impl Fn(Interval) -> S) -> [S; 2]
    where
        S: Copy + Add<Output = S> + Sub<Output = S> + Mul<Output = S>,
    {
        let [c, s] = self.rotation().map(&constant);
        let [from, to] = [self.from, self.to].map(|x| x.map(|x| constant(Interval::point(x))));
        let p = [p[0] - from[0], p[1] - from[1]];
        [c * p[0] - s * p[1] + to[0], s * p[0] + c * p[1] + to[1]]
    }
}

/// The image of a run of a panel's border in the drawing's coordinates.
#[derive(Clone, Copy)]
pub(super) struct Image<'a> {
    pub flat: &'a FlatRails,
    pub trim: &'a Curve<2>,
    pub motion: Motion,
}

/// A stretch of an image, by the share of the stretch.
enum Stretch {
    /// As polynomials.
    Close([TaylorModel; 2]),
    /// With enclosed derivatives, and its ends.
    Wide {
        curve: [Jet; 2],
        ends: [[Interval; 2]; 2],
        /// See [`Jet::chord_deviation`].
        rough: f64,
    },
}

impl Stretch {
    /// Points, and first and last one.
    fn points(&self) -> ([Interval; 2], [[Interval; 2]; 2]) {
        match self {
            Self::Close(p) => {
                let ends = p.map(|x| x.ends());
                (p.map(|x| x.range()), [0, 1].map(|k: usize| ends.map(|e| e[k])))
            }
            Self::Wide { curve, ends, .. } => (curve.map(|j| j.v), *ends),
        }
    }

    /// `w·direction` for the ways w from a point: at both ends, and the least of all.
    fn least_along(&self, from: &[Interval; 2], direction: &[Interval; 2]) -> f64 {
        let (ends, rises, stray) = match self {
            Self::Close(p) => {
                let way = way_along(p, from, direction, TaylorModel::constant);
                (way.ends(), way.derivative().range().sign() != 0, way.chord_deviation())
            }
            Self::Wide { curve, ends, rough } => {
                let way = way_along(curve, from, direction, Jet::constant);
                let ends = ends.map(|e| way_along(&e, from, direction, |x| x));
                (ends, way.d.sign() != 0, way.chord_deviation(*rough))
            }
        };
        if rises {
            ends[0].lo.min(ends[1].lo)
        } else {
            ends[0].hull(ends[1]).widen(stray).lo
        }
    }
}

fn way_along<S>(p: &[S; 2], from: &[Interval; 2], direction: &[Interval; 2], constant: impl Fn(Interval) -> S) -> S
where
    S: Copy + Add<Output = S> + Sub<Output = S> + Mul<Output = S>,
{
    let [x, y] = [0, 1].map(|d: usize| (p[d] - constant(from[d])) * constant(direction[d]));
    x + y
}

impl Image<'_> {
    /// The image at one place, with derivatives by the parameter.
    fn at(&self, s: f64) -> Option<[Jet; 2]> {
        let j = self.trim.jet(s);
        let jet =
            |d: usize| Jet { v: Interval::point(j[0][d]), d: Interval::point(j[1][d]), dd: Interval::point(j[2][d]) };
        Some(self.motion.jet(&self.flat.along_curve(jet(0), jet(1))?.0))
    }

    /// About where the image is.
    pub fn place(&self, s: f64) -> Option<[f64; 2]> {
        let q = self.trim.point(s);
        Some(self.motion.about(&self.flat.place(q[0], q[1])?))
    }

    /// Where the image exactly is at an end of the run, or at a place within.
    pub fn point(&self, s: f64) -> Option<[Interval; 2]> {
        // Bernstein coefficients over a tiny stretch that begins or ends there enclose the curve's own value.
        let breaks = self.trim.knots.breaks();
        let i = breaks.partition_point(|&b| b <= s).clamp(1, breaks.len() - 1);
        let theta = trim_piece(self.trim, s, breaks[i]);
        let last = theta[0].len() - 1;
        let k = if s >= breaks[i] { last } else { 0 };
        let p = self.flat.along_curve(Jet::constant(theta[0][k]), Jet::constant(theta[1][k]))?.0;
        Some(self.motion.point(&[p[0].v, p[1].v]))
    }

    /// Where to cut it: see [`cuts`].
    fn cuts(&self) -> Vec<f64> {
        cuts(self.trim, self.flat.breaks())
    }

    fn over(&self, s0: f64, s1: f64) -> Option<Stretch> {
        let theta = trim_piece(self.trim, s0, s1);
        if let Some(p) = self.flat.model(&theta) {
            return Some(Stretch::Close(self.motion.image(&p, TaylorModel::constant)));
        }
        let (curve, rough) = self.flat.along_curve(Jet::of_bernstein(&theta[0]), Jet::of_bernstein(&theta[1]))?;
        let last = theta[0].len() - 1;
        let end = |k: usize| {
            let p = self.flat.along_curve(Jet::constant(theta[0][k]), Jet::constant(theta[1][k]))?.0;
            Some(self.motion.point(&[p[0].v, p[1].v]))
        };
        Some(Stretch::Wide { curve: self.motion.jet(&curve), ends: [end(0)?, end(last)?], rough })
    }

    /// The place nearest to a point, from a place near it; inside `[low, 1]`.
    pub fn nearest(&self, to: &[f64; 2], from: f64, low: f64) -> f64 {
        let far = |s: f64| self.place(s).map_or(f64::INFINITY, |p| (p[0] - to[0]).hypot(p[1] - to[1]));
        let mut s = from.clamp(low, 1.0);
        for _ in 0..STEPS {
            let Some(p) = self.at(s) else { return s };
            let w = [p[0].v.mid() - to[0], p[1].v.mid() - to[1]];
            let (v, a) = ([p[0].d.mid(), p[1].d.mid()], [p[0].dd.mid(), p[1].dd.mid()]);
            let slope = w[0] * v[0] + w[1] * v[1];
            let speed = v[0] * v[0] + v[1] * v[1];
            let bend = speed + w[0] * a[0] + w[1] * a[1];
            // Where the second derivative misleads, the first alone does.
            let step = slope / if bend > 0.25 * speed { bend } else { speed };
            if !step.is_finite() {
                return s;
            }
            // Behind a knot the image may be many times faster: shorter steps then.
            let here = w[0].hypot(w[1]);
            let shares = std::iter::successors(Some(1.0), |x| Some(SHORTER * x)).take(TRIES);
            let next = shares.map(|x| (s - x * step).clamp(low, 1.0)).find(|&t| far(t) < here);
            let Some(next) = next else { return s };
            s = next;
            if step * step * speed < STILL * STILL {
                return s;
            }
        }
        s
    }
}

/// Bound (mm) of the distance, both ways, between the image of a run and the lines and arcs of a chain. `vertices`
/// begins with the chain's first joint and ends with its last one, whose bulge does not count.
pub(super) fn chain_bound(image: &Image, vertices: &[ContourVertex], tolerance: f64) -> Option<f64> {
    let (mut pieces, slack) = halved(vertices)?;
    let last = pieces.pop()?;
    if pieces.is_empty() {
        // Nothing is drawn but a point.
        let bound = greatest(image.trim.knots.breaks(), EXCESS * tolerance, |a, b| {
            let (all, [first, _]) = image.over(a, b)?.points();
            Some((distance(&all, &last.point).hi, distance(&first, &last.point).lo))
        })?;
        return bound.is_finite().then_some(bound);
    }
    let places = joints(image, &pieces, &last)?;
    let all_cuts = image.cuts();
    let mut bound = 0.0f64;
    for (k, piece) in pieces.iter().enumerate() {
        let next = pieces.get(k + 1).unwrap_or(&last);
        let (s0, s1) = (places[k], places[k + 1]);
        let arc = ArcFrame::new(piece.point, next.point, piece.bulge)?;
        for (s, p) in [(s0, piece), (s1, next)] {
            let here = image.point(s)?;
            bound = bound.max(distance(&here, &p.point).hi);
        }
        // What is far away at its joints is not worth a closer look.
        if bound > tolerance {
            return None;
        }
        if s0 >= s1 {
            // An arc that the image does not follow at all: its points are within its length of the joint.
            bound = bound.max((distance(&image.point(s0)?, &piece.point) + arc.reach()).hi);
            continue;
        }
        let mut cuts = vec![s0, s1];
        cuts.extend(all_cuts.iter().copied().filter(|&t| t > s0 && t < s1));
        let off = greatest(cuts, EXCESS * tolerance, |a, b| arc.off(&image.over(a, b)?))?;
        bound = bound.max(off);
    }
    let bound = (Interval::point(bound) + Interval::point(slack)).hi;
    bound.is_finite().then_some(bound)
}

fn distance(p: &[Interval; 2], q: &[f64; 2]) -> Interval {
    let w = [0, 1].map(|d: usize| p[d] - Interval::point(q[d]));
    (w[0].sqr() + w[1].sqr()).sqrt()
}

/// A joint as numbers.
#[derive(Clone, Copy)]
struct Joint {
    point: [f64; 2],
    bulge: f64,
}

/// The chain with steep arcs in halves, and how far that moved any point.
fn halved(vertices: &[ContourVertex]) -> Option<(Vec<Joint>, f64)> {
    let mut out = Vec::with_capacity(vertices.len());
    let mut slack = 0.0f64;
    for w in vertices.windows(2) {
        let joint = |v: &ContourVertex| Joint { point: [v.point.x, v.point.y], bulge: v.bulge };
        let mut open = vec![(joint(&w[0]), joint(&w[1]).point, 0)];
        while let Some((a, b, depth)) = open.pop() {
            if a.bulge.abs() <= STEEP || a.bulge.is_nan() {
                out.push(a);
                continue;
            }
            if depth == SPLITS {
                return None;
            }
            let v = a.bulge;
            let half = v / (1.0 + v.hypot(1.0));
            // A counter-clockwise arc lies on the right of its chord.
            let middle = [
                0.5 * (a.point[0] + b[0] + v * (b[1] - a.point[1])),
                0.5 * (a.point[1] + b[1] - v * (b[0] - a.point[0])),
            ];
            let size = a.point.iter().chain(&b).chain(&middle).fold(0.0f64, |m, x| m.max(x.abs()));
            slack = slack.max(size * MIDDLE * (depth + 1) as f64);
            open.push((Joint { point: middle, bulge: half }, b, depth + 1));
            open.push((Joint { bulge: half, ..a }, middle, depth + 1));
        }
    }
    let last = vertices.last()?;
    out.push(Joint { point: [last.point.x, last.point.y], bulge: 0.0 });
    let finite = out.iter().all(|j| j.point[0].is_finite() && j.point[1].is_finite() && j.bulge.is_finite());
    finite.then_some((out, slack))
}

/// Places on the run of all joints, increasing from 0 to 1: about equal shares of the length first, then the nearest.
fn joints(image: &Image, pieces: &[Joint], last: &Joint) -> Option<Vec<f64>> {
    let mut out = by_length(image, pieces, last)?;
    for k in 1..pieces.len() {
        out[k] = image.nearest(&pieces[k].point, out[k], out[k - 1]);
    }
    Some(out)
}

/// Joints of a chain with the places of an image at the same shares of the length: pairs for [`Motion::between`].
pub(super) fn pairs_by_length(image: &Image, vertices: &[ContourVertex]) -> Option<Vec<([f64; 2], [f64; 2])>> {
    let (mut pieces, _) = halved(vertices)?;
    let last = pieces.pop()?;
    let places = by_length(image, &pieces, &last)?;
    pieces.iter().zip(places).map(|(p, s)| Some((image.place(s)?, p.point))).collect()
}

/// Length of a line or arc.
pub(super) fn arc_length(a: [f64; 2], b: [f64; 2], bulge: f64) -> f64 {
    let chord = (b[0] - a[0]).hypot(b[1] - a[1]);
    let half = 2.0 * bulge.atan();
    if half.abs() > f64::EPSILON {
        chord * half / half.sin()
    } else {
        chord
    }
}

/// Places on the run at the joints' shares of the whole length, from 0 to 1.
fn by_length(image: &Image, pieces: &[Joint], last: &Joint) -> Option<Vec<f64>> {
    let walked = walk(image)?;
    let total = walked[walked.len() - 1].1;
    let mut own = vec![0.0];
    for (k, piece) in pieces.iter().enumerate() {
        let next = pieces.get(k + 1).unwrap_or(last).point;
        own.push(own[k] + arc_length(piece.point, next, piece.bulge));
    }
    let whole = own[own.len() - 1];
    let mut out = vec![0.0];
    for k in 1..pieces.len() {
        let at = own[k] / whole * total;
        let i = walked.partition_point(|w| w.1 <= at).clamp(1, walked.len() - 1);
        let ((s0, l0), (s1, l1)) = (walked[i - 1], walked[i]);
        out.push(if l1 > l0 { s0 + (s1 - s0) * (at - l0) / (l1 - l0) } else { s0 });
    }
    out.push(1.0);
    Some(out)
}

/// Places along an image with the length up to there, by chords.
fn walk(image: &Image) -> Option<Vec<(f64, f64)>> {
    const SAMPLES: usize = 6;
    let breaks = image.trim.knots.breaks();
    let mut walked = vec![(0.0, 0.0)];
    let mut before = image.place(breaks[0])?;
    for w in breaks.windows(2) {
        for k in 1..=SAMPLES {
            let s = w[0] + (w[1] - w[0]) * k as f64 / SAMPLES as f64;
            let p = image.place(s)?;
            let length = walked[walked.len() - 1].1 + (p[0] - before[0]).hypot(p[1] - before[1]);
            walked.push((s, length));
            before = p;
        }
    }
    Some(walked)
}

/// A line or arc: its ends, tangents there and curvature.
struct ArcFrame {
    ends: [[Interval; 2]; 2],
    tangents: [[Interval; 2]; 2],
    curvature: Interval,
    length: Interval,
}

impl ArcFrame {
    fn new(a: [f64; 2], b: [f64; 2], bulge: f64) -> Option<Self> {
        let ends = [a, b].map(|p| p.map(Interval::point));
        let chord = [0, 1].map(|d: usize| ends[1][d] - ends[0][d]);
        let length = (chord[0].sqr() + chord[1].sqr()).sqrt();
        if length.sign() <= 0 {
            return None;
        }
        // tan of a quarter of the sweep; the tangents are half the sweep off the chord.
        let v = Interval::point(bulge);
        let one = Interval::ONE + v.sqr();
        let (c, s) = ((Interval::ONE - v.sqr()) / one, v.scale_exact(2.0) / one);
        let [x, y] = chord.map(|p| p / length);
        let tangents = [[c * x + s * y, c * y - s * x], [c * x - s * y, c * y + s * x]];
        Some(Self { ends, tangents, curvature: v.scale_exact(4.0) / (length * one), length })
    }

    /// No point of the arc is farther from its first end than twice the chord: arcs turn by less than half a circle.
    fn reach(&self) -> Interval {
        self.length.scale_exact(2.0)
    }

    /// Bound of the distance of a stretch's points from the arc, and at the ends of the stretch.
    fn off(&self, stretch: &Stretch) -> Option<(f64, f64)> {
        let k = self.curvature;
        let (all, at_ends) = self.signed(stretch);
        let off = all.mag();
        let mut bound = off;
        for (end, forward) in [(0, true), (1, false)] {
            let direction = self.tangents[end].map(|t| if forward { t } else { -t });
            let least = stretch.least_along(&self.ends[end], &direction);
            if least >= 0.0 {
                continue;
            }
            let points = stretch.points().0;
            let w = [0, 1].map(|d: usize| points[d] - self.ends[end][d]);
            let far = (w[0].sqr() + w[1].sqr()).sqrt();
            if (far * k.abs()).hi > 1.0 {
                return None;
            }
            let k = k.abs();
            let off = Interval::point(off);
            let c = Interval::point(-least) + off * (Interval::ONE + k * off);
            let near = if (k * c).hi > SHORT { f64::INFINITY } else { (c * (Interval::ONE + k * c)).hi };
            bound = bound.max(near.min(far.hi));
        }
        (bound.is_finite()).then_some((bound, at_ends))
    }

    /// Signed distances of a stretch's points from the circle, and a bound of those at its ends.
    fn signed(&self, stretch: &Stretch) -> (Interval, f64) {
        let k = self.curvature;
        let distance = |power: Interval| power / (Interval::ONE + (Interval::ONE + k * power).sqrt());
        match stretch {
            Stretch::Close(p) => {
                let power = self.power(p, TaylorModel::constant, |x| x * x);
                let [first, last] = power.ends().map(distance);
                (distance(power.range()), first.mag().max(last.mag()))
            }
            Stretch::Wide { curve, ends, rough } => {
                let power = self.power(curve, Jet::constant, square);
                let all = power.over(Jet::from(1.0) + (Jet::from(1.0) + Jet::constant(k) * power).sqrt());
                let [first, last] = ends.map(|e| distance(self.power(&e, |x| x, Interval::sqr)));
                (first.hull(last).widen(all.chord_deviation(*rough)), first.mag().max(last.mag()))
            }
        }
    }

    /// `k |w|² − 2 y` of points.
    fn power<S>(&self, p: &[S; 2], constant: impl Fn(Interval) -> S, square: impl Fn(S) -> S) -> S
    where
        S: Copy + Add<Output = S> + Sub<Output = S> + Mul<Output = S>,
    {
        let w = [0, 1].map(|d: usize| p[d] - constant(self.ends[0][d]));
        let t = self.tangents[0].map(&constant);
        let y = t[0] * w[1] - t[1] * w[0];
        constant(self.curvature) * (square(w[0]) + square(w[1])) - (y + y)
    }
}

/// Square of a jet, its value taken tightly.
fn square(x: Jet) -> Jet {
    Jet { v: x.v.sqr(), ..x * x }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line beside a short arc that turns by 65°, and a little behind its end: the arc's points are up to 0.13 mm away, and a
    /// drawing that coarse may be meant.
    #[test]
    fn a_line_behind_the_end_of_a_short_arc_is_bounded() {
        let (p, q) = ([0.0, 0.0], [-0.6, -0.1]);
        let arc = ArcFrame::new(p, q, -0.29).expect("an arc");
        let ends = [[-0.53, 0.007], [-0.584, 0.0134]];
        let piece = |a: f64, b: f64| {
            let at = |t: f64| [0, 1].map(|d: usize| Interval::point(ends[0][d] + t * (ends[1][d] - ends[0][d])));
            let [from, to] = [at(a), at(b)];
            let line = [0, 1].map(|d| TaylorModel::of_bernstein(&[from[d], to[d]]));
            arc.off(&Stretch::Close(line))
        };
        let bound = greatest(vec![0.0, 1.0], 1e-3, piece).expect("a bound");
        // The true distance, by a search along the arc.
        let (radius, sweep) = (1.0 / arc.curvature.abs().mid(), 4.0 * 0.29_f64.atan());
        let tangent = arc.tangents[0].map(|t| t.mid());
        let centre = [p[0] + radius * tangent[1], p[1] - radius * tangent[0]];
        let on_arc = |k: usize| {
            let (s, c) = (-sweep * k as f64 / 1000.0).sin_cos();
            let w = [p[0] - centre[0], p[1] - centre[1]];
            [centre[0] + c * w[0] - s * w[1], centre[1] + s * w[0] + c * w[1]]
        };
        assert!((on_arc(1000)[0] - q[0]).hypot(on_arc(1000)[1] - q[1]) < 1e-9);
        let off = |x: [f64; 2]| {
            (0..=1000).map(on_arc).map(|y| (x[0] - y[0]).hypot(x[1] - y[1])).fold(f64::INFINITY, f64::min)
        };
        let farthest = ends.map(off).into_iter().fold(0.0, f64::max);
        assert!(farthest <= bound && bound < farthest + 0.02, "{farthest} {bound}");
    }
}
