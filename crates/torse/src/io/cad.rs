//! CAD files of any format that is read: STEP, IGES, 3DM. The kind is found by what a file holds, not by its name.

use super::model::{Model, ReadOptions};
use super::{iges, step, threedm};

/// Formats of CAD files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// ISO 10303-21.
    Step,
    /// IGES.
    Iges,
    /// Rhino archives.
    ThreeDm,
}

/// Why nothing could be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// Of a STEP file, or of a file that is none of these.
    #[error(transparent)]
    Step(#[from] step::read::ReadError),
    /// Of an IGES file.
    #[error(transparent)]
    Iges(#[from] iges::read::ReadError),
    /// Of a Rhino archive.
    #[error(transparent)]
    ThreeDm(#[from] threedm::ReadError),
}

/// The format of a file, by its first bytes; STEP where it is nothing else.
pub(crate) fn format(bytes: &[u8]) -> Format {
    recognised(bytes).unwrap_or(Format::Step)
}

/// The format of a CAD file, by its first bytes; `None` for files that say nothing of it.
///
/// # Example
/// ```
/// use torse::io::cad::{recognised, Format};
/// assert_eq!(recognised(b"ISO-10303-21;\nHEADER;"), Some(Format::Step));
/// assert_eq!(recognised(b"x,y,z\n0,0,0\n"), None);
/// ```
pub fn recognised(bytes: &[u8]) -> Option<Format> {
    if threedm::recognises(bytes) {
        Some(Format::ThreeDm)
    } else if iges::read::recognises(bytes) {
        Some(Format::Iges)
    } else {
        step::read::recognises(bytes).then_some(Format::Step)
    }
}

/// Reads a CAD file with default options.
///
/// # Errors
/// See [`ReadError`]: only where no face at all can be used.
///
/// # Example
/// ```
/// let model = torse::read(include_bytes!("../../../../data/cone_holes.step"))?;
/// assert_eq!((model.faces.len(), model.unit.as_str()), (1, "millimetre"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(bytes: &[u8]) -> Result<Model, ReadError> {
    read_with(bytes, &ReadOptions::default())
}

/// Reads a CAD file.
///
/// # Errors
/// As [`read`].
pub fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<Model, ReadError> {
    Ok(match format(bytes) {
        Format::Step => step::read::read_with(bytes, options)?,
        Format::Iges => iges::read::read_with(bytes, options)?,
        Format::ThreeDm => threedm::read_with(bytes, options)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_their_first_bytes() {
        assert_eq!(format(b"ISO-10303-21;\nHEADER;"), Format::Step);
        assert_eq!(format(b"3D Geometry File Format       70"), Format::ThreeDm);
        let line = format!("{:72}S{:7}\n", "a hull", 1);
        assert_eq!(format(line.as_bytes()), Format::Iges);
        assert_eq!(format(b""), Format::Step);
    }
}
