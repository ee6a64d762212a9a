//! Position, tangent plane and noise of the measured surface at places spread over it.
//!
//! *Method.* In every cell a quadric height field over the plane of the points around is fitted by least squares with
//! outliers losing their weight; its value and slope above the middle of the cell are the estimates \[PW99, 4.3: planes
//! are to be estimated first\]. Noise is averaged over the neighbourhood, and its bias is of fourth order in the cell.

use super::error::{CloudError, FEWEST};
use super::grid::{around, core, Grid};
use super::lines::distance_of_lines;

use crate::fit::planes::linear_system::robust_weights;
use crate::geom::Vec3;
use crate::num::parallel;
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector6};
use std::collections::HashMap;

/// Points of a neighbourhood that take part.
const CROWD: usize = 240;
/// Points that a quadric needs to be more than an interpolation.
const QUADRIC: usize = 10;

/// An estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Place on the surface, mm.
    pub x: Vec3,
    /// Unit normal, of any orientation.
    pub n: Vec3,
    /// Root mean square distance of the points around from the local surface, mm.
    pub noise: f64,
    /// Number of points that it stands for.
    pub weight: f64,
}

/// Estimates for a cloud with the cell of each.
pub struct Estimates {
    /// The estimates.
    pub items: Vec<Estimate>,
    /// Estimate of each point's cell, `None` for points too lonely to belong to a surface.
    pub of_point: Vec<Option<u32>>,
    /// Edge of the cells, mm.
    pub cell: f64,
    /// Median noise, mm.
    pub noise: f64,
    pub(super) links: Vec<(u32, u32)>,
    grid: Grid,
    index: HashMap<[i32; 3], u32>,
}

/// Estimates at up to about `count` places.
///
/// # Errors
/// Too few points, coordinates that are not finite, points in a line.
pub fn estimates(points: &[Vec3], count: usize) -> Result<Estimates, CloudError> {
    // Points per cell at least, on average.
    const DENSITY: usize = 8;
    // Edge of cells in distances of lines.
    const LINES: f64 = 1.25;
    check(points)?;
    let mut grid = Grid::with_count(points, (points.len() / DENSITY).clamp(4, count.max(4)));
    // Cells around a cell hold three lines of a scanner at least.
    let least = distance_of_lines(points).map_or(0.0, |apart| LINES * apart);
    if grid.size < least {
        grid = Grid::new(points, least);
    }
    let keys = grid.keys();
    let found: Vec<Option<Estimate>> = parallel::map(keys.iter(), |k| estimate(points, &grid, k));
    let mut items = Vec::new();
    let mut index = HashMap::new();
    let mut of_point = vec![None; points.len()];
    for (k, e) in keys.iter().zip(&found) {
        if let Some(e) = e {
            index.insert(*k, items.len() as u32);
            for &i in grid.cell(k) {
                of_point[i as usize] = Some(items.len() as u32);
            }
            items.push(*e);
        }
    }
    let mut links = Vec::new();
    for k in &keys {
        let Some(&a) = index.get(k) else { continue };
        links.extend(around(k, 1).filter_map(|o| index.get(&o)).filter(|&&b| b > a).map(|&b| (a, b)));
    }
    if items.is_empty() {
        return Err(CloudError::NoSurface { points: points.len(), places: keys.len() });
    }
    let mut noises: Vec<f64> = items.iter().map(|e| e.noise).collect();
    noises.sort_by(f64::total_cmp);
    let noise = noises[noises.len() / 2];
    Ok(Estimates { items, of_point, cell: grid.size, noise, links, grid, index })
}

impl Estimates {
    /// Estimates up to two cells from a place.
    pub(super) fn near<'a>(&'a self, p: &Vec3) -> impl Iterator<Item = u32> + 'a {
        let key = self.grid.key(p);
        let keys: Vec<[i32; 3]> = around(&key, 2).collect();
        keys.into_iter().filter_map(|k| self.index.get(&k).copied())
    }
}

fn check(points: &[Vec3]) -> Result<(), CloudError> {
    // Spread below this share of the largest is a line up to rounding of the file.
    const LINE: f64 = 1e-10;
    if points.len() < FEWEST {
        return Err(CloudError::Few(points.len()));
    }
    for (index, p) in points.iter().enumerate() {
        if let Some(&value) = p.iter().find(|x| !x.is_finite()) {
            return Err(CloudError::NotFinite { index, value });
        }
    }
    let b = core(points);
    let size = b.diagonal();
    if size <= 0.0 {
        return Err(CloudError::Thin { what: "place", within: 0.0, size: 0.0 });
    }
    // Points far from nearly all others do not make a line with them.
    let inside = |p: &&Vec3| (0..3).all(|k| p[k] >= b.min[k] && p[k] <= b.max[k]);
    let c = b.center();
    let (mut m, mut mean, mut count) = (Matrix3::zeros(), Vec3::zeros(), 0.0);
    for d in points.iter().filter(inside).map(|p| (p - c) / size) {
        m += d * d.transpose();
        mean += d;
        count += 1.0;
    }
    mean /= count;
    let mut e = SymmetricEigen::new(m / count - mean * mean.transpose()).eigenvalues;
    e.as_mut_slice().sort_by(f64::total_cmp);
    if e[1] <= LINE * e[2] {
        let within = e[1].max(0.0).sqrt() * size;
        return Err(CloudError::Thin { what: "line", within, size });
    }
    Ok(())
}

/// The estimate of one cell; `None` if the points around do not make a surface.
fn estimate(points: &[Vec3], grid: &Grid, key: &[i32; 3]) -> Option<Estimate> {
    // A neighbourhood thicker than this share of its width is a corner or a heap.
    const THICK: f64 = 0.15;
    // Ratio of the squared spreads, breadth against length, below which it is a row of points: no thousandth as broad.
    const ROW: f64 = 1e-6;
    const ROUNDS: usize = 6;
    // Points of a cell farther than this many times the noise (at least this share of the cell) are not on the surface.
    const OUTLYING: f64 = 5.0;
    const ROUGH: f64 = 1e-3;
    // Share of its trace that is added to the matrix of a quadric, which keeps it finite over rows of points …
    const RIDGE: f64 = 1e-9;
    // … and the part of that for its value and slopes, which such rows still tell.
    const LINEAR: f64 = 1e-3;
    let own = grid.cell(key);
    let middle = own.iter().map(|&i| points[i as usize]).sum::<Vec3>() / own.len() as f64;
    let near: Vec<u32> = around(key, 1).flat_map(|k| grid.cell(&k).iter().copied()).collect();
    let stride = near.len().div_ceil(CROWD).max(1);
    let near: Vec<Vec3> = near.into_iter().step_by(stride).map(|i| points[i as usize]).collect();
    if near.len() < 6 {
        return None;
    }
    let centre = near.iter().sum::<Vec3>() / near.len() as f64;
    let m: Matrix3<f64> = near.iter().map(|p| p - centre).map(|d| d * d.transpose()).sum();
    let eigen = SymmetricEigen::new(m);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let values = order.map(|k| eigen.eigenvalues[k]);
    if values[0] > THICK * values[1] || values[1] <= ROW * values[2] {
        return None;
    }
    let z: Vec3 = eigen.eigenvectors.column(order[0]).normalize();
    let x: Vec3 = eigen.eigenvectors.column(order[2]).normalize();
    let y = z.cross(&x);
    let h = grid.size;
    let local: Vec<[f64; 3]> = near
        .iter()
        .map(|p| {
            let d = (p - middle) / h;
            [d.dot(&x), d.dot(&y), d.dot(&z)]
        })
        .collect();
    let quadric = local.len() >= QUADRIC;
    let terms = |p: &[f64; 3]| -> Vector6<f64> {
        let q = if quadric { 1.0 } else { 0.0 };
        Vector6::new(1.0, p[0], p[1], q * p[0] * p[0], q * p[0] * p[1], q * p[1] * p[1])
    };
    let mut weights = vec![1.0; local.len()];
    let mut c = Vector6::zeros();
    let mut residuals = vec![0.0; local.len()];
    for round in 0..ROUNDS {
        let mut a = Matrix6::zeros();
        let mut b = Vector6::zeros();
        for (p, w) in local.iter().zip(&weights) {
            let t = terms(p);
            a += t * t.transpose() * *w;
            b += t * (p[2] * w);
        }
        let ridge = RIDGE * a.trace();
        for k in 0..6 {
            a[(k, k)] += if k < 3 { LINEAR * ridge } else { ridge };
        }
        c = a.cholesky()?.solve(&b);
        for (r, p) in residuals.iter_mut().zip(&local) {
            *r = p[2] - terms(p).dot(&c);
        }
        weights = robust_weights(&residuals, 2 * round);
    }
    let total: f64 = weights.iter().sum();
    let free = (total - if quadric { 6.0 } else { 3.0 }).max(1.0);
    let noise = (residuals.iter().zip(&weights).map(|(r, w)| w * r * r).sum::<f64>() / free).sqrt() * h;
    // Cells of outliers beside the surface say nothing about it.
    let far = |p: &Vec3| {
        let d = (p - middle) / h;
        let local = [d.dot(&x), d.dot(&y), d.dot(&z)];
        (local[2] - terms(&local).dot(&c)).abs() * h > OUTLYING * noise.max(ROUGH * h)
    };
    if 2 * own.iter().filter(|&&i| far(&points[i as usize])).count() >= own.len() {
        return None;
    }
    let n = (z - x * c[1] - y * c[2]).normalize();
    let place = middle + z * (c[0] * h);
    (place.iter().chain(n.iter()).all(|v| v.is_finite())).then_some(Estimate {
        x: place,
        n,
        noise,
        weight: own.len() as f64,
    })
}
