//! How two pieces meet along a common line: the gap between their sides, and the angle between their tangent planes.
//!
//! *Method.* On every stretch both sides are polynomials over one parameter. Along a side with direction e, let i point into
//! the piece; `n = e × i` is normal to it. Both pieces go on smoothly where n₁ and −n₂ have one direction, and the angle
//! between these is that of the joint. With Bernstein coefficients \[FR88\] of `n₁ × n₂` and `−n₁·n₂` in interval arithmetic it
//! is bounded stretch by stretch; stretches are halved until the bound is little above what is seen \[MKC09\].
//! *Guaranteed*: at equal parameters the sides are no farther apart than the gap, and the tangent planes at no larger angle
//! than the bound, rounding included. *Not guaranteed*: anything about rational sides, and about sides over different knots.

use super::claim::UpperBound;
use super::vector::{length, length_bound};
use crate::geom::Vec3;
use crate::num::bernstein::{self, derivative, difference, product, sum};
use crate::num::interval::Interval;
use crate::torse::strip::Strip;
use std::f64::consts::PI;

/// A side of a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Side<'a> {
    /// The rail `v = 0` or `v = 1`.
    Rail(&'a Strip, usize),
    /// The first ruling.
    First(&'a Strip),
    /// The last ruling.
    Last(&'a Strip),
}

/// How two pieces meet.
#[derive(Clone, Debug)]
pub(crate) struct Joint {
    /// Distance of both sides at equal parameters, mm.
    pub gap: UpperBound,
    /// Angle between the tangent planes, rad: 0 where the pieces go on smoothly.
    pub angle: UpperBound,
    /// Places along the line with the angle there, rad, measured.
    pub seen: Vec<(Vec3, f64)>,
}

type Poly = Vec<Interval>;

/// A stretch of a side: the line and the normal of the piece along it, as polynomials over [0, 1].
#[derive(Clone)]
struct Stretch {
    range: (f64, f64),
    line: [Poly; 3],
    normal: [Poly; 3],
}

/// The bound may exceed what is seen by this share of it.
const EXCESS: f64 = 0.02;
/// An angle (rad) that is none: bounds below it need not be sharp.
const NO_ANGLE: f64 = 1e-9;
/// Halvings of a stretch at most.
const DEPTH: usize = 12;
/// Places looked at on every stretch.
const PLACES: usize = 12;
/// What the arc tangent of the system may be off, as a share: four units in the last place.
const ARC: f64 = 4.0 * f64::EPSILON;

/// How two pieces meet; where the second side runs the other way, `reversed`.
pub(crate) fn joint(a: &Side, b: &Side, reversed: bool) -> Joint {
    let (first, mut second) = (stretches(a), stretches(b));
    if reversed {
        second = second.map(turned);
    }
    let unknown = Joint { gap: UpperBound::UNKNOWN, angle: UpperBound::UNKNOWN, seen: Vec::new() };
    let (Some(first), Some(second)) = (first, second) else { return unknown };
    let mut out = unknown;
    let same = first.len() == second.len() && first.iter().zip(&second).all(|(p, q)| p.range == q.range);
    if !same {
        return out;
    }
    let (mut gap, mut worst) = (0.0f64, 0.0f64);
    for (p, q) in first.iter().zip(&second) {
        let apart = [0, 1, 2].map(|d: usize| difference(&p.line[d], &q.line[d]));
        gap = gap.max((0..apart[0].len()).map(|i| length_bound(&[0, 1, 2].map(|d| apart[d][i]))).fold(0.0, f64::max));
        let (mut here, from) = (0.0f64, out.seen.len());
        for k in 0..=PLACES {
            let x = k as f64 / PLACES as f64;
            let at = |c: &[Poly; 3]| Vec3::from([0, 1, 2].map(|d: usize| value(&c[d], x)));
            let (n, m) = (at(&p.normal), -at(&q.normal));
            let angle = n.cross(&m).norm().atan2(n.dot(&m));
            // Places where a side stands still have no plane; stretches begin where others end.
            if angle.is_finite() && n.norm() > 0.0 && m.norm() > 0.0 && (k > 0 || from == 0) {
                out.seen.push((at(&p.line), angle));
                here = here.max(angle);
            }
        }
        worst = worst.max(bound(&p.normal, &q.normal, here, 0));
    }
    (out.gap, out.angle) = (UpperBound::shown(gap), UpperBound::shown(worst));
    out
}

/// Value of a polynomial by the middles of its coefficients.
fn value(c: &Poly, x: f64) -> f64 {
    bernstein::value(&c.iter().map(|i| i.mid()).collect::<Vec<f64>>(), x)
}

/// Bound of the angle between n and −m over a stretch on which `seen` was seen.
fn bound(n: &[Poly; 3], m: &[Poly; 3], seen: f64, depth: usize) -> f64 {
    let cross = cross(n, m);
    let dot = (0..3).map(|d| product(&n[d], &m[d])).reduce(|a, b| sum(&a, &b)).unwrap_or_default();
    let dot = -bernstein::hull(&dot);
    let sine = (0..cross[0].len()).map(|i| length(&[0, 1, 2].map(|d: usize| cross[d][i])).hi).fold(0.0, f64::max);
    let here = angle(Interval { lo: least(&cross), hi: sine }, dot);
    if here <= seen * (1.0 + EXCESS) + NO_ANGLE || depth == DEPTH {
        return here;
    }
    let halves = |c: &[Poly; 3]| {
        let [x, y, z] = [0, 1, 2].map(|d: usize| bernstein::halves(&c[d]));
        ([x.0, y.0, z.0], [x.1, y.1, z.1])
    };
    let ((n0, n1), (m0, m1)) = (halves(n), halves(m));
    bound(&n0, &m0, seen, depth + 1).max(bound(&n1, &m1, seen, depth + 1))
}

/// The largest angle whose sine and cosine are in these ranges, both times one positive factor.
pub(super) fn angle(sine: Interval, cosine: Interval) -> f64 {
    if cosine.lo > 0.0 {
        let tangent = (Interval::point(sine.hi) / Interval::point(cosine.lo)).hi;
        return (tangent.atan() * (1.0 + ARC)).next_up();
    }
    let half_turn = PI.next_up();
    if sine.lo > 0.0 && cosine.lo.is_finite() {
        // The sharper the tangent of what is left of half a turn, the less is known.
        let left = (Interval::point(sine.lo) / Interval::point(-cosine.lo)).lo;
        return (half_turn - (left.atan() * (1.0 - ARC)).next_down()).next_up();
    }
    half_turn
}

/// Lower bound of the length of a vector polynomial: the least projection of its coefficients on their sum.
fn least(c: &[Poly; 3]) -> f64 {
    let middles = [0, 1, 2].map(|d: usize| c[d].iter().map(|i| i.mid()).sum::<f64>());
    let Some(axis) = Vec3::from(middles).try_normalize(0.0) else { return 0.0 };
    // The axis has unit length up to rounding, which the last factor pays for.
    let along = |i: usize| {
        (0..3).map(|d| c[d][i] * Interval::point(axis[d])).fold(Interval::ZERO, |s, x| s + x).lo * (1.0 - ARC)
    };
    (0..c[0].len()).map(along).fold(f64::INFINITY, f64::min).max(0.0)
}

fn cross(a: &[Poly; 3], b: &[Poly; 3]) -> [Poly; 3] {
    let of = |i: usize, j: usize| difference(&product(&a[i], &b[j]), &product(&a[j], &b[i]));
    [of(1, 2), of(2, 0), of(0, 1)]
}

/// The same side run through the other way.
fn turned(stretches: Vec<Stretch>) -> Vec<Stretch> {
    let last = stretches.last().map_or(0.0, |s| s.range.1) + stretches.first().map_or(0.0, |s| s.range.0);
    let back = |s: Stretch| {
        let flip = |c: Poly, sign: f64| c.into_iter().rev().map(|x| x * sign).collect::<Poly>();
        Stretch {
            range: (last - s.range.1, last - s.range.0),
            line: s.line.map(|c| flip(c, 1.0)),
            normal: s.normal.map(|c| flip(c, -1.0)),
        }
    };
    stretches.into_iter().rev().map(back).collect()
}

/// Stretches of a side; `None` for rational pieces.
fn stretches(side: &Side) -> Option<Vec<Stretch>> {
    match side {
        Side::Rail(strip, k) => {
            let spans = spans(strip)?;
            Some(spans.into_iter().map(|(range, ends)| along_rail(range, &ends, *k)).collect())
        }
        Side::First(strip) => spans(strip)?.first().map(|(_, ends)| vec![along_ruling(ends, true)]),
        Side::Last(strip) => spans(strip)?.last().map(|(_, ends)| vec![along_ruling(ends, false)]),
    }
}

/// Both rails over every span as Bernstein polynomials.
type Span = ((f64, f64), [[Poly; 3]; 2]);

fn spans(strip: &Strip) -> Option<Vec<Span>> {
    let patch = &strip.patch;
    let ruled = patch.knots_v.degree() == 1 && patch.row() == 2;
    if !ruled || patch.control.iter().any(|c| c[3].to_bits() != 1f64.to_bits()) {
        return None;
    }
    let knots = &patch.knots_u;
    let p = knots.degree();
    let of = |w: &[f64]| {
        let span = knots.span(0.5 * (w[0] + w[1]));
        let local = &knots.values()[span + 1 - p..=span + p];
        let ends = [0, 1].map(|end: usize| {
            [0, 1, 2].map(|d: usize| {
                let net: Poly = (span - p..=span).map(|i| Interval::point(patch.control[2 * i + end][d])).collect();
                bernstein::from_spline_over(&net, local, w[0], w[1])
            })
        });
        ((w[0], w[1]), ends)
    };
    Some(knots.breaks().windows(2).map(of).collect())
}

fn along_rail(range: (f64, f64), ends: &[[Poly; 3]; 2], k: usize) -> Stretch {
    let line = ends[k].clone();
    let along = [0, 1, 2].map(|d: usize| derivative(&line[d]));
    let inward = [0, 1, 2].map(|d: usize| difference(&ends[1 - k][d], &ends[k][d]));
    Stretch { range, normal: cross(&along, &inward), line }
}

fn along_ruling(ends: &[[Poly; 3]; 2], first: bool) -> Stretch {
    let leg = |c: &Poly| match (first, c.len()) {
        (_, 0 | 1) => Interval::ZERO,
        (true, _) => c[1] - c[0],
        (false, n) => c[n - 2] - c[n - 1],
    };
    let end = |c: &Poly| if first { c[0] } else { c[c.len() - 1] };
    let line = [0, 1, 2].map(|d: usize| vec![end(&ends[0][d]), end(&ends[1][d])]);
    let along = [0, 1, 2].map(|d: usize| vec![line[d][1] - line[d][0]]);
    // At an end that stands still the normal vanishes, and elsewhere it is that of the other end.
    let still = |side: usize| {
        let same = |c: &Poly| c.windows(2).all(|w| w[0].mid().to_bits() == w[1].mid().to_bits());
        ends[side].iter().all(same)
    };
    let of = [if still(0) { 1 } else { 0 }, if still(1) { 0 } else { 1 }];
    let inward = [0, 1, 2].map(|d: usize| of.map(|side: usize| leg(&ends[side][d])).to_vec());
    Stretch { range: (0.0, 1.0), normal: cross(&along, &inward), line }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::specimens::strip;
    use crate::torse::form::PanelKind;

    /// Half a roof at a slope (rad) beside the ridge `y = 0`, on the side of negative or positive y.
    fn roof(side: f64, slope: f64) -> Strip {
        let ridge = [[0.0, 0.0, 0.0], [50.0, 0.0, 8.0], [100.0, 0.0, 0.0]];
        let low = ridge.map(|p| [p[0], side * 40.0 * slope.cos(), p[2] - 40.0 * slope.sin()]);
        strip(&ridge, &low)
    }

    #[test]
    fn a_roof_has_the_angle_of_its_halves() {
        for slope in [0.0, 0.2, 0.7, 1.3] {
            let (left, right) = (roof(-1.0, slope), roof(1.0, slope));
            let found = joint(&Side::Rail(&left, 0), &Side::Rail(&right, 0), false);
            // At the top of the ridge both halves are inclined by the slope.
            let top = found.seen.iter().min_by(|a, b| (a.0.x - 50.0).abs().total_cmp(&(b.0.x - 50.0).abs()));
            assert!((top.expect("a place").1 - 2.0 * slope).abs() < 1e-12, "{slope}");
            let most = found.seen.iter().map(|s| s.1).fold(0.0, f64::max);
            assert!(found.angle.value() >= most && found.angle.value() <= 1.03 * most + 1e-8, "{slope} {found:?}");
            assert!(found.gap.value() < 1e-11);
        }
        // Folded upon itself.
        let found = joint(&Side::Rail(&roof(1.0, 0.3), 0), &Side::Rail(&roof(1.0, 0.3), 0), false);
        assert!(found.angle.value() >= PI && found.angle.value() < 3.15);
    }

    #[test]
    fn rulings_of_pieces_that_go_on_are_smooth_and_gaps_are_seen() {
        // A skew strip cut in two: tangent planes turn along the common ruling, and agree.
        let whole = |from: f64, to: f64| {
            let a = |x: f64| [x, 0.0, 0.01 * x * x];
            let b = |x: f64| [x, 50.0, 10.0 - 0.02 * x * x];
            // Quadratic pieces through the ends with the middle control point that keeps the parabola.
            let piece = |f: &dyn Fn(f64) -> [f64; 3], c: f64, y: f64, z: f64| {
                let m = [0.5 * (from + to), y, z + c * from * to];
                [f(from), m, f(to)]
            };
            strip(&piece(&a, 0.01, 0.0, 0.0), &piece(&b, -0.02, 50.0, 10.0))
        };
        let (first, second) = (whole(0.0, 40.0), whole(40.0, 90.0));
        let found = joint(&Side::Last(&first), &Side::First(&second), false);
        assert!(found.angle.value() < 1e-8 && found.gap.value() < 1e-12, "{found:?}");
        let moved = second.clone().moved(&Vec3::new(0.0, 0.0, 0.25));
        let found = joint(&Side::Last(&first), &Side::First(&moved), false);
        assert!((found.gap.value() - 0.25).abs() < 1e-9);
        // A triangle at the last ruling of a plane strip, seen from the other end.
        let plane = strip(&[[0.0; 3], [10.0, 0.0, 0.0]], &[[0.0, 5.0, 0.0], [10.0, 5.0, 0.0]]);
        let triangle = |z: f64| {
            let tip = Vec3::new(14.0, 2.0, z);
            let corners = [Vec3::new(10.0, 5.0, 0.0), Vec3::new(10.0, 0.0, 0.0)];
            let of = |first, last| Strip::quad("t", PanelKind::Plane, first, last).expect("a triangle");
            [of([corners[0], tip], [corners[1], tip]), of([corners[0], corners[1]], [tip, tip])]
        };
        for (k, t) in triangle(0.0).iter().enumerate() {
            let side = if k == 0 { Side::Rail(t, 0) } else { Side::First(t) };
            let found = joint(&Side::Last(&plane), &side, true);
            assert!(found.angle.value() < 1e-8 && found.gap.value() < 1e-11, "{found:?}");
        }
        // With its tip as an end of the side.
        let [first, _] = triangle(3.0);
        let other = Strip::quad("o", PanelKind::Plane, first.ruling(0.0), [Vec3::new(8.0, 7.0, 1.0); 2]).expect("one");
        let found = joint(&Side::First(&first), &Side::First(&other), false);
        assert!(found.angle.value() < 3.15 && found.seen.iter().all(|s| s.1 > 0.1), "{found:?}");
        let spread = found.seen.iter().map(|s| s.1).fold(0.0, f64::max);
        assert!(found.angle.value() <= 1.03 * spread, "{found:?}");
        let bent = joint(&Side::Last(&plane), &Side::Rail(&triangle(4.0)[0], 0), true);
        assert!((bent.angle.value() - PI / 4.0).abs() < 1e-6 && bent.gap.value() < 1e-11, "{bent:?}");
    }

    #[test]
    fn rational_sides_and_other_knots_are_unknown() {
        let mut rational = roof(1.0, 0.2);
        rational.patch.control[2][3] = 0.7;
        let plain = roof(-1.0, 0.2);
        assert_eq!(joint(&Side::Rail(&rational, 0), &Side::Rail(&plain, 0), false).angle, UpperBound::UNKNOWN);
        let [a, b] = [0, 1].map(|k| plain.rail(k).with_knots(&[0.5]).expect("a curve"));
        let other = Strip::between("o", PanelKind::Torse, &a, &b).expect("a strip");
        assert_eq!(joint(&Side::Rail(&other, 0), &Side::Rail(&plain, 0), false).gap, UpperBound::UNKNOWN);
    }
}
