//! Sheet and work for the answer of any job: material, thickness, the neutral fibre, kinks, roll radii, sections, bevels.
//!
//! Comes after the job and before its files. What a job has proven of its panels stays; flat patterns that are changed here are
//! measured from then on, and say so.

mod made;
mod offsets;
mod options;
mod planes;
mod refusals;

use crate::answer::note::{Note, ShopNote};
use crate::answer::shop::{PartWork, Shop};
use crate::answer::{Answer, Job};
use crate::certify::claim::{Claim, Subject, What};
use crate::develop::shop::bevel::{bevels, SeamBevel};
use crate::develop::shop::thickness::{below_least, too_tight, Sheet};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::bends::BendKind;
use crate::develop::unfold::part::SheetPart;
use crate::num::parallel;
use crate::patchwork::pattern::Pattern;
use crate::search::build::drawings_missed;
use crate::search::cover::Limits;
use crate::search::strips::cut::flat_area;
use made::{made, Made};
use offsets::offsets;
pub use options::{Stations, WorkshopError, WorkshopOptions};
use planes::planes;

/// Prepares sheet and work of an answer: [`Answer::shop`], marks of sections and patterns of the neutral fibre.
///
/// # Errors
/// See `WorkshopError`.
///
/// # Example
/// ```
/// use torse::pipeline::workshop::{prepare, WorkshopOptions};
/// let pipe = torse::read(include_bytes!("../../../../data/cylinder_holes.step"))?;
/// let mut answer = torse::approximate(&pipe, &torse::Approximate::new(0.5))?;
/// prepare(&mut answer, &WorkshopOptions { thickness: Some(2.0), ..WorkshopOptions::default() })?;
/// assert_eq!(answer.shop.thickness, Some(2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn prepare(answer: &mut Answer, options: &WorkshopOptions) -> Result<(), WorkshopError> {
    if let Some(t) = options.thickness.filter(|t| !(*t > 0.0 && t.is_finite())) {
        return Err(WorkshopError::Thickness(t));
    }
    options.k.as_ref().map_or(Ok(()), KFactor::check)?;
    let has_sheet = options.thickness.is_some() || answer.sheets.iter().any(|s| s.thickness > 0.0);
    if options.k.is_some() && !answer.parts.is_empty() && !has_sheet {
        return Err(WorkshopError::NoSheet);
    }
    let planes = planes(answer, &options.stations)?;
    answer.shop = Shop { material: options.material.clone(), thickness: options.thickness, ..Shop::default() };
    let sheet = options.sheet();
    let made: Vec<Made> = parallel::map(answer.patterns.iter(), |pattern| made(answer, pattern, &planes, options));
    let mut told = Told::default();
    for (k, made) in made.into_iter().enumerate() {
        let Made { work, changed, known } = made;
        let pattern = &answer.patterns[k];
        let curved = pattern.bends.iter().any(|b| b.angle > 0.0);
        let drawn = answer.sheets.get(pattern.panel).is_some_and(|s| s.given.is_some());
        let moves = sheet.as_ref().is_some_and(|s| s.of(pattern).neutral != 0.0) && work.sheet.is_some();
        // Rolled faces of bodies are kinked where they are laid flat.
        let kinked = options.kinked && answer.job != Job::Unroll;
        if !known && (!planes.is_empty() || (curved && (kinked || moves))) {
            // Bodies of sheet have their own fibre, and surfaces without a thickness none.
            let is_body = answer.sheets.get(pattern.panel).is_some_and(|s| s.thickness > 0.0);
            let has_all = drawn || is_body || (answer.job == Job::Unroll && !moves);
            let list = if has_all { &mut told.places } else { &mut told.unknown };
            list.push(pattern.name.clone());
        }
        if drawn && curved {
            told.neutral.push(pattern.name.clone());
        }
        let is_moved = !drawn && work.sheet.is_some_and(|s| s.neutral.is_finite() && s.neutral != 0.0);
        if is_moved && changed.is_some() {
            told.moved.push(k);
        } else if !drawn && curved && moves && answer.job == Job::Unroll {
            told.not_neutral.push(k);
        }
        if let Some(pattern) = changed {
            answer.patterns[k] = pattern;
        }
        answer.shop.work.push(work);
    }
    answer.shop.bevels = bevelled(answer);
    let (offsets, of_offsets) = offsets(answer, options);
    answer.shop.offsets = offsets;
    measured_from_now_on(answer, &told.moved);
    refuse_grown(answer, &told.moved, &options.limits);
    answer.claims.extend(refusals::refusals(answer, options, &told.not_neutral));
    let notes = notes(answer, options, told);
    answer.notes.extend(notes.into_iter().chain(of_offsets).map(Note::Shop));
    if let Some(depth) = sheet.as_ref().map(Sheet::greatest_depth) {
        answer.claims.extend(inside_radius(answer, depth));
    }
    Ok(())
}

/// Bevels along seams between panels that cover faces, and along edges that parts share.
fn bevelled(answer: &Answer) -> Vec<SeamBevel> {
    let panels = &answer.patchwork;
    let covers = answer.covers_faces() || (answer.job == Job::Unroll && panels.seam_count + panels.joint_count > 0);
    let mut out = if covers { bevels(panels) } else { Vec::new() };
    out.extend(answer.joints.iter().map(|joint| {
        let own = joint.parts.iter().filter_map(|k| answer.sheets.get(*k)).map(|s| s.thickness);
        SeamBevel {
            name: joint.name.clone(),
            between: joint.parts.map(|k| answer.parts.get(k).map_or_else(String::new, |p| p.name.clone())),
            thickness: own.reduce(f64::min).filter(|t| *t > 0.0),
            stations: joint.stations.clone(),
        }
    }));
    out
}

/// What is to be told of parts.
#[derive(Default)]
struct Told {
    /// Patterns moved to the neutral fibre: their numbers.
    moved: Vec<usize>,
    /// Patterns that ought to be moved and are not: their numbers.
    not_neutral: Vec<usize>,
    /// Names of parts that were laid flat by their neutral fibre.
    neutral: Vec<String>,
    /// Of parts of which neither work nor the neutral fibre is known.
    unknown: Vec<String>,
    /// Of those of which the work is not known.
    places: Vec<String>,
}

/// The least inside radius of all parts: proven where panels cover faces, else measured.
fn inside_radius(answer: &Answer, depth: f64) -> Option<Claim> {
    if answer.job == Job::Unroll {
        return None;
    }
    if let Some(certificate) = &answer.certificate {
        return Some(certificate.inside_radius(depth));
    }
    let least = answer.shop.work.iter().filter_map(|w| w.sheet).map(|s| s.inside_radius).fold(f64::INFINITY, f64::min);
    Some(Claim::measured(What::InsideRadius, Subject::Whole, least.max(0.0)))
}

/// Nothing is proven any more of flat patterns that were changed.
fn measured_from_now_on(answer: &mut Answer, moved: &[usize]) {
    if moved.is_empty() {
        return;
    }
    let parts: Vec<usize> = moved.iter().map(|k| answer.patterns[*k].panel).collect();
    answer.flat.retain(|f| !parts.contains(&f.panel()));
    let about = [What::LengthError, What::DrawingDistance, What::JointGap];
    let gone = |c: &Claim| {
        about.contains(&c.what())
            && match c.subject() {
                Subject::Whole => true,
                Subject::Panel(k) => answer.part_of(k).is_some_and(|p| parts.contains(&p)),
                Subject::Part(k) => parts.contains(&k),
            }
    };
    let kept: Vec<Claim> = answer.claims.iter().filter(|c| !gone(c)).cloned().collect();
    let worst = |of: fn(&Pattern) -> f64| moved.iter().map(|k| of(&answer.patterns[*k])).fold(0.0, f64::max);
    let more = [
        Claim::measured(What::LengthError, Subject::Whole, worst(|p| p.isometry_error)),
        Claim::measured(What::DrawingDistance, Subject::Whole, worst(|p| p.contour_error)),
    ];
    for joint in &mut answer.joints {
        for (part, length) in joint.parts.iter().zip(&mut joint.lengths) {
            *length = if parts.contains(part) { f64::NAN } else { *length };
        }
    }
    answer.claims = kept;
    answer.claims.extend(more);
    if answer.claim(What::FlatArea).is_some() {
        answer.claims.retain(|c| c.what() != What::FlatArea);
        answer.claims.push(flat_area(&answer.patterns));
    }
}

/// Patterns of the neutral fibre that do not keep the limits of the sheet, though their panels do.
fn refuse_grown(answer: &mut Answer, moved: &[usize], limits: &Limits) {
    let kept = |k: &&usize| !answer.beyond_limits.contains(&answer.patterns[**k].panel);
    let grown: Vec<&Pattern> = moved.iter().filter(kept).map(|k| &answer.patterns[*k]).collect();
    let missed = drawings_missed(grown, limits);
    answer.claims.extend(missed.reasons.into_iter().map(|reason| Claim::objection(Subject::Whole, reason)));
    answer.beyond_limits.extend(missed.panels);
    answer.beyond_limits.sort_unstable();
}

/// The least inside radius (mm) of a sheet. Sharp bends of a model tell none.
fn least_radius(sheet: &SheetPart) -> f64 {
    let round = sheet.bends.iter().filter(|b| b.kind != BendKind::Fold);
    round.map(|b| b.least_inside_radius).fold(f64::INFINITY, f64::min)
}

/// What people should know of sheet and work.
fn notes(answer: &Answer, options: &WorkshopOptions, told: Told) -> Vec<ShopNote> {
    let Told { moved, neutral, unknown, places, .. } = told;
    let mut out: Vec<ShopNote> = options.material.clone().map(ShopNote::Material).into_iter().collect();
    out.extend(options.sheet().filter(|_| answer.job != Job::Unroll).map(ShopNote::Sheet));
    if let Some(sheet) = options.sheet().filter(|_| !neutral.is_empty()) {
        out.push(ShopNote::OfFibre { parts: neutral, sheet });
    }
    if !moved.is_empty() {
        out.push(ShopNote::Neutral { parts: moved.iter().map(|&k| answer.patterns[k].name.clone()).collect() });
    }
    for (k, pattern) in answer.patterns.iter().enumerate() {
        let own = answer.sheets.get(k);
        let thickness = own.map(|s| s.thickness).filter(|t| *t > 0.0).or(options.thickness);
        let (Some(thickness), material) = (thickness, options.material.as_ref()) else { continue };
        let tight = match own.filter(|s| s.thickness > 0.0) {
            Some(sheet) => below_least(least_radius(sheet), thickness, material),
            None => {
                let work = answer.shop.work.get(k).and_then(|w| w.sheet);
                work.and_then(|s| too_tight(s.inside_radius, thickness, material))
            }
        };
        out.extend(tight.map(|tight| ShopNote::TooTight { part: pattern.name.clone(), tight }));
    }
    let left = |(p, w): (&Pattern, &PartWork)| {
        (w.sheet.is_some_and(|s| s.neutral.is_nan()) && !unknown.contains(&p.name)).then(|| p.name.clone())
    };
    let left: Vec<String> = answer.patterns.iter().zip(&answer.shop.work).filter_map(left).collect();
    if !left.is_empty() && (answer.job != Job::Unroll || options.k.is_none()) {
        out.push(ShopNote::NotNeutral { parts: left });
    }
    let off = |w: &PartWork| w.faceted.as_ref().map_or(0.0, |f| f.displacement_estimate);
    let worst = answer.shop.work.iter().map(off).filter(|w| w.is_finite()).max_by(f64::total_cmp).filter(|w| *w > 0.0);
    out.extend(worst.map(|displacement_estimate| ShopNote::Kinked { displacement_estimate }));
    let varies = |(p, w): (&Pattern, &PartWork)| {
        let of_faces = answer.laid_faces.get(p.panel).is_some_and(|f| !f.is_empty());
        (of_faces && w.faceted.as_ref().is_some_and(|f| f.displacement_estimate.is_nan())).then(|| p.name.clone())
    };
    let varying: Vec<String> = answer.patterns.iter().zip(&answer.shop.work).filter_map(varies).collect();
    if !varying.is_empty() {
        out.push(ShopNote::KinkedFibre { parts: varying });
    }
    if !unknown.is_empty() {
        out.push(ShopNote::Unknown { parts: unknown });
    }
    if !places.is_empty() {
        out.push(ShopNote::NoPlaces { parts: places });
    }
    out
}
