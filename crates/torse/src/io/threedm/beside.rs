//! Curves, points and text dots of an archive that lie beside its faces.

use super::archive::Archive;
use super::blocks::{label, Occurrence};
use super::bytes::{fault, Cursor, Reading};
use super::classes::Class;
use super::curves;
use super::records::Object;
use crate::answer::note::reader::ReaderNote;
use crate::brep::free_curve::{FreeCurve, FreeShape};
use std::collections::HashSet;

/// Numbers that the second and further copies of curves may hold in all; a short file can ask for copies without end.
const MOST_COPIED: usize = 5_000_000;

/// Reads them where blocks put them, mm; with what could not be read, in words.
pub(super) fn read(archive: &Archive, uses: &[Occurrence]) -> (Vec<FreeCurve>, Vec<ReaderNote>) {
    let layers = archive.named_layers();
    let (mut out, mut notes) = (Vec::new(), Vec::new());
    let (mut seen, mut held) = (HashSet::new(), 0);
    for o in uses {
        let Some(Ok(record)) = archive.objects.get(o.object) else { continue };
        let Ok(object) = record.object.clone() else { continue };
        let first = seen.insert(o.object);
        match shape(object, archive.unit.length) {
            Ok((shape, words)) => {
                held += if first { 0 } else { numbers(&shape) };
                let shape = shape.placed(&o.placement);
                if held > MOST_COPIED || !shape.is_sound() {
                    continue;
                }
                let layer = layers.get(&record.attributes.layer).map_or_else(String::new, |l| l.0.clone());
                let name = if words.is_empty() { record.attributes.name.clone() } else { words };
                out.push(FreeCurve { item: format!("object {}", o.object + 1), name, layer, shape });
            }
            Err(f) if first => notes.push(ReaderNote::Object { name: label(o.object, record), reason: f.0 }),
            Err(_) => {}
        }
    }
    if held > MOST_COPIED {
        notes.push(ReaderNote::TooManyCopies);
    }
    (out, notes)
}

/// Numbers that a shape holds.
fn numbers(shape: &FreeShape) -> usize {
    match shape {
        FreeShape::Curve(pieces) => pieces.iter().map(|c| c.control.len()).sum(),
        FreeShape::Point(_) | FreeShape::Text { .. } => 1,
    }
}

/// The shape of an object, and its words.
fn shape(object: Object, scale: f64) -> Reading<(FreeShape, String)> {
    match object.class {
        Class::Point => Ok((FreeShape::Point(anchor(&mut object.data.clone(), scale)?), String::new())),
        Class::Dot => {
            let mut c = object.data.clone();
            let at = anchor(&mut c, scale)?;
            // Its height in points of type stands before the words.
            c.i32()?;
            Ok((FreeShape::Point(at), c.name()?))
        }
        _ => {
            let pieces = curves::curve(object, scale).and_then(|c| curves::splines(&c.whole()))?;
            Ok((FreeShape::Curve(pieces), String::new()))
        }
    }
}

/// Where a point or a dot stands.
fn anchor(c: &mut Cursor, scale: f64) -> Reading<crate::geom::Vec3> {
    match c.version()? {
        (1, _) => curves::point(c, scale),
        (major, minor) => fault(format!("a point has the unknown version {major}.{minor}")),
    }
}
