//! Boundary planes around the used part of a torse: where a ruled patch begins and ends on every ruling.
//!
//! Planes `direction(t) · X = offset(t)` of low degree in t follow oblique and tapering regions; along the rulings
//! they stay clear of the regression curve. Source: certificate specification, section 4 (planes that hug the
//! region, weights positive).

use super::convert::ConvertError;
use super::torse::Torse;
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;

/// The part of a torse that a panel uses.
#[derive(Clone, Debug, Default)]
pub struct Extent {
    /// Points on the boundary of the used region (mm) with the parameters of their rulings.
    pub points: Vec<(f64, Vec3)>,
}

/// Largest degree of the boundary families `y(t)`, `A(t)`: enough for oblique and tapering regions, and degrees stay
/// below those that file readers limit.
pub(super) const MAX_FAMILY: usize = 3;
/// Margin beyond the used region along rulings, share of its mean length: keeps trims inside the patch.
const MARGIN_ALONG: f64 = 0.05;
/// Smallest share of the regularity at the used points that the patch keeps at its boundary curves.
const REGULARITY_KEPT: f64 = 0.3;
/// A higher family degree must save this share of the patch to be taken.
const WORTHWHILE: f64 = 0.87;
/// Smallest cosine between rulings and the direction of the planes that cut them.
const MIN_COSINE: f64 = 0.6;

/// Boundary planes `direction(t) · (X − origin) = low(t)` and `= high(t)`, splines on `range`.
pub(super) struct Bound {
    pub range: (f64, f64),
    pub origin: Vec3,
    pub direction: Curve<3>,
    pub low: Curve<1>,
    pub high: Curve<1>,
    /// Order of continuity of the three.
    pub order: isize,
}

impl Bound {
    /// Degree that the families add to the patch.
    pub fn degree(&self) -> usize {
        degree(&self.direction).max(degree(&self.low)).max(degree(&self.high))
    }
}

/// Degree of a family; 0 if it is constant.
pub(super) fn degree<const D: usize>(curve: &Curve<D>) -> usize {
    if curve.control.windows(2).all(|w| w[0] == w[1]) {
        0
    } else {
        curve.knots.degree()
    }
}

/// A used point: parameter of its ruling, place on the ruling, coordinate along `direction`.
struct Used {
    t: f64,
    place: Vec3,
    y: f64,
}

/// Finds boundary planes around the extent: polynomial families of the lowest sensible degree, else splines.
pub(super) fn hug(torse: &Torse, extent: &Extent, range: (f64, f64)) -> Result<Bound, ConvertError> {
    let origin = match torse {
        Torse::Primal(p) => p.frame.origin,
        Torse::Dual(_) => extent.points.iter().map(|p| p.1).sum::<Vec3>() / extent.points.len() as f64,
    };
    let knots = spline_knots(torse, range)?;
    let mut trouble = ConvertError::Regression { t: range.0 };
    for splines in [false, true] {
        let direction = match (torse, splines) {
            (Torse::Primal(p), _) => constant(p.frame.y.into(), range)?,
            (Torse::Dual(_), false) => match direction_polynomial(torse, range)? {
                Some(d) => d,
                None => continue,
            },
            (Torse::Dual(_), true) => direction_spline(torse, &knots)?,
        };
        if let Some(t) = departs(torse, &direction, range) {
            trouble = ConvertError::Turning { t };
            continue;
        }
        let used: Vec<Used> = extent
            .points
            .iter()
            .map(|&(t, x)| {
                let r = torse.ruling(t);
                let place = r.point + r.direction * r.direction.dot(&(x - r.point));
                Used { t, place, y: Vec3::from(direction.point(t)).dot(&(place - origin)) }
            })
            .collect();
        let mut best: Option<(f64, Bound)> = None;
        let degrees = if splines { 0..=0 } else { 0..=MAX_FAMILY };
        for degree in degrees {
            let side = |sign: f64| {
                if splines {
                    spline_envelope(&used, &knots, sign)
                } else {
                    envelope(&used, degree, sign, range)
                }
            };
            let (low, high) = (side(-1.0)?, side(1.0)?);
            let width = mean(&high) - mean(&low);
            let margin = MARGIN_ALONG * width;
            let bound = Bound {
                range,
                origin,
                direction: direction.clone(),
                low: shifted(low, -margin),
                high: shifted(high, margin),
                order: if splines { 1 } else { isize::MAX },
            };
            match irregular(torse, &bound, &used) {
                Some(t) => trouble = ConvertError::Regression { t },
                None if best.as_ref().is_none_or(|(w, _)| width < WORTHWHILE * w) => best = Some((width, bound)),
                None => {}
            }
        }
        if let Some((_, bound)) = best {
            return Ok(bound);
        }
    }
    Err(trouble)
}

/// Parameter at which a boundary curve would come near the regression curve: there the slope of the foot function,
/// which is linear along a ruling and vanishes at the regression point, loses its size or sign.
fn irregular(torse: &Torse, bound: &Bound, used: &[Used]) -> Option<f64> {
    // Least slope at the used points of each slice of the range, as the measure of what there is to keep.
    let slice = |t: f64| {
        let s = (t - bound.range.0) / (bound.range.1 - bound.range.0);
        ((s * SLICES as f64) as usize).min(SLICES - 1)
    };
    let mut least = [f64::INFINITY; SLICES];
    for u in used {
        let k = slice(u.t);
        least[k] = least[k].min(torse.foot_function(&u.place, u.t).1.abs());
    }
    used.iter().find_map(|u| {
        let r = torse.ruling(u.t);
        let per_mm = Vec3::from(bound.direction.point(u.t)).dot(&r.direction);
        let slope_at = |y: f64| torse.foot_function(&(u.place + r.direction * ((y - u.y) / per_mm)), u.t).1;
        let sign = slope_at(u.y).signum();
        [bound.low.point(u.t)[0], bound.high.point(u.t)[0]]
            .into_iter()
            .any(|y| slope_at(y) * sign < REGULARITY_KEPT * least[slice(u.t)])
            .then_some(u.t)
    })
}

/// Slices of the range in which extremes of the used points are sought.
const SLICES: usize = 24;
/// Samples of the range for checks of directions.
const SAMPLES: usize = 64;

/// Parameter at which directions are too far from the rulings, if any.
fn departs(torse: &Torse, direction: &Curve<3>, range: (f64, f64)) -> Option<f64> {
    (0..=SAMPLES).map(|i| range.0 + (range.1 - range.0) * i as f64 / SAMPLES as f64).find(|&t| {
        let a = Vec3::from(direction.point(t));
        a.dot(&torse.ruling(t).direction) < MIN_COSINE * a.norm()
    })
}

/// Polynomial of the lowest degree that stays near the ruling directions.
fn direction_polynomial(torse: &Torse, range: (f64, f64)) -> Result<Option<Curve<3>>, ConvertError> {
    let nodes: Vec<(f64, Vec3)> = (0..=SAMPLES)
        .map(|i| i as f64 / SAMPLES as f64)
        .map(|s| (s, torse.ruling(range.0 + s * (range.1 - range.0)).direction))
        .collect();
    for degree in 0..=MAX_FAMILY {
        let fit = |c: usize| least_squares(&nodes.iter().map(|(s, e)| (*s, e[c], 1.0)).collect::<Vec<_>>(), degree);
        let (x, y, z) = (fit(0), fit(1), fit(2));
        let control: Vec<[f64; 3]> = (0..x.len()).map(|i| [x[i], y[i], z[i]]).collect();
        let curve = polynomial(control, range)?;
        if departs(torse, &curve, range).is_none() {
            return Ok(Some(curve));
        }
    }
    Ok(None)
}

/// Quadratic spline on the torse's knots whose control vectors are ruling directions.
fn direction_spline(torse: &Torse, knots: &Knots) -> Result<Curve<3>, ConvertError> {
    let v = knots.values();
    let control =
        (0..knots.control_count()).map(|i| torse.ruling(0.5 * (v[i + 1] + v[i + 2])).direction.into()).collect();
    Ok(Curve::new(2, v.to_vec(), control)?)
}

/// Quadratic knots at the torse's breaks inside the range.
fn spline_knots(torse: &Torse, range: (f64, f64)) -> Result<Knots, ConvertError> {
    let breaks = match torse {
        Torse::Primal(p) => p.profile.knots.breaks(),
        Torse::Dual(d) => d.planes.knots.breaks(),
    };
    let mut b = vec![range.0];
    b.extend(breaks.into_iter().filter(|&t| t > range.0 && t < range.1));
    b.push(range.1);
    Ok(Knots::clamped(2, &b)?)
}

fn constant(value: [f64; 3], range: (f64, f64)) -> Result<Curve<3>, ConvertError> {
    polynomial(vec![value], range)
}

/// Polynomial with Bernstein coefficients on `range`; a constant becomes linear since splines have a degree.
fn polynomial<const D: usize>(mut control: Vec<[f64; D]>, range: (f64, f64)) -> Result<Curve<D>, ConvertError> {
    if control.len() == 1 {
        control.push(control[0]);
    }
    let n = control.len();
    let mut values = vec![range.0; n];
    values.extend(vec![range.1; n]);
    Ok(Curve::new(n - 1, values, control)?)
}

fn mean(c: &Curve<1>) -> f64 {
    c.control.iter().map(|x| x[0]).sum::<f64>() / c.control.len() as f64
}

fn shifted(mut c: Curve<1>, by: f64) -> Curve<1> {
    for x in &mut c.control {
        x[0] += by;
    }
    c
}

/// Spline with `sign (q(t) − y) ≥ 0` at all points: each control value is the extreme one on its support, hence
/// every convex combination of those active at t is beyond the points there.
fn spline_envelope(used: &[Used], knots: &Knots, sign: f64) -> Result<Curve<1>, ConvertError> {
    let v = knots.values();
    let control = (0..knots.control_count())
        .map(|i| {
            let (a, b) = (v[i], v[i + 3]);
            let inside = used.iter().filter(|u| u.t >= a && u.t <= b).map(|u| sign * u.y).reduce(f64::max);
            let nearest = || {
                let m = 0.5 * (a + b);
                used.iter().min_by(|p, q| (p.t - m).abs().total_cmp(&(q.t - m).abs())).map_or(0.0, |u| sign * u.y)
            };
            [sign * inside.unwrap_or_else(nearest)]
        })
        .collect();
    Ok(Curve::new(2, v.to_vec(), control)?)
}

/// Polynomial `q` of the given degree with `sign (q(t) − y) ≥ 0` at all points, near the extreme ones.
fn envelope(used: &[Used], degree: usize, sign: f64, range: (f64, f64)) -> Result<Curve<1>, ConvertError> {
    // Extreme points of slices of the range, joined by a least-squares polynomial, which is then shifted.
    let unit = |t: f64| (t - range.0) / (range.1 - range.0);
    let mut extreme: [Option<(f64, f64, f64)>; SLICES] = [None; SLICES];
    for u in used {
        let s = unit(u.t);
        let k = ((s * SLICES as f64) as usize).min(SLICES - 1);
        if extreme[k].is_none_or(|e| sign * (u.y - e.1) > 0.0) {
            extreme[k] = Some((s, u.y, 1.0));
        }
    }
    let data: Vec<_> = extreme.into_iter().flatten().collect();
    let q = least_squares(&data, degree.min(data.len().saturating_sub(1)));
    let q = polynomial(q.into_iter().map(|c| [c]).collect(), range)?;
    let shift = used.iter().map(|u| sign * (u.y - q.point(u.t)[0])).fold(f64::NEG_INFINITY, f64::max);
    Ok(shifted(q, sign * shift))
}

/// Least-squares polynomial through `(s, value, weight)` in Bernstein form on [0, 1]; lower degree if singular.
fn least_squares(data: &[(f64, f64, f64)], degree: usize) -> Vec<f64> {
    let n = degree + 1;
    let mut a = nalgebra::DMatrix::<f64>::zeros(n, n);
    let mut b = nalgebra::DVector::<f64>::zeros(n);
    for &(s, y, w) in data {
        let basis: Vec<f64> = (0..n).map(|i| bernstein(&unit_vector(n, i), s)).collect();
        for i in 0..n {
            b[i] += w * basis[i] * y;
            for j in 0..n {
                a[(i, j)] += w * basis[i] * basis[j];
            }
        }
    }
    match nalgebra::linalg::Cholesky::new(a) {
        Some(c) => c.solve(&b).iter().copied().collect(),
        None if degree > 0 => least_squares(data, degree - 1),
        None => vec![0.0],
    }
}

fn unit_vector(n: usize, i: usize) -> Vec<f64> {
    let mut v = vec![0.0; n];
    v[i] = 1.0;
    v
}

/// Value at `s` by de Casteljau.
fn bernstein(c: &[f64], s: f64) -> f64 {
    let mut d = c.to_vec();
    for r in 1..d.len() {
        for i in 0..d.len() - r {
            d[i] = (1.0 - s) * d[i] + s * d[i + 1];
        }
    }
    d[0]
}
