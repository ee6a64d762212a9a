//! Smooth joins of two strips along a common ruling.
//!
//! The control points of the ruling are shared. With derivatives taken away from the first strip and into the second:
//!
//! - G1: the boundary curves go on in their direction, `a₂' = e^w a₁'`, and likewise `b`. Where both strips are torsal along the
//!   ruling, they have one tangent plane there; where they are skew, they need one ratio e^w for both sides: the tangent plane
//!   at `(1 − v) a + v b` is spanned by the ruling and `(1 − v) a' + v b'`.
//! - G2: with the common normal n, `n·a''/|a'|²` is equal on both sides, and likewise for `b`.

use super::stencil::{Stencil, Support};
use crate::geom::Vec3;
use crate::num::gauss_newton::Block;

/// `d₂ − e^w d₁ = 0`: curves go on in their directions, all at the same ratio of speeds. Private unknown w.
#[derive(Clone, Debug)]
pub(crate) struct SameDirection {
    support: Support,
    pairs: usize,
}

impl SameDirection {
    /// First derivatives where the first curve ends and where the second begins.
    pub fn new(first: &Stencil, second: &Stencil) -> Self {
        Self { support: Support::new(&[first, second]), pairs: 1 }
    }

    /// The same for both sides of a strip with one ratio: strips that are skew there have equal tangent planes all along the
    /// ruling, too.
    pub fn both(first: [&Stencil; 2], second: [&Stencil; 2]) -> Self {
        Self { support: Support::new(&[first[0], second[0], first[1], second[1]]), pairs: 2 }
    }

    fn vectors(&self, pair: usize, x: &[f64]) -> [Vec3; 2] {
        [0, 1].map(|k| self.support.vector(2 * pair + k, x))
    }
}

/// |w| at most: lengths of derivatives differ by less than a factor of a million.
const LARGEST_LOG: f64 = 14.0;

impl Block for SameDirection {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        3 * self.pairs
    }

    fn private(&self) -> usize {
        1
    }

    fn begin(&self, x: &[f64], own: &mut [f64]) {
        let sums = (0..self.pairs).fold([0.0; 2], |s, k| {
            let [p, q] = self.vectors(k, x).map(|v| v.norm());
            [s[0] + p, s[1] + q]
        });
        let w = (sums[1] / sums[0]).ln();
        own[0] = if w.is_finite() { w.clamp(-LARGEST_LOG, LARGEST_LOG) } else { 0.0 };
    }

    fn evaluate(&self, x: &[f64], own: &[f64], residual: &mut [f64], mut jacobian: Option<&mut [f64]>) {
        let factor = own[0].clamp(-LARGEST_LOG, LARGEST_LOG).exp();
        let width = x.len() + 1;
        for k in 0..self.pairs {
            let [p, q] = self.vectors(k, x);
            residual[3 * k..3 * k + 3].copy_from_slice((q - p * factor).as_slice());
            let Some(jacobian) = jacobian.as_deref_mut() else { continue };
            let c = [0, 1].map(|i| self.support.coefficients(2 * k + i));
            for d in 0..3 {
                let row = &mut jacobian[(3 * k + d) * width..(3 * k + d + 1) * width];
                for (j, (p, q)) in c[0].iter().zip(c[1]).enumerate() {
                    row[3 * j + d] = q - factor * p;
                }
                row[x.len()] = -factor * p[d];
            }
        }
    }
}

/// Equal normal curvature of a curve before and after a ruling: `n·(|d₁|² e₂ − |d₂|² e₁) = 0` over a product of lengths that
/// is renewed with every step, with `n·d₁ = n·d₂ = n·r = 0`, `|n| = 1`. Private unknown n.
#[derive(Clone, Debug)]
pub(crate) struct SameCurvature {
    support: Support,
    scale: f64,
}

impl SameCurvature {
    /// First and second derivatives of the curve where it ends and where it goes on, and the ruling.
    pub fn new(first: [&Stencil; 2], second: [&Stencil; 2], ruling: &Stencil) -> Self {
        Self { support: Support::new(&[first[0], first[1], second[0], second[1], ruling]), scale: 1.0 }
    }

    fn vectors(&self, x: &[f64]) -> [Vec3; 5] {
        [0, 1, 2, 3, 4].map(|k| self.support.vector(k, x))
    }
}

impl Block for SameCurvature {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        5
    }

    fn private(&self) -> usize {
        3
    }

    fn begin(&self, x: &[f64], own: &mut [f64]) {
        let [d1, _, d2, _, r] = self.vectors(x);
        let n = (d1 + d2).cross(&r).try_normalize(0.0).unwrap_or(Vec3::z());
        own.copy_from_slice(n.as_slice());
    }

    fn refresh(&mut self, x: &[f64]) {
        let [d1, _, d2, _, _] = self.vectors(x);
        let size = d1.norm() * d2.norm();
        if size > 0.0 && size.is_finite() {
            self.scale = 1.0 / size;
        }
    }

    fn evaluate(&self, x: &[f64], own: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let [d1, e1, d2, e2, r] = self.vectors(x);
        let n = Vec3::from_column_slice(own);
        let (p, q) = (d1.norm_squared(), d2.norm_squared());
        let difference = (e2 * p - e1 * q) * self.scale;
        residual.copy_from_slice(&[
            n.dot(&difference),
            n.dot(&d1),
            n.dot(&d2),
            n.dot(&r),
            0.5 * (n.norm_squared() - 1.0),
        ]);
        let Some(jacobian) = jacobian else { return };
        jacobian.fill(0.0);
        let width = x.len() + 3;
        let (row, rest) = jacobian.split_at_mut(width);
        let s = self.scale;
        self.support.spread(0, &(d1 * (2.0 * s * n.dot(&e2))), row);
        self.support.spread(1, &(n * (-s * q)), row);
        self.support.spread(2, &(d2 * (-2.0 * s * n.dot(&e1))), row);
        self.support.spread(3, &(n * (s * p)), row);
        row[x.len()..].copy_from_slice(difference.as_slice());
        for (row, (k, v)) in rest.chunks_exact_mut(width).zip([(0, d1), (2, d2), (4, r)]) {
            self.support.spread(k, &n, row);
            row[x.len()..].copy_from_slice(v.as_slice());
        }
        rest[3 * width + x.len()..].copy_from_slice(n.as_slice());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::{check, check_at, noise};

    #[test]
    fn derivatives_are_right() {
        let s = |k: u32| Stencil(vec![(3 * k, 1.0), (3 * k + 3, -0.6), (3 * k + 6, 0.3)]);
        check(&mut SameDirection::new(&s(0), &s(1)), 1.0);
        check(&mut SameDirection::both([&s(0), &s(1)], [&s(2), &s(3)]), 1.5);
        let mut block = SameCurvature::new([&s(0), &s(1)], [&s(2), &s(3)], &s(4));
        block.refresh(&noise(21, 2.0));
        check_at(&block, &noise(21, 3.0), &noise(3, 4.0));
    }

    #[test]
    fn a_parabola_cut_in_two_is_smooth_of_second_order() {
        // y = x²/2 in the plane z = 0 before and after x = 1, at different speeds; rulings along z.
        let block = {
            let p = |k: u32| Stencil::point(3 * k);
            SameCurvature::new([&p(0), &p(1)], [&p(2), &p(3)], &p(4))
        };
        let speed = 3.0;
        let x =
            [[1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [speed, speed, 0.0], [0.7, 0.7 + speed * speed, 0.0], [0.0, 0.0, 1.0]]
                .concat();
        let mut own = [0.0; 3];
        block.begin(&x, &mut own);
        let mut out = [0.0; 5];
        block.evaluate(&x, &own, &mut out, None);
        assert!(out.iter().all(|r| r.abs() < 1e-12), "{out:?}");
    }
}
