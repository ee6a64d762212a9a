//! Curves on faces that panels cover, and texts.

use super::curves::{curve, length, off, polyline, unrolled, TOLERANCE};
use super::model_of;
use crate::answer::note::{Note, UnrollNote};
use crate::brep::face::Face;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::control::Control;
use crate::develop::unfold::specimens::rectangle;
use crate::geom::{Vec2, Vec3};
use crate::io::model::Model;
use crate::patchwork::pattern::MarkLine;
use crate::pipeline::unroll::{unroll, UnrollOptions};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// A curve on a face that is covered by panels is drawn at the nearest places of these, and told of.
#[test]
fn a_curve_on_a_face_that_panels_cover_is_drawn_on_them() {
    let twist = 0.002;
    let at = |x: f64, y: f64| Vec3::new(x, y, twist * x * y);
    let corners = [at(0.0, 0.0), at(0.0, 80.0), at(100.0, 0.0), at(100.0, 80.0)];
    let knots = || Knots::clamped(1, &[0.0, 1.0]).expect("knots");
    let face = Face::untrimmed(Surface::new(knots(), knots(), &corners, None).expect("a surface"));
    let line = |y: f64| [at(10.0, y), at(90.0, y)];
    let beside = line(40.0).map(|p| p + Vec3::z());
    let curves = vec![curve("score", polyline(&line(30.0))), curve("beside", polyline(&beside))];
    let model = Model { curves, ..model_of(vec![face]) };
    let options = UnrollOptions { surfaces: true, approximate: Some(3.0), ..UnrollOptions::new(TOLERANCE) };
    let answer = unroll(&model, &options, &Control::default()).expect("an answer");
    let drawn: Vec<&MarkLine> = answer.patterns.iter().flat_map(|p| &p.curves).collect();
    let [a, b] = line(30.0);
    let whole: f64 = drawn.iter().map(|l| length(l)).sum();
    assert!((whole - (b - a).norm()).abs() < 0.01 * whole, "{whole} {drawn:?}");
    assert!(drawn.iter().any(|l| l.label == "score"));
    assert_eq!(off(&answer).iter().map(|c| c.curve.as_str()).collect::<Vec<_>>(), ["object 1 'beside'"]);
    let told = |n: &Note| matches!(n, Note::Unroll(UnrollNote::OnPanels { curves }) if curves.len() == 1);
    assert!(answer.notes.iter().any(told), "{:?}", answer.notes);
}

/// A text lies on the pattern where it lies on the face, in the same direction and size, in single strokes.
#[test]
fn a_text_stands_where_it_stands_on_the_face() {
    let (origin, x, y) = (Vec3::new(5.0, 6.0, 7.0), Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.8, 0.6, 0.0));
    let plate = rectangle(origin, 80.0 * x, 40.0 * y);
    let height = 4.0;
    let shape = FreeShape::Text { at: origin + x * 10.0 + y * 20.0, along: x, up: y * height };
    let text = FreeCurve { shape, ..curve("HI", Vec::new()) };
    let answer = unrolled(vec![plate], vec![text], true);
    let lines = &answer.patterns[0].curves;
    assert!(!lines.is_empty() && lines.iter().all(|l| l.label.is_empty()), "{lines:?}");
    // As long and high as the words are, and as far from a corner of the plate as on the face.
    let points: Vec<Vec2> = lines.iter().flat_map(|l| l.joints.iter().map(|j| j.point)).collect();
    let farthest = |from: &Vec2| points.iter().map(|p| (p - from).norm()).fold(0.0, f64::max);
    let wide = crate::draw::stroke_font::width("HI", height);
    let across = points.iter().map(farthest).fold(0.0, f64::max);
    assert!((across - wide.hypot(height)).abs() < 0.3, "{across} {wide}");
    let corners = answer.patterns[0].contours[0].vertices.iter().map(|v| v.point);
    let wanted = (10.0 + wide).hypot(20.0 + height);
    assert!(corners.into_iter().any(|c| (farthest(&c) - wanted).abs() < 0.3), "{wanted}");
    assert!(off(&answer).is_empty());
}

/// Annotations of STEP files are counted by kinds.
#[test]
fn annotations_of_step_files_are_told() {
    let more = "#9001=TEXT_LITERAL_WITH_EXTENT('','GRAIN',#9003,'baseline left',.RIGHT.,#9004,#9005);\n\
                #9002=(ANNOTATION_CURVE_OCCURRENCE()ANNOTATION_OCCURRENCE()LEADER_CURVE()STYLED_ITEM((),#9001));\n\
                #9006=(ANNOTATION_CURVE_OCCURRENCE()ANNOTATION_OCCURRENCE()LEADER_CURVE()STYLED_ITEM((),#9001));\n";
    let text = include_str!("../../../../../../data/bracket.step");
    let (before, after) = text.rsplit_once("ENDSEC;").expect("an end");
    let model = crate::io::cad::read(format!("{before}{more}ENDSEC;{after}").as_bytes()).expect("a model");
    let told: Vec<String> = model.notes.iter().map(crate::io::words::note).collect();
    assert!(told.iter().any(|n| n.contains("1 text and 2 leader lines")), "{told:?}");
}
