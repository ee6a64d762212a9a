//! Linear combinations of unknown points: values and derivatives of splines \[PT97\], differences, midpoints.

use crate::geom::Vec3;
use crate::spline::knots::Knots;

/// `Σ cᵢ pᵢ`; a point is named by the index of the first of its three unknowns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stencil(pub Vec<(u32, f64)>);

impl Stencil {
    /// One point.
    pub fn point(p: u32) -> Self {
        Self(vec![(p, 1.0)])
    }

    /// Value and first two derivatives at `t` of the spline with these control points. Derivatives are taken with respect
    /// to `t/unit`.
    pub fn jet(knots: &Knots, points: &[u32], t: f64, unit: f64) -> [Self; 3] {
        let basis = knots.basis(t, 2);
        let mut factor = 1.0;
        [0, 1, 2].map(|k: usize| {
            let row = &basis.rows[k][..=knots.degree()];
            let out = row.iter().enumerate().map(|(j, b)| (points[basis.first + j], factor * b)).collect();
            factor *= unit;
            Self(out)
        })
    }

    /// The combination times a number.
    pub fn times(mut self, factor: f64) -> Self {
        self.0.iter_mut().for_each(|t| t.1 *= factor);
        self
    }

    /// The sum of two combinations.
    pub fn plus(mut self, other: &Self) -> Self {
        self.0.extend_from_slice(&other.0);
        self
    }

    /// The difference of two combinations.
    pub fn minus(self, other: &Self) -> Self {
        self.plus(&other.clone().times(-1.0))
    }

    /// Value for given unknowns.
    pub fn value(&self, x: &[f64]) -> Vec3 {
        self.0.iter().map(|&(p, c)| c * Vec3::from_column_slice(&x[p as usize..p as usize + 3])).sum()
    }
}

/// Several combinations of the same points, for one block.
#[derive(Clone, Debug)]
pub struct Support {
    unknowns: Vec<u32>,
    /// Per combination, a number per point.
    coefficients: Vec<f64>,
    points: usize,
}

impl Support {
    /// All points of the combinations, in order of their unknowns, each once.
    pub fn new(stencils: &[&Stencil]) -> Self {
        let mut points: Vec<u32> = stencils.iter().flat_map(|s| s.0.iter().map(|t| t.0)).collect();
        points.sort_unstable();
        points.dedup();
        let mut coefficients = vec![0.0; stencils.len() * points.len()];
        for (s, row) in stencils.iter().zip(coefficients.chunks_mut(points.len().max(1))) {
            for (p, c) in &s.0 {
                if let Ok(k) = points.binary_search(p) {
                    row[k] += c;
                }
            }
        }
        let unknowns = points.iter().flat_map(|&p| [p, p + 1, p + 2]).collect();
        Self { unknowns, coefficients, points: points.len() }
    }

    /// Unknowns of all points.
    pub fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    /// Coefficients of combination `k`, one per point.
    #[inline]
    pub fn coefficients(&self, k: usize) -> &[f64] {
        &self.coefficients[k * self.points..(k + 1) * self.points]
    }

    /// Combination `k` for given values of the unknowns.
    #[inline]
    pub fn vector(&self, k: usize, x: &[f64]) -> Vec3 {
        let mut out = Vec3::zeros();
        for (c, p) in self.coefficients(k).iter().zip(x.chunks_exact(3)) {
            out.x += c * p[0];
            out.y += c * p[1];
            out.z += c * p[2];
        }
        out
    }

    /// Adds to a row of a Jacobian the derivative of a function whose gradient with respect to combination `k` is given.
    #[inline]
    pub fn spread(&self, k: usize, gradient: &Vec3, row: &mut [f64]) {
        for (c, out) in self.coefficients(k).iter().zip(row.chunks_exact_mut(3)) {
            out[0] += c * gradient.x;
            out[1] += c * gradient.y;
            out[2] += c * gradient.z;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stencils_are_the_curve_and_its_derivatives() {
        let knots = Knots::uniform(3, 4, 0.0, 2.0).expect("knots");
        let n = knots.control_count();
        let points: Vec<u32> = (0..n as u32).map(|i| 3 * i).collect();
        let x: Vec<f64> = (0..3 * n).map(|i| (0.7 * i as f64).sin()).collect();
        let control = x.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
        let curve = crate::spline::curve::Curve::new(3, knots.values().to_vec(), control).expect("curve");
        let jet = curve.jet(0.83);
        for (k, s) in Stencil::jet(&knots, &points, 0.83, 0.5).iter().enumerate() {
            let wanted = Vec3::from(jet[k]) * 0.5f64.powi(k as i32);
            assert!((s.value(&x) - wanted).norm() < 1e-12);
        }
    }

    #[test]
    fn points_that_occur_twice_are_one() {
        let s = Stencil::point(3).plus(&Stencil::point(0)).minus(&Stencil::point(3));
        let support = Support::new(&[&s, &Stencil::point(3)]);
        assert_eq!(support.unknowns(), [0, 1, 2, 3, 4, 5]);
        let x = [1.0, 2.0, 3.0, 9.0, 9.0, 8.0];
        assert_eq!(support.vector(0, &x), Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(support.vector(1, &x), Vec3::new(9.0, 9.0, 8.0));
    }
}
