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

mod guide;
mod motion;
mod sector;

use crate::geom::{Frame, Vec2, Vec3};
use crate::num::binomial::binomial;
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::patchwork::image::{ClosedMap, EdgeImage, Stroke};
use crate::spline::blossom::of_piece;
use crate::spline::curve::Curve;
use guide::{arc_tangent, widened, Guide};
use motion::{hull, local, placed, turns};
use std::f64::consts::TAU;

/// Lengths of lines are computed without outward rounding; this share of them is far above what that may be.
const SLACK: f64 = 1e-12;
/// Halvings of a part of an edge at most.
const DEEPEST: usize = 14;
/// The same about the apex of a cone.
const DEEPEST_AT_APEX: usize = 48;
/// Share of the tolerance below which a bound needs no better one.
const ENOUGH: f64 = 0.25;
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
        for [a, b] in smooth_parts(image) {
            bound = bound.max(part(&guide, image, [a, b], (tolerance, [DEEPEST, DEEPEST_AT_APEX])));
        }
    }
    // Ends of images that follow each other, and both ends of the stroke.
    let end = |i: &EdgeImage, k: usize| point(i, i.part[k]).map(|p| (p[0], p[1]));
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

/// Distance from the stroke over a part of an edge, halved where that helps.
fn part(guide: &Guide, image: &EdgeImage, [a, b]: [f64; 2], (tolerance, depths): (f64, [usize; 2])) -> f64 {
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
    let enough = if apex.is_some() { NOTHING } else { ENOUGH } * tolerance;
    if bound <= enough || left == 0 || bound <= seen().unwrap_or(f64::INFINITY) + EXCESS * tolerance {
        return bound;
    }
    let m = 0.5 * (a + b);
    let next = (tolerance, next);
    part(guide, image, [a, m], next).max(part(guide, image, [m, b], next))
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
    let off = flat_off(guide, image, net).unwrap_or(off + d_off * reach);
    let ahead = match d_ahead.lo > 0.0 || d_ahead.hi < 0.0 {
        // Progress that does not turn round is greatest at the ends.
        true => {
            let at = |t: f64| Some(guide.measure(point(image, t)?, [Interval::ZERO; 2])?[2]);
            at(a)?.hull(at(b)?)
        }
        false => ahead + d_ahead * reach,
    };
    let beyond = (ahead.mag() - guide.half().lo).max(0.0);
    let beyond = Interval::new(0.0, beyond);
    Some((off.sqr() + beyond.sqr()).sqrt().hi)
}

/// The image of a point of an edge.
fn point(image: &EdgeImage, t: f64) -> Option<[Interval; 2]> {
    let h = from_origin(image.curve.bounds(t, t), image.map.frame());
    let v = [h[0] / h[3], h[1] / h[3], h[2] / h[3]];
    mapped(image, v, [Interval::ZERO; 3], t).map(|m| m.0).or_else(|| sector::about_apex(image, &[h]))
}

/// Homogeneous coordinates from the origin of a frame: where radii are small against coordinates, quotients of the
/// coordinates themselves would lose them.
fn from_origin(h: [Interval; 4], frame: &Frame) -> [Interval; 4] {
    let o = &frame.origin;
    [h[0] - h[3] * o.x, h[1] - h[3] * o.y, h[2] - h[3] * o.z, h[3]]
}

/// Place and derivative under the map and the motion of a box of ways from the frame's origin, around the point at `t`,
/// which tells turns apart.
fn mapped(image: &EdgeImage, v: [Interval; 3], dv: [Interval; 3], t: f64) -> Option<([Interval; 2], [Interval; 2])> {
    let frame = image.map.frame();
    let (q, dq) = (local(frame, v), local(frame, dv));
    let angle = || -> Option<(Interval, Interval)> {
        let away = q[0].sqr() + q[1].sqr();
        if away.lo <= 0.0 {
            return None;
        }
        let slope = (q[0] * dq[1] - q[1] * dq[0]) / away;
        let angle = arc_tangent(q[1], q[0])?;
        Some((angle + Interval::point(turns(image, angle.mid(), t)) * widened(TAU), slope))
    };
    let (p, d) = match &image.map {
        ClosedMap::Plane(_) => ([q[0], q[1]], [dq[0], dq[1]]),
        ClosedMap::Cylinder { reach, .. } => {
            let (a, da) = angle()?;
            ([a * *reach, q[2]], [da * *reach, dq[2]])
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
            ([slant * c, slant * s], [d_slant * c - slant * df * s, d_slant * s + slant * df * c])
        }
    };
    let [c, s] = image.turn.map(Interval::point);
    let turned = |v: [Interval; 2]| [c * v[0] - s * v[1], s * v[0] + c * v[1]];
    Some((placed(image, p), turned(d)))
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

/// Bézier points, homogeneous from a frame's origin, of a curve between two parameters of one span.
fn net(c: &Curve<4>, frame: &Frame, [a, b]: [f64; 2]) -> Vec<[Interval; 4]> {
    let p = c.knots.degree();
    let span = c.knots.span(0.5 * (a + b));
    let coefficient = |k: usize| {
        let net = c.control[span - p..=span].iter().map(|q| from_origin(q.map(Interval::point), frame));
        let mut net: Vec<[Interval; 4]> = net.collect();
        let args: Vec<Interval> = (0..p).map(|i| Interval::point(if i < p - k { a } else { b })).collect();
        of_piece(&c.knots, span, &mut net, &args)
    };
    (0..=p).map(coefficient).collect()
}

/// Distance from a line or circle of the image of Bézier points under the map of a plane: a polynomial of the curve's degree,
/// or of twice that, over the weight, bounded by its coefficients. `None` for other maps.
fn flat_off(guide: &Guide, image: &EdgeImage, net: &[[Interval; 4]]) -> Option<Interval> {
    let ClosedMap::Plane(frame) = &image.map else { return None };
    let [c, s] = image.turn.map(Interval::point);
    let from = guide.circle.map_or(guide.start, |(centre, ..)| centre);
    let shift = [image.shift.x, image.shift.y].map(Interval::point);
    // From the start of the line or the centre of the circle, times the weight.
    let flat: Vec<[Interval; 3]> = (net.iter())
        .map(|h| {
            let q = local(frame, [h[0], h[1], h[2]]);
            let turned = [c * q[0] - s * q[1], s * q[0] + c * q[1]];
            [turned[0] + (shift[0] - from[0]) * h[3], turned[1] + (shift[1] - from[1]) * h[3], h[3]]
        })
        .collect();
    let weight = hull(flat.iter().map(|p| p[2]));
    if weight.lo <= 0.0 {
        return None;
    }
    let Some((_, radius, ..)) = guide.circle else {
        let away = hull(flat.iter().map(|p| guide.way[0] * p[1] - guide.way[1] * p[0]));
        return Some(away / weight);
    };
    // |v|² − r² = (|v| − r)(|v| + r).
    let p = flat.len() - 1;
    let form = |a: &[Interval; 3], b: &[Interval; 3]| a[0] * b[0] + a[1] * b[1] - radius.sqr() * a[2] * b[2];
    let coefficient = |k: usize| {
        let share =
            |i: usize| Interval::point(binomial(p, i) * binomial(p, k - i)) / Interval::point(binomial(2 * p, k));
        let terms = (k.saturating_sub(p)..=k.min(p)).map(|i| share(i) * form(&flat[i], &flat[k - i]));
        terms.fold(Interval::ZERO, |sum, x| sum + x)
    };
    let most = hull((0..=2 * p).map(coefficient)).mag();
    let least = root_between(Interval::point(weight.lo) * radius.lo, most);
    (radius.lo > 0.0).then(|| Interval::new(-most, most) / (Interval::point(weight.lo) * least))
}

/// Boxes around ways from a frame's origin to a curve of these Bézier points, and around its derivative by a parameter that
/// runs over `width`.
fn enclosed(points: &[[Interval; 4]], width: Interval) -> Option<([Interval; 3], [Interval; 3])> {
    let p = points.len() - 1;
    let factor = Interval::point(p as f64) / width;
    let h: [Interval; 4] = std::array::from_fn(|d| hull(points.iter().map(|q| q[d])));
    let dh: [Interval; 4] = std::array::from_fn(|d| hull(points.windows(2).map(|w| (w[1][d] - w[0][d]) * factor)));
    if h[3].lo <= 0.0 {
        return None;
    }
    let x: [Interval; 3] = std::array::from_fn(|d| h[d] / h[3]);
    Some((x, std::array::from_fn(|d| (dh[d] - x[d] * dh[3]) / h[3])))
}

/// The least of |a| + |b| where a is at least `least`, and b² off a² by `off` at most: a difference of squares over it is
/// one of roots.
pub(super) fn root_between(least: Interval, off: f64) -> Interval {
    let square = (least.sqr() - Interval::point(off)).lo.max(0.0);
    Interval::point((least + Interval::point(square).sqrt()).lo)
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
