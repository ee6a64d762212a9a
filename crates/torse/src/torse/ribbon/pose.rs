//! A ruling with the sheet beside it as a frame in space, and frames that move evenly.
//!
//! *Method*. Along a developable, the frame of ruling e, direction across b and normal n moves by e' = φ' b,
//! b' = −φ' e + κ n, n' = −κ b: the spin φ' is the same in space and in the plane, the turn κ is 0 in the plane \[DC76\]. With
//! constant rates the motion is a screw in closed form, and the sheet is a piece of a plane, a circular cylinder or a
//! circular cone.

use crate::geom::{Vec2, Vec3};
use nalgebra::Matrix3;

/// A frame: where a point of a ruling is, and the axes ruling, across, normal towards the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Columns: unit vectors along the ruling, across it in the sheet, and square to the sheet.
    pub axes: Matrix3<f64>,
    /// A point of the ruling, mm.
    pub at: Vec3,
}

/// Rates at which a frame moves, over a parameter that runs from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Turn of the tangent plane about the ruling, towards the eye, rad.
    pub turn: f64,
    /// Turn of the ruling within the sheet, rad.
    pub spin: f64,
    /// Way along the ruling, mm.
    pub along: f64,
    /// Way across the ruling, mm.
    pub across: f64,
}

/// Angle (rad) below which the series of sine and cosine are exact to the last bit that counts.
const SMALL: f64 = 1e-3;

impl Pose {
    /// The ruling through a point of the plane z = 0 with a unit direction in it, seen from z > 0.
    pub fn flat(at: Vec2, way: Vec2) -> Self {
        let (e, b) = (Vec3::new(way.x, way.y, 0.0), Vec3::new(-way.y, way.x, 0.0));
        Self { axes: Matrix3::from_columns(&[e, b, Vec3::z()]), at: Vec3::new(at.x, at.y, 0.0) }
    }

    /// The point at coordinates along the ruling and across it.
    pub fn point(&self, along: f64, across: f64) -> Vec3 {
        self.at + self.axes.column(0) * along + self.axes.column(1) * across
    }

    /// Unit vector along the ruling.
    pub fn ruling(&self) -> Vec3 {
        self.axes.column(0).into()
    }

    /// Unit vector across the ruling.
    pub fn across(&self) -> Vec3 {
        self.axes.column(1).into()
    }

    /// Unit normal towards the eye.
    pub fn normal(&self) -> Vec3 {
        self.axes.column(2).into()
    }

    /// The frame after moving at constant rates for the share `s`.
    pub fn moved(&self, rates: &Rates, s: f64) -> Self {
        let (x, z) = (rates.turn * s, rates.spin * s);
        let v = Vec3::new(rates.along * s, rates.across * s, 0.0);
        let angle = x.hypot(z);
        let (a, b, c) = if angle < SMALL {
            let q = angle * angle;
            (
                1.0 - q / 6.0 * (1.0 - q / 20.0),
                0.5 - q / 24.0 * (1.0 - q / 30.0),
                1.0 / 6.0 - q / 120.0 * (1.0 - q / 42.0),
            )
        } else {
            let (sin, cos) = angle.sin_cos();
            (sin / angle, (1.0 - cos) / (angle * angle), (angle - sin) / angle.powi(3))
        };
        // The axis of the motion is (turn, 0, spin) in the frame itself.
        let w = Matrix3::new(0.0, -z, 0.0, z, 0.0, -x, 0.0, x, 0.0);
        let ww = w * w;
        let (turned, moved) = (Matrix3::identity() + w * a + ww * b, Matrix3::identity() + w * b + ww * c);
        Self { axes: self.axes * turned, at: self.at + self.axes * (moved * v) }
    }

    /// The rates without turn that bring this frame of the plane to another one; both lie in z = 0.
    pub fn flat_rates_to(&self, other: &Self) -> Rates {
        let (e, f) = (self.ruling(), other.ruling());
        let spin = (e.x * f.y - e.y * f.x).atan2(e.dot(&f));
        let way = other.at - self.at;
        let (x, y) = (way.dot(&e), way.dot(&self.across()));
        // The inverse of the integral of the turning axes.
        let half = 0.5 * spin;
        let k = if half.abs() < SMALL { 1.0 - half * half / 3.0 } else { half / half.tan() };
        Rates { turn: 0.0, spin, along: k * x + half * y, across: k * y - half * x }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_motion_in_the_plane_is_found_again() {
        for (angle, x, y) in [(0.7, 3.0, -2.0), (-1.3, 0.5, 4.0), (1e-9, 1.0, 1.0)] {
            let a = Pose::flat(Vec2::new(1.0, 2.0), Vec2::new(0.6, 0.8));
            let (s, c) = (0.3f64 + angle).sin_cos();
            let (t, u) = (0.3f64.sin(), 0.3f64.cos());
            let first = Pose::flat(a.at.xy(), Vec2::new(u, t));
            let b = Pose::flat(Vec2::new(1.0 + x, 2.0 + y), Vec2::new(c, s));
            let moved = first.moved(&first.flat_rates_to(&b), 1.0);
            assert!((moved.at - b.at).norm() < 1e-12 && (moved.axes - b.axes).norm() < 1e-12);
        }
    }

    #[test]
    fn a_quarter_turn_of_a_cylinder_ends_where_its_arc_ends() {
        let r = 10.0;
        let rates =
            Rates { turn: std::f64::consts::FRAC_PI_2, across: r * std::f64::consts::FRAC_PI_2, ..Rates::default() };
        let end = Pose::flat(Vec2::zeros(), Vec2::x()).moved(&rates, 1.0);
        assert!((end.at - Vec3::new(0.0, r, r)).norm() < 1e-12, "{}", end.at);
        assert!((end.normal() + Vec3::y()).norm() < 1e-12);
    }

    #[test]
    fn small_and_large_angles_agree() {
        let start = Pose::flat(Vec2::new(1.0, 1.0), Vec2::x());
        let rates = Rates { turn: 0.8, spin: -0.5, along: 2.0, across: 7.0 };
        let mut step = start;
        for _ in 0..4096 {
            step = step.moved(&rates, 1.0 / 4096.0);
        }
        assert!((step.at - start.moved(&rates, 1.0).at).norm() < 1e-10);
    }
}
