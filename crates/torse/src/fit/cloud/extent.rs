//! The part of a torse that points cover, as a strip.
//!
//! *Method.* Points near the torse are dropped on it; in bins of rulings the outermost ones make the border that a ruled
//! patch hugs. The patch is then cut back to the outermost ruling and the outermost points (Lemma 2 of \[PW99\] in the
//! primal form of the main job).

use super::estimates::Estimates;
use crate::fit::near::power_form::{Guesses, PowerForm};
use crate::fit::near::samples::{Fit, Sample};
use crate::fit::near::{descent::RefitOptions, refit::refit};
use crate::geom::Vec3;
use crate::num::parallel;
use crate::spline::pieces::Pieces;
use crate::torse::convert::{parameters, patch, ConvertError, Extent};
use crate::torse::form::{DualTorse, PrimalTorse, Torse};
use crate::torse::strip::Strip;

/// Bins of rulings.
const BINS: usize = 48;

/// Why there is no strip.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExtentError {
    /// Too few points near the torse.
    #[error("only {0} of its points are near the torse")]
    Few(usize),
    /// No patch.
    #[error(transparent)]
    Patch(#[from] ConvertError),
    /// No spline.
    #[error(transparent)]
    Spline(#[from] crate::spline::SplineError),
}

/// A fit on a longer domain: torses end a little beyond the estimates, which lie inside the measured part and keep off
/// creases, so that points at its borders would have no feet. `None` if its splines cannot go on.
pub(crate) fn widened(fit: &Fit) -> Option<Fit> {
    // Share of the range on both sides: a few cells of a coarse grid.
    const BEYOND: f64 = 0.25;
    let (a, b) = fit.torse.domain();
    let (from, to) = (a - BEYOND * (b - a), b + BEYOND * (b - a));
    let torse = match &fit.torse {
        Torse::Dual(d) => {
            let planes = Pieces::of(&d.planes)?.on(from, to, 0.0).to_curve().ok()?;
            Torse::Dual(DualTorse { planes })
        }
        Torse::Primal(p) => {
            let profile = Pieces::of(p.profile())?.on(from, to, 0.0).to_curve().ok()?;
            // The slope at the new start, from which it is integrated.
            let beta = p.functions(profile.domain().0)[5];
            Torse::Primal(PrimalTorse::new(p.frame, profile, beta))
        }
        Torse::Cylinder(_) => return None,
    };
    Some(Fit { torse, ..fit.clone() })
}

/// A fit continued over the points themselves, where its estimates, which lie inside the measured part, left the borders
/// to extrapolation. `None` where the iteration does not go on.
///
/// *Not guaranteed*: that it is nearer to all points; outliers among them pull.
pub(crate) fn polished(fit: &Fit, points: &[Vec3], tolerance: f64) -> Option<Fit> {
    // Points taken evenly, and the farthest ones.
    const EVEN: usize = 1500;
    const FAR: usize = 300;
    let power_form = PowerForm::of(&fit.torse)?;
    let guesses = power_form.guesses();
    let mut found: Vec<(f64, Sample)> = points
        .iter()
        .filter_map(|x| {
            let q = power_form.local(x);
            let t = power_form.foot(&q, guesses.guess(&q), power_form.domain())?;
            let d = power_form.distance(&q, t).0.abs();
            Some((d, Sample { x: *x, n: fit.torse.ruling(t).normal, weight: 1.0 }))
        })
        .collect();
    let mut samples: Vec<Sample> = found.iter().step_by(found.len().div_ceil(EVEN).max(1)).map(|f| f.1).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    samples.extend(found.iter().take(FAR).map(|f| f.1));
    refit(fit, &samples, &RefitOptions::new(0.5 * tolerance))
}

/// Torse of every point: that of its own estimate (`owner`) if the point is within `near` (mm) of it, otherwise the
/// nearest among those around; `None` where no torse is near. So points along creases find their side.
pub(crate) fn assigned(
    estimates: &Estimates,
    owner: &[Option<u32>],
    fits: &[&Fit],
    points: &[Vec3],
    near: f64,
) -> Vec<Option<u32>> {
    let power_forms: Vec<Option<(PowerForm, Guesses)>> = fits
        .iter()
        .map(|f| {
            let power_form = PowerForm::of(&f.torse)?;
            let guesses = power_form.guesses();
            Some((power_form, guesses))
        })
        .collect();
    let distance = |k: u32, p: &Vec3| -> Option<f64> {
        let (power_form, guesses) = power_forms.get(k as usize)?.as_ref()?;
        let q = power_form.local(p);
        let t = power_form.foot(&q, guesses.guess(&q), power_form.domain())?;
        Some(power_form.distance(&q, t).0.abs())
    };
    parallel::map(points.iter().zip(&estimates.of_point), |(p, e)| {
        let own = e.and_then(|e| owner[e as usize]);
        if let Some(k) = own.filter(|&k| distance(k, p).is_some_and(|d| d <= near)) {
            return Some(k);
        }
        let mut around: Vec<u32> = estimates.near(p).filter_map(|e| owner[e as usize]).collect();
        around.sort_unstable();
        around.dedup();
        let found = around.into_iter().filter_map(|k| Some((distance(k, p)?, k)));
        found.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|f| f.0 <= near).map(|f| f.1)
    })
}

/// The strip of a torse under points; points farther than `near` (mm) from it do not count.
///
/// # Errors
/// See [`ExtentError`].
pub fn strip(name: &str, fit: &Fit, points: &[Vec3], near: f64) -> Result<Strip, ExtentError> {
    let power_form = PowerForm::of(&fit.torse).ok_or(ExtentError::Few(0))?;
    let guesses = power_form.guesses();
    let domain = power_form.domain();
    let dropped: Vec<(f64, Vec3, f64)> = parallel::map(points.iter(), |p| {
        let q = power_form.local(p);
        let t = power_form.foot(&q, guesses.guess(&q), domain)?;
        let (d, _) = power_form.distance(&q, t);
        if d.abs() > near {
            return None;
        }
        let r = fit.torse.ruling(t);
        let along = r.direction.dot(&(p - r.point));
        Some((t, r.point + r.direction * along, along))
    })
    .into_iter()
    .flatten()
    .collect();
    if dropped.len() < 4 {
        return Err(ExtentError::Few(dropped.len()));
    }
    let (a, b) = dropped.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.0), b.max(p.0)));
    let mut bins: Vec<Option<(usize, usize)>> = vec![None; BINS];
    for (i, p) in dropped.iter().enumerate() {
        let k = (((p.0 - a) / (b - a) * BINS as f64) as usize).min(BINS - 1);
        let (lo, hi) = bins[k].unwrap_or((i, i));
        bins[k] = Some((if p.2 < dropped[lo].2 { i } else { lo }, if p.2 > dropped[hi].2 { i } else { hi }));
    }
    // At the end of each bin the strip reaches as far as the outermost points on both sides, and a little farther, so
    // that what hugs the border holds all points between.
    const FARTHER: f64 = 0.02;
    let mut sides: [Vec<(f64, Vec3)>; 2] = [Vec::new(), Vec::new()];
    for k in 0..=BINS {
        let t = a + (b - a) * k as f64 / BINS as f64;
        let r = fit.torse.ruling(t);
        let beside = [k.checked_sub(1), (k < BINS).then_some(k)];
        let outermost = beside.into_iter().flatten().filter_map(|k| bins[k]).flat_map(|(lo, hi)| [lo, hi]);
        let (lo, hi) = outermost
            .map(|i| r.direction.dot(&(dropped[i].1 - r.point)))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), s| (lo.min(s), hi.max(s)));
        if lo <= hi {
            let room = FARTHER * (hi - lo);
            sides[0].push((t, r.point + r.direction * (lo - room)));
            sides[1].push((t, r.point + r.direction * (hi + room)));
        }
    }
    let [mut border, upper] = sides;
    border.extend(upper.into_iter().rev());
    let whole = patch(&fit.torse, &Extent { loops: vec![border] })?;
    // Cut back to what the points reach.
    let ((u0, u1), _) = whole.domain();
    let reach: Vec<f64> = dropped.iter().map(|p| parameters(&whole, p.0.clamp(u0, u1), &p.1)).collect();
    let (lo, hi) = reach.iter().fold((1.0_f64, 0.0_f64), |(lo, hi), &r| (lo.min(r), hi.max(r)));
    let part = whole.restricted((a.max(u0), b.min(u1)), (lo.clamp(0.0, 1.0), hi.clamp(0.0, 1.0)))?;
    let ((_, _), (v0, v1)) = part.domain();
    Ok(Strip::between(name, fit.kind, &part.curve_at_v(v0), &part.curve_at_v(v1))?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::near::primal::primal;
    use crate::fit::near::primal::PrimalOptions;

    #[test]
    fn a_widened_torse_is_the_same_surface_on_more_rulings() {
        // A cone, so that the slope of the rulings changes along the profile.
        let samples: Vec<Sample> = (0..400)
            .map(|k| {
                let (a, s) = (0.05 * f64::from(k % 20) - 0.5, 500.0 + 20.0 * f64::from(k / 20));
                let x = Vec3::new(0.5 * s * a.sin(), s, 0.5 * s * a.cos());
                Sample { x, n: Vec3::new(a.sin(), -0.5, a.cos()).normalize(), weight: 1.0 }
            })
            .collect();
        let fit = primal(&samples, &PrimalOptions::new(0.01)).expect("a fit");
        let wide = widened(&fit).expect("a longer one");
        let ((a, b), (c, d)) = (fit.torse.domain(), wide.torse.domain());
        assert!(c < a && d > b);
        for k in 0..=10 {
            let t = a + (b - a) * f64::from(k) / 10.0;
            let (p, q) = (fit.torse.ruling(t), wide.torse.ruling(t));
            assert!((p.point - q.point).norm() < 1e-9 && (p.direction - q.direction).norm() < 1e-12);
        }
        // It is still the cone beyond the old ends.
        let r = wide.torse.ruling(d);
        assert!(r.direction.cross(&r.point).norm() / r.point.norm() < 1e-3, "{r:?}");
    }
}
