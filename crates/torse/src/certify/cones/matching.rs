//! Which point of a boundary belongs to which point of an edge: found by numbers, judged by intervals elsewhere.
//!
//! Any continuous correspondence that runs once around both loops will do for the proof of [`super::outline`]
//! (docs/algorithms/cones.md); one that joins near points makes its bounds small. Nothing here has to be true.

use super::side::{before, EdgeCurve};
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use crate::torse::g1_element::G1Element;

/// A closed boundary as a sequence of spans, position τ = number of the span + share of it.
pub(super) struct Ring<'a> {
    patch: &'a Surface,
    spans: Vec<(&'a Curve<2>, [f64; 2])>,
    /// Places along it: τ, point, length from the beginning.
    stations: Vec<(f64, Vec3, f64)>,
}

/// Places to a span at least, and to the whole ring about.
const SPAN_STATIONS: usize = 4;
const RING_STATIONS: usize = 600;
/// Places as near as this to the nearest one, as a share of the whole ring, are as near: both sides of the seam of a pipe.
const AS_NEAR: f64 = 1e-9;
/// Ends of edges that lie this near to their places, as a share of the whole ring, are where they belong.
const CLOSE: f64 = 1e-3;
/// Steps of searches for the nearest place, each to two thirds of the interval.
const STEPS: usize = 60;
/// A station lies this far from where the lengths say, as a share of the way from the last one and of the whole ring.
const WINDOW: [f64; 2] = [0.3, 0.004];

impl<'a> Ring<'a> {
    /// The ring of closed runs of curves on a patch.
    pub(super) fn new(patch: &'a Surface, curves: &'a [Curve<2>]) -> Self {
        let mut spans = Vec::new();
        for c in curves {
            spans.extend(c.knots.breaks().windows(2).map(|w| (c, [w[0], w[1]])));
        }
        let mut ring = Self { patch, spans, stations: Vec::new() };
        ring.measure();
        ring
    }

    fn measure(&mut self) {
        // A span may be a whole rim, which ends where it begins.
        let place = |k: usize, j: usize| self.point(k as f64 + j as f64 / SPAN_STATIONS as f64);
        let chord = |k: usize| (0..SPAN_STATIONS).map(|j| (place(k, j + 1) - place(k, j)).norm()).sum();
        let chords: Vec<f64> = (0..self.spans.len()).map(chord).collect();
        let whole: f64 = chords.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let mut stations: Vec<(f64, Vec3, f64)> = Vec::new();
        let mut length = 0.0;
        for (k, c) in chords.iter().enumerate() {
            let parts = SPAN_STATIONS.max((RING_STATIONS as f64 * c / whole) as usize);
            for j in 0..parts {
                let tau = k as f64 + j as f64 / parts as f64;
                let x = self.point(tau);
                length += stations.last().map_or(0.0, |s| (x - s.1).norm());
                stations.push((tau, x, length));
            }
        }
        let end = self.point(0.0);
        length += stations.last().map_or(0.0, |s| (end - s.1).norm());
        stations.push((self.spans.len() as f64, end, length));
        self.stations = stations;
    }

    /// The same ring the other way round.
    fn reverse(&mut self) {
        self.spans.reverse();
        self.spans.iter_mut().for_each(|s| s.1.swap(0, 1));
        self.measure();
    }

    fn length(&self) -> f64 {
        self.stations.last().map_or(0.0, |s| s.2)
    }

    /// Number of spans: τ of a full turn.
    pub(super) fn turn(&self) -> f64 {
        self.spans.len() as f64
    }

    /// The span of a stretch of τ that stays within one, and its curve's parameters there.
    pub(super) fn stretch(&self, [a, b]: [f64; 2]) -> (&'a Curve<2>, [f64; 2]) {
        let whole = (0.5 * (a + b)).floor();
        let (curve, [t0, t1]) = self.spans[whole.rem_euclid(self.turn()) as usize];
        // Ends bit by bit.
        let at = |tau: f64| match tau - whole {
            x if x <= 0.0 => t0,
            x if x >= 1.0 => t1,
            x => t0 + (t1 - t0) * x,
        };
        (curve, [at(a), at(b)])
    }

    /// Parameters of the patch at τ.
    fn place(&self, tau: f64) -> [f64; 2] {
        let (curve, [t, _]) = self.stretch([tau, tau]);
        curve.point(t)
    }

    pub(super) fn point(&self, tau: f64) -> Vec3 {
        let [u, v] = self.place(tau);
        self.patch.point(u, v)
    }

    /// Distance of the nearest station.
    pub(super) fn far(&self, x: &Vec3) -> f64 {
        self.stations.iter().map(|s| (s.1 - x).norm()).fold(f64::INFINITY, f64::min)
    }

    /// Length up to the station nearest to a point.
    fn nearest(&self, x: &Vec3) -> f64 {
        let best = self.stations.iter().min_by(|a, b| (a.1 - x).norm_squared().total_cmp(&(b.1 - x).norm_squared()));
        best.map_or(0.0, |s| s.2)
    }

    /// Lengths up to all stations that are nearest to a point: where a ring passes a place twice there are two.
    fn all_nearest(&self, x: &Vec3) -> Vec<f64> {
        let far = |k: usize| (self.stations[k].1 - x).norm();
        let n = self.stations.len() - 1;
        let best = (0..n).map(far).fold(f64::INFINITY, f64::min);
        let near = best + AS_NEAR * self.length();
        (0..n).filter(|k| far(*k) <= near).map(|k| self.stations[k].2).collect()
    }

    /// Runs the same way as a sequence of points of it, which is closed.
    pub(super) fn follow(&mut self, points: &[Vec3]) {
        let whole = self.length();
        let at: Vec<f64> = points.iter().map(|x| self.nearest(x)).collect();
        let step = |i: usize| {
            let d = at[(i + 1) % at.len()] - at[i];
            d - whole * (d / whole).round()
        };
        if (0..at.len()).map(step).sum::<f64>() < 0.0 {
            self.reverse();
        }
    }

    /// τ of the place nearest to a point, whose length along the ring is about `expected`, give or take `window`.
    fn near(&self, x: &Vec3, expected: f64, window: f64) -> f64 {
        let whole = self.length();
        let n = self.stations.len() - 1;
        let mut best = (f64::INFINITY, 0.0, 1.0 / SPAN_STATIONS as f64);
        let first = ((expected - window) / whole).floor() as i64;
        let last = ((expected + window) / whole).floor() as i64;
        for round in first..=last {
            for k in 0..n {
                let (tau, p, length) = &self.stations[k];
                let length = length + whole * round as f64;
                if (length - expected).abs() > window {
                    continue;
                }
                let far = (p - x).norm_squared();
                if far < best.0 {
                    let before =
                        if k > 0 { tau - self.stations[k - 1].0 } else { self.turn() - self.stations[n - 1].0 };
                    best = (far, tau + self.turn() * round as f64, before.max(self.stations[k + 1].0 - tau));
                }
            }
        }
        least(best.1 - best.2, best.1 + best.2, |tau| (self.point(tau) - x).norm_squared())
    }

    /// τ between two others of the place nearest to a point.
    pub(super) fn between(&self, x: &Vec3, [a, b]: [f64; 2]) -> f64 {
        least(a, b, |tau| (self.point(tau) - x).norm_squared())
    }

    /// τ in between where a knot line of the patch is crossed, in order.
    pub(super) fn crossings(&self, [a, b]: [f64; 2]) -> Vec<f64> {
        /// Places at which a crossing is looked for.
        const TRIED: usize = 8;
        let breaks = self.patch.knots_u.breaks();
        let mut out = Vec::new();
        for knot in &breaks[1..breaks.len() - 1] {
            let off = |tau: f64| self.place(tau)[0] - knot;
            for k in 0..TRIED {
                let at = |k: usize| a + (b - a) * k as f64 / TRIED as f64;
                out.extend(root(at(k), at(k + 1), &off));
            }
        }
        out.sort_by(f64::total_cmp);
        out
    }
}

/// Where a function is least between two places, if it has one least value there.
fn least(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..STEPS {
        let (l, r) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
        if f(l) <= f(r) {
            b = r;
        } else {
            a = l;
        }
    }
    0.5 * (a + b)
}

/// Where a function changes its sign between two places.
fn root(mut a: f64, mut b: f64, f: &impl Fn(f64) -> f64) -> Option<f64> {
    let from = f(a);
    if from == 0.0 || (from < 0.0) == (f(b) < 0.0) {
        return None;
    }
    for _ in 0..STEPS {
        let m = 0.5 * (a + b);
        if (f(m) < 0.0) == (from < 0.0) {
            a = m;
        } else {
            b = m;
        }
    }
    Some(0.5 * (a + b))
}

/// Where a function changes its sign beside a place, within half a span: near it before farther away, since the plane of a
/// joint cuts a span that is a whole rim on both sides, and there rounding says what the signs at its ends are.
fn crossing_beside(tau: f64, f: &impl Fn(f64) -> f64) -> Option<f64> {
    const NEAR: [f64; 3] = [0.008, 0.06, 0.5];
    NEAR.into_iter().find_map(|near| {
        let both = root(tau - near, tau, f).into_iter().chain(root(tau, tau + near, f));
        both.min_by(|a, b| (a - tau).abs().total_cmp(&(b - tau).abs()))
    })
}

/// One edge of a loop, passed in its sense, with the joint at whose plane it ends.
pub(super) struct Passed {
    pub curve: EdgeCurve,
    pub forward: bool,
    /// Joint's plane at the end of the way.
    pub joint: Option<G1Element>,
}

/// Stretches of an edge and of the ring that belong together: parameters s and τ at both ends.
pub(super) struct Matched {
    pub edge: usize,
    pub s: [f64; 2],
    pub tau: [f64; 2],
}

/// A stretch of an edge: its number, parameters at both ends, length.
type Station = (usize, f64, f64, f64);

/// Places (τ) on a ring of the ends of stretches, the first at `origin` near a length along the ring, and how far the farthest
/// of them is from its place.
fn places(ring: &Ring, loop_: &[Passed], stations: &[Station], (origin, guess): (&Vec3, f64)) -> (Vec<f64>, f64) {
    let total: f64 = stations.iter().map(|s| s.3).sum();
    let scale = ring.length() / total;
    let first = ring.near(origin, guess, WINDOW[1] * ring.length());
    let mut off = (ring.point(first) - origin).norm();
    let mut taus = vec![first];
    let (mut way, mut last) = (guess, first);
    for (i, (k, _, s1, length)) in stations.iter().enumerate() {
        if i + 1 == stations.len() {
            taus.push(first + ring.turn());
            break;
        }
        way += length * scale;
        let e = &loop_[*k];
        let x = e.curve.point(*s1);
        let window = WINDOW[0] * length * scale + WINDOW[1] * ring.length();
        let mut tau = ring.near(&x, way, window);
        let at_end = stations[i + 1].0 != *k;
        if let Some(plane) = e.joint.as_ref().filter(|_| at_end) {
            tau = crossing_beside(tau, &|tau| before(plane, &ring.point(tau))).unwrap_or(tau);
        }
        last = tau.clamp(last, first + ring.turn());
        off = off.max((ring.point(last) - x).norm());
        taus.push(last);
    }
    (taus, off)
}

/// Pieces of a closed loop of edges beside a ring, each within one span of either; `None` where they do not run along
/// each other.
pub(super) fn matched(ring: &mut Ring, loop_: &[Passed]) -> Option<Vec<Matched>> {
    // 1. Stations: ends and knots of the edges.
    let mut stations: Vec<Station> = Vec::new();
    for (k, e) in loop_.iter().enumerate() {
        let mut breaks = e.curve.breaks();
        if !e.forward {
            breaks.reverse();
        }
        for w in breaks.windows(2) {
            /// Chords by which the length of a stretch is measured.
            const CHORDS: usize = 8;
            let at = |i: usize| e.curve.point(w[0] + (w[1] - w[0]) * i as f64 / CHORDS as f64);
            let length: f64 = (0..CHORDS).map(|i| (at(i + 1) - at(i)).norm()).sum();
            stations.push((k, w[0], w[1], length));
        }
    }
    // 2. Their places on the ring; one that passes the beginning twice, or back and forth along a seam, is tried from either
    // place and in either direction.
    let start = loop_.first()?;
    let origin = start.curve.point(if start.forward { 0.0 } else { 1.0 });
    let mut best: Option<(f64, bool, Vec<f64>)> = None;
    for reversed in [false, true] {
        if reversed {
            ring.reverse();
        }
        for guess in ring.all_nearest(&origin) {
            let (taus, off) = places(ring, loop_, &stations, (&origin, guess));
            if best.as_ref().is_none_or(|b| off < b.0) {
                best = Some((off, reversed, taus));
            }
        }
        if best.as_ref().is_some_and(|b| b.0 <= CLOSE * ring.length()) {
            break;
        }
        if reversed && best.as_ref().is_some_and(|b| !b.1) {
            ring.reverse();
        }
    }
    let taus = best?.2;
    // 3. Cut where spans end.
    let mut out = Vec::new();
    for ((k, s0, s1, _), t) in stations.iter().zip(taus.windows(2)) {
        let mut cuts: Vec<f64> = Vec::new();
        let mut tau = t[0];
        let mut next = t[0].floor() + 1.0;
        loop {
            let end = next.min(t[1]);
            cuts.extend(ring.crossings([tau, end]));
            if next >= t[1] {
                break;
            }
            cuts.push(next);
            (tau, next) = (next, next + 1.0);
        }
        let curve = &loop_[*k].curve;
        let (mut s, mut tau) = (*s0, t[0]);
        for cut in cuts {
            let x = ring.point(cut);
            let at = least(0.0, 1.0, |f| (curve.point(s + (s1 - s) * f) - x).norm_squared());
            let to = s + (s1 - s) * at;
            out.push(Matched { edge: *k, s: [s, to], tau: [tau, cut] });
            (s, tau) = (to, cut);
        }
        out.push(Matched { edge: *k, s: [s, *s1], tau: [tau, t[1]] });
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::crossing_beside;

    /// The plane of a joint cuts a rim that is one span in its middle and where it begins and ends.
    #[test]
    fn a_joint_is_looked_for_beside_its_place() {
        let rim = |t: f64| match t {
            t if t <= 0.0 => 1e-11,
            t if t >= 1.0 => -1e-11,
            0.5 => 1e-14,
            t => -(std::f64::consts::TAU * t).sin(),
        };
        let found = crossing_beside(0.5, &rim).expect("a crossing");
        assert!((found - 0.5).abs() < 1e-9, "{found}");
        // Farther away, where there is none beside.
        let found = crossing_beside(0.2, &|t| t - 0.5).expect("a crossing");
        assert!((found - 0.5).abs() < 1e-9, "{found}");
    }
}
