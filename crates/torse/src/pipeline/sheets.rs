//! The answer of jobs whose results are untrimmed strips: everything that files and reports are made from.

use super::outcome::Status;
use crate::geom::Vec3;
use crate::surface::pattern::Pattern;
use crate::surface::strip::Strip;

/// How a number was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Shown for every point.
    Proven,
    /// The largest (or smallest) of samples.
    Measured,
    /// Asked for, counted or defined.
    Given,
}

impl Basis {
    /// Lower-case name used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Proven => "proven",
            Self::Measured => "measured",
            Self::Given => "given",
        }
    }
}

/// A named number with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Name, for people and as key: "deviation from rail A".
    pub name: String,
    /// Value; an infinite one stands for "none".
    pub value: f64,
    /// Unit ("mm", "rad", "mm²"); empty for plain numbers.
    pub unit: String,
    /// How it was found.
    pub basis: Basis,
}

impl Figure {
    /// A figure from its parts.
    pub fn new(name: impl Into<String>, value: f64, unit: &str, basis: Basis) -> Self {
        Self { name: name.into(), value, unit: unit.into(), basis }
    }
}

/// A curve to be seen with the strips: a rail, a given line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guide {
    /// Name.
    pub name: String,
    /// Points along it, mm.
    pub points: Vec<Vec3>,
}

/// Values on a grid of a strip, for colours; the strip's triangles follow the same grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StripField {
    /// Parameters of the rulings, increasing.
    pub u: Vec<f64>,
    /// Parameters along the rulings, increasing.
    pub v: Vec<f64>,
    /// Values, index `i * v.len() + j`.
    pub values: Vec<f64>,
}

/// Measured points with a value each, for a map of all of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointMap {
    /// Places, mm.
    pub places: Vec<Vec3>,
    /// Values, in the unit of the colours; one per place.
    pub values: Vec<f64>,
    /// Index of the point that is farthest from the strips.
    pub worst: Option<usize>,
}

/// What the colours mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldMeaning {
    /// Name: "deviation", "twist".
    pub name: String,
    /// Unit.
    pub unit: String,
    /// End of the scale.
    pub limit: f64,
}

/// One part as it is cut: consecutive strips that share rulings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlatPart {
    /// Name of the part.
    pub name: String,
    /// First strip.
    pub first: usize,
    /// Number of strips.
    pub count: usize,
    /// Why the part has no pattern; empty if it has one.
    pub missing: String,
}

/// The answer to a job that makes strips.
#[derive(Clone, Debug)]
pub struct Sheets {
    /// Name of the job: "loft", "hull", "fit", "cones".
    pub job: String,
    /// Name of the input, without folder.
    pub input: String,
    /// Tolerance asked for, mm.
    pub tolerance: f64,
    /// How the job ended.
    pub status: Status,
    /// Strips; neighbours within a part follow each other.
    pub strips: Vec<Strip>,
    /// Figures of each strip, the same names in the same order for all.
    pub strip_figures: Vec<Vec<Figure>>,
    /// Values for colours, one per strip; empty if there are none.
    pub fields: Vec<StripField>,
    /// Measured points; none for jobs that have no points.
    pub points: PointMap,
    /// What they mean.
    pub meaning: FieldMeaning,
    /// Parts, in the order of their strips.
    pub parts: Vec<FlatPart>,
    /// Flat patterns; `panel` is the index of the part.
    pub patterns: Vec<Pattern>,
    /// Rails and other given curves.
    pub guides: Vec<Guide>,
    /// Figures of the whole.
    pub figures: Vec<Figure>,
    /// What people should know, in plain sentences.
    pub notes: Vec<String>,
    /// Items of the input that could not be used, and why.
    pub skipped: Vec<String>,
    /// Wall time, seconds.
    pub seconds: f64,
}
