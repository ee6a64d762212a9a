//! For which M* the first and the last ruling can be met by a polynomial net.
//!
//! *Method.* With `δ_i = (v × w)·(c_{i+1} − c_i)` the condition of \[FJ07\], (20)–(21), is a polynomial of degree `L − 1`
//! in M*,
//! `p = Σ δ_i Π_{j<i} g(u_j) Π_{j>i+n} g(u_j)`.
//! For M* outside the domain all factors are positive, so that in Bernstein form nothing cancels but the δ_i, and
//! there are at most as many regular solutions as the δ_i change sign, of the same parity \[FR88\].

use super::problem::{EndRulings, InterpolateError, Options, Problem};
use crate::num::bernstein::{derivative, value};
use crate::num::interval::Interval;
use crate::num::roots::{isolate, refine};
use crate::spline::curve::Curve;
use crate::torse::net::paper_knots;

/// Distance from a knot, as a share of the domain, within which a root counts as the knot's own: such roots close no
/// cell.
const ON_KNOT: f64 = 1e-9;
/// Undecided parts of [0, 1] narrower than this stand for a double root in their middle; wider ones say nothing of
/// its place.
const NARROW: f64 = 1e-3;
/// Share of the summed sizes of δ below which their sum is rounding: then m = 0, the cone, is a root.
const ROUNDING: f64 = 1e-14;
/// Roots, as numbers of (−1, 1), that are nearer to zero than this are then that root.
const AT_CONE: f64 = 1e-9;

/// Polynomial nets through a curve with two given lines, counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Solvability {
    /// `(v × w)·(c_{i+1} − c_i)`: on which side of the plane of the two directions each leg of the polygon runs.
    pub delta: Vec<f64>,
    /// Stable form `m = 1/(M* − u_m)` of the solutions whose regression curve stays off the curve, increasing; 0 for
    /// a cone.
    pub regular: Vec<f64>,
    /// Whether the number of regular solutions is proven.
    pub certain: bool,
    /// M* of further solutions, inside the domain, increasing: their regression curve meets the curve there.
    pub singular: Vec<f64>,
}

impl Solvability {
    /// How often the δ_i change sign: a bound of the number of regular solutions, of the same parity.
    pub fn sign_changes(&self) -> usize {
        let signs: Vec<bool> = self.delta.iter().filter(|d| **d != 0.0).map(|d| *d > 0.0).collect();
        signs.windows(2).filter(|w| w[0] != w[1]).count()
    }

    /// The signs of the δ_i, as `+`, `-` and `0`.
    pub fn pattern(&self) -> String {
        let sign = |d: &f64| {
            if *d > 0.0 {
                '+'
            } else if *d < 0.0 {
                '-'
            } else {
                '0'
            }
        };
        self.delta.iter().map(sign).collect()
    }
}

/// All polynomial nets through `curve` (weights all equal) with these end rulings, without building them.
///
/// *Guarantee*: the number of regular ones, where `certain`. Parallel end rulings give no condition: δ = 0.
///
/// # Errors
/// As [`super::interpolate`].
pub fn solvability(curve: &Curve<4>, rulings: &EndRulings) -> Result<Solvability, InterpolateError> {
    Ok(of(&Problem::new(curve, rulings, &Options::default())?, true))
}

/// [`solvability`]; the singular solutions only where `all` are wanted.
pub(super) fn of(problem: &Problem, all: bool) -> Solvability {
    let enclosed = problem.deltas();
    let delta: Vec<f64> = enclosed.iter().map(|d| d.mid()).collect();
    let mut out = Solvability { delta, regular: vec![], certain: true, singular: vec![] };
    if problem.parallel() {
        return out;
    }
    let (n, u) = (problem.curve.knots.degree(), paper_knots(&problem.curve.knots));
    let (a, b) = problem.curve.domain();
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    // 1. m = x/half with x in (−1, 1): g(u_j) = 1 − x s_j.
    let s = |j: usize| (Interval::point(u[j]) - Interval::point(middle)) / Interval::point(half);
    let regular = isolate(&polynomial(&enclosed, n, |j| (Interval::ONE + s(j), Interval::ONE - s(j))));
    out.certain = regular.is_certain();
    let span = |t: f64| (2.0 * t - 1.0) / half;
    for root in &regular.simple {
        let condition = |m: f64| condition(&out.delta, u, n, middle, m);
        out.regular.push(refine(condition, span(root.lo), span(root.hi), root.rising));
    }
    // Undecided parts: a double root touches zero without a sign change to hold on to; its place is all there is.
    for part in &regular.undecided {
        let inside = part.0 > 0.0 && part.1 < 1.0;
        if inside && part.1 - part.0 < NARROW {
            out.regular.push(span(0.5 * (part.0 + part.1)));
        }
    }
    out.regular.sort_by(f64::total_cmp);
    // A root at rounding's distance from the cone is the cone.
    let size = out.delta.iter().map(|d| d.abs()).sum::<f64>();
    if out.delta.iter().sum::<f64>().abs() <= ROUNDING * size {
        for m in out.regular.iter_mut().filter(|m| m.abs() * half < AT_CONE) {
            *m = 0.0;
        }
    }
    if !all {
        return out;
    }
    // 2. M* = a + t (b − a): the factors M* − u_j vanish at the knots.
    let at = |x: f64, j: usize| Interval::point(x) - Interval::point(u[j]);
    let inner = polynomial(&enclosed, n, |j| (at(a, j), at(b, j)));
    let numbers: Vec<f64> = inner.iter().map(|c| c.mid()).collect();
    let slope = derivative(&numbers);
    let roots = isolate(&inner);
    let simple = roots.simple.iter().map(|r| refine(|t| (value(&numbers, t), value(&slope, t)), r.lo, r.hi, r.rising));
    let inside = simple.chain(roots.undecided.iter().filter(|p| p.1 - p.0 < NARROW).map(|p| 0.5 * (p.0 + p.1)));
    out.singular =
        inside.map(|t| a + t * (b - a)).filter(|x| u.iter().all(|k| (x - k).abs() > ON_KNOT * (b - a))).collect();
    out.singular.sort_by(f64::total_cmp);
    out
}

/// Bernstein coefficients of `Σ δ_i Π_{j<i} l_j Π_{j>i+n} l_j` for linear factors `l_j` given by their end values.
fn polynomial(delta: &[Interval], n: usize, factor: impl Fn(usize) -> (Interval, Interval)) -> Vec<Interval> {
    let times = |b: &[Interval], (l, r): (Interval, Interval)| -> Vec<Interval> {
        let degree = b.len();
        let share = |k: usize| Interval::point(k as f64) / Interval::point(degree as f64);
        (0..=degree)
            .map(|i| {
                let left = if i < degree { share(degree - i) * l * b[i] } else { Interval::ZERO };
                let right = if i > 0 { share(i) * r * b[i - 1] } else { Interval::ZERO };
                left + right
            })
            .collect()
    };
    // q_k = q_{k−1} l_{k+n} + δ_k p_k with p_k = Π_{j<k} l_j: every term gets its later factors on the way.
    let mut q = vec![delta[0]];
    let mut p = vec![Interval::ONE];
    for k in 1..delta.len() {
        p = times(&p, factor(k - 1));
        q = times(&q, factor(k + n)).iter().zip(&p).map(|(&x, &y)| x + delta[k] * y).collect();
    }
    q
}

/// `N·T(m)` and its slope by the recursion: the polynomial divided by positive factors.
fn condition(delta: &[f64], u: &[f64], n: usize, middle: f64, m: f64) -> (f64, f64) {
    let (mut s, mut ds) = (0.0, 0.0);
    for (i, d) in delta.iter().enumerate() {
        let (above, below) = (1.0 - m * (u[i + n] - middle), 1.0 - m * (u[i] - middle));
        let numerator = above * s + d;
        let slope = above * ds - (u[i + n] - middle) * s;
        s = numerator / below;
        ds = (slope + s * (u[i] - middle)) / below;
    }
    (s, ds)
}
