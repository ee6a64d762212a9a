//! Cubic spline curves span by span in powers of the distance from the span's start: the fast form for many
//! evaluations, and the way to change the ends of a domain.

use super::curve::Curve;
use super::knots::Knots;
use super::SplineError;

/// A piecewise cubic function with values in `R^D`, continued outside its domain by its outermost polynomials.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pieces<const D: usize> {
    /// Ends of the spans, increasing; one more than there are spans.
    pub breaks: Vec<f64>,
    /// `power[s][k]`: coefficient of `(t − breaks[s])^k` on span `s`.
    pub power: Vec<[[f64; D]; 4]>,
}

/// Index of the span that contains `t`; the outermost spans reach to infinity.
#[inline]
pub(crate) fn span_of(breaks: &[f64], t: f64) -> usize {
    let spans = breaks.len() - 1;
    // Most splines here are uniform: guess, then walk.
    let guess = (t - breaks[0]) / (breaks[spans] - breaks[0]) * spans as f64;
    let mut s = (guess.max(0.0) as usize).min(spans - 1);
    while s > 0 && t < breaks[s] {
        s -= 1;
    }
    while s + 1 < spans && t >= breaks[s + 1] {
        s += 1;
    }
    s
}

impl<const D: usize> Pieces<D> {
    /// The spans of a curve of degree at most three; `None` for a higher degree.
    pub fn of(curve: &Curve<D>) -> Option<Self> {
        if curve.knots.degree() > 3 {
            return None;
        }
        let breaks = curve.knots.breaks();
        let power = breaks
            .windows(2)
            .map(|w| {
                let span = curve.knots.span(0.5 * (w[0] + w[1]));
                let h = w[1] - w[0];
                let jet = |t: f64| {
                    let b = curve.knots.basis_on_span(span, t, 2);
                    let mut out = [[0.0; D]; 3];
                    for (row, values) in out.iter_mut().zip(&b.rows) {
                        for j in 0..=curve.knots.degree() {
                            for d in 0..D {
                                row[d] += values[j] * curve.control[b.first + j][d];
                            }
                        }
                    }
                    out
                };
                let (a, b) = (jet(w[0]), jet(w[1]));
                let mut c = [[0.0; D]; 4];
                for d in 0..D {
                    // The second derivative is linear, so its end values give the cubic coefficient.
                    c[0][d] = a[0][d];
                    c[1][d] = a[1][d];
                    c[2][d] = 0.5 * a[2][d];
                    c[3][d] = (b[2][d] - a[2][d]) / (6.0 * h);
                }
                c
            })
            .collect();
        Some(Self { breaks, power })
    }

    /// Ends of the domain.
    pub fn domain(&self) -> (f64, f64) {
        (self.breaks[0], self.breaks[self.breaks.len() - 1])
    }

    /// Value and first two derivatives at `t`.
    #[inline]
    pub fn jet(&self, t: f64) -> [[f64; D]; 3] {
        let s = span_of(&self.breaks, t);
        let (x, c) = (t - self.breaks[s], &self.power[s]);
        let mut out = [[0.0; D]; 3];
        for d in 0..D {
            out[0][d] = c[0][d] + x * (c[1][d] + x * (c[2][d] + x * c[3][d]));
            out[1][d] = c[1][d] + x * (2.0 * c[2][d] + x * 3.0 * c[3][d]);
            out[2][d] = 2.0 * c[2][d] + 6.0 * x * c[3][d];
        }
        out
    }

    /// The function on a domain with other ends: inner breaks stay, breaks beyond the ends are dropped, the outermost
    /// polynomials are continued. An end that would leave a span shorter than `shortest` is moved outwards.
    pub fn on(&self, a: f64, b: f64, shortest: f64) -> Self {
        let inner = |t: &&f64| **t > a && **t < b;
        let inside: Vec<f64> = self.breaks[1..self.breaks.len() - 1].iter().filter(inner).copied().collect();
        let a = inside.first().map_or(a, |&t| a.min(t - shortest));
        let b = inside.last().map_or(b, |&t| b.max(t + shortest));
        let mut breaks = vec![a];
        breaks.extend(inside);
        breaks.push(b);
        let power = breaks
            .windows(2)
            .map(|w| {
                let s = span_of(&self.breaks, 0.5 * (w[0] + w[1]));
                let (x, c) = (w[0] - self.breaks[s], &self.power[s]);
                let mut out = [[0.0; D]; 4];
                for d in 0..D {
                    out[0][d] = c[0][d] + x * (c[1][d] + x * (c[2][d] + x * c[3][d]));
                    out[1][d] = c[1][d] + x * (2.0 * c[2][d] + x * 3.0 * c[3][d]);
                    out[2][d] = c[2][d] + 3.0 * x * c[3][d];
                    out[3][d] = c[3][d];
                }
                out
            })
            .collect();
        Self { breaks, power }
    }

    /// The curve with clamped ends and simple inner knots. Exact (up to rounding) when neighbouring pieces agree to
    /// the second derivative.
    ///
    /// # Errors
    /// Breaks that do not increase, values that are not finite.
    pub fn to_curve(&self) -> Result<Curve<D>, SplineError> {
        let knots = Knots::clamped(3, &self.breaks)?;
        let v = knots.values();
        let control = (0..knots.control_count())
            .map(|i| {
                // The blossom of any piece on whose span the function is not zero; the middle one is best conditioned.
                let s = span_of(&self.breaks, (v[i + 1] + v[i + 2] + v[i + 3]) / 3.0);
                let t = self.breaks[s];
                let (x, y, z) = (v[i + 1] - t, v[i + 2] - t, v[i + 3] - t);
                let c = &self.power[s];
                std::array::from_fn(|d| {
                    c[0][d]
                        + c[1][d] * (x + y + z) / 3.0
                        + c[2][d] * (x * y + y * z + z * x) / 3.0
                        + c[3][d] * x * y * z
                })
            })
            .collect();
        Curve::new(3, v.to_vec(), control)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Curve<2> {
        let c = vec![[0.0, 1.0], [1.0, 0.5], [-1.0, 2.0], [0.5, 0.0], [2.0, 1.0], [0.0, -1.0]];
        Curve::new(3, vec![0., 0., 0., 0., 0.3, 0.7, 1., 1., 1., 1.], c).expect("curve")
    }

    #[test]
    fn pieces_and_curve_are_the_same_function() {
        let c = sample();
        let p = Pieces::of(&c).expect("cubic");
        let back = p.to_curve().expect("curve");
        for i in 0..=50 {
            let t = i as f64 / 50.0;
            for (a, b) in c.jet(t).iter().flatten().zip(p.jet(t).iter().flatten()) {
                assert!((a - b).abs() < 1e-11);
            }
        }
        for (a, b) in c.control.iter().flatten().zip(back.control.iter().flatten()) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn other_ends_keep_the_function() {
        let c = sample();
        let p = Pieces::of(&c).expect("cubic");
        for (a, b) in [(-0.2, 1.3), (0.4, 0.9), (0.1, 0.2)] {
            let q = p.on(a, b, 0.01).to_curve().expect("curve");
            for i in 0..=20 {
                let t = a + (b - a) * i as f64 / 20.0;
                for d in 0..2 {
                    assert!((q.point(t)[d] - p.jet(t)[0][d]).abs() < 1e-11);
                }
            }
        }
    }
}
