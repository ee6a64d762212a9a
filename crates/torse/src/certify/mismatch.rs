//! What boundary, edges and rounding add to the distance, on every triangle of a panel's region \[certificate, 1\].
//!
//! *Theorem*. With paths as in [`boundary`](super::boundary), a point y of the panel that is on no path is the foot of some
//! point X of the region, and D(X) away from it: nothing is added there. A point on a path from the foot of X′ on the
//! boundary is at most `√((D(X′) + κδ²/2)² + δ²)` from X′, with δ and κ of the side of the boundary on which X′ lies.
//! With several sides near, the largest δ and the largest κδ²/2 of one of them are enough. Conversely, the foot P of a point X of the region is on the panel, or on such a path, and then at most δ along the torse
//! from a point of the panel's boundary: X is at most `√((D(X) + κδ²/2)² + δ²)` from that. In this case
//! `|X − X′| ≤ |X − P| + |P − P′| + |P′ − X′| ≤ D(X) + δ + D(X′)`. So a side adds its mismatch to those triangles only that
//! are nearer to it than 2D + δ, and to those that it bounds. Nearness is judged by boxes in space.

use super::boundary::Side;
use super::distance::{sag, way_total, Curl};
use super::prepared::Prepared;
use crate::num::interval::Interval;
use crate::num::parallel;

/// Mismatch, as a share of the tolerance, below which it is the same everywhere: it takes less than a five-thousandth of
/// the tolerance, as it enters in quadrature.
const ALIKE: f64 = 0.02;

/// What boundary, edges and rounding add to the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mismatch {
    /// Bound of the length of the paths, mm.
    pub delta: f64,
    /// Bound of the torse's curvature along them, 1/mm.
    pub curvature: f64,
    /// Bound of κδ²/2, mm: short paths may run where the torse is bent sharply, and long ones where it is not.
    pub sag: f64,
    /// What is added to all, mm.
    pub eta: f64,
}

impl Mismatch {
    /// What is added by rounding, and nothing else.
    pub fn of_rounding(eta: f64) -> Self {
        Self { delta: 0.0, curvature: 0.0, sag: 0.0, eta }
    }

    /// The same with a side of the boundary.
    pub fn with_side(self, side: &Side) -> Self {
        Self {
            delta: self.delta.max(side.bound),
            curvature: self.curvature.max(side.curvature),
            sag: self.sag.max(sag(side.bound, side.curvature)),
            ..self
        }
    }

    /// `√((D + κδ²/2)² + δ²) + η`, rounded up.
    pub fn total(&self, distance: f64) -> f64 {
        way_total(distance, self.delta, self.sag, self.eta)
    }

    /// The mismatch where a region folds at its rim: ways to the trimming curves are longer by the ways to the rim.
    pub fn with(&self, curl: &Curl) -> Self {
        let delta = (Interval::point(self.delta) + Interval::point(curl.way)).hi;
        let curvature = self.curvature.max(curl.curvature);
        Self { delta, curvature, sag: sag(delta, curvature), ..*self }
    }

    /// A distance for which [`Mismatch::total`] stays within the tolerance; not positive when there is none.
    pub fn budget(&self, tolerance: f64) -> f64 {
        // A few roundings, each of a unit in the last place of the tolerance.
        const ROUNDING: f64 = 16.0 * f64::EPSILON;
        let rest = tolerance * (1.0 - ROUNDING) - self.eta;
        if rest <= self.delta || rest.is_nan() {
            return 0.0;
        }
        let square = self.delta * self.delta;
        (rest * rest - square).sqrt() - self.sag - ROUNDING * tolerance
    }

    /// What each triangle adds, where no distance is above the tolerance: `self`, but of the sides that are near alone.
    pub fn on_triangles(
        &self,
        prepared: &Prepared,
        triangles: &[[[f64; 2]; 3]],
        sides: &[Side],
        tolerance: f64,
    ) -> Vec<Self> {
        if self.delta <= ALIKE * tolerance || !self.delta.is_finite() {
            return vec![*self; triangles.len()];
        }
        let reach = (Interval::point(tolerance) * Interval::point(2.0) + Interval::point(self.delta)).hi;
        let around = |s: &Side| around(prepared, &[s.ends[0], s.ends[1], s.ends[1]]);
        let boxes: Vec<(Around, &Side)> = parallel::map(sides.iter(), |s| (widened(around(s), reach), s));
        let of = |t: &[[f64; 2]; 3]| {
            let here = self::around(prepared, t);
            let sides = boxes.iter().filter(|(b, _)| near(&here, b));
            sides.fold(Self::of_rounding(self.eta), |m, (_, s)| m.with_side(s))
        };
        parallel::map(triangles.iter(), of)
    }

    /// What each triangle adds, `local`, where parts of some of them may fold at the rim: points no farther from these than twice the
    /// distance may have the way to the rim before them, and that from there to the trimming curve.
    pub fn with_folds(
        local: &[Self],
        folds: &[(usize, Curl)],
        (prepared, triangles): (&Prepared, &[[[f64; 2]; 3]]),
        tolerance: f64,
    ) -> Vec<Self> {
        let reach = (Interval::point(tolerance) * Interval::point(2.0)).hi;
        let longer =
            |(k, curl): &(usize, Curl)| (widened(around(prepared, &triangles[*k]), reach), local[*k].with(curl));
        let longer: Vec<(Around, Self)> = folds.iter().map(longer).collect();
        let of = |(t, own): (&[[f64; 2]; 3], &Self)| {
            let here = around(prepared, t);
            longer.iter().filter(|(b, _)| near(&here, b)).fold(*own, |m, (_, other)| m.with_other(other))
        };
        parallel::map(triangles.iter().zip(local), of)
    }

    /// The greater of two, each for itself.
    fn with_other(self, other: &Self) -> Self {
        Self {
            delta: self.delta.max(other.delta),
            curvature: self.curvature.max(other.curvature),
            sag: self.sag.max(other.sag),
            eta: self.eta.max(other.eta),
        }
    }
}

/// A box in space; `None` if it is not known, and near to all.
type Around = Option<[Interval; 3]>;

/// The box around a triangle of the parameter plane.
fn around(prepared: &Prepared, t: &[[f64; 2]; 3]) -> Around {
    let patch = prepared.patch_of(t)?;
    Some(patch.over(t).around(&patch.centre))
}

fn widened(around: Around, reach: f64) -> Around {
    around.map(|b| b.map(|x| x.widen(reach)))
}

fn near(a: &Around, b: &Around) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (0..3).all(|d| a[d].lo <= b[d].hi && b[d].lo <= a[d].hi),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    #[test]
    fn the_budget_keeps_the_total_within_the_tolerance() {
        for (delta, curvature, eta) in [(0.0, 0.0, 0.0), (0.07, 0.5, 1e-9), (0.5, 0.1, 1e-3), (0.9, 0.0, 0.05)] {
            let m = Mismatch { delta, curvature, sag: sag(delta, curvature), eta };
            let d = m.budget(1.0);
            assert!(d > 0.0 && m.total(d) <= 1.0 && m.total(d) > 1.0 - 1e-12, "{m:?} {d}");
        }
        assert!(Mismatch { delta: 1.0, ..Mismatch::of_rounding(0.0) }.budget(1.0) <= 0.0);
        assert!(Mismatch::of_rounding(f64::INFINITY).budget(1.0) <= 0.0);
    }

    #[test]
    fn sharp_bends_count_where_ways_are_long_alone() {
        let side = |bound: f64, curvature: f64| Side { ends: [[0.0; 2]; 2], bound, curvature };
        // A thousandth of a millimetre beside a tip, and 0.7 mm where the radius is 100 mm.
        let both = Mismatch::of_rounding(0.0).with_side(&side(1e-3, 10.0)).with_side(&side(0.7, 0.01));
        assert!((both.total(1.0) - (1.0 + 0.005 * 0.49_f64).hypot(0.7)).abs() < 1e-12, "{both:?}");
        assert!(both.total(1.0) >= Mismatch::of_rounding(0.0).with_side(&side(0.7, 0.01)).total(1.0));
    }

    #[test]
    fn sides_count_near_by_alone() {
        // A plane of 100 × 100 mm in squares of 10 mm, cut in halves.
        let knots = || Knots::new(1, vec![0.0, 0.0, 1.0, 1.0], 2).expect("knots");
        let corners = [0, 1, 2, 3].map(|k| Vec3::new(100.0 * (k / 2) as f64, 100.0 * (k % 2) as f64, 0.0));
        let surface = Surface::new(knots(), knots(), &corners, None).expect("plane");
        let prepared = Prepared::new(&surface);
        let at = |i: usize, j: usize| [i as f64 / 10.0, j as f64 / 10.0];
        let squares = (0..100).map(|k| (k / 10, k % 10));
        let triangles: Vec<[[f64; 2]; 3]> = squares
            .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
            .collect();
        let side = |i: usize, bound: f64| Side { ends: [at(i, 0), at(i + 1, 0)], bound, curvature: bound };
        let sides: Vec<Side> = (0..10).map(|i| side(i, if i == 4 { 0.5 } else { 0.1 })).collect();
        let whole = sides.iter().fold(Mismatch::of_rounding(1e-3), Mismatch::with_side);
        let found = whole.on_triangles(&prepared, &triangles, &sides, 1.0);
        // Within 2.5 mm of the wide side, of the others, of none.
        for (t, m) in triangles.iter().zip(&found) {
            let (low, high) = (t.iter().map(|c| c[0]).fold(1.0, f64::min), t.iter().map(|c| c[0]).fold(0.0, f64::max));
            let first_row = t.iter().any(|c| c[1] <= 0.0);
            let delta = match (first_row, low <= 0.5 + 0.025 && high >= 0.4 - 0.025) {
                (true, true) => 0.5,
                (true, false) => 0.1,
                (false, _) => m.delta,
            };
            assert_eq!((m.delta, m.curvature, m.eta), (delta, delta, 1e-3), "{t:?}");
            let far = t.iter().all(|c| c[1] >= 0.15);
            assert!(!far || m.delta <= 0.0, "{t:?}");
        }
        // What is nothing much is alike everywhere.
        let little = Mismatch { delta: 0.01, ..whole };
        assert!(little.on_triangles(&prepared, &triangles, &sides, 1.0).iter().all(|m| *m == little));
    }

    #[test]
    fn ways_to_folds_count_near_these_alone() {
        // A plane of 100 × 10 mm in ten squares, cut in halves; the first may fold, and bends about 0.1 mm.
        let knots = || Knots::new(1, vec![0.0, 0.0, 1.0, 1.0], 2).expect("knots");
        let corners = [0, 1, 2, 3].map(|k| Vec3::new(100.0 * (k / 2) as f64, 10.0 * (k % 2) as f64, 0.0));
        let surface = Surface::new(knots(), knots(), &corners, None).expect("plane");
        let at = |i: usize, j: f64| [i as f64 / 10.0, j];
        let triangles: Vec<[[f64; 2]; 3]> = (0..10)
            .flat_map(|i| [[at(i, 0.0), at(i + 1, 0.0), at(i + 1, 1.0)], [at(i, 0.0), at(i + 1, 1.0), at(i, 1.0)]])
            .collect();
        let local = vec![Mismatch::of_rounding(1e-3); 20];
        let curl = Curl { way: 0.05, curvature: 10.0 };
        let found = Mismatch::with_folds(&local, &[(0, curl)], (&Prepared::new(&surface), &triangles), 1.0);
        for (t, m) in triangles.iter().zip(&found) {
            let is_near = t.iter().any(|c| c[0] <= 0.12);
            assert!((m.delta - if is_near { 0.05 } else { 0.0 }).abs() < 1e-15, "{t:?} {m:?}");
            assert!((m.sag - if is_near { 0.0125 } else { 0.0 }).abs() < 1e-15, "{t:?} {m:?}");
        }
    }
}
