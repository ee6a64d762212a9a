//! Weighted least squares with sparse rows: every row has its entries in one run of neighbouring columns, so that
//! the normal matrix is banded. Dense problems are the special case in which the run covers all columns.
//!
//! Source: any text on linear algebra (banded Cholesky factorisation); nothing here knows what the columns mean.

/// Rows of a linear problem, each with `width` entries from column `first` on.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    columns: usize,
    width: usize,
    first: Vec<usize>,
    values: Vec<f64>,
}

impl Rows {
    /// No rows yet; `width` is the length of the run of entries of every row, at most `columns`.
    pub fn new(columns: usize, width: usize) -> Self {
        Self { columns, width: width.min(columns), first: Vec::new(), values: Vec::new() }
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// Removes all rows and keeps the memory.
    pub fn clear(&mut self) {
        self.first.clear();
        self.values.clear();
    }

    /// Appends a row of zeros whose run starts at column `first` (moved left where it would leave the matrix) and
    /// gives its entries, together with the column of the first of them.
    pub fn push(&mut self, first: usize) -> (usize, &mut [f64]) {
        let first = first.min(self.columns - self.width);
        let start = self.values.len();
        self.first.push(first);
        self.values.resize(start + self.width, 0.0);
        (first, &mut self.values[start..])
    }

    /// First column and entries of row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> (usize, &[f64]) {
        (self.first[i], &self.values[i * self.width..(i + 1) * self.width])
    }

    /// The numbers of all rows by the column at which they start.
    pub fn order(&self, out: &mut Vec<usize>) {
        out.clear();
        out.extend(0..self.len());
        out.sort_by_key(|&i| self.first[i]);
    }

    /// Product of row `i` with the vector `x`.
    #[inline]
    pub fn dot(&self, i: usize, x: &[f64]) -> f64 {
        let (first, row) = self.row(i);
        dot(row, &x[first..first + row.len()])
    }

    /// Adds `scale` times row `i` to the vector `out`.
    #[inline]
    pub fn scatter(&self, i: usize, scale: f64, out: &mut [f64]) {
        let (first, row) = self.row(i);
        for (o, a) in out[first..].iter_mut().zip(row) {
            *o += scale * a;
        }
    }
}

/// Scalar product of two vectors of the same length, in four sums that do not wait for each other.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 4;
    let (fours_a, fours_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = fours_a.remainder().iter().zip(fours_b.remainder()).map(|(x, y)| x * y).sum();
    let mut sums = [0.0; LANES];
    for (p, q) in fours_a.zip(fours_b) {
        for (s, (x, y)) in sums.iter_mut().zip(p.iter().zip(q)) {
            *s += x * y;
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// Symmetric banded matrix; only the lower half is stored, row by row.
#[derive(Clone, Debug)]
pub(crate) struct BandMatrix {
    size: usize,
    width: usize,
    values: Vec<f64>,
}

impl BandMatrix {
    /// The zero matrix of `size` rows whose entries further than `width − 1` from the diagonal vanish.
    pub fn zeros(size: usize, width: usize) -> Self {
        let width = width.clamp(1, size.max(1));
        Self { size, width, values: vec![0.0; size * width] }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Becomes a copy of `other` (same shape) without allocation.
    pub fn assign(&mut self, other: &Self) {
        self.size = other.size;
        self.width = other.width;
        self.values.clone_from(&other.values);
    }

    /// The matrix times a number.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|v| *v *= factor);
        self
    }

    /// Becomes zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Diagonal entry `i`.
    pub fn diagonal(&self, i: usize) -> f64 {
        self.values[(i + 1) * self.width - 1]
    }

    /// Entry in row `i` and column `j`.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        if i - j >= self.width {
            return 0.0;
        }
        self.values[(i + 1) * self.width - 1 - (i - j)]
    }

    /// Adds `value` to the diagonal entry `i`.
    pub fn add_diagonal(&mut self, i: usize, value: f64) {
        self.values[(i + 1) * self.width - 1] += value;
    }

    /// Adds `value` to the entry in row `i` and column `j ≤ i`, and so to its mirror image.
    pub fn add_entry(&mut self, i: usize, j: usize, value: f64) {
        self.values[(i + 1) * self.width - 1 - (i - j)] += value;
    }

    /// Adds `weight · rᵀ r` for row `i` of `rows`.
    #[inline]
    pub fn add_row(&mut self, rows: &Rows, i: usize, weight: f64) {
        let (first, row) = rows.row(i);
        let w = self.width;
        for (p, &v) in row.iter().enumerate() {
            let s = weight * v;
            if s == 0.0 {
                continue;
            }
            let end = (first + p + 1) * w;
            for (o, a) in self.values[end - p - 1..end].iter_mut().zip(row) {
                *o += s * a;
            }
        }
    }

    /// Adds `weights[i] · rᵢᵀ rᵢ` for all rows. `order` has their numbers by the column at which they start
    /// ([`Rows::order`]): four rows that start together are added at once.
    pub fn add_rows(&mut self, rows: &Rows, order: &[usize], weights: &[f64]) {
        for together in order.chunk_by(|&i, &j| rows.first[i] == rows.first[j]) {
            let fours = together.chunks_exact(4);
            for &i in fours.remainder() {
                self.add_row(rows, i, weights[i]);
            }
            for four in fours {
                let w = [0, 1, 2, 3].map(|k: usize| weights[four[k]]);
                let (first, _) = rows.row(four[0]);
                let r = [0, 1, 2, 3].map(|k: usize| rows.row(four[k]).1);
                for p in 0..rows.width {
                    let s = [0, 1, 2, 3].map(|k: usize| w[k] * r[k][p]);
                    if s == [0.0; 4] {
                        continue;
                    }
                    let end = (first + p + 1) * self.width;
                    let out = &mut self.values[end - p - 1..end];
                    let [a, b, c, d] = r.map(|r| &r[..out.len()]);
                    for (q, o) in out.iter_mut().enumerate() {
                        *o += (s[0] * a[q] + s[1] * b[q]) + (s[2] * c[q] + s[3] * d[q]);
                    }
                }
            }
        }
    }

    /// Product with a vector.
    pub fn product(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for i in 0..self.size {
            let lo = (i + 1).saturating_sub(self.width);
            let row = &self.values[(i + 1) * self.width - (i - lo) - 1..(i + 1) * self.width];
            for (k, &v) in row.iter().enumerate() {
                let j = lo + k;
                out[i] += v * x[j];
                if j != i {
                    out[j] += v * x[i];
                }
            }
        }
    }

    /// Replaces the matrix by its Cholesky factor. `false` if it is not positive definite to working precision
    /// (the content is then lost).
    pub fn factorise(&mut self) -> bool {
        // A pivot below this share of its diagonal entry is rounding error only.
        const SINGULAR: f64 = 1e-14;
        let w = self.width;
        for i in 0..self.size {
            let lo = (i + 1).saturating_sub(w);
            for j in lo..=i {
                let lo_j = (j + 1).saturating_sub(w).max(lo);
                let (head, tail) = self.values.split_at_mut(i * w);
                let row_i = &mut tail[..w];
                let at_i = |column: usize| column + w - 1 - i;
                if j == i {
                    let tail = &row_i[at_i(lo)..w - 1];
                    let s = dot(tail, tail);
                    let d = row_i[w - 1];
                    let pivot = d - s;
                    if pivot.is_nan() || pivot <= SINGULAR * d {
                        return false;
                    }
                    row_i[w - 1] = pivot.sqrt();
                } else {
                    let row_j = &head[j * w..(j + 1) * w];
                    let a = &row_i[at_i(lo_j)..at_i(j)];
                    let b = &row_j[w - 1 - (j - lo_j)..w - 1];
                    let s = dot(a, b);
                    let c = at_i(j);
                    row_i[c] = (row_i[c] - s) / row_j[w - 1];
                }
            }
        }
        true
    }

    /// Solves in place with the factor left by [`BandMatrix::factorise`].
    pub fn solve(&self, x: &mut [f64]) {
        let w = self.width;
        for i in 0..self.size {
            let lo = (i + 1).saturating_sub(w);
            let row = &self.values[(i + 1) * w - (i - lo) - 1..(i + 1) * w];
            let s = dot(&row[..i - lo], &x[lo..i]);
            x[i] = (x[i] - s) / row[i - lo];
        }
        for i in (0..self.size).rev() {
            let lo = (i + 1).saturating_sub(w);
            let row = &self.values[(i + 1) * w - (i - lo) - 1..(i + 1) * w];
            x[i] /= row[i - lo];
            let s = x[i];
            for (o, a) in x[lo..i].iter_mut().zip(&row[..i - lo]) {
                *o -= a * s;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn banded_system_is_solved_to_rounding() {
        let (n, w) = (9, 3);
        let mut rows = Rows::new(n, w);
        for i in 0..n {
            let (_, r) = rows.push(i);
            r.copy_from_slice(&[1.0 + i as f64, -0.5, 0.25 * i as f64]);
        }
        for i in 0..n - 2 {
            let (_, r) = rows.push(i);
            r.copy_from_slice(&[0.3, 2.0, 1.0]);
        }
        let mut m = BandMatrix::zeros(n, w);
        let weights: Vec<f64> = (0..rows.len()).map(|i| 1.0 + 0.1 * i as f64).collect();
        for (i, &weight) in weights.iter().enumerate() {
            m.add_row(&rows, i, weight);
        }
        let x: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut b = vec![0.0; n];
        m.product(&x, &mut b);
        assert!(m.factorise());
        m.solve(&mut b);
        for (a, b) in x.iter().zip(&b) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn rows_added_together_are_those_added_one_by_one() {
        let (n, w) = (8, 3);
        let mut rows = Rows::new(n, w);
        for i in 0..40 {
            let x = 0.3 * i as f64;
            rows.push((7 * i) % 6).1.copy_from_slice(&[x.sin(), if i % 3 == 0 { 0.0 } else { x.cos() }, 1.0]);
        }
        let weights: Vec<f64> = (0..40).map(|i| 0.1 + i as f64).collect();
        let (mut one, mut all, mut order) = (BandMatrix::zeros(n, w), BandMatrix::zeros(n, w), Vec::new());
        for (i, &weight) in weights.iter().enumerate() {
            one.add_row(&rows, i, weight);
        }
        rows.order(&mut order);
        all.add_rows(&rows, &order, &weights);
        for i in 0..n {
            for j in 0..=i {
                let (a, b) = (one.entry(i, j), all.entry(i, j));
                assert!((a - b).abs() <= 1e-12 * (1.0 + a.abs()), "{i} {j}: {a} {b}");
            }
        }
    }

    #[test]
    fn singular_matrix_is_reported() {
        let mut rows = Rows::new(3, 3);
        rows.push(0).1.copy_from_slice(&[1.0, 2.0, 3.0]);
        let mut m = BandMatrix::zeros(3, 3);
        m.add_row(&rows, 0, 1.0);
        assert!(!m.factorise());
    }
}
