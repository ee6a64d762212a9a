//! Runs that go on beyond a place where the zero set of `det(a', b', b − a)` crosses itself, or is no line.
//!
//! At an inflection that two rails have in common, as an S-shaped curve and its copy do, the line of parallel tangents is crossed
//! by another, which pairs places on both sides of the inflection and runs backwards on one rail; where straight parts of both rails
//! are parallel, every pair of their places is a zero. The chains of a grid turn off at such places, and runs end there though
//! another begins. Both are one if the straight way from one to the other in the plane of both parameters is a zero, too. Through
//! straight parts it leads from corner to corner.

use super::branch::{used_share, Branch, BranchType, Direction};
use super::track::{LineElement, Track};
use crate::num::parallel;

/// Determinant up to which a way between two runs is a zero of it: the twist that fitted rulings may have.
const ZERO: f64 = 1e-6;
/// Places looked at on a way.
const LOOKED_AT: usize = 16;
/// Stations that the end of a run may have beside the place where it turned off.
const TURNED_OFF: usize = 8;
/// Share of both tracks that runs must pass to be linked, corners included: shorter ones are crumbs of the grid.
const LEAST_LENGTH: f64 = 1e-3;
/// Steps of a parameter below which a rail rests.
const REST: f64 = 1e-10;
/// Turn (rad) from node to node below which a rail is straight: what rounding leaves of it.
const STRAIGHT: f64 = 1e-12;
/// Determinant between straight parts that are parallel, at most: rounding.
const PARALLEL: f64 = 1e-10;
/// Stations on the way through straight parts.
const THROUGH: usize = 9;
/// Runs and parts to be linked at most: rails that are all noise have thousands, and none goes on.
const MOST_LINKED: usize = 400;

/// A run, or the way through straight parts of both rails.
struct Linkable {
    run: Branch,
    /// Whether runs belong to it: a way through straight parts alone is none.
    is_run: bool,
}

/// The runs with those joined that follow each other, the nearest first; `nodes` of both tracks are those of the grid.
pub(super) fn linked(
    runs: Vec<Branch>,
    tracks: [&Track; 2],
    nodes: [&[f64]; 2],
    f: &(dyn Fn(f64, f64) -> f64 + Sync),
) -> Vec<Branch> {
    let link = Linker { tracks, f };
    let (able, mut out): (Vec<Branch>, Vec<Branch>) = runs.into_iter().partition(|r| link.is_able(r));
    let mut pieces: Vec<Linkable> = able.into_iter().map(|run| Linkable { run, is_run: true }).collect();
    if (1..=MOST_LINKED).contains(&pieces.len()) {
        pieces.extend(
            link.straight_parts(nodes).into_iter().take(MOST_LINKED).map(|run| Linkable { run, is_run: false }),
        );
        while let Some((p, q, way)) = link.nearest(&pieces) {
            let joined = link.joined(&pieces[p].run, &pieces[q].run, &way, p == q);
            let is_run = pieces[p].is_run || pieces[q].is_run;
            pieces.remove(p.max(q));
            if p != q {
                pieces.remove(p.min(q));
            }
            pieces.push(Linkable { run: joined, is_run });
        }
    }
    out.extend(pieces.into_iter().filter(|p| p.is_run).map(|p| p.run));
    out
}

/// Stations at the end of a run at which it may be left: its last ones, and where one rail comes to rest for the rest of the run.
fn exits(stations: &[[f64; 2]]) -> Vec<usize> {
    let last = stations.len() - 1;
    let mut out: Vec<usize> = (0..=TURNED_OFF.min(last)).map(|k| last - k).collect();
    for d in 0..2 {
        let rests = |k: &usize| (stations[*k][d] - stations[last][d]).abs() <= REST;
        let from = (0..=last).rev().take_while(rests).last().unwrap_or(last);
        if !out.contains(&from) {
            out.push(from);
        }
    }
    out
}

/// The same at the beginning.
fn entries(stations: &[[f64; 2]]) -> Vec<usize> {
    let turned: Vec<[f64; 2]> = stations.iter().rev().copied().collect();
    exits(&turned).into_iter().map(|k| stations.len() - 1 - k).collect()
}

/// A way from a station of one run to a station of another.
struct Way {
    from: usize,
    to: usize,
    /// By how much the second is moved, whole periods of closed rails.
    shift: [f64; 2],
    length: f64,
}

struct Linker<'a> {
    tracks: [&'a Track<'a>; 2],
    f: &'a (dyn Fn(f64, f64) -> f64 + Sync),
}

impl Linker<'_> {
    /// Whether a run may be one with others.
    fn is_able(&self, run: &Branch) -> bool {
        let (first, last) = (run.stations[0], run.stations[run.stations.len() - 1]);
        let is_long = (0..2).all(|d: usize| last[d] - first[d] > LEAST_LENGTH * self.tracks[d].end());
        !run.closed && is_long && run.kind == BranchType::Regular && run.direction == Direction::Same
    }

    /// The two that are nearest to each other, and the way between them.
    fn nearest(&self, pieces: &[Linkable]) -> Option<(usize, usize, Way)> {
        let of = |p: usize| {
            let ways = (0..pieces.len())
                .filter_map(move |q| Some((p, q, self.between(&pieces[p].run, &pieces[q].run, p == q)?)));
            ways.min_by(|a, b| a.2.length.total_cmp(&b.2.length))
        };
        let all: Vec<_> =
            parallel::map((0..pieces.len()).filter(|p| !pieces[*p].run.closed), of).into_iter().flatten().collect();
        all.into_iter().min_by(|a, b| a.2.length.total_cmp(&b.2.length))
    }

    /// The shortest way from the end of a run to the beginning of another, or of itself a period on.
    fn between(&self, p: &Branch, q: &Branch, is_same: bool) -> Option<Way> {
        if q.closed {
            return None;
        }
        let periods = self.tracks.map(|t| if t.rail.closed { vec![-t.end(), 0.0, t.end()] } else { vec![0.0] });
        let shifts = periods[0].iter().flat_map(|&x| periods[1].iter().map(move |&y| [x, y]));
        let (exits, entries) = (exits(&p.stations), entries(&q.stations));
        let mut best: Option<Way> = None;
        for shift in shifts {
            // A run goes on in itself only where it goes round both rails.
            if is_same && shift.iter().any(|x| *x <= 0.0) {
                continue;
            }
            for (&from, &to) in exits.iter().flat_map(|e| entries.iter().map(move |s| (e, s))) {
                if from == 0 || to + 1 == q.stations.len() || (is_same && to >= from) {
                    continue;
                }
                let least = best.as_ref().map_or(f64::INFINITY, |w| w.length);
                best = self
                    .way([p.stations[from], q.stations[to]], shift, least)
                    .map_or(best, |length| Some(Way { from, to, shift, length }));
            }
        }
        best.map(|way| self.without_turns(p, q, way, is_same))
    }

    /// A way from where both runs have not turned off yet: stations beside a crossing lie a little off their line.
    fn without_turns(&self, p: &Branch, q: &Branch, way: Way, is_same: bool) -> Way {
        let able = |k: usize| {
            let (from, to) = (way.from.checked_sub(k).filter(|f| *f > 0)?, way.to + k);
            let within = to + 1 < q.stations.len() && !(is_same && to >= from);
            within.then(|| self.way([p.stations[from], q.stations[to]], way.shift, f64::INFINITY))?.map(|_| (from, to))
        };
        let farthest = (1..=TURNED_OFF).rev().find_map(able);
        match farthest {
            Some((from, to)) => Way { from, to, ..way },
            None => way,
        }
    }

    /// Length of the way between two stations; `None` where it is not below `least`, runs back on a rail, or is no zero.
    fn way(&self, [from, to]: [[f64; 2]; 2], shift: [f64; 2], least: f64) -> Option<f64> {
        let step = [0, 1].map(|d: usize| to[d] + shift[d] - from[d]);
        let length = step[0].hypot(step[1]);
        let is_zero = |k: usize| {
            let at = [0, 1].map(|d: usize| from[d] + step[d] * k as f64 / LOOKED_AT as f64);
            (self.f)(at[0], at[1]).abs() <= ZERO
        };
        let holds =
            length < least && step.iter().all(|d| *d >= 0.0) && is_zero(LOOKED_AT / 2) && (1..LOOKED_AT).all(is_zero);
        holds.then_some(length)
    }

    /// Two runs as one; a run with itself is a closed one.
    fn joined(&self, p: &Branch, q: &Branch, way: &Way, is_same: bool) -> Branch {
        let kept = &p.stations[..=way.from];
        let moved = |s: &[f64; 2]| [s[0] + way.shift[0], s[1] + way.shift[1]];
        let mut stations: Vec<[f64; 2]> = match is_same {
            // From the first station that is kept to the same a period on.
            true => kept[way.to..].iter().copied().chain([moved(&p.stations[way.to])]).collect(),
            false => kept.iter().copied().chain(q.stations[way.to..].iter().map(moved)).collect(),
        };
        stations.dedup();
        self.run(stations, is_same)
    }

    /// A regular run over stations.
    fn run(&self, stations: Vec<[f64; 2]>, closed: bool) -> Branch {
        let used = |d: usize| used_share(self.tracks[d], stations[0][d], stations[stations.len() - 1][d]);
        let coverage = [used(0), used(1)];
        Branch { stations, kind: BranchType::Regular, direction: Direction::Same, closed, coverage }
    }

    /// Ways from corner to corner through straight parts of both rails that are parallel.
    fn straight_parts(&self, nodes: [&[f64]; 2]) -> Vec<Branch> {
        let parts = [0, 1].map(|d: usize| straight(self.tracks[d], nodes[d]));
        let mut out = Vec::new();
        for (a, b) in parts[0].iter().flat_map(|a| parts[1].iter().map(move |b| (a, b))) {
            let is_zero = (self.f)(0.5 * (a.0[0] + a.0[1]), 0.5 * (b.0[0] + b.0[1])).abs() <= PARALLEL;
            if is_zero && a.1.cross(&b.1).norm() <= PARALLEL && a.1.dot(&b.1) > 0.0 {
                let at = |s: [f64; 2], k: usize| s[0] + (s[1] - s[0]) * k as f64 / (THROUGH - 1) as f64;
                out.push(self.run((0..THROUGH).map(|k| [at(a.0, k), at(b.0, k)]).collect(), false));
            }
        }
        out
    }
}

/// A straight part of a rail: its parameters and its direction.
type Straight = ([f64; 2], crate::geom::Vec3);

/// Straight parts of a track between nodes of a grid.
fn straight(track: &Track, nodes: &[f64]) -> Vec<Straight> {
    let mut at: Vec<f64> = nodes.to_vec();
    if track.rail.closed {
        at.push(track.end());
    }
    // Just inside of what lies between two nodes, as tangents jump at the ends of pieces.
    let inside = |w: &[f64], share: f64| track.at(w[0] + (w[1] - w[0]) * share);
    let goes_on = |p: &LineElement, q: &LineElement| {
        p.tangent.cross(&q.tangent).norm() <= STRAIGHT && p.tangent.dot(&q.tangent) > 0.0
    };
    let mut out: Vec<Straight> = Vec::new();
    let mut open = false;
    for w in at.windows(2) {
        let (p, q) = (inside(w, 0.01), inside(w, 0.99));
        let way = q.point - p.point;
        let along = way.norm() > 0.0 && goes_on(&p, &q) && goes_on(&p, &LineElement { tangent: way.normalize(), ..q });
        let last = out.last_mut().filter(|last| open && along && last.1.cross(&p.tangent).norm() <= STRAIGHT);
        if let Some(last) = last {
            last.0[1] = w[1];
        } else if along {
            out.push(([w[0], w[1]], p.tangent));
        }
        open = along;
    }
    out
}
