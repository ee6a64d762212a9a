//! Planes, rulings and points: F1, F2, F3, corrections, knots, frames.

use super::Random;
use torse::fit::planes::correction::{corrected, joint, JointOptions};
use torse::fit::planes::estimates::{planes_of_rulings, ruling_direction, Ends, EstimateError};
use torse::fit::planes::frame::{frame_of_normals, segments, FrameError, STEEPEST};
use torse::fit::planes::knot_choice::{planes_within, KnotOptions};
use torse::fit::planes::linear_system::{
    interpolated, planes, ruling_condition, PlaneDatum, PlanesError, PlanesOptions,
};
use torse::fit::planes::reduce::{reduced, reduced_robustly};
use torse::fit::planes::rulings::{slope_fit, PointDatum, RulingDatum, SlopeData, SlopeOptions};
use torse::fit::planes::Freedom;
use torse::geom::measure::{LineMeasure, Measure};
use torse::geom::Vec3;
use torse::spline::knots::Knots;
use torse::torse::dual::{graph_in, plane_through, DualCurve, Plane};

fn square() -> Measure {
    Measure::rectangle([-1.0, 1.0], [-1.0, 1.0]).expect("area")
}

fn smooth(t: f64) -> [f64; 3] {
    [0.3 * (2.0 * t).sin(), 0.4 * (3.0 * t).cos(), 1.5 * t - 0.4 * t * t]
}

fn data(count: usize, parameter: impl Fn(f64) -> f64) -> Vec<PlaneDatum> {
    (0..count)
        .map(|i| {
            let s = i as f64 / (count - 1) as f64;
            PlaneDatum { plane: smooth(s), parameter: parameter(s), measure: square(), weight: 1.0 }
        })
        .collect()
}

#[test]
fn planes_of_a_spline_are_reproduced_with_any_metric() {
    let knots = Knots::uniform(3, 4, 0.0, 1.0).expect("knots");
    let control: Vec<[f64; 3]> = (0..7).map(|i| smooth(f64::from(i) / 6.0)).collect();
    let truth = DualCurve::graph(3, knots.values().to_vec(), &control).expect("a curve");
    for measure in [square(), Measure::disc([3.0, 1.0], 0.5).expect("disc")] {
        let given: Vec<PlaneDatum> = (0..25)
            .map(|i| {
                let t = f64::from(i) / 24.0;
                let u = truth.graphs().point(t);
                PlaneDatum { plane: [u[0], u[1], u[2]], parameter: t, measure, weight: 1.0 }
            })
            .collect();
        let fit = planes(&given, &knots, &PlanesOptions::default()).expect("a fit");
        assert!(fit.cost < 1e-24);
        for (a, b) in fit.curve.graphs().control.iter().zip(&truth.graphs().control) {
            assert!((0..3).all(|d| (a[d] - b[d]).abs() < 1e-9));
        }
    }
}

#[test]
fn end_rulings_can_be_fixed() {
    let knots = Knots::uniform(3, 4, 0.0, 1.0).expect("knots");
    let end = smooth(0.0);
    let ground_plan = [0.2, -0.3, 1.0];
    let conditions = vec![(0, Freedom::Fixed(end)), (1, ruling_condition(end, ground_plan))];
    let fit =
        planes(&data(30, |s| s), &knots, &PlanesOptions { conditions, ..PlanesOptions::default() }).expect("a fit");
    let r = fit.curve.ruling(0.0).expect("a ruling");
    for p in [r.point, r.point + r.direction] {
        assert!((ground_plan[0] + ground_plan[1] * p.x + ground_plan[2] * p.y).abs() < 1e-12);
        assert!((p.z - end[0] - end[1] * p.x - end[2] * p.y).abs() < 1e-12);
    }
}

#[test]
fn joint_iteration_is_fifty_times_better_than_two_hundred_corrections() {
    // The planes of a spline with parameters that have slipped.
    let knots = Knots::uniform(3, 2, 0.0, 1.0).expect("knots");
    let control: Vec<[f64; 3]> = (0..5).map(|i| smooth(f64::from(i) / 4.0)).collect();
    let truth = DualCurve::graph(3, knots.values().to_vec(), &control).expect("a curve");
    let given: Vec<PlaneDatum> = (0..41)
        .map(|i| {
            let s = f64::from(i) / 40.0;
            let u = truth.graphs().point(s);
            PlaneDatum { plane: [u[0], u[1], u[2]], parameter: s.powf(1.3), measure: square(), weight: 1.0 }
        })
        .collect();
    let slow = corrected(&given, &knots, &PlanesOptions::default(), 200).expect("corrections");
    assert!(slow.history.windows(2).all(|w| w[1] <= w[0]));
    let fast = joint(&given, &knots, &PlanesOptions::default(), &JointOptions::default()).expect("a joint fit");
    let error = |cost: f64| cost.sqrt();
    assert!(
        50.0 * error(fast.fit.cost) < error(slow.fit.cost),
        "{:e} against {:e}",
        error(fast.fit.cost),
        error(slow.fit.cost)
    );
    assert!(fast.parameters.windows(2).all(|w| w[0] < w[1]));
    assert_eq!((fast.parameters[0], fast.parameters[40]), (0.0, 1.0));
}

#[test]
fn outliers_lose_their_weight() {
    let knots = Knots::uniform(3, 4, 0.0, 1.0).expect("knots");
    let mut random = Random::new(3);
    let mut given = data(60, |s| s);
    for d in &mut given {
        d.plane[0] += 1e-4 * random.number();
    }
    given[20].plane[0] += 1.0;
    given[41].plane[1] -= 2.0;
    let fit = planes(&given, &knots, &PlanesOptions { robust: true, ..PlanesOptions::default() }).expect("a fit");
    assert!(fit.trust[20] == 0.0 && fit.trust[41] == 0.0);
    let worst = (0..60).filter(|i| ![20, 41].contains(i)).map(|i| fit.distances[i]).fold(0.0, f64::max);
    assert!(worst < 2e-3, "{worst}");
}

#[test]
fn knots_are_as_few_as_the_tolerance_allows() {
    let given = data(200, |s| s);
    let coarse = planes_within(&given, &KnotOptions::new(1e-2)).expect("a fit");
    let fine = planes_within(&given, &KnotOptions::new(1e-5)).expect("a fit");
    let spans = |f: &torse::fit::planes::linear_system::PlanesFit| f.curve.knots().breaks().len() - 1;
    assert!(coarse.distances.iter().all(|d| *d <= 1e-2) && fine.distances.iter().all(|d| *d <= 1e-5));
    assert!(spans(&coarse) < spans(&fine) && spans(&fine) < 40, "{} {}", spans(&coarse), spans(&fine));
}

#[test]
fn degree_reduction_does_not_depend_on_a_constant_metric() {
    let control: Vec<[f64; 3]> = (0..8).map(|i| smooth(f64::from(i) / 7.0)).collect();
    let knots = Knots::uniform(5, 3, 0.0, 1.0).expect("knots");
    let source = DualCurve::graph(5, knots.values().to_vec(), &control).expect("a curve");
    let target = Knots::uniform(3, 4, 0.0, 1.0).expect("knots");
    let disc = Measure::disc([2.0, -1.0], 0.3).expect("disc");
    let a = reduced(&source, &target, &|_| square(), true).expect("a fit");
    let b = reduced(&source, &target, &|_| disc, true).expect("a fit");
    for (p, q) in a.curve.graphs().control.iter().zip(&b.curve.graphs().control) {
        assert!((0..3).all(|d| (p[d] - q[d]).abs() < 1e-9));
    }
    let (from, to) = (source.graph_jet(0.0)[0], a.curve.graph_jet(0.0)[0]);
    assert!((0..3).all(|d| (from[d] - to[d]).abs() < 1e-14));
    assert!(a.cost > 0.0 && a.worst_estimate >= a.cost.sqrt() * 0.5);
}

#[test]
fn interpolation_meets_all_planes() {
    let t: Vec<f64> = (0..15).map(|i| (f64::from(i) / 14.0).powf(1.2)).collect();
    let given: Vec<[f64; 3]> = t.iter().map(|&t| smooth(t)).collect();
    let curve = interpolated(&given, &t, 3).expect("a curve");
    for (t, p) in t.iter().zip(&given) {
        let u = curve.graphs().point(*t);
        assert!((0..3).all(|d| (u[d] - p[d]).abs() < 1e-11));
    }
    assert!(matches!(interpolated(&given, &[0.0; 15], 3), Err(PlanesError::Order { index: 1, .. })));
    assert!(interpolated(&given[..3], &t[..3], 3).is_err());
}

#[test]
fn rulings_and_points_pull_the_surface() {
    // u0 and u1 of a spline: its own planes, one ruling and one point are met exactly.
    let knots = Knots::uniform(3, 3, 0.0, 1.0).expect("knots");
    let control: Vec<[f64; 2]> = (0..6).map(|i| [(f64::from(i) * 0.8).sin(), (f64::from(i) * 0.5).cos()]).collect();
    let truth = DualCurve::slope(3, knots.values().to_vec(), &control).expect("a curve");
    let mut given = SlopeData::default();
    for i in 0..12 {
        let t = f64::from(i) / 11.0;
        let u = truth.graphs().point(t);
        given.planes.push(PlaneDatum { plane: [u[0], u[1], t], parameter: t, measure: square(), weight: 1.0 });
    }
    let d = truth.graph_jet(0.4)[1];
    let along = LineMeasure::interval(-1.0, 1.0).expect("an interval");
    given.rulings.push(RulingDatum { parameter: 0.4, ground_plan: [d[0], d[1]], along, weight: 2.0 });
    let e = truth.graph_jet(0.7)[1];
    given.points.push(PointDatum { parameter: 0.7, ground_plan: [0.5, -(e[0] + 0.5 * e[1])], weight: 1.0 });
    let exact = slope_fit(&given, &knots, &SlopeOptions::default()).expect("a fit");
    assert!(exact.cost < 1e-22);
    // Another ruling pulls: the fit comes nearer to it than the planes alone leave it.
    given.rulings[0].ground_plan[0] += 0.3;
    let pulled = slope_fit(&given, &knots, &SlopeOptions::default()).expect("a fit");
    let off = |c: &DualCurve| (c.graph_jet(0.4)[1][0] - given.rulings[0].ground_plan[0]).abs();
    assert!(off(&pulled.curve) < 0.9 * off(&exact.curve));
    given.planes[3].parameter += 0.01;
    assert!(matches!(slope_fit(&given, &knots, &SlopeOptions::default()), Err(PlanesError::Parameter { .. })));
}

#[test]
fn bad_planes_are_named() {
    let knots = Knots::uniform(3, 8, 0.0, 1.0).expect("knots");
    let options = PlanesOptions::default();
    let good = data(30, |s| s);
    let with = |change: &dyn Fn(&mut Vec<PlaneDatum>)| {
        let mut d = good.clone();
        change(&mut d);
        planes(&d, &knots, &options)
    };
    assert!(matches!(with(&|d| d[7].plane[1] = f64::NAN), Err(PlanesError::Datum { index: 7, .. })));
    assert!(matches!(with(&|d| d[2].weight = -1.0), Err(PlanesError::Datum { index: 2, .. })));
    assert!(matches!(with(&|d| d[9].parameter = 1.5), Err(PlanesError::Parameter { index: 9, .. })));
    let line = Measure::masses(&[[0.0, 0.0], [1.0, 1.0]], &[1.0, 1.0]).expect("masses");
    assert!(matches!(with(&|d| d[4].measure = line), Err(PlanesError::Measure { index: 4, .. })));
    // Schoenberg–Whitney: too few planes, none in a whole support, or all at one parameter.
    assert!(matches!(with(&|d| d.truncate(5)), Err(PlanesError::Undetermined { .. })));
    assert!(matches!(with(&|d| d.retain(|p| p.parameter < 0.3)), Err(PlanesError::Undetermined { .. })));
    assert!(matches!(with(&|d| d.iter_mut().for_each(|p| p.parameter = 0.5)), Err(PlanesError::Undetermined { .. })));
    assert!(planes(&[], &knots, &options).is_err());
    // Smoothing makes any of these solvable.
    let soft = PlanesOptions { smoothing: 1e-9, ..PlanesOptions::default() };
    assert!(planes(&good[..8], &knots, &soft).is_ok());
    let nowhere = PlanesOptions { conditions: vec![(99, Freedom::Fixed([0.0; 3]))], ..PlanesOptions::default() };
    assert!(matches!(planes(&good, &knots, &nowhere), Err(PlanesError::Condition { control: 99, .. })));
}

/// Tangent planes of a cone about z, from angle `a` to `b`.
fn cone_planes(a: f64, b: f64, count: usize) -> Vec<Plane> {
    (0..count)
        .map(|i| {
            let phi = a + (b - a) * i as f64 / (count - 1) as f64;
            let n = Vec3::new(phi.cos(), phi.sin(), 0.3).normalize();
            plane_through(&Vec3::new(1.0, 2.0, 3.0), &n)
        })
        .collect()
}

#[test]
fn rows_of_planes_are_split_where_axes_end() {
    let half = segments(&cone_planes(0.0, 2.0, 40), true).expect("segments");
    assert_eq!(half.len(), 1);
    assert!(half[0].by_slope);
    let full = segments(&cone_planes(0.0, 6.2, 120), true).expect("segments");
    assert!(full.len() >= 2 && full.len() <= 4, "{}", full.len());
    assert_eq!(full[0].range.start, 0);
    assert_eq!(full[full.len() - 1].range.end, 120);
    assert!(full.windows(2).all(|w| w[1].range.start + 1 == w[0].range.end));
    for s in &full {
        let planes = &cone_planes(0.0, 6.2, 120)[s.range.clone()];
        let graphs: Vec<[f64; 3]> =
            planes.iter().enumerate().map(|(i, p)| graph_in(&s.frame, p, i).expect("a graph")).collect();
        assert!(graphs.windows(2).all(|w| w[1][2] > w[0][2]), "slopes increase");
    }
    // A turn back is an inflection: type (3) ends there.
    let mut there_and_back = cone_planes(0.0, 1.0, 20);
    there_and_back.extend(cone_planes(0.95, 0.0, 20));
    assert_eq!(segments(&there_and_back, true).expect("segments").len(), 2);
    assert_eq!(segments(&there_and_back, false).expect("segments").len(), 1);
}

#[test]
fn axes_of_wide_fans_are_those_of_the_cap() {
    // Most normals at one end: the main direction leaves the other end too steep, the cap's axis does not.
    let mut normals = vec![Vec3::new(0.0, 0.0, 1.0); 200];
    normals.extend((0..=20).map(|i| {
        let a = 2.2 * f64::from(i) / 20.0;
        Vec3::new(0.0, a.sin(), a.cos())
    }));
    let f = frame_of_normals(&normals).expect("axes");
    assert!(f.min_cosine > STEEPEST && (f.min_cosine - 1.1_f64.cos()).abs() < 1e-6);
    let all_round: Vec<Vec3> = (0..12).map(|i| Vec3::new(f64::from(i).cos(), f64::from(i).sin(), 0.0)).collect();
    assert!(matches!(frame_of_normals(&all_round), Err(FrameError::TooFar { .. })));
    assert!(matches!(frame_of_normals(&[]), Err(FrameError::Normal { .. })));
    assert!(matches!(frame_of_normals(&[Vec3::z(), Vec3::zeros()]), Err(FrameError::Normal { index: 1, .. })));
}

#[test]
fn planes_of_rulings_are_of_second_order() {
    // Rulings of a cone.
    let worst = |n: usize, ends: Ends, range: std::ops::Range<usize>| {
        let at = |i: usize| 1.2 * (i as f64 / (n - 1) as f64) + 0.2 * (i as f64 / (n - 1) as f64).powi(2);
        let d = |a: f64| Vec3::new(a.cos(), a.sin(), 0.5);
        let from: Vec<Vec3> = (0..n).map(|i| d(at(i))).collect();
        let to: Vec<Vec3> = (0..n).map(|i| d(at(i)) * 3.0).collect();
        let got = planes_of_rulings(&from, &to, ends).expect("planes");
        range
            .map(|i| {
                let e = d(at(i));
                let truth = e.cross(&Vec3::new(-at(i).sin(), at(i).cos(), 0.0)).normalize();
                got[i].cross(&truth).norm().asin()
            })
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(11, Ends::OneSided, 1..10), worst(21, Ends::OneSided, 1..20));
    assert!(fine < 0.3 * coarse, "{coarse} {fine}");
    assert!(worst(21, Ends::Extrapolated, 0..21) < 0.2 * worst(21, Ends::OneSided, 0..21));
    let x = [Vec3::zeros(), Vec3::x()];
    assert!(matches!(planes_of_rulings(&x[..1], &x[..1], Ends::OneSided), Err(EstimateError::Count(_))));
    assert!(matches!(planes_of_rulings(&x, &x, Ends::OneSided), Err(EstimateError::Ruling { index: 0 })));
    let same = [Vec3::zeros(), Vec3::zeros()];
    let ends = [Vec3::x(), Vec3::x()];
    assert!(matches!(planes_of_rulings(&same, &ends, Ends::OneSided), Err(EstimateError::Vague { .. })));
    let r = ruling_direction([[1.0, 1.0], [1.0, 1.0]]).expect("a direction");
    assert!((r[0] + r[1]).abs() < 1e-12);
    assert!(ruling_direction([[0.0, 0.0], [0.0, 0.0]]).is_none());
}

#[test]
fn robust_weights_reject_rulings_points_and_dents() {
    let knots = Knots::uniform(3, 4, 0.0, 1.0).expect("knots");
    let along = LineMeasure::interval(-1.0, 1.0).expect("an interval");
    // The paraboloid-like surface u0 = t³, u1 = t² with rulings h0 = 3 t², h1 = 2 t; every ninth ruling is wrong.
    let plane = |t: f64| PlaneDatum { plane: [t * t * t, t * t, t], parameter: t, measure: square(), weight: 1.0 };
    let rulings = (0..40)
        .map(|i| {
            let t = f64::from(i) / 39.0;
            let wrong = if i % 9 == 4 { 0.7 } else { 1e-4 * f64::from(i % 5) };
            RulingDatum { parameter: t, ground_plan: [3.0 * t * t + wrong, 2.0 * t], along, weight: 1.0 }
        })
        .collect();
    let data = SlopeData { planes: vec![plane(0.0), plane(1.0)], rulings, points: Vec::new() };
    let off = |robust: bool| {
        let options = SlopeOptions { robust, ..SlopeOptions::default() };
        let f = slope_fit(&data, &knots, &options).expect("a fit");
        (0..=20)
            .map(|i| f64::from(i) / 20.0)
            .map(|t| (f.curve.graph_jet(t)[1][0] - 3.0 * t * t).abs())
            .fold(0.0, f64::max)
    };
    assert!(off(true) < 2e-3 && off(false) > 0.05, "{} {}", off(true), off(false));
    // A source with a dent, reduced to few knots.
    let fine = Knots::uniform(3, 40, 0.0, 1.0).expect("knots");
    let control: Vec<[f64; 3]> = (0..43)
        .map(|i| {
            let dent = if i == 20 { 0.5 } else { 0.0 };
            let t = f64::from(i) / 42.0;
            [t * t + dent, t, 1.0 - t]
        })
        .collect();
    let source = DualCurve::graph(3, fine.values().to_vec(), &control).expect("planes");
    let smooth = |c: &DualCurve| (c.graphs().point(0.5)[0] - 0.25).abs();
    let measure = |_: f64| square();
    let plain = reduced(&source, &knots, &measure, false).expect("a reduction");
    let robust = reduced_robustly(&source, &knots, &measure, false).expect("a reduction");
    assert!(smooth(&robust.curve) < 0.2 * smooth(&plain.curve), "{} {}", smooth(&robust.curve), smooth(&plain.curve));
}
