//! What the fits say about regression curves: a proven distance for each strip, and limits that are not kept.

use crate::certify::claim::{Claim, Subject, What};
use crate::certify::regression::{clearance_bound, regression, RegressionVerdict};
use crate::geom::Vec3;
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
