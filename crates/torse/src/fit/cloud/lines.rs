//! Points that lie in lines, as scanners write them that sweep a line over the sheet: how far the lines are apart.
//!
//! *Method.* Around some points the nearest ones are looked at: where they lie in a line, the nearest points on both sides of it tell
//! the distance of the lines. Cells of a cloud must be larger than that, or each knows one line only, and no surface.

use crate::geom::Vec3;
use crate::num::parallel;
use nalgebra::{Matrix3, SymmetricEigen};

/// Points around which it is looked, at least and at most, and distances that are measured for these if there are enough points.
const LOOKS: (usize, usize) = (24, 120);
const DISTANCES: usize = 40_000_000;
/// Points around each: lines a tenth as dense across as along show within these.
const AROUND: usize = 20;
/// Ratio of the squared spreads, across against along, below which points lie in a line.
const LINE: f64 = 0.05;
/// Points beside a line are farther from it than so many of its spreads.
const BESIDE: f64 = 4.0;
/// Largest ratio of the distances of a line from both of its neighbours.
const UNEVEN: f64 = 4.0;
/// Share of the distances found that are no greater than the one that is told: cells should span all.
const NEARLY_ALL: f64 = 0.9;
/// Share of the looks that must find a line.
const FINDING: f64 = 0.7;

/// Distance (mm) of neighbouring lines in which points lie, where it is large; `None` where they do not lie in lines.
///
/// *Cost*: some operations for each point and each of a hundred places.
pub(super) fn distance_of_lines(points: &[Vec3]) -> Option<f64> {
    let count = (DISTANCES / points.len().max(1)).clamp(LOOKS.0, LOOKS.1);
    let stride = points.len().div_ceil(count).max(1);
    let looks: Vec<&Vec3> = points.iter().step_by(stride).collect();
    let found: Vec<f64> = parallel::map(looks.iter(), |p| beside(points, p)).into_iter().flatten().collect();
    if (found.len() as f64) < FINDING * looks.len() as f64 {
        return None;
    }
    let mut found = found;
    found.sort_by(f64::total_cmp);
    found.get((NEARLY_ALL * found.len() as f64) as usize).copied()
}

/// Distance of the farther of both lines beside the line of points around one; `None` where there is no such line.
fn beside(points: &[Vec3], p: &Vec3) -> Option<f64> {
    let mut by_distance: Vec<(f64, u32)> = points.iter().zip(0..).map(|(q, i)| ((q - p).norm_squared(), i)).collect();
    let count = AROUND.min(by_distance.len().checked_sub(1)?);
    by_distance.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0));
    let near: Vec<Vec3> = by_distance[..=count].iter().map(|d| points[d.1 as usize]).collect();
    let middle = near.iter().sum::<Vec3>() / near.len() as f64;
    let m: Matrix3<f64> = near.iter().map(|q| (q - middle) * (q - middle).transpose()).sum();
    let e = SymmetricEigen::new(m / near.len() as f64);
    let along = e.eigenvalues.imax();
    let direction: Vec3 = e.eigenvectors.column(along).into_owned();
    let across = (0..3).filter(|k| *k != along).map(|k| e.eigenvalues[k]).fold(0.0, f64::max);
    if across > LINE * e.eigenvalues[along] {
        return None;
    }
    let off = BESIDE * across.max(0.0).sqrt();
    // Lines that bend leave their direction: only what lies abreast counts.
    let abreast = |q: &&Vec3| {
        let d = *q - middle;
        let ahead = d.dot(&direction);
        let aside = (d - direction * ahead).norm();
        aside > off && aside > ahead.abs()
    };
    let nearest = |a: &Vec3, b: &Vec3| a.norm_squared().total_cmp(&b.norm_squared());
    let first = points.iter().filter(abreast).map(|q| q - middle).min_by(nearest)?;
    let across = |d: &Vec3| d.dot(&first) < 0.0;
    let other = points.iter().filter(abreast).map(|q| q - middle).filter(across).min_by(nearest);
    // Beyond the last line there is none, or another part of the sheet.
    let own = first.norm();
    Some(other.map(|d| d.norm()).filter(|d| *d < UNEVEN * own).map_or(own, |d| d.max(own)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_told_from_grids() {
        let at = |k: i32, j: i32, step: f64| {
            let a = step * f64::from(k) / 300.0;
            let astray = 0.05 * (f64::from(k * 31 + j * 17) * 12.9898).sin();
            Vec3::new(300.0 * a.sin(), 15.0 * f64::from(j) + astray, 300.0 * a.cos())
        };
        let lines: Vec<Vec3> = (0..12).flat_map(|j| (0..400).map(move |k| at(k, j, 0.5))).collect();
        let found = distance_of_lines(&lines).expect("lines");
        assert!((found - 15.0).abs() < 0.5, "{found}");
        let grid: Vec<Vec3> = (0..12).flat_map(|j| (0..40).map(move |k| at(k, j, 5.0))).collect();
        assert_eq!(distance_of_lines(&grid), None);
    }
}
