//! One plane of a moving plane with its derivatives: ruling and regression point of the envelope (section 1A of
//! \[W15\]).

use super::form::Ruling;
use super::ruled_point::RuledPoint;
use crate::geom::Vec3;
use nalgebra::Matrix3;

/// A plane `n·X = h` that moves with u, and its first two derivatives. Lengths in mm, n of any length but 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopePoint {
    /// `n`, `n'`, `n''`.
    pub normal: [Vec3; 3],
    /// `h`, `h'`, `h''`.
    pub offset: [f64; 3],
}

/// Ratio of the least to the greatest singular value of the directions of `n`, `n'`, `n''` from which three planes
/// meet in a point; below it the point is lost in rounding, and the envelope is a cylinder to first order.
const NO_POINT: f64 = 1e-10;

impl EnvelopePoint {
    /// The line in which the plane meets its next neighbour; its point is the one nearest to the origin. `None` where
    /// the plane stands still to first order.
    pub fn ruling(&self) -> Option<Ruling> {
        let normal = self.normal[0].try_normalize(0.0)?;
        // n' may have a part along n, from a normal that changes its length; it moves nothing.
        let along = self.normal[1].dot(&self.normal[0]) / self.normal[0].norm_squared();
        let m = self.normal[1] - self.normal[0] * along;
        let turned = self.offset[1] - self.offset[0] * along;
        if m.norm() <= NO_POINT * self.normal[1].norm() {
            return None;
        }
        let direction = normal.cross(&m).try_normalize(0.0)?;
        let point = normal * (self.offset[0] / self.normal[0].norm()) + m * (turned / m.norm_squared());
        Some(Ruling { point, direction, normal })
    }

    /// The point in which the plane meets its next two neighbours: `n·X = h`, `n'·X = h'`, `n''·X = h''`.
    /// `None` for cylinders (no point) and planes that stand still.
    pub fn regression_point(&self) -> Option<Vec3> {
        let mut rows = [Vec3::zeros(); 3];
        let mut right = Vec3::zeros();
        for k in 0..3 {
            let length = self.normal[k].norm();
            rows[k] = self.normal[k].try_normalize(0.0)?;
            right[k] = self.offset[k] / length;
        }
        let m = Matrix3::from_rows(&rows.map(|r| r.transpose()));
        let svd = m.svd(true, true);
        let (least, most) = (svd.singular_values.min(), svd.singular_values.max());
        if least.is_nan() || least <= NO_POINT * most {
            return None;
        }
        svd.solve(&right, 0.0).ok()
    }

    /// The plane along a torsal ruling through `a`: unit normal along `a' × r`, or, where the directrix stands still
    /// or runs along the ruling, along `r' × r`. `None` where neither says anything.
    pub fn tangent_plane(at: &RuledPoint, a: &Vec3) -> Option<(Vec3, f64)> {
        let first = at.a_dot.cross(&at.r);
        let second = at.r_dot.cross(&at.r);
        let scale = at.r.norm() * at.a_dot.norm().max(at.r_dot.norm());
        let n = if first.norm() > NO_POINT * scale { first } else { second };
        let n = n.try_normalize(0.0)?;
        Some((n, n.dot(a)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Osculating planes of the helix (cos t, sin t, p t).
    fn osculating(t: f64, p: f64) -> EnvelopePoint {
        let (s, c) = t.sin_cos();
        EnvelopePoint {
            normal: [Vec3::new(p * s, -p * c, 1.0), Vec3::new(p * c, p * s, 0.0), Vec3::new(-p * s, p * c, 0.0)],
            offset: [p * t, p, 0.0],
        }
    }

    #[test]
    fn osculating_planes_envelop_the_tangents_and_meet_on_the_curve() {
        let (t, p) = (0.3f64, 0.5);
        let e = osculating(t, p);
        let c = Vec3::new(t.cos(), t.sin(), p * t);
        assert!((e.regression_point().expect("a point") - c).norm() < 1e-12);
        let r = e.ruling().expect("a ruling");
        let tangent = Vec3::new(-t.sin(), t.cos(), p).normalize();
        assert!(r.direction.cross(&tangent).norm() < 1e-14);
        assert!((r.point - c).cross(&tangent).norm() < 1e-14);
        assert!(r.point.dot(&r.direction).abs() < 1e-14);
    }

    #[test]
    fn a_change_of_the_length_of_the_normal_changes_nothing() {
        // (1 + 0.7 h) times the planes.
        let e = osculating(0.3, 0.5);
        let f = EnvelopePoint {
            normal: [e.normal[0], e.normal[1] + e.normal[0] * 0.7, e.normal[2] + e.normal[1] * 1.4],
            offset: [e.offset[0], e.offset[1] + 0.7 * e.offset[0], e.offset[2] + 1.4 * e.offset[1]],
        };
        let (a, b) = (e.ruling().expect("ruling"), f.ruling().expect("ruling"));
        assert!((a.point - b.point).norm() < 1e-14 && (a.direction - b.direction).norm() < 1e-14);
        assert!((e.regression_point().expect("p") - f.regression_point().expect("q")).norm() < 1e-12);
    }

    #[test]
    fn cylinders_have_no_regression_point_and_standing_planes_no_ruling() {
        let (s, c) = 0.4f64.sin_cos();
        let cylinder = EnvelopePoint {
            normal: [Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0), Vec3::new(-c, -s, 0.0)],
            offset: [1.0, 0.0, 0.0],
        };
        assert!(cylinder.regression_point().is_none());
        assert!((cylinder.ruling().expect("ruling").direction - Vec3::z()).norm() < 1e-14);
        let standing = EnvelopePoint { normal: [Vec3::z(), Vec3::z(), Vec3::zeros()], offset: [1.0, 1.0, 0.0] };
        assert!(standing.ruling().is_none() && standing.regression_point().is_none());
    }

    #[test]
    fn planes_of_a_ruled_point_and_back() {
        let t = 0.3f64;
        let r = Vec3::new(-t.sin(), t.cos(), 0.5);
        let at = RuledPoint { a_dot: r, r, r_dot: Vec3::new(-t.cos(), -t.sin(), 0.0) };
        let (n, h) = EnvelopePoint::tangent_plane(&at, &Vec3::new(t.cos(), t.sin(), 0.5 * t)).expect("a plane");
        let e = osculating(t, 0.5);
        assert!(n.cross(&e.normal[0]).norm() < 1e-13);
        assert!((h.abs() - (e.offset[0] / e.normal[0].norm()).abs()).abs() < 1e-13);
    }
}
