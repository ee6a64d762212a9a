//! Two developables along a common curve that unfold to one sheet: a curved crease \[W15\].
//!
//! With unit normals n₁, n₂ of both sides, oriented alike in the flat sheet, the osculating plane of the crease is
//! equally inclined to both: `(n₁ + n₂)·c'' = 0` (proposition 4.4). Then the crease has one geodesic curvature from both sides.

use super::stencil::{Stencil, Support};
use crate::geom::Vec3;
use crate::num::gauss_newton::Block;

/// `(n₁ + n₂)·c'' = 0` at one point of a crease with the unit normals `n₁ ∥ c' × r₁` and `n₂ ∥ r₂ × c'`.
///
/// Departure from the source, where the normals are unknowns with equations of their own: such a normal can turn over on the way,
/// and then the equation is that of a sheet folded upon itself.
#[derive(Clone, Debug)]
pub(crate) struct Fold {
    support: Support,
}

impl Fold {
    /// Derivatives of the crease, and the rulings from it into both sides.
    pub fn new(first: &Stencil, second: &Stencil, rulings: [&Stencil; 2]) -> Self {
        Self { support: Support::new(&[first, second, rulings[0], rulings[1]]) }
    }
}

impl Block for Fold {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let [d, e, r, s] = [0, 1, 2, 3].map(|k| self.support.vector(k, x));
        // A crease or a ruling that vanishes has no normal; it asks for nothing then.
        let unit = |n: Vec3| {
            let size = n.norm();
            if size > 0.0 {
                (n / size, 1.0 / size)
            } else {
                (Vec3::zeros(), 0.0)
            }
        };
        let ((n, per_n), (m, per_m)) = (unit(d.cross(&r)), unit(s.cross(&d)));
        residual[0] = (n + m).dot(&e);
        let Some(jacobian) = jacobian else { return };
        jacobian.fill(0.0);
        // How n·c'' and m·c'' change with the products before they have unit length.
        let (p, q) = ((e - n * n.dot(&e)) * per_n, (e - m * m.dot(&e)) * per_m);
        self.support.spread(0, &(r.cross(&p) + q.cross(&s)), jacobian);
        self.support.spread(1, &(n + m), jacobian);
        self.support.spread(2, &p.cross(&d), jacobian);
        self.support.spread(3, &d.cross(&q), jacobian);
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
            let mut out = [0.0];
            block.evaluate(&x, &[], &mut out, None);
            out[0].abs()
        };
        assert!(residual([-0.8, 0.0, 0.6], [0.8, 0.0, 0.6]) < 1e-15);
        // Another slope outside would need another length of the crease there.
        assert!(residual([-0.8, 0.0, 0.6], [0.6, 0.0, 0.8]) > 0.1);
    }
}
