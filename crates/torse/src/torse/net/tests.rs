use super::control_net::{affine, plus};
use super::*;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use proptest::prelude::*;

/// A small deterministic generator of numbers in `[0, 1)`.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.next()
    }
}

/// A curve with `pieces` uneven pieces; clamped, or with knots that go on evenly beyond the ends.
fn any_curve(numbers: &mut Numbers, degree: usize, pieces: usize, clamped: bool) -> Curve<3> {
    let count = degree + pieces;
    let mut values: Vec<f64> = Vec::new();
    let mut t = 0.0;
    for _ in 0..count + degree + 1 {
        values.push(t);
        t += numbers.between(0.2, 1.0);
    }
    if clamped {
        let (a, b) = (values[degree], values[count]);
        values[..degree].fill(a);
        values[count + 1..].fill(b);
    }
    let control = (0..count)
        .map(|i| [i as f64 + numbers.between(-0.3, 0.3), numbers.between(-1.0, 1.0), numbers.between(-1.0, 1.0)])
        .collect();
    Curve::new(degree, values, control).expect("valid curve")
}

fn rational(numbers: &mut Numbers, curve: &Curve<3>) -> Curve<4> {
    let control = curve.control.iter().map(|c| {
        let w = numbers.between(0.6, 1.5);
        [w * c[0], w * c[1], w * c[2], w]
    });
    Curve { knots: curve.knots.clone(), control: control.collect() }
}

/// Largest of det(c', d', d − c)/(|c'| |d'| |d − c|) over rulings of the domain.
fn twist(net: &Net) -> f64 {
    let (a, b) = net.domain();
    let mut worst = 0.0f64;
    for k in 0..=60 {
        let u = a + (b - a) * f64::from(k) / 60.0;
        let [c, c1, e, e1] = net.jet(u);
        worst = worst.max(coplanar(&c, &c1, &plus(&c, &e, 1.0), &plus(&c1, &e1, 1.0)));
    }
    worst
}

/// Share of the volume of c', d', d − c, from homogeneous points and derivatives.
fn coplanar(c: &[f64; 4], c1: &[f64; 4], d: &[f64; 4], d1: &[f64; 4]) -> f64 {
    let (p, q) = (affine(c), affine(d));
    let slope = |x: &[f64; 4], x1: &[f64; 4]| (Vec3::new(x1[0], x1[1], x1[2]) - affine(x) * x1[3]) / x[3];
    let (p1, q1, e) = (slope(c, c1), slope(d, d1), q - p);
    (p1.cross(&q1).dot(&e) / (p1.norm() * q1.norm() * e.norm())).abs()
}

fn stars(net: &Net) -> (f64, f64) {
    (net.shape().lambda_star(), net.shape().m_star())
}

/// A regular net of each kind of curve.
fn sample(seed: u64, degree: usize, pieces: usize, clamped: bool) -> Net {
    let mut n = Numbers(seed);
    let c = any_curve(&mut n, degree, pieces, clamped);
    let (a, b) = c.domain();
    let (lambda, m) = (a - n.between(0.3, 2.0) * (b - a), a - n.between(0.35, 2.0) * (b - a));
    let shape = Shape::from_stars((a, b), lambda, m).expect("outside the domain");
    Net::through(&c, &(Vec3::from(c.control[0]) + Vec3::new(0.2, 1.0, 0.7)), shape).expect("a net")
}

#[test]
fn theorem_1_blossoms_agree_at_lambda_star_and_m_star() {
    for (degree, pieces, clamped) in [(1, 4, true), (2, 3, true), (3, 4, false), (4, 1, true), (5, 3, false)] {
        let net = sample(7 + degree as u64, degree, pieces, clamped);
        let (lambda, m) = stars(&net);
        let d = net.opposite();
        let breaks = net.curve().knots.breaks();
        for w in breaks.windows(2) {
            let at = 0.3 * w[0] + 0.7 * w[1];
            let mut args: Vec<f64> = (0..degree).map(|k| w[0] + 0.2 * k as f64).collect();
            args[0] = lambda;
            let x = net.curve().blossom(at, &args).expect("as many arguments");
            args[0] = m;
            let y = d.blossom(at, &args).expect("as many arguments");
            let size = x.iter().fold(1.0f64, |s, v| s.max(v.abs()));
            for k in 0..4 {
                assert!((x[k] - y[k]).abs() < 1e-11 * size, "degree {degree}");
            }
        }
        assert!(twist(&net) < 1e-12);
    }
}

#[test]
fn corollary_1_aumanns_bezier_nets_have_the_same_cell_everywhere() {
    let polygon = [[0., 0., 0.], [1., 1., 0.2], [2., 1.2, -0.3], [3., 0.4, 0.5], [4., 0., 0.]].map(Vec3::from);
    let d_0 = Vec3::new(-0.2, 1.0, 1.0);
    let (lambda, mu) = (1.3, 0.8);
    let net = aumann(&polygon, &d_0, lambda, mu).expect("a net");
    let d: Vec<Vec3> = net.opposite_points().iter().map(affine).collect();
    for i in 1..polygon.len() {
        let want = polygon[i - 1] * (1.0 - lambda - mu) + polygon[i] * lambda + d[i - 1] * mu;
        assert!((d[i] - want).norm() < 1e-13);
    }
    // (12): (1 − Λ) C_i + Λ C_{i+1} = (1 − M) D_i + M D_{i+1}, with Λ = λ/(1 − μ), M = 1/(1 − μ).
    let (l, m) = (lambda / (1.0 - mu), 1.0 / (1.0 - mu));
    for i in 0..polygon.len() - 1 {
        let off = polygon[i] * (1.0 - l) + polygon[i + 1] * l - d[i] * (1.0 - m) - d[i + 1] * m;
        assert!(off.norm() < 1e-12);
    }
    assert!(twist(&net) < 1e-13);
}

#[test]
fn corollary_2_cells_satisfy_the_condition_on_knots() {
    let net = sample(3, 3, 5, false);
    let (lambda, m) = stars(&net);
    let (n, u, d) = (3, paper_knots(&net.curve().knots).to_vec(), net.opposite_points());
    let c = &net.curve().control;
    for i in 0..c.len() - 1 {
        for k in 0..3 {
            let side =
                |x: &[[f64; 4]], s: f64| ((u[i + n] - s) * x[i][k] + (s - u[i]) * x[i + 1][k]) / (u[i + n] - u[i]);
            assert!((side(c, lambda) - side(&d, m)).abs() < 1e-12);
        }
    }
}

#[test]
fn corollary_3_regular_exactly_if_both_numbers_lie_on_one_side_of_all_segments() {
    let mut n = Numbers(11);
    let c = any_curve(&mut n, 3, 4, true);
    let (a, b) = c.domain();
    let d_0 = Vec3::from(c.control[0]) + Vec3::new(0.1, 0.4, 1.0);
    let mut seen = [0, 0];
    for k in 0..200 {
        let (lambda, m) = (n.between(a - 6.0, b + 6.0), n.between(a - 6.0, b + 6.0));
        let Some(shape) = Shape::from_stars((a, b), lambda, m) else { continue };
        let segments: Vec<[f64; 2]> = c.knots.breaks().windows(2).map(|w| shape.of_segment(w[0], w[1])).collect();
        let one_side =
            segments.iter().all(|s| s[0] < 0.0 && s[1] < 0.0) || segments.iter().all(|s| s[0] > 1.0 && s[1] > 1.0);
        let found = shape.regression_within((0.0, 1.0));
        assert_eq!(found.is_none(), one_side, "case {k}: {lambda} {m}");
        seen[usize::from(one_side)] += 1;
        if let (Some((u, v)), Ok(net)) = (found, Net::through(&c, &d_0, shape)) {
            // The normal c_u × c_v vanishes at the witness.
            let [x, x1, e, e1] = net.jet(u);
            let (along, ruling) = (plus(&x1, &e1, v), affine(&plus(&e, &[0.0, 0.0, 0.0, 1.0], 1.0)));
            let slope = Vec3::new(along[0], along[1], along[2]);
            let size = Vec3::new(x1[0], x1[1], x1[2]).norm() * ruling.norm();
            assert!(slope.cross(&ruling).norm() < 1e-9 * (size + x[0].abs()));
            assert!(!net.regularity().holds());
        }
    }
    assert!(seen[0] > 20 && seen[1] > 20);
}

#[test]
fn the_explicit_formula_of_the_paper_gives_the_same_polygon() {
    // (16), with M* away from all knots.
    let net = sample(23, 3, 4, true);
    let (lambda, m) = stars(&net);
    let (n, u, c) = (3, paper_knots(&net.curve().knots), &net.curve().control);
    for last in 1..c.len() {
        let product = |from: usize| (from..last).map(|j| (m - u[n + j]) / (m - u[j])).product::<f64>();
        for k in 0..3 {
            let sum: f64 = (0..last).map(|i| product(i + 1) * (c[i + 1][k] - c[i][k]) / (m - u[i])).sum();
            let want = product(0) * net.rulings()[0][k] + (lambda - m) * sum;
            assert!((net.rulings()[last][k] - want).abs() < 1e-12);
        }
    }
}

#[test]
fn segments_follow_each_other_as_in_equation_10() {
    let net = sample(29, 2, 5, true);
    let breaks = net.curve().knots.breaks();
    let pairs: Vec<[f64; 2]> = breaks.windows(2).map(|w| net.shape().of_segment(w[0], w[1])).collect();
    for k in 1..pairs.len() {
        let ratio = (breaks[k] - breaks[k - 1]) / (breaks[k + 1] - breaks[k]);
        for j in 0..2 {
            assert!((pairs[k][j] - ratio * (pairs[k - 1][j] - 1.0)).abs() < 1e-12);
        }
    }
    // (19): the Bézier net of every segment is one of Aumann's.
    let d = net.opposite();
    let pieces = |c: &Curve<4>| crate::spline::curve::bezier_pieces(c);
    for ((p, q), pair) in pieces(net.curve()).iter().zip(&pieces(&d)).zip(&pairs) {
        for i in 0..2 {
            for k in 0..3 {
                let side = |x: &[[f64; 4]], s: f64| (1.0 - s) * x[i][k] + s * x[i + 1][k];
                assert!((side(&p.2, pair[0]) - side(&q.2, pair[1])).abs() < 1e-11);
            }
        }
    }
}

#[test]
fn cells_follow_each_other_as_in_equation_18_also_on_cones() {
    for shape_of in [|d: (f64, f64)| Shape::from_stars(d, d.0 - 1.0, d.0 - 0.6), |d| Some(Shape::new(d, 0.0, 0.4))] {
        let mut numbers = Numbers(31);
        let c = any_curve(&mut numbers, 3, 5, false);
        let shape = shape_of(c.domain()).expect("a shape");
        let net = Net::through(&c, &Vec3::new(0.0, 1.0, 2.0), shape).expect("a net");
        let (n, u) = (3, paper_knots(&net.curve().knots));
        let cells: Vec<[f64; 2]> = (1..c.control.len()).map(|i| shape.of_cell(u[i - 1], u[i + n - 1])).collect();
        let d = net.opposite_points();
        for i in 1..c.control.len() {
            let [lambda, mu] = cells[i - 1];
            for k in 0..3 {
                let want = (1.0 - lambda - mu) * c.control[i - 1][k] + lambda * c.control[i][k] + mu * d[i - 1][k];
                assert!((d[i][k] - want).abs() < 1e-12);
            }
            if i >= 2 {
                let [l, m] = cells[i - 2];
                let below = u[i + n - 2] - u[i - 1] + m * (u[i - 1] - u[i - 2]);
                let want = [
                    (m * (u[i - 1] - u[i - 2]) + l * (u[i + n - 2] - u[i - 2]) - u[i - 1] + u[i - 2]) / below,
                    (u[i + n - 2] - u[i + n - 1] + m * (u[i + n - 1] - u[i - 2])) / below,
                ];
                assert!((want[0] - lambda).abs() < 1e-12 && (want[1] - mu).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn cylinders_have_lambda_equal_to_m_and_cones_parallel_polygons() {
    let mut n = Numbers(37);
    let c = any_curve(&mut n, 3, 4, true);
    let net = Net::through(
        &c,
        &(Vec3::from(c.control[0]) + Vec3::z()),
        Shape::from_stars(c.domain(), 12.0, 12.0).expect("s"),
    )
    .expect("a net");
    assert!(matches!(net.kind(), NetKind::Cylinder { direction } if (direction - Vec3::z()).norm() < 1e-15));
    assert!(net.rulings().iter().all(|e| e[0].abs() + e[1].abs() < 1e-15));
    assert!(net.regression_point(c.domain().0).is_none() && net.clearance_estimate().is_infinite());
    let plain = Net::cylinder(homogeneous(&c), &Vec3::new(0.0, 0.0, 2.0)).expect("a cylinder");
    assert!(plain.rulings().iter().all(|e| *e == [0.0, 0.0, 2.0, 0.0]) && twist(&plain) < 1e-14);

    let vertex = Vec3::new(1.0, -3.0, 2.0);
    let cone = Net::cone(homogeneous(&c), &vertex, 0.4).expect("a cone");
    assert!(matches!(cone.kind(), NetKind::Cone { vertex: v } if (v - vertex).norm() < 1e-14));
    for (c, d) in cone.curve().control.iter().zip(cone.opposite_points()) {
        assert!((affine(&d) - affine(c) - (vertex - affine(c)) * 0.4).norm() < 1e-14);
    }
    for u in [0.1, 0.5, 0.9].map(|s| c.domain().0 * (1.0 - s) + c.domain().1 * s) {
        assert!((cone.regression_point(u).expect("finite") - vertex).norm() < 1e-12);
    }
    // Rational cones have their vertex in the weights.
    let q = rational(&mut n, &c);
    let cone = Net::cone(q, &vertex, 0.4).expect("a cone");
    assert!(matches!(cone.kind(), NetKind::Cone { vertex: v } if (v - vertex).norm() < 1e-14));
    assert!(twist(&cone) < 1e-12 && cone.regularity().holds());
    let (p, q) = (affine(&cone.curve().control[0]), affine(&cone.opposite_points()[0]));
    assert!((q - p - (vertex - p) * 0.4).norm() < 1e-14);
}

#[test]
fn the_regression_curve_is_a_spline_of_one_degree_more_with_polar_boundaries() {
    for is_rational in [false, true] {
        let mut n = Numbers(41);
        let c = any_curve(&mut n, 4, 4, true);
        let mut r = homogeneous(&c);
        if is_rational {
            r = rational(&mut n, &c);
        }
        let (a, b) = c.domain();
        let net = Net::tangent_surface(&r, a - 0.9 * (b - a), a - 0.3 * (b - a)).expect("a net");
        assert_eq!(net.degree(), 3);
        assert!(twist(&net) < 1e-11);
        for k in 0..=20 {
            let u = a + (b - a) * f64::from(k) / 20.0;
            let point = net.regression_point(u).expect("finite");
            assert!((point - affine(&r.point(u))).norm() < 1e-11, "u = {u}");
        }
        // The recursion gives the same net.
        let again = Net::from_first(net.curve().clone(), net.rulings()[0], *net.shape()).expect("a net");
        for (x, y) in again.rulings().iter().zip(net.rulings()) {
            assert!((0..4).all(|k| (x[k] - y[k]).abs() < 1e-11));
        }
    }
}

#[test]
fn equation_17_restriction_across_keeps_m_star() {
    let net = sample(43, 3, 4, true);
    let (lambda, m) = stars(&net);
    for beta in [0.3, 2.5] {
        let part = net.between(0.0, beta).expect("a part");
        let (l, mm) = stars(&part);
        assert!((mm - m).abs() < 1e-12 && (l - m - beta * (lambda - m)).abs() < 1e-12);
    }
    let turned = net.exchanged().expect("exchanged");
    let (l, mm) = stars(&turned);
    assert!((l - m).abs() < 1e-11 && (mm - lambda).abs() < 1e-11);
    let again = Net::from_first(turned.curve().clone(), turned.rulings()[0], *turned.shape()).expect("a net");
    for (x, y) in again.rulings().iter().zip(turned.rulings()) {
        assert!((0..4).all(|k| (x[k] - y[k]).abs() < 1e-10));
    }
    assert!(net.between(0.5, 0.5).is_err());
}

#[test]
fn parts_and_extensions_are_the_same_surface() {
    for is_rational in [false, true] {
        let net = if is_rational { rational_sample() } else { sample(47, 3, 4, false) };
        let (a, b) = net.domain();
        let h = b - a;
        for (x, y) in [(a + 0.2 * h, b - 0.3 * h), (a - 0.05 * h, b + 0.04 * h), (a - 0.1 * h, a + 0.5 * h)] {
            let part = net.over(x, y).expect("a part");
            let stars_differ = (stars(&part).0 - stars(&net).0).abs() + (stars(&part).1 - stars(&net).1).abs();
            assert!(stars_differ < 1e-9, "{stars_differ}");
            assert!(twist(&part) < 1e-9);
            for k in 0..=10 {
                let u = (x + (y - x) * f64::from(k) / 10.0).clamp(a, b);
                let (p, q) = (part.ruling(u), net.ruling(u));
                assert!((p[0] - q[0]).norm() + (p[1] - q[1]).norm() < 1e-10);
            }
            let again = Net::from_first(part.curve().clone(), part.rulings()[0], *part.shape()).expect("a net");
            let last = again.rulings().len() - 1;
            assert!((0..3).all(|k| (again.rulings()[last][k] - part.rulings()[last][k]).abs() < 1e-8));
        }
        let back = net.reversed();
        let again = Net::from_first(back.curve().clone(), back.rulings()[0], *back.shape()).expect("a net");
        let last = again.rulings().len() - 1;
        assert!((0..3).all(|k| (again.rulings()[last][k] - back.rulings()[last][k]).abs() < 1e-10));
        assert!(net.over(b + 1.0, b + 2.0).is_err() && net.over(b, a).is_err() && net.over(f64::NAN, b).is_err());
    }
}

fn rational_sample() -> Net {
    let mut n = Numbers(53);
    let c = any_curve(&mut n, 3, 3, true);
    let c = rational(&mut n, &c);
    let (a, b) = c.domain();
    let shape = Shape::from_stars((a, b), a - 0.6 * (b - a), a - 0.8 * (b - a)).expect("a shape");
    Net::from_first(c, [0.1, 0.9, 0.5, 0.05], shape).expect("a net")
}

#[test]
fn rational_nets_are_developable_with_positive_weights() {
    let net = rational_sample();
    assert!(net.is_rational() && twist(&net) < 1e-12);
    assert!(net.regularity().holds(), "{:?}", net.regularity());
    // R = (Λ* − u) C + (u − M*) D is tangent to the rulings.
    let (a, b) = net.domain();
    let h = 1e-5 * (b - a);
    for k in 1..10 {
        let u = a + (b - a) * f64::from(k) / 10.0;
        let at = |u: f64| net.regression_point(u).expect("finite");
        let along = (at(u + h) - at(u - h)).normalize();
        let [p, q] = net.ruling(u);
        assert!(along.cross(&(q - p).normalize()).norm() < 1e-6);
    }
}

#[test]
fn elevation_and_tapers_stay_on_the_surface() {
    for is_rational in [false, true] {
        let net = if is_rational { rational_sample() } else { sample(59, 2, 4, true) };
        let (a, b) = net.domain();
        let (c, d) = net.elevated().expect("degree allowed");
        let plain = TaperedNet { net: net.clone(), taper: (1.0, 1.0) };
        let (pc, pd) = plain.boundaries().expect("degree allowed");
        let strip = TaperedNet { net: net.clone(), taper: (0.4, 1.7) };
        let patch = strip.patch().expect("a patch");
        assert_eq!(patch.knots_u.degree(), net.degree() + 1);
        for k in 0..=30 {
            let u = a + (b - a) * f64::from(k) / 30.0;
            let [p, q] = net.ruling(u);
            assert!((affine(&c.point(u)) - p).norm() + (affine(&d.point(u)) - q).norm() < 1e-12);
            assert!((affine(&pc.point(u)) - p).norm() + (affine(&pd.point(u)) - q).norm() < 1e-12);
            let [x, _, e, _] = net.jet(u);
            let want = affine(&plus(&x, &e, strip.factor(u)));
            assert!((patch.point(u, 1.0) - want).norm() < 1e-12 && (patch.point(u, 0.0) - p).norm() < 1e-12);
            // Still one tangent plane along the ruling.
            let (s, t) = (patch.jet(u, 0.0), patch.jet(u, 1.0));
            assert!(s.normal().cross(&t.normal()).norm() < 1e-9 * s.normal().norm() * t.normal().norm());
        }
    }
    // A taper towards the regression curve is found to be singular.
    let net = sample(61, 3, 3, true);
    let (lambda, m) = stars(&net);
    assert!(lambda < m || net.shape().kappa < 0.0 || net.regression(net.domain().0) < 0.0);
    let reach = net.regression(net.domain().1).abs().max(net.regression(net.domain().0).abs());
    let sign = net.regression(net.domain().0).signum();
    let strip = TaperedNet { net, taper: (sign, 2.0 * sign * reach) };
    assert!(matches!(strip.regularity(), Regularity::Regression { .. } | Regularity::Weight { .. }));
}

#[test]
fn the_first_cell_determines_the_net() {
    let net = sample(67, 4, 3, true);
    let d: Vec<Vec3> = net.opposite_points().iter().map(affine).collect();
    let c = Curve {
        knots: net.curve().knots.clone(),
        control: net.curve().control.iter().map(|p| [p[0], p[1], p[2]]).collect(),
    };
    let again = from_first_cell(&c, &d[0], &d[1]).expect("a net");
    for (x, y) in again.opposite_points().iter().zip(&d) {
        assert!((affine(x) - y).norm() < 1e-11);
    }
    let off = d[1] + Vec3::new(0.3, 0.3, -0.2);
    assert!(matches!(from_first_cell(&c, &d[0], &off), Err(NetError::Cell { .. })));
    let tangent = Vec3::from(c.control[0]) * 2.0 - Vec3::from(c.control[1]);
    assert!(matches!(from_first_cell(&c, &tangent, &d[1]), Err(NetError::Cell { .. })));
    assert!(from_first_cell(&c, &Vec3::repeat(f64::NAN), &d[1]).is_err());
}

#[test]
fn patches_are_read_back_with_their_deviation() {
    for net in [
        sample(71, 3, 4, true),
        rational_sample(),
        Net::cone(rational_sample().curve().clone(), &Vec3::new(1.0, 5.0, 2.0), 0.3).expect("cone"),
    ] {
        let mut patch = net.patch().expect("a patch");
        let back = recognise(&patch).expect("a net");
        assert!(back.deviation < 1e-11, "{}", back.deviation);
        assert!((back.net.shape().m - net.shape().m).abs() < 1e-9);
        // A patch that is no net is seen.
        let n = patch.control.len();
        patch.control[n - 3][2] += 0.05;
        let off = recognise(&patch).expect("a net").deviation;
        assert!(off > 0.01 && off < 10.0, "{off}");
    }
}

#[test]
fn the_dual_form_is_exact_and_the_primal_form_states_its_error() {
    // A helix-like curve: no inflections.
    let control: Vec<[f64; 3]> =
        (0..8).map(|k| f64::from(k) * 0.25).map(|t| [10.0 * t.cos(), 10.0 * t.sin(), 4.0 * t]).collect();
    let r =
        Curve::<3>::new(3, Knots::uniform(3, 5, 0.0, 1.0).expect("knots").values().to_vec(), control).expect("curve");
    let net = Net::tangent_surface(&homogeneous(&r), -2.0, -1.0).expect("a net");
    assert!(net.regularity().holds());
    let dual = to_dual(&net).expect("no inflection");
    assert!(dual.error_estimate < 1e-8, "{}", dual.error_estimate);
    for (spans, allowed) in [(1, 1e-2), (40, 1e-4)] {
        let primal = to_primal(&net, 1e-6, spans).expect("ordered rulings");
        eprintln!("{spans} {}", primal.error_estimate);
        assert!(primal.error_estimate < allowed, "{}", primal.error_estimate);
        assert!(primal.error_estimate > 1e-9);
    }
}

#[test]
fn a_ruling_along_the_curve_is_found() {
    // A cylinder over a plane arc whose tangent turns through the direction of the rulings at u = 1/2.
    let c = Curve::<3>::new(2, vec![0., 0., 0., 1., 1., 1.], vec![[0., 0., 0.], [1., 0., 1.], [0., 0., 2.]])
        .expect("curve");
    let net = Net::cylinder(homogeneous(&c), &Vec3::new(0.0, 0.3, 1.0)).expect("a cylinder");
    assert!(net.regularity().holds());
    let net = Net::cylinder(homogeneous(&c), &Vec3::z()).expect("a cylinder");
    assert!(matches!(net.regularity(), Regularity::TangentRuling { u } if (u - 0.5).abs() < 1e-6));
}

#[test]
fn bad_data_are_refused_by_name() {
    let mut n = Numbers(73);
    let c = any_curve(&mut n, 2, 3, true);
    let (a, b) = c.domain();
    let d_0 = Vec3::new(0.0, 0.0, 3.0);
    let knot = c.knots.breaks()[1];
    let shape = Shape::from_stars((a, b), b + 1.0, knot).expect("a shape");
    assert!(matches!(Net::through(&c, &d_0, shape), Err(NetError::OnKnot { .. })));
    assert!(matches!(Net::through(&c, &d_0, Shape::new((a, b), f64::NAN, 0.0)), Err(NetError::Shape { .. })));
    assert!(matches!(
        Net::through(&c, &Vec3::repeat(f64::NAN), Shape::new((a, b), 0.0, 0.1)),
        Err(NetError::Ruling { .. })
    ));
    assert!(Net::through(&c, &Vec3::from(c.control[0]), Shape::new((a, b), 0.0, 0.1)).is_err());
    let mut q = homogeneous(&c);
    q.control[1][3] = 0.0;
    assert!(matches!(
        Net::from_first(q, [0.0, 0.0, 1.0, 0.0], Shape::new((a, b), 0.0, 0.1)),
        Err(NetError::Weight { index: 1, .. })
    ));
    assert!(
        aumann(&[Vec3::zeros()], &d_0, 1.0, 1.0).is_err()
            && aumann(&[Vec3::zeros(), Vec3::x()], &d_0, 1.0, -1.0).is_err()
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn all_nets_are_developable_and_commute_with_motions(
        seed in 0u64..10_000, degree in 1usize..6, pieces in 1usize..6, clamped: bool, kappa in -0.5..2.0f64, x in -0.6..0.6f64,
    ) {
        let mut n = Numbers(seed);
        let c = any_curve(&mut n, degree, pieces, clamped);
        let (a, b) = c.domain();
        let shape = Shape::new((a, b), 2.0 * x / (b - a), kappa);
        let d_0 = Vec3::from(c.control[0]) + Vec3::new(0.3, 0.5, 1.0);
        let Ok(net) = Net::through(&c, &d_0, shape) else { return Ok(()) };
        // Where M* comes near a knot outside the domain, the ruling vectors grow and digits are lost.
        let size = net.rulings().iter().flatten().fold(1.0f64, |m, x| m.max(x.abs()));
        prop_assume!(size < 1e3);
        prop_assert!(twist(&net) < 1e-9 * size);
        // Halved and moved: control points of the image are images of the control points.
        let image = |p: &[f64; 3]| [0.5 * p[1] + 3.0, -0.5 * p[0], 0.5 * p[2] - 1.0];
        let moved = Curve { knots: c.knots.clone(), control: c.control.iter().map(image).collect() };
        let other = Net::through(&moved, &Vec3::from(image(&[d_0.x, d_0.y, d_0.z])), shape).expect("a net");
        for (p, q) in net.opposite_points().iter().zip(other.opposite_points()) {
            let want = Vec3::from(image(&[p[0], p[1], p[2]]));
            prop_assert!((affine(&q) - want).norm() < 1e-9 * size);
        }
        prop_assert_eq!(net.regularity().holds(), other.regularity().holds());
    }
}
