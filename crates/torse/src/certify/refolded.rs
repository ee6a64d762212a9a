//! A part bent back from its drawing against its panel in space, both ways and with its edges.
//!
//! *Theorem.* Let a strip of rulings be laid in the plane, `F(s, v)`, and in space, `X(s, v)`, and let `T` be what closed lines
//! of its parameters enclose, simple, disjoint, and each other's holes. Where [`distance`] answers a bound `D`: F is regular on T and maps these lines within D of the
//! outline as drawn, and `X(T)` and the panel within its border are within D of each other, in both directions.
//!
//! *Proof.* Φ takes places of the strip to parameters of the panel's patch S. It is linear from ruling to ruling and quadratic along
//! them, so it is continuous, and its Jacobian, linear from ruling to ruling too, has one sign along all rulings and therefore everywhere:
//! it does not fold. 1. `|X − S∘Φ| ≤ δ`: on
//! a cell the difference is within `(|D_ss| + |D_vv|)/8` of the bilinear function through its corners, whose norm is
//! greatest in a corner; where a knot line of S is less than C¹, along the span within a quarter of what its first derivatives range
//! over, or, if only a share of the cell is beyond it, within that share of the range, twice, and the eighth. `X` moves
//! evenly, so that `X_ss = A (ω × V)` in the frame A that turns by `|ω|` at most \[DC76\];
//! derivatives of S are enclosed over boxes \[MKC09\]. Cells cover what T has of a span: over an interval of it T lies between ways that
//! pieces of γ have there, since these bound it along every ruling. 2. The lines Φ∘γ and the panel's border are joined by
//! segments of the parameter plane, whose images are no longer than β. A place of the panel off these segments is enclosed by
//! Φ∘γ as often as by the border: it is Φ of a place of T. A place `y` of T whose Φ(y) is off them is, because Φ does not
//! fold, enclosed by the border too. Everything on the segments is within β of both edges. 3. In the plane the same is asked of
//! F∘γ and the outline as drawn: ε, which is a distance in space too, because the strip keeps lengths. 4. What is off the segments is
//! within the δ of its span, what is on that of one place of γ within the δ, β and ε of the piece that holds it: D is the greatest δ,
//! or the greatest sum of the three of one piece, and what rounding leaves between spans.
//!
//! How lines, places and borders are matched does not matter for the proof: any numbers will do, near ones make D small.

mod judged_panel;
#[cfg(test)]
mod tests;

pub(crate) use judged_panel::JudgedPanel;

use super::claim::UpperBound;
use super::simple::polygons_are_simple;
use super::tensor::{about, Jet2, Tensor};
use super::vector::{add, length_bound, scale, sub, V3};
use crate::control::Control;
use crate::geom::{Vec2, Vec3};
use crate::num::interval::Interval;
use crate::num::parallel;
use crate::torse::ribbon::pose::Pose;
use crate::torse::ribbon::Span;
use rayon::prelude::*;
use std::collections::HashMap;

/// Parameters of the patch along a ruling: `at + slope v + bend v²` at the way v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Along {
    /// Parameters at the frame's own point.
    pub at: [f64; 2],
    /// Their change per mm.
    pub slope: [f64; 2],
    /// Half the change of that per mm: where rulings of the patch lie across this one, it is straight in space and not in parameters.
    pub bend: [f64; 2],
}

impl Along {
    /// The parameters at a way.
    pub fn place(&self, v: f64) -> [f64; 2] {
        [0, 1].map(|d: usize| self.at[d] + (self.slope[d] + self.bend[d] * v) * v)
    }
}

/// A piece of a closed line, straight in the parameters of one span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SpanChord {
    /// The span.
    pub span: usize,
    /// First and last place: share of the span and way along the ruling, mm.
    pub ends: [[f64; 2]; 2],
    /// Places on the panel's border that belong to these: number of a corner and share of the way to the next; goes on
    /// beyond the number of corners.
    pub border: [f64; 2],
    /// The segment drawn for it; `None` where the part goes on, on the next panel.
    pub drawn: Option<[Vec2; 2]>,
}

/// A strip of rulings and the panel that belongs to it.
#[derive(Clone, Debug)]
pub(crate) struct Stretch<'a> {
    /// The rulings, where the part is in space.
    pub spans: &'a [Span],
    /// Where the rulings are on the patch, one more than spans.
    pub places: Vec<Along>,
    /// Closed lines with the number of the border that belongs to each.
    pub lines: Vec<(usize, Vec<SpanChord>)>,
    /// The panel, by whose parameters places are told.
    pub panel: &'a JudgedPanel<'a>,
    /// Distance (mm) of what pieces are drawn for from the lines and arcs of the file, by the closed form of arcs.
    pub chords: f64,
}

/// Why no bound was shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unshown {
    /// Lines with gaps, or that do not run once around each border.
    #[error("its outline could not be followed along the border of its panel")]
    Lines,
    /// Rulings that cross.
    #[error("its rulings cross in the part, or fold over on the panel")]
    Folds,
    /// Nothing finite.
    #[error("its panel has no bounded derivatives")]
    Unbounded,
    /// The job was asked to stop.
    #[error("the job was stopped before it was done")]
    Stopped,
}

/// Share of the size that rounding may move what plain arithmetic computes here from spans: a thousand times what some
/// fifty operations on doubles do.
const ROUNDING: f64 = 1e-12;
/// Cells across a span along its rulings.
const CELLS: usize = 4;
/// Parts of the rulings of a span over which the sign of the Jacobian is enclosed.
const BANDS: usize = 16;
/// Parts of a span in both directions, at most; of an outline's pieces the square of it.
const FINEST: usize = 16;
/// Share of a bound below which another one is worth more parts.
const GAIN: f64 = 0.95;
/// Places on a border that are one, in corners.
const ONE_PLACE: f64 = 1e-6;

/// Bound (mm) of the distance between a stretch bent back and its panel; the same whatever the number of threads.
pub(crate) fn distance(stretch: &Stretch, control: &Control) -> Result<UpperBound, Unshown> {
    let judge = Judge::new(stretch)?;
    judge.check_lines()?;
    let mut bent = judge.spans(control)?;
    // Bounds over parts: pieces on both sides of a span ask for the same ones.
    let mut known: HashMap<(usize, usize), f64> = HashMap::new();
    let mut in_parts = |k: usize, n: usize| *known.entry((k, n)).or_insert_with(|| judge.span(k, n));
    let mut worst = 0.0_f64;
    for k in falling(&bent) {
        if GAIN * bent[k] <= worst {
            break;
        }
        going(control)?;
        bent[k] = refined(bent[k], worst, &mut |n| in_parts(k, n));
        worst = bent[k].max(worst);
    }
    worst = bent.iter().copied().fold(worst, worse);
    let pieces: Vec<(usize, &SpanChord)> =
        stretch.lines.iter().flat_map(|(b, l)| l.iter().map(move |p| (*b, p))).collect();
    let of = |(border, piece): (usize, &SpanChord), bent: f64, n: usize| {
        sum(&[bent, judge.to_border(piece, &stretch.panel.borders()[border], n * n), judge.to_drawing(piece)])
    };
    let mut whole: Vec<f64> = parallel::map(pieces.iter(), |p| of(*p, bent[p.1.span], 1));
    for k in falling(&whole) {
        let (here, span) = (pieces[k], pieces[k].1.span);
        if GAIN * whole[k] <= worst {
            break;
        }
        going(control)?;
        whole[k] = refined(whole[k], worst, &mut |n| of(here, in_parts(span, n).min(bent[span]), n));
        worst = whole[k].max(worst);
    }
    worst = whole.iter().copied().fold(worst, worse);
    let bound = UpperBound::shown(sum(&[worst, judge.gap, stretch.chords, stretch.panel.off().value()]));
    // Any infinite or undefined term shows nothing.
    if bound.value().is_finite() {
        Ok(bound)
    } else {
        Err(Unshown::Unbounded)
    }
}

/// Whether the job goes on.
fn going(control: &Control) -> Result<(), Unshown> {
    if control.stopped() {
        Err(Unshown::Stopped)
    } else {
        Ok(())
    }
}

/// The sum of bounds, rounded up.
fn sum(terms: &[f64]) -> f64 {
    terms.iter().copied().map(Interval::point).fold(Interval::ZERO, |s, x| s + x).hi
}

/// Indices of numbers, the greatest first.
fn falling(of: &[f64]) -> Vec<usize> {
    let mut out: Vec<usize> = (0..of.len()).collect();
    out.sort_by(|a, b| of[*b].total_cmp(&of[*a]));
    out
}

/// A bound over ever more parts, while that gains something and more than `enough`: the greatest is asked for, and what is below it
/// need not be known better.
fn refined(coarse: f64, enough: f64, over: &mut dyn FnMut(usize) -> f64) -> f64 {
    let (mut best, mut parts) = (coarse, 2);
    while best > enough && parts <= FINEST {
        let next = over(parts);
        let gains = next < GAIN * best;
        best = best.min(next);
        if !gains {
            break;
        }
        parts *= 2;
    }
    best
}

struct Judge<'a> {
    asked: &'a Stretch<'a>,
    tensor: Tensor<'a, 4>,
    origin: Vec3,
    /// Ways along the rulings that lines reach on every span.
    reach: Vec<Option<[f64; 2]>>,
    /// First and last places of the pieces on every span.
    sides: Vec<Vec<[[f64; 2]; 2]>>,
    /// What coordinates are rounded to, mm.
    rough: f64,
    /// Greatest step from span to span, mm.
    gap: f64,
}

impl<'a> Judge<'a> {
    fn new(asked: &'a Stretch<'a>) -> Result<Self, Unshown> {
        let n = asked.spans.len();
        if n == 0 || asked.places.len() != n + 1 {
            return Err(Unshown::Lines);
        }
        let mut reach: Vec<Option<[f64; 2]>> = vec![None; n];
        let mut sides = vec![Vec::new(); n];
        for piece in asked.lines.iter().flat_map(|l| &l.1) {
            let ways = piece.ends.map(|e| e[1]);
            let slot = reach.get_mut(piece.span).ok_or(Unshown::Lines)?;
            let old = slot.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            *slot = Some([old[0].min(ways[0]).min(ways[1]), old[1].max(ways[0]).max(ways[1])]);
            sides[piece.span].push(piece.ends);
        }
        let far = |s: &Span| s.space.at.amax().max(s.flat.at.amax()) + s.in_space.along.hypot(s.in_space.across);
        let ways = reach.iter().flatten().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        let patch = asked.panel.surface().control.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        let rough = ROUNDING * (asked.spans.iter().map(far).fold(0.0, f64::max) + ways + patch);
        let origin = asked.spans[n / 2].space.at;
        let surface = asked.panel.surface();
        let control = about(&surface.control, [origin.x, origin.y, origin.z]);
        let tensor = Tensor::new([&surface.knots_u, &surface.knots_v], control);
        let mut out = Self { asked, tensor, origin, reach, sides, rough, gap: 0.0 };
        out.gap = out.gaps();
        Ok(out)
    }

    /// Greatest distance between the last ruling of a span and the first one of the next, in the plane and in space.
    fn gaps(&self) -> f64 {
        let apart = |a: &Pose, b: &Pose, v: f64| (a.point(v, 0.0) - b.point(v, 0.0)).norm();
        let mut out = 0.0_f64;
        for (k, w) in self.asked.spans.windows(2).enumerate() {
            let (flat, space) = (w[0].flat.moved(&w[0].in_plane, 1.0), w[0].space.moved(&w[0].in_space, 1.0));
            // Segments are farthest apart at their ends.
            for v in [self.reach[k], self.reach[k + 1]].into_iter().flatten().flatten() {
                out = out.max(apart(&flat, &w[1].flat, v)).max(apart(&space, &w[1].space, v));
            }
        }
        out + 2.0 * self.rough
    }

    /// Lines are closed, and run once around the border that belongs to each.
    fn check_lines(&self) -> Result<(), Unshown> {
        let mut used = vec![false; self.asked.panel.borders().len()];
        let mut sense = None;
        for (border, line) in &self.asked.lines {
            let fresh = used.get_mut(*border).filter(|u| !**u).ok_or(Unshown::Lines)?;
            *fresh = true;
            let corners = self.asked.panel.borders()[*border].len() as f64;
            let (Some(first), Some(last)) = (line.first(), line.last()) else { return Err(Unshown::Lines) };
            let around = (last.border[1] - first.border[0]).abs();
            let follows = |a: &SpanChord, b: &SpanChord, turn: f64| {
                let ([_, [s, v]], [[t, w], _]) = (a.ends, b.ends);
                let same = a.span == b.span && s == t
                    || a.span + 1 == b.span && s == 1.0 && t == 0.0
                    || b.span + 1 == a.span && t == 1.0 && s == 0.0;
                same && v == w && (a.border[1] - b.border[0] - turn).abs() <= ONE_PLACE
            };
            let turn = last.border[1] - first.border[0];
            let closed = line.windows(2).all(|w| follows(&w[0], &w[1], 0.0)) && follows(last, first, turn);
            let inside = |p: &SpanChord| p.ends.iter().all(|e| (0.0..=1.0).contains(&e[0]));
            // All lines run with their borders, or all against them.
            let alike = *sense.get_or_insert(turn > 0.0) == (turn > 0.0);
            if !closed || !alike || (around - corners).abs() > ONE_PLACE || !line.iter().all(inside) {
                return Err(Unshown::Lines);
            }
        }
        let mut lines: Vec<&(usize, Vec<SpanChord>)> = self.asked.lines.iter().collect();
        lines.sort_by_key(|l| l.0);
        let corner = |p: &SpanChord| [p.span as f64 + p.ends[0][0], p.ends[0][1]];
        let polygons: Vec<Vec<[f64; 2]>> = lines.iter().map(|l| l.1.iter().map(corner).collect()).collect();
        if used.iter().all(|u| *u) && polygons_are_simple(&polygons).is_ok() {
            Ok(())
        } else {
            Err(Unshown::Lines)
        }
    }

    /// The parameters along the ruling at a share of a span.
    fn ruling(&self, k: usize, share: f64) -> RulingParameters {
        let [p, q] = [&self.asked.places[k], &self.asked.places[k + 1]];
        let (s, rest) = (Interval::point(share), Interval::ONE - Interval::point(share));
        let of = |a: f64, b: f64| Interval::point(a) * rest + Interval::point(b) * s;
        RulingParameters {
            at: [0, 1].map(|d: usize| of(p.at[d], q.at[d])),
            slope: [0, 1].map(|d: usize| of(p.slope[d], q.slope[d])),
            bend: [0, 1].map(|d: usize| of(p.bend[d], q.bend[d])),
        }
    }

    /// Derivative of the parameters over a span, at a way: what is the same at both ends is taken off before the way comes in,
    /// else an interval of ways would count twice.
    fn along_span(&self, k: usize, v: Interval) -> [Interval; 2] {
        let [p, q] = [&self.asked.places[k], &self.asked.places[k + 1]];
        let less = |a: f64, b: f64| Interval::point(b) - Interval::point(a);
        [0, 1].map(|d: usize| {
            less(p.at[d], q.at[d]) + (less(p.slope[d], q.slope[d]) + less(p.bend[d], q.bend[d]) * v) * v
        })
    }

    /// Sign of the Jacobian of Φ on a span; `None` where it has none, or the rulings cross in the plane.
    fn orientation(&self, k: usize, reach: [f64; 2]) -> Option<i32> {
        let rates = &self.asked.spans[k].in_plane;
        let speed = |v: f64| Interval::point(rates.across) + Interval::point(v) * Interval::point(rates.spin);
        if reach.iter().any(|v| speed(*v).sign() <= 0) {
            return None;
        }
        // Where parameters are linear along both rulings so is the Jacobian, and both ends tell of what lies between.
        let places = &self.asked.places[k..=k + 1];
        let ways: Vec<Interval> = if places.iter().all(|p| p.bend == [0.0; 2]) {
            reach.map(Interval::point).to_vec()
        } else {
            let way = |i: usize| {
                if i == BANDS {
                    reach[1]
                } else {
                    reach[0] + (reach[1] - reach[0]) * i as f64 / BANDS as f64
                }
            };
            (0..BANDS).map(|i| Interval::new(way(i), way(i + 1))).collect()
        };
        let mut sign = None;
        for v in ways {
            let [us, rs] = self.along_span(k, v);
            for end in places {
                let slope = [0, 1].map(|d: usize| {
                    Interval::point(end.slope[d]) + (Interval::point(end.bend[d]) * v).scale_exact(2.0)
                });
                let here = (us * slope[1] - rs * slope[0]).sign();
                if here == 0 || sign.is_some_and(|s| s != here) {
                    return None;
                }
                sign = Some(here);
            }
        }
        sign
    }

    /// Bounds of `|X − S∘Φ|` on all spans, none in parts; 0 where a span holds nothing of the part.
    fn spans(&self, control: &Control) -> Result<Vec<f64>, Unshown> {
        let of = |(k, reach): (usize, &Option<[f64; 2]>)| -> Result<(i32, f64), Unshown> {
            let Some(reach) = *reach else { return Ok((0, 0.0)) };
            going(control)?;
            Ok((self.orientation(k, reach).ok_or(Unshown::Folds)?, self.span(k, 1)))
        };
        let all: Vec<(i32, f64)> =
            parallel::map(self.reach.iter().enumerate(), of).into_iter().collect::<Result<_, _>>()?;
        let mut signs = all.iter().map(|s| s.0).filter(|s| *s != 0);
        let first = signs.next();
        if signs.any(|s| Some(s) != first) {
            return Err(Unshown::Folds);
        }
        Ok(all.into_iter().map(|s| s.1).collect())
    }

    /// Ways along the rulings that lines reach over shares of a span, and the part with them, whose ends lie on lines; `None` where
    /// there is nothing of it.
    fn column(&self, k: usize, [from, to]: [f64; 2]) -> Option<[f64; 2]> {
        let mut out: Option<[f64; 2]> = None;
        for [[s, v], [t, w]] in &self.sides[k] {
            let [low, high] = [s.min(*t).max(from), s.max(*t).min(to)];
            if low > high {
                continue;
            }
            let at = |x: f64| if x == *t { *w } else { v + (w - v) * ((x - s) / (t - s)) };
            let ways = if s == t { [*v, *w] } else { [at(low), at(high)] };
            for way in ways {
                let [lo, hi] = out.unwrap_or([way, way]);
                out = Some([lo.min(way), hi.max(way)]);
            }
        }
        out.map(|[lo, hi]| [lo - self.rough, hi + self.rough])
    }

    /// Bound of `|X − S∘Φ|` on what a span holds of the part, in so many parts of it and times as many along its rulings: beyond the
    /// part nothing is asked, and patches may go anywhere.
    fn span(&self, k: usize, parts: usize) -> f64 {
        let count = CELLS * parts;
        let share = |j: usize| j as f64 / parts as f64;
        let between = |j: usize| {
            let shares = [share(j), share(j + 1)];
            let Some([lo, hi]) = self.column(k, shares) else { return 0.0 };
            let way = |i: usize| if i == count { hi } else { lo + (hi - lo) * i as f64 / count as f64 };
            let corner = |i: usize| worse(self.corner(k, shares[0], way(i)), self.corner(k, shares[1], way(i)));
            let corners: Vec<f64> = (0..=count).map(corner).collect();
            let cell = |i: usize| sum(&[worse(corners[i], corners[i + 1]), self.cell(k, shares, [way(i), way(i + 1)])]);
            (0..count).map(cell).fold(0.0, worse)
        };
        parallel::map(0..parts, between).into_iter().fold(0.0, worse)
    }

    /// Bound of the distance on a cell from the bilinear function through its corners.
    fn cell(&self, k: usize, shares: [f64; 2], ways: [f64; 2]) -> f64 {
        let v = Interval::new(ways[0], ways[1]);
        let ends = shares.map(|s| self.ruling(k, s));
        let [a, b] = [0, 1].map(|e: usize| ends[e].place(v));
        let box_ = [a[0].hull(b[0]), a[1].hull(b[1])];
        let jet = self.tensor.affine_over(box_);
        let bends = sub(&self.turning(k, v), &second(&jet, self.along_span(k, v)));
        let slopes = ends.each_ref().map(|r| r.slope_at(v));
        let [long, wide] = [shares, ways].map(|[from, to]| Interval::point(to) - Interval::point(from));
        let smooth = (Interval::point(length_bound(&bends)) * long.sqr()).scale_exact(0.125);
        if !self.tensor.creased(box_) {
            let slopes = [0, 1].map(|d: usize| slopes[0][d].hull(slopes[1][d]));
            let bend = [0, 1].map(|d: usize| ends[0].bend[d].hull(ends[1].bend[d]));
            let rest = length_bound(&scale(&along_ruling(&jet, slopes, bend), wide.sqr()));
            return (smooth + Interval::point(rest).scale_exact(0.125)).hi;
        }
        // A function is within a quarter of what its derivative ranges over of its chord.
        let first = {
            let along = self.along_span(k, v);
            add(&scale(&jet.du, along[0]), &scale(&jet.dv, along[1]))
        };
        let range = Interval::point(length_bound(&first.map(|x| Interval::point(x.width()))));
        let along = range + Interval::point(length_bound(&self.turning(k, v)));
        let across = Interval::point(worse(self.across(&ends[0], a, v), self.across(&ends[1], b, v)));
        let quarter = ((along * long).scale_exact(0.25) + across).hi;
        // Where all but a share of the span is beside the crease, the rest is off by no more than its share of that, and moves the
        // chord by as much.
        let speed = self.along_span(k, v)[0].mig();
        let less = self.tensor.beside_crease(box_).filter(|_| speed > 0.0).map(|beyond| {
            let share = Interval::point(beyond) / Interval::point(speed);
            (smooth + (share * along).scale_exact(2.0) + across).hi
        });
        less.map_or(quarter, |l| l.min(quarter))
    }

    /// Bound of the distance of the patch from its chord along a ruling, over the box of its places and these ways: an eighth of
    /// the second derivative, or a quarter of what the first ranges over where the ruling crosses a crease.
    fn across(&self, ruling: &RulingParameters, box_: [Interval; 2], v: Interval) -> f64 {
        let jet = self.tensor.affine_over(box_);
        let (slope, wide) = (ruling.slope_at(v), Interval::point(v.hi) - Interval::point(v.lo));
        let bound = if self.tensor.creased(box_) {
            let first = add(&scale(&jet.du, slope[0]), &scale(&jet.dv, slope[1]));
            (Interval::point(length_bound(&first.map(|x| Interval::point(x.width())))) * wide).scale_exact(0.25)
        } else {
            Interval::point(length_bound(&scale(&along_ruling(&jet, slope, ruling.bend), wide.sqr())))
                .scale_exact(0.125)
        };
        bound.hi
    }

    /// `X_ss` over a span for ways along its rulings.
    fn turning(&self, k: usize, v: Interval) -> V3<Interval> {
        let s = &self.asked.spans[k];
        let [turn, spin, along, across] =
            [s.in_space.turn, s.in_space.spin, s.in_space.along, s.in_space.across].map(Interval::point);
        let speed = across + v * spin;
        // ω = (turn, 0, spin) and V = (along, speed, 0) in the frame itself.
        let own = [-(spin * speed), spin * along, turn * speed];
        let axes = s.space.moved(&s.in_space, 0.5).axes;
        let spread = (turn.sqr() + spin.sqr()).sqrt().scale_exact(0.5) * Interval::point(length_bound(&own));
        [0, 1, 2].map(|d: usize| {
            let row = [0, 1, 2].map(|e: usize| Interval::point(axes[(d, e)]) * own[e]);
            (row[0] + row[1] + row[2]).widen(spread.hi + self.rough)
        })
    }

    /// Bound of the distance at a place of a span.
    fn corner(&self, k: usize, share: f64, v: f64) -> f64 {
        let s = &self.asked.spans[k];
        let pose = if share == 0.0 { s.space } else { s.space.moved(&s.in_space, share) };
        let x = pose.point(v, 0.0) - self.origin;
        let on = self.tensor.point_at(self.phi(k, [share, v]));
        let x = [x.x, x.y, x.z].map(|c| Interval::point(c).widen(self.rough));
        length_bound(&sub(&x, &on))
    }

    /// Φ at a place of a span.
    fn phi(&self, k: usize, [s, v]: [f64; 2]) -> [Interval; 2] {
        self.ruling(k, s).place(Interval::point(v))
    }

    /// Bound of the images of the segments between a piece and its stretch of the border, in so many parts between corners.
    fn to_border(&self, piece: &SpanChord, border: &[[f64; 2]], parts: usize) -> f64 {
        let [from, to] = piece.border;
        let n = border.len() as i64;
        let on_border = |x: f64| {
            let k = x.floor();
            let share = Interval::point(x - k);
            let (a, b) = (&border[(k as i64).rem_euclid(n) as usize], &border[(k as i64 + 1).rem_euclid(n) as usize]);
            [0, 1].map(|d| Interval::point(a[d]) * (Interval::ONE - share) + Interval::point(b[d]) * share)
        };
        let [p, q] = piece.ends;
        let on_line = |share: f64| {
            let at = [0, 1].map(|d: usize| if share == 1.0 { q[d] } else { p[d] + (q[d] - p[d]) * share });
            self.phi(piece.span, at)
        };
        // The line is a cubic: beside its chord by an eighth of its second derivative.
        let places = &self.asked.places[piece.span..=piece.span + 1];
        let ways = Interval::point(p[1]).hull(Interval::point(q[1]));
        let change = [0, 1].map(|d: usize| {
            let less = |a: f64, b: f64| Interval::point(b) - Interval::point(a);
            let [ds, dv] = [0, 1].map(|e: usize| Interval::point(q[e]) - Interval::point(p[e]));
            let bend = Interval::point(places[0].bend[d]).hull(Interval::point(places[1].bend[d]));
            let turn = less(places[0].bend[d], places[1].bend[d]) * ways;
            let mixed = (less(places[0].slope[d], places[1].slope[d]) + turn.scale_exact(2.0)) * ds * dv;
            (mixed + bend * dv.sqr()).scale_exact(0.25)
        });
        // Shares of the piece and places on the border: where this turns, and both ends.
        let share = |x: f64| if to == from { 1.0 } else { (x - from) / (to - from) };
        let mut stations = vec![(0.0, from)];
        let mut inner: Vec<f64> =
            (from.min(to).floor() as i64 + 1..).map(|k| k as f64).take_while(|x| *x < from.max(to)).collect();
        if to < from {
            inner.reverse();
        }
        stations.extend(inner.into_iter().map(|x| (share(x), x)));
        stations.push((1.0, to));
        let mut out = 0.0;
        for w in stations.windows(2) {
            let [(s, x), (t, y)] = [w[0], w[1]];
            let between = |a: f64, b: f64, k: usize| if k == parts { b } else { a + (b - a) * k as f64 / parts as f64 };
            let at = |k: usize| (on_line(between(s, t, k)), on_border(between(x, y, k)));
            let part = (Interval::point(t) - Interval::point(s)) / Interval::point(parts as f64);
            let beside = change.map(|c| (c * part.sqr()).mag());
            let longest = |k: usize| {
                let ends = [at(k), at(k + 1)];
                let hull = |of: &dyn Fn(&Both) -> Interval| of(&ends[0]).hull(of(&ends[1]));
                let box_ = [0, 1].map(|d: usize| hull(&|e| e.0[d].hull(e.1[d])).widen(beside[d]));
                let off = [0, 1].map(|d: usize| hull(&|e| e.0[d] - e.1[d]).widen(beside[d]));
                let jet = self.tensor.affine_over(box_);
                length_bound(&add(&scale(&jet.du, off[0]), &scale(&jet.dv, off[1])))
            };
            out = worse(out, (0..parts).into_par_iter().with_min_len(FINEST).map(longest).reduce(|| 0.0, worse));
        }
        out
    }

    /// Bound of the distance between a piece laid in the plane and what is drawn for it.
    fn to_drawing(&self, piece: &SpanChord) -> f64 {
        let Some(drawn) = piece.drawn else { return 0.0 };
        let s = &self.asked.spans[piece.span];
        let off = |k: usize| {
            let [share, v] = piece.ends[k];
            (s.flat.moved(&s.in_plane, share).point(v, 0.0).xy() - drawn[k]).norm()
        };
        let [[s0, v0], [s1, v1]] = piece.ends;
        let (ds, dv, spin) = ((s1 - s0).abs(), (v1 - v0).abs(), s.in_plane.spin.abs());
        let speed = s.in_plane.along.hypot(s.in_plane.across) + v0.abs().max(v1.abs()) * spin;
        let beside = 0.125 * (ds * ds * spin * speed + 2.0 * ds * dv * spin);
        off(0).max(off(1)) + beside * (1.0 + ROUNDING) + self.rough
    }
}

/// A place of a line and the one of the border that belongs to it.
type Both = ([Interval; 2], [Interval; 2]);

/// Parameters of the patch along a ruling, enclosed.
struct RulingParameters {
    at: [Interval; 2],
    slope: [Interval; 2],
    bend: [Interval; 2],
}

impl RulingParameters {
    /// The parameters at a way.
    fn place(&self, v: Interval) -> [Interval; 2] {
        [0, 1].map(|d| self.at[d] + (self.slope[d] + self.bend[d] * v) * v)
    }

    /// Their change per mm there.
    fn slope_at(&self, v: Interval) -> [Interval; 2] {
        [0, 1].map(|d| self.slope[d] + (self.bend[d] * v).scale_exact(2.0))
    }
}

/// Second derivative of the patch along a ruling, per mm: in the direction of its parameters, and as this turns.
fn along_ruling(jet: &Jet2<3>, slope: [Interval; 2], bend: [Interval; 2]) -> V3<Interval> {
    let turn = add(&scale(&jet.du, bend[0].scale_exact(2.0)), &scale(&jet.dv, bend[1].scale_exact(2.0)));
    add(&second(jet, slope), &turn)
}

/// Second derivative of the patch along a direction of its parameters.
fn second(jet: &Jet2<3>, [u, v]: [Interval; 2]) -> V3<Interval> {
    let mixed = (u * v).scale_exact(2.0);
    add(&add(&scale(&jet.duu, u.sqr()), &scale(&jet.duv, mixed)), &scale(&jet.dvv, v.sqr()))
}

/// The greater of both; what is no number is worst.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || a.is_nan() {
        f64::INFINITY
    } else {
        a.max(b)
    }
}
