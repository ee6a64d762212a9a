//! The tangent planes of a net as a spline in dual space.
//!
//! *Method.* The plane along ruling `u` goes through the homogeneous points `c`, `c'` and `e`; its coordinates are
//! their 3 × 3 minors, products in Bernstein form, of degree `3n − 1` in `u` \[FJ07, PW99\].

use super::control_net::{Net, NetError};
use crate::num::bernstein::{derivative, difference, from_spline, product, sum, with_degree};
use crate::spline::blossom::of_piece;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::MAX_DEGREE;

/// Planes `(n_x, n_y, n_z, h)` with `n·X = h`, mm, not normalised, one per ruling, exact up to rounding.
///
/// # Errors
/// A degree whose planes exceed the largest supported one; an interior knot as often as the degree, where the planes
/// may jump.
pub(super) fn tangent_planes(net: &Net) -> Result<Curve<4>, NetError> {
    let (n, knots) = (net.degree(), &net.curve().knots);
    let q = 3 * n - 1;
    if q > MAX_DEGREE {
        let reason = format!("its tangent planes have degree {q}; at most {MAX_DEGREE} is supported");
        return Err(NetError::Form { reason });
    }
    let breaks = knots.breaks();
    let mut values = vec![breaks[0]; q + 1];
    for (t, m) in knots.distinct() {
        if t > breaks[0] && t < breaks[breaks.len() - 1] {
            if m >= n {
                return Err(NetError::Form { reason: format!("its curve has a corner at the knot {t}; cut it there") });
            }
            // The planes are as smooth as c', which is n − 1 − m times differentiable.
            values.extend(std::iter::repeat_n(t, 2 * n + m));
        }
    }
    values.extend(std::iter::repeat_n(breaks[breaks.len() - 1], q + 1));
    let count = values.len() - q - 1;
    let planes = Knots::new(q, values, count)?;
    let pieces: Vec<Vec<[f64; 4]>> = breaks.windows(2).map(|w| piece(net, w[0], w[1], q)).collect();
    let v = planes.values();
    let control = (0..count)
        .map(|i| {
            let args = &v[i + 1..=i + q];
            // The piece that holds most of the arguments: least is extrapolated.
            let held = |w: &[f64]| args.iter().filter(|t| **t >= w[0] && **t <= w[1]).count();
            let k = (0..pieces.len()).rev().max_by_key(|&k| held(&breaks[k..k + 2])).unwrap_or(0);
            let mut local = vec![breaks[k]; q + 1];
            local.extend(std::iter::repeat_n(breaks[k + 1], q + 1));
            let local = Knots::new(q, local, q + 1)?;
            Ok(of_piece(&local, q, &mut pieces[k].clone(), args))
        })
        .collect::<Result<Vec<_>, NetError>>()?;
    Ok(Curve { knots: planes, control })
}

/// Bernstein coefficients of the planes on `[from, to]`.
fn piece(net: &Net, from: f64, to: f64, degree: usize) -> Vec<[f64; 4]> {
    let knots = &net.curve().knots;
    let (p, all) = (knots.degree(), knots.values());
    let span = knots.span(0.5 * (from + to));
    let part = |control: &[[f64; 4]]| -> [Vec<f64>; 4] {
        std::array::from_fn(|d| {
            let coefficients: Vec<f64> = control[span - p..=span].iter().map(|c| c[d]).collect();
            from_spline(&coefficients, &all[span + 1 - p..=span + p])
        })
    };
    let (c, e) = (part(&net.curve().control), part(net.rulings()));
    // Derivatives by the parameter itself, so that neighbouring pieces agree.
    let slope: [Vec<f64>; 4] =
        std::array::from_fn(|d| derivative(&c[d]).iter().map(|x| x / (to - from)).collect::<Vec<f64>>());
    let cross = |x: &[Vec<f64>; 4], y: &[Vec<f64>; 4]| -> [Vec<f64>; 3] {
        std::array::from_fn(|d| {
            let (i, j) = ((d + 1) % 3, (d + 2) % 3);
            difference(&product(&x[i], &y[j]), &product(&x[j], &y[i]))
        })
    };
    let (a, b, g) = (cross(&slope, &e), cross(&e, &c), cross(&c, &slope));
    let normal: [Vec<f64>; 3] =
        std::array::from_fn(|d| sum(&sum(&product(&a[d], &c[3]), &product(&g[d], &e[3])), &product(&b[d], &slope[3])));
    // h = det(c, c', e), from n·c w_c⁻¹ without the division.
    let offset = (0..3).map(|d| product(&c[d], &a[d])).reduce(|x, y| sum(&x, &y)).unwrap_or_default();
    let raised: Vec<Vec<f64>> = normal.iter().chain([&offset]).map(|b| with_degree(b, degree)).collect();
    (0..=degree).map(|i| std::array::from_fn(|d| raised[d][i])).collect()
}
