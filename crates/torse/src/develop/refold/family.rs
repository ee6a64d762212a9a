//! The family of rulings through the lines that are drawn.
//!
//! *Method*. Cubics with given ends in the coordinates of lines, and the changes at the lines turned so that neighbouring
//! rulings meet where the radii of the table say: the page on refolding in `docs/algorithms`.

use super::cut::cut;
use super::drawn::{bounds, crossings, FlatPart};
use super::lines::Whole;
use super::pose::Pose;
use super::smooth::Smooth;
use crate::geom::Vec2;

/// Shares of the turn of rulings that are tried beyond the last line.
const LESS: [f64; 4] = [1.0, 0.7, 0.4, 0.2];
/// Least distance of neighbouring rulings there, as a share of that in the middle.
const LEAST_SPEED: f64 = 0.15;

/// The family of rulings between and beyond the lines drawn.
pub(super) struct Family {
    /// Places of the lines, rising.
    pub at: Vec<f64>,
    /// Normal and distance from `origin` at every line, and how they change.
    lines: Vec<([f64; 3], [f64; 3])>,
    /// Way by which the outermost cubics go on beyond the first and last line.
    beyond: [f64; 2],
    /// How coordinates change from there on, where rulings run through one point or are parallel.
    tail: [[f64; 3]; 2],
    /// Where the first and last line are, along themselves, from the foot of the origin.
    pub reach: [[f64; 2]; 2],
    /// Middle of the part.
    pub origin: Vec2,
}

impl Family {
    /// The family through lines; `even` if they lie at equal steps.
    pub fn through(part: &FlatPart, lines: &[Whole], even: bool) -> Self {
        let (lo, hi) = bounds(&part.loops);
        let origin = (lo + hi) * 0.5;
        let mut at = vec![0.0];
        for w in lines.windows(2) {
            // Lines at equal turns have equal steps whatever trims leave of them.
            let step = if even { 1.0 } else { (w[1].point(0.5) - w[0].point(0.5)).norm().max(f64::MIN_POSITIVE) };
            at.push(at[at.len() - 1] + step);
        }
        let coordinates = |l: &Whole| {
            let n = Vec2::new(-l.way.y, l.way.x);
            [n.x, n.y, n.dot(&(l.at - origin))]
        };
        let mut values: Vec<[f64; 3]> = lines.iter().map(coordinates).collect();
        if let [n] = values[..] {
            // One line: the others are parallel to it.
            at.push(1.0);
            values.push([n[0], n[1], n[2] + 1.0]);
        }
        let spline = Smooth::through(&at, &values);
        let jets = at.iter().map(|t| spline.jet(*t)).collect();
        let mut out = Self { at, lines: jets, beyond: [0.0; 2], tail: [[0.0; 3]; 2], reach: [[0.0; 2]; 2], origin };
        for (k, l) in lines.iter().enumerate() {
            out.aim(k, l);
        }
        let foot = |l: &Whole| l.way.dot(&(l.at - origin));
        let reach = |l: &Whole| l.reach.map(|v| v + foot(l));
        if let (Some(first), Some(last)) = (lines.first(), lines.last()) {
            out.reach = [reach(first), reach(last)];
        }
        out.settle_ends(part);
        out
    }

    /// Turns the change at a line so that neighbouring rulings meet it where its radii say: they are as far apart at both
    /// ends as the radii are large.
    fn aim(&mut self, k: usize, line: &Whole) {
        let t = self.at[k];
        let (pose, spin, across) = self.ruling(t);
        let v = [0.0, 1.0].map(|share| (line.point(share) - pose.at.xy()).dot(&pose.ruling().xy()));
        let apart = v.map(|v| across + v * spin);
        let middle = 0.5 * (apart[0] + apart[1]);
        let [r, q] = line.radii;
        if !(r > 0.0 && q > 0.0 && (r + q).is_finite() && middle > 0.0 && v[1] > v[0]) {
            return;
        }
        let [x, y] = [2.0 * middle * r / (r + q), 2.0 * middle * q / (r + q)];
        let spin = (y - x) / (v[1] - v[0]);
        let across = x - v[0] * spin;
        // The change of normal and distance with this spin, for a normal of the length that it has.
        let ([nx, ny, p], _) = self.lines[k];
        let norm = nx.hypot(ny);
        let way = pose.ruling();
        let slope = [-spin * norm * way.x, -spin * norm * way.y, across * norm];
        self.lines[k] = ([nx, ny, p], slope);
    }

    /// How far the outermost cubics go on: half an interval, or not at all where rulings would cross in the part.
    fn settle_ends(&mut self, part: &FlatPart) {
        let n = self.at.len();
        for (end, sign) in [(0, -1.0), (1, 1.0)] {
            let (from, h) = match end {
                0 => (self.at[0], self.at[1] - self.at[0]),
                _ => (self.at[n - 1], self.at[n - 1] - self.at[n - 2]),
            };
            self.beyond[end] = 0.5 * h;
            let fine = (1..=8).all(|k| self.is_regular(part, from + sign * 0.0625 * h * f64::from(k), self.reach[end]));
            if !fine {
                self.beyond[end] = 0.0;
            }
            self.tail[end] = self.tail(part, from + sign * self.beyond[end], sign);
        }
    }

    /// How coordinates change behind an end: rulings go on through the point in which neighbours meet, or turn less where that
    /// would bring it into what is left of the part.
    fn tail(&self, part: &FlatPart, t: f64, sign: f64) -> [f64; 3] {
        let (value, slope) = self.coordinates(t);
        let norm = value[0].hypot(value[1]);
        let (pose, spin, across) = self.ruling(t);
        let Some(reach) = reach_near(part, &pose, self.reach[usize::from(sign > 0.0)]) else { return slope };
        // What is left of the part beyond the ruling.
        let chord = reach.map(|v| pose.point(v, 0.0).xy());
        let rest = cut(&part.loops, &[chord]).into_iter().filter(|r| r.chords.contains(&(0, sign > 0.0)));
        let left: Vec<f64> =
            rest.flat_map(|r| r.loops.concat()).map(|x| pose.ruling().xy().dot(&(x - pose.at.xy()))).collect();
        let middle = left.iter().sum::<f64>() / left.len().max(1) as f64;
        let speed = across + middle * spin;
        if speed.is_nan() || speed <= 0.0 || left.is_empty() {
            return if left.is_empty() { slope } else { [0.0, 0.0, norm * across.abs().max(spin.abs())] };
        }
        for share in LESS {
            let turn = spin * share;
            let here = speed - middle * turn;
            if left.iter().all(|v| here + v * turn >= LEAST_SPEED * speed) {
                let way = pose.ruling();
                return [-turn * norm * way.x, -turn * norm * way.y, here * norm];
            }
        }
        [0.0, 0.0, speed * norm]
    }

    /// Whether rulings beside a place do not cross in the part.
    pub fn is_regular(&self, part: &FlatPart, t: f64, like: [f64; 2]) -> bool {
        let (pose, spin, across) = self.ruling(t);
        let reach = reach_near(part, &pose, like);
        reach.is_none_or(|r| r.iter().all(|v| across + v * spin > 0.0))
    }

    /// Coordinates of a ruling and how they change; beyond what the cubics can tell, rulings run through one point.
    fn coordinates(&self, t: f64) -> ([f64; 3], [f64; 3]) {
        let n = self.at.len();
        let (lo, hi) = (self.at[0] - self.beyond[0], self.at[n - 1] + self.beyond[1]);
        let inner = t.clamp(lo, hi);
        let k = self.at.partition_point(|x| *x <= inner).clamp(1, n - 1);
        let h = self.at[k] - self.at[k - 1];
        let x = (inner - self.at[k - 1]) / h;
        let ((p, dp), (q, dq)) = (&self.lines[k - 1], &self.lines[k]);
        let value = |d: usize| {
            let (y, z) = (x * x, x * x * x);
            (2.0 * z - 3.0 * y + 1.0) * p[d]
                + (z - 2.0 * y + x) * h * dp[d]
                + (3.0 * y - 2.0 * z) * q[d]
                + (z - y) * h * dq[d]
        };
        let slope = |d: usize| {
            let y = x * x;
            (6.0 * y - 6.0 * x) * (p[d] - q[d]) / h + (3.0 * y - 4.0 * x + 1.0) * dp[d] + (3.0 * y - 2.0 * x) * dq[d]
        };
        let (value, slope): ([f64; 3], [f64; 3]) = (std::array::from_fn(value), std::array::from_fn(slope));
        if t == inner {
            return (value, slope);
        }
        let tail = self.tail[usize::from(t > inner)];
        (std::array::from_fn(|d| value[d] + (t - inner) * tail[d]), tail)
    }

    /// The ruling at a place, and how fast it moves: spin, and way across at the frame's own point.
    pub fn ruling(&self, t: f64) -> (Pose, f64, f64) {
        let ([x, y, p], [dx, dy, dp]) = self.coordinates(t);
        let norm = x.hypot(y);
        let n = Vec2::new(x, y) / norm;
        let way = Vec2::new(n.y, -n.x);
        let dn = Vec2::new(dx, dy) / norm;
        let spin = way.perp(&Vec2::new(dn.y, -dn.x));
        // The foot of the origin moves square to the ruling by the change of the normed distance.
        let across = dp / norm - p / norm * n.dot(&dn);
        (Pose::flat(self.origin + n * (p / norm), way), spin, across)
    }
}

/// The stretches inside the part of a ruling that go on from those of a ruling beside it, as one.
pub(super) fn reach_near(part: &FlatPart, pose: &Pose, like: [f64; 2]) -> Option<[f64; 2]> {
    let cuts = crossings(&part.loops, &pose.at.xy(), &pose.ruling().xy());
    let near = cuts.chunks_exact(2).filter(|c| c[0].max(like[0]) <= c[1].min(like[1]));
    near.map(|c| [c[0], c[1]]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
