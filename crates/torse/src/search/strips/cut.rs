//! Flat parts from chains of strips: develop each chain; a chain that would overlap itself in the plane is cut in two.

use crate::certify::claim::{Claim, Subject, What};
use crate::certify::flat::{strip_parts, FlatCertificate};
use crate::control::Control;
use crate::develop::strip::{least_spacing, pattern, StripOptions};
use crate::develop::view::{centre, viewed};
use crate::develop::DevelopError;
use crate::geom::unit::SQUARE_METRES;
use crate::patchwork::part::Part;
use crate::patchwork::pattern::Pattern;
use crate::reason::{Item, Reason, Unlaid};
use crate::torse::strip::Strip;

/// Area of all patterns together.
pub(crate) fn flat_area(patterns: &[Pattern]) -> Claim {
    // The sum of nothing is −0.
    let area = patterns.iter().map(|p| p.area * SQUARE_METRES).sum::<f64>() + 0.0;
    Claim::measured(What::FlatArea, Subject::Whole, area)
}

/// Develops parts. `chains` name their first strip and the number of strips; strips of a chain share rulings.
///
/// Patterns are seen from the side of the model that the options name. Every part asked for is answered: one that cannot be developed is listed with the reason, and without pattern.
pub fn cut(strips: &[Strip], chains: &[Part], options: &StripOptions) -> (Vec<Part>, Vec<Pattern>) {
    cut_until(strips, chains, options, &Control::default())
}

/// As [`cut`]; parts whose turn comes after a control said stop have no pattern.
pub(crate) fn cut_until(
    strips: &[Strip],
    chains: &[Part],
    options: &StripOptions,
    control: &Control,
) -> (Vec<Part>, Vec<Pattern>) {
    let (mut parts, mut patterns) = (Vec::new(), Vec::new());
    let centre = centre(strips);
    let mut waiting: Vec<Part> = chains.iter().rev().cloned().collect();
    while let Some(mut part) = waiting.pop() {
        let Some(chain) = strips.get(part.first..part.first + part.count) else {
            part.missing = Some(Unlaid::NoStrips);
            parts.push(part);
            continue;
        };
        if control.stopped() {
            part.missing = Some(Unlaid::NotBegun);
            parts.push(part);
            continue;
        }
        let chain: Vec<&Strip> = chain.iter().collect();
        match pattern(&chain, parts.len(), &part.name, options) {
            Ok(p) => {
                patterns.push(viewed(p, &chain, options.side, &centre, options.drawn.view));
                parts.push(part);
            }
            Err(DevelopError::Overlap { .. } | DevelopError::Apart { .. }) if part.count > 1 => {
                let half = part.count / 2;
                let piece = |letter: char, first: usize, count: usize| {
                    Part::new(format!("{}{letter}", part.name), first, count)
                };
                waiting.push(piece('b', part.first + half, part.count - half));
                waiting.push(piece('a', part.first, half));
            }
            Err(e) => {
                part.missing = Some(Unlaid::Undeveloped(e.to_string()));
                parts.push(part);
            }
        }
    }
    (parts, patterns)
}

/// Strips laid flat, with what is proven of that.
#[derive(Clone, Debug)]
pub(crate) struct Laid {
    /// Parts as they are cut.
    pub parts: Vec<Part>,
    /// Their patterns.
    pub patterns: Vec<Pattern>,
    /// What is proven of the patterns.
    pub proofs: Vec<FlatCertificate>,
    /// Lines that were asked for nearer to each other than they are drawn.
    pub crowded: Vec<Crowded>,
    /// Distance that drawings must keep, mm.
    tolerance: f64,
}

/// Lays chains of strips flat, see [`cut`], and has them judged; `tolerance` (mm) is that of the job.
pub(crate) fn laid(strips: &[Strip], chains: &[Part], options: &StripOptions, tolerance: f64) -> Laid {
    laid_until(strips, chains, options, tolerance, &Control::default())
}

/// As [`laid`]; parts whose turn comes after a control said stop have no pattern.
pub(crate) fn laid_until(
    strips: &[Strip],
    chains: &[Part],
    options: &StripOptions,
    tolerance: f64,
    control: &Control,
) -> Laid {
    let (parts, patterns) = cut_until(strips, chains, options, control);
    // As the proof of strips in space, this has its own clock.
    let proofs = strip_parts(strips, &parts, &patterns, tolerance, &Control::default());
    let crowded = crowded(&patterns, options);
    Laid { parts, patterns, proofs, crowded, tolerance }
}

impl Laid {
    /// What is said of flat parts: their area, what is proven of lengths and of the drawing, and what stands against each.
    pub(crate) fn claims(&self) -> Vec<Claim> {
        let whole = Subject::Whole;
        let missing =
            self.parts.iter().filter_map(|p| Some(Reason::of(Item::Part(p.name.clone()), p.missing.clone()?)));
        let mut out = vec![self.area()];
        out.extend(self.lengths());
        out.extend(missing.chain(self.refused()).map(|r| Claim::objection(whole, r)));
        out
    }

    /// Puts other proofs in the place of those of the same parts.
    pub(crate) fn prove_anew(&mut self, proofs: Vec<FlatCertificate>) {
        for proof in proofs {
            self.proofs.iter_mut().filter(|p| p.panel() == proof.panel()).for_each(|p| *p = proof.clone());
        }
    }

    /// Area of all patterns.
    pub(crate) fn area(&self) -> Claim {
        flat_area(&self.patterns)
    }

    /// See `lengths`.
    pub(crate) fn lengths(&self) -> Vec<Claim> {
        lengths(&self.patterns, &self.proofs)
    }

    /// See `refused`.
    pub(crate) fn refused(&self) -> Vec<Reason> {
        refused(&self.parts, &self.patterns, &self.proofs, self.tolerance)
    }
}

/// Lines on flat parts that were asked for nearer to each other than they are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crowded {
    /// Which lines.
    pub lines: Lines,
    /// Distance asked for, mm.
    pub asked: f64,
    /// Distance at which they are drawn on the longest part, mm.
    pub least: f64,
}

/// Lines on flat parts of which the distance can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lines {
    /// Rulings.
    Rulings,
    /// Marks along the rails.
    Marks,
}

/// Which lines were asked for nearer to each other than they are drawn.
fn crowded(patterns: &[Pattern], options: &StripOptions) -> Vec<Crowded> {
    let longest = |p: &Pattern| p.sides.iter().map(|s| s.length).fold(0.0, f64::max);
    let least = least_spacing(patterns.iter().map(longest).fold(0.0, f64::max));
    [(Lines::Rulings, options.ruling_spacing), (Lines::Marks, options.mark_spacing)]
        .into_iter()
        .filter_map(|(lines, asked)| Some(Crowded { lines, asked: asked.filter(|s| *s > 0.0 && *s < least)?, least }))
        .collect()
}

/// What is proven of flat parts together; where a part has no proof of its map, lengths as they were measured.
pub(crate) fn lengths(patterns: &[Pattern], flat: &[FlatCertificate]) -> Vec<Claim> {
    if flat.is_empty() {
        return Vec::new();
    }
    let mut out = FlatCertificate::of_parts(flat);
    if !out.iter().any(|c| c.what() == What::LengthError) {
        let measured = patterns.iter().map(|p| p.isometry_error).fold(0.0, f64::max);
        out.push(Claim::measured(What::LengthError, Subject::Whole, measured));
    }
    out
}

/// Parts whose drawings are not proven within the tolerance (mm), and parts without a proof of their map whose lengths are
/// measured to be wrong by more than it, as reasons.
pub(crate) fn refused(parts: &[Part], patterns: &[Pattern], flat: &[FlatCertificate], tolerance: f64) -> Vec<Reason> {
    let item = |f: &FlatCertificate| Item::Part(parts.get(f.panel()).map_or_else(String::new, |p| p.name.clone()));
    let stretched = |f: &FlatCertificate| {
        let own = patterns.iter().find(|p| p.panel == f.panel());
        let off = own.map_or(f64::NAN, |p| p.isometry_error * p.length);
        off.is_nan() || off > tolerance
    };
    let reason = |f: &FlatCertificate| match (f.reason(), f.open()) {
        (None, None) => None,
        (None, Some(open)) => stretched(f).then(|| Reason::of(item(f), open)),
        (Some(reason), _) => Some(Reason::of(item(f), reason)),
    };
    flat.iter().filter_map(reason).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::torse::form::PanelKind;

    #[test]
    fn a_ring_of_triangles_that_overlaps_is_cut_in_two() {
        // Eight flat-lying triangles of 60° about a common point: 480° in the plane.
        let x = |k: usize| {
            let a = (k as f64) * std::f64::consts::FRAC_PI_3;
            Vec3::new(100.0 * a.cos(), 100.0 * a.sin(), 0.0)
        };
        let strips: Vec<Strip> = (0..8)
            .map(|k| {
                let top = Vec3::zeros();
                Strip::quad(&format!("{k}"), PanelKind::Plane, [x(k), top], [x(k + 1), top]).expect("strip")
            })
            .collect();
        // In space the second round lies 50 mm higher, so that it is an overlap and no contact.
        let strips: Vec<Strip> = strips
            .into_iter()
            .enumerate()
            .map(|(k, mut s)| {
                for (i, c) in s.patch.control.iter_mut().enumerate() {
                    if i % 2 == 0 {
                        c[2] += 8.0 * (k + i / 2) as f64;
                    }
                }
                s
            })
            .collect();
        let whole = Part::new("fan", 0, 8);
        let (parts, patterns) = cut(&strips, &[whole], &StripOptions::new(0.01));
        assert_eq!((parts.len(), patterns.len()), (2, 2));
        assert!(parts.iter().all(|p| p.missing.is_none()) && parts[1].name == "fanb" && patterns[1].panel == 1);
    }

    #[test]
    fn rulings_asked_for_too_near_are_told_of() {
        let x = Vec3::new;
        let quad = [[x(0.0, 0.0, 0.0), x(0.0, 80.0, 0.0)], [x(100.0, 0.0, 0.0), x(100.0, 80.0, 0.0)]];
        let strips = [Strip::quad("A-01", PanelKind::Cylinder, quad[0], quad[1]).expect("strip")];
        let whole = Part::new("A", 0, 1);
        let asked = |ruling_spacing, mark_spacing| {
            let options = StripOptions { ruling_spacing, mark_spacing, ..StripOptions::new(0.01) };
            crowded(&cut(&strips, std::slice::from_ref(&whole), &options).1, &options)
        };
        assert!(asked(None, None).is_empty() && asked(Some(1.0), Some(0.0)).is_empty());
        let told = asked(Some(1e-6), Some(1.0));
        assert!(told.len() == 1 && told[0].lines == Lines::Rulings, "{told:?}");
        assert_eq!(asked(Some(1e-6), Some(1e-6)).len(), 2);
    }

    #[test]
    fn a_pattern_with_wrong_lengths_is_named() {
        let x = Vec3::new;
        let quad = [[x(0.0, 0.0, 0.0), x(0.0, 80.0, 0.0)], [x(100.0, 0.0, 0.0), x(100.0, 80.0, 0.0)]];
        let strips = [Strip::quad("A-01", PanelKind::Plane, quad[0], quad[1]).expect("strip")];
        let whole = Part::new("A", 0, 1);
        let (parts, mut patterns) = cut(&strips, &[whole], &StripOptions::new(0.01));
        let told = |patterns: &[Pattern]| {
            refused(&parts, patterns, &strip_parts(&strips, &parts, patterns, 1e-6, &Control::default()), 1e-6)
        };
        assert!(told(&patterns).is_empty(), "{:?}", told(&patterns));
        patterns[0].contours[0].vertices.iter_mut().for_each(|v| v.point.x *= 1.001);
        let told = told(&patterns);
        assert!(matches!(&told[..], [Reason::Of(Item::Part(name), _)] if name == "A"), "{told:?}");
    }
}
