//! Better parameters for given planes: alternating correction, and all unknowns at once.
//!
//! *Method.* The correction of \[PW99, 4.2\] moves each inner parameter to the foot point of its plane to first order, in
//! the plane's own metric, with step halving, and fits again: linear, and slow, since it alternates. The joint
//! iteration is damped Gauss–Newton in control planes and parameters together; each parameter is eliminated from its
//! own three rows, so that the system stays banded and the cost linear.

use super::functionals::{Freedom, Functional, System};
use super::planes::{checked, fit_of, freedoms, mean_root, planes, PlaneDatum, PlanesError, PlanesFit, PlanesOptions};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;

/// A fit with the parameters that it found.
#[derive(Clone, Debug, PartialEq)]
pub struct Corrected {
    /// The fit.
    pub fit: PlanesFit,
    /// Parameters of the planes.
    pub parameters: Vec<f64>,
    /// `F1` at the start and after every step taken.
    pub history: Vec<f64>,
}

/// Options of [`joint`].
#[derive(Clone, Debug, PartialEq)]
pub struct JointOptions {
    /// Corrections before the joint iteration; 4.
    pub corrections: usize,
    /// Evaluations of the joint iteration at most; 40.
    pub evaluations: usize,
    /// Relative decrease of `F1` below which it ends; 1e-6.
    pub decrease: f64,
}

impl Default for JointOptions {
    fn default() -> Self {
        Self { corrections: 4, evaluations: 40, decrease: 1e-6 }
    }
}

/// Fits and corrects the inner parameters `count` times in turn. `F1` never grows.
///
/// # Errors
/// As [`planes`].
pub fn corrected(
    data: &[PlaneDatum],
    knots: &Knots,
    options: &PlanesOptions,
    count: usize,
) -> Result<Corrected, PlanesError> {
    let mut data = data.to_vec();
    let mut fit = planes(&data, knots, options)?;
    let mut history = vec![fit.cost];
    for _ in 0..count {
        let before = data.clone();
        correct(&mut data, fit.curve.planes());
        let next = planes(&data, knots, options)?;
        if next.cost > fit.cost {
            // Only smoothing or robust weights can do this; the last state is the better one.
            data = before;
            break;
        }
        fit = next;
        history.push(fit.cost);
    }
    Ok(Corrected { fit, parameters: data.iter().map(|d| d.parameter).collect(), history })
}

/// One correction of all parameters but the first and the last.
fn correct(data: &mut [PlaneDatum], curve: &Curve<4>) {
    // Halvings after which a parameter stays where it is.
    const HALVINGS: usize = 30;
    let (from, to) = curve.domain();
    let last = data.len().saturating_sub(1);
    for d in data.iter_mut().take(last).skip(1) {
        let error = |t: f64| {
            let u = curve.point(t);
            let e: [f64; 3] = std::array::from_fn(|i| d.plane[i] - u[i]);
            d.measure.distance_sq(&e)
        };
        let [u, du, _] = curve.jet(d.parameter);
        let g = d.measure.gram();
        let product = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| -> f64 {
            (0..3).map(|i| (0..3).map(|j| a(i) * g[i][j] * b(j)).sum::<f64>()).sum()
        };
        let speed = product(&|i| du[i], &|i| du[i]);
        if speed.is_nan() || speed <= 0.0 {
            continue;
        }
        let mut step = product(&|i| d.plane[i] - u[i], &|i| du[i]) / speed;
        let here = error(d.parameter);
        for _ in 0..HALVINGS {
            let t = (d.parameter + step).clamp(from, to);
            if error(t) < here {
                d.parameter = t;
                break;
            }
            step *= 0.5;
        }
    }
}

/// Fits control planes and inner parameters together, after a few corrections. Parameters that increase stay
/// increasing; the first and the last are kept.
///
/// # Errors
/// As [`planes`].
pub fn joint(
    data: &[PlaneDatum],
    knots: &Knots,
    options: &PlanesOptions,
    joint: &JointOptions,
) -> Result<Corrected, PlanesError> {
    // Damping: start, factors after success and failure, and where further failures are hopeless.
    const START: f64 = 1e-4;
    const EASE: f64 = 0.2;
    const STRAIN: f64 = 5.0;
    const HOPELESS: f64 = 1e8;
    let start = corrected(data, knots, options, joint.corrections)?;
    let roots = checked(data, knots)?;
    let bound = freedoms(knots, &options.conditions)?;
    // Changes of control planes have the same freedoms without offsets.
    let changes: Vec<Freedom<3>> = bound
        .iter()
        .map(|f| match f {
            Freedom::Free => Freedom::Free,
            Freedom::Fixed(_) => Freedom::Fixed([0.0; 3]),
            Freedom::Line { direction, .. } => Freedom::Line { base: [0.0; 3], direction: *direction },
        })
        .collect();
    let smooth = if options.smoothing > 0.0 { mean_root(data) } else { None };
    let mut data = data.to_vec();
    for ((d, &t), trust) in data.iter_mut().zip(&start.parameters).zip(&start.fit.trust) {
        d.parameter = t;
        d.weight *= trust;
    }
    let planes_of = |c: &Curve<4>| -> Vec<[f64; 3]> { c.control.iter().map(|p| [p[0], p[1], p[2]]).collect() };
    let mut control = planes_of(start.fit.curve.planes());
    let mut history = start.history.clone();
    let mut cost = cost_of(&data, &roots, knots, &control);
    let mut damping = START;
    for _ in 0..joint.evaluations {
        let step =
            step(&data, &roots, knots, &control, &changes, damping, smooth.as_ref().map(|r| (options.smoothing, r)));
        let Some((change, moves)) = step else {
            damping *= STRAIN;
            if damping > HOPELESS {
                break;
            }
            continue;
        };
        let next: Vec<[f64; 3]> =
            control.iter().zip(&change).map(|(c, d)| std::array::from_fn(|i| c[i] + d[i])).collect();
        let mut moved = data.clone();
        for (d, m) in moved.iter_mut().zip(&moves) {
            d.parameter += m;
        }
        let value = cost_of(&moved, &roots, knots, &next);
        if value < cost {
            let gain = (cost - value) / cost;
            (control, data, cost) = (next, moved, value);
            history.push(cost);
            damping = (damping * EASE).max(f64::EPSILON);
            if gain < joint.decrease {
                break;
            }
        } else {
            damping *= STRAIN;
            if damping > HOPELESS {
                break;
            }
        }
    }
    let parameters = data.iter().map(|d| d.parameter).collect();
    let fit = fit_of(&data, &roots, knots, control, start.fit.trust)?;
    Ok(Corrected { fit, parameters, history })
}

/// Changes of control planes and parameters to first order, damped.
fn step(
    data: &[PlaneDatum],
    roots: &[[[f64; 3]; 3]],
    knots: &Knots,
    control: &[[f64; 3]],
    changes: &[Freedom<3>],
    damping: f64,
    smooth: Option<(f64, &[[f64; 3]; 3])>,
) -> Option<(Vec<[f64; 3]>, Vec<f64>)> {
    // Share of the gap between neighbours that one step may close.
    const GAP: f64 = 0.8;
    let zero = [0.0; 3];
    let last = data.len() - 1;
    // 1 − c with (1 − c)² = λ / (1 + λ): the square root of the damped projection off the direction of U'.
    let off = 1.0 - (damping / (1.0 + damping)).sqrt();
    let mut system = System::new(knots, changes);
    let mut state = Vec::with_capacity(data.len());
    for (i, (d, root)) in data.iter().zip(roots).enumerate() {
        let basis = knots.basis(d.parameter, 1);
        let (mut e, mut speed) = (d.plane.map(|x| -x), zero);
        for j in 0..=knots.degree() {
            for k in 0..3 {
                e[k] += basis.rows[0][j] * control[basis.first + j][k];
                speed[k] += basis.rows[1][j] * control[basis.first + j][k];
            }
        }
        let apply = |x: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|r| (0..3).map(|k| root[r][k] * x[k]).sum()) };
        let (r, j) = (apply(&e), apply(&speed));
        let jj: f64 = j.iter().map(|x| x * x).sum();
        let inner = i > 0 && i < last && jj > 0.0;
        let along = |x: [f64; 3]| -> f64 {
            if inner {
                off * (0..3).map(|k| j[k] * x[k]).sum::<f64>() / jj
            } else {
                0.0
            }
        };
        for row in 0..3 {
            // Row of S R with S = I − off · j jᵀ / jᵀj.
            let coefficients: [f64; 3] =
                std::array::from_fn(|k| root[row][k] - j[row] * along([root[0][k], root[1][k], root[2][k]]));
            let value = -(r[row] - j[row] * along(r));
            system.add(&Functional {
                t: d.parameter,
                coefficients: [coefficients, zero, zero],
                value,
                weight: d.weight,
            });
        }
        state.push((r, j, if inner { jj } else { 0.0 }, basis));
    }
    if let Some((share, root)) = smooth {
        system.add_smoothing(share, root);
    }
    let change = system.solved(damping)?;
    let mut moves = vec![0.0; data.len()];
    for (i, (r, j, jj, basis)) in state.iter().enumerate() {
        if *jj <= 0.0 {
            continue;
        }
        let mut du = zero;
        for k in 0..=knots.degree() {
            for c in 0..3 {
                du[c] += basis.rows[0][k] * change[basis.first + k][c];
            }
        }
        let rest: f64 =
            (0..3).map(|row| j[row] * (r[row] + (0..3).map(|k| roots[i][row][k] * du[k]).sum::<f64>())).sum();
        moves[i] = -rest / ((1.0 + damping) * jj);
    }
    // The whole step is shortened until the order of the parameters stays as it is.
    let mut share = 1.0_f64;
    for (d, m) in data.windows(2).zip(moves.windows(2)) {
        let (gap, closing) = (d[1].parameter - d[0].parameter, m[0] - m[1]);
        if gap > 0.0 && closing > GAP * gap {
            share = share.min(GAP * gap / closing);
        }
    }
    let (a, b) = knots.domain();
    for (d, m) in data.iter().zip(&mut moves) {
        *m = (share * *m).clamp(a - d.parameter, b - d.parameter);
    }
    let change = change.iter().map(|c| c.map(|x| share * x)).collect();
    Some((change, moves))
}

/// `F1`.
fn cost_of(data: &[PlaneDatum], roots: &[[[f64; 3]; 3]], knots: &Knots, control: &[[f64; 3]]) -> f64 {
    data.iter()
        .zip(roots)
        .map(|(d, root)| {
            let basis = knots.basis(d.parameter, 0);
            let mut e = d.plane.map(|x| -x);
            for j in 0..=knots.degree() {
                for k in 0..3 {
                    e[k] += basis.rows[0][j] * control[basis.first + j][k];
                }
            }
            d.weight * root.iter().map(|r| (0..3).map(|k| r[k] * e[k]).sum::<f64>().powi(2)).sum::<f64>()
        })
        .sum()
}
