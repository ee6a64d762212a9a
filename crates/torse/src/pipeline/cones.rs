//! The job of `torse cones`: ruled developable faces (or the panels of a patchwork) as chains of exact cones,
//! cylinders and planes, with their proof and their flat patterns of true arcs.

mod flat;
mod options;
#[cfg(test)]
mod tests;

use crate::answer::note::Note;
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{Answer, Cones, Job};
use crate::brep::body::SMOOTH;
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Counted, Subject, UpperBound, What};
use crate::certify::flat::cone_parts;
use crate::certify::trims::trim_proof;
use crate::control::Control;
use crate::geom::coarse::{is_tolerance, Loose};
use crate::geom::BBox;
use crate::io::words;
use crate::patchwork::panel::Patchwork;
use crate::reason::{FaceReason, Item, JobReason, Reason, StripReason};
use crate::search::apex::{beside_apexes, Hair};
use crate::search::creased::between_sharp_creases;
use crate::search::strips::cone_body::{body, Proven, Target};
use crate::search::strips::cone_outline::PlaneOutline;
use crate::search::strips::cone_strip::{bent_tip, ruled, strip_of};
use crate::search::strips::cut::{lengths, refused};
use crate::search::trims::{assess_trims, AssessedTrims, TRIM_AIM};
use crate::torse::cone::part::ConeBody;
use crate::torse::strip::Strip;
pub(crate) use flat::counts;
use flat::strips_of;
pub use options::ConesOptions;
use std::time::Instant;

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConesJobError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive number of mm")]
    Tolerance(f64),
    /// Nothing to be approximated.
    #[error("none of the {count} faces is a ruled developable surface; the first: {reason}")]
    Nothing {
        /// Number of faces.
        count: usize,
        /// Why the first is not.
        reason: String,
    },
}

/// Faces as cone splines. Faces that are not ruled developables are listed as skipped.
///
/// The chain covers the strip between the least and the greatest parameters of a face's trim; holes and edges that do
/// not follow the strip are cut from it.
///
/// # Errors
/// See [`ConesJobError`].
///
/// # Example
/// ```
/// let chute = torse::read(include_bytes!("../../../../data/cone_holes.step"))?;
/// let options = torse::ConesOptions::new(0.5, "chute");
/// let answer = torse::cones(&chute.faces, &chute.skipped, &options, &torse::Control::default())?;
/// assert_eq!(answer.status(), torse::Status::Certified);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn of_faces(
    faces: &[Face],
    skipped: &[Skipped],
    options: &ConesOptions,
    control: &Control,
) -> Result<Answer, ConesJobError> {
    let boxes: Vec<BBox> = faces.iter().map(|f| f.surface.bbox()).collect();
    Loose::check(BBox::of(boxes.iter().flat_map(|b| [&b.min, &b.max])).diagonal(), options.tolerance)?;
    let mut targets = Vec::new();
    let AssessedTrims { faces, bound, missed } = assess_trims(faces.to_vec(), options.tolerance);
    let faces = beside_apexes(faces, Hair::OF_CONES, options.tolerance);
    // Where a tip was cut off, more is missed than the trims are off.
    let bound = faces.iter().map(|f| trim_proof(f, TRIM_AIM * options.tolerance).bound()).fold(bound, UpperBound::max);
    let creased = between_sharp_creases(faces, SMOOTH, options.tolerance);
    let told = Note::creased(&creased);
    let faces = creased.faces;
    let mut left = skipped.to_vec();
    let before = left.len();
    for (i, face) in faces.iter().enumerate() {
        let name = if face.name.is_empty() { format!("F{:02}", i + 1) } else { face.name.clone() };
        let found = ruled(face, options.tolerance);
        match found.and_then(|f| bent_tip(&f.0, &f.1).map_or(Ok(f), Err)) {
            Ok((strip, outline)) => targets.push(Target { name, strip, outline }),
            Err(reason) => left.push(Skipped::of_face(face, Reason::of(Item::Named(name), reason))),
        }
    }
    if !is_tolerance(options.tolerance) {
        return Err(ConesJobError::Tolerance(options.tolerance));
    }
    if targets.is_empty() {
        let reason = left.get(before).map_or_else(|| "no faces".into(), words::left_out);
        return Err(ConesJobError::Nothing { count: faces.len(), reason });
    }
    // What trims miss of the file's edges is part of the tolerance where it fits in, and named where it does not.
    let trim = Trim { bound, fits: missed.is_empty() };
    let skipped = left.clone();
    let mut out = run(&targets, skipped, options, control, Some(trim))?;
    out.claims.extend(missed.into_iter().map(|reason| Claim::objection(Subject::Whole, reason)));
    out.claims.extend(left_out(&left));
    out.notes.extend(told);
    Ok(out)
}

/// The panels of a patchwork as cone splines, cut along their outlines. `skipped` are the faces that have no panels.
///
/// # Errors
/// See [`ConesJobError`].
pub fn of_panels(
    patchwork: &Patchwork,
    skipped: &[Skipped],
    options: &ConesOptions,
    control: &Control,
) -> Result<Answer, ConesJobError> {
    let mut targets = Vec::new();
    let mut left = Vec::new();
    for panel in &patchwork.panels {
        let outline = PlaneOutline::of_panel(panel);
        match strip_of(&outline) {
            Some(strip) => targets.push(Target { name: panel.strip.name.clone(), strip, outline }),
            None => {
                left.push(Reason::of(Item::Named(panel.strip.name.clone()), FaceReason::OutlineLeaves).into());
            }
        }
    }
    if targets.is_empty() {
        let reason = left.first().map_or_else(|| "no panels".into(), words::left_out);
        return Err(ConesJobError::Nothing { count: patchwork.panels.len(), reason });
    }
    let missing =
        left.first().map(|l| FaceReason::PanelsLeftOut { count: left.len(), first: Box::new(l.reason.clone()) });
    let mut out = run(&targets, left, options, control, None)?;
    out.claims.extend(missing.map(Claim::left_out));
    out.claims.extend(left_out(skipped));
    out.skipped.extend(skipped.iter().cloned());
    Ok(out)
}

/// What the trims of faces keep from the file's edges.
#[derive(Clone, Copy)]
struct Trim {
    bound: UpperBound,
    /// Whether every face's distance fits into the tolerance, of which it takes its part.
    fits: bool,
}

fn run(
    targets: &[Target],
    left: Vec<Skipped>,
    options: &ConesOptions,
    control: &Control,
    trim: Option<Trim>,
) -> Result<Answer, ConesJobError> {
    if !is_tolerance(options.tolerance) {
        return Err(ConesJobError::Tolerance(options.tolerance));
    }
    let started = Instant::now();
    let rest = options.tolerance - trim.filter(|t| t.fits).map_or(0.0, |t| t.bound.value());
    let mut answer = Answer { skipped: left, ..Answer::new(Job::Cones, &options.input, options.tolerance) };
    let (mut bodies, mut pieces): (Vec<ConeBody>, Vec<(usize, usize)>) = (Vec::new(), Vec::new());
    let mut all: Vec<Proven> = Vec::new();
    let mut failures = Vec::new();
    for (i, target) in targets.iter().enumerate() {
        let told = |reason: Reason| Reason::of(Item::Named(target.name.clone()), reason);
        control.report("cones", i as f64 / targets.len() as f64, target.name.clone());
        if control.stopped() {
            failures.push(JobReason::StoppedCones.into());
            break;
        }
        let (body, proven) = match body(target, rest) {
            Ok(made) => made,
            Err(reason) => {
                answer.skipped.push(told(reason).into());
                failures.push(told(StripReason::NoCones.into()));
                continue;
            }
        };
        if let Some(reason) = &proven.missing {
            answer.skipped.push(told(reason.clone().into()).into());
            failures.push(told(StripReason::NoProof.into()));
        } else if proven.bound.value() > rest {
            failures.push(told(StripReason::Beyond(proven.bound.value()).into()));
        }
        let before = answer.skipped.len();
        for piece in strips_of(&mut answer, &body, &proven, &options.drawn) {
            pieces.push((bodies.len(), piece));
        }
        if answer.skipped.len() > before {
            failures.push(told(StripReason::NotComplete.into()));
        }
        all.push(proven);
        bodies.push(body);
    }
    let whole = Subject::Whole;
    let mut claims = claims(&bodies, &all, trim, options.tolerance);
    let strips: Vec<Strip> = answer.strips().cloned().collect();
    answer.flat = cone_parts((&bodies, &pieces), &strips, &answer.parts, &answer.patterns, options.tolerance);
    claims.extend(lengths(&answer.patterns, &answer.flat));
    failures.extend(refused(&answer.parts, &answer.patterns, &answer.flat, options.tolerance));
    claims.extend(failures.into_iter().map(|reason| Claim::objection(whole, reason)));
    claims.append(&mut answer.claims);
    answer.claims = claims;
    answer.notes.push(Note::ExactFaces);
    answer.seconds = started.elapsed().as_secs_f64();
    answer.cones = Some(Cones { bodies, pieces });
    Ok(answer)
}

/// What is proven and counted of all chains.
fn claims(bodies: &[ConeBody], all: &[Proven], trim: Option<Trim>, tolerance: f64) -> Vec<Claim> {
    let counts = counts(bodies);
    let whole = Subject::Whole;
    let cones = UpperBound::largest(all.iter().map(|p| p.bound));
    let both = trim.map_or(cones, |t| cones.plus(t.bound));
    let mut claims = vec![
        Claim::count(Counted::Surfaces, whole, bodies.len()),
        Claim::count(Counted::Cones, whole, counts[0]),
        Claim::count(Counted::Cylinders, whole, counts[1]),
        Claim::count(Counted::Planes, whole, counts[2]),
        Claim::at_most(What::Deviation, whole, both).within(tolerance),
        Claim::measured(What::JointMismatch, whole, all.iter().map(|p| p.joint).fold(0.0, f64::max)),
    ];
    claims.extend(trim.map(|t| Claim::at_most(What::TrimDistance, whole, t.bound)));
    let trimmed: Vec<[UpperBound; 2]> = all.iter().filter_map(|p| p.trimmed).collect();
    for (k, what) in [What::OutlineDistance, What::EdgeDistance].into_iter().enumerate() {
        if !trimmed.is_empty() {
            claims.push(Claim::at_most(what, whole, UpperBound::largest(trimmed.iter().map(|t| t[k]))));
        }
    }
    claims
}
