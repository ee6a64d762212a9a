//! Time of one fit: a strip of a torus at the width for which the best error is 1 mm.

use torse::fit::near::dual::DualOptions;
use torse::fit::near::primal::PrimalOptions;
use torse::fit::near::samples::Sample;
use torse::fit::near::{dual::dual, plane::plane, primal::primal};
use torse::geom::Vec3;
use torse::torse::form::Ruling;

fn main() {
    divan::main();
}

/// `n × m` samples of a torus (radii 1500 and 500 mm) beside the parallel at half a radian, and its centre line.
fn strip(n: usize, m: usize) -> (Vec<Sample>, Vec<Ruling>) {
    let point = |a: f64, b: f64| {
        let n = Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin());
        (Vec3::new(a.cos(), a.sin(), 0.0) * 1500.0 + n * 500.0, n)
    };
    let half = 2.0 / 500.0_f64.sqrt();
    let along = |i: usize, n: usize| -0.6 + 1.2 * i as f64 / (n - 1) as f64;
    let mut samples = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let (x, n) = point(along(i, n), 0.5 + half * (2.0 * j as f64 / (m - 1) as f64 - 1.0));
            samples.push(Sample { x, n, weight: 1.0 });
        }
    }
    let centre = (0..60)
        .map(|i| {
            let a = along(i, 60);
            let (x, n) = point(a, 0.5);
            let (sin, cos) = 0.5_f64.sin_cos();
            Ruling { point: x, direction: Vec3::new(-a.cos() * sin, -a.sin() * sin, cos), normal: n }
        })
        .collect();
    (samples, centre)
}

/// Tolerances in mm: one that the first steps reach, one near the optimum, one that cannot be reached.
const TOLERANCES: [f64; 3] = [2.0, 1.05, 0.5];

#[divan::bench(args = TOLERANCES)]
fn primal_450(bencher: divan::Bencher, tolerance: f64) {
    let (samples, _) = strip(50, 9);
    bencher.bench(|| primal(&samples, &PrimalOptions::new(tolerance)));
}

#[divan::bench(args = TOLERANCES)]
fn dual_450(bencher: divan::Bencher, tolerance: f64) {
    let (samples, centre) = strip(50, 9);
    bencher.bench(|| dual(&samples, &centre, &DualOptions::new(tolerance)));
}

#[divan::bench(args = [450, 4500])]
fn plane_of(bencher: divan::Bencher, count: usize) {
    let (samples, _) = strip(count / 9, 9);
    bencher.bench(|| plane(&samples));
}
