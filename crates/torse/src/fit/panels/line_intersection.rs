//! Where a torse meets the lines on which panels end, the face's normals or others near them: panels trimmed there meet in
//! common end points, whatever their distances from the face are.
//!
//! *Method*: Newton steps along the line, each from the distance to the tangent plane at the foot (the certificate's
//! foot, \[SE06\] carried on).

use crate::geom::Vec3;
use crate::torse::form::Torse;

/// Steps along the line; the distance falls by the square of the angle between the normals.
const STEPS: usize = 12;
/// Steps end below this share of the first distance and of the coordinates' rounding.
const SETTLED: f64 = 1e-13;
/// Share of the coordinates that counts as first distance, too: [`SETTLED`] of it is their rounding.
const COORDINATES: f64 = 1e-3;

/// Least cosine between a panel's own normal and the direction in which it ends. A face that bends to a smaller radius than a panel
/// is away from it has normals at all angles to the panel's: on these it would end anywhere. With 0.5 a panel 13 mm beside a crest
/// of 9 mm radius ends more than 20 mm from where it should.
pub(crate) const LEAST_LEAN: f64 = 0.7;

/// Ruling and point in which the torse meets the line through `p` along `normal`, near the ruling `guess`. Where the face
/// has no normal (zero, at a pole), the foot of the perpendicular. `None` without a foot.
pub(crate) fn on_normal(p: &Vec3, normal: &Vec3, torse: &Torse, guess: f64) -> Option<(f64, Vec3)> {
    let mut t = torse.foot(p, guess)?;
    let first = torse.plane_distance(p, t);
    let foot = p - torse.ruling(t).normal * first;
    let Some(n) = normal.try_normalize(0.0) else { return Some((t, foot)) };
    let settled = SETTLED * (first.abs() + COORDINATES * p.amax());
    let mut x = *p;
    for _ in 0..STEPS {
        let across = n.dot(&torse.ruling(t).normal);
        let step = -torse.plane_distance(&x, t) / across;
        if !step.is_finite() {
            return Some((t, foot));
        }
        x += n * step;
        t = torse.foot(&x, t)?;
        if step.abs() <= settled {
            break;
        }
    }
    Some((t, x))
}

/// As [`on_normal`], with the line turned towards the torse's own normal at the foot of `p` as far as [`LEAST_LEAN`] asks.
pub(super) fn on_leaning(p: &Vec3, normal: &Vec3, torse: &Torse, guess: f64) -> Option<(f64, Vec3)> {
    let own = torse.ruling(torse.foot(p, guess)?).normal;
    let cosine = normal.try_normalize(0.0).map_or(1.0, |n| n.dot(&own));
    let across = (normal - own * normal.dot(&own)).try_normalize(0.0);
    match across.filter(|_| cosine.abs() < LEAST_LEAN) {
        Some(across) => {
            let turned = own * LEAST_LEAN.copysign(cosine) + across * (1.0 - LEAST_LEAN * LEAST_LEAN).sqrt();
            on_normal(p, &turned, torse, guess)
        }
        None => on_normal(p, normal, torse, guess),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::curve::Curve;
    use crate::torse::form::PrimalTorse;

    /// The plane z = 0.
    fn plane() -> Torse {
        let control = (0..4).map(|_| [0.0, 0.0]).collect();
        let profile =
            Curve::new(3, vec![-100., -100., -100., -100., 100., 100., 100., 100.], control).expect("profile");
        Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.0))
    }

    #[test]
    fn panels_end_on_normals_of_the_face_that_lean_by_no_more_than_45_degrees() {
        let p = Vec3::new(1.0, 2.0, 10.0);
        let ends = |x: f64, z: f64| on_leaning(&p, &Vec3::new(x, 0.0, z), &plane(), 0.0).expect("an end").1;
        // By 30°, either way round.
        for sign in [1.0, -1.0] {
            let end = ends(-0.5 * sign, sign * 0.75_f64.sqrt());
            assert!((end - Vec3::new(1.0 + 10.0 / 3.0_f64.sqrt(), 2.0, 0.0)).norm() < 1e-9, "{end}");
        }
        // By 84° and by more than a right angle.
        let way = 10.0 * (LEAST_LEAN.powi(-2) - 1.0).sqrt();
        assert!((ends(-10.0, 1.0) - Vec3::new(1.0 + way, 2.0, 0.0)).norm() < 1e-9);
        assert!((ends(-10.0, -1.0) - Vec3::new(1.0 - way, 2.0, 0.0)).norm() < 1e-9);
        // Without a normal.
        assert!((ends(0.0, 0.0) - Vec3::new(1.0, 2.0, 0.0)).norm() < 1e-12);
    }
}
