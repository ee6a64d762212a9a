//! Newton steps of minimum norm, for more digits than normal equations give.
//!
//! Near a solution the hard rows alone are solved, `J Δx = −F` in least squares with the shortest Δx, private unknowns
//! eliminated. J is factorised orthogonally above a tiny multiple of the unit matrix, so no digits are lost to squares, and
//! directions without singular value worth the name take no part: what a truncated pseudo-inverse would do \[B96\].

use super::block::Role;
use super::elimination::substitute;
use super::normal_matrix::FROZEN;
use super::solver::Solver;
use super::sparse::SparseRows;
use super::status::{Outcome, Status};
use crate::control::Control;

/// Multiple of the unit matrix at first, as a share of the largest row, and at most.
const SHIFT: f64 = 1e-9;
/// The least one: singular values of cubic strips reach down to 1e-9, and what leaves them out creeps.
const LEAST_SHIFT: f64 = 1e-13;
/// Where rows fall by no more than this factor, a tenth of the shift is tried.
const SLOW: f64 = 0.5;
/// Where rows grow by this factor, the shift was too small: directions of mere rounding took part.
const WILD: f64 = 30.0;
/// Corrections of every solution, so that the shift itself leaves no trace.
const REPEATS: usize = 2;
/// Newton steps without a new least residual until the polish ends. Steps along weak directions are long, and rows grow before
/// they fall quadratically.
const PATIENCE: usize = 30;
/// Rows beyond which Newton steps have left the neighbourhood of a solution.
const LOST: f64 = 0.1;

impl Solver {
    /// Lowers the hard rows to `tolerance` (largest absolute value) with at most `iterations` Newton steps of minimum
    /// norm, or as far as they go; what is met with the least residual is kept. Soft and fairness rows take no part.
    /// Private unknowns begin anew.
    pub fn polish(&mut self, tolerance: f64, iterations: usize, control: &Control) -> Outcome {
        self.begin();
        let mut best = (f64::INFINITY, self.x.clone(), self.own.clone(), 0);
        let mut last_step = f64::INFINITY;
        let mut status = Status::MaxIterations;
        let (mut share, mut before) = (SHIFT, f64::INFINITY);
        for iteration in 0..=iterations {
            self.linearise(0.0, 0.0);
            let here = self.hard();
            if here < best.0 && self.flipped().is_none() {
                best = (here, self.x.clone(), self.own.clone(), iteration);
            }
            if best.0 <= tolerance {
                status = Status::Converged;
                break;
            }
            if control.stopped() {
                status = Status::Cancelled;
                break;
            }
            if here.is_nan() || here >= LOST || iteration > best.3 + PATIENCE {
                status = Status::Stalled;
                break;
            }
            if here > WILD * before {
                share = (share * 100.0).min(SHIFT);
            } else if here > SLOW * before && here < before {
                share = (share * 0.1).max(LEAST_SHIFT);
            }
            before = here;
            let (rows, right) = self.reduce();
            let Some(step) = rows.shortest(self.step.len(), &right, share * rows.largest(), REPEATS) else {
                status = Status::Stalled;
                break;
            };
            self.step.copy_from_slice(&step);
            self.private_polish_steps();
            self.try_step(1.0);
            std::mem::swap(&mut self.x, &mut self.trial);
            std::mem::swap(&mut self.own, &mut self.trial_own);
            last_step = self.step.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
            control.report("polishing", (iteration + 1) as f64 / iterations.max(1) as f64, "");
        }
        if best.0.is_infinite() {
            return Outcome { flipped: self.flipped(), ..self.outcome(Status::Flipped, 0, last_step) };
        }
        self.x.copy_from_slice(&best.1);
        self.own.copy_from_slice(&best.2);
        self.linearise(0.0, 0.0);
        self.outcome(status, best.3, last_step)
    }

    /// Hard rows without private unknowns, and their right-hand side.
    fn reduce(&mut self) -> (SparseRows, Vec<f64>) {
        let (mut rows, mut right) = (SparseRows::default(), Vec::new());
        for slot in self.slots.iter().filter(|s| s.placed.role == Role::Hard) {
            let (n, private) = (slot.placed.block.rows(), slot.placed.block.private());
            let width = slot.columns.len() + private;
            let entries = &self.jacobian[slot.entry..slot.entry + n * width];
            self.workspace.load(entries, &self.residual[slot.row..slot.row + n], private, 1.0, 0.0);
            self.workspace.eliminate();
            let kept = self.workspace.triangle();
            self.triangles[slot.triangle..slot.triangle + kept.len()].copy_from_slice(kept);
            for row in self.workspace.reduced() {
                let (s, r) = row.split_at(slot.columns.len());
                let free = slot.columns.iter().zip(s).filter(|(c, v)| **c != FROZEN && **v != 0.0);
                free.for_each(|(c, v)| rows.entry(*c, *v));
                rows.end();
                right.push(-r[0]);
            }
        }
        (rows, right)
    }

    /// Increments of private unknowns of hard blocks; those of others stay.
    fn private_polish_steps(&mut self) {
        self.step_own.fill(0.0);
        for slot in self.slots.iter().filter(|s| s.placed.role == Role::Hard) {
            let private = slot.placed.block.private();
            let step = &self.step;
            let shared = |j: usize| step.get(slot.columns[j] as usize).copied().unwrap_or(0.0);
            let size = private * (slot.columns.len() + private + 1);
            let own = &mut self.step_own[slot.own..slot.own + private];
            substitute(&self.triangles[slot.triangle..slot.triangle + size], shared, own);
        }
    }
}
