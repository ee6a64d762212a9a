//! The matrix of the normal equations, banded or sparse, whichever costs less.

use super::order;
use super::sparse::SparseMatrix;
use crate::num::least_squares::BandMatrix;

/// Multiplications up to which a band is taken without asking whether a sparse factor costs less: some milliseconds.
const CHEAP: usize = 12_000_000;

/// Mark of a column that belongs to a frozen unknown.
pub(super) const FROZEN: u32 = u32::MAX;

enum Store {
    Band(BandMatrix),
    Sparse(Box<SparseMatrix>),
}

/// A symmetric matrix of fixed structure with its factor.
pub(super) struct NormalMatrix {
    store: Store,
    place: Vec<u32>,
    turned: Vec<f64>,
}

impl NormalMatrix {
    /// The matrix in which the unknowns of every list occur together; `None` if there is no memory for it.
    pub fn new<'a>(count: usize, columns: impl Iterator<Item = &'a [u32]>) -> Option<Self> {
        let cliques = order::cliques(columns);
        let given: Vec<u32> = (0..count as u32).collect();
        let cost = |width: usize| count.saturating_mul(width).saturating_mul(width);
        let turned = vec![0.0; count];
        let w = order::width(&cliques, &given);
        let band =
            |w: usize, place| Self { store: Store::Band(BandMatrix::zeros(count, w)), place, turned: vec![0.0; count] };
        if cost(w) <= CHEAP {
            return Some(band(w, given));
        }
        let neighbours = order::neighbours(count, &cliques);
        let place = order::narrow(&neighbours);
        let narrow = order::width(&cliques, &place);
        if cost(narrow) <= CHEAP {
            return Some(band(narrow, place));
        }
        let store = Store::Sparse(Box::new(SparseMatrix::new(&neighbours)?));
        Some(Self { store, place: given, turned })
    }

    /// Whether the matrix is stored as a band, and its half bandwidth.
    pub fn is_band(&self) -> bool {
        matches!(self.store, Store::Band(_))
    }

    /// Numbers that [`NormalMatrix::add`] needs for these columns, [`FROZEN`] ones included: the places of their pairs.
    pub fn places(&self, columns: &[u32]) -> Vec<u32> {
        let place = |c: u32| if c == FROZEN { FROZEN } else { self.place[c as usize] };
        match &self.store {
            Store::Band(_) => columns.iter().map(|&c| place(c)).collect(),
            Store::Sparse(m) => {
                let mut out = Vec::with_capacity(columns.len() * (columns.len() + 1) / 2);
                for (p, &i) in columns.iter().enumerate() {
                    for &j in &columns[..=p] {
                        let frozen = i == FROZEN || j == FROZEN;
                        let at = if frozen { None } else { m.place(place(i) as usize, place(j) as usize) };
                        out.push(at.unwrap_or(FROZEN));
                    }
                }
                out
            }
        }
    }

    /// Becomes zero.
    pub fn clear(&mut self) {
        match &mut self.store {
            Store::Band(m) => m.clear(),
            Store::Sparse(m) => m.values().fill(0.0),
        }
    }

    /// Adds a small symmetric matrix, its lower half row by row, at the places that were asked for before.
    pub fn add(&mut self, places: &[u32], lower: &[f64]) {
        match &mut self.store {
            Store::Band(m) => {
                let mut at = 0;
                for (p, &i) in places.iter().enumerate() {
                    let row = &lower[at..=at + p];
                    at += p + 1;
                    if i == FROZEN {
                        continue;
                    }
                    for (&j, &v) in places.iter().zip(row) {
                        if j != FROZEN {
                            m.add_entry(i.max(j) as usize, i.min(j) as usize, v);
                        }
                    }
                }
            }
            Store::Sparse(m) => {
                let values = m.values();
                for (&k, &v) in places.iter().zip(lower) {
                    if let Some(x) = values.get_mut(k as usize) {
                        *x += v;
                    }
                }
            }
        }
    }

    /// Adds a number to the whole diagonal.
    pub fn add_diagonal(&mut self, value: f64) {
        for i in 0..self.place.len() {
            match &mut self.store {
                Store::Band(m) => m.add_diagonal(i, value),
                Store::Sparse(m) => m.add_diagonal(i, value),
            }
        }
    }

    /// Finds the factor, which takes the matrix' place; `false` if it is not positive definite.
    pub fn factorise(&mut self) -> bool {
        match &mut self.store {
            Store::Band(m) => m.factorise(),
            Store::Sparse(m) => m.factorise(),
        }
    }

    /// Solves in place with the factor; unknowns in their given order.
    pub fn solve(&mut self, x: &mut [f64]) {
        for (&p, v) in self.place.iter().zip(x.iter()) {
            self.turned[p as usize] = *v;
        }
        match &mut self.store {
            Store::Band(m) => m.solve(&mut self.turned),
            Store::Sparse(m) => m.solve(&mut self.turned),
        }
        for (&p, v) in self.place.iter().zip(x.iter_mut()) {
            *v = self.turned[p as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of `n` unknowns with a far link is solved as a band and sparse alike.
    #[test]
    fn band_and_sparse_factors_solve_the_same_system() {
        let n = 60;
        let lists: Vec<Vec<u32>> = (0..n as u32).map(|i| vec![i, (i + 1) % n as u32, (i + 7) % n as u32]).collect();
        let cliques = order::cliques(lists.iter().map(|l| &l[..]));
        let sparse = SparseMatrix::new(&order::neighbours(n, &cliques)).expect("memory");
        let mut all = [
            NormalMatrix::new(n, lists.iter().map(|l| &l[..])).expect("memory"),
            NormalMatrix {
                store: Store::Sparse(Box::new(sparse)),
                place: (0..n as u32).collect(),
                turned: vec![0.0; n],
            },
        ];
        assert!(all[0].is_band() && !all[1].is_band());
        let solutions = all.each_mut().map(|m| {
            m.clear();
            for (k, list) in lists.iter().enumerate() {
                let r = [1.0, -0.4, 0.2 + 0.01 * k as f64];
                let mut lower = Vec::new();
                (0..3).for_each(|p| (0..=p).for_each(|q| lower.push(r[p] * r[q])));
                let places = m.places(list);
                m.add(&places, &lower);
            }
            m.add_diagonal(0.1);
            assert!(m.factorise());
            let mut x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            m.solve(&mut x);
            x
        });
        for (a, b) in solutions[0].iter().zip(&solutions[1]) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}
