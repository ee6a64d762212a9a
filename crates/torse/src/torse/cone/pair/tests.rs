//! Closed forms, the paper's statements, and the whole range of element distances.

use super::*;

/// Largest mismatch anywhere: start, junction, end.
fn smoothness(pair: &ConePair, a: &G1Element, b: &G1Element) -> f64 {
    let length = (b.point - a.point).norm();
    let [one, two] = &pair.segments;
    let ends = one.start.mismatch(a, length).max(two.end().mismatch(b, length));
    ends.max(one.end().mismatch(&two.start, length))
}

/// Element of the tangent surface of a curve with derivatives c', c'', at the distance r from the curve.
fn tangent_element(c: [Vec3; 3], r: f64) -> G1Element {
    let e = c[1].normalize();
    let p = (c[2] - e * e.dot(&c[2])).normalize();
    G1Element::new(c[0] + e * r, e, p).expect("element")
}

fn cubic(u: f64, r: f64) -> G1Element {
    tangent_element(
        [Vec3::new(u, u * u, u * u * u), Vec3::new(1.0, 2.0 * u, 3.0 * u * u), Vec3::new(0.0, 2.0, 6.0 * u)],
        r,
    )
}

fn helix(u: f64, r: f64) -> G1Element {
    let (s, c) = u.sin_cos();
    tangent_element([Vec3::new(c, s, 0.6 * u), Vec3::new(-s, c, 0.6), Vec3::new(-c, -s, 0.0)], r)
}

/// Element of a cone over a space curve.
fn general_cone(u: f64, r: f64) -> G1Element {
    let x = |u: f64| Vec3::new(u.cos(), u.sin(), 1.0 + 0.3 * (2.0 * u).cos());
    let dx = Vec3::new(-u.sin(), u.cos(), -0.6 * (2.0 * u).sin());
    let e = x(u).normalize();
    G1Element::new(e * r, e, dx - e * e.dot(&dx)).expect("element")
}

/// Element of a cylinder over an ellipse.
fn general_cylinder(u: f64, r: f64) -> G1Element {
    let e = Vec3::new(0.3, -0.4, 0.9).normalize();
    let (a, b) = (e.cross(&Vec3::x()).normalize(), e.cross(&e.cross(&Vec3::x())).normalize());
    G1Element::new(a * (2.0 * u.cos()) + b * u.sin() + e * r, e, a * (-2.0 * u.sin()) + b * u.cos()).expect("element")
}

#[test]
fn smooth_to_1e_12_for_distances_from_1_to_1e_4() {
    type Source = (&'static str, fn(f64, f64) -> G1Element);
    let sources: [Source; 4] =
        [("tangent surface", cubic), ("constant slope", helix), ("cone", general_cone), ("cylinder", general_cylinder)];
    for (name, source) in sources {
        for h in [1.0, 0.5, 0.3, 0.1, 0.03, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4] {
            for u in [0.1, 0.35, 0.7] {
                for (r1, r2) in [(1.5, 1.5), (1.2, 1.7)] {
                    let (a, b) = (source(u, r1), source(u + h, r2));
                    for psi in [0.5, 0.4, 0.6] {
                        let options = PairOptions { psi, ..PairOptions::default() };
                        let pair = any_pair(&a, &b, &options).expect(name);
                        // Angles exactly, lines against the distance of the elements: 1e-4 apart, a rounding of
                        // coordinates around 1 is 1e-12 of that.
                        let off = smoothness(&pair, &a, &b) * (b.point - a.point).norm().min(1.0);
                        assert!(off < 1e-12, "{name} u {u} h {h} psi {psi}: {off:e}");
                        let turn = (pair.segments[0].end().normal - pair.segments[1].start.normal).norm();
                        assert!(turn < 1e-13, "{name} h {h}: {turn:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn practical_pairs_are_forward_with_their_vertices_outside() {
    for h in [1.0, 0.3, 0.1, 1e-2, 1e-3] {
        for u in [0.1, 0.4] {
            let options = PairOptions { first: [-0.5, 0.5], second: [-0.5, 0.5], ..PairOptions::default() };
            cone_pair(&cubic(u, 1.5), &cubic(u + h, 1.5), &options).expect("cubic");
            cone_pair(&helix(u, 1.5), &helix(u + h, 1.5), &options).expect("helix");
            // The other nappe: forward on the surface is backward for the moving tangent.
            let beyond = |u: f64| {
                let g = helix(u, -1.5);
                G1Element::new(g.point, g.direction, -g.forward).expect("element")
            };
            cone_pair(&beyond(u), &beyond(u + h), &options).expect("other side");
        }
    }
}

#[test]
fn one_half_is_the_practical_root_of_equation_12() {
    for h in [0.4, 0.2, 0.1, 0.05] {
        let (a, b) = (cubic(0.2, 1.5), cubic(0.2 + h, 1.5));
        let pair = any_pair(&a, &b, &PairOptions::default()).expect("pair");
        let (members, practical) = least_distances(&a, &b).expect("roots");
        let [v, w] = pair.segments.map(|s| s.vertex().expect("vertex"));
        let [mu1, mu2] = members[practical];
        assert!((a.at(mu1) - v).norm() < 1e-9 && (b.at(pair.shift - mu2) - w).norm() < 1e-9, "h = {h}");
    }
}

#[test]
fn theorem_1_the_junctions_touch_one_sphere() {
    let (a, b) = (cubic(0.2, 1.5), cubic(0.8, 1.4));
    let spheres: Vec<_> = [0.3, 0.5, 0.7]
        .iter()
        .map(|&psi| {
            let pair = any_pair(&a, &b, &PairOptions { psi, ..PairOptions::default() }).expect("pair");
            let (m, r) = pair.inscribed_sphere().expect("sphere");
            let g = pair.junction();
            assert!(((m - g.point).dot(&g.normal) - r).abs() < 1e-9);
            (m, r)
        })
        .collect();
    for (m, r) in &spheres[1..] {
        assert!((m - spheres[0].0).norm() < 1e-9 && (r - spheres[0].1).abs() < 1e-9);
    }
}

#[test]
fn constant_slope_has_equal_angles_and_openings() {
    let pair = any_pair(&helix(0.3, 1.5), &helix(1.0, 1.5), &PairOptions::default()).expect("pair");
    let [a, b] = pair.segments.map(|s| s.shape);
    let (Shape::Cone { cos_gamma: c1, angle: f1, .. }, Shape::Cone { cos_gamma: c2, angle: f2, .. }) = (a, b) else {
        panic!("cones")
    };
    assert!((c1 - c2).abs() < 1e-14 && (f1 - f2).abs() < 1e-14 && (f1 - 0.5 * pair.rotation).abs() < 1e-14);
}

#[test]
fn half_turns_are_possible_where_the_caller_allows_them() {
    let (a, b) = (helix(0.0, 1.5), helix(std::f64::consts::PI, 1.5));
    assert!(matches!(any_pair(&a, &b, &PairOptions::default()), Err(PairError::Rotation { .. })));
    let options = PairOptions { rotation_limit: 3.2, ..PairOptions::default() };
    let pair = cone_pair(&a, &b, &options).expect("pair");
    assert!(smoothness(&pair, &a, &b) < 1e-14);
}

#[test]
fn cones_and_cylinders_of_revolution_are_reproduced() {
    let g = G1Element::new(Vec3::new(1.0, 0.0, 2.0), Vec3::new(1.0, 0.0, 2.0), Vec3::y()).expect("element");
    let shape = Shape::Cone { distance: 5f64.sqrt(), cos_gamma: 0.6, sin_gamma: 0.8, angle: 0.9 };
    let whole = Segment::new(g, shape);
    let pair = cone_pair(&whole.start, &whole.end(), &PairOptions::default()).expect("pair");
    for s in pair.segments {
        let Shape::Cone { distance, cos_gamma, .. } = s.shape else { panic!("cone") };
        assert!((distance - 5f64.sqrt()).abs() < 1e-12 && (cos_gamma - 0.6).abs() < 1e-13);
    }
    let whole = Segment::new(g, Shape::Cylinder { radius: -3.0, angle: 0.5 });
    let pair = cone_pair(&whole.start, &whole.end(), &PairOptions::default()).expect("pair");
    for s in pair.segments {
        let Shape::Cylinder { radius, .. } = s.shape else { panic!("cylinder") };
        assert!((radius + 3.0).abs() < 1e-12);
    }
}

#[test]
fn special_members_of_the_family() {
    let (a, b) = (cubic(0.2, 1.5), cubic(0.7, 1.4));
    for psi in congruent_shares(&a, &b).expect("shares").into_iter().filter(|p| *p > 0.0 && *p < 1.0) {
        let pair = any_pair(&a, &b, &PairOptions { psi, ..PairOptions::default() }).expect("pair");
        let [Shape::Cone { cos_gamma: c1, .. }, Shape::Cone { cos_gamma: c2, .. }] = pair.segments.map(|s| s.shape)
        else {
            panic!("cones")
        };
        assert!((c1.abs() - c2.abs()).abs() < 1e-9, "{c1} {c2}");
    }
    for pair in [cylinder_first(&a, &b, &PairOptions::default()), cylinder_last(&a, &b, &PairOptions::default())] {
        let pair = pair.expect("pair");
        assert!(pair.segments.iter().any(|s| s.shape.name() == "cylinder"));
        assert!(smoothness(&pair, &a, &b) < 1e-12, "{}", smoothness(&pair, &a, &b));
    }
}

#[test]
fn vertex_orders_of_the_tangent_surface() {
    // Vertices of pairs lie within O(h²) of the regression curve.
    let off = |h: f64| {
        let pair = any_pair(&cubic(0.3, 1.5), &cubic(0.3 + h, 1.5), &PairOptions::default()).expect("pair");
        let v = pair.segments[0].vertex().expect("vertex");
        (0..4000)
            .map(|i| cubic(0.3 + h * (i as f64 / 2000.0 - 0.5), 0.0).point)
            .map(|c| (c - v).norm())
            .fold(9.0, f64::min)
    };
    let ratio = off(0.1) / off(0.05);
    assert!(ratio > 3.4, "{ratio}");
}

#[test]
fn bad_pairs_are_refused_with_the_reason() {
    let o = PairOptions::default();
    let g = cubic(0.3, 1.5);
    assert_eq!(any_pair(&g, &g, &o), Err(PairError::Identical));
    let opposite = G1Element { direction: -g.direction, forward: -g.forward, ..g };
    assert!(any_pair(&g, &opposite, &o).is_err());
    let moved = G1Element { point: g.point + g.normal, ..g };
    assert!(matches!(any_pair(&g, &moved, &o), Err(PairError::OffsetPlanes { .. })));
    let nan = G1Element { point: Vec3::new(f64::NAN, 0.0, 0.0), ..g };
    assert_eq!(any_pair(&g, &nan, &o), Err(PairError::NotFinite { element: 2 }));
    assert_eq!(any_pair(&g, &cubic(0.5, 1.5), &PairOptions { psi: 1.0, ..o }), Err(PairError::Psi(1.0)));
    // The strip reaches over the regression curve.
    let reach = PairOptions { first: [-2.0, 0.0], ..o };
    assert!(matches!(cone_pair(&g, &cubic(0.5, 1.5), &reach), Err(PairError::Segment { .. })));
    for huge in [1e200, 1e308] {
        let far = G1Element { point: Vec3::repeat(huge), ..cubic(0.5, 1.5) };
        let _ = cone_pair(&g, &far, &o);
    }
}
