//! Area of a trimmed face by quadrature.

use super::face::Face;
use crate::spline::knots::Knots;

/// Nodes and weights of Gauss–Legendre quadrature with 6 points on [0, 1].
const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
    (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_55, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_17),
];

/// Area of the face in space, mm², by Green's theorem in the parameter plane: `∮ F dv` with
/// `F(u, v) = ∫_{u₀}^{u} |S_u × S_v| du`, six Gauss points per knot span in each direction. An estimate: exact to
/// rounding only where the integrand is smooth.
pub fn area_estimate(face: &Face) -> f64 {
    let s = &face.surface;
    let (bu, bv) = (breaks(&s.knots_u), breaks(&s.knots_v));
    let inner = |u: f64, v: f64| -> f64 {
        let mut sum = 0.0;
        for w in bu.windows(2) {
            let b = w[1].min(u);
            if b <= w[0] {
                break;
            }
            let h = b - w[0];
            sum += GAUSS.iter().map(|(x, k)| k * h * s.jet(w[0] + x * h, v).normal().norm()).sum::<f64>();
        }
        sum
    };
    let mut total = 0.0;
    for l in &face.loops {
        let n = l.points.len();
        for i in 0..n {
            let (a, b) = (l.points[i], l.points[(i + 1) % n]);
            for (p, q) in pieces(a, b, &bu, &bv) {
                let dv = q[1] - p[1];
                if dv.abs() > 0.0 {
                    total +=
                        GAUSS.iter().map(|(x, k)| k * dv * inner(p[0] + x * (q[0] - p[0]), p[1] + x * dv)).sum::<f64>();
                }
            }
        }
    }
    total
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
    use crate::geom::Frame;
    use crate::spline::carrier::Carrier;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    #[test]
    fn area_of_a_sphere() {
        let sphere = Carrier::Sphere { frame: Frame::world(), radius: 3.0 };
        let (s, _) = sphere.to_spline((0.0, TAU), (-FRAC_PI_2, FRAC_PI_2)).expect("a sphere");
        assert!((area_estimate(&Face::untrimmed(s)) / (36.0 * PI) - 1.0).abs() < 1e-9);
    }
}
