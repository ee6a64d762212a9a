//! Curves of the model that lie on the faces of a part, as lines on its flat pattern.
//!
//! *Method*. A curve is followed from point to point, each pulled to the nearest place of the faces within their edges and from
//! there mapped to the plane by the maps that laid the part flat. Where it leaves the faces, and where its image leaps because
//! the part is cut open there, its ends are found by halving; between them chords are halved until they keep to a distance. Lines and
//! arcs are drawn for them ([`super::marked`]); how far these are off is the sum of what chords and they are.
//! What lies on a face that a panel covers has its foot on the panel; what lies on the other skin of a sheet, on that which is laid
//! flat, a thickness away along the normal.
//! Everything here is measured, not proven.

use super::marked::marked;
use super::refold::atlas::{Atlas, OnPanel};
use super::shop::roll::outlines;
use super::shop::sections::clipped;
use crate::brep::face::Face;
use crate::geom::outline::Outline;
use crate::geom::segment::foot;
use crate::geom::{BBox, Vec2, Vec3};
use crate::patchwork::pattern::{MarkLine, Pattern};
use crate::spline::curve::Curve;
use crate::torse::rail::{jet, span_length};

/// A part that curves are carried to.
pub(crate) struct Target {
    atlas: Atlas,
    bounds: BBox,
    /// Outlines of its pattern as polygons, and how far (mm) these may be off.
    loops: Vec<Vec<Vec2>>,
    outline: Outline,
    rough: f64,
    /// Distance (mm) that images on both sides of a sharp bend may be apart.
    leap: f64,
    /// The face that the part covers as a panel, and how far (mm) it may be from that.
    ground: Option<(Atlas, f64)>,
    /// Where the other skin of the sheet is, for every face: its distance (mm) along the normal; none of surfaces.
    other_skin: Vec<f64>,
}

/// The skin of a sheet on which curves are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Skin {
    /// That which is laid flat.
    Laid,
    /// The other one.
    Other,
}

/// A curve as it is followed: its parameter is the number of the piece and a share of its domain.
pub(crate) struct Path<'a> {
    pieces: &'a [Curve<4>],
    at: Vec<f64>,
    bounds: BBox,
}

/// How curves are carried over.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarryOptions {
    /// Distance (mm) within which a point is on a face; no default.
    pub within: f64,
    /// Distance (mm) of lines drawn from the images of curves; no default.
    pub chord: f64,
    /// On which skin; no default.
    pub skin: Skin,
}

/// What a curve leaves on a part.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carried {
    /// Its lines, without labels.
    pub lines: Vec<MarkLine>,
    /// Whether it has stretches along the outline, which are none of these: they are cut anyway.
    pub along_edge: bool,
    /// Greatest distance (mm) of its points from the faces, and of the lines from its image, measured.
    pub distance: f64,
    /// See `distance`.
    pub deviation: f64,
    /// Which points of the path lie on the part.
    pub on: Vec<bool>,
}

/// A point of a path, and its place on a part.
#[derive(Clone, Copy)]
struct Spot {
    s: f64,
    x: Vec3,
    place: Option<(OnPanel, Vec2)>,
}

/// Steps over the extent of a curve, and on every span of its knots at least and at most.
const STEPS: f64 = 48.0;
/// See [`STEPS`].
const PER_SPAN: (usize, usize) = (2, 400);
/// Halvings with which ends are found: what doubles can tell.
const HALVINGS: usize = 48;
/// Points of one curve on one part that are looked for between its first ones at most.
const MOST_POINTS: usize = 20_000;
/// Halvings of a chord at most.
const DEEPEST: usize = 20;
/// Shares of a chord at which it is compared with the image.
const BETWEEN: [f64; 3] = [0.27, 0.5, 0.73];
/// Factor by which an image may be longer than the curve where nothing is cut: the neutral fibre of a tight bend is longer than
/// its inside.
const STRETCH: f64 = 4.0;
/// Distance from the outline within which a line runs along it, against what both may be off.
const ALONG: f64 = 2.0;
/// Length against the distance within which points are on a face below which lines are no more than where a curve comes through a
/// face or to a cut.
const STUB: f64 = 10.0;
/// Half the length of the lines of a cross against the part's length.
const ARM: f64 = 0.01;

impl<'a> Path<'a> {
    /// Pieces of a curve, in order.
    pub fn new(pieces: &'a [Curve<4>]) -> Self {
        let place = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
        let points: Vec<Vec3> = pieces.iter().flat_map(|c| c.control.iter().map(place)).collect();
        let bounds = BBox::of(&points);
        let step = bounds.diagonal() / STEPS;
        let mut at = Vec::new();
        for (k, c) in pieces.iter().enumerate() {
            let (from, to) = c.knots.domain();
            for w in c.knots.breaks().windows(2) {
                let parts = ((span_length(c, w[0], w[1]) / step).ceil() as usize).clamp(PER_SPAN.0, PER_SPAN.1);
                let share = |i: usize| (w[0] + (w[1] - w[0]) * i as f64 / parts as f64 - from) / (to - from);
                at.extend((0..parts).map(|i| k as f64 + share(i)));
            }
        }
        at.push(pieces.len() as f64);
        Self { pieces, at, bounds }
    }

    fn point(&self, s: f64) -> Vec3 {
        let k = (s.floor() as usize).min(self.pieces.len().saturating_sub(1));
        let (from, to) = self.pieces[k].knots.domain();
        jet(&self.pieces[k], from + (to - from) * (s - k as f64).clamp(0.0, 1.0))[0]
    }

    /// The points by which it is followed first.
    pub fn points(&self) -> Vec<Vec3> {
        self.at.iter().map(|s| self.point(*s)).collect()
    }
}

impl Target {
    /// A part with its maps, and by how much (mm) its faces are apart in the plane along sharp bends.
    pub fn new(atlas: Atlas, pattern: &Pattern, leap: f64) -> Self {
        let mut bounds = BBox::empty();
        for b in atlas.panels.iter().map(|s| s.panel.surface.bbox()) {
            bounds.include(&b.min);
            bounds.include(&b.max);
        }
        let size = pattern.length.max(pattern.area.sqrt());
        let (loops, rough) = (outlines(pattern, size), pattern.contour_error.max(0.0));
        let outline = Outline::of(&loops);
        Self { atlas, bounds, loops, outline, rough, leap, ground: None, other_skin: Vec::new() }
    }

    /// The same part of a sheet, the other skin of which is so far (mm) along the normals of its faces, in their order.
    pub fn of_sheet(self, other_skin: Vec<f64>) -> Self {
        Self { other_skin, ..self }
    }

    /// The same part as a panel that covers a face within a distance (mm): what lies on the face is on the panel where its foot is.
    pub fn covering(self, face: &Face, within: f64) -> Self {
        let mut bounds = self.bounds;
        let own = face.surface.bbox();
        [own.min, own.max].iter().for_each(|p| bounds.include(p));
        Self { bounds, ground: Some((Atlas::of_parameters(face), within)), ..self }
    }

    /// Whether it has another skin.
    pub fn is_sheet(&self) -> bool {
        !self.other_skin.is_empty()
    }

    /// How far (mm) the skin may be from the faces.
    fn depth(&self, skin: Skin) -> f64 {
        match skin {
            Skin::Laid => 0.0,
            Skin::Other => self.other_skin.iter().fold(0.0, |m, d| m.max(d.abs())),
        }
    }

    /// A place told from the skin: what is off it; `None` where there is none.
    fn on_skin(&self, x: &Vec3, on: OnPanel, skin: Skin) -> Option<OnPanel> {
        if skin == Skin::Laid {
            return Some(on);
        }
        let jet = self.atlas.panels[on.panel].panel.surface.jet(on.uv[0], on.uv[1]);
        let normal = jet.normal().try_normalize(0.0)?;
        let there = jet.p + normal * *self.other_skin.get(on.panel)?;
        Some(OnPanel { off: (x - there).norm(), ..on })
    }

    /// Distance (mm) of a point from the box around the part.
    pub fn away(&self, x: &Vec3) -> f64 {
        (self.bounds.min - x).sup(&(x - self.bounds.max)).sup(&Vec3::zeros()).norm()
    }

    /// Distance (mm) of a point from the part, or from the face that it covers.
    pub fn distance(&self, x: &Vec3) -> f64 {
        self.ground.as_ref().map_or(&self.atlas, |g| &g.0).at_space(x).map_or(f64::INFINITY, |on| on.off)
    }

    /// A point as a cross of two lines on the pattern, as far as these are inside it, and its distance (mm) from the part; `None`
    /// where it lies on no face.
    pub fn cross(&self, x: &Vec3, within: f64, skin: Skin) -> Option<(Vec<Vec<Vec2>>, f64)> {
        let (on, p) = self.spot(0.0, *x, None, (within, skin)).place?;
        let all = self.loops.iter().flatten();
        let (low, high) = all.fold((p, p), |(l, h), q| (l.inf(q), h.sup(q)));
        let arm = ARM * (high - low).norm();
        let line = |d: Vec2| clipped(&[p - d, p + d], &self.loops);
        Some(([line(Vec2::new(arm, 0.0)), line(Vec2::new(0.0, arm))].concat(), on.off))
    }

    /// The strokes of a text (from the beginning of its base line, mm) on the pattern, as far as they are inside it, where its base
    /// line begins and goes `ahead` from there, and the distance (mm) of that place from the part; `None` where it lies on no face.
    pub fn text(
        &self,
        (at, ahead): (&Vec3, &Vec3),
        strokes: &[Vec<Vec2>],
        (within, skin): (f64, Skin),
    ) -> Option<(Vec<Vec<Vec2>>, f64)> {
        let first = self.spot(0.0, *at, None, (within, skin));
        let (on, p) = first.place?;
        let way = [1.0, -1.0].into_iter().find_map(|sign| {
            let next = self.spot(0.0, at + ahead * sign, Some(&first), (within, skin)).place?.1;
            ((next - p) * sign).try_normalize(0.0)
        })?;
        let up = Vec2::new(-way.y, way.x);
        let line = |l: &Vec<Vec2>| -> Vec<Vec2> { l.iter().map(|q| p + way * q.x + up * q.y).collect() };
        Some((strokes.iter().flat_map(|l| clipped(&line(l), &self.loops)).collect(), on.off))
    }

    /// The lines of a curve.
    pub fn carried(&self, path: &Path, options: &CarryOptions) -> Carried {
        let gap = (self.bounds.min - path.bounds.max).sup(&(path.bounds.min - self.bounds.max)).max();
        if gap > options.within + self.depth(options.skin) {
            return Carried { on: vec![false; path.at.len()], ..Carried::default() };
        }
        let mut spots: Vec<Spot> = Vec::with_capacity(path.at.len());
        for s in &path.at {
            let before = spots.last().copied();
            spots.push(self.spot(*s, path.point(*s), before.as_ref(), (options.within, options.skin)));
        }
        let mut walk = Walk { target: self, path, options, lines: vec![Vec::new()], left: MOST_POINTS };
        for w in spots.windows(2) {
            walk.stretch(&w[0], &w[1], 0);
        }
        let mut out = Carried { on: spots.iter().map(|s| s.place.is_some()).collect(), ..Carried::default() };
        let lines = std::mem::take(&mut walk.lines);
        for line in lines.iter().filter(|l| l.len() > 1) {
            let fine: Vec<Vec2> = line.iter().filter_map(|s| s.place.map(|p| p.1)).collect();
            let edge = ALONG * (options.within + self.rough);
            let is_stub = fine.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>() <= STUB * options.within;
            if is_stub && (lines.len() > 1 || !out.on.iter().all(|on| *on)) {
                continue;
            }
            if fine.iter().all(|p| self.outline.any_within(p, edge)) {
                out.along_edge = true;
                continue;
            }
            let off = line.iter().filter_map(|s| s.place.map(|p| p.0.off)).fold(0.0, f64::max);
            let (drawn, fit) = marked("", &fine, options.chord);
            out.distance = out.distance.max(off);
            out.deviation = out.deviation.max(walk.between(line) + fit);
            out.lines.push(drawn);
        }
        out
    }

    /// The place of a point within a distance of a skin, near that of the point before where that is near enough.
    fn spot(&self, s: f64, x: Vec3, before: Option<&Spot>, (within, skin): (f64, Skin)) -> Spot {
        let mut reach = within + self.depth(skin);
        if let Some((face, off)) = &self.ground {
            reach += off;
            if face.within(&x, within).is_none_or(|on| on.off > within) {
                return Spot { s, x, place: None };
            }
        }
        let told = |on: OnPanel| self.on_skin(&x, on, skin).filter(|on| self.is_above(&x, on, within));
        let near = before.and_then(|b| self.atlas.beside(&x, &b.place?.0)).and_then(told);
        let on = near.or_else(|| self.atlas.within(&x, reach).and_then(told));
        Spot { s, x, place: on.map(|on| (on, self.atlas.flat(&on))) }
    }

    /// Whether a point is within a distance of its place; of a panel that covers a face, whether it is beside the place by no more, and
    /// above or below it no farther than that and the panel are off.
    fn is_above(&self, x: &Vec3, on: &OnPanel, within: f64) -> bool {
        let Some((_, off)) = &self.ground else { return on.off <= within };
        let jet = self.atlas.panels[on.panel].panel.surface.jet(on.uv[0], on.uv[1]);
        let Some(normal) = jet.normal().try_normalize(0.0) else { return false };
        let way = x - jet.p;
        on.off <= within + off && (way - normal * way.dot(&normal)).norm() <= within
    }
}

/// A curve on its way over a part: the last of the lines is still open.
struct Walk<'w, 'a> {
    target: &'w Target,
    path: &'w Path<'a>,
    options: &'w CarryOptions,
    lines: Vec<Vec<Spot>>,
    /// Points that may still be looked for: where images leap to and fro no halving ends.
    left: usize,
}

impl Walk<'_, '_> {
    fn at(&mut self, s: f64, near: &Spot) -> Spot {
        self.left = self.left.saturating_sub(1);
        self.target.spot(s, self.path.point(s), Some(near), (self.options.within, self.options.skin))
    }

    /// Whether the image goes on from one point to another.
    fn goes_on(&self, a: &Spot, b: &Spot) -> bool {
        let (Some(p), Some(q)) = (a.place, b.place) else { return false };
        let slack = self.target.leap + STRETCH * self.options.within;
        (p.1 - q.1).norm() <= STRETCH * (a.x - b.x).norm() + slack
    }

    fn push(&mut self, spot: Spot) {
        if let Some(line) = self.lines.last_mut() {
            if line.last().is_none_or(|l| l.s != spot.s) {
                line.push(spot);
            }
        }
    }

    /// What lies between two points of the path.
    fn stretch(&mut self, a: &Spot, b: &Spot, depth: usize) {
        if self.goes_on(a, b) {
            return self.chord(a, b, depth);
        }
        let (leaves, enters) = (self.last(a, b), self.last(b, a));
        if let Some(end) = leaves {
            self.chord(a, &end, depth + 1);
        }
        if self.lines.last().is_some_and(|l| !l.is_empty()) {
            self.lines.push(Vec::new());
        }
        if let Some(start) = enters {
            self.chord(&start, b, depth + 1);
        }
    }

    /// A stretch over which the image goes on.
    fn chord(&mut self, a: &Spot, b: &Spot, depth: usize) {
        self.push(*a);
        let middles = BETWEEN.map(|share: f64| self.at(a.s + (b.s - a.s) * share, a));
        let ends = a.place.zip(b.place);
        let off = |m: &Spot| match (ends, m.place) {
            (Some((p, q)), Some(m)) => (m.1 - foot(&p.1, &q.1, &m.1)).norm(),
            _ => f64::INFINITY,
        };
        let worst = middles.iter().map(off).fold(0.0, f64::max);
        if worst > self.options.chord && depth < DEEPEST && self.left > 0 {
            let [_, middle, _] = middles;
            self.stretch(a, &middle, depth + 1);
            self.stretch(&middle, b, depth + 1);
            return;
        }
        middles.into_iter().filter(|m| m.place.is_some()).for_each(|m| self.push(m));
        self.push(*b);
    }

    /// Greatest distance (mm) of the image from the chords of a line, half way between its points.
    fn between(&mut self, line: &[Spot]) -> f64 {
        let mut worst = 0.0_f64;
        for w in line.windows(2) {
            let middle = self.at(0.5 * (w[0].s + w[1].s), &w[0]);
            let places = [&w[0], &middle, &w[1]].map(|s| s.place.map(|p| p.1));
            if let [Some(p), Some(m), Some(q)] = places {
                worst = worst.max((m - foot(&p, &q, &m)).norm());
            }
        }
        worst
    }

    /// The last point on the way from one to the other to which the image of the first goes on.
    fn last(&mut self, from: &Spot, to: &Spot) -> Option<Spot> {
        from.place?;
        let (mut on, mut beyond) = (*from, to.s);
        for _ in 0..HALVINGS {
            let next = self.at(0.5 * (on.s + beyond), &on);
            if self.goes_on(&on, &next) {
                on = next;
            } else {
                beyond = next.s;
            }
        }
        Some(on)
    }
}
