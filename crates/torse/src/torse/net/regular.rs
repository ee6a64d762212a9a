//! Regularity of a net, decided: where the regression curve lies against the strip, and whether the curve ever runs
//! along its ruling.
//!
//! *Method.* The first is a comparison of numbers, because the regression curve lies at a place linear in `u`
//! (corollary 3 of \[FJ07\] for all segments at once). The second asks for zeros of the vector polynomial `c' × e`,
//! by subdivision in Bernstein form with interval coefficients \[FR88\].

use super::control_net::{affine, plus, Net};
use crate::geom::Vec3;
use crate::num::bernstein::{derivative, difference, elevated, from_spline, halves, product, sum, value};
use crate::num::binomial::binomial;
use crate::num::golden_section;
use crate::num::interval::Interval;
use crate::spline::blossom::of_piece;

/// Sine of the angle between curve and ruling below which the ruling counts as tangent: the square of it is the
/// rounding of one.
const TANGENT_SINE: f64 = 1e-8;
/// Times a segment is halved before a ruling is called tangent: the part left is below the spacing of numbers.
const DEEPEST: usize = 50;

/// Golden sections about the least distance of a table.
const SECTIONS: usize = 40;

/// Answer of [`Net::regularity`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regularity {
    /// The strip is a regular surface.
    Regular,
    /// The regression curve crosses the strip.
    Regression {
        /// A ruling on which it does.
        u: f64,
        /// Where on the ruling.
        v: f64,
    },
    /// The ruling is tangent to the curve: the surface is singular along it.
    TangentRuling {
        /// The ruling.
        u: f64,
    },
    /// A weight of the opposite boundary is not positive, so that boundary may run through infinity.
    Weight {
        /// Index of the control point.
        index: usize,
        /// Its weight.
        weight: f64,
    },
}

impl Regularity {
    /// Whether the strip is regular.
    pub fn holds(&self) -> bool {
        *self == Self::Regular
    }
}

impl Net {
    /// Whether the strip between the curve and the opposite boundary is regular, else a witness.
    ///
    /// *Guarantee*: `Regular` is proven for the control points as they are, up to the rounding of one comparison of
    /// M* and Λ* with the domain. *Cost*: linear in the number of pieces.
    pub fn regularity(&self) -> Regularity {
        if let Some((index, weight)) = weight_fault(self.opposite_points().iter()) {
            return Regularity::Weight { index, weight };
        }
        if let Some((u, v)) = self.shape().regression_within((0.0, 1.0)) {
            return Regularity::Regression { u, v };
        }
        match self.tangent_ruling() {
            Some(u) => Regularity::TangentRuling { u },
            None => Regularity::Regular,
        }
    }

    /// A ruling that is tangent to the curve, if there is one. That there is none is proven.
    pub fn tangent_ruling(&self) -> Option<f64> {
        let knots = &self.curve().knots;
        let (p, all) = (knots.degree(), knots.values());
        let mut scratch = Triage::new(p);
        knots.breaks().windows(2).find_map(|w| {
            if scratch.shows_none(self, w[0], w[1]) {
                return None;
            }
            let span = knots.span(0.5 * (w[0] + w[1]));
            let around = &all[span + 1 - p..=span + p];
            let part = |control: &[[f64; 4]]| -> [Vec<Interval>; 4] {
                std::array::from_fn(|d| {
                    let net: Vec<Interval> = control[span - p..=span].iter().map(|c| Interval::point(c[d])).collect();
                    from_spline(&net, around)
                })
            };
            NormalForm::new(part(&self.curve().control), part(self.rulings())).zero().map(|x| w[0] + x * (w[1] - w[0]))
        })
    }

    /// Smallest distance along a ruling from the curve to the regression curve, mm, infinite for cylinders: how far
    /// the surface could be extended behind or beyond the curve.
    ///
    /// *Not guaranteed*: sampled with 4 (n + 1) rulings per piece and refined around the smallest.
    pub fn clearance_estimate(&self) -> f64 {
        let distance =
            |u: f64| self.regression_point(u).map_or(f64::INFINITY, |r| (r - affine(&self.curve().point(u))).norm());
        let breaks = self.curve().knots.breaks();
        let per_piece = 4 * (self.degree() + 1);
        let mut best = (f64::INFINITY, breaks[0], breaks[0]);
        for w in breaks.windows(2) {
            let step = (w[1] - w[0]) / per_piece as f64;
            for k in 0..=per_piece {
                let u = w[0] + step * k as f64;
                let x = distance(u);
                if x < best.0 {
                    best = (x, (u - step).max(w[0]), (u + step).min(w[1]));
                }
            }
        }
        if best.0.is_finite() {
            best.0.min(golden_section::least(distance, [best.1, best.2], SECTIONS).1)
        } else {
            best.0
        }
    }

    /// Unit normal of the tangent plane along ruling `u`; `None` on a ruling tangent to the curve.
    pub fn normal(&self, u: f64) -> Option<Vec3> {
        let [c, c1, e, _] = self.jet(u);
        let n = normal(&c, &c1, &e);
        let size = n.norm();
        (size > 0.0 && size.is_finite()).then(|| n / size)
    }
}

/// Normal part of the plane through the homogeneous points `c`, `c'`, `e`.
pub(super) fn normal(c: &[f64; 4], c1: &[f64; 4], e: &[f64; 4]) -> Vec3 {
    let v = |x: &[f64; 4]| Vec3::new(x[0], x[1], x[2]);
    v(c1).cross(&v(e)) * c[3] + v(e).cross(&v(c)) * c1[3] + v(c).cross(&v(c1)) * e[3]
}

/// The first weight that is not positive.
pub(super) fn weight_fault<'a>(points: impl Iterator<Item = &'a [f64; 4]>) -> Option<(usize, f64)> {
    points.enumerate().find(|(_, p)| p[3].is_nan() || p[3] <= 0.0).map(|(i, p)| (i, p[3]))
}

/// A quick proof for most pieces: all Bernstein coefficients of the normal lie on one side of a plane, farther than
/// rounding can have moved them.
struct Triage {
    binomials: Vec<f64>,
    slope_binomials: Vec<f64>,
    c: Vec<[f64; 4]>,
    e: Vec<[f64; 4]>,
    coefficients: Vec<Vec3>,
}

/// Rounding of a coefficient of the normal per degree, as a share of the products it is made of: some 200 operations.
const ROUNDING: f64 = 1e-13;

impl Triage {
    fn new(p: usize) -> Self {
        let row = |n: usize| (0..=n).map(|k| binomial(n, k)).collect::<Vec<f64>>();
        Self { binomials: row(p), slope_binomials: row(p - 1), c: vec![], e: vec![], coefficients: vec![] }
    }

    fn shows_none(&mut self, net: &Net, from: f64, to: f64) -> bool {
        let knots = &net.curve().knots;
        let (p, span) = (knots.degree(), knots.span(0.5 * (from + to)));
        // 1. Bézier form: convex combinations of the control points.
        let mut args = vec![from; p];
        self.c.clear();
        self.e.clear();
        let mut work = Vec::with_capacity(p + 1);
        for k in 0..=p {
            if k > 0 {
                args[p - k] = to;
            }
            for (source, target) in [(&net.curve().control, &mut self.c), (&net.rulings, &mut self.e)] {
                work.clear();
                work.extend_from_slice(&source[span - p..=span]);
                target.push(of_piece(knots, span, &mut work, &args));
            }
        }
        // 2. Sizes before and after moving the origin to the piece.
        let largest = |x: &[[f64; 4]], d: std::ops::Range<usize>| {
            x.iter().flat_map(|p| &p[d.clone()]).fold(0.0f64, |m, v| m.max(v.abs()))
        };
        let (w, ew) = (largest(&self.c, 3..4), largest(&self.e, 3..4));
        let origin = affine(&self.c[0]);
        let far = origin.amax();
        let (cs, es) = (largest(&self.c, 0..3) + w * far, largest(&self.e, 0..3) + ew * far);
        let margin = ROUNDING * p as f64 * (w * cs * es + ew * cs * cs);
        for x in self.c.iter_mut().chain(&mut self.e) {
            for d in 0..3 {
                x[d] -= x[3] * origin[d];
            }
        }
        // 3. Coefficients, up to positive factors: degree 2p − 1 for constant weights, 3p − 1 otherwise.
        let plain = ew == 0.0 && self.c.iter().all(|x| x[3] == self.c[0][3]);
        let degree = if plain { 2 * p - 1 } else { 3 * p - 1 };
        self.coefficients.clear();
        self.coefficients.resize(degree + 1, Vec3::zeros());
        let v = |x: &[f64; 4]| Vec3::new(x[0], x[1], x[2]);
        for i in 0..p {
            let slope: [f64; 4] = std::array::from_fn(|d| self.c[i + 1][d] - self.c[i][d]);
            for j in 0..=p {
                let share = self.slope_binomials[i] * self.binomials[j];
                if plain {
                    self.coefficients[i + j] += v(&slope).cross(&v(&self.e[j])) * (share * w);
                    continue;
                }
                for k in 0..=p {
                    let part = normal(&self.c[k], &slope, &self.e[j]);
                    self.coefficients[i + j + k] += part * (share * self.binomials[k]);
                }
            }
        }
        for (k, x) in self.coefficients.iter_mut().enumerate() {
            *x /= binomial(degree, k);
        }
        let mean: Vec3 = self.coefficients.iter().sum();
        let size = mean.norm();
        size.is_finite() && self.coefficients.iter().all(|x| x.dot(&mean) > 2.0 * margin * size)
    }
}

/// Bernstein form of one piece: the normal `c' × e` in homogeneous form, and the curve and ruling for its scale.
struct NormalForm {
    normal: [Vec<Interval>; 3],
    curve: [Vec<f64>; 4],
    ruling: [Vec<f64>; 4],
}

impl NormalForm {
    fn new(curve: [Vec<Interval>; 4], ruling: [Vec<Interval>; 4]) -> Self {
        let slope: [Vec<Interval>; 4] = std::array::from_fn(|d| derivative(&curve[d]));
        let cross = |x: &[Vec<Interval>; 4], y: &[Vec<Interval>; 4]| -> [Vec<Interval>; 3] {
            std::array::from_fn(|d| {
                let (i, j) = ((d + 1) % 3, (d + 2) % 3);
                difference(&product(&x[i], &y[j]), &product(&x[j], &y[i]))
            })
        };
        let is = |b: &[Interval], x: f64| b.iter().all(|c| c.lo >= x && c.hi <= x);
        let normal = if curve[3].iter().all(|w| *w == curve[3][0]) && is(&ruling[3], 0.0) {
            // Constant weight: a positive factor of the normal.
            cross(&slope, &ruling)
        } else {
            // Coordinates from a point of the piece, so that little cancels.
            let origin: [f64; 3] = std::array::from_fn(|d| curve[d][0].mid() / curve[3][0].mid());
            let shifted = |x: &[Vec<Interval>; 4]| -> [Vec<Interval>; 4] {
                std::array::from_fn(|d| match origin.get(d) {
                    Some(&o) => x[d].iter().zip(&x[3]).map(|(&a, &w)| a - w * o).collect(),
                    None => x[3].clone(),
                })
            };
            let (c, c1, e) = (shifted(&curve), shifted(&slope), shifted(&ruling));
            let (a, b, g) = (cross(&c1, &e), cross(&e, &c), cross(&c, &c1));
            std::array::from_fn(|d| {
                let low = sum(&product(&a[d], &c[3]), &product(&g[d], &e[3]));
                // (n − 1) + n + n for these two, n + n + (n − 1) for the middle one: equal degrees.
                sum(&low, &product(&b[d], &c1[3]))
            })
        };
        let mid = |x: [Vec<Interval>; 4]| x.map(|b| b.iter().map(|c| c.mid()).collect::<Vec<f64>>());
        // The slope is needed for its scale only.
        Self { normal, curve: mid(curve), ruling: mid(ruling) }
    }

    /// A parameter in `[0, 1]` at which the normal vanishes, up to [`TANGENT_SINE`]; `None` is a proof.
    fn zero(&self) -> Option<f64> {
        let mut parts = vec![(0.0, 1.0, 0usize, self.normal.clone())];
        while let Some((lo, hi, depth, n)) = parts.pop() {
            if n.iter().any(|b| b.iter().all(|x| x.lo > 0.0) || b.iter().all(|x| x.hi < 0.0)) {
                continue;
            }
            let middle = 0.5 * (lo + hi);
            let sine = self.sine(middle);
            if sine.is_nan() || sine <= TANGENT_SINE || depth >= DEEPEST {
                return Some(middle);
            }
            let parts_of = n.map(|b| halves(&b));
            let [a, b, c] = parts_of;
            parts.push((middle, hi, depth + 1, [a.1, b.1, c.1]));
            parts.push((lo, middle, depth + 1, [a.0, b.0, c.0]));
        }
        None
    }

    /// Sine of the angle between curve and ruling.
    fn sine(&self, x: f64) -> f64 {
        let at = |b: &[Vec<f64>; 4]| -> [f64; 4] { std::array::from_fn(|d| value(&b[d], x)) };
        let slope: [Vec<f64>; 4] = std::array::from_fn(|d| elevated(&derivative(&self.curve[d])));
        let (c, c1, e) = (at(&self.curve), at(&slope), at(&self.ruling));
        let point = affine(&c);
        let off = |y: &[f64; 4]| affine(&plus(&[y[0], y[1], y[2], 1.0], &[point.x, point.y, point.z, 0.0], -y[3]));
        let (along, across) = (off(&c1), off(&e));
        along.cross(&across).norm() / (along.norm() * across.norm())
    }
}
