//! Scalar bicubic B-splines on a rectangle of the parameter plane.

use super::knots::Knots;
use super::SplineError;

/// A bicubic function `φ(u, v) = Σ c_ij N_i(u) N_j(v)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Knots in u.
    pub(crate) knots_u: Knots,
    /// Knots in v.
    pub(crate) knots_v: Knots,
    /// Coefficients, row-major: index `i * n_v + j`.
    pub(crate) coefficients: Vec<f64>,
}

impl Field {
    /// A bicubic field with `spans × spans` spans over `[u0, u1] × [v0, v1]`, zero everywhere.
    ///
    /// # Errors
    /// An empty rectangle.
    pub fn bicubic([u0, u1, v0, v1]: [f64; 4], spans: usize) -> Result<Self, SplineError> {
        let (knots_u, knots_v) = (Knots::uniform(3, spans, u0, u1)?, Knots::uniform(3, spans, v0, v1)?);
        let coefficients = vec![0.0; knots_u.control_count() * knots_v.control_count()];
        Ok(Self { knots_u, knots_v, coefficients })
    }

    /// Sets the field to `a u + b v`, which it represents exactly.
    pub fn set_linear(&mut self, a: f64, b: f64) {
        let (gu, gv) = (greville(&self.knots_u), greville(&self.knots_v));
        for (i, u) in gu.iter().enumerate() {
            for (j, v) in gv.iter().enumerate() {
                self.coefficients[i * gv.len() + j] = a * u + b * v;
            }
        }
    }

    /// The basis functions that are not zero at a point: `(coefficient index, N, ∂N/∂u, ∂N/∂v)`.
    pub fn basis(&self, u: f64, v: f64) -> Vec<(usize, f64, f64, f64)> {
        let (bu, bv) = (self.knots_u.basis(u, 1), self.knots_v.basis(v, 1));
        let n = self.knots_v.control_count();
        let mut out = Vec::with_capacity(16);
        for i in 0..=self.knots_u.degree() {
            for j in 0..=self.knots_v.degree() {
                out.push((
                    (bu.first + i) * n + bv.first + j,
                    bu.rows[0][i] * bv.rows[0][j],
                    bu.rows[1][i] * bv.rows[0][j],
                    bu.rows[0][i] * bv.rows[1][j],
                ));
            }
        }
        out
    }

    /// Value and gradient. Outside the rectangle the tangent plane at the nearest point is used.
    pub fn jet(&self, u: f64, v: f64) -> [f64; 3] {
        let ((u0, u1), (v0, v1)) = (self.knots_u.domain(), self.knots_v.domain());
        let (cu, cv) = (u.clamp(u0, u1), v.clamp(v0, v1));
        let ((first_u, bu), (first_v, bv)) = (self.knots_u.basis_fixed::<4>(cu), self.knots_v.basis_fixed::<4>(cv));
        let n = self.knots_v.control_count();
        let mut out = [0.0; 3];
        for i in 0..4 {
            let row = &self.coefficients[(first_u + i) * n + first_v..][..4];
            let sum = |b: &[f64; 4]| b[0] * row[0] + b[1] * row[1] + b[2] * row[2] + b[3] * row[3];
            let (s, d) = (sum(&bv[0]), sum(&bv[1]));
            out[0] += bu[0][i] * s;
            out[1] += bu[1][i] * s;
            out[2] += bu[0][i] * d;
        }
        out[0] += out[1] * (u - cu) + out[2] * (v - cv);
        out
    }

    /// Value at a point, see [`Field::jet`].
    pub fn value(&self, p: [f64; 2]) -> f64 {
        self.jet(p[0], p[1])[0]
    }
}

/// Greville abscissae: means of `degree` consecutive knots.
fn greville(k: &Knots) -> Vec<f64> {
    let p = k.degree();
    (0..k.control_count()).map(|i| k.values()[i + 1..=i + p].iter().sum::<f64>() / p as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_functions_are_exact_inside_and_outside() {
        let mut f = Field::bicubic([-1.0, 3.0, 2.0, 5.0], 4).expect("field");
        f.set_linear(0.7, -1.3);
        for (u, v) in [(0.1, 2.2), (2.9, 4.9), (5.0, 1.0)] {
            let j = f.jet(u, v);
            assert!((j[0] - (0.7 * u - 1.3 * v)).abs() < 1e-12);
            assert!((j[1] - 0.7).abs() < 1e-12 && (j[2] + 1.3).abs() < 1e-12);
        }
    }
}
