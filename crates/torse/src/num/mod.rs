//! Floor 0: numbers. Intervals, Bernstein form, roots, least squares, linear programs; knows no geometry.

pub mod binomial;
pub mod interval;
pub mod least_squares;
pub mod quadrature;
