//! Curves of the model on faces whose flat images are known.

use super::model_of;
use crate::answer::note::{Note, OffFaces, UnrollNote};
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::brep::space_curve::SpaceCurve;
use crate::certify::claim::Status;
use crate::control::Control;
use crate::develop::unfold::specimens::{quarter, rectangle, round_surface, BentSheet, Stretch};
use crate::draw::flat::line_points;
use crate::geom::{Frame, Vec2, Vec3};
use crate::io::model::Model;
use crate::io::{drawings, dxf, words};
use crate::patchwork::pattern::MarkLine;
use crate::pipeline::unroll::{groups, unroll, UnrollOptions};
use crate::spline::curve::Curve;
use crate::torse::rail::Rail;
use std::f64::consts::TAU;

pub(super) const TOLERANCE: f64 = 0.01;

pub(super) fn curve(name: &str, pieces: Vec<Curve<4>>) -> FreeCurve {
    let (item, layer) = ("object 1".into(), "scribe".into());
    FreeCurve { item, name: name.into(), layer, shape: FreeShape::Curve(pieces) }
}

pub(super) fn polyline(points: &[Vec3]) -> Vec<Curve<4>> {
    Rail::polyline("line", points).expect("a line").pieces
}

/// An arc from `x` towards `y`.
fn arc(origin: Vec3, [x, y]: [Vec3; 2], radius: f64, turn: f64) -> Curve<4> {
    let frame = Frame { origin, x, y, z: x.cross(&y) };
    SpaceCurve::Ellipse { frame, a: radius, b: radius }.to_spline(0.0, turn).expect("an arc").0
}

pub(super) fn unrolled(faces: Vec<Face>, curves: Vec<FreeCurve>, surfaces: bool) -> Answer {
    let model = Model { curves, ..model_of(faces) };
    let options = UnrollOptions { surfaces, ..UnrollOptions::new(TOLERANCE) };
    unroll(&model, &options, &Control::default()).expect("an answer")
}

/// Points close to each other along a line.
fn points(line: &MarkLine) -> Vec<Vec2> {
    line_points(line, 1e-4)
}

pub(super) fn length(line: &MarkLine) -> f64 {
    points(line).windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

pub(super) fn off(answer: &Answer) -> Vec<OffFaces> {
    let found = answer.notes.iter().find_map(|n| match n {
        Note::Unroll(UnrollNote::OffFaces { curves }) => Some(curves.clone()),
        _ => None,
    });
    found.unwrap_or_default()
}

/// Circles, slots and lines on a plane face are what they are, in pattern and drawing.
#[test]
fn circles_and_lines_on_a_plane_are_circles_and_lines() {
    let plate = rectangle(Vec3::zeros(), 90.0 * Vec3::x(), 60.0 * Vec3::y());
    let axes = [Vec3::x(), Vec3::y()];
    let circle = curve("circle", vec![arc(Vec3::new(20.0, 30.0, 0.0), axes, 8.0, TAU)]);
    let line = curve("line", polyline(&[Vec3::new(40.0, 10.0, 0.0), Vec3::new(80.0, 50.0, 0.0)]));
    let quarter = curve("quarter", vec![arc(Vec3::new(60.0, 10.0, 0.0), axes, 20.0, 0.25 * TAU)]);
    let answer = unrolled(vec![plate], vec![circle, line, quarter], true);
    let [circle, line, quarter] = answer.patterns[0].curves.as_slice() else { panic!("three lines") };
    let (_, radius) = circle.contour().circle().expect("a circle");
    assert!(circle.closed && (radius - 8.0).abs() < 1e-6, "{radius}");
    assert_eq!((line.joints.len(), line.joints[0].bulge), (2, 0.0));
    assert!(quarter.joints.len() == 2 && (quarter.joints[0].bulge.abs() - (0.0625 * TAU).tan()).abs() < 1e-6);
    let told =
        |n: &Note| matches!(n, Note::Unroll(UnrollNote::Carried { deviation, .. }) if *deviation < 0.1 * TOLERANCE);
    assert!(answer.notes.iter().any(told), "{:?}", answer.notes);
}

/// From a flange on over the cylinder that it touches, rising as steeply: one straight line.
#[test]
fn a_helix_becomes_a_straight_line_across_the_bend() {
    let cylinder = quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0);
    let flange = rectangle(Vec3::new(50.0, -20.0, 0.0), 20.0 * Vec3::y(), 30.0 * Vec3::z());
    let helix: Vec<Vec3> = (0..=100)
        .map(|k| {
            let turn = 0.008 * f64::from(k);
            Vec3::new(50.0 * turn.cos(), 50.0 * turn.sin(), 10.0 + 50.0 * turn / 3.0)
        })
        .collect();
    let mut pieces = polyline(&[Vec3::new(50.0, -15.0, 5.0), Vec3::new(50.0, 0.0, 10.0)]);
    pieces.extend(Rail::through("helix", &helix).expect("a helix").pieces);
    let answer = unrolled(vec![cylinder, flange], vec![curve("weld", pieces)], true);
    assert_eq!(answer.status(), Status::Certified);
    let [line] = answer.patterns[0].curves.as_slice() else { panic!("{:?}", answer.patterns[0].curves) };
    assert_eq!(line.label, "weld");
    let (a, b) = (line.joints[0].point, line.joints[line.joints.len() - 1].point);
    let straight = 55f64.hypot(55.0 / 3.0);
    assert!(((b - a).norm() - straight).abs() < TOLERANCE, "{} {straight}", (b - a).norm());
    assert!((length(line) - straight).abs() < TOLERANCE);
    // Drawn with few joints, and there in the file.
    assert!(line.joints.len() < 5, "{line:?}");
    let options = crate::draw::drawing::DrawingOptions::default();
    let drawing = crate::draw::drawing::drawing(&answer.patterns, &[], &[], &options);
    let bytes = dxf::write(&drawing).expect("a drawing");
    let pieces = drawings::dxf(&bytes).expect("a drawing");
    assert!(crate::certify::written::drawing(&answer.patterns, &pieces).bound() < 1e-6);
    assert!(String::from_utf8_lossy(&bytes).contains("MARK_CURVE"));
    assert!(off(&answer).is_empty());
}

/// A circle around a cone that is cut open: an arc about its apex, as long as the circle.
#[test]
fn a_circle_around_a_cone_becomes_an_arc_about_its_apex() {
    let (slope, at) = (0.5, 10.0);
    let cone = round_surface(30.0, slope, (0.0, 25.0));
    let radius = 30.0 + slope * at;
    let circle = arc(Vec3::z() * at, [Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.8, 0.6, 0.0)], radius, TAU);
    let away = FreeCurve { layer: "other".into(), shape: FreeShape::Point(Vec3::zeros()), ..curve("", Vec::new()) };
    let answer = unrolled(vec![cone], vec![curve("", vec![circle]), away], true);
    let lines = &answer.patterns[0].curves;
    // It begins beside the cut.
    assert_eq!(lines.len(), 2);
    assert_eq!([lines[0].label.as_str(), lines[1].label.as_str()], ["scribe", ""]);
    let whole: f64 = lines.iter().map(length).sum();
    assert!((whole - TAU * radius).abs() < 0.002 * whole, "{whole} {}", TAU * radius);
    let slant = radius / slope.atan().sin();
    // Arcs, and no more than half of a turn asks for.
    assert!(lines.iter().all(|l| l.joints.len() <= 5 && l.joints[0].bulge != 0.0), "{lines:?}");
    let (first, second) = (points(&lines[0]), points(&lines[1]));
    let longest = if first.len() > second.len() { &first } else { &second };
    let points: Vec<Vec2> = [&first[..], &second[..]].concat();
    let (a, b, c) = (longest[0], longest[longest.len() / 2], longest[longest.len() - 1]);
    // The centre of the circle through three points.
    let (u, v) = (b - a, c - a);
    let (p, q) = (u.norm_squared(), v.norm_squared());
    let centre = a + Vec2::new(v.y * p - u.y * q, u.x * q - v.x * p) / (2.0 * u.perp(&v));
    assert!(points.iter().all(|x| ((x - centre).norm() - slant).abs() < TOLERANCE), "{slant}");
}

/// On either skin of a bent sheet a curve is as long as the neutral fibre, and at the same place; the other side is named.
#[test]
fn a_curve_over_a_bend_is_as_long_as_the_neutral_fibre() {
    let sheet =
        BentSheet::new(2.0, &[Stretch::Line(40.0), Stretch::Bend(1.0, 3.0), Stretch::Line(20.0)], &[0.0, 9.0], &[]);
    let skin = |above: f64, radius: f64| {
        let (sin, cos) = 1f64.sin_cos();
        let centre = Vec3::new(40.0, 4.0, 5.0);
        let mut pieces = polyline(&[Vec3::new(10.0, 4.0, above), Vec3::new(40.0, 4.0, above)]);
        pieces.push(arc(centre, [-Vec3::z(), Vec3::x()], radius, 1.0));
        let end = centre + Vec3::new(sin, 0.0, -cos) * radius;
        pieces.extend(polyline(&[end, end + Vec3::new(cos, 0.0, sin) * 10.0]));
        curve(&format!("at {above}"), pieces)
    };
    let answer = unrolled(sheet.faces(), vec![skin(0.0, 5.0), skin(2.0, 3.0)], false);
    assert_eq!(answer.status(), Status::Certified);
    let [line, other] = answer.patterns[0].curves.as_slice() else { panic!("{:?}", answer.patterns[0].curves) };
    let neutral = 30.0 + (3.0 + 0.44 * 2.0) + 10.0;
    for line in [line, other] {
        assert!((length(line) - neutral).abs() < TOLERANCE && line.joints.len() < 6, "{line:?}");
    }
    assert_eq!([line.label.as_str(), other.label.as_str()], ["at 0", "at 2 (other side)"]);
    let ends = |l: &MarkLine| [l.joints[0].point, l.joints[l.joints.len() - 1].point];
    assert!(ends(line).iter().zip(ends(other)).all(|(p, q)| (p - q).norm() < TOLERANCE), "{line:?} {other:?}");
    assert!(off(&answer).is_empty());
    let sentences: Vec<String> = answer.notes.iter().map(words::note).collect();
    assert!(sentences.iter().any(|s| s.contains("other side") && s.contains("'at 2'")), "{sentences:?}");
    // As far before the sheet as the other skin is behind it, and half way between both, is on neither.
    let answer = unrolled(sheet.faces(), vec![skin(-2.0, 7.0), skin(1.0, 4.0)], false);
    assert!(answer.patterns[0].curves.is_empty());
    assert_eq!(off(&answer).len(), 2);
}

/// Curves that lie on faces in part, beside them or along their edges, and points.
#[test]
fn what_lies_on_no_face_is_named() {
    let plate = rectangle(Vec3::zeros(), 40.0 * Vec3::x(), 30.0 * Vec3::y());
    let half = curve("half", polyline(&[Vec3::new(20.0, 10.0, 0.0), Vec3::new(60.0, 10.0, 0.0)]));
    let beside = curve("beside", polyline(&[Vec3::new(5.0, 5.0, 3.0), Vec3::new(15.0, 5.0, 3.0)]));
    let edge = curve("edge", polyline(&[Vec3::zeros(), Vec3::new(40.0, 0.0, 0.0)]));
    let point = |name: &str, at: Vec3| FreeCurve { shape: FreeShape::Point(at), ..curve(name, Vec::new()) };
    let through = curve("through", polyline(&[Vec3::new(30.0, 5.0, -4.0), Vec3::new(31.0, 5.0, 4.0)]));
    let points = [point("P1", Vec3::new(30.0, 20.0, 0.0)), point("P2", Vec3::new(30.0, 20.0, 7.0))];
    let answer = unrolled(vec![plate], [vec![half, beside, edge, through], points.to_vec()].concat(), true);
    let lines = &answer.patterns[0].curves;
    assert_eq!(lines.iter().map(|l| l.label.as_str()).collect::<Vec<_>>(), ["half", "P1", ""]);
    assert!((length(&lines[0]) - 20.0).abs() < 2.0 * TOLERANCE, "{:?}", lines[0]);
    let middle = |k: usize| (lines[k].joints[0].point + lines[k].joints[1].point) * 0.5;
    assert!((middle(1) - middle(2)).norm() < 1e-9);
    let named = off(&answer);
    let told: Vec<(&str, f64)> = named.iter().map(|o| (o.curve.as_str(), o.farthest.round())).collect();
    assert_eq!(
        told,
        [("object 1 'half'", 20.0), ("object 1 'beside'", 3.0), ("object 1 'through'", 4.0), ("object 1 'P2'", 7.0)]
    );
    assert!((named[0].off - 20.0).abs() < 1.0 && (named[0].length - 40.0).abs() < 1e-9, "{:?}", named[0]);
    let sentences: Vec<String> = answer.notes.iter().map(words::note).collect();
    assert!(sentences.iter().any(|s| s.contains("run along outlines") && s.contains("'edge'")), "{sentences:?}");
    assert!(sentences.iter().any(|s| s.contains("1 curve and 1 point of the model")), "{sentences:?}");
}

/// In groups of bodies every curve goes with the body that it lies on.
#[test]
fn curves_go_with_the_group_whose_faces_they_lie_on() {
    let plate = |at: f64, body: u32| {
        let mut face = rectangle(Vec3::new(at, 0.0, 0.0), 10.0 * Vec3::x(), 10.0 * Vec3::y());
        face.body = body;
        face
    };
    let line = |at: f64| curve("", polyline(&[Vec3::new(at + 2.0, 2.0, 0.0), Vec3::new(at + 8.0, 8.0, 0.0)]));
    let model = Model { curves: vec![line(0.0), line(50.0)], ..model_of(vec![plate(0.0, 1), plate(50.0, 2)]) };
    let groups = groups(model, 1, TOLERANCE, true);
    assert_eq!(groups.iter().map(|g| g.curves.len()).collect::<Vec<_>>(), [1, 1]);
}

/// A set of curves and points beside the solid of a file, with a layer.
#[test]
fn curves_of_step_sets_are_read_where_they_are_put() {
    let more = "#9001=CARTESIAN_POINT('',(1.,2.,0.));\n#9002=CARTESIAN_POINT('',(11.,2.,0.));\n\
                #9003=POLYLINE('score',(#9001,#9002));\n#9004=CARTESIAN_POINT('P',(5.,6.,0.));\n\
                #9005=GEOMETRIC_CURVE_SET('',(#9003,#9004));\n\
                #9006=GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('',(#9005),#13);\n\
                #9007=PRESENTATION_LAYER_ASSIGNMENT('engrave','',(#9003));\n";
    let text = include_str!("../../../../../../data/bracket.step");
    let (before, after) = text.rsplit_once("ENDSEC;").expect("an end");
    let model = crate::io::cad::read(format!("{before}{more}ENDSEC;{after}").as_bytes()).expect("a model");
    let called: Vec<(String, &str)> = model.curves.iter().map(|c| (c.called(), c.layer.as_str())).collect();
    assert_eq!(called, [("#9003 'score'".to_owned(), "engrave"), ("#9004 'P'".to_owned(), "")]);
    let FreeShape::Curve(pieces) = &model.curves[0].shape else { panic!("a curve") };
    assert_eq!(pieces[0].point(pieces[0].domain().1)[..3], [11.0, 2.0, 0.0]);
    assert_eq!(model.curves[1].shape, FreeShape::Point(Vec3::new(5.0, 6.0, 0.0)));
    assert!(model.skipped.is_empty() && model.faces.iter().all(|f| f.entity < 9000));
}
