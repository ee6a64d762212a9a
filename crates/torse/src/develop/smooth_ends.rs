//! Curves through the ends of rulings laid flat: sheets end smoothly where the ends do.
//!
//! *Method.* At a point where the polygon turns gently, as its neighbours do, the curve has the tangent of the circle through
//! it and both neighbours; stretches are cubics with these tangents. Where ends jump to and fro, and at corners, nothing is
//! known of a curve, and stretches are straight.

use crate::geom::Vec2;

/// Turn (rad) of a polygon beyond which a point of it is a corner.
const CORNER: f64 = 0.5;
/// Turn (rad) that needs no neighbours that agree.
const GENTLE: f64 = 0.02;
/// Share of the curvature at a point and beside it by which the former may differ from what the latter lets expect.
const AGREES: f64 = 0.6;
/// Pieces of a stretch at most.
const MOST_PIECES: f64 = 64.0;
/// Sagitta of an arc as a share of its chord and the angle (rad) between both at its end.
const SAGITTA: f64 = 0.25;

/// Which points of an open chain are no corners: none where more are corners than not, since ends that jump to and fro turn like
/// a curve here and there.
pub(crate) fn smooth(chain: &[Vec2]) -> Vec<bool> {
    let n = chain.len();
    // Turn, and turn over the length that it belongs to.
    let bend = |i: usize| -> Option<(f64, f64)> {
        let (p, q) = (chain[i] - *chain.get(i.checked_sub(1)?)?, chain.get(i + 1)? - chain[i]);
        let turn = p.perp(&q).atan2(p.dot(&q));
        Some((turn, 2.0 * turn / (p.norm() + q.norm())))
    };
    let bends: Vec<Option<(f64, f64)>> = (0..n).map(bend).collect();
    let at = |i: Option<usize>| i.and_then(|i| bends.get(i).copied().flatten()).map(|b| b.1);
    let is_smooth = |i: usize| {
        let Some((turn, own)) = bends[i] else { return false };
        let (expected, size) = match (at(i.checked_sub(1)), at(Some(i + 1))) {
            (Some(a), Some(b)) => (0.5 * (a + b), (a.abs() + b.abs() + own.abs()) / 3.0),
            (Some(a), None) | (None, Some(a)) => (a, 0.5 * (a.abs() + own.abs())),
            (None, None) => (own, own.abs()),
        };
        turn.abs() <= CORNER && ((own - expected).abs() <= AGREES * size || turn.abs() <= GENTLE)
    };
    let found: Vec<bool> = (0..n).map(is_smooth).collect();
    let corners = n.saturating_sub(2) - found.iter().filter(|s| **s).count();
    if 2 * corners > n.saturating_sub(2) {
        return vec![false; n];
    }
    found
}

/// Points of the curve inside every stretch of a chain; chords between them lie within `chord` (mm) of the curve, about.
pub(crate) fn through(chain: &[Vec2], chord: f64) -> Vec<Vec<Vec2>> {
    let smooth = smooth(chain);
    let tangent = |i: usize| -> Option<Vec2> {
        let (p, q) = (chain[i] - chain[i - 1], chain[i + 1] - chain[i]);
        (p * (q.norm() / p.norm()) + q * (p.norm() / q.norm())).try_normalize(0.0)
    };
    let tangents: Vec<Option<Vec2>> =
        smooth.iter().enumerate().map(|(i, s)| if *s { tangent(i) } else { None }).collect();
    chain
        .windows(2)
        .zip(tangents.windows(2))
        .map(|(ends, tangents)| stretch([ends[0], ends[1]], [tangents[0], tangents[1]], chord))
        .collect()
}

/// Points of a cubic between two points, without these. A missing tangent is that of a circle.
fn stretch([p, q]: [Vec2; 2], tangents: [Option<Vec2>; 2], chord: f64) -> Vec<Vec2> {
    let d = q - p;
    let mirrored = |t: Vec2| d * (2.0 * t.dot(&d) / d.norm_squared()) - t;
    let (s, t) = match tangents {
        [None, None] => return Vec::new(),
        [Some(s), Some(t)] => (s, t),
        [Some(s), None] => (s, mirrored(s)),
        [None, Some(t)] => (mirrored(t), t),
    };
    let length = d.norm();
    let angle = |t: &Vec2| d.perp(t).atan2(d.dot(t)).abs();
    let sagitta = SAGITTA * length * angle(&s).max(angle(&t));
    let pieces = (sagitta / chord).sqrt().ceil().clamp(1.0, MOST_PIECES) as usize;
    let (a, b) = (p + s * (length / 3.0), q - t * (length / 3.0));
    (1..pieces)
        .map(|k| {
            let x = k as f64 / pieces as f64;
            let y = 1.0 - x;
            p * (y * y * y) + a * (3.0 * x * y * y) + b * (3.0 * x * x * y) + q * (x * x * x)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_circle_have_a_circle_through_them() {
        let at = |k: usize| Vec2::new((0.1 * k as f64).cos(), (0.1 * k as f64).sin()) * 300.0;
        let chain: Vec<Vec2> = (0..12).map(at).collect();
        let found = through(&chain, 0.001);
        assert!(found.len() == 11 && found.iter().all(|s| s.len() > 5));
        let off = found.iter().flatten().map(|p| (p.norm() - 300.0).abs()).fold(0.0, f64::max);
        // Chords are 0.37 beside the circle.
        assert!(off < 0.01, "{off}");
    }

    #[test]
    fn corners_and_ends_that_jump_to_and_fro_are_joined_straight() {
        let steps: Vec<Vec2> = (0..9).map(|k| Vec2::new(10.0 * k as f64, if k % 2 == 0 { 0.0 } else { 1.5 })).collect();
        assert!(through(&steps, 0.001).iter().all(Vec::is_empty));
        let corner: Vec<Vec2> =
            [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [20.0, 10.0], [20.0, 20.0]].map(Vec2::from).to_vec();
        assert!(through(&corner, 0.001).iter().all(Vec::is_empty));
    }
}
