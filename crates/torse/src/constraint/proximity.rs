//! Closeness to a surface, to second order \[PH03\].
//!
//! The squared distance from a surface, near a point at the signed height d over the foot q, is
//! `(n·(p − q))² + Σ dκᵢ/(dκᵢ − 1) (eᵢ·(p − q))²` with principal directions eᵢ and curvatures κᵢ at q (lemma 2.8 of \[W15\]).
//! Coefficients below zero are left out, those beyond a centre of curvature are one. Feet are renewed with every step.

use super::reference::{Foot, Reference};
use super::stencil::{Stencil, Support};
use crate::geom::Vec3;
use crate::num::gauss_newton::Block;
use std::sync::Arc;

/// From the lengths of a system to those of a reference: `origin + size · x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// Place of the system's origin, mm.
    pub origin: Vec3,
    /// Length of the system's unit, mm.
    pub size: f64,
}

/// A place held near a reference.
#[derive(Clone)]
pub(crate) struct Proximity {
    support: Support,
    reference: Arc<dyn Reference>,
    scale: Scale,
    foot: Option<Foot>,
    /// Directions with factors, in the system's units.
    rows: [Vec3; 3],
    at: Vec3,
}

/// Coefficients of the squared offsets in both principal directions and along the normal, for curvatures `k` (1/mm) at the
/// signed height `d` (mm): lemma 2.8, as it is below both centres of curvature.
pub fn squared_distance(d: f64, k: [f64; 2]) -> [f64; 3] {
    let [a, b] = k.map(|k| d * k / (d * k - 1.0));
    [a, b, 1.0]
}

/// The same for both principal directions as rows use them: none below zero, and one beyond a centre of curvature.
pub(crate) fn tangential(d: f64, k: [f64; 2]) -> [f64; 2] {
    let [a, b, _] = squared_distance(d, k);
    let kept = |k: f64, a: f64| if d * k >= 1.0 { 1.0 } else { a.max(0.0) };
    [kept(k[0], a), kept(k[1], b)]
}

impl Proximity {
    /// A place of the system, a reference, and how lengths are to be read.
    pub fn new(place: &Stencil, reference: Arc<dyn Reference>, scale: Scale) -> Self {
        let rows = [Vec3::zeros(); 3];
        Self { support: Support::new(&[place]), reference, scale, foot: None, rows, at: Vec3::zeros() }
    }
}

impl Block for Proximity {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        3
    }

    fn refresh(&mut self, x: &[f64]) {
        let p = self.scale.origin + self.support.vector(0, x) * self.scale.size;
        let Some(foot) = self.reference.foot(&p, self.foot.as_ref()) else {
            self.rows = [Vec3::zeros(); 3];
            return;
        };
        let d = foot.normal.dot(&(p - foot.point));
        let [s, t] = tangential(d, foot.curvatures).map(f64::sqrt);
        self.rows = [foot.normal, foot.directions[0] * s, foot.directions[1] * t];
        self.at = (foot.point - self.scale.origin) / self.scale.size;
        self.foot = Some(foot);
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let off = self.support.vector(0, x) - self.at;
        for (r, e) in residual.iter_mut().zip(&self.rows) {
            *r = e.dot(&off);
        }
        let Some(jacobian) = jacobian else { return };
        jacobian.fill(0.0);
        for (row, e) in jacobian.chunks_exact_mut(x.len()).zip(&self.rows) {
            self.support.spread(0, e, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check;

    /// The unit sphere, normals outward.
    struct Sphere;

    impl Reference for Sphere {
        fn foot(&self, x: &Vec3, _: Option<&Foot>) -> Option<Foot> {
            let normal = x.try_normalize(0.0)?;
            let e = normal.cross(&Vec3::new(0.3, 0.5, 0.9)).try_normalize(0.0)?;
            let directions = [e, normal.cross(&e)];
            Some(Foot { point: normal, normal, directions, curvatures: [-1.0; 2], at: [0.0; 2], of: 0 })
        }
    }

    #[test]
    fn factors_are_those_of_the_lemma() {
        // κ = (0.5, −1) at d = 0.3: −0.15/0.85 and 0.3/1.3; the first is below zero and left out.
        let [s, t] = tangential(0.3, [0.5, -1.0]);
        assert!(s == 0.0 && (t - 0.3 / 1.3).abs() < 1e-15);
        assert_eq!(tangential(3.0, [0.5, 0.0]), [1.0, 0.0]);
    }

    #[test]
    fn rows_are_the_squared_distance_to_second_order() {
        let scale = Scale { origin: Vec3::zeros(), size: 1.0 };
        let mut block = Proximity::new(&Stencil::point(0), Arc::new(Sphere), scale);
        let p = Vec3::new(0.9, -0.7, 0.8);
        block.refresh(p.as_slice());
        let energy = |x: &Vec3| {
            let mut out = [0.0; 3];
            block.evaluate(x.as_slice(), &[], &mut out, None);
            out.iter().map(|r| r * r).sum::<f64>()
        };
        for k in 0..20 {
            let move_ = Vec3::new((k as f64).sin(), (2.0 * k as f64).cos(), (0.7 * k as f64).sin());
            let off = |h: f64| {
                let x = p + move_ * h;
                (energy(&x) - (x.norm() - 1.0).powi(2)).abs()
            };
            // Third order: eight times less at half the step.
            assert!(off(1e-2) < 1e-5 && off(5e-3) < 0.2 * off(1e-2) + 1e-12, "{k}: {} {}", off(1e-2), off(5e-3));
        }
        check(&mut block, 1.0);
    }
}
