//! The answer of jobs whose results are untrimmed strips: everything that files and reports are made from.

use crate::certify::claim::{Claim, Status, Subject, What};
use crate::geom::Vec3;
use crate::patchwork::pattern::Pattern;
use crate::torse::strip::Strip;

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
    /// What is said of the whole and of single strips; the status is computed from these.
    pub claims: Vec<Claim>,
    /// Strips; neighbours within a part follow each other.
    pub strips: Vec<Strip>,
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
    /// What people should know, in plain sentences.
    pub notes: Vec<String>,
    /// Items of the input that could not be used, and why.
    pub skipped: Vec<String>,
    /// Wall time, seconds.
    pub seconds: f64,
}

impl Sheets {
    /// How the job ended.
    pub fn status(&self) -> Status {
        Status::of(&self.claims)
    }

    /// What is said of the whole or of a strip, without objections.
    pub fn claims_of(&self, subject: Subject) -> impl Iterator<Item = &Claim> {
        self.claims
            .iter()
            .filter(move |c| c.subject() == subject && !matches!(c.what(), What::Objection | What::LeftOut))
    }

    /// The claim about something of the whole, if there is one.
    pub fn claim(&self, what: What) -> Option<&Claim> {
        self.claims_of(Subject::Whole).find(|c| c.what() == what)
    }
}
