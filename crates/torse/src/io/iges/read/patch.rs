//! Surfaces with what their entities say of them.

use crate::brep::raw::{RawLoop, SurfaceDeviation, SurfaceKind};
use crate::brep::recast;
use crate::brep::space_curve::SpaceCurve;
use crate::brep::support_surface::SupportSurface;
use crate::geom::Frame;

/// A surface with what its entity says beyond the support.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// The surface, without the transformation of its own entity.
    pub support: SupportSurface,
    /// Kind for people.
    pub kind: SurfaceKind,
    /// Whether its normal is that of the support.
    pub same_sense: bool,
    /// Rectangle of natural parameters, if the entity bounds it.
    pub rectangle: Option<[(f64, f64); 2]>,
    /// Distance from the file's surface where the support is an approximation.
    pub deviation: SurfaceDeviation,
    /// How the parameters of the file become natural ones; `None` where curves in its parameter plane cannot be used.
    pub chart: Option<Chart>,
    /// The elementary surface that it is too, with other parameters.
    pub round: Option<(SupportSurface, SurfaceKind)>,
    /// The surface that it is where its entity does not tell of an offset on which side it lies, and its edges lie there.
    pub other: Option<(SupportSurface, SurfaceDeviation)>,
}

/// The map `natural[k] = scale[k] · stated + shift[k]`, of the other stated parameter if they are exchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chart {
    /// Whether the file's first parameter is our second.
    pub exchanged: bool,
    /// Factors.
    pub scale: [f64; 2],
    /// Terms.
    pub shift: [f64; 2],
}

impl Chart {
    /// Natural parameters as stated.
    pub const SAME: Self = Self { exchanged: false, scale: [1.0; 2], shift: [0.0; 2] };
    /// Radians per degree.
    pub const DEGREES: f64 = std::f64::consts::PI / 180.0;

    /// Natural parameters as stated, times factors.
    pub fn scaled(scale: [f64; 2]) -> Option<Self> {
        Some(Self { scale, ..Self::SAME })
    }
}

impl Patch {
    /// The patch on the elementary surface that a turned line or arc is: feet are known there. The parameters of the
    /// file are lost, so this is for faces that are bounded by curves of space.
    pub fn simplified(self) -> Self {
        let Some((support, kind)) = self.round.clone() else { return self };
        let Some(rectangle) = self.rectangle else { return self };
        // A place that is no pole.
        let at = rectangle.map(|(a, b)| a + PROBE * (b - a));
        let old = self.support.jet(at);
        let new = support.jet(support.foot(&old.p, None));
        let agree = old.du.cross(&old.dv).dot(&new.du.cross(&new.dv)) >= 0.0;
        Self { support, kind, same_sense: self.same_sense == agree, rectangle: None, chart: None, round: None, ..self }
    }

    /// A surface that is its support.
    pub fn exact(support: SupportSurface, kind: SurfaceKind) -> Self {
        Self {
            support,
            kind,
            same_sense: true,
            rectangle: None,
            deviation: SurfaceDeviation::NONE,
            chart: Some(Chart::SAME),
            round: None,
            other: None,
        }
    }

    /// The patch on the side on which its edges begin and end.
    pub fn beside(self, loops: &[RawLoop]) -> Self {
        let Some((support, deviation)) = self.other.clone() else { return self };
        let ends = || loops.iter().flat_map(|l| &l.edges).flat_map(|e| &e.path).map(|arc| arc.ends().0);
        let off = |s: &SupportSurface| ends().map(|x| (s.jet(s.foot(&x, None)).p - x).norm()).sum::<f64>();
        if off(&support) < off(&self.support) {
            Self { support, deviation, other: None, ..self }
        } else {
            self
        }
    }
}

/// Share of a surface's sides at which the normals of two forms are compared.
const PROBE: f64 = 0.4;

/// Centres this near to an axis, as a share of the radius, are on it.
const ON_AXIS: f64 = 1e-9;

/// The plane, cylinder, cone, torus or sphere that a turned line or arc is.
pub(super) fn round(sweep: &SupportSurface) -> Option<(SupportSurface, SurfaceKind)> {
    let SupportSurface::Revolution { directrix, frame } = sweep else { return None };
    if let Some((support, _)) = recast::elementary(sweep) {
        let kind = match &support {
            SupportSurface::Cylinder { .. } => SurfaceKind::Cylinder,
            SupportSurface::Cone { .. } => SurfaceKind::Cone,
            _ => SurfaceKind::Torus,
        };
        return Some((support, kind));
    }
    match directrix {
        SpaceCurve::Line { origin, direction } => {
            let level = frame.z.dot(direction).abs() <= ON_AXIS * direction.norm();
            let origin = frame.origin + frame.z * frame.to_local(origin).z;
            level.then_some((SupportSurface::Plane(Frame { origin, ..*frame }), SurfaceKind::Plane))
        }
        SpaceCurve::Ellipse { frame: own, a, b } => {
            let (centre, normal) = (frame.to_local(&own.origin), frame.vector_to_local(&own.z));
            let centred = centre.x.hypot(centre.y) <= ON_AXIS * a && normal.z.abs() <= ON_AXIS;
            ((a - b).abs() <= ON_AXIS * a && centred).then(|| {
                let origin = frame.origin + frame.z * centre.z;
                (SupportSurface::Sphere { frame: Frame { origin, ..*frame }, radius: *a }, SurfaceKind::Sphere)
            })
        }
        _ => None,
    }
}
