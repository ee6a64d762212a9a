//! Meshes of an archive: points and faces of three or four corners, in millimetres.

use super::archive;
use super::blocks::{self, label, Want};
use super::bytes::{checksum, fault, Cursor, Fault, Reading};
use super::error::ReadError;
use crate::answer::note::reader::ReaderNote;
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use crate::io::words::note::reader_note;
use std::collections::HashSet;

/// Coordinates above this many mm (a million kilometres) are damage.
const FARTHEST: f64 = 1e12;
/// A packed list may be so many times longer than its packing: more is no list of places, and would only fill memory …
const MOST_EXPANSION: usize = 100;
/// … but so many bytes are always allowed.
const ALWAYS_ALLOWED: usize = 1 << 16;
/// Corners and triangles of all meshes that blocks copy at most; a short file can ask for copies without end.
const MOST_COPIED: usize = 5_000_000;

/// What an archive holds of meshes: all that are shown, where its blocks put them, as one.
#[derive(Clone, Debug, Default)]
pub struct Meshes {
    /// Corners, mm: those of single precision that every mesh has.
    pub points: Vec<Vec3>,
    /// Faces of four corners each, of which triangles repeat the last.
    pub faces: Vec<[u32; 4]>,
    /// Whether the archive names no length unit, so that millimetres are assumed.
    pub assumes_unit: bool,
    /// What was not read.
    pub notes: Vec<ReaderNote>,
}

impl Meshes {
    /// Points and triangles: quadrilaterals are cut into two about their first corner.
    pub(crate) fn into_cloud(self) -> Cloud {
        let halves = |q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]];
        let triangles = |q: &[u32; 4]| halves(q).into_iter().take(if q[2] == q[3] { 1 } else { 2 });
        Cloud { triangles: self.faces.iter().flat_map(triangles).collect(), points: self.points }
    }
}

/// Reads all meshes of an archive that are shown.
///
/// # Errors
/// Not an archive, or a damaged one; no mesh that can be read.
pub fn read(bytes: &[u8]) -> Result<Meshes, ReadError> {
    let archive = archive::archive(bytes)?;
    let uses = blocks::uses(&archive, Want::Meshes);
    let mut notes = archive.notes.clone();
    notes.extend(uses.notes);
    notes.extend(uses.skipped.into_iter().map(ReaderNote::LeftOut));
    let mut out = Meshes::default();
    let (mut seen, mut copied) = (HashSet::new(), 0);
    for o in &uses.occurrences {
        let Some(Ok(record)) = archive.objects.get(o.object) else { continue };
        let Ok(object) = record.object.clone() else { continue };
        let read = mesh(object.data, archive.unit.length).and_then(|m| {
            if !seen.insert(o.object) {
                copied += m.points.len() + m.faces.len();
            }
            if copied > MOST_COPIED || out.points.len() + m.points.len() > u32::MAX as usize {
                return fault("the blocks of the file copy too many meshes");
            }
            let first = out.points.len() as u32;
            out.points.extend(m.points.iter().map(|p| o.placement.point(p)));
            out.faces.extend(m.faces.iter().map(|f| f.map(|c| c + first)));
            Ok(())
        });
        if let Err(f) = read {
            notes.push(ReaderNote::Object { name: label(o.object, record), reason: f.0 });
        }
    }
    let within = |p: &Vec3| p.iter().all(|x| x.abs() <= FARTHEST);
    if !out.points.iter().all(within) {
        notes.insert(0, ReaderNote::EndlessMeshes);
        out = Meshes::default();
    }
    if out.points.is_empty() {
        let reason = notes.first().map_or_else(String::new, reader_note);
        return Err(ReadError::Nothing { what: "meshes", objects: archive.objects.len(), reason });
    }
    Ok(Meshes { assumes_unit: archive.unit.name.is_empty(), notes, ..out })
}

fn mesh(mut c: Cursor, scale: f64) -> Reading<Meshes> {
    let (major, minor) = c.version()?;
    if major != 1 && major != 3 {
        return fault(format!("a mesh has the unknown version {major}.{minor}"));
    }
    let (corners, faces) = (c.i32()?, c.i32()?);
    let (Ok(corners), Ok(faces)) = (usize::try_from(corners), usize::try_from(faces)) else {
        return fault(format!("a mesh claims {corners} corners and {faces} faces"));
    };
    // Intervals of parameters, scales, boxes in single precision, whether it is closed.
    c.skip(64 + 16 + 64 + 4)?;
    // How it was made, and four statistics of curvature.
    for _ in 0..5 {
        if c.bool()? {
            c.chunk()?;
        }
    }
    let faces = quadruples(&mut c, faces, corners)?;
    let length = corners.checked_mul(12).ok_or_else(|| Fault("a mesh claims too many corners".into()))?;
    let bytes = match major {
        1 => {
            let n = c.count(12)?;
            c.take(12 * n)?.to_vec()
        }
        _ => packed(&mut c, length)?,
    };
    if bytes.len() != length {
        return fault(format!("a mesh of {corners} corners has places for {}", bytes.len() / 12));
    }
    let at = |b: &[u8], k: usize| f64::from(f32::from_le_bytes([b[k], b[k + 1], b[k + 2], b[k + 3]])) * scale;
    let points: Vec<Vec3> = bytes.chunks_exact(12).map(|b| Vec3::new(at(b, 0), at(b, 4), at(b, 8))).collect();
    if points.iter().any(|p| !p.iter().all(|x| x.is_finite())) {
        return fault("a corner of a mesh is not finite");
    }
    Ok(Meshes { points, faces, ..Meshes::default() })
}

/// Faces of four corners each, of which triangles repeat the last.
fn quadruples(c: &mut Cursor, faces: usize, corners: usize) -> Reading<Vec<[u32; 4]>> {
    let width = match c.i32()? {
        w @ (1 | 2 | 4) => w as usize,
        w => return fault(format!("the corners of a mesh have numbers of {w} bytes")),
    };
    let bytes = c.take(faces.saturating_mul(4 * width))?;
    let mut out = Vec::with_capacity(faces);
    for face in bytes.chunks_exact(4 * width) {
        let number = |b: &[u8]| b.iter().rev().fold(0_u32, |n, &x| n << 8 | u32::from(x));
        let mut q = [0; 4];
        for (k, b) in q.iter_mut().zip(face.chunks_exact(width)) {
            *k = number(b);
            if *k as usize >= corners {
                return fault(format!("a mesh of {corners} corners has a face with the corner {k}"));
            }
        }
        out.push(q);
    }
    Ok(out)
}

/// A list that may be packed.
fn packed(c: &mut Cursor, expected: usize) -> Reading<Vec<u8>> {
    let length = c.u32()? as usize;
    if length != expected {
        return fault(format!("a packed list has {length} bytes where {expected} are needed"));
    }
    if length == 0 {
        return Ok(Vec::new());
    }
    let (sum, method) = (c.u32()?, c.u8()?);
    let bytes = match method {
        0 => c.take(length)?.to_vec(),
        1 => {
            let body = c.anonymous()?.rest();
            if length > body.len().saturating_mul(MOST_EXPANSION).max(ALWAYS_ALLOWED) {
                return fault(format!("{} bytes claim to unpack to {length}", body.len()));
            }
            miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(body, length)
                .map_err(|e| Fault(format!("a packed list cannot be unpacked: {e}")))?
        }
        other => return fault(format!("a list is packed by the unknown method {other}")),
    };
    if bytes.len() != length || checksum(&bytes) != sum {
        return fault("the checksum of a packed list is wrong: the file is damaged there");
    }
    Ok(bytes)
}
