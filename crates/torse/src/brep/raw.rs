//! Faces as files describe them: a support surface and oriented boundary curves of space, before they are trimmed.

use super::space_curve::{Arc, SpaceCurve};
use super::support_surface::SupportSurface;
use crate::geom::Vec3;

/// How far a surface that was read is from that of its file, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SurfaceDeviation {
    /// As seen at samples.
    pub estimate: f64,
    /// As proven; infinite where nothing is.
    pub bound: f64,
}

impl SurfaceDeviation {
    /// Of a surface that is the file's.
    pub const NONE: Self = Self { estimate: 0.0, bound: 0.0 };

    /// Of one of which nothing is proven.
    pub(crate) fn seen(estimate: f64) -> Self {
        Self { estimate, bound: if estimate == 0.0 { 0.0 } else { f64::INFINITY } }
    }

    /// Of one that is off by no more than `bound`.
    pub(crate) fn proven(bound: f64) -> Self {
        Self { estimate: bound, bound }
    }

    /// Of the offset of a surface, which is off from its exact offset by `self`. Of offsets of what is off itself nothing is
    /// known: their normals differ.
    pub(crate) fn over(self, base: Self) -> Self {
        let bound = if base.bound == 0.0 { self.bound } else { f64::INFINITY };
        Self { estimate: self.estimate + base.estimate, bound }
    }

    /// The worse of both.
    pub(crate) fn max(self, o: Self) -> Self {
        Self { estimate: self.estimate.max(o.estimate), bound: self.bound.max(o.bound) }
    }

    /// Of a surface that is farther off by no more than `bound`.
    pub(crate) fn plus(self, bound: f64) -> Self {
        Self { estimate: self.estimate + bound, bound: self.bound + bound }
    }

    /// In another unit.
    pub(crate) fn scaled(self, by: f64) -> Self {
        Self { estimate: self.estimate * by, bound: self.bound * by }
    }
}

/// A face as files describe it: a support and oriented boundary curves of space.
#[derive(Clone, Debug)]
pub(crate) struct RawFace {
    /// Number of the entity in the file.
    pub entity: u64,
    /// Name in the file.
    pub name: String,
    /// Name of the part.
    pub part: String,
    /// What the file calls the surface.
    pub kind: SurfaceKind,
    /// The surface.
    pub support: SupportSurface,
    /// Whether the face's normal is that of the support.
    pub same_sense: bool,
    /// The part of the support that is the face.
    pub region: RawRegion,
    /// How far `support` is from the file's surface.
    pub surface_deviation: SurfaceDeviation,
    /// Distance (mm) below which the file calls points the same; 0 if it does not say.
    pub uncertainty: f64,
}

/// Which part of a support belongs to a face.
#[derive(Clone, Debug)]
pub(crate) enum RawRegion {
    /// All of a bounded or closed surface.
    Whole,
    /// A rectangle of natural parameters, each from low to high.
    Rectangle([(f64, f64); 2]),
    /// Inside boundary loops.
    Loops(Vec<RawLoop>),
}

/// A closed chain of edges, material on the left seen against the face's normal.
#[derive(Clone, Debug, Default)]
pub(crate) struct RawLoop {
    /// Edges in order.
    pub edges: Vec<RawEdge>,
    /// Whether the file calls it the outer one and its sense is not to be relied on.
    pub outer: bool,
}

/// One edge in the direction of its loop.
#[derive(Clone, Debug)]
pub(crate) struct RawEdge {
    /// Number of the edge in the file.
    pub entity: u64,
    /// Whether the loop uses the edge in its own direction.
    pub forward: bool,
    /// The pieces of its curve in the direction of the loop.
    pub path: Vec<Arc>,
    /// Where the file's vertices put its ends, in the direction of the loop; `None` if it has none.
    pub vertices: Option<[Vec3; 2]>,
    /// The same curve in the parameter plane of the support, if the file gives it and the path is one piece. It is
    /// used where it proves to agree with the curve in space.
    pub trace: Option<PlaneTrace>,
}

/// A curve in the parameter plane, with the parameter of the curve in space that it belongs to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlaneTrace {
    /// The curve; third coordinate 0.
    pub curve: SpaceCurve,
    /// Factors from its coordinates to natural parameters of the support.
    pub scale: [f64; 2],
}

impl PlaneTrace {
    /// Natural parameters at `t`.
    pub(super) fn at(&self, t: f64) -> [f64; 2] {
        let q = self.curve.point(t);
        [q.x * self.scale[0], q.y * self.scale[1]]
    }
}

impl RawEdge {
    /// The edge run the other way.
    pub(crate) fn reversed(&self) -> Self {
        Self {
            entity: self.entity,
            forward: !self.forward,
            path: self.path.iter().rev().map(Arc::reversed).collect(),
            vertices: self.vertices.map(|[p, q]| [q, p]),
            trace: self.trace.clone(),
        }
    }
}

impl RawLoop {
    /// The loop run the other way.
    pub(crate) fn reversed(&self) -> Self {
        Self { edges: self.edges.iter().rev().map(RawEdge::reversed).collect(), outer: self.outer }
    }
}

/// What the face's surface was called in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SurfaceKind {
    /// Plane.
    Plane,
    /// Right circular cylinder.
    Cylinder,
    /// Right circular cone.
    Cone,
    /// Sphere.
    Sphere,
    /// Torus.
    Torus,
    /// Linear extrusion of a curve.
    Extrusion,
    /// Surface of revolution.
    Revolution,
    /// Offset of another surface.
    Offset,
    /// Polynomial or rational B-spline or Bézier surface.
    Spline,
}

impl SurfaceKind {
    /// Lower-case name used in reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Cylinder => "cylinder",
            Self::Cone => "cone",
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Extrusion => "extrusion",
            Self::Revolution => "revolution",
            Self::Offset => "offset",
            Self::Spline => "spline",
        }
    }
}
