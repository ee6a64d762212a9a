//! How far a refolded part is from where it belongs, after the best rigid motion. Sampled; nothing is proven here.

use super::atlas::{Atlas, OnPanel};
use super::drawn::FlatPart;
use super::leaf::Refolded;
use crate::brep::project::refine;
use crate::geom::inside::Inside;
use crate::geom::placement::Placement;
use crate::geom::polygon::{area, bounds};
use crate::geom::{Vec2, Vec3};
use crate::num::parallel;
use nalgebra::Matrix3;
/// What was measured of a part, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The best rigid motion, from the refolded part to the part in space.
    pub motion: Placement,
    /// Largest distance of any sample from the place where it belongs.
    pub matched_estimate: f64,
    /// Root mean square of these.
    pub matched_mean_estimate: f64,
    /// Largest distance of any sample of the refolded surface from the part, and the other way.
    pub distance_estimate: f64,
    /// Place on the drawing of the sample that is farthest from where it belongs.
    pub worst: Vec2,
    /// Samples that were compared.
    pub samples: usize,
}

/// Samples inside a part, about.
const SAMPLES: usize = 2000;
/// The same where ways to lay panels onto an outline are told apart, which differ by whole bends.
const FEW_SAMPLES: usize = 200;
/// Steps at most towards the nearest point of the refolded surface: each squares what is left of the first, which is small.
const STEPS: usize = 5;

/// Points inside a part on a grid, and the joints of its outlines.
pub(crate) fn samples(part: &FlatPart) -> Vec<Vec2> {
    so_many(part, SAMPLES)
}

fn so_many(part: &FlatPart, wanted: usize) -> Vec<Vec2> {
    let (lo, hi) = bounds(&part.loops);
    let whole: f64 = part.loops.iter().map(|l| area(l)).sum();
    let (inside, step) = (Inside::of(&part.loops), (whole / wanted as f64).sqrt());
    let mut out: Vec<Vec2> = part.joints.iter().flatten().copied().collect();
    let count = |d: f64| ((d / step).floor() as usize).max(1);
    let (n, m) = (count(hi.x - lo.x), count(hi.y - lo.y));
    for i in 0..=n {
        for j in 0..=m {
            let q = lo
                + Vec2::new(
                    (hi.x - lo.x) * (i as f64 + 0.5) / (n + 1) as f64,
                    (hi.y - lo.y) * (j as f64 + 0.5) / (m + 1) as f64,
                );
            if inside.holds(&q) {
                out.push(q);
            }
        }
    }
    out
}

/// A place of the drawing, where it is on the refolded part, and where it belongs on a panel.
type Pair = (Vec2, Vec3, OnPanel, Vec3);

/// A refolded part laid onto its panels.
struct Matched {
    pairs: Vec<Pair>,
    motion: Placement,
    /// Root mean square of the distances of samples from the places where they belong, mm.
    mean_estimate: f64,
}

/// Of several ways to lay the panels onto an outline the one that the bends agree with. `None` where no sample is on both.
pub(crate) fn best<'a>(part: &FlatPart, refolded: &Refolded, all: &'a [Atlas]) -> Option<&'a Atlas> {
    if let [one] = all {
        return Some(one);
    }
    let few = so_many(part, FEW_SAMPLES);
    let mut out: Option<(&Atlas, f64)> = None;
    for atlas in all {
        let Some(way) = matched(few.clone(), refolded, atlas) else { continue };
        // Ways that differ by rounding only: the first, whose outline begins where the panels do.
        if out.is_none_or(|b| way.mean_estimate < 0.9 * b.1) {
            out = Some((atlas, way.mean_estimate));
        }
    }
    out.map(|b| b.0)
}

/// Lays samples of a refolded part onto its panels. `None` where none is on both.
fn matched(samples: Vec<Vec2>, refolded: &Refolded, atlas: &Atlas) -> Option<Matched> {
    let pair = |q: Vec2| {
        let (place, on) = (refolded.locate(&q)?, atlas.at_flat(&q)?);
        Some((q, refolded.frame(&place).0, on, atlas.space(&on)))
    };
    let pairs: Vec<Pair> =
        parallel::map(samples.into_iter().filter(|q| refolded.is_of_one(q)), pair).into_iter().flatten().collect();
    let motion = best_motion(&pairs.iter().map(|p| (p.1, p.3)).collect::<Vec<_>>())?;
    let mut out = Matched { pairs, motion, mean_estimate: 0.0 };
    out.mean_estimate = (out.pairs.iter().map(|p| out.off(p).powi(2)).sum::<f64>() / out.pairs.len() as f64).sqrt();
    Some(out)
}

impl Matched {
    fn off(&self, p: &Pair) -> f64 {
        (self.motion.point(&p.1) - p.3).norm()
    }

    /// How far it is from these panels.
    fn compared(&self, refolded: &Refolded, atlas: &Atlas) -> Option<Comparison> {
        let Self { pairs, motion, mean_estimate } = self;
        let worst = pairs.iter().max_by(|a, b| self.off(a).total_cmp(&self.off(b)))?;
        let back = motion.inverse()?;
        let nearest = parallel::map(pairs, |(q, x, on, y)| {
            let there = refine(&atlas.panels[on.panel].panel.surface, &motion.point(x), on.uv).distance;
            there.max(to_refolded(refolded, q, &back.point(y)))
        });
        Some(Comparison {
            motion: *motion,
            matched_estimate: self.off(worst),
            matched_mean_estimate: *mean_estimate,
            distance_estimate: nearest.into_iter().fold(0.0, f64::max),
            worst: worst.0,
            samples: pairs.len(),
        })
    }
}

/// Compares a refolded part with its panels. `None` where no sample is on both.
pub(crate) fn compare(part: &FlatPart, refolded: &Refolded, atlas: &Atlas) -> Option<Comparison> {
    matched(samples(part), refolded, atlas)?.compared(refolded, atlas)
}

/// Distance of a point from the refolded surface near the image of `q`.
fn to_refolded(refolded: &Refolded, q: &Vec2, x: &Vec3) -> f64 {
    let mut q = *q;
    let mut least = f64::INFINITY;
    for _ in 0..STEPS {
        let Some(place) = refolded.locate(&q) else { break };
        let (p, pose) = refolded.frame(&place);
        let off = x - p;
        if off.norm() >= least {
            break;
        }
        least = off.norm();
        // The map keeps lengths, so the way in the plane is that in the tangent plane.
        let flat = refolded.leaves[place.leaf].ribbon.flat(place.spot.t);
        q += flat.ruling().xy() * off.dot(&pose.ruling()) + flat.across().xy() * off.dot(&pose.across());
    }
    least
}

/// The rotation and move that bring the first points of pairs nearest to the second in the mean square. `None` without
/// pairs.
pub(crate) fn best_motion(pairs: &[(Vec3, Vec3)]) -> Option<Placement> {
    if pairs.is_empty() {
        return None;
    }
    let n = pairs.len() as f64;
    let a = pairs.iter().map(|p| p.0).sum::<Vec3>() / n;
    let b = pairs.iter().map(|p| p.1).sum::<Vec3>() / n;
    let m: Matrix3<f64> = pairs.iter().map(|(p, q)| (q - b) * (p - a).transpose()).sum();
    let svd = m.svd(true, true);
    let (u, vt) = (svd.u?, svd.v_t?);
    let sign = (u * vt).determinant().signum();
    // The least singular direction is turned over where a reflection would fit better.
    let mut fix = Matrix3::identity();
    let least = svd.singular_values.imin();
    fix[(least, least)] = sign;
    let linear = u * fix * vt;
    Some(Placement { linear, shift: b - linear * a })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigid_motions_are_found_again() {
        let turn = *nalgebra::Rotation3::from_euler_angles(0.3, -1.2, 2.0).matrix();
        let by = Placement { linear: turn, shift: Vec3::new(3.0, -4.0, 5.0) };
        // Points of a plane too, where a reflection would fit as well.
        for height in [0.0, 2.0] {
            let points: Vec<Vec3> = (0..20)
                .map(|k| {
                    let t = k as f64;
                    Vec3::new(t.sin() * 5.0, t.cos() * 3.0 + t, height * (1.7 * t).sin())
                })
                .collect();
            let pairs: Vec<(Vec3, Vec3)> = points.iter().map(|p| (*p, by.point(p))).collect();
            let found = best_motion(&pairs).expect("a motion");
            assert!((found.linear - by.linear).norm() < 1e-12 && (found.shift - by.shift).norm() < 1e-11);
        }
    }
}
