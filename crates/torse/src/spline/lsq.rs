//! Curves near given points: linear least squares with given parameters, end points met exactly.
//!
//! *Method.* Normal equations of \[PT97, 9.4.1\] with the first and last control point fixed; they are banded.
//! *Not guaranteed*: anything between the points.

use super::curve::Curve;
use super::knots::Knots;
use super::SplineError;
use crate::num::least_squares::{BandMatrix, Rows};

/// Data that no curve can be fitted to.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LsqError {
    /// Different numbers of points and parameters, or fewer than two.
    #[error("{points} points and {parameters} parameters: as many are needed, at least two")]
    Count {
        /// Number of points.
        points: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// Parameters decrease, are no numbers, or do not run from end to end of the domain.
    #[error("parameter {index} = {value}: parameters must not decrease and run from end to end of the knots")]
    Parameter {
        /// Index of the parameter.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A point with a coordinate that is not finite.
    #[error("point {index} has a coordinate that is not a finite number")]
    Point {
        /// Index of the point.
        index: usize,
    },
    /// Some control point is not determined by the data.
    #[error("the points do not determine {control} control points: use fewer spans or more points")]
    Undetermined {
        /// Number of control points asked for.
        control: usize,
    },
    /// The knots are not valid, or not clamped.
    #[error(transparent)]
    Knots(#[from] SplineError),
}

/// A fitted curve with its distance from the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit<const D: usize> {
    /// The curve.
    pub curve: Curve<D>,
    /// Largest distance between a point and the curve at the point's parameter.
    pub error: f64,
    /// Index of that point.
    pub worst: usize,
}

/// Parameters proportional to chord length on `[0, 1]`; equally spaced if all points coincide.
pub(crate) fn chord_parameters<const D: usize>(points: &[[f64; D]]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for w in points.windows(2) {
        let step = (0..D).map(|d| (w[1][d] - w[0][d]).powi(2)).sum::<f64>().sqrt();
        sums.push(sums[sums.len() - 1] + step);
    }
    sums.truncate(points.len());
    let (total, last) = (sums.last().copied().unwrap_or(0.0), sums.len().saturating_sub(1).max(1) as f64);
    if total > 0.0 && total.is_finite() {
        for x in &mut sums {
            *x /= total;
        }
    } else {
        for (i, x) in sums.iter_mut().enumerate() {
            *x = i as f64 / last;
        }
    }
    sums
}

/// The curve over clamped `knots` with least sum of squared distances to `points` at `parameters`, through the first
/// and the last point exactly.
///
/// *Input*: parameters from one end of the knots to the other, not decreasing.
/// *Cost*: linear in points and control points.
///
/// # Errors
/// See [`LsqError`].
pub(crate) fn fit<const D: usize>(points: &[[f64; D]], parameters: &[f64], knots: &Knots) -> Result<Fit<D>, LsqError> {
    check(points, parameters, knots)?;
    let (p, n) = (knots.degree(), knots.control_count());
    let (first, last) = (points[0], points[points.len() - 1]);
    let mut control = vec![first; n];
    control[n - 1] = last;
    if n > 2 {
        // Unknown: all control points but the two at the ends.
        let unknown = n - 2;
        let mut rows = Rows::new(unknown, p + 1);
        let mut right = vec![[0.0; D]; unknown];
        let mut matrix = BandMatrix::zeros(unknown, p + 1);
        for (index, (x, &t)) in points.iter().zip(parameters).enumerate() {
            let basis = knots.basis(t, 0);
            let mut rest = *x;
            let (start, row) = rows.push(basis.first.saturating_sub(1));
            for j in 0..=p {
                let (i, b) = (basis.first + j, basis.rows[0][j]);
                match i {
                    0 => (0..D).for_each(|d| rest[d] -= b * first[d]),
                    _ if i == n - 1 => (0..D).for_each(|d| rest[d] -= b * last[d]),
                    _ => row[i - 1 - start] = b,
                }
            }
            matrix.add_row(&rows, index, 1.0);
            let (start, row) = rows.row(index);
            for (k, b) in row.iter().enumerate() {
                for d in 0..D {
                    right[start + k][d] += b * rest[d];
                }
            }
        }
        if !matrix.factorise() {
            return Err(LsqError::Undetermined { control: n });
        }
        let mut column = vec![0.0; unknown];
        for d in 0..D {
            for (c, r) in column.iter_mut().zip(&right) {
                *c = r[d];
            }
            matrix.solve(&mut column);
            for (c, &x) in control[1..].iter_mut().zip(&column) {
                c[d] = x;
            }
        }
    }
    let curve = Curve { knots: knots.clone(), control };
    let (mut error, mut worst) = (0.0, 0);
    for (i, (x, &t)) in points.iter().zip(parameters).enumerate() {
        let distance = distance(&curve.point(t), x);
        if distance > error {
            (error, worst) = (distance, i);
        }
    }
    Ok(Fit { curve, error, worst })
}

/// A curve within `tolerance` of the points at their parameters, with spans halved where it is not near enough, or
/// the best one reached when spans run out of points or `max_spans` is reached: see [`Fit::error`].
///
/// # Errors
/// See [`LsqError`].
pub fn fit_within<const D: usize>(
    points: &[[f64; D]],
    parameters: &[f64],
    degree: usize,
    tolerance: f64,
    max_spans: usize,
) -> Result<Fit<D>, LsqError> {
    let (&a, &b) = match (parameters.first(), parameters.last()) {
        (Some(a), Some(b)) => (a, b),
        _ => return Err(LsqError::Count { points: points.len(), parameters: parameters.len() }),
    };
    let mut breaks = vec![a, b];
    let mut best = fit(points, parameters, &Knots::clamped(degree, &breaks)?)?;
    while best.error > tolerance && breaks.len() <= max_spans {
        let mut next = vec![a];
        for w in breaks.windows(2) {
            let from = parameters.partition_point(|&t| t < w[0]);
            let to = parameters.partition_point(|&t| t <= w[1]);
            let off = (from..to).any(|i| distance(&best.curve.point(parameters[i]), &points[i]) > tolerance);
            // Each half must keep two points or more, to determine its new control point.
            if off && to - from > 4 {
                next.push(0.5 * (w[0] + w[1]));
            }
            next.push(w[1]);
        }
        if next.len() == breaks.len() || next.len() > max_spans + 1 {
            break;
        }
        breaks = next;
        match fit(points, parameters, &Knots::clamped(degree, &breaks)?) {
            Ok(better) if better.error < best.error => best = better,
            Ok(_) => {}
            Err(LsqError::Undetermined { .. }) => break,
            Err(e) => return Err(e),
        }
    }
    Ok(best)
}

fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

/// Checks the input of [`fit`].
fn check<const D: usize>(points: &[[f64; D]], parameters: &[f64], knots: &Knots) -> Result<(), LsqError> {
    if points.len() != parameters.len() || points.len() < 2 {
        return Err(LsqError::Count { points: points.len(), parameters: parameters.len() });
    }
    if let Some(index) = points.iter().position(|x| x.iter().any(|c| !c.is_finite())) {
        return Err(LsqError::Point { index });
    }
    let (a, b) = knots.domain();
    let last = parameters.len() - 1;
    for (index, &value) in parameters.iter().enumerate() {
        let low = if index == 0 { a } else { parameters[index - 1] };
        let at_ends = (index > 0 || value <= a) && (index < last || value >= b);
        if !(value >= low && value <= b && at_ends) {
            return Err(LsqError::Parameter { index, value });
        }
    }
    let v = knots.values();
    let ends = [(v[0], a), (v[v.len() - 1], b)];
    for (value, end) in ends {
        if value != end {
            let multiplicity = v.iter().filter(|&&x| x == end).count();
            return Err(SplineError::Multiplicity { value: end, multiplicity, allowed: knots.degree() + 1 }.into());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::sample::any_curve;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn a_spline_is_found_again_from_its_points(curve in any_curve()) {
            // Points enough in every span, the ends included.
            let breaks = curve.knots.breaks();
            let mut parameters: Vec<f64> = breaks
                .windows(2)
                .flat_map(|w| (0..12).map(move |i| w[0] + (w[1] - w[0]) * f64::from(i) / 12.0))
                .collect();
            parameters.push(1.0);
            let points: Vec<[f64; 3]> = parameters.iter().map(|&t| curve.point(t)).collect();
            let found = fit(&points, &parameters, &curve.knots).expect("determined");
            prop_assert!(found.error < 1e-6, "{}", found.error);
            prop_assert_eq!(found.curve.control[0], points[0]);
            for (a, b) in found.curve.control.iter().zip(&curve.control) {
                prop_assert!(distance(a, b) < 1e-4);
            }
        }
    }

    #[test]
    fn halving_spans_reaches_the_tolerance() {
        let parameters: Vec<f64> = (0..=400).map(|i| f64::from(i) / 400.0).collect();
        let points: Vec<[f64; 2]> = parameters.iter().map(|&t| [t, (12.0 * t * t).sin()]).collect();
        let coarse = fit_within(&points, &parameters, 3, 1e-2, 100).expect("fit");
        let fine = fit_within(&points, &parameters, 3, 1e-4, 100).expect("fit");
        assert!(coarse.error <= 1e-2 && fine.error <= 1e-4);
        assert!(coarse.curve.control.len() < fine.curve.control.len() && fine.curve.control.len() < 60);
        // Few spans allowed: the best is answered, with its error.
        let poor = fit_within(&points, &parameters, 3, 1e-4, 2).expect("fit");
        assert!(poor.error > 1e-4 && poor.curve.control.len() <= 5);
    }

    #[test]
    fn unusable_data_are_refused() {
        let k = Knots::uniform(3, 8, 0.0, 1.0).expect("knots");
        let points = vec![[0.0], [1.0], [2.0]];
        assert!(matches!(fit(&points, &[0.0, 0.5, 1.0], &k), Err(LsqError::Undetermined { .. })));
        assert!(matches!(fit(&points, &[0.0, 1.0], &k), Err(LsqError::Count { .. })));
        assert!(matches!(fit(&points, &[0.0, 0.5, 0.9], &k), Err(LsqError::Parameter { index: 2, .. })));
        assert!(matches!(fit(&points, &[0.0, f64::NAN, 1.0], &k), Err(LsqError::Parameter { index: 1, .. })));
        assert!(matches!(fit(&[[0.0], [f64::INFINITY]], &[0.0, 1.0], &k), Err(LsqError::Point { index: 1 })));
        assert!(fit_within::<2>(&[], &[], 3, 1.0, 4).is_err());
        let open = Knots::new(2, vec![-1., 0., 0., 1., 1., 2.], 3).expect("knots");
        assert!(matches!(fit(&points, &[0.0, 0.5, 1.0], &open), Err(LsqError::Knots(_))));
    }

    #[test]
    fn chord_lengths_are_shares() {
        assert_eq!(chord_parameters(&[[0.0, 0.0], [3.0, 4.0], [3.0, 9.0]]), vec![0.0, 0.5, 1.0]);
        assert_eq!(chord_parameters(&[[1.0], [1.0], [1.0]]), vec![0.0, 0.5, 1.0]);
        assert!(chord_parameters::<2>(&[]).is_empty());
    }
}
