//! Cone splines near a developable strip: as few cone pairs as the tolerance asks for.
//!
//! *Method*: rulings of the strip with their tangent planes are joined by the practical cone pairs of \[LP98\], from
//! one forced joint to the next by steps that follow the measured error, which is of order 3
//! (docs/algorithms/cones.md). Where to put the rulings is left open in the paper.

use crate::geom::Vec3;
use crate::torse::cone::distance::{forward_of, Round};
use crate::torse::cone::pair::{cone_pair, ConePair, PairError, PairOptions, ROTATION_LIMIT};
use crate::torse::cone::spline::ConeSpline;
use crate::torse::g1_element::{ElementError, G1Element};
use crate::torse::ruled_patch::{RuledStrip, StripJet};

/// Options of [`cones`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeFitOptions {
    /// Wanted distance, mm; no default.
    pub tolerance: f64,
    /// Wanted distance, along the rulings, of the edges of segments from the boundary of the strip; none, mm.
    pub edges: f64,
    /// Share of the rotation at which junction rulings lie; 1/2.
    pub psi: f64,
    /// Largest rotation within a pair; 2.5 rad.
    pub rotation_limit: f64,
    /// Most pairs; 100 000.
    pub most_pairs: usize,
}

impl ConeFitOptions {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, edges: f64::INFINITY, psi: 0.5, rotation_limit: ROTATION_LIMIT, most_pairs: 100_000 }
    }
}

/// A cone spline near a strip.
#[derive(Clone, Debug, PartialEq)]
pub struct ConeFit {
    /// The chain: two segments for each pair.
    pub spline: ConeSpline,
    /// Rulings of the strip that it takes, one more than pairs: pair k lies between `nodes[k]` and `nodes[k + 1]`.
    pub nodes: Vec<f64>,
    /// Those among the nodes that were forced: inflection rulings and breaks of curvature.
    pub forced: Vec<f64>,
    /// Largest distance measured of the strip from the chain, with 10 % added, mm.
    pub estimate: f64,
}

/// Why no cone spline was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConeFitError {
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive number of mm")]
    Tolerance(f64),
    /// A ruling of the strip that has no direction or no tangent plane.
    #[error("ruling u = {u} of the strip: {source}")]
    Element {
        /// Its parameter.
        u: f64,
        /// Reason.
        source: ElementError,
    },
    /// The regression curve runs through the strip.
    #[error("the regression curve runs through the strip at ruling u = {u}; trim the strip there")]
    Regression {
        /// Parameter of the ruling.
        u: f64,
    },
    /// Steps became too short.
    #[error(
        "no cone pair from ruling u = {u} on, however short ({reason}); is the surface developable and smooth there?"
    )]
    Stuck {
        /// Parameter of the ruling.
        u: f64,
        /// Reason of the last trial.
        reason: String,
    },
    /// Too many.
    #[error("more than {most} cone pairs are needed (ruling u = {u} reached); a larger tolerance needs fewer")]
    TooMany {
        /// The limit.
        most: usize,
        /// Parameter reached.
        u: f64,
    },
}

/// Interior rulings at which a pair is measured.
const RULINGS: usize = 7;
/// Added to measured distances for what lies between these rulings: 3 to 10 % on smooth strips.
const RESERVE: f64 = 1.1;
/// Samples per smooth piece when inflections are sought.
const SCAN: usize = 64;
/// Shortest step, as a share of the domain: where no pair fits, steps would be halved without end.
const SHORTEST: f64 = 1e-7;
/// A remainder shorter than this share of the last step is joined to it.
const REMAINDER: f64 = 0.3;
/// A jump of the curvature across a break beyond this share of it is a forced joint.
const JUMP: f64 = 1e-3;
/// Distance from a break at which both sides are compared, as a share of the domain.
const BESIDE: f64 = 1e-9;
/// Curvature across the rulings below this share of its greatest value is none: plane parts have no inflections.
const NO_BEND: f64 = 1e-9;

/// A ruling with everything that steps need.
#[derive(Clone, Copy)]
struct Station {
    u: f64,
    element: G1Element,
    half: f64,
}

/// A cone spline within the tolerance of a developable strip.
///
/// *Input*: a strip whose rulings all have a direction, developable up to far less than the tolerance, mm.
/// *Guarantee*: smooth joints (rounding); inflection rulings and breaks of curvature are joints; edges pass through
/// the boundary of the strip at every joint and in the middle of every segment. *Not guaranteed*: the distance, which
/// is measured at 7 rulings of a pair; `certify::cones` proves it.
///
/// # Errors
/// See [`ConeFitError`].
/// *Cost*: about 1.3 trials for an accepted pair, some 3 µs each for cheap strips.
pub fn cones(strip: &impl RuledStrip, options: &ConeFitOptions) -> Result<ConeFit, ConeFitError> {
    let tolerance = options.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(ConeFitError::Tolerance(tolerance));
    }
    // 1. Joints that no pair may cross.
    let forced = forced_joints(strip)?;
    let (first, last) = strip.domain();
    let mut fit = ConeFit { spline: ConeSpline::default(), nodes: vec![first], forced: forced.clone(), estimate: 0.0 };
    let shortest = SHORTEST * (last - first);
    let mut from = station(strip, first)?;
    let mut step = last - first;
    // 2. From joint to joint.
    for &goal in forced.iter().chain([&last]) {
        step = step.min(goal - from.u);
        while from.u < goal {
            if fit.nodes.len() > options.most_pairs {
                return Err(ConeFitError::TooMany { most: options.most_pairs, u: from.u });
            }
            let (to, pair, error) = trial(strip, &from, goal, &mut step, shortest, options)?;
            step *= growth(tolerance, error, 0.5, 3.0);
            fit.estimate = fit.estimate.max(error);
            fit.spline.segments.extend(pair.segments);
            fit.nodes.push(to.u);
            from = to;
        }
    }
    Ok(fit)
}

/// A step that is accepted: the ruling reached, the pair and its measured error. `step` is the one to try, and the
/// one taken in the end.
fn trial(
    strip: &impl RuledStrip,
    from: &Station,
    goal: f64,
    step: &mut f64,
    shortest: f64,
    options: &ConeFitOptions,
) -> Result<(Station, ConePair, f64), ConeFitError> {
    // Once a step over a short remainder has failed, the remainder is left.
    let mut absorb = REMAINDER;
    loop {
        let left = goal - from.u;
        let u = if left <= *step * (1.0 + absorb) { goal } else { from.u + *step };
        let to = station(strip, u)?;
        let reason = match between(strip, from, &to, options) {
            Ok(pair) => {
                // Edges count in units of their own tolerance.
                let edges = edges_off(strip, from, &to, &pair, options.edges) * options.tolerance;
                let error = measured(strip, from, &to, &pair)?.max(edges);
                if error <= options.tolerance {
                    *step = u - from.u;
                    return Ok((to, pair, error));
                }
                let tried = u - from.u;
                *step = tried * growth(options.tolerance, error, 0.3, 0.9);
                format!("{error:.3e} mm off")
            }
            Err(reason) => {
                *step = 0.5 * (u - from.u);
                reason.to_string()
            }
        };
        absorb = 0.0;
        if *step <= shortest || step.is_nan() {
            return Err(ConeFitError::Stuck { u: from.u, reason });
        }
    }
}

/// Factor for the next step from the error of the last: order 3.
fn growth(tolerance: f64, error: f64, least: f64, most: f64) -> f64 {
    let f = (0.95 * tolerance / error).cbrt();
    // An error of zero asks for the longest step.
    if f.is_finite() {
        f.clamp(least, most)
    } else {
        most
    }
}

fn station(strip: &impl RuledStrip, u: f64) -> Result<Station, ConeFitError> {
    let jet = strip.jet(u);
    let element = jet.element().map_err(|source| ConeFitError::Element { u, source })?;
    if !jet.speeds(&element).iter().all(|s| *s > 0.0) {
        return Err(ConeFitError::Regression { u });
    }
    Ok(Station { u, element, half: 0.5 * jet.length() })
}

/// The pair between two rulings, its edges through the boundary of the strip at the junction and in the middle of
/// each segment.
fn between(strip: &impl RuledStrip, a: &Station, b: &Station, options: &ConeFitOptions) -> Result<ConePair, PairError> {
    let reach = |s: &Station| [-s.half, s.half];
    let pair_options =
        PairOptions { psi: options.psi, rotation_limit: options.rotation_limit, first: reach(a), second: reach(b) };
    let mut pair = cone_pair(&a.element, &b.element, &pair_options)?;
    let [one, two] = &mut pair.segments;
    let end = one.end();
    let slide = (two.start.point - end.point).dot(&two.start.direction);
    let middles = [one.element(0.5), end, two.element(0.5)];
    for side in 0..2 {
        let mut r = [0.0; 3];
        for (k, g) in middles.iter().enumerate() {
            let guess = a.u + (b.u - a.u) * (k + 1) as f64 / 4.0;
            r[k] = crossing(strip, side, g, guess, (a.u, b.u));
        }
        one.edges[side][1] = r[0];
        one.edges[side][2] = r[1];
        two.edges[side][0] = r[1] - slide;
        two.edges[side][1] = r[2];
    }
    pair.checked()
}

/// Where a boundary curve of the strip passes the normal plane of a ruling: its coordinate along the ruling.
fn crossing(strip: &impl RuledStrip, side: usize, ruling: &G1Element, guess: f64, range: (f64, f64)) -> f64 {
    // Newton's steps from a guess that is good to second order; four are plenty. After one below this share of the
    // range the next would be rounding.
    const SETTLED: f64 = 1e-9;
    let mut u = guess;
    let mut x = strip.jet(u).ends[side];
    for _ in 0..4 {
        let step = forward_of(ruling, &x[0]) / x[1].dot(&ruling.forward);
        if !step.is_finite() {
            break;
        }
        let next = (u - step).clamp(range.0, range.1);
        let moved = (next - u).abs();
        u = next;
        x = strip.jet(u).ends[side];
        if moved < SETTLED * (range.1 - range.0) {
            break;
        }
    }
    (x[0] - ruling.point).dot(&ruling.direction)
}

/// Largest distance of the edges of a pair from the boundary of the strip at the quarters of its segments, as a share of
/// what is allowed; not looked at where everything is.
fn edges_off(strip: &impl RuledStrip, a: &Station, b: &Station, pair: &ConePair, allowed: f64) -> f64 {
    if !allowed.is_finite() {
        return 0.0;
    }
    let mut worst = 0.0_f64;
    for (k, s) in pair.segments.iter().enumerate() {
        for f in [0.25, 0.75] {
            let guess = a.u + (b.u - a.u) * 0.5 * (k as f64 + f);
            let g = s.element(f);
            for side in 0..2 {
                let off = crossing(strip, side, &g, guess, (a.u, b.u)) - s.edge(side, f);
                worst = worst.max(RESERVE * off.abs() / allowed);
            }
        }
    }
    worst
}

/// Largest distance of some rulings of the strip from a pair, with the reserve.
fn measured(strip: &impl RuledStrip, a: &Station, b: &Station, pair: &ConePair) -> Result<f64, ConeFitError> {
    let junction = pair.junction();
    let rounds = pair.segments.map(|s| Round::of(&s));
    let mut worst = 0.0_f64;
    for j in 1..=RULINGS {
        let u = a.u + (b.u - a.u) * j as f64 / (RULINGS + 1) as f64;
        let jet: StripJet = strip.jet(u);
        let [p, q]: [Vec3; 2] = [jet.ends[0][0], jet.ends[1][0]];
        let beyond = [forward_of(&junction, &p) > 0.0, forward_of(&junction, &q) > 0.0];
        for (k, round) in rounds.iter().enumerate() {
            if beyond.contains(&(k == 1)) {
                worst = worst.max(round.largest_on_line(&p, &q));
            }
        }
    }
    if !worst.is_finite() {
        return Err(ConeFitError::Element { u: a.u, source: ElementError::NotFinite("strip") });
    }
    Ok(RESERVE * worst)
}

/// Inflection rulings, and breaks at which the curvature jumps.
fn forced_joints(strip: &impl RuledStrip) -> Result<Vec<f64>, ConeFitError> {
    let (first, last) = strip.domain();
    let bend = |u: f64| -> Result<f64, ConeFitError> {
        let jet = strip.jet(u);
        let g = jet.element().map_err(|source| ConeFitError::Element { u, source })?;
        Ok(jet.bend(&g))
    };
    let mut ends: Vec<f64> = strip.breaks();
    ends.retain(|u| *u > first && *u < last);
    ends.insert(0, first);
    ends.push(last);
    let beside = BESIDE * (last - first);
    let mut joints = Vec::new();
    let mut greatest = 0.0_f64;
    let mut crossings = Vec::new();
    for w in ends.windows(2) {
        let (a, b) = (w[0] + beside, w[1] - beside);
        let mut before = (a, bend(a)?);
        for k in 1..=SCAN {
            let u = a + (b - a) * k as f64 / SCAN as f64;
            let now = (u, bend(u)?);
            greatest = greatest.max(now.1.abs());
            if before.1 * now.1 < 0.0 {
                crossings.push((before, now));
            }
            // A value that is zero is no side: the last one with a sign stays.
            if now.1 != 0.0 || before.1 == 0.0 {
                before = now;
            }
        }
        if w[1] < last {
            let (l, r) = (bend(w[1] - beside)?, bend(w[1] + beside)?);
            if (l - r).abs() > JUMP * l.abs().max(r.abs()) {
                joints.push(w[1]);
            }
        }
    }
    for ((mut a, fa), (mut b, fb)) in crossings {
        if fa.abs().max(fb.abs()) <= NO_BEND * greatest {
            continue;
        }
        for _ in 0..60 {
            let m = 0.5 * (a + b);
            if bend(m)? * fa > 0.0 {
                a = m;
            } else {
                b = m;
            }
        }
        joints.push(0.5 * (a + b));
    }
    joints.sort_by(f64::total_cmp);
    joints.dedup_by(|a, b| *a - *b < 10.0 * beside);
    Ok(joints)
}

#[cfg(test)]
mod tests;
