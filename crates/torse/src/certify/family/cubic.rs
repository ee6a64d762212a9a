//! Cubic pieces of splines, enclosed, with their derivatives.

use crate::num::bernstein::{elevated, from_spline, Scalar};
use crate::num::interval::Interval;
use crate::spline::knots::Knots;

/// A cubic and its derivatives with respect to t, each in powers of x. The derivatives come from differences of control
/// points, which are exact numbers: that loses much less to rounding than differentiating the enclosed cubic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cubic<S> {
    pub(super) value: [S; 4],
    pub(super) first: [S; 3],
    pub(super) second: [S; 2],
}

impl<S: Scalar> Cubic<S> {
    /// Value and first two derivatives at `x`.
    #[inline]
    pub(super) fn at(&self, x: S) -> [S; 3] {
        let ([a, b, c, d], [e, f, g]) = (self.value, self.first);
        [a + x * (b + x * (c + x * d)), e + x * (f + x * g), self.bend(x)]
    }

    /// Second derivative at `x`.
    #[inline]
    pub(super) fn bend(&self, x: S) -> S {
        self.second[0] + x * self.second[1]
    }
}

impl Cubic<Interval> {
    pub(super) fn map<S>(&self, f: impl Fn(Interval) -> S + Copy) -> Cubic<S> {
        Cubic { value: self.value.map(f), first: self.first.map(f), second: self.second.map(f) }
    }
}

/// The cubic pieces of each component on the span `[a, b]`.
pub(super) fn pieces<const D: usize>(knots: &Knots, control: &[[Interval; D]], a: f64, b: f64) -> [Cubic<Interval>; D] {
    let (p, v) = (knots.degree(), knots.values());
    let span = knots.span(0.5 * (a + b));
    std::array::from_fn(|d| {
        let mut net: Vec<Interval> = control[span - p..=span].iter().map(|c| c[d]).collect();
        let mut local = &v[span + 1 - p..=span + p];
        let mut powers = Vec::with_capacity(3);
        for order in 0..3 {
            powers.push(powers_about_half(&net, local, 3 - order));
            // Control points of the derivative: p (d_{i+1} − d_i)/(T_{i+p} − T_i) over the inner knots.
            let p = net.len() - 1;
            net = if p == 0 {
                vec![Interval::ZERO]
            } else {
                let width = |i: usize| Interval::point(local[i + p]) - Interval::point(local[i]);
                (0..p).map(|i| (net[i + 1] - net[i]) * p as f64 / width(i)).collect()
            };
            if p > 0 {
                local = &local[1..local.len() - 1];
            }
        }
        Cubic {
            value: [0, 1, 2, 3].map(|k: usize| powers[0][k]),
            first: [0, 1, 2].map(|k: usize| powers[1][k]),
            second: [0, 1].map(|k: usize| powers[2][k]),
        }
    })
}

/// Powers of `x` of a spline piece, as a polynomial of the given degree.
fn powers_about_half(net: &[Interval], knots: &[f64], degree: usize) -> Vec<Interval> {
    let mut bez = from_spline(net, knots);
    while bez.len() <= degree {
        bez = elevated(&bez);
    }
    crate::num::bernstein::powers_about_half(&bez)
}
