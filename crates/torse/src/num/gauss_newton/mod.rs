//! Guided projection: a damped Gauss–Newton method for many small groups of equations \[W15\].
//!
//! The solver knows unknowns, rows and energies, and nothing of what they mean. Hard rows must vanish, soft rows pull
//! with a weight, fairness rows regularise with a factor that falls from step to step. Each step solves for the
//! increment of the unknowns, never for their new values; unknowns that belong to one group of rows only are eliminated
//! there; the structure of the matrix is found once and kept. See `docs/algorithms/constraint.md`.

pub(crate) mod block;
mod elimination;
mod normal_matrix;
mod order;
mod polish;
mod solver;
mod sparse;
pub(crate) mod status;
pub mod system;
#[cfg(test)]
mod tests;

pub(crate) use block::{Block, Role};
pub(crate) use solver::{Kept, Schedule, Solver};
pub use status::{Outcome, Status};
pub(crate) use system::System;
