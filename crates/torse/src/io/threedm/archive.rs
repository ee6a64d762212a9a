//! The tables of an archive.

use super::bytes::{Chunk, Cursor, Fault, Format, LONGEST_NAME};
use super::error::ReadError;
use super::records::{self, Definition, Layer, Record, Unit};
use crate::answer::note::reader::{ArchiveTable, ReaderNote, UnitNote};
use std::collections::HashMap;

/// What every archive begins with.
pub(super) const MAGIC: &[u8; 24] = b"3D Geometry File Format ";
/// Bytes of the header.
const HEADER: usize = 32;
/// The oldest version whose objects have classes throughout.
const OLDEST: u32 = 2;
/// Versions that are known.
const KNOWN: [u32; 8] = [2, 3, 4, 5, 50, 60, 70, 80];

/// Levels of layers at most; a deeper nesting is a circle.
const DEEPEST_LAYER: usize = 32;

const END_OF_FILE: u32 = 0x0000_7FFF;
const END_OF_TABLE: u32 = 0xFFFF_FFFF;
const PROPERTIES: u32 = 0x1000_0014;
const SETTINGS: u32 = 0x1000_0015;
const LAYERS: u32 = 0x1000_0011;
const BLOCKS: u32 = 0x1000_0021;
const OBJECTS: u32 = 0x1000_0013;
const WRITER: u32 = 0xA000_0026;
const UNITS: u32 = 0x2000_8031;
const LAYER: u32 = 0x2000_8050;
const BLOCK: u32 = 0x2000_8076;
const OBJECT: u32 = 0x2000_8070;

/// What matters of an archive.
#[derive(Clone, Debug, Default)]
pub(super) struct Archive<'a> {
    pub unit: Unit,
    pub layers: Vec<Layer>,
    pub blocks: Vec<Definition>,
    /// Objects in the order of their table; what is wrong with those that cannot be framed.
    pub objects: Vec<Result<Record<'a>, String>>,
    /// Remarks on the file as a whole.
    pub notes: Vec<ReaderNote>,
}

/// Reads the tables of an archive.
pub(super) fn archive(bytes: &[u8]) -> Result<Archive<'_>, ReadError> {
    let mut format = Format { version: version(bytes)?, writer: 0 };
    let mut c = Cursor::new(bytes.get(HEADER..).unwrap_or_default(), format);
    let mut out = Archive::default();
    let (mut unit, mut ended, mut objects) = (None, false, false);
    while c.left() > 0 {
        c.format = format;
        let at = bytes.len() - c.left();
        let damaged = |words: String| ReadError::Damaged { at, reason: words };
        let Chunk { code, mut body, .. } = c.chunk().map_err(|f| damaged(f.0))?;
        match code {
            END_OF_FILE => {
                ended = true;
                break;
            }
            PROPERTIES | SETTINGS | LAYERS | BLOCKS | OBJECTS => {
                objects |= code == OBJECTS;
                while body.left() > 0 {
                    let chunk = body.chunk().map_err(|f| damaged(f.0))?;
                    match chunk.code {
                        END_OF_TABLE => break,
                        WRITER => format.writer = chunk.value as u32,
                        UNITS => unit = Some(records::unit(chunk.body).map_err(|f| damaged(f.0))?),
                        kind => out.keep(code, kind, chunk.body),
                    }
                }
            }
            _ => {}
        }
    }
    if !ended {
        // What is lost may be objects.
        let reason = if objects { "its end mark is missing" } else { "it ends before its table of objects" };
        return Err(ReadError::Damaged { at: bytes.len(), reason: reason.into() });
    }
    match unit {
        Some(u) => out.unit = u,
        None => out.notes.push(ReaderNote::Unit(UnitNote::NoSettings)),
    }
    Ok(out)
}

impl<'a> Archive<'a> {
    /// Notes the entry of a table after `before` others.
    fn unreadable(&mut self, table: ArchiveTable, before: usize, fault: Fault) {
        self.notes.push(ReaderNote::Entry { table, number: before + 1, reason: fault.0 });
    }

    /// Keeps a record of a table.
    fn keep(&mut self, table: u32, code: u32, body: Cursor<'a>) {
        match code {
            LAYER => match records::layer(body) {
                Ok(l) => self.layers.push(l),
                Err(f) => self.unreadable(ArchiveTable::Layer, self.layers.len(), f),
            },
            BLOCK => match records::definition(body) {
                Ok(d) => self.blocks.push(d),
                Err(f) => self.unreadable(ArchiveTable::Block, self.blocks.len(), f),
            },
            OBJECT => self.objects.push(records::record(body).map_err(|f| f.0)),
            _ if table == OBJECTS => self.objects.push(Err(format!("records of kind {code:#010x} are not read"))),
            _ => {}
        }
    }

    /// Full names of the layers with whether they are shown, by index.
    pub fn named_layers(&self) -> HashMap<i32, (String, bool)> {
        let by_id: HashMap<_, _> = self.layers.iter().filter(|l| !l.id.is_nil()).map(|l| (l.id, l)).collect();
        let full = |l: &Layer| {
            let (mut name, mut shown, mut above) = (l.name.clone(), !l.hidden, l.parent);
            for _ in 0..DEEPEST_LAYER {
                let Some(parent) = by_id.get(&above) else { break };
                name = format!("{}::{name}", parent.name);
                shown &= !parent.hidden;
                above = parent.parent;
            }
            let name = name.chars().take(LONGEST_NAME).collect();
            (l.index, (name, shown))
        };
        self.layers.iter().map(full).collect()
    }
}

/// The version that the header states.
fn version(bytes: &[u8]) -> Result<u32, ReadError> {
    if bytes.iter().all(|&b| b == 0 || b.is_ascii_whitespace()) {
        return Err(ReadError::Empty);
    }
    let Some(head) = bytes.get(..HEADER).filter(|h| h.starts_with(MAGIC)) else {
        return Err(ReadError::NotThreeDm(guess(bytes)));
    };
    let text = String::from_utf8_lossy(&head[MAGIC.len()..]);
    match text.trim().parse::<u32>() {
        Ok(v) if v < OLDEST => Err(ReadError::TooOld(v)),
        Ok(v) if KNOWN.contains(&v) => Ok(v),
        Ok(v) => Err(ReadError::TooNew(v)),
        Err(_) => Err(ReadError::NotThreeDm(format!("its version '{}' is no number", text.trim()))),
    }
}

/// What a file without the header is.
fn guess(bytes: &[u8]) -> String {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(128)]);
    let start = start.trim_start_matches(|c: char| c.is_control() || c.is_whitespace() || c == '\u{feff}');
    let what = if start.starts_with("3D Geometry File") {
        "it is cut off within its header"
    } else if start.starts_with("ISO-10303-21") {
        "it is a STEP file"
    } else if start.starts_with("PK") {
        "it is a ZIP archive (unpack it first)"
    } else if start.starts_with("solid") {
        "it looks like an STL mesh"
    } else if start.starts_with("%PDF") {
        "it is a PDF"
    } else if start.starts_with('<') {
        "it is XML or HTML"
    } else if start.len() >= 73 && start.as_bytes().get(72) == Some(&b'S') {
        "it looks like an IGES file"
    } else {
        "it does not begin with '3D Geometry File Format'"
    };
    what.into()
}
