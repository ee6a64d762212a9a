//! Strips that are proposed and judged for lofts, rows of elements, given faces and cone splines.

pub mod cone_body;
pub mod cone_outline;
pub mod cone_strip;
pub mod cut;
pub mod exact_chain;
pub mod exact_strip;
pub mod face_panel;
pub mod fewest;
pub mod hull_kept;
pub mod judgement;
pub mod loft_ends;
pub mod regression;
pub mod rows;
pub mod ruled_face;
pub mod scan;
pub mod scan_outline;
