//! One strip through a part of the curve, and how it was found \[FJ07\].

use crate::torse::net::{Regularity, TaperedNet};

/// Ratio of the reaches beyond which a strip has no width at one end: its regression curve touches the curve there but
/// for rounding.
const LEAST_RATIO: f64 = 1e-6;
/// Angle between an end ruling and its line above which rounding has spoilt the answer, radians.
const LARGEST_END_ERROR: f64 = 1e-9;

/// One strip through a part of the curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The strip. Its curve is the given one, clamped; the taper is constant unless both reaches were prescribed.
    pub strip: TaperedNet,
    /// Length of the first ruling, in the given vector.
    pub start_reach: f64,
    /// Length of the last ruling, in the given vector; negative on the other side.
    pub end_reach: f64,
    /// Smallest distance found along a ruling from the curve to the regression curve, mm.
    pub clearance_estimate: f64,
    /// Whether the strip is a regular surface, or where it is not.
    pub regularity: Regularity,
    /// Larger of the angles between the end rulings and the lines given, radians: rounding.
    pub end_error: f64,
}

impl Solution {
    /// Regular, with both end rulings on the sides given and of comparable lengths.
    pub fn is_good(&self) -> bool {
        let ratio = self.end_reach / self.start_reach;
        self.start_reach > 0.0
            && ratio > LEAST_RATIO
            && ratio < 1.0 / LEAST_RATIO
            && self.end_error < LARGEST_END_ERROR
            && self.regularity.holds()
    }
}

/// How the answer was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// A polynomial net, a tangent surface.
    Polynomial,
    /// Parallel end rulings.
    Cylinder,
    /// End rulings that meet.
    Cone,
    /// A rational net.
    Rational,
    /// Nets joined smoothly along rulings.
    Split,
}
