//! How nearly developable the exported patch is, from its control points alone.
//!
//! *Method* \[certificate, 4\]: with homogeneous boundary curves a(t), b(t), the tangent planes at the two ends of a
//! ruling are `a∧b∧a'` and `a∧b∧b'`; their normals n0, n1 satisfy `n0 × n1 = ± Δ (w_a x_b − w_b x_a)` with
//! `Δ = det(a, a', b, b')`. With the halves α, β of degree p − 1 (`a = (1−s) α + s β`) the line `a∧a'` is `p α∧β` without
//! cancellation, degree 2p − 2. All as interval Bernstein products on quarters of the spans, origin at the middle.
//!
//! Only the trimmed part matters: on every part of the parameter interval, a and b are taken at the ends of the range
//! of r that the trimming curves reach there (a region bounded by curves reaches no farther than they do on any
//! ruling). Outside it the patch may well run into its regression curve.
//!
//! Both normals having a positive component along one direction while being parallel up to a tiny angle, no point of
//! the regression curve lies between A and B.

use super::boundary::trim_piece;
use super::ruled::Ruled;
use crate::num::bernstein::{hull, product};
use crate::num::interval::Interval;
use crate::spline::curve::Curve;

/// Angle (rad) up to which a patch counts as developable: two micrometres over a metre, far below anything that can be
/// made; above rounding, which grows near the regression curve.
pub(super) const ANGLE_LIMIT: f64 = 2e-6;

/// Spans are cut into this many parts; hulls of products are then tight.
const PARTS: usize = 4;

/// Parts that show nothing are halved at most this often.
const HALVINGS: usize = 6;

/// Smallest cosine allowed between a normal and the part's middle normal.
const COSINE: f64 = 0.1;

/// The range of r on a part is taken at least this wide: on nearly no ruling at all, rounding would rule.
const LEAST_RANGE: f64 = 0.05;

/// Trimming curves are enclosed by boxes of this many pieces per span.
const BOXES: usize = 8;

/// What the control points show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Developability {
    /// Bound (rad) of the angle between the tangent planes at both ends of the used part of any ruling.
    pub angle: f64,
    /// Whether no ruling meets the regression curve in its used part.
    pub regular: bool,
}

/// Boxes (t, r) that together contain the trimming curves.
pub(super) fn trim_boxes<'a>(curves: impl IntoIterator<Item = &'a Curve<2>>) -> Vec<[Interval; 2]> {
    let mut out = Vec::new();
    for c in curves {
        for w in c.knots.breaks().windows(2) {
            let cut = |i: usize| if i == BOXES { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / BOXES as f64 };
            out.extend((0..BOXES).map(|i| trim_piece(c, cut(i), cut(i + 1)).map(|b| hull(&b))));
        }
    }
    out
}

/// Bounds the angle between tangent planes along the rulings inside the trimming curves.
pub(super) fn developability(patch: &Ruled, trims: &[[Interval; 2]]) -> Developability {
    developability_within(patch, trims, ANGLE_LIMIT)
}

/// The same with another angle (rad) up to which a patch counts as developable: parts are halved until they show it.
pub(super) fn developability_within(patch: &Ruled, trims: &[[Interval; 2]], limit: f64) -> Developability {
    let mut worst = Developability { angle: 0.0, regular: true };
    for w in patch.breaks().windows(2) {
        let cut = |i: usize| if i == PARTS { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / PARTS as f64 };
        let mut open: Vec<(f64, f64, usize)> = (0..PARTS).map(|i| (cut(i), cut(i + 1), 0)).collect();
        while let Some((a, b, depth)) = open.pop() {
            let Some(r) = used_range(trims, a, b) else { continue };
            let part = on_part(patch, a, b, r, limit);
            if (part.regular && part.angle <= limit) || depth == HALVINGS {
                worst.angle = worst.angle.max(part.angle);
                worst.regular &= part.regular;
            } else {
                let m = 0.5 * (a + b);
                open.extend([(a, m, depth + 1), (m, b, depth + 1)]);
            }
        }
    }
    worst
}

/// Range of r that the trimming curves reach over `[a, b]`; `None` when they do not come there.
fn used_range(trims: &[[Interval; 2]], a: f64, b: f64) -> Option<Interval> {
    let r = trims.iter().filter(|[t, _]| t.lo <= b && t.hi >= a).map(|[_, r]| *r).reduce(Interval::hull)?;
    let missing = (0.5 * (LEAST_RANGE - (r.hi - r.lo))).max(0.0);
    Some(Interval { lo: (r.lo - missing).max(0.0), hi: (r.hi + missing).min(1.0) })
}

type Poly = Vec<Interval>;

/// `x y − z w` of polynomials.
fn minor(x: &Poly, y: &Poly, z: &Poly, w: &Poly) -> Poly {
    product(x, y).into_iter().zip(product(z, w)).map(|(a, b)| a - b).collect()
}

/// `a∧a'/p`: the six minors 01, 02, 03, 12, 13, 23 of the halves.
fn tangent_line(a: &[Poly; 4]) -> [Poly; 6] {
    let low = |d: usize| a[d][..a[d].len() - 1].to_vec();
    let high = |d: usize| a[d][1..].to_vec();
    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| minor(&low(i), &high(j), &low(j), &high(i)))
}

/// Normal of the plane through a line (six minors) and a point.
fn plane_normal(l: &[Poly; 6], b: &[Poly; 4]) -> [Poly; 3] {
    // 3×3 minors of rows (line, point) in the columns (y z w), (z x w), (x y w): coefficients of x, y, z.
    let three = |ij: &Poly, k: &Poly, ik: &Poly, j: &Poly, jk: &Poly, i: &Poly| -> Poly {
        let (p, q, r) = (product(ij, k), product(ik, j), product(jk, i));
        (0..p.len()).map(|n| p[n] - q[n] + r[n]).collect()
    };
    let [xy, xz, xw, yz, yw, zw] = l;
    let minus = |p: Poly| -> Poly { p.into_iter().map(|x| -x).collect() };
    [
        three(yz, &b[3], yw, &b[2], zw, &b[1]),
        minus(three(xz, &b[3], xw, &b[2], zw, &b[0])),
        three(xy, &b[3], xw, &b[1], yw, &b[0]),
    ]
}

fn on_part(patch: &Ruled, a: f64, b: f64, used: Interval, limit: f64) -> Developability {
    let origin = patch.middle(0.5 * (a + b));
    let (first, last) = (patch.end(0, a, b, &origin), patch.end(1, a, b, &origin));
    let at = |r: f64| -> [Poly; 4] {
        let (r, s) = (Interval::point(r), Interval::ONE - Interval::point(r));
        [0, 1, 2, 3].map(|d: usize| first[d].iter().zip(&last[d]).map(|(&x, &y)| x * s + y * r).collect())
    };
    let (pa, pb) = (at(used.lo), at(used.hi));
    let (la, lb) = (tangent_line(&pa), tangent_line(&pb));
    // Laplace expansion of det(α_a, β_a, α_b, β_b) by pairs of rows.
    let mut delta: Poly = Vec::new();
    for (i, j, sign) in [(0, 5, 1.0), (1, 4, -1.0), (2, 3, 1.0), (3, 2, 1.0), (4, 1, -1.0), (5, 0, 1.0)] {
        let term = product(&la[i], &lb[j]);
        if delta.is_empty() {
            delta = vec![Interval::ZERO; term.len()];
        }
        for (d, t) in delta.iter_mut().zip(term) {
            *d += t * sign;
        }
    }
    // a∧b∧a' and a∧b∧b' have the same orientation where the patch is regular: −(a∧a')∧b and (b∧b')∧a.
    let n0 = plane_normal(&la, &pb).map(|p| p.into_iter().map(|x| -x).collect::<Poly>());
    let n1 = plane_normal(&lb, &pa);
    let ruling = [0, 1, 2].map(|d: usize| hull(&minor(&pa[3], &pb[d], &pb[3], &pa[d])));
    let middle = [0, 1, 2].map(|d: usize| n0[d][n0[d].len() / 2].mid());
    let size = middle.iter().map(|x| x * x).sum::<f64>().sqrt();
    let component = |n: &[Poly; 3]| -> (f64, f64) {
        let along: Poly = (0..n[0].len())
            .map(|i| (0..3).fold(Interval::ZERO, |s, d| s + n[d][i] * Interval::point(middle[d] / size)))
            .collect();
        let length = super::vector::length(&[0, 1, 2].map(|d: usize| hull(&n[d])));
        (hull(&along).lo, length.hi)
    };
    let ((c0, l0), (c1, l1)) = (component(&n0), component(&n1));
    // The direction is of unit length up to rounding, which 1e-12 pays for many times over.
    let (low0, low1) = (Interval::point(c0 * (1.0 - 1e-12)), Interval::point(c1 * (1.0 - 1e-12)));
    if !(c0 > 0.0 && c1 > 0.0) {
        return Developability { angle: std::f64::consts::FRAC_PI_2, regular: false };
    }
    let top = Interval::point(hull(&delta).mag()) * Interval::point(super::vector::length_bound(&ruling));
    let sine = (top / (low0 * low1)).hi;
    // asin x ≤ x (1 + x²) for x ≤ ½.
    let angle = if sine <= 0.5 { sine * (1.0 + sine * sine) } else { std::f64::consts::FRAC_PI_2 };
    let regular = angle <= limit && c0 > COSINE * l0 && c1 > COSINE * l1;
    Developability { angle, regular }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::*;

    /// Everything between two values of r.
    fn all(lo: f64, hi: f64) -> Vec<[Interval; 2]> {
        vec![[Interval::EVERYTHING, Interval::new(lo, hi)]]
    }

    #[test]
    fn exact_patches_are_developable_and_tampered_ones_are_not() {
        for patch in [primal_patch(), dual_patch()] {
            let good = developability(&Ruled::new(&patch).expect("ruled"), &all(0.0, 1.0));
            assert!(good.regular && good.angle < ANGLE_LIMIT, "{good:?}");
            let mut bad = patch;
            bad.control[8][2] += 1e-5;
            let bad = developability(&Ruled::new(&bad).expect("ruled"), &all(0.0, 1.0));
            assert!(bad.angle > ANGLE_LIMIT, "{bad:?}");
        }
    }

    #[test]
    fn angles_are_bounded_on_a_doubly_ruled_surface() {
        // z = x y with rulings y = const: tangent planes turn by atan 1 from x = 0 to x = 1 on every ruling near y = 0.
        let saddle = ruled_patch(1, &[0.0, 1.0], &|t, e| [e as f64, t, t * e as f64, 1.0]);
        let d = developability(&Ruled::new(&saddle).expect("ruled"), &all(0.0, 1.0));
        assert!(d.angle >= std::f64::consts::FRAC_PI_4 && !d.regular, "{d:?}");
    }

    #[test]
    fn the_regression_curve_between_the_ends_is_noticed() {
        // Tangents of a twisted cubic on both sides of their points of contact.
        let tangents = ruled_patch(4, &[0.2, 1.0], &|t, e| {
            let s = [-0.5, 0.5][e];
            [t + s, t * t + 2.0 * s * t, t * t * t + 3.0 * s * t * t, 1.0]
        });
        let d = developability(&Ruled::new(&tangents).expect("ruled"), &all(0.0, 1.0));
        assert!(!d.regular, "{d:?}");
        let upper = developability(&Ruled::new(&tangents).expect("ruled"), &all(0.7, 0.9));
        assert!(upper.regular && upper.angle < ANGLE_LIMIT, "{upper:?}");
        let one_side = ruled_patch(4, &[0.2, 1.0], &|t, e| {
            let s = [0.3, 0.8][e];
            [t + s, t * t + 2.0 * s * t, t * t * t + 3.0 * s * t * t, 1.0]
        });
        let d = developability(&Ruled::new(&one_side).expect("ruled"), &all(0.0, 1.0));
        assert!(d.regular && d.angle < ANGLE_LIMIT, "{d:?}");
    }
}
