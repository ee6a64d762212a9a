//! Sparse rows whose entries come in runs of neighbouring columns, and such rows by their runs: many have the same ones, and are
//! dense matrices together.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Sparse rows whose entries come in runs of neighbouring columns.
#[derive(Clone, Debug, Default)]
pub struct Runs {
    /// First column and length of each run.
    runs: Vec<(usize, usize)>,
    values: Vec<f64>,
    /// For each row the ends of its runs and of its values.
    ends: Vec<(usize, usize)>,
}

impl Runs {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Adds a run to the row that is being written. Runs of one row must not overlap.
    pub fn run(&mut self, first: usize, values: impl IntoIterator<Item = f64>) {
        let before = self.values.len();
        self.values.extend(values);
        let count = self.values.len() - before;
        if count > 0 {
            self.runs.push((first, count));
        }
    }

    /// Ends the row.
    pub fn end(&mut self) {
        self.ends.push((self.runs.len(), self.values.len()));
    }

    /// Appends the rows of others.
    pub fn append(&mut self, others: &Self) {
        let (runs, values) = (self.runs.len(), self.values.len());
        self.runs.extend_from_slice(&others.runs);
        self.values.extend_from_slice(&others.values);
        self.ends.extend(others.ends.iter().map(|e| (e.0 + runs, e.1 + values)));
    }

    /// First column and values of every run of a row.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &[f64])> + Clone {
        let (runs, values) = self.of(i);
        let mut at = 0;
        runs.iter().map(move |&(first, count)| {
            at += count;
            (first, &values[at - count..at])
        })
    }

    /// Product of row `i` with a vector.
    pub fn dot(&self, i: usize, x: &[f64]) -> f64 {
        let of = |(first, v): (usize, &[f64])| v.iter().zip(&x[first..]).map(|(a, b)| a * b).sum::<f64>();
        self.row(i).map(of).sum()
    }

    /// Runs and values of a row.
    fn of(&self, i: usize) -> (&[(usize, usize)], &[f64]) {
        let (run, value) = if i == 0 { (0, 0) } else { self.ends[i - 1] };
        let end = self.ends[i];
        (&self.runs[run..end.0], &self.values[value..end.1])
    }
}

/// Columns from which on products are shared.
const WIDE: usize = 96;

/// Rows with the same runs.
pub(crate) struct Bundle {
    /// First column and length of each run.
    pub runs: Vec<(usize, usize)>,
    /// Entries in a row.
    pub width: usize,
    /// Number of rows.
    count: usize,
    /// Column after column.
    values: Vec<f64>,
}

impl Bundle {
    fn new(rows: &Runs, members: &[usize]) -> Self {
        let runs = rows.of(members[0]).0.to_vec();
        let (width, count) = (runs.iter().map(|r| r.1).sum(), members.len());
        let mut values = vec![0.0; width * count];
        for (k, &i) in members.iter().enumerate() {
            rows.of(i).1.iter().enumerate().for_each(|(j, v)| values[j * count + k] = *v);
        }
        Self { runs, width, count, values }
    }

    fn matrix(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.values, self.count, self.width)
    }

    /// Products of all rows with a vector.
    fn products(&self, x: &[f64]) -> Vec<f64> {
        let met: Vec<f64> = self.runs.iter().flat_map(|&(first, count)| &x[first..first + count]).copied().collect();
        applied(self.matrix(), &met)
    }

    /// `Σ sᵢ rᵢ`.
    fn sum(&self, scales: &[f64]) -> Vec<f64> {
        applied(self.matrix().transpose(), scales)
    }

    /// `Σ wᵢ rᵢᵀ rᵢ`, column after column; only the lower half counts.
    fn square(&self, weights: &[f64]) -> Vec<f64> {
        let (w, k) = (self.width, self.count);
        let mut weighted = self.values.clone();
        for column in weighted.chunks_exact_mut(k) {
            column.iter_mut().zip(weights).for_each(|(v, weight)| *v *= weight);
        }
        let mut out = vec![0.0; w * w];
        let all = MatMut::from_column_major_slice_mut(&mut out, w, w);
        lower_product(all, MatRef::from_column_major_slice(&weighted, k, w), self.matrix());
        out
    }
}

/// The lower half of `aᵀ b`: of many columns in two shares of equal work, however many threads there are.
fn lower_product(to: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    if b.ncols() < WIDE {
        let (whole, lower) = (BlockStructure::Rectangular, BlockStructure::TriangularLower);
        triangular::matmul(to, lower, Accum::Replace, a.transpose(), whole, b, whole, 1.0, Par::Seq);
        return;
    }
    let half = b.ncols() / 2;
    let (first, _, across, last) = to.split_at_mut(half, half);
    let ((a, a_last), (b, b_last)) = (a.split_at_col(half), b.split_at_col(half));
    rayon::join(
        || matmul(across, Accum::Replace, a_last.transpose(), b, 1.0, Par::Seq),
        || {
            lower_product(first, a, b);
            lower_product(last, a_last, b_last);
        },
    );
}

/// A matrix times a vector.
fn applied(matrix: MatRef<'_, f64>, x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; matrix.nrows()];
    let to = MatMut::from_column_major_slice_mut(&mut out, matrix.nrows(), 1);
    matmul(to, Accum::Replace, matrix, MatRef::from_column_major_slice(x, x.len(), 1), 1.0, Par::Seq);
    out
}

/// Rows by their runs, in an order of their own.
pub(crate) struct Bundles {
    bundles: Vec<Bundle>,
    /// Number of the first row of every bundle in the order of bundles.
    firsts: Vec<usize>,
    /// For every row in the order of bundles its number.
    order: Vec<usize>,
}

impl Bundles {
    /// All rows.
    pub fn new(rows: &Runs) -> Self {
        Self::chosen(rows, |_| true)
    }

    /// Rows by their numbers.
    pub fn chosen(rows: &Runs, chosen: impl Fn(usize) -> bool) -> Self {
        let mut known: HashMap<&[(usize, usize)], usize> = HashMap::new();
        let mut members: Vec<Vec<usize>> = Vec::new();
        for i in (0..rows.len()).filter(|&i| chosen(i)) {
            let k = *known.entry(rows.of(i).0).or_insert(members.len());
            if k == members.len() {
                members.push(Vec::new());
            }
            members[k].push(i);
        }
        let mut firsts = Vec::with_capacity(members.len());
        let mut count = 0;
        for m in &members {
            firsts.push(count);
            count += m.len();
        }
        let bundles = members.par_iter().map(|m| Bundle::new(rows, m)).collect();
        Self { bundles, firsts, order: members.into_iter().flatten().collect() }
    }

    /// What belongs to the rows, in the order of bundles.
    pub fn ordered<T: Copy>(&self, of_rows: &[T]) -> Vec<T> {
        self.order.iter().map(|&i| of_rows[i]).collect()
    }

    /// Bundles with the numbers of their rows in the order of bundles.
    fn each(&self) -> impl ParallelIterator<Item = (&Bundle, Range<usize>)> {
        self.bundles.par_iter().zip(&self.firsts).map(|(b, &first)| (b, first..first + b.count))
    }

    /// Products of all rows with a vector.
    pub fn products(&self, x: &[f64]) -> Vec<f64> {
        self.bundles.par_iter().map(|b| b.products(x)).collect::<Vec<_>>().concat()
    }

    /// Adds all rows times their scales to a vector.
    pub fn scatter(&self, scales: &[f64], out: &mut [f64]) {
        let sums: Vec<Vec<f64>> = self.each().map(|(b, range)| b.sum(&scales[range])).collect();
        for (b, sum) in self.bundles.iter().zip(&sums) {
            let mut at = 0;
            for &(first, count) in &b.runs {
                out[first..first + count].iter_mut().zip(&sum[at..at + count]).for_each(|(o, s)| *o += s);
                at += count;
            }
        }
    }

    /// All bundles that have entries with their weighted squares `Σ wᵢ rᵢᵀ rᵢ`, column after column, of which the lower halves
    /// count.
    pub fn squares(&self, weights: &[f64]) -> Vec<(&Bundle, Vec<f64>)> {
        self.each().filter(|(b, _)| b.width > 0).map(|(b, range)| (b, b.square(&weights[range]))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bundles_do_what_their_rows_do() {
        let mut rows = Runs::default();
        let value = |i: usize| ((i * i + 3 * i) as f64).sin();
        for i in 0..60 {
            match i % 5 {
                0 => rows.run(2, (0..3).map(|k| value(i + k))),
                1 | 3 => {
                    rows.run(7, [value(i)]);
                    rows.run(0, [value(2 * i), 1.0]);
                }
                2 => {}
                _ => rows.run(4, [value(i), value(i + 1)]),
            }
            rows.end();
        }
        let bundles = Bundles::new(&rows);
        assert_eq!((bundles.order.len(), bundles.bundles.len()), (60, 4));
        assert_eq!(Bundles::chosen(&rows, |i| i > 50).ordered(&(0..60).collect::<Vec<_>>()).len(), 9);
        let x: Vec<f64> = (0..8).map(value).collect();
        let products: Vec<f64> = (0..60).map(|i| rows.dot(i, &x)).collect();
        for (a, b) in bundles.products(&x).iter().zip(bundles.ordered(&products)) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
        let weights: Vec<f64> = (0..60).map(|i| 1.0 + value(i)).collect();
        let own = bundles.ordered(&weights);
        let mut sum = vec![0.0; 8];
        bundles.scatter(&own, &mut sum);
        let mut square = vec![[0.0; 8]; 8];
        for (b, s) in bundles.squares(&own) {
            let columns: Vec<usize> = b.runs.iter().flat_map(|&(first, count)| first..first + count).collect();
            for j in 0..b.width {
                for i in j..b.width {
                    square[columns[i].max(columns[j])][columns[i].min(columns[j])] += s[j * b.width + i];
                }
            }
        }
        for a in 0..8 {
            let entry = |i: usize, a: usize| {
                rows.row(i).find(|r| (r.0..r.0 + r.1.len()).contains(&a)).map_or(0.0, |r| r.1[a - r.0])
            };
            assert!((sum[a] - (0..60).map(|i| weights[i] * entry(i, a)).sum::<f64>()).abs() < 1e-12);
            for b in 0..=a {
                let wanted: f64 = (0..60).map(|i| weights[i] * entry(i, a) * entry(i, b)).sum();
                assert!((square[a][b] - wanted).abs() < 1e-12, "{a} {b}");
            }
        }
    }
    #[test]
    fn wide_products_are_those_of_their_columns() {
        let (rows, width) = (5, 2 * WIDE + 3);
        let value = |i: usize| ((i * i + 3 * i) as f64).sin();
        let [a, b] = [1, 7].map(|k| (0..rows * width).map(|i| value(k * i)).collect::<Vec<f64>>());
        let [left, right] = [&a, &b].map(|m| MatRef::from_column_major_slice(m, rows, width));
        let mut out = vec![0.0; width * width];
        lower_product(MatMut::from_column_major_slice_mut(&mut out, width, width), left, right);
        for j in 0..width {
            for i in j..width {
                let wanted: f64 = (0..rows).map(|k| a[i * rows + k] * b[j * rows + k]).sum();
                assert!((out[j * width + i] - wanted).abs() < 1e-12, "{i} {j}");
            }
        }
    }
}
