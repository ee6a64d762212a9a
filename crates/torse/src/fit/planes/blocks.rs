//! Normal equations of splines of planes, gathered span by span in 3×3 blocks.
//!
//! *Method.* A term `(U(t) − V)ᵀ K (U(t) − V)` of (9) in \[PW99\] gives control planes a and b the block `N_a N_b K`.
//! Blocks of one span are summed densely and brought into the band once, where freedoms are eliminated too: the cost
//! for a plane is some hundred multiplications, whatever the conditions are.

use super::functionals::Freedom;
use crate::num::least_squares::BandMatrix;
use crate::spline::knots::Knots;

/// A symmetric 3×3 form, row by row.
pub(crate) type Form = [f64; 9];

/// Sums of blocks, and of right sides, for changes of control planes.
pub(crate) struct Blocks<'a> {
    freedoms: &'a [Freedom<3>],
    offsets: Vec<usize>,
    order: usize,
    first: usize,
    forms: Vec<Form>,
    sides: Vec<[f64; 3]>,
    matrix: BandMatrix,
    right: Vec<f64>,
}

impl<'a> Blocks<'a> {
    /// Nothing summed yet. Offsets of the freedoms do not count: what is solved for are changes.
    pub fn new(knots: &Knots, freedoms: &'a [Freedom<3>]) -> Self {
        let order = knots.degree() + 1;
        let mut offsets = vec![0];
        for f in freedoms {
            let size = match f {
                Freedom::Free => 3,
                Freedom::Fixed(_) => 0,
                Freedom::Line { .. } => 1,
            };
            offsets.push(offsets[offsets.len() - 1] + size);
        }
        let unknowns = offsets[freedoms.len()];
        Self {
            freedoms,
            offsets,
            order,
            first: 0,
            forms: vec![[0.0; 9]; order * (order + 1) / 2],
            sides: vec![[0.0; 3]; order],
            matrix: BandMatrix::zeros(unknowns, 3 * order),
            right: vec![0.0; unknowns],
        }
    }

    /// Becomes zero and keeps the memory.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.right.fill(0.0);
    }

    /// Adds the term with the form `form` and the right side `side`; `basis` are the values of the functions that
    /// begin with control plane `first`.
    #[inline]
    pub fn add(&mut self, first: usize, basis: &[f64], form: &Form, side: &[f64; 3]) {
        if first != self.first {
            self.flush();
            self.first = first;
        }
        let mut blocks = self.forms.iter_mut();
        for (a, &na) in basis.iter().enumerate() {
            for &nb in &basis[..=a] {
                let Some(block) = blocks.next() else { return };
                let f = na * nb;
                for (o, k) in block.iter_mut().zip(form) {
                    *o += f * k;
                }
            }
            for (o, s) in self.sides[a].iter_mut().zip(side) {
                *o += na * s;
            }
        }
    }

    /// Adds a block of a pair of control planes, `i ≥ j`, directly.
    pub fn add_pair(&mut self, i: usize, j: usize, form: &Form) {
        let (di, dj) = (directions(&self.freedoms[i]), directions(&self.freedoms[j]));
        for (p, x) in di.iter().enumerate() {
            for (q, y) in dj.iter().enumerate() {
                let (row, column) = (self.offsets[i] + p, self.offsets[j] + q);
                if row >= column {
                    let value = (0..3).map(|r| x[r] * (0..3).map(|c| form[3 * r + c] * y[c]).sum::<f64>()).sum();
                    self.matrix.add_entry(row, column, value);
                }
            }
        }
    }

    /// Adds to the right side of a control plane.
    pub fn add_side(&mut self, i: usize, side: &[f64; 3]) {
        for (p, x) in directions(&self.freedoms[i]).iter().enumerate() {
            self.right[self.offsets[i] + p] += (0..3).map(|c| x[c] * side[c]).sum::<f64>();
        }
    }

    fn flush(&mut self) {
        let mut k = 0;
        for a in 0..self.order {
            for b in 0..=a {
                let form = std::mem::replace(&mut self.forms[k], [0.0; 9]);
                k += 1;
                if form != [0.0; 9] {
                    self.add_pair(self.first + a, self.first + b, &form);
                }
            }
            let side = std::mem::replace(&mut self.sides[a], [0.0; 3]);
            if side != [0.0; 3] {
                self.add_side(self.first + a, &side);
            }
        }
    }

    /// Changes of the control planes, with `damping` times its diagonal added to the matrix; `None` if it is not
    /// positive definite. The sums are lost.
    pub fn solved(&mut self, damping: f64) -> Option<Vec<[f64; 3]>> {
        self.flush();
        for i in 0..self.matrix.size() {
            let d = self.matrix.diagonal(i);
            self.matrix.add_diagonal(i, damping * d);
        }
        if !self.right.is_empty() {
            if !self.matrix.factorise() {
                return None;
            }
            self.matrix.solve(&mut self.right);
        }
        let x = &self.right;
        x.iter().all(|v| v.is_finite()).then(|| {
            (self.freedoms.iter().zip(&self.offsets))
                .map(|(f, &at)| match f {
                    Freedom::Free => [x[at], x[at + 1], x[at + 2]],
                    Freedom::Fixed(_) => [0.0; 3],
                    Freedom::Line { direction, .. } => direction.map(|d| x[at] * d),
                })
                .collect()
        })
    }
}

/// Directions in which a control plane may move.
fn directions(f: &Freedom<3>) -> Vec<[f64; 3]> {
    match f {
        Freedom::Free => vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        Freedom::Fixed(_) => Vec::new(),
        Freedom::Line { direction, .. } => vec![*direction],
    }
}
