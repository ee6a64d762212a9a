//! Control of the regression curve, and the walk of the paper that is not used.

use super::Random;
use torse::fit::planes::linear_system::PlaneDatum;
use torse::fit::planes::regression::{
    regression_free, regression_free_where, ForbiddenZone, RegressionError, RegressionOptions,
};
use torse::fit::planes::rulings::{SlopeData, SlopeOptions};
use torse::fit::planes::Freedom;
use torse::geom::measure::Measure;
use torse::num::quadratic_program::QuadraticProgram;
use torse::spline::knots::Knots;
use torse::torse::dual::DualCurve;

fn noisy(seed: u64, count: usize) -> SlopeData {
    let measure = Measure::rectangle([-1.0, 1.0], [-1.0, 1.0]).expect("area");
    let mut random = Random::new(seed);
    let planes = (0..count)
        .map(|i| {
            let t = i as f64 / (count - 1) as f64;
            let plane = [0.4 * t * t + 0.1 * random.number(), 0.2 * random.number(), t];
            PlaneDatum { plane, parameter: t, measure, weight: 1.0 }
        })
        .collect();
    SlopeData { planes, ..SlopeData::default() }
}

/// x of the regression points at many parameters; infinite where they are far.
fn regression_x(c: &DualCurve) -> Vec<f64> {
    let (a, b) = c.domain();
    (0..=400)
        .map(|i| {
            let p = c.regression_point(a + (b - a) * f64::from(i) / 400.0);
            p[0] / p[3]
        })
        .collect()
}

#[test]
fn lemma_5_regression_points_are_outside_the_slab_exactly_in_the_wedges() {
    // x = −u0''/u1'' outside [a, b] iff both u0'' + a u1'' and u0'' + b u1'' have the same strict sign.
    let mut random = Random::new(5);
    for _ in 0..500 {
        let (w0, w1) = (random.number(), random.number());
        let (a, b) = (-0.5, 0.3);
        let x = -w0 / w1;
        let same = (w0 + a * w1) * (w0 + b * w1) > 0.0;
        assert_eq!(!(a..=b).contains(&x), same);
        let (c, r) = ((a + b) / 2.0, (b - a) / 2.0);
        assert_eq!((w0 / w1 + c).abs() > r, same);
    }
}

#[test]
fn lemma_6_control_points_in_a_wedge_keep_the_regression_curve_out() {
    let knots = Knots::uniform(3, 5, 0.0, 1.0).expect("knots");
    for seed in 1..12 {
        let data = noisy(seed, 30);
        let zone = ForbiddenZone::Slab(-0.5, 0.5);
        let got = regression_free(&data, &knots, &zone, &RegressionOptions::default()).expect("a fit");
        assert!(regression_x(&got.fit.curve).iter().all(|x| x.abs() > 0.5 - 1e-6));
        assert!(got.fit.cost >= got.free_cost - 1e-12);
    }
}

#[test]
fn higher_degrees_are_tightened_by_refinement() {
    let knots = Knots::uniform(5, 3, 0.0, 1.0).expect("knots");
    let data = noisy(2, 40);
    let zone = ForbiddenZone::Slab(-0.4, 0.4);
    let mut last = f64::INFINITY;
    for refinements in [0, 1, 3] {
        let options = RegressionOptions { refinements, margin: Some(1e-3), ..RegressionOptions::default() };
        let got = regression_free(&data, &knots, &zone, &options).expect("a fit");
        assert!(regression_x(&got.fit.curve).iter().all(|x| x.abs() > 0.4 - 1e-6));
        assert!(got.fit.cost <= last * (1.0 + 1e-9));
        last = got.fit.cost;
    }
}

#[test]
fn an_outline_needs_less_than_its_slab() {
    let knots = Knots::uniform(3, 8, 0.0, 1.0).expect("knots");
    let data = noisy(4, 40);
    let extent = (0..=20).map(|i| {
        let t = f64::from(i) / 20.0;
        (t, -0.1 - 0.9 * t, 0.1 + 0.9 * t)
    });
    let outline = ForbiddenZone::Outline { extent: extent.collect(), clearance: 0.05 };
    let options = RegressionOptions { margin: Some(1e-3), ..RegressionOptions::default() };
    let narrow = regression_free(&data, &knots, &outline, &options).expect("a fit");
    let wide = regression_free(&data, &knots, &ForbiddenZone::Slab(-1.05, 1.05), &options).expect("a fit");
    assert!(narrow.fit.cost < wide.fit.cost);
    let x = regression_x(&narrow.fit.curve);
    assert!((0..=400).all(|i| x[i].abs() > 0.1 + 0.9 * i as f64 / 400.0));
}

#[test]
fn a_box_binds_only_the_rulings_that_meet_it() {
    let knots = Knots::uniform(3, 8, 0.0, 1.0).expect("knots");
    let data = noisy(4, 40);
    let options = RegressionOptions { margin: Some(1e-3), ..RegressionOptions::default() };
    let wide = regression_free(&data, &knots, &ForbiddenZone::Slab(-1.05, 1.05), &options).expect("a fit");
    // A box around the middle of the surface, and one that the surface never meets.
    let (min, max) = ([-1.05, -0.5, -10.0], [1.05, -0.2, 10.0]);
    let boxed = regression_free(&data, &knots, &ForbiddenZone::Box { min, max }, &options).expect("a fit");
    assert!(boxed.fit.cost <= wide.fit.cost * (1.0 + 1e-9));
    for i in 0..=400 {
        let t = f64::from(i) / 400.0;
        let [_, d, s] = boxed.fit.curve.graph_jet(t);
        let x = -s[0] / s[1];
        let y = -(d[0] + d[1] * x);
        assert!(!(x > min[0] + 1e-6 && x < max[0] - 1e-6 && y > min[1] + 1e-6 && y < max[1] - 1e-6), "{t}: {x} {y}");
    }
    let far = ForbiddenZone::Box { min: [-1.0, 900.0, -1.0], max: [1.0, 901.0, 1.0] };
    let got = regression_free(&data, &knots, &far, &options).expect("a fit");
    assert!((got.fit.cost - got.free_cost).abs() <= 1e-9 * got.free_cost);
}

#[test]
fn zones_that_depend_on_the_ruling_are_kept_free() {
    let knots = Knots::uniform(3, 8, 0.0, 1.0).expect("knots");
    let data = noisy(4, 40);
    let options = RegressionOptions { margin: Some(1e-3), ..RegressionOptions::default() };
    // The same interval for all rulings is a slab.
    let slab = regression_free(&data, &knots, &ForbiddenZone::Slab(-0.5, 0.5), &options).expect("a fit");
    let same = regression_free_where(&data, &knots, &|_, _| Some((-0.5, 0.5)), &options).expect("a fit");
    assert!((same.fit.cost - slab.fit.cost).abs() <= 1e-9 * slab.fit.cost);
    // A strip that moves with its rulings: the interval follows the heights of each fit.
    let moving = |c: &DualCurve, t: f64| Some((-0.4 + c.graph_jet(t)[0][0], 0.4 + c.graph_jet(t)[0][0]));
    let got = regression_free_where(&data, &knots, &moving, &options).expect("a fit");
    for i in 0..=400 {
        let t = f64::from(i) / 400.0;
        let (p, z) = (got.fit.curve.regression_point(t), got.fit.curve.graph_jet(t)[0][0]);
        assert!((p[0] / p[3] - z).abs() > 0.4 - 1e-6, "{t}");
    }
    let free = regression_free_where(&data, &knots, &|_, _| None, &options).expect("a fit");
    assert!((free.fit.cost - free.free_cost).abs() <= 1e-9 * free.free_cost);
}

#[test]
fn the_outline_of_a_panel_is_cut_by_its_rulings() {
    let knots = Knots::uniform(3, 8, 0.0, 1.0).expect("knots");
    let data = noisy(4, 40);
    let options = RegressionOptions { margin: Some(1e-3), ..RegressionOptions::default() };
    let free = torse::fit::planes::rulings::slope_fit(&data, &knots, &options.fit).expect("a fit");
    let square = [[-0.5, -9.0], [0.5, -9.0], [0.5, 9.0], [-0.5, 9.0]];
    let zone = ForbiddenZone::of_outline(&free.curve, &square, 0.1, 33).expect("a zone");
    let ForbiddenZone::Outline { extent, .. } = &zone else { panic!("an outline") };
    assert!(extent.iter().all(|e| e.1 >= -0.5 - 1e-12 && e.2 <= 0.5 + 1e-12) && !extent.is_empty());
    let got = regression_free(&data, &knots, &zone, &options).expect("a fit");
    let wide = regression_free(&data, &knots, &ForbiddenZone::Slab(-0.6, 0.6), &options).expect("a fit");
    assert!(got.fit.cost <= wide.fit.cost * (1.0 + 1e-9));
    assert!(ForbiddenZone::of_outline(&free.curve, &[], 0.1, 33).is_err());
}

#[test]
fn many_control_points_go_through_the_other_solver() {
    let knots = Knots::uniform(3, 60, 0.0, 1.0).expect("knots");
    let options = RegressionOptions {
        fit: SlopeOptions { smoothing: 1e-9, ..SlopeOptions::default() },
        ..RegressionOptions::default()
    };
    let got = regression_free(&noisy(9, 300), &knots, &ForbiddenZone::Slab(-0.5, 0.5), &options).expect("a fit");
    assert!(regression_x(&got.fit.curve).iter().all(|x| x.is_nan() || x.abs() >= 0.5 - 1e-3));
}

#[test]
fn impossible_zones_are_refused() {
    let knots = Knots::uniform(3, 2, 0.0, 1.0).expect("knots");
    let data = noisy(1, 20);
    let options = RegressionOptions::default();
    let zone = ForbiddenZone::Slab(0.5, -0.5);
    assert!(matches!(regression_free(&data, &knots, &zone, &options), Err(RegressionError::Zone { .. })));
    let zone = ForbiddenZone::Slab(f64::NAN, 1.0);
    assert!(matches!(regression_free(&data, &knots, &zone, &options), Err(RegressionError::Zone { .. })));
    // All control values fixed on a surface whose regression curve crosses the zone.
    let control = [[0.0, 1.0], [0.3, -1.0], [0.1, 2.0], [0.5, 0.0], [-0.2, 1.0]];
    let conditions = control.iter().enumerate().map(|(i, c)| (i, Freedom::Fixed(*c))).collect();
    let fit = SlopeOptions { conditions, ..SlopeOptions::default() };
    let options = RegressionOptions { fit, ..RegressionOptions::default() };
    let zone = ForbiddenZone::Slab(-5.0, 5.0);
    assert!(matches!(regression_free(&data, &knots, &zone, &options), Err(RegressionError::Infeasible(_))));
    let sharp = Knots::new(2, vec![0., 0., 0., 0.5, 0.5, 1., 1., 1.], 5).expect("knots");
    let options = RegressionOptions::default();
    assert!(matches!(
        regression_free(&data, &sharp, &ForbiddenZone::Slab(-1.0, 1.0), &options),
        Err(RegressionError::NoSecondDerivative { .. })
    ));
}

/// The paper's walk for a simplicial cone `a_i·x ≥ 0` and the point `o`: end point.
fn walk(a: &[Vec<f64>], o: &[f64], inside: &[f64]) -> Option<Vec<f64>> {
    let n = o.len();
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    // Nearest point to o with the given constraints active.
    let nearest = |active: &[usize]| -> Option<Vec<f64>> {
        let mut p = QuadraticProgram::new(n);
        (0..n).for_each(|i| p.add_hessian(i, i, 1.0));
        p.linear = o.iter().map(|x| -x).collect();
        for &k in active {
            p.at_least(a[k].iter().copied().enumerate(), 0.0);
            p.at_least(a[k].iter().map(|x| -x).enumerate(), 0.0);
        }
        Some(p.active_set().ok()?.x)
    };
    // Leaving point of a segment, and the constraint that is met.
    let leave = |p: &[f64], q: &[f64], active: &[usize]| -> Option<(Vec<f64>, usize)> {
        let mut best: Option<(f64, usize)> = None;
        for k in (0..a.len()).filter(|k| !active.contains(k)) {
            let (x, y) = (dot(&a[k], p), dot(&a[k], q));
            if y < -1e-12 {
                let s = (x / (x - y)).max(0.0);
                if best.is_none_or(|b| s < b.0) {
                    best = Some((s, k));
                }
            }
        }
        best.map(|(s, k)| (p.iter().zip(q).map(|(p, q)| p + s * (q - p)).collect(), k))
    };
    let Some((mut p, first)) = leave(inside, o, &[]) else { return Some(o.to_vec()) };
    let mut face = vec![first];
    for _ in 0..100 {
        let q = nearest(&face)?;
        let Some((r, met)) = leave(&p, &q, &face) else { return Some(q) };
        let mut edge = face.clone();
        edge.push(met);
        // Faces of the same codimension around the edge: leave one constraint out.
        let next = (0..edge.len()).find_map(|k| {
            let mut g = edge.clone();
            let freed = g.remove(k);
            let towards = nearest(&g)?;
            let rate = dot(&a[freed], &towards) - dot(&a[freed], &r);
            (rate > 1e-12).then_some(g)
        });
        p = r;
        face = next.unwrap_or(edge);
        if face.len() >= n {
            return Some(p);
        }
    }
    None
}

#[test]
fn walk_along_faces_ends_too_early() {
    // A cone of dimension 4 or 5 on which the paper's algorithm does not reach the nearest point.
    let mut random = Random::new(11);
    let mut counterexamples = 0;
    for trial in 0..3000 {
        let n = 4 + trial % 2;
        let a: Vec<Vec<f64>> = (0..n).map(|_| (0..n).map(|_| random.number()).collect()).collect();
        let o: Vec<f64> = (0..n).map(|_| random.number()).collect();
        let mut inner = QuadraticProgram::new(n);
        (0..n).for_each(|i| inner.add_hessian(i, i, 1.0));
        a.iter().for_each(|row| inner.at_least(row.iter().copied().enumerate(), 1.0));
        let Ok(inside) = inner.active_set() else { continue };
        let mut program = QuadraticProgram::new(n);
        (0..n).for_each(|i| program.add_hessian(i, i, 1.0));
        program.linear = o.iter().map(|x| -x).collect();
        a.iter().for_each(|row| program.at_least(row.iter().copied().enumerate(), 0.0));
        let best = program.active_set().expect("a nearest point").x;
        let distance = |x: &[f64]| x.iter().zip(&o).map(|(x, o)| (x - o) * (x - o)).sum::<f64>().sqrt();
        let Some(end) = walk(&a, &o, &inside.x) else { continue };
        assert!(distance(&end) >= distance(&best) - 1e-9, "the program finds the nearest point");
        if distance(&end) > 1.01 * distance(&best) {
            counterexamples += 1;
        }
    }
    assert!(counterexamples > 0, "no cone stops the walk too early");
}
