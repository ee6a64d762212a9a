//! Bent zones of a part: what is known of one before it is put into space.

use super::drawn::{FlatPart, SheetRow};
use super::RefoldError;
use crate::geom::polygon::{crossings, distance, inside};
use crate::geom::Vec2;
use crate::patchwork::pattern::BendSense;
use crate::torse::ribbon::pose::{Pose, Rates};

/// Share of the size within which lines are one.
pub(super) const ON_ONE_LINE: f64 = 1e-6;
/// Share of the shorter one by which a stretch of an edge and the centre line are beside each other.
const BESIDE: f64 = 0.5;

/// A line of the plane: a point and a unit direction.
pub(super) type DirectedLine = (Vec2, Vec2);

/// A strip between two rulings of a zone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// Its first ruling in the plane.
    pub flat: Pose,
    /// How it moves in the plane.
    pub in_plane: Rates,
    /// How it moves in space.
    pub in_space: Rates,
}

/// A bent zone: strips between lines that do not cross in it; it lies to the left of its first line and to the right of the last.
#[derive(Clone, Debug)]
pub(super) struct Zone {
    /// Its first and last line.
    pub edges: [DirectedLine; 2],
    /// Its strips; one without breadth of a fold.
    pub strips: Vec<Strip>,
    /// Places on the centre lines; none of a zone without breadth.
    pub inner: Vec<Vec2>,
    /// Turn of a fold towards the eye, rad.
    pub turn: f64,
    /// Way (mm) by which the regions beside a line go on beyond it, to their common edge.
    pub beyond: f64,
}

/// Thickness of the sheet (mm) by the allowances of its bends; 0 where the neutral fibre is the skin itself.
pub fn thickness(bends: &[SheetRow]) -> f64 {
    // The largest allowance has the smallest relative rounding.
    let known = bends.iter().filter_map(|b| Some((b.angle * b.k, by_allowance(b)?)));
    known.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |b| b.1.max(0.0))
}

/// Thickness (mm) of the sheet at a bend by its allowance, as exactly as that is printed.
fn by_allowance(b: &SheetRow) -> Option<f64> {
    let found = match b.allowance < 0.0 {
        true => b.allowance / (b.k * b.angle - 2.0 * (0.5 * b.angle).tan()),
        false => (b.allowance / b.angle - b.inside_radius) / b.k,
    };
    (b.k > 0.0 && b.angle > 0.0 && found.is_finite()).then_some(found)
}

/// Thickness (mm) of the sheet at a bend: of those that the part has somewhere, the one that its allowance tells of; else that of the
/// part.
fn at_bend(part: &FlatPart, row: &SheetRow, thickness: f64) -> f64 {
    let Some(told) = by_allowance(row).filter(|_| row.allowance > 0.0) else { return thickness };
    let known = part.local.iter().copied().filter(|t| *t > 0.0);
    known.min_by(|a, b| (a - told).abs().total_cmp(&(b - told).abs())).unwrap_or(thickness)
}

/// The centre lines of a bend, each in parts where holes lie between.
type Pieces = Vec<Vec<[Vec2; 2]>>;

/// The lines of a bend.
///
/// # Errors
/// Lines that are missing or do not run through the part.
pub(super) fn lines_of(part: &FlatPart, row: &SheetRow) -> Result<Pieces, RefoldError> {
    let mut lines: Pieces = Vec::new();
    for k in row.lines.clone() {
        let l = part.lines.get(k).ok_or_else(|| {
            RefoldError::Table(format!("bend_table.csv names more lines than bends.csv has; line {} is missing", k + 1))
        })?;
        let [a, b] = l.ends;
        if !inside(&part.loops, &((a + b) * 0.5)) {
            return Err(RefoldError::Outside { line: k + 1 });
        }
        let on = |m: &Vec<[Vec2; 2]>| {
            let way = (m[0][1] - m[0][0]).normalize();
            [a, b].iter().all(|p| way.perp(&(p - m[0][0])).abs() <= ON_ONE_LINE * part.size())
        };
        match lines.iter_mut().find(|m| on(m)) {
            Some(m) => m.push(l.ends),
            None => lines.push(vec![l.ends]),
        }
    }
    Ok(lines)
}

/// The middles of lines.
pub(super) fn middles(lines: &[Vec<[Vec2; 2]>]) -> Vec<Vec2> {
    lines.iter().flatten().map(|l| (l[0] + l[1]) * 0.5).collect()
}

/// A zone with the chords of its first and last edge.
type Bounded = (Zone, [Vec<[Vec2; 2]>; 2]);

/// The zone of a bend of one radius, of one without breadth with the chords of one edge.
///
/// # Errors
/// See [`lines_of`].
pub(super) fn round(part: &FlatPart, row: &SheetRow, thickness: f64) -> Result<Option<Bounded>, RefoldError> {
    let lines = lines_of(part, row)?;
    let n = lines.len();
    let sign = if row.sense == BendSense::Down { -1.0 } else { 1.0 };
    let turn = sign * row.angle / n.max(1) as f64;
    let directed = |l: &[Vec2; 2], like: Vec2| {
        let way = (l[1] - l[0]).normalize();
        (l[0], if way.dot(&like) < 0.0 { -way } else { way })
    };
    let Some(first) = lines.first().map(|l| l[0][1] - l[0][0]) else { return Ok(None) };
    let mut all: Vec<DirectedLine> = lines.iter().map(|l| directed(&l[0], first)).collect();
    // Neighbours follow each other to the left.
    if n > 1 && all[0].1.perp(&(all[1].0 - all[0].0)) < 0.0 {
        all.iter_mut().for_each(|l| l.1 = -l.1);
    }
    let breadth = if row.allowance.is_finite() { row.allowance.max(0.0) / n as f64 } else { 0.0 };
    let beyond = 0.5 * (-row.allowance).max(0.0);
    let thickness = at_bend(part, row, thickness);
    // The surface that panels show may lie below the outer side.
    let above = part.fibre.as_ref().map_or(0.0, |f| f.above);
    let skin = row.inside_radius + if sign < 0.0 { thickness - above } else { above };
    // Edges of the outline may lie on the edges of a zone, which are only known as far as the table is printed.
    let hair = part.printed.min(0.25 * breadth);
    let stretch = if breadth > 0.0 && skin.is_finite() && thickness > 0.0 {
        let narrow = row.allowance - 2.0 * hair;
        (skin * row.angle - 2.0 * hair).max(0.0) / narrow
    } else {
        1.0
    };
    let beside = |(at, way): DirectedLine, by: f64| (at + Vec2::new(-way.y, way.x) * by, way);
    let half = 0.5 * breadth - hair;
    let inner = (1..n).map(|k| beside(all[k], -0.5 * breadth));
    let lined: Vec<DirectedLine> =
        std::iter::once(beside(all[0], -half)).chain(inner).chain([beside(all[n - 1], half)]).collect();
    let edges = [lined[0], lined[n]];
    let sharp = (edges[1].0 - edges[0].0).norm() <= ON_ONE_LINE * part.size();
    let chords = [(0, 0), (1, n - 1)].map(|(end, beside): (usize, usize)| match sharp && end == 1 {
        true => Vec::new(),
        false => stretches(part, &edges[end], (&lines[beside], sharp)),
    });
    let inner = if sharp { Vec::new() } else { middles(&lines) };
    Ok(Some((Zone { edges, strips: equal_strips(&lined, turn, stretch), inner, turn, beyond }, chords)))
}

/// Strips between lines that each turn alike; skins are `stretch` times as long as what is drawn, across.
fn equal_strips(lines: &[DirectedLine], turn: f64, stretch: f64) -> Vec<Strip> {
    let mut flat = vec![Pose::flat(lines[0].0, lines[0].1)];
    for (to, way) in &lines[1..] {
        // The point across, so that parallel edges need no way along.
        let at = flat[flat.len() - 1].at.xy();
        flat.push(Pose::flat(to + way * way.dot(&(at - to)), *way));
    }
    flat.windows(2)
        .map(|w| {
            let in_plane = w[0].flat_rates_to(&w[1]);
            let in_space = Rates { turn, across: in_plane.across * stretch, ..in_plane };
            Strip { flat: w[0], in_plane, in_space }
        })
        .collect()
}

/// The stretches of a zone's edge inside the part that lie beside its centre lines; of a sharp one these themselves.
fn stretches(part: &FlatPart, (at, way): &(Vec2, Vec2), (lines, sharp): (&[[Vec2; 2]], bool)) -> Vec<[Vec2; 2]> {
    // Sides of neighbouring regions may go on along a fold, so that crossings do not tell where it ends.
    let near = ON_ONE_LINE * part.size() + part.printed;
    if sharp && lines.iter().flatten().all(|p| distance(&part.loops, p) <= near) {
        return lines.iter().map(|l| if way.dot(&(l[1] - l[0])) < 0.0 { [l[1], l[0]] } else { *l }).collect();
    }
    let cuts = crossings(&part.loops, at, way);
    let beside = |a: f64, b: f64| {
        lines.iter().any(|l| {
            let [p, q] = l.map(|x| way.dot(&(x - at)));
            // A corner beside the bend may open a stretch that only begins there.
            b.min(p.max(q)) - a.max(p.min(q)) > BESIDE * (b - a).min((q - p).abs())
        })
    };
    cuts.chunks_exact(2).filter(|c| beside(c[0], c[1])).map(|c| [at + way * c[0], at + way * c[1]]).collect()
}

impl Zone {
    /// Way by which a region beside the first edge, to its left or its right, goes on beyond it.
    pub fn reach(&self, left: bool) -> Vec2 {
        let way = self.edges[0].1;
        Vec2::new(-way.y, way.x) * if left { -self.beyond } else { self.beyond }
    }
}
