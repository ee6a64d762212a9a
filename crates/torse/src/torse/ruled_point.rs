//! One ruling of a ruled surface to first order: what its tangent plane does along it (Lemma 1.1 of \[W15\]).
//!
//! A ruled surface `x(u, v) = a(u) + v r(u)` is known near one ruling by `a'`, `r` and `r'`. They decide whether the
//! tangent plane turns (twisted), stands still (torsal) or is missing (singular), where the striction point lies, and
//! the Gauss curvature along the ruling. Nothing is known here of neighbouring rulings.

use crate::geom::Vec3;
use nalgebra::Matrix3;

/// First-order data of a ruled surface at one ruling. Lengths in mm, `u` in any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuledPoint {
    /// Velocity of the directrix.
    pub a_dot: Vec3,
    /// Vector along the ruling, of any length but 0.
    pub r: Vec3,
    /// Velocity of that vector.
    pub r_dot: Vec3,
}

/// The three cases of Lemma 1.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RulingCase {
    /// `a'`, `r`, `r'` span space: the tangent plane turns by 180° in all, and no point is singular.
    Twisted,
    /// They span a plane: one tangent plane for all points but at most one.
    Torsal,
    /// They span a line: no point has a tangent plane.
    Singular,
}

impl RulingCase {
    /// Lower-case name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Twisted => "twisted",
            Self::Torsal => "torsal",
            Self::Singular => "singular",
        }
    }
}

/// Velocities that change by no more than this share of the directrix' or the ruling's are rounding: the ruling is
/// that of a cylinder. Four digits above the rounding of cross products.
const STANDS_STILL: f64 = 1e-12;

impl RuledPoint {
    /// The ruling that joins `a` and `b`, from the velocities of both and `r = b − a`.
    pub fn between(a_dot: Vec3, b_dot: Vec3, r: Vec3) -> Self {
        Self { a_dot, r, r_dot: b_dot - a_dot }
    }

    /// Dimension of the span of `a'`, `r`, `r'`, each scaled to length 1: the number of singular values of at least
    /// `tolerance` (a sine: 1e-9 for exact data, three standard deviations of the angles for noisy ones). Vectors of
    /// length 0 are left out; 0 if all are, or if one is not finite.
    pub fn rank(&self, tolerance: f64) -> usize {
        let columns = [self.a_dot, self.r, self.r_dot].map(|v| v.try_normalize(0.0).unwrap_or_else(Vec3::zeros));
        if columns.iter().any(|c| c.iter().any(|x| !x.is_finite())) {
            return 0;
        }
        let s = Matrix3::from_columns(&columns).singular_values();
        s.iter().filter(|x| **x >= tolerance).count()
    }

    /// The case of Lemma 1.1; see [`RuledPoint::rank`] for the tolerance.
    pub fn case(&self, tolerance: f64) -> RulingCase {
        match self.rank(tolerance) {
            3 => RulingCase::Twisted,
            2 => RulingCase::Torsal,
            _ => RulingCase::Singular,
        }
    }

    /// Unit direction and its velocity, which is orthogonal to it; `None` for a ruling without length or one whose
    /// direction stands still (cylinder).
    fn turning(&self) -> Option<(Vec3, Vec3)> {
        let length = self.r.norm();
        let e = self.r.try_normalize(0.0)?;
        let w = (self.r_dot - e * self.r_dot.dot(&e)) / length;
        // Compared with the turning that would move the end of the ruling as fast as the directrix moves.
        let scale = (self.a_dot.norm() / length).max(self.r_dot.norm() / length);
        (w.norm() > STANDS_STILL * scale).then_some((e, w))
    }

    /// Distribution parameter `δ = det(a', e, e') / e'·e'` for the unit direction `e`, mm. 0 for a torsal ruling;
    /// `None` where the direction stands still (cylinder), which is torsal too.
    pub fn distribution_parameter(&self) -> Option<f64> {
        let (e, w) = self.turning()?;
        Some(self.a_dot.cross(&e).dot(&w) / w.norm_squared())
    }

    /// Distance of the striction point from the directrix along the ruling, mm: where neighbouring rulings come
    /// nearest, the regression point if the ruling is torsal. `None` for a cylinder's ruling.
    pub fn striction(&self) -> Option<f64> {
        let (_, w) = self.turning()?;
        Some(-self.a_dot.dot(&w) / w.norm_squared())
    }

    /// Angle by which the tangent plane has turned from the striction point to the point at distance `s` (mm) from the
    /// directrix, rad in (−π/2, π/2): `tan = (s − s₀) / δ`. ±π/2 at once for a torsal ruling with a regression point;
    /// 0 for a cylinder's ruling.
    pub fn tangent_rotation(&self, s: f64) -> f64 {
        match (self.distribution_parameter(), self.striction()) {
            (Some(delta), Some(s0)) => tangent_rotation(delta, s - s0),
            _ => 0.0,
        }
    }

    /// Gauss curvature at the distance `s` (mm) from the directrix, 1/mm²: `−δ² / (δ² + (s − s₀)²)²`. 0 for torsal
    /// rulings.
    pub fn gauss_curvature(&self, s: f64) -> f64 {
        match (self.distribution_parameter(), self.striction()) {
            (Some(delta), Some(s0)) => gauss_curvature(delta, s - s0),
            _ => 0.0,
        }
    }

    /// Least-squares `κ`, `ν` of `b' − a' = κ (b' + a') + ν r` and the length of what is left (mm per unit of u).
    ///
    /// Nothing is left exactly for torsal rulings. Their regression point lies at `v = 1/2 − 1/(2κ)` of the segment
    /// from `a` to `b`, so outside of it if and only if `|κ| < 1`; `κ = 0` stands for parallel neighbours. `None` if
    /// the mean velocity runs along the ruling.
    pub fn segment_form(&self) -> Option<SegmentForm> {
        let e = self.r.try_normalize(0.0)?;
        let off = |v: Vec3| v - e * v.dot(&e);
        let (m, d) = (off(self.a_dot * 2.0 + self.r_dot), off(self.r_dot));
        if m.norm() <= STANDS_STILL * d.norm().max(self.a_dot.norm()) {
            return None;
        }
        let kappa = d.dot(&m) / m.norm_squared();
        let along = self.r_dot - (self.a_dot * 2.0 + self.r_dot) * kappa;
        Some(SegmentForm { kappa, nu: along.dot(&e) / self.r.norm(), residual: (d - m * kappa).norm() })
    }
}

/// See [`tangent_rotation`](RuledPoint::tangent_rotation): from the distribution parameter and the distance from the
/// striction point alone.
pub fn tangent_rotation(delta: f64, from_striction: f64) -> f64 {
    if delta == 0.0 && from_striction == 0.0 {
        return 0.0;
    }
    (from_striction * delta.signum()).atan2(delta.abs())
}

/// See [`gauss_curvature`](RuledPoint::gauss_curvature): from the distribution parameter and the distance from the
/// striction point alone.
pub fn gauss_curvature(delta: f64, from_striction: f64) -> f64 {
    if delta == 0.0 {
        return 0.0;
    }
    // Scaled, so that neither tiny nor huge lengths leave the range of numbers.
    let q = from_striction / delta;
    let d = 1.0 + q * q;
    -1.0 / (delta * d) / (delta * d)
}

/// A ruling's velocities in the form that shows where its regression point lies; see [`RuledPoint::segment_form`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentForm {
    /// Coefficient of the sum of velocities; −1 and 1 put the regression point on `b` and on `a`.
    pub kappa: f64,
    /// Coefficient of the ruling.
    pub nu: f64,
    /// Length of what is left; 0 for torsal rulings.
    pub residual: f64,
}

impl SegmentForm {
    /// The regression point as a share of the segment; infinite for parallel neighbours.
    pub fn regression(&self) -> f64 {
        0.5 - 0.5 / self.kappa
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn helicoid(u: f64) -> RuledPoint {
        RuledPoint {
            a_dot: Vec3::new(0.0, 0.0, 0.7),
            r: Vec3::new(u.cos(), u.sin(), 0.0),
            r_dot: Vec3::new(-u.sin(), u.cos(), 0.0),
        }
    }

    /// Tangents of the helix (cos t, sin t, p t).
    fn tangents(t: f64, p: f64) -> RuledPoint {
        let r = Vec3::new(-t.sin(), t.cos(), p);
        RuledPoint { a_dot: r, r, r_dot: Vec3::new(-t.cos(), -t.sin(), 0.0) }
    }

    #[test]
    fn lemma_1_1_helicoid_hyperboloid_tangents_and_a_standing_line() {
        let h = helicoid(0.4);
        assert_eq!((h.rank(1e-9), h.case(1e-9)), (3, RulingCase::Twisted));
        assert!((h.distribution_parameter().expect("turns") - 0.7).abs() < 1e-15);
        assert!(h.striction().expect("turns").abs() < 1e-15);
        assert!((h.gauss_curvature(1.0) + 0.220_710_778_793_748).abs() < 1e-14);
        // In all, the tangent plane turns by 180°.
        let total = h.tangent_rotation(1e12) - h.tangent_rotation(-1e12);
        assert!((total - std::f64::consts::PI).abs() < 1e-11);
        let (s, c) = 0.4f64.sin_cos();
        let hyperboloid =
            RuledPoint { a_dot: Vec3::new(-s, c, 0.0), r: Vec3::new(-s, c, 1.5), r_dot: Vec3::new(-c, -s, 0.0) };
        assert!((hyperboloid.distribution_parameter().expect("turns") + 1.5).abs() < 1e-14);
        assert!(hyperboloid.striction().expect("turns").abs() < 1e-14);
        let t = tangents(0.3, 0.5);
        assert_eq!(t.case(1e-9), RulingCase::Torsal);
        assert!(t.striction().expect("turns").abs() < 1e-15 && t.gauss_curvature(2.0) == 0.0);
        let line = RuledPoint { a_dot: Vec3::x(), r: Vec3::x() * 2.0, r_dot: Vec3::x() };
        assert_eq!(line.case(1e-9), RulingCase::Singular);
        assert_eq!(RuledPoint { a_dot: Vec3::repeat(f64::NAN), ..line }.rank(1e-9), 0);
    }

    #[test]
    fn the_turn_of_the_tangent_plane_is_what_the_normals_do() {
        let h = RuledPoint {
            a_dot: Vec3::new(0.3, -0.2, 0.7),
            r: Vec3::new(1.0, 2.0, 0.5),
            r_dot: Vec3::new(0.4, 0.1, -0.6),
        };
        let normal = |s: f64| (h.a_dot + h.r_dot * (s / h.r.norm())).cross(&h.r);
        for (a, b) in [(-1.0, 0.3), (0.2, 5.0), (-20.0, 30.0)] {
            let (m, n) = (normal(a), normal(b));
            let turned = (h.tangent_rotation(b) - h.tangent_rotation(a)).abs();
            assert!((m.cross(&n).norm().atan2(m.dot(&n)) - turned).abs() < 1e-12);
        }
    }

    #[test]
    fn gauss_curvature_is_that_of_the_fundamental_forms() {
        // x = a(u) + s e(u) with a = (0, 0, 0.7 u): K = −δ²/(δ² + s²)², and directly for the helicoid.
        for s in [0.1, 1.3, 4.0] {
            let k = -0.49 / (0.49 + s * s) / (0.49 + s * s);
            assert!((helicoid(1.1).gauss_curvature(s) - k).abs() < 1e-14);
        }
        assert_eq!(gauss_curvature(0.0, 0.0), 0.0);
    }

    #[test]
    fn the_segment_form_tells_on_which_side_the_regression_point_lies() {
        // A cone with its apex at the share v of the segment.
        for v in [-2.0, 0.25, 0.9, 3.5] {
            let r = Vec3::new(1.0, 2.0, -0.5);
            let across = Vec3::new(0.3, -0.1, 0.4);
            let p = RuledPoint::between(across * -v, across * (1.0 - v), r);
            let form = p.segment_form();
            let form = form.expect("a mean velocity across the ruling");
            assert!(form.residual < 1e-14 && (form.regression() - v).abs() < 1e-12);
            assert_eq!(form.kappa.abs() > 1.0, (0.0..=1.0).contains(&v));
        }
        let cylinder = RuledPoint::between(Vec3::x(), Vec3::x(), Vec3::z());
        assert_eq!(cylinder.segment_form().expect("form").kappa, 0.0);
        assert!(cylinder.striction().is_none() && cylinder.case(1e-9) == RulingCase::Torsal);
        assert!(helicoid(0.2).segment_form().expect("form").residual > 0.5);
    }
}
