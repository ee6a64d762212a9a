//! Developability with a bound for the regression curve.
//!
//! A ruling from `a` to `b = a + r` is torsal if and only if `b' − a' = κ (b' + a') + ν r`. Its regression point then lies
//! at `v = 1/2 − 1/(2κ)`: outside the strip for `|κ| < 1`, at infinity for `κ = 0`. Three rows ask for this; a fourth,
//! `κ² + w² = κ_max²`, keeps `|κ|` below a bound. Unlike the equations of a normal, these cannot be met by rulings whose
//! regression point lies inside the strip.

use super::{vectors, StripPoints};
use crate::constraint::stencil::Support;
use crate::geom::Vec3;
use crate::num::gauss_newton::Block;

/// Developability of one ruling; private unknowns κ, ν, w.
#[derive(Clone, Debug)]
pub(crate) struct KForm {
    support: Support,
    largest: f64,
}

/// Share of the bound within which κ starts.
const START: f64 = 0.9;

impl KForm {
    /// The ruling at `u` in a piece of length `unit`. The regression point keeps off the strip by `margin` lengths of the
    /// ruling at least: `κ_max = 1/(1 + 2 margin)`.
    pub fn new(strip: StripPoints, u: f64, unit: f64, margin: f64) -> Self {
        let [da, db, r] = strip.ruling(u, unit);
        Self { support: Support::new(&[&da, &db, &r]), largest: 1.0 / (1.0 + 2.0 * margin.max(0.0)) }
    }
}

/// κ and ν of least squares for a ruling.
fn least_squares(da: &Vec3, db: &Vec3, r: &Vec3) -> (f64, f64) {
    let (s, d) = (db + da, db - da);
    let (ss, sr, rr) = (s.norm_squared(), s.dot(r), r.norm_squared());
    let det = ss * rr - sr * sr;
    if det > f64::EPSILON * ss * rr {
        let (x, y) = (s.dot(&d), r.dot(&d));
        ((x * rr - y * sr) / det, (y * ss - x * sr) / det)
    } else {
        (0.0, if rr > 0.0 { r.dot(&d) / rr } else { 0.0 })
    }
}

impl Block for KForm {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        4
    }

    fn private(&self) -> usize {
        3
    }

    fn begin(&self, x: &[f64], own: &mut [f64]) {
        let [da, db, r] = vectors(&self.support, x);
        let (kappa, nu) = least_squares(&da, &db, &r);
        let limit = START * self.largest;
        let kappa = if kappa.is_finite() { kappa.clamp(-limit, limit) } else { 0.0 };
        own.copy_from_slice(&[kappa, nu, (self.largest * self.largest - kappa * kappa).sqrt()]);
    }

    fn evaluate(&self, x: &[f64], own: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let [da, db, r] = vectors(&self.support, x);
        let (kappa, nu, w) = (own[0], own[1], own[2]);
        let sum = db + da;
        let e = (db - da) - sum * kappa - r * nu;
        residual[..3].copy_from_slice(e.as_slice());
        residual[3] = kappa * kappa + w * w - self.largest * self.largest;
        let Some(jacobian) = jacobian else { return };
        let width = x.len() + 3;
        let c = [0, 1, 2].map(|k| self.support.coefficients(k));
        for d in 0..3 {
            let row = &mut jacobian[d * width..(d + 1) * width];
            for (j, ((a, b), r)) in c[0].iter().zip(c[1]).zip(c[2]).enumerate() {
                row[3 * j + d] = (1.0 - kappa) * b - (1.0 + kappa) * a - nu * r;
            }
            row[x.len()] = -sum[d];
            row[x.len() + 1] = -r[d];
        }
        jacobian[3 * width + x.len()] = 2.0 * kappa;
        jacobian[3 * width + x.len() + 2] = 2.0 * w;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check;
    use crate::spline::knots::Knots;

    fn residual_of(a: &[Vec3], b: &[Vec3], margin: f64) -> (f64, f64) {
        let n = a.len();
        let knots = Knots::uniform(n - 1, 1, 0.0, 1.0).expect("knots");
        let points: Vec<u32> = (0..2 * n as u32).map(|i| 3 * i).collect();
        let strip = StripPoints { knots: &knots, a: &points[..n], b: &points[n..] };
        let x: Vec<f64> = a.iter().chain(b).flat_map(|p| [p.x, p.y, p.z]).collect();
        let mut worst: f64 = 0.0;
        let mut kappa = 0.0;
        for (u, unit) in super::super::samples(&knots) {
            let block = KForm::new(strip, u, unit, margin);
            let mut own = [0.0; 3];
            let local: Vec<f64> = block.unknowns().iter().map(|&i| x[i as usize]).collect();
            block.begin(&local, &mut own);
            let mut out = [0.0; 4];
            block.evaluate(&local, &own, &mut out, None);
            worst = out.iter().fold(worst, |m, r| m.max(r.abs()));
            kappa = own[0];
        }
        (worst, kappa)
    }

    #[test]
    fn derivatives_are_right() {
        let knots = Knots::uniform(3, 2, 0.0, 1.0).expect("knots");
        let points: Vec<u32> = (0..10).map(|i| 3 * i).collect();
        let strip = StripPoints { knots: &knots, a: &points[..5], b: &points[5..] };
        check(&mut KForm::new(strip, 0.3, 0.5, 0.1), 1.0);
        // A common end point of both curves.
        let strip = StripPoints { knots: &knots, a: &points[..5], b: &[0, 15, 18, 21, 24] };
        check(&mut KForm::new(strip, 0.1, 0.5, 0.1), 2.0);
    }

    #[test]
    fn cylinders_cones_and_tangent_surfaces_are_developable() {
        let v = Vec3::new;
        let a = [v(0.0, 0.0, 0.0), v(0.3, 0.5, 0.1), v(0.8, 0.4, 0.0), v(1.0, 0.0, 0.2)];
        let shift = v(0.2, 0.1, 0.9);
        let cylinder: Vec<Vec3> = a.iter().map(|p| p + shift).collect();
        let (r, kappa) = residual_of(&a, &cylinder, 0.0);
        assert!(r < 1e-14 && kappa.abs() < 1e-14);
        // A cone whose apex lies 1/2 of a ruling before the first curve: v* = −1/2, so κ = 1/2.
        let apex = v(0.2, -0.4, 1.5);
        let cone: Vec<Vec3> = a.iter().map(|p| apex + (p - apex) * 3.0).collect();
        let (r, kappa) = residual_of(&a, &cone, 0.0);
        assert!(r < 1e-13 && (kappa - 0.5).abs() < 1e-13, "{r} {kappa}");
        // The tangent surface of (t, t², t³): c + c'/4 and c + c' in Bernstein form of degree 3.
        let c = [v(0.0, 0.0, 0.0), v(1.0 / 3.0, 0.0, 0.0), v(2.0 / 3.0, 1.0 / 3.0, 0.0), v(1.0, 1.0, 1.0)];
        // c' = (1, 2t, 3t²), elevated to degree 3.
        let d = [v(1.0, 0.0, 0.0), v(1.0, 2.0 / 3.0, 0.0), v(1.0, 4.0 / 3.0, 1.0), v(1.0, 2.0, 3.0)];
        let side = |s: f64| (0..4).map(|i| c[i] + d[i] * s).collect::<Vec<Vec3>>();
        let (r, kappa) = residual_of(&side(0.5), &side(2.0), 0.0);
        // Regression at v* = −1/3: κ = 1/(1 + 2/3).
        assert!(r < 1e-13 && (kappa - 0.6).abs() < 1e-12, "{r} {kappa}");
    }

    #[test]
    fn an_apex_inside_the_strip_is_refused() {
        let v = Vec3::new;
        let a = [v(0.0, 0.0, 0.0), v(0.5, 0.5, 0.0), v(1.0, 0.0, 0.0)];
        let apex = v(0.4, 0.1, 1.0);
        let double: Vec<Vec3> = a.iter().map(|p| apex - (p - apex)).collect();
        assert!(residual_of(&a, &double, 0.0).0 > 0.1);
    }
}
