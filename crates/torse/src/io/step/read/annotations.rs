//! Annotations of a STEP file, which are on no face: counted by kinds.

use super::records::Records;
use crate::io::model::not_carried;
use std::collections::HashSet;

/// Keywords with what people call them, the more special ones first: a record may have several.
const KINDS: [(&[&str], &str, &str); 7] = [
    (
        &[
            "TEXT_LITERAL",
            "TEXT_LITERAL_WITH_ASSOCIATED_CURVES",
            "TEXT_LITERAL_WITH_BLANKING_BOX",
            "TEXT_LITERAL_WITH_DELINEATION",
            "TEXT_LITERAL_WITH_EXTENT",
        ],
        "text",
        "texts",
    ),
    (&["TESSELLATED_ANNOTATION_OCCURRENCE"], "drawn annotation", "drawn annotations"),
    (&["LEADER_CURVE"], "leader line", "leader lines"),
    (&["DIMENSION_CURVE", "PROJECTION_CURVE"], "dimension line", "dimension lines"),
    (&["ANNOTATION_SYMBOL_OCCURRENCE"], "symbol", "symbols"),
    (&["ANNOTATION_FILL_AREA_OCCURRENCE"], "filled area", "filled areas"),
    (&["ANNOTATION_CURVE_OCCURRENCE"], "annotation line", "annotation lines"),
];

/// What is said of them; nothing where there are none.
pub(super) fn told(records: &Records) -> Option<String> {
    let mut seen = HashSet::new();
    let mut count = |keywords: &[&str]| records.all(keywords).into_iter().filter(|id| seen.insert(*id)).count();
    not_carried(&KINDS.map(|(keywords, one, many)| (count(keywords), one, many)))
}
