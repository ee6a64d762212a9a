//! Which way round rails are run through, and where closed ones begin, as their branches of common tangent planes ask for
//! \[W15, 4\].

use super::branches::{branches, Branch, BranchOptions, BranchType, Direction};
use super::track::{Segment, Track};
use super::LoftError;
use crate::torse::rail::{Rail, SEAM};

/// Share of a rail that may be left over without a word.
pub const WHOLE: f64 = 1e-6;
/// Share of both rails that a branch uses at least where it tells their direction.
const TELLING: f64 = 0.1;
/// The ends of open rails tell their direction where they are together so much nearer to each other one way than the other.
const CLEAR: f64 = 0.95;

/// The second rail, turned round where its ends are nearer then, if both are open and their ends tell; else, if `by_branches`,
/// where the best branch runs against it. With its branches, and whether it was turned.
pub(crate) fn oriented(a: &Rail, b: Rail, by_branches: bool) -> (Rail, Vec<Branch>, bool) {
    let found = branches(a, &b, &BranchOptions::default());
    let merit = |d: Direction| {
        found
            .iter()
            .filter(|f| f.kind == BranchType::Regular && f.direction == d)
            .map(|f| f.coverage[0].min(f.coverage[1]))
            .fold(0.0, f64::max)
    };
    let ends = |b: &Rail| {
        let n = b.pieces.len() as f64;
        let m = a.pieces.len() as f64;
        (a.point(0.0) - b.point(0.0)).norm() + (a.point(m) - b.point(n)).norm()
    };
    // Between open rails the first and the last ruling must not cross: their ends go before branches, which may run either way
    // for a part of both.
    let (same, opposite) = (merit(Direction::Same), merit(Direction::Opposite));
    let turned = b.reversed();
    let open = !a.closed && !b.closed;
    let [straight, crossed] = [&b, &turned].map(ends);
    let ends_tell = open && straight.min(crossed) < CLEAR * straight.max(crossed);
    let turn = match by_branches && !ends_tell && same.max(opposite) > TELLING {
        true => opposite > same,
        false => open && crossed < straight,
    };
    if !turn {
        return (b, found, false);
    }
    let found = branches(a, &turned, &BranchOptions::default());
    (turned, found, true)
}

/// Closed rails turned so that both begin where a fan or facet of the closed branch begins: no strip is cut in two by
/// the place where a drawing happens to start. The branch, found once more, begins there too.
///
/// # Errors
/// A rail that cannot begin there.
pub(crate) fn seamed(
    a: &Rail,
    b: &Rail,
    branch: &Branch,
    alternative: usize,
) -> Result<([Rail; 2], Branch), LoftError> {
    const STILL: f64 = 1e-11;
    const MOVES: f64 = 1e-4;
    let as_it_is = || Ok(([a.clone(), b.clone()], branch.clone()));
    let s = &branch.stations;
    let n = s.len() - 1;
    let rests = |k: usize| {
        let (p, q) = (s[k % n], s[k % n + 1]);
        let d = [q[0] - p[0], q[1] - p[1]];
        (0..2).find(|&k| d[k] <= STILL && d[1 - k] > MOVES)
    };
    let corner = |d: usize, x: f64| {
        let track = if d == 0 { Track::new(a) } else { Track::new(b) };
        matches!(track.locate(x.rem_euclid(track.end()) + SEAM).0, Segment::Piece(_)) && (x - x.round()).abs() < SEAM
    };
    // A place where a fan about a corner ends: the corner's rail goes on from the beginning of a piece.
    let changes = |k: &usize| rests(k + n - 1) != rests(*k);
    let best = (0..n).filter(changes).max_by_key(|&k| [0, 1].iter().filter(|d| corner(**d, s[k][**d])).count());
    let Some(k) = best else { return as_it_is() };
    let start = |rail: &Rail, x: f64| {
        let track = Track::new(rail);
        rail.started_at(track.rail_parameter(x.rem_euclid(track.end()))).map_err(LoftError::from)
    };
    let (a2, b2) = (start(a, s[k][0])?, start(b, s[k][1])?);
    let again = branches(&a2, &b2, &BranchOptions::default());
    let same = again.into_iter().filter(is_candidate).nth(alternative.max(1) - 1).filter(|f| f.closed);
    let Some(mut found) = same else { return as_it_is() };
    let ends = [Track::new(&a2).end(), Track::new(&b2).end()];
    let off = |s: &[f64; 2]| (0..2).map(|d| (s[d] / ends[d] - (s[d] / ends[d]).round()).abs()).fold(0.0, f64::max);
    let n = found.stations.len() - 1;
    let Some(first) = (0..n).min_by(|&i, &j| off(&found.stations[i]).total_cmp(&off(&found.stations[j]))) else {
        return as_it_is();
    };
    const NEAR: f64 = 1e-7;
    if off(&found.stations[first]) > NEAR {
        return as_it_is();
    }
    // Stations from there on, a period later where the list began anew; both ends exactly at the seams.
    let turns = [0, 1].map(|d: usize| (found.stations[first][d] / ends[d]).round() * ends[d]);
    let mut stations: Vec<[f64; 2]> = (first..=first + n)
        .map(|i| [0, 1].map(|d: usize| found.stations[i % n][d] + if i >= n { ends[d] } else { 0.0 } - turns[d]))
        .collect();
    stations[0] = [0.0; 2];
    stations[n] = ends;
    found.stations = stations;
    Ok(([a2, b2], found))
}

/// Whether a branch may be used.
pub(crate) fn is_candidate(f: &Branch) -> bool {
    f.kind == BranchType::Regular && f.direction == Direction::Same && f.coverage[0].max(f.coverage[1]) > WHOLE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    /// Rails that run the same way, of which the branches that run against each other are the longer ones.
    #[test]
    fn open_rails_are_joined_at_their_near_ends() {
        let rail = |name: &str, y: f64, z: f64| {
            let at = |x: f64, z: f64| Vec3::new(x, y, z);
            Rail::polyline(name, &[at(0.0, 0.0), at(50.0, z), at(100.0, 0.0)]).expect("a rail")
        };
        let (a, b) = (rail("a", 0.0, 10.0), rail("b", 60.0, -10.0));
        assert!(!oriented(&a, b.clone(), true).2);
        assert!(oriented(&a, b.reversed(), true).2);
    }
}
