//! Vertices of Wavefront OBJ files; everything else is passed over.

use super::{triple, CloudReadError};
use crate::geom::Vec3;

pub(super) fn points(bytes: &[u8]) -> Result<Vec<Vec3>, CloudReadError> {
    let text = String::from_utf8_lossy(bytes);
    let mut out = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let Some(rest) = line.trim_start().strip_prefix("v ") else { continue };
        let p = triple(rest.split_whitespace()).ok_or_else(|| CloudReadError::Line {
            format: "OBJ",
            line: i + 1,
            reason: "a vertex needs three numbers".into(),
        })?;
        out.push(p);
    }
    Ok(out)
}
