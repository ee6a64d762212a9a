//! Transformation matrices (124), and curves and surfaces moved by them.

use super::records::DEEPEST;
use super::records::{Entry, Fault, Records};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::geom::placement::Placement;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use nalgebra::Matrix3;

/// Matrices this near to a rotation, up to scale, keep circles circles: printed entries have ten digits or so.
const SIMILAR: f64 = 1e-9;
/// Determinants below this share of their entries' size squash space.
const FLAT: f64 = 1e-6;

/// The placement that an entity's directory entry asks for.
pub(super) fn of_entry(records: &Records, e: &Entry) -> Result<Placement, Fault> {
    let mut out = Placement::identity();
    let mut next = e.matrix;
    let mut depth = 0;
    while next != 0 {
        let m = records.get(next)?;
        if m.kind != MATRIX {
            return Err(Fault::new(
                e.number,
                format!("D{next} is named as a transformation, but is of type {}", m.kind),
            ));
        }
        depth += 1;
        if depth > DEEPEST {
            return Err(Fault::new(e.number, format!("the transformation D{next} contains itself")));
        }
        let x = m.numbers(1, 12)?;
        let linear = Matrix3::new(x[0], x[1], x[2], x[4], x[5], x[6], x[8], x[9], x[10]);
        let size = linear.amax();
        if linear.determinant().abs() <= FLAT * size.powi(3) || !size.is_finite() {
            return Err(Fault::new(next, format!("the transformation D{next} is singular")));
        }
        out = Placement { linear, shift: Vec3::new(x[3], x[7], x[11]) }.after(&out);
        next = m.matrix;
    }
    Ok(out)
}

/// Type of a transformation matrix.
const MATRIX: u32 = 124;

/// The factor by which a placement scales all lengths; `None` if it scales some more than others.
fn similarity(p: &Placement) -> Option<f64> {
    let square = p.linear.transpose() * p.linear;
    let scale = square.trace() / 3.0;
    ((square - Matrix3::identity() * scale).amax() <= SIMILAR * scale).then(|| scale.sqrt())
}

/// A path moved.
pub(super) fn path(arcs: Vec<(u64, Arc)>, p: &Placement) -> Result<Vec<(u64, Arc)>, Fault> {
    if *p == Placement::identity() {
        return Ok(arcs);
    }
    arcs.into_iter().map(|(id, a)| Ok((id, arc(&a, p).ok_or_else(|| unmoved(id))?))).collect()
}

fn unmoved(id: u64) -> Fault {
    Fault::new(id, format!("the curve D{id} cannot be moved by its transformation"))
}

/// A piece of a curve moved: conics stay conics unless the placement squeezes them.
fn arc(a: &Arc, p: &Placement) -> Option<Arc> {
    let curve = match (&a.curve, similarity(p)) {
        (SpaceCurve::Line { origin, direction }, _) => {
            SpaceCurve::Line { origin: p.point(origin), direction: p.linear * direction }
        }
        (SpaceCurve::Spline(c), _) => SpaceCurve::Spline(spline(c, p)),
        (SpaceCurve::Ellipse { frame: f, a, b }, Some(s)) => {
            SpaceCurve::Ellipse { frame: frame(f, p), a: a * s, b: b * s }
        }
        (SpaceCurve::Parabola { frame: f, focal }, Some(s)) => {
            SpaceCurve::Parabola { frame: frame(f, p), focal: focal * s }
        }
        (SpaceCurve::Hyperbola { frame: f, a, b }, Some(s)) => {
            SpaceCurve::Hyperbola { frame: frame(f, p), a: a * s, b: b * s }
        }
        (SpaceCurve::Traced(_), _) => return None,
        (conic, None) => {
            let (c, _) = conic.to_spline(a.from.min(a.to), a.from.max(a.to)).ok()?;
            let (t0, t1) = c.domain();
            let (from, to) = if a.from <= a.to { (t0, t1) } else { (t1, t0) };
            return Some(Arc { curve: SpaceCurve::Spline(spline(&c, p)), from, to });
        }
    };
    Some(Arc { curve, from: a.from, to: a.to })
}

/// A homogeneous spline moved.
fn spline(c: &Curve<4>, p: &Placement) -> Curve<4> {
    let moved = |h: &[f64; 4]| {
        let q = p.linear * Vec3::new(h[0], h[1], h[2]) + p.shift * h[3];
        [q.x, q.y, q.z, h[3]]
    };
    Curve { knots: c.knots.clone(), control: c.control.iter().map(moved).collect() }
}

/// A frame moved by a similarity. Curves lie in the plane of x and y, so that z may follow these under a reflection.
fn frame(f: &Frame, p: &Placement) -> Frame {
    let (x, y) = ((p.linear * f.x).normalize(), (p.linear * f.y).normalize());
    Frame { origin: p.point(&f.origin), x, y, z: x.cross(&y) }
}

/// A surface moved; `None` where that would change its kind or its parameters.
pub(super) fn support(c: &SupportSurface, p: &Placement) -> Option<SupportSurface> {
    if *p == Placement::identity() {
        return Some(c.clone());
    }
    if let SupportSurface::Spline(s) = c {
        let mut surface = s.surface.clone();
        surface.place(p);
        return Some(SupportSurface::Spline(SplineSupport::new(surface)));
    }
    let s = similarity(p).filter(|_| !p.reflects())?;
    Some(match c {
        SupportSurface::Plane(f) if (s - 1.0).abs() <= SIMILAR => SupportSurface::Plane(frame(f, p)),
        SupportSurface::Cylinder { frame: f, radius } if (s - 1.0).abs() <= SIMILAR => {
            SupportSurface::Cylinder { frame: frame(f, p), radius: *radius }
        }
        SupportSurface::Cone { frame: f, radius, slope } if (s - 1.0).abs() <= SIMILAR => {
            SupportSurface::Cone { frame: frame(f, p), radius: *radius, slope: *slope }
        }
        SupportSurface::Sphere { frame: f, radius } => {
            SupportSurface::Sphere { frame: frame(f, p), radius: radius * s }
        }
        SupportSurface::Torus { frame: f, major, minor } => {
            SupportSurface::Torus { frame: frame(f, p), major: major * s, minor: minor * s }
        }
        _ => return None,
    })
}
