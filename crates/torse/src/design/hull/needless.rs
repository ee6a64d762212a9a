//! Curves that lie on the hull of their neighbours, such as frames between two others of a straight skin: every ruling there
//! touches three curves, and which two it belongs to would be left to rounding.

use crate::geom::convex_hull::convex_hull;
use crate::geom::Vec3;
use crate::torse::rail::Rail;

/// Samples of a curve to begin with, and at most.
const SAMPLES: [usize; 2] = [256, 4096];
/// Fewest samples on a piece.
const FEWEST_SAMPLES: usize = 8;

/// Indices of curves that come out of the hull of the ones before and behind them by no more than twice `within` (mm) at
/// samples; before and behind along the line between the two curves that are farthest apart. These two are never among them.
pub(crate) fn needless(rails: &[Rail], within: f64) -> Vec<usize> {
    let middles: Vec<Vec3> = rails.iter().map(|r| 0.5 * (r.bbox().min + r.bbox().max)).collect();
    let pairs = (0..rails.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let apart = |&(i, j): &(usize, usize)| (middles[i] - middles[j]).norm();
    let Some((i, j)) = pairs.max_by(|p, q| apart(p).total_cmp(&apart(q))) else { return Vec::new() };
    let axis = middles[i] - middles[j];
    let mut left: Vec<usize> = (0..rails.len()).collect();
    left.sort_by(|p, q| axis.dot(&middles[*p]).total_cmp(&axis.dot(&middles[*q])));
    let mut out = Vec::new();
    // Where one is left out, those beside it have other neighbours.
    while let Some(k) = (1..left.len().saturating_sub(1)).find(|k| {
        let beside = [&rails[left[k - 1]], &rails[left[k + 1]]];
        covers(beside, &rails[left[*k]], within)
    }) {
        out.push(left.remove(k));
    }
    out.sort_unstable();
    out
}

/// Whether a curve comes out of the hull of two others by no more than twice `within` at samples.
fn covers(others: [&Rail; 2], rail: &Rail, within: f64) -> bool {
    let mut count = SAMPLES[0];
    while others.iter().any(|r| sag(r, count) > within) {
        count *= 2;
        if count > SAMPLES[1] {
            return false;
        }
    }
    let points: Vec<Vec3> = others.iter().flat_map(|r| samples(r, count)).collect();
    let Some(hull) = convex_hull(&points, &|| false) else { return false };
    let planes: Vec<(Vec3, f64)> = hull
        .iter()
        .filter_map(|f| {
            let [a, b, c] = f.map(|i| points[i]);
            let n = (b - a).cross(&(c - a)).try_normalize(0.0)?;
            Some((n, n.dot(&a)))
        })
        .collect();
    samples(rail, SAMPLES[0]).all(|p| planes.iter().all(|(n, d)| n.dot(&p) - d <= 2.0 * within))
}

/// Parameter steps on each piece.
fn steps(rail: &Rail, k: usize, count: usize) -> usize {
    if rail.is_straight(k) {
        1
    } else {
        count.div_ceil(rail.pieces.len()).max(FEWEST_SAMPLES)
    }
}

fn samples(rail: &Rail, count: usize) -> impl Iterator<Item = Vec3> + '_ {
    let last = rail.point(rail.pieces.len() as f64);
    let on = move |k: usize| {
        let n = steps(rail, k, count);
        (0..n).map(move |i| rail.point(k as f64 + i as f64 / n as f64))
    };
    (0..rail.pieces.len()).flat_map(on).chain(std::iter::once(last))
}

/// How far a curve comes out of the chords between its samples, mm, in the middle of each.
fn sag(rail: &Rail, count: usize) -> f64 {
    let of = |k: usize| {
        let n = steps(rail, k, count);
        let at = move |x: f64| rail.point(k as f64 + x / n as f64);
        (0..n).map(move |i| i as f64).map(move |i| (at(i + 0.5) - 0.5 * (at(i) + at(i + 1.0))).norm())
    };
    (0..rail.pieces.len()).filter(|k| !rail.is_straight(*k)).flat_map(of).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::geom::Frame;

    fn circle(z: f64, r: f64) -> Rail {
        let frame = Frame { origin: Vec3::new(0.0, 0.0, z), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() };
        let round =
            SpaceCurve::Ellipse { frame, a: r, b: r }.to_spline(0.0, std::f64::consts::TAU).expect("a circle").0;
        Rail::new("circle", &[round]).expect("rail")
    }

    #[test]
    fn frames_of_a_straight_skin_are_needless_and_wider_ones_are_not() {
        let frames = [(0.0, 100.0), (500.0, 200.0), (200.0, 140.0), (350.0, 170.0)].map(|(z, r)| circle(z, r));
        assert_eq!(needless(&frames, 1e-2), [2, 3]);
        let wide = [(0.0, 100.0), (500.0, 100.0), (200.0, 100.5)].map(|(z, r)| circle(z, r));
        assert_eq!(needless(&wide, 1e-2), [0_usize; 0]);
        assert_eq!(needless(&wide, 1.0), [2]);
        assert_eq!(needless(&wide[..2], 1.0), [0_usize; 0]);
    }
}
