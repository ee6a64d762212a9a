//! Rigorous boxes around parts of curves and surfaces.
//!
//! *Method.* The part is brought to Bernstein form by blossoms in interval arithmetic \[R89, MKC09\]; its values lie in
//! the hull of the coefficients. Rational values are quotients of the intervals, valid because weights are positive.
//! *Guarantee.* Every exact value of the spline with the stored coefficients lies in the box, rounding included.
//! *Not guaranteed*: that the box is tight. Its excess shrinks with the square of the part's size.

use super::blossom::of_piece;
use super::curve::Curve;
use super::surface::Surface;
use crate::num::interval::Interval;

/// `degree` blossom arguments for Bernstein coefficient `k` of the part from `a` to `b`.
fn corner_arguments(a: f64, b: f64, degree: usize, k: usize) -> Vec<Interval> {
    (0..degree).map(|i| Interval::point(if i < degree - k { a } else { b })).collect()
}

/// The part of `[a, b]` in each polynomial piece: `(span, from, to)`.
fn parts(knots: &super::knots::Knots, a: f64, b: f64) -> Vec<(usize, f64, f64)> {
    let (start, end) = knots.domain();
    let (a, b) = (a.clamp(start, end), b.clamp(start, end));
    if a >= b {
        return vec![(knots.span(a), a, a)];
    }
    knots
        .breaks()
        .windows(2)
        .filter(|w| w[0] < b && w[1] > a)
        .map(|w| (knots.span(0.5 * (w[0] + w[1])), w[0].max(a), w[1].min(b)))
        .collect()
}

fn hull_of<const D: usize>(hull: &mut Option<[Interval; D]>, x: [Interval; D]) {
    *hull = Some(match hull {
        None => x,
        Some(h) => std::array::from_fn(|d| h[d].hull(x[d])),
    });
}

impl<const D: usize> Curve<D> {
    /// A box that holds the curve over `[a, b]` (clamped to the domain).
    pub fn bounds(&self, a: f64, b: f64) -> [Interval; D] {
        let p = self.knots.degree();
        let mut hull = None;
        for (span, from, to) in parts(&self.knots, a.min(b), a.max(b)) {
            for k in 0..=p {
                let mut net: Vec<[Interval; D]> =
                    self.control[span - p..=span].iter().map(|c| c.map(Interval::point)).collect();
                hull_of(&mut hull, of_piece(&self.knots, span, &mut net, &corner_arguments(from, to, p, k)));
            }
        }
        hull.unwrap_or([Interval::EVERYTHING; D])
    }
}

impl Surface {
    /// A box of space that holds the surface over `[u0, u1] × [v0, v1]` (clamped to the domain).
    pub fn bounds(&self, u: (f64, f64), v: (f64, f64)) -> [Interval; 3] {
        let (p, q, row) = (self.knots_u.degree(), self.knots_v.degree(), self.row());
        let mut hull = None;
        for (su, u0, u1) in parts(&self.knots_u, u.0.min(u.1), u.0.max(u.1)) {
            for (sv, v0, v1) in parts(&self.knots_v, v.0.min(v.1), v.0.max(v.1)) {
                // Along v in every row that matters, then along u.
                let lines: Vec<Vec<[Interval; 4]>> = (su - p..=su)
                    .map(|i| {
                        let line = &self.control[i * row + sv - q..=i * row + sv];
                        (0..=q)
                            .map(|k| {
                                let mut net: Vec<[Interval; 4]> = line.iter().map(|c| c.map(Interval::point)).collect();
                                of_piece(&self.knots_v, sv, &mut net, &corner_arguments(v0, v1, q, k))
                            })
                            .collect()
                    })
                    .collect();
                for k in 0..=p {
                    let args = corner_arguments(u0, u1, p, k);
                    for l in 0..=q {
                        let mut net: Vec<[Interval; 4]> = lines.iter().map(|line| line[l]).collect();
                        let h = of_piece(&self.knots_u, su, &mut net, &args);
                        let x =
                            if self.rational { [h[0] / h[3], h[1] / h[3], h[2] / h[3]] } else { [h[0], h[1], h[2]] };
                        hull_of(&mut hull, x);
                    }
                }
            }
        }
        hull.unwrap_or([Interval::EVERYTHING; 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::sample::{any_curve, any_surface};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn values_never_leave_the_box(curve in any_curve(), x in 0.0..1.0f64, y in 0.0..1.0f64) {
            let b = curve.bounds(x, y);
            for i in 0..=50 {
                let p = curve.point(x + (y - x) * f64::from(i) / 50.0);
                for d in 0..3 {
                    // The sample itself carries rounding.
                    prop_assert!(b[d].lo - 1e-12 <= p[d] && p[d] <= b[d].hi + 1e-12);
                }
            }
            let whole = curve.bounds(0.0, 1.0);
            prop_assert!((0..3).all(|d| whole[d].mag() <= 10.0 + 1e-9));
        }

        #[test]
        fn values_of_rational_surfaces_never_leave_the_box(
            s in any_surface(), u in (0.0..1.0f64, 0.0..1.0f64), v in (0.0..1.0f64, 0.0..1.0f64),
        ) {
            let b = s.bounds(u, v);
            for i in 0..=8 {
                for j in 0..=8 {
                    let at = |r: (f64, f64), k: i32| r.0 + (r.1 - r.0) * f64::from(k) / 8.0;
                    let p = s.point(at(u, i), at(v, j));
                    for d in 0..3 {
                        prop_assert!(b[d].lo - 1e-11 <= p[d] && p[d] <= b[d].hi + 1e-11);
                    }
                }
            }
        }
    }

    #[test]
    fn boxes_of_small_parts_are_small() {
        // Around the top of a parabola, where the hull of the coefficients is not the range.
        let c = Curve::<1>::new(2, vec![0., 0., 0., 1., 1., 1.], vec![[0.], [1.], [0.]]).expect("curve");
        let excess = |size: f64| {
            let b = c.bounds(0.5 - size, 0.5 + 0.6 * size)[0];
            (b.hi - 0.5) + (c.point(0.5 - size)[0] - b.lo)
        };
        let (e1, e2, e3) = (excess(0.2), excess(0.1), excess(0.05));
        assert!(e3 > 1e-4 && e2 < 0.3 * e1 && e3 < 0.3 * e2, "{e1} {e2} {e3}");
        assert!(c.bounds(0.3, 0.3)[0].rad() < 1e-14);
    }
}
