//! The same face with its parameter plane turned: u and v exchanged, or one of them run backwards; control points and
//! knots change places, as blossoms do \[R89\].

use crate::brep::face::{Face, TrimLoop};

/// The loop under a map of the parameter plane that turns orientation round: run the other way, so that it keeps its
/// sense.
fn turned_loop(l: &TrimLoop, map: impl Fn([f64; 2]) -> [f64; 2]) -> TrimLoop {
    let n = l.points.len();
    TrimLoop {
        points: l.points.iter().rev().map(|&p| map(p)).collect(),
        edge: (0..n).map(|k| l.edge[(2 * n - 2 - k) % n]).collect(),
    }
}

/// `a + b − x`, with the ends of the range exact.
fn mirrored(x: f64, (a, b): (f64, f64)) -> f64 {
    if x <= a {
        b
    } else if x >= b {
        a
    } else {
        (a + (b - x)).clamp(a, b)
    }
}

/// The face with u and v exchanged.
pub(super) fn transposed(face: &Face) -> Face {
    let mut out = face.clone();
    out.surface = face.surface.transposed();
    out.reversed = !face.reversed;
    out.loops = face.loops.iter().map(|l| turned_loop(l, |p| [p[1], p[0]])).collect();
    out
}

/// The face with u run backwards on the same domain.
pub(super) fn reversed_u(face: &Face) -> Face {
    let range = face.surface.knots_u.domain();
    let mut out = face.clone();
    out.surface = face.surface.reversed_u();
    out.reversed = !face.reversed;
    out.loops = face.loops.iter().map(|l| turned_loop(l, |p| [mirrored(p[0], range), p[1]])).collect();
    out
}

/// The face with v run backwards on the same domain.
pub(super) fn reversed_v(face: &Face) -> Face {
    transposed(&reversed_u(&transposed(face)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    #[test]
    fn turned_faces_keep_points_normals_and_edges() {
        let k = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let points = [Vec3::zeros(), Vec3::y(), Vec3::x(), Vec3::new(1.0, 1.0, 0.3)];
        let face = Face::untrimmed(Surface::new(k.clone(), k, &points, None).expect("a surface"));
        type Map = fn(f64, f64) -> (f64, f64);
        let cases: [(Face, Map); 3] = [
            (transposed(&face), |u, v| (v, u)),
            (reversed_u(&face), |u, v| (1.0 - u, v)),
            (reversed_v(&face), |u, v| (u, 1.0 - v)),
        ];
        let side = |f: &Face, edge: u32| {
            let l = &f.loops[0];
            let k = l.edge.iter().position(|&e| e == edge).expect("edge");
            let (p, q) = (l.points[k], l.points[(k + 1) % l.points.len()]);
            f.surface.point(0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]))
        };
        for (turned, map) in &cases {
            let (u, v) = map(0.3, 0.6);
            assert!((turned.surface.point(u, v) - face.surface.point(0.3, 0.6)).norm() < 1e-15);
            let (m, n) = (turned.surface.jet(u, v).normal(), face.surface.jet(0.3, 0.6).normal());
            assert!((m + n).norm() < 1e-14 && turned.reversed);
            for e in 0..4 {
                assert!((side(turned, e) - side(&face, e)).norm() < 1e-15, "edge {e}");
            }
            let p = &turned.loops[0].points;
            let area: f64 = (0..4).map(|i| p[i][0] * p[(i + 1) % 4][1] - p[i][1] * p[(i + 1) % 4][0]).sum();
            assert!(area > 0.0);
        }
    }
}
