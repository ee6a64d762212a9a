//! Symmetric positive definite matrices in dense blocks, most of which vanish: for unknowns in groups of which few
//! occur together.
//!
//! *Method*: block Cholesky factorisation \[GL13, 4.2\] in an order of least degree; which blocks fill up is found once.

use super::least_squares::dot;
use super::runs::{Bundle, Bundles, Runs};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// No block.
const NONE: usize = usize::MAX;

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
    /// Column after column.
    blocks: Vec<Vec<f64>>,
}

impl<'a> BlockMatrix<'a> {
    /// The zero matrix.
    pub fn zeros(structure: &'a Structure) -> Self {
        let mut blocks = vec![Vec::new(); structure.count];
        for k in 0..structure.order.len() {
            for &p in std::iter::once(&k).chain(&structure.later[k]) {
                blocks[structure.at(k, p)] = vec![0.0; structure.size(k) * structure.size(p)];
            }
        }
        Self { structure, blocks }
    }

    /// Becomes a copy of a matrix of the same structure.
    pub fn assign(&mut self, other: &Self) {
        self.blocks.iter_mut().zip(&other.blocks).for_each(|(a, b)| a.copy_from_slice(b));
    }

    /// Adds `Σ wᵢ rᵢᵀ rᵢ` for all rows; weights in the order of the bundles.
    pub fn add(&mut self, rows: &Bundles, weights: &[f64]) {
        for (bundle, square) in rows.squares(weights) {
            self.add_square(bundle, &square);
        }
    }

    fn add_square(&mut self, bundle: &Bundle, square: &[f64]) {
        let s = self.structure;
        let w = bundle.width;
        let mut below = 0;
        for (p, &(first, height)) in bundle.runs.iter().enumerate() {
            let (a, row) = (s.place[s.group[first]], first - s.starts[s.group[first]]);
            let mut before = 0;
            for &(second, breadth) in &bundle.runs[..=p] {
                let (b, column) = (s.place[s.group[second]], second - s.starts[s.group[second]]);
                // Rows of a block are those of the earlier place; on the diagonal those of the later column.
                let turned = if a == b { second > first } else { b < a };
                let block = &mut self.blocks[if turned { s.at(b, a) } else { s.at(a, b) }];
                let rows = s.size(if turned { b } else { a });
                for j in 0..breadth {
                    // Only the lower half of the diagonal.
                    let from = if first == second { j } else { 0 };
                    let own = &square[(before + j) * w + below..][from..height];
                    if turned {
                        own.iter().enumerate().for_each(|(i, v)| block[(row + from + i) * rows + column + j] += v);
                    } else {
                        let target = &mut block[(column + j) * rows + row + from..];
                        target.iter_mut().zip(own).for_each(|(t, v)| *t += v);
                    }
                }
                before += breadth;
            }
            below += height;
        }
    }

    /// Adds to a diagonal entry.
    pub fn add_diagonal(&mut self, column: usize, value: f64) {
        let s = self.structure;
        let g = s.group[column];
        let (place, i) = (s.place[g], column - s.starts[g]);
        self.blocks[s.at(place, place)][i * (s.size(place) + 1)] += value;
    }

    /// A block as a matrix.
    fn block(&self, a: usize, b: usize) -> MatRef<'_, f64> {
        let s = self.structure;
        MatRef::from_column_major_slice(&self.blocks[s.at(a, b)], s.size(a), s.size(b))
    }

    /// Replaces the matrix by its factor; `false` if it is not positive definite.
    pub fn factorise(&mut self) -> bool {
        let s = self.structure;
        let largest = (0..s.order.len()).map(|k| s.size(k)).max().unwrap_or(0);
        let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(largest, Par::Seq, Default::default()));
        for k in 0..s.order.len() {
            let n = s.size(k);
            let own = MatMut::from_column_major_slice_mut(&mut self.blocks[s.at(k, k)], n, n);
            let stack = MemStack::new(&mut memory);
            if cholesky_in_place(own, Default::default(), Par::Seq, stack, Default::default()).is_err() {
                return false;
            }
            let mut beside: Vec<Vec<f64>> =
                s.later[k].iter().map(|&p| std::mem::take(&mut self.blocks[s.at(k, p)])).collect();
            let lower = self.block(k, k);
            beside.par_iter_mut().for_each(|b| {
                let columns = b.len() / n;
                solve_lower_triangular_in_place(lower, MatMut::from_column_major_slice_mut(b, n, columns), Par::Seq);
            });
            for (&p, b) in s.later[k].iter().zip(beside) {
                self.blocks[s.at(k, p)] = b;
            }
            let pairs = s.later[k].iter().enumerate().flat_map(|(i, &p)| s.later[k][i..].iter().map(move |&q| (p, q)));
            let mut targets: Vec<(usize, usize, Vec<f64>)> =
                pairs.map(|(p, q)| (p, q, std::mem::take(&mut self.blocks[s.at(p, q)]))).collect();
            targets.par_iter_mut().for_each(|(p, q, b)| {
                let target = MatMut::from_column_major_slice_mut(b, s.size(*p), s.size(*q));
                matmul(target, Accum::Add, self.block(k, *p).transpose(), self.block(k, *q), -1.0, Par::Seq);
            });
            for (p, q, b) in targets {
                self.blocks[s.at(p, q)] = b;
            }
        }
        true
    }

    /// Solves in place with the factor.
    pub fn solve(&self, x: &mut [f64]) {
        let s = self.structure;
        let range = |place: usize| s.starts[s.order[place]]..s.starts[s.order[place] + 1];
        let columns = |a: usize, b: usize| self.blocks[s.at(a, b)].chunks_exact(s.size(a).max(1));
        let mut parts: Vec<Vec<f64>> = (0..s.order.len()).map(|k| x[range(k)].to_vec()).collect();
        for k in 0..s.order.len() {
            let mut own = std::mem::take(&mut parts[k]);
            for (j, column) in columns(k, k).enumerate() {
                own[j] /= column[j];
                let share = own[j];
                own[j + 1..].iter_mut().zip(&column[j + 1..]).for_each(|(o, c)| *o -= share * c);
            }
            for &p in &s.later[k] {
                parts[p].iter_mut().zip(columns(k, p)).for_each(|(o, c)| *o -= dot(&own, c));
            }
            parts[k] = own;
        }
        for k in (0..s.order.len()).rev() {
            let mut own = std::mem::take(&mut parts[k]);
            for &p in &s.later[k] {
                for (share, column) in parts[p].iter().zip(columns(k, p)) {
                    own.iter_mut().zip(column).for_each(|(o, c)| *o -= share * c);
                }
            }
            for (j, column) in columns(k, k).enumerate().rev() {
                own[j] = (own[j] - dot(&own[j + 1..], &column[j + 1..])) / column[j];
            }
            x[range(k)].copy_from_slice(&own);
            parts[k] = own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

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
            m.add(&Bundles::new(&rows), &vec![2.0; rows.len()]);
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
