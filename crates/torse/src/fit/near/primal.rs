//! Fitting a primal torse: a plane profile with conjugate rulings, inflections included.
//!
//! *Method*: mixed-curvature specification C1.5 (frame from the normals, ten ruling directions, ranking by cylinders
//! and cones, Gauss–Newton), finished by linearised minimax steps with exchange of the worst samples.

use super::descent::RefitOptions;
use super::descent::GOAL;
use super::descent::{descended, largest, polished, repaired, Family};
use super::directions::{candidates, mean_direction, spans, Candidate, Counts};
use super::plane::plane;
use super::power_form::{PowerForm, RegularityMargin};
use super::profile::{ProfileFamily, Slopes};
use super::samples::{measure, thin, Fit, Sample, MARGIN};
use crate::control::Control;
use crate::geom::{Frame, Vec3};
use crate::spline::pieces::Pieces;
use crate::torse::form::{PanelKind, PrimalTorse, Torse};

/// Options of [`primal`].
#[derive(Clone, Debug)]
pub struct PrimalOptions {
    /// Wanted distance, mm: the fit ends early below it, and simple kinds are preferred when they reach it.
    pub tolerance: f64,
    /// Ruling directions tried; 10.
    pub directions: usize,
    /// Best directions that get a full fit; 3.
    pub keep: usize,
    /// Spans of the profile f (raised to a multiple of `ruling_spans`); 10.
    pub profile_spans: usize,
    /// Spans of the ruling slope a; 2.
    pub ruling_spans: usize,
    /// Samples that take part at first; 220.
    pub max_samples: usize,
    /// Wanted radius of curvature at the samples, mm; 0. Kept as far as the start allows.
    pub bend_radius: f64,
    /// Ends the fit early with the best torse so far; never.
    pub control: Control,
}

impl PrimalOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            directions: 10,
            keep: 3,
            profile_spans: 10,
            ruling_spans: 2,
            max_samples: 220,
            bend_radius: 0.0,
            control: Control::default(),
        }
    }

    /// The same with more spans of the profile, of the rulings' slope as many more in proportion, and more samples.
    pub(crate) fn with_spans(&self, profile_spans: usize) -> Self {
        let more = profile_spans as f64 / self.profile_spans.max(1) as f64;
        Self {
            profile_spans,
            ruling_spans: (self.ruling_spans as f64 * more) as usize,
            // With all the more samples fits take twice as long and are hardly better.
            max_samples: (self.max_samples as f64 * more.sqrt()) as usize,
            ..self.clone()
        }
    }
}

/// Fits between one and this many tolerances get splines with more spans.
const FINER: f64 = 2.0;
/// Fits worse than this many tolerances are not refined.
const HOPELESS: f64 = 6.0;

/// The primal torse nearest to the samples in the sense of the largest distance, or a plane, cylinder or cone when
/// such a one reaches the tolerance.
///
/// *Input*: samples of a piece of surface whose normals lie within 70° of a common direction; normals may be zero in
/// places. *Result*: a fit whose domain reaches at least 5 % of the feet's range beyond all feet, regular
/// (`1 + y a' > 0.05`) at all samples; its error may exceed the tolerance (then it is within a few percent of the best
/// local optimum found, or, above six tolerances, only roughly fitted). Where no regular torse was found, or none better
/// than the plane: the best plane. `None` without samples or with numbers that are not finite.
/// *Not guaranteed*: that the optimum is global.
pub fn primal(samples: &[Sample], options: &PrimalOptions) -> Option<Fit> {
    let enough = GOAL * options.tolerance;
    let flat = plane(samples)?;
    if flat.error <= options.tolerance || samples.len() < 6 {
        return Some(flat);
    }
    let best = curved(samples, options, enough);
    match best {
        Some(fit) if fit.error < flat.error => Some(fit),
        _ => Some(flat),
    }
}

fn curved(samples: &[Sample], options: &PrimalOptions, enough: f64) -> Option<Fit> {
    let up = mean_direction(samples)?;
    let few = thin(samples, options.max_samples.max(12));
    let all: Vec<usize> = (0..samples.len()).collect();
    let ruling_spans = options.ruling_spans.max(1);
    let profile_spans = options.profile_spans.max(2).div_ceil(ruling_spans) * ruling_spans;

    let counts = Counts { directions: options.directions.max(1), profile_spans, ruling_spans };
    let mut found = candidates(samples, &few, up, counts, &options.control);

    // Simple kinds from the best direction whose cone is regular everywhere.
    found.sort_by(|a, b| a.cone.total_cmp(&b.cone));
    if let Some(c) = found.iter_mut().find_map(|c| c.family.irregular(&c.x, &all).is_empty().then_some(c)) {
        for (slopes, kind) in [(Slopes::Constant, PanelKind::Cylinder), (Slopes::Affine, PanelKind::Cone)] {
            if let Some(fit) = simple(c, slopes, kind, samples, (&few, &all), options.tolerance) {
                return Some(fit);
            }
        }
    }

    // General torses: a few steps for each direction, the rest for the best that is regular everywhere.
    found.sort_by(|a, b| a.torse.total_cmp(&b.torse));
    let mut freed: Vec<Freed> = Vec::new();
    for c in &mut found {
        if c.family.irregular(&c.x, &all).is_empty() {
            freed.extend(self::freed(c, &few, profile_spans, ruling_spans));
        }
        // The first good one will do.
        let stopped = !freed.is_empty() && options.control.stopped();
        if stopped || freed.len() >= options.keep.max(1) || freed.last().is_some_and(|f| f.worst <= enough) {
            break;
        }
    }
    freed.sort_by(|a, b| a.worst.total_cmp(&b.worst));
    let mut best = freed.into_iter().find_map(|f| f.repaired(&all))?;
    if options.tolerance > 0.0 && best.worst > HOPELESS * options.tolerance {
        return finished(best.frame, best.unit, &best.family, &best.x, PanelKind::Torse, samples);
    }
    let goal = enough / best.unit;
    best.family.keep_margin(&best.x, RegularityMargin { clearance: 0.0, bend_radius: options.bend_radius / best.unit });
    let few = std::mem::take(&mut best.few);
    let reached = polished(&mut best.family, &mut best.x, &few, &all, goal)? * best.unit;
    if reached > options.tolerance && reached < FINER * options.tolerance {
        // More freedom, from where the coarse fit ended.
        let (a, b) = best.family.foot_range();
        let breaks = spans(a, b, 2 * profile_spans);
        let coarse = breaks.iter().step_by(profile_spans / ruling_spans).copied().collect();
        if let Some((mut family, mut x)) = best.family.changed(&best.x, breaks, Slopes::Spline(coarse)) {
            match polished(&mut family, &mut x, &few, &all, goal) {
                Some(finer) if finer * best.unit < reached => (best.family, best.x) = (family, x),
                _ => {}
            }
        }
    }
    finished(best.frame, best.unit, &best.family, &best.x, PanelKind::Torse, samples)
}

/// A general torse after the first steps.
struct Freed {
    frame: Frame,
    unit: f64,
    family: ProfileFamily,
    x: Vec<f64>,
    /// The cone that it started from, in the same family.
    cone: Vec<f64>,
    few: Vec<usize>,
    /// Largest distance among `few`, mm.
    worst: f64,
}

/// First steps of the general torse from a ranked cone.
fn freed(c: &Candidate, few: &[usize], profile_spans: usize, ruling_spans: usize) -> Option<Freed> {
    let (a, b) = c.family.foot_range();
    let (mut family, x) = c.family.changed(&c.x, spans(a, b, profile_spans), Slopes::Affine)?;
    let few = with_ends(&family, few, profile_spans);
    let (x, _) = descended(&mut family, x, &few, 5, 0)?;
    let (a, b) = family.foot_range();
    let breaks = spans(a, b, profile_spans);
    let coarse = breaks.iter().step_by(profile_spans / ruling_spans).copied().collect();
    let (mut family, cone) = family.changed(&x, breaks, Slopes::Spline(coarse))?;
    let (x, worst) = descended(&mut family, cone.clone(), &few, 9, 4)?;
    Some(Freed { frame: c.frame, unit: c.unit, family, x, cone, few, worst: worst * c.unit })
}

impl Freed {
    /// The same, regular at all samples.
    fn repaired(mut self, all: &[usize]) -> Option<Self> {
        let x = std::mem::take(&mut self.x);
        let (x, worst) = repaired(&mut self.family, x, &self.cone, &mut self.few, all, [4, 3])?;
        self.x = x;
        self.worst = worst.map_or(self.worst, |w| w * self.unit);
        Some(self)
    }
}

/// The samples `few` and, for each of `bins` parts of the range of feet, the two farthest along the rulings: there the
/// torse is least regular, and mostly farthest away.
fn with_ends(family: &ProfileFamily, few: &[usize], bins: usize) -> Vec<usize> {
    let (a, b) = family.foot_range();
    let mut ends = vec![None::<(usize, usize)>; bins];
    for (i, (q, t)) in family.points.iter().zip(&family.feet).enumerate() {
        let k = ((t - a) / (b - a) * bins as f64) as usize;
        let end = ends[k.min(bins - 1)].get_or_insert((i, i));
        if q.y < family.points[end.0].y {
            end.0 = i;
        }
        if q.y > family.points[end.1].y {
            end.1 = i;
        }
    }
    let mut out = few.to_vec();
    out.extend(ends.into_iter().flatten().flat_map(|e| [e.0, e.1]));
    out.sort_unstable();
    out.dedup();
    out
}

/// The best cylinder or cone near a candidate if it reaches the tolerance.
fn simple(
    candidate: &Candidate,
    slopes: Slopes,
    kind: PanelKind,
    samples: &[Sample],
    (few, all): (&[usize], &[usize]),
    tolerance: f64,
) -> Option<Fit> {
    // Least-squares fits whose largest distance exceeds this many tolerances do not come below it by minimax steps.
    const PROMISING: f64 = 2.5;
    let unit = candidate.unit;
    let (mut family, x) = candidate.family.changed(&candidate.x, candidate.family.breaks.clone(), slopes.clone())?;
    let (x, worst) = descended(&mut family, x, few, 6, 0)?;
    if worst * unit > PROMISING * tolerance {
        return None;
    }
    let (a, b) = family.foot_range();
    let count = family.breaks.len() - 1;
    let (mut family, mut x) = family.changed(&x, spans(a, b, count), slopes)?;
    let reached = polished(&mut family, &mut x, few, all, GOAL * tolerance / unit)?;
    if reached * unit > tolerance {
        return None;
    }
    finished(candidate.frame, unit, &family, &x, kind, samples).filter(|fit| fit.error <= tolerance)
}

/// The torse in mm on a domain that reaches a little beyond the feet of all points of the family (the samples come first),
/// with its measured error.
pub(crate) fn finished(
    frame: Frame,
    unit: f64,
    family: &ProfileFamily,
    x: &[f64],
    kind: PanelKind,
    samples: &[Sample],
) -> Option<Fit> {
    let power_form = family.power_form(x);
    let PowerForm::Primal { profile, .. } = &power_form else { return None };
    // Feet of all samples, wherever they are on the continued torse.
    let (lo, hi) = profile.domain();
    let wide = (lo - 0.5 * (hi - lo), hi + 0.5 * (hi - lo));
    let (mut a, mut b) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut feet = Vec::with_capacity(samples.len());
    for (q, &guess) in family.points.iter().zip(&family.feet) {
        let t = power_form.foot(q, guess, wide)?;
        (a, b) = (a.min(t), b.max(t));
        feet.push(t * unit);
    }
    let margin = MARGIN * (b - a);
    // An end piece shorter than a quarter of a span would have ill-conditioned knots.
    let shortest = 0.25 * (hi - lo) / profile.power.len() as f64;
    let on = profile.on(a - margin, b + margin, shortest);
    let beta = power_form.slope(on.breaks[0]);
    let scaled = Pieces {
        breaks: on.breaks.iter().map(|t| t * unit).collect(),
        power: on
            .power
            .iter()
            .map(|p| std::array::from_fn(|k| [p[k][0] * unit.powi(1 - k as i32), p[k][1] * unit.powi(-(k as i32))]))
            .collect(),
    };
    let torse = Torse::Primal(PrimalTorse::new(frame, scaled.to_curve().ok()?, beta));
    let (error, worst) = measure(&PowerForm::of(&torse)?, samples, &mut feet)?;
    Some(Fit { torse, kind, error, worst })
}

/// The family of a torse over points (mm) in coordinates of about unit size, its coefficients, and the unit (mm).
pub(crate) fn scaled(torse: &PrimalTorse, kind: PanelKind, points: &[Vec3]) -> Option<(ProfileFamily, Vec<f64>, f64)> {
    let pieces = Pieces::of(torse.profile())?;
    let (lo, hi) = pieces.domain();
    let unit = (hi - lo) / (1.0 + 2.0 * MARGIN);
    let breaks: Vec<f64> = pieces.breaks.iter().map(|t| t / unit).collect();
    let slopes = match kind {
        PanelKind::Plane | PanelKind::Cylinder => Slopes::Constant,
        PanelKind::Cone => Slopes::Affine,
        PanelKind::Torse | PanelKind::Ruled => Slopes::Spline(coarse_breaks(&pieces, &breaks)),
    };
    let scaled = Pieces {
        breaks: breaks.clone(),
        power: pieces
            .power
            .iter()
            .map(|p| std::array::from_fn(|k| [p[k][0] * unit.powi(k as i32 - 1), p[k][1] * unit.powi(k as i32)]))
            .collect(),
    };
    let points: Vec<Vec3> = points.iter().map(|x| torse.frame.to_local(x) / unit).collect();
    let feet = points.iter().map(|q| q.x).collect();
    let family = ProfileFamily::new(points, feet, breaks, slopes)?;
    let x = family.coefficients(&scaled, torse.beta());
    Some((family, x, unit))
}

/// Continues the minimax iteration of a primal torse over samples that may have been added.
pub(crate) fn refit(torse: &PrimalTorse, kind: PanelKind, samples: &[Sample], options: &RefitOptions) -> Option<Fit> {
    let points: Vec<Vec3> = samples.iter().map(|s| s.x).collect();
    let (mut family, mut x, unit) = scaled(torse, kind, &points)?;
    family.control = options.control.clone();
    let all: Vec<usize> = (0..samples.len()).collect();
    let few = thin(samples, options.max_samples.max(12));
    let mut residual = Vec::new();
    if family.residuals(&x, &all, &mut residual) {
        family.adopt(&all);
    }
    family.keep_margin(&x, RegularityMargin { clearance: 0.0, bend_radius: options.bend_radius / unit });
    polished(&mut family, &mut x, &few, &all, GOAL * options.tolerance / unit)?;
    finished(torse.frame, unit, &family, &x, kind, samples)
}

/// Breaks at which the third derivative of a jumps, ends included.
fn coarse_breaks(pieces: &Pieces<2>, breaks: &[f64]) -> Vec<f64> {
    // Below this share of the largest third derivative a jump is rounding.
    const JUMP: f64 = 1e-7;
    let third: Vec<f64> = pieces.power.iter().map(|p| p[3][1]).collect();
    let most = largest(&third);
    let mut out = vec![breaks[0]];
    for s in 1..third.len() {
        if (third[s] - third[s - 1]).abs() > JUMP * most {
            out.push(breaks[s]);
        }
    }
    out.push(breaks[breaks.len() - 1]);
    out
}
