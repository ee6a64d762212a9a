//! Cone splines from the fit to the certificate, which know nothing of each other.

use std::f64::consts::TAU;
use torse::certify::cones::{cones as judge, ConeJudgeOptions};
use torse::fit::cones::{cones, ConeFitOptions};
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::surface::cone_forms::all_patches;
use torse::surface::ruled_strip::{HelicalStrip, RuledPatch, RuledStrip};

fn helix() -> HelicalStrip {
    HelicalStrip { radius: 1.0, rise: 0.6, reach: [1.0, 2.0], domain: (0.0, TAU) }
}

#[test]
fn accuracy_ladder_with_certificates() {
    for (tolerance, most) in [(1e-2, 4), (1e-3, 8), (1e-4, 17), (1e-5, 37), (1e-6, 79)] {
        let fit = cones(&helix(), &ConeFitOptions::new(tolerance)).expect("fit");
        assert!(fit.nodes.len() - 1 <= most);
        let proof = judge(&helix(), &fit.nodes, &fit.spline, &ConeJudgeOptions::new(tolerance)).expect("proof");
        // The fit reserves 10 %, of which the proof takes less.
        assert!(proof.strip_bound <= tolerance, "{tolerance}: {proof:?}");
        assert!(proof.chain_bound <= 5.0 * tolerance, "{tolerance}: {proof:?}");
    }
}

/// The tangent surface of (u, u², u³) between the curve's points c + c' and c + 2 c': polynomial boundaries.
fn cubic_patch() -> RuledPatch {
    let knots = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    // c + k c' in powers: (k + u, 2 k u + u², 3 k u² + u³), to Bernstein form of degree 3.
    let side = |k: f64| {
        let powers = [[k, 0.0, 0.0], [1.0, 2.0 * k, 0.0], [0.0, 1.0, 3.0 * k], [0.0, 0.0, 1.0]];
        let control = (0..4)
            .map(|i| {
                let mut x = [0.0, 0.0, 0.0, 1.0];
                for (j, p) in powers.iter().enumerate().take(i + 1) {
                    let binomial = |n: usize, k: usize| (0..k).fold(1.0, |b, m| b * (n - m) as f64 / (m + 1) as f64);
                    for d in 0..3 {
                        x[d] += binomial(i, j) / binomial(3, j) * p[d];
                    }
                }
                x
            })
            .collect();
        Curve { knots: knots.clone(), control }
    };
    RuledPatch::between(side(1.0), side(2.0)).expect("strip")
}

#[test]
fn ruled_patches_are_approximated_and_certified() {
    let strip = cubic_patch();
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let fit = cones(&strip, &ConeFitOptions::new(tolerance)).expect("fit");
        let proof = judge(&strip, &fit.nodes, &fit.spline, &ConeJudgeOptions::new(tolerance)).expect("proof");
        assert!(proof.strip_bound <= tolerance && proof.chain_bound <= 3.0 * tolerance, "{tolerance}: {proof:?}");
        assert!(proof.mismatch < 1e-11);
        // Patches of degree (2, 1) with positive weights, corner to corner.
        let patches = all_patches(&fit.spline).expect("patches");
        for w in patches.windows(2) {
            for v in [0.0, 1.0] {
                assert!((w[0].point(1.0, v) - w[1].point(0.0, v)).norm() < 1e-9);
            }
        }
        let first = strip.jet(0.0).ends[1][0];
        assert!((patches[0].point(0.0, 1.0) - first).norm() < 1e-12);
    }
}

#[test]
fn exact_faces_are_written_and_read_back() {
    use torse::io::cones::exact;
    use torse::surface::cone_part::ConeBody;
    use torse::surface::cone_spline::ConeSpline;
    use torse::surface::face::SurfaceKind;
    let fit = cones(&helix(), &ConeFitOptions::new(1e-2)).expect("fit");
    // The arcs across the rulings come nearer to the vertices by the length of the regression curve.
    let circular = ConeSpline { segments: fit.spline.segments[..2].to_vec() }.with_circular_edges(2.0, 2.4);
    assert!(circular.segments.iter().all(|s| s.fault().is_none()));
    for spline in [fit.spline, circular] {
        let (_, bytes) =
            exact("helix", &[ConeBody { name: "A".into(), spline: spline.clone(), part: None }], "2026-01-01T00:00:00")
                .expect("file");
        let model = torse::io::step::read::read(&bytes).expect("model");
        assert!(model.skipped.is_empty());
        assert_eq!(model.faces.len(), spline.segments.len());
        for (face, s) in model.faces.iter().zip(&spline.segments) {
            assert_eq!(face.kind, SurfaceKind::Cone);
            // The reader makes polygons of edges.
            assert!(face.trim_deviation_estimate < 1e-3, "{}", face.trim_deviation_estimate);
            // A point inside the trim lies on the segment, and the normal is the segment's.
            let count = face.loops[0].points.len() as f64;
            let uv = face.loops[0].points.iter().fold([0.0; 2], |c, p| [c[0] + p[0] / count, c[1] + p[1] / count]);
            let jet = face.surface.jet(uv[0], uv[1]);
            let near = ConeSpline { segments: vec![*s] }.nearest(&jet.p).expect("one");
            assert!(near.1 < 1e-9, "{near:?}");
            let n = if face.reversed { -jet.normal() } else { jet.normal() }.normalize();
            assert!(n.dot(&s.element(0.5).normal) > 0.9);
        }
    }
}
