//! `net`: the developable through one curve, from its first and last ruling or from its free parameters.
//!
//! Reads like the page that describes it: take the curve as one spline, find all regular nets \[FJ07\], keep the best,
//! have it judged, develop.

mod assessed;
mod error;
mod options;
#[cfg(test)]
mod tests;

use crate::answer::note::NetNote;
use crate::answer::Answer;
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::control::Control;
use crate::design::interpolate::{self, interpolate, EndRulings, InterpolateError, Interpolation, Solution};
use crate::design::loft::net_strip::strip;
use crate::geom::coarse::{is_tolerance, Loose};
use crate::geom::Vec3;
use crate::reason::{Reason, StripReason};
use crate::spline::curve::Curve;
use crate::torse::net::{Net, NetError, Shape, TaperedNet};
use crate::torse::rail::Rail;
use assessed::{assessed, Nets};
pub use error::NetJobError;
pub use options::{Condition, Options};
use std::time::Instant;

/// The developable strip through a curve, judged and developed. It is exactly developable by construction; where the end
/// rulings allow no regular one, the answer has no strips and the status says why.
///
/// *Guarantee.* `Certified` only if the strips' first edge is proven to lie within the tolerance of the curve, their
/// twist is proven to stay below `twist_tolerance`, no ruling meets the regression curve between the edges (proven), and
/// every part has a pattern.
///
/// # Errors
/// See `NetJobError`.
///
/// # Example
/// ```
/// use torse::geom::Vec3;
/// use torse::pipeline::net::Condition;
/// let keel = torse::io::net::read(include_bytes!("../../../../data/keel_net.json"), "keel", None)?;
/// let (first, last) = (keel.first_ruling.ok_or("no ruling")?, keel.last_ruling.ok_or("no ruling")?);
/// let options = torse::Net::new(0.1, first, Condition::LastRuling { direction: last, width: None });
/// let answer = torse::net(&keel.curve, &options, &torse::Control::default())?;
/// assert_eq!(answer.status(), torse::Status::Certified);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn net(curve: &Rail, options: &Options, control: &Control) -> Result<Answer, NetJobError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !is_tolerance(tolerance) {
        return Err(NetJobError::Tolerance(tolerance));
    }
    let name = || curve.name.clone();
    let [from, to] = options.along;
    if !(from < to && from < 1.0 && to > 0.0 && from.is_finite() && to.is_finite()) {
        return Err(NetJobError::Along { curve: name(), along: options.along });
    }
    let spline = |source| NetJobError::Spline { curve: name(), source };
    let Some(given) = curve.as_one().map_err(spline)? else {
        let (piece, turn) = curve.first_corner().unwrap_or((0, 0.0));
        let at = curve.length_to(piece as f64) / curve.length();
        return Err(NetJobError::Corner { curve: name(), at, turn_deg: turn.to_degrees() });
    };
    Loose::check(Rail::extent(&[curve]).max(options.first_ruling.norm()), tolerance)?;
    control.report("looking for nets", 0.2, "");
    let mut answer = match options.condition {
        Condition::LastRuling { direction, width } => by_rulings(&given, curve, direction, width, options)?,
        Condition::Shape { m, kappa } => by_shape(&given, curve, Shape::new((0.0, 1.0), m, kappa), options)?,
        Condition::Stars { lambda_star, m_star } => {
            let shape = Shape::from_stars((0.0, 1.0), lambda_star, m_star)
                .ok_or(NetJobError::Middle { curve: name(), m_star })?;
            by_shape(&given, curve, shape, options)?
        }
    };
    let rail = continued(&given, curve, &mut answer, options)?;
    control.report("judging", 0.6, "");
    let mut built = Vec::new();
    for (k, net) in answer.nets.iter().enumerate() {
        built.push(strip(net, k, options.along).map_err(|e| match e {
            NetError::Spline(source) => NetJobError::Spline { curve: name(), source },
            source => NetJobError::Net { curve: name(), source },
        })?);
    }
    Ok(assessed(&rail, curve, built, answer, options, start))
}

/// Nets that hold the first and the last ruling.
fn by_rulings(
    given: &Curve<4>,
    curve: &Rail,
    direction: Vec3,
    width: Option<f64>,
    options: &Options,
) -> Result<Nets, NetJobError> {
    // Both rulings in units of the first one's length, so that reaches compare.
    let size = options.first_ruling.norm();
    let unit = direction.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    let rulings = EndRulings { start: options.first_ruling, end: unit * size };
    let wanted = interpolate::Options {
        end_reach: width.map(|w| w / size),
        shorten: options.shorten && !options.polynomial,
        rational: !options.polynomial,
        split: !options.polynomial,
        ..interpolate::Options::default()
    };
    let found = interpolate(given, &rulings, &wanted)
        .map_err(|source| NetJobError::Rulings { curve: curve.name.clone(), source })?;
    let mut out = Nets::default();
    let good: Vec<&Solution> = found.candidates.iter().filter(|s| s.is_good()).collect();
    out.claims.push(Claim::count(Counted::Solutions, Subject::Whole, good.len()));
    tell_candidates(&found, size, &mut out.notes);
    let chosen: Vec<Solution> = if options.alternative > 1 {
        let Some(one) = good.get(options.alternative - 1) else {
            let (asked, count) = (options.alternative, good.len());
            return Err(NetJobError::NoAlternative { curve: curve.name.clone(), asked, count });
        };
        out.notes.push(NetNote::Asked { number: options.alternative });
        vec![(*one).clone()]
    } else {
        tell_route(&found, good.len(), size, &mut out);
        found.strips
    };
    if let (Some(first), Some(last)) = (chosen.first(), chosen.last()) {
        let error = chosen.iter().map(|s| s.end_error).fold(0.0, f64::max);
        let measured = |what, value| Claim::measured(what, Subject::Whole, value);
        out.claims.push(measured(What::FirstRuling, first.start_reach * size));
        out.claims.push(measured(What::LastRuling, last.end_reach * size));
        out.claims.push(measured(What::EndRulingError, error.to_degrees()));
    }
    out.nets = chosen.into_iter().map(|s| s.strip).collect();
    Ok(out)
}

/// One line for each polynomial net.
fn tell_candidates(found: &Interpolation, size: f64, notes: &mut Vec<NetNote>) {
    for (k, s) in found.candidates.iter().enumerate() {
        notes.push(NetNote::Candidate {
            number: k + 1,
            shape: *s.strip.net.shape(),
            quality: s.quality(),
            clearance_estimate: s.clearance_estimate,
            last: s.end_reach * size,
        });
    }
}

/// Which answer was taken, and why; `size` (mm) is the width asked for.
fn tell_route(found: &Interpolation, good: usize, size: f64, out: &mut Nets) {
    use interpolate::Status as Found;
    match &found.status {
        Found::Solved(route) => out.notes.push(NetNote::Route { route: *route, good }),
        Found::Shortened(route) => {
            out.notes.push(NetNote::Route { route: *route, good });
            let widths = found.strips.first().map(|s| (s.start_reach * size, size));
            let narrower = widths.map(|(width, asked)| Claim::in_part(StripReason::Narrower { width, asked }));
            out.claims.extend(narrower);
        }
        Found::Unsolved(reasons) => out.missing.push(Reason::error(reasons.as_ref())),
    }
}

/// The net with given parameters.
fn by_shape(given: &Curve<4>, curve: &Rail, shape: Shape, options: &Options) -> Result<Nets, NetJobError> {
    let fault = |source| NetJobError::Net { curve: curve.name.clone(), source };
    let e = options.first_ruling;
    let tangent = crate::torse::rail::tangent(given, 0.0);
    const TANGENT: f64 = 1e-8;
    if e.norm() > 0.0 && tangent.cross(&e).norm() <= TANGENT * e.norm() {
        let source = InterpolateError::Tangent { which: "first", u: 0.0, angle: tangent.cross(&e).norm() / e.norm() };
        return Err(NetJobError::Rulings { curve: curve.name.clone(), source });
    }
    let w = given.control[0][3];
    let net = Net::from_first(given.clone(), [e.x * w, e.y * w, e.z * w, 0.0], shape).map_err(fault)?;
    let last = net.ruling(1.0);
    let mut out = Nets::default();
    out.claims.push(Claim::measured(What::LastRuling, Subject::Whole, (last[1] - last[0]).norm()));
    out.nets.push(TaperedNet { net, taper: (1.0, 1.0) });
    Ok(out)
}

/// The curve over the stretch asked for, as a rail of one piece; nets at its ends are restricted or continued with it.
fn continued(given: &Curve<4>, curve: &Rail, answer: &mut Nets, options: &Options) -> Result<Rail, NetJobError> {
    let [from, to] = options.along;
    let whole = options.along == [0.0, 1.0];
    let spline = |source| NetJobError::Spline { curve: curve.name.clone(), source };
    if !whole {
        let count = answer.nets.len();
        let nets = std::mem::take(&mut answer.nets);
        for (k, net) in nets.into_iter().enumerate() {
            let (a, b) = net.net.domain();
            let (a, b) = (if k == 0 { from } else { a.max(from) }, if k + 1 == count { to } else { b.min(to) });
            if a >= b {
                continue;
            }
            let taper = (net.factor(a), net.factor(b));
            let fault = |source| NetJobError::Net { curve: curve.name.clone(), source };
            answer.nets.push(TaperedNet { net: net.net.over(a, b).map_err(fault)?, taper });
        }
        answer.notes.push(NetNote::Stretch { along: options.along });
    }
    let piece = if whole { given.clone() } else { given.extended(from, to).map_err(spline)? };
    let rail = Rail { name: curve.name.clone(), pieces: vec![piece], closed: whole && curve.closed };
    if whole {
        return Ok(rail);
    }
    Ok(Rail { name: curve.name.clone(), ..Rail::new(&curve.name, &rail.pieces)? })
}
