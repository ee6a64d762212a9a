//! Meshes of panels and faces for pictures and mesh files: the triangles of the partition, carried to the panels by
//! the foot map. Nothing is proven here.

use crate::num::hash::HashMap;
use std::collections::VecDeque;

use super::diagnostics::curvature;
use crate::geom::mesh::Mesh;
use crate::geom::Vec3;
use crate::patchwork::clip::ClippedRulings;
use crate::patchwork::panel::{Panel, PanelForm, Patchwork};
use crate::torse::form::PanelKind;

/// Mesh of one panel: its partition's triangles with every vertex moved to its foot on the torse.
///
/// `values`: signed distance (mm) of the panel from the face, positive where the panel lies on the outer side.
/// Normals point to the outer side. An empty mesh if the panel does not exist.
pub fn panel_mesh(patchwork: &Patchwork, panel: usize) -> Mesh {
    let Some(p) = patchwork.panels.get(panel) else { return Mesh::default() };
    let on = (&p.trim, patchwork.face_of(p), patchwork.partition_of(p));
    let (Some(trim), Some(face), Some(partition)) = on else { return Mesh::default() };
    // 1. Vertices used, neighbours, and feet known from the trimming curves.
    let mut index: HashMap<u32, u32> = HashMap::default();
    let mut old: Vec<u32> = Vec::new();
    let mut triangles = Vec::new();
    for (t, &l) in partition.triangles.iter().zip(&partition.labels) {
        if l == trim.label {
            triangles.push(t.map(|v| {
                *index.entry(v).or_insert_with(|| {
                    old.push(v);
                    old.len() as u32 - 1
                })
            }));
        }
    }
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); old.len()];
    for t in &triangles {
        for k in 0..3 {
            around[t[k] as usize].push(t[(k + 1) % 3]);
            around[t[k] as usize].push(t[(k + 2) % 3]);
        }
    }
    let mut foot: Vec<Option<[f64; 2]>> = vec![None; old.len()];
    let mut queue = VecDeque::new();
    for run in trim.loops.iter().flatten() {
        for (v, s) in run.vertices.iter().zip(&run.parameters) {
            if let Some(&i) = index.get(v) {
                if foot[i as usize].is_none() {
                    foot[i as usize] = Some(run.trim.point(*s));
                    queue.push_back(i);
                }
            }
        }
    }
    // A border that knows no vertices leaves the first one to be looked for.
    if let (PanelForm::Ruled(map), None, Some(v)) = (&trim.form, queue.front(), old.first()) {
        let ((s0, s1), (t0, t1)) = (map.knots_s.domain(), map.knots_t.domain());
        let middle = [0.5 * (s0 + s1), 0.5 * (t0 + t1)];
        foot[0] = Some(map.nearest(partition.vertices[*v as usize], middle).0);
        queue.push_back(0);
    }
    // 2. Feet, from the border inwards, each from a neighbour's.
    let jets: Vec<_> =
        old.iter().map(|&v| partition.vertices[v as usize]).map(|q| face.surface.jet(q[0], q[1])).collect();
    while let Some(i) = queue.pop_front() {
        let guess = foot[i as usize].unwrap_or_default();
        for &n in &around[i as usize] {
            if foot[n as usize].is_none() {
                let found = match &trim.form {
                    PanelForm::Torse(torse) => torse.foot(&jets[n as usize].p, guess[0]).map(|t| [t, guess[1]]),
                    PanelForm::Ruled(map) => map.inverse(partition.vertices[old[n as usize] as usize], guess),
                };
                foot[n as usize] = Some(found.unwrap_or(guess));
                queue.push_back(n);
            }
        }
    }
    // 3. Points, normals and deviations.
    let mut mesh = Mesh { triangles, ..Mesh::default() };
    for (i, j) in jets.iter().enumerate() {
        let outward = if face.reversed { -j.normal() } else { j.normal() };
        let (place, normal) = match &trim.form {
            PanelForm::Torse(torse) => {
                let ruling = torse.ruling(foot[i].map_or(torse.domain().0, |f| f[0]));
                let x = j.p - ruling.point;
                (ruling.point + ruling.direction * ruling.direction.dot(&x), ruling.normal)
            }
            PanelForm::Ruled(_) => {
                let [s, t] = foot[i].unwrap_or_default();
                let on = p.strip.patch.jet(s, t);
                (on.p, on.normal().try_normalize(0.0).unwrap_or(outward))
            }
        };
        let normal = if normal.dot(&outward) < 0.0 { -normal } else { normal };
        mesh.values.push((place - j.p).dot(&normal));
        mesh.positions.push(place);
        mesh.normals.push(normal);
    }
    mesh
}

/// Mesh of one face: the partition's triangles on the input surface; normals point outwards, no values.
pub fn surface_mesh(patchwork: &Patchwork, face: usize) -> Mesh {
    let (Some(f), Some(partition)) = (patchwork.faces.get(face), patchwork.partitions.get(face)) else {
        return Mesh::default();
    };
    let mut mesh = Mesh { triangles: partition.triangles.clone(), ..Mesh::default() };
    for q in &partition.vertices {
        let j = f.surface.jet(q[0], q[1]);
        let n = if f.reversed { -j.normal() } else { j.normal() };
        mesh.positions.push(j.p);
        mesh.normals.push(n.try_normalize(0.0).unwrap_or_else(Vec3::zeros));
    }
    mesh
}

/// Gauss curvature (1/mm²) of one face at the vertices of its [`surface_mesh`].
pub(crate) fn surface_curvature(patchwork: &Patchwork, face: usize) -> Vec<f64> {
    let (Some(f), Some(partition)) = (patchwork.faces.get(face), patchwork.partitions.get(face)) else {
        return Vec::new();
    };
    partition.vertices.iter().map(|q| curvature(&f.surface.jet(q[0], q[1]))).collect()
}

/// Rulings of a panel in space, clipped to its borders, about `spacing` (mm) apart; none for planes.
pub fn ruling_lines(panel: &Panel, spacing: f64) -> Vec<[Vec3; 2]> {
    if panel.strip.kind == PanelKind::Plane {
        return Vec::new();
    }
    let clipped = ClippedRulings::new(panel);
    let point = |t: f64, r: f64| panel.strip.patch.point(t, r);
    clipped
        .spaced(spacing)
        .into_iter()
        .flat_map(|t| clipped.at(t).into_iter().map(move |(a, b)| [point(t, a), point(t, b)]))
        .collect()
}

/// Borders of a panel in space as closed polylines, `per_span` points per span of the edge curves.
pub fn border_lines(panel: &Panel, per_span: usize) -> Vec<Vec<Vec3>> {
    let mut out = Vec::new();
    for l in panel.loops() {
        let mut line = Vec::new();
        for run in l {
            for w in run.edge.knots.breaks().windows(2) {
                for k in 0..per_span {
                    line.push(Vec3::from(run.edge.point(w[0] + (w[1] - w[0]) * k as f64 / per_span as f64)));
                }
            }
        }
        line.extend(line.first().copied());
        out.push(line);
    }
    out
}
