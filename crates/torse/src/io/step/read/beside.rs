//! Curves and points of sets beside the faces of a STEP file, where its assemblies put them.

use super::curves::{Geometry, ResolvedCurve};
use super::records::{as_reference, Fault, Records};
use super::token::Value;
use super::walk::Census;
use crate::answer::note::reader::ReaderNote;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::brep::ruled::spline_of;
use crate::brep::space_curve::Arc;
use crate::spline::curve::Curve;
use std::collections::HashMap;

/// Reads them, mm; with what could not be read.
pub(super) fn read(records: &Records, census: &Census) -> (Vec<FreeCurve>, Vec<ReaderNote>) {
    let layers = layers(records);
    let (mut out, mut notes) = (Vec::new(), Vec::new());
    for o in &census.beside {
        let Some(units) = census.units.get(o.units) else { continue };
        let geometry = Geometry { records, units };
        let shape = match records.name(o.face) {
            POINT => geometry.point(o.face).map(FreeShape::Point),
            _ => geometry
                .resolved_curve(o.face, 0)
                .and_then(|c| whole(o.face, c))
                .and_then(|p| pieces(o.face, &p))
                .map(FreeShape::Curve),
        };
        match shape.map(|s| s.placed(&o.placement)) {
            Ok(shape) if shape.is_sound() => {
                let name = records.simple(o.face).map_or("", |a| a.text(0));
                let name = if UNNAMED.contains(&name) { "" } else { name };
                let layer = layers.get(&o.face).cloned().unwrap_or_default();
                out.push(FreeCurve { item: format!("#{}", o.face), name: name.into(), layer, shape });
            }
            Ok(_) => notes.push(ReaderNote::NotFinite { item: format!("#{}", o.face) }),
            Err(f) => notes.push(ReaderNote::FreeCurve { reason: f.reason }),
        }
    }
    (out, notes)
}

/// Keyword of points.
pub(super) const POINT: &str = "CARTESIAN_POINT";
/// Names that say that there is none.
const UNNAMED: [&str; 3] = ["NONE", "none", " "];

/// The layer of every item that has one.
fn layers(records: &Records) -> HashMap<u64, String> {
    let mut out = HashMap::new();
    for id in records.all(&["PRESENTATION_LAYER_ASSIGNMENT"]) {
        let Ok(a) = records.simple(id) else { continue };
        let Some(Value::List(items)) = a.values.get(2) else { continue };
        out.extend(items.iter().filter_map(as_reference).map(|item| (item, a.text(0).to_owned())));
    }
    out
}

/// A curve as a path: bounded curves as they are.
pub(super) fn whole(id: u64, curve: ResolvedCurve) -> Result<Vec<Arc>, Fault> {
    match curve {
        ResolvedCurve::Path(path) => Ok(path),
        ResolvedCurve::Basis(curve, _) => match curve.domain() {
            Some((from, to)) => Ok(vec![Arc { curve, from, to }]),
            None => Err(Fault::new(id, format!("#{id} is an endless curve"))),
        },
    }
}

/// The pieces of a path as splines in the direction of travel.
pub(super) fn pieces(id: u64, path: &[Arc]) -> Result<Vec<Curve<4>>, Fault> {
    let there = path.iter().filter(|a| a.from != a.to);
    there.map(|arc| spline_of(arc).map_err(|e| Fault::new(id, e.to_string()))).collect()
}
