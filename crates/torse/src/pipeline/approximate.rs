//! The main job: faces in, certified developable panels and flat patterns out.
//!
//! Reads like the page that describes it: cover every face, build the panels as they will be exported, have them
//! judged, cut what is refused, develop the rest.

use super::build::{build, limits_missed, too_large, Built};
use super::cover::{check_curves, cover, strip_range, Cover, CoverOptions, CurveError, Guide, Layout, Limits};
use super::meet::{met, with_room};
use super::outcome::{AlongCurve, Outcome, Skipped, Status};
use crate::certify;
use crate::control::Control;
use crate::geom::BBox;
use crate::surface::face::Face;
use crate::surface::join::{joined, JoinOptions};
use crate::surface::panel::{Border, Panel, Patchwork};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// What the main job is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Deviation bound to reach between model and panels, mm.
    pub tolerance: f64,
    /// Largest number of panels on any face; default none.
    pub max_panels: Option<usize>,
    /// Name of the input for reports, without folder.
    pub input: String,
    /// What sheet and material allow.
    pub limits: Limits,
    /// Where strips and seams run.
    pub layout: Layout,
    /// Whether neighbouring strips are to meet in common seams where that can be certified.
    pub meet: bool,
    /// Greatest angle (rad) between faces along a common edge across which they are covered as one surface; 0 covers
    /// each face for itself. See [`crate::surface::join`].
    pub smooth_angle: f64,
}

/// Angle between faces (degrees) up to which they are covered as one unless something else is asked for. Modelling
/// programs join surfaces smoothly within a tenth of a degree, most exported files within half of one.
pub const SMOOTH_ANGLE_DEG: f64 = 0.5;

/// Why the job cannot be done at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ApproximateError {
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
/// Share of the tolerance by which control points of two faces may differ along an edge across which they are joined;
/// what is used of it is taken from the tolerance of the panels.
const MISMATCH_SHARE: f64 = 0.01;
/// Angle through which the normal of a joined face may turn along its parameter lines: half a tube with something to
/// spare, not a whole tube, whose level functions would have to close.
const MOST_TURN_DEG: f64 = 200.0;
/// Share of the parameter range within which a corner of a trim counts as lying on a knot line: a few times the
/// rounding of readers' projections, far below any length that matters.
const ON_LINE: f64 = 1e-9;
/// Rounds of cutting panels that the judge refuses as built.
const ROUNDS: usize = 6;
/// Rounds of cutting panels that are too large for the sheet, each in halves.
const SHEET_ROUNDS: usize = 8;
/// Round from which refused regions get plane facets only: these can always be built.
const FACET_ROUND: usize = 3;
/// Factor on the tolerance from one attempt to the next when the number of panels is limited.
const COARSER: f64 = 1.6;

/// Approximates faces by developable panels within a tolerance.
///
/// *Method.* [`cover`] per face, in parallel; panels built by [`crate::fit::boundary`]; the proof by
/// [`certify::patchwork`], which shares nothing with the fit; development of every panel.
/// *Guarantee.* The status is [`Status::Certified`] only if the certificate holds for every panel as exported.
/// Ended early by `control` or `max_panels`, the answer holds the best panels found and says why it is not certified.
///
/// # Errors
/// No faces, a tolerance that is not positive or cannot be certified at the size of the model.
pub fn approximate(
    faces: Vec<Face>,
    mut skipped: Vec<Skipped>,
    options: &Options,
    control: &Control,
) -> Result<Outcome, ApproximateError> {
    let start = Instant::now();
    let tolerance = options.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(ApproximateError::Tolerance(tolerance));
    }
    if options.max_panels == Some(0) {
        return Err(ApproximateError::MaxPanels);
    }
    if let Some((name, value)) = options.limits.named().into_iter().find(|(_, v)| !v.is_none_or(|v| v > 0.0)) {
        return Err(ApproximateError::Limit { name, value: value.unwrap_or(f64::NAN) });
    }
    if !(0.0..std::f64::consts::FRAC_PI_2).contains(&options.smooth_angle) {
        return Err(ApproximateError::SmoothAngle(options.smooth_angle.to_degrees()));
    }
    if faces.is_empty() {
        let why = skipped.first().map_or("the file holds none".to_owned(), |s| format!("#{}: {}", s.entity, s.reason));
        return Err(ApproximateError::NoFaces(why));
    }
    let mut bbox = BBox::empty();
    for f in &faces {
        let b = f.surface.bbox();
        bbox.include(&b.min);
        bbox.include(&b.max);
    }
    let size = bbox.diagonal().max(bbox.min.amax().max(bbox.max.amax()));
    if tolerance < PRECISION * size {
        return Err(ApproximateError::Precision { tolerance, size, least: PRECISION * size });
    }
    checked_layout(&options.layout, &bbox)?;
    let faces = smoothly_joined(faces, tolerance, options.smooth_angle);
    checked_curves(&faces, options)?;
    let total = faces.len();
    let finished = AtomicUsize::new(0);
    let built: Vec<Result<Built, Skipped>> = faces
        .into_par_iter()
        .enumerate()
        .map(|(index, face)| {
            let built = one_face(index, face, options, control);
            let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
            control.report("covering faces", n as f64 / total as f64, format!("{n} of {total}"));
            built
        })
        .collect();
    let mut patchwork = Patchwork { faces: Vec::new(), partitions: Vec::new(), panels: Vec::new(), seam_count: 0 };
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
        let why = skipped.first().map_or(String::new(), |s| format!("#{}: {}", s.entity, s.reason));
        return Err(ApproximateError::NoFaces(why));
    }
    let certificate = certify::join(certificates, tolerance);
    missing.extend(limits_missed(&patchwork, &certificate, &patterns, &options.limits));
    let reasons: Vec<&String> = certificate.missing.iter().chain(&missing).collect();
    let status = if certificate.certified && reasons.is_empty() {
        Status::Certified
    } else {
        let stopped = if control.stopped() { "ended early; " } else { "" };
        let first = reasons.first().map_or("not every panel could be proven", |r| r.as_str());
        Status::Uncertified(format!("{stopped}{first}"))
    };
    Ok(Outcome {
        input: options.input.clone(),
        tolerance,
        status,
        patchwork,
        certificate,
        patterns,
        skipped,
        along,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Faces that go on smoothly within an angle (rad) as one, as exactly as a tolerance (mm) asks for.
pub fn smoothly_joined(faces: Vec<Face>, tolerance: f64, angle: f64) -> Vec<Face> {
    let options = JoinOptions { angle, mismatch: tolerance * MISMATCH_SHARE, turn: MOST_TURN_DEG.to_radians() };
    // Strips of one level function across both, or at least no such strips given up.
    joined(faces, &options, &|whole, a, b| match (strip_range(whole), strip_range(a), strip_range(b)) {
        (Some(whole), Some(a), Some(b)) => whole <= a + b,
        (Some(_), _, _) | (None, None, None) => true,
        (None, _, _) => false,
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

/// The loop over one face: cover, build, judge, develop; cut what is refused and go round again.
fn one_face(index: usize, mut face: Face, options: &Options, control: &Control) -> Result<Built, Skipped> {
    let entity = face.entity;
    corners_on_knot_lines(&mut face);
    let refuse = |reason: String| Skipped { entity, reason };
    let limit = options.max_panels.unwrap_or(usize::MAX);
    // What joining moved belongs to the distance from the file's faces: the rest is left for the search.
    let tolerance = options.tolerance - face.joint_bound;
    let mut cover_options = CoverOptions {
        tolerance,
        max_panels: limit,
        facets: false,
        limits: options.limits,
        layout: options.layout.clone(),
    };
    let mut found = cover(&face, &cover_options, control).map_err(|e| refuse(e.to_string()))?;
    while !found.complete && !control.stopped() {
        // Too many panels: the fewest that were asked for, as near as they can be.
        cover_options.tolerance *= COARSER;
        found = cover(&face, &cover_options, control).map_err(|e| refuse(e.to_string()))?;
    }
    let Cover { mut state, complete } = found;
    if !complete {
        super::cover::fill(&mut state);
    }
    let mut round = 0;
    let mut sheets = 0;
    loop {
        let (built, refused) = build(index, &face, &state, options.tolerance);
        if control.stopped() || cover_options.tolerance > tolerance {
            return Ok(built);
        }
        if refused.is_empty() {
            // Pieces of a good panel are good panels: only the cuts are new.
            let large = too_large(&built, &options.limits);
            if large.is_empty() || sheets == SHEET_ROUNDS || built.patchwork.panels.len() + large.len() > limit {
                if !options.meet {
                    return Ok(built);
                }
                let best = met(index, &face, &state, built, &cover_options, control);
                return Ok(with_room(index, &face, best, &cover_options, control));
            }
            sheets += 1;
            state = super::cover::cut_large(&face, &state, &large);
            continue;
        }
        if round == ROUNDS || built.patchwork.panels.len() + refused.len() > limit {
            return Ok(built);
        }
        cover_options.facets = round >= FACET_ROUND;
        match super::cover::cut_refused(&face, &cover_options, control, &state, &refused) {
            Some(next) => state = next,
            None => return Ok(built),
        }
        round += 1;
    }
}

/// Moves corners of the trims that miss a knot line by rounding only onto it, so that no triangle crosses the line by
/// a hair. From here on these corners are the definition of the face.
fn corners_on_knot_lines(face: &mut Face) {
    let mut lines = [face.surface.knots_u.breaks(), face.surface.knots_v.breaks()];
    // The outermost corners are lines of the triangulation too.
    for (d, lines) in lines.iter_mut().enumerate() {
        let along = face.loops.iter().flat_map(|l| &l.points).map(|p| p[d] + 0.0);
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        for x in [lo, hi] {
            if !lines.iter().any(|k| (k - x).abs() <= ON_LINE * (hi - lo)) {
                lines.push(x);
            }
        }
    }
    for p in face.loops.iter_mut().flat_map(|l| &mut l.points) {
        for (x, lines) in p.iter_mut().zip(&lines) {
            // No negative zero: corners are compared bit by bit.
            *x += 0.0;
            let extent = lines.iter().fold(0.0, |m: f64, k| m.max((k - lines[0]).abs()));
            if let Some(&k) = lines.iter().find(|k| (*k - *x).abs() <= ON_LINE * extent) {
                *x = k;
            }
        }
    }
}

/// Adds the faces, panels and seams of another patchwork.
fn append(whole: &mut Patchwork, part: Patchwork) {
    let (faces, seams) = (whole.faces.len(), whole.seam_count as u32);
    whole.faces.extend(part.faces);
    whole.partitions.extend(part.partitions);
    whole.panels.extend(part.panels.into_iter().map(|mut p: Panel| {
        p.face += faces;
        for run in p.loops.iter_mut().flatten() {
            if let Border::Seam { seam, .. } = &mut run.border {
                *seam += seams;
            }
        }
        p
    }));
    whole.seam_count += part.seam_count;
}
