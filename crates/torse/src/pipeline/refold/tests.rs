//! Parts of surfaces without thickness bent back, and what is proven of them.

use super::refold;
use crate::brep::face::Face;
use crate::control::Control;
use crate::develop::shop::thickness::{Sheet, SheetSide};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::specimens::{quarter, rectangle, rolled_cone, round_surface, BentSheet, Stretch};
use crate::geom::Vec3;
use crate::io::model::Model;
use crate::io::refold_report::RefoldReport;
use crate::pipeline::deliver::files;
use crate::pipeline::map_artwork::{read_map, Side};
use crate::pipeline::unroll::{unroll, UnrollOptions};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

const TOLERANCE: f64 = 0.05;

/// Faces laid flat, written, read and bent back.
fn back(faces: Vec<Face>) -> RefoldReport {
    back_within(faces, TOLERANCE)
}

/// The same with another tolerance, mm.
fn back_within(faces: Vec<Face>, tolerance: f64) -> RefoldReport {
    back_as(faces, &UnrollOptions { surfaces: true, ..UnrollOptions::new(tolerance) })
}

/// The same as it is asked for.
fn back_as(faces: Vec<Face>, options: &UnrollOptions) -> RefoldReport {
    let model =
        Model { faces, skipped: vec![], unit: "millimetre".into(), notes: vec![], products: vec![], curves: vec![] };
    let mut answer = unroll(&model, options, &Control::default()).expect("parts");
    let made: HashMap<String, Vec<u8>> =
        files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    refold(&|name| made.get(name).cloned(), None, &Control::default()).expect("an answer").report()
}

/// Every panel is proven within a bound (mm).
fn all_within(report: &RefoldReport, panels: usize, bound: f64) {
    assert!(report.left.is_empty(), "{:?}", report.left);
    let of = report.parts.iter().flat_map(|p| &p.panels).collect::<Vec<_>>();
    assert_eq!(of.len(), panels, "{:?}", report.parts);
    assert!(of.iter().all(|p| p.distance_bound.is_some_and(|b| b < bound)), "{of:?}");
    assert!(report.parts.iter().all(|p| p.matched_estimate < 0.1 * bound), "{:?}", report.parts);
}

/// Places go to the neutral fibre that is drawn, also where no row of the bend table has one radius; bent back is the skin.
#[test]
fn places_on_a_rolled_cone_go_to_its_neutral_fibre() {
    let (t, k, radius, slope, height, turn) = (2.0, 0.4, 20.0, 0.5_f64, 60.0, 1.8);
    let faces = rolled_cone(t, (radius, slope), height, turn);
    let model =
        Model { faces, skipped: vec![], unit: "millimetre".into(), notes: vec![], products: vec![], curves: vec![] };
    let options = UnrollOptions { k: KFactor::Ansi(k), ..UnrollOptions::new(TOLERANCE) };
    let mut answer = unroll(&model, &options, &Control::default()).expect("parts");
    let made: HashMap<String, Vec<u8>> =
        files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let map = read_map(&|name| made.get(name).cloned(), None, None).expect("a map");
    let (sin, cos) = slope.atan().sin_cos();
    // At the wide end of the outside, corners included.
    let (outer, z) = (radius + slope * height + t * cos, height - t * sin);
    let at = |angle: f64| (1, Vec3::new(outer * angle.cos(), outer * angle.sin(), z));
    let angles: Vec<f64> = (0..=12).map(|i| turn * f64::from(i) / 12.0).collect();
    let found = map.points(&angles.iter().map(|a| at(*a)).collect::<Vec<_>>(), Side::Flat);
    let places: Vec<Vec3> = found.iter().map(|r| r.place.expect("a place on the part")).collect();
    let neutral = (radius + slope * height + k * t * cos) / sin;
    for (place, angle) in places.iter().zip(&angles) {
        let chord = 2.0 * neutral * (0.5 * angle * sin).sin();
        assert!(((place - places[0]).norm() - chord).abs() < 1e-6, "{angle}: {} {chord}", (place - places[0]).norm());
    }
    // Asked to stop, nothing is bent back, and all of it is named.
    let stop = Control::default();
    stop.cancel();
    let stopped = refold(&|name| made.get(name).cloned(), None, &stop).expect("an answer");
    assert!(stopped.parts.is_empty() && stopped.left.iter().any(|l| l.1.contains("stopped")), "{:?}", stopped.left);
    let report = refold(&|name| made.get(name).cloned(), None, &Control::default()).expect("an answer").report();
    assert!(report.left.is_empty() && report.parts[0].matched_estimate < 1e-3, "{report:?}");
    // Without the word of the report nobody knows which fibre is drawn.
    let silent = |name: &str| {
        let bytes = made.get(name).cloned()?;
        let text = String::from_utf8_lossy(&bytes).replace("\"neutral\"", "\"unknown\"");
        Some(if name == "report.json" { text.into_bytes() } else { bytes })
    };
    let left = refold(&silent, None, &Control::default()).expect("an answer").report().left;
    assert!(!left.is_empty(), "{left:?}");
}

/// Faces with some of them looking the other way.
fn turned(mut faces: Vec<Face>, is_turned: &dyn Fn(usize) -> bool) -> Vec<Face> {
    faces.iter_mut().enumerate().filter(|f| is_turned(f.0)).for_each(|f| f.1.reversed = !f.1.reversed);
    faces
}

/// Faces of a solid may all look inwards, and some the other way than their neighbours: what is drawn is the skin as it looks out of
/// the sheet, and so the panels are written with which it is compared.
#[test]
fn bent_sheets_that_are_inside_out_come_back_as_their_skins() {
    let bends = [Stretch::Bend(1.0, 3.0), Stretch::Bend(-0.7, 4.0)];
    let stretches = [Stretch::Line(40.0), bends[0], Stretch::Line(20.0), bends[1], Stretch::Line(30.0)];
    let faces = BentSheet::new(2.0, &stretches, &[0.0, 25.0], &[]).faces();
    let ways: [&dyn Fn(usize) -> bool; 3] = [&|_| false, &|_| true, &|k| k % 2 == 0];
    for is_turned in ways {
        all_within(&back_as(turned(faces.clone(), is_turned), &UnrollOptions::new(TOLERANCE)), 5, 0.05);
    }
}

/// The same of a face without one radius.
#[test]
fn a_rolled_cone_that_is_inside_out_comes_back_as_its_skin() {
    let faces = rolled_cone(2.0, (20.0, 0.5), 30.0, 0.8);
    all_within(&back_as(turned(faces, &|_| true), &UnrollOptions::new(TOLERANCE)), 1, 0.05);
}

/// Rolled over a full turn: one region with all its rulings, not one for every line.
#[test]
fn a_pipe_is_proven_as_a_whole() {
    all_within(&back(vec![round_surface(50.0, 0.0, (0.0, 100.0))]), 1, 0.1);
}

/// Lines at an apex are none, and nothing is folded there. Where all rulings meet nothing is proven, and the reason says so.
#[test]
fn a_cone_up_to_its_apex_is_compared() {
    let report = back(vec![round_surface(50.0, -0.5, (0.0, 100.0))]);
    assert!(report.left.is_empty(), "{:?}", report.left);
    let part = &report.parts[0];
    assert!(part.distance_estimate < 0.1, "{part:?}");
    assert!(part.distance_bound.is_some() || !part.not_proven.is_empty(), "{part:?}");
}

/// All edges of a cube are alike: it is unfolded in the same way again, and its folds end in corners.
#[test]
fn a_box_is_folded_up_again() {
    let o = Vec3::zeros();
    for [a, b, c] in [[10.0, 20.0, 30.0], [20.0, 20.0, 20.0]] {
        let (x, y, z) = (Vec3::x() * a, Vec3::y() * b, Vec3::z() * c);
        let faces = [(o, y, x), (z, x, y), (o, x, z), (y, z, x), (o, z, y), (x, y, z)];
        all_within(&back(faces.map(|(o, a, b)| rectangle(o, a, b)).to_vec()), 6, 0.01);
    }
}

/// Faces side by side in one plane, with no line between them: each is judged with its own share of the region.
#[test]
fn faces_in_one_plane_are_proven_one_by_one() {
    let cylinder = quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0);
    let flange =
        |from: f64, long: f64| rectangle(Vec3::new(50.0, from - long, 0.0), long * Vec3::y(), 30.0 * Vec3::z());
    all_within(&back(vec![cylinder, flange(0.0, 20.0), flange(-20.0, 35.0)]), 3, TOLERANCE);
}

/// A tangent surface, on whose patch rulings and rims are far from square to each other, comes back within what it was drawn to, and
/// so is proven.
#[test]
fn a_tangent_surface_is_proven_within_its_tolerance() {
    let tolerance = 0.01;
    // (100 t, 60 t², 40 t³), and so many times its derivative beyond.
    let powers = [[0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0], [0.0, 0.0, 1.0 / 3.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
    let point = |i: usize, k: f64| {
        let [t, square, cube] = powers.map(|p| p[i]);
        Vec3::new(100.0 * (t + k), 60.0 * square + 120.0 * k * t, 40.0 * cube + 120.0 * k * square)
    };
    let points: Vec<Vec3> = (0..4).flat_map(|i| [0.5, 4.0].map(|k| point(i, k))).collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    let face = Face::untrimmed(Surface::new(knots(3), knots(1), &points, None).expect("a surface"));
    all_within(&back_within(vec![face], tolerance), 1, 1.5 * tolerance);
}

/// A face that bends both ways has two rows in the bend table, and one family of rulings.
#[test]
fn faces_that_bend_both_ways_are_bent_back_as_one() {
    let profile = [[0.0, 0.0], [40.0, 60.0], [60.0, -60.0], [100.0, 0.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    let points: Vec<Vec3> = profile.iter().flat_map(|p| [*p, p + 90.0 * Vec3::y()]).collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    let surface = Surface::new(knots(3), knots(1), &points, None).expect("a surface");
    let report = back(vec![Face::untrimmed(surface)]);
    assert!(report.left.is_empty() && report.parts.len() == 1, "{:?}", report.left);
    assert!(report.parts[0].panels.iter().all(|p| p.distance_bound.is_some()), "{:?}", report.parts);
}

/// A general cylinder and a general cone over a curve that bends unevenly come back within what their lines are to tell.
#[test]
fn uneven_faces_get_as_many_lines_as_bending_them_back_needs() {
    let tolerance = 0.01;
    let along: &dyn Fn(Vec3) -> Vec3 = &|p| p + 120.0 * Vec3::z();
    let towards: &dyn Fn(Vec3) -> Vec3 = &|p| p + (300.0 * Vec3::z() - p) * 0.6;
    for face in [wave(along), wave(towards)] {
        let report = back_within(vec![face], tolerance);
        assert!(report.left.is_empty() && report.parts.len() == 1, "{:?}", report.left);
        let part = &report.parts[0];
        let (matched, lines) = (part.matched_estimate, part.lines);
        assert!(matched <= 0.7 * tolerance && lines < 200, "{matched} {lines}");
    }
}

/// What is drawn of surfaces that were given a thickness is their neutral fibre: places go to it, and bent back it is as far beside them as
/// it was.
#[test]
fn surfaces_that_were_given_a_thickness_are_compared_with_their_neutral_fibre() {
    let (radius, t) = (50.0, 4.0);
    for side in [SheetSide::Inside, SheetSide::Middle, SheetSide::Outside] {
        let faces = vec![quarter(Vec3::zeros(), Vec3::z(), radius * Vec3::x(), 40.0)];
        let model = Model {
            faces,
            skipped: vec![],
            unit: "millimetre".into(),
            notes: vec![],
            products: vec![],
            curves: vec![],
        };
        let sheet = Some(Sheet { thickness: t, side, k: KFactor::Ansi(0.3) });
        let options = UnrollOptions { surfaces: true, sheet, ..UnrollOptions::new(TOLERANCE) };
        let mut answer = unroll(&model, &options, &Control::default()).expect("parts");
        let made: HashMap<String, Vec<u8>> =
            files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
        let report = refold(&|name| made.get(name).cloned(), None, &Control::default()).expect("an answer").report();
        let p = &report.parts[0];
        assert!(report.status == "certified" && p.distance_bound.is_some_and(|b| b < TOLERANCE), "{side:?} {report:?}");
        assert!(report.words().contains("drawn is the neutral fibre, up to "), "{}", report.words());
        let map = read_map(&|name| made.get(name).cloned(), None, None).expect("a map");
        let angle = 0.5;
        let at = |a: f64| (1, Vec3::new(radius * a.cos(), radius * a.sin(), 20.0));
        let found = map.points(&[at(0.2), at(0.2 + angle)], Side::Flat);
        let [a, b] = [0, 1].map(|k: usize| found[k].place.expect("a place on the part"));
        let neutral = answer.patterns[0].area / (40.0 * FRAC_PI_2);
        assert!((neutral - radius).abs() > 0.5, "{side:?} {neutral}");
        assert!(((neutral - radius).abs() - p.beside).abs() < 1e-6, "{side:?} {neutral} {p:?}");
        assert!(((b - a).norm() - neutral * angle).abs() < 1e-6, "{side:?} {}", (b - a).norm());
    }
}

/// Surfaces laid flat as the neutral fibre of a sheet, written, read and bent back.
fn back_of_sheet(faces: Vec<Face>, side: SheetSide, k: KFactor) -> RefoldReport {
    let sheet = Some(Sheet { thickness: 3.0, side, k });
    back_as(faces, &UnrollOptions { surfaces: true, sheet, ..UnrollOptions::new(TOLERANCE) })
}

/// Of the sheet that is bent back it is the surface that was given it which is compared: of a pipe with its slit, and of a cone.
#[test]
fn round_surfaces_with_a_thickness_come_back_as_themselves() {
    for (slope, side) in [(0.0, SheetSide::Inside), (0.5, SheetSide::Middle)] {
        let face = round_surface(50.0, slope, (0.0, 30.0));
        all_within(&back_of_sheet(vec![face], side, KFactor::Ansi(0.47)), 1, 0.1);
    }
}

/// The same of a bend between planes, hollow and not.
#[test]
fn bends_with_a_thickness_come_back_as_themselves() {
    let cylinder = quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0);
    let flange = rectangle(Vec3::new(50.0, -20.0, 0.0), 20.0 * Vec3::y(), 30.0 * Vec3::z());
    for (side, is_turned) in [(SheetSide::Inside, false), (SheetSide::Middle, true)] {
        let faces = turned(vec![cylinder.clone(), flange.clone()], &|_| is_turned);
        all_within(&back_of_sheet(faces, side, KFactor::Ansi(0.3)), 2, TOLERANCE);
    }
}

/// A face that bends both ways, from a profile to where its places go.
fn wave(to: &dyn Fn(Vec3) -> Vec3) -> Face {
    let profile = [[0.0, 0.0], [60.0, 90.0], [140.0, -40.0], [220.0, 40.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let points: Vec<Vec3> = profile.iter().flat_map(|p| [*p, to(*p)]).collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    Face::untrimmed(Surface::new(knots(3), knots(1), &points, None).expect("a surface"))
}

/// The fibre lies on one side of a wave here and on the other there, as deep as K says at each ruling.
#[test]
fn general_cylinders_with_a_thickness_come_back_as_themselves() {
    let face = wave(&|p| p + 120.0 * Vec3::z());
    all_within(&back_of_sheet(vec![face], SheetSide::Inside, KFactor::Din), 1, 0.1);
}

/// The same over rulings through a point.
#[test]
fn general_cones_with_a_thickness_come_back_as_themselves() {
    let face = wave(&|p| p + (300.0 * Vec3::z() - p) * 0.6);
    all_within(&back_of_sheet(vec![face], SheetSide::Outside, KFactor::Ansi(0.3)), 1, 0.1);
}
