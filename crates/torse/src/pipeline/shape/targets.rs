//! What is proven of the distance between strips and their targets.

use super::given::Taken;
use super::goal::Goal;
use super::options::Options;
use crate::answer::note::Note;
use crate::certify::claim::{Claim, Subject, What};
use crate::certify::nearness::{distance_from, Open, Target, TargetDistance};
use crate::control::Control;
use crate::io::shape::TargetRecord;
use crate::reason::{JobReason, Reason};
use crate::torse::strip::Strip;

/// What a job was, for its result.
pub(super) struct Asked<'a> {
    pub records: &'a [TargetRecord],
    pub goals: &'a [Goal],
    /// Number of curves that the job gives itself: the first ones.
    pub own: usize,
    /// What was taken over.
    pub taken: &'a Taken,
    pub options: &'a Options,
}

/// Claims about the distance from targets, and notes where one way stays open.
pub(super) fn targets(strips: &[Strip], asked: &Asked, control: &Control) -> (Vec<Claim>, Vec<Note>) {
    let (mut claims, mut notes) = (Vec::new(), Vec::new());
    for (index, (record, goal)) in asked.records.iter().zip(asked.goals).enumerate() {
        let wanted = |s: &&Strip| record.strips.is_empty() || record.strips.contains(&s.name);
        let near: Vec<&Strip> = strips.iter().filter(wanted).collect();
        let target = match goal {
            Goal::Faces(faces) => Target::Faces(faces),
            Goal::Cloud(cloud) => Target::Cloud(cloud),
        };
        let within = record.within.unwrap_or(asked.options.tolerance);
        let found = distance_from(&near, target, within, control);
        let bound = match (found.open, record.covered) {
            (Some(Open::Points), _) => found.back,
            (_, true) => found.there.max(found.back),
            (_, false) => found.there,
        };
        claims.push(
            Claim::at_most(What::TargetDistance(index), Subject::Whole, bound)
                .within(within)
                .because(beyond(index, record, &found, within)),
        );
        notes.push(Note::Target {
            index,
            there: found.there,
            back: found.back,
            points: found.open == Some(Open::Points),
        });
    }
    (claims, notes)
}

/// Why a target is not met, and what would help.
fn beyond(index: usize, record: &TargetRecord, found: &TargetDistance, within: f64) -> Reason {
    let (file, covered) = (record.file.clone(), record.covered);
    JobReason::Target { index, file, apart: found.seen, at: found.place, within, covered }.into()
}
