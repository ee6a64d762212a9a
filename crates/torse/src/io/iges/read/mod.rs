//! Reading IGES files in the fixed ASCII format (versions 3 to 5.3): every face, placed, named, in millimetres.
//!
//! Tolerant of what real files contain: an entity that cannot be read costs what depends on it and nothing more, and
//! every face that is lost is named with the reason. Knows the format; the geometry of trimming is
//! `brep::trim`'s. Entities are named by the sequence number of their first line in the directory (`D5`),
//! always an odd number.

mod annotations;
mod beside;
mod boundary;
mod curves;
mod faces;
mod fields;
pub mod free;
mod global;
mod patch;
mod placing;
mod records;
mod sections;
mod solids;
mod splines;
mod surfaces;
mod walk;

use self::curves::Geometry;
use self::faces::{Asked, Lost};
use self::records::Records;
use self::sections::{Sections, LETTER, RECORD};
use self::walk::{Census, Occurrence};
use crate::answer::note::reader::{EndMark, ReaderNote};
use crate::answer::note::Note;
use crate::answer::skipped::Skipped;
use crate::brep::face::Face;
use crate::geom::placement::Placement;
use crate::geom::Vec3;
use crate::io::model::unread;
use crate::io::model::{first_of, Model, ReadOptions};
use crate::io::words::note::reader_note;
use crate::io::words::why;
use crate::num::parallel;
use nalgebra::Matrix3;
use std::collections::HashMap;

/// Why nothing could be read at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// No bytes.
    #[error("the file is empty")]
    Empty,
    /// Something else than IGES.
    #[error("this is not an IGES file: {0}")]
    NotIges(String),
    /// A form of the format that is not read.
    #[error("the IGES file is in the {0} form, which is not read; save it in the fixed ASCII form")]
    OtherForm(&'static str),
    /// Sections are missing, or data that entities need are still to come where the file ends.
    #[error("the IGES file is truncated: {0}; save it again from the CAD program")]
    Truncated(String),
    /// Entities, but no face among them.
    #[error("the IGES file holds no surfaces ({entities} entities read{}); export trimmed surfaces or solids, not wires or drawings", first_of(.reason))]
    NoFaces {
        /// Number of entities.
        entities: usize,
        /// The first item that could not be used, with the reason; empty if there is none.
        reason: String,
    },
    /// Every face was refused.
    #[error("none of the {count} faces could be read; the first, D{entity}: {reason}")]
    NoUsableFaces {
        /// Number of faces.
        count: usize,
        /// Number of the first one's directory entry.
        entity: u64,
        /// What is wrong with it.
        reason: String,
    },
}

/// Whether bytes look like an IGES file of any form: the first line that is not blank ends with the letter of a section
/// in column 73 and a number.
pub(crate) fn recognises(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = bytes.iter().position(|b| !matches!(b, b'\r' | b'\n')).unwrap_or(0);
    let head = &bytes[start..bytes.len().min(start + RECORD)];
    let line = head.split(|b| matches!(b, b'\r' | b'\n')).next().unwrap_or_default();
    let number = || line.get(LETTER + 1..).is_some_and(|n| n.iter().all(|b| b.is_ascii_digit() || *b == b' '));
    line.get(LETTER).is_some_and(|l| b"SGCB".contains(l)) && number() || Sections::of(head).flag.is_some()
}

/// Reads an IGES file with default options.
///
/// *Guarantee*: no panic and bounded recursion on any input; every trimmed or bounded surface, every face of a solid or
/// shell, and every surface that nothing refers to is either in `faces` or named in `skipped` by its directory entry.
/// *Not guaranteed*: faces whose file contradicts itself may be refused where another program repairs them.
///
/// # Errors
/// See [`ReadError`]: only where no face at all can be used, or where the end of the file is certainly missing.
pub fn read(bytes: &[u8]) -> Result<Model, ReadError> {
    read_with(bytes, &ReadOptions::default())
}

/// Reads an IGES file; see [`read`].
///
/// # Errors
/// As [`read`].
pub(crate) fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<Model, ReadError> {
    let sections = Sections::of(bytes);
    let records = records(bytes, &sections)?;
    let census = walk::census(&records);
    let mut notes = records.notes.clone();
    notes.extend(damage(&sections));
    notes.extend(census.notes.iter().cloned());
    let mut skipped: Vec<Skipped> = census.faults.iter().map(|f| unread(f.entity, f.reason.clone(), None)).collect();
    if census.occurrences.is_empty() {
        let damage = damage(&sections);
        let reason = skipped.first().map(|s| why(&s.reason)).into_iter().chain(damage.iter().map(reader_note));
        let reason = reason.collect::<Vec<_>>().join("; ");
        return Err(ReadError::NoFaces { entities: records.order.len(), reason });
    }
    let before = skipped.len();
    let faces = placed(&records, &census, options, &mut skipped);
    if faces.is_empty() {
        let first = skipped.get(before).or(skipped.first());
        let (entity, reason) = first.map_or((0, String::new()), |s| (s.entity.unwrap_or_default(), why(&s.reason)));
        return Err(ReadError::NoUsableFaces { count: census.occurrences.len(), entity, reason });
    }
    let (curves, lost) = beside::read(&Geometry { records: &records }, &census.beside);
    let notes = notes.into_iter().chain(lost).map(Note::Input).collect();
    Ok(Model { faces, skipped, unit: records.global.unit.clone(), notes, products: census.parts, curves })
}

/// The entities of a file.
fn records(bytes: &[u8], sections: &Sections) -> Result<Records, ReadError> {
    if bytes.iter().all(|b| b.is_ascii_whitespace() || *b == 0) {
        return Err(ReadError::Empty);
    }
    match sections.flag {
        Some(b'C') => return Err(ReadError::OtherForm("compressed ASCII")),
        Some(_) => return Err(ReadError::OtherForm("binary")),
        None => {}
    }
    if !sections.recognised() {
        return Err(ReadError::NotIges(foreign(bytes).into()));
    }
    if sections.directory.is_empty() {
        return Err(ReadError::Truncated("it has no directory".into()));
    }
    if sections.parameter.is_empty() {
        return Err(ReadError::Truncated("it has no parameter data".into()));
    }
    let records = Records::of(sections);
    if let (false, Some(first)) = (sections.terminated, records.lost.first()) {
        let n = records.lost.len();
        let what = format!("it ends before the data of {n} entities, the first D{first}, and without its last line");
        return Err(ReadError::Truncated(what));
    }
    Ok(records)
}

/// Bytes in which the kind of a foreign file shows.
const START: usize = 256;

/// What a file of another format is.
fn foreign(bytes: &[u8]) -> &'static str {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(START)]).into_owned();
    let start = start.trim_start_matches(|c: char| c.is_control() || c.is_whitespace() || c == '\u{feff}');
    if start.starts_with("ISO-10303-21") {
        "it is a STEP file"
    } else if start.starts_with("PK") {
        "it is a ZIP archive (unpack it first)"
    } else if start.starts_with("solid") {
        "it looks like an STL mesh"
    } else if start.starts_with("3D Geometry File Format") {
        "it is a Rhino 3DM file"
    } else if start.starts_with("%PDF") {
        "it is a PDF"
    } else if start.starts_with('<') {
        "it is XML or HTML"
    } else if start.starts_with("0\n") || start.starts_with("0\r") || start.starts_with("999") {
        "it looks like a DXF drawing"
    } else {
        "no line of it ends with the letter of a section and a number"
    }
}

/// What was found wrong with the lines of a file.
fn damage(sections: &Sections) -> Vec<ReaderNote> {
    let mut out = Vec::new();
    if !sections.terminated {
        out.push(ReaderNote::NoEnd(EndMark::LastLine));
    }
    if sections.unreadable > 0 {
        out.push(ReaderNote::NoSection { lines: sections.unreadable, line: sections.first_unreadable });
    }
    out
}

/// Builds every face once and places its occurrences.
fn placed(records: &Records, census: &Census, options: &ReadOptions, skipped: &mut Vec<Skipped>) -> Vec<Face> {
    let mut jobs: Vec<(u64, bool)> = census.occurrences.iter().map(key).collect();
    jobs.sort_unstable();
    jobs.dedup();
    let unit = records.global.millimetres;
    let to_mm = Placement { linear: Matrix3::identity() * unit, shift: Vec3::zeros() };
    let chords = options.chord_tolerance.map(|t| t / unit);
    let geometry = Geometry { records };
    let built: HashMap<(u64, bool), Result<Vec<Face>, Lost>> =
        parallel::map(jobs, |job| (job, geometry.faces(job.0, Asked { flipped: job.1, chords }))).into_iter().collect();
    let mut out = Vec::new();
    let mut named: HashMap<(u64, bool), usize> = HashMap::new();
    for o in &census.occurrences {
        let placement = to_mm.after(&o.placement);
        match built.get(&key(o)) {
            Some(Ok(faces)) => {
                let there = faces.iter().map(|f| {
                    let mut face = f.placed(&placement, &o.part);
                    face.body = o.body;
                    face
                });
                let before = out.len();
                out.extend(there.filter(is_finite));
                if out.len() < before + faces.len() {
                    skipped.push(unread(o.face, "its placement is not finite", None));
                }
            }
            Some(Err(lost)) => {
                // Named once, with the area of all its occurrences.
                let area = lost.area.map(|a| a * placement.scale().powi(2)).filter(|a| a.is_finite());
                let at = *named.entry(key(o)).or_insert_with(|| {
                    skipped.push(unread(o.face, lost.fault.reason.clone(), area.map(|_| 0.0)));
                    skipped.len() - 1
                });
                skipped[at].area_estimate = skipped[at].area_estimate.zip(area).map(|(sum, a)| sum + a);
            }
            None => {}
        }
    }
    out
}

fn is_finite(f: &Face) -> bool {
    f.surface.control.iter().flatten().all(|x| x.is_finite())
        && f.loops.iter().flat_map(|l| &l.points).flatten().all(|x| x.is_finite())
}

fn key(o: &Occurrence) -> (u64, bool) {
    (o.face, o.flipped)
}
