//! Polygons with holes cut along chords.

use crate::geom::polygon::{area, bounds, distance, inside};
use crate::geom::segment::foot;
use crate::geom::Vec2;
use std::f64::consts::TAU;

/// Share of the size within which ends of chords and corners are one place: what files print.
const ONE_PLACE: f64 = 1e-9;

/// A region that is left between chords.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutRegion {
    /// The outer polygon counter-clockwise, then holes clockwise.
    pub loops: Vec<Vec<Vec2>>,
    /// Chords on its border, and whether the region lies to their left.
    pub chords: Vec<(usize, bool)>,
}

/// A corner of a border in the making.
struct Node {
    at: Vec2,
    next: usize,
    /// The chord along which the border leaves this corner, and whether in its direction.
    chord: Option<(usize, bool)>,
}

/// Where a chord ends on a side: steps along it, minus the turn from it, the chord, and which of its ends.
type Crossing = (i64, f64, usize, usize);

/// The regions into which chords cut the inside of polygons (the outer one counter-clockwise, holes clockwise). The ends of
/// every chord lie on sides of the polygons, up to rounding, and chords do not cross; several may end in one corner.
///
/// *Method*: a chord is run through in both directions; at both of its ends the border turns into it, so that borders come
/// apart or together as they must, holes included.
pub fn cut(loops: &[Vec<Vec2>], chords: &[[Vec2; 2]]) -> Vec<CutRegion> {
    let (lo, hi) = bounds(loops);
    let one = ONE_PLACE * (hi - lo).norm();
    let mut chords = chords.to_vec();
    // Ends of chords on the sides that they lie on: how far along, how far they turn from the side, and which they are.
    let mut on: Vec<Vec<Vec<Crossing>>> = loops.iter().map(|l| vec![Vec::new(); l.len()]).collect();
    for (c, chord) in chords.iter_mut().enumerate() {
        for end in 0..2 {
            let Some((i, k)) = side_of(loops, chord, end, one) else { continue };
            let l = &loops[i];
            let (p, q) = (l[k], l[(k + 1) % l.len()]);
            let along = (foot(&p, &q, &chord[end]) - p).norm();
            if along <= one {
                chord[end] = p;
            }
            let turn = turn(q - p, chord[1 - end] - chord[end]);
            on[i][k].push(((along / one).round() as i64, -turn, c, end));
        }
    }
    let mut nodes: Vec<Node> = Vec::new();
    let mut ends = vec![[usize::MAX; 2]; chords.len()];
    for (l, sides) in loops.iter().zip(&mut on) {
        let first = nodes.len();
        for (p, side) in l.iter().zip(sides) {
            nodes.push(Node { at: *p, next: nodes.len() + 1, chord: None });
            // Of several ends in one place the border comes first to that which turns farthest back.
            side.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            for (_, _, c, end) in side.iter() {
                ends[*c][*end] = nodes.len();
                nodes.push(Node { at: chords[*c][*end], next: nodes.len() + 1, chord: None });
            }
        }
        if let Some(last) = nodes.last_mut() {
            last.next = first;
        }
    }
    for (c, &[a, b]) in ends.iter().enumerate() {
        if a == usize::MAX || b == usize::MAX {
            continue;
        }
        let (a2, b2) = (nodes.len(), nodes.len() + 1);
        let copy = |n: &Node| Node { at: n.at, next: n.next, chord: n.chord };
        let (x, y) = (copy(&nodes[a]), copy(&nodes[b]));
        nodes.push(x);
        nodes.push(y);
        (nodes[a].next, nodes[a].chord) = (b2, Some((c, true)));
        (nodes[b].next, nodes[b].chord) = (a2, Some((c, false)));
    }
    gathered(&nodes)
}

/// Angle (rad, from 0 to a full turn) from one direction to another, counter-clockwise.
fn turn(from: Vec2, to: Vec2) -> f64 {
    from.perp(&to).atan2(from.dot(&to)).rem_euclid(TAU)
}

/// The polygon and the side of it on which an end of a chord lies: the nearest one; of those that are as near within `one`, as
/// both sides of a slit without breadth are, the one from which the chord leads into the inside.
fn side_of(loops: &[Vec<Vec2>], chord: &[Vec2; 2], end: usize, one: f64) -> Option<(usize, usize)> {
    let (at, way) = (chord[end], chord[1 - end] - chord[end]);
    let mut all: Vec<(f64, usize, usize)> = Vec::new();
    for (i, l) in loops.iter().enumerate() {
        for k in 0..l.len() {
            let q = l[(k + 1) % l.len()];
            let f = foot(&l[k], &q, &at);
            // A corner belongs to the side that begins in it.
            if (f - q).norm() > one {
                all.push(((f - at).norm(), i, k));
            }
        }
    }
    let least = all.iter().map(|a| a.0).fold(f64::INFINITY, f64::min);
    all.retain(|a| a.0 <= least + one);
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let inwards = |&&(_, i, k): &&(f64, usize, usize)| {
        let l = &loops[i];
        let (p, q, before) = (l[k], l[(k + 1) % l.len()], l[(k + l.len() - 1) % l.len()]);
        let corner = (foot(&p, &q, &at) - p).norm() <= one;
        let opens = if corner { turn(q - p, before - p) } else { 0.5 * TAU };
        // Where a slit ends it is inside all around.
        turn(q - p, way) < if opens > 0.0 { opens } else { TAU }
    };
    all.iter().find(inwards).or(all.first()).map(|a| (a.1, a.2))
}

/// Borders as regions: outer ones with the holes that lie in them.
fn gathered(nodes: &[Node]) -> Vec<CutRegion> {
    let mut seen = vec![false; nodes.len()];
    let (mut out, mut holes): (Vec<CutRegion>, Vec<CutRegion>) = (Vec::new(), Vec::new());
    for start in 0..nodes.len() {
        if seen[start] {
            continue;
        }
        let mut one = CutRegion::default();
        let mut border = Vec::new();
        let mut k = start;
        while !seen[k] {
            seen[k] = true;
            border.push(nodes[k].at);
            one.chords.extend(nodes[k].chord);
            k = nodes[k].next;
        }
        let positive = area(&border) > 0.0;
        one.loops.push(border);
        if positive {
            out.push(one);
        } else {
            holes.push(one);
        }
    }
    for hole in holes {
        let x = hole.loops[0][0];
        let holds = |r: &&mut CutRegion| inside(&r.loops[..1], &x);
        // Of nested regions the least one; a hole on the border of one belongs to the nearest.
        let within = out.iter_mut().filter(|r| holds(r)).min_by(|a, b| area(&a.loops[0]).total_cmp(&area(&b.loops[0])));
        let home = match within {
            Some(r) => Some(r),
            None => out.iter_mut().min_by(|a, b| distance(&a.loops, &x).total_cmp(&distance(&b.loops, &x))),
        };
        if let Some(r) = home {
            r.loops.extend(hole.loops);
            r.chords.extend(hole.chords);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(a: f64, b: f64, c: f64, d: f64) -> Vec<Vec2> {
        vec![Vec2::new(a, c), Vec2::new(b, c), Vec2::new(b, d), Vec2::new(a, d)]
    }

    fn total(r: &CutRegion) -> f64 {
        r.loops.iter().map(|l| area(l)).sum()
    }

    /// The net of a box: chords of neighbouring flaps end in one corner of the base, whatever rounding says of their ends.
    #[test]
    fn chords_may_end_in_one_corner() {
        let cross = [(0, 0), (1, 0), (1, -1), (2, -1), (2, 0), (3, 0), (3, 1), (2, 1), (2, 2), (1, 2), (1, 1), (0, 1)];
        let outline: Vec<Vec2> = cross.iter().map(|(x, y)| Vec2::new(f64::from(*x), f64::from(*y))).collect();
        let corners = [(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)].map(|(x, y)| Vec2::new(x, y));
        for hair in [0.0, 1e-9, -1e-9] {
            let chord = |k: usize| [corners[k] + Vec2::new(hair, -hair), corners[(k + 1) % 4] + Vec2::new(-hair, hair)];
            let regions = cut(std::slice::from_ref(&outline), &[chord(0), chord(1), chord(2), chord(3)]);
            assert_eq!(regions.len(), 5, "{hair}");
            assert!(regions.iter().all(|r| (total(r) - 1.0).abs() < 1e-8), "{hair}");
            assert_eq!(regions.iter().filter(|r| r.chords.len() == 4).count(), 1, "{hair}");
        }
    }

    /// Flaps without relief: a side of the plate and one of the bend run along each other, whatever rounding says of which is
    /// nearer.
    #[test]
    fn chords_end_on_their_own_side_of_a_slit() {
        for hair in [0.0, 1e-9, -1e-9] {
            let x = [3.0, 3.0, 3.0, 3.0 + hair, 7.0 - hair, 7.0, 7.0, 7.0];
            let y = [0.0, 2.0, 1.0, -4.0, -4.0, 1.0, 2.0, 0.0];
            let mut outline = vec![Vec2::new(0.0, 0.0)];
            outline.extend(x.iter().zip(&y).map(|(x, y)| Vec2::new(*x, *y)));
            outline.extend([(10.0, 0.0), (10.0, 8.0), (0.0, 8.0)].map(|(x, y)| Vec2::new(x, y)));
            let across = |y: f64| [Vec2::new(3.0, y), Vec2::new(7.0, y)];
            let regions = cut(&[outline], &[across(0.5), across(1.9)]);
            let mut areas: Vec<f64> = regions.iter().map(total).collect();
            areas.sort_by(f64::total_cmp);
            assert_eq!(areas.len(), 3, "{hair}");
            assert!(areas.iter().zip([5.6, 18.0, 72.4]).all(|(a, b)| (a - b).abs() < 1e-6), "{hair} {areas:?}");
        }
    }

    #[test]
    fn chords_across_a_hole_leave_what_is_left() {
        let mut hole = rectangle(4.0, 6.0, 4.0, 6.0);
        hole.reverse();
        let loops = vec![rectangle(0.0, 10.0, 0.0, 10.0), hole];
        let up = |x: f64, from: f64, to: f64| [Vec2::new(x, from), Vec2::new(x, to)];
        // Both pieces of a line through the hole: two halves without a hole.
        let halves = cut(&loops, &[up(5.0, 0.0, 4.0), up(5.0, 6.0, 10.0)]);
        assert_eq!(halves.len(), 2);
        assert!(halves.iter().all(|r| r.loops.len() == 1 && (total(r) - 48.0).abs() < 1e-12 && r.chords.len() == 2));
        let left = halves.iter().find(|r| r.loops[0].iter().all(|p| p.x <= 5.0)).expect("the left half");
        assert!(left.chords.iter().all(|c| c.1), "it lies to the left of a line upwards");
        // One piece alone cuts nothing off but joins hole and border.
        let one = cut(&loops, &[up(5.0, 0.0, 4.0)]);
        assert!(one.len() == 1 && (total(&one[0]) - 96.0).abs() < 1e-12 && one[0].loops.len() == 1);
        // Beside the hole it stays in one of three.
        let three = cut(&loops, &[up(2.0, 0.0, 10.0), up(3.0, 0.0, 10.0)]);
        let mut areas: Vec<f64> = three.iter().map(total).collect();
        areas.sort_by(f64::total_cmp);
        assert!((areas[0] - 10.0).abs() < 1e-12 && (areas[2] - 66.0).abs() < 1e-12);
        assert_eq!(three.iter().map(|r| r.loops.len()).sum::<usize>(), 4);
    }
}
