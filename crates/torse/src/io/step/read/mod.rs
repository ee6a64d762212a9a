//! Reading STEP files (ISO 10303-21) of AP203, AP214 and AP242: every face, placed, named, in millimetres.
//!
//! Tolerant of what real files contain: a record that cannot be read costs what depends on it and nothing more, and
//! every face that is lost is named with the reason. Knows the format; the geometry of trimming is
//! `brep::trim`'s.

mod annotations;
mod beside;
mod curves;
pub mod edges;
mod extruded;
mod items;
pub mod own;
mod product;
mod records;
mod surfaces;
mod token;
mod topology;
mod units;
mod walk;

use self::curves::Geometry;
use self::records::{Fault, Records};
use self::walk::{Census, Occurrence};
use crate::answer::note::reader::{EndMark, ReaderNote, UnitNote};
use crate::answer::note::Note;
use crate::answer::skipped::Skipped;
use crate::brep::face::Face;
use crate::brep::raw::RawFace;
use crate::brep::trim;
use crate::io::model::unread;
use crate::io::model::{first_of, Model, ReadOptions};
use crate::io::words::note::reader_note;
use crate::io::words::why;
use crate::num::parallel;
use std::borrow::Cow;
use std::collections::HashMap;

/// Why nothing could be read at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// No bytes.
    #[error("the file is empty")]
    Empty,
    /// Something else than STEP.
    #[error("this is neither a STEP, an IGES nor a Rhino file: {0}")]
    NotStep(String),
    /// The data section is missing, holds no record, or ends where records that others need are still to come.
    #[error("the STEP file is truncated: {0}; save it again from the CAD program")]
    Truncated(String),
    /// A unit in which lengths or angles are given that is not known: all sizes would be a guess.
    #[error("a unit of the STEP file could not be read: {reason} (#{entity}); save it again from the CAD program, in millimetres")]
    Unit {
        /// Entity number of the unit.
        entity: u64,
        /// What is wrong with it.
        reason: String,
    },
    /// Records, but no face among them.
    #[error("the STEP file holds no surfaces ({records} records read{}); export surfaces or solids, not wires or meshes", first_of(.reason))]
    NoFaces {
        /// Number of records.
        records: usize,
        /// The first item that could not be used, with the reason; empty if there is none.
        reason: String,
    },
    /// Every face was refused.
    #[error("none of the {count} faces could be read; the first, #{entity}: {reason}")]
    NoUsableFaces {
        /// Number of faces.
        count: usize,
        /// Entity number of the first.
        entity: u64,
        /// What is wrong with it.
        reason: String,
    },
}

/// Bytes within which a STEP file says that it is one.
const START: usize = 1024;
/// What may stand before the first word of a file.
const BLANK: [char; 5] = ['\u{feff}', ' ', '\r', '\n', '\t'];

/// Whether a file says that it is STEP.
pub(crate) fn recognises(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(START)]);
    start.trim_start_matches(BLANK).starts_with("ISO-10303-21")
}

/// Reads a STEP file with default options.
///
/// *Guarantee*: no panic and bounded recursion on any input; every face of a shell, solid, surface model or geometric
/// set that a shape representation leads to is either in `faces` or named in `skipped`. *Not guaranteed*: faces whose
/// file contradicts itself (loops of wrong sense, gaps above 2 % of the boundary) may be refused where another program
/// repairs them.
///
/// # Errors
/// See [`ReadError`]: only where no face at all can be used, or where the end of the file is certainly missing.
///
/// # Example
/// ```
/// let model = torse::read_step(include_bytes!("../../../../../../data/cone_holes.step"))?;
/// assert_eq!((model.faces.len(), model.skipped.len()), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(bytes: &[u8]) -> Result<Model, ReadError> {
    read_with(bytes, &ReadOptions::default())
}

/// Reads a STEP file; see [`read`].
///
/// # Errors
/// As [`read`].
pub(crate) fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<Model, ReadError> {
    if bytes.iter().all(|b| b.is_ascii_whitespace() || *b == 0) {
        return Err(ReadError::Empty);
    }
    let text = decoded(bytes);
    let Some(records) = Records::parse(&text) else { return Err(foreign(&text)) };
    if records.len() == 0 {
        return Err(ReadError::Truncated("its data section holds no readable record".into()));
    }
    if let Some(loss) = records.loss() {
        // What is lost may be faces, or the unit of length: whatever could still be read would be a guess.
        return Err(ReadError::Truncated(loss));
    }
    let census = product::census(&records);
    let mut notes = remarks(&records);
    notes.extend(census.notes.iter().cloned());
    let mut skipped: Vec<Skipped> = census.faults.iter().map(as_skipped).collect();
    if records.damage.truncated && (census.unplaced || census.occurrences.is_empty()) {
        let last = records.order.last().map_or(0, |id| *id);
        return Err(ReadError::Truncated(format!(
            "it ends after #{last} without ENDSEC, before the shape representation that holds its surfaces"
        )));
    }
    if census.occurrences.is_empty() {
        let damage = damage(&records).iter().map(reader_note).next();
        let reason = census.faults.first().map(|f| f.reason.clone()).into_iter().chain(damage);
        let reason = reason.collect::<Vec<_>>().join("; ");
        return Err(ReadError::NoFaces { records: records.len(), reason });
    }
    let fault = |o: &Occurrence| census.units.get(o.units).and_then(|u| u.fault.clone());
    if let Some(Fault { entity, reason }) = census.occurrences.iter().find_map(fault) {
        return Err(ReadError::Unit { entity, reason });
    }
    let unit = main_unit(&census, &mut notes);
    let faces = placed(&records, &census, options, &mut skipped);
    if faces.is_empty() {
        let (entity, reason) =
            skipped.last().map_or((0, String::new()), |s| (s.entity.unwrap_or_default(), why(&s.reason)));
        let reason =
            [reason].into_iter().chain(damage(&records).iter().map(reader_note)).collect::<Vec<_>>().join("; ");
        return Err(ReadError::NoUsableFaces { count: census.occurrences.len(), entity, reason });
    }
    let (curves, lost) = beside::read(&records, &census);
    let notes = notes.into_iter().chain(lost).chain(annotations::told(&records)).map(Note::Input).collect();
    Ok(Model { faces, skipped, unit, notes, products: census.products, curves })
}

/// UTF-8 where it is, else Latin-1, which never fails.
fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&b| char::from(b)).collect()),
    }
}

/// How files compressed by gzip and pictures begin, as text of one byte a letter.
const GZIP: &str = "\u{1f}\u{8b}";
const PNG: &str = "\u{89}PNG";
/// And text of two bytes a letter.
const UTF_16: [&str; 2] = ["\u{ff}\u{fe}", "\u{fe}\u{ff}"];

/// Whether a drawing begins here, after comments.
fn is_dxf(start: &str) -> bool {
    let mut lines = start.lines().map(str::trim);
    let mut code = lines.next();
    while code == Some("999") {
        lines.next();
        code = lines.next();
    }
    code == Some("0") && lines.next() == Some("SECTION")
}

/// Whether a mesh of triangles in binary form is so long as its header says.
fn is_binary_stl(text: &str) -> bool {
    /// Bytes of the header, and of each triangle.
    const SIZES: (usize, usize) = (80, 50);
    let bytes: Option<Vec<u8>> = text.chars().map(|c| u8::try_from(u32::from(c)).ok()).collect();
    let Some(bytes) = bytes else { return false };
    let count = bytes.get(SIZES.0..SIZES.0 + 4).and_then(|b| <[u8; 4]>::try_from(b).ok()).map(u32::from_le_bytes);
    count.is_some_and(|n| n > 0 && bytes.len() as u64 == SIZES.0 as u64 + 4 + SIZES.1 as u64 * u64::from(n))
}

/// Whether a line of whole numbers comes first, and the name of the program that makes such files soon after.
fn is_sat(start: &str) -> bool {
    let mut lines = start.lines();
    let numbers = lines.next().is_some_and(|l| {
        let words: Vec<&str> = l.split_whitespace().collect();
        words.len() >= 3 && words.iter().all(|w| w.parse::<i64>().is_ok())
    });
    numbers && lines.take(2).any(|l| l.contains("ACIS"))
}

/// Whether the first line that is no comment is one of a mesh.
fn is_obj(start: &str) -> bool {
    let line = start.lines().map(str::trim).find(|l| !l.is_empty() && !l.starts_with('#')).unwrap_or_default();
    let mut words = line.split_whitespace();
    match words.next() {
        Some("mtllib" | "usemtl" | "o" | "g" | "s") => words.next().is_some(),
        Some("v" | "vn" | "vt") => words.clone().count() >= 2 && words.all(|w| w.parse::<f64>().is_ok()),
        _ => false,
    }
}

/// What a text without a data section is.
fn foreign(text: &str) -> ReadError {
    let start = text.trim_start_matches(|c: char| c.is_control() || c.is_whitespace() || c == '\u{feff}');
    if text.contains("ISO-10303-21") || start.starts_with("HEADER") {
        return ReadError::Truncated("it has no DATA section".into());
    }
    let guess = if text.starts_with(UTF_16[0]) || text.starts_with(UTF_16[1]) {
        "its text is UTF-16 (save it as UTF-8 or plain ASCII)"
    } else if text.starts_with(GZIP) {
        "it is compressed with gzip (unpack it first)"
    } else if start.starts_with("AutoCAD Binary DXF") || is_dxf(start) {
        "it is a DXF drawing, which has curves and no faces"
    } else if text.starts_with(PNG) {
        "it is a picture"
    } else if start.starts_with('{') || start.starts_with('[') {
        "it is JSON"
    } else if start.starts_with("PK") {
        "it is a ZIP archive (unpack it first, if it is a compressed STEP file)"
    } else if start.starts_with("solid") || is_binary_stl(text) {
        "it looks like an STL mesh"
    } else if is_sat(start) {
        "it is an ACIS file (SAT), which is not read"
    } else if is_obj(start) {
        "it looks like an OBJ mesh, which has no surfaces"
    } else if start.starts_with("%PDF") {
        "it is a PDF"
    } else if start.starts_with("<?xml") || start.starts_with('<') {
        "it is XML or HTML"
    } else if text.lines().next().is_some_and(|l| l.len() >= 73 && l.as_bytes().get(72) == Some(&b'S')) {
        "it looks like an IGES file"
    } else {
        "it does not begin with ISO-10303-21"
    };
    ReadError::NotStep(guess.into())
}

/// Text that could not be read.
fn damage(records: &Records) -> Option<ReaderNote> {
    let (stretches, line) = (records.damage.unreadable, records.damage.first_unreadable_line);
    (stretches > 0).then_some(ReaderNote::NoRecords { stretches, line })
}

fn remarks(records: &Records) -> Vec<ReaderNote> {
    let mut notes = Vec::new();
    if records.damage.truncated {
        notes.push(ReaderNote::NoEnd(EndMark::Endsec));
    }
    notes.extend(damage(records));
    if let Some(&first) = records.repeated.first() {
        notes.push(ReaderNote::Repeated { count: records.repeated.len(), first });
    }
    notes
}

/// Share by which units may differ that are one, written in two ways: rounding of their factors.
const SAME_UNIT: f64 = 1e-12;

/// The unit of the context that most faces use.
fn main_unit(census: &Census, notes: &mut Vec<ReaderNote>) -> String {
    let mut counts = vec![0_usize; census.units.len()];
    for o in &census.occurrences {
        if let Some(c) = counts.get_mut(o.units) {
            *c += 1;
        }
    }
    let best = (0..counts.len()).max_by_key(|&i| (counts[i], usize::MAX - i));
    let unit = best.map_or(String::new(), |i| census.units[i].name.clone());
    if unit.is_empty() {
        notes.push(ReaderNote::Unit(UnitNote::Missing));
    }
    let lengths: Vec<f64> = (0..counts.len()).filter(|&i| counts[i] > 0).map(|i| census.units[i].length).collect();
    if lengths.iter().any(|l| (l - lengths[0]).abs() > SAME_UNIT * lengths[0]) {
        notes.push(ReaderNote::Unit(UnitNote::Mixed));
    }
    unit
}

fn as_skipped(f: &Fault) -> Skipped {
    unread(f.entity, f.reason.clone(), None)
}

/// Builds every face once and places its occurrences.
fn placed(records: &Records, census: &Census, options: &ReadOptions, skipped: &mut Vec<Skipped>) -> Vec<Face> {
    let mut jobs: Vec<(u64, bool, usize)> = census.occurrences.iter().map(key).collect();
    jobs.sort_unstable();
    jobs.dedup();
    let built: HashMap<(u64, bool, usize), Result<Vec<Face>, Lost>> = parallel::map(jobs, |job| {
        let (id, flipped, units) = job;
        let geometry = Geometry { records, units: &census.units[units] };
        let trimmed =
            |raw: &RawFace| trim::faces(raw, options.chord_tolerance).map_err(|e| Fault::new(id, e.to_string()));
        let faces = geometry.faces(id, flipped).and_then(|raw| {
            let all: Result<Vec<Vec<Face>>, Fault> = raw.iter().map(trimmed).collect();
            all.map(|f| f.into_iter().flatten().collect())
        });
        (job, faces.map_err(|fault| Lost { fault, area: geometry.spanned_area(id, 0) }))
    })
    .into_iter()
    .collect();
    let mut out = Vec::new();
    let mut named: HashMap<(u64, bool, usize), usize> = HashMap::new();
    for o in &census.occurrences {
        match built.get(&key(o)) {
            Some(Ok(faces)) => {
                let there = faces.iter().map(|f| {
                    let mut face = f.placed(&o.placement, &o.part);
                    face.body = o.body;
                    face
                });
                let before = out.len();
                out.extend(there.filter(is_finite));
                if out.len() < before + faces.len() {
                    let reason = "its placement is not finite".to_string();
                    skipped.push(unread(o.face, reason, None));
                }
            }
            Some(Err(lost)) => {
                // Named once, with the area of all its occurrences.
                let area = lost.area.map(|a| a * o.placement.scale().powi(2)).filter(|a| a.is_finite());
                let at = *named.entry(key(o)).or_insert_with(|| {
                    // The face is what the user looks for; the record at fault is named in the reason.
                    let reason = lost.fault.reason.clone();
                    skipped.push(unread(o.face, reason, area.map(|_| 0.0)));
                    skipped.len() - 1
                });
                skipped[at].area_estimate = skipped[at].area_estimate.zip(area).map(|(sum, a)| sum + a);
            }
            None => {}
        }
    }
    out
}

/// A face that could not be built.
struct Lost {
    fault: Fault,
    /// Its area, mm², as far as its edges tell.
    area: Option<f64>,
}

fn is_finite(f: &Face) -> bool {
    f.surface.control.iter().flatten().all(|x| x.is_finite())
        && f.loops.iter().flat_map(|l| &l.points).flatten().all(|x| x.is_finite())
}

fn key(o: &Occurrence) -> (u64, bool, usize) {
    (o.face, o.flipped, o.units)
}
