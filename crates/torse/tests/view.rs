//! From which side patterns are seen and which way their lines bend: the same whichever way a face or a strip was drawn.

use std::f64::consts::{FRAC_PI_2, TAU};
use torse::brep::face::{Face, TrimLoop};
use torse::brep::support_surface::SupportSurface;
use torse::control::Control;
use torse::develop::bends::BendSpacing;
use torse::develop::strip::StripOptions;
use torse::develop::view::Drawn;
use torse::geom::{Frame, Vec3};
use torse::patchwork::part::Part;
use torse::patchwork::pattern::{BendSense, Pattern, ViewSide};
use torse::pipeline::approximate::{of_faces, Options};
use torse::search::cover::{Layout, Limits};
use torse::search::strips::cut::cut;
use torse::spline::curve::Curve;
use torse::torse::form::PanelKind;
use torse::torse::strip::Strip;

fn changed(mut face: Face, change: impl FnOnce(&mut Face)) -> Face {
    change(&mut face);
    face
}

fn patterns(faces: Vec<Face>, drawn: Drawn) -> Vec<Pattern> {
    let options = Options {
        tolerance: 0.2,
        max_panels: None,
        input: "test".into(),
        limits: Limits::default(),
        layout: Layout::default(),
        meet: false,
        smooth_angle: 0.0,
        drawn,
    };
    of_faces(faces, Vec::new(), &options, &Control::default()).expect("an answer").patterns().to_vec()
}

/// A triangle with three different sides on a quarter of a cylinder.
fn shell() -> Face {
    let c = SupportSurface::Cylinder { frame: Frame::world(), radius: 100.0 };
    let surface = c.to_spline((0.0, FRAC_PI_2), (0.0, 120.0)).expect("a surface").0;
    let ((u0, u1), (v0, v1)) = surface.domain();
    let at = |s: f64, t: f64| [u0 + (u1 - u0) * s, v0 + (v1 - v0) * t];
    let points = vec![at(0.1, 0.1), at(0.9, 0.2), at(0.3, 0.9)];
    changed(Face::untrimmed(surface), |f| f.loops = vec![TrimLoop { points, edge: vec![0, 1, 2] }])
}

/// The same face drawn with u and v exchanged.
fn exchanged(f: &Face) -> Face {
    let mut loops = f.loops.clone();
    for l in &mut loops {
        l.points = l.points.iter().rev().map(|p| [p[1], p[0]]).collect();
    }
    changed(f.clone(), |g| {
        g.surface = f.surface.transposed();
        g.loops = loops;
    })
}

/// Lengths of the sides in their order around the pattern, the shortest first: mirrored parts have another order.
fn turning(p: &Pattern) -> Vec<i64> {
    let lengths: Vec<i64> = p.sides.iter().map(|s| (10.0 * s.length).round() as i64).collect();
    let least = (0..lengths.len()).min_by_key(|&k| lengths[k]).expect("sides");
    (0..lengths.len()).map(|k| lengths[(least + k) % lengths.len()]).collect()
}

/// The only sense in which a pattern bends.
fn sense(p: &Pattern) -> BendSense {
    let first = p.bends[0].sense;
    assert!(!p.bends.is_empty() && p.bends.len() == p.rulings.len() && p.bends.iter().all(|b| b.sense == first));
    first
}

#[test]
fn a_shell_looks_the_same_however_its_face_was_drawn() {
    let plain = shell();
    let reversed = changed(plain.clone(), |f| f.reversed = true);
    let other = exchanged(&plain);
    let both = changed(other.clone(), |f| f.reversed = true);
    let seen: Vec<Pattern> =
        [plain.clone(), reversed, other, both].into_iter().flat_map(|f| patterns(vec![f], Drawn::default())).collect();
    assert_eq!(seen.len(), 4);
    for p in &seen {
        assert_eq!((p.view, sense(p)), (ViewSide::Outside, BendSense::Down));
        assert_eq!(turning(p), turning(&seen[0]));
    }
    let inside = patterns(vec![plain.clone()], Drawn { view: ViewSide::Inside, ..Drawn::default() });
    assert_eq!((inside[0].view, sense(&inside[0])), (ViewSide::Inside, BendSense::Up));
    let (mut a, mut b) = (turning(&inside[0]), turning(&seen[0]));
    assert_ne!(a, b);
    a[1..].reverse();
    assert_eq!(a, b);
    b.clear();
    // Angle and radius of the lines; finer lines add up to the same turn.
    let turn = |p: &Pattern| p.bends.iter().map(|b| b.angle.to_degrees()).sum::<f64>();
    let corner = |k: usize| plain.surface.jet(plain.loops[0].points[k][0], plain.loops[0].points[k][1]).normal();
    let whole = corner(0).angle(&corner(1)).to_degrees();
    assert!((turn(&seen[0]) - whole).abs() < 0.1, "{} {whole}", turn(&seen[0]));
    assert!(seen[0].bends.iter().all(|b| b.radii.iter().all(|r| (r - 100.0).abs() < 0.1)));
    let fine = BendSpacing { step: 2.0f64.to_radians(), least: 0.001, ..BendSpacing::default() };
    let fine = patterns(vec![plain], Drawn { bends: fine, ..Drawn::default() });
    assert!(fine[0].bends.len() > seen[0].bends.len() && (turn(&fine[0]) - whole).abs() < 0.1);
}

#[test]
fn of_a_closed_body_outside_is_away_from_the_material() {
    // A pipe with a wall: two tubes and two rings, drawn any way.
    let tube = |radius: f64| {
        let c = SupportSurface::Cylinder { frame: Frame::world(), radius };
        Face::untrimmed(c.to_spline((0.0, TAU), (0.0, 120.0)).expect("a surface").0)
    };
    let ring = |z: f64, reversed: bool| {
        let frame = Frame { origin: Vec3::new(0.0, 0.0, z), ..Frame::world() };
        let (surface, _) = SupportSurface::Plane(frame).to_spline((-110.0, 110.0), (-110.0, 110.0)).expect("a surface");
        let circle = |r: f64, way: f64| {
            let corner = |k: usize| {
                let (s, c) = (way * TAU * k as f64 / 90.0).sin_cos();
                [r * c, r * s]
            };
            TrimLoop { points: (0..90).map(corner).collect(), edge: vec![0; 90] }
        };
        changed(Face::untrimmed(surface), |f| {
            f.reversed = reversed;
            f.loops = vec![circle(100.0, 1.0), circle(80.0, -1.0)];
        })
    };
    for flip in [false, true] {
        let mut faces = vec![tube(100.0), tube(80.0), ring(0.0, flip), ring(120.0, flip)];
        faces[0].reversed = flip;
        let found = patterns(faces, Drawn::default());
        assert_eq!(found.len(), 4);
        assert_eq!(sense(&found[0]), BendSense::Down, "the outer tube is seen from its convex side");
        assert_eq!(sense(&found[1]), BendSense::Up, "the inner tube is seen from its hollow side");
    }
}

#[test]
fn strips_look_the_same_whichever_rail_comes_first() {
    // A quarter of a cylinder between a circle and a slanting curve.
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let rail = |z: [f64; 3]| {
        let point = |x: f64, y: f64, z: f64, w: f64| [100.0 * w * x, 100.0 * w * y, w * z, w];
        let c = vec![point(1.0, 0.0, z[0], 1.0), point(1.0, 1.0, z[1], h), point(0.0, 1.0, z[2], 1.0)];
        Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], c).expect("a rail")
    };
    let (low, high) = (rail([0.0; 3]), rail([50.0, 80.0, 140.0]));
    let mut seen = Vec::new();
    for (a, b) in [(&low, &high), (&high, &low), (&low.reversed(), &high.reversed())] {
        let strip = Strip::between("s", PanelKind::Cylinder, a, b).expect("a strip");
        let whole = Part { name: "s".into(), first: 0, count: 1, missing: None };
        seen.extend(cut(&[strip], &[whole], &StripOptions::new(0.01)).1);
    }
    assert_eq!(seen.len(), 3);
    for p in &seen {
        assert_eq!((p.view, sense(p)), (ViewSide::Outside, BendSense::Down));
        assert_eq!(turning(p), turning(&seen[0]));
        let turn = p.bends.iter().map(|b| b.angle.to_degrees()).sum::<f64>();
        assert!((turn - 90.0).abs() < 0.1, "{turn}");
    }
}
