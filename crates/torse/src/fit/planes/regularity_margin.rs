//! Torses whose regression curves keep their distance from what they belong to, and out of zones.
//!
//! *Method* \[PW99, 4.4\]: fits are looked at ruling by ruling; where none keeps to the limits, the convex program of
//! [`regression`](super::regression) is solved in rounds, with the part of each ruling that is out of bounds as its
//! interval: the hull of the strip itself, the distance on both sides, and the zones that the ruling meets.
//! *Not guaranteed*: rulings between those looked at; the judge proves them.

use super::regression::{regression_free_where, RegressionOptions};
use super::rulings::{SlopeData, SlopeOptions};
use crate::geom::{Frame, Vec3};
use crate::spline::knots::Knots;
use crate::torse::dual::DualCurve;
use crate::torse::form::Torse;
use crate::torse::zone::RegressionLimits;

/// A point of what is fitted, with the distance (mm) by which the strip reaches beyond it along the ruling.
pub(crate) type Reach = (Vec3, f64);

/// Bins of rulings in which the extent of a strip is taken.
const BINS: usize = 32;
/// A strip hugs its points with a rectangle of parameters and reaches a little beyond them: share of its length.
const HUG: f64 = 0.05;
/// Regression points farther than this many extents are as good as at infinity.
const FAR: f64 = 1e3;

/// Whether the regression curve of a torse keeps to the limits at the rulings of these points. Points without a foot on
/// the torse do not count.
pub(crate) fn keeps(torse: &Torse, reaches: &[Reach], limits: &RegressionLimits) -> bool {
    let Some(power_form) = crate::fit::near::power_form::PowerForm::of(torse) else { return false };
    let guesses = power_form.guesses();
    let feet: Vec<(f64, Reach)> = reaches
        .iter()
        .filter_map(|r| {
            let q = power_form.local(&r.0);
            Some((power_form.foot(&q, guesses.guess(&q), power_form.domain())?, *r))
        })
        .collect();
    if feet.is_empty() {
        return false;
    }
    let extent = Extent::of(feet);
    (0..=4 * BINS).all(|k| {
        let t = extent.from + (extent.to - extent.from) * k as f64 / (4 * BINS) as f64;
        let r = torse.ruling(t);
        let Some(own) = extent.on(t, &r.point, &r.direction) else { return true };
        let size = (own.1 - own.0).max(f64::MIN_POSITIVE);
        // The derivative of the foot function is linear along a ruling and vanishes at the regression point.
        let slope = |s: f64| torse.foot_function(&(r.point + r.direction * s), t).1;
        let (p, q) = (slope(own.0), slope(own.0 + size));
        let s = own.0 + size * p / (p - q);
        let limits = limits.widened(HUG * size);
        (s - own.0).is_nan() || (s - own.0).abs() > FAR * size || !limits.forbid(&r.point, &r.direction, own, s)
    })
}

/// The fit of type (3) over `knots` whose regression curve keeps to the limits, in the frame of the data. `places` are
/// points in the frame with the parameters of their planes. `None` if there is none.
pub(crate) fn controlled(
    data: &SlopeData,
    frame: &Frame,
    places: Vec<(f64, Reach)>,
    knots: &Knots,
    limits: &RegressionLimits,
    fit: &SlopeOptions,
) -> Option<DualCurve> {
    let extent = Extent::of(places);
    let forbidden = |c: &DualCurve, t: f64| -> Option<(f64, f64)> {
        // The ruling is y = −(u0' + u1' x), z = u0 + t y + u1 x.
        let [u, d, _] = c.graph_jet(t);
        let point = Vec3::new(0.0, -d[0], u[0] - t * d[0]);
        let along = Vec3::new(1.0, -d[1], u[1] - t * d[1]);
        let length = along.norm();
        let direction = along / length;
        let own = extent.on(t, &point, &direction)?;
        let far = FAR * (own.1 - own.0);
        let limits = limits.widened(HUG * (own.1 - own.0));
        let (a, b) = limits.hull(&frame.to_world(&point), &frame.vector_to_world(&direction), own);
        Some((a.max(own.0 - far) / length, b.min(own.1 + far) / length))
    };
    let options = RegressionOptions { fit: fit.clone(), ..RegressionOptions::default() };
    Some(regression_free_where(data, knots, &forbidden, &options).ok()?.fit.curve)
}

/// Points in order of their parameters.
struct Extent {
    places: Vec<(f64, Reach)>,
    from: f64,
    to: f64,
}

impl Extent {
    fn of(mut places: Vec<(f64, Reach)>) -> Self {
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ends = [places.first(), places.last()].map(|p| p.map_or(0.0, |p| p.0));
        Self { places, from: ends[0], to: ends[1] }
    }

    /// The interval of the line `point + s direction` that the points with parameters around t cover.
    fn on(&self, t: f64, point: &Vec3, direction: &Vec3) -> Option<(f64, f64)> {
        let wide = (self.to - self.from) / BINS as f64;
        let last = self.places.len().checked_sub(1)?;
        let lo = self.places.partition_point(|p| p.0 < t - wide);
        let hi = self.places.partition_point(|p| p.0 <= t + wide);
        // At least the neighbours on both sides.
        let middle = self.places.partition_point(|p| p.0 < t);
        let (lo, hi) = (lo.min(middle.saturating_sub(2)), hi.max(middle + 2).min(last + 1));
        let (a, b) = self.places[lo..hi].iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (_, (x, half))| {
            let s = direction.dot(&(x - point));
            (a.min(s - half), b.max(s + half))
        });
        let hug = HUG * (b - a);
        (a <= b).then_some((a - hug, b + hug))
    }
}
