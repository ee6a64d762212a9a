//! Extrusions: closed or open profiles in a plane, moved along a line, with mitred ends and caps.

use super::bytes::{fault, Cursor, Reading};
use super::curves;
use super::records;
use crate::brep::raw::SurfaceKind;
use crate::brep::raw::{RawEdge, RawFace, RawLoop, RawRegion, SurfaceDeviation};
use crate::brep::recast;
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::SupportSurface;
use crate::geom::placement::Placement;
use crate::geom::{BBox, Frame, Vec3};
use nalgebra::Matrix3;

/// Ends of pieces of a profile that are nearer than this share of its size are one point: what ten digits lose.
const CLOSED: f64 = 1e-9;
/// A mitre's normal must rise at least this much from the plane of the profile.
const FLATTEST: f64 = 1e-3;

/// What the file says of an extrusion, lengths in mm.
struct Extrusion {
    /// Origin at the start of the path, z along it, y up.
    frame: Frame,
    /// From the start to the end of the path.
    path: Vec3,
    /// Heights along z by which x and y of the profile move at each end.
    slopes: [[f64; 2]; 2],
    /// The profiles, the outer one first, cut at their corners.
    profiles: Vec<Vec<Arc>>,
    caps: [bool; 2],
    transposed: bool,
}

/// The faces of an extrusion: walls, then caps; `scale` is the length of the file's unit in mm.
pub(super) fn faces(c: Cursor, scale: f64, tolerance: f64) -> Reading<Vec<RawFace>> {
    let e = read(c, scale)?;
    let mut out = Vec::new();
    let mut rims = [Vec::new(), Vec::new()];
    let mut count = 0;
    for profile in &e.profiles {
        let closed = is_closed(profile);
        let mut edges = [Vec::new(), Vec::new()];
        for (k, arc) in profile.iter().enumerate() {
            let number = |k: usize, which: u64| count + 3 * k as u64 + which;
            let bottom = e.edge(arc, 0, number(k, 1));
            let top = e.edge(arc, 1, number(k, 2));
            // The side at the end of the last piece of a closed profile is that at the start of the first.
            let next = if closed { (k + 1) % profile.len() } else { k + 1 };
            let sides = [side(&bottom, &top, 0, number(k, 3)), side(&bottom, &top, 1, number(next, 3))];
            out.push(e.wall(arc, [&bottom, &top], sides, tolerance));
            edges[0].push(bottom);
            edges[1].push(top);
        }
        count += 3 * profile.len() as u64 + 3;
        for (rim, edges) in rims.iter_mut().zip(edges) {
            rim.push(RawLoop { edges, outer: rim.is_empty() });
        }
    }
    let rims = rims.into_iter().zip(e.caps).enumerate();
    out.extend(rims.filter(|(_, (_, cap))| *cap).map(|(end, (loops, _))| e.cap(end, loops, tolerance)));
    Ok(out)
}

fn read(mut c: Cursor, scale: f64) -> Reading<Extrusion> {
    let mut c = c.anonymous()?;
    let (major, minor) = (c.i32()?, c.i32()?);
    if major != 1 {
        return fault(format!("an extrusion has the unknown version {major}.{minor}"));
    }
    let profile = curves::curve(records::object(&mut c)?, scale)?;
    let (from, to) = (curves::point(&mut c, scale)?, curves::point(&mut c, scale)?);
    let part = c.increasing()?;
    let up = c.vector()?;
    let mitred = [c.bool()?, c.bool()?];
    let normals = [c.vector()?, c.vector()?];
    c.interval()?;
    let transposed = c.bool()?;
    let count = if minor >= 1 { c.i32()? } else { 1 };
    let caps = if minor >= 2 { [c.bool()?, c.bool()?] } else { [true; 2] };
    let Some(z) = (to - from).try_normalize(0.0) else { return fault("an extrusion has a path without length") };
    let Some(x) = up.cross(&z).try_normalize(0.0) else { return fault("an extrusion has no direction up") };
    let frame = Frame { origin: from + (to - from) * part[0], x, y: z.cross(&x), z };
    let slopes = [0, 1].map(|k| slope(mitred[k].then_some(normals[k])));
    let profiles = loops(profile.smooth()?);
    if profiles.is_empty() || (count > 1 && usize::try_from(count) != Ok(profiles.len())) {
        return fault(format!("an extrusion of {count} profiles has {}", profiles.len()));
    }
    let caps = caps.map(|c| c && profiles.iter().all(|p| is_closed(p)));
    Ok(Extrusion { frame, path: (to - from) * (part[1] - part[0]), slopes, profiles, caps, transposed })
}

/// Height over x and over y of a mitre's plane.
fn slope(normal: Option<Vec3>) -> [f64; 2] {
    match normal.and_then(|n| n.try_normalize(0.0)) {
        Some(n) if n.z > FLATTEST => [-n.x / n.z, -n.y / n.z],
        _ => [0.0; 2],
    }
}

fn size(pieces: &[Arc]) -> f64 {
    let middle = |a: &Arc| a.curve.point(0.5 * (a.from + a.to));
    let points: Vec<Vec3> = pieces.iter().flat_map(|a| [a.ends().0, middle(a), a.ends().1]).collect();
    BBox::of(&points).diagonal()
}

fn is_closed(pieces: &[Arc]) -> bool {
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return false };
    (first.ends().0 - last.ends().1).norm() <= CLOSED * size(pieces)
}

/// The pieces of all profiles, each by itself: one ends where it is closed.
fn loops(pieces: Vec<Arc>) -> Vec<Vec<Arc>> {
    let mut out: Vec<Vec<Arc>> = Vec::new();
    let hair = CLOSED * size(&pieces);
    for arc in pieces {
        match out.last_mut() {
            Some(open) if (open[0].ends().0 - open[open.len() - 1].ends().1).norm() > hair => open.push(arc),
            _ => out.push(vec![arc]),
        }
    }
    out
}

/// The line from the bottom to the top at the start (0) or end (1) of two edges.
fn side(bottom: &RawEdge, top: &RawEdge, end: usize, entity: u64) -> RawEdge {
    let at = |e: &RawEdge| {
        let ends = e.path[0].ends();
        if end == 0 {
            ends.0
        } else {
            ends.1
        }
    };
    let (p, q) = (at(bottom), at(top));
    let curve = SpaceCurve::Line { origin: p, direction: q - p };
    let path = vec![Arc { curve, from: 0.0, to: 1.0 }];
    RawEdge { entity, forward: true, path, vertices: Some([p, q]), trace: None }
}

impl Extrusion {
    /// The piece of a profile at the start (0) or end (1) of the path.
    fn edge(&self, arc: &Arc, end: usize, entity: u64) -> RawEdge {
        let f = &self.frame;
        let [a, b] = self.slopes[end];
        let linear = Matrix3::from_columns(&[f.x + f.z * a, f.y + f.z * b, f.z]);
        let place = Placement { linear, shift: f.origin + self.path * end as f64 };
        let curve = match &arc.curve {
            SpaceCurve::Line { origin, direction } => {
                SpaceCurve::Line { origin: place.point(origin), direction: linear * direction }
            }
            SpaceCurve::Ellipse { frame, a: p, b: q } if a.abs() + b.abs() <= 0.0 => {
                let turned = |v: &Vec3| f.vector_to_world(v);
                let (x, y, z) = (turned(&frame.x), turned(&frame.y), turned(&frame.z));
                SpaceCurve::Ellipse { frame: Frame { origin: place.point(&frame.origin), x, y, z }, a: *p, b: *q }
            }
            // A circle becomes an ellipse: an exact spline over the same parameters.
            other => match other.to_spline(arc.from, arc.to) {
                Ok((c, _)) => SpaceCurve::Spline(curves::placed(c, &place)),
                Err(_) => other.clone(),
            },
        };
        let path = vec![Arc { curve, ..*arc }];
        let (p, q) = path[0].ends();
        RawEdge { entity, forward: true, path, vertices: Some([p, q]), trace: None }
    }

    fn wall(&self, arc: &Arc, [bottom, top]: [&RawEdge; 2], sides: [RawEdge; 2], uncertainty: f64) -> RawFace {
        let level = Self { slopes: [[0.0; 2]; 2], profiles: Vec::new(), ..*self };
        let straight = level.edge(arc, 0, 0).path.remove(0);
        let swept = SupportSurface::Extrusion { directrix: straight.curve, direction: self.path };
        let elementary = recast::elementary(&swept);
        let kind = match &elementary {
            Some((SupportSurface::Plane(_), _)) => SurfaceKind::Plane,
            Some((SupportSurface::Cylinder { .. }, _)) => SurfaceKind::Cylinder,
            _ => SurfaceKind::Extrusion,
        };
        // Outward with the material inside the outer profile; the file may count the path first where there are no caps.
        let outward = !self.transposed || self.caps.contains(&true);
        if self.slopes.iter().flatten().all(|s| s.abs() <= 0.0) {
            let region = RawRegion::Rectangle([(straight.from, straight.to), (0.0, 1.0)]);
            return raw(swept, kind, outward, region, uncertainty);
        }
        let (support, same) = elementary.unwrap_or((swept, true));
        let [start, end] = sides;
        let edges = vec![bottom.clone(), end, top.reversed(), start.reversed()];
        let l = RawLoop { edges, outer: true };
        let l = if outward { l } else { l.reversed() };
        raw(support, kind, same == outward, RawRegion::Loops(vec![l]), uncertainty)
    }

    fn cap(&self, end: usize, loops: Vec<RawLoop>, uncertainty: f64) -> RawFace {
        let f = &self.frame;
        let [a, b] = self.slopes[end];
        let z = (f.z - f.x * a - f.y * b).normalize();
        let x = (f.x + f.z * a).normalize();
        let plane = Frame { origin: f.origin + self.path * end as f64, x, y: z.cross(&x), z };
        let top = end == 1;
        let loops = loops.into_iter().map(|l| if top { l } else { l.reversed() }).collect();
        raw(SupportSurface::Plane(plane), SurfaceKind::Plane, top, RawRegion::Loops(loops), uncertainty)
    }
}

fn raw(support: SupportSurface, kind: SurfaceKind, same_sense: bool, region: RawRegion, uncertainty: f64) -> RawFace {
    let (name, part) = (String::new(), String::new());
    RawFace {
        entity: 0,
        name,
        part,
        kind,
        support,
        same_sense,
        region,
        surface_deviation: SurfaceDeviation::NONE,
        uncertainty,
    }
}
