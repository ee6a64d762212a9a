//! Torses near tangent planes that come in a sequence, with or without their rulings: the dual spline fits as one tool.
//!
//! *Method* \[PW99, 4.1–4.3\]: axes from the normals; parameters from distance and turn; `F1` over few knots for the
//! tolerance; joint correction of planes and parameters. Where rulings are known, they count through `F3` in a further
//! fit if slopes increase; results are polished with distances at exact feet, and a torse over a plane profile is tried
//! as well: it alone has inflections. Rows that no torse follows are cut, each run as long as can be. *Not guaranteed*:
//! distances; see the judge.

use crate::fit::near::descent::RefitOptions;
use crate::fit::near::dual;
use crate::fit::near::primal::{primal, PrimalOptions};
use crate::fit::near::samples::{error, Fit, Sample, MARGIN};
use crate::fit::planes::correction::{corrected, joint, JointOptions};
use crate::fit::planes::frame::{frame_of_normals, slope_frame, STEEPEST};
use crate::fit::planes::functionals::Freedom;
use crate::fit::planes::knot_choice::{planes_within, KnotOptions, FAINT};
use crate::fit::planes::linear_system::{ruling_condition, PlaneDatum, PlanesOptions};
use crate::fit::planes::regularity_margin::{controlled, keeps, Reach};
use crate::fit::planes::rulings::{slope_fit, RulingDatum, SlopeData, SlopeOptions};
use crate::geom::measure::{LineMeasure, Measure};
use crate::geom::{Frame, Vec3};
use crate::num::golden_section;
use crate::spline::knots::Knots;
use crate::spline::pieces::Pieces;
use crate::torse::contact::ContactElement;
use crate::torse::dual::{graph_in, plane_through, DualCurve};
use crate::torse::form::{DualTorse, PanelKind, Torse};
use crate::torse::zone::RegressionLimits;

/// How a sequence of torses is fitted to elements.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceOptions {
    /// Largest distance of a plane over its region, and of a ruling, mm.
    pub tolerance: f64,
    /// Pieces at most; 64.
    pub max_pieces: usize,
    /// Whether planes far from the rest lose their weight; false.
    pub robust: bool,
    /// Weight of bending against the data in fits, as a share; 1e-9. Larger than that, fits stay as smooth as they come:
    /// they are not polished towards the data.
    pub smoothing: f64,
    /// Whether the first and the last element of each piece are kept: planes, and rulings where they are known; false.
    /// Fits are not polished then.
    pub fix_ends: bool,
    /// What is asked of regression curves; nothing beyond a regular strip.
    pub limits: Option<RegressionLimits>,
}

impl SequenceOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_pieces: 64, robust: false, smoothing: FAINT, fix_ends: false, limits: None }
    }

    /// Whether distances at exact feet may move fits.
    pub(crate) fn polishes(&self) -> bool {
        !self.fix_ends && self.smoothing <= FAINT
    }
}

/// A run of the sequence with its torses.
#[derive(Clone, Debug)]
pub(crate) struct SequencePiece {
    /// Elements that belong to it; neighbouring pieces share one.
    pub range: std::ops::Range<usize>,
    /// Torses within the tolerance of the elements as far as samples tell, the nearest first; empty where nothing fits.
    pub fits: Vec<Fit>,
    /// Whether it is empty because of what is asked of the regression curve.
    pub kept_off: bool,
}

/// Elements without which no surface is looked for, but a plane.
pub(crate) const FEWEST: usize = 4;

/// Torses for the runs of a sequence, greedily as long as can be. Every element belongs to a piece.
///
/// *Input*: usable elements, neighbours oriented alike.
pub(crate) fn sequence_pieces(elements: &[ContactElement], options: &SequenceOptions) -> Vec<SequencePiece> {
    let mut out: Vec<SequencePiece> = Vec::new();
    for (range, hopeless) in stretches(elements, options) {
        if hopeless {
            out.push(SequencePiece { range, fits: Vec::new(), kept_off: true });
        } else {
            greedy(elements, range, options, &mut out);
        }
    }
    out
}

/// Stretches of a sequence, and whether limits of the regression curve leave nothing of them: a strip that keeps to the limits
/// does so on every part, so that where short runs have fits but none within the limits, longer ones have none either.
fn stretches(elements: &[ContactElement], options: &SequenceOptions) -> Vec<(std::ops::Range<usize>, bool)> {
    let whole = || vec![(0..elements.len(), false)];
    if options.limits.is_none() || elements.len() <= FEWEST || !torses(elements, options).is_empty() {
        return whole();
    }
    let free = SequenceOptions { limits: None, ..options.clone() };
    let mut out: Vec<(std::ops::Range<usize>, bool)> = Vec::new();
    let mut from = 0;
    while from + 1 < elements.len() {
        // A rest that is too short for a fit belongs to the last run.
        let to = if from + 2 * FEWEST > elements.len() { elements.len() } else { from + FEWEST };
        let own = &elements[from..to];
        let hopeless = torses(own, options).is_empty() && !torses(own, &free).is_empty();
        match out.last_mut().filter(|l| l.1 == hopeless) {
            Some(last) => last.0.end = to,
            None => out.push((from..to, hopeless)),
        }
        from = to - 1;
    }
    out
}

/// Pieces of a stretch of a sequence.
fn greedy(
    elements: &[ContactElement],
    range: std::ops::Range<usize>,
    options: &SequenceOptions,
    out: &mut Vec<SequencePiece>,
) {
    let mut from = range.start;
    while from + 1 < range.end {
        let rest = range.end - from;
        let attempt = |count: usize| torses(&elements[from..from + count], options);
        let mut best = attempt(rest);
        let mut length = rest;
        if best.is_empty() && rest > FEWEST && out.len() < options.max_pieces {
            let (mut good, mut bad) = (0usize, rest);
            // Bisections of its length, to the last element.
            loop {
                let middle = if good == 0 { (bad / 2).max(FEWEST) } else { good.midpoint(bad) };
                if middle <= good || middle >= bad {
                    break;
                }
                let found = attempt(middle);
                if found.is_empty() {
                    bad = middle;
                } else {
                    (good, best) = (middle, found);
                }
            }
            length = if good == 0 { bad.min(FEWEST) } else { good };
        }
        out.push(SequencePiece { range: from..from + length, fits: best, kept_off: false });
        from += length - 1;
    }
}

/// Torses within the tolerance of all elements, the nearest first; empty where nothing fits.
///
/// *Input*: as for [`sequence_pieces`].
pub(crate) fn torses(elements: &[ContactElement], options: &SequenceOptions) -> Vec<Fit> {
    let mut out = Vec::new();
    let samples = samples(elements);
    let rulings = elements.iter().all(ContactElement::has_ruling);
    if rulings && options.polishes() {
        out.extend(primal(&samples, &PrimalOptions::new(0.5 * options.tolerance)));
    }
    if let Some((torse, far)) = dual_of_sequence(elements, options) {
        if rulings {
            let wanted = RefitOptions::new(0.5 * options.tolerance);
            let kept = error(&torse, &samples).map(|(error, worst)| Fit {
                torse: torse.clone(),
                kind: PanelKind::Torse,
                error,
                worst,
            });
            let polished = match &torse {
                Torse::Dual(d) => dual::refit(d, &samples, &wanted),
                Torse::Primal(_) | Torse::Cylinder(_) => None,
            };
            out.extend(kept);
            if options.fix_ends {
                out.retain(|f| f.error <= options.tolerance);
                return out;
            }
            let polished = polished.filter(|_| options.polishes());
            out.extend(polished);
            let sloped = dual_by_slope(elements, options);
            let further = sloped.as_ref().filter(|_| options.polishes());
            out.extend(further.and_then(|t| dual::refit(t, &samples, &wanted)));
            out.extend(sloped.and_then(|t| {
                let torse = Torse::Dual(t);
                let (error, worst) = error(&torse, &samples)?;
                Some(Fit { torse, kind: PanelKind::Torse, error, worst })
            }));
        } else {
            let worst = (0..far.len()).max_by(|&i, &j| far[i].total_cmp(&far[j])).unwrap_or(0);
            out.push(Fit { torse, kind: PanelKind::Torse, error: far.get(worst).copied().unwrap_or(0.0), worst });
        }
    }
    let crossing = rulings && options.limits.is_some();
    let near = |f: &Fit| f.error <= options.tolerance && (!crossing || follows(&f.torse, elements, options.tolerance));
    out.retain(near);
    // With more conditions nothing comes nearer.
    if out.is_empty() {
        return out;
    }
    // The convex program also serves where a regression curve crosses what is fitted: no strip comes of such fits.
    let limits = options.limits.clone().unwrap_or_default();
    let reaches = reaches(elements);
    let kept: Vec<bool> = out.iter().map(|f| keeps(&f.torse, &reaches, &limits)).collect();
    if !kept.contains(&true) && !options.fix_ends {
        let further = controlled_by_slope(elements, &limits, options);
        out.retain(|_| options.limits.is_none());
        out.extend(further.filter(|f| near(f) && keeps(&f.torse, &reaches, &limits)));
    } else if options.limits.is_some() {
        let mut kept = kept.into_iter();
        out.retain(|_| kept.next() == Some(true));
    }
    out.sort_by(|a, b| a.error.total_cmp(&b.error));
    out
}

/// Whether rulings of a torse run near given ones, and not only the points on them: nearly plane pieces follow points
/// with rulings of any direction.
fn follows(torse: &Torse, elements: &[ContactElement], tolerance: f64) -> bool {
    // Rulings are proven part by part; where ends are farther off than so many tolerances, parts are too.
    const CROSSING: f64 = 32.0;
    let Some(power_form) = crate::fit::near::power_form::PowerForm::of(torse) else { return false };
    let guesses = power_form.guesses();
    elements.iter().all(|e| {
        let q = power_form.local(&e.centre());
        let Some(t) = power_form.foot(&q, guesses.guess(&q), power_form.domain()) else { return false };
        let r = torse.ruling(t);
        e.ends.iter().all(|x| (x - r.point).cross(&r.direction).norm() <= CROSSING * tolerance)
    })
}

/// What a strip for the elements reaches: both ends of rulings, or regions around planes.
fn reaches(elements: &[ContactElement]) -> Vec<Reach> {
    let reach = |e: &ContactElement| if e.has_ruling() { 0.0 } else { e.radius };
    elements.iter().flat_map(|e| e.ends.map(|x| (x, reach(e)))).collect()
}

/// The nearest torse found whose regression curve keeps to the limits, by the convex program, over more and more knots
/// until it is within the tolerance.
fn controlled_by_slope(
    elements: &[ContactElement],
    limits: &RegressionLimits,
    options: &SequenceOptions,
) -> Option<Fit> {
    let (data, frame) = slope_data(elements)?;
    let places = |e: &ContactElement, t: f64| {
        e.ends.map(|x| (t, (frame.to_local(&x), if e.has_ruling() { 0.0 } else { e.radius })))
    };
    let places: Vec<(f64, Reach)> =
        elements.iter().zip(&data.planes).flat_map(|(e, d)| places(e, d.parameter)).collect();
    let start = planes_within(&data.planes, &knots_wanted(elements.len(), options)).ok()?;
    controlled_fit((&data, &frame), places, start.curve.knots().clone(), limits, options, |torse| {
        if elements.iter().all(ContactElement::has_ruling) {
            return error(torse, &samples(elements));
        }
        let Torse::Dual(d) = torse else { return None };
        let (a, b) = d.planes.domain();
        let far = |e: &ContactElement| {
            // The nearest of the planes: the parameter is a slope, which noise moves.
            let at = |t: f64| {
                let u = d.planes.jet(t)[0];
                let n = Vec3::new(u[0], u[1], u[2]);
                distance(e, &n, u[3] / n.norm())
            };
            least(a, b, at)
        };
        let far: Vec<f64> = elements.iter().map(far).collect();
        let worst = (0..far.len()).max_by(|&i, &j| far[i].total_cmp(&far[j]))?;
        Some((far[worst], worst))
    })
}

/// The least value on an interval: the best of a table, then golden sections.
pub(crate) fn least(a: f64, b: f64, value: impl Fn(f64) -> f64) -> f64 {
    const TABLE: usize = 96;
    const SECTIONS: usize = 30;
    let at = |k: usize| a + (b - a) * k as f64 / TABLE as f64;
    let values: Vec<f64> = (0..=TABLE).map(|k| value(at(k))).collect();
    let k = (0..=TABLE).min_by(|&i, &j| values[i].total_cmp(&values[j])).unwrap_or(0);
    golden_section::least(value, [at(k.saturating_sub(1)), at((k + 1).min(TABLE))], SECTIONS).1.min(values[k])
}

/// Fits by the convex program over `knots`, then over halved spans, until one is within the tolerance; the nearest.
fn controlled_fit(
    (data, frame): (&SlopeData, &Frame),
    places: Vec<(f64, Reach)>,
    mut knots: Knots,
    limits: &RegressionLimits,
    options: &SequenceOptions,
    measured: impl Fn(&Torse) -> Option<(f64, usize)>,
) -> Option<Fit> {
    const HALVINGS: usize = 2;
    // Limits that push a fit farther away than so many tolerances do so over any knots.
    const HOPELESS: f64 = 3.0;
    let wanted = SlopeOptions { smoothing: options.smoothing, robust: options.robust, ..SlopeOptions::default() };
    let mut best: Option<Fit> = None;
    for _ in 0..=HALVINGS {
        let curve = controlled(data, frame, places.clone(), &knots, limits, &wanted);
        if let Some(torse) = curve.and_then(|c| extended(&c, frame)).map(Torse::Dual) {
            if let Some((error, worst)) = measured(&torse) {
                if best.as_ref().is_none_or(|b| error < b.error) {
                    best = Some(Fit { torse, kind: PanelKind::Torse, error, worst });
                }
            }
        }
        if best.as_ref().is_some_and(|b| b.error <= options.tolerance || b.error > HOPELESS * options.tolerance) {
            break;
        }
        let breaks = knots.breaks();
        let halved: Vec<f64> =
            breaks.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]).chain(breaks.last().copied()).collect();
        knots = Knots::clamped(knots.degree(), &halved).ok()?;
    }
    best
}

/// Points of the rulings of a sequence with their normals, for fits of points.
pub(crate) fn samples(elements: &[ContactElement]) -> Vec<Sample> {
    // Enough for a straight line on a surface that is ruled nearly the same way.
    const ALONG: usize = 5;
    let mut out = Vec::with_capacity(ALONG * elements.len());
    for e in elements {
        for k in 0..ALONG {
            let s = k as f64 / (ALONG - 1) as f64;
            out.push(Sample { x: e.ends[0] * (1.0 - s) + e.ends[1] * s, n: e.normal, weight: e.weight });
        }
    }
    out
}

/// Largest distance of an element's region from a plane `n·X = h`, over its ends and radius, mm.
pub(crate) fn distance(e: &ContactElement, n: &Vec3, h: f64) -> f64 {
    let n = n.normalize();
    let ends = e.ends.map(|x| (n.dot(&x) - h).abs());
    // In the element's plane the distance is linear; its slope is the sine of the angle between the planes. A ruling
    // that is known is compared on itself only.
    let slope = if e.has_ruling() { 0.0 } else { n.cross(&e.normal).norm() };
    ends[0].max(ends[1]) + e.radius * slope
}

/// As [`dual_of_cloud`], with a regression curve that keeps to the limits: planes by their slopes, by the convex program.
pub(crate) fn controlled_of_cloud(
    samples: &[Sample],
    radius: f64,
    limits: &RegressionLimits,
    options: &SequenceOptions,
) -> Option<Fit> {
    let (elements, frame) = sloped(samples, radius)?;
    let elements: Vec<ContactElement> = elements.into_iter().map(|e| e.1).collect();
    let mut data = SlopeData { planes: data(&elements, &vec![0.0; elements.len()], &frame)?, ..SlopeData::default() };
    data.planes.iter_mut().for_each(|d| d.parameter = d.plane[2]);
    let places = (elements.iter().zip(&data.planes)).map(|(e, d)| (d.parameter, (frame.to_local(&e.centre()), radius)));
    let places: Vec<(f64, Reach)> = places.collect();
    let start = planes_within(&data.planes, &knots_wanted(elements.len(), options)).ok()?;
    controlled_fit((&data, &frame), places, start.curve.knots().clone(), limits, options, |t| error(t, samples))
}

/// Whether the regression curve of a torse keeps to the limits at estimates that reach `radius` (mm) around them.
pub(crate) fn keeps_limits(torse: &Torse, samples: &[Sample], radius: f64, limits: &RegressionLimits) -> bool {
    let reaches: Vec<Reach> = samples.iter().map(|s| (s.x, radius)).collect();
    keeps(torse, &reaches, limits)
}

/// Estimates as planes with their slopes, in increasing order, and the axes of these.
fn sloped(samples: &[Sample], radius: f64) -> Option<(Vec<(f64, ContactElement)>, Frame)> {
    let normals: Vec<Vec3> = samples.iter().map(|s| s.n).collect();
    let frame = axes(&normals, samples.iter().map(|s| s.x))?;
    let mut sloped: Vec<(f64, ContactElement)> = samples
        .iter()
        .map(|s| {
            let n = frame.vector_to_local(&s.n);
            (-n.y / n.z, ContactElement { normal: s.n, ends: [s.x; 2], radius, weight: 1.0 })
        })
        .collect();
    sloped.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some((sloped, frame))
}

/// A dual torse near surface elements in no order, as estimated from measured points: planes are sorted by their slope
/// in the direction in which normals spread most, corrected in turn, and polished with distances at exact feet. `radius`
/// (mm) is the reach of an estimate. `None` where the planes are no graphs over one plane, or no regular torse is found.
pub(crate) fn dual_of_cloud(samples: &[Sample], radius: f64, options: &SequenceOptions) -> Option<Fit> {
    // Corrections gain little after these; feet are exact afterwards.
    const CORRECTIONS: usize = 3;
    let (sloped, frame) = sloped(samples, radius)?;
    let (a, b) = (sloped.first()?.0, sloped.last()?.0);
    let elements: Vec<ContactElement> = sloped.iter().map(|s| s.1).collect();
    let parameters: Vec<f64> = sloped.iter().map(|s| (s.0 - a) / (b - a)).collect();
    if parameters.iter().any(|t| !t.is_finite()) {
        return None;
    }
    let data = data(&elements, &parameters, &frame)?;
    let wanted = knots_wanted(elements.len(), options);
    let few = planes_within(&data, &wanted).ok()?;
    let better = corrected(&data, few.curve.knots(), &wanted.fit, CORRECTIONS).ok()?;
    let torse = extended(&better.fit.curve, &frame)?;
    dual::refit(&torse, samples, &RefitOptions::new(options.tolerance))
}

/// Axes of normals with the origin in the middle of the places; `None` if one axis does not suit all.
pub(crate) fn axes(normals: &[Vec3], places: impl ExactSizeIterator<Item = Vec3>) -> Option<Frame> {
    let found = frame_of_normals(normals).ok()?;
    let count = places.len();
    if count < FEWEST || found.min_cosine <= STEEPEST {
        return None;
    }
    Some(Frame { origin: places.sum::<Vec3>() / count as f64, ..found.frame })
}

/// Knots for a tolerance: `F1` measures the mean over a region, and along the axis.
pub(crate) fn knots_wanted(count: usize, options: &SequenceOptions) -> KnotOptions {
    KnotOptions {
        max_spans: (count / 2).clamp(1, 60),
        removals: 20,
        fit: PlanesOptions { smoothing: options.smoothing, robust: options.robust, ..PlanesOptions::default() },
        ..KnotOptions::new(0.3 * options.tolerance)
    }
}

impl KnotOptions {
    /// Keeps the first and the last plane of a sequence and, where they are known, the rulings in them: the next control
    /// planes go through these \[PW99, 4.2\]. `None` if a ruling is square to the ground plan.
    pub(crate) fn keep_ends(&mut self, elements: &[ContactElement], data: &[PlaneDatum], frame: &Frame) -> Option<()> {
        let condition = |e: &ContactElement, d: &PlaneDatum| -> Option<Vec<(usize, Freedom<3>)>> {
            let mut out = vec![(0, Freedom::Fixed(d.plane))];
            if e.has_ruling() {
                let [p, q] = e.ends.map(|x| frame.to_local(&x));
                let size = (q - p).xy().norm();
                if size.is_nan() || size <= 0.0 {
                    return None;
                }
                let plan = [(p.x * q.y - q.x * p.y) / size, (p.y - q.y) / size, (q.x - p.x) / size];
                out.push((1, ruling_condition(d.plane, plan)));
            }
            Some(out)
        };
        self.fit.conditions = condition(elements.first()?, data.first()?)?;
        self.from_end = condition(elements.last()?, data.last()?)?;
        Some(())
    }
}

/// A cubic dual torse near a sequence by `F1` with joint correction, on a domain that reaches beyond its ends, with the
/// distances of all elements. `None` where the planes are no graphs over one plane, or turn back.
pub(crate) fn dual_of_sequence(elements: &[ContactElement], options: &SequenceOptions) -> Option<(Torse, Vec<f64>)> {
    let normals: Vec<Vec3> = elements.iter().map(|e| e.normal).collect();
    let parameters = parameters(elements)?;
    let axes = axes(&normals, elements.iter().map(ContactElement::centre))?;
    let frame = slope_frame(&normals, &axes).unwrap_or(axes);
    let data = data(elements, &parameters, &frame)?;
    let mut wanted = knots_wanted(elements.len(), options);
    if options.fix_ends {
        wanted.keep_ends(elements, &data, &frame)?;
    }
    let few = planes_within(&data, &wanted).ok()?;
    let knots = few.curve.knots();
    let better = joint(&data, knots, &wanted.over(knots), &JointOptions::default()).ok();
    let (curve, parameters) = match better {
        Some(b) => (b.fit.curve, b.parameters),
        None => (few.curve, parameters),
    };
    let torse = extended(&curve, &frame)?;
    let far = elements
        .iter()
        .zip(&parameters)
        .map(|(e, &t)| {
            let u = torse.planes.jet(t)[0];
            distance(e, &Vec3::new(u[0], u[1], u[2]), u[3] / Vec3::new(u[0], u[1], u[2]).norm())
        })
        .collect();
    Some((Torse::Dual(torse), far))
}

/// A cubic dual torse of type (3) near a sequence of rulings with planes by `F3`, where the slope of the planes increases
/// along the sequence. The rulings themselves count, not only their planes.
fn dual_by_slope(elements: &[ContactElement], options: &SequenceOptions) -> Option<DualTorse> {
    let (data, frame) = slope_data(elements)?;
    // As many knots as the planes need.
    let few = planes_within(&data.planes, &knots_wanted(elements.len(), options)).ok()?;
    let wanted = SlopeOptions { smoothing: options.smoothing, robust: options.robust, ..SlopeOptions::default() };
    let fit = slope_fit(&data, few.curve.knots(), &wanted).ok()?;
    extended(&fit.curve, &frame)
}

/// Planes, and rulings where they are known, by the slope of the planes, in axes in which it increases along the sequence.
pub(crate) fn slope_data(elements: &[ContactElement]) -> Option<(SlopeData, Frame)> {
    // Rulings against planes: lengths in the ground plan times this share of the range of slopes are heights.
    const SHARE: f64 = 0.25;
    let normals: Vec<Vec3> = elements.iter().map(|e| e.normal).collect();
    let axes = axes(&normals, elements.iter().map(ContactElement::centre))?;
    let frame = slope_frame(&normals, &axes)?;
    let mut out = SlopeData { planes: data(elements, &vec![0.0; elements.len()], &frame)?, ..SlopeData::default() };
    out.planes.iter_mut().for_each(|d| d.parameter = d.plane[2]);
    let (from, to) = (out.planes.first()?.parameter, out.planes.last()?.parameter);
    for (e, d) in elements.iter().zip(&out.planes).filter(|(e, _)| e.has_ruling()) {
        let [p, q] = e.ends.map(|x| frame.to_local(&x));
        let slope = -(q.y - p.y) / (q.x - p.x);
        let along = LineMeasure::interval(p.x.min(q.x), p.x.max(q.x)).ok()?;
        let weight = d.weight * (SHARE * (to - from)).powi(2) / (q.x - p.x).abs();
        let ground_plan = [-p.y - slope * p.x, slope];
        out.rulings.push(RulingDatum { parameter: d.parameter, ground_plan, along, weight });
    }
    Some((out, frame))
}

/// Parameters in [0, 1]: shares of the way along the sequence and of the turn of its normals.
pub(crate) fn parameters(elements: &[ContactElement]) -> Option<Vec<f64>> {
    // Even sequences that neither move nor turn somewhere get distinct parameters.
    const EVEN: f64 = 1e-3;
    let (mut way, mut turn) = (vec![0.0], vec![0.0]);
    for w in elements.windows(2) {
        way.push(way[way.len() - 1] + (w[1].centre() - w[0].centre()).norm());
        turn.push(turn[turn.len() - 1] + (w[1].normal - w[0].normal).norm());
    }
    let (length, angle) = (way[way.len() - 1], turn[turn.len() - 1]);
    let count = elements.len().checked_sub(1).filter(|&n| n > 0)? as f64;
    // Planes that share a region are told apart by their turn only.
    let share = |x: f64, whole: f64| if whole > 0.0 { x / whole } else { 0.0 };
    let raw: Vec<f64> =
        (0..elements.len()).map(|i| share(way[i], length) + share(turn[i], angle) + EVEN * i as f64 / count).collect();
    let whole = raw[raw.len() - 1];
    let out: Vec<f64> = raw.iter().map(|x| x / whole).collect();
    out.windows(2).all(|w| w[1] > w[0]).then_some(out)
}

/// The data of `F1` in a frame.
pub(crate) fn data(elements: &[ContactElement], parameters: &[f64], frame: &Frame) -> Option<Vec<PlaneDatum>> {
    let mut out = Vec::with_capacity(elements.len());
    for (i, (e, &parameter)) in elements.iter().zip(parameters).enumerate() {
        let plane = graph_in(frame, &plane_through(&e.centre(), &e.normal), i).ok()?;
        let ground = e.ends.map(|x| frame.to_local(&x)).map(|x| [x.x, x.y]);
        let c = [0.5 * (ground[0][0] + ground[1][0]), 0.5 * (ground[0][1] + ground[1][1])];
        let disc = Measure::disc(c, e.radius).ok()?;
        let disc = disc.scaled(1.0 / disc.mass());
        let measure = if e.has_ruling() {
            // The ruling counts fully, the width of its region so that the tilt about it is determined.
            Measure::masses(&ground, &[0.5, 0.5]).ok()?.plus(&disc.scaled(0.5))
        } else {
            disc
        };
        let weight = e.weight * crate::fit::planes::linear_system::slope_weight(&plane);
        out.push(PlaneDatum { plane, parameter, measure, weight });
    }
    Some(out)
}

/// The torse of a cubic curve of planes, in the world, continued a little beyond both ends.
pub(crate) fn extended(curve: &DualCurve, frame: &Frame) -> Option<DualTorse> {
    extended_by(MARGIN, curve, frame)
}

/// The same, continued by a share of its domain.
pub(crate) fn extended_by(share: f64, curve: &DualCurve, frame: &Frame) -> Option<DualTorse> {
    let torse = curve.to_world(frame).ok()?.to_torse();
    let pieces = Pieces::of(&torse.planes)?;
    let (a, b) = pieces.domain();
    let shortest = 0.25 * (b - a) / pieces.power.len() as f64;
    let planes = pieces.on(a - share * (b - a), b + share * (b - a), shortest).to_curve().ok()?;
    Some(DualTorse { planes })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rulings of the tangent surface of a helix, moved out along the tangents.
    fn helix(count: usize, turn: f64) -> Vec<ContactElement> {
        (0..count)
            .map(|i| {
                let t = turn * i as f64 / (count - 1) as f64;
                let c = Vec3::new(500.0 * t.cos(), 500.0 * t.sin(), 300.0 * t);
                let d = Vec3::new(-500.0 * t.sin(), 500.0 * t.cos(), 300.0).normalize();
                let n = d.cross(&Vec3::new(-t.cos(), -t.sin(), 0.0)).normalize();
                ContactElement { normal: n, ends: [c + d * 200.0, c + d * 500.0], radius: 30.0, weight: 1.0 }
            })
            .collect()
    }

    #[test]
    fn rulings_of_a_tangent_surface_are_met() {
        let out = sequence_pieces(&helix(40, 1.0), &SequenceOptions::new(0.1));
        assert_eq!(out.len(), 1);
        assert!(out[0].fits.iter().any(|f| matches!(f.torse, Torse::Dual(_))), "{out:?}");
        assert!(out[0].fits[0].error < 0.05, "{}", out[0].fits[0].error);
    }

    #[test]
    fn planes_alone_are_met_over_their_regions() {
        let planes: Vec<ContactElement> =
            helix(40, 1.0).into_iter().map(|e| ContactElement { ends: [e.centre(); 2], radius: 150.0, ..e }).collect();
        let out = sequence_pieces(&planes, &SequenceOptions::new(0.1));
        assert_eq!(out.len(), 1);
        assert!(out[0].fits[0].error <= 0.1, "{:?}", out[0].fits[0].error);
    }

    #[test]
    fn a_jump_cuts_the_row() {
        let mut jump = helix(40, 1.0);
        for e in &mut jump[20..] {
            e.ends = e.ends.map(|x| x + Vec3::new(0.0, 0.0, 40.0));
        }
        let out = sequence_pieces(&jump, &SequenceOptions::new(0.1));
        assert!(out.len() > 1);
        assert_eq!(out.iter().map(|p| p.range.len() - 1).sum::<usize>(), 39);
    }
}
