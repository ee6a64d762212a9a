//! Solids that files describe by a face and a way: the faces that bound them.

use super::curves::Geometry;
use super::records::Fault;
use super::topology::turn;
use crate::brep::raw::SurfaceKind;
use crate::brep::raw::{RawEdge, RawFace, RawLoop, RawRegion};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::geom::placement::Placement;
use crate::geom::Vec3;

impl Geometry<'_, '_> {
    /// The faces of item `#id`: itself, or those that bound an extruded face.
    pub fn faces(&self, id: u64, flipped: bool) -> Result<Vec<RawFace>, Fault> {
        if self.records.get(id)?.name() == "EXTRUDED_FACE_SOLID" {
            return self.extruded(id, flipped);
        }
        self.face(id, flipped, 0).map(|f| vec![f])
    }

    /// Base, top and one side for every piece of an edge of an extruded face, normals outward.
    fn extruded(&self, id: u64, flipped: bool) -> Result<Vec<RawFace>, Fault> {
        let a = self.records.simple(id)?;
        let base = self.face(a.reference(1)?, false, 0)?;
        let way = self.direction(a.reference(2)?)? * (a.number(3)? * self.units.length);
        let SupportSurface::Plane(frame) = &base.support else {
            return Err(Fault::new(id, format!("the solid #{id} extrudes a curved face, which is not read")));
        };
        let up = frame.z.dot(&way) * if base.same_sense { 1.0 } else { -1.0 };
        let RawRegion::Loops(loops) = &base.region else {
            return Err(Fault::new(id, format!("the solid #{id} extrudes a face without boundary")));
        };
        if up == 0.0 || up.is_nan() {
            return Err(Fault::new(id, format!("the solid #{id} extrudes a face along itself")));
        }
        let mut out = Vec::new();
        for arc in loops.iter().flat_map(|l| &l.edges).flat_map(|e| &e.path) {
            let (lo, hi) = (arc.from.min(arc.to), arc.from.max(arc.to));
            let mut side = base.clone();
            side.support = SupportSurface::Extrusion { directrix: arc.curve.clone(), direction: way };
            side.kind = SurfaceKind::Extrusion;
            side.region = RawRegion::Rectangle([(lo, hi), (0.0, 1.0)]);
            // Material lies left of the loop seen against the face's normal, so that travel × way points outward.
            side.same_sense = (arc.to >= arc.from) == (up > 0.0);
            out.push(side);
        }
        let shift = |c: &SupportSurface| moved(c, &way).ok_or_else(|| Fault::new(id, format!("#{id} cannot be moved")));
        let mut top = base.clone();
        top.support = shift(&base.support)?;
        top.region =
            RawRegion::Loops(loops.iter().map(|l| moved_loop(l, &way)).collect::<Option<_>>().ok_or_else(|| {
                Fault::new(id, format!("the solid #{id} has an edge that is given in a parameter plane only"))
            })?);
        // The end of the solid that the base's normal points away from keeps it.
        let (mut near, mut far) = (base, top);
        if up > 0.0 {
            turn(&mut near);
        } else {
            turn(&mut far);
        }
        out.extend([near, far]);
        for f in &mut out {
            f.entity = id;
            if flipped {
                turn(f);
            }
        }
        Ok(out)
    }
}

fn moved(c: &SupportSurface, way: &Vec3) -> Option<SupportSurface> {
    match c {
        SupportSurface::Plane(f) => {
            let mut f = *f;
            f.origin += way;
            Some(SupportSurface::Plane(f))
        }
        SupportSurface::Spline(s) => {
            let mut surface = s.surface.clone();
            surface.place(&Placement { shift: *way, ..Placement::identity() });
            Some(SupportSurface::Spline(SplineSupport::new(surface)))
        }
        _ => None,
    }
}

fn moved_loop(l: &RawLoop, way: &Vec3) -> Option<RawLoop> {
    let arc = |a: &Arc| Some(Arc { curve: moved_curve(&a.curve, way)?, ..a.clone() });
    let edge =
        |e: &RawEdge| Some(RawEdge { path: e.path.iter().map(arc).collect::<Option<_>>()?, trace: None, ..e.clone() });
    Some(RawLoop { edges: l.edges.iter().map(edge).collect::<Option<_>>()?, outer: l.outer })
}

fn moved_curve(c: &SpaceCurve, way: &Vec3) -> Option<SpaceCurve> {
    let mut out = c.clone();
    match &mut out {
        SpaceCurve::Line { origin, .. } => *origin += way,
        SpaceCurve::Ellipse { frame, .. }
        | SpaceCurve::Parabola { frame, .. }
        | SpaceCurve::Hyperbola { frame, .. } => frame.origin += way,
        SpaceCurve::Spline(c) => {
            for h in &mut c.control {
                (0..3).for_each(|d| h[d] += h[3] * way[d]);
            }
        }
        SpaceCurve::Traced(_) => return None,
    }
    Some(out)
}
