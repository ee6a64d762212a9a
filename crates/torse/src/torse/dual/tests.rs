//! Closed forms and the statements of the paper about types, sections and regression curves.

use super::*;
use proptest::prelude::*;

fn by_slope(degree: usize) -> DualCurve {
    let mut knots = vec![-0.5; degree + 1];
    knots.extend([0.1, 0.4]);
    knots.extend(vec![1.0; degree + 1]);
    let control: Vec<[f64; 2]> =
        (0..degree + 3).map(|i| [(i as f64 * 1.3).sin(), (i as f64 * 0.7 + 0.3).cos()]).collect();
    DualCurve::slope(degree, knots, &control).expect("a spline")
}

fn graph(degree: usize) -> DualCurve {
    let control: Vec<[f64; 3]> =
        (0..degree + 1).map(|i| [(i as f64 * 1.3).sin(), (i as f64 * 0.7).cos(), i as f64 * 0.4 + 0.1]).collect();
    let mut knots = vec![0.0; degree + 1];
    knots.extend(vec![1.0; degree + 1]);
    DualCurve::graph(degree, knots, &control).expect("a spline")
}

#[test]
fn lemma_1_no_inflections_and_no_rulings_parallel_to_x_0() {
    let s = by_slope(3);
    assert_eq!(s.inflection_rulings(), inflection::Inflections::default());
    for i in 0..=20 {
        let t = -0.5 + 1.5 * f64::from(i) / 20.0;
        assert!(s.ruling(t).expect("a ruling").direction.x.abs() > 1e-3);
    }
    // A graph with U' = 0 in the middle has one inflection ruling there.
    let bezier: Vec<[f64; 3]> = [[0.0, 0.0, -0.125], [0.0, 0.0, 0.125], [0.0, 0.0, -0.125], [0.0, 0.0, 0.125]].to_vec();
    let g = DualCurve::graph(3, vec![0., 0., 0., 0., 1., 1., 1., 1.], &bezier).expect("a spline");
    // u2 = (t − 1/2)³ + const needs controls −1/8, 1/8, −1/8, 1/8.
    let at = g.inflection_rulings().at;
    assert!(at.len() == 1 && (at[0] - 0.5).abs() < 1e-6, "{at:?}");
}

#[test]
fn lemma_2_sections_are_polynomial_splines_of_the_same_degree() {
    for degree in 2..=5 {
        let s = by_slope(degree);
        let c = 0.7;
        let curve = s.section(c).expect("a section");
        assert_eq!(curve.knots.degree(), degree);
        let wanted: Vec<usize> =
            s.knots().distinct().iter().map(|k| if k.1 > degree { k.1 } else { k.1 + 1 }).collect();
        let got: Vec<usize> = curve.knots.distinct().iter().map(|k| k.1).collect();
        assert_eq!(got, wanted);
        for i in 0..=30 {
            let t = -0.5 + 1.5 * f64::from(i) / 30.0;
            let p = curve.point(t);
            let [u, d, _] = s.jet(t);
            for form in [u, d] {
                let value = form[0] * p[0] + form[1] * p[1] + form[2] * p[2] - form[3];
                assert!((p[0] - c).abs() < 1e-13 && value.abs() < 1e-11, "degree {degree}: {value}");
            }
        }
    }
}

#[test]
fn corollary_3_surface_between_two_sections_is_the_torse() {
    let s = by_slope(3);
    let patch = s.tensor_product(-1.0, 2.0).expect("a patch");
    assert_eq!((patch.knots_u.degree(), patch.knots_v.degree()), (3, 1));
    for i in 1..20 {
        let t = -0.5 + 1.5 * f64::from(i) / 20.0;
        for r in [0.0, 0.3, 1.0] {
            let jet = patch.jet(t, r);
            let ruling = s.ruling(t).expect("a ruling");
            assert!(ruling.normal.dot(&(jet.p - ruling.point)).abs() < 1e-11);
            assert!(jet.du.dot(&ruling.normal).abs() < 1e-10 && jet.dv.cross(&ruling.direction).norm() < 1e-10);
        }
    }
}

#[test]
fn facets_are_refused() {
    let knots = vec![0., 0., 0., 0.5, 0.5, 1., 1., 1.];
    let control: Vec<[f64; 2]> = (0..5).map(|i| [f64::from(i * i), f64::from(i)]).collect();
    let s = DualCurve::slope(2, knots, &control).expect("a spline");
    assert!(matches!(s.section(0.0), Err(DualError::Facet { multiplicity: 2, .. })));
}

#[test]
fn rational_form_agrees_with_rulings() {
    for degree in [2, 3, 4] {
        let g = graph(degree);
        let (a, b) = ([1.0, 0.0, 0.0, -0.2], [1.0, 0.1, 0.0, 2.0]);
        let patch = g.rational_tensor_product(&a, &b).expect("a patch");
        assert_eq!(patch.knots_u.degree(), 2 * degree - 2);
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            let ruling = g.ruling(t).expect("a ruling");
            for (v, plane) in [(0.0, a), (1.0, b)] {
                let p = patch.point(t, v);
                assert!((plane[0] * p.x + plane[1] * p.y - plane[3]).abs() < 1e-11 * (1.0 + p.norm()));
                assert!((p - ruling.point).cross(&ruling.direction).norm() < 1e-10 * (1.0 + p.norm()));
            }
        }
    }
}

#[test]
fn parallel_rulings_are_refused() {
    // The rulings of a cylinder along x are parallel to every plane z = const.
    let control: Vec<[f64; 3]> = (0..4).map(|i| [f64::from(i * i), 0.0, f64::from(i)]).collect();
    let g = DualCurve::graph(3, vec![0., 0., 0., 0., 1., 1., 1., 1.], &control).expect("a spline");
    assert!(matches!(
        g.rational_tensor_product(&[0.0, 0.0, 1.0, 0.0], &[1.0, 0.0, 0.0, 0.0]),
        Err(DualError::RulingParallel { .. })
    ));
}

#[test]
fn degree_of_the_regression_curve() {
    for degree in 2..=5 {
        for piece in graph(degree).regression_curve().expect("a regression curve") {
            assert_eq!(piece.points.degree(), 3 * degree - 6);
        }
        for piece in by_slope(degree).regression_curve().expect("a regression curve") {
            assert_eq!(piece.points.degree(), if degree == 2 { 0 } else { 2 * degree - 3 });
        }
    }
    assert!(matches!(graph(1).regression_curve(), Err(DualError::Degree { .. })));
}

#[test]
fn regression_curve_of_a_helix_tangent_surface_is_the_helix() {
    // Osculating planes of the cubic (t, t², t³): 3 t² x − 3 t y + z = t³.
    let power = [[0.0, 0.0, 1.0, 0.0], [0.0, -3.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    // Powers to Bernstein on [0, 1].
    let control = (0..4usize)
        .map(|i| {
            std::array::from_fn(|d| {
                (0..=i)
                    .map(|k| {
                        power[k][d]
                            * [[1., 1., 1., 1.], [0., 1. / 3., 2. / 3., 1.], [0., 0., 1. / 3., 1.], [0., 0., 0., 1.]][k]
                                [i]
                    })
                    .sum()
            })
        })
        .collect();
    let s = DualCurve::general(3, vec![0., 0., 0., 0., 1., 1., 1., 1.], control).expect("a spline");
    for piece in s.regression_curve().expect("a curve") {
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            let p = piece.points.point(t);
            for (d, wanted) in [t, t * t, t * t * t].into_iter().enumerate() {
                assert!((p[d] / p[3] - wanted).abs() < 1e-13);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn regression_pieces_agree_with_regression_points(t in 0.0..1.0f64, degree in 2usize..6) {
        for s in [graph(degree), by_slope(degree)] {
            let (a, b) = s.domain();
            let t = a + (b - a) * t;
            let wanted = s.regression_point(t);
            let size = wanted.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            for piece in s.regression_curve().expect("a curve") {
                if t < piece.a || t > piece.b {
                    continue;
                }
                let p = piece.points.point((t - piece.a) / (piece.b - piece.a));
                let n = p.iter().fold(0.0f64, |m, x| m.max(x.abs()));
                for i in 0..4 {
                    for j in 0..4 {
                        prop_assert!((p[i] * wanted[j] - p[j] * wanted[i]).abs() < 1e-9 * size * n);
                    }
                }
            }
        }
    }

    #[test]
    fn motions_insertions_and_elevations_keep_rulings(x in -3.0..3.0f64, angle in 0.0..6.0f64, t in 0.02..0.98f64) {
        let s = graph(3);
        let rotation = nalgebra::Rotation3::from_euler_angles(angle, 0.3 * angle, -angle);
        let map = Placement { linear: *rotation.matrix(), shift: Vec3::new(x, -x, 1.0) };
        let moved = s.transformed(&map).expect("a motion");
        let r = s.ruling(t).expect("a ruling");
        let m = moved.ruling(t).expect("a ruling");
        prop_assert!((map.point(&r.point) - m.point).cross(&m.direction).norm() < 1e-9);
        prop_assert!((map.linear * r.normal).cross(&m.normal).norm() < 1e-12);
        for same in [s.with_knots(&[0.3, 0.3, 0.7]).expect("knots"), s.elevated().expect("degree")] {
            let q = same.ruling(t).expect("a ruling");
            prop_assert!((q.point - r.point).norm() < 1e-9 && q.direction.cross(&r.direction).norm() < 1e-10);
        }
        let torse = crate::torse::form::Torse::Dual(s.to_torse());
        let q = torse.ruling(t);
        prop_assert!((q.point - r.point).norm() < 1e-9 && (q.normal - r.normal).norm() < 1e-12);
    }
}

#[test]
fn steep_and_still_planes_are_named() {
    let f = Frame::world();
    assert!(matches!(graph_in(&f, &[1.0, 0.0, 0.0, 1.0], 7), Err(DualError::Parallel { index: 7, .. })));
    assert!(graph_in(&f, &[0.0, 0.0, 1.0, f64::NAN], 0).is_err());
    let still = DualCurve::graph(2, vec![0., 0., 0., 1., 1., 1.], &[[1.0, 0.0, 0.0]; 3]).expect("a spline");
    assert!(matches!(still.ruling(0.5), Err(DualError::NoRuling { .. })));
    assert_eq!(still.inflection_rulings().still, vec![(0.0, 1.0)]);
    assert!(matches!(
        DualCurve::general(1, vec![0., 0., 1., 1.], vec![[0.0; 4], [1.0; 4]]),
        Err(DualError::NoPlane { index: 0 })
    ));
}
