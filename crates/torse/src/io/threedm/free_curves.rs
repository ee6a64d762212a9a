//! Curves of an archive, in millimetres, for jobs that start from curves.

use super::blocks::{self, label, Want};
use super::bytes::Reading;
use super::classes::Class;
use super::error::ReadError;
use super::{archive, brep, curves};
use crate::answer::note::reader::ReaderNote;
use crate::geom::placement::Placement;
use crate::io::words::note::reader_note;
use crate::spline::curve::Curve;
use std::collections::{HashMap, HashSet};

/// Control points of all curves that blocks copy at most; a short file can ask for copies without end.
const MOST_COPIED: usize = 5_000_000;

/// A curve of a file with the name by which it can be selected.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedCurve {
    /// Name of the object, or its number in the file, counted from 1; with the number of the edge behind a point for edges
    /// (`3.12`). Further places of one object, which blocks make, are counted behind a slash (`3/2`).
    pub label: String,
    /// Its pieces in order, homogeneous, mm.
    pub curves: Vec<Curve<4>>,
}

/// The curves of an archive where its blocks put them, or, where it has none, the edges of its polysurfaces; with what was
/// not read, in words.
///
/// # Errors
/// Not an archive, or a damaged one; no curve that can be read.
pub fn curves(bytes: &[u8]) -> Result<(Vec<NamedCurve>, Vec<ReaderNote>), ReadError> {
    let archive = archive::archive(bytes)?;
    let scale = archive.unit.length;
    let mut found = Vec::new();
    let mut notes = archive.notes.clone();
    let mut copies: HashMap<String, usize> = HashMap::new();
    for want in [Want::Curves, Want::Faces] {
        let uses = blocks::uses(&archive, want);
        if want == Want::Curves {
            notes.extend(uses.notes);
            notes.extend(uses.skipped.into_iter().map(ReaderNote::LeftOut));
        }
        let (mut seen, mut held) = (HashSet::new(), 0);
        for o in &uses.occurrences {
            let Some(Ok(record)) = archive.objects.get(o.object) else { continue };
            let Ok(object) = record.object.clone() else { continue };
            let name = match record.attributes.name.as_str() {
                "" => (o.object + 1).to_string(),
                name => name.to_string(),
            };
            let mut keep = |name: String, pieces: Reading<Vec<Curve<4>>>| match pieces {
                Ok(pieces) => {
                    if !seen.insert((o.object, name.clone())) {
                        held += pieces.iter().map(|c| c.control.len()).sum::<usize>();
                    }
                    if held > MOST_COPIED {
                        return;
                    }
                    let n = copies.entry(name.clone()).and_modify(|n| *n += 1).or_insert(1);
                    let label = if *n > 1 { format!("{name}/{n}") } else { name };
                    found.push(NamedCurve { label, curves: placed(pieces, &o.placement) });
                }
                Err(f) => notes.push(ReaderNote::Object { name: label(o.object, record), reason: f.0 }),
            };
            match object.class {
                Class::Brep => match brep::read(object.data, scale) {
                    Ok(b) => {
                        for (k, path) in b.paths().enumerate() {
                            keep(format!("{name}.{}", k + 1), path.and_then(|p| curves::splines(&p)));
                        }
                    }
                    Err(f) => keep(name, Err(f)),
                },
                class if class.is_curve() => {
                    let pieces = curves::curve(object, scale).and_then(|c| curves::splines(&c.whole()));
                    keep(name, pieces);
                }
                _ => {}
            }
        }
        if held > MOST_COPIED {
            notes.push(ReaderNote::TooManyCopies);
        }
        if !found.is_empty() {
            return Ok((found, notes));
        }
    }
    let reason = notes.first().map_or_else(String::new, reader_note);
    Err(ReadError::Nothing { what: "curves", objects: archive.objects.len(), reason })
}

/// The pieces moved.
fn placed(pieces: Vec<Curve<4>>, place: &Placement) -> Vec<Curve<4>> {
    if *place == Placement::identity() {
        return pieces;
    }
    pieces.into_iter().map(|c| curves::placed(c, place)).collect()
}
