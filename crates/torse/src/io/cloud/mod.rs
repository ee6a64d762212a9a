//! Readers of measured points: PLY, CSV (and XYZ), OBJ, STL. The formats carry no unit: the caller gives it.

mod error;
mod obj;
pub mod ply;
mod stl;
mod table;
mod triple;

use crate::answer::note::reader::{ReaderNote, UnitNote};
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use crate::io::threedm;
pub use error::CloudReadError;

/// Points of a file, with the triangles of OBJ and STL files; the format is told by the ending of the name. `unit` is the
/// length of the file's unit in mm; where none is given, what the headings of a table say, else mm.
///
/// # Errors
/// See [`CloudReadError`].
///
/// # Example
/// ```
/// let scan = torse::io::cloud::read("scan.xyz", b"0 0 0\n1 0 0\n1 1 0.5\n", Some(1000.0))?;
/// assert_eq!((scan.points.len(), scan.points[2].z), (3, 500.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(name: &str, bytes: &[u8], unit: Option<f64>) -> Result<Cloud, CloudReadError> {
    read_noted(name, bytes, unit).map(|(cloud, _)| cloud)
}

/// As [`read`], with a note where neither the file nor the caller says a unit.
///
/// # Errors
/// See [`CloudReadError`].
pub fn read_noted(name: &str, bytes: &[u8], unit: Option<f64>) -> Result<(Cloud, Option<ReaderNote>), CloudReadError> {
    let mut guessed = unit.is_none();
    let ending = name.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
    if threedm::recognises(bytes) || ending == "3dm" {
        // The file says its unit, or that it has none.
        let found = threedm::meshes::read(bytes)?;
        let note = found.assumes_unit.then(|| unit_note(name));
        return Ok((found.into_cloud(), note));
    }
    let only = |points: Vec<Vec3>| Cloud { points, ..Cloud::default() };
    let mut cloud = match ending.as_str() {
        "ply" => only(ply::points(bytes)?),
        "csv" | "xyz" | "txt" | "asc" | "pts" => {
            let (points, is_guess) = table::points(bytes, unit, ending == "pts")?;
            guessed = is_guess;
            only(points)
        }
        "obj" => obj::cloud(bytes)?,
        "stl" => stl::cloud(bytes)?,
        _ => return Err(CloudReadError::Kind(name.to_string())),
    };
    if cloud.points.is_empty() {
        return Err(CloudReadError::Empty);
    }
    // Tables know their units themselves.
    let unit = if ["ply", "obj", "stl"].contains(&ending.as_str()) { unit.unwrap_or(1.0) } else { 1.0 };
    for (index, p) in cloud.points.iter_mut().enumerate() {
        *p *= unit;
        if !p.iter().all(|x| x.is_finite()) {
            return Err(CloudReadError::NotFinite { index });
        }
    }
    Ok((cloud, guessed.then(|| unit_note(name))))
}

/// What is said where a unit had to be guessed.
pub(super) fn unit_note(name: &str) -> ReaderNote {
    ReaderNote::Unit(UnitNote::Guessed { file: name.into() })
}

#[cfg(test)]
mod tests;
