//! Drawings written in stretches: files of many parts are long.

use std::io;

/// Hands over what there is so far; `finite` says whether all its coordinates were.
///
/// # Errors
/// A coordinate that is not a finite number ([`io::ErrorKind::InvalidData`]), and those of `out`.
pub(super) fn flush(text: &mut String, finite: bool, out: &mut dyn io::Write) -> io::Result<()> {
    if !finite {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a coordinate of a pattern is not a finite number"));
    }
    out.write_all(text.as_bytes())?;
    text.clear();
    Ok(())
}
