//! Lines and arcs drawn against the flat images of the edges that they stand for, in interval arithmetic.
//!
//! *Theorem.* Every point of an image lies within the bound of its stroke, and every point of a stroke within it of its
//! image. *Proof.* Distance and progress along the stroke are
//! enclosed over parts of the edge by their value in the middle and their derivative over the part. Progress is
//! continuous and takes the values at both ends, which are compared with the ends of the stroke: so it takes all values
//! between, and the stroke is covered too. Along rulings of a cone and about its apex, which has no derivative, images are
//! enclosed by sectors (`strokes/sector.rs`).
//!
//! Knows edges, maps and strokes; how they were found is not looked at.

mod coefficients;
mod guide;
mod motion;
mod sector;

use crate::geom::{Frame, Vec2, Vec3};
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::patchwork::image::{ClosedMap, EdgeImage, Stroke};
use crate::spline::blossom::of_piece;
use crate::spline::curve::Curve;
pub(super) use coefficients::root_between;
use guide::{arc_tangent, widened, Guide};
use motion::{hull, placed, turns};
use std::f64::consts::TAU;

/// Lengths of lines are computed without outward rounding; this share of them is far above what that may be.
const SLACK: f64 = 1e-12;
/// Halvings of a part of an edge at most.
const DEEPEST: usize = 14;
/// The same about the apex of a cone.
const DEEPEST_AT_APEX: usize = 48;
/// Share of the tolerance below which a bound needs no better one.
const GOOD_BOUND: f64 = 0.25;
/// The same about the apex of a cone, where it takes few parts.
const NOTHING: f64 = 1e-6;
/// Else parts are halved until bounds exceed what is seen in their middle by no more than this share of the tolerance.
const EXCESS: f64 = 0.05;

/// Bound of the distance (mm), both ways, between strokes and what they are drawn for; infinite where nothing is shown.
/// `tolerance` (mm) says how fine is fine enough. A stroke drawn for no edge is a line across a sharp bend, as long as one
/// of the `allowances` (mm); by what it is not, or by half its length, it counts as off.
pub(super) fn strokes(all: &[Stroke], allowances: &[f64], tolerance: f64) -> f64 {
    let one = |s: &Stroke| match s.images.as_deref() {
        None => f64::INFINITY,
        Some([]) => {
            let length = (s.end - s.start).norm();
            let off = allowances.iter().map(|a| (a.abs() - length).abs()).fold(0.5 * length, f64::min);
            off + SLACK * length
        }
        Some(images) => stroke(s, images, tolerance),
    };
    parallel::map(all.iter(), one).into_iter().fold(0.0, f64::max)
}

/// Distance between one stroke and its images.
fn stroke(s: &Stroke, images: &[EdgeImage], tolerance: f64) -> f64 {
    let Some(guide) = Guide::new(s) else { return f64::INFINITY };
    let mut bound = 0.0_f64;
    for image in images {
        let Some(guide) = guide.before_motion(image) else { return f64::INFINITY };
        for [a, b] in smooth_parts(image) {
            // A part that is nearer than others were needs no better bound.
            bound = bound.max(part(&guide, image, [a, b], (tolerance, [DEEPEST, DEEPEST_AT_APEX]), bound));
        }
    }
    // Ends of images that follow each other, and both ends of the stroke.
    let end = |i: &EdgeImage, k: usize| point(i, i.part[k]).map(|p| placed(i, p)).map(|p| (p[0], p[1]));
    let near = |p: Option<(Interval, Interval)>, q: Option<(Interval, Interval)>| match (p, q) {
        (Some(p), Some(q)) => ((p.0 - q.0).sqr() + (p.1 - q.1).sqr()).sqrt().hi,
        _ => f64::INFINITY,
    };
    let fixed = |p: &Vec2| Some((Interval::point(p.x), Interval::point(p.y)));
    match (images.first(), images.last()) {
        (Some(first), Some(last)) => {
            bound = bound.max(near(end(first, 0), fixed(&s.start))).max(near(end(last, 1), fixed(&s.end)));
            images.windows(2).fold(bound, |b, w| b.max(near(end(&w[0], 1), end(&w[1], 0))))
        }
        _ => f64::INFINITY,
    }
}

/// Distance from the stroke over a part of an edge, halved where that helps: not where it is at most `elsewhere` (mm).
fn part(
    guide: &Guide,
    image: &EdgeImage,
    [a, b]: [f64; 2],
    (tolerance, depths): (f64, [usize; 2]),
    elsewhere: f64,
) -> f64 {
    let seen = || {
        let p = point(image, 0.5 * (a + b))?;
        let m = guide.measure(p, [Interval::ZERO; 2])?;
        Some(m[0].mag())
    };
    let net = net(&image.curve, image.map.frame(), [a, b]);
    let ruling = sector::ruling(guide, image, &net, 0.5 * (a + b)).unwrap_or(f64::INFINITY);
    let known = ruling.min(over(guide, image, [a, b], &net).unwrap_or(f64::INFINITY));
    let apex = sector::apex(guide, image, &net).filter(|a| a.is_inside);
    let bound = known.min(apex.map_or(f64::INFINITY, |a| a.bound));
    // About an apex parts are halved towards it.
    let [depth, at_apex] = depths;
    let (left, next) = match apex {
        Some(_) => (at_apex, [depth, at_apex.saturating_sub(1)]),
        None => (depth, [depth.saturating_sub(1), at_apex]),
    };
    let enough = if apex.is_some() { NOTHING } else { GOOD_BOUND } * tolerance;
    if bound <= enough.max(elsewhere) || left == 0 || bound <= seen().unwrap_or(f64::INFINITY) + EXCESS * tolerance {
        return bound;
    }
    let m = 0.5 * (a + b);
    let next = (tolerance, next);
    let first = part(guide, image, [a, m], next, elsewhere);
    first.max(part(guide, image, [m, b], next, elsewhere.max(first)))
}

/// Distance from the stroke over a part of an edge, by values in the middle and derivatives over the part.
fn over(guide: &Guide, image: &EdgeImage, [a, b]: [f64; 2], net: &[[Interval; 4]]) -> Option<f64> {
    let m = 0.5 * (a + b);
    let reach = Interval::new(a - m, b - m).hull(Interval::point(m - a)).hull(Interval::point(m - b));
    let (v, dv) = enclosed(net, Interval::point(b) - Interval::point(a))?;
    let (_, slope) = mapped(image, v, dv, m)?;
    let middle = point(image, m)?;
    // Where the image is, by its own derivative: narrower than the map of a box.
    let place = [middle[0] + slope[0] * reach, middle[1] + slope[1] * reach];
    let [_, d_off, _, d_ahead] = guide.measure(place, slope)?;
    let [off, _, ahead, _] = guide.measure(middle, [Interval::ZERO; 2])?;
    let by_slope = off + d_off * reach;
    let off = coefficients::off(guide, &image.map, net).and_then(|off| off.intersect(by_slope)).unwrap_or(by_slope);
    let ahead = match d_ahead.lo > 0.0 || d_ahead.hi < 0.0 {
        // Progress that does not turn round is greatest at the ends.
        true => {
            let at = |t: f64| Some(guide.measure(point(image, t)?, [Interval::ZERO; 2])?[2]);
            at(a)?.hull(at(b)?)
        }
        false => ahead + d_ahead * reach,
    };
    Some(guide.distance(off, ahead))
}

/// The image of a point of an edge under the map alone.
fn point(image: &EdgeImage, t: f64) -> Option<[Interval; 2]> {
    let h = in_frame(image.curve.bounds(t, t), image.map.frame());
    let q = [h[0] / h[3], h[1] / h[3], h[2] / h[3]];
    mapped(image, q, [Interval::ZERO; 3], t).map(|m| m.0).or_else(|| sector::about_apex(image, &[h]))
}

/// Homogeneous coordinates in a frame: where radii are small against coordinates, quotients of the coordinates themselves
/// would lose them.
fn in_frame(h: [Interval; 4], frame: &Frame) -> [Interval; 4] {
    let o = &frame.origin;
    let v = [h[0] - h[3] * o.x, h[1] - h[3] * o.y, h[2] - h[3] * o.z];
    let along = |a: &Vec3| v[0] * a.x + v[1] * a.y + v[2] * a.z;
    [along(&frame.x), along(&frame.y), along(&frame.z), h[3]]
}

/// Place and derivative under the map of a box in its frame, around the point at `t`, which tells turns apart.
fn mapped(image: &EdgeImage, q: [Interval; 3], dq: [Interval; 3], t: f64) -> Option<([Interval; 2], [Interval; 2])> {
    let angle = || -> Option<(Interval, Interval)> {
        let away = q[0].sqr() + q[1].sqr();
        if away.lo <= 0.0 {
            return None;
        }
        let slope = (q[0] * dq[1] - q[1] * dq[0]) / away;
        let angle = arc_tangent(q[1], q[0])?;
        Some((angle + Interval::point(turns(image, angle.mid(), t)) * widened(TAU), slope))
    };
    match &image.map {
        ClosedMap::Plane(_) => Some(([q[0], q[1]], [dq[0], dq[1]])),
        ClosedMap::Cylinder { reach, .. } => {
            let (a, da) = angle()?;
            Some(([a * *reach, q[2]], [da * *reach, dq[2]]))
        }
        ClosedMap::Cone { half_angle, behind, turn, .. } => {
            let (a, da) = angle()?;
            let (sin, cos) = (widened(half_angle.sin()), widened(half_angle.cos()));
            let radius = (q[0].sqr() + q[1].sqr()).sqrt();
            let slant = q[2] * cos + radius * sin + Interval::point(*behind);
            let out = (q[0] * dq[0] + q[1] * dq[1]) / radius;
            let d_slant = dq[2] * cos + out * sin;
            let (f, df) = (a * *turn, da * *turn);
            let (s, c) = (widened(f.mid().sin()).widen(f.rad()), widened(f.mid().cos()).widen(f.rad()));
            Some(([slant * c, slant * s], [d_slant * c - slant * df * s, d_slant * s + slant * df * c]))
        }
    }
}

/// Parts of an edge between its knots, in the direction drawn.
fn smooth_parts(image: &EdgeImage) -> Vec<[f64; 2]> {
    let [a, b] = image.part;
    let (lo, hi) = (a.min(b), a.max(b));
    let mut at = vec![lo];
    at.extend(image.curve.knots.breaks().into_iter().filter(|t| *t > lo && *t < hi));
    at.push(hi);
    at.windows(2).map(|w| [w[0], w[1]]).collect()
}

/// Bézier points, homogeneous in a frame, of a curve between two parameters of one span.
fn net(c: &Curve<4>, frame: &Frame, [a, b]: [f64; 2]) -> Vec<[Interval; 4]> {
    let p = c.knots.degree();
    let span = c.knots.span(0.5 * (a + b));
    let coefficient = |k: usize| {
        let net = c.control[span - p..=span].iter().map(|q| in_frame(q.map(Interval::point), frame));
        let mut net: Vec<[Interval; 4]> = net.collect();
        let args: Vec<Interval> = (0..p).map(|i| Interval::point(if i < p - k { a } else { b })).collect();
        of_piece(&c.knots, span, &mut net, &args)
    };
    (0..=p).map(coefficient).collect()
}

/// Boxes around a curve of these Bézier points (homogeneous) and around its derivative by a parameter that runs over `width`.
fn enclosed(points: &[[Interval; 4]], width: Interval) -> Option<([Interval; 3], [Interval; 3])> {
    let p = points.len() - 1;
    let factor = Interval::point(p as f64) / width;
    let weight = hull(points.iter().map(|q| q[3]));
    if weight.lo <= 0.0 {
        return None;
    }
    // From a point among them, so that quotients by weights lose nothing of coordinates in which the curve hardly moves.
    let heavy: f64 = points.iter().map(|q| q[3].mid()).sum();
    let from: [f64; 3] = std::array::from_fn(|d| points.iter().map(|q| q[d].mid()).sum::<f64>() / heavy);
    let ways = || points.iter().map(|q| std::array::from_fn::<_, 3, _>(|d| q[d] - q[3] * from[d]));
    let d_weight = hull(points.windows(2).map(|w| (w[1][3] - w[0][3]) * factor));
    let steps = || ways().zip(ways().skip(1)).map(|(a, b)| std::array::from_fn::<_, 3, _>(|d| (b[d] - a[d]) * factor));
    let x: [Interval; 3] = std::array::from_fn(|d| hull(ways().map(|w| w[d])) / weight);
    let dx = std::array::from_fn(|d| (hull(steps().map(|s| s[d])) - x[d] * d_weight) / weight);
    Some((std::array::from_fn(|d| x[d] + Interval::point(from[d])), dx))
}

/// Relative change of lengths by a map: how far its frame and its turn are from orthonormal.
pub(super) fn strain(image: &EdgeImage) -> f64 {
    let frame = image.map.frame();
    let axes = [frame.x, frame.y, frame.z];
    let dot = |a: &Vec3, b: &Vec3| Interval::point(a.x) * b.x + Interval::point(a.y) * b.y + Interval::point(a.z) * b.z;
    let mut off = 0.0_f64;
    for (i, a) in axes.iter().enumerate() {
        for (j, b) in axes.iter().enumerate() {
            off = off.max((dot(a, b) - if i == j { Interval::ONE } else { Interval::ZERO }).mag());
        }
    }
    let [c, s] = image.turn.map(Interval::point);
    off = off.max((c.sqr() + s.sqr() - Interval::ONE).mag());
    if let ClosedMap::Cone { half_angle, turn, .. } = &image.map {
        off = off.max((widened(half_angle.sin()) - Interval::point(turn.abs())).mag() / turn.abs());
    }
    // A matrix whose Gram matrix is off the unit by entries of this size changes lengths by less than thrice that;
    // frame and turn follow each other.
    (Interval::point(8.0) * off).hi
}

#[cfg(test)]
mod tests;
