//! Time of developables between two curves: branches of common tangent planes, the strip of least twist, strips that
//! follow a branch, the convex hull.

use std::f64::consts::TAU;
use torse::brep::space_curve::SpaceCurve;
use torse::control::Control;
use torse::design::hull::{hull, Hull};
use torse::design::loft::branches::{branches, Branch, BranchOptions};
use torse::design::loft::build::{follow, BuildOptions, BuiltStrip};
use torse::design::loft::least_twist::{least_twist, LeastTwistOptions, TwistPath};
use torse::geom::{Frame, Vec3};
use torse::torse::rail::Rail;

fn main() {
    divan::main();
}

fn ellipse(z: f64, a: f64, b: f64) -> Rail {
    let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
    let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
    Rail::new("ellipse", &[c]).expect("rail")
}

/// A cubic spline through points of a space curve.
fn wavy(z: f64, phase: f64) -> Rail {
    let points: Vec<Vec3> = (0..40)
        .map(|k| f64::from(k) / 39.0)
        .map(|t| Vec3::new(10.0 * t, 2.0 * (2.0 * t + phase).sin(), z + 0.5 * (3.0 * t + phase).cos()))
        .collect();
    Rail::through("wavy", &points).expect("rail")
}

#[divan::bench]
fn branches_400_closed(b: divan::Bencher) {
    let (p, q) = (ellipse(0.0, 1.0, 1.0), ellipse(1.0, 1.5, 0.6));
    b.bench(|| -> Vec<Branch> { branches(divan::black_box(&p), &q, &BranchOptions::default()) });
}

#[divan::bench]
fn branches_400_open(b: divan::Bencher) {
    let (p, q) = (wavy(0.0, 0.0), wavy(3.0, 0.3));
    b.bench(|| -> Vec<Branch> { branches(divan::black_box(&p), &q, &BranchOptions::default()) });
}

#[divan::bench]
fn least_twist_400(b: divan::Bencher) {
    let (p, q) = (wavy(0.0, 0.0), wavy(3.0, 0.3));
    b.bench(|| -> TwistPath { least_twist(divan::black_box(&p), &q, &LeastTwistOptions::default()).expect("path") });
}

#[divan::bench]
fn strips_along_a_branch(b: divan::Bencher) {
    let (p, q) = (ellipse(0.0, 1.0, 1.0), ellipse(1.0, 1.5, 0.6));
    let found = branches(&p, &q, &BranchOptions::default());
    b.bench(|| -> Vec<BuiltStrip> {
        follow([&p, &q], divan::black_box(&found[0]), &BuildOptions::new(1e-5), &Control::default()).expect("strips")
    });
}

#[divan::bench]
fn hull_of_two_ellipses(b: divan::Bencher) {
    let curves = [ellipse(0.0, 1.0, 1.0), ellipse(1.0, 1.5, 0.6)];
    b.bench(|| -> Hull { hull(divan::black_box(&curves), 256, &Control::default()).expect("hull") });
}
