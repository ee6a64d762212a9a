//! Cones, cylinders and planes in chains with common tangent planes: cone splines \[LP98\], their exact patches, their
//! charts, and parts cut from them.

pub mod chart;
pub(crate) mod distance;
pub mod forms;
pub mod pair;
pub mod part;
pub mod spline;
