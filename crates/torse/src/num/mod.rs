//! Floor 0: numbers. Intervals, Bernstein form, roots, least squares, linear programs; knows no geometry.

pub mod bernstein;
pub mod interval;
pub mod linear_program;
pub mod least_squares;
pub mod minimax;
pub mod max_flow;
pub mod binomial;
pub mod quadrature;
pub mod jet;
