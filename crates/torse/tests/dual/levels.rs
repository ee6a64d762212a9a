//! Nested spaces: wavelets, and strips of cones between parallel planes.

use super::Random;
use torse::fit::planes::multiresolution::trigonometric::{
    cone_strip, support_spline, ConeStrip, ContourMetric, RadiusSign, StripError, TrigonometricSpline,
};
use torse::fit::planes::multiresolution::wavelets::{split, thinned, wavelets, LevelError};
use torse::geom::measure::Measure;
use torse::num::quadrature::gauss_legendre;
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::torse::dual::DualCurve;

fn knots(breaks: &[f64]) -> Knots {
    Knots::clamped(3, breaks).expect("knots")
}

/// Uneven breaks on [0, 1], and every second of them.
fn two_levels() -> (Knots, Knots) {
    let fine: Vec<f64> = (0..=16).map(|i| (f64::from(i) / 16.0).powf(1.3)).collect();
    let coarse: Vec<f64> = fine.iter().step_by(2).copied().collect();
    (knots(&fine), knots(&coarse))
}

fn some_curve(k: &Knots) -> Curve<3> {
    let mut random = Random::new(8);
    let control = (0..k.control_count()).map(|_| [random.number(), random.number(), random.number()]).collect();
    Curve { knots: k.clone(), control }
}

fn inner(a: &dyn Fn(f64) -> f64, b: &dyn Fn(f64) -> f64, breaks: &[f64]) -> f64 {
    let nodes = gauss_legendre(8);
    breaks
        .windows(2)
        .map(|w| {
            nodes
                .iter()
                .map(|(x, g)| {
                    let t = w[0] + (w[1] - w[0]) * x;
                    g * (w[1] - w[0]) * a(t) * b(t)
                })
                .sum::<f64>()
        })
        .sum()
}

#[test]
fn details_are_orthogonal_and_reconstruction_is_exact() {
    let (fine, coarse) = two_levels();
    let curve = some_curve(&fine);
    let s = split(&curve, &coarse).expect("a split");
    let again = s.joined().expect("a curve");
    assert!(again.control.iter().zip(&curve.control).all(|(a, b)| (0..3).all(|d| (a[d] - b[d]).abs() < 1e-14)));
    for i in 0..coarse.control_count() {
        let control = (0..coarse.control_count()).map(|j| [f64::from(u8::from(i == j))]).collect();
        let b = Curve::<1> { knots: coarse.clone(), control };
        for d in 0..3 {
            let dot = inner(&|t| b.point(t)[0], &|t| s.detail.point(t)[d], &fine.breaks());
            assert!(dot.abs() < 1e-14);
        }
    }
}

#[test]
fn wavelets_are_a_short_orthogonal_complement() {
    let (fine, coarse) = two_levels();
    let found = wavelets(&fine, &coarse).expect("wavelets");
    assert_eq!(found.len(), fine.control_count() - coarse.control_count());
    assert!(
        found.iter().all(|w| w.coefficients.len() <= 11),
        "{:?}",
        found.iter().map(|w| w.coefficients.len()).collect::<Vec<_>>()
    );
    for w in &found {
        let mut control = vec![[0.0]; fine.control_count()];
        w.coefficients.iter().enumerate().for_each(|(k, c)| control[w.first + k] = [*c]);
        let curve = Curve { knots: fine.clone(), control };
        assert!((inner(&|t| curve.point(t)[0], &|t| curve.point(t)[0], &fine.breaks()) - 1.0).abs() < 1e-10);
        let s = split(&curve, &coarse).expect("a split");
        assert!(s.coarse.control.iter().all(|c| c[0].abs() < 1e-8));
    }
    // Independent: firsts increase.
    assert!(found.windows(2).all(|w| w[0].first < w[1].first));
}

#[test]
fn thinning_keeps_its_promise() {
    let breaks: Vec<f64> = (0..=32).map(|i| f64::from(i) / 32.0).collect();
    let level = |step: usize| knots(&breaks.iter().step_by(step).copied().collect::<Vec<_>>());
    let k = level(1);
    let control = (0..k.control_count()).map(|i| {
        let x = i as f64 / 34.0;
        // Smooth but for one place.
        [x.sin() + if i == 20 { 0.5 } else { 0.0 }, x * x, 0.0]
    });
    let curve = Curve { knots: k.clone(), control: control.collect() };
    for tolerance in [1e-2, 1e-4, 1e-7] {
        let t = thinned(&curve, &[level(2), level(4), level(8)], tolerance).expect("thinned");
        assert!(t.error_bound <= tolerance && t.kept <= t.total && (t.kept < t.total || tolerance < 1e-3));
        for i in 0..=200 {
            let (a, b) = (t.curve.point(f64::from(i) / 200.0), curve.point(f64::from(i) / 200.0));
            assert!((0..3).all(|d| (a[d] - b[d]).abs() <= t.error_bound + 1e-15));
        }
    }
    assert!(matches!(thinned(&curve, &[level(2)], 0.0), Err(LevelError::Tolerance(_))));
    let other = knots(&[0.0, 0.4, 1.0]);
    assert!(matches!(split(&curve, &other), Err(LevelError::NotNested { .. })));
}

#[test]
fn planes_of_a_thinned_dual_spline_stay_within_the_bound() {
    let breaks: Vec<f64> = (0..=32).map(|i| f64::from(i) / 32.0).collect();
    let level = |step: usize| knots(&breaks.iter().step_by(step).copied().collect::<Vec<_>>());
    // Heights over a region of radius 1, so that all coordinates of planes are lengths.
    let control: Vec<[f64; 3]> = (0..level(1).control_count())
        .map(|i| {
            let x = i as f64 / 34.0;
            [(3.0 * x).sin(), 0.3 * x * x + if i == 11 { 0.02 } else { 0.0 }, 1.5 * x]
        })
        .collect();
    let curve = Curve { knots: level(1), control };
    // Points of both splines are as long as the region, and rounded.
    const ROUNDING: f64 = 1e-15;
    let mut seen = 0.0_f64;
    for tolerance in [3e-2, 1e-3, 1e-5] {
        let t = thinned(&curve, &[level(2), level(4), level(8)], tolerance).expect("thinned");
        let values = |c: &Curve<3>| DualCurve::graph(3, c.knots.values().to_vec(), &c.control).expect("a dual curve");
        let (given, found) = (values(&curve), values(&t.curve));
        let disc = Measure::disc([0.0, 0.0], 1.0).expect("a disc");
        let mut worst = 0.0_f64;
        for i in 0..=2000 {
            let [u, v] = [&given, &found].map(|c| c.graphs().point(f64::from(i) / 2000.0));
            let e = [0, 1, 2].map(|d| u[d] - v[d]);
            assert!(e.iter().all(|x| x.abs() <= t.error_bound + ROUNDING), "{e:?} {}", t.error_bound);
            // Root mean square over the disc: 1, 1/4 and 1/4 are the moments per area.
            worst = worst.max((disc.distance_sq(&e) / disc.mass()).sqrt());
        }
        let allowed = 1.5f64.sqrt() * t.error_bound + ROUNDING;
        assert!(worst <= allowed && t.error_bound <= tolerance, "{worst} {}", t.error_bound);
        seen = seen.max(worst / tolerance);
    }
    // Something was dropped, or nothing would have been measured.
    assert!(seen > 0.05, "{seen}");
}

fn h0(p: f64) -> f64 {
    2.0 + 0.2 * (2.0 * p).cos() + 0.1 * (3.0 * p).sin()
}

fn h1(p: f64) -> f64 {
    1.2 + 0.1 * (2.0 * p).cos() - 0.2 * p.sin()
}

fn angles(n: usize) -> Vec<f64> {
    (0..=n).map(|i| 0.2 + 2.2 * i as f64 / n as f64).collect()
}

#[test]
fn lemma_7_both_metrics_are_positive_definite() {
    for metric in [ContourMetric::Contours, ContourMetric::Integral] {
        for i in 0..360 {
            let (s, c) = f64::from(i).to_radians().sin_cos();
            assert!(metric.square(c, s) > 0.16);
        }
    }
    // (16) is the integral over the height.
    let direct: f64 = gauss_legendre(3).iter().map(|(z, w)| w * (z * 0.7 + (1.0 - z) * -0.3_f64).powi(2)).sum();
    assert!((ContourMetric::Integral.square(-0.3, 0.7) - direct).abs() < 1e-15);
}

#[test]
fn theorem_8_levels_are_nested_and_orthogonal() {
    let fine = cone_strip(&h0, &h1, &angles(16), RadiusSign::Free).expect("a strip");
    let coarse = fine.coarsened(&angles(8)).expect("a strip");
    // Nested: refining the coarse strip changes nothing.
    let again = coarse.bottom.refined(&angles(16)).expect("the same");
    for i in 0..=100 {
        let p = 0.2 + 0.022 * f64::from(i);
        assert!((again.value(p).0 - coarse.bottom.value(p).0).abs() < 1e-12);
        assert!((again.value(p).1 - coarse.bottom.value(p).1).abs() < 1e-12);
    }
    // Orthogonal: squares add, in both metrics.
    for metric in [ContourMetric::Contours, ContourMetric::Integral] {
        let zero = |_: f64| 0.0;
        let detail = |a: &TrigonometricSpline, b: &TrigonometricSpline, p: f64| a.value(p).0 - b.value(p).0;
        let whole = fine.distance_sq(&zero, &zero, metric);
        let part = coarse.distance_sq(&zero, &zero, metric);
        let rest = inner_square(&|p| {
            metric.square(detail(&fine.bottom, &coarse.bottom, p), detail(&fine.top, &coarse.top, p))
        });
        assert!((whole - part - rest).abs() < 1e-10 * whole);
    }
    // The projection of the projection is the direct one.
    let direct = cone_strip(&h0, &h1, &angles(8), RadiusSign::Free).expect("a strip");
    for (a, b) in coarse.bottom.radii().iter().zip(direct.bottom.radii()) {
        assert!((a - b).abs() < 1e-8);
    }
}

fn inner_square(f: &dyn Fn(f64) -> f64) -> f64 {
    inner(f, &|_| 1.0, &angles(16))
}

#[test]
fn corollary_9_contours_are_approximated_separately() {
    // No change of the coefficients of either contour makes the distance smaller, in either metric.
    let best = cone_strip(&h0, &h1, &angles(8), RadiusSign::Free).expect("a strip");
    let mut random = Random::new(2);
    for metric in [ContourMetric::Contours, ContourMetric::Integral] {
        let least = best.distance_sq(&h0, &h1, metric);
        for _ in 0..20 {
            let mut moved = |s: &TrigonometricSpline| {
                let radii: Vec<f64> = s.radii().iter().map(|r| r + 1e-3 * random.number()).collect();
                let (h, d) = s.value(0.2);
                let start = [h * 0.2f64.cos() - d * 0.2f64.sin(), h * 0.2f64.sin() + d * 0.2f64.cos()];
                TrigonometricSpline::new(angles(8), start, radii).expect("a spline")
            };
            let other = ConeStrip { bottom: moved(&best.bottom), top: moved(&best.top) };
            assert!(other.distance_sq(&h0, &h1, metric) > least);
        }
    }
}

#[test]
fn arcs_have_common_tangents_and_errors_of_third_order() {
    let mut last: Option<f64> = None;
    for n in [8, 16, 32] {
        let s = support_spline(&h0, &angles(n), RadiusSign::Free).expect("a spline");
        for w in s.arcs().windows(2) {
            let (s, c) = w[0].angles.1.sin_cos();
            let end = |a: &torse::fit::planes::multiresolution::trigonometric::Arc| {
                [a.centre[0] + a.radius * c, a.centre[1] + a.radius * s]
            };
            let (p, q) = (end(&w[0]), end(&w[1]));
            assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 1e-10);
        }
        let error =
            (0..=500).map(|i| 0.2 + 0.0044 * f64::from(i)).map(|p| (s.value(p).0 - h0(p)).abs()).fold(0.0, f64::max);
        if let Some(before) = last {
            assert!((5.0..14.0).contains(&(before / error)), "{before:e} {error:e}");
        }
        last = Some(error);
    }
}

#[test]
fn radii_of_one_sign_make_regular_strips() {
    let wavy = |p: f64| 1.0 + 0.3 * (4.0 * p).cos();
    let free = cone_strip(&wavy, &h1, &angles(8), RadiusSign::Free).expect("a strip");
    assert!(!free.singular_pieces().is_empty());
    let convex = cone_strip(&wavy, &h1, &angles(8), RadiusSign::Positive).expect("a strip");
    assert!(convex.bottom.radii().iter().chain(convex.top.radii()).all(|r| *r >= -1e-12));
    assert!(
        convex.distance_sq(&wavy, &h1, ContourMetric::Contours) > free.distance_sq(&wavy, &h1, ContourMetric::Contours)
    );
    // Apexes: circles of the section shrink to a point there.
    for (apex, (a, b)) in free.apexes().iter().zip(free.bottom.radii().iter().zip(free.top.radii())) {
        let z = apex.expect("cones");
        assert!(((1.0 - z) * a + z * b).abs() < 1e-9 * (1.0 + z.abs()));
    }
}

#[test]
fn bad_angles_are_named() {
    let free = RadiusSign::Free;
    assert!(matches!(support_spline(&h0, &[0.0], free), Err(StripError::Count(1))));
    assert!(matches!(support_spline(&h0, &[0.0, 1.0, 1.0], free), Err(StripError::Angle { index: 2, .. })));
    assert!(matches!(support_spline(&h0, &[0.0, 4.0], free), Err(StripError::Angle { index: 1, .. })));
    assert!(matches!(support_spline(&|_| f64::NAN, &[0.0, 1.0], free), Err(StripError::Value(_))));
    let fine = cone_strip(&h0, &h1, &angles(4), free).expect("a strip");
    assert!(matches!(fine.coarsened(&[0.2, 0.9, 2.4]), Err(StripError::NotNested(_))));
}
