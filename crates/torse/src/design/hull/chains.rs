//! Chains of rulings on the boundary of a convex hull: triangles between samples put in order \[W15, 5.1\].

use super::contact::{coplanarity, is_corner, moved, opposite, tangents, touching, OnRail};
use super::sampled::{Sampled, SideKind};
use super::turning::{farthest, one_way};
use super::walk::{End, Walk};
use crate::control::Control;
use crate::geom::convex_hull::sides;
use crate::geom::Vec3;
use crate::num::parallel;
use std::collections::HashMap;

/// A run of rulings between two curves (or one curve and itself), in order.
#[derive(Clone, Debug, PartialEq)]
pub struct RulingChain {
    /// Curves of the first and second ends.
    pub rails: [usize; 2],
    /// Parameters of the rulings' ends; on closed curves they go on beyond the domain. Each column is monotone.
    pub stations: Vec<[f64; 2]>,
    /// Indices of stations where fans, facets and smooth runs meet, ends excluded.
    pub joints: Vec<usize>,
    /// Whether the last ruling is the first one again.
    pub closed: bool,
    /// Whether the rulings shrink to a point beyond the first and the last one.
    pub tips: [bool; 2],
    /// Whether the ends of rulings turn round at the first and the last one.
    pub turns: [bool; 2],
}

/// What happens along a run of moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Both ends follow smooth curves.
    Smooth,
    /// The end of this side rests at a corner.
    Fan(usize),
    /// The other side moves along a straight piece, the end of this side rests.
    Facet(usize),
}

/// All chains, and the facets that belong to none.
pub(super) fn chains(
    sampled: &Sampled,
    facet_of: &[Option<usize>],
    facets: &[[OnRail; 3]],
    control: &Control,
) -> (Vec<RulingChain>, Vec<usize>) {
    let mut owner: HashMap<[usize; 2], usize> = HashMap::new();
    for (t, f) in sampled.triangles.iter().enumerate() {
        owner.extend(sides(f).into_iter().map(|e| (e, t)));
    }
    let rulings = |f: &[usize; 3]| sides(f).into_iter().filter(|e| sampled.side(*e) == SideKind::Ruling).count();
    let is_step: Vec<bool> = sampled.triangles.iter().map(|f| sampled.lid(f).is_none() && rulings(f) == 2).collect();
    let mut seen = vec![false; is_step.len()];
    let mut walks = Vec::new();
    let end_at = |t: usize| match facet_of[t] {
        Some(f) => End::Facet(f),
        None if sampled.lid(&sampled.triangles[t]).is_none() && rulings(&sampled.triangles[t]) == 1 => End::Tip,
        None => End::Other,
    };
    // Open chains first: they begin beside a triangle that is no step.
    for closed in [false, true] {
        for t in 0..is_step.len() {
            for e in sides(&sampled.triangles[t]) {
                if !is_step[t] || seen[t] || sampled.side(e) != SideKind::Ruling {
                    continue;
                }
                let Some(&before) = owner.get(&[e[1], e[0]]) else { continue };
                if !closed && is_step[before] {
                    continue;
                }
                let mut walk = Walk { edges: vec![e], moves: Vec::new(), ends: [end_at(before), End::Closed] };
                if closed {
                    walk.ends[0] = End::Closed;
                }
                let mut now = t;
                loop {
                    seen[now] = true;
                    let Some(exit) = step(sampled, &sampled.triangles[now], &mut walk) else { break };
                    let Some(&next) = owner.get(&exit) else { break };
                    if !is_step[next] {
                        walk.ends[1] = end_at(next);
                        break;
                    }
                    if seen[next] {
                        break;
                    }
                    now = next;
                }
                walks.push(walk);
            }
        }
    }
    let single = (0..facet_of.len()).filter(|&t| !is_step[t]).filter_map(|t| facet_of[t]).collect();
    let polish = |w: Walk| if control.stopped() { None } else { polished(sampled, facets, w, control) };
    let walks: Vec<Walk> = walks.into_iter().flat_map(|w| one_way(sampled, w)).collect();
    (parallel::map(walks, polish).into_iter().flatten().collect(), single)
}

/// Goes through a triangle; the directed edge by which the next one has it.
fn step(sampled: &Sampled, f: &[usize; 3], walk: &mut Walk) -> Option<[usize; 2]> {
    let [p, q] = *walk.edges.last()?;
    let x = *f.iter().find(|i| **i != p && **i != q)?;
    let kind = [[p, x], [q, x]].map(|e| sampled.side(e));
    let side = kind.iter().position(|k| *k != SideKind::Ruling)?;
    walk.moves.push((side, kind[side] == SideKind::Straight));
    let edge = if side == 0 { [x, q] } else { [p, x] };
    walk.edges.push(edge);
    // Sides of a triangle go round: the way out runs against its direction.
    Some(if sides(f).contains(&edge) { [edge[1], edge[0]] } else { edge })
}

/// A range of moves: from edge `first` to edge `last`.
struct MoveRange {
    kind: Kind,
    first: usize,
    last: usize,
}

fn move_ranges(sampled: &Sampled, walk: &Walk) -> Vec<MoveRange> {
    let mut out: Vec<MoveRange> = Vec::new();
    for (k, &(side, straight)) in walk.moves.iter().enumerate() {
        let rest = 1 - side;
        let at = &sampled.at[walk.edges[k][rest]];
        let kind = if straight {
            Kind::Facet(rest)
        } else if is_corner(&sampled.rails[at.rail], at.parameter) {
            Kind::Fan(rest)
        } else {
            Kind::Smooth
        };
        match out.last_mut() {
            // The same corner: the resting end is the same sample.
            Some(r)
                if r.kind == kind
                    && !straight
                    && (kind == Kind::Smooth || walk.edges[r.first][rest] == walk.edges[k][rest]) =>
            {
                r.last = k + 1;
            }
            _ => out.push(MoveRange { kind, first: k, last: k + 1 }),
        }
    }
    out
}

/// A closed walk turned so that it begins where two runs meet, or else where a piece begins.
fn turned(sampled: &Sampled, walk: &mut Walk) {
    let n = walk.moves.len();
    let found = move_ranges(sampled, walk);
    let whole = |k: &usize| sampled.at[walk.edges[*k][0]].parameter.fract() == 0.0;
    let start = if found.len() > 1 { found[1].first } else { (0..n).find(whole).unwrap_or(0) };
    walk.edges.truncate(n);
    walk.edges.rotate_left(start);
    walk.moves.rotate_left(start);
    walk.edges.push(walk.edges[0]);
}

/// The chain with its rulings where they belong.
fn polished(sampled: &Sampled, facets: &[[OnRail; 3]], mut walk: Walk, control: &Control) -> Option<RulingChain> {
    let closed = walk.ends[1] == End::Closed;
    if closed && walk.edges.first() != walk.edges.last() {
        return None;
    }
    if closed {
        turned(sampled, &mut walk);
    }
    let found = move_ranges(sampled, &walk);
    let rails = [0, 1].map(|d| sampled.at[walk.edges[0][d]].rail);
    let mut stations: Vec<[f64; 2]> = Vec::new();
    let mut joints = Vec::new();
    let along = walk.unwrapped(sampled);
    // On the turn of a closed curve that the walk is on at an edge.
    let turned = |s: [f64; 2], edge: usize| {
        [0, 1].map(|d| {
            let rail = &sampled.rails[rails[d]];
            let n = rail.pieces.len() as f64;
            s[d] + if rail.closed { ((along[edge][d] - s[d]) / n).round() * n } else { 0.0 }
        })
    };
    for (k, run) in found.iter().enumerate() {
        let before = if k > 0 { Some(&found[k - 1]) } else { found.last().filter(|_| closed) };
        let after = found.get(k + 1).or(if closed { found.first() } else { None });
        if k == 0 {
            let start = border(sampled, facets, &walk, run.first, [before, Some(run)], walk.ends[0]);
            stations.push(turned(start, run.first));
        } else {
            joints.push(stations.len() - 1);
        }
        let end = turned(border(sampled, facets, &walk, run.last, [Some(run), after], walk.ends[1]), run.last);
        if run.kind == Kind::Smooth {
            let first = stations.len() - 1;
            // Each for itself: the order is that of the edges.
            let found: Vec<[f64; 2]> = parallel::map(run.first + 1..run.last, |k| {
                let seen = || turned(between(sampled, walk.edges[k], kept(&walk, k)), k);
                (!control.stopped()).then(seen)
            })
            .into_iter()
            .flatten()
            .collect();
            if control.stopped() {
                return None;
            }
            stations.extend(found);
            stations.push(end);
            monotone(&mut stations, first);
        } else {
            stations.push(end);
        }
    }
    let tips = if closed { [false; 2] } else { walk.ends.map(|e| e == End::Tip) };
    let turns = walk.ends.map(|e| matches!(e, End::Turn { .. }));
    Some(RulingChain { rails, stations, joints, closed, tips, turns })
}

/// Edges beside a turn at which the side that does not turn is kept: where the other one hardly moves, two places belong to each of
/// its.
const BESIDE_TURN: usize = 6;

/// The side whose end is kept at an edge: the one that moved last.
fn kept(walk: &Walk, edge: usize) -> usize {
    let turning = |end: End, off: usize| match end {
        End::Turn { side, .. } if off <= BESIDE_TURN => Some(1 - side),
        _ => None,
    };
    let beside = turning(walk.ends[0], edge).or(turning(walk.ends[1], walk.moves.len() - edge));
    beside.unwrap_or(walk.moves[edge - 1].0)
}

/// Puts the stations after `first` in order and keeps those that lie strictly between those before and the last one.
fn monotone(stations: &mut Vec<[f64; 2]>, first: usize) {
    let (start, end) = (stations[first], stations[stations.len() - 1]);
    let sign = [0, 1].map(|d| (end[d] - start[d]).signum());
    let ahead = |p: &[f64; 2], q: &[f64; 2]| (0..2).all(|d| (q[d] - p[d]) * sign[d] > STILL);
    let mut kept = vec![start];
    let inner = first + 1..stations.len() - 1;
    let advance = |s: &[f64; 2]| sign[0] * s[0] + sign[1] * s[1];
    stations[inner.clone()].sort_by(|p, q| advance(p).total_cmp(&advance(q)));
    for s in stations[inner].iter() {
        if ahead(&kept[kept.len() - 1], s) && ahead(s, &end) {
            kept.push(*s);
        }
    }
    kept.push(end);
    stations.truncate(first);
    stations.extend(kept);
}

/// Parameter steps of rulings that are one and the same.
pub(super) const STILL: f64 = 1e-9;

fn place(sampled: &Sampled, i: usize) -> OnRail {
    sampled.at[i]
}

/// A ruling within a smooth run, with the end on this side kept where it is: the one that moved last, so that no two
/// rulings have the same end where one end hardly moves. Ends of pieces are kept, so that strips can be cut there.
fn between(sampled: &Sampled, e: [usize; 2], moved_last: usize) -> [f64; 2] {
    let whole = e.map(|i| place(sampled, i).parameter.fract() == 0.0);
    let kept = if whole[1 - moved_last] { 1 - moved_last } else { moved_last };
    let (p, q) = (place(sampled, e[kept]), place(sampled, e[1 - kept]));
    let rails = sampled.rails;
    let t = tangents(&rails[p.rail], p.parameter)[1];
    let h = sampled.reach(e[1 - kept]);
    let q = if p.rail == q.rail {
        // Without the factor that vanishes on the diagonal; lengths are counted in that of the ruling.
        let long = (q.point - p.point).norm();
        moved(rails, q, h, &|x, d| {
            let l = (x - p.point).norm() / long;
            if l > 0.0 {
                coplanarity(&p.point, &t, x, d) / (l * l * l)
            } else {
                0.0
            }
        })
    } else {
        opposite(rails, &p, &t, q, h)
    };
    if kept == 0 {
        [p.parameter, q.parameter]
    } else {
        [q.parameter, p.parameter]
    }
}

/// The ruling where two runs meet, or where the chain ends.
fn border(
    sampled: &Sampled,
    facets: &[[OnRail; 3]],
    walk: &Walk,
    edge: usize,
    [before, after]: [Option<&MoveRange>; 2],
    end: End,
) -> [f64; 2] {
    let rails = sampled.rails;
    let e = walk.edges[edge];
    let ends = e.map(|i| place(sampled, i));
    let plain = ends.map(|x| x.parameter);
    // 1. A facet along a straight piece: its third corner touches.
    for run in [before, after].into_iter().flatten() {
        if let Kind::Facet(rest) = run.kind {
            let straight = [walk.edges[run.first][1 - rest], walk.edges[run.last][1 - rest]];
            let [p, q] = straight.map(|i| place(sampled, i).point);
            let mut out = plain;
            out[rest] = touching(rails, ends[rest], &p, &q, sampled.reach(e[rest])).parameter;
            return out;
        }
    }
    // 2. The end of the chain at a facet.
    if before.is_none() || after.is_none() {
        return match end {
            End::Facet(f) => [0, 1].map(|d| nearest(sampled, &facets[f], &ends[d])),
            End::Turn { side, reach } if !ends.iter().any(|x| is_corner(&rails[x.rail], x.parameter)) => {
                // The nearest place of the column before the turn.
                let mut others = walk.edges.iter().map(|e| e[side]).filter(|i| *i != e[side]);
                match if edge == 0 { others.next() } else { others.next_back() } {
                    Some(inner) => farthest(sampled, e, side, reach, inner),
                    None => plain,
                }
            }
            End::Turn { side, .. }
                if smooth_beside(&[before, after]) && is_corner(&rails[ends[side].rail], ends[side].parameter) =>
            {
                from_corner(sampled, walk, edge, [before, after], side)
            }
            _ if ends.iter().any(|x| is_corner(&rails[x.rail], x.parameter)) => plain,
            _ => between(sampled, e, 0),
        };
    }
    // 3. A fan begins or ends beside a smooth run.
    let fan = [before, after].into_iter().flatten().find_map(|r| match r.kind {
        Kind::Fan(rest) => Some(rest),
        _ => None,
    });
    if let Some(rest) = fan.filter(|_| smooth_beside(&[before, after])) {
        return from_corner(sampled, walk, edge, [before, after], rest);
    }
    if ends.iter().any(|x| is_corner(&rails[x.rail], x.parameter)) {
        return plain;
    }
    between(sampled, e, 0)
}

fn smooth_beside(beside: &[Option<&MoveRange>; 2]) -> bool {
    beside.iter().flatten().any(|r| r.kind == Kind::Smooth)
}

/// The ruling from a corner on one side at which a smooth run begins or ends: in the plane of the run's tangent at the corner.
fn from_corner(sampled: &Sampled, walk: &Walk, edge: usize, beside: [Option<&MoveRange>; 2], rest: usize) -> [f64; 2] {
    let rails = sampled.rails;
    let e = walk.edges[edge];
    let ends = e.map(|i| place(sampled, i));
    let mut out = ends.map(|x| x.parameter);
    let Some(smooth) = beside.into_iter().flatten().find(|r| r.kind == Kind::Smooth) else { return out };
    let corner = ends[rest];
    let inner = place(sampled, walk.edges[if smooth.first == edge { smooth.last } else { smooth.first }][rest]);
    let t = one_sided(sampled, &corner, &inner);
    let q = opposite(rails, &corner, &t, ends[1 - rest], sampled.reach(e[1 - rest]));
    if !is_corner(&rails[q.rail], ends[1 - rest].parameter) {
        out[1 - rest] = q.parameter;
    }
    out
}

/// Tangent at a corner on the side on which another place of the curve lies.
fn one_sided(sampled: &Sampled, corner: &OnRail, inner: &OnRail) -> Vec3 {
    let rail = &sampled.rails[corner.rail];
    let n = rail.pieces.len() as f64;
    let mut off = inner.parameter - corner.parameter;
    if rail.closed {
        off -= (off / n).round() * n;
    }
    tangents(rail, corner.parameter)[usize::from(off > 0.0)]
}

/// Parameter of the facet's corner that began as the given sample.
fn nearest(sampled: &Sampled, facet: &[OnRail; 3], sample: &OnRail) -> f64 {
    let rail = &sampled.rails[sample.rail];
    let n = rail.pieces.len() as f64;
    let off = |c: &&OnRail| {
        let d = (c.parameter - sample.parameter).abs();
        if rail.closed {
            d.min(n - d)
        } else {
            d
        }
    };
    facet
        .iter()
        .filter(|c| c.rail == sample.rail)
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .map_or(sample.parameter, |c| c.parameter)
}
