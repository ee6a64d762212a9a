//! One region, one torse: propose, judge, refine. A torse is accepted only by the certificate; where that refuses,
//! its witness becomes a sample of the next fit, for bands laid all at once with all peaks between the samples so far.

use super::job::{Job, DISTANCE_SHARE};
use super::region::{Density, Region};
use crate::certify::distance::{distance, DistanceOptions};
use crate::certify::{Obstruction, Verdict};
use crate::fit::near::centre_line::{has_inflection, spans_along};
use crate::fit::near::dual::dual;
use crate::fit::near::dual::DualOptions;
use crate::fit::near::plane::plane;
use crate::fit::near::primal::{primal, PrimalOptions};
use crate::fit::near::samples::beyond;
use crate::fit::near::samples::{Fit, Sample};
use crate::fit::near::{descent::RefitOptions, refit::refit};
use crate::torse::form::{Ruling, Torse};
use std::sync::atomic::Ordering;
use std::sync::Arc;

/// Sampled errors up to this share of the allowed distance go to the certificate; true suprema exceed sampled ones
/// by a few per cent at the most.
const HOPEFUL: f64 = 0.99;
/// Share of the allowed distance at which fits of bands may stop.
const KEEN: f64 = 0.7;
/// Panels that bend more sharply than this multiple of the tolerance are refused: their rulings crowd together near
/// the regression curve, and their trims cannot be drawn well (certificate specification, 4).
const LEAST_BEND: f64 = 3.0;
/// … and than this share of the model's size, which is the less where tolerances are coarse.
const LEAST_BEND_SHARE: f64 = 0.03;
/// Fits keep this multiple of that radius where they can.
const WANTED_BEND: f64 = 5.0;
/// … and this one of the radius that the material allows: what the certificate shows is a lower bound.
const WANTED_LIMIT: f64 = 1.2;
/// Shares of both below which fits are started again in another way. Tubes bend hardly less sharply than fits are wanted to:
/// with 0.85 of the first all starts were tried for each band of a tube, in four times the time, and the first was taken.
const NEEDED: (f64, f64) = (0.4, 0.85);
/// Share of their mean width by which fits of bands keep the regression curve away where they can.
const WANTED_CLEARANCE: f64 = 0.1;
/// Panels whose regression curve comes nearer than this share of their mean width (area over length) are refused: there
/// feet move too fast along the border for trims to follow.
const LEAST_CLEARANCE: f64 = 0.01;
/// Spans of the torse of a band per length-to-width ratio of the band, and at most.
const SPANS: f64 = 0.7;
/// See [`SPANS`].
const MOST_SPANS: usize = 80;
/// Share of the allowed distance within which a spline with the spans of a primal torse follows the centre line: bands
/// over many waves need more of them.
const LINE_SHARE: f64 = 0.1;
/// Share of the allowed distance above which further samples of a refused torse are taken in.
const PEAK: f64 = 0.95;
/// Refits with witnesses before a torse is given up.
const REFITS: usize = 3;

/// Smallest radius of curvature (mm) of panels on a face of a size (mm) within a tolerance (mm).
pub(in crate::search) fn least_bend(size: f64, tolerance: f64) -> f64 {
    (LEAST_BEND * tolerance).min(LEAST_BEND_SHARE * size)
}

/// Result of trying one torse on a region.
pub(crate) struct Attempt {
    /// The torse, if proven.
    pub(crate) accepted: Option<Arc<Fit>>,
    /// Error reached, mm; above the tolerance when nothing was accepted; infinite when nothing fits at all.
    pub(crate) error: f64,
    /// The best torse that was not accepted.
    pub(super) refused: Option<Fit>,
    /// Whether a torse near enough was refused for its shape: how much smaller the region should be is not known.
    pub(super) misshapen: bool,
}

/// How torses are tried on a region.
#[derive(Clone, Copy, Debug)]
pub(super) struct AttemptOptions<'a> {
    /// Whether what is accepted must be proven.
    pub(super) prove: bool,
    /// Whether torses with many spans are tried first.
    pub(super) fine_first: bool,
    /// How dense the region is sampled.
    pub(super) density: Density,
    /// A torse of about the same region, to start from.
    pub(super) from: Option<&'a Fit>,
}

impl AttemptOptions<'_> {
    /// With proof, without a torse to start from.
    pub(super) const USUAL: Self =
        AttemptOptions { prove: true, fine_first: false, density: Density::Usual, from: None };

    /// Whether a torse has more spans than those that are tried first usually.
    pub(super) fn is_fine(fit: &Fit) -> bool {
        let usual = DualOptions::new(1.0).spans;
        matches!(&fit.torse, Torse::Dual(d) if d.planes.knots.breaks().len() > usual * 5 / 4)
    }
}

impl Attempt {
    /// The accepted one of two, else the one with the smaller error.
    fn or_better(self, other: Self) -> Self {
        let rank = |t: &Self| (t.accepted.is_none(), t.error);
        if rank(&other) < rank(&self) {
            other
        } else {
            self
        }
    }

    fn failed(error: f64) -> Self {
        Self { accepted: None, error, refused: None, misshapen: false }
    }
}

impl Job<'_> {
    /// Tries plane, dual torse along the centre line (if there is one) and primal torse on a region.
    pub(crate) fn single(&self, region: Region, centre: Option<&[Ruling]>) -> Attempt {
        self.tried(region, centre, AttemptOptions::USUAL)
    }

    /// The proof of what was proposed.
    pub(super) fn confirmed(&self, region: Region, fit: &Fit) -> Attempt {
        self.peaks_proven(region, fit.clone(), region.dense_samples(Density::Band), true)
    }

    /// As [`Job::single`] in another manner. Without proof, what is accepted here may still be refused.
    pub(super) fn tried(&self, region: Region, centre: Option<&[Ruling]>, how: AttemptOptions) -> Attempt {
        let allowed = self.options.tolerance * DISTANCE_SHARE;
        if self.control.stopped() {
            return Attempt::failed(f64::INFINITY);
        }
        self.control.attempt();
        let samples = region.dense_samples(how.density);
        let control = || self.control.clone();
        let proven = |fit: Fit| {
            if how.prove {
                self.proven(region, fit, samples.clone())
            } else {
                let error = fit.error;
                Attempt { accepted: Some(Arc::new(fit)), ..Attempt::failed(error) }
            }
        };
        if let Some(fit) = plane(&samples) {
            if fit.error <= allowed * HOPEFUL {
                let t = proven(fit);
                if t.accepted.is_some() {
                    return t;
                }
            }
        }
        if self.options.facets {
            return Attempt::failed(f64::INFINITY);
        }
        let assess = |fit: Fit| {
            let t = if fit.error <= allowed * HOPEFUL { proven(fit.clone()) } else { Attempt::failed(fit.error) };
            let refused = t.accepted.is_none().then_some(fit);
            Attempt { refused, ..t }
        };
        // Bands are wanted as wide as they can be: the fit must not rest on the first torse that is good enough.
        let keen = if centre.is_some() { allowed * KEEN } else { allowed };
        let bend_radius = self.wanted_bend();
        let mut best = Attempt::failed(f64::INFINITY);
        if let Some(from) = how.from {
            if let Some(fit) =
                refit(from, &samples, &RefitOptions { bend_radius, control: control(), ..RefitOptions::new(keen) })
            {
                best = assess(fit);
                if best.accepted.is_some() {
                    return best;
                }
            }
        }
        if let Some(line) = centre.filter(|l| !l.is_empty()) {
            let length: f64 = line.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
            let slender = length * length / region.area().max(f64::MIN_POSITIVE);
            let fine = ((SPANS * slender) as usize).min(MOST_SPANS);
            let usual = self.dual_options(region);
            // Slender bands need more spans; many spans on short ones come too near the regression curve.
            let mut counts = vec![usual.spans];
            if fine > usual.spans * 5 / 4 {
                counts.insert(usize::from(!how.fine_first), fine);
            }
            for spans in counts {
                let max_samples = usual.max_samples * spans / usual.spans;
                if let Some(fit) = dual(&samples, line, &DualOptions { spans, max_samples, ..usual.clone() }) {
                    let t = assess(fit);
                    let accepted = t.accepted.is_some();
                    best = best.or_better(t);
                    if accepted {
                        return best;
                    }
                }
            }
        }
        let usual = PrimalOptions { bend_radius, control: control(), ..PrimalOptions::new(keen) };
        let wanted = centre
            .filter(|line| has_inflection(line))
            .map_or(0, |line| spans_along(line, LINE_SHARE * allowed, region.bbox().diagonal(), MOST_SPANS));
        if let Some(fit) = primal(&samples, &usual.with_spans(wanted.max(usual.profile_spans))) {
            best = best.or_better(assess(fit));
        }
        if best.accepted.is_none() {
            best.error = best.error.max(self.options.tolerance * 1.0001);
        }
        best
    }

    /// How dual torses are fitted to a band.
    fn dual_options(&self, region: Region) -> DualOptions {
        let limit = self.options.limits.min_bend_radius.unwrap_or(0.0);
        DualOptions {
            clearance: WANTED_CLEARANCE * region.width(),
            bend_radius: self.wanted_bend(),
            least_bend_radius: (NEEDED.0 * WANTED_BEND * self.patch_bend()).max(NEEDED.1 * WANTED_LIMIT * limit),
            control: self.control.clone(),
            ..DualOptions::new(self.options.tolerance * DISTANCE_SHARE * KEEN)
        }
    }

    /// Smallest radius of curvature at which a patch can be laid around a panel, mm.
    fn patch_bend(&self) -> f64 {
        least_bend(self.face.surface.bbox().diagonal(), self.options.tolerance)
    }

    /// Smallest radius of curvature that a panel may have, mm.
    fn least_bend(&self) -> f64 {
        self.patch_bend().max(self.options.limits.min_bend_radius.unwrap_or(0.0))
    }

    /// The radius of curvature that fits keep where they can, mm.
    fn wanted_bend(&self) -> f64 {
        let limit = self.options.limits.min_bend_radius.unwrap_or(0.0);
        (WANTED_BEND * self.patch_bend()).max(WANTED_LIMIT * limit)
    }

    /// The loop of propose, judge and refine for one torse.
    pub(crate) fn proven(&self, region: Region, first: Fit, samples: Vec<Sample>) -> Attempt {
        self.peaks_proven(region, first, samples, false)
    }

    /// As [`Job::proven`]; with `peaks` a refused torse learns those between the samples, which is worth its time where
    /// it need only be a little better.
    fn peaks_proven(&self, region: Region, first: Fit, mut samples: Vec<Sample>, peaks: bool) -> Attempt {
        let allowed = self.options.tolerance * DISTANCE_SHARE;
        let triangles = region.triangles();
        let limits = &self.options.limits;
        let clearance = (LEAST_CLEARANCE * region.width()).max(limits.min_clearance.unwrap_or(0.0));
        let bend = self.least_bend();
        let (bend_radius, control) = (self.wanted_bend(), self.control.clone());
        let options = RefitOptions { bend_radius, control, ..RefitOptions::new(allowed * HOPEFUL * HOPEFUL) };
        let mut fit = first;
        for round in 0..=REFITS {
            self.proofs.fetch_add(1, Ordering::Relaxed);
            let judged =
                distance(&self.prepared, &fit.torse, &triangles, allowed, &DistanceOptions::default(), self.control);
            match judged.verdict {
                Verdict::Holds { .. }
                    if judged.min_bend_radius < bend
                        || judged.regression_clearance < clearance
                        || !region.has_patch(&fit.torse) =>
                {
                    return Attempt { misshapen: true, ..Attempt::failed(allowed * 1.03) };
                }
                Verdict::Holds { .. } => {
                    let error = fit.error;
                    return Attempt { accepted: Some(Arc::new(fit)), ..Attempt::failed(error) };
                }
                Verdict::Fails { uv, distance } => {
                    if round == REFITS || distance.abs() > 1.3 * allowed {
                        return Attempt::failed(distance.abs().max(allowed * 1.0001));
                    }
                    let j = self.face.surface.jet(uv[0], uv[1]);
                    let weight = samples.iter().map(|s| s.weight).fold(0.0, f64::max);
                    if peaks && round == 0 {
                        let finer = region.dense_samples(Density::Peaks);
                        samples.extend(beyond(&fit.torse, finer, fit.error.max(PEAK * allowed)));
                    }
                    let n = j.normal();
                    let n = if n.norm() > 0.0 { n.normalize() } else { n };
                    samples.push(Sample { x: j.p, n, weight });
                    match refit(&fit, &samples, &options) {
                        // The witness is near another ruling: further samples cannot help.
                        Some(next) if next.torse == fit.torse => return Attempt::failed(distance.abs()),
                        Some(next) if next.error <= allowed => fit = next,
                        Some(next) => return Attempt::failed(next.error),
                        None => return Attempt::failed(distance.abs()),
                    }
                }
                Verdict::Undecided { reason, .. } => {
                    // Near enough at every place looked at, but its regression curve comes into the panel.
                    let misshapen = matches!(reason, Obstruction::Foot | Obstruction::Fold);
                    return Attempt { misshapen, ..Attempt::failed(allowed * 1.05) };
                }
            }
        }
        Attempt::failed(allowed * 1.02)
    }
}
