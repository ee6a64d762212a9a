//! Covering one face with torses, each accepted by the certificate.
//!
//! *Method* (mixed-curvature specification, C0): one panel if one is enough; two; straight bands laid all at once, where
//! they promise fewer panels than curved ones, or marched in the best directions, where they are few and cannot be laid
//! so; bands of a strip potential for the conjugate field (\[SE06\] carried on), all at once or one after the other, if
//! they promise enough; division, where no strip potential is good or saddles surround a flat point; a sweep of straight
//! bands in the directions that are left, where more panels are needed than theory asks for; bisection, which always
//! ends, at worst with small planar facets. The smallest cover wins; neighbours that fit one torse are merged.
//!
//! What is developable already, and faces of revolution, come before all that (`exact`, `revolved`).
//!
//! This file holds the recursion; `covered_face` holds what is known of the face, `region` answers for one part of it, `propose`
//! fits and proves single torses, `march` lays bands.

mod covered_face;
mod curve_on_face;
mod directed_bands;
mod equidistribute;
mod exact;
mod guided;
mod halve;
mod job;
mod layout;
mod limits;
mod march;
mod merge;
mod prong;
mod propose;
mod recount;
mod region;
mod revolved;
mod seam_line;
mod signs;
mod umbilic;
mod whole_face;

use crate::brep::face::Face;
use crate::control::Control;
use crate::fit::near::samples::Fit;
use crate::fit::strip_potential::{
    straight_bands, strip_potential, strip_potentials, StripPotential, StripPotentialOptions,
};
use crate::num::hash::HashMap;
use crate::num::parallel;
use crate::patchwork::partition::centroid;
use crate::patchwork::triangulate::TriangulateError;
use crate::spline::field::Field;
pub use covered_face::{Cover, Origin};
pub use curve_on_face::{CurveError, CurveShape, PanelCurve};
pub(crate) use exact::exactly;
pub(in crate::search) use exact::{exact_regions, exactly_covered};
pub(crate) use exact::{is_developable, is_smoothly_developable};
pub use job::CoverOptions;
pub(crate) use job::Job;
use layout::DirectionField;
pub use layout::{Guide, Layout, LayoutKind, SeamPlane};
pub use limits::Limits;
pub(crate) use limits::{bent_panels, panels_needed};
use march::SWEEP_DIRECTIONS;
pub(in crate::search) use propose::least_bend;
pub(crate) use recount::Recount;
use region::Density;
pub use region::Region;
pub(crate) use revolved::is_all_round;
pub(in crate::search) use revolved::{meridian, revolved};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Arc;
use umbilic::Star;

/// Functions of a face along whose levels bands are laid: so many strip potentials, and so many straight directions all at once.
const CANDIDATES: usize = 2;
/// Depth of the recursion at which only facets are tried, so that it ends.
const FACET_DEPTH: usize = 14;
/// Strip potentials are given up for parts when their merit exceeds this multiple of their range (C4).
const POOR: f64 = 1.5;
/// Covers with up to this multiple of the predicted count, and one panel more, count as near theory.
const PROMISING: f64 = 1.25;
/// Depth of the recursion down to which sweeps are tried.
const SWEEP_DEPTH: usize = 2;
/// Against covers of more panels than this, a direction of the sweep …
const SWEEP_COUNT: f64 = 18.0;
/// … must promise less than this share of them: with many panels, sweeps take long.
const PROMISED: f64 = 0.8;
/// Sweeps end with this multiple of the panels that they promise, and so many more: bands that become narrower and narrower, as
/// before a place where the face bends more sharply than panels may, would go on for long.
const MOST_SWEPT: (f64, f64) = (4.0, 8.0);
/// Budgets above this are not limited by any cover, or by the user.
const UNLIMITED: usize = usize::MAX / 2;
/// Strip potentials are not tried when they promise more than this multiple of the panels that marched straight bands
/// leave to win.
const BEATEN: f64 = 1.15;
/// Parts must promise less than this multiple of the panels that they may have: merits say little where they are poor.
const HOPED: f64 = 2.0;
/// Deep in the recursion only so many are tried, those that promise the fewest bands.
const FEW_DIRECTIONS: usize = 3;
/// Two panels are tried when the best single error is below this multiple of the tolerance.
const TWO_FACTOR: f64 = 8.0;
/// A linear function of the parameters, whose levels bound straight bands.
struct Straight {
    field: Field,
    /// Number of bands that theory promises, and how dense they must lie in equal parts of the function's range.
    promised: f64,
    density: Vec<f64>,
}

impl Straight {
    /// Panels with which a sweep is given up.
    fn most_swept(&self) -> usize {
        // Endless promises say nothing; casts saturate.
        (MOST_SWEPT.0 * self.promised + MOST_SWEPT.1) as usize
    }
}

/// Covers a face; regions without a torse could not be covered within the limits.
///
/// # Errors
/// Trim loops that cannot be triangulated.
pub fn cover(face: &Face, options: &CoverOptions, control: &Control) -> Result<Cover, TriangulateError> {
    if let Some(cover) = exactly_covered(face, options, control) {
        return Ok(cover);
    }
    let mut cover = Cover::bare(face, options.tolerance)?;
    cover.cut_along_seams(&options.layout, options.tolerance);
    let mut job = Job::new(face, options, control);
    Ok(match options.layout.curves.as_slice() {
        [] => {
            let directions = options.layout.guide.as_ref().map_or(DirectionField::Free, DirectionField::Along);
            job.covered(cover, &directions)
        }
        curves => job.along_curves(cover, curves),
    })
}

/// What is wrong with each curve of a layout on a face.
///
/// # Errors
/// Trim loops that cannot be triangulated.
pub(crate) fn check_curves(
    face: &Face,
    curves: &[PanelCurve],
    tolerance: f64,
) -> Result<Vec<Result<(), CurveError>>, TriangulateError> {
    Ok(Cover::of_face(face, f64::INFINITY)?.checked(curves, tolerance))
}

/// As [`check_curves`], for curves of seams: any curve on a face is of use.
pub(crate) fn check_seam_curves(
    face: &Face,
    curves: &[PanelCurve],
    tolerance: f64,
) -> Result<Vec<Result<(), CurveError>>, TriangulateError> {
    let cover = Cover::of_face(face, f64::INFINITY)?;
    Ok(curves.iter().map(|c| cover.lines_of(c, tolerance).map(drop)).collect())
}

impl<'a> Job<'a> {
    /// Covers all regions that have no torse yet; strips that have a direction field run along it, or in rings.
    fn covered(&mut self, mut cover: Cover, directions: &DirectionField<'a>) -> Cover {
        for label in cover.free() {
            let around = match self.options.layout.kind {
                LayoutKind::Rings => self.rings(&mut cover, label),
                LayoutKind::Auto | LayoutKind::Strips => None,
            };
            let (directions, parts) = match around {
                Some((centre, parts)) => (DirectionField::Around(centre), parts),
                None => (directions.clone(), vec![label]),
            };
            self.directions = directions;
            for part in parts {
                let left = self.options.max_panels.saturating_sub(cover.panels.len());
                if let Some(next) = self.region_covered(cover.clone(), part, left, 0) {
                    cover = next;
                }
            }
        }
        cover
    }

    /// Covers the region `label` with at most `budget` panels. `None`: over budget, stopped, or out of depth.
    #[expect(clippy::too_many_lines, reason = "one story of a face, attempt by attempt")]
    pub(crate) fn region_covered(&self, cover: Cover, label: u32, budget: usize, depth: usize) -> Option<Cover> {
        if budget == 0 {
            return None;
        }
        if self.control.stopped() {
            return Some(cover);
        }
        let before = cover.panels.len();
        let region = cover.region(label);
        let attempt = self.single(region, None);
        if let Some(fit) = attempt.accepted {
            let mut cover = cover;
            cover.panels.insert(label, fit);
            return Some(cover);
        }
        if self.control.stopped() {
            return Some(cover);
        }
        if depth >= FACET_DEPTH || self.options.facets {
            return self.bisect(cover, label, budget, depth);
        }
        let free = matches!(self.directions, DirectionField::Free);
        let fewest = free && self.options.layout.kind == LayoutKind::Auto;
        if fewest && budget >= 2 && attempt.error < TWO_FACTOR * self.options.tolerance {
            if let Some(next) = self.two(region) {
                return Some(next);
            }
        }
        let mut best: Option<Cover> = None;
        let mut limit = budget;
        let top = depth == 0;
        let keep = |next: Cover, best: &mut Option<Cover>, limit: &mut usize| {
            let next = if top { self.merged(next) } else { next };
            let n = next.panels.len().saturating_sub(before);
            // A candidate cut short by the clock has few panels because it is unfinished.
            if n <= *limit && !(best.is_some() && self.control.stopped()) {
                *limit = n.saturating_sub(1);
                *best = Some(next);
            }
        };
        let four = 4.0 * self.options.tolerance.sqrt();
        let found = self.strip_potentials(region, depth);
        let good: Vec<&StripPotential> =
            found.iter().filter(|l| !free || l.merit <= POOR * l.range).take(CANDIDATES).collect();
        let predicted = good.iter().map(|l| l.merit / four).fold(f64::INFINITY, f64::min);
        // Bands of a good strip potential come within a panel or two of theory; others can hardly beat that.
        let near_theory = |n: f64| predicted.is_finite() && n <= PROMISING * predicted + 1.0;
        // With more to spare, one band fewer might do: theory may ask for more than is needed.
        let full = |n: usize, spare: f64| spare < 1.0 - equidistribute::AIM * (1.0 - 1.0 / n.max(1) as f64).powi(2);
        let mut swept = false;
        let straight = if fewest && depth <= SWEEP_DEPTH { self.straight(region) } else { Vec::new() };
        // Directions in which straight bands have been marched.
        let mut marched = 0;
        if top {
            let curved = found.first().map_or(f64::INFINITY, |l| self.bands_predicted(region, l));
            if let Some((next, spare)) = self.equidistribute_straight(region, &straight, curved, limit) {
                swept = full(next.panels.len().saturating_sub(before), spare);
                keep(next, &mut best, &mut limit);
            } else if straight.first().is_some_and(|s| s.promised < curved.min(SWEEP_COUNT)) {
                marched = FEW_DIRECTIONS.min(straight.len());
                if let Some(next) = self.sweep(region, limit, &straight[..marched], f64::INFINITY) {
                    keep(next, &mut best, &mut limit);
                }
            }
        }
        // Theory is no limit where panels are few: strip potentials must promise clearly more than what is left to win.
        let most = if marched > 0 { BEATEN } else { 1.0 } * limit as f64;
        let worth_it = |l: &StripPotential| best.is_none() || l.merit / four <= most;
        let tried: Vec<&StripPotential> = good.iter().copied().filter(|l| worth_it(l)).collect();
        for (i, l) in tried.into_iter().enumerate() {
            let near = |b: &Cover| near_theory((b.panels.len() - before) as f64);
            if limit == 0 || (i > 0 && best.as_ref().is_some_and(near)) {
                break;
            }
            let even = if top { self.equidistribute(region, &l.field, (l.merit / four, &[1.0]), limit) } else { None };
            let mut enough = false;
            if let Some((next, spare)) = even {
                enough = full(next.panels.len().saturating_sub(before), spare);
                keep(next, &mut best, &mut limit);
            }
            if enough || limit == 0 {
                continue;
            }
            if let Some(next) = self.bands(region, l, limit, depth) {
                keep(next, &mut best, &mut limit);
            }
        }
        // Around a flat point of saddles no strip potential is good, even if samples do not tell.
        let stars = if fewest { region.stars() } else { Vec::new() };
        // Parts have no limit as long as there is no cover, and could go on for long: a sweep, which ends, gives them one.
        if top && best.is_none() && good.is_empty() && stars.is_empty() && marched < straight.len() {
            if let Some(next) = self.sweep(region, limit, &straight[marched..], f64::INFINITY) {
                keep(next, &mut best, &mut limit);
            }
            marched = straight.len();
        }
        if limit > 0 && (good.is_empty() || !stars.is_empty()) {
            if let Some(next) = self.divided(region, limit, depth, &stars) {
                keep(next, &mut best, &mut limit);
            }
        }
        let reached = best.as_ref().map_or(predicted, |b| (b.panels.len() - before) as f64);
        let near = near_theory(reached);
        if marched < straight.len() && limit > 0 && !(swept && (near || reached > SWEEP_COUNT)) {
            // Many bands, or bands near theory, leave little hope: only directions that promise fewer are worth it.
            let (most, directions) = if reached > SWEEP_COUNT {
                (PROMISED * reached, SWEEP_DIRECTIONS)
            } else if near {
                (reached, FEW_DIRECTIONS)
            } else {
                (f64::INFINITY, SWEEP_DIRECTIONS)
            };
            let directions = if depth > 0 { FEW_DIRECTIONS } else { directions }.clamp(marched, straight.len());
            if let Some(next) = self.sweep(region, limit, &straight[marched..directions], most) {
                keep(next, &mut best, &mut limit);
            }
        }
        if top && fewest {
            best = best.map(|b| self.evened(region, b));
        }
        // A part that must do with what another cover leaves has had its chance: halves of it, and of every part around it in turn,
        // need no fewer panels, and are without number.
        if best.is_none() && (depth == 0 || budget > UNLIMITED) {
            if let Some(next) = self.bisect(cover, label, budget, depth) {
                limit = budget;
                keep(next, &mut best, &mut limit);
            }
        }
        // Nobody knows how many it will take.
        self.control.report("covering faces", f64::NAN, format!("{} proofs", self.proofs.load(Ordering::Relaxed)));
        best
    }

    /// Strip potentials of a region, the one that promises the fewest panels first; the first region of a face, worth
    /// more than small remainders, has them sought in two spaces.
    fn strip_potentials(&self, region: Region, depth: usize) -> Vec<StripPotential> {
        let places = region.places();
        if !matches!(self.directions, DirectionField::Free) {
            let samples_and_spans = if depth > 0 { (700, 2) } else { (1500, 3) };
            return self.directed_strip_potentials(&self.directions, region, samples_and_spans);
        }
        let attempt = |samples: usize, spans: usize, keep: usize| {
            let options = StripPotentialOptions {
                spans,
                keep,
                control: self.control.clone(),
                ..StripPotentialOptions::default()
            };
            strip_potentials(&region.forms(samples), &places, &options)
        };
        if depth > 0 {
            let mut found = attempt(700, 2, 2);
            found.truncate(1);
            return found;
        }
        let (coarse, fine) = parallel::join(|| attempt(700, 2, 3), || attempt(1500, 3, 3));
        let mut found: Vec<(f64, StripPotential)> =
            coarse.into_iter().chain(fine).map(|l| (self.bands_predicted(region, &l), l)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|f| f.1).collect()
    }

    /// Number of panels that bands of the theoretical width would be, in as many pieces as they fall into, raised where
    /// the strip potential falls short.
    fn bands_predicted(&self, region: Region, l: &StripPotential) -> f64 {
        let width = 4.0 * self.options.tolerance.sqrt();
        let (partition, cells) = (&region.cover.partition, region.cells());
        let value = |t: usize| l.field.value(centroid(partition.corners(t)));
        let lo = cells.iter().map(|&t| value(t)).fold(f64::INFINITY, f64::min);
        let bands: HashMap<usize, i64> =
            cells.iter().map(|&t| (t, ((value(t) - lo) / width).floor().min(1e6) as i64)).collect();
        let pieces = partition.components(&cells, |a, b| bands[&a] == bands[&b]).len();
        pieces as f64 * l.merit / l.range
    }

    /// The directions of a sweep; the one that promises the fewest bands first.
    fn straight(&self, region: Region) -> Vec<Straight> {
        let bounds = region.bounds();
        let forms = region.forms(100);
        let (e, g) = forms.iter().fold((0.0, 0.0), |(e, g), f| (e + f.first[0], g + f.first[2]));
        let aspect = if e > 0.0 { (g / e).sqrt() } else { 1.0 };
        let four = 4.0 * self.options.tolerance.sqrt();
        let mut found: Vec<Straight> = (0..SWEEP_DIRECTIONS)
            .filter_map(|k| {
                let angle = std::f64::consts::PI * k as f64 / SWEEP_DIRECTIONS as f64;
                let gradient = [angle.cos(), angle.sin() * aspect];
                let mut field = Field::bicubic(bounds, 1).ok()?;
                field.set_linear(gradient[0], gradient[1]);
                let bands = straight_bands(&forms, gradient);
                Some(Straight { field, promised: bands.range / four, density: bands.density })
            })
            .collect();
        found.sort_by(|a, b| a.promised.total_cmp(&b.promised));
        found
    }

    /// Straight bands laid all at once, where they promise fewer panels than curved ones; as [`Job::equidistribute`].
    fn equidistribute_straight(
        &self,
        region: Region,
        directions: &[Straight],
        curved: f64,
        budget: usize,
    ) -> Option<(Cover, f64)> {
        directions
            .iter()
            .take(CANDIDATES)
            .filter(|s| s.promised < curved && s.promised <= budget as f64)
            .find_map(|s| self.equidistribute(region, &s.field, (s.promised, &s.density), budget))
    }

    /// Straight bands marched in those of several directions that promise fewer than `most`; the fewest win (C5b).
    fn sweep(&self, region: Region, budget: usize, directions: &[Straight], most: f64) -> Option<Cover> {
        let incumbent = AtomicUsize::new(march::key(budget, SWEEP_DIRECTIONS));
        let before = region.cover.panels.len();
        // Without a limit, directions of which nothing can be said are tried too.
        let tried = directions.iter().enumerate().filter(|(_, s)| most.is_infinite() || s.promised < most);
        let found = parallel::map(tried, |(rank, s)| {
            let most = s.most_swept();
            let next = self.swept(region, &s.field, march::Limit { best: &incumbent, rank, most })?;
            let n = next.panels.len() - before;
            incumbent.fetch_min(march::key(n, rank), Ordering::Relaxed);
            Some((n, rank, next))
        });
        found.into_iter().flatten().min_by_key(|(n, rank, _)| (*n, *rank)).map(|(_, _, s)| s)
    }

    /// Cuts a region for which no strip potential is good, where the parts together promise fewer strips (C4): by sign, in
    /// halves, or through a flat point.
    fn divided(&self, region: Region, budget: usize, depth: usize, stars: &[Star]) -> Option<Cover> {
        let four = 4.0 * self.options.tolerance.sqrt();
        let rate = |part: Region| {
            let options =
                StripPotentialOptions { rounds: 3, control: self.control.clone(), ..StripPotentialOptions::default() };
            strip_potential(&part.forms(160), &part.places(), &options)
        };
        let candidates: Vec<(f64, Cover, Vec<u32>)> = parallel::map(0..4 + stars.len(), |k| {
            let mut s = region.cover.clone();
            let parts = match k {
                0 => s.cut_by_sign(region.label)?,
                1..4 => s.halve(region.label, k - 1)?,
                _ => stars[k - 4].cut(&mut s, region.label)?,
            };
            let merit: f64 = parts.iter().map(|&p| rate(s.region(p)).map_or(0.0, |l| l.merit) + four).sum();
            Some((merit, s, parts))
        })
        .into_iter()
        .flatten()
        .collect();
        let (merit, s, parts) = candidates.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        if merit > HOPED * four * budget as f64 {
            return None;
        }
        self.parts(s, &parts, budget, depth)
    }

    /// Covers several regions one after the other within a common budget.
    fn parts(&self, mut cover: Cover, parts: &[u32], budget: usize, depth: usize) -> Option<Cover> {
        let before = cover.panels.len();
        for (i, &p) in parts.iter().enumerate() {
            let used = cover.panels.len() - before;
            let rest = parts.len() - 1 - i;
            cover = self.region_covered(cover, p, budget.checked_sub(used + rest)?, depth + 1)?;
        }
        Some(cover)
    }

    /// Cuts a region in the middle of its principal axis in space and covers the parts (C6).
    fn bisect(&self, mut cover: Cover, label: u32, budget: usize, depth: usize) -> Option<Cover> {
        let parts = cover.halve(label, 0)?;
        self.parts(cover, &parts, budget, depth)
    }
}

/// Range of the best strip potential over a whole face (√mm), its shortfall added: bands of the width `4√ε` then number
/// `range/(4√ε)`, the fewest that theory allows (approximation specification B2) as far as the strip potential is
/// the best. `None` where no strip potential covers the face: planes, mixed curvature.
pub(crate) fn band_range(face: &Face) -> Option<f64> {
    let cover = Cover::of_face(face, f64::INFINITY).ok()?;
    let region = cover.region(0);
    let options = StripPotentialOptions { spans: 3, ..StripPotentialOptions::default() };
    let best = strip_potentials(&region.forms(1500), &region.places(), &options).into_iter().next()?;
    (best.merit <= POOR * best.range).then_some(best.merit)
}

/// As [`band_range`], from few samples and in little time: for comparing faces.
pub(crate) fn strip_range(face: &Face) -> Option<f64> {
    let cover = Cover::of_face(face, f64::INFINITY).ok()?;
    let options = StripPotentialOptions { rounds: 3, ..StripPotentialOptions::default() };
    let region = cover.region(0);
    let best = strip_potential(&region.forms(160), &region.places(), &options)?;
    (best.merit <= POOR * best.range).then_some(best.merit)
}

/// Whether one panel is proven to cover a face within a tolerance (mm).
pub(crate) fn has_one_panel(face: &Face, tolerance: f64, control: &Control) -> bool {
    let Ok(cover) = Cover::bare(face, tolerance) else { return false };
    let options = CoverOptions::new(tolerance);
    match cover.partition.distinct_labels()[..] {
        [label] => Job::new(face, &options, control).single(cover.region(label), None).accepted.is_some(),
        _ => false,
    }
}

impl Job<'_> {
    /// A torse that is proven on a region, from those that were tried on about the same, else without.
    pub(crate) fn laid_anew<'a>(&self, region: Region, from: impl Iterator<Item = &'a Arc<Fit>>) -> Option<Arc<Fit>> {
        let samples = region.dense_samples(Density::Band);
        let mut tried = from.map(|fit| self.proven(region, (**fit).clone(), samples.clone()));
        tried.find_map(|t| t.accepted).or_else(|| self.single(region, None).accepted)
    }

    /// A panel given to a neighbour whose torse is good for both, or joined with one of them by a new panel, or shared evenly
    /// by two.
    /// `None` where neither can be proven.
    pub(crate) fn without_sliver(&self, region: Region) -> Option<Cover> {
        let mut bare = region.cover.clone();
        bare.panels.remove(&region.label);
        let bare = bare.region(region.label);
        self.absorbed(bare, None).or_else(|| self.as_one(bare)).or_else(|| self.shared(bare))
    }

    /// Gives the regions of refused panels to neighbours that can have them, or cuts them in two and covers the parts
    /// anew.
    pub(crate) fn cut_refused(&self, cover: &Cover, refused: &[u32]) -> Option<Cover> {
        let mut cover = cover.clone();
        for &label in refused {
            cover.panels.remove(&label);
            if let Some(next) = self.absorbed(cover.region(label), None) {
                cover = next;
                continue;
            }
            cover = match cover.cut_open(label) {
                Some(parts) => self.parts(cover, &parts, usize::MAX, 0)?,
                None => self.bisect(cover, label, usize::MAX, 0)?,
            };
        }
        Some(cover)
    }
}
