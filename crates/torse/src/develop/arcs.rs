//! Plane curves as chains of lines and circular arcs: adaptive biarcs, tangent-continuous inside a curve.
//!
//! *Method*: biarcs with equal tangent lengths between points of the curve, with its tangents there; the longest
//! stretch that meets the tolerance is taken next (bisection) \[MW95\]. Equal tangent lengths keep both arcs short.

use crate::geom::rectangle::{smallest_rectangle, Rectangle};
use crate::geom::Vec2;
use crate::patchwork::pattern::{Contour, ContourVertex};

/// A line or arc of a chain; it ends where the next begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ArcPiece {
    /// Start.
    pub point: Vec2,
    /// tan(sweep/4), positive counter-clockwise, 0 for a line.
    pub bulge: f64,
    /// Parameter of the curve at the start (of the whole biarc, for its second arc half way).
    pub s: f64,
}

/// A curve with its derivative, on [0, 1].
pub(crate) trait PlaneCurve {
    /// Point at `s`.
    fn place(&self, s: f64) -> Vec2;
    /// Derivative at `s`.
    fn velocity(&self, s: f64) -> Vec2;
}

/// Samples per biarc while searching, and when the error is measured for the record.
const SEARCH: usize = 16;
const MEASURE: usize = 48;
/// Measured errors are enlarged by this factor for what may happen between samples: with 48 of them, a smooth error
/// is missed by less than 1 %.
const SAFETY: f64 = 1.02;
/// Part of the tolerance used while searching, since fewer samples are taken.
const SEARCH_SHARE: f64 = 0.93;
/// Deviation from a line, as a share of the tolerance, below which a stretch is called straight: tangents then agree
/// to far less than any cutter resolves.
const STRAIGHT: f64 = 1e-3;
/// The same for a whole curve between two corners.
const NEARLY_STRAIGHT: f64 = 0.5;
/// Largest angle (rad) between tangent and chord of an arc.
const STEEPEST: f64 = 1.0;
/// Least tolerance, as a share of the curve's extent: finer ones would follow rounding, with arcs without end.
const FINEST: f64 = 1e-10;
/// Most that arcs may stray, as a share of the curve's extent: what is small beside the tolerance, as the border about a cone's tip,
/// has arcs of its own shape, and the proof can follow them.
const OWN_SHAPE: f64 = 1.0 / 16.0;
/// Shortest stretch of the parameter that is still halved.
const SHORTEST: f64 = 1e-6;
/// Difference of the angles (rad) between a chord and the tangents at its ends up to which one arc is tried: what it
/// strays is measured all the same.
const ONE_ARC: f64 = 1e-7;
/// `2 (1 − cos)` of the angle between end tangents, about its square, below which they are parallel: the difference
/// has no more than four digits then.
const PARALLEL: f64 = 1e-12;
/// Share of a stretch over which a secant stands for its end tangent.
const SECANT: f64 = 1e-4;
/// A curve rests where its speed is below this share of that secant's.
const RESTS: f64 = 1e-3;
/// Arcs of a smaller bulge are lines: they leave their chord by half of this share of its length.
const NO_BULGE: f64 = 1e-9;

/// Lines and arcs within `tolerance` of a curve, or a sixteenth of its extent if that is less, and the largest distance measured
/// (mm, with a safety factor).
///
/// *Guarantee*: first and last point are those of the curve; tangents agree at inner joints to rounding. Tolerances
/// below 1e-10 of the curve's extent are taken for that: the error returned is what was reached.
/// *Not guaranteed*: the tolerance itself where the curve has a kink inside; the error returned is honest then.
pub(crate) fn arcs(curve: &impl PlaneCurve, tolerance: f64) -> (Vec<ArcPiece>, f64) {
    let start = curve.place(0.0);
    let extent = (1..=SEARCH).map(|k| (curve.place(k as f64 / SEARCH as f64) - start).norm()).fold(0.0, f64::max);
    let tolerance = tolerance.max(FINEST * extent);
    // A curve that is straight as a whole is a line: its ends are corners, so no joint gets a kink.
    let line = vec![ArcPiece { point: curve.place(0.0), bulge: 0.0, s: 0.0 }];
    let off = distance(curve, &line, 0.0, 1.0, MEASURE);
    if SAFETY * off <= NEARLY_STRAIGHT * tolerance {
        return (line, SAFETY * off);
    }
    let tolerance = tolerance.min(OWN_SHAPE * extent);
    let mut out = Vec::new();
    let mut error = 0.0_f64;
    let mut s = 0.0;
    let mut stride = 1.0_f64;
    while s < 1.0 {
        let rest = 1.0 - s;
        let mut good: Option<(f64, Vec<ArcPiece>)> = None;
        // Bracket from the last stride, then bisect.
        let (mut lo, mut hi) = (0.0, rest);
        let mut step = (1.6 * stride).min(rest);
        for _ in 0..40 {
            match fit(curve, s, if step >= rest { 1.0 } else { s + step }, SEARCH_SHARE * tolerance) {
                Some(p) => {
                    good = Some((step, p));
                    lo = step;
                    if step >= rest {
                        break;
                    }
                }
                None => hi = step,
            }
            if hi - lo < 0.04 * hi || hi < SHORTEST {
                break;
            }
            step = if good.is_none() { 0.5 * hi } else { 0.5 * (lo + hi) };
        }
        let (length, pieces) = good.unwrap_or_else(|| {
            let step = SHORTEST.min(rest);
            (step, vec![ArcPiece { point: curve.place(s), bulge: 0.0, s }])
        });
        let next = if length >= rest { 1.0 } else { s + length };
        error = error.max(distance(curve, &pieces, s, next, MEASURE));
        out.extend(pieces);
        stride = length;
        s = next;
    }
    (out, SAFETY * error)
}

/// Line, arc or biarc on [a, b] if it stays within the tolerance.
fn fit(curve: &impl PlaneCurve, a: f64, b: f64, tolerance: f64) -> Option<Vec<ArcPiece>> {
    let (p, q) = (curve.place(a), curve.place(b));
    let chord = q - p;
    let line = vec![ArcPiece { point: p, bulge: 0.0, s: a }];
    if distance(curve, &line, a, b, SEARCH) <= STRAIGHT * tolerance {
        return Some(line);
    }
    let (t0, t1) = (direction(curve, a, b)?, direction(curve, b, a)?);
    // One arc, if the curve is one.
    let (alpha, omega) = (angle(&t0, &chord), angle(&chord, &t1));
    if alpha.abs() < STEEPEST && (alpha - omega).abs() < ONE_ARC {
        let one = vec![ArcPiece { point: p, bulge: (0.5 * alpha).tan(), s: a }];
        if distance(curve, &one, a, b, SEARCH) <= tolerance {
            return Some(one);
        }
    }
    // |q − p − d (t0 + t1)| = 2 d.
    let t = t0 + t1;
    let (vt, vv, k) = (chord.dot(&t), chord.norm_squared(), 2.0 * (1.0 - t0.dot(&t1)));
    let d = if k > PARALLEL {
        // Stable form of the positive root.
        vv / (vt + (vt * vt + k * vv).sqrt())
    } else {
        vv / (2.0 * vt)
    };
    if !(d > 0.0 && d.is_finite()) {
        return None;
    }
    let m = (p + q + (t0 - t1) * d) * 0.5;
    let (alpha, beta) = (angle(&t0, &(m - p)), angle(&(q - m), &t1));
    if alpha.abs() > STEEPEST || beta.abs() > STEEPEST {
        return None;
    }
    let two = vec![
        ArcPiece { point: p, bulge: (0.5 * alpha).tan(), s: a },
        ArcPiece { point: m, bulge: (0.5 * beta).tan(), s: 0.5 * (a + b) },
    ];
    (distance(curve, &two, a, b, SEARCH) <= tolerance).then_some(two)
}

/// Unit tangent at `at`, in the direction of growing s; from a secant towards `other` where the curve rests.
fn direction(curve: &impl PlaneCurve, at: f64, other: f64) -> Option<Vec2> {
    let (v, h) = (curve.velocity(at), other - at);
    let secant = (curve.place(at + SECANT * h) - curve.place(at)) / (SECANT * h);
    let v = if v.norm() > RESTS * secant.norm() { v } else { secant };
    let n = v.norm();
    (n > 0.0 && n.is_finite()).then(|| v / n)
}

fn angle(a: &Vec2, b: &Vec2) -> f64 {
    a.perp(b).atan2(a.dot(b))
}

/// Largest distance of `samples` points of the curve on [a, b] to the pieces, which end at the curve's point b.
fn distance(curve: &impl PlaneCurve, pieces: &[ArcPiece], a: f64, b: f64, samples: usize) -> f64 {
    let end = curve.place(b);
    (1..samples)
        .map(|i| {
            let x = curve.place(a + (b - a) * i as f64 / samples as f64);
            (0..pieces.len())
                .map(|k| {
                    let to = pieces.get(k + 1).map_or(end, |p| p.point);
                    distance_to_arc(&x, &pieces[k].point, &to, pieces[k].bulge)
                })
                .fold(f64::INFINITY, f64::min)
        })
        .fold(0.0, f64::max)
}

/// Distance from `x` to the line or arc from `a` to `b`.
pub fn distance_to_arc(x: &Vec2, a: &Vec2, b: &Vec2, bulge: f64) -> f64 {
    let chord = b - a;
    let l = chord.norm();
    if bulge.abs() < NO_BULGE || l <= 0.0 {
        let s = if l > 0.0 { ((x - a).dot(&chord) / (l * l)).clamp(0.0, 1.0) } else { 0.0 };
        return (x - a - chord * s).norm();
    }
    let (centre, radius) = circle(a, b, bulge);
    let v = x - centre;
    let sweep = 4.0 * bulge.atan();
    let turned = angle(&(a - centre), &v) * sweep.signum();
    let turned = if turned < 0.0 { turned + std::f64::consts::TAU } else { turned };
    if turned <= sweep.abs() {
        (v.norm() - radius).abs()
    } else {
        (x - a).norm().min((x - b).norm())
    }
}

/// Centre and radius of the arc from `a` to `b`; `bulge` not 0.
pub(crate) fn circle(a: &Vec2, b: &Vec2, bulge: f64) -> (Vec2, f64) {
    let chord = b - a;
    let left = Vec2::new(-chord.y, chord.x);
    let centre = (a + b) * 0.5 + left * (0.25 * (1.0 / bulge - bulge));
    (centre, (a - centre).norm())
}

/// Points along the line or arc from `a` (included) to `b` (not), such that chords stay within about 1 % of the
/// radius, at least `least` of them.
pub fn points_along(a: &Vec2, b: &Vec2, bulge: f64, least: usize) -> Vec<Vec2> {
    let sweep = 4.0 * bulge.atan();
    let n = least.max((sweep.abs() / 0.1).ceil() as usize).max(1);
    if bulge.abs() < NO_BULGE {
        return (0..n).map(|k| a + (b - a) * (k as f64 / n as f64)).collect();
    }
    let (centre, _) = circle(a, b, bulge);
    let v = a - centre;
    (0..n)
        .map(|k| {
            let (s, c) = (sweep * k as f64 / n as f64).sin_cos();
            centre + Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y)
        })
        .collect()
}

/// Turn of an arc (rad) between points of it that stand for it: chords miss it by half a millionth of its radius.
const FINE: f64 = 0.002;

/// The smallest rectangle around the outer contour, the first one; arcs reach beyond their ends. `None` without contours.
pub(crate) fn rectangle_around(contours: &[Contour]) -> Option<Rectangle> {
    let all = &contours.first()?.vertices;
    let piece = |(k, v): (usize, &ContourVertex)| {
        let sweep = 4.0 * v.bulge.atan().abs();
        points_along(&v.point, &all[(k + 1) % all.len()].point, v.bulge, (sweep / FINE).ceil() as usize)
    };
    smallest_rectangle(&all.iter().enumerate().flat_map(piece).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Formula<F: Fn(f64) -> (Vec2, Vec2)>(F);

    impl<F: Fn(f64) -> (Vec2, Vec2)> PlaneCurve for Formula<F> {
        fn place(&self, s: f64) -> Vec2 {
            (self.0)(s).0
        }
        fn velocity(&self, s: f64) -> Vec2 {
            (self.0)(s).1
        }
    }

    fn circle_arc(sweep: f64) -> impl PlaneCurve {
        Formula(move |s: f64| {
            let (y, x) = (sweep * s).sin_cos();
            (Vec2::new(30.0 * x, 30.0 * y), Vec2::new(-y, x) * (30.0 * sweep))
        })
    }

    #[test]
    fn a_line_is_one_line_and_an_arc_one_arc() {
        let line = Formula(|s: f64| (Vec2::new(3.0 * s, 4.0 * s), Vec2::new(3.0, 4.0)));
        let (p, e) = arcs(&line, 0.1);
        assert!(p.len() == 1 && p[0].bulge == 0.0 && e < 1e-12);
        let (p, e) = arcs(&circle_arc(1.2), 0.1);
        assert_eq!(p.len(), 1);
        assert!((p[0].bulge - 0.3_f64.tan()).abs() < 1e-9 && e < 1e-9);
        let (centre, radius) =
            circle(&Vec2::new(30.0, 0.0), &Vec2::new(30.0 * 1.2_f64.cos(), 30.0 * 1.2_f64.sin()), p[0].bulge);
        assert!(centre.norm() < 1e-6 && (radius - 30.0).abs() < 1e-6);
        // A clockwise arc.
        let (p, _) = arcs(&circle_arc(-1.2), 0.1);
        assert!((p[0].bulge + 0.3_f64.tan()).abs() < 1e-9);
    }

    #[test]
    fn what_is_smaller_than_the_tolerance_keeps_its_shape() {
        let (pieces, error) = arcs(&circle_arc(5.8), 20.0);
        assert!(pieces.len() > 1 && error < 2.0 * 30.0 * OWN_SHAPE * SAFETY, "{} pieces, error {error}", pieces.len());
        // What is flat beside it is a line all the same.
        assert_eq!(arcs(&circle_arc(0.5), 20.0).0.len(), 1);
    }

    #[test]
    fn no_tolerance_is_so_fine_that_arcs_have_no_end() {
        struct Parabola;
        impl PlaneCurve for Parabola {
            fn place(&self, s: f64) -> Vec2 {
                Vec2::new(100.0 * s, 40.0 * s * s)
            }
            fn velocity(&self, s: f64) -> Vec2 {
                Vec2::new(100.0, 80.0 * s)
            }
        }
        let (pieces, error) = arcs(&Parabola, 1e-300);
        assert!(pieces.len() < 3000 && error < 1e-7, "{} pieces, error {error:e}", pieces.len());
    }

    #[test]
    fn a_wave_needs_few_tangent_arcs_within_the_tolerance() {
        let wave = Formula(|s: f64| {
            let x = 3000.0 * s;
            let k = 0.004;
            (Vec2::new(x, 100.0 * (k * x).sin()), Vec2::new(3000.0, 300_000.0 * k * (k * x).cos()))
        });
        let tolerance = 0.05;
        let (p, e) = arcs(&wave, tolerance);
        assert!(e <= tolerance * SAFETY && p.len() <= 46, "{} pieces, error {e}", p.len());
        let end = wave.place(1.0);
        let mut last: Option<Vec2> = None;
        for k in 0..p.len() {
            let to = p.get(k + 1).map_or(end, |q| q.point);
            let (half, chord) = (2.0 * p[k].bulge.atan(), (to - p[k].point).normalize());
            let turn = |a: f64| Vec2::new(chord.x * a.cos() - chord.y * a.sin(), chord.x * a.sin() + chord.y * a.cos());
            if let Some(t) = last {
                assert!(angle(&t, &turn(-half)).abs() < 1e-6);
            }
            last = Some(turn(half));
        }
        // Against dense samples of the arcs, the other way round.
        for k in 0..p.len() {
            let to = p.get(k + 1).map_or(end, |q| q.point);
            for x in points_along(&p[k].point, &to, p[k].bulge, 5) {
                let y = 100.0 * (0.004 * x.x).sin();
                assert!((x.y - y).abs() < 1.2 * tolerance);
            }
        }
    }

    #[test]
    fn rectangles_reach_as_far_as_arcs_do() {
        let vertex = |x: f64, y: f64, bulge: f64| ContourVertex { point: Vec2::new(x, y), bulge, corner: true };
        // A disc of two halves, and the sector of an annulus between radii of 200/3 and 500/3 mm over 120°.
        let disc = Contour { vertices: vec![vertex(-50.0, 0.0, 1.0), vertex(50.0, 0.0, 1.0)] };
        let r = rectangle_around(&[disc]).expect("a rectangle");
        assert!((r.length - 100.0).abs() < 1e-4 && (r.width - 100.0).abs() < 1e-4, "{r:?}");
        let (inner, outer, half) = (200.0 / 3.0, 500.0 / 3.0, std::f64::consts::FRAC_PI_3);
        let at = |r: f64, a: f64, bulge: f64| vertex(r * a.sin(), r * a.cos(), bulge);
        let bulge = (0.5 * half).tan();
        let vertices =
            vec![at(inner, half, 0.0), at(outer, half, bulge), at(outer, -half, 0.0), at(inner, -half, -bulge)];
        let r = rectangle_around(&[Contour { vertices }]).expect("a rectangle");
        assert!((r.length - 288.675_134).abs() < 1e-4 && (r.width - 400.0 / 3.0).abs() < 1e-4, "{r:?}");
    }
}
