//! Which parts must not be cut: the one place where that is decided, for every file, picture and report.

use super::{Answer, Job};
use crate::certify::claim::{Claim, Status, Subject, What};
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
    /// or something is left out; where the whole fails and no panel is to blame, none of them is good. Of parts of which
    /// something is claimed one by one, those are good of which all of it is proven, unless something else stands against the
    /// whole. Panels without either have one status for all: marked are all or none, and none where all that was made is proven
    /// and something is only left out.
    pub fn of(answer: &Answer) -> Self {
        let count = answer.patchwork.panels.len();
        let Some(certificate) = &answer.certificate else {
            return Self::of_parts(answer).unwrap_or_else(|| Self::all(answer, is_refused(&answer.claims)));
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
        let seams_unknown = certificate.seams.len() < answer.patchwork.seam_count + answer.patchwork.joint_count;
        let whole = certificate.covered || seams_unknown;
        if is_refused(&answer.claims) && !panels.contains(&true) && whole {
            panels.fill(true);
        }
        Self::from_panels(answer, panels)
    }

    /// Marks of parts that have claims of their own; `None` if none has.
    fn of_parts(answer: &Answer) -> Option<Self> {
        let mut own: Vec<Vec<&Claim>> = vec![Vec::new(); answer.parts.len()];
        let mut whole = Vec::new();
        let mut claimed = false;
        let mut part_of = vec![None; answer.patchwork.panels.len()];
        for (k, part) in answer.parts.iter().enumerate() {
            part_of.iter_mut().skip(part.first).take(part.count).for_each(|p| *p = Some(k));
        }
        for c in &answer.claims {
            let part = match c.subject() {
                Subject::Part(k) => {
                    claimed = true;
                    Some(k)
                }
                Subject::Panel(k) => part_of.get(k).copied().flatten(),
                Subject::Whole => None,
            };
            match part.and_then(|k| own.get_mut(k)) {
                Some(claims) => claims.push(c),
                // What is said of something that is no part might be said of all of them.
                None => whole.push(c),
            }
        }
        if !claimed {
            return None;
        }
        let beyond =
            |part: &Part| answer.beyond_limits.iter().any(|k| (part.first..part.first + part.count).contains(k));
        let marked = |(claims, part): (&Vec<&Claim>, &Part)| {
            Status::of(claims.iter().copied()) != Status::Certified || beyond(part)
        };
        let parts: Vec<bool> = own.iter().zip(&answer.parts).map(marked).collect();
        let blamed = parts.contains(&true);
        let against = |c: &&Claim| c.is_broken() && c.what() != What::LeftOut && !(c.is_told_of_parts() && blamed);
        if whole.iter().any(against) {
            return Some(Self::all(answer, true));
        }
        let panels = part_of.iter().map(|part| part.is_none_or(|k| parts[k])).collect();
        let patterns = answer.patterns.iter().map(|p| parts.get(p.panel).copied().unwrap_or(true)).collect();
        Some(Self { panels, patterns, parts })
    }

    /// Nothing is marked.
    pub(crate) fn none(answer: &Answer) -> Self {
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
    use crate::certify::claim::UpperBound;
    use crate::geom::Vec3;
    use crate::patchwork::pattern::Pattern;
    use crate::reason::{JobReason, PanelFault, StripReason, WrittenFault};

    #[test]
    fn every_pattern_of_a_refused_answer_is_marked() {
        let mut answer = Answer::new(Job::Cones, "chute", 0.1);
        // A part whose panels are not there has a pattern all the same.
        answer.parts = vec![Part { name: "A".into(), first: 7, count: 0, missing: None }];
        answer.patterns = vec![Pattern::default()];
        assert!(!Marks::of(&answer).any());
        answer.claims.push(Claim::left_out(StripReason::NoHull));
        assert!(!Marks::of(&answer).any());
        answer.claims.push(Claim::objection(Subject::Whole, JobReason::Stopped));
        let marks = Marks::of(&answer);
        assert_eq!((marks.patterns, marks.parts), (vec![true], vec![true]));
    }

    /// Two parts of which the first is proven and the second is not, and the whole for that reason is not.
    fn one_of_two() -> Answer {
        let mut answer = Answer::new(Job::Unroll, "ducts", 0.1);
        answer.parts = ["A", "B"].map(|name| Part { name: name.into(), first: 0, count: 0, missing: None }).into();
        answer.patterns = (0..2).map(|panel| Pattern { panel, ..Pattern::default() }).collect();
        let proven = |subject, bound| Claim::at_most(What::MapSurfaceDistance, subject, bound).within(0.1);
        answer.claims = vec![
            proven(Subject::Whole, UpperBound::UNKNOWN).told_of_parts(),
            proven(Subject::Part(0), UpperBound::largest([])).within(f64::INFINITY),
            proven(Subject::Part(1), UpperBound::UNKNOWN),
        ];
        answer
    }

    #[test]
    fn a_part_that_is_proven_is_good_beside_one_that_is_not() {
        let answer = one_of_two();
        let marks = Marks::of(&answer);
        assert_eq!((marks.patterns, marks.parts), (vec![false, true], vec![false, true]));
        assert_eq!(Status::of(&answer.claims), Status::Uncertified);
    }

    #[test]
    fn what_may_concern_every_part_marks_every_part() {
        let all = |change: &dyn Fn(&mut Answer)| {
            let mut answer = one_of_two();
            change(&mut answer);
            Marks::of(&answer).parts
        };
        assert_eq!(all(&|_| {}), [false, true]);
        // A file that is not what was judged; a claim about a panel that is in no part; a bound that no part is to blame for.
        assert_eq!(all(&|a| a.claims.push(Claim::objection(Subject::Whole, WrittenFault::Moved(1.0)))), [true, true]);
        assert_eq!(
            all(&|a| a.claims.push(Claim::objection(Subject::Panel(7), PanelFault::Twisted(0.1, Vec3::zeros())))),
            [true, true]
        );
        assert_eq!(all(&|a| a.claims[2] = a.claims[2].clone().within(f64::INFINITY)), [true, true]);
        // What was only measured of a part, and nothing at all, is no proof.
        assert_eq!(
            all(&|a| a.claims[1] = Claim::measured(What::MapSurfaceDistance, Subject::Part(0), 0.0)),
            [true, true]
        );
        assert_eq!(all(&|a| drop(a.claims.remove(1))), [true, true]);
        // What is only left out, nobody can cut.
        assert_eq!(all(&|a| a.claims.push(Claim::left_out(StripReason::NoHull))), [false, true]);
    }
}
