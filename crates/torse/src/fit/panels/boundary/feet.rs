//! Feet of a border on a torse, all of them on the side of the regression curve where the panel lies.
//!
//! A torse goes on beyond its regression curve, and a point may have a foot there that is nearer than its own. The
//! derivative of the foot function tells both sides apart: it vanishes at the regression curve \[certificate, 1\].

use crate::geom::Vec3;
use crate::torse::form::Torse;

/// Points of a border whose nearest feet vote on the side.
const VOTES: usize = 7;
/// Intervals of the domain in which feet are sought without a guess.
const SCAN: usize = 96;

/// Foot parameters of the points (mm) of a closed border, followed along it.
///
/// # Errors
/// The index of a point without a foot.
pub(super) fn feet_along(torse: &Torse, border: &[Vec3]) -> Result<Vec<f64>, usize> {
    let n = border.len();
    let voters = VOTES.min(n);
    // Foot and slope there; the farther from the regression curve, the larger is the slope and the safer the foot.
    let votes: Vec<(usize, f64, f64)> = (0..voters)
        .map(|k| k * n / voters)
        .filter_map(|i| {
            let t = nearest_foot(torse, &border[i], None)?;
            Some((i, t, torse.foot_function(&border[i], t).1))
        })
        .collect();
    let side = votes.iter().map(|v| v.2).sum::<f64>() > 0.0;
    // Where a torse closes, points at its ends have two feet: the border is followed from one that has not.
    let (a, b) = torse.domain();
    let inside = |v: &&(usize, f64, f64)| (v.1 - a).min(b - v.1);
    let own = votes.iter().filter(|v| (v.2 > 0.0) == side);
    let &(first, start, _) = own.max_by(|v, w| inside(v).total_cmp(&inside(w))).ok_or(0_usize)?;
    let mut feet = vec![start; n];
    let mut guess = start;
    for i in (first + 1..first + n).map(|i| i % n) {
        let x = &border[i];
        let followed = torse.foot(x, guess).filter(|&t| rises(torse, x, t) == side);
        guess = followed.or_else(|| nearest_foot(torse, x, Some(side))).ok_or(i)?;
        feet[i] = guess;
    }
    Ok(feet)
}

/// Whether the foot function of a point rises at its foot.
fn rises(torse: &Torse, x: &Vec3, t: f64) -> bool {
    torse.foot_function(x, t).1 > 0.0
}

/// Foot parameter of `x` without a guess: the sign change of the foot function that is nearest in space, of those on a
/// `side` if there are any.
fn nearest_foot(torse: &Torse, x: &Vec3, side: Option<bool>) -> Option<f64> {
    let (a, b) = torse.domain();
    let node = |i: usize| if i == SCAN { b } else { a + (b - a) * i as f64 / SCAN as f64 };
    let mut best: Option<((bool, f64), f64)> = None;
    let mut before = torse.foot_function(x, a).0;
    for i in 1..=SCAN {
        let here = torse.foot_function(x, node(i)).0;
        if before * here <= 0.0 {
            if let Some(t) = torse.foot(x, 0.5 * (node(i - 1) + node(i))) {
                let beyond = side.is_some_and(|s| rises(torse, x, t) != s);
                let key = (beyond, torse.plane_distance(x, t).abs());
                if best.is_none_or(|b| key < b.0) {
                    best = Some((key, t));
                }
            }
        }
        before = here;
    }
    best.map(|b| b.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Frame;
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;
    use crate::torse::form::PrimalTorse;

    /// Close to the regression curve points may have nearer feet beyond it; a border that begins at such a point keeps
    /// to its side all the same.
    #[test]
    fn a_border_keeps_to_its_side_of_the_regression_curve() {
        let knots = Knots::clamped(3, &[-1.0, 0.0, 1.0]).expect("knots");
        let profile = Curve { knots, control: vec![[0.9, 0.5], [0.3, 0.1], [0.0, 0.0], [0.25, -0.1], [0.8, 0.6]] };
        let torse = Torse::Primal(PrimalTorse::new(Frame::world(), profile, 0.2));
        let on = |t: f64, y: f64| {
            let r = torse.ruling(t);
            r.point + r.direction * y
        };
        let regression = |t: f64| {
            let slope = |y: f64| torse.foot_function(&on(t, y), t).1;
            slope(0.0) / (slope(0.0) - slope(1.0))
        };
        let rulings: Vec<f64> = (0..60).map(|k| -0.6 + 0.5 * k as f64 / 59.0).collect();
        let mut misled = 0;
        for side in [-1.0, 1.0] {
            let at = |t: f64, distance: f64| {
                let x = on(t, regression(t) + side * distance);
                (t, x + 0.001 * torse.ruling(t).normal)
            };
            let near = rulings.iter().map(|&t| at(t, 0.2));
            let far = rulings.iter().rev().map(|&t| at(t, 2.0));
            let border: Vec<(f64, Vec3)> = near.chain(far).collect();
            for first in 0..border.len() {
                let (own, x) = border[first];
                if nearest_foot(&torse, &x, None).is_none_or(|t| (t - own).abs() < 1e-3) {
                    continue;
                }
                misled += 1;
                let (own, points): (Vec<f64>, Vec<Vec3>) =
                    border[first..].iter().chain(&border[..first]).copied().unzip();
                let feet = feet_along(&torse, &points).expect("feet");
                assert!(own.iter().zip(&feet).all(|(a, b)| (a - b).abs() < 1e-9), "{own:?} {feet:?}");
            }
        }
        assert!(misled > 0, "no point with a nearer foot beyond the regression curve");
    }
}
