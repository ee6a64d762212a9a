//! The family of rulings through the lines that are drawn.
//!
//! *Method*. From line to line the cubics of `develop::between`; beyond the first and last line as the page on refolding in
//! `docs/algorithms` says.

use super::cut::cut;
use super::drawn::FlatPart;
use super::lines::Whole;
use crate::develop::between::{moving, Between};
use crate::geom::polygon::{bounds, crossings, distance};
use crate::geom::Vec2;
use crate::num::quadrature::GAUSS_4;
use crate::torse::ribbon::pose::{Pose, Rates};

/// Shares of the turn of rulings that are tried beyond the last line.
const LESS: [f64; 4] = [1.0, 0.7, 0.4, 0.2];
/// Least distance of neighbouring rulings there, as a share of that in the middle.
const LEAST_SPEED: f64 = 0.15;
/// Share of the part's size within which the outline runs through the point where rulings meet.
const TIP: f64 = 1e-4;
/// Share of the part's size below which a ruling only touches the part.
const TOUCHES: f64 = 1e-6;

/// The family of rulings between and beyond the lines drawn: line k has the place k.
pub(super) struct Family {
    /// Stretches from line to line.
    pub stretches: Vec<Between>,
    /// Way by which the outermost cubics go on beyond the first and last line.
    beyond: [f64; 2],
    /// How coordinates change from there on, where rulings run through one point or are parallel.
    tail: [[f64; 3]; 2],
    /// Where the first and last line are, along themselves, from the foot of the origin.
    pub reach: [[f64; 2]; 2],
    /// A point from which rulings are told: the tip of a cone, else the middle of the part.
    pub origin: Vec2,
    /// See [`centres`].
    centres: Vec<Vec2>,
    /// Where the rulings beside the first and last line meet in a corner of the outline, if they do: the tip of a cone or fan.
    tips: [Option<Vec2>; 2],
}

impl Family {
    /// The family through lines, at least two: about the tip in which they all meet, if they do, else about the middle of the part.
    pub fn through(part: &FlatPart, lines: &[Whole]) -> Self {
        let (lo, hi) = bounds(&part.loops);
        let out = Self::about(part, lines, (lo + hi) * 0.5);
        match out.tips {
            [Some(p), Some(q)] if (q - p).norm() <= TOUCHES * part.size() => Self::about(part, lines, (p + q) * 0.5),
            _ => out,
        }
    }

    fn about(part: &FlatPart, lines: &[Whole], origin: Vec2) -> Self {
        let between = |w: &[Whole]| {
            let [a, b] = [w[0].side(true), w[1].side(false)];
            Between::new(&a, &b, w[1].turned[0] - w[0].turned[1], origin)
        };
        let stretches = lines.windows(2).map(between).collect();
        let mut out = Self {
            stretches,
            beyond: [0.0; 2],
            tail: [[0.0; 3]; 2],
            reach: [[0.0; 2]; 2],
            origin,
            centres: centres(part, lines, origin),
            tips: [None; 2],
        };
        let foot = |l: &Whole| l.way.dot(&(l.at - origin));
        let reach = |l: &Whole| l.reach.map(|v| v + foot(l));
        if let (Some(first), Some(last)) = (lines.first(), lines.last()) {
            out.reach = [reach(first), reach(last)];
        }
        out.tips = [0.0, out.last()].map(|t| out.tip(part, t));
        out.settle_ends(part);
        out
    }

    /// Where the ruling at a place meets its neighbours, if a corner of the outline lies there.
    fn tip(&self, part: &FlatPart, t: f64) -> Option<Vec2> {
        let (pose, spin, across) = self.ruling(t);
        let meet = pose.at.xy() - pose.ruling().xy() * (across / spin);
        let near = part.loops.iter().flatten().min_by(|p, q| (*p - meet).norm().total_cmp(&(*q - meet).norm()))?;
        ((near - meet).norm() <= TIP * part.size()).then_some(meet)
    }

    /// The stretch inside the part of the ruling at a place, on its own side of the tip if there is one, that goes on from
    /// the stretch of a ruling beside it; `None` where it only touches the part.
    pub fn reach_at(&self, part: &FlatPart, t: f64, like: [f64; 2]) -> Option<[f64; 2]> {
        let (pose, spin, _) = self.ruling(t);
        let tip = self.tips[usize::from(2.0 * t > self.last())];
        let end = tip.map(|tip| pose.ruling().xy().dot(&(tip - pose.at.xy())));
        let side = |[a, b]: [f64; 2]| match end {
            Some(v) if spin > 0.0 => [a.max(v), b],
            Some(v) if spin < 0.0 => [a, b.min(v)],
            _ => [a, b],
        };
        let found = side(reach_near(part, &pose, side(like))?);
        // Outlines may keep a hair from the tip: what a ruling has there is no part of the sheet.
        let least = if tip.is_some() { TIP } else { TOUCHES };
        (found[1] - found[0] > least * part.size()).then_some(found)
    }

    /// How far the outermost cubics go on: half an interval, or not at all where rulings would cross in the part.
    fn settle_ends(&mut self, part: &FlatPart) {
        for (end, sign) in [(0, -1.0), (1, 1.0)] {
            let from = if end == 0 { 0.0 } else { self.last() };
            self.beyond[end] = 0.5;
            let fine = (1..=8).all(|k| self.is_regular(part, from + sign * 0.0625 * f64::from(k), self.reach[end]));
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
        let Some(reach) = self.reach_at(part, t, self.reach[usize::from(sign > 0.0)]) else { return slope };
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
        let tip = self.tips[usize::from(sign > 0.0)];
        if tip.is_some() {
            return slope_through(&pose, spin, speed - middle * spin, norm);
        }
        for share in LESS {
            let turn = spin * share;
            let here = speed - middle * turn;
            if left.iter().all(|v| here + v * turn >= LEAST_SPEED * speed) {
                return slope_through(&pose, turn, here, norm);
            }
        }
        [0.0, 0.0, speed * norm]
    }

    /// Whether rulings beside a place do not cross in the part.
    pub fn is_regular(&self, part: &FlatPart, t: f64, like: [f64; 2]) -> bool {
        let (_, spin, across) = self.ruling(t);
        let reach = self.reach_at(part, t, like);
        // At a tip neighbours meet, up to rounding.
        let slack = match self.tips[usize::from(2.0 * t > self.last())] {
            Some(_) => TIP * part.size() * spin.abs(),
            None => 0.0,
        };
        reach.is_none_or(|r| r.iter().all(|v| across + v * spin > -slack))
    }

    /// The point about which rulings are laid at a place; see [`centres`].
    pub fn centre(&self, t: f64) -> Vec2 {
        self.centres[(t.max(0.0) as usize).min(self.stretches.len() - 1)]
    }

    /// Place of the last line, or of the end of the only stretch.
    pub fn last(&self) -> f64 {
        self.stretches.len() as f64
    }

    /// The stretch of a place, and the place within it.
    fn stretch(&self, t: f64) -> (&Between, f64) {
        let k = (t.max(0.0) as usize).min(self.stretches.len() - 1);
        (&self.stretches[k], t - k as f64)
    }

    /// Coordinates of a ruling and how they change; beyond what the cubics can tell, rulings run through one point.
    fn coordinates(&self, t: f64) -> ([f64; 3], [f64; 3]) {
        let inner = t.clamp(-self.beyond[0], self.last() + self.beyond[1]);
        let (stretch, x) = self.stretch(inner);
        let (value, slope) = stretch.coordinates(x);
        if t == inner {
            return (value, slope);
        }
        let tail = self.tail[usize::from(t > inner)];
        (std::array::from_fn(|d| value[d] + (t - inner) * tail[d]), tail)
    }

    /// The ruling at a place, and how fast it moves: spin, and way across at the frame's own point.
    pub fn ruling(&self, t: f64) -> (Pose, f64, f64) {
        let (value, slope) = self.coordinates(t);
        moving(&self.origin, &value, &slope)
    }

    /// The motion in space from one place to another, between which no line lies; `flat` are the rulings there.
    pub fn motion(&self, [a, b]: [f64; 2], flat: [&Pose; 2]) -> Rates {
        let (stretch, _) = self.stretch(0.5 * (a + b));
        let from = (0.5 * (a + b)).clamp(0.0, self.last() - 0.5).floor();
        let rate = |t: f64| stretch.rate(t - from, &self.ruling(t));
        Rates { turn: GAUSS_4.integrate(a, b, rate), ..flat[0].flat_rates_to(flat[1]) }
    }
}

/// The points about which rulings are laid, stretch by stretch: from one line at which pieces of the part join to the next, where all
/// lines meet in one point of the outline, that point, else `origin`.
fn centres(part: &FlatPart, lines: &[Whole], origin: Vec2) -> Vec<Vec2> {
    let near = TIP * part.size();
    let meets: Vec<Vec2> = lines
        .windows(2)
        .map(|w| w[0].at + w[0].way * ((w[1].at - w[0].at).perp(&w[1].way) / w[0].way.perp(&w[1].way)))
        .collect();
    let mut out = Vec::with_capacity(meets.len());
    let mut first = 0;
    for end in (1..lines.len()).filter(|k| lines[*k].joins() || k + 1 == lines.len()) {
        let own = &meets[first..end];
        let one = own.iter().all(|m| (m - own[0]).norm() <= near) && distance(&part.loops, &own[0]) <= near;
        out.resize(end, if one { own[0] } else { origin });
        first = end;
    }
    out
}

/// How coordinates of this `norm` change where a ruling spins, and its own point moves across.
fn slope_through(pose: &Pose, spin: f64, across: f64, norm: f64) -> [f64; 3] {
    let way = pose.ruling();
    [-spin * norm * way.x, -spin * norm * way.y, across * norm]
}

/// The stretches inside the part of a ruling that go on from those of a ruling beside it, as one.
fn reach_near(part: &FlatPart, pose: &Pose, like: [f64; 2]) -> Option<[f64; 2]> {
    let cuts = crossings(&part.loops, &pose.at.xy(), &pose.ruling().xy());
    let near = cuts.chunks_exact(2).filter(|c| c[0].max(like[0]) <= c[1].min(like[1]));
    near.map(|c| [c[0], c[1]]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
