//! The developable surface that connects two curves, and its dual spline.
//!
//! *Method.* The ruling from `A(u)` ends where `det(A'(u), B'(v), B(v) − A(u)) = 0`: there both ends have the same
//! tangent plane (\[W15, 5.2\]). One root in the middle is chosen by the expected ruling; the others follow by
//! continuation. The planes are fitted by a cubic spline in the mean of normalised arc length and Gauss length.
//! Departure: continuation in place of a scan per ruling.

use crate::geom::Vec3;
use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::torse::form::DualTorse;

/// A ruling between two seams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConnectingRuling {
    /// Parameter on the lower seam.
    pub u: f64,
    /// Parameter on the upper seam.
    pub v: f64,
    /// End on the lower seam.
    pub a: Vec3,
    /// End on the upper seam.
    pub b: Vec3,
    /// Unit normal of the common tangent plane.
    pub n: Vec3,
    /// Angle between the tangent planes at both ends, rad: rounding only.
    pub twist: f64,
}

/// Cells of the scan for the first ruling.
const SCAN: usize = 322;
/// Newton steps for one ruling.
const STEPS: usize = 12;
/// Steps end below this share of the upper seam's length.
const SETTLED: f64 = 1e-14;
/// Largest twist of a ruling, rad: larger ones are rulings of nothing.
const LARGEST_TWIST: f64 = 1e-9;

/// Position and first two derivatives.
fn jet(c: &Curve<3>, t: f64) -> [Vec3; 3] {
    c.jet(t).map(Vec3::from)
}

/// Rulings of the developable that connects two curves, with increasing parameters on both: as many of `count` equally
/// spaced ones on the lower curve as form one regular stretch around the ruling that leaves `lower(u0)` in about the
/// direction `ruling`. `None` where there is no such ruling, or the stretch has fewer than eight.
pub(crate) fn connecting(
    lower: &Curve<3>,
    upper: &Curve<3>,
    u0: f64,
    ruling: &Vec3,
    normal: &Vec3,
    count: usize,
) -> Option<Vec<ConnectingRuling>> {
    let ((ua, ub), (va, vb)) = (lower.domain(), upper.domain());
    let du = (ub - ua) / (count.max(2) - 1) as f64;
    // 1. The first ruling.
    let [a, a1, _] = jet(lower, u0);
    let node = |i: usize| va + (vb - va) * i as f64 / SCAN as f64;
    let f = |v: f64| {
        let [b, b1, _] = jet(upper, v);
        a1.cross(&b1).dot(&(b - a))
    };
    let off = |v: f64| {
        let d = Vec3::from(upper.point(v)) - a;
        (d - ruling * d.dot(ruling)).norm()
    };
    let wanted = (0..=SCAN).map(node).min_by(|x, y| off(*x).total_cmp(&off(*y)))?;
    let values: Vec<f64> = (0..=SCAN).map(|i| f(node(i))).collect();
    let v0 = (0..SCAN)
        .filter(|&i| values[i] * values[i + 1] <= 0.0 && values[i] != values[i + 1])
        .map(|i| node(i) + (node(i + 1) - node(i)) * values[i] / (values[i] - values[i + 1]))
        .min_by(|x, y| (x - wanted).abs().total_cmp(&(y - wanted).abs()))?;
    let start = solved(lower, upper, u0, v0, normal)?;
    // 2. The others, both ways.
    let mut all = vec![start.0];
    for sign in [-1.0, 1.0] {
        let (mut here, mut speed) = start;
        let mut normal = here.n;
        for k in 1..count {
            let u = u0 + sign * du * k as f64;
            if !(u >= ua && u <= ub) {
                break;
            }
            let v = here.v + speed * (u - here.u);
            let Some((next, s)) = solved(lower, upper, u, v, &normal) else { break };
            // The branch must go on: no jump, no return.
            if (next.v - v).abs() > 0.5 * (speed * du).abs() || s <= 0.0 {
                break;
            }
            (here, speed, normal) = (next, s, next.n);
            all.push(next);
        }
        if sign < 0.0 {
            all.reverse();
        }
    }
    (all.len() >= 8).then_some(all)
}

/// The ruling from `lower(u)` near `upper(v)` and dv/du there.
fn solved(lower: &Curve<3>, upper: &Curve<3>, u: f64, mut v: f64, normal: &Vec3) -> Option<(ConnectingRuling, f64)> {
    let (va, vb) = upper.domain();
    let [a, a1, a2] = jet(lower, u);
    for _ in 0..STEPS {
        let [b, b1, b2] = jet(upper, v);
        let r = b - a;
        let (f, fv) = (a1.cross(&b1).dot(&r), a1.cross(&b2).dot(&r));
        let step = -f / fv;
        if !step.is_finite() {
            return None;
        }
        v += step;
        if !(v >= va && v <= vb) {
            return None;
        }
        if step.abs() <= SETTLED * (vb - va) {
            break;
        }
    }
    let [b, b1, b2] = jet(upper, v);
    let r = b - a;
    let (na, nb) = (a1.cross(&r), b1.cross(&r));
    let size = na.norm() * nb.norm();
    let twist = na.cross(&nb).norm().atan2(na.dot(&nb));
    if !(size > 0.0 && twist < LARGEST_TWIST) {
        return None;
    }
    let mean = (na.normalize() + nb.normalize()).normalize();
    let n = if mean.dot(normal) < 0.0 { -mean } else { mean };
    let speed = -a2.cross(&b1).dot(&r) / a1.cross(&b2).dot(&r);
    speed.is_finite().then_some((ConnectingRuling { u, v, a, b, n, twist }, speed))
}

/// The dual cubic spline nearest to the planes of rulings, and the parameter of each of them.
///
/// *Input*: at least eight rulings; `spans` at least 4, fewer than rulings. `None` for planes that do not turn.
pub fn refit(rulings: &[ConnectingRuling], spans: usize) -> Option<(DualTorse, Vec<f64>)> {
    let middle = |r: &ConnectingRuling| (r.a + r.b) * 0.5;
    let mut sums = vec![(0.0, 0.0)];
    for w in rulings.windows(2) {
        let (s, g) = sums[sums.len() - 1];
        sums.push((s + (middle(&w[1]) - middle(&w[0])).norm(), g + (w[1].n - w[0].n).norm()));
    }
    let (length, turn) = sums[sums.len() - 1];
    if !(length > 0.0 && turn > 0.0 && (length + turn).is_finite()) || rulings.len() < 8 {
        return None;
    }
    let parameters: Vec<f64> = sums.iter().map(|(s, g)| (0.5 * (s / length + g / turn)).min(1.0)).collect();
    // Around their own middle the planes have small fourth coordinates.
    let origin = rulings.iter().map(middle).sum::<Vec3>() / rulings.len() as f64;
    let knots = Knots::uniform(3, spans.clamp(4, rulings.len() / 2), 0.0, 1.0).ok()?;
    let n = knots.control_count();
    let mut rows = Rows::new(n, 4);
    let mut matrix = BandMatrix::zeros(n, 4);
    let mut right = vec![vec![0.0; n]; 4];
    for (i, (r, &t)) in rulings.iter().zip(&parameters).enumerate() {
        let b = knots.basis(t, 0);
        rows.push(b.first).1.copy_from_slice(&b.rows[0][..4]);
        // The ends count more: little else holds them.
        let weight = if i == 0 || i + 1 == rulings.len() { END_WEIGHT } else { 1.0 };
        matrix.add_row(&rows, i, weight);
        let h = 0.5 * (r.n.dot(&(r.a - origin)) + r.n.dot(&(r.b - origin)));
        for (out, value) in right.iter_mut().zip([r.n.x, r.n.y, r.n.z, h]) {
            rows.scatter(i, value * weight, out);
        }
    }
    if !matrix.factorise() {
        return None;
    }
    for r in &mut right {
        matrix.solve(r);
    }
    let control = (0..n)
        .map(|i| {
            let [x, y, z, h] = [0, 1, 2, 3].map(|c: usize| right[c][i]);
            [x, y, z, h + Vec3::new(x, y, z).dot(&origin)]
        })
        .collect();
    let planes = Curve::new(3, knots.values().to_vec(), control).ok()?;
    Some((DualTorse { planes }, parameters))
}

/// Weight of the first and last plane.
const END_WEIGHT: f64 = 4.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::lsq;
    use crate::torse::form::Torse;

    /// Arc of a circle with radius r about the z-axis at height z, by angle.
    fn arc(r: f64, z: f64) -> Curve<3> {
        let angles: Vec<f64> = (0..=400).map(|i| f64::from(i) / 400.0).collect();
        let points: Vec<[f64; 3]> = angles.iter().map(|a| [r * a.cos(), r * a.sin(), z]).collect();
        lsq::fit(&points, &angles, &Knots::uniform(5, 20, 0.0, 1.0).expect("knots")).expect("a curve").curve
    }

    fn cone(a: &Curve<3>, b: &Curve<3>) -> Vec<ConnectingRuling> {
        let start = jet(a, 0.5)[0];
        let direction = (jet(b, 0.5)[0] - start).normalize();
        connecting(a, b, 0.5, &direction, &Vec3::new(start.x, start.y, 0.0).normalize(), 241).expect("rulings")
    }

    #[test]
    fn equal_parallel_circles_are_joined_by_a_cylinder() {
        let found = cone(&arc(100.0, 0.0), &arc(100.0, 30.0));
        assert_eq!(found.len(), 241);
        for r in &found {
            assert!((r.u - r.v).abs() < 1e-9 && r.twist < 1e-9);
            assert!((r.b - r.a - Vec3::z() * 30.0).norm() < 1e-6);
        }
    }

    #[test]
    fn unequal_circles_are_joined_by_a_cone_that_the_spline_follows() {
        let (a, b) = (arc(100.0, 0.0), arc(80.0, 30.0));
        let found = cone(&a, &b);
        assert!(found.iter().all(|r| (r.u - r.v).abs() < 1e-9 && r.twist < 1e-9));
        // The error of the spline falls by the fourth power of the number of spans.
        let worst = |spans: usize| {
            let (torse, parameters) = refit(&found, spans).expect("planes");
            let torse = Torse::Dual(torse);
            let off = |x: Vec3, t: f64| torse.foot(&x, t).map_or(f64::NAN, |t| torse.plane_distance(&x, t).abs());
            let inner = || found.iter().zip(&parameters).skip(4).step_by(3).take(76);
            inner().map(|(r, &t)| off(r.a, t).max(off(r.b, t))).fold(0.0, f64::max)
        };
        let (coarse, fine) = (worst(15), worst(60));
        assert!(fine < 1e-5 && fine < coarse / 50.0, "{coarse} {fine}");
    }

    #[test]
    fn curves_without_common_tangent_planes_have_no_rulings() {
        let line = |y: f64, d: [f64; 3]| {
            let end = [d[0], y + d[1], d[2]];
            Curve::new(1, vec![0., 0., 1., 1.], vec![[0.0, y, 0.0], end]).expect("a line")
        };
        let (a, b) = (line(0.0, [10.0, 0.0, 0.0]), line(5.0, [10.0, 0.0, 10.0]));
        assert!(connecting(&a, &b, 0.5, &Vec3::y(), &Vec3::z(), 50).is_none());
    }
}
