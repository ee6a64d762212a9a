//! Readers of measured points: PLY, CSV (and XYZ), OBJ, STL. The formats carry no unit: the caller gives it.

mod obj;
pub mod ply;
mod stl;
mod table;

use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use crate::io::threedm;

/// Why a file of points cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CloudReadError {
    /// A 3DM file without meshes, or none at all.
    #[error(transparent)]
    ThreeDm(#[from] threedm::ReadError),
    /// The ending of the name is not known.
    #[error("'{0}' is no known kind of point file: give .ply, .csv, .xyz, .txt, .obj, .stl or .3dm")]
    Kind(String),
    /// A drawing whose unit is not known, or not that which is given.
    #[error("{0}")]
    Drawing(String),
    /// Not what the ending says.
    #[error("not a {format} file: {reason}")]
    Format {
        /// Name of the format.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A line that cannot be read.
    #[error("{format} line {line}: {reason}")]
    Line {
        /// Name of the format.
        format: &'static str,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// The data end too early.
    #[error("the {format} file ends after {read} of {promised} {what}: it was cut off")]
    Short {
        /// Name of the format.
        format: &'static str,
        /// Things read.
        read: usize,
        /// Things promised by the header.
        promised: usize,
        /// What they are.
        what: &'static str,
    },
    /// A coordinate that is not finite.
    #[error("point {index} has a coordinate that is not a finite number; remove it")]
    NotFinite {
        /// Index of the point.
        index: usize,
    },
    /// No points.
    #[error("the file holds no points")]
    Empty,
}

/// Points of a file, with the triangles of OBJ and STL files; the format is told by the ending of the name. `unit` is the
/// length of the file's unit in mm; where none is given, what the headings of a table say, else mm.
///
/// # Errors
/// See [`CloudReadError`].
pub fn read(name: &str, bytes: &[u8], unit: Option<f64>) -> Result<Cloud, CloudReadError> {
    read_noted(name, bytes, unit).map(|(cloud, _)| cloud)
}

/// As [`read`], with a note where neither the file nor the caller says a unit.
///
/// # Errors
/// See [`CloudReadError`].
pub fn read_noted(name: &str, bytes: &[u8], unit: Option<f64>) -> Result<(Cloud, Option<String>), CloudReadError> {
    let mut guessed = unit.is_none();
    let ending = name.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
    if ending == "3dm" {
        // The file says its unit, or that it has none.
        let found = threedm::meshes::cloud(bytes)?;
        return Ok((found.cloud, found.assumes_unit.then(|| unit_note(name))));
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
pub(super) fn unit_note(name: &str) -> String {
    format!("{name} does not say its unit: its numbers were taken as mm; --unit says what they are")
}

/// Three numbers of a line.
fn triple<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<Vec3> {
    let mut next = || words.next()?.trim().parse::<f64>().ok();
    Some(Vec3::new(next()?, next()?, next()?))
}

#[cfg(test)]
mod tests;
