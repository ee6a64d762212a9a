//! Swept surfaces, of which extrusions, surfaces of revolution and with them the quadrics and tori are made: nearest
//! points through the directrix, and the exact rational B-splines (Piegl & Tiller, The NURBS Book (1997), section 8.5).

use super::parameter_map::{quarter_pieces, unit_arc, ParameterMap};
use super::space_curve::{SpaceCurve, COINCIDENT};
use super::unroll;
use crate::geom::{Frame, Vec3};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;
use std::f64::consts::{PI, TAU};

/// A parameter line `u = value` (axis 0) or `v = value` (axis 1) that is one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pole {
    /// The parameter that is constant: 0 for u, 1 for v.
    pub axis: usize,
    /// Its value.
    pub value: f64,
    /// The point.
    pub point: Vec3,
}

/// Nearest point on an extrusion: nearest point of the directrix seen along the direction.
pub(crate) fn foot_on_extrusion(
    directrix: &SpaceCurve,
    direction: &Vec3,
    x: &Vec3,
    guess: Option<[f64; 2]>,
) -> [f64; 2] {
    let speed = direction.norm();
    let unit = direction / speed;
    let flat = |p: Vec3| p - unit * unit.dot(&p);
    let height = |u: f64| unit.dot(&(x - directrix.point(u))) / speed;
    // The seen curve is no longer a conic with the same parameter in general, so it is searched as it is.
    let distance = |u: f64| {
        let j = directrix.jet(u).map(flat);
        (j[0] - flat(*x), j[1], j[2])
    };
    let limits = if directrix.period().is_some() { None } else { directrix.domain() };
    let starts: Vec<f64> = match (guess, directrix) {
        (_, SpaceCurve::Line { .. }) => vec![0.0],
        (Some(g), _) => vec![g[0]],
        (None, SpaceCurve::Parabola { .. } | SpaceCurve::Hyperbola { .. }) => {
            (-20..=20).map(|i| 0.2 * i as f64).collect()
        }
        (None, _) => samples_of(directrix),
    };
    let u = nearest_by(distance, &starts, limits);
    [u, height(u)]
}

/// Nearest point on a surface of revolution: nearest point of the meridian in the half plane of `x`.
pub(crate) fn foot_on_revolution(directrix: &SpaceCurve, frame: &Frame, x: &Vec3, guess: Option<[f64; 2]>) -> [f64; 2] {
    let q = frame.to_local(x);
    let target = Vec3::new(q.x.hypot(q.y), 0.0, q.z);
    let distance = |v: f64| {
        let j = directrix.jet(v);
        let (p, d, e) = (frame.to_local(&j[0]), frame.vector_to_local(&j[1]), frame.vector_to_local(&j[2]));
        let rho = p.x.hypot(p.y);
        if rho < f64::MIN_POSITIVE {
            return (Vec3::new(0.0, 0.0, p.z) - target, Vec3::new(d.x.hypot(d.y), 0.0, d.z), Vec3::zeros());
        }
        let d1 = (p.x * d.x + p.y * d.y) / rho;
        let d2 = (d.x * d.x + d.y * d.y + p.x * e.x + p.y * e.y - d1 * d1) / rho;
        (Vec3::new(rho, 0.0, p.z) - target, Vec3::new(d1, 0.0, d.z), Vec3::new(d2, 0.0, e.z))
    };
    let limits = if directrix.period().is_some() { None } else { directrix.domain() };
    let starts: Vec<f64> = match (guess, directrix) {
        (_, SpaceCurve::Line { .. }) => vec![directrix.nearest(&frame.to_world(&target)), directrix.nearest(x)],
        (Some(g), _) => vec![g[1]],
        (None, SpaceCurve::Parabola { .. } | SpaceCurve::Hyperbola { .. }) => {
            (-20..=20).map(|i| 0.2 * i as f64).collect()
        }
        (None, _) => samples_of(directrix),
    };
    let v = nearest_by(distance, &starts, limits);
    let p = frame.to_local(&directrix.point(v));
    let angle = q.y.atan2(q.x) - p.y.atan2(p.x);
    [(angle + PI).rem_euclid(TAU) - PI, v]
}

/// Starts for searches along a bounded curve.
fn samples_of(curve: &SpaceCurve) -> Vec<f64> {
    let (a, b) = curve.domain().unwrap_or((-1.0, 1.0));
    let breaks = curve.stations(a, b);
    let mut out: Vec<f64> =
        breaks.windows(2).flat_map(|w| (0..6).map(move |i| w[0] + (w[1] - w[0]) * i as f64 / 6.0)).collect();
    out.push(b);
    out
}

/// Parameter of least distance, from the best few of many starts; `residual` answers difference, first and second
/// derivative.
fn nearest_by(residual: impl Fn(f64) -> (Vec3, Vec3, Vec3), starts: &[f64], limits: Option<(f64, f64)>) -> f64 {
    let clamp = |t: f64| limits.map_or(t, |(a, b)| t.clamp(a, b));
    let mut order: Vec<(f64, f64)> = starts.iter().map(|&t| (residual(t).0.norm_squared(), t)).collect();
    order.sort_by(|p, q| p.0.total_cmp(&q.0));
    let mut best = (f64::INFINITY, 0.0);
    for &(mut d, mut t) in order.iter().take(3) {
        for _ in 0..50 {
            let (r, r1, r2) = residual(t);
            let speed = r1.norm_squared();
            let full = speed + r.dot(&r2);
            let slope = if full > 0.1 * speed { full } else { speed };
            if slope <= 0.0 || slope.is_nan() {
                break;
            }
            let mut step = -r.dot(&r1) / slope;
            let mut moved = false;
            for _ in 0..12 {
                let next = clamp(t + step);
                let dn = residual(next).0.norm_squared();
                if dn < d {
                    (t, d, moved) = (next, dn, true);
                    break;
                }
                step *= 0.5;
            }
            if !moved {
                break;
            }
        }
        if d < best.0 {
            best = (d, t);
        }
    }
    best.1
}

/// Why a curve cannot be turned about an axis: the surface would be covered twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum MeridianError {
    /// A closed curve, of which no part is told.
    #[error("its closed curve meets the axis, so all of it turned covers the surface twice, which is not read")]
    Closed,
    /// A curve that goes on beyond the axis.
    #[error("its curve crosses the axis, so that the surface meets itself there, which is not read")]
    Crosses,
}

/// What is turned about the axis of `frame`: where the curve is closed and comes to the axis, the `part` that is asked for,
/// as a spline; `None` for all of the curve.
pub(crate) fn meridian(
    curve: &SpaceCurve,
    part: Option<(f64, f64)>,
    frame: &Frame,
) -> Result<Option<SpaceCurve>, MeridianError> {
    let Some((period, (start, _))) = curve.period().zip(curve.domain()) else { return Ok(None) };
    if !meets_axis(curve, frame, (start, start + period), 0..LOOKED_AT) {
        return Ok(None);
    }
    let (from, to) = part.filter(|(from, to)| to - from < period).ok_or(MeridianError::Closed)?;
    let part = curve.to_spline(from, to).map_err(|_| MeridianError::Closed)?.0;
    let ends = part.domain();
    let part = SpaceCurve::Spline(part);
    if meets_axis(&part, frame, ends, 1..LOOKED_AT) {
        return Err(MeridianError::Crosses);
    }
    Ok(Some(part))
}

/// Places along a meridian at which its distance from the axis is looked at.
const LOOKED_AT: usize = 256;

/// Whether a curve comes to the axis about which it is turned, at one of the given places of its range or beside it.
fn meets_axis(curve: &SpaceCurve, frame: &Frame, (start, end): (f64, f64), mut places: std::ops::Range<usize>) -> bool {
    /// Steps to the least distance, each to two thirds.
    const STEPS: usize = 60;
    let away = |t: f64| {
        let q = frame.to_local(&curve.point(t));
        q.x.hypot(q.y)
    };
    let at = |k: f64| start + (end - start) * k / LOOKED_AT as f64;
    let far = (0..LOOKED_AT).map(|k| away(at(k as f64))).fold(0.0, f64::max);
    let is_lowest = |k: usize| {
        let [a, b, c] = [-1.0, 0.0, 1.0].map(|d| away(at(k as f64 + d)));
        b <= a && b <= c
    };
    places.any(|k| {
        if !is_lowest(k) {
            return false;
        }
        let (mut a, mut b) = (at(k as f64 - 1.0), at(k as f64 + 1.0));
        for _ in 0..STEPS {
            let (l, r) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
            if away(l) <= away(r) {
                b = r;
            } else {
                a = l;
            }
        }
        away(0.5 * (a + b)) <= COINCIDENT * far
    })
}

pub(crate) fn poles_of_revolution(directrix: &SpaceCurve, frame: &Frame, pole: impl Fn(f64) -> Pole) -> Vec<Pole> {
    let distance = |p: &Vec3| {
        let q = frame.to_local(p);
        q.x.hypot(q.y)
    };
    match directrix {
        SpaceCurve::Line { origin, direction } => {
            let (o, d) = (frame.to_local(origin), frame.vector_to_local(direction));
            let speed = d.x * d.x + d.y * d.y;
            if speed <= 0.0 || speed.is_nan() {
                return Vec::new();
            }
            let t = -(o.x * d.x + o.y * d.y) / speed;
            let scale = o.x.hypot(o.y).max(speed.sqrt());
            if distance(&directrix.point(t)) <= COINCIDENT * scale {
                vec![pole(t)]
            } else {
                Vec::new()
            }
        }
        _ => match (directrix.domain(), directrix.period()) {
            (Some((a, b)), None) => {
                let (p, q) = (directrix.point(a), directrix.point(b));
                let scale = samples_of(directrix).iter().map(|&t| distance(&directrix.point(t))).fold(0.0, f64::max);
                [(a, p), (b, q)]
                    .into_iter()
                    .filter(|(_, x)| distance(x) <= COINCIDENT * scale)
                    .map(|(t, _)| pole(t))
                    .collect()
            }
            _ => Vec::new(),
        },
    }
}

/// `C(u) + v direction` over a box.
pub(crate) fn extrude(
    directrix: &SpaceCurve,
    direction: &Vec3,
    u: (f64, f64),
    v: (f64, f64),
) -> Result<(Surface, [ParameterMap; 2]), SplineError> {
    let (c, map) = piece(directrix, u)?;
    let knots_v = Knots::new(1, vec![v.0, v.0, v.1, v.1], 2)?;
    let mut control = Vec::with_capacity(2 * c.control.len());
    for p in &c.control {
        for t in [v.0, v.1] {
            let d = direction * (t * p[3]);
            control.push([p[0] + d.x, p[1] + d.y, p[2] + d.z, p[3]]);
        }
    }
    Ok((checked(c.knots, knots_v, control)?, [map, ParameterMap::Same]))
}

/// `C(v)` turned about the z-axis of the frame, over a box.
pub(crate) fn revolve(
    directrix: &SpaceCurve,
    frame: &Frame,
    u: (f64, f64),
    v: (f64, f64),
) -> Result<(Surface, [ParameterMap; 2]), SplineError> {
    if !(u.1 > u.0 && u.1 - u.0 < 32.0 * TAU) {
        return Err(SplineError::KnotOrder { index: 0, value: u.1 });
    }
    let (c, map) = piece(directrix, v)?;
    let pieces = quarter_pieces(u.1 - u.0);
    let sweep = (u.1 - u.0) / pieces as f64;
    let (knots, arc) = unit_arc(u.0, sweep, pieces);
    let knots_u = Knots::new(2, knots, arc.len())?;
    let mut control = Vec::with_capacity(arc.len() * c.control.len());
    for a in &arc {
        for p in &c.control {
            let w = p[3];
            let q = frame.vector_to_local(&(Vec3::new(p[0], p[1], p[2]) - frame.origin * w));
            let turned = Vec3::new(a[0] * q.x - a[1] * q.y, a[1] * q.x + a[0] * q.y, a[2] * q.z);
            let x = frame.vector_to_world(&turned) + frame.origin * (w * a[2]);
            control.push([x.x, x.y, x.z, w * a[2]]);
        }
    }
    Ok((checked(knots_u, c.knots, control)?, [ParameterMap::Angle { start: u.0, sweep }, map]))
}

/// The piece of a directrix over a range: closed splines are unrolled, other splines kept whole.
fn piece(curve: &SpaceCurve, range: (f64, f64)) -> Result<(Curve<4>, ParameterMap), SplineError> {
    match (curve, curve.period()) {
        (SpaceCurve::Spline(c), Some(_)) => Ok((unroll::curve(c, range)?, ParameterMap::Same)),
        _ => curve.to_spline(range.0, range.1),
    }
}

/// A surface from homogeneous control points, checked.
fn checked(knots_u: Knots, knots_v: Knots, control: Vec<[f64; 4]>) -> Result<Surface, SplineError> {
    for (index, c) in control.iter().enumerate() {
        if !(c.iter().all(|x| x.is_finite()) && c[3] > 0.0) {
            return Err(SplineError::Control { index, reason: "not finite, or a weight that is not positive".into() });
        }
    }
    let rational = control.iter().any(|c| (c[3] - 1.0).abs() > 0.0);
    Ok(Surface { knots_u, knots_v, control, rational })
}
