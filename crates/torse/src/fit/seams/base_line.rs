//! Base lines of seams: level lines of a function on a surface with what theory asks about them, traced beyond the
//! region by arc length.
//!
//! *Method*: \[SE06\]; midpoint steps along the level line, each followed by Newton steps back onto the level, on the
//! second-order Taylor extension of the surface outside its domain.

use crate::geom::Vec3;
use crate::spline::field::Field;
use crate::spline::surface::Surface;

/// A point of a base line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BasePoint {
    /// Arc length from the seed, mm.
    pub s: f64,
    /// Position, mm.
    pub x: Vec3,
    /// Unit normal of the surface.
    pub n: Vec3,
    /// Unit direction of the ruling (conjugate to the line), towards higher levels.
    pub ruling: Vec3,
    /// Normal curvature of the surface along the ruling, 1/mm, with the sign that `n` gives it.
    pub curvature: f64,
    /// Increase of the level along the ruling, per mm.
    pub slope: f64,
    /// Cosine of the angle between line and ruling.
    pub lean: f64,
}

/// A level line with points in order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BaseLine {
    /// Points with increasing `s`.
    pub points: Vec<BasePoint>,
    /// Range of `s` inside the region.
    pub inside: (f64, f64),
}

impl BaseLine {
    /// The point with the nearest `s`.
    pub fn near(&self, s: f64) -> &BasePoint {
        let k = self.points.partition_point(|p| p.s < s).min(self.points.len() - 1);
        let before = k.saturating_sub(1);
        if s - self.points[before].s < self.points[k].s - s {
            &self.points[before]
        } else {
            &self.points[k]
        }
    }

    /// Points inside the region.
    pub fn inner(&self) -> impl Iterator<Item = &BasePoint> {
        let (a, b) = self.inside;
        self.points.iter().filter(move |p| p.s >= a && p.s <= b)
    }
}

/// Steps of a trace over the length inside the region.
const STEPS: f64 = 220.0;
/// Steps at most.
const MOST_STEPS: usize = 2000;
/// Newton steps back onto the level.
const BACK: usize = 4;

/// Traces the level line of `field` through `seed`: `inside` lengths (backwards, forwards; mm) in the region, and
/// `beyond` (mm) more on each side. Forwards is where higher levels lie on the right in the (u, v) plane. `None` where
/// surface or level function degenerate, or the line is its own conjugate (asymptotic).
pub(crate) fn base_line(
    surface: &Surface,
    field: &Field,
    seed: [f64; 2],
    inside: (f64, f64),
    beyond: [f64; 2],
) -> Option<BaseLine> {
    let level = field.value(seed);
    let step = (inside.0 + inside.1) / STEPS;
    if !(step > 0.0 && step.is_finite()) {
        return None;
    }
    let mut halves: [Vec<BasePoint>; 2] = [Vec::new(), Vec::new()];
    for (half, (sign, length)) in halves.iter_mut().zip([(-1.0, inside.0 + beyond[0]), (1.0, inside.1 + beyond[1])]) {
        let count = ((length / step).ceil() as usize).clamp(1, MOST_STEPS);
        let step = length / count as f64;
        let mut p = seed;
        let mut s = 0.0;
        half.push(point(surface, field, p, s)?);
        for _ in 0..count {
            let middle = advance(surface, field, p, 0.5 * step * sign, p)?;
            p = advance(surface, field, p, step * sign, middle)?;
            for _ in 0..BACK {
                let [f, fu, fv] = field_jet(field, p[0], p[1]);
                let g = fu * fu + fv * fv;
                if g <= 0.0 {
                    return None;
                }
                p = [p[0] + (level - f) / g * fu, p[1] + (level - f) / g * fv];
            }
            let mut next = point(surface, field, p, 0.0)?;
            s += sign * (next.x - half[half.len() - 1].x).norm();
            next.s = s;
            half.push(next);
        }
    }
    let [mut points, ahead] = halves;
    points.reverse();
    points.extend(&ahead[1..]);
    // Steps of a curve that turns back on itself are no line.
    points.windows(2).all(|w| w[1].s > w[0].s).then_some(BaseLine { points, inside: (-inside.0, inside.1) })
}

/// Value and gradient of a level function, with its second-order Taylor polynomial outside its rectangle: a tangent plane
/// there would bend level lines at the border.
fn field_jet(field: &Field, u: f64, v: f64) -> [f64; 3] {
    let ((u0, u1), (v0, v1)) = (field.knots_u.domain(), field.knots_v.domain());
    let (cu, cv) = (u.clamp(u0, u1), v.clamp(v0, v1));
    let (a, b) = (u - cu, v - cv);
    if a == 0.0 && b == 0.0 {
        return field.jet(u, v);
    }
    let (bu, bv) = (field.knots_u.basis(cu, 2), field.knots_v.basis(cv, 2));
    let n = field.knots_v.control_count();
    // Derivatives of order i in u and j in v.
    let partial = |i: usize, j: usize| -> f64 {
        let sum = |k: usize| {
            let row = &field.coefficients[(bu.first + k) * n + bv.first..];
            (0..=field.knots_v.degree()).map(|l| bv.rows[j][l] * row[l]).sum::<f64>()
        };
        (0..=field.knots_u.degree()).map(|k| bu.rows[i][k] * sum(k)).sum()
    };
    let (f, fu, fv) = (partial(0, 0), partial(1, 0), partial(0, 1));
    let (fuu, fuv, fvv) = (partial(2, 0), partial(1, 1), partial(0, 2));
    [
        f + fu * a + fv * b + 0.5 * (fuu * a * a + fvv * b * b) + fuv * a * b,
        fu + fuu * a + fuv * b,
        fv + fuv * a + fvv * b,
    ]
}

/// From `p` a step of `length` (mm) along the level line's direction at `at`.
fn advance(surface: &Surface, field: &Field, p: [f64; 2], length: f64, at: [f64; 2]) -> Option<[f64; 2]> {
    let j = surface.extended_jet(at[0], at[1]);
    let [_, fu, fv] = field_jet(field, at[0], at[1]);
    let speed = (j.du * fv - j.dv * fu).norm();
    (speed > 0.0 && speed.is_finite()).then(|| [p[0] + length * fv / speed, p[1] - length * fu / speed])
}

/// Sine between parameter lines below which the parametrisation is taken as degenerate.
const DEGENERATE: f64 = 1e-9;

/// Normal, conjugate direction and curvature at a point of the level line.
fn point(surface: &Surface, field: &Field, p: [f64; 2], s: f64) -> Option<BasePoint> {
    let j = surface.extended_jet(p[0], p[1]);
    let n = j.normal();
    if n.norm() <= DEGENERATE * j.du.norm() * j.dv.norm() {
        return None;
    }
    let n = n.normalize();
    let (l, m, k) = (n.dot(&j.duu), n.dot(&j.duv), n.dot(&j.dvv));
    let [_, fu, fv] = field_jet(field, p[0], p[1]);
    // T = (φ_v, −φ_u); the conjugate (a, b) solves II(T, (a, b)) = 0.
    let (a, b) = (m * fv - k * fu, -(l * fv - m * fu));
    let up = (fu * a + fv * b).signum();
    let (a, b) = (a * up, b * up);
    let ruling = j.du * a + j.dv * b;
    let size = ruling.norm();
    let along = j.du * fv - j.dv * fu;
    let slope = (fu * a + fv * b) / size;
    (size > 0.0 && slope > 0.0 && slope.is_finite()).then(|| BasePoint {
        s,
        x: j.p,
        n,
        ruling: ruling / size,
        curvature: (l * a * a + 2.0 * m * a * b + k * b * b) / (size * size),
        slope,
        lean: (ruling / size).dot(&along) / along.norm(),
    })
}
