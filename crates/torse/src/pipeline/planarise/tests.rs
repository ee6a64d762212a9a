//! Strips that become plane, and what cannot.

use super::*;
use crate::answer::shapes::shapes;
use crate::certify::claim::{Evidence, Status};
use crate::io::words;

/// A strip between a circle and an ellipse above it, 200 mm wide.
fn twisted(quads: usize) -> QuadStrip {
    let t = |k: usize| 1.8 * k as f64 / quads as f64;
    let a = (0..=quads).map(t).map(|t| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 0.0)).collect();
    let b = (0..=quads).map(t).map(|t| Vec3::new(150.0 * (t + 0.1).cos(), 120.0 * (t + 0.1).sin(), 90.0)).collect();
    QuadStrip::new(a, b).expect("a strip")
}

#[test]
fn a_strip_is_planarised_refined_proven_and_developed() {
    let options = Options { levels: 2, ..Options::new(1e-6) };
    let s = planarise(&twisted(8), &options, &Control::default()).expect("an answer");
    assert_eq!(s.status(), Status::Certified);
    assert_eq!((s.patchwork.panels.len(), s.patterns.len(), s.notes.len()), (32, 1, 3));
    let gap = s.claim(What::DiagonalGap).expect("a claim");
    assert!(gap.value() < 1e-10 && gap.evidence() == Evidence::Proven);
    assert!(s.patterns[0].isometry_error < 1e-9);
    assert!((s.patterns[0].area - s.patterns[0].area_in_space).abs() < 1e-6);
    assert!(!shapes(&s).is_empty());
}

#[test]
fn what_cannot_be_plane_or_moves_too_far_is_not_certified() {
    let x = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    // One warped quadrilateral, all of its corners held.
    let held =
        QuadStrip::new(vec![x(0., 0., 5.), x(50., 0., -5.)], vec![x(0., 50., -5.), x(50., 50., 5.)]).expect("strip");
    let options = Options { hold: Hold::Ends, ..Options::new(0.01) };
    let s = planarise(&held, &options, &Control::default()).expect("an answer");
    assert_eq!(s.status(), Status::Uncertified);
    let reason = words::reason(&s.claims, &[]);
    assert!(reason.contains("hold fewer"), "{reason}");
    let options = Options { most_move: Some(1e-3), ..Options::new(0.01) };
    let s = planarise(&twisted(8), &options, &Control::default()).expect("an answer");
    assert!(words::reason(&s.claims, &[]).contains("moved"));
    let crossed =
        QuadStrip::new(vec![x(50., 0., 0.), x(0., 0., 0.)], vec![x(0., 50., 0.), x(50., 50., 0.)]).expect("strip");
    let s = planarise(&crossed, &Options::new(0.01), &Control::default()).expect("an answer");
    assert!(words::reason(&s.claims, &[]).contains("cross"));
}

/// Refining cuts corners: the strip that is written is farther from the points given than these moved to be plane.
#[test]
fn points_given_are_measured_against_the_strip_that_is_written() {
    let zigzag = |y: f64| {
        (0..7).map(|k| Vec3::new(20.0 * f64::from(k), y, if k % 2 == 0 { 0.0 } else { 10.0 })).collect::<Vec<_>>()
    };
    let strip = QuadStrip::new(zigzag(0.0), zigzag(50.0)).expect("a strip");
    let ask = |levels: usize, most_move: Option<f64>| {
        let options = Options { levels, most_move, ..Options::new(0.01) };
        planarise(&strip, &options, &Control::default()).expect("an answer")
    };
    let value = |s: &Answer, what| s.claim(what).expect("a claim").value();
    let (plain, refined) = (ask(0, None), ask(3, None));
    assert_eq!((value(&plain, What::PointsMoved), value(&refined, What::PointsMoved)), (0.0, 0.0));
    assert!(value(&plain, What::GivenDistance) < 1e-9);
    let far = value(&refined, What::GivenDistance);
    assert!(far > 2.0 && far < 10.0, "{far}");
    assert_eq!(ask(3, Some(1.0)).status(), Status::Uncertified);
}

#[test]
fn bad_requests_are_refused() {
    let s = twisted(8);
    let ask = |o: Options| planarise(&s, &o, &Control::default()).expect_err("refused");
    assert!(matches!(ask(Options::new(f64::NAN)), PlanariseError::Tolerance(_)));
    for levels in [10, 70, 5_000_000_000] {
        assert!(matches!(ask(Options { levels, ..Options::new(0.1) }), PlanariseError::Many { .. }));
    }
}
