//! From a torse to the ruled B-spline patch that is written to files: closed forms in Bernstein algebra, no fitting
//! of the surface itself. The patch has u = t and is linear in v = r ∈ [0, 1] along the rulings.
//!
//! *Primal* torse, `x = t + y a`, `z = f + y g`: a boundary curve `y = y(t)` is a polynomial spline of degree 5 plus
//! the degree of `y`. *Cylinder*: of degree 3, or that of `y` if it is higher. *Dual* torse, planes `U = (n, h)`: a
//! boundary curve is the intersection of the ruling `L = U ∧ U'` with a plane `A(t)`, a rational spline of degree 4 plus the
//! degree of `A` \[PW99\].
//! Both boundary curves use the same L and planes of the same direction, hence equal weights: r is affine along a ruling.

use super::form::{CylinderTorse, DualTorse, PrimalTorse, Torse};
pub(crate) use super::patch_extent::ConvertError;
pub use super::patch_extent::Extent;
use super::patch_extent::{degree, patch_extent, Bound};
use crate::geom::Vec3;
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// Margin beyond the used rulings, share of the used range: as above.
const MARGIN_ACROSS: f64 = 0.02;
/// Regions narrower than this share of the torse's domain hold no rulings: rounding of their feet.
const NO_WIDTH: f64 = 1e-12;
/// The ruled patch over the used part of a torse with a margin of about 5 % along and 2 % across the rulings.
///
/// *Input*: boundary points of the used region near the torse, in mm, with their foot parameters.
/// *Guarantee*: `patch(t, r)` lies on the ruling t of the torse up to rounding, for every r; weights are positive and
/// do not depend on r; all points given have r in (0, 1).
/// *Not guaranteed*: that r = 0 and r = 1 follow the region closely where it is not bounded by smooth curves.
///
/// # Errors
/// Empty region; regression curve inside the patch; rulings that turn more than boundary families of degree 3 follow.
pub fn patch(torse: &Torse, extent: &Extent) -> Result<Surface, ConvertError> {
    // 1. Used range of rulings.
    let (mut t0, mut t1) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in extent.points() {
        t0 = t0.min(p.0);
        t1 = t1.max(p.0);
    }
    let (d0, d1) = torse.domain();
    if t0 > t1 || t1 - t0 <= NO_WIDTH * (d1 - d0) {
        return Err(ConvertError::Empty(extent.points().count()));
    }
    let margin = MARGIN_ACROSS * (t1 - t0);
    let range = ((t0 - margin).max(d0), (t1 + margin).min(d1));
    let bound = patch_extent(torse, extent, range)?;
    match torse {
        Torse::Primal(p) => primal_patch(p, &bound),
        Torse::Dual(d) => dual_patch(d, &bound),
        Torse::Cylinder(c) => cylinder_patch(c, &bound),
    }
}

/// Patch parameter r of the point of ruling `t` nearest `x`; outside [0, 1] beyond the boundary curves.
pub(crate) fn parameters(patch: &Surface, t: f64, x: &Vec3) -> f64 {
    let a = patch.homogeneous_jet(t, 0.0, 0)[0];
    let b = patch.homogeneous_jet(t, 1.0, 0)[0];
    let p = Vec3::new(a[0], a[1], a[2]) / a[3];
    let q = Vec3::new(b[0], b[1], b[2]) / b[3];
    let d = q - p;
    let l = (x - p).dot(&d) / d.norm_squared();
    // An affine parameter l belongs to r = l w_a / (l w_a + (1 − l) w_b).
    l * a[3] / (l * a[3] + (1.0 - l) * b[3])
}

fn primal_patch(torse: &PrimalTorse, bound: &Bound) -> Result<Surface, ConvertError> {
    let mut pieces = Vec::new();
    let mut g0 = torse.beta();
    for (a, b, net) in bezier_pieces(torse.profile()) {
        let f: Vec<f64> = net.iter().map(|c| c[0]).collect();
        let w: Vec<f64> = net.iter().map(|c| c[1]).collect();
        let integrand = product(&derivative(&f, b - a), &derivative(&w, b - a));
        let g = integral(&integrand, b - a, g0);
        g0 = g[g.len() - 1];
        for (lo, hi) in bound.parts(a, b) {
            let cut = |q: &[f64]| restrict(q, (lo - a) / (b - a), (hi - a) / (b - a));
            let (f, w, g) = (cut(&f), cut(&w), cut(&g));
            let curve = |y: &Curve<1>| -> [Vec<f64>; 4] {
                let [y] = coefficients(y, (lo, hi));
                let p = 5 + bound.degree();
                let x = sum(&elevate(&[lo, hi], p), &elevate(&product(&y, &w), p));
                let z = sum(&elevate(&f, p), &elevate(&product(&y, &g), p));
                let y = elevate(&y, p);
                let mut out = [vec![], vec![], vec![], vec![1.0; p + 1]];
                for i in 0..=p {
                    let q = torse.frame.to_world(&Vec3::new(x[i], y[i], z[i]));
                    for d in 0..3 {
                        out[d].push(q[d]);
                    }
                }
                out
            };
            pieces.push(BezierRails { a: lo, b: hi, curves: [curve(&bound.low), curve(&bound.high)] });
        }
    }
    let order =
        |t: f64| multiplicity(&torse.profile().knots, t).map_or(bound.order, |m| (3 - m as isize).min(bound.order));
    assemble(&pieces, order, false)
}

/// Boundary curves `(x(t), y(t), z(t))`: of degree 3, or that of `y`.
fn cylinder_patch(torse: &CylinderTorse, bound: &Bound) -> Result<Surface, ConvertError> {
    let mut pieces = Vec::new();
    for (a, b, net) in bezier_pieces(&torse.profile) {
        let component = |d: usize| -> Vec<f64> { net.iter().map(|c| c[d]).collect() };
        let (x, z) = (component(0), component(1));
        for (lo, hi) in bound.parts(a, b) {
            let cut = |q: &[f64]| restrict(q, (lo - a) / (b - a), (hi - a) / (b - a));
            let p = (x.len() - 1).max(bound.degree());
            let (x, z) = (elevate(&cut(&x), p), elevate(&cut(&z), p));
            let curve = |y: &Curve<1>| -> [Vec<f64>; 4] {
                let [y] = coefficients(y, (lo, hi));
                let y = elevate(&y, p);
                let mut out = [vec![], vec![], vec![], vec![1.0; p + 1]];
                for i in 0..=p {
                    let q = torse.frame.to_world(&Vec3::new(x[i], y[i], z[i]));
                    (0..3).for_each(|d| out[d].push(q[d]));
                }
                out
            };
            pieces.push(BezierRails { a: lo, b: hi, curves: [curve(&bound.low), curve(&bound.high)] });
        }
    }
    let order =
        |t: f64| multiplicity(&torse.profile.knots, t).map_or(bound.order, |m| (3 - m as isize).min(bound.order));
    assemble(&pieces, order, false)
}

fn dual_patch(torse: &DualTorse, bound: &Bound) -> Result<Surface, ConvertError> {
    let mut pieces = Vec::new();
    // About the used part: far from the origin of the model most digits would be lost in differences of large products.
    let origin = bound.origin;
    let about = |c: &[f64; 4]| [c[0], c[1], c[2], c[3] - Vec3::new(c[0], c[1], c[2]).dot(&origin)];
    let planes = Curve { knots: torse.planes.knots.clone(), control: torse.planes.control.iter().map(about).collect() };
    for (a, b, net) in bezier_pieces(&planes) {
        // U ∧ U' = (k/h) Ua ∧ Ub with Ua, Ub the de Casteljau halves of degree k − 1.
        let k = net.len() - 1;
        let half = |shift: usize, c: usize| -> Vec<f64> { (0..k).map(|i| net[i + shift][c]).collect() };
        let (ua, ub): (Vec<_>, Vec<_>) = (0..4).map(|c| (half(0, c), half(1, c))).unzip();
        let scale = k as f64 / (b - a);
        let minor = |i: usize, j: usize| -> Vec<f64> {
            let q = difference(&product(&ua[i], &ub[j]), &product(&ua[j], &ub[i]));
            q.iter().map(|x| x * scale).collect()
        };
        let whole = [[minor(1, 2), minor(2, 0), minor(0, 1)], [minor(3, 0), minor(3, 1), minor(3, 2)]];
        for (lo, hi) in bound.parts(a, b) {
            let [d, moment] = whole
                .each_ref()
                .map(|part| part.each_ref().map(|q| restrict(q, (lo - a) / (b - a), (hi - a) / (b - a))));
            let alpha = coefficients(&bound.direction, (lo, hi));
            let curve = |offset: &Curve<1>| -> [Vec<f64>; 4] {
                let [offset] = coefficients(offset, (lo, hi));
                let p = 2 * k - 2 + bound.degree();
                // w = α·d, w X = (h m − k n) × α + offset d.
                let dot = |x: &[Vec<f64>; 3]| -> Vec<f64> {
                    (0..3).map(|i| product(&x[i], &alpha[i])).reduce(|s, q| sum(&s, &q)).unwrap_or_default()
                };
                let weight = dot(&d);
                let mut out: [Vec<f64>; 4] = [vec![], vec![], vec![], elevate(&weight, p)];
                for i in 0..3 {
                    let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                    let cross = difference(&product(&moment[j], &alpha[l]), &product(&moment[l], &alpha[j]));
                    out[i] = sum(&elevate(&cross, p), &elevate(&product(&d[i], &offset), p));
                }
                out
            };
            pieces.push(BezierRails { a: lo, b: hi, curves: [curve(&bound.low), curve(&bound.high)] });
        }
    }
    // One sign and scale for all weights.
    let mut total = 0.0;
    let mut count = 0.0;
    for p in &pieces {
        total += p.curves[0][3].iter().sum::<f64>();
        count += p.curves[0][3].len() as f64;
    }
    let factor = count / total;
    for p in &mut pieces {
        for c in p.curves.iter_mut().flatten().flatten() {
            *c *= factor;
        }
        if p.curves.iter().any(|c| c[3].iter().any(|w| !(*w > 0.0 && w.is_finite()))) {
            return Err(ConvertError::Turning { t: 0.5 * (p.a + p.b) });
        }
    }
    let knots = &torse.planes.knots;
    let order = |t: f64| multiplicity(knots, t).map_or(bound.order, |m| (2 - m as isize).min(bound.order));
    let mut patch = assemble(&pieces, order, true)?;
    for c in &mut patch.control {
        (0..3).for_each(|d| c[d] += c[3] * origin[d]);
    }
    Ok(patch)
}

/// Bézier piece on [a, b]: homogeneous coefficients of both boundary curves by coordinate.
struct BezierRails {
    a: f64,
    b: f64,
    curves: [[Vec<f64>; 4]; 2],
}

/// How many of the values lie in the piece's interval.
fn held(piece: &BezierRails, args: &[f64]) -> usize {
    args.iter().filter(|t| **t >= piece.a && **t <= piece.b).count()
}

/// Multiplicity of a knot, `None` if `t` is no knot.
fn multiplicity(knots: &Knots, t: f64) -> Option<usize> {
    knots.values().iter().filter(|v| v.total_cmp(&t).is_eq()).count().checked_sub(1).map(|m| m + 1)
}

/// Joins Bézier pieces to one B-spline surface; `continuity(t)` is the order of continuity at a break.
fn assemble(
    pieces: &[BezierRails],
    continuity: impl Fn(f64) -> isize,
    rational: bool,
) -> Result<Surface, ConvertError> {
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return Err(ConvertError::Empty(0)) };
    let p = first.curves[0][3].len() - 1;
    let mut values = vec![first.a; p + 1];
    for w in pieces.windows(2) {
        let order = continuity(w[1].a);
        if order < 0 {
            return Err(ConvertError::Jump { t: w[1].a });
        }
        values.extend(std::iter::repeat_n(w[1].a, p.saturating_sub(order as usize).max(1)));
    }
    values.extend(std::iter::repeat_n(last.b, p + 1));
    let n = values.len() - p - 1;
    let mut control = Vec::with_capacity(2 * n);
    let mut k = 0;
    for i in 0..n {
        // Control point i is the blossom at the knots i+1..i+p, of the piece that holds most of them: there the
        // polynomials of neighbouring pieces agree, and least is extrapolated.
        let args = &values[i + 1..=i + p];
        while k + 1 < pieces.len() && held(&pieces[k + 1], args) > held(&pieces[k], args) {
            k += 1;
        }
        let piece = &pieces[k];
        for curve in &piece.curves {
            let mut c = [0.0; 4];
            for (d, coefficients) in curve.iter().enumerate() {
                c[d] = blossom(coefficients, args, piece.a, piece.b);
            }
            if !rational {
                c[3] = 1.0;
            }
            control.push(c);
        }
    }
    let knots_u = Knots::new(p, values, n)?;
    let knots_v = Knots::new(1, vec![0.0, 0.0, 1.0, 1.0], 2)?;
    for (index, c) in control.iter().enumerate() {
        if !(c[3] > 0.0 && c.iter().all(|x| x.is_finite())) {
            return Err(SplineError::Control { index, reason: "no finite point with a positive weight".into() }.into());
        }
    }
    Ok(Surface { knots_u, knots_v, control, rational })
}

// Bernstein algebra on coefficient slices; degree = length − 1.

/// Blossom at `args` (global parameters) of the polynomial with coefficients `c` on [a, b].
fn blossom(c: &[f64], args: &[f64], a: f64, b: f64) -> f64 {
    let mut d = c.to_vec();
    for (r, &t) in args.iter().enumerate() {
        // Both weights by division, so that the ends of the piece reproduce its coefficients exactly.
        let (v, w) = ((b - t) / (b - a), (t - a) / (b - a));
        for i in 0..d.len() - 1 - r {
            d[i] = v * d[i] + w * d[i + 1];
        }
    }
    d[0]
}

/// Coefficients on the part [x, y] of [0, 1].
fn restrict(c: &[f64], x: f64, y: f64) -> Vec<f64> {
    let p = c.len() - 1;
    (0..=p)
        .map(|k| {
            let mut args = vec![x; p - k];
            args.extend(std::iter::repeat_n(y, k));
            blossom(c, &args, 0.0, 1.0)
        })
        .collect()
}

/// Bernstein coefficients of a family on a part of one of its spans, by component.
fn coefficients<const D: usize>(curve: &Curve<D>, part: (f64, f64)) -> [Vec<f64>; D] {
    let middle = 0.5 * (part.0 + part.1);
    let pieces = bezier_pieces(curve);
    let k = pieces.iter().position(|p| middle <= p.1).unwrap_or(pieces.len() - 1);
    let (a, b, net) = &pieces[k];
    let (x, y) = ((part.0 - a) / (b - a), (part.1 - a) / (b - a));
    std::array::from_fn(|d| {
        let c: Vec<f64> = net.iter().map(|p| p[d]).collect();
        if degree(curve) == 0 {
            vec![c[0]]
        } else {
            restrict(&c, x, y)
        }
    })
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}

fn product(x: &[f64], y: &[f64]) -> Vec<f64> {
    let (p, q) = (x.len() - 1, y.len() - 1);
    let mut out = vec![0.0; p + q + 1];
    for i in 0..=p {
        for j in 0..=q {
            out[i + j] += binomial(p, i) * binomial(q, j) / binomial(p + q, i + j) * x[i] * y[j];
        }
    }
    out
}

fn elevate(c: &[f64], degree: usize) -> Vec<f64> {
    if degree + 1 == c.len() {
        return c.to_vec();
    }
    product(c, &vec![1.0; degree + 2 - c.len()])
}

fn zip(x: &[f64], y: &[f64], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let p = x.len().max(y.len()) - 1;
    elevate(x, p).iter().zip(&elevate(y, p)).map(|(a, b)| f(*a, *b)).collect()
}

fn sum(x: &[f64], y: &[f64]) -> Vec<f64> {
    zip(x, y, |a, b| a + b)
}

fn difference(x: &[f64], y: &[f64]) -> Vec<f64> {
    zip(x, y, |a, b| a - b)
}

/// Derivative with respect to a parameter that covers `length`.
fn derivative(c: &[f64], length: f64) -> Vec<f64> {
    let p = (c.len() - 1) as f64;
    c.windows(2).map(|w| p / length * (w[1] - w[0])).collect()
}

/// Integral from the start with value `start` there.
fn integral(c: &[f64], length: f64, start: f64) -> Vec<f64> {
    let mut out = vec![start];
    let mut s = start;
    for x in c {
        s += length / c.len() as f64 * x;
        out.push(s);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::curve::Curve;

    fn primal() -> Torse {
        let profile = Curve::new(
            3,
            vec![-1., -1., -1., -1., -0.3, 0.4, 1., 1., 1., 1.],
            vec![[0.3, 0.1], [0.1, 0.0], [-0.2, 0.2], [0.1, 0.3], [0.3, 0.1], [0.5, -0.1]],
        )
        .expect("profile");
        let z = Vec3::new(0.2, -0.1, 1.0).normalize();
        let x = Vec3::y().cross(&z).normalize();
        let frame = Frame { origin: Vec3::new(3.0, -2.0, 5.0), x, y: z.cross(&x), z };
        Torse::Primal(PrimalTorse::new(frame, profile, 0.2))
    }

    fn dual() -> Torse {
        // Tangent planes of a helix-like fan: normals turn steadily, offsets vary.
        let control = (0..7)
            .map(|i| {
                let u = 0.3 * i as f64 - 0.9;
                [u.sin(), 0.2 * u * u, u.cos(), 1.0 + 0.1 * u + 0.05 * u * u]
            })
            .collect();
        let planes = Curve::new(3, vec![0., 0., 0., 0., 0.2, 0.5, 0.8, 1., 1., 1., 1.], control).expect("planes");
        Torse::Dual(DualTorse { planes })
    }

    /// A region whose length along the rulings and place vary with t.
    fn extent(torse: &Torse, centre: impl Fn(f64) -> f64, half: f64) -> Extent {
        let (a, b) = torse.domain();
        let mut border = Vec::new();
        for (side, order) in [(-half, false), (half, true)] {
            for i in 0..=40 {
                let i = if order { 40 - i } else { i };
                let t = a + (b - a) * (0.1 + 0.8 * f64::from(i) / 40.0);
                let r = torse.ruling(t);
                border.push((t, r.point + r.direction * (centre(t) + side)));
            }
        }
        Extent { loops: vec![border] }
    }

    fn check(torse: &Torse, extent: &Extent) -> Surface {
        let patch = patch(torse, extent).expect("a patch");
        assert_eq!(patch.knots_v.degree(), 1);
        let ((a, b), _) = patch.domain();
        for i in 0..=60 {
            let t = a + (b - a) * i as f64 / 60.0;
            let ruling = torse.ruling(t);
            for r in [0.0, 0.3, 1.0] {
                let d = patch.point(t, r) - ruling.point;
                let off = d - ruling.direction * d.dot(&ruling.direction);
                assert!(off.norm() < 1e-13, "{} off the ruling at t = {t}", off.norm());
            }
            let w = patch.homogeneous_jet(t, 0.0, 0)[0][3] / patch.homogeneous_jet(t, 1.0, 0)[0][3];
            assert!((w - 1.0).abs() < 1e-12);
        }
        for (t, x) in extent.points() {
            let r = parameters(&patch, *t, x);
            assert!(r > 0.01 && r < 0.99, "r = {r}");
            assert!((patch.point(*t, r) - x).norm() < 1e-12);
        }
        patch
    }

    #[test]
    fn primal_patch_lies_on_the_rulings_with_the_expected_continuity() {
        let torse = primal();
        let p = check(&torse, &extent(&torse, |_| 0.1, 0.4));
        assert_eq!((p.knots_u.degree(), p.rational), (5, false));
        let interior: Vec<usize> = p.knots_u.distinct().iter().map(|k| k.1).collect();
        assert_eq!(interior, vec![6, 3, 3, 6]);
    }

    #[test]
    fn oblique_regions_get_oblique_patches() {
        let torse = primal();
        let p = check(&torse, &extent(&torse, |t| 0.5 * t, 0.1));
        assert_eq!(p.knots_u.degree(), 6);
        let length = |t: f64| (p.point(t, 1.0) - p.point(t, 0.0)).norm();
        assert!((-8..=8).all(|i| length(0.1 * i as f64) < 0.36));
    }

    /// An outline that turns sharply within a span of the torse gives the patch shorter spans, and it stays exact.
    #[test]
    fn outlines_that_turn_sharply_get_shorter_spans() {
        for torse in [primal(), dual()] {
            let (a, b) = torse.domain();
            let bump = |t: f64| 0.8 * (-((t - 0.5 * (a + b)) / (0.05 * (b - a))).powi(2)).exp();
            let p = check(&torse, &extent(&torse, bump, 0.01));
            assert!(p.knots_u.breaks().len() > torse.breaks().len(), "{:?}", p.knots_u.breaks());
        }
    }

    #[test]
    fn dual_patch_lies_on_the_rulings_with_positive_weights() {
        let torse = dual();
        let p = check(&torse, &extent(&torse, |_| 0.0, 0.2));
        assert!(p.rational);
        let d = p.knots_u.degree();
        assert_eq!(
            p.knots_u.distinct().iter().map(|k| k.1).collect::<Vec<_>>(),
            vec![d + 1, d - 1, d - 1, d - 1, d + 1]
        );
        let w: Vec<f64> = p.control.iter().map(|c| c[3]).collect();
        let (lo, hi) = w.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &x| (l.min(x), h.max(x)));
        assert!(lo > 0.0 && hi / lo < 10.0);
    }

    #[test]
    fn a_region_across_the_regression_curve_is_refused() {
        let torse = primal();
        let e = extent(&torse, |_| 0.0, 30.0);
        assert!(matches!(patch(&torse, &e), Err(ConvertError::Regression { .. })));
        assert!(matches!(patch(&torse, &Extent::default()), Err(ConvertError::Empty(0))));
    }
}
