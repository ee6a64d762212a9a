//! Axes in which given planes are graphs, and the split of a row of planes into pieces that have such axes.
//!
//! *Method* \[PW99, 4.1–4.3\]: the third axis is the main direction of the normals; the second the direction in which
//! they spread most, so that the slope u2 is as monotone as can be. Where the main direction leaves a plane too steep,
//! the axis of the smallest cap around the normals takes its place (a quadratic program in three variables).

use crate::geom::{Frame, Vec3};
use crate::num::quadratic_program::QuadraticProgram;
use crate::torse::dual::Plane;
use nalgebra::{Matrix3, SymmetricEigen};

/// Cosine of the largest angle between a normal and the third axis: 75°.
pub const STEEPEST: f64 = 0.258_819_045_102_520_76;

/// Axes for a set of unit normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalFrame {
    /// The axes; the origin is that of the world.
    pub frame: Frame,
    /// Smallest cosine between a normal and the third axis.
    pub min_cosine: f64,
}

/// Why there are no axes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// No normals, or one that is not finite or zero.
    #[error("normal {index} of {count} cannot be used: finite, non-zero normals are needed")]
    Normal {
        /// Its index.
        index: usize,
        /// Number of normals.
        count: usize,
    },
    /// No direction is nearer than 90° to all normals.
    #[error("normals turn too far for one axis (smallest cosine {min_cosine:.3}): split the data")]
    TooFar {
        /// Smallest cosine with the best axis found.
        min_cosine: f64,
    },
}

/// Axes in which all planes with these unit normals are graphs, steeper than [`STEEPEST`] only if no axis avoids it.
///
/// *Input*: normals oriented alike, so that neighbours have positive products.
///
/// # Errors
/// See [`FrameError`].
pub fn frame_of_normals(normals: &[Vec3]) -> Result<NormalFrame, FrameError> {
    let count = normals.len();
    let bad = normals.iter().position(|n| !(n.norm() > 0.0 && n.norm().is_finite()));
    if let Some(index) = if count == 0 { Some(0) } else { bad } {
        return Err(FrameError::Normal { index, count });
    }
    let scatter: Matrix3<f64> = normals.iter().map(|n| n * n.transpose()).sum();
    let sum: Vec3 = normals.iter().sum();
    let main = main_direction(&scatter);
    let main = if main.dot(&sum) < 0.0 { -main } else { main };
    let worst = |e: &Vec3| normals.iter().map(|n| e.dot(n) / n.norm()).fold(f64::INFINITY, f64::min);
    let mut axis = main;
    if worst(&axis) <= STEEPEST {
        match cap_axis(normals) {
            Some(e) if worst(&e) > worst(&axis) => axis = e,
            _ => {}
        }
    }
    let min_cosine = worst(&axis);
    if min_cosine <= 0.0 {
        return Err(FrameError::TooFar { min_cosine });
    }
    // Spread at right angles to the axis.
    let flat: Matrix3<f64> = normals.iter().map(|n| n - axis * n.dot(&axis)).map(|n| n * n.transpose()).sum();
    let spread = main_direction(&flat);
    let spread = spread - axis * spread.dot(&axis);
    // Normals that are all the same spread in no direction, and least of all along the axis.
    let y = if spread.norm() > 0.5 { spread.normalize() } else { axis.cross(&least(&axis)).normalize() };
    Ok(NormalFrame { frame: Frame { origin: Vec3::zeros(), x: y.cross(&axis), y, z: axis }, min_cosine })
}

/// The coordinate direction least along a vector.
fn least(v: &Vec3) -> Vec3 {
    let k = v.iamin();
    Vec3::ith(k, 1.0)
}

/// Eigenvector of the largest eigenvalue.
fn main_direction(m: &Matrix3<f64>) -> Vec3 {
    let e = SymmetricEigen::new(*m);
    let k = e.eigenvalues.imax();
    e.eigenvectors.column(k).into_owned().normalize()
}

/// Axis of the smallest cap around unit normals: the direction of the shortest `x` with `n·x ≥ 1` for all of them.
fn cap_axis(normals: &[Vec3]) -> Option<Vec3> {
    // More constraints than this are thinned: the cap of a dense row of normals hardly changes.
    const MOST_NORMALS: usize = 400;
    let stride = normals.len().div_ceil(MOST_NORMALS);
    let mut p = QuadraticProgram::new(3);
    for i in 0..3 {
        p.add_hessian(i, i, 1.0);
    }
    for n in normals.iter().step_by(stride.max(1)) {
        let n = n.normalize();
        p.at_least((0..3).map(|i| (i, n[i])), 1.0);
    }
    let x = p.active_set().ok()?.x;
    Some(Vec3::new(x[0], x[1], x[2]).normalize())
}

/// A run of planes that one surface of type (3), or at least (2), can follow.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneSegment {
    /// Planes of the row that belong to it; neighbouring segments share a plane.
    pub range: std::ops::Range<usize>,
    /// Axes in which they are graphs.
    pub frame: Frame,
    /// Whether the slope u2 increases strictly along the row, so that type (3) can be used.
    pub by_slope: bool,
}

/// Splits a row of planes (neighbours oriented alike) into as few runs as greed finds: each as long as its planes are
/// graphs over common axes and, where wanted, their slope is monotone. At inflections the slope turns, so there a
/// run of type (3) ends.
///
/// *Cost*: `n log n`.
///
/// # Errors
/// A plane without a normal. Fewer than two planes give no segment.
pub fn segments(planes: &[Plane], by_slope: bool) -> Result<Vec<PlaneSegment>, FrameError> {
    let normals: Vec<Vec3> = planes.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect();
    if let Some(index) = normals.iter().position(|n| !(n.norm() > 0.0 && n.norm().is_finite())) {
        return Err(FrameError::Normal { index, count: planes.len() });
    }
    let normals: Vec<Vec3> = normals.iter().map(Vec3::normalize).collect();
    let fits = |from: usize, to: usize| -> Option<PlaneSegment> {
        let axes = frame_of_normals(&normals[from..to]).ok()?;
        if axes.min_cosine <= STEEPEST && to - from > 2 {
            return None;
        }
        let turned = slope_frame(&normals[from..to], &axes.frame);
        if by_slope && turned.is_none() && to - from > 2 {
            return None;
        }
        let frame = turned.unwrap_or(axes.frame);
        Some(PlaneSegment { range: from..to, frame, by_slope: turned.is_some() })
    };
    let mut out = Vec::new();
    let mut from = 0;
    while from + 1 < planes.len() {
        // The longest run, by doubling and halving.
        let mut good = (from + 2).min(planes.len());
        let Some(mut best) = fits(from, good) else {
            from += 1;
            continue;
        };
        let mut step = 2;
        while step > 0 {
            let to = (good + step).min(planes.len());
            match fits(from, to) {
                Some(s) if to > good => {
                    (good, best) = (to, s);
                    step *= 2;
                }
                _ => step /= 2,
            }
        }
        out.push(best);
        from = good - 1;
    }
    Ok(out)
}

/// The axes turned about the third one so that the least increment of the slope u2 along the row is as large as can
/// be in angle; `None` if no turn makes all increments positive.
pub(crate) fn slope_frame(normals: &[Vec3], frame: &Frame) -> Option<Frame> {
    // Steps shorter than this share of the longest have no direction worth keeping.
    const STILL: f64 = 1e-9;
    let slopes: Vec<[f64; 2]> = normals
        .iter()
        .map(|n| {
            let l = frame.vector_to_local(n);
            [-l.x / l.z, -l.y / l.z]
        })
        .collect();
    let steps: Vec<[f64; 2]> = slopes.windows(2).map(|w| [w[1][0] - w[0][0], w[1][1] - w[0][1]]).collect();
    let length = |s: &[f64; 2]| s[0].hypot(s[1]);
    let longest = steps.iter().map(length).fold(0.0, f64::max);
    if longest.is_nan() || longest <= 0.0 || steps.iter().any(|s| length(s) <= STILL * longest) {
        return None;
    }
    let mut angles: Vec<f64> = steps.iter().map(|s| s[1].atan2(s[0])).collect();
    angles.sort_by(f64::total_cmp);
    // The largest gap between directions must exceed a half turn; the axis points opposite to its middle.
    let n = angles.len();
    let (mut gap, mut middle) = (0.0, 0.0);
    for i in 0..n {
        let next = if i + 1 < n { angles[i + 1] } else { angles[0] + std::f64::consts::TAU };
        if next - angles[i] > gap {
            (gap, middle) = (next - angles[i], 0.5 * (next + angles[i]));
        }
    }
    // A tenth of a degree of margin keeps increments away from zero.
    const MARGIN: f64 = 1.745e-3;
    if gap <= std::f64::consts::PI + MARGIN {
        return None;
    }
    let turn = middle + std::f64::consts::PI;
    let y = frame.x * turn.cos() + frame.y * turn.sin();
    Some(Frame { origin: frame.origin, x: y.cross(&frame.z), y, z: frame.z })
}
