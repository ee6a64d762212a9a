//! The job of `torse map`: points and curves carried between parts in space and their flat patterns.

use super::part_atlas::{atlases, flat_part, panels, refolded, PartAtlasError};
pub(crate) use crate::develop::refold::artwork::MapPart;
pub use crate::develop::refold::artwork::{
    ArtworkMap, Carried, Item, Off, Placed, PlacedShape, Shape, Side, Style, Words,
};
use crate::develop::refold::compare::best;
use crate::io::result_folder::{read, FolderError};
use crate::num::parallel;

/// Distance (mm) that polylines keep from the images of curves where none is given: that of drawings of `torse unroll`.
const CHORD: f64 = 0.01;

/// Why nothing can be carried over.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// The folder.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The file of panels.
    #[error(transparent)]
    Panels(PartAtlasError),
    /// No such part.
    #[error("there is no part '{name}'; the result has {known}")]
    Part {
        /// Name asked for.
        name: String,
        /// Names that there are.
        known: String,
    },
    /// No part can be used.
    #[error("no part can be used; the first, {0}")]
    Nothing(String),
}

/// Reads a result. `part` takes one part only; `within` (mm) is how far from a part points may be, by default the tolerance
/// of the result.
///
/// # Errors
/// See [`MapError`].
///
/// # Example
/// ```
/// let bracket = torse::read(include_bytes!("../../../../data/bracket.step"))?;
/// let mut answer = torse::unroll(&bracket, &torse::UnrollOptions::new(0.1), &torse::Control::default())?;
/// let files = torse::files(&mut answer, "2026-01-31T12:00:00")?;
/// let file = |name: &str| files.iter().find(|f| f.0 == name).map(|f| f.1.clone());
/// let map = torse::pipeline::map_artwork::read_map(&file, None, None)?;
/// assert_eq!((map.parts.len(), map.within), (1, 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_map(
    file: &(dyn Fn(&str) -> Option<Vec<u8>> + Sync),
    part: Option<&str>,
    within: Option<f64>,
) -> Result<ArtworkMap, MapError> {
    let folder = read(file)?;
    if let Some(name) = part {
        if !folder.report.parts.iter().any(|p| p.name == name) {
            let known = folder.report.parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
            return Err(MapError::Part { name: name.into(), known });
        }
    }
    let all = panels(file, folder.job, folder.report.tolerance).map_err(MapError::Panels)?;
    let made: Vec<Result<MapPart, (String, String)>> =
        parallel::map(folder.parts.iter().filter(|p| part.is_none_or(|name| p.record.name == name)), |p| {
            let named = |e: String| (p.record.name.clone(), e);
            let flat = flat_part(p, true);
            flat.check_slits().map_err(|e| named(e.to_string()))?;
            let found = atlases(&folder, &all, p, &flat).map_err(|e| named(e.to_string()))?;
            // Of ways that fit alike the bends tell the right one.
            let chosen = match (found.len(), refolded(&flat)) {
                (2.., Ok(back)) => best(&flat, &back, &found),
                _ => found.first(),
            };
            let atlas = chosen.or(found.first()).cloned().ok_or_else(|| named("it has no panels".into()))?;
            Ok(MapPart::new(p.record.name.clone(), flat, atlas))
        });
    let wanted = |l: &&(String, String)| part.is_none_or(|name| l.0 == name);
    let mut left: Vec<(String, String)> = folder.left.iter().filter(wanted).cloned().collect();
    let mut parts = Vec::new();
    for m in made {
        match m {
            Ok(p) => parts.push(p),
            Err(e) => left.push(e),
        }
    }
    if parts.is_empty() {
        let first = left.first().map_or_else(String::new, |l| format!("{}: {}", l.0, l.1));
        return Err(MapError::Nothing(first));
    }
    Ok(ArtworkMap::new(parts, left, within.unwrap_or(folder.report.tolerance), CHORD))
}
