//! Points, texts and curves carried between parts in space and their flat patterns, by the map of the panels' patches \[DC76\].
//!
//! A point in space goes to its nearest place on a panel within its edges and from there to the drawing by the isometric map
//! that made it, laid onto the outline as written; the way back is the same map inverted by Newton's method. Texts are carried
//! with the direction in which they are read (`items.rs`), curves as polylines (`followed.rs`).

use super::atlas::Atlas;
use super::drawn::FlatPart;
use crate::geom::box_tree::BoxTree;
use crate::geom::outline::Outline;
use crate::geom::{BBox, Vec2, Vec3};
use crate::num::parallel;
use crate::spline::curve::Curve;

/// Where artwork is carried to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// To the flat patterns.
    Flat,
    /// To the parts in space.
    Space,
}

/// A part ready to carry artwork.
#[derive(Clone, Debug)]
pub struct MapPart {
    /// Name.
    pub name: String,
    /// Its drawing.
    pub(crate) flat: FlatPart,
    /// The outlines of that.
    outline: Outline,
    /// Its panels in space and laid flat.
    pub(crate) atlas: Atlas,
    /// Box around its panels.
    pub(super) bounds: BBox,
    /// Distance (mm) of the panels' corners from the outline drawn: what places in the drawing may be off.
    pub alignment: f64,
}

/// The parts of a result.
#[derive(Clone, Debug)]
pub struct ArtworkMap {
    /// Parts that can be used.
    pub parts: Vec<MapPart>,
    /// Over the parts as drawn.
    drawn: BoxTree,
    /// Parts that cannot, with the reason.
    pub left: Vec<(String, String)>,
    /// Distance (mm) within which a point is on a part.
    pub within: f64,
    /// Distance (mm) that polylines may keep from the images of curves, looked at between their points.
    pub chord: f64,
}

/// A point that was carried over, or what keeps it from being.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRow {
    /// Line of the input.
    pub line: usize,
    /// Name of the part.
    pub part: String,
    /// Its place on the other side, mm; `None` for points on no part.
    pub place: Option<Vec3>,
    /// Distance from the part, mm.
    pub distance: f64,
}

/// How something is drawn, as its drawing has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Layer.
    pub layer: String,
    /// Number of its colour; `None` for that of the layer.
    pub colour: Option<i32>,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Words {
    /// The text.
    pub text: String,
    /// Where it stands, mm.
    pub at: Vec3,
    /// Unit direction in which it is read.
    pub way: Vec3,
    /// Unit normal of its plane, towards who reads it.
    pub normal: Vec3,
    /// Height of its letters, mm.
    pub height: f64,
    /// Width of its letters as a share of the usual one.
    pub stretch: f64,
    /// Slant of its letters, degrees.
    pub slant: f64,
    /// Which place of the text its own place is, across and upwards, as drawings number these.
    pub held: [i32; 2],
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Curves that follow each other, homogeneous, mm.
    Curves(Vec<Curve<4>>),
    /// A point, mm.
    Point(Vec3),
    /// A text.
    Words(Words),
}

/// One thing of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it is called, for messages.
    pub name: String,
    /// How it is drawn.
    pub style: Style,
    /// What it is.
    pub shape: Shape,
}

/// What something of a drawing has become.
#[derive(Clone, Debug, PartialEq)]
pub enum PlacedShape {
    /// A polyline, mm; a closed one goes back to its first point.
    Line {
        /// Its points.
        points: Vec<Vec3>,
        /// Whether it is closed.
        closed: bool,
    },
    /// A point, mm.
    Point(Vec3),
    /// A text.
    Words(Words),
}

/// Something that was carried over, on one part.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// Name of the part.
    pub part: String,
    /// How it is drawn.
    pub style: Style,
    /// What it is.
    pub shape: PlacedShape,
}

/// What became of one thing of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Carried {
    /// On parts.
    pub placed: Vec<Placed>,
    /// What lies on no part.
    pub off: Option<Off>,
}

/// What of something lies on no part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Off {
    /// Its length (mm, about); 0 for points and texts.
    pub length: f64,
    /// Its largest distance from the nearest part, mm; infinite where none has a place for it.
    pub farthest: f64,
}

/// Share of a part's size by which places may lie beyond its edges and still be on it: what its outline as drawn leaves open.
const HAIR: f64 = 1e-7;

/// A place found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Number of the part.
    pub part: usize,
    /// The place on the other side.
    pub place: Vec3,
    /// Distance from the part, mm.
    pub off: f64,
    /// Whether the nearest place of the part is on its edge, and the point beyond that.
    pub beyond: bool,
}

impl MapPart {
    /// A part of its drawing and of its panels.
    pub(crate) fn new(name: String, flat: FlatPart, atlas: Atlas) -> Self {
        let mut bounds = BBox::empty();
        for b in atlas.panels.iter().map(|s| s.panel.surface.bbox()) {
            bounds.include(&b.min);
            bounds.include(&b.max);
        }
        Self { name, alignment: atlas.alignment, outline: Outline::of(&flat.loops), flat, atlas, bounds }
    }
}

impl ArtworkMap {
    /// A map of parts that can be used and names of those that cannot, see its fields.
    pub(crate) fn new(parts: Vec<MapPart>, left: Vec<(String, String)>, within: f64, chord: f64) -> Self {
        let drawn = BoxTree::new(parts.len(), &|k| BBox::of_flat(parts[k].flat.loops.iter().flatten()));
        Self { parts, drawn, left, within, chord }
    }

    /// The nearest part of a point, its place on the other side, and how far off the point is.
    pub(super) fn nearest(&self, x: &Vec3, to: Side) -> Option<Found> {
        match to {
            Side::Flat => self.in_plane(x),
            Side::Space => self.in_space(&x.xy()),
        }
    }

    fn in_plane(&self, x: &Vec3) -> Option<Found> {
        let mut best: Option<Found> = None;
        let away = |b: &BBox| (b.min - x).sup(&(x - b.max)).sup(&Vec3::zeros()).norm();
        let mut order: Vec<(f64, usize)> = self.parts.iter().map(|p| away(&p.bounds)).zip(0..).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (least, part) in order {
            if best.as_ref().is_some_and(|b| b.off <= least) {
                break;
            }
            let atlas = &self.parts[part].atlas;
            let Some(on) = atlas.at_space(x) else { continue };
            if best.as_ref().is_none_or(|b| on.off < b.off) {
                let q = atlas.flat(&on);
                let beyond = atlas.along(x, &on) > self.hair(part);
                best = Some(Found { part, place: Vec3::new(q.x, q.y, 0.0), off: on.off, beyond });
            }
        }
        best
    }

    fn in_space(&self, q: &Vec2) -> Option<Found> {
        let off = |part: usize| self.parts[part].outline.off(q);
        let (part, _) = self.drawn.nearest(&Vec3::new(q.x, q.y, 0.0), &|part| off(part).powi(2))?;
        let atlas = &self.parts[part].atlas;
        let on = atlas.at_flat(q)?;
        let off = off(part).max(on.off);
        // Outlines as drawn run a little beside the edges of panels.
        let beyond = off.max(atlas.over(&on)) > self.hair(part);
        Some(Found { part, place: atlas.space(&on), off, beyond })
    }

    /// By how much (mm) places may lie beyond the edges of a part.
    fn hair(&self, part: usize) -> f64 {
        let part = &self.parts[part];
        HAIR * part.bounds.diagonal() + part.alignment + part.flat.chords
    }

    /// Carries points over, each with its line.
    pub fn points(&self, points: &[(usize, Vec3)], to: Side) -> Vec<PointRow> {
        let row = |(line, x): &(usize, Vec3)| match self.nearest(x, to) {
            Some(f) => {
                let on = f.off <= self.within;
                let part = if on { self.parts[f.part].name.clone() } else { String::new() };
                PointRow { line: *line, part, place: on.then_some(f.place), distance: f.off }
            }
            None => PointRow { line: *line, part: String::new(), place: None, distance: f64::INFINITY },
        };
        parallel::map(points.iter(), row)
    }
}
