//! Faces that run to the very tip of a cone end a hair before it: there they have no tangent plane, sheet cannot be bent to it, and
//! files have no edge without length. What is missing is proven and counts as what trims miss.

use crate::brep::carrier::bounds;
use crate::brep::face::{Face, TrimLoop};
use crate::brep::rulings::Rulings;
use crate::certify::parameters_moved;
use rayon::prelude::*;
use std::sync::Arc;

/// Length of the hair, as a share of the rulings and of the tolerance, of which it takes the less.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hair {
    pub rulings: f64,
    pub tolerance: f64,
}

impl Hair {
    /// Nothing that anybody sees. With less the torse through a shallow cone has no room beside its tip, with more what is proven of
    /// flat parts that are bent back suffers.
    pub const FINE: Self = Self { rulings: 2e-5, tolerance: 0.08 };
    /// For what is to be written as exact cones, whose proof loses accuracy beside the tip.
    pub const OF_CONES: Self = Self { rulings: 1e-3, tolerance: 0.2 };
}

/// Least radius of curvature where the face ends, as a share of the tolerance: ways between trims of a coarse tolerance would
/// else turn around the tip.
const ROOM: f64 = 1.0 / 250.0;
/// The same, as a share of the largest coordinate: patches are written with as many digits, and beside the tip their control points
/// are a hundredth of that radius apart.
const DIGITS: f64 = 2e-8;
/// Share of the tolerance within which lines are rulings.
const SLACK: f64 = 0.05;

/// Faces that end beside their apexes, if they have any; tolerance in mm.
pub(crate) fn beside_apexes(faces: Vec<Face>, hair: Hair, tolerance: f64) -> Vec<Face> {
    faces.into_par_iter().map(|f| beside_apex(&f, hair, tolerance).unwrap_or(f)).collect()
}

/// A face without the tip where all its rulings meet; `None` where they do not.
fn beside_apex(face: &Face, hair: Hair, tolerance: f64) -> Option<Face> {
    let rulings = Rulings::of(&face.surface, bounds(face), SLACK * tolerance)?;
    let (lo, hi) = rulings.reach();
    let (a, b) = rulings.range();
    let length = rulings.line(0.5 * (a + b))?.length;
    let tip = match rulings.meet() {
        [true, false] => 0,
        [false, true] => 1,
        _ => return None,
    };
    let bbox = face.surface.bbox();
    let reach = bbox.min.amax().max(bbox.max.amax());
    let room = (ROOM * tolerance).max(DIGITS * reach) / rulings.least_radius_estimate(1 - tip)?;
    let hair = hair.rulings.max(room).min(hair.tolerance * tolerance / length) * (hi - lo);
    let (from, to) = if tip == 0 { (lo + hair, hi) } else { (lo, hi - hair) };
    let along = usize::from(!rulings.is_swapped());
    let mut out = face.clone();
    for p in out.loops.iter_mut().flat_map(|l| &mut l.points) {
        p[along] = p[along].clamp(from, to);
    }
    // Corners that came to lie on each other are one.
    let mut boundary = face.boundary.as_deref().cloned();
    for (k, l) in out.loops.iter_mut().enumerate() {
        let sides: Vec<usize> =
            (0..l.points.len()).filter(|&i| l.points[i] != l.points[(i + 1) % l.points.len()]).collect();
        if let Some(along) = boundary.as_mut().and_then(|b| b.along.get_mut(k)).filter(|a| a.len() == l.points.len()) {
            *along = sides.iter().map(|&i| along[i]).collect();
        }
        *l = TrimLoop {
            points: sides.iter().map(|&i| l.points[i]).collect(),
            edge: sides.iter().map(|&i| l.edge[i]).collect(),
        };
    }
    let mut off = [0.0; 2];
    off[along] = hair;
    out.boundary = boundary.map(Arc::new);
    let missed = (out.trim_bound() + parameters_moved(&face.surface, off)).next_up();
    out.set_trim_bound(missed);
    Some(out)
}
