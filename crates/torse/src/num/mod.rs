//! Floor 0: numbers. Intervals, Bernstein form, roots, least squares, linear programs; knows no geometry.

pub(crate) mod bernstein;
pub(crate) mod binomial;
pub(crate) mod block_matrix;
pub mod gauss_newton;
pub(crate) mod golden_section;
pub(crate) mod greatest;
pub(crate) mod hash;
pub mod interval;
pub(crate) mod jet;
pub(crate) mod least_squares;
pub(crate) mod linear_program;
pub(crate) mod max_flow;
pub(crate) mod minimax;
pub(crate) mod minimax_program;
pub(crate) mod parallel;
pub mod quadratic_program;
pub mod quadrature;
pub(crate) mod roots;
pub(crate) mod runs;
pub(crate) mod series;
pub(crate) mod taylor_model;

#[cfg(test)]
mod laws;
