//! Coordinates whose last digits are coarser than what is asked of them.

/// Numbers so large that neighbouring ones are too far apart for a tolerance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "coordinates up to {largest:.1e} mm are exact to {step:.1e} mm only, too coarse for the tolerance of {tolerance} mm: \
     move the data towards the origin"
)]
pub struct Coarse {
    /// Largest coordinate, mm.
    pub largest: f64,
    /// Distance of neighbouring numbers there, mm.
    pub step: f64,
    /// Tolerance, mm.
    pub tolerance: f64,
}

/// Steps between numbers, where coordinates are largest, that a tolerance should hold.
const STEPS: f64 = 20.0;

impl Coarse {
    /// The fault of coordinates up to `largest` for a tolerance, mm; `None` if there is none. Numbers that are not finite
    /// are another fault.
    pub fn of(largest: f64, tolerance: f64) -> Option<Self> {
        let step = largest * f64::EPSILON;
        (largest.is_finite() && STEPS * step > tolerance).then_some(Self { largest, step, tolerance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_holds_twenty_steps() {
        let step = 1e9 * f64::EPSILON;
        assert_eq!(Coarse::of(1e9, 20.5 * step), None);
        let fault = Coarse::of(1e9, 19.5 * step).expect("too coarse");
        assert!(fault.to_string().starts_with("coordinates up to 1.0e9 mm are exact to 2.2e-7 mm only"));
        assert_eq!(Coarse::of(f64::INFINITY, 1.0), None);
    }
}
