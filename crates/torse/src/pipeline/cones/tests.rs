//! Faces that become exact cones, and those that are none.

use super::*;
use crate::brep::face::TrimLoop;
use crate::brep::support_surface::SupportSurface;
use crate::certify::claim::Status;
use crate::geom::{Frame, Vec3};
use crate::io::model::unread;
use crate::io::words;
use crate::search::strips::cone_strip::tests::{face_point, slanting};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::cone::spline::Shape;

/// A cylinder over a parabola, ruled along y, as a face; `bent` lifts one corner line so that it is no developable.
fn face(lift: f64) -> Face {
    let points: Vec<Vec3> = (0..3)
        .flat_map(|i| {
            let x = 50.0 * f64::from(i);
            let z = if i == 1 { 40.0 } else { 0.0 };
            [Vec3::new(x, 0.0, z), Vec3::new(x, 100.0, z + if i == 2 { lift } else { 0.0 })]
        })
        .collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    Face::untrimmed(Surface::new(knots(2), knots(1), &points, None).expect("surface"))
}

#[test]
fn a_cylinder_becomes_certified_cylinders_and_files_parts_and_patterns_agree() {
    let options = ConesOptions::new(0.05, "test");
    let out = of_faces(&[face(0.0)], &[], &options, &Control::default()).expect("an answer");
    assert_eq!(out.status(), Status::Certified);
    let bodies = &out.cones.as_ref().expect("cones").bodies;
    assert_eq!(bodies.len(), 1);
    let [cones, cylinders, _] = bodies[0].spline.counts(100.0);
    assert!(cones == 0 && cylinders > 1 && out.patchwork.panels.len() == bodies[0].spline.segments.len());
    let area: f64 = out.patterns.iter().map(|p| p.area).sum();
    let surface: f64 = out.strips().map(Strip::area_estimate).sum();
    assert!((area - surface).abs() < 1e-3 * surface, "{area} {surface}");
}

#[test]
fn faces_that_are_no_developables_are_named() {
    let options = ConesOptions::new(0.05, "test");
    let error = of_faces(&[face(30.0)], &[], &options, &Control::default()).expect_err("hyperbolic");
    assert!(error.to_string().contains("not developable"), "{error}");
    let out = of_faces(&[face(30.0), face(0.0)], &[], &options, &Control::default()).expect("one of two");
    assert_eq!(out.skipped.len(), 1);
    // One surface of two is no answer that is certified, nor is what a reader left out.
    assert_eq!(out.status(), Status::Uncertified, "half of it is missing");
    let reason = words::reason(&out.claims, &[]);
    assert!(reason.contains("left out") && reason.contains("not developable"), "{reason}");
    let lost = unread(7, "unreadable", None);
    let out = of_faces(&[face(0.0)], &[lost], &options, &Control::default()).expect("the other");
    assert!(words::reason(&out.claims, &[]).contains("#7"), "{:?}", out.claims);
    let bad = ConesOptions { tolerance: f64::NAN, ..options };
    assert!(of_faces(&[face(0.0)], &[], &bad, &Control::default()).is_err());
}

#[test]
fn slanting_parts_beside_the_regression_curve_are_certified_and_trimmed() {
    let options = ConesOptions::new(0.2, "test");
    let out = of_faces(&[slanting()], &[], &options, &Control::default()).expect("an answer");
    assert_eq!(out.status(), Status::Certified);
    let bodies = &out.cones.as_ref().expect("cones").bodies;
    let part = bodies[0].part.as_ref().expect("trimmed");
    assert!(part.faces.len() > 1 && part.outline_estimate < 0.01, "{}", part.outline_estimate);
    // The area of the part is that of the region: |c' x (c' + ...)| by the midpoint rule.
    let area: f64 = out.patterns.iter().map(|p| p.area).sum();
    let n = 200;
    let mut expected = 0.0;
    for i in 0..n {
        let u = 0.2 + 0.8 * (f64::from(i) + 0.5) / f64::from(n);
        for j in 0..20 {
            let v = 0.7 - 0.5 * u + 0.25 * (f64::from(j) + 0.5) / 20.0;
            let h = 1e-5;
            let s = |u, v| face_point(u, v);
            let (du, dv) = (s(u + h, v) - s(u - h, v), s(u, v + h) - s(u, v - h));
            expected += du.cross(&dv).norm() / (4.0 * h * h) * (0.8 / f64::from(n)) * (0.25 / 20.0);
        }
    }
    assert!((area - expected).abs() < 5e-3 * expected, "{area} {expected}");
}

/// A full turn: the pipe of the examples with its holes, slit along one ruling, whose rims end where they begin.
#[test]
fn a_pipe_with_holes_is_one_cylinder_in_a_few_faces() {
    let pipe = crate::read(include_bytes!("../../../../../data/cylinder_holes.step")).expect("a model");
    let options = ConesOptions::new(0.1, "pipe");
    let out = of_faces(&pipe.faces, &pipe.skipped, &options, &Control::default()).expect("an answer");
    assert_eq!(out.status(), Status::Certified, "{}", words::reason(&out.claims, &[]));
    let bodies = &out.cones.as_ref().expect("cones").bodies;
    assert_eq!(counts(bodies), [0, 1, 0]);
    let part = bodies[0].part.as_ref().expect("trimmed");
    // Blanks turn by less than 120 degrees, or by as much.
    assert!((3..=4).contains(&part.faces.len()), "{}", part.faces.len());
    assert_eq!(out.patchwork.panels.len(), part.faces.len());
    for f in &part.faces {
        let Shape::Cylinder { radius, .. } = f.blank.segment.shape else { panic!("{:?}", f.blank.segment.shape) };
        assert!((radius.abs() - 250.0).abs() < 1e-6, "{radius}");
    }
    // Its flat part bends by as much between lines as was asked for, with its own radius, whatever the pieces are.
    for bend in &out.patterns[0].bends {
        assert!(bend.angle <= options.drawn.bends.step + 1e-9, "{bend:?}");
        assert!(bend.radii.iter().all(|r| (r - 250.0).abs() < 1e-6), "{bend:?}");
    }
    assert!(out.patterns[0].bends.len() >= 72, "{}", out.patterns[0].bends.len());
}

/// A disc touches the rulings at its ends in one point each.
#[test]
fn a_disc_is_a_certified_plane() {
    let knots = |p| Knots::clamped(p, &[-110.0, 110.0]).expect("knots");
    let at = |u: f64, v: f64| Vec3::new(u, v, 0.0);
    let corners = [at(-110.0, -110.0), at(-110.0, 110.0), at(110.0, -110.0), at(110.0, 110.0)];
    let mut face = Face::untrimmed(Surface::new(knots(1), knots(1), &corners, None).expect("surface"));
    let count = 240;
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
    let points = (0..count).map(|k| [100.0 * turn(k).cos(), 100.0 * turn(k).sin()]).collect();
    face.loops = vec![TrimLoop { points, edge: vec![0; count as usize] }];
    let options = ConesOptions::new(0.1, "disc");
    let out = of_faces(&[face], &[], &options, &Control::default()).expect("an answer");
    assert_eq!(out.status(), Status::Certified, "{}", words::reason(&out.claims, &[]));
    assert_eq!(counts(&out.cones.as_ref().expect("cones").bodies), [0, 0, 1]);
    // Its size is that of the arcs, not of the points where they meet.
    let [length, width] = [out.patterns[0].length, out.patterns[0].width];
    assert!((length - 200.0).abs() < 0.2 && (width - 200.0).abs() < 0.2, "{length} {width}");
}

#[test]
fn a_cylinder_of_a_full_turn_is_that_cylinder() {
    let tube = SupportSurface::Cylinder { frame: Frame::world(), radius: 100.0 };
    let (surface, _) = tube.to_spline((0.0, std::f64::consts::TAU), (0.0, 300.0)).expect("a cylinder");
    let options = ConesOptions::new(0.1, "test");
    let mut out = of_faces(&[Face::untrimmed(surface)], &[], &options, &Control::default()).expect("an answer");
    assert_eq!((out.patchwork.panels.len(), out.parts.len()), (1, 1));
    let files = crate::files(&mut out, "2026-01-31T12:00:00").expect("files");
    assert_eq!(out.status(), Status::Certified, "{}", words::reason(&out.claims, &[]));
    let step = files.iter().find(|f| f.0 == "cones.step").map(|f| String::from_utf8_lossy(&f.1).into_owned());
    let step = step.expect("cones.step");
    let count = |word: &str| step.matches(word).count();
    assert_eq!(["ADVANCED_FACE(", "CYLINDRICAL_SURFACE(", "EDGE_CURVE(", "VERTEX_POINT("].map(count), [1, 1, 3, 2]);
    // A cylinder that is wider, or a circle, is another one.
    let at = step.find("CYLINDRICAL_SURFACE(").expect("a cylinder");
    let end = at + step[at..].find(')').expect("its end");
    let radius = step[..end].rfind(',').expect("its radius");
    let moved = format!("{},100.001{}", &step[..radius], &step[end..]);
    let panels = crate::io::bundle::CONES.to_owned();
    crate::pipeline::deliver::judge(&mut out, &[(panels, moved.into_bytes())]);
    assert_eq!(out.status(), Status::Uncertified);
}

#[test]
fn a_cone_that_reaches_its_tip_is_that_cone() {
    for turn in [3.0, std::f64::consts::TAU] {
        let cone = SupportSurface::Cone { frame: Frame::world(), radius: 100.0, slope: -0.5 };
        let (surface, _) = cone.to_spline((0.0, turn), (0.0, 200.0)).expect("a cone");
        let options = ConesOptions::new(0.1, "test");
        let mut out = of_faces(&[Face::untrimmed(surface)], &[], &options, &Control::default()).expect("an answer");
        let files = crate::files(&mut out, "2026-01-31T12:00:00").expect("files");
        assert_eq!(out.status(), Status::Certified, "{}", words::reason(&out.claims, &[]));
        let step = files.iter().find(|f| f.0 == "cones.step").map(|f| String::from_utf8_lossy(&f.1).into_owned());
        assert_eq!(step.expect("cones.step").matches("CONICAL_SURFACE(").count(), 1);
        let slant = 200.0 * 1.25f64.sqrt();
        let area = 0.5 * slant * slant * turn * (0.5 / 1.25f64.sqrt());
        let flat: f64 = out.patterns.iter().map(|p| p.area).sum();
        assert!((flat - area).abs() < 0.1 * slant, "{flat} {area}");
    }
}

/// Files have digits enough for the sides of a slit, but not for their angles beside the tip; and not quite for a whole turn.
#[test]
fn a_cone_whose_slit_is_as_uncertain_as_files_are_is_that_cone() {
    let whole = std::f64::consts::TAU;
    for (turn, astray) in [(whole - 1.7e-9, 0.0), (whole - 1.7e-9, 2.7e-8), (4.0, 2.7e-8), (4.0, -2.7e-8)] {
        let cone = SupportSurface::Cone { frame: Frame::world(), radius: 200.0, slope: -0.5 };
        let (surface, _) = cone.to_spline((0.0, turn + f64::abs(astray)), (0.0, 400.0)).expect("a cone");
        let ((u0, u1), (v0, v1)) = surface.domain();
        let mut face = Face::untrimmed(surface);
        // The base ends beside the tip, on either side.
        let [base, tip] = [f64::max(astray, 0.0), f64::max(-astray, 0.0)].map(|off| u1 - off);
        let points = vec![[u0, v0], [base, v0], [tip, v1], [u0, v1]];
        face.loops = vec![TrimLoop { points, edge: vec![0, 1, 2, 3] }];
        let options = ConesOptions::new(0.1, "test");
        let mut out = of_faces(&[face], &[], &options, &Control::default()).expect("an answer");
        let files = crate::files(&mut out, "2026-01-31T12:00:00").expect("files");
        assert_eq!(out.status(), Status::Certified, "{turn} {}", words::reason(&out.claims, &[]));
        let step = files.iter().find(|f| f.0 == "cones.step").map(|f| String::from_utf8_lossy(&f.1).into_owned());
        assert_eq!(step.expect("cones.step").matches("CONICAL_SURFACE(").count(), 1);
        // What is written is closed where it fails to be a whole turn by less than numbers of its size show.
        let moved = out.written.iter().filter(|w| w.0 == "cones.step").map(|w| w.1.bound()).fold(0.0, f64::max);
        assert!(moved < 1e-6, "{turn} {moved}");
    }
}

/// Copies of chains hold the same faces as the exact ones, trimmed like them.
#[test]
fn copies_of_trimmed_chains_in_other_formats_have_their_area() {
    let model = crate::read(include_bytes!("../../../../../data/cone_holes.step")).expect("a model");
    let mut out = of_faces(&model.faces, &[], &ConesOptions::new(0.5, "test"), &Control::default()).expect("an answer");
    (out.cut.iges, out.cut.threedm) = (true, true);
    let shown = crate::answer::presentation::present(&out);
    let files = crate::io::bundle::geometry(&out, &shown, "2026-11-21T14:30:00").expect("files");
    let area = |name: &str| {
        let bytes = &files.iter().find(|f| f.0 == name).unwrap_or_else(|| panic!("no {name}")).1;
        let model = crate::read(bytes).expect(name);
        let faces = model.faces.iter().map(crate::brep::area::area_estimate).sum::<f64>();
        (model.faces.len(), faces)
    };
    let exact = area("cones.step");
    for name in ["panels.igs", "panels.3dm"] {
        let copy = area(name);
        assert!(copy.0 == exact.0 && (copy.1 / exact.1 - 1.0).abs() < 1e-5, "{name}: {copy:?} {exact:?}");
    }
}
