//! Two directions at a given angle.

use super::stencil::{Stencil, Support};
use crate::num::gauss_newton::Block;

/// `v·w/(|v||w|) − cos φ = 0` for two combinations of points. For angles near 0 and π the row has no slope: ask for
/// parallel directions with a `super::handle::Parallel`.
#[derive(Clone, Debug)]
pub struct Angle {
    support: Support,
    cosine: f64,
}

impl Angle {
    /// Two vectors and their angle, rad.
    pub fn new(v: &Stencil, w: &Stencil, angle: f64) -> Self {
        Self { support: Support::new(&[v, w]), cosine: angle.cos() }
    }
}

impl Block for Angle {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let (v, w) = (self.support.vector(0, x), self.support.vector(1, x));
        let (p, q) = (v.norm(), w.norm());
        if p == 0.0 || q == 0.0 {
            // A vector without direction is at no angle; nothing says how to change that.
            residual[0] = 1.0;
            jacobian.into_iter().for_each(|row| row.fill(0.0));
            return;
        }
        let (e, f) = (v / p, w / q);
        let cosine = e.dot(&f);
        residual[0] = cosine - self.cosine;
        if let Some(row) = jacobian {
            row.fill(0.0);
            self.support.spread(0, &((f - e * cosine) / p), row);
            self.support.spread(1, &((e - f * cosine) / q), row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check;

    #[test]
    fn derivatives_are_right() {
        let (v, w) = (Stencil::point(0).minus(&Stencil::point(3)), Stencil::point(6).minus(&Stencil::point(3)));
        check(&mut Angle::new(&v, &w, 1.1), 1.0);
    }

    #[test]
    fn the_row_vanishes_at_the_angle() {
        let block = Angle::new(&Stencil::point(0), &Stencil::point(3), std::f64::consts::FRAC_PI_3);
        let mut out = [0.0];
        block.evaluate(&[2.0, 0.0, 0.0, 0.5, 3f64.sqrt() / 2.0, 0.0], &[], &mut out, None);
        assert!(out[0].abs() < 1e-15);
    }
}
