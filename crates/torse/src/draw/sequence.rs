//! Pictures in rows: stages of a motion side by side, all seen by one camera.

use super::camera::{Camera, Rect};
use super::colour;
use super::raster::{Drawing, Image, Paint, PenLine, Vertex};
use super::scene::Scene;
use crate::geom::{Vec2, Vec3};

/// Width and height of one picture, and of the caption below, pixels.
const CELL: (f64, f64) = (340.0, 360.0);
const CAPTION: f64 = 60.0;
/// Pictures in a row.
const ROW: usize = 3;
/// Margin around the model in a picture, pixels.
const MARGIN: f64 = 10.0;
/// Way (mm) by which borders are lifted towards the eye: their own triangles must not hide them.
const LIFT: f64 = 1e-3;

/// The stages in rows of three, each with its caption below; `eye` points from the model to the eye.
pub fn sequence(stages: &[(String, Scene)], eye: &Vec3) -> Image {
    let (columns, rows) = (stages.len().clamp(1, ROW), stages.len().div_ceil(ROW).max(1));
    let mut picture = Drawing::new((CELL.0 * columns as f64) as usize, ((CELL.1 + CAPTION) * rows as f64) as usize);
    let points: Vec<Vec3> =
        stages.iter().flat_map(|(_, s)| s.panels.iter().flat_map(|p| p.mesh.positions.iter().copied())).collect();
    for (k, (caption, stage)) in stages.iter().enumerate() {
        let (left, top) = (CELL.0 * (k % ROW) as f64, (CELL.1 + CAPTION) * (k / ROW) as f64);
        let rect = Rect {
            x: left + MARGIN,
            y: top + 2.0 * MARGIN,
            width: CELL.0 - 2.0 * MARGIN,
            height: CELL.1 - 2.0 * MARGIN,
        };
        let camera = Camera::fitting(points.iter(), eye, rect);
        for (i, shape) in stage.panels.iter().enumerate() {
            let corner = |c: u32| Vertex {
                place: camera.project(&shape.mesh.positions[c as usize]),
                normal: camera.to_view(&shape.mesh.normals[c as usize]),
                value: 0.0,
            };
            for t in &shape.mesh.triangles {
                picture.triangles.push((Paint::Solid(colour::shown(i, shape.marked)), t.map(corner)));
            }
            for b in &shape.borders {
                let points = b.iter().map(|p| camera.project_towards_eye(p, LIFT)).collect();
                picture.lines.push(PenLine { points, width: 1.6, colour: [0.1, 0.1, 0.12], alpha: 1.0 });
            }
        }
        picture.text(caption, Vec2::new(left + 2.0 * MARGIN, top + CELL.1 + 40.0), 17.0, [0.2, 0.2, 0.22]);
    }
    picture.render()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::scene::PanelShape;
    use crate::geom::mesh::Mesh;

    #[test]
    fn every_stage_has_its_place() {
        let stage = |z: f64| {
            let mesh = Mesh {
                positions: vec![Vec3::zeros(), Vec3::x() * 10.0, Vec3::new(10.0, 10.0, z)],
                normals: vec![Vec3::z(); 3],
                triangles: vec![[0, 1, 2]],
                values: Vec::new(),
            };
            Scene { panels: vec![PanelShape { mesh, ..PanelShape::default() }], ..Scene::default() }
        };
        let image = sequence(&[("0 %".into(), stage(0.0)), ("100 %".into(), stage(5.0))], &Vec3::new(0.3, -1.0, 0.8));
        assert_eq!((image.width, image.height), (680, 420));
        // Something is drawn in both cells.
        let inked = |from: usize| {
            (20..340).any(|y| (from..from + 340).any(|x| image.pixels[y * image.width + x] != image.pixels[0]))
        };
        assert!(inked(0) && inked(340));
        let five: Vec<_> = (0..5).map(|k| (format!("{k}"), stage(f64::from(k)))).collect();
        let image = sequence(&five, &Vec3::new(0.3, -1.0, 0.8));
        assert_eq!((image.width, image.height), (1020, 840));
        assert!(sequence(&[], &Vec3::z()).width > 0);
    }
}
