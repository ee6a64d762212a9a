//! Writing archives of Rhino (version 6): sheets of trimmed faces as polysurfaces, in millimetres.
//!
//! Every sheet becomes one object with its name on the layer `Panels`. Numbers of splines are written bit for bit. The
//! writer neither checks nor repairs geometry.

mod body;
mod seams;
mod sheet;
mod tables;
mod trims;

use self::body::Body;
use crate::io::step::write::{sewn, Header, Sheet};
use crate::patchwork::panel::Patchwork;
use std::io;

/// Writes the panels of a patchwork, one object each, normals on the side of the input faces' normals. Names of panels that
/// `marked` holds for say that they must not be cut.
///
/// # Errors
/// As [`sheets`].
pub fn panels(header: &Header, patchwork: &Patchwork, marked: &[bool]) -> io::Result<Vec<u8>> {
    sheets(header, &sewn::sheets(patchwork, marked))
}

/// Writes sheets whose surfaces are splines or planes and whose edges are lines or splines.
///
/// # Errors
/// An edge or vertex number that is out of range, cylinders, cones and circles, and edges of spline surfaces without a
/// curve in the parameter plane that do not join corners of the surface ([`io::ErrorKind::InvalidInput`]).
pub fn sheets(header: &Header, sheets: &[Sheet]) -> io::Result<Vec<u8>> {
    let mut objects = Vec::with_capacity(sheets.len());
    for s in sheets {
        let mut data = Body::default();
        sheet::write(&mut data, s, header.uncertainty)?;
        objects.push((s.name.as_str(), data));
    }
    Ok(tables::archive(header, objects))
}

/// A sheet with the seams that it is written with.
#[cfg(test)]
pub(crate) fn seams_of(s: &Sheet) -> io::Result<Sheet> {
    seams::joined(&seams::closed(s))
}
