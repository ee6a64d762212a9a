//! Strips with few control points, kept ends, smoothing, outliers, and limits that nothing keeps.

use super::rows::{helix, rulings};
use super::{strips, value, Random};
use torse::answer::note::{Became, FaceNote, FitNote, Note, SplineSize};
use torse::answer::Answer;
use torse::brep::face::Face;
use torse::certify::claim::{Counted, Status, What};
use torse::control::Control;
use torse::fit::elements::extent::strip_by_slope;
use torse::fit::elements::sequence::SequenceOptions;
use torse::fit::elements::span_series::{PlaneSeries, SlopeSeries};
use torse::geom::cloud::Cloud;
use torse::geom::Vec3;
use torse::io::words::why;
use torse::pipeline::elements::{fit_elements, fit_faces, ElementFitOptions};
use torse::pipeline::fit::{fit, FitOptions};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::contact::{ContactElement, Given};
use torse::torse::dual::DualCurve;
use torse::torse::strip::Strip;
use torse::torse::zone::RegressionLimits;

fn elements(count: usize) -> Vec<ContactElement> {
    let element = |i: usize| {
        let (ends, normal) = helix(i as f64 / (count - 1) as f64);
        ContactElement { normal, ends, radius: 30.0, weight: 1.0 }
    };
    (0..count).map(element).collect()
}

fn run(given: Given, options: &ElementFitOptions) -> Answer {
    fit_elements(&given, options, &Control::default()).expect("a fit")
}

fn count(strip: &Strip) -> usize {
    strip.patch.knots_u.control_count()
}

/// A developable of degree 6 with 31 control points along: type (3) over 13 spans.
fn heavy() -> Face {
    let breaks: Vec<f64> = (0..=13).map(|i| -0.5 + f64::from(i) / 13.0).collect();
    let knots = Knots::clamped(6, &breaks).expect("knots");
    let v = knots.values().to_vec();
    let control: Vec<[f64; 2]> = (0..knots.control_count())
        .map(|i| {
            let t = v[i + 1..=i + 6].iter().sum::<f64>() / 6.0;
            [250.0 * t * t + 40.0 * (2.0 * t).sin(), 0.3 * (1.5 * t).cos()]
        })
        .collect();
    let surface = DualCurve::slope(6, v, &control).expect("a curve").tensor_product(-100.0, 150.0).expect("a patch");
    assert_eq!((surface.knots_u.degree(), surface.knots_u.control_count()), (6, 31));
    Face::untrimmed(surface)
}

#[test]
fn a_face_of_degree_six_gets_a_few_control_points() {
    let mut before = 0;
    for (tolerance, most) in [(0.5, 8), (0.01, 14), (1e-3, 30)] {
        let got =
            fit_faces(&[heavy()], &[], &ElementFitOptions::new(tolerance, "six"), &Control::default()).expect("a fit");
        assert_eq!(got.status(), Status::Certified);
        assert!(value(&got, What::ElementDistance) <= tolerance);
        let strip = &got.patchwork().panels[0].strip;
        assert!(got.patchwork().panels.len() == 1 && count(strip) <= most, "{tolerance}: {}", count(strip));
        assert!(strip.patch.knots_u.degree() < 6);
        assert!(count(strip) >= before, "finer tolerances need more: {} after {before}", count(strip));
        before = count(strip);
        let now = SplineSize { degree: [strip.patch.knots_u.degree(), 1], control: [count(strip), 2] };
        let told = |n: &Note| match n {
            Note::Fit(FitNote::Face(f)) => {
                f.given.control == [31, 2] && f.became == Became::Strips(vec![("A-01".into(), now)])
            }
            _ => false,
        };
        assert!(got.notes.iter().any(told), "{:?}", got.notes);
        // Between the rulings that were fitted as well.
        let truth: Vec<Vec3> = (1..300)
            .flat_map(|i| [0.01, 0.5, 0.99].map(|r| heavy().surface.point(-0.5 + f64::from(i) / 300.0, r)))
            .collect();
        let off = torse::certify::points::points(&strips(&got), &truth, &Control::default());
        assert!(off.worst_bound().value() <= 1.5 * tolerance, "{tolerance}: {}", off.worst_bound().value());
    }
}

#[test]
fn a_face_that_is_simple_stays_as_it_is() {
    // A parabolic cylinder, and a plane triangle whose rulings meet in a corner.
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    let bent: Vec<Vec3> = [(0.0, 0.0), (50.0, 40.0), (100.0, 0.0)]
        .iter()
        .flat_map(|(x, z)| [Vec3::new(*x, 0.0, *z), Vec3::new(*x, 90.0, *z)])
        .collect();
    let corner = Vec3::new(0.0, 80.0, 30.0);
    let flat = [Vec3::zeros(), corner, Vec3::new(70.0, 0.0, 0.0), corner];
    for (degree, points) in [(2, &bent[..]), (1, &flat[..])] {
        let surface = Surface::new(knots(degree), knots(1), points, None).expect("a surface");
        let options = ElementFitOptions::new(0.05, "simple");
        let got = fit_faces(&[Face::untrimmed(surface)], &[], &options, &Control::default()).expect("a fit");
        assert_eq!(got.status(), Status::Certified);
        let strip = &got.patchwork().panels[0].strip;
        assert_eq!((strip.patch.knots_u.degree(), count(strip)), (degree, points.len() / 2));
        assert!(value(&got, What::ElementDistance) < 1e-9);
        let kept = |n: &Note| matches!(n, Note::Fit(FitNote::Face(FaceNote { became: Became::Itself(_), .. })));
        assert!(got.notes.iter().any(kept), "{:?}", got.notes);
    }
}

#[test]
fn corollary_3_strips_of_type_3_have_cubic_polynomial_rails() {
    let surface = heavy().surface;
    let row: Vec<ContactElement> = (0..40)
        .map(|i| {
            let jet = surface.jet(-0.5 + f64::from(i) / 39.0, 0.5);
            let ends = [0.0, 1.0].map(|v| surface.point(-0.5 + f64::from(i) / 39.0, v));
            ContactElement { normal: jet.normal().normalize(), ends, radius: 30.0, weight: 1.0 }
        })
        .collect();
    let series = SlopeSeries::of(&row, &SequenceOptions::new(0.1)).expect("slopes increase");
    for spans in [1, 2, 5] {
        let found = series.fit(spans, true).expect("a fit");
        let strip = strip_by_slope("s", &found, 1.0, &row).expect("a strip");
        assert_eq!((strip.patch.knots_u.degree(), count(&strip), strip.patch.rational), (3, 2 + 2 * spans, false));
        assert!(strip.twist_bound().is_some_and(|t| t < 1e-9));
    }
}

#[test]
fn ends_are_kept_exactly() {
    let off = |ruling: [Vec3; 2], given: &[Vec3; 2]| {
        let d = (ruling[1] - ruling[0]).normalize();
        given.iter().map(|x| (x - ruling[0]).cross(&d).norm()).fold(0.0, f64::max)
    };
    let given = rulings(50);
    let worst = |fix_ends: bool| {
        let options = ElementFitOptions { fix_ends, ..ElementFitOptions::new(0.5, "helix") };
        let got = run(Given::Rulings(given.clone()), &options);
        assert_eq!(got.status(), Status::Certified);
        let s = &got.patchwork().panels[0].strip;
        let ends = [s.ruling(0.0), s.ruling(1.0)];
        // Strips may run the other way.
        let along = off(ends[0], &given[0]).max(off(ends[1], &given[49]));
        along.min(off(ends[0], &given[49]).max(off(ends[1], &given[0])))
    };
    let (kept, free) = (worst(true), worst(false));
    assert!(kept < 1e-6 && free > 1e-5, "{kept} {free}");
}

#[test]
fn planes_at_the_ends_are_kept_exactly() {
    let mut random = Random::new(3);
    let planes: Vec<ContactElement> = elements(40)
        .into_iter()
        .map(|e| {
            let tilt = Vec3::new(random.number(), random.number(), random.number()) * 1e-3;
            ContactElement { normal: (e.normal + tilt).normalize(), ends: [e.centre(); 2], radius: 120.0, ..e }
        })
        .collect();
    let ends = |fix_ends: bool| {
        let options = ElementFitOptions { fix_ends, ..ElementFitOptions::new(0.6, "planes") };
        let got = run(Given::Planes(planes.clone()), &options);
        assert_eq!(got.status(), Status::Certified);
        let judged = torse::certify::elements::elements(&strips(&got), &planes, &Control::default());
        judged.bounds()[0].max(judged.bounds()[39])
    };
    let (kept, free) = (ends(true), ends(false));
    assert!(kept < 1e-6 && free > 1e-4, "{kept} {free}");
}

#[test]
fn smoothing_trades_distance_for_calm() {
    let mut random = Random::new(5);
    let planes: Vec<ContactElement> = elements(60)
        .into_iter()
        .map(|e| {
            let tilt = Vec3::new(random.number(), random.number(), random.number()) * 2e-3;
            ContactElement { normal: (e.normal + tilt).normalize(), ends: [e.centre(); 2], radius: 120.0, ..e }
        })
        .collect();
    let wave = |smoothing: f64| {
        let options = SequenceOptions { smoothing, ..SequenceOptions::new(0.45) };
        let fit = PlaneSeries::of(&planes, &options).expect("a series").fit(12, None).expect("a fit");
        let (a, b) = fit.torse.domain();
        let d = |k: i32| fit.torse.ruling(a + (b - a) * f64::from(k) / 102.0).direction;
        let bends: f64 = (0..=100).map(|k| (d(k) - 2.0 * d(k + 1) + d(k + 2)).norm()).sum();
        (bends, fit.error)
    };
    let (calm, far) = wave(1e-3);
    let (restless, near) = wave(1e-9);
    assert!(calm < 0.5 * restless && far > near, "{calm} {restless}, {far} {near}");
    let options = ElementFitOptions { smoothing: Some(1e-3), ..ElementFitOptions::new(0.6, "planes") };
    assert_eq!(run(Given::Planes(planes), &options).status(), Status::Certified);
}

#[test]
fn outliers_are_left_out_and_named() {
    let mut given = rulings(50);
    for i in [12, 31] {
        let n = helix(i as f64 / 49.0).1;
        given[i] = given[i].map(|x| x + n * 7.0);
    }
    let options = ElementFitOptions { robust: true, ..ElementFitOptions::new(0.1, "outliers") };
    let got = run(Given::Rulings(given), &options);
    assert_eq!(got.status(), Status::Certified);
    let skipped = &got.skipped;
    assert_eq!(
        (value(&got, What::Count(Counted::Rulings)) as usize, got.patchwork().panels.len(), skipped.len()),
        (48, 1, 2),
        "{skipped:?}"
    );
    for (i, s) in [12, 31].iter().zip(skipped) {
        assert!(
            why(&s.reason).starts_with(&format!("ruling {i}: ")) && why(&s.reason).contains("nothing is proven of it"),
            "{s:?}"
        );
    }
    // Against the truth at the places that were left out.
    let truth: Vec<Vec3> = [12.0, 31.0].iter().flat_map(|i| helix(i / 49.0).0).collect();
    let off = torse::certify::points::points(&strips(&got), &truth, &Control::default());
    assert!(off.worst_bound().value() < 0.1, "{}", off.worst_bound().value());
}

#[test]
fn a_clearance_that_nothing_keeps_is_named_for_rulings_planes_and_points() {
    let limits = Some(RegressionLimits { clearance: 5000.0, zones: Vec::new() });
    let options = ElementFitOptions { limits: limits.clone(), ..ElementFitOptions::new(0.1, "far") };
    let planes =
        elements(16).into_iter().map(|e| ContactElement { ends: [e.centre(); 2], radius: 150.0, ..e }).collect();
    for (given, tolerance) in [(Given::Rulings(rulings(16)), 0.1), (Given::Planes(planes), 1e-3)] {
        let got = run(given, &ElementFitOptions { tolerance, ..options.clone() });
        assert_eq!(got.status(), Status::Uncertified);
        let named = got.skipped.iter().any(|s| why(&s.reason).contains("regression curve in bounds"));
        assert!(named, "{:?}", got.skipped);
    }
    let mut random = Random::new(8);
    let points = (0..900)
        .map(|_| {
            let ([p, q], _) = helix(0.5 + 0.5 * random.number());
            p + (q - p) * (0.5 + 0.5 * random.number())
        })
        .collect();
    let options = FitOptions { limits, ..FitOptions::new(0.1, "far") };
    let got = fit(&Cloud { points, ..Cloud::default() }, &options, &Control::default()).expect("a fit");
    let skipped = &got.skipped;
    assert!(skipped.iter().any(|s| why(&s.reason).contains("with its regression curve in bounds (")), "{skipped:?}");
}
