//! Fits of meshes.

use super::*;

/// A fine mesh of a cylinder without the triangles within 25 mm of its middle, whose corners stay.
fn holed() -> Cloud {
    const N: u32 = 40;
    let middle = Vec3::new(100.0, 0.0, 75.0);
    let place = |k: u32| {
        let (s, c) = (0.03 * f64::from(k / (N + 1)) - 0.6).sin_cos();
        Vec3::new(100.0 * c, 100.0 * s, 3.75 * f64::from(k % (N + 1)))
    };
    let points: Vec<Vec3> = (0..(N + 1) * (N + 1)).map(place).collect();
    let cell = |i: u32, j: u32| {
        let k = i * (N + 1) + j;
        [[k, k + N + 1, k + 1], [k + N + 1, k + N + 2, k + 1]]
    };
    let all = (0..N).flat_map(|i| (0..N).flat_map(move |j| cell(i, j)));
    let kept = |t: &[u32; 3]| t.iter().all(|&k| (points[k as usize] - middle).norm() > 25.0);
    let triangles = all.filter(kept).collect();
    Cloud { points, triangles }
}

#[test]
fn corners_of_deleted_triangles_are_no_points_of_the_sheet() {
    let mesh = holed();
    let answer = fit(&mesh, &FitOptions::new(0.5, "hole"), &Control::default()).expect("an answer");
    let unused = mesh.used().1;
    assert!(
        unused > 20 && answer.notes.contains(&Note::Fit(FitNote::Unused { count: unused, kept: false })),
        "{:?}",
        answer.notes
    );
    let points = answer.claim(What::Count(Counted::Points)).expect("a count").value();
    assert_eq!(points, (mesh.points.len() - unused) as f64);
    let holes = answer.notes.iter().find_map(|n| match n {
        Note::Fit(FitNote::Ends { outlines, .. }) => outlines.as_ref().map(|o| o.holes),
        _ => None,
    });
    assert_eq!(holes, Some(1));
}

#[test]
fn what_was_stopped_is_not_said_to_have_no_border() {
    let control = Control::default();
    control.cancel();
    let answer = fit(&holed(), &FitOptions::new(0.5, "hole"), &control).expect("an answer");
    assert!(!answer.notes.iter().any(|n| matches!(n, Note::Fit(FitNote::Ends { .. }))), "{:?}", answer.notes);
}
