//! Proof that a cone spline and a developable strip lie within a distance of each other, in both directions.
//!
//! *Method* (docs/algorithms/cones.md): the signed distance from a cone \[LP98\] is evaluated by intervals at the ends
//! of short stretches of the boundary curves, and its second derivative is enclosed between them; along a ruling it is
//! convex, and its deviation from a chord is bounded by the twist of the ruling about the axis. The reverse
//! direction follows from the winding of the boundary's feet around the strip, and the distance between these feet
//! and the edges of the segments. Shares nothing with the fit.

use crate::num::bernstein::Scalar;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::surface::cone_distance::Round;
use crate::surface::cone_spline::{ConeSpline, Segment, Shape};
use crate::surface::g1_element::G1Element;
use crate::surface::ruled_strip::EnclosedStrip;

use super::vector::{cross, dot, exact, scale, sub, V3};

/// Options of [`cones`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeJudgeOptions {
    /// Distance to be proven, mm; no default.
    pub tolerance: f64,
    /// Stretches are halved until what lies between their ends adds no more than this share of the tolerance; 0.05.
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

/// What was proven of a cone spline and a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeProof {
    /// Every point of the strip is within this distance (mm) of the chain; infinite where nothing could be shown.
    pub strip_bound: f64,
    /// Every point of the chain between its edges is within this distance (mm) of the strip.
    pub chain_bound: f64,
    /// Ruling where the bound of the strip is attained.
    pub worst: f64,
    /// A distance that is attained at some point of the strip, mm: more than the tolerance proves failure.
    pub attained: f64,
    /// Largest mismatch at a joint, in rad and as a share of the strip's size: computed, not enclosed.
    pub mismatch: f64,
    /// Stretches examined.
    pub stretches: usize,
}

impl ConeProof {
    /// Whether both directions are proven to stay within a tolerance (mm).
    pub fn holds(&self, tolerance: f64) -> bool {
        self.strip_bound <= tolerance && self.chain_bound <= tolerance
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
/// Rounding of a segment's own points against its exact carrier, as a share of the coordinates: eight operations.
const ROUNDING: f64 = 1e-15;
/// Joints rougher than this are no joints: the wedges of the segments would not meet.
const ROUGH: f64 = 1e-6;

/// Functions of u that bounds are needed of; numbers enclosed at a ruling, or over a stretch with derivatives.
trait Quantity: Scalar {
    fn root(self) -> Self;
}

impl Quantity for Interval {
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Quantity for Jet {
    fn root(self) -> Self {
        self.sqrt()
    }
}

/// A segment prepared: carrier, frame of the middle ruling, edges.
struct Prepared {
    segment: Segment,
    round: Round,
    middle: G1Element,
    /// Unit vector from the axis to the middle of the segment, and across, so that the turn from the middle is
    /// positive as the segment counts it.
    radial: crate::geom::Vec3,
    across: crate::geom::Vec3,
}

/// Distance and edge deviations of both ends of a ruling, for one segment.
struct Measures<S> {
    distance: [S; 2],
    /// det(axis, q_A, q_B): twist of the ruling about the axis.
    twist: S,
    /// Distances of both ends from the axis.
    rho: [S; 2],
    /// q_A·q_B: positive where both ends lie on one side of the axis.
    facing: S,
    /// Foot coordinate minus edge coordinate along the ruling, at both ends.
    edge: [S; 2],
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

    fn measures<S: Quantity>(&self, ends: &[V3<S>; 2]) -> Measures<S> {
        let r = &self.round;
        let (center, axis) = (exact::<S>(&r.center), exact::<S>(&r.axis));
        let plane = r.tilt == 0.0 && matches!(self.segment.shape, Shape::Flat { .. });
        let parts = [0, 1].map(|k| {
            let y = sub(&ends[k], &center);
            let z = dot(&y, &axis);
            (z, sub(&y, &scale(&axis, z)))
        });
        let rho = [0, 1].map(|k| if plane { S::from(1.0) } else { dot(&parts[k].1, &parts[k].1).root() });
        let distance = [0, 1].map(|k| {
            let z = S::from(r.rise) * parts[k].0;
            if r.tilt == 0.0 {
                z
            } else {
                z - S::from(r.tilt) * (rho[k] - S::from(r.radius))
            }
        });
        let twist = if r.tilt == 0.0 { S::from(0.0) } else { dot(&axis, &cross(&parts[0].1, &parts[1].1)) };
        let facing = if r.tilt == 0.0 { S::from(1.0) } else { dot(&parts[0].1, &parts[1].1) };
        let edge = [0, 1].map(|k| self.edge_off(k, parts[k].0, &parts[k].1, rho[k], &ends[k]));
        Measures { distance, twist, rho, facing, edge }
    }

    /// Coordinate along the ruling of the foot of a boundary point, minus that of the edge at the same turn.
    fn edge_off<S: Quantity>(&self, side: usize, z: S, q: &V3<S>, rho: S, x: &V3<S>) -> S {
        let [a, m, b] = self.segment.edges[side];
        let from = S::from;
        if let Shape::Flat { width } = self.segment.shape {
            let y = sub(x, &exact(&self.middle.point));
            let t = (dot(&y, &exact(&self.middle.forward)) * from(2.0)).over(from(width));
            let r = dot(&y, &exact(&self.middle.direction));
            return r - from(m) - t * from(0.5 * (b - a)) - t * t * from(0.5 * (a + b) - m);
        }
        let full = self.segment.shape.angle();
        let (half, wh) = ((0.25 * full).sin(), (0.5 * full).sin());
        let vh = 2.0 * half * half;
        let cosine = dot(q, &exact(&self.radial)).over(rho);
        let sine = dot(q, &exact(&self.across)).over(rho);
        let versine = from(1.0) - cosine;
        match self.segment.shape {
            Shape::Cone { distance: d, cos_gamma, sin_gamma, .. } => {
                let foot = from(cos_gamma) * z + from(d.signum() * sin_gamma) * (rho - from(self.round.radius));
                let tm = d + m;
                let (ga, gb) = (-(a - m) / (d + a), -(b - m) / (d + b));
                let g = sine * from(0.5 * (gb - ga) / wh) + versine * from(0.5 * (ga + gb) / vh);
                foot - from(m) + g * from(tm).over(from(1.0) + g)
            }
            _ => z - from(m) - sine * from(0.5 * (b - a) / wh) - versine * from((0.5 * (a + b) - m) / vh),
        }
    }
}

/// `(x − point)·forward` of a ruling at both ends.
fn ahead<S: Quantity>(g: &G1Element, ends: &[V3<S>; 2]) -> [S; 2] {
    let (o, p) = (exact::<S>(&g.point), exact::<S>(&g.forward));
    [0, 1].map(|k| dot(&sub(&ends[k], &o), &p))
}

/// Enclosure over a stretch (parameter scaled to [0, 1]) from its values at both ends and its jet.
fn over(a: Interval, b: Interval, jet: Jet) -> Interval {
    let bow = jet.dd.mag() * 0.125;
    let tight = a.hull(b).widen(bow);
    if bow.is_finite() {
        tight.intersect(jet.v).unwrap_or(tight)
    } else {
        jet.v
    }
}

/// A bound over a stretch, and what lies between the ends.
#[derive(Clone, Copy)]
struct Stretch {
    strip: f64,
    attained: f64,
    edges: f64,
    surcharge: f64,
}

/// The proof for a cone spline made of pairs between rulings of a strip.
///
/// *Input*: the strip with enclosures; `nodes`, the rulings that the chain takes, one more than pairs (two segments
/// each). *Guarantee*: the bounds hold for the exact carriers (centre, axis, radius, opening as numbers) of the
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
        strip_bound: 0.0,
        chain_bound: 0.0,
        worst: first,
        attained: 0.0,
        mismatch: spline.mismatch(size),
        stretches: 0,
    };
    let mut breaks = strip.breaks();
    breaks.sort_by(f64::total_cmp);
    let mut edges = 0.0_f64;
    for (k, w) in nodes.windows(2).enumerate() {
        let pair = [Prepared::new(&spline.segments[2 * k]), Prepared::new(&spline.segments[2 * k + 1])];
        // Wedges: front of the first ruling, junction, back of the last.
        let planes = [spline.segments[2 * k].start, spline.segments[2 * k + 1].start, spline.segments[2 * k + 1].end()];
        let mut stops = vec![w[0]];
        stops.extend(breaks.iter().copied().filter(|b| *b > w[0] && *b < w[1]));
        stops.push(w[1]);
        let mut stack: Vec<(f64, f64, usize)> = stops.windows(2).rev().map(|s| (s[0], s[1], 0)).collect();
        while let Some((a, b, depth)) = stack.pop() {
            proof.stretches += 1;
            let s = stretch(strip, &pair, &planes, a, b, tolerance);
            let fine = s.surcharge <= options.surcharge * tolerance;
            if !fine && depth < options.depth {
                let m = 0.5 * (a + b);
                stack.push((m, b, depth + 1));
                stack.push((a, m, depth + 1));
                continue;
            }
            if s.strip > proof.strip_bound {
                (proof.strip_bound, proof.worst) = (s.strip, a);
            }
            proof.attained = proof.attained.max(s.attained);
            edges = edges.max(s.edges);
        }
    }
    let reach = spline.segments.iter().map(|s| s.start.point.norm()).fold(size, f64::max);
    let slack = BEHIND * tolerance + ROUNDING * reach;
    proof.strip_bound += slack;
    proof.chain_bound = proof.strip_bound + edges;
    if !(proof.mismatch <= ROUGH && proof.strip_bound.is_finite()) {
        (proof.strip_bound, proof.chain_bound) = (f64::INFINITY, f64::INFINITY);
    }
    Ok(proof)
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
    let nothing = Stretch { strip: f64::INFINITY, attained: 0.0, edges: f64::INFINITY, surcharge: f64::INFINITY };
    let at = |u: f64| strip.enclosure(u, u).map(|c| c[0]);
    let (xa, xb) = (at(a), at(b));
    // Derivatives for the parameter scaled to [0, 1].
    let step = Interval::point(b) - Interval::point(a);
    let jets = strip
        .enclosure(a, b)
        .map(|c| std::array::from_fn(|d| Jet { v: c[0][d], d: c[1][d] * step, dd: c[2][d] * step.sqr() }));
    // 1. In which wedges?
    let sides = |g: &G1Element| -> [Interval; 2] {
        let (l, r, j) = (ahead(g, &xa), ahead(g, &xb), ahead(g, &jets));
        [0, 1].map(|k| {
            // Where the curve moves on steadily, its values lie between those of its ends.
            let ends = l[k].hull(r[k]);
            if j[k].d.sign() != 0 {
                ends
            } else {
                over(l[k], r[k], j[k])
            }
        })
    };
    let behind = BEHIND * tolerance;
    let (front, junction, back) = (sides(&planes[0]), sides(&planes[1]), sides(&planes[2]));
    let outside = (0..2).map(|k| (-front[k].lo).max(back[k].hi)).fold(0.0, f64::max);
    if !(outside <= behind) {
        return Stretch { surcharge: outside, ..nothing };
    }
    let takes = [junction.iter().any(|s| s.lo <= 0.0), junction.iter().any(|s| s.hi >= 0.0)];
    // 2. Distances and edges.
    let mut out = Stretch { strip: 0.0, attained: 0.0, edges: 0.0, surcharge: 0.0 };
    let both = takes[0] && takes[1];
    for (segment, _) in pair.iter().zip(takes).filter(|(_, t)| *t) {
        let (l, r, j) = (segment.measures(&xa), segment.measures(&xb), segment.measures(&jets));
        let mut largest = 0.0_f64;
        for k in 0..2 {
            let ends = l.distance[k].mag().max(r.distance[k].mag());
            let all = over(l.distance[k], r.distance[k], j.distance[k]).mag();
            let (ends_off, all_off) =
                (l.edge[k].mag().max(r.edge[k].mag()), over(l.edge[k], r.edge[k], j.edge[k]).mag());
            largest = largest.max(all);
            out.edges = out.edges.max(all_off);
            out.surcharge = out.surcharge.max(all - ends).max(all_off - ends_off);
            if !both {
                out.attained = out.attained.max(l.distance[k].mig()).max(r.distance[k].mig());
            }
        }
        let sag = if segment.round.tilt == 0.0 {
            0.0
        } else {
            let twist = over(l.twist, r.twist, j.twist);
            let [p, q] = [0, 1].map(|k| over(l.rho[k], r.rho[k], j.rho[k]));
            if over(l.facing, r.facing, j.facing).sign() <= 0 {
                return nothing;
            }
            // Against the chord, ρ falls short by at most δ²/ρ_B, δ = twist/ρ_A the offset of one end from the other's
            // meridian plane.
            let sag = (twist.sqr() / (p.sqr() * q)).hull(twist.sqr() / (p * q.sqr()));
            (sag * segment.round.tilt.abs()).mag()
        };
        if !(sag.is_finite() && largest.is_finite()) {
            return nothing;
        }
        out.surcharge = out.surcharge.max(sag);
        out.strip = out.strip.max(Interval::point(largest).widen(sag).hi);
    }
    if out.edges.is_nan() || out.surcharge.is_nan() {
        return nothing;
    }
    out
}

#[cfg(test)]
mod tests;
