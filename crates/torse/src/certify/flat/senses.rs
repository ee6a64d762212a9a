//! Whether a pattern that fits a part from one side says that the sheet bends as it does, seen from that side.
//!
//! A mirrored outline is a good outline of the other side of the sheet: then bend lines must have changed their senses too.
//! Told by samples of the normals; it can take a proof away and never gives one.

use crate::geom::Vec3;
use crate::patchwork::pattern::{BendSense, Pattern};
use crate::spline::surface::Surface;

/// Samples of a patch between two knots.
const SAMPLES: usize = 8;

/// Share of all turns that must remain when they are added with their signs: of sheets that bend to both sides by about as
/// much, nothing is said.
const ONE_WAY: f64 = 0.2;

/// Turn (rad) below which a sheet is as good as flat: about 3°.
const FLAT: f64 = 0.05;

/// Whether the bends drawn go against those of patches that follow each other, seen with `side` as flat rails are.
pub(super) fn against<'a>(patches: impl Iterator<Item = &'a Surface>, side: f64, pattern: &Pattern) -> bool {
    let signed = |(k, _)| {
        let bend = pattern.bend(k);
        match bend.sense {
            BendSense::Up => bend.angle,
            BendSense::Down => -bend.angle,
            BendSense::Flat => 0.0,
        }
    };
    let drawn = one_way(pattern.rulings.iter().enumerate().map(signed));
    drawn.abs() > FLAT && drawn * one_way(turns(patches, side).into_iter()) < 0.0
}

/// The side from which patches are seen in a drawing: that on which the outline fits better, unless the bends go against it
/// and the other is near enough (mm). `None` where bends go against all that fits.
pub(super) fn seen<'a>(
    patches: impl Iterator<Item = &'a Surface> + Clone,
    pattern: &Pattern,
    near: f64,
    off: &dyn Fn(f64) -> f64,
) -> Option<f64> {
    let score = |side: f64| off(side) + if against(patches.clone(), side, pattern) { near } else { 0.0 };
    let side = if score(-1.0) < score(1.0) { -1.0 } else { 1.0 };
    (!against(patches, side, pattern)).then_some(side)
}

/// The sum of turns, if these go one way on the whole; else 0.
fn one_way(turns: impl Iterator<Item = f64>) -> f64 {
    let (sum, all) = turns.fold((0.0, 0.0), |(s, a), t| (s + t, a + t.abs()));
    if f64::abs(sum) > ONE_WAY * all {
        sum
    } else {
        0.0
    }
}

/// Turns of the tangent plane along the middle, positive towards the eye.
fn turns<'a>(patches: impl Iterator<Item = &'a Surface>, side: f64) -> Vec<f64> {
    let mut out = Vec::new();
    let mut before: Option<(Vec3, Vec3)> = None;
    for patch in patches {
        for w in patch.knots_u.breaks().windows(2) {
            for k in 0..=SAMPLES {
                let j = patch.jet(w[0] + (w[1] - w[0]) * k as f64 / SAMPLES as f64, 0.5);
                let (Some(n), Some(e)) = (j.dv.cross(&j.du).try_normalize(0.0), j.dv.try_normalize(0.0)) else {
                    continue;
                };
                let (n, across) = (n * side, j.du - e * e.dot(&j.du));
                let across = across.try_normalize(0.0).unwrap_or_default();
                if let Some((m, earlier)) = before {
                    let ahead = (n - m).dot(&(across + earlier));
                    out.push(if ahead > 0.0 { -n.angle(&m) } else { n.angle(&m) });
                }
                before = Some((n, across));
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec2;
    use crate::patchwork::pattern::Bend;
    use crate::spline::knots::Knots;

    /// A parabola that opens upwards, ruled along y.
    fn trough() -> Surface {
        let points: Vec<Vec3> = (0..3)
            .flat_map(|i| [0.0, 50.0].map(|y| Vec3::new(50.0 * f64::from(i), y, if i == 1 { -40.0 } else { 0.0 })))
            .collect();
        let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
        Surface::new(knots(2), knots(1), &points, None).expect("a surface")
    }

    #[test]
    fn a_trough_comes_up_from_above_and_goes_down_from_below() {
        let patch = trough();
        let j = patch.jet(0.5, 0.5);
        let above = j.dv.cross(&j.du).z.signum();
        let drawn = |sense| Pattern {
            rulings: vec![[Vec2::zeros(), Vec2::y()]],
            bends: vec![Bend::of(sense, 0.8, [60.0; 2])],
            ..Pattern::default()
        };
        let told = |side: f64, sense| against(std::iter::once(&patch), side, &drawn(sense));
        assert!(!told(above, BendSense::Up) && told(above, BendSense::Down));
        assert!(told(-above, BendSense::Up) && !told(-above, BendSense::Down));
        assert!(!told(above, BendSense::Flat));
    }
}
