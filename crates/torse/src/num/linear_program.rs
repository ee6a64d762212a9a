//! Linear programs `min c·x, A x ≤ b`, solved by an interior-point method.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// Iterations after which a program is given up; regular ones need 10 to 25.
const MAX_ITERATIONS: u32 = 60;
/// Gap between a program and its dual, as a share of the objective: minimisers are proposals; six digits are plenty.
const RELATIVE_GAP: f64 = 1e-6;
/// The same gap where the objective itself is near zero, in its unit: below it the share alone would never be met.
const ABSOLUTE_GAP: f64 = 1e-8;
/// Share of the program's data by which rows may be violated: a digit below the gap, which they must not buy.
const INFEASIBLE: f64 = 1e-7;

/// A linear program under construction.
#[derive(Clone, Debug, Default)]
pub(crate) struct LinearProgram {
    /// Objective coefficients, one per variable.
    pub cost: Vec<f64>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
    bounds: Vec<f64>,
}

impl LinearProgram {
    /// A program in `n` variables with zero cost.
    pub fn new(n: usize) -> Self {
        Self { cost: vec![0.0; n], ..Self::default() }
    }

    /// Adds the row `Σ coefficient · x[variable] ≤ bound`.
    pub fn at_most(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, bound: f64) {
        let row = self.bounds.len();
        for (column, value) in terms {
            if value != 0.0 {
                self.rows.push(row);
                self.columns.push(column);
                self.values.push(value);
            }
        }
        self.bounds.push(bound);
    }

    /// Minimiser, or `None` if the program is infeasible, unbounded or did not converge.
    pub fn solve(&self) -> Option<Vec<f64>> {
        let (n, m) = (self.cost.len(), self.bounds.len());
        let a = CscMatrix::new_from_triplets(m, n, self.rows.clone(), self.columns.clone(), self.values.clone());
        let p = CscMatrix::zeros((n, n));
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .max_iter(MAX_ITERATIONS)
            .tol_gap_rel(RELATIVE_GAP)
            .tol_gap_abs(ABSOLUTE_GAP)
            .tol_feas(INFEASIBLE)
            .build()
            .ok()?;
        let cones = [SupportedConeT::NonnegativeConeT(m)];
        let mut solver = DefaultSolver::new(&p, &self.cost, &a, &self.bounds, &cones, settings).ok()?;
        solver.solve();
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved)
            .then(|| solver.solution.x.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_is_found() {
        let mut lp = LinearProgram::new(2);
        lp.cost = vec![-1.0, -2.0];
        lp.at_most([(0, 1.0), (1, 1.0)], 4.0);
        lp.at_most([(1, 1.0)], 3.0);
        lp.at_most([(0, -1.0)], 0.0);
        let x = lp.solve().expect("solvable");
        assert!((x[0] - 1.0).abs() < 1e-5 && (x[1] - 3.0).abs() < 1e-5);
    }
}
