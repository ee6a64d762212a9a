//! Floor 6: development, the isometric map of a panel to the plane.

pub mod arcs;
pub mod bends;
pub(crate) mod between;
pub(crate) mod carried;
pub(crate) mod cone_bends;
pub(crate) mod cone_part;
pub mod cones;
pub(crate) mod joints;
pub mod layout;
pub mod map;
pub(crate) mod marked;
pub(crate) mod mesh_border;
pub(crate) mod outline;
pub(crate) mod overlap;
pub mod pattern;
pub mod refold;
pub(crate) mod same;
pub(crate) mod scanned;
pub mod shop;
pub(crate) mod smooth_ends;
pub mod strip;
pub mod unfold;
pub mod view;

/// Why a panel has no flat pattern.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DevelopError {
    /// A ruling without length, or the regression curve inside the patch.
    #[error("the patch is not regular at t = {t}")]
    Irregular {
        /// Ruling concerned.
        t: f64,
    },
    /// The flat pattern overlaps itself.
    #[error("the flat pattern overlaps itself; cutting the panel along the ruling t = {t} would separate the overlapping parts")]
    Overlap {
        /// Ruling to cut along.
        t: f64,
    },
    /// Neighbouring strips of one piece do not share a ruling.
    #[error("strip {strip} of piece {piece} begins {gap} mm from the ruling that ends the strip before; order the strips along the rails")]
    Apart {
        /// Index of the piece.
        piece: usize,
        /// Name of the strip.
        strip: String,
        /// Distance, mm.
        gap: f64,
    },
    /// There is no such panel, or it has no boundary.
    #[error("panel {0} does not exist or has no boundary")]
    Missing(usize),
}

#[cfg(test)]
mod laws;
