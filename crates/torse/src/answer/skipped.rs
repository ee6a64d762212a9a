//! What is missing from an answer.

use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::certify::claim::Claim;

/// A face of the input, or another item of it, that is missing from the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// Number of the entity in a CAD file: of a record in STEP, of a directory entry in IGES, of the face counted through a
    /// Rhino archive.
    pub entity: Option<u64>,
    /// Why, and what would help.
    pub reason: String,
    /// Area (mm²) of all its occurrences, as far as surface or edges tell; `None` if unknown.
    pub area_estimate: Option<f64>,
}

impl Skipped {
    /// A face or item of a CAD file.
    pub fn of_file(entity: u64, reason: impl Into<String>, area_estimate: Option<f64>) -> Self {
        Self { entity: Some(entity), reason: reason.into(), area_estimate }
    }

    /// A face that is left out for a reason, with the faces of the file that are one with it.
    pub fn of_face(face: &Face, reason: String) -> Self {
        let others: Vec<String> = face.parts.iter().skip(1).map(|p| format!("#{}", p.entity)).collect();
        let reason = if others.is_empty() { reason } else { format!("{reason} (joined with {})", others.join(", ")) };
        let area_estimate = Some(area_estimate(face)).filter(|a| a.is_finite() && *a > 0.0);
        Self::of_file(face.entity, reason, area_estimate)
    }

    /// As [`Skipped::of_face`], at once: the face's area is not looked at.
    pub(crate) fn in_haste(face: &Face, reason: &str) -> Self {
        Self::of_file(face.entity, reason, None)
    }

    /// Name of the item in front of the reason.
    pub fn words(&self) -> String {
        match self.entity {
            Some(entity) => format!("#{entity}: {}", self.reason),
            None => self.reason.clone(),
        }
    }
}

impl From<String> for Skipped {
    /// An item that the words name.
    fn from(reason: String) -> Self {
        Self { entity: None, reason, area_estimate: None }
    }
}

/// What is missing from an answer, as an objection: such an answer is never certified, however good the rest is. `None`
/// if nothing is missing.
pub fn left_out(skipped: &[Skipped]) -> Option<Claim> {
    let first = skipped.first()?;
    let (what, more) = match skipped.len() {
        1 => ("1 face or item of the file is".to_string(), ""),
        n => (format!("{n} faces or items of the file are"), ", the first"),
    };
    let known: f64 = skipped.iter().filter_map(|s| s.area_estimate).sum();
    let known = if known < 100.0 { format!("{known:.4}") } else { format!("{known:.0}") };
    let area = match skipped.iter().filter(|s| s.area_estimate.is_none()).count() {
        0 => format!("about {known} mm²"),
        n if n == skipped.len() => "of unknown area".to_string(),
        n => format!("about {known} mm², {n} of them of unknown area"),
    };
    Some(Claim::left_out(format!("{what} left out ({area}){more} {}", first.words())))
}
