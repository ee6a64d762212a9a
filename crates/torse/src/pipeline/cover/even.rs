//! Bands of a level function laid all at once: as many as theory asks for, their widths evened out until all have the
//! same error (B3.6).
//!
//! The error of a band grows with the square of its width. Fitting all bands once therefore tells how dense the levels
//! must lie everywhere, and how many bands are needed; a few rounds settle it. Marching, which needs some trials per
//! band one after the other, is left to regions where this fails.

use super::march::range;
use super::{Job, State, DISTANCE_SHARE};
use crate::fit::samples::Fit;
use crate::spline::field::Field;
use rayon::prelude::*;
use std::sync::Arc;

/// Fewer bands than this are left to the march: errors of wide bands follow no law.
const FEWEST: f64 = 7.0;
/// Rounds of fitting all bands.
const ROUNDS: usize = 8;
/// Rounds with the same number of bands.
const SAME: usize = 3;
/// Share of the allowed distance that levels are laid for: errors follow the square law within some percent.
const AIM: f64 = 0.965;
/// Shares below this count as this: fits end early when they are good enough.
const LEAST_SHARE: f64 = 0.3;
/// Shares above this count as this, and what no torse fits. Bands that resist so much once the levels are laid anew
/// are left to the march.
const MOST_SHARE: f64 = 2.5;
/// Bands whose shares differ by less than this factor count as even.
const EVEN: f64 = 1.15;
/// Further bands that may be tried beyond theory, as a share of it and in number.
const MORE: (f64, f64) = (0.3, 2.0);

/// One component of a band.
struct Piece {
    label: u32,
    fit: Option<Arc<Fit>>,
    /// Its error as a share of the allowed distance.
    share: f64,
}

impl Job<'_> {
    /// Covers a region by bands between levels of a function, all laid at once. `theory`: number of bands that theory
    /// asks for. With the cover comes the share of the tolerance that its bands leave, in the mean. `None` where bands
    /// resist, or where no number of panels up to `budget` will do.
    pub(super) fn even(
        &self,
        state: &State,
        label: u32,
        field: &Field,
        theory: f64,
        budget: usize,
    ) -> Option<(State, f64)> {
        let (lo, hi) = range(state, label, field);
        let most = (theory * (1.0 + MORE.0) + MORE.1) as usize;
        let mut count = (theory.ceil() as usize).clamp(1, budget.max(1));
        let mut levels: Vec<f64> = (0..=count).map(|i| lo + (hi - lo) * i as f64 / count as f64).collect();
        // Panels and largest share of the best cover, mean of what its bands leave of the tolerance, and itself.
        let mut best: Option<((usize, f64), f64, State)> = None;
        let mut same = 0;
        // Fewer bands than this have failed.
        let mut least_count = 1;
        for round in 0..ROUNDS {
            if theory < FEWEST || count > budget.min(most) || self.control.stopped() {
                break;
            }
            let (mut laid, bands) = self.laid(state, label, field, &levels);
            let shares: Vec<f64> =
                bands.iter().map(|b| b.iter().fold(LEAST_SHARE, |m, p| m.max(p.share)).min(MOST_SHARE)).collect();
            let worst = shares.iter().copied().fold(0.0, f64::max);
            let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
            let needed = (shares.iter().map(|s| s.sqrt()).sum::<f64>() / AIM.sqrt()).ceil() as usize;
            let complete = bands.iter().flatten().all(|p| p.fit.is_some());
            if complete {
                let key = (bands.iter().map(Vec::len).sum::<usize>(), worst);
                if key.0 <= budget && best.as_ref().is_none_or(|b| key < b.0) {
                    for p in bands.into_iter().flatten() {
                        laid.panels.extend(p.fit.map(|f| (p.label, f)));
                    }
                    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
                    best = Some((key, 1.0 - mean, laid));
                }
                if needed >= count && (worst <= EVEN * least || same >= SAME) {
                    break;
                }
            } else if round > 0 && worst >= MOST_SHARE {
                break;
            }
            let next = if worst < MOST_SHARE { needed.max(least_count) } else { needed.max(count) };
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
            levels = relaid(&levels, &shares, count);
        }
        best.map(|b| (b.2, b.1))
    }

    /// The bands between levels, with the best torse of each of their components: proven when all bands might do.
    fn laid(&self, state: &State, label: u32, field: &Field, levels: &[f64]) -> (State, Vec<Vec<Piece>>) {
        let mut laid = state.clone();
        let mut labels = Vec::with_capacity(levels.len() - 1);
        for &level in &levels[1..levels.len() - 1] {
            let fresh = laid.partition.fresh_label();
            laid.cut(&self.face.surface, label, fresh, |p| level - field.value(p));
            labels.push(fresh);
        }
        labels.push(label);
        let mut bands: Vec<Vec<u32>> = Vec::with_capacity(labels.len());
        for l in labels {
            bands.push(laid.partition.split_components(l));
        }
        let allowed = self.options.tolerance * DISTANCE_SHARE;
        let tried = |prove: bool| -> Vec<Vec<Piece>> {
            bands
                .par_iter()
                .map(|band| {
                    band.par_iter()
                        .map(|&label| {
                            let centre = self.centre(&laid, label, field);
                            let t = if prove {
                                self.single(&laid, label, Some(&centre))
                            } else {
                                self.proposed(&laid, label, Some(&centre))
                            };
                            Piece { label, fit: t.accepted, share: t.error / allowed }
                        })
                        .collect()
                })
                .collect()
        };
        let mut pieces = tried(false);
        if pieces.iter().flatten().all(|p| p.fit.is_some()) {
            pieces = tried(true);
        }
        (laid, pieces)
    }
}

/// Levels for `count` bands of equal error by the square law, from bands with known shares.
fn relaid(levels: &[f64], shares: &[f64], count: usize) -> Vec<f64> {
    let total: f64 = shares.iter().map(|s| s.sqrt()).sum();
    let mut out = vec![levels[0]];
    let mut before = 0.0;
    for (w, s) in levels.windows(2).zip(shares) {
        let rise = s.sqrt();
        while out.len() < count && before + rise >= total * out.len() as f64 / count as f64 {
            let part = (total * out.len() as f64 / count as f64 - before) / rise;
            out.push(w[0] + part * (w[1] - w[0]));
        }
        before += rise;
    }
    out.push(levels[levels.len() - 1]);
    out
}

#[cfg(test)]
mod tests {
    use super::relaid;

    #[test]
    fn levels_follow_the_square_law() {
        // Errors 4 and 1 on equal widths: the first band must be half as wide as the second.
        let l = relaid(&[0.0, 1.0, 2.0], &[4.0, 1.0], 3);
        let want = [0.0, 0.5, 1.0, 2.0];
        assert!(l.len() == 4 && l.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{l:?}");
        let even = relaid(&[0.0, 0.5, 1.0, 2.0], &[1.0, 1.0, 1.0], 3);
        assert!(even.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{even:?}");
    }
}
