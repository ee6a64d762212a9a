//! What people look at and cutters follow: scene, view and drawing of an answer.

use super::marks::Marks;
use super::orders::{self, PartOrder};
use super::shapes::{shapes, Shape};
use super::{Answer, Stage};
use crate::certify::claim::Claim;
use crate::develop::layout::layout;
use crate::draw::drawing::{drawing, Drawing, DrawingOptions};
use crate::draw::flat::{self, FlatPiece};
use crate::draw::picture;
use crate::draw::scene::{PanelShape, Scene, ShapePatch};
use crate::geom::mesh::Mesh;
use crate::geom::{Vec2, Vec3};
use crate::num::parallel;
use crate::patchwork::panel::Panel;
use crate::patchwork::pattern::Pattern;
use crate::tessellate::diagnostics::{joints, strip_curvature};
use crate::tessellate::panel::{border_lines, panel_mesh, ruling_lines, surface_curvature, surface_mesh};
use crate::tessellate::strip;
use crate::torse::cone::part::{ConePart, PartFace};
use crate::torse::strip::Strip;
/// Everything drawn, in mm.
#[derive(Clone, Debug)]
pub struct Presentation {
    /// What must not be cut.
    pub marks: Marks,
    /// Triangles and lines in space.
    pub scene: Scene,
    /// The strips at the stages of the answer, with captions.
    pub stages: Vec<(String, Scene)>,
    /// Direction from which the model shows best.
    pub direction: Vec3,
    /// The cutter's drawing of all patterns side by side.
    pub drawing: Drawing,
    /// A drawing of each part alone, with its name, where that is wanted.
    pub alone: Vec<(String, Drawing)>,
    /// The same patterns as polygons, for pictures.
    pub pieces: Vec<FlatPiece>,
    /// Planes, cylinders, cones and tangent surfaces of which whole strips consist; empty where panels cover faces.
    pub shapes: Vec<Shape>,
    /// What is ordered of each pattern.
    pub(crate) orders: Vec<PartOrder>,
    /// Their triangles, to be coloured by kind.
    pub shape_patches: Vec<ShapePatch>,
}

/// Rulings are drawn about this many to the diagonal of the model.
const RULINGS: f64 = 60.0;
/// Points on every span of a border line.
const BORDER_POINTS: usize = 6;
/// Chord error of the pictures' outlines, as a share of the longest pattern: a tenth of a pixel.
const PICTURE_CHORD: f64 = 5e-5;

/// Prepares an answer for the writers.
pub fn present(answer: &Answer) -> Presentation {
    present_marked(answer, Marks::of(answer))
}

/// Prepares an answer for the writers with given marks.
pub(crate) fn present_marked(answer: &Answer, marks: Marks) -> Presentation {
    let patchwork = &answer.patchwork;
    let surfaces = parallel::map(0..patchwork.faces.len(), |f| surface_mesh(patchwork, f));
    let mut scene = Scene { surfaces, ..Scene::default() };
    let panels = patchwork.panels.iter().enumerate();
    scene.panels = parallel::map(panels, |(k, panel)| shape(answer, k, panel, marks.panels[k]));
    scene.guides = answer.guides.iter().map(|g| g.points.clone()).collect();
    scene.witnesses = witnesses(answer);
    let meshes: Vec<&Mesh> = scene.panels.iter().map(|p| &p.mesh).collect();
    scene.joints = joints(&meshes, apart(answer));
    scene.curvature = [
        parallel::map(patchwork.panels.iter().enumerate(), |(k, p)| curvature_of(answer, k, p)),
        parallel::map(0..patchwork.faces.len(), |f| surface_curvature(patchwork, f)),
    ];
    let spacing = scene.bbox().diagonal() / RULINGS;
    let ruled = scene.panels.iter_mut().zip(&patchwork.panels).enumerate();
    let ruled = ruled.filter(|(k, _)| trimmed_cone(answer, *k).is_none());
    parallel::for_each(ruled, |(_, (shown, panel))| {
        shown.rulings = if panel.loops().is_empty() {
            strip::ruling_lines(&panel.strip, spacing)
        } else {
            ruling_lines(panel, spacing)
        };
    });
    let shapes = shapes(answer);
    let placements = layout(&answer.patterns);
    let places: Vec<(f64, Vec2)> = placements.iter().map(|p| (p.angle, p.offset)).collect();
    let longest = answer.patterns.iter().map(|p| p.length).fold(0.0, f64::max);
    let orders = orders::orders(answer);
    let options = DrawingOptions {
        title: answer.input.to_uppercase(),
        sources: sources(answer),
        words: orders::words(answer, &orders),
        unit: answer.cut.unit,
        test_square: true,
    };
    Presentation {
        direction: picture::direction(&scene),
        stages: parallel::map(answer.stages.iter(), |s| (s.caption.clone(), stage(answer, s, &marks.panels))),
        drawing: drawing(&answer.patterns, &placements, &marks.patterns, &options),
        alone: if answer.cut.one_per_part { alone(&answer.patterns, &marks, &options) } else { Vec::new() },
        pieces: pieces(&answer.patterns, &places, PICTURE_CHORD * longest, &marks),
        shape_patches: shape_patches(answer, &shapes),
        shapes,
        orders,
        marks,
        scene,
    }
}

/// Where claims that are broken are seen, each place once.
fn witnesses(answer: &Answer) -> Vec<Vec3> {
    let mut out: Vec<Vec3> = Vec::new();
    for place in answer.claims.iter().filter(|c| c.is_broken()).filter_map(Claim::witness) {
        if !out.contains(&place) {
            out.push(place);
        }
    }
    out
}

/// How far apart the borders of panels that meet may be, mm.
fn apart(answer: &Answer) -> f64 {
    let gap = answer.certificate.as_ref().map(|c| c.seam_gap_bound).filter(|g| g.is_finite());
    gap.unwrap_or(0.0).max(2.0 * answer.tolerance)
}

/// Gauss curvature at the vertices that [`shape`] makes; none where only the judge's own map knows them.
fn curvature_of(answer: &Answer, k: usize, panel: &Panel) -> Vec<f64> {
    match (trimmed_cone(answer, k), &panel.trim, answer.fields.get(k)) {
        (Some(_), ..) | (_, Some(_), _) => Vec::new(),
        _ if !panel.outline.is_empty() => Vec::new(),
        (.., Some(f)) if f.u.len() > 1 && f.v.len() > 1 => strip_curvature(&panel.strip, &f.u, &f.v),
        _ => {
            let (u, v) = strip::grid(&panel.strip);
            strip_curvature(&panel.strip, &u, &v)
        }
    }
}

/// The strips of a stage over the grids of the final ones, so that all stages have the same triangles.
fn stage(answer: &Answer, stage: &Stage, marks: &[bool]) -> Scene {
    let panel = |(k, s): (usize, &Strip)| {
        let last = answer.patchwork.panels.get(k).map_or(s, |p| &p.strip);
        let (u, v) = strip::grid(last);
        PanelShape {
            name: s.name.clone(),
            mesh: strip::mesh(s, &u, &v, &[]),
            borders: vec![strip::border_line(s)],
            marked: marks.get(k).copied().unwrap_or(false),
            ..PanelShape::default()
        }
    };
    Scene { panels: stage.strips.iter().enumerate().map(panel).collect(), ..Scene::default() }
}

/// Triangles and borders of a panel.
fn shape(answer: &Answer, k: usize, panel: &Panel, marked: bool) -> PanelShape {
    let name = panel.strip.name.clone();
    let (mesh, borders) = match (trimmed_cone(answer, k), &panel.trim, answer.fields.get(k)) {
        (Some((part, face)), ..) => (face.mesh.clone(), face.loops.iter().map(|l| part.polyline(l)).collect()),
        (_, Some(_), _) => (panel_mesh(&answer.patchwork, k), border_lines(panel, BORDER_POINTS)),
        (.., field) if !panel.outline.is_empty() => {
            let grid = field.filter(|f| f.u.len() > 1 && f.v.len() > 1).map(|f| (&f.u[..], &f.v[..], &f.values[..]));
            let (u, v) = strip::grid(&panel.strip);
            let (u, v, values) = grid.unwrap_or((&u, &v, &[]));
            (strip::trimmed_mesh(panel, u, v, values), border_lines(panel, 1))
        }
        (.., Some(f)) if f.u.len() > 1 && f.v.len() > 1 => {
            (strip::mesh(&panel.strip, &f.u, &f.v, &f.values), vec![strip::border_line(&panel.strip)])
        }
        _ => {
            let (u, v) = strip::grid(&panel.strip);
            (strip::mesh(&panel.strip, &u, &v, &[]), vec![strip::border_line(&panel.strip)])
        }
    };
    PanelShape { name, mesh, rulings: Vec::new(), borders, marked }
}

/// The piece of a trimmed chain of cones that a panel is the patch of, if it is one.
fn trimmed_cone(answer: &Answer, panel: usize) -> Option<(&ConePart, &PartFace)> {
    let cones = answer.cones.as_ref()?;
    let &(body, piece) = cones.pieces.get(panel)?;
    let part = cones.bodies.get(body)?.part.as_ref()?;
    Some((part, part.faces.get(piece)?))
}

/// Triangles of the shapes of parts, to be coloured by kind.
fn shape_patches(answer: &Answer, shapes: &[Shape]) -> Vec<ShapePatch> {
    shapes
        .iter()
        .flat_map(|s| s.pieces.iter().map(|p| (s.shape.kind(), p)))
        .filter_map(|(kind, &(k, from, to))| {
            let s = &answer.patchwork.panels.get(k)?.strip;
            let (grid, across) = strip::grid(s);
            let inner = grid.into_iter().filter(|u| *u > from && *u < to);
            let u: Vec<f64> = std::iter::once(from).chain(inner).chain([to]).collect();
            Some(ShapePatch { kind, mesh: strip::mesh(s, &u, &across, &[]) })
        })
        .collect()
}

/// The names that patterns have in the model, where it consists of several parts with names; none where a pattern has the same
/// name.
fn sources(answer: &Answer) -> Vec<String> {
    if !answer.has_named_parts() {
        return Vec::new();
    }
    let named = |p: &Pattern| Some(answer.sources_of(p.panel).join(" + ")).filter(|source| *source != p.name);
    answer.patterns.iter().map(|p| named(p).map_or_else(String::new, |source| source.to_uppercase())).collect()
}

/// Every pattern in a drawing of its own, its scale to be checked as in the common one.
fn alone(patterns: &[Pattern], marks: &Marks, options: &DrawingOptions) -> Vec<(String, Drawing)> {
    let one = |(k, pattern): (usize, &Pattern)| {
        let one = std::slice::from_ref(pattern);
        let DrawingOptions { unit, test_square, .. } = *options;
        let sources = options.sources.get(k..=k).unwrap_or(&[]).to_vec();
        let words = options.words.get(k..=k).unwrap_or(&[]).to_vec();
        let options = DrawingOptions { title: options.title.clone(), sources, words, unit, test_square };
        let marked = marks.patterns.get(k..=k).unwrap_or(&[]);
        (pattern.name.clone(), drawing(one, &layout(one), marked, &options))
    };
    parallel::map(patterns.iter().enumerate(), one)
}

/// Patterns for pictures, marked.
fn pieces(patterns: &[Pattern], places: &[(f64, Vec2)], chord: f64, marks: &Marks) -> Vec<FlatPiece> {
    let mut pieces = flat::pieces(patterns, places, chord);
    for (piece, marked) in pieces.iter_mut().zip(&marks.patterns) {
        piece.marked = *marked;
    }
    pieces
}
