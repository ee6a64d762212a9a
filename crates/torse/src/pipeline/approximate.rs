//! The main job: faces in, certified developable panels and flat patterns out.
//!
//! Reads like the page that describes it: cover every face, build the panels as they will be exported, have them
//! judged, cut what is refused, develop the rest.

use crate::answer::skipped::{left_out, Skipped};
use crate::answer::{Answer, Job};
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::brep::join::{joined, JoinOptions};
use crate::brep::trim::with_chords;
use crate::certify;
use crate::certify::claim::{Claim, Status, Subject, UpperBound};
use crate::certify::trims::trim_proof;
use crate::control::Control;
use crate::develop::bends::BendSpacing;
use crate::develop::pattern::bends_anew;
use crate::develop::view::{seen_from, Drawn};
use crate::geom::coarse::Loose;
use crate::geom::BBox;
use crate::io::step::read::Model;
use crate::patchwork::outside::outward;
use crate::patchwork::panel::{Border, Panel, Patchwork};
use crate::patchwork::part::Part;
use crate::patchwork::pattern::{Pattern, ViewSide};
use crate::search::build::{build, limits_missed, too_large, AlongCurve, Built};
use crate::search::cover::{
    check_curves, cover, is_developable, is_smoothly_developable, strip_range, Cover, CoverOptions, CurveError, Guide,
    Layout, Limits,
};
use crate::search::stitch::attempts::{met, with_room};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

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

/// Tolerance of the first stopgap against the size of a face: one panel or two.
const COARSEST: f64 = 1.0 / 16.0;
/// Tolerance of each stopgap against that of the next one, and of the last against what was asked for: four times finer
/// takes about twice the panels.
const STOPGAP_STEP: f64 = 4.0;
/// Share of a limited time that goes into stopgaps.
const STOPGAP_SHARE: f64 = 0.2;
/// See [`grace`]: people who asked to stop wait for it.
const GRACE: Duration = Duration::from_millis(1500);
/// See [`grace`].
const LEAST_GRACE: Duration = Duration::from_millis(200);

/// Approximates a model by developable panels; see [`of_faces`].
///
/// # Errors
/// As [`of_faces`].
///
/// # Example
/// ```
/// let plate = include_bytes!("../../../../data/cylinder_holes.step");
/// let answer = torse::approximate(&torse::read_step(plate)?, &torse::Approximate::new(0.5))?;
/// assert_eq!((answer.status(), answer.parts.len()), (torse::Status::Certified, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn approximate(model: &Model, options: &Options) -> Result<Answer, ApproximateError> {
    let found = of_faces(model.faces.clone(), model.skipped.clone(), options, &Control::default())?;
    Ok(Answer { notes: model.notes.clone(), ..found })
}

/// Approximates faces by developable panels within a tolerance.
///
/// *Method.* [`cover`] per face, in parallel; panels built by [`crate::fit::panels::boundary`]; the proof by
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
    if let Some((name, value)) = options.limits.named().into_iter().find(|(_, v)| !v.is_none_or(|v| v > 0.0)) {
        return Err(ApproximateError::Limit { name, value: value.unwrap_or(f64::NAN) });
    }
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
    checked_curves(&faces, options)?;
    let total = faces.len();
    let finished = AtomicUsize::new(0);
    let deadline = OnceLock::new();
    let built: Vec<Result<Built, Skipped>> = faces
        .into_par_iter()
        .enumerate()
        .map(|(index, face)| {
            let built = one_face(index, face, options, control, &deadline);
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
    let certificate = certify::join(&patchwork, certificates, tolerance);
    let patterns = with_bends(&patchwork, patterns, &options.drawn);
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

/// Share of the tolerance that the proven distance of trims from the file's edges may take.
const TRIM_SHARE: f64 = 0.5;
/// Distances of trims from edges below this share of the tolerance are not told apart.
const TRIM_AIM: f64 = 0.002;
/// Share of the tolerance that chords of trims may keep from the file's edges.
const CHORDS_SHARE: f64 = 0.05;

/// Faces whose trims were judged.
pub struct TrimsJudged {
    /// The faces, with finer trims where the tolerance asks for them.
    pub faces: Vec<Face>,
    /// Greatest distance of a trim from the file's edges, mm.
    pub bound: UpperBound,
    /// In words, trims that take too much of the tolerance.
    pub missed: Vec<String>,
}

/// Faces with trims as fine as the tolerance asks for and the proven distance of these from the file's edges, and in
/// words where that takes too much of the tolerance.
pub fn trims_judged(faces: Vec<Face>, tolerance: f64) -> TrimsJudged {
    let judged = faces.into_par_iter().map(|mut face| {
        if face.boundary.is_none() {
            let bound = trim_proof(&face, TRIM_AIM * tolerance).bound();
            return (face, (bound, None));
        }
        if let Some(finer) = with_chords(&face, CHORDS_SHARE * tolerance) {
            face = finer;
        }
        corners_on_knot_lines(&mut face);
        let proof = trim_proof(&face, TRIM_AIM * tolerance);
        let bound = proof.bound();
        face.set_trim_bound(bound.value());
        let words = (bound.value() > TRIM_SHARE * tolerance).then(|| {
            let far = if bound.value().is_finite() { format!("{:.3e} mm", bound.value()) } else { "no bound".into() };
            format!(
                "face #{}: the trim is only proven to keep to the file's edges within {far} (edge #{})",
                face.entity,
                proof.edge()
            )
        });
        (face, (bound, words))
    });
    let (faces, found): (Vec<Face>, Vec<(UpperBound, Option<String>)>) = judged.unzip();
    let bound = UpperBound::largest(found.iter().map(|f| f.0));
    TrimsJudged { faces, bound, missed: found.into_iter().filter_map(|f| f.1).collect() }
}

/// One face covered. Where its trim takes too much of the tolerance it is covered as it was read, for the eye, and judged
/// with the whole distance.
fn one_face(
    index: usize,
    mut face: Face,
    options: &Options,
    control: &Control,
    deadline: &OnceLock<Instant>,
) -> Result<Built, Skipped> {
    let missed = face.trim_bound();
    if missed <= TRIM_SHARE * options.tolerance {
        return covered(index, face, options, control, deadline);
    }
    face.set_trim_bound(0.0);
    let mut found = covered(index, face, options, control, deadline)?;
    found.patchwork.faces.iter_mut().for_each(|f| f.set_trim_bound(missed));
    found.certificate = certify::patchwork(&found.patchwork, options.tolerance, &Control::default());
    Ok(found)
}

/// The loop over one face: cover, build, judge, develop; cut what is refused and go round again.
fn covered(
    index: usize,
    mut face: Face,
    options: &Options,
    control: &Control,
    deadline: &OnceLock<Instant>,
) -> Result<Built, Skipped> {
    corners_on_knot_lines(&mut face);
    let refuse = |reason: String| left_face(&face, reason);
    let limit = options.max_panels.unwrap_or(usize::MAX);
    // What trimming missed and joining moved belongs to the distance from the file's faces: the rest is left for the
    // search.
    let tolerance = options.tolerance - face.joint_bound() - face.trim_bound();
    let mut cover_options = CoverOptions {
        tolerance,
        max_panels: limit,
        facets: false,
        limits: options.limits,
        layout: options.layout.clone(),
    };
    let share = control.remaining().map(|left| Instant::now() + left.mul_f64(STOPGAP_SHARE));
    let mut stopgap = share.and_then(|end| stopgaps(index, &face, &cover_options, &control.clone().until(end)));
    let mut found = cover(&face, &cover_options, control).map_err(|e| refuse(e.to_string()))?;
    while !found.complete && !control.stopped() {
        // Too many panels: the fewest that were asked for, as near as they can be.
        cover_options.tolerance *= COARSER;
        found = cover(&face, &cover_options, control).map_err(|e| refuse(e.to_string()))?;
    }
    let Cover { mut state, complete } = found;
    if !complete {
        // Time is up: a coarse cover of all of it says more than a fine one of a part.
        if let Some(built) = stopgap.take().or_else(|| stopgaps(index, &face, &cover_options, &grace(deadline))) {
            return Ok(built);
        }
        crate::search::cover::fill(&mut state);
    }
    let mut round = 0;
    let mut sheets = 0;
    loop {
        let (built, refused) = build(index, &face, &state, options.tolerance);
        if control.stopped() && !built.certificate.deviation_bound.is_finite() {
            return Ok(stopgap.take().unwrap_or(built));
        }
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
            state = crate::search::cover::cut_large(&face, &state, &large);
            continue;
        }
        if round == ROUNDS || built.patchwork.panels.len() + refused.len() > limit {
            return Ok(built);
        }
        cover_options.facets = round >= FACET_ROUND;
        match crate::search::cover::cut_refused(&face, &cover_options, control, &state, &refused) {
            Some(next) => state = next,
            None => return Ok(built),
        }
        round += 1;
    }
}

/// Covers of a whole face from coarse to fine, each proven, until time is up: the finest.
fn stopgaps(index: usize, face: &Face, wanted: &CoverOptions, control: &Control) -> Option<Built> {
    let mut best = None;
    let mut tolerance = COARSEST * face.surface.bbox().diagonal();
    while tolerance > STOPGAP_STEP * wanted.tolerance && !control.stopped() {
        // What was asked for besides the tolerance would only take time here; what is missed is marked.
        let options =
            CoverOptions { tolerance, limits: Limits::default(), layout: Layout::default(), ..wanted.clone() };
        let found = cover(face, &options, control).ok()?;
        if found.complete {
            let built = build(index, face, &found.state, tolerance).0;
            if built.certificate.deviation_bound.is_finite() {
                best = Some(built);
            }
        }
        tolerance /= STOPGAP_STEP;
    }
    best
}

/// Time for stopgaps after a job was asked to stop: a little for all faces together, at least a moment for each.
fn grace(deadline: &OnceLock<Instant>) -> Control {
    let now = Instant::now();
    Control::default().until((now + LEAST_GRACE).max(*deadline.get_or_init(|| now + GRACE)))
}

/// A face that is left out for a reason, with the faces of the file that go with it.
pub(super) fn left_face(face: &Face, reason: String) -> Skipped {
    let others: Vec<String> = face.parts.iter().skip(1).map(|p| format!("#{}", p.entity)).collect();
    let reason = if others.is_empty() { reason } else { format!("{reason} (joined with {})", others.join(", ")) };
    let area_estimate = Some(area_estimate(face)).filter(|a| a.is_finite() && *a > 0.0);
    Skipped::of_file(face.entity, reason, area_estimate)
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
