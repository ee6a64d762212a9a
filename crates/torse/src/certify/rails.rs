//! Proven distances between the rails of a strip and the rails that were asked for, and proven twist.
//!
//! *Method.* On every piece, the strip's rail R(u) and the given rail at its parameter, H(σ(u)), are polynomials in
//! homogeneous coordinates; `R.xyz H.w − H.xyz R.w` divided by the least weights bounds the distance. All coefficients
//! are Bernstein coefficients \[FR88\] in interval arithmetic with outward rounding, relative to a point nearby.

use super::claim::UpperBound;
use super::developable::developability_until;
use super::ruled::Ruled;
use super::vector::length_bound;
use crate::control::Control;
use crate::geom::Vec3;
use crate::num::bernstein::{self, from_spline_over, hull, product};
use crate::num::interval::Interval;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::torse::rail::{Rail, RailPart};
use crate::torse::strip::Strip;

/// Halvings of a stretch of the parameter until it is known where a knot of the rail is met.
const HALVINGS: usize = 60;
/// Parameters by which the map may pass a knot, rounding of [`HALVINGS`]; it is paid for.
const PAST: f64 = 1e-9;
/// Parts into which an arc is cut between its knots: control points are then near it.
const ARC_PARTS: usize = 4;
/// Stretches of the parameter that are no more than rounding.
const NOTHING: f64 = 1e-13;

/// Bound on the distance (mm) between a strip's rail and the part of the given rail that it stands for, point by
/// point; both are run through from end to end, so it bounds the distance in both directions. Unknown if the parts do
/// not belong together (a piece that does not exist, weights that are not positive), or the control says stop.
///
/// *Guarantee*: the bound holds at every parameter, rounding included.
pub(crate) fn rail_bound(strip: &Strip, side: usize, rail: &Rail, part: &RailPart, control: &Control) -> UpperBound {
    enclosed((strip, side), rail, part, control).map_or(UpperBound::UNKNOWN, UpperBound::shown)
}

fn enclosed((strip, side): (&Strip, usize), rail: &Rail, part: &RailPart, control: &Control) -> Option<f64> {
    let given = rail.pieces.get(part.piece)?;
    let patch = Ruled::new(&strip.patch)?;
    let map = &part.parameter;
    // The strip's spans, those of the parameter, and where the parameter meets a knot of the rail.
    let mut breaks = patch.breaks();
    let (first, last) = (*breaks.first()?, *breaks.last()?);
    breaks.extend(map.knots.breaks().into_iter().filter(|t| *t > first && *t < last));
    let sigma = |u: f64| map.point(u)[0];
    let spans = given.knots.breaks();
    let (from, to) = (sigma(first), sigma(last));
    for t in spans.iter().copied().filter(|t| from < *t && *t < to) {
        if control.stopped() {
            return None;
        }
        let (mut lo, mut hi) = (first, last);
        for _ in 0..HALVINGS {
            let m = 0.5 * (lo + hi);
            if sigma(m) < t {
                lo = m;
            } else {
                hi = m;
            }
        }
        breaks.push(0.5 * (lo + hi));
    }
    breaks.sort_by(f64::total_cmp);
    let mut worst = 0.0_f64;
    let mut a = first;
    for &b in breaks.iter().filter(|b| **b > first) {
        if b - a <= NOTHING * (last - first) && b < last {
            continue;
        }
        if control.stopped() {
            return None;
        }
        worst = worst.max(piece_bound((&patch, side), (given, &spans), map, a, b)?);
        a = b;
    }
    worst.is_finite().then_some(worst)
}

/// Bound on the distance (mm) of every point of an arc of a curve from the first or the last ruling of a strip: what is
/// left off where the strip is cut before a tip. The arc runs from one parameter to a greater one, on closed curves also beyond the domain. Unknown for
/// arcs of more than one turn, or where weights are not positive.
///
/// *Method*: distances from a segment are convex, so that those of control points \[FR88\] of short parts bound it.
pub(crate) fn tip_bound(strip: &Strip, at_end: bool, rail: &Rail, arc: [f64; 2]) -> UpperBound {
    let control = &strip.patch.control;
    let first = if at_end { control.len().saturating_sub(2) } else { 0 };
    let [Some(p), Some(q)] = [control.get(first), control.get(first + 1)] else { return UpperBound::UNKNOWN };
    if strip.patch.row() != 2 || p[3] <= 0.0 || q[3] <= 0.0 {
        return UpperBound::UNKNOWN;
    }
    let affine = |c: &[f64; 4]| [0, 1, 2].map(|d: usize| Interval::point(c[d]) / Interval::point(c[3]));
    // The ruling of numbers is off the true one by rounding.
    let ends = [affine(p), affine(q)];
    let about = ends.map(|e| Vec3::from(e.map(Interval::mid)));
    let off = (0..2)
        .map(|k| length_bound(&[0, 1, 2].map(|d: usize| ends[k][d] - Interval::point(about[k][d]))))
        .fold(0.0, f64::max);
    arc_bound(rail, arc, about).plus(UpperBound::shown(off))
}

/// Bound on the distance of every point of an arc from a segment.
fn arc_bound(rail: &Rail, [from, to]: [f64; 2], segment: [Vec3; 2]) -> UpperBound {
    let n = rail.pieces.len();
    let (from, to) = (from - PAST, to + PAST);
    let whole = 0..n as i64;
    let inside = rail.closed || (from >= -2.0 * PAST && to <= n as f64 + 2.0 * PAST);
    if !(inside && from < to && to - from < n as f64) {
        return UpperBound::UNKNOWN;
    }
    let mut worst = 0.0_f64;
    for turn in (from.floor() as i64..=to.floor() as i64).filter(|k| rail.closed || whole.contains(k)) {
        let piece = &rail.pieces[turn.rem_euclid(n as i64) as usize];
        let (a, b) = ((from - turn as f64 - PAST).max(0.0), (to - turn as f64 + PAST).min(1.0));
        for w in piece.knots.breaks().windows(2) {
            let (a, b): (f64, f64) = (a.max(w[0]), b.min(w[1]));
            if a < b {
                match arc_part(piece, (a, b), segment) {
                    Some(off) => worst = worst.max(off),
                    None => return UpperBound::UNKNOWN,
                }
            }
        }
    }
    UpperBound::shown(worst)
}

/// Of an arc without knots, in short parts.
fn arc_part(piece: &Curve<4>, (a, b): (f64, f64), [p, q]: [Vec3; 2]) -> Option<f64> {
    let mut worst = 0.0_f64;
    for k in 0..ARC_PARTS {
        let cut = |k: usize| if k == ARC_PARTS { b } else { a + (b - a) * k as f64 / ARC_PARTS as f64 };
        let net = [0, 1, 2, 3].map(|d: usize| {
            let value = |i: usize| {
                let c = &piece.control[i];
                match d {
                    3 => Interval::point(c[3]),
                    _ => Interval::less_product(c[d], c[3], p[d]),
                }
            };
            over(&piece.knots, value, cut(k), cut(k + 1))
        });
        for i in 0..net[3].len() {
            if net[3][i].lo <= 0.0 {
                return None;
            }
            let place = [0, 1, 2].map(|d: usize| net[d][i] / net[3][i]);
            // Any point of the segment will do.
            let about = Vec3::from(place.map(Interval::mid));
            let along = q - p;
            let share = (about.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            let share = Interval::point(if share.is_nan() { 0.0 } else { share });
            let foot = [0, 1, 2].map(|d: usize| (Interval::point(q[d]) - Interval::point(p[d])) * share);
            worst = worst.max(length_bound(&[0, 1, 2].map(|d: usize| place[d] - foot[d])));
        }
    }
    worst.is_finite().then_some(worst)
}

/// One stretch without knots inside: of a side of a patch, against a curve with its breaks.
fn piece_bound(
    (patch, side): (&Ruled, usize),
    (given, breaks): (&Curve<4>, &[f64]),
    map: &Curve<1>,
    a: f64,
    b: f64,
) -> Option<f64> {
    let middle = 0.5 * (a + b);
    let origin = patch.middle(middle);
    let r = patch.end(side, a, b, &origin);
    let sigma = over(&map.knots, |i| Interval::point(map.control[i][0]), a, b);
    // The rail over the span in which the parameter lies.
    let at = map.point(middle)[0];
    let k = breaks[1..breaks.len() - 1].partition_point(|t| *t <= at);
    let (t0, t1) = (breaks[k], breaks[k + 1]);
    let h = [0, 1, 2, 3].map(|d: usize| {
        let value = |i: usize| {
            let c = &given.control[i];
            match d {
                3 => Interval::point(c[3]),
                _ => Interval::less_product(c[d], c[3], origin[d]),
            }
        };
        over(&given.knots, value, t0, t1)
    });
    let width = Interval::point(t1) - Interval::point(t0);
    let local: Vec<Interval> = sigma.iter().map(|s| (*s - Interval::point(t0)) / width).collect();
    let (lo, hi) = (hull(&local).lo, hull(&local).hi);
    let past = (-lo).max(hi - 1.0).max(0.0);
    if past > PAST {
        return None;
    }
    let composed = h.clone().map(|c| compose(&c, &local));
    let (rw, hw) = (hull(&r[3]), hull(&composed[3]));
    if rw.lo <= 0.0 || hw.lo <= 0.0 {
        return None;
    }
    let difference: [Vec<Interval>; 3] =
        [0, 1, 2].map(|d: usize| bernstein::difference(&product(&r[d], &composed[3]), &product(&composed[d], &r[3])));
    let top =
        (0..difference[0].len()).map(|i| length_bound(&[0, 1, 2].map(|d: usize| difference[d][i]))).fold(0.0, f64::max);
    let quotient = (Interval::point(top) / (Interval::point(rw.lo) * Interval::point(hw.lo))).hi;
    // Beyond a knot the polynomial is continued where the rail has the next one: both leave the knot with at most the
    // speed of a control polygon. Twice for either, doubled for the weights.
    let speed = (0..h[0].len()).map(|i| length_bound(&[0, 1, 2].map(|d: usize| h[d][i]))).fold(0.0, f64::max)
        * given.knots.degree() as f64
        / hw.lo;
    Some((quotient + 8.0 * past * speed) * (1.0 + f64::EPSILON * 8.0))
}

/// Bernstein coefficients over `[a, b]` inside one span.
fn over(knots: &Knots, value: impl Fn(usize) -> Interval, a: f64, b: f64) -> Vec<Interval> {
    let p = knots.degree();
    let span = knots.span(0.5 * (a + b));
    let net: Vec<Interval> = (span - p..=span).map(value).collect();
    from_spline_over(&net, &knots.values()[span + 1 - p..=span + p], a, b)
}

/// The polynomial with coefficients `c` at the polynomial `x`: de Casteljau's algorithm with polynomials.
fn compose(c: &[Interval], x: &[Interval]) -> Vec<Interval> {
    let rest: Vec<Interval> = x.iter().map(|x| Interval::ONE - *x).collect();
    let mut level: Vec<Vec<Interval>> = c.iter().map(|c| vec![*c]).collect();
    while level.len() > 1 {
        level = level.windows(2).map(|w| bernstein::sum(&product(&rest, &w[0]), &product(x, &w[1]))).collect();
    }
    level.pop().unwrap_or_default()
}

/// What is proven about the rulings of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TwistBound {
    /// Bound (rad) of the angle between the tangent planes at both ends of any ruling.
    angle: UpperBound,
    /// Whether no ruling meets the regression curve between the rails. False too where nothing could be shown.
    regular: bool,
}

impl TwistBound {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { angle: UpperBound::UNKNOWN, regular: false };

    /// Bound (rad) of the angle between the tangent planes at both ends of any ruling.
    pub fn angle(&self) -> UpperBound {
        self.angle
    }

    /// Whether no ruling meets the regression curve between the rails. False too where nothing could be shown.
    pub fn is_regular(&self) -> bool {
        self.regular
    }
}

/// Proven bound of the twist of a strip; parts are halved until it is below `limit` (rad) or cannot be shown to be.
/// Unknown where rulings may meet the regression curve, and where the control says stop.
///
/// Fans (a rail that is a point) are cones: their twist is 0, and their apex is where their rail rests.
pub fn twist_bound(strip: &Strip, limit: f64, control: &Control) -> TwistBound {
    if strip.is_point(0) || strip.is_point(1) {
        return TwistBound { angle: UpperBound::shown(0.0), regular: true };
    }
    let all = [[Interval::EVERYTHING, Interval::new(0.0, 1.0)]];
    let shown = Ruled::new(&strip.patch).and_then(|patch| developability_until(&patch, &all, limit, control));
    match shown.filter(|shown| shown.regular) {
        Some(shown) => TwistBound { angle: UpperBound::shown(shown.angle), regular: true },
        None => TwistBound::UNKNOWN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::curve::Curve;
    use crate::torse::form::PanelKind;

    #[test]
    fn arcs_are_as_high_over_their_chords_as_circles_are_and_no_higher_than_bounded() {
        let at = |k: u32| f64::from(k % 60) * std::f64::consts::TAU / 60.0;
        let points: Vec<Vec3> = (0..=60).map(at).map(|t| Vec3::new(t.cos(), t.sin(), 0.0) * 100.0).collect();
        let rail = Rail::through("circle", &points).expect("rail");
        // Across the seam, too.
        for arc in [[0.2, 0.23], [-0.02, 0.015], [0.985, 1.02]] {
            let ends = arc.map(|s: f64| rail.point(s.rem_euclid(1.0)));
            let height = 100.0 * (1.0 - (std::f64::consts::PI * (arc[1] - arc[0])).cos());
            let bound = arc_bound(&rail, arc, ends).value();
            assert!(bound >= height * (1.0 - 1e-4) && bound <= height * 1.1, "{arc:?}: {bound} {height}");
            let moved = ends.map(|p| p + Vec3::z());
            assert!(arc_bound(&rail, arc, moved).value() >= 1.0);
        }
        // An open curve has nothing beyond its end.
        let open = Rail::through("half", &points[..=30]).expect("rail");
        let ends = [0.97, 1.0].map(|s| open.point(s));
        assert!(arc_bound(&open, [0.97, 1.0], ends).value() < 1.0);
        assert_eq!(arc_bound(&open, [0.97, 1.01], ends), UpperBound::UNKNOWN);
        for arc in [[0.3, 0.2], [0.2, 1.3], [0.2, f64::NAN]] {
            assert_eq!(arc_bound(&rail, arc, [Vec3::zeros(); 2]), UpperBound::UNKNOWN);
        }
    }

    #[test]
    fn the_bound_exceeds_every_sample_and_sees_what_is_moved() {
        let rail = Rail::through(
            "r",
            &(0..9).map(|k| f64::from(k) * 0.4).map(|t| Vec3::new(10.0 * t, t.sin(), t.cos())).collect::<Vec<_>>(),
        )
        .expect("rail");
        let sigma = Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![[0.0], [0.6], [1.0]]).expect("σ");
        // The given rail at σ(u), sampled and joined by a polygon: near, but not on it.
        let n = 200;
        let at = |u: f64| rail.point(sigma.point(u)[0]);
        let control: Vec<[f64; 3]> = (0..=n).map(|k| at(f64::from(k) / f64::from(n)).into()).collect();
        let mut knots = vec![0.0];
        knots.extend((0..=n).map(|k| f64::from(k) / f64::from(n)));
        knots.push(1.0);
        let a = Curve::<3>::new(1, knots, control).expect("polygon");
        let far = Curve::<3>::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![[0.0, 50.0, 0.0], [32.0, 50.0, 0.0]]).expect("far");
        let strip = Strip::polynomial("s", PanelKind::Torse, &a, &far).expect("strip");
        // Knots of the rail between breaks of the polygon would spoil the pieces: the spline has its own breaks.
        let part = RailPart { piece: 0, parameter: sigma.clone() };
        let sampled =
            (0..=1000).map(|k| f64::from(k) / 1000.0).map(|u| (strip.ruling(u)[0] - at(u)).norm()).fold(0.0, f64::max);
        let bound = rail_bound(&strip, 0, &rail, &part, &Control::default()).value();
        assert!(sampled > 0.0 && bound >= sampled && bound < 0.05, "{sampled} {bound}");
        assert_eq!(
            rail_bound(&strip, 0, &rail, &RailPart { piece: 4, parameter: sigma }, &Control::default()),
            UpperBound::UNKNOWN
        );
    }
}
