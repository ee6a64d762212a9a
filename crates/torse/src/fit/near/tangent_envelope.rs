//! The envelope of the tangent planes along a curve on a surface, and the region that it approximates.
//!
//! *Method* (\[SE06\], sections 2.1, 2.2 and 2.6; formulas (1)–(4), (18), (19) as corrected in the approximation
//! specification, B1). The ruling at a point of the curve is conjugate to its tangent, parallel to `N × N'`. Around each
//! ruling the points of the surface within the tolerance of it form a region; the minimal interval of the ruling is
//! its range of the coordinate along the ruling. The paper traces the region's border as an algebraic curve; here the
//! section of the surface with the plane square to the ruling is followed instead, which gives the same end points: the
//! interval ends at the first such plane in which the surface is farther from the ruling than the tolerance.
//!
//! Knows nothing of faces and panels. What it says about distances is sampled; see `certify` for proofs.

use crate::geom::Vec3;
use crate::spline::surface::Surface;
use crate::torse::form::Ruling;

/// The ruling of the envelope at a point of a curve on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeRuling {
    /// Parameters of the point on the surface.
    pub uv: [f64; 2],
    /// The ruling at the point, with the surface's normal, oriented so that curve direction, ruling and normal are right-handed.
    pub ruling: Ruling,
    /// Normal curvature along the curve, 1/mm.
    pub curvature: f64,
    /// Normal curvature along the ruling, 1/mm.
    pub across: f64,
}

/// Why a curve has no envelope, or none that could be a panel.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AlongError {
    /// Fewer than three different points, or numbers that are not finite.
    #[error("the curve has no length")]
    Empty,
    /// The parametrisation has no normal.
    #[error("the surface has no normal at {share:.3} of the curve's length; lead the curve around that point")]
    Normal {
        /// Share of the curve's length.
        share: f64,
    },
    /// The tangent planes do not turn.
    #[error("the tangent planes do not turn at {share:.3} of the curve's length: the surface is flat there")]
    Flat {
        /// Share of the curve's length.
        share: f64,
    },
    /// The curve runs along an asymptotic direction.
    #[error(
        "the curve runs along an asymptotic direction at {share:.3} of its length: the rulings of the envelope lie along \
         the curve there; turn the curve by some degrees, or end it before"
    )]
    Asymptotic {
        /// Share of the curve's length.
        share: f64,
    },
}

/// Smallest sine between ruling and curve: at 3° a strip is twenty times longer along its rulings than it is wide.
const LEAST_SINE: f64 = 0.05;
/// Shares below this are rounding: of a normal in `|S_u| |S_v|`, of its turning in that along the largest curvature.
pub(crate) const ROUNDING: f64 = 1e-9;

/// Rulings of the envelope of the tangent planes along the curve through parameter points (at least three, a smooth
/// curve, about equally spaced).
///
/// # Errors
/// [`AlongError`] with the place: no length, no normal, no turning plane, an asymptotic direction.
pub fn envelope_along(surface: &Surface, line: &[[f64; 2]]) -> Result<Vec<EnvelopeRuling>, AlongError> {
    let n = line.len();
    if n < 3 || line.iter().flatten().any(|x| !x.is_finite()) || line.windows(2).all(|w| w[0] == w[1]) {
        return Err(AlongError::Empty);
    }
    (0..n)
        .map(|i| {
            let share = i as f64 / (n - 1) as f64;
            ruling_at(surface, line[i], tangent(line, i), share)
        })
        .collect()
}

/// Derivative of a quadratic through neighbouring points, by the index.
fn tangent(line: &[[f64; 2]], i: usize) -> [f64; 2] {
    let n = line.len();
    std::array::from_fn(|d| match i {
        0 => -1.5 * line[0][d] + 2.0 * line[1][d] - 0.5 * line[2][d],
        _ if i == n - 1 => 1.5 * line[i][d] - 2.0 * line[i - 1][d] + 0.5 * line[i - 2][d],
        _ => 0.5 * (line[i + 1][d] - line[i - 1][d]),
    })
}

/// The ruling of the envelope at `uv` for the curve direction `t` in the parameter plane.
fn ruling_at(surface: &Surface, uv: [f64; 2], t: [f64; 2], share: f64) -> Result<EnvelopeRuling, AlongError> {
    let j = surface.extended_jet(uv[0], uv[1]);
    let n = j.normal();
    if n.norm().is_nan() || n.norm() <= ROUNDING * j.du.norm() * j.dv.norm() {
        return Err(AlongError::Normal { share });
    }
    let n = n.normalize();
    let second = j.second_form(&n);
    let along = j.du * t[0] + j.dv * t[1];
    let speed = along.norm();
    if speed.is_nan() || speed <= 0.0 {
        return Err(AlongError::Empty);
    }
    // II(t, ·) as a covector; its kernel is the conjugate direction, and it vanishes where N' does.
    let co = [second[0] * t[0] + second[1] * t[1], second[1] * t[0] + second[2] * t[1]];
    let w = j.du * -co[1] + j.dv * co[0];
    let cross = j.du.cross(&j.dv).norm();
    // |w| = |N'| · |S_u × S_v|, and |N'| is compared with the largest curvature.
    let e = [j.du.norm_squared(), j.du.dot(&j.dv), j.dv.norm_squared()];
    let largest = (second[0] * e[2] - 2.0 * second[1] * e[1] + second[2] * e[0]).abs() / (cross * cross)
        + ((second[0] * second[2] - second[1] * second[1]).abs()).sqrt() / cross;
    if w.norm().is_nan() || w.norm() <= ROUNDING * largest.max(f64::MIN_POSITIVE) * speed * cross {
        return Err(AlongError::Flat { share });
    }
    let direction = w.normalize();
    let sine = along.cross(&direction).dot(&n) / speed;
    if sine.abs() < LEAST_SINE {
        return Err(AlongError::Asymptotic { share });
    }
    let ab = [-co[1] / w.norm(), co[0] / w.norm()];
    let form = |a: [f64; 2]| second[0] * a[0] * a[0] + 2.0 * second[1] * a[0] * a[1] + second[2] * a[1] * a[1];
    Ok(EnvelopeRuling {
        uv,
        ruling: Ruling { point: j.p, direction: if sine < 0.0 { -direction } else { direction }, normal: n },
        curvature: form(t) / (speed * speed),
        across: form(ab),
    })
}

/// The point of the surface in the plane square to the ruling at distance `r` along it, nearest to the ruling, and its
/// distance from it. `start`: parameters near by.
pub(crate) fn beside(surface: &Surface, p: &EnvelopeRuling, r: f64, start: [f64; 2]) -> Option<([f64; 2], f64)> {
    // Each step leaves about the square of the turn of the tangent plane.
    const STEPS: usize = 30;
    const SETTLED: f64 = 1e-12;
    // Share of the distance (of a millimetre, for short ones) by which a point that ran out of steps may miss its
    // plane.
    const REACHED: f64 = 1e-6;
    let mut uv = start;
    let Ruling { point, direction, .. } = p.ruling;
    let e = p.ruling.at(r);
    for _ in 0..STEPS {
        let j = surface.extended_jet(uv[0], uv[1]);
        let side = j.normal().cross(&direction).try_normalize(0.0)?;
        let rest = j.p - e;
        let (g, h) = (-direction.dot(&rest), -side.dot(&rest));
        let (a, b, c, d) = (direction.dot(&j.du), direction.dot(&j.dv), side.dot(&j.du), side.dot(&j.dv));
        let det = a * d - b * c;
        let step = [(g * d - b * h) / det, (a * h - c * g) / det];
        if !step.iter().all(|s| s.is_finite()) {
            return None;
        }
        uv = [uv[0] + step[0], uv[1] + step[1]];
        if g.abs() + h.abs() <= SETTLED * (1.0 + r.abs()) {
            break;
        }
    }
    let j = surface.extended_jet(uv[0], uv[1]);
    let v = j.p - point;
    let distance = (v - direction * v.dot(&direction)).norm();
    let off = (v.dot(&direction) - r).abs();
    (off <= REACHED * (1.0 + r.abs()) && distance.is_finite()).then_some((uv, distance))
}

/// Distances along the ruling, `[backward, forward]` (both positive, mm), up to which the surface stays within
/// `tolerance` of it; at most `reach`.
pub fn interval(surface: &Surface, p: &EnvelopeRuling, tolerance: f64, reach: f64) -> [f64; 2] {
    // Steps up to the interval of the second-order theory, and bisections of the last step.
    const STEPS: f64 = 8.0;
    const BISECTIONS: usize = 30;
    let theory = (2.0 * tolerance / p.across.abs().max(f64::MIN_POSITIVE)).sqrt().min(reach);
    [-1.0, 1.0].map(|sign| {
        let (mut good, mut uv) = (0.0, p.uv);
        let step = theory / STEPS;
        while good < reach {
            let r = (good + step).min(reach);
            match beside(surface, p, sign * r, uv) {
                Some((at, d)) if d <= tolerance => (good, uv) = (r, at),
                _ => {
                    let mut bad = r;
                    for _ in 0..BISECTIONS {
                        let middle = 0.5 * (good + bad);
                        match beside(surface, p, sign * middle, uv) {
                            Some((at, d)) if d <= tolerance => (good, uv) = (middle, at),
                            _ => bad = middle,
                        }
                    }
                    break;
                }
            }
            if step <= 0.0 {
                break;
            }
        }
        good
    })
}

/// Parameters of the surface beside the ruling at distance `r`, reached in steps from the curve.
pub fn walked(surface: &Surface, p: &EnvelopeRuling, r: f64) -> Option<[f64; 2]> {
    const STEPS: usize = 4;
    let mut uv = p.uv;
    for k in 1..=STEPS {
        uv = beside(surface, p, r * k as f64 / STEPS as f64, uv)?.0;
    }
    Some(uv)
}

/// Smooths a border `q` of a strip towards its centre line `c` ((18), (19)): `q̃ = (1 − β) c + β q` with `0 ≤ β ≤ 1`
/// minimises `weight · Σ|second differences of q̃|² + Σ|q̃ − q|²`.
pub fn smoothed(c: &[[f64; 2]], q: &[[f64; 2]], weight: f64) -> Vec<[f64; 2]> {
    // Coordinate descent on a strictly convex function over a box; enough for the weights of some units that are used.
    const SWEEPS: usize = 100;
    let n = c.len().min(q.len());
    let d: Vec<[f64; 2]> = (0..n).map(|i| [q[i][0] - c[i][0], q[i][1] - c[i][1]]).collect();
    let mut out: Vec<[f64; 2]> = q[..n].to_vec();
    let mut beta = vec![1.0_f64; n];
    for _ in 0..SWEEPS {
        for i in 0..n {
            let dd = d[i][0] * d[i][0] + d[i][1] * d[i][1];
            if dd <= 0.0 {
                continue;
            }
            // Gradient and second derivative with respect to β_i.
            let mut gradient = dd * (beta[i] - 1.0);
            let mut curvature = dd;
            for (m, factor) in [(i.wrapping_sub(1), 1.0), (i, -2.0), (i + 1, 1.0)] {
                if m == usize::MAX || m == 0 || m + 1 >= n {
                    continue;
                }
                let s: [f64; 2] = std::array::from_fn(|k| out[m - 1][k] - 2.0 * out[m][k] + out[m + 1][k]);
                gradient += weight * factor * (s[0] * d[i][0] + s[1] * d[i][1]);
                curvature += weight * factor * factor * dd;
            }
            beta[i] = (beta[i] - gradient / curvature).clamp(0.0, 1.0);
            out[i] = std::array::from_fn(|k| c[i][k] + beta[i] * d[i][k]);
        }
    }
    out
}

/// Largest distance found by the paper's own comparison (10)–(13), (15): the surface over the bilinear map of the
/// parameter quadrangles between rulings, each divided in `2^m` along every half ruling, against the ruled pieces
/// between the rulings' ends, split at the curve. Sampled at `3 × 3` points per quadrangle. It counts the mismatch
/// along the surface too, so it exceeds the distance unless rulings are dense.
pub fn paper_estimate(surface: &Surface, points: &[EnvelopeRuling], ends: &[[f64; 2]], m: u32) -> f64 {
    const INSIDE: usize = 2;
    let parts = 1usize << m.min(6);
    // Both halves of each ruling: parameter points at equal parts of the minimal interval.
    let rows: Vec<Vec<([f64; 2], Vec3)>> = points
        .iter()
        .zip(ends)
        .map(|(p, r)| {
            let mut row = Vec::with_capacity(2 * parts + 1);
            for k in 0..=2 * parts {
                let share = k as f64 / parts as f64 - 1.0;
                let at = if share < 0.0 { -share * -r[0] } else { share * r[1] };
                let uv = walked(surface, p, at).unwrap_or(p.uv);
                row.push((uv, p.ruling.at(at)));
            }
            row
        })
        .collect();
    let mut worst: f64 = 0.0;
    for w in rows.windows(2) {
        for k in 0..2 * parts {
            for (i, j) in (0..=INSIDE).flat_map(|i| (0..=INSIDE).map(move |j| (i, j))) {
                let (a, b) = (i as f64 / INSIDE as f64, j as f64 / INSIDE as f64);
                let weights = [(1.0 - a) * (1.0 - b), (1.0 - a) * b, a * (1.0 - b), a * b];
                let corners = [&w[0][k], &w[0][k + 1], &w[1][k], &w[1][k + 1]];
                let uv: [f64; 2] = std::array::from_fn(|d| weights.iter().zip(corners).map(|(w, c)| w * c.0[d]).sum());
                let x: Vec3 = weights.iter().zip(corners).map(|(w, c)| c.1 * *w).sum();
                worst = worst.max((surface.extended_jet(uv[0], uv[1]).p - x).norm());
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;

    /// z = (a x² + b y²)/2 over [−1, 1]².
    fn quadric(a: f64, b: f64) -> Surface {
        let k = Knots::clamped(2, &[-1.0, 1.0]).expect("knots");
        // Bernstein coefficients of t and t² on [−1, 1].
        let (t, tt) = ([-1.0, 0.0, 1.0], [1.0, -1.0, 1.0]);
        let points: Vec<Vec3> =
            (0..3).flat_map(|i| (0..3).map(move |j| Vec3::new(t[i], t[j], 0.5 * (a * tt[i] + b * tt[j])))).collect();
        Surface::new(k.clone(), k, &points, None).expect("surface")
    }

    fn line(f: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
        (0..21).map(|i| f(-0.8 + 1.6 * i as f64 / 20.0)).collect()
    }

    #[test]
    fn the_interval_of_a_ruling_is_that_of_the_closed_form() {
        // Along y = 0 of a paraboloid the rulings run along y: the surface leaves them by b y²/2.
        let (s, b, eps) = (quadric(1.0, 0.5), 0.5_f64, 1e-3);
        let p = envelope_along(&s, &line(|t| [t, 0.0])).expect("envelope");
        let middle = p[10];
        assert!((middle.ruling.direction - Vec3::y()).norm() < 1e-12 && (middle.across - b).abs() < 1e-12);
        let want = (2.0 * eps / b).sqrt();
        for r in interval(&s, &middle, eps, 10.0) {
            assert!((r - want).abs() < 1e-6 * want, "{r} {want}");
        }
        // The whole width is √(8 ε/κ).
        let [x, y] = interval(&s, &middle, eps, 10.0);
        assert!((x + y - (8.0 * eps / b).sqrt()).abs() < 1e-6);
    }

    #[test]
    fn rulings_are_conjugate_and_turn_with_the_normals() {
        let s = quadric(1.0, 0.3);
        let l = line(|t| [t, 0.3 * t + 0.1 * t * t]);
        let p = envelope_along(&s, &l).expect("envelope");
        for w in p.windows(3).skip(1).take(15) {
            let w_paper = w[1].ruling.normal.cross(&(w[2].ruling.normal - w[0].ruling.normal)).normalize();
            assert!(w_paper.cross(&w[1].ruling.direction).norm() < 2e-3);
        }
    }

    #[test]
    fn asymptotic_and_flat_curves_are_named() {
        let saddle = quadric(1.0, -1.0);
        let e = envelope_along(&saddle, &line(|t| [t, t])).expect_err("asymptotic");
        assert!(matches!(e, AlongError::Asymptotic { .. }), "{e}");
        let cylinder = quadric(1.0, 0.0);
        let e = envelope_along(&cylinder, &line(|t| [0.0, t])).expect_err("flat");
        assert!(matches!(e, AlongError::Flat { share } if share == 0.0), "{e}");
        assert_eq!(envelope_along(&saddle, &[[f64::NAN; 2]; 4]), Err(AlongError::Empty));
        assert_eq!(envelope_along(&saddle, &[[0.1, 0.1]; 5]), Err(AlongError::Empty));
    }

    #[test]
    fn smoothing_takes_out_teeth_and_stays_inside() {
        let c: Vec<[f64; 2]> = (0..20).map(|i| [i as f64, 0.0]).collect();
        let q: Vec<[f64; 2]> = (0..20).map(|i| [i as f64, 1.0 + if i % 2 == 0 { 0.1 } else { -0.1 }]).collect();
        let s = smoothed(&c, &q, 5.0);
        let rough = |l: &[[f64; 2]]| l.windows(3).map(|w| (w[0][1] - 2.0 * w[1][1] + w[2][1]).powi(2)).sum::<f64>();
        assert!(rough(&s) < 0.05 * rough(&q));
        assert!(s.iter().zip(&q).all(|(s, q)| s[1] <= q[1] + 1e-12 && s[1] >= 0.0));
    }

    #[test]
    fn the_papers_comparison_falls_with_more_rulings() {
        let (s, eps) = (quadric(1.0, 0.5), 1e-3);
        let run = |n: usize| {
            let l: Vec<[f64; 2]> = (0..n).map(|i| [-0.8 + 1.6 * i as f64 / (n - 1) as f64, 0.0]).collect();
            let p = envelope_along(&s, &l).expect("envelope");
            let ends: Vec<[f64; 2]> = p.iter().map(|p| interval(&s, p, eps, 1.0)).collect();
            paper_estimate(&s, &p, &ends, 2)
        };
        let (few, many) = (run(6), run(60));
        assert!(many < few && many >= 0.999 * eps && many < 1.1 * eps, "{few} {many}");
    }
}
