//! Quadrilateral faces of a mesh in the order of the strip that they form.

use super::error::QuadReadError;
use crate::geom::Vec3;
use crate::io::threedm::meshes::Meshes;
use std::collections::HashMap;

/// Both polylines of the strip that the meshes of an archive form. Corners in one place are one: neighbours in such meshes often have
/// each their own.
pub(super) fn rulings(meshes: &Meshes) -> Result<[Vec<Vec3>; 2], QuadReadError> {
    let mut first: HashMap<[u64; 3], usize> = HashMap::new();
    // Zeros of both signs are one place.
    let key = |p: &Vec3| [p.x, p.y, p.z].map(|c| (c + 0.0).to_bits());
    let corners: Vec<usize> =
        meshes.points.iter().enumerate().map(|(k, p)| *first.entry(key(p)).or_insert(k)).collect();
    let mut faces = Vec::with_capacity(meshes.faces.len());
    for (k, face) in meshes.faces.iter().enumerate() {
        let face = face.map(|c| corners[c as usize]);
        if (0..4).any(|i| face[i + 1..].contains(&face[i])) {
            let reason = format!("face {k} (counted from 0) is a triangle; all must be quadrilaterals");
            return Err(QuadReadError::NoStrip(reason));
        }
        faces.push(face);
    }
    in_order(&meshes.points, &faces)
}

/// Both polylines of the strip that faces form.
pub(super) fn in_order(points: &[Vec3], faces: &[[usize; 4]]) -> Result<[Vec<Vec3>; 2], QuadReadError> {
    let place = |side: Vec<usize>| side.into_iter().map(|i| points[i]).collect();
    ordered(faces).map(|sides| sides.map(place)).map_err(QuadReadError::NoStrip)
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
