//! Reflection lines in meshes, and fine meshes of strips to see them in.

use std::f64::consts::TAU;
use torse::draw::reflection::stripe;
use torse::draw::scene::{PanelShape, Scene};
use torse::geom::mesh::Mesh;
use torse::geom::Vec3;
use torse::tessellate::strip;
use torse::torse::strip::Strip;

/// Triangles are cut until their normals differ by less than this (rad): a tenth of a stripe.
const TURN: f64 = 0.012;
/// Cuts of a triangle's side at most.
const CUTS: u32 = 48;

/// A strip over a grid of so many cells along and across.
pub fn ruled_mesh(s: &Strip, along: u32, across: u32) -> Mesh {
    let (a, b) = s.domain();
    let u: Vec<f64> = (0..=along).map(|i| a + (b - a) * f64::from(i) / f64::from(along)).collect();
    let v: Vec<f64> = (0..=across).map(|j| f64::from(j) / f64::from(across)).collect();
    strip::mesh(s, &u, &v, &[])
}

/// A corner of a triangle that is cut along the edges of images of lamps.
#[derive(Clone, Copy)]
struct Corner {
    place: Vec3,
    normal: Vec3,
    dark: f64,
}

/// Puts the bright part of a triangle into the first mesh and the dark one into the second.
fn cut(corners: [Corner; 3], halves: &mut [Mesh; 2]) {
    let mut put = |dark: bool, c: [Corner; 3]| {
        let out = &mut halves[usize::from(dark)];
        let first = out.positions.len() as u32;
        out.positions.extend(c.map(|c| c.place));
        out.normals.extend(c.map(|c| c.normal));
        out.triangles.push([first, first + 1, first + 2]);
    };
    let dark = corners.map(|c| c.dark > 0.0);
    // The corner that is alone on its side of the edge.
    let Some(k) = (0..3).find(|&k| dark[k] != dark[(k + 1) % 3] && dark[k] != dark[(k + 2) % 3]) else {
        return put(dark[0], corners);
    };
    let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let between = |p: &Corner, q: &Corner| {
        let t = p.dark / (p.dark - q.dark);
        Corner {
            place: p.place + (q.place - p.place) * t,
            normal: (p.normal + (q.normal - p.normal) * t).normalize(),
            dark: 0.0,
        }
    };
    let (ab, ac) = (between(&a, &b), between(&a, &c));
    put(dark[k], [a, ab, ac]);
    put(!dark[k], [ab, b, c]);
    put(!dark[k], [ab, c, ac]);
}

/// Bright and dark images of parallel lamps in meshes seen from far away; `eye` points from the model to the eye.
pub fn striped(meshes: &[Mesh], eye: &Vec3) -> Scene {
    let toward = eye.normalize();
    let side = toward.cross(&Vec3::z()).normalize();
    let up = side.cross(&toward);
    let mut halves = [Mesh::default(), Mesh::default()];
    for mesh in meshes {
        for t in &mesh.triangles {
            let p = t.map(|k| mesh.positions[k as usize]);
            let n = t.map(|k| mesh.normals[k as usize]);
            let turn = (0..3).map(|k| (n[k] - n[(k + 1) % 3]).norm()).fold(0.0, f64::max);
            let parts = ((turn / TURN).ceil() as u32).clamp(1, CUTS);
            let at = |list: &[Vec3; 3], i: u32, j: u32| {
                let (s, t) = (f64::from(i) / f64::from(parts), f64::from(j) / f64::from(parts));
                list[0] * (1.0 - s) + list[1] * (s - t) + list[2] * t
            };
            // Positive where the image of a lamp is dark.
            let darkness = |normal: &Vec3| (TAU * stripe(&-toward, normal, [&toward, &up])).sin();
            let mut piece = |c: [(u32, u32); 3]| {
                let corner = |(i, j)| {
                    let normal = at(&n, i, j).normalize();
                    Corner { place: at(&p, i, j), normal, dark: darkness(&normal) }
                };
                cut(c.map(corner), &mut halves);
            };
            for (i, j) in (0..parts).flat_map(|i| (0..=i).map(move |j| (i, j))) {
                piece([(i, j), (i + 1, j), (i + 1, j + 1)]);
                if j < i {
                    piece([(i, j), (i + 1, j + 1), (i, j + 1)]);
                }
            }
        }
    }
    let panels = halves.map(|mesh| PanelShape { mesh, ..PanelShape::default() }).into();
    Scene { panels, ..Scene::default() }
}
