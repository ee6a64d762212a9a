//! Strictly convex quadratic programs `min ½ xᵀH x + gᵀx, A x ≥ b`: a dual active-set method for few variables and an
//! interior-point method for many.
//!
//! *Method*: the dual active-set method of \[GI83\], written with the Gram matrix `A H⁻¹ Aᵀ` of the constraints, which
//! for tiny programs is simpler than updated factors and as fast; Clarabel's interior-point method otherwise.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector};

/// Up to this many variables the active-set method is used by [`QuadraticProgram::solve`].
const TINY: usize = 60;
/// Interior-point iterations after which a program is given up; regular ones need 10 to 25.
const MAX_ITERATIONS: u32 = 100;
/// Gap and violation, as shares of the program's data, at which interior-point steps end: the place of a minimum is
/// known to the square root of its value only, so that this leaves five digits of it.
const ACCURACY: f64 = 1e-11;

/// Why there is no minimum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuadraticProgramError {
    /// The Hessian is not positive definite to working precision.
    #[error("the objective is not strictly convex: add a small smoothing term")]
    NotConvex,
    /// No point fulfils all constraints.
    #[error("no point fulfils all constraints; constraint {constraint} cannot be added to the others")]
    Infeasible {
        /// Index of a constraint that contradicts the others (0 if the method does not tell).
        constraint: usize,
    },
    /// The iteration ended without an answer.
    #[error("the quadratic program did not converge in {0} steps: scale the constraints")]
    NoConvergence(usize),
    /// A number is not finite.
    #[error("a coefficient of the quadratic program is not a finite number")]
    NotFinite,
}

/// A quadratic program under construction.
#[derive(Clone, Debug, Default)]
pub struct QuadraticProgram {
    /// Linear coefficients `g`, one per variable.
    pub linear: Vec<f64>,
    hessian: Vec<(usize, usize, f64)>,
    rows: Vec<Vec<(usize, f64)>>,
    bounds: Vec<f64>,
}

/// A minimum with its multipliers.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// The minimiser.
    pub x: Vec<f64>,
    /// Multiplier of every constraint, not negative; zero where the constraint is not active.
    pub multipliers: Vec<f64>,
    /// Value of the objective there.
    pub value: f64,
}

impl QuadraticProgram {
    /// A program in `n` variables with zero objective and no constraints.
    pub fn new(n: usize) -> Self {
        Self { linear: vec![0.0; n], ..Self::default() }
    }

    /// Adds `value` to the entry `(i, j)` of `H` and, off the diagonal, to `(j, i)`.
    pub fn add_hessian(&mut self, i: usize, j: usize, value: f64) {
        if value != 0.0 {
            self.hessian.push((i.min(j), i.max(j), value));
        }
    }

    /// Adds the constraint `Σ coefficient · x[variable] ≥ bound`.
    pub fn at_least(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, bound: f64) {
        self.rows.push(terms.into_iter().filter(|t| t.1 != 0.0).collect());
        self.bounds.push(bound);
    }

    /// The minimum, by the method that suits the size.
    ///
    /// # Errors
    /// See [`QuadraticProgramError`].
    pub fn solve(&self) -> Result<Minimum, QuadraticProgramError> {
        if self.linear.len() <= TINY {
            self.active_set()
        } else {
            self.interior_point()
        }
    }

    fn check(&self) -> Result<(), QuadraticProgramError> {
        let finite = self.linear.iter().chain(&self.bounds).all(|x| x.is_finite())
            && self.hessian.iter().all(|h| h.2.is_finite())
            && self.rows.iter().flatten().all(|t| t.1.is_finite());
        if finite {
            Ok(())
        } else {
            Err(QuadraticProgramError::NotFinite)
        }
    }

    fn value(&self, x: &[f64]) -> f64 {
        let quadratic: f64 =
            self.hessian.iter().map(|&(i, j, h)| if i == j { 0.5 * h * x[i] * x[i] } else { h * x[i] * x[j] }).sum();
        quadratic + self.linear.iter().zip(x).map(|(g, x)| g * x).sum::<f64>()
    }

    /// The minimum by the dual active-set method: starts at the free minimum and adds violated constraints one by
    /// one, releasing those whose multiplier would become negative. Ends exactly (up to rounding) at the minimum.
    ///
    /// *Cost*: `n³ + m n²` to start, `q³` per step with `q` active constraints.
    ///
    /// # Errors
    /// See [`QuadraticProgramError`].
    #[expect(clippy::too_many_lines, reason = "the steps of one interior-point iteration")]
    pub fn active_set(&self) -> Result<Minimum, QuadraticProgramError> {
        // A constraint counts as violated beyond this share of the size of its terms; rounding only below it.
        const VIOLATED: f64 = 1e-13;
        // A step direction is zero if the share of a constraint that the active ones leave is below this.
        const DEPENDENT: f64 = 1e-13;
        self.check()?;
        let (n, m) = (self.linear.len(), self.rows.len());
        let mut h = DMatrix::zeros(n, n);
        for &(i, j, v) in &self.hessian {
            h[(i, j)] += v;
            if i != j {
                h[(j, i)] += v;
            }
        }
        let factor = h.cholesky().ok_or(QuadraticProgramError::NotConvex)?;
        let mut x = -factor.solve(&DVector::from_column_slice(&self.linear));
        let mut a = DMatrix::zeros(m, n);
        for (i, row) in self.rows.iter().enumerate() {
            for &(j, v) in row {
                a[(i, j)] += v;
            }
        }
        // H⁻¹ Aᵀ and the Gram matrix of the constraints.
        let inverse = factor.solve(&a.transpose());
        let gram = &a * &inverse;
        let mut active: Vec<usize> = Vec::new();
        let mut lambda: Vec<f64> = Vec::new();
        let most = 20 * (n + m) + 100;
        for _ in 0..most {
            // The most violated constraint, measured in the metric of H.
            let mut worst = (0.0, None);
            for i in (0..m).filter(|i| !active.contains(i)) {
                let product = a.row(i).transpose().dot(&x);
                let size: f64 = a.row(i).iter().zip(x.iter()).map(|(a, x)| (a * x).abs()).sum::<f64>();
                let gap = self.bounds[i] - product;
                let scaled = gap / gram[(i, i)].sqrt().max(f64::MIN_POSITIVE);
                if gap > VIOLATED * (size + self.bounds[i].abs()) && scaled > worst.0 {
                    worst = (scaled, Some(i));
                }
            }
            let Some(p) = worst.1 else {
                let mut multipliers = vec![0.0; m];
                for (&i, &l) in active.iter().zip(&lambda) {
                    multipliers[i] = l;
                }
                let x: Vec<f64> = x.iter().copied().collect();
                return Ok(Minimum { value: self.value(&x), x, multipliers });
            };
            let mut own = 0.0;
            loop {
                let q = active.len();
                let r = if q == 0 {
                    DVector::zeros(0)
                } else {
                    let small = DMatrix::from_fn(q, q, |i, j| gram[(active[i], active[j])]);
                    let right = DVector::from_fn(q, |i, _| gram[(active[i], p)]);
                    small.cholesky().ok_or(QuadraticProgramError::NoConvergence(q))?.solve(&right)
                };
                let slope = gram[(p, p)] - (0..q).map(|i| r[i] * gram[(active[i], p)]).sum::<f64>();
                let mut release = (f64::INFINITY, None);
                for i in 0..q {
                    if r[i] > 0.0 && lambda[i] / r[i] < release.0 {
                        release = (lambda[i] / r[i], Some(i));
                    }
                }
                let gap = self.bounds[p] - a.row(p).transpose().dot(&x);
                let full = if slope > DEPENDENT * gram[(p, p)] { gap / slope } else { f64::INFINITY };
                let step = full.min(release.0);
                if !step.is_finite() {
                    return Err(QuadraticProgramError::Infeasible { constraint: p });
                }
                for i in 0..q {
                    lambda[i] -= step * r[i];
                }
                own += step;
                if full.is_finite() {
                    x += inverse.column(p) * step;
                    for i in 0..q {
                        x -= inverse.column(active[i]) * (step * r[i]);
                    }
                }
                match release.1 {
                    Some(i) if release.0 < full => {
                        active.remove(i);
                        lambda.remove(i);
                    }
                    _ => {
                        active.push(p);
                        lambda.push(own);
                        break;
                    }
                }
            }
        }
        Err(QuadraticProgramError::NoConvergence(most))
    }

    /// The minimum by an interior-point method: for many variables and sparse constraints. About nine digits.
    ///
    /// # Errors
    /// See [`QuadraticProgramError`].
    pub fn interior_point(&self) -> Result<Minimum, QuadraticProgramError> {
        self.check()?;
        let (n, m) = (self.linear.len(), self.rows.len());
        let triplets = |values: &mut dyn Iterator<Item = (usize, usize, f64)>| {
            let (mut r, mut c, mut v) = (Vec::new(), Vec::new(), Vec::new());
            for (i, j, x) in values {
                r.push(i);
                c.push(j);
                v.push(x);
            }
            (r, c, v)
        };
        let (r, c, v) = triplets(&mut self.hessian.iter().copied());
        let p = CscMatrix::new_from_triplets(n, n, r, c, v);
        let (r, c, v) =
            triplets(&mut self.rows.iter().enumerate().flat_map(|(i, row)| row.iter().map(move |&(j, a)| (i, j, -a))));
        let a = CscMatrix::new_from_triplets(m, n, r, c, v);
        let b: Vec<f64> = self.bounds.iter().map(|x| -x).collect();
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .max_iter(MAX_ITERATIONS)
            .tol_gap_rel(ACCURACY)
            .tol_gap_abs(ACCURACY)
            .tol_feas(ACCURACY)
            .build()
            .map_err(|_| QuadraticProgramError::NoConvergence(0))?;
        let mut solver = DefaultSolver::new(&p, &self.linear, &a, &b, &[SupportedConeT::NonnegativeConeT(m)], settings)
            .map_err(|_| QuadraticProgramError::NoConvergence(0))?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                let x = solver.solution.x.clone();
                Ok(Minimum { value: self.value(&x), x, multipliers: solver.solution.z.clone() })
            }
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                Err(QuadraticProgramError::Infeasible { constraint: 0 })
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => Err(QuadraticProgramError::NotConvex),
            _ => Err(QuadraticProgramError::NoConvergence(solver.solution.iterations as usize)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nearest_in_wedge() -> QuadraticProgram {
        // Nearest point to (2, 0) with y ≥ x and x + y ≥ 3: the corner (1.5, 1.5).
        let mut p = QuadraticProgram::new(2);
        p.add_hessian(0, 0, 1.0);
        p.add_hessian(1, 1, 1.0);
        p.linear = vec![-2.0, 0.0];
        p.at_least([(0, -1.0), (1, 1.0)], 0.0);
        p.at_least([(0, 1.0), (1, 1.0)], 3.0);
        p
    }

    #[test]
    fn a_corner_is_found_by_both_methods() {
        let p = nearest_in_wedge();
        for m in [p.active_set().expect("a minimum"), p.interior_point().expect("a minimum")] {
            assert!((m.x[0] - 1.5).abs() < 1e-8 && (m.x[1] - 1.5).abs() < 1e-8);
            assert!(m.multipliers.iter().all(|l| *l > 0.1));
        }
    }

    #[test]
    fn methods_agree_on_random_programs() {
        let mut state = 7u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for _ in 0..40 {
            let n = 6;
            let mut p = QuadraticProgram::new(n);
            let root: Vec<f64> = (0..n * n).map(|_| random()).collect();
            for i in 0..n {
                for j in i..n {
                    let dot: f64 = (0..n).map(|k| root[i * n + k] * root[j * n + k]).sum();
                    p.add_hessian(i, j, dot + if i == j { 0.1 } else { 0.0 });
                }
                p.linear[i] = random();
            }
            let inside: Vec<f64> = (0..n).map(|_| random()).collect();
            for _ in 0..9 {
                let row: Vec<f64> = (0..n).map(|_| random()).collect();
                let at: f64 = row.iter().zip(&inside).map(|(a, b)| a * b).sum();
                p.at_least(row.into_iter().enumerate(), at - 0.05);
            }
            let (a, b) = (p.active_set().expect("a minimum"), p.interior_point().expect("a minimum"));
            let size = a.x.iter().fold(1.0f64, |m, x| m.max(x.abs()));
            assert!(a.x.iter().zip(&b.x).all(|(x, y)| (x - y).abs() < 1e-6 * size), "{a:?} {b:?}");
        }
    }

    #[test]
    fn contradictions_and_flat_objectives_are_refused() {
        let mut p = nearest_in_wedge();
        p.at_least([(0, -1.0), (1, -1.0)], -2.0);
        assert!(matches!(p.active_set(), Err(QuadraticProgramError::Infeasible { .. })));
        assert!(matches!(p.interior_point(), Err(QuadraticProgramError::Infeasible { .. })));
        let flat = QuadraticProgram::new(2);
        assert_eq!(flat.active_set(), Err(QuadraticProgramError::NotConvex));
        let mut bad = nearest_in_wedge();
        bad.linear[0] = f64::NAN;
        assert_eq!(bad.solve(), Err(QuadraticProgramError::NotFinite));
    }
}
