//! Nets that are known, and questions that cannot be asked.

use super::*;
use crate::answer::note::Note;
use crate::certify::claim::Status;
use crate::io::words;
use crate::spline::knots::Knots;
use crate::torse::form::PanelKind;

/// The worked example of the specification of nets, 250 mm to the unit.
fn keel() -> Rail {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.3], [2.0, 0.75, 0.6], [3.0, 0.5, 0.5], [4.0, 0.0, 0.125]];
    let knots = Knots::clamped(3, &[0.0, 0.5, 1.0]).expect("knots");
    let control = points.map(|p| [250.0 * p[0], 250.0 * p[1], 250.0 * p[2], 1.0]).to_vec();
    Rail::new("keel", &[Curve { knots, control }]).expect("rail")
}

fn first() -> Vec3 {
    Vec3::new(62.5, 250.0, 0.0)
}

fn last(x: f64, y: f64, z: f64, width: Option<f64>) -> Condition {
    Condition::LastRuling { direction: Vec3::new(x, y, z), width }
}

fn made(options: &Options) -> Answer {
    net(&keel(), options, &Control::default()).expect("an answer")
}

fn figure(s: &Answer, name: &str) -> f64 {
    let curves: Vec<String> = s.guides.iter().map(|g| g.name.clone()).collect();
    s.claims_of(Subject::Whole).find(|c| words::name(c, &curves) == name).map_or(f64::NAN, Claim::value)
}

#[test]
fn the_worked_example_is_certified_with_its_numbers() {
    let s = made(&Options::new(1e-3, first(), last(-0.25, 1.0, 0.125, None)));
    assert_eq!(s.status(), Status::Certified, "{:?}", s.claims);
    assert!((figure(&s, "M*") - 1.369_415_885_318_557_6).abs() < 1e-9);
    assert!((figure(&s, "Λ*") - 1.362_462_674_853_677_2).abs() < 1e-9);
    assert!(figure(&s, "from keel") < 1e-9 && figure(&s, "twist, bound") < 1e-8);
    let told = |n: &Note| matches!(n, Note::Net(NetNote::Regression { at, .. }) if (at[0] - 196.9473).abs() < 1e-4);
    assert!(s.notes.iter().any(told), "{:?}", s.notes);
    let end = s.patchwork.panels[0].strip.ruling(1.0)[1];
    let expected = Vec3::new(3.994_013_734_506_109, 0.023_945_061_975_563, 0.127_993_132_746_945) * 250.0;
    assert!((end - expected).norm() < 1e-6, "{end}");
    let both = made(&Options::new(1e-3, first(), last(-0.25, 1.0, 0.125, Some(200.0))));
    let r = both.patchwork.panels[0].strip.ruling(1.0);
    assert!(both.status() == Status::Certified && ((r[1] - r[0]).norm() - 200.0).abs() < 1e-9);
}

#[test]
fn free_parameters_make_tangent_surfaces_cones_and_cylinders() {
    for (condition, kind) in [
        (Condition::Stars { m_star: 1.5, lambda_star: 1.4 }, PanelKind::Torse),
        (Condition::Shape { m: 0.0, kappa: 0.3 }, PanelKind::Cone),
        (Condition::Shape { m: 0.0, kappa: 0.0 }, PanelKind::Cylinder),
    ] {
        for along in [[0.0, 1.0], [-0.05, 1.1], [0.2, 0.7]] {
            let s = made(&Options { along, ..Options::new(1e-3, first(), condition) });
            assert_eq!((s.status(), s.patchwork.panels[0].strip.kind), (Status::Certified, kind), "{along:?}");
            assert!(figure(&s, "from keel") < 1e-8, "{along:?} {:?}", s.claims);
            let end = keel().pieces[0].extended(-1.0, 2.0).expect("curve").point(along[1]);
            assert!((s.patchwork.panels[0].strip.ruling(1.0)[0] - Vec3::new(end[0], end[1], end[2])).norm() < 1e-9);
        }
    }
}

#[test]
fn what_has_no_regular_answer_says_why_and_has_no_strips() {
    let s = made(&Options { polynomial: true, ..Options::new(1e-3, first(), last(0.0, -1.0, 0.5, None)) });
    assert_eq!(s.status(), Status::Uncertified);
    let reason = words::reason(&s.claims, &[]);
    assert!(reason.contains("pattern ++++") && s.patchwork.panels.is_empty() && s.patterns.is_empty(), "{reason}");
    let s = made(&Options::new(1e-3, first(), Condition::Stars { m_star: 0.7, lambda_star: 1.4 }));
    assert_eq!(s.status(), Status::Uncertified);
    let reason = words::reason(&s.claims, &[]);
    assert!(reason.contains("u = 0.7000"), "{reason}");
}

/// A width that no strip has on this side of its regression curve: what is made is told as a part of what was asked.
#[test]
fn a_narrower_strip_is_certified_in_part() {
    let first = Vec3::new(-0.874, -0.486, 0.654).normalize() * 1500.0;
    let s = made(&Options::new(0.1, first, last(-0.788, -0.616, -0.049, None)));
    let told = words::reason(&s.claims, &[]);
    assert!(told.starts_with("certified in part: a strip 375 mm wide") && told.contains("1500 mm"), "{told}");
    assert!(s.status() == Status::Uncertified && s.patterns.len() == 1);
    assert!((figure(&s, "first ruling") - 375.0).abs() < 1e-6);
}

#[test]
fn questions_that_cannot_be_asked_name_the_curve_and_the_place() {
    let told =
        |curve: &Rail, options: &Options| net(curve, options, &Control::default()).expect_err("refused").to_string();
    let usual = Options::new(1e-3, first(), last(-0.25, 1.0, 0.125, None));
    let tangent = Vec3::new(250.0, 125.0, 75.0);
    for (options, words) in [
        (Options { first_ruling: tangent, ..usual.clone() }, ["keel: the first ruling is tangent", "u = 0"]),
        (Options { first_ruling: Vec3::zeros(), ..usual.clone() }, ["keel: the first ruling", "no direction"]),
        (Options { condition: last(0.0, 0.0, 0.0, None), ..usual.clone() }, ["keel: the last ruling", "no direction"]),
        (
            Options { condition: last(250.0, -125.0, -93.75, None), ..usual.clone() },
            ["last ruling is tangent", "u = 1"],
        ),
        (
            Options { condition: Condition::Stars { m_star: 0.5, lambda_star: 2.0 }, ..usual.clone() },
            ["keel: M* = 0.5", "middle"],
        ),
        (Options { condition: Condition::Shape { m: f64::NAN, kappa: 1.0 }, ..usual.clone() }, ["keel", "finite"]),
        (Options { along: [0.7, 0.2], ..usual.clone() }, ["keel", "from 0.7 to 0.2"]),
        (Options { tolerance: 0.0, ..usual.clone() }, ["tolerance", "0"]),
        (Options { alternative: 4, ..usual.clone() }, ["alternative 4", "there are 1"]),
        (
            Options { condition: Condition::Shape { m: 2.0, kappa: 1.0 }, first_ruling: tangent, ..usual.clone() },
            ["keel", "first ruling is tangent"],
        ),
    ] {
        let e = told(&keel(), &options);
        assert!(words.iter().all(|w| e.contains(w)), "{e}");
    }
    // M* on a knot: u = 1/4 of a curve with a knot there.
    let knots = Knots::clamped(2, &[0.0, 0.25, 1.0]).expect("knots");
    let control = (0..4).map(|i| f64::from(i) * 100.0).map(|x| [x, 0.002 * x * x, 0.0, 1.0]).collect();
    let curve = Rail::new("c", &[Curve { knots, control }]).expect("rail");
    let stars = Condition::Stars { m_star: 0.25, lambda_star: 2.0 };
    let e = told(&curve, &Options { condition: stars, ..usual.clone() });
    assert!(e.contains("c, ") && e.contains("M* = 0.25 lies on knot"), "{e}");
    let bent = Rail::polyline("bent", &[Vec3::zeros(), Vec3::x() * 10.0, Vec3::new(10.0, 30.0, 0.0)]).expect("rail");
    let e = told(&bent, &usual);
    assert!(e.contains("bent has a corner of 90.000° at 0.2500"), "{e}");
}
