//! Surfaces of an archive as supports: what is a plane, a cylinder, a cone or a sweep stays one.

use super::bytes::{fault, Cursor, Fault, Reading};
use super::classes::Class;
use super::curves::{self, FileCurve};
use super::records::{self, Object};
use crate::brep::raw::SurfaceKind;
use crate::brep::recast;
use crate::brep::space_curve::SpaceCurve;
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use std::f64::consts::TAU;

/// A circle's centre within this share of its radius of the axis, and an axis so nearly in its plane, make a sphere: what
/// thirteen digits lose.
const SAME: f64 = 1e-12;
/// A full turn up to this share: printed angles.
const FULL_TURN: f64 = 1e-9;

/// A surface of the file.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// The unbounded surface.
    pub support: SupportSurface,
    /// What people call it.
    pub kind: SurfaceKind,
    /// Whether the normal of the support is opposite to the file's.
    pub flipped: bool,
    /// The same surface for a face without trims.
    pub whole: Whole,
}

/// A support with the rectangle that the file's surface covers.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    /// The support; another form of [`Patch::support`] where that has no parameters of the file any more.
    pub support: SupportSurface,
    /// Natural parameters, each from low to high.
    pub rectangle: [(f64, f64); 2],
    /// Whether its normal is opposite to the file's.
    pub flipped: bool,
}

/// Reads a surface; `scale` is the length of the file's unit in mm.
pub(super) fn surface(object: Object, scale: f64) -> Reading<Patch> {
    let mut c = object.data;
    let (major, minor) = c.version()?;
    if !(major == 1 || (major == 2 && object.class == Class::RevSurface)) {
        return fault(format!("a surface has the unknown version {major}.{minor}"));
    }
    let out = match object.class {
        Class::NurbsSurface => nurbs(&mut c, scale)?,
        Class::PlaneSurface => plane(&mut c, scale, minor)?,
        Class::RevSurface => revolution(&mut c, scale, major)?,
        Class::SumSurface => sum(&mut c, scale)?,
        Class::Other(id) => return fault(format!("a surface of the unknown class {id} is not read")),
        other => return fault(format!("a {} stands where a surface is needed", other.name())),
    };
    c.check()?;
    Ok(out)
}

/// Reads a spline surface that stands without a frame of its own.
pub(super) fn inline(c: &mut Cursor, scale: f64) -> Reading<Patch> {
    c.version()?;
    nurbs(c, scale)
}

fn unusable(e: impl std::fmt::Display) -> Fault {
    Fault(format!("a NURBS surface is not usable: {e}"))
}

fn spline(surface: Surface) -> Patch {
    let (u, v) = surface.domain();
    let support = SupportSurface::Spline(SplineSupport::new(surface));
    Patch::simple(support, [u, v], SurfaceKind::Spline)
}

impl Patch {
    fn simple(support: SupportSurface, rectangle: [(f64, f64); 2], kind: SurfaceKind) -> Self {
        let whole = Whole { support: support.clone(), rectangle, flipped: false };
        Self { support, kind, flipped: false, whole }
    }

    /// A sweep, by the elementary surface that it is if it is one.
    fn sweep(whole: Whole, elementary: Option<(SupportSurface, bool)>, kind: SurfaceKind) -> Self {
        let (support, same) = elementary.unwrap_or_else(|| (whole.support.clone(), true));
        let kind = match &support {
            SupportSurface::Plane(_) => SurfaceKind::Plane,
            SupportSurface::Cylinder { .. } => SurfaceKind::Cylinder,
            SupportSurface::Cone { .. } => SurfaceKind::Cone,
            SupportSurface::Sphere { .. } => SurfaceKind::Sphere,
            SupportSurface::Torus { .. } => SurfaceKind::Torus,
            _ => kind,
        };
        Self { support, kind, flipped: whole.flipped == same, whole }
    }
}

fn nurbs(c: &mut Cursor, scale: f64) -> Reading<Patch> {
    let (dimension, rational) = curves::dimension(c)?;
    let degrees = [curves::degree(c)?, curves::degree(c)?];
    let claimed = [c.i32()?, c.i32()?];
    c.skip(8)?;
    c.skip_box()?;
    let knots = [c.numbers()?, c.numbers()?];
    let n = c.count(8 * (dimension as usize + usize::from(rational)))?;
    let counts = claimed.map(|n| usize::try_from(n).unwrap_or(0));
    if counts[0].checked_mul(counts[1]) != Some(n) {
        return fault(format!("a NURBS surface of {} x {} control points has {n}", claimed[0], claimed[1]));
    }
    let control = (0..n).map(|_| curves::control(c, dimension, rational, scale)).collect::<Reading<Vec<_>>>()?;
    let whole = |k: usize| {
        let own = &knots[k];
        let ends = own.first().zip(own.last());
        let values = ends.map_or_else(Vec::new, |(a, b)| [&[*a][..], own, &[*b]].concat());
        Knots::new(degrees[k], values, counts[k]).map_err(unusable)
    };
    Ok(spline(Surface { knots_u: whole(0)?, knots_v: whole(1)?, rational: is_rational(&control), control }))
}

fn is_rational(control: &[[f64; 4]]) -> bool {
    control.iter().any(|h| h[3].to_bits() != 1f64.to_bits())
}

fn plane(c: &mut Cursor, scale: f64, minor: u8) -> Reading<Patch> {
    let frame = curves::plane(c, scale)?;
    let mut extents = [c.increasing()?, c.increasing()?];
    if minor >= 1 {
        extents = [c.increasing()?, c.increasing()?];
    }
    let rectangle = extents.map(|[a, b]| (a * scale, b * scale));
    Ok(Patch::simple(SupportSurface::Plane(frame), rectangle, SurfaceKind::Plane))
}

fn revolution(c: &mut Cursor, scale: f64, major: u8) -> Reading<Patch> {
    let (from, to) = (curves::point(c, scale)?, curves::point(c, scale)?);
    let angles = c.increasing()?;
    if major >= 2 {
        c.increasing()?;
    }
    c.skip_box()?;
    let transposed = c.i32()? != 0;
    if !c.bool()? {
        return fault("a surface of revolution has no profile");
    }
    let profile = curves::curve(records::object(c)?, scale)?;
    if angles[1] - angles[0] > TAU * (1.0 + FULL_TURN) {
        return fault(format!("a surface of revolution turns from {} to {} rad", angles[0], angles[1]));
    }
    let Some(axis) = (to - from).try_normalize(0.0) else {
        return fault("a surface of revolution has no axis");
    };
    turned(&profile, &about(from, axis), angles, transposed)
}

/// A frame with the axis z.
fn about(origin: Vec3, z: Vec3) -> Frame {
    let x = z.cross(&Vec3::ith(z.iamin(), 1.0)).normalize();
    Frame { origin, x, y: z.cross(&x), z }
}

/// A profile turned about the z axis of a frame.
fn turned(profile: &FileCurve, frame: &Frame, [a, b]: [f64; 2], transposed: bool) -> Reading<Patch> {
    let (directrix, [from, to]) = profile.single()?;
    // Without trims an arc is its own piece: turned as a circle it would cover a sphere twice.
    let bounded = match &directrix {
        SpaceCurve::Ellipse { .. } => SpaceCurve::Spline(directrix.to_spline(from, to).map_err(unusable)?.0),
        other => other.clone(),
    };
    let swept = SupportSurface::Revolution { directrix, frame: *frame };
    let elementary = sphere(&swept, 0.5 * (from + to)).or_else(|| recast::elementary(&swept));
    let support = SupportSurface::Revolution { directrix: bounded, frame: *frame };
    let whole = Whole { support, rectangle: [(a, b), (from, to)], flipped: transposed };
    Ok(Patch::sweep(whole, elementary, SurfaceKind::Revolution))
}

/// A circle turned about an axis through its centre, in its plane; `false` if the normal of the sphere is opposite where
/// the profile has the parameter `middle`.
fn sphere(swept: &SupportSurface, middle: f64) -> Option<(SupportSurface, bool)> {
    let SupportSurface::Revolution { directrix: SpaceCurve::Ellipse { frame: own, a, .. }, frame } = swept else {
        return None;
    };
    let (centre, normal) = (frame.to_local(&own.origin), frame.vector_to_local(&own.z));
    if centre.x.hypot(centre.y) > SAME * a || normal.z.abs() > SAME {
        return None;
    }
    let out = SupportSurface::Sphere { frame: Frame { origin: own.origin, ..*frame }, radius: *a };
    let j = swept.jet([0.0, middle]);
    let k = out.jet(out.foot(&j.p, None));
    Some((out, j.du.cross(&j.dv).dot(&k.du.cross(&k.dv)) > 0.0))
}

fn sum(c: &mut Cursor, scale: f64) -> Reading<Patch> {
    let base = curves::point(c, scale)?;
    c.skip_box()?;
    let first = curves::curve(records::object(c)?, scale)?;
    let second = curves::curve(records::object(c)?, scale)?;
    match (first.single()?, second.single()?) {
        ((curve, range), (SpaceCurve::Line { origin, direction }, along)) => {
            extruded(moved(curve, origin + base), range, direction, along, false)
        }
        ((SpaceCurve::Line { origin, direction }, along), (curve, range)) => {
            extruded(moved(curve, origin + base), range, direction, along, true)
        }
        _ => both_curved(&first.spline()?, &second.spline()?, base),
    }
}

/// A curve moved along a direction; `flipped` if the file counts the direction first.
fn extruded(
    directrix: SpaceCurve,
    [a, b]: [f64; 2],
    direction: Vec3,
    [c, d]: [f64; 2],
    flipped: bool,
) -> Reading<Patch> {
    let support = SupportSurface::Extrusion { directrix, direction };
    let elementary = recast::elementary(&support);
    let whole = Whole { support, rectangle: [(a, b), (c, d)], flipped };
    Ok(Patch::sweep(whole, elementary, SurfaceKind::Extrusion))
}

/// The curve moved by a vector.
fn moved(curve: SpaceCurve, by: Vec3) -> SpaceCurve {
    match curve {
        SpaceCurve::Line { origin, direction } => SpaceCurve::Line { origin: origin + by, direction },
        SpaceCurve::Ellipse { frame, a, b } => {
            SpaceCurve::Ellipse { frame: Frame { origin: frame.origin + by, ..frame }, a, b }
        }
        SpaceCurve::Spline(mut c) => {
            for h in &mut c.control {
                for k in 0..3 {
                    h[k] += by[k] * h[3];
                }
            }
            SpaceCurve::Spline(c)
        }
        // Archives hold no other curves.
        other => other,
    }
}

/// The surface that one curve makes when it is moved along another, exactly.
fn both_curved(first: &Curve<4>, second: &Curve<4>, base: Vec3) -> Reading<Patch> {
    let mut net = Vec::with_capacity(first.control.len() * second.control.len());
    for p in &first.control {
        for q in &second.control {
            let x = |k: usize| p[k] * q[3] + q[k] * p[3] + base[k] * p[3] * q[3];
            net.push([x(0), x(1), x(2), p[3] * q[3]]);
        }
    }
    Ok(spline(Surface {
        knots_u: first.knots.clone(),
        knots_v: second.knots.clone(),
        rational: is_rational(&net),
        control: net,
    }))
}
