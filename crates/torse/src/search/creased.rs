//! Faces with sharp edges of their own that no smooth panel can pass are covered as one face on each side.

use crate::brep::face::Face;
use crate::brep::trim::crease::{uncreased, Crease, Uncreased};

/// Least distance of a smooth curve from the corner of two chords that meet at an angle, as a share of that angle (rad) and of
/// the shorter chord: an arc touches both where they end and misses the corner by a quarter, to both sides by half of that.
const CORNER: f64 = 0.125;

/// The pieces of faces between those of their creases sharper than `angle` (rad) that panels within a tolerance (mm) cannot
/// pass. Profiles of many short chords stay whole.
pub(crate) fn between_sharp_creases(faces: Vec<Face>, angle: f64, tolerance: f64) -> Uncreased {
    let sharp = |_: &Face, c: &Crease| CORNER * c.turn * c.breadth_estimate > tolerance;
    uncreased(faces, angle, sharp)
}
