//! Notes of sheet and work.

pub(crate) use crate::answer::shop::OffsetSide;
pub(crate) use crate::develop::shop::material::LeastRadius;
pub use crate::develop::shop::material::Material;
pub(crate) use crate::develop::shop::offsets::NoOffset;
pub use crate::develop::shop::thickness::Sheet;
pub(crate) use crate::develop::shop::thickness::TooTight;

/// Something that people should know of sheet and work.
#[derive(Clone, Debug, PartialEq)]
pub enum ShopNote {
    /// The material that was asked for.
    Material(Material),
    /// The sheet beside the panels.
    Sheet(Sheet),
    /// Flat patterns of the neutral fibre.
    Neutral {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// Flat patterns of the neutral fibre of a sheet that surfaces were given, proven as such.
    OfFibre {
        /// Names of the parts.
        parts: Vec<String>,
        /// The sheet.
        sheet: Sheet,
    },
    /// Parts whose faces have maps that do not fit what is drawn: their work is not known.
    NoPlaces {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// Flat patterns of the panels, not of the neutral fibre, although that lies beside them.
    NotNeutral {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// A part that is bent too tightly.
    TooTight {
        /// Name of the part.
        part: String,
        /// Why.
        tight: TooTight,
    },
    /// Parts that are kinked in place of being rolled.
    Kinked {
        /// How far they come to lie from the curved ones, mm, sampled.
        displacement_estimate: f64,
    },
    /// Parts that are kinked in place of being rolled, whose neutral fibre is not at one distance from their faces: how far they come to
    /// lie from the curved ones is not known.
    KinkedFibre {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// Parts drawn from other surfaces than their panels: their work is not known.
    Unknown {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// Surfaces of the sheet are written.
    Offsets {
        /// Largest distance (mm) of their edges from where they belong, measured.
        edge_error: f64,
    },
    /// A panel of which a surface of the sheet is not written: it is not regular.
    NoOffset {
        /// Name of the panel.
        panel: String,
        /// Which surface.
        side: OffsetSide,
        /// Where, and why.
        none: NoOffset,
    },
    /// Parts of which no surfaces of the sheet are written: bodies that have them, and faces without a panel.
    NoOffsets {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// Parts whose neutral surface is not at one distance from the panels.
    NeutralVaries {
        /// Names of the parts.
        parts: Vec<String>,
    },
    /// Chains of cones have their surfaces in a file of their own.
    OffsetsOfCones,
}
