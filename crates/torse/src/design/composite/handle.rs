//! Handles: what is held or pulled, where, and how strongly.

use crate::geom::Vec3;

/// A place on a boundary curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Name of the curve.
    pub curve: String,
    /// Parameter on the scale of its knots.
    pub u: f64,
}

/// What a handle holds to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hold {
    /// The place lies at a point, mm.
    Point(Vec3),
    /// The curve runs along a direction there. What is held is the line: a curve that begins by running along it backwards
    /// goes on to, and a judge must look.
    Tangent(Vec3),
    /// The place lies in a plane.
    Plane {
        /// A point of the plane, mm.
        point: Vec3,
        /// Its normal.
        normal: Vec3,
    },
}

impl Hold {
    /// Word for messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Point(_) => "point",
            Self::Tangent(_) => "tangent",
            Self::Plane { .. } => "plane",
        }
    }
}

/// How strongly a handle holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Strength {
    /// Exactly, like developability itself.
    Exact,
    /// With a weight that fades within a solve, so that developability wins: what can not be reached is neared.
    Pull(f64),
}

/// A handle.
#[derive(Clone, Debug, PartialEq)]
pub struct Handle {
    /// Where.
    pub place: Place,
    /// To what.
    pub hold: Hold,
    /// How strongly.
    pub strength: Strength,
}

impl Handle {
    /// A place held exactly at a point.
    pub fn point(curve: &str, u: f64, at: Vec3) -> Self {
        Self { place: Place { curve: curve.into(), u }, hold: Hold::Point(at), strength: Strength::Exact }
    }
}
