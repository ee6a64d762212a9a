//! Symmetric positive definite matrices in dense blocks, most of which vanish: for unknowns in groups of which few
//! occur together.
//!
//! *Method*: block Cholesky factorisation \[GL13, 4.2\] in an order of least degree; which blocks fill up is found once.

use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

/// No block.
const NONE: usize = usize::MAX;

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

    /// First column and values of every run of a row.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &[f64])> + Clone {
        let (from, mut at) = if i == 0 { (0, 0) } else { self.ends[i - 1] };
        self.runs[from..self.ends[i].0].iter().map(move |&(first, count)| {
            at += count;
            (first, &self.values[at - count..at])
        })
    }

    /// Product of row `i` with a vector.
    pub fn dot(&self, i: usize, x: &[f64]) -> f64 {
        let of = |(first, v): (usize, &[f64])| v.iter().zip(&x[first..]).map(|(a, b)| a * b).sum::<f64>();
        self.row(i).map(of).sum()
    }

    /// Adds `scale` times row `i` to a vector.
    pub fn scatter(&self, i: usize, scale: f64, out: &mut [f64]) {
        for (first, v) in self.row(i) {
            out[first..].iter_mut().zip(v).for_each(|(o, a)| *o += scale * a);
        }
    }
}

/// Where blocks lie, and in which order they are eliminated.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    /// First column of every group; the number of columns at the end.
    starts: Vec<usize>,
    /// Group of every column.
    group: Vec<usize>,
    /// Place of every group in the order of elimination, and the group at every place.
    place: Vec<usize>,
    order: Vec<usize>,
    /// For each place the later places with which it has a block, in order.
    later: Vec<Vec<usize>>,
    /// Number of the block of two places (first ≤ second).
    block: Vec<usize>,
    count: usize,
}

impl Structure {
    /// The structure of `AᵀA` for all rows of `matrices`, over groups of neighbouring columns of the given sizes. No run may
    /// leave a group.
    pub fn new(sizes: &[usize], matrices: &[&Runs]) -> Self {
        let groups = sizes.len();
        let mut starts = vec![0];
        sizes.iter().for_each(|s| starts.push(starts[starts.len() - 1] + s));
        let group: Vec<usize> = sizes.iter().enumerate().flat_map(|(g, &s)| std::iter::repeat_n(g, s)).collect();
        let mut near: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); groups];
        for m in matrices {
            for i in 0..m.len() {
                let of: Vec<usize> = m.row(i).map(|(first, _)| group[first]).collect();
                for &a in &of {
                    for &b in of.iter().filter(|b| **b != a) {
                        near[a].insert(b);
                    }
                }
            }
        }
        // Least degree, counted in columns.
        let (mut order, mut place, mut fill) = (Vec::new(), vec![NONE; groups], Vec::new());
        let mut left: BTreeSet<usize> = (0..groups).collect();
        while let Some(&next) = left.iter().min_by_key(|&&g| near[g].iter().map(|&h| sizes[h]).sum::<usize>()) {
            left.remove(&next);
            place[next] = order.len();
            order.push(next);
            let around = std::mem::take(&mut near[next]);
            for &a in &around {
                near[a].remove(&next);
                let others = around.iter().copied().filter(|&b| b != a);
                near[a].extend(others);
            }
            fill.push(around);
        }
        let mut block = vec![NONE; groups * groups];
        let (mut count, mut later) = (0, Vec::new());
        for (k, around) in fill.iter().enumerate() {
            let mut places: Vec<usize> = around.iter().map(|&g| place[g]).collect();
            places.sort_unstable();
            for &p in std::iter::once(&k).chain(&places) {
                block[k * groups + p] = count;
                count += 1;
            }
            later.push(places);
        }
        Self { starts, group, place, order, later, block, count }
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.group.len()
    }

    fn size(&self, place: usize) -> usize {
        let g = self.order[place];
        self.starts[g + 1] - self.starts[g]
    }

    fn at(&self, a: usize, b: usize) -> usize {
        self.block[a * self.order.len() + b]
    }
}

/// A symmetric matrix in blocks; of diagonal blocks only the lower half counts. After factorisation it is its factor.
#[derive(Clone, Debug)]
pub(crate) struct BlockMatrix<'a> {
    structure: &'a Structure,
    blocks: Vec<DMatrix<f64>>,
}

impl<'a> BlockMatrix<'a> {
    /// The zero matrix.
    pub fn zeros(structure: &'a Structure) -> Self {
        let mut blocks = vec![DMatrix::zeros(0, 0); structure.count];
        for k in 0..structure.order.len() {
            for &p in std::iter::once(&k).chain(&structure.later[k]) {
                blocks[structure.at(k, p)] = DMatrix::zeros(structure.size(k), structure.size(p));
            }
        }
        Self { structure, blocks }
    }

    /// Becomes a copy of a matrix of the same structure.
    pub fn assign(&mut self, other: &Self) {
        self.blocks.iter_mut().zip(&other.blocks).for_each(|(a, b)| a.copy_from(b));
    }

    /// Adds `weight · rᵀr` for row `i` of `rows`.
    pub fn add_row(&mut self, rows: &Runs, i: usize, weight: f64) {
        let s = self.structure;
        for (p, (first, u)) in rows.row(i).enumerate() {
            let (a, row) = (s.place[s.group[first]], first - s.starts[s.group[first]]);
            for (second, v) in rows.row(i).take(p + 1) {
                let (b, column) = (s.place[s.group[second]], second - s.starts[s.group[second]]);
                // Rows of a block are those of the earlier place; on the diagonal those of the later column.
                let swap = if a == b { second > first } else { b < a };
                let (k, r, c, u, v) =
                    if swap { (s.at(b, a), column, row, v, u) } else { (s.at(a, b), row, column, u, v) };
                let block = &mut self.blocks[k];
                for (j, y) in v.iter().enumerate() {
                    let scale = weight * y;
                    // Only the lower half of the diagonal.
                    let from = if a == b && first == second { j } else { 0 };
                    let mut target = block.column_mut(c + j);
                    let target = &mut target.as_mut_slice()[r + from..r + u.len()];
                    target.iter_mut().zip(&u[from..]).for_each(|(t, x)| *t += scale * x);
                }
            }
        }
    }

    /// Adds to a diagonal entry.
    pub fn add_diagonal(&mut self, column: usize, value: f64) {
        let s = self.structure;
        let g = s.group[column];
        let (k, i) = (s.at(s.place[g], s.place[g]), column - s.starts[g]);
        self.blocks[k][(i, i)] += value;
    }

    /// Replaces the matrix by its factor; `false` if it is not positive definite.
    pub fn factorise(&mut self) -> bool {
        let s = self.structure;
        for k in 0..s.order.len() {
            let at = s.at(k, k);
            let diagonal = std::mem::replace(&mut self.blocks[at], DMatrix::zeros(0, 0));
            let Some(factor) = diagonal.cholesky() else { return false };
            let lower = factor.unpack();
            for &p in &s.later[k] {
                if !lower.solve_lower_triangular_mut(&mut self.blocks[s.at(k, p)]) {
                    return false;
                }
            }
            self.blocks[at] = lower;
            for (i, &p) in s.later[k].iter().enumerate() {
                for &q in &s.later[k][i..] {
                    let mut target = std::mem::replace(&mut self.blocks[s.at(p, q)], DMatrix::zeros(0, 0));
                    target.gemm_tr(-1.0, &self.blocks[s.at(k, p)], &self.blocks[s.at(k, q)], 1.0);
                    self.blocks[s.at(p, q)] = target;
                }
            }
        }
        true
    }

    /// Solves in place with the factor.
    pub fn solve(&self, x: &mut [f64]) {
        let s = self.structure;
        let range = |place: usize| s.starts[s.order[place]]..s.starts[s.order[place] + 1];
        let mut parts: Vec<DVector<f64>> =
            (0..s.order.len()).map(|k| DVector::from_column_slice(&x[range(k)])).collect();
        for k in 0..s.order.len() {
            self.blocks[s.at(k, k)].solve_lower_triangular_mut(&mut parts[k]);
            let own = parts[k].clone();
            for &p in &s.later[k] {
                parts[p].gemv_tr(-1.0, &self.blocks[s.at(k, p)], &own, 1.0);
            }
        }
        for k in (0..s.order.len()).rev() {
            let mut own = std::mem::replace(&mut parts[k], DVector::zeros(0));
            for &p in &s.later[k] {
                own.gemv(-1.0, &self.blocks[s.at(k, p)], &parts[p], 1.0);
            }
            self.blocks[s.at(k, k)].tr_solve_lower_triangular_mut(&mut own);
            parts[k] = own;
            x[range(k)].copy_from_slice(parts[k].as_slice());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows over a ring of groups, each with its neighbour, and the dense matrix.
    fn ring(groups: usize, size: usize) -> (Vec<usize>, Runs, DMatrix<f64>) {
        let n = groups * size;
        let mut rows = Runs::default();
        let mut dense = DMatrix::identity(n, n) * 0.1;
        let value = |i: usize| ((i * i + 3 * i) as f64).sin();
        for i in 0..6 * n {
            let (g, h) = (i % groups, (i + 1) % groups);
            let (a, b) = (g * size + i % 2, h * size);
            let (u, v): (Vec<f64>, Vec<f64>) = ((0..2).map(|j| value(i + 7 * j)).collect(), vec![value(5 * i + 1)]);
            rows.run(a, u.clone());
            rows.run(b, v.clone());
            // A second run in the first group.
            rows.run(g * size + 3, [0.3]);
            rows.end();
            let mut full = DVector::zeros(n);
            (full[a], full[a + 1], full[b], full[g * size + 3]) = (u[0], u[1], v[0], 0.3);
            dense += &full * full.transpose() * 2.0;
        }
        (vec![size; groups], rows, dense)
    }

    #[test]
    fn a_ring_of_groups_is_solved_as_the_dense_matrix() {
        for groups in [2, 3, 7] {
            let (sizes, rows, dense) = ring(groups, 4);
            let structure = Structure::new(&sizes, &[&rows]);
            let mut m = BlockMatrix::zeros(&structure);
            (0..rows.len()).for_each(|i| m.add_row(&rows, i, 2.0));
            (0..structure.columns()).for_each(|i| m.add_diagonal(i, 0.1));
            let right = DVector::from_fn(dense.nrows(), |i, _| (i as f64).cos());
            let wanted = dense.cholesky().expect("positive").solve(&right);
            assert!(m.factorise());
            let mut x = right.as_slice().to_vec();
            m.solve(&mut x);
            for (a, b) in x.iter().zip(wanted.iter()) {
                assert!((a - b).abs() < 1e-10 * wanted.amax(), "{a} {b}");
            }
        }
    }

    #[test]
    fn chains_do_not_fill_up() {
        let mut rows = Runs::default();
        for g in 0..9 {
            rows.run(2 * g, [1.0]);
            rows.run(2 * g + 2, [1.0]);
            rows.end();
        }
        let structure = Structure::new(&[2; 10], &[&rows]);
        assert_eq!(structure.count, 10 + 9);
    }
}
