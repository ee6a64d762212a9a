//! The strip of least twist between two rails: exact optimum over all triangle strips between samples \[W15, 5.3\].
//!
//! *Method.* Dynamic programming over (i, j, last move): a move advances one rail and adds a triangle; it costs the
//! square of the dihedral angle to the triangle before. Needs no tangents: corners make fans, straight pieces facets.

use super::track::{Segment, Track};
use super::LoftError;
use crate::geom::Vec3;
use crate::torse::rail::Rail;

/// Knobs of [`least_twist`].
#[derive(Clone, Debug)]
pub struct LeastTwistOptions {
    /// Chords of each rail; default 400.
    pub chords: usize,
    /// Rulings that must be used, as shares of both rails' lengths, in order; default none.
    pub fixed: Vec<[f64; 2]>,
}

impl Default for LeastTwistOptions {
    fn default() -> Self {
        Self { chords: 400, fixed: Vec::new() }
    }
}

/// A path of rulings with the triangles that it stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct TwistPath {
    /// Parameters on both tracks, not decreasing.
    pub stations: Vec<[f64; 2]>,
    /// Ends of the rulings, mm.
    pub rulings: Vec<[Vec3; 2]>,
    /// Sum of squared dihedral angles, rad².
    pub cost: f64,
    /// Area of the triangles, mm².
    pub area: f64,
    /// Whether the path goes round two closed rails.
    pub closed: bool,
    /// Stations of the fixed rulings.
    pub held: Vec<usize>,
}

/// Halvings in the search of a share of the length: to the last digit.
const HALVINGS: usize = 50;

/// Samples of a rail: parameter on the track and point.
struct Samples {
    x: Vec<f64>,
    points: Vec<Vec3>,
}

/// About `chords` chords, with points at the given shares of the length.
fn samples(rail: &Rail, chords: usize, shares: &[f64]) -> Samples {
    let track = Track::new(rail);
    let total = track.length().max(f64::MIN_POSITIVE);
    let mut out = Samples { x: Vec::new(), points: Vec::new() };
    for (k, segment) in track.segments.iter().enumerate() {
        let Segment::Piece(piece) = segment else { continue };
        let share = rail.piece_length(*piece, 1.0) / total;
        let parts = ((chords as f64 * share).round() as usize).max(1);
        for i in 0..parts {
            let x = k as f64 + i as f64 / parts as f64;
            out.x.push(x);
            out.points.push(track.at(x).point);
        }
    }
    let last = rail.pieces.len() as f64;
    out.x.push(track.end());
    out.points.push(rail.point(last));
    for share in shares.iter().filter(|s| (0.0..=1.0).contains(*s)) {
        let x = at_share(&track, *share);
        let k = out.x.partition_point(|y| *y < x);
        if out.x.get(k) != Some(&x) {
            out.x.insert(k, x);
            out.points.insert(k, track.at(x).point);
        }
    }
    out
}

/// The parameter of a track at a share of its rail's length.
fn at_share(track: &Track, share: f64) -> f64 {
    if share <= 0.0 {
        return 0.0;
    }
    if share >= 1.0 {
        return track.end();
    }
    let goal = share * track.length();
    let (mut lo, mut hi) = (0.0, track.end());
    for _ in 0..HALVINGS {
        let m = 0.5 * (lo + hi);
        if track.length_to(m) < goal {
            lo = m;
        } else {
            hi = m;
        }
    }
    0.5 * (lo + hi)
}

/// The triangle strip of least total squared bending between two rails, used from end to end.
///
/// On closed rails the path starts at the first rail's start; where on the second is found on a coarse sampling.
/// *Guarantee*: exact optimum of that cost for the samples. *Not guaranteed*: that the smooth strip through the rulings
/// is developable; its twist must be looked at.
/// *Cost*: 2 · chords² states.
///
/// # Errors
/// Fixed rulings that are not in order on the rails.
pub fn least_twist(a: &Rail, b: &Rail, options: &LeastTwistOptions) -> Result<TwistPath, LoftError> {
    let closed = a.closed && b.closed;
    let column = |d: usize| options.fixed.iter().map(|f| f[d]).collect::<Vec<f64>>();
    let (p, q) = (samples(a, options.chords, &column(0)), samples(b, options.chords, &column(1)));
    if closed && options.fixed.is_empty() {
        let costs = starts(a, b, COARSE.min(options.chords));
        let best = (0..costs.len()).min_by(|&i, &j| costs[i].total_cmp(&costs[j])).unwrap_or(0);
        return least_twist_from(a, b, options, best as f64 / costs.len() as f64);
    }
    // Fixed rulings cut the task into independent ones.
    let (ta, tb) = (Track::new(a), Track::new(b));
    let share = |s: &Samples, track: &Track, at: f64| {
        let x = at_share(track, at);
        s.x.partition_point(|y| *y < x).min(s.x.len() - 1)
    };
    let mut cuts = vec![[0, 0]];
    for (index, f) in options.fixed.iter().enumerate() {
        let next = [share(&p, &ta, f[0]), share(&q, &tb, f[1])];
        let last = cuts[cuts.len() - 1];
        let inside = f.iter().all(|x| (0.0..=1.0).contains(x));
        if !inside || next[0] < last[0] || next[1] < last[1] || (index > 0 && next == last) {
            return Err(LoftError::Fixed { index, at_a: f[0], at_b: f[1] });
        }
        cuts.push(next);
    }
    cuts.push([p.points.len() - 1, q.points.len() - 1]);
    let mut whole: Option<TwistPath> = None;
    for w in cuts.windows(2).filter(|w| w[0] != w[1]) {
        let (i, j) = (w[0][0]..=w[1][0], w[0][1]..=w[1][1]);
        let (moves, cost) = optimum(&p.points[i.clone()], &q.points[j.clone()]);
        let part = path((&p.x[i.clone()], &p.points[i]), (&q.x[j.clone()], &q.points[j]), &moves, cost, closed);
        whole = Some(match whole {
            None => part,
            Some(mut all) => {
                all.held.push(all.stations.len() - 1);
                all.stations.extend_from_slice(&part.stations[1..]);
                all.rulings.extend_from_slice(&part.rulings[1..]);
                all.cost += part.cost;
                all.area += part.area;
                all
            }
        });
    }
    whole.ok_or(LoftError::Fixed { index: 0, at_a: 0.0, at_b: 0.0 })
}

/// Chords where the start on the second of two closed rails is sought.
const COARSE: usize = 48;

/// Costs of the best strips between two closed rails whose first ruling begins at the first rail's start and at each
/// point of the second rail, sampled by about `chords` chords.
pub(super) fn starts(a: &Rail, b: &Rail, chords: usize) -> Vec<f64> {
    let (p, q) = (samples(a, chords, &[]), samples(b, chords, &[]));
    (0..q.points.len() - 1).map(|j| optimum(&p.points, &turn(&q.points, j)).1).collect()
}

/// The best strip between two closed rails that begins at the first rail's start and at the sample `start` (as a share of
/// all) of the second.
///
/// # Errors
/// None for valid rails.
pub(super) fn least_twist_from(
    a: &Rail,
    b: &Rail,
    options: &LeastTwistOptions,
    start: f64,
) -> Result<TwistPath, LoftError> {
    let (p, q) = (samples(a, options.chords, &[]), samples(b, options.chords, &[]));
    let n = q.points.len() - 1;
    let start = (start * n as f64).round() as usize % n;
    let turned = turn(&q.points, start);
    let end = q.x[n];
    let x: Vec<f64> = (0..=n).map(|k| if start + k <= n { q.x[start + k] } else { q.x[start + k - n] + end }).collect();
    let (moves, cost) = optimum(&p.points, &turned);
    Ok(path((&p.x, &p.points), (&x, &turned), &moves, cost, true))
}

/// Closed polyline (last point equal to the first) starting at its point `k`.
fn turn(points: &[Vec3], k: usize) -> Vec<Vec3> {
    let n = points.len() - 1;
    (0..=n).map(|i| points[(i + k) % n]).collect()
}

/// Stations of a polyline and its points.
type Stations<'a> = (&'a [f64], &'a [Vec3]);

/// The path that starts at both beginnings and takes the given steps: along the first polyline or the second.
fn path((x, p): Stations, (y, q): Stations, moves: &[bool], cost: f64, closed: bool) -> TwistPath {
    let (mut i, mut j) = (0, 0);
    let mut out = TwistPath {
        stations: vec![[x[0], y[0]]],
        rulings: vec![[p[0], q[0]]],
        cost,
        area: 0.0,
        closed,
        held: Vec::new(),
    };
    for &first in moves {
        let (a, b) = (p[i], q[j]);
        let c = if first {
            i += 1;
            p[i]
        } else {
            j += 1;
            q[j]
        };
        out.area += 0.5 * (b - a).cross(&(c - a)).norm();
        out.stations.push([x[i], y[j]]);
        out.rulings.push([p[i], q[j]]);
    }
    out
}

/// Square of the angle between unit vectors, from a quarter of the square of their distance.
fn squared_angle(a: &Vec3, b: &Vec3) -> f64 {
    let q = 0.25 * (a - b).norm_squared();
    if q < 0.02 {
        // asin² x = x² (1 + x²/3 + 8 x⁴/45 + 4 x⁶/35 + …).
        return 4.0 * q * (1.0 + q * (1.0 / 3.0 + q * (8.0 / 45.0 + q * (4.0 / 35.0 + q * (128.0 / 1575.0)))));
    }
    let half = q.min(1.0).sqrt().asin();
    4.0 * half * half
}

/// Moves (true: first rail) of the cheapest path from end to end, and its cost.
fn optimum(p: &[Vec3], q: &[Vec3]) -> (Vec<bool>, f64) {
    let (n, m) = (p.len(), q.len());
    // Normals of the triangles that moves to (i, j) add: by the first rail and by the second.
    let normal = |d: Vec3, r: Vec3| d.cross(&r).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    let row = |i: usize| -> (Vec<Vec3>, Vec<Vec3>) {
        (0..m)
            .map(|j| {
                let r = q[j] - p[i];
                let first = if i > 0 { normal(p[i] - p[i - 1], r) } else { Vec3::zeros() };
                let second = if j > 0 { normal(q[j] - q[j - 1], r) } else { Vec3::zeros() };
                (first, second)
            })
            .unzip()
    };
    const FAR: f64 = f64::INFINITY;
    // Costs of the row before: states entered by a move of the first and of the second rail.
    let mut cost: Vec<[f64; 2]> = vec![[FAR; 2]; m];
    // For each state and kind of last move: whether the move before was of the first rail.
    let mut from = vec![0u8; n * m];
    let mut before = row(0);
    // Along the first row only the second rail moves.
    for j in 1..m {
        cost[j][1] = if j == 1 { 0.0 } else { cost[j - 1][1] + squared_angle(&before.1[j - 1], &before.1[j]) };
    }
    for i in 1..n {
        let now = row(i);
        let mut next = vec![[FAR; 2]; m];
        for j in 0..m {
            // Enter by a move of the first rail, from (i − 1, j).
            let normal = &now.0[j];
            let options = if i == 1 && j == 0 {
                [0.0, FAR]
            } else {
                let step =
                    |k: usize, n: &Vec3| if cost[j][k] < FAR { cost[j][k] + squared_angle(n, normal) } else { FAR };
                [step(0, &before.0[j]), step(1, &before.1[j])]
            };
            let mut back = u8::from(options[0] <= options[1]);
            next[j][0] = options[0].min(options[1]);
            // Enter by a move of the second rail, from (i, j − 1).
            if j > 0 {
                let normal = &now.1[j];
                let step = |k: usize, n: &Vec3| {
                    if next[j - 1][k] < FAR {
                        next[j - 1][k] + squared_angle(n, normal)
                    } else {
                        FAR
                    }
                };
                let options = [step(0, &now.0[j - 1]), step(1, &now.1[j - 1])];
                back |= u8::from(options[0] <= options[1]) << 1;
                next[j][1] = options[0].min(options[1]);
            }
            from[i * m + j] = back;
        }
        cost = next;
        before = now;
    }
    let last = cost[m - 1];
    let mut first = last[0] <= last[1];
    let total = last[0].min(last[1]);
    let (mut i, mut j) = (n - 1, m - 1);
    let mut moves = Vec::with_capacity(n + m - 2);
    while i > 0 || j > 0 {
        // Borders leave no choice.
        first = if i == 0 {
            false
        } else if j == 0 {
            true
        } else {
            first
        };
        moves.push(first);
        let back = from[i * m + j];
        if first {
            first = back & 1 == 1;
            i -= 1;
        } else {
            first = back >> 1 & 1 == 1;
            j -= 1;
        }
    }
    moves.reverse();
    (moves, if total.is_finite() { total } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::geom::Frame;

    fn circle() -> Rail {
        let (c, _) = SpaceCurve::Ellipse { frame: Frame::world(), a: 1.0, b: 1.0 }
            .to_spline(0.0, std::f64::consts::TAU)
            .expect("spline");
        Rail::new("circle", &[c]).expect("rail")
    }

    fn square() -> Rail {
        // From the middle of an edge, so that both rails start at the same azimuth.
        let points = [(0.8, 0.0), (0.8, 0.8), (-0.8, 0.8), (-0.8, -0.8), (0.8, -0.8), (0.8, 0.0)];
        Rail::polyline("square", &points.map(|(x, y)| Vec3::new(x, y, 1.5))).expect("rail")
    }

    #[test]
    fn the_area_between_circle_and_square_converges_with_order_two() {
        let area = 9.565_584_009_167_319;
        let off: Vec<f64> = [32, 64, 128]
            .into_iter()
            .map(|chords| {
                let options = LeastTwistOptions { chords, ..LeastTwistOptions::default() };
                (least_twist(&circle(), &square(), &options).expect("path").area - area).abs()
            })
            .collect();
        assert!(off[2] < 6e-4 * area && off[0] / off[1] > 3.0 && off[1] / off[2] > 3.0, "{off:?}");
    }

    #[test]
    fn fixed_rulings_are_used_and_disorder_is_refused() {
        let line = |y: f64, z: f64| {
            Rail::polyline("line", &[Vec3::new(0.0, y, 0.0), Vec3::new(4.0, y, 0.0), Vec3::new(10.0, y, z)])
                .expect("rail")
        };
        let (a, b) = (line(0.0, 1.0), line(3.0, 2.0));
        let options = |fixed: Vec<[f64; 2]>| LeastTwistOptions { chords: 50, fixed };
        let path = least_twist(&a, &b, &options(vec![[0.3, 0.5]])).expect("path");
        let (la, lb) = (0.3 * a.length(), 0.5 * b.length());
        let met = path.rulings.iter().any(|r| {
            (r[0] - a.point(0.0)).norm() - la < 0.3 && ((r[0].x - la).abs() < 0.3) && (r[1].x - lb).abs() < 0.5
        });
        assert!(met);
        let e = least_twist(&a, &b, &options(vec![[0.5, 0.5], [0.4, 0.6]])).expect_err("disorder");
        assert!(matches!(e, LoftError::Fixed { index: 1, .. }));
    }
}
