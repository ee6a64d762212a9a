//! The sides of a sheet and its neutral surface in space, for CAD.

use super::options::WorkshopOptions;
use crate::answer::note::ShopNote;
use crate::answer::shop::{OffsetFile, OffsetSide};
use crate::answer::{Answer, Job};
use crate::brep::recognised_surface::{recognise, RecognisedSurface};
use crate::develop::shop::offsets::{offset, NoOffset, OffsetPanel};
use crate::develop::shop::thickness::Sheet;
use crate::develop::unfold::allowance::KFactor;
use crate::develop::view::{centre, sides};
use crate::geom::outward::outward as outside_of_sheet;
use crate::num::parallel;
use crate::patchwork::outside::outward;
use crate::patchwork::part::Part;
use crate::torse::strip::Strip;

/// The surfaces of the sheet that was asked for beside all panels, and what is to be told of them.
pub(super) fn offsets(answer: &Answer, options: &WorkshopOptions) -> (Vec<OffsetFile>, Vec<ShopNote>) {
    let Some(sheet) = options.sheet().filter(|_| options.offsets) else { return (Vec::new(), Vec::new()) };
    if answer.cones.is_some() {
        return (Vec::new(), vec![ShopNote::OffsetsOfCones]);
    }
    let mut files = OffsetSide::ALL.map(|side| OffsetFile { side, panels: Vec::new() });
    let (mut notes, mut left, mut varies) = (Vec::new(), Vec::new(), Vec::new());
    let outside = Outside::of(answer);
    for (k, part) in answer.parts.iter().enumerate() {
        let own = answer.sheets.get(k).map_or(0.0, |s| s.thickness);
        let Some(signs) = outside.signs(answer, k, part).filter(|_| own <= 0.0) else {
            left.push(part.name.clone());
            continue;
        };
        let [low, high] = sheet.extent();
        let neutral = neutral(answer, k, &sheet);
        if neutral.is_none() {
            varies.push(part.name.clone());
        }
        let wanted = [(0, Some(low)), (1, neutral), (2, Some(high))].into_iter().filter_map(|(f, d)| Some((f, d?)));
        let asked: Vec<(usize, f64, usize)> =
            wanted.flat_map(|(file, d)| (0..signs.len()).map(move |j| (file, d, j))).collect();
        let made: Vec<_> =
            parallel::map(asked.iter(), |&(file, d, j)| (file, one(answer, part.first + j, signs[j] * d)));
        for (file, found) in made {
            match found {
                Ok(panel) => files[file].panels.push(panel),
                Err((panel, none)) => notes.push(ShopNote::NoOffset { panel, side: files[file].side, none }),
            }
        }
    }
    let edge_error = files.iter().flat_map(|f| &f.panels).map(|p| p.edge_error).fold(0.0, f64::max);
    let files: Vec<OffsetFile> = files.into_iter().filter(|f| !f.panels.is_empty()).collect();
    if !files.is_empty() {
        notes.insert(0, ShopNote::Offsets { edge_error });
    }
    if !left.is_empty() {
        notes.push(ShopNote::NoOffsets { parts: left });
    }
    if !varies.is_empty() {
        notes.push(ShopNote::NeutralVaries { parts: varies });
    }
    (files, notes)
}

/// The offset of one panel, along the normal of its patch.
fn one(answer: &Answer, index: usize, distance: f64) -> Result<OffsetPanel, (String, NoOffset)> {
    let panel = &answer.patchwork.panels[index];
    let face = answer.patchwork.face_of(panel);
    // Panels of faces that are laid flat as they are, not of covers, lie on the surface of their face.
    let exact = face.filter(|_| answer.job == Job::Unroll).map(recognise).filter(RecognisedSurface::is_developable);
    let made = offset(panel, distance, exact.as_ref()).map_err(|none| (panel.strip.name.clone(), none))?;
    Ok(OffsetPanel { panel: index, reversed: face.is_some_and(|f| f.reversed), ..made })
}

/// Distance (mm) of the neutral surface from the panels of a part, outwards; `None` where it is not one number.
fn neutral(answer: &Answer, part: usize, sheet: &Sheet) -> Option<f64> {
    let pattern = answer.patterns.iter().position(|p| p.panel == part)?;
    let found = answer.shop.work.get(pattern)?.sheet?.neutral;
    let mut radii = answer.patterns[pattern].bends.iter().flat_map(|b| b.radii);
    let first = radii.next();
    let is_round = radii.all(|r| first.is_some_and(|f| (f - r).abs() <= SAME_RADIUS * f));
    let is_one = matches!(sheet.k, KFactor::Ansi(_)) || is_round || answer.job != Job::Unroll;
    Some(found).filter(|d| d.is_finite() && is_one)
}

/// Share by which radii of a circular cylinder differ by rounding.
const SAME_RADIUS: f64 = 1e-6;

/// Which side of panels is the outside of the model.
struct Outside {
    /// Of every face +1 if S_u × S_v looks there; empty where no part needs it.
    faces: Vec<f64>,
    strips: Vec<Strip>,
}

impl Outside {
    fn of(answer: &Answer) -> Self {
        let unfolded = |k: usize| answer.sheets.get(k).is_some_and(|s| !s.turned.is_empty());
        let needed = (0..answer.parts.len()).any(|k| !unfolded(k)) && !answer.patchwork.faces.is_empty();
        Self {
            faces: if needed { outward(&answer.patchwork) } else { Vec::new() },
            strips: if answer.patchwork.faces.is_empty() { answer.strips().cloned().collect() } else { Vec::new() },
        }
    }

    /// Of every panel of a part +1 if ∂u × ∂v of its patch looks out of the model, else −1; `None` where a face has no panel.
    fn signs(&self, answer: &Answer, number: usize, part: &Part) -> Option<Vec<f64>> {
        let panels = answer.patchwork.panels.get(part.first..part.first + part.count)?;
        let sign = |yes: bool| if yes { 1.0 } else { -1.0 };
        if let Some(turned) = answer.sheets.get(number).map(|s| &s.turned).filter(|t| !t.is_empty()) {
            // Faces that are unfolded look out as they were laid flat.
            let of = |panel: &crate::patchwork::panel::Panel| {
                let face = answer.patchwork.face_of(panel)?;
                Some(sign(!panel.mirrored()) * sign(!face.reversed))
            };
            return (turned.len() == panels.len()).then(|| panels.iter().map(of).collect())?;
        }
        if self.strips.is_empty() {
            let of = |panel: &crate::patchwork::panel::Panel| {
                Some(sign(!panel.mirrored()) * self.faces.get(panel.face()?).copied()?)
            };
            return panels.iter().map(of).collect();
        }
        // The sides of strips look along ∂v × ∂u.
        let all: Vec<_> = panels.iter().flat_map(|p| sides(&p.strip)).collect();
        Some(vec![-outside_of_sheet(&all, &centre(&self.strips)); panels.len()])
    }
}
