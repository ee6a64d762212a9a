//! Vectors of numbers or intervals: dot and cross products for the proofs of this floor.

use crate::geom::Vec3;
use crate::num::bernstein::Scalar;
use crate::num::interval::Interval;

/// Three components.
pub(super) type V3<S> = [S; 3];

/// Exact copy of a vector of numbers.
#[inline]
pub(super) fn exact<S: Scalar>(v: &Vec3) -> V3<S> {
    [S::from(v.x), S::from(v.y), S::from(v.z)]
}

#[inline]
pub(super) fn dot<S: Scalar>(a: &V3<S>, b: &V3<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(super) fn cross<S: Scalar>(a: &V3<S>, b: &V3<S>) -> V3<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub(super) fn scale<S: Scalar>(a: &V3<S>, k: S) -> V3<S> {
    [a[0] * k, a[1] * k, a[2] * k]
}

#[inline]
pub(super) fn add<S: Scalar>(a: &V3<S>, b: &V3<S>) -> V3<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(super) fn sub<S: Scalar>(a: &V3<S>, b: &V3<S>) -> V3<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Length of an interval vector, with squares taken tightly.
#[inline]
pub(super) fn length(a: &V3<Interval>) -> Interval {
    (a[0].sqr() + a[1].sqr() + a[2].sqr()).sqrt()
}

/// Upper bound of the length.
#[inline]
pub(super) fn length_bound(a: &V3<Interval>) -> f64 {
    length(a).hi
}

/// Middles of the components.
#[inline]
pub(super) fn mid(a: &V3<Interval>) -> V3<f64> {
    [a[0].mid(), a[1].mid(), a[2].mid()]
}

/// Upper bound of the distance of a member from [`mid`].
#[inline]
pub(super) fn rad(a: &V3<Interval>) -> f64 {
    a[0].rad() + a[1].rad() + a[2].rad()
}

/// Component-wise hull.
#[inline]
pub(super) fn hull(a: &V3<Interval>, b: &V3<Interval>) -> V3<Interval> {
    [a[0].hull(b[0]), a[1].hull(b[1]), a[2].hull(b[2])]
}
