//! Derivatives of any order, polynomial and rational.
//!
//! *Method.* Basis functions of lower degree are differenced upwards \[PT97, A2.3\]; derivatives of quotients by the
//! product rule \[PT97, 4.8 and 4.20\]. For order two on the hot path see [`Curve::jet`] and
//! [`Surface::jet`](super::surface::Surface::jet), which do not allocate.

use super::curve::Curve;
use super::knots::Knots;
use super::surface::Surface;
use super::{SplineError, MAX_DEGREE};
use crate::geom::Vec3;
use crate::num::binomial::binomial;

impl Knots {
    /// Derivatives `0..=order` of the `degree + 1` basis functions that live on `span`, at `t`: one row per order.
    /// Rows above the degree are zero.
    pub fn basis_derivatives(&self, span: usize, t: f64, order: usize) -> Vec<[f64; MAX_DEGREE + 1]> {
        let (p, v) = (self.degree(), self.values());
        let mut rows = vec![[0.0; MAX_DEGREE + 1]; order + 1];
        // The functions of each degree; where row k is wanted, degree p − k is differenced k times.
        let mut cur = [0.0; MAX_DEGREE + 1];
        cur[0] = 1.0;
        for d in 0..=p {
            if d > 0 {
                let mut saved = 0.0;
                for r in 0..d {
                    let (right, left) = (v[span + r + 1], v[span + 1 + r - d]);
                    let temp = cur[r] / (right - left);
                    cur[r] = saved + (right - t) * temp;
                    saved = (t - left) * temp;
                }
                cur[d] = saved;
            }
            let k = p - d;
            if k > order {
                continue;
            }
            let mut row = cur;
            for m in d + 1..=p {
                let low = row;
                for j in 0..=m {
                    let i = span - m + j;
                    let mut s = 0.0;
                    if j > 0 {
                        s += low[j - 1] / (v[i + m] - v[i]);
                    }
                    if j < m {
                        s -= low[j] / (v[i + m + 1] - v[i + 1]);
                    }
                    row[j] = m as f64 * s;
                }
            }
            rows[k] = row;
        }
        rows
    }
}

impl<const D: usize> Curve<D> {
    /// Derivatives `0..=order` at `t`, of the piece that [`Knots::span`] names there.
    pub fn derivatives(&self, t: f64, order: usize) -> Vec<[f64; D]> {
        let p = self.knots.degree();
        let span = self.knots.span(t);
        self.knots
            .basis_derivatives(span, t, order)
            .iter()
            .map(|row| {
                let mut sum = [0.0; D];
                for j in 0..=p {
                    for d in 0..D {
                        sum[d] += row[j] * self.control[span - p + j][d];
                    }
                }
                sum
            })
            .collect()
    }

    /// The derivative as a spline of one degree less on the same domain.
    ///
    /// # Errors
    /// Degree one, or a knot at which the curve has a corner: the derivative jumps there and is no spline curve.
    pub fn derivative(&self) -> Result<Self, SplineError> {
        let (p, v) = (self.knots.degree(), self.knots.values());
        if p < 2 {
            return Err(SplineError::Degree(p - 1));
        }
        let control = (0..self.control.len() - 1)
            .map(|i| {
                let scale = p as f64 / (v[i + p + 1] - v[i + 1]);
                std::array::from_fn(|d| scale * (self.control[i + 1][d] - self.control[i][d]))
            })
            .collect();
        Self::new(p - 1, v[1..v.len() - 1].to_vec(), control)
    }
}

/// Partial derivatives of a surface up to some total order.
#[derive(Clone, Debug, PartialEq)]
pub struct Partials {
    order: usize,
    values: Vec<Vec3>,
}

impl Partials {
    /// `∂^{k+l} S / ∂u^k ∂v^l`; zero vector beyond the order asked for.
    pub fn at(&self, k: usize, l: usize) -> Vec3 {
        if k + l > self.order {
            return Vec3::zeros();
        }
        self.values[k * (self.order + 1) + l]
    }
}

impl Surface {
    /// All partial derivatives of total order up to `order` at `(u, v)`.
    ///
    /// *Cost*: O(order² (p + 1)(q + 1)) for the sums; allocates.
    pub fn partials(&self, u: f64, v: f64, order: usize) -> Partials {
        let (p, q, row) = (self.knots_u.degree(), self.knots_v.degree(), self.row());
        let (su, sv) = (self.knots_u.span(u), self.knots_v.span(v));
        let bu = self.knots_u.basis_derivatives(su, u, order);
        let bv = self.knots_v.basis_derivatives(sv, v, order);
        let side = order + 1;
        let mut homogeneous = vec![[0.0; 4]; side * side];
        for k in 0..=order {
            for l in 0..=order - k {
                let sum = &mut homogeneous[k * side + l];
                for i in 0..=p {
                    for j in 0..=q {
                        let c = &self.control[(su - p + i) * row + sv - q + j];
                        let b = bu[k][i] * bv[l][j];
                        for d in 0..4 {
                            sum[d] += b * c[d];
                        }
                    }
                }
            }
        }
        let weight = |k: usize, l: usize| homogeneous[k * side + l][3];
        let mut values = vec![Vec3::zeros(); side * side];
        for k in 0..=order {
            for l in 0..=order - k {
                let h = &homogeneous[k * side + l];
                let mut sum = Vec3::new(h[0], h[1], h[2]);
                for i in 0..=k {
                    for j in 0..=l {
                        if i + j > 0 {
                            let c = binomial(k, i) * binomial(l, j) * weight(i, j);
                            sum -= values[(k - i) * side + l - j] * c;
                        }
                    }
                }
                values[k * side + l] = sum / weight(0, 0);
            }
        }
        Partials { order, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::sample::{any_curve, any_surface};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn derivatives_of_curves_match_differences(curve in any_curve(), t in 0.0..1.0f64) {
            // Difference within one piece, whatever knots are near: by its polynomial from the blossom.
            let p = curve.knots.degree();
            let at = |x: f64| curve.blossom(t, &vec![x; p]).expect("degree arguments");
            let d = curve.derivatives(t, p + 2);
            let breaks = curve.knots.breaks();
            let shortest = breaks.windows(2).fold(1.0f64, |m, w| m.min(w[1] - w[0]));
            let h = 1e-4 * shortest;
            let (a, b, c) = (at(t - h), at(t), at(t + h));
            for k in 0..3 {
                let scale = 100.0 / shortest;
                prop_assert!(((c[k] - a[k]) / (2.0 * h) - d[1][k]).abs() < 1e-4 * scale);
                prop_assert!(((c[k] - 2.0 * b[k] + a[k]) / (h * h) - d[2][k]).abs() < 1e-2 * scale * scale);
                prop_assert!(d[p + 1][k] == 0.0 && d[p + 2][k] == 0.0);
                let jet = curve.jet(t);
                for m in 0..3 {
                    prop_assert!((jet[m][k] - d[m][k]).abs() <= 1e-10 * scale.powi(m as i32) * 100.0);
                }
            }
        }

        #[test]
        fn partials_agree_with_the_jet_and_with_differences(s in any_surface(), u in 0.0..1.0f64, v in 0.0..1.0f64) {
            let (j, d) = (s.jet(u, v), s.partials(u, v, 3));
            for (a, b) in [(j.p, d.at(0, 0)), (j.du, d.at(1, 0)), (j.dv, d.at(0, 1)), (j.duu, d.at(2, 0)), (j.duv, d.at(1, 1)), (j.dvv, d.at(0, 2))] {
                prop_assert!((a - b).norm() <= 1e-9 * (1.0 + b.norm()));
            }
            // Third derivatives against differences of second ones, away from knots.
            let h = 1e-6;
            let near = |k: &Knots, t: f64| k.breaks().iter().any(|b| (b - t).abs() < 2.0 * h);
            prop_assume!(!near(&s.knots_u, u) && !near(&s.knots_v, v));
            let size = 1.0 + d.at(3, 0).norm() + d.at(2, 1).norm() + d.at(1, 2).norm();
            let duu = (s.jet(u + h, v).duu - s.jet(u - h, v).duu) / (2.0 * h);
            prop_assert!((duu - d.at(3, 0)).norm() < 1e-3 * size, "{} {}", duu, d.at(3, 0));
            let duv = (s.jet(u, v + h).duv - s.jet(u, v - h).duv) / (2.0 * h);
            prop_assert!((duv - d.at(1, 2)).norm() < 1e-3 * size);
        }
    }

    #[test]
    fn the_derivative_curve_is_the_derivative() {
        let c = Curve::<2>::new(
            3,
            vec![0., 0., 0., 0., 0.4, 0.4, 1., 1., 1., 1.],
            vec![[0., 0.], [1., 2.], [2., -1.], [3., 1.], [4., 0.], [1., 1.]],
        )
        .expect("curve");
        let d = c.derivative().expect("smooth enough");
        for t in [0.0, 0.2, 0.4, 0.9, 1.0] {
            for k in 0..2 {
                assert!((d.point(t)[k] - c.jet(t)[1][k]).abs() < 1e-12);
            }
        }
        let corner = Curve::<1>::new(2, vec![0., 0., 0., 0.5, 0.5, 1., 1., 1.], vec![[0.], [1.], [0.], [1.], [0.]]);
        assert!(corner.expect("curve").derivative().is_err());
    }
}
