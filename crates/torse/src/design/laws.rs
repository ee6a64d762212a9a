//! Laws of designed developables: what comes out is developable, lies where it was asked to, and does not depend on place and size.

use super::cones::{cone_spline, ConeOptions};
use super::discrete::planarise::{planarise, Hold, PlanariseOptions, PlanariseStatus};
use super::loft::branches::{branches, BranchOptions};
use super::loft::build::{follow, BuildOptions};
use super::loft::least_twist::{least_twist, LeastTwistOptions};
use crate::brep::space_curve::SpaceCurve;
use crate::control::Control;
use crate::geom::generated::{frame, powers_of_ten, vector};
use crate::geom::Vec3;
use crate::patchwork::generated::{free_cone, round_cone};
use crate::torse::g1_element::G1Element;
use crate::torse::quad_strip::QuadStrip;
use crate::torse::rail::Rail;
use crate::torse::strip::Strip;
use proptest::prelude::*;

fn quads(strip: &Strip, count: usize) -> [Vec<Vec3>; 2] {
    let (a, b) = strip.domain();
    [0, 1].map(|side| (0..=count).map(|k| strip.ruling(a + (b - a) * k as f64 / count as f64)[side]).collect())
}

fn rails(strip: &Strip) -> [Rail; 2] {
    [0, 1].map(|side| Rail::new(["a", "b"][side], &[strip.rail(side)]).expect("a rail"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn quadrilaterals_become_plane_and_those_that_are_stay(
        strip in free_cone(), noise in proptest::collection::vec((vector(), vector()), 13),
        amount in powers_of_ten(-7.0..-0.5), hold in 0usize..4,
    ) {
        let [a, b] = quads(&strip, 12);
        let given = QuadStrip::new(a.clone(), b.clone()).expect("a strip");
        // Rulings of a cone are coplanar two by two, up to rounding far from the origin.
        let options = PlanariseOptions { warp: 1e-11, ..PlanariseOptions::default() };
        let same = planarise(&given, &options, &Control::default()).expect("a strip");
        prop_assert!(same.status == PlanariseStatus::Plane && same.strip == given, "{same:?}");
        let hold = [Hold::Nothing, Hold::First, Hold::Second, Hold::Ends][hold];
        let moved = |p: &[Vec3], n: &dyn Fn(usize) -> Vec3| {
            p.iter().enumerate().map(|(k, x)| x + n(k) * amount).collect::<Vec<Vec3>>()
        };
        let warped = QuadStrip::new(moved(&a, &|k| noise[k].0), moved(&b, &|k| noise[k].1)).expect("a strip");
        let found = planarise(&warped, &PlanariseOptions { hold, ..options }, &Control::default()).expect("a strip");
        prop_assert!(found.status != PlanariseStatus::Plane || found.warp <= 1.01 * options.warp);
        prop_assert_eq!(found.warp, found.strip.largest_warp());
        prop_assert!(found.warp <= found.warp_before);
        // Nothing held, there is always a way, and not a far one.
        prop_assert!(hold != Hold::Nothing || found.status == PlanariseStatus::Plane, "{:?} {}", found.status, found.warp);
        prop_assert!(hold != Hold::Nothing || found.largest_move < 10.0 * amount, "{} {amount}", found.largest_move);
        let kept = |side: fn(&QuadStrip) -> &[Vec3], k: usize| side(&found.strip)[k] == side(&warped)[k];
        for k in 0..13 {
            let ends = hold == Hold::Ends && (k == 0 || k == 12);
            prop_assert!(!(ends || hold == Hold::First) || kept(QuadStrip::a, k));
            prop_assert!(!(ends || hold == Hold::Second) || kept(QuadStrip::b, k));
        }
    }

    #[test]
    fn chains_through_elements_of_a_round_cone_are_the_cone(
        cone in round_cone(), shares in proptest::collection::vec(0.02..1.0f64, 1..5), slide in -0.4..0.4f64,
    ) {
        let total: f64 = shares.iter().sum();
        // Neighbours turn by less than the limit of pairs.
        prop_assume!(shares.iter().all(|s| s / total * cone.turn < 2.4));
        let mut at = 0.0;
        let places: Vec<f64> = std::iter::once(0.0).chain(shares.iter().map(|s| {
            at += s / total;
            at
        })).collect();
        let [_, height] = [0, 1].map(|side| {
            let (a, _) = cone.strip.domain();
            cone.surface.foot(&cone.strip.ruling(a)[side], None)[1]
        });
        let elements: Vec<G1Element> = places.iter().enumerate().map(|(k, t)| {
            let v = height * (0.5 + slide * if k % 2 == 0 { 1.0 } else { -1.0 });
            let jet = cone.surface.jet([0.3 + t * cone.turn, v]);
            G1Element::new(jet.p, jet.dv, jet.du).expect("an element")
        }).collect();
        let found = cone_spline(&elements, &[], &ConeOptions::default()).expect("a chain");
        prop_assert_eq!(found.segments.len(), 2 * (elements.len() - 1));
        prop_assert!(found.mismatch(cone.length) < 1e-9, "{}", found.mismatch(cone.length));
        for (i, s) in found.segments.iter().enumerate() {
            prop_assert!(s.fault().is_none());
            for f in [0.0, 0.3, 0.7, 1.0] {
                let x = s.element(f).point;
                let off = (cone.surface.jet(cone.surface.foot(&x, None)).p - x).norm();
                prop_assert!(off < 1e-6, "{off} in {i} at {f}");
            }
        }
        for (k, e) in elements.iter().enumerate() {
            let there = found.segments.get(2 * k).map_or_else(|| found.segments[2 * k - 1].end(), |s| s.start);
            prop_assert!((there.point - e.point).cross(&e.direction).norm() < 1e-6, "{there:?} {e:?}");
        }
    }

    #[test]
    fn paths_of_least_twist_do_not_depend_on_side_place_and_size(
        control in [vector(), vector(), vector(), vector()], apart in powers_of_ten(-2.0..1.0), place in frame(1e3),
        size in powers_of_ten(-1.0..2.0),
    ) {
        let at = |i: usize, y: f64| Vec3::new(i as f64, y, 0.0) + control[i] * (0.3 * apart.min(1.0));
        let side = |y: f64| (0..4).map(|i| at(i, y) + Vec3::z() * (0.2 * y * i as f64)).collect::<Vec<Vec3>>();
        let rail = |points: &[Vec3]| Rail::polyline("r", points).expect("a rail");
        let placed = |points: &[Vec3]| points.iter().map(|p| place.to_world(&(p * size))).collect::<Vec<Vec3>>();
        let (a, b) = (side(0.0), side(apart));
        let options = LeastTwistOptions { chords: 24, ..LeastTwistOptions::default() };
        let path = |p: &[Vec3], q: &[Vec3]| least_twist(&rail(p), &rail(q), &options).expect("a path");
        let (found, swapped, moved) = (path(&a, &b), path(&b, &a), path(&placed(&a), &placed(&b)));
        let near = |x: f64, y: f64| (x - y).abs() < 1e-6 * (1.0 + x.abs());
        prop_assert!(near(found.cost, swapped.cost), "{} {}", found.cost, swapped.cost);
        prop_assert!(near(found.cost, moved.cost), "{} {}", found.cost, moved.cost);
        for path in [&found, &moved] {
            prop_assert!(path.stations.windows(2).all(|w| w[0][0] <= w[1][0] && w[0][1] <= w[1][1]));
            prop_assert!(path.stations[0] == [0.0, 0.0] && path.stations.len() == path.rulings.len());
        }
        // In a plane nothing bends.
        let flat = |p: &[Vec3]| p.iter().map(|x| place.to_world(&Vec3::new(x.x, x.y, 0.0))).collect::<Vec<Vec3>>();
        prop_assert!(path(&flat(&a), &flat(&b)).cost < 1e-9);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn strips_between_rails_of_a_cone_are_developable_and_end_at_the_rails(strip in free_cone()) {
        let [a, b] = rails(&strip);
        let found = branches(&a, &b, &BranchOptions { cells: 100, ..BranchOptions::default() });
        // Between rails that lie in one plane but for a hair anything is a branch, and there may be none.
        prop_assume!(!found.is_empty());
        let best = &found[0];
        let tolerance = 1e-4;
        let built = follow([&a, &b], best, &BuildOptions::new(tolerance), &Control::default());
        prop_assume!(built.is_ok());
        let built = built.expect("strips");
        let curves = [0, 1].map(|side| SpaceCurve::Spline(strip.rail(side)));
        for s in built.iter().map(|b| &b.strip) {
            let (from, to) = s.domain();
            for k in 0..=10 {
                let u = from + (to - from) * f64::from(k) / 10.0;
                prop_assert!(s.twist(u) < 1e-5 || (s.twist(u) - std::f64::consts::PI).abs() < 1e-5, "{} at {u}", s.twist(u));
                for (curve, x) in curves.iter().zip(s.ruling(u)) {
                    let off = (curve.point(curve.nearest(&x)) - x).norm();
                    prop_assert!(off < 1.1 * tolerance, "{off} at {u}");
                }
            }
        }
    }
}
