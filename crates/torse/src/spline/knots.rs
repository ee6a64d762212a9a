//! Knot vectors: spans, multiplicities and basis functions with derivatives (Cox–de Boor).

use super::{SplineError, MAX_DEGREE};

/// Parameters nearer than this share of their domain or period are one: what ten printed digits and shifts by whole
/// periods lose.
pub(crate) const SAME_PARAMETER: f64 = 1e-9;

/// A non-decreasing knot vector `T_0 ≤ … ≤ T_{n+p}` for `n` control points of degree `p`
/// (NURBS-book convention: `p + 1` knots before the domain ends, clamped or not).
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    degree: usize,
    values: Vec<f64>,
}

/// Values and derivatives of the `degree + 1` basis functions that are not zero on a span.
#[derive(Clone, Copy, Debug)]
pub struct BasisJet {
    /// Index of the first control point concerned.
    pub first: usize,
    /// `rows[k][j]`: k-th derivative of basis function `first + j`.
    pub rows: [[f64; MAX_DEGREE + 1]; 3],
}

impl Knots {
    /// Checks and stores a knot vector for `control` control points.
    ///
    /// # Errors
    /// Wrong degree, count, order, or multiplicity (interior knots may be repeated up to `degree` times).
    pub fn new(degree: usize, values: Vec<f64>, control: usize) -> Result<Self, SplineError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(SplineError::Degree(degree));
        }
        if control < degree + 1 || values.len() != control + degree + 1 {
            return Err(SplineError::KnotCount { knots: values.len(), control, degree });
        }
        for (index, &value) in values.iter().enumerate() {
            if !value.is_finite() || (index > 0 && value < values[index - 1]) {
                return Err(SplineError::KnotOrder { index, value });
            }
        }
        let k = Self { degree, values };
        let (a, b) = k.domain();
        if a >= b {
            return Err(SplineError::Multiplicity { value: a, multiplicity: k.values.len(), allowed: degree + 1 });
        }
        for (value, multiplicity) in k.distinct() {
            let allowed = if value <= a || value >= b { degree + 1 } else { degree };
            if multiplicity > allowed {
                return Err(SplineError::Multiplicity { value, multiplicity, allowed });
            }
        }
        Ok(k)
    }

    /// Clamped knots with simple interior knots: `breaks` increasing, at least two.
    ///
    /// # Errors
    /// As [`Knots::new`].
    pub fn clamped(degree: usize, breaks: &[f64]) -> Result<Self, SplineError> {
        let (Some(&a), Some(&b)) = (breaks.first(), breaks.last()) else {
            return Err(SplineError::KnotCount { knots: 0, control: 0, degree });
        };
        let mut values = vec![a; degree + 1];
        values.extend_from_slice(&breaks[1..breaks.len() - 1]);
        values.extend(std::iter::repeat_n(b, degree + 1));
        let control = values.len() - degree - 1;
        Self::new(degree, values, control)
    }

    /// Clamped uniform knots with `spans` spans on `[a, b]`.
    ///
    /// # Errors
    /// As [`Knots::new`].
    pub fn uniform(degree: usize, spans: usize, a: f64, b: f64) -> Result<Self, SplineError> {
        let breaks: Vec<f64> =
            (0..=spans).map(|i| if i == spans { b } else { a + (b - a) * i as f64 / spans as f64 }).collect();
        Self::clamped(degree, &breaks)
    }

    /// Knots of the splines run through backwards, on the same domain.
    pub fn reversed(&self) -> Self {
        let (a, b) = self.domain();
        // The ends are kept exactly; `a + b − x` would move them by rounding.
        let mirror = |x: f64| {
            if x <= a {
                b + (a - x)
            } else if x >= b {
                a - (x - b)
            } else {
                (a + (b - x)).clamp(a, b)
            }
        };
        // Order and multiplicities are mirrored with the values, so nothing needs to be checked again.
        Self { degree: self.degree, values: self.values.iter().rev().map(|&x| mirror(x)).collect() }
    }

    /// Polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, repeated ones included.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Number of control points.
    pub fn control_count(&self) -> usize {
        self.values.len() - self.degree - 1
    }

    /// Ends of the parameter domain.
    pub fn domain(&self) -> (f64, f64) {
        (self.values[self.degree], self.values[self.values.len() - 1 - self.degree])
    }

    /// Distinct knot values with multiplicities, in order.
    pub fn distinct(&self) -> Vec<(f64, usize)> {
        let mut out: Vec<(f64, usize)> = Vec::new();
        for &v in &self.values {
            match out.last_mut() {
                Some(last) if last.0 >= v => last.1 += 1,
                _ => out.push((v, 1)),
            }
        }
        out
    }

    /// Distinct knot values inside the closed domain: the ends of the polynomial pieces.
    pub fn breaks(&self) -> Vec<f64> {
        let (a, b) = self.domain();
        self.distinct().into_iter().map(|(v, _)| v).filter(|&v| v >= a && v <= b).collect()
    }

    /// Index `i` of the span `T_i ≤ t < T_{i+1}` used for `t`; `t` is clamped to the domain, its right end
    /// belongs to the last span.
    #[inline]
    pub fn span(&self, t: f64) -> usize {
        let (p, n) = (self.degree, self.control_count());
        let v = &self.values;
        if t >= v[n] {
            let mut i = n - 1;
            while v[i] >= v[n] {
                i -= 1;
            }
            return i;
        }
        if t <= v[p] {
            let mut i = p;
            while v[i + 1] <= v[p] {
                i += 1;
            }
            return i;
        }
        // Halving without branches: the last index in p..n whose knot is not above t.
        let (mut base, mut size) = (p, n - p);
        while size > 1 {
            let half = size / 2;
            base = if v[base + half] <= t { base + half } else { base };
            size -= half;
        }
        base
    }

    /// Basis functions of degree `N − 1` at `t` with first and second derivatives, and the index of the first
    /// control point concerned: [`Knots::basis`] for a degree known at compile time, without the wide rows. The
    /// degree of the knots must be `N − 1`.
    #[inline(always)]
    pub(crate) fn basis_fixed<const N: usize>(&self, t: f64) -> (usize, [[f64; N]; 3]) {
        let p = N - 1;
        debug_assert_eq!(p, self.degree);
        let span = self.span(t);
        // T_{span+1−p} … T_{span+p}: all knots that matter.
        let w = &self.values[span + 1 - p..span + 1 + p];
        let mut rows = [[0.0; N]; 3];
        let mut cur = [0.0; N];
        let mut slope = [0.0; N]; // first derivatives of the functions of degree p − 1
        cur[0] = 1.0;
        for d in 1..p {
            let mut saved = 0.0;
            let mut before = 0.0;
            for r in 0..d {
                let (right, left) = (w[p + r], w[p + r - d]);
                let temp = cur[r] / (right - left);
                cur[r] = saved + (right - t) * temp;
                saved = (t - left) * temp;
                if d + 1 == p {
                    slope[r] = d as f64 * (before - temp);
                    before = temp;
                }
            }
            cur[d] = saved;
            if d + 1 == p {
                slope[d] = d as f64 * before;
            }
        }
        let degree = p as f64;
        let (mut saved, mut before, mut before2) = (0.0, 0.0, 0.0);
        for r in 0..p {
            let (right, left) = (w[p + r], w[r]);
            let inverse = 1.0 / (right - left);
            let value = cur[r] * inverse;
            let (temp, temp2) = (degree * value, degree * slope[r] * inverse);
            rows[0][r] = saved + (right - t) * value;
            saved = (t - left) * value;
            rows[1][r] = before - temp;
            rows[2][r] = before2 - temp2;
            before = temp;
            before2 = temp2;
        }
        rows[0][p] = saved;
        rows[1][p] = before;
        rows[2][p] = before2;
        (span - p, rows)
    }

    /// Basis functions on the span of `t` with derivatives up to `order ≤ 2`. No allocation.
    /// Outside the domain the polynomial of the first or last span is continued.
    #[inline]
    pub fn basis(&self, t: f64, order: usize) -> BasisJet {
        self.basis_on_span(self.span(t), t, order)
    }

    /// As [`Knots::basis`], on a given span (its polynomial is continued outside the span).
    pub fn basis_on_span(&self, span: usize, t: f64, order: usize) -> BasisJet {
        let p = self.degree;
        let v = &self.values;
        let mut rows = [[0.0; MAX_DEGREE + 1]; 3];
        // Triangular table by degree: `cur` holds the functions of the degree reached.
        let mut cur = [0.0; MAX_DEGREE + 1];
        let mut lower = [[0.0; MAX_DEGREE + 1]; 2]; // degrees p-1 and p-2
        cur[0] = 1.0;
        for d in 1..=p {
            if d == p {
                lower[0] = cur;
            }
            if d + 1 == p {
                lower[1] = cur;
            }
            let mut saved = 0.0;
            for r in 0..d {
                let right = v[span + r + 1];
                let left = v[span + 1 + r - d];
                let temp = cur[r] / (right - left);
                cur[r] = saved + (right - t) * temp;
                saved = (t - left) * temp;
            }
            cur[d] = saved;
        }
        rows[0] = cur;
        if order >= 1 {
            difference(&mut rows[1], &lower[0], v, span, p);
        }
        if order >= 2 && p >= 2 {
            let mut first = [0.0; MAX_DEGREE + 1];
            difference(&mut first, &lower[1], v, span, p - 1);
            let source = first;
            difference(&mut rows[2], &source, v, span, p);
        }
        BasisJet { first: span - p, rows }
    }
}

/// Derivative of degree-`d` functions on `span` from the values `low` of the degree-`d−1` functions:
/// `N'_i = d (N_{i,d−1}/(T_{i+d}−T_i) − N_{i+1,d−1}/(T_{i+d+1}−T_{i+1}))`.
fn difference(out: &mut [f64; MAX_DEGREE + 1], low: &[f64; MAX_DEGREE + 1], v: &[f64], span: usize, d: usize) {
    for j in 0..=d {
        let i = span - d + j;
        let mut s = 0.0;
        if j > 0 {
            s += low[j - 1] / (v[i + d] - v[i]);
        }
        if j < d {
            s -= low[j] / (v[i + d + 1] - v[i + 1]);
        }
        out[j] = d as f64 * s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn basis_is_a_partition_of_unity_with_consistent_derivatives() {
        let k = Knots::new(3, vec![0., 0., 0., 0., 0.3, 0.5, 0.5, 1., 1., 1., 1.], 7).expect("valid knots");
        for i in 0..=100 {
            let t = i as f64 / 100.0;
            let b = k.basis(t, 2);
            let sum: f64 = b.rows[0].iter().sum();
            assert!((sum - 1.0).abs() < 1e-14);
            assert!(b.rows[1].iter().sum::<f64>().abs() < 1e-12);
            assert!(b.rows[2].iter().sum::<f64>().abs() < 1e-10);
            let h = 1e-6;
            let span = k.span(t);
            let (m, q) = (k.basis_on_span(span, t - h, 1), k.basis_on_span(span, t + h, 1));
            for j in 0..4 {
                assert!(((q.rows[0][j] - m.rows[0][j]) / (2.0 * h) - b.rows[1][j]).abs() < 1e-6);
                assert!(((q.rows[1][j] - m.rows[1][j]) / (2.0 * h) - b.rows[2][j]).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn degrees_known_at_compile_time_agree_with_any_degree() {
        fn check<const N: usize>() {
            let p = N - 1;
            let mut values = vec![-1.0; p + 1];
            values.extend([-0.5, 0.25, 0.3, 1.5]);
            values.extend(vec![0.7; p]);
            values.sort_by(f64::total_cmp);
            values.extend(vec![2.0; p + 1]);
            values.sort_by(f64::total_cmp);
            let control = values.len() - p - 1;
            let k = Knots::new(p, values, control).expect("valid knots");
            for i in -5..=305 {
                let t = -1.0 + 3.0 * f64::from(i) / 300.0;
                let (slow, (first, fast)) = (k.basis(t, 2), k.basis_fixed::<N>(t));
                assert_eq!(slow.first, first);
                for (row, wide) in fast.iter().zip(&slow.rows) {
                    let size = wide.iter().fold(1.0f64, |m, x| m.max(x.abs()));
                    for j in 0..N {
                        assert!((row[j] - wide[j]).abs() <= 1e-13 * size, "degree {p}, t = {t}");
                    }
                }
            }
        }
        check::<2>();
        check::<3>();
        check::<4>();
        check::<5>();
        check::<6>();
    }
}
