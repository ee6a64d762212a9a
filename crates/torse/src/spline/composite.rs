//! Curves on surfaces: where the composition is smooth.

use super::curve::Curve;
use super::knots::SAME_PARAMETER;
use super::surface::Surface;

/// Ends of the smooth pieces of `surface(curve(s))`: knots of the curve and its crossings of the surface's knot lines
/// u = const, found between four samples per span; from the start of the curve's domain [0, 1] to its end.
pub(crate) fn smooth_breaks(surface: &Surface, curve: &Curve<2>) -> Vec<f64> {
    let own = curve.knots.breaks();
    let lines = surface.knots_u.breaks();
    let mut out = own.clone();
    for w in own.windows(2) {
        const PARTS: usize = 4;
        for k in 0..PARTS {
            let mut a = w[0] + (w[1] - w[0]) * k as f64 / PARTS as f64;
            let mut b = w[0] + (w[1] - w[0]) * (k + 1) as f64 / PARTS as f64;
            let (ta, tb) = (curve.point(a)[0], curve.point(b)[0]);
            for &line in lines.iter().filter(|&&l| (ta < l) != (tb < l)) {
                let (lo, hi) = (a, b);
                for _ in 0..50 {
                    let m = 0.5 * (a + b);
                    if (curve.point(m)[0] - line) * (ta - line) > 0.0 {
                        a = m;
                    } else {
                        b = m;
                    }
                }
                out.push(0.5 * (a + b));
                (a, b) = (lo, hi);
            }
        }
    }
    out.sort_by(f64::total_cmp);
    // Breaks that nearly coincide would make spans without content.
    let mut kept: Vec<f64> = vec![0.0];
    for s in out {
        if s - kept[kept.len() - 1] > SAME_PARAMETER && s < 1.0 - SAME_PARAMETER {
            kept.push(s);
        }
    }
    kept.push(1.0);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::spline::knots::Knots;

    #[test]
    fn crossings_of_knot_lines_are_found() {
        let ku = Knots::clamped(2, &[0.0, 0.25, 0.5, 1.0]).expect("knots");
        let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let p: Vec<Vec3> = (0..10).map(|i| Vec3::new(f64::from(i), f64::from(i * i), 0.0)).collect();
        let surface = Surface::new(ku, kv, &p, None).expect("surface");
        let curve =
            Curve::new(1, vec![0.0, 0.0, 0.5, 1.0, 1.0], vec![[0.0, 0.1], [0.6, 0.2], [0.4, 0.9]]).expect("curve");
        let b = smooth_breaks(&surface, &curve);
        let expected = [0.0, 0.25 / 1.2, 0.5 / 1.2, 0.5, 0.75, 1.0];
        assert_eq!(b.len(), expected.len());
        assert!(b.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-9));
    }
}
