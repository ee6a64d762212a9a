//! Floor 0: numbers. Intervals, Bernstein form, roots, least squares, linear programs; knows no geometry.

pub mod bernstein;
pub mod binomial;
pub mod block_matrix;
pub mod gauss_newton;
pub mod greatest;
pub mod interval;
pub mod jet;
pub mod least_squares;
pub mod linear_program;
pub mod max_flow;
pub mod minimax;
pub mod minimax_program;
pub mod quadratic_program;
pub mod quadrature;
pub mod roots;
pub mod series;
