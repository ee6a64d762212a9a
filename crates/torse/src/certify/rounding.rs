//! How far the exported patch is from the exact torse.
//!
//! *Method*: every ruling of the patch, at parameter t, is compared with the torse's ruling at t. The numerators of
//! `n(t)·A(t) − h(t)` and `m(t)·A(t) − k(t)` are polynomials that ought to vanish; their interval Bernstein
//! coefficients bound what rounding has left of them. With `F, μ` these residuals, the distance from A(t) to the ruling
//! is the root of `F²/|n|² + (μ − F (n·m)/|n|²)²/|m⊥|²` \[certificate, 1\]. Points between A and B are convex
//! combinations. Nothing is assumed about how the patch was made \[certificate, 4\].

use super::family::{Family, Forms};
use super::ruled::{common_breaks, Ruled};
use super::vector::length;
use crate::num::bernstein::{hull, product};
use crate::num::interval::Interval;

/// A span is halved at most this often to keep |n| and |m⊥| away from zero.
const HALVINGS: usize = 12;

/// Bound (mm) of the distance between points of the patch and the torse's ruling at the same parameter; `None` when the
/// patch reaches outside the torse's domain or the torse's planes degenerate.
pub(super) fn rounding_bound(family: &Family, patch: &Ruled) -> Option<f64> {
    let (t0, t1) = family.domain();
    let own = patch.breaks();
    let (a, b) = (own[0], own[own.len() - 1]);
    if a < t0 || b > t1 {
        return None;
    }
    let mut open: Vec<(f64, f64, usize)> =
        common_breaks(&own, family.breaks(), a, b).windows(2).map(|w| (w[0], w[1], 0)).collect();
    let mut bound = 0.0f64;
    while let Some((a, b, depth)) = open.pop() {
        match on_piece(family, patch, a, b) {
            Some(x) => bound = bound.max(x),
            None if depth < HALVINGS => {
                let m = 0.5 * (a + b);
                open.extend([(a, m, depth + 1), (m, b, depth + 1)]);
            }
            None => return None,
        }
    }
    Some(bound)
}

fn on_piece(family: &Family, patch: &Ruled, a: f64, b: f64) -> Option<f64> {
    let plane = family.over(Interval::new(a, b));
    // |m⊥| = |n × m|/|n|.
    let cross = length(&Family::direction(&plane));
    let n_len = plane.nn.sqrt();
    let across = (cross * Interval::point(1.0 - 4.0 * (family.metric - 1.0)) / n_len).lo;
    if across <= 0.0 || n_len.lo <= 0.0 {
        return None;
    }
    let slant = (plane.nm.abs() / plane.nn).hi;
    let forms = family.bernstein(a, b);
    let origin = [family.origin.x, family.origin.y, family.origin.z];
    let mut bound = 0.0f64;
    for end in 0..2 {
        let x = patch.end(end, a, b, &origin);
        let w = hull(&x[3]);
        if w.lo <= 0.0 {
            return None;
        }
        let size = w * forms.scale;
        if size.lo <= 0.0 {
            return None;
        }
        let f = (Interval::point(residual(&forms, &x, true)) / size).hi;
        let mu = (Interval::point(residual(&forms, &x, false)) / size).hi;
        let up = Interval::point(f) / Interval::point(n_len.lo);
        let side = (Interval::point(mu) + Interval::point(f) * Interval::point(slant)) / Interval::point(across);
        bound = bound.max(((up.sqr() + side.sqr()).sqrt() * Interval::point(family.metric)).hi);
    }
    bound.is_finite().then_some(bound)
}

/// Largest Bernstein coefficient of `n·x − h w` (or `m·x − k w`).
fn residual(forms: &Forms, x: &[Vec<Interval>; 4], normal: bool) -> f64 {
    let (v, s) = if normal { (&forms.n, &forms.h) } else { (&forms.m, &forms.k) };
    let mut sum: Vec<Interval> = product(s, &x[3]).into_iter().map(|c| -c).collect();
    for d in 0..3 {
        for (c, y) in sum.iter_mut().zip(product(&v[d], &x[d])) {
            *c += y;
        }
    }
    hull(&sum).mag()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::*;
    use crate::spline::surface::Surface;
    use crate::torse::form::Torse;

    fn eta(torse: &Torse, patch: &Surface) -> Option<f64> {
        rounding_bound(&Family::new(torse).expect("family"), &Ruled::new(patch).expect("ruled"))
    }

    #[test]
    fn exact_patches_differ_by_rounding_only() {
        for (torse, patch, size) in [
            (Torse::Primal(primal()), primal_patch(), 45.0),
            (Torse::Dual(dual()), dual_patch(), 5.0),
            // The forms of a cylinder are as many times longer as its profile is fast: up to eleven here, and five at least.
            (Torse::Cylinder(cylinder()), cylinder_patch(), 45.0 * 11.0 / 5.0 * 2.0),
        ] {
            let bound = eta(&torse, &patch).expect("a bound");
            assert!(bound < 1e-12 * size, "{bound:e}");
            // Points between the ends of a ruling are as near as stated.
            let ((t0, t1), _) = patch.domain();
            for i in 0..=50 {
                let t = t0 + (t1 - t0) * i as f64 / 50.0;
                let r = torse.ruling(t);
                for v in [0.0, 0.3, 1.0] {
                    let off = (patch.point(t, v) - r.point).cross(&r.direction).norm();
                    assert!(off <= bound + 1e-13 * size, "{t} {v}: {off:e} {bound:e}");
                }
            }
        }
    }

    #[test]
    fn a_control_point_moved_is_seen() {
        for by in [1e-9, 1e-6] {
            for (torse, mut patch) in
                [(Torse::Primal(primal()), primal_patch()), (Torse::Cylinder(cylinder()), cylinder_patch())]
            {
                patch.control[8][2] += by;
                let bound = eta(&torse, &patch).expect("a bound");
                assert!(bound > 0.2 * by && bound < 1.5 * by, "{bound:e} for {by:e}");
            }
        }
    }
}
