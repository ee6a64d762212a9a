//! Surfaces that are elementary ones: a line or a circle turned about an axis, a line moved along a direction, whose offsets are
//! known exactly then, and splines that are triangles.

use super::space_curve::SpaceCurve;
use super::support_surface::SupportSurface;
use crate::geom::{Frame, Vec3};

/// Directions and places that differ by less than this share are the same: what thirteen printed digits lose.
const SAME: f64 = 1e-12;
/// Share of its extent by which a triangle may leave the plane that it is read as: what nine printed digits lose. It counts in
/// what is proven.
const FLAT: f64 = 1e-9;
/// Control points of a bilinear spline.
const CORNERS: usize = 4;
/// Natural parameters at which the normals of both forms are compared.
const PROBE: [f64; 2] = [0.3, 0.1];

/// The elementary surface that a swept surface is, up to rounding of the file's numbers; `false` if its normal is turned
/// round. `None` for surfaces that are no such sweep. Natural parameters are those of the answer.
pub(crate) fn elementary(support: &SupportSurface) -> Option<(SupportSurface, bool)> {
    let out = match support {
        SupportSurface::Revolution { directrix: SpaceCurve::Line { origin, direction }, frame } => {
            turned_line(&frame.to_local(origin), &frame.vector_to_local(direction).normalize(), frame)
        }
        SupportSurface::Revolution { directrix: SpaceCurve::Ellipse { frame: own, a, b }, frame }
            if (a - b).abs() <= SAME * a =>
        {
            turned_circle(own, *a, frame)
        }
        SupportSurface::Extrusion { directrix: SpaceCurve::Line { origin, direction }, direction: way } => {
            let x = direction.normalize();
            let z = direction.cross(way);
            let flat = z.norm() > SAME * direction.norm() * way.norm();
            flat.then(|| SupportSurface::Plane(frame_of(*origin, z.normalize(), x)))
        }
        SupportSurface::Extrusion { directrix: SpaceCurve::Ellipse { frame, a, b }, direction } => {
            let upright = frame.z.cross(direction).norm() <= SAME * direction.norm();
            (upright && (a - b).abs() <= SAME * a).then_some(SupportSurface::Cylinder { frame: *frame, radius: *a })
        }
        _ => None,
    }?;
    let jet = support.jet(PROBE);
    let other = out.jet(out.foot(&jet.p, None));
    let same = jet.du.cross(&jet.dv).dot(&other.du.cross(&other.dv)) > 0.0;
    Some((out, same))
}

/// The plane, with the spline's normal, of a triangle: of a bilinear spline, weights or none, with a corner for a side; and how far
/// (mm) it is off at most. At that corner parameters are not unique, and rulings through it have no tangent plane. Such a spline
/// covers its triangle once; others may fold, and stay what they are.
pub(crate) fn plane_of_triangle(support: &SupportSurface) -> Option<(SupportSurface, f64)> {
    let SupportSurface::Spline(spline) = support else { return None };
    let surface = &spline.surface;
    if !spline.has_poles() || surface.control.len() != CORNERS {
        return None;
    }
    let ((u0, u1), (v0, v1)) = surface.domain();
    let jet = surface.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1));
    let (x, z) = (jet.du.try_normalize(0.0)?, jet.normal().try_normalize(0.0)?);
    // Weights are positive: the surface lies in the hull of its control points.
    let heights = surface.control.iter().map(|h| (Vec3::new(h[0], h[1], h[2]) / h[3] - jet.p).dot(&z).abs());
    let off = heights.fold(0.0, f64::max);
    (off <= FLAT * surface.bbox().diagonal()).then(|| (SupportSurface::Plane(frame_of(jet.p, z, x)), off))
}

fn frame_of(origin: Vec3, z: Vec3, x: Vec3) -> Frame {
    Frame { origin, x, y: z.cross(&x), z }
}

/// A line turned about the z axis: a cylinder, or a cone if it meets the axis elsewhere than at a right angle.
fn turned_line(origin: &Vec3, direction: &Vec3, frame: &Frame) -> Option<SupportSurface> {
    let (reach, radius) = (direction.x.hypot(direction.y), origin.x.hypot(origin.y));
    if reach <= SAME {
        return (radius > 0.0).then_some(SupportSurface::Cylinder { frame: *frame, radius });
    }
    let beside = (origin.x * direction.y - origin.y * direction.x) / reach;
    if beside.abs() > SAME * (radius + origin.z.abs()) || direction.z.abs() <= SAME {
        return None;
    }
    let signed = (origin.x * direction.x + origin.y * direction.y) / reach;
    let slope = reach / direction.z * if signed < 0.0 { -1.0 } else { 1.0 };
    let foot = frame.origin + frame.z * origin.z;
    Some(SupportSurface::Cone { frame: Frame { origin: foot, ..*frame }, radius: signed.abs(), slope })
}

/// A circle turned about an axis in its plane that it does not meet: a torus.
fn turned_circle(own: &Frame, minor: f64, frame: &Frame) -> Option<SupportSurface> {
    let (centre, normal) = (frame.to_local(&own.origin), frame.vector_to_local(&own.z));
    let major = centre.x.hypot(centre.y);
    let in_plane = normal.z.abs() <= SAME && (centre.x * normal.x + centre.y * normal.y).abs() <= SAME * major;
    let origin = frame.origin + frame.z * centre.z;
    (in_plane && major > minor).then_some(SupportSurface::Torus { frame: Frame { origin, ..*frame }, major, minor })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_are_the_surfaces_that_they_are_called() {
        let f = frame_of(Vec3::new(3.0, -1.0, 2.0), Vec3::z(), Vec3::x());
        let line = |p: Vec3, d: Vec3| SpaceCurve::Line { origin: f.to_world(&p), direction: f.vector_to_world(&d) };
        let meridian = frame_of(f.to_world(&Vec3::new(5.0, 0.0, 1.0)), -Vec3::y(), Vec3::x());
        let circle = |frame: Frame| SpaceCurve::Ellipse { frame, a: 2.0, b: 2.0 };
        let turned = |directrix: SpaceCurve| SupportSurface::Revolution { directrix, frame: f };
        let moved = |directrix: SpaceCurve, direction: Vec3| SupportSurface::Extrusion { directrix, direction };
        let sweeps = [
            turned(line(Vec3::new(0.0, 4.0, 1.0), Vec3::z() * 2.0)),
            turned(line(Vec3::new(0.0, 4.0, 1.0), Vec3::new(0.0, -1.0, 2.0))),
            turned(line(Vec3::new(0.0, 4.0, 1.0), Vec3::new(0.0, 1.0, -2.0))),
            turned(circle(meridian)),
            moved(line(Vec3::zeros(), Vec3::new(1.0, 2.0, 0.0)), Vec3::new(0.0, 1.0, 3.0)),
            moved(circle(f), Vec3::new(0.0, 0.0, -3.0)),
        ];
        for sweep in sweeps {
            let (c, same) = elementary(&sweep).expect("an elementary surface");
            for q in [[0.3, 0.2], [2.0, -0.7], [4.0, 0.4]] {
                let j = sweep.jet(q);
                let k = c.jet(c.foot(&j.p, None));
                assert!((j.p - k.p).norm() < 1e-12, "{c:?} at {q:?}");
                let turn = j.du.cross(&j.dv).normalize().dot(&k.du.cross(&k.dv).normalize());
                assert!((turn - if same { 1.0 } else { -1.0 }).abs() < 1e-12, "{c:?} at {q:?}: {turn}");
            }
        }
        // A line that passes the axis makes a hyperboloid.
        assert!(elementary(&turned(line(Vec3::new(0.0, 4.0, 1.0), Vec3::new(1.0, 0.0, 2.0)))).is_none());
    }
}
