//! Annotations of an IGES file: the strings of its notes, where they stand, and what else there is, counted by kinds.

use super::placing;
use super::records::{Entry, Fault, Records};
use crate::answer::note::reader::{AnnotationKind, ReaderNote};
use crate::brep::free_curve::FreeShape;
use crate::geom::Vec3;
use crate::io::model::not_carried;

/// Type of general notes.
pub(super) const NOTE: u32 = 212;

/// Types of the kinds.
const KINDS: [(&[u32], AnnotationKind); 6] = [
    (&[214], AnnotationKind::LeaderLine),
    (&[202, 204, 206, 216, 218, 220, 222], AnnotationKind::Dimension),
    (&[208, 210], AnnotationKind::Label),
    (&[NOTE, 213], AnnotationKind::Note),
    (&[228], AnnotationKind::Symbol),
    (&[230], AnnotationKind::FilledArea),
];

/// Fields of a string of a note.
const FIELDS: usize = 12;
/// Strings of a note at most.
const MOST_STRINGS: usize = 10_000;

/// Whether a note stands for itself and is shown.
pub(super) fn is_text(e: &Entry) -> bool {
    e.kind == NOTE && !e.blanked && !e.dependent
}

/// What is said of those that are not read; nothing where there are none.
pub(super) fn told(records: &Records) -> Option<ReaderNote> {
    let left = |e: &&Entry| !e.blanked && !is_text(e);
    let count = |kinds: &[u32]| records.all().filter(left).filter(|e| kinds.contains(&e.kind)).count();
    not_carried(KINDS.map(|(types, kind)| (kind, count(types))))
}

/// The strings of a note with their places, in the numbers of the file.
pub(super) fn texts(records: &Records, e: &Entry) -> Result<Vec<(String, FreeShape)>, Fault> {
    let place = placing::of_entry(records, e)?;
    let count = e.count(1)?.min(MOST_STRINGS);
    let string = |k: usize| -> Result<(String, FreeShape), Fault> {
        let first = 2 + k * FIELDS;
        let [height, angle, mirrored] = [e.number(first + 2)?, e.number(first + 5)?, e.number(first + 6)?];
        let [x, y, z] = [8, 9, 10].map(|d: usize| e.number(first + d));
        let (sin, cos) = angle.sin_cos();
        let way = |v: Vec3| place.linear * v;
        // Mirrored about the line square to the text, or about the base line.
        let (flip, turn) = (if mirrored == 1.0 { -1.0 } else { 1.0 }, if mirrored == 2.0 { -1.0 } else { 1.0 });
        let (along, up) = (way(Vec3::new(cos, sin, 0.0)) * flip, way(Vec3::new(-sin, cos, 0.0)) * (height * turn));
        let shape = FreeShape::Text { at: place.point(&Vec3::new(x?, y?, z?)), along, up };
        Ok((e.text(first + 11).to_owned(), shape))
    };
    (0..count).map(string).collect()
}
