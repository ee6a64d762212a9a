//! Corners of the triangles of STL files, binary and text; corners shared by triangles are kept once.

use super::{triple, CloudReadError};
use crate::geom::Vec3;
use std::collections::HashSet;

pub(super) fn points(bytes: &[u8]) -> Result<Vec<Vec3>, CloudReadError> {
    const HEAD: usize = 84;
    const TRIANGLE: usize = 50;
    let promised = bytes.get(80..84).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let binary =
        promised.is_some_and(|n| n.checked_mul(TRIANGLE).and_then(|m| m.checked_add(HEAD)) == Some(bytes.len()));
    let text = bytes.starts_with(b"solid") && !binary;
    let mut found = Vec::new();
    if text {
        for (i, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
            let Some(rest) = line.trim_start().strip_prefix("vertex") else { continue };
            found.push(triple(rest.split_whitespace()).ok_or_else(|| CloudReadError::Line {
                format: "STL",
                line: i + 1,
                reason: "a vertex needs three numbers".into(),
            })?);
        }
    } else {
        let Some(n) = promised else {
            return Err(CloudReadError::Format {
                format: "STL",
                reason: "the header of 84 bytes is not complete".into(),
            });
        };
        let body = &bytes[HEAD..];
        if body.len() / TRIANGLE < n {
            return Err(CloudReadError::Short {
                format: "STL",
                read: body.len() / TRIANGLE,
                promised: n,
                what: "triangles",
            });
        }
        for t in body.chunks_exact(TRIANGLE).take(n) {
            let at = |k: usize| f64::from(f32::from_le_bytes([t[k], t[k + 1], t[k + 2], t[k + 3]]));
            found.extend((0..3).map(|c| Vec3::new(at(12 + 12 * c), at(16 + 12 * c), at(20 + 12 * c))));
        }
    }
    let mut seen = HashSet::with_capacity(found.len());
    found.retain(|p| seen.insert([p.x.to_bits(), p.y.to_bits(), p.z.to_bits()]));
    Ok(found)
}
