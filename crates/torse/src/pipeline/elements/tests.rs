//! Planes and rulings of cones: what robust fits leave out, and what is said of given tangent planes.

use super::*;
use crate::certify::claim::What;
use crate::geom::Vec3;

/// A ruling of a circular cone with its normal turned about it, at a share of 2 rad.
fn element(share: f64, turned: f64) -> ContactElement {
    let ((s, c), (p, q)) = ((2.0 * share).sin_cos(), 0.5_f64.sin_cos());
    let (ray, normal) = (Vec3::new(p * c, p * s, q), Vec3::new(q * c, q * s, -p));
    let normal = normal * turned.cos() + ray.cross(&normal) * turned.sin();
    ContactElement { normal, ends: [ray * 100.0, ray * 300.0], radius: 20.0, weight: 1.0 }
}

fn fitted(given: Vec<ContactElement>, robust: bool) -> Answer {
    let options = ElementFitOptions { robust, ..ElementFitOptions::new(0.2, "cone") };
    fit_elements(&Given::Planes(given), &options, &Control::default()).expect("an answer")
}

/// Planes without rulings, some of them lifted.
fn planes(lifted: &[(usize, f64)]) -> Vec<ContactElement> {
    let plane = |k: usize| {
        let e = element(k as f64 / 29.0, 0.0);
        let lift = lifted.iter().find(|l| l.0 == k).map_or(0.0, |l| l.1);
        ContactElement { ends: [e.centre() + e.normal * lift; 2], radius: 60.0, ..e }
    };
    (0..30).map(plane).collect()
}

#[test]
fn robust_fits_keep_the_good_planes_of_a_cone() {
    let left_out = |answer: &Answer| answer.skipped.iter().map(words::left_out).collect::<Vec<_>>();
    let all = fitted(planes(&[]), true);
    assert!(all.status() == Status::Certified && all.skipped.is_empty(), "{:?}", left_out(&all));
    for (k, lift) in [(12, 20.0), (5, 5.0), (20, 5.0)] {
        let but_one = fitted(planes(&[(k, lift)]), true);
        let told = left_out(&but_one);
        assert!(but_one.status() == Status::Certified && told.len() == 1, "{k}: {told:?}");
        assert!(told[0].contains(&format!("plane {k}:")), "{k}: {told:?}");
    }
    // The end of the row goes with an outlier there, and that is told.
    let shorter = fitted(planes(&[(29, 20.0)]), true);
    let note = shorter.notes.iter().find_map(|n| match n {
        Note::Fit(FitNote::Shortened { count, by, of }) => Some((*count, *by, *of)),
        _ => None,
    });
    let (count, by, of) = note.expect("a note");
    assert!(count == 1 && by > 5.0 && by < 30.0 && of > 150.0, "{note:?}");
}

#[test]
fn tangent_planes_given_with_rulings_are_judged() {
    let cone = |turned: &dyn Fn(usize) -> f64| (0..40).map(|k| element(k as f64 / 39.0, turned(k))).collect();
    let right = fitted(cone(&|_| 0.0), false);
    let angle = right.claim(What::ElementAngle).expect("a figure");
    assert!(right.status() == Status::Certified && angle.value() < 1.0, "{angle:?}");
    let turned = fitted(cone(&|_| 0.17), false);
    let angle = turned.claim(What::ElementAngle).expect("a figure");
    assert!(turned.status() == Status::Uncertified && angle.value() > 5.0, "{angle:?}");
    let one = fitted(cone(&|k| if k == 15 { 1.5 } else { 0.0 }), false);
    let told = words::reason(&one.claims, &[]);
    assert!(one.status() == Status::Uncertified && told.contains("tangent plane given with ruling 15"), "{told}");
    // Rails of strips are simple: how far these go on beyond the rulings is told.
    let reach = right.claim(What::BeyondRulings).expect("a figure").value();
    assert!((0.0..100.0).contains(&reach), "{reach}");
    // Planes that are found from rulings are no data.
    let rulings = Given::Rulings((0..40).map(|k| element(k as f64 / 39.0, 0.0).ends).collect());
    let found = fit_elements(&rulings, &ElementFitOptions::new(0.2, "cone"), &Control::default()).expect("an answer");
    assert!(found.status() == Status::Certified && found.claim(What::ElementAngle).is_none());
}
