//! Which panel the rulings of a part bent back belong to, and what of the drawing belongs to it: along rulings where the sheet bends,
//! along common edges of panels where several lie in one plane.

use crate::develop::refold::atlas::{Atlas, OnPanel};
use crate::develop::refold::compare::samples;
use crate::develop::refold::cut::{cut, CutRegion};
use crate::develop::refold::drawn::{FlatPart, ROUNDED};
use crate::develop::refold::leaf::Leaf;
use crate::geom::polygon::{area, bounds, corner_near, distance, inside};
use crate::geom::segment::same_segment;
use crate::geom::Vec2;
use crate::torse::ribbon::{Ribbon, Span};
use std::ops::Range;

/// Share of the size within which corners of a panel are on the ruling in which it ends, and on the border of a plane region.
pub(super) const ON_RULING: f64 = 1e-5;

/// What of a region belongs to one panel.
#[derive(Clone)]
pub(super) struct Share {
    /// Its rulings.
    pub ribbon: Ribbon,
    /// The panel.
    pub panel: usize,
    /// Closed polygons of the plane around it.
    pub loops: Vec<Vec<Vec2>>,
}

/// The shares of the panels of a region.
pub(super) fn shares(part: &FlatPart, leaf: &Leaf, ribbon: &Ribbon, atlas: &Atlas) -> Vec<Share> {
    let n = ribbon.spans.len();
    let of = |q: &Vec2| atlas.at_flat(q).map(|on| on.panel);
    let turns = ribbon.spans.iter().any(|s| s.in_space.turn != 0.0);
    if atlas.panels.len() == 1 {
        return vec![Share { ribbon: ribbon.clone(), panel: 0, loops: leaf.loops.clone() }];
    }
    if !turns || n == 1 {
        return in_one_plane(part, leaf, ribbon, atlas);
    }
    let mut out: Vec<(Range<usize>, usize)> = Vec::new();
    // Where frames only slide along a ruling there is no sheet.
    let wide = |s: &Span| s.in_plane.across != 0.0 || s.in_plane.spin != 0.0;
    for (k, s) in ribbon.spans.iter().enumerate().filter(|(_, s)| wide(s)) {
        let middle = s.flat.moved(&s.in_plane, 0.5).point(0.5 * (s.reach[0] + s.reach[1]), 0.0).xy();
        let panel = of(&middle).or(out.last().map(|o| o.1)).unwrap_or(0);
        match out.last_mut() {
            Some(last) if last.1 == panel => last.0.end = k + 1,
            _ => out.push((k..k + 1, panel)),
        }
    }
    let breadth = |range: &Range<usize>| -> f64 {
        let of = |s: &Span| (s.in_plane.across + 0.5 * (s.reach[0] + s.reach[1]) * s.in_plane.spin).abs();
        ribbon.spans[range.clone()].iter().map(of).sum()
    };
    let out = each_once(out, breadth);
    let share = |(range, panel): (Range<usize>, usize)| {
        let loops = between(leaf, ribbon, &range, (atlas, panel));
        Share { ribbon: Ribbon { spans: ribbon.spans[range].to_vec() }, panel, loops }
    };
    out.into_iter().map(share).collect()
}

/// Every panel with its longest range: the middle of a ruling that leaves the part and comes back to it may lie on another one, and
/// so may that of a ruling within what drawings are rounded by from the edge of a panel.
fn each_once(
    mut ranges: Vec<(Range<usize>, usize)>,
    breadth: impl Fn(&Range<usize>) -> f64,
) -> Vec<(Range<usize>, usize)> {
    let longest: Vec<usize> =
        ranges.iter().map(|r| ranges.iter().filter(|s| s.1 == r.1).map(|s| s.0.len()).max().unwrap_or(0)).collect();
    let is_stray = |k: usize| longest[k] > ranges[k].0.len() || breadth(&ranges[k].0) <= ROUNDED;
    let stray: Vec<bool> = (0..ranges.len()).map(is_stray).collect();
    // What lies before the first range that is none belongs to this.
    let first = stray.iter().position(|s| !s).unwrap_or(0);
    if let Some(from) = ranges.first().map(|r| r.0.start) {
        ranges[first].0.start = from;
    }
    let mut out: Vec<(Range<usize>, usize)> = Vec::new();
    for ((range, panel), stray) in ranges.into_iter().zip(stray).skip(first) {
        match out.last_mut() {
            Some(last) if stray || last.1 == panel => last.0.end = range.end,
            _ => out.push((range, panel)),
        }
    }
    out
}

/// The shares of a plane region: on each side of the edges that its panels have in common the panel that most of it lies on.
fn in_one_plane(part: &FlatPart, leaf: &Leaf, ribbon: &Ribbon, atlas: &Atlas) -> Vec<Share> {
    let (lo, hi) = bounds(&leaf.loops);
    let near = ON_RULING * (hi - lo).norm();
    let panel_of = |loops: &[Vec<Vec2>]| {
        let mut votes = vec![0usize; atlas.panels.len()];
        let own = samples(&FlatPart { loops: loops.to_vec(), ..part.clone() });
        for q in own.iter().filter(|q| inside(loops, q)) {
            atlas.at_flat(q).into_iter().for_each(|on| votes[on.panel] += 1);
        }
        (0..votes.len()).max_by_key(|k| votes[*k]).unwrap_or(0)
    };
    // Edges of a bent zone are beside those of its panel by what tables are rounded to: what is between them is no share of the panel.
    let is_hair = |loops: &[Vec<Vec2>]| {
        let (lo, hi) = bounds(loops);
        let own = whole_area(loops);
        own <= ROUNDED * (hi - lo).norm() && own < HAIR * whole_area(&border(atlas, panel_of(loops)))
    };
    let mut pieces = vec![leaf.loops.clone()];
    for edge in common_edges(&leaf.loops, near, atlas) {
        let halves = |loops: Vec<Vec<Vec2>>| {
            let runs_inside = |c: &[Vec2; 2]| is_inside(&loops, &(0.5 * (c[0] + c[1])), near);
            let chord = snapped(&loops, edge, near).filter(runs_inside);
            let parts = chord.map(|chord| cut(&loops, &[chord]));
            match parts {
                Some(parts) if !parts.iter().any(|r| is_hair(&r.loops)) => parts.into_iter().map(|r| r.loops).collect(),
                _ => vec![loops],
            }
        };
        pieces = pieces.into_iter().flat_map(halves).collect();
    }
    let whole = pieces.len() == 1;
    let mut out: Vec<Share> = Vec::new();
    for loops in pieces {
        let panel = panel_of(&loops);
        match out.iter_mut().find(|s| s.panel == panel) {
            Some(share) => share.loops.extend(loops),
            None => out.push(Share { ribbon: ribbon.clone(), panel, loops }),
        }
    }
    // What lies far beside a panel has no place on it.
    for share in out.iter_mut().filter(|_| !whole) {
        let places = || share.loops.iter().flatten().filter_map(|q| ribbon.locate(q)).map(|spot| spot.t);
        let (from, to) = (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
        if from < to {
            share.ribbon = ribbon.between([from.max(0.0), to.min(ribbon.end())]);
        }
    }
    out
}

/// Share of a panel below which a hair beside it is none of it.
const HAIR: f64 = 0.5;

/// Area within polygons, holes clockwise, mm².
fn whole_area(loops: &[Vec<Vec2>]) -> f64 {
    loops.iter().map(|l| area(l)).sum::<f64>().abs()
}

/// Place in the drawing of a place on a panel.
fn flat(atlas: &Atlas, panel: usize, uv: &[f64; 2]) -> Vec2 {
    atlas.flat(&OnPanel { panel, uv: *uv, off: 0.0 })
}

/// The border of a panel in the drawing.
fn border(atlas: &Atlas, panel: usize) -> Vec<Vec<Vec2>> {
    let loops = atlas.panels[panel].panel.loops.iter();
    loops.map(|l| l.iter().map(|uv| flat(atlas, panel, uv)).collect()).collect()
}

/// Whether a place is inside polygons, and not on their border.
fn is_inside(loops: &[Vec<Vec2>], q: &Vec2, near: f64) -> bool {
    inside(loops, q) && distance(loops, q) > near
}

/// Straight edges that panels have in common and that run through polygons, the longest first. Where a sharp bend takes up or lacks
/// sheet, edges of neighbours are apart.
fn common_edges(loops: &[Vec<Vec2>], near: f64, atlas: &Atlas) -> Vec<[Vec2; 2]> {
    let borders: Vec<Vec<Vec<Vec2>>> = (0..atlas.panels.len()).map(|k| border(atlas, k)).collect();
    let mut out: Vec<[Vec2; 2]> = Vec::new();
    for (panel, placed) in atlas.panels.iter().enumerate() {
        let corners: Vec<Vec2> = placed.panel.corners.iter().map(|uv| flat(atlas, panel, uv)).collect();
        for (p, q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let (edge, middle) = ([*p, *q], 0.5 * (p + q));
            let known = out.iter().any(|e| same_segment(e, &edge, near).is_some());
            let on = |k: usize| distance(&borders[k], &middle) <= near;
            let is_common = || on(panel) && (0..borders.len()).any(|k| k != panel && on(k));
            if !known && is_inside(loops, &middle, near) && is_common() {
                out.push(edge);
            }
        }
    }
    out.sort_by(|a, b| (b[1] - b[0]).norm().total_cmp(&(a[1] - a[0]).norm()));
    out
}

/// A chord with its ends on the border of polygons, in corners to the bit where some are near; `None` where one is not.
fn snapped(loops: &[Vec<Vec2>], chord: [Vec2; 2], near: f64) -> Option<[Vec2; 2]> {
    chord.iter().all(|q| distance(loops, q) <= near).then(|| chord.map(|q| corner_near(loops, q, near)))
}

/// The part of a region that lies on a range of spans: cut off along its first and last ruling, between corners of the panel.
fn between(leaf: &Leaf, ribbon: &Ribbon, range: &Range<usize>, (atlas, panel): (&Atlas, usize)) -> Vec<Vec<Vec2>> {
    let (lo, hi) = bounds(&leaf.loops);
    let near = ON_RULING * (hi - lo).norm();
    let corners = atlas.panels[panel].panel.corners.iter().map(|uv| flat(atlas, panel, uv));
    let corners: Vec<Vec2> = corners.collect();
    let mut chords = Vec::new();
    let ends = [(range.start, range.start > 0), (range.end, range.end < ribbon.spans.len())];
    // Where the chords of each end are.
    let mut own = [0..0, 0..0];
    for (k, (t, _)) in ends.into_iter().enumerate().filter(|(_, e)| e.1) {
        let pose = ribbon.flat(t as f64);
        let off = |q: &Vec2| (q - pose.at.xy()).dot(&pose.across().xy()).abs();
        let mut ways: Vec<f64> =
            corners.iter().filter(|q| off(q) <= near).map(|q| (q - pose.at.xy()).dot(&pose.ruling().xy())).collect();
        ways.sort_by(f64::total_cmp);
        ways.dedup_by(|b, a| *b - *a <= near);
        let first = chords.len();
        // To the bit a corner of the region, where one is: several chords may end in it.
        let at = |v: f64| corner_near(&leaf.loops, pose.point(v, 0.0).xy(), near);
        let within = |w: &&[f64]| inside(&leaf.loops, &at(0.5 * (w[0] + w[1])));
        chords.extend(ways.windows(2).filter(within).map(|w| [at(w[0]), at(w[1])]));
        own[k] = first..chords.len();
    }
    if chords.is_empty() {
        return leaf.loops.clone();
    }
    // Rulings follow each other to their left.
    let belongs = |r: &CutRegion| r.chords.iter().any(|(c, left)| own[usize::from(!left)].contains(c));
    cut(&leaf.loops, &chords).into_iter().filter(belongs).flat_map(|r| r.loops).collect()
}
