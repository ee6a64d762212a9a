//! Reading archives of Rhino (3DM) of versions 2 to 8: every face, placed, named, in millimetres.
//!
//! An archive is a tree of chunks; objects that cannot be read cost themselves and nothing more, and every face that is
//! lost is named with its object and the reason. Knows the format; the geometry of trimming is
//! `brep::trim`'s.

mod archive;
mod beside;
mod blocks;
mod brep;
mod bytes;
mod classes;
mod curves;
mod error;
mod extrusion;
mod faces;
pub(crate) mod free_curves;
pub mod meshes;
mod records;
mod surfaces;
pub(crate) mod write;

use self::blocks::{Occurrence, Want};
pub use self::error::ReadError;
use self::faces::Shapes;
use crate::answer::note::reader::{ReaderNote, UnitNote};
use crate::answer::note::Note;
use crate::answer::skipped::Skipped;
use crate::brep::area::spanned_area_estimate;
use crate::brep::face::Face;
use crate::brep::raw::SurfaceKind;
use crate::brep::raw::{RawFace, RawRegion};
use crate::brep::trim;
use crate::io::model::unread;
use crate::io::model::{Model, ReadOptions};
use crate::io::words::left_out;
use crate::num::parallel;
use std::collections::{HashMap, HashSet};

/// Whether bytes begin as an archive of Rhino does, of whatever version.
pub(crate) fn recognises(bytes: &[u8]) -> bool {
    bytes.starts_with(archive::MAGIC)
}

/// Reads an archive of Rhino.
///
/// Faces are numbered in the order of the file: those of the first object, then those of the second, and so on; the number
/// is [`Face::entity`]. A face is named by its object, its part is the block that it belongs to or the layer that it lies
/// on. Objects that Rhino does not show are left out, and counted in the notes.
///
/// *Guarantee*: no panic and bounded recursion on any input; every face of a surface, polysurface or extrusion that is
/// shown is either in `faces` or named in `skipped`, and so is every mesh, SubD and object of an unknown class. *Not
/// guaranteed*: faces whose file contradicts itself (loops of wrong sense, gaps above 2 % of the boundary) may be refused
/// where another program repairs them.
///
/// # Errors
/// See [`ReadError`]: only where no face at all can be used, or where the tables of the file are damaged.
pub(crate) fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<Model, ReadError> {
    let archive = archive::archive(bytes)?;
    let mut notes = archive.notes.clone();
    if archive.unit.name.is_empty() {
        notes.push(ReaderNote::Unit(UnitNote::Missing));
    }
    let uses = blocks::uses(&archive, Want::Faces);
    notes.extend(uses.notes);
    let (curves, lost) = beside::read(&archive, &uses.beside);
    notes.extend(lost);
    let shapes = faces::shapes(&archive, &uses.occurrences);
    let mut skipped = uses.skipped;
    let objects = archive.objects.len();
    if shapes.count == 0 {
        skipped.extend(shapes.lost);
        let reason = skipped.first().map_or(String::new(), left_out);
        return Err(ReadError::NoFaces { objects, reason });
    }
    let count = shapes.count;
    let faces = placed(shapes, &uses.occurrences, options, &mut skipped);
    if faces.is_empty() {
        let reason = skipped.first().map_or(String::new(), left_out);
        return Err(ReadError::NoUsableFaces { count, reason });
    }
    let products = parts(&faces);
    let notes = notes.into_iter().map(Note::Input).collect();
    Ok(Model { faces, skipped, unit: archive.unit.name, notes, products, curves })
}

/// Names of the parts, in the order in which they appear.
fn parts(faces: &[Face]) -> Vec<String> {
    let mut seen = HashSet::new();
    let names = faces.iter().map(|f| f.part.as_str()).filter(|name| !name.is_empty());
    names.filter(|name| seen.insert(*name)).map(str::to_owned).collect()
}

/// Numbers that the second and further copies of faces may hold in all; a short file can ask for copies without end.
const MOST_COPIED: usize = 20_000_000;

/// A face that could not be trimmed, with its area (mm²) as far as its edges tell.
struct Lost {
    entity: u64,
    reason: String,
    area: Option<f64>,
}

/// Trims every face once and places its occurrences.
fn placed(shapes: Shapes, uses: &[Occurrence], options: &ReadOptions, skipped: &mut Vec<Skipped>) -> Vec<Face> {
    skipped.extend(shapes.lost);
    let mut by_object: HashMap<usize, Vec<Result<Vec<Face>, Lost>>> = HashMap::new();
    let jobs = shapes.shapes.into_iter().flat_map(|s| s.faces.into_iter().map(move |face| (s.object, face)));
    let jobs: Vec<(usize, Result<RawFace, Skipped>)> = jobs.collect();
    let trim = |(object, raw): (usize, Result<RawFace, Skipped>)| (object, raw.map(|raw| trimmed(&raw, options)));
    for (object, face) in parallel::map(jobs, trim) {
        match face {
            Ok(face) => by_object.entry(object).or_default().push(face),
            Err(lost) => skipped.push(lost),
        }
    }
    let mut out = Vec::new();
    let mut named: HashMap<u64, usize> = HashMap::new();
    let mut numbers = 0;
    let mut seen = HashSet::new();
    for (body, o) in (1..).zip(uses) {
        let copied = !seen.insert(o.object);
        let grown = o.placement.scale().powi(2);
        for face in by_object.get(&o.object).into_iter().flatten() {
            match face {
                Ok(faces) => {
                    for f in faces {
                        if copied {
                            numbers += size(f);
                        }
                        let face = (numbers <= MOST_COPIED).then(|| at_home(f, o, body)).filter(is_finite);
                        match face {
                            Some(face) => out.push(face),
                            // Named once, however often it is used.
                            None if named.insert(f.entity, skipped.len()).is_none() => {
                                let reason = "its placement is not finite, or the blocks of the file hold too much";
                                skipped.push(unread(f.entity, reason, None));
                            }
                            None => {}
                        }
                    }
                }
                Err(lost) => {
                    // Named once, with the area of all its occurrences.
                    let area = lost.area.map(|a| a * grown).filter(|a| a.is_finite());
                    let at = *named.entry(lost.entity).or_insert_with(|| {
                        skipped.push(unread(lost.entity, lost.reason.clone(), area.map(|_| 0.0)));
                        skipped.len() - 1
                    });
                    skipped[at].area_estimate = skipped[at].area_estimate.zip(area).map(|(sum, a)| sum + a);
                }
            }
        }
    }
    out
}

/// The face where a use of its object puts it.
fn at_home(f: &Face, o: &Occurrence, body: u32) -> Face {
    let mut face = f.placed(&o.placement, &o.part);
    face.body = body;
    if face.kind != SurfaceKind::Plane && !blocks::is_similarity(&o.placement) {
        face.kind = SurfaceKind::Spline;
    }
    face
}

fn trimmed(raw: &RawFace, options: &ReadOptions) -> Result<Vec<Face>, Lost> {
    trim::faces(raw, options.chord_tolerance).map_err(|e| Lost {
        entity: raw.entity,
        reason: if raw.name.is_empty() { e.to_string() } else { format!("'{}': {e}", raw.name) },
        area: match &raw.region {
            RawRegion::Loops(loops) => spanned_area_estimate(loops),
            _ => None,
        },
    })
}

/// Numbers that a face holds: control points, corners, about as many for its edges.
fn size(f: &Face) -> usize {
    4 * f.surface.control.len() + 8 * f.loops.iter().map(|l| l.points.len()).sum::<usize>()
}

fn is_finite(f: &Face) -> bool {
    f.surface.control.iter().flatten().all(|x| x.is_finite())
        && f.loops.iter().flat_map(|l| &l.points).flatten().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests;
