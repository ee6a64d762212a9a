//! Which parts must not be cut: the one place where that is decided, for every file, picture and report.

use super::{Answer, Job};
use crate::certify::claim::{Claim, Subject, What};
use crate::patchwork::part::Part;

/// What is marked as not certified.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// One entry per panel.
    pub panels: Vec<bool>,
    /// One entry per flat pattern.
    pub patterns: Vec<bool>,
    /// One entry per part.
    pub parts: Vec<bool>,
}

impl Marks {
    /// Marks of an answer. Where panels cover faces, one whose own proof holds is good to cut even where another one fails
    /// or something is left out; where the whole fails and no panel is to blame, none of them is good. Panels without such
    /// proofs have one status for all: marked are all or none, and none where all that was made is proven and something is
    /// only left out.
    pub fn of(answer: &Answer) -> Self {
        let count = answer.patchwork.panels.len();
        let Some(certificate) = &answer.certificate else {
            return Self::all(answer, is_refused(&answer.claims));
        };
        let mut panels: Vec<bool> = (0..count)
            .map(|k| {
                let proof = certificate.panels.get(k);
                let proven = proof.is_some_and(|p| p.certified && p.deviation_bound <= answer.tolerance);
                let flat =
                    answer.job == Job::Ruled || answer.part_of(k).is_some_and(|part| answer.pattern_of(part).is_some());
                let refused = answer.claims.iter().any(|c| c.subject() == Subject::Panel(k) && c.is_broken());
                !proven || !flat || refused || answer.beyond_limits.contains(&k)
            })
            .collect();
        let seams_unknown = certificate.seams.len() < answer.patchwork.seam_count;
        let whole = certificate.covered || seams_unknown;
        if is_refused(&answer.claims) && !panels.contains(&true) && whole {
            panels.fill(true);
        }
        Self::from_panels(answer, panels)
    }

    /// Nothing is marked.
    pub fn none(answer: &Answer) -> Self {
        Self::all(answer, false)
    }

    /// Everything is marked, or nothing, whatever parts say of their panels.
    fn all(answer: &Answer, marked: bool) -> Self {
        Self {
            panels: vec![marked; answer.patchwork.panels.len()],
            patterns: vec![marked; answer.patterns.len()],
            parts: vec![marked; answer.parts.len()],
        }
    }

    fn from_panels(answer: &Answer, panels: Vec<bool>) -> Self {
        let of = |part: &Part| panels.iter().skip(part.first).take(part.count).any(|m| *m);
        let parts: Vec<bool> = answer.parts.iter().map(of).collect();
        let patterns = answer.patterns.iter().map(|p| parts.get(p.panel).copied().unwrap_or(true)).collect();
        Self { panels, patterns, parts }
    }

    /// Whether there is anything that must not be cut.
    pub fn any(&self) -> bool {
        self.panels.contains(&true) || self.patterns.contains(&true)
    }
}

/// Whether something of what was made is not proven, as opposed to something that is only left out.
fn is_refused(claims: &[Claim]) -> bool {
    claims.iter().any(|c| c.is_broken() && c.what() != What::LeftOut)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Job;
    use crate::patchwork::pattern::Pattern;

    #[test]
    fn every_pattern_of_a_refused_answer_is_marked() {
        let mut answer = Answer::new(Job::Cones, "chute", 0.1);
        // A part whose panels are not there has a pattern all the same.
        answer.parts = vec![Part { name: "A".into(), first: 7, count: 0, missing: String::new() }];
        answer.patterns = vec![Pattern::default()];
        assert!(!Marks::of(&answer).any());
        answer.claims.push(Claim::left_out("a rail is missing"));
        assert!(!Marks::of(&answer).any());
        answer.claims.push(Claim::objection(Subject::Whole, "too far"));
        let marks = Marks::of(&answer);
        assert_eq!((marks.patterns, marks.parts), (vec![true], vec![true]));
    }
}
