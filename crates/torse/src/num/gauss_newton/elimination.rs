//! Elimination of the private unknowns of one block by Householder reflections.
//!
//! The rows `[√λ I 0; A B | r]` (private unknowns, shared unknowns, values) are turned so that the private columns become
//! upper triangular. What is below no longer holds private unknowns: it goes into the normal equations of the shared
//! ones. No product of matrices is formed, so nothing is lost where λ is tiny.

/// A pivot below this share of its column before elimination is rounding: the unknown then keeps its value.
const SINGULAR: f64 = 1e-13;

/// One block while it is reduced: its rows below those of the damping, of `private + shared + 1` numbers, row-major.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace {
    values: Vec<f64>,
    column: Vec<f64>,
    product: Vec<f64>,
    width: usize,
    rows: usize,
    private: usize,
    above: usize,
}

impl Workspace {
    /// Fills in weight times a block's Jacobian (shared columns before private ones) and residual, with `√λ` (`damping`)
    /// for its private unknowns; without damping there are no rows for it.
    pub fn load(&mut self, jacobian: &[f64], residual: &[f64], private: usize, weight: f64, damping: f64) {
        let rows = residual.len();
        let shared = jacobian.len() / rows.max(1) - private;
        (self.rows, self.private, self.width) = (rows, private, private + shared + 1);
        self.above = if damping > 0.0 { private } else { 0 };
        self.values.clear();
        self.values.resize((rows + self.above).max(private) * self.width, 0.0);
        for k in 0..self.above {
            self.values[k * self.width + k] = damping;
        }
        let below = &mut self.values[self.above * self.width..];
        for ((out, row), &r) in
            below.chunks_exact_mut(self.width).zip(jacobian.chunks_exact(shared + private)).zip(residual)
        {
            for (o, v) in out[..private].iter_mut().zip(&row[shared..]) {
                *o = weight * v;
            }
            for (o, v) in out[private..private + shared].iter_mut().zip(row) {
                *o = weight * v;
            }
            out[private + shared] = weight * r;
        }
    }

    /// Makes the private columns upper triangular.
    pub fn eliminate(&mut self) {
        let (n, w) = ((self.rows + self.above).max(self.private), self.width);
        for k in 0..self.private {
            let all: f64 = (0..n).map(|i| self.values[i * w + k].powi(2)).sum::<f64>().sqrt();
            let norm = (k..n).map(|i| self.values[i * w + k].powi(2)).sum::<f64>().sqrt();
            if norm <= SINGULAR * all || norm.is_nan() {
                // Nothing is left of this unknown; zero pivots are skipped when values are read back.
                (k..n).for_each(|i| self.values[i * w + k] = 0.0);
                continue;
            }
            let head = self.values[k * w + k];
            let alpha = if head > 0.0 { -norm } else { norm };
            self.column.clear();
            self.column.extend((k..n).map(|i| self.values[i * w + k]));
            self.column[0] -= alpha;
            // |v|² = 2 (norm² + |head| norm), so I − 2 v vᵀ/|v|².
            let scale = 1.0 / (norm * (norm + head.abs()));
            self.product.clear();
            self.product.resize(w - k, 0.0);
            for (v, row) in self.column.iter().zip(self.values[k * w..].chunks_exact(w)) {
                for (p, x) in self.product.iter_mut().zip(&row[k..]) {
                    *p += v * x;
                }
            }
            for (v, row) in self.column.iter().zip(self.values[k * w..].chunks_exact_mut(w)) {
                let s = scale * v;
                for (p, x) in self.product.iter().zip(&mut row[k..]) {
                    *x -= s * p;
                }
            }
            self.values[k * w + k] = alpha;
            (k + 1..n).for_each(|i| self.values[i * w + k] = 0.0);
        }
    }

    /// Rows without private unknowns: shared columns, then the value.
    pub fn reduced(&self) -> impl Iterator<Item = &[f64]> {
        self.values[self.private * self.width..].chunks_exact(self.width).map(|row| &row[self.private..])
    }

    /// Rows from which private unknowns follow.
    pub fn triangle(&self) -> &[f64] {
        &self.values[..self.private * self.width]
    }
}

/// Increments of the private unknowns from those of the shared ones, with the rows kept from [`Workspace::triangle`].
pub(super) fn substitute(triangle: &[f64], shared: impl Fn(usize) -> f64, own: &mut [f64]) {
    let private = own.len();
    if private == 0 {
        return;
    }
    let width = triangle.len() / private;
    for k in (0..private).rev() {
        let row = &triangle[k * width..(k + 1) * width];
        let mut s = -row[width - 1];
        for j in k + 1..private {
            s -= row[j] * own[j];
        }
        for (j, v) in row[private..width - 1].iter().enumerate() {
            s -= v * shared(j);
        }
        own[k] = if row[k] == 0.0 { 0.0 } else { s / row[k] };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elimination_agrees_with_the_whole_system() {
        // Two shared and two private unknowns, four rows: normal equations of all against the reduced ones.
        let jacobian: Vec<f64> = (0..16).map(|i| ((i * i) as f64 * 0.37).sin() + 0.1 * i as f64).collect();
        let residual = [0.3, -0.2, 0.9, 0.4];
        let lambda = 0.01_f64;
        let mut w = Workspace::default();
        w.load(&jacobian, &residual, 2, 1.0, lambda.sqrt());
        w.eliminate();
        let mut m = nalgebra::Matrix2::<f64>::identity() * lambda;
        let mut g = nalgebra::Vector2::<f64>::zeros();
        for row in w.reduced() {
            let v = nalgebra::Vector2::new(row[0], row[1]);
            m += v * v.transpose();
            g -= v * row[2];
        }
        let dx = m.lu().solve(&g).expect("regular");
        let mut own = [0.0; 2];
        substitute(w.triangle(), |j| dx[j], &mut own);
        let j = nalgebra::Matrix4::from_row_slice(&jacobian);
        let f = nalgebra::Vector4::from_row_slice(&residual);
        let whole = j.transpose() * j + nalgebra::Matrix4::identity() * lambda;
        let all = whole.lu().solve(&-(j.transpose() * f)).expect("regular");
        for (a, b) in [dx[0], dx[1], own[0], own[1]].iter().zip(all.iter()) {
            assert!((a - b).abs() < 1e-10, "{a} {b}");
        }
    }
}
