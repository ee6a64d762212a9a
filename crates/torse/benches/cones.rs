//! Time of a cone pair, of a chain through given rulings, and of an adaptive approximation with its certificate.

use std::f64::consts::TAU;
use torse::certify::cones::{cones as judge, ConeJudgeOptions, ConeProof};
use torse::design::cones::{cone_spline, ConeOptions};
use torse::fit::elements::cones::{cones, ConeFit, ConeFitOptions};
use torse::torse::cone::pair::{cone_pair, ConePair, PairOptions};
use torse::torse::cone::spline::ConeSpline;
use torse::torse::g1_element::G1Element;
use torse::torse::ruled_patch::{HelicalStrip, RuledStrip};

fn main() {
    divan::main();
}

fn helix(turns: f64) -> HelicalStrip {
    HelicalStrip { radius: 1.0, rise: 0.6, reach: [1.0, 2.0], domain: (0.0, TAU * turns) }
}

fn elements(count: usize) -> Vec<G1Element> {
    (0..count).map(|i| helix(1.0).jet(0.05 * i as f64).element().expect("ruling")).collect()
}

#[divan::bench]
fn pair(b: divan::Bencher) {
    let e = elements(2);
    b.bench(|| -> ConePair {
        cone_pair(divan::black_box(&e[0]), divan::black_box(&e[1]), &PairOptions::default()).expect("pair")
    });
}

#[divan::bench]
fn spline_of_1000_elements(b: divan::Bencher) {
    let e = elements(1000);
    b.bench(|| -> ConeSpline { cone_spline(divan::black_box(&e), &[], &ConeOptions::default()).expect("spline") });
}

#[divan::bench(args = [1e-3, 1e-6])]
fn helix_turn(b: divan::Bencher, tolerance: f64) {
    b.bench(|| -> ConeFit { cones(&helix(1.0), &ConeFitOptions::new(tolerance)).expect("fit") });
}

#[divan::bench(args = [1e-3, 1e-6])]
fn helix_turn_with_certificate(b: divan::Bencher, tolerance: f64) {
    b.bench(|| -> (ConeFit, ConeProof) {
        let fit = cones(&helix(1.0), &ConeFitOptions::new(tolerance)).expect("fit");
        let proof = judge(&helix(1.0), &fit.nodes, &fit.spline, &ConeJudgeOptions::new(tolerance)).expect("proof");
        (fit, proof)
    });
}
