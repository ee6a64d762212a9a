//! Edges and free curves of a STEP file, in millimetres, for jobs that start from curves.

use super::curves::{Course, Geometry};
use super::records::{Fault, Records};
use super::topology::ParameterPlane;
use super::{decoded, foreign, units, ReadError};
use crate::spline::curve::Curve;
use crate::spline::space_curve::{Arc, SpaceCurve};
use crate::spline::unroll;

/// A curve of a file.
#[derive(Clone, Debug)]
pub struct EdgeCurve {
    /// Entity number.
    pub entity: u64,
    /// Its pieces in order, homogeneous, mm.
    pub curves: Vec<Curve<4>>,
}

/// All edges of a STEP file, or, where it has no edges, its curves. Placements of assemblies are not applied: a file
/// of curves is read as it stands.
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
    let mut keep = |entity: u64, path: Result<Vec<Arc>, Fault>| match path.and_then(|p| pieces(entity, &p)) {
        Ok(curves) if !curves.is_empty() => out.push(EdgeCurve { entity, curves }),
        Ok(_) => {}
        Err(f) => {
            fault.get_or_insert(f);
        }
    };
    let edges = records.all(&["EDGE_CURVE"]);
    for id in &edges {
        keep(*id, geometry.edge_curve(*id, &plane).map(|e| e.path));
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
            keep(id, geometry.course(id, 0).and_then(|c| whole(id, c)));
        }
    }
    match (out.is_empty(), fault) {
        (true, Some(f)) => Err(ReadError::NoUsableFaces { count: edges.len(), entity: f.entity, reason: f.reason }),
        (true, None) => Err(ReadError::NoFaces { records: records.len(), reason: "it holds no curves either".into() }),
        _ => Ok(out),
    }
}

/// A course as a path: bounded curves as they are.
fn whole(id: u64, course: Course) -> Result<Vec<Arc>, Fault> {
    match course {
        Course::Path(path) => Ok(path),
        Course::Basis(curve, _) => match curve.domain() {
            Some((from, to)) => Ok(vec![Arc { curve, from, to }]),
            None => Err(Fault::new(id, format!("#{id} is an endless curve"))),
        },
    }
}

/// The pieces of a path as splines in the direction of travel.
fn pieces(id: u64, path: &[Arc]) -> Result<Vec<Curve<4>>, Fault> {
    path.iter()
        .filter(|a| a.from != a.to)
        .map(|arc| {
            let (lo, hi) = (arc.from.min(arc.to), arc.from.max(arc.to));
            let spline = match &arc.curve {
                SpaceCurve::Spline(c) => {
                    let (a, b) = c.domain();
                    let hair = 1e-9 * (b - a);
                    if lo >= a - hair && hi <= b + hair {
                        c.restricted(lo.max(a), hi.min(b))
                    } else {
                        unroll::curve(c, (lo, hi))
                    }
                }
                other => other.to_spline(lo, hi).map(|c| c.0),
            };
            let spline = spline.map_err(|e| Fault::new(id, e.to_string()))?;
            Ok(if arc.to < arc.from { spline.reversed() } else { spline })
        })
        .collect()
}
