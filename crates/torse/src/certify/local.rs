//! The surface over a small box: a reference point, derivatives there, and hulls of linear forms over the box.
//!
//! Values of Bernstein polynomials stay in the hull of their coefficients. Sums are taken in f64 with an a-priori bound
//! of their rounding, added once per hull (Higham, *Accuracy and Stability of Numerical Algorithms*, 3.1; \[MKC09\]).

use super::prepared::{bernstein_weights, contract, Net, Patch, Prepared, UNIT};
use super::vector::{mid, rad, V3};
use crate::num::interval::Interval;
use crate::spline::surface::Surface;

/// Hulls over the box of a linear form `ω` of `X − z` and the surface's derivatives.
pub(super) struct Forms {
    pub x: Interval,
    pub s1: Interval,
    pub s2: Interval,
    pub s11: Interval,
    pub s12: Interval,
    pub s22: Interval,
}

/// The surface over the box, about the reference point `z` near the image of the centroid.
pub(super) struct Local<'a> {
    net: &'a Net,
    pub z: V3<f64>,
    /// Bound of |X(c) − z| per component.
    pub centre_error: f64,
    /// First derivatives at the centroid.
    pub d: [V3<Interval>; 2],
    /// Bounds of |X − z|, |S_1|, |S_2|, |S_11|, |S_12|, |S_22| over the box.
    pub norms: [f64; 6],
    /// Bound of |b − z| per component over the coefficients (of homogeneous ones for rational surfaces).
    reach: f64,
    /// Bound of the error of a component of (b − z).
    error: f64,
    /// Hulls of the weight and its derivatives in the order of [`Forms`].
    weight: Option<[Interval; 6]>,
}

impl<'a> Local<'a> {
    #[expect(clippy::too_many_lines, reason = "one chain of enclosures, each of which needs those before it")]
    pub fn new(net: &'a Net, c: [f64; 2]) -> Self {
        let (p, q) = (net.p, net.q);
        let row = q + 1;
        let relative = relative_error(net);
        let comps = if net.rational() { 4 } else { 3 };
        let (wu, wv) = (bernstein_weights(p, c[0]), bernstein_weights(q, c[1]));
        let (du, dv) = (bernstein_weights(p - 1, c[0]), bernstein_weights(q - 1, c[1]));
        let Place { z, weight: w_c, error: centre_error } = Place::of(net, c);
        let z_size = z[0].abs().max(z[1].abs()).max(z[2].abs());
        // Error of a component of b − z (of A − w z for rational surfaces).
        let mut error = net.error;
        if comps == 4 {
            error += net.weight_error * z_size + 3.0 * UNIT * (net.size + net.weight_size * z_size);
        }
        let shifted: [Vec<f64>; 3] = std::array::from_fn(|d| {
            let c = net.component(d);
            if comps == 4 {
                c.iter().zip(net.component(3)).map(|(a, w)| a - w * z[d]).collect()
            } else {
                c.iter().map(|a| a - z[d]).collect()
            }
        });
        let reach = shifted.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs())) * (1.0 + 4.0 * UNIT) + error;
        let error = error + 2.0 * UNIT * reach;

        // Sizes of the derivatives: largest difference of control points.
        let (pf, qf) = (p as f64, q as f64);
        let largest = |rows: usize, cols: usize, f: &dyn Fn(&[f64], usize) -> f64| {
            let mut best = 0.0f64;
            for i in 0..rows {
                for j in 0..cols {
                    let k = i * row + j;
                    let v = [f(&shifted[0], k), f(&shifted[1], k), f(&shifted[2], k)];
                    best = best.max(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                }
            }
            best.sqrt() * (1.0 + 8.0 * UNIT)
        };
        let less = |a: usize, k: usize| (a + 1).saturating_sub(k);
        let e = 2.0 * error;
        let mut norms = [
            largest(p + 1, q + 1, &|s, k| s[k]) + e,
            pf * (largest(p, q + 1, &|s, k| s[k + row] - s[k]) + 2.0 * e),
            qf * (largest(p + 1, q, &|s, k| s[k + 1] - s[k]) + 2.0 * e),
            pf * (pf - 1.0) * (largest(less(p, 2), q + 1, &|s, k| s[k + 2 * row] - 2.0 * s[k + row] + s[k]) + 4.0 * e),
            pf * qf * (largest(p, q, &|s, k| s[k + row + 1] - s[k + row] - s[k + 1] + s[k]) + 4.0 * e),
            qf * (qf - 1.0) * (largest(p + 1, less(q, 2), &|s, k| s[k + 2] - 2.0 * s[k + 1] + s[k]) + 4.0 * e),
        ];
        let slope_error = |degree: f64| degree * (2.0 * error + 2.0 * relative * reach);
        let mut d = [[Interval::ZERO; 3]; 2];
        for k in 0..3 {
            let s = &shifted[k];
            let mut a = 0.0;
            let mut b = 0.0;
            for i in 0..=p {
                let r = &s[i * row..(i + 1) * row];
                let along: f64 = r.windows(2).zip(&dv[..q]).map(|(w, x)| (w[1] - w[0]) * x).sum();
                b += wu[i] * along;
                if i < p {
                    let next = &s[(i + 1) * row..(i + 2) * row];
                    let across: f64 = next.iter().zip(r).zip(&wv[..row]).map(|((y, x), w)| (y - x) * w).sum();
                    a += du[i] * across;
                }
            }
            d[0][k] = Interval::point(pf * a).widen(slope_error(pf));
            d[1][k] = Interval::point(qf * b).widen(slope_error(qf));
        }
        let mut weight = None;
        if comps == 4 {
            let hulls = hulls(net.component(3), p, q, net.weight_error);
            let w = Interval { lo: hulls[0].lo, hi: hulls[0].hi };
            let low = w.lo;
            let size = hulls.map(Interval::mag);
            let up = 1.0 + 16.0 * UNIT;
            // Affine bounds from the homogeneous ones, in the order of the quotient rules.
            let x = norms[0] / low;
            let s1 = (norms[1] + size[1] * x) / low;
            let s2 = (norms[2] + size[2] * x) / low;
            let s11 = (norms[3] + 2.0 * size[1] * s1 + size[3] * x) / low;
            let s12 = (norms[4] + size[1] * s2 + size[2] * s1 + size[4] * x) / low;
            let s22 = (norms[5] + 2.0 * size[2] * s2 + size[5] * x) / low;
            norms = if low > 0.0 { [x, s1, s2, s11, s12, s22].map(|v| v * up) } else { [f64::INFINITY; 6] };
            // Derivatives at the centroid: (A_1 − w_1 (X − z))/w with X − z within the centre's error.
            let off = Interval::symmetric(centre_error);
            for (i, row) in d.iter_mut().enumerate() {
                for c in row.iter_mut() {
                    *c = (*c - hulls[i + 1] * off) / w_c;
                }
            }
            weight = Some(hulls);
        }
        Self { net, z, centre_error, d, norms, reach, error, weight }
    }

    /// Values of the form `ω` at the shifted coefficients and a bound of their error.
    #[inline]
    fn scalars(&self, form: &V3<Interval>, out: &mut Vec<f64>) -> f64 {
        let w = mid(form);
        let z = self.z;
        out.clear();
        let (x, y, zz) = (self.net.component(0), self.net.component(1), self.net.component(2));
        if self.weight.is_some() {
            for (k, &q) in self.net.component(3).iter().enumerate() {
                out.push(w[0] * (x[k] - q * z[0]) + w[1] * (y[k] - q * z[1]) + w[2] * (zz[k] - q * z[2]));
            }
        } else {
            for k in 0..x.len() {
                out.push(w[0] * (x[k] - z[0]) + w[1] * (y[k] - z[1]) + w[2] * (zz[k] - z[2]));
            }
        }
        let size = w[0].abs() + w[1].abs() + w[2].abs();
        (size * (self.error + 8.0 * UNIT * self.reach) + rad(form) * (self.reach + self.error)) * (1.0 + 8.0 * UNIT)
    }

    /// Hull of `ω·(X − z)` over the box, from affine control points.
    pub fn value_form(&self, form: &V3<Interval>) -> Interval {
        let mut s = Vec::with_capacity(self.net.count());
        let error = self.scalars(form, &mut s);
        self.affine_hull(&s, error)
    }

    fn affine_hull(&self, s: &[f64], error: f64) -> Interval {
        match &self.weight {
            None => range(s.iter().copied()).widen(error),
            Some(_) => s
                .iter()
                .zip(self.net.component(3))
                .map(|(&a, &w)| Interval::point(a).widen(error) / Interval::point(w).widen(self.net.weight_error))
                .reduce(Interval::hull)
                .unwrap_or(Interval::EVERYTHING),
        }
    }

    /// Hulls of the form over the box, of the surface and its derivatives.
    pub fn forms(&self, form: &V3<Interval>) -> Forms {
        let mut s = Vec::with_capacity(self.net.count());
        let error = self.scalars(form, &mut s);
        let x = self.affine_hull(&s, error);
        let [_, h1, h2, h11, h12, h22] = hulls(&s, self.net.p, self.net.q, error);
        match &self.weight {
            None => Forms { x, s1: h1, s2: h2, s11: h11, s12: h12, s22: h22 },
            Some([w, w1, w2, w11, w12, w22]) => {
                let s1 = (h1 - *w1 * x) / *w;
                let s2 = (h2 - *w2 * x) / *w;
                Forms {
                    x,
                    s1,
                    s2,
                    s11: (h11 - *w1 * s1 * 2.0 - *w11 * x) / *w,
                    s12: (h12 - *w1 * s2 - *w2 * s1 - *w12 * x) / *w,
                    s22: (h22 - *w2 * s2 * 2.0 - *w22 * x) / *w,
                }
            }
        }
    }
}

/// Bound of the distance in space, mm, between points of a surface whose parameters differ by at most `off`.
pub(super) fn way(prepared: &Prepared, off: [f64; 2]) -> f64 {
    let of = |p: &Patch| {
        let [_, s1, s2, ..] = Local::new(&p.net, [0.5, 0.5]).norms;
        let share = |(a, b): (f64, f64), off: f64| Interval::point(off) / (Interval::point(b) - Interval::point(a));
        (share(p.u, off[0]) * Interval::point(s1) + share(p.v, off[1]) * Interval::point(s2)).hi
    };
    // A short way may lead over knot lines: each patch has no more than its share.
    prepared.patches().iter().map(of).fold(0.0, f64::max)
}

/// Bound of the distance in space, mm, between points of a surface whose parameters differ by at most `off`.
pub fn parameters_moved(surface: &Surface, off: [f64; 2]) -> f64 {
    way(&Prepared::new(surface), off)
}

/// Relative error of a contraction with Bernstein weights, in relation to the largest coefficient.
#[inline]
fn relative_error(net: &Net) -> f64 {
    (8 * (net.p + net.q + 3)) as f64 * UNIT
}

/// A point of the surface.
pub(super) struct Place {
    /// The point, rounded, relative to the centre of the patch.
    pub z: V3<f64>,
    /// Weight there.
    weight: Interval,
    /// Bound of the error of a component of `z`.
    pub error: f64,
}

impl Place {
    /// The point with box coordinates `c ∈ [0, 1]²`.
    pub fn of(net: &Net, c: [f64; 2]) -> Self {
        let (wu, wv) = (bernstein_weights(net.p, c[0]), bernstein_weights(net.q, c[1]));
        let relative = relative_error(net);
        let value = |d: usize| contract(net.component(d), &wu[..=net.p], &wv[..=net.q]);
        let z = [value(0), value(1), value(2)];
        let error = net.error + relative * net.size;
        if !net.rational() {
            return Self { z, weight: Interval::ONE, error };
        }
        let w = value(3);
        let z = z.map(|x| x / w);
        let z_size = z[0].abs().max(z[1].abs()).max(z[2].abs());
        let weight_error = net.weight_error + relative * net.weight_size;
        let weight = Interval::point(w).widen(weight_error);
        let error = error + weight_error * z_size + 3.0 * UNIT * (net.size + net.weight_size * z_size);
        Self { z, weight, error: (Interval::point(error) / weight).hi }
    }
}

/// Hull of numbers.
#[inline]
fn range(values: impl Iterator<Item = f64>) -> Interval {
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for v in values {
        lo = if v < lo { v } else { lo };
        hi = if v > hi { v } else { hi };
    }
    Interval { lo, hi }
}

/// Hulls of a scalar tensor-product polynomial and its derivatives, in the order value, 1, 2, 11, 12, 22; `error` bounds
/// the error of each coefficient.
fn hulls(s: &[f64], p: usize, q: usize, error: f64) -> [Interval; 6] {
    let row = q + 1;
    let (pf, qf) = (p as f64, q as f64);
    let value = range(s.iter().copied());
    let rounding = error + 2.0 * UNIT * value.mag();
    let first = range((0..p * row).map(|k| s[k + row] - s[k]));
    let second = range(s.chunks_exact(row).flat_map(|r| r.windows(2).map(|w| w[1] - w[0])));
    let twist = range(
        s.chunks_exact(row)
            .zip(s.chunks_exact(row).skip(1))
            .flat_map(|(a, b)| (0..q).map(move |j| (b[j + 1] - b[j]) - (a[j + 1] - a[j]))),
    );
    let zero = Interval::ZERO;
    let bend_u = if p < 2 {
        zero
    } else {
        range((0..(p - 1) * row).map(|k| s[k + 2 * row] - 2.0 * s[k + row] + s[k])).widen(5.0 * rounding)
            * (pf * (pf - 1.0))
    };
    let bend_v = if q < 2 {
        zero
    } else {
        range(s.chunks_exact(row).flat_map(|r| r.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]))).widen(5.0 * rounding)
            * (qf * (qf - 1.0))
    };
    [
        value.widen(error),
        first.widen(3.0 * rounding) * pf,
        second.widen(3.0 * rounding) * qf,
        bend_u,
        twist.widen(5.0 * rounding) * (pf * qf),
        bend_v,
    ]
}
