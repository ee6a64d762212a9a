//! Floor 3: every exact developable. Torses in three exact forms ([`form`]), curves in dual space ([`dual`]), B-spline
//! developables through control nets ([`net`]), cone splines ([`cone`]), strips between rails ([`strip`]), strips of
//! plane quadrilaterals ([`quad_strip`]), and what people call their kinds ([`kind`]).
//!
//! What iterates here looks for the roots and best values that a form has by itself: parameters of a given plane, free numbers
//! of a net, rulings that keep within given lengths. Nothing is known of the faces that a torse is to approximate.

pub mod cone;
pub mod contact;
pub mod convert;
pub mod dual;
pub mod envelope_point;
pub mod form;
pub mod g1_element;
pub mod kind;
pub mod net;
mod patch_extent;
pub mod quad_strip;
pub mod rail;
pub mod ribbon;
pub mod ruled_patch;
pub mod ruled_point;
pub mod strip;
pub mod zone;
