//! Strips: developable pieces between two rails, untrimmed, as exact ruled patches \[W15, FR88\].
//!
//! A strip is bounded by its four natural sides: the rails `v = 0` and `v = 1`, the rulings `u = u₀` and `u = u₁`.
//! One rail may be a point (a fan). Whether a strip is developable is a question to be asked ([`Strip::twist`],
//! [`Strip::twist_bound`]), not a promise of the type.

use super::form::PanelKind;
use crate::geom::Vec3;
use crate::num::bernstein;
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// A named developable piece with its ruled patch.
///
/// # Example
/// ```
/// use torse::{geom::Vec3, torse::{form::PanelKind, strip::Strip}};
/// let [a, b] = [[0.0, 0.0], [30.0, 8.0]].map(|[x, z]| [Vec3::new(x, 0.0, 0.0), Vec3::new(x, 90.0, z)]);
/// let warped = Strip::quad("warped", PanelKind::Ruled, a, b)?;
/// assert!(warped.twist(0.5) > 0.1, "its tangent planes turn along the rulings");
/// let plane = Strip::quad("plane", PanelKind::Plane, a, [b[0], b[1] - Vec3::z() * 8.0])?;
/// assert!(plane.twist_bound().is_some_and(|t| t < 1e-12) && (plane.area_estimate() - 2700.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Name, unique within the job ("A-03").
    pub name: String,
    /// What it is, for people.
    pub kind: PanelKind,
    /// The ruled patch, mm: u selects the ruling, v ∈ [0, 1] runs along it, degree 1 in v; polynomial or rational.
    pub patch: Surface,
}

/// A rail that moves less than this share of the other one per parameter stands still: an apex, up to rounding.
const STANDS_STILL: f64 = 1e-10;

/// Difference of the velocities of both rails, as a share of them, that is rounding: the regression point would be this
/// many lengths of the ruling away.
const PARALLEL: f64 = 1e-10;

impl Strip {
    /// The strip between two rails given as homogeneous curves (weight last). Degrees and knots are made equal, both
    /// domains become [0, 1]; points with the same relative parameter are joined by a ruling. A rail that is a point has the
    /// weights of the other one: that is the same strip, but places follow each other evenly along its rulings.
    ///
    /// # Errors
    /// Curves whose degrees or knots cannot be made equal, control points that are not finite.
    pub fn between(name: &str, kind: PanelKind, a: &Curve<4>, b: &Curve<4>) -> Result<Self, SplineError> {
        let place = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
        let apex = |c: &Curve<4>| {
            let first = place(c.control.first()?);
            c.control.iter().all(|h| place(h) == first).then_some(first)
        };
        let apexes = [a, b].map(apex);
        let (a, b) = matched(a, b)?;
        let mut points = Vec::with_capacity(2 * a.control.len());
        let mut weights = Vec::with_capacity(2 * a.control.len());
        for (p, q) in a.control.iter().zip(&b.control) {
            let own = [p, q];
            for side in 0..2 {
                points.push(apexes[side].unwrap_or_else(|| place(own[side])));
                let of = if apexes[side].is_some() { 1 - side } else { side };
                weights.push(own[of][3]);
            }
        }
        let rational = weights.iter().any(|w| *w != 1.0);
        let across = Knots::clamped(1, &[0.0, 1.0])?;
        let patch = Surface::new(a.knots, across, &points, rational.then_some(&weights[..]))?;
        Ok(Self { name: name.into(), kind, patch })
    }

    /// The strip between two polynomial rails; see [`Strip::between`].
    ///
    /// # Errors
    /// As [`Strip::between`].
    pub fn polynomial(name: &str, kind: PanelKind, a: &Curve<3>, b: &Curve<3>) -> Result<Self, SplineError> {
        Self::between(name, kind, &homogeneous(a), &homogeneous(b))
    }

    /// The bilinear strip with end rulings `first` and `last`: plane if the four points are, a triangle if two
    /// coincide.
    ///
    /// # Errors
    /// Points that are not finite.
    pub fn quad(name: &str, kind: PanelKind, first: [Vec3; 2], last: [Vec3; 2]) -> Result<Self, SplineError> {
        let side = |k: usize| Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![first[k].into(), last[k].into()]);
        Self::polynomial(name, kind, &side(0)?, &side(1)?)
    }

    /// Domain of the rulings.
    pub fn domain(&self) -> (f64, f64) {
        self.patch.knots_u.domain()
    }

    /// Ends of the ruling at `u`.
    pub fn ruling(&self, u: f64) -> [Vec3; 2] {
        [self.patch.point(u, 0.0), self.patch.point(u, 1.0)]
    }

    /// The rail `v = 0` or `v = 1` as a homogeneous curve.
    pub fn rail(&self, side: usize) -> Curve<4> {
        let row = self.patch.row();
        let j = if side == 0 { 0 } else { row - 1 };
        let control = (0..self.patch.knots_u.control_count()).map(|i| self.patch.control[i * row + j]).collect();
        Curve { knots: self.patch.knots_u.clone(), control }
    }

    /// The strip moved by a vector (mm), its control points rounded there.
    pub fn moved(mut self, by: &Vec3) -> Self {
        for c in &mut self.patch.control {
            (0..3).for_each(|d| c[d] += c[3] * by[d]);
        }
        self
    }

    /// Whether a rail is a point, up to rounding.
    pub fn is_point(&self, side: usize) -> bool {
        let c = self.rail(side).control;
        let place = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
        let first = place(&c[0]);
        let size = self.patch.bbox().diagonal();
        c.iter().all(|h| (place(h) - first).norm() <= STANDS_STILL * size)
    }

    /// Components across the ruling of both rails' velocities, and the ruling, at `u`: `(a'⊥, b'⊥, b − a)`.
    fn across(&self, u: f64) -> (Vec3, Vec3, Vec3) {
        let (p, q) = (self.patch.jet(u, 0.0), self.patch.jet(u, 1.0));
        let r = q.p - p.p;
        let rr = r.norm_squared();
        let off = |d: Vec3| if rr > 0.0 { d - r * (d.dot(&r) / rr) } else { d };
        (off(p.du), off(q.du), r)
    }

    /// Oriented twist at `u`, rad: angle in [0, π] between the normals at both ends of the ruling. 0 where the ruling
    /// is torsal and regular; π where it is torsal with the regression point between the rails; 0 at an apex.
    pub fn twist(&self, u: f64) -> f64 {
        let (a, b, _) = self.across(u);
        let (x, y) = (a.norm(), b.norm());
        if x <= STANDS_STILL * y || y <= STANDS_STILL * x {
            return 0.0;
        }
        a.cross(&b).norm().atan2(a.dot(&b))
    }

    /// Distance along the ruling from the strip to its regression point, mm: infinite for parallel neighbours,
    /// 0 where the regression point lies on the strip (apex of a fan included). Exact for torsal rulings \[W15, 1.2\];
    /// for others, the point where neighbouring rulings come nearest.
    pub fn regression_clearance(&self, u: f64) -> f64 {
        let (a, b, r) = self.across(u);
        let d = b - a;
        let dd = d.norm_squared();
        // Rulings parallel up to rounding: the direction of d would be noise.
        if dd <= (PARALLEL * (a.norm() + b.norm())).powi(2) {
            return f64::INFINITY;
        }
        let v = -a.dot(&d) / dd;
        let beyond = if v < 0.0 { -v } else { (v - 1.0).max(0.0) };
        beyond * r.norm()
    }

    /// Bound on the sine of the twist over the whole strip, proven up to the rounding of the coefficients (some
    /// 1e-15). `None` where it could not be shown that rails and rulings stay transversal. 0 for fans.
    ///
    /// *Method.* `sin = |det(a', b', r)| |r| / (|a' × r| |b' × r|)`, `r = b − a`. In homogeneous coordinates all four
    /// are polynomials in u: `det [A, A', B, B']` and minors of these columns. The numerator is bounded by its
    /// Bernstein coefficients \[FR88\], the norms from below by projection on one direction, piece by piece.
    pub fn twist_bound(&self) -> Option<f64> {
        if self.is_point(0) || self.is_point(1) {
            return Some(0.0);
        }
        let (a, b) = (bezier_pieces(&self.rail(0)), bezier_pieces(&self.rail(1)));
        let mut worst = 0.0_f64;
        for ((u0, u1, p), (_, _, q)) in a.iter().zip(&b) {
            worst = worst.max(piece_twist(p, q, *u0, *u1, 0)?);
        }
        Some(worst)
    }

    /// Area, mm², by quadrature of `|(1 − λ) a'⊥ + λ b'⊥| |b − a|` over rulings and their affine parameter λ, 8 × 4
    /// Gauss points in each quarter of a span; in λ exact for developable strips. Not a bound.
    pub fn area_estimate(&self) -> f64 {
        use crate::num::quadrature::{GAUSS_4, GAUSS_8};
        let row = |u: f64| {
            let (a, b, r) = self.across(u);
            r.norm() * GAUSS_4.integrate(0.0, 1.0, |l| (a + (b - a) * l).norm())
        };
        let breaks = self.patch.knots_u.breaks();
        let mut sum = 0.0;
        for w in breaks.windows(2) {
            let h = 0.25 * (w[1] - w[0]);
            sum += (0..4).map(|k| w[0] + h * f64::from(k)).map(|a| GAUSS_8.integrate(a, a + h, row)).sum::<f64>();
        }
        sum
    }
}

/// Halvings of a Bézier piece before a lower bound of a norm is given up.
const DEEPEST: usize = 10;

/// See [`Strip::twist_bound`]: one Bézier piece.
fn piece_twist(p: &[[f64; 4]], q: &[[f64; 4]], u0: f64, u1: f64, depth: usize) -> Option<f64> {
    let component = |c: &[[f64; 4]], d: usize| c.iter().map(|h| h[d]).collect::<Vec<f64>>();
    let (a, b): (Vec<_>, Vec<_>) = (0..4).map(|d| (component(p, d), component(q, d))).unzip();
    let (da, db): (Vec<_>, Vec<_>) =
        (0..4).map(|d| (bernstein::derivative(&a[d]), bernstein::derivative(&b[d]))).unzip();
    // 2 × 2 minors of [A, A'] and [B, B']; Laplace expansion of the 4 × 4 determinant.
    let minor = |x: &[Vec<f64>], y: &[Vec<f64>], i: usize, j: usize| {
        bernstein::difference(&bernstein::product(&x[i], &y[j]), &bernstein::product(&x[j], &y[i]))
    };
    let pairs = [
        (0, 1, 2, 3, 1.0),
        (0, 2, 1, 3, -1.0),
        (0, 3, 1, 2, 1.0),
        (1, 2, 0, 3, 1.0),
        (1, 3, 0, 2, -1.0),
        (2, 3, 0, 1, 1.0),
    ];
    let mut det: Option<Vec<f64>> = None;
    for (i, j, k, l, sign) in pairs {
        let term = bernstein::scaled(&bernstein::product(&minor(&a, &da, i, j), &minor(&b, &db, k, l)), sign);
        det = Some(match det {
            Some(d) => bernstein::sum(&d, &term),
            None => term,
        });
    }
    let largest = det.as_ref()?.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let ruling: [Vec<f64>; 3] =
        [0, 1, 2].map(|d| bernstein::difference(&bernstein::product(&b[d], &a[3]), &bernstein::product(&a[d], &b[3])));
    // Affine velocity of a rail times its squared weight, and its product with the ruling.
    let transversal = |x: &[Vec<f64>], y: &[Vec<f64>]| {
        let v: [Vec<f64>; 3] = [0, 1, 2].map(|d| minor(x, y, 3, d));
        let cross = |i: usize, j: usize| {
            bernstein::difference(&bernstein::product(&v[i], &ruling[j]), &bernstein::product(&v[j], &ruling[i]))
        };
        least_norm(&[cross(1, 2), cross(2, 0), cross(0, 1)])
    };
    let (x, y) = (transversal(&a, &da), transversal(&b, &db));
    let most = |w: &[f64]| w.iter().fold(0.0, |m: f64, x| m.max(*x));
    let length =
        (0..ruling[0].len()).map(|i| Vec3::new(ruling[0][i], ruling[1][i], ruling[2][i]).norm()).fold(0.0, f64::max);
    if x > 0.0 && y > 0.0 {
        return Some(largest * length * most(&a[3]) * most(&b[3]) / (x * y));
    }
    if depth >= DEEPEST {
        return None;
    }
    let halves = |c: &[[f64; 4]]| {
        let parts: Vec<(Vec<f64>, Vec<f64>)> = (0..4).map(|d| bernstein::halves(&component(c, d))).collect();
        let pick = |k: usize| -> Vec<[f64; 4]> {
            (0..c.len()).map(|i| [0, 1, 2, 3].map(|d| if k == 0 { parts[d].0[i] } else { parts[d].1[i] })).collect()
        };
        (pick(0), pick(1))
    };
    let ((p0, p1), (q0, q1)) = (halves(p), halves(q));
    let m = 0.5 * (u0 + u1);
    Some(piece_twist(&p0, &q0, u0, m, depth + 1)?.max(piece_twist(&p1, &q1, m, u1, depth + 1)?))
}

/// Lower bound of the length of a vector polynomial: the least projection of its coefficients on their sum.
fn least_norm(c: &[Vec<f64>; 3]) -> f64 {
    let sum = Vec3::new(c[0].iter().sum(), c[1].iter().sum(), c[2].iter().sum());
    let Some(axis) = sum.try_normalize(0.0) else { return 0.0 };
    (0..c[0].len()).map(|i| axis.dot(&Vec3::new(c[0][i], c[1][i], c[2][i]))).fold(f64::INFINITY, f64::min)
}

/// A polynomial curve of space with weight 1.
pub(crate) fn homogeneous(c: &Curve<3>) -> Curve<4> {
    Curve { knots: c.knots.clone(), control: c.control.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect() }
}

/// Distance of knots, share of the domain, that is rounding: the rulings that join two rails are found to some 1e-11 of
/// a rail, and a short stretch of it makes more of that.
const ONE_KNOT: f64 = 1e-9;

/// The same curves over the same knots on [0, 1], up to [`ONE_KNOT`].
fn matched(a: &Curve<4>, b: &Curve<4>) -> Result<(Curve<4>, Curve<4>), SplineError> {
    let (a, b) = (on_unit(a)?, on_unit(b)?);
    let a = a.elevated_to(b.knots.degree())?;
    let mut b = b.elevated_to(a.knots.degree())?;
    // Knots that differ by rounding are one: a span between them would have no direction.
    let known = a.knots.breaks();
    let one = |t: &f64| known.iter().copied().find(|k| (k - t).abs() <= ONE_KNOT).unwrap_or(*t);
    let values = b.knots.values().iter().map(one).collect();
    b.knots = Knots::new(b.knots.degree(), values, b.control.len())?;
    let missing = |from: &Knots, into: &Knots| -> Vec<f64> {
        let have = into.distinct();
        let mut out = Vec::new();
        for (t, m) in from.distinct() {
            if t > 0.0 && t < 1.0 {
                let there = have.iter().find(|h| h.0 == t).map_or(0, |h| h.1);
                out.extend(std::iter::repeat_n(t, m.saturating_sub(there)));
            }
        }
        out
    };
    let (more_a, more_b) = (missing(&b.knots, &a.knots), missing(&a.knots, &b.knots));
    Ok((a.with_knots(&more_a)?, b.with_knots(&more_b)?))
}

/// The clamped curve on [0, 1].
fn on_unit(c: &Curve<4>) -> Result<Curve<4>, SplineError> {
    let (a, b) = c.domain();
    let c = c.restricted(a, b)?;
    let values =
        c.knots.values().iter().map(|&t| if t >= b { 1.0 } else { ((t - a) / (b - a)).clamp(0.0, 1.0) }).collect();
    let (values, control) = without_end_spans(c.knots.degree(), values, c.control);
    let knots = Knots::new(c.knots.degree(), values, control.len())?;
    Ok(Curve { knots, control })
}

/// Knots and control points of a clamped curve on [0, 1] without spans at its ends that are no longer than [`ONE_KNOT`]: what a cut
/// beside a knot leaves. The ends stay where they are.
fn without_end_spans(degree: usize, mut values: Vec<f64>, mut control: Vec<[f64; 4]>) -> (Vec<f64>, Vec<[f64; 4]>) {
    let more = |control: &Vec<[f64; 4]>| control.len() > degree + 1;
    while more(&control) && values[degree + 1] <= ONE_KNOT {
        // With the knot moved into the end the first point counts nothing, and the next one is the end.
        values.remove(degree + 1);
        control.remove(1);
    }
    while more(&control) && values[values.len() - degree - 2] >= 1.0 - ONE_KNOT {
        values.remove(values.len() - degree - 2);
        control.remove(control.len() - 2);
    }
    (values, control)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(p: [f64; 3], q: [f64; 3]) -> Curve<3> {
        Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![p, q]).expect("line")
    }

    /// A rail cut a rounding beside one of its knots has the end span that is left taken off, at either end.
    #[test]
    fn knots_a_rounding_from_an_end_are_the_end() {
        let near = 3e-10;
        for inner in [near, 1.0 - near] {
            let knots = vec![0.0, 0.0, 0.0, 0.0, inner, 1.0, 1.0, 1.0, 1.0];
            let points = [[0.0, 0.0, 0.0], [0.0, 10.0, 1.0], [0.0, 20.0, 3.0], [0.0, 25.0, 9.0], [0.0, 40.0, 2.0]];
            // Beside the knot two control points are as near as it is.
            let points = match inner < 0.5 {
                true => [points[0], points[0], points[1], points[2], points[4]],
                false => [points[0], points[1], points[2], points[4], points[4]],
            };
            let cut = homogeneous(&Curve::new(3, knots, points.to_vec()).expect("a curve"));
            let straight = homogeneous(&line([100.0, 0.0, 0.0], [100.0, 40.0, 0.0]));
            let (a, b) = matched(&straight, &cut).expect("common knots");
            assert_eq!((a.knots.values(), b.knots.breaks()), (b.knots.values(), vec![0.0, 1.0]));
            for t in [0.0, 0.2, 0.7, 1.0] {
                let (p, q) = (b.point(t), cut.point(t));
                assert!((0..3).all(|d| (p[d] - q[d]).abs() < 1e-7), "{t}: {p:?} {q:?}");
            }
            for t in [0.0, 1.0] {
                let (p, q) = (b.point(t), cut.point(t));
                assert!((0..3).all(|d| (p[d] - q[d]).abs() < 1e-12), "{t}: {p:?} {q:?}");
            }
        }
    }

    #[test]
    fn a_cone_between_a_circle_and_a_point_is_torsal_everywhere() {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let arc = Curve::<4>::new(
            2,
            vec![0.0, 0.0, 0.0, 2.0, 2.0, 2.0],
            vec![[1.0, 0.0, 0.0, 1.0], [h, h, 0.0, h], [0.0, 1.0, 0.0, 1.0]],
        )
        .expect("arc");
        let apex = Curve::<4>::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[0.0, 0.0, 2.0, 1.0]; 2]).expect("apex");
        let s = Strip::between("c", PanelKind::Cone, &arc, &apex).expect("strip");
        assert!(s.is_point(1) && !s.is_point(0));
        assert!(s.twist(0.3) == 0.0 && s.regression_clearance(0.3) == 0.0);
        let half = Strip::between(
            "h",
            PanelKind::Cone,
            &arc,
            &Curve {
                knots: arc.knots.clone(),
                control: arc.control.iter().map(|c| [0.5 * c[0], 0.5 * c[1], c[3], c[3]]).collect(),
            },
        )
        .expect("strip");
        assert!(half.twist(0.4) < 1e-15);
        assert!(half.twist_bound().expect("bound") < 1e-15);
        assert!((half.regression_clearance(0.7) - 1.25f64.sqrt()).abs() < 1e-12);
        let lateral = 0.25 * std::f64::consts::PI * 5f64.sqrt() * 0.75;
        assert!((half.area_estimate() - lateral).abs() < 1e-9);
    }

    #[test]
    fn knots_that_differ_by_rounding_are_one() {
        let rail = |y: f64, knot: f64| {
            let control = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x: f64| [x, y, 0.1 * x * x]).to_vec();
            Curve::<3>::new(3, vec![0.0, 0.0, 0.0, 0.0, knot, 1.0, 1.0, 1.0, 1.0], control).expect("rail")
        };
        for off in [3e-13, 8e-11] {
            let s = Strip::polynomial("s", PanelKind::Cylinder, &rail(0.0, 0.5), &rail(5.0, 0.5 + off)).expect("strip");
            assert_eq!(s.patch.knots_u.breaks(), vec![0.0, 0.5, 1.0]);
            assert!(s.twist_bound().is_some_and(|b| b < 1e-9));
        }
    }

    #[test]
    fn the_twist_of_a_hyperbolic_paraboloid_is_seen_and_bounded() {
        let s = Strip::polynomial(
            "s",
            PanelKind::Torse,
            &line([0.0; 3], [1.0, 0.0, 0.0]),
            &line([0.0, 1.0, 0.0], [1.0, 1.0, 1.0]),
        )
        .expect("strip");
        let worst = (0..=50).map(|k| s.twist(f64::from(k) / 50.0).sin()).fold(0.0, f64::max);
        assert!(worst > 0.5);
        assert!(s.twist_bound().expect("bound") > 0.5);
    }

    #[test]
    fn a_ruling_through_its_regression_point_has_the_twist_pi() {
        let s = Strip::polynomial(
            "x",
            PanelKind::Plane,
            &line([0.0; 3], [1.0, 0.0, 0.0]),
            &line([1.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
        )
        .expect("strip");
        assert!((s.twist(0.5) - std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(s.regression_clearance(0.5), 0.0);
    }

    #[test]
    fn rails_of_different_degree_and_knots_are_matched() {
        let a = Curve::<3>::new(
            2,
            vec![0.0, 0.0, 0.0, 0.3, 1.0, 1.0, 1.0],
            vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0], [3.0, 0.0, 0.0]],
        )
        .expect("a");
        let b = line([0.0, 2.0, 1.0], [3.0, 2.0, 1.0]);
        let s = Strip::polynomial("m", PanelKind::Torse, &a, &b).expect("strip");
        for k in 0..=10 {
            let u = f64::from(k) / 10.0;
            let [p, q] = s.ruling(u);
            assert!((p - Vec3::from(a.point(u))).norm() < 1e-14 && (q - Vec3::from(b.point(u))).norm() < 1e-14);
        }
    }
}
