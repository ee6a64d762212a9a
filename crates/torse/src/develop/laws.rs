//! Laws of maps to the plane: lengths and angles are kept, outlines are drawn as near as is said, and what is alike is found alike.

use super::arcs::{arcs, circle, distance_to_arc, points_along, PlaneCurve};
use super::map::Development;
use super::same::same_parts;
use super::strip::{pattern, StripOptions};
use crate::geom::generated::{flat_vector, powers_of_ten};
use crate::geom::Vec2;
use crate::patchwork::generated::{free_cone, round_cone};
use crate::patchwork::pattern::{Pattern, Placement};
use crate::spline::bezier::Bezier;
use proptest::prelude::*;

/// A cubic of the plane.
struct Cubic(Bezier<2>);

impl PlaneCurve for Cubic {
    fn place(&self, s: f64) -> Vec2 {
        self.0.point(s).into()
    }

    fn velocity(&self, s: f64) -> Vec2 {
        self.0.derivative().point(s).into()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn lengths_and_angles_are_kept(
        strip in free_cone(), t in 0.01..0.99f64, r in 0.0..1.0f64, ways in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0, -1.0..1.0],
    ) {
        let map = Development::new(&strip.patch, 1.0).expect("a development");
        let jet = strip.patch.jet(t, r);
        let both = [[ways[0], ways[1]], [ways[2], ways[3]]];
        let space = both.map(|w| jet.du * w[0] + jet.dv * w[1]);
        let plane = both.map(|w| map.tangent(t, r, w[0], w[1]));
        let size = (jet.du.norm() + jet.dv.norm()).powi(2);
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            let (a, b) = (space[i].dot(&space[j]), plane[i].dot(&plane[j]));
            prop_assert!((a - b).abs() < 1e-7 * size, "{a} {b}");
        }
        // The tangents are those of the map.
        let h = 1e-4;
        let quotient = (map.map(t + h * ways[0], r + h * ways[1]) - map.map(t - h * ways[0], r - h * ways[1])) / (2.0 * h);
        prop_assert!((quotient - plane[0]).norm() < 1e-4 * size.sqrt(), "{quotient} {}", plane[0]);
        prop_assert!(map.strain(t, r) < 1e-7);
        // Rulings are straight and as long as they were.
        let ends = [0.0, 1.0].map(|r| map.map(t, r));
        let [p, q] = strip.ruling(t);
        prop_assert!(((ends[1] - ends[0]).norm() - (q - p).norm()).abs() < 1e-7);
        prop_assert!((map.map(t, r) - ends[0] - (ends[1] - ends[0]) * r).norm() < 1e-7);
    }

    #[test]
    fn patterns_of_round_cones_are_their_sectors(cone in round_cone(), other_side in any::<bool>()) {
        // Turns close to a whole one of a flat disc would overlap; the area is that of the sector all the same.
        let tolerance = 0.01;
        let options = StripOptions { side: if other_side { -1.0 } else { 1.0 }, ..StripOptions::new(tolerance) };
        let found = pattern(&[&cone.strip], 0, "c", &options);
        let Ok(found) = found else { return Err(TestCaseError::fail(format!("{:?}", found.err()))) };
        let wanted = cone.area();
        prop_assert!((found.area - wanted).abs() < 1e-6 * wanted && (found.area_in_space - wanted).abs() < 1e-6 * wanted);
        prop_assert!(found.isometry_error < 1e-7 && found.contour_error < 1.1 * tolerance, "{}", found.contour_error);
        // Both arcs and both rulings are as long as they are in space.
        let mut lengths: Vec<f64> = found.sides.iter().map(|s| s.length).collect();
        let mut known = vec![cone.length, cone.length, cone.radii[0] * cone.turn, cone.radii[1] * cone.turn];
        lengths.sort_by(f64::total_cmp);
        known.sort_by(f64::total_cmp);
        prop_assert_eq!(lengths.len(), 4);
        for (a, b) in lengths.iter().zip(&known) {
            prop_assert!((a - b).abs() < 1e-6 * (1.0 + b), "{lengths:?} {known:?}");
        }
        // Corners lie on two circles about the apex of the sector, or on two lines of the image of a cylinder.
        let joints = &found.contours[0].vertices;
        let drawn: f64 = (0..joints.len()).map(|k| {
            let (v, w) = (&joints[k], &joints[(k + 1) % joints.len()]);
            let sweep = 4.0 * v.bulge.atan();
            let chord = (w.point - v.point).norm();
            if v.bulge.abs() < 1e-12 { chord } else { circle(&v.point, &w.point, v.bulge).1 * sweep.abs() }
        }).sum();
        let whole: f64 = known.iter().sum();
        prop_assert!((drawn - whole).abs() < 0.01 * whole, "{drawn} {whole}");
    }

    #[test]
    fn parts_moved_or_turned_over_are_found_alike(strip in free_cone(), angle in -3.0..3.0f64, by in flat_vector()) {
        let found = pattern(&[&strip], 0, "p", &StripOptions::new(0.01)).expect("a pattern");
        let placement = Placement { angle, offset: by * 1000.0 };
        let mut moved = found.clone();
        moved.contours.iter_mut().flat_map(|c| c.vertices.iter_mut()).for_each(|v| v.point = placement.apply(&v.point));
        moved.rulings.iter_mut().flatten().for_each(|p| *p = placement.apply(p));
        moved.extents.iter_mut().flatten().for_each(|p| *p = placement.apply(p));
        moved.marks.iter_mut().for_each(|m| (m.point, m.inward) = (placement.apply(&m.point), placement.turn(&m.inward)));
        let turned = moved.turned_over();
        let back = turned.turned_over();
        for (v, w) in back.contours[0].vertices.iter().zip(&moved.contours[0].vertices) {
            prop_assert!((v.point - w.point).norm() < 1e-9 && (v.bulge - w.bulge).abs() < 1e-12);
        }
        let longer = |p: &Pattern| {
            let mut p = p.clone();
            p.contours[0].vertices.iter_mut().for_each(|v| v.point *= 1.01);
            p.area *= 1.01 * 1.01;
            (p.length, p.width) = (p.length * 1.01, p.width * 1.01);
            p
        };
        let same = same_parts(&[found.clone(), moved, turned, longer(&found)], &[1.0; 4]);
        prop_assert!(same[0].is_none() && same[3].is_none(), "{same:?}");
        prop_assert!(same[1].is_some() && same[2].is_some(), "{same:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn arcs_stay_as_near_to_a_curve_as_they_say(
        control in [flat_vector(), flat_vector(), flat_vector(), flat_vector()], flat in powers_of_ten(-6.0..0.0),
        size in powers_of_ten(-1.0..4.0), tolerance in powers_of_ten(-5.0..-1.0), away in flat_vector(),
    ) {
        // Cubics without cusp: along x, from nearly straight ones to strongly bent ones.
        let along = |(i, p): (usize, &Vec2)| {
            let q = Vec2::new(i as f64 + 0.3 * p.x, flat * 2.0 * p.y) * size + away * 1e4;
            [q.x, q.y]
        };
        let curve = Cubic(Bezier::new(control.iter().enumerate().map(along).collect()));
        let (pieces, error) = arcs(&curve, tolerance * size);
        prop_assert!(error <= tolerance * size * 1.03, "{error} of {}", tolerance * size);
        prop_assert!((pieces[0].point - curve.place(0.0)).norm() == 0.0);
        let ends: Vec<Vec2> = pieces.iter().skip(1).map(|p| p.point).chain([curve.place(1.0)]).collect();
        let hair = 1e-11 * (size + 1e4);
        for k in 0..=500 {
            let x = curve.place(f64::from(k) / 500.0);
            let off = pieces.iter().zip(&ends).map(|(p, q)| distance_to_arc(&x, &p.point, q, p.bulge));
            prop_assert!(off.fold(f64::INFINITY, f64::min) <= error + hair);
        }
        // And arcs stay near the curve, where they are between its ends.
        let samples: Vec<Vec2> = (0..=2000).map(|k| curve.place(f64::from(k) / 2000.0)).collect();
        for (p, q) in pieces.iter().zip(&ends) {
            for x in points_along(&p.point, q, p.bulge, 5) {
                let off = samples.windows(2).map(|w| distance_to_arc(&x, &w[0], &w[1], 0.0)).fold(f64::INFINITY, f64::min);
                prop_assert!(off <= 1.05 * error + 1e-6 * size + hair, "{off} {error}");
            }
        }
    }

    #[test]
    fn places_of_arcs_lie_on_them(
        a in flat_vector(), way in flat_vector(), long in powers_of_ten(-3.0..3.0), bulge in powers_of_ten(-12.0..1.5),
        left in any::<bool>(), least in 1usize..9, beside in -0.3..0.3f64,
    ) {
        let b = a + way * long;
        let bulge = if left { bulge } else { -bulge };
        let found = points_along(&a, &b, bulge, least);
        prop_assert!(found.len() >= least);
        let radius = if bulge.abs() > 1e-9 { circle(&a, &b, bulge).1 } else { 0.0 };
        let hair = 1e-13 * (radius + (b - a).norm()) + 1e-15;
        prop_assert!((found[0] - a).norm() < 10.0 * hair);
        prop_assert!(found.iter().all(|p| distance_to_arc(p, &a, &b, bulge) < 10.0 * hair));
        prop_assert!(distance_to_arc(&b, &a, &b, bulge) < 10.0 * hair);
        // The arc leaves its chord by half of the bulge times its length, to the right of a positive one.
        let d = b - a;
        let top = (a + b) * 0.5 + Vec2::new(d.y, -d.x) * (0.5 * bulge);
        prop_assert!(distance_to_arc(&top, &a, &b, bulge) < 10.0 * hair + 1e-9 * d.norm());
        // Beside its top by a share of the radius, so far it is away.
        if bulge.abs() > 1e-3 {
            let (centre, radius) = circle(&a, &b, bulge);
            let x = top + (top - centre) * beside;
            prop_assert!((distance_to_arc(&x, &a, &b, bulge) - beside.abs() * radius).abs() < 10.0 * hair);
        }
    }
}
