//! Strips that are proposed and judged for lofts, sequences of elements, given faces and cone splines.

pub(crate) mod assessment;
pub(crate) mod cone_body;
pub(crate) mod cone_outline;
pub(crate) mod cone_strip;
pub mod cut;
pub(crate) mod exact_chain;
pub(crate) mod exact_strip;
pub(crate) mod face_panel;
pub(crate) mod fewest;
pub(crate) mod given_outline;
pub(crate) mod hull_followed;
pub(crate) mod hull_kept;
pub(crate) mod hull_whole;
pub(crate) mod loft_ends;
pub(crate) mod regression;
pub(crate) mod ruled_face;
pub(crate) mod scan;
pub(crate) mod scan_outline;
pub(crate) mod sequences;
