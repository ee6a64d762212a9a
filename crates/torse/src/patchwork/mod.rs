//! Floor 4: a whole in pieces. The partition of a face's parameter domain, the panels that stand for its regions, the
//! seams between them, and the drawing of a panel in the plane.

pub(crate) mod clip;
pub(crate) mod foot_map;
#[cfg(test)]
pub(crate) mod generated;
pub mod image;
pub(crate) mod joint;
pub(crate) mod outside;
pub mod panel;
pub mod part;
pub mod partition;
pub mod pattern;
pub(crate) mod redraw;
pub mod seam;
pub mod shell_surface;
pub(crate) mod skins;
pub(crate) mod smooth_seams;
pub mod triangulate;
pub mod written;

#[cfg(test)]
mod laws;
