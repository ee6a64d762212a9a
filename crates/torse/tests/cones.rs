//! Cone splines from the fit to the certificate, which know nothing of each other.

use std::f64::consts::TAU;
use torse::certify::cones::outline::{outline, OutlineFault, Region};
use torse::certify::cones::{cones as judge, ConeJudgeOptions, ConeProof};
use torse::fit::elements::cones::{cones, ConeFit, ConeFitOptions};
use torse::fit::panels::cone_trim::{cone_part, ConeTrimOptions, OutlinePoint};
use torse::geom::Vec3;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::cone::forms::all_patches;
use torse::torse::cone::part::{ConePart, PartCurve};
use torse::torse::ruled_patch::{HelicalStrip, RuledPatch, RuledStrip};

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
        assert!(proof.lines_bound().value() <= tolerance, "{tolerance}: {proof:?}");
        assert!(proof.bound().value() <= 5.0 * tolerance, "{tolerance}: {proof:?}");
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
        assert!(
            proof.lines_bound().value() <= tolerance && proof.bound().value() <= 3.0 * tolerance,
            "{tolerance}: {proof:?}"
        );
        assert!(proof.mismatch() < 1e-11);
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
    use torse::brep::raw::SurfaceKind;
    use torse::io::bundle::exact;
    use torse::torse::cone::part::ConeBody;
    use torse::torse::cone::spline::ConeSpline;
    let fit = cones(&helix(), &ConeFitOptions::new(1e-2)).expect("fit");
    // The arcs across the rulings come nearer to the vertices by the length of the regression curve.
    let circular = ConeSpline { segments: fit.spline.segments[..2].to_vec() }.with_circular_edges(2.0, 2.4);
    assert!(circular.segments.iter().all(|s| s.fault().is_none()));
    for spline in [fit.spline, circular] {
        let bytes = exact(
            "helix",
            &[ConeBody { name: "A".into(), spline: spline.clone(), part: None }],
            false,
            "2026-01-01T00:00:00",
        )
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

/// A cylinder over a parabola, 100 long, ruled along y.
fn parabolic() -> Surface {
    let points: Vec<Vec3> = [(0.0, 0.0), (50.0, 40.0), (100.0, 0.0)]
        .iter()
        .flat_map(|&(x, z)| [Vec3::new(x, 0.0, z), Vec3::new(x, 100.0, z)])
        .collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    Surface::new(knots(2), knots(1), &points, None).expect("surface")
}

/// A slanting region of it with a square hole: loops of corners.
fn slanting_with_hole() -> Vec<Vec<[f64; 2]>> {
    let close = |corners: &[[f64; 2]]| -> Vec<[f64; 2]> {
        (0..corners.len())
            .flat_map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                (0..40).map(move |k| [0, 1].map(|d| a[d] + (b[d] - a[d]) * f64::from(k) / 40.0))
            })
            .collect()
    };
    let outer = close(&[[0.1, 0.1], [0.9, 0.3], [0.8, 0.9], [0.2, 0.7]]);
    vec![outer, close(&[[0.4, 0.4], [0.4, 0.6], [0.6, 0.6], [0.6, 0.4]])]
}

/// The region as a part of a chain within a tolerance, its loops as curves, and the chain's proof.
fn cut_out(tolerance: f64) -> (RuledPatch, ConeFit, ConeProof, ConePart, Vec<Vec<Curve<2>>>) {
    let loops = slanting_with_hole();
    let strip = RuledPatch::of_region(&parabolic(), (0.1, 0.9), [vec![0.1], vec![0.9]]).expect("strip");
    let fit = cones(&strip, &ConeFitOptions::new(tolerance)).expect("fit");
    let proof = judge(&strip, &fit.nodes, &fit.spline, &ConeJudgeOptions::new(tolerance)).expect("proof");
    let points: Vec<Vec<OutlinePoint>> = loops
        .iter()
        .map(|l| {
            let place = |(i, q): (usize, &[f64; 2])| OutlinePoint {
                point: parabolic().point(q[0], q[1]),
                edge: (i / 40) as u32,
            };
            l.iter().enumerate().map(place).collect()
        })
        .collect();
    let part =
        cone_part(&fit.spline, &points, &ConeTrimOptions { outline: 0.02 * tolerance, edge: 1e-6 }).expect("part");
    let curves = loops
        .iter()
        .map(|l| {
            let control: Vec<[f64; 2]> = l.iter().chain(&l[..1]).copied().collect();
            let n = control.len();
            let mut knots = vec![0.0];
            knots.extend((0..n).map(|k| k as f64));
            knots.push((n - 1) as f64);
            vec![Curve::new(1, knots, control).expect("polygon")]
        })
        .collect();
    (strip, fit, proof, part, curves)
}

#[test]
fn outlines_are_proven_both_ways_and_not_by_samples() {
    let tolerance = 0.05;
    let (strip, fit, proof, part, loops) = cut_out(tolerance);
    let patch = parabolic();
    let region = Region { patch: &patch, strip: &strip, loops: &loops };
    let shown = outline(&region, &part, &fit.spline, &proof, tolerance).expect("outline");
    assert!(
        shown.bound().value() >= proof.lines_bound().value()
            && shown.bound().value() < 1.02 * proof.lines_bound().value() + 1e-3,
        "{shown:?}"
    );
    assert!(shown.path_bound().value() < 0.2 * tolerance && shown.edge_bound().value() < 3e-6, "{shown:?}");
    // Samples of edges stay within what is proven of them.
    let mut reached = 0.0_f64;
    for e in &part.edges {
        let PartCurve::Free { space, .. } = &e.curve else { continue };
        for k in 0..=50 {
            let x = Vec3::from(space.point(f64::from(k) / 50.0));
            reached = reached.max(fit.spline.nearest(&x).expect("segment").1);
        }
    }
    assert!(reached > 0.0 && reached <= shown.edge_bound().value(), "{reached}");
    // A dent between the corners of the outline: seen at no corner.
    let mut dented = part.clone();
    let edge = dented.edges.iter_mut().find(|e| matches!(e.curve, PartCurve::Free { .. })).expect("an edge");
    if let PartCurve::Free { space, .. } = &mut edge.curve {
        let middle = space.control.len() / 2;
        space.control[middle][1] += 1.0;
    }
    let worse = outline(&region, &dented, &fit.spline, &proof, tolerance).expect("outline");
    assert!(worse.bound().value() > 0.1 && worse.path_bound().value() > 0.1, "{worse:?}");
}

#[test]
fn parts_of_other_outlines_are_refused_or_bounded_by_what_they_miss() {
    let tolerance = 0.05;
    let (strip, fit, proof, part, loops) = cut_out(tolerance);
    let patch = parabolic();
    // The hole forgotten.
    let region = Region { patch: &patch, strip: &strip, loops: &loops[..1] };
    let e = outline(&region, &part, &fit.spline, &proof, tolerance).expect_err("a hole too many");
    assert_eq!(e, OutlineFault::Loops { found: 2, wanted: 1 });
    // The hole elsewhere: 2 mm along the rulings.
    let mut moved = loops.clone();
    moved[1][0].control.iter_mut().for_each(|q| q[1] += 0.02);
    let region = Region { patch: &patch, strip: &strip, loops: &moved };
    let far = outline(&region, &part, &fit.spline, &proof, tolerance).expect("bounded");
    assert!(far.bound().value() > 1.9, "{far:?}");
    // An edge that no longer ends where its neighbours begin.
    let mut open = part.clone();
    open.edges[0].start = open.edges[0].end;
    let region = Region { patch: &patch, strip: &strip, loops: &loops };
    assert!(outline(&region, &open, &fit.spline, &proof, tolerance).is_err());
}
