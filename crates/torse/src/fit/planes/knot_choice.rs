//! Number and place of knots for a wanted distance of planes.
//!
//! *Method.* Spans whose planes are not near enough are halved at the median of their parameters, until all are near
//! or a span has too few planes; then knots are taken out one by one, the least needed first, while all stay near
//! (knot removal in the spirit of \[PT97, 9.4.4\], by fits instead of bounds).

use super::functionals::Freedom;
use super::linear_system::{planes, PlaneDatum, PlanesError, PlanesFit, PlanesOptions};
use crate::spline::knots::Knots;
use crate::torse::dual::DualError;

/// Share of the data's own weight that smoothing has: fits stay determined where planes are few, and others do not
/// move.
pub(in crate::fit) const FAINT: f64 = 1e-9;

/// Options of [`planes_within`].
#[derive(Clone, Debug, PartialEq)]
pub struct KnotOptions {
    /// Largest root mean square distance of a plane over its region, mm.
    pub tolerance: f64,
    /// Degree; 3.
    pub degree: usize,
    /// Spans at most; 200.
    pub max_spans: usize,
    /// Fits spent on taking knots out; 60.
    pub removals: usize,
    /// Conditions on control planes counted from the last one; none.
    pub from_end: Vec<(usize, Freedom<3>)>,
    /// Options of the fits. Small smoothing keeps fits determined where planes are few.
    pub fit: PlanesOptions,
}

impl KnotOptions {
    /// Options of a fit over knots, with the conditions that depend on their number.
    pub(crate) fn over(&self, knots: &Knots) -> PlanesOptions {
        let mut out = self.fit.clone();
        let count = knots.control_count();
        out.conditions.extend(self.from_end.iter().filter(|c| c.0 < count).map(|(i, f)| (count - 1 - i, *f)));
        out
    }

    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            degree: 3,
            max_spans: 200,
            removals: 60,
            from_end: Vec::new(),
            fit: PlanesOptions { smoothing: FAINT, ..PlanesOptions::default() },
        }
    }
}

/// The fit with few knots whose planes are within the tolerance, or the nearest one reached: compare
/// [`PlanesFit::distances`]. Planes without weight or trust do not count.
///
/// *Input*: at least two different parameters; the knots span all of them.
///
/// # Errors
/// See [`PlanesError`].
pub fn planes_within(data: &[PlaneDatum], options: &KnotOptions) -> Result<PlanesFit, PlanesError> {
    let mut sorted: Vec<f64> = data.iter().map(|d| d.parameter).collect();
    if let Some(index) = sorted.iter().position(|t| !t.is_finite()) {
        return Err(PlanesError::Datum { what: "plane", index, value: sorted[index] });
    }
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let (Some(&a), Some(&b)) = (sorted.first(), sorted.last()) else {
        return Err(PlanesError::Undetermined { control: 0, count: options.degree + 1 });
    };
    let fit = |breaks: &[f64]| -> Result<PlanesFit, PlanesError> {
        let knots = Knots::clamped(options.degree, breaks).map_err(DualError::from)?;
        planes(data, &knots, &options.over(&knots))
    };
    let far = |f: &PlanesFit, i: usize| f.distances[i] > options.tolerance && data[i].weight > 0.0 && f.trust[i] > 0.0;
    let mut breaks = vec![a, b];
    let mut best = fit(&breaks)?;
    loop {
        let mut split = Vec::new();
        for w in breaks.windows(2) {
            let poor = (0..data.len()).any(|i| data[i].parameter >= w[0] && data[i].parameter <= w[1] && far(&best, i));
            if !poor {
                continue;
            }
            let lo = sorted.partition_point(|t| *t <= w[0]);
            let hi = sorted.partition_point(|t| *t < w[1]);
            // Two planes inside each new span at least, or it follows noise.
            if hi > lo + 3 {
                let middle = (lo + hi) / 2;
                split.push(0.5 * (sorted[middle - 1] + sorted[middle]));
            }
        }
        if split.is_empty() || breaks.len() - 1 + split.len() > options.max_spans {
            break;
        }
        breaks.extend(split);
        breaks.sort_by(f64::total_cmp);
        best = fit(&breaks)?;
    }
    if (0..data.len()).any(|i| far(&best, i)) {
        return Ok(best);
    }
    // Taking out, shortest pairs of spans first.
    let mut spent = 0;
    let mut kept: Vec<f64> = Vec::new();
    loop {
        let candidate = (1..breaks.len() - 1)
            .filter(|&i| !kept.contains(&breaks[i]))
            .min_by(|&i, &j| (breaks[i + 1] - breaks[i - 1]).total_cmp(&(breaks[j + 1] - breaks[j - 1])));
        let Some(i) = candidate.filter(|_| spent < options.removals) else { break };
        spent += 1;
        let mut fewer = breaks.clone();
        fewer.remove(i);
        match fit(&fewer) {
            Ok(f) if !(0..data.len()).any(|i| far(&f, i)) => (breaks, best) = (fewer, f),
            _ => kept.push(breaks[i]),
        }
    }
    Ok(best)
}
