//! Rulings towards a tip of a hull's boundary, where they shrink to a point of one curve \[W15, 5.1\].

use super::chains::STILL;
use super::contact::{coplanarity, tangents, wrap};
use crate::geom::Vec3;
use crate::torse::rail::Rail;

/// Length of rulings near a tip, share of the curve's size, below which the samples are too near each other to be told
/// apart by a change of sign.
const SHORT: f64 = 0.05;
/// Steps by which the middle of a ruling near a tip is put right, and the change, share of the half distance, at which
/// it has arrived.
const RIGHTINGS: usize = 12;
/// See [`RIGHTINGS`].
const RIGHT: f64 = 1e-12;
/// Length of rulings, share of the curve's size, at which rounding of points turns them by as much as twist may be.
const ROUNDED: f64 = 1e-6;
/// Places between the ends of a ruling at which the height of the curve over it is looked at.
const PLACES: usize = 16;
/// Share of a determinant below which another one is no rounding of it.
const BY_FAR: f64 = 0.01;
/// First step of the middle, share of the half distance.
const TRIED: f64 = 1e-3;

/// Stations with the rulings between the last one and the chain's tip put in order: short ones are replaced by halvings
/// of the distance left, until the curve lies within `height` (mm) of the last one. Their middles are extrapolated
/// from longer rulings, on which they depend as an even function of the half distance where the curve is smooth, and moved
/// until the ruling is coplanar with both tangents: rounding of the determinant, which is of third order in the length l,
/// moves the middle by no more than its share of l⁻², and the tangent planes by its share of l⁻¹. A fan about a place of the
/// curve itself is brought as near instead.
pub(super) fn towards_tip(rail: &Rail, mut stations: Vec<[f64; 2]>, height: f64) -> Vec<[f64; 2]> {
    const HALVINGS: usize = 60;
    const KNOWN: usize = 3;
    let n = rail.pieces.len() as f64;
    let point = |s: f64| rail.point(wrap(rail, s));
    let length = |s: &[f64; 2]| (point(s[1]) - point(s[0])).norm();
    let size = rail.bbox().diagonal();
    if let Some(rest) = fan_at_end(&stations) {
        nearer(rail, &mut stations, rest, height);
        return stations;
    }
    while stations.len() > KNOWN && length(&stations[stations.len() - 1]) < SHORT * size {
        stations.pop();
    }
    if stations.len() < KNOWN {
        return stations;
    }
    // Both parameters on one turn.
    let last = stations[stations.len() - 1];
    let turns = if rail.closed { ((last[1] - last[0]) / n).round() * n } else { 0.0 };
    let mut known: Vec<[f64; 2]> = stations[stations.len() - KNOWN..]
        .iter()
        .map(|s| [0.5 * (s[1] - turns - s[0]), 0.5 * (s[0] + s[1] - turns)])
        .collect();
    for _ in 0..HALVINGS {
        let half = 0.5 * known[KNOWN - 1][0];
        let middle = best_middle(rail, half, &known);
        let next = [middle - half, middle + half + turns];
        if !next.iter().all(|x| x.is_finite()) || length(&next) <= ROUNDED * size {
            break;
        }
        stations.push(next);
        if arc_height(rail, next[0], next[1] - turns) <= height {
            break;
        }
        known.remove(0);
        known.push([half, middle]);
    }
    stations
}

/// The side whose end rests between the last two stations, if one does.
fn fan_at_end(stations: &[[f64; 2]]) -> Option<usize> {
    let [.., a, b] = stations else { return None };
    (0..2).find(|&d| (a[d] - b[d]).abs() <= STILL)
}

/// Brings the last ruling of a fan about a place of its own curve nearer to that, by halvings and from one end of a piece to the next,
/// until the arc between its ends is within `height` (mm) of it.
fn nearer(rail: &Rail, stations: &mut [[f64; 2]], rest: usize, height: f64) {
    const STEPS: usize = 60;
    let n = rail.pieces.len() as f64;
    let Some(last) = stations.last_mut() else { return };
    let long = last[1 - rest] - last[rest];
    let turns = if rail.closed { (long / n).round() * n } else { 0.0 };
    let (corner, mut off) = (last[rest] + turns, long - turns);
    for _ in 0..STEPS {
        if arc_height(rail, corner, corner + off) <= height {
            break;
        }
        let way = off.signum();
        let end_of_piece = way * ((way * (corner + off) - STILL).ceil() - 1.0) - corner;
        off = way * (way * end_of_piece).max(way * 0.5 * off);
    }
    last[1 - rest] = corner + off;
}

/// Distance (mm) of the curve between two parameters, which may lie beyond the domain of a closed curve, from the line
/// through both places, at samples.
fn arc_height(rail: &Rail, from: f64, to: f64) -> f64 {
    let at = |s: f64| rail.point(wrap(rail, s));
    let (p, q) = (at(from), at(to));
    let along = (q - p).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    let off = |k: usize| {
        let d = at(from + (to - from) * k as f64 / PLACES as f64) - p;
        (d - along * d.dot(&along)).norm()
    };
    (1..PLACES).map(off).fold(0.0, f64::max)
}

/// The middle at a half distance from three known ones. It is an even function of it where the curve is smooth; where its torsion
/// jumps, as splines have it at knots, it is not, and what leads to a ruling that is coplanar by far is taken.
fn best_middle(rail: &Rail, half: f64, known: &[[f64; 2]]) -> f64 {
    let [even, any] = [2, 1].map(|power| righted(rail, half, extrapolated(known, half, power)));
    let off = |m: f64| uneven(rail, half, m).abs();
    if off(any) < BY_FAR * off(even) {
        any
    } else {
        even
    }
}

/// The middle at a half distance from known ones: Lagrange in a power of the half distance.
fn extrapolated(known: &[[f64; 2]], half: f64, power: i32) -> f64 {
    let at = |i: usize| known[i][0].powi(power);
    let term = |i: usize| {
        (0..known.len()).filter(|j| *j != i).fold(known[i][1], |m, j| m * (half.powi(power) - at(j)) / (at(i) - at(j)))
    };
    (0..known.len()).map(term).sum()
}

/// How far the ruling with this half distance and middle is from coplanar with both tangents.
fn uneven(rail: &Rail, half: f64, middle: f64) -> f64 {
    let ends = [middle - half, middle + half].map(|s| (rail.point(wrap(rail, s)), tangents(rail, s)[1]));
    coplanarity(&ends[0].0, &ends[0].1, &ends[1].0, &ends[1].1)
}

/// The middle of the ruling with this half distance that is coplanar with both tangents: secants from the one given, which
/// stays where they lead farther away than the ruling is long.
fn righted(rail: &Rail, half: f64, given: f64) -> f64 {
    let value = |m: f64| uneven(rail, half, m);
    let (mut x, mut y) = (given, given + TRIED * half);
    let (mut fx, mut fy) = (value(x), value(y));
    for _ in 0..RIGHTINGS {
        let step = fy * (y - x) / (fy - fx);
        if !step.is_finite() {
            break;
        }
        (x, fx) = (y, fy);
        y -= step;
        fy = value(y);
        if step.abs() <= RIGHT * half.abs() {
            break;
        }
    }
    if (y - given).abs() <= half.abs() && fy.abs() <= value(given).abs() {
        y
    } else {
        given
    }
}
