//! One face from its surface to panels that are proven and lie flat: cover, build, judge, develop; what is refused is cut
//! and goes round again.

use super::build::{build_until, limits_missed, too_large, Built};
use super::cover::{
    bent_panels, cover, exactly_covered, revolved, Cover, CoverOptions, Layout, Limits, Recount, SeamPlane,
};
use super::joint::BorderCounts;
use super::laid::{Laid, Task};
use super::sheet::{self, Fitted};
use super::slivers;
use super::stitch::attempts::met;
use super::stitch::faces_together::Side;
use super::stitch::openness::{openness, unproven};
use super::trims::{corners_on_knot_lines, TRIM_SHARE};
use crate::brep::face::Face;
use crate::certify::{self, SeamStatus};
use crate::control::Control;
use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;
use crate::patchwork::triangulate::TriangulateError;
use crate::reason::{FaceReason, Reason};
use std::collections::BTreeSet;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Factor on the tolerance from one attempt to the next when the number of panels is limited.
const COARSER: f64 = 1.6;

/// Tolerance of the first stopgap against the size of a face: one panel or two.
const COARSEST: f64 = 1.0 / 16.0;
/// Tolerance of each stopgap against that of the next one, and of the last against what was asked for: four times finer
/// takes about twice the panels.
const STOPGAP_STEP: f64 = 4.0;
/// Share of a limited time that goes into the first stopgaps of all faces.
const FIRST_SHARE: f64 = 0.2;
/// Share of the time left that goes into finer stopgaps of a face.
const STOPGAP_SHARE: f64 = 0.3;
/// Panels one after the other, where one would do but for the radius to which it may bend, from which on they may not be found
/// at all.
const BENT_PANELS: f64 = 2.0;
/// Time, after a job was asked to stop, for fits of regions that no cover has reached, and for proofs of what has none.
const FILLING: Duration = Duration::from_millis(250);
/// Attempts at covers of a face that limits of bending ask to be cut: what is found at all is found in fewer. Users who want more
/// of them give a time.
const LIMITED: usize = 250;
/// Share of a time that is set that they get then.
const LIMITED_SHARE: f64 = 0.5;
/// Parts of panels that meet may be more than panels that need not by this share: the half bowl at 10 mm is 12 panels on sheets of
/// 0.5 m by 1 m that keep 21 of 25 seams open, or 15 that meet.
const MORE_PARTS: f64 = 0.25;
/// Fits are judged with this multiple of the distance at their samples, so that the report can state a bound.
const LOOSE: f64 = 1.2;

/// What becomes of faces, and when it must end.
pub(crate) struct Wanted<'a> {
    /// Tolerance of the whole, limits, layout.
    pub options: CoverOptions,
    /// Whether neighbouring panels are to meet.
    pub meet: bool,
    /// Progress and cancellation.
    pub control: &'a Control,
    /// Bodies and numbers of the file's edges in which faces meet.
    pub between: HashSet<(u32, u64)>,
    /// When stopgaps of all faces together must end: set by the first that needs one.
    pub deadline: OnceLock<Instant>,
}

impl Wanted<'_> {
    /// When a job that was asked to stop must end: soon, for all faces together.
    fn end(&self) -> Instant {
        *self.deadline.get_or_init(|| Instant::now() + self.control.grace())
    }

    /// Time for stopgaps after a job was asked to stop.
    fn grace(&self) -> Control {
        Control::default().until(self.end())
    }

    /// How long a cover of a face is looked for, and why that is no longer: where the user has set limits that hardly any panel
    /// of the face keeps to. Of a time that is set a part is left for a cover without them.
    fn search(&self, face: &Face, options: &CoverOptions) -> (Control, Option<Reason>) {
        let radius = options.limits.min_bend_radius;
        let needed = radius.and_then(|r| Some((r, bent_panels(face, r, options.tolerance)?)));
        let Some((radius, [along, across])) = needed.filter(|(_, n)| n[0] >= BENT_PANELS) else {
            return (self.control.clone(), None);
        };
        let (entity, panels) = (face.entity, along * across);
        let control = self.control.clone();
        let (control, attempts) = match control.remaining() {
            None => (control.within(LIMITED), Some(LIMITED)),
            Some(left) => (control.until(Instant::now() + left.mul_f64(LIMITED_SHARE)), None),
        };
        (control, Some(FaceReason::TooTight { entity, attempts, radius, panels }.into()))
    }

    /// Whether a job was asked to stop and its time for stopgaps is up: no face should be begun.
    pub(crate) fn is_over(&self) -> bool {
        self.control.stopped() && Instant::now() >= self.end()
    }
}

/// Edges of the file in which different faces of a body meet. Bodies of a Rhino archive number theirs each for itself.
pub(crate) fn edges_between(faces: &[Face]) -> HashSet<(u32, u64)> {
    let mut first: HashMap<(u32, u64), usize> = HashMap::default();
    let mut out = HashSet::default();
    for (k, face) in faces.iter().enumerate() {
        for edge in face.boundary.iter().flat_map(|b| &b.loops).flatten() {
            let edge = (face.body, edge.entity);
            if *first.entry(edge).or_insert(k) != k {
                out.insert(edge);
            }
        }
    }
    out
}

/// Where time is limited, a coarse cover of a face, for want of a better one: before any face gets a fine one.
pub(crate) fn first_covers(faces: &[Face], wanted: &Wanted) -> Vec<Option<Built>> {
    let Some(left) = wanted.control.remaining() else { return faces.iter().map(|_| None).collect() };
    let control = wanted.control.clone().until(Instant::now() + left.mul_f64(FIRST_SHARE));
    let whole = wanted.options.tolerance;
    let first = |(index, face): (usize, &Face)| {
        let mut face = face.clone();
        if control.stopped() || face.trim_bound() > TRIM_SHARE * whole {
            return None;
        }
        corners_on_knot_lines(&mut face);
        let tolerance = whole - face.joint_bound() - face.trim_bound();
        let options = CoverOptions { tolerance, ..wanted.options.clone() };
        stopgap(index, &face, &options, (COARSEST * face.surface.bbox().diagonal(), &control))
    };
    parallel::map(faces.iter().enumerate(), first)
}

/// A face as it is covered.
pub(crate) struct Covered {
    /// Its panels.
    built: Built,
    /// Why they miss what was asked for.
    why: Option<Reason>,
    /// What they need to meet, where they are to.
    apart: Option<Apart>,
}

/// A cover whose strips have been laid one by one.
struct Apart {
    /// Whether they meet within the face as they are.
    meets: bool,
    cover: Cover,
    options: CoverOptions,
    /// Labels of panels whose flat patterns are not proven.
    unproven: BTreeSet<u32>,
    /// Covers in panels of which these are parts, or could be.
    wholes: Vec<Whole>,
}

/// A cover whose panels are too large for the sheets of a shop.
struct Whole {
    cover: Cover,
    built: Built,
    options: CoverOptions,
    /// Planes along which its panels are cut.
    planes: Vec<SeamPlane>,
}

impl Whole {
    /// Planes between sections that nobody has asked for do not hold seams: panels on both sides meet beside them.
    fn of(task: &Task, Laid { cover, built, .. }: Laid, planes: Vec<SeamPlane>) -> Self {
        let mut options = task.options.clone();
        let limits = &mut options.limits;
        (limits.sheet, limits.max_length, limits.max_width) = (None, None, None);
        Self { cover, built, options, planes }
    }
}

impl Apart {
    /// Parts, with their cover, of panels that are too large, laid anew so that they meet: their parts do so as well. `None` where
    /// parts are too many, or worse than `built`.
    fn parted(&self, (index, built): (usize, &Built), whole: Whole, control: &Control) -> Option<(Cover, Built)> {
        let (face, options) = (&self.cover.face, self.options.clone());
        let open = unproven(&whole.built, control).into_iter().collect();
        // With fewer strips little of the tolerance would be left for the ends of parts.
        let asked = (&whole.options, &[Recount::More][..]);
        let joined = met(index, &whole.cover, (whole.built, open), asked, control);
        let cover = whole.cover.of_panels(&joined)?;
        let task = Task { index, face, whole: built.certificate.tolerance, options, control };
        let (cover, parts) = sheet::parted(&task, (&cover, &joined), &whole.planes)?;
        let limits = &self.options.limits;
        let missed = |b: &Built| limits_missed(&b.patchwork, &b.certificate, &b.patterns, limits).reasons.len();
        let most = (1.0 + MORE_PARTS) * built.patchwork.panels.len() as f64;
        let is_as_good = parts.patchwork.panels.len() as f64 <= most && missed(&parts) <= missed(built);
        let are_flat = || unproven(&parts, control).len() <= self.unproven.len();
        (is_as_good && are_flat()).then_some((cover, parts))
    }

    /// The best parts, which take the place of the panels at hand.
    fn in_parts(&mut self, (index, built): (usize, &Built), control: &Control) -> Option<Built> {
        let mut best: Option<(Cover, Built)> = None;
        for whole in std::mem::take(&mut self.wholes) {
            let found = self.parted((index, built), whole, control);
            let is_better = |f: &(Cover, Built)| best.as_ref().is_none_or(|b| openness(&f.1) < openness(&b.1));
            best = found.filter(is_better).or(best);
            if best.as_ref().is_some_and(|b| openness(&b.1) == 0.0) {
                break;
            }
        }
        let (cover, parts) = best?;
        self.cover = cover;
        Some(parts)
    }
}

impl Covered {
    /// Whether strips are to meet that do not yet.
    pub(crate) fn is_apart(&self) -> bool {
        self.apart.as_ref().is_some_and(|a| !a.meets)
    }

    /// Proves the flat patterns of strips that are to meet: what meeting must not lose.
    pub(crate) fn assess_flat(&mut self, control: &Control) {
        if let Some(apart) = self.apart.as_mut().filter(|a| !a.meets) {
            apart.unproven = unproven(&self.built, control).into_iter().collect();
        }
    }

    /// The panels, laid anew where neighbours are to meet, as far as that can be certified before time is up.
    pub(crate) fn met(mut self, index: usize, control: &Control) -> Met {
        let mut built = match self.apart.as_mut().filter(|a| !a.meets && !control.stopped()) {
            Some(apart) => apart.in_parts((index, &self.built), control).unwrap_or_else(|| {
                let Apart { cover, options, unproven, .. } = apart;
                let asked = (&*options, &[Recount::Less, Recount::More][..]);
                met(index, cover, (self.built, unproven.clone()), asked, control)
            }),
            None => self.built,
        };
        built.missing.splice(0..0, self.why);
        Met { built, apart: self.apart }
    }
}

/// A face whose panels meet, as far as they do.
pub(crate) struct Met {
    /// Its panels.
    pub built: Built,
    /// What they have been laid on.
    apart: Option<Apart>,
}

impl Met {
    /// Whether its panels can be laid anew to meet those of other faces: what is missed already is told of the panels as they
    /// are.
    pub(crate) fn is_free(&self) -> bool {
        self.apart.is_some() && self.built.missing.is_empty()
    }

    /// The face as one whose panels are laid anew to meet those of others; `borders` says what distances count on its border.
    pub(crate) fn side<'a>(&'a self, index: usize, borders: &'a BorderCounts) -> Option<Side<'a>> {
        let Apart { cover, options, .. } = self.apart.as_ref()?;
        Some(Side { index, cover, built: &self.built, wanted: options, borders })
    }
}

/// One face covered. Where its trim takes too much of the tolerance it is covered as it was read, for the eye, and judged
/// with the whole distance.
///
/// # Errors
/// Trim loops that cannot be triangulated.
pub(crate) fn one_face(
    index: usize,
    face: &Face,
    first: Option<Built>,
    wanted: &Wanted,
) -> Result<Covered, TriangulateError> {
    let mut face = face.clone();
    let (missed, tolerance) = (face.trim_bound(), wanted.options.tolerance);
    if missed <= TRIM_SHARE * tolerance {
        return covered(index, face, first, wanted);
    }
    face.set_trim_bound(0.0);
    let found = covered(index, face, None, wanted)?;
    let mut found = Covered { apart: None, ..found };
    let built = &mut found.built;
    // What ends beside a pole is missing besides.
    built.patchwork.faces.iter_mut().for_each(|f| f.set_trim_bound((missed + f.trim_bound()).next_up()));
    let clock = match wanted.control.stopped() {
        true => Control::default().until(Instant::now() + FILLING),
        false => Control::default(),
    };
    built.certificate = certify::patchwork(&built.patchwork, tolerance, &clock);
    Ok(found)
}

/// The loop over one face: cover, build, judge, develop; then what limits ask for.
fn covered(index: usize, mut face: Face, first: Option<Built>, wanted: &Wanted) -> Result<Covered, TriangulateError> {
    corners_on_knot_lines(&mut face);
    let (control, whole) = (wanted.control, wanted.options.tolerance);
    // What trimming missed and joining moved belongs to the distance from the file's faces: the rest is left for the
    // search.
    let tolerance = whole - face.joint_bound() - face.trim_bound();
    let mut options = CoverOptions { tolerance, ..wanted.options.clone() };
    let mut stopgap = first;
    // What is developable already needs no search: it is covered even when time is up.
    let exact = exactly_covered(&face, &options, &Control::default());
    let is_exact = exact.is_some();
    let exact = exact.or_else(|| {
        let cover = revolved(&face, &options, &wanted.between, control)?;
        face = (*cover.face).clone();
        options.tolerance = whole - face.joint_bound() - face.trim_bound();
        Some(cover)
    });
    // Where a limit is given up, the panels say why.
    let mut why = None;
    let mut found = match exact {
        Some(cover) => cover,
        None => {
            if let Some(left) = control.remaining() {
                let end = Instant::now() + left.mul_f64(STOPGAP_SHARE);
                stopgap = stopgaps(index, &face, &options, (stopgap, &control.clone().until(end)));
            }
            let (search, reason) = wanted.search(&face, &options);
            let found = cover(&face, &options, &search)?;
            if found.is_complete() || control.stopped() || !search.stopped() {
                found
            } else {
                // Without the limit of bending: panels that miss it are marked, and the rest is good.
                why = reason;
                options.limits.min_bend_radius = None;
                cover(&face, &options, control)?
            }
        }
    };
    let told = |built: Built| Covered { built, why, apart: None };
    while !found.is_complete() && !control.stopped() {
        // Too many panels: the fewest that were asked for, as near as they can be.
        options.tolerance *= COARSER;
        found = cover(&face, &options, control)?;
    }
    if !found.is_complete() {
        // Time is up: a coarse cover of all of it says more than a fine one of a part.
        let coarse = stopgap.take().or_else(|| stopgaps(index, &face, &options, (None, &wanted.grace())));
        return Ok(told(coarse.unwrap_or_else(|| filled(index, found, whole))));
    }
    if (control.stopped() && !is_exact) || options.tolerance > tolerance {
        // What is found as time runs out is judged in a moment, or not at all.
        let clock = if control.stopped() { wanted.grace() } else { Control::default() };
        let built = build_until(index, &found, whole, &clock).0;
        let unknown = !built.certificate.deviation_bound.is_finite();
        return Ok(told(stopgap.filter(|_| unknown && control.stopped()).unwrap_or(built)));
    }
    let task = Task { index, face: &face, whole, options, control };
    let (mut laid, mut wholes) = (task.laid(found, Vec::new()), Vec::new());
    if laid.accepted && !too_large(&laid.built, &task.options.limits).is_empty() {
        Fitted { laid, wholes } = sheet::fitted(&task, slivers::widened(&task, laid));
    }
    if laid.accepted {
        laid = slivers::widened(&task, laid);
    }
    let Laid { cover, built, accepted, seams } = laid;
    if control.stopped() && !built.certificate.deviation_bound.is_finite() {
        return Ok(told(stopgap.unwrap_or(built)));
    }
    if !accepted && control.stopped() {
        return Ok(told(built));
    }
    let meets = built.certificate.seams.iter().all(|s| s.status == SeamStatus::Exact);
    // What is developable already lies on its face.
    if !accepted || !wanted.meet || (meets && is_exact) || control.stopped() {
        return Ok(told(built));
    }
    let wholes = wholes.into_iter().map(|(whole, planes)| Whole::of(&task, whole, planes)).collect();
    let options = task.options_with(&seams);
    let apart = Apart { meets, cover, options, unproven: BTreeSet::new(), wholes };
    Ok(Covered { apart: Some(apart), ..told(built) })
}

/// Covers of a whole face from coarse to fine, each proven, until time is up: the finest. One may be at hand.
fn stopgaps(
    index: usize,
    face: &Face,
    wanted: &CoverOptions,
    (mut best, control): (Option<Built>, &Control),
) -> Option<Built> {
    let mut tolerance = COARSEST * face.surface.bbox().diagonal();
    if best.is_some() {
        tolerance /= STOPGAP_STEP;
    }
    while tolerance > STOPGAP_STEP * wanted.tolerance && !control.stopped() {
        best = stopgap(index, face, wanted, (tolerance, control)).or(best);
        tolerance /= STOPGAP_STEP;
    }
    best
}

/// A cover of a whole face that is proven to keep to a tolerance (mm), or to a bound near it; `None` where time is up
/// before.
fn stopgap(index: usize, face: &Face, wanted: &CoverOptions, (tolerance, control): (f64, &Control)) -> Option<Built> {
    // What was asked for besides the tolerance would only take time here; what is missed is marked.
    let options = CoverOptions { tolerance, limits: Limits::default(), layout: Layout::default(), ..wanted.clone() };
    let found = cover(face, &options, control).ok().filter(Cover::is_complete)?;
    let built = build_until(index, &found, tolerance, control).0;
    built.certificate.deviation_bound.is_finite().then_some(built)
}

/// A cover that time has cut short, its gaps filled with what is near; judged with the distance of what was found, so that
/// it has a bound where one can be shown in a moment.
fn filled(index: usize, mut cover: Cover, whole: f64) -> Built {
    cover.fill(&Control::default().until(Instant::now() + FILLING));
    let worst = cover.panels.values().map(|fit| fit.error).fold(0.0, f64::max);
    let tolerance = if worst.is_finite() { whole.max(LOOSE * worst) } else { whole };
    build_until(index, &cover, tolerance, &Control::default().until(Instant::now() + FILLING)).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::{knots::Knots, surface::Surface};

    #[test]
    fn limits_that_hardly_any_panel_keeps_leave_time_for_a_cover_without_them() {
        // A dome of about 25 mm radius both ways.
        let k = Knots::clamped(2, &[0.0, 1.0]).expect("knots");
        let rise = [0.0, 4.0, 0.0];
        let points: Vec<Vec3> = (0..9)
            .map(|i| Vec3::new(10.0 * f64::from(i / 3), 10.0 * f64::from(i % 3), 0.0))
            .enumerate()
            .map(|(i, p)| p + Vec3::z() * (rise[i / 3] + rise[i % 3]))
            .collect();
        let face = Face::untrimmed(Surface::new(k.clone(), k, &points, None).expect("surface"));
        let asked = |min_bend_radius: Option<f64>| CoverOptions {
            limits: Limits { min_bend_radius, ..Limits::default() },
            ..CoverOptions::new(0.01)
        };
        let options = asked(Some(1e3));
        let searched = |control: &Control, options: &CoverOptions| {
            let deadline = OnceLock::new();
            let between = HashSet::default();
            Wanted { options: options.clone(), meet: false, control, between, deadline }.search(&face, options)
        };
        let (control, why) = searched(&Control::default().until(Instant::now() + Duration::from_secs(1000)), &options);
        let left = control.remaining().expect("a time");
        assert!(why.is_some() && left < Duration::from_secs(510) && left > Duration::from_secs(400), "{left:?}");
        let (control, why) = searched(&Control::default(), &options);
        assert!(why.is_some() && control.remaining().is_none());
        let (_, why) = searched(&Control::default(), &asked(None));
        assert!(why.is_none());
    }
}
