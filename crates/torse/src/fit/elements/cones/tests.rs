//! Counts of the specification, order three, inflections and refusals.

use super::*;
use crate::torse::ruled_patch::{tangent_strip, HelicalStrip, StripFn};
use std::f64::consts::TAU;

fn helix() -> HelicalStrip {
    HelicalStrip { radius: 1.0, rise: 0.6, reach: [1.0, 2.0], domain: (0.0, TAU) }
}

fn power(exponents: [i32; 3], domain: (f64, f64)) -> StripFn<impl Fn(f64) -> StripJet> {
    let jet = move |u: f64| {
        let d = |k: i32, e: i32| {
            let factor: i32 = (0..k).map(|i| e - i).product();
            if e >= k {
                f64::from(factor) * u.powi(e - k)
            } else {
                0.0
            }
        };
        let c = [0, 1, 2, 3].map(|k| Vec3::from(exponents.map(|e| d(k, e))));
        tangent_strip(&c, [1.0, 2.0])
    };
    StripFn { domain, breaks: Vec::new(), jet }
}

/// Largest distance of many points of the strip from the chain.
fn dense(strip: &impl RuledStrip, fit: &ConeFit) -> f64 {
    let mut worst = 0.0_f64;
    for (k, w) in fit.nodes.windows(2).enumerate() {
        let part = ConeSpline { segments: fit.spline.segments[2 * k..2 * k + 2].to_vec() };
        for i in 0..=100 {
            let jet = strip.jet(w[0] + (w[1] - w[0]) * f64::from(i) / 100.0);
            let [a, b] = jet.ends.map(|e| e[0]);
            for v in [0.0, 0.5, 1.0] {
                worst = worst.max(part.nearest(&(a * (1.0 - v) + b * v)).expect("segments").1);
            }
        }
    }
    worst
}

#[test]
fn counts_are_those_of_the_specification() {
    fn check(name: &str, strip: &impl RuledStrip, counts: &[(f64, usize)]) {
        for &(tolerance, most) in counts {
            let fit = cones(strip, &ConeFitOptions::new(tolerance)).expect(name);
            let pairs = fit.nodes.len() - 1;
            assert!(pairs <= most, "{name} at {tolerance}: {pairs} pairs, {most} are enough");
            assert!(dense(strip, &fit) <= tolerance, "{name} at {tolerance}: {}", dense(strip, &fit));
            assert!(fit.spline.mismatch(1.0) < 1e-10, "{}", fit.spline.mismatch(1.0));
        }
    }
    check("helix", &helix(), &[(1e-2, 4), (1e-3, 8), (1e-4, 17), (1e-5, 37), (1e-6, 79)]);
    check("cubic", &power([1, 2, 3], (0.0, 1.0)), &[(1e-2, 3), (1e-3, 4), (1e-4, 7), (1e-5, 14), (1e-6, 27)]);
    check("cubic, longer", &power([1, 2, 3], (-1.0, 1.0)), &[(1e-2, 5), (1e-3, 8), (1e-4, 14), (1e-5, 28), (1e-6, 57)]);
    check("quartic", &power([1, 2, 4], (-1.0, 1.0)), &[(1e-2, 7), (1e-3, 12), (1e-4, 22), (1e-5, 42), (1e-6, 85)]);
}

#[test]
fn third_order_ladder() {
    let strip = power([1, 2, 3], (0.0, 0.8));
    let error = |h: f64| {
        let (a, b) = (station(&strip, 0.2).expect("ruling"), station(&strip, 0.2 + h).expect("ruling"));
        let pair = between(&strip, &a, &b, &ConeFitOptions::new(1.0)).expect("pair");
        measured(&strip, &a, &b, &pair).expect("error")
    };
    let errors = [0.4, 0.2, 0.1, 0.05, 0.025].map(error);
    for w in errors.windows(2) {
        let order = (w[0] / w[1]).log2();
        assert!((2.8..3.3).contains(&order), "{errors:?}");
    }
}

#[test]
fn inflections_become_joints() {
    let fit = cones(&power([1, 2, 4], (-1.0, 1.0)), &ConeFitOptions::new(1e-3)).expect("fit");
    assert_eq!(fit.forced.len(), 1);
    assert!(fit.forced[0].abs() < 1e-12 && fit.nodes.contains(&fit.forced[0]));
}

#[test]
fn junctions_lie_on_the_boundary_of_the_strip() {
    let strip = helix();
    let fit = cones(&strip, &ConeFitOptions::new(1e-3)).expect("fit");
    for s in &fit.spline.segments {
        let p = s.point(1.0, s.edge(1, 1.0));
        let near = (0..=20000).map(|i| (strip.jet(TAU * f64::from(i) / 20000.0).ends[1][0] - p).norm());
        assert!(near.fold(9.0, f64::min) < 2e-3);
    }
}

#[test]
fn bad_strips_are_refused_with_the_ruling() {
    let through = HelicalStrip { reach: [-1.0, 2.0], ..helix() };
    assert!(matches!(cones(&through, &ConeFitOptions::new(1e-3)), Err(ConeFitError::Regression { .. })));
    assert!(matches!(cones(&helix(), &ConeFitOptions::new(0.0)), Err(ConeFitError::Tolerance(_))));
    assert!(matches!(cones(&helix(), &ConeFitOptions::new(f64::NAN)), Err(ConeFitError::Tolerance(_))));
    let nan =
        StripFn { domain: (0.0, 1.0), breaks: vec![], jet: |_| StripJet { ends: [[Vec3::repeat(f64::NAN); 3]; 2] } };
    assert!(matches!(cones(&nan, &ConeFitOptions::new(1e-3)), Err(ConeFitError::Element { .. })));
    let few = ConeFitOptions { most_pairs: 3, ..ConeFitOptions::new(1e-6) };
    assert!(matches!(cones(&helix(), &few), Err(ConeFitError::TooMany { .. })));
}
