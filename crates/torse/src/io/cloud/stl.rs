//! Triangles of STL files, binary and text; corners shared by triangles are kept once.

use super::error::CloudReadError;
use super::triple::triple;
use crate::geom::cloud::Cloud;
use crate::geom::Vec3;
use std::collections::HashMap;

const FORMAT: &str = "STL";
/// Bytes of a header with the number of triangles.
const HEAD: usize = 84;
/// Bytes of a triangle.
const TRIANGLE: usize = 50;

pub(super) fn cloud(bytes: &[u8]) -> Result<Cloud, CloudReadError> {
    let promised = bytes.get(80..HEAD).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let length = promised.and_then(|n| n.checked_mul(TRIANGLE)?.checked_add(HEAD));
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    let corners = if start.trim_start().starts_with("solid") && length != Some(bytes.len()) && !bytes.contains(&0) {
        text(bytes)?
    } else {
        binary(bytes, promised)?
    };
    Ok(joined(&corners))
}

/// Corners of the triangles of a text file, in threes.
fn text(bytes: &[u8]) -> Result<Vec<Vec3>, CloudReadError> {
    let mut found = Vec::new();
    let (mut facets, mut last) = (0, String::new());
    for (i, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
        let fault = |reason: String| CloudReadError::Line { format: FORMAT, line: i + 1, reason };
        let mut words = line.split_whitespace();
        let Some(first) = words.next() else { continue };
        last = first.to_ascii_lowercase();
        match last.as_str() {
            "facet" if facets == 0 && !found.is_empty() => {
                return Err(fault(format!("{} corners stand before the first facet", found.len())));
            }
            "facet" if found.len() != 3 * facets => {
                return Err(fault(format!(
                    "the facet before has {} corners, not three",
                    found.len() - 3 * (facets - 1)
                )));
            }
            "facet" => facets += 1,
            "vertex" => found.push(triple(words).ok_or_else(|| fault("a vertex needs three numbers".into()))?),
            _ => {}
        }
    }
    if found.len() != 3 * facets || last != "endsolid" {
        let reason = format!("it was cut off: after {facets} facets the last line is no 'endsolid'");
        return Err(CloudReadError::Format { format: FORMAT, reason });
    }
    Ok(found)
}

/// Corners of the triangles of a binary file, in threes.
fn binary(bytes: &[u8], promised: Option<usize>) -> Result<Vec<Vec3>, CloudReadError> {
    let wrong = |reason: String| CloudReadError::Format { format: FORMAT, reason };
    let Some(n) = promised else { return Err(wrong("the header of 84 bytes is not complete".into())) };
    let body = &bytes[HEAD..];
    let read = body.len() / TRIANGLE;
    if read < n {
        return Err(CloudReadError::Short { format: FORMAT, read, promised: n, what: "triangles" });
    }
    if body.len() != n * TRIANGLE {
        return Err(wrong(format!("it promises {n} triangles, but {} bytes follow them", body.len() - n * TRIANGLE)));
    }
    let mut out = Vec::with_capacity(3 * n);
    for t in body.chunks_exact(TRIANGLE) {
        let at = |k: usize| f64::from(f32::from_le_bytes([t[k], t[k + 1], t[k + 2], t[k + 3]]));
        out.extend((0..3).map(|c| Vec3::new(at(12 + 12 * c), at(16 + 12 * c), at(20 + 12 * c))));
    }
    Ok(out)
}

/// Triangles by their corners, each corner once.
fn joined(corners: &[Vec3]) -> Cloud {
    let mut places: HashMap<[u64; 3], u32> = HashMap::with_capacity(corners.len() / 2);
    let mut points = Vec::new();
    let mut number = |p: &Vec3| {
        // Nought has two signs; both are one place.
        let p = p.map(|x| x + 0.0);
        *places.entry([p.x.to_bits(), p.y.to_bits(), p.z.to_bits()]).or_insert_with(|| {
            points.push(p);
            points.len() as u32 - 1
        })
    };
    let triangles = corners.chunks_exact(3).map(|t| [number(&t[0]), number(&t[1]), number(&t[2])]).collect();
    Cloud { points, triangles }
}
