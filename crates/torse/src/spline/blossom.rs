//! Blossoms (polar forms) of polynomial pieces, in floating point or in intervals.
//!
//! *Method.* The de Boor scheme with a different argument at each step \[R89\]; the control points of a spline are its
//! blossom at consecutive knots, which is what refinement, splitting and conversion to Bézier form rest on.

use super::knots::Knots;
use crate::num::interval::Interval;
use std::ops::{Add, Div, Mul, Sub};

/// Numbers in which a blossom can be evaluated: f64, or [`Interval`] where a bound is wanted.
pub(crate) trait Scalar:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// `(1 − a) x + a y` for the share `a`.
    fn blend(x: Self, y: Self, a: Self) -> Self;
}

impl Scalar for f64 {
    #[inline]
    fn blend(x: f64, y: f64, a: f64) -> f64 {
        (1.0 - a) * x + a * y
    }
}

impl Scalar for Interval {
    /// A share that is exactly 0 or 1 gives an end exactly.
    #[inline]
    fn blend(x: Interval, y: Interval, a: Interval) -> Interval {
        if a == Interval::ZERO {
            x
        } else if a == Interval::ONE {
            y
        } else {
            (Interval::ONE - a) * x + a * y
        }
    }
}

/// Blossom at `args` (as many as the degree) of the polynomial piece on `span`, whose control points
/// `span − degree ..= span` are in `net`; `net` is used up. Symmetric and multi-affine in `args`.
pub(crate) fn of_piece<S: Scalar, const D: usize>(
    knots: &Knots,
    span: usize,
    net: &mut [[S; D]],
    args: &[S],
) -> [S; D] {
    let (p, v) = (knots.degree(), knots.values());
    for r in 1..=p {
        for j in (r..=p).rev() {
            let i = span - p + j;
            let left = S::from(v[i]);
            let share = share(args[r - 1], left, S::from(v[i + p + 1 - r]));
            let (before, here) = (net[j - 1], net[j]);
            for d in 0..D {
                net[j][d] = S::blend(before[d], here[d], share);
            }
        }
    }
    net[p]
}

/// `(t − left) / (right − left)`.
#[inline]
fn share<S: Scalar>(t: S, left: S, right: S) -> S {
    (t - left) / (right - left)
}

#[cfg(test)]
mod tests {
    use crate::spline::curve::Curve;
    use crate::spline::sample::any_curve;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn symmetric_affine_and_equal_to_the_curve_on_the_diagonal(
            curve in any_curve(), at in 0.0..1.0f64, x in -0.2..1.2f64, y in -0.2..1.2f64, share in -1.0..2.0f64,
        ) {
            let p = curve.knots.degree();
            let mut args: Vec<f64> = (0..p).map(|i| at + 0.1 * (i as f64 * 2.4).sin()).collect();
            args[0] = x;
            let one = curve.blossom(at, &args).expect("as many arguments as the degree");
            // Symmetric: any rotation of the arguments.
            let mut turned = args.clone();
            turned.rotate_left(p / 2);
            turned.reverse();
            let other = curve.blossom(at, &turned).expect("as many");
            // Affine in the first argument.
            args[0] = y;
            let two = curve.blossom(at, &args).expect("as many");
            args[0] = (1.0 - share) * x + share * y;
            let mixed = curve.blossom(at, &args).expect("as many");
            let diagonal = curve.blossom(at, &vec![at; p]).expect("as many");
            let point = curve.point(at);
            // Arguments away from a short span are extrapolated, and rounding grows with the values met.
            let size = one.iter().chain(&two).chain(&mixed).fold(10.0f64, |m, x| m.max(x.abs()));
            let shortest = curve.knots.breaks().windows(2).fold(1.0f64, |m, w| m.min(w[1] - w[0]));
            let slack = 1e-12 * size / shortest.powi(p as i32 - 1);
            for d in 0..3 {
                prop_assert!((one[d] - other[d]).abs() <= slack);
                prop_assert!(((1.0 - share) * one[d] + share * two[d] - mixed[d]).abs() <= 3.0 * slack);
                prop_assert!((diagonal[d] - point[d]).abs() <= 1e-11);
            }
        }
    }

    #[test]
    fn a_wrong_number_of_arguments_is_refused() {
        let c = Curve::<1>::new(2, vec![0., 0., 0., 1., 1., 1.], vec![[0.], [1.], [0.]]).expect("curve");
        assert!(c.blossom(0.5, &[0.5]).is_none());
        assert!((c.blossom(0.5, &[0.0, 1.0]).expect("two")[0] - 1.0).abs() < 1e-15);
    }
}
