//! Intervals with outward rounding: the scalar in which bounds are proven.
//!
//! Every operation returns an interval that contains the exact result for all members of its operands.
//! Round-to-nearest is assumed; each inexact end point is moved outward by at least one unit in the last place.
//! This module knows no geometry.
//!
//! The step outward is `|x| 2⁻⁵² + 2⁻¹⁰²²`: no less than the distance to the neighbouring number (so the exact result,
//! which round-to-nearest leaves within half of that, stays inside), and twice as fast as stepping through bit
//! patterns.
//!
//! No end of a result is NaN: where an end is not known, because an operand was NaN or a number overflowed, it is
//! infinite. So comparisons, hulls and largest values never lose an unknown.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// The next number below, or one a little further down; −∞ for NaN and for what overflowed.
#[inline]
fn down(x: f64) -> f64 {
    let y = x - (x.abs() * f64::EPSILON + f64::MIN_POSITIVE);
    // Written so that it is one instruction, and false for NaN.
    if y > f64::NEG_INFINITY {
        y
    } else {
        f64::NEG_INFINITY
    }
}

/// The next number above, or one a little further up; +∞ for NaN and for what overflowed.
#[inline]
fn up(x: f64) -> f64 {
    let y = x + (x.abs() * f64::EPSILON + f64::MIN_POSITIVE);
    if y < f64::INFINITY {
        y
    } else {
        f64::INFINITY
    }
}

/// The smaller number; one of both, or NaN, where one is NaN. One instruction, other than `f64::min`.
#[inline]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b {
        a
    } else {
        b
    }
}

/// The larger number; one of both, or NaN, where one is NaN.
#[inline]
fn greater(a: f64, b: f64) -> f64 {
    if a > b {
        a
    } else {
        b
    }
}

/// A closed interval `[lo, hi]` of real numbers with f64 end points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Interval {
    /// Zero, exactly.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };
    /// One, exactly.
    pub const ONE: Self = Self { lo: 1.0, hi: 1.0 };
    /// The whole line: "nothing is known".
    pub const EVERYTHING: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// The interval holding exactly the number `x`; everything for NaN.
    #[inline]
    pub const fn point(x: f64) -> Self {
        if x.is_nan() {
            return Self::EVERYTHING;
        }
        Self { lo: x, hi: x }
    }

    /// The interval between two end points given in either order; everything if one is NaN.
    #[inline]
    pub fn new(a: f64, b: f64) -> Self {
        if a.is_nan() || b.is_nan() {
            return Self::EVERYTHING;
        }
        Self { lo: a.min(b), hi: a.max(b) }
    }

    /// `[-r, r]` for `r >= 0`; everything for anything else.
    #[inline]
    pub fn symmetric(r: f64) -> Self {
        if r >= 0.0 {
            Self { lo: -r, hi: r }
        } else {
            Self::EVERYTHING
        }
    }

    /// Some number near the middle (not rounded in any direction).
    #[inline]
    pub fn mid(self) -> f64 {
        0.5 * (self.lo + self.hi)
    }

    /// An upper bound of half the width, valid around [`Interval::mid`].
    #[inline]
    pub fn rad(self) -> f64 {
        let m = self.mid();
        up((m - self.lo).max(self.hi - m))
    }

    /// Largest absolute value.
    #[inline]
    pub fn mag(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Smallest absolute value.
    #[inline]
    pub fn mig(self) -> f64 {
        if self.lo > 0.0 {
            self.lo
        } else if self.hi < 0.0 {
            -self.hi
        } else {
            0.0
        }
    }

    /// Smallest interval containing both.
    #[inline]
    pub fn hull(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Common part, if any.
    #[inline]
    pub fn intersect(self, o: Self) -> Option<Self> {
        let (lo, hi) = (self.lo.max(o.lo), self.hi.min(o.hi));
        (lo <= hi).then_some(Self { lo, hi })
    }

    /// Whether `x` lies inside.
    #[inline]
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Whether `o` lies inside.
    #[inline]
    pub fn encloses(self, o: Self) -> bool {
        self.lo <= o.lo && o.hi <= self.hi
    }

    /// +1 or −1 when every member has that strict sign, 0 otherwise.
    #[inline]
    pub fn sign(self) -> i32 {
        if self.lo > 0.0 {
            1
        } else if self.hi < 0.0 {
            -1
        } else {
            0
        }
    }

    /// Whether both ends are finite numbers.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// Square, tighter than `x * x`.
    #[inline]
    pub fn sqr(self) -> Self {
        let (a, b) = (self.mig(), self.mag());
        Self { lo: down(a * a).max(0.0), hi: up(b * b) }
    }

    /// Square root of the non-negative part.
    #[inline]
    pub fn sqrt(self) -> Self {
        Self { lo: down(self.lo.max(0.0).sqrt()).max(0.0), hi: up(self.hi.max(0.0).sqrt()) }
    }

    /// Absolute values.
    #[inline]
    pub fn abs(self) -> Self {
        Self { lo: self.mig(), hi: self.mag() }
    }

    /// `1/x`; [`Interval::EVERYTHING`] when zero is a member.
    #[inline]
    pub fn recip(self) -> Self {
        if self.sign() == 0 {
            return Self::EVERYTHING;
        }
        Self { lo: down(1.0 / self.hi), hi: up(1.0 / self.lo) }
    }

    /// A lower bound of `|x|/|y|` for all members x and all members y of `o`: 0 where nothing is known, and infinite
    /// only where y can be nothing but 0.
    #[inline]
    pub fn least_ratio(self, o: Self) -> f64 {
        let (least, most) = (self.mig(), o.mag());
        if least > 0.0 && most <= 0.0 {
            return f64::INFINITY;
        }
        let q = least / most;
        if q > 0.0 {
            down(q.min(f64::MAX)).max(0.0)
        } else {
            0.0
        }
    }

    /// `x` widened by `r >= 0` on both sides.
    #[inline]
    pub fn widen(self, r: f64) -> Self {
        Self { lo: down(self.lo - r), hi: up(self.hi + r) }
    }

    /// An upper bound of the width.
    #[inline]
    pub fn width(self) -> f64 {
        up(self.hi - self.lo)
    }

    /// `x − w o` of three numbers, to an error that is relative to the result: where `x` and `w o` are large and nearly equal,
    /// a product that was rounded before would leave nothing of it.
    ///
    /// *Method*: the product as an exact sum of two numbers (Dekker), barring overflow and underflow.
    pub fn less_product(x: f64, w: f64, o: f64) -> Self {
        /// `2²⁷ + 1`: parts a number into halves of its digits.
        const PARTS: f64 = 134_217_729.0;
        /// Sizes of factors and products between which no step leaves the range of numbers.
        const SAFE: (f64, f64) = (1e-200, 1e200);
        let halves = |y: f64| {
            let z = PARTS * y;
            let high = z - (z - y);
            (high, y - high)
        };
        let whole = w * o;
        let safe = |y: f64| y.abs() > SAFE.0 && y.abs() < SAFE.1;
        if !(safe(w) && safe(o) && safe(whole)) {
            return Self::point(x) - Self::point(w) * Self::point(o);
        }
        let ((a, b), (c, d)) = (halves(w), halves(o));
        let rest = ((a * c - whole) + a * d + b * c) + b * d;
        (Self::point(x) - Self::point(whole)) - Self::point(rest)
    }

    /// Product with a power of two, exact barring underflow.
    #[inline]
    pub fn scale_exact(self, power_of_two: f64) -> Self {
        Self::new(self.lo * power_of_two, self.hi * power_of_two)
    }
}

impl From<f64> for Interval {
    fn from(x: f64) -> Self {
        Self::point(x)
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { lo: down(self.lo + o.lo), hi: up(self.hi + o.hi) }
    }
}

impl AddAssign for Interval {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self { lo: down(self.lo - o.hi), hi: up(self.hi - o.lo) }
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        // NaN comes from 0 · ∞ only, and the other products cover what it stands for.
        let (a, b, c, d) = (self.lo * o.lo, self.lo * o.hi, self.hi * o.lo, self.hi * o.hi);
        Self { lo: down(lesser(lesser(a, b), lesser(c, d))), hi: up(greater(greater(a, b), greater(c, d))) }
    }
}

impl Mul<f64> for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, k: f64) -> Self {
        let (a, b) = (self.lo * k, self.hi * k);
        if k.is_nan() {
            return Self::EVERYTHING;
        }
        Self { lo: down(lesser(a, b)), hi: up(greater(a, b)) }
    }
}

impl Div for Interval {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        if o.sign() == 0 {
            return Self::EVERYTHING;
        }
        // NaN comes from ∞/∞ only.
        let (a, b, c, d) = (self.lo / o.lo, self.lo / o.hi, self.hi / o.lo, self.hi / o.hi);
        Self { lo: down(lesser(lesser(a, b), lesser(c, d))), hi: up(greater(greater(a, b), greater(c, d))) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contains_the_exact_result() {
        let third = Interval::ONE / Interval::point(3.0);
        let one = third + third + third;
        assert!(one.contains(1.0) && one.rad() < 1e-15);
        assert!(Interval::new(-1.0, 2.0).sqr().encloses(Interval::new(0.0, 4.0)));
        assert_eq!(Interval::new(-1.0, 2.0).recip(), Interval::EVERYTHING);
    }

    #[test]
    fn a_product_that_cancels_keeps_its_digits() {
        // (1 + 2⁻³⁰)(1 + 2⁻²⁹) = 1 + 3 · 2⁻³⁰ + 2⁻⁵⁹, of which the last term is rounded away.
        let tiny = 0.5_f64.powi(30);
        let (w, o) = (1.0 + tiny, 1.0 + 2.0 * tiny);
        let found = Interval::less_product(1.0 + 3.0 * tiny, w, o);
        let exact = -2.0 * tiny * tiny;
        assert!(found.contains(exact) && found.width() < 1e-14 * tiny * tiny, "{found:?}");
        let plain = Interval::point(1.0 + 3.0 * tiny) - Interval::point(w) * Interval::point(o);
        assert!(plain.encloses(found) && plain.width() > 1e-16);
        for (x, w, o) in
            [(3.0, 0.0, 1e300), (1.0, f64::NAN, 1.0), (1.0, 1e300, 1e300), (2.0, 1.0, 2.0), (0.0, 1e-300, 1e-20)]
        {
            let plain = Interval::point(x) - Interval::point(w) * Interval::point(o);
            assert!(plain.encloses(Interval::less_product(x, w, o)), "{x} {w} {o}");
        }
    }

    #[test]
    fn an_unknown_is_never_lost() {
        let (nan, inf) = (Interval::point(f64::NAN), f64::INFINITY);
        let two = Interval::new(2.0, 3.0);
        let huge = Interval::point(1e300) * Interval::point(1e300);
        for x in [nan, Interval::new(f64::NAN, 1.0), Interval::symmetric(f64::NAN), Interval::symmetric(-1.0)] {
            assert_eq!(x, Interval::EVERYTHING);
            for y in [x + two, x - two, x * two, two / x, x / two, x.hull(two), x.widen(1.0), two.widen(f64::NAN)] {
                assert_eq!(y, Interval::EVERYTHING);
            }
            assert!(x.mag() == inf && x.mig() == 0.0 && x.sign() == 0 && x.least_ratio(two) == 0.0);
        }
        assert!(huge.hi == inf && !huge.lo.is_nan() && (huge - huge) == Interval::EVERYTHING);
        assert_eq!(Interval::ZERO * Interval::EVERYTHING, Interval::EVERYTHING);
    }

    #[test]
    fn least_ratios_are_infinite_only_above_nothing_but_zero() {
        let one = Interval::ONE;
        assert_eq!(one.least_ratio(Interval::ZERO), f64::INFINITY);
        assert_eq!(Interval::ZERO.least_ratio(Interval::ZERO), 0.0);
        let half = one.least_ratio(Interval::new(-1.0, 2.0));
        assert!(half <= 0.5 && half > 0.4999);
        assert_eq!(one.least_ratio(Interval::EVERYTHING), 0.0);
        assert_eq!(Interval::new(-1.0, 1.0).least_ratio(one), 0.0);
        assert!(one.least_ratio(Interval::symmetric(1e-320)).is_finite());
    }

    #[test]
    fn steps_outward_pass_the_neighbouring_numbers() {
        for x in [1.0, 1.0 + f64::EPSILON, 2.0 - f64::EPSILON, 1e-300, -3.7, 0.0, f64::MIN_POSITIVE, 5e-324, -1e308] {
            assert!(down(x) <= x.next_down() && up(x) >= x.next_up());
        }
    }
}
