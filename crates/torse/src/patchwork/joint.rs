//! Joints: where panels of different faces, or a panel that closes on itself, meet along borders of their faces.
//!
//! Seams within a face are known from its partition; joints are found by their places in space. Measured, not proven.

use super::panel::{Border, Coedge, Patchwork};
use crate::geom::{BBox, Vec3};

/// One side of a joint.
#[derive(Clone, Copy, Debug)]
pub struct JointSide<'a> {
    /// Index of the panel.
    pub panel: usize,
    /// Its run, a part of which lies along the joint.
    pub run: &'a Coedge,
}

/// A joint: two runs along borders of faces with a common stretch.
#[derive(Clone, Debug)]
pub struct Joint<'a> {
    /// Both sides.
    pub sides: [JointSide<'a>; 2],
    /// Parameters of pairs of places, at equal steps of length from one end of the common stretch to the other.
    pub pairs: Vec<[f64; 2]>,
    /// Length of the stretch, mm.
    pub length: f64,
}

/// Samples of a run.
const SAMPLES: usize = 96;
/// Cosine of the angle above which two runs are parallel.
const PARALLEL: f64 = 0.9;
/// Stretches shorter than this multiple of the reach are corners in which runs touch.
const LEAST_STRETCH: f64 = 8.0;
/// Halvings that refine a foot on a run: to 1e-6 of the distance of samples.
const REFINEMENTS: usize = 20;

/// A run as a polyline.
struct Course<'a> {
    side: JointSide<'a>,
    points: Vec<Vec3>,
    bbox: BBox,
}

impl<'a> Course<'a> {
    fn new(panel: usize, run: &'a Coedge, reach: f64) -> Self {
        let points: Vec<Vec3> = (0..=SAMPLES).map(|k| point(run, k as f64 / SAMPLES as f64)).collect();
        let mut bbox = BBox::empty();
        for p in &points {
            bbox.include(&p.add_scalar(reach));
            bbox.include(&p.add_scalar(-reach));
        }
        Self { side: JointSide { panel, run }, points, bbox }
    }

    fn near(&self, other: &Self) -> bool {
        (0..3).all(|d| self.bbox.min[d] <= other.bbox.max[d] && other.bbox.min[d] <= self.bbox.max[d])
    }

    fn direction(&self, k: usize) -> Vec3 {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(SAMPLES));
        (self.points[b] - self.points[a]).normalize()
    }

    /// Parameter of the place nearest to a point, its distance and the direction there.
    fn foot(&self, x: &Vec3) -> (f64, f64, Vec3) {
        let k = (0..=SAMPLES)
            .min_by(|&a, &b| (self.points[a] - x).norm_squared().total_cmp(&(self.points[b] - x).norm_squared()))
            .unwrap_or(0);
        let step = 1.0 / SAMPLES as f64;
        let (mut lo, mut hi) = ((k as f64 - 1.0).max(0.0) * step, (k as f64 + 1.0).min(SAMPLES as f64) * step);
        let far = |s: f64| (point(self.side.run, s) - x).norm_squared();
        for _ in 0..REFINEMENTS {
            let (a, b) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
            if far(a) < far(b) {
                hi = b;
            } else {
                lo = a;
            }
        }
        let s = 0.5 * (lo + hi);
        (s, far(s).sqrt(), self.direction(k))
    }
}

fn point(run: &Coedge, s: f64) -> Vec3 {
    Vec3::from(run.edge.point(s))
}

/// All joints: pairs of runs along borders of faces that lie within `reach` (mm) of each other over a stretch; `spacing`
/// (mm) says about how far apart the places on it are.
pub fn joints(patchwork: &Patchwork, reach: f64, spacing: f64) -> Vec<Joint<'_>> {
    let mut all: Vec<Course> = Vec::new();
    for (k, panel) in patchwork.panels.iter().enumerate() {
        let runs = panel.loops().iter().flatten();
        let on_borders = runs.filter(|r| matches!(r.border, Border::Trim { .. }) && !r.is_point());
        all.extend(on_borders.map(|run| Course::new(k, run, reach)));
    }
    let mut out = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for b in all[i + 1..].iter().filter(|b| a.near(b)) {
            out.extend(joint(a, b, reach, spacing));
        }
    }
    out
}

/// The longest common stretch of two runs.
fn joint<'a>(a: &Course<'a>, b: &Course<'a>, reach: f64, spacing: f64) -> Option<Joint<'a>> {
    let together: Vec<bool> = (0..=SAMPLES)
        .map(|k| {
            let (_, far, direction) = b.foot(&a.points[k]);
            far <= reach && direction.dot(&a.direction(k)).abs() > PARALLEL
        })
        .collect();
    let (mut best, mut from): (Option<[usize; 2]>, usize) = (None, 0);
    for k in 0..=SAMPLES + 1 {
        if k > SAMPLES || !together[k] {
            if best.is_none_or(|[f, t]| k.saturating_sub(from) > t + 1 - f) && k > from {
                best = Some([from, k - 1]);
            }
            from = k + 1;
        }
    }
    let [from, to] = best.filter(|[f, t]| t > f)?;
    let mut at = vec![0.0];
    for w in a.points[from..=to].windows(2) {
        at.push(at[at.len() - 1] + (w[1] - w[0]).norm());
    }
    let length = at[at.len() - 1];
    if length < LEAST_STRETCH * reach {
        return None;
    }
    let count = (length / spacing.max(f64::MIN_POSITIVE)).round().clamp(1.0, 9.0) as usize;
    let places = (1..=count).map(|k| {
        let wanted = length * k as f64 / (count + 1) as f64;
        let i = at.partition_point(|&l| l <= wanted).clamp(1, at.len() - 1);
        let s = (from + i - 1) as f64 + (wanted - at[i - 1]) / (at[i] - at[i - 1]).max(f64::MIN_POSITIVE);
        let s = s / SAMPLES as f64;
        [s, b.foot(&point(a.side.run, s)).0]
    });
    Some(Joint { sides: [a.side, b.side], pairs: places.collect(), length })
}
