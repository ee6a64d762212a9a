//! Rulings, tangent planes and faces of high degree, from data to proven strips.

use super::{strips, value, Random};
use torse::brep::face::Face;
use torse::certify::claim::{Counted, Status, What};
use torse::control::Control;
use torse::geom::Vec3;
use torse::pipeline::elements::{fit_elements, fit_faces, ElementFitError, ElementFitOptions};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::contact::{ContactElement, Given};

/// Ruling and unit normal of the tangent surface of a helix, away from the helix.
pub fn helix(t: f64) -> ([Vec3; 2], Vec3) {
    let c = Vec3::new(500.0 * t.cos(), 500.0 * t.sin(), 300.0 * t);
    let d = Vec3::new(-500.0 * t.sin(), 500.0 * t.cos(), 300.0).normalize();
    let n = d.cross(&Vec3::new(-t.cos(), -t.sin(), 0.0)).normalize();
    ([c + d * 200.0, c + d * 500.0], n)
}

/// Rulings of that surface, evenly spaced.
pub fn rulings(count: usize) -> Vec<[Vec3; 2]> {
    (0..count).map(|i| helix(i as f64 / (count - 1) as f64).0).collect()
}

#[test]
fn rulings_of_a_drawing_in_any_order_are_met() {
    let given: Vec<[Vec3; 2]> = (0..60)
        .map(|i| {
            let [p, q] = rulings(60)[(17 * i) % 60];
            if i % 4 == 0 {
                [q, p]
            } else {
                [p, q]
            }
        })
        .collect();
    let got = fit_elements(&Given::Rulings(given), &ElementFitOptions::new(0.1, "helix"), &Control::default())
        .expect("a fit");
    assert_eq!(got.status(), Status::Certified);
    assert_eq!(
        (got.patchwork().panels.len(), got.patterns().len(), value(&got, What::Count(Counted::Rulings)) as usize),
        (1, 1, 60)
    );
    // Against the truth, between the rulings given.
    let truth: Vec<Vec3> =
        (0..200).map(|i| helix(f64::from(i) / 199.0).0).flat_map(|[p, q]| [p, 0.5 * (p + q), q]).collect();
    let off = torse::certify::points::points(&strips(&got), &truth, &Control::default());
    assert!(off.worst_bound().value() < 0.2, "{}", off.worst_bound().value());
}

#[test]
fn sampled_tangent_planes_are_met_over_their_regions() {
    let planes = (0..60)
        .map(|i| {
            let ([p, q], n) = helix(f64::from(i) / 59.0);
            // Orientation is nobody's business.
            ContactElement {
                normal: if i % 3 == 0 { -n } else { n },
                ends: [0.5 * (p + q); 2],
                radius: 150.0,
                weight: 1.0,
            }
        })
        .collect();
    let got = fit_elements(&Given::Planes(planes), &ElementFitOptions::new(0.1, "helix"), &Control::default())
        .expect("a fit");
    assert_eq!(got.status(), Status::Certified);
    assert_eq!(got.patchwork().panels.len(), 1);
    assert!(value(&got, What::ElementDistance) < 0.05, "{}", value(&got, What::ElementDistance));
}

#[test]
fn noise_of_rulings_is_averaged() {
    let mut random = Random::new(11);
    let noisy = rulings(60)
        .into_iter()
        .map(|r| r.map(|x| x + Vec3::new(random.number(), random.number(), random.number()) * 0.05))
        .collect();
    let got = fit_elements(&Given::Rulings(noisy), &ElementFitOptions::new(0.4, "noisy"), &Control::default())
        .expect("a fit");
    assert_eq!(got.status(), Status::Certified);
    assert!(got.patchwork().panels.len() <= 2, "{}", got.patchwork().panels.len());
}

#[test]
fn rulings_of_no_developable_are_named() {
    let hypar = (0..16)
        .map(|i| f64::from(i) * 40.0 - 300.0)
        .map(|x| [Vec3::new(x, -200.0, -0.4 * x), Vec3::new(x, 200.0, 0.4 * x)])
        .collect();
    let got = fit_elements(&Given::Rulings(hypar), &ElementFitOptions::new(0.1, "hypar"), &Control::default());
    match got {
        Ok(g) => {
            assert_eq!(g.status(), Status::Uncertified);
            assert!(!g.skipped.is_empty() || value(&g, What::Count(Counted::Beyond)) > 0.0);
        }
        Err(e) => assert!(matches!(e, ElementFitError::Estimate(_)), "{e}"),
    }
}

#[test]
fn a_face_of_high_degree_gets_a_lighter_strip() {
    // A cylinder of degree 9 over y.
    let points: Vec<Vec3> = (0..10)
        .flat_map(|i| {
            let x = 50.0 * f64::from(i);
            let z = 80.0 * (x / 140.0).sin();
            [Vec3::new(x, 0.0, z), Vec3::new(x, 200.0, z)]
        })
        .collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    let face = Face::untrimmed(Surface::new(knots(9), knots(1), &points, None).expect("a surface"));
    let got = fit_faces(&[face], &[], &ElementFitOptions::new(0.05, "nine"), &Control::default()).expect("a fit");
    assert_eq!(got.status(), Status::Certified);
    assert_eq!(got.patchwork().panels.len(), 1);
}

#[test]
fn bad_rows_are_refused() {
    let run = |given: Given, tolerance: f64| {
        fit_elements(&given, &ElementFitOptions::new(tolerance, "bad"), &Control::default()).map(|_| ())
    };
    assert!(matches!(run(Given::Rulings(rulings(3)), 0.1), Err(ElementFitError::Few(3, "rulings"))));
    assert!(matches!(run(Given::Rulings(rulings(9)), -1.0), Err(ElementFitError::Tolerance(_))));
    let twice = vec![rulings(9)[0], rulings(9)[1], rulings(9)[1], rulings(9)[2]];
    let repeated = Err(ElementFitError::Repeated { what: "ruling", index: 2 });
    assert_eq!(run(Given::Rulings(twice), 0.1), repeated);
    let far = rulings(9).into_iter().map(|r| r.map(|x| x + Vec3::repeat(1e15))).collect();
    assert!(matches!(run(Given::Rulings(far), 0.1), Err(ElementFitError::Coarse { .. })));
    let mut nan = rulings(9);
    nan[4][1].z = f64::NAN;
    assert!(run(Given::Rulings(nan), 0.1).expect_err("a fault").to_string().contains("ruling 4"));
    let mut point = rulings(9);
    point[2][1] = point[2][0];
    assert!(run(Given::Rulings(point), 0.1).expect_err("a fault").to_string().contains("ruling 2"));
    let flat = ContactElement { normal: Vec3::zeros(), ends: [Vec3::zeros(); 2], radius: 1.0, weight: 1.0 };
    assert!(matches!(run(Given::Planes(vec![flat; 5]), 0.1), Err(ElementFitError::Element { index: 0 })));
}
