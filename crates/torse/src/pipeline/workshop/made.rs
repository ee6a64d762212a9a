//! The work on one part.

use super::options::WorkshopOptions;
use crate::answer::shop::{face_name, PartWork};
use crate::answer::Answer;
use crate::develop::shop::facets::faceted;
use crate::develop::shop::laid::Laid;
use crate::develop::shop::neutral::offset_pattern;
use crate::develop::shop::roll::roll_table;
use crate::develop::shop::sections::{sections, SectionPlane};
use crate::develop::shop::thickness::{Hollow, PartSheet, Sheet};
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;

/// Share of the tolerance to which changed outlines and marks are drawn.
const DRAWN: f64 = 0.05;

/// What is known of the work on a part.
pub(super) struct Made {
    pub work: PartWork,
    /// Its pattern, where it is changed.
    pub changed: Option<Pattern>,
    /// Whether rulings of the drawing are known in space.
    pub known: bool,
}

/// The work on the part of a pattern.
pub(super) fn made(answer: &Answer, pattern: &Pattern, planes: &[SectionPlane], options: &WorkshopOptions) -> Made {
    let part = answer.parts.get(pattern.panel);
    let own = answer.sheets.get(pattern.panel);
    let faces = answer.laid_faces.get(pattern.panel).filter(|f| !f.is_empty());
    // Bodies of sheet have their own thickness; surfaces that were given one are laid flat by their neutral fibre.
    let is_body = own.is_some_and(|s| s.thickness > 0.0);
    let is_fibre = own.is_some_and(|s| s.given.is_some());
    let laid = part.and_then(|p| match faces.zip(own) {
        Some((faces, own)) => Laid::of_faces(faces, own, pattern),
        None if is_body || is_fibre => None,
        None => Laid::of(&answer.patchwork, p, pattern),
    });
    let apex = part.is_some_and(|p| has_apex(answer, p));
    let of = |s: &Sheet| {
        let found = s.of(pattern);
        let Hollow { outwards, inwards } = Hollow::of(pattern);
        // The offset of an apex is a curve, which no outline of the panels has; a sheet that does not fit has none. Faces that have
        // a map of their own and are not laid flat by their fibre have no room for it.
        let none = apex || found.inside_radius <= 0.0 || laid.is_none() || faces.is_some();
        let unknown = if is_fibre { outwards && inwards } else { none && found.neutral != 0.0 };
        PartSheet { neutral: if unknown { f64::NAN } else { found.neutral }, ..found }
    };
    let sheet = options.sheet().filter(|_| !is_body).as_ref().map(of);
    let Some(laid) = &laid else {
        return Made { work: PartWork { sheet, ..PartWork::default() }, changed: None, known: false };
    };
    let work = PartWork {
        roll: roll_table(laid, pattern),
        faceted: options.kinked.then(|| faceted(laid, pattern)).flatten(),
        panels: panel_names(answer, pattern, part, laid),
        sheet,
    };
    let tolerance = DRAWN * answer.tolerance;
    let neutral = sheet.map(|s| s.neutral).filter(|d| d.is_finite() && !is_fibre).unwrap_or(0.0);
    let marks = sections(laid, pattern, planes, tolerance);
    let changed = (!marks.is_empty() || neutral != 0.0).then(|| {
        let marked = Pattern { sections: marks, ..pattern.clone() };
        offset_pattern(laid, &marked, neutral, tolerance)
    });
    Made { work, changed, known: true }
}

/// Names of the panels of a part, as the file of panels has them.
fn panel_names(answer: &Answer, pattern: &Pattern, part: Option<&Part>, laid: &Laid) -> Vec<String> {
    if laid.is_of_faces() {
        return (0..laid.len()).map(|k| face_name(&pattern.name, k)).collect();
    }
    let panels = part.and_then(|p| answer.patchwork.panels.get(p.first..p.first + p.count));
    panels.unwrap_or_default().iter().map(|p| p.strip.name.clone()).collect()
}

/// Whether a strip of a part ends in a point.
fn has_apex(answer: &Answer, part: &Part) -> bool {
    let strips = answer.strips().skip(part.first).take(part.count);
    strips.into_iter().any(|s| s.is_point(0) || s.is_point(1))
}
