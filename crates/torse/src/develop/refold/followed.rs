//! Curves of artwork carried over as polylines.
//!
//! *Method*. A curve is looked at in small steps. Between two places that are on different parts, of which one is beyond an edge, or
//! whose images are torn apart, as on both sides of a slit, places are looked at again and again in the middle, until there the end of
//! a piece is found; so are places between which the image keeps farther from its chord than is asked for. Points that are not needed
//! are left out at last.
//! *Not guaranteed*: that what a curve does between two places is seen.

use super::artwork::{ArtworkMap, Off, PlacedShape, Side};
use crate::geom::segment::foot;
use crate::geom::Vec3;
use crate::num::parallel;
use crate::spline::curve::Curve;

/// Steps over a curve's extent, at most.
const STEPS: f64 = 400.0;
/// Steps over the size of the smallest part: short curves need fewer.
const PART_STEPS: f64 = 4000.0;
/// Steps on every piece of a curve at least, and at most.
const PER_PIECE: (usize, usize) = (2, 4000);
/// Halvings of a step with which the end of a piece on a part is found.
const HALVINGS: usize = 40;
/// How much farther apart than the places themselves their images may be: more is a slit between them.
const TORN: f64 = 2.0;
/// Share of the distance allowed from chords that places in the middle may use, and that points left out may use.
const CHORDS: (f64, f64) = (0.25, 0.5);
/// Share of a curve's extent within which its ends are one point.
const CLOSED: f64 = 1e-9;

/// A place of a curve that was looked at.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// Number of the piece and share of its domain.
    at: f64,
    point: Vec3,
    /// The part that it is on, and its place there.
    on: Option<(usize, Vec3)>,
    /// Whether it lies beyond the edge of the part.
    beyond: bool,
    /// Distance from the nearest part, mm.
    off: f64,
}

impl Seen {
    /// Where it is, as far as that ends pieces.
    fn state(&self) -> Option<(usize, bool)> {
        self.on.map(|(part, _)| (part, self.beyond))
    }

    /// How far apart (mm) the images of two places of one part are, and the places themselves.
    fn apart(&self, other: &Self) -> Option<(f64, f64)> {
        let ((p, a), (q, b)) = (self.on?, other.on?);
        (p == q).then(|| ((b - a).norm(), (other.point - self.point).norm()))
    }
}

/// A curve between its places, carried to one side.
struct Follower<'a> {
    map: &'a ArtworkMap,
    curves: &'a [Curve<4>],
    to: Side,
}

/// A stretch of a curve on one part.
struct CurveStretch {
    part: usize,
    seen: Vec<Seen>,
}

impl ArtworkMap {
    /// Curves that follow each other as polylines, one for every stretch on a part with the number of that, and what lies on no part.
    /// Ends of stretches are on the edge of the part as near as numbers tell.
    pub(super) fn followed(&self, curves: &[Curve<4>], to: Side) -> (Vec<(usize, PlacedShape)>, Option<Off>) {
        let follower = Follower { map: self, curves, to };
        let seen = follower.seen();
        let (Some(first), Some(last)) = (seen.first(), seen.last()) else { return (Vec::new(), None) };
        let size = seen.iter().map(|s| (s.point - first.point).norm()).fold(0.0, f64::max);
        let closed = (last.point - first.point).norm() <= CLOSED * size;
        let (mut runs, off) = follower.runs(&seen);
        let torn = |a: &Seen, b: &Seen| follower.is_torn(a, b);
        let whole = |r: &CurveStretch| r.seen.len() == seen.len() && !torn(&r.seen[0], &r.seen[seen.len() - 1]);
        let is_ring = closed && runs.len() == 1 && runs.first().is_some_and(whole);
        // A stretch over the place where a closed curve begins is one.
        if closed && runs.len() > 1 {
            let goes_on = |a: &CurveStretch, b: &CurveStretch| {
                let (Some(end), Some(begin)) = (a.seen.last(), b.seen.first()) else { return false };
                a.part == b.part && end.at == last.at && begin.at == first.at && !torn(end, begin)
            };
            let head = runs.remove(0);
            match runs.last_mut().filter(|tail| goes_on(tail, &head)) {
                Some(tail) => tail.seen.extend(head.seen.into_iter().skip(1)),
                None => runs.insert(0, head),
            }
        }
        // Beside slits and seams rounding and the chords of polylines lead to the other side for a moment.
        let alone = runs.len() == 1;
        runs.retain(|r| alone || extent(r) > self.chord);
        let off = off.filter(|off| off.length > self.chord || runs.is_empty());
        let lines = runs.into_iter().filter_map(|r| {
            let mut points = needed(&r.seen, CHORDS.1 * self.chord);
            if is_ring {
                points.pop();
            }
            let least = if is_ring { RING } else { 2 };
            (points.len() >= least).then_some((r.part, PlacedShape::Line { points, closed: is_ring }))
        });
        (lines.collect(), off)
    }
}

/// Greatest distance (mm) of places of a stretch from its first one.
fn extent(run: &CurveStretch) -> f64 {
    run.seen.iter().map(|s| (s.point - run.seen[0].point).norm()).fold(0.0, f64::max)
}

/// Points of a closed polyline at least.
const RING: usize = 3;

impl Follower<'_> {
    fn look(&self, at: f64) -> Seen {
        let point = point(self.curves, at);
        let found = self.map.nearest(&point, self.to);
        let on = found.filter(|f| f.off <= self.map.within).map(|f| (f.part, f.place));
        Seen { at, point, on, beyond: found.is_some_and(|f| f.beyond), off: found.map_or(f64::INFINITY, |f| f.off) }
    }

    /// The places looked at, in order.
    fn seen(&self) -> Vec<Seen> {
        let boxes = self.curves.iter().flat_map(|c| &c.control).map(|h| Vec3::new(h[0], h[1], h[2]) / h[3]);
        let extent = crate::geom::BBox::of(&boxes.collect::<Vec<_>>()).diagonal();
        let least = self.map.parts.iter().map(|p| p.bounds.diagonal()).fold(f64::INFINITY, f64::min);
        let step = (extent / STEPS).max(least / PART_STEPS);
        let mut at: Vec<f64> = Vec::new();
        for (k, c) in self.curves.iter().enumerate() {
            let of = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
            let length: f64 = c.control.windows(2).map(|w| (of(&w[1]) - of(&w[0])).norm()).sum();
            let n = ((length / step).ceil() as usize).clamp(PER_PIECE.0, PER_PIECE.1);
            at.extend((0..n).map(|i| k as f64 + i as f64 / n as f64));
        }
        at.push(self.curves.len() as f64);
        let first: Vec<Seen> = parallel::map(at.iter(), |s| self.look(*s));
        let between = |w: &[Seen]| {
            let mut out = vec![w[0]];
            self.halve(&w[0], &w[1], HALVINGS, &mut out);
            out
        };
        let mut out: Vec<Seen> = parallel::map(first.windows(2), between).into_iter().flatten().collect();
        out.extend(first.last());
        out
    }

    /// Looks at the middle between two places and at what is needed on both sides of it.
    fn halve(&self, a: &Seen, b: &Seen, halvings: usize, out: &mut Vec<Seen>) {
        let alike = a.state() == b.state();
        if halvings == 0 || alike && a.on.is_none() {
            return;
        }
        let middle = self.look(0.5 * (a.at + b.at));
        if alike && middle.state() == a.state() && !self.is_torn(a, b) && self.is_straight([a, &middle, b]) {
            return;
        }
        self.halve(a, &middle, halvings - 1, out);
        out.push(middle);
        self.halve(&middle, b, halvings - 1, out);
    }

    /// Whether the image of the middle is near the chord between those of the others.
    fn is_straight(&self, seen: [&Seen; 3]) -> bool {
        let [Some(a), Some(m), Some(b)] = seen.map(|s| s.on.map(|on| on.1)) else { return true };
        beside(&m, [&a, &b]) <= CHORDS.0 * self.map.chord
    }

    /// Whether images of two places of one part lie on both sides of a slit.
    fn is_torn(&self, a: &Seen, b: &Seen) -> bool {
        a.apart(b).is_some_and(|(there, here)| there > TORN * here + self.map.chord)
    }

    /// Stretches on parts without what lies beyond edges where they leave these, and what lies on no part.
    fn runs(&self, seen: &[Seen]) -> (Vec<CurveStretch>, Option<Off>) {
        let mut runs: Vec<CurveStretch> = Vec::new();
        // Whether a stretch begins and ends where another one goes on.
        let mut meets: Vec<[bool; 2]> = Vec::new();
        let mut off = Off { length: 0.0, farthest: 0.0 };
        for (k, s) in seen.iter().enumerate() {
            let before = k.checked_sub(1).map(|k| &seen[k]);
            let Some((part, _)) = s.on else {
                let way = before.filter(|b| b.on.is_none()).map_or(0.0, |b| (s.point - b.point).norm());
                off = Off { length: off.length + way, farthest: off.farthest.max(s.off) };
                continue;
            };
            let goes_on = before.is_some_and(|b| b.on.is_some_and(|on| on.0 == part) && !self.is_torn(b, s));
            match runs.last_mut().filter(|_| goes_on) {
                Some(run) => run.seen.push(*s),
                None => {
                    let met = before.is_some_and(|b| b.on.is_some());
                    if let Some(last) = meets.last_mut().filter(|_| met) {
                        last[1] = true;
                    }
                    meets.push([met, false]);
                    runs.push(CurveStretch { part, seen: vec![*s] });
                }
            }
        }
        for (run, meets) in runs.iter_mut().zip(meets) {
            let Some(first) = run.seen.iter().position(|s| !s.beyond) else { continue };
            let last = run.seen.iter().rposition(|s| !s.beyond).unwrap_or(first);
            for (cut, met) in [&run.seen[..=first], &run.seen[last..]].into_iter().zip(meets) {
                if !met {
                    let length: f64 = cut.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
                    let farthest = cut.iter().filter(|s| s.beyond).map(|s| s.off).fold(off.farthest, f64::max);
                    off = Off { length: off.length + length, farthest };
                }
            }
            run.seen = run.seen[first..=last].to_vec();
        }
        (runs, (off.farthest > 0.0).then_some(off))
    }
}

/// The images of the places that are needed: ends, corners between pieces of the curve, and of what is between these none that lies
/// within `off` (mm) of the chord between those kept.
fn needed(seen: &[Seen], off: f64) -> Vec<Vec3> {
    let places: Vec<Vec3> = seen.iter().filter_map(|s| s.on.map(|on| on.1)).collect();
    let mut keep: Vec<bool> = seen.iter().map(|s| s.at.fract() == 0.0).collect();
    if let ([first, ..], true) = (&mut keep[..], !places.is_empty()) {
        *first = true;
    }
    if let Some(last) = keep.last_mut() {
        *last = true;
    }
    let kept: Vec<usize> = (0..places.len()).filter(|k| keep[*k]).collect();
    let mut open: Vec<(usize, usize)> = kept.windows(2).map(|w| (w[0], w[1])).collect();
    while let Some((i, j)) = open.pop() {
        let from = |k: usize| beside(&places[k], [&places[i], &places[j]]);
        let Some(k) = (i + 1..j).max_by(|x, y| from(*x).total_cmp(&from(*y))) else { continue };
        if from(k) > off {
            keep[k] = true;
            open.extend([(i, k), (k, j)]);
        }
    }
    places.into_iter().zip(keep).filter(|p| p.1).map(|p| p.0).collect()
}

/// Distance of a point from a segment.
fn beside(x: &Vec3, [a, b]: [&Vec3; 2]) -> f64 {
    (foot(a, b, x) - x).norm()
}

/// The point of curves that follow each other at the number of one and the share of its domain.
fn point(curves: &[Curve<4>], s: f64) -> Vec3 {
    let k = (s.floor() as usize).min(curves.len() - 1);
    let c = &curves[k];
    let (a, b) = c.knots.domain();
    crate::torse::rail::jet(c, a + (b - a) * (s - k as f64).clamp(0.0, 1.0))[0]
}
