//! Where a primal fit starts: the mean normal, ruling directions in its plane, and a cone for each of them
//! (mixed-curvature specification, C1.5).

use super::descent::{Descent, Family};
use super::plane::principal_frame;
use super::profile::{ProfileFamily, Slopes};
use super::samples::{Sample, MARGIN};
use crate::control::Control;
use crate::geom::{Frame, Vec3};

/// An extent along the profile below this share of all extents leaves no profile.
const NO_PROFILE: f64 = 1e-6;

/// A ruling direction with the best cone for it.
pub(crate) struct Candidate {
    /// Local coordinates: y along the middle ruling, z along the mean normal.
    pub frame: Frame,
    /// Extent of the samples in x, mm; the family's unit of length.
    pub unit: f64,
    /// Cones in these coordinates.
    pub family: ProfileFamily,
    /// The best of them.
    pub x: Vec<f64>,
    /// Root mean square of its distances, mm.
    pub cone: f64,
    /// The same for a general torse after a few steps, mm.
    pub torse: f64,
}

/// A direction that makes a positive product with as many normals as possible: their mean, turned towards the farthest
/// ones where these lie too far off. `None` if no direction has all normals within about 70°.
pub(crate) fn mean_direction(samples: &[Sample]) -> Option<Vec3> {
    // Least cosine with a normal, and steps towards the farthest normals, each shorter than the last: where there is no such
    // direction they would go on.
    const LEAST_COSINE: f64 = 0.3;
    const STEPS: usize = 20;
    let normals: Vec<(Vec3, f64)> =
        samples.iter().filter(|s| s.n.norm_squared() > 0.25).map(|s| (s.n, s.weight)).collect();
    if normals.is_empty() {
        return principal_frame(samples).map(|f| f.z);
    }
    let mut up = normals.iter().map(|(n, w)| n * *w).sum::<Vec3>().try_normalize(0.0)?;
    for k in 0..=STEPS {
        let far = normals.iter().map(|(n, _)| n).min_by(|a, b| a.dot(&up).total_cmp(&b.dot(&up)))?;
        if far.dot(&up) >= LEAST_COSINE {
            return Some(up);
        }
        up = (up + far * (1.0 / (2.0 + k as f64))).try_normalize(0.0)?;
    }
    None
}

/// How many directions are looked at, and how many spans the splines have in each.
#[derive(Clone, Copy)]
pub(crate) struct Counts {
    pub directions: usize,
    pub profile_spans: usize,
    pub ruling_spans: usize,
}

/// All directions, or the first good ones if `control` ends the search, each with its best cone and the promise of a general torse; in no particular order. The cones are
/// regular at the samples `few`.
pub(crate) fn candidates(
    samples: &[Sample],
    few: &[usize],
    up: Vec3,
    Counts { directions, profile_spans, ruling_spans }: Counts,
    control: &Control,
) -> Vec<Candidate> {
    // Samples and steps that suffice to rank directions.
    const RANKING: usize = 100;
    const CONE_STEPS: usize = 3;
    const TORSE_STEPS: usize = 3;
    let seed = if up.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
    let e1 = (seed - up * seed.dot(&up)).normalize();
    let e2 = up.cross(&e1);
    let active: Vec<usize> = few.iter().step_by(few.len().div_ceil(RANKING).max(1)).copied().collect();
    let mut out = Vec::new();
    for k in 0..directions {
        if control.stopped() && !out.is_empty() {
            break;
        }
        let (sin, cos) = (std::f64::consts::PI * k as f64 / directions as f64).sin_cos();
        let y = e1 * cos + e2 * sin;
        let axes = Frame { origin: Vec3::zeros(), x: y.cross(&up), y, z: up };
        let Some(mut c) = placed(samples, axes, profile_spans) else { continue };
        c.family.control = control.clone();
        let start = vec![0.0; c.family.unknowns()];
        let Some((x, rms)) = improved(&mut c.family, start, &active, CONE_STEPS) else { continue };
        (c.x, c.cone) = (x, rms * c.unit);
        // Feet of the samples that did not take part.
        let mut unused = Vec::new();
        if !c.family.residuals(&c.x, few, &mut unused) {
            continue;
        }
        c.family.adopt(few);
        c.torse = c.cone;
        let coarse = c.family.breaks.iter().step_by(profile_spans / ruling_spans).copied().collect();
        if let Some((mut free, x)) = c.family.changed(&c.x, c.family.breaks.clone(), Slopes::Spline(coarse)) {
            if let Some((_, rms)) = improved(&mut free, x, &active, TORSE_STEPS) {
                c.torse = rms * c.unit;
            }
        }
        out.push(c);
    }
    out
}

/// Coefficients after some Gauss–Newton steps, and the root mean square of the distances.
fn improved(family: &mut ProfileFamily, x: Vec<f64>, active: &[usize], steps: usize) -> Option<(Vec<f64>, f64)> {
    let mut d = Descent::new(family, x, active.to_vec())?;
    for _ in 0..steps {
        if !d.gauss_newton() {
            break;
        }
    }
    let rms = d.rms();
    Some((d.x, rms))
}

/// Local coordinates with unit extent in x, and the family of cones there.
fn placed(samples: &[Sample], axes: Frame, profile_spans: usize) -> Option<Candidate> {
    let local = samples.iter().map(|s| axes.vector_to_local(&s.x));
    let (lo, hi) = local
        .fold((Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)), |(lo, hi), q| (lo.inf(&q), hi.sup(&q)));
    let unit = hi.x - lo.x;
    if !(unit > NO_PROFILE * (hi - lo).norm() && unit.is_finite()) {
        return None;
    }
    let frame = Frame { origin: axes.vector_to_world(&((lo + hi) * 0.5)), ..axes };
    let points: Vec<Vec3> = samples.iter().map(|s| frame.to_local(&s.x) / unit).collect();
    let feet = points.iter().map(|q| q.x).collect();
    let family = ProfileFamily::new(points, feet, spans(-0.5, 0.5, profile_spans), Slopes::Affine)?;
    Some(Candidate { frame, unit, family, x: Vec::new(), cone: f64::INFINITY, torse: f64::INFINITY })
}

/// Breaks of `count` equal spans that reach beyond the feet's range.
pub(crate) fn spans(a: f64, b: f64, count: usize) -> Vec<f64> {
    let (lo, hi) = (a - MARGIN * (b - a), b + MARGIN * (b - a));
    (0..=count).map(|i| lo + (hi - lo) * i as f64 / count as f64).collect()
}
