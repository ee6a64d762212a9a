//! The main job: faces in, certified developable panels and flat patterns out.
//!
//! Reads like the page that describes it: cover every face, build the panels as they will be exported, have them
//! judged, cut what is refused, develop the rest.

use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{joints::apart, note::Note, Answer, Job};
use crate::brep::face::Face;
use crate::certify;
use crate::certify::claim::{Claim, Status, Subject};
use crate::control::Control;
use crate::develop::joints::{with_joint_marks, with_marks_across};
use crate::develop::pattern::with_bends;
use crate::develop::view::panels_viewed;
use crate::io::model::Model;
use crate::io::words;
use crate::num::parallel;
use crate::patchwork::panel::{Border, Patchwork};
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::reason::{FaceReason, Item, JobReason, Reason, Unlaid};
use crate::search::all_met::all_met;
use crate::search::apex::{beside_apexes, Hair};
use crate::search::build::{limits_missed, AlongCurve, Built};
use crate::search::cover::CoverOptions;
use crate::search::creased::between_sharp_creases;
use crate::search::face::{edges_between, first_covers, one_face, Covered, Wanted};
use crate::search::smooth::smoothly_joined;
use crate::search::trims::{assess_trims, AssessedTrims};
use checks::{checked, checked_curves, checked_number, told_of_curves};
pub use error::ApproximateError;
pub use options::{Options, SMOOTH_ANGLE_DEG};
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

mod checks;
mod error;
mod options;

/// Time for the proof of flat patterns where a job was asked to stop: these wait until they are proven or not cut.
const FLAT_GRACE: Duration = Duration::from_secs(2);
/// Borders of panels that are joined are each within a tolerance of the file's edge.
const JOINT_REACH: f64 = 2.0;

/// Approximates a model by developable panels; see [`of_faces`].
///
/// # Errors
/// As [`of_faces`].
///
/// # Example
/// ```
/// let plate = include_bytes!("../../../../data/cylinder_holes.step");
/// let answer = torse::approximate(&torse::read(plate)?, &torse::Approximate::new(0.5))?;
/// assert_eq!((answer.status(), answer.parts.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn approximate(model: &Model, options: &Options) -> Result<Answer, ApproximateError> {
    let mut answer = of_faces(model.faces.clone(), model.skipped.clone(), options, &Control::default())?;
    answer.notes.splice(0..0, model.notes.iter().cloned());
    Ok(answer)
}

/// Approximates faces by developable panels within a tolerance.
///
/// *Method.* [`crate::search::cover`] per face, in parallel; panels built by [`crate::fit::panels::boundary`]; the proof by
/// [`certify::patchwork`], which names nothing of the fit; development of every panel.
/// *Guarantee.* The status is [`Status::Certified`] only if the certificate holds for every panel as exported.
/// Ended early by `control`, the answer holds the finest complete cover found, with its bound; ended by `max_panels`, the
/// best panels found. It says why it is not certified.
///
/// # Errors
/// No faces, a tolerance that is not positive or cannot be certified at the size of the model.
pub fn of_faces(
    faces: Vec<Face>,
    mut skipped: Vec<Skipped>,
    options: &Options,
    control: &Control,
) -> Result<Answer, ApproximateError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    checked(&faces, &skipped, options)?;
    let AssessedTrims { faces, missed: untrue, .. } = assess_trims(faces, tolerance);
    let creased = between_sharp_creases(faces, options.smooth_angle, tolerance);
    let told = Note::creased(&creased);
    let faces = smoothly_joined(creased.faces, tolerance, (options.smooth_angle, options.meet), control);
    let faces = beside_apexes(faces, Hair::FINE, tolerance);
    checked_number(&faces, options)?;
    checked_curves(&faces, options)?;
    let (built, flat_time) = covered(faces, options, control);
    let Whole { patchwork, certificates, patterns, along, mut missing } = whole(built, &mut skipped);
    if patchwork.faces.is_empty() {
        let why = skipped.first().map_or(String::new(), words::left_out);
        return Err(ApproximateError::NoFaces(why));
    }
    control.report("judging flat patterns", f64::NAN, format!("{} panels", patchwork.panels.len()));
    let certificate = certify::join(&patchwork, certificates, tolerance);
    let patterns = with_bends(&patchwork, patterns, &options.drawn.bends.of_job(tolerance));
    let patterns = with_marks_across(&patchwork, patterns);
    let patterns = with_joint_marks(&patchwork, patterns, JOINT_REACH * tolerance);
    let missed = limits_missed(&patchwork, &certificate, &patterns, &options.limits);
    missing.extend(missed.reasons);
    // As the proof of the panels, this has its own clock.
    let clock = match control.stopped() {
        true => Control::default().until(Instant::now() + FLAT_GRACE.max(flat_time)),
        false => Control::default(),
    };
    let flat = certify::flat::flat(&patchwork, &patterns, tolerance, &clock);
    // Turned over exactly: what was proven holds for either side.
    let patterns = panels_viewed(&patchwork, patterns, options.drawn.view);
    let bad = patterns.iter().zip(&flat).filter_map(|(p, f)| {
        let reason = f.reason().or(f.open().map(Reason::from))?;
        Some(Claim::objection(Subject::Panel(p.panel), Reason::of(Item::Pattern(p.name.clone()), reason)))
    });
    let refused: Vec<Claim> = bad.collect();
    let mut claims: Vec<Claim> = untrue.into_iter().map(|reason| Claim::objection(Subject::Whole, reason)).collect();
    claims.extend(certificate.claims());
    claims.extend(flat.iter().flat_map(|f| f.claims()));
    claims.extend(refused);
    claims.extend(missing.into_iter().map(|reason| Claim::objection(Subject::Whole, reason)));
    if control.stopped() && Status::of(&claims) == Status::Uncertified {
        let bound = certificate.deviation_bound;
        let reached = Some(bound).filter(|b| *b > tolerance && b.is_finite());
        claims.insert(0, Claim::objection(Subject::Whole, JobReason::EndedEarly(reached)));
    }
    // What was left out on the way counts, whatever is proven of the rest.
    claims.splice(0..0, left_out(&skipped));
    let parts = one_by_one(&patchwork, &patterns);
    let notes =
        told.into_iter().chain(told_of_curves(&options.layout, &along)).chain(apart(&patterns, tolerance)).collect();
    Ok(Answer {
        claims,
        patchwork,
        certificate: Some(certificate),
        parts,
        patterns,
        flat,
        skipped,
        along,
        notes,
        beyond_limits: missed.panels,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::new(Job::Approximate, &options.input, tolerance)
    })
}

/// Panels for every face, on all cores, and what to leave for the proof of their flat patterns.
fn covered(faces: Vec<Face>, options: &Options, control: &Control) -> (Vec<Result<Built, Skipped>>, Duration) {
    let total = faces.len();
    let finished = AtomicUsize::new(0);
    let wanted = Wanted {
        options: CoverOptions {
            tolerance: options.tolerance,
            max_panels: options.max_panels.unwrap_or(usize::MAX),
            facets: false,
            limits: options.limits,
            layout: options.layout.clone(),
        },
        meet: options.meet,
        control,
        between: edges_between(&faces),
        deadline: OnceLock::new(),
    };
    control.report("covering faces", 0.0, format!("0 of {total}"));
    let first = first_covers(&faces, &wanted);
    let found: Vec<Result<Covered, Skipped>> =
        parallel::map(faces.into_iter().zip(first).enumerate(), |(index, (face, first))| {
            let built = if first.is_none() && wanted.is_over() {
                Err(Skipped::in_haste(&face, FaceReason::OutOfTime))
            } else {
                one_face(index, &face, first, &wanted).map_err(|e| Skipped::of_face(&face, Reason::error(&e)))
            };
            let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
            control.report("covering faces", n as f64 / total as f64, format!("{n} of {total}"));
            built
        });
    all_met(found, options.meet.then_some((options.tolerance, &options.limits)), control)
}

/// The panels of all faces.
#[derive(Default)]
struct Whole {
    patchwork: Patchwork,
    certificates: Vec<certify::Certificate>,
    patterns: Vec<Pattern>,
    along: Vec<AlongCurve>,
    missing: Vec<Reason>,
}

/// What was built on faces as one whole; faces without panels are added to `skipped`.
fn whole(built: Vec<Result<Built, Skipped>>, skipped: &mut Vec<Skipped>) -> Whole {
    let mut out = Whole::default();
    for b in built {
        match b {
            Ok(b) => {
                let first = out.patchwork.panels.len();
                out.certificates.push(b.certificate);
                out.patterns.extend(b.patterns.into_iter().map(|p| Pattern { panel: p.panel + first, ..p }));
                out.along.extend(b.along.into_iter().map(|a| AlongCurve { panel: a.panel + first, ..a }));
                out.missing.extend(b.missing);
                out.patchwork.append(b.patchwork);
            }
            Err(s) => skipped.push(s),
        }
    }
    let runs = out.patchwork.panels.iter().flat_map(|p| p.loops().iter().flatten());
    out.patchwork.joint_count = runs.filter(|r| matches!(r.border, Border::Joint { first: true, .. })).count();
    out
}

/// Every panel as a part of its own.
fn one_by_one(patchwork: &Patchwork, patterns: &[Pattern]) -> Vec<Part> {
    let flat: BTreeSet<usize> = patterns.iter().map(|p| p.panel).collect();
    let missing = |k: usize| (!flat.contains(&k)).then_some(Unlaid::Panel);
    let panels = patchwork.panels.iter().enumerate();
    panels.map(|(k, p)| Part { name: p.strip.name.clone(), first: k, count: 1, missing: missing(k) }).collect()
}
