//! Floor 3: the domain model. Input faces, developable surfaces (torses), panels and patchworks. Nothing iterates here.

pub mod area;
pub mod clip;
pub mod convert;
pub mod dual;
pub mod face;
mod hug;
pub mod panel;
pub mod pattern;
pub mod rail;
pub mod strip;
pub mod torse;
pub mod trim;
