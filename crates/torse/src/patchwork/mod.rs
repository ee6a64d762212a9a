//! Floor 4: a whole in pieces. The partition of a face's parameter domain, the panels that stand for its regions, the
//! seams between them, and the drawing of a panel in the plane.

pub mod clip;
pub mod image;
pub mod joint;
pub mod outside;
pub mod panel;
pub mod part;
pub mod partition;
pub mod pattern;
pub mod seam;
pub mod skins;
pub mod smooth_seams;
pub mod triangulate;
pub mod written;
