//! Faces of solids and shells (510) with their loops (508), edges (504) and vertices (502).

use super::boundary::{trace_of, Base};
use super::curves::{vec3, Geometry, Path};
use super::faces::{Asked, Lost};
use super::placing;
use super::records::{Entry, Fault};
use crate::brep::face::Face;
use crate::brep::raw::{RawEdge, RawLoop, RawRegion};
use crate::brep::space_curve::Arc;
use crate::brep::trim::{self, edge};
use crate::geom::placement::Placement;
use crate::geom::Vec3;

/// Ends of an edge's curve farther from its vertices than this share of its extent: the curve is to be cut.
const CUT: f64 = 1e-3;

/// An edge of a loop as its data list it.
struct EdgeUse {
    list: u64,
    index: usize,
    forward: bool,
    /// Curves in the parameter plane.
    plane: Vec<u64>,
}

impl Geometry<'_> {
    /// The face of a solid or shell, in the coordinates of the solid.
    pub fn face_of_solid(&self, e: &Entry, asked: Asked) -> Result<Vec<Face>, Lost> {
        let base = self.base(e.pointer(1)?)?;
        let own = base.own;
        let placed = |faces: Vec<Face>| faces.iter().map(|f| f.placed(&own, "")).collect();
        let ids = e.pointers(4, e.count(2)?)?;
        if ids.is_empty() {
            let region = base.patch.rectangle.map_or(RawRegion::Whole, RawRegion::Rectangle);
            let raw = self.raw(e, base.patch, region, asked);
            return Ok(trim::faces(&raw, asked.chords)
                .map(placed)
                .map_err(|why| Fault::new(e.number, why.to_string()))?);
        }
        let patch = base.patch.clone().simplified();
        let base = Base { patch, ..base };
        let mut loops = Vec::with_capacity(ids.len());
        // What is called outer is not so on a surface without border: the sense of loops says which side is meant.
        for id in &ids {
            loops.push(self.solid_loop(*id, &base)?);
        }
        self.trimmed(e, base.patch, loops, asked).map(placed)
    }

    /// A loop, run as the file says: material on the left seen against the normal of the surface.
    fn solid_loop(&self, id: u64, base: &Base) -> Result<RawLoop, Fault> {
        let e = self.get(id)?;
        if e.kind != 508 {
            return Err(Fault::new(id, format!("D{id} is of type {}, not a loop", e.kind)));
        }
        let mut edges = Vec::new();
        let mut at = 2;
        for _ in 0..e.count(1)? {
            let (kind, list, index) = (e.integer(at)?, e.pointer(at + 1)?, e.count_any(at + 2)?);
            let (forward, count) = (e.integer(at + 3)? == 1, e.count(at + 4)?);
            let plane = (0..count).map(|k| e.pointer(at + 6 + 2 * k)).collect::<Result<Vec<_>, _>>()?;
            at += 5 + 2 * count;
            // A vertex bounds nothing: the surface ends there by itself.
            if kind == 0 {
                edges.push(self.solid_edge(&EdgeUse { list, index, forward, plane }, base)?);
            }
        }
        Ok(RawLoop { edges, outer: false })
    }

    fn solid_edge(&self, u: &EdgeUse, base: &Base) -> Result<RawEdge, Fault> {
        let e = self.get(u.list)?;
        let wrong = || Fault::new(u.list, format!("D{} has no edge {}", u.list, u.index));
        if e.kind != 504 || u.index == 0 || u.index > e.count(1)? {
            return Err(wrong());
        }
        let at = 2 + 5 * (u.index - 1);
        let own = placing::of_entry(self.records, e)?;
        let place = base.back.after(&own);
        let curve = e.pointer(at)?;
        let (start, end) = ((e.pointer(at + 1)?, e.count_any(at + 2)?), (e.pointer(at + 3)?, e.count_any(at + 4)?));
        let [p, q] = [self.vertex(start)?, self.vertex(end)?].map(|v| place.point(&v));
        let path = placing::path(self.path(curve, 0)?, &place)?;
        let path = between(path, [p, q], start == end);
        let trace = match (&u.plane[..], &path[..], base.patch.chart) {
            ([flat], [arc], Some(chart)) => {
                self.flat(*flat, chart).and_then(|f| trace_of(&f, arc, &base.patch.support))
            }
            _ => None,
        };
        let edge = RawEdge { entity: curve, forward: true, path, vertices: Some([p, q]), trace };
        Ok(if u.forward { edge } else { edge.reversed() })
    }

    /// A vertex of a list, with the transformation of the list.
    fn vertex(&self, (list, index): (u64, usize)) -> Result<Vec3, Fault> {
        let e = self.get(list)?;
        if e.kind != 502 || index == 0 || index > e.count(1)? {
            return Err(Fault::new(list, format!("D{list} has no vertex {index}")));
        }
        let place: Placement = placing::of_entry(self.records, e)?;
        Ok(place.point(&vec3(e, 2 + 3 * (index - 1))?))
    }
}

/// The pieces of an edge's curve from one vertex to the other.
fn between(path: Path, [p, q]: [Vec3; 2], closed: bool) -> Vec<Arc> {
    let arcs: Vec<Arc> = path.into_iter().map(|(_, a)| a).collect();
    let [one] = &arcs[..] else {
        return if closed { arcs } else { edge::oriented(arcs, &p, &q) };
    };
    let (a, b) = one.ends();
    let size = (b - a).norm().max((one.curve.point(0.5 * (one.from + one.to)) - a).norm());
    let far = |x: Vec3, y: Vec3| (x - y).norm() > CUT * size;
    if far(a, p) && !far(a, q) && !far(b, p) {
        return vec![one.reversed()];
    }
    if far(a, p) || far(b, q) {
        return vec![edge::between(&one.curve, &p, &q, closed, one.from <= one.to)];
    }
    arcs
}
