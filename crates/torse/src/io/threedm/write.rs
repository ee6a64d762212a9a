//! Writing archives of Rhino (version 6): shells of trimmed faces as polysurfaces, in millimetres.
//!
//! Every shell becomes one object with its name on the layer `Panels`. Numbers of splines are written bit for bit. The
//! writer neither checks nor repairs geometry.

mod body;
mod seams;
mod shell;
mod tables;
mod trims;

use self::body::Body;
use crate::io::step::write::{sewn, Header, Shell};
use crate::patchwork::panel::Patchwork;
use std::io;

/// Writes the panels of a patchwork, one object each, normals on the side of the input faces' normals. Names of panels that
/// `marked` holds for say that they must not be cut.
///
/// # Errors
/// As [`shells`].
pub fn panels(header: &Header, patchwork: &Patchwork, marked: &[bool]) -> io::Result<Vec<u8>> {
    shells(header, &sewn::shells(patchwork, marked))
}

/// Writes shells whose surfaces are splines or planes and whose edges are lines or splines.
///
/// # Errors
/// An edge or vertex number that is out of range, cylinders, cones and circles, and edges of spline surfaces without a
/// curve in the parameter plane that do not join corners of the surface ([`io::ErrorKind::InvalidInput`]).
pub fn shells(header: &Header, shells: &[Shell]) -> io::Result<Vec<u8>> {
    let mut objects = Vec::with_capacity(shells.len());
    for s in shells {
        let mut data = Body::default();
        shell::write(&mut data, s, header.uncertainty)?;
        objects.push((s.name.as_str(), data));
    }
    Ok(tables::archive(header, objects))
}

/// A shell with the seams that it is written with.
#[cfg(test)]
pub(crate) fn seams_of(s: &Shell) -> io::Result<Shell> {
    seams::joined(&seams::closed(s))
}
