//! Polynomials in Bernstein form, over numbers or intervals: the same formulae serve a quick look and a proof.
//!
//! Coefficients `b_0 … b_p` stand for `Σ b_i C(p,i) x^i (1−x)^{p−i}` on `0 ≤ x ≤ 1`; values stay in the hull of the
//! coefficients. With [`Interval`] coefficients every result encloses the exact one. Formulae: Farin, *Curves and
//! Surfaces for CAGD*, ch. 4–5 (de Casteljau, blossoms, degree elevation), \[PW99\] section 4 for products of planes
//! and points.

use super::binomial::binomial;
use super::interval::Interval;
use std::ops::{Add, Mul, Neg, Sub};

/// A number or an interval.
pub(crate) trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + From<f64> + Send + Sync
{
    /// Quotient `a / b` of two numbers, rounded or enclosed.
    fn ratio(a: f64, b: f64) -> Self;
    /// Sum of two numbers, rounded or enclosed.
    fn sum(a: f64, b: f64) -> Self;
    /// Quotient; everything (or not a number) when the divisor may be zero.
    fn over(self, divisor: Self) -> Self;
    /// Square root; of what may be negative, that of what is not.
    fn square_root(self) -> Self;
}

impl Scalar for f64 {
    #[inline]
    fn ratio(a: f64, b: f64) -> Self {
        a / b
    }
    #[inline]
    fn sum(a: f64, b: f64) -> Self {
        a + b
    }
    #[inline]
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }
    #[inline]
    fn square_root(self) -> Self {
        self.sqrt()
    }
}

impl Scalar for Interval {
    #[inline]
    fn ratio(a: f64, b: f64) -> Self {
        Self::point(a) / Self::point(b)
    }
    #[inline]
    fn sum(a: f64, b: f64) -> Self {
        Self::point(a) + Self::point(b)
    }
    #[inline]
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }
    #[inline]
    fn square_root(self) -> Self {
        self.sqrt()
    }
}

/// Bernstein coefficients of a B-spline piece over its own span. `net` holds the p + 1 coefficients of the piece
/// and `knots` the 2p knots around it: piece on `[knots[p−1], knots[p]]`.
pub(crate) fn from_spline<S: Scalar>(net: &[S], knots: &[f64]) -> Vec<S> {
    let p = net.len() - 1;
    if p == 0 {
        return net.to_vec();
    }
    from_spline_over(net, knots, knots[p - 1], knots[p])
}

/// Bernstein coefficients of a B-spline piece over any interval `[a, b]`; see [`from_spline`].
pub(crate) fn from_spline_over<S: Scalar>(net: &[S], knots: &[f64], a: f64, b: f64) -> Vec<S> {
    SplinePiece::new(net.len() - 1, knots, a, b).coefficients(net)
}

/// The change from the net of a B-spline piece to its Bernstein coefficients over an interval `[a, b]`: the same for all
/// components of a curve. See [`blossom`]; coefficient k is that of p − k times a and k times b.
pub(crate) struct SplinePiece<S> {
    degree: usize,
    /// Shares of the left and right neighbour for the arguments a and b, step by step.
    shares: [Vec<[S; 2]>; 2],
}

impl<S: Scalar> SplinePiece<S> {
    /// Of degree p, with the 2p knots around the piece.
    pub fn new(degree: usize, knots: &[f64], a: f64, b: f64) -> Self {
        let shares = [a, b].map(|x| {
            let mut all = Vec::with_capacity(degree * (degree + 1) / 2);
            for r in 1..=degree {
                for j in (r..=degree).rev() {
                    let (left, right) = (knots[j - 1], knots[j + degree - r]);
                    let width = S::sum(right, -left);
                    all.push([S::sum(right, -x).over(width), S::sum(x, -left).over(width)]);
                }
            }
            all
        });
        Self { degree, shares }
    }

    /// Bernstein coefficients of a net of p + 1 numbers.
    pub fn coefficients(&self, net: &[S]) -> Vec<S> {
        let net: Vec<[S; 1]> = net.iter().map(|x| [*x]).collect();
        self.of_points(&net).into_iter().map(|[x]| x).collect()
    }

    /// The same of a net of p + 1 points.
    pub fn of_points<const N: usize>(&self, net: &[[S; N]]) -> Vec<[S; N]> {
        let p = self.degree;
        // Steps 1 to r − 1 use so many shares.
        let before = |r: usize| (r - 1) * p - (r - 1) * r.saturating_sub(2) / 2;
        let step = |d: &mut [[S; N]], r: usize, argument: usize| {
            let shares = &self.shares[argument][before(r)..];
            for (j, [left, right]) in (r..=p).rev().zip(shares) {
                let from = d[j - 1];
                for (x, y) in d[j].iter_mut().zip(from) {
                    *x = *left * y + *right * *x;
                }
            }
        };
        let mut level = net.to_vec();
        let mut out = net.to_vec();
        let mut d = net.to_vec();
        for m in 0..=p {
            d.copy_from_slice(&level);
            for r in m + 1..=p {
                step(&mut d, r, 1);
            }
            out[p - m] = d[p];
            if m < p {
                step(&mut level, m + 1, 0);
            }
        }
        out
    }
}

/// Bernstein coefficients on `[a, b]` of a polynomial in powers of `x`.
pub(crate) fn from_powers<S: Scalar>(powers: &[S], a: S, b: S) -> Vec<S> {
    let n = powers.len();
    // Taylor shift to a (Horner's scheme repeated), then scaling by b − a.
    let mut c = powers.to_vec();
    for i in 0..n {
        for j in (i..n - 1).rev() {
            c[j] = c[j] + a * c[j + 1];
        }
    }
    let mut power = S::from(1.0);
    for x in c.iter_mut() {
        *x = *x * power;
        power = power * (b - a);
    }
    (0..n)
        .map(|i| {
            let mut s = c[0];
            for k in 1..=i {
                s = s + S::ratio(binomial(i, k), binomial(n - 1, k)) * c[k];
            }
            s
        })
        .collect()
}

/// The polynomial written with `degree ≥` its own.
pub(crate) fn with_degree<S: Scalar>(b: &[S], degree: usize) -> Vec<S> {
    let mut out = b.to_vec();
    while out.len() <= degree {
        out = elevated(&out);
    }
    out
}

/// Product with a scalar.
pub fn scaled<S: Scalar>(b: &[S], k: S) -> Vec<S> {
    b.iter().map(|&x| x * k).collect()
}

/// Value at `x`.
pub fn value<S: Scalar>(b: &[S], x: S) -> S {
    let mut d = b.to_vec();
    let y = S::from(1.0) - x;
    for r in 1..d.len() {
        for i in 0..d.len() - r {
            d[i] = y * d[i] + x * d[i + 1];
        }
    }
    d[0]
}

/// Derivative with respect to `x`, one degree lower.
pub fn derivative<S: Scalar>(b: &[S]) -> Vec<S> {
    if b.len() < 2 {
        return vec![S::from(0.0)];
    }
    let p = S::from((b.len() - 1) as f64);
    b.windows(2).map(|w| p * (w[1] - w[0])).collect()
}

/// The same polynomial written one degree higher.
pub fn elevated<S: Scalar>(b: &[S]) -> Vec<S> {
    let n = b.len();
    let mut out = Vec::with_capacity(n + 1);
    out.push(b[0]);
    for i in 1..n {
        out.push(S::ratio(i as f64, n as f64) * b[i - 1] + S::ratio((n - i) as f64, n as f64) * b[i]);
    }
    out.push(b[n - 1]);
    out
}

/// Product of two polynomials; degrees add.
pub fn product<S: Scalar>(a: &[S], b: &[S]) -> Vec<S> {
    let scaled =
        |c: &[S]| -> Vec<S> { c.iter().enumerate().map(|(i, &x)| x * S::from(binomial(c.len() - 1, i))).collect() };
    let (a, b) = (scaled(a), scaled(b));
    let (p, q) = (a.len() - 1, b.len() - 1);
    (0..=p + q)
        .map(|k| {
            let terms = (k.saturating_sub(q)..=k.min(p)).map(|i| a[i] * b[k - i]);
            terms.fold(S::from(0.0), |sum, term| sum + term) * S::ratio(1.0, binomial(p + q, k))
        })
        .collect()
}

/// Sum of polynomials of equal degree.
pub fn sum<S: Scalar>(a: &[S], b: &[S]) -> Vec<S> {
    a.iter().zip(b).map(|(&x, &y)| x + y).collect()
}

/// Difference of polynomials of equal degree.
pub fn difference<S: Scalar>(a: &[S], b: &[S]) -> Vec<S> {
    a.iter().zip(b).map(|(&x, &y)| x - y).collect()
}

/// Halves `[0, 1/2]` and `[1/2, 1]`.
pub fn halves<S: Scalar>(b: &[S]) -> (Vec<S>, Vec<S>) {
    split(b, S::from(0.5))
}

/// Parts `[0, x]` and `[x, 1]`.
pub fn split<S: Scalar>(b: &[S], x: S) -> (Vec<S>, Vec<S>) {
    let n = b.len();
    let y = S::from(1.0) - x;
    let mut d = b.to_vec();
    let mut left = Vec::with_capacity(n);
    let mut right = vec![S::from(0.0); n];
    for r in 0..n {
        left.push(d[0]);
        right[n - 1 - r] = d[n - 1 - r];
        for i in 0..n - 1 - r {
            d[i] = y * d[i] + x * d[i + 1];
        }
    }
    (left, right)
}

/// Coefficients in powers of `x − ½`: `c_k = C(p, k) (Δᵏ b)(½)`.
pub(crate) fn powers_about_half(b: &[Interval]) -> Vec<Interval> {
    let p = b.len() - 1;
    let mut differences = b.to_vec();
    (0..=p)
        .map(|k| {
            let mut v = differences.clone();
            while v.len() > 1 {
                v = v.windows(2).map(|w| (w[0] + w[1]).scale_exact(0.5)).collect();
            }
            let c = v[0] * binomial(p, k);
            differences = differences.windows(2).map(|w| w[1] - w[0]).collect();
            c
        })
        .collect()
}

/// Hull of the coefficients: encloses all values.
pub fn hull(b: &[Interval]) -> Interval {
    b.iter().skip(1).fold(b[0], |h, &x| h.hull(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_derivatives_and_pieces_agree_with_values() {
        let a = [1.0, -2.0, 0.5, 3.0];
        let b = [0.25, 1.0, -1.0];
        let ab = product(&a, &b);
        let (left, right) = split(&a, 0.3);
        for i in 0..=10 {
            let x = i as f64 / 10.0;
            assert!((value(&ab, x) - value(&a, x) * value(&b, x)).abs() < 1e-14);
            assert!((value(&elevated(&a), x) - value(&a, x)).abs() < 1e-14);
            assert!((value(&left, x) - value(&a, 0.3 * x)).abs() < 1e-14);
            assert!((value(&right, x) - value(&a, 0.3 + 0.7 * x)).abs() < 1e-14);
            let h = 1e-6;
            let slope = (value(&a, x + h) - value(&a, x - h)) / (2.0 * h);
            assert!((value(&derivative(&a), x) - slope).abs() < 1e-8);
        }
    }

    #[test]
    fn powers_are_converted() {
        let c = [1.0, -2.0, 0.5, 3.0];
        let b = from_powers(&c, 0.3, 0.9);
        for i in 0..=10 {
            let s = i as f64 / 10.0;
            let x: f64 = 0.3 + 0.6 * s;
            assert!((value(&b, s) - (1.0 - 2.0 * x + 0.5 * x * x + 3.0 * x * x * x)).abs() < 1e-14);
        }
        assert!(with_degree(&c, 6).len() == 7 && (value(&with_degree(&c, 6), 0.4) - value(&c, 0.4)).abs() < 1e-14);
    }

    #[test]
    fn spline_pieces_are_enclosed() {
        // Knots 0,0,0 | .4 | 1,1,1 with cubic coefficients; first piece [0, .4].
        let knots = [0.0, 0.0, 0.0, 0.4, 1.0, 1.0];
        let net = [0.0, 1.0, -1.0, 2.0];
        let exact = from_spline::<f64>(&net, &knots);
        let enclosed = from_spline::<Interval>(&net.map(Interval::point), &knots);
        for (x, e) in exact.iter().zip(&enclosed) {
            assert!(e.contains(*x) && e.rad() < 1e-14);
        }
        assert!((exact[3] - value(&exact, 1.0)).abs() < 1e-15);
        assert!(hull(&enclosed).contains(value(&exact, 0.37)));
    }
}
