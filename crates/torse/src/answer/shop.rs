//! What a shop is told besides the flat patterns.

use crate::develop::shop::bevel::SeamBevel;
use crate::develop::shop::facets::Faceted;
use crate::develop::shop::material::Material;
use crate::develop::shop::offsets::OffsetPanel;
use crate::develop::shop::roll::RollStation;
use crate::develop::shop::thickness::PartSheet;

/// Sheet and work of an answer.
#[derive(Clone, Debug, Default)]
pub struct Shop {
    /// What the sheet is made of.
    pub material: Option<Material>,
    /// Thickness (mm) of parts whose input has none of its own.
    pub thickness: Option<f64>,
    /// What is known of the work on each pattern, in their order; empty before anything was asked.
    pub work: Vec<PartWork>,
    /// Bevels along seams between panels.
    pub bevels: Vec<SeamBevel>,
    /// Surfaces of the sheet in space, where they were asked for.
    pub offsets: Vec<OffsetFile>,
}

/// A surface of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OffsetSide {
    /// Its inside, as seen from the model.
    Inside,
    /// The neutral fibre of its bends.
    Neutral,
    /// Its outside.
    Outside,
}

impl OffsetSide {
    /// All of them, from the inside outwards.
    pub const ALL: [Self; 3] = [Self::Inside, Self::Neutral, Self::Outside];

    /// Name of its file.
    pub fn file(self) -> &'static str {
        match self {
            Self::Inside => "inside.step",
            Self::Neutral => "neutral.step",
            Self::Outside => "outside.step",
        }
    }
}

/// One surface of the sheet beside all panels that have it.
#[derive(Clone, Debug)]
pub struct OffsetFile {
    /// Which.
    pub side: OffsetSide,
    /// The panels moved there.
    pub panels: Vec<OffsetPanel>,
}

/// The work on one part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartWork {
    /// Radii along the part; empty for flat parts and where the panels' own maps are not those of the pattern.
    pub roll: Vec<RollStation>,
    /// Its kinks, if it is to be kinked.
    pub faceted: Option<Faceted>,
    /// Names of its panels, or faces, which stations of rolling and kinks count.
    pub panels: Vec<String>,
    /// What the thickness makes of it, if one was given.
    pub sheet: Option<PartSheet>,
}

/// Name of a face of a part that is laid flat by its faces, which its panel has too; counted from 0.
pub(crate) fn face_name(part: &str, face: usize) -> String {
    format!("{part}-{:02}", face + 1)
}
