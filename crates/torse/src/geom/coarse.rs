//! Tolerances that do not suit the coordinates: finer than their last digits, or larger than the model.

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
    pub(crate) fn of(largest: f64, tolerance: f64) -> Option<Self> {
        let step = largest * f64::EPSILON;
        (largest.is_finite() && STEPS * step > tolerance).then_some(Self { largest, step, tolerance })
    }
}

/// Whether a number can be a tolerance: a positive length.
pub(crate) fn is_tolerance(x: f64) -> bool {
    x > 0.0 && x.is_finite()
}

/// A tolerance that is as large as the model, so that nothing would have to look like it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the tolerance of {tolerance} mm is more than half the diagonal of all that is read, which is {diagonal:.3} mm: check \
     the unit of the file and the tolerance"
)]
pub struct Loose {
    /// Tolerance, mm.
    pub tolerance: f64,
    /// Diagonal of the box around what is read, mm.
    pub diagonal: f64,
}

/// Share of the diagonal beyond which a tolerance says nothing: everything is that near to the middle.
const MOST_SHARE: f64 = 0.5;

impl Loose {
    /// Refuses a tolerance that is too large for the diagonal of a model, mm. Models without extent are another fault.
    ///
    /// # Errors
    /// The tolerance is more than half the diagonal.
    pub(crate) fn check(diagonal: f64, tolerance: f64) -> Result<(), Self> {
        if diagonal > 0.0 && tolerance > MOST_SHARE * diagonal {
            return Err(Self { tolerance, diagonal });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_is_at_most_half_the_diagonal() {
        assert_eq!((Loose::check(4.0, 2.0), Loose::check(0.0, 2.0)), (Ok(()), Ok(())));
        let told = Loose::check(3.0, 2.0).expect_err("too large").to_string();
        assert!(told.contains("2 mm") && told.contains("3.000 mm"), "{told}");
    }

    #[test]
    fn a_tolerance_holds_twenty_steps() {
        let step = 1e9 * f64::EPSILON;
        assert_eq!(Coarse::of(1e9, 20.5 * step), None);
        let fault = Coarse::of(1e9, 19.5 * step).expect("too coarse");
        assert!(fault.to_string().starts_with("coordinates up to 1.0e9 mm are exact to 2.2e-7 mm only"));
        assert_eq!(Coarse::of(f64::INFINITY, 1.0), None);
    }
}
