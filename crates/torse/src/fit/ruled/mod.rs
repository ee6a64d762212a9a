//! Ruled strips near a face, with rulings along its asymptotic curves; in general not developable.

pub(crate) mod chart;
pub mod directions;
pub(crate) mod solve;
pub(crate) mod strip_map;
pub(crate) mod tensor_fit;
