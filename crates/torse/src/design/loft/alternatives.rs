//! Several strips of little twist between two rails, distinct from each other.
//!
//! *Method.* Every path between two open rails crosses the line that joins their far corners in the plane of both
//! parameters. The cheapest path through each point of it, on a coarse sampling, is found by dynamic programming
//! \[W15, 5.3\]; local minima of its cost are the alternatives, and each is found again on the fine sampling. On closed
//! rails the places where rulings can begin on the second rail stand for that line.

use super::branches::twist;
use super::least_twist::{least_twist, least_twist_from, starts, LeastTwistOptions, TwistPath};
use super::track::Track;
use super::LoftError;
use crate::torse::rail::Rail;

/// Chords of the coarse sampling.
const COARSE: usize = 64;
/// Points of the line across.
const ACROSS: usize = 33;
/// Largest difference between shares of the lengths, at the same ruling of the other rail, up to which two paths are
/// the same.
const SAME: f64 = 0.03;
/// Places where paths are compared.
const PLACES: usize = 64;
/// A path that costs this many times the best one is no alternative.
const COSTLY: f64 = 100.0;

/// Strips of little twist, the best first: the optimum of [`least_twist`] and at most `count - 1` others.
///
/// Where rulings are fixed there are no others. *Not guaranteed*: others are local optima of a coarse sampling across the
/// middle; there may be more.
/// *Cost*: about that of three more dynamic programmes, and one for each alternative.
///
/// # Errors
/// As [`least_twist`].
pub(crate) fn alternatives(
    a: &Rail,
    b: &Rail,
    options: &LeastTwistOptions,
    count: usize,
) -> Result<Vec<TwistPath>, LoftError> {
    let mut out = vec![least_twist(a, b, options)?];
    if count < 2 || !options.fixed.is_empty() {
        return Ok(out);
    }
    let mut others: Vec<TwistPath> = Vec::new();
    if a.closed && b.closed {
        let costs = starts(a, b, COARSE);
        for k in minima(&costs, true) {
            others.extend(least_twist_from(a, b, options, k as f64 / costs.len() as f64));
        }
    } else {
        let through = |k: usize| [k as f64 / (ACROSS - 1) as f64, 1.0 - k as f64 / (ACROSS - 1) as f64];
        let path = |k: usize, chords: usize| least_twist(a, b, &LeastTwistOptions { chords, fixed: vec![through(k)] });
        let costs: Vec<f64> =
            (0..ACROSS).map(|k| path(k, COARSE).map_or(f64::INFINITY, |p| p.cost + join(&p))).collect();
        for k in minima(&costs, false) {
            // A place passed, not a ruling that must stay.
            others.extend(path(k, options.chords).map(|p| TwistPath {
                cost: p.cost + join(&p),
                held: Vec::new(),
                ..p
            }));
        }
    }
    others.sort_by(|p, q| p.cost.total_cmp(&q.cost));
    for p in others {
        let distinct = out.iter().all(|q| difference(a, b, &p, q) > SAME);
        if out.len() < count && distinct && p.cost <= COSTLY * out[0].cost.max(f64::MIN_POSITIVE) {
            out.push(p);
        }
    }
    Ok(out)
}

/// Greatest oriented twist along a path, rad.
pub(crate) fn greatest_twist(a: &Rail, b: &Rail, path: &TwistPath) -> f64 {
    let (ta, tb) = (Track::new(a), Track::new(b));
    path.stations.iter().filter_map(|s| twist(&ta.at(s[0]), &tb.at(s[1]))).fold(0.0, f64::max)
}

/// Square of the angle by which the triangles on both sides of the held ruling differ: what cutting there leaves out.
fn join(path: &TwistPath) -> f64 {
    let n = path.rulings.len();
    let Some(&k) = path.held.first().filter(|k| **k > 0 && **k + 1 < n) else { return 0.0 };
    let (p, r, q) = (path.rulings[k - 1], path.rulings[k], path.rulings[k + 1]);
    let along = |s: [crate::geom::Vec3; 2], t: [crate::geom::Vec3; 2]| (t[0] - s[0]) + (t[1] - s[1]);
    let e = r[1] - r[0];
    let (x, y) = (along(p, r).cross(&e), along(r, q).cross(&e));
    x.cross(&y).norm().atan2(x.dot(&y)).powi(2)
}

/// Indices of local minima; plateaus count once.
fn minima(costs: &[f64], closed: bool) -> Vec<usize> {
    let n = costs.len();
    let at = |k: isize| -> f64 {
        if closed {
            costs[k.rem_euclid(n as isize) as usize]
        } else {
            usize::try_from(k).ok().and_then(|k| costs.get(k)).copied().unwrap_or(f64::INFINITY)
        }
    };
    (0..n).filter(|&k| costs[k] < at(k as isize - 1) && costs[k] <= at(k as isize + 1)).collect()
}

/// Greatest difference between the shares of the second rail's length that two paths join to the same point of the first,
/// and the other way round.
fn difference(a: &Rail, b: &Rail, p: &TwistPath, q: &TwistPath) -> f64 {
    let rails = [a, b];
    let tracks = rails.map(Track::new);
    let shares = |path: &TwistPath, d: usize| -> Vec<f64> {
        let track = &tracks[d];
        let total = track.length().max(f64::MIN_POSITIVE);
        let of = |x: f64| {
            let turns = if rails[d].closed { (x / track.end()).floor() } else { 0.0 };
            turns + track.length_to(x - turns * track.end()) / total
        };
        // Lengths cost quadratures: a few stations tell.
        let step = (path.stations.len() / PLACES).max(1);
        path.stations.iter().step_by(step).map(|s| of(s[d])).collect()
    };
    let (p, q) = ([shares(p, 0), shares(p, 1)], [shares(q, 0), shares(q, 1)]);
    // A path as a function of the sum of both shares, from which both can be told.
    let at = |path: &[Vec<f64>; 2], sum: f64| -> f64 {
        let n = path[0].len();
        let total = |i: usize| path[0][i] + path[1][i] - path[0][0] - path[1][0];
        let k = (1..n).find(|&i| total(i) >= sum).unwrap_or(n - 1);
        let (x, y) = (total(k - 1), total(k));
        let t = if y > x { ((sum - x) / (y - x)).clamp(0.0, 1.0) } else { 0.0 };
        let lean = |i: usize| path[1][i] - path[0][i];
        lean(k - 1) + (lean(k) - lean(k - 1)) * t
    };
    let wrap = |x: f64| if a.closed && b.closed { x - x.round() } else { x };
    (0..=PLACES)
        .map(|k| 2.0 * k as f64 / PLACES as f64)
        .map(|sum| 0.5 * wrap(at(&p, sum) - at(&q, sum)).abs())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    fn square(z: f64, r: f64) -> Rail {
        let points: Vec<Vec3> = (0..=4)
            .map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2)
            .map(|t| Vec3::new(r * t.cos(), r * t.sin(), z))
            .collect();
        Rail::polyline("square", &points).expect("rail")
    }

    #[test]
    fn between_two_squares_turned_against_each_other_there_are_several_strips() {
        let (a, b) = (square(0.0, 100.0), square(60.0, 80.0));
        let options = LeastTwistOptions { chords: 120, ..LeastTwistOptions::default() };
        let found = alternatives(&a, &b, &options, 4).expect("paths");
        assert!(found.len() >= 2, "{:?}", found.iter().map(|p| p.cost).collect::<Vec<_>>());
        assert!(found.windows(2).all(|w| w[0].cost <= w[1].cost * (1.0 + 1e-9)));
        for (i, p) in found.iter().enumerate() {
            assert!(found[..i].iter().all(|q| difference(&a, &b, p, q) > SAME));
            assert!(difference(&a, &b, p, p) == 0.0 && greatest_twist(&a, &b, p) <= std::f64::consts::PI);
        }
        // One is enough where one is asked for, and rulings that are fixed leave no choice.
        assert_eq!(alternatives(&a, &b, &options, 1).expect("path").len(), 1);
    }

    #[test]
    fn minima_are_found_at_ends_and_across_the_seam() {
        assert_eq!(minima(&[1.0, 2.0, 0.5, 0.5, 3.0, 2.0], false), [0, 2, 5]);
        assert_eq!(minima(&[1.0, 2.0, 0.5, 0.5, 3.0, 2.0], true), [0, 2]);
        assert!(minima(&[f64::INFINITY; 4], false).is_empty());
    }
}
