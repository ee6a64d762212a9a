//! Sheet and work for the answer of any job: material, thickness, the neutral fibre, kinks, roll radii, sections, bevels.
//!
//! Comes after the job and before its files. What a job has proven of its panels stays; flat patterns that are changed here are
//! measured from then on, and say so.

mod options;
mod planes;
mod refusals;

use crate::answer::note::{Note, ShopNote};
use crate::answer::shop::{PartWork, Shop};
use crate::answer::{Answer, Job};
use crate::certify::claim::{Claim, Subject, What};
use crate::develop::shop::bevel::bevels;
use crate::develop::shop::facets::faceted;
use crate::develop::shop::laid::Laid;
use crate::develop::shop::neutral::offset_pattern;
use crate::develop::shop::roll::roll_table;
use crate::develop::shop::sections::sections;
use crate::develop::shop::thickness::{below_least, too_tight, PartSheet, Sheet};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::bends::BendKind;
use crate::develop::unfold::part::SheetPart;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::search::build::drawings_missed;
use crate::search::cover::Limits;
use crate::search::strips::cut::flat_area;
pub use options::{Stations, WorkshopError, WorkshopOptions};
use planes::planes;
use rayon::prelude::*;

/// Share of the tolerance to which changed outlines and marks are drawn.
const DRAWN: f64 = 0.05;

/// Prepares sheet and work of an answer: [`Answer::shop`], marks of sections and patterns of the neutral fibre.
///
/// # Errors
/// See `WorkshopError`.
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
    let tolerance = DRAWN * answer.tolerance;
    let made: Vec<(PartWork, Option<Pattern>, bool)> = answer
        .patterns
        .par_iter()
        .map(|pattern| {
            let part = answer.parts.get(pattern.panel);
            let laid = part.and_then(|p| Laid::of(&answer.patchwork, p, pattern));
            let Some(laid) = laid else {
                // Bodies of sheet have their own thickness, and other charts than their panels.
                let own = answer.sheets.get(pattern.panel).is_some_and(|s| s.thickness > 0.0);
                let of = |s: &Sheet| PartSheet { neutral: f64::NAN, ..s.of(pattern) };
                let sheet = sheet.as_ref().filter(|_| !own).map(of);
                return (PartWork { sheet, ..PartWork::default() }, None, false);
            };
            // The offset of an apex is a curve, which no outline of the panels has; a sheet that does not fit has none.
            let apex = part.is_some_and(|p| has_apex(answer, p));
            let of = |s: &Sheet| {
                let found = s.of(pattern);
                let none = apex || found.inside_radius <= 0.0;
                let neutral = if none && found.neutral != 0.0 { f64::NAN } else { found.neutral };
                PartSheet { neutral, ..found }
            };
            let work = PartWork {
                roll: roll_table(&laid, pattern),
                faceted: options.kinked.then(|| faceted(&laid, pattern)).flatten(),
                sheet: sheet.as_ref().map(of),
            };
            let neutral = work.sheet.map(|s| s.neutral).filter(|d| d.is_finite()).unwrap_or(0.0);
            let marks = sections(&laid, pattern, &planes, tolerance);
            let changed = (!marks.is_empty() || neutral != 0.0).then(|| {
                let marked = Pattern { sections: marks, ..pattern.clone() };
                offset_pattern(&laid, &marked, neutral, tolerance)
            });
            (work, changed, true)
        })
        .collect();
    let mut moved: Vec<usize> = Vec::new();
    let mut unknown: Vec<String> = Vec::new();
    for (k, (work, changed, known)) in made.into_iter().enumerate() {
        let curved = answer.patterns[k].bends.iter().any(|b| b.angle > 0.0);
        let moves = sheet.as_ref().is_some_and(|s| s.of(&answer.patterns[k]).neutral != 0.0) && work.sheet.is_some();
        // Rolled faces of bodies are kinked where they are laid flat.
        let kinked = options.kinked && answer.job != Job::Unroll;
        if !known && (!planes.is_empty() || (curved && (kinked || moves))) {
            unknown.push(answer.patterns[k].name.clone());
        }
        if let Some(pattern) = changed {
            if work.sheet.is_some_and(|s| s.neutral.is_finite() && s.neutral != 0.0) {
                moved.push(k);
            }
            answer.patterns[k] = pattern;
        }
        answer.shop.work.push(work);
    }
    if answer.covers_faces() {
        answer.shop.bevels = bevels(&answer.patchwork);
    }
    measured_from_now_on(answer, &moved);
    refuse_grown(answer, &moved, &options.limits);
    answer.claims.extend(refusals::refusals(answer, options));
    let notes = notes(answer, options, &moved, unknown);
    answer.notes.extend(notes.into_iter().map(Note::Shop));
    if let Some(depth) = sheet.as_ref().map(Sheet::greatest_depth) {
        answer.claims.extend(inside_radius(answer, depth));
    }
    Ok(())
}

/// Whether a strip of a part ends in a point.
fn has_apex(answer: &Answer, part: &Part) -> bool {
    let strips = answer.strips().skip(part.first).take(part.count);
    strips.into_iter().any(|s| s.is_point(0) || s.is_point(1))
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
fn notes(answer: &Answer, options: &WorkshopOptions, moved: &[usize], unknown: Vec<String>) -> Vec<ShopNote> {
    let mut out: Vec<ShopNote> = options.material.clone().map(ShopNote::Material).into_iter().collect();
    out.extend(options.sheet().filter(|_| answer.job != Job::Unroll).map(ShopNote::Sheet));
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
    if !left.is_empty() && answer.job != Job::Unroll {
        out.push(ShopNote::NotNeutral { parts: left });
    }
    let off = |w: &PartWork| w.faceted.as_ref().map_or(0.0, |f| f.displacement_estimate);
    let worst = answer.shop.work.iter().map(off).max_by(f64::total_cmp).filter(|w| *w > 0.0);
    out.extend(worst.map(|displacement_estimate| ShopNote::Kinked { displacement_estimate }));
    if !unknown.is_empty() {
        out.push(ShopNote::Unknown { parts: unknown });
    }
    out
}
