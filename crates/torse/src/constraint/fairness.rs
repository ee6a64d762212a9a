//! Differences of control points: small ones make fair curves and rulings.
//!
//! Second and third differences along curves, second differences across strips \[W15\]; with knots that are not evenly
//! spaced, divided differences over the Greville abscissae, scaled so that even spacing gives `1, −2, 1`.

use super::stencil::Stencil;
use crate::spline::knots::Knots;

/// Greville abscissae: the parameters that control points stand for.
pub(crate) fn greville(knots: &Knots) -> Vec<f64> {
    let p = knots.degree();
    let v = knots.values();
    (0..knots.control_count()).map(|i| v[i + 1..=i + p].iter().sum::<f64>() / p as f64).collect()
}

/// Differences of order `order` of control points over their abscissae. Points whose abscissae coincide have none.
pub(crate) fn differences(abscissae: &[f64], points: &[u32], order: usize) -> Vec<Stencil> {
    let n = abscissae.len().min(points.len());
    if n <= order || order == 0 {
        return Vec::new();
    }
    let step = (abscissae[n - 1] - abscissae[0]) / (n - 1) as f64;
    let factorial: f64 = (1..=order).map(|k| k as f64).product();
    let scale = factorial * step.powi(order as i32);
    let mut out = Vec::new();
    for i in 0..n - order {
        let at = &abscissae[i..=i + order];
        let weight = |j: usize| {
            let others = (0..=order).filter(|&k| k != j);
            others.map(|k| 1.0 / (at[j] - at[k])).product::<f64>() * scale
        };
        let terms: Vec<(u32, f64)> = (0..=order).map(|j| (points[i + j], weight(j))).collect();
        if terms.iter().all(|t| t.1.is_finite()) {
            out.push(Stencil(terms));
        }
    }
    out
}

/// Second difference of three points across strips.
pub(crate) fn across(a: u32, b: u32, c: u32) -> Stencil {
    Stencil(vec![(a, 1.0), (b, -2.0), (c, 1.0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_spacing_gives_binomials() {
        let rows = differences(&[0.0, 1.0, 2.0, 3.0], &[0, 3, 6, 9], 2);
        assert_eq!(rows, [Stencil(vec![(0, 1.0), (3, -2.0), (6, 1.0)]), Stencil(vec![(3, 1.0), (6, -2.0), (9, 1.0)])]);
        assert_eq!(
            differences(&[0.0, 1.0, 2.0, 3.0], &[0, 3, 6, 9], 3)[0].0.iter().map(|t| t.1).collect::<Vec<_>>(),
            [-1.0, 3.0, -3.0, 1.0]
        );
    }

    #[test]
    fn polynomials_of_lower_degree_have_no_differences() {
        let knots = Knots::new(3, vec![0., 0., 0., 0., 0.2, 0.2, 0.7, 1., 1., 1., 1.], 7).expect("knots");
        let g = greville(&knots);
        let points: Vec<u32> = (0..7).map(|i| 3 * i).collect();
        let x: Vec<f64> = g.iter().flat_map(|t| [*t, 1.0 - 2.0 * t, t * t]).collect();
        for s in differences(&g, &points, 3) {
            assert!(s.value(&x).norm() < 1e-12);
        }
        for s in differences(&g, &points, 2) {
            let v = s.value(&x);
            assert!(v.xy().norm() < 1e-13 && v.z > 0.0);
        }
    }
}
