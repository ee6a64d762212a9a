//! Linear minimax problems: `min_d  max_i |r_i + (J d)_i| + ½ dᵀ Q d + cᵀ d`, by a primal-dual interior-point method.
//!
//! Each step is one weighted least-squares solve with the weights `z/s` of both sides of every row, so it costs the
//! same as a step of Lawson's reweighting, but it converges in about ten steps and knows its own gap.
//! Source: Mehrotra's primal-dual framework for linear programs, specialised to the Chebyshev problem.

use super::least_squares::{BandMatrix, Rows};

/// Working memory of [`step`], kept between calls.
#[derive(Debug)]
pub struct Workspace {
    matrix: BandMatrix,
    slack: [Vec<f64>; 2],
    dual: [Vec<f64>; 2],
    moved: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    gradient: Vec<f64>,
}

impl Workspace {
    /// Empty workspace.
    pub fn new() -> Self {
        let none = || [Vec::new(), Vec::new()];
        Self {
            matrix: BandMatrix::zeros(0, 1),
            slack: none(),
            dual: none(),
            moved: Vec::new(),
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
    quadratic: &BandMatrix,
    linear: &[f64],
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
    let Workspace { matrix, slack, dual, moved, p, q, gradient } = work;
    for k in 0..2 {
        slack[k].clear();
        slack[k].extend(residual.iter().map(|r| if k == 0 { e - r } else { e + r }));
        dual[k].clear();
        dual[k].resize(m, 0.5 / m as f64);
    }
    moved.resize(m, 0.0);
    p.resize(n, 0.0);
    q.resize(n, 0.0);
    gradient.resize(n, 0.0);
    for _ in 0..STEPS {
        let complementarity: f64 = (0..2).map(|k| slack[k].iter().zip(&dual[k]).map(|(s, z)| s * z).sum::<f64>()).sum();
        let total: f64 = dual.iter().flatten().sum();
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
        for i in 0..m {
            let (w0, w1) = (dual[0][i] / slack[0][i], dual[1][i] / slack[1][i]);
            let (i0, i1) = (1.0 / slack[0][i], 1.0 / slack[1][i]);
            matrix.add_row(jacobian, i, w0 + w1);
            jacobian.scatter(i, -mu * (i0 - i1), p);
            jacobian.scatter(i, w0 - w1, q);
            sum_w += w0 + w1;
            rhs_e += mu * (i0 + i1);
        }
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
        // Step lengths for slacks and duals.
        let (mut primal, mut dualstep) = (1.0_f64, 1.0_f64);
        for i in 0..m {
            let jd = jacobian.dot(i, p);
            moved[i] = jd;
            for k in 0..2 {
                let (s, z) = (slack[k][i], dual[k][i]);
                let ds = if k == 0 { de - jd } else { de + jd };
                let dz = (mu - z * ds) / s - z;
                if ds < 0.0 {
                    primal = primal.min(-TO_BOUND * s / ds);
                }
                if dz < 0.0 {
                    dualstep = dualstep.min(-TO_BOUND * z / dz);
                }
            }
        }
        if !(primal.is_finite() && dualstep.is_finite() && de.is_finite()) {
            return None;
        }
        // With a quadratic term the dual residual only shrinks when both steps agree.
        let length = primal.min(dualstep);
        for i in 0..m {
            for k in 0..2 {
                let (s, z) = (slack[k][i], dual[k][i]);
                let ds = if k == 0 { de - moved[i] } else { de + moved[i] };
                let dz = (mu - z * ds) / s - z;
                slack[k][i] = s + length * ds;
                dual[k][i] = z + length * dz;
            }
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
        let e = step(&rows, &r, &q, &[0.0; 2], 1e-6, &mut Workspace::new(), &mut d).expect("solved");
        assert!((e - 0.125).abs() < 1e-6, "{e}");
        assert!((d[0] + 0.125).abs() < 1e-5 && (d[1] - 1.0).abs() < 1e-5);
    }
}
