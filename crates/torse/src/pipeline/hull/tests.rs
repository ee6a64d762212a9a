//! Hulls of curves that are known.

use super::*;
use crate::answer::marks::Marks;
use crate::brep::space_curve::SpaceCurve;
use crate::certify::claim::What;
use crate::certify::claim::{Evidence, Status};
use crate::design::hull::hull as rulings_of_hull;
use crate::design::hull::strips::strips;
use crate::design::loft::build::BuildOptions;
use crate::geom::{Frame, Vec3};
use crate::io::curves::CurveOptions;
use crate::io::words;
use crate::reason::JobReason;
use crate::search::strips::hull_whole::apart;
use crate::torse::strip::Strip;
use std::f64::consts::TAU;

fn ellipse(name: &str, origin: Vec3, a: f64, b: f64) -> Rail {
    let frame = Frame { origin, ..Frame::world() };
    let (c, _) = SpaceCurve::Ellipse { frame, a, b }.to_spline(0.0, TAU).expect("spline");
    Rail::new(name, &[c]).expect("rail")
}

#[test]
fn circle_and_ellipse_are_joined_and_certified() {
    let curves = [ellipse("low", Vec3::zeros(), 300.0, 300.0), ellipse("high", Vec3::z() * 400.0, 500.0, 200.0)];
    let answer = hull(&curves, &Options::new(0.1), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
    assert_eq!(answer.notes.iter().filter(|n| matches!(n, Note::Lid { .. })).count(), 2);
    assert!(!answer.patterns.is_empty());
}

/// Frames of a straight skin: those in the middle lie on the cone of the others and take no part.
#[test]
fn frames_on_a_cone_leave_one_cone() {
    let frames = [(0.0, 100.0), (200.0, 140.0), (500.0, 200.0)];
    let curves = frames.map(|(z, r)| ellipse(&format!("at {z}"), Vec3::z() * z, r, r));
    let answer = hull(&curves, &Options::new(0.1), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
    let area: f64 = answer.patterns.iter().map(|p| p.area).sum();
    let exact = std::f64::consts::PI * 300.0 * 500f64.hypot(100.0);
    assert!((area - exact).abs() < 1e-4 * exact, "{area} {exact}");
    assert!(answer.notes.iter().any(|n| matches!(n, Note::Inside { curve } if curve == "at 200")));
    assert_eq!(answer.guides.len(), 3);
}

/// Eaves and a ridge: a hip roof, whose ridge is passed on both sides. A piece that is missing is seen.
#[test]
fn a_hip_roof_is_whole() {
    let line = |points: &[[f64; 3]]| {
        Rail::polyline("line", &points.iter().map(|p| Vec3::from(*p)).collect::<Vec<_>>()).expect("a line")
    };
    let eaves = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [100.0, 60.0, 0.0], [0.0, 60.0, 0.0], [0.0, 0.0, 0.0]];
    let curves = [line(&eaves), line(&[[30.0, 30.0, 40.0], [70.0, 30.0, 40.0]])];
    let answer = hull(&curves, &Options::new(0.05), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
    let area: f64 = answer.patterns.iter().map(|p| p.area).sum();
    assert!((area - 10_000.0).abs() < 1e-6, "{area}");
    let control = Control::default();
    let found = rulings_of_hull(&curves, 64, &control).expect("a hull");
    let mut made = strips(&curves, &found, 1e-3, &BuildOptions::new(1e-3), &control).expect("strips");
    assert_eq!(apart(&found, &made, 0.05), None);
    made[0].strips.pop();
    let (by, _) = apart(&found, &made, 0.05).expect("a gap");
    assert!(by > 5.0, "{by}");
}

#[test]
fn three_circles_leave_two_planar_triangles() {
    let curves = [0.0, 1.0, 2.0].map(|k: f64| {
        let a = k * TAU / 3.0;
        // Circles about the middle of a triangle's corners, standing upright, turned towards it.
        let frame = Frame {
            origin: Vec3::new(a.cos(), a.sin(), 0.0) * 300.0,
            x: Vec3::new(-a.sin(), a.cos(), 0.0),
            y: Vec3::z(),
            z: Vec3::new(a.cos(), a.sin(), 0.0),
        };
        let (c, _) = SpaceCurve::Ellipse { frame, a: 100.0, b: 100.0 }.to_spline(0.0, TAU).expect("spline");
        Rail::new(&format!("circle {k}"), &[c]).expect("rail")
    });
    let answer = hull(&curves, &Options::new(0.1), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified, "{:?} {:?}", answer.claims, answer.notes);
    let upright = |s: &&Strip| {
        let p = s.patch.control.iter().map(|c| c[2] / c[3]).collect::<Vec<_>>();
        p.iter().all(|z| (z.abs() - 100.0).abs() < 1e-9)
    };
    // Planes z = ±100 touch all three circles at their tops and bottoms.
    assert_eq!(answer.strips().filter(upright).count(), 2);
}

#[test]
fn proven_numbers_are_known_and_not_below_measured_ones() {
    let wave = |t: f64| Vec3::new(300.0 * t.cos(), 200.0 * t.sin(), 60.0 * (2.0 * t).cos());
    let cap = |t: f64| Vec3::new(150.0 * t.cos(), 150.0 * t.sin(), 400.0 + 20.0 * (3.0 * t).cos());
    let row = |f: &dyn Fn(f64) -> Vec3| {
        let points: Vec<Vec3> = (0..=60).map(|k| f(TAU * f64::from(k % 60) / 60.0)).collect();
        Rail::through("curve", &points).expect("rail")
    };
    let options = Options { samples: 48, ..Options::new(0.5) };
    let answer = hull(&[row(&wave), row(&cap)], &options, &Control::default()).expect("an answer");
    assert!(answer.claims.iter().all(|c| !c.is_unknown()), "{:?}", answer.claims);
    let twist = |c: &&Claim| c.what() == What::Twist;
    for bound in answer.claims.iter().filter(twist).filter(|c| c.evidence() == Evidence::Proven) {
        let measured = |c: &&Claim| c.evidence() == Evidence::Measured && c.subject() == bound.subject();
        for c in answer.claims.iter().filter(twist).filter(measured) {
            assert!(c.value() <= bound.value(), "{c:?} {bound:?}");
        }
    }
    // What is written has bounds; the rest is named.
    assert!(answer.strips().all(|s| answer.skipped.iter().all(|n| !words::why(&n.reason).contains(&s.name))));
}

#[test]
fn curves_through_many_points_have_as_few_spans_as_their_shape_needs() {
    let at = |t: f64, a: f64, b: f64, z: f64| Vec3::new(a * t.cos(), b * t.sin(), z);
    let row = |n: u32, a: f64, b: f64, z: f64| {
        let points: Vec<Vec3> = (0..=n).map(|k| at(TAU * f64::from(k % n) / f64::from(n), a, b, z)).collect();
        Rail::through("curve", &points).expect("rail")
    };
    let curves = [row(700, 300.0, 300.0, 0.0), row(500, 500.0, 200.0, 400.0)];
    let options = Options { samples: 64, ..Options::new(0.1) };
    let answer = hull(&curves, &options, &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified, "{:?} {:?}", answer.claims, answer.skipped);
    let spans: usize = answer.strips().map(|s| s.patch.knots_u.breaks().len() - 1).sum();
    assert!(spans < 600, "{spans}");
    // Fitted to the curves, not laid between them.
    assert!(answer.claims.iter().any(|c| c.what() == What::Count(Counted::ExactStrips) && c.value() == 0.0));
}

/// A closed table of `n` points that begins `start` (radians) along the curve, rounded to so many decimals.
fn table(n: u32, start: f64, decimals: Option<i32>, at: &dyn Fn(f64) -> Vec3) -> Rail {
    let point = |k: u32| {
        let p = at(start + TAU * f64::from(k % n) / f64::from(n));
        decimals.map_or(p, |d| p.map(|x| (x * 10f64.powi(d)).round() / 10f64.powi(d)))
    };
    Rail::through("loop", &(0..=n).map(point).collect::<Vec<_>>()).expect("rail")
}

#[test]
fn smooth_loops_through_points_are_certified_with_their_tips() {
    let waves = |t: f64| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 35.0 * (3.0 * t).cos());
    let saddle = |t: f64| Vec3::new(100.0 * t.cos(), 100.0 * t.sin(), 50.0 * (2.0 * t).cos());
    let cases = [(0.0, None), (0.113, None), (0.608, None), (1.0, Some(6))];
    for (start, decimals) in cases {
        for rail in [table(200, start, decimals, &waves), table(200, start, decimals, &saddle)] {
            let tolerance = 0.3;
            let answer = hull(&[rail], &Options::new(tolerance), &Control::default()).expect("an answer");
            assert_eq!(answer.status(), Status::Certified, "{start} {decimals:?} {:?}", answer.claims);
            // What is cut off at tips counts.
            let within = answer.notes.iter().find_map(|n| match n {
                Note::Tips { within, .. } => Some(*within),
                _ => None,
            });
            let off = answer.claims.iter().find(|c| c.what() == What::FromCurves).expect("a distance").value();
            assert!(within.is_some_and(|w| w > 0.0 && w <= off) && off <= tolerance, "{within:?} {off}");
        }
    }
}

/// Splines through few points have tips at knots, where the torsion jumps.
#[test]
fn loops_through_few_points_are_certified() {
    for (n, saddle, wave) in [(18, 0.1, 0.1), (24, 0.2, 0.1)] {
        let height = |t: f64| 350.0 * (saddle * (2.0 * t).cos() + wave * (3.0 * t).sin());
        let rail = table(n, 0.3, Some(3), &|t| Vec3::new(350.0 * t.cos(), 250.0 * t.sin(), height(t)));
        let answer = hull(&[rail], &Options::new(0.05), &Control::default()).expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{n} {:?}", answer.claims);
    }
}

/// Some of its corners are none: straight pieces and parabolas through three points.
#[test]
fn a_loop_of_straight_and_round_pieces_is_certified() {
    let heights = [49.0, -50.0, -55.0, 75.0, 26.0, -58.0, -20.0, 33.0];
    let point = |k: usize| {
        let t = TAU * (k % 8) as f64 / 8.0;
        Vec3::new(610.0 * t.cos(), 392.0 * t.sin(), heights[k % 8])
    };
    let rail = Rail::through("loop", &(0..=8).map(point).collect::<Vec<_>>()).expect("rail");
    assert!((2..8).contains(&rail.pieces.len()), "{}", rail.pieces.len());
    let answer = hull(&[rail], &Options::new(0.1), &Control::default()).expect("an answer");
    assert_eq!(answer.status(), Status::Certified, "{:?}", answer.claims);
}

/// Two edges of a hull 10 m long, tables of 25 points.
fn chines() -> [Rail; 2] {
    let curve = |name: &str, table: &[u8]| {
        let options = CurveOptions { unit: Some(1.0), ..CurveOptions::new(name) };
        crate::io::curves::read(table, &options).expect("a curve").0
    };
    let low = curve("low", include_bytes!("../../../../../data/chine_low.csv"));
    [low, curve("high", include_bytes!("../../../../../data/chine_high.csv"))]
}

/// Rulings between places of one curve are of any length, and where it is nearly plane they hang on little.
#[test]
fn long_curves_are_certified_at_every_tolerance() {
    for tolerance in [0.005, 0.5, 10.0] {
        let answer = hull(&chines(), &Options::new(tolerance), &Control::default()).expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{tolerance}: {:?}", answer.claims);
        assert!(answer.skipped.is_empty());
    }
}

#[test]
fn strips_beside_those_that_are_not_written_are_good_to_cut() {
    let curves = [ellipse("low", Vec3::zeros(), 300.0, 300.0), ellipse("high", Vec3::z() * 400.0, 500.0, 200.0)];
    let mut answer = hull(&curves, &Options::new(0.1), &Control::default()).expect("an answer");
    answer.claims.push(Claim::left_out(StripReason::NotWritten(1)));
    assert_eq!(answer.status(), Status::Uncertified);
    assert!(!answer.patterns.is_empty() && !Marks::of(&answer).any(), "{:?}", answer.claims);
}

#[test]
fn a_stopped_job_ends_at_once_and_says_so() {
    let curves = [ellipse("low", Vec3::zeros(), 300.0, 300.0), ellipse("high", Vec3::z() * 400.0, 500.0, 200.0)];
    let control = Control::default();
    control.cancel();
    let answer = hull(&curves, &Options::new(0.1), &control).expect("an answer");
    let told = |c: &Claim| c.what() == What::Objection && c.reason() == Some(&JobReason::Stopped.into());
    assert!(answer.patchwork.panels.is_empty() && answer.claims.iter().any(told), "{:?}", answer.claims);
}

#[test]
fn what_has_no_hull_is_refused() {
    let control = Control::default();
    assert_eq!(hull(&[], &Options::new(0.1), &control).err(), Some(HullError::NoCurves));
    let flat = [ellipse("a", Vec3::zeros(), 1.0, 1.0), ellipse("b", Vec3::x() * 5.0, 1.0, 1.0)];
    let e = hull(&flat, &Options::new(0.1), &control).expect_err("flat");
    assert!(e.to_string().contains("a, b"), "{e}");
    assert!(matches!(hull(&flat, &Options::new(f64::NAN), &control), Err(HullError::Tolerance(_))));
}
