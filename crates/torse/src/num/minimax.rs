//! Linear minimax problems: `min_d  max_i |r_i + (J d)_i| + ½ dᵀ Q d + cᵀ d`, by a primal-dual interior-point method.
//!
//! Each step is one weighted least-squares solve with the weights `z/s` of both sides of every row, so it costs the
//! same as a step of Lawson's reweighting, but it converges in about ten steps and knows its own gap.
//! A predictor and a corrector need a third fewer, but end nearer to a corner of all that is nearly as good: torses are less even
//! then, and a fuselage at 10 mm got six strips for five.
//! Source: Mehrotra's primal-dual framework for linear programs, specialised to the Chebyshev problem.

use super::least_squares::{BandMatrix, Rows};

/// Working memory of [`step`], kept between calls.
#[derive(Debug)]
pub struct Workspace {
    matrix: BandMatrix,
    sides: Vec<[Side; 2]>,
    /// Row numbers by their first columns.
    order: Vec<usize>,
    weights: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    gradient: Vec<f64>,
}

/// One side of a row: `slack = e ∓ (r + J d) > 0` with its multiplier, and what a step makes of them.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    slack: f64,
    dual: f64,
    /// 1/slack, dual/slack and 1/dual.
    inverse: f64,
    weight: f64,
    inverse_dual: f64,
    /// Their changes in a full step.
    slack_step: f64,
    dual_step: f64,
}

impl Side {
    /// Brings the quotients up to date, with a single division.
    #[inline]
    fn prepare(&mut self) {
        let both = 1.0 / (self.slack * self.dual);
        self.inverse = self.dual * both;
        self.weight = self.dual * self.inverse;
        self.inverse_dual = self.slack * both;
    }

    /// Takes the full step that moves the slack by `ds`; the results are the largest shrinkages of both, as shares.
    #[inline]
    fn aim(&mut self, ds: f64, mu: f64) -> (f64, f64) {
        self.slack_step = ds;
        self.dual_step = mu * self.inverse - self.weight * ds - self.dual;
        (-ds * self.inverse, -self.dual_step * self.inverse_dual)
    }
}

impl Workspace {
    /// Empty workspace.
    pub fn new() -> Self {
        Self {
            matrix: BandMatrix::zeros(0, 1),
            sides: Vec::new(),
            order: Vec::new(),
            weights: Vec::new(),
            p: Vec::new(),
            q: Vec::new(),
            gradient: Vec::new(),
        }
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

/// Most interior-point steps; ten are usual.
const STEPS: usize = 30;
/// Share of the way to the nearest bound that a step may take.
const TO_BOUND: f64 = 0.95;
/// Wanted reduction of the complementarity per step.
const CENTERING: f64 = 0.15;

/// Solves the problem of the module's header for `d`, to a duality gap below `gap` times the optimum.
///
/// *Input*: rows `jacobian`, one residual each, the positive (semi)definite `quadratic` term `Q` (it must make the
/// problem strictly convex) and its linear term `linear`. *Result*: the predicted maximum `max |r + J d|`, with `d` in
/// `out`; `None` if a factorisation failed. *Cost*: about ten weighted normal-matrix assemblies and solves.
pub fn step(
    jacobian: &Rows,
    residual: &[f64],
    (quadratic, linear): (&BandMatrix, &[f64]),
    gap: f64,
    work: &mut Workspace,
    out: &mut Vec<f64>,
) -> Option<f64> {
    let (m, n) = (jacobian.len(), jacobian.columns());
    out.clear();
    out.resize(n, 0.0);
    let start = residual.iter().fold(0.0_f64, |a, r| a.max(r.abs()));
    if m == 0 || start == 0.0 || !start.is_finite() {
        return (start == 0.0).then_some(0.0);
    }
    let mut e = 1.1 * start;
    let Workspace { matrix, sides, order, weights, p, q, gradient } = work;
    let dual = 0.5 / m as f64;
    sides.clear();
    sides.extend(residual.iter().map(|r| [e - r, e + r].map(|slack| Side { slack, dual, ..Side::default() })));
    jacobian.order(order);
    weights.resize(m, 0.0);
    p.resize(n, 0.0);
    q.resize(n, 0.0);
    gradient.resize(n, 0.0);
    for _ in 0..STEPS {
        let complementarity: f64 = sides.iter().flatten().map(|s| s.slack * s.dual).sum();
        let total: f64 = sides.iter().flatten().map(|s| s.dual).sum();
        if complementarity < gap * e && (total - 1.0).abs() < gap {
            break;
        }
        let mu = CENTERING * complementarity / (2 * m) as f64;
        // Newton system: (Q + JᵀWJ) Δd − JᵀV Δe = −(Q d + c) − μ Jᵀ(1/s₁ − 1/s₂),
        //                ΣW Δe − VᵀJ Δd = μ Σ(1/s₁ + 1/s₂) − 1.
        matrix.assign(quadratic);
        quadratic.product(out, gradient);
        for j in 0..n {
            p[j] = -(gradient[j] + linear[j]);
            q[j] = 0.0;
        }
        let (mut sum_w, mut rhs_e) = (0.0, -1.0);
        for (i, side) in sides.iter_mut().enumerate() {
            side.iter_mut().for_each(Side::prepare);
            let [a, b] = side;
            weights[i] = a.weight + b.weight;
            jacobian.scatter(i, -mu * (a.inverse - b.inverse), p);
            jacobian.scatter(i, a.weight - b.weight, q);
            sum_w += weights[i];
            rhs_e += mu * (a.inverse + b.inverse);
        }
        matrix.add_rows(jacobian, order, weights);
        gradient.copy_from_slice(q); // JᵀV
        if !matrix.factorise() {
            return None;
        }
        matrix.solve(p);
        matrix.solve(q);
        let vjp: f64 = gradient.iter().zip(p.iter()).map(|(a, b)| a * b).sum();
        let vjq: f64 = gradient.iter().zip(q.iter()).map(|(a, b)| a * b).sum();
        let denominator = sum_w - vjq;
        let de = if denominator > 0.0 { (rhs_e + vjp) / denominator } else { 0.0 };
        for j in 0..n {
            p[j] += q[j] * de;
        }
        // With a quadratic term the dual residual only shrinks when slacks and multipliers go the same share.
        let mut shrinkage = TO_BOUND;
        for (i, [a, b]) in sides.iter_mut().enumerate() {
            let jd = jacobian.dot(i, p);
            for (slack, dual) in [a.aim(de - jd, mu), b.aim(de + jd, mu)] {
                shrinkage = shrinkage.max(slack).max(dual);
            }
        }
        let length = TO_BOUND / shrinkage;
        if !(length.is_finite() && length > 0.0 && de.is_finite()) {
            return None;
        }
        for side in sides.iter_mut().flatten() {
            side.slack += length * side.slack_step;
            side.dual += length * side.dual_step;
        }
        e += length * de;
        for j in 0..n {
            out[j] += length * p[j];
        }
    }
    let worst = residual.iter().enumerate().fold(0.0_f64, |a, (i, r)| a.max((r + jacobian.dot(i, out)).abs()));
    worst.is_finite().then_some(worst)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best straight line to `x²` on [0, 1] is `x − 1/8`, with error 1/8.
    #[test]
    fn best_line_to_a_parabola() {
        let mut rows = Rows::new(2, 2);
        let mut r = Vec::new();
        for i in 0..=100 {
            let x = i as f64 / 100.0;
            rows.push(0).1.copy_from_slice(&[1.0, x]);
            r.push(-x * x);
        }
        let mut q = BandMatrix::zeros(2, 2);
        q.add_diagonal(0, 1e-9);
        q.add_diagonal(1, 1e-9);
        let mut d = Vec::new();
        let e = step(&rows, &r, (&q, &[0.0; 2]), 1e-6, &mut Workspace::new(), &mut d).expect("solved");
        assert!((e - 0.125).abs() < 1e-6, "{e}");
        assert!((d[0] + 0.125).abs() < 1e-5 && (d[1] - 1.0).abs() < 1e-5);
    }
}
