//! Trimming curves of a panel: cubic splines through foot points in the parameter plane of the patch, and the same
//! curves in space. Method: certificate specification, section 5 (cubic spline in the shared parameter s through
//! feet of the region's boundary, end values copied, refined until the error in space is small).

use crate::spline::composite::smooth_breaks;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// A point that the trimming curve should pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Waypoint {
    /// Parameter of the curve, from 0 to 1.
    pub s: f64,
    /// Parameters (t, r) on the patch.
    pub place: [f64; 2],
    /// Accepted distance in space, mm.
    pub allowance: f64,
}

/// A fitted trimming curve.
#[derive(Clone, Debug)]
pub struct Trim {
    /// `(t, r)(s)`, cubic, domain [0, 1], C² except at double knots where it crosses a knot line of the patch: feet
    /// are only C¹ there. Its ends are those of the waypoints, bit by bit.
    pub curve: Curve<2>,
    /// Largest distance in space (mm) between curve and waypoints at equal s (first order).
    pub deviation_estimate: f64,
}

/// Weight of second differences against waypoints. A control point that is felt at its nearest waypoint by less than the
/// square root of it counts as left open: with a thousandth of this, one that is felt by 10⁻⁵ followed the last digits of
/// feet and threw the curve out of its patch, within the span and unseen at waypoints.
const STIFFNESS: f64 = 1e-8;
/// Rounds of refinement; every round halves the spans that miss their allowance.
const ROUNDS: usize = 20;
/// A span with fewer waypoints gets more of them before it is cut: more knots could not be determined.
const SPLITTABLE: usize = 5;

/// Cubic spline near waypoints with increasing s from 0 to 1, with few knots where it is smooth.
///
/// *Method*: least squares with fixed ends; spans are cut where the error in space exceeds the allowance, at a
/// crossing of the patch's knot lines (double knot) or at their middle waypoint. Where waypoints are too few for
/// another knot, `between` gives one between two neighbours. *Not guaranteed*: that the allowance is met (see
/// `deviation_estimate`), namely where the waypoints have a kink.
///
/// # Errors
/// Values that are not finite.
pub fn trim(
    patch: &Surface,
    mut waypoints: Vec<Waypoint>,
    between: impl Fn(&Waypoint, &Waypoint) -> Option<Waypoint>,
) -> Result<Trim, SplineError> {
    let lines = patch.knots_u.breaks();
    let mut breaks = vec![(0.0, 1), (1.0, 1)];
    let mut best: Option<Trim> = None;
    for _ in 0..ROUNDS {
        let curve = least_squares(&breaks, &waypoints)?;
        let mut worst = 0.0_f64;
        let mut exceeded = vec![false; breaks.len() - 1];
        for w in &waypoints {
            let q = curve.point(w.s);
            let j = patch.jet(w.place[0], w.place[1]);
            let error = (j.du * (q[0] - w.place[0]) + j.dv * (q[1] - w.place[1])).norm();
            worst = worst.max(error);
            if error > w.allowance {
                let k = breaks.partition_point(|b| b.0 <= w.s).clamp(1, breaks.len() - 1);
                exceeded[k - 1] = true;
            }
        }
        if best.as_ref().is_none_or(|b| worst < b.deviation_estimate) {
            best = Some(Trim { curve, deviation_estimate: worst });
        }
        if !exceeded.contains(&true) {
            break;
        }
        let mut finer = vec![breaks[0]];
        let mut fuller = vec![waypoints[0]];
        for (k, w) in breaks.windows(2).enumerate() {
            let (lo, hi) = (waypoints.partition_point(|p| p.s <= w[0].0), waypoints.partition_point(|p| p.s < w[1].0));
            let scarce = exceeded[k] && hi - lo < SPLITTABLE;
            if exceeded[k] && !scarce {
                finer.push(cut(&waypoints[lo..hi], &lines));
            }
            finer.push(w[1]);
            // Waypoints after w[0], up to w[1] or the first one beyond.
            let end =
                if k + 2 == breaks.len() { waypoints.len() } else { waypoints.partition_point(|p| p.s <= w[1].0) };
            for i in lo.max(1)..end {
                if scarce {
                    fuller.extend(between(&waypoints[i - 1], &waypoints[i]));
                }
                fuller.push(waypoints[i]);
            }
        }
        if finer.len() == breaks.len() && fuller.len() == waypoints.len() {
            break;
        }
        (breaks, waypoints) = (finer, fuller);
    }
    best.ok_or(SplineError::KnotCount { knots: 0, control: 0, degree: 3 })
}

/// The trimming curve of a border that is a point.
///
/// # Errors
/// Values that are not finite.
pub fn point(place: [f64; 2]) -> Result<Trim, SplineError> {
    let curve = Curve::new(3, vec![0., 0., 0., 0., 1., 1., 1., 1.], vec![place; 4])?;
    Ok(Trim { curve, deviation_estimate: 0.0 })
}

/// Where to cut a span with the given waypoints, and the multiplicity of the knot: at a crossing of the patch's knot
/// lines, where the second derivative of the feet jumps, if one lies in the middle half; else at the middle waypoint.
fn cut(inside: &[Waypoint], lines: &[f64]) -> (f64, usize) {
    let n = inside.len();
    let middle = n / 2;
    let crossing = |k: usize| {
        let (a, b) = (&inside[k - 1], &inside[k]);
        let (p, q) = (a.place[0], b.place[0]);
        lines
            .iter()
            .find(|&&l| (p < l) != (q < l))
            .map(|l| (a.s + (b.s - a.s) * ((l - p) / (q - p)).clamp(0.0, 1.0), 2))
    };
    (0..=n / 4)
        .flat_map(|d| [middle + d, middle - d])
        .filter(|&k| k > 0 && k < n)
        .find_map(crossing)
        .unwrap_or((inside[middle].s, 1))
}

/// Least-squares cubic spline on knots `(s, multiplicity)` with its ends fixed to the first and last waypoint.
fn least_squares(breaks: &[(f64, usize)], waypoints: &[Waypoint]) -> Result<Curve<2>, SplineError> {
    let mut values = vec![0.0; 4];
    for &(s, m) in &breaks[1..breaks.len() - 1] {
        values.extend(std::iter::repeat_n(s, m));
    }
    values.extend([1.0; 4]);
    let n = values.len() - 4;
    let knots = Knots::new(3, values, n)?;
    let (first, last) = match (waypoints.first(), waypoints.last()) {
        (Some(a), Some(b)) => (a.place, b.place),
        _ => return Err(SplineError::KnotCount { knots: 0, control: 0, degree: 3 }),
    };
    // Normal equations of the inner control points, four diagonals.
    let m = n - 2;
    let mut a = vec![[0.0; 4]; m];
    let mut rhs = vec![[0.0; 2]; m];
    for w in waypoints {
        let b = knots.basis(w.s, 0);
        let mut target = w.place;
        for j in 0..4 {
            let i = b.first + j;
            if i == 0 || i == n - 1 {
                let end = if i == 0 { first } else { last };
                target[0] -= b.rows[0][j] * end[0];
                target[1] -= b.rows[0][j] * end[1];
            }
        }
        for j in 0..4 {
            let i = b.first + j;
            if i == 0 || i == n - 1 {
                continue;
            }
            for d in 0..2 {
                rhs[i - 1][d] += b.rows[0][j] * target[d];
            }
            for l in 0..=j {
                let k = b.first + l;
                if k > 0 {
                    a[i - 1][j - l] += b.rows[0][j] * b.rows[0][l];
                }
            }
        }
    }
    // A trace of second differences decides what few waypoints leave open.
    let trace: f64 = a.iter().map(|r| r[0]).sum::<f64>() / m as f64;
    let hair = STIFFNESS * trace.max(f64::MIN_POSITIVE);
    for i in 1..n - 1 {
        let stencil = [(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)];
        for (p, x) in stencil {
            if p == 0 || p == n - 1 {
                continue;
            }
            for (q, y) in stencil {
                if q == 0 || q == n - 1 {
                    let end = if q == 0 { first } else { last };
                    rhs[p - 1][0] -= hair * x * y * end[0];
                    rhs[p - 1][1] -= hair * x * y * end[1];
                } else if q <= p {
                    a[p - 1][p - q] += hair * x * y;
                }
            }
        }
    }
    banded_cholesky(&mut a, &mut rhs);
    let mut control = Vec::with_capacity(n);
    control.push(first);
    control.extend(rhs);
    control.push(last);
    let values = knots.values().to_vec();
    Curve::new(3, values, control)
}

/// Solves the symmetric positive system with `a[i][k] = A(i, i − k)`, k ≤ 3, in place.
fn banded_cholesky(a: &mut [[f64; 4]], b: &mut [[f64; 2]]) {
    let m = a.len();
    for i in 0..m {
        for k in (0..=3.min(i)).rev() {
            let j = i - k;
            let mut s = a[i][k];
            for l in 1..=3 {
                // Common earlier columns j − l of rows i and j.
                if l <= j && k + l <= 3 {
                    s -= a[i][k + l] * a[j][l];
                }
            }
            a[i][k] = if k == 0 { s.max(f64::MIN_POSITIVE).sqrt() } else { s / a[j][0] };
        }
        for d in 0..2 {
            let mut s = b[i][d];
            for l in 1..=3.min(i) {
                s -= a[i][l] * b[i - l][d];
            }
            b[i][d] = s / a[i][0];
        }
    }
    for i in (0..m).rev() {
        for d in 0..2 {
            let mut s = b[i][d];
            for l in 1..=3 {
                if i + l < m {
                    s -= a[i + l][l] * b[i + l][d];
                }
            }
            b[i][d] = s / a[i][0];
        }
    }
}

/// The curve `patch(trim(s))` in space as a cubic C¹ spline with the same parameter, within about `tolerance` (mm).
///
/// *Method*: cubic Hermite pieces (exact ends and end derivatives) between the knots of the trimming curve and its
/// crossings of the patch's knot lines, halved until the error at three inner points meets the tolerance.
///
/// # Errors
/// Values that are not finite.
pub fn edge(patch: &Surface, trim: &Curve<2>, tolerance: f64) -> Result<Curve<3>, SplineError> {
    const DEEPEST: usize = 9;
    let eval = |s: f64| {
        let mut q = trim.jet(s);
        // Bit by bit the same ends for neighbouring curves.
        let last = trim.control.len() - 1;
        if s <= 0.0 {
            q[0] = trim.control[0];
        } else if s >= 1.0 {
            q[0] = trim.control[last];
        }
        let j = patch.jet(q[0][0], q[0][1]);
        (j.p, j.du * q[1][0] + j.dv * q[1][1])
    };
    // One-sided derivatives agree: trim and patch are C¹.
    let mut stack: Vec<(f64, f64, usize)> =
        smooth_breaks(patch, trim).windows(2).rev().map(|w| (w[0], w[1], 0)).collect();
    let mut nodes = vec![(0.0, eval(0.0))];
    while let Some((a, b, depth)) = stack.pop() {
        let (pa, pb) = (eval(a), eval(b));
        let h = b - a;
        let worst = [0.25, 0.5, 0.75]
            .into_iter()
            .map(|x: f64| {
                let y = 1.0 - x;
                let p = pa.0 * (y * y * (1.0 + 2.0 * x)) + pa.1 * (h * x * y * y) + pb.0 * (x * x * (1.0 + 2.0 * y))
                    - pb.1 * (h * x * x * y);
                (p - eval(a + x * h).0).norm()
            })
            .fold(0.0, f64::max);
        if worst > tolerance && depth < DEEPEST {
            let m = 0.5 * (a + b);
            stack.push((m, b, depth + 1));
            stack.push((a, m, depth + 1));
        } else {
            nodes.push((b, pb));
        }
    }
    let n = nodes.len() - 1;
    let mut values = vec![0.0; 4];
    let mut control: Vec<[f64; 3]> = vec![nodes[0].1 .0.into()];
    for k in 0..n {
        let (a, b) = (&nodes[k], &nodes[k + 1]);
        let h = b.0 - a.0;
        control.push((a.1 .0 + a.1 .1 * (h / 3.0)).into());
        control.push((b.1 .0 - b.1 .1 * (h / 3.0)).into());
        if k + 1 < n {
            values.extend([b.0; 2]);
        }
    }
    control.push(nodes[n].1 .0.into());
    values.extend([nodes[n].0; 4]);
    Curve::new(3, values, control)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    fn bilinear() -> Surface {
        let k = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let p = [(0., 0.), (0., 50.), (100., 0.), (100., 50.)].map(|(x, y)| Vec3::new(x, y, 0.0));
        Surface::new(k.clone(), k, &p, None).expect("surface")
    }

    fn waypoints(n: usize, f: impl Fn(f64) -> [f64; 2]) -> Vec<Waypoint> {
        (0..=n).map(|i| i as f64 / n as f64).map(|s| Waypoint { s, place: f(s), allowance: 1e-3 }).collect()
    }

    #[test]
    fn smooth_feet_get_few_knots_and_exact_ends() {
        let f = |s: f64| [0.1 + 0.8 * s, 0.5 + 0.3 * (3.0 * s).sin()];
        let w = waypoints(80, f);
        let t = trim(&bilinear(), w.clone(), |_, _| None).expect("a curve");
        assert!(t.deviation_estimate <= 1e-3);
        assert!(t.curve.control.len() <= 20, "{} control points", t.curve.control.len());
        assert!(t.curve.point(0.0) == f(0.0) && t.curve.point(1.0) == f(1.0));
        // A straight line needs one span.
        let line = trim(&bilinear(), waypoints(20, |s| [s, 0.2 + 0.1 * s]), |_, _| None).expect("a line");
        assert_eq!(line.curve.control.len(), 4);
        assert!(line.deviation_estimate < 1e-9);
    }

    #[test]
    fn the_edge_follows_the_patch() {
        let k = Knots::clamped(3, &[0.0, 0.3, 1.0]).expect("knots");
        let v = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let mut p = Vec::new();
        for i in 0..5 {
            for j in 0..2 {
                p.push(Vec3::new(20.0 * f64::from(i), 30.0 * f64::from(j), f64::from(i * i % 7)));
            }
        }
        let s = Surface::new(k, v, &p, None).expect("surface");
        let t = trim(&s, waypoints(60, |s| [0.05 + 0.9 * s * s, 0.5 + 0.3 * (2.0 * s).cos()]), |_, _| None)
            .expect("a curve");
        let e = edge(&s, &t.curve, 1e-6).expect("an edge");
        for i in 0..=500 {
            let x = f64::from(i) / 500.0;
            let q = t.curve.point(x);
            assert!((Vec3::from(e.point(x)) - s.point(q[0], q[1])).norm() < 2e-6);
        }
    }
}
