//! Floor 0: numbers. Intervals, Bernstein form, roots, least squares, linear programs; knows no geometry.

pub mod bernstein;
pub mod interval;
pub mod jet;
