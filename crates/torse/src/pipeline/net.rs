//! `net`: the developable through one curve, from its first and last ruling or from its free parameters.
//!
//! Reads like the page that describes it: take the curve as one spline, find all regular nets \[FJ07\], keep the best,
//! have it judged, develop.

use crate::answer::note::{NetNote, Note};
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, NetNumber, Subject, What};
use crate::control::Control;
use crate::design::interpolate::{self, interpolate, EndRulings, InterpolateError, Interpolation, Solution};
use crate::design::loft::build::{classified, BuiltStrip};
use crate::develop::strip::StripOptions;
use crate::develop::view::Drawn;
use crate::geom::coarse::Loose;
use crate::geom::Vec3;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::search::strips::cut::{claims as flat_claims, crowded, cut, judged as flat_judged};
use crate::search::strips::judgement::{judge, Candidate};
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use crate::torse::form::PanelKind;
use crate::torse::net::{Net, NetError, NetKind, Regularity, Shape, TaperedNet};
use crate::torse::rail::{Rail, RailError, RailPart};
use crate::torse::strip::Strip;
use std::time::Instant;

/// What decides the net besides its curve and first ruling. The curve's parameter runs from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// The last ruling lies on the line in this direction (any length), on this side of the curve.
    LastRuling {
        /// Direction.
        direction: Vec3,
        /// Length of the last ruling, mm; none: it follows from the surface.
        width: Option<f64>,
    },
    /// The free parameters in stable form, see [`Shape`].
    Shape {
        /// `1/(M* − 1/2)`; 0 for cones.
        m: f64,
        /// `(Λ* − M*) m`; 0 for cylinders.
        kappa: f64,
    },
    /// The free parameters of the paper.
    Stars {
        /// Λ*.
        lambda_star: f64,
        /// M*.
        m_star: f64,
    },
}

/// What the job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Distance allowed between strips and curve, mm; no default.
    pub tolerance: f64,
    /// The first ruling, from the curve to the opposite edge, mm; no default.
    pub first_ruling: Vec3,
    /// What else decides; no default.
    pub condition: Condition,
    /// Name of the input for reports.
    pub input: String,
    /// The stretch of the curve that is used; beyond 0 and 1 the surface is continued. Default 0 to 1.
    pub along: [f64; 2],
    /// Which of the regular polynomial solutions, best first, from 1; default 1.
    pub alternative: usize,
    /// Whether only one polynomial net will do, neither rational nor split; default false.
    pub polynomial: bool,
    /// Whether the strip may be made narrower to stay clear of its regression curve; default true.
    pub shorten: bool,
    /// Distance between drawn rulings, mm; default none: 20 over the length.
    pub ruling_spacing: Option<f64>,
    /// Distance between marks on the curve, mm; default none: 8 over the length.
    pub mark_spacing: Option<f64>,
    /// Twist that counts as developable, rad; default 1e-5 (0.0006°).
    pub twist_tolerance: f64,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm), the first ruling (mm) and the condition.
    pub fn new(tolerance: f64, first_ruling: Vec3, condition: Condition) -> Self {
        Self {
            tolerance,
            first_ruling,
            condition,
            input: "net".into(),
            along: [0.0, 1.0],
            alternative: 1,
            polynomial: false,
            shorten: true,
            ruling_spacing: None,
            mark_spacing: None,
            twist_tolerance: 1e-5,
            drawn: Drawn::default(),
        }
    }
}

/// A question about a net that cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetJobError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// The curve has corners.
    #[error(
        "{curve} has a corner of {turn_deg:.3}° at {at:.4} of its length; a net needs a smooth curve: split it there"
    )]
    Corner {
        /// Name.
        curve: String,
        /// Share of the length.
        at: f64,
        /// Turn of the tangent, degrees.
        turn_deg: f64,
    },
    /// The rulings given cannot be used.
    #[error("{curve}: {source}")]
    Rulings {
        /// Name.
        curve: String,
        /// What is wrong.
        source: InterpolateError,
    },
    /// The free parameters do not make a net.
    #[error("{curve}, with the parameter running from 0 to 1: {source}")]
    Net {
        /// Name.
        curve: String,
        /// What is wrong.
        source: NetError,
    },
    /// M* in the middle of the curve, or not finite.
    #[error("{curve}: M* = {m_star} cannot be used: it must be finite, and not the middle of the parameter, which runs from 0 to 1; the surface is regular only with M* and L* both before 0 or both beyond 1")]
    Middle {
        /// Name.
        curve: String,
        /// As given.
        m_star: f64,
    },
    /// There are fewer alternatives than asked for.
    #[error("{curve}: alternative {asked} does not exist; there are {count} regular polynomial solutions")]
    NoAlternative {
        /// Name.
        curve: String,
        /// Number asked for, from 1.
        asked: usize,
        /// Number there are.
        count: usize,
    },
    /// A stretch that is none.
    #[error("{curve}: the stretch from {} to {} must run forwards and hold part of the curve, whose parameter runs from 0 to 1", .along[0], .along[1])]
    Along {
        /// Name.
        curve: String,
        /// As given.
        along: [f64; 2],
    },
    /// The continued curve is no rail.
    #[error(transparent)]
    Rail(#[from] RailError),
    /// A tolerance that is not a positive number.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// A strip could not be stored.
    #[error("{curve}: {source}")]
    Spline {
        /// Name.
        curve: String,
        /// What is wrong.
        source: SplineError,
    },
}

/// Share of the tolerance for lines and arcs of the flat outline.
const CONTOUR_SHARE: f64 = 0.05;

/// The developable strip through a curve, judged and developed. It is exactly developable by construction; where the end
/// rulings allow no regular one, the answer has no strips and the status says why.
///
/// *Guarantee.* `Certified` only if the strips' first edge is proven to lie within the tolerance of the curve, their
/// twist is proven to stay below `twist_tolerance`, no ruling meets the regression curve between the edges (proven), and
/// every part has a pattern.
///
/// # Errors
/// See [`NetJobError`].
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
    if !(tolerance > 0.0 && tolerance.is_finite()) {
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
    Ok(judged(&rail, curve, built, answer, options, start))
}

/// What was found, in the words of the report.
#[derive(Default)]
struct Nets {
    nets: Vec<TaperedNet>,
    claims: Vec<Claim>,
    notes: Vec<NetNote>,
    missing: Vec<String>,
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
        tell_route(&found, good.len(), &mut out);
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

/// Which answer was taken, and why.
fn tell_route(found: &Interpolation, good: usize, out: &mut Nets) {
    use interpolate::Status as Found;
    match &found.status {
        Found::Solved(route) => out.notes.push(NetNote::Route { route: *route, good }),
        Found::Shortened(route) => out.notes.extend([NetNote::Route { route: *route, good }, NetNote::Narrower]),
        Found::Unsolved(reasons) => out.missing.push(reasons.to_string()),
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

/// The strip of a net, and the stretch of the rail that it follows; `along` is the stretch that the rail stands for.
fn strip(net: &TaperedNet, index: usize, along: [f64; 2]) -> Result<BuiltStrip, NetError> {
    let (c, d) = if net.is_constant() {
        let net = net.net.between(0.0, net.taper.0)?;
        (net.curve().clone(), net.opposite())
    } else {
        net.boundaries()?
    };
    for (i, w) in d.control.iter().enumerate().map(|(i, p)| (i, p[3])) {
        if w.is_nan() || w <= 0.0 {
            return Err(NetError::Weight { index: i, weight: w });
        }
    }
    let kind = match net.net.kind() {
        NetKind::Cylinder { .. } => PanelKind::Cylinder,
        NetKind::Cone { .. } => PanelKind::Cone,
        NetKind::Tangent => PanelKind::Torse,
    };
    let strip = Strip::between(&format!("A-{:02}", index + 1), kind, &c, &d)?;
    // Planes have their own name; for the rest the net knows best.
    let seen = classified(strip.clone());
    let strip = if seen.kind == PanelKind::Plane { seen } else { strip };
    let (a, b) = net.net.domain();
    let share = |u: f64| (u - along[0]) / (along[1] - along[0]);
    let linear = |x: f64, y: f64| Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[x], [y]]);
    let part = |x: f64, y: f64| Ok::<_, NetError>(RailPart { piece: 0, parameter: linear(x, y)? });
    let whole = part(share(a).clamp(0.0, 1.0), share(b).clamp(0.0, 1.0))?;
    Ok(BuiltStrip { strip, rails: [whole.clone(), whole] })
}

/// Where the regression curve lies against a strip.
fn tell_regression(name: &str, net: &TaperedNet, notes: &mut Vec<NetNote>) {
    let (a, b) = net.net.domain();
    let at = [net.regression(a), net.regression(b)];
    let strip = name.to_owned();
    if !(at[0].is_finite() && at[1].is_finite()) {
        notes.push(NetNote::NoRegression { strip });
        return;
    }
    let apex = matches!(net.net.kind(), NetKind::Cone { .. });
    notes.push(NetNote::Regression { strip, apex, linear: !apex && net.is_constant(), at });
}

/// Judges and develops strips.
fn judged(
    rail: &Rail,
    given: &Rail,
    built: Vec<BuiltStrip>,
    answer: Nets,
    options: &Options,
    start: Instant,
) -> Answer {
    let Nets { nets, mut claims, mut notes, mut missing } = answer;
    let pieces: Vec<Candidate> =
        built.iter().enumerate().map(|(index, built)| Candidate { index, built, rails: [Some(rail), None] }).collect();
    let judgement = judge(&pieces, [What::FromCurve(0), What::FromCurve(1)], options.twist_tolerance);
    let whole = Subject::Whole;
    for (s, net) in built.iter().zip(&nets) {
        tell_regression(&s.strip.name, net, &mut notes);
        match net.regularity() {
            Regularity::Regular => {}
            Regularity::Regression { u, v } => missing.push(format!(
                "strip {} meets its regression curve on ruling u = {u:.4} at {:.0} % of its length; choose other parameters, or a shorter stretch",
                s.strip.name,
                100.0 * v
            )),
            Regularity::TangentRuling { u } => {
                missing.push(format!("strip {} has a ruling tangent to {} at u = {u:.4}", s.strip.name, given.name));
            }
            Regularity::Weight { index, weight } => {
                missing.push(format!("strip {} has weight {weight:.3} at control point {index}", s.strip.name));
            }
        }
    }
    missing.extend(judgement.missing.iter().filter(|_| missing.is_empty()).cloned().collect::<Vec<_>>());
    let strips: Vec<Strip> = built.into_iter().map(|s| s.strip).collect();
    let flat = StripOptions {
        ruling_spacing: options.ruling_spacing,
        mark_spacing: options.mark_spacing,
        drawn: options.drawn,
        ..StripOptions::new(CONTOUR_SHARE * options.tolerance)
    };
    let chains: Vec<Part> = (!strips.is_empty())
        .then(|| Part { name: "A".into(), first: 0, count: strips.len(), missing: String::new() })
        .into_iter()
        .collect();
    let (parts, patterns) = cut(&strips, &chains, &flat);
    let flat_proof = flat_judged(&strips, &parts, &patterns, options.tolerance);
    let mut notes: Vec<Note> = notes.into_iter().map(Note::Net).collect();
    notes.extend(crowded(&patterns, &flat).into_iter().map(Note::Crowded));
    if let Some(net) = nets.first() {
        let shape = net.net.shape();
        let stars = [(NetNumber::MStar, shape.m_star()), (NetNumber::LambdaStar, shape.lambda_star())];
        let numbers = if shape.m == 0.0 { [(NetNumber::M, 0.0), (NetNumber::Kappa, shape.kappa)] } else { stars };
        claims.extend(numbers.map(|(number, x)| Claim::given(What::NetShape(number), whole, x)));
    }
    if !strips.is_empty() {
        let off = judgement.off[0];
        claims.push(Claim::at_most(What::FromCurve(0), whole, off).within(options.tolerance).because(format!(
            "the strips stray up to {:.4} mm from {}",
            off.value(),
            given.name
        )));
        claims.extend(judgement.whole().into_iter().filter(|c| !matches!(c.what(), What::Count(_))));
    }
    claims.push(Claim::count(Counted::Strips, whole, strips.len()));
    if !parts.is_empty() {
        claims.extend(flat_claims(&parts, &patterns, &flat_proof, options.tolerance));
    }
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(judgement.claims);
    Answer {
        claims,
        patchwork: Patchwork::of_strips(strips),
        fields: judgement.fields,
        meaning: judgement.meaning,
        parts,
        patterns,
        flat: flat_proof,
        guides: vec![Guide { name: given.name.clone(), points: given.samples(200) }],
        notes,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::new(Job::Net, &options.input, options.tolerance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::claim::Status;
    use crate::io::words;
    use crate::spline::knots::Knots;

    /// The worked example of the specification of nets, 250 mm to the unit.
    fn keel() -> Rail {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.3], [2.0, 0.75, 0.6], [3.0, 0.5, 0.5], [4.0, 0.0, 0.125]];
        let knots = Knots::clamped(3, &[0.0, 0.5, 1.0]).expect("knots");
        let control = points.map(|p| [250.0 * p[0], 250.0 * p[1], 250.0 * p[2], 1.0]).to_vec();
        Rail::new("keel", &[Curve { knots, control }]).expect("rail")
    }

    fn first() -> Vec3 {
        Vec3::new(62.5, 250.0, 0.0)
    }

    fn last(x: f64, y: f64, z: f64, width: Option<f64>) -> Condition {
        Condition::LastRuling { direction: Vec3::new(x, y, z), width }
    }

    fn made(options: &Options) -> Answer {
        net(&keel(), options, &Control::default()).expect("an answer")
    }

    fn figure(s: &Answer, name: &str) -> f64 {
        let curves: Vec<String> = s.guides.iter().map(|g| g.name.clone()).collect();
        s.claims_of(Subject::Whole).find(|c| words::name(c, &curves) == name).map_or(f64::NAN, Claim::value)
    }

    #[test]
    fn the_worked_example_is_certified_with_its_numbers() {
        let s = made(&Options::new(1e-3, first(), last(-0.25, 1.0, 0.125, None)));
        assert_eq!(s.status(), Status::Certified, "{:?}", s.claims);
        assert!((figure(&s, "M*") - 1.369_415_885_318_557_6).abs() < 1e-9);
        assert!((figure(&s, "Λ*") - 1.362_462_674_853_677_2).abs() < 1e-9);
        assert!(figure(&s, "from keel") < 1e-9 && figure(&s, "twist, bound") < 1e-8);
        let told = |n: &Note| matches!(n, Note::Net(NetNote::Regression { at, .. }) if (at[0] - 196.9473).abs() < 1e-4);
        assert!(s.notes.iter().any(told), "{:?}", s.notes);
        let end = s.patchwork.panels[0].strip.ruling(1.0)[1];
        let expected = Vec3::new(3.994_013_734_506_109, 0.023_945_061_975_563, 0.127_993_132_746_945) * 250.0;
        assert!((end - expected).norm() < 1e-6, "{end}");
        let both = made(&Options::new(1e-3, first(), last(-0.25, 1.0, 0.125, Some(200.0))));
        let r = both.patchwork.panels[0].strip.ruling(1.0);
        assert!(both.status() == Status::Certified && ((r[1] - r[0]).norm() - 200.0).abs() < 1e-9);
    }

    #[test]
    fn free_parameters_make_tangent_surfaces_cones_and_cylinders() {
        for (condition, kind) in [
            (Condition::Stars { m_star: 1.5, lambda_star: 1.4 }, PanelKind::Torse),
            (Condition::Shape { m: 0.0, kappa: 0.3 }, PanelKind::Cone),
            (Condition::Shape { m: 0.0, kappa: 0.0 }, PanelKind::Cylinder),
        ] {
            for along in [[0.0, 1.0], [-0.05, 1.1], [0.2, 0.7]] {
                let s = made(&Options { along, ..Options::new(1e-3, first(), condition) });
                assert_eq!((s.status(), s.patchwork.panels[0].strip.kind), (Status::Certified, kind), "{along:?}");
                assert!(figure(&s, "from keel") < 1e-8, "{along:?} {:?}", s.claims);
                let end = keel().pieces[0].extended(-1.0, 2.0).expect("curve").point(along[1]);
                assert!((s.patchwork.panels[0].strip.ruling(1.0)[0] - Vec3::new(end[0], end[1], end[2])).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn what_has_no_regular_answer_says_why_and_has_no_strips() {
        let s = made(&Options { polynomial: true, ..Options::new(1e-3, first(), last(0.0, -1.0, 0.5, None)) });
        assert_eq!(s.status(), Status::Uncertified);
        let reason = words::reason(&s.claims, &[]);
        assert!(reason.contains("pattern ++++") && s.patchwork.panels.is_empty() && s.patterns.is_empty(), "{reason}");
        let s = made(&Options::new(1e-3, first(), Condition::Stars { m_star: 0.7, lambda_star: 1.4 }));
        assert_eq!(s.status(), Status::Uncertified);
        let reason = words::reason(&s.claims, &[]);
        assert!(reason.contains("u = 0.7000"), "{reason}");
    }

    #[test]
    fn questions_that_cannot_be_asked_name_the_curve_and_the_place() {
        let told = |curve: &Rail, options: &Options| {
            net(curve, options, &Control::default()).expect_err("refused").to_string()
        };
        let usual = Options::new(1e-3, first(), last(-0.25, 1.0, 0.125, None));
        let tangent = Vec3::new(250.0, 125.0, 75.0);
        for (options, words) in [
            (Options { first_ruling: tangent, ..usual.clone() }, ["keel: the first ruling is tangent", "u = 0"]),
            (Options { first_ruling: Vec3::zeros(), ..usual.clone() }, ["keel: the first ruling", "no direction"]),
            (
                Options { condition: last(0.0, 0.0, 0.0, None), ..usual.clone() },
                ["keel: the last ruling", "no direction"],
            ),
            (
                Options { condition: last(250.0, -125.0, -93.75, None), ..usual.clone() },
                ["last ruling is tangent", "u = 1"],
            ),
            (
                Options { condition: Condition::Stars { m_star: 0.5, lambda_star: 2.0 }, ..usual.clone() },
                ["keel: M* = 0.5", "middle"],
            ),
            (Options { condition: Condition::Shape { m: f64::NAN, kappa: 1.0 }, ..usual.clone() }, ["keel", "finite"]),
            (Options { along: [0.7, 0.2], ..usual.clone() }, ["keel", "from 0.7 to 0.2"]),
            (Options { tolerance: 0.0, ..usual.clone() }, ["tolerance", "0"]),
            (Options { alternative: 4, ..usual.clone() }, ["alternative 4", "there are 1"]),
            (
                Options { condition: Condition::Shape { m: 2.0, kappa: 1.0 }, first_ruling: tangent, ..usual.clone() },
                ["keel", "first ruling is tangent"],
            ),
        ] {
            let e = told(&keel(), &options);
            assert!(words.iter().all(|w| e.contains(w)), "{e}");
        }
        // M* on a knot: u = 1/4 of a curve with a knot there.
        let knots = Knots::clamped(2, &[0.0, 0.25, 1.0]).expect("knots");
        let control = (0..4).map(|i| f64::from(i) * 100.0).map(|x| [x, 0.002 * x * x, 0.0, 1.0]).collect();
        let curve = Rail::new("c", &[Curve { knots, control }]).expect("rail");
        let stars = Condition::Stars { m_star: 0.25, lambda_star: 2.0 };
        let e = told(&curve, &Options { condition: stars, ..usual.clone() });
        assert!(e.contains("c, ") && e.contains("M* = 0.25 lies on knot"), "{e}");
        let bent =
            Rail::polyline("bent", &[Vec3::zeros(), Vec3::x() * 10.0, Vec3::new(10.0, 30.0, 0.0)]).expect("rail");
        let e = told(&bent, &usual);
        assert!(e.contains("bent has a corner of 90.000° at 0.2500"), "{e}");
    }
}
