//! The faces of a file that this program wrote, number for number: nothing is mended, placed or converted.
//!
//! Knows the records that the writer of panels uses, and no others; whatever else stands in the place of one of them
//! is named.

use super::records::{as_number, as_reference, Args, Fault, Records};
use super::token::Value;
use super::{decoded, units};
use crate::patchwork::written::{
    WrittenBase, WrittenCurve, WrittenEdge, WrittenExact, WrittenFace, WrittenSide, WrittenStrip, WrittenSurface,
};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;

/// Reads back all faces of a file of panels.
///
/// # Errors
/// In plain words, with the entity: what is not as the writer writes it.
pub fn faces(bytes: &[u8]) -> Result<Vec<WrittenFace>, String> {
    each(bytes, face)
}

/// Reads back all faces of a file of untrimmed strips.
///
/// # Errors
/// As [`faces`].
pub fn strips(bytes: &[u8]) -> Result<Vec<WrittenStrip>, String> {
    each(bytes, strip)
}

/// Reads back all faces of a file of exact cones, cylinders and planes.
///
/// # Errors
/// As [`faces`].
pub fn exact(bytes: &[u8]) -> Result<Vec<WrittenExact>, String> {
    each(bytes, exact_face)
}

/// What `read` makes of every face of a file.
fn each<T>(bytes: &[u8], read: impl Fn(&Records, u64) -> Result<T, Fault>) -> Result<Vec<T>, String> {
    let text = decoded(bytes);
    let records = Records::parse(&text).ok_or("there is no data section")?;
    if records.truncated || records.unreadable > 0 || !records.repeated.is_empty() {
        return Err("it is cut short or damaged".into());
    }
    let all = shown(&records).and_then(|ids| ids.into_iter().map(|id| read(&records, id)).collect());
    all.map_err(|f| if f.entity == 0 { f.reason } else { format!("#{}: {}", f.entity, f.reason) })
}

/// The faces that a CAD program shows.
fn shown(records: &Records) -> Result<Vec<u64>, Fault> {
    for id in records.all(&["GLOBAL_UNIT_ASSIGNED_CONTEXT"]) {
        let unit = units::of_context(records, id);
        if unit.fault.is_some() || unit.length.to_bits() != 1.0f64.to_bits() {
            return Err(Fault::new(id, "the unit of lengths is not the millimetre"));
        }
    }
    // From the shape down, so that nothing counts that no CAD program would show.
    let mut out = Vec::new();
    for shape in records.all(&["MANIFOLD_SURFACE_SHAPE_REPRESENTATION"]) {
        for model in below(records, shape, 1, "SHELL_BASED_SURFACE_MODEL")? {
            for shell in below(records, model, 1, "OPEN_SHELL")? {
                out.extend(below(records, shell, 1, "ADVANCED_FACE")?);
            }
        }
    }
    if out.len() != records.all(&["ADVANCED_FACE"]).len() {
        return Err(Fault::new(0, "a face belongs to no shell, or to several"));
    }
    Ok(out)
}

/// Entities of one kind in a list of references.
fn below(records: &Records, id: u64, index: usize, kind: &str) -> Result<Vec<u64>, Fault> {
    let all = records.simple(id)?.references(index)?;
    Ok(all.into_iter().filter(|&id| records.name(id) == kind).collect())
}

fn face(records: &Records, id: u64) -> Result<WrittenFace, Fault> {
    let a = records.args(id, "ADVANCED_FACE")?;
    let support = a.reference(2)?;
    let mut loops = Vec::new();
    for bound in a.references(1)? {
        let b = records.simple(bound)?;
        if !matches!(records.name(bound), "FACE_OUTER_BOUND" | "FACE_BOUND") || !b.logical(2, false) {
            return Err(Fault::new(bound, "a bound is turned over"));
        }
        let uses = records.args(b.reference(1)?, "EDGE_LOOP")?.references(1)?;
        loops.push(uses.into_iter().map(|u| edge(records, u, support)).collect::<Result<Vec<_>, _>>()?);
    }
    Ok(WrittenFace {
        entity: id,
        name: a.text(0).to_owned(),
        reversed: !a.logical(3, true),
        surface: surface(records, support)?,
        loops,
    })
}

/// An untrimmed strip: one loop, the normal that of the surface.
fn strip(records: &Records, id: u64) -> Result<WrittenStrip, Fault> {
    let a = records.args(id, "ADVANCED_FACE")?;
    let [bound] = a.references(1)?[..] else { return Err(Fault::new(id, "the face has several loops")) };
    let b = records.args(bound, "FACE_OUTER_BOUND")?;
    if !(b.logical(2, false) && a.logical(3, false)) {
        return Err(Fault::new(id, "the face is turned over"));
    }
    let uses = records.args(b.reference(1)?, "EDGE_LOOP")?.references(1)?;
    let base = a.reference(2)?;
    let surface = support(records, base)?;
    let sides = uses.into_iter().map(|u| side(records, u)).collect::<Result<_, _>>()?;
    Ok(WrittenStrip { entity: id, name: a.text(0).to_owned(), surface, sides })
}

/// A face on an exact surface, with its loops.
fn exact_face(records: &Records, id: u64) -> Result<WrittenExact, Fault> {
    let a = records.args(id, "ADVANCED_FACE")?;
    let mut loops = Vec::new();
    for bound in a.references(1)? {
        let b = records.simple(bound)?;
        if !matches!(records.name(bound), "FACE_OUTER_BOUND" | "FACE_BOUND") || !b.logical(2, false) {
            return Err(Fault::new(bound, "a bound is turned over"));
        }
        let uses = records.args(b.reference(1)?, "EDGE_LOOP")?.references(1)?;
        loops.push(uses.into_iter().map(|u| side(records, u)).collect::<Result<_, _>>()?);
    }
    let surface = support(records, a.reference(2)?)?;
    Ok(WrittenExact { entity: id, name: a.text(0).to_owned(), reversed: !a.logical(3, true), surface, loops })
}

/// A plane, cylinder, cone or spline.
fn support(records: &Records, id: u64) -> Result<WrittenBase, Fault> {
    let placed = || placement(records, records.simple(id)?.reference(1)?);
    Ok(match records.name(id) {
        "PLANE" => {
            let (point, normal) = placed()?;
            WrittenBase::Plane { point, normal }
        }
        "CYLINDRICAL_SURFACE" => {
            let ((point, axis), radius) = (placed()?, records.simple(id)?.number(2)?);
            WrittenBase::Cylinder { point, axis, radius }
        }
        "CONICAL_SURFACE" => {
            let ((point, axis), s) = (placed()?, records.simple(id)?);
            WrittenBase::Cone { point, axis, radius: s.number(2)?, half_angle: s.number(3)? }
        }
        _ => WrittenBase::Spline(surface(records, id)?),
    })
}

/// Origin and axis of a placement.
fn placement(records: &Records, id: u64) -> Result<([f64; 3], [f64; 3]), Fault> {
    let place = records.args(id, "AXIS2_PLACEMENT_3D")?;
    Ok((point(records, place.reference(1)?)?, direction(records, place.reference(2)?)?))
}

fn side(records: &Records, id: u64) -> Result<WrittenSide, Fault> {
    let use_ = oriented(records, id)?;
    let in_space = match records.name(use_.curve) {
        "SURFACE_CURVE" => records.simple(use_.curve)?.reference(1)?,
        _ => use_.curve,
    };
    let curve = match records.name(in_space) {
        "LINE" => {
            let l = records.simple(in_space)?;
            let along = records.args(l.reference(2)?, "VECTOR")?.reference(1)?;
            WrittenCurve::Line { point: point(records, l.reference(1)?)?, direction: direction(records, along)? }
        }
        "CIRCLE" => {
            let c = records.simple(in_space)?;
            let (centre, axis) = placement(records, c.reference(1)?)?;
            WrittenCurve::Circle { centre, axis, radius: c.number(2)? }
        }
        _ => {
            let (curve, weights) = spline(records, in_space)?;
            WrittenCurve::Spline { curve, weights }
        }
    };
    Ok(WrittenSide { entity: use_.entity, forward: use_.forward, vertices: use_.vertices, curve })
}

/// An edge as a loop names it.
struct Oriented {
    entity: u64,
    forward: bool,
    vertices: [[f64; 3]; 2],
    curve: u64,
}

fn oriented(records: &Records, id: u64) -> Result<Oriented, Fault> {
    let u = records.args(id, "ORIENTED_EDGE")?;
    let entity = u.reference(3)?;
    let e = records.args(entity, "EDGE_CURVE")?;
    let vertex = |k: usize| -> Result<[f64; 3], Fault> {
        point(records, records.args(e.reference(k)?, "VERTEX_POINT")?.reference(1)?)
    };
    if !e.logical(4, false) {
        return Err(Fault::new(entity, "the edge runs against its curve"));
    }
    Ok(Oriented { entity, forward: u.logical(4, true), vertices: [vertex(1)?, vertex(2)?], curve: e.reference(3)? })
}

fn edge(records: &Records, id: u64, support: u64) -> Result<WrittenEdge, Fault> {
    let Oriented { entity, forward, vertices, curve: both } = oriented(records, id)?;
    if !matches!(records.name(both), "SURFACE_CURVE" | "SEAM_CURVE") {
        return Err(Fault::new(both, "the edge has no curve on its surface"));
    }
    let c = records.simple(both)?;
    let mut trims = Vec::new();
    for p in c.references(2)? {
        let p = records.args(p, "PCURVE")?;
        if p.reference(1)? == support {
            let r = records.args(p.reference(2)?, "DEFINITIONAL_REPRESENTATION")?;
            trims.extend(r.references(1)?);
        }
    }
    let [trim] = trims[..] else {
        return Err(Fault::new(both, format!("the edge has {} curves on the face's surface", trims.len())));
    };
    Ok(WrittenEdge { entity, forward, vertices, curve: curve(records, c.reference(1)?)?, trim: curve(records, trim)? })
}

fn point<const D: usize>(records: &Records, id: u64) -> Result<[f64; D], Fault> {
    let x = records.args(id, "CARTESIAN_POINT")?.numbers(1)?;
    <[f64; D]>::try_from(x).map_err(|_| Fault::new(id, format!("a point does not have {D} coordinates")))
}

fn direction(records: &Records, id: u64) -> Result<[f64; 3], Fault> {
    let x = records.args(id, "DIRECTION")?.numbers(1)?;
    <[f64; 3]>::try_from(x).map_err(|_| Fault::new(id, "a direction does not have 3 coordinates"))
}

fn points<const D: usize>(records: &Records, list: &[Value]) -> Result<Vec<[f64; D]>, Fault> {
    list.iter()
        .map(|v| point(records, as_reference(v).ok_or_else(|| Fault::new(0, "a control point is no reference"))?))
        .collect()
}

/// Knots from multiplicities and values.
fn knots(a: &Args, degree: usize, first: usize, second: usize, control: usize) -> Result<Knots, Fault> {
    let (counts, values) = (a.numbers(first)?, a.numbers(second)?);
    if counts.len() != values.len() {
        return Err(Fault::new(a.id, "knots and multiplicities differ in number"));
    }
    let all: Vec<f64> =
        counts.iter().zip(&values).flat_map(|(&n, &v)| std::iter::repeat_n(v, n.clamp(0.0, 64.0) as usize)).collect();
    Knots::new(degree, all, control).map_err(|e| Fault::new(a.id, e.to_string()))
}

fn curve<const D: usize>(records: &Records, id: u64) -> Result<Curve<D>, Fault> {
    if records.get(id)?.parts.len() != 1 {
        return Err(Fault::new(id, "the curve is rational"));
    }
    let a = records.args(id, "B_SPLINE_CURVE_WITH_KNOTS")?;
    let degree = a.count(1)?;
    let control = points(records, a.list(2)?)?;
    let knots = knots(&a, degree, 6, 7, control.len())?;
    Ok(Curve { knots, control })
}

/// A curve of space with its weights; none for a polynomial one.
fn spline(records: &Records, id: u64) -> Result<(Curve<3>, Vec<f64>), Fault> {
    if records.get(id)?.parts.len() == 1 {
        return Ok((curve(records, id)?, Vec::new()));
    }
    let (shape, lists) = (records.args(id, "B_SPLINE_CURVE")?, records.args(id, "B_SPLINE_CURVE_WITH_KNOTS")?);
    let control = points(records, shape.list(1)?)?;
    let knots = knots(&lists, shape.count(0)?, 0, 1, control.len())?;
    Ok((Curve { knots, control }, records.args(id, "RATIONAL_B_SPLINE_CURVE")?.numbers(0)?))
}

fn surface(records: &Records, id: u64) -> Result<WrittenSurface, Fault> {
    let simple = records.get(id)?.parts.len() == 1;
    let (shape, lists) = if simple {
        let all = records.args(id, "B_SPLINE_SURFACE_WITH_KNOTS")?;
        (
            Args { id, values: all.values.get(1..).unwrap_or_default() },
            Args { id, values: all.values.get(8..).unwrap_or_default() },
        )
    } else {
        (records.args(id, "B_SPLINE_SURFACE")?, records.args(id, "B_SPLINE_SURFACE_WITH_KNOTS")?)
    };
    let rows = |list: &'_ [Value]| -> Result<usize, Fault> {
        let lengths: Vec<usize> = list.iter().map(|v| if let Value::List(l) = v { l.len() } else { 0 }).collect();
        match lengths.first() {
            Some(&n) if n > 0 && lengths.iter().all(|&l| l == n) => Ok(n),
            _ => Err(Fault::new(id, "the control points form no net")),
        }
    };
    let net = shape.list(2)?;
    let row = rows(net)?;
    let mut all = Vec::with_capacity(net.len() * row);
    for v in net {
        if let Value::List(l) = v {
            all.extend(points::<3>(records, l)?);
        }
    }
    let mut weights = Vec::new();
    if !simple {
        for v in records.args(id, "RATIONAL_B_SPLINE_SURFACE")?.list(0)? {
            if let Value::List(l) = v {
                weights.extend(l.iter().filter_map(as_number));
            }
        }
    }
    let ku = knots(&lists, shape.count(0)?, 0, 2, net.len())?;
    let kv = knots(&lists, shape.count(1)?, 1, 3, row)?;
    Ok(WrittenSurface { knots: [ku, kv], points: all, weights })
}
