//! Coarse and fine: splines and support functions in nested spaces \[PW99, 4.5\].

pub mod trigonometric;
pub mod wavelets;
