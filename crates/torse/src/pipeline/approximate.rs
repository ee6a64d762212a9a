//! The main job: faces in, certified developable panels and flat patterns out.
//!
//! Reads like the page that describes it: cover every face, build the panels as they will be exported, have them
//! judged, cut what is refused, develop the rest.

use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{Answer, Job};
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::brep::join::{joined, JoinOptions};
use crate::certify;
use crate::certify::claim::{Claim, Status, Subject};
use crate::control::Control;
use crate::develop::bends::BendSpacing;
use crate::develop::joints::with_joint_marks;
use crate::develop::pattern::bends_anew;
use crate::develop::view::{seen_from, Drawn};
use crate::geom::coarse::Loose;
use crate::geom::BBox;
use crate::io::model::Model;
use crate::patchwork::outside::outward;
use crate::patchwork::panel::{Border, Panel, Patchwork};
use crate::patchwork::part::Part;
use crate::patchwork::pattern::{Pattern, ViewSide};
use crate::search::build::{limits_missed, AlongCurve, Built};
use crate::search::cover::{
    check_curves, is_developable, is_smoothly_developable, panels_needed, strip_range, CoverOptions, CurveError, Guide,
    Layout, Limits,
};
use crate::search::face::{one_face, Wanted};
use crate::search::trims::{trims_judged, TrimsJudged};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::OnceLock;
use std::time::Instant;

/// What the main job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Deviation bound to reach between model and panels, mm.
    pub tolerance: f64,
    /// Largest number of panels on any face; default none.
    pub max_panels: Option<usize>,
    /// Name of the input for reports, without folder; default "model".
    pub input: String,
    /// What sheet and material allow; default anything.
    pub limits: Limits,
    /// Where strips and seams run; default where fewest are needed.
    pub layout: Layout,
    /// Whether neighbouring strips are to meet in common seams where that can be certified; default
    /// they are not.
    pub meet: bool,
    /// Greatest angle (rad) between faces along a common edge across which they are covered as one surface; 0 covers
    /// each face for itself; default [`SMOOTH_ANGLE_DEG`]. See [`crate::brep::join`].
    pub smooth_angle: f64,
    /// How flat patterns are drawn; default seen from outside, lines every 5°.
    pub drawn: Drawn,
}

impl Options {
    /// Defaults with a tolerance (mm).
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            max_panels: None,
            input: "model".into(),
            limits: Limits::default(),
            layout: Layout::default(),
            meet: false,
            smooth_angle: SMOOTH_ANGLE_DEG.to_radians(),
            drawn: Drawn::default(),
        }
    }
}

/// Angle between faces (degrees) up to which they are covered as one unless something else is asked for. Modelling
/// programs join surfaces smoothly within a tenth of a degree, most exported files within half of one.
pub const SMOOTH_ANGLE_DEG: f64 = 0.5;

/// Why the job cannot be done at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ApproximateError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// Nothing to approximate.
    #[error("there is no face to approximate; {0}")]
    NoFaces(String),
    /// Tolerance that is not a positive number.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// Tolerance too small to be proven in double precision.
    #[error(
        "a tolerance of {tolerance:.3e} mm is below what double precision can certify on a model of {size:.1} mm; \
         ask for at least {least:.1e} mm"
    )]
    Precision {
        /// Asked for, mm.
        tolerance: f64,
        /// Diagonal of the model, mm.
        size: f64,
        /// Smallest tolerance, mm.
        least: f64,
    },
    /// A limit of sheet or material that is not a positive length.
    #[error("the {name} must be a positive length, not {value} mm")]
    Limit {
        /// Which one.
        name: &'static str,
        /// Asked for, mm.
        value: f64,
    },
    /// A limit that asks for more panels than can be laid.
    #[error(
        "the {name} asks for about {count:.0} panels on face #{entity}, more than the {MOST_PANELS:.0} that can be laid; \
         allow more there, or a larger tolerance"
    )]
    TooMany {
        /// Which limit.
        name: &'static str,
        /// About how many panels that would be.
        count: f64,
        /// The face in the file.
        entity: u64,
    },
    /// A least width above the greatest.
    #[error("the least width, {least} mm, is above the greatest, {greatest} mm")]
    Widths {
        /// Least, mm.
        least: f64,
        /// Greatest, mm.
        greatest: f64,
    },
    /// Angle of smooth edges that is none.
    #[error("the angle of smooth edges must lie between 0 and 90 degrees, not at {0}")]
    SmoothAngle(f64),
    /// A plane for a seam that no face meets, or that is none.
    #[error(
        "no seam can run in plane {index}, {at:.6} mm from the origin: the model lies between {lo:.6} mm and {hi:.6} mm \
         in its direction"
    )]
    SeamPlane {
        /// Number of the plane among those given, from 1.
        index: usize,
        /// Its distance from the origin, mm.
        at: f64,
        /// Where the model begins along the plane's normal, mm.
        lo: f64,
        /// Where it ends, mm.
        hi: f64,
    },
    /// A direction or guide curve of no length.
    #[error("the direction that strips are to follow has no length, or is not finite")]
    Guide,
    /// A curve that no panel can be laid along, on any face.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// Limit of panels that cannot be kept.
    #[error("the greatest number of panels must be at least 1")]
    MaxPanels,
}

/// Share of the model's size below which no tolerance is accepted (certificate specification, 3).
const PRECISION: f64 = 1e-10;
/// Borders of panels that are joined are each within a tolerance of the file's edge.
const JOINT_REACH: f64 = 2.0;
/// Panels of one face; more take hours.
const MOST_PANELS: f64 = 1000.0;
/// Share of the tolerance by which control points of two faces may differ along an edge across which they are joined;
/// what is used of it is taken from the tolerance of the panels.
const MISMATCH_SHARE: f64 = 0.01;
/// Angle through which the normal of a joined face may turn along its parameter lines: half a tube with something to
/// spare, not a whole tube, whose level functions would have to close.
const MOST_TURN_DEG: f64 = 200.0;
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
    let found = of_faces(model.faces.clone(), model.skipped.clone(), options, &Control::default())?;
    Ok(Answer { notes: model.notes.clone(), ..found })
}

/// Approximates faces by developable panels within a tolerance.
///
/// *Method.* [`crate::search::cover`] per face, in parallel; panels built by [`crate::fit::panels::boundary`]; the proof by
/// [`certify::patchwork`], which shares nothing with the fit; development of every panel.
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
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(ApproximateError::Tolerance(tolerance));
    }
    if options.max_panels == Some(0) {
        return Err(ApproximateError::MaxPanels);
    }
    checked_limits(&options.limits)?;
    if !(0.0..std::f64::consts::FRAC_PI_2).contains(&options.smooth_angle) {
        return Err(ApproximateError::SmoothAngle(options.smooth_angle.to_degrees()));
    }
    if faces.is_empty() {
        let why = skipped.first().map_or("the file holds none".to_owned(), Skipped::words);
        return Err(ApproximateError::NoFaces(why));
    }
    let mut bbox = BBox::empty();
    for f in &faces {
        let b = f.surface.bbox();
        bbox.include(&b.min);
        bbox.include(&b.max);
    }
    Loose::check(bbox.diagonal(), tolerance)?;
    let size = bbox.diagonal().max(bbox.min.amax().max(bbox.max.amax()));
    if tolerance < PRECISION * size {
        return Err(ApproximateError::Precision { tolerance, size, least: PRECISION * size });
    }
    checked_layout(&options.layout, &bbox)?;
    let TrimsJudged { faces, missed: untrue, .. } = trims_judged(faces, tolerance);
    let faces = smoothly_joined(faces, tolerance, options.smooth_angle);
    for f in faces.iter().filter(|f| !is_developable(f, tolerance)) {
        if let Some((name, count)) = panels_needed(f, &options.limits, tolerance).filter(|n| n.1 > MOST_PANELS) {
            return Err(ApproximateError::TooMany { name, count, entity: f.entity });
        }
    }
    checked_curves(&faces, options)?;
    let total = faces.len();
    let finished = AtomicUsize::new(0);
    let wanted = Wanted {
        options: CoverOptions {
            tolerance,
            max_panels: options.max_panels.unwrap_or(usize::MAX),
            facets: false,
            limits: options.limits,
            layout: options.layout.clone(),
        },
        meet: options.meet,
        control,
        deadline: OnceLock::new(),
    };
    let built: Vec<Result<Built, Skipped>> = faces
        .into_par_iter()
        .enumerate()
        .map(|(index, face)| {
            let built = one_face(index, &face, &wanted).map_err(|e| left_face(&face, e.to_string()));
            let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
            control.report("covering faces", n as f64 / total as f64, format!("{n} of {total}"));
            built
        })
        .collect();
    let mut patchwork = Patchwork::default();
    let (mut certificates, mut patterns, mut missing) = (Vec::new(), Vec::new(), Vec::new());
    let mut along = Vec::new();
    for b in built {
        match b {
            Ok(b) => {
                certificates.push(b.certificate);
                let first = patchwork.panels.len();
                patterns.extend(b.patterns.into_iter().map(|mut p| {
                    p.panel += first;
                    p
                }));
                along.extend(b.along.into_iter().map(|a| AlongCurve { panel: a.panel + first, ..a }));
                missing.extend(b.missing);
                append(&mut patchwork, b.patchwork);
            }
            Err(s) => skipped.push(s),
        }
    }
    if patchwork.faces.is_empty() {
        let why = skipped.first().map_or(String::new(), Skipped::words);
        return Err(ApproximateError::NoFaces(why));
    }
    control.report("judging flat patterns", 1.0, format!("{} panels", patchwork.panels.len()));
    let certificate = certify::join(&patchwork, certificates, tolerance);
    let patterns = with_bends(&patchwork, patterns, &options.drawn);
    let patterns = with_joint_marks(&patchwork, patterns, JOINT_REACH * tolerance);
    let missed = limits_missed(&patchwork, &certificate, &patterns, &options.limits);
    missing.extend(missed.reasons);
    // As the proof of the panels, this has its own clock.
    let flat = certify::flat::flat(&patchwork, &patterns, tolerance, &Control::default());
    // Turned over exactly: what was proven holds for either side.
    let patterns = as_wanted(&patchwork, patterns, &options.drawn);
    let bad = patterns.iter().zip(&flat).filter(|(_, f)| !f.holds());
    let refused: Vec<Claim> = bad
        .map(|(p, f)| Claim::objection(Subject::Panel(p.panel), format!("pattern {}: {}", p.name, f.reason())))
        .collect();
    let mut claims: Vec<Claim> = untrue.into_iter().map(|reason| Claim::objection(Subject::Whole, reason)).collect();
    claims.extend(certificate.claims());
    claims.extend(flat.iter().flat_map(|f| f.claims()));
    claims.extend(refused);
    claims.extend(missing.into_iter().map(|reason| Claim::objection(Subject::Whole, reason)));
    if control.stopped() && Status::of(&claims) == Status::Uncertified {
        let bound = certificate.deviation_bound;
        let reached = match bound > tolerance && bound.is_finite() {
            true => format!("ended early; the panels found so far are proven within {bound:.4} mm only"),
            false => "ended early".into(),
        };
        claims.insert(0, Claim::objection(Subject::Whole, reached));
    }
    // What was left out on the way counts, whatever is proven of the rest.
    claims.splice(0..0, left_out(&skipped));
    let parts = one_by_one(&patchwork, &patterns);
    Ok(Answer {
        claims,
        patchwork,
        certificate: Some(certificate),
        parts,
        patterns,
        flat,
        skipped,
        along,
        beyond_limits: missed.panels,
        seconds: start.elapsed().as_secs_f64(),
        ..Answer::new(Job::Approximate, &options.input, tolerance)
    })
}

/// Every panel as a part of its own.
fn one_by_one(patchwork: &Patchwork, patterns: &[Pattern]) -> Vec<Part> {
    let flat: BTreeSet<usize> = patterns.iter().map(|p| p.panel).collect();
    let missing = |k: usize| if flat.contains(&k) { String::new() } else { "it could not be laid flat".into() };
    let panels = patchwork.panels.iter().enumerate();
    panels.map(|(k, p)| Part { name: p.strip.name.clone(), first: k, count: 1, missing: missing(k) }).collect()
}

/// Patterns with the lines that are wanted.
fn with_bends(patchwork: &Patchwork, patterns: Vec<Pattern>, drawn: &Drawn) -> Vec<Pattern> {
    if drawn.bends == BendSpacing::default() {
        return patterns;
    }
    patterns.into_par_iter().map(|pattern| bends_anew(patchwork, pattern, &drawn.bends)).collect()
}

/// Patterns seen from the side that is wanted. They come as seen from the side to which
/// the file says that a face looks.
fn as_wanted(patchwork: &Patchwork, patterns: Vec<Pattern>, drawn: &Drawn) -> Vec<Pattern> {
    let outward = outward(patchwork);
    let wanted = |pattern: Pattern| {
        let face = patchwork.panels[pattern.panel].face();
        let of = face.and_then(|f| Some((outward.get(f)?, patchwork.faces.get(f)?)));
        let as_outside = of.is_some_and(|(outward, face)| (*outward < 0.0) == face.reversed);
        let seen = if as_outside { ViewSide::Outside } else { ViewSide::Inside };
        seen_from(Pattern { view: seen, ..pattern }, drawn.view)
    };
    patterns.into_par_iter().map(wanted).collect()
}

/// Faces that go on smoothly within an angle (rad) as one, as exactly as a tolerance (mm) asks for.
pub fn smoothly_joined(faces: Vec<Face>, tolerance: f64, angle: f64) -> Vec<Face> {
    let options = JoinOptions { angle, mismatch: tolerance * MISMATCH_SHARE, turn: MOST_TURN_DEG.to_radians() };
    joined(faces, &options, &|whole, a, b| {
        // What is developable already keeps its edges and stays exact, unless both together are one smooth developable.
        if is_developable(a, tolerance) || is_developable(b, tolerance) {
            return is_smoothly_developable(whole, tolerance);
        }
        // Strips of one level function across both, or at least no such strips given up.
        match (strip_range(whole), strip_range(a), strip_range(b)) {
            (Some(whole), Some(a), Some(b)) => whole <= a + b,
            (Some(_), _, _) | (None, None, None) => true,
            (None, _, _) => false,
        }
    })
}

/// A curve of the layout that is of use on no face: the error of the face that it comes nearest to.
fn checked_curves(faces: &[Face], options: &Options) -> Result<(), ApproximateError> {
    let curves = &options.layout.curves;
    let cover_options = CoverOptions {
        tolerance: options.tolerance,
        max_panels: usize::MAX,
        facets: false,
        limits: options.limits,
        layout: Layout::default(),
    };
    let mut least: Vec<Option<CurveError>> = vec![None; curves.len()];
    let mut useful = vec![curves.is_empty(); curves.len()];
    for face in faces.iter().filter(|_| !curves.is_empty()) {
        // Faces that cannot be triangulated are reported by the cover.
        let Ok(found) = check_curves(face, curves, &cover_options) else { continue };
        for (i, r) in found.into_iter().enumerate() {
            match r {
                Ok(()) => useful[i] = true,
                Err(e) if least[i].as_ref().is_none_or(|l| e.remoteness() < l.remoteness()) => least[i] = Some(e),
                Err(_) => {}
            }
        }
    }
    match useful.iter().position(|u| !u).and_then(|i| least[i].clone()) {
        Some(e) => Err(e.into()),
        None => Ok(()),
    }
}

/// Limits that nothing can keep.
fn checked_limits(limits: &Limits) -> Result<(), ApproximateError> {
    if let Some((name, value)) = limits.named().into_iter().find(|(_, v)| !v.is_none_or(|v| v > 0.0)) {
        return Err(ApproximateError::Limit { name, value: value.unwrap_or(f64::NAN) });
    }
    match limits.min_width.zip(limits.widest()) {
        Some((least, greatest)) if least > greatest => Err(ApproximateError::Widths { least, greatest }),
        _ => Ok(()),
    }
}

/// A layout that asks for what cannot be.
fn checked_layout(layout: &Layout, bbox: &BBox) -> Result<(), ApproximateError> {
    for (i, seam) in layout.seams.iter().enumerate() {
        let (middle, half) = (0.5 * (bbox.min + bbox.max), 0.5 * (bbox.max - bbox.min));
        let (at, reach) = (seam.normal.dot(&middle), seam.normal.abs().dot(&half));
        let (lo, hi) = (at - reach, at + reach);
        if !(seam.offset > lo && seam.offset < hi) {
            return Err(ApproximateError::SeamPlane { index: i + 1, at: seam.offset, lo, hi });
        }
    }
    let sound = match &layout.guide {
        None => true,
        Some(Guide::Direction(d)) => d.norm() > 0.0 && d.norm().is_finite(),
        Some(Guide::Curve(points)) => {
            points.iter().all(|p| p.iter().all(|x| x.is_finite())) && points.windows(2).any(|w| w[0] != w[1])
        }
    };
    if sound {
        Ok(())
    } else {
        Err(ApproximateError::Guide)
    }
}

/// A face that is left out for a reason, with the faces of the file that go with it.
pub(super) fn left_face(face: &Face, reason: String) -> Skipped {
    let others: Vec<String> = face.parts.iter().skip(1).map(|p| format!("#{}", p.entity)).collect();
    let reason = if others.is_empty() { reason } else { format!("{reason} (joined with {})", others.join(", ")) };
    let area_estimate = Some(area_estimate(face)).filter(|a| a.is_finite() && *a > 0.0);
    Skipped::of_file(face.entity, reason, area_estimate)
}

/// Adds the faces, panels and seams of another patchwork.
fn append(whole: &mut Patchwork, part: Patchwork) {
    let (faces, seams) = (whole.faces.len(), whole.seam_count as u32);
    whole.faces.extend(part.faces);
    whole.partitions.extend(part.partitions);
    whole.panels.extend(part.panels.into_iter().map(|mut p: Panel| {
        p.trim.iter_mut().for_each(|t| t.face += faces);
        for run in p.loops_mut().iter_mut().flatten() {
            if let Border::Seam { seam, .. } = &mut run.border {
                *seam += seams;
            }
        }
        p
    }));
    whole.seam_count += part.seam_count;
}
