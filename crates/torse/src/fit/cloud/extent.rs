//! The part of a torse that points cover, as a strip.
//!
//! *Method.* Points near the torse are dropped on it; in bins of rulings the outermost ones make the border that a ruled
//! patch hugs. The patch is then cut back to the outermost ruling and the outermost points (Lemma 2 of \[PW99\] in the
//! primal form of the main job).

use super::estimates::Estimates;
use crate::fit::samples::Fit;
use crate::fit::sheet::{Guesses, Sheet};
use crate::geom::Vec3;
use crate::surface::convert::{parameters, patch, ConvertError, Extent};
use crate::surface::strip::Strip;
use rayon::prelude::*;

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

/// Torse of every point: that of its own estimate (`owner`) if the point is within `near` (mm) of it, otherwise the
/// nearest among those around; `None` where no torse is near. So points along creases find their side.
pub fn assigned(
    estimates: &Estimates,
    owner: &[Option<u32>],
    fits: &[&Fit],
    points: &[Vec3],
    near: f64,
) -> Vec<Option<u32>> {
    let sheets: Vec<Option<(Sheet, Guesses)>> = fits
        .iter()
        .map(|f| {
            let sheet = Sheet::of(&f.torse)?;
            let guesses = sheet.guesses();
            Some((sheet, guesses))
        })
        .collect();
    let distance = |k: u32, p: &Vec3| -> Option<f64> {
        let (sheet, guesses) = sheets.get(k as usize)?.as_ref()?;
        let q = sheet.local(p);
        let t = sheet.foot(&q, guesses.guess(&q), sheet.domain())?;
        Some(sheet.distance(&q, t).0.abs())
    };
    points
        .par_iter()
        .zip(&estimates.of_point)
        .map(|(p, e)| {
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
        .collect()
}

/// The strip of a torse under points; points farther than `near` (mm) from it do not count.
///
/// # Errors
/// See [`ExtentError`].
pub fn strip(name: &str, fit: &Fit, points: &[Vec3], near: f64) -> Result<Strip, ExtentError> {
    let sheet = Sheet::of(&fit.torse).ok_or(ExtentError::Few(0))?;
    let guesses = sheet.guesses();
    let domain = sheet.domain();
    let dropped: Vec<(f64, Vec3, f64)> = points
        .par_iter()
        .filter_map(|p| {
            let q = sheet.local(p);
            let t = sheet.foot(&q, guesses.guess(&q), domain)?;
            let (d, _) = sheet.distance(&q, t);
            if d.abs() > near {
                return None;
            }
            let r = fit.torse.ruling(t);
            let along = r.direction.dot(&(p - r.point));
            Some((t, r.point + r.direction * along, along))
        })
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
    let kept: Vec<(usize, usize)> = bins.into_iter().flatten().collect();
    let at = |i: usize| (dropped[i].0, dropped[i].1);
    let mut border: Vec<(f64, Vec3)> = kept.iter().map(|k| at(k.0)).collect();
    border.extend(kept.iter().rev().map(|k| at(k.1)));
    let whole = patch(&fit.torse, &Extent { loops: vec![border] })?;
    // Cut back to what the points reach.
    let ((u0, u1), _) = whole.domain();
    let reach: Vec<f64> = dropped.iter().map(|p| parameters(&whole, p.0.clamp(u0, u1), &p.1)).collect();
    let (lo, hi) = reach.iter().fold((1.0_f64, 0.0_f64), |(lo, hi), &r| (lo.min(r), hi.max(r)));
    let part = whole.restricted((a.max(u0), b.min(u1)), (lo.clamp(0.0, 1.0), hi.clamp(0.0, 1.0)))?;
    let ((_, _), (v0, v1)) = part.domain();
    Ok(Strip::between(name, fit.kind, &part.curve_at_v(v0), &part.curve_at_v(v1))?)
}
