//! Given surfaces that places are held near: faces, meshes, point clouds.

mod face;
mod points;

pub(crate) use face::FaceReference;
pub(crate) use points::PointReference;

use crate::geom::Vec3;

/// The nearest point of a reference and its neighbourhood; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// The nearest point.
    pub point: Vec3,
    /// Unit normal there.
    pub normal: Vec3,
    /// Principal directions, unit, at right angles to the normal and to each other.
    pub directions: [Vec3; 2],
    /// Curvatures in these directions, positive where the surface bends towards the normal; zero where they are not known.
    pub curvatures: [f64; 2],
    /// Parameters, for faces: where the next search begins.
    pub at: [f64; 2],
    /// Index of the face, triangle or point.
    pub of: usize,
}

/// Something that has nearest points.
pub trait Reference: Send + Sync {
    /// The nearest point to `x` (mm); `near` is what was found for a place nearby. `None` where there is none.
    fn foot(&self, x: &Vec3, near: Option<&Foot>) -> Option<Foot>;

    /// Which of these places (mm) have something of the reference to be near to; all of them, but where a reference ends
    /// before the places do and says nothing of what is beyond.
    fn meets(&self, places: &[Vec3]) -> Vec<bool> {
        vec![true; places.len()]
    }
}

/// Principal directions and curvatures from the second fundamental form `[[l, m], [m, n]]` in an orthonormal frame.
pub(super) fn principal(l: f64, m: f64, n: f64, e: [Vec3; 2]) -> ([Vec3; 2], [f64; 2]) {
    let angle = 0.5 * (2.0 * m).atan2(l - n);
    let (s, c) = angle.sin_cos();
    let k = [l * c * c + 2.0 * m * s * c + n * s * s, l * s * s - 2.0 * m * s * c + n * c * c];
    ([e[0] * c + e[1] * s, e[1] * c - e[0] * s], k)
}
