//! Regularity of a net, decided: where the regression curve lies against the strip, and whether the curve ever runs
//! along its ruling.
//!
//! *Method.* The first is a comparison of numbers, because the regression curve lies at a place linear in `u`
//! (corollary 3 of \[FJ07\] for all segments at once). The second asks for zeros of the vector polynomial `c' × e`,
//! by subdivision in Bernstein form with interval coefficients \[FR88\].

use super::{affine, plus, Net};
use crate::geom::Vec3;
use crate::num::bernstein::{derivative, difference, elevated, from_spline, halves, product, sum, value};
use crate::num::interval::Interval;

/// Sine of the angle between curve and ruling below which the ruling counts as tangent: the square of it is the
/// rounding of one.
const TANGENT_SINE: f64 = 1e-8;
/// Times a segment is halved before a ruling is called tangent: the part left is below the spacing of numbers.
const DEEPEST: usize = 50;

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
        knots.breaks().windows(2).find_map(|w| {
            let span = knots.span(0.5 * (w[0] + w[1]));
            let around = &all[span + 1 - p..=span + p];
            let part = |control: &[[f64; 4]]| -> [Vec<Interval>; 4] {
                std::array::from_fn(|d| {
                    let net: Vec<Interval> = control[span - p..=span].iter().map(|c| Interval::point(c[d])).collect();
                    from_spline(&net, around)
                })
            };
            Piece::new(part(&self.curve().control), part(self.rulings())).zero().map(|x| w[0] + x * (w[1] - w[0]))
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
            best.0.min(golden(distance, best.1, best.2))
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
    points.enumerate().find(|(_, p)| !(p[3] > 0.0)).map(|(i, p)| (i, p[3]))
}

/// Smallest value met by golden section between `a` and `b`.
fn golden(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_8;
    let (mut x, mut y) = (b - SHARE * (b - a), a + SHARE * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    // 40 steps shrink the bracket to the square root of rounding, where a minimum stops changing.
    for _ in 0..40 {
        if fx < fy {
            (b, y, fy) = (y, x, fx);
            x = b - SHARE * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + SHARE * (b - a);
            fy = f(y);
        }
    }
    fx.min(fy)
}

/// Bernstein form of one piece: the normal `c' × e` in homogeneous form, and the curve and ruling for its scale.
struct Piece {
    normal: [Vec<Interval>; 3],
    curve: [Vec<f64>; 4],
    ruling: [Vec<f64>; 4],
}

impl Piece {
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
            if !(sine > TANGENT_SINE) || depth >= DEEPEST {
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
