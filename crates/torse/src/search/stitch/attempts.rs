//! Strips that meet: the strips of a covered face are changed, and their borders moved, until neighbours end on common edges, as
//! far as that can be certified.
//!
//! First all strips in one program, without those that are refused; then strips as they are, with the borders that are still
//! open where they intersect. The best panels are kept, and those of the cover if nothing better can be proven.

use super::bordering::{Bordering, Moving};
use super::intersection::Intersections;
use super::openness::{open, openness};
use super::stitching::Stitching;
use super::together::{Together, REGULAR};
use crate::control::Control;
use crate::search::build::Built;
use crate::search::cover::{Cover, CoverOptions, Job, Limits, Recount};
use crate::torse::form::Torse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

/// See [`Stitching::most`], of another number of strips than the cover has: nine strips of the half bowl at 1 mm end at 0.990 and are
/// proven, where ends of panels cost more the proof finds some percent more.
const NEAR_ENOUGH: f64 = 0.995;
/// Gaps (tolerances) up to which strips are laid end to end: their borders move by little.
const END_TO_END: f64 = 0.01;

/// Attempts to make the strips of a face meet.
struct Attempts<'a> {
    of: Stitching<'a>,
    /// The best panels so far.
    best: Built,
}

/// The same panels, with the labels of those whose flat patterns are not proven, laid anew so that neighbours meet, as far as that
/// can be certified; as they are where it cannot. Asked for are what covers are, and what other numbers of strips may be tried.
pub(crate) fn met(
    index: usize,
    cover: &Cover,
    (built, unproven): (Built, BTreeSet<u32>),
    (wanted, recounts): (&CoverOptions, &[Recount]),
    control: &Control,
) -> Built {
    let of = Stitching {
        index,
        cover,
        built: &built,
        tolerance: built.certificate.tolerance,
        wanted,
        control,
        known: Arc::default(),
        unproven: OnceLock::from(unproven),
        most: f64::INFINITY,
        borders: None,
    };
    let mut attempts = Attempts { of, best: built.clone() };
    // Strips that are laid end to end need edges, and nothing else.
    if attempts.is_end_to_end() {
        attempts.intersect();
    }
    if recounts.contains(&Recount::Less) && attempts.recounted(Recount::Less) {
        return attempts.best;
    }
    // Borders that the program has left open are moved at once, which may spare its next solution; those of the cover only where
    // it has brought nothing.
    if !attempts.changed_together() {
        attempts.intersect();
    }
    if recounts.contains(&Recount::More) {
        attempts.recounted(Recount::More);
    }
    attempts.best
}

impl Attempts<'_> {
    /// Whether strips are equally high along all their borders.
    fn is_end_to_end(&self) -> bool {
        let torses = torses(&self.best);
        let base = self.of.cover.as_built(&self.best);
        let largest = base.and_then(|cover| Intersections::new(&torses).on(&cover).largest_gap());
        largest.is_some_and(|gap| gap <= END_TO_END * self.of.tolerance)
    }

    /// Whether something is left to be done, and time for it.
    fn is_open(&self) -> bool {
        openness(&self.best) > 0.0 && !self.of.control.stopped()
    }

    /// Strips of one program in place of those at hand, with one share of their regularity after the other until all seams are
    /// closed; whether that brought anything.
    fn changed_together(&mut self) -> bool {
        let Some(base) = self.of.cover.as_built(self.of.built) else { return false };
        let mut moved = false;
        for regular in REGULAR {
            if !self.is_open() {
                break;
            }
            let next = Together { of: &self.of, base: &base }.joined(regular, &self.best);
            if next.is_some_and(|next| self.keep(next)) {
                self.intersect();
                moved = true;
            }
        }
        moved
    }

    /// Tries another number of strips, where no limits or seams are asked for; whether all of them meet then.
    fn recounted(&mut self, recount: Recount) -> bool {
        let Stitching { cover, tolerance, wanted, control, .. } = self.of;
        let layout = &wanted.layout;
        let free = wanted.limits == Limits::default() && layout.seams.is_empty() && layout.curves.is_empty();
        if !free || !self.is_open() {
            return false;
        }
        let Some(next) = Job::new(&cover.face, wanted, control).recounted(cover, recount) else { return false };
        let next = next.with_smooth_borders(tolerance, |_| true);
        // Labels are others, and no flat pattern is given up.
        let unproven = OnceLock::from(BTreeSet::new());
        let of = Stitching { cover: &next, known: Arc::clone(&self.of.known), unproven, most: NEAR_ENOUGH, ..self.of };
        let Some(best) = Together { of: &of, base: &next }.joined(REGULAR[0], &self.best) else { return false };
        let mut others = Attempts { of, best };
        others.intersect();
        let all_meet = openness(&others.best) == 0.0;
        if all_meet {
            self.best = others.best;
        }
        all_meet
    }

    /// Moves borders that are still open to where the strips of the best panels intersect.
    fn intersect(&mut self) {
        if self.is_open() {
            if let Some(next) = self.intersecting() {
                self.keep(next);
            }
        }
    }

    /// Takes panels that are nearer to meeting and miss no more limits; whether it did.
    fn keep(&mut self, next: Built) -> bool {
        let is_better = self.of.is_better(&next, &self.best);
        if is_better {
            self.best = next;
        }
        is_better
    }

    /// The best panels with their borders where they intersect, in place of those along which they do not meet. `None` where
    /// that is not possible, or cannot be proven.
    fn intersecting(&self) -> Option<Built> {
        let built = &self.best;
        let torses = torses(built);
        let strips = Intersections::new(&torses);
        let base = self.of.cover.as_built(built)?;
        let wanted: Vec<[u32; 2]> = open(built).into_iter().filter(|p| !self.of.is_asked_for(built, *p)).collect();
        Bordering { of: &self.of, strips: &strips, base: &base, how: Moving::Accepted(built) }.panels(wanted).ok()
    }
}

/// Torses of panels by their labels.
fn torses(built: &Built) -> BTreeMap<u32, &Torse> {
    let trims = built.patchwork.panels.iter().filter_map(|p| p.trim.as_ref());
    trims.filter_map(|t| Some((t.label, t.form.torse()?))).collect()
}
