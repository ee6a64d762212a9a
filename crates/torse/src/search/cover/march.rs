//! Bands of a strip potential: greedy marching with width control, every component on its own (B3.6, C5).

use super::covered_face::Cover;
use super::job::{Job, DISTANCE_SHARE};
use super::propose::AttemptOptions;
use super::region::Region;
use crate::fit::near::centre_line::centre_line;
use crate::fit::near::samples::Fit;
use crate::fit::strip_potential::StripPotential;
use crate::num::parallel;
use crate::spline::field::Field;
use crate::torse::form::Ruling;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Arc;

/// Width trials for one band, or for one strip beside a curve.
pub(super) const TRIALS: usize = 8;
/// A band is wide enough when its error reaches this share of the tolerance.
const WIDE: f64 = 0.86;
/// Narrowest band, as a share of the theoretical width, before its region is bisected instead.
const NARROWEST: f64 = 0.2;
/// Bands below this share of the theoretical width count as narrow (C5)…
const POOR_WIDTH: f64 = 0.55;
/// … and after so many of them in a row the rest is given to a new strip potential.
const PATIENCE: usize = 2;
/// A rest below this share of the march's range gets a strip potential of its own when bands fail.
const FRESH: f64 = 0.9;
/// A resisting end is left behind when what lies beyond is at least this many bands wide…
const BEHIND: f64 = 3.0;
/// … at most so many times in a march.
const SKIPS: usize = 3;
/// Widths are sought until the widest good one is that near to the narrowest bad one.
const CLOSE: f64 = 1.02;
/// Factor on the width where it is not known how much too wide a band is, or a strip beside a curve.
pub(super) const UNKNOWN: f64 = 0.6;
/// A rest of less than this share of a band is tried together with it; of two bands that are joined afterwards, one that is smaller
/// than this share of the other is such a rest, and worth a fit along the centre line of the other.
pub(super) const REST: f64 = 0.15;

/// Depth of the recursion down to which marches start from both ends: deeper, trying both would double the work at
/// every level.
const BOTH_ENDS_DEPTH: usize = 0;
/// Of a rest that is too wide for one band, at most this share goes into the next.
const LARGEST_PART: f64 = 0.9;

/// How bands are laid.
struct Lay<'f> {
    field: &'f Arc<Field>,
    /// Theoretical width in units of the field; `None` for sweeps.
    theory: Option<f64>,
    /// Give up instead of bisecting.
    strict: bool,
    depth: usize,
}

/// Directions of the sweep.
pub(super) const SWEEP_DIRECTIONS: usize = 8;
/// Covers that compete are told apart by their ranks, all below this: a direction each, and one for what comes after all of them.
const RANKS: usize = SWEEP_DIRECTIONS + 1;

/// Order of competing covers: fewer panels first, then the lower rank.
pub(super) fn key(panels: usize, rank: usize) -> usize {
    panels.saturating_mul(RANKS).saturating_add(rank)
}

/// The best cover so far among several that are sought at the same time; which of them wins does not depend on their
/// speed.
#[derive(Clone, Copy)]
pub(super) struct Limit<'a> {
    /// Smallest [`key`] so far.
    pub(super) best: &'a AtomicUsize,
    /// Rank of the cover that is limited.
    pub(super) rank: usize,
    /// Panels with which it is given up in any case.
    pub(super) most: usize,
}

impl Limit<'_> {
    /// The limit for a cover that competes with nothing but a number of panels.
    fn of(panels: &AtomicUsize) -> Limit<'_> {
        Limit { best: panels, rank: 0, most: usize::MAX }
    }

    /// Whether a cover of so many panels, or more, cannot win.
    fn excludes(&self, panels: usize) -> bool {
        panels > self.most || key(panels, self.rank) > self.best.load(Ordering::Relaxed)
    }

    /// Largest number of panels that may still win.
    fn panels(&self) -> usize {
        self.best.load(Ordering::Relaxed) / RANKS
    }
}

/// What is left to do of a march.
struct Rest {
    label: u32,
    width: f64,
    /// Consecutive bands that came out far narrower than theory.
    narrow: usize,
}

impl Job<'_> {
    /// Bands along a strip potential.
    pub(super) fn bands(
        &self,
        region: Region,
        potential: &StripPotential,
        budget: usize,
        depth: usize,
    ) -> Option<Cover> {
        let theory = 4.0 * self.options.tolerance.sqrt();
        let mut falling = potential.field.clone();
        falling.coefficients.iter_mut().for_each(|c| *c = -*c);
        // Each end has the whole budget for itself: what is found must not depend on which of them is faster.
        let run = |field: &Field| {
            let field = &Arc::new(field.clone());
            let lay = Lay { field, theory: Some(theory), strict: false, depth };
            self.march(
                region.cover.clone(),
                region.label,
                &lay,
                theory,
                Limit::of(&AtomicUsize::new(key(budget, RANKS - 1))),
            )
        };
        if depth > BOTH_ENDS_DEPTH {
            return run(&potential.field);
        }
        let (up, down) = parallel::join(|| run(&potential.field), || run(&falling));
        match (up, down) {
            (Some(a), Some(b)) => Some(if b.panels.len() < a.panels.len() { b } else { a }),
            (a, b) => a.or(b),
        }
    }

    /// Bands of a linear function, given up as soon as they exceed `limit`.
    pub(super) fn swept(&self, region: Region, field: &Field, limit: Limit) -> Option<Cover> {
        let (lo, hi) = region.range(field);
        let field = &Arc::new(field.clone());
        let lay = Lay { field, theory: None, strict: true, depth: 0 };
        self.march(region.cover.clone(), region.label, &lay, 0.25 * (hi - lo), limit)
    }

    fn march(&self, mut cover: Cover, label: u32, lay: &Lay, width: f64, limit: Limit) -> Option<Cover> {
        let before = cover.panels.len();
        let (lo, hi) = cover.region(label).range(lay.field);
        let whole = hi - lo;
        let mut open = vec![Rest { label, width, narrow: 0 }];
        let mut skipped = 0;
        while let Some(rest) = open.pop() {
            let used = cover.panels.len() - before;
            if self.control.stopped() {
                return Some(cover);
            }
            if limit.excludes(used + open.len() + 1) {
                return None;
            }
            if rest.narrow >= PATIENCE {
                // The strip potential is poor here: what is left gets one of its own.
                let budget = limit.panels().saturating_sub(used + open.len());
                cover = self.region_covered(cover, rest.label, budget, lay.depth + 1)?;
                continue;
            }
            match self.band(&cover, &rest, lay) {
                Some((next, more)) => {
                    cover = next;
                    open.extend(more);
                }
                None if lay.strict => return None,
                None => {
                    let budget = limit.panels().saturating_sub(used + open.len());
                    let (lo, hi) = cover.region(rest.label).range(lay.field);
                    if hi - lo > BEHIND * width && skipped < SKIPS {
                        // The end resists: it is left behind for other means, and the march goes on beyond it.
                        skipped += 1;
                        let end = cover.partition.fresh_label();
                        let level = lo + width;
                        cover.cut(rest.label, end, |p| level - lay.field.value(p));
                        let ahead = cover.partition.split_components(rest.label);
                        for label in cover.partition.split_components(end) {
                            let used = cover.panels.len() - before;
                            let budget = limit.panels().saturating_sub(used + open.len() + ahead.len());
                            cover = self.region_covered(cover, label, budget, lay.depth + 1)?;
                        }
                        open.extend(ahead.into_iter().map(|label| Rest { label, width, narrow: 0 }));
                        continue;
                    }
                    // A strip potential of its own may do better on what is left; the whole region must be cut.
                    cover = if hi - lo < FRESH * whole {
                        self.region_covered(cover, rest.label, budget, lay.depth + 1)?
                    } else {
                        self.bisect(cover, rest.label, budget, lay.depth + 1)?
                    };
                }
            }
        }
        Some(cover)
    }

    /// The widest acceptable band at the lower end of a region; the components of the rest go on by themselves.
    #[expect(clippy::too_many_lines, reason = "one march with its state")]
    fn band(&self, cover: &Cover, rest: &Rest, lay: &Lay) -> Option<(Cover, Vec<Rest>)> {
        let (lo, hi) = cover.region(rest.label).range(lay.field);
        let narrowest = lay.theory.map_or((hi - lo) / 60.0, |t| NARROWEST * t);
        let mut width = rest.width;
        let mut accepted: Option<(f64, Cover, Vec<u32>)> = None;
        let (mut too_wide, mut good) = (f64::INFINITY, 0.0);
        let mut whole_failed = false;
        // The torse of the last trial.
        let mut from: Option<Arc<Fit>> = None;
        for _ in 0..TRIALS {
            if self.control.stopped() {
                return None;
            }
            // Two bands of about equal width serve better than one and a sliver.
            let halved = whole_failed && width > LARGEST_PART * (hi - lo);
            if halved {
                width = 0.5 * (hi - lo);
            }
            let whole = !whole_failed && lo + width * (1.0 + REST) >= hi;
            let mut trial = cover.clone();
            let band_label = if whole {
                width = hi - lo;
                rest.label
            } else {
                let fresh = trial.partition.fresh_label();
                let level = lo + width;
                trial.cut(rest.label, fresh, |p| level - lay.field.value(p));
                fresh
            };
            let mut others: Vec<u32> = Vec::new();
            if !whole {
                if trial.region(rest.label).cells().is_empty() {
                    // The cut took everything.
                    return None;
                }
                others = trial.partition.split_components(rest.label);
            }
            let bands = trial.partition.split_components(band_label);
            let mut error: f64 = 0.0;
            let mut ok = true;
            let (mut refused, mut misshapen) = (None, false);
            for &b in &bands {
                let (lo, hi) = trial.region(b).range(lay.field);
                let centre = self.centre(trial.region(b), lay.field, 0.5 * (lo + hi));
                let from = from.as_deref().filter(|_| bands.len() == 1);
                let t = self.tried(trial.region(b), Some(&centre), AttemptOptions { from, ..AttemptOptions::USUAL });
                match t.accepted {
                    Some(fit) => {
                        error = error.max(t.error);
                        trial.panels.insert(b, fit);
                        trial.bands.insert(b, Arc::clone(lay.field));
                    }
                    None => {
                        error = error.max(t.error);
                        ok = false;
                        (refused, misshapen) = (t.refused, t.misshapen);
                        break;
                    }
                }
            }
            if let [b] = bands[..] {
                from = trial.panels.get(&b).cloned().or(refused.map(Arc::new)).or(from);
            }
            let share = error / (self.options.tolerance * DISTANCE_SHARE);
            if ok {
                if whole {
                    return Some((trial, Vec::new()));
                }
                good = width;
                accepted = Some((width, trial, others));
                if share >= WIDE || halved {
                    break;
                }
            } else {
                too_wide = width;
                whole_failed |= whole;
            }
            if too_wide <= good * CLOSE {
                break;
            }
            let factor = if share.is_finite() && !misshapen { (0.95 / share).sqrt().clamp(0.4, 2.0) } else { UNKNOWN };
            width *= if ok { factor.max(1.02) } else { factor.min(0.98) };
            if too_wide.is_finite() && width >= too_wide {
                width = 0.5 * (good + too_wide);
            }
            if width <= good {
                width = if too_wide.is_finite() { 0.5 * (good + too_wide) } else { good * 1.1 };
            }
            if width < narrowest {
                break;
            }
        }
        let (width, cover, others) = accepted?;
        let poor = lay.theory.is_some_and(|t| width < POOR_WIDTH * t);
        let narrow = if poor { rest.narrow + 1 } else { 0 };
        // The next march starts hopeful again where a single band was narrow.
        let width = if poor { width * 1.5 } else { width };
        Some((cover, others.into_iter().map(|label| Rest { label, width, narrow }).collect()))
    }

    /// Centre line of a band: the level of its field at the value `middle`.
    pub(super) fn centre(&self, region: Region, field: &Field, middle: f64) -> Vec<Ruling> {
        let off = |p: &[f64; 2]| (field.value(*p) - middle).abs();
        let seed = region.places().into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        let Some(mut seed) = seed else { return Vec::new() };
        for _ in 0..3 {
            let [f, fu, fv] = field.jet(seed[0], seed[1]);
            let g = fu * fu + fv * fv;
            if g > 0.0 {
                seed = [seed[0] + (middle - f) * fu / g, seed[1] + (middle - f) * fv / g];
            }
        }
        centre_line(&self.face.surface, field, region.bounds(), seed, region.bbox().diagonal())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cover_is_given_up_with_its_own_limit_or_that_of_the_best() {
        let best = AtomicUsize::new(key(20, 3));
        let limit = |most: usize, rank: usize| Limit { best: &best, rank, most };
        let first_excluded = |l: Limit| (1..30).find(|&n| l.excludes(n));
        // As many panels as the best has are good enough for a lower rank.
        assert_eq!(first_excluded(limit(usize::MAX, 2)), Some(21));
        assert_eq!(first_excluded(limit(usize::MAX, 4)), Some(20));
        assert_eq!(first_excluded(limit(12, 2)), Some(13));
    }
}
