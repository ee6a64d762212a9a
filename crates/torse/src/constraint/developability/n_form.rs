//! Developability by a common normal: `n·a' = n·b' = n·r = 0`, `|n| = 1`.
//!
//! Converges quadratically near a solution, and so polishes what [`super::KForm`] has found. Rulings whose regression
//! point lies inside the strip meet these equations, too: [`crate::num::gauss_newton::Block::keeps_side`] tells.

use super::{vectors, StripPoints};
use crate::constraint::stencil::Support;
use crate::geom::Vec3;
use crate::num::gauss_newton::Block;

/// Developability of one ruling; private unknown: its normal.
#[derive(Clone, Debug)]
pub(crate) struct NForm {
    support: Support,
}

impl NForm {
    /// The ruling at `u` in a piece of length `unit`.
    pub fn new(strip: StripPoints, u: f64, unit: f64) -> Self {
        let [da, db, r] = strip.ruling(u, unit);
        Self { support: Support::new(&[&da, &db, &r]) }
    }
}

impl Block for NForm {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        4
    }

    fn private(&self) -> usize {
        3
    }

    fn begin(&self, x: &[f64], own: &mut [f64]) {
        let [da, db, r] = vectors(&self.support, x);
        let n = (da + db).cross(&r).try_normalize(0.0).unwrap_or(Vec3::z());
        own.copy_from_slice(n.as_slice());
    }

    fn evaluate(&self, x: &[f64], own: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let vectors = vectors(&self.support, x);
        let n = Vec3::from_column_slice(own);
        for (k, v) in vectors.iter().enumerate() {
            residual[k] = n.dot(v);
        }
        residual[3] = 0.5 * (n.norm_squared() - 1.0);
        let Some(jacobian) = jacobian else { return };
        let width = x.len() + 3;
        for (k, v) in vectors.iter().enumerate() {
            let row = &mut jacobian[k * width..(k + 1) * width];
            for (c, out) in self.support.coefficients(k).iter().zip(row.chunks_exact_mut(3)) {
                out.copy_from_slice(&[c * n.x, c * n.y, c * n.z]);
            }
            row[x.len()..].copy_from_slice(v.as_slice());
        }
        jacobian[3 * width + x.len()..].copy_from_slice(n.as_slice());
    }

    fn keeps_side(&self, x: &[f64], _: &[f64]) -> bool {
        let [da, db, r] = vectors(&self.support, x);
        da.cross(&r).dot(&db.cross(&r)) >= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check;
    use crate::spline::knots::Knots;

    #[test]
    fn derivatives_are_right() {
        let knots = Knots::uniform(2, 3, 0.0, 1.0).expect("knots");
        let points: Vec<u32> = (0..10).map(|i| 3 * i).collect();
        let strip = StripPoints { knots: &knots, a: &points[..5], b: &points[5..] };
        check(&mut NForm::new(strip, 0.4, 1.0 / 3.0), 3.0);
    }

    #[test]
    fn a_double_cone_is_on_the_wrong_side() {
        let knots = Knots::uniform(2, 1, 0.0, 1.0).expect("knots");
        let points: Vec<u32> = (0..6).map(|i| 3 * i).collect();
        let block = NForm::new(StripPoints { knots: &knots, a: &points[..3], b: &points[3..] }, 0.3, 1.0);
        let apex = Vec3::new(0.4, 0.1, 1.0);
        let a = [Vec3::zeros(), Vec3::new(0.5, 0.5, 0.0), Vec3::x()];
        let values = |factor: f64| -> Vec<f64> {
            let b = a.iter().map(|p| apex + (p - apex) * factor);
            a.iter().copied().chain(b).flat_map(|p| [p.x, p.y, p.z]).collect()
        };
        let mut own = [0.0; 3];
        let mut out = [0.0; 4];
        for (factor, right) in [(0.5, true), (-1.5, false)] {
            let x = values(factor);
            block.begin(&x, &mut own);
            block.evaluate(&x, &own, &mut out, None);
            assert!(out.iter().all(|r| r.abs() < 1e-14), "both are torsal");
            assert_eq!(block.keeps_side(&x, &own), right);
        }
    }
}
