//! Floor 2: B-spline calculus. Knots, curves in any dimension, tensor-product surfaces polynomial and rational.

pub mod bezier;
pub(crate) mod blossom;
pub(crate) mod bounds;
pub(crate) mod composite;
pub mod curve;
pub mod derivative;
pub mod field;
pub(crate) mod image;
pub mod knots;
pub mod lsq;
pub(crate) mod pieces;
pub(crate) mod refine;
pub mod surface;
pub(crate) mod through;

#[cfg(test)]
pub(crate) mod sample;

/// Largest polynomial degree that the kernel evaluates (workspace lives on the stack).
pub(crate) const MAX_DEGREE: usize = 25;

/// Data that do not define a spline.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Degree zero or above `MAX_DEGREE`.
    #[error("degree {0} is outside 1..={MAX_DEGREE}")]
    Degree(usize),
    /// Number of knots does not fit number of control points and degree.
    #[error("{control} control points of degree {degree} need {} knots, but {knots} are given", control + degree + 1)]
    KnotCount {
        /// Number of knots given.
        knots: usize,
        /// Number of control points.
        control: usize,
        /// Degree.
        degree: usize,
    },
    /// Knots decrease or are not finite.
    #[error("knot {index} = {value} decreases or is not a finite number")]
    KnotOrder {
        /// Index into the knot vector.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// An interior knot is repeated more than degree times, or the domain is empty.
    #[error("knot value {value} occurs {multiplicity} times; at most {allowed} are allowed")]
    Multiplicity {
        /// Value of the knot.
        value: f64,
        /// Its multiplicity.
        multiplicity: usize,
        /// Largest allowed multiplicity.
        allowed: usize,
    },
    /// Control point or weight is not finite, or a weight is not positive.
    #[error("control point {index}: {reason}")]
    Control {
        /// Index of the control point.
        index: usize,
        /// What is wrong.
        reason: String,
    },
}
