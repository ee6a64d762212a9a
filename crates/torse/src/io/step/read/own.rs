//! The faces of a file that this program wrote, number for number: nothing is mended, placed or converted.
//!
//! Knows the records that the writer of panels uses, and no others; whatever else stands in the place of one of them
//! is named.

use super::records::{as_number, as_reference, each_record, record_at, Args, Fault, Record, Records};
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
pub(crate) fn exact(bytes: &[u8]) -> Result<Vec<WrittenExact>, String> {
    each(bytes, exact_face)
}

/// What `read` makes of every face of a file.
fn each<T>(bytes: &[u8], read: impl Fn(&Own, u64) -> Result<T, Fault>) -> Result<Vec<T>, String> {
    let text = decoded(bytes);
    let own = Own::parse(&text)?;
    let all = own.shown().and_then(|ids| ids.into_iter().map(|id| read(&own, id)).collect());
    all.map_err(|f| if f.entity == 0 { f.reason } else { format!("#{}: {}", f.entity, f.reason) })
}

/// A file with where its records are, which are read anew whenever they are asked for: values of many panels take several times
/// the memory of their text.
struct Own<'a> {
    text: &'a str,
    /// Numbers of the records and where these begin, in ascending order.
    places: Vec<(u64, usize)>,
    /// Records about units, and the shapes that a CAD program shows.
    few: Records<'a>,
    /// Number of faces.
    faces: usize,
}

impl<'a> Own<'a> {
    fn parse(text: &'a str) -> Result<Self, String> {
        let mut own = Self { text, places: Vec::new(), few: Records::default(), faces: 0 };
        let damage = each_record(text, &mut |id, at, record| {
            own.places.push((id, at));
            own.faces += usize::from(record.part(FACE).is_some());
            if record.parts.iter().any(|p| p.name == SHAPE || p.name.contains("UNIT")) {
                own.few.insert(id, record);
            }
        });
        let damage = damage.ok_or("there is no data section")?;
        own.places.sort_unstable();
        let repeated = own.places.windows(2).any(|w| w[0].0 == w[1].0);
        if damage.truncated || damage.unreadable > 0 || repeated {
            return Err("it is cut short or damaged".into());
        }
        Ok(own)
    }

    /// The record `#id`.
    fn get(&self, id: u64) -> Result<Record<'a>, Fault> {
        let place = self.places.binary_search_by_key(&id, |p| p.0).ok();
        let record = place.and_then(|k| record_at(self.text, self.places[k].1));
        record.ok_or_else(|| Fault::new(id, format!("#{id} is not in the file")))
    }

    /// The faces that a CAD program shows.
    fn shown(&self) -> Result<Vec<u64>, Fault> {
        for id in self.few.all(&["GLOBAL_UNIT_ASSIGNED_CONTEXT"]) {
            let unit = units::of_context(&self.few, id);
            if unit.fault.is_some() || unit.length.to_bits() != 1.0f64.to_bits() {
                return Err(Fault::new(id, "the unit of lengths is not the millimetre"));
            }
        }
        // From the shape down, so that nothing counts that no CAD program would show.
        let mut out = Vec::new();
        for shape in self.few.all(&[SHAPE]) {
            for model in self.below(shape, 1, "SHELL_BASED_SURFACE_MODEL")? {
                for shell in self.below(model, 1, "OPEN_SHELL")? {
                    out.extend(self.below(shell, 1, FACE)?);
                }
            }
        }
        if out.len() != self.faces {
            return Err(Fault::new(0, "a face belongs to no shell, or to several"));
        }
        Ok(out)
    }

    /// Entities of one kind in a list of references.
    fn below(&self, id: u64, index: usize, kind: &str) -> Result<Vec<u64>, Fault> {
        let all = self.get(id)?.simple(id)?.references(index)?;
        Ok(all.into_iter().filter(|&id| self.get(id).is_ok_and(|r| r.name() == kind)).collect())
    }
}

/// Keyword of faces.
const FACE: &str = "ADVANCED_FACE";
/// Keyword of what a file shows.
const SHAPE: &str = "MANIFOLD_SURFACE_SHAPE_REPRESENTATION";

fn face(own: &Own, id: u64) -> Result<WrittenFace, Fault> {
    let record = own.get(id)?;
    let a = record.args(id, FACE)?;
    let support = a.reference(2)?;
    let mut loops = Vec::new();
    for bound in a.references(1)? {
        let uses = uses(own, bound)?;
        loops.push(uses.into_iter().map(|u| edge(own, u, support)).collect::<Result<Vec<_>, _>>()?);
    }
    Ok(WrittenFace {
        entity: id,
        name: a.text(0).to_owned(),
        reversed: !a.logical(3, true),
        surface: surface(own, support)?,
        loops,
    })
}

/// An untrimmed strip: one loop, the normal that of the surface.
fn strip(own: &Own, id: u64) -> Result<WrittenStrip, Fault> {
    let record = own.get(id)?;
    let a = record.args(id, FACE)?;
    let [bound] = a.references(1)?[..] else { return Err(Fault::new(id, "the face has several loops")) };
    let outer = own.get(bound)?;
    let b = outer.args(bound, "FACE_OUTER_BOUND")?;
    if !(b.logical(2, false) && a.logical(3, false)) {
        return Err(Fault::new(id, "the face is turned over"));
    }
    let uses = edge_loop(own, b.reference(1)?)?;
    let surface = support(own, a.reference(2)?)?;
    let sides = uses.into_iter().map(|u| side(own, u)).collect::<Result<_, _>>()?;
    Ok(WrittenStrip { entity: id, name: a.text(0).to_owned(), surface, sides })
}

/// A face on an exact surface, with its loops.
fn exact_face(own: &Own, id: u64) -> Result<WrittenExact, Fault> {
    let record = own.get(id)?;
    let a = record.args(id, FACE)?;
    let mut loops = Vec::new();
    for bound in a.references(1)? {
        let uses = uses(own, bound)?;
        loops.push(uses.into_iter().map(|u| side(own, u)).collect::<Result<_, _>>()?);
    }
    let surface = support(own, a.reference(2)?)?;
    Ok(WrittenExact { entity: id, name: a.text(0).to_owned(), reversed: !a.logical(3, true), surface, loops })
}

/// The edges that a bound of a face uses.
fn uses(own: &Own, bound: u64) -> Result<Vec<u64>, Fault> {
    let record = own.get(bound)?;
    let b = record.simple(bound)?;
    if !matches!(record.name(), "FACE_OUTER_BOUND" | "FACE_BOUND") || !b.logical(2, false) {
        return Err(Fault::new(bound, "a bound is turned over"));
    }
    edge_loop(own, b.reference(1)?)
}

/// The edges of a loop.
fn edge_loop(own: &Own, id: u64) -> Result<Vec<u64>, Fault> {
    own.get(id)?.args(id, "EDGE_LOOP")?.references(1)
}

/// A plane, cylinder, cone or spline.
fn support(own: &Own, id: u64) -> Result<WrittenBase, Fault> {
    let record = own.get(id)?;
    let s = record.simple(id)?;
    let placed = || placement(own, s.reference(1)?);
    Ok(match record.name() {
        "PLANE" => {
            let (point, normal) = placed()?;
            WrittenBase::Plane { point, normal }
        }
        "CYLINDRICAL_SURFACE" => {
            let ((point, axis), radius) = (placed()?, s.number(2)?);
            WrittenBase::Cylinder { point, axis, radius }
        }
        "CONICAL_SURFACE" => {
            let (point, axis) = placed()?;
            WrittenBase::Cone { point, axis, radius: s.number(2)?, half_angle: s.number(3)? }
        }
        _ => WrittenBase::Spline(surface(own, id)?),
    })
}

/// Origin and axis of a placement.
fn placement(own: &Own, id: u64) -> Result<([f64; 3], [f64; 3]), Fault> {
    let record = own.get(id)?;
    let place = record.args(id, "AXIS2_PLACEMENT_3D")?;
    Ok((point(own, place.reference(1)?)?, direction(own, place.reference(2)?)?))
}

fn side(own: &Own, id: u64) -> Result<WrittenSide, Fault> {
    let use_ = oriented(own, id)?;
    let given = own.get(use_.curve)?;
    let in_space = match given.name() {
        "SURFACE_CURVE" => given.simple(use_.curve)?.reference(1)?,
        _ => use_.curve,
    };
    let record = own.get(in_space)?;
    let c = record.simple(in_space)?;
    let curve = match record.name() {
        "LINE" => {
            let along = c.reference(2)?;
            let along = own.get(along)?.args(along, "VECTOR")?.reference(1)?;
            WrittenCurve::Line { point: point(own, c.reference(1)?)?, direction: direction(own, along)? }
        }
        "CIRCLE" => {
            let (centre, axis) = placement(own, c.reference(1)?)?;
            WrittenCurve::Circle { centre, axis, radius: c.number(2)? }
        }
        _ => {
            let (curve, weights) = spline(own, in_space)?;
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

fn oriented(own: &Own, id: u64) -> Result<Oriented, Fault> {
    let record = own.get(id)?;
    let u = record.args(id, "ORIENTED_EDGE")?;
    let entity = u.reference(3)?;
    let edge = own.get(entity)?;
    let e = edge.args(entity, "EDGE_CURVE")?;
    let vertex = |k: usize| -> Result<[f64; 3], Fault> {
        let vertex = e.reference(k)?;
        point(own, own.get(vertex)?.args(vertex, "VERTEX_POINT")?.reference(1)?)
    };
    if !e.logical(4, false) {
        return Err(Fault::new(entity, "the edge runs against its curve"));
    }
    Ok(Oriented { entity, forward: u.logical(4, true), vertices: [vertex(1)?, vertex(2)?], curve: e.reference(3)? })
}

fn edge(own: &Own, id: u64, support: u64) -> Result<WrittenEdge, Fault> {
    let Oriented { entity, forward, vertices, curve: both } = oriented(own, id)?;
    let record = own.get(both)?;
    if !matches!(record.name(), "SURFACE_CURVE" | "SEAM_CURVE") {
        return Err(Fault::new(both, "the edge has no curve on its surface"));
    }
    let c = record.simple(both)?;
    let mut trims = Vec::new();
    for p in c.references(2)? {
        let record = own.get(p)?;
        let a = record.args(p, "PCURVE")?;
        if a.reference(1)? == support {
            let r = a.reference(2)?;
            trims.extend(own.get(r)?.args(r, "DEFINITIONAL_REPRESENTATION")?.references(1)?);
        }
    }
    let [trim] = trims[..] else {
        return Err(Fault::new(both, format!("the edge has {} curves on the face's surface", trims.len())));
    };
    Ok(WrittenEdge { entity, forward, vertices, curve: curve(own, c.reference(1)?)?, trim: curve(own, trim)? })
}

fn point<const D: usize>(own: &Own, id: u64) -> Result<[f64; D], Fault> {
    let x = own.get(id)?.args(id, "CARTESIAN_POINT")?.numbers(1)?;
    <[f64; D]>::try_from(x).map_err(|_| Fault::new(id, format!("a point does not have {D} coordinates")))
}

fn direction(own: &Own, id: u64) -> Result<[f64; 3], Fault> {
    let x = own.get(id)?.args(id, "DIRECTION")?.numbers(1)?;
    <[f64; 3]>::try_from(x).map_err(|_| Fault::new(id, "a direction does not have 3 coordinates"))
}

fn points<const D: usize>(own: &Own, list: &[Value]) -> Result<Vec<[f64; D]>, Fault> {
    list.iter()
        .map(|v| point(own, as_reference(v).ok_or_else(|| Fault::new(0, "a control point is no reference"))?))
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

fn curve<const D: usize>(own: &Own, id: u64) -> Result<Curve<D>, Fault> {
    let record = own.get(id)?;
    if record.parts.len() != 1 {
        return Err(Fault::new(id, "the curve is rational"));
    }
    let a = record.args(id, "B_SPLINE_CURVE_WITH_KNOTS")?;
    let degree = a.count(1)?;
    let control = points(own, a.list(2)?)?;
    let knots = knots(&a, degree, 6, 7, control.len())?;
    Ok(Curve { knots, control })
}

/// A curve of space with its weights; none for a polynomial one.
fn spline(own: &Own, id: u64) -> Result<(Curve<3>, Vec<f64>), Fault> {
    let record = own.get(id)?;
    if record.parts.len() == 1 {
        return Ok((curve(own, id)?, Vec::new()));
    }
    let (shape, lists) = (record.args(id, "B_SPLINE_CURVE")?, record.args(id, "B_SPLINE_CURVE_WITH_KNOTS")?);
    let control = points(own, shape.list(1)?)?;
    let knots = knots(&lists, shape.count(0)?, 0, 1, control.len())?;
    Ok((Curve { knots, control }, record.args(id, "RATIONAL_B_SPLINE_CURVE")?.numbers(0)?))
}

fn surface(own: &Own, id: u64) -> Result<WrittenSurface, Fault> {
    let record = own.get(id)?;
    let simple = record.parts.len() == 1;
    let (shape, lists) = if simple {
        let all = record.args(id, "B_SPLINE_SURFACE_WITH_KNOTS")?;
        (
            Args { id, values: all.values.get(1..).unwrap_or_default() },
            Args { id, values: all.values.get(8..).unwrap_or_default() },
        )
    } else {
        (record.args(id, "B_SPLINE_SURFACE")?, record.args(id, "B_SPLINE_SURFACE_WITH_KNOTS")?)
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
            all.extend(points::<3>(own, l)?);
        }
    }
    let mut weights = Vec::new();
    if !simple {
        for v in record.args(id, "RATIONAL_B_SPLINE_SURFACE")?.list(0)? {
            if let Value::List(l) = v {
                weights.extend(l.iter().filter_map(as_number));
            }
        }
    }
    let ku = knots(&lists, shape.count(0)?, 0, 2, net.len())?;
    let kv = knots(&lists, shape.count(1)?, 1, 3, row)?;
    Ok(WrittenSurface { knots: [ku, kv], points: all, weights })
}
