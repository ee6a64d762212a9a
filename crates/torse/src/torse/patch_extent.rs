//! Boundary planes around the used part of a torse: where a ruled patch begins and ends on every ruling.
//!
//! Planes `direction(t) · X = offset(t)` of low degree in t follow oblique and tapering regions; along the rulings
//! they stay clear of the regression curve. Source: certificate specification, section 4 (planes that hug the
//! region, weights positive).

use super::form::{DualTorse, Torse};
use crate::geom::Vec3;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::SplineError;
use nalgebra::Matrix3;

/// Why a torse cannot be written as a patch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConvertError {
    /// The used region is empty or a single ruling.
    #[error("the used part of the torse has no extent ({0} boundary points)")]
    Empty(usize),
    /// The region comes too close to the regression curve for a patch around it.
    #[error("the regression curve comes too close to the used part at t = {t}")]
    Regression {
        /// Ruling concerned.
        t: f64,
    },
    /// The rulings turn so much that no plane family of low degree meets all of them.
    #[error(
        "the rulings turn too much around t = {t} for boundary planes of degree {MAX_FAMILY}; cut the panel there"
    )]
    Turning {
        /// Ruling concerned.
        t: f64,
    },
    /// The torse is not smooth enough: its tangent planes jump.
    #[error("the tangent planes of the torse jump at the knot t = {t}")]
    Jump {
        /// Knot concerned.
        t: f64,
    },
    /// The patch does not make a valid spline.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// The part of a torse that a panel uses.
#[derive(Clone, Debug, Default)]
pub struct Extent {
    /// Border of the used region as closed polylines of points (mm) with the parameters of their rulings; the last
    /// point is joined to the first.
    pub loops: Vec<Vec<(f64, Vec3)>>,
}

impl Extent {
    /// All points of the border.
    pub fn points(&self) -> impl Iterator<Item = &(f64, Vec3)> {
        self.loops.iter().flatten()
    }
}

/// Largest degree of the boundary families `y(t)`, `A(t)`: enough for oblique and tapering regions, and degrees stay
/// below those that file readers limit.
pub(crate) const MAX_FAMILY: usize = 3;
/// Margin beyond the used region along rulings, share of its mean length: keeps trims inside the patch.
const MARGIN_ALONG: f64 = 0.05;
/// Smallest share of the regularity at the used points that the patch keeps at its boundary curves.
const REGULARITY_KEPT: f64 = 0.3;
/// Largest excess of the patch over the region at either end of a ruling, share of the region's mean length: what is
/// wanted, and what is granted to regions with jagged borders.
const EXCESS: [f64; 3] = [0.3, 1.0, 4.0];
/// Reach of a neighbourhood of rulings, share of the range.
const NEIGHBOURHOOD: f64 = 0.04;
/// Shares of the reach of the used part: how far its apex may be, and how near all planes must pass by it.
const APEX: (f64, f64) = (2.0, 1e-9);
/// Smallest cosine between rulings and the direction of the planes that cut them.
const MIN_COSINE: f64 = 0.6;

/// Boundary planes `direction(t) · (X − origin) = low(t)` and `= high(t)`, splines on `range`.
pub(crate) struct Bound {
    pub range: (f64, f64),
    pub origin: Vec3,
    pub direction: Curve<3>,
    pub low: Curve<1>,
    pub high: Curve<1>,
    /// Order of continuity of the three.
    pub order: isize,
}

impl Bound {
    /// Parts of `[a, b]`, within the range, on which the families are polynomials.
    pub fn parts(&self, a: f64, b: f64) -> Vec<(f64, f64)> {
        let (lo, hi) = (a.max(self.range.0), b.min(self.range.1));
        if lo >= hi {
            return Vec::new();
        }
        let mut at: Vec<f64> = [&self.low, &self.high].iter().flat_map(|c| c.knots.breaks()).collect();
        at.extend(self.direction.knots.breaks());
        at.retain(|t| *t > lo && *t < hi);
        at.extend([lo, hi]);
        at.sort_by(f64::total_cmp);
        at.dedup();
        at.windows(2).map(|w| (w[0], w[1])).collect()
    }

    /// Degree that the families add to the patch.
    pub fn degree(&self) -> usize {
        degree(&self.direction).max(degree(&self.low)).max(degree(&self.high))
    }
}

/// Degree of a family; 0 if it is constant.
pub(crate) fn degree<const D: usize>(curve: &Curve<D>) -> usize {
    if curve.control.windows(2).all(|w| w[0] == w[1]) {
        0
    } else {
        curve.knots.degree()
    }
}

/// Room for the boundary curves on one ruling: `low` must lie in the first interval, `high` in the second.
struct BoundaryIntervals {
    t: f64,
    low: (f64, f64),
    high: (f64, f64),
}

/// Finds boundary planes around the extent, in the room that the regression curve leaves: polynomial families of the
/// lowest degree that fits, else splines on some of the torse's knots.
pub(crate) fn patch_extent(torse: &Torse, extent: &Extent, range: (f64, f64)) -> Result<Bound, ConvertError> {
    let count = extent.points().count() as f64;
    let origin = match torse {
        Torse::Primal(p) => p.frame.origin,
        Torse::Cylinder(c) => c.frame.origin,
        Torse::Dual(d) => {
            let middle = extent.points().map(|p| p.1).sum::<Vec3>() / count;
            let reach = extent.points().map(|p| (p.1 - middle).norm()).fold(0.0, f64::max);
            apex(d, &middle, reach).unwrap_or(middle)
        }
    };
    if let Some(bound) = flat(torse, extent, &origin, range)? {
        return Ok(bound);
    }
    let all = breaks_inside(torse, range);
    let mut trouble = ConvertError::Regression { t: range.0 };
    for spline_direction in [false, true] {
        let direction = match (torse, spline_direction) {
            (Torse::Primal(p), false) => polynomial(vec![p.frame.y.into()], range)?,
            (Torse::Cylinder(c), false) => polynomial(vec![c.frame.y.into()], range)?,
            (Torse::Primal(_) | Torse::Cylinder(_), true) => continue,
            (Torse::Dual(_), false) => match direction_polynomial(torse, range)? {
                Some(d) => d,
                None => continue,
            },
            (Torse::Dual(_), true) => direction_spline(torse, &Knots::clamped(2, &all)?)?,
        };
        // Rulings of a primal torse meet every plane y = const, whatever their angle.
        let oblique = if matches!(torse, Torse::Dual(_)) { departs(torse, &direction, range) } else { None };
        if let Some(t) = oblique {
            trouble = ConvertError::Turning { t };
            continue;
        }
        let side =
            |pick: &dyn Fn(&BoundaryIntervals) -> (f64, f64), corners: &[f64]| -> Result<Curve<1>, ConvertError> {
                let mut missed = range.0;
                for excess in EXCESS {
                    let boundary_intervals =
                        boundary_intervals(torse, extent, (&direction, &origin), range, excess, corners)?;
                    let data: Vec<(f64, (f64, f64))> = boundary_intervals.iter().map(|r| (r.t, pick(r))).collect();
                    match band(&data, &all) {
                        Ok(curve) => return Ok(curve),
                        Err(t) => missed = t,
                    }
                }
                Err(ConvertError::Regression { t: missed })
            };
        // Corners between the sampled rulings may stick out: they get rulings of their own.
        let mut corners = Vec::new();
        for _ in 0..CORNER_ROUNDS {
            match (side(&|r| r.low, &corners), side(&|r| r.high, &corners)) {
                (Ok(low), Ok(high)) => {
                    let outside = cut_off(torse, extent, &direction, &origin, (&low, &high));
                    if let Some(&t) = outside.first() {
                        trouble = ConvertError::Regression { t };
                        corners.extend(outside);
                        continue;
                    }
                    let splines = [&low, &high].iter().any(|c| c.knots.breaks().len() > 2) || spline_direction;
                    let order = if splines { 1 } else { isize::MAX };
                    return Ok(Bound { range, origin, direction, low, high, order });
                }
                (Err(e), _) | (_, Err(e)) => {
                    trouble = e;
                    break;
                }
            }
        }
    }
    Err(trouble)
}

/// The point that all planes pass through, if it is nearer to the `middle` of the used part than twice its `reach` (mm). A border
/// close around it has coordinates along the rulings of one small size, reckoned from there; from elsewhere they change by as much
/// as the part is long, and would have to be followed to a share of that small size.
fn apex(torse: &DualTorse, middle: &Vec3, reach: f64) -> Option<Vec3> {
    let planes = torse.planes.control.iter().map(|p| {
        let n = Vec3::new(p[0], p[1], p[2]);
        (n, p[3] - n.dot(middle))
    });
    let none = (Matrix3::zeros(), Vec3::zeros());
    let (normal, side) = planes.clone().fold(none, |(m, r), (n, h)| (m + n * n.transpose(), r + n * h));
    let off = normal.try_inverse()? * side;
    let miss = planes.map(|(n, h)| (n.dot(&off) - h).abs() / n.norm()).fold(0.0, f64::max);
    (off.norm() < APEX.0 * reach && miss < APEX.1 * reach).then(|| middle + off)
}

/// Wide bounds parallel to the profile for a plane: it has no regression curve to stay clear of, and its regions may
/// be pointed slivers.
fn flat(torse: &Torse, extent: &Extent, origin: &Vec3, range: (f64, f64)) -> Result<Option<Bound>, ConvertError> {
    let Torse::Primal(p) = torse else { return Ok(None) };
    let n = p.profile().control.len();
    let bends = |d: usize| {
        (0..=n).any(|k| {
            let t = range.0 + (range.1 - range.0) * k as f64 / n as f64;
            p.profile().jet(t)[2][d] != 0.0 || (d == 1 && p.profile().jet(t)[1][d] != 0.0)
        })
    };
    if bends(0) || bends(1) {
        return Ok(None);
    }
    let direction = polynomial(vec![p.frame.y.into()], range)?;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (t, x) in extent.points() {
        let y = coordinate(torse, &direction, origin, *t, x);
        (low, high) = (low.min(y), high.max(y));
    }
    let margin = PLANE_MARGIN * (high - low);
    let side = |y: f64| polynomial(vec![[y]], range);
    let (low, high) = (side(low - margin)?, side(high + margin)?);
    Ok(Some(Bound { range, origin: *origin, direction, low, high, order: isize::MAX }))
}

/// Margin of a plane's patch on each side, share of its width.
const PLANE_MARGIN: f64 = 0.2;

/// Rulings of the border points beyond the boundary planes.
fn cut_off(
    torse: &Torse,
    extent: &Extent,
    direction: &Curve<3>,
    origin: &Vec3,
    (low, high): (&Curve<1>, &Curve<1>),
) -> Vec<f64> {
    let beyond = |t: f64, y: f64| !(y > low.point(t)[0] && y < high.point(t)[0]);
    let border = extent.points().map(|(t, x)| (*t, coordinate(torse, direction, origin, *t, x)));
    border.filter(|&(t, y)| beyond(t, y)).map(|(t, _)| t).collect()
}

/// Coordinate along `direction` of the point of ruling `t` nearest `x`.
fn coordinate(torse: &Torse, direction: &Curve<3>, origin: &Vec3, t: f64, x: &Vec3) -> f64 {
    let r = torse.ruling(t);
    let on = r.point + r.direction * r.direction.dot(&(x - r.point));
    Vec3::from(direction.point(t)).dot(&(on - origin))
}

/// Rounds in which corners that stick out get rulings of their own.
const CORNER_ROUNDS: usize = 4;
/// Equally spaced rulings at which the room is determined; up to twice as many border points have theirs too.
const RULINGS: usize = 120;
/// Distance of a border point from a ruling, as a share of the range, within which it lies on it: rounding of both.
const TOUCHES: f64 = 1e-12;

/// Room on rulings over the range, those of `corners` among them.
#[expect(clippy::too_many_lines, reason = "one walk over all rulings with its state")]
fn boundary_intervals(
    torse: &Torse,
    extent: &Extent,
    (direction, origin): (&Curve<3>, &Vec3),
    range: (f64, f64),
    excess: f64,
    corners: &[f64],
) -> Result<Vec<BoundaryIntervals>, ConvertError> {
    // Border in the (t, y) plane.
    let border: Vec<Vec<(f64, f64)>> = extent
        .loops
        .iter()
        .map(|l| l.iter().map(|(t, x)| (*t, coordinate(torse, direction, origin, *t, x))).collect())
        .collect();
    let mut spans: Vec<(f64, f64, f64)> = Vec::new();
    let mut length = (0.0, 0.0);
    let count = border.iter().map(Vec::len).sum::<usize>();
    let stride = count.div_ceil(2 * RULINGS).max(1);
    let mut at: Vec<f64> = (0..=RULINGS).map(|k| range.0 + (range.1 - range.0) * k as f64 / RULINGS as f64).collect();
    at.extend(border.iter().flatten().step_by(stride).map(|p| p.0));
    at.extend(corners);
    at.sort_by(f64::total_cmp);
    at.dedup();
    for t in at {
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut include = |y: f64| {
            lo = lo.min(y);
            hi = hi.max(y);
        };
        for l in &border {
            for i in 0..l.len() {
                let (a, b) = (l[i], l[(i + 1) % l.len()]);
                if (a.0 <= t) != (b.0 <= t) {
                    include(a.1 + (b.1 - a.1) * (t - a.0) / (b.0 - a.0));
                }
                // A ruling that only touches the border.
                if (a.0 - t).abs() <= TOUCHES * (range.1 - range.0) {
                    include(a.1);
                }
            }
        }
        if lo <= hi {
            length = (length.0 + hi - lo, length.1 + 1.0);
        }
        spans.push((t, lo, hi));
    }
    let mean = length.0 / f64::max(length.1, 1.0);
    if mean <= 0.0 {
        return Err(ConvertError::Empty(extent.points().count()));
    }
    // Rulings beside the region go on as at its ends, if they can.
    let inside: Vec<usize> = (0..spans.len()).filter(|&k| spans[k].1 <= spans[k].2).collect();
    let mut lines: Vec<RulingPart> = Vec::with_capacity(spans.len());
    for (k, &(t, lo, hi)) in spans.iter().enumerate() {
        let beside = lo > hi;
        let (lo, hi) = if beside {
            let nearest = inside.iter().min_by_key(|&&i| i.abs_diff(k)).copied().unwrap_or(k);
            (spans[nearest].1, spans[nearest].2)
        } else {
            (lo, hi)
        };
        // The slope of the foot function is linear along a ruling and vanishes at the regression point.
        let r = torse.ruling(t);
        let a = Vec3::from(direction.point(t));
        let (per_mm, base) = (a.dot(&r.direction), a.dot(&(r.point - origin)));
        let slope = |y: f64| torse.foot_function(&(r.point + r.direction * ((y - base) / per_mm)), t).1;
        let rate = (slope(hi + mean) - slope(lo)) / (hi + mean - lo);
        let slopes = (slope(lo), slope(hi));
        if slopes.0 * slopes.1 > 0.0 {
            lines.push(RulingPart { t, ends: (lo, hi), slopes, rate });
        } else if !beside {
            return Err(ConvertError::Regression { t });
        }
    }
    // Where the region is pointed, what its neighbourhood needs is granted.
    let window = NEIGHBOURHOOD * (range.1 - range.0);
    let mut out = Vec::with_capacity(lines.len());
    for line in &lines {
        let (mut lo, mut hi, mut least) = (f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY);
        for n in lines.iter().filter(|n| (n.t - line.t).abs() <= window) {
            lo = lo.min(n.ends.0);
            hi = hi.max(n.ends.1);
            least = least.min(n.slopes.0.abs().min(n.slopes.1.abs()));
        }
        // Distance from an end of the region at which |slope| has fallen to what is kept.
        let reach = |at: f64, towards: f64| {
            let fall = -towards * line.rate * at.signum();
            if fall > 0.0 {
                (at.abs() - REGULARITY_KEPT * least.min(at.abs())) / fall
            } else {
                f64::INFINITY
            }
        };
        let down = reach(line.slopes.0, -1.0).min(line.ends.0 - lo + excess * mean);
        let up = reach(line.slopes.1, 1.0).min(hi - line.ends.1 + excess * mean);
        // A quarter of the reach where it is short: the patch needs some margin everywhere.
        let margin = |reach: f64| (MARGIN_ALONG * mean).min(0.25 * reach);
        out.push(BoundaryIntervals {
            t: line.t,
            low: (line.ends.0 - down, line.ends.0 - margin(down)),
            high: (line.ends.1 + margin(up), line.ends.1 + up),
        });
    }
    Ok(out)
}

/// Part of a ruling inside the region: coordinates of its ends, slopes of the foot function there and their rate.
struct RulingPart {
    t: f64,
    ends: (f64, f64),
    slopes: (f64, f64),
    rate: f64,
}

/// Polynomial of the lowest degree, else quadratic spline with the fewest knots (those of the torse first), that passes
/// all intervals; else the parameter of the interval that is missed most.
fn band(data: &[(f64, (f64, f64))], all: &[f64]) -> Result<Curve<1>, f64> {
    let range = (all[0], all[all.len() - 1]);
    // A constant, if there is one; then as near the region as it may be.
    let (most, least) = data.iter().fold((f64::NEG_INFINITY, f64::INFINITY), |(m, l), (_, b)| (m.max(b.0), l.min(b.1)));
    if most <= least {
        return polynomial(vec![[0.5 * (most + least)]], range).map_err(|_| range.0);
    }
    let mut worst = range.0;
    for degree in 1..=MAX_FAMILY {
        let Ok(knots) = Knots::clamped(degree, &[range.0, range.1]) else { continue };
        match through(data, &knots) {
            Ok(c) => return Ok(c),
            Err(t) => worst = t,
        }
    }
    for stride in [8, 4, 2, 1] {
        let mut breaks: Vec<f64> = all.iter().copied().step_by(stride).collect();
        if breaks[breaks.len() - 1] < range.1 {
            breaks.push(range.1);
        }
        let Ok(knots) = Knots::clamped(2, &breaks) else { continue };
        match through(data, &knots) {
            Ok(c) => return Ok(c),
            Err(t) => worst = t,
        }
    }
    // Where it is missed, shorter spans than the torse has.
    let mut breaks = all.to_vec();
    for _ in 0..HALVINGS {
        let k = breaks.partition_point(|b| *b <= worst).clamp(1, breaks.len() - 1);
        let (first, last) = ((k - 1).saturating_sub(1), (k + 1).min(breaks.len() - 1));
        let middles: Vec<f64> = breaks[first..=last].windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        breaks.extend(middles);
        breaks.sort_by(f64::total_cmp);
        let Ok(knots) = Knots::clamped(2, &breaks) else { break };
        match through(data, &knots) {
            Ok(c) => return Ok(c),
            Err(t) => worst = t,
        }
    }
    Err(worst)
}

/// Rounds in which spans where a spline misses its intervals, and those beside them, are halved.
const HALVINGS: usize = 4;

/// Spline through intervals by reweighted least squares towards their middles (Lawson), scaled by half widths.
fn through(data: &[(f64, (f64, f64))], knots: &Knots) -> Result<Curve<1>, f64> {
    const ROUNDS: usize = 40;
    // Least weight of an interval against the mean of all: one that lies well inside must be able to come back.
    const LEAST_WEIGHT: f64 = 1e-6;
    let intervals: Vec<(f64, f64)> = data.iter().map(|(_, b)| (0.5 * (b.0 + b.1), 0.5 * (b.1 - b.0))).collect();
    let mut splines = LeastSquares::new(knots, data.iter().map(|d| d.0));
    let mut weight = vec![1.0; data.len()];
    let mut worst = knots.domain().0;
    for _ in 0..ROUNDS {
        let fitted = splines.fit(|i| (intervals[i].0, weight[i] / (intervals[i].1 * intervals[i].1)));
        let Some(c) = fitted else { return Err(worst) };
        let miss = intervals.iter().enumerate().map(|(i, (middle, half))| (splines.value(i, &c) - middle).abs() / half);
        let miss: Vec<f64> = miss.collect();
        let mut most = 0.0;
        for (m, (t, _)) in miss.iter().zip(data) {
            if *m > most {
                most = *m;
                worst = *t;
            }
        }
        if most <= 1.0 {
            let control = c.iter().map(|v| [*v]).collect();
            return Curve::new(knots.degree(), knots.values().to_vec(), control).map_err(|_| worst);
        }
        for (w, m) in weight.iter_mut().zip(&miss) {
            *w *= 0.03 + m / most;
        }
        let total: f64 = weight.iter().sum::<f64>() / weight.len() as f64;
        for w in &mut weight {
            *w = (*w / total).max(LEAST_WEIGHT);
        }
    }
    Err(worst)
}

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
        .map(|i| range.0 + (range.1 - range.0) * i as f64 / SAMPLES as f64)
        .map(|t| (t, torse.ruling(t).direction))
        .collect();
    for degree in 0..=MAX_FAMILY {
        let curve = if degree == 0 {
            let mean = nodes.iter().map(|n| n.1).sum::<Vec3>() / nodes.len() as f64;
            polynomial(vec![mean.into()], range)?
        } else {
            let knots = Knots::clamped(degree, &[range.0, range.1])?;
            let mut splines = LeastSquares::new(&knots, nodes.iter().map(|n| n.0));
            let mut fit = |c: usize| splines.fit(|i| (nodes[i].1[c], 1.0));
            let (Some(x), Some(y), Some(z)) = (fit(0), fit(1), fit(2)) else { continue };
            let control = (0..x.len()).map(|i| [x[i], y[i], z[i]]).collect();
            Curve::new(degree, knots.values().to_vec(), control)?
        };
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

/// Ends of the range and the torse's breaks between them.
fn breaks_inside(torse: &Torse, range: (f64, f64)) -> Vec<f64> {
    let mut b = vec![range.0];
    b.extend(torse.breaks().into_iter().filter(|&t| t > range.0 && t < range.1));
    b.push(range.1);
    b
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

/// Least-squares splines on fixed knots through values at fixed parameters; the basis is evaluated once.
struct LeastSquares {
    rows: Rows,
    normal: BandMatrix,
}

impl LeastSquares {
    fn new(knots: &Knots, parameters: impl Iterator<Item = f64>) -> Self {
        let (n, active) = (knots.control_count(), knots.degree() + 1);
        let mut rows = Rows::new(n, active);
        for t in parameters {
            let basis = knots.basis(t, 0);
            rows.push(basis.first).1.copy_from_slice(&basis.rows[0][..active]);
        }
        Self { rows, normal: BandMatrix::zeros(n, active) }
    }

    /// Coefficients of the spline through `(value, weight)` at parameter `i`; `None` if the data do not determine it.
    fn fit(&mut self, data: impl Fn(usize) -> (f64, f64)) -> Option<Vec<f64>> {
        let mut x = vec![0.0; self.rows.columns()];
        self.normal.clear();
        for i in 0..self.rows.len() {
            let (value, weight) = data(i);
            self.normal.add_row(&self.rows, i, weight);
            self.rows.scatter(i, weight * value, &mut x);
        }
        self.normal.factorise().then(|| self.normal.solve(&mut x))?;
        Some(x)
    }

    /// Value at parameter `i` of the spline with such coefficients.
    fn value(&self, i: usize, coefficients: &[f64]) -> f64 {
        self.rows.dot(i, coefficients)
    }
}
