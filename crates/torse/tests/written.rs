//! Flat patterns and written files are judged: what is as it should be is proven, what is off by little is seen.

use std::sync::OnceLock;
use torse::answer::presentation::present;
use torse::answer::Answer;
use torse::certify;
use torse::certify::claim::Status;
use torse::certify::flat::flat;
use torse::control::Control;
use torse::geom::Vec2;
use torse::io::bundle::{self, File};
use torse::io::step::read::read;
use torse::io::words;
use torse::pipeline::approximate::{of_faces, Options};
use torse::pipeline::deliver;

const TOLERANCE: f64 = 10.0;

fn answer() -> &'static Answer {
    static ANSWER: OnceLock<Answer> = OnceLock::new();
    ANSWER.get_or_init(|| run(include_bytes!("../../../data/torus_piece.step"), TOLERANCE))
}

fn run(bytes: &[u8], tolerance: f64) -> Answer {
    let model = read(bytes).expect("a model");
    let options = Options { meet: false, smooth_angle: 0.0, ..Options::new(tolerance) };
    of_faces(model.faces, Vec::new(), &options, &Control::default()).expect("an answer")
}

fn files() -> &'static Vec<File> {
    static FILES: OnceLock<Vec<File>> = OnceLock::new();
    FILES.get_or_init(|| {
        let o = answer();
        bundle::geometry(o, &present(o), "2026-01-01T00:00:00").expect("files")
    })
}

#[test]
fn patterns_of_a_certified_result_are_proven_closely() {
    let o = answer();
    assert_eq!(o.status(), Status::Certified);
    for (f, p) in o.flat().iter().zip(o.patterns()) {
        assert!(f.holds(), "{:?}", f.reason());
        assert!(f.strain_bound() < 1e-8, "{:e}", f.strain_bound());
        assert!(f.outline_bound() < 1.1 * p.contour_error, "{} {}", f.outline_bound(), p.contour_error);
        assert!(f.ruling_bound() < 1e-6 && f.mark_bound() < 1e-6, "{f:?}");
    }
}

#[test]
fn a_pattern_changed_by_more_than_its_bound_is_seen() {
    let o = answer();
    let judged = |change: &dyn Fn(&mut torse::patchwork::pattern::Pattern)| {
        let mut patterns = o.patterns().to_vec();
        change(&mut patterns[0]);
        flat(o.patchwork(), &patterns, TOLERANCE, &Control::default()).swap_remove(0)
    };
    let by = 2.0 * o.flat()[0].drawing_bound();
    let moved = judged(&|p| p.contours[0].vertices[3].point.y += by);
    assert!(moved.outline_bound() > 0.5 * by && moved.outline_bound() < 2.0 * by, "{moved:?}");
    let bulged = judged(&|p| p.contours[0].vertices[1].bulge += 0.5);
    assert!(bulged.outline_bound() > by, "{bulged:?}");
    let turned = judged(&|p| {
        let v = p.rulings[0][1] - p.rulings[0][0];
        p.rulings[0][0] += Vec2::new(-v.y, v.x).normalize() * by;
    });
    assert!(turned.ruling_bound() > 0.05 * by, "{turned:?}");
    let far = judged(&|p| p.contours[0].vertices.iter_mut().for_each(|v| v.point.x *= 1.5));
    assert!(!far.holds());
}

#[test]
fn edges_in_space_are_part_of_the_proof() {
    let o = answer();
    let proof = |by: f64| {
        let mut p = o.patchwork().clone();
        let k = p.panels[0].loops()[0][0].edge.control.len() / 2;
        p.panels[0].loops_mut()[0][0].edge.control[k][1] += by;
        certify::patchwork(&p, TOLERANCE, &Control::default())
    };
    assert!(proof(0.0).certified);
    for by in [1000.0, f64::NAN] {
        let c = proof(by);
        assert!(!c.certified && !c.missing.is_empty(), "{by}");
    }
}

#[test]
fn files_that_hold_what_was_judged_keep_the_certificate() {
    let mut o = answer().clone();
    deliver::judge(&mut o, files());
    assert_eq!(o.status(), Status::Certified);
    let names: Vec<&str> = o.written().iter().map(|w| w.0.as_str()).collect();
    assert_eq!(names, ["panels.step", "patterns.dxf", "patterns.svg"]);
    assert!(o.written().iter().all(|(_, w)| w.bound() < 1e-5), "{:?}", o.written());
}

#[test]
fn panels_with_poles_and_panels_that_share_edges_are_read_back_as_judged() {
    let pipe = run(include_bytes!("../../../data/cylinder_holes.step"), 1.0);
    for (mut o, meet) in [(super::shop::bowl().clone(), true), (pipe, false)] {
        assert_eq!(o.status(), Status::Certified, "{}", words::reason(o.claims(), &[]));
        let written = bundle::geometry(&o, &present(&o), "2026-01-01T00:00:00").expect("files");
        deliver::judge(&mut o, &written);
        assert_eq!(o.status(), Status::Certified, "{}", words::reason(o.claims(), &[]));
        if meet {
            // Curves that run backwards have rounded knots; what these move is known.
            assert!(o.written()[0].1.bound() < 1e-9, "{:?}", o.written());
        }
    }
}

/// Replaces a piece of text after a mark, once.
fn changed(bytes: &[u8], after: &str, from: &str, to: &str) -> Vec<u8> {
    let text = String::from_utf8(bytes.to_vec()).expect("text");
    let at = text.find(after).expect("the place");
    let (head, tail) = text.split_at(at);
    assert!(tail.contains(from), "{from}");
    (head.to_owned() + &tail.replacen(from, to, 1)).into_bytes()
}

fn tampered(file: &str, after: &str, from: &str, to: &str) -> Vec<File> {
    let mut all = files().clone();
    let (_, bytes) = all.iter_mut().find(|f| f.0 == file).expect("the file");
    *bytes = changed(bytes, after, from, to);
    all
}

#[test]
fn any_other_file_loses_it_and_is_named() {
    for (file, after, from, to) in [
        // A control point of the first surface or curve that comes, far enough to matter.
        ("panels.step", "B_SPLINE_CURVE_WITH_KNOTS('',3", "CARTESIAN_POINT('',(", "CARTESIAN_POINT('',(1"),
        ("panels.step", "ORIENTED_EDGE('',*,*,", ".T.", ".F."),
        ("panels.step", "SI_UNIT(", ".MILLI.", ".CENTI."),
        ("panels.step", "FACE_OUTER_BOUND(", ".T.", ".F."),
        ("panels.step", "ADVANCED_FACE('", "ADVANCED_FACE('A", "ADVANCED_FACE('B"),
        ("panels.step", "ENDSEC;\nEND", "ENDSEC;\nEND", "END"),
        ("patterns.dxf", "CUT_OUTER\n100\nAcDbPolyline", " 10\n", " 10\n9"),
        ("patterns.dxf", "ENTITIES\n", "AcDbLine\n 10\n", "AcDbLine\n 10\n9"),
        ("patterns.dxf", "ENTITIES\n", "\nBEND_", "\nBENT_"),
        ("patterns.dxf", "\nMARK\n100\nAcDbLine", " 10\n", " 10\n9"),
        ("patterns.dxf", "$INSUNITS", "     4", "     1"),
        ("patterns.svg", "class=\"cut-outer\"", "d=\"M", "d=\"M9"),
        ("patterns.svg", "class=\"marks\"", "d=\"M", "d=\"M9"),
        ("patterns.svg", "<svg", "mm\"", "in\""),
    ] {
        let mut o = answer().clone();
        deliver::judge(&mut o, &tampered(file, after, from, to));
        assert_eq!(o.status(), Status::Uncertified, "{file}: {from} became {to} unseen");
        let reason = words::reason(o.claims(), &[]);
        assert!(reason.contains(file), "{reason}");
    }
}

/// A fan, a plane and a cylinder: strips between a straight edge and an arc that begins at it.
fn lofted() -> Answer {
    use torse::io::curves::{read as curve, CurveOptions};
    use torse::pipeline::loft::{loft, Options};
    let rail = |name: &str, bytes: &[u8]| {
        let options = CurveOptions { name: name.into(), select: String::new(), unit: None, polyline: false };
        curve(bytes, &options).expect("a rail").0
    };
    let a = rail("square", include_bytes!("../../../data/duct_square.dxf"));
    let b = rail("round", include_bytes!("../../../data/duct_round.dxf"));
    loft(&a, &b, &Options::new(0.1), &Control::default()).expect("strips")
}

#[test]
fn strips_are_read_back_too() {
    let answer = lofted();
    assert_eq!(answer.status(), Status::Certified, "{}", words::reason(answer.claims(), &[]));
    let all = torse::io::bundle::geometry(&answer, &present(&answer), "2026-01-01T00:00:00").expect("files");
    let judged = |files: &[File]| {
        let mut s = answer.clone();
        deliver::judge(&mut s, files);
        (s.status(), words::reason(s.claims(), &[]))
    };
    assert_eq!(judged(&all), (Status::Certified, String::new()));
    for (file, after, from, to) in [
        // A vertex, a plane's normal, weights of a cone, its name, the unit, an edge of a loop.
        ("panels.step", "DATA", "CARTESIAN_POINT('',(-300.", "CARTESIAN_POINT('',(-301."),
        ("panels.step", "VERTEX_POINT", "DIRECTION('',(0.,-0.99", "DIRECTION('',(0.,-0.89"),
        ("panels.step", "RATIONAL_B_SPLINE_SURFACE", "(1.,", "(2.,"),
        ("panels.step", "DATA", "ADVANCED_FACE('", "ADVANCED_FACE('X"),
        ("panels.step", "DATA", ".MILLI.", ".CENTI."),
        ("panels.step", "DATA", "ORIENTED_EDGE('',*,*,#", "ORIENTED_EDGE('',*,*,#1"),
        ("patterns.dxf", "CUT_OUTER\n100\nAcDbPolyline", " 10\n", " 10\n9"),
        ("patterns.svg", "class=\"cut-outer\"", "d=\"M", "d=\"M9"),
    ] {
        let mut bad = all.clone();
        let bytes = &mut bad.iter_mut().find(|f| f.0 == file).expect("the file").1;
        *bytes = changed(bytes, after, from, to);
        let (status, reason) = judged(&bad);
        assert!(status == Status::Uncertified && reason.contains(file), "{file}: {from} became {to}: {reason}");
    }
}
