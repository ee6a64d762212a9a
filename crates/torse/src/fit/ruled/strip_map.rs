//! One of several ruled strips as a patch, with the map to its face \[W15, 2C\].

use super::chart::Chart;
use super::solve::{foot, point, Strips};
use super::tensor_fit::{tensor_fit, Target};
use crate::geom::Vec3;
use crate::patchwork::foot_map::FootMap;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::spline::SplineError;

/// A patch of degree 1 along its rulings, and the map from its parameters to those of the face.
#[derive(Clone, Debug)]
pub struct RuledStrip {
    /// The patch; v from 0 to 1 along rulings.
    pub patch: Surface,
    /// The map.
    pub map: FootMap,
}

/// Spans of the map against those of the strip, and along rulings: fewest first.
const SPANS: [(usize, usize); 3] = [(1, 2), (2, 4), (4, 6)];
/// Samples per span.
const SAMPLES: usize = 4;
/// Weight of places far beyond the face against feet on it and near.
const BEYOND: f64 = 1e-3;
/// How far beyond the face feet count, share of its parameters: there it goes on as its second derivatives say.
const NEAR: f64 = 0.08;
/// Steps towards a level line.
const STEPS: usize = 4;
/// Weight of fairness.
const FAIR: f64 = 1e-8;

/// Strip `k` over the whole domain of its curves, with a map that is `near` (mm) the feet at samples if that can be had;
/// `None` where there is no map.
pub fn strip(
    surface: &Surface,
    chart: &Chart,
    (strips, k): (&Strips, usize),
    inside: &dyn Fn([f64; 2]) -> bool,
    near: f64,
) -> Option<RuledStrip> {
    let mut best: Option<(FootMap, f64)> = None;
    for spans in SPANS {
        let found = map(surface, chart, (strips, k), inside, spans)?;
        let done = found.1 <= near;
        if best.as_ref().is_none_or(|b| found.1 < b.1) {
            best = Some(found);
        }
        if done {
            break;
        }
    }
    let mut points = Vec::new();
    for (a, b) in strips.curves[k].control.iter().zip(&strips.curves[k + 1].control) {
        points.extend([Vec3::from(*a), Vec3::from(*b)]);
    }
    let across = Knots::clamped(1, &[0.0, 1.0]).ok()?;
    let patch = Surface::new(strips.curves[k].knots.clone(), across, &points, None).ok()?;
    Some(RuledStrip { patch, map: best?.0 })
}

/// A map with so many times the spans of the strip and so many spans along rulings, and how far (mm) it is from feet.
fn map(
    surface: &Surface,
    chart: &Chart,
    (strips, k): (&Strips, usize),
    inside: &dyn Fn([f64; 2]) -> bool,
    (times, spans_t): (usize, usize),
) -> Option<(FootMap, f64)> {
    let knots = &strips.curves[k].knots;
    let (lo, hi) = knots.domain();
    let spans_s = times * (knots.breaks().len() - 1);
    let (knots_s, knots_t) = (Knots::uniform(3, spans_s, lo, hi).ok()?, Knots::uniform(3, spans_t, 0.0, 1.0).ok()?);
    let (count_s, count_t) = (SAMPLES * spans_s, SAMPLES * spans_t);
    let mut targets = Vec::with_capacity((count_s + 1) * (count_t + 1));
    let ((u0, u1), (v0, v1)) = surface.domain();
    let beside = |x: f64, a: f64, b: f64| ((a - x).max(x - b).max(0.0)) / (b - a);
    let foot_at = |s: f64, t: f64| {
        let b = strips.levels[k] + t * (strips.levels[k + 1] - strips.levels[k]);
        let guess = chart.places.jet(s, b).p;
        let found = foot(surface, &point(&strips.curves, k, s, t), guess);
        let far = |p: [f64; 2]| beside(p[0], u0, u1).max(beside(p[1], v0, v1));
        let moved = ((found[0] - guess[0]) / (u1 - u0)).hypot((found[1] - guess[1]) / (v1 - v0));
        // A foot far from where it is expected is that of another part.
        if far(found) <= NEAR && moved <= NEAR {
            (found, 1.0)
        } else {
            (guess, BEYOND * BEYOND)
        }
    };
    let mut counted = Vec::new();
    for i in 0..=count_s {
        let s = lo + (hi - lo) * i as f64 / count_s as f64;
        // What the feet of a boundary curve between strips are off its level line is taken off all feet beside it.
        let off = [0, 1].map(|e: usize| {
            let shared = k + e > 0 && k + e + 1 < strips.levels.len();
            if shared {
                chart.along.value(foot_at(s, e as f64).0) - strips.levels[k + e]
            } else {
                0.0
            }
        });
        for j in 0..=count_t {
            let t = j as f64 / count_t as f64;
            let (found, weight) = foot_at(s, t);
            let wanted = chart.along.value(found) - off[0] * (1.0 - t) - off[1] * t;
            let b = strips.levels[k] + t * (strips.levels[k + 1] - strips.levels[k]);
            let value = to_level(chart, found, chart.places.jet(s, b).dt, wanted);
            counted.push(inside(value) && weight >= 1.0);
            targets.push(Target { at: [s, t], value, weight });
        }
    }
    let control = tensor_fit([&knots_s, &knots_t], &targets, FAIR)?;
    let map = FootMap { knots_s, knots_t, control };
    let off = targets.iter().zip(&counted).filter(|t| *t.1).map(|(t, _)| {
        let p = map.jet(t.at[0], t.at[1]).p;
        let j = surface.extended_jet(p[0], p[1]);
        (j.du * (p[0] - t.value[0]) + j.dv * (p[1] - t.value[1])).norm()
    });
    let off = off.fold(0.0, f64::max);
    Some((map, off))
}

/// The place on a level line of the chart that lies in a direction from another.
fn to_level(chart: &Chart, from: [f64; 2], direction: [f64; 2], wanted: f64) -> [f64; 2] {
    let mut at = from;
    for _ in 0..STEPS {
        let [value, x, y] = chart.along.jet(at[0], at[1]);
        let step = (wanted - value) / (x * direction[0] + y * direction[1]);
        if !step.is_finite() {
            return from;
        }
        at = [at[0] + step * direction[0], at[1] + step * direction[1]];
    }
    at
}

impl RuledStrip {
    /// The part between two rulings.
    ///
    /// # Errors
    /// An interval that is not within the domain.
    pub fn restricted(&self, a: f64, b: f64) -> Result<Self, SplineError> {
        let row = self.patch.row();
        let rails = (0..row)
            .map(|j| {
                let control = self.patch.control.iter().skip(j).step_by(row).copied().collect();
                Curve::<4> { knots: self.patch.knots_u.clone(), control }.restricted(a, b)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let columns = self.map.knots_t.control_count();
        let lines = (0..columns)
            .map(|j| {
                let control = self.map.control.iter().skip(j).step_by(columns).copied().collect();
                Curve::<2> { knots: self.map.knots_s.clone(), control }.restricted(a, b)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let knots_u = rails[0].knots.clone();
        let count = knots_u.control_count();
        // Weights of 1 stay so to the last bit.
        let whole = |c: [f64; 4]| if self.patch.rational { c } else { [c[0], c[1], c[2], 1.0] };
        let control = (0..count).flat_map(|i| rails.iter().map(move |r| whole(r.control[i]))).collect();
        let patch = Surface { knots_u, knots_v: self.patch.knots_v.clone(), control, rational: self.patch.rational };
        let knots_s = lines[0].knots.clone();
        let control = (0..knots_s.control_count()).flat_map(|i| lines.iter().map(move |l| l.control[i])).collect();
        Ok(Self { patch, map: FootMap { knots_s, knots_t: self.map.knots_t.clone(), control } })
    }
}
