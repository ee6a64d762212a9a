//! Bounds against dense samples, both ways; mutated truths are refused.

use super::*;
use crate::geom::Vec3;
use crate::torse::cone::pair::{cone_pair, PairOptions};
use crate::torse::ruled_patch::{HelicalStrip, RuledStrip};

fn strip() -> HelicalStrip {
    HelicalStrip { radius: 1.0, rise: 0.6, reach: [1.0, 2.0], domain: (0.2, 1.4) }
}

/// Pairs between even rulings, edges from the strip at joints only.
fn chain(count: usize) -> (Vec<f64>, ConeSpline) {
    let s = strip();
    let nodes: Vec<f64> = (0..=count).map(|i| 0.2 + 1.2 * i as f64 / count as f64).map(|u| u.min(1.4)).collect();
    let mut segments = Vec::new();
    for w in nodes.windows(2) {
        let [a, b] = [w[0], w[1]].map(|u| s.jet(u).element().expect("ruling"));
        let options = PairOptions { first: [-0.5, 0.5], second: [-0.5, 0.5], ..PairOptions::default() };
        segments.extend(cone_pair(&a, &b, &options).expect("pair").segments);
    }
    (nodes, ConeSpline { segments })
}

fn dense_strip(nodes: &[f64], spline: &ConeSpline) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..=600 {
        let u = nodes[0] + (nodes[nodes.len() - 1] - nodes[0]) * f64::from(i) / 600.0;
        let [a, b] = strip().jet(u).ends.map(|e| e[0]);
        for v in [0.0, 0.3, 0.5, 0.8, 1.0] {
            worst = worst.max(spline.nearest(&(a + (b - a) * v)).expect("segment").1);
        }
    }
    worst
}

#[test]
fn bounds_exceed_dense_samples_but_not_by_much() {
    for (count, tolerance) in [(2, 1e-2), (4, 1e-3), (8, 1e-4), (24, 3e-6)] {
        let (nodes, spline) = chain(count);
        let proof = cones(&strip(), &nodes, &spline, &ConeJudgeOptions::new(tolerance)).expect("proof");
        let dense = dense_strip(&nodes, &spline);
        assert!(
            proof.lines_bound().value() >= dense && proof.lines_bound().value() < 1.1 * dense + 0.1 * tolerance,
            "{proof:?} {dense}"
        );
        assert!(proof.attained() <= dense * 1.02);
        // Chain to strip.
        let mut back = 0.0_f64;
        for s in &spline.segments {
            for (f, v) in [(0.25, 0.0), (0.5, 1.0), (0.7, 0.4), (0.1, 0.9)] {
                let x = s.point(f, s.edge(0, f) * (1.0 - v) + s.edge(1, f) * v);
                let near = (0..=3000).map(|i| {
                    let [a, b] = strip().jet(0.2 + 1.2 * f64::from(i) / 3000.0).ends.map(|e| e[0]);
                    let t = ((x - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
                    (a + (b - a) * t - x).norm()
                });
                back = back.max(near.fold(f64::INFINITY, f64::min));
            }
        }
        assert!(back <= proof.bound().value() + 2e-4, "{back} {proof:?}");
        assert!(proof.bound().value().is_finite());
    }
}

#[test]
fn moved_chains_are_refused() {
    let (nodes, spline) = chain(8);
    let tolerance = 1e-4;
    assert!(
        cones(&strip(), &nodes, &spline, &ConeJudgeOptions::new(tolerance)).expect("proof").lines_bound().value()
            < tolerance
    );
    // All of it by twice the tolerance.
    let mut moved = spline.clone();
    for s in &mut moved.segments {
        s.start.point += Vec3::new(0.0, 0.0, 2.0 * tolerance) + s.start.normal * (2.0 * tolerance);
    }
    assert!(!cones(&strip(), &nodes, &moved, &ConeJudgeOptions::new(tolerance)).expect("proof").holds(tolerance));
    // A parallel chain is smooth, and off by its offset.
    let off = spline.offset(2.0 * tolerance).expect("offset");
    let proof = cones(&strip(), &nodes, &off, &ConeJudgeOptions::new(tolerance)).expect("proof");
    assert!(!proof.holds(tolerance) && proof.attained() > tolerance, "{proof:?}");
    // One joint broken.
    let mut broken = spline.clone();
    broken.segments[3].start.normal = broken.segments[2].start.normal;
    assert!(!cones(&strip(), &nodes, &broken, &ConeJudgeOptions::new(tolerance)).expect("proof").holds(tolerance));
    // Edges that are too short.
    let mut narrow = spline;
    for s in &mut narrow.segments {
        s.edges[1] = s.edges[1].map(|r| r - 0.1);
    }
    assert!(cones(&strip(), &nodes, &narrow, &ConeJudgeOptions::new(tolerance)).expect("proof").bound().value() > 0.09);
}

#[test]
fn nodes_that_do_not_fit_are_an_error() {
    let (nodes, spline) = chain(2);
    assert!(cones(&strip(), &nodes[1..], &spline, &ConeJudgeOptions::new(1e-3)).is_err());
    assert!(cones(&strip(), &nodes, &spline, &ConeJudgeOptions::new(f64::NAN)).is_err());
}

#[test]
fn a_turn_of_a_helix_takes_few_stretches() {
    let (nodes, spline) = chain(24);
    let proof = cones(&strip(), &nodes, &spline, &ConeJudgeOptions::new(3e-6)).expect("proof");
    assert!(proof.stretches() < 8 * 24, "{}", proof.stretches());
}
