//! What is missing from an answer.

use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::certify::claim::Claim;
use crate::reason::{FaceReason, Reason};

/// A face of the input, or another item of it, that is missing from the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// Number of the entity in a CAD file: of a record in STEP, of a directory entry in IGES, of the face counted through a
    /// Rhino archive.
    pub entity: Option<u64>,
    /// Why, and what would help.
    pub reason: Reason,
    /// Area (mm²) of all its occurrences, as far as surface or edges tell; `None` if unknown.
    pub area_estimate: Option<f64>,
}

impl Skipped {
    /// A face or item of a CAD file.
    pub(crate) fn of_file(entity: u64, reason: impl Into<Reason>, area_estimate: Option<f64>) -> Self {
        Self { entity: Some(entity), reason: reason.into(), area_estimate }
    }

    /// A face that is left out for a reason, with the faces of the file that are one with it.
    pub(crate) fn of_face(face: &Face, reason: impl Into<Reason>) -> Self {
        let others: Vec<u64> = face.parts.iter().skip(1).map(|p| p.entity).collect();
        let reason = match others.is_empty() {
            true => reason.into(),
            false => FaceReason::Joined(Box::new(reason.into()), others).into(),
        };
        let area_estimate = Some(area_estimate(face)).filter(|a| a.is_finite() && *a > 0.0);
        Self::of_file(face.entity, reason, area_estimate)
    }

    /// As [`Skipped::of_face`], at once: the face's area is not looked at.
    pub(crate) fn in_haste(face: &Face, reason: FaceReason) -> Self {
        Self::of_file(face.entity, reason, None)
    }
}

impl<R: Into<Reason>> From<R> for Skipped {
    /// An item that the reason names.
    fn from(reason: R) -> Self {
        Self { entity: None, reason: reason.into(), area_estimate: None }
    }
}

/// What is missing from an answer, as an objection: such an answer is never certified, however good the rest is. `None`
/// if nothing is missing.
pub(crate) fn left_out(skipped: &[Skipped]) -> Option<Claim> {
    let first = skipped.first()?;
    Some(Claim::left_out(FaceReason::LeftOut {
        count: skipped.len(),
        area_estimate: skipped.iter().filter_map(|s| s.area_estimate).sum(),
        unknown: skipped.iter().filter(|s| s.area_estimate.is_none()).count(),
        entity: first.entity,
        first: Box::new(first.reason.clone()),
    }))
}
