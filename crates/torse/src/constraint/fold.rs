//! Two developables along a common curve that unfold to one sheet: a curved crease \[W15\].
//!
//! With unit normals n₁, n₂ of both sides, oriented alike in the flat sheet, the osculating plane of the crease is
//! equally inclined to both: `(n₁ + n₂)·c'' = 0` (proposition 4.4). Then the crease has one geodesic curvature from both sides.

use super::stencil::{Stencil, Support};
use crate::geom::Vec3;
use crate::num::gauss_newton::Block;

/// `nᵢ·c' = nᵢ·rᵢ = 0`, `|nᵢ| = 1` and `(n₁ + n₂)·c'' = 0` at one point of a crease. Private unknowns n₁, n₂.
#[derive(Clone, Debug)]
pub(crate) struct Fold {
    support: Support,
}

impl Fold {
    /// Derivatives of the crease, and the rulings from it into both sides.
    pub fn new(first: &Stencil, second: &Stencil, rulings: [&Stencil; 2]) -> Self {
        Self { support: Support::new(&[first, second, rulings[0], rulings[1]]) }
    }

    fn vectors(&self, x: &[f64]) -> [Vec3; 4] {
        [0, 1, 2, 3].map(|k| self.support.vector(k, x))
    }
}

impl Block for Fold {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        7
    }

    fn private(&self) -> usize {
        6
    }

    fn begin(&self, x: &[f64], own: &mut [f64]) {
        let [d, _, r, s] = self.vectors(x);
        let n = d.cross(&r).try_normalize(0.0).unwrap_or(Vec3::z());
        let m = s.cross(&d).try_normalize(0.0).unwrap_or(Vec3::z());
        own[..3].copy_from_slice(n.as_slice());
        own[3..].copy_from_slice(m.as_slice());
    }

    fn evaluate(&self, x: &[f64], own: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let v = self.vectors(x);
        let n = [Vec3::from_column_slice(&own[..3]), Vec3::from_column_slice(&own[3..])];
        for k in 0..2 {
            residual[3 * k] = n[k].dot(&v[0]);
            residual[3 * k + 1] = n[k].dot(&v[2 + k]);
            residual[3 * k + 2] = 0.5 * (n[k].norm_squared() - 1.0);
        }
        let sum = n[0] + n[1];
        residual[6] = sum.dot(&v[1]);
        let Some(jacobian) = jacobian else { return };
        jacobian.fill(0.0);
        let width = x.len() + 6;
        for k in 0..2 {
            let at = x.len() + 3 * k;
            let mut put = |i: usize, stencil: Option<usize>, other: &Vec3| {
                let row = &mut jacobian[(3 * k + i) * width..(3 * k + i + 1) * width];
                if let Some(s) = stencil {
                    self.support.spread(s, &n[k], row);
                }
                row[at..at + 3].copy_from_slice(other.as_slice());
            };
            put(0, Some(0), &v[0]);
            put(1, Some(2 + k), &v[2 + k]);
            put(2, None, &n[k]);
        }
        let row = &mut jacobian[6 * width..];
        self.support.spread(1, &sum, row);
        row[x.len()..x.len() + 3].copy_from_slice(v[1].as_slice());
        row[x.len() + 3..].copy_from_slice(v[1].as_slice());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check;

    #[test]
    fn derivatives_are_right() {
        let s = |k: u32| Stencil(vec![(3 * k, 1.0), (3 * k + 3, -0.6), (3 * k + 6, 0.3)]);
        check(&mut Fold::new(&s(0), &s(1), [&s(2), &s(3)]), 1.0);
    }

    #[test]
    fn a_circle_between_mirrored_cones_is_a_fold() {
        // A sheet with a circular crease folds into a cone and its mirror image in the plane of the crease.
        let p = |k: u32| Stencil::point(3 * k);
        let block = Fold::new(&p(0), &p(1), [&p(2), &p(3)]);
        let residual = |inner: [f64; 3], outer: [f64; 3]| {
            // At (1, 0, 0) of the unit circle: c' = (0, 1, 0), c'' = (−1, 0, 0).
            let x = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], inner, outer].concat();
            let (mut own, mut out) = ([0.0; 6], [0.0; 7]);
            block.begin(&x, &mut own);
            block.evaluate(&x, &own, &mut out, None);
            out.iter().fold(0.0, |m: f64, r| m.max(r.abs()))
        };
        assert!(residual([-0.8, 0.0, 0.6], [0.8, 0.0, 0.6]) < 1e-15);
        // Another slope outside would need another length of the crease there.
        assert!(residual([-0.8, 0.0, 0.6], [0.6, 0.0, 0.8]) > 0.1);
    }
}
