//! The part of a torse that belongs to a row of rulings or planes, as a strip.
//!
//! *Method.* Ends of rulings are dropped on the torse; for a plane the nearest tangent plane is looked for and its ruling
//! is cut by the ball of the region of interest. A ruled patch that hugs these points is cut back to them (Lemma 2
//! of \[PW99\] in rational form).

use super::cloud::extent::ExtentError;
use super::samples::Fit;
use super::sheet::Sheet;
use crate::geom::Vec3;
use crate::surface::convert::{parameters, patch, Extent};
use crate::surface::plane_row::PlaneElement;
use crate::surface::strip::Strip;
use crate::surface::torse::{Ruling, Torse};

/// The strip of a torse for the elements that it was fitted to.
///
/// # Errors
/// See [`ExtentError`].
pub fn strip(name: &str, fit: &Fit, elements: &[PlaneElement]) -> Result<Strip, ExtentError> {
    let sheet = Sheet::of(&fit.torse).ok_or(ExtentError::Few(0))?;
    let mut sides: [Vec<(f64, Vec3)>; 2] = [Vec::new(), Vec::new()];
    for e in elements {
        let t = least(&fit.torse, |r| off(r, e));
        let ends = if e.has_ruling() {
            // Feet of the ends, near the parameter of the ruling as a whole: other folds may pass nearer to one end.
            e.ends.map(|x| {
                let q = sheet.local(&x);
                let foot =
                    sheet.foot(&q, t, sheet.domain()).filter(|s| sheet.distance(&q, *s).0.abs() <= 2.0 * fit.error);
                (foot.unwrap_or(t), x)
            })
        } else {
            let r = fit.torse.ruling(t);
            let c = e.centre();
            let middle = r.point + r.direction * r.direction.dot(&(c - r.point));
            let half = (e.radius * e.radius - (c - middle).norm_squared()).max(0.0).sqrt();
            [(t, middle - r.direction * half), (t, middle + r.direction * half)]
        };
        for (side, end) in sides.iter_mut().zip(ends) {
            side.push(end);
        }
    }
    // Directions of rulings follow the torse, not the elements: ends may have changed sides.
    let border: Vec<(f64, Vec3)> = sides
        .into_iter()
        .flatten()
        .map(|(t, x)| {
            let r = fit.torse.ruling(t);
            (t, r.point + r.direction * r.direction.dot(&(x - r.point)))
        })
        .collect();
    if border.len() < 4 {
        return Err(ExtentError::Few(border.len()));
    }
    let whole = patch(&fit.torse, &Extent { loops: vec![border.clone()] })?;
    let (a, b) = border.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.0), b.max(p.0)));
    let ((u0, u1), _) = whole.domain();
    let reach: Vec<f64> = border.iter().map(|p| parameters(&whole, p.0.clamp(u0, u1), &p.1)).collect();
    let (lo, hi) = reach.iter().fold((1.0_f64, 0.0_f64), |(lo, hi), &r| (lo.min(r), hi.max(r)));
    let part = whole.restricted((a.max(u0), b.min(u1)), (lo.clamp(0.0, 1.0), hi.clamp(0.0, 1.0)))?;
    let (_, (v0, v1)) = part.domain();
    Ok(Strip::between(name, fit.kind, &part.curve_at_v(v0), &part.curve_at_v(v1))?)
}

/// Distance of an element from a ruling: end by end, or as planes over the region.
fn off(r: &Ruling, e: &PlaneElement) -> f64 {
    if e.has_ruling() {
        e.ends.map(|x| (x - r.point).cross(&r.direction).norm()).iter().fold(0.0, |a, b| a.max(*b))
    } else {
        r.normal.dot(&(e.centre() - r.point)).abs() + e.radius * r.normal.cross(&e.normal).norm()
    }
}

/// The parameter with the least value: the best of a table, then golden sections.
fn least(torse: &Torse, value: impl Fn(&Ruling) -> f64) -> f64 {
    const TABLE: usize = 128;
    const SECTIONS: usize = 40;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let off = |t: f64| value(&torse.ruling(t));
    let (from, to) = torse.domain();
    let at = |k: usize| from + (to - from) * k as f64 / TABLE as f64;
    let k = (0..=TABLE).min_by(|&i, &j| off(at(i)).total_cmp(&off(at(j)))).unwrap_or(0);
    let (mut a, mut b) = (at(k.saturating_sub(1)), at((k + 1).min(TABLE)));
    for _ in 0..SECTIONS {
        let (p, q) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        if off(p) < off(q) {
            b = q;
        } else {
            a = p;
        }
    }
    0.5 * (a + b)
}
