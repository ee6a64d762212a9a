//! PLY files: vertices are read (text, binary of both byte orders), points with a value are written.

use super::error::CloudReadError;
use super::triple::triple;
use crate::geom::Vec3;

const FORMAT: &str = "PLY";

/// Size in bytes of a scalar type, and whether it is floating.
fn scalar(name: &str) -> Option<(usize, bool)> {
    Some(match name {
        "char" | "int8" | "uchar" | "uint8" => (1, false),
        "short" | "int16" | "ushort" | "uint16" => (2, false),
        "int" | "int32" | "uint" | "uint32" => (4, false),
        "float" | "float32" => (4, true),
        "double" | "float64" => (8, true),
        _ => return None,
    })
}

#[derive(Clone, Copy, PartialEq)]
enum Coding {
    Text,
    Little,
    Big,
}

struct Element {
    name: String,
    count: usize,
    /// Name, size and whether floating; `None` for lists.
    properties: Vec<(String, Option<(usize, bool)>)>,
}

fn wrong(reason: impl Into<String>) -> CloudReadError {
    CloudReadError::Format { format: FORMAT, reason: reason.into() }
}

pub(super) fn points(bytes: &[u8]) -> Result<Vec<Vec3>, CloudReadError> {
    let (coding, elements, start) = header(bytes)?;
    let mut rest = &bytes[start..];
    let mut text = if coding == Coding::Text { String::from_utf8_lossy(rest).into_owned() } else { String::new() };
    for (k, e) in elements.iter().enumerate() {
        if e.name == "vertex" {
            let later = elements[k + 1..].iter().map(|e| e.count).fold(0, usize::saturating_add);
            let place = |axis: &str| e.properties.iter().position(|p| p.0 == axis);
            let (Some(x), Some(y), Some(z)) = (place("x"), place("y"), place("z")) else {
                return Err(wrong("its vertices have no x, y and z"));
            };
            return match coding {
                Coding::Text => text_vertices(&text, e, [x, y, z], later),
                _ => binary_vertices(rest, e, [x, y, z], coding == Coding::Big, later),
            };
        }
        // Elements before the vertices are passed over.
        if coding == Coding::Text {
            let skip: usize = text.split_inclusive('\n').take(e.count).map(str::len).sum();
            text.drain(..skip);
        } else {
            let row: Option<usize> = e.properties.iter().map(|p| p.1.map(|s| s.0)).sum();
            let Some(row) = row else { return Err(wrong("lists before the vertices are not supported")) };
            rest = rest.get(row.saturating_mul(e.count)..).ok_or_else(|| wrong("the data are cut off"))?;
        }
    }
    Err(wrong("it has no vertices"))
}

fn header(bytes: &[u8]) -> Result<(Coding, Vec<Element>, usize), CloudReadError> {
    // A header longer than this is not one.
    const LONGEST: usize = 1 << 16;
    if !bytes.starts_with(b"ply") {
        return Err(wrong("it does not begin with 'ply'"));
    }
    let mut coding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut at = 0;
    while at < bytes.len().min(LONGEST) {
        let end = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |k| at + k + 1);
        let line = String::from_utf8_lossy(&bytes[at..end]);
        at = end;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["format", kind, ..] => {
                coding = Some(match *kind {
                    "ascii" => Coding::Text,
                    "binary_little_endian" => Coding::Little,
                    "binary_big_endian" => Coding::Big,
                    other => return Err(wrong(format!("unknown format '{other}'"))),
                });
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| wrong(format!("'{count}' is not a number of elements")))?;
                elements.push(Element { name: (*name).to_string(), count, properties: Vec::new() });
            }
            ["property", "list", .., name] => {
                if let Some(e) = elements.last_mut() {
                    e.properties.push(((*name).to_string(), None));
                }
            }
            ["property", kind, name] => {
                let size = scalar(kind).ok_or_else(|| wrong(format!("unknown type '{kind}'")))?;
                if let Some(e) = elements.last_mut() {
                    e.properties.push(((*name).to_string(), Some(size)));
                }
            }
            ["end_header"] => {
                return coding.map(|c| (c, elements, at)).ok_or_else(|| wrong("the header has no format"));
            }
            [] | ["ply" | "comment" | "obj_info", ..] => {}
            _ => return Err(wrong(format!("the header has the line '{}'", line.trim()))),
        }
    }
    Err(wrong("the header has no end"))
}

/// Vertices of a text file; `later` lines of other elements follow.
fn text_vertices(text: &str, e: &Element, axes: [usize; 3], later: usize) -> Result<Vec<Vec3>, CloudReadError> {
    if e.properties.iter().any(|p| p.1.is_none()) {
        return Err(wrong("vertices with lists are not supported"));
    }
    let mut out = Vec::new();
    let mut lines = text.lines().filter(|l| !l.trim().is_empty());
    for (i, line) in lines.by_ref().take(e.count).enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let fault = |reason: String| CloudReadError::Line { format: FORMAT, line: i + 1, reason };
        if words.len() != e.properties.len() {
            let reason = format!("vertex {i} has {} numbers, {} are promised", words.len(), e.properties.len());
            return Err(fault(reason));
        }
        let p = triple(axes.iter().map(|&k| words[k]));
        out.push(p.ok_or_else(|| fault(format!("vertex {i} has no three numbers x, y, z")))?);
    }
    if out.len() < e.count {
        return Err(CloudReadError::Short { format: FORMAT, read: out.len(), promised: e.count, what: "vertices" });
    }
    match lines.count() {
        n if n > later => Err(wrong(format!("{} lines more than its header promises", n - later))),
        _ => Ok(out),
    }
}

/// Vertices of a binary file; `later` things of other elements follow.
fn binary_vertices(
    bytes: &[u8],
    e: &Element,
    axes: [usize; 3],
    big: bool,
    later: usize,
) -> Result<Vec<Vec3>, CloudReadError> {
    let mut offsets = Vec::new();
    let mut row = 0;
    for (_, size) in &e.properties {
        let Some((size, floating)) = size else { return Err(wrong("vertices with lists are not supported")) };
        offsets.push((row, *size, *floating));
        row += size;
    }
    let read = bytes.len().checked_div(row).unwrap_or(0);
    if read < e.count {
        return Err(CloudReadError::Short { format: FORMAT, read, promised: e.count, what: "vertices" });
    }
    if later == 0 && bytes.len() != row * e.count {
        return Err(wrong(format!("{} bytes more than its header promises", bytes.len() - row * e.count)));
    }
    if e.count == 0 {
        return Ok(Vec::new());
    }
    for &a in &axes {
        if !offsets[a].2 {
            return Err(wrong("coordinates that are integers are not supported"));
        }
    }
    let value = |r: &[u8], axis: usize| -> f64 {
        let (at, size, _) = offsets[axis];
        let mut b = [0u8; 8];
        b[..size].copy_from_slice(&r[at..at + size]);
        if big {
            b[..size].reverse();
        }
        if size == 4 {
            f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        } else {
            f64::from_le_bytes(b)
        }
    };
    Ok(bytes
        .chunks_exact(row)
        .take(e.count)
        .map(|r| Vec3::new(value(r, axes[0]), value(r, axes[1]), value(r, axes[2])))
        .collect())
}

/// A binary PLY of points (mm) with one value each, under the property `name`.
pub fn with_values(points: &[Vec3], values: &[f64], name: &str) -> Vec<u8> {
    let n = points.len().min(values.len());
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {n}\nproperty float x\nproperty float y\n\
         property float z\nproperty float {name}\nend_header\n"
    )
    .into_bytes();
    for (p, v) in points.iter().zip(values) {
        for x in [p.x, p.y, p.z, *v] {
            out.extend_from_slice(&(x as f32).to_le_bytes());
        }
    }
    out
}
