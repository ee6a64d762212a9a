//! Which parts must not be cut: the one place where that is decided, for every file, picture and report.

use super::outcome::Outcome;
use super::sheets::Sheets;
use crate::certify::claim::{Claim, Subject, What};

/// What is marked as not certified.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// One entry per panel or strip.
    pub panels: Vec<bool>,
    /// One entry per flat pattern.
    pub patterns: Vec<bool>,
}

impl Marks {
    /// Marks of panels. A panel whose own proof holds is good to cut even where another one fails or something is left
    /// out; where the whole fails and no panel is to blame, none of them is good.
    pub fn of(outcome: &Outcome) -> Self {
        let proofs = &outcome.certificate.panels;
        let count = outcome.patchwork.panels.len();
        let mut panels: Vec<bool> = (0..count)
            .map(|k| {
                let proven = proofs.get(k).is_some_and(|p| p.certified && p.deviation_bound <= outcome.tolerance);
                let flat = outcome.patterns.iter().any(|p| p.panel == k);
                let refused = outcome.claims.iter().any(|c| c.subject() == Subject::Panel(k) && c.is_broken());
                !proven || !flat || refused || outcome.beyond_limits.contains(&k)
            })
            .collect();
        let seams_unknown = outcome.certificate.seams.len() < outcome.patchwork.seam_count;
        let whole = outcome.certificate.covered || seams_unknown;
        if is_refused(&outcome.claims) && !panels.contains(&true) && whole {
            panels.fill(true);
        }
        let patterns = outcome.patterns.iter().map(|p| panels.get(p.panel).copied().unwrap_or(true)).collect();
        Self { panels, patterns }
    }

    /// Nothing is marked.
    pub fn none(outcome: &Outcome) -> Self {
        Self { panels: vec![false; outcome.patchwork.panels.len()], patterns: vec![false; outcome.patterns.len()] }
    }

    /// Marks of strips: all or none, since their status is one for all; none where all are proven and something is only
    /// left out.
    pub fn of_sheets(sheets: &Sheets) -> Self {
        let marked = is_refused(&sheets.claims);
        Self { panels: vec![marked; sheets.strips.len()], patterns: vec![marked; sheets.patterns.len()] }
    }

    /// Nothing is marked of strips.
    pub fn none_of_sheets(sheets: &Sheets) -> Self {
        Self { panels: vec![false; sheets.strips.len()], patterns: vec![false; sheets.patterns.len()] }
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
