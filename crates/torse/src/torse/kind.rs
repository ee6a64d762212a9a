//! Tangent planes along a developable, and runs of them with one shape: plane, cylinder, cone, tangent surface
//! (Proposition 1.12 of \[W15\]).

use super::form::PanelKind;
use super::strip::Strip;
use crate::geom::Vec3;

/// A tangent plane `n·X = h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentPlane {
    /// Normal; of unit length unless said otherwise.
    pub normal: Vec3,
    /// `h`, mm.
    pub offset: f64,
}

impl TangentPlane {
    /// The plane through a point.
    pub fn through(point: &Vec3, normal: Vec3) -> Self {
        Self { normal, offset: normal.dot(point) }
    }

    /// The tangent plane of a strip along its ruling at `u`, in the middle of the ruling where it is twisted. `None`
    /// where the ruling has no length or both rails run along it.
    pub fn of(strip: &Strip, u: f64) -> Option<Self> {
        let middle = strip.patch.jet(u, 0.5);
        let n = middle.normal().try_normalize(0.0)?;
        Some(Self::through(&middle.p, n))
    }
}

/// What the planes of a piece envelop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EnvelopeShape {
    /// They are one plane, the mean of all.
    Plane {
        /// The plane.
        plane: TangentPlane,
    },
    /// They are parallel to a line.
    Cylinder {
        /// Unit direction of the rulings.
        direction: Vec3,
    },
    /// They pass through a point.
    Cone {
        /// The point, mm.
        apex: Vec3,
    },
    /// None of these: tangents of a curve.
    Tangent,
}

impl EnvelopeShape {
    /// Lower-case name used in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Tangent => "tangent",
        }
    }

    /// The kind of a panel of this shape.
    pub fn kind(&self) -> PanelKind {
        match self {
            Self::Plane { .. } => PanelKind::Plane,
            Self::Cylinder { .. } => PanelKind::Cylinder,
            Self::Cone { .. } => PanelKind::Cone,
            Self::Tangent => PanelKind::Torse,
        }
    }
}

/// Successive planes of one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopePiece {
    /// First plane.
    pub first: usize,
    /// Behind the last plane.
    pub end: usize,
    /// What they envelop.
    pub shape: EnvelopeShape,
    /// Root mean square of what the shape leaves: angles in rad and distances by the size together. 0 for tangents.
    pub residual: f64,
    /// Whether another shape would be chosen if the noise were twice or half as great.
    pub ambiguous: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_of_a_bilinear_strip_touch_it_in_the_middle() {
        let x = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let strip = |z: f64| {
            Strip::quad("s", PanelKind::Plane, [x(0., 0., 1.), x(0., 2., 1.)], [x(3., 0., 1.), x(3., 2., z)])
                .expect("strip")
        };
        let t = TangentPlane::of(&strip(1.0), 0.3).expect("a plane");
        assert!((t.normal.z.abs() - 1.0).abs() < 1e-15 && (t.offset * t.normal.z - 1.0).abs() < 1e-15);
        let t = TangentPlane::of(&strip(2.0), 0.5).expect("a plane");
        assert!((t.normal.dot(&x(1.5, 1.0, 1.25)) - t.offset).abs() < 1e-15);
        assert_eq!(EnvelopeShape::Tangent.kind(), PanelKind::Torse);
    }
}
