//! From measured points to proven strips.

use super::{strips, value, Random};
use torse::certify::claim::{Counted, Status, What};
use torse::control::Control;
use torse::fit::cloud::CloudError;
use torse::geom::cloud::Cloud;
use torse::geom::Vec3;
use torse::pipeline::fit::{fit, FitOptions};

/// A developable sheet of about 1 m: `(u + v a, v, f + v g)` with `a' c' = e'`, and its unit normal.
fn sheet(u: f64, v: f64) -> (Vec3, Vec3) {
    let (a, f, df) = (0.25 * u, 0.15 * (2.2 * u).sin(), 0.33 * (2.2 * u).cos());
    let n = Vec3::new(-df, a * df - 0.25 * f, 1.0).normalize();
    (Vec3::new(u + v * a, v, f + v * 0.25 * f) * 1000.0, n)
}

fn measured(count: usize, noise: f64, seed: u64) -> Cloud {
    let mut random = Random::new(seed);
    let points = (0..count)
        .map(|_| {
            let (x, n) = sheet(0.5 * random.number(), 0.4 * random.number());
            x + n * (noise * random.number())
        })
        .collect();
    Cloud { points, ..Cloud::default() }
}

#[test]
fn a_sheet_with_noise_of_a_tenth_is_recovered_within_twice_the_noise() {
    let cloud = measured(6000, 0.1, 1);
    let got = fit(&cloud, &FitOptions::new(0.5, "sheet"), &Control::default()).expect("a fit");
    assert_eq!(got.status(), Status::Certified);
    assert_eq!(got.patchwork().panels.len(), 1);
    assert!(value(&got, What::PointDistance) <= 0.2 + 0.1, "{}", value(&got, What::PointDistance));
    assert!((value(&got, What::Noise) - 0.1 / 3f64.sqrt()).abs() < 0.01);
    // Against the truth: points of the sheet without noise.
    let truth: Vec<Vec3> = (0..400)
        .map(|i| sheet(0.49 * (f64::from(i % 20) / 9.5 - 1.0), 0.39 * (f64::from(i / 20) / 9.5 - 1.0)).0)
        .collect();
    let off = torse::certify::points::points(&strips(&got), &truth, &Control::default());
    assert!(off.worst_bound().value() <= 0.2, "{}", off.worst_bound().value());
    assert_eq!((got.parts.len(), got.patterns().len()), (1, 1));
}

#[test]
fn a_strongly_curved_sheet_is_recovered_within_twice_the_noise_of_the_truth() {
    // The tangent surface of a helix, turning by 34 degrees.
    let place = |t: f64, r: f64| {
        let d = Vec3::new(-800.0 * t.sin(), 800.0 * t.cos(), 500.0).normalize();
        let c = Vec3::new(800.0 * t.cos(), 800.0 * t.sin(), 500.0 * t);
        (c + d * (300.0 + 500.0 * r), d.cross(&Vec3::new(-t.cos(), -t.sin(), 0.0)).normalize())
    };
    let mut random = Random::new(9);
    let mut share = || 0.5 + 0.5 * random.number();
    let points = (0..5000)
        .map(|_| {
            let (x, n) = place(0.6 * share(), share());
            x + n * (0.1 * (2.0 * share() - 1.0))
        })
        .collect();
    let got =
        fit(&Cloud { points, ..Cloud::default() }, &FitOptions::new(0.4, "helix"), &Control::default()).expect("a fit");
    assert_eq!((got.status(), got.patchwork().panels.len()), (Status::Certified, 1));
    let truth: Vec<Vec3> = (0..900)
        .map(|i| place(0.6 * (0.03 + 0.94 * f64::from(i % 30) / 29.0), 0.03 + 0.94 * f64::from(i / 30) / 29.0).0)
        .collect();
    let off = torse::certify::points::points(&strips(&got), &truth, &Control::default());
    assert!(off.worst_bound().value() <= 0.2, "{}", off.worst_bound().value());
}

#[test]
fn a_moved_point_is_found() {
    let mut cloud = measured(4000, 0.0, 2);
    let (_, n) = sheet(0.1, 0.1);
    cloud.points[777] += n * 2.0;
    let got = fit(&cloud, &FitOptions::new(0.5, "sheet"), &Control::default()).expect("a fit");
    assert_eq!(got.status(), Status::Uncertified);
    assert_eq!((got.points.worst, value(&got, What::Count(Counted::Beyond))), (Some(777), 1.0));
}

#[test]
fn a_crease_is_found() {
    let mut random = Random::new(4);
    let mut points = Vec::new();
    for _ in 0..6000 {
        let (a, y) = (0.6 * random.number(), 200.0 * random.number());
        let x = 400.0 * a.sin();
        points.push(Vec3::new(x, y, 400.0 * a.cos()));
        points.push(Vec3::new(2.0 * 400.0 * 0.6f64.sin() - x, y, 400.0 * a.cos()));
    }
    let got = fit(&Cloud { points, ..Cloud::default() }, &FitOptions::new(0.5, "crease"), &Control::default())
        .expect("a fit");
    assert!(got.patchwork().panels.len() >= 2 && got.patchwork().panels.len() <= 4, "{}", got.patchwork().panels.len());
    assert!(value(&got, What::Count(Counted::Beyond)) < 120.0, "{}", value(&got, What::Count(Counted::Beyond)));
}

#[test]
fn what_fits_nothing_is_named() {
    let mut random = Random::new(6);
    let points = (0..3000).map(|_| Vec3::new(random.number(), random.number(), random.number()) * 100.0).collect();
    let got = fit(&Cloud { points, ..Cloud::default() }, &FitOptions::new(0.1, "heap"), &Control::default());
    match got {
        Ok(g) => assert_eq!(g.status(), Status::Uncertified),
        Err(e) => assert!(matches!(e, CloudError::Few(_))),
    }
}

#[test]
fn bad_clouds_are_refused() {
    let run = |points: Vec<Vec3>, tolerance: f64| {
        fit(&Cloud { points, ..Cloud::default() }, &FitOptions::new(tolerance, "bad"), &Control::default()).map(|_| ())
    };
    let good = measured(200, 0.0, 3).points;
    assert_eq!(run(Vec::new(), 1.0), Err(CloudError::Few(0)));
    assert_eq!(run(vec![Vec3::x(); 100], 1.0), Err(CloudError::Thin { what: "place", within: 0.0, size: 0.0 }));
    let line = (0..100).map(|i| Vec3::new(1.0, 2.0, 3.0) * f64::from(i)).collect();
    assert!(matches!(run(line, 1.0), Err(CloudError::Thin { what: "line", .. })));
    assert_eq!(run(good.clone(), 0.0), Err(CloudError::Tolerance(0.0)));
    let mut nan = good;
    nan[5].y = f64::NAN;
    assert!(matches!(run(nan, 1.0), Err(CloudError::NotFinite { index: 5, .. })));
}
