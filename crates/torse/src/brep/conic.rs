//! Conic arcs: from the coefficients of an equation to axes (docs/algorithms/reading.md).

use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::geom::{Frame, Vec3};
use std::f64::consts::TAU;

/// Eigenvalues below this share of the larger one are zero: the equation is that of a parabola.
const PARABOLIC: f64 = 1e-9;
/// Arcs below this angle are whole ellipses whose ends were rounded apart.
pub(crate) const WHOLE_TURN: f64 = 1e-6;

/// The arc from `start` to `end` on `A x² + B x y + C y² + D x + E y + F = 0` at the height `z`; `None` if the equation
/// is that of no conic.
pub fn arc(k: &[f64], z: f64, start: [f64; 2], end: [f64; 2]) -> Option<Arc> {
    let [a, b, c, d, e, f] = *k else { return None };
    // Axes that have no mixed term.
    let angle = 0.5 * b.atan2(a - c);
    let (sin, cos) = angle.sin_cos();
    let l1 = a * cos * cos + b * sin * cos + c * sin * sin;
    let l2 = a * sin * sin - b * sin * cos + c * cos * cos;
    let x = Vec3::new(cos, sin, 0.0);
    let y = Vec3::new(-sin, cos, 0.0);
    // Linear terms along the axes.
    let (g1, g2) = (d * cos + e * sin, e * cos - d * sin);
    let at = |u: f64, v: f64| x * u + y * v + Vec3::new(0.0, 0.0, z);
    let largest = l1.abs().max(l2.abs());
    if l1.abs().min(l2.abs()) <= PARABOLIC * largest {
        return if l1.abs() <= l2.abs() {
            parabola([l2, g1, g2, f], [x, y], z, start, end)
        } else {
            parabola([l1, g2, -g1, f], [y, -x], z, start, end)
        };
    }
    let (u0, v0) = (-0.5 * g1 / l1, -0.5 * g2 / l2);
    let rest = f - l1 * u0 * u0 - l2 * v0 * v0;
    let (p, q) = (-rest / l1, -rest / l2);
    let origin = at(u0, v0);
    let local = |s: [f64; 2], f: &Frame| f.to_local(&Vec3::new(s[0], s[1], z));
    if p > 0.0 && q > 0.0 {
        let frame = Frame { origin, x, y, z: Vec3::z() };
        let (a, b) = (p.sqrt(), q.sqrt());
        let turn = |s: [f64; 2]| {
            let l = local(s, &frame);
            (l.y / b).atan2(l.x / a)
        };
        let from = turn(start);
        let way = (turn(end) - from).rem_euclid(TAU);
        let to = from + if way < WHOLE_TURN { TAU } else { way };
        return Some(Arc { curve: SpaceCurve::Ellipse { frame, a, b }, from, to });
    }
    let (mut frame, a, b) = match (p > 0.0, q > 0.0) {
        (true, false) => (Frame { origin, x, y, z: Vec3::z() }, p.sqrt(), (-q).sqrt()),
        (false, true) => (Frame { origin, x: y, y: -x, z: Vec3::z() }, q.sqrt(), (-p).sqrt()),
        _ => return None,
    };
    if local(start, &frame).x < 0.0 {
        (frame.x, frame.y) = (-frame.x, -frame.y);
    }
    let parameter = |s: [f64; 2]| (local(s, &frame).y / b).asinh();
    let (from, to) = (parameter(start), parameter(end));
    Some(Arc { curve: SpaceCurve::Hyperbola { frame, a, b }, from, to })
}

/// `l y² + g1 x + g2 y + f = 0` along the axes given.
fn parabola([l, g1, g2, f]: [f64; 4], axes: [Vec3; 2], z: f64, start: [f64; 2], end: [f64; 2]) -> Option<Arc> {
    if g1 == 0.0 || l == 0.0 {
        return None;
    }
    let v0 = -0.5 * g2 / l;
    let u0 = -(f - l * v0 * v0) / g1;
    let mut focal = -0.25 * g1 / l;
    let [mut x, mut y] = axes;
    let origin = x * u0 + y * v0 + Vec3::new(0.0, 0.0, z);
    if focal < 0.0 {
        (x, y, focal) = (-x, -y, -focal);
    }
    let frame = Frame { origin, x, y, z: x.cross(&y) };
    let parameter = |s: [f64; 2]| 0.5 * frame.to_local(&Vec3::new(s[0], s[1], z)).y / focal;
    let (from, to) = (parameter(start), parameter(end));
    Some(Arc { curve: SpaceCurve::Parabola { frame, focal }, from, to })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_conic_satisfies_its_equation() {
        let cases: [([f64; 6], [f64; 2], [f64; 2]); 6] = [
            ([1.0, 0.0, 4.0, 0.0, 0.0, -4.0], [2.0, 0.0], [0.0, 1.0]),
            ([5.0, 4.0, 8.0, -2.0, 1.0, -30.0], [0.0, 0.0], [0.0, 0.0]),
            ([1.0, 0.0, -1.0, 0.0, 0.0, -1.0], [-2.0, 3f64.sqrt()], [-1.0, 0.0]),
            ([1.0, 0.0, -1.0, 0.0, 0.0, 1.0], [0.0, 1.0], [3f64.sqrt(), 2.0]),
            ([0.0, 0.0, 1.0, -4.0, 0.0, 0.0], [0.0, 0.0], [1.0, 2.0]),
            ([1.0, 0.0, 0.0, 0.0, 2.0, -3.0], [1.0, 1.0], [3.0, -3.0]),
        ];
        for (k, start, end) in cases {
            let arc = arc(&k, 7.0, start, end).expect("a conic");
            for i in 0..=8 {
                let p = arc.curve.point(arc.from + (arc.to - arc.from) * f64::from(i) / 8.0);
                let value = k[0] * p.x * p.x + k[1] * p.x * p.y + k[2] * p.y * p.y + k[3] * p.x + k[4] * p.y + k[5];
                assert!(value.abs() < 1e-9 && (p.z - 7.0).abs() < 1e-12, "{k:?}: {value:e} at {p:?}");
            }
            let ends = arc.ends();
            // The second case has ends off the curve, which only say that it is a whole ellipse.
            let far = (ends.0 - Vec3::new(start[0], start[1], 7.0)).norm();
            assert!(far < 1e-9 || start == end, "{k:?}: {far}");
        }
        assert!(arc(&[1.0, 0.0, 1.0, 0.0, 0.0, 1.0], 0.0, [0.0; 2], [0.0; 2]).is_none());
        assert!(arc(&[0.0; 6], 0.0, [0.0; 2], [0.0; 2]).is_none());
    }
}
