//! Vertices and faces of Wavefront OBJ files; everything else is passed over. Faces of more than three corners are cut
//! into triangles about their first.

use super::error::CloudReadError;
use super::triple::triple;
use crate::geom::cloud::Cloud;
use crate::io::quads::obj::index;

pub(super) fn cloud(bytes: &[u8]) -> Result<Cloud, CloudReadError> {
    let text = String::from_utf8_lossy(bytes);
    let mut out = Cloud::default();
    for (i, line) in text.lines().enumerate() {
        let fault = |reason: String| CloudReadError::Line { format: "OBJ", line: i + 1, reason };
        let mut words = line.split('#').next().unwrap_or("").split_whitespace();
        match words.next() {
            Some("v") => out.points.push(triple(words).ok_or_else(|| fault("a vertex needs three numbers".into()))?),
            Some("f") => {
                let corner = |word: &str| {
                    let number = word.split('/').next().unwrap_or("");
                    let at = index(number, out.points.len());
                    at.map(|k| k as u32).ok_or_else(|| fault(format!("there is no vertex {number} before this line")))
                };
                let corners = words.map(corner).collect::<Result<Vec<u32>, _>>()?;
                if corners.len() < 3 {
                    return Err(fault(format!("a face has {} corners; it needs three", corners.len())));
                }
                out.triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
            }
            _ => {}
        }
    }
    Ok(out)
}
