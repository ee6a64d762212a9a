//! Splines that fulfil linear conditions in the sense of least squares: the quadratic forms behind all fits of planes.
//!
//! *Method.* Every term of (9), (10) and (13) of \[PW99\] is a weighted square of a linear functional of the spline, its
//! derivatives included, at one parameter; the normal matrix is banded. Fixed control points, and control points on
//! a line, are eliminated.

use crate::num::least_squares::{BandMatrix, Rows};
use crate::num::quadrature::gauss_legendre;
use crate::spline::knots::Knots;

/// What a control point may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom<const D: usize> {
    /// Anything.
    Free,
    /// Nothing.
    Fixed([f64; D]),
    /// Move along a line.
    Line {
        /// A point of the line.
        base: [f64; D],
        /// Its direction.
        direction: [f64; D],
    },
}

/// The condition `Σ_k coefficients[k] · U⁽ᵏ⁾(t) = value` with a weight for its square.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Functional<const D: usize> {
    pub t: f64,
    pub coefficients: [[f64; D]; 3],
    pub value: f64,
    pub weight: f64,
}

/// Conditions on a spline, ready to be solved.
pub(crate) struct System<'a, const D: usize> {
    knots: &'a Knots,
    freedoms: &'a [Freedom<D>],
    offsets: Vec<usize>,
    rows: Rows,
    right: Vec<f64>,
    weights: Vec<f64>,
}

/// Normal equations `matrix · x = right`; up to a constant the objective is `xᵀ matrix x − 2 rightᵀ x`.
pub(crate) struct Normal {
    pub matrix: BandMatrix,
    pub right: Vec<f64>,
}

impl<'a, const D: usize> System<'a, D> {
    /// No conditions yet; as many freedoms as control points.
    pub fn new(knots: &'a Knots, freedoms: &'a [Freedom<D>]) -> Self {
        let mut offsets = vec![0];
        for f in freedoms {
            let size = match f {
                Freedom::Free => D,
                Freedom::Fixed(_) => 0,
                Freedom::Line { .. } => 1,
            };
            offsets.push(offsets[offsets.len() - 1] + size);
        }
        let unknowns = offsets[freedoms.len()];
        let rows = Rows::new(unknowns, (D * (knots.degree() + 1)).min(unknowns));
        Self { knots, freedoms, offsets, rows, right: Vec::new(), weights: Vec::new() }
    }

    /// Number of unknown numbers.
    pub fn unknowns(&self) -> usize {
        self.offsets[self.freedoms.len()]
    }

    /// Adds a condition.
    pub fn add(&mut self, f: &Functional<D>) {
        let orders = if f.coefficients[2] != [0.0; D] { 2 } else { usize::from(f.coefficients[1] != [0.0; D]) };
        let basis = self.knots.basis(f.t, orders);
        self.add_on(&basis, f);
    }

    fn add_on(&mut self, basis: &crate::spline::knots::BasisJet, f: &Functional<D>) {
        let unknowns = self.unknowns();
        let mut value = f.value;
        let (start, row) = if unknowns > 0 { self.rows.push(self.offsets[basis.first]) } else { (0, &mut [][..]) };
        for j in 0..=self.knots.degree() {
            let i = basis.first + j;
            let share: [f64; D] =
                std::array::from_fn(|d| (0..3).map(|k| basis.rows[k][j] * f.coefficients[k][d]).sum());
            let dot = |x: &[f64; D]| -> f64 { (0..D).map(|d| share[d] * x[d]).sum() };
            match &self.freedoms[i] {
                Freedom::Free => {
                    let at = self.offsets[i] - start;
                    row[at..at + D].copy_from_slice(&share);
                }
                Freedom::Fixed(x) => value -= dot(x),
                Freedom::Line { base, direction } => {
                    value -= dot(base);
                    row[self.offsets[i] - start] = dot(direction);
                }
            }
        }
        self.right.push(value);
        self.weights.push(f.weight);
    }

    /// Adds `share ·` (trace of what there is / trace of this) `· ∫ |root U''|² dt`: the smoothing term. The rows of
    /// `root` are the directions measured. Returns the whole factor before the integral.
    pub fn add_smoothing(&mut self, share: f64, root: &[[f64; D]]) -> f64 {
        let before = self.right.len();
        self.add_bending(root);
        if self.unknowns() == 0 {
            return 0.0;
        }
        let trace = |range: std::ops::Range<usize>| -> f64 {
            range.map(|i| self.weights[i] * self.rows.row(i).1.iter().map(|x| x * x).sum::<f64>()).sum()
        };
        let (data, smooth) = (trace(0..before), trace(before..self.right.len()));
        let factor = if smooth > 0.0 { share * data / smooth } else { 0.0 };
        self.weights[before..].iter_mut().for_each(|w| *w *= factor);
        factor
    }

    /// Adds `∫ |root U''|² dt`.
    pub fn add_bending(&mut self, root: &[[f64; D]]) {
        let nodes = gauss_legendre(self.knots.degree());
        for w in self.knots.breaks().windows(2) {
            let h = w[1] - w[0];
            let span = self.knots.span(0.5 * (w[0] + w[1]));
            for (x, weight) in &nodes {
                let t = w[0] + h * x;
                let basis = self.knots.basis_on_span(span, t, 2);
                for r in root {
                    let coefficients = [[0.0; D], [0.0; D], *r];
                    self.add_on(&basis, &Functional { t, coefficients, value: 0.0, weight: h * weight });
                }
            }
        }
    }

    /// The normal equations.
    pub fn normal(&self) -> Normal {
        let n = self.unknowns();
        let mut matrix = BandMatrix::zeros(n, D * (self.knots.degree() + 1));
        let mut right = vec![0.0; n];
        if n > 0 {
            for i in 0..self.right.len() {
                matrix.add_row(&self.rows, i, self.weights[i]);
                self.rows.scatter(i, self.weights[i] * self.right[i], &mut right);
            }
        }
        Normal { matrix, right }
    }

    /// Solves with `damping` times its diagonal added to the matrix; `None` if it is not positive definite.
    pub fn solved(&self, damping: f64) -> Option<Vec<[f64; D]>> {
        let Normal { mut matrix, mut right } = self.normal();
        if right.is_empty() {
            return Some(self.control(&[]));
        }
        if damping > 0.0 {
            for i in 0..matrix.size() {
                let d = matrix.diagonal(i);
                matrix.add_diagonal(i, damping * d);
            }
        }
        if !matrix.factorise() {
            return None;
        }
        let first = right.clone();
        matrix.solve(&mut right);
        // One refinement with the residual of the rows, which removes most of what the squared condition costs.
        if damping == 0.0 {
            let mut rest = vec![0.0; first.len()];
            for i in 0..self.right.len() {
                self.rows.scatter(i, self.weights[i] * (self.right[i] - self.rows.dot(i, &right)), &mut rest);
            }
            matrix.solve(&mut rest);
            for (x, r) in right.iter_mut().zip(&rest) {
                *x += r;
            }
        }
        right.iter().all(|x| x.is_finite()).then(|| self.control(&right))
    }

    /// Control points from the unknowns.
    pub fn control(&self, x: &[f64]) -> Vec<[f64; D]> {
        self.freedoms
            .iter()
            .zip(&self.offsets)
            .map(|(f, &at)| match f {
                Freedom::Free => std::array::from_fn(|d| x[at + d]),
                Freedom::Fixed(p) => *p,
                Freedom::Line { base, direction } => std::array::from_fn(|d| base[d] + x[at] * direction[d]),
            })
            .collect()
    }

    /// Unknowns concerned by control point `i` with their directions: for further linear conditions. The second part
    /// is the constant.
    pub fn terms(&self, i: usize, form: &[f64; D]) -> (Vec<(usize, f64)>, f64) {
        let at = self.offsets[i];
        let dot = |x: &[f64; D]| -> f64 { (0..D).map(|d| form[d] * x[d]).sum() };
        match &self.freedoms[i] {
            Freedom::Free => ((0..D).map(|d| (at + d, form[d])).collect(), 0.0),
            Freedom::Fixed(p) => (Vec::new(), dot(p)),
            Freedom::Line { base, direction } => (vec![(at, dot(direction))], dot(base)),
        }
    }
}

/// First control point that sorted `parameters` do not determine (Schoenberg–Whitney: there must be distinct
/// parameters inside the supports, in order); `None` if all are determined.
pub(crate) fn undetermined(knots: &Knots, parameters: &[f64], fixed: impl Fn(usize) -> bool) -> Option<usize> {
    let (p, v) = (knots.degree(), knots.values());
    let (a, b) = knots.domain();
    let mut sorted = parameters.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let mut next = sorted.into_iter().peekable();
    for i in (0..knots.control_count()).filter(|&i| !fixed(i)) {
        let inside = |t: f64| {
            let left = t > v[i] || (t <= a && v[i + p] <= a);
            let right = t < v[i + p + 1] || (t >= b && v[i + 1] >= b);
            (left, right)
        };
        loop {
            match next.peek() {
                None => return Some(i),
                Some(&t) => match inside(t) {
                    (true, true) => {
                        next.next();
                        break;
                    }
                    (false, _) => {
                        next.next();
                    }
                    (true, false) => return Some(i),
                },
            }
        }
    }
    None
}
