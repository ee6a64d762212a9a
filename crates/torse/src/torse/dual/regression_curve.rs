//! The regression curve as a rational curve of its true degree \[PW99, 2 and 4.4\].
//!
//! *Method.* On a span write `U = (1−s)² A + 2 s (1−s) B + s² C` with polynomials of degree k−2, the last but one level
//! of de Casteljau's scheme. Then `U ∧ U' ∧ U''` is a constant times `A ∧ B ∧ C`, of degree 3k−6 without any
//! cancellation. For type (3) the degree is only 2k−3 if k > 3: there the products with vanishing leading
//! coefficients are reduced exactly. (The paper states 3k−6 in general; that is the degree for types (1) and (2).)

use super::assemble::reduced;
use super::wedge::{line_of_planes, point_of_line_and_plane};
use super::{DualCurve, DualError, DualKind};
use crate::spline::bezier::Bezier;

/// One span of the regression curve.
#[derive(Clone, Debug, PartialEq)]
pub struct RegressionPiece {
    /// Start of the span.
    pub a: f64,
    /// End of the span.
    pub b: f64,
    /// Homogeneous points `(w x, w y, w z, w)` over `[0, 1]`. Points where `w` changes sign are at infinity.
    pub points: Bezier<4>,
}

impl DualCurve {
    /// The regression curve span by span, of degree 3k−6, for type (3) of degree 2k−3 (0 if k = 2, where every span is
    /// part of a cone). Jumps where the planes are only C¹.
    ///
    /// # Errors
    /// Planes of degree 1: all rulings lie on the common lines of planes, there is no regression curve.
    pub fn regression_curve(&self) -> Result<Vec<RegressionPiece>, DualError> {
        let degree = self.knots().degree();
        if degree < 2 {
            return Err(DualError::Degree { degree, what: "regression curve" });
        }
        let piece = |(a, b, u): (f64, f64, Bezier<4>)| {
            let points = if self.kind() == DualKind::Slope && degree > 3 { by_slope(a, b, &u) } else { general(&u) };
            RegressionPiece { a, b, points }
        };
        Ok(self.pieces().into_iter().map(piece).collect())
    }
}

/// `A ∧ B ∧ C`.
fn general(u: &Bezier<4>) -> Bezier<4> {
    let c = u.control();
    let k = c.len() - 1;
    let part = |from: usize| Bezier::new(c[from..from + k - 1].to_vec());
    point_of_line_and_plane(&line_of_planes(&part(0), &part(1)), &part(2))
}

/// `w = u1''`, `w x = −u0''`, `w y = u1' u0'' − u0' u1''`, `w z = u0 u1'' − u1 u0'' + t (w y)`; derivatives with
/// respect to the share of the span, which changes all of them by the same factor.
fn by_slope(a: f64, b: f64, u: &Bezier<4>) -> Bezier<4> {
    let h = b - a;
    let (p, q) = (u.component(3), Bezier::constant([0.0]).minus(&u.component(0)));
    let (dp, dq) = (p.derivative(), q.derivative());
    let (ddp, ddq) = (dp.derivative(), dq.derivative());
    // Products of a function and the derivatives of another, antisymmetric: the leading coefficients cancel.
    let wy = reduced(&dq.times(&ddp).minus(&dp.times(&ddq)));
    let first = p.times(&ddq).minus(&q.times(&ddp));
    let t = Bezier::new(vec![[a], [b]]);
    // w y holds one derivative in t, which is 1/h of one in the share.
    let turn = t.times(&wy).control().iter().map(|c| [c[0] / h]).collect();
    let wz = reduced(&first).plus(&Bezier::new(turn));
    let n = wz.degree();
    let raise = |c: &Bezier<1>, factor: f64| -> Vec<f64> {
        c.elevated(n.saturating_sub(c.degree())).control().iter().map(|x| factor * x[0]).collect()
    };
    let (x, y, z, w) = (raise(&ddp, -1.0), raise(&wy, 1.0 / h), raise(&wz, 1.0), raise(&ddq, 1.0));
    Bezier::new((0..=n).map(|i| [x[i], y[i], z[i], w[i]]).collect())
}
