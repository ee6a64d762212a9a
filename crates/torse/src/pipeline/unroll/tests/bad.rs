//! Broken faces beside good ones, in every format: the broken one is named with its fault, the good one is laid flat.

use super::super::proofs::fault;
use super::super::{unroll, UnrollOptions};
use crate::answer::marks::Marks;
use crate::answer::Answer;
use crate::certify::claim::Status;
use crate::control::Control;
use crate::develop::unfold::bends::BendKind;
use crate::develop::unfold::part::{flat_parts, PartOptions};
use crate::geom::{Frame, Vec3};
use crate::io::step::write::{self as step, sewn, Header};
use crate::io::words::why;
use crate::io::{cad, iges, threedm};
use crate::patchwork::panel::{Border, Coedge, Panel, Patchwork};
use crate::reason::Reason;
use crate::spline::curve::Curve;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// Closed polygons.
type Loops = &'static [&'static [[f64; 2]]];

/// A plane face of 100 mm with closed polygons for its border, in shares of its sides.
fn face(name: &str, corner: Vec3, loops: &[&[[f64; 2]]]) -> Panel {
    let (x, y) = (100.0 * Vec3::x(), 100.0 * Vec3::y());
    let strip =
        Strip::quad(name, PanelKind::Plane, [corner, corner + y], [corner + x, corner + x + y]).expect("a strip");
    let line = |l: &&[[f64; 2]]| {
        let side = |k: usize| {
            let (p, q) = (l[k], l[(k + 1) % l.len()]);
            let space = [p, q].map(|p| <[f64; 3]>::from(strip.patch.point(p[0], p[1])));
            let knots = vec![0.0, 0.0, 1.0, 1.0];
            Coedge {
                border: Border::Trim { edge: k as u32 },
                vertices: Vec::new(),
                parameters: vec![0.0, 1.0],
                trim: Curve::new(1, knots.clone(), vec![p, q]).expect("a curve"),
                edge: Curve::new(1, knots, space.to_vec()).expect("a curve"),
            }
        };
        (0..l.len()).map(side).collect::<Vec<_>>()
    };
    let outline = loops.iter().map(line).collect();
    Panel { strip, trim: None, outline }
}

/// The panels as files of three formats.
fn files(panels: Vec<Panel>) -> [(&'static str, Vec<u8>); 3] {
    let header = Header { name: "bad".into(), time: "2026-01-31T12:00:00".into(), uncertainty: 1e-6 };
    let patchwork = Patchwork { panels, ..Patchwork::default() };
    let bytes = step::panels(&header, &patchwork, &[]).expect("a file");
    let sheets = sewn::shells(&patchwork, &[]);
    [
        ("STEP", bytes),
        ("IGES", iges::write::panels(&header, &patchwork, &[])),
        ("3DM", threedm::write::shells(&header, &sheets).expect("a file")),
    ]
}

const SQUARE: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

fn laid(format: &str, bytes: &[u8]) -> Answer {
    let model = cad::read(bytes).unwrap_or_else(|e| panic!("{format}: {e}"));
    let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(0.05) };
    unroll(&model, &options, &Control::default()).unwrap_or_else(|e| panic!("{format}: {e}"))
}

#[test]
fn borders_that_are_none_are_named_and_the_other_faces_are_laid_flat() {
    let cases: [(&str, Loops, &str); 7] = [
        ("crossing", &[&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.7]]], "crosses or touches itself"),
        (
            "touching",
            &[&[[0.0, 0.0], [0.5, 0.5], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5], [0.0, 1.0]]],
            "crosses or touches itself",
        ),
        (
            "hole beyond",
            &[&[[0.0, 0.0], [0.8, 0.0], [0.8, 1.0], [0.0, 1.0]], &[[0.5, 0.4], [0.5, 0.6], [0.95, 0.6], [0.95, 0.4]]],
            "crosses or touches itself",
        ),
        ("hole on an edge", &[SQUARE, &[[0.0, 0.2], [0.0, 0.8], [0.3, 0.5]]], "crosses or touches itself"),
        ("all hole", &[SQUARE, &[[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]], "crosses or touches itself"),
        (
            "two holes",
            &[
                SQUARE,
                &[[0.2, 0.2], [0.2, 0.6], [0.6, 0.6], [0.6, 0.2]],
                &[[0.4, 0.4], [0.4, 0.8], [0.8, 0.8], [0.8, 0.4]],
            ],
            "crosses or touches itself",
        ),
        ("sliver", &[&[[0.0, 0.0], [1.0, 0.0], [1.0, 1e-6]]], "nothing is left of its outline"),
    ];
    for (case, loops, fault) in cases {
        let panels = vec![face("good", Vec3::new(300.0, 0.0, 0.0), &[SQUARE]), face("bad", Vec3::zeros(), loops)];
        for (format, bytes) in files(panels) {
            let answer = laid(format, &bytes);
            let told: Vec<String> = answer.skipped.iter().map(|s| why(&s.reason)).collect();
            assert_eq!((answer.patterns.len(), told.len()), (1, 1), "{format}, {case}: {told:?}");
            // IGES has too few digits to tell the corners of the sliver apart.
            let fault = if (format, case) == ("IGES", "sliver") { "the boundary is open" } else { fault };
            assert!(told[0].contains(fault), "{format}, {case}: {told:?}");
            assert!(
                answer.skipped[0].entity.is_some_and(|e| e > 0),
                "{format}, {case}: the face is named by its number"
            );
            assert!((answer.patterns[0].area - 1e4).abs() < 1e-6);
            // The good part may be cut, the whole is not certified.
            assert_eq!((answer.status(), Marks::of(&answer).parts), (Status::Uncertified, vec![false]), "{case}");
        }
    }
}

#[test]
fn faces_that_close_on_themselves_are_named_with_what_flattening_them_would_need() {
    use crate::brep::face::Face;
    use crate::brep::support_surface::SupportSurface;
    use std::f64::consts::{FRAC_PI_2, TAU};
    let frame = Frame::world();
    for (support, v) in [
        (SupportSurface::Torus { frame, major: 100.0, minor: 20.0 }, (0.0, TAU)),
        (SupportSurface::Sphere { frame, radius: 50.0 }, (-FRAC_PI_2, FRAC_PI_2)),
    ] {
        let closed = Face::untrimmed(support.to_spline((0.0, TAU), v).expect("a spline").0);
        let good = super::rectangle(Vec3::new(300.0, 0.0, 0.0), 100.0 * Vec3::x(), 100.0 * Vec3::y());
        let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(0.05) };
        let answer = unroll(&super::model_of(vec![closed, good]), &options, &Control::default()).expect("an answer");
        let told = why(&answer.skipped[0].reason);
        assert!((answer.patterns.len(), answer.skipped.len()) == (1, 1), "{told}");
        let strain = told.split("strain of about ").nth(1).and_then(|s| s.split(';').next());
        let strain: f64 = strain.and_then(|s| s.parse().ok()).expect("a strain");
        assert!(strain > 0.5 && told.contains("--approximate"), "{told}");
    }
}

#[test]
fn a_face_with_sharp_edges_inside_is_bent_about_them() {
    use crate::brep::face::Face;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    let extruded = |across: Knots, profile: &[[f64; 2]]| {
        let points: Vec<Vec3> = profile.iter().flat_map(|p| [0.0, 90.0].map(|y| Vec3::new(p[0], y, p[1]))).collect();
        let along = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        Face::untrimmed(Surface::new(across, along, &points, None).expect("a surface"))
    };
    let polyline = Knots::clamped(1, &[0.0, 1.0, 2.0, 3.0]).expect("knots");
    // Control points that coincide make a corner where the knot is a simple one.
    let quadratic = Knots::clamped(2, &[0.0, 1.0, 2.0]).expect("knots");
    let gable = |lift: f64| vec![[0.0, 0.0], [40.0, 0.0], [80.0, lift], [120.0, 0.0]];
    let corner = vec![[0.0, 0.0], [40.0, 0.0], [40.0, 0.0], [40.0, 50.0]];
    for (across, profile, folds) in [
        (&polyline, gable(0.0), vec![]),
        (&polyline, gable(0.1), vec![]),
        (&polyline, gable(30.0), vec![36.8699, 73.7398]),
        (&quadratic, corner, vec![90.0]),
    ] {
        let face = extruded(across.clone(), &profile);
        // Laid flat as it is, such a face is named: its bend table would not tell of the edges.
        let whole =
            flat_parts(&[&face], "gable", &PartOptions { surfaces: true, ..PartOptions::new(0.05) }).parts.remove(0);
        let told = fault(&whole, std::slice::from_ref(&face), false).map(Reason::from).map(|r| why(&r));
        assert_eq!(told.as_ref().is_some_and(|t| t.contains("sharp edge inside")), !folds.is_empty(), "{told:?}");
        let answer = super::answered(vec![face], None);
        let told: Vec<String> = answer.claims.iter().filter_map(|c| c.reason()).map(why).collect();
        assert_eq!((answer.status(), answer.patterns.len()), (Status::Certified, 1), "{told:?}");
        let bends = answer.sheets[0].bends.iter().filter(|b| b.kind == BendKind::Fold);
        let mut angles: Vec<f64> = bends.map(|b| b.angle.to_degrees().abs()).collect();
        angles.sort_by(f64::total_cmp);
        assert_eq!(angles.len(), folds.len(), "{angles:?}");
        assert!(angles.iter().zip(&folds).all(|(a, f)| (a - f).abs() < 1e-3), "{angles:?}");
        let length: f64 = profile.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum();
        assert!((answer.patterns[0].length.max(answer.patterns[0].width) - length).abs() < 1e-6 * length);
    }
}

/// A curved face with a sharp edge, read from a file, is covered once, on each side of its edge.
#[test]
fn a_curved_face_with_a_sharp_edge_is_covered_once() {
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;
    let (across, along) = (Knots::clamped(1, &[0.0, 1.0, 2.0]), Knots::clamped(1, &[0.0, 1.0]));
    let ends = [(0.0, 0.0, 0.0), (100.0, 0.0, 25.0), (200.0, 80.0, 20.0)];
    let points: Vec<Vec3> = ends.iter().flat_map(|e| [Vec3::new(e.0, 0.0, e.1), Vec3::new(e.0, 100.0, e.2)]).collect();
    let surface = Surface::new(across.expect("knots"), along.expect("knots"), &points, None).expect("a surface");
    let header = Header { name: "roof".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-6 };
    let bytes = step::shells(&header, &[step::Shell::untrimmed("roof", &surface)]).expect("a file");
    let model = crate::read(&bytes).expect("a model");
    assert!(model.faces.len() == 1 && model.faces[0].boundary.is_some());
    let options = UnrollOptions { surfaces: true, approximate: Some(4.0), ..UnrollOptions::new(0.05) };
    let answer = unroll(&model, &options, &Control::default()).expect("an answer");
    let told: Vec<String> = answer.claims.iter().filter_map(|c| c.reason()).map(why).collect();
    assert_eq!(answer.status(), Status::Certified, "{told:?}");
    let area: f64 = answer.patterns.iter().map(|p| p.area).sum();
    let whole = crate::brep::area::area_estimate(&model.faces[0]);
    assert!((area - whole).abs() < 0.02 * whole, "{area} {whole}");
}

#[test]
fn covers_are_written_to_their_own_tolerance_beside_a_finer_one() {
    let model = crate::read(include_bytes!("../../../../../../data/torus_piece.step")).expect("a model");
    let options = UnrollOptions { surfaces: true, approximate: Some(4.0), ..UnrollOptions::new(0.01) };
    let mut answer = unroll(&model, &options, &Control::default()).expect("an answer");
    crate::pipeline::deliver::files(&mut answer, "2026-01-01T00:00:00").expect("files");
    let told: Vec<String> = answer.claims.iter().filter_map(|c| c.reason()).map(why).collect();
    assert_eq!(answer.status(), Status::Certified, "{told:?}");
}
