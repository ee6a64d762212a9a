//! Wavefront OBJ: quadrilateral faces in the order of their strip.

use super::error::QuadReadError;
use crate::geom::Vec3;
use std::collections::HashMap;

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
    let place = |side: Vec<usize>| side.into_iter().map(|i| points[i]).collect();
    ordered(&faces).map(|sides| sides.map(place)).map_err(QuadReadError::NoStrip)
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

/// Vertices of both polylines of the strip that faces form, or why they form none.
fn ordered(faces: &[[usize; 4]]) -> Result<[Vec<usize>; 2], String> {
    if faces.is_empty() {
        return Err("there are no faces".into());
    }
    let edge = |f: &[usize; 4], k: usize| {
        let (p, q) = (f[k % 4], f[(k + 1) % 4]);
        (p.min(q), p.max(q))
    };
    let mut beside: HashMap<(usize, usize), Vec<usize>> = HashMap::new();
    for (i, f) in faces.iter().enumerate() {
        for k in 0..4 {
            beside.entry(edge(f, k)).or_default().push(i);
        }
    }
    let next = |i: usize, k: usize| beside[&edge(&faces[i], k)].iter().copied().find(|j| *j != i);
    let shared = |i: usize| (0..4).filter(|k| next(i, *k).is_some()).collect::<Vec<_>>();
    if let Some(e) = beside.values().find(|e| e.len() > 2) {
        return Err(format!("faces {:?} (counted from 0) have one edge in common", e));
    }
    let Some(start) = (0..faces.len()).find(|i| shared(*i).len() < 2) else {
        return Err("it is closed; leave out one quadrilateral to open it".into());
    };
    // The first ruling lies opposite the only shared edge.
    let leaving = shared(start).first().copied().unwrap_or(2);
    let f = &faces[start];
    let (mut a, mut b) = (vec![f[(leaving + 3) % 4]], vec![f[(leaving + 2) % 4]]);
    let (mut at, mut k, mut seen) = (start, leaving, 0);
    loop {
        // The edge k leads out; its ends continue the polylines in the sense in which the face goes round.
        let f = &faces[at];
        let (p, q) = (f[k], f[(k + 1) % 4]);
        let last = *a.last().unwrap_or(&p);
        let forward = (0..4).any(|m| edge(f, m) == (last.min(p), last.max(p)));
        let (p, q) = if forward { (p, q) } else { (q, p) };
        a.push(p);
        b.push(q);
        seen += 1;
        let Some(other) = next(at, k) else { break };
        if other == start || seen > faces.len() {
            return Err("it is closed; leave out one quadrilateral to open it".into());
        }
        let out = edge(f, k);
        let entered = (0..4).find(|m| edge(&faces[other], *m) == out).unwrap_or(0);
        let opposite = (entered + 2) % 4;
        if shared(other).iter().any(|m| *m != entered && *m != opposite) {
            return Err(format!("it turns or branches at face {other} (counted from 0)"));
        }
        (at, k) = (other, opposite);
    }
    if seen < faces.len() {
        return Err(format!("it has several pieces; {seen} of {} faces hang together", faces.len()));
    }
    Ok([a, b])
}
