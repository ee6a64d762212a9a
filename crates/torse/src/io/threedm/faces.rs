//! The faces of the objects of an archive.

use super::archive::Archive;
use super::blocks::{label, Occurrence};
use super::brep;
use super::bytes::{fault, Reading};
use super::classes::Class;
use super::extrusion;
use super::records::{Object, Unit};
use super::surfaces;
use crate::answer::skipped::Skipped;
use crate::brep::raw::{RawFace, RawRegion, SurfaceDeviation};
use crate::io::model::unread;
use std::collections::BTreeSet;

/// The faces of one object before they are trimmed.
pub(super) struct Shape {
    /// Index of the object in its table.
    pub object: usize,
    /// The faces, or what is wrong with them.
    pub faces: Vec<Result<RawFace, Skipped>>,
}

/// The faces of all objects.
pub(super) struct Shapes {
    /// One for each object that could be read.
    pub shapes: Vec<Shape>,
    /// Objects that could not.
    pub lost: Vec<Skipped>,
    /// Number of faces, those of a lost object counted as one.
    pub count: usize,
}

/// Reads every object that is used once, and numbers its faces.
pub(super) fn shapes(archive: &Archive, occurrences: &[Occurrence]) -> Shapes {
    let used: BTreeSet<usize> = occurrences.iter().map(|o| o.object).collect();
    let mut out = Shapes { shapes: Vec::new(), lost: Vec::new(), count: 0 };
    for index in used {
        let Some(Ok(record)) = archive.objects.get(index) else { continue };
        let Ok(object) = &record.object else { continue };
        let name = &record.attributes.name;
        let first = out.count as u64 + 1;
        match raw_faces(object.clone(), &archive.unit) {
            Ok(all) => {
                let several = all.len() > 1;
                let numbered = |(k, face): (usize, Reading<RawFace>)| {
                    let entity = first + k as u64;
                    let title = if several && !name.is_empty() { format!("{name}.{}", k + 1) } else { name.clone() };
                    match face {
                        Ok(f) => Ok(RawFace { entity, name: title, ..f }),
                        Err(f) => {
                            let which = if several { format!("face {} of ", k + 1) } else { String::new() };
                            let reason = format!("{which}{}: {}", label(index, record), f.0);
                            Err(unread(entity, reason, None))
                        }
                    }
                };
                out.count += all.len();
                out.shapes.push(Shape { object: index, faces: all.into_iter().enumerate().map(numbered).collect() });
            }
            Err(f) => {
                out.count += 1;
                let reason = format!("{}: {}", label(index, record), f.0);
                out.lost.push(unread(first, reason, None));
            }
        }
    }
    out
}

/// The faces of an object, each by itself.
fn raw_faces(object: Object, unit: &Unit) -> Reading<Vec<Reading<RawFace>>> {
    let scale = unit.length;
    match object.class {
        Class::Brep => {
            let brep = brep::read(object.data, scale)?;
            if brep.count() == 0 {
                return fault("it has no faces");
            }
            Ok((0..brep.count()).map(|i| brep.face(i, unit.tolerance)).collect())
        }
        Class::Extrusion => Ok(extrusion::faces(object.data, scale, unit.tolerance)?.into_iter().map(Ok).collect()),
        _ => {
            let patch = surfaces::surface(object, scale)?;
            let whole = patch.whole;
            Ok(vec![Ok(RawFace {
                entity: 0,
                name: String::new(),
                part: String::new(),
                kind: patch.kind,
                support: whole.support,
                same_sense: !whole.flipped,
                region: RawRegion::Rectangle(whole.rectangle),
                surface_deviation: SurfaceDeviation::NONE,
                uncertainty: unit.tolerance,
            })])
        }
    }
}
