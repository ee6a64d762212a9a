//! Placements: affine maps that put a part where its assembly wants it.

use super::{Frame, Vec3};
use nalgebra::Matrix3;

/// The map `x ↦ linear x + shift`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Rotation, possibly with uniform scale or reflection.
    pub linear: Matrix3<f64>,
    /// Translation, mm.
    pub shift: Vec3,
}

/// Share within which maps that came about on different ways are one.
const ROUNDING: f64 = 1e-9;

impl Placement {
    /// The map that moves nothing.
    pub fn identity() -> Self {
        Self { linear: Matrix3::identity(), shift: Vec3::zeros() }
    }

    /// The map that takes coordinates in the frame to world coordinates.
    pub fn of_frame(f: &Frame) -> Self {
        Self { linear: Matrix3::from_columns(&[f.x, f.y, f.z]), shift: f.origin }
    }

    /// The image of a point.
    pub fn point(&self, p: &Vec3) -> Vec3 {
        self.linear * p + self.shift
    }

    /// First `inner`, then `self`.
    pub fn after(&self, inner: &Self) -> Self {
        Self { linear: self.linear * inner.linear, shift: self.point(&inner.shift) }
    }

    /// The map back; `None` if there is none.
    pub fn inverse(&self) -> Option<Self> {
        let linear = self.linear.try_inverse()?;
        Some(Self { linear, shift: -(linear * self.shift) })
    }

    /// Factor by which lengths grow (the cube root of the volume factor).
    pub fn scale(&self) -> f64 {
        self.linear.determinant().abs().cbrt()
    }

    /// Whether another map is the same but for rounding.
    pub fn is_nearly(&self, other: &Self) -> bool {
        (self.linear - other.linear).norm() <= ROUNDING * self.linear.norm()
            && (self.shift - other.shift).norm() <= ROUNDING * (1.0 + self.shift.norm())
    }

    /// Whether left and right are exchanged.
    pub fn reflects(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_compose_and_invert() {
        let f = Frame { origin: Vec3::new(1.0, 2.0, 3.0), x: Vec3::y(), y: -Vec3::x(), z: Vec3::z() };
        let p = Placement::of_frame(&f);
        let x = Vec3::new(0.3, -0.2, 5.0);
        assert_eq!(p.point(&x), f.to_world(&x));
        let back = p.inverse().expect("a rotation").after(&p);
        assert!((back.point(&x) - x).norm() < 1e-14);
        assert!((p.scale() - 1.0).abs() < 1e-14 && !p.reflects());
    }
}
