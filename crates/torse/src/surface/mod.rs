//! Floor 3: the domain model. Input faces, developable surfaces (torses), panels and patchworks. Nothing iterates here.

pub mod area;
pub mod clip;
pub mod cone_distance;
pub mod cone_forms;
pub mod cone_pair;
pub mod cone_spline;
pub mod convert;
pub mod dual;
pub mod face;
pub mod g1_element;
mod hug;
pub mod net;
pub mod panel;
pub mod pattern;
pub mod rail;
pub mod ruled_strip;
pub mod seam;
pub mod strip;
pub mod torse;
pub mod trim;
