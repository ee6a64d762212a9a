//! Parts in space beside their flat patterns: the patches of the panels as a parametrisation of both.
//!
//! *Method*. Every panel is developed anew from its patch: the isometric map of a ruled patch \[DC76\], or the chart of a face of
//! sheet metal on its neutral surface. Panels of one part are laid beside each other along their common rulings; then the
//! whole is moved onto the outline as drawn: first by area, centre and axes of inertia, then by the nearest points of the
//! outline, last by the corners, which are exact images.

mod inverse;

use super::align::{fitted, settled, Moments};
use super::drawn::FlatPart;
use crate::brep::body::{oriented, Body};
use crate::brep::face::Face;
use crate::brep::project::refine;
use crate::develop::map::Development;
use crate::develop::shop::thickness::SheetSide;
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::chart::Chart;
use crate::develop::unfold::placed_face::PlacedChart;
use crate::develop::unfold::region::Motion;
use crate::develop::unfold::tree::{unfold, Joins, UnfoldOptions};
use crate::geom::box_tree::BoxTree;
use crate::geom::inside::Inside;
use crate::geom::outline::Outline;
use crate::geom::polygon::{area, bounds, sides};
use crate::geom::{BBox, Vec2, Vec3};
use crate::spline::surface::Surface;
use std::sync::{Arc, OnceLock};

/// A panel as its file has it: a ruled patch and the region of its parameter plane.
#[derive(Clone, Debug)]
pub(crate) struct PanelPatch {
    /// Name.
    pub name: String,
    /// The patch, mm.
    pub surface: Surface,
    /// Polygons of the parameter plane that bound the panel.
    pub loops: Vec<Vec<[f64; 2]>>,
    /// Corners: ends of the edges.
    pub corners: Vec<[f64; 2]>,
}

/// How a panel is laid flat.
#[derive(Clone, Debug)]
enum Map {
    Developed(Box<Development>),
    Charted(Box<Chart>),
    /// Not at all: places are told by their parameters.
    Parameters,
}

/// A panel with its place in the plane.
#[derive(Clone, Debug)]
pub(crate) struct PlacedPanel {
    /// The panel.
    pub panel: PanelPatch,
    map: Map,
    own: Motion,
    /// The box around the patch.
    bounds: BBox,
    /// Images of the loops, after everything.
    flat: Vec<Vec<Vec2>>,
    seeds: Vec<([f64; 2], Vec2)>,
    /// The seeds in space.
    places: Vec<Vec3>,
    /// Sides of the loops in pieces that are nearly straight in space.
    border: Vec<BorderPiece>,
    /// What tells the nearest of both, and what lies within the loops; made when it is asked first.
    index: Arc<OnceLock<Index>>,
    /// The same of the images.
    outline: Arc<OnceLock<Outline>>,
    /// By how much a place may lie beyond the patch and still be on it: ahead of and behind it in both parameters.
    slack: [[f64; 2]; 2],
    /// First and last parameter of the rulings that its loops reach.
    ends: [f64; 2],
}

/// The seeds and the pieces of the border of a panel in space, and its loops.
#[derive(Debug)]
struct Index {
    places: BoxTree,
    border: BoxTree,
    region: Inside,
}

/// A piece of a panel's border: parameters and places of its ends.
#[derive(Clone, Copy, Debug)]
struct BorderPiece {
    uv: [[f64; 2]; 2],
    ends: [Vec3; 2],
}

impl BorderPiece {
    /// Share of the chord that is nearest to a point, and how far that is, mm.
    fn chord(&self, x: &Vec3) -> (f64, f64) {
        let way = self.ends[1] - self.ends[0];
        let share = ((x - self.ends[0]).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        let share = if share.is_finite() { share } else { 0.0 };
        (share, (self.ends[0] + way * share - x).norm())
    }

    /// Parameters of the place of the piece itself that is nearest to a point, and how far it is, mm.
    fn nearest(&self, surface: &Surface, x: &Vec3) -> ([f64; 2], f64) {
        let [a, b] = self.uv;
        let way = [0, 1].map(|d: usize| b[d] - a[d]);
        let at = |s: f64| [0, 1].map(|d: usize| a[d] + way[d] * s);
        let mut s = self.chord(x).0;
        let mut best = (at(s), f64::INFINITY);
        for _ in 0..STEPS {
            let uv = at(s);
            let j = surface.jet(uv[0], uv[1]);
            let off = (j.p - x).norm();
            if off >= best.1 {
                break;
            }
            best = (uv, off);
            let velocity = j.du * way[0] + j.dv * way[1];
            let step = (x - j.p).dot(&velocity) / velocity.norm_squared();
            if !step.is_finite() {
                break;
            }
            s = (s + step).clamp(0.0, 1.0);
        }
        best
    }
}

/// The panels of a part with their places in the plane.
#[derive(Clone, Debug)]
pub(crate) struct Atlas {
    /// The panels.
    pub panels: Vec<PlacedPanel>,
    mirrored: bool,
    motion: Motion,
    /// Diagonal (mm) of the box around the images of the panels.
    size: f64,
    /// Largest distance (mm) between corners of the panels and those of the outline as drawn; of the outline's joints from
    /// the panels' sides where fewer than two corners fit.
    pub alignment: f64,
}

/// A place on a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OnPanel {
    /// Index of the panel in the atlas.
    pub panel: usize,
    /// Parameters on its patch.
    pub uv: [f64; 2],
    /// Distance (mm) of what was asked for from this place, in space or in the plane.
    pub off: f64,
}

/// Why panels cannot be laid beside their pattern.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AtlasError {
    /// A patch that cannot be developed.
    #[error("panel {name} cannot be developed: {reason}")]
    Panel {
        /// Its name.
        name: String,
        /// Why.
        reason: String,
    },
    /// Panels of one part that have no ruling in common.
    #[error("panel {0} has no ruling in common with those before it")]
    Apart(String),
    /// Outlines that differ.
    #[error(
        "the outline drawn is {0:.4} mm from that of the panels laid side by side: one of both was changed, or the drawing has \
         them beside each other in another way"
    )]
    Differs(f64),
    /// No panel at all.
    #[error("it has no panels")]
    Empty,
}

/// Share of the size within which rulings of neighbours are one.
const JOINT: f64 = 1e-6;
/// Share of the size within which edges of panels are one: a panel ends a little before an apex.
const BESIDE: f64 = 2e-5;
/// Outlines that are farther from those of the panels (share of the size) do not belong to them.
const BELONGS: f64 = 2e-3;
/// Points on the image of a line over all rulings of a panel, if it is an arc.
const PARTS: f64 = 96.0;
/// Share of a line at which its image is compared with a chord: not in the middle, where waves may cross it.
const BETWEEN: f64 = 0.37;
/// Samples over a panel from which searches start.
const SEEDS: (usize, usize) = (40, 8);
/// Pieces of a border, the nearest by their chords, of which the nearest place is looked for.
const NEAREST_PIECES: usize = 4;
/// Seeds, the nearest in space, from which the nearest place is looked for.
const NEAREST_SEEDS: usize = 3;
/// Steps of Newton's method.
const STEPS: usize = 30;
/// Share of a patch by which a place may lie beyond an edge and still be on it: drawn outlines are a little off. Where an edge
/// is shorter than the next share of the other, as beside an apex, nothing may but beyond that other one.
const EDGE: f64 = 1e-3;
/// See [`EDGE`].
const TIP: f64 = 0.1;
/// Share of the size below which places have been found.
const FOUND: f64 = 1e-13;
/// Share of the size within which two corners of a panel are beside the tip of a cone.
const BESIDE_TIP: f64 = 1e-4;
/// Ratio of the moments of inertia from which on a part has a direction.
const LONG: f64 = 1.2;
/// Corners that tell how an outline lies, and points of it where there are fewer.
const ENOUGH_JOINTS: usize = 12;
/// See [`ENOUGH_JOINTS`].
const POINTS: usize = 300;
/// Directions that are tried for parts without one.
const DIRECTIONS: usize = 48;
/// Steps that bring an outline onto another, for a first look and at most.
const GLANCE: usize = 6;
/// See [`GLANCE`].
const ROUNDS: usize = 60;
/// Ways to lay an outline that are followed further: a square has four.
const MOST_WAYS: usize = 8;
/// Ways whose turns differ by less than a degree (cosine) lead to one.
const ONE_WAY: f64 = 0.999_85;
/// Candidates whose outlines fit so much worse than the best are no candidates.
const AS_GOOD: f64 = 3.0;

/// Points of a closed polygon at equal ways (mm) from each other: straight sides of a slit count as much as arcs.
fn at_ways(polygon: &[Vec2], way: f64) -> Vec<Vec2> {
    let mut out = Vec::new();
    // Way from the last point to the corner.
    let mut gone = way;
    for (p, q) in (0..polygon.len()).map(|k| (polygon[k], polygon[(k + 1) % polygon.len()])) {
        let length = (q - p).norm();
        let mut at = way - gone;
        while at < length {
            out.push(p + (q - p) * (at / length));
            at += way;
        }
        gone = length - (at - way);
    }
    out
}

/// By how much places may lie beyond a patch, see [`EDGE`].
fn slack(surface: &Surface) -> [[f64; 2]; 2] {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let length = |v: f64| -> f64 {
        let at = |k: usize| surface.point(u0 + (u1 - u0) * k as f64 / SEEDS.0 as f64, v);
        (0..SEEDS.0).map(|k| (at(k + 1) - at(k)).norm()).sum()
    };
    let (a, b) = (length(v0), length(v1));
    let (du, dv) = (EDGE * (u1 - u0), EDGE * (v1 - v0));
    if a.min(b) >= TIP * a.max(b) {
        [[du; 2], [dv; 2]]
    } else {
        [[0.0; 2], if a < b { [0.0, dv] } else { [dv, 0.0] }]
    }
}

impl PlacedPanel {
    fn new(panel: PanelPatch, map: Map, own: Motion) -> Self {
        let slack = slack(&panel.surface);
        let bounds = panel.surface.bbox();
        let (flat, seeds, places, border) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (index, outline, ends) = (Arc::default(), Arc::default(), [0.0; 2]);
        let mut out = Self { panel, map, own, bounds, flat, seeds, places, border, index, outline, slack, ends };
        out.flat = out.images();
        out.border = out.border_pieces();
        let start = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let b = out
            .panel
            .loops
            .iter()
            .flatten()
            .fold(start, |b, p| [b[0].min(p[0]), b[1].max(p[0]), b[2].min(p[1]), b[3].max(p[1])]);
        out.ends = [b[0], b[1]];
        for i in 0..=SEEDS.0 {
            for j in 0..=SEEDS.1 {
                let uv = [
                    b[0] + (b[1] - b[0]) * i as f64 / SEEDS.0 as f64,
                    b[2] + (b[3] - b[2]) * j as f64 / SEEDS.1 as f64,
                ];
                out.places.push(out.panel.surface.point(uv[0], uv[1]));
                out.seeds.push((uv, out.own_flat(uv)));
            }
        }
        out
    }

    /// Images of the loops, with points on sides that run over many rulings: these are arcs in the plane.
    fn images(&self) -> Vec<Vec<Vec2>> {
        let ((u0, u1), _) = self.panel.surface.domain();
        let side = |a: [f64; 2], b: [f64; 2]| {
            let place = move |x: f64| self.own_flat([0, 1].map(|d| a[d] + (b[d] - a[d]) * x));
            let [p, q, r] = [0.0, BETWEEN, 1.0].map(place);
            let straight = (r - p).perp(&(q - p)).abs() <= BESIDE * (r - p).norm_squared();
            let share = if straight { 0.0 } else { ((b[0] - a[0]) / (u1 - u0)).abs() };
            let parts = (PARTS * share).ceil().max(1.0) as usize;
            (0..parts).map(move |i| place(i as f64 / parts as f64))
        };
        let image = |l: &Vec<[f64; 2]>| (0..l.len()).flat_map(|k| side(l[k], l[(k + 1) % l.len()])).collect();
        self.panel.loops.iter().map(image).collect()
    }

    fn border_pieces(&self) -> Vec<BorderPiece> {
        let surface = &self.panel.surface;
        let ((u0, u1), (v0, v1)) = surface.domain();
        let side = |a: [f64; 2], b: [f64; 2]| {
            let share = ((b[0] - a[0]) / (u1 - u0)).abs().max(((b[1] - a[1]) / (v1 - v0)).abs());
            let parts = (PARTS * share).ceil().max(1.0) as usize;
            let at = move |i: usize| [0, 1].map(|d: usize| a[d] + (b[d] - a[d]) * i as f64 / parts as f64);
            (0..parts).map(move |i| [at(i), at(i + 1)])
        };
        let piece = |uv: [[f64; 2]; 2]| BorderPiece { uv, ends: uv.map(|c| surface.point(c[0], c[1])) };
        let loops = self.panel.loops.iter();
        loops.flat_map(|l| (0..l.len()).flat_map(|k| side(l[k], l[(k + 1) % l.len()])).map(piece)).collect()
    }

    fn index(&self) -> &Index {
        let polygon = |l: &Vec<[f64; 2]>| l.iter().map(|p| Vec2::new(p[0], p[1])).collect::<Vec<_>>();
        self.index.get_or_init(|| Index {
            places: BoxTree::new(self.places.len(), &|k| BBox::of(&self.places[k..=k])),
            border: BoxTree::new(self.border.len(), &|k| BBox::of(&self.border[k].ends)),
            region: Inside::of(&self.panel.loops.iter().map(polygon).collect::<Vec<_>>()),
        })
    }

    /// Seeds from which the nearest place to a point is looked for.
    fn near_seeds(&self, x: &Vec3) -> impl Iterator<Item = [f64; 2]> + '_ {
        let near = self.index().places.several(x, NEAREST_SEEDS, &|k| (self.places[k] - x).norm_squared());
        near.into_iter().map(|k| self.seeds[k].0)
    }

    /// Places on the border that are near a point: parameters, and how far (mm).
    fn near_border(&self, x: &Vec3) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
        let near = self.index().border.several(x, NEAREST_PIECES, &|k| self.border[k].chord(x).1.powi(2));
        let x = *x;
        near.into_iter().map(move |k| self.border[k].nearest(&self.panel.surface, &x))
    }

    /// Image before the whole is moved.
    fn own_flat(&self, uv: [f64; 2]) -> Vec2 {
        let p = match &self.map {
            Map::Developed(d) => d.map(uv[0], uv[1]),
            Map::Charted(c) => c.flat_at(uv, &self.panel.surface.point(uv[0], uv[1])),
            Map::Parameters => Vec2::new(uv[0], uv[1]),
        };
        self.own.apply(&p)
    }

    fn contains(&self, uv: [f64; 2]) -> bool {
        self.index().region.holds(&Vec2::new(uv[0], uv[1]))
    }
}

impl Atlas {
    /// Panels that share rulings, each after the one that it is joined to; a single panel is a chain of one. Drawn is what
    /// lies `beside` them (mm), on that side of the first patch to which `e × R_t` points (see [`Development::new`]).
    ///
    /// # Errors
    /// Patches that are not regular, panels that share no ruling with those before them.
    pub(crate) fn developed(panels: Vec<PanelPatch>, beside: f64) -> Result<Self, AtlasError> {
        let mut placed: Vec<PlacedPanel> = Vec::new();
        let size = panels.iter().map(|p| p.surface.bbox().diagonal()).fold(0.0, f64::max);
        for panel in panels {
            let map = |side: f64| {
                let fault = |e: crate::develop::DevelopError| AtlasError::Panel {
                    name: panel.name.clone(),
                    reason: e.to_string(),
                };
                Development::offset(&panel.surface, side, beside).map(|d| Map::Developed(Box::new(d))).map_err(fault)
            };
            if placed.is_empty() {
                let map = map(1.0)?;
                placed.push(PlacedPanel::new(panel, map, Motion::identity()));
                continue;
            }
            let joint = placed.iter().enumerate().rev().find_map(|(k, s)| Some((k, common(&s.panel, &panel, size)?)));
            let Some((k, [there, here])) = joint else { return Err(AtlasError::Apart(panel.name)) };
            let to = there.map(|uv| placed[k].own_flat(uv));
            let across = |s: &PlacedPanel| {
                let l: Vec<Vec2> = s.flat.iter().flatten().copied().collect();
                (to[1] - to[0]).perp(&(l.iter().sum::<Vec2>() / l.len() as f64 - to[0]))
            };
            // Seen from the same side the neighbours lie on both sides of the ruling.
            let mut laid = None;
            for side in [1.0, -1.0] {
                let one = PlacedPanel::new(panel.clone(), map(side)?, Motion::identity());
                let from = here.map(|uv| one.own_flat(uv));
                let Some(own) = Motion::between(from, to) else { continue };
                let one = PlacedPanel::new(panel.clone(), one.map, own);
                if across(&one) * across(&placed[k]) < 0.0 {
                    laid = Some(one);
                    break;
                }
            }
            placed.push(laid.ok_or(AtlasError::Apart(panel.name))?);
        }
        Self::of(placed)
    }

    /// Faces of one sheet, with the thickness (mm, 0 for surfaces) of every one below the skin given, or as the side of a sheet, laid
    /// flat to a tolerance (mm) as they were: faces without a closed form are laid in strips that depend on it.
    ///
    /// # Errors
    /// Faces that cannot be laid beside each other.
    pub(crate) fn unfolded(
        faces: &[Face],
        k: &KFactor,
        (thickness, side): (Vec<f64>, Option<SheetSide>),
        tolerance: f64,
    ) -> Result<Self, AtlasError> {
        // Files may turn some faces of a sheet round, as those that it was made of were.
        let given = Body::joined(faces.iter().collect(), BESIDE);
        let turned = oriented(&given);
        let body = turned.as_ref().map_or(given, |all| Body::joined(all.iter().collect(), BESIDE));
        let skin: Vec<usize> = (0..faces.len()).collect();
        let asked = UnfoldOptions { k: k.clone(), tolerance, thickness, side, joins: Joins::All };
        let (pieces, left) = unfold(&body, &skin, &asked);
        if let Some(f) = left.first().map(|k| &faces[*k]) {
            return Err(AtlasError::Panel { name: f.name.clone(), reason: "it has no closed chart".into() });
        }
        let mut pieces = pieces.into_iter();
        let piece = pieces.next().ok_or(AtlasError::Empty)?;
        if let Some(f) = pieces.next().and_then(|p| p.faces.first().map(|f| &faces[f.face])) {
            return Err(AtlasError::Apart(f.name.clone()));
        }
        let placed = piece
            .faces
            .into_iter()
            .map(|p| PlacedPanel::new(of_face(&faces[p.face]), Map::Charted(Box::new(p.chart)), p.motion));
        Self::of(placed.collect())
    }

    /// Faces where their charts have laid them.
    ///
    /// # Errors
    /// No face.
    pub(crate) fn placed<'a>(faces: impl Iterator<Item = (&'a Face, &'a PlacedChart)>) -> Result<Self, AtlasError> {
        let placed = |(f, c): (&Face, &PlacedChart)| {
            PlacedPanel::new(of_face(f), Map::Charted(Box::new(c.chart.clone())), c.motion)
        };
        Self::of(faces.map(placed).collect())
    }

    /// One panel where its development has laid it.
    pub(crate) fn mapped(panel: PanelPatch, map: Development) -> Self {
        let panels = vec![PlacedPanel::new(panel, Map::Developed(Box::new(map)), Motion::identity())];
        Self::lying(panels, 0.0)
    }

    /// A face by its parameters, for places in space alone.
    pub(crate) fn of_parameters(face: &Face) -> Self {
        let panels = vec![PlacedPanel::new(of_face(face), Map::Parameters, Motion::identity())];
        Self::lying(panels, 0.0)
    }

    fn of(panels: Vec<PlacedPanel>) -> Result<Self, AtlasError> {
        match panels.is_empty() {
            true => Err(AtlasError::Empty),
            false => Ok(Self::lying(panels, f64::NAN)),
        }
    }

    fn moved(&self, q: &Vec2) -> Vec2 {
        self.motion.apply(&if self.mirrored { Vec2::new(-q.x, q.y) } else { *q })
    }

    fn moved_back(&self, q: &Vec2) -> Vec2 {
        let p = self.motion.back(q);
        if self.mirrored {
            Vec2::new(-p.x, p.y)
        } else {
            p
        }
    }

    /// Place in the drawing of a place on a panel.
    pub(crate) fn flat(&self, on: &OnPanel) -> Vec2 {
        self.moved(&self.panels[on.panel].own_flat(on.uv))
    }

    /// Place in space of a place on a panel.
    pub(crate) fn space(&self, on: &OnPanel) -> Vec3 {
        self.panels[on.panel].panel.surface.point(on.uv[0], on.uv[1])
    }

    /// The place on the panels of a point of the drawing: on the panel whose region holds it, else on the nearest one.
    pub(crate) fn at_flat(&self, q: &Vec2) -> Option<OnPanel> {
        let own = self.moved_back(q);
        let order = |s: &PlacedPanel| s.outline.get_or_init(|| Outline::of(&s.flat)).off(&own);
        let mut near: Vec<(f64, usize)> = self.panels.iter().map(order).zip(0..).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (_, panel) = *near.first()?;
        let (uv, off) = self.panels[panel].inverse(&own, self.size);
        Some(OnPanel { panel, uv, off })
    }

    /// Parameters on a panel of a point of the drawing, beyond its edges too.
    pub(crate) fn on_panel(&self, panel: usize, q: &Vec2) -> [f64; 2] {
        self.panels[panel].inverse(&self.moved_back(q), self.size).0
    }

    /// The place of a point in space near another one on the same panel; `None` where that lies beyond its edges.
    pub(crate) fn beside(&self, x: &Vec3, on: &OnPanel) -> Option<OnPanel> {
        let panel = &self.panels[on.panel];
        let at = refine(&panel.panel.surface, x, on.uv);
        panel.contains(at.at).then_some(OnPanel { panel: on.panel, uv: at.at, off: at.distance })
    }

    /// How far (mm) a point in space is from a place on a panel, along the panel: beyond its edge, where that is the nearest place.
    pub(crate) fn along(&self, x: &Vec3, on: &OnPanel) -> f64 {
        let j = self.panels[on.panel].panel.surface.jet(on.uv[0], on.uv[1]);
        let way = x - j.p;
        j.du.cross(&j.dv).try_normalize(0.0).map_or(0.0, |n| (way - n * n.dot(&way)).norm())
    }

    /// How far (mm) a place on a panel is beyond its edge.
    pub(crate) fn over(&self, on: &OnPanel) -> f64 {
        let panel = &self.panels[on.panel];
        if panel.contains(on.uv) {
            return 0.0;
        }
        let x = self.space(on);
        panel.near_border(&x).map(|p| p.1).fold(f64::INFINITY, f64::min)
    }

    /// The nearest place on the panels of a point in space, within their edges.
    pub(crate) fn at_space(&self, x: &Vec3) -> Option<OnPanel> {
        self.within(x, f64::INFINITY)
    }

    /// The same on panels whose boxes are within `reach` (mm).
    pub(crate) fn within(&self, x: &Vec3, reach: f64) -> Option<OnPanel> {
        let mut best: Option<OnPanel> = None;
        let away = |b: &BBox| (b.min - x).sup(&(x - b.max)).sup(&Vec3::zeros()).norm();
        let mut order: Vec<(f64, usize)> = self.panels.iter().map(|s| away(&s.bounds)).zip(0..).collect();
        order.retain(|o| o.0 <= reach);
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (least, panel) in order {
            if best.is_some_and(|b| b.off < least) {
                break;
            }
            let s = &self.panels[panel];
            let mut offer = |uv: [f64; 2], off: f64| {
                if best.is_none_or(|b| off < b.off) {
                    best = Some(OnPanel { panel, uv, off });
                }
            };
            for seed in s.near_seeds(x) {
                let at = refine(&s.panel.surface, x, seed);
                if s.contains(at.at) {
                    offer(at.at, at.distance);
                }
            }
            s.near_border(x).for_each(|(uv, off)| offer(uv, off));
        }
        best
    }

    /// Panels as they lie.
    fn lying(panels: Vec<PlacedPanel>, alignment: f64) -> Self {
        let start = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        let boxes = panels.iter().map(|s| bounds(&s.flat));
        let (lo, hi) = boxes.fold(start, |(l, h), (a, b)| (l.inf(&a), h.sup(&b)));
        Self { panels, mirrored: false, motion: Motion::identity(), size: (hi - lo).norm(), alignment }
    }

    /// All ways to lay the panels onto an outline, the best first; mirror images and turns that fit as well are all there.
    ///
    /// # Errors
    /// Outlines that do not fit in any way.
    pub(crate) fn aligned(&self, part: &FlatPart) -> Result<Vec<Self>, AtlasError> {
        let size = part.size();
        let own: Vec<Vec<Vec2>> = self.panels.iter().flat_map(|s| s.flat.clone()).collect();
        let there = Moments::of(&part.loops, &vec![1.0; part.loops.len()]);
        // Few corners fit in many ways, and those of parts without a direction too, as on the rim of a cone laid flat: then points of
        // the outline count.
        let few = part.joints.iter().map(Vec::len).sum::<usize>() < ENOUGH_JOINTS || there.ratio <= LONG;
        let way = sides(&part.loops).map(|(p, q)| (q - p).norm()).sum::<f64>() / POINTS as f64;
        let points: Vec<Vec<Vec2>> = match few {
            true => part.loops.iter().map(|l| at_ways(l, way)).collect(),
            false => part.joints.clone(),
        };
        // How well all points fit, and those that count.
        let mut found: Vec<(f64, f64, Self)> = Vec::new();
        for mirrored in [false, true] {
            let flip = |p: &Vec2| if mirrored { Vec2::new(-p.x, p.y) } else { *p };
            let loops: Vec<Vec<Vec2>> = own.iter().map(|l| l.iter().map(flip).collect()).collect();
            let weights: Vec<f64> = self
                .panels
                .iter()
                .flat_map(|s| {
                    let sign = s.flat.iter().map(|l| area(l)).sum::<f64>().signum() * if mirrored { -1.0 } else { 1.0 };
                    vec![sign; s.flat.len()]
                })
                .collect();
            let (here, outline) = (Moments::of(&loops, &weights), Outline::of(&loops));
            let turns: Vec<f64> = if there.ratio > LONG {
                vec![there.angle - here.angle, there.angle - here.angle + std::f64::consts::PI]
            } else {
                (0..DIRECTIONS).map(|k| std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).collect()
            };
            let start = |turn: f64| {
                let (s, c) = turn.sin_cos();
                let only = Motion { turn: [c, s], shift: Vec2::zeros() };
                Motion { turn: [c, s], shift: there.centre - only.apply(&here.centre) }
            };
            // A few steps tell the ways that are worth more.
            let mut tried: Vec<(f64, Motion)> = turns
                .into_iter()
                .map(|turn| settled(&outline, start(turn), &points, GLANCE))
                .map(|(motion, off)| (off, motion))
                .collect();
            tried.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut ways: Vec<Motion> = Vec::new();
            for (_, way) in tried {
                let alike = |m: &Motion| {
                    m.turn[0] * way.turn[0] + m.turn[1] * way.turn[1] > ONE_WAY
                        && (m.shift - way.shift).norm() < BELONGS * size
                };
                if ways.len() < MOST_WAYS && !ways.iter().any(alike) {
                    ways.push(way);
                }
            }
            for start in ways {
                let (motion, fit) = settled(&outline, start, &points, ROUNDS);
                // Corners are exact, other points are on chords. But corners of a ring are on its circles anywhere.
                let (motion, off) = if few { settled(&outline, motion, &part.joints, ROUNDS) } else { (motion, fit) };
                found.push((fit.max(off), off, Self { mirrored, motion, alignment: off, ..self.clone() }));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = found.first().map_or(f64::INFINITY, |f| f.0);
        if best.is_nan() || best > BELONGS * size {
            return Err(AtlasError::Differs(best));
        }
        let floor = JOINT * size;
        let mut out: Vec<Self> = Vec::new();
        for (_, off, mut a) in found.into_iter().filter(|f| f.0 <= AS_GOOD * best + floor) {
            a.snap(part, off + floor);
            let same = |b: &Self| {
                b.mirrored == a.mirrored
                    && (b.motion.shift - a.motion.shift).norm() < 10.0 * (off + floor)
                    && (b.motion.turn[0] * a.motion.turn[0] + b.motion.turn[1] * a.motion.turn[1]) > ONE_WAY
            };
            if !out.iter().any(same) {
                out.push(a);
            }
        }
        // Where all fit alike, the outline begins where the first panel's does.
        let first = |a: &Self| match (a.panels[0].panel.corners.first(), part.joints.first().and_then(|j| j.first())) {
            (Some(uv), Some(j)) => (a.flat(&OnPanel { panel: 0, uv: *uv, off: 0.0 }) - j).norm(),
            _ => 0.0,
        };
        out.sort_by(|a, b| first(a).total_cmp(&first(b)));
        Ok(out)
    }

    /// Brings corners onto those of the outline, which are their exact images.
    fn snap(&mut self, part: &FlatPart, near: f64) {
        let mut pairs: Vec<(Vec2, Vec2)> = Vec::new();
        let mut tips: Vec<(Vec2, Vec2)> = Vec::new();
        let short = BESIDE_TIP * self.size;
        for s in &self.panels {
            let corners: Vec<Vec2> = s.panel.corners.iter().map(|uv| s.own_flat(*uv)).collect();
            let beside = |p: &Vec2| corners.iter().filter(|q| (*q - p).norm() <= short).count() > 1;
            for corner in &corners {
                let own = if self.mirrored { Vec2::new(-corner.x, corner.y) } else { *corner };
                let at = self.motion.apply(&own);
                let nearest = part.joints.iter().flatten().min_by(|a, b| (*a - at).norm().total_cmp(&(*b - at).norm()));
                if let Some(j) = nearest.filter(|j| (*j - at).norm() <= 4.0 * near) {
                    if beside(corner) { &mut tips } else { &mut pairs }.push((own, *j));
                }
            }
        }
        // Panels end a hair before their tips, where the drawing has one corner: these count where there are no others.
        if pairs.len() <= 2 {
            pairs.append(&mut tips);
        }
        // Corners of which the nearest joint is another one are told by their distance after a first fit.
        for _ in 0..3 {
            let Some(motion) = fitted(&pairs) else { return };
            let mut off: Vec<f64> = pairs.iter().map(|(a, b)| (motion.apply(a) - b).norm()).collect();
            (self.motion, self.alignment) = (motion, off.iter().copied().fold(0.0, f64::max));
            off.sort_by(f64::total_cmp);
            let median = off[off.len() / 2];
            let kept: Vec<(Vec2, Vec2)> = pairs
                .iter()
                .filter(|(a, b)| (motion.apply(a) - b).norm() <= 4.0 * median + FOUND * near.max(1.0))
                .copied()
                .collect();
            if kept.len() == pairs.len() || kept.len() < 2 {
                return;
            }
            pairs = kept;
        }
    }
}

/// A face as a panel.
pub(crate) fn of_face(face: &Face) -> PanelPatch {
    let corner = |l: &crate::brep::face::TrimLoop| {
        let n = l.points.len();
        (0..n).filter(|k| l.edge[*k] != l.edge[(k + n - 1) % n]).map(|k| l.points[k]).collect::<Vec<_>>()
    };
    PanelPatch {
        name: face.name.clone(),
        surface: face.surface.clone(),
        loops: face.loops.iter().map(|l| l.points.clone()).collect(),
        corners: face.loops.iter().flat_map(corner).collect(),
    }
}

/// The ruling that two panels have in common: its ends in the parameters of both.
fn common(a: &PanelPatch, b: &PanelPatch, size: f64) -> Option<[[[f64; 2]; 2]; 2]> {
    let ends = |p: &PanelPatch| {
        let n = p.corners.len();
        (0..n).map(|k| [p.corners[k], p.corners[(k + 1) % n]]).collect::<Vec<_>>()
    };
    let near =
        |p: [f64; 2], q: [f64; 2]| (a.surface.point(p[0], p[1]) - b.surface.point(q[0], q[1])).norm() <= JOINT * size;
    for x in ends(a) {
        for y in ends(b) {
            let long = (a.surface.point(x[0][0], x[0][1]) - a.surface.point(x[1][0], x[1][1])).norm() > JOINT * size;
            if !long {
                continue;
            }
            if near(x[0], y[0]) && near(x[1], y[1]) {
                return Some([x, y]);
            }
            if near(x[0], y[1]) && near(x[1], y[0]) {
                return Some([x, [y[1], y[0]]]);
            }
        }
    }
    None
}
