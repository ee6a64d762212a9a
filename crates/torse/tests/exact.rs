//! What is developable already stays what it is: one panel for a face, with its radius and its length, at any tolerance.

use std::f64::consts::PI;
use torse::answer::Answer;
use torse::brep::face::{Face, TrimLoop};
use torse::brep::space_curve::SpaceCurve;
use torse::brep::support_surface::SupportSurface;
use torse::certify::claim::Status;
use torse::control::Control;
use torse::geom::{Frame, Vec3};
use torse::pipeline::approximate::{of_faces, Options};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;

const PIPE: &[u8] = include_bytes!("../../../data/cylinder_holes.step");

fn panels(faces: Vec<Face>, tolerance: f64) -> Answer {
    let options = Options::new(tolerance);
    let out = of_faces(faces, Vec::new(), &options, &Control::default()).expect("an answer");
    assert_eq!(out.status(), Status::Certified, "{}", torse::io::words::reason(out.claims(), &[]));
    out
}

fn part(c: &SupportSurface, u: (f64, f64), v: (f64, f64)) -> Surface {
    c.to_spline(u, v).expect("a surface").0
}

/// Frame with the axis z along `z`, x along `x`.
fn frame(origin: Vec3, x: Vec3, z: Vec3) -> Frame {
    Frame { origin, x, y: z.cross(&x), z }
}

#[test]
fn a_pipe_with_holes_is_one_panel_at_any_tolerance() {
    let model = torse::io::step::read::read(PIPE).expect("a model");
    for tolerance in [0.5, 0.01] {
        let out = panels(model.faces.clone(), tolerance);
        assert_eq!(out.patchwork().panels.len(), 1);
        let (proof, flat) = (&out.certificate().expect("a certificate").panels[0], &out.patterns()[0]);
        assert!((249.0..=250.0).contains(&proof.min_bend_radius), "{}", proof.min_bend_radius);
        assert!(flat.bends.iter().all(|b| b.radii.iter().all(|r| (r - 250.0).abs() < 0.1)), "{:?}", flat.bends);
        assert!(proof.deviation_bound < 0.7 * tolerance, "{}", proof.deviation_bound);
        assert!((flat.length - 500.0 * PI).abs() < 0.01 && (flat.width - 800.0).abs() < 0.01, "{flat:?}");
        assert_eq!(flat.contours.len(), 3);
    }
}

/// A radius that the surface only just has is no reason to cut it up, whatever is lost in its proof.
#[test]
fn a_pipe_that_just_keeps_a_bending_radius_is_one_panel() {
    let model = torse::io::step::read::read(PIPE).expect("a model");
    for (radius, kept) in [(249.0, true), (249.999, false)] {
        let mut options = torse::Approximate::new(0.5);
        options.limits.min_bend_radius = Some(radius);
        let out = torse::approximate(&model, &options).expect("an answer");
        assert_eq!((out.patchwork().panels.len(), out.status() == torse::Status::Certified), (1, kept), "{radius}");
    }
}

#[test]
fn a_frustum_of_three_faces_is_three_cones() {
    let cone = SupportSurface::Cone { frame: Frame::world(), radius: 100.0, slope: 0.5 };
    let third = 2.0 * PI / 3.0;
    let faces: Vec<Face> = (0..3)
        .map(|k| Face::untrimmed(part(&cone, (k as f64 * third, (k + 1) as f64 * third), (0.0, 150.0))))
        .collect();
    let out = panels(faces, 0.02);
    assert_eq!(out.patchwork().panels.len(), 3);
    // A sector of the development: angles shrink by the sine of the half angle.
    let sine = 0.5 / 1.25f64.sqrt();
    let (inner, outer) = (100.0 / sine, 175.0 / sine);
    for p in out.patterns() {
        let area = 0.5 * third * sine * (outer * outer - inner * inner);
        assert!((p.area - area).abs() < 1e-4 * area, "{} {area}", p.area);
    }
}

#[test]
fn a_wavy_extrusion_is_one_panel() {
    // An S with an inflection, extruded askew.
    let k = torse::spline::knots::Knots::clamped(3, &[0.0, 0.4, 1.0]).expect("knots");
    let net = [[0.0, 0.0], [40.0, 80.0], [100.0, -90.0], [160.0, 60.0], [200.0, 0.0]];
    let points: Vec<Vec3> = net.iter().map(|p| Vec3::new(p[0], 0.0, p[1])).collect();
    let line = torse::spline::knots::Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let both: Vec<Vec3> = points.iter().flat_map(|p| [*p, p + Vec3::new(30.0, 120.0, 10.0)]).collect();
    let s = Surface::new(k, line, &both, None).expect("a surface");
    for s in [s.clone(), s.transposed().elevated_u().expect("elevated")] {
        let out = panels(vec![Face::untrimmed(s)], 0.01);
        assert_eq!(out.patchwork().panels.len(), 1);
    }
}

/// A wave that is steep to one side for longer than to the other: the mean of its normals is not their middle.
#[test]
fn an_uneven_wave_is_one_panel() {
    let k = torse::spline::knots::Knots::clamped(5, &[0.0, 1.0]).expect("knots");
    let net = [[0.0, 0.0], [109.0, 443.0], [219.0, -932.0], [254.0, 873.0], [396.0, -323.0], [500.0, 25.0]];
    let line = torse::spline::knots::Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let both: Vec<Vec3> =
        net.iter().map(|p| Vec3::new(p[0], 0.0, p[1])).flat_map(|p| [p, p + Vec3::new(30.0, 250.0, 20.0)]).collect();
    let out = panels(vec![Face::untrimmed(Surface::new(k, line, &both, None).expect("a surface"))], 0.05);
    assert_eq!(out.patchwork().panels.len(), 1);
}

/// An omega profile turns through more than half a circle and back: it is the graph of no function.
#[test]
fn an_omega_profile_is_one_panel() {
    let net = [
        [0.0, 0.0],
        [60.0, 0.0],
        [95.0, 0.0],
        [90.0, 30.0],
        [35.0, 60.0],
        [40.0, 120.0],
        [100.0, 130.0],
        [160.0, 120.0],
        [165.0, 60.0],
        [110.0, 30.0],
        [105.0, 0.0],
        [140.0, 0.0],
        [200.0, 0.0],
    ];
    let breaks: Vec<f64> = (0..=net.len() - 3).map(|k| k as f64).collect();
    let k = Knots::clamped(3, &breaks).expect("knots");
    let line = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let both: Vec<Vec3> =
        net.iter().map(|p| Vec3::new(p[0], 7.0, p[1])).flat_map(|p| [p, p + Vec3::new(0.0, 400.0, 0.0)]).collect();
    let s = Surface::new(k, line, &both, None).expect("a surface");
    let length: f64 = (0..4000)
        .map(|i| {
            let at = |i: i32| s.point(breaks[breaks.len() - 1] * f64::from(i) / 4000.0, 0.0);
            (at(i + 1) - at(i)).norm()
        })
        .sum();
    let mut round = Face::untrimmed(s.clone());
    let ((u0, u1), _) = s.domain();
    // The same with a hole in its arch.
    let turn = |k: u32| 2.0 * PI * f64::from(k) / 40.0;
    let hole = (0..40).map(|k| [u0 + (u1 - u0) * (0.5 + 0.05 * turn(k).cos()), 0.5 - 0.1 * turn(k).sin()]).collect();
    round.loops.push(TrimLoop { points: hole, edge: vec![9; 40] });
    for face in [Face::untrimmed(s.clone()), Face::untrimmed(s.transposed()), round] {
        for tolerance in [0.5, 0.01] {
            let out = panels(vec![face.clone()], tolerance);
            assert_eq!(out.patchwork().panels.len(), 1);
            let flat = &out.patterns()[0];
            let sides = [flat.length.max(flat.width), flat.length.min(flat.width)];
            assert!(
                (sides[0] - length.max(400.0)).abs() < 0.01 && (sides[1] - length.min(400.0)).abs() < 0.01,
                "{flat:?}"
            );
        }
    }
}

#[test]
fn a_tangent_surface_of_a_curve_is_one_panel() {
    // Tangents of a cubic, from one to two times its derivative away.
    let at = |t: f64| Vec3::new(100.0 * t, 80.0 * t * t, 60.0 * t * t * t);
    let tangent = |t: f64| Vec3::new(100.0, 160.0 * t, 180.0 * t * t);
    let knots = torse::spline::knots::Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    let line = torse::spline::knots::Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    // Cubic Bézier points from values and derivatives at the ends.
    let rail = |s: f64| {
        let p = |t: f64| at(t) + tangent(t) * s;
        let d = |t: f64| tangent(t) + Vec3::new(0.0, 160.0, 360.0 * t) * s;
        [p(0.0), p(0.0) + d(0.0) / 3.0, p(1.0) - d(1.0) / 3.0, p(1.0)]
    };
    let (a, b) = (rail(1.0), rail(2.0));
    let points: Vec<Vec3> = a.iter().zip(&b).flat_map(|(p, q)| [*p, *q]).collect();
    let s = Surface::new(knots, line, &points, None).expect("a surface");
    let out = panels(vec![Face::untrimmed(s)], 0.01);
    assert_eq!(out.patchwork().panels.len(), 1);
}

/// Plane, bend and plane of a bent plate: 60 mm and 40 mm with an inner radius of 5 mm between, 30 mm wide.
fn bracket(turn: f64) -> Vec<Face> {
    let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
    let bend = SupportSurface::Cylinder { frame: frame(Vec3::new(0.0, 0.0, 5.0), -z, y), radius: 5.0 };
    // From the lowest point of the circle on; the axis runs along y, and the angle grows from −z to −x.
    let bend = part(&bend, (-turn, 0.0), (0.0, 30.0));
    let (along, up) = (x * turn.cos() + z * turn.sin(), z * turn.cos() - x * turn.sin());
    let start = Vec3::new(5.0 * turn.sin(), 0.0, 5.0 - 5.0 * turn.cos());
    let first = part(&SupportSurface::Plane(frame(Vec3::zeros(), x, z)), (-60.0, 0.0), (0.0, 30.0));
    let last = part(&SupportSurface::Plane(frame(start, along, up)), (0.0, 40.0), (0.0, 30.0));
    [first, bend, last].into_iter().map(Face::untrimmed).collect()
}

#[test]
fn a_bent_bracket_keeps_its_planes_and_its_bend() {
    for (turn, tolerance) in [(0.5 * PI, 2.0), (0.5 * PI, 0.01), (PI, 0.1)] {
        let out = panels(bracket(turn), tolerance);
        let flat: f64 = out.patterns().iter().map(|p| p.area).sum();
        let want = 30.0 * (100.0 + 5.0 * turn);
        assert!((flat - want).abs() < 1e-3 * want, "{flat} {want}");
        // The planes and the bend keep their edges, and bend lines are in the bend alone.
        assert_eq!(out.patchwork().panels.len(), 3);
        let bent: Vec<usize> = out.patterns().iter().map(|p| p.bends.len()).collect();
        assert!(bent[0] == 0 && bent[1] > 5 && bent[2] == 0, "{bent:?}");
        assert!(out.patterns()[1].bends.iter().all(|b| b.radii.iter().all(|r| (r - 5.0).abs() < 0.01)));
    }
}

#[test]
fn turns_of_more_than_a_half_circle_are_one_panel() {
    let tilted = frame(Vec3::new(10.0, 20.0, 30.0), Vec3::new(0.6, 0.8, 0.0), Vec3::z());
    let ellipse = SpaceCurve::Ellipse { frame: tilted, a: 80.0, b: 50.0 };
    let tube = SupportSurface::Extrusion { directrix: ellipse, direction: Vec3::new(0.1, 0.2, 1.0) };
    let out = panels(vec![Face::untrimmed(part(&tube, (0.0, 1.9 * PI), (0.0, 100.0)))], 0.01);
    assert_eq!(out.patchwork().panels.len(), 1);
}

/// Corners of outlines and holes that share a coordinate but for its last digits, as files with chamfered caps have them.
#[test]
fn corners_in_line_but_for_rounding_are_in_line() {
    let knots = |lo: f64, hi: f64| Knots::clamped(1, &[lo, hi]).expect("knots");
    let (u, v) = ([-1.1101679159995956, 7.80622017146501], [-1.3755068091133649, 11.57603501136442]);
    let corner = |k: usize| Vec3::new(u[k / 2], v[k % 2], 0.0);
    let control: Vec<Vec3> = (0..4).map(corner).collect();
    let mut face =
        Face::untrimmed(Surface::new(knots(u[0], u[1]), knots(v[0], v[1]), &control, None).expect("a plane"));
    let outer = vec![
        [-0.9386989143175821, -1.126438697181099],
        [5.819933268769008, -1.1264386971810998],
        [5.819933268769007, 0.0],
        [3.5044759467856386, 4.440892098500626e-16],
        [3.5044759467856395, 6.070252979253694],
        [7.634751169782996, 6.070252979253694],
        [-0.938698914317583, 11.326966899432152],
    ];
    let hole = vec![
        [0.0, 1.3322676295501878e-15],
        [0.0, 6.070252979253696],
        [2.252877394362196, 6.070252979253696],
        [2.2528773943621996, 1.3322676295501878e-15],
    ];
    let trim = |points: Vec<[f64; 2]>| TrimLoop { edge: (0..points.len() as u32).collect(), points };
    face.loops = vec![trim(outer), trim(hole)];
    assert_eq!(panels(vec![face], 0.5).patterns().len(), 1);
}

/// A whole cone is slit along one ruling; its ends are one line in space, and points there have two feet.
#[test]
fn a_frustum_of_a_full_turn_is_one_panel() {
    let cone = SupportSurface::Cone { frame: Frame::world(), radius: 200.0, slope: -1.0 / 3.0 };
    for tolerance in [1.0, 0.05] {
        let out = panels(vec![Face::untrimmed(part(&cone, (0.0, 2.0 * PI), (0.0, 300.0)))], tolerance);
        assert_eq!(out.patchwork().panels.len(), 1, "{tolerance} mm");
    }
}

/// A cone of half angle 0.54 about z, its base of radius 300 mm in the plane z = 0, up to its tip; over a turn.
fn to_the_tip(turn: f64) -> Face {
    let cone = SupportSurface::Cone { frame: Frame::world(), radius: 300.0, slope: -0.6 };
    Face::untrimmed(part(&cone, (0.0, turn), (0.0, 500.0)))
}

#[test]
fn a_cone_up_to_its_tip_is_one_panel_with_its_slant_at_any_tolerance() {
    let tolerances = [10.0, 1.0, 0.01];
    for (turn, tolerance) in [0.5 * PI, 2.0 * PI].into_iter().flat_map(|t| tolerances.map(|x| (t, x))) {
        let out = panels(vec![to_the_tip(turn)], tolerance);
        assert_eq!(out.patchwork().panels.len(), 1, "{turn} {tolerance}");
        // A sector: every corner of the outline is at the tip or as far from it as the cone is slant.
        let (slant, sine) = (500.0 * 1.36f64.sqrt(), 0.6 / 1.36f64.sqrt());
        let flat = &out.patterns()[0];
        let corners: Vec<_> = flat.contours[0].vertices.iter().map(|v| v.point).collect();
        let gap = |p: &torse::geom::Vec2| corners.iter().map(|q| (q - p).norm()).fold(0.0, f64::max);
        let middle = |p: &&torse::geom::Vec2| {
            let far: Vec<f64> = corners.iter().map(|q| (q - **p).norm()).filter(|d| *d > 0.1 * slant).collect();
            far.iter().map(|d| (d - slant).abs()).fold(0.0, f64::max)
        };
        let tip = corners.iter().min_by(|p, q| middle(p).total_cmp(&middle(q))).expect("a corner");
        assert!(middle(&tip) < 0.1 * tolerance, "{turn} {tolerance} {} {}", middle(&tip), gap(tip));
        assert!((flat.area - 0.5 * slant * slant * turn * sine).abs() < tolerance * slant, "{}", flat.area);
    }
}

#[test]
fn shallow_and_steep_cones_up_to_their_tips_are_one_panel() {
    for (radius, height) in [(50.0, 400.0), (600.0, 200.0), (1000.0, 100.0)] {
        let cone = SupportSurface::Cone { frame: Frame::world(), radius, slope: -radius / height };
        let face = Face::untrimmed(part(&cone, (0.0, 2.0 * PI), (0.0, height)));
        for tolerance in [5.0, 0.5, 0.1, 0.02] {
            let out = panels(vec![face.clone()], tolerance);
            assert_eq!(out.patchwork().panels.len(), 1, "{radius} {height} {tolerance}");
            let area = PI * radius * radius.hypot(height);
            assert!((out.patterns()[0].area - area).abs() < tolerance * height.hypot(radius), "{radius} {tolerance}");
        }
    }
}

/// Whole files lie about in space, not with a tip near the origin.
#[test]
fn a_cone_up_to_its_tip_is_one_panel_wherever_it_lies() {
    let z = Vec3::new(1.0, 2.0, 3.0).normalize();
    let x = Vec3::new(0.0, 3.0, -2.0).normalize();
    let aslant = Frame { origin: Vec3::new(0.0, -100.0, 0.0), x, y: z.cross(&x), z };
    let beside = Frame { origin: Vec3::new(0.0, -100.0, 0.0), ..Frame::world() };
    let afar = Frame { origin: Vec3::new(1e3, 500.0, 30.0), ..Frame::world() };
    for (frame, turn) in [(aslant, PI), (beside, PI), (afar, PI), (beside, 2.0 * PI)] {
        let cone = SupportSurface::Cone { frame, radius: 50.0, slope: -0.5 };
        for tolerance in [1.0, 0.02] {
            let out = panels(vec![Face::untrimmed(part(&cone, (0.0, turn), (0.0, 100.0)))], tolerance);
            assert_eq!(out.patchwork().panels.len(), 1, "{:?} {turn} {tolerance}", frame.origin);
        }
    }
}

/// Plants and ships are drawn about an origin far away.
#[test]
fn cylinders_and_cones_are_one_panel_however_far_away() {
    for away in [1e5, 1e6, 1e7] {
        let frame = Frame { origin: Vec3::new(away, -0.7 * away, 0.1 * away), ..Frame::world() };
        let pipe = SupportSurface::Cylinder { frame, radius: 20.0 };
        let cone = SupportSurface::Cone { frame, radius: 30.0, slope: -0.4 };
        for (surface, turn, height) in [(&pipe, 2.0 * PI, 50.0), (&pipe, 4.0, 50.0), (&cone, 2.0 * PI, 50.0)] {
            let out = panels(vec![Face::untrimmed(part(surface, (0.0, turn), (0.0, height)))], 0.1);
            assert_eq!(out.patchwork().panels.len(), 1, "{away} {turn}");
        }
        // Up to its tip a cone needs more digits than numbers have a kilometre away.
        if away < 1e6 {
            let out = panels(vec![Face::untrimmed(part(&cone, (0.0, 2.0 * PI), (0.0, 75.0)))], 0.1);
            assert_eq!(out.patchwork().panels.len(), 1, "{away}");
        }
    }
}

#[test]
fn a_solid_cone_is_its_sector_and_its_disc() {
    let k = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let corners = [[-400.0, -400.0], [-400.0, 400.0], [400.0, -400.0], [400.0, 400.0]];
    let plane = Surface::new(k.clone(), k, &corners.map(|[x, y]| Vec3::new(x, y, 0.0)), None).expect("a plane");
    let mut base = Face::untrimmed(plane);
    let around = |i: i32| 2.0 * PI * f64::from(i) / 720.0;
    base.loops = vec![TrimLoop {
        points: (0..720).map(|i| [0.5 + 0.375 * around(i).cos(), 0.5 + 0.375 * around(i).sin()]).collect(),
        edge: vec![0; 720],
    }];
    let out = panels(vec![to_the_tip(2.0 * PI), base], 0.1);
    assert_eq!(out.patchwork().panels.len(), 2);
}
