//! One face from its surface to panels that are proven and lie flat: cover, build, judge, develop; what is refused is cut
//! and goes round again.

use super::build::{build, too_large, Built};
use super::cover::{cover, fill, Cover, CoverOptions, Layout, Limits};
use super::laid::{Laid, Task};
use super::stitch::attempts::{met, with_room};
use super::trims::{corners_on_knot_lines, TRIM_SHARE};
use super::{sheet, slivers};
use crate::brep::face::Face;
use crate::certify;
use crate::control::Control;
use crate::patchwork::triangulate::TriangulateError;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

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

/// What becomes of faces, and when it must end.
pub(crate) struct Wanted<'a> {
    /// Tolerance of the whole, limits, layout.
    pub options: CoverOptions,
    /// Whether neighbouring panels are to meet.
    pub meet: bool,
    /// Progress and cancellation.
    pub control: &'a Control,
    /// When stopgaps of all faces together must end: set by the first that needs one.
    pub deadline: OnceLock<Instant>,
}

/// One face covered. Where its trim takes too much of the tolerance it is covered as it was read, for the eye, and judged
/// with the whole distance.
///
/// # Errors
/// Trim loops that cannot be triangulated.
pub(crate) fn one_face(index: usize, face: &Face, wanted: &Wanted) -> Result<Built, TriangulateError> {
    let mut face = face.clone();
    let (missed, tolerance) = (face.trim_bound(), wanted.options.tolerance);
    if missed <= TRIM_SHARE * tolerance {
        return covered(index, face, wanted);
    }
    face.set_trim_bound(0.0);
    let mut found = covered(index, face, wanted)?;
    found.patchwork.faces.iter_mut().for_each(|f| f.set_trim_bound(missed));
    found.certificate = certify::patchwork(&found.patchwork, tolerance, &Control::default());
    Ok(found)
}

/// The loop over one face: cover, build, judge, develop; then what limits and seams ask for.
fn covered(index: usize, mut face: Face, wanted: &Wanted) -> Result<Built, TriangulateError> {
    corners_on_knot_lines(&mut face);
    let (control, whole) = (wanted.control, wanted.options.tolerance);
    // What trimming missed and joining moved belongs to the distance from the file's faces: the rest is left for the
    // search.
    let tolerance = whole - face.joint_bound() - face.trim_bound();
    let mut options = CoverOptions { tolerance, ..wanted.options.clone() };
    let share = control.remaining().map(|left| Instant::now() + left.mul_f64(STOPGAP_SHARE));
    let mut stopgap = share.and_then(|end| stopgaps(index, &face, &options, &control.clone().until(end)));
    let mut found = cover(&face, &options, control)?;
    while !found.complete && !control.stopped() {
        // Too many panels: the fewest that were asked for, as near as they can be.
        options.tolerance *= COARSER;
        found = cover(&face, &options, control)?;
    }
    let Cover { mut state, complete } = found;
    if !complete {
        // Time is up: a coarse cover of all of it says more than a fine one of a part.
        if let Some(built) = stopgap.take().or_else(|| stopgaps(index, &face, &options, &grace(&wanted.deadline))) {
            return Ok(built);
        }
        fill(&mut state);
    }
    if control.stopped() || options.tolerance > tolerance {
        let built = build(index, &face, &state, whole).0;
        let unknown = !built.certificate.deviation_bound.is_finite();
        return Ok(stopgap.filter(|_| unknown && control.stopped()).unwrap_or(built));
    }
    let task = Task { index, face: &face, whole, options, control };
    let mut laid = task.laid(state, Vec::new());
    if laid.accepted && !too_large(&laid.built, &task.options.limits).is_empty() {
        laid = sheet::fitted(&task, laid);
    }
    if laid.accepted {
        laid = slivers::widened(&task, laid);
    }
    let Laid { state, built, accepted, seams } = laid;
    if control.stopped() && !built.certificate.deviation_bound.is_finite() {
        return Ok(stopgap.unwrap_or(built));
    }
    if !accepted || !wanted.meet || control.stopped() {
        return Ok(built);
    }
    let options = task.options_with(&seams);
    let best = met(index, &face, &state, built, &options, control);
    Ok(with_room(index, &face, best, &options, control))
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
