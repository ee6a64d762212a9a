//! The same developable with other ends: restricted or extended along the curve and across it, boundaries exchanged,
//! run through backwards.
//!
//! *Method.* Along the curve, blossoms of both boundaries at the new knots; M* and Λ* stay \[FJ07, theorem 1\]. Across
//! it, (17) of \[FJ07\] and its generalisation: the strip between `v_0` and `v_1` has the blossom arguments
//! `M* + v_i (Λ* − M*)`.

use super::control_net::{plus, Net, NetError};
use super::shape::Shape;
use crate::spline::curve::Curve;

impl Net {
    /// The part over `[a, b]`, clamped. Beyond the domain the first and last pieces are continued: an extension.
    ///
    /// # Errors
    /// `a < b`, both finite, meeting the domain, are needed; M* in the middle of `[a, b]` cannot be represented.
    pub fn over(&self, a: f64, b: f64) -> Result<Self, NetError> {
        let curve = self.curve.extended(a, b)?;
        let rulings = self.ruling_curve().extended(a, b)?.control;
        let shape = self.shape.over((a, b));
        if !(shape.m.is_finite() && shape.kappa.is_finite()) {
            return Err(NetError::Shape { m: shape.m, kappa: shape.kappa });
        }
        Ok(Self::from_parts(curve, rulings, shape))
    }

    /// The strip between `v_0` and `v_1` of the same surface: shorter for values in `[0, 1]`, longer beyond.
    /// `v_0 > v_1` exchanges the boundaries. For rational nets `v` is the homogeneous share.
    ///
    /// # Errors
    /// `v_0 = v_1`; a boundary with weights that are not positive, or for which M* is the middle of the domain.
    pub fn between(&self, v_0: f64, v_1: f64) -> Result<Self, NetError> {
        let shape = self.shape.between(v_0, v_1);
        if !(shape.m.is_finite() && shape.kappa.is_finite() && v_0 != v_1) {
            return Err(NetError::Shape { m: shape.m, kappa: shape.kappa });
        }
        let control: Vec<[f64; 4]> =
            self.curve.control.iter().zip(&self.rulings).map(|(c, e)| plus(c, e, v_0)).collect();
        let curve = Curve { knots: self.curve.knots.clone(), control };
        super::control_net::check_curve(&curve)?;
        let rulings = self.rulings.iter().map(|e| e.map(|x| (v_1 - v_0) * x)).collect();
        Ok(Self::from_parts(curve, rulings, shape))
    }

    /// The same strip seen from the opposite boundary: M* and Λ* exchange their roles.
    ///
    /// # Errors
    /// As [`Net::between`].
    pub fn exchanged(&self) -> Result<Self, NetError> {
        self.between(1.0, 0.0)
    }

    /// The same strip with the curve run through backwards.
    pub fn reversed(&self) -> Self {
        let curve = self.curve.reversed();
        let rulings = self.rulings.iter().rev().copied().collect();
        let shape = Shape { m: -self.shape.m, ..self.shape };
        Self::from_parts(curve, rulings, shape)
    }
}
