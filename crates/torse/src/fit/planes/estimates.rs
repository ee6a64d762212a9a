//! Tangent planes for rulings that are given without them.
//!
//! *Method* \[PW99, 4.3\], made precise: the plane contains the ruling's direction; its normal `n ⟂ d_i` minimises
//! `∫ (n·(X − P_i))²` over the two neighbouring rulings, a 2×2 eigenproblem. Inside a row the angle error is of second
//! order in the spacing; at the ends only one neighbour exists and it is of first order unless extrapolated.

use super::functionals::{Freedom, Functional, System};
use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;

/// Planes at the ends of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// From the one neighbour: first order.
    OneSided,
    /// Extrapolated from the three nearest inner planes, turned about the ruling: third order.
    Extrapolated,
}

/// Why there is no plane.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// Fewer than two rulings, or different counts of ends.
    #[error("{0} rulings: at least two are needed, each with two ends")]
    Count(usize),
    /// A ruling without length or with a coordinate that is not finite.
    #[error("ruling {index} has no length or a coordinate that is not a finite number")]
    Ruling {
        /// Its index.
        index: usize,
    },
    /// The neighbours do not span a plane with the ruling.
    #[error("ruling {index}: its neighbours lie on it, or all over the place (ratio {ratio:.2} of the mean squares): no tangent plane")]
    Vague {
        /// Its index.
        index: usize,
        /// Ratio of the eigenvalues; 1 where nothing is known.
        ratio: f64,
    },
}

/// Unit normals of the tangent planes along rulings given as segments `from[i]`–`to[i]`, in order along the surface;
/// neighbours are oriented alike.
///
/// # Errors
/// See [`EstimateError`].
pub fn planes_of_rulings(from: &[Vec3], to: &[Vec3], ends: Ends) -> Result<Vec<Vec3>, EstimateError> {
    let n = from.len();
    if n < 2 || to.len() != n {
        return Err(EstimateError::Count(n.min(to.len())));
    }
    for index in 0..n {
        let length = (to[index] - from[index]).norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(EstimateError::Ruling { index });
        }
    }
    let mut normals: Vec<Vec3> = Vec::with_capacity(n);
    for i in 0..n {
        let neighbours = [i.checked_sub(1), (i + 1 < n).then_some(i + 1)];
        let normal = one(from, to, i, &neighbours)?;
        let same = normals.last().is_none_or(|last: &Vec3| last.dot(&normal) >= 0.0);
        normals.push(if same { normal } else { -normal });
    }
    if ends == Ends::Extrapolated && n >= 6 {
        for (end, inner) in [(0, [1, 2, 3]), (n - 1, [n - 2, n - 3, n - 4])] {
            let d = (to[end] - from[end]).normalize();
            let wanted = normals[inner[0]] * 3.0 - normals[inner[1]] * 3.0 + normals[inner[2]];
            let flat = wanted - d * wanted.dot(&d);
            if flat.norm() > 0.0 {
                normals[end] = flat.normalize();
            }
        }
    }
    Ok(normals)
}

/// Unit normals of the tangent planes along rulings whose ends lie on smooth curves: the planes of ruling and
/// derivative across it, by differences over five neighbours. Fourth order inside and at the ends; with ends that jump
/// along their rulings only first order, where [`planes_of_rulings`] is better.
///
/// # Errors
/// See [`EstimateError`].
pub(crate) fn planes_of_smooth_rulings(from: &[Vec3], to: &[Vec3]) -> Result<Vec<Vec3>, EstimateError> {
    const NEIGHBOURS: usize = 5;
    let n = from.len();
    if n < 2 || to.len() != n {
        return Err(EstimateError::Count(n.min(to.len())));
    }
    let way = way(from, to);
    let mut normals: Vec<Vec3> = Vec::with_capacity(n);
    for i in 0..n {
        let length = (to[i] - from[i]).norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(EstimateError::Ruling { index: i });
        }
        let first = i.saturating_sub(NEIGHBOURS / 2).min(n - NEIGHBOURS.min(n));
        let at = &way[first..(first + NEIGHBOURS).min(n)];
        let across: Vec3 =
            slopes(at, way[i]).iter().enumerate().map(|(k, w)| (from[first + k] + to[first + k]) * *w).sum();
        let normal = (to[i] - from[i]).cross(&across);
        let Some(normal) = normal.try_normalize(0.0).filter(|v| v.iter().all(|x| x.is_finite())) else {
            return Err(EstimateError::Vague { index: i, ratio: 1.0 });
        };
        let same = normals.last().is_none_or(|last: &Vec3| last.dot(&normal) >= 0.0);
        normals.push(if same { normal } else { -normal });
    }
    Ok(normals)
}

/// Unit normals of the tangent planes along noisy rulings whose ends lie on smooth curves: both curves are cubic
/// splines by least squares, with the fewest spans whose largest distance from the ends is within `tolerance` (mm), or
/// with one span for every four rulings.
///
/// # Errors
/// See [`EstimateError`].
pub(crate) fn planes_of_noisy_rulings(from: &[Vec3], to: &[Vec3], tolerance: f64) -> Result<Vec<Vec3>, EstimateError> {
    const DEGREE: usize = 3;
    // Share of the data's own weight that smoothing has: spans without rulings stay determined, and others do not move.
    const WEAK: f64 = 1e-12;
    let n = from.len();
    if n <= DEGREE || to.len() != n {
        return Err(EstimateError::Count(n.min(to.len())));
    }
    let way = way(from, to);
    let index = way.windows(2).position(|w| w[1].is_nan() || w[1] <= w[0]);
    if let Some(index) = index {
        return Err(EstimateError::Ruling { index });
    }
    let mut spans = 1;
    loop {
        let knots = Knots::uniform(DEGREE, spans, 0.0, way[n - 1]).map_err(|_| EstimateError::Count(n))?;
        let free = vec![Freedom::Free; knots.control_count()];
        let mut system = System::<6>::new(&knots, &free);
        for (i, &t) in way.iter().enumerate() {
            for k in 0..6 {
                let value = if k < 3 { from[i][k] } else { to[i][k - 3] };
                let row = std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 });
                system.add(&Functional { t, coefficients: [row, [0.0; 6], [0.0; 6]], value, weight: 1.0 });
            }
        }
        let root: [[f64; 6]; 6] = std::array::from_fn(|k| std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 }));
        system.add_smoothing(WEAK, &root);
        let control = system.solved(0.0).ok_or(EstimateError::Count(n))?;
        let curve = Curve::<6>::new(DEGREE, knots.values().to_vec(), control).map_err(|_| EstimateError::Count(n))?;
        let off = (0..n).map(|i| {
            let x = curve.point(way[i]);
            let end = |k: usize, p: &Vec3| (Vec3::new(x[k], x[k + 1], x[k + 2]) - p).norm();
            end(0, &from[i]).max(end(3, &to[i]))
        });
        if off.fold(0.0, f64::max) > tolerance && 2 * spans * (DEGREE + 1) <= n {
            spans *= 2;
            continue;
        }
        let mut normals: Vec<Vec3> = Vec::with_capacity(n);
        for (index, &t) in way.iter().enumerate() {
            let [x, d, _] = curve.jet(t);
            let along = Vec3::new(x[3] - x[0], x[4] - x[1], x[5] - x[2]);
            let normal = along.cross(&Vec3::new(d[0] + d[3], d[1] + d[4], d[2] + d[5]));
            let normal = normal.try_normalize(0.0).ok_or(EstimateError::Vague { index, ratio: 1.0 })?;
            let same = normals.last().is_none_or(|last: &Vec3| last.dot(&normal) >= 0.0);
            normals.push(if same { normal } else { -normal });
        }
        return Ok(normals);
    }
}

/// Mean way of both ends along the row.
fn way(from: &[Vec3], to: &[Vec3]) -> Vec<f64> {
    let mut way = vec![0.0];
    for i in 1..from.len() {
        way.push(way[i - 1] + 0.5 * ((from[i] - from[i - 1]).norm() + (to[i] - to[i - 1]).norm()));
    }
    way
}

/// Weights of values at the places `x` in the derivative of their interpolating polynomial at `t`.
fn slopes(x: &[f64], t: f64) -> Vec<f64> {
    (0..x.len())
        .map(|j| {
            (0..x.len())
                .filter(|&m| m != j)
                .map(|m| {
                    let others: f64 =
                        (0..x.len()).filter(|&k| k != j && k != m).map(|k| (t - x[k]) / (x[j] - x[k])).product();
                    others / (x[j] - x[m])
                })
                .sum()
        })
        .collect()
}

fn one(from: &[Vec3], to: &[Vec3], i: usize, neighbours: &[Option<usize>; 2]) -> Result<Vec3, EstimateError> {
    // Beyond this ratio of mean squares the neighbours do not lie in a plane with the ruling.
    const VAGUE: f64 = 0.2;
    let d = (to[i] - from[i]).normalize();
    let a = {
        let k = d.iamin();
        d.cross(&Vec3::ith(k, 1.0)).normalize()
    };
    let b = d.cross(&a);
    // Mean squares of the coordinates along a and b over the segments; Simpson's rule is exact for squares.
    let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
    for k in neighbours.iter().flatten() {
        for (x, w) in [(from[*k], 1.0), (0.5 * (from[*k] + to[*k]), 4.0), (to[*k], 1.0)] {
            let e = x - from[i];
            let (p, q) = (e.dot(&a), e.dot(&b));
            aa += w * p * p;
            ab += w * p * q;
            bb += w * q * q;
        }
    }
    let (mean, half) = (0.5 * (aa + bb), (0.25 * (aa - bb) * (aa - bb) + ab * ab).sqrt());
    let (small, large) = (mean - half, mean + half);
    let ratio = if large > 0.0 { small / large } else { 1.0 };
    if ratio.is_nan() || ratio > VAGUE {
        return Err(EstimateError::Vague { index: i, ratio });
    }
    // Eigenvector of the small eigenvalue, from the better conditioned row.
    let (x, y) = if (aa - small).abs() > (bb - small).abs() { (-ab, aa - small) } else { (bb - small, -ab) };
    Ok((a * x + b * y).normalize())
}

/// The ruling through a point of a surface with the second fundamental form `[[l, m], [m, n]]` in an orthonormal
/// basis of the tangent plane: its null direction (for measured data: that of the smaller curvature in size), as a
/// unit vector in that basis. `None` where both curvatures vanish.
pub fn ruling_direction(form: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let [[l, m], [_, n]] = form;
    let (mean, half) = (0.5 * (l + n), (0.25 * (l - n) * (l - n) + m * m).sqrt());
    let small = if mean >= 0.0 { mean - half } else { mean + half };
    if half.is_nan() || half <= 0.0 {
        return None;
    }
    let (x, y) = if (l - small).abs() > (n - small).abs() { (-m, l - small) } else { (n - small, -m) };
    let size = x.hypot(y);
    (size > 0.0).then(|| [x / size, y / size])
}
