//! Rulings and turn of a sheet between two lines that are drawn: what lines, radii and turns of a bend table say about the
//! stretch between them.
//!
//! *Method*. A line of the plane has the coordinates (n, p), its unit normal and distance; the family between two lines is
//! the cubic through both with the changes that their radii give: neighbouring rulings are as far apart at both ends of a
//! line as its radii there are large \[DC76\]. Lines through one point satisfy a linear relation that the cubic keeps, so
//! that cones and cylinders stay what they are. The curvature at a fixed way along the rulings runs from that of one line to
//! that of the other, and a quadratic bubble brings the turn between the lines to what the table says: for circular cones and
//! cylinders that bubble is nothing.

use crate::geom::Vec2;
use crate::num::quadrature::GAUSS_4;
use crate::torse::ribbon::pose::{Pose, Rates};

/// A line as one side of a stretch sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSide {
    /// A point of it.
    pub at: Vec2,
    /// Unit direction; the family goes on to its left.
    pub way: Vec2,
    /// Where it begins and ends, mm from the point on.
    pub reach: [f64; 2],
    /// Radii of the sheet (mm, not negative) there; infinite where it is flat.
    pub radii: [f64; 2],
    /// +1 where the sheet comes up towards the eye, −1 where it goes down.
    pub sign: f64,
}

/// The family between two lines, over a parameter that runs from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    origin: Vec2,
    /// Normal and distance of both lines from `origin`.
    value: [[f64; 3]; 2],
    /// How they change.
    slope: [[f64; 3]; 2],
    /// A point in the middle, from `origin`: curvatures are compared near its feet on the rulings.
    middle: Vec2,
    /// How far from these feet, along both lines.
    along: [f64; 2],
    /// Curvatures there, positive towards the eye, and what is added between them.
    curvature: [f64; 2],
    bubble: f64,
    /// Whether the sheet turns evenly instead: where both lines bend one way and what lies between would bend the other.
    even: Option<f64>,
}

/// Coordinates of a line and how they may change.
struct Seen {
    value: [f64; 3],
    slope: Option<[f64; 3]>,
    along: f64,
    curvature: f64,
}

/// Parts in which turns are integrated.
const PARTS: usize = 4;

impl LineSide {
    /// Way along the line of the foot of a point, from the line's own point.
    fn foot(&self, origin: &Vec2) -> f64 {
        self.way.dot(&(origin - self.at))
    }

    /// Where the line begins and ends, from the foot of a point on.
    fn around_foot(&self, origin: &Vec2) -> [f64; 2] {
        self.reach.map(|v| v - self.foot(origin))
    }

    /// Coordinates, and their change where neighbouring rulings are `apart` (mm) at the way `along` from the foot.
    fn seen(&self, origin: &Vec2, along: f64, apart: f64) -> Seen {
        let n = Vec2::new(-self.way.y, self.way.x);
        let [a, b] = self.around_foot(origin);
        let along = along.clamp(a.min(b), a.max(b));
        let value = [n.x, n.y, n.dot(&(self.at - origin))];
        let rise = (self.radii[1] - self.radii[0]) / (b - a);
        let radius = |v: f64| self.radii[0] + rise * (v - a);
        let here = radius(along);
        if !(here > 0.0 && here.is_finite() && rise.is_finite()) {
            return Seen { value, slope: None, along, curvature: 0.0 };
        }
        let spin = apart * rise / here;
        let across = apart * radius(0.0) / here;
        let slope = [-spin * self.way.x, -spin * self.way.y, across];
        Seen { value, slope: Some(slope), along, curvature: self.sign / here }
    }
}

impl Between {
    /// The family from a line to the next one, which turns the sheet by `turn` (rad, positive towards the eye); `origin` is a
    /// point near both.
    pub fn new(first: &LineSide, last: &LineSide, turn: f64, origin: Vec2) -> Self {
        let half = |l: &LineSide| l.at + l.way * (0.5 * (l.reach[0] + l.reach[1]));
        let middle = (half(first) + half(last)) * 0.5;
        let at = |l: &LineSide| {
            let [a, b] = l.reach;
            l.at + l.way * l.foot(&middle).clamp(a.min(b), a.max(b))
        };
        let apart = (at(last) - at(first)).norm();
        let foot = |l: &LineSide| l.way.dot(&(middle - origin));
        let ends = [first, last].map(|l| l.seen(&origin, foot(l), apart));
        let chord: [f64; 3] = std::array::from_fn(|d| ends[1].value[d] - ends[0].value[d]);
        // Where a line tells nothing, the cubic does not bend there.
        let natural = |other: &[f64; 3]| std::array::from_fn(|d| 1.5 * chord[d] - 0.5 * other[d]);
        let slope = match (ends[0].slope, ends[1].slope) {
            (Some(a), Some(b)) => [a, b],
            (Some(a), None) => [a, natural(&a)],
            (None, Some(b)) => [natural(&b), b],
            (None, None) => [chord, chord],
        };
        let mut out = Self {
            origin,
            value: [ends[0].value, ends[1].value],
            slope,
            middle: middle - origin,
            along: [ends[0].along - foot(first), ends[1].along - foot(last)],
            curvature: [ends[0].curvature, ends[1].curvature],
            bubble: 0.0,
            even: None,
        };
        let whole = out.width();
        let found = out.integral(0.0, 1.0, &|x| out.curvature[0] * (1.0 - x) + out.curvature[1] * x);
        let bubble = (turn - found) / out.integral(0.0, 1.0, &bubble);
        out.bubble = if bubble.is_finite() { bubble } else { 0.0 };
        let alike = out.curvature.iter().all(|c| c * turn >= 0.0);
        let through = |x: f64| (out.curvature_at(x) * turn) < 0.0;
        if alike && turn != 0.0 && (1..PLACES).any(|k| through(k as f64 / PLACES as f64)) {
            out.even = Some(turn / whole);
        }
        out
    }

    fn curvature_at(&self, x: f64) -> f64 {
        self.even.unwrap_or(self.curvature[0] * (1.0 - x) + self.curvature[1] * x + self.bubble * bubble(x))
    }

    /// Integral over the way across the rulings, where curvatures are compared.
    fn integral(&self, a: f64, b: f64, f: &dyn Fn(f64) -> f64) -> f64 {
        let speed = |x: f64| {
            let (pose, spin, across) = self.ruling(x);
            across + self.along_at(x, &pose) * spin
        };
        let h = (b - a) / PARTS as f64;
        let at = |k: usize| a + h * k as f64;
        (0..PARTS).map(|k| GAUSS_4.integrate(at(k), at(k + 1), |x| f(x) * speed(x))).sum()
    }

    /// Way along a ruling, from the foot of the origin, at which curvatures are compared.
    fn along_at(&self, x: f64, pose: &Pose) -> f64 {
        let x = x.clamp(0.0, 1.0);
        pose.ruling().xy().dot(&self.middle) + self.along[0] * (1.0 - x) + self.along[1] * x
    }

    /// Rate at which the sheet turns where the ruling moves as given; beyond the stretch the curvature goes on evenly.
    pub fn rate(&self, x: f64, (pose, spin, across): &(Pose, f64, f64)) -> f64 {
        let inner = x.clamp(0.0, 1.0);
        let slope = self.curvature[1] - self.curvature[0] + self.bubble * if x < 0.0 { 6.0 } else { -6.0 };
        let more = if self.even.is_some() { 0.0 } else { slope * (x - inner).clamp(-BEYOND, BEYOND) };
        let here = self.curvature_at(inner);
        // What goes on does not change its sense.
        let curvature = if (here + more) * here > 0.0 { here + more } else { here };
        curvature * (across + self.along_at(x, pose) * spin)
    }

    /// Way across the rulings from one line to the other, mm.
    pub fn width(&self) -> f64 {
        self.integral(0.0, 1.0, &|_| 1.0)
    }

    /// Turn of the sheet (rad) that curvatures at the lines alone would not give.
    pub fn disagreement(&self) -> f64 {
        self.integral(0.0, 1.0, &|x| self.bubble * bubble(x)).abs()
    }

    /// Turn of the sheet between two places, rad.
    pub fn turn(&self, a: f64, b: f64) -> f64 {
        self.integral(a, b, &|x| self.curvature_at(x))
    }

    /// Coordinates of the ruling at a place, and how they change; beyond the stretch the cubic goes on.
    pub fn coordinates(&self, x: f64) -> ([f64; 3], [f64; 3]) {
        let (y, z) = (x * x, x * x * x);
        let [p, q] = &self.value;
        let [dp, dq] = &self.slope;
        let value = |d: usize| {
            (2.0 * z - 3.0 * y + 1.0) * p[d] + (z - 2.0 * y + x) * dp[d] + (3.0 * y - 2.0 * z) * q[d] + (z - y) * dq[d]
        };
        let slope = |d: usize| {
            (6.0 * y - 6.0 * x) * (p[d] - q[d]) + (3.0 * y - 4.0 * x + 1.0) * dp[d] + (3.0 * y - 2.0 * x) * dq[d]
        };
        (std::array::from_fn(value), std::array::from_fn(slope))
    }

    /// The ruling at a place, and how fast it moves: spin, and way across at the foot of the origin.
    pub fn ruling(&self, x: f64) -> (Pose, f64, f64) {
        let (value, slope) = self.coordinates(x);
        moving(&self.origin, &value, &slope)
    }

    /// The motions of the ruling in space over equal parts of the stretch: between them the sheet is a plane, a circular
    /// cylinder or a circular cone.
    pub fn steps(&self, count: usize) -> Vec<Rates> {
        let at = |k: usize| k as f64 / count as f64;
        let poses: Vec<Pose> = (0..=count).map(|k| self.ruling(at(k)).0).collect();
        let rates = |k: usize| Rates { turn: self.turn(at(k), at(k + 1)), ..poses[k].flat_rates_to(&poses[k + 1]) };
        (0..count).map(rates).collect()
    }
}

/// Share of the stretch by which curvatures change on beyond it.
const BEYOND: f64 = 0.5;
/// Places at which the sense of the curvature is looked at.
const PLACES: usize = 8;

/// What is added to curvatures between two lines, up to a factor: its mean is one.
fn bubble(x: f64) -> f64 {
    6.0 * x * (1.0 - x)
}

/// The ruling with given coordinates from a point, and how fast it moves.
pub fn moving(origin: &Vec2, [x, y, p]: &[f64; 3], [dx, dy, dp]: &[f64; 3]) -> (Pose, f64, f64) {
    let norm = x.hypot(*y);
    let n = Vec2::new(*x, *y) / norm;
    let way = Vec2::new(n.y, -n.x);
    let dn = Vec2::new(*dx, *dy) / norm;
    let spin = way.perp(&Vec2::new(dn.y, -dn.x));
    // The foot of the origin moves square to the ruling by the change of the normed distance.
    let across = dp / norm - p / norm * n.dot(&dn);
    (Pose::flat(origin + n * (p / norm), way), spin, across)
}
