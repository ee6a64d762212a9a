//! Where the neutral fibre, which is drawn of sheets, lies below the panels of a part (docs/algorithms/refold.md, "Sheet metal").

use super::error::PartAtlasError;
use crate::develop::shop::thickness::SheetSide;
use crate::develop::unfold::allowance::{Fibre, KFactor};
use crate::develop::unfold::bends::BendKind;
use crate::io::json::NeutralRecord;
use crate::io::result_folder::{ResultPart, TableBend};
use crate::patchwork::pattern::{Bend, BendSense, ViewSide};

/// Where the fibre lies below the panels, as the drawing is seen; `None` where these are drawn themselves, or nobody knows. It is at one
/// distance from panels that the shop was given a sheet for, in either bend, and as K says below the faces that are unfolded.
pub(super) fn fibre(part: &ResultPart) -> Option<Fibre> {
    let Some(sheet) = &part.record.neutral else {
        let out = moved(part)?;
        return Some(Fibre::fixed(if part.view == Some(ViewSide::Inside) { out } else { -out }));
    };
    let thickness = greatest(sheet);
    let above = sheet.sheet_side().ok()?.map_or(0.0, |side| side.extent(thickness)[1]);
    Some(Fibre { k: sheet.k.factor()?, thickness, above })
}

/// How far (mm) outwards from its panels a pattern was moved that was not unfolded as a neutral fibre; `None` where it was not.
pub(super) fn moved(part: &ResultPart) -> Option<f64> {
    part.record.neutral_offset.filter(|d| *d != 0.0 && part.record.neutral.is_none())
}

/// Thickness (mm) of the sheet whose neutral fibre was unfolded; 0 for others.
pub(super) fn thickness(part: &ResultPart) -> f64 {
    part.record.neutral.as_ref().map_or(0.0, greatest)
}

/// Greatest thickness (mm) of a sheet.
fn greatest(sheet: &NeutralRecord) -> f64 {
    sheet.thickness.iter().copied().fold(0.0, f64::max)
}

/// Whether the panels of a part are surfaces that were given a sheet, so that the radii of its bend lines are theirs.
fn is_given(part: &ResultPart) -> bool {
    moved(part).is_some() || part.record.neutral.as_ref().is_some_and(|n| n.side.is_some())
}

/// What a line says of the fibre that is drawn, where it says it of the surface that was given the sheet. Of folds, and of bends of one
/// radius, the table is right.
pub(super) fn on_fibre(part: &ResultPart, line: usize, bend: Bend, fibre: Option<&Fibre>) -> Bend {
    let row = part.bends.iter().find(|b| b.lines.contains(&line));
    let Some(fibre) = fibre.filter(|_| is_given(part) && row.is_none_or(|b| !b.allowance.is_finite())) else {
        return bend;
    };
    let hollow = bend.sense == BendSense::Up;
    let of = |radii: [f64; 2]| {
        let depth = fibre.depth(0.5 * (radii[0] + radii[1]), hollow);
        let below = if hollow { depth } else { -depth };
        radii.map(|r| if radii == [0.0; 2] { r } else { (r + below).max(0.0) })
    };
    Bend { radii: of(bend.radii), before: of(bend.before), ..bend }
}

/// How far (mm) the neutral fibre, which is drawn, lies at most from panels that were given a sheet; 0 for others.
pub(crate) fn beside_panels(part: &ResultPart) -> f64 {
    let Some(fibre) = fibre(part).filter(|_| is_given(part)) else { return 0.0 };
    if let Some(out) = moved(part) {
        return out.abs();
    }
    // Sharp edges have no fibre.
    let bent = part.bends.iter().filter(|b| b.kind != BendKind::Fold);
    let off = |b: &TableBend| {
        let share = if b.sense == BendSense::Up { b.k } else { 1.0 - b.k };
        (share * fibre.thickness - fibre.above).abs()
    };
    bent.map(off).filter(|d| d.is_finite()).fold(0.0, f64::max)
}

/// Thickness (mm) at every panel of a part, zero for surfaces, and the side of the sheet that the panels are where they were given one.
pub(super) type SheetOfPanels = (Vec<f64>, Option<SheetSide>);

/// K-factor and sheet of a part of so many panels.
///
/// # Errors
/// A report that does not say them.
pub(super) fn neutral(part: &ResultPart, panels: usize) -> Result<(KFactor, SheetOfPanels), PartAtlasError> {
    let Some(neutral) = &part.record.neutral else {
        let silent = part.bends.iter().any(|b| b.k > 0.0);
        let told = || (KFactor::default(), (vec![0.0; panels], None));
        return if silent { Err(PartAtlasError::Neutral) } else { Ok(told()) };
    };
    let k = neutral.k.factor().filter(|_| neutral.thickness.len() == panels).ok_or(PartAtlasError::Neutral)?;
    let side = neutral.sheet_side().map_err(|_| PartAtlasError::Neutral)?;
    Ok((k, (neutral.thickness.clone(), side)))
}
