//! Curves and points of an IGES file that nothing is made of, where its copies put them.

use super::annotations::{self, NOTE};
use super::curves::Geometry;
use super::records::{Fault, Records};
use super::walk::{Occurrence, POINT};
use crate::answer::note::reader::ReaderNote;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::brep::ruled::spline_of;
use crate::geom::placement::Placement;
use crate::spline::curve::Curve;
use nalgebra::Matrix3;
use std::collections::HashMap;

/// Reads them, mm; with what could not be read, in words.
pub(super) fn read(geometry: &Geometry, uses: &[Occurrence]) -> (Vec<FreeCurve>, Vec<ReaderNote>) {
    let unit = geometry.records.global.millimetres;
    let levels = levels(geometry.records);
    let (mut out, mut notes) = (Vec::new(), Vec::new());
    for o in uses {
        // Shapes are in mm here, shifts in the numbers of the file.
        let place = Placement { shift: o.placement.shift * unit, ..o.placement };
        let entry = geometry.records.entry(o.face);
        let layer = entry.and_then(|e| levels.get(&e.level)).cloned().unwrap_or_default();
        match shapes(geometry, o.face) {
            Ok(shapes) => {
                for (name, shape) in shapes {
                    let shape = shape.placed(&place);
                    if shape.is_sound() {
                        out.push(FreeCurve { item: format!("D{}", o.face), name, layer: layer.clone(), shape });
                    } else {
                        notes.push(ReaderNote::NotFinite { item: format!("D{}", o.face) });
                    }
                }
            }
            Err(f) => notes.push(ReaderNote::FreeCurve { reason: f.reason }),
        }
    }
    notes.extend(annotations::told(geometry.records));
    (out, notes)
}

/// Names of levels by their numbers, as properties of the file (406 of form 3) give them.
fn levels(records: &Records) -> HashMap<i64, String> {
    let named = records.all().filter(|e| e.kind == 406 && e.form == 3 && !e.text(3).is_empty());
    named.map(|e| (e.level, e.text(3).to_owned())).collect()
}

/// What an entity is, mm, with its name; strings of a note one by one.
fn shapes(geometry: &Geometry, id: u64) -> Result<Vec<(String, FreeShape)>, Fault> {
    let (records, unit) = (geometry.records, geometry.records.global.millimetres);
    let label = records.entry(id).map_or_else(String::new, |e| e.label.clone());
    match records.kind(id) {
        POINT => Ok(vec![(label, FreeShape::Point(geometry.point(id)? * unit))]),
        NOTE => {
            let larger = Placement { linear: Matrix3::identity() * unit, ..Placement::identity() };
            let texts = annotations::texts(records, records.get(id)?)?;
            Ok(texts.into_iter().map(|(words, shape)| (words, shape.placed(&larger))).collect())
        }
        _ => Ok(vec![(label, FreeShape::Curve(pieces(geometry, id)?))]),
    }
}

/// The pieces of a curve as splines in the direction of travel, mm.
pub(super) fn pieces(geometry: &Geometry, id: u64) -> Result<Vec<Curve<4>>, Fault> {
    let unit = geometry.records.global.millimetres;
    let scaled = |h: &[f64; 4]| [h[0] * unit, h[1] * unit, h[2] * unit, h[3]];
    geometry
        .path(id, 0)?
        .iter()
        .map(|(id, arc)| {
            let spline = spline_of(arc).map_err(|e| Fault::new(*id, e.to_string()))?;
            Ok(Curve { control: spline.control.iter().map(scaled).collect(), knots: spline.knots })
        })
        .collect()
}
