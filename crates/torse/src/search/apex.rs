//! Faces that run to the very tip of a cone end a hair before it: there they have no tangent plane, sheet cannot be bent to it, and
//! files have no edge without length. What is missing is proven and counts as what trims miss.

use crate::brep::face::{Face, TrimLoop};
use crate::brep::meridian::Meridian;
use crate::brep::recognised_surface::bounds;
use crate::brep::rulings::Rulings;
use crate::certify::parameters_moved;
use crate::num::parallel;
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
/// Length of the hair where a face of revolution comes to its axis, as a share of the tolerance.
const AT_POLE: f64 = 1.0 / 250.0;
/// Places of a meridian at which its distance from the axis is looked at.
const TURNED: usize = 64;
/// Share of the tolerance within which lines are rulings, and keep their tangent planes: files round.
pub(super) const SLACK: f64 = 0.05;
/// Distance at the wide end, as a share of the tolerance, within which a side of the trim that runs to the tip is a ruling.
const STRAIGHT: f64 = 0.01;

/// Faces that end beside their apexes, if they have any; tolerance in mm.
pub(crate) fn beside_apexes(faces: Vec<Face>, hair: Hair, tolerance: f64) -> Vec<Face> {
    parallel::map(faces, |f| beside_apex(&f, hair, tolerance).unwrap_or(f))
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
    let range = if tip == 0 { (lo + hair, hi) } else { (lo, hi - hair) };
    let along = usize::from(!rulings.is_swapped());
    let breadth = rulings.breadths(0.5 * (a + b))?[1 - tip];
    Some(ended(face, along, range, STRAIGHT * tolerance / breadth))
}

/// A face of revolution without the points where it comes to its axis: cones about it have no foot for these. `None` where it
/// comes to none.
pub(crate) fn beside_poles(face: &Face, meridian: &Meridian, tolerance: f64) -> Option<Face> {
    let (lo, hi) = meridian.range;
    let poles = meridian.ends_on_axis();
    let hair = |t: f64| AT_POLE * tolerance / meridian.jet(t)[1].norm();
    let ends = [(lo, poles[0], 1.0), (hi, poles[1], -1.0)]
        .map(|(t, is_pole, into)| if is_pole { t + into * hair(t) } else { t });
    if !poles.contains(&true) || ends[0] >= ends[1] {
        return None;
    }
    let radius = (0..=TURNED).map(|k| meridian.jet(lo + (hi - lo) * k as f64 / TURNED as f64)[0].x).fold(0.0, f64::max);
    Some(ended(face, meridian.along(), (ends[0], ends[1]), STRAIGHT * tolerance / radius * meridian.per_radian()))
}

/// A face that ends where a parameter, u or v by its number, leaves a range; sides that run there within `slack` of a line of the
/// other parameter lie on it. By how far points have moved counts as what its trim misses.
fn ended(face: &Face, along: usize, (from, to): (f64, f64), slack: f64) -> Face {
    let mut out = face.clone();
    let mut off = [0.0_f64; 2];
    for points in out.loops.iter_mut().map(|l| &mut l.points) {
        let before = points.clone();
        for p in points.iter_mut() {
            p[along] = p[along].clamp(from, to);
        }
        let moved = points.iter().zip(&before).map(|(p, q)| (p[along] - q[along]).abs());
        off[along] = moved.fold(off[along], f64::max);
        for end in [from, to] {
            // Only where something was taken away.
            if points.iter().zip(&before).any(|(p, q)| p[along] == end && q[along] != end) {
                off[1 - along] = off[1 - along].max(straightened(points, along, end, slack));
            }
        }
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
    out.boundary = boundary.map(Arc::new);
    let missed = (out.trim_bound() + parameters_moved(&face.surface, off)).next_up();
    out.set_trim_bound(missed);
    out
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

    #[test]
    fn faces_of_revolution_end_beside_their_poles() {
        use crate::brep::space_curve::SpaceCurve;
        use crate::brep::swept::revolve;
        use crate::geom::{Frame, Vec3};
        // A cap of radius 100 mm, whose poles are at the end of the meridian.
        let frame = Frame { y: Vec3::z(), z: -Vec3::y(), ..Frame::world() };
        let circle = SpaceCurve::Ellipse { frame, a: 100.0, b: 100.0 };
        let turned = |to: f64| {
            let surface = revolve(&circle, &Frame::world(), (0.0, 3.0), (0.5, to)).expect("a surface").0;
            Face::untrimmed(surface)
        };
        let beside = |face: &Face| {
            let meridian = Meridian::of(&face.surface, bounds(face), 1e-6).expect("a meridian");
            beside_poles(face, &meridian, 1.0)
        };
        let face = turned(std::f64::consts::FRAC_PI_2);
        let ended = beside(&face).expect("a pole");
        let nearest = |face: &Face| {
            let points = face.loops.iter().flat_map(|l| &l.points).map(|p| face.surface.point(p[0], p[1]));
            points.map(|x| x.x.hypot(x.y)).fold(f64::INFINITY, f64::min)
        };
        assert!(nearest(&face) < 1e-9 && (nearest(&ended) - AT_POLE).abs() < 1e-4, "{}", nearest(&ended));
        // What is missing is a disc of that radius; its bound knows no more of the surface than its largest speed.
        assert!(ended.trim_bound() >= AT_POLE * 0.999 && ended.trim_bound() < 3.0 * AT_POLE, "{}", ended.trim_bound());
        assert!(beside(&turned(1.2)).is_none());
    }
}
