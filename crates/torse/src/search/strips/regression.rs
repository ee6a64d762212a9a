//! What the fits say about regression curves: a proven distance for each strip, and limits that are not kept.

use crate::certify::claim::{Claim, LowerBound, Subject, What};
use crate::certify::regression::{clearance_bound, margin_bound, regression, RegressionVerdict};
use crate::geom::Vec3;
use crate::num::parallel;
use crate::reason::{Reason, StripReason};
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;

/// The proven distance between the strip of a number and its regression curve.
pub(crate) fn claim(index: usize, strip: &Strip) -> Claim {
    Claim::at_least(What::RegressionClearance, Subject::Panel(index), clearance_bound(strip))
}

/// The proven distance between the strip of a number and its regression curve, in lengths of the ruling; no less than `asked`
/// of them are demanded.
fn margin_claim(index: usize, strip: &Strip, asked: f64) -> Claim {
    let bound = margin_bound(strip, asked);
    let claim = Claim::at_least(What::RegressionMargin, Subject::Panel(index), bound);
    if asked > 0.0 {
        let reason = StripReason::Margin { strip: strip.name.clone(), shown: bound.value(), asked };
        return claim.not_below(asked).because(Reason::from(reason));
    }
    claim
}

/// Proven distances between strips that bend and their regression curves, in mm and in lengths of the ruling, of which
/// `asked` says how many are demanded: of the strips one by one, and the least of all. Planes have no regression curve, fans
/// have theirs at their tip, ruled strips have no say in it.
pub(crate) fn claims(strips: &[Strip], asked: &(dyn Fn(usize) -> f64 + Sync)) -> Vec<Claim> {
    let bends = |s: &Strip| !matches!(s.kind, PanelKind::Ruled | PanelKind::Plane) && !s.is_point(0) && !s.is_point(1);
    let of = |(k, s): (usize, &Strip)| {
        let clearance = clearance_bound(s);
        let claim = Claim::at_least(What::RegressionClearance, Subject::Panel(k), clearance);
        (clearance, [claim, margin_claim(k, s, asked(k))])
    };
    let each: Vec<_> = parallel::map(strips.iter().enumerate().filter(|(_, s)| bends(s)), of);
    if each.is_empty() {
        return Vec::new();
    }
    let least = LowerBound::smallest(each.iter().map(|e| e.0));
    let whole = Claim::at_least(What::RegressionClearance, Subject::Whole, least);
    each.into_iter().flat_map(|e| e.1).chain([whole]).collect()
}

/// Whether a strip provably keeps to the limits.
pub(crate) fn keeps(strip: &Strip, limits: Option<&RegressionLimits>) -> bool {
    limits.is_none_or(|l| regression(strip, l) == RegressionVerdict::Clear)
}

/// A strip whose regression curve is not known to keep to the limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Name of the strip.
    pub strip: String,
    /// Where the curve is out of bounds, or near which ruling's middle that is undecided, mm.
    pub at: Vec3,
    /// Whether it is out of bounds there; false where it could only not be shown to stay in them.
    pub proven: bool,
}

impl From<&Broken> for Reason {
    fn from(b: &Broken) -> Self {
        StripReason::OutOfBounds { strip: b.strip.clone(), at: b.at, proven: b.proven }.into()
    }
}

/// Strips that are not shown to keep to the limits.
pub(crate) fn broken(strips: &[Strip], limits: Option<&RegressionLimits>) -> Vec<Broken> {
    let Some(limits) = limits else { return Vec::new() };
    let found = |s: &Strip| {
        let (at, proven) = match regression(s, limits) {
            RegressionVerdict::Clear => return None,
            RegressionVerdict::Meets { at, .. } => (at, true),
            RegressionVerdict::Undecided { u } => {
                let [p, q] = s.ruling(u);
                (0.5 * (p + q), false)
            }
        };
        Some(Broken { strip: s.name.clone(), at, proven })
    };
    strips.iter().filter_map(found).collect()
}
