//! Strips between two parallel planes made of oblique circular cones: support functions as trigonometric splines
//! \[PW99, 4.5\].
//!
//! *Method.* The contours in z = 0 and z = 1 have support functions h0, h1 of the normal angle φ. Over angles
//! `φ_0 < … < φ_N` the space of C¹ functions with pieces in span{1, cos φ, sin φ} has dimension N + 2; its contours
//! are arc splines with radii `ρ_i = h + h''`, constant on each piece. A local basis of functions over three pieces keeps
//! the least-squares problem banded. Both contours use the same angles, so that the strip consists of cones with
//! circular sections. By Corollary 9 the two contours are approximated separately, whichever of the metrics (15), (16)
//! is used.

use crate::num::least_squares::{BandMatrix, Rows};
use crate::num::quadratic_program::{QuadraticProgram, QuadraticProgramError};
use crate::num::quadrature::gauss_legendre;

/// Nodes of the Gauss rule on each part of a piece, and parts: smooth data are integrated to rounding.
pub(super) const NODES: usize = 12;
pub(super) const PARTS: usize = 2;

/// Pieces of a closed contour at least: three neighbours must not meet behind their backs.
pub(crate) const FEWEST_CLOSED: usize = 4;

/// Why a strip cannot be approximated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StripError {
    /// Fewer than two angles.
    #[error("{0} angles: at least two are needed")]
    Count(usize),
    /// Angles that do not increase, or are a half turn apart.
    #[error("angle {index} = {value}: angles must increase by less than a half turn")]
    Angle {
        /// Its index.
        index: usize,
        /// Its value, radians.
        value: f64,
    },
    /// Angles of a closed contour that do not go round once, or too few of them.
    #[error("a closed contour needs at least {FEWEST_CLOSED} pieces whose angles go round once; here {pieces} pieces turn by {turn}")]
    Turn {
        /// Number of pieces.
        pieces: usize,
        /// Last angle minus first, radians.
        turn: f64,
    },
    /// A support function that is not finite.
    #[error("the support function at the angle {0} is not a finite number")]
    Value(f64),
    /// The coarse angles are not among the fine ones.
    #[error("the coarse angle {0} is not among the fine ones: levels must be nested")]
    NotNested(f64),
    /// No radii of one sign fit.
    #[error("no arcs with radii of the wanted sign: {0}")]
    Sign(#[from] QuadraticProgramError),
    /// Rounding has made the matrix singular.
    #[error("angles near {0} are too close to each other for double precision")]
    Singular(f64),
}

/// A circular arc of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Normal angles at its ends, radians.
    pub angles: (f64, f64),
    /// Centre, mm.
    pub centre: [f64; 2],
    /// Radius with sign: negative where the contour turns against its normal, mm.
    pub radius: f64,
}

/// A support function that is a trigonometric spline: a contour made of arcs with common tangents.
#[derive(Clone, Debug, PartialEq)]
pub struct TrigonometricSpline {
    angles: Vec<f64>,
    /// `h = a cos φ + b sin φ` before the first angle.
    start: [f64; 2],
    /// Radius of each piece.
    radii: Vec<f64>,
}

impl TrigonometricSpline {
    /// From the centre of the arc through the start (as `a cos + b sin`) and the radii.
    ///
    /// # Errors
    /// Angles that do not increase.
    pub fn new(angles: Vec<f64>, start: [f64; 2], radii: Vec<f64>) -> Result<Self, StripError> {
        check(&angles)?;
        if radii.len() + 1 != angles.len() {
            return Err(StripError::Count(radii.len()));
        }
        Ok(Self { angles, start, radii })
    }

    /// Angles between the pieces, radians.
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// Radii of the pieces, mm.
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// `(h, h')` at an angle.
    pub fn value(&self, phi: f64) -> (f64, f64) {
        let mut h = self.start[0] * phi.cos() + self.start[1] * phi.sin();
        let mut d = -self.start[0] * phi.sin() + self.start[1] * phi.cos();
        for (w, r) in self.angles.windows(2).zip(&self.radii) {
            if phi <= w[0] {
                break;
            }
            let end = w[1].min(phi);
            // ∫ sin(φ − s) ds and ∫ cos(φ − s) ds over the piece.
            h += r * ((phi - end).cos() - (phi - w[0]).cos());
            d += r * ((phi - w[0]).sin() - (phi - end).sin());
        }
        (h, d)
    }

    /// The arcs of the contour. Centre `(h − ρ) n + h' t` with normal `n = (cos, sin)` and `t = (−sin, cos)`.
    pub fn arcs(&self) -> Vec<Arc> {
        let mut centre = self.start;
        self.angles
            .windows(2)
            .enumerate()
            .map(|(i, w)| {
                // Centres of neighbours lie on the common normal, radii differ by the distance.
                let before = if i == 0 { 0.0 } else { self.radii[i - 1] };
                let step = before - self.radii[i];
                centre = [centre[0] + step * w[0].cos(), centre[1] + step * w[0].sin()];
                Arc { angles: (w[0], w[1]), centre, radius: self.radii[i] }
            })
            .collect()
    }

    /// The same function over more angles.
    ///
    /// # Errors
    /// Angles that do not contain the present ones.
    pub fn refined(&self, angles: &[f64]) -> Result<Self, StripError> {
        check(angles)?;
        nested(angles, &self.angles)?;
        let radii = angles
            .windows(2)
            .map(|w| {
                let middle = 0.5 * (w[0] + w[1]);
                let i = self.angles.partition_point(|a| *a <= middle).clamp(1, self.radii.len());
                self.radii[i - 1]
            })
            .collect();
        Ok(Self { angles: angles.to_vec(), start: self.start, radii })
    }

    /// Point of the contour with normal angle `phi`.
    pub fn point(&self, phi: f64) -> [f64; 2] {
        let (h, d) = self.value(phi);
        [h * phi.cos() - d * phi.sin(), h * phi.sin() + d * phi.cos()]
    }
}

pub(super) fn check(angles: &[f64]) -> Result<(), StripError> {
    if angles.len() < 2 {
        return Err(StripError::Count(angles.len()));
    }
    for (index, &value) in angles.iter().enumerate() {
        let step = if index > 0 { value - angles[index - 1] } else { 1.0 };
        if !(value.is_finite() && step > 0.0 && step < std::f64::consts::PI) {
            return Err(StripError::Angle { index, value });
        }
    }
    Ok(())
}

fn nested(fine: &[f64], coarse: &[f64]) -> Result<(), StripError> {
    let ends = fine.first() == coarse.first() && fine.last() == coarse.last();
    match coarse.iter().find(|c| !fine.contains(c)) {
        Some(&c) => Err(StripError::NotNested(c)),
        None if !ends => Err(StripError::NotNested(coarse[0])),
        None => Ok(()),
    }
}

/// A local basis function: three pieces from angle `first` of the extended angles, zero outside.
pub(super) struct Local {
    angles: [f64; 4],
    pub(super) radii: [f64; 3],
}

impl Local {
    /// Radii with vanishing closing vector `∫ ρ e^{is} ds`, scaled to height about 1.
    pub(super) fn over(angles: [f64; 4]) -> Self {
        let e = |i: usize| {
            let (a, b) = (angles[i], angles[i + 1]);
            [b.sin() - a.sin(), a.cos() - b.cos()]
        };
        let (p, q, r) = (e(0), e(1), e(2));
        let cross = |x: [f64; 2], y: [f64; 2]| x[0] * y[1] - x[1] * y[0];
        let raw = [cross(q, r), cross(r, p), cross(p, q)];
        let mut local = Self { angles, radii: raw };
        let height = local.value(0.5 * (angles[1] + angles[2]));
        local.radii = raw.map(|x| x / height);
        local
    }

    pub(super) fn value(&self, phi: f64) -> f64 {
        if phi <= self.angles[0] || phi >= self.angles[3] {
            return 0.0;
        }
        (0..3)
            .map(|i| {
                let (a, b) = (self.angles[i], self.angles[i + 1]);
                if phi <= a {
                    return 0.0;
                }
                self.radii[i] * ((phi - b.min(phi)).cos() - (phi - a).cos())
            })
            .sum()
    }
}

/// Basis over angles continued by their own first and last steps.
fn basis(angles: &[f64]) -> Vec<Local> {
    let n = angles.len() - 1;
    let at = |i: isize| -> f64 {
        if i < 0 {
            angles[0] + i as f64 * (angles[1] - angles[0])
        } else if i as usize > n {
            angles[n] + (i - n as isize) as f64 * (angles[n] - angles[n - 1])
        } else {
            angles[i as usize]
        }
    };
    (0..n + 2)
        .map(|j| {
            let j = j as isize - 2;
            Local::over([at(j), at(j + 1), at(j + 2), at(j + 3)])
        })
        .collect()
}

/// Sign wanted of all radii.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RadiusSign {
    /// Any.
    Free,
    /// Not negative: a convex contour.
    Positive,
    /// Not positive.
    Negative,
}

/// The trigonometric spline over `angles` nearest to a support function in L².
///
/// # Errors
/// See [`StripError`].
pub fn support_spline(
    h: &dyn Fn(f64) -> f64,
    angles: &[f64],
    sign: RadiusSign,
) -> Result<TrigonometricSpline, StripError> {
    check(angles)?;
    let basis = basis(angles);
    let n = basis.len();
    let mut rows = Rows::new(n, 3);
    let mut matrix = BandMatrix::zeros(n, 3);
    let mut right = vec![0.0; n];
    let mut samples = Vec::new();
    let nodes = gauss_legendre(NODES);
    for (piece, w) in angles.windows(2).enumerate() {
        let step = (w[1] - w[0]) / PARTS as f64;
        for part in 0..PARTS {
            for (x, weight) in &nodes {
                let phi = w[0] + step * (part as f64 + x);
                let value = h(phi);
                if !value.is_finite() {
                    return Err(StripError::Value(phi));
                }
                let (_, row) = rows.push(piece);
                for (k, r) in row.iter_mut().enumerate() {
                    *r = basis[piece + k].value(phi);
                }
                samples.push((weight * step, value));
            }
        }
    }
    for (i, (weight, value)) in samples.iter().enumerate() {
        matrix.add_row(&rows, i, *weight);
        rows.scatter(i, weight * value, &mut right);
    }
    let x = if sign == RadiusSign::Free {
        let mut factor = matrix.clone();
        if !factor.factorise() {
            return Err(StripError::Singular(angles[0]));
        }
        let mut x = right.clone();
        factor.solve(&mut x);
        // One refinement with the residual of the rows.
        let mut rest = vec![0.0; n];
        for (i, (weight, value)) in samples.iter().enumerate() {
            rows.scatter(i, weight * (value - rows.dot(i, &x)), &mut rest);
        }
        factor.solve(&mut rest);
        x.iter().zip(&rest).map(|(a, b)| a + b).collect()
    } else {
        let s = if sign == RadiusSign::Positive { 1.0 } else { -1.0 };
        let mut program = QuadraticProgram::new(n);
        for i in 0..n {
            program.linear[i] = -right[i];
            for j in i.saturating_sub(2)..=i {
                program.add_hessian(j, i, matrix.entry(i, j));
            }
        }
        for i in 0..angles.len() - 1 {
            program.at_least((0..3).map(|k| (i + k, s * basis[i + k].radii[2 - k])), 0.0);
        }
        program.solve()?.x
    };
    Ok(of_coefficients(angles, &basis, &x))
}

impl Local {
    fn slope(&self, phi: f64) -> f64 {
        if phi <= self.angles[0] || phi >= self.angles[3] {
            return 0.0;
        }
        (0..3)
            .map(|i| {
                let (a, b) = (self.angles[i], self.angles[i + 1]);
                if phi <= a {
                    return 0.0;
                }
                self.radii[i] * ((phi - a).sin() - (phi - b.min(phi)).sin())
            })
            .sum()
    }
}

/// Distance of planes with parallel contour lines from the distances `h0`, `h1` of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContourMetric {
    /// `h0² + h1²` \[PW99, (15)\].
    Contours,
    /// `∫ h(z)² dz = (h0² + h0 h1 + h1²) / 3` \[PW99, (16)\].
    Integral,
}

impl ContourMetric {
    /// The quadratic form.
    pub fn square(self, h0: f64, h1: f64) -> f64 {
        match self {
            Self::Contours => h0 * h0 + h1 * h1,
            Self::Integral => (h0 * h0 + h0 * h1 + h1 * h1) / 3.0,
        }
    }
}

/// A strip between z = 0 and z = 1 (times its height) of oblique circular cones.
#[derive(Clone, Debug, PartialEq)]
pub struct ConeStrip {
    /// Contour in z = 0.
    pub bottom: TrigonometricSpline,
    /// Contour in z = 1, over the same angles.
    pub top: TrigonometricSpline,
}

/// The strip over `angles` nearest to the surface with support functions `h0`, `h1`: by Corollary 9 each contour for
/// itself, in both metrics.
///
/// # Errors
/// See [`StripError`].
pub fn cone_strip(
    h0: &dyn Fn(f64) -> f64,
    h1: &dyn Fn(f64) -> f64,
    angles: &[f64],
    sign: RadiusSign,
) -> Result<ConeStrip, StripError> {
    Ok(ConeStrip { bottom: support_spline(h0, angles, sign)?, top: support_spline(h1, angles, sign)? })
}

impl ConeStrip {
    /// The strip over fewer angles, the orthogonal projection; what is lost is orthogonal to it (Theorem 8).
    ///
    /// # Errors
    /// Angles that are not among the present ones.
    pub fn coarsened(&self, angles: &[f64]) -> Result<Self, StripError> {
        check(angles)?;
        nested(self.bottom.angles(), angles)?;
        // Integration over the pieces of the fine function, on which the coarse basis is smooth too.
        Ok(Self { bottom: projected(&self.bottom, angles)?, top: projected(&self.top, angles)? })
    }

    /// Squared distance to the surface with support functions `h0`, `h1` over the strip's angles.
    pub fn distance_sq(&self, h0: &dyn Fn(f64) -> f64, h1: &dyn Fn(f64) -> f64, metric: ContourMetric) -> f64 {
        let nodes = gauss_legendre(NODES);
        let mut sum = 0.0;
        for w in self.bottom.angles().windows(2) {
            let step = (w[1] - w[0]) / PARTS as f64;
            for part in 0..PARTS {
                for (x, weight) in &nodes {
                    let phi = w[0] + step * (part as f64 + x);
                    let e = (h0(phi) - self.bottom.value(phi).0, h1(phi) - self.top.value(phi).0);
                    sum += step * weight * metric.square(e.0, e.1);
                }
            }
        }
        sum
    }

    /// Heights (as shares of the strip) of the apexes of the cones; `None` for cylinders.
    pub fn apexes(&self) -> Vec<Option<f64>> {
        self.bottom
            .radii()
            .iter()
            .zip(self.top.radii())
            .map(|(a, b)| if a == b { None } else { Some(a / (a - b)) })
            .collect()
    }

    /// Pieces with the apex inside the strip: the radii have different signs.
    pub fn singular_pieces(&self) -> Vec<usize> {
        (0..self.bottom.radii().len()).filter(|&i| self.bottom.radii()[i] * self.top.radii()[i] < 0.0).collect()
    }
}

/// Orthogonal projection to fewer angles.
fn projected(fine: &TrigonometricSpline, angles: &[f64]) -> Result<TrigonometricSpline, StripError> {
    let basis = basis(angles);
    let n = basis.len();
    let mut rows = Rows::new(n, 3);
    let mut matrix = BandMatrix::zeros(n, 3);
    let mut right = vec![0.0; n];
    let nodes = gauss_legendre(NODES);
    for w in fine.angles.windows(2) {
        let piece = angles.partition_point(|a| *a <= 0.5 * (w[0] + w[1])).clamp(1, angles.len() - 1) - 1;
        for (x, weight) in &nodes {
            let phi = w[0] + (w[1] - w[0]) * x;
            let (_, row) = rows.push(piece);
            for (k, r) in row.iter_mut().enumerate() {
                *r = basis[piece + k].value(phi);
            }
            let i = rows.len() - 1;
            let weight = weight * (w[1] - w[0]);
            matrix.add_row(&rows, i, weight);
            rows.scatter(i, weight * fine.value(phi).0, &mut right);
        }
    }
    if !matrix.factorise() {
        return Err(StripError::Singular(angles[0]));
    }
    matrix.solve(&mut right);
    Ok(of_coefficients(angles, &basis, &right))
}

/// The spline with given coefficients of the local basis.
pub(super) fn of_coefficients(angles: &[f64], basis: &[Local], x: &[f64]) -> TrigonometricSpline {
    let radii = (0..angles.len() - 1).map(|i| (0..3).map(|k| x[i + k] * basis[i + k].radii[2 - k]).sum()).collect();
    let phi = angles[0];
    let (value, slope) =
        (0..3).fold((0.0, 0.0), |(v, d), k| (v + x[k] * basis[k].value(phi), d + x[k] * basis[k].slope(phi)));
    let (c, s) = (phi.cos(), phi.sin());
    TrigonometricSpline { angles: angles.to_vec(), start: [value * c - slope * s, value * s + slope * c], radii }
}
