//! The plane nearest to samples in the sense of the largest distance.

use super::samples::{error, Fit, Sample, MARGIN};
use crate::geom::{Frame, Vec3};
use crate::num::least_squares::{BandMatrix, Rows};
use crate::num::minimax;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::torse::form::{PanelKind, PrimalTorse, Torse};
use nalgebra as na;

/// The plane with the smallest largest distance to the samples, as a primal torse whose rulings run along the
/// direction of the second largest extent.
///
/// *Method*: minimax regression over a support that grows by the worst samples until no sample is farther than the
/// support's own; the frame turns with the plane so that heights become distances.
/// *Input*: at least one sample; normals are not used. Collinear or coincident samples get some plane through them.
/// *Guarantee*: the error is the true minimum up to about 0.1 % and rounding. `None` without samples or with
/// coordinates that are not finite.
pub fn plane(samples: &[Sample]) -> Option<Fit> {
    let axes = principal_frame(samples)?;
    let extent = samples.iter().fold(0.0_f64, |m, s| m.max((s.x - axes.origin).amax()));
    let mut frame = axes;
    if extent > 0.0 && samples.len() > 3 {
        // The second round measures along the normal that the first one found.
        for _ in 0..2 {
            let Some(c) = best_heights(samples, &frame, extent) else { break };
            frame = tilted(&frame, c);
        }
    }
    as_torse(samples, frame, extent)
}

/// Mean point and principal axes, the direction of least spread last. `None` for no samples or numbers not finite.
pub(crate) fn principal_frame(samples: &[Sample]) -> Option<Frame> {
    if samples.is_empty() {
        return None;
    }
    let origin = samples.iter().map(|s| s.x).sum::<Vec3>() / samples.len() as f64;
    let mut m = na::Matrix3::zeros();
    for s in samples {
        let d = s.x - origin;
        m += d * d.transpose();
    }
    if !m.iter().all(|v| v.is_finite()) {
        return None;
    }
    let eigen = m.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let x: Vec3 = eigen.eigenvectors.column(order[0]).normalize();
    let mut z: Vec3 = eigen.eigenvectors.column(order[2]).normalize();
    let mean: Vec3 = samples.iter().map(|s| s.n).sum();
    if z.dot(&mean) < 0.0 {
        z = -z;
    }
    Some(Frame { origin, x, y: z.cross(&x), z })
}

/// Coefficients of the best `z = c₀ + c₁ x + c₂ y` in the frame; c₀ in mm.
fn best_heights(samples: &[Sample], frame: &Frame, extent: f64) -> Option<[f64; 3]> {
    // Samples added per round and rounds; the support of the optimum has four samples.
    const ADDED: usize = 4;
    const ROUNDS: usize = 12;
    // Accepted excess of a sample outside the support over the optimum of the support.
    const EXCESS: f64 = 1.001;
    // Gap of the linear problem, as a share of the largest distance: well below that excess.
    const GAP: f64 = 0.3 * (EXCESS - 1.0);
    // Rounding of a height; the extent is 1.
    const ROUNDING: f64 = 1e-15;
    // Weight of a step's own size, extent 1: keeps collinear samples solvable, and moves others by less than is seen.
    const COLLINEAR: f64 = 1e-9;
    let local: Vec<Vec3> = samples.iter().map(|s| frame.to_local(&s.x) / extent).collect();
    // Start: the samples extreme in eight directions of the plane and in height.
    let mut support = Vec::new();
    for k in 0..8 {
        let (sin, cos) = (k as f64 * std::f64::consts::FRAC_PI_4).sin_cos();
        support.extend(extreme(&local, |q| cos * q.x + sin * q.y));
    }
    support.extend(extreme(&local, |q| q.z));
    support.extend(extreme(&local, |q| -q.z));
    support.sort_unstable();
    support.dedup();
    let mut quadratic = BandMatrix::zeros(3, 3);
    for i in 0..3 {
        quadratic.add_diagonal(i, COLLINEAR);
    }
    let mut work = minimax::Workspace::new();
    let (mut step, mut rows) = (Vec::new(), Rows::new(3, 3));
    let mut c = [0.0; 3];
    for _ in 0..ROUNDS {
        rows.clear();
        let mut residual = Vec::with_capacity(support.len());
        for &i in &support {
            let q = &local[i];
            rows.push(0).1.copy_from_slice(&[1.0, q.x, q.y]);
            residual.push(c[0] + c[1] * q.x + c[2] * q.y - q.z);
        }
        let best = minimax::step(&rows, &residual, (&quadratic, &[0.0; 3]), GAP, &mut work, &mut step)?;
        for (a, d) in c.iter_mut().zip(&step) {
            *a += d;
        }
        let mut beyond: Vec<(f64, usize)> = local
            .iter()
            .enumerate()
            .map(|(i, q)| ((c[0] + c[1] * q.x + c[2] * q.y - q.z).abs(), i))
            .filter(|(r, _)| *r > EXCESS * best + ROUNDING)
            .collect();
        if beyond.is_empty() {
            break;
        }
        beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
        support.extend(beyond.iter().take(ADDED).map(|b| b.1));
        support.sort_unstable();
        support.dedup();
    }
    Some([c[0] * extent, c[1], c[2]])
}

/// Index of the point with the largest value.
fn extreme(points: &[Vec3], value: impl Fn(&Vec3) -> f64) -> Option<usize> {
    (0..points.len()).max_by(|&a, &b| value(&points[a]).total_cmp(&value(&points[b])))
}

/// The frame whose xy-plane is `z = c₀ + c₁ x + c₂ y` of the given one.
fn tilted(frame: &Frame, c: [f64; 3]) -> Frame {
    let z = frame.vector_to_world(&Vec3::new(-c[1], -c[2], 1.0).normalize());
    let x = frame.vector_to_world(&Vec3::new(1.0, 0.0, c[1]).normalize());
    Frame { origin: frame.origin + frame.z * c[0], x, y: z.cross(&x), z }
}

/// The xy-plane of the frame as a primal torse with one span.
fn as_torse(samples: &[Sample], frame: Frame, extent: f64) -> Option<Fit> {
    let (lo, hi) =
        samples.iter().map(|s| frame.to_local(&s.x).x).fold((0.0_f64, 0.0_f64), |(lo, hi), x| (lo.min(x), hi.max(x)));
    // A single point still gets a domain of positive length.
    let margin = if hi > lo { MARGIN * (hi - lo) } else { extent.max(1.0) };
    let knots = Knots::uniform(3, 1, lo - margin, hi + margin).ok()?;
    let profile = Curve::new(3, knots.values().to_vec(), vec![[0.0; 2]; 4]).ok()?;
    let torse = Torse::Primal(PrimalTorse::new(frame, profile, 0.0));
    let (error, worst) = error(&torse, samples)?;
    Some(Fit { torse, kind: PanelKind::Plane, error, worst })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bump(x: f64, y: f64) -> Sample {
        // 1 mm of sagitta over a 100 x 60 mm sheet, tilted.
        let z = 0.2 * x - 0.1 * y - 4e-4 * x * x;
        Sample { x: Vec3::new(x, y, z), n: Vec3::z(), weight: 1.0 }
    }

    #[test]
    fn error_is_half_the_thickness_of_the_slab() {
        let mut samples = Vec::new();
        for i in 0..=50 {
            for j in 0..=30 {
                samples.push(bump(-50.0 + 2.0 * i as f64, -30.0 + 2.0 * j as f64));
            }
        }
        let fit = plane(&samples).expect("a plane");
        let cos = 1.0 / (1.0_f64 + 0.04 + 0.01).sqrt();
        assert!((fit.error - 0.5 * cos).abs() < 2e-3 * fit.error, "{}", fit.error);
    }

    #[test]
    fn degenerate_samples_end_quietly() {
        assert!(plane(&[]).is_none());
        let one = bump(1.0, 2.0);
        assert!(plane(&[one]).expect("plane").error < 1e-12);
        let line: Vec<Sample> = (0..9).map(|i| Sample { x: Vec3::new(1.0, 2.0, 3.0) * i as f64, ..one }).collect();
        assert!(plane(&line).expect("plane").error < 1e-9);
        let nan = Sample { x: Vec3::new(f64::NAN, 0.0, 0.0), ..one };
        assert!(plane(&[one, nan]).is_none());
    }
}
