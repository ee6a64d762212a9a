//! Polynomials over [−1, 1] kept as a few coefficients and a bound of all that these leave out: what cancels between two of
//! them cancels, where enclosures by intervals would remember both.
//!
//! Arithmetic of Taylor models \[MB03\], with one difference: the rest, too, is a polynomial, of known degree, and what is
//! bounded is the sum of the sizes of its coefficients. So derivatives have bounds as well: the rest of a derivative is at most
//! the degree times as large.

use super::bernstein::powers_about_half;
use super::interval::Interval;
use std::ops::{Add, Mul, Neg, Sub};

/// Degree up to which coefficients are kept.
const KEPT: usize = 8;
const N: usize = KEPT + 1;

/// Covers the rounding of a coefficient of a product, or of a sum of a few terms, against the sum of the sizes of all terms.
const ROUNDING: f64 = 32.0 * f64::EPSILON;
/// Covers the rounding of a sum of positive terms, thousands of times over.
const UP: f64 = 1.0 + 1e-12;

/// Covers what products that are nearly zero lose below the smallest number.
const TINY: f64 = f64::MIN_POSITIVE * (N * N) as f64;

/// A polynomial over [−1, 1]: `Σ c_k τ^k` and a rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TaylorModel {
    c: [f64; N],
    /// Bound of the sum of the absolute values of the rest's coefficients.
    rest: f64,
    /// Degree of the whole.
    degree: usize,
}

impl TaylorModel {
    /// A constant known to lie in an interval.
    pub fn constant(v: Interval) -> Self {
        let mut c = [0.0; N];
        c[0] = v.mid();
        Self { c, rest: v.rad(), degree: 0 }
    }

    /// The polynomial with the given Bernstein coefficients over [0, 1], in `τ = 2x − 1`.
    pub fn of_bernstein(b: &[Interval]) -> Self {
        Self::of_powers(&powers_about_half(b))
    }

    /// The polynomial with these coefficients of the powers of `τ/2`.
    fn of_powers(powers: &[Interval]) -> Self {
        let mut out = Self { c: [0.0; N], rest: 0.0, degree: powers.len().saturating_sub(1) };
        let mut scale = 1.0;
        for (k, p) in powers.iter().enumerate() {
            let p = p.scale_exact(scale);
            match out.c.get_mut(k) {
                Some(c) => {
                    *c = p.mid();
                    out.rest += p.rad();
                }
                None => out.rest += p.mag(),
            }
            scale *= 0.5;
        }
        out.rest *= UP;
        out
    }

    /// Its powers, from the constant one up to the given power.
    pub fn powers(self, most: usize) -> Vec<Self> {
        let one = Self::constant(Interval::ONE);
        std::iter::successors(Some(one), |p| Some(*p * self)).take(most + 1).collect()
    }

    /// A polynomial of a function: coefficients of the powers, from the constant up, and the powers of the function.
    pub fn combination(coefficients: &[Interval], powers: &[Self]) -> Self {
        let mut out = Self { c: [0.0; N], rest: 0.0, degree: 0 };
        for (a, p) in coefficients.iter().zip(powers) {
            let (m, size) = (a.mid(), p.size());
            for (c, x) in out.c.iter_mut().zip(&p.c) {
                *c += m * x;
            }
            // Sums of a few terms, each rounded as often.
            out.rest += (a.rad() + m.abs() * ROUNDING) * (size + p.rest) + m.abs() * p.rest + TINY;
            out.degree = out.degree.max(p.degree);
        }
        out.rest *= UP;
        out
    }

    /// The values at −1 and 1.
    pub fn ends(&self) -> [Interval; 2] {
        let even: f64 = self.c.iter().step_by(2).sum();
        let odd: f64 = self.c.iter().skip(1).step_by(2).sum();
        let reach = (self.rest + self.size() * ROUNDING) * UP;
        [even - odd, even + odd].map(|v| Interval::point(v).widen(reach))
    }

    /// The largest distance of a value from those at the ends, or between them.
    pub fn chord_deviation(&self) -> f64 {
        // τ² − 1, τ³ − τ and the others less 1 or τ are at most these.
        const OFF_CHORD: [f64; N] = [0.0, 0.0, 1.0, 0.385, 1.0, 0.535, 1.0, 0.621, 1.0];
        let known: f64 = self.c.iter().zip(OFF_CHORD).map(|(c, m)| c.abs() * m).sum();
        (known + 2.0 * self.rest + self.size() * ROUNDING) * UP
    }

    /// All values.
    pub fn range(&self) -> Interval {
        let [a, b] = self.ends();
        a.hull(b).widen(self.chord_deviation())
    }

    /// The derivative by τ.
    pub fn derivative(&self) -> Self {
        let mut c = [0.0; N];
        for k in 1..N {
            c[k - 1] = self.c[k] * k as f64;
        }
        let rest = (self.degree as f64 * self.rest + self.size() * N as f64 * ROUNDING) * UP;
        Self { c, rest, degree: self.degree.saturating_sub(1) }
    }

    /// Product with what lies in an interval.
    pub fn times(self, k: Interval) -> Self {
        Self::combination(&[k], &[self])
    }

    /// Whether anything is known.
    pub fn is_finite(&self) -> bool {
        self.rest.is_finite() && self.c.iter().all(|c| c.is_finite())
    }

    /// Sum of the sizes of the coefficients that are kept.
    fn size(&self) -> f64 {
        self.c.iter().map(|c| c.abs()).sum()
    }
}

impl Neg for TaylorModel {
    type Output = Self;
    fn neg(self) -> Self {
        Self { c: self.c.map(|c| -c), ..self }
    }
}

impl Add for TaylorModel {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let mut c = self.c;
        c.iter_mut().zip(&o.c).for_each(|(c, x)| *c += x);
        let rest = (self.rest + o.rest + (self.size() + o.size()) * ROUNDING) * UP;
        Self { c, rest, degree: self.degree.max(o.degree) }
    }
}

impl Sub for TaylorModel {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for TaylorModel {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let mut c = [0.0; N];
        let mut left_out = 0.0;
        for (i, a) in self.c.iter().enumerate() {
            for (j, b) in o.c.iter().enumerate() {
                match c.get_mut(i + j) {
                    Some(c) => *c += a * b,
                    None => left_out += (a * b).abs(),
                }
            }
        }
        let (p, q) = (self.size(), o.size());
        let rest = (left_out + p * o.rest + q * self.rest + self.rest * o.rest + p * q * ROUNDING + TINY) * UP;
        Self { c, rest, degree: self.degree + o.degree }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(powers: &[f64], x: f64) -> f64 {
        powers.iter().rev().fold(0.0, |v, c| v * x + c)
    }

    fn bernstein(powers: &[f64]) -> Vec<Interval> {
        let powers: Vec<Interval> = powers.iter().map(|&c| Interval::point(c)).collect();
        crate::num::bernstein::from_powers(&powers, Interval::point(0.0), Interval::point(1.0))
    }

    #[test]
    fn values_and_derivatives_of_compositions_lie_within_the_bounds() {
        // p(q(x)) − p(r(x)), of degree 15 each, with q and r nearly the same.
        let (p, q) = ([3.0, -200.0, 40.0, 900.0, -300.0, 7.0], [0.1, 0.04, -0.005, 0.002]);
        let r = [0.1, 0.04 + 1e-7, -0.005, 0.002 - 1e-7];
        let p_intervals = p.map(Interval::point);
        let of = |q: &[f64]| {
            let x = TaylorModel::of_bernstein(&bernstein(q));
            TaylorModel::combination(&p_intervals, &x.powers(p.len() - 1))
        };
        let difference = of(&q) - of(&r);
        let (range, slope) = (difference.range(), difference.derivative().range());
        let exact = |x: f64| value(&p, value(&q, x)) - value(&p, value(&r, x));
        let (mut most, mut steepest) = (0.0f64, 0.0f64);
        for i in 0..=1000 {
            let x = f64::from(i) / 1000.0;
            assert!(range.widen(1e-12).contains(exact(x)), "{x}: {} {range:?}", exact(x));
            most = most.max(exact(x).abs());
            if i > 0 && i < 1000 {
                // By τ: half as steep as by x.
                let d = 0.5 * (exact(x + 1e-4) - exact(x - 1e-4)) / 2e-4;
                assert!(slope.widen(1e-9).contains(d), "{x}: {d} {slope:?}");
                steepest = steepest.max(d.abs());
            }
        }
        assert!(range.mag() < 1.5 * most && slope.mag() < 2.5 * steepest, "{range:?} {most} {slope:?} {steepest}");
        let ends = difference.ends();
        assert!(ends[0].widen(1e-12).contains(exact(0.0)) && ends[1].widen(1e-12).contains(exact(1.0)));
    }

    #[test]
    fn coefficients_that_are_not_kept_and_intervals_count() {
        // x^12 and a coefficient that is not known.
        let mut powers = vec![0.0; 13];
        powers[12] = 1.0;
        let high = TaylorModel::of_bernstein(&bernstein(&powers));
        let unknown = high.times(Interval::new(-2.0, 3.0));
        for i in 0..=100 {
            let x = f64::from(i) / 100.0;
            let v = x.powi(12);
            assert!(high.range().contains(v));
            assert!(unknown.range().contains(-2.0 * v) && unknown.range().contains(3.0 * v));
            assert!((high * high).range().contains(v * v));
            assert!((-high + high).range().contains(0.0));
            assert!(high.derivative().range().contains(6.0 * x.powi(11)));
        }
        assert!(!high.times(Interval::EVERYTHING).is_finite());
    }
}
