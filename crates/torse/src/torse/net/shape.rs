//! The two numbers that decide the shape of a developable net: where its regression curve lies on every ruling.
//!
//! *Method.* \[FJ07\], corollary 2 and (17), in a form without infinities. The paper's numbers are the blossom arguments
//! Λ* and M*; here `m = 1/(M* − u_m)` and `κ = (Λ* − M*) m` with `u_m` the middle of the domain. Cones have `m = 0`,
//! cylinders `κ = 0`, and only M* = u_m, which is singular anyway, cannot be written.

/// Shape of a developable net over the domain `[a, b]` of its curve.
///
/// With `g(u) = 1 − m (u − u_m)` the ruling vectors satisfy `g e' = κ c' − n m e`, and the regression curve lies at
/// `v = −g(u)/κ` on ruling `u`, where `v = 0` is the curve and `v = 1` the opposite boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Domain of the curve.
    pub domain: (f64, f64),
    /// `1/(M* − u_m)`, per unit of the parameter; 0 for cones.
    pub m: f64,
    /// `(Λ* − M*) m`, no unit; 0 for cylinders (and for cones with a vertex in the weights).
    pub kappa: f64,
}

impl Shape {
    /// The shape with these numbers.
    pub fn new(domain: (f64, f64), m: f64, kappa: f64) -> Self {
        Self { domain, m, kappa }
    }

    /// The shape with the blossom arguments Λ* and M*. `None` if M* is the middle of the domain or a number is not
    /// finite.
    pub fn from_stars(domain: (f64, f64), lambda_star: f64, m_star: f64) -> Option<Self> {
        let m = 1.0 / (m_star - middle(domain));
        let kappa = (lambda_star - m_star) * m;
        (m.is_finite() && kappa.is_finite()).then_some(Self { domain, m, kappa })
    }

    /// Middle of the domain.
    pub fn middle(&self) -> f64 {
        middle(self.domain)
    }

    /// M*; infinite for cones.
    pub fn m_star(&self) -> f64 {
        self.middle() + 1.0 / self.m
    }

    /// Λ*; infinite for cones.
    pub fn lambda_star(&self) -> f64 {
        self.middle() + (1.0 + self.kappa) / self.m
    }

    /// `g(u) = 1 − m (u − u_m)`, proportional to `M* − u`.
    pub fn g(&self, u: f64) -> f64 {
        1.0 - self.m * (u - self.middle())
    }

    /// Smaller of the values of `g` at the ends of the domain; not positive when M* lies inside.
    pub fn least_g(&self) -> f64 {
        self.g(self.domain.0).min(self.g(self.domain.1))
    }

    /// Where the regression curve meets ruling `u`: exact on every ruling, linear in `u`. Infinite when `κ = 0`.
    pub fn regression(&self, u: f64) -> f64 {
        -self.g(u) / self.kappa
    }

    /// Some ruling of the domain on which the regression curve lies in the strip `v_0 ≤ v ≤ v_1`, with its place
    /// `(u, v)` there; `None` if there is none. Exact up to the rounding of one expression.
    pub fn regression_within(&self, v: (f64, f64)) -> Option<(f64, f64)> {
        let (a, b) = self.domain;
        // h(u, v) = g(u) + κ v vanishes on the regression curve and is bilinear: its extremes are at corners.
        let value = |u: f64, v: f64| self.g(u) + self.kappa * v;
        let corners = [(a, v.0), (a, v.1), (b, v.0), (b, v.1)];
        let (mut low, mut high) = ((f64::INFINITY, a, v.0), (f64::NEG_INFINITY, a, v.0));
        for (u, v) in corners {
            let h = value(u, v);
            if h < low.0 {
                low = (h, u, v);
            }
            if h > high.0 {
                high = (h, u, v);
            }
        }
        if low.0 > 0.0 || high.0 < 0.0 {
            return None;
        }
        // A zero on the segment between the extreme corners: h is at most quadratic there, bisection is certain.
        let (mut x, mut y) = ((low.1, low.2), (high.1, high.2));
        for _ in 0..60 {
            let mid = (0.5 * (x.0 + y.0), 0.5 * (x.1 + y.1));
            if value(mid.0, mid.1) > 0.0 {
                y = mid;
            } else {
                x = mid;
            }
        }
        Some(x)
    }

    /// Shape of the same surface over another part of the curve.
    pub fn over(&self, domain: (f64, f64)) -> Self {
        let g = self.g(middle(domain));
        Self { domain, m: self.m / g, kappa: self.kappa / g }
    }

    /// Shape of the strip between `v_0` and `v_1` of the same surface; (17) of the paper for `v_0 = 0`, exchange of
    /// the boundaries for `(1, 0)`.
    pub fn between(&self, v_0: f64, v_1: f64) -> Self {
        let scale = 1.0 + v_0 * self.kappa;
        Self { domain: self.domain, m: self.m / scale, kappa: (v_1 - v_0) * self.kappa / scale }
    }

    /// Coefficients Λ and M of the segment `[u_k, u_{k+1}]`, those of its Bézier net \[FJ07, 19\]; infinite for cones.
    pub fn of_segment(&self, u_k: f64, u_next: f64) -> [f64; 2] {
        [(self.lambda_star() - u_k) / (u_next - u_k), (self.m_star() - u_k) / (u_next - u_k)]
    }

    /// Barycentric coefficients λ, μ of the cell whose control points depend on the knots `first … last`:
    /// `d_i = (1 − λ − μ) c_{i−1} + λ c_i + μ d_{i−1}` with `first = u_{i−1}`, `last = u_{i+n−1}` \[FJ07, 18\]. For cones
    /// `(1 + κ, 1)`.
    pub fn of_cell(&self, first: f64, last: f64) -> [f64; 2] {
        let g = self.g(first);
        // λ = (Λ* − u)/(M* − u) = (g + κ)/g, without the infinities of a cone.
        [(g + self.kappa) / g, self.g(last) / g]
    }

    /// The shape whose cell over the knots `first … last` has the coefficients λ and μ: inverse of
    /// [`Shape::of_cell`]. `None` if M* would be the middle of the domain.
    pub fn from_cell(domain: (f64, f64), first: f64, last: f64, lambda: f64, mu: f64) -> Option<Self> {
        // μ g(first) = g(last) is linear in m.
        let c = middle(domain);
        let m = (1.0 - mu) / ((last - c) - mu * (first - c));
        let shape = Self { domain, m, kappa: 0.0 };
        let kappa = (lambda - 1.0) * shape.g(first);
        (m.is_finite() && kappa.is_finite()).then_some(Self { kappa, ..shape })
    }
}

fn middle(domain: (f64, f64)) -> f64 {
    0.5 * (domain.0 + domain.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: (f64, f64) = (0.5, 2.0);

    #[test]
    fn stars_and_stable_numbers_are_the_same_shape() {
        let s = Shape::from_stars(DOMAIN, -0.7, -0.2).expect("regular");
        assert!((s.m_star() + 0.2).abs() < 1e-15 && (s.lambda_star() + 0.7).abs() < 1e-15);
        for u in [0.5, 1.1, 2.0] {
            assert!((s.regression(u) - (u + 0.2) / (-0.7 + 0.2)).abs() < 1e-14);
        }
        assert!(Shape::from_stars(DOMAIN, 3.0, 1.25).is_none() && Shape::from_stars(DOMAIN, f64::NAN, 3.0).is_none());
    }

    #[test]
    fn parts_and_exchange_keep_the_regression_curve() {
        let s = Shape::from_stars(DOMAIN, 3.0, 2.5).expect("regular");
        let part = s.over((0.8, 1.3));
        assert!((part.m_star() - 2.5).abs() < 1e-14 && (part.lambda_star() - 3.0).abs() < 1e-14);
        let strip = s.between(-0.5, 2.0);
        assert!((strip.m_star() - 2.25).abs() < 1e-14 && (strip.lambda_star() - 3.5).abs() < 1e-14);
        let turned = s.between(1.0, 0.0);
        assert!((turned.m_star() - 3.0).abs() < 1e-14 && (turned.lambda_star() - 2.5).abs() < 1e-14);
    }

    #[test]
    fn cells_are_inverted_and_cones_have_no_infinities() {
        let s = Shape::from_stars(DOMAIN, 3.0, 2.5).expect("regular");
        let [lambda, mu] = s.of_cell(0.5, 1.0);
        assert!((lambda - 2.5 / 2.0).abs() < 1e-15 && (mu - 1.5 / 2.0).abs() < 1e-15);
        let back = Shape::from_cell(DOMAIN, 0.5, 1.0, lambda, mu).expect("a shape");
        assert!((back.m - s.m).abs() < 1e-14 && (back.kappa - s.kappa).abs() < 1e-14);
        let cone = Shape::new(DOMAIN, 0.0, 0.3);
        assert_eq!(cone.of_cell(0.5, 1.0), [1.3, 1.0]);
        assert!(Shape::from_cell(DOMAIN, 0.5, 1.0, 1.3, 1.0).is_some_and(|s| s.m.abs() < 1e-15));
    }

    #[test]
    fn the_regression_curve_is_found_where_it_crosses_the_strip() {
        let s = Shape::from_stars(DOMAIN, 0.2, -0.4).expect("a shape");
        assert!(s.regression_within((0.0, 1.0)).is_none());
        let (u, v) = s.regression_within((0.0, 2.0)).expect("crosses");
        assert!((s.regression(u) - v).abs() < 1e-12 && (0.0..=2.0).contains(&v) && (0.5..=2.0).contains(&u));
        // Λ* and M* on different sides: some ruling between carries the curve at c or d or between them.
        assert!(Shape::from_stars(DOMAIN, 3.0, 0.1).is_some_and(|s| s.regression_within((0.0, 1.0)).is_some()));
    }
}
