//! Faces, loops and edges of ISO 10303-42, and surfaces that are bounded without topology.

use super::curves::{Geometry, ResolvedCurve, DEEPEST};
use super::records::{as_reference, Args, Fault};
use super::surfaces::Patch;
use super::token::Value;
use crate::brep::area::spanned_area_estimate;
use crate::brep::raw::{PlaneTrace, RawEdge, RawFace, RawLoop, RawRegion};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::trim::edge;
use crate::geom::Vec3;

/// The parameter plane of the face being read.
pub(super) struct ParameterPlane {
    /// Entity number of the surface.
    pub(super) surface: u64,
    /// Factors from its stated parameters to natural ones.
    pub(super) scale: [f64; 2],
}

impl<'r, 'a> Geometry<'r, 'a> {
    /// The face `#id`: a face of topology or a bounded surface. `flipped` turns its normal round.
    pub fn face(&self, id: u64, flipped: bool, depth: u32) -> Result<RawFace, Fault> {
        if depth > DEEPEST {
            return Err(super::curves::too_deep(id));
        }
        let r = self.records.get(id)?;
        let a = self.records.simple(id)?;
        match r.name() {
            "ADVANCED_FACE" | "FACE_SURFACE" => {
                let surface = a.reference(2)?;
                let patch = self.surface_near(surface, &self.places(surface, &a), 0)?;
                let plane = ParameterPlane { surface, scale: patch.parameter_units(self.units) };
                let mut loops = Vec::new();
                for b in a.references(1)? {
                    loops.push(self.bound(b, &plane)?);
                }
                // On a face of opposite sense the file's loops run about the face's normal, as ours do.
                let same = a.logical(3, true) == patch.same_sense;
                let region = match patch.rectangle {
                    Some(rectangle) if loops.is_empty() => RawRegion::Rectangle(rectangle),
                    _ if loops.is_empty() => RawRegion::Whole,
                    _ => RawRegion::Loops(loops),
                };
                let mut face = self.raw(id, a.text(0), patch, region);
                face.same_sense = same;
                if flipped {
                    turn(&mut face);
                }
                Ok(face)
            }
            "ORIENTED_FACE" => {
                let flip = !a.logical(3, true);
                self.face(a.reference(2)?, flipped != flip, depth + 1)
            }
            "FACE" | "SUBFACE" => Err(Fault::new(id, format!("face #{id} has no surface"))),
            "CURVE_BOUNDED_SURFACE" => {
                let patch = self.surface(a.reference(1)?, 0)?;
                let loops = self.boundary_curves(id, &a, &patch)?;
                let region = match patch.rectangle {
                    _ if !loops.is_empty() => RawRegion::Loops(loops),
                    Some(r) => RawRegion::Rectangle(r),
                    None => RawRegion::Whole,
                };
                Ok(self.raw(id, a.text(0), patch, region))
            }
            _ => {
                let patch = self.surface(id, 0)?;
                let region = patch.rectangle.map_or(RawRegion::Whole, RawRegion::Rectangle);
                let mut face = self.raw(id, a.text(0), patch, region);
                if flipped {
                    turn(&mut face);
                }
                Ok(face)
            }
        }
    }

    /// The area (mm²) that the edges of the face `#id` span, whatever its surface is; `None` where they tell nothing.
    pub fn spanned_area(&self, id: u64, depth: u32) -> Option<f64> {
        if depth > DEEPEST {
            return None;
        }
        let a = self.records.simple(id).ok()?;
        match self.records.name(id) {
            "ADVANCED_FACE" | "FACE_SURFACE" => spanned_area_estimate(&self.loops_alone(&a).ok()?),
            "ORIENTED_FACE" => self.spanned_area(a.reference(2).ok()?, depth + 1),
            _ => match self.face(id, false, 0).ok()?.region {
                RawRegion::Loops(loops) => spanned_area_estimate(&loops),
                _ => None,
            },
        }
    }

    /// The loops of a face without what its surface says of them.
    fn loops_alone(&self, a: &Args) -> Result<Vec<RawLoop>, Fault> {
        let plane = ParameterPlane { surface: 0, scale: [1.0; 2] };
        a.references(1)?.into_iter().map(|b| self.bound(b, &plane)).collect()
    }

    /// Places (mm) along the edges of a face on an offset, which may have no end of its own; none on other surfaces.
    fn places(&self, surface: u64, a: &Args) -> Vec<Vec3> {
        if self.records.name(surface) != "OFFSET_SURFACE" {
            return Vec::new();
        }
        let arcs = |l: RawLoop| l.edges.into_iter().flat_map(|e| e.path);
        let along = |p: Arc| p.curve.stations(p.from, p.to).into_iter().map(|t| p.curve.point(t)).collect::<Vec<_>>();
        self.loops_alone(a)
            .map_or_else(|_| Vec::new(), |loops| loops.into_iter().flat_map(arcs).flat_map(along).collect())
    }

    fn raw(&self, id: u64, name: &str, patch: Patch, region: RawRegion) -> RawFace {
        RawFace {
            entity: id,
            name: name.to_string(),
            part: String::new(),
            kind: patch.kind,
            support: patch.support,
            same_sense: patch.same_sense,
            region,
            surface_deviation: patch.deviation,
            uncertainty: self.units.uncertainty,
        }
    }

    /// The boundaries of a surface without topology, one edge for each piece of a curve.
    fn boundary_curves(&self, id: u64, a: &Args, patch: &Patch) -> Result<Vec<RawLoop>, Fault> {
        let boundaries = a.references(2)?;
        let ends = patch.rectangle.is_some() || patch.support.limits().iter().any(Option::is_some);
        let outer = boundaries.iter().any(|b| self.records.name(*b) == "OUTER_BOUNDARY_CURVE");
        if a.logical(3, false) && ends && !outer && !boundaries.is_empty() {
            return Err(Fault::new(
                id,
                format!("#{id} ends at the sides of its surface and has holes, which is not read"),
            ));
        }
        boundaries.into_iter().map(|b| self.boundary_curve(b)).collect()
    }

    fn boundary_curve(&self, id: u64) -> Result<RawLoop, Fault> {
        let part =
            |(entity, arc): (u64, Arc)| RawEdge { entity, forward: true, path: vec![arc], vertices: None, trace: None };
        let composite =
            self.records.get(id)?.parts.iter().any(|p| p.name.contains("BOUNDARY") || p.name.contains("COMPOSITE"));
        let pieces = if composite {
            self.segments(id, 0)?
        } else {
            match self.resolved_curve(id, 0)? {
                ResolvedCurve::Path(path) => path.into_iter().map(|arc| (id, arc)).collect(),
                ResolvedCurve::Basis(curve, _) => {
                    let domain = curve.domain();
                    let (from, to) = domain.ok_or_else(|| Fault::new(id, format!("the boundary #{id} is endless")))?;
                    vec![(id, Arc { curve, from, to })]
                }
            }
        };
        // The sense of such boundaries is not reliable: the region is what they enclose.
        Ok(RawLoop { edges: pieces.into_iter().map(part).collect(), outer: true })
    }

    /// A bound of a face, run in the sense that the bound asks for.
    fn bound(&self, id: u64, plane: &ParameterPlane) -> Result<RawLoop, Fault> {
        let a = self.records.simple(id)?;
        let name = self.records.name(id);
        if name != "FACE_BOUND" && name != "FACE_OUTER_BOUND" {
            return Err(Fault::new(id, format!("#{id} is a {name}, not a bound of a face")));
        }
        // What is called outer is not so on a surface without border: the sense says which side is meant.
        let l = self.edge_loop(a.reference(1)?, plane)?;
        Ok(if a.logical(2, true) { l } else { l.reversed() })
    }

    fn edge_loop(&self, id: u64, plane: &ParameterPlane) -> Result<RawLoop, Fault> {
        let a = self.records.simple(id)?;
        match self.records.get(id)?.name() {
            "EDGE_LOOP" => {
                let mut edges = Vec::new();
                for e in a.references(1)? {
                    edges.push(self.oriented_edge(e, plane, 0)?);
                }
                if edges.is_empty() {
                    return Err(Fault::new(id, format!("the edge loop #{id} has no edges")));
                }
                Ok(RawLoop { edges, outer: false })
            }
            // A vertex bounds nothing: the surface ends there by itself.
            "VERTEX_LOOP" => Ok(RawLoop::default()),
            "POLY_LOOP" => {
                let points = a.references(1)?.into_iter().map(|p| self.point(p)).collect::<Result<Vec<_>, _>>()?;
                let n = points.len();
                let edges = (0..n)
                    .map(|i| (points[i], points[(i + 1) % n]))
                    .filter(|(p, q)| (q - p).norm() > 0.0)
                    .map(|(p, q)| RawEdge {
                        // Sides have no numbers of their own.
                        entity: id,
                        forward: true,
                        path: vec![Arc { curve: SpaceCurve::Line { origin: p, direction: q - p }, from: 0.0, to: 1.0 }],
                        vertices: None,
                        trace: None,
                    })
                    .collect::<Vec<_>>();
                if edges.is_empty() {
                    return Err(Fault::new(id, format!("the polygon #{id} has no sides")));
                }
                Ok(RawLoop { edges, outer: false })
            }
            other => Err(Fault::new(id, format!("a loop of kind {other} is not read"))),
        }
    }

    fn oriented_edge(&self, id: u64, plane: &ParameterPlane, depth: u32) -> Result<RawEdge, Fault> {
        if depth > DEEPEST {
            return Err(super::curves::too_deep(id));
        }
        match self.records.get(id)?.name() {
            "ORIENTED_EDGE" => {
                let a = self.records.simple(id)?;
                let e = self.oriented_edge(a.reference(3)?, plane, depth + 1)?;
                Ok(if a.logical(4, true) { e } else { e.reversed() })
            }
            "EDGE_CURVE" => self.edge_curve(id, plane),
            other => Err(Fault::new(id, format!("an edge of kind {other} is not read"))),
        }
    }

    pub(super) fn edge_curve(&self, id: u64, plane: &ParameterPlane) -> Result<RawEdge, Fault> {
        let a = self.records.args(id, "EDGE_CURVE")?;
        let (start, end) = (a.reference(1)?, a.reference(2)?);
        let (p, q) = (self.vertex(start)?, self.vertex(end)?);
        let same = a.logical(4, true);
        let path = match self.resolved_curve(a.reference(3)?, 0)? {
            ResolvedCurve::Basis(c, along) => vec![edge::between(&c, &p, &q, start == end, same == along)],
            // A trimmed curve is its basis, cut anew by the vertices.
            ResolvedCurve::Path(path) if path.len() == 1 => {
                let arc = &path[0];
                vec![edge::between(&arc.curve, &p, &q, start == end, same == (arc.to >= arc.from))]
            }
            ResolvedCurve::Path(path) => {
                let path = if same { path } else { path.iter().rev().map(Arc::reversed).collect() };
                if start == end {
                    path
                } else {
                    edge::oriented(path, &p, &q)
                }
            }
        };
        let trace = self.trace(a.reference(3)?, plane).filter(|_| path.len() == 1);
        Ok(RawEdge { entity: id, forward: true, path, vertices: Some([p, q]), trace })
    }

    /// The curve in the parameter plane that goes with an edge's geometry on the face's own surface. A seam has two;
    /// which is meant the file does not say, so neither is taken.
    fn trace(&self, geometry: u64, plane: &ParameterPlane) -> Option<PlaneTrace> {
        if !matches!(self.records.name(geometry), "SURFACE_CURVE" | "INTERSECTION_CURVE") {
            return None;
        }
        let values = self.records.simple(geometry).ok()?.values;
        let associated = values.iter().find_map(|v| match v {
            Value::List(l) => Some(l.iter().filter_map(as_reference).collect::<Vec<u64>>()),
            _ => None,
        })?;
        let mut found = None;
        for p in associated {
            let Ok(a) = self.records.args(p, "PCURVE") else { continue };
            if a.reference(1) == Ok(plane.surface) && found.replace(p).is_some() {
                return None;
            }
        }
        let definition = self.records.args(found?, "PCURVE").ok()?.reference(2).ok()?;
        let item = *self.records.simple(definition).ok()?.references(1).ok()?.first()?;
        Some(PlaneTrace { curve: self.plane_curve(item).ok()?, scale: plane.scale })
    }

    fn vertex(&self, id: u64) -> Result<Vec3, Fault> {
        let a = self.records.args(id, "VERTEX_POINT")?;
        let p = a.reference(1)?;
        match self.records.name(p) {
            "CARTESIAN_POINT" => self.point(p),
            "POINT_ON_CURVE" => {
                let b = self.records.simple(p)?;
                match self.resolved_curve(b.reference(1)?, 0)? {
                    ResolvedCurve::Basis(c, _) => Ok(c.point(b.number(2)?)),
                    ResolvedCurve::Path(_) => Err(Fault::new(p, format!("point #{p} on a bounded curve is not read"))),
                }
            }
            other => Err(Fault::new(p, format!("a point of kind {other} is not read"))),
        }
    }
}

/// Turns a face's normal round; its loops follow.
pub(super) fn turn(face: &mut RawFace) {
    face.same_sense = !face.same_sense;
    if let RawRegion::Loops(loops) = &mut face.region {
        for l in loops {
            *l = l.reversed();
        }
    }
}

/// Whether a record of this kind is a surface that may be a face without topology. Endless ones are refused by name
/// when their region is asked for; a lone plane is construction geometry.
pub(super) fn may_be_face(name: &str) -> bool {
    name.ends_with("_SURFACE")
        || name.starts_with("SURFACE_OF_")
        || name.contains("B_SPLINE_SURFACE")
        || name == "SURFACE_REPLICA"
}
