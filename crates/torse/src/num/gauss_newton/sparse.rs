//! Sparse factorisations with faer: Cholesky, whose symbolic part is found once, and orthogonal ones for least squares.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::cholesky::{
    factorize_symbolic_cholesky, CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
};
use faer::sparse::linalg::qr::{factorize_symbolic_qr, QrSymbolicParams};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

/// A symmetric matrix of fixed structure, its lower half by columns, and its factor.
pub(super) struct SparseMatrix {
    pattern: SymbolicSparseColMat<usize>,
    values: Vec<f64>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl SparseMatrix {
    /// A zero matrix with entries on the diagonal and wherever `neighbours` (sorted) says. `None` without memory.
    pub fn new(neighbours: &[Vec<u32>]) -> Option<Self> {
        let n = neighbours.len();
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for (i, list) in neighbours.iter().enumerate() {
            rows.push(i);
            rows.extend(list.iter().map(|&j| j as usize).filter(|&j| j > i));
            starts.push(rows.len());
        }
        let count = rows.len();
        let pattern = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        let need = StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        let memory = MemBuffer::try_new(need).ok()?;
        let factor = vec![0.0; symbolic.len_val()];
        Some(Self { pattern, values: vec![0.0; count], symbolic, factor, memory })
    }

    /// Place of the entry in row `i` and column `j`, in any order, among the values.
    pub fn place(&self, i: usize, j: usize) -> Option<u32> {
        let (i, j) = (i.max(j), i.min(j));
        let start = self.pattern.col_ptr()[j];
        let rows = &self.pattern.row_idx()[start..self.pattern.col_ptr()[j + 1]];
        rows.binary_search(&i).ok().map(|k| (start + k) as u32)
    }

    /// The values, to be added to.
    pub fn values(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Adds to a diagonal entry.
    pub fn add_diagonal(&mut self, i: usize, value: f64) {
        // The diagonal comes first in its column.
        self.values[self.pattern.col_ptr()[i]] += value;
    }

    /// Finds the factor; `false` if the matrix is not positive definite.
    pub fn factorise(&mut self) -> bool {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), &self.values[..]);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .is_ok()
    }

    /// Solves in place with the factor.
    pub fn solve(&mut self, x: &mut [f64]) {
        let n = x.len();
        let stack = MemStack::new(&mut self.memory);
        let factor = LltRef::<'_, usize, f64>::new(&self.symbolic, &self.factor);
        factor.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(x, n, 1), Par::Seq, stack);
    }
}

/// Sparse rows.
#[derive(Clone, Debug, Default)]
pub(super) struct SparseRows {
    columns: Vec<u32>,
    values: Vec<f64>,
    ends: Vec<usize>,
}

impl SparseRows {
    /// Adds an entry to the row that is being written.
    pub fn entry(&mut self, column: u32, value: f64) {
        self.columns.push(column);
        self.values.push(value);
    }

    /// Ends a row.
    pub fn end(&mut self) {
        self.ends.push(self.columns.len());
    }

    /// Largest norm of a row.
    pub fn largest(&self) -> f64 {
        (0..self.ends.len()).map(|i| self.row(i).map(|(_, v)| v * v).sum::<f64>().sqrt()).fold(0.0, f64::max)
    }

    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = if i == 0 { 0 } else { self.ends[i - 1] }..self.ends[i];
        self.columns[range.clone()].iter().map(|&c| c as usize).zip(self.values[range].iter().copied())
    }

    /// The solution of `A x ≈ right` by orthogonal factorisation of A above `shift` times the unit matrix, corrected
    /// `repeats` times: of minimum norm, without directions whose singular values are far below the shift. `None`
    /// without memory.
    pub fn shortest(&self, unknowns: usize, right: &[f64], shift: f64, repeats: usize) -> Option<Vec<f64>> {
        let rows = self.ends.len();
        let mut starts = vec![0usize; unknowns + 1];
        self.columns.iter().for_each(|&c| starts[c as usize + 1] += 1);
        (0..unknowns).for_each(|j| starts[j + 1] += starts[j] + 1);
        let mut next = starts.clone();
        let (mut row_of, mut values) = (vec![0usize; starts[unknowns]], vec![0.0; starts[unknowns]]);
        let mut put = |j: usize, i: usize, v: f64| {
            (row_of[next[j]], values[next[j]]) = (i, v);
            next[j] += 1;
        };
        (0..rows).for_each(|i| self.row(i).for_each(|(j, v)| put(j, i, v)));
        (0..unknowns).for_each(|j| put(j, rows + j, shift));
        let pattern = SymbolicSparseColMat::new_checked(rows + unknowns, unknowns, starts, None, row_of);
        let symbolic = factorize_symbolic_qr(pattern.as_ref(), QrSymbolicParams::default()).ok()?;
        let need = StackReq::any_of(&[
            symbolic.factorize_numeric_qr_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]);
        let mut memory = MemBuffer::try_new(need).ok()?;
        let stack = MemStack::new(&mut memory);
        let (mut indices, mut numbers) = (vec![0usize; symbolic.len_idx()], vec![0.0; symbolic.len_val()]);
        let matrix = SparseColMatRef::new(pattern.as_ref(), &values[..]);
        let parameters = Default::default();
        let factor =
            symbolic.factorize_numeric_qr::<f64>(&mut indices, &mut numbers, matrix, Par::Seq, stack, parameters);
        let mut x = vec![0.0; unknowns];
        let mut side = vec![0.0; rows + unknowns];
        for _ in 0..=repeats {
            side.fill(0.0);
            for i in 0..rows {
                side[i] = right[i] - self.row(i).map(|(j, v)| v * x[j]).sum::<f64>();
            }
            let part = MatMut::from_column_major_slice_mut(&mut side, rows + unknowns, 1);
            factor.solve_in_place_with_conj(Conj::No, part, Par::Seq, stack);
            x.iter_mut().zip(&side).for_each(|(x, d)| *x += d);
        }
        x.iter().all(|v| v.is_finite()).then_some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_solution_is_that_of_the_pseudo_inverse() {
        // Six rows of rank five in nine unknowns: the last is the sum of two others.
        let (n, m) = (9, 6);
        let mut a = nalgebra::DMatrix::<f64>::from_fn(m, n, |i, j| {
            if (i + 2 * j) % 3 == 0 {
                0.0
            } else {
                ((i * 7 + j * j) as f64).sin()
            }
        });
        let sum = a.row(0) + a.row(1);
        a.set_row(5, &sum);
        let mut right: Vec<f64> = (0..m).map(|i| (i as f64).cos()).collect();
        right[5] = right[0] + right[1];
        let mut rows = SparseRows::default();
        for i in 0..m {
            (0..n).filter(|&j| a[(i, j)] != 0.0).for_each(|j| rows.entry(j as u32, a[(i, j)]));
            rows.end();
        }
        let x = rows.shortest(n, &right, 1e-9 * rows.largest(), 2).expect("memory");
        let wanted = a.svd(true, true).solve(&nalgebra::DVector::from_vec(right), 1e-9).expect("a solution");
        for (a, b) in x.iter().zip(wanted.iter()) {
            // Rounding over the shift is what a direction without singular value may get.
            assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
    }
}
