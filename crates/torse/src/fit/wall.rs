//! Where a torse meets the normals of the face along its boundary: panels trimmed there meet in common end points,
//! whatever their distances from the face are.
//!
//! *Method*: Newton steps along the normal, each from the distance to the tangent plane at the foot (the certificate's
//! foot, \[SE06\] carried on).

use crate::geom::Vec3;
use crate::spline::surface::Surface;
use crate::surface::torse::Torse;

/// Steps along the normal; the distance falls by the square of the angle between the normals.
const STEPS: usize = 12;
/// Steps end below this share of the first distance and of the coordinates' rounding.
const SETTLED: f64 = 1e-13;

/// Ruling and point in which the torse meets the face's normal at `uv`, near the ruling `guess`. At a pole, where the
/// face has no normal, the foot of the perpendicular. `None` without a foot.
pub(super) fn on_normal(surface: &Surface, torse: &Torse, uv: [f64; 2], guess: f64) -> Option<(f64, Vec3)> {
    let j = surface.jet(uv[0], uv[1]);
    let normal = j.normal();
    let mut t = torse.foot(&j.p, guess)?;
    let first = torse.plane_distance(&j.p, t);
    let foot = j.p - torse.ruling(t).normal * first;
    if normal.norm() <= 0.0 {
        return Some((t, foot));
    }
    let n = normal.normalize();
    let settled = SETTLED * (first.abs() + 1e-3 * j.p.amax());
    let mut x = j.p;
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
