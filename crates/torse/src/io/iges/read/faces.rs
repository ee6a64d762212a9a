//! Faces: trimmed and bounded surfaces, faces of solids, and surfaces that are faces by themselves.

use super::boundary::{Base, Boundary, Source, CONTRADICTED};
use super::curves::Geometry;
use super::patch::Patch;
use super::records::{Entry, Fault};
use super::surfaces::is_surface;
use crate::brep::area::spanned_area_estimate;
use crate::brep::face::Face;
use crate::brep::raw::{PlaneTrace, RawEdge, RawFace, RawLoop, RawRegion};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::{SplineSupport, SupportSurface};
use crate::brep::trim::{self, TrimError};
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;

/// A face that could not be built.
#[derive(Clone, Debug)]
pub(super) struct Lost {
    /// Why.
    pub fault: Fault,
    /// Its area in squares of the file's unit, as far as its edges tell.
    pub area: Option<f64>,
}

impl From<Fault> for Lost {
    fn from(fault: Fault) -> Self {
        Self { fault, area: None }
    }
}

/// How a face is wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// Whether its normal is turned round.
    pub flipped: bool,
    /// Largest distance of chords from the boundary, in the file's unit; the default if there is none.
    pub chords: Option<f64>,
}

/// Types of entities that are faces.
pub(super) fn is_face(kind: u32) -> bool {
    matches!(kind, 143 | 144 | 510) || is_surface(kind)
}

/// Loops of which every combination of senses is tried.
const FEW_LOOPS: usize = 5;

impl Geometry<'_> {
    /// The trimmed faces of an entity, in the numbers of the file, without the entity's own transformation.
    pub fn faces(&self, id: u64, asked: Asked) -> Result<Vec<Face>, Lost> {
        let e = self.get(id)?;
        match e.kind {
            143 => {
                let ids = e.pointers(4, e.count(3)?)?;
                let base = self.base(e.pointer(2)?)?;
                self.bounded(e, base, &ids, true, asked)
            }
            144 => {
                let inner = e.pointers(5, e.count(3)?)?;
                let outer = e.optional(4)?;
                let given = e.integer(2)? != 0 && outer != 0;
                let ids: Vec<u64> = given.then_some(outer).into_iter().chain(inner).collect();
                let base = self.base(e.pointer(1)?)?;
                self.bounded(e, base, &ids, given, asked)
            }
            510 => self.face_of_solid(e, asked),
            108 if e.form != 0 => {
                let still = Placement::identity();
                let base = Base { patch: self.surface(id, 0)?, own: still, back: still, periods: [None; 2] };
                self.bounded(e, base, &[e.pointer(5)?], true, asked)
            }
            _ => {
                let patch = self.surface(id, 0)?;
                let region = patch.rectangle.map_or(RawRegion::Whole, RawRegion::Rectangle);
                let raw = self.raw(e, patch, region, asked);
                Ok(trim::faces(&raw, asked.chords).map_err(|why| Fault::new(id, why.to_string()))?)
            }
        }
    }

    /// The face as the trimming takes it.
    pub fn raw(&self, e: &Entry, patch: Patch, region: RawRegion, asked: Asked) -> RawFace {
        let mut raw = RawFace {
            entity: e.number,
            name: self.name(e),
            part: String::new(),
            kind: patch.kind,
            support: patch.support,
            same_sense: patch.same_sense,
            region,
            surface_deviation: patch.deviation,
            uncertainty: self.records.global.resolution / self.records.global.millimetres,
        };
        if asked.flipped {
            raw.same_sense = !raw.same_sense;
            if let RawRegion::Loops(loops) = &mut raw.region {
                loops.iter_mut().for_each(|l| *l = l.reversed());
            }
        }
        raw
    }

    /// A surface inside boundaries. The first is the outer one if `given`, else the surface's own sides are.
    fn bounded(&self, e: &Entry, base: Base, ids: &[u64], given: bool, asked: Asked) -> Result<Vec<Face>, Lost> {
        let own = base.own;
        let placed = |faces: Vec<Face>| faces.iter().map(|f| f.placed(&own, "")).collect();
        if ids.is_empty() {
            let region = base.patch.rectangle.map_or(RawRegion::Whole, RawRegion::Rectangle);
            let raw = self.raw(e, base.patch, region, asked);
            return Ok(trim::faces(&raw, asked.chords)
                .map(placed)
                .map_err(|why| Fault::new(e.number, why.to_string()))?);
        }
        let boundaries = ids.iter().map(|b| self.boundary(*b)).collect::<Result<Vec<_>, _>>()?;
        let mut first: Option<Lost> = None;
        // Faces whose boundary is far from all curves that were tried; others may do better.
        let mut poor: Option<(f64, Vec<Face>)> = None;
        for source in self.sources(&boundaries) {
            match self.attempt(e, &base, (&boundaries, given), *source, asked) {
                Ok(faces) => {
                    let off = missed_share_estimate(&faces);
                    if off <= CONTRADICTED {
                        return Ok(placed(faces));
                    }
                    if poor.as_ref().is_none_or(|p| off < p.0) {
                        poor = Some((off, faces));
                    }
                }
                // What is wrong with the curves in space says most.
                Err(lost) if first.is_none() || *source == Source::Space => first = Some(lost),
                Err(_) => {}
            }
        }
        match poor {
            Some((_, faces)) => Ok(placed(faces)),
            None => Err(first.unwrap_or_else(|| Fault::new(e.number, "it has no boundary").into())),
        }
    }

    /// One way to bound a surface.
    fn attempt(
        &self,
        e: &Entry,
        base: &Base,
        (boundaries, given): (&[Boundary], bool),
        source: Source,
        asked: Asked,
    ) -> Result<Vec<Face>, Lost> {
        let mut patch = base.patch.clone();
        let mut loops = Vec::with_capacity(boundaries.len() + 1);
        let changed;
        let mut base = base;
        if given && source == Source::Space && !boundaries.is_empty() {
            patch = patch.simplified();
            changed = Base { patch: patch.clone(), ..*base };
            base = &changed;
        } else if !given {
            patch = bounded_spline(patch).map_err(|why| Fault::new(e.number, why))?;
            loops.push(sides(e.number, &patch));
            changed = Base { patch: patch.clone(), ..*base };
            base = &changed;
        }
        for (i, b) in boundaries.iter().enumerate() {
            loops.push(self.boundary_loop(b, base, source, given && i == 0)?);
        }
        self.trimmed(e, patch, loops, asked)
    }

    /// A surface inside loops, whose senses are turned where they bound nothing.
    pub fn trimmed(&self, e: &Entry, patch: Patch, loops: Vec<RawLoop>, asked: Asked) -> Result<Vec<Face>, Lost> {
        let area = spanned_area_estimate(&loops);
        let count = loops.len();
        let raw = self.raw(e, patch.beside(&loops), RawRegion::Loops(loops), asked);
        let first = match trim::faces(&raw, asked.chords) {
            Ok(faces) => return Ok(faces),
            Err(why) => why,
        };
        let winding = matches!(first, TrimError::OpenWinding | TrimError::NoArea | TrimError::SelfTouching(_));
        if winding && count > 1 && count <= FEW_LOOPS {
            // All of them turned round is tried by the trimming itself.
            for mask in 1..1_usize << (count - 1) {
                let mut other = raw.clone();
                if let RawRegion::Loops(loops) = &mut other.region {
                    let turned = loops.iter_mut().enumerate().filter(|(i, _)| mask >> i & 1 == 1);
                    turned.for_each(|(_, l)| *l = l.reversed());
                }
                if let Ok(faces) = trim::faces(&other, asked.chords) {
                    return Ok(faces);
                }
            }
        }
        Err(Lost { fault: Fault::new(e.number, first.to_string()), area })
    }

    /// Name of an entity: its name property, else its label.
    pub fn name(&self, e: &Entry) -> String {
        self.property(e).unwrap_or_else(|| e.label.clone())
    }

    /// The name property (406 of form 15) among the pointers after an entity's own data.
    fn property(&self, e: &Entry) -> Option<String> {
        let n = |k: usize| e.count(k).ok();
        let own = match e.kind {
            118 | 120 | 122 => 5,
            140 => 6,
            128 => {
                let [k1, k2, m1, m2] = [n(1)?, n(2)?, n(3)?, n(4)?];
                18 + k1 + m1 + k2 + m2 + (k1 + 1).checked_mul(k2 + 1)?.checked_mul(4)?
            }
            143 | 510 => 4 + n(if e.kind == 143 { 3 } else { 2 })?,
            144 => 5 + n(3)?,
            186 => 4 + 2 * n(3)?,
            514 => 2 + 2 * n(1)?,
            308 => 4 + n(3)?,
            408 => 6,
            402 => 2 + n(1)?,
            _ => return None,
        };
        let properties = own + 1 + n(own)?;
        let pointers = e.pointers(properties + 1, n(properties)?).ok()?;
        pointers.into_iter().find_map(|p| {
            let p = self.get(p).ok().filter(|p| p.kind == 406 && p.form == 15)?;
            Some(p.text(2).to_string()).filter(|t| !t.is_empty())
        })
    }
}

/// By how much boundaries miss the curves of the file, against the extent of their surfaces; as seen at samples.
fn missed_share_estimate(faces: &[Face]) -> f64 {
    faces.iter().map(|f| f.trim_deviation_estimate / f.surface.bbox().diagonal()).fold(0.0, f64::max)
}

/// A patch as a spline with sides.
fn bounded_spline(patch: Patch) -> Result<Patch, String> {
    if let (SupportSurface::Spline(_), None) = (&patch.support, patch.rectangle) {
        return Ok(patch);
    }
    let Some([u, v]) = patch.rectangle else {
        return Err(TrimError::Unbounded.to_string());
    };
    let (surface, _) = patch.support.to_spline(u, v).map_err(|why| why.to_string())?;
    let surface = surface.restricted(u, v).unwrap_or(surface);
    let support = SupportSurface::Spline(SplineSupport::new(surface));
    Ok(Patch { support, rectangle: None, chart: None, ..patch })
}

/// The four sides of a spline surface as a loop; those that are points are left out.
fn sides(entity: u64, patch: &Patch) -> RawLoop {
    let SupportSurface::Spline(s) = &patch.support else { return RawLoop::default() };
    let s: &Surface = &s.surface;
    let ((u0, u1), (v0, v1)) = s.domain();
    let all: [(Curve<4>, [f64; 2], [f64; 2], bool); 4] = [
        (s.curve_at_v(v0), [u0, v0], [u1, v0], true),
        (s.curve_at_u(u1), [u1, v0], [u1, v1], true),
        (s.curve_at_v(v1), [u0, v1], [u1, v1], false),
        (s.curve_at_u(u0), [u0, v0], [u0, v1], false),
    ];
    let point = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
    let mut edges = Vec::with_capacity(4);
    for (curve, p, q, along) in all {
        let first = point(&curve.control[0]);
        if curve.control.iter().all(|h| (point(h) - first).norm() <= f64::EPSILON * s.bbox().diagonal()) {
            continue;
        }
        let (a, b) = curve.domain();
        let flat = |x: [f64; 2]| [x[0], x[1], 0.0, 1.0];
        let trace = Curve::new(1, vec![a, a, b, b], vec![flat(p), flat(q)]).ok();
        let trace = trace.map(|c| PlaneTrace { curve: SpaceCurve::Spline(c), scale: [1.0; 2] });
        let (from, to) = if along { (a, b) } else { (b, a) };
        let path = vec![Arc { curve: SpaceCurve::Spline(curve), from, to }];
        edges.push(RawEdge { entity, forward: true, path, vertices: None, trace });
    }
    let l = RawLoop { edges, outer: true };
    // The loop runs about the normal of the file, which may be the other one.
    if patch.same_sense {
        l
    } else {
        l.reversed()
    }
}
