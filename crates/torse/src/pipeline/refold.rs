//! The job of `torse refold`: a result read back, bent back, and compared with the part in space; how far it is from
//! that is proven where it can be.

use super::part_atlas::{atlases, beside_panels, flat_part, panels, read_bound, refolded, PartAtlasError};
use crate::certify::claim::UpperBound;
use crate::control::Control;
use crate::develop::refold::atlas::Atlas;
use crate::develop::refold::compare::{best, compare, Comparison};
use crate::develop::refold::drawn::FlatPart;
use crate::develop::refold::leaf::Refolded;
use crate::io::result_folder::{read, FolderError, ResultPart};
use crate::num::parallel;
use crate::search::refolded::{distance_bounds, NotRefolded, PanelBound};
use answer::largest;

pub use answer::{PartAnswer, RefoldAnswer, FILES};

mod answer;

/// Bends all parts of a result back. `file` answers the bytes of its files by name; `tolerance` (mm, positive; default twice that of
/// the result) is within what they are to lie from their panels. Parts whose turn comes after the control said
/// stop are left out, and of those under way nothing more is proven.
///
/// # Errors
/// See [`FolderError`]; what concerns single parts stands in the answer.
///
/// # Example
/// ```
/// let bracket = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// let mut answer = torse::unroll(&bracket, &torse::UnrollOptions::new(0.1), &torse::Control::default())?;
/// let files = torse::files(&mut answer, "2026-01-31T12:00:00")?;
/// let file = |name: &str| files.iter().find(|f| f.0 == name).map(|f| f.1.clone());
/// let back = torse::pipeline::refold::refold(&file, None, &torse::Control::default())?;
/// assert_eq!((back.parts.len(), back.left.len()), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refold(
    file: &(dyn Fn(&str) -> Option<Vec<u8>> + Sync),
    tolerance: Option<f64>,
    control: &Control,
) -> Result<RefoldAnswer, FolderError> {
    let folder = read(file)?;
    let in_space = panels(file, folder.job, folder.report.tolerance);
    let made: Vec<_> = parallel::map(folder.parts.iter(), |p| {
        if control.stopped() {
            return Err((p.record.name.clone(), NotRefolded::Stopped.to_string()));
        }
        let flat = flat_part(p, true);
        let back = refolded(&flat).map_err(|e| (p.record.name.clone(), e.to_string()))?;
        let found = match &in_space {
            Ok(all) => atlases(&folder, all, p, &flat),
            Err(e) => Err(e.clone()),
        };
        let aim = AIM * folder.report.tolerance;
        let read = in_space.as_ref().map_or(Some(UpperBound::UNKNOWN), |all| read_bound(all, p, aim));
        Ok(answer(p, (flat, back), found, (read, control)))
    });
    let mut left = folder.left.clone();
    let mut parts = Vec::new();
    for m in made {
        m.map_or_else(|e| left.push(e), |p| parts.push(p));
    }
    let tolerance = tolerance.unwrap_or(TWICE * folder.report.tolerance);
    Ok(RefoldAnswer { tolerance, notes: folder.notes.clone(), folder, parts, left })
}

/// Tolerances of a result within which its parts are to lie by default: outlines may be drawn off by one, and what lies between bend lines
/// by another.
const TWICE: f64 = 2.0;
/// Share of a result's tolerance below which distances of trims are not told apart.
const AIM: f64 = 1e-4;

fn answer(
    part: &ResultPart,
    (flat, refolded): (FlatPart, Refolded),
    found: Result<Vec<Atlas>, PartAtlasError>,
    (read, control): (Option<UpperBound>, &Control),
) -> PartAnswer {
    let mut out = PartAnswer {
        name: part.record.name.clone(),
        compared: Err(NotRefolded::NoSample),
        printed: None,
        proven: Vec::new(),
        printed_proven: None,
        alignment: f64::NAN,
        beside: beside_panels(part),
        flat,
        refolded,
    };
    let all = match found {
        Err(e) => {
            out.compared = Err(NotRefolded::Panels(e.to_string()));
            return out;
        }
        Ok(all) => all,
    };
    let Some(atlas) = best(&out.flat, &out.refolded, &all) else { return out };
    let Some(c) = compare(&out.flat, &out.refolded, atlas) else { return out };
    let bounds = |flat: &FlatPart, back: &Refolded, c: &Comparison| -> Vec<(String, Result<UpperBound, NotRefolded>)> {
        let of = |p: PanelBound| {
            let found = p.found.map(|b| read.map_or(b, |read| b.plus(read)));
            (p.name, found.and_then(|b| if b.value().is_finite() { Ok(b) } else { Err(NotRefolded::NotExact) }))
        };
        distance_bounds(flat, back, (atlas, &c.motion), control).into_iter().map(of).collect()
    };
    let printed = flat_part(part, false);
    let back = super::part_atlas::refolded(&printed).ok();
    // Of most sheet metal the digits change nothing.
    let same = back.as_ref().is_some_and(|b| b.leaves == out.refolded.leaves);
    let from_digits = || {
        let back = back.filter(|_| !same)?;
        let c = compare(&printed, &back, atlas)?;
        Some((largest(&bounds(&printed, &back, &c)).ok(), c))
    };
    let (proven, digits) = parallel::join(|| bounds(&out.flat, &out.refolded, &c), from_digits);
    let digits = if same { Some((largest(&proven).ok(), c.clone())) } else { digits };
    (out.printed_proven, out.printed) = digits.map_or((None, None), |(bound, c)| (bound, Some(c)));
    (out.alignment, out.proven, out.compared) = (atlas.alignment, proven, Ok(c));
    out
}

#[cfg(test)]
mod tests;
