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
