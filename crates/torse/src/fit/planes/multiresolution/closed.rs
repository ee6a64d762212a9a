//! Closed contours as trigonometric splines: support functions with period 2π \[PW99, 4.5\].
//!
//! *Method.* The local basis of the open case is continued periodically: functions that begin a turn later are the same
//! function, so that the space over N pieces has dimension N, and every contour in it closes: `∫ ρ e^{is} ds = 0` holds
//! for each basis function. The normal matrix is cyclically banded and solved densely.

use super::trigonometric::{
    check, of_coefficients, ConeStrip, Local, RadiusSign, StripError, TrigonometricSpline, FEWEST_CLOSED, NODES, PARTS,
};
use crate::num::least_squares::{BandMatrix, Rows};
use crate::num::quadratic_program::QuadraticProgram;
use crate::num::quadrature::gauss_legendre;
use std::f64::consts::TAU;

/// The closed trigonometric spline over `angles` nearest in L² to a support function with period 2π.
///
/// *Input*: angles that increase by less than a half turn each and go round once: the last is the first plus 2π; at
/// least four pieces. *Cost*: cubic in the number of pieces.
///
/// # Errors
/// See [`StripError`].
pub fn closed_support_spline(
    h: &dyn Fn(f64) -> f64,
    angles: &[f64],
    sign: RadiusSign,
) -> Result<TrigonometricSpline, StripError> {
    // Rounding of a full turn that is written down in decimals.
    const ONCE: f64 = 1e-9;
    check(angles)?;
    let count = angles.len() - 1;
    let turn = angles[count] - angles[0];
    if count < FEWEST_CLOSED || (turn - TAU).abs() > ONCE {
        return Err(StripError::Turn { pieces: count, turn });
    }
    let at = |i: isize| -> f64 {
        let turns = i.div_euclid(count as isize);
        angles[i.rem_euclid(count as isize) as usize] + turns as f64 * turn
    };
    let basis: Vec<Local> = (0..count + 2)
        .map(|j| {
            let j = j as isize - 2;
            Local::over([at(j), at(j + 1), at(j + 2), at(j + 3)])
        })
        .collect();
    let mut rows = Rows::new(count, count);
    let mut matrix = BandMatrix::zeros(count, count);
    let mut right = vec![0.0; count];
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
                rows.clear();
                let (_, row) = rows.push(0);
                for k in 0..3 {
                    row[(piece + k) % count] += basis[piece + k].value(phi);
                }
                matrix.add_row(&rows, 0, weight * step);
                rows.scatter(0, weight * step * value, &mut right);
            }
        }
    }
    let mut x = if sign == RadiusSign::Free {
        if !matrix.factorise() {
            return Err(StripError::Singular(angles[0]));
        }
        matrix.solve(&mut right);
        right
    } else {
        let s = if sign == RadiusSign::Positive { 1.0 } else { -1.0 };
        let mut program = QuadraticProgram::new(count);
        for i in 0..count {
            program.linear[i] = -right[i];
            for j in 0..=i {
                program.add_hessian(j, i, matrix.entry(i, j));
            }
        }
        for i in 0..count {
            program.at_least((0..3).map(|k| ((i + k) % count, s * basis[i + k].radii[2 - k])), 0.0);
        }
        program.solve()?.x
    };
    x.extend_from_within(..2);
    Ok(of_coefficients(angles, &basis, &x))
}

/// The closed strip between two planes nearest to the surface with support functions `h0`, `h1` of period 2π.
///
/// # Errors
/// See [`StripError`].
pub fn closed_cone_strip(
    h0: &dyn Fn(f64) -> f64,
    h1: &dyn Fn(f64) -> f64,
    angles: &[f64],
    sign: RadiusSign,
) -> Result<ConeStrip, StripError> {
    let bottom = closed_support_spline(h0, angles, sign)?;
    Ok(ConeStrip { bottom, top: closed_support_spline(h1, angles, sign)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(n: usize) -> Vec<f64> {
        (0..=n)
            .map(|i| {
                TAU * i as f64 / n as f64 + if i == 0 || i == n { 0.0 } else { 0.05 * (i as f64).sin() / n as f64 }
            })
            .collect()
    }

    #[test]
    fn closed_contours_close_and_converge() {
        // An ellipse with half axes 3 and 2, off the origin.
        let h = |p: f64| (9.0 * p.cos().powi(2) + 4.0 * p.sin().powi(2)).sqrt() + 0.5 * p.cos();
        let mut before = f64::INFINITY;
        for n in [8, 16, 32] {
            let s = closed_support_spline(&h, &turn(n), RadiusSign::Positive).expect("a contour");
            let (a, b) = (s.point(0.0), s.point(TAU));
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12 && (s.value(0.0).1 - s.value(TAU).1).abs() < 1e-12);
            let worst =
                (0..400).map(|i| TAU * f64::from(i) / 400.0).map(|p| (s.value(p).0 - h(p)).abs()).fold(0.0, f64::max);
            assert!(worst < before / 4.0, "{n}: {worst} after {before}");
            before = worst;
        }
    }

    #[test]
    fn circles_are_reproduced_and_open_angles_refused() {
        let h = |p: f64| 5.0 + 0.3 * p.cos() - 0.7 * p.sin();
        let s = closed_cone_strip(&h, &|p| 2.0 * h(p), &turn(6), RadiusSign::Free).expect("a strip");
        assert!(s.bottom.radii().iter().all(|r| (r - 5.0).abs() < 1e-11));
        assert!(s.top.radii().iter().all(|r| (r - 10.0).abs() < 1e-11) && s.singular_pieces().is_empty());
        assert!(matches!(
            closed_support_spline(&h, &[0.0, 1.0, 2.0, 3.0, 4.0], RadiusSign::Free),
            Err(StripError::Turn { pieces: 4, .. })
        ));
    }
}
