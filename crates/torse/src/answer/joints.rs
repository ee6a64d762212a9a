//! Joints between parts, told from the marks on their flat patterns.

use super::note::Note;
use crate::patchwork::pattern::{MarkPlace, Pattern};
use std::collections::BTreeMap;

/// A joint: two borders of faces that meet, or both ends of one that is closed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointMarks {
    /// What its marks have in common: J3 of J3.1, J3.2, …
    pub name: String,
    /// Indices of the patterns on both sides; twice the same where a part is joined to itself.
    pub between: [usize; 2],
    /// Number of marks on either side.
    pub marks: usize,
    /// Largest distance (mm) in space of two marks that belong together.
    pub gap_estimate: f64,
}

/// The joints of which patterns carry marks, by their numbers.
pub(crate) fn joints(patterns: &[Pattern]) -> Vec<JointMarks> {
    let mut found: BTreeMap<(usize, &str), Vec<(usize, f64)>> = BTreeMap::new();
    for (k, pattern) in patterns.iter().enumerate() {
        for mark in pattern.marks.iter().filter(|m| m.on == MarkPlace::Joint) {
            let name = mark.label.split_once('.').map_or(mark.label.as_str(), |l| l.0);
            // J2 before J10.
            found.entry((name.len(), name)).or_default().push((k, mark.apart));
        }
    }
    let joint = |((_, name), on): ((usize, &str), Vec<(usize, f64)>)| {
        let between = [on.first()?.0, on.last()?.0];
        let gap_estimate = on.iter().map(|m| m.1).fold(0.0, f64::max);
        Some(JointMarks { name: name.into(), between, marks: on.len().div_ceil(2), gap_estimate })
    };
    found.into_iter().filter_map(joint).collect()
}

/// Gaps below this share of the tolerance are none to speak of.
const MEETS: f64 = 0.01;

/// The joint with the largest gap, if it is one; `tolerance` in mm.
pub(crate) fn apart(patterns: &[Pattern], tolerance: f64) -> Option<Note> {
    let widest = joints(patterns).into_iter().max_by(|a, b| a.gap_estimate.total_cmp(&b.gap_estimate))?;
    let JointMarks { name: joint, between, gap_estimate, .. } = widest;
    let between = between.map(|k| patterns[k].name.clone());
    (gap_estimate > MEETS * tolerance).then_some(Note::Apart { joint, between, gap_estimate })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec2;
    use crate::patchwork::pattern::Mark;

    #[test]
    fn marks_with_one_name_are_one_joint() {
        let mark =
            |label: &str, on| Mark { point: Vec2::zeros(), inward: Vec2::x(), label: label.into(), on, apart: 0.25 };
        let pattern = |labels: &[&str]| Pattern {
            marks: labels.iter().map(|l| mark(l, MarkPlace::Joint)).collect(),
            ..Pattern::default()
        };
        let mut first = pattern(&["J10.1", "J2.1", "J2.2"]);
        first.marks.push(mark("S1.1", MarkPlace::Seam));
        let found = joints(&[first, pattern(&["J2.1", "J2.2", "J3.1", "J3.1"]), pattern(&["J10.1"])]);
        let joint = |name: &str, between, marks| JointMarks { name: name.into(), between, marks, gap_estimate: 0.25 };
        let widest = apart(&[pattern(&["J2.1"]), pattern(&["J2.1"])], 1.0);
        assert!(matches!(widest, Some(Note::Apart { gap_estimate, .. }) if gap_estimate == 0.25));
        assert_eq!(apart(&[pattern(&["J2.1"]), pattern(&["J2.1"])], 100.0), None);
        assert_eq!(found, [joint("J2", [0, 1], 2), joint("J3", [1, 1], 1), joint("J10", [0, 2], 1)]);
    }
}
