//! Edges and free curves of a STEP file, in millimetres, for jobs that start from curves.

use super::beside::{pieces, whole};
use super::curves::Geometry;
use super::records::{Fault, Records};
use super::topology::ParameterPlane;
use super::{decoded, foreign, product, units, ReadError};
use crate::brep::space_curve::Arc;
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use std::collections::HashMap;

/// A curve of a file.
#[derive(Clone, Debug)]
pub struct EdgeCurve {
    /// Entity number.
    pub entity: u64,
    /// Which of its places in an assembly, counted from 1.
    pub copy: usize,
    /// Its pieces in order, homogeneous, mm.
    pub curves: Vec<Curve<4>>,
}

/// All edges of a STEP file where its assemblies put them, once for each place, or, where it has no edges, its curves.
/// Edges of no placed face, and free curves, are read as they stand.
///
/// # Errors
/// Not a STEP file, no records; no curve that can be read.
pub fn curves(bytes: &[u8]) -> Result<Vec<EdgeCurve>, ReadError> {
    let text = decoded(bytes);
    let Some(records) = Records::parse(&text) else { return Err(foreign(&text)) };
    let unit = records
        .all(&["GLOBAL_UNIT_ASSIGNED_CONTEXT"])
        .first()
        .map(|&id| units::of_context(&records, id))
        .unwrap_or_default();
    let geometry = Geometry { records: &records, units: &unit };
    let plane = ParameterPlane { surface: 0, scale: [1.0, 1.0] };
    let mut out = Vec::new();
    let mut fault: Option<Fault> = None;
    let mut keep = |entity: u64, copy: usize, place: &Placement, path: Result<Vec<Arc>, Fault>| match path
        .and_then(|p| pieces(entity, &p))
    {
        Ok(curves) if !curves.is_empty() => {
            out.push(EdgeCurve { entity, copy, curves: curves.iter().map(|c| placed(c, place)).collect() });
        }
        Ok(_) => {}
        Err(f) => {
            fault.get_or_insert(f);
        }
    };
    let edges = records.all(&["EDGE_CURVE"]);
    let places = places(&records);
    for id in &edges {
        match places.edges.get(id) {
            Some(there) => {
                for (k, (place, units)) in there.iter().enumerate() {
                    let geometry = Geometry { records: &records, units: &places.units[*units] };
                    keep(*id, k + 1, place, geometry.edge_curve(*id, &plane).map(|e| e.path));
                }
            }
            None => keep(*id, 1, &Placement::identity(), geometry.edge_curve(*id, &plane).map(|e| e.path)),
        }
    }
    if edges.is_empty() {
        // Curves that others are made of stand below these in the file; a set names those that are meant.
        let meant: Vec<u64> = records
            .all(&["GEOMETRIC_CURVE_SET", "GEOMETRIC_SET"])
            .into_iter()
            .filter_map(|id| records.simple(id).ok()?.references(1).ok())
            .flatten()
            .collect();
        let free = ["B_SPLINE_CURVE_WITH_KNOTS", "POLYLINE", "TRIMMED_CURVE", "COMPOSITE_CURVE", "CIRCLE", "ELLIPSE"];
        let ids = if meant.is_empty() { records.all(&free) } else { meant };
        for id in ids {
            keep(id, 1, &Placement::identity(), geometry.resolved_curve(id, 0).and_then(|c| whole(id, c)));
        }
    }
    match (out.is_empty(), fault) {
        (true, Some(f)) => Err(ReadError::NoUsableFaces { count: edges.len(), entity: f.entity, reason: f.reason }),
        (true, None) => Err(ReadError::NoFaces { records: records.len(), reason: "it holds no curves either".into() }),
        _ => Ok(out),
    }
}

/// Where edges lie in the whole model.
struct Places {
    /// Different placements of each edge, with the index of its units.
    edges: HashMap<u64, Vec<(Placement, usize)>>,
    units: Vec<units::Units>,
}

/// Follows the uses of faces to their edges.
fn places(records: &Records) -> Places {
    let census = product::census(records);
    let mut edges: HashMap<u64, Vec<(Placement, usize)>> = HashMap::new();
    let mut of_face: HashMap<u64, Vec<u64>> = HashMap::new();
    for o in &census.occurrences {
        let own = of_face.entry(o.face).or_insert_with(|| {
            let mut found = Vec::new();
            edges_of(records, o.face, 0, &mut found);
            found
        });
        for e in own.iter() {
            let there = edges.entry(*e).or_default();
            if !there.iter().any(|(p, _)| *p == o.placement) {
                there.push((o.placement, o.units));
            }
        }
    }
    Places { edges, units: census.units }
}

/// Levels between a face and its edges at most; a deeper nesting is a circle.
const DEEPEST: u32 = 12;

/// Edges that bound a face.
fn edges_of(records: &Records, id: u64, depth: u32, out: &mut Vec<u64>) {
    let (Ok(record), Ok(a)) = (records.get(id), records.simple(id)) else { return };
    let below: Vec<u64> = match record.name() {
        "EDGE_CURVE" => {
            if !out.contains(&id) {
                out.push(id);
            }
            return;
        }
        "ADVANCED_FACE" | "FACE_SURFACE" | "FACE" | "SUBFACE" | "EDGE_LOOP" => a.references(1).unwrap_or_default(),
        "FACE_BOUND" | "FACE_OUTER_BOUND" => a.reference(1).into_iter().collect(),
        "ORIENTED_FACE" => a.reference(2).into_iter().collect(),
        "ORIENTED_EDGE" => a.reference(3).into_iter().collect(),
        _ => return,
    };
    if depth < DEEPEST {
        for b in below {
            edges_of(records, b, depth + 1, out);
        }
    }
}

/// The curve moved.
fn placed(c: &Curve<4>, place: &Placement) -> Curve<4> {
    if *place == Placement::identity() {
        return c.clone();
    }
    let moved = |h: &[f64; 4]| {
        let p = place.linear * Vec3::new(h[0], h[1], h[2]) + place.shift * h[3];
        [p.x, p.y, p.z, h[3]]
    };
    Curve { knots: c.knots.clone(), control: c.control.iter().map(moved).collect() }
}
