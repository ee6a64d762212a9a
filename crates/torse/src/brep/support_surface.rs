//! Surfaces as CAD files hold them, with their natural parameters: nearest points, periods, poles, exact B-splines.
//!
//! Natural parameters follow ISO 10303-42: lengths in mm, angles in radians, and every support is oriented so that
//! `S_u × S_v` is the normal of that standard.

use super::parameter_map::ParameterMap;
use super::project::{self, SurfaceProjector};
use super::space_curve::{SpaceCurve, Support, COINCIDENT};
use super::swept::{self, Pole};
use super::unroll;
use crate::geom::{Frame, Vec2, Vec3};
use crate::spline::knots::SAME_PARAMETER;
use crate::spline::surface::Surface;
use crate::spline::SplineError;
use std::f64::consts::{FRAC_PI_2, TAU};

/// An unbounded surface (or a spline with its domain).
#[derive(Clone, Debug, PartialEq)]
pub enum SupportSurface {
    /// `origin + u x + v y`.
    Plane(Frame),
    /// `origin + radius (cos u x + sin u y) + v z`.
    Cylinder {
        /// Axis z.
        frame: Frame,
        /// Radius, mm.
        radius: f64,
    },
    /// `origin + (radius + v slope)(cos u x + sin u y) + v z`.
    Cone {
        /// Axis z.
        frame: Frame,
        /// Radius at v = 0, mm.
        radius: f64,
        /// Tangent of the half angle.
        slope: f64,
    },
    /// `origin + radius (cos v (cos u x + sin u y) + sin v z)`.
    Sphere {
        /// Centre and axes.
        frame: Frame,
        /// Radius, mm.
        radius: f64,
    },
    /// `origin + (major + minor cos v)(cos u x + sin u y) + minor sin v z`.
    Torus {
        /// Axis z.
        frame: Frame,
        /// Radius of the circle of centres, mm.
        major: f64,
        /// Radius of the tube, mm.
        minor: f64,
    },
    /// `C(u) + v direction`.
    Extrusion {
        /// The curve C.
        directrix: SpaceCurve,
        /// Direction and speed.
        direction: Vec3,
    },
    /// `C(v)` turned by the angle u about the axis `origin, z` of the frame.
    Revolution {
        /// The curve C.
        directrix: SpaceCurve,
        /// Axis z.
        frame: Frame,
    },
    /// A B-spline surface.
    Spline(SplineSupport),
}

/// A B-spline surface with what searches and unwrapping need to know.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineSupport {
    /// The surface.
    pub surface: Surface,
    /// Periods in u and v of a surface whose opposite sides coincide.
    pub periods: [Option<f64>; 2],
    poles: Vec<Pole>,
    /// Whether all sides are seams or poles up to what coarse files round.
    nearly_closed: bool,
    projector: SurfaceProjector,
}

/// Point and first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentJet {
    /// S.
    pub p: Vec3,
    /// ∂S/∂u.
    pub du: Vec3,
    /// ∂S/∂v.
    pub dv: Vec3,
}

/// The foot from a start nearby is trusted when it ends this near to the surface, as a share of its size; else the
/// search goes everywhere. Edges of files lie nearer, and other sheets of the surface farther.
const TRUSTED: f64 = 1e-5;

/// Sides this near to each other, or to a point, as a share of the size, may be meant as one.
const NEARLY: f64 = 1e-4;

impl SplineSupport {
    /// Examines a surface.
    pub fn new(surface: Surface) -> Self {
        let size = surface.bbox().diagonal();
        let ((u0, u1), (v0, v1)) = surface.domain();
        let side = |axis: usize, value: f64| -> Vec<Vec3> {
            (0..=32)
                .map(|i| {
                    let s = i as f64 / 32.0;
                    if axis == 0 {
                        surface.point(value, v0 + (v1 - v0) * s)
                    } else {
                        surface.point(u0 + (u1 - u0) * s, value)
                    }
                })
                .collect()
        };
        let sides = [[side(0, u0), side(0, u1)], [side(1, v0), side(1, v1)]];
        let mut poles = Vec::new();
        for (axis, ends) in [(0, [u0, u1]), (1, [v0, v1])] {
            for (k, value) in ends.into_iter().enumerate() {
                let s = &sides[axis][k];
                if s.iter().all(|p| (p - s[0]).norm() <= COINCIDENT * size) {
                    poles.push(Pole { axis, value, point: s[0] });
                }
            }
        }
        let closed = |axis: usize| {
            let [a, b] = &sides[axis];
            a.iter().zip(b).all(|(p, q)| (p - q).norm() <= COINCIDENT * size)
                && a.iter().any(|p| (p - a[0]).norm() > COINCIDENT * size)
        };
        let periods = [closed(0).then_some(u1 - u0), closed(1).then_some(v1 - v0)];
        let near = NEARLY * size;
        let meet = |[a, b]: &[Vec<Vec3>; 2]| a.iter().zip(b).all(|(p, q)| (p - q).norm() <= near);
        let vanish = |ends: &[Vec<Vec3>; 2]| ends.iter().flatten().all(|p| (p - ends[0][0]).norm() <= near);
        let collapse = |ends: &[Vec<Vec3>; 2]| ends.iter().all(|s| s.iter().all(|p| (p - s[0]).norm() <= near));
        let nearly_closed = sides.iter().all(|s| (meet(s) && !vanish(s)) || collapse(s));
        let projector = SurfaceProjector::new(&surface);
        Self { surface, periods, poles, nearly_closed, projector }
    }

    fn wrap(&self, q: [f64; 2]) -> [f64; 2] {
        let ((u0, u1), (v0, v1)) = self.surface.domain();
        let one = |x: f64, a: f64, b: f64, period: Option<f64>| match period {
            Some(p) if x < a || x > b => a + (x - a).rem_euclid(p),
            _ => x.clamp(a, b),
        };
        [one(q[0], u0, u1, self.periods[0]), one(q[1], v0, v1, self.periods[1])]
    }
}

impl SplineSupport {
    /// Whether a side is a single point.
    pub(super) fn has_poles(&self) -> bool {
        !self.poles.is_empty()
    }

    /// The foot near a guess; steps that stop at a closed side go on from the opposite one.
    fn near(&self, x: &Vec3, guess: [f64; 2]) -> project::Foot {
        let mut best = project::refine(&self.surface, x, self.wrap(guess));
        let ((u0, u1), (v0, v1)) = self.surface.domain();
        for (k, (a, b)) in [(0, (u0, u1)), (1, (v0, v1))] {
            let hair = SAME_PARAMETER * (b - a);
            let low = best.at[k] <= a + hair;
            if self.periods[k].is_some() && (low || best.at[k] >= b - hair) {
                let mut over = best.at;
                over[k] = if low { b } else { a };
                let other = project::refine(&self.surface, x, over);
                if other.distance < best.distance {
                    best = other;
                }
            }
        }
        best
    }
}

impl Support for SupportSurface {
    fn tangent_jet(&self, at: [f64; 2]) -> [Vec3; 3] {
        let j = self.jet(at);
        [j.p, j.du, j.dv]
    }

    fn nearest(&self, x: &Vec3) -> [f64; 2] {
        self.foot(x, None)
    }
}

impl SupportSurface {
    /// Point and derivatives at natural parameters.
    pub fn jet(&self, q: [f64; 2]) -> TangentJet {
        let [u, v] = q;
        let round = |f: &Frame| (f.x * u.cos() + f.y * u.sin(), f.y * u.cos() - f.x * u.sin());
        match self {
            Self::Plane(f) => TangentJet { p: f.origin + f.x * u + f.y * v, du: f.x, dv: f.y },
            Self::Cylinder { frame, radius } => {
                let (r, t) = round(frame);
                TangentJet { p: frame.origin + r * *radius + frame.z * v, du: t * *radius, dv: frame.z }
            }
            Self::Cone { frame, radius, slope } => {
                let (r, t) = round(frame);
                let rho = radius + v * slope;
                TangentJet { p: frame.origin + r * rho + frame.z * v, du: t * rho, dv: r * *slope + frame.z }
            }
            Self::Sphere { frame, radius } => {
                let (r, t) = round(frame);
                let (s, c) = v.sin_cos();
                TangentJet {
                    p: frame.origin + (r * c + frame.z * s) * *radius,
                    du: t * (radius * c),
                    dv: (frame.z * c - r * s) * *radius,
                }
            }
            Self::Torus { frame, major, minor } => {
                let (r, t) = round(frame);
                let (s, c) = v.sin_cos();
                TangentJet {
                    p: frame.origin + r * (major + minor * c) + frame.z * (minor * s),
                    du: t * (major + minor * c),
                    dv: (frame.z * c - r * s) * *minor,
                }
            }
            Self::Extrusion { directrix, direction } => {
                let j = directrix.jet(u);
                TangentJet { p: j[0] + direction * v, du: j[1], dv: *direction }
            }
            Self::Revolution { directrix, frame } => {
                let j = directrix.jet(v);
                let (a, d) = (frame.to_local(&j[0]), frame.vector_to_local(&j[1]));
                let (s, c) = u.sin_cos();
                let turn = |p: Vec3| Vec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
                let p = turn(a);
                TangentJet {
                    p: frame.to_world(&p),
                    du: frame.vector_to_world(&Vec3::new(-p.y, p.x, 0.0)),
                    dv: frame.vector_to_world(&turn(d)),
                }
            }
            Self::Spline(s) => {
                let [u, v] = s.wrap(q);
                let j = s.surface.jet(u, v);
                TangentJet { p: j.p, du: j.du, dv: j.dv }
            }
        }
    }

    /// Natural parameters of a nearest point to `x`; searches start from `guess` where they need one. Angles are in
    /// one turn around zero.
    pub fn foot(&self, x: &Vec3, guess: Option<[f64; 2]>) -> [f64; 2] {
        match self {
            Self::Plane(f) => {
                let q = f.to_local(x);
                [q.x, q.y]
            }
            Self::Cylinder { frame, .. } => {
                let q = frame.to_local(x);
                [q.y.atan2(q.x), q.z]
            }
            Self::Cone { frame, radius, slope } => {
                let q = frame.to_local(x);
                // Behind the apex the radius is negative: the opposite nappe.
                let sign = if radius + q.z * slope < 0.0 { -1.0 } else { 1.0 };
                let rho = sign * q.x.hypot(q.y);
                [(sign * q.y).atan2(sign * q.x), ((rho - radius) * slope + q.z) / (1.0 + slope * slope)]
            }
            Self::Sphere { frame, .. } => {
                let q = frame.to_local(x);
                [q.y.atan2(q.x), q.z.atan2(q.x.hypot(q.y))]
            }
            Self::Torus { frame, major, .. } => {
                let q = frame.to_local(x);
                [q.y.atan2(q.x), q.z.atan2(q.x.hypot(q.y) - major)]
            }
            Self::Extrusion { directrix, direction } => swept::foot_on_extrusion(directrix, direction, x, guess),
            Self::Revolution { directrix, frame } => swept::foot_on_revolution(directrix, frame, x, guess),
            Self::Spline(s) => {
                let started = guess.map(|g| s.near(x, g));
                match started {
                    Some(foot) if foot.distance <= TRUSTED * s.surface.bbox().diagonal() => foot.at,
                    Some(foot) => {
                        let best = s.projector.nearest(&s.surface, x);
                        // Only a clearly nearer point is worth a jump.
                        if best.distance < 0.5 * foot.distance {
                            best.at
                        } else {
                            foot.at
                        }
                    }
                    None => s.projector.nearest(&s.surface, x).at,
                }
            }
        }
    }

    /// Periods of the natural parameters.
    pub fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Plane(_) => [None, None],
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => [Some(TAU), None],
            Self::Torus { major, minor, .. } => [Some(TAU), (major > minor).then_some(TAU)],
            Self::Extrusion { directrix, .. } => [directrix.period(), None],
            Self::Revolution { directrix, .. } => [Some(TAU), directrix.period()],
            Self::Spline(s) => s.periods,
        }
    }

    /// Whether the surface may have no border, up to what files round: then the sense of loops must be heeded.
    pub fn is_nearly_closed(&self) -> bool {
        match self {
            Self::Spline(s) => s.nearly_closed,
            _ => self.is_closed(),
        }
    }

    /// Whether the surface has no border: all its sides are seams or poles.
    pub fn is_closed(&self) -> bool {
        let (periods, poles) = (self.periods(), self.poles());
        (0..2).all(|k| periods[k].is_some() || poles.iter().filter(|p| p.axis == k).count() == 2)
    }

    /// Parameter lines that are single points.
    pub fn poles(&self) -> Vec<Pole> {
        let on_axis = |value: f64| Pole { axis: 1, value, point: self.jet([0.0, value]).p };
        match self {
            Self::Cone { radius, slope, .. } if slope.abs() > 0.0 => vec![on_axis(-radius / slope)],
            Self::Sphere { .. } => vec![on_axis(-FRAC_PI_2), on_axis(FRAC_PI_2)],
            Self::Torus { major, minor, .. } if major <= minor => {
                let a = (-major / minor).acos();
                vec![on_axis(-a), on_axis(a)]
            }
            Self::Revolution { directrix, frame } => swept::poles_of_revolution(directrix, frame, on_axis),
            Self::Spline(s) => s.poles.clone(),
            _ => Vec::new(),
        }
    }

    /// Bounds of the natural parameters where the surface ends by itself.
    pub fn limits(&self) -> [Option<(f64, f64)>; 2] {
        match self {
            Self::Sphere { .. } => [None, Some((-FRAC_PI_2, FRAC_PI_2))],
            Self::Torus { major, minor, .. } if major <= minor => {
                let a = (-major / minor).acos();
                [None, Some((-a, a))]
            }
            Self::Extrusion { directrix, .. } if directrix.period().is_none() => [directrix.domain(), None],
            Self::Revolution { directrix, .. } if directrix.period().is_none() => [None, directrix.domain()],
            Self::Spline(s) => {
                let (u, v) = s.surface.domain();
                [s.periods[0].is_none().then_some(u), s.periods[1].is_none().then_some(v)]
            }
            _ => [None, None],
        }
    }

    /// The part over the box `u × v` of natural parameters as an exact (rational) B-spline, and how parameters map.
    /// A spline keeps its own domain unless the box leaves it over a closed side.
    ///
    /// # Errors
    /// A box without area or beyond what the surface has.
    pub fn to_spline(&self, u: (f64, f64), v: (f64, f64)) -> Result<(Surface, [ParameterMap; 2]), SplineError> {
        let line = |frame: &Frame, p: Vec2, d: Vec2| {
            let world = |t: f64| frame.to_world(&Vec3::new(p.x + t * d.x, 0.0, p.y + t * d.y));
            SpaceCurve::Line { origin: world(0.0), direction: world(1.0) - world(0.0) }
        };
        let circle = |frame: &Frame, center: f64, radius: f64| SpaceCurve::Ellipse {
            frame: Frame { origin: frame.origin + frame.x * center, x: frame.x, y: frame.z, z: -frame.y },
            a: radius,
            b: radius,
        };
        match self {
            Self::Plane(f) => {
                let directrix = SpaceCurve::Line { origin: f.origin, direction: f.x };
                swept::extrude(&directrix, &f.y, u, v)
            }
            Self::Cylinder { frame, radius } => {
                swept::revolve(&line(frame, Vec2::new(*radius, 0.0), Vec2::new(0.0, 1.0)), frame, u, v)
            }
            Self::Cone { frame, radius, slope } => {
                swept::revolve(&line(frame, Vec2::new(*radius, 0.0), Vec2::new(*slope, 1.0)), frame, u, v)
            }
            Self::Sphere { frame, radius } => swept::revolve(&circle(frame, 0.0, *radius), frame, u, v),
            Self::Torus { frame, major, minor } => swept::revolve(&circle(frame, *major, *minor), frame, u, v),
            Self::Extrusion { directrix, direction } => swept::extrude(directrix, direction, u, v),
            Self::Revolution { directrix, frame } => swept::revolve(directrix, frame, u, v),
            Self::Spline(s) => {
                let mut surface = s.surface.clone();
                if s.periods[0].is_some() {
                    surface = unroll::in_u(&surface, u)?;
                }
                if s.periods[1].is_some() {
                    surface = unroll::in_v(&surface, v)?;
                }
                Ok((surface, [ParameterMap::Same, ParameterMap::Same]))
            }
        }
    }

    /// A length that tells how large the surface is by itself; 0 where it has no size of its own.
    pub fn size(&self) -> f64 {
        match self {
            Self::Sphere { radius, .. } => 2.0 * radius,
            Self::Torus { major, minor, .. } => 2.0 * (major + minor),
            Self::Spline(s) => s.surface.bbox().diagonal(),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;

    fn frame() -> Frame {
        let z = Vec3::new(1.0, 2.0, 2.0) / 3.0;
        let x = Vec3::new(2.0, 1.0, -2.0) / 3.0;
        Frame { origin: Vec3::new(10.0, -2.0, 3.0), x, y: z.cross(&x), z }
    }

    fn supports() -> Vec<SupportSurface> {
        let f = frame();
        let tilted = Frame { origin: f.to_world(&Vec3::new(5.0, 1.0, 0.5)), x: f.x, y: f.z, z: -f.y };
        let conic = SpaceCurve::Ellipse { frame: tilted, a: 2.0, b: 1.0 };
        vec![
            SupportSurface::Plane(f),
            SupportSurface::Cylinder { frame: f, radius: 3.0 },
            SupportSurface::Cone { frame: f, radius: 3.0, slope: 0.4 },
            SupportSurface::Sphere { frame: f, radius: 3.0 },
            SupportSurface::Torus { frame: f, major: 5.0, minor: 2.0 },
            SupportSurface::Extrusion { directrix: conic.clone(), direction: Vec3::new(0.3, 1.0, 0.2) },
            SupportSurface::Revolution { directrix: conic, frame: f },
        ]
    }

    #[test]
    fn splines_are_exact_and_feet_return() {
        for c in supports() {
            let (u, v) = ((0.3, 2.9), (-0.9, 1.1));
            let (s, map) = c.to_spline(u, v).expect("a spline");
            for i in 0..=10 {
                for j in 0..=10 {
                    let q = [u.0 + (u.1 - u.0) * i as f64 / 10.0, v.0 + (v.1 - v.0) * j as f64 / 10.0];
                    let jet = c.jet(q);
                    let p = s.point(map[0].forward(q[0]), map[1].forward(q[1]));
                    assert!((p - jet.p).norm() < 1e-12, "{c:?} at {q:?}");
                    let foot = c.foot(&jet.p, None);
                    let near = c.jet(foot);
                    assert!((near.p - jet.p).norm() < 1e-9, "{c:?} at {q:?}: {foot:?}");
                    let h = 1e-6;
                    let du = (c.jet([q[0] + h, q[1]]).p - c.jet([q[0] - h, q[1]]).p) / (2.0 * h);
                    let dv = (c.jet([q[0], q[1] + h]).p - c.jet([q[0], q[1] - h]).p) / (2.0 * h);
                    assert!((du - jet.du).norm() < 1e-7 && (dv - jet.dv).norm() < 1e-7);
                }
            }
        }
    }

    #[test]
    fn poles_of_a_collapsed_patch_are_seen() {
        let k = Knots::new(1, vec![0., 0., 1., 1.], 2).expect("knots");
        let p = [Vec3::zeros(), Vec3::zeros(), Vec3::x(), Vec3::y()];
        let c = SplineSupport::new(Surface::new(k.clone(), k, &p, None).expect("surface"));
        assert_eq!(c.poles.len(), 1);
        assert_eq!((c.poles[0].axis, c.periods), (0, [None, None]));
    }
}
