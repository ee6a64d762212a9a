//! What one can pull on: places, directions and planes that combinations of points are held to.
//!
//! Targets are points of the system, too. Frozen, they are given numbers that may change between solves without a new
//! set-up; free, they tie parts to each other.

use super::stencil::{Stencil, Support};
use crate::num::gauss_newton::Block;

/// `c Σ cᵢ pᵢ = 0`, three linear rows: two places that coincide, differences that vanish.
#[derive(Clone, Debug)]
pub(crate) struct Vanish {
    support: Support,
    factor: f64,
}

impl Vanish {
    /// The combination, and the factor of its rows.
    pub fn new(combination: &Stencil, factor: f64) -> Self {
        Self { support: Support::new(&[combination]), factor }
    }

    /// A place held to a target, a point of the system.
    pub fn at(place: &Stencil, target: u32) -> Self {
        Self::new(&place.clone().minus(&Stencil::point(target)), 1.0)
    }
}

impl Block for Vanish {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let v = self.support.vector(0, x) * self.factor;
        residual.copy_from_slice(v.as_slice());
        let Some(jacobian) = jacobian else { return };
        let width = x.len();
        for d in 0..3 {
            let row = &mut jacobian[d * width..(d + 1) * width];
            for (j, c) in self.support.coefficients(0).iter().enumerate() {
                row[3 * j + d] = self.factor * c;
            }
        }
    }
}

/// `d × t/|t| = 0`: a derivative in the direction of a vector of the system, forwards or backwards.
#[derive(Clone, Debug)]
pub(crate) struct Parallel {
    support: Support,
}

impl Parallel {
    /// The derivative, and the direction as a vector of the system.
    pub fn new(derivative: &Stencil, direction: u32) -> Self {
        Self { support: Support::new(&[derivative, &Stencil::point(direction)]) }
    }
}

impl Block for Parallel {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let (d, t) = (self.support.vector(0, x), self.support.vector(1, x));
        residual.copy_from_slice(d.cross(&t).as_slice());
        let Some(jacobian) = jacobian else { return };
        jacobian.fill(0.0);
        let width = x.len();
        for i in 0..3 {
            let row = &mut jacobian[i * width..(i + 1) * width];
            let mut e = crate::geom::Vec3::zeros();
            e[i] = 1.0;
            // e·(d × t) = d·(t × e) = t·(e × d).
            self.support.spread(0, &t.cross(&e), row);
            self.support.spread(1, &e.cross(&d), row);
        }
    }
}

/// `n·(p − o) = 0`: a place in the plane through `o` with normal `n`, both vectors of the system.
#[derive(Clone, Debug)]
pub(crate) struct OnPlane {
    support: Support,
}

impl OnPlane {
    /// The place, the plane's point and its normal.
    pub fn new(place: &Stencil, origin: u32, normal: u32) -> Self {
        let offset = place.clone().minus(&Stencil::point(origin));
        Self { support: Support::new(&[&offset, &Stencil::point(normal)]) }
    }
}

impl Block for OnPlane {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let (d, n) = (self.support.vector(0, x), self.support.vector(1, x));
        residual[0] = d.dot(&n);
        if let Some(row) = jacobian {
            row.fill(0.0);
            self.support.spread(0, &n, row);
            self.support.spread(1, &d, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check;

    #[test]
    fn derivatives_are_right() {
        let place = Stencil(vec![(0, 0.3), (3, 0.5), (6, 0.2)]);
        check(&mut Vanish::at(&place, 9), 1.0);
        check(&mut Vanish::new(&place, 2.5), 2.0);
        check(&mut Parallel::new(&place, 9), 3.0);
        check(&mut OnPlane::new(&place, 9, 12), 4.0);
    }

    #[test]
    fn rows_vanish_where_they_should() {
        let mut out = [0.0; 3];
        Parallel::new(&Stencil::point(0), 3).evaluate(&[0.4, -0.2, 1.0, 0.2, -0.1, 0.5], &[], &mut out, None);
        assert!(out.iter().all(|r| r.abs() < 1e-16));
        let plane = OnPlane::new(&Stencil::point(0), 3, 6);
        plane.evaluate(&[5.0, -7.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0], &[], &mut out, None);
        assert_eq!(out[0], 0.0);
    }
}
