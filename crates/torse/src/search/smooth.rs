//! Faces that go on smoothly, joined where one cover of both is better than two.
//!
//! *Method*. Faces are joined as `brep::join` says \[R89\]; the cover's own estimates decide whether they should be.

use super::cover::{is_developable, is_smoothly_developable, strip_range};
use crate::brep::face::Face;
use crate::brep::join::{joined, JoinOptions};
use crate::control::Control;
use std::time::Instant;

/// Share of the tolerance by which control points of two faces may differ along an edge across which they are joined;
/// what is used of it is taken from the tolerance of the panels.
const MISMATCH_SHARE: f64 = 0.01;
/// Angle through which the normal of a joined face may turn along its parameter lines: half a tube with something to
/// spare, not a whole tube, whose level functions would have to close.
const MOST_TURN_DEG: f64 = 200.0;

/// Share of a limited time after which no more faces are joined: each can be covered for itself.
const JOIN_SHARE: f64 = 0.15;

/// Faces that go on smoothly within an angle (rad) as one, as exactly as a tolerance (mm) asks for; where time is limited, those
/// that were found soon.
pub(crate) fn smoothly_joined(faces: Vec<Face>, tolerance: f64, angle: f64, control: &Control) -> Vec<Face> {
    let control = match control.remaining() {
        Some(left) => control.clone().until(Instant::now() + left.mul_f64(JOIN_SHARE)),
        None => control.clone(),
    };
    let options = JoinOptions { angle, mismatch: tolerance * MISMATCH_SHARE, turn: MOST_TURN_DEG.to_radians() };
    joined(faces, &options, &|whole, a, b| {
        if control.stopped() {
            return false;
        }
        // What is developable already keeps its edges and stays exact, unless both together are one smooth developable.
        if is_developable(a, tolerance) || is_developable(b, tolerance) {
            return is_smoothly_developable(whole, tolerance);
        }
        // Strips of one level function across both, or at least no such strips given up.
        match (strip_range(whole), strip_range(a), strip_range(b)) {
            (Some(whole), Some(a), Some(b)) => whole <= a + b,
            (Some(_), _, _) | (None, None, None) => true,
            (None, _, _) => false,
        }
    })
}
