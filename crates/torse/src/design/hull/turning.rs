//! Where the ends of rulings turn round on a curve: both sides of the hull meet along it up to there \[W15, 4B\].
//!
//! A curve that stands out of the hull like a ridge is passed there on one side and back on the other. Its farthest ruling is
//! where its place on that curve is farthest as the other end goes on.

use super::contact::{on, opposite, tangents, wrap};
use super::sampled::Sampled;
use super::walk::{End, Walk};
use crate::num::golden_section;

/// Samples beyond those beside which the curve rests, within which its farthest place is looked for.
const BEYOND: f64 = 2.0;
/// Steps of the golden section: what is left of the bracket is the root of rounding.
const STEPS: usize = 44;

/// The walk in pieces on which both columns go one way.
pub(super) fn one_way(sampled: &Sampled, mut walk: Walk) -> Vec<Walk> {
    let closed = walk.is_closed();
    let mut found = turns(sampled, &walk, closed);
    let Some(&(first, ..)) = found.first() else { return vec![walk] };
    if closed {
        let n = walk.moves.len();
        walk.edges.truncate(n);
        walk.edges.rotate_left(first);
        walk.moves.rotate_left(first);
        walk.edges.push(walk.edges[0]);
        found.iter_mut().for_each(|t| t.0 -= first);
        let (_, side, reach) = found.remove(0);
        walk.ends = [End::Turn { side, reach }; 2];
    }
    let mut out = Vec::new();
    let (mut from, mut start) = (0, walk.ends[0]);
    let last = (walk.moves.len(), None);
    for (to, end) in found.iter().map(|t| (t.0, Some(End::Turn { side: t.1, reach: t.2 }))).chain([last]) {
        let end = end.unwrap_or(walk.ends[1]);
        if to > from {
            let (edges, moves) = (walk.edges[from..=to].to_vec(), walk.moves[from..to].to_vec());
            out.push(Walk { edges, moves, ends: [start, end] });
        }
        (from, start) = (to, end);
    }
    out
}

/// Edges (in order) at which a column turns round, that column, and how far (in parameters) the other one may be off there.
fn turns(sampled: &Sampled, walk: &Walk, closed: bool) -> Vec<(usize, usize, f64)> {
    let n = walk.moves.len();
    // Of every side the way it goes, and the move by which it went.
    let mut going: [Option<(bool, usize)>; 2] = [None; 2];
    let mut out = Vec::new();
    // Around closed walks three times, for the ways before and after what is counted once.
    for k in 0..if closed { 3 * n } else { n } {
        let (side, _) = walk.moves[k % n];
        let [a, b] = [k % n, k % n + 1].map(|e| sampled.at[walk.edges[e][side]]);
        let step = sampled.step_between(&a, &b);
        if let Some((_, before)) = going[side].filter(|g| g.0 != (step > 0.0)) {
            let rests = k - before - 1;
            let edge = before + 1 + rests / 2;
            if !closed || (n..2 * n).contains(&edge) {
                let other = sampled.at[walk.edges[edge % n][1 - side]].rail;
                out.push((edge % n, side, (0.5 * rests as f64 + BEYOND) * sampled.step[other]));
            }
        }
        going[side] = Some((step > 0.0, k));
    }
    out.sort_by_key(|t| t.0);
    out.dedup_by_key(|t| t.0);
    out
}

/// The ruling at a smooth place where a column turns round: both parameters.
pub(super) fn farthest(sampled: &Sampled, edge: [usize; 2], side: usize, reach: f64, inner: usize) -> [f64; 2] {
    let rails = sampled.rails;
    let (kept, turning) = (sampled.at[edge[1 - side]], sampled.at[edge[side]]);
    // The way to the turn, from a place of the column before it.
    let whole = rails[turning.rail].pieces.len() as f64;
    let unwrapped = |s: f64| match rails[turning.rail].closed {
        true => s - ((s - turning.parameter) / whole).round() * whole,
        false => s,
    };
    let way = (turning.parameter - unwrapped(sampled.at[inner].parameter)).signum();
    let place = |s: f64| {
        let x = on(rails, kept.rail, wrap(&rails[kept.rail], s));
        let t = tangents(&rails[kept.rail], x.parameter)[1];
        opposite(rails, &x, &t, turning, sampled.reach(edge[side])).parameter
    };
    let short = |s: f64| -way * unwrapped(place(s));
    let (mut lo, mut hi) = (kept.parameter - reach, kept.parameter + reach);
    if !rails[kept.rail].closed {
        (lo, hi) = (lo.max(0.0), hi.min(rails[kept.rail].pieces.len() as f64));
    }
    let s = golden_section::least(short, [lo, hi], STEPS).0;
    let mut out = [0.0; 2];
    (out[1 - side], out[side]) = (wrap(&rails[kept.rail], s), place(s));
    out
}
