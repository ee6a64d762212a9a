//! Polysurfaces: faces on surfaces, bounded by loops of trims, which use edges.

mod old;
mod tables;

use super::bytes::{fault, Cursor, Fault, Reading};
use super::curves;
use super::records;
use super::surfaces;
use crate::brep::raw::{PlaneTrace, RawEdge, RawFace, RawLoop, RawRegion, SurfaceDeviation};
use crate::brep::space_curve::Arc;
use crate::brep::support_surface::SupportSurface;
use crate::spline::surface::Surface;
use std::collections::HashMap;
pub(super) use tables::Brep;
use tables::{Edge, Face, Loop, Trim, Vertex, OUTER, SINGULAR};

/// Writers from this date on store domains of edges and trims.
const EDGES_HAVE_DOMAINS: u32 = 200_206_180;
/// Archives from this version on may do so.
const FIRST_WITH_DOMAINS: u32 = 3;
/// Bytes of a trim after its two tolerances.
const REST_OF_TRIM: usize = 48 + 16;

/// Kinds of trims that are no edge of the face: a curve or a point inside.
const LOOSE_TRIMS: [i32; 2] = [5, 6];
/// Curves nearer than this share of their length lie at one place: trims keep to a tolerance, sides of a surface do not
/// come so near each other in its parameters.
const APART: f64 = 1e-3;
/// Kinds of loops that bound nothing.
const LOOSE_LOOPS: [i32; 2] = [4, 5];

/// The entry of a table by the index that the file gives.
fn entry<'t, T>(table: &'t [T], index: i32, what: &str) -> Reading<&'t T> {
    let found = usize::try_from(index).ok().and_then(|i| table.get(i));
    found.ok_or_else(|| Fault(format!("there is no {what} {index} among {}", table.len())))
}

/// A table in a chunk of its own.
fn table<T>(c: &mut Cursor, each: usize, read: impl Fn(&mut Cursor) -> Reading<T>) -> Reading<Vec<T>> {
    let mut body = c.anonymous()?;
    let (major, minor) = body.version()?;
    if major != 1 {
        return fault(format!("a table of a polysurface has the unknown version {major}.{minor}"));
    }
    let n = body.count(each)?;
    (0..n).map(|_| read(&mut body)).collect()
}

/// A table of objects, some of which may be missing. What is wrong with one stays with it.
fn objects<T>(c: &mut Cursor, read: impl Fn(records::Object) -> Reading<T>) -> Reading<Vec<Reading<T>>> {
    table(c, 4, |body| {
        if body.i32()? != 1 {
            return Ok(fault("it is missing in the file"));
        }
        // A chunk that is framed badly leaves no way to the next.
        Ok(read(records::object(body)?))
    })
}

/// Reads the tables; `scale` is the length of the file's unit in mm.
pub(super) fn read(mut c: Cursor, scale: f64) -> Reading<Brep> {
    let (major, minor) = c.version()?;
    match major {
        2 => return old::read(c, scale),
        3 => {}
        _ => return fault(format!("a polysurface has the unknown version {major}.{minor}; save it anew in Rhino")),
    }
    let has_domains = c.format.version >= FIRST_WITH_DOMAINS && c.format.writer >= EDGES_HAVE_DOMAINS;
    let out = Brep {
        plane_curves: objects(&mut c, |o| curves::curve(o, 1.0))?,
        curves: objects(&mut c, |o| curves::curve(o, scale))?,
        surfaces: objects(&mut c, |o| surfaces::surface(o, scale))?,
        vertices: table(&mut c, 40, |b| vertex(b, scale))?,
        edges: table(&mut c, 44, |b| {
            let edge = edge(b, scale)?;
            if has_domains {
                b.interval()?;
            }
            Ok(edge)
        })?,
        trims: table(&mut c, 68 + REST_OF_TRIM, |b| trim(b, has_domains))?,
        loops: table(&mut c, 16, |b| {
            b.skip(4)?;
            let out = Loop { trims: b.integers()?, kind: b.i32()? };
            b.skip(4)?;
            Ok(out)
        })?,
        faces: table(&mut c, 20, |b| {
            b.skip(4)?;
            let out = Face { loops: b.integers()?, surface: b.i32()?, reversed: b.i32()? != 0 };
            b.skip(4)?;
            Ok(out)
        })?,
    };
    Ok(out)
}

fn vertex(b: &mut Cursor, scale: f64) -> Reading<Vertex> {
    b.skip(4)?;
    let point = curves::point(b, scale)?;
    b.integers()?;
    Ok(Vertex { point, tolerance: b.f64()? * scale })
}

fn edge(b: &mut Cursor, scale: f64) -> Reading<Edge> {
    b.skip(4)?;
    let (curve, reversed) = (b.i32()?, b.i32()? != 0);
    let part = b.interval()?;
    let ends = [b.i32()?, b.i32()?];
    b.integers()?;
    Ok(Edge { curve, reversed, part, ends, tolerance: b.f64()? * scale })
}

fn trim(b: &mut Cursor, has_domains: bool) -> Reading<Trim> {
    b.skip(4)?;
    let (curve, part) = (b.i32()?, b.interval()?);
    let edge = b.i32()?;
    b.skip(8)?;
    let (reversed, kind) = (b.i32()? != 0, b.i32()?);
    // Whether it is a parameter line, its loop, its tolerances.
    b.skip(4 + 4 + 16)?;
    let rest = b.take(REST_OF_TRIM)?;
    // After the domain of the trim; where there is none, points stand there.
    let backwards = has_domains && rest[16] == 1;
    Ok(Trim { curve, part, backwards, edge, reversed, kind })
}

impl Brep {
    /// Number of faces.
    pub fn count(&self) -> usize {
        self.faces.len()
    }

    /// Face number `index`; `tolerance` is the distance below which the file calls points the same, mm.
    pub fn face(&self, index: usize, tolerance: f64) -> Reading<RawFace> {
        let Some(face) = self.faces.get(index) else { return fault("there is no such face") };
        let patch = entry(&self.surfaces, face.surface, "surface")?;
        let patch = patch.as_ref().map_err(|f| Fault(format!("its surface {}: {}", face.surface, f.0)))?;
        let mut uncertainty = tolerance;
        let mut loops = Vec::new();
        for &l in &face.loops {
            let l = entry(&self.loops, l, "loop")?;
            if !LOOSE_LOOPS.contains(&l.kind) {
                loops.push(RawLoop { edges: self.edges_of(l, &mut uncertainty)?, outer: l.kind == OUTER });
            }
        }
        if let (SupportSurface::Spline(s), [None, None]) = (&patch.support, patch.support.periods()) {
            self.part_seams(&mut loops, &patch.support, &s.surface);
        }
        if face.reversed {
            // The file's loops run about the normal of the surface, ours about that of the face.
            loops = loops.iter().map(RawLoop::reversed).collect();
        }
        if loops.is_empty() {
            return fault("it has no boundary");
        }
        Ok(RawFace {
            entity: 0,
            name: String::new(),
            part: String::new(),
            kind: patch.kind,
            support: patch.support.clone(),
            same_sense: face.reversed == patch.flipped,
            region: RawRegion::Loops(loops),
            surface_deviation: SurfaceDeviation::NONE,
            uncertainty,
        })
    }

    fn edges_of(&self, l: &Loop, uncertainty: &mut f64) -> Reading<Vec<RawEdge>> {
        let mut out = Vec::new();
        for &index in &l.trims {
            let trim = entry(&self.trims, index, "trim")?;
            if trim.kind == SINGULAR || LOOSE_TRIMS.contains(&trim.kind) {
                continue;
            }
            let edge = entry(&self.edges, trim.edge, "edge")?;
            *uncertainty = uncertainty.max(edge.tolerance);
            let mut vertices = None;
            if let (Ok(p), Ok(q)) = (self.vertex(edge.ends[0]), self.vertex(edge.ends[1])) {
                *uncertainty = uncertainty.max(p.tolerance).max(q.tolerance);
                vertices = Some([p.point, q.point]);
            }
            let path = self.path(edge).map_err(|f| Fault(format!("its edge {}: {}", trim.edge, f.0)))?;
            let raw = RawEdge { entity: trim.edge as u64 + 1, forward: true, path, vertices, trace: None };
            let raw = if trim.reversed { raw.reversed() } else { raw };
            let trace = self.trace(trim, &raw.path);
            out.push(RawEdge { trace, ..raw });
        }
        Ok(out)
    }

    /// An edge that a face uses twice on a surface without a seam, at different places of the parameter plane, joins two
    /// sides that nearly meet: it is two edges. There, along sides that nearly meet, and where an edge has its feet elsewhere,
    /// on a sheet of the surface that lies along its own, the curves in the parameter plane say which is meant; elsewhere the
    /// edges in space are followed.
    fn part_seams(&self, loops: &mut [RawLoop], support: &SupportSurface, surface: &Surface) {
        let (u, v) = surface.domain();
        let size = [u.1 - u.0, v.1 - v.0];
        let near = APART * surface.bbox().diagonal();
        let mut uses: HashMap<u64, usize> = HashMap::new();
        for e in loops.iter().flat_map(|l| &l.edges) {
            *uses.entry(e.entity).or_default() += 1;
        }
        let mut first: HashMap<u64, PlaneTrace> = HashMap::new();
        for e in loops.iter_mut().flat_map(|l| &mut l.edges) {
            let Some(trace) = e.trace.take() else { continue };
            if uses.get(&e.entity) != Some(&2) {
                let is_elsewhere = |s: f64| {
                    let t = e.path[0].from + s * (e.path[0].to - e.path[0].from);
                    let (foot, q) = (support.foot(&e.path[0].curve.point(t), None), trace.curve.point(t));
                    (0..2).any(|k| (foot[k] - q[k]).abs() > APART * size[k]) || meets(surface, [q[0], q[1]], near)
                };
                let is_elsewhere = [0.25, 0.5, 0.75].into_iter().any(is_elsewhere);
                e.trace = Some(trace).filter(|_| is_elsewhere);
                continue;
            }
            match first.get(&e.entity) {
                Some(other) if apart(other, &trace, &e.path[0]) => e.entity += self.edges.len() as u64,
                Some(_) => {}
                None => drop(first.insert(e.entity, trace.clone())),
            }
            e.trace = Some(trace);
        }
    }

    /// The trim's curve in the parameter plane, with the parameter of its only curve in space.
    fn trace(&self, trim: &Trim, path: &[Arc]) -> Option<PlaneTrace> {
        let [arc] = path else { return None };
        // Natural parameters of splines are the file's.
        let curve = entry(&self.plane_curves, trim.curve, "curve").ok()?.as_ref().ok()?;
        let plane = curve.part(trim.part).ok()?;
        let [plane] = &plane[..] else { return None };
        let plane = if trim.backwards { plane.reversed() } else { plane.clone() };
        Some(PlaneTrace { curve: curves::run_over(&plane, [arc.from, arc.to])?, scale: [1.0; 2] })
    }

    fn vertex(&self, index: i32) -> Reading<&Vertex> {
        entry(&self.vertices, index, "vertex")
    }

    /// The curves of all edges.
    pub fn paths(&self) -> impl Iterator<Item = Reading<Vec<Arc>>> + '_ {
        self.edges.iter().map(|e| self.path(e))
    }

    /// The curve of an edge in its direction.
    fn path(&self, edge: &Edge) -> Reading<Vec<Arc>> {
        let curve = entry(&self.curves, edge.curve, "curve")?;
        let path = curve.as_ref().map_err(Clone::clone)?.part(edge.part)?;
        Ok(if edge.reversed { path.iter().rev().map(Arc::reversed).collect() } else { path })
    }
}

/// Whether a place lies on a side of the domain that comes near the side opposite there, in space.
fn meets(surface: &Surface, q: [f64; 2], near: f64) -> bool {
    let (u, v) = surface.domain();
    [u, v].into_iter().enumerate().any(|(k, (a, b))| {
        let hair = APART * (b - a);
        let mut other = q;
        other[k] = if q[k] - a <= hair { b } else { a };
        let on_side = q[k] - a <= hair || b - q[k] <= hair;
        on_side && (surface.point(q[0], q[1]) - surface.point(other[0], other[1])).norm() <= near
    })
}

/// Whether two curves in a parameter plane, which belong to one edge, lie at different places.
fn apart(one: &PlaneTrace, other: &PlaneTrace, arc: &Arc) -> bool {
    let middle = 0.5 * (arc.from + arc.to);
    let (p, q) = (one.curve.point(middle), other.curve.point(middle));
    let length = (other.curve.point(arc.to) - other.curve.point(arc.from)).norm();
    (p - q).norm() > APART * length
}
