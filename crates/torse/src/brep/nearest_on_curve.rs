//! Nearest points on curves: Newton steps on the squared distance, from sampled starts.
//!
//! Method: Piegl & Tiller, The NURBS Book (1997), section 6.1, with the Gauss–Newton matrix where the full Hessian is
//! not positive definite, step halving, and parameters held at the ends while the distance falls outward.

use crate::geom::Vec3;
use crate::spline::knots::Knots;

/// Newton steps before giving up; convergence is quadratic and usually takes 5.
const STEPS: usize = 60;
/// Steps shorter than this share of the parameter (of one, near zero) no longer move it: a few units in its last place.
const STILL: f64 = 1e-15;

/// Improves the parameter `t` of a point of a curve, given by point and two derivatives, near `x`; answers parameter and squared distance. `limits`
/// bound the parameter.
pub fn refine(jet_at: impl Fn(f64) -> [Vec3; 3], x: &Vec3, t: f64, limits: Option<(f64, f64)>) -> (f64, f64) {
    let clamp = |t: f64| limits.map_or(t, |(a, b)| t.clamp(a, b));
    let mut t = clamp(t);
    let mut jet = jet_at(t);
    let mut best = (jet[0] - x).norm_squared();
    for _ in 0..STEPS {
        let r = jet[0] - x;
        let gradient = r.dot(&jet[1]);
        let speed = jet[1].norm_squared();
        let full = speed + r.dot(&jet[2]);
        let slope = if full > 0.1 * speed { full } else { speed };
        if slope <= 0.0 || slope.is_nan() {
            break;
        }
        let mut step = -gradient / slope;
        let mut moved = false;
        for _ in 0..20 {
            let next = clamp(t + step);
            let j = jet_at(next);
            let d = (j[0] - x).norm_squared();
            if d < best {
                let small = (next - t).abs() <= STILL * (1.0 + t.abs());
                (t, jet, best, moved) = (next, j, d, !small);
                break;
            }
            step *= 0.5;
            if step.abs() <= STILL * (1.0 + t.abs()) {
                break;
            }
        }
        if !moved {
            break;
        }
    }
    (t, best)
}

/// Parameter of a nearest point of a spline curve: every span is sampled, the best samples are refined.
pub fn nearest(jet_at: impl Fn(f64) -> [Vec3; 3], knots: &Knots, x: &Vec3) -> f64 {
    let per_span = 2 * knots.degree() + 2;
    let breaks = knots.breaks();
    let mut samples: Vec<(f64, f64)> = Vec::with_capacity(breaks.len() * per_span);
    for w in breaks.windows(2) {
        for i in 0..per_span {
            let t = w[0] + (w[1] - w[0]) * i as f64 / per_span as f64;
            samples.push((t, (jet_at(t)[0] - x).norm_squared()));
        }
    }
    let (a, b) = knots.domain();
    samples.push((b, (jet_at(b)[0] - x).norm_squared()));
    let mut starts: Vec<(f64, f64)> = (0..samples.len())
        .filter(|&i| {
            (i == 0 || samples[i - 1].1 >= samples[i].1) && samples.get(i + 1).is_none_or(|n| n.1 >= samples[i].1)
        })
        .map(|i| samples[i])
        .collect();
    starts.sort_by(|p, q| p.1.total_cmp(&q.1));
    starts
        .iter()
        .take(4)
        .map(|s| refine(&jet_at, x, s.0, Some((a, b))))
        .min_by(|p, q| p.1.total_cmp(&q.1))
        .map_or(a, |p| p.0)
}
