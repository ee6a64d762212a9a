//! Tests of the distance proof: closed forms, brute force, and surfaces that are not what they seem.

use super::*;
use crate::certify::specimens::*;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::form::PrimalTorse;

fn judged(s: &Surface, torse: &Torse, triangles: &[[[f64; 2]; 3]], tolerance: f64) -> Judgement {
    distance(&Prepared::new(s), torse, triangles, tolerance, &DistanceOptions::default(), &Control::default())
}

fn moved(s: &Surface, f: &dyn Fn(Vec3) -> Vec3) -> Surface {
    let mut out = s.clone();
    for c in &mut out.control {
        let p = f(Vec3::new(c[0], c[1], c[2]) / c[3]) * c[3];
        *c = [p.x, p.y, p.z, c[3]];
    }
    out
}

/// Certified at 3 % above the sampled supremum, refuted at 3 % below; the bound is never below the samples.
fn tight(s: &Surface, torse: &Torse, triangles: &[[[f64; 2]; 3]]) -> f64 {
    let sup = brute_sup(s, torse, triangles, 6);
    let yes = judged(s, torse, triangles, sup * 1.03);
    let Verdict::Holds { bound } = yes.verdict else { panic!("{yes:?}, sampled {sup}") };
    assert!(bound >= sup * (1.0 - 1e-12) && bound <= sup * 1.03, "{bound} {sup}");
    let no = judged(s, torse, triangles, sup * 0.97);
    let Verdict::Fails { uv, distance } = no.verdict else { panic!("{no:?}, sampled {sup}") };
    assert!(distance.abs() > sup * 0.97);
    let there = brute_distance(torse, &s.point(uv[0], uv[1]));
    assert!((there - distance.abs()).abs() < 1e-3 * sup, "{there} {distance}");
    sup
}

#[test]
fn torses_over_a_profile_with_an_inflection() {
    let s = near_primal(1e-3);
    let sup = tight(&s, &Torse::Primal(primal()), &grid(&s, 3, 3));
    assert!(sup > 5e-4 && sup < 1e-3);
}

#[test]
fn envelopes_near_a_rational_sphere() {
    let s = sphere_strip(0.05);
    let sup = tight(&s, &Torse::Dual(dual()), &grid(&s, 4, 4));
    // Tangent strip of half-width w = 5 · .05: w²/(2 R) in the first order.
    assert!((sup - 0.25f64.powi(2) / 10.0).abs() < 2e-4, "{sup}");
}

#[test]
fn a_torse_that_comes_round_again_has_one_sheet_over_a_pipe() {
    use crate::spline::knots::Knots;
    use crate::torse::form::DualTorse;
    use std::f64::consts::TAU;
    // A pipe of a full turn; the torse goes on by a fifth of a turn at both ends, so that points near the slit have
    // feet on both of its ends. The region's triangles come in no order.
    let around = Knots::uniform(3, 24, 0.0, TAU).expect("knots");
    let along = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    let s = interpolant(&around, &along, &|u, v| Vec3::new(5.0 * u.cos(), 5.0 * u.sin(), v));
    let longer = Knots::uniform(3, 34, -0.2 * TAU, 1.2 * TAU).expect("knots");
    let torse = Torse::Dual(DualTorse { planes: curve(&longer, &|t| [t.cos(), t.sin(), 0.0, 5.0]) });
    let triangles = grid(&s, 1, 2);
    let n = triangles.len();
    let shuffled: Vec<_> = (0..n).map(|i| triangles[(i * 37) % n]).collect();
    assert!(!n.is_multiple_of(37), "all triangles");
    let j = judged(&s, &torse, &shuffled, 1e-2);
    assert!(matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
}

#[test]
fn creases_holes_and_reflex_corners() {
    use crate::spline::knots::Knots;
    // A C⁰ knot line with a crease, and a region with a hole and a notch.
    let k = Knots::clamped(3, &[0.0, 0.5, 0.5, 0.5, 1.0]).expect("knots");
    let z = tilted_frame().z;
    let s = interpolant(&k, &k, &|u, v| {
        primal_point(1.3 * u, 0.8 * v - 0.4) + z * (2e-3 * (u - 0.5).abs() + 1e-3 * (5.0 * v + u).sin())
    });
    let middle = |t: &[[f64; 2]; 3]| centroid(t);
    let region: Vec<_> = grid(&s, 4, 4)
        .into_iter()
        .filter(|t| {
            let [u, v] = middle(t);
            let hole = (0.25..0.625).contains(&u) && (0.25..0.5).contains(&v);
            let notch = u > 0.75 && v > 0.625;
            !hole && !notch
        })
        .collect();
    assert!(region.len() < 120);
    tight(&s, &Torse::Primal(primal()), &region);
}

#[test]
fn perturbed_surfaces_are_refused_with_a_witness() {
    let s = near_primal(1e-3);
    let torse = Torse::Primal(primal());
    let triangles = grid(&s, 3, 3);
    let tolerance = 1.02e-3;
    assert!(matches!(judged(&s, &torse, &triangles, tolerance).verdict, Verdict::Holds { .. }));
    let (frame, middle) = (tilted_frame(), primal_point(0.6, 0.0));
    let r = torse.ruling(0.6);
    let turned = |angle: f64| {
        move |p: Vec3| {
            let q = p - middle;
            let e = r.direction;
            middle + q * angle.cos() + e.cross(&q) * angle.sin() + e * (e.dot(&q) * (1.0 - angle.cos()))
        }
    };
    let cases: Vec<(&str, Surface)> = vec![
        ("shift by two tolerances", moved(&s, &|p| p + frame.z * (2.0 * tolerance))),
        ("shift by .3 tolerances", moved(&s, &|p| p + frame.z * (0.3 * tolerance))),
        ("rotation about a ruling", moved(&s, &turned(0.02))),
        ("tilt along the ruling", moved(&s, &|p| p + r.normal * (0.03 * (p - middle).dot(&r.direction)))),
        ("one control point", {
            let mut out = s.clone();
            out.control[14][2] += 6.0 * tolerance;
            out
        }),
    ];
    for (name, surface) in cases {
        let j = judged(&surface, &torse, &triangles, tolerance);
        let Verdict::Fails { uv, distance } = j.verdict else { panic!("{name}: {j:?}") };
        assert!(distance.abs() > tolerance);
        assert!(brute_distance(&torse, &surface.point(uv[0], uv[1])) > tolerance * (1.0 - 1e-9), "{name}");
    }
}

#[test]
fn a_spike_between_samples_is_found() {
    // A knot interval of width .002 with a spike of 1.2 tolerances in it, over a plane region.
    use crate::spline::knots::Knots;
    let k = Knots::clamped(3, &[0.0, 0.4, 0.4005, 0.401, 0.4015, 0.402, 1.0]).expect("knots");
    let q = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    let mut s = interpolant(&k, &q, &|u, v| primal_point(1.3 * u, 0.8 * v - 0.4));
    let z = tilted_frame().z * 1.8e-3;
    let row = s.row();
    for c in &mut s.control[4 * row..5 * row] {
        *c = [c[0] + z.x, c[1] + z.y, c[2] + z.z, 1.0];
    }
    let triangles = grid(&s, 1, 1);
    let j = judged(&s, &Torse::Primal(primal()), &triangles, 1e-3);
    assert!(!matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
}

#[test]
fn feet_outside_the_torse_are_not_accepted() {
    let s = near_primal(1e-3);
    let p = primal();
    let short = curve(&Knots::clamped(3, &[-0.3, 1.0]).expect("knots"), &|t| p.profile().point(t));
    let p = PrimalTorse::new(p.frame, short, p.beta());
    let j = judged(&s, &Torse::Primal(p), &grid(&s, 3, 3), 1.0);
    assert!(matches!(j.verdict, Verdict::Undecided { reason: Obstruction::Foot, .. }), "{j:?}");
}

#[test]
fn scaling_by_a_power_of_two_scales_the_bound() {
    let s = near_primal(1e-3);
    let (p, factor) = (primal(), 1024.0);
    let frame = Frame { origin: p.frame.origin * factor, ..p.frame };
    let values = p.profile().knots.values().iter().map(|t| t * factor).collect();
    let control = p.profile().control.iter().map(|c| [c[0] * factor, c[1]]).collect();
    let q = PrimalTorse::new(frame, Curve::new(3, values, control).expect("profile"), p.beta());
    // f and t grow by the factor; a, g = beta + ∫ f' da and the slopes stay.
    let big = moved(&s, &|x| x * factor);
    let triangles = grid(&s, 3, 3);
    let a = judged(&s, &Torse::Primal(p), &triangles, 1.02e-3);
    let b = judged(&big, &Torse::Primal(q), &triangles, 1.02e-3 * factor);
    let (Verdict::Holds { bound: a }, Verdict::Holds { bound: b }) = (&a.verdict, &b.verdict) else {
        panic!("{a:?} {b:?}")
    };
    assert!((a * factor - b).abs() < 1e-9 * b);
}

/// A corner turned over in a space far smaller than the tolerance does not spoil the proof; where the tolerance is
/// as small as the corner, it does.
#[test]
fn a_tiny_curl_at_the_rim_is_certified_within_the_tolerance() {
    use crate::spline::knots::Knots;
    let k = Knots::clamped(3, &[0.0, 1e-3, 2e-3, 0.3, 1.0]).expect("knots");
    let mut s = interpolant(&k, &k, &|u, v| primal_point(1.3 * u, 0.8 * v - 0.4));
    // The corner lies beyond its neighbours.
    let (corner, beside) = (s.control[0], s.control[2 * k.control_count()]);
    for d in 0..3 {
        s.control[0][d] = corner[d] + 3.0 * (beside[d] - corner[d]);
    }
    let torse = Torse::Primal(primal());
    let triangles = grid(&s, 2, 2);
    let normal = |u: f64| s.jet(u, 1e-9).normal();
    assert!(normal(1e-9).dot(&normal(0.5)) < 0.0, "the corner is not turned over");
    let j = judged(&s, &torse, &triangles, 0.05);
    let Verdict::Holds { bound } = j.verdict else { panic!("{j:?}") };
    assert!(bound >= brute_sup(&s, &torse, &triangles, 6) && bound <= 0.05, "{bound}");
    let j = judged(&s, &torse, &triangles, 5e-4);
    assert!(!matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
}

#[test]
fn a_pole_at_the_rim_is_certified_and_a_fold_is_not() {
    use crate::spline::knots::Knots;
    let k = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    // A fan over the primal torse: all of u = 0 is one point.
    let fan = interpolant(&k, &k, &|u, v| primal_point(0.2 + 0.8 * u, 0.5 * u * (v - 0.5)));
    let triangles = grid(&fan, 4, 4);
    let torse = Torse::Primal(primal());
    let sup = brute_sup(&fan, &torse, &triangles, 6);
    let j = judged(&fan, &torse, &triangles, 1e-4 + sup);
    assert!(matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
    // The same with the parametrisation folded back: distances are small, but the region doubles.
    let folded = interpolant(&k, &k, &|u, v| primal_point(0.2 + 0.8 * u, 0.5 * (v - 0.4).powi(2)));
    let triangles = grid(&folded, 4, 4);
    let j = judged(&folded, &torse, &triangles, 1e-2);
    assert!(!matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
}

/// A hem: the rim is turned back under the rest, so that points at the fold have no point of the trimmed panel at
/// their feet, and their way to it is longer than their distance from the torse.
#[test]
fn points_over_a_hem_are_as_far_from_the_panel_as_they_are() {
    use crate::geom::Frame;
    use crate::spline::knots::Knots;
    use crate::torse::form::PrimalTorse;
    let profile = curve(&Knots::uniform(3, 40, 3.0, 6.0).expect("knots"), &|t| [0.005 * t * t, 0.0]);
    let torse = Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.0));
    // (foot, height): level, down at the edge, and back under.
    let hem = |u: f64| match u {
        u if u <= 1.0 => (4.0 + u, 0.99),
        u if u <= 1.05 => (5.0 + 0.4 * (u - 1.0), 0.99 - 19.4 * (u - 1.0)),
        u => {
            let x = (u - 1.05) / 0.15;
            (5.02 + 0.03 * x - 0.35 * x * x, 0.02)
        }
    };
    let k = Knots::clamped(3, &[0.0, 1.0, 1.0, 1.0, 1.05, 1.05, 1.05, 1.2]).expect("knots");
    let flat = Knots::clamped(3, &[0.0, 1.0]).expect("knots");
    let s = interpolant(&k, &flat, &|u, v| {
        let (t, d) = hem(u);
        let r = torse.ruling(t);
        r.point + r.direction * (0.1 * v) + r.normal * d
    });
    let j = judged(&s, &torse, &grid(&s, 1, 1), 1.01);
    // From the last level point to the rim's foot.
    let (edge, rim) = (torse.ruling(5.0), torse.ruling(4.7));
    let off = edge.point + edge.normal * 0.99 - rim.point;
    let true_distance = (off - rim.direction * off.dot(&rim.direction)).norm();
    assert!(true_distance > 1.02);
    assert!(!matches!(j.verdict, Verdict::Holds { .. }), "{j:?}");
    // Where there is room for it, the way is part of the bound.
    let j = judged(&s, &torse, &grid(&s, 1, 1), 4.0);
    let Verdict::Holds { bound } = j.verdict else { panic!("{j:?}") };
    assert!(bound >= true_distance, "{bound} {true_distance}");
}
