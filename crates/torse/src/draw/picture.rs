//! The three pictures of a job: panels with rulings, deviation map, flat layout.

use super::camera::{telling_direction, Camera, Rect};
use super::colour::{self, Rgb};
use super::flat::FlatPiece;
use super::label::SightMap;
use super::names::{self, Named, PlacedName, Room};
use super::raster::{Drawing, Image, Paint, PenLine, Vertex};
use super::scene::{titled, Scene, ShapePatch, NOT_CERTIFIED};
use super::stroke_font;
use crate::geom::mesh::Mesh;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::pattern::BendSense;
use crate::torse::form::PanelKind;

/// Size and captions of a picture.
#[derive(Clone, Debug)]
pub struct Caption {
    /// Width of the picture; default 1600 pixels. The height follows from the contents.
    pub width: usize,
    /// First line, upper left; default empty.
    pub title: String,
    /// Second line, smaller; default empty.
    pub note: String,
}

impl Default for Caption {
    fn default() -> Self {
        Self { width: 1600, title: String::new(), note: String::new() }
    }
}

const INK: Rgb = [0.10, 0.12, 0.16];
/// Given curves.
const GUIDE: Rgb = [0.78, 0.16, 0.12];
/// Bend lines, as in SVG files.
const UPWARDS: Rgb = [0.0, 0.5, 1.0];
/// See [`UPWARDS`].
const DOWNWARDS: Rgb = [1.0, 0.5, 0.0];
const GREY: Rgb = [0.42, 0.45, 0.50];
/// Space around the contents, px.
const MARGIN: f64 = 44.0;
/// Height of capitals of titles and legends, px: still readable in a picture shrunk to two fifths.
const TITLE: f64 = 24.0;
const SMALL: f64 = 18.0;
/// Lines drawn on a surface are lifted towards the eye by this share of the model's diagonal, or the chords of the
/// mesh would swallow them.
const LIFT: f64 = 2.5e-3;
/// Panels whose borders and rulings are drawn; of more, every second, third, … is: lines of a pixel's distance would only
/// blacken the picture.
const MOST_LINED: usize = 1000;
/// Rulings drawn on the sheet; of more, every second, third, … is.
const MOST_RULINGS: usize = 4000;

/// A telling direction to see the scene from (from the model to the eye).
pub fn direction(scene: &Scene) -> Vec3 {
    telling_direction(meshes(scene))
}

/// Panels in distinct colours with rulings, seams and names; those that must not be cut in red, with words that say it.
///
/// `direction` points from the model to the eye, see [`direction`].
pub fn panels(scene: &Scene, direction: &Vec3, caption: &Caption) -> Image {
    let (mut drawing, camera) = stage(scene, direction, caption, 0.0);
    let top = MARGIN + head(caption);
    let lift = LIFT * scene.bbox().diagonal();
    for (i, panel) in scene.panels.iter().enumerate() {
        let base = colour::shown(i, panel.marked);
        triangles(&mut drawing, &camera, &panel.mesh, Paint::Solid(base), 1.0);
        let ruling = colour::mix(base, INK, 0.55);
        for r in panel.rulings.iter().filter(|_| i % lined(scene) == 0) {
            let points = r.map(|p| camera.project_towards_eye(&p, lift)).to_vec();
            drawing.lines.push(PenLine { points, width: 1.3, colour: ruling, alpha: 0.8 });
        }
    }
    if scene.panels.is_empty() {
        for mesh in &scene.surfaces {
            triangles(&mut drawing, &camera, mesh, Paint::Solid([0.80, 0.82, 0.85]), 1.0);
        }
    }
    borders(&mut drawing, &camera, scene, 2.6);
    witnesses(&mut drawing, &camera, scene, top);
    if scene.panels.len() <= names::MOST_NAMES {
        names(&mut drawing, &camera, scene, top);
    }
    drawing.render()
}

/// The signed deviation of the panels from the surface, with a legend from −tolerance to +tolerance (mm).
pub(crate) fn deviation(scene: &Scene, direction: &Vec3, tolerance: f64, caption: &Caption) -> Image {
    values(scene, direction, tolerance, "deviation, mm", caption)
}

/// The values at the vertices of the panels, with a legend from −limit to +limit and the words `what`.
pub(crate) fn values(scene: &Scene, direction: &Vec3, limit: f64, what: &str, caption: &Caption) -> Image {
    let (mut drawing, camera) = stage(scene, direction, caption, LEGEND);
    for panel in &scene.panels {
        triangles(&mut drawing, &camera, &panel.mesh, Paint::Deviation, 1.0 / limit);
    }
    borders(&mut drawing, &camera, scene, 1.6);
    value_legend(&mut drawing, limit, what);
    drawing.render()
}

/// Room for the legend of values, px.
const LEGEND: f64 = 190.0;

/// The legend of values at the right border.
fn value_legend(drawing: &mut Drawing, limit: f64, what: &str) {
    let (width, height) = (drawing.width as f64, drawing.height as f64);
    let bar = Rect {
        x: width - LEGEND,
        y: 0.5 * height - 0.5 * (height - 150.0).min(460.0) + 18.0,
        width: 30.0,
        height: (height - 150.0).min(460.0),
    };
    legend(drawing, bar, limit, what);
}

/// Points coloured by their values over the strips in grey, with a legend from −limit to +limit and the words `what`.
/// Without strips the points alone are shown. Points beyond the limit are larger; those outside the picture, which shows
/// all strips, are missing, and counted in the answer.
pub(crate) fn points(
    scene: &Scene,
    (points, values): (&[Vec3], &[f64]),
    direction: &Vec3,
    limit: f64,
    what: &str,
    caption: &Caption,
) -> (Image, usize) {
    const GROUND: Rgb = [0.66, 0.68, 0.71];
    let mut scene = std::borrow::Cow::Borrowed(scene);
    if meshes(&scene).all(|m| m.positions.is_empty()) {
        let positions = points.iter().filter(|p| p.iter().all(|x| x.is_finite())).copied().collect();
        scene.to_mut().surfaces = vec![Mesh { positions, ..Mesh::default() }];
    }
    let (mut drawing, camera) = stage(&scene, direction, caption, LEGEND);
    for panel in &scene.panels {
        triangles(&mut drawing, &camera, &panel.mesh, Paint::Solid(GROUND), 1.0);
    }
    borders(&mut drawing, &camera, &scene, 1.2);
    value_legend(&mut drawing, limit, what);
    let mut image = drawing.render();
    let shares: Vec<f64> = values.iter().map(|v| v / limit).collect();
    let drawn = super::dots::dots(&mut image, &camera, points, &shares);
    (image, points.len() - drawn)
}

/// Patches coloured by what they are, with the rulings and borders of the scene, and a legend of the four kinds.
pub fn shapes(scene: &Scene, patches: &[ShapePatch], direction: &Vec3, caption: &Caption) -> Image {
    const LEGEND: f64 = 290.0;
    const BOX: f64 = 22.0;
    let (mut drawing, camera) = stage(scene, direction, caption, LEGEND);
    for p in patches {
        triangles(&mut drawing, &camera, &p.mesh, Paint::Solid(colour::kind(p.kind)), 1.0);
    }
    let lift = LIFT * scene.bbox().diagonal();
    for r in scene.panels.iter().step_by(lined(scene)).flat_map(|p| &p.rulings) {
        let points = r.map(|p| camera.project_towards_eye(&p, lift)).to_vec();
        drawing.lines.push(PenLine { points, width: 1.0, colour: INK, alpha: 0.35 });
    }
    borders(&mut drawing, &camera, scene, 1.6);
    let x = drawing.width as f64 - LEGEND + 10.0;
    let kinds = [
        (PanelKind::Plane, "plane"),
        (PanelKind::Cylinder, "cylinder"),
        (PanelKind::Cone, "cone"),
        (PanelKind::Torse, "tangent surface"),
    ];
    let mut y = 0.5 * drawing.height as f64 - 70.0;
    for (kind, name) in kinds {
        let corners = [[0.0, 0.0], [BOX, 0.0], [BOX, BOX], [0.0, BOX], [0.0, 0.0]];
        let frame: Vec<Vec2> = corners.iter().map(|c| Vec2::new(x + c[0], y + c[1])).collect();
        drawing.fill(vec![frame[..4].to_vec()], colour::kind(kind), 1.0);
        drawing.stroke(&frame, 1.0, GREY, 1.0);
        drawing.text(name, Vec2::new(x + BOX + 12.0, y + 0.5 * (BOX + SMALL)), SMALL, INK);
        y += BOX + 16.0;
    }
    drawing.render()
}

/// The flat patterns on the sheet with rulings, marks and names.
pub(crate) fn layout(pieces: &[FlatPiece], caption: &Caption) -> Image {
    const HEIGHT: std::ops::RangeInclusive<f64> = 260.0..=2400.0;
    const FOOT: f64 = 46.0;
    let finite = |p: &&Vec2| p.x.is_finite() && p.y.is_finite();
    let points = || pieces.iter().flat_map(|p| p.outlines.iter().flatten()).filter(finite);
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    for p in points() {
        (low, high) = (low.inf(p), high.sup(p));
    }
    if points().next().is_none() {
        (low, high) = (Vec2::zeros(), Vec2::repeat(1.0));
    }
    let extent = (high - low).sup(&Vec2::repeat(f64::MIN_POSITIVE));
    let width = caption.width.max(200) as f64;
    let head = head(caption);
    let most = (*HEIGHT.end() - head - 2.0 * MARGIN - FOOT) / extent.y;
    let scale = ((width - 2.0 * MARGIN) / extent.x).min(most);
    let height = (extent.y * scale + 2.0 * MARGIN + head + FOOT).clamp(*HEIGHT.start(), *HEIGHT.end());
    let left = 0.5 * (width - extent.x * scale);
    let place = |p: &Vec2| Vec2::new(left + (p.x - low.x) * scale, head + MARGIN + (high.y - p.y) * scale);
    let mut map = SightMap::new(width as usize, height as usize);
    let named = names::of_pieces(&mut map, pieces, place);
    map.close_below(height - FOOT);
    let room = Room { top: head + 0.5 * MARGIN, most: names::most_beside(pieces.len()), numbers: true };
    let placed = names::placed(&mut map, &named, room);
    let list = NameList::new(&named, &placed, width - 2.0 * MARGIN);
    let mut drawing = Drawing::new(width as usize, (height + list.height()) as usize);
    captions(&mut drawing, caption);
    let step = pieces.iter().map(|p| p.rulings.len()).sum::<usize>().div_ceil(MOST_RULINGS).max(1);
    for piece in pieces {
        let base = colour::shown(piece.panel, piece.marked);
        let loops: Vec<Vec<Vec2>> = piece.outlines.iter().map(|o| o.iter().map(place).collect()).collect();
        drawing.fill(loops.clone(), colour::mix(base, [1.0; 3], 0.55), 1.0);
        for (k, r) in piece.rulings.iter().enumerate().step_by(step) {
            // Of sheet with bends, which way each goes is what people look for.
            let bend = piece.bends.get(k).filter(|_| !piece.extents.is_empty());
            let (width, colour, opacity) = match bend.map(|b| b.sense) {
                Some(BendSense::Up) => (2.4, UPWARDS, 1.0),
                Some(BendSense::Down) => (2.4, DOWNWARDS, 1.0),
                _ => (1.1, colour::mix(base, INK, 0.35), 0.65),
            };
            drawing.stroke(&r.map(|p| place(&p)), width, colour, opacity);
        }
        for r in &piece.extents {
            drawing.stroke(&r.map(|p| place(&p)), 1.0, INK, 0.4);
        }
        for outline in &piece.formed {
            let line: Vec<Vec2> = outline.iter().chain(outline.first()).map(place).collect();
            drawing.stroke(&line, 1.4, INK, 0.5);
        }
        for line in piece.sections.iter().chain(&piece.curves) {
            let line: Vec<Vec2> = line.iter().map(place).collect();
            drawing.stroke(&line, 1.2, INK, 0.7);
        }
        for mut outline in loops {
            outline.extend(outline.first().copied());
            drawing.stroke(&outline, 2.2, INK, 1.0);
        }
        for [at, inward] in &piece.marks {
            let (p, d) = (place(at), Vec2::new(inward.x, -inward.y));
            drawing.stroke(&[p, p + d * 9.0], 1.6, INK, 1.0);
        }
    }
    write_names(&mut drawing, &named, &placed);
    list.write(&mut drawing, Vec2::new(MARGIN, height - FOOT));
    let right = scale_bar(&mut drawing, scale);
    if pieces.iter().any(|p| !p.extents.is_empty()) {
        let base = drawing.height as f64 - 34.0 + 0.5 * SMALL;
        let mut x = right + 40.0;
        for (words, colour) in [("bends up", UPWARDS), ("bends down", DOWNWARDS)] {
            drawing.stroke(&[Vec2::new(x, base - 5.0), Vec2::new(x + 28.0, base - 5.0)], 2.4, colour, 1.0);
            drawing.text(words, Vec2::new(x + 36.0, base), SMALL, INK);
            x += 60.0 + stroke_font::width(words, SMALL);
        }
    }
    drawing.render()
}

/// The names for which numbers stand on flat parts, in columns.
struct NameList {
    entries: Vec<String>,
    columns: usize,
    column: f64,
}

impl NameList {
    /// Distance of base lines, px.
    const LINE: f64 = SMALL + 10.0;
    /// Space between columns, px.
    const BETWEEN: f64 = 40.0;

    /// The list of names as they were placed, in as many columns as a width (px) has room for.
    fn new(named: &[Named], placed: &[PlacedName], width: f64) -> Self {
        let entry = |(number, k): (usize, usize)| format!("{number}  {}", titled(named[k].name, named[k].marked));
        let entries: Vec<String> = names::listed(placed).into_iter().map(entry).collect();
        let column = Self::BETWEEN + entries.iter().map(|e| stroke_font::width(e, SMALL)).fold(0.0, f64::max);
        let columns = ((width / column) as usize).clamp(1, entries.len().max(1));
        Self { entries, columns, column }
    }

    fn lines(&self) -> usize {
        self.entries.len().div_ceil(self.columns)
    }

    /// Of the lines and one between them and what is below, px; nothing without names.
    fn height(&self) -> f64 {
        match self.lines() {
            0 => 0.0,
            lines => (lines + 1) as f64 * Self::LINE,
        }
    }

    /// Writes the list below and to the right of a corner.
    fn write(&self, drawing: &mut Drawing, corner: Vec2) {
        for (k, entry) in self.entries.iter().enumerate() {
            let (column, line) = (k / self.lines(), k % self.lines());
            let down = Vec2::new(column as f64 * self.column, (line + 1) as f64 * Self::LINE);
            drawing.text(entry, corner + down, SMALL, INK);
        }
    }
}

/// A number with so many significant digits, without exponent between 1e-4 and 1e7.
pub(crate) fn figure(x: f64, digits: usize) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return if x.is_nan() { "?".into() } else { format!("{}\u{221e}", if x < 0.0 { "\u{2212}" } else { "" }) };
    }
    let magnitude = x.abs().log10().floor() as i32;
    let text = if (-4..7).contains(&magnitude) {
        let decimals = (digits as i32 - 1 - magnitude).max(0) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.*e}", digits.saturating_sub(1))
    };
    text.replace('-', "\u{2212}")
}

fn meshes(scene: &Scene) -> impl Iterator<Item = &Mesh> + Clone {
    // Without panels there is still the surface to look at.
    let surfaces = if scene.panels.is_empty() { &scene.surfaces[..] } else { &[] };
    scene.panels.iter().map(|p| &p.mesh).chain(surfaces)
}

fn head(caption: &Caption) -> f64 {
    let line = |text: &String, height: f64| if text.is_empty() { 0.0 } else { height };
    line(&caption.title, TITLE + 14.0) + line(&caption.note, SMALL + 12.0)
}

/// A drawing with captions and a camera that shows the scene with its curves below them, `right` pixels kept free for a legend.
fn stage(scene: &Scene, direction: &Vec3, caption: &Caption, right: f64) -> (Drawing, Camera) {
    const ASPECT: std::ops::RangeInclusive<f64> = 0.36..=0.68;
    let finite = |p: &&Vec3| p.iter().all(|x| x.is_finite());
    let guides = scene.guides.iter().flatten();
    let points = meshes(scene).flat_map(|m| &m.positions).chain(guides).filter(finite);
    let width = caption.width.max(200) as f64;
    let head = head(caption);
    let room = width - 2.0 * MARGIN - right;
    // Higher than any picture gets, so that the width alone decides.
    let unit = Camera::fitting(points.clone(), direction, Rect { x: 0.0, y: 0.0, width: room, height: 4.0 * width });
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in points.clone() {
        let y = unit.project(p)[1] - unit.origin[1];
        (low, high) = (low.min(y), high.max(y));
    }
    let wanted = if high > low { high - low } else { 0.0 };
    let height = (wanted + head + 2.0 * MARGIN).clamp(ASPECT.start() * width, ASPECT.end() * width).round();
    let rect = Rect { x: MARGIN, y: MARGIN + head, width: room, height: height - head - 2.0 * MARGIN };
    let mut drawing = Drawing::new(width as usize, height as usize);
    captions(&mut drawing, caption);
    (drawing, Camera::fitting(points, direction, rect))
}

fn captions(drawing: &mut Drawing, caption: &Caption) {
    // Words too long for the picture are written smaller.
    let room = drawing.width as f64 - 2.0 * MARGIN;
    let fitting = |text: &str, size: f64| size.min(room / stroke_font::width(text, 1.0));
    let mut y = MARGIN;
    if !caption.title.is_empty() {
        drawing.text(&caption.title, Vec2::new(MARGIN, y + 0.5 * TITLE), fitting(&caption.title, TITLE), INK);
        y += TITLE + 10.0;
    }
    if !caption.note.is_empty() {
        drawing.text(&caption.note, Vec2::new(MARGIN, y + 0.5 * SMALL), fitting(&caption.note, SMALL), GREY);
    }
}

fn triangles(drawing: &mut Drawing, camera: &Camera, mesh: &Mesh, paint: Paint, unit: f64) {
    drawing.triangles.extend(projected(camera, mesh, unit).map(|corners| (paint, corners)));
}

/// The triangles of a mesh as the camera sees them, values multiplied by `unit`.
fn projected<'a>(camera: &Camera, mesh: &'a Mesh, unit: f64) -> impl Iterator<Item = [Vertex; 3]> + 'a {
    let vertices: Vec<Vertex> = mesh
        .positions
        .iter()
        .enumerate()
        .map(|(i, p)| Vertex {
            place: camera.project(p),
            normal: mesh.normals.get(i).map_or_else(Vec3::zeros, |n| camera.to_view(n)),
            value: mesh.values.get(i).map_or(0.0, |v| v * unit),
        })
        .collect();
    let camera = *camera;
    mesh.triangles.iter().filter_map(move |t| {
        let mut corners = corners(&vertices, t)?;
        let [a, b, c] = t.map(|k| mesh.positions[k as usize]);
        let flat = (b - a).cross(&(c - a)).try_normalize(0.0).map_or_else(Vec3::z, |n| camera.to_view(&n));
        for corner in &mut corners {
            // Normals that are missing are replaced, and all point to the triangle's own side, so that they can
            // be averaged.
            let usable = corner.normal.iter().all(|x| x.is_finite()) && corner.normal.norm_squared() > 0.25;
            let normal = if usable { corner.normal } else { flat };
            corner.normal = if normal.dot(&flat) < 0.0 { -normal } else { normal };
        }
        Some(corners)
    })
}

fn corners(vertices: &[Vertex], t: &[u32; 3]) -> Option<[Vertex; 3]> {
    Some([*vertices.get(t[0] as usize)?, *vertices.get(t[1] as usize)?, *vertices.get(t[2] as usize)?])
}

/// The step from one panel whose lines are drawn to the next.
fn lined(scene: &Scene) -> usize {
    scene.panels.len().div_ceil(MOST_LINED).max(1)
}

fn borders(drawing: &mut Drawing, camera: &Camera, scene: &Scene, width: f64) {
    let lift = LIFT * scene.bbox().diagonal();
    for border in scene.panels.iter().step_by(lined(scene)).flat_map(|p| &p.borders) {
        let points = border.iter().map(|p| camera.project_towards_eye(p, lift)).collect();
        drawing.lines.push(PenLine { points, width, colour: INK, alpha: 1.0 });
    }
    for guide in &scene.guides {
        let points = guide.iter().map(|p| camera.project_towards_eye(p, 1.5 * lift)).collect();
        drawing.lines.push(PenLine { points, width: width + 1.4, colour: GUIDE, alpha: 1.0 });
    }
}

/// Half the width of the cross at a place where something is wrong, px.
const CROSS: f64 = 8.0;

/// Crosses where what is asked is seen to be broken, over everything below `top` (pixels); places beside the picture have none.
fn witnesses(drawing: &mut Drawing, camera: &Camera, scene: &Scene, top: f64) {
    let places = scene.witnesses.iter().map(|p| camera.project(p));
    let (width, height) = (drawing.width as f64, drawing.height as f64);
    for [x, y, _] in places.filter(|p| (0.0..width).contains(&p[0]) && (top..height).contains(&p[1])) {
        let arm = |dx: f64, dy: f64| [Vec2::new(x - dx, y - dy), Vec2::new(x + dx, y + dy)];
        let arms = [arm(CROSS, CROSS), arm(CROSS, -CROSS)];
        arms.iter().for_each(|a| drawing.stroke(a, 7.0, [1.0; 3], 1.0));
        arms.iter().for_each(|a| drawing.stroke(a, 3.0, INK, 1.0));
    }
}

/// Names where most of the panel is in sight, if there is room; else beside the model, below `top` (pixels), with a line to
/// the panel.
fn names(drawing: &mut Drawing, camera: &Camera, scene: &Scene, top: f64) {
    // Names beside the model at most: more would hide what they name.
    const MOST_BESIDE: usize = 24;
    let mut map = SightMap::new(drawing.width, drawing.height);
    for (i, panel) in scene.panels.iter().enumerate() {
        for corners in projected(camera, &panel.mesh, 1.0) {
            map.triangle(i as u32, &corners);
        }
    }
    let places = map.places(scene.panels.len());
    let panels = scene.panels.iter().zip(places).enumerate();
    let named = panels
        .filter_map(|(i, (p, place))| Some(Named { owner: i as u32, name: &p.name, marked: p.marked, place: place? }));
    let named: Vec<Named> = named.collect();
    let placed = names::placed(&mut map, &named, Room { top, most: MOST_BESIDE, numbers: false });
    write_names(drawing, &named, &placed);
}

/// Writes names where [`names::placed`] puts them.
fn write_names(drawing: &mut Drawing, named: &[Named], placed: &[PlacedName]) {
    for p in placed {
        let text = p.text(named[p.named].name);
        if let Some([at, end]) = p.leader {
            drawing.stroke(&[at, end], 1.2, INK, 1.0);
            drawing.stroke(&[at, at], 5.0, INK, 1.0);
        }
        let wide = stroke_font::width(&text, p.size);
        drawing.rimmed_text(&text, p.middle + Vec2::new(-0.5 * wide, 0.5 * p.size), p.size, INK);
        if let Some((size, below)) = p.words {
            let wide = stroke_font::width(NOT_CERTIFIED, size);
            let base = p.middle + Vec2::new(-0.5 * wide, 0.5 * p.size + below);
            drawing.rimmed_text(NOT_CERTIFIED, base, size, INK);
        }
    }
}

fn legend(drawing: &mut Drawing, bar: Rect, limit: f64, what: &str) {
    const STEPS: usize = 120;
    let rectangle = |x: f64, y: f64, w: f64, h: f64| {
        vec![Vec2::new(x, y), Vec2::new(x + w, y), Vec2::new(x + w, y + h), Vec2::new(x, y + h)]
    };
    let step = bar.height / STEPS as f64;
    for i in 0..STEPS {
        let share = 1.0 - 2.0 * (i as f64 + 0.5) / STEPS as f64;
        let y = bar.y + i as f64 * step;
        drawing.fill(vec![rectangle(bar.x, y, bar.width, step + 0.3)], colour::deviation(share), 1.0);
    }
    let mut frame = rectangle(bar.x, bar.y, bar.width, bar.height);
    frame.extend(frame.first().copied());
    drawing.stroke(&frame, 1.2, INK, 1.0);
    for share in [1.0, 0.5, 0.0, -0.5, -1.0] {
        let y = bar.y + 0.5 * bar.height * (1.0 - share);
        let x = bar.x + bar.width;
        drawing.stroke(&[Vec2::new(x, y), Vec2::new(x + 7.0, y)], 1.2, INK, 1.0);
        let sign = if share > 0.0 { "+" } else { "" };
        let text = format!("{sign}{}", figure(share * limit, 3));
        drawing.text(&text, Vec2::new(x + 14.0, y + 0.5 * SMALL), SMALL, INK);
    }
    drawing.text(what, Vec2::new(bar.x - 16.0, bar.y - 22.0), SMALL, GREY);
}

fn scale_bar(drawing: &mut Drawing, scale: f64) -> f64 {
    // The longest of 1, 2, 5 · 10^k mm that is at most 200 pixels long.
    const LONGEST: f64 = 200.0;
    let power = 10f64.powf((LONGEST / scale).log10().floor());
    let length = [5.0, 2.0, 1.0].map(|m| m * power).into_iter().find(|l| l * scale <= LONGEST).unwrap_or(power);
    let (x, y) = (MARGIN, drawing.height as f64 - 34.0);
    let end = x + length * scale;
    if !end.is_finite() {
        return x;
    }
    drawing.stroke(&[Vec2::new(x, y), Vec2::new(end, y)], 2.0, INK, 1.0);
    for tick in [x, end] {
        drawing.stroke(&[Vec2::new(tick, y - 6.0), Vec2::new(tick, y + 6.0)], 2.0, INK, 1.0);
    }
    let text = if length >= 1000.0 { format!("{} m", length / 1000.0) } else { format!("{length} mm") };
    drawing.text(&text, Vec2::new(end + 14.0, y + 0.5 * SMALL), SMALL, INK);
    end + 14.0 + stroke_font::width(&text, SMALL)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::scene::PanelShape;

    /// Two square panels side by side, one at +0.4 mm and one at −0.4 mm.
    fn scene() -> Scene {
        let panel = |x: f64, value: f64, name: &str| {
            let corners = [[x, 0.0], [x + 100.0, 0.0], [x + 100.0, 100.0], [x, 100.0]];
            let positions: Vec<Vec3> = corners.iter().map(|c| Vec3::new(c[0], c[1], 0.0)).collect();
            let mut border = positions.clone();
            border.push(positions[0]);
            let mesh = Mesh {
                normals: vec![Vec3::z(); 4],
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                values: vec![value; 4],
                positions,
            };
            let rulings = vec![[Vec3::new(x + 50.0, 0.0, 0.0), Vec3::new(x + 50.0, 100.0, 0.0)]];
            PanelShape { name: name.into(), mesh, rulings, borders: vec![border], marked: false }
        };
        Scene {
            panels: vec![panel(0.0, 0.4, "A-01"), panel(100.0, -0.4, "A-02")],
            surfaces: vec![],
            ..Scene::default()
        }
    }

    fn share(image: &Image, test: impl Fn([i32; 3]) -> bool) -> f64 {
        let count = image.pixels.iter().filter(|p| test(p.map(i32::from))).count();
        count as f64 / image.pixels.len() as f64
    }

    #[test]
    fn both_panels_fill_their_part_of_the_picture() {
        let image = panels(&scene(), &direction(&scene()), &Caption { width: 600, ..Caption::default() });
        for i in 0..2 {
            let base = colour::bytes(colour::panel(i)).map(i32::from);
            let like = |p: [i32; 3]| (0..3).all(|k| (p[k] - base[k]).abs() < 45);
            assert!(share(&image, like) > 0.03, "panel {i}: {}", share(&image, like));
        }
    }

    #[test]
    fn what_must_not_be_cut_is_red_in_space_and_flat() {
        let red = |image: &Image| {
            let base = colour::bytes(colour::NOT_CERTIFIED).map(i32::from);
            share(image, |p| (0..3).all(|k| (p[k] - base[k]).abs() < 60) && p[0] > p[1] + 80 && p[0] > p[2] + 80)
        };
        let caption = Caption { width: 600, ..Caption::default() };
        let mut scene = scene();
        let side = vec![Vec2::zeros(), Vec2::new(100.0, 0.0), Vec2::new(100.0, 60.0), Vec2::new(0.0, 60.0)];
        let mut piece = FlatPiece { name: "A-01".into(), outlines: vec![side], room: 25.0, ..FlatPiece::default() };
        let before = (panels(&scene, &Vec3::z(), &caption), layout(&[piece.clone()], &caption));
        assert!(red(&before.0) < 1e-3 && red(&before.1) < 1e-3);
        scene.panels[0].marked = true;
        piece.marked = true;
        assert!(red(&panels(&scene, &Vec3::z(), &caption)) > 0.03);
        let after = layout(&[piece], &caption);
        assert!(after.pixels != before.1.pixels);
    }

    #[test]
    fn narrow_panels_are_named_beside_the_model() {
        let mut scene = scene();
        // A third panel of 1.5 mm beside squares of 100 mm.
        let mut slim = scene.panels[0].clone();
        slim.name = "A-03".into();
        for p in slim.mesh.positions.iter_mut().chain(slim.borders.iter_mut().flatten()) {
            *p = Vec3::new(200.0 + 0.015 * p.x, p.y, p.z);
        }
        slim.rulings.clear();
        scene.panels.push(slim);
        let caption = Caption { width: 600, ..Caption::default() };
        let with = panels(&scene, &Vec3::z(), &caption);
        scene.panels[2].name.clear();
        let without = panels(&scene, &Vec3::z(), &caption);
        assert!(with.pixels != without.pixels);
    }

    #[test]
    fn the_deviation_map_is_red_above_and_blue_below() {
        let image = deviation(&scene(), &direction(&scene()), 0.5, &Caption { width: 600, ..Caption::default() });
        assert!(share(&image, |[r, _, b]| r > b + 60) > 0.03);
        assert!(share(&image, |[r, _, b]| b > r + 60) > 0.03);
    }

    #[test]
    fn empty_scenes_and_layouts_give_a_picture_too() {
        let caption = Caption { width: 300, title: "nothing".into(), note: String::new() };
        assert!(panels(&Scene::default(), &Vec3::z(), &caption).height > 50);
        assert!(deviation(&Scene::default(), &Vec3::x(), 1.0, &caption).height > 50);
        assert!(layout(&[], &caption).height > 50);
    }

    #[test]
    fn long_titles_and_far_curves_stay_in_the_picture() {
        let caption = Caption { width: 600, title: "a title of many words ".repeat(8), note: "note ".repeat(60) };
        let mut scene = scene();
        scene.guides = vec![vec![Vec3::new(-400.0, -300.0, 0.0), Vec3::new(500.0, 400.0, 0.0)]];
        let image = panels(&scene, &Vec3::new(0.3, -0.2, 1.0), &caption);
        let paper = image.pixels[0];
        let (w, h) = (image.width, image.height);
        let edge = (0..w).flat_map(|x| [x, (h - 1) * w + x]).chain((0..h).flat_map(|y| [y * w, y * w + w - 1]));
        assert!(edge.into_iter().all(|i| image.pixels[i] == paper));
        assert!(image.pixels.iter().any(|p| *p == colour::bytes(GUIDE)));
    }

    #[test]
    fn figures_keep_their_digits() {
        assert_eq!(figure(12.3456, 3), "12.3");
        assert_eq!(figure(-0.0123456, 3), "\u{2212}0.0123");
        assert_eq!(figure(0.0, 3), "0");
        assert_eq!(figure(123_456.0, 3), "123456");
        assert_eq!(figure(3.2e-9, 2), "3.2e\u{2212}9");
        assert_eq!(figure(f64::INFINITY, 2), "\u{221e}");
    }
}
