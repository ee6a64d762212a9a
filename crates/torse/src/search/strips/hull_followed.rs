//! Strips of convex hulls of curves \[W15, 5.4\]: curves through many points are followed by their likes with few knots, ever
//! closer until every strip has a proof.

use super::hull_kept::{kept, Kept};
use super::hull_whole::apart;
use crate::control::Control;
use crate::design::hull::sparse::sparse;
use crate::design::hull::strips::strips;
use crate::design::hull::{hull, HullError};
use crate::design::loft::build::BuildOptions;
use crate::geom::Vec3;
use crate::num::parallel;
use crate::torse::rail::Rail;

/// Share of the tolerance for fitted rails.
const RAIL_SHARE: f64 = 0.1;
/// Shares of the tolerance by which splines with few knots may stray from curves with many, one after the other until all
/// strips have a proof: where a curve is nearly plane, rulings depend on what only the closer ones have.
const FOLLOW_SHARES: [f64; 4] = [0.1, 0.01, 0.001, 0.0001];
/// Share of the tolerance by which a curve may lie off the last ruling before a tip: shorter rulings say nothing more of
/// the shape, and less can be proven of them.
const TIP_SHARE: f64 = 0.1;
/// Twist asked of fits, as a share of what counts as developable.
const TWIST_SHARE: f64 = 0.1;

/// What is asked of strips.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// Points per curve with which the search begins.
    pub samples: usize,
    /// Distance allowed between strips and curves, mm.
    pub tolerance: f64,
    /// Twist that counts as developable, rad.
    pub twist: f64,
}

/// Strips before their judge, and what the search found.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Curves with the boundary of a planar piece of the hull, and whether all of the curve lies in its plane.
    pub lids: Vec<(usize, bool)>,
    /// Of each curve, whether a strip lies along it.
    pub used: Vec<bool>,
    /// What is bounded, and the names of the others.
    pub kept: Kept,
    /// The greatest distance (mm) between strips and hull, and where, if that is more than can be explained.
    pub apart: Option<(f64, Vec3)>,
}

impl Judged {
    /// Strips without a proof, demands that are not met, and whatever else is missing.
    fn faults(&self) -> usize {
        let Kept { claims, of_strips, skipped, missing, .. } = &self.kept;
        let broken = claims.iter().chain(of_strips).filter(|c| c.is_broken()).count();
        skipped.len() + missing.len() + broken + usize::from(self.apart.is_some())
    }
}

/// Strips of the hull of curves, those of the closest likes with the fewest faults. Judged are they by the given curves.
///
/// # Errors
/// No curves; curves in one plane; data that no spline can hold.
pub fn judged(curves: &[Rail], asked: &Asked, control: &Control) -> Result<Judged, HullError> {
    let likes = |share: f64| parallel::map(curves.iter(), |c| sparse(c, share * asked.tolerance, control));
    let mut followed: Vec<Rail> = likes(FOLLOW_SHARES[0]);
    let mut best = of_likes(curves, &followed, asked, 0, control)?;
    for (round, share) in FOLLOW_SHARES.into_iter().enumerate().skip(1) {
        if best.faults() == 0 || control.stopped() {
            break;
        }
        let closer = likes(share);
        if closer == followed {
            continue;
        }
        followed = closer;
        // A round that fails takes nothing away, nor does one that was stopped, of which strips are missing.
        let Ok(found) = of_likes(curves, &followed, asked, round, control) else { continue };
        if !control.stopped() && found.faults() < best.faults() {
            best = found;
        }
    }
    Ok(best)
}

/// The same with given likes of the curves.
fn of_likes(
    curves: &[Rail],
    followed: &[Rail],
    asked: &Asked,
    round: usize,
    control: &Control,
) -> Result<Judged, HullError> {
    let Asked { samples, tolerance, twist } = *asked;
    let report = |step: &'static str, done: f64| control.report(step, if round == 0 { done } else { 0.7 }, "");
    report("looking for rulings", 0.1);
    let found = hull(followed, samples, control)?;
    report("fitting", 0.4);
    let mut build = BuildOptions::new(RAIL_SHARE * tolerance);
    build.twist_tolerance = TWIST_SHARE * twist;
    let mut made = strips(followed, &found, TIP_SHARE * tolerance, &build, control)?;
    let apart = if control.stopped() { None } else { apart(&found, &made, tolerance) };
    let changed: Vec<bool> = curves.iter().zip(followed).map(|(c, f)| c != f).collect();
    for s in made.iter_mut().flat_map(|p| &mut p.strips) {
        for d in (0..2).filter(|d| changed[s.rails[*d]]) {
            // No longer the curve itself: a degree above the first says so.
            let part = &mut s.built.rails[d].parameter;
            *part = part.elevated()?;
        }
    }
    report("judging", 0.7);
    let mut used = vec![false; curves.len()];
    made.iter().flat_map(|p| &p.strips).for_each(|s| s.rails.iter().for_each(|&r| used[r] = true));
    let kept = kept(curves, made, (tolerance, twist), control);
    Ok(Judged { lids: found.lids, used, kept, apart })
}
