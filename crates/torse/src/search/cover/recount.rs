//! A cover with one band less or more, as strips that are to meet may begin with: all bands of one function laid anew, of
//! even errors by the square law. Nothing is proven here, and torses may be farther away than the tolerance.
//!
//! Strips in one program keep to less of the tolerance than each for itself, and even out what bands of a function leave
//! uneven: where little is missing, one band less will do.

use super::covered_face::{Cover, SAMPLES};
use super::equidistribute::Rise;
use super::job::{CoverOptions, Job, DISTANCE_SHARE};
use crate::fit::strip_potential::Forms;
use crate::spline::field::Field;
use std::sync::Arc;

/// Largest error (tolerances) that the square law may promise for a band less. Half bowl at 1 mm: 1.15 becomes 0.96 in the
/// program; monkey saddle at 10 mm: 1.23 becomes 0.95.
const LOOSE: f64 = 1.25;
/// Of more bands than this one less is not worth the time: 29 of the half bowl at 0.1 mm take 13 seconds more to end at 0.99.
const MOST_RECOUNTED: usize = 20;
/// Factor on that up to which torses are taken as they are: the program makes them better in less time than fits of their own.
const ACCEPTED: f64 = 1.3;
/// Bands overlap by less than this share of the narrower one where they follow each other.
const BESIDE: f64 = 0.3;

/// Which number of bands is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Recount {
    /// One less than the cover has.
    Less,
    /// One more.
    More,
}

/// Bands of one function.
struct BandSequence {
    field: Arc<Field>,
    labels: Vec<u32>,
    rise: Rise,
    /// Bands one after the other.
    count: usize,
}

impl BandSequence {
    /// Error (tolerances) that so many bands promise by the square law.
    fn promised(&self, count: usize) -> f64 {
        (self.rise.whole() / count.max(1) as f64).powi(2)
    }
}

impl Job<'_> {
    /// The cover with one band less or more among those of one function. `None` where none of the functions promises that, or where
    /// the panels do not become fewer, or more than by one in ten.
    pub(crate) fn recounted(&self, cover: &Cover, recount: Recount) -> Option<Cover> {
        let (options, control) = (&self.options, self.control);
        let chains = cover.chains(options.tolerance * DISTANCE_SHARE);
        let count = |c: &BandSequence| match recount {
            Recount::Less => c.count - 1,
            Recount::More => c.count + 1,
        };
        let promised = |c: &BandSequence| c.promised(count(c));
        // With one sign of curvature theory holds: it becomes no less than promised.
        let most = if cover.has_one_sign() { 1.0 } else { LOOSE };
        let chain = match recount {
            Recount::Less => {
                let promising =
                    chains.iter().filter(|c| (3..=MOST_RECOUNTED).contains(&c.count) && promised(c) <= most);
                promising.min_by(|a, b| promised(a).total_cmp(&promised(b)))
            }
            Recount::More => chains.iter().max_by(|a, b| a.promised(a.count).total_cmp(&b.promised(b.count))),
        }?;
        let options = CoverOptions { tolerance: ACCEPTED * options.tolerance * promised(chain), ..options.clone() };
        let job = Job::new(self.face, &options, control);
        let (bare, whole) = cover.without(chain, options.tolerance)?;
        let next = job.roughly_laid(bare.region(whole), &chain.field, &chain.rise.levels(count(chain)))?;
        let (before, now) = (cover.panels.len(), next.panels.len());
        let is_wanted = match recount {
            Recount::Less => now < before,
            Recount::More => now <= before + before.div_ceil(10),
        };
        (is_wanted && !control.stopped()).then_some(next)
    }
}

impl Cover {
    /// The cover with the bands of one function as one region, and its label. Where there is nothing else the face is triangulated
    /// anew: triangles beside borders that are gone would be thin.
    fn without(&self, chain: &BandSequence, tolerance: f64) -> Option<(Cover, u32)> {
        if chain.labels.len() == self.panels.len() {
            return Some((Cover::bare(&self.face, tolerance).ok()?, 0));
        }
        let mut out = self.clone();
        let whole = chain.labels[0];
        for label in &chain.labels {
            out.panels.remove(label);
            out.bands.remove(label);
        }
        out.partition.labels.iter_mut().filter(|l| chain.labels.contains(l)).for_each(|l| *l = whole);
        Some((out, whole))
    }

    /// Functions of which a cover has several bands, in the order of their first labels.
    fn chains(&self, allowed: f64) -> Vec<BandSequence> {
        let mut groups: Vec<(Arc<Field>, Vec<u32>)> = Vec::new();
        for (label, field) in self.bands.iter().filter(|b| self.panels.contains_key(b.0)) {
            match groups.iter_mut().find(|g| Arc::ptr_eq(&g.0, field)) {
                Some(group) => group.1.push(*label),
                None => groups.push((Arc::clone(field), vec![*label])),
            }
        }
        let chain = |(field, labels): (Arc<Field>, Vec<u32>)| {
            let band = |l: &u32| {
                let (lo, hi) = self.region(*l).range(&field);
                [lo, hi, self.panels[l].error / allowed]
            };
            let bands: Vec<[f64; 3]> = labels.iter().map(band).collect();
            BandSequence { rise: Rise::of_bands(&bands), count: in_sequence(bands), field, labels }
        };
        groups.into_iter().filter(|g| g.1.len() > 1).map(chain).collect()
    }

    /// Whether a face is curved with one sign wherever it was looked at.
    fn has_one_sign(&self) -> bool {
        let each = SAMPLES / self.regions().count().max(1) + 1;
        let sign = |f: &Forms| f.principal().iter().map(|k| k.signum()).product::<f64>();
        let signs: Vec<f64> = self.regions().flat_map(|r| r.forms(each)).map(|f| sign(&f)).collect();
        signs.windows(2).all(|w| w[0] == w[1])
    }
}

/// How many bands `[lo, hi, …]` follow each other.
fn in_sequence(mut bands: Vec<[f64; 3]>) -> usize {
    bands.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let mut last: Option<[f64; 3]> = None;
    let mut count = 0;
    for b in bands {
        let follows = |l: [f64; 3]| l[1] - b[0] <= BESIDE * (b[1] - b[0]).min(l[1] - l[0]);
        if last.is_none_or(follows) {
            count += 1;
            last = Some(b);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_side_by_side_count_once() {
        let bands = [[0.0, 1.0, 1.0], [0.9, 2.0, 1.0], [0.1, 1.0, 0.5], [2.0, 3.0, 1.0], [2.1, 2.9, 0.4]];
        assert_eq!(in_sequence(bands.to_vec()), 3);
        assert_eq!(in_sequence(bands[..1].to_vec()), 1);
    }
}
