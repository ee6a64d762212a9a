//! Sheets and surfaces whose flat parts are known.

mod bad;
mod curves;
mod given;
mod joined;
mod kinds;
mod marks;
mod offsets;
mod rolled;
mod round;
mod sections;
mod skins;

use crate::answer::note::{Note, UnrollNote};
use crate::brep::face::Face;
use crate::certify::claim::Status;
use crate::develop::bends::{sagitta, BendSpacing, Facets};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::bends::BendKind;
use crate::develop::unfold::part::{flat_parts, BodyParts, FlatPart, PartOptions};
use crate::develop::unfold::specimens::{quarter, rectangle, rolled_cone, round_surface, BentSheet, Stretch};
use crate::develop::unfold::tree::{CutReason, Joins};
use crate::geom::Vec3;
use crate::io::words::why;
use crate::patchwork::image::ClosedMap;
use crate::patchwork::pattern::BendSense;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use std::f64::consts::{FRAC_PI_2, PI};

const TOLERANCE: f64 = 1e-3;

fn flat(faces: &[Face], k: f64) -> BodyParts {
    let options = PartOptions { k: KFactor::Ansi(k), ..PartOptions::new(TOLERANCE) };
    flat_parts(&faces.iter().collect::<Vec<_>>(), "part", &options)
}

/// The only part, with nothing left out and its drawing proven.
fn only(faces: &[Face], made: BodyParts) -> FlatPart {
    assert!(made.left.is_empty(), "{:?}", made.left);
    assert_eq!(made.parts.len(), 1);
    let part = made.parts.into_iter().next().expect("a part");
    let proof = super::assessed(&part, faces, TOLERANCE);
    assert!(proof.map_surface_distance().value() < 1e-9 && proof.drawing_distance().value() <= TOLERANCE, "{proof:?}");
    assert!(proof.joint_gap().value() < 1e-9 && proof.strain().value() < 1e-12, "{proof:?}");
    part
}

fn laid(faces: &[Face], k: f64) -> FlatPart {
    only(faces, flat(faces, k))
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
}

#[test]
fn a_bracket_is_as_long_as_its_neutral_fibre() {
    let (t, r, k, angle, w) = (2.0, 3.0, 0.4, 1.2, 30.0);
    for sign in [1.0, -1.0] {
        let profile = [Stretch::Line(40.0), Stretch::Bend(sign * angle, r), Stretch::Line(25.0)];
        let part = laid(&BentSheet::new(t, &profile, &[0.0, w], &[]).faces(), k);
        let length = 40.0 + (r + k * t) * angle + 25.0;
        near(part.sheet.thickness, t);
        near(part.pattern.area, length * w);
        near(part.pattern.length, length);
        near(part.pattern.width, w);
        assert_eq!(part.pattern.contours.len(), 1);
        assert_eq!(part.pattern.contours[0].vertices.len(), 4, "straight sides are one line each");
        let [bend] = part.sheet.bends.as_slice() else { panic!("one bend") };
        assert_eq!((bend.kind, bend.lines.len(), bend.extents.len()), (BendKind::Bend, 1, 2));
        near(bend.angle, angle);
        near(bend.inside_radius, r);
        near(bend.allowance, (r + k * t) * angle);
        near(bend.length, w);
        // The bend line lies half way between its extents.
        let middle = |l: &[crate::geom::Vec2; 2]| (l[0] + l[1]) * 0.5;
        let between = (middle(&bend.extents[0]) + middle(&bend.extents[1])) * 0.5;
        assert!((middle(&bend.lines[0]) - between).norm() < 1e-9);
    }
}

#[test]
fn a_channel_bends_one_way_and_a_step_both_ways() {
    let profile = |second: f64| {
        [
            Stretch::Line(20.0),
            Stretch::Bend(FRAC_PI_2, 2.0),
            Stretch::Line(50.0),
            Stretch::Bend(second * FRAC_PI_2, 2.0),
            Stretch::Line(30.0),
        ]
    };
    let length = 100.0 + 2.0 * (2.0 + 0.44 * 1.5) * FRAC_PI_2;
    for (second, alike) in [(1.0, true), (-1.0, false)] {
        let part = laid(&BentSheet::new(1.5, &profile(second), &[0.0, 40.0], &[]).faces(), 0.44);
        near(part.pattern.length, length);
        near(part.pattern.area, 40.0 * length);
        assert_eq!(part.sheet.bends.len(), 2);
        assert_eq!(part.sheet.bends[0].sense == part.sheet.bends[1].sense, alike);
        let mut order: Vec<usize> = part.sheet.bends.iter().map(|b| b.order).collect();
        order.sort_unstable();
        assert_eq!(order, [1, 2]);
    }
}

#[test]
fn a_window_across_a_bend_stays_open_and_splits_the_bend_line() {
    let profile = [
        Stretch::Line(20.0),
        Stretch::Line(10.0),
        Stretch::Bend(FRAC_PI_2, 2.0),
        Stretch::Line(10.0),
        Stretch::Line(20.0),
    ];
    let holes = [[1, 1], [2, 1], [3, 1]];
    let sheet = BentSheet::new(1.0, &profile, &[0.0, 10.0, 25.0, 40.0], &holes);
    let part = laid(&sheet.faces(), 0.5);
    let bent = 2.5 * FRAC_PI_2;
    near(part.pattern.area, 40.0 * (60.0 + bent) - 15.0 * (20.0 + bent));
    assert_eq!(part.pattern.contours.len(), 2, "an outer contour and a hole");
    assert!(part.pattern.contours.iter().all(|c| c.vertices.len() == 4));
    let [bend] = part.sheet.bends.as_slice() else { panic!("one bend: {:?}", part.sheet.bends) };
    assert_eq!(bend.lines.len(), 2);
    near(bend.length, 40.0);
    assert!(part.cuts.is_empty());
}

#[test]
fn a_tray_of_four_flanges_is_a_cross() {
    let (a, b, r, h) = (60.0, 40.0, 3.0, 15.0);
    // Seen from below, which is outside.
    let mut faces = vec![rectangle(Vec3::zeros(), Vec3::y() * b, Vec3::x() * a)];
    let sides = [
        (Vec3::zeros(), Vec3::x(), -Vec3::y(), a),
        (Vec3::new(a, 0.0, 0.0), Vec3::y(), Vec3::x(), b),
        (Vec3::new(a, b, 0.0), -Vec3::x(), Vec3::y(), a),
        (Vec3::new(0.0, b, 0.0), -Vec3::y(), -Vec3::x(), b),
    ];
    for (corner, along, out, length) in sides {
        // Up: the axis lies above the edge.
        let axis = corner + Vec3::z() * r;
        faces.push(quarter(axis + along * length, -along, -Vec3::z() * r, length));
        let foot = axis + out * r;
        faces.push(rectangle(foot, along * length, Vec3::z() * h));
    }
    let part = laid(&faces, 0.44);
    assert_eq!(part.sheet.thickness, 0.0);
    let flange = h + r * FRAC_PI_2;
    near(part.pattern.area, a * b + 2.0 * (a + b) * flange);
    assert_eq!(part.pattern.contours[0].vertices.len(), 12);
    assert_eq!((part.sheet.bends.len(), part.cuts.len()), (4, 0));
    assert!(part.sheet.bends.iter().all(|b| b.kind == BendKind::Bend));
}

#[test]
fn faces_that_look_different_ways_are_turned_before_they_are_joined() {
    let (x, y, z) = (Vec3::x() * 10.0, Vec3::y() * 20.0, Vec3::z() * 30.0);
    let floor = rectangle(Vec3::zeros(), x, y);
    for wall in [rectangle(Vec3::zeros(), y, z), rectangle(Vec3::zeros(), z, y)] {
        let part = laid(&[floor.clone(), wall], 0.44);
        near(part.pattern.area, 800.0);
        assert_eq!((part.sheet.bends.len(), part.faces.len()), (1, 2));
    }
}

/// The faces of a box, looking outwards.
fn box_faces() -> [Face; 6] {
    let (x, y, z) = (Vec3::x() * 10.0, Vec3::y() * 20.0, Vec3::z() * 30.0);
    let o = Vec3::zeros();
    [
        rectangle(o, y, x),
        rectangle(z, x, y),
        rectangle(o, x, z),
        rectangle(y, z, x),
        rectangle(o, z, y),
        rectangle(x, y, z),
    ]
}

/// Bodies are laid beside each other over the edges that are asked for, and no others.
#[test]
fn bends_are_where_they_are_asked_for() {
    let bracket: Vec<Face> = crate::read(include_bytes!("../../../../../data/bracket.step")).expect("a bracket").faces;
    let laid = |faces: &[Face], joins: Joins| {
        let options = super::UnrollOptions { surfaces: true, joins, ..super::UnrollOptions::new(TOLERANCE) };
        super::unroll(&model_of(faces.to_vec()), &options, &crate::control::Control::default())
    };
    let count = |faces: &[Face], joins: Joins| {
        let answer = laid(faces, joins).expect("parts");
        assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
        let area: f64 = answer.patterns.iter().map(|p| p.area).sum();
        let folds = answer.sheets.iter().flat_map(|s| &s.bends).filter(|b| b.kind == BendKind::Fold);
        (answer.parts.len(), folds.map(|b| b.edges.clone()).collect::<Vec<Vec<u64>>>(), area)
    };
    for (joins, parts) in [(Joins::All, 1), (Joins::Smooth, 6), (Joins::None, 6)] {
        let (made, folds, area) = count(&box_faces(), joins);
        assert_eq!((made, folds.len()), (parts, 6 - parts));
        near(area, 2200.0);
    }
    // Edges are those that the table names.
    let (smooth, none, area) = count(&bracket, Joins::Smooth);
    assert!(none.is_empty());
    let (whole, folds, _) = count(&bracket, Joins::All);
    let edge = *folds.iter().flatten().next().expect("a sharp bend");
    let (named, one, same) = count(&bracket, Joins::Named(vec![edge]));
    assert!(whole < named && named + 1 == smooth && one == [vec![edge]], "{whole} {named} {smooth} {one:?}");
    assert!((area - same).abs() < 1e-6 * area, "{area} {same}");
    assert_eq!(laid(&bracket, Joins::Named(vec![edge, 1])).err(), Some(super::UnrollError::Edge(1)));
    // What goes on smoothly is one part unless every face is to be one.
    let halves = [0.0, 10.0].map(|x| rectangle(Vec3::x() * x, 10.0 * Vec3::x(), 20.0 * Vec3::y()));
    let parts = |joins| {
        let options = PartOptions { surfaces: true, joins, ..PartOptions::new(TOLERANCE) };
        flat_parts(&halves.iter().collect::<Vec<_>>(), "halves", &options).parts.len()
    };
    assert_eq!([Joins::All, Joins::Smooth, Joins::None].map(parts), [1, 1, 2]);
}

#[test]
fn a_closed_box_is_cut_open_along_seven_edges() {
    let faces = box_faces();
    let options = PartOptions { surfaces: true, ..PartOptions::new(TOLERANCE) };
    let part = only(&faces, flat_parts(&faces.iter().collect::<Vec<_>>(), "box", &options));
    near(part.pattern.area, 2.0 * (200.0 + 300.0 + 600.0));
    assert_eq!((part.cuts.len(), part.sheet.bends.len()), (7, 5));
    assert!(part.cuts.iter().all(|c| c.1 == CutReason::Closes));
    assert!(part.sheet.bends.iter().all(|b| b.kind == BendKind::Fold && b.sense == BendSense::Down));
}

/// The inside of a rolled cone is tightest at its narrow end; the neutral fibre that is drawn is not so tight.
#[test]
fn a_rolled_cone_has_its_least_inside_radius_at_its_narrow_end() {
    let (t, k, radius, slope, height, turn) = (2.0, 0.4, 20.0, 0.5_f64, 60.0, 1.8);
    let part = laid(&rolled_cone(t, (radius, slope), height, turn), k);
    let (sin, cos) = slope.atan().sin_cos();
    let slant = height / cos;
    // The neutral cone has its radii square to the rulings larger by k t.
    near(part.pattern.area, turn * slant * (radius + k * t * cos + 0.5 * slant * sin));
    let bend = &part.sheet.bends[0];
    assert!(bend.kind == BendKind::Rolled && bend.inside_radius.is_infinite());
    assert!((bend.least_inside_radius - radius / cos).abs() < 1e-3, "{}", bend.least_inside_radius);
    assert_eq!((part.sheet.local.len(), &part.sheet.k), (1, &KFactor::Ansi(k)));
    near(part.sheet.local[0], t);
}

/// Arcs stay low at the wide end of a cone too.
#[test]
fn facets_of_a_cone_keep_their_height_at_its_wide_end() {
    let height = 0.2;
    let spacing = BendSpacing { facets: Some(Facets::Chord(height)), ..BendSpacing::default() };
    let options = PartOptions { spacing, ..PartOptions::new(TOLERANCE) };
    let part = flat_parts(&[&round_surface(20.0, 0.8, (0.0, 100.0))], "cone", &options).parts.remove(0);
    let worst = part.pattern.bends.iter().map(sagitta).fold(0.0, f64::max);
    assert!(worst <= height && worst > 0.8 * height, "{worst}");
}

#[test]
fn a_frustum_is_a_sector_and_a_pipe_a_rectangle() {
    let (radius, slope, h) = (20.0, 0.3_f64, 40.0);
    let cone = laid(&[round_surface(radius, slope, (0.0, h))], 0.44);
    let slant = h * (1.0 + slope * slope).sqrt();
    near(cone.pattern.area, PI * slant * (2.0 * radius + slope * h));
    assert!(cone.sheet.bends[0].kind == BendKind::Rolled && cone.sheet.bends[0].lines.len() > 60);
    // Two lines and two arcs of one centre, each in two parts at most.
    assert!(cone.pattern.contours[0].vertices.len() <= 6, "{}", cone.pattern.contours[0].vertices.len());
    let pipe = laid(&[round_surface(radius, 0.0, (0.0, h))], 0.44);
    near(pipe.pattern.area, 2.0 * PI * radius * h);
    near(pipe.pattern.length, 2.0 * PI * radius);
    assert_eq!(pipe.pattern.contours[0].vertices.len(), 4);
}

#[test]
fn bodies_without_one_thickness_are_refused_with_the_distances_found() {
    // A block: three distances, none of which is that of most of it.
    let profile = [Stretch::Line(30.0)];
    let block = BentSheet::new(28.0, &profile, &[0.0, 29.0], &[]).faces();
    let made = flat(&block, 0.44);
    assert!(made.parts.is_empty());
    let (face, reason) = &made.left[0];
    let reason = why(&reason.clone().into());
    assert!(face.is_none() && reason.contains("no constant thickness"), "{reason}");
    assert!(reason.contains("28.000") && reason.contains("29.000"), "{reason}");
    // As surfaces they unfold all the same.
    let options = PartOptions { surfaces: true, ..PartOptions::new(TOLERANCE) };
    let part = only(&block, flat_parts(&block.iter().collect::<Vec<_>>(), "block", &options));
    near(part.pattern.area, 2.0 * (30.0 * 28.0 + 30.0 * 29.0 + 28.0 * 29.0));
}

/// A face ruled along a direction or to a point over a parabola, without thickness.
fn over_parabola(to: impl Fn(Vec3) -> Vec3) -> Face {
    let curve = [Vec3::zeros(), Vec3::new(50.0, 0.0, 40.0), Vec3::new(100.0, 0.0, 0.0)];
    let points: Vec<Vec3> = curve.iter().flat_map(|p| [*p, to(*p)]).collect();
    let knots = |degree| crate::spline::knots::Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
    let surface = crate::spline::surface::Surface::new(knots(2), knots(1), &points, None).expect("a surface");
    Face::untrimmed(surface)
}

#[test]
fn general_developables_keep_their_area_and_the_lengths_of_their_edges() {
    let apex = Vec3::new(40.0, 130.0, 10.0);
    let shapes: [(&str, Face); 2] = [
        ("general cylinder", over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0))),
        ("general cone", over_parabola(|p| p + (apex - p) * 0.6)),
    ];
    for (name, face) in shapes {
        assert_eq!(crate::brep::recognised_surface::recognise(&face).name(), name);
        let made = flat(std::slice::from_ref(&face), 0.44);
        assert!(made.left.is_empty());
        let part = &made.parts[0];
        let area = crate::brep::area::area_estimate(&face);
        assert!((part.pattern.area - area).abs() < 1e-5 * area, "{name}: {} {area}", part.pattern.area);
        let length = |a: Vec3, b: Vec3| (a - b).norm();
        let corner = |k: usize| {
            let q = face.loops[0].points[k];
            face.surface.point(q[0], q[1])
        };
        let corners: Vec<_> = part.pattern.contours[0].vertices.iter().filter(|v| v.corner).map(|v| v.point).collect();
        assert_eq!(corners.len(), 4);
        // Two sides are rulings: their lengths stay, in space and in the plane.
        let flat_sides: Vec<f64> = (0..4).map(|k| (corners[k] - corners[(k + 1) % 4]).norm()).collect();
        for (p, q) in [(0, 3), (1, 2)] {
            let wanted = length(corner(p), corner(q));
            assert!(flat_sides.iter().any(|s| (s - wanted).abs() < 1e-8 * wanted), "{name}: {flat_sides:?} {wanted}");
        }
        assert!(part.sheet.bends[0].kind == BendKind::Rolled && part.sheet.bends[0].lines.len() > 10);
    }
}

#[test]
fn twisted_faces_are_named_with_their_twist() {
    let twisted = over_parabola(|p| p + Vec3::new(0.0, 90.0, 0.2 * p.x));
    let made = flat(std::slice::from_ref(&twisted), 0.44);
    assert!(made.parts.is_empty());
    let reason = why(&made.left[0].1.clone().into());
    assert!(reason.contains("not developable") && reason.contains("° along a ruling"), "{reason}");
}

#[test]
fn a_drawing_that_is_moved_is_refused_by_the_judge() {
    let profile = [Stretch::Line(40.0), Stretch::Bend(1.0, 3.0), Stretch::Line(25.0)];
    let faces = BentSheet::new(2.0, &profile, &[0.0, 30.0], &[]).faces();
    let part = laid(&faces, 0.44);
    let judged = |change: &dyn Fn(&mut FlatPart)| {
        let mut forged = part.clone();
        change(&mut forged);
        super::assessed(&forged, &faces, TOLERANCE)
    };
    let drawn = |change: &dyn Fn(&mut FlatPart)| judged(change).drawing_distance().value();
    assert!(drawn(&|_| {}) <= TOLERANCE);
    // Contours that are not what was judged.
    assert!(drawn(&|p| p.pattern.contours[0].vertices[1].point.x += 1e-9).is_infinite());
    assert!(drawn(&|p| p.pattern.contours[0].vertices[1].bulge = 1e-9).is_infinite());
    assert!(drawn(&|p| p.pattern.contours.push(p.pattern.contours[0].clone())).is_infinite());
    // Strokes moved together with the contours.
    let x = 2.0 * TOLERANCE;
    assert!(
        drawn(&|p| {
            p.pattern.contours[0].vertices[1].point.x += x;
            p.strokes[0].end.x += x;
            p.strokes[1].start.x += x;
        }) > TOLERANCE
    );
    assert!(
        drawn(&|p| {
            p.pattern.contours[0].vertices[1].bulge = 0.01;
            p.strokes[1].bulge = 0.01;
        }) > TOLERANCE
    );
    // A line drawn for nothing, although there is no sharp bend.
    assert!(drawn(&|p| p.strokes[1].images = Some(Vec::new())) > TOLERANCE);
    // Images of which the judge does not know the map, or that lie elsewhere.
    assert!(drawn(&|p| p.strokes[1].images = None).is_infinite());
    assert!(drawn(&|p| p.strokes[1].images.iter_mut().flatten().for_each(|i| i.shift.x += x)) > TOLERANCE);
    assert!(drawn(&|p| p.strokes[1].images.iter_mut().flatten().for_each(|i| i.face += 1)).is_infinite());
    // A joint whose other side is elsewhere.
    let gap = judged(&|p| {
        for s in &mut p.joints[0][1] {
            s.start.x += x;
            s.end.x += x;
            s.images.iter_mut().flatten().for_each(|i| i.shift.x += x);
        }
    });
    assert!(gap.joint_gap().value() > TOLERANCE);
    // A bend of another radius, for which everything else would fit.
    let bend = part.maps.iter().position(|m| matches!(m, Some(ClosedMap::Cylinder { .. }))).expect("a bend");
    let wider = judged(&|p| {
        if let Some(ClosedMap::Cylinder { radius, .. }) = &mut p.maps[bend] {
            *radius += x;
        }
    });
    assert!(wider.map_surface_distance().value() > TOLERANCE);
    // A surface without thickness keeps its own radius.
    assert!(judged(&|p| p.sheet.thickness = 0.0).strain().value() > 0.01);
}

#[test]
fn a_job_that_is_stopped_says_so() {
    let sheet =
        BentSheet::new(2.0, &[Stretch::Line(40.0), Stretch::Bend(1.0, 3.0), Stretch::Line(20.0)], &[0.0, 9.0], &[]);
    let (options, control) = (super::UnrollOptions::new(TOLERANCE), crate::control::Control::default());
    let (parts, left) = super::bodies::flat_parts_of(&sheet.faces(), &options, &control).expect("parts");
    assert_eq!((parts.len(), left.len()), (1, 0));
    control.cancel();
    let stopped = super::bodies::flat_parts_of(&sheet.faces(), &options, &control);
    let Err(e) = stopped else { panic!("nothing is unfolded after a stop") };
    assert!(e.to_string().contains("stopped"), "{e}");
}

/// Faces as a file holds them.
fn model_of(faces: Vec<Face>) -> crate::io::model::Model {
    crate::io::model::Model {
        faces,
        skipped: Vec::new(),
        unit: "millimetre".into(),
        notes: Vec::new(),
        products: Vec::new(),
        curves: Vec::new(),
    }
}

/// What is said of faces without thickness.
fn answered(faces: Vec<Face>, approximate: Option<f64>) -> crate::answer::Answer {
    answered_within(0.05, faces, approximate)
}

/// The same with another tolerance, mm.
fn answered_within(tolerance: f64, faces: Vec<Face>, approximate: Option<f64>) -> crate::answer::Answer {
    let model = model_of(faces);
    let options = super::UnrollOptions { surfaces: true, approximate, ..super::UnrollOptions::new(tolerance) };
    super::unroll(&model, &options, &crate::control::Control::default()).expect("an answer")
}

#[test]
fn tolerances_larger_than_the_model_are_refused() {
    let faces = vec![over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0))];
    let model = model_of(faces);
    let options = super::UnrollOptions { surfaces: true, ..super::UnrollOptions::new(900.0) };
    let e = super::unroll(&model, &options, &crate::control::Control::default()).expect_err("too large a tolerance");
    assert!(matches!(e, super::UnrollError::Loose(_)), "{e}");
}

#[test]
fn other_developables_are_proven_alone() {
    let apex = Vec3::new(40.0, 130.0, 10.0);
    for face in [over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0)), over_parabola(|p| p + (apex - p) * 0.6)] {
        let area = crate::brep::area::area_estimate(&face);
        // Outlines are drawn within the tolerance, which tells in the area.
        let answer = answered_within(0.005, vec![face], None);
        assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
        let [pattern] = answer.patterns.as_slice() else { panic!("one part") };
        assert!((pattern.area - area).abs() < 1e-4 * area, "{} {area}", pattern.area);
        let drawn = (answer.patchwork.panels.len(), answer.sheets[0].bends[0].lines.clone());
        assert_eq!(drawn, (1, pattern.rulings.clone()));
    }
}

#[test]
fn faces_that_are_not_developable_are_covered_on_demand() {
    let smooth = over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0));
    let twisted = {
        let mut face = over_parabola(|p| p + Vec3::new(0.0, 90.0, 0.2 * p.x));
        face.body = 1;
        face
    };
    let without = answered(vec![smooth.clone(), twisted.clone()], None);
    assert_eq!((without.status(), without.parts.len(), without.skipped.len()), (Status::Uncertified, 1, 1));
    let with = answered(vec![smooth, twisted.clone()], Some(1.0));
    assert_eq!((with.status(), with.skipped.len()), (Status::Certified, 0), "{:?}", with.claims);
    let count = with.parts.len();
    assert!(count > 1 && with.patterns.len() == count && with.sheets.len() == count);
    assert!(with.patterns.iter().enumerate().all(|(k, p)| p.panel == k && p.name == with.parts[k].name));
    // Nothing but faces to be covered will do as well.
    assert_eq!(answered(vec![twisted], Some(1.0)).status(), Status::Certified);
}

/// A face and a parallelogram beside it along a ruling, given by its start and its way, as one body.
fn flap(face: Face, [start, way]: [Vec3; 2]) -> [Face; 2] {
    let plane = rectangle(start, Vec3::new(60.0, -20.0, -48.0), way);
    [face, plane].map(|mut f| {
        f.body = 7;
        f
    })
}

/// A tangent surface over (100 t, 60 t², 40 t³), from so many times its derivative to another multiple of it, with a flap.
fn tangent_flap([from, to]: [f64; 2]) -> [Face; 2] {
    let rails = |k: f64| {
        let (one, two) = (100.0 / 3.0, 20.0);
        [
            Vec3::new(100.0 * k, 0.0, 0.0),
            Vec3::new(one + 100.0 * k, 40.0 * k, 0.0),
            Vec3::new(2.0 * one + 100.0 * k, two + 80.0 * k, 40.0 * k),
            Vec3::new(100.0 + 100.0 * k, 60.0 + 120.0 * k, 40.0 + 120.0 * k),
        ]
    };
    let points: Vec<Vec3> = rails(from).iter().zip(&rails(to)).flat_map(|(a, b)| [*a, *b]).collect();
    let knots = |degree| crate::spline::knots::Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
    let surface = crate::spline::surface::Surface::new(knots(3), knots(1), &points, None).expect("a surface");
    let face = Face::untrimmed(surface);
    assert_eq!(crate::brep::recognised_surface::recognise(&face).name(), "tangent surface");
    flap(face, [100.0 * from * Vec3::x(), 100.0 * (to - from) * Vec3::x()])
}

/// General cylinder, general cone, one up to its apex and tangent surface, each with a flap.
fn general_flaps() -> [[Face; 2]; 4] {
    let (start, apex) = (100.0 * Vec3::x(), Vec3::new(40.0, 130.0, 10.0));
    let way = Vec3::new(10.0, 90.0, 5.0);
    [
        flap(over_parabola(|p| p + way), [start, way]),
        flap(over_parabola(|p| p + (apex - p) * 0.6), [start, (apex - start) * 0.6]),
        flap(over_parabola(|_| apex), [start, apex - start]),
        tangent_flap([0.5, 1.5]),
    ]
}

#[test]
fn general_cylinders_and_cones_and_tangent_surfaces_are_proven_in_strips_beside_other_faces() {
    for faces in general_flaps() {
        let area: f64 = faces.iter().map(crate::brep::area::area_estimate).sum();
        let answer = answered(faces.to_vec(), None);
        assert_eq!((answer.status(), answer.parts.len()), (Status::Certified, 1), "{:?}", answer.claims);
        assert!((answer.patterns[0].area - area).abs() < 1e-4 * area, "{} {area}", answer.patterns[0].area);
        // Faces without a panel in space are told of.
        let absent = answer.notes.iter().map(|n| match n {
            Note::Unroll(UnrollNote::NotInSpace { faces, .. }) => faces.len(),
            _ => 0,
        });
        assert_eq!(answer.patchwork.faces.len() + absent.sum::<usize>(), 2);
    }
}

#[test]
fn a_fold_along_a_curve_is_drawn_as_that_curve() {
    // A cylinder, a part of which is reflected in the plane of a section.
    let faces = [-60.0, 60.0].map(|z| {
        let mut face = over_parabola(|p| p + Vec3::new(0.0, -80.0, z));
        face.body = 7;
        face
    });
    let answer = answered(faces.to_vec(), None);
    assert_eq!((answer.status(), answer.patterns.len()), (Status::Certified, 1), "{:?}", answer.claims);
    let fold = answer.sheets[0].bends.iter().find(|b| b.kind == BendKind::Fold).expect("a fold");
    let lines = &fold.lines;
    assert!(lines.len() > 4 && lines.windows(2).all(|w| w[0][1] == w[1][0]), "{lines:?}");
    // The length of the parabola 0.008 x (100 − x).
    let length = 100.0 * (0.5 * (1.0 + 0.64_f64).sqrt() + 0.8_f64.asinh() / 1.6);
    assert!((fold.length - length).abs() < 1e-3 * length, "{} {length}", fold.length);
    let chord = (lines[lines.len() - 1][1] - lines[0][0]).norm();
    assert!(chord < 0.99 * fold.length, "{chord}");
}

#[test]
fn strips_that_lie_elsewhere_are_refused_by_the_judge() {
    for faces in general_flaps() {
        let options = PartOptions { surfaces: true, ..PartOptions::new(TOLERANCE) };
        let part = only_near(&faces, &options);
        let strip = part.strips.iter().position(|s| s.len() > 2).expect("strips");
        let judged = |change: &dyn Fn(&mut FlatPart)| {
            let mut forged = part.clone();
            change(&mut forged);
            let proof = super::assessed(&forged, &faces, TOLERANCE);
            [proof.map_surface_distance(), proof.drawing_distance(), proof.joint_gap()]
                .map(|b| b.value())
                .into_iter()
                .fold(0.0, f64::max)
        };
        assert!(judged(&|_| {}) <= TOLERANCE, "{}", judged(&|_| {}));
        let x = 2.0 * TOLERANCE;
        // A strip that is missing, one that is moved alone, and one that is moved with all its images.
        assert!(judged(&|p| {
            p.strips[strip].remove(1);
        })
        .is_infinite());
        assert!(judged(&|p| {
            p.strips[strip].pop();
        })
        .is_infinite());
        assert!(judged(&|p| p.strips[strip][1].shift.y += x).is_infinite());
        let moved = |p: &mut FlatPart| {
            let old = p.strips[strip][1];
            p.strips[strip][1].shift.y += x;
            let strokes = p.strokes.iter_mut().chain(p.joints.iter_mut().flatten().flatten());
            for i in strokes.flat_map(|s| s.images.iter_mut().flatten()) {
                if i.face == strip && (i.map, i.shift) == (old.map, old.shift) {
                    i.shift.y += x;
                }
            }
        };
        assert!(judged(&moved) > TOLERANCE);
        // Angles that its rulings do not have, so that edges of others might pass for its own.
        let wider = |p: &mut FlatPart| {
            let all = &mut p.strips[strip][1].angles;
            *all = [2.0 * all[0] - all[1], 2.0 * all[1] - all[0]];
        };
        assert!(judged(&wider).is_infinite());
        // Strips without the ruling between them.
        assert!(judged(&|p| drop(p.joints.pop())).is_infinite());
    }
}

/// The only part, near enough.
fn only_near(faces: &[Face], options: &PartOptions) -> FlatPart {
    let made = flat_parts(&faces.iter().collect::<Vec<_>>(), "flap", options);
    assert!(made.left.is_empty() && made.parts.len() == 1, "{:?}", made.left);
    made.parts.into_iter().next().expect("a part")
}

#[test]
fn a_part_without_proof_marks_itself_and_no_other() {
    let alone = rectangle(Vec3::new(0.0, 500.0, 0.0), 60.0 * Vec3::x(), 20.0 * Vec3::y());
    let mut twisted = over_parabola(|p| p + Vec3::new(0.0, 90.0, 0.2 * p.x));
    twisted.body = 9;
    for approximate in [None, Some(1.0)] {
        // The order of the parts is that of the bodies.
        // Up to its regression curve no cone stands for the face.
        let answer = answered([&[alone.clone(), twisted.clone()][..], &tangent_flap([0.0, 1.0])].concat(), approximate);
        let marks = crate::answer::marks::Marks::of(&answer);
        assert_eq!(answer.status(), Status::Uncertified);
        assert_eq!(marks.parts[..2], [false, true], "{:?}", answer.claims);
        // Panels that cover the twisted face are proven by themselves.
        assert!(marks.parts[2..].iter().all(|m| !m) && (marks.parts.len() > 2) == approximate.is_some());
        assert_eq!(
            marks.panels,
            marks.parts.iter().zip(&answer.parts).flat_map(|(m, p)| vec![*m; p.count]).collect::<Vec<_>>()
        );
    }
}

#[test]
fn what_cannot_be_covered_is_named_and_the_rest_is_laid_flat() {
    let smooth = over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0));
    let mut twisted = over_parabola(|p| p + Vec3::new(0.0, 90.0, 0.2 * p.x));
    twisted.body = 1;
    let answer = answered(vec![smooth, twisted], Some(1e4));
    assert_eq!((answer.status(), answer.parts.len(), answer.skipped.len()), (Status::Uncertified, 1, 1));
    let reason = why(&answer.skipped[0].reason);
    assert!(reason.contains("tolerance"), "{reason}");
}

#[test]
fn groups_of_bodies_keep_every_face_and_the_names_of_the_whole() {
    let face = |part: &str, body| {
        let mut face = rectangle(Vec3::zeros(), 10.0 * Vec3::x(), 20.0 * Vec3::y());
        (face.part, face.body) = (part.into(), body);
        face
    };
    let faces = vec![face("a", 1), face("b", 2), face("a", 3), face("a", 1), face("c", 4)];
    let (skipped, notes) = (Vec::new(), Vec::new());
    let model = crate::io::model::Model {
        faces,
        skipped,
        notes,
        unit: String::new(),
        products: vec!["whole".into()],
        curves: vec![],
    };
    let made = super::groups(model, 2, 0.05, false);
    let named = |k: usize| made[k].faces.iter().map(|f| (f.part.as_str(), f.body)).collect::<Vec<_>>();
    assert_eq!(made.len(), 2);
    assert_eq!(named(0), [("a 1", 1), ("b", 2), ("a 1", 1)]);
    assert_eq!(named(1), [("a 2", 3), ("c", 4)]);
    assert_eq!(made[1].products, ["whole"]);
}

#[test]
fn sheets_of_one_body_that_are_apart_are_bodies_where_faces_have_no_thickness_and_where_they_are_open() {
    let face = |x: f64, body: u32| {
        let mut face = rectangle(Vec3::new(x, 0.0, 0.0), 10.0 * Vec3::x(), 20.0 * Vec3::y());
        (face.part, face.body) = ("a".into(), body);
        face
    };
    // Two that meet and one that is apart, out of order; and another body.
    let faces = vec![face(40.0, 1), face(0.0, 1), face(10.0, 1), face(90.0, 2)];
    let split = |faces: &[Face], surfaces| -> Vec<Vec<String>> {
        let made = super::groups(model_of(faces.to_vec()), 1, 0.05, surfaces);
        made.iter().map(|m| m.faces.iter().map(|f| f.part.clone()).collect()).collect()
    };
    for surfaces in [false, true] {
        assert_eq!(split(&faces, surfaces), [vec!["a 1-1"], vec!["a 1-2"; 2], vec!["a 2"]]);
    }
    // A solid with a hollow is one body, though its shells are apart.
    let shell = |at: f64, size: f64| {
        let corner = Vec3::repeat(at);
        let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()].map(|a| size * a);
        let sides = [(corner, x, y), (corner, y, z), (corner, z, x)];
        let opposite = [(corner + z, y, x), (corner + x, z, y), (corner + y, x, z)];
        sides.into_iter().chain(opposite).map(|(o, a, b)| rectangle(o, a, b)).collect::<Vec<Face>>()
    };
    let hollow = [shell(0.0, 50.0), shell(20.0, 10.0)].concat();
    assert_eq!(split(&hollow, false).iter().map(Vec::len).collect::<Vec<_>>(), [12]);
    assert_eq!(split(&hollow, true).iter().map(Vec::len).collect::<Vec<_>>(), [6, 6]);
    // Names stay when a group is unrolled for itself.
    let made = super::groups(model_of(faces), 2, 0.05, true);
    let options = super::UnrollOptions { surfaces: true, ..super::UnrollOptions::new(0.05) };
    let answer = super::unroll(&made[0], &options, &crate::control::Control::default()).expect("an answer");
    assert_eq!(answer.parts.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["a 1-1", "a 1-2"]);
}

/// A plate of 100 × 60 × 2 mm, one side of which leans by 45°: it is a side, and named.
#[test]
fn sides_that_are_not_square_are_named() {
    for lean in [0.0, 2.0] {
        let corner = |x: f64, y: f64, z: f64| Vec3::new(x + if x > 0.0 { lean * 0.5 * z } else { 0.0 }, y, z);
        let at = |k: [i32; 3]| corner(100.0 * f64::from(k[0]), 60.0 * f64::from(k[1]), 2.0 * f64::from(k[2]));
        let line = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let faces: Vec<Face> = (0..3)
            .flat_map(|axis: usize| [0, 1].map(|end: i32| (axis, end)))
            .zip(1..)
            .map(|((axis, end), entity)| {
                let of = |a: i32, b: i32| {
                    let mut k = [end; 3];
                    (k[(axis + 1) % 3], k[(axis + 2) % 3]) = (a, b);
                    at(k)
                };
                let points = [of(0, 0), of(0, 1), of(1, 0), of(1, 1)];
                let surface = Surface::new(line.clone(), line.clone(), &points, None).expect("a surface");
                let mut face = Face::untrimmed(surface);
                (face.entity, face.reversed) = (entity, end == 0);
                face
            })
            .collect();
        let part = laid(&faces, 0.44);
        near(part.sheet.thickness, 2.0);
        // The larger skin is drawn.
        near(part.pattern.area, 60.0 * (100.0 + lean));
        assert_eq!(part.slanting, if lean > 0.0 { vec![2] } else { vec![] });
    }
}
