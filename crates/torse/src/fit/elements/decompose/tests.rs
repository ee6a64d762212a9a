//! Shapes that are known, put together without continuity; noise from a fixed sequence.

use super::*;

fn plane(n: Vec3, through: Vec3) -> TangentPlane {
    let n = n.normalize();
    TangentPlane { normal: n, offset: n.dot(&through) }
}

fn flat(count: usize) -> Vec<TangentPlane> {
    vec![plane(Vec3::new(0.0, 0.6, 0.8), Vec3::new(0.0, 0.0, 0.25)); count]
}

fn cylinder(count: usize) -> Vec<TangentPlane> {
    let at = |k: usize| (k as f64 * 0.04).sin_cos();
    (0..count).map(at).map(|(s, c)| plane(Vec3::new(c, s, 0.0), Vec3::new(c, s, 0.0) * 1.3)).collect()
}

fn cone(count: usize) -> Vec<TangentPlane> {
    let at = |k: usize| (k as f64 * 0.045).sin_cos();
    (0..count).map(at).map(|(s, c)| plane(Vec3::new(0.8 * c, 0.8 * s, 0.6), Vec3::new(0.2, -0.1, 0.9))).collect()
}

/// Osculating planes of a helix.
fn tangents(count: usize) -> Vec<TangentPlane> {
    (0..count)
        .map(|k| {
            let t = k as f64 * 0.05;
            let (s, c) = t.sin_cos();
            plane(Vec3::new(0.5 * s, -0.5 * c, 1.0), Vec3::new(c, s, 0.5 * t))
        })
        .collect()
}

/// Adds noise of a given size to all coordinates.
fn noisy(planes: &[TangentPlane], size: f64) -> Vec<TangentPlane> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = || {
        // Sum of uniform numbers from a multiplicative sequence, near enough to a normal one.
        (0..12)
            .map(|_| {
                state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
                (state >> 11) as f64 / (1u64 << 53) as f64
            })
            .sum::<f64>()
            - 6.0
    };
    planes
        .iter()
        .map(|p| TangentPlane {
            normal: p.normal + Vec3::new(next(), next(), next()) * size,
            offset: p.offset + next() * size,
        })
        .collect()
}

fn summary(runs: &[EnvelopePiece]) -> Vec<(usize, usize, &'static str)> {
    runs.iter().map(|r| (r.first, r.end, r.shape.name())).collect()
}

#[test]
fn proposition_1_12_every_shape_is_found_with_its_parameters() {
    let all = [flat(20), cylinder(25), cone(25), tangents(25)].concat();
    let runs = decompose(&all, &DecomposeOptions::default()).expect("runs");
    assert_eq!(summary(&runs), [(0, 20, "plane"), (20, 45, "cylinder"), (45, 70, "cone"), (70, 95, "tangent")]);
    assert!(runs.iter().all(|r| !r.ambiguous && r.residual < 1e-7));
    let EnvelopeShape::Plane { plane } = runs[0].shape else { panic!("{:?}", runs[0]) };
    assert!((plane.normal - flat(1)[0].normal).norm() < 1e-12 && (plane.offset - 0.2).abs() < 1e-12);
    let EnvelopeShape::Cylinder { direction } = runs[1].shape else { panic!("{:?}", runs[1]) };
    assert!(direction.cross(&Vec3::z()).norm() < 1e-8);
    let EnvelopeShape::Cone { apex } = runs[2].shape else { panic!("{:?}", runs[2]) };
    assert!((apex - Vec3::new(0.2, -0.1, 0.9)).norm() < 1e-10);
}

#[test]
fn noise_changes_no_label() {
    let all = [cylinder(25), tangents(25), cone(25), flat(20)].concat();
    for size in [1e-6, 1e-5, 5e-5] {
        let options = DecomposeOptions { noise: size, ..DecomposeOptions::default() };
        let runs = decompose(&noisy(&all, size), &options).expect("runs");
        let names: Vec<&str> = runs.iter().map(|r| r.shape.name()).collect();
        assert_eq!(names, ["cylinder", "tangent", "cone", "plane"], "{size}");
        for (r, end) in runs.iter().zip([25usize, 50, 75, 95]) {
            assert!(r.end.abs_diff(end) <= 2 && r.residual < 3.0 * size);
        }
    }
}

#[test]
fn long_sequences_are_searched_coarsely_and_settled() {
    let all = [cylinder(333), cone(301), tangents(407)].concat();
    let runs = decompose(&all, &DecomposeOptions::default()).expect("runs");
    let names: Vec<&str> = runs.iter().map(|r| r.shape.name()).collect();
    assert_eq!(names, ["cylinder", "cone", "tangent"]);
    for (r, end) in runs.iter().zip([333usize, 634, 1041]) {
        assert!(r.end.abs_diff(end) <= 2, "{}", r.end);
    }
}

#[test]
fn motions_scales_and_flipped_normals_change_nothing() {
    let all = [cylinder(25), cone(25), tangents(25)].concat();
    let turn = nalgebra::Rotation3::from_euler_angles(0.5, 0.2, -2.0);
    let shift = Vec3::new(4e4, -2e4, 1e3);
    let moved: Vec<TangentPlane> = all
        .iter()
        .enumerate()
        .map(|(k, p)| {
            let n = turn * p.normal;
            let sign = if k % 3 == 0 { -2.0 } else { 1.0 };
            TangentPlane { normal: n * sign, offset: sign * (p.offset * 1e3 + n.dot(&shift)) }
        })
        .collect();
    let options = DecomposeOptions { centre: shift, size: 1e3, noise: 1e-6 };
    let runs = decompose(&moved, &options).expect("runs");
    assert_eq!(summary(&runs), [(0, 25, "cylinder"), (25, 50, "cone"), (50, 75, "tangent")]);
    let EnvelopeShape::Cone { apex } = runs[1].shape else { panic!("{:?}", runs[1]) };
    assert!((apex - (shift + turn * Vec3::new(0.2, -0.1, 0.9) * 1e3)).norm() < 1e-6);
}

#[test]
fn between_cylinders_and_cones_noise_makes_the_shape_ambiguous() {
    let steep = |slope: f64| -> EnvelopePiece {
        let planes: Vec<TangentPlane> = (0..25)
            .map(|k| (f64::from(k) * 0.045).sin_cos())
            .map(|(s, c)| plane(Vec3::new(c, s, slope), Vec3::new(0.0, 0.0, 0.5 / slope.max(1e-3))))
            .collect();
        let options = DecomposeOptions { noise: 1e-4, ..DecomposeOptions::default() };
        let runs = decompose(&planes, &options).expect("runs");
        assert_eq!(runs.len(), 1);
        runs[0]
    };
    assert!(steep(0.0).shape.name() == "cylinder" && !steep(0.0).ambiguous);
    assert!(steep(0.3).shape.name() == "cone" && !steep(0.3).ambiguous);
    assert!((0..12).any(|k| steep(0.001 * 1.4f64.powi(k)).ambiguous));
}

#[test]
fn bad_sequences_are_refused_by_index() {
    let options = DecomposeOptions::default();
    assert_eq!(decompose(&flat(5), &options), Err(DecomposeError::TooFew(5)));
    let mut broken = flat(9);
    broken[4].normal = Vec3::zeros();
    assert_eq!(decompose(&broken, &options), Err(DecomposeError::Plane(4)));
    broken[4] = TangentPlane { normal: Vec3::z(), offset: f64::NAN };
    assert_eq!(decompose(&broken, &options), Err(DecomposeError::Plane(4)));
    let bad = DecomposeOptions { size: 0.0, ..options };
    assert!(matches!(decompose(&flat(9), &bad), Err(DecomposeError::Option { what: "size", .. })));
}
