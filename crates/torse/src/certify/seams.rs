//! Gaps between neighbouring panels: the distance of the two trimmed edges at equal places of the seam.
//!
//! `gap(s) = |R_i(θ_i(s)) − R_j(θ_j(1 − s))|` \[certificate, 5\]: chord between enclosed end values plus a quarter of the width of the enclosed
//! derivative, component by component, on pieces between the knots of both curves, halved while that pays.

use super::boundary::trim_piece;
use super::ruled::RuledJets;
use super::vector::{add, exact, length_bound, scale, sub, V3};
use crate::geom::Vec3;
use crate::num::bernstein::{derivative, hull};
use crate::num::interval::Interval;
use crate::surface::panel::Run;

/// Pieces are halved until the enclosure exceeds its end values by less than this share of the tolerance.
const EXCESS: f64 = 2e-3;

/// Halvings of a piece at most.
const DEPTH: usize = 10;

/// One side of a seam.
#[derive(Clone, Copy)]
pub(super) struct Shore<'a> {
    pub jets: &'a RuledJets,
    pub run: &'a Run,
}

/// Bound (mm) of the gap along a seam whose sides run against each other. `None` if a curve leaves its patch.
pub(super) fn gap_bound(a: Shore, b: Shore, tolerance: f64) -> Option<f64> {
    let shift = sub(&exact(&Vec3::from(a.jets.origin)), &exact(&Vec3::from(b.jets.origin)));
    let mut cuts: Vec<f64> = a.run.trim.knots.breaks();
    // 1 − s is rounded; the pieces of the other curve are cut at the rounded places, see `Shore::over`.
    cuts.extend(b.run.trim.knots.breaks().into_iter().map(|t| 1.0 - t));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|x, y| x.to_bits() == y.to_bits());
    let mut open: Vec<(f64, f64, usize)> = cuts.windows(2).map(|w| (w[0], w[1], 0)).collect();
    let mut bound = 0.0f64;
    while let Some((s0, s1, depth)) = open.pop() {
        let m = 0.5 * (s0 + s1);
        let can_halve = depth < DEPTH && s0 < m && m < s1;
        match piece(a, b, &shift, s0, s1) {
            Some((all, ends)) if all <= ends + EXCESS * tolerance || !can_halve => bound = bound.max(all),
            None if !can_halve => return None,
            _ => open.extend([(s0, m, depth + 1), (m, s1, depth + 1)]),
        }
    }
    Some(bound)
}

/// Bounds of the gap over a piece and at its ends.
fn piece(a: Shore, b: Shore, shift: &V3<Interval>, s0: f64, s1: f64) -> Option<(f64, f64)> {
    let p = a.over(s0, s1, false)?;
    let q = b.over(s0, s1, true)?;
    let ends = [0, 1].map(|k: usize| add(&sub(&p.ends[k], &q.ends[k]), shift));
    let slope = sub(&p.slope, &q.slope);
    let spread = [0, 1, 2].map(|d: usize| ends[0][d].hull(ends[1][d]).widen(0.25 * slope[d].width()));
    Some((length_bound(&spread), length_bound(&ends[0]).max(length_bound(&ends[1]))))
}

/// A trimmed edge over a piece.
struct EdgePiece {
    ends: [V3<Interval>; 2],
    slope: V3<Interval>,
}

impl Shore<'_> {
    /// The edge over `[s0, s1]`, or over `[1 − s1, 1 − s0]` backwards; its derivative with respect to the share of the piece.
    ///
    /// Rounding of `1 − s` shifts the correspondence by less than a unit in the last place and never leaves a gap, since
    /// neighbouring pieces round alike.
    fn over(&self, s0: f64, s1: f64, backwards: bool) -> Option<EdgePiece> {
        let (from, to) = if backwards { (1.0 - s1, 1.0 - s0) } else { (s0, s1) };
        let theta = trim_piece(&self.run.trim, from, to);
        let (lo, hi) = self.jets.domain();
        let domain = Interval { lo, hi };
        let t = hull(&theta[0]);
        if !domain.widen(1e-12 * (hi - lo)).encloses(t) {
            return None;
        }
        let jet = self.jets.over(t.intersect(domain)?, hull(&theta[1]));
        let slopes = [hull(&derivative(&theta[0])), hull(&derivative(&theta[1]))];
        let slope = add(&scale(&jet.dt, slopes[0]), &scale(&jet.dr, slopes[1]));
        let last = theta[0].len() - 1;
        let at = |k: usize| Some(self.jets.over(theta[0][k].intersect(domain)?, theta[1][k]).point);
        let (first, second) = (at(0)?, at(last)?);
        Some(if backwards {
            EdgePiece { ends: [second, first], slope: scale(&slope, -Interval::ONE) }
        } else {
            EdgePiece { ends: [first, second], slope }
        })
    }
}
