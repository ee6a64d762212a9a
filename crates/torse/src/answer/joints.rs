//! Joints between parts, told from the marks on their flat patterns.

use crate::patchwork::pattern::{MarkPlace, Pattern};
use std::collections::BTreeMap;

/// A joint: two borders of faces that meet, or both ends of one that is closed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct JointMarks {
    /// What its marks have in common: J3 of J3.1, J3.2, …
    pub name: String,
    /// Indices of the patterns on both sides; twice the same where a part is joined to itself.
    pub between: [usize; 2],
    /// Number of marks on either side.
    pub marks: usize,
}

/// The joints of which patterns carry marks, by their numbers.
pub(crate) fn joints(patterns: &[Pattern]) -> Vec<JointMarks> {
    let mut found: BTreeMap<(usize, &str), Vec<usize>> = BTreeMap::new();
    for (k, pattern) in patterns.iter().enumerate() {
        for mark in pattern.marks.iter().filter(|m| m.on == MarkPlace::Joint) {
            let name = mark.label.split_once('.').map_or(mark.label.as_str(), |l| l.0);
            // J2 before J10.
            found.entry((name.len(), name)).or_default().push(k);
        }
    }
    let joint = |((_, name), on): ((usize, &str), Vec<usize>)| {
        Some(JointMarks { name: name.into(), between: [*on.first()?, *on.last()?], marks: on.len().div_ceil(2) })
    };
    found.into_iter().filter_map(joint).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec2;
    use crate::patchwork::pattern::Mark;

    #[test]
    fn marks_with_one_name_are_one_joint() {
        let mark = |label: &str, on| Mark { point: Vec2::zeros(), inward: Vec2::x(), label: label.into(), on };
        let pattern = |labels: &[&str]| Pattern {
            marks: labels.iter().map(|l| mark(l, MarkPlace::Joint)).collect(),
            ..Pattern::default()
        };
        let mut first = pattern(&["J10.1", "J2.1", "J2.2"]);
        first.marks.push(mark("S1.1", MarkPlace::Seam));
        let found = joints(&[first, pattern(&["J2.1", "J2.2", "J3.1", "J3.1"]), pattern(&["J10.1"])]);
        let joint = |name: &str, between, marks| JointMarks { name: name.into(), between, marks };
        assert_eq!(found, [joint("J2", [0, 1], 2), joint("J3", [1, 1], 1), joint("J10", [0, 2], 1)]);
    }
}
