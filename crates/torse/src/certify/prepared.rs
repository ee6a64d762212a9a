//! A surface cut into Bézier patches, and the part of a patch over a small box with a bound of its rounding error.
//!
//! Patches are extracted once with intervals; boxes are then cut out in plain f64. Every step of the de Casteljau
//! scheme on `[0, 1]` is a convex combination, so its error is at most `3.01 u` times the largest coefficient and errors
//! do not grow: `k` steps err by at most `3.01 k u · size` (Higham, *Accuracy and Stability*, 3.1). That bound, and the
//! patch's own, travel with the box as one number per kind of component.

use crate::geom::Vec3;
use crate::num::bernstein::from_spline;
use crate::num::interval::Interval;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// Unit roundoff of f64.
pub(super) const UNIT: f64 = 0.5 * f64::EPSILON;

/// Midpoints of edges are rounded, at most this many times half a unit in the last place over all levels of subdivision:
/// boxes are enlarged by as much, so that cells with rounded corners still cover the triangle.
const CORNER_ULPS: f64 = 64.0;

/// A Bézier patch of the surface, relative to its centre.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// Corners of the parameter box.
    pub u: (f64, f64),
    /// See `u`.
    pub v: (f64, f64),
    /// Centre: coefficients are relative to it.
    pub centre: Vec3,
    /// The whole patch.
    pub net: Net,
}

/// Bernstein coefficients over a box, component by component (x, y, z, and w for rational surfaces), `i (q+1) + j`.
#[derive(Clone, Debug)]
pub(super) struct Net {
    /// Degree in u.
    pub p: usize,
    /// Degree in v.
    pub q: usize,
    /// Components: 3, or 4 homogeneous ones.
    pub data: Vec<f64>,
    /// Bound of the error of any x, y, z coefficient.
    pub error: f64,
    /// Bound of the error of any weight.
    pub weight_error: f64,
    /// Bound of any |x|, |y|, |z| coefficient.
    pub size: f64,
    /// Bound of any weight.
    pub weight_size: f64,
}

impl Net {
    /// Coefficients per component.
    #[inline]
    pub fn count(&self) -> usize {
        (self.p + 1) * (self.q + 1)
    }

    /// Whether weights are stored.
    #[inline]
    pub fn rational(&self) -> bool {
        self.data.len() > 3 * self.count()
    }

    /// One component.
    #[inline]
    pub fn component(&self, d: usize) -> &[f64] {
        let n = self.count();
        &self.data[d * n..(d + 1) * n]
    }

    /// The part over `[β_u γ_u, β_u] × [β_v γ_v, β_v]` (exact real box).
    fn part(&self, cut_u: Cut, cut_v: Cut) -> Self {
        let mut net = self.clone();
        let (p, q, n) = (self.p, self.q, self.count());
        let row = q + 1;
        let mut steps = 0;
        for (cut, degree) in [(cut_u, p), (cut_v, q)] {
            steps += if cut.beta < 1.0 { degree } else { 0 } + if cut.gamma > 0.0 { degree } else { 0 };
        }
        for d in 0..self.data.len() / n {
            let c = &mut net.data[d * n..(d + 1) * n];
            if cut_u.beta < 1.0 {
                let (b, a) = (cut_u.beta, 1.0 - cut_u.beta);
                for r in 1..=p {
                    for i in (r..=p).rev() {
                        for j in 0..row {
                            c[i * row + j] = a * c[(i - 1) * row + j] + b * c[i * row + j];
                        }
                    }
                }
            }
            if cut_u.gamma > 0.0 {
                let (b, a) = (cut_u.gamma, 1.0 - cut_u.gamma);
                for r in 1..=p {
                    for i in 0..=p - r {
                        for j in 0..row {
                            c[i * row + j] = a * c[i * row + j] + b * c[(i + 1) * row + j];
                        }
                    }
                }
            }
            for c in c.chunks_exact_mut(row) {
                if cut_v.beta < 1.0 {
                    let (b, a) = (cut_v.beta, 1.0 - cut_v.beta);
                    for r in 1..=q {
                        for j in (r..=q).rev() {
                            c[j] = a * c[j - 1] + b * c[j];
                        }
                    }
                }
                if cut_v.gamma > 0.0 {
                    let (b, a) = (cut_v.gamma, 1.0 - cut_v.gamma);
                    for r in 1..=q {
                        for j in 0..=q - r {
                            c[j] = a * c[j] + b * c[j + 1];
                        }
                    }
                }
            }
        }
        let rounding = 3.01 * UNIT * steps as f64;
        net.error += rounding * net.size;
        net.weight_error += rounding * net.weight_size;
        net
    }
}

/// The interval `[βγ, β]` of `[0, 1]` (a real product, not rounded).
#[derive(Clone, Copy, Debug)]
struct Cut {
    beta: f64,
    gamma: f64,
}

impl Cut {
    /// A cut that contains `a` with a margin of `pad`.
    fn around(a: Interval, pad: f64) -> Self {
        let beta = (a.hi + pad).min(1.0);
        // Two ulps pay for the rounded quotient, so that βγ stays below a.lo − pad.
        let gamma = ((a.lo - pad) / beta * (1.0 - 4.0 * UNIT)).clamp(0.0, 1.0 - 4.0 * UNIT);
        Self { beta, gamma }
    }

    /// Coordinate in the cut of the coordinate `a`, widened by `pad`.
    fn local(self, a: Interval, pad: f64) -> Interval {
        let low = Interval::point(self.beta) * Interval::point(self.gamma);
        let width = Interval::point(self.beta) * (Interval::ONE - Interval::point(self.gamma));
        (a.widen(pad) - low) / width
    }
}

/// A triangle of the parameter plane with the part of the surface over its bounding box.
#[derive(Clone, Debug)]
pub(super) struct BoxNet {
    /// Coefficients over the (slightly enlarged) bounding box.
    pub net: Net,
    /// Corners in box coordinates.
    pub corners: [[Interval; 2]; 3],
}

impl BoxNet {
    /// A box around the surface over the triangle's bounding box; `centre` is that of the patch.
    pub fn around(&self, centre: &Vec3) -> [Interval; 3] {
        let net = &self.net;
        let weight = |i: usize| match net.rational() {
            true => Interval::point(net.component(3)[i]).widen(net.weight_error),
            false => Interval::ONE,
        };
        [0, 1, 2].map(|d: usize| {
            let point = |i: usize| Interval::point(net.component(d)[i]).widen(net.error) / weight(i);
            let first = point(0);
            (1..net.count()).map(point).fold(first, Interval::hull) + Interval::point(centre[d])
        })
    }
}

/// A surface ready for [`distance`](super::distance::distance).
#[derive(Clone, Debug)]
pub struct Prepared<'a> {
    /// The surface.
    pub surface: &'a Surface,
    patches: Vec<Patch>,
    breaks_u: Vec<f64>,
    breaks_v: Vec<f64>,
}

impl<'a> Prepared<'a> {
    /// Extracts the Bézier patches. *Cost*: some 10 µs per patch.
    pub fn new(surface: &'a Surface) -> Self {
        let rational = surface.control.iter().any(|c| c[3].total_cmp(&1.0).is_ne());
        let (breaks_u, breaks_v) = (surface.knots_u.breaks(), surface.knots_v.breaks());
        let (cuts_u, cuts_v) = (extractions(&surface.knots_u), extractions(&surface.knots_v));
        let mut patches = Vec::with_capacity(cuts_u.len() * cuts_v.len());
        for (a, eu) in cuts_u.iter().enumerate() {
            for (b, ev) in cuts_v.iter().enumerate() {
                patches.push(Patch::extract(
                    surface,
                    rational,
                    eu,
                    ev,
                    (breaks_u[a], breaks_u[a + 1]),
                    (breaks_v[b], breaks_v[b + 1]),
                ));
            }
        }
        Self { surface, patches, breaks_u, breaks_v }
    }

    /// All patches.
    pub(super) fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// The patch over which the triangle lies; `None` when it crosses a knot line or leaves the domain.
    pub(super) fn patch_of(&self, triangle: &[[f64; 2]; 3]) -> Option<&Patch> {
        let middle = |d: usize| (triangle[0][d] + triangle[1][d] + triangle[2][d]) / 3.0;
        let find = |breaks: &[f64], t: f64| breaks[1..breaks.len() - 1].partition_point(|&b| b <= t);
        let (mut i, mut j) = (find(&self.breaks_u, middle(0)), find(&self.breaks_v, middle(1)));
        // The rounded centroid of a sliver on a knot line may fall on the other side of the line.
        let inside =
            |breaks: &[f64], k: usize, d: usize| triangle.iter().all(|c| breaks[k] <= c[d] && c[d] <= breaks[k + 1]);
        for (breaks, k, d) in [(&self.breaks_u, &mut i, 0), (&self.breaks_v, &mut j, 1)] {
            if !inside(breaks, *k, d) {
                if *k > 0 && inside(breaks, *k - 1, d) {
                    *k -= 1;
                } else if *k + 2 < breaks.len() && inside(breaks, *k + 1, d) {
                    *k += 1;
                } else {
                    return None;
                }
            }
        }
        self.patches.get(i * (self.breaks_v.len() - 1) + j)
    }
}

impl Patch {
    fn extract(
        surface: &Surface,
        rational: bool,
        eu: &Extraction,
        ev: &Extraction,
        u: (f64, f64),
        v: (f64, f64),
    ) -> Self {
        let (p, q, row) = (surface.knots_u.degree(), surface.knots_v.degree(), surface.row());
        let control = |i: usize, j: usize| &surface.control[(eu.first + i) * row + ev.first + j];
        let mut centre = Vec3::zeros();
        for i in 0..=p {
            for j in 0..=q {
                let c = control(i, j);
                centre += Vec3::new(c[0], c[1], c[2]) / (c[3] * ((p + 1) * (q + 1)) as f64);
            }
        }
        let n = (p + 1) * (q + 1);
        let comps = if rational { 4 } else { 3 };
        let mut data = vec![0.0; comps * n];
        let (mut error, mut weight_error, mut size, mut weight_size) = (0.0f64, 0.0f64, 0.0f64, 1.0f64);
        let mut net = vec![Interval::ZERO; n];
        let mut half = vec![Interval::ZERO; n];
        for d in 0..comps {
            for i in 0..=p {
                for j in 0..=q {
                    let c = control(i, j);
                    net[i * (q + 1) + j] = if d == 3 {
                        Interval::point(c[3])
                    } else if rational {
                        Interval::less_product(c[d], c[3], centre[d])
                    } else {
                        Interval::point(c[d]) - Interval::point(centre[d])
                    };
                }
            }
            for k in 0..=p {
                for j in 0..=q {
                    half[k * (q + 1) + j] =
                        (0..=p).fold(Interval::ZERO, |s, i| s + eu.rows[k][i] * net[i * (q + 1) + j]);
                }
            }
            for k in 0..=p {
                for l in 0..=q {
                    let c = (0..=q).fold(Interval::ZERO, |s, j| s + ev.rows[l][j] * half[k * (q + 1) + j]);
                    data[d * n + k * (q + 1) + l] = c.mid();
                    if d < 3 {
                        error = error.max(c.rad());
                        size = size.max(c.mag());
                    } else {
                        weight_error = weight_error.max(c.rad());
                        weight_size = weight_size.max(c.mag());
                    }
                }
            }
        }
        Self { u, v, centre, net: Net { p, q, data, error, weight_error, size, weight_size } }
    }

    /// The surface over the bounding box of a triangle inside the patch.
    pub(super) fn over(&self, triangle: &[[f64; 2]; 3]) -> BoxNet {
        let mut cuts = [Cut { beta: 1.0, gamma: 0.0 }; 2];
        let mut corners = [[Interval::ZERO; 2]; 3];
        for d in 0..2 {
            let (a, b) = if d == 0 { self.u } else { self.v };
            let width = Interval::point(b) - Interval::point(a);
            let locals = [0, 1, 2].map(|k: usize| (Interval::point(triangle[k][d]) - Interval::point(a)) / width);
            let pad = CORNER_ULPS * UNIT * 1.01 * a.abs().max(b.abs()) / width.lo;
            let all = locals[0].hull(locals[1]).hull(locals[2]);
            cuts[d] = Cut::around(all, pad);
            for k in 0..3 {
                corners[k][d] = cuts[d].local(locals[k], pad);
            }
        }
        BoxNet { net: self.net.part(cuts[0], cuts[1]), corners }
    }

    /// Point at `(u, v)` relative to the centre, in f64.
    pub(super) fn quick_point(&self, u: f64, v: f64) -> [f64; 3] {
        let net = &self.net;
        let wu = bernstein_weights(net.p, (u - self.u.0) / (self.u.1 - self.u.0));
        let wv = bernstein_weights(net.q, (v - self.v.0) / (self.v.1 - self.v.0));
        let mut out = [0.0; 4];
        let comps = if net.rational() { 4 } else { 3 };
        for (d, o) in out.iter_mut().enumerate().take(comps) {
            *o = contract(net.component(d), &wu[..=net.p], &wv[..=net.q]);
        }
        if comps == 4 {
            [out[0] / out[3], out[1] / out[3], out[2] / out[3]]
        } else {
            [out[0], out[1], out[2]]
        }
    }
}

/// Bernstein polynomials of degree `p` at `x ∈ [0, 1]`; relative error at most `(4p + 4) u`.
#[inline]
pub(super) fn bernstein_weights(p: usize, x: f64) -> [f64; crate::spline::MAX_DEGREE + 1] {
    let mut w = [0.0; crate::spline::MAX_DEGREE + 1];
    w[0] = 1.0;
    let y = 1.0 - x;
    for d in 1..=p {
        let mut carry = 0.0;
        for c in w.iter_mut().take(d) {
            let k = *c;
            *c = carry + y * k;
            carry = x * k;
        }
        w[d] = carry;
    }
    w
}

/// `Σ a_i c_ij b_j`.
#[inline]
pub(super) fn contract(c: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (row, &x) in c.chunks_exact(b.len()).zip(a) {
        let mut inner = 0.0;
        for (&y, &z) in row.iter().zip(b) {
            inner += y * z;
        }
        sum += x * inner;
    }
    sum
}

/// Bernstein coefficients of a span as combinations of the B-spline's.
struct Extraction {
    /// First control point concerned.
    first: usize,
    /// `rows[k][i]`: weight of control point `first + i` in Bernstein coefficient `k`.
    rows: Vec<Vec<Interval>>,
}

fn extractions(knots: &Knots) -> Vec<Extraction> {
    let (p, v) = (knots.degree(), knots.values());
    knots
        .breaks()
        .windows(2)
        .map(|w| {
            let span = knots.span(0.5 * (w[0] + w[1]));
            let local = &v[span + 1 - p..=span + p];
            let columns: Vec<Vec<Interval>> = (0..=p)
                .map(|i| {
                    let mut net = vec![Interval::ZERO; p + 1];
                    net[i] = Interval::ONE;
                    from_spline(&net, local)
                })
                .collect();
            let rows = (0..=p).map(|k| columns.iter().map(|c| c[k]).collect()).collect();
            Extraction { first: span - p, rows }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wavy(rational: bool) -> Surface {
        let k = Knots::clamped(3, &[0.0, 0.35, 1.0]).expect("knots");
        let mut points = Vec::new();
        let mut weights = Vec::new();
        for i in 0..5 {
            for j in 0..5 {
                points.push(Vec3::new(i as f64, j as f64, (i as f64 * 1.3 + j as f64).sin()));
                weights.push(1.0 + 0.1 * ((i * 3 + j) % 4) as f64);
            }
        }
        Surface::new(k.clone(), k, &points, rational.then_some(weights.as_slice())).expect("surface")
    }

    #[test]
    fn boxes_reproduce_the_surface() {
        for rational in [false, true] {
            let s = wavy(rational);
            let prepared = Prepared::new(&s);
            let triangle = [[0.4, 0.36], [0.5, 0.4], [0.45, 0.6]];
            let patch = prepared.patch_of(&triangle).expect("inside one patch");
            let b = patch.over(&triangle);
            assert!(b.net.error < 1e-13);
            for (k, c) in triangle.iter().enumerate() {
                let y = [b.corners[k][0].mid(), b.corners[k][1].mid()];
                let (wu, wv) = (bernstein_weights(3, y[0]), bernstein_weights(3, y[1]));
                let h: Vec<f64> =
                    (0..b.net.data.len() / 16).map(|d| contract(b.net.component(d), &wu[..4], &wv[..4])).collect();
                let w = if rational { h[3] } else { 1.0 };
                let x = Vec3::new(h[0], h[1], h[2]) / w + patch.centre;
                assert!((x - s.point(c[0], c[1])).norm() < 1e-13);
                let quick = patch.quick_point(c[0], c[1]);
                assert!((Vec3::from(quick) + patch.centre - x).norm() < 1e-13);
            }
        }
    }

    #[test]
    fn triangles_across_knot_lines_are_noticed() {
        let s = wavy(false);
        let prepared = Prepared::new(&s);
        assert!(prepared.patch_of(&[[0.3, 0.4], [0.4, 0.4], [0.35, 0.5]]).is_none());
        assert!(prepared.patch_of(&[[0.35, 0.35], [0.9, 0.4], [0.4, 1.0]]).is_some());
        assert!(prepared.patch_of(&[[0.35, 0.9], [0.9, 0.9], [0.4, 1.1]]).is_none());
    }
}
