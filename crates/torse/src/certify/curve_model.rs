//! Curves on panels over a piece of their parameter, as quotients of polynomials: what is large in two of them, that lie near
//! each other, cancels before their difference is enclosed.
//!
//! With `P = H/w` and `Q = G/v` the difference is `(H v − G w)/(w v)`. Numerator and denominator are Taylor models
//! (`num/taylor_model`), so the bound of a difference that is small everywhere is small after one look, where interval jets
//! of both curves need pieces whose own third derivatives are small.

use super::vector::{length_bound, V3};
use crate::num::bernstein;
use crate::num::interval::Interval;
use crate::num::taylor_model::TaylorModel;
use crate::spline::curve::Curve;

/// A curve in space over a piece: components of the numerator and the weight, if it has one.
#[derive(Clone, Copy)]
pub(super) struct CurveModel {
    h: V3<TaylorModel>,
    w: Option<TaylorModel>,
}

impl CurveModel {
    /// `None` where nothing is known, or the weight may vanish.
    pub fn new(h: V3<TaylorModel>, w: Option<TaylorModel>) -> Option<Self> {
        let finite = h.iter().chain(&w).all(TaylorModel::is_finite);
        (finite && w.is_none_or(|w| w.range().lo > 0.0)).then_some(Self { h, w })
    }

    /// A polynomial curve of these Bernstein coefficients.
    pub fn of_bernstein(b: &V3<Vec<Interval>>) -> Option<Self> {
        Self::new([0, 1, 2].map(|d: usize| TaylorModel::of_bernstein(&b[d])), None)
    }

    /// The curve moved.
    pub fn moved(&self, by: &V3<Interval>) -> Self {
        let whole = TaylorModel::constant(Interval::ONE);
        let h = [0, 1, 2].map(|d: usize| self.h[d] + self.w.unwrap_or(whole).times(by[d]));
        Self { h, w: self.w }
    }

    /// What this curve is beside another one.
    pub fn minus(&self, o: &Self) -> Self {
        let scaled = |h: TaylorModel, w: &Option<TaylorModel>| w.map_or(h, |w| h * w);
        let h = [0, 1, 2].map(|d: usize| scaled(self.h[d], &o.w) - scaled(o.h[d], &self.w));
        let w = match (self.w, o.w) {
            (Some(w), Some(v)) => Some(w * v),
            (w, v) => w.or(v),
        };
        Self { h, w }
    }

    /// First and last point.
    pub fn ends(&self) -> [V3<Interval>; 2] {
        let weights = self.w.map_or([Interval::ONE; 2], |w| w.ends());
        let h = self.h.map(|h| h.ends());
        [0, 1].map(|k: usize| h.map(|h| h[k] / weights[k]))
    }

    /// All points.
    pub fn range(&self) -> V3<Interval> {
        let h = self.h.map(|h| h.range());
        self.w.map_or(h, |w| h.map(|h| h / w.range()))
    }

    /// Derivatives by the share of the piece.
    pub fn velocity(&self) -> V3<Interval> {
        // The parameter of models runs over twice the share.
        let slope = |x: &TaylorModel| x.derivative().range().scale_exact(2.0);
        let dh = self.h.map(|h| slope(&h));
        let Some(w) = self.w else { return dh };
        let (points, dw, w) = (self.range(), slope(&w), w.range());
        [0, 1, 2].map(|d: usize| (dh[d] - points[d] * dw) / w)
    }

    /// Bounds of the distance from the origin, over all and at the ends.
    pub fn size(&self) -> (f64, f64) {
        let [a, b] = self.ends().map(|p| length_bound(&p));
        (length_bound(&self.range()), a.max(b))
    }
}

/// `(t − first)/length − ½` for Bernstein coefficients of t.
pub(super) fn within(t: &[Interval], first: f64, inverse: Interval) -> TaylorModel {
    let half = Interval::point(0.5);
    let x: Vec<Interval> = t.iter().map(|&t| (t - Interval::point(first)) * inverse - half).collect();
    TaylorModel::of_bernstein(&x)
}

/// The span of `breaks` that all of these Bernstein coefficients lie in.
pub(super) fn span_of(t: &[Interval], breaks: &[f64]) -> Option<usize> {
    let t = bernstein::hull(t);
    let i = breaks[1..breaks.len() - 1].partition_point(|&b| b <= t.mid());
    (t.lo >= breaks[i] && t.hi <= breaks[i + 1]).then_some(i)
}

/// Ways by which cuts stay away from a crossing, as a share of the piece of the curve.
const BESIDE: f64 = 1e-9;
/// Steps of bisection that find a crossing well within that.
const BISECTIONS: usize = 40;

/// Where a trimming curve is to be cut so that its pieces lie in one span each, but for tiny ones: its knots, and places on both
/// sides of where its first coordinate passes one of `breaks`, or reaches it.
pub(super) fn cuts(trim: &Curve<2>, breaks: &[f64]) -> Vec<f64> {
    let mut out = trim.knots.breaks();
    let hair = BESIDE * (breaks[breaks.len() - 1] - breaks[0]);
    let mut beside = Vec::new();
    for w in out.windows(2) {
        let t = [w[0], w[1]].map(|s| trim.point(s)[0]);
        let (lo, hi) = (t[0].min(t[1]) - hair, t[0].max(t[1]) + hair);
        for &knot in &breaks[breaks.partition_point(|&b| b < lo)..breaks.partition_point(|&b| b <= hi)] {
            let (mut a, mut b) = (w[0], w[1]);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (a + b);
                let before = (trim.point(middle)[0] < knot) == (t[0] < t[1]);
                (a, b) = if before { (middle, b) } else { (a, middle) };
            }
            let way = BESIDE * (w[1] - w[0]);
            beside.extend([a - way, b + way].into_iter().filter(|&s| w[0] < s && s < w[1]));
        }
    }
    out.extend(beside);
    out
}

#[cfg(test)]
mod tests {
    use super::super::boundary::trim_piece;
    use super::super::ruled::{Ruled, RuledJets};
    use super::super::specimens::dual_patch;
    use super::*;
    use crate::geom::Vec3;
    use crate::num::jet::Jet;

    /// A trimming curve across a patch, bent.
    fn trim(t: [f64; 2]) -> Curve<2> {
        let control = vec![[t[0], 0.2], [0.6 * t[0] + 0.4 * t[1], 0.9], [0.3 * t[0] + 0.7 * t[1], 0.1], [t[1], 0.7]];
        Curve { knots: crate::spline::knots::Knots::clamped(3, &[0.0, 1.0]).expect("knots"), control }
    }

    #[test]
    fn curves_on_rational_patches_lie_within_and_differences_that_are_small_are_seen_to_be() {
        let patch = dual_patch();
        let jets = RuledJets::new(&Ruled::new(&patch).expect("ruled"), &[1.0, 2.0, 3.0]);
        let ((t0, t1), _) = patch.domain();
        let curve = trim([t0, t1]);
        let mut near = curve.clone();
        near.control.iter_mut().for_each(|c| c[1] += 1e-7);
        let all = cuts(&curve, jets.breaks());
        let mut all: Vec<f64> = all.into_iter().filter(|s| (0.0..=1.0).contains(s)).collect();
        all.sort_by(f64::total_cmp);
        let (mut seen, mut length) = (0, 0.0);
        for w in all.windows(2) {
            let theta = trim_piece(&curve, w[0], w[1]);
            let Some(model) = jets.model(&theta) else { continue };
            (seen, length) = (seen + 1, length + w[1] - w[0]);
            let point = |s: f64| {
                let q = curve.point(s);
                patch.point(q[0], q[1]) - Vec3::new(1.0, 2.0, 3.0)
            };
            let (range, velocity) = (model.range(), model.velocity());
            let share = |x: f64| w[0] + (w[1] - w[0]) * x;
            for i in 1..20 {
                let x = f64::from(i) / 20.0;
                let p = point(share(x));
                let v = (point(share(x + 1e-4)) - point(share(x - 1e-4))) / 2e-4;
                for d in 0..3 {
                    assert!(range[d].widen(1e-11).contains(p[d]) && velocity[d].widen(1e-5).contains(v[d]), "{x} {d}");
                }
            }
            for (end, s) in model.ends().iter().zip(w) {
                assert!((0..3).all(|d| end[d].widen(1e-11).contains(point(*s)[d])), "{s}");
            }
            // Twice the same but for a hair: seen at once by models, while jets of both know no better than their widths.
            let other = trim_piece(&near, w[0], w[1]);
            let off = jets.model(&other).expect("a model").minus(&model);
            let ruling = patch.point(t0, 1.0) - patch.point(t0, 0.0);
            assert!(off.size().0 < 1e-6 * ruling.norm() && off.size().0 > 1e-9, "{:?}", off.size());
            let moved = model.moved(&[Interval::ONE; 3]).minus(&model).range();
            assert!(moved.iter().all(|m| m.contains(1.0) && m.width() < 1e-4), "{moved:?}");
            let [a, b] =
                [&theta, &other].map(|t| jets.along_curve(Jet::of_bernstein(&t[0]), Jet::of_bernstein(&t[1])).0);
            assert!((a[0] - b[0]).v.width() > 1e-3);
        }
        assert!(seen > 3 && length > 1.0 - 1e-6, "{seen} {length}");
    }

    #[test]
    fn weights_that_may_vanish_are_no_model() {
        let b = [0.0, 1.0, 2.0].map(Interval::point).to_vec();
        let h = [0, 1, 2].map(|_| TaylorModel::of_bernstein(&b));
        assert!(CurveModel::new(h, Some(h[0])).is_none());
        assert!(CurveModel::new(h, Some(h[0].times(Interval::EVERYTHING))).is_none());
        assert!(CurveModel::of_bernstein(&[b.clone(), b.clone(), b]).is_some());
    }
}
