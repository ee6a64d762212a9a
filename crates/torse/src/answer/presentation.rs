//! What people look at and cutters follow: scene, view and drawing of an outcome.

use super::marks::Marks;
use super::outcome::Outcome;
use super::shapes::{shapes, Shape};
use super::sheets::Sheets;
use crate::develop::layout::layout;
use crate::draw::drawing::{drawing, Drawing};
use crate::draw::flat::{self, FlatPiece};
use crate::draw::picture;
use crate::draw::scene::{PanelShape, Scene, ShapePatch};
use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::Pattern;
use crate::tessellate::panel::{border_lines, panel_mesh, ruling_lines, surface_mesh};
use crate::tessellate::strip;
use rayon::prelude::*;

/// Everything drawn, in mm.
#[derive(Clone, Debug)]
pub struct Presentation {
    /// What must not be cut.
    pub marks: Marks,
    /// Triangles and lines in space.
    pub scene: Scene,
    /// Direction from which the model shows best.
    pub direction: Vec3,
    /// The cutter's drawing of all patterns side by side.
    pub drawing: Drawing,
    /// The same patterns as polygons, for pictures.
    pub pieces: Vec<FlatPiece>,
    /// Planes, cylinders, cones and tangent surfaces of which strips consist; empty for jobs without strips.
    pub shapes: Vec<Shape>,
    /// Their triangles, to be coloured by kind.
    pub shape_patches: Vec<ShapePatch>,
}

/// Rulings are drawn about this many to the diagonal of the model.
const RULINGS: f64 = 60.0;
/// Points on every span of a border line.
const BORDER_POINTS: usize = 6;
/// Chord error of the pictures' outlines, as a share of the tolerance.
const PICTURE_CHORD: f64 = 0.2;

/// Prepares an outcome for the writers.
pub fn present(outcome: &Outcome) -> Presentation {
    present_marked(outcome, Marks::of(outcome))
}

/// Prepares an outcome for the writers with given marks.
pub fn present_marked(outcome: &Outcome, marks: Marks) -> Presentation {
    let patchwork = &outcome.patchwork;
    let surfaces = (0..patchwork.faces.len()).into_par_iter().map(|f| surface_mesh(patchwork, f)).collect();
    let mut scene = Scene { surfaces, ..Scene::default() };
    let spacing = scene.bbox().diagonal() / RULINGS;
    scene.panels = (0..patchwork.panels.len())
        .into_par_iter()
        .map(|k| {
            let panel = &patchwork.panels[k];
            PanelShape {
                name: panel.strip.name.clone(),
                mesh: panel_mesh(patchwork, k),
                rulings: ruling_lines(panel, spacing),
                borders: border_lines(panel, BORDER_POINTS),
                marked: marks.panels[k],
            }
        })
        .collect();
    let placements = layout(&outcome.patterns);
    let places: Vec<(f64, Vec2)> = placements.iter().map(|p| (p.angle, p.offset)).collect();
    Presentation {
        direction: picture::direction(&scene),
        drawing: drawing(&outcome.patterns, &placements, &marks.patterns),
        pieces: pieces(&outcome.patterns, &places, PICTURE_CHORD * outcome.tolerance, &marks),
        shapes: Vec::new(),
        shape_patches: Vec::new(),
        marks,
        scene,
    }
}

/// Patterns for pictures, marked.
fn pieces(patterns: &[Pattern], places: &[(f64, Vec2)], chord: f64, marks: &Marks) -> Vec<FlatPiece> {
    let mut pieces = flat::pieces(patterns, places, chord);
    for (piece, marked) in pieces.iter_mut().zip(&marks.patterns) {
        piece.marked = *marked;
    }
    pieces
}

/// Prepares strips for the writers.
pub fn present_sheets(sheets: &Sheets) -> Presentation {
    present_sheets_marked(sheets, Marks::of_sheets(sheets))
}

/// Prepares strips for the writers with given marks.
pub fn present_sheets_marked(sheets: &Sheets, marks: Marks) -> Presentation {
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
        scene.panels.push(PanelShape {
            name: s.name.clone(),
            mesh,
            rulings: Vec::new(),
            borders,
            marked: marks.panels[k],
        });
    }
    let spacing = scene.bbox().diagonal() / RULINGS;
    for (shape, s) in scene.panels.iter_mut().zip(&sheets.strips) {
        shape.rulings = strip::ruling_lines(s, spacing);
    }
    scene.guides = sheets.guides.iter().map(|g| g.points.clone()).collect();
    let shapes = shapes(sheets);
    let shape_patches = shapes
        .iter()
        .flat_map(|s| s.pieces.iter().map(|p| (s.shape.kind(), p)))
        .filter_map(|(kind, &(k, from, to))| {
            let s = sheets.strips.get(k)?;
            let (grid, across) = strip::grid(s);
            let inner = grid.into_iter().filter(|u| *u > from && *u < to);
            let u: Vec<f64> = std::iter::once(from).chain(inner).chain([to]).collect();
            Some(ShapePatch { kind, mesh: strip::mesh(s, &u, &across, &[]) })
        })
        .collect();
    let placements = layout(&sheets.patterns);
    let places: Vec<(f64, Vec2)> = placements.iter().map(|p| (p.angle, p.offset)).collect();
    Presentation {
        direction: picture::direction(&scene),
        drawing: drawing(&sheets.patterns, &placements, &marks.patterns),
        pieces: pieces(&sheets.patterns, &places, PICTURE_CHORD * sheets.tolerance, &marks),
        shapes,
        shape_patches,
        marks,
        scene,
    }
}
