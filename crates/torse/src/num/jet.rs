//! Values with first and second derivatives, enclosed by intervals: automatic differentiation for functions of one
//! variable over an interval.
//!
//! Rules of product and quotient of Taylor series (Moore, Kearfott and Cloud, *Introduction to Interval Analysis*, ch.
//! 9).

use super::bernstein::{derivative, hull, Scalar};
use super::interval::Interval;
use std::ops::{Add, Mul, Neg, Sub};

/// Enclosures of a function and its first two derivatives over an interval of its variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Jet {
    /// Values.
    pub v: Interval,
    /// First derivatives.
    pub d: Interval,
    /// Second derivatives.
    pub dd: Interval,
}

impl Jet {
    /// A constant known to lie in an interval.
    #[inline]
    pub const fn constant(v: Interval) -> Self {
        Self { v, d: Interval::ZERO, dd: Interval::ZERO }
    }

    /// Over [0, 1], the polynomial with the given Bernstein coefficients.
    pub fn of_bernstein(b: &[Interval]) -> Self {
        let d = derivative(b);
        Self { v: hull(b), d: hull(&d), dd: hull(&derivative(&d)) }
    }

    /// Component-wise hull: encloses functions that agree with one or the other in turn.
    #[inline]
    pub fn hull(self, o: Self) -> Self {
        Self { v: self.v.hull(o.v), d: self.d.hull(o.d), dd: self.dd.hull(o.dd) }
    }

    /// The largest deviation on [0, 1] from the chord of a function with these derivatives: a quarter of the width w of
    /// the first derivative, or an eighth of the second where there is one. Where there is none at the very ends, on
    /// shares a and b, the function is within w·max(a, b) of one that goes on straight there, and so are their chords:
    /// `rough ≥ 2 (a + b)` pays for both.
    #[inline]
    pub fn chord_deviation(self, rough: f64) -> f64 {
        let width = self.d.width();
        // Not larger than the exact products, since the factors are powers of two.
        let (first, second) = (0.25 * width, 0.125 * self.dd.mag());
        if rough > 0.0 {
            first.min((Interval::point(second) + Interval::point(rough) * Interval::point(width)).hi)
        } else {
            first.min(second)
        }
    }
}

impl Jet {
    /// A polynomial of a function: coefficients of the powers, from the constant up.
    #[inline]
    pub fn polynomial(self, powers: &[Interval]) -> Self {
        // Value, first and half the second derivative by Horner's scheme repeated, then the chain rule. What is still zero is
        // not multiplied: of a cubic that is half of all.
        let mut downwards = powers.iter().rev();
        let mut v = downwards.next().copied().unwrap_or(Interval::ZERO);
        let (mut d, mut half) = (Interval::ZERO, Interval::ZERO);
        for (k, &c) in downwards.enumerate() {
            half = match k {
                0 => half,
                1 => d,
                _ => half * self.v + d,
            };
            d = if k == 0 { v } else { d * self.v + v };
            v = v * self.v + c;
        }
        let dd = half.scale_exact(2.0) * self.d.sqr() + d * self.dd;
        Self { v, d: d * self.d, dd }
    }

    /// Square root of a function that is positive; derivatives are everything where it may not be.
    #[inline]
    pub fn sqrt(self) -> Self {
        let v = self.v.sqrt();
        let twice = v.scale_exact(2.0);
        let d = self.d / twice;
        Self { v, d, dd: (self.dd - d.sqr().scale_exact(2.0)) / twice }
    }
}

impl From<f64> for Jet {
    fn from(x: f64) -> Self {
        Self::constant(Interval::point(x))
    }
}

impl Neg for Jet {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { v: -self.v, d: -self.d, dd: -self.dd }
    }
}

impl Add for Jet {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { v: self.v + o.v, d: self.d + o.d, dd: self.dd + o.dd }
    }
}

impl Sub for Jet {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self { v: self.v - o.v, d: self.d - o.d, dd: self.dd - o.dd }
    }
}

impl Mul for Jet {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self {
            v: self.v * o.v,
            d: self.d * o.v + self.v * o.d,
            dd: self.dd * o.v + (self.d * o.d).scale_exact(2.0) + self.v * o.dd,
        }
    }
}

impl Scalar for Jet {
    fn ratio(a: f64, b: f64) -> Self {
        Self::constant(<Interval as Scalar>::ratio(a, b))
    }
    fn sum(a: f64, b: f64) -> Self {
        Self::constant(<Interval as Scalar>::sum(a, b))
    }
    #[inline]
    fn over(self, o: Self) -> Self {
        let v = self.v / o.v;
        let d = (self.d - v * o.d) / o.v;
        Self { v, d, dd: (self.dd - (d * o.d).scale_exact(2.0) - v * o.dd) / o.v }
    }
    fn square_root(self) -> Self {
        self.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_rational_function_are_enclosed() {
        // f(x) = (x³ − 2x + 1)/(x² + 1) on [.2, .4]: against differences.
        let f = |x: f64| (x * x * x - 2.0 * x + 1.0) / (x * x + 1.0);
        let x = Jet { v: Interval::new(0.2, 0.4), d: Interval::ONE, dd: Interval::ZERO };
        let one = Jet::from(1.0);
        let y = (x * x * x - Jet::from(2.0) * x + one).over(x * x + one);
        let h = 1e-5;
        for i in 0..=10 {
            let x = 0.2 + 0.02 * i as f64;
            assert!(y.v.contains(f(x)));
            assert!(y.d.contains((f(x + h) - f(x - h)) / (2.0 * h)));
            assert!(y.dd.contains((f(x + h) - 2.0 * f(x) + f(x - h)) / (h * h)));
        }
        assert!(y.d.width() < 1.5 && y.dd.width() < 6.0, "{y:?}");
    }

    #[test]
    fn polynomials_of_any_degree_are_enclosed() {
        let powers = [0.7, -1.3, 0.4, 2.0, -0.6];
        for n in 0..=powers.len() {
            let p = &powers[..n];
            let of = |x: f64| p.iter().rev().fold([0.0; 3], |[v, d, h], c| [v * x + c, d * x + v, h * x + d]);
            // The variable is 0.1 + 3 s for s about 0.1.
            let x = Jet { v: Interval::new(0.4, 0.401), d: Interval::point(3.0), dd: Interval::ZERO };
            let y = x.polynomial(&p.iter().map(|c| Interval::point(*c)).collect::<Vec<_>>());
            let [v, d, h] = of(0.4005);
            assert!(y.v.contains(v) && y.d.contains(3.0 * d) && y.dd.contains(18.0 * h), "{n}: {y:?}");
            assert!(y.v.width() < 0.01 && y.d.width() < 0.1 && y.dd.width() < 0.2, "{n}: {y:?}");
        }
    }

    #[test]
    fn derivatives_of_a_root_are_enclosed() {
        let x = Jet { v: Interval::new(0.5, 0.6), d: Interval::ONE, dd: Interval::ZERO };
        let y = (x * x + Jet::from(1.0)).sqrt();
        for t in [0.5f64, 0.55, 0.6] {
            let r = (t * t + 1.0).sqrt();
            assert!(y.v.contains(r) && y.d.contains(t / r) && y.dd.contains(1.0 / (r * r * r)));
        }
        assert!(y.dd.width() < 0.5);
    }

    #[test]
    fn chords_and_bernstein_form() {
        let b = [0.0, 1.0, -1.0, 2.0].map(Interval::point);
        let j = Jet::of_bernstein(&b);
        let value = |x: f64| crate::num::bernstein::value(&[0.0, 1.0, -1.0, 2.0], x);
        for i in 0..=100 {
            let x = i as f64 / 100.0;
            let off = (value(x) - 2.0 * x).abs();
            assert!(off <= j.chord_deviation(0.0) && off <= j.chord_deviation(1.0));
        }
    }
}
