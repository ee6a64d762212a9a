//! Line or circle of a stroke, enclosed: docs/algorithms/unroll.md.

use super::motion::{before, scale};
use crate::geom::Vec2;
use crate::num::interval::Interval;
use crate::patchwork::image::{EdgeImage, Stroke};

/// Line or circle of a stroke, enclosed.
pub(super) struct Guide {
    /// What a length in its plane is in the drawing.
    scale: Interval,
    pub(super) start: [Interval; 2],
    /// Unit direction of a line; of an arc, that from the centre to its middle.
    pub(super) way: [Interval; 2],
    pub(super) length: Interval,
    /// Centre, radius, half the sweep and its sign.
    pub(super) circle: Option<([Interval; 2], Interval, Interval, f64)>,
}

impl Guide {
    pub(super) fn new(s: &Stroke) -> Option<Self> {
        let at = |p: &Vec2| [Interval::point(p.x), Interval::point(p.y)];
        let (a, b) = (at(&s.start), at(&s.end));
        let chord = [b[0] - a[0], b[1] - a[1]];
        let length = (chord[0].sqr() + chord[1].sqr()).sqrt();
        if length.lo <= 0.0 {
            return None;
        }
        if s.bulge == 0.0 {
            let way = [chord[0] / length, chord[1] / length];
            return Some(Self { scale: Interval::ONE, start: a, way, length, circle: None });
        }
        let bulge = Interval::point(s.bulge);
        let quarter = (Interval::ONE / bulge - bulge) * 0.25;
        let half = Interval::point(0.5);
        let centre = [(a[0] + b[0]) * half - chord[1] * quarter, (a[1] + b[1]) * half + chord[0] * quarter];
        let radius = (((a[0] - centre[0]).sqr() + (a[1] - centre[1]).sqr()).sqrt()).abs();
        let sign = s.bulge.signum();
        // The middle of a counter-clockwise arc lies to the right of its chord.
        let way = [chord[1] / length * sign, -(chord[0] / length) * sign];
        let half_sweep = widened(2.0 * s.bulge.abs().atan());
        Some(Self { scale: Interval::ONE, start: a, way, length, circle: Some((centre, radius, half_sweep, sign)) })
    }

    /// The same in the plane of an image before its motion, in which boxes around it are narrower; `None` where the motion is
    /// none.
    pub(super) fn before_motion(&self, image: &EdgeImage) -> Option<Self> {
        let scale = scale(image)?;
        let shift = [image.shift.x, image.shift.y].map(Interval::point);
        let place = |p: [Interval; 2]| before(image, [p[0] - shift[0], p[1] - shift[1]]);
        let circle = |(centre, radius, half_sweep, sign)| (place(centre), radius / scale, half_sweep, sign);
        Some(Self {
            scale,
            start: place(self.start),
            way: before(image, self.way).map(|w| w * scale),
            length: self.length / scale,
            circle: self.circle.map(circle),
        })
    }

    /// Distance (mm, in the drawing) from the stroke of a place that is `off` it and `ahead` of its middle. At a distance ρ from
    /// the centre of an arc of radius r, an angle φ beyond its end, that is the root of (ρ − r)² + 4ρr sin²(φ/2), and 4 sin²(φ/2) < φ².
    pub(super) fn distance(&self, off: Interval, ahead: Interval) -> f64 {
        let beyond = Interval::point((Interval::point(ahead.mag()) - self.half()).hi.max(0.0));
        let outside = match self.circle {
            Some((_, radius, ..)) => Interval::ONE + Interval::point(off.mag()) / radius,
            None => Interval::ONE,
        };
        ((off.sqr() + beyond.sqr() * outside).sqrt() * self.scale).hi
    }

    /// Distance from the line or circle (signed), and way beyond its ends, of a place; both with their derivative where
    /// the place has one: `(off, off', ahead, ahead')`. `ahead` is measured from the middle, mm.
    pub(super) fn measure(&self, p: [Interval; 2], d: [Interval; 2]) -> Option<[Interval; 4]> {
        let Some((centre, radius, _, sign)) = self.circle else {
            let v = [p[0] - self.start[0], p[1] - self.start[1]];
            let dot = |v: [Interval; 2]| v[0] * self.way[0] + v[1] * self.way[1];
            let perp = |v: [Interval; 2]| self.way[0] * v[1] - self.way[1] * v[0];
            return Some([perp(v), perp(d), dot(v) - self.length * 0.5, dot(d)]);
        };
        let v = [p[0] - centre[0], p[1] - centre[1]];
        let reach = (v[0].sqr() + v[1].sqr()).sqrt();
        if reach.lo <= 0.0 {
            return None;
        }
        let out = (v[0] * d[0] + v[1] * d[1]) / reach;
        let along = (v[0] * d[1] - v[1] * d[0]) / reach.sqr() * radius * sign;
        let (x, y) = (v[0] * self.way[0] + v[1] * self.way[1], self.way[0] * v[1] - self.way[1] * v[0]);
        let angle = arc_tangent(y, x)?;
        Some([reach - radius, out, angle * radius * sign, along])
    }

    /// Half the length of the stroke, mm.
    pub(super) fn half(&self) -> Interval {
        self.circle.map_or(self.length * 0.5, |(_, radius, half_sweep, _)| radius * half_sweep)
    }
}

/// Relative error of trigonometric functions of the standard library, far above what any platform's library has.
pub(super) const TRIGONOMETRIC: f64 = 1e-14;

/// A number from a trigonometric function, with its error.
pub(super) fn widened(x: f64) -> Interval {
    Interval::point(x).widen(TRIGONOMETRIC * (1.0 + x.abs()))
}

/// Angle of small boxes: that of the middle, with the angle under which the box is seen.
pub(super) fn arc_tangent(y: Interval, x: Interval) -> Option<Interval> {
    let away = (x.sqr() + y.sqr()).sqrt();
    let box_radius = (Interval::point(x.rad()).sqr() + Interval::point(y.rad()).sqr()).sqrt();
    let share = (box_radius / away).hi;
    // sin of the angle is at most the share; below a half the angle is at most 1.1 times it.
    (away.lo > 0.0 && share < 0.5).then(|| widened(y.mid().atan2(x.mid())).widen((1.1 * share).next_up()))
}
