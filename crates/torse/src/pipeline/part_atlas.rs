//! Parts of a result with their panels in space and their flat patterns: what refolding and carrying artwork begin with.

mod error;
mod fibre;
mod strips;

pub use error::PartAtlasError;
pub(crate) use fibre::beside_panels;

use crate::answer::Job;
use crate::brep::face::Face;
use crate::certify::claim::UpperBound;
use crate::certify::trims::trim_proof;
use crate::develop::refold::atlas::{of_face, Atlas, AtlasError, PanelPatch};
use crate::develop::refold::drawn::{chord_height, polygon, BendLine, FlatPart, SheetRow, ROUNDED};
use crate::develop::refold::leaf::Refolded;
use crate::develop::refold::{one_family, sheet, RefoldError};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::bends::BendKind;
use crate::geom::Vec2;
use crate::io::bundle::{CONES, PANELS};
use crate::io::model::ReadOptions;
use crate::io::result_folder::{ResultFolder, ResultPart, TableBend, TableLine};
use crate::io::step::read as step;
use crate::torse::form::PanelKind;
use fibre::{fibre, moved, neutral, on_fibre, thickness, SheetOfPanels};
use std::collections::HashMap;
use strips::{panel_of, plain};

/// The part as its drawing and its table have it: `exact` takes the unrounded numbers of the report where they are there.
pub(crate) fn flat_part(part: &ResultPart, exact: bool) -> FlatPart {
    let joints: Vec<Vec<_>> = part.contours.iter().map(|c| c.iter().map(|j| j.0).collect()).collect();
    let size = FlatPart { loops: joints.clone(), ..FlatPart::default() }.size();
    let outline = FlatPart {
        loops: part.contours.iter().map(|c| polygon(c, size)).collect(),
        chords: part.contours.iter().map(|c| chord_height(c, size)).fold(0.0, f64::max),
        joints,
        printed: part.printed,
        ..FlatPart::default()
    };
    // What ends in a corner ends in it to the bit: rulings that meet there would cross beside it where a drawing is rounded.
    let settled = |ends: &[Vec2; 2]| ends.map(|q| outline.joint_meant(&q, ROUNDED).unwrap_or(q));
    let numbers = part.exact.as_ref().filter(|_| exact);
    let fibre = fibre(part);
    let line = |(k, (ends, row)): (usize, &([_; 2], TableLine))| BendLine {
        ends: settled(ends),
        bend: on_fibre(part, k, numbers.map_or(row.bend, |n| n[k]), fibre.as_ref()),
    };
    let bend = |b: &TableBend| SheetRow {
        lines: b.lines.clone(),
        rolled: b.kind == BendKind::Rolled,
        sense: b.sense,
        angle: b.angle,
        inside_radius: b.inside_radius,
        allowance: b.allowance,
        k: if b.k.is_finite() { b.k } else { 0.0 },
    };
    // Sheet metal has its lines from edge to edge, panels a little less.
    let inset = if part.bends.is_empty() { part.record.contour_error.unwrap_or(0.0) } else { 0.0 };
    let (lines, extents) =
        (part.lines.iter().enumerate().map(line).collect(), part.extents.iter().map(settled).collect());
    FlatPart {
        lines,
        bends: part.bends.iter().map(bend).collect(),
        extents,
        inset,
        thickness: thickness(part),
        local: part.record.neutral.as_ref().map_or_else(Vec::new, |n| n.thickness.clone()),
        fibre,
        ..outline
    }
}

/// Share of their extent within which lines of one bend are one line: half of what a fold is off one that is drawn as a curve.
const ONE_LINE: f64 = 1e-5;

/// Whether the lines of a bend lie in one line.
fn is_straight(part: &FlatPart, bend: &SheetRow) -> bool {
    let lines = part.lines.get(bend.lines.clone()).unwrap_or_default();
    let (Some(first), Some(last)) = (lines.first(), lines.last()) else { return true };
    let whole = last.ends[1] - first.ends[0];
    let Some(way) = whole.try_normalize(0.0) else { return lines.len() < 2 };
    let off = |p: &Vec2| way.perp(&(p - first.ends[0])).abs();
    lines.iter().flat_map(|l| &l.ends).map(off).fold(0.0, f64::max) <= (ONE_LINE * whole.norm()).max(part.printed)
}

/// Bends a part back from its drawing and tables alone.
///
/// # Errors
/// See [`RefoldError`].
pub fn refolded(part: &FlatPart) -> Result<Refolded, RefoldError> {
    let varies = |b: &&SheetRow| b.rolled && !b.allowance.is_finite();
    if let Some(row) = part.bends.iter().find(varies).filter(|_| part.thickness > 0.0 && part.fibre.is_none()) {
        return Err(RefoldError::Neutral { line: row.lines.start + 1 });
    }
    let curved = |b: &&SheetRow| !b.rolled && !is_straight(part, b);
    if let Some(row) = part.bends.iter().find(curved) {
        return Err(RefoldError::Curve { line: row.lines.start + 1 });
    }
    // One rolled face without others beside it is one family of rulings, whichever ways it is bent.
    if part.bends.is_empty() || part.extents.is_empty() && part.bends.iter().all(|b| varies(&b)) {
        return one_family::refold(part);
    }
    sheet::refold(part)
}

/// The panels of a result by name.
pub enum Panels {
    /// Faces with trims.
    Faces(HashMap<String, Face>),
    /// Untrimmed strips.
    Strips(HashMap<String, PanelPatch>),
}

/// Share of a result's tolerance that chords of the trims of its panels may keep from these at the places where readers look: the
/// distance that is proven counts them twice, and what is between these places.
const CHORDS: f64 = 0.02;

/// Reads the panels of a result, with its tolerance (mm).
///
/// # Errors
/// A file that is missing or cannot be read.
pub fn panels(file: &dyn Fn(&str) -> Option<Vec<u8>>, job: Job, tolerance: f64) -> Result<Panels, PartAtlasError> {
    let name = if job == Job::Cones { CONES } else { PANELS };
    let bytes = file(name).ok_or(PartAtlasError::NoFile(name))?;
    let fault = |reason: String| PartAtlasError::File { file: name, reason };
    // Of a fit either all strips are trimmed or none.
    let trimmed = job == Job::Fit && step::own::faces(&bytes).is_ok();
    if trimmed || matches!(job, Job::Approximate | Job::Unroll | Job::Cones) {
        let options = ReadOptions { chord_tolerance: Some(CHORDS * tolerance) };
        let model = step::read_with(&bytes, &options).map_err(|e| fault(e.to_string()))?;
        let name = |f: &Face| if job == Job::Cones { of_chain(plain(&f.name)) } else { plain(&f.name) };
        let named = model.faces.into_iter().map(|f| (name(&f), f));
        return Ok(Panels::Faces(named.collect()));
    }
    let strips = step::own::strips(&bytes).map_err(fault)?;
    let named = strips.iter().map(|s| panel_of(s).map(|p| (plain(&s.name), p)));
    named.collect::<Result<_, String>>().map(Panels::Strips).map_err(fault)
}

/// Bound (mm) of the distance between the panels of a part as their file has them and as they are compared; `aim` (mm) is
/// fine enough. `None` for strips, which are bounded by lines of their parameters and compared as they are.
pub(crate) fn read_bound(panels: &Panels, part: &ResultPart, aim: f64) -> Option<UpperBound> {
    match panels {
        Panels::Strips(_) => None,
        Panels::Faces(all) => Some(UpperBound::largest(part.record.panels.iter().map(|name| match all.get(name) {
            Some(face) => trim_proof(face, aim).bound(),
            None => UpperBound::UNKNOWN,
        }))),
    }
}

/// The name of a panel without its kind, which the faces of chains of cones have behind it.
fn of_chain(name: String) -> String {
    let is_kind =
        |word: &str| [PanelKind::Cone, PanelKind::Cylinder, PanelKind::Plane].iter().any(|k| k.name() == word);
    match name.rsplit_once(' ') {
        Some((panel, kind)) if is_kind(kind) => panel.to_owned(),
        _ => name,
    }
}

/// Share of the tolerance by which drawings may differ from the panels laid flat, and what the digits of a drawing leave open
/// at least, mm: where nothing was changed both fall together.
const ALIGNED: f64 = 0.1;
/// See [`ALIGNED`].
const PRINTED: f64 = 1e-3;

/// The panels of a part laid onto its outline in all ways that fit, the best first.
///
/// # Errors
/// Panels that are missing or cannot be laid flat, outlines that differ.
pub(crate) fn atlases(
    folder: &ResultFolder,
    panels: &Panels,
    part: &ResultPart,
    flat: &FlatPart,
) -> Result<Vec<Atlas>, PartAtlasError> {
    let missing = |name: &String| PartAtlasError::NoPanel(name.clone());
    // Drawn is the neutral fibre of the sheet, on either side of the panels; the outline tells on which.
    let developed = |own: Vec<PanelPatch>| {
        let beside = part.record.neutral_offset.unwrap_or(0.0);
        let sides = if beside == 0.0 { &[1.0][..] } else { &[1.0, -1.0] };
        let all = sides.iter().map(|side| Atlas::developed(own.clone(), side * beside)?.aligned(flat));
        let better = |a: &Result<Vec<Atlas>, AtlasError>| a.as_ref().map_or(f64::INFINITY, |a| a[0].alignment);
        all.min_by(|a, b| better(a).total_cmp(&better(b))).unwrap_or(Err(AtlasError::Empty))
    };
    let chain = |own: &[Face]| developed(own.iter().map(of_face).collect());
    let unfolded = |own: &[Face], k: &KFactor, sheet: SheetOfPanels| {
        Atlas::unfolded(own, k, sheet, folder.report.tolerance).and_then(|a| a.aligned(flat))
    };
    let found = match panels {
        Panels::Strips(all) => {
            let own: Result<Vec<PanelPatch>, PartAtlasError> =
                part.record.panels.iter().map(|n| all.get(n).cloned().ok_or_else(|| missing(n))).collect();
            developed(own?)
        }
        Panels::Faces(all) => {
            let own: Result<Vec<Face>, PartAtlasError> =
                part.record.panels.iter().map(|n| all.get(n).cloned().ok_or_else(|| missing(n))).collect();
            let own = own?;
            match folder.job {
                Job::Approximate | Job::Fit => chain(&own),
                // Laid flat through a panel, and moved.
                Job::Unroll if moved(part).is_some() => chain(&own),
                // One after the other; a pipe is cut open where the chain begins.
                Job::Cones => {
                    chain(&own).or_else(|_| unfolded(&own, &KFactor::default(), (vec![0.0; own.len()], None)))
                }
                _ => {
                    let (k, sheet) = neutral(part, own.len())?;
                    unfolded(&own, &k, sheet)
                }
            }
        }
    };
    let found = found?;
    let off = found.iter().map(|a| a.alignment).fold(f64::INFINITY, f64::min);
    if off > (ALIGNED * folder.report.tolerance).max(PRINTED) {
        return Err(AtlasError::Differs(off).into());
    }
    Ok(found)
}
