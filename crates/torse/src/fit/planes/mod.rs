//! Developables near given tangent planes: linear systems, parameters, knots, wavelets, and regression curves kept away
//! \[PW99\].

pub(in crate::fit) mod blocks;
pub mod correction;
pub mod estimates;
pub mod frame;
pub(in crate::fit) mod functionals;
pub mod knot_choice;
pub mod linear_system;
pub mod multiresolution;
pub mod reduce;
pub mod regression;
pub(in crate::fit) mod regularity_margin;
pub mod rulings;

pub use functionals::Freedom;
