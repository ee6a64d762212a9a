//! Proof that a cone spline and a developable strip lie within a distance of each other, in both directions.
//!
//! *Method* (docs/algorithms/cones.md): the signed distance from a cone \[LP98\] and its derivative are evaluated by
//! intervals at the ends of stretches of the boundary curves, and its fourth derivative is enclosed between them; along
//! a ruling it is convex, and its deviation from a chord is bounded by the twist of the ruling about the axis. The
//! reverse direction follows from the winding of the boundary's feet around the strip, and the distance between these
//! feet and the edges of the segments; as the map to the feet does not fold, the same winding shows that no foot lies
//! farther outside. Shares nothing with the fit. Chains that are cut along an outline: [`outline`].

use super::claim::UpperBound;
use crate::num::bernstein::Scalar;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::num::series::{hermite_range, Series};
use crate::torse::cone::distance::Round;
use crate::torse::cone::spline::{ConeSpline, Segment, Shape};
use crate::torse::g1_element::G1Element;
use crate::torse::ruled_patch::EnclosedStrip;

use super::vector::{cross, dot, sub, V3};
use crate::geom::Vec3;

/// Options of [`cones`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeJudgeOptions {
    /// Distance to be proven, mm; no default.
    pub tolerance: f64,
    /// Stretches are halved until no bound exceeds what is reached somewhere by more than this share of the tolerance,
    /// or of what is reached where that is more; 0.05.
    pub surcharge: f64,
    /// Most halvings of the stretch between two nodes; 14.
    pub depth: usize,
}

impl ConeJudgeOptions {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, surcharge: 0.05, depth: 14 }
    }
}

/// What was proven of a cone spline and a strip; only [`cones`] makes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeProof {
    lines_bound: f64,
    bound: f64,
    worst: f64,
    attained: f64,
    mismatch: f64,
    stretches: usize,
}

impl ConeProof {
    /// Every point of the strip is within this distance (mm) of the chain, and every point of the chain between its
    /// edges is within it of the strip; unknown where nothing could be shown.
    pub fn bound(&self) -> UpperBound {
        UpperBound::shown(self.bound)
    }

    /// Every point of the strip is within this distance (mm) of the chain, where the rulings of the chain count as
    /// whole lines: what holds whatever is cut from it.
    pub fn lines_bound(&self) -> UpperBound {
        UpperBound::shown(self.lines_bound)
    }

    /// Ruling where [`ConeProof::lines_bound`] is attained.
    pub fn worst(&self) -> f64 {
        self.worst
    }

    /// A distance from the cones that is attained at some point of the strip, mm: more than the tolerance proves
    /// failure.
    pub fn attained(&self) -> f64 {
        self.attained
    }

    /// Largest mismatch at a joint, in rad and as a share of the strip's size: computed, not enclosed.
    pub fn mismatch(&self) -> f64 {
        self.mismatch
    }

    /// Stretches examined.
    pub fn stretches(&self) -> usize {
        self.stretches
    }

    /// Whether both directions are proven to stay within a tolerance (mm).
    pub fn holds(&self, tolerance: f64) -> bool {
        self.bound <= tolerance
    }
}

/// Why nothing can be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConeJudgeError {
    /// Nodes that do not go with the chain.
    #[error("{nodes} nodes for {segments} segments; a chain of n pairs has n + 1 nodes, increasing within the domain")]
    Nodes {
        /// Number of nodes.
        nodes: usize,
        /// Number of segments.
        segments: usize,
    },
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive number of mm")]
    Tolerance(f64),
}

/// Points this far (as a share of the tolerance) behind the normal plane of a node still count as in front of it; the
/// same share is added to the bound.
const BEHIND: f64 = 1e-4;
/// Rounding of a segment's own points against its exact cone, as a share of the coordinates: eight operations.
const ROUNDING: f64 = 1e-15;
/// Joints rougher than this are no joints: the wedges of the segments would not meet. What is less is paid for, by
/// [`GAP`] times the mismatch.
const ROUGH: f64 = 1e-6;
/// Distance between both sides of a joint anywhere on the strip over its mismatch times the strip's size: once for the
/// lines, once for their directions, once for the normals, and as much again.
const GAP: f64 = 6.0;
/// Steps across the first and the last ruling count this often: the distance from the axis of a foot is less than twice
/// that of its point.
const ACROSS: f64 = 2.0;
/// Where the rulings run to a point the surface has no normal there; this share of a ruling beside it is left out and
/// paid for.
const TIP: f64 = 1e-9;

/// Functions of u that bounds are needed of; numbers enclosed at a ruling, or over a stretch with derivatives.
trait Quantity: Scalar {
    fn root(self) -> Self;
    /// Product with a number: most factors here are numbers, and cheap.
    fn times(self, k: f64) -> Self;
    /// Sum with a number.
    fn plus(self, k: f64) -> Self;
}

impl Quantity for Interval {
    #[inline]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn times(self, k: f64) -> Self {
        self * k
    }
    #[inline]
    fn plus(self, k: f64) -> Self {
        self + Self::point(k)
    }
}

impl<const N: usize> Quantity for Series<N> {
    #[inline]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn times(self, k: f64) -> Self {
        Series::times(self, k)
    }
    #[inline]
    fn plus(self, k: f64) -> Self {
        Series::plus(self, k)
    }
}

/// Value and derivatives of second order of a series.
fn jet(s: &Series<5>) -> Jet {
    Jet { v: s.0[0], d: s.0[1], dd: s.0[2].scale_exact(2.0) }
}

/// Product with a vector of numbers.
#[inline]
fn component<S: Quantity>(a: &V3<S>, k: &Vec3) -> S {
    a[0].times(k.x) + a[1].times(k.y) + a[2].times(k.z)
}

/// Difference from a point.
#[inline]
fn from_point<S: Quantity>(a: &V3<S>, o: &Vec3) -> V3<S> {
    [a[0].plus(-o.x), a[1].plus(-o.y), a[2].plus(-o.z)]
}

/// A segment prepared: cone, frame of the middle ruling, edges.
struct Prepared {
    segment: Segment,
    round: Round,
    middle: G1Element,
    /// Unit vector from the axis to the middle of the segment, and across, so that the turn from the middle is
    /// positive as the segment counts it.
    radial: Vec3,
    across: Vec3,
}

/// A point of a ruling in the coordinates of a cone.
#[derive(Clone, Copy)]
struct Seen<S> {
    /// Signed distance from the cone.
    distance: S,
    /// Along the axis, across it, and the distance from it.
    z: S,
    q: V3<S>,
    rho: S,
}

impl Seen<Series<2>> {
    /// Without derivatives.
    fn value(&self) -> Seen<Interval> {
        Seen { distance: self.distance.0[0], z: self.z.0[0], q: self.q.map(|x| x.0[0]), rho: self.rho.0[0] }
    }
}

impl Prepared {
    fn new(segment: &Segment) -> Self {
        let middle = segment.element(0.5);
        let round = Round::of(segment);
        let (radial, across) = match segment.shape {
            Shape::Cone { distance, cos_gamma, sin_gamma, .. } => {
                let a = middle.direction * sin_gamma - middle.normal * cos_gamma;
                (a * distance.signum(), middle.forward * distance.signum())
            }
            Shape::Cylinder { radius, .. } => (middle.normal * radius.signum(), -middle.forward * radius.signum()),
            Shape::Flat { .. } => (middle.forward, middle.forward),
        };
        Self { segment: *segment, round, middle, radial, across }
    }

    fn seen<S: Quantity>(&self, x: &V3<S>) -> Seen<S> {
        let r = &self.round;
        let y = from_point(x, &r.center);
        let z = component(&y, &r.axis);
        let q = [y[0] - z.times(r.axis.x), y[1] - z.times(r.axis.y), y[2] - z.times(r.axis.z)];
        if matches!(self.segment.shape, Shape::Flat { .. }) {
            return Seen { distance: z, z, q, rho: S::from(1.0) };
        }
        let rho = dot(&q, &q).root();
        let distance = z.times(r.rise) - rho.plus(-r.radius).times(r.tilt);
        Seen { distance, z, q, rho }
    }

    /// det(axis, q_a, q_b): twist of two points of a ruling about the axis.
    fn twist<S: Quantity>(&self, a: &Seen<S>, b: &Seen<S>) -> S {
        component(&cross(&a.q, &b.q), &self.round.axis)
    }

    /// Coordinate along the ruling of the foot of a boundary point, minus that of the edge at the same turn.
    fn edge_off<S: Quantity>(&self, side: usize, seen: &Seen<S>, x: &V3<S>) -> S {
        let [a, m, b] = self.segment.edges[side];
        let from = S::from;
        if let Shape::Flat { width } = self.segment.shape {
            let y = from_point(x, &self.middle.point);
            let t = component(&y, &self.middle.forward).times(2.0).over(from(width));
            let r = component(&y, &self.middle.direction);
            return r.plus(-m) - t.times(0.5 * (b - a)) - (t * t).times(0.5 * (a + b) - m);
        }
        let full = self.segment.shape.angle();
        let (half, wh) = ((0.25 * full).sin(), (0.5 * full).sin());
        let vh = 2.0 * half * half;
        let (z, rho) = (seen.z, seen.rho);
        let cosine = component(&seen.q, &self.radial).over(rho);
        let sine = component(&seen.q, &self.across).over(rho);
        let versine = (-cosine).plus(1.0);
        match self.segment.shape {
            Shape::Cone { distance: d, cos_gamma, sin_gamma, .. } => {
                let foot = z.times(cos_gamma) + rho.plus(-self.round.radius).times(d.signum() * sin_gamma);
                let tm = d + m;
                let (ga, gb) = (-(a - m) / (d + a), -(b - m) / (d + b));
                let g = sine.times(0.5 * (gb - ga) / wh) + versine.times(0.5 * (ga + gb) / vh);
                foot.plus(-m) + g.times(tm).over(g.plus(1.0))
            }
            _ => z.plus(-m) - sine.times(0.5 * (b - a) / wh) - versine.times((0.5 * (a + b) - m) / vh),
        }
    }
}

/// `(x − point)·forward` of a ruling at both ends.
fn ahead<S: Quantity>(g: &G1Element, ends: &[V3<S>; 2]) -> [S; 2] {
    [0, 1].map(|k| component(&from_point(&ends[k], &g.point), &g.forward))
}

/// Bounds over a stretch, and what is reached at its ends.
#[derive(Clone, Copy)]
struct Stretch {
    strip: f64,
    attained: f64,
    edges: f64,
    /// Distances of the strip and of the edges at the ends of the stretch: lower bounds but for rounding.
    reached: [f64; 2],
}

/// The proof for a cone spline made of pairs between rulings of a strip.
///
/// *Input*: the strip with enclosures; `nodes`, the rulings that the chain takes, one more than pairs (two segments
/// each). *Guarantee*: the bounds hold for the exact cones (centre, axis, radius, opening as numbers) of the
/// segments and the strip as enclosed; points of segments computed in double precision are within 1e-15 of the
/// coordinates of these, which is added. Rulings of the chain count as lines in the bound of the strip.
/// *Not guaranteed*: anything where a bound is infinite.
///
/// # Errors
/// Nodes that do not go with the chain.
/// *Cost*: some 10 µs for a stretch, 4 to 16 stretches for a pair.
pub fn cones(
    strip: &impl EnclosedStrip,
    nodes: &[f64],
    spline: &ConeSpline,
    options: &ConeJudgeOptions,
) -> Result<ConeProof, ConeJudgeError> {
    let tolerance = options.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(ConeJudgeError::Tolerance(tolerance));
    }
    let (first, last) = strip.domain();
    let whole = nodes.first() == Some(&first) && nodes.last() == Some(&last) && nodes.windows(2).all(|w| w[0] < w[1]);
    if !whole || spline.segments.len() != 2 * (nodes.len() - 1) {
        return Err(ConeJudgeError::Nodes { nodes: nodes.len(), segments: spline.segments.len() });
    }
    let jet = strip.jet(first);
    let size = jet.length();
    let mut proof = ConeProof {
        lines_bound: 0.0,
        bound: 0.0,
        worst: first,
        attained: 0.0,
        mismatch: spline.mismatch(size),
        stretches: 0,
    };
    let mut breaks = strip.breaks();
    breaks.sort_by(f64::total_cmp);
    let mut edges = 0.0_f64;
    let (mut parts, mut pairs) = (Vec::new(), Vec::new());
    for (k, w) in nodes.windows(2).enumerate() {
        let pair = [Prepared::new(&spline.segments[2 * k]), Prepared::new(&spline.segments[2 * k + 1])];
        // Wedges: front of the first ruling, junction, back of the last.
        let planes = [spline.segments[2 * k].start, spline.segments[2 * k + 1].start, spline.segments[2 * k + 1].end()];
        let mut stops = vec![w[0], w[1]];
        stops.extend(breaks.iter().copied().filter(|b| *b > w[0] && *b < w[1]));
        stops.extend(beside(strip, &planes[1], w[0], w[1]));
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        parts.extend(stops.windows(2).map(|s| (k, s[0], s[1])));
        pairs.push((pair, planes));
    }
    // Stretches in the order of the chain at first, so that `reached` is soon large everywhere; then the halves of
    // those whose bounds exceed it.
    let mut reached = [0.0_f64; 2];
    let mut waiting: Vec<(usize, f64, f64, usize, Option<Stretch>)> =
        parts.into_iter().rev().map(|(k, a, b)| (k, a, b, 0, None)).collect();
    for (k, a, b, _, done) in waiting.iter_mut() {
        let s = stretch(strip, &pairs[*k].0, &pairs[*k].1, *a, *b, tolerance);
        reached = [reached[0].max(s.reached[0]), reached[1].max(s.reached[1])];
        proof.stretches += 1;
        *done = Some(s);
    }
    while let Some((k, a, b, depth, done)) = waiting.pop() {
        let s = done.unwrap_or_else(|| {
            proof.stretches += 1;
            stretch(strip, &pairs[k].0, &pairs[k].1, a, b, tolerance)
        });
        reached = [reached[0].max(s.reached[0]), reached[1].max(s.reached[1])];
        proof.attained = proof.attained.max(s.attained);
        let near = |bound: f64, reached: f64| bound <= reached + options.surcharge * tolerance.max(reached);
        let fine = near(s.strip, reached[0]) && near(s.edges, reached[1]);
        if !fine && depth < options.depth {
            let m = 0.5 * (a + b);
            waiting.push((k, m, b, depth + 1, None));
            waiting.push((k, a, m, depth + 1, None));
            continue;
        }
        // What is no number counts as far away.
        let [strip, beyond] = [s.strip, s.edges].map(|x| if x.is_nan() { f64::INFINITY } else { x });
        if strip > proof.lines_bound {
            (proof.lines_bound, proof.worst) = (strip, a);
        }
        edges = edges.max(beyond);
    }
    // Feet of the first and the last ruling that are not on those of the chain.
    let starts = outer_off(strip, &spline.segments[0].start, first, nodes[1]);
    let ends = outer_off(strip, &spline.segments[spline.segments.len() - 1].end(), last, nodes[nodes.len() - 2]);
    let reach = spline.segments.iter().map(|s| s.start.point.norm()).fold(size, f64::max);
    let slack = BEHIND * tolerance + ROUNDING * reach + (GAP * proof.mismatch + TIP) * size;
    let aside = Interval::point(edges) + Interval::point(starts.max(ends)) * ACROSS;
    // A foot and a step in the tangent plane: at right angles.
    let across = (Interval::point(proof.lines_bound).sqr() + aside.sqr()).sqrt().hi;
    proof.lines_bound += slack;
    proof.bound = across + slack;
    if !(proof.mismatch <= ROUGH && proof.lines_bound.is_finite() && proof.bound.is_finite()) {
        (proof.lines_bound, proof.bound) = (f64::INFINITY, f64::INFINITY);
    }
    Ok(proof)
}

/// Distance of a ruling from the normal plane of an element, at both ends; `beside` is another ruling of the strip.
fn outer_off(strip: &impl EnclosedStrip, g: &G1Element, u: f64, beside: f64) -> f64 {
    // Next to the ruling: there may be breaks between it and the other one.
    let inside = strip.breaks().into_iter().fold(beside, |b, t| if (t - u) * (t - b) < 0.0 { t } else { b });
    let ends = strip.enclosure(u, u, 0.5 * (u + inside)).map(|rows| rows[0]);
    ahead(g, &ends).iter().map(|a| a.mag()).fold(0.0, f64::max)
}

/// Rulings close before and behind the junction, so that only the short stretch between them meets both wedges.
fn beside(strip: &impl EnclosedStrip, junction: &G1Element, a: f64, b: f64) -> Vec<f64> {
    /// Distance from the junction, as a share of the pair.
    const NEAR: f64 = 1.0 / 512.0;
    /// Steps of bisection, to a fraction of that distance.
    const STEPS: usize = 12;
    let ahead = |k: usize, u: f64| (strip.jet(u).ends[k][0] - junction.point).dot(&junction.forward);
    let mut crossings = [a; 2];
    for (k, crossing) in crossings.iter_mut().enumerate() {
        let (mut lo, mut hi) = (a, b);
        for _ in 0..STEPS {
            let m = 0.5 * (lo + hi);
            if ahead(k, m) < 0.0 {
                lo = m;
            } else {
                hi = m;
            }
        }
        *crossing = 0.5 * (lo + hi);
    }
    let near = NEAR * (b - a);
    let stops = [crossings[0].min(crossings[1]) - near, crossings[0].max(crossings[1]) + near];
    stops.into_iter().filter(|u| *u > a && *u < b).collect()
}

/// Bounds between two rulings.
fn stretch(
    strip: &impl EnclosedStrip,
    pair: &[Prepared; 2],
    planes: &[G1Element; 3],
    a: f64,
    b: f64,
    tolerance: f64,
) -> Stretch {
    let nothing = Stretch { strip: f64::INFINITY, attained: 0.0, edges: f64::INFINITY, reached: [0.0; 2] };
    // Taylor coefficients for the parameter scaled to [0, 1].
    let step = Interval::point(b) - Interval::point(a);
    // Derivatives at the ends are those from within.
    let middle = 0.5 * (a + b);
    let all = strip.enclosure(a, b, middle);
    let ends = [a, b].map(|u| {
        let at = strip.enclosure(u, u, middle);
        [0, 1].map(|k| -> V3<Series<2>> { std::array::from_fn(|d| Series([at[k][0][d], at[k][1][d] * step])) })
    });
    let powers: [Interval; 5] = {
        let s2 = step.sqr();
        let i = Interval::point;
        [Interval::ONE, step, s2 * 0.5, s2 * step / i(6.0), s2.sqr() / i(24.0)]
    };
    let jets =
        all.map(|c| -> V3<Series<5>> { std::array::from_fn(|d| Series(std::array::from_fn(|k| c[k][d] * powers[k]))) });
    // 1. In which wedges?
    let sides = |g: &G1Element| -> [Interval; 2] {
        let (l, r, j) = (ahead(g, &ends[0]), ahead(g, &ends[1]), ahead(g, &jets));
        [0, 1].map(|k| {
            // Where the curve moves on steadily, its values lie between those of its ends.
            if j[k].0[1].sign() != 0 {
                l[k].0[0].hull(r[k].0[0])
            } else {
                hermite_range(&l[k], &r[k], &j[k]).0
            }
        })
    };
    let behind = BEHIND * tolerance;
    let (front, junction, back) = (sides(&planes[0]), sides(&planes[1]), sides(&planes[2]));
    // Before the junction only the first ruling's plane matters, behind it only the last one's.
    let takes = [junction.iter().any(|s| s.lo <= 0.0), junction.iter().any(|s| s.hi >= 0.0)];
    let outside = (0..2)
        .map(|k| if takes[0] { -front[k].lo } else { 0.0 }.max(if takes[1] { back[k].hi } else { 0.0 }))
        .fold(0.0, f64::max);
    if outside > behind || outside.is_nan() {
        return nothing;
    }
    // 2. Distances and edges.
    let mut out = Stretch { strip: 0.0, attained: 0.0, edges: 0.0, reached: [0.0; 2] };
    let both = takes[0] && takes[1];
    for (segment, _) in pair.iter().zip(takes).filter(|(_, t)| *t) {
        if judge(segment, &ends, &jets, !both, &mut out).is_none() {
            return nothing;
        }
    }
    if out.edges.is_nan() || !out.strip.is_finite() {
        return nothing;
    }
    out
}

/// Parts of a ruling between whose nodes the distance is bounded by its chord.
const PARTS: usize = 8;

/// The bounds of one segment over a stretch. `surely`: its wedge holds all of the stretch. `None` where a ruling
/// passes the axis.
///
/// *Method*: at the share λ of a ruling, ρ falls short of the chord of its ends by
/// `D = λ(1−λ) K / (chord + ρ)`, `K = 2 twist² / (ρ_a ρ_b + q_a·q_b)` (exact). The distances of both boundary curves
/// and the twist are enclosed over the stretch by cubics; so the distance lies below a parabola in λ. Where that has
/// its greatest value inside, the rulings at both ends are examined instead, and the second derivative between them.
fn judge(
    segment: &Prepared,
    ends: &[[V3<Series<2>>; 2]; 2],
    jets: &[V3<Series<5>>; 2],
    surely: bool,
    out: &mut Stretch,
) -> Option<()> {
    let [l, r] = ends.map(|x| [segment.seen(&x[0]), segment.seen(&x[1])]);
    let j = [segment.seen(&jets[0]), segment.seen(&jets[1])];
    // 1. Edges.
    for k in 0..2 {
        let at = |s: &Seen<Series<2>>, x: &V3<Series<2>>| segment.edge_off(k, s, x);
        let (el, er) = (at(&l[k], &ends[0][k]), at(&r[k], &ends[1][k]));
        let (range, least) = hermite_range(&el, &er, &segment.edge_off(k, &j[k], &jets[k]));
        out.edges = out.edges.max(range.mag());
        if surely {
            out.reached[1] = out.reached[1].max(least);
        }
        if range.mag().is_nan() {
            return None;
        }
    }
    if !unfolded(segment, jets, &j) {
        return None;
    }
    // 2. The boundary curves.
    let mut along = [Interval::ZERO; 2];
    let mut reached = 0.0_f64;
    for k in 0..2 {
        let (range, least) = hermite_range(&l[k].distance, &r[k].distance, &j[k].distance);
        along[k] = range;
        reached = reached.max(least);
    }
    if surely {
        out.attained = out.attained.max(reached);
    }
    let tilt = segment.round.tilt;
    let mut bound = along[0].mag().max(along[1].mag());
    // 3. The rulings between them.
    if tilt != 0.0 {
        let twist = segment.twist(&j[0], &j[1]);
        let facing = j[0].rho * j[1].rho + dot(&j[0].q, &j[1].q);
        if facing.0[0].lo <= 0.0 {
            return None;
        }
        let (turned, _) = hermite_range(&segment.twist(&l[0], &l[1]), &segment.twist(&r[0], &r[1]), &twist);
        let k = turned.sqr().times(2.0) / facing.0[0];
        let least = Interval::point(j[0].rho.0[0].lo.min(j[1].rho.0[0].lo));
        let rho = Interval::point((least.sqr() - k * 0.25).sqrt().lo);
        let sag = if rho.lo > 0.0 { (k / (least + rho) * tilt.abs()).hi } else { f64::INFINITY };
        let up = parabola(along[0].hi, along[1].hi, if tilt > 0.0 { sag } else { 0.0 });
        let down = parabola(-along[0].lo, -along[1].lo, if tilt < 0.0 { sag } else { 0.0 });
        let all = up.max(down);
        // An ulp is no inner maximum.
        if all.is_nan() || all > bound {
            let rulings = [&l, &r].map(|s| s.map(|s| s.value()));
            let (mut most, mut at_ends) = (0.0_f64, 0.0_f64);
            for s in &rulings {
                let [b, m] = along_ruling(segment, s)?;
                (at_ends, most) = (at_ends.max(b), most.max(m));
            }
            reached = reached.max(most);
            let bow = bow(segment, &j, &twist, &facing)?;
            let other = Interval::point(at_ends).widen(0.125 * bow).hi;
            bound = if other.is_finite() { all.min(other.max(bound)) } else { all };
        }
    }
    if bound.is_nan() {
        return None;
    }
    out.strip = out.strip.max(bound);
    if surely {
        out.reached[0] = out.reached[0].max(reached);
    }
    Some(())
}

/// Whether the map from the strip to its feet keeps its orientation over a stretch: the normals `e × x'` of the strip,
/// linear along a ruling, and those of the cone at the feet, `rise w − tilt q/ρ`, are nowhere at right angles.
fn unfolded(segment: &Prepared, jets: &[V3<Series<5>>; 2], seen: &[Seen<Series<5>>; 2]) -> bool {
    let value = |k: usize| jets[k].map(|s| s.0[0]);
    let ruling = sub(&value(1), &value(0));
    let round = &segment.round;
    let [a, b] = seen.each_ref().map(|s| s.rho.0[0]);
    // Between ends that lie less than a right angle apart about the axis, ρ is at most the greater of both and at
    // least cos 45° times the lesser one.
    if round.tilt != 0.0 && dot(&seen[0].q, &seen[1].q).0[0].lo <= 0.0 {
        return false;
    }
    let rho = Interval { lo: 0.5 * a.lo.min(b.lo), hi: a.hi.max(b.hi) };
    let facing = |normal: &V3<Interval>, s: &Seen<Series<5>>| {
        let along_axis = component(normal, &round.axis) * round.rise;
        let radial = dot(normal, &s.q.map(|q| q.0[0])) * round.tilt;
        (along_axis * rho - radial).lo
    };
    let least = [0, 1].map(|k: usize| {
        let normal = cross(&ruling, &jets[k].map(|s| s.0[1]));
        facing(&normal, &seen[0]).min(facing(&normal, &seen[1]))
    });
    least[0] > -TIP * least[1] && least[1] > -TIP * least[0]
}

/// Upper bound of the greatest value of `(1−λ) a + λ b + λ(1−λ) c` for λ from 0 to 1, `c ≥ 0`.
fn parabola(a: f64, b: f64, c: f64) -> f64 {
    let ends = a.max(b);
    let i = Interval::point;
    let rise = i(b) - i(a);
    if c <= rise.mig() {
        return ends;
    }
    // At λ = 1/2 + (b − a)/(2c).
    let inside = (i(a) + i(b)) * 0.5 + i(c) * 0.25 + rise.sqr() / (i(c) * 4.0);
    inside.hi.max(ends)
}

/// Bound of the second derivative of the distance along a stretch, at any share of the rulings.
fn bow(segment: &Prepared, j: &[Seen<Series<5>>; 2], twist: &Series<5>, facing: &Series<5>) -> Option<f64> {
    let ends = jet(&j[0].distance).dd.hull(jet(&j[1].distance).dd).mag();
    let (twist, facing) = (jet(twist), jet(facing));
    let k = (twist * twist * Jet::from(2.0)).over(facing);
    let chord = jet(&j[0].rho).hull(jet(&j[1].rho));
    // λ(1 − λ) lies between 0 and 1/4, whatever λ is.
    let share = Jet::constant(Interval { lo: 0.0, hi: 0.25 });
    let short = share * k;
    let rho = (chord * chord - short).sqrt();
    let sag = short.over(chord + rho);
    (sag.dd.is_finite() && rho.v.lo > 0.0).then(|| ends + segment.round.tilt.abs() * sag.dd.mag())
}

/// Bound of the distance along a whole ruling, and the largest one at the nodes. `None` where it passes the axis.
fn along_ruling(segment: &Prepared, s: &[Seen<Interval>; 2]) -> Option<[f64; 2]> {
    let [a, b] = s;
    let tilt = segment.round.tilt;
    if tilt == 0.0 {
        let most = a.distance.mag().max(b.distance.mag());
        return Some([most; 2]);
    }
    let facing = a.rho * b.rho + dot(&a.q, &b.q);
    if facing.lo <= 0.0 || a.rho.lo <= 0.0 || b.rho.lo <= 0.0 {
        return None;
    }
    let twist_sq = segment.twist(a, b).sqr();
    let k = twist_sq.times(2.0) / facing;
    let mut most = 0.0_f64;
    for i in 0..=PARTS {
        // A power of two: shares are exact.
        let x = i as f64 / PARTS as f64;
        let y = 1.0 - x;
        let short = k * (x * y);
        let chord = a.rho * y + b.rho * x;
        let rho = (chord.sqr() - short).sqrt();
        if rho.lo <= 0.0 {
            return None;
        }
        let sag = short / (chord + rho);
        let d = a.distance * y + b.distance * x + sag * tilt;
        most = most.max(d.mag());
    }
    // Nowhere on the ruling is ρ² less than the least of its chord's squares minus K/4.
    let rho = (Interval::point(a.rho.lo.min(b.rho.lo)).sqr() - k * 0.25).sqrt();
    let rho = Interval::point(rho.lo);
    if rho.lo <= 0.0 {
        return None;
    }
    let sag = (twist_sq * tilt.abs() / (rho * rho.sqr())).hi * (0.125 / (PARTS * PARTS) as f64);
    Some([Interval::point(most).widen(sag).hi, most])
}

mod matching;
pub mod outline;
mod side;

#[cfg(test)]
mod tests;
