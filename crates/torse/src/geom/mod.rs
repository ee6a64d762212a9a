//! Floor 1: points, frames, boxes. Vectors are nalgebra's behind aliases; lengths are in millimetres.

use nalgebra as na;

pub(crate) mod box_tree;
pub mod cloud;
pub mod coarse;
pub(crate) mod convex_hull;
#[cfg(test)]
pub(crate) mod generated;
pub(crate) mod inside;
pub mod measure;
pub mod mesh;
pub(crate) mod outline;
pub(crate) mod outward;
pub mod placement;
pub(crate) mod polygon;
pub(crate) mod rectangle;
pub(crate) mod segment;
pub mod unit;

/// A point or vector of space, in millimetres.
pub type Vec3 = na::Vector3<f64>;
/// A point or vector of a plane.
pub type Vec2 = na::Vector2<f64>;

/// A right-handed orthonormal frame (up to rounding).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Origin.
    pub origin: Vec3,
    /// First axis, unit length.
    pub x: Vec3,
    /// Second axis, unit length.
    pub y: Vec3,
    /// Third axis, unit length.
    pub z: Vec3,
}

impl Frame {
    /// The frame of the world.
    pub fn world() -> Self {
        Self { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() }
    }

    /// Coordinates of the world point `p` in this frame.
    pub fn to_local(&self, p: &Vec3) -> Vec3 {
        self.vector_to_local(&(p - self.origin))
    }

    /// The world point with the coordinates `q` in this frame.
    pub fn to_world(&self, q: &Vec3) -> Vec3 {
        self.origin + self.vector_to_world(q)
    }

    /// Components of a world vector in this frame.
    pub fn vector_to_local(&self, v: &Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// The world vector with the given components.
    pub fn vector_to_world(&self, v: &Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

/// An axis-parallel box of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BBox {
    /// Smallest coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
}

impl BBox {
    /// The box that contains nothing.
    pub fn empty() -> Self {
        Self { min: Vec3::repeat(f64::INFINITY), max: Vec3::repeat(f64::NEG_INFINITY) }
    }

    /// The smallest box around points.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Vec3>) -> Self {
        let mut b = Self::empty();
        for p in points {
            b.include(p);
        }
        b
    }

    /// Enlarges the box to contain `p`.
    pub fn include(&mut self, p: &Vec3) {
        self.min = self.min.inf(p);
        self.max = self.max.sup(p);
    }

    /// The box around points of the plane, at height 0.
    pub fn of_flat<'a>(points: impl IntoIterator<Item = &'a Vec2>) -> Self {
        let mut out = Self::empty();
        points.into_iter().for_each(|p| out.include(&Vec3::new(p.x, p.y, 0.0)));
        out
    }

    /// Whether it has a point in common with another one.
    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|d| self.min[d] <= other.max[d] && other.min[d] <= self.max[d])
    }

    /// Length of the diagonal; 0 for an empty box.
    pub fn diagonal(&self) -> f64 {
        let d = self.max - self.min;
        if d.x >= 0.0 {
            d.norm()
        } else {
            0.0
        }
    }

    /// Centre of the box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }
}

/// A place in words, with as many digits as tell it from its surroundings: (1203.4, −20.0, 88.1) mm.
pub(crate) fn place_in_words(x: &Vec3) -> String {
    let digits = match x.amax() {
        m if m >= 10.0 => 1,
        m if m >= 0.1 => 3,
        _ => 6,
    };
    format!("({:.digits$}, {:.digits$}, {:.digits$}) mm", x.x, x.y, x.z)
}
