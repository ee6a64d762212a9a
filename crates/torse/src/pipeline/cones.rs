//! The job of `torse cones`: ruled developable faces (or the panels of a patchwork) as chains of exact cones,
//! cylinders and planes, with their proof and their flat patterns of true arcs.

use super::cone_outline::PlaneOutline;
use super::cone_strip::strip_of;
use super::outcome::{Skipped, Status};
use super::sheets::{Basis, Figure, FlatPart, Sheets};
use crate::certify::cones::{cones as judge, ConeJudgeOptions, ConeProof};
use crate::control::Control;
use crate::develop::cone_part::{overlaps as part_overlaps, part_pattern};
use crate::develop::cones::{cone_pattern, overlaps};
use crate::fit::cone_trim::{cone_part, ConeTrimError, ConeTrimOptions};
use crate::fit::cones::{cones as fit, ConeFit, ConeFitOptions};
use crate::surface::cone_forms::patches;
use crate::surface::cone_part::{ConeBody, ConePart};
use crate::surface::cone_spline::{ConeSpline, Segment};
use crate::surface::face::Face;
use crate::surface::panel::Patchwork;
use crate::surface::pattern::Pattern;
use crate::surface::ruled_strip::{RuledPatch, RuledStrip};
use crate::surface::strip::Strip;
use crate::surface::torse::PanelKind;
use std::time::Instant;

/// What the job is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct ConesOptions {
    /// Distance allowed between surface and cones, both ways, mm.
    pub tolerance: f64,
    /// Name of the input, for the files.
    pub input: String,
}

/// What it answers.
#[derive(Clone, Debug)]
pub struct ConesOutcome {
    /// Everything for files and reports.
    pub sheets: Sheets,
    /// The chains, trimmed where faces are, in the order of the parts before cutting.
    pub bodies: Vec<ConeBody>,
    /// Body and piece of every strip.
    pub pieces: Vec<(usize, usize)>,
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConesJobError {
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

/// Rulings at which a face is tested for developability.
const TESTED: usize = 33;
/// Largest deviation of a ruled face from a developable one that still counts as none, as a share of the tolerance:
/// the sine of the twist times the length of the ruling.
const TWISTED: f64 = 0.05;
/// The tolerance of the fit against that of the job: the proof of the way back adds to the distance fitted.
const SHARES: [f64; 5] = [0.76, 0.6, 0.45, 0.3, 0.15];
/// Distance allowed to edges, as a share of that of the surface: both add up in the proof.
const EDGES: f64 = 0.25;
/// Contours stay within this share of the tolerance.
const CONTOUR_SHARE: f64 = 0.1;
/// Parts that fall together in the plane are apart in space by more than this share of the size.
const APART: f64 = 1e-3;

/// Distance (mm) allowed between trimmed edges and the exact surfaces: CAD systems take less for none.
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
pub fn of_faces(
    faces: &[Face],
    skipped: &[Skipped],
    options: &ConesOptions,
    control: &Control,
) -> Result<ConesOutcome, ConesJobError> {
    let mut targets = Vec::new();
    let mut left: Vec<String> = skipped.iter().map(|s| format!("#{}: {}", s.entity, s.reason)).collect();
    let before = left.len();
    for (i, face) in faces.iter().enumerate() {
        let name = if face.name.is_empty() { format!("F{:02}", i + 1) } else { face.name.clone() };
        match ruled(face, options.tolerance) {
            Ok((strip, outline)) => targets.push(Target { name, strip, outline }),
            Err(reason) => left.push(format!("#{} {name}: {reason}", face.entity)),
        }
    }
    if targets.is_empty() {
        let reason = left.get(before).cloned().unwrap_or_else(|| "no faces".into());
        return Err(ConesJobError::Nothing { count: faces.len(), reason });
    }
    run(&targets, left, options, control)
}

/// The panels of a patchwork as cone splines, cut along their outlines.
///
/// # Errors
/// See [`ConesJobError`].
pub fn of_panels(
    patchwork: &Patchwork,
    options: &ConesOptions,
    control: &Control,
) -> Result<ConesOutcome, ConesJobError> {
    let mut targets = Vec::new();
    let mut left = Vec::new();
    for panel in &patchwork.panels {
        let outline = PlaneOutline::of_panel(panel);
        match strip_of(&outline) {
            Some(strip) => targets.push(Target { name: panel.name.clone(), strip, outline }),
            None => left.push(format!("{}: its outline leaves the patch", panel.name)),
        }
    }
    if targets.is_empty() {
        let reason = left.first().cloned().unwrap_or_else(|| "no panels".into());
        return Err(ConesJobError::Nothing { count: patchwork.panels.len(), reason });
    }
    run(&targets, left, options, control)
}

fn run(
    targets: &[Target],
    left: Vec<String>,
    options: &ConesOptions,
    control: &Control,
) -> Result<ConesOutcome, ConesJobError> {
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(ConesJobError::Tolerance(options.tolerance));
    }
    let started = Instant::now();
    let mut sheets = Sheets {
        job: "cones".into(),
        input: options.input.clone(),
        tolerance: options.tolerance,
        status: Status::Certified,
        strips: Vec::new(),
        strip_figures: Vec::new(),
        fields: Vec::new(),
        points: Default::default(),
        meaning: Default::default(),
        parts: Vec::new(),
        patterns: Vec::new(),
        guides: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        skipped: left,
        seconds: 0.0,
    };
    let (mut bodies, mut pieces): (Vec<ConeBody>, Vec<(usize, usize)>) = (Vec::new(), Vec::new());
    let (mut worst, mut back, mut joint, mut edges) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    let mut failures = Vec::new();
    for (i, target) in targets.iter().enumerate() {
        control.report("cones", i as f64 / targets.len() as f64, target.name.clone());
        if control.stopped() {
            failures.push("stopped before all surfaces were done".to_owned());
            break;
        }
        let (found, proof) = match approximated(target, options.tolerance) {
            Ok(both) => both,
            Err(reason) => {
                sheets.skipped.push(format!("{}: {reason}", target.name));
                failures.push(format!("{} has no cone spline", target.name));
                continue;
            }
        };
        let mut found = found;
        found.spline = found.spline.with_turns_below(LARGEST_TURN);
        let conics = target.outline.is_rectangle() && !found.spline.has_circular_edges();
        if !conics {
            found.spline = found.spline.merged(target.strip.jet(target.strip.domain().0).length(), LARGEST_TURN);
        }
        // Trimmed edges replace those of the chain, so that its bounds hold for what lies between them.
        let (part, back_here) = if target.outline.is_rectangle() {
            (None, proof.chain_bound)
        } else {
            match trimmed(target, &found, options.tolerance) {
                Ok(part) => {
                    edges = edges.max(part.outline_estimate);
                    let bound = proof.strip_bound + part.outline_estimate + EDGE_ROUNDING;
                    (Some(part), bound)
                }
                Err(e) => {
                    sheets.skipped.push(format!("{}: its outline is not cut: {e}", target.name));
                    failures.push(format!("{} is a blank, its outline is not cut", target.name));
                    (None, proof.chain_bound)
                }
            }
        };
        if proof.strip_bound > options.tolerance || back_here > options.tolerance {
            failures
                .push(format!("{} is not proven to stay within the tolerance (bound {back_here:.3e} mm)", target.name));
        }
        (worst, back) = (worst.max(proof.strip_bound), back.max(back_here));
        joint = joint.max(proof.mismatch);
        let body = ConeBody { name: target.name.clone(), spline: found.spline, part };
        for piece in strips_of(&mut sheets, &body, &proof) {
            pieces.push((bodies.len(), piece));
        }
        bodies.push(body);
    }
    let counts = counts(&bodies);
    sheets.figures = vec![
        Figure::new("surfaces", bodies.len() as f64, "", Basis::Given),
        Figure::new("cones", counts[0] as f64, "", Basis::Given),
        Figure::new("cylinders", counts[1] as f64, "", Basis::Given),
        Figure::new("planes", counts[2] as f64, "", Basis::Given),
        Figure::new("distance of the surface from the cones", worst, "mm", Basis::Proven),
        Figure::new("distance of the cones from the surface", back, "mm", Basis::Proven),
        Figure::new("mismatch at joints", joint, "rad", Basis::Measured),
        Figure::new("distance of trimmed edges from the outline carried over", edges, "mm", Basis::Measured),
    ];
    sheets.notes.push("Faces of cones.step are exact cones, cylinders and planes.".into());
    if !failures.is_empty() {
        sheets.status = Status::Uncertified(failures.join("; "));
    }
    sheets.seconds = started.elapsed().as_secs_f64();
    Ok(ConesOutcome { sheets, bodies, pieces })
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

/// The chain cut along the outline of what it stands for.
fn trimmed(target: &Target, found: &ConeFit, tolerance: f64) -> Result<ConePart, ConeTrimError> {
    let outline = target.outline.in_space(&found.nodes);
    cone_part(&found.spline, &outline, &ConeTrimOptions { outline: OUTLINE_SHARE * tolerance, edge: EDGE_ROUNDING })
}

/// Strips, figures, parts and patterns of one chain; the pieces that the strips show.
fn strips_of(sheets: &mut Sheets, body: &ConeBody, proof: &ConeProof) -> Vec<usize> {
    let first = sheets.strips.len();
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
            sheets.skipped.push(format!("{name}: its edges run through its vertex"));
            continue;
        };
        shown.push(k);
        sheets.strips.push(Strip { name, kind, patch });
        sheets.strip_figures.push(vec![
            Figure::new("turn about the axis", s.shape.angle().abs().to_degrees(), "deg", Basis::Measured),
            Figure::new("distance, surface from cones", proof.strip_bound, "mm", Basis::Proven),
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
        let contour = CONTOUR_SHARE * sheets.tolerance;
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
        pattern.panel = sheets.parts.len();
        sheets.patterns.push(pattern);
        sheets.parts.push(FlatPart { name, first: first + strips.0, count: strips.1, missing: String::new() });
    }
    shown
}

/// The strip of a ruled developable face.
pub(super) fn ruled(face: &Face, tolerance: f64) -> Result<(RuledPatch, PlaneOutline), String> {
    let candidates = [Some(face.surface.clone()), Some(face.surface.transposed())];
    let mut reason = "it is not ruled (of degree 1 in one direction)".to_owned();
    for (k, surface) in candidates.into_iter().flatten().enumerate() {
        let outline = PlaneOutline::of_face(face, surface, k == 1);
        let Some(strip) = strip_of(&outline) else { continue };
        match faulty(&strip, tolerance) {
            None => return Ok((strip, outline)),
            Some(fault) => reason = fault,
        }
    }
    Err(reason)
}

/// What keeps a ruled strip from being developable.
fn faulty(strip: &RuledPatch, tolerance: f64) -> Option<String> {
    let (a, b) = strip.domain();
    for k in 0..TESTED {
        let u = a + (b - a) * k as f64 / (TESTED - 1) as f64;
        let jet = strip.jet(u);
        let element = match jet.element() {
            Ok(e) => e,
            Err(e) => return Some(format!("its ruling u = {u:.4} is not usable: {e}")),
        };
        let off = jet.twist(&element) * jet.length();
        if off > TWISTED * tolerance || off.is_nan() {
            return Some(format!("it is not developable (twist of {off:.2e} mm along ruling u = {u:.4})"));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
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
        let out = of_faces(&[face(0.0)], &[], &options, &Control::default()).expect("outcome");
        assert_eq!(out.sheets.status, Status::Certified);
        assert_eq!(out.bodies.len(), 1);
        let [cones, cylinders, _] = out.bodies[0].spline.counts();
        assert!(cones == 0 && cylinders > 1 && out.sheets.strips.len() == out.bodies[0].spline.segments.len());
        let area: f64 = out.sheets.patterns.iter().map(|p| p.area).sum();
        let surface: f64 = out.sheets.strips.iter().map(Strip::area_estimate).sum();
        assert!((area - surface).abs() < 1e-3 * surface, "{area} {surface}");
    }

    #[test]
    fn faces_that_are_no_developables_are_named() {
        let options = ConesOptions { tolerance: 0.05, input: "test".into() };
        let error = of_faces(&[face(30.0)], &[], &options, &Control::default()).expect_err("hyperbolic");
        assert!(error.to_string().contains("not developable"), "{error}");
        let out = of_faces(&[face(30.0), face(0.0)], &[], &options, &Control::default()).expect("one of two");
        assert_eq!(out.sheets.skipped.len(), 1);
        let bad = ConesOptions { tolerance: f64::NAN, ..options };
        assert!(of_faces(&[face(0.0)], &[], &bad, &Control::default()).is_err());
    }
}
