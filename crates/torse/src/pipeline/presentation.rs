//! What people look at and cutters follow: scene, view and drawing of an outcome.

use super::outcome::Outcome;
use super::sheets::Sheets;
use crate::develop::layout::layout;
use crate::geom::{Vec2, Vec3};
use crate::tessellate::drawing::{drawing, Drawing};
use crate::tessellate::flat::{self, FlatPiece};
use crate::tessellate::panel::{border_lines, panel_mesh, ruling_lines, surface_mesh};
use crate::tessellate::picture;
use crate::tessellate::scene::{PanelShape, Scene};
use crate::tessellate::strip;
use rayon::prelude::*;

/// Everything drawn, in mm.
#[derive(Clone, Debug)]
pub struct Presentation {
    /// Triangles and lines in space.
    pub scene: Scene,
    /// Direction from which the model shows best.
    pub direction: Vec3,
    /// The cutter's drawing of all patterns side by side.
    pub drawing: Drawing,
    /// The same patterns as polygons, for pictures.
    pub pieces: Vec<FlatPiece>,
}

/// Rulings are drawn about this many to the diagonal of the model.
const RULINGS: f64 = 60.0;
/// Points on every span of a border line.
const BORDER_POINTS: usize = 6;
/// Chord error of the pictures' outlines, as a share of the tolerance.
const PICTURE_CHORD: f64 = 0.2;

/// Prepares an outcome for the writers.
pub fn present(outcome: &Outcome) -> Presentation {
    let patchwork = &outcome.patchwork;
    let surfaces = (0..patchwork.faces.len()).into_par_iter().map(|f| surface_mesh(patchwork, f)).collect();
    let mut scene = Scene { surfaces, ..Scene::default() };
    let spacing = scene.bbox().diagonal() / RULINGS;
    scene.panels = (0..patchwork.panels.len())
        .into_par_iter()
        .map(|k| {
            let panel = &patchwork.panels[k];
            PanelShape {
                name: panel.name.clone(),
                mesh: panel_mesh(patchwork, k),
                rulings: ruling_lines(panel, spacing),
                borders: border_lines(panel, BORDER_POINTS),
            }
        })
        .collect();
    let placements = layout(&outcome.patterns);
    let places: Vec<(f64, Vec2)> = placements.iter().map(|p| (p.angle, p.offset)).collect();
    Presentation {
        direction: picture::direction(&scene),
        drawing: drawing(&outcome.patterns, &placements),
        pieces: flat::pieces(&outcome.patterns, &places, PICTURE_CHORD * outcome.tolerance),
        scene,
    }
}

/// Prepares strips for the writers.
pub fn present_sheets(sheets: &Sheets) -> Presentation {
    let mut scene = Scene::default();
    for (k, s) in sheets.strips.iter().enumerate() {
        let mesh = match sheets.fields.get(k) {
            Some(f) if f.u.len() > 1 && f.v.len() > 1 => strip::mesh(s, &f.u, &f.v, &f.values),
            _ => {
                let (u, v) = strip::grid(s);
                strip::mesh(s, &u, &v, &[])
            }
        };
        let borders = vec![strip::border_line(s)];
        scene.panels.push(PanelShape { name: s.name.clone(), mesh, rulings: Vec::new(), borders });
    }
    let spacing = scene.bbox().diagonal() / RULINGS;
    for (shape, s) in scene.panels.iter_mut().zip(&sheets.strips) {
        shape.rulings = strip::ruling_lines(s, spacing);
    }
    scene.guides = sheets.guides.iter().map(|g| g.points.clone()).collect();
    let placements = layout(&sheets.patterns);
    let places: Vec<(f64, Vec2)> = placements.iter().map(|p| (p.angle, p.offset)).collect();
    Presentation {
        direction: picture::direction(&scene),
        drawing: drawing(&sheets.patterns, &placements),
        pieces: flat::pieces(&sheets.patterns, &places, PICTURE_CHORD * sheets.tolerance),
        scene,
    }
}
