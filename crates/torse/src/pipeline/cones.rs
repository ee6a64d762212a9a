//! The job of `torse cones`: ruled developable faces (or the panels of a patchwork) as chains of exact cones,
//! cylinders and planes, with their proof and their flat patterns of true arcs.

use super::approximate::left_face;
use crate::answer::note::Note;
use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{Answer, Cones, Job};
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Counted, Subject, UpperBound, What};
use crate::certify::cones::outline::{astray_bound, outline as certified, Region};
use crate::certify::cones::{cones as judge, ConeJudgeOptions, ConeProof};
use crate::certify::flat::cone_parts;
use crate::control::Control;
use crate::develop::cone_part::{overlaps as part_overlaps, part_pattern};
use crate::develop::cones::{cone_pattern, overlaps};
use crate::develop::view::cones_viewed;
use crate::fit::elements::cones::{cones as fit, ConeFit, ConeFitOptions};
use crate::fit::panels::cone_trim::{cone_part, ConeTrimOptions};
use crate::geom::coarse::Loose;
use crate::geom::BBox;
use crate::patchwork::panel::Patchwork;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::search::strips::cone_outline::PlaneOutline;
use crate::search::strips::cone_strip::{ruled, strip_of};
use crate::search::strips::cut::{lengths, refused};
use crate::search::trims::{trims_judged, TrimsJudged};
use crate::torse::cone::forms::patches;
use crate::torse::cone::part::ConeBody;
use crate::torse::cone::spline::{ConeSpline, Segment};
use crate::torse::form::PanelKind;
use crate::torse::ruled_patch::{RuledPatch, RuledStrip};
use crate::torse::strip::Strip;
use std::time::Instant;

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct ConesOptions {
    /// Distance allowed between surface and cones, both ways, mm.
    pub tolerance: f64,
    /// Name of the input, for the files.
    pub input: String,
}

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

/// The tolerance of the fit against that of the job: the proof of the way back adds to the distance fitted.
const SHARES: [f64; 5] = [0.76, 0.6, 0.45, 0.3, 0.15];
/// Distance allowed to edges, as a share of that of the surface: both add up in the proof.
const EDGES: f64 = 0.25;
/// Contours stay within this share of the tolerance.
const CONTOUR_SHARE: f64 = 0.1;
/// Parts that fall together in the plane are apart in space by more than this share of the size.
const APART: f64 = 1e-3;

/// Distance (mm) asked for between trimmed edges and the exact surfaces: CAD systems take less for none. What is reached
/// is proven.
pub(super) const EDGE_ROUNDING: f64 = 5e-7;
/// Distance allowed between the outline and trimmed edges, as a share of the tolerance.
const OUTLINE_SHARE: f64 = 0.02;
/// Largest turn of a segment in files, rad.
const LARGEST_TURN: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

/// Something to be approximated.
struct Target {
    name: String,
    strip: RuledPatch,
    outline: PlaneOutline,
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
/// let options = torse::ConesOptions { tolerance: 0.5, input: "chute".into() };
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
    let TrimsJudged { faces, bound, missed } = trims_judged(faces.to_vec(), options.tolerance);
    let mut left = skipped.to_vec();
    let before = left.len();
    for (i, face) in faces.iter().enumerate() {
        let name = if face.name.is_empty() { format!("F{:02}", i + 1) } else { face.name.clone() };
        match ruled(face, options.tolerance) {
            Ok((strip, outline)) => targets.push(Target { name, strip, outline }),
            Err(reason) => left.push(left_face(face, format!("{name}: {reason}"))),
        }
    }
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(ConesJobError::Tolerance(options.tolerance));
    }
    if targets.is_empty() {
        let reason = left.get(before).map_or("no faces".into(), Skipped::words);
        return Err(ConesJobError::Nothing { count: faces.len(), reason });
    }
    // What trims miss of the file's edges is part of the tolerance where it fits in, and named where it does not.
    let trim = Trim { bound, fits: missed.is_empty() };
    let skipped = left.clone();
    let mut out = run(&targets, skipped, options, control, Some(trim))?;
    out.claims.extend(missed.into_iter().map(|reason| Claim::objection(Subject::Whole, reason)));
    out.claims.extend(left_out(&left));
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
            None => left.push(Skipped::from(format!("{}: its outline leaves the patch", panel.strip.name))),
        }
    }
    if targets.is_empty() {
        let reason = left.first().map_or_else(|| "no panels".into(), Skipped::words);
        return Err(ConesJobError::Nothing { count: patchwork.panels.len(), reason });
    }
    let missing = left.first().map(|l| format!("{} panels are left out, the first {}", left.len(), l.words()));
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
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(ConesJobError::Tolerance(options.tolerance));
    }
    let started = Instant::now();
    let rest = options.tolerance - trim.filter(|t| t.fits).map_or(0.0, |t| t.bound.value());
    let mut answer = Answer { skipped: left, ..Answer::new(Job::Cones, &options.input, options.tolerance) };
    let (mut bodies, mut pieces): (Vec<ConeBody>, Vec<(usize, usize)>) = (Vec::new(), Vec::new());
    let mut all: Vec<Proven> = Vec::new();
    let mut failures = Vec::new();
    for (i, target) in targets.iter().enumerate() {
        control.report("cones", i as f64 / targets.len() as f64, target.name.clone());
        if control.stopped() {
            failures.push("stopped before all surfaces were done".to_owned());
            break;
        }
        let (body, proven) = match body(target, rest) {
            Ok(made) => made,
            Err(reason) => {
                answer.skipped.push(format!("{}: {reason}", target.name).into());
                failures.push(format!("{} has no cone spline", target.name));
                continue;
            }
        };
        if let Some(reason) = &proven.missing {
            answer.skipped.push(format!("{}: {reason}", target.name).into());
            failures.push(format!("{} has no proof for its outline", target.name));
        } else if proven.bound.value() > rest {
            failures.push(format!(
                "{} is not proven to stay within the tolerance (bound {:.3e} mm)",
                target.name,
                proven.bound.value()
            ));
        }
        let before = answer.skipped.len();
        for piece in strips_of(&mut answer, &body, &proven) {
            pieces.push((bodies.len(), piece));
        }
        if answer.skipped.len() > before {
            failures.push(format!("{} is not complete", target.name));
        }
        all.push(proven);
        bodies.push(body);
    }
    let counts = counts(&bodies);
    let whole = Subject::Whole;
    let cones = UpperBound::largest(all.iter().map(|p| p.bound));
    let both = trim.map_or(cones, |t| cones.plus(t.bound));
    let mut claims = vec![
        Claim::count(Counted::Surfaces, whole, bodies.len()),
        Claim::count(Counted::Cones, whole, counts[0]),
        Claim::count(Counted::Cylinders, whole, counts[1]),
        Claim::count(Counted::Planes, whole, counts[2]),
        Claim::at_most(What::Deviation, whole, both).within(options.tolerance),
        Claim::measured(What::JointMismatch, whole, all.iter().map(|p| p.joint).fold(0.0, f64::max)),
    ];
    claims.extend(trim.map(|t| Claim::at_most(What::TrimDistance, whole, t.bound)));
    let trimmed: Vec<[UpperBound; 2]> = all.iter().filter_map(|p| p.trimmed).collect();
    for (k, what) in [What::OutlineDistance, What::EdgeDistance].into_iter().enumerate() {
        if !trimmed.is_empty() {
            claims.push(Claim::at_most(what, whole, UpperBound::largest(trimmed.iter().map(|t| t[k]))));
        }
    }
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

/// What is proven of one chain.
#[derive(Clone, Debug, PartialEq)]
struct Proven {
    /// Distance between surface and cones, both ways.
    bound: UpperBound,
    /// Mismatch at joints, computed.
    joint: f64,
    /// Trimmed edges: way from the outline carried over, and distance from the exact surfaces; none for whole chains.
    trimmed: Option<[UpperBound; 2]>,
    /// Why the outline is not proven.
    missing: Option<String>,
}

/// The chain of one surface, cut along its outline, and its proof.
fn body(target: &Target, tolerance: f64) -> Result<(ConeBody, Proven), String> {
    let (found, proof) = approximated(target, tolerance)?;
    let name = target.name.clone();
    let unmerged = found.spline.with_turns_below(LARGEST_TURN);
    let joint = proof.mismatch();
    let whole = |spline: ConeSpline, bound: UpperBound, missing: Option<String>| {
        let proven = Proven { bound, joint, trimmed: None, missing };
        (ConeBody { name: name.clone(), spline, part: None }, proven)
    };
    if let Some(share) = target.outline.strays_from_rectangle() {
        let (spline, proof) = match unmerged.has_circular_edges() {
            true => merged(target, &found, proof, tolerance),
            false => (unmerged, proof),
        };
        return Ok(whole(spline, proof.bound().plus(astray_bound(&target.outline.surface, share)), None));
    }
    // Trimmed edges replace those of the chain, so that its bounds hold for what lies between them.
    let (spline, proof) = merged(target, &found, proof, tolerance);
    let outline = target.outline.in_space(&found.nodes);
    let wanted = ConeTrimOptions { outline: OUTLINE_SHARE * tolerance, edge: EDGE_ROUNDING };
    let part = match cone_part(&spline, &outline, &wanted) {
        Ok(part) => part,
        Err(e) => return Ok(whole(spline, proof.bound(), Some(format!("its outline is not cut, it is a blank: {e}")))),
    };
    let region = Region { patch: &target.outline.surface, strip: &target.strip, loops: &target.outline.curves };
    let proven = match certified(&region, &part, &spline, &proof, tolerance) {
        Ok(shown) => Proven {
            bound: shown.bound(),
            joint: proof.mismatch(),
            trimmed: Some([shown.path_bound(), shown.edge_bound()]),
            missing: None,
        },
        Err(fault) => {
            let missing = Some(format!("nothing is proven of its outline: {fault}"));
            Proven { bound: UpperBound::UNKNOWN, joint: proof.mismatch(), trimmed: None, missing }
        }
    };
    Ok((ConeBody { name, spline, part: Some(part) }, proven))
}

/// Fit and proof; the fit aims lower until the proof of both directions holds.
fn approximated(target: &Target, tolerance: f64) -> Result<(ConeFit, ConeProof), String> {
    let mut best: Option<(ConeFit, ConeProof)> = None;
    for share in SHARES {
        let wanted = ConeFitOptions { edges: EDGES * share * tolerance, ..ConeFitOptions::new(share * tolerance) };
        let found = fit(&target.strip, &wanted).map_err(|e| e.to_string());
        let found = match (found, best.take()) {
            (Ok(found), _) => found,
            (Err(_), Some(earlier)) => return Ok(earlier),
            (Err(reason), None) => return Err(reason),
        };
        let proof = judge(&target.strip, &found.nodes, &found.spline, &ConeJudgeOptions::new(tolerance))
            .map_err(|e| e.to_string())?;
        let done = proof.holds(tolerance);
        best = Some((found, proof));
        if done {
            break;
        }
    }
    best.ok_or_else(|| "nothing was tried".into())
}

/// The chain with segments on one carrier made one. These carriers are not those that were judged, to the last digit:
/// they are judged again, and stay apart where they do not hold.
fn merged(target: &Target, found: &ConeFit, proof: ConeProof, tolerance: f64) -> (ConeSpline, ConeProof) {
    let size = target.strip.jet(target.strip.domain().0).length();
    let merged = found.spline.merged(size, LARGEST_TURN);
    let again = (merged.segments.len() < found.spline.segments.len())
        .then(|| merged.cut_like(&found.spline))
        .flatten()
        .and_then(|cut| judge(&target.strip, &found.nodes, &cut, &ConeJudgeOptions::new(tolerance)).ok())
        .filter(|again| again.holds(tolerance.max(proof.bound().value())));
    match again {
        Some(again) => (merged.with_turns_below(LARGEST_TURN), again),
        None => (found.spline.with_turns_below(LARGEST_TURN), proof),
    }
}

/// Segments of each kind in bodies: cones, cylinders, planes; of trimmed ones, pieces.
pub fn counts(bodies: &[ConeBody]) -> [usize; 3] {
    let mut out = [0; 3];
    for b in bodies {
        let n = match &b.part {
            Some(p) => ConeSpline { segments: p.faces.iter().map(|f| f.blank.segment).collect() }.counts(),
            None => b.spline.counts(),
        };
        out.iter_mut().zip(n).for_each(|(o, n)| *o += n);
    }
    out
}

/// Strips, figures, parts and patterns of one chain; the pieces that the strips show.
fn strips_of(answer: &mut Answer, body: &ConeBody, proven: &Proven) -> Vec<usize> {
    let first = answer.patchwork.panels.len();
    let mut shown = Vec::new();
    let pieces: Vec<Segment> = match &body.part {
        Some(part) => part.faces.iter().map(|f| f.blank.segment).collect(),
        None => body.spline.segments.clone(),
    };
    for (k, s) in pieces.iter().enumerate() {
        let kind = match s.shape.name() {
            "cone" => PanelKind::Cone,
            "cylinder" => PanelKind::Cylinder,
            _ => PanelKind::Plane,
        };
        let name = format!("{}-{:02}", body.name, k + 1);
        let Some(patch) = patches(s).ok().and_then(|p| p.into_iter().next()) else {
            answer.skipped.push(format!("{name}: its edges run through its vertex").into());
            continue;
        };
        shown.push(k);
        answer.patchwork.panels.push(Strip { name, kind, patch }.into());
        let subject = Subject::Panel(answer.patchwork.panels.len() - 1);
        answer.claims.extend([
            Claim::measured(What::Turn, subject, s.shape.angle().abs().to_degrees()),
            Claim::at_most(What::Deviation, subject, proven.bound),
        ]);
    }
    // One part for the chain, halved while it overlaps itself in the plane.
    let spline = &body.spline;
    let size = spline.segments.first().map_or(1.0, |s| (s.edges[1][0] - s.edges[0][0]).abs());
    let mut waiting = vec![(body.name.clone(), 0, spline.segments.len())];
    while let Some((name, from, count)) = waiting.pop() {
        let chain = ConeSpline { segments: spline.segments[from..from + count].to_vec() };
        let part = body.part.as_ref().map(|p| p.between(from, from + count));
        let overlapping = match &part {
            Some(part) => part_overlaps(spline, part, APART * size),
            None => overlaps(&chain, APART * size),
        };
        if count > 1 && overlapping {
            let half = count / 2;
            waiting.push((format!("{name}b"), from + half, count - half));
            waiting.push((format!("{name}a"), from, half));
            continue;
        }
        let contour = CONTOUR_SHARE * answer.tolerance;
        let (mut pattern, strips): (Pattern, (usize, usize)) = match &part {
            Some(part) => {
                let before = body.part.iter().flat_map(|p| &p.faces).take_while(|f| f.segment < from).count();
                (part_pattern(spline, part, &name, contour), (before, part.faces.len()))
            }
            None => (cone_pattern(&chain, &name, contour), (from, count)),
        };
        if pattern.contours.is_empty() {
            continue;
        }
        pattern.panel = answer.parts.len();
        answer.patterns.push(cones_viewed(pattern, if part.is_some() { spline } else { &chain }));
        answer.parts.push(Part { name, first: first + strips.0, count: strips.1, missing: String::new() });
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::claim::Status;
    use crate::geom::Vec3;
    use crate::io::words;
    use crate::search::strips::cone_strip::tests::{face_point, slanting};
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    /// A cylinder over a parabola, ruled along y, as a face; `bent` lifts one corner line so that it is no developable.
    fn face(lift: f64) -> Face {
        let points: Vec<Vec3> = (0..3)
            .flat_map(|i| {
                let x = 50.0 * f64::from(i);
                let z = if i == 1 { 40.0 } else { 0.0 };
                [Vec3::new(x, 0.0, z), Vec3::new(x, 100.0, z + if i == 2 { lift } else { 0.0 })]
            })
            .collect();
        let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
        Face::untrimmed(Surface::new(knots(2), knots(1), &points, None).expect("surface"))
    }

    #[test]
    fn a_cylinder_becomes_certified_cylinders_and_files_parts_and_patterns_agree() {
        let options = ConesOptions { tolerance: 0.05, input: "test".into() };
        let out = of_faces(&[face(0.0)], &[], &options, &Control::default()).expect("an answer");
        assert_eq!(out.status(), Status::Certified);
        let bodies = &out.cones.as_ref().expect("cones").bodies;
        assert_eq!(bodies.len(), 1);
        let [cones, cylinders, _] = bodies[0].spline.counts();
        assert!(cones == 0 && cylinders > 1 && out.patchwork.panels.len() == bodies[0].spline.segments.len());
        let area: f64 = out.patterns.iter().map(|p| p.area).sum();
        let surface: f64 = out.strips().map(Strip::area_estimate).sum();
        assert!((area - surface).abs() < 1e-3 * surface, "{area} {surface}");
    }

    #[test]
    fn faces_that_are_no_developables_are_named() {
        let options = ConesOptions { tolerance: 0.05, input: "test".into() };
        let error = of_faces(&[face(30.0)], &[], &options, &Control::default()).expect_err("hyperbolic");
        assert!(error.to_string().contains("not developable"), "{error}");
        let out = of_faces(&[face(30.0), face(0.0)], &[], &options, &Control::default()).expect("one of two");
        assert_eq!(out.skipped.len(), 1);
        // One surface of two is no answer that is certified, nor is what a reader left out.
        assert_eq!(out.status(), Status::Uncertified, "half of it is missing");
        let reason = words::reason(&out.claims, &[]);
        assert!(reason.contains("left out") && reason.contains("not developable"), "{reason}");
        let lost = Skipped::of_file(7, "unreadable", None);
        let out = of_faces(&[face(0.0)], &[lost], &options, &Control::default()).expect("the other");
        assert!(words::reason(&out.claims, &[]).contains("#7"), "{:?}", out.claims);
        let bad = ConesOptions { tolerance: f64::NAN, ..options };
        assert!(of_faces(&[face(0.0)], &[], &bad, &Control::default()).is_err());
    }

    #[test]
    fn slanting_parts_beside_the_regression_curve_are_certified_and_trimmed() {
        let options = ConesOptions { tolerance: 0.2, input: "test".into() };
        let out = of_faces(&[slanting()], &[], &options, &Control::default()).expect("an answer");
        assert_eq!(out.status(), Status::Certified);
        let bodies = &out.cones.as_ref().expect("cones").bodies;
        let part = bodies[0].part.as_ref().expect("trimmed");
        assert!(part.faces.len() > 1 && part.outline_estimate < 0.01, "{}", part.outline_estimate);
        // The area of the part is that of the region: |c' x (c' + ...)| by the midpoint rule.
        let area: f64 = out.patterns.iter().map(|p| p.area).sum();
        let n = 200;
        let mut expected = 0.0;
        for i in 0..n {
            let u = 0.2 + 0.8 * (f64::from(i) + 0.5) / f64::from(n);
            for j in 0..20 {
                let v = 0.7 - 0.5 * u + 0.25 * (f64::from(j) + 0.5) / 20.0;
                let h = 1e-5;
                let s = |u, v| face_point(u, v);
                let (du, dv) = (s(u + h, v) - s(u - h, v), s(u, v + h) - s(u, v - h));
                expected += du.cross(&dv).norm() / (4.0 * h * h) * (0.8 / f64::from(n)) * (0.25 / 20.0);
            }
        }
        assert!((area - expected).abs() < 5e-3 * expected, "{area} {expected}");
    }
}
