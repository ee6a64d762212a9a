//! Orthogonal spline wavelets over arbitrary knots, for curves of planes \[PW99, 4.5; SDS96\].
//!
//! *Method.* With knot insertion `P` and the mass matrix `M` of the fine B-splines, the coarse part is the orthogonal
//! projection `(PᵀMP)⁻¹PᵀM c`, the detail the rest. Wavelets are vectors of `ker(PᵀM)` in the shortest windows of
//! neighbouring control points that hold one. Coordinates are treated alike, so that all of this is the same for
//! every metric that does not change with the parameter.

use crate::num::least_squares::{BandMatrix, Rows};
use crate::num::quadrature::gauss_legendre;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::SplineError;
use nalgebra::DMatrix;

/// Why a curve cannot be split into levels.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LevelError {
    /// Not a spline.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// The coarse knots are not among the fine ones.
    #[error("the coarse knot {value} is not among the fine knots (as often): levels must be nested")]
    NotNested {
        /// Value of the knot.
        value: f64,
    },
    /// A tolerance that is not positive.
    #[error("the tolerance {0} is not a positive number")]
    Tolerance(f64),
    /// Rounding has made a matrix singular.
    #[error("the knots near {0} are too close to each other for double precision")]
    Singular(f64),
}

/// A curve split in two: `fine = insertion(coarse) + detail`.
#[derive(Clone, Debug, PartialEq)]
pub struct Split<const D: usize> {
    /// The projection to the coarse knots.
    pub coarse: Curve<D>,
    /// What is missing, over the fine knots; orthogonal to all splines over the coarse ones.
    pub detail: Curve<D>,
}

/// Splits a curve orthogonally.
///
/// # Errors
/// Coarse knots that are not part of the fine ones.
pub fn split<const D: usize>(fine: &Curve<D>, coarse: &Knots) -> Result<Split<D>, LevelError> {
    let more = inserted(&fine.knots, coarse)?;
    // (P'MP) x = P'M c, written with integrals over the coarse basis: exact Gauss rules on the fine spans.
    let n = coarse.control_count();
    let p = coarse.degree();
    let mut rows = Rows::new(n, p + 1);
    let mut matrix = BandMatrix::zeros(n, p + 1);
    let mut right = vec![vec![0.0; n]; D];
    let nodes = gauss_legendre(p + 1);
    for w in fine.knots.breaks().windows(2) {
        for (x, weight) in &nodes {
            let t = w[0] + (w[1] - w[0]) * x;
            let basis = coarse.basis(t, 0);
            rows.push(basis.first).1.copy_from_slice(&basis.rows[0][..=p]);
            let i = rows.len() - 1;
            let weight = weight * (w[1] - w[0]);
            matrix.add_row(&rows, i, weight);
            let value = fine.point(t);
            for d in 0..D {
                rows.scatter(i, weight * value[d], &mut right[d]);
            }
        }
    }
    if !matrix.factorise() {
        return Err(LevelError::Singular(coarse.domain().0));
    }
    right.iter_mut().for_each(|r| matrix.solve(r));
    let control = (0..n).map(|i| std::array::from_fn(|d| right[d][i])).collect();
    let coarse = Curve { knots: coarse.clone(), control };
    let back = coarse.with_knots(&more)?;
    let detail = fine.control.iter().zip(&back.control).map(|(a, b)| std::array::from_fn(|d| a[d] - b[d])).collect();
    Ok(Split { coarse, detail: Curve { knots: fine.knots.clone(), control: detail } })
}

impl<const D: usize> Split<D> {
    /// The curve that was split.
    ///
    /// # Errors
    /// None for splits made by [`split`].
    pub fn joined(&self) -> Result<Curve<D>, LevelError> {
        let more = inserted(&self.detail.knots, &self.coarse.knots)?;
        let back = self.coarse.with_knots(&more)?;
        let control =
            back.control.iter().zip(&self.detail.control).map(|(a, b)| std::array::from_fn(|d| a[d] + b[d])).collect();
        Ok(Curve { knots: back.knots, control })
    }
}

/// Knots to insert into `coarse` to get `fine`.
fn inserted(fine: &Knots, coarse: &Knots) -> Result<Vec<f64>, LevelError> {
    if fine.degree() != coarse.degree() || fine.domain() != coarse.domain() {
        return Err(LevelError::NotNested { value: coarse.domain().0 });
    }
    let mut more = Vec::new();
    let mut rest = coarse.values().iter().peekable();
    for &v in fine.values() {
        match rest.peek() {
            Some(&&c) if c == v => {
                rest.next();
            }
            Some(&&c) if c < v => return Err(LevelError::NotNested { value: c }),
            _ => more.push(v),
        }
    }
    match rest.next() {
        Some(&value) => Err(LevelError::NotNested { value }),
        None => Ok(more),
    }
}

/// A wavelet: coefficients over neighbouring fine control points, with norm 1 in L².
#[derive(Clone, Debug, PartialEq)]
pub struct Wavelet {
    /// First control point.
    pub first: usize,
    /// Coefficients.
    pub coefficients: Vec<f64>,
}

/// A basis of the splines over `fine` that are orthogonal to those over `coarse`, of short support (3p + 2
/// coefficients where every second knot is taken out, eleven for cubics, fewer at the ends).
///
/// *Method*: for each start the shortest window with a null vector of `PᵀM` that begins there. The basis is not unique.
///
/// # Errors
/// As [`split`].
pub fn wavelets(fine: &Knots, coarse: &Knots) -> Result<Vec<Wavelet>, LevelError> {
    // Singular values below this share of the largest are zero.
    const NULL: f64 = 1e-10;
    inserted(fine, coarse)?;
    let (n, m, p) = (fine.control_count(), coarse.control_count(), fine.degree());
    let nodes = gauss_legendre(p + 1);
    // Inner products of coarse with fine B-splines, and of fine with fine.
    let mut cross = DMatrix::zeros(m, n);
    let mut mass = DMatrix::zeros(n, n);
    for w in fine.breaks().windows(2) {
        for (x, weight) in &nodes {
            let (t, weight) = (w[0] + (w[1] - w[0]) * x, weight * (w[1] - w[0]));
            let (f, c) = (fine.basis(t, 0), coarse.basis(t, 0));
            for j in 0..=p {
                for i in 0..=p {
                    cross[(c.first + i, f.first + j)] += weight * c.rows[0][i] * f.rows[0][j];
                    mass[(f.first + i, f.first + j)] += weight * f.rows[0][i] * f.rows[0][j];
                }
            }
        }
    }
    let count = n - m;
    let mut out: Vec<Wavelet> = Vec::new();
    // Vectors with different first control points are independent, and the null space has as many of them as its
    // dimension: for each start the shortest window whose first column depends on the others.
    for start in 0..n {
        for length in 2..=n - start {
            let window = cross.columns(start, length).into_owned();
            let first = window.column(0).into_owned();
            let svd = window.columns(1, length - 1).into_owned().svd(true, true);
            let Ok(z) = svd.solve(&-&first, NULL * svd.singular_values.max()) else { continue };
            let rest = window.columns(1, length - 1) * &z + &first;
            if rest.norm() > NULL * first.norm() {
                continue;
            }
            let vector = nalgebra::DVector::from_iterator(length, std::iter::once(1.0).chain(z.iter().copied()));
            let block = mass.view((start, start), (length, length));
            let norm = (vector.transpose() * block * &vector)[(0, 0)].sqrt();
            out.push(Wavelet { first: start, coefficients: vector.iter().map(|x| x / norm).collect() });
            break;
        }
    }
    if out.len() == count {
        Ok(out)
    } else {
        Err(LevelError::Singular(coarse.domain().0))
    }
}

/// A curve at a coarse level with the detail coefficients that matter.
#[derive(Clone, Debug, PartialEq)]
pub struct Thinned<const D: usize> {
    /// The reconstruction from the coarsest level and what was kept.
    pub curve: Curve<D>,
    /// Detail control points kept, over all levels.
    pub kept: usize,
    /// Detail control points of all levels.
    pub total: usize,
    /// No coordinate of the reconstruction differs by more than this from the given curve, anywhere, up to rounding.
    pub error_bound: f64,
}

/// Compresses a curve: splits it through `levels` (each coarser than the one before) and drops details that move no
/// coordinate by more than `tolerance` in sum. The bound is that of the control points of the difference, rounded
/// outwards: B-splines are not negative and sum to 1.
///
/// # Errors
/// As [`split`]; a tolerance that is not positive.
pub fn thinned<const D: usize>(curve: &Curve<D>, levels: &[Knots], tolerance: f64) -> Result<Thinned<D>, LevelError> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(LevelError::Tolerance(tolerance));
    }
    let mut splits = Vec::new();
    let mut here = curve.clone();
    for level in levels {
        let s = split(&here, level)?;
        here = s.coarse.clone();
        splits.push(s);
    }
    let total = splits.iter().map(|s| s.detail.control.len()).sum();
    // Dropping details below a threshold moves the curve by at most the threshold at each level (B-splines sum to 1),
    // so this share is always allowed; larger ones are tried first.
    let safe = tolerance / levels.len().max(1) as f64;
    let mut threshold = 4.0 * safe;
    loop {
        let mut kept = 0;
        let mut again = here.clone();
        for s in splits.iter().rev() {
            let mut part = s.clone();
            part.coarse = again;
            for c in &mut part.detail.control {
                if c.iter().all(|x| x.abs() <= threshold) {
                    *c = [0.0; D];
                } else {
                    kept += 1;
                }
            }
            again = part.joined()?;
        }
        let error_bound = again
            .control
            .iter()
            .zip(&curve.control)
            .flat_map(|(a, b)| (0..D).map(move |d| gap_bound(a[d], b[d])))
            .fold(0.0, f64::max);
        if error_bound <= tolerance || threshold <= 0.25 * safe {
            return Ok(Thinned { curve: again, kept, total, error_bound });
        }
        threshold *= 0.5;
    }
}

/// Upper bound of the distance of two numbers; a difference that is not zero is rounded by half a unit at most.
fn gap_bound(a: f64, b: f64) -> f64 {
    let d = (a - b).abs();
    if d > 0.0 {
        d.next_up()
    } else {
        d
    }
}
