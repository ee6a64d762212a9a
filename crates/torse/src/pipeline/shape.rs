//! `shape`: strips of splines between curves, pulled by handles, as developable panels.
//!
//! Reads like the page that describes it: set up the composite, settle it, move handles, polish, have it judged, develop.

mod composite;
mod options;
#[cfg(test)]
mod tests;

use crate::answer::note::Note;
use crate::answer::{Answer, Guide, Job};
use crate::certify::claim::{Claim, Counted, Subject, What};
use crate::design::composite::{Composite, Hold, Join, Options as SessionOptions, Session, Smoothness};
use crate::design::loft::build::{classified, BuiltStrip};
use crate::develop::strip::StripOptions;
use crate::geom::coarse::{is_tolerance, Loose};
use crate::geom::{BBox, Vec3};
use crate::io::shape::ShapeFile;
use crate::num::gauss_newton::Status;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::search::strips::cut::laid;
use crate::search::strips::judgement::{judge, Candidate};
use crate::spline::curve::Curve;
use crate::spline::SplineError;
use crate::torse::rail::{Rail, RailPart};
use crate::torse::strip::{homogeneous, Strip};
use crate::Control;
use composite::{between, composite, held};
pub use options::Options;
pub(crate) use options::ShapeError;
use std::time::Instant;

/// Residual of the polish, as a share of the size: some digits beyond what twist is asked for.
const POLISHED: f64 = 1e-11;
/// Points of a guide.
const GUIDE_POINTS: usize = 200;

/// Strips between curves that keep what is held, judged and developed.
///
/// `load` answers the contents of files that targets name.
///
/// *Guarantee.* `Certified` only if the twist of every strip is proven to stay below `twist_tolerance`, no ruling meets the
/// regression curve within a strip (proven), every held place is within the tolerance of its target (measured), fixed
/// curves are proven to be kept within it, and every part has a pattern. Everything else is `Uncertified` with the reason.
///
/// # Errors
/// Anything in the job that does not make sense, with its place: `$.handles[2].curve`.
///
/// # Example
/// ```
/// let job = torse::io::shape::read(include_bytes!("../../../../data/pulled_hull.json"), "hull", None)?;
/// let nothing = |name: &str| Err(format!("no file {name}"));
/// let answer = torse::shape(&job, &torse::Shape::new(0.5), &nothing, &torse::Control::default())?;
/// assert_eq!(answer.patchwork.panels.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn shape(
    job: &ShapeFile,
    options: &Options,
    load: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    control: &Control,
) -> Result<Answer, ShapeError> {
    let start = Instant::now();
    if !is_tolerance(options.tolerance) {
        return Err(ShapeError::Tolerance(options.tolerance));
    }
    let points: Vec<Vec3> = job.curves.iter().flat_map(|c| c.1.control.iter().map(|p| Vec3::from(*p))).collect();
    Loose::check(BBox::of(&points).diagonal(), options.tolerance)?;
    let composite = composite(job, load)?;
    let mut notes = Vec::new();
    let mut session = Session::new(composite, SessionOptions::default())?;
    control.report("settling", 0.1, "");
    let settled = session.settle(control);
    notes.push(Note::Solved { step: None, report: settled });
    for (index, m) in job.moves.iter().enumerate() {
        let source = |source| ShapeError::Move { index, source };
        let from = session.composite().handles.get(m.handle).map(|h| h.hold);
        let to = held(m.point, m.tangent, m.plane);
        let (Some(from), Some(to)) = (from, to) else { continue };
        let mut told = false;
        for k in 1..=m.steps {
            if control.stopped() {
                break;
            }
            session.set_handle(m.handle, between(&from, &to, k as f64 / m.steps as f64)).map_err(source)?;
            let report = session.step(control);
            if report.status != Status::Converged && !std::mem::replace(&mut told, true) {
                notes.push(Note::Solved { step: Some((index, k)), report });
            }
        }
        control.report("moving", 0.1 + 0.5 * (index + 1) as f64 / job.moves.len() as f64, "");
    }
    control.report("polishing", 0.6, "");
    let polished = session.polish(POLISHED, control)?;
    notes.push(Note::Met { residual: polished.residual });
    control.report("judging", 0.7, "");
    judged(&session, options, notes, start)
}

/// Distance of every held place from what it is held to, with the handle's words.
fn off(session: &Session) -> Vec<(String, f64)> {
    let mut out = Vec::new();
    for (k, h) in session.composite().handles.iter().enumerate() {
        let Some(curve) = session.composite().curve(&h.place.curve).and_then(|c| session.curve(c)) else { continue };
        let [p, d, _] = curve.jet(h.place.u).map(Vec3::from);
        let what = format!("handle {k} on {}", h.place.curve);
        match h.hold {
            Hold::Point(target) => out.push((what, (p - target).norm())),
            Hold::Plane { point, normal } => out.push((what, normal.normalize().dot(&(p - point)).abs())),
            // Over the length of the control polygon's side there, a direction is off by so much.
            Hold::Tangent(t) => out.push((what, d.cross(&t.normalize()).norm() / curve.knots.degree() as f64)),
        }
    }
    out
}

/// A strip as the judge takes it, with the fixed curves that it must keep.
struct Made {
    built: BuiltStrip,
    rails: [Option<Rail>; 2],
}

fn made(session: &Session, strip: Strip, index: usize) -> Result<Made, SplineError> {
    let composite = session.composite();
    let linear = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[0.0], [1.0]])?;
    let part = RailPart { piece: 0, parameter: linear };
    let rails = composite.strips[index].sides.each_ref().map(|name| {
        let given = &composite.curves[composite.curve(name)?];
        let rail = given.fixed.then(|| Rail::new(name, &[homogeneous(&given.curve)]).ok()).flatten()?;
        // A fixed curve with corners is no single piece; its control points are kept all the same.
        (rail.pieces.len() == 1).then_some(rail)
    });
    Ok(Made { built: BuiltStrip { strip: classified(strip), rails: [part.clone(), part] }, rails })
}

/// Chains of strips that go on smoothly, as parts that are cut from one sheet.
fn chains(composite: &Composite) -> Vec<Part> {
    let mut out: Vec<Part> = Vec::new();
    for (k, s) in composite.strips.iter().enumerate() {
        let goes_on = k > 0
            && composite.joins.iter().any(|j| {
                matches!(j, Join::Ruling { first, second, smoothness }
                    if *smoothness != Smoothness::G0 && *first == composite.strips[k - 1].name && *second == s.name)
            });
        match out.last_mut() {
            Some(last) if goes_on => last.count += 1,
            _ => out.push(Part::new(&s.name, k, 1)),
        }
    }
    out
}

/// Judges and develops strips.
fn judged(session: &Session, options: &Options, mut notes: Vec<Note>, start: Instant) -> Result<Answer, ShapeError> {
    let strips = session.strips()?;
    let all = strips.into_iter().enumerate().map(|(k, s)| made(session, s, k)).collect::<Result<Vec<_>, _>>()?;
    let pieces: Vec<Candidate> = all
        .iter()
        .enumerate()
        .map(|(index, m)| Candidate { index, built: &m.built, rails: m.rails.each_ref().map(Option::as_ref) })
        .collect();
    let judgement = judge(&pieces, [What::FromSide(0), What::FromSide(1)], options.twist_tolerance);
    let whole = Subject::Whole;
    let mut claims = Vec::new();
    for side in 0..2 {
        if all.iter().any(|m| m.rails[side].is_some()) {
            let reason = format!("the strips stray up to {:.1e} mm from fixed curves", judgement.off[side].value());
            let kept = Claim::at_most(What::FromSide(side), whole, judgement.off[side]);
            claims.push(kept.within(options.tolerance).because(reason));
        }
    }
    let mut missing = judgement.missing.clone();
    for (what, off) in off(session).into_iter().filter(|h| h.1.is_nan() || h.1 > options.tolerance) {
        missing.push(format!("{what} is {off:.4} mm from where it should be; hold less, or move it in steps"));
    }
    let strips: Vec<Strip> = all.into_iter().map(|m| m.built.strip).collect();
    let flat = StripOptions::of_job(options.tolerance, [options.ruling_spacing, options.mark_spacing], options.drawn);
    let laid = laid(&strips, &chains(session.composite()), &flat, options.tolerance);
    notes.extend(laid.crowded.iter().copied().map(Note::Crowded));
    claims.extend(judgement.whole().into_iter().filter(|c| !matches!(c.what(), What::Count(_))));
    claims.push(Claim::count(Counted::Strips, whole, strips.len()));
    claims.extend(laid.claims());
    claims.extend(missing.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.extend(judgement.claims);
    let guides = session.composite().curves.iter().map(|c| {
        let (a, b) = c.curve.domain();
        let at = |k: usize| Vec3::from(c.curve.point(a + (b - a) * k as f64 / GUIDE_POINTS as f64));
        Guide { name: format!("{} as given", c.name), points: (0..=GUIDE_POINTS).map(at).collect() }
    });
    Ok(Answer {
        claims,
        guides: guides.collect(),
        patchwork: Patchwork::of_strips(strips),
        fields: judgement.fields,
        meaning: judgement.meaning,
        notes,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::of_flat(Job::Shape, &options.input, options.tolerance, laid)
    })
}
