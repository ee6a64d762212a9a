//! Geometry records: points, placements, curves and surfaces (ISO 10303-42).

use super::records::{boolean, list, real, references, Records};
use super::shell::ShellCurve;
use crate::geom::{Frame, Vec3};
use crate::patchwork::shell_surface::{ShellSurface, SurfaceForm};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// CARTESIAN_POINT in the plane or in space.
pub fn point(r: &mut Records, coordinates: &[f64]) -> u64 {
    r.push(&format!("CARTESIAN_POINT('',{})", list(coordinates.iter().map(|&x| real(x)))))
}

/// DIRECTION; `d` need not have unit length.
pub fn direction(r: &mut Records, d: &Vec3) -> u64 {
    r.push(&format!("DIRECTION('',{})", list(d.iter().map(|&x| real(x)))))
}

/// AXIS2_PLACEMENT_3D.
pub fn placement(r: &mut Records, f: &Frame) -> u64 {
    let (o, z, x) = (point(r, f.origin.as_slice()), direction(r, &f.z), direction(r, &f.x));
    r.push(&format!("AXIS2_PLACEMENT_3D('',#{o},#{z},#{x})"))
}

/// Multiplicities and distinct knots, as two lists.
fn knot_lists(k: &Knots) -> (String, String) {
    let distinct = k.distinct();
    (list(distinct.iter().map(|d| d.1.to_string())), list(distinct.iter().map(|d| real(d.0))))
}

/// B_SPLINE_CURVE_WITH_KNOTS, polynomial, of the plane or of space.
pub fn curve<const D: usize>(r: &mut Records, c: &Curve<D>) -> u64 {
    let poles: Vec<u64> = c.control.iter().map(|p| point(r, p)).collect();
    let (mults, knots) = knot_lists(&c.knots);
    r.push(&format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',{},{},.UNSPECIFIED.,.F.,.F.,{mults},{knots},.UNSPECIFIED.)",
        c.knots.degree(),
        references(poles)
    ))
}

/// Rational B-spline curve of space from homogeneous control points: a complex record.
fn rational_curve(r: &mut Records, c: &Curve<4>) -> u64 {
    let poles: Vec<u64> = c.control.iter().map(|h| affine_point(r, h)).collect();
    let (mults, knots) = knot_lists(&c.knots);
    r.push(&format!(
        "(BOUNDED_CURVE() B_SPLINE_CURVE({},{},.UNSPECIFIED.,.F.,.F.) \
         B_SPLINE_CURVE_WITH_KNOTS({mults},{knots},.UNSPECIFIED.) CURVE() GEOMETRIC_REPRESENTATION_ITEM() \
         RATIONAL_B_SPLINE_CURVE({}) REPRESENTATION_ITEM(''))",
        c.knots.degree(),
        references(poles),
        list(c.control.iter().map(|h| real(h[3])))
    ))
}

fn affine_point(r: &mut Records, h: &[f64; 4]) -> u64 {
    point(r, &[h[0] / h[3], h[1] / h[3], h[2] / h[3]])
}

/// The curve of an edge between two points.
pub(crate) fn edge_curve(r: &mut Records, c: &ShellCurve, start: &Vec3, end: &Vec3) -> u64 {
    match c {
        ShellCurve::Line => {
            let chord = end - start;
            let (p, d) = (point(r, start.as_slice()), direction(r, &chord.normalize()));
            let v = r.push(&format!("VECTOR('',#{d},1.)"));
            r.push(&format!("LINE('',#{p},#{v})"))
        }
        ShellCurve::Circle { frame, radius } => {
            let a = placement(r, frame);
            r.push(&format!("CIRCLE('',#{a},{})", real(*radius)))
        }
        ShellCurve::Spline(c) => curve(r, c),
        ShellCurve::Rational(c) => rational_curve(r, c),
    }
}

/// The surface of a face.
pub fn surface(r: &mut Records, s: &ShellSurface) -> u64 {
    match s {
        ShellSurface::Plane(f) => {
            let a = placement(r, f);
            r.push(&format!("PLANE('',#{a})"))
        }
        ShellSurface::Cylinder { frame, radius } => {
            let a = placement(r, frame);
            r.push(&format!("CYLINDRICAL_SURFACE('',#{a},{})", real(*radius)))
        }
        ShellSurface::Cone { frame, radius, half_angle } => {
            let a = placement(r, frame);
            r.push(&format!("CONICAL_SURFACE('',#{a},{},{})", real(*radius), real(*half_angle)))
        }
        ShellSurface::Spline { surface, form } => spline_surface(r, surface, keyword(*form)),
        ShellSurface::Offset { surface, form, distance } => {
            let base = spline_surface(r, surface, keyword(*form));
            r.push(&format!("OFFSET_SURFACE('',#{base},{},.F.)", real(*distance)))
        }
    }
}

/// The hint as the standard spells it.
fn keyword(form: SurfaceForm) -> &'static str {
    match form {
        SurfaceForm::Plane => "PLANE_SURF",
        SurfaceForm::Extrusion => "SURF_OF_LINEAR_EXTRUSION",
        SurfaceForm::Cone => "GENERALISED_CONE",
        SurfaceForm::Ruled => "RULED_SURF",
        SurfaceForm::Unspecified => "UNSPECIFIED",
    }
}

/// B_SPLINE_SURFACE_WITH_KNOTS, or the complex record of a rational one.
fn spline_surface(r: &mut Records, s: &Surface, form: &str) -> u64 {
    let poles: Vec<u64> = s.control.iter().map(|h| affine_point(r, h)).collect();
    let net = list(poles.chunks(s.row()).map(|row| references(row.iter().copied())));
    let (mults_u, knots_u) = knot_lists(&s.knots_u);
    let (mults_v, knots_v) = knot_lists(&s.knots_v);
    let shape = format!(
        "{},{},{net},.{form}.,{c},{c},{c}",
        s.knots_u.degree(),
        s.knots_v.degree(),
        c = boolean(false) // closed in u, closed in v, self-intersecting
    );
    let knots = format!("{mults_u},{mults_v},{knots_u},{knots_v},.UNSPECIFIED.");
    if !s.rational {
        return r.push(&format!("B_SPLINE_SURFACE_WITH_KNOTS('',{shape},{knots})"));
    }
    let weights = list(s.control.chunks(s.row()).map(|row| list(row.iter().map(|h| real(h[3])))));
    r.push(&format!(
        "(BOUNDED_SURFACE() B_SPLINE_SURFACE({shape}) B_SPLINE_SURFACE_WITH_KNOTS({knots}) \
         GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_SURFACE({weights}) REPRESENTATION_ITEM('') SURFACE())"
    ))
}
