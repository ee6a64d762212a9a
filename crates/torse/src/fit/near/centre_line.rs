//! Centre lines of strips: a level curve of φ, traced beyond the region, with tangent planes and conjugate rulings.
//!
//! *Method.* The envelope of the tangent planes along a curve has the conjugate directions as rulings (\[SE06\]);
//! approximation specification B3.4: the curve is continued beyond the region, so that oblique rulings reach its
//! corners, on the second-order Taylor extension of the surface. How a line waves says how many spans a torse along it
//! needs (cubic splines by least squares over the arc length).

use super::tangent_envelope::ROUNDING;
use crate::geom::Vec3;
use crate::spline::field::Field;
use crate::spline::knots::Knots;
use crate::spline::lsq::{chord_parameters, fit};
use crate::spline::surface::Surface;
use crate::torse::form::Ruling;

/// Steps of the trace over the diagonal of the region.
const STEPS: usize = 60;
/// Share of the box by which the trace may leave it on each side.
const BEYOND: f64 = 0.25;

/// Traces the level curve of `field` through `seed` in both directions until it leaves the box
/// `[u0, u1, v0, v1]` enlarged by a quarter, or turns back. `size` is the diagonal of the region in mm.
/// Points where the normal curvature along the curve vanishes are left out. Fewer than four points: empty.
pub(crate) fn centre_line(
    surface: &Surface,
    field: &Field,
    bounds: [f64; 4],
    seed: [f64; 2],
    size: f64,
) -> Vec<Ruling> {
    let level = field.value(seed);
    let (mu, mv) = (BEYOND * (bounds[1] - bounds[0]), BEYOND * (bounds[3] - bounds[2]));
    let outside =
        |p: [f64; 2]| p[0] < bounds[0] - mu || p[0] > bounds[1] + mu || p[1] < bounds[2] - mv || p[1] > bounds[3] + mv;
    let step = size / STEPS as f64;
    let mut halves: [Vec<Ruling>; 2] = [Vec::new(), Vec::new()];
    for (half, sign) in halves.iter_mut().zip([1.0, -1.0]) {
        let mut p = seed;
        for k in 0..4 * STEPS {
            if k > 0 || sign > 0.0 {
                half.extend(ruling(surface, field, p));
            }
            let Some(mid) = advance(surface, field, p, 0.5 * step * sign, p) else { break };
            let Some(mut next) = advance(surface, field, p, step * sign, mid) else { break };
            // Back onto the level by Newton steps along the gradient.
            for _ in 0..3 {
                let [f, fu, fv] = field.jet(next[0], next[1]);
                let g = fu * fu + fv * fv;
                if g <= 0.0 {
                    break;
                }
                let s = (level - f) / g;
                next = [next[0] + s * fu, next[1] + s * fv];
            }
            p = next;
            if outside(p) || !(p[0].is_finite() && p[1].is_finite()) {
                break;
            }
        }
    }
    let [forward, mut line] = halves;
    line.reverse();
    // Reversed half: its curve direction is opposite, its rulings are oriented by the first direction anyway.
    line.extend(forward);
    for k in 1..line.len() {
        if line[k].direction.dot(&line[k - 1].direction) < 0.0 {
            line[k].direction = -line[k].direction;
        }
    }
    if line.len() < 4 {
        line.clear();
    }
    line
}

/// From `p` a step of length `length` (mm) along the level curve's direction at `at`.
fn advance(surface: &Surface, field: &Field, p: [f64; 2], length: f64, at: [f64; 2]) -> Option<[f64; 2]> {
    let j = surface.extended_jet(at[0], at[1]);
    let [_, fu, fv] = field.jet(at[0], at[1]);
    let speed = (j.du * fv - j.dv * fu).norm();
    (speed > 0.0 && speed.is_finite()).then(|| [p[0] + length * fv / speed, p[1] - length * fu / speed])
}

/// Tangent plane and conjugate direction at a point of the level curve.
fn ruling(surface: &Surface, field: &Field, p: [f64; 2]) -> Option<Ruling> {
    let j = surface.extended_jet(p[0], p[1]);
    let n = j.normal();
    if n.norm() <= ROUNDING * j.du.norm() * j.dv.norm() {
        return None;
    }
    let n = n.normalize();
    let [l, m, k] = j.second_form(&n);
    let [_, fu, fv] = field.jet(p[0], p[1]);
    // T = (φ_v, −φ_u); the conjugate (a, b) solves II(T, (a, b)) = 0.
    let (a, b) = (m * fv - k * fu, -(l * fv - m * fu));
    let direction: Vec3 = j.du * a + j.dv * b;
    let size = direction.norm();
    (size > 0.0 && size.is_finite()).then(|| Ruling { point: j.p, direction: direction / size, normal: n })
}

/// Number of equal spans of a cubic spline that follows a centre line within a distance (mm), on a stretch of it as long
/// as `extent` (mm); no more than `most`. *Not guaranteed*: the fewest; numbers rise by a quarter, and only the points of the
/// line are looked at.
pub(crate) fn spans_along(line: &[Ruling], distance: f64, extent: f64, most: usize) -> usize {
    let points: Vec<[f64; 3]> = line.iter().map(|r| r.point.into()).collect();
    let parameters = chord_parameters(&points);
    // Too few points, or none that differ, ask for nothing.
    let follows = |spans: usize| {
        Knots::uniform(3, spans, 0.0, 1.0)
            .ok()
            .and_then(|knots| fit(&points, &parameters, &knots).ok())
            .is_none_or(|fit| fit.error <= distance)
    };
    let mut spans = 1;
    while spans < most && !follows(spans) {
        spans += spans.div_ceil(4);
    }
    let length: f64 = line.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum();
    (spans as f64 * (extent / length).min(1.0)).ceil().min(most as f64) as usize
}

/// Whether the normal curvature of a centre line changes its sign, its points being about equally spaced; curvatures below
/// a tenth of the largest do not count.
pub(crate) fn has_inflection(line: &[Ruling]) -> bool {
    const LEAST_BEND: f64 = 0.1;
    let bend = |w: &[Ruling]| w[1].normal.dot(&(w[0].point - w[1].point * 2.0 + w[2].point));
    let (lo, hi) = line.windows(3).map(bend).fold((0.0_f64, 0.0_f64), |(lo, hi), b| (lo.min(b), hi.max(b)));
    (-lo).min(hi) > LEAST_BEND * (-lo).max(hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave needs about as many spans as the error of cubic splines says: h⁴ times the fourth derivative over 384.
    #[test]
    fn waves_need_more_spans_than_arcs() {
        let line = |f: &dyn Fn(f64) -> f64| -> Vec<Ruling> {
            let point = |i: i32| {
                let x = f64::from(i) / 200.0;
                Ruling { point: Vec3::new(x, 0.0, f(x)), direction: Vec3::y(), normal: Vec3::z() }
            };
            (0..=200).map(point).collect()
        };
        let wave = line(&|x| 0.01 * (40.0 * x).sin());
        let straight = line(&|x| 0.1 * x);
        assert!(spans_along(&straight, 1e-4, 2.0, 80) == 1, "{}", spans_along(&straight, 1e-4, 2.0, 80));
        let needed = (0.01 * 40f64.powi(4) / 384.0 / 1e-4_f64).powf(0.25);
        let spans = spans_along(&wave, 1e-4, 2.0, 80);
        assert!((0.8 * needed..1.8 * needed).contains(&(spans as f64)), "{spans} {needed}");
        // On half of it, half as many; more within a smaller distance.
        assert!(spans_along(&wave, 1e-4, 0.5, 80).abs_diff(spans / 2) <= 1);
        assert!(spans_along(&wave, 1e-5, 2.0, 80) > spans);
        assert!(spans_along(&[], 1e-4, 1.0, 80) <= 1 && spans_along(&wave[..1], 1e-4, 1.0, 80) <= 1);
    }
}
