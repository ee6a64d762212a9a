//! Edges of two strips that are known, for borders to lie under.

use crate::geom::Vec3;
use crate::spline::curve::Curve;

/// Places on a known edge from which its nearest point is looked for.
const KNOWN: usize = 400;
/// Newton steps to a place on an edge, under a point, or between heights: some more than are taken.
pub(super) const STEPS: usize = 20;

/// An edge of two strips in space, and places on it.
pub(super) struct KnownEdge {
    pub(super) curve: Curve<3>,
    places: Vec<(f64, Vec3)>,
}

impl KnownEdge {
    pub(super) fn new(curve: Curve<3>) -> Self {
        let (a, b) = curve.domain();
        let at = |i: usize| a + (b - a) * i as f64 / KNOWN as f64;
        let places = (0..=KNOWN).map(|i| (at(i), Vec3::from(curve.point(at(i))))).collect();
        Self { curve, places }
    }

    /// The parameter of the point that lies beside `x`, not along the edge, as seen along the unit normal `n`, and how far
    /// (mm) `x` is to the left of it.
    pub(super) fn beside(&self, x: &Vec3, n: &Vec3) -> Option<(f64, f64)> {
        const SETTLED: f64 = 1e-15;
        let off = |p: &(f64, Vec3)| (p.1 - x).norm_squared();
        let mut s = self.places.iter().min_by(|p, q| off(p).total_cmp(&off(q)))?.0;
        let (a, b) = self.curve.domain();
        for _ in 0..STEPS {
            let j = self.curve.jet(s).map(Vec3::from);
            let along = j[1] - n * j[1].dot(n);
            let step = (x - j[0]).dot(&along) / j[1].dot(&along);
            if !step.is_finite() {
                return None;
            }
            let next = (s + step).clamp(a, b);
            let settled = (next - s).abs() <= SETTLED * (b - a);
            s = next;
            if settled {
                break;
            }
        }
        let j = self.curve.jet(s).map(Vec3::from);
        Some((s, (x - j[0]).dot(&n.cross(&j[1]).try_normalize(0.0)?)))
    }
}
