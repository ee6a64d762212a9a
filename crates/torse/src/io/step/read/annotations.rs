//! Annotations of a STEP file, which are on no face: counted by kinds.

use super::records::Records;
use crate::answer::note::reader::{AnnotationKind, ReaderNote};
use crate::io::model::not_carried;
use std::collections::HashSet;

/// Keywords of the kinds, the more special ones first: a record may have several.
const KINDS: [(&[&str], AnnotationKind); 7] = [
    (
        &[
            "TEXT_LITERAL",
            "TEXT_LITERAL_WITH_ASSOCIATED_CURVES",
            "TEXT_LITERAL_WITH_BLANKING_BOX",
            "TEXT_LITERAL_WITH_DELINEATION",
            "TEXT_LITERAL_WITH_EXTENT",
        ],
        AnnotationKind::Text,
    ),
    (&["TESSELLATED_ANNOTATION_OCCURRENCE"], AnnotationKind::Drawn),
    (&["LEADER_CURVE"], AnnotationKind::LeaderLine),
    (&["DIMENSION_CURVE", "PROJECTION_CURVE"], AnnotationKind::DimensionLine),
    (&["ANNOTATION_SYMBOL_OCCURRENCE"], AnnotationKind::Symbol),
    (&["ANNOTATION_FILL_AREA_OCCURRENCE"], AnnotationKind::FilledArea),
    (&["ANNOTATION_CURVE_OCCURRENCE"], AnnotationKind::Line),
];

/// What is said of them; nothing where there are none.
pub(super) fn told(records: &Records) -> Option<ReaderNote> {
    let mut seen = HashSet::new();
    let mut count = |keywords: &[&str]| records.all(keywords).into_iter().filter(|id| seen.insert(*id)).count();
    not_carried(KINDS.map(|(keywords, kind)| (kind, count(keywords))))
}
