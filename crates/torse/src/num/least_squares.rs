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

/// Adds `scale` times `b` to `a`, as far as both go.
#[inline]
fn add_scaled(a: &mut [f64], scale: f64, b: &[f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += scale * b;
    }
}

/// Symmetric banded matrix; only the upper half is stored, row by row from the diagonal on. Rows reach beyond the last
/// column with zeros.
#[derive(Clone, Debug)]
pub(crate) struct BandMatrix {
    size: usize,
    width: usize,
    values: Vec<f64>,
}

/// Rows of a factor that are taken off the rest together.
const TOGETHER: usize = 4;

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
        self.values[i * self.width]
    }

    /// Entry in row `i` and column `j`.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        if i - j >= self.width {
            return 0.0;
        }
        self.values[j * self.width + (i - j)]
    }

    /// Adds `value` to the diagonal entry `i`.
    pub fn add_diagonal(&mut self, i: usize, value: f64) {
        self.values[i * self.width] += value;
    }

    /// Adds `value` to the entry in row `i` and column `j ≤ i`, and so to its mirror image.
    pub fn add_entry(&mut self, i: usize, j: usize, value: f64) {
        self.values[j * self.width + (i - j)] += value;
    }

    /// Adds `weight · rᵀ r` for row `i` of `rows`.
    #[inline]
    pub fn add_row(&mut self, rows: &Rows, i: usize, weight: f64) {
        let (first, row) = rows.row(i);
        for (q, &v) in row.iter().enumerate() {
            let s = weight * v;
            if s != 0.0 {
                add_scaled(&mut self.values[(first + q) * self.width..], s, &row[q..]);
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
                for q in 0..rows.width {
                    let s = [0, 1, 2, 3].map(|k: usize| w[k] * r[k][q]);
                    if s == [0.0; 4] {
                        continue;
                    }
                    let out = &mut self.values[(first + q) * self.width..][..rows.width - q];
                    add_scaled_four(out, s, r.map(|r| &r[q..]));
                }
            }
        }
    }

    /// Product with a vector.
    pub fn product(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for i in 0..self.size {
            let row = self.row(i);
            out[i] += row[0] * x[i] + dot(&row[1..], &x[i + 1..i + row.len()]);
            add_scaled(&mut out[i + 1..], x[i], &row[1..]);
        }
    }

    /// Row `i` from the diagonal on, as far as the matrix goes.
    #[inline]
    fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.width..][..self.width.min(self.size - i)]
    }

    /// Replaces the matrix by its Cholesky factor. `false` if it is not positive definite to working precision
    /// (the content is then lost).
    pub fn factorise(&mut self) -> bool {
        // A pivot below this share of its diagonal entry is rounding error only.
        const SINGULAR: f64 = 1e-14;
        let (n, w) = (self.size, self.width);
        let diagonal: Vec<f64> = (0..n).map(|i| self.diagonal(i)).collect();
        for j in (0..n).step_by(TOGETHER) {
            let end = n.min(j + TOGETHER);
            for i in j..end {
                let pivot = self.values[i * w];
                if pivot.is_nan() || pivot <= SINGULAR * diagonal[i] {
                    return false;
                }
                let root = pivot.sqrt();
                let inverse = root.recip();
                self.values[i * w] = root;
                self.values[i * w + 1..(i + 1) * w].iter_mut().for_each(|v| *v *= inverse);
                (i + 1..end.min(i + w)).for_each(|r| self.take_off(i, r));
            }
            for r in end..n.min(end + w - 1) {
                if end - j < TOGETHER || r - j >= w {
                    ((r + 1).saturating_sub(w).max(j)..end).for_each(|i| self.take_off(i, r));
                } else {
                    self.take_off_four(j, r);
                }
            }
        }
        true
    }

    /// Takes what row `i` of the factor makes of row `r > i` off it.
    #[inline]
    fn take_off(&mut self, i: usize, r: usize) {
        let w = self.width;
        let (head, tail) = self.values.split_at_mut(r * w);
        let row = &head[i * w + (r - i)..(i + 1) * w];
        add_scaled(tail, -row[0], row);
    }

    /// The same of the four rows from `j` on, where all of them reach row `r`.
    #[inline]
    fn take_off_four(&mut self, j: usize, r: usize) {
        let w = self.width;
        let (head, tail) = self.values.split_at_mut(r * w);
        let rows = [0, 1, 2, 3].map(|p: usize| &head[(j + p) * w + (r - j - p)..(j + p + 1) * w]);
        let scales = rows.map(|row| -row[0]);
        let (common, rest) = tail.split_at_mut(w - (r - j));
        add_scaled_four(common, scales, rows);
        for (row, scale) in rows.iter().zip(scales).skip(1) {
            add_scaled(rest, scale, &row[common.len()..]);
        }
    }

    /// Solves in place with the factor left by [`BandMatrix::factorise`].
    pub fn solve(&self, x: &mut [f64]) {
        for i in 0..self.size {
            let row = self.row(i);
            let (head, tail) = x.split_at_mut(i + 1);
            head[i] /= row[0];
            add_scaled(tail, -head[i], &row[1..]);
        }
        for i in (0..self.size).rev() {
            let row = self.row(i);
            x[i] = (x[i] - dot(&row[1..], &x[i + 1..i + row.len()])) / row[0];
        }
    }
}

/// Adds four vectors, at least as long as `a` each, times numbers to `a`.
#[inline]
fn add_scaled_four(a: &mut [f64], s: [f64; 4], b: [&[f64]; 4]) {
    let [p, q, r, t] = b.map(|b| &b[..a.len()]);
    for (k, a) in a.iter_mut().enumerate() {
        *a += (s[0] * p[k] + s[1] * q[k]) + (s[2] * r[k] + s[3] * t[k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn banded_systems_are_solved_to_rounding() {
        for (n, w) in (1..14).flat_map(|n| (1..=n.min(9)).map(move |w| (n, w))) {
            let mut rows = Rows::new(n, w);
            for i in 0..3 * n {
                let (_, r) = rows.push(i % n);
                r.iter_mut().enumerate().for_each(|(k, r)| *r = ((7 * i + 3 * k) as f64).sin());
            }
            let mut m = BandMatrix::zeros(n, w);
            for i in 0..rows.len() {
                m.add_row(&rows, i, 1.0 + 0.1 * i as f64);
            }
            (0..n).for_each(|i| m.add_diagonal(i, 1.0));
            let x: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).cos()).collect();
            let mut b = vec![0.0; n];
            m.product(&x, &mut b);
            let by_entries = |i: usize| (0..n).map(|j| m.entry(i, j) * x[j]).sum::<f64>();
            assert!((0..n).all(|i| (by_entries(i) - b[i]).abs() < 1e-12 * (1.0 + b[i].abs())), "{n} {w}");
            assert!(m.factorise());
            m.solve(&mut b);
            assert!(x.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-10), "{n} {w}");
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
