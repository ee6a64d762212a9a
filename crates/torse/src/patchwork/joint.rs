//! Joints: where panels of different faces, or a panel that closes on itself, meet along borders of their faces.
//!
//! Seams within a face are known from its partition; joints are found by their places in space. Measured, not proven.

use super::panel::{Border, Coedge, Patchwork};
use crate::brep::face::Face;
use crate::geom::{BBox, Vec3};
use crate::num::hash::{HashMap, HashSet};
use crate::num::parallel;

/// One side of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointSide<'a> {
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
}

/// Samples of a run.
const SAMPLES: usize = 96;
/// Cosine of the angle above which two runs are parallel.
const PARALLEL: f64 = 0.9;
/// Stretches shorter than this multiple of the reach are corners in which runs touch.
const LEAST_STRETCH: f64 = 8.0;
/// Share of the shorter run over which two runs of one face must be together to be where it closes.
const LEAST_OF_ONE_FACE: f64 = 0.5;
/// Steps that refine a foot on a run, each to two thirds: to 1e-6 of the distance of samples.
const REFINEMENTS: usize = 34;

/// A run as a polyline.
struct CoedgePolyline<'a> {
    side: JointSide<'a>,
    /// Number of its face, of the edge within the face, and of the edge in the file (0 if unknown).
    edge: (usize, u32, u64),
    points: Vec<Vec3>,
    /// Longest way between points that follow each other, mm.
    step: f64,
    bbox: BBox,
}

impl<'a> CoedgePolyline<'a> {
    fn new(panel: usize, run: &'a Coedge, edge: (usize, u32, u64), reach: f64) -> Self {
        let points: Vec<Vec3> = (0..=SAMPLES).map(|k| point(run, k as f64 / SAMPLES as f64)).collect();
        let mut bbox = BBox::empty();
        for p in &points {
            bbox.include(&p.add_scalar(reach));
            bbox.include(&p.add_scalar(-reach));
        }
        let step = points.windows(2).map(|w| (w[1] - w[0]).norm()).fold(0.0, f64::max);
        Self { side: JointSide { panel, run }, edge, points, step, bbox }
    }

    fn near(&self, other: &Self) -> bool {
        (0..3).all(|d| self.bbox.min[d] <= other.bbox.max[d] && other.bbox.min[d] <= self.bbox.max[d])
    }

    fn direction(&self, k: usize) -> Vec3 {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(SAMPLES));
        (self.points[b] - self.points[a]).normalize()
    }

    /// Length of its chords, mm.
    fn length(&self) -> f64 {
        self.points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
    }

    /// Number of the sample nearest to a point.
    fn nearest(&self, x: &Vec3) -> usize {
        let far = |k: usize| (self.points[k] - x).norm_squared();
        (0..=SAMPLES).min_by(|&a, &b| far(a).total_cmp(&far(b))).unwrap_or(0)
    }

    /// Parameter of the place nearest to a point, its distance and the direction there.
    fn foot(&self, x: &Vec3) -> (f64, f64, Vec3) {
        let k = self.nearest(x);
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

/// Parameter of the place of a run that is nearest to a point, and its distance, mm.
pub(crate) fn foot(run: &Coedge, x: &Vec3) -> (f64, f64) {
    let (s, far, _) = CoedgePolyline::new(0, run, (0, 0, 0), 0.0).foot(x);
    (s, far)
}

fn point(run: &Coedge, s: f64) -> Vec3 {
    Vec3::from(run.edge.point(s))
}

/// All joints: pairs of runs along borders of faces that lie within `reach` (mm) of each other over a stretch; `spacing`
/// (mm) says about how far apart the places on it are. Runs along an edge that the file gives to two faces are joined to
/// each other only, however near other borders are, as both sides of a thin strip; other runs go by their places alone.
pub fn joints(patchwork: &Patchwork, reach: f64, spacing: f64) -> Vec<Joint<'_>> {
    let mut runs: Vec<(usize, &Coedge, (usize, u32, u64))> = Vec::new();
    for (k, panel) in patchwork.panels.iter().enumerate() {
        let Some(face) = panel.face() else { continue };
        for run in panel.loops().iter().flatten().filter(|r| !r.is_point()) {
            if let Border::Trim { edge } = run.border {
                runs.push((k, run, (face, edge, entity(&patchwork.faces[face], edge))));
            }
        }
    }
    let all: Vec<CoedgePolyline> = parallel::map(runs, |(k, run, edge)| CoedgePolyline::new(k, run, edge, reach));
    let mut uses: HashMap<u64, HashSet<(usize, u32)>> = HashMap::default();
    for (face, label, entity) in all.iter().map(|c| c.edge).filter(|e| e.2 != 0) {
        uses.entry(entity).or_default().insert((face, label));
    }
    let shared = |c: &CoedgePolyline| uses.get(&c.edge.2).is_some_and(|u| u.len() > 1);
    let may_join = |a: &CoedgePolyline, b: &CoedgePolyline| {
        let by_number = shared(a) || shared(b);
        (!by_number || a.edge.2 == b.edge.2) && a.near(b)
    };
    let with_later = |i: usize| -> Vec<Joint> {
        let later = all[i + 1..].iter().filter(|b| may_join(&all[i], b));
        later.filter_map(|b| joint(&all[i], b, reach, spacing)).collect()
    };
    parallel::map(0..all.len(), with_later).into_iter().flatten().collect()
}

/// Number in the file of an edge of a face; 0 if it has none.
fn entity(face: &Face, label: u32) -> u64 {
    let edges = face.boundary.iter().flat_map(|b| &b.loops).flatten();
    edges.filter(|e| e.label == label).map(|e| e.entity).next().unwrap_or(0)
}

/// The longest common stretch of two runs.
fn joint<'a>(a: &CoedgePolyline<'a>, b: &CoedgePolyline<'a>, reach: f64, spacing: f64) -> Option<Joint<'a>> {
    let together: Vec<bool> = (0..=SAMPLES)
        .map(|k| {
            // A foot lies within half a step of the nearest sample.
            let x = &a.points[k];
            if (b.points[b.nearest(x)] - x).norm() > reach + b.step {
                return false;
            }
            let (_, far, direction) = b.foot(x);
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
    // Borders of one face that only touch, as two holes do, are no seam of it.
    let is_touch = a.edge.0 == b.edge.0 && length < LEAST_OF_ONE_FACE * a.length().min(b.length());
    if length < LEAST_STRETCH * reach || is_touch {
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
    Some(Joint { sides: [a.side, b.side], pairs: places.collect() })
}
