//! Faces that run to the very tip of a cone end a hair before it: there they have no tangent plane, sheet cannot be bent to it, and
//! files have no edge without length. What is missing is proven and counts as what trims miss.

use crate::brep::face::{Face, TrimLoop};
use crate::brep::recognised_surface::bounds;
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
/// Distance at the wide end, as a share of the tolerance, within which a side of the trim that runs to the tip is a ruling.
const STRAIGHT: f64 = 0.01;

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
    let tip = match rulings.end_in_points() {
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
    let end = if tip == 0 { from } else { to };
    let breadth = rulings.breadths(0.5 * (a + b))?[1 - tip];
    let mut out = face.clone();
    let mut off = [0.0_f64; 2];
    for points in out.loops.iter_mut().map(|l| &mut l.points) {
        for p in points.iter_mut() {
            p[along] = p[along].clamp(from, to);
        }
        off[1 - along] = off[1 - along].max(straightened(points, along, end, STRAIGHT * tolerance / breadth));
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
    off[along] = hair;
    out.boundary = boundary.map(Arc::new);
    let missed = (out.trim_bound() + parameters_moved(&face.surface, off)).next_up();
    out.set_trim_bound(missed);
    Some(out)
}

/// Makes rulings of the sides of a loop that run to its part at the `end` of the rulings, if they turn aside by no more than `slack`: the
/// points of an edge of the file have feet the less certain the nearer they are to the tip. By how much points move.
fn straightened(points: &mut [[f64; 2]], along: usize, end: f64, slack: f64) -> f64 {
    let (n, across) = (points.len(), 1 - along);
    let ends: Vec<bool> = points.iter().map(|p| p[along] == end).collect();
    let mut moved = 0.0_f64;
    for i in (0..n).filter(|&i| ends[i]) {
        // Forwards and backwards; a point alone is the end of two sides.
        let ways = [1, n - 1].map(|step| (step, (i + step) % n)).into_iter().filter(|w| !ends[w.1]);
        let [(step, first)] = ways.collect::<Vec<_>>()[..] else { continue };
        let tip = points[i][across];
        let beside = |k: &usize| !ends[*k] && (points[*k][across] - tip).abs() <= slack;
        let side: Vec<usize> = (0..n).map(|k| (first + k * step) % n).take_while(beside).collect();
        let Some(&wide) = side.last() else { continue };
        let ruling = points[wide][across];
        for k in side.into_iter().chain([i]) {
            moved = moved.max((points[k][across] - ruling).abs());
            points[k][across] = ruling;
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_that_run_to_the_tip_are_rulings_where_they_nearly_are() {
        let ([a, b], tip) = ([1e-9, 3e-8], 5.0);
        let loop_with = |off: f64| vec![[0.0, 0.0], [2.0, 0.0], [2.0 + a, 4.0], [2.0 + off, tip], [0.5, tip], [b, tip]];
        let mut points = loop_with(-b);
        let moved = straightened(&mut points, 1, tip, 1e-7);
        assert_eq!(points, vec![[0.0, 0.0], [2.0, 0.0], [2.0, 4.0], [2.0, tip], [0.5, tip], [0.0, tip]]);
        assert!((moved - b).abs() < 1e-12, "{moved}");
        // A side that turns aside farther stays what it is; so does a corner that is the end of both sides.
        let mut points = loop_with(-1e-3);
        let moved = straightened(&mut points, 1, tip, 1e-7);
        assert_eq!((points[2], points[3], points[5]), ([2.0 + a, 4.0], [2.0 - 1e-3, tip], [0.0, tip]));
        assert!((moved - b).abs() < 1e-12, "{moved}");
        let corner = vec![[0.0, 0.0], [1e-8, 0.0], [1e-9, tip]];
        let mut points = corner.clone();
        assert_eq!(straightened(&mut points, 1, tip, 1e-7), 0.0);
        assert_eq!(points, corner);
    }
}
