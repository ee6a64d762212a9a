//! The profile of a cylinder, its unit tangent and how that turns.

use super::cubic::Cubic;
use crate::certify::vector::{scale, sub, V3};
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
}
