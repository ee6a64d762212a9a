//! Places and frames drawn at random, for laws of this floor and of those above: in all directions, near the origin and far off.

use super::{Frame, Vec2, Vec3};
use proptest::prelude::*;

/// Numbers of all sizes between two powers of ten alike.
pub(crate) fn powers_of_ten(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> + Clone {
    exponents.prop_map(|e| 10f64.powf(e))
}

/// A vector of length 1 at most in each coordinate.
pub(crate) fn vector() -> impl Strategy<Value = Vec3> + Clone {
    [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(Vec3::from)
}

/// A vector of the plane with coordinates between −1 and 1.
pub(crate) fn flat_vector() -> impl Strategy<Value = Vec2> + Clone {
    [-1.0..1.0f64, -1.0..1.0].prop_map(Vec2::from)
}

/// A frame in any direction whose origin is up to `far` away.
pub(crate) fn frame(far: f64) -> impl Strategy<Value = Frame> + Clone {
    let turn = [-1.0..1.0f64, -1.0..1.0, -1.0..1.0, -1.0..1.0].prop_filter("no direction", |q| {
        let norm: f64 = q.iter().map(|x| x * x).sum();
        norm > 0.01
    });
    (turn, vector(), 0.0..1.0f64).prop_map(move |(q, at, share)| {
        let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
        let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()].map(|e| turn * e);
        // As often near the origin as far away.
        Frame { origin: at * (far * share.powi(4)), x, y, z }
    })
}
