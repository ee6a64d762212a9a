//! Gaps between neighbouring panels: the distance of the two trimmed edges at equal places of the seam.
//!
//! `gap(s) = |R_i(θ_i(s)) − R_j(θ_j(1 − s))|` \[certificate, 5\]: chord between enclosed end values plus the deviation
//! that the enclosed derivatives allow, component by component, on pieces between the knots of both curves. Only
//! pieces that may hold the greatest gap are halved. Where both curves are polynomials over a piece their difference is one,
//! and what is large in both cancels before it is enclosed.

use super::boundary::trim_piece;
use super::curve_model::{cuts, CurveModel};
use super::ruled::RuledJets;
use super::vector::{add, dot, exact, length, length_bound, mid, sub, V3};
use crate::geom::Vec3;
use crate::num::greatest::greatest;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::spline::curve::Curve;

/// Pieces are halved until their enclosures exceed the greatest gap seen by less than this share of the tolerance.
const EXCESS: f64 = 1e-3;

/// One side of a seam.
#[derive(Clone, Copy)]
pub(super) struct SeamSide<'a> {
    pub jets: &'a RuledJets,
    pub trim: &'a Curve<2>,
}

/// Bound (mm) of the gap along a seam, whose sides run against each other if `turned`. `None` if a curve leaves its patch.
pub(super) fn gap_bound([a, b]: [SeamSide; 2], turned: bool, tolerance: f64) -> Option<f64> {
    let shift = sub(&exact(&Vec3::from(a.jets.origin)), &exact(&Vec3::from(b.jets.origin)));
    let mut cuts: Vec<f64> = a.cuts();
    // 1 − s is rounded; the pieces of the other curve are cut at the rounded places, see `SeamSide::over`.
    cuts.extend(b.cuts().into_iter().map(|t| if turned { 1.0 - t } else { t }));
    greatest(cuts, EXCESS * tolerance, |s0, s1| piece([a, b], turned, &shift, [s0, s1]))
}

/// Bound (mm) of the difference between the lengths of the two sides of a seam: what one flat pattern is longer than the
/// other where they are joined. `None` if a curve leaves its patch.
///
/// `|p'| − |q'| = (p' − q')·m`, `m = (p' + q')/(|p'| + |q'|)`; over a piece the integral of `p' − q'` is known from the
/// ends, and m is nearly constant.
pub(super) fn length_difference([a, b]: [SeamSide; 2], turned: bool, tolerance: f64) -> Option<f64> {
    let mut cuts: Vec<f64> = a.cuts();
    cuts.extend(b.cuts().into_iter().map(|t| if turned { 1.0 - t } else { t }));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|x, y| x.to_bits() == y.to_bits());
    let over = |s0: f64, s1: f64| {
        length_difference_over([a, b], turned, [s0, s1]).map(|(known, spread)| SeamPiece { s0, s1, known, spread })
    };
    let mut pieces: Vec<SeamPiece> = cuts.windows(2).map(|w| over(w[0], w[1])).collect::<Option<_>>()?;
    let most = LENGTH_LOOKS * pieces.len();
    let mut looks = pieces.len();
    // The worst first: enclosures that do not narrow would be halved everywhere.
    while looks < most && pieces.iter().map(|p| p.spread).sum::<f64>() > LENGTH_EXCESS * tolerance {
        pieces.sort_by(|p, q| q.spread.total_cmp(&p.spread));
        let worst = pieces.len().div_ceil(LENGTH_WORST);
        let halved = pieces.drain(..worst).collect::<Vec<_>>();
        looks += 2 * halved.len();
        for p in halved {
            let middle = 0.5 * (p.s0 + p.s1);
            if !(p.s0 < middle && middle < p.s1) {
                return None;
            }
            pieces.extend([over(p.s0, middle)?, over(middle, p.s1)?]);
        }
    }
    let bound = pieces.iter().fold(Interval::ZERO, |sum, p| sum + p.known + Interval::symmetric(p.spread)).mag();
    bound.is_finite().then_some(bound)
}

/// A piece of both sides of a seam.
struct SeamPiece {
    s0: f64,
    s1: f64,
    /// What the ends tell of the difference of lengths, and by how much it may be off, mm.
    known: Interval,
    spread: f64,
}

/// What one side is longer than the other over a piece: what the ends tell, and by how much it may be off.
fn length_difference_over([a, b]: [SeamSide; 2], turned: bool, [s0, s1]: [f64; 2]) -> Option<(Interval, f64)> {
    if let (Some(p), Some(q)) = (a.model(s0, s1, false), b.model(s0, s1, turned)) {
        let off = p.minus(&q);
        let [first, last] = off.ends();
        return Some(difference_of([p.velocity(), q.velocity()], &sub(&last, &first), &off.velocity()));
    }
    let (p, q) = (a.over(s0, s1, false)?, b.over(s0, s1, turned)?);
    let whole = sub(&sub(&p.ends[1], &p.ends[0]), &sub(&q.ends[1], &q.ends[0]));
    let velocities = [p.curve.map(|x| x.d), q.curve.map(|x| x.d)];
    Some(difference_of(velocities, &whole, &sub(&velocities[0], &velocities[1])))
}

/// Difference of the lengths of two curves of these velocities, by how much their ends' difference changes and by the
/// difference of the velocities.
fn difference_of([dp, dq]: [V3<Interval>; 2], whole: &V3<Interval>, off: &V3<Interval>) -> (Interval, f64) {
    let both = length(&dp) + length(&dq);
    let m = add(&dp, &dq).map(|x| x / both).map(|x| x.intersect(Interval::symmetric(1.0)).unwrap_or(x));
    let middle = mid(&m).map(Interval::point);
    let rest = Interval::point(length_bound(off)) * Interval::point(length_bound(&sub(&m, &middle)));
    (dot(whole, &middle), rest.hi)
}

/// Pieces over which lengths are compared are halved until what the enclosures leave open is less than this share of the
/// tolerance along the whole seam, or so many are looked at for each that there was to begin with.
const LENGTH_EXCESS: f64 = 0.05;
/// See [`LENGTH_EXCESS`].
const LENGTH_LOOKS: usize = 16;
/// One of so many pieces is halved at a time.
const LENGTH_WORST: usize = 4;
/// Share of the domain by which the rounded coefficients of a trimming curve may stick out of it; beyond, it has left
/// it.
const OVERHANG: f64 = 1e-12;

/// Bounds of the gap over a piece and at its ends.
fn piece([a, b]: [SeamSide; 2], turned: bool, shift: &V3<Interval>, [s0, s1]: [f64; 2]) -> Option<(f64, f64)> {
    if let (Some(p), Some(q)) = (a.model(s0, s1, false), b.model(s0, s1, turned)) {
        return Some(p.moved(shift).minus(&q).size());
    }
    let p = a.over(s0, s1, false)?;
    let q = b.over(s0, s1, turned)?;
    let rough = (Interval::point(p.rough) + Interval::point(q.rough)).hi;
    let ends = [0, 1].map(|k: usize| add(&sub(&p.ends[k], &q.ends[k]), shift));
    let spread = [0, 1, 2].map(|d: usize| {
        let difference = p.curve[d] - q.curve[d];
        ends[0][d].hull(ends[1][d]).widen(difference.chord_deviation(rough))
    });
    Some((length_bound(&spread), length_bound(&ends[0]).max(length_bound(&ends[1]))))
}

/// A trimmed edge over a piece, relative to the origin of the patch's jets.
pub(super) struct EdgePiece {
    /// First and last point.
    pub ends: [V3<Interval>; 2],
    /// With derivatives with respect to the share of the piece.
    pub curve: V3<Jet>,
    /// See [`Jet::chord_deviation`].
    pub rough: f64,
}

impl SeamSide<'_> {
    /// See [`cuts`].
    pub(super) fn cuts(&self) -> Vec<f64> {
        cuts(self.trim, self.jets.breaks())
    }

    /// As [`SeamSide::over`], closer where it can be.
    pub(super) fn model(&self, s0: f64, s1: f64, backwards: bool) -> Option<CurveModel> {
        self.jets.model(&self.parameters(s0, s1, backwards))
    }

    /// Bernstein coefficients of the trimming curve over a piece.
    fn parameters(&self, s0: f64, s1: f64, backwards: bool) -> [Vec<Interval>; 2] {
        let (from, to) = if backwards { (1.0 - s1, 1.0 - s0) } else { (s0, s1) };
        let mut theta = trim_piece(self.trim, from, to);
        if backwards {
            theta.iter_mut().for_each(|c| c.reverse());
        }
        theta
    }

    /// The edge over `[s0, s1]`, or over `[1 − s1, 1 − s0]` backwards.
    ///
    /// Rounding of `1 − s` shifts the correspondence by less than a unit in the last place and never leaves a gap, since
    /// neighbouring pieces round alike.
    pub(super) fn over(&self, s0: f64, s1: f64, backwards: bool) -> Option<EdgePiece> {
        let theta = self.parameters(s0, s1, backwards);
        let (lo, hi) = self.jets.domain();
        let domain = Interval { lo, hi };
        let (mut t, r) = (Jet::of_bernstein(&theta[0]), Jet::of_bernstein(&theta[1]));
        if !domain.widen(OVERHANG * (hi - lo)).encloses(t.v) {
            return None;
        }
        t.v = t.v.intersect(domain)?;
        let (curve, rough) = self.jets.along_curve(t, r);
        let last = theta[0].len() - 1;
        let at = |k: usize| Some(self.jets.at(theta[0][k].intersect(domain)?, theta[1][k]));
        Some(EdgePiece { ends: [at(0)?, at(last)?], curve, rough })
    }
}
