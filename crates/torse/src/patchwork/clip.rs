//! Rulings of a panel between its borders: which stretches of `t = const` lie in the trimmed region. Wanted by
//! flat patterns and by pictures alike.

use super::panel::{Coedge, Panel};
use crate::geom::Vec3;
use crate::spline::surface::Surface;

/// The trimming curves of a panel, sampled for questions about rulings.
pub(crate) struct ClippedRulings<'a> {
    patch: &'a Surface,
    sides: Vec<Step<'a>>,
    range: (f64, f64),
}

/// A short step of a trimming curve.
struct Step<'a> {
    run: &'a Coedge,
    s: (f64, f64),
    t: (f64, f64),
}

/// Steps per span of a trimming curve, and per run at least.
const STEPS: (usize, usize) = (8, 32);

/// Place (t, r) on a trimming curve; at its ends exactly those shared with the neighbouring runs.
pub(crate) fn trim_place(run: &Coedge, s: f64) -> [f64; 2] {
    let c = &run.trim.control;
    if s <= 0.0 {
        c[0]
    } else if s >= 1.0 {
        c[c.len() - 1]
    } else {
        run.trim.point(s)
    }
}

impl<'a> ClippedRulings<'a> {
    /// Samples the borders of a panel.
    pub fn new(panel: &'a Panel) -> Self {
        let mut sides = Vec::new();
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for run in panel.loops().iter().flatten() {
            let breaks = run.trim.knots.breaks();
            let parts = STEPS.0.max(STEPS.1.div_ceil(breaks.len() - 1));
            for w in breaks.windows(2) {
                for k in 0..parts {
                    let at = |k: usize| if k == parts { w[1] } else { w[0] + (w[1] - w[0]) * k as f64 / parts as f64 };
                    let s = (at(k), at(k + 1));
                    let t = (trim_place(run, s.0)[0], trim_place(run, s.1)[0]);
                    range = (range.0.min(t.0), range.1.max(t.0));
                    sides.push(Step { run, s, t });
                }
            }
        }
        Self { patch: &panel.strip.patch, sides, range }
    }

    /// Range of rulings that meet the region.
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// Intervals of r in which the ruling lies in the region, by the even-odd rule. Ends lie on the trimming curves
    /// to rounding.
    pub fn at(&self, t: f64) -> Vec<(f64, f64)> {
        let mut hits: Vec<f64> = Vec::new();
        for step in self.sides.iter().filter(|x| (x.t.0 < t) != (x.t.1 < t)) {
            let (mut a, mut b) = step.s;
            for _ in 0..50 {
                let m = 0.5 * (a + b);
                if (trim_place(step.run, m)[0] < t) == (step.t.0 < t) {
                    a = m;
                } else {
                    b = m;
                }
            }
            hits.push(trim_place(step.run, 0.5 * (a + b))[1]);
        }
        hits.sort_by(f64::total_cmp);
        hits.chunks_exact(2).map(|h| (h[0], h[1])).collect()
    }

    /// Rulings at equal distances of about `spacing` (mm), measured across the rulings in the middle of the patch;
    /// at least 3 and at most 60, none at the ends of the range.
    pub fn spaced(&self, spacing: f64) -> Vec<f64> {
        const NODES: usize = 200;
        let (t0, t1) = self.range;
        let node = |k: usize| t0 + (t1 - t0) * k as f64 / NODES as f64;
        let mut at = vec![0.0];
        let mut before = self.patch.point(node(0), 0.5);
        for k in 1..=NODES {
            let here = self.patch.point(node(k), 0.5);
            let ruling: Vec3 = self.patch.point(node(k), 1.0) - self.patch.point(node(k), 0.0);
            let d = here - before;
            let across = d.cross(&ruling).norm() / ruling.norm().max(f64::MIN_POSITIVE);
            at.push(at[k - 1] + across);
            before = here;
        }
        let total = at[NODES];
        let count = (total / spacing.max(f64::MIN_POSITIVE)).round().clamp(3.0, 60.0) as usize;
        (0..count)
            .map(|k| {
                let l = total * (k as f64 + 0.5) / count as f64;
                let i = at.partition_point(|&a| a <= l).clamp(1, NODES);
                let step = at[i] - at[i - 1];
                let x = if step > 0.0 { (l - at[i - 1]) / step } else { 0.0 };
                node(i - 1) + (node(i) - node(i - 1)) * x
            })
            .collect()
    }
}
