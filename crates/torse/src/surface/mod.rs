//! Floor 3: the domain model. Input faces, developable surfaces (torses), panels and patchworks. Nothing iterates here.

pub mod area;
pub mod clip;
pub mod cone_chart;
pub mod cone_distance;
pub mod cone_forms;
pub mod cone_pair;
pub mod cone_part;
pub mod cone_spline;
pub mod convert;
pub mod dual;
pub mod envelope_point;
pub mod face;
pub mod g1_element;
mod hug;
pub mod net;
pub mod panel;
pub mod pattern;
pub mod plane_row;
pub mod quad_strip;
pub mod rail;
pub mod ruled_point;
pub mod ruled_strip;
pub mod seam;
pub mod shape_run;
pub mod strip;
pub mod torse;
pub mod trim;
