//! Three vectors in one plane, and points in a common plane that is itself unknown.

use super::stencil::{Stencil, Support};
use crate::geom::Vec3;
use crate::num::gauss_newton::Block;

/// `det(u, v, w) = 0` for three combinations of points, divided by a product of lengths that is renewed with every step:
/// the row is the height of `w` over the plane of `u` and `v`, as long as these are not parallel.
#[derive(Clone, Debug)]
pub(crate) struct Coplanarity {
    support: Support,
    scale: f64,
}

/// Sine of the angle between `u` and `v` below which the height over their plane says nothing, and the row is scaled as if it
/// were this.
const FLAT: f64 = 0.05;

impl Coplanarity {
    /// Three vectors: combinations whose coefficients sum to zero, or derivatives.
    pub fn new(u: &Stencil, v: &Stencil, w: &Stencil) -> Self {
        Self { support: Support::new(&[u, v, w]), scale: 1.0 }
    }

    fn vectors(&self, x: &[f64]) -> [Vec3; 3] {
        [0, 1, 2].map(|k| self.support.vector(k, x))
    }
}

impl Block for Coplanarity {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        1
    }

    fn refresh(&mut self, x: &[f64]) {
        let [u, v, _] = self.vectors(x);
        let size = u.cross(&v).norm().max(FLAT * u.norm() * v.norm());
        if size > 0.0 && size.is_finite() {
            self.scale = 1.0 / size;
        }
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let [u, v, w] = self.vectors(x);
        residual[0] = self.scale * u.cross(&v).dot(&w);
        if let Some(row) = jacobian {
            row.fill(0.0);
            for (k, gradient) in [v.cross(&w), w.cross(&u), u.cross(&v)].iter().enumerate() {
                self.support.spread(k, &(gradient * self.scale), row);
            }
        }
    }
}

/// `n·p + h = 0` for a point `p` and an unknown plane: its normal is a point of the system, `h` an unknown.
#[derive(Clone, Debug)]
pub(crate) struct InPlane {
    support: Support,
    unknowns: Vec<u32>,
}

impl InPlane {
    /// A combination of points with sum 1, the first unknown of the normal, the unknown `h`.
    pub fn new(p: &Stencil, normal: u32, height: u32) -> Self {
        let support = Support::new(&[p, &Stencil::point(normal)]);
        let unknowns = support.unknowns().iter().copied().chain([height]).collect();
        Self { support, unknowns }
    }
}

impl Block for InPlane {
    fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let (points, height) = x.split_at(x.len() - 1);
        let (p, n) = (self.support.vector(0, points), self.support.vector(1, points));
        residual[0] = n.dot(&p) + height[0];
        if let Some(row) = jacobian {
            row.fill(0.0);
            self.support.spread(0, &n, row);
            self.support.spread(1, &p, row);
            row[x.len() - 1] = 1.0;
        }
    }
}

/// `(|v|² − 1)/2 = 0`: an unknown vector of unit length.
#[derive(Clone, Debug)]
pub struct Unit {
    unknowns: [u32; 3],
}

impl Unit {
    /// The vector by its first unknown.
    pub fn new(vector: u32) -> Self {
        Self { unknowns: [vector, vector + 1, vector + 2] }
    }
}

impl Block for Unit {
    fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        residual[0] = 0.5 * (x.iter().map(|v| v * v).sum::<f64>() - 1.0);
        if let Some(row) = jacobian {
            row.copy_from_slice(x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four points, named by their first unknowns.
    fn of_points(p: [u32; 4]) -> Coplanarity {
        let from = |k: usize| Stencil::point(p[k]).minus(&Stencil::point(p[0]));
        Coplanarity::new(&from(1), &from(2), &from(3))
    }
    use crate::constraint::derivative_check::{check, check_at, noise};

    #[test]
    fn derivatives_are_right() {
        let mut block = of_points([0, 3, 6, 9]);
        // The scale belongs to the step, so it is kept.
        block.refresh(&noise(12, 1.0));
        check_at(&block, &noise(12, 2.0), &[]);
        check(&mut InPlane::new(&Stencil::point(0).times(0.4).plus(&Stencil::point(3).times(0.6)), 6, 9), 4.0);
        check(&mut Unit::new(0), 5.0);
    }

    #[test]
    fn the_row_is_the_height_over_the_plane() {
        let mut block = of_points([0, 3, 6, 9]);
        let x = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.5, 3.0, 0.0, 0.3, 0.4, 0.25];
        block.refresh(&x);
        let mut out = [0.0];
        block.evaluate(&x, &[], &mut out, None);
        assert!((out[0] - 0.25).abs() < 1e-15);
    }
}
