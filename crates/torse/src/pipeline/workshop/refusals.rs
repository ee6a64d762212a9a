//! Thicknesses that cannot be.

use super::WorkshopOptions;
use crate::answer::{Answer, Job};
use crate::certify::claim::{Claim, Subject};
use crate::patchwork::pattern::Pattern;

/// What stands against cutting parts that are laid flat as they are: a thickness that the sheet has not, or that its bends
/// have no room for.
pub(super) fn refusals(answer: &Answer, options: &WorkshopOptions) -> Vec<Claim> {
    let (Job::Unroll, Some(asked)) = (answer.job, options.thickness) else { return Vec::new() };
    let shown = |mm: f64| format!("{} {}", number(answer.cut.unit.of(mm)), answer.cut.unit.sign());
    let refusal = |(k, pattern): (usize, &Pattern)| {
        let own = answer.sheets.get(k)?;
        let reason = if own.thickness > 0.0 {
            let other = (own.thickness - asked).abs() > answer.tolerance.max(SAME_THICKNESS * own.thickness);
            other.then(|| {
                format!("is sheet of {}, not of {}: leave out --thickness", shown(own.thickness), shown(asked))
            })
        } else {
            let inside = answer.shop.work.get(k).and_then(|w| w.sheet).map(|s| s.inside_radius)?;
            let no_room = inside <= 0.0;
            no_room.then(|| format!("bends so tightly that a sheet of {} has no room inside", shown(asked)))
        };
        reason.map(|r| Claim::objection(Subject::Part(pattern.panel), format!("part {} {r}", pattern.name)))
    };
    answer.patterns.iter().enumerate().filter_map(refusal).collect()
}

/// Digits that a message needs.
fn number(x: f64) -> String {
    format!("{x:.3}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Share by which a sheet may differ from the thickness that was asked for.
const SAME_THICKNESS: f64 = 0.01;
