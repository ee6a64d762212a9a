//! Distances from a line or circle that Bernstein coefficients bound.
//!
//! *Theorem*. Under the map of a plane the image of Bézier points is a curve of their degree, and so is, times the weight, its
//! distance from a line; from a circle of radius r, |v|² − r² is of twice the degree. Under the map of a cone an image is as far
//! from that of the apex as its slant height says, which is a linear function of the height above the apex, a polynomial again,
//! and of the distance from the axis, whose square is one. A polynomial lies between its least and greatest coefficient.
//! Edges that are circles about the axis are so known at once, where values and derivatives over parts would take hundreds.

use super::guide::{widened, Guide};
use super::motion::hull;
use crate::num::binomial::binomial;
use crate::num::interval::Interval;
use crate::patchwork::image::ClosedMap;

/// Distance (mm, signed) from the line or circle of a guide of the image of Bézier points (homogeneous, in the map's frame).
/// `None` for cylinders, and for lines on cones.
pub(super) fn off(guide: &Guide, map: &ClosedMap, net: &[[Interval; 4]]) -> Option<Interval> {
    match (map, guide.circle) {
        (ClosedMap::Plane(_), Some((centre, radius, ..))) => off_circle(net, centre, radius),
        (ClosedMap::Plane(_), None) => {
            let [x, y] = guide.start;
            let away = |p: &[Interval; 4]| guide.way[0] * (p[1] - y * p[3]) - guide.way[1] * (p[0] - x * p[3]);
            Some(hull(net.iter().map(away)) / weight(net)?)
        }
        (ClosedMap::Cone { half_angle, behind, .. }, Some((centre, radius, ..))) => {
            // By height and distance from the axis of its first point.
            let [x, y, z, w] = net.first()?.map(Interval::mid);
            let [height, reach] = [z / w, x.hypot(y) / w].map(Interval::point);
            let above = hull(net.iter().map(|p| p[2] - p[3] * height)) / weight(net)?;
            let beside = off_circle(net, [Interval::ZERO; 2], reach)?;
            let (sin, cos) = (widened(half_angle.sin()), widened(half_angle.cos()));
            let slant = (height + above) * cos + (reach + beside) * sin + Interval::point(*behind);
            // The apex lies in the origin of the plane.
            let away = (centre[0].sqr() + centre[1].sqr()).sqrt().hi;
            let exact = (height * cos + reach * sin + Interval::point(*behind)) - radius;
            (slant.lo > 0.0).then(|| exact + above * cos + beside * sin + Interval::symmetric(away))
        }
        _ => None,
    }
}

/// Weights of Bézier points; `None` unless all are positive.
fn weight(net: &[[Interval; 4]]) -> Option<Interval> {
    let all = hull(net.iter().map(|p| p[3]));
    (all.lo > 0.0).then_some(all)
}

/// Distance in the first two coordinates of a curve of Bézier points from a circle.
fn off_circle(net: &[[Interval; 4]], centre: [Interval; 2], radius: Interval) -> Option<Interval> {
    let weight = Interval::point(weight(net)?.lo);
    // From the centre, times the weight.
    let ways: Vec<[Interval; 3]> =
        net.iter().map(|p| [p[0] - centre[0] * p[3], p[1] - centre[1] * p[3], p[3]]).collect();
    // |v|² − r² = (|v| − r)(|v| + r).
    let p = ways.len() - 1;
    let form = |a: &[Interval; 3], b: &[Interval; 3]| a[0] * b[0] + a[1] * b[1] - radius.sqr() * a[2] * b[2];
    let coefficient = |k: usize| {
        let share =
            |i: usize| Interval::point(binomial(p, i) * binomial(p, k - i)) / Interval::point(binomial(2 * p, k));
        let terms = (k.saturating_sub(p)..=k.min(p)).map(|i| share(i) * form(&ways[i], &ways[k - i]));
        terms.fold(Interval::ZERO, |sum, x| sum + x)
    };
    let most = hull((0..=2 * p).map(coefficient)).mag();
    let least = root_between(weight * radius.lo, most);
    (radius.lo > 0.0).then(|| Interval::new(-most, most) / (weight * least))
}

/// The least of |a| + |b| where a is at least `least`, and b² off a² by `off` at most: a difference of squares over it is
/// one of roots.
pub(in crate::certify) fn root_between(least: Interval, off: f64) -> Interval {
    let square = (least.sqr() - Interval::point(off)).lo.max(0.0);
    Interval::point((least + Interval::point(square).sqrt()).lo)
}
