//! Wavefront OBJ: quadrilateral faces of a strip.

use super::error::QuadReadError;
use super::mesh::in_order;
use crate::geom::Vec3;

/// Both polylines in units of the file.
pub(super) fn rulings(text: &str) -> Result<[Vec<Vec3>; 2], QuadReadError> {
    let (mut points, mut faces): (Vec<Vec3>, Vec<[usize; 4]>) = (Vec::new(), Vec::new());
    for (k, line) in text.lines().enumerate() {
        let fault = |reason: String| QuadReadError::Line { line: k + 1, reason };
        let mut fields = line.split('#').next().unwrap_or("").split_whitespace();
        match fields.next() {
            Some("v") => {
                let x: Vec<f64> =
                    fields.take(3).filter_map(|f| f.parse().ok()).filter(|x: &f64| x.is_finite()).collect();
                let [x, y, z] = x[..] else { return Err(fault("a vertex needs three finite numbers".into())) };
                points.push(Vec3::new(x, y, z));
            }
            Some("f") => {
                let corners: Vec<&str> = fields.collect();
                let [a, b, c, d] = corners[..] else {
                    return Err(fault(format!("a face has {} corners; all must be quadrilaterals", corners.len())));
                };
                let mut face = [0; 4];
                for (slot, text) in face.iter_mut().zip([a, b, c, d]) {
                    let number = text.split('/').next().unwrap_or("");
                    *slot = index(number, points.len())
                        .ok_or_else(|| fault(format!("there is no vertex {number} before this line")))?;
                }
                if (0..4).any(|i| face[i + 1..].contains(&face[i])) {
                    return Err(fault("a face names a vertex twice".into()));
                }
                faces.push(face);
            }
            _ => {}
        }
    }
    in_order(&points, &faces)
}

/// Place of a vertex number, which counts from 1, or backwards from −1.
pub(in crate::io) fn index(number: &str, count: usize) -> Option<usize> {
    let n: i64 = number.parse().ok()?;
    let i = if n > 0 {
        usize::try_from(n).ok()? - 1
    } else {
        count.checked_sub(usize::try_from(n.checked_neg()?).ok()?)?
    };
    (n != 0 && i < count).then_some(i)
}
