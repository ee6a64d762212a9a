//! What is asked of sheet and work, and why it cannot be had.

use crate::develop::shop::material::Material;
use crate::develop::shop::thickness::{Sheet, SheetSide};
use crate::develop::unfold::allowance::{KFactor, KFactorError};
use crate::geom::Vec3;
use crate::search::cover::Limits;

/// Most sections of one direction.
pub(super) const MOST_PLANES: usize = 1000;

/// What is asked of sheet and work.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkshopOptions {
    /// What the sheet is made of; default nothing is said.
    pub material: Option<Material>,
    /// Thickness of the sheet, mm; default none.
    pub thickness: Option<f64>,
    /// Which side of the sheet the panels are; default its middle.
    pub side: SheetSide,
    /// Where the neutral fibre lies; default what the material says, else in the middle.
    pub k: Option<KFactor>,
    /// Whether the lines drawn are kinks for a press brake; default no.
    pub kinked: bool,
    /// Planes whose sections are marked; default none.
    pub stations: Vec<Stations>,
    /// Whether the sides of the sheet and its neutral surface are written; default no.
    pub offsets: bool,
    /// Limits of the sheet that patterns of the neutral fibre are to keep, too; default none.
    pub limits: Limits,
}

/// Parallel planes.
#[derive(Clone, Debug, PartialEq)]
pub struct Stations {
    /// Unit normal.
    pub normal: Vec3,
    /// Name of the direction, before the number in labels.
    pub name: String,
    /// Distance of the first plane from the origin, mm; infinite: the first multiple of the step that meets the model.
    pub from: f64,
    /// And of the last one; infinite: as far as the model goes.
    pub to: f64,
    /// Distance between planes, mm.
    pub step: f64,
}

/// Why sheet and work cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorkshopError {
    /// A thickness that is none.
    #[error("the thickness {0} is not a positive number of mm")]
    Thickness(f64),
    /// A K-factor that cannot be meant.
    #[error(transparent)]
    KFactor(#[from] KFactorError),
    /// A neutral fibre without a sheet to lie in.
    #[error("a K-factor says where in the sheet the neutral fibre lies, but nothing here has a thickness")]
    NoSheet,
    /// Planes that the model does not meet.
    #[error("no plane {name} from {from} to {to} mm meets the model, which lies between {lo:.3} and {hi:.3} mm")]
    Nowhere {
        /// Name of the direction.
        name: String,
        /// First place asked for.
        from: f64,
        /// Last place.
        to: f64,
        /// Where the model begins.
        lo: f64,
        /// Where it ends.
        hi: f64,
    },
    /// More planes than anybody can use.
    #[error("a step of {step} mm makes {count:.0} sections across the model; {MOST_PLANES} are allowed")]
    TooMany {
        /// The step, mm.
        step: f64,
        /// How many that would be.
        count: f64,
    },
}

impl WorkshopOptions {
    /// The sheet that covers are made of, if a thickness is given.
    pub fn sheet(&self) -> Option<Sheet> {
        let of_material = || self.material.as_ref().and_then(|m| m.k.clone());
        let k = self.k.clone().or_else(of_material).unwrap_or(KFactor::Ansi(0.5));
        Some(Sheet { thickness: self.thickness?, side: self.side, k })
    }

    /// Least radius (mm) of panels that a sheet of the material and thickness can follow; `None` where nothing is known.
    pub fn least_panel_radius(&self) -> Option<f64> {
        let sheet = self.sheet()?;
        let least = self.material.as_ref().and_then(|m| m.least_radius).map_or(0.0, |r| r.of(sheet.thickness));
        Some(least + sheet.greatest_depth()).filter(|r| *r > 0.0)
    }
}
