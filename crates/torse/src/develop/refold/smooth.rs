//! The cubic spline through values, with as few knots as it needs: "not a knot" at both ends \[deB78\].

/// A spline through values of `D` components at increasing places.
#[derive(Clone, Debug, PartialEq)]
pub struct Smooth<const D: usize> {
    at: Vec<f64>,
    value: Vec<[f64; D]>,
    /// Second derivatives at the places.
    bend: Vec<[f64; D]>,
}

impl<const D: usize> Smooth<D> {
    /// The spline through `value` at the places `at`, which rise. With fewer than four places it is the polynomial through
    /// them; through one it is constant.
    ///
    /// *Guarantee*: a linear relation that holds for all values holds for every point of the spline, up to rounding.
    pub fn through(at: &[f64], value: &[[f64; D]]) -> Self {
        let n = at.len().min(value.len());
        let (at, value) = (at[..n].to_vec(), value[..n].to_vec());
        let mut bend = vec![[0.0; D]; n];
        if n == 3 {
            let (h, k) = (at[1] - at[0], at[2] - at[1]);
            for d in 0..D {
                let second = ((value[2][d] - value[1][d]) / k - (value[1][d] - value[0][d]) / h) * 2.0 / (h + k);
                bend.iter_mut().for_each(|b| b[d] = second);
            }
        } else if n > 3 {
            bend = second_derivatives(&at, &value);
        }
        Self { at, value, bend }
    }

    /// Value and first derivative; beyond the ends the outermost pieces go on.
    pub fn jet(&self, t: f64) -> ([f64; D], [f64; D]) {
        let n = self.at.len();
        if n < 2 {
            return (self.value.first().copied().unwrap_or([0.0; D]), [0.0; D]);
        }
        let k = self.at.partition_point(|x| *x <= t).clamp(1, n - 1);
        let h = self.at[k] - self.at[k - 1];
        let (a, b) = ((self.at[k] - t) / h, (t - self.at[k - 1]) / h);
        let (p, q, m, n) = (&self.value[k - 1], &self.value[k], &self.bend[k - 1], &self.bend[k]);
        let value = |d: usize| a * p[d] + b * q[d] + ((a * a * a - a) * m[d] + (b * b * b - b) * n[d]) * h * h / 6.0;
        let slope = |d: usize| (q[d] - p[d]) / h + ((3.0 * b * b - 1.0) * n[d] - (3.0 * a * a - 1.0) * m[d]) * h / 6.0;
        (std::array::from_fn(value), std::array::from_fn(slope))
    }
}

/// Second derivatives of the spline whose third derivative does not jump at the last place but one on either side.
fn second_derivatives<const D: usize>(at: &[f64], value: &[[f64; D]]) -> Vec<[f64; D]> {
    let n = at.len();
    let h: Vec<f64> = at.windows(2).map(|w| w[1] - w[0]).collect();
    // Inner equations; the outermost unknowns are replaced by continuations of their neighbours.
    let m = n - 2;
    let mut diagonal: Vec<f64> = (0..m).map(|i| 2.0 * (h[i] + h[i + 1])).collect();
    let (mut below, mut above) = (h[..m].to_vec(), h[1..].to_vec());
    let (r, s) = (h[0] / h[1], h[n - 2] / h[n - 3]);
    diagonal[0] += h[0] * (1.0 + r);
    above[0] -= h[0] * r;
    diagonal[m - 1] += h[n - 2] * (1.0 + s);
    below[m - 1] -= h[n - 2] * s;
    let mut right: Vec<[f64; D]> = (0..m)
        .map(|i| {
            let slope = |k: usize, d: usize| (value[k + 1][d] - value[k][d]) / h[k];
            std::array::from_fn(|d| 6.0 * (slope(i + 1, d) - slope(i, d)))
        })
        .collect();
    for i in 1..m {
        let f = below[i] / diagonal[i - 1];
        diagonal[i] -= f * above[i - 1];
        let before = right[i - 1];
        right[i].iter_mut().zip(before).for_each(|(r, b)| *r -= f * b);
    }
    let mut out = vec![[0.0; D]; n];
    for i in (0..m).rev() {
        for d in 0..D {
            let next = if i + 1 < m { above[i] * out[i + 2][d] } else { 0.0 };
            out[i + 1][d] = (right[i][d] - next) / diagonal[i];
        }
    }
    let beyond = |a: [f64; D], b: [f64; D], share: f64| std::array::from_fn(|d| a[d] + share * (a[d] - b[d]));
    out[0] = beyond(out[1], out[2], r);
    out[n - 1] = beyond(out[n - 2], out[n - 3], s);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_found_again_with_their_slopes() {
        let f = |t: f64| [1.0 + t - 2.0 * t * t + 0.3 * t * t * t, 4.0];
        for n in [1, 2, 3, 4, 5, 9] {
            let at: Vec<f64> = (0..n).map(|k| k as f64 + 0.2 * (k as f64).sin()).collect();
            // A polynomial of the degree that so few values determine.
            let p = |t: f64| if n > 3 { f(t) } else { [[2.0, 2.0 + t, 2.0 + t - t * t][n - 1], 4.0] };
            let s = Smooth::through(&at, &at.iter().map(|t| p(*t)).collect::<Vec<_>>());
            for t in [-0.4, 0.3, 1.7, at[n - 1] + 0.5] {
                let (value, slope) = s.jet(t);
                let expected = (p(t + 1e-5)[0] - p(t - 1e-5)[0]) / 2e-5;
                assert!((value[0] - p(t)[0]).abs() < 1e-9 && (slope[0] - expected).abs() < 1e-6, "{n} {t}");
                assert!((value[1] - 4.0).abs() < 1e-12);
            }
        }
    }
}
