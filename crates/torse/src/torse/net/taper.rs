//! Strips of a net's surface with another opposite boundary: the ruling's length multiplied by a linear function, and
//! the degree raised by one.
//!
//! *Method.* Aumann's degree elevation in the knots of \[FJ07\]: `d = c + β e` with `β` linear has the blossom
//! `c[…] + 1/(n+1) Σ β(v_j) e[… without v_j]`. With `β` constant it is plain degree elevation. The pair `(c, d)` no
//! longer satisfies (13) with constants, but the surface is the same, and its regression curve known.

use super::control_net::{ruled, Net, NetError};
use super::regular::weight_fault;
use super::regular::Regularity;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;

/// A net whose ruling vectors are multiplied by `β(u)`, linear, with the values `taper` at the ends of the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct TaperedNet {
    /// The surface.
    pub net: Net,
    /// `β` at the start and end of the domain; both of one sign, not zero.
    pub taper: (f64, f64),
}

impl TaperedNet {
    /// `β(u)`.
    pub fn factor(&self, u: f64) -> f64 {
        let (a, b) = self.net.domain();
        let s = (u - a) / (b - a);
        (1.0 - s) * self.taper.0 + s * self.taper.1
    }

    /// Whether `β` is constant, so that the strip is a net of its own.
    pub fn is_constant(&self) -> bool {
        self.taper.0 == self.taper.1
    }

    /// Homogeneous position of the regression point on ruling `u`: 0 on the curve, 1 on the opposite boundary.
    pub fn regression(&self, u: f64) -> f64 {
        self.net.regression(u) / self.factor(u)
    }

    /// Both boundaries with the degree raised by one, homogeneous, over the same knots.
    ///
    /// # Errors
    /// The degree is the largest supported one.
    pub fn boundaries(&self) -> Result<(Curve<4>, Curve<4>), NetError> {
        let c = self.net.curve().elevated()?;
        let d = c.control.clone();
        let mut d = Curve { knots: c.knots.clone(), control: d };
        for (x, e) in d.control.iter_mut().zip(self.elevated_rulings(&c)) {
            for k in 0..4 {
                x[k] += e[k];
            }
        }
        Ok((c, d))
    }

    /// Control vectors of `β e` over the knots of `raised`.
    fn elevated_rulings(&self, raised: &Curve<4>) -> Vec<[f64; 4]> {
        let q = raised.knots.degree();
        let v = raised.knots.values();
        let e = self.net.ruling_curve();
        let pieces: Vec<(f64, f64)> = raised.knots.breaks().windows(2).map(|w| (w[0], w[1])).collect();
        let mut args = Vec::with_capacity(q);
        (0..raised.control.len())
            .map(|i| {
                let wanted = &v[i + 1..=i + q];
                // A parameter of a piece on which control point i acts, near the middle of its knots.
                let mean = wanted.iter().sum::<f64>() / q as f64;
                let at = pieces
                    .iter()
                    .filter(|w| w.0 < v[i + q + 1] && w.1 > v[i])
                    .map(|w| ((w.0 - mean).max(mean - w.1).max(0.0), 0.5 * (w.0 + w.1)))
                    .min_by(|x, y| x.0.total_cmp(&y.0))
                    .map_or(mean, |x| x.1);
                let mut sum = [0.0; 4];
                for left_out in 0..q {
                    args.clear();
                    args.extend(wanted.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, x)| *x));
                    let factor = self.factor(wanted[left_out]) / q as f64;
                    if let Some(b) = e.blossom(at, &args) {
                        for k in 0..4 {
                            sum[k] += factor * b[k];
                        }
                    }
                }
                sum
            })
            .collect()
    }

    /// The strip as a ruled patch of degree `n + 1` in `u`.
    ///
    /// # Errors
    /// Degree too high; a weight of the opposite boundary that is not positive.
    pub fn patch(&self) -> Result<Surface, NetError> {
        if self.is_constant() {
            return self.net.between(0.0, self.taper.0)?.patch();
        }
        let (c, d) = self.boundaries()?;
        ruled(&c, &d)
    }

    /// Whether the strip is regular, else a witness.
    ///
    /// *Guarantee*: as [`Net::regularity`]; the regression curve lies at `−g/(κ β)`, a quotient of linear functions.
    pub fn regularity(&self) -> Regularity {
        if let Ok((_, d)) = self.boundaries() {
            if let Some((index, weight)) = weight_fault(d.control.iter()) {
                return Regularity::Weight { index, weight };
            }
        }
        let (a, b) = self.net.domain();
        let shape = self.net.shape();
        // The strip holds the regression curve where g + κ v β vanishes: linear in u on both boundaries, linear in v
        // on every ruling. So the signs at the four corners decide.
        let near = [shape.g(a), shape.g(b)];
        let far = [near[0] + shape.kappa * self.taper.0, near[1] + shape.kappa * self.taper.1];
        let crossing = |x: [f64; 2]| a + (b - a) * (x[0] / (x[0] - x[1])).clamp(0.0, 1.0);
        if near[0] * near[1] <= 0.0 {
            return Regularity::Regression { u: crossing(near), v: 0.0 };
        }
        if far[0] * far[1] <= 0.0 {
            return Regularity::Regression { u: crossing(far), v: 1.0 };
        }
        if near[0] * far[0] < 0.0 {
            return Regularity::Regression { u: a, v: self.regression(a) };
        }
        match self.net.tangent_ruling() {
            Some(u) => Regularity::TangentRuling { u },
            None => Regularity::Regular,
        }
    }
}

impl Net {
    /// Both boundaries with the degree raised by one; the surface and its parameters are the same.
    ///
    /// # Errors
    /// The degree is the largest supported one.
    pub fn elevated(&self) -> Result<(Curve<4>, Curve<4>), NetError> {
        Ok((self.curve.elevated()?, self.opposite().elevated()?))
    }
}
