//! Planes and rulings of cones: what robust fits leave out, and what is said of given tangent planes.

use super::*;
use crate::answer::note::FitNote;
use crate::certify::claim::What;
use crate::torse::contact::ContactElement;

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

/// Rulings of a cone of 2 rad whose ends are moved along them, mm.
fn rulings(count: usize, moved: impl Fn(usize) -> [f64; 2]) -> Given {
    let ruling = |k: usize| {
        let [p, q] = element(k as f64 / (count - 1) as f64, 0.0).ends;
        let [from, to] = moved(k);
        let along = (q - p).normalize();
        [p + along * from, q + along * to]
    };
    Given::Rulings((0..count).map(ruling).collect())
}

/// Area of what a cone's rulings from 100 to 300 mm cover, when laid flat, with their ends moved, mm².
fn area(count: usize, moved: impl Fn(usize) -> [f64; 2]) -> f64 {
    let turn = 2.0 * 0.5_f64.sin() / (count - 1) as f64;
    let sides = |k: usize| [100.0 + moved(k)[0], 300.0 + moved(k)[1]];
    let triangle = |a: f64, b: f64| 0.5 * a * b * turn.sin();
    (1..count).map(|k| triangle(sides(k - 1)[1], sides(k)[1]) - triangle(sides(k - 1)[0], sides(k)[0])).sum()
}

fn fit_rulings(given: &Given) -> Answer {
    fit_elements(given, &ElementFitOptions::new(0.2, "cone"), &Control::default()).expect("an answer")
}

#[test]
fn strips_and_patterns_end_where_rulings_end() {
    let value = |answer: &Answer, what| answer.claim(what).expect("a figure").value();
    // Ends on a curve that no rail of low degree follows, and ends that jump to and fro.
    let wavy = |k: usize| [20.0 * (0.3 * k as f64).sin(), 30.0 * (0.25 * k as f64).cos()];
    let ragged = |k: usize| [[-7.0, 9.0], [6.0, -8.0], [3.0, 4.0]][k % 3];
    for (given, expected) in [(rulings(40, wavy), area(40, wavy)), (rulings(40, ragged), area(40, ragged))] {
        let answer = fit_rulings(&given);
        assert_eq!(answer.status(), Status::Certified, "{}", words::reason(&answer.claims, &[]));
        assert!(value(&answer, What::EndDistance) <= 0.21 && value(&answer, What::BeyondRulings) < 0.6);
        assert_eq!(answer.patchwork.panels[0].outline.len(), 1);
        let flat: f64 = answer.patterns.iter().map(|p| p.area).sum();
        assert!((flat / expected - 1.0).abs() < 0.003, "{flat} {expected}");
    }
    // Ends on circles: the strip ends there as it is.
    let plain = fit_rulings(&rulings(40, |_| [0.0; 2]));
    assert!(plain.status() == Status::Certified && value(&plain, What::BeyondRulings) < 0.6);
}

#[test]
fn two_groups_of_rulings_are_two_strips() {
    let Given::Rulings(all) = rulings(60, |_| [0.0; 2]) else { return };
    let two = Given::Rulings(all.iter().enumerate().filter(|(k, _)| *k < 15 || *k > 44).map(|k| *k.1).collect());
    let answer = fit_rulings(&two);
    assert_eq!((answer.status(), answer.patchwork.panels.len()), (Status::Certified, 2));
    let is_gap = |n: &Note| matches!(n, Note::Fit(FitNote::Gap { bulge_estimate: None, count: 1, .. }));
    assert!(answer.notes.iter().any(is_gap), "{:?}", answer.notes);
    assert!(!fit_rulings(&Given::Rulings(all)).notes.iter().any(|n| matches!(n, Note::Fit(FitNote::Gap { .. }))));
}

#[test]
fn strips_of_faces_end_at_their_border_and_at_holes() {
    use crate::search::strips::cone_strip::tests::slanting;
    let mut face = slanting();
    let hole = |k: i32| (f64::from(k) * -std::f64::consts::TAU / 64.0).sin_cos();
    let points: Vec<[f64; 2]> = (0..64).map(hole).map(|(s, c)| [0.6 + 0.06 * c, 0.525 + 0.04 * s]).collect();
    let edge = vec![9; points.len()];
    let whole = fit_faces(std::slice::from_ref(&face), &[], &ElementFitOptions::new(0.2, "f"), &Control::default());
    face.loops.push(crate::brep::face::TrimLoop { points, edge });
    let holed = fit_faces(&[face], &[], &ElementFitOptions::new(0.2, "f"), &Control::default());
    for (answer, loops) in [(whole, 1), (holed, 2)] {
        let answer = answer.expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{}", words::reason(&answer.claims, &[]));
        assert!(answer.claim(What::FaceDistance).is_some_and(|c| c.value() <= 0.2));
        assert_eq!(answer.patchwork.panels[0].outline.len(), loops);
    }
}

/// Rulings of a circular cone all around, the last one the first; their ends are 100 and 300 mm from its tip.
fn ring(count: usize) -> Vec<[Vec3; 2]> {
    let ray = |k: usize| {
        let ((s, c), (p, q)) =
            ((std::f64::consts::TAU * (k % count) as f64 / count as f64).sin_cos(), 0.3_f64.sin_cos());
        Vec3::new(p * c, p * s, q)
    };
    (0..=count).map(|k| [ray(k) * 100.0, ray(k) * 300.0]).collect()
}

#[test]
fn rings_are_covered_all_around() {
    let has = |a: &Answer, f: fn(&FitNote) -> bool| a.notes.iter().any(|n| matches!(n, Note::Fit(n) if f(n)));
    let flat = |a: &Answer| a.patterns.iter().map(|p| p.area).sum::<f64>();
    let one = std::f64::consts::PI * 0.3_f64.sin() * (300.0 * 300.0 - 100.0 * 100.0) / 48.0;
    let closed = fit_rulings(&Given::Rulings(ring(48)));
    assert_eq!(closed.status(), Status::Certified, "{}", words::reason(&closed.claims, &[]));
    assert!((flat(&closed) / (48.0 * one) - 1.0).abs() < 0.004, "{} {}", flat(&closed), 48.0 * one);
    assert!(!has(&closed, |n| matches!(n, FitNote::NoStrip { .. } | FitNote::OpenRing { .. })), "{:?}", closed.notes);
    let open = fit_rulings(&Given::Rulings(ring(48)[..48].to_vec()));
    assert_eq!(open.status(), Status::Certified, "{}", words::reason(&open.claims, &[]));
    assert!((flat(&open) / (47.0 * one) - 1.0).abs() < 0.004, "{} {}", flat(&open), 47.0 * one);
    assert!(has(&open, |n| matches!(n, FitNote::OpenRing { .. })), "{:?}", open.notes);
    // It is open where the rulings are.
    assert!(!has(&open, |n| matches!(n, FitNote::NoStrip { .. })), "{:?}", open.notes);
}

#[test]
fn stretches_without_a_strip_are_told() {
    use crate::search::strips::scan_outline::Ended;
    let Given::Rulings(all) = rulings(40, |_| [0.0; 2]) else { return };
    let half = fit_rulings(&Given::Rulings(all[..25].to_vec()));
    let ended = Ended::whole(half.strips().cloned().collect());
    let told = ends::Ends::of(&all).notes(&ended, true, &Control::default());
    let count = told.iter().find_map(|n| match n {
        Note::Fit(FitNote::NoStrip { count, off, .. }) if *off > 50.0 => Some(*count),
        _ => None,
    });
    assert_eq!(count, Some(15), "{told:?}");
    let whole = ends::Ends::of(&all[..25]).notes(&ended, true, &Control::default());
    assert!(whole.is_empty(), "{whole:?}");
}

#[test]
fn strips_of_planes_reach_the_places_given_with_these() {
    let plane = |k: usize| {
        let (s, c) = (std::f64::consts::TAU * k as f64 / 72.0).sin_cos();
        let normal = Vec3::new(c, s, 0.0);
        ContactElement { normal, ends: [normal * 400.0; 2], radius: 120.0, weight: 1.0 }
    };
    let options = ElementFitOptions::new(0.5, "ring");
    let given = Given::Planes((0..73).map(plane).collect());
    let answer = fit_elements(&given, &options, &Control::default()).expect("an answer");
    let off = answer.claim(What::CentreDistance).expect("a figure").value();
    assert!(answer.status() == Status::Certified && off <= 0.5, "{off} {}", words::reason(&answer.claims, &[]));
}
