//! Outlines laid onto outlines: first by area, centre and axes of inertia, then by the nearest points.

use crate::develop::unfold::region::Motion;
use crate::geom::outline::Outline;
use crate::geom::polygon::bounds;
use crate::geom::Vec2;
use nalgebra::Matrix2;

/// Share of the size below which places have been found.
const FOUND: f64 = 1e-13;

/// Area, centre and axes of polygons.
pub(super) struct Moments {
    /// Centre.
    pub centre: Vec2,
    /// Direction of the longer axis.
    pub angle: f64,
    /// Ratio of the moments about both axes.
    pub ratio: f64,
}

impl Moments {
    /// Of polygons, each counted with its weight.
    pub fn of(loops: &[Vec<Vec2>], weights: &[f64]) -> Self {
        let (lo, hi) = bounds(loops);
        let o = (lo + hi) * 0.5;
        let (mut a, mut first, mut second) = (0.0, Vec2::zeros(), Matrix2::zeros());
        for (l, w) in loops.iter().zip(weights) {
            for k in 0..l.len() {
                let (p, q) = (l[k] - o, l[(k + 1) % l.len()] - o);
                let twice = p.perp(&q) * w;
                a += twice / 2.0;
                first += (p + q) * (twice / 6.0);
                let s = p + q;
                second += (p * p.transpose() + q * q.transpose() + s * s.transpose()) * (twice / 24.0);
            }
        }
        let c = first / a;
        let m = second / a - c * c.transpose();
        let (half, diff) = (0.5 * (m[(0, 0)] + m[(1, 1)]), (0.5 * (m[(0, 0)] - m[(1, 1)])).hypot(m[(0, 1)]));
        Self {
            centre: o + c,
            angle: 0.5 * (2.0 * m[(0, 1)]).atan2(m[(0, 0)] - m[(1, 1)]),
            ratio: (half + diff) / (half - diff).max(f64::MIN_POSITIVE),
        }
    }
}

/// Moves an outline until given points lie on its sides as nearly as they can: the motion, and the root mean square of what
/// is left.
pub(super) fn settled(outline: &Outline, start: Motion, points: &[Vec<Vec2>], rounds: usize) -> (Motion, f64) {
    let mut motion = start;
    let mut left = f64::INFINITY;
    for _ in 0..rounds {
        // Normal equations of a small turn and move: points may slide along the sides.
        let mut normal = nalgebra::Matrix3::zeros();
        let mut right = nalgebra::Vector3::zeros();
        let (mut sum, mut count) = (0.0, 0.0);
        for x in points.iter().flatten() {
            let own = motion.back(x);
            let Some(([from, to], on)) = outline.nearest(&own) else { continue };
            let (off, along) = (own - on, to - from);
            let n = off.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(|| Vec2::new(-along.y, along.x) / along.norm());
            let row = nalgebra::Vector3::new(n.x, n.y, own.perp(&n));
            normal += row * row.transpose();
            right += row * off.dot(&n);
            sum += off.norm_squared();
            count += 1.0;
        }
        left = (sum / f64::max(count, 1.0)).sqrt();
        let Some(step) =
            (normal + nalgebra::Matrix3::identity() * (f64::EPSILON * normal.trace())).try_inverse().map(|i| i * right)
        else {
            break;
        };
        // The polygons move by the step: own points come nearer by moving the other way.
        let (s, c) = step.z.sin_cos();
        let inner = Motion { turn: [c, s], shift: Vec2::new(step.x, step.y) };
        let turn = [motion.turn[0] * c - motion.turn[1] * s, motion.turn[1] * c + motion.turn[0] * s];
        motion = Motion { turn, shift: motion.apply(&inner.shift) };
        if step.norm() < FOUND {
            break;
        }
    }
    (motion, left)
}

/// The motion that brings the first points of pairs onto the second; `None` for fewer than two.
pub(super) fn fitted(pairs: &[(Vec2, Vec2)]) -> Option<Motion> {
    if pairs.len() < 2 {
        return None;
    }
    let n = pairs.len() as f64;
    let a = pairs.iter().map(|p| p.0).sum::<Vec2>() / n;
    let b = pairs.iter().map(|p| p.1).sum::<Vec2>() / n;
    let (mut c, mut s) = (0.0, 0.0);
    for (p, q) in pairs {
        c += (p - a).dot(&(q - b));
        s += (p - a).perp(&(q - b));
    }
    let norm = c.hypot(s);
    if norm.is_nan() || norm <= 0.0 {
        return None;
    }
    let turn = [c / norm, s / norm];
    let only = Motion { turn, shift: Vec2::zeros() };
    Some(Motion { turn, shift: b - only.apply(&a) })
}
