//! Faces that are curved all around, beside flat parts.

use super::super::{unroll, UnrollError, UnrollOptions};
use super::{model_of, rectangle};
use crate::brep::face::Face;
use crate::brep::support_surface::SupportSurface;
use crate::certify::claim::Status;
use crate::control::Control;
use crate::geom::{Frame, Vec3};
use crate::io::step::write::{self as step, Header};
use crate::io::words::why;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Whole spheres and tori beside a plate are covered with cones about their axis, which meet.
#[test]
fn faces_all_round_an_axis_are_covered_beside_flat_parts() {
    let frame = Frame::world();
    for (support, v, least) in [
        (SupportSurface::Torus { frame, major: 500.0, minor: 150.0 }, (0.0, TAU), 5),
        (SupportSurface::Sphere { frame, radius: 500.0 }, (-FRAC_PI_2, FRAC_PI_2), 4),
    ] {
        let closed = Face::untrimmed(support.to_spline((0.0, TAU), v).expect("a spline").0);
        let whole = crate::brep::area::area_estimate(&closed);
        let good = rectangle(Vec3::new(900.0, 0.0, 0.0), 100.0 * Vec3::x(), 100.0 * Vec3::y());
        let options = UnrollOptions { surfaces: true, approximate: Some(10.0), ..UnrollOptions::new(0.05) };
        let answer = unroll(&model_of(vec![closed, good]), &options, &Control::default()).expect("an answer");
        let told: Vec<String> = answer.claims.iter().filter_map(|c| c.reason()).map(why).collect();
        assert_eq!((answer.status(), answer.skipped.len()), (Status::Certified, 0), "{told:?}");
        assert!(answer.patterns.len() > least, "{}", answer.patterns.len());
        let area: f64 = answer.patterns.iter().map(|p| p.area).sum::<f64>() - 1e4;
        assert!((area - whole).abs() < 0.03 * whole, "{area} {whole}");
    }
}

/// All of a torus but a narrow gap goes round no axis: it is not covered beside flat parts, which would take long.
#[test]
fn faces_that_are_curved_all_around_are_left_to_the_other_job() {
    const GAP: f64 = 0.1;
    let torus = SupportSurface::Torus { frame: Frame::world(), major: 500.0, minor: 150.0 };
    let (surface, _) = torus.to_spline((GAP, TAU - GAP), (GAP, TAU - GAP)).expect("a surface");
    let header = Header { name: "ring".into(), time: "2026-01-01T00:00:00".into(), uncertainty: 1e-6 };
    let bytes = step::shells(&header, &[step::Shell::untrimmed("ring", &surface)]).expect("a file");
    let ring = crate::read(&bytes).expect("a model");
    let options = UnrollOptions { surfaces: true, approximate: Some(1.0), ..UnrollOptions::new(0.1) };
    let Err(UnrollError::Round(why)) = unroll(&ring, &options, &Control::default()) else { panic!("not refused") };
    // The integral of |cos v| over both ranges.
    let exact = (4.0 - 2.0 * GAP.sin()) * (TAU - 2.0 * GAP) / TAU;
    assert!((why.turns - exact).abs() < 1e-2, "{} {exact}", why.turns);
    // Beside a plate it is named.
    let mut model = ring;
    model.faces.push(rectangle(Vec3::zeros(), 40.0 * Vec3::x(), 30.0 * Vec3::y()));
    let answer = unroll(&model, &options, &Control::default()).expect("an answer");
    assert_eq!((answer.patterns.len(), answer.skipped.len()), (1, 1));
    assert_ne!(answer.status(), Status::Certified);
}
