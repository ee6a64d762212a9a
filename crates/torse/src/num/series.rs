//! Taylor coefficients enclosed by intervals: automatic differentiation to any order for functions of one variable.
//!
//! Rules of Taylor series (Moore, Kearfott and Cloud, *Introduction to Interval Analysis*, ch. 9). Over an interval of
//! the variable coefficient k encloses the k-th derivative divided by k! everywhere in it.

use super::bernstein::Scalar;
use super::interval::Interval;
use std::ops::{Add, Mul, Neg, Sub};

/// Enclosures of the first N Taylor coefficients of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series<const N: usize>(pub [Interval; N]);

impl<const N: usize> Series<N> {
    /// A constant known to lie in an interval.
    #[inline]
    pub fn constant(v: Interval) -> Self {
        Self(std::array::from_fn(|k| if k == 0 { v } else { Interval::ZERO }))
    }

    /// Product with a number.
    #[inline]
    pub fn times(self, k: f64) -> Self {
        Self(self.0.map(|c| c * k))
    }

    /// Sum with a number.
    #[inline]
    pub fn plus(mut self, k: f64) -> Self {
        self.0[0] += Interval::point(k);
        self
    }

    /// Square root of a function that is positive; coefficients are everything where it may not be.
    #[inline]
    pub fn sqrt(self) -> Self {
        let mut r = [Interval::ZERO; N];
        r[0] = self.0[0].sqrt();
        let twice = r[0].scale_exact(2.0);
        for k in 1..N {
            let mut rest = self.0[k];
            for i in 1..k {
                rest = rest - r[i] * r[k - i];
            }
            r[k] = rest / twice;
        }
        Self(r)
    }
}

/// Enclosure over [0, 1] of a function with four derivatives, and a lower bound of its largest absolute value.
///
/// *Method*: the cubic through values and first derivatives at both ends (`first`, `last`) is evaluated at nine places,
/// between which it deviates from its chords by its second derivative; the function deviates from the cubic by 1/384
/// of its fourth derivative at most (`all`). *Guarantee*: both bounds.
pub(crate) fn hermite_range(first: &Series<2>, last: &Series<2>, all: &Series<5>) -> (Interval, f64) {
    const PARTS: usize = 8;
    // c₄ = f''''/24.
    let off = all.0[4].mag() / 16.0;
    if !off.is_finite() {
        return (all.0[0], 0.0);
    }
    let third = Interval::ONE / Interval::point(3.0);
    let [f, df] = first.0;
    let [g, dg] = last.0;
    let b = [f, f + df * third, g - dg * third, g];
    // Second derivative of a cubic: linear.
    let bend = |k: usize| ((b[k] - b[k + 1].scale_exact(2.0) + b[k + 2]) * 6.0).mag();
    let mut range = f.hull(g);
    let mut least = f.mig().max(g.mig());
    for i in 1..PARTS {
        // Powers of two: exact.
        let x = i as f64 / PARTS as f64;
        let y = 1.0 - x;
        let value = b[0] * (y * y * y) + b[1] * (3.0 * x * y * y) + b[2] * (3.0 * x * x * y) + b[3] * (x * x * x);
        range = range.hull(value);
        least = least.max(Interval::point(value.mig()).widen(off).lo);
    }
    let chords = bend(0).max(bend(1)) / (8 * PARTS * PARTS) as f64;
    let range = range.widen(chords).widen(off);
    (range.intersect(all.0[0]).unwrap_or(range), least.max(0.0))
}

impl<const N: usize> From<f64> for Series<N> {
    fn from(x: f64) -> Self {
        Self::constant(Interval::point(x))
    }
}

impl<const N: usize> Neg for Series<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl<const N: usize> Add for Series<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + o.0[k]))
    }
}

impl<const N: usize> Sub for Series<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - o.0[k]))
    }
}

impl<const N: usize> Mul for Series<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self(std::array::from_fn(|k| {
            let mut sum = self.0[0] * o.0[k];
            for i in 1..=k {
                sum += self.0[i] * o.0[k - i];
            }
            sum
        }))
    }
}

impl<const N: usize> Scalar for Series<N> {
    fn ratio(a: f64, b: f64) -> Self {
        Self::constant(<Interval as Scalar>::ratio(a, b))
    }
    fn sum(a: f64, b: f64) -> Self {
        Self::constant(<Interval as Scalar>::sum(a, b))
    }
    #[inline]
    fn over(self, o: Self) -> Self {
        let mut q = [Interval::ZERO; N];
        for k in 0..N {
            let mut rest = self.0[k];
            for i in 1..=k {
                rest = rest - o.0[i] * q[k - i];
            }
            q[k] = rest / o.0[0];
        }
        Self(q)
    }
    fn square_root(self) -> Self {
        self.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variable<const N: usize>(x: Interval, step: f64) -> Series<N> {
        let mut s = Series::constant(x);
        s.0[1] = Interval::point(step);
        s
    }

    /// √(1 + x²)/(2 + x), whose derivatives are known from its own series at points.
    fn f<const N: usize>(x: Series<N>) -> Series<N> {
        (x * x).plus(1.0).sqrt().over(x.plus(2.0))
    }

    #[test]
    fn coefficients_over_an_interval_contain_those_at_its_points() {
        let all = f::<5>(variable(Interval::new(0.2, 0.3), 1.0));
        for i in 0..=10 {
            let here = f::<5>(variable(Interval::point(0.2 + 0.01 * f64::from(i)), 1.0));
            for k in 0..5 {
                assert!(all.0[k].widen(1e-14).encloses(here.0[k]), "{k}");
            }
        }
    }

    #[test]
    fn series_sum_up_to_the_function() {
        let here = f::<5>(variable(Interval::point(0.2), 1.0));
        let h = 0.01;
        let sum: f64 = here.0.iter().rev().fold(0.0, |s, c| s * h + c.mid());
        let x: f64 = 0.2 + h;
        assert!((sum - (1.0 + x * x).sqrt() / (2.0 + x)).abs() < 1e-11);
    }

    #[test]
    fn ranges_contain_the_function_closely() {
        for (a, b) in [(-0.4, 0.3), (0.1, 0.2), (-1.5, 1.0)] {
            let x = Interval::new(a, b);
            let at = |u: f64| f::<2>(variable(Interval::point(u), b - a)).plus(-0.5);
            let (range, least) = hermite_range(&at(a), &at(b), &f::<5>(variable(x, b - a)).plus(-0.5));
            let values: Vec<f64> = (0..=1000)
                .map(|i| a + (b - a) * f64::from(i) / 1000.0)
                .map(|x: f64| (1.0 + x * x).sqrt() / (2.0 + x) - 0.5)
                .collect();
            let (lo, hi) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
            assert!(range.lo <= lo && range.hi >= hi, "{range:?}");
            let most = lo.abs().max(hi.abs());
            assert!(least <= most);
            if b - a < 0.2 {
                assert!(range.width() < 1.05 * (hi - lo) && least > 0.99 * most, "{range:?} {lo} {hi} {least}");
            }
        }
    }
}
