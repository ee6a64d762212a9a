//! B-spline curves in `R^D`. Rational curves of space are curves in `R^4` (homogeneous, weight last).

use super::knots::Knots;
use super::{blossom, SplineError};

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
        match self.knots.degree() {
            1 => return self.fixed_degree_jet::<2>(t),
            2 => return self.fixed_degree_jet::<3>(t),
            3 => return self.fixed_degree_jet::<4>(t),
            5 => return self.fixed_degree_jet::<6>(t),
            _ => {}
        }
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

    /// [`Curve::jet`] for degree `N − 1`.
    #[inline(always)]
    fn fixed_degree_jet<const N: usize>(&self, t: f64) -> [[f64; D]; 3] {
        let (first, basis) = self.knots.basis_fixed::<N>(t);
        let mut out = [[0.0; D]; 3];
        for (j, c) in self.control[first..first + N].iter().enumerate() {
            for k in 0..3 {
                for d in 0..D {
                    out[k][d] += basis[k][j] * c[d];
                }
            }
        }
        out
    }

    /// Value at `t`.
    pub fn point(&self, t: f64) -> [f64; D] {
        // The compiler leaves out what belongs to the derivatives.
        match self.knots.degree() {
            1 => return self.fixed_degree_jet::<2>(t)[0],
            2 => return self.fixed_degree_jet::<3>(t)[0],
            3 => return self.fixed_degree_jet::<4>(t)[0],
            5 => return self.fixed_degree_jet::<6>(t)[0],
            _ => {}
        }
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

impl<const D: usize> Curve<D> {
    /// Blossom of the polynomial piece that holds the parameter `at`. With all arguments equal to `t` it is that
    /// piece at `t`.
    ///
    /// # Errors
    /// `None` unless there are as many arguments as the degree.
    pub fn blossom(&self, at: f64, args: &[f64]) -> Option<[f64; D]> {
        let p = self.knots.degree();
        if args.len() != p {
            return None;
        }
        let span = self.knots.span(at);
        let mut net = self.control[span - p..=span].to_vec();
        Some(blossom::of_piece(&self.knots, span, &mut net, args))
    }
}

/// Bézier pieces `(a, b, control points)` of a curve, by inserting every interior knot up to the degree.
pub fn bezier_pieces<const D: usize>(curve: &Curve<D>) -> Vec<(f64, f64, Vec<[f64; D]>)> {
    let p = curve.knots.degree();
    let breaks = curve.knots.breaks();
    breaks
        .windows(2)
        .map(|w| {
            let span = curve.knots.span(0.5 * (w[0] + w[1]));
            let net = &curve.control[span - p..=span];
            let bez = (0..=p)
                .map(|k| {
                    let mut args = vec![w[0]; p - k];
                    args.extend(std::iter::repeat_n(w[1], k));
                    blossom::of_piece(&curve.knots, span, &mut net.to_vec(), &args)
                })
                .collect();
            (w[0], w[1], bez)
        })
        .collect()
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
