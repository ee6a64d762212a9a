//! Bounds of strokes against what is seen, with frames, motions, edges and strokes of any kind.

use super::strokes;
use crate::geom::{Frame, Vec2, Vec3};
use crate::patchwork::image::{ClosedMap, EdgeImage, Stroke};
use crate::spline::curve::Curve;
use proptest::prelude::*;

const HALF_ANGLE: f64 = 0.4;
const RADIUS: f64 = 80.0;

fn frame(at: Vec3, angles: [f64; 3]) -> Frame {
    let turn = *nalgebra::Rotation3::from_euler_angles(angles[0], angles[1], angles[2]).matrix();
    let axis = |k: usize| Vec3::from(turn.column(k));
    Frame { origin: at, x: axis(0), y: axis(1), z: axis(2) }
}

/// A plane, a cylinder or a cone; `sheet` moves its neutral surface off the face.
fn map(kind: usize, frame: Frame, sheet: f64) -> ClosedMap {
    match kind {
        0 => ClosedMap::Plane(frame),
        1 => ClosedMap::Cylinder { frame, radius: RADIUS, reach: RADIUS - sheet },
        _ => ClosedMap::Cone { frame, half_angle: HALF_ANGLE, behind: sheet, turn: HALF_ANGLE.sin() },
    }
}

/// The point beside the surface of a map at an angle and a height, or at two coordinates of a plane.
fn beside(map: &ClosedMap, angle: f64, height: f64, off: f64) -> Vec3 {
    let (s, c) = angle.sin_cos();
    let local = match map {
        ClosedMap::Plane(_) => Vec3::new(RADIUS * angle, height, off),
        ClosedMap::Cylinder { .. } => Vec3::new((RADIUS + off) * c, (RADIUS + off) * s, height),
        ClosedMap::Cone { .. } => {
            let r = height * HALF_ANGLE.tan() + off;
            Vec3::new(r * c, r * s, height)
        }
    };
    map.frame().to_world(&local)
}

fn edge(points: &[Vec3], weights: &[f64]) -> Curve<4> {
    let control = points.iter().zip(weights).map(|(p, w)| [p.x * w, p.y * w, p.z * w, *w]).collect();
    let knots = [vec![0.0; points.len()], vec![1.0; points.len()]].concat();
    Curve::new(points.len() - 1, knots, control).expect("an edge")
}

/// Where an edge's point comes to lie in the drawing.
fn image_of(i: &EdgeImage, t: f64) -> Vec2 {
    let h = i.curve.point(t);
    let x = Vec3::new(h[0], h[1], h[2]) / h[3];
    let q = i.map.flat(&x, i.map.angle(&x));
    let [c, s] = i.turn;
    Vec2::new(c * q.x - s * q.y, s * q.x + c * q.y) + i.shift
}

/// Distance of a place from a line or arc.
fn distance(s: &Stroke, p: &Vec2) -> f64 {
    let chord = s.end - s.start;
    if s.bulge == 0.0 {
        let share = (chord.dot(&(p - s.start)) / chord.norm_squared()).clamp(0.0, 1.0);
        return (p - s.start - chord * share).norm();
    }
    let normal = Vec2::new(-chord.y, chord.x);
    let centre = (s.start + s.end) * 0.5 + normal * ((1.0 - s.bulge * s.bulge) / (4.0 * s.bulge));
    let out = (s.start + s.end) * 0.5 - normal * (0.5 * s.bulge) - centre;
    let half = 2.0 * s.bulge.abs().atan();
    match out.angle(&(p - centre)) <= half {
        true => ((p - centre).norm() - out.norm()).abs(),
        false => (p - s.start).norm().min((p - s.end).norm()),
    }
}

/// The edge goes out to 20 mm on one side of a small arc between its ends, and back.
#[test]
fn what_lies_beyond_the_end_of_an_arc_and_outside_its_circle_is_as_far_as_it_is() {
    for side in [-1.0, 1.0] {
        let points = [Vec3::new(-1.0, 0.0, 0.0), Vec3::new(0.0, 40.0 * side, 0.0), Vec3::new(1.0, 0.0, 0.0)];
        let image = EdgeImage {
            face: 0,
            curve: edge(&points, &[1.0; 3]),
            map: ClosedMap::Plane(Frame::world()),
            turn: [1.0, 0.0],
            shift: Vec2::zeros(),
            part: [0.0, 1.0],
            angles: [0.0; 2],
        };
        let drawn = |images| Stroke { start: -Vec2::x(), end: Vec2::x(), bulge: 0.2, images };
        let seen = distance(&drawn(None), &Vec2::new(0.0, 20.0 * side));
        let bound = strokes(&[drawn(Some(vec![image]))], &[], 0.01);
        assert!(bound >= seen && bound < 2.0 * seen, "{bound} for {seen}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn no_point_of_an_image_is_beyond_the_bound(
        kind in 0..3usize,
        (at, angles, turn) in (prop::array::uniform3(-500.0..500.0f64), prop::array::uniform3(-3.0..3.0f64), -3.0..3.0f64),
        places in prop::array::uniform4((-0.8..0.8f64, 60.0..160.0f64, -0.5..0.5f64, 0.7..1.4f64)),
        (sheet, bulge, off) in (-1.0..1.0f64, prop_oneof![Just(0.0), -0.6..0.6f64], prop::array::uniform2(-0.5..0.5f64)),
    ) {
        let map = map(kind, frame(Vec3::from(at), angles), sheet);
        let points = places.map(|(angle, height, off, _)| beside(&map, angle, height, off));
        let image = EdgeImage {
            face: 0,
            curve: edge(&points, &places.map(|p| p.3)),
            map,
            turn: [turn.cos(), turn.sin()],
            shift: Vec2::new(at[1], at[2]),
            part: [0.0, 1.0],
            angles: [map.angle(&points[0]), map.angle(&points[3])],
        };
        let ends = [0.0, 1.0].map(|t| image_of(&image, t));
        let drawn = |images| Stroke { start: ends[0], end: ends[1] + Vec2::from(off), bulge, images };
        let bound = strokes(&[drawn(Some(vec![image.clone()]))], &[], 0.5);
        let seen = (0..=400).map(|k| distance(&drawn(None), &image_of(&image, f64::from(k) / 400.0))).fold(0.0, f64::max);
        prop_assert!(bound >= seen - 1e-9, "{bound} but {seen} seen");
    }

    /// Circles about the axis and lines along it, in any frame and after any motion, are known to rounding.
    #[test]
    fn circles_about_an_axis_are_known_to_rounding(
        kind in 1..3usize,
        (at, angles, turn) in (prop::array::uniform3(-500.0..500.0f64), prop::array::uniform3(-3.0..3.0f64), -3.0..3.0f64),
        (half, height, sheet, wrong) in (0.1..1.2f64, 60.0..160.0f64, -1.0..1.0f64, 0.001..0.1f64),
    ) {
        let map = map(kind, frame(Vec3::from(at), angles), sheet);
        let [a, b] = [-half, half].map(|angle| beside(&map, angle, height, 0.0));
        // Where the tangents at both ends meet.
        let reach = if kind == 1 { RADIUS } else { height * HALF_ANGLE.tan() };
        let middle = map.frame().to_world(&Vec3::new(reach / half.cos(), 0.0, height));
        let image = EdgeImage {
            face: 0,
            curve: edge(&[a, middle, b], &[1.0, half.cos(), 1.0]),
            map,
            turn: [turn.cos(), turn.sin()],
            shift: Vec2::new(at[1], at[2]),
            part: [0.0, 1.0],
            angles: [-half, half],
        };
        let [start, end] = [0.0, 1.0].map(|t| image_of(&image, t));
        let bulge = if kind == 1 { 0.0 } else { (0.5 * half * HALF_ANGLE.sin()).tan() };
        let drawn = |start, end| strokes(&[Stroke { start, end, bulge, images: Some(vec![image.clone()]) }], &[], 1e-6);
        let bound = drawn(start, end);
        prop_assert!(bound <= 1e-8, "{bound}");
        let way = (end - start).normalize();
        let aside = Vec2::new(-way.y, way.x) * wrong;
        let bound = drawn(start + aside, end + aside);
        prop_assert!(bound >= wrong - 1e-9 && bound <= 1.5 * wrong + 1e-8, "{bound} for {wrong}");
    }
}
