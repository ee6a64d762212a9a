//! Reflection lines: images of parallel lamps far away \[W15, 4\]. Where surfaces meet at an angle they break, and where the
//! curvature jumps they have corners: lines that are continuous show one tangent plane, smooth ones one curvature.

use crate::geom::Vec3;

/// Bright and dark lamps over half a turn.
const LAMPS: f64 = 12.0;

/// Direction in which a ray with direction `ray` goes on from a surface with unit normal `normal`.
pub fn reflected(ray: &Vec3, normal: &Vec3) -> Vec3 {
    ray - normal * (2.0 * normal.dot(ray))
}

/// Where in the pattern of lamps, which are parallel to `e2 × e1`, the image at a place with this normal lies, 0 to 1: dark
/// below one half. The two directions are orthogonal unit vectors.
pub fn stripe(ray: &Vec3, normal: &Vec3, [e1, e2]: [&Vec3; 2]) -> f64 {
    let y = reflected(ray, normal);
    (LAMPS * y.dot(e2).atan2(y.dot(e1)) / std::f64::consts::PI).rem_euclid(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_leave_as_they_came() {
        let ray = Vec3::new(0.6, 0.0, -0.8);
        assert!((reflected(&ray, &Vec3::z()) - Vec3::new(0.6, 0.0, 0.8)).norm() < 1e-15);
        // Length and angle with the normal are kept, whichever side the normal points to.
        let n = Vec3::new(1.0, 2.0, -2.0) / 3.0;
        let y = reflected(&ray, &n);
        assert!((y.norm() - 1.0).abs() < 1e-15 && (y.dot(&n) + ray.dot(&n)).abs() < 1e-15);
        assert_eq!(y, reflected(&ray, &-n));
    }

    #[test]
    fn stripes_go_on_where_normals_do_and_break_at_edges() {
        let (ray, toward, z) = (Vec3::y(), -Vec3::y(), Vec3::z());
        let at = |a: f64| stripe(&ray, &Vec3::new(0.2 * a.sin(), -a.cos(), a.sin()).normalize(), [&toward, &z]);
        let off = |a: f64, b: f64| ((at(a) - at(b) + 0.5).rem_euclid(1.0) - 0.5).abs();
        assert!((1..40).all(|k| off(0.03 * f64::from(k), 0.03 * f64::from(k) + 1e-4) < 1e-2));
        assert!(off(0.3, 0.32) > 0.05);
    }
}
