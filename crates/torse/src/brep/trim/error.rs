//! Why a face has no region.

use crate::geom::Vec3;
use crate::spline::SplineError;

/// Why loops do not bound a region of their surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrimError {
    /// The surface is endless and no loop bounds the region.
    #[error("the face has no boundary, and its surface does not end by itself")]
    Unbounded,
    /// Loops wind around a closed surface without bounding a region.
    #[error("the boundary winds around the closed surface but does not enclose a region: a boundary loop is missing")]
    OpenWinding,
    /// Loops that leave the other side of a surface that closes up to rounding.
    #[error(
        "its boundary is that of a hole, but the surface does not quite close around it, so that both sides may be meant: \
         write the surface with more digits, or the face in two"
    )]
    EitherSide,
    /// A loop is shorter than can be told from a point.
    #[error("every boundary loop is shorter than {0:.3e} mm: the face has no area")]
    Vanishing(f64),
    /// Consecutive edges do not meet.
    #[error("the boundary is open: edges #{before} and #{after} end {gap:.3e} mm apart")]
    Gap {
        /// Edge before the gap.
        before: u64,
        /// Edge after the gap.
        after: u64,
        /// Width of the gap, mm.
        gap: f64,
    },
    /// Boundary curves far from the surface.
    #[error("edge #{edge} runs {distance:.3e} mm away from the surface of its face")]
    OffSurface {
        /// The edge.
        edge: u64,
        /// Distance, mm.
        distance: f64,
    },
    /// The boundary crosses or touches itself.
    #[error("the boundary crosses or touches itself near ({:.6}, {:.6}, {:.6}) mm", .0.x, .0.y, .0.z)]
    SelfTouching(Vec3),
    /// The region has no area.
    #[error("the boundary encloses no area")]
    NoArea,
    /// The boundary needs too many chords.
    #[error("the boundary would need more than {0} chords; a coarser chord tolerance would help")]
    TooFine(usize),
    /// The support is not usable.
    #[error("the surface is not usable: {0}")]
    Surface(#[from] SplineError),
}
