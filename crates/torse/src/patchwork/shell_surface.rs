//! The surface of a face of a shell: what a file may hold, planes, circular cylinders and circular cones by their measures and
//! everything else as a B-spline patch or at a distance from one.

use crate::geom::Frame;
use crate::spline::surface::Surface;
use crate::torse::form::PanelKind;

/// Surface of a face.
#[derive(Clone, Debug)]
pub enum ShellSurface {
    /// The plane z = 0 of the frame.
    Plane(Frame),
    /// Cylinder about the frame's z-axis.
    Cylinder {
        /// Axis z; angles from x.
        frame: Frame,
        /// Radius, mm.
        radius: f64,
    },
    /// Cone about the frame's z-axis, widening along z.
    Cone {
        /// Axis z; angles from x.
        frame: Frame,
        /// Radius at z = 0, mm.
        radius: f64,
        /// Angle between axis and rulings, rad.
        half_angle: f64,
    },
    /// B-spline surface.
    Spline {
        /// The surface.
        surface: Surface,
        /// What it is, for readers that care.
        form: SurfaceForm,
    },
    /// The surface at a distance from a B-spline surface.
    Offset {
        /// The surface.
        surface: Surface,
        /// What it is, for readers that care.
        form: SurfaceForm,
        /// The distance, mm, on the side of ∂u × ∂v.
        distance: f64,
    },
}

/// The hint `surface_form` of a B-spline surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceForm {
    /// Plane.
    Plane,
    /// Cylinder over any curve.
    Extrusion,
    /// Cone over any curve.
    Cone,
    /// Other ruled surface.
    Ruled,
    /// Freeform.
    Unspecified,
}

impl From<PanelKind> for SurfaceForm {
    fn from(kind: PanelKind) -> Self {
        match kind {
            PanelKind::Plane => Self::Plane,
            PanelKind::Cylinder => Self::Extrusion,
            PanelKind::Cone => Self::Cone,
            PanelKind::Torse | PanelKind::Ruled => Self::Ruled,
        }
    }
}
