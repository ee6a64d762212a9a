//! Two places at a given distance.

use super::stencil::{Stencil, Support};
use crate::num::gauss_newton::Block;

/// `(|v|² − L²)/(2L) = 0` for a combination `v` of points; near the solution the row is `|v| − L`.
#[derive(Clone, Debug)]
pub struct Distance {
    support: Support,
    length: f64,
}

impl Distance {
    /// The vector between two places, and its length, which is positive.
    pub fn new(between: &Stencil, length: f64) -> Self {
        Self { support: Support::new(&[between]), length }
    }
}

impl Block for Distance {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let v = self.support.vector(0, x);
        residual[0] = 0.5 * (v.norm_squared() / self.length - self.length);
        if let Some(row) = jacobian {
            row.fill(0.0);
            self.support.spread(0, &(v / self.length), row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check;

    #[test]
    fn derivatives_are_right() {
        let v = Stencil::point(0).minus(&Stencil::point(3).times(0.7)).minus(&Stencil::point(6).times(0.3));
        check(&mut Distance::new(&v, 0.8), 1.0);
    }

    #[test]
    fn the_row_vanishes_at_the_length() {
        let block = Distance::new(&Stencil::point(0), 3.0);
        let mut out = [0.0];
        block.evaluate(&[2.0, 1.0, 2.0], &[], &mut out, None);
        assert_eq!(out[0], 0.0);
        block.evaluate(&[2.0, 1.0, 2.001], &[], &mut out, None);
        assert!((out[0] - 0.002 / 3.0).abs() < 1e-6);
    }
}
