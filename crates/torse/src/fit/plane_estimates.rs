//! Tangent planes for rulings that are given without them.
//!
//! *Method* \[PW99, 4.3\], made precise: the plane contains the ruling's direction; its normal `n ⟂ d_i` minimises
//! `∫ (n·(X − P_i))²` over the two neighbouring rulings, a 2×2 eigenproblem. Inside a row the angle error is of second
//! order in the spacing; at the ends only one neighbour exists and it is of first order unless extrapolated.

use crate::geom::Vec3;

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
