//! Bands of a strip potential laid all at once: as many as theory asks for, their widths evened out until all have the
//! same error (B3.6).
//!
//! The error of a band grows with the square of its width. Fitting all bands once therefore tells how dense the levels
//! must lie everywhere, and how many bands are needed; a few rounds settle it. Single bands that are then still a little
//! too wide give of their width to neighbours with something to spare; all others keep their torses. Components far
//! narrower than their band join the band beside them. Marching, which needs some trials per band one after the other,
//! is left to regions where this fails; what it leaves is laid anew in this way where its errors say that this pays.

use super::covered_face::Cover;
use super::job::{Job, DISTANCE_SHARE};
use super::propose::{Attempt, AttemptOptions};
use super::region::{Density, Region};
use crate::fit::near::samples::Fit;
use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;
use crate::spline::field::Field;
use crate::torse::form::Ruling;
use std::sync::Arc;

/// Fewer bands than this are left to the march: errors of wide bands follow no law.
const FEWEST: f64 = 7.0;
/// More bands than this are asked for where a strip potential is no good, as around a pole.
const MOST_BANDS: f64 = 1000.0;
/// Rounds of fitting all bands, at most: numbers of bands may go up and down.
const ROUNDS: usize = 8;
/// The same where bands are laid anew whose widths are nearly right.
const ROUNDS_ANEW: usize = 4;
/// Bands whose share is below this are remainders of a march: less than about two thirds as wide as they could be.
const REMAINDER: f64 = 0.5;
/// Bands none of whose shares exceed this do not end where they do because of the tolerance: their widths follow no law.
const LIMITED: f64 = 0.75;
/// So many bands are laid anew for the sake of a remainder; fewer may end where they do because a surface closes.
const SEVERAL: usize = 4;
/// Components that are narrower than this share of their band become part of their neighbours.
const NARROW: f64 = 0.4;
/// Rounds with the same number of bands.
const SAME: usize = 3;
/// Share of the allowed distance that levels are laid for: errors follow the square law within some percent.
pub(super) const AIM: f64 = 0.965;
/// Shares below this count as this: fits end early when they are good enough.
const LEAST_SHARE: f64 = 0.3;
/// Shares above this count as this, and what no torse fits. Bands that resist so much once the levels are laid anew
/// are left to the march.
const MOST_SHARE: f64 = 2.5;
/// Bands whose shares differ by less than this factor count as even.
const EVEN: f64 = 1.15;
/// Times that single bands are narrowed in a round.
const REPAIRS: usize = 2;
/// Bands with larger shares are not narrowed on their own.
const MOST_REPAIRED: f64 = 1.2;
/// Fewer bands than this are not narrowed on their own: their errors hardly follow the law.
const FEWEST_NARROWED: usize = 16;
/// Of so many bands one may resist and be divided in two.
const ONE_RESISTS_OF: usize = 8;
/// Share by which areas of the same region may differ, by rounding.
const SAME_AREA: f64 = 1e-9;
/// Share for which a band is laid that gives of its width, and the one up to which others take it.
const GIVES: f64 = 0.955;
/// See [`GIVES`].
const TAKES: f64 = 0.975;
/// A band gives of its width to bands at most so many places away.
const NEAR: usize = 4;
/// Bands begin with the torse of one with which they share more than this.
const OVERLAP: f64 = 0.5;
/// Further bands that may be tried beyond theory, as a share of it and in number.
const MORE: (f64, f64) = (0.3, 2.0);

/// One component of a band.
struct BandPart {
    label: u32,
    fit: Option<Arc<Fit>>,
    /// The best torse, where none is good enough.
    refused: Option<Arc<Fit>>,
    /// Its error as a share of the allowed distance.
    share: f64,
    /// Area, mm², once the torse is proven.
    proven: Option<f64>,
}

impl Job<'_> {
    /// Covers a region by bands between levels of a function, all laid at once. `theory`: number of bands that theory
    /// asks for, and how dense they must lie in equal parts of the function's range. With the cover comes the share of
    /// the tolerance that its bands leave, in the mean. `None` where bands resist, or where no number of panels up to
    /// `budget` will do.
    pub(super) fn equidistribute(
        &self,
        region: Region,
        field: &Field,
        (theory, density): (f64, &[f64]),
        budget: usize,
    ) -> Option<(Cover, f64)> {
        if !(FEWEST..MOST_BANDS).contains(&theory) {
            return None;
        }
        let most = (theory * (1.0 + MORE.0) + MORE.1) as usize;
        let count = (theory.ceil() as usize).clamp(1, budget.max(1));
        let (lo, hi) = region.range(field);
        let rise = Rise::guessed(lo, hi, density);
        let start = Start { levels: rise.levels(count), rise, known: Vec::new(), rounds: ROUNDS, most };
        self.settled(region, field, start, budget)
    }

    /// A cover by bands of one function laid one after the other, as [`Job::march`] leaves it, laid anew with even
    /// errors where that needs fewer panels or where one of the bands is but a remainder. `bare`: the region that `cover`
    /// covers, before it does.
    pub(super) fn evened(&self, bare: Region, cover: Cover) -> Cover {
        let allowed = self.options.tolerance * DISTANCE_SHARE;
        let Some((field, fresh)) = bare.cover.chain(&cover) else { return cover };
        let bands: Vec<[f64; 3]> = fresh
            .iter()
            .map(|l| {
                let (lo, hi) = cover.region(*l).range(&field);
                [lo, hi, (cover.panels[l].error / allowed).max(LEAST_SHARE)]
            })
            .collect();
        let rise = Rise::of_bands(&bands);
        let count = rise.needed().min(fresh.len());
        let remainder = bands.iter().any(|b| b[2] < REMAINDER) && bands.iter().any(|b| b[2] > LIMITED);
        let uneven = remainder && fresh.len() >= SEVERAL;
        if count == fresh.len() && !uneven {
            return cover;
        }
        let known = fresh.iter().zip(&bands).map(|(l, b)| Known {
            ends: [b[0], b[1]],
            good: Vec::new(),
            single: cover.panels.get(l).cloned(),
        });
        let known = known.collect();
        let start = Start { levels: rise.levels(count), rise, known, rounds: ROUNDS_ANEW, most: fresh.len() };
        let least = |cover: &Cover| bare.cover.newly(cover).map(|(_, fit)| fit.error).fold(f64::INFINITY, f64::min);
        match self.settled(bare, &field, start, fresh.len()) {
            Some((s, _)) if s.panels.len() < cover.panels.len() || (uneven && least(&s) > least(&cover)) => s,
            _ => cover,
        }
    }

    /// Lays bands of `field` until their errors are even; see [`Job::equidistribute`].
    #[expect(clippy::too_many_lines, reason = "one descent with its state")]
    fn settled(&self, region: Region, field: &Field, start: Start, budget: usize) -> Option<(Cover, f64)> {
        let Start { mut rise, mut levels, mut known, rounds, most } = start;
        let mut count = levels.len() - 1;
        // Panels and largest share of the best cover, mean of what its bands leave of the tolerance, and itself.
        let mut best: Option<((usize, f64), f64, Cover)> = None;
        let levels_of = Arc::new(field.clone());
        let mut same = 0;
        // Fewer bands than this have failed.
        let mut least_count = 1;
        let (mut round, mut repairs) = (0, 0);
        let mut divided = None;
        while round < rounds {
            if count > budget.min(most) || self.control.stopped() {
                break;
            }
            let (laid, bands) = self.laid(region, field, &levels, &known);
            let shares: Vec<f64> =
                bands.iter().map(|b| b.iter().fold(LEAST_SHARE, |m, p| m.max(p.share)).min(MOST_SHARE)).collect();
            let worst = shares.iter().copied().fold(0.0, f64::max);
            let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
            let needed = bands_for(shares.iter().map(|s| s.sqrt()).sum());
            rise.include(&levels, &shares);
            let complete = bands.iter().flatten().all(|p| p.fit.is_some());
            let resist: Vec<bool> = bands.iter().map(|b| b.iter().any(|p| p.fit.is_none())).collect();
            let resisting = resist.iter().filter(|r| **r).count();
            if !complete && resisting <= (count / ONE_RESISTS_OF).max(1) && count + resisting <= budget {
                divided = Some(halved(&levels, &resist));
            }
            known = levels
                .windows(2)
                .zip(&bands)
                .map(|(w, band)| Known {
                    ends: [w[0], w[1]],
                    good: band.iter().filter_map(|p| Some((p.fit.clone()?, p.proven))).collect(),
                    single: if let [p] = &band[..] { p.fit.clone().or(p.refused.clone()) } else { None },
                })
                .collect();
            if !complete && count >= FEWEST_NARROWED && repairs < REPAIRS && (round > 0 || worst <= EVEN * EVEN * least)
            {
                if let Some(next) = repaired(&levels, &shares) {
                    levels = next;
                    repairs += 1;
                    continue;
                }
            }
            round += 1;
            if complete {
                let key = (bands.iter().map(Vec::len).sum::<usize>(), worst);
                if key.0 <= budget && best.as_ref().is_none_or(|b| key < b.0) {
                    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
                    best = Some((key, 1.0 - mean, finished(laid, bands, &levels_of)));
                }
                // No fewer can be hoped for, and they are even, or as even as another round makes them.
                if needed.max(least_count) >= count && (worst <= EVEN * least || same > 0 || repairs > 0) {
                    break;
                }
            } else if round > 1 && worst >= MOST_SHARE && resisting > (count / ONE_RESISTS_OF).max(1) {
                break;
            }
            // One band fewer is not tried before all bands of a round were good.
            let fewer = complete || needed + 1 < count;
            let next = if worst < MOST_SHARE && fewer { needed.max(least_count) } else { needed.max(count) };
            if next == count {
                same += 1;
                if same >= SAME {
                    if best.is_some() {
                        break;
                    }
                    least_count = count + 1;
                    count += 1;
                    same = 0;
                }
            } else {
                if best.is_some() && next > count {
                    break;
                }
                count = next;
                same = 0;
            }
            repairs = 0;
            levels = rise.levels(count);
        }
        if best.is_none() && !self.control.stopped() {
            // A few bands resist, the others are good: two in place of each.
            let (laid, bands) = self.laid(region, field, &divided?, &known);
            let panels: Vec<&BandPart> = bands.iter().flatten().collect();
            let within = panels.len() <= budget && panels.iter().all(|p| p.fit.is_some());
            // The march may do better than halves.
            return within.then(|| (finished(laid, bands, &levels_of), 1.0));
        }
        best.map(|b| (b.2, b.1))
    }

    /// The bands between levels, with the best torse of each of their components: proven when all bands might do. Bands
    /// of the round before that have not moved keep the torses that are `known` for them; the others, where they are few,
    /// begin with that of the band with which they share the most.
    fn laid(&self, region: Region, field: &Field, levels: &[f64], known: &[Known]) -> (Cover, Vec<Vec<BandPart>>) {
        let (laid, mut pieces) = self.proposed(region, field, levels, known);
        if pieces.iter().flatten().all(|p| p.fit.is_some()) {
            let how = AttemptOptions { prove: true, ..proposals(known) };
            let proven = |p: &mut BandPart, w: &[f64]| {
                let Some(fit) = p.fit.as_ref().filter(|_| p.proven.is_none()) else { return };
                let region = laid.region(p.label);
                let mut t = self.confirmed(region, fit);
                if t.accepted.is_none() {
                    t = self.tried(region, Some(&self.middle(region, field, w)), how);
                }
                *p = self.piece(p.label, t);
                p.proven = p.fit.as_ref().map(|_| region.area());
            };
            parallel::for_each(pieces.iter_mut().zip(levels.windows(2)), |(band, w)| {
                parallel::for_each(band.iter_mut(), |p| proven(p, w))
            });
        }
        (laid, pieces)
    }

    /// As [`Job::laid`], nothing proven but what is known.
    fn proposed(&self, region: Region, field: &Field, levels: &[f64], known: &[Known]) -> (Cover, Vec<Vec<BandPart>>) {
        let (mut laid, label) = (region.cover.clone(), region.label);
        let mut bands: Vec<Vec<u32>> = Vec::with_capacity(levels.len() - 1);
        for &level in &levels[1..levels.len() - 1] {
            let fresh = laid.partition.fresh_label();
            laid.cut(label, fresh, |p| level - field.value(p));
            // A band narrower than a hair has no triangle.
            let empty = !laid.partition.labels.contains(&fresh);
            bands.push(if empty { Vec::new() } else { laid.partition.split_components(fresh) });
        }
        bands.push(laid.partition.split_components(label));
        laid.absorb_narrow(&mut bands, field, levels);
        let allowed = self.options.tolerance * DISTANCE_SHARE;
        let how = proposals(known);
        let proposed = |label: u32, w: &[f64], alone: bool| {
            let region = laid.region(label);
            let before = known.iter().find(|k| k.ends[..] == *w).map_or(&[][..], |k| &k.good[..]);
            let sampled = || region.dense_samples(how.density);
            let samples = if before.is_empty() { Vec::new() } else { sampled() };
            let kept = before.iter().find_map(|(fit, proven)| {
                let (error, worst) = crate::fit::near::samples::error(&fit.torse, &samples)?;
                let area = region.area();
                // The same region: its proof still holds.
                let proven = proven.filter(|a| (a - area).abs() <= SAME_AREA * area);
                let fit = (error <= allowed).then(|| Arc::new(Fit { error, worst, ..(**fit).clone() }))?;
                Some(BandPart { label, share: error / allowed, fit: Some(fit), refused: None, proven })
            });
            match kept {
                Some(piece) => piece,
                None => {
                    let near =
                        known.iter().filter(|k| alone && levels.len() <= FEWEST_NARROWED && k.overlap(w) > OVERLAP);
                    let near = near.max_by(|a, b| a.overlap(w).total_cmp(&b.overlap(w)));
                    let from = near.and_then(|k| k.single.as_deref());
                    let centre = self.middle(region, field, w);
                    self.piece(label, self.tried(region, Some(&centre), AttemptOptions { from, ..how }))
                }
            }
        };
        let pieces = parallel::map(bands.iter().zip(levels.windows(2)), |(band, w)| {
            parallel::map(band.iter(), |&label| proposed(label, w, band.len() == 1))
        });
        (laid, pieces)
    }

    /// Bands between levels with the best torses at hand, good enough or not. `None` where some band has none.
    pub(super) fn roughly_laid(&self, region: Region, field: &Arc<Field>, levels: &[f64]) -> Option<Cover> {
        let (laid, mut bands) = self.proposed(region, field, levels, &[]);
        bands.iter_mut().flatten().for_each(|p| p.fit = p.fit.take().or(p.refused.take()));
        bands.iter().flatten().all(|p| p.fit.is_some()).then(|| finished(laid, bands, field))
    }

    /// What was tried on a component of a band.
    fn piece(&self, label: u32, t: Attempt) -> BandPart {
        let share = t.error / (self.options.tolerance * DISTANCE_SHARE);
        BandPart { label, fit: t.accepted, refused: t.refused.map(Arc::new), share, proven: None }
    }

    /// The middle line of a component of the band between two levels.
    fn middle(&self, region: Region, field: &Field, w: &[f64]) -> Vec<Ruling> {
        let (lo, hi) = region.range(field);
        self.centre(region, field, 0.5 * (lo.max(w[0]) + hi.min(w[1])))
    }
}

/// How torses of bands are tried: what most bands needed in the round before, they will need again.
fn proposals(known: &[Known]) -> AttemptOptions<'static> {
    let fine = known.iter().flat_map(|k| &k.good).filter(|f| AttemptOptions::is_fine(&f.0)).count();
    AttemptOptions { prove: false, fine_first: 2 * fine > known.len(), density: Density::Band, from: None }
}

/// What bands are laid from at first.
struct Start {
    /// How dense levels must lie, as far as it is known.
    rise: Rise,
    levels: Vec<f64>,
    /// Bands that lie about there.
    known: Vec<Known>,
    /// Rounds at most.
    rounds: usize,
    /// Bands at most.
    most: usize,
}

/// Number of bands that can be hoped to do where the roots of their shares sum up to `rise`.
fn bands_for(rise: f64) -> usize {
    (rise / AIM.sqrt()).ceil() as usize
}

impl Cover {
    /// The panels of a cover that are new to it.
    fn newly<'a>(&'a self, cover: &'a Cover) -> impl Iterator<Item = (u32, &'a Arc<Fit>)> {
        let is_new = |l: &u32, fit: &Arc<Fit>| self.panels.get(l).is_none_or(|f| !Arc::ptr_eq(f, fit));
        cover.panels.iter().filter(move |(l, fit)| is_new(l, fit)).map(|(l, fit)| (*l, fit))
    }

    /// The panels of a cover that are new to it and the function of which all of them are bands. `None` where there are
    /// others among them.
    fn chain(&self, cover: &Cover) -> Option<(Arc<Field>, Vec<u32>)> {
        let fresh: Vec<u32> = self.newly(cover).map(|p| p.0).collect();
        let field = cover.bands.get(fresh.first()?)?;
        let all = fresh.iter().all(|l| cover.bands.get(l).is_some_and(|f| Arc::ptr_eq(f, field)));
        (all && fresh.len() > 1).then(|| (Arc::clone(field), fresh))
    }

    /// Gives components that are far narrower than their bands, as levels cut them off at a border, to the components beside
    /// them that share the most edges.
    fn absorb_narrow(&mut self, bands: &mut [Vec<u32>], field: &Field, levels: &[f64]) {
        let narrow: HashSet<u32> = bands
            .iter()
            .zip(levels.windows(2))
            .flat_map(|(band, w)| {
                let is_narrow = |l: &u32| {
                    let (lo, hi) = self.region(*l).range(field);
                    hi - lo < NARROW * (w[1] - w[0])
                };
                band.iter().copied().filter(is_narrow).collect::<Vec<u32>>()
            })
            .collect();
        if narrow.is_empty() {
            return;
        }
        let wide: HashSet<u32> = bands.iter().flatten().copied().filter(|l| !narrow.contains(l)).collect();
        // Of each narrow one, edges shared with the best neighbour, and that one.
        let mut into: HashMap<u32, (usize, u32)> = HashMap::default();
        for ((a, b), shared) in self.partition.neighbours() {
            for (from, to) in [(a, b), (b, a)] {
                if narrow.contains(&from) && wide.contains(&to) {
                    let best = into.entry(from).or_insert((0, to));
                    *best = (*best).max((shared, to));
                }
            }
        }
        for l in &mut self.partition.labels {
            if let Some((_, to)) = into.get(l) {
                *l = *to;
            }
        }
        bands.iter_mut().for_each(|band| band.retain(|l| !into.contains_key(l)));
    }
}

/// A band of the round before.
struct Known {
    /// The levels between which it lies.
    ends: [f64; 2],
    /// Torses of its components, with their areas where they are proven.
    good: Vec<(Arc<Fit>, Option<f64>)>,
    /// The torse of its only component, good enough or not.
    single: Option<Arc<Fit>>,
}

impl Known {
    /// The common part of the band and that between two levels, as a share of what they cover together.
    fn overlap(&self, w: &[f64]) -> f64 {
        let [lo, hi] = self.ends;
        (hi.min(w[1]) - lo.max(w[0])) / (hi.max(w[1]) - lo.min(w[0]))
    }
}

/// The cover with the panels of bands.
fn finished(mut laid: Cover, bands: Vec<Vec<BandPart>>, levels_of: &Arc<Field>) -> Cover {
    for p in bands.into_iter().flatten() {
        laid.bands.insert(p.label, Arc::clone(levels_of));
        laid.panels.extend(p.fit.map(|f| (p.label, f)));
    }
    laid
}

/// Levels with one more in the middle of each band that resists; the others stay bit by bit.
fn halved(levels: &[f64], resist: &[bool]) -> Vec<f64> {
    let mut out = Vec::with_capacity(levels.len() + 1);
    for (w, resists) in levels.windows(2).zip(resist) {
        out.push(w[0]);
        if *resists {
            out.push(0.5 * (w[0] + w[1]));
        }
    }
    out.extend(levels.last());
    out
}

/// Levels between which bands that are a little too wide have given of their width to the nearest bands with something
/// to spare, by the square law; levels that need not move stay bit by bit. `None` where too much is missing.
fn repaired(levels: &[f64], shares: &[f64]) -> Option<Vec<f64>> {
    if shares.iter().any(|s| *s > MOST_REPAIRED) {
        return None;
    }
    let mut widths: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).collect();
    // Width at which the error of each band would be all that is allowed.
    let full: Vec<f64> = widths.iter().zip(shares).map(|(w, s)| w / s.sqrt()).collect();
    let mut shift = vec![0.0; levels.len()];
    for i in (0..widths.len()).filter(|&i| shares[i] > 1.0) {
        let mut missing = widths[i] - GIVES.sqrt() * full[i];
        for distance in 1..=NEAR {
            for j in [i.checked_sub(distance), Some(i + distance)].into_iter().flatten() {
                if j >= widths.len() || shares[j] > 1.0 || missing <= 0.0 {
                    continue;
                }
                let taken = (TAKES.sqrt() * full[j] - widths[j]).clamp(0.0, missing);
                if taken > 0.0 {
                    widths[i] -= taken;
                    widths[j] += taken;
                    missing -= taken;
                    let (moved, by) = if j < i { (j + 1..=i, taken) } else { (i + 1..=j, -taken) };
                    shift[moved].iter_mut().for_each(|s| *s += by);
                }
            }
        }
        // What is left must at least bring the band below what is allowed.
        if widths[i] > full[i] * (1.0 + GIVES.sqrt()) * 0.5 {
            return None;
        }
    }
    let next: Vec<f64> = levels.iter().zip(&shift).map(|(l, s)| l + s).collect();
    next.windows(2).all(|w| w[0] < w[1]).then_some(next)
}

/// How dense levels must lie: the rise of `√error` over the range of the field, as the rounds so far have measured it.
/// Single fits miss their best by some percent, which the mean of several rounds evens out.
pub(super) struct Rise {
    lo: f64,
    hi: f64,
    /// Rise in every cell of an even division of the range.
    cells: Vec<f64>,
    /// Whether nothing has been measured yet.
    guessed: bool,
}

/// Cells of a [`Rise`].
const CELLS: usize = 2048;
/// Weight of a new round against those before.
const FRESH: f64 = 0.5;

impl Rise {
    /// Before the first round: in proportion to a density in equal parts of the range.
    fn guessed(lo: f64, hi: f64, density: &[f64]) -> Self {
        let cells = (0..CELLS).map(|k| density[k * density.len() / CELLS]).collect();
        Self { lo, hi, cells, guessed: true }
    }

    /// As bands from `lo` to `hi` with their shares, `[lo, hi, share]`, tell it; the steepest counts where they lie side
    /// by side.
    pub(in crate::search) fn of_bands(bands: &[[f64; 3]]) -> Self {
        // Narrow ones beside wide ones tell nothing.
        let beside = |b: &[f64; 3], c: &[f64; 3]| c[0] <= b[0] && b[1] <= c[1] && b[1] - b[0] < NARROW * (c[1] - c[0]);
        let bands: Vec<&[f64; 3]> = bands.iter().filter(|b| !bands.iter().any(|c| beside(b, c))).collect();
        let lo = bands.iter().fold(f64::INFINITY, |m, b| m.min(b[0]));
        let hi = bands.iter().fold(f64::NEG_INFINITY, |m, b| m.max(b[1]));
        let mut rise = Self { lo, hi, cells: vec![0.0; CELLS], guessed: false };
        for b in &bands {
            for (k, r) in rise.within(**b) {
                rise.cells[k] = rise.cells[k].max(r);
            }
        }
        rise
    }

    /// The rise in the cells that a band `[lo, hi, share]` touches.
    fn within(&self, [lo, hi, share]: [f64; 3]) -> impl Iterator<Item = (usize, f64)> {
        let (origin, step) = (self.lo, (self.hi - self.lo) / CELLS as f64);
        let density = if hi > lo { share.sqrt() / (hi - lo) } else { 0.0 };
        let first = (((lo - origin) / step) as usize).min(CELLS - 1);
        (first..CELLS).map_while(move |k| {
            let begin = origin + k as f64 * step;
            (begin < hi).then(|| (k, density * ((begin + step).min(hi) - begin.max(lo)).max(0.0)))
        })
    }

    /// Number of bands that can be hoped to do.
    fn needed(&self) -> usize {
        bands_for(self.whole())
    }

    /// Rise over the whole range: as many bands would be at the tolerance, by the square law.
    pub(super) fn whole(&self) -> f64 {
        self.cells.iter().sum()
    }

    /// Takes in the shares of bands between levels.
    fn include(&mut self, levels: &[f64], shares: &[f64]) {
        let mut fresh = vec![0.0; CELLS];
        for (w, share) in levels.windows(2).zip(shares) {
            for (k, r) in self.within([w[0], w[1], *share]) {
                fresh[k] += r;
            }
        }
        if self.guessed {
            self.cells = fresh;
            self.guessed = false;
        } else {
            self.cells.iter_mut().zip(fresh).for_each(|(old, new)| *old += FRESH * (new - *old));
        }
    }

    /// Levels for `count` bands of equal error by the square law.
    pub(in crate::search) fn levels(&self, count: usize) -> Vec<f64> {
        let step = (self.hi - self.lo) / CELLS as f64;
        let each = self.cells.iter().sum::<f64>() / count as f64;
        let mut out = vec![self.lo];
        let mut before = 0.0;
        for (k, rise) in self.cells.iter().enumerate() {
            while out.len() < count && before + rise >= each * out.len() as f64 {
                out.push(self.lo + step * (k as f64 + (each * out.len() as f64 - before) / rise));
            }
            before += rise;
        }
        out.resize(count, self.hi);
        out.push(self.hi);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn relaid(levels: &[f64], shares: &[f64], count: usize) -> Vec<f64> {
        let mut rise = Rise::guessed(levels[0], levels[levels.len() - 1], &[1.0]);
        rise.include(levels, shares);
        rise.levels(count)
    }

    #[test]
    fn levels_follow_the_square_law() {
        // Errors 4 and 1 on equal widths: the first band must be half as wide as the second.
        let l = relaid(&[0.0, 1.0, 2.0], &[4.0, 1.0], 3);
        let want = [0.0, 0.5, 1.0, 2.0];
        assert!(l.len() == 4 && l.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{l:?}");
        let even = relaid(&[0.0, 0.5, 1.0, 2.0], &[1.0, 1.0, 1.0], 3);
        assert!(even.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{even:?}");
    }

    #[test]
    fn wide_bands_give_to_the_nearest_with_room() {
        let levels = [0.0, 1.0, 2.0, 3.0, 4.0];
        let l = repaired(&levels, &[0.8, 0.9, 1.02, 0.97]).expect("room");
        // The third band gives of its width to the second; its other neighbour has no room worth having.
        assert!(l[0] == 0.0 && l[1] == 1.0 && l[4] == 4.0, "{l:?}");
        let width = (l[3] - l[2]) * (1.02_f64 / GIVES).sqrt();
        assert!((width - 1.0).abs() < 1e-12 && l[2] > 2.0, "{l:?}");
        assert_eq!(repaired(&levels, &[0.97, 0.97, 1.1, 0.97]), None);
        assert_eq!(repaired(&levels, &[0.5, 0.5, 1.9, 0.5]), None);
    }

    #[test]
    fn bands_that_resist_are_divided() {
        assert_eq!(halved(&[0.0, 1.0, 2.0, 4.0], &[false, true, false]), [0.0, 1.0, 1.5, 2.0, 4.0]);
    }

    #[test]
    fn rise_of_bands_leaves_narrow_ones_beside_wide_ones_out() {
        // A sliver beside the second band says nothing of how dense levels must lie there.
        let bands = [[0.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.9, 2.0, 1.0]];
        let rise = Rise::of_bands(&bands);
        let l = rise.levels(2);
        assert!((l[1] - 1.0).abs() < 1e-2 && rise.needed() == 3, "{l:?} {}", rise.needed());
        // Side by side, the one that needs more counts.
        let l = Rise::of_bands(&[[0.0, 2.0, 1.0], [0.0, 1.0, 2.25]]).levels(2);
        assert!((l[1] - 2.0 / 3.0).abs() < 1e-2, "{l:?}");
    }

    #[test]
    fn first_levels_follow_the_density() {
        let l = Rise::guessed(0.0, 2.0, &[3.0, 1.0]).levels(4);
        let want = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 2.0];
        assert!(l.len() == 5 && l.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-2), "{l:?}");
    }

    #[test]
    fn rounds_are_averaged() {
        let mut rise = Rise::guessed(0.0, 1.0, &[1.0]);
        rise.include(&[0.0, 0.5, 1.0], &[1.21, 0.81]);
        rise.include(&[0.0, 0.5, 1.0], &[0.81, 1.21]);
        let l = rise.levels(2);
        assert!((l[1] - 0.5).abs() < 1e-12, "{l:?}");
    }

    /// Bands side by side from 0 on: widths, and shares.
    fn laid_bands() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
        proptest::collection::vec((-2.0..0.0f64, LEAST_SHARE..MOST_SHARE), 2..30).prop_map(|bands| {
            let mut levels = vec![0.0];
            bands.iter().for_each(|b| levels.push(levels[levels.len() - 1] + 10f64.powf(b.0)));
            (levels, bands.iter().map(|b| b.1).collect())
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        #[test]
        fn levels_part_the_rise_evenly_and_in_order((levels, shares) in laid_bands(), count in 1usize..60) {
            let mut rise = Rise::guessed(levels[0], levels[levels.len() - 1], &[1.0]);
            rise.include(&levels, &shares);
            let whole: f64 = shares.iter().map(|s| s.sqrt()).sum();
            prop_assert!((rise.whole() - whole).abs() < 1e-9 * whole);
            prop_assert!(rise.needed() as f64 >= whole && (rise.needed() as f64) < 1.0 + whole / AIM.sqrt());
            let found = rise.levels(count);
            prop_assert!(found.len() == count + 1 && found[0] == levels[0] && found[count] == levels[levels.len() - 1]);
            prop_assert!(found.windows(2).all(|w| w[0] < w[1]), "{found:?}");
            // By the square law every band has its part of the rise, up to a cell at either end.
            let cell = rise.cells.iter().copied().fold(0.0, f64::max);
            let part = |a: f64, b: f64| -> f64 {
                let bands = levels.windows(2).zip(&shares);
                bands.map(|(w, s)| s.sqrt() * ((b.min(w[1]) - a.max(w[0])).max(0.0) / (w[1] - w[0]))).sum()
            };
            for w in found.windows(2) {
                let own = part(w[0], w[1]);
                prop_assert!((own - whole / count as f64).abs() <= 2.0 * cell + 1e-9, "{own} of {whole} in {count}");
            }
            // What is measured again says nothing new.
            let before = rise.cells.clone();
            rise.include(&levels, &shares);
            prop_assert!(rise.cells.iter().zip(before).all(|(a, b)| (a - b).abs() < 1e-12));
        }

        #[test]
        fn repaired_bands_are_within_what_is_allowed((levels, shares) in laid_bands(), scale in 0.3..0.5f64) {
            let shares: Vec<f64> = shares.iter().map(|s| s * scale).collect();
            let Some(found) = repaired(&levels, &shares) else { return Ok(()) };
            prop_assert!(found.len() == levels.len() && found[0] == levels[0]);
            prop_assert!((found[levels.len() - 1] - levels[levels.len() - 1]).abs() < 1e-12);
            for (k, (w, v)) in found.windows(2).zip(levels.windows(2)).enumerate() {
                let share = shares[k] * ((w[1] - w[0]) / (v[1] - v[0])).powi(2);
                prop_assert!(w[0] < w[1] && share < 1.0, "{share} in {k}");
                // Bands that were good neither give nor grow beyond what they take.
                prop_assert!(shares[k] > 1.0 || (share >= shares[k] - 1e-9 && share <= shares[k].max(TAKES) + 1e-9));
            }
        }
    }
}
