//! Developables near elements in order: rulings, tangent planes, both; cone splines; what they consist of.

pub mod cones;
pub mod decompose;
pub mod extent;
pub(crate) mod gaps;
pub(crate) mod given;
pub(crate) mod outliers;
pub(crate) mod ruling_order;
pub mod sequence;
pub mod span_series;
