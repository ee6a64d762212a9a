//! Polynomials in Bernstein form: values, parts, products, compositions; the Bézier patches of a surface.
//!
//! *Method.* Products and degree elevation by \[FR88\]; composition by de Casteljau's scheme with a polynomial as the
//! parameter, every blend being a product. Nothing here is rounded outward; for bounds see
//! `bounds`.

use super::blossom::of_piece;
use super::surface::Surface;
use crate::num::binomial::binomial;

/// A polynomial curve `Σ c_i B_i(t)` on `[0, 1]` with coefficients in `R^D`; a scalar polynomial for `D = 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Bezier<const D: usize> {
    /// Coefficients, one more than the degree; never empty.
    control: Vec<[f64; D]>,
}

impl<const D: usize> Bezier<D> {
    /// The polynomial with these coefficients; the zero polynomial for an empty list.
    pub fn new(control: Vec<[f64; D]>) -> Self {
        if control.is_empty() {
            return Self { control: vec![[0.0; D]] };
        }
        Self { control }
    }

    /// The constant polynomial.
    pub fn constant(value: [f64; D]) -> Self {
        Self { control: vec![value] }
    }

    /// Coefficients, one more than the degree.
    pub fn control(&self) -> &[[f64; D]] {
        &self.control
    }

    /// Degree of the form; the polynomial itself may be of lower degree.
    pub fn degree(&self) -> usize {
        self.control.len() - 1
    }

    /// Value at `t`, by de Casteljau's scheme.
    pub fn point(&self, t: f64) -> [f64; D] {
        let mut c = self.control.clone();
        for r in 1..c.len() {
            for i in 0..c.len() - r {
                c[i] = blend(&c[i], &c[i + 1], t);
            }
        }
        c[0]
    }

    /// The derivative.
    pub fn derivative(&self) -> Self {
        let n = self.degree() as f64;
        Self::new(self.control.windows(2).map(|w| std::array::from_fn(|d| n * (w[1][d] - w[0][d]))).collect())
    }

    /// The antiderivative that vanishes at 0.
    pub fn integral(&self) -> Self {
        let n = self.control.len() as f64;
        let mut sum = [0.0; D];
        let mut control = vec![sum];
        for c in &self.control {
            for d in 0..D {
                sum[d] += c[d] / n;
            }
            control.push(sum);
        }
        Self { control }
    }

    /// The same polynomial with a degree higher by `by`.
    pub fn elevated(&self, by: usize) -> Self {
        self.times(&Bezier { control: vec![[1.0]; by + 1] })
    }

    /// The parts on `[0, t]` and `[t, 1]`, each over `[0, 1]`; their common end is bitwise the same.
    pub fn split(&self, t: f64) -> (Self, Self) {
        let n = self.degree();
        let mut c = self.control.clone();
        let mut left = vec![c[0]];
        let mut right = vec![c[n]];
        for r in 1..=n {
            for i in 0..=n - r {
                c[i] = blend(&c[i], &c[i + 1], t);
            }
            left.push(c[0]);
            right.push(c[n - r]);
        }
        right.reverse();
        (Self { control: left }, Self { control: right })
    }

    /// The part over `[a, b]`, itself over `[0, 1]` (also backwards or outside: the polynomial is continued).
    pub fn restricted(&self, a: f64, b: f64) -> Self {
        let n = self.degree();
        let control = (0..=n)
            .map(|k| {
                // Blossom at a (n − k times) and b (k times).
                let mut c = self.control.clone();
                for r in 1..=n {
                    let t = if r <= n - k { a } else { b };
                    for i in 0..=n - r {
                        c[i] = blend(&c[i], &c[i + 1], t);
                    }
                }
                c[0]
            })
            .collect();
        Self { control }
    }

    /// The polynomial run through backwards.
    pub fn reversed(&self) -> Self {
        Self { control: self.control.iter().rev().copied().collect() }
    }

    /// Product with a scalar polynomial; degrees add.
    pub fn times(&self, factor: &Bezier<1>) -> Self {
        let (m, n) = (self.degree(), factor.degree());
        let mut control = vec![[0.0; D]; m + n + 1];
        for (i, a) in self.control.iter().enumerate() {
            for (j, b) in factor.control.iter().enumerate() {
                let share = binomial(m, i) * binomial(n, j) / binomial(m + n, i + j) * b[0];
                for d in 0..D {
                    control[i + j][d] += share * a[d];
                }
            }
        }
        Self { control }
    }

    /// Sum; the higher degree.
    pub fn plus(&self, other: &Self) -> Self {
        self.combined(other, 1.0)
    }

    /// Difference; the higher degree.
    pub fn minus(&self, other: &Self) -> Self {
        self.combined(other, -1.0)
    }

    fn combined(&self, other: &Self, sign: f64) -> Self {
        let (m, n) = (self.degree(), other.degree());
        let (a, b) = (self.elevated(n.saturating_sub(m)), other.elevated(m.saturating_sub(n)));
        let control = a.control.iter().zip(&b.control).map(|(x, y)| std::array::from_fn(|d| x[d] + sign * y[d]));
        Self { control: control.collect() }
    }

    /// One component as a scalar polynomial.
    pub fn component(&self, d: usize) -> Bezier<1> {
        Bezier { control: self.control.iter().map(|c| [c.get(d).copied().unwrap_or(0.0)]).collect() }
    }

    /// Scalar product; degrees add.
    pub fn dot(&self, other: &Self) -> Bezier<1> {
        let (m, n) = (self.degree(), other.degree());
        let mut control = vec![[0.0]; m + n + 1];
        for (i, a) in self.control.iter().enumerate() {
            for (j, b) in other.control.iter().enumerate() {
                let share = binomial(m, i) * binomial(n, j) / binomial(m + n, i + j);
                control[i + j][0] += share * (0..D).map(|d| a[d] * b[d]).sum::<f64>();
            }
        }
        Bezier { control }
    }

    /// The composition `self(g(t))`; degrees multiply. `g` may leave `[0, 1]`: the polynomial is continued.
    pub fn compose(&self, g: &Bezier<1>) -> Self {
        let rest = Bezier::constant([1.0]).minus(g);
        let mut c: Vec<Self> = self.control.iter().map(|&x| Self::constant(x)).collect();
        for r in 1..c.len() {
            for i in 0..c.len() - r {
                c[i] = c[i].times(&rest).plus(&c[i + 1].times(g));
            }
        }
        c.swap_remove(0)
    }

    /// Smallest and largest coefficient of every component: the values on `[0, 1]` lie between (up to rounding; for
    /// a rigorous hull see `bounds`).
    pub fn hull(&self) -> [(f64, f64); D] {
        std::array::from_fn(|d| {
            self.control.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), c| (lo.min(c[d]), hi.max(c[d])))
        })
    }
}

impl Bezier<3> {
    /// Vector product; degrees add.
    pub fn cross(&self, other: &Self) -> Self {
        let c = |a: usize, b: usize| {
            let (x, y) = (self.component(a).times(&other.component(b)), self.component(b).times(&other.component(a)));
            x.minus(&y)
        };
        let (x, y, z) = (c(1, 2), c(2, 0), c(0, 1));
        let control = (0..x.control.len()).map(|i| [x.control[i][0], y.control[i][0], z.control[i][0]]).collect();
        Self { control }
    }
}

#[inline]
fn blend<const D: usize>(a: &[f64; D], b: &[f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|d| (1.0 - t) * a[d] + t * b[d])
}

/// A polynomial piece of a surface in Bernstein form.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierPatch {
    /// Interval of the surface's u.
    pub u: (f64, f64),
    /// Interval of the surface's v.
    pub v: (f64, f64),
    /// Degrees in u and v.
    pub degree: (usize, usize),
    /// Homogeneous control points, row-major: index `i * (degree.1 + 1) + j`.
    pub control: Vec<[f64; 4]>,
}

impl BezierPatch {
    /// Homogeneous value at local parameters in `[0, 1]²`.
    pub fn point(&self, s: f64, t: f64) -> [f64; 4] {
        Bezier::new(self.rows().map(|row| row.point(t)).collect()).point(s)
    }

    /// Curves in v, one per control row.
    fn rows(&self) -> impl Iterator<Item = Bezier<4>> + '_ {
        self.control.chunks(self.degree.1 + 1).map(|row| Bezier { control: row.to_vec() })
    }

    /// The curve on the patch over a curve `(s, t)` of the parameter square, homogeneous, of degree
    /// `(p + q) · degree(curve)`.
    pub fn compose(&self, curve: &Bezier<2>) -> Bezier<4> {
        let (s, t) = (curve.component(0), curve.component(1));
        let rest = Bezier::constant([1.0]).minus(&s);
        let mut c: Vec<Bezier<4>> = self.rows().map(|row| row.compose(&t)).collect();
        for r in 1..c.len() {
            for i in 0..c.len() - r {
                c[i] = c[i].times(&rest).plus(&c[i + 1].times(&s));
            }
        }
        c.swap_remove(0)
    }
}

impl Surface {
    /// The Bézier patches of the surface, row by row in u.
    pub fn bezier_patches(&self) -> Vec<BezierPatch> {
        self.bezier_patches_on(&self.knots_u.breaks(), &self.knots_v.breaks())
    }

    /// Bézier patches between parameters in order, row by row in u; between two neighbours there must be no knot.
    pub(crate) fn bezier_patches_on(&self, us: &[f64], vs: &[f64]) -> Vec<BezierPatch> {
        let (p, q, row) = (self.knots_u.degree(), self.knots_v.degree(), self.row());
        let corners = |a: f64, b: f64, n: usize, k: usize| -> Vec<f64> {
            (0..n).map(|i| if i < n - k { a } else { b }).collect()
        };
        let mut patches = Vec::new();
        for u in us.windows(2) {
            let su = self.knots_u.span(0.5 * (u[0] + u[1]));
            // Along u first: p + 1 rows that still span all of v.
            let rows: Vec<Vec<[f64; 4]>> = (0..=p)
                .map(|k| {
                    let args = corners(u[0], u[1], p, k);
                    (0..row)
                        .map(|j| {
                            let mut net: Vec<[f64; 4]> = (su - p..=su).map(|i| self.control[i * row + j]).collect();
                            of_piece(&self.knots_u, su, &mut net, &args)
                        })
                        .collect()
                })
                .collect();
            for v in vs.windows(2) {
                let sv = self.knots_v.span(0.5 * (v[0] + v[1]));
                let mut control = Vec::with_capacity((p + 1) * (q + 1));
                for line in &rows {
                    for k in 0..=q {
                        let mut net = line[sv - q..=sv].to_vec();
                        control.push(of_piece(&self.knots_v, sv, &mut net, &corners(v[0], v[1], q, k)));
                    }
                }
                patches.push(BezierPatch { u: (u[0], u[1]), v: (v[0], v[1]), degree: (p, q), control });
            }
        }
        patches
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::sample::any_surface;
    use proptest::prelude::*;

    fn polynomial<const D: usize>(degrees: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Bezier<D>> {
        prop::collection::vec(prop::collection::vec(-5.0..5.0f64, D), *degrees.start() + 1..=*degrees.end() + 1)
            .prop_map(|c| Bezier::new(c.iter().map(|x| std::array::from_fn(|d| x[d])).collect()))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn algebra_is_that_of_the_values(
            a in polynomial::<3>(0..=6), b in polynomial::<3>(0..=5), f in polynomial::<1>(0..=4),
            g in polynomial::<1>(0..=3), t in 0.0..1.0f64,
        ) {
            let (x, y, s) = (a.point(t), b.point(t), f.point(t)[0]);
            let near = |p: f64, q: f64, size: f64| (p - q).abs() <= 1e-12 * size;
            let dot: f64 = (0..3).map(|d| x[d] * y[d]).sum();
            prop_assert!(near(a.dot(&b).point(t)[0], dot, 100.0));
            let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
            for d in 0..3 {
                prop_assert!(near(a.times(&f).point(t)[d], x[d] * s, 100.0));
                prop_assert!(near(a.plus(&b).point(t)[d], x[d] + y[d], 10.0));
                prop_assert!(near(a.minus(&b).point(t)[d], x[d] - y[d], 10.0));
                prop_assert!(near(a.cross(&b).point(t)[d], cross[d], 200.0));
                prop_assert!(near(a.elevated(3).point(t)[d], x[d], 10.0));
                prop_assert!(near(a.integral().derivative().point(t)[d], x[d], 100.0));
                prop_assert!(near(a.reversed().point(1.0 - t)[d], x[d], 10.0));
            }
            prop_assert_eq!(a.times(&f).degree(), a.degree() + f.degree());
            // The composition leaves [0, 1], where values of high degree grow fast: compare relative to the hull.
            let inner = Bezier::new(g.control().iter().map(|c| [0.5 + 0.2 * c[0]]).collect());
            let whole = f.compose(&inner);
            let size = whole.control().iter().fold(10.0f64, |m, c| m.max(c[0].abs()));
            prop_assert!(near(whole.point(t)[0], f.point(inner.point(t)[0])[0], 10.0 * size));
            prop_assert_eq!(whole.degree(), f.degree() * g.degree());
        }

        #[test]
        fn parts_and_hulls_hold_the_values(a in polynomial::<2>(1..=7), cut in 0.0..1.0f64, t in 0.0..1.0f64) {
            let (left, right) = a.split(cut);
            let part = a.restricted(0.2, cut);
            for d in 0..2 {
                prop_assert!((left.point(t)[d] - a.point(cut * t)[d]).abs() < 1e-12);
                prop_assert!((right.point(t)[d] - a.point(cut + (1.0 - cut) * t)[d]).abs() < 1e-12);
                prop_assert!((part.point(t)[d] - a.point(0.2 + (cut - 0.2) * t)[d]).abs() < 1e-11);
                let (lo, hi) = left.hull()[d];
                prop_assert!(lo - 1e-12 <= left.point(t)[d] && left.point(t)[d] <= hi + 1e-12);
            }
            prop_assert_eq!(left.control().last(), right.control().first());
        }

        #[test]
        fn patches_and_curves_on_them_lie_on_the_surface(s in any_surface(), x in 0.0..1.0f64, y in 0.0..1.0f64) {
            let affine = |h: [f64; 4]| crate::geom::Vec3::new(h[0], h[1], h[2]) / h[3];
            let patches = s.bezier_patches();
            prop_assert_eq!(patches.len(), (s.knots_u.breaks().len() - 1) * (s.knots_v.breaks().len() - 1));
            let curve = Bezier::new(vec![[0.1, 0.9], [0.8, 0.2], [0.6, 0.7]]);
            for patch in &patches {
                let on = |a: f64, b: f64| s.point(patch.u.0 + a * (patch.u.1 - patch.u.0), patch.v.0 + b * (patch.v.1 - patch.v.0));
                prop_assert!((affine(patch.point(x, y)) - on(x, y)).norm() < 1e-8);
                let p = curve.point(x);
                prop_assert!((affine(patch.compose(&curve).point(x)) - on(p[0], p[1])).norm() < 1e-7);
            }
        }
    }

    #[test]
    fn the_empty_list_is_zero() {
        assert_eq!(Bezier::<2>::new(Vec::new()).point(0.3), [0.0, 0.0]);
        assert_eq!(Bezier::constant([2.0]).derivative().point(0.5), [0.0]);
    }
}
