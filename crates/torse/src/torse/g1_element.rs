//! A ruling with its tangent plane, oriented: the datum from which developables are interpolated \[LP98\].

use crate::geom::Vec3;

/// Largest cosine between the forward direction and the ruling of a given element: further off they do not span a
/// plane of which one could say that it was meant as tangent plane.
const LARGEST_SKEW: f64 = 1e-6;

/// Why vectors do not make an element.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// A coordinate is not a finite number.
    #[error("the {0} of the element is not finite")]
    NotFinite(&'static str),
    /// A direction has no length.
    #[error("the {0} of the element has length zero; give a direction")]
    Zero(&'static str),
    /// The forward direction is not perpendicular to the ruling.
    #[error("the forward direction is not perpendicular to the ruling (cosine {cosine:e}, allowed {LARGEST_SKEW:e}); subtract its component along the ruling")]
    Skew {
        /// Cosine of the angle between both.
        cosine: f64,
    },
    /// The plane does not contain the ruling.
    #[error("the tangent plane does not contain its ruling (cosine of normal and ruling {cosine:e}, allowed {LARGEST_SKEW:e})")]
    PlaneMissesRuling {
        /// Cosine of the angle between normal and ruling.
        cosine: f64,
    },
}

/// A ruling with its tangent plane and the way on from there, as an orthonormal frame at a point of the ruling: what a
/// [`Ruling`](super::form::Ruling) does not tell.
///
/// `normal = direction × forward`. `point` lies in the used part of the ruling; `forward` points to the side of
/// increasing parameter *there* (beyond the singular point of the ruling it would point backwards).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct G1Element {
    /// A point of the ruling inside the used strip, mm.
    pub point: Vec3,
    /// Unit direction of the ruling, e; the same way for all elements of a surface.
    pub direction: Vec3,
    /// Unit vector of the tangent plane across the ruling, p.
    pub forward: Vec3,
    /// Unit normal of the tangent plane, n = e × p.
    pub normal: Vec3,
}

impl G1Element {
    /// Element from a point, a ruling direction and a forward direction; lengths are normalised and rounding of the
    /// right angle is removed.
    ///
    /// # Errors
    /// Vectors that are not finite or zero; a forward direction that is not perpendicular to the ruling.
    pub fn new(point: Vec3, direction: Vec3, forward: Vec3) -> Result<Self, ElementError> {
        finite(&point, "point")?;
        let e = unit(&direction, "ruling direction")?;
        let p = unit(&forward, "forward direction")?;
        let cosine = p.dot(&e);
        if cosine.abs() > LARGEST_SKEW {
            return Err(ElementError::Skew { cosine });
        }
        Ok(Self::of_perpendicular(point, e, p))
    }

    /// Element from a ruling and the normal of its plane; forward is normal × direction.
    ///
    /// # Errors
    /// Vectors that are not finite or zero; a plane that does not contain the ruling.
    pub fn of_plane(point: Vec3, direction: Vec3, normal: Vec3) -> Result<Self, ElementError> {
        finite(&point, "point")?;
        let e = unit(&direction, "ruling direction")?;
        let n = unit(&normal, "normal")?;
        let cosine = n.dot(&e);
        if cosine.abs() > LARGEST_SKEW {
            return Err(ElementError::PlaneMissesRuling { cosine });
        }
        Ok(Self::of_perpendicular(point, e, n.cross(&e)))
    }

    /// `e` is unit, `p` nearly perpendicular and nearly unit.
    fn of_perpendicular(point: Vec3, e: Vec3, p: Vec3) -> Self {
        let p = (p - e * p.dot(&e)).normalize();
        Self { point, direction: e, forward: p, normal: e.cross(&p) }
    }

    /// The same ruling passed in the opposite sense of the parameter: forward and normal turn over.
    pub fn reversed(&self) -> Self {
        Self { forward: -self.forward, normal: -self.normal, ..*self }
    }

    /// World components of a vector given in the frame (direction, forward, normal).
    pub fn to_world(&self, v: &Vec3) -> Vec3 {
        self.direction * v.x + self.forward * v.y + self.normal * v.z
    }

    /// Components of a world vector in the frame (direction, forward, normal).
    pub fn to_local(&self, v: &Vec3) -> Vec3 {
        Vec3::new(self.direction.dot(v), self.forward.dot(v), self.normal.dot(v))
    }

    /// The point at the signed distance `r` from `point` along the ruling.
    pub fn at(&self, r: f64) -> Vec3 {
        self.point + self.direction * r
    }

    /// How far two elements are from being the same ruling with the same tangent plane: the larger of the angle
    /// between the frames (rad) and the distance of the other's point from this ruling divided by `length`.
    pub fn mismatch(&self, other: &Self, length: f64) -> f64 {
        let d = other.point - self.point;
        let off = (d - self.direction * d.dot(&self.direction)).norm() / length;
        let turn = (self.direction - other.direction).norm().max((self.normal - other.normal).norm());
        off.max(turn)
    }
}

fn finite(v: &Vec3, what: &'static str) -> Result<(), ElementError> {
    if v.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(ElementError::NotFinite(what))
    }
}

fn unit(v: &Vec3, what: &'static str) -> Result<Vec3, ElementError> {
    finite(v, what)?;
    // Scaled first, so that neither huge nor tiny vectors lose their direction.
    let largest = v.amax();
    if largest == 0.0 {
        return Err(ElementError::Zero(what));
    }
    Ok((v / largest).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let g = G1Element::new(Vec3::zeros(), Vec3::new(0.0, 3e200, 0.0), Vec3::new(0.0, 1e-7, 2.0)).expect("element");
        assert!((g.direction.dot(&g.forward)).abs() < 1e-16 && (g.normal - Vec3::x()).norm() < 1e-15);
        let v = Vec3::new(0.3, -2.0, 5.0);
        assert!((g.to_world(&g.to_local(&v)) - v).norm() < 1e-14);
    }

    #[test]
    fn bad_elements_are_refused_with_the_reason() {
        let (o, x, y) = (Vec3::zeros(), Vec3::x(), Vec3::y());
        assert!(matches!(G1Element::new(o, x, x + y), Err(ElementError::Skew { .. })));
        assert!(matches!(G1Element::of_plane(o, x, x + y), Err(ElementError::PlaneMissesRuling { .. })));
        assert!(matches!(G1Element::new(o, Vec3::zeros(), y), Err(ElementError::Zero(_))));
        assert!(matches!(G1Element::new(Vec3::new(f64::NAN, 0.0, 0.0), x, y), Err(ElementError::NotFinite(_))));
    }
}
