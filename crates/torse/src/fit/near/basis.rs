//! Functions of one variable span by span, for the unknown splines of a fit.

use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::knots::Knots;

/// Functions on common spans, each span with at most four that do not vanish, in powers of the distance from the
/// span's start.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    /// Number of functions.
    pub count: usize,
    /// Number of functions per span.
    pub active: usize,
    /// First function of each span.
    pub first: Vec<usize>,
    /// `power[s][j]`: coefficients of function `first[s] + j` on span s.
    pub power: Vec<[[f64; 4]; 4]>,
}

impl Basis {
    /// Cubic B-splines on `knots`, whose breaks must be among `breaks`.
    pub fn spline(knots: &Knots, breaks: &[f64]) -> Self {
        let (mut first, mut power) = (Vec::new(), Vec::new());
        for w in breaks.windows(2) {
            let span = knots.span(0.5 * (w[0] + w[1]));
            let (a, b) = (knots.basis_on_span(span, w[0], 2), knots.basis_on_span(span, w[1], 2));
            first.push(a.first);
            power.push(std::array::from_fn(|j| {
                let third = (b.rows[2][j] - a.rows[2][j]) / (6.0 * (w[1] - w[0]));
                [a.rows[0][j], a.rows[1][j], 0.5 * a.rows[2][j], third]
            }));
        }
        Self { count: knots.control_count(), active: 4, first, power }
    }

    /// The function 1, or 1 and the linear function that is ∓1 at the ends.
    pub fn polynomial(linear: bool, breaks: &[f64]) -> Self {
        let (lo, hi) = (breaks[0], breaks[breaks.len() - 1]);
        let half = 0.5 * (hi - lo);
        let power = breaks.windows(2).map(|w| {
            let mut p = [[0.0; 4]; 4];
            p[0][0] = 1.0;
            if linear {
                p[1] = [(w[0] - lo) / half - 1.0, 1.0 / half, 0.0, 0.0];
            }
            p
        });
        let count = 1 + usize::from(linear);
        Self { count, active: count, first: vec![0; breaks.len() - 1], power: power.collect() }
    }

    /// Power coefficients on span `s` of the function with the given coefficients.
    #[inline]
    pub fn combine(&self, s: usize, coefficients: &[f64]) -> [f64; 4] {
        let mut out = [0.0; 4];
        for j in 0..self.active {
            let c = coefficients[self.first[s] + j];
            for k in 0..4 {
                out[k] += c * self.power[s][j][k];
            }
        }
        out
    }

    /// Coefficients of the function nearest to `value` at points spread over the spans.
    pub fn project(&self, breaks: &[f64], value: impl Fn(f64) -> f64) -> Vec<f64> {
        // Points per span: one more than the degree.
        const POINTS: usize = 4;
        let mut rows = Rows::new(self.count, self.active);
        let mut matrix = BandMatrix::zeros(self.count, self.active);
        let mut out = vec![0.0; self.count];
        for s in 0..breaks.len() - 1 {
            let h = breaks[s + 1] - breaks[s];
            for k in 0..POINTS {
                let x = h * k as f64 / (POINTS - 1) as f64;
                let (_, row) = rows.push(self.first[s]);
                for j in 0..self.active {
                    row[j] = cubic(&self.power[s][j], x);
                }
                let i = rows.len() - 1;
                matrix.add_row(&rows, i, 1.0);
                rows.scatter(i, value(breaks[s] + x), &mut out);
            }
        }
        if matrix.factorise() {
            matrix.solve(&mut out);
        }
        out
    }
}

/// Value of a cubic in power form.
#[inline]
pub(crate) fn cubic(c: &[f64; 4], x: f64) -> f64 {
    c[0] + x * (c[1] + x * (c[2] + x * c[3]))
}
