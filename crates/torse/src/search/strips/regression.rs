//! What the fits say about regression curves: a proven distance for each strip, and limits that are not kept.

use crate::certify::claim::{Claim, Subject, What};
use crate::certify::regression::{clearance_bound, regression, RegressionVerdict};
use crate::torse::strip::Strip;
use crate::torse::zone::RegressionLimits;

/// The proven distance between the strip of a number and its regression curve.
pub(crate) fn claim(index: usize, strip: &Strip) -> Claim {
    Claim::at_least(What::RegressionClearance, Subject::Panel(index), clearance_bound(strip))
}

/// Whether a strip provably keeps to the limits.
pub(crate) fn keeps(strip: &Strip, limits: Option<&RegressionLimits>) -> bool {
    limits.is_none_or(|l| regression(strip, l) == RegressionVerdict::Clear)
}

/// Why a limit is not usable; `None` if all are.
pub(crate) fn fault(limits: &RegressionLimits) -> Option<String> {
    if !(limits.clearance >= 0.0 && limits.clearance.is_finite()) {
        return Some(format!("the clearance {} of the regression curve is not a length", limits.clearance));
    }
    let bad = limits.zones.iter().position(|z| !z.is_usable())?;
    let name = |k: usize| ["x", "y", "z"][k];
    let ranges: Vec<String> = limits.zones[bad]
        .ranges
        .iter()
        .enumerate()
        .map(|(k, r)| format!("{} from {} to {}", name(k), r.0, r.1))
        .collect();
    Some(format!("zone {bad} of the regression curve is empty or everything ({} mm)", ranges.join(", ")))
}

/// Strips that do not keep to the limits, in words.
pub(crate) fn broken(strips: &[Strip], limits: Option<&RegressionLimits>) -> Vec<String> {
    let Some(limits) = limits else { return Vec::new() };
    let words = |s: &Strip| match regression(s, limits) {
        RegressionVerdict::Clear => None,
        RegressionVerdict::Meets { at, .. } => Some(format!(
            "the regression curve of {} is out of bounds at ({:.3}, {:.3}, {:.3})",
            s.name, at.x, at.y, at.z
        )),
        RegressionVerdict::Undecided { u } => {
            let [p, q] = s.ruling(u);
            let c = 0.5 * (p + q);
            Some(format!(
                "it could not be shown that the regression curve of {} stays in bounds, around ({:.3}, {:.3}, {:.3})",
                s.name, c.x, c.y, c.z
            ))
        }
    };
    strips.iter().filter_map(words).collect()
}

/// How near developables come that keep to the limits, in words that follow "within so many mm"; infinite if none does.
pub(crate) fn kept_off(nearest: f64) -> String {
    let how = if nearest.is_finite() {
        format!("the nearest found is {nearest:.3} mm away")
    } else {
        "none was found that is".to_string()
    };
    format!(
        " with its regression curve in bounds ({how}); raise the tolerance, or ask for less of the regression curve"
    )
}

/// What was asked, as a note.
pub(crate) fn note(limits: &RegressionLimits) -> String {
    let mut out = if limits.clearance > 0.0 {
        format!("Regression curves were to keep {} mm from their strips", limits.clearance)
    } else {
        "Regression curves were to stay off their strips".to_string()
    };
    if !limits.zones.is_empty() {
        let count = limits.zones.len();
        out += &format!(" and out of {count} zone{}", if count == 1 { "" } else { "s" });
    }
    out + "; this is proven for every ruling, not only for the given ones."
}
