//! Sections of parts of several faces, of closed faces and of bodies of sheet, against closed forms.

use super::{box_faces, model_of};
use crate::answer::note::{Note, ShopNote};
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::control::Control;
use crate::develop::arcs::points_along;
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::specimens::{quarter, rectangle, rolled_cone, round_surface, BentSheet, Stretch};
use crate::geom::polygon::{distance, inside};
use crate::geom::{Vec2, Vec3};
use crate::io::model::Model;
use crate::patchwork::pattern::{BendSense, ContourVertex, MarkLine};
use crate::pipeline::unroll::{unroll, UnrollOptions};
use crate::pipeline::workshop::{prepare, Stations, WorkshopOptions};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) const TOLERANCE: f64 = 1e-3;
pub(super) const PLACE: f64 = 1e-6;

/// Planes square to a direction at one distance (mm) from the origin.
fn cut(normal: Vec3, at: f64) -> Stations {
    Stations { normal: normal.normalize(), name: "s".into(), from: at, to: at, step: 1.0 }
}

/// The answer for a model with its work: surfaces without thickness, or of a sheet, or with `surfaces` false bodies.
pub(super) fn worked(model: &Model, options: UnrollOptions, asked: WorkshopOptions) -> Answer {
    let mut answer = unroll(model, &options, &Control::default()).expect("an answer");
    prepare(&mut answer, &asked).expect("its work");
    let told = |n: &Note| matches!(n, Note::Shop(ShopNote::NoPlaces { .. } | ShopNote::Unknown { .. }));
    assert!(!answer.notes.iter().any(told), "{:?}", answer.notes);
    answer
}

fn marked(faces: Vec<Face>, surfaces: bool, stations: Vec<Stations>) -> Answer {
    let options = UnrollOptions { surfaces, ..UnrollOptions::new(TOLERANCE) };
    let answer = worked(&model_of(faces), options, WorkshopOptions { stations, ..WorkshopOptions::default() });
    // Marks lie in the pattern.
    for pattern in &answer.patterns {
        let outline = |v: &[ContourVertex]| {
            (0..v.len()).flat_map(|k| points_along(&v[k].point, &v[(k + 1) % v.len()].point, v[k].bulge, 64)).collect()
        };
        let loops: Vec<Vec<Vec2>> = pattern.contours.iter().map(|c| outline(&c.vertices)).collect();
        for q in pattern.sections.iter().flat_map(along) {
            assert!(inside(&loops, &q) || distance(&loops, &q) < TOLERANCE, "{q:?}");
        }
    }
    answer
}

/// Points of a mark.
fn along(line: &MarkLine) -> Vec<Vec2> {
    line.joints.windows(2).flat_map(|w| points_along(&w[0].point, &w[1].point, w[0].bulge, 16)).collect()
}

/// Length of a mark, arcs and all.
fn length(line: &MarkLine) -> f64 {
    let piece = |w: &[ContourVertex]| {
        let (chord, half) = ((w[1].point - w[0].point).norm(), 2.0 * w[0].bulge.abs().atan());
        if half > 0.0 {
            chord * half / half.sin()
        } else {
            chord
        }
    };
    line.joints.windows(2).map(piece).sum()
}

pub(super) fn near(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within, "{a} {b}");
}

#[test]
fn a_pipe_is_marked_along_its_rulings_and_by_a_sine() {
    let (radius, height, slope) = (50.0, 100.0, 0.4);
    let pipe = || vec![round_surface(radius, 0.0, (0.0, height))];
    // x = 25 meets it in the rulings at ±60°.
    let answer = marked(pipe(), true, vec![cut(Vec3::x(), 25.0)]);
    let lines = &answer.patterns[0].sections;
    assert_eq!(lines.len(), 2);
    lines.iter().for_each(|l| near(length(l), height, PLACE));
    let places = [0, 1].map(|k| 0.5 * (lines[k].joints[0].point + lines[k].joints[1].point));
    let apart = (places[0] - places[1]).norm();
    near((apart - PI * radius).abs(), PI * radius - radius * TAU / 3.0, PLACE);
    // An oblique plane meets it in a sine from seam to seam.
    let answer = marked(pipe(), true, vec![cut(Vec3::new(-slope, 0.0, 1.0), 50.0 / (1.0 + slope * slope).sqrt())]);
    let [line] = answer.patterns[0].sections.as_slice() else { panic!("{:?}", answer.patterns[0].sections) };
    let (first, last) = (line.joints[0].point, line.joints[line.joints.len() - 1].point);
    near((last - first).norm(), TAU * radius, PLACE);
    let rows = line.joints.len();
    let a = nalgebra::DMatrix::from_fn(rows, 3, |i, j| {
        let angle = line.joints[i].point.x / radius;
        [1.0, angle.cos(), angle.sin()][j]
    });
    let b = nalgebra::DVector::from_fn(rows, |i, _| line.joints[i].point.y);
    let found = a.clone().svd(true, true).solve(&b, 0.0).expect("a fit");
    assert!((&a * &found - &b).amax() < PLACE, "{}", (&a * &found - &b).amax());
    near(found[1].hypot(found[2]), radius * slope, PLACE);
    // Between its joints the line keeps to the tolerance, too.
    let off = |q: &Vec2| {
        let angle = q.x / radius;
        (q.y - found[0] - found[1] * angle.cos() - found[2] * angle.sin()).abs()
    };
    assert!(along(line).iter().map(off).fold(0.0, f64::max) < TOLERANCE);
}

#[test]
fn a_closed_cone_is_marked_by_arcs() {
    let (radius, slope) = (20.0, 0.3_f64);
    let answer = marked(vec![round_surface(radius, slope, (0.0, 40.0))], true, vec![cut(Vec3::z(), 10.0)]);
    let [line] = answer.patterns[0].sections.as_slice() else { panic!("{:?}", answer.patterns[0].sections) };
    near(length(line), TAU * (radius + 10.0 * slope), PLACE);
    // All joints are as far from the apex.
    let slant = (radius + 10.0 * slope) / slope.atan().sin();
    line.joints.iter().for_each(|j| near(j.point.norm(), slant, PLACE));
    // A plane through the axis meets it in two rulings.
    let answer =
        marked(vec![round_surface(radius, slope, (0.0, 40.0))], true, vec![cut(Vec3::new(0.6, 0.8, 0.0), 0.0)]);
    assert_eq!(answer.patterns[0].sections.len(), 2);
    // They end at chords of the outline, whose arcs are drawn within the tolerance.
    answer.patterns[0].sections.iter().for_each(|l| near(length(l), 40.0 * 1.0_f64.hypot(slope), 0.2 * TOLERANCE));
}

/// A duct of four planes and four quarters of cylinders about z.
fn duct((a, b): (f64, f64), r: f64, h: f64) -> Vec<Face> {
    let (x, y, up) = (0.5 * a, 0.5 * b, Vec3::z() * h);
    let corner = |p: f64, q: f64, start: Vec3| quarter(Vec3::new(p, q, 0.0), Vec3::z(), start * r, h);
    vec![
        rectangle(Vec3::new(-x, -y - r, 0.0), Vec3::x() * a, up),
        corner(x, -y, -Vec3::y()),
        rectangle(Vec3::new(x + r, -y, 0.0), Vec3::y() * b, up),
        corner(x, y, Vec3::x()),
        rectangle(Vec3::new(x, y + r, 0.0), -Vec3::x() * a, up),
        corner(-x, y, Vec3::y()),
        rectangle(Vec3::new(-x - r, y, 0.0), -Vec3::y() * b, up),
        corner(-x, -y, -Vec3::x()),
    ]
}

#[test]
fn a_duct_of_planes_and_bends_is_marked_in_one_line() {
    let ((a, b), r, h, k) = ((80.0, 60.0), 15.0, 200.0, 0.3);
    let level = marked(duct((a, b), r, h), true, vec![cut(Vec3::z(), 70.0)]);
    assert_eq!(level.patterns.len(), 1);
    let [line] = level.patterns[0].sections.as_slice() else { panic!("{:?}", level.patterns[0].sections) };
    near(length(line), 2.0 * (a + b) + TAU * r, PLACE);
    let (first, last) = (line.joints[0].point, line.joints[line.joints.len() - 1].point);
    near((last - first).norm(), length(line), PLACE);
    // z = 100 + k x: straight on the planes, sines on the bends; lengths are kept.
    let plane = cut(Vec3::new(-k, 0.0, 1.0), 100.0 / (1.0 + k * k).sqrt());
    let oblique = marked(duct((a, b), r, h), true, vec![plane]);
    let [line] = oblique.patterns[0].sections.as_slice() else { panic!("{:?}", oblique.patterns[0].sections) };
    let steps = 2000;
    let speed = |i: usize| r * 1.0_f64.hypot(k * (FRAC_PI_2 * i as f64 / steps as f64).sin());
    let arc = (1..steps).map(speed).sum::<f64>() + 0.5 * (speed(0) + speed(steps));
    let whole = 2.0 * a * 1.0_f64.hypot(k) + 2.0 * b + 4.0 * arc * FRAC_PI_2 / steps as f64;
    near(length(line), whole, 1e-4);
    let (first, last) = (line.joints[0].point, line.joints[line.joints.len() - 1].point);
    near((last - first).norm(), 2.0 * (a + b) + TAU * r, PLACE);
    // A plane along an edge that two faces share marks it once.
    let edge = marked(duct((a, b), r, h), true, vec![cut(Vec3::x(), 0.5 * a)]);
    let on_edge = &edge.patterns[0].sections;
    assert!((1..=2).contains(&on_edge.len()), "{on_edge:?}");
    on_edge.iter().for_each(|l| near(length(l), h, PLACE));
}

#[test]
fn a_section_of_a_body_of_sheet_goes_on_through_its_bends() {
    let (t, r, angle, w) = (2.0, 3.0, 1.2, 30.0);
    let profile = [Stretch::Line(40.0), Stretch::Bend(angle, r), Stretch::Line(25.0)];
    let bracket = || BentSheet::new(t, &profile, &[0.0, w], &[]).faces();
    let answer = marked(bracket(), false, vec![cut(Vec3::y(), 10.0)]);
    let [line] = answer.patterns[0].sections.as_slice() else { panic!("{:?}", answer.patterns[0].sections) };
    assert_eq!(line.joints.len(), 2);
    near(length(line), 40.0 + (r + KFactor::default().share(r / t) * t) * angle + 25.0, PLACE);
    // The plane that halves the bend meets it in its line.
    let (sin, cos) = (0.5 * angle).sin_cos();
    let normal = Vec3::new(cos, 0.0, sin);
    let answer = marked(bracket(), false, vec![cut(normal, normal.dot(&Vec3::new(40.0, 0.0, r + t)))]);
    let [line] = answer.patterns[0].sections.as_slice() else { panic!("{:?}", answer.patterns[0].sections) };
    let [p, q] = answer.sheets[0].bends[0].lines[0];
    let [a, b] = [line.joints[0].point, line.joints[1].point];
    near(((a - p).norm() + (b - q).norm()).min((a - q).norm() + (b - p).norm()), 0.0, PLACE);
    // A rolled cone is marked at the neutral fibre of its skin.
    let (t, k, radius, slope, height, turn) = (2.0, 0.44, 20.0, 0.5_f64, 60.0, 1.8);
    let answer = marked(rolled_cone(t, (radius, slope), height, turn), false, vec![cut(Vec3::z(), 30.0)]);
    let [line] = answer.patterns[0].sections.as_slice() else { panic!("{:?}", answer.patterns[0].sections) };
    let cos = slope.atan().cos();
    let above = if answer.sheets[0].bends[0].sense == BendSense::Up { 0.0 } else { t / cos - t * cos };
    near(length(line), turn * (radius + slope * 30.0 + k * t * cos + above), PLACE);
    // Its roll radii are those of the inside.
    let work = &answer.shop.work[0];
    assert_eq!((work.roll.len(), work.panels.len()), (25, 1));
    for s in &work.roll {
        let [small, large] = s.radii;
        let (small, large) = (small.min(large), small.max(large));
        // The skin that is drawn may end a little higher or lower than the other one.
        assert!(
            (small - radius / cos).abs() < 0.1 * t + 1.0 && (large - (radius + slope * height) / cos).abs() < 2.0,
            "{s:?}"
        );
    }
}

#[test]
fn a_section_crosses_sharp_bends() {
    // A box is cut open along seven edges; z = 12 meets four sides.
    let answer = marked(box_faces().to_vec(), true, vec![cut(Vec3::z(), 12.0)]);
    let whole: f64 = answer.patterns[0].sections.iter().map(length).sum();
    near(whole, 2.0 * (10.0 + 20.0), PLACE);
}
