//! The exported ruled patch: its two boundary curves A (v = 0) and B (v = 1) as enclosed Bernstein polynomials.

use super::curve_model::{span_of, within, CurveModel};
use super::vector::{hull, V3};
use crate::num::bernstein::{powers_about_half, Scalar, SplinePiece};
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::num::taylor_model::TaylorModel;
use crate::spline::surface::Surface;
use std::ops::RangeInclusive;

/// A patch of degree 1 in v over `v ∈ [0, 1]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ruled<'a> {
    /// The patch.
    pub surface: &'a Surface,
    /// Whether any weight differs from 1.
    pub rational: bool,
    /// Whether the rails have the same weights, number for number.
    pub alike: bool,
}

impl<'a> Ruled<'a> {
    /// `None` when the patch is not of degree 1 in v with just two rows of control points over `[0, 1]`, or a
    /// weight is not positive.
    pub fn new(surface: &'a Surface) -> Option<Self> {
        let v = surface.knots_v.values();
        let form = surface.knots_v.degree() == 1
            && surface.row() == 2
            && v.iter().map(|x| x.to_bits()).eq([0.0f64, 0.0, 1.0, 1.0].map(f64::to_bits));
        let positive = surface.control.iter().all(|c| c[3] > 0.0);
        let rational = surface.control.iter().any(|c| c[3].total_cmp(&1.0).is_ne());
        let alike = surface.control.chunks_exact(2).all(|c| c[0][3].to_bits() == c[1][3].to_bits());
        (form && positive).then_some(Self { surface, rational, alike })
    }

    /// Knots in u, ends of the domain included.
    pub fn breaks(&self) -> Vec<f64> {
        self.surface.knots_u.breaks()
    }

    /// Homogeneous Bernstein coefficients (x, y, z, w) of A (`end` 0) or B (1) over `[a, b]` inside one span, with the
    /// origin moved to `origin`.
    pub fn end(&self, end: usize, a: f64, b: f64, origin: &[f64; 3]) -> [Vec<Interval>; 4] {
        let k = &self.surface.knots_u;
        let (p, v) = (k.degree(), k.values());
        let span = k.span(0.5 * (a + b));
        let piece = SplinePiece::new(p, &v[span + 1 - p..=span + p], a, b);
        [0, 1, 2, 3].map(|d: usize| {
            if d == 3 && !self.rational {
                return vec![Interval::ONE; p + 1];
            }
            let net: Vec<Interval> = (span - p..=span)
                .map(|i| {
                    let c = &self.surface.control[2 * i + end];
                    if d == 3 {
                        Interval::point(c[3])
                    } else if self.rational {
                        Interval::less_product(c[d], c[3], origin[d])
                    } else {
                        Interval::point(c[d]) - Interval::point(origin[d])
                    }
                })
                .collect();
            piece.coefficients(&net)
        })
    }

    /// Control points of both rails near the middle of the span holding `t`, in space: good origins for each.
    pub fn middles(&self, t: f64) -> [[f64; 3]; 2] {
        let i = self.surface.knots_u.span(t) - self.surface.knots_u.degree() / 2;
        [0, 1].map(|end: usize| {
            let c = &self.surface.control[2 * i + end];
            [0, 1, 2].map(|k: usize| c[k] / c[3])
        })
    }

    /// A point of the rail that is far shorter than the other one, as beside the tip of a cone, if there is one.
    pub fn tip(&self) -> Option<[f64; 3]> {
        let rail = |end: usize| -> Vec<[f64; 3]> {
            let own = self.surface.control.iter().skip(end).step_by(2);
            own.map(|c| [0, 1, 2].map(|k: usize| c[k] / c[3])).collect()
        };
        let rails = [rail(0), rail(1)];
        let [a, b] = [0, 1].map(|end: usize| -> f64 {
            let way = |w: &[[f64; 3]]| (0..3).map(|k| (w[1][k] - w[0][k]).powi(2)).sum::<f64>().sqrt();
            rails[end].windows(2).map(way).sum()
        });
        let of = |end: usize| rails[end][rails[end].len() / 2];
        if a < NARROW * b {
            Some(of(0))
        } else if b < NARROW * a {
            Some(of(1))
        } else {
            None
        }
    }

    /// A point near the middle of the span holding `t`, in space: a good origin. Where one rail is far shorter than the other, as
    /// beside the tip of a cone, it is on that, where coordinates would else be large against everything.
    pub fn middle(&self, t: f64) -> [f64; 3] {
        let [p, q] = self.middles(t);
        let breadth = |end: usize| {
            let i = self.surface.knots_u.span(t) - self.surface.knots_u.degree();
            let (c, d) = (&self.surface.control[2 * i + end], &self.surface.control[2 * (i + 1) + end]);
            (0..3).map(|k| (d[k] / d[3] - c[k] / c[3]).powi(2)).sum::<f64>().sqrt()
        };
        let (a, b) = (breadth(0), breadth(1));
        let share = if a < NARROW * b { 0.0 } else { 0.5 };
        let share = if b < NARROW * a { 1.0 } else { share };
        [0, 1, 2].map(|k: usize| p[k] * (1.0 - share) + q[k] * share)
    }
}

/// Length of a rail against that of the other below which origins lie on it.
const NARROW: f64 = 0.05;

/// The boundary curves in powers of `x = (t − a)/(b − a) − ½` on every span: quick values and derivatives over intervals.
pub(super) struct RuledJets {
    /// Positions are relative to it.
    pub origin: [f64; 3],
    breaks: Vec<f64>,
    spans: Vec<RuledSpan>,
}

struct RuledSpan {
    inverse: Interval,
    /// Homogeneous components of A and B.
    ends: [[Vec<Interval>; 4]; 2],
    rational: bool,
}

impl RuledJets {
    /// Prepares a patch, with positions relative to `origin`.
    pub fn new(patch: &Ruled, origin: &[f64; 3]) -> Self {
        let breaks = patch.breaks();
        let spans = breaks
            .windows(2)
            .map(|w| RuledSpan {
                inverse: Interval::ONE / (Interval::point(w[1]) - Interval::point(w[0])),
                ends: [0, 1].map(|end: usize| patch.end(end, w[0], w[1], origin).map(|b| powers_about_half(&b))),
                rational: patch.rational,
            })
            .collect();
        Self { origin: *origin, breaks, spans }
    }

    /// Parameter interval in t.
    pub fn domain(&self) -> (f64, f64) {
        (self.breaks[0], self.breaks[self.breaks.len() - 1])
    }

    /// The curve `R(t(s), r(s))` with derivatives, `t` inside the domain; and how [`rough`] it is.
    pub fn along_curve(&self, t: Jet, r: Jet) -> (V3<Jet>, f64) {
        let (first, last) = (self.span(t.v.lo), self.span(t.v.hi));
        let piece = |i: usize| {
            let t = Jet { v: self.clip(i, t.v), ..t };
            let span = &self.spans[i];
            let x = (t - Jet::from(self.breaks[i])) * Jet::constant(span.inverse) - Jet::from(0.5);
            span.point(r, |c| x.polynomial(c))
        };
        let hull = |p: V3<Jet>, i: usize| {
            let q = piece(i);
            [0, 1, 2].map(|d: usize| p[d].hull(q[d]))
        };
        ((first + 1..=last).fold(piece(first), hull), rough(&self.breaks, first..=last, t))
    }

    /// The curve `R(t(s), r(s))` of Bernstein coefficients of t and r: closer than [`RuledJets::along`], but only within one
    /// span.
    pub fn model(&self, theta: &[Vec<Interval>; 2]) -> Option<CurveModel> {
        let i = span_of(&theta[0], &self.breaks)?;
        let span = &self.spans[i];
        let powers = within(&theta[0], self.breaks[i], span.inverse).powers(span.ends[0][0].len() - 1);
        let r = TaylorModel::of_bernstein(&theta[1]);
        let component = |d: usize| {
            let [a, b] = [0, 1].map(|end: usize| TaylorModel::combination(&span.ends[end][d], &powers));
            a + r * (b - a)
        };
        CurveModel::new([0, 1, 2].map(component), span.rational.then(|| component(3)))
    }

    /// Knots in t.
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Points `R(t, r)`, `t` inside the domain: for narrow intervals.
    pub fn at(&self, t: Interval, r: Interval) -> V3<Interval> {
        let (first, last) = (self.span(t.lo), self.span(t.hi));
        let piece = |i: usize| {
            let x = (self.clip(i, t) - Interval::point(self.breaks[i])) * self.spans[i].inverse - Interval::point(0.5);
            let value = |c: &[Interval]| c.iter().copied().rev().reduce(|v, a| v * x + a).unwrap_or(Interval::ZERO);
            self.spans[i].point(r, value)
        };
        (first + 1..=last).fold(piece(first), |p, i| hull(&p, &piece(i)))
    }

    fn span(&self, t: f64) -> usize {
        self.breaks[1..self.breaks.len() - 1].partition_point(|&b| b <= t)
    }

    fn clip(&self, i: usize, t: Interval) -> Interval {
        let lo = t.lo.max(self.breaks[i]);
        Interval { lo, hi: t.hi.min(self.breaks[i + 1]).max(lo) }
    }
}

impl RuledSpan {
    /// The point at `r`, from values of polynomials in x.
    fn point<S: Scalar>(&self, r: S, value: impl Fn(&[Interval]) -> S) -> V3<S> {
        let comps = if self.rational { 4 } else { 3 };
        let mut h = [S::from(0.0); 4];
        for (d, h) in h.iter_mut().enumerate().take(comps) {
            let (a, b) = (value(&self.ends[0][d]), value(&self.ends[1][d]));
            // A convex combination, written so that r appears once.
            *h = a + r * (b - a);
        }
        if self.rational {
            [h[0].over(h[3]), h[1].over(h[3]), h[2].over(h[3])]
        } else {
            [h[0], h[1], h[2]]
        }
    }
}

/// What [`Jet::chord_deviation`] is to be told of a function of t over the spans `used` of these knots: twice the share
/// of the piece that lies outside the span which holds most of it. Ends of pieces are knots up to rounding.
pub(super) fn rough(breaks: &[f64], used: RangeInclusive<usize>, t: Jet) -> f64 {
    if used.start() == used.end() {
        return 0.0;
    }
    let overlap = |i: usize| t.v.hi.min(breaks[i + 1]) - t.v.lo.max(breaks[i]);
    let Some(most) = used.max_by(|&i, &j| overlap(i).total_cmp(&overlap(j))) else { return f64::INFINITY };
    let before = (Interval::point(breaks[most]) - Interval::point(t.v.lo)).hi.max(0.0);
    let after = (Interval::point(t.v.hi) - Interval::point(breaks[most + 1])).hi.max(0.0);
    // The least speed of t; without one, t may linger outside.
    let least = t.d.lo.max(-t.d.hi);
    if least > 0.0 {
        ((Interval::point(before) + Interval::point(after)).scale_exact(2.0) / Interval::point(least)).hi
    } else {
        f64::INFINITY
    }
}

/// All breaks of two lists within `[a, b]`, with `a` and `b`, increasing.
pub(super) fn common_breaks(x: &[f64], y: &[f64], a: f64, b: f64) -> Vec<f64> {
    let mut out: Vec<f64> = x.iter().chain(y).copied().filter(|&t| t > a && t < b).chain([a, b]).collect();
    out.sort_by(f64::total_cmp);
    out.dedup_by(|p, q| p.to_bits() == q.to_bits());
    out
}
