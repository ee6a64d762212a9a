//! Thicknesses that cannot be.

use super::options::WorkshopOptions;
use crate::answer::{Answer, Job};
use crate::certify::claim::{Claim, Subject};
use crate::patchwork::pattern::Pattern;
use crate::reason::JobReason;

/// What stands against cutting parts: a thickness that the sheet has not, or that its bends have no room for, or patterns, by their
/// numbers, that are not those of the neutral fibre.
pub(super) fn refusals(answer: &Answer, options: &WorkshopOptions, not_neutral: &[usize]) -> Vec<Claim> {
    let Some(asked) = options.thickness else { return Vec::new() };
    // Where panels cover faces their certificate tells the inside radius.
    if answer.job != Job::Unroll && answer.certificate.is_some() {
        return Vec::new();
    }
    let unit = answer.cut.unit;
    let refusal = |(k, pattern): (usize, &Pattern)| {
        let own = answer.sheets.get(k).map(|s| s.thickness).filter(|t| *t > 0.0);
        let part = || pattern.name.clone();
        let reason = if let Some(own) = own {
            let other = (own - asked).abs() > answer.tolerance.max(SAME_THICKNESS * own);
            other.then(|| JobReason::Thickness { part: part(), own, asked, unit })
        } else {
            let inside = answer.shop.work.get(k).and_then(|w| w.sheet).map(|s| s.inside_radius)?;
            let no_room = inside <= 0.0;
            if no_room {
                Some(JobReason::NoRoom { part: part(), asked, unit })
            } else {
                // Who says where the neutral fibre lies asks for it; else a note tells of it.
                let is_asked = options.k.is_some() && not_neutral.contains(&k);
                is_asked.then(|| JobReason::NotNeutral { part: part() })
            }
        };
        reason.map(|r| Claim::objection(Subject::Part(pattern.panel), r))
    };
    answer.patterns.iter().enumerate().filter_map(refusal).collect()
}

/// Share by which a sheet may differ from the thickness that was asked for.
const SAME_THICKNESS: f64 = 0.01;
