//! Curves and points of an IGES file that nothing is made of, where its copies put them.

use super::curves::Geometry;
use super::records::Fault;
use super::walk::{Occurrence, POINT};
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::brep::ruled::spline_of;
use crate::geom::placement::Placement;
use crate::spline::curve::Curve;

/// Reads them, mm; with what could not be read, in words.
pub(super) fn read(geometry: &Geometry, uses: &[Occurrence]) -> (Vec<FreeCurve>, Vec<String>) {
    let unit = geometry.records.global.millimetres;
    let (mut out, mut notes) = (Vec::new(), Vec::new());
    for o in uses {
        let shape = match geometry.records.kind(o.face) {
            POINT => geometry.point(o.face).map(|p| FreeShape::Point(p * unit)),
            _ => pieces(geometry, o.face).map(FreeShape::Curve),
        };
        // Shapes are in mm here, shifts in the numbers of the file.
        let place = Placement { shift: o.placement.shift * unit, ..o.placement };
        match shape.map(|s| s.placed(&place)) {
            Ok(shape) if shape.is_sound() => {
                let name = geometry.records.entry(o.face).map_or_else(String::new, |e| e.label.clone());
                out.push(FreeCurve { item: format!("D{}", o.face), name, layer: String::new(), shape });
            }
            Ok(_) => notes.push(format!("the curve D{} is not finite where it is put", o.face)),
            Err(f) => notes.push(format!("a curve beside the faces is not read: {}", f.reason)),
        }
    }
    (out, notes)
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
