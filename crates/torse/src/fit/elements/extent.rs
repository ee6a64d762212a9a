//! The part of a torse that belongs to a sequence of rulings or planes, as a strip.
//!
//! *Method.* Ends of rulings are dropped on the torse; for a plane the nearest tangent plane is looked for and its ruling
//! is cut by the ball of the region of interest. A ruled patch that hugs these points is cut back to them (Lemma 2
//! of \[PW99\] in rational form).

use super::span_series::Sloped;
use crate::fit::cloud::extent::ExtentError;
use crate::fit::near::power_form::PowerForm;
use crate::fit::near::samples::{Fit, MARGIN};
use crate::geom::Vec3;
use crate::num::golden_section;
use crate::spline::pieces::Pieces;
use crate::torse::contact::ContactElement;
use crate::torse::convert::{parameters, patch, Extent};
use crate::torse::dual::DualCurve;
use crate::torse::form::{PanelKind, Ruling, Torse};
use crate::torse::strip::Strip;

/// The strip of a torse for the elements that it was fitted to.
///
/// # Errors
/// See [`ExtentError`].
pub(crate) fn strip(name: &str, fit: &Fit, elements: &[ContactElement]) -> Result<Strip, ExtentError> {
    within(name, fit, elements, true).or_else(|_| within(name, fit, elements, false))
}

/// The same with or without what is beyond the outermost planes, see [`border`].
fn within(name: &str, fit: &Fit, elements: &[ContactElement], beyond: bool) -> Result<Strip, ExtentError> {
    let border = border(&fit.torse, fit.error, elements, beyond)?;
    let whole = patch(&fit.torse, &Extent { loops: vec![border.clone()] })?;
    let (a, b) = border.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.0), b.max(p.0)));
    let ((u0, u1), _) = whole.domain();
    let reach: Vec<f64> = border.iter().map(|p| parameters(&whole, p.0.clamp(u0, u1), &p.1)).collect();
    let (lo, hi) = reach.iter().fold((1.0_f64, 0.0_f64), |(lo, hi), &r| (lo.min(r), hi.max(r)));
    let part = whole.restricted((a.max(u0), b.min(u1)), (lo.clamp(0.0, 1.0), hi.clamp(0.0, 1.0)))?;
    let (_, (v0, v1)) = part.domain();
    Ok(Strip::between(name, fit.kind, &part.curve_at_v(v0), &part.curve_at_v(v1))?)
}

/// Largest excess of a strip between two parallel planes over the elements at either end, share of their mean length.
const EXCESS: f64 = 0.3;

/// The strip of a torse of type (3) for the elements that it was fitted to, between two planes square to the x-axis
/// of its frame: its rails are polynomials of the degree of the planes \[PW99, Corollary 3\]. `None` where such planes
/// leave much of the strip over, or there is no strip. `error` (mm) is the distance of the torse from the elements.
pub fn strip_by_slope(name: &str, found: &Sloped, error: f64, elements: &[ContactElement]) -> Option<Strip> {
    let curve = continued(&found.curve)?;
    let torse = Torse::Dual(curve.to_world(&found.frame).ok()?.to_torse());
    let border = border(&torse, error, elements, true).ok()?;
    let local: Vec<(f64, f64)> = border.iter().map(|(t, x)| (*t, found.frame.to_local(x).x)).collect();
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    };
    let (a, b) = range(&mut local.iter().map(|p| p.0));
    let (from, to) = range(&mut local.iter().map(|p| p.1));
    let half = local.len() / 2;
    let own = |i: usize| (local[i].1.min(local[i + half].1), local[i].1.max(local[i + half].1));
    let mean = (0..half).map(|i| own(i).1 - own(i).0).sum::<f64>() / half as f64;
    if (0..half).any(|i| own(i).0 - from > EXCESS * mean || to - own(i).1 > EXCESS * mean) {
        return None;
    }
    let patch = curve.restricted(a, b).ok()?.tensor_product(from, to).ok()?;
    let (_, (v0, v1)) = patch.domain();
    let rail = |v: f64| {
        let mut c = patch.curve_at_v(v);
        for p in &mut c.control {
            let x = found.frame.to_world(&(Vec3::new(p[0], p[1], p[2]) / p[3]));
            *p = [x.x, x.y, x.z, 1.0];
        }
        c
    };
    Strip::between(name, PanelKind::Torse, &rail(v0), &rail(v1)).ok()
}

/// A curve of planes of type (3) continued a little beyond both ends.
fn continued(curve: &DualCurve) -> Option<DualCurve> {
    let (a, b) = curve.domain();
    let graphs = Pieces::of(&curve.graphs())?.on(a - MARGIN * (b - a), b + MARGIN * (b - a), 0.0).to_curve().ok()?;
    let control: Vec<[f64; 2]> = graphs.control.iter().map(|c| [c[0], c[1]]).collect();
    DualCurve::slope(graphs.knots.degree(), graphs.knots.values().to_vec(), &control).ok()
}

/// How far the centre of the region of a plane may lie beside a torse that touches the plane there, as a share of its radius.
const BESIDE: f64 = 0.01;

/// Ends of the rulings of a torse for the elements: all first ends, then all second ones, with their parameters. A torse that has
/// nearly the planes asked for may touch them a little before or behind the centres of their regions: with `beyond` it is followed
/// up to those of the first and the last plane, if it goes by there.
fn border(
    torse: &Torse,
    error: f64,
    elements: &[ContactElement],
    beyond: bool,
) -> Result<Vec<(f64, Vec3)>, ExtentError> {
    let power_form = PowerForm::of(torse).ok_or(ExtentError::Few(0))?;
    let mut sides: [Vec<(f64, Vec3)>; 2] = [Vec::new(), Vec::new()];
    let at = passed(torse, error, elements);
    for (e, &t) in elements.iter().zip(&at) {
        let ends = if e.has_ruling() {
            // Feet of the ends, near the parameter of the ruling as a whole: other folds may pass nearer to one end.
            e.ends.map(|x| {
                let q = power_form.local(&x);
                let foot = power_form
                    .foot(&q, t, power_form.domain())
                    .filter(|s| power_form.distance(&q, *s).0.abs() <= 2.0 * error);
                (foot.unwrap_or(t), x)
            })
        } else {
            chord(torse, t, e)
        };
        for (side, end) in sides.iter_mut().zip(ends) {
            side.push(end);
        }
    }
    let (a, b) = sides[0].iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.0), b.max(p.0)));
    let outermost = [elements.first().zip(at.first()), elements.last().zip(at.last())];
    for (e, &from) in outermost.into_iter().flatten().filter(|(e, _)| beyond && !e.has_ruling()) {
        let q = power_form.local(&e.centre());
        let near = |t: &f64| power_form.distance(&q, *t).0.abs() <= 2.0 * error + BESIDE * e.radius;
        if let Some(t) = power_form.foot(&q, from, power_form.domain()).filter(near).filter(|t| *t < a || *t > b) {
            sides.iter_mut().zip(chord(torse, t, e)).for_each(|(side, end)| side.push(end));
        }
    }
    // Directions of rulings follow the torse, not the elements: ends may have changed sides.
    let border: Vec<(f64, Vec3)> = sides
        .into_iter()
        .flatten()
        .map(|(t, x)| {
            let r = torse.ruling(t);
            (t, r.point + r.direction * r.direction.dot(&(x - r.point)))
        })
        .collect();
    if border.len() < 4 {
        return Err(ExtentError::Few(border.len()));
    }
    Ok(border)
}

/// What a ball around the centre of a plane leaves of the ruling at a parameter: its ends, with this.
fn chord(torse: &Torse, t: f64, e: &ContactElement) -> [(f64, Vec3); 2] {
    let (r, c) = (torse.ruling(t), e.centre());
    let middle = r.point + r.direction * r.direction.dot(&(c - r.point));
    let half = (e.radius * e.radius - (c - middle).norm_squared()).max(0.0).sqrt();
    [(t, middle - r.direction * half), (t, middle + r.direction * half)]
}

/// Distance of an element from a ruling: end by end, or as planes over the region.
fn off(r: &Ruling, e: &ContactElement) -> f64 {
    if e.has_ruling() {
        e.ends.map(|x| (x - r.point).cross(&r.direction).norm()).iter().fold(0.0, |a, b| a.max(*b))
    } else {
        r.normal.dot(&(e.centre() - r.point)).abs() + e.radius * r.normal.cross(&e.normal).norm()
    }
}

/// A ruling as near as this multiple of the nearest one, or of the distance of the torse, may be the one of an element.
const AS_NEAR: f64 = 4.0;

/// The parameters of elements on a torse. Where it goes round further than the elements do, more than one ruling is as near to one of
/// these; those are taken between which the way from element to element is shortest.
fn passed(torse: &Torse, error: f64, elements: &[ContactElement]) -> Vec<f64> {
    // Of each ruling that an element may be: its parameter, the way up to it, and the one before it.
    let mut ways: Vec<Vec<(f64, f64, usize)>> = Vec::with_capacity(elements.len());
    for e in elements {
        let all = minima(torse, |r| off(r, e));
        let nearest = all.iter().map(|m| m.1).fold(f64::INFINITY, f64::min);
        let may = all.iter().filter(|m| m.1 <= AS_NEAR * nearest.max(error)).map(|m| m.0);
        let way = |t: f64| match ways.last() {
            Some(before) => (before.iter().enumerate())
                .map(|(k, b)| (t, b.1 + (t - b.0).abs(), k))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap_or((t, 0.0, 0)),
            None => (t, 0.0, 0),
        };
        let reached = may.map(way).collect();
        ways.push(reached);
    }
    let last = ways.last().into_iter().flatten().enumerate().min_by(|a, b| a.1 .1.total_cmp(&b.1 .1));
    let mut k = last.map_or(0, |l| l.0);
    let mut out = Vec::with_capacity(elements.len());
    for own in ways.iter().rev() {
        let Some(&(t, _, before)) = own.get(k) else { break };
        out.push(t);
        k = before;
    }
    out.reverse();
    out
}

/// The places of the least values in their surroundings, with these: those of a table, then golden sections.
fn minima(torse: &Torse, value: impl Fn(&Ruling) -> f64) -> Vec<(f64, f64)> {
    const TABLE: usize = 128;
    const SECTIONS: usize = 40;
    let off = |t: f64| value(&torse.ruling(t));
    let (from, to) = torse.domain();
    let at = |k: usize| from + (to - from) * k as f64 / TABLE as f64;
    let values: Vec<f64> = (0..=TABLE).map(|k| off(at(k))).collect();
    let is_least = |&k: &usize| {
        let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
        beside.filter_map(|i| values.get(i)).all(|v| values[k] <= *v)
    };
    let refined = |k: usize| golden_section::least(off, [at(k.saturating_sub(1)), at((k + 1).min(TABLE))], SECTIONS);
    (0..=TABLE).filter(is_least).map(refined).collect()
}
