//! Times of fits in dual space and of measured points, as the documentation states them.

use torse::control::Control;
use torse::fit::planes::correction::{joint, JointOptions};
use torse::fit::planes::linear_system::{planes, PlaneDatum, PlanesOptions};
use torse::fit::planes::regression::{regression_free, ForbiddenZone, RegressionOptions};
use torse::fit::planes::rulings::SlopeData;
use torse::geom::cloud::Cloud;
use torse::geom::measure::Measure;
use torse::geom::Vec3;
use torse::pipeline::fit::{fit, FitOptions};
use torse::spline::knots::Knots;

fn main() {
    divan::main();
}

fn noise(i: usize) -> f64 {
    ((i as f64 * 12.9898).sin() * 43_758.547).fract()
}

fn data(count: usize, slip: f64) -> Vec<PlaneDatum> {
    let measure = Measure::rectangle([-1.0, 1.0], [-1.0, 1.0]).expect("area");
    (0..count)
        .map(|i| {
            let s = i as f64 / (count - 1) as f64;
            let plane = [(9.0 * s).sin() + 1e-4 * noise(i), (7.0 * s).cos(), 3.0 * s];
            PlaneDatum { plane, parameter: s.powf(slip), measure, weight: 1.0 }
        })
        .collect()
}

/// 10 000 planes into 100 control planes.
#[divan::bench]
fn planes_10_000_into_100(bencher: divan::Bencher) {
    let (data, knots) = (data(10_000, 1.0), Knots::uniform(3, 97, 0.0, 1.0).expect("knots"));
    bencher.bench_local(|| planes(&data, &knots, &PlanesOptions::default()).expect("a fit").cost);
}

/// The same with parameters that have slipped: corrections and joint iteration.
#[divan::bench]
fn joint_10_000_into_100(bencher: divan::Bencher) {
    let (data, knots) = (data(10_000, 1.05), Knots::uniform(3, 97, 0.0, 1.0).expect("knots"));
    bencher.bench_local(|| {
        joint(&data, &knots, &PlanesOptions::default(), &JointOptions::default()).expect("a fit").fit.cost
    });
}

/// Both sides of the regression control with 200 control points.
#[divan::bench]
fn regression_200(bencher: divan::Bencher) {
    let measure = Measure::rectangle([-1.0, 1.0], [-1.0, 1.0]).expect("area");
    let planes = (0..2000)
        .map(|i| {
            let t = i as f64 / 1999.0;
            let plane = [0.4 * t * t + 1e-3 * noise(i), 0.1 * (9.0 * t).sin() + 1e-3 * noise(i + 7), t];
            PlaneDatum { plane, parameter: t, measure, weight: 1.0 }
        })
        .collect();
    let data = SlopeData { planes, ..SlopeData::default() };
    let knots = Knots::uniform(3, 197, 0.0, 1.0).expect("knots");
    let zone = ForbiddenZone::Slab(-0.5, 0.5);
    bencher
        .bench_local(|| regression_free(&data, &knots, &zone, &RegressionOptions::default()).expect("a fit").fit.cost);
}

/// A scan with noise, from points to proven strip and flat pattern.
#[divan::bench(args = [100_000, 1_000_000], sample_count = 1, sample_size = 1)]
fn scan(bencher: divan::Bencher, count: usize) {
    let points = (0..count)
        .map(|i| {
            let (u, v) = (noise(2 * i) * 0.5, 0.4 * noise(2 * i + 1));
            let (a, f) = (0.25 * u, 0.15 * (2.2 * u).sin());
            Vec3::new(u + v * a, v, f + v * 0.25 * f) * 1000.0 + Vec3::z() * (0.1 * noise(i + 5))
        })
        .collect();
    let cloud = Cloud { points, ..Cloud::default() };
    bencher.bench_local(|| fit(&cloud, &FitOptions::new(0.5, "scan"), &Control::default()).expect("a fit").seconds);
}
