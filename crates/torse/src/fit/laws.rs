//! Laws of fits: what is drawn from an exact model is found again, and what is told of distances is what was put there.

use super::elements::cones::{cones, ConeFitOptions};
use super::elements::ruling_order::ordered;
use super::height::Height;
use super::near::chords::{fewest_chords, Ends, Place};
use super::near::plane::plane;
use super::near::primal::{primal, PrimalOptions};
use super::near::samples::{error, Sample};
use crate::geom::generated::{frame, powers_of_ten};
use crate::geom::{Vec2, Vec3};
use crate::patchwork::generated::round_cone;
use crate::spline::curve::Curve;
use crate::torse::form::{PanelKind, PrimalTorse, Torse};
use crate::torse::ruled_patch::{RuledPatch, RuledStrip};
use proptest::prelude::*;

/// Torses over profiles of length 2, regular within half of that from the profile; some are flat but for a hair.
fn torse() -> impl Strategy<Value = Torse> {
    let profile = proptest::collection::vec((-0.1..0.1f64, -0.1..0.1f64), 5);
    (frame(1e3), profile, powers_of_ten(-8.0..0.0), -0.5..0.5f64).prop_map(|(frame, control, flat, beta)| {
        let knots = vec![-1., -1., -1., -1., 0., 1., 1., 1., 1.];
        let control = control.iter().map(|(f, a)| [f * flat, *a]).collect();
        Torse::Primal(PrimalTorse::new(frame, Curve::new(3, knots, control).expect("a profile"), beta))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn samples_are_as_far_from_a_torse_as_they_were_put(
        torse in torse(), places in proptest::collection::vec((-0.9..0.9f64, -0.5..0.5f64, -0.02..0.02f64), 1..20),
    ) {
        let samples: Vec<Sample> = places.iter().map(|(t, r, h)| {
            let ruling = torse.ruling(*t);
            Sample { x: ruling.at(*r) + ruling.normal * *h, n: ruling.normal, weight: 1.0 }
        }).collect();
        let (found, worst) = error(&torse, &samples).expect("feet");
        let wanted = places.iter().fold(0.0f64, |m, p| m.max(p.2.abs()));
        prop_assert!((found - wanted).abs() < 1e-10, "{found} {wanted}");
        prop_assert!((places[worst].2.abs() - wanted).abs() < 1e-10);
        let heights = Height::of(&torse).expect("a cubic torse");
        for (s, p) in samples.iter().zip(&places) {
            let h = heights.at(&s.x, &s.n).expect("a ruling");
            prop_assert!((h + p.2).abs() < 1e-9, "{h} {}", p.2);
        }
    }

    #[test]
    fn the_best_plane_is_as_far_as_four_corners_demand(
        place in frame(1e4), size in powers_of_ten(-1.0..4.0), off in powers_of_ten(-7.0..-2.0), tilt in -0.3..0.3f64,
        inner in proptest::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -0.9..0.9f64), 0..40),
    ) {
        // Corners of a square, up and down in turn: no plane is nearer to all four of them than this.
        let corners = [(-1.0, -1.0, 1.0), (1.0, -1.0, -1.0), (1.0, 1.0, 1.0), (-1.0, 1.0, -1.0)];
        let at = |(x, y, h): &(f64, f64, f64)| place.to_world(&(Vec3::new(*x, *y, tilt * x + off * h) * size));
        let samples: Vec<Sample> =
            corners.iter().chain(&inner).map(|p| Sample { x: at(p), n: place.z, weight: 1.0 }).collect();
        let found = plane(&samples).expect("a plane");
        // Heights are along the normal of the plane that leans.
        let wanted = off * size / tilt.hypot(1.0);
        prop_assert!((found.error - wanted).abs() < 0.002 * wanted + 1e-12 * (size + 1e4), "{} {wanted}", found.error);
        prop_assert_eq!(found.kind, PanelKind::Plane);
    }

    #[test]
    fn chords_keep_within_their_distance_and_more_room_takes_no_more_of_them(
        waves in proptest::collection::vec((-1.0..1.0f64, 0.0..6.3f64), 3), distance in powers_of_ten(-3.0..-0.3),
        held in any::<[bool; 2]>(), rims in any::<[bool; 2]>(),
    ) {
        let at = |x: f64| {
            let wave = |f: fn(f64) -> f64, slope: f64| -> f64 {
                waves.iter().enumerate().map(|(k, (a, p))| {
                    let k = 0.5 * k as f64 + 0.3;
                    a * f(k * x + p) * if slope == 0.0 { 1.0 } else { k }
                }).sum()
            };
            let slope = wave(f64::cos, 1.0);
            Place { point: Vec2::new(x, wave(f64::sin, 0.0)), normal: Vec2::new(-slope, 1.0).normalize() }
        };
        let curve: Vec<Place> = (0..=60).map(|k| at(f64::from(k) * 0.1)).collect();
        let ends = Ends { held, rims };
        let (Some(found), Some(roomy)) = (fewest_chords(&curve, ends, distance), fewest_chords(&curve, ends, 2.0 * distance))
        else {
            // Places may be too far from each other for a distance so small.
            return Ok(());
        };
        prop_assert!(roomy.count() <= found.count(), "{} {}", roomy.count(), found.count());
        prop_assert!(found.distance <= distance * (1.0 + 1e-9));
        prop_assert!(found.corners[0].0 == 0 && found.corners[found.count()].0 == curve.len() - 1);
        for w in found.corners.windows(2) {
            let way = (w[1].1 - w[0].1).normalize();
            for p in &curve[w[0].0..=w[1].0] {
                let off = way.perp(&(p.point - w[0].1)).abs();
                prop_assert!(off <= found.distance * (1.0 + 1e-6) + 1e-12, "{off} {}", found.distance);
            }
        }
        for (k, end) in [(0, 0), (1, found.count())] {
            let (place, corner) = found.corners[end];
            prop_assert!(!held[k] || (corner - curve[place].point).norm() < 1e-12);
        }
    }

    #[test]
    fn rulings_in_any_order_and_direction_are_put_in_order(
        cone in round_cone(), order in Just((0..14usize).collect::<Vec<_>>()).prop_shuffle(), flips in any::<[bool; 14]>(),
    ) {
        let (a, b) = cone.strip.domain();
        let all: Vec<[Vec3; 2]> = (0..14).map(|k| cone.strip.ruling(a + (b - a) * k as f64 / 13.0)).collect();
        // Around most of a turn the two ends are as near to each other as neighbours.
        prop_assume!(cone.turn < 3.0);
        let given: Vec<[Vec3; 2]> = order.iter().map(|&k| {
            let [p, q] = all[k];
            if flips[k] { [q, p] } else { [p, q] }
        }).collect();
        let found = ordered(&given);
        let number = |r: &[Vec3; 2]| all.iter().position(|s| s[0] == r[0] || s[0] == r[1]);
        let numbers: Vec<usize> = found.iter().filter_map(number).collect();
        let wanted: Vec<usize> = if numbers[0] == 0 { (0..14).collect() } else { (0..14).rev().collect() };
        prop_assert_eq!(&numbers, &wanted);
        let way = |k: usize| found[k][0] == all[numbers[k]][0];
        prop_assert!((0..14).all(|k| way(k) == way(0)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn torses_near_samples_are_no_farther_than_the_plane_and_as_near_as_they_say(cone in round_cone()) {
        // That the cone itself is found is not promised: of some round cones a general torse, or the plane, is.
        prop_assume!(cone.turn < 1.6);
        let tolerance = 0.02;
        let (a, b) = cone.strip.domain();
        let samples: Vec<Sample> = (0..120).map(|k| {
            let (u, v) = (f64::from(k % 15) / 14.0, f64::from(k / 15) / 7.0);
            let x = cone.strip.patch.point(a + (b - a) * u, v);
            let jet = cone.surface.jet(cone.surface.foot(&x, None));
            Sample { x, n: jet.du.cross(&jet.dv).normalize(), weight: 1.0 }
        }).collect();
        let found = primal(&samples, &PrimalOptions::new(tolerance)).expect("a fit");
        let flat = plane(&samples).expect("a plane");
        prop_assert!(found.error <= flat.error && (flat.error > tolerance || found.kind == PanelKind::Plane));
        let (again, worst) = error(&found.torse, &samples).expect("feet");
        prop_assert!((again - found.error).abs() < 1e-6 && worst < samples.len(), "{again} {}", found.error);
    }

    #[test]
    fn cone_splines_of_a_round_cone_are_the_cone(cone in round_cone()) {
        let strip = RuledPatch::new(&cone.strip.patch, 0.0, 1.0).expect("a strip");
        let found = cones(&strip, &ConeFitOptions::new(1e-4)).expect("cones");
        prop_assert!(found.estimate < 1e-4 && found.spline.mismatch(cone.length) < 1e-9);
        let (a, b) = strip.domain();
        prop_assert!(found.nodes[0] == a && found.nodes[found.nodes.len() - 1] == b);
        prop_assert!(found.nodes.windows(2).all(|w| w[0] < w[1]));
        // No more pairs than turns of 2.5 rad.
        prop_assert!(found.nodes.len() <= 2 + (cone.turn / 2.5) as usize, "{:?} over {}", found.nodes, cone.turn);
        for s in &found.spline.segments {
            for f in [0.0, 0.4, 1.0] {
                let x = s.element(f).point;
                let off = (cone.surface.jet(cone.surface.foot(&x, None)).p - x).norm();
                prop_assert!(off < 1e-4, "{off}");
            }
        }
    }
}
