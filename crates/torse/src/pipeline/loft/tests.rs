//! Lofts that are known, and rails that cannot be joined.

use super::*;
use crate::answer::note::EndNote;
use crate::answer::note::Note;
use crate::brep::space_curve::SpaceCurve;
use crate::certify::claim::Status;
use crate::certify::claim::{Claim, Subject};
use crate::geom::{Frame, Vec3};
use crate::io::words;
use crate::search::strips::exact_strip::ExactError;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;
use std::f64::consts::TAU;

fn made(a: &Rail, b: &Rail, options: &Options) -> Answer {
    loft(a, b, options, &Control::default()).expect("an answer")
}

fn figure(s: &Answer, name: &str) -> f64 {
    let curves: Vec<String> = s.guides.iter().map(|g| g.name.clone()).collect();
    s.claims_of(Subject::Whole).find(|c| words::name(c, &curves) == name).map_or(f64::NAN, Claim::value)
}

/// A duct from a square that starts in the middle of an edge to a circle whose seam lies anywhere.
fn duct(seam: f64) -> (Rail, Rail) {
    let points = [(0.0, -300.0), (300.0, -300.0), (300.0, 300.0), (-300.0, 300.0), (-300.0, -300.0), (0.0, -300.0)];
    let square = Rail::polyline("square", &points.map(|(x, y)| Vec3::new(x, y, 0.0))).expect("rail");
    let (s, c) = seam.sin_cos();
    let frame = Frame {
        origin: Vec3::new(50.0, 20.0, 500.0),
        x: Vec3::new(c, s, 0.1).normalize(),
        y: Vec3::new(-s, c, 0.0).normalize(),
        z: Vec3::z(),
    };
    let frame = Frame { z: frame.x.cross(&frame.y), ..frame };
    let (round, _) = SpaceCurve::Ellipse { frame, a: 175.0, b: 175.0 }.to_spline(0.0, TAU).expect("spline");
    (square, Rail::new("round", &[round]).expect("rail"))
}

#[test]
fn a_duct_is_four_triangles_and_four_cones_wherever_its_drawings_start() {
    for seam in [0.0, 0.4, 2.0] {
        let (a, b) = duct(seam);
        let answer = made(&a, &b, &Options::new(1e-6));
        assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
        let count = |kind| answer.strips().filter(|s| s.kind == kind).count();
        assert_eq!(
            (count(PanelKind::Plane), count(PanelKind::Cone), answer.patchwork.panels.len()),
            (4, 4, 8),
            "{seam}"
        );
    }
}

#[test]
fn the_crease_between_two_triangles_is_told() {
    let line = |name: &str, p: Vec3, q: Vec3| Rail::polyline(name, &[p, q]).expect("rail");
    let a = line("a", Vec3::zeros(), Vec3::new(100.0, 0.0, 0.0));
    let b = line("b", Vec3::new(0.0, 100.0, 0.0), Vec3::new(100.0, 100.0, 100.0));
    let answer = made(&a, &b, &Options::new(1e-3));
    let crease = |n: &Note| match n {
        Note::Loft(LoftNote::Creases { count: 1, sharpest, .. }) => Some(sharpest.to_degrees()),
        _ => None,
    };
    let told = answer.notes.iter().find_map(crease);
    assert!(told.is_some_and(|a| (a - 54.7).abs() < 0.1 || (a - 45.0).abs() < 0.1), "{:?}", answer.notes);
    // Smooth ones have none.
    let (a, b) = duct(0.4);
    let smooth = made(&a, &b, &Options::new(1e-3));
    assert!(!smooth.notes.iter().any(|n| matches!(n, Note::Loft(LoftNote::Creases { .. }))));
    let far = line("far", Vec3::new(200.0, 0.0, 0.0), Vec3::new(300.0, 0.0, 0.0));
    let near = line("near", Vec3::zeros(), Vec3::new(100.0, 0.0, 0.0));
    let refused = loft(&near, &far, &Options::new(1e-3), &Control::default());
    assert!(matches!(refused, Err(LoftError::OneLine { .. })), "{refused:?}");
}

/// Two arcs over a common cylinder, the second one longer at its end.
fn arcs() -> (Rail, Rail) {
    let arc = |name: &str, to: f64, z: f64, r: f64| {
        let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a: r, b: r }.to_spline(0.0, to).expect("spline");
        Rail::new(name, &[c]).expect("rail")
    };
    (arc("short", 1.2, 0.0, 100.0), arc("long", 1.9, 60.0, 80.0))
}

#[test]
fn ends_are_trimmed_fanned_or_extended() {
    let (a, b) = arcs();
    let with = |ends| made(&a, &b, &Options { ends, ..Options::new(0.01) });
    let ring = |r: f64, s: f64, h: f64, angle: f64| 0.5 * angle * (r + s) * (h * h + (r - s) * (r - s)).sqrt();
    let area = |s: &Answer| s.strips().map(Strip::area_estimate).sum::<f64>();
    let trimmed = with(Ends::Trim);
    assert_eq!(trimmed.status(), Status::Uncertified);
    let reason = words::reason(&trimmed.claims, &[]);
    assert!(reason.starts_with("certified in part: 63.1 % of long"), "{reason}");
    // Both edges, 200 mm long in all, may lie up to the tolerance off.
    assert!((area(&trimmed) - ring(100.0, 80.0, 60.0, 1.2)).abs() < 0.01 * 200.0);
    let cut_short = |n: &Note| matches!(n, Note::Loft(LoftNote::Ends(EndNote::Used { rail, .. })) if rail == "long");
    assert!(trimmed.notes.iter().any(cut_short), "{:?}", trimmed.notes);
    // The rest of the long rail is joined to the end of the short one.
    let fanned = with(Ends::Fan);
    assert_eq!(fanned.status(), Status::Certified, "{:?} {:?}", fanned.claims, fanned.notes);
    let tip = a.point(1.0);
    let fan: Vec<&Strip> = fanned.strips().filter(|s| s.is_point(0)).collect();
    assert_eq!(fan.len(), 1);
    assert!((fan[0].ruling(0.5)[0] - tip).norm() < 1e-9);
    assert!((fan[0].ruling(1.0)[1] - b.point(1.0)).norm() < 1e-9);
    // The short rail goes on along its tangent.
    let extended = with(Ends::Extend);
    assert_eq!(extended.status(), Status::Uncertified, "past the end");
    let reason = words::reason(&extended.claims, &[]);
    assert!(reason.starts_with("certified in part:") && reason.contains("past the ends of short"), "{reason}");
    let longer = |n: &Note| matches!(n, Note::Loft(LoftNote::Ends(EndNote::Extended { .. })));
    assert!(area(&extended) > area(&trimmed) && extended.notes.iter().any(longer));
}

#[test]
fn alternatives_fixed_rulings_and_least_twist_are_what_was_asked_for() {
    let (a, b) = arcs();
    let e = loft(&a, &b, &Options { alternative: 9, ..Options::new(0.01) }, &Control::default()).expect_err("none");
    assert!(matches!(e, LoftError::NoAlternative { asked: 9, .. }), "{e}");
    let fixed = made(&a, &b, &Options { fixed: vec![[0.5, 0.3]], ..Options::new(0.01) });
    let at = |rail: &Rail, share: f64| {
        let all = (0..=2000).map(|k| f64::from(k) / 2000.0);
        rail.point(
            all.min_by(|s, t| {
                let off = |s: f64| (rail.length_to(s) - share * rail.length()).abs();
                off(*s).total_cmp(&off(*t))
            })
            .expect("some"),
        )
    };
    let (p, q) = (at(&a, 0.5), at(&b, 0.3));
    let met = fixed.strips().flat_map(|s| [s.ruling(0.0), s.ruling(1.0)]);
    // Within the step of the search above.
    assert!(met.into_iter().any(|r| (r[0] - p).norm() < 0.1 && (r[1] - q).norm() < 0.1));
    assert!(fixed.status() == Status::Uncertified && fixed.patchwork.panels.len() < 10);
    assert!(figure(&fixed, "twist") > 1e-3, "{:?} {:?}", fixed.claims, fixed.notes);
    let least = made(&a, &b, &Options { choice: Choice::LeastTwist, ..Options::new(0.01) });
    assert!(least.notes.contains(&Note::Loft(LoftNote::LeastTwist)));
}

#[test]
fn tolerances_beyond_rounding_end_soon_and_say_what_is_met() {
    // A circle and an ellipse: no exact spline, so that work would have no end.
    let ring = |name: &str, z: f64, a: f64, b: f64| {
        let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
        let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
        Rail::new(name, &[c]).expect("rail")
    };
    let (a, b) = (ring("a", 0.0, 100.0, 100.0), ring("b", 120.0, 150.0, 60.0));
    let s = made(&a, &b, &Options::new(1e-14));
    assert_eq!(s.status(), Status::Uncertified);
    let reason = words::reason(&s.claims, &[]);
    assert!(reason.contains(" mm is met") && figure(&s, "from a") < 1e-7, "{reason}");
    // An exact one is found at once where the tolerance allows, and is worth its name.
    let s = made(&a, &b, &Options::new(0.01));
    assert!(s.status() == Status::Certified && figure(&s, "twist, bound") < 1e-4, "{:?}", s.claims);
    assert!(s.notes.iter().any(|n| matches!(n, Note::Loft(LoftNote::Exact(_)))), "{:?}", s.notes);
    let stopped = Control::default();
    stopped.cancel();
    let s = loft(&a, &b, &Options::new(0.01), &stopped).expect("an answer");
    let early = |n: &Note| matches!(n, Note::Loft(LoftNote::Ruled { why: ExactError::NotLookedFor, .. }));
    assert!(s.status() == Status::Certified && s.notes.iter().any(early), "{:?}", s.notes);
}

#[test]
fn rails_that_touch_and_bad_tolerances_are_refused() {
    let (a, _) = arcs();
    let e = loft(&a, &a, &Options::new(0.01), &Control::default()).expect_err("the same");
    assert!(e.to_string().contains("short"), "{e}");
    let again = Rail { name: "again".into(), ..a.clone() };
    let e = loft(&a, &again, &Options::new(0.01), &Control::default()).expect_err("the same");
    assert!(e.to_string().contains("short runs along again"), "{e}");
    let crossing = Rail::polyline("crossing", &[a.point(0.5) - Vec3::z() * 9.0, a.point(0.5) + Vec3::z() * 30.0]);
    let e = loft(&a, &crossing.expect("rail"), &Options::new(0.01), &Control::default()).expect_err("touch");
    assert!(matches!(e, LoftError::Touch { .. }), "{e}");
    for t in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(loft(&a, &a, &Options::new(t), &Control::default()), Err(LoftError::Tolerance(_))));
    }
}
