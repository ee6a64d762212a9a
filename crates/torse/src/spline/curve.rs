//! B-spline curves in `R^D`. Rational curves of space are curves in `R^4` (homogeneous, weight last).

use super::knots::Knots;
use super::SplineError;

/// A B-spline curve with control points in `R^D`.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve<const D: usize> {
    /// Knots and degree.
    pub knots: Knots,
    /// Control points, as many as the knots ask for.
    pub control: Vec<[f64; D]>,
}

impl<const D: usize> Curve<D> {
    /// Checks and stores a curve.
    ///
    /// # Errors
    /// Knots that do not fit, control points that are not finite.
    pub fn new(degree: usize, knots: Vec<f64>, control: Vec<[f64; D]>) -> Result<Self, SplineError> {
        let knots = Knots::new(degree, knots, control.len())?;
        for (index, c) in control.iter().enumerate() {
            if c.iter().any(|x| !x.is_finite()) {
                return Err(SplineError::Control { index, reason: "a coordinate is not a finite number".into() });
            }
        }
        Ok(Self { knots, control })
    }

    /// Value and first two derivatives at `t` (of the last span's polynomial outside the domain).
    pub fn jet(&self, t: f64) -> [[f64; D]; 3] {
        let b = self.knots.basis(t, 2);
        let mut out = [[0.0; D]; 3];
        for (k, row) in out.iter_mut().enumerate() {
            for j in 0..=self.knots.degree() {
                let c = &self.control[b.first + j];
                for d in 0..D {
                    row[d] += b.rows[k][j] * c[d];
                }
            }
        }
        out
    }

    /// Value at `t`.
    pub fn point(&self, t: f64) -> [f64; D] {
        let b = self.knots.basis(t, 0);
        let mut out = [0.0; D];
        for j in 0..=self.knots.degree() {
            let c = &self.control[b.first + j];
            for d in 0..D {
                out[d] += b.rows[0][j] * c[d];
            }
        }
        out
    }

    /// Ends of the parameter domain.
    pub fn domain(&self) -> (f64, f64) {
        self.knots.domain()
    }
}

/// Bézier pieces `(a, b, control points)` of a curve, by inserting every interior knot up to the degree.
pub fn bezier_pieces<const D: usize>(curve: &Curve<D>) -> Vec<(f64, f64, Vec<[f64; D]>)> {
    let (p, v) = (curve.knots.degree(), curve.knots.values());
    let breaks = curve.knots.breaks();
    breaks
        .windows(2)
        .map(|w| {
            let span = curve.knots.span(0.5 * (w[0] + w[1]));
            let net: Vec<[f64; D]> = curve.control[span - p..=span].to_vec();
            let bez = (0..=p)
                .map(|k| {
                    let mut args = vec![w[0]; p - k];
                    args.extend(std::iter::repeat_n(w[1], k));
                    blossom_on_span(&net, v, span, p, &args)
                })
                .collect();
            (w[0], w[1], bez)
        })
        .collect()
}

/// Blossom (polar form) of the polynomial piece on `span` at `args` (as many as the degree), by the de Boor scheme.
fn blossom_on_span<const D: usize>(net: &[[f64; D]], v: &[f64], span: usize, p: usize, args: &[f64]) -> [f64; D] {
    let mut d = net.to_vec();
    for r in 1..=p {
        for j in (r..=p).rev() {
            let i = span - p + j;
            let a = (args[r - 1] - v[i]) / (v[i + p + 1 - r] - v[i]);
            for c in 0..D {
                d[j][c] = (1.0 - a) * d[j - 1][c] + a * d[j][c];
            }
        }
    }
    d[p]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bezier_pieces_reproduce_the_curve() {
        let c = Curve::<2>::new(
            3,
            vec![0., 0., 0., 0., 0.4, 1., 1., 1., 1.],
            vec![[0., 0.], [1., 2.], [2., -1.], [3., 1.], [4., 0.]],
        )
        .expect("valid curve");
        for (a, b, bez) in bezier_pieces(&c) {
            let t: f64 = 0.3;
            let q = c.point(a + t * (b - a));
            let w = [(1. - t).powi(3), 3. * t * (1. - t).powi(2), 3. * t * t * (1. - t), t.powi(3)];
            for d in 0..2 {
                let s: f64 = (0..4).map(|i| w[i] * bez[i][d]).sum();
                assert!((s - q[d]).abs() < 1e-14);
            }
        }
    }
}
