//! The profile of a cylinder, and the plane that touches the cylinder along a ruling.

use super::cubic::Cubic;
use super::Plane;
use crate::certify::vector::{add, scale, sub, V3};
use crate::num::bernstein::Scalar;

/// The profile of a cylinder at one parameter, or over some: point, unit tangent, speed r and turn ω.
pub(super) struct Profile<S> {
    pub(super) point: [S; 2],
    pub(super) tangent: [S; 2],
    pub(super) speed: S,
    pub(super) turn: S,
}

impl<S: Scalar> Profile<S> {
    #[inline]
    pub(super) fn at(x: &Cubic<S>, z: &Cubic<S>, at: S) -> Self {
        let ([px, tx, bx], [pz, tz, bz]) = (x.at(at), z.at(at));
        let square = tx * tx + tz * tz;
        let speed = square.square_root();
        Self {
            point: [px, pz],
            tangent: [tx.over(speed), tz.over(speed)],
            speed,
            turn: (tx * bz - tz * bx).over(square),
        }
    }

    #[inline]
    pub(super) fn normal(&self, axes: &[V3<S>; 3]) -> V3<S> {
        sub(&scale(&axes[2], self.tangent[0]), &scale(&axes[0], self.tangent[1]))
    }

    /// n the unit normal, m the unit tangent backwards: `n' = ω m`, `m' = −ω n`.
    #[inline]
    pub(super) fn plane(&self, axes: &[V3<S>; 3]) -> Plane<S> {
        let ([x, z], [ex, ez]) = (self.point, self.tangent);
        let n = self.normal(axes);
        let h = ex * z - ez * x;
        let (zero, one) = (S::from(0.0), S::from(1.0));
        Plane {
            n,
            m: scale(&add(&scale(&axes[0], ex), &scale(&axes[2], ez)), -one),
            dm: scale(&n, -self.turn),
            sigma: self.turn,
            nn: one,
            nm: zero,
            mm: one,
            ndm: -self.turn,
            h,
            k: -(ex * x + ez * z),
            dk: -(self.turn * h + self.speed),
        }
    }
}
