//! Faces that go on smoothly, joined where one cover of both is better than two.
//!
//! *Method*. Faces are joined as `brep::join` says \[R89\]; the cover's own estimates decide whether they should be.

use super::cover::{has_one_panel, is_developable, is_smoothly_developable, least_bend, strip_range};
use crate::brep::face::Face;
use crate::brep::join::{joined, JoinOptions};
use crate::control::Control;
use crate::geom::Vec3;
use std::time::Instant;

/// Share of the tolerance by which control points of two faces may differ along an edge across which they are joined;
/// what is used of it is taken from the tolerance of the panels.
const MISMATCH_SHARE: f64 = 0.01;
/// Angle through which the normal of a joined face may turn along its parameter lines: half a tube with something to
/// spare, not a whole tube, whose strip potentials would have to close.
const MOST_TURN_DEG: f64 = 200.0;

/// Angle through which a joined face may turn where it bends more sharply than panels may: a panel that stays away from the
/// corner by a third of its least radius turns by 83°, one that lies across the bend as a plane by some more. A fuselage whose nose
/// turns by 106° has no end at 20 mm when its halves are joined beside it, and 38 panels when they are joined above it.
const MOST_SHARP_DEG: f64 = 95.0;
/// The same where panels are to meet: strips around such a bend come too near to folding to be equally high along their seams. With the
/// quarters of its tail joined, that fuselage has 39 panels and 11 of 36 seams open, else 42 and 2 of 32.
const MOST_SHARP_MEETING_DEG: f64 = 45.0;
/// Only on faces larger than so many tolerances: on small ones covers of the whole are found in seconds, and a nose of 1000 mm with a
/// radius of 2 mm at its tip has 4 panels at 5 mm, its halves 6; with 10 m, 9 mm and 20 mm no end was found.
const LONG: f64 = 400.0;
/// Only where each of its parts turns by so much less do two panels go where one cannot.
const SHARPER: f64 = 1.2;
/// Parameter lines of each kind along which bends are looked at, and places on each.
const LOOKED_AT: (usize, usize) = (17, 65);
/// Places on a line nearer to each other than this share of a face's size are one: the line is a pole.
const POLE: f64 = 1e-9;

/// One panel is tried on faces that promise more strips than this, of the width `4√ε`.
const MISJUDGED: f64 = 2.0;

/// Share of a limited time after which no more faces are joined: each can be covered for itself.
const JOIN_SHARE: f64 = 0.15;

/// Faces that go on smoothly within an angle (rad) as one, as exactly as a tolerance (mm) asks for, of panels that are to meet or not;
/// where time is limited, those that were found soon.
pub(crate) fn smoothly_joined(
    faces: Vec<Face>,
    tolerance: f64,
    (angle, meet): (f64, bool),
    control: &Control,
) -> Vec<Face> {
    let control = match control.remaining() {
        Some(left) => control.clone().until(Instant::now() + left.mul_f64(JOIN_SHARE)),
        None => control.clone(),
    };
    let options = JoinOptions { angle, mismatch: tolerance * MISMATCH_SHARE, turn: MOST_TURN_DEG.to_radians() };
    joined(faces, &options, &|whole, a, b| {
        if control.stopped() {
            return false;
        }
        // No panel goes around both where they turn too far in a bend that is sharper than panels may have.
        if whole.surface.bbox().diagonal() > LONG * tolerance {
            let sharp = [whole, a, b].map(|f| sharp_turn(f, tolerance).to_degrees());
            let no_panel = sharp[0] > MOST_SHARP_DEG && sharp[0] > SHARPER * sharp[1].max(sharp[2]);
            if no_panel || (meet && sharp[0] > MOST_SHARP_MEETING_DEG) {
                return false;
            }
        }
        // What is developable already keeps its edges and stays exact, unless both together are one smooth developable.
        if is_developable(a, tolerance) || is_developable(b, tolerance) {
            return is_smoothly_developable(whole, tolerance);
        }
        let ranges = [whole, a, b].map(strip_range);
        // Strips of one strip potential across both, or at least no such strips given up.
        let promising = match ranges {
            [Some(whole), Some(a), Some(b)] => whole <= a + b,
            [Some(_), _, _] | [None, None, None] => true,
            [None, _, _] => false,
        };
        // Nearly developable faces promise nothing, or many strips, and are one panel each: then both together must be.
        let many = MISJUDGED * 4.0 * tolerance.sqrt();
        let misjudged = ranges[1..].iter().all(|r| r.is_none_or(|r| r > many));
        let one = |f: &Face| has_one_panel(f, tolerance, &control);
        promising && !(misjudged && one(a) && one(b) && !one(whole))
    })
}

/// Largest angle (rad) through which a face turns along a parameter line without a break in a bend that is sharper than panels within
/// a tolerance (mm) may have; at samples.
fn sharp_turn(face: &Face, tolerance: f64) -> f64 {
    let size = face.surface.bbox().diagonal();
    let least = least_bend(size, tolerance);
    let ((u0, u1), (v0, v1)) = face.surface.domain();
    let place = |s: f64, t: f64| {
        let j = face.surface.jet(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
        Some((j.p, j.normal().try_normalize(f64::MIN_POSITIVE)?))
    };
    let (lines, places) = LOOKED_AT;
    let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
    let longest = |at: &dyn Fn(f64) -> Option<(Vec3, Vec3)>| {
        let along: Vec<(Vec3, Vec3)> = (0..places).filter_map(|k| at(share(k, places))).collect();
        let (mut turned, mut most) = (0.0_f64, 0.0_f64);
        for w in along.windows(2) {
            let turn = w[0].1.cross(&w[1].1).norm().atan2(w[0].1.dot(&w[1].1));
            let way = (w[1].0 - w[0].0).norm();
            // At a pole normals say nothing.
            let is_sharp = turn * least > way && way > POLE * size;
            turned = if is_sharp { turned + turn } else { 0.0 };
            most = most.max(turned);
        }
        most
    };
    let of_line = |k: usize| {
        let at = share(k, lines);
        longest(&|t| place(at, t)).max(longest(&|s| place(s, at)))
    };
    (0..lines).map(of_line).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    use std::f64::consts::FRAC_1_SQRT_2;

    /// A quarter of a nose of 1000 mm whose sections are arcs, from a radius (mm) at its tip to 300 mm, above or below; the first part
    /// of the way (mm) makes it wide.
    fn quarter((tip, way): (f64, f64), above: bool) -> Face {
        let knots = || Knots::clamped(2, &[0.0, 1.0]).expect("knots");
        let arc = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[y, z]| if above { [y, z] } else { [z, -y] });
        let along = [[0.0, tip], [way, 0.6 * (tip + 300.0)], [1000.0, 300.0]];
        let points: Vec<Vec3> = along.iter().flat_map(|&[x, r]| arc.map(|[y, z]| Vec3::new(x, r * y, r * z))).collect();
        let weights = [1.0, FRAC_1_SQRT_2, 1.0].repeat(3);
        Face::untrimmed(Surface::new(knots(), knots(), &points, Some(&weights)).expect("a surface"))
    }

    /// A wing of 1270 mm, thinner and turned a little at its tip, above or below.
    fn wing(above: bool) -> Face {
        let knots = |p: usize| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
        let side = if above { 1.0 } else { -1.0 };
        let section = |y: f64, thick: f64, turn: f64| {
            [[0.0, 0.0], [0.0, thick], [120.0, 0.8 * thick], [254.0, 0.0]].map(|[x, z]| {
                let (sin, cos) = f64::sin_cos(turn);
                Vec3::new(x * cos - side * z * sin, y, x * sin + side * z * cos)
            })
        };
        let points = [section(0.0, 16.0, 0.0), section(1270.0, 15.0, 0.004)].concat();
        Face::untrimmed(Surface::new(knots(1), knots(3), &points, None).expect("a surface"))
    }

    #[test]
    fn faces_of_one_panel_each_are_not_joined_to_a_face_of_more() {
        let tolerance = 1.3;
        let control = Control::default();
        assert!([true, false].iter().all(|above| has_one_panel(&wing(*above), tolerance, &control)));
        let joined = smoothly_joined(vec![wing(true), wing(false)], tolerance, (0.01, true), &control);
        assert_eq!(joined.len(), 2);
    }

    #[test]
    fn faces_are_not_joined_around_a_tip_that_no_panel_can_go_around() {
        let joined = |nose: (f64, f64), tolerance: f64, meet: bool| {
            let faces = vec![quarter(nose, true), quarter(nose, false)];
            smoothly_joined(faces, tolerance, (0.01, meet), &Control::default()).len()
        };
        assert_eq!([false, true].map(|meet| joined((100.0, 300.0), 2.0, meet)), [1, 1]);
        // Panels bend to 6 mm.
        assert_eq!(joined((2.0, 300.0), 2.0, false), 2);
        assert_eq!([false, true].map(|meet| joined((2.0, 300.0), 5.0, meet)), [1, 1]);
        // Half of this one turns by 88°.
        assert_eq!([false, true].map(|meet| joined((2.0, 100.0), 2.0, meet)), [1, 2]);
        // Normals of a section lean by the slope of the nose at its tip.
        let slope = (0.6 * 302.0 - 2.0) / 300.0_f64;
        let turns =
            [quarter((2.0, 300.0), true), quarter((100.0, 300.0), true)].map(|f| sharp_turn(&f, 2.0).to_degrees());
        assert!((turns[0] - 90.0 / slope.hypot(1.0)).abs() < 0.1 && turns[1] == 0.0, "{turns:?}");
    }
}
