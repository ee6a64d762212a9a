//! Which side of a boundary a face lies on, on surfaces without border (docs/algorithms/reading.md).

use super::{about_its_circles, faces, TrimError};
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::brep::raw::{RawEdge, RawFace, RawLoop, RawRegion, SurfaceDeviation, SurfaceKind};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A small loop around (0.5, 0.3) of the natural parameters' box, counter-clockwise in the parameter plane or not.
fn small_loop(support: &SupportSurface, box_of: [(f64, f64); 2], counter_clockwise: bool, outer: bool) -> RawLoop {
    let [(u0, u1), (v0, v1)] = box_of;
    let origin = Vec3::new(u0 + 0.5 * (u1 - u0), v0 + 0.3 * (v1 - v0), 0.0);
    let plane =
        SpaceCurve::Ellipse { frame: Frame { origin, ..Frame::world() }, a: 0.1 * (u1 - u0), b: 0.1 * (v1 - v0) };
    let curve = SpaceCurve::traced(plane, support.clone(), [1.0, 1.0]);
    let (from, to) = if counter_clockwise { (0.0, TAU) } else { (TAU, 0.0) };
    let path = vec![Arc { curve, from, to }];
    RawLoop { edges: vec![RawEdge { entity: 7, forward: true, path, vertices: None, trace: None }], outer }
}

fn raw(support: &SupportSurface, region: RawRegion) -> RawFace {
    RawFace {
        entity: 1,
        name: String::new(),
        part: String::new(),
        kind: SurfaceKind::Spline,
        support: support.clone(),
        same_sense: true,
        region,
        surface_deviation: SurfaceDeviation::NONE,
        uncertainty: 0.0,
    }
}

fn area(support: &SupportSurface, region: RawRegion) -> f64 {
    faces(&raw(support, region), None).expect("a face").iter().map(area_estimate).sum()
}

fn spline(surface: Surface) -> SupportSurface {
    SupportSurface::Spline(SplineSupport::new(surface))
}

/// A surface without border, with the box of its natural parameters.
type Named = (&'static str, SupportSurface, [(f64, f64); 2]);

/// Surfaces without border.
fn closed() -> Vec<Named> {
    let frame = Frame::world();
    let sphere = SupportSurface::Sphere { frame, radius: 100.0 };
    let torus = SupportSurface::Torus { frame, major: 200.0, minor: 60.0 };
    let around = [(0.0, TAU), (-FRAC_PI_2, FRAC_PI_2)];
    let both = [(0.0, TAU); 2];
    let of_sphere = sphere.to_spline(around[0], around[1]).expect("a spline").0;
    let of_torus = torus.to_spline(both[0], both[1]).expect("a spline").0;
    let domain = |s: &Surface| [s.domain().0, s.domain().1];
    let (on_sphere, on_torus) = (domain(&of_sphere), domain(&of_torus));
    // An egg: from pole to pole, turned about the axis.
    let meridian: Vec<[f64; 4]> =
        [[0.0, -100.0], [80.0, -100.0], [90.0, 60.0], [0.0, 120.0]].map(|[x, z]| [x, 0.0, z, 1.0]).to_vec();
    let directrix = Curve::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], meridian).expect("a meridian");
    let egg = SupportSurface::Revolution { directrix: SpaceCurve::Spline(directrix), frame };
    let other_way = spline(of_sphere.transposed());
    vec![
        ("sphere", sphere, around),
        ("torus", torus, both),
        ("sphere as a spline", spline(of_sphere), on_sphere),
        ("sphere as a spline, parameters exchanged", other_way, [on_sphere[1], on_sphere[0]]),
        ("torus as a spline", spline(of_torus), on_torus),
        ("egg", egg, [(0.0, TAU), (0.0, 1.0)]),
    ]
}

/// Both sides of a loop are regions; together they are the whole surface, whatever the file calls outer.
#[test]
fn the_sense_of_a_loop_says_which_side_of_it_a_face_is() {
    for (name, support, box_of) in closed() {
        let bounded = |counter_clockwise: bool, outer: bool| {
            area(&support, RawRegion::Loops(vec![small_loop(&support, box_of, counter_clockwise, outer)]))
        };
        let (inside, outside) = (bounded(true, false), bounded(false, false));
        let whole = area(&support, RawRegion::Rectangle(box_of));
        assert!((inside + outside - whole).abs() < 2e-3 * whole, "{name}: {inside} + {outside} is not {whole}");
        assert!(inside < 0.1 * whole, "{name}: {inside} of {whole}");
        // Where senses are not to be relied on, it is the inside.
        let told = bounded(false, true);
        assert!((told - inside).abs() < 1e-3 * inside, "{name}: {told} is not {inside}");
    }
}

/// A spline that closes but for rounding has both sides too, and no sure way to the other one.
#[test]
fn the_other_side_of_a_surface_that_hardly_closes_is_refused() {
    let sphere = SupportSurface::Sphere { frame: Frame::world(), radius: 100.0 };
    let (mut surface, _) = sphere.to_spline((0.0, TAU), (-FRAC_PI_2, FRAC_PI_2)).expect("a spline");
    surface.control[0][2] += 1e-3;
    let support = spline(surface.clone());
    assert!(!support.is_closed() && support.is_nearly_closed());
    let box_of = [surface.domain().0, surface.domain().1];
    let bounded =
        |way: bool| faces(&raw(&support, RawRegion::Loops(vec![small_loop(&support, box_of, way, false)])), None);
    assert_eq!(bounded(false).err(), Some(TrimError::EitherSide));
    assert!(bounded(true).is_ok());
}

/// A band of a torus between two waves that are drawn with points at other places, and with a hole below the mean of the lower
/// one: the band, not the band and the whole torus.
#[test]
fn a_wavy_band_of_a_torus_is_that_band() {
    let (major, minor) = (200.0, 60.0);
    let support = SupportSurface::Torus { frame: Frame::world(), major, minor };
    let wave = |lift: f64, power: f64, forward: bool| {
        const COUNT: u32 = 160;
        let point = |k: u32| {
            let u = TAU * (f64::from(k) / f64::from(COUNT)).powf(power);
            [u, u.sin() + lift, 0.0, 1.0]
        };
        let ends = |x: f64| [x, x];
        let inner = (1..COUNT).map(f64::from);
        let knots = ends(0.0).into_iter().chain(inner).chain(ends(f64::from(COUNT))).collect();
        let curve = Curve::new(1, knots, (0..=COUNT).map(point).collect()).expect("a wave");
        let curve = SpaceCurve::traced(SpaceCurve::Spline(curve), support.clone(), [1.0, 1.0]);
        let (from, to) = if forward { (0.0, f64::from(COUNT)) } else { (f64::from(COUNT), 0.0) };
        RawLoop {
            edges: vec![RawEdge {
                entity: 1,
                forward: true,
                path: vec![Arc { curve, from, to }],
                vertices: None,
                trace: None,
            }],
            outer: false,
        }
    };
    let hole = {
        let origin = Vec3::new(0.75 * TAU, -0.85, 0.0);
        let plane = SpaceCurve::Ellipse { frame: Frame { origin, ..Frame::world() }, a: 0.05, b: 0.05 };
        let path = vec![Arc { curve: SpaceCurve::traced(plane, support.clone(), [1.0, 1.0]), from: TAU, to: 0.0 }];
        RawLoop { edges: vec![RawEdge { entity: 2, forward: true, path, vertices: None, trace: None }], outer: false }
    };
    for lift in [0.3, 1.0, 5.5] {
        let loops = vec![wave(0.0, 2.0, true), wave(lift, 0.5, false)];
        let count = 4000;
        let sum: f64 = (0..count)
            .map(|k| {
                let low = (TAU * (f64::from(k) + 0.5) / f64::from(count)).sin();
                major * lift + minor * ((low + lift).sin() - low.sin())
            })
            .sum();
        let wanted = minor * sum * TAU / f64::from(count);
        let found = area(&support, RawRegion::Loops(loops.clone()));
        assert!((found - wanted).abs() < 1e-2 * wanted, "{lift}: {found} is not {wanted}");
        let pierced = area(&support, RawRegion::Loops(loops.into_iter().chain([hole.clone()]).collect()));
        let removed = minor * (major + minor * 0.85f64.cos()) * std::f64::consts::PI * 0.05 * 0.05;
        assert!((found - pierced - removed).abs() < 0.02 * removed, "{lift}: {} is not {removed}", found - pierced);
    }
}

/// A tube with an edge that leaves its upper circle upwards and comes back: the edge bounds nothing.
#[test]
fn a_slit_of_a_cylinder_bounds_nothing() {
    let support = SupportSurface::Cylinder { frame: Frame::world(), radius: 10.0 };
    let circle = |z: f64, from: f64, to: f64| {
        let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
        Arc { curve: SpaceCurve::Ellipse { frame, a: 10.0, b: 10.0 }, from, to }
    };
    let slit = |from: f64, to: f64| {
        let curve = SpaceCurve::Line { origin: Vec3::new(10.0, 0.0, 20.0), direction: Vec3::z() };
        Arc { curve, from, to }
    };
    let edge = |entity: u64, arc: Arc| RawEdge {
        entity,
        forward: arc.from < arc.to,
        path: vec![arc],
        vertices: None,
        trace: None,
    };
    let low = RawLoop { edges: vec![edge(1, circle(0.0, 0.0, TAU))], outer: false };
    let edges = vec![edge(2, circle(20.0, TAU, 0.0)), edge(3, slit(0.0, 6.0)), edge(3, slit(6.0, 0.0))];
    let high = RawLoop { edges, outer: false };
    let made = faces(&raw(&support, RawRegion::Loops(vec![low, high])), None).expect("a tube");
    let wanted = TAU * 10.0 * 20.0;
    let found: f64 = made.iter().map(area_estimate).sum();
    assert!((found - wanted).abs() < 1e-3 * wanted, "{found} is not {wanted}");
    let boundary = made[0].boundary.as_ref().expect("edges of the file");
    let entities: Vec<u64> = boundary.loops.iter().flatten().map(|e| e.entity).collect();
    assert_eq!(entities, [1, 2]);
}

/// A hole of 20 mm that is less than two thousandths of a millimetre wide is one, though both its edges nearly agree.
#[test]
fn a_slim_hole_of_a_cylinder_is_no_slit() {
    let support = SupportSurface::Cylinder { frame: Frame::world(), radius: 10.0 };
    let edge = |entity: u64, curve: SpaceCurve, from: f64, to: f64| RawEdge {
        entity,
        forward: from < to,
        path: vec![Arc { curve, from, to }],
        vertices: None,
        trace: None,
    };
    let circle = |z: f64| {
        let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
        SpaceCurve::Ellipse { frame, a: 10.0, b: 10.0 }
    };
    let hole = || {
        let plane = SpaceCurve::Ellipse {
            frame: Frame { origin: Vec3::new(2.0, 15.0, 0.0), ..Frame::world() },
            a: 8e-5,
            b: 10.0,
        };
        SpaceCurve::traced(plane, support.clone(), [1.0, 1.0])
    };
    let turned = [-FRAC_PI_2, FRAC_PI_2, 3.0 * FRAC_PI_2];
    let loops = vec![
        RawLoop { edges: vec![edge(1, circle(0.0), 0.0, TAU)], outer: false },
        RawLoop { edges: vec![edge(2, circle(30.0), TAU, 0.0)], outer: false },
        RawLoop {
            edges: vec![edge(3, hole(), turned[2], turned[1]), edge(4, hole(), turned[1], turned[0])],
            outer: false,
        },
    ];
    let made = faces(&raw(&support, RawRegion::Loops(loops)), None).expect("a tube with a hole");
    let boundary = made[0].boundary.as_ref().expect("edges of the file");
    let entities: Vec<u64> = boundary.loops.iter().flatten().map(|e| e.entity).collect();
    assert_eq!((made[0].loops.len(), entities), (2, vec![1, 2, 3, 4]));
}

/// The cap of a sphere above a circle, whose file has another axis: parametrised about that of the circle it has a pole in its middle.
#[test]
fn caps_are_parametrised_about_their_circles() {
    let up = Frame { origin: Vec3::new(1.0, 2.0, 3.0), ..Frame::world() };
    let support = SupportSurface::Sphere { frame: Frame { x: up.y, y: up.z, z: up.x, ..up }, radius: 100.0 };
    let rim = |height: f64| {
        let frame = Frame { origin: up.origin + Vec3::z() * height, ..up };
        let a = (100.0_f64.powi(2) - height * height).sqrt();
        let path = vec![Arc { curve: SpaceCurve::Ellipse { frame, a, b: a }, from: 0.0, to: TAU }];
        RawLoop { edges: vec![RawEdge { entity: 7, forward: true, path, vertices: None, trace: None }], outer: true }
    };
    let made = |rim: RawLoop| faces(&raw(&support, RawRegion::Loops(vec![rim])), None).expect("a face").remove(0);
    let face = made(rim(80.0));
    let turned = about_its_circles(&face, 0.01).expect("a cap");
    let cap = TAU * 100.0 * 20.0;
    assert!((area_estimate(&face) - cap).abs() < 1.0 && (area_estimate(&turned) - cap).abs() < 1.0);
    let pole = up.origin + Vec3::z() * 100.0;
    let nearest = |f: &Face| {
        let corners = f.loops.iter().flat_map(|l| &l.points).map(|p| f.surface.point(p[0], p[1]));
        corners.map(|x| (x - pole).norm()).fold(f64::INFINITY, f64::min)
    };
    assert!(nearest(&face) > 60.0 && nearest(&turned) < 1e-9, "{} {}", nearest(&face), nearest(&turned));
    // It is so parametrised then.
    assert!(about_its_circles(&turned, 0.01).is_none());
}

/// A fan of 600 mm whose rulings end a hair before its tip, in an edge that is shorter than a point: its long sides stay on their rulings.
#[test]
fn fans_that_end_a_hair_before_their_tip_keep_their_sides() {
    let (hair, wide) = (1e-5, 4.0);
    let corners = [[0.0, 0.0], [0.0, hair]].map(|c| Vec3::new(c[0], c[1], 0.0));
    let rim = [[600.0, 0.0], [600.0, wide]].map(|c| Vec3::new(c[0], c[1], 0.0));
    let knots = || crate::spline::knots::Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let points = [corners[0], rim[0], corners[1], rim[1]];
    let surface = Surface::new(knots(), knots(), &points, None).expect("a surface");
    let line = |p: Vec3, q: Vec3| {
        let curve = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], [p, q].map(|x| [x.x, x.y, x.z, 1.0]).to_vec());
        Arc { curve: SpaceCurve::Spline(curve.expect("a line")), from: 0.0, to: 1.0 }
    };
    let way = [corners[0], corners[1], rim[1], rim[0]];
    let edge = |k: usize| {
        let (p, q) = (way[k], way[(k + 1) % 4]);
        RawEdge { entity: k as u64 + 1, forward: true, path: vec![line(p, q)], vertices: Some([p, q]), trace: None }
    };
    let region = RawRegion::Loops(vec![RawLoop { edges: (0..4).map(edge).collect(), outer: true }]);
    let faces = faces(&raw(&spline(surface), region), None).expect("a face");
    let corners = &faces[0].loops[0].points;
    assert_eq!(corners.len(), 4, "{corners:?}");
    assert!(corners.iter().flatten().all(|x| x.abs().min((x - 1.0).abs()) < 1e-6), "{corners:?}");
}

/// A triangle as a bilinear spline with a corner for a side, whose first edge is as long as rounding: it is read as a plane, with three
/// corners.
#[test]
fn triangles_with_a_pole_are_read_on_their_plane() {
    let (tip, rim) = (Vec3::new(-300.0, -200.0, 10.0), [Vec3::new(200.0, 40.0, 500.0), Vec3::new(75.0, -400.0, 470.0)]);
    let knots = || crate::spline::knots::Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let control = [tip, rim[0], tip, rim[1]];
    let surface = Surface::new(knots(), knots(), &control, None).expect("a surface");
    // An edge that is a point: control points of different weights, which rounding keeps apart.
    let homogeneous = |p: Vec3, w: f64| [p.x * w, p.y * w, p.z * w, w];
    let line = |p: Vec3, q: Vec3, weight: f64| {
        let curve = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![homogeneous(p, weight), homogeneous(q, 1.0)]);
        Arc { curve: SpaceCurve::Spline(curve.expect("a line")), from: 0.0, to: 1.0 }
    };
    let beside = tip + Vec3::x() * 3e-14;
    let way = [tip, beside, rim[1], rim[0]];
    let edge = |k: usize| {
        let (p, q) = (way[k], way[(k + 1) % 4]);
        let path = vec![line(p, q, if k == 0 { 0.7 } else { 1.0 })];
        RawEdge { entity: k as u64 + 1, forward: true, path, vertices: Some([p, q]), trace: None }
    };
    let region = || RawRegion::Loops(vec![RawLoop { edges: (0..4).map(edge).collect(), outer: true }]);
    let made = faces(&raw(&spline(surface.clone()), region()), None).expect("a face");
    let normal = |f: &Face| f.surface.jet(0.5, 0.5).normal().normalize() * if f.reversed { -1.0 } else { 1.0 };
    let asked = surface.jet(0.5, 0.5).normal().normalize();
    let area = 0.5 * (rim[0] - tip).cross(&(rim[1] - tip)).norm();
    let face = &made[0];
    assert_eq!((made.len(), face.loops[0].points.len()), (1, 3), "{face:?}");
    assert!((area_estimate(face) - area).abs() < 1e-9 * area && (normal(face) - asked).norm() < 1e-12);
    assert!(face.trim_deviation_estimate < 1e-9, "{face:?}");
    // A fan that bends stays a spline.
    let middle = 0.5 * (rim[0] + rim[1]) + asked * 1e-3;
    let two = crate::spline::knots::Knots::clamped(2, &[0.0, 1.0]).expect("knots");
    let fan = Surface::new(two, knots(), &[tip, rim[0], tip, middle, tip, rim[1]], None).expect("a surface");
    assert!(crate::brep::recast::plane_of_triangle(&spline(fan)).is_none());
}
