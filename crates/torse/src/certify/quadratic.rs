//! The largest value of a quadratic polynomial on a triangle.

/// `c + g·y + ½ yᵀHy` with `H = [[a, b], [b, d]]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadratic {
    /// Constant.
    pub c: f64,
    /// Gradient at 0.
    pub g: [f64; 2],
    /// Entries a, b, d of the Hessian.
    pub h: [f64; 3],
}

/// Rounding errors of the few operations spent on one value, with a wide margin.
const SLACK: f64 = 64.0 * f64::EPSILON;
/// Share of a triangle's area by which it is enlarged when candidates are sought: far above the rounding of their
/// places.
const HAIR: f64 = 1e-6;
/// The same for triangles without area, in the square of the unit of their corners.
const SPECK: f64 = 1e-12;

impl Quadratic {
    /// Value at `y`.
    #[inline]
    pub fn value(&self, y: [f64; 2]) -> f64 {
        let [a, b, d] = self.h;
        self.c + self.g[0] * y[0] + self.g[1] * y[1] + 0.5 * (a * y[0] * y[0] + d * y[1] * y[1]) + b * y[0] * y[1]
    }

    /// Bound of every intermediate magnitude for |y₁|, |y₂| ≤ `reach`.
    fn scale(&self, reach: f64) -> f64 {
        let r = reach;
        self.c.abs()
            + (self.g[0].abs() + self.g[1].abs()) * r
            + (self.h[0].abs() + 2.0 * self.h[1].abs() + self.h[2].abs()) * r * r
    }

    /// An upper bound of |value| on the triangle, exact up to rounding.
    ///
    /// Candidates: corners, stationary points of the sides, the inner stationary point where the form is definite.
    /// A stationary value of a concave function bounds it everywhere, so a candidate slightly outside only enlarges.
    pub fn magnitude_bound(&self, corners: &[[f64; 2]; 3]) -> f64 {
        let negated = Self { c: -self.c, g: [-self.g[0], -self.g[1]], h: self.h.map(|x| -x) };
        let reach = corners.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
        self.upper(corners, reach).max(negated.upper(corners, reach)) + SLACK * self.scale(reach)
    }

    fn upper(&self, corners: &[[f64; 2]; 3], reach: f64) -> f64 {
        let [a, b, d] = self.h;
        let mut best = f64::NEG_INFINITY;
        for k in 0..3 {
            let (p, q) = (corners[k], corners[(k + 1) % 3]);
            best = best.max(self.value(p));
            let e = [q[0] - p[0], q[1] - p[1]];
            let curvature = a * e[0] * e[0] + 2.0 * b * e[0] * e[1] + d * e[1] * e[1];
            if curvature < 0.0 {
                let slope = (self.g[0] + a * p[0] + b * p[1]) * e[0] + (self.g[1] + b * p[0] + d * p[1]) * e[1];
                let s = -slope / curvature;
                if (-0.01..=1.01).contains(&s) {
                    best = best.max(self.value(p) + 0.5 * slope * s);
                }
            }
        }
        if a < 0.0 && d < 0.0 {
            // Relative doubt about the sign of the determinant.
            const DOUBT: f64 = 1e-12;
            let (det, size) = (a * d - b * b, a * d);
            if det > DOUBT * size {
                let y = [(b * self.g[1] - d * self.g[0]) / det, (b * self.g[0] - a * self.g[1]) / det];
                if inside(corners, y) {
                    // Concave: value(x) ≤ value(y) + ∇(y)·(x − y).
                    let rest = (self.g[0] + a * y[0] + b * y[1]).abs() + (self.g[1] + b * y[0] + d * y[1]).abs();
                    best = best.max(self.value(y) + rest * 4.0 * reach);
                }
            } else if det >= -DOUBT * size {
                // With d raised by 2·DOUBT·|d| the form is indefinite and its maximum on the boundary.
                best += 2.0 * DOUBT * d.abs() * reach * reach;
            }
        }
        best
    }
}

/// Whether `y` lies in the triangle, enlarged by a hair.
fn inside(c: &[[f64; 2]; 3], y: [f64; 2]) -> bool {
    let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let whole = area(c[0], c[1], c[2]);
    (0..3).all(|k| area(c[k], c[(k + 1) % 3], y) * whole.signum() >= -HAIR * whole.abs() - SPECK)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn samples_never_exceed_the_bound_and_come_near(
            c in -1.0..1.0f64, g in prop::array::uniform2(-1.0..1.0f64), h in prop::array::uniform3(-4.0..4.0f64),
            corners in prop::array::uniform3(prop::array::uniform2(-0.7..0.7f64)),
        ) {
            let q = Quadratic { c, g, h };
            let bound = q.magnitude_bound(&corners);
            let mut best = 0.0f64;
            let n = 60;
            for i in 0..=n {
                for j in 0..=n - i {
                    let (a, b) = (i as f64 / n as f64, j as f64 / n as f64);
                    let w = [a, b, 1.0 - a - b];
                    let y = [0, 1].map(|d| (0..3).map(|k| w[k] * corners[k][d]).sum::<f64>());
                    best = best.max(q.value(y).abs());
                }
            }
            prop_assert!(best <= bound + 1e-13);
            prop_assert!(bound <= best + 0.01);
        }
    }
}
