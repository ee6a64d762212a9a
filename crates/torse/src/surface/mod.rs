//! Floor 3: the domain model. Input faces, developable surfaces (torses), panels and patchworks. Nothing iterates here.

pub mod convert;
pub mod area;
pub mod face;
pub mod panel;
pub mod pattern;
pub mod torse;
pub mod trim;
