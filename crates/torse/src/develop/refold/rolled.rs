//! Rolled faces without one radius, as cones and fans: the family of rulings through their lines, from where the face begins to
//! where it ends.
//!
//! *Method*. The part is cut along all lines where bends begin and end; what holds the lines of a face is its region, over which
//! rulings are laid as over a part that bends about one family. The lines of a face stand for equal turns, so that the turn up to
//! its first line and behind its last one are known: what the family gives there is brought to these.

use super::cut::{cut, CutRegion};
use super::drawn::{FlatPart, SheetRow, ROUNDED};
use super::lines::whole_lines;
use super::one_family::rulings;
use super::skin::on_skin;
use super::zone::{lines_of, middles, DirectedLine, Strip, Zone, ON_ONE_LINE};
use super::RefoldError;
use crate::geom::polygon::{distance, inside, sides};
use crate::geom::segment::foot;
use crate::geom::segment::same_segment;
use crate::geom::Vec2;
use crate::torse::ribbon::pose::{Pose, Rates};
use crate::torse::ribbon::Ribbon;

/// Both ends of a chord.
pub(super) type Chord = [Vec2; 2];

/// Share of a span below which a ruling and the edge of a zone are one.
const ONE_RULING: f64 = 1e-6;

/// A rolled face.
pub(super) struct Rolled {
    pub zone: Zone,
    /// The chords of its first and its last edge, directed as its rulings; none where it ends in the outline.
    pub chords: [Vec<Chord>; 2],
    /// Largest turn (rad) by which the table differs from its radii.
    pub disagreement: f64,
}

/// Whether a bend is a rolled face without one radius.
pub(super) fn is_rolled(row: &SheetRow) -> bool {
    row.rolled && !row.allowance.is_finite()
}

/// The zone of a rolled face without one radius; `None` without lines.
///
/// # Errors
/// Lines that are missing, cross in the part, or do not run through it; a face whose ends are not drawn.
pub(super) fn rolled(part: &FlatPart, row: &SheetRow) -> Result<Option<Rolled>, RefoldError> {
    let inner = middles(&lines_of(part, row)?);
    let (Some(first), Some(last)) = (inner.first(), inner.last()) else { return Ok(None) };
    let ends = ends(part);
    let holds = |r: &CutRegion| inner.iter().all(|q| inside(&r.loops, q));
    let region =
        cut(&part.loops, &ends).into_iter().find(holds).ok_or(RefoldError::Ends { line: row.lines.start + 1 })?;
    // Lines of other faces in the region: what lies between is not drawn. A sharp bend may be on its edge.
    let near = ON_ONE_LINE * part.size();
    let within = |q: &Vec2| inside(&region.loops, q) && distance(&region.loops, q) > near;
    let strange = |k: &usize| !row.lines.contains(k) && within(&middle(&part.lines[*k].ends));
    if (0..part.lines.len()).any(|k| strange(&k)) {
        return Err(RefoldError::Ends { line: row.lines.start + 1 });
    }
    let outline = region.loops.clone();
    let own = FlatPart {
        joints: outline.clone(),
        loops: outline,
        lines: part.lines[row.lines.clone()].to_vec(),
        ..part.clone()
    };
    let (ribbon, disagreement) = rulings(&own, whole_lines(&own)).map_err(|e| match e {
        RefoldError::Crossing { first, second } => {
            let start = row.lines.start;
            RefoldError::Crossing { first: start + first, second: start + second }
        }
        other => other,
    })?;
    let place = |q: &Vec2| ribbon.locate(q).map(|s| s.t);
    let (Some(from), Some(to)) = (place(first), place(last)) else { return Ok(None) };
    let mut chords = [Vec::new(), Vec::new()];
    let mut reach = [0.0, ribbon.end()];
    let mut edges: [Option<DirectedLine>; 2] = [None; 2];
    for chord in region.chords.iter().map(|(c, _)| ends[*c]) {
        let Some(t) = place(&middle(&chord)) else { continue };
        let behind = t > 0.5 * (from + to);
        let like = ribbon.flat(t).ruling().xy();
        let chord = if like.dot(&(chord[1] - chord[0])) < 0.0 { [chord[1], chord[0]] } else { chord };
        reach[usize::from(behind)] = t;
        edges[usize::from(behind)] = Some((chord[0], (chord[1] - chord[0]).normalize()));
        chords[usize::from(behind)].push(chord);
    }
    let mut strips = strips(&ribbon, reach, edges);
    // Lines stand for equal turns, half of which lies before the first one and behind the last.
    let half = |k: usize| 0.5 * part.lines[k].bend.angle;
    let outer = [half(row.lines.start), half(row.lines.end - 1)];
    for (k, turn) in outer.into_iter().enumerate().filter(|(k, _)| edges[*k].is_some()) {
        let beyond = |t: f64| if k == 0 { t < from } else { t > to };
        let found: f64 = strips.iter().filter(|s| beyond(s.0)).map(|s| s.1.in_space.turn).sum();
        let share = turn / found.abs();
        if share.is_finite() {
            strips.iter_mut().filter(|s| beyond(s.0)).for_each(|s| s.1.in_space.turn *= share);
        }
    }
    let whole = |k: usize| {
        let pose = ribbon.flat(reach[k]);
        (pose.at.xy(), pose.ruling().xy())
    };
    let edges = [0, 1].map(|k: usize| edges[k].unwrap_or_else(|| whole(k)));
    let on_skin = |(t, strip): (f64, Strip)| match &part.fibre {
        Some(fibre) => Strip { in_space: on_skin(fibre, strip.in_space, ribbon.span(t).0.reach), ..strip },
        None => strip,
    };
    let strips = strips.into_iter().map(on_skin).collect();
    let zone = Zone { edges, strips, inner, turn: 0.0, beyond: 0.0 };
    Ok(Some(Rolled { zone, chords, disagreement }))
}

/// The point half way between two.
fn middle(chord: &Chord) -> Vec2 {
    (chord[0] + chord[1]) * 0.5
}

/// The lines where bends begin and end, each once, from outline to outline.
fn ends(part: &FlatPart) -> Vec<Chord> {
    let near = ROUNDED.max(ON_ONE_LINE * part.size());
    let mut out: Vec<Chord> = Vec::new();
    for chord in part.extents.iter().map(|e| e.map(|q| on_outline(part, &q, near))) {
        let same = |c: &Chord| same_segment(c, &chord, near).is_some();
        if (chord[1] - chord[0]).norm() > near && !out.iter().any(same) {
            out.push(chord);
        }
    }
    out
}

/// The nearest place of an outline; the joint that is meant, if one is.
fn on_outline(part: &FlatPart, q: &Vec2, near: f64) -> Vec2 {
    let closer = |a: &Vec2, b: &Vec2| (a - q).norm().total_cmp(&(b - q).norm());
    let corner = part.joint_meant(q, near);
    corner.or_else(|| sides(&part.loops).map(|(a, b)| foot(&a, &b, q)).min_by(closer)).unwrap_or(*q)
}

/// The strips of a ribbon between two places, each with the place in its middle; the outermost rulings are those of the edges.
fn strips(ribbon: &Ribbon, [from, to]: [f64; 2], edges: [Option<DirectedLine>; 2]) -> Vec<(f64, Strip)> {
    let mut places = vec![from];
    places.extend((from.floor() as i64 + 1..).map(|k| k as f64).take_while(|t| *t < to - ONE_RULING));
    if places.len() > 1 && places[1] - from <= ONE_RULING {
        places.remove(1);
    }
    places.push(to);
    let last = places.len() - 1;
    let pose = |k: usize| {
        let own = ribbon.flat(places[k]);
        let edge = if k == 0 {
            edges[0]
        } else if k == last {
            edges[1]
        } else {
            None
        };
        edge.map_or(own, |(at, way)| Pose::flat(at + way * way.dot(&(own.at.xy() - at)), way))
    };
    let poses: Vec<Pose> = (0..=last).map(pose).collect();
    let strip = |k: usize| {
        let t = 0.5 * (places[k] + places[k + 1]);
        let turn = ribbon.span(t).0.in_space.turn * (places[k + 1] - places[k]);
        let in_plane = poses[k].flat_rates_to(&poses[k + 1]);
        (t, Strip { flat: poses[k], in_plane, in_space: Rates { turn, ..in_plane } })
    };
    (0..last).map(strip).collect()
}
