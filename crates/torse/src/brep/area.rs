//! Area of a trimmed face by quadrature.

use super::face::Face;
use super::raw::RawLoop;
use crate::geom::Vec3;
use crate::num::quadrature::GAUSS_8;
use crate::spline::knots::Knots;

/// Area of the face in space, mm², by Green's theorem in the parameter plane, so that holes subtract themselves: `∮ F dv`
/// with `F(u, v) = ∫_{u₀}^{u} |S_u × S_v| du` and `u₀` the left end of the loops; eight Gauss points on each quarter of a
/// knot span in both directions. An estimate: exact to rounding only where the integrand is smooth.
pub fn area_estimate(face: &Face) -> f64 {
    integral(face, &|u, v| face.surface.jet(u, v).normal().norm())
}

/// What the absolute Gaussian curvature of a face adds up to, by the same quadrature: 4π on a whole sphere, 8π on a torus.
pub(crate) fn total_curvature_estimate(face: &Face) -> f64 {
    let density = |u: f64, v: f64| {
        let jet = face.surface.jet(u, v);
        let normal = jet.normal();
        let [l, m, n] = jet.second_form(&normal);
        let cube = normal.norm().powi(3);
        // Poles have no curvature of their own.
        if cube > 0.0 {
            (l * n - m * m).abs() / cube
        } else {
            0.0
        }
    };
    integral(face, &density)
}

/// The integral of a density of the parameter plane over a face.
fn integral(face: &Face, density: &dyn Fn(f64, f64) -> f64) -> f64 {
    let s = &face.surface;
    let (bu, bv) = (breaks(&s.knots_u), breaks(&s.knots_v));
    // Nothing to the left of the loops is integrated.
    let start = face.loops.iter().flat_map(|l| &l.points).map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let inner = |u: f64, v: f64| -> f64 {
        let spans = bu.windows(2).map(|w| (w[0].max(start), w[1].min(u))).filter(|(a, b)| a < b);
        spans.map(|(a, b)| GAUSS_8.integrate(a, b, |x| density(x, v))).sum()
    };
    let mut total = 0.0;
    for l in &face.loops {
        let n = l.points.len();
        for i in 0..n {
            for (p, q) in pieces(l.points[i], l.points[(i + 1) % n], &bu, &bv) {
                let (du, dv) = (q[0] - p[0], q[1] - p[1]);
                if dv.abs() > 0.0 {
                    total += dv * GAUSS_8.integrate(0.0, 1.0, |x| inner(p[0] + x * du, p[1] + x * dv));
                }
            }
        }
    }
    total
}

/// Share of the square of its length below which the area that a boundary spans says nothing about its face: the two
/// circles of a tube span none, nor does a boundary that runs back along itself.
const FLAT_SHARE: f64 = 1e-3;

/// Area (mm²) that oriented boundary loops span: the length of their vector area `½ ∮ x × dx`, exact for plane faces, too
/// small for curved ones. `None` where it says nothing.
pub(crate) fn spanned_area_estimate(loops: &[RawLoop]) -> Option<f64> {
    let mut points: Vec<Vec<Vec3>> = Vec::new();
    for l in loops {
        let mut own = Vec::new();
        for arc in l.edges.iter().flat_map(|e| &e.path) {
            // Chords of an eighth of a span.
            for w in arc.curve.stations(arc.from, arc.to).windows(2) {
                own.extend((0..8).map(|i| arc.curve.point(w[0] + (w[1] - w[0]) * f64::from(i) / 8.0)));
            }
        }
        points.push(own);
    }
    let origin = *points.iter().flatten().next()?;
    let (mut area, mut length) = (Vec3::zeros(), 0.0);
    for own in &points {
        for (i, p) in own.iter().enumerate() {
            let q = own[(i + 1) % own.len()];
            area += 0.5 * (p - origin).cross(&(q - origin));
            length += (q - p).norm();
        }
    }
    let area = area.norm();
    (area > FLAT_SHARE * length * length && area.is_finite()).then_some(area)
}

/// Knot spans, the long ones halved twice: rational pieces are not polynomials.
fn breaks(k: &Knots) -> Vec<f64> {
    let b = k.breaks();
    let mut out: Vec<f64> =
        b.windows(2).flat_map(|w| (0..4).map(move |i| w[0] + (w[1] - w[0]) * f64::from(i) / 4.0)).collect();
    out.extend(b.last());
    out
}

/// A side cut where it crosses lines of the grid.
fn pieces(a: [f64; 2], b: [f64; 2], us: &[f64], vs: &[f64]) -> Vec<([f64; 2], [f64; 2])> {
    let mut cuts = vec![0.0, 1.0];
    for (k, lines) in [(0, us), (1, vs)] {
        let d = b[k] - a[k];
        if d.abs() > 0.0 {
            cuts.extend(lines.iter().map(|x| (x - a[k]) / d).filter(|s| *s > 0.0 && *s < 1.0));
        }
    }
    cuts.sort_by(f64::total_cmp);
    let at = |s: f64| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
    cuts.windows(2).map(|w| (at(w[0]), at(w[1]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::TrimLoop;
    use crate::brep::support_surface::SupportSurface;
    use crate::geom::Frame;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    #[test]
    fn area_of_a_sphere() {
        let sphere = SupportSurface::Sphere { frame: Frame::world(), radius: 3.0 };
        let (s, _) = sphere.to_spline((0.0, TAU), (-FRAC_PI_2, FRAC_PI_2)).expect("a sphere");
        assert!((area_estimate(&Face::untrimmed(s)) / (36.0 * PI) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn holes_subtract_themselves() {
        let tube = SupportSurface::Cylinder { frame: Frame::world(), radius: 2.0 };
        let (s, _) = tube.to_spline((0.0, PI), (0.0, 3.0)).expect("a cylinder");
        let mut face = Face::untrimmed(s);
        let ((u0, u1), (v0, v1)) = face.surface.domain();
        let at = |x: f64, y: f64| [u0 + x * (u1 - u0), v0 + y * (v1 - v0)];
        let whole = area_estimate(&face);
        assert!((whole / (6.0 * PI) - 1.0).abs() < 1e-12);
        // A slanted triangle, clockwise as a hole and counter-clockwise as a face of its own.
        let mut points = vec![at(0.2, 0.2), at(0.4, 0.8), at(0.8, 0.3)];
        face.loops.push(TrimLoop { points: points.clone(), edge: vec![4, 5, 6] });
        let rest = area_estimate(&face);
        points.reverse();
        face.loops = vec![TrimLoop { points, edge: vec![0, 1, 2] }];
        let cut = area_estimate(&face);
        assert!(cut > 0.5 && (whole - rest - cut).abs() < 1e-12 * whole);
    }
}
