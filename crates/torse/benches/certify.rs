//! Cost of the distance proof per triangle.

use torse::certify::{distance, DistanceOptions, Prepared, Verdict};
use torse::control::Control;
use torse::geom::{Frame, Vec3};
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::form::{DualTorse, PrimalTorse, Torse};

fn main() {
    divan::main();
}

/// A shallow bicubic dish of 10 × 2 with a torse along it, cut into `2 n²` triangles.
fn dish(n: usize, rational: bool) -> (Surface, Torse, Vec<[[f64; 2]; 3]>) {
    let knots = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    let mut points = Vec::new();
    for i in 0..4 {
        for j in 0..4 {
            let (x, y) = (10.0 * i as f64 / 3.0 - 5.0, 2.0 * j as f64 / 3.0 - 1.0);
            points.push(Vec3::new(x, y, 0.05 * x * x + 0.002 * y * y + 0.0005 * x * y * y));
        }
    }
    let weights: Vec<f64> = (0..16).map(|i| 1.0 + 1e-4 * (i % 3) as f64).collect();
    let s = Surface::new(knots.clone(), knots, &points, rational.then_some(&weights)).expect("surface");
    // The profile is fitted to the section y = 0 at the Greville points of a few spans.
    let breaks: Vec<f64> = (0..=10).map(|i| -6.0 + 1.2 * i as f64).collect();
    let k = Knots::clamped(3, &breaks).expect("knots");
    let v = k.values();
    let control: Vec<[f64; 2]> = (0..k.control_count())
        .map(|i| {
            // Blossom of the best parabola through the dish's middle.
            let (a, b, c) = (v[i + 1], v[i + 2], v[i + 3]);
            let height = |x: f64| s.point((x + 5.0) / 10.0, 0.5).z;
            let q = (height(5.0) + height(-5.0) - 2.0 * height(0.0)) / 50.0;
            [height(0.0) + q * (a * b + b * c + c * a) / 3.0, 0.001 * (a + b + c)]
        })
        .collect();
    let profile = Curve::new(3, v.to_vec(), control).expect("profile");
    let torse = Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.0));
    let mut triangles = Vec::new();
    let at = |i: usize| i as f64 / n as f64;
    for i in 0..n {
        for j in 0..n {
            triangles.push([[at(i), at(j)], [at(i + 1), at(j)], [at(i + 1), at(j + 1)]]);
            triangles.push([[at(i), at(j)], [at(i + 1), at(j + 1)], [at(i), at(j + 1)]]);
        }
    }
    (s, torse, triangles)
}

/// The same torse as an envelope of planes.
fn as_dual(torse: &Torse) -> Torse {
    let k = Knots::uniform(3, 26, -5.9, 5.9).expect("knots");
    let v = k.values();
    let control = (0..k.control_count())
        .map(|i| {
            let r = torse.ruling((v[i + 1] + v[i + 2] + v[i + 3]) / 3.0);
            [r.normal.x, r.normal.y, r.normal.z, r.normal.dot(&r.point)]
        })
        .collect();
    let planes = Curve::new(3, v.to_vec(), control).expect("planes");
    Torse::Dual(DualTorse { planes })
}

#[divan::bench(args = [(false, false), (false, true), (true, false)])]
fn triangles_1152(bencher: divan::Bencher, (rational, dual): (bool, bool)) {
    let (s, torse, triangles) = dish(24, rational);
    let torse = if dual { as_dual(&torse) } else { torse };
    let prepared = Prepared::new(&s);
    let run = || distance(&prepared, &torse, &triangles, 1.0, &DistanceOptions::default(), &Control::default());
    let j = run();
    assert!(matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
    bencher.bench_local(run);
}

#[divan::bench]
fn prepare(bencher: divan::Bencher) {
    let (s, _, _) = dish(2, false);
    bencher.bench_local(|| Prepared::new(&s));
}
