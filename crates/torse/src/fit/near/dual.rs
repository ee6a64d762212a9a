//! Fitting a dual torse: the envelope of a cubic spline of planes, for long strips whose normals turn far.
//!
//! *Method*: dual-and-approximation specification B3.5 (tangent planes along a centre line, distances at exact feet,
//! gauges), finished by linearised minimax steps with exchange of the worst samples.

use super::descent::RefitOptions;
use super::descent::GOAL;
use super::descent::{descended, polished, repaired, Family};
use super::envelope::EnvelopeFamily;
use super::power_form::{PowerForm, RegularityMargin};
use super::samples::{measure, thin, Fit, Sample, MARGIN};
use crate::control::Control;
use crate::geom::{BBox, Vec3};
use crate::num::least_squares::{BandMatrix, Rows};
use crate::spline::knots::Knots;
use crate::spline::pieces::Pieces;
use crate::torse::form::{DualTorse, PanelKind, Ruling, Torse};

/// Options of [`dual`].
#[derive(Clone, Debug)]
pub struct DualOptions {
    /// Wanted distance, mm: the fit ends early below it.
    pub tolerance: f64,
    /// Spans of the plane spline; 26. Fewer make the regularity test fail for no good reason.
    pub spans: usize,
    /// Samples that take part at first; 300.
    pub max_samples: usize,
    /// Wanted distance along rulings between samples and regression curve, mm; 0. Kept as far as the start allows.
    pub clearance: f64,
    /// Wanted radius of curvature at the samples, mm; 0. Kept as far as the start allows.
    pub bend_radius: f64,
    /// Radius of curvature at the samples below which other starts are tried, mm; 0.
    pub least_bend_radius: f64,
    /// Ends the fit early with the best torse so far; never.
    pub control: Control,
}

impl DualOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            spans: 26,
            max_samples: 300,
            clearance: 0.0,
            bend_radius: 0.0,
            least_bend_radius: 0.0,
            control: Control::default(),
        }
    }
}

/// Scaled coordinates: `X = center + unit · Y`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    center: Vec3,
    pub(crate) unit: f64,
}

impl Scale {
    pub(crate) fn of(samples: &[Sample]) -> Option<Self> {
        let bbox = BBox::of(samples.iter().map(|s| &s.x));
        let unit = 0.5 * bbox.diagonal();
        (unit > 0.0 && unit.is_finite()).then(|| Self { center: bbox.center(), unit })
    }

    pub(crate) fn point(&self, x: &Vec3) -> Vec3 {
        (x - self.center) / self.unit
    }

    /// Plane coordinates `(n, h)` in the scaled system from those in mm.
    pub(crate) fn plane(&self, p: &[f64; 4]) -> [f64; 4] {
        let nc = p[0] * self.center.x + p[1] * self.center.y + p[2] * self.center.z;
        [p[0], p[1], p[2], (p[3] - nc) / self.unit]
    }

    /// Plane coordinates in mm.
    pub(crate) fn plane_back(&self, p: &[f64; 4]) -> [f64; 4] {
        let nc = p[0] * self.center.x + p[1] * self.center.y + p[2] * self.center.z;
        [p[0], p[1], p[2], p[3] * self.unit + nc]
    }
}

/// The dual torse nearest to the samples of a strip in the sense of the largest distance, started from the tangent
/// planes along `centre`: rulings at points of a centre line, conjugate to it.
///
/// *Input*: at least 6 samples and 4 rulings in order along the strip, with normals that are continuous along it (directions may
/// have any sign); the line should run nearly the whole length of the strip. *Result*: a fit whose domain reaches beyond all feet and whose regression curve is clear of all
/// samples; of several starts the first wins whose fit has the room that is needed, and no other is tried after a fit that is
/// too far away for room to matter. `None` if no regular start exists (inflections, asymptotic centre lines, foldings), or
/// with too few or invalid data. *Not guaranteed*: that the error is within the tolerance, or that the room wanted is kept.
pub fn dual(samples: &[Sample], centre: &[Ruling], options: &DualOptions) -> Option<Fit> {
    // Shares of the parameter range by which the start reaches beyond the centre line, with weights of third
    // differences: light ones leave the data alone to about their cube, heavy ones iron out a wavy centre line.
    const STARTS: [(f64, f64); 4] = [(0.12, 1e-3), (0.4, 1e-3), (0.12, 1.0), (0.4, 1.0)];
    if samples.len() < 6 || centre.len() < 4 {
        return None;
    }
    let scale = Scale::of(samples)?;
    let parameters = strip_parameters(centre, scale.unit)?;
    // The first fit that has room enough; else the first.
    let mut first = None;
    for (reach, smooth) in STARTS {
        if first.is_some() && options.control.stopped() {
            break;
        }
        let start = start_planes(centre, &parameters, &scale, options.spans.max(4), reach, smooth);
        match start.and_then(|start| fitted(samples, &scale, start, options)) {
            Some((fit, true)) => return Some(fit),
            Some((fit, false)) if first.is_none() && fit.error > USELESS * options.tolerance => return Some(fit),
            Some((fit, false)) => first = first.or(Some(fit)),
            None => {}
        }
    }
    first
}

/// The envelope of the tangent planes along `centre` as a cubic spline of planes with `spans` spans, exactly developable,
/// least-squares near the given planes; its domain reaches beyond both ends of the line by `reach` of its range.
/// `None` for fewer than four points, or planes that do not turn.
pub(crate) fn envelope(centre: &[Ruling], spans: usize, reach: f64) -> Option<Torse> {
    // Third differences of the planes count as little as in the first start of [`dual`].
    const SMOOTH: f64 = 1e-3;
    if centre.len() < 4 {
        return None;
    }
    let bbox = BBox::of(centre.iter().map(|c| &c.point));
    let scale = Scale { center: bbox.center(), unit: 0.5 * bbox.diagonal() };
    let parameters = strip_parameters(centre, scale.unit)?;
    let pieces = start_planes(centre, &parameters, &scale, spans.max(4), reach, SMOOTH)?;
    let mut planes = pieces.to_curve().ok()?;
    for c in &mut planes.control {
        *c = scale.plane_back(c);
    }
    Some(Torse::Dual(DualTorse { planes }))
}

/// Parameters in [0, 1]: normalised arc length plus normalised length of the Gauss image.
fn strip_parameters(centre: &[Ruling], unit: f64) -> Option<Vec<f64>> {
    let mut sums = vec![(0.0, 0.0)];
    for w in centre.windows(2) {
        let (s, g) = sums[sums.len() - 1];
        sums.push((s + (w[1].point - w[0].point).norm() / unit, g + (w[1].normal - w[0].normal).norm()));
    }
    let (length, turn) = sums[sums.len() - 1];
    if !(length > 0.0 && turn > 0.0 && (length + turn).is_finite()) {
        return None;
    }
    let t: Vec<f64> = sums.iter().map(|(s, g)| 0.5 * (s / length + g / turn)).collect();
    t.windows(2).all(|w| w[1] >= w[0]).then_some(t)
}

/// Least-squares spline through the tangent planes, on a domain that reaches beyond [0, 1].
fn start_planes(
    centre: &[Ruling],
    parameters: &[f64],
    scale: &Scale,
    spans: usize,
    reach: f64,
    smooth: f64,
) -> Option<Pieces<4>> {
    let knots = Knots::uniform(3, spans, -reach, 1.0 + reach).ok()?;
    let n = knots.control_count();
    let mut rows = Rows::new(n, 4);
    let mut matrix = BandMatrix::zeros(n, 4);
    let mut right = vec![vec![0.0; n]; 4];
    for (c, &t) in centre.iter().zip(parameters) {
        let b = knots.basis(t, 0);
        rows.push(b.first).1.copy_from_slice(&b.rows[0][..4]);
        let i = rows.len() - 1;
        matrix.add_row(&rows, i, 1.0);
        let plane = scale.plane(&[c.normal.x, c.normal.y, c.normal.z, c.normal.dot(&c.point)]);
        for (out, value) in right.iter_mut().zip(plane) {
            rows.scatter(i, value, out);
        }
    }
    let h = (1.0 + 2.0 * reach) / spans as f64;
    for w in knots.breaks().windows(2) {
        let span = knots.span(0.5 * (w[0] + w[1]));
        let (a, b) = (knots.basis_on_span(span, w[0], 2), knots.basis_on_span(span, w[1], 2));
        let (_, row) = rows.push(a.first);
        for j in 0..4 {
            row[j] = (b.rows[2][j] - a.rows[2][j]) * h * h;
        }
        matrix.add_row(&rows, rows.len() - 1, smooth * smooth * centre.len() as f64 / spans as f64);
    }
    if !matrix.factorise() {
        return None;
    }
    for r in &mut right {
        matrix.solve(r);
    }
    let control = (0..n).map(|i| std::array::from_fn(|c| right[c][i])).collect();
    Pieces::of(&crate::spline::curve::Curve::new(3, knots.values().to_vec(), control).ok()?)
}

/// The fit from given planes (scaled coordinates), and whether it has room enough.
fn fitted(samples: &[Sample], scale: &Scale, start: Pieces<4>, options: &DualOptions) -> Option<(Fit, bool)> {
    let points: Vec<Vec3> = samples.iter().map(|s| scale.point(&s.x)).collect();
    let mut few = thin(samples, options.max_samples.max(12));
    let all: Vec<usize> = (0..samples.len()).collect();
    let goal = GOAL * options.tolerance / scale.unit;
    let (mut family, start) = EnvelopeFamily::new(points, None, start)?;
    family.control = options.control.clone();
    let mut residual = Vec::new();
    if !family.residuals(&start, &all, &mut residual) {
        return None;
    }
    family.adopt(&all);
    let wanted = RegularityMargin { clearance: options.clearance, bend_radius: options.bend_radius }.scaled(scale.unit);
    family.keep_margin(&start, wanted);
    // Least squares, then a domain that suits the feet.
    let (x, _) = descended(&mut family, start.clone(), &few, 3, 0)?;
    let (x, _) = repaired(&mut family, x, &start, &mut few, &all, [3, 0])?;
    let (mut family, start) = family.refitted(&x, options.spans.max(4), MARGIN)?;
    family.keep_margin(&start, wanted);
    let (x, _) = descended(&mut family, start.clone(), &few, 3, 3)?;
    let (mut x, _) = repaired(&mut family, x, &start, &mut few, &all, [3, 3])?;
    let reached = polished(&mut family, &mut x, &few, &all, goal)? * scale.unit;
    // Feet that have strayed to another part of the torse spoil what is measured in the end.
    let fit = finished(samples, scale, &family, &x).filter(|fit| fit.error <= STRAYED * reached)?;
    let margin = RegularityMargin::least(&family.power_form(&x), &family.points, &family.feet);
    let regular_enough = margin.bend_radius * scale.unit >= options.least_bend_radius
        && margin.clearance * scale.unit >= NEARLY * options.clearance;
    Some((fit, regular_enough))
}

/// The torse in mm on a domain that reaches a little beyond the feet.
fn finished(samples: &[Sample], scale: &Scale, family: &EnvelopeFamily, x: &[f64]) -> Option<Fit> {
    let power_form = family.power_form(x);
    let PowerForm::Dual { planes } = &power_form else { return None };
    let (lo, hi) = planes.domain();
    let wide = (lo - 0.5 * (hi - lo), hi + 0.5 * (hi - lo));
    let (mut a, mut b) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut feet = Vec::with_capacity(samples.len());
    for (q, &guess) in family.points.iter().zip(&family.feet) {
        let t = power_form.foot(q, guess, wide)?;
        (a, b) = (a.min(t), b.max(t));
        feet.push(t);
    }
    let margin = MARGIN * (b - a);
    let on = planes.on(a - margin, b + margin, 0.25 * (hi - lo) / planes.power.len() as f64);
    let mut planes = on.to_curve().ok()?;
    for c in &mut planes.control {
        *c = scale.plane_back(c);
    }
    let torse = Torse::Dual(DualTorse { planes });
    let (error, worst) = measure(&PowerForm::of(&torse)?, samples, &mut feet)?;
    Some(Fit { torse, kind: PanelKind::Torse, error, worst })
}

/// Share of the clearance wanted that will do.
const NEARLY: f64 = 0.25;

/// A fit farther away than so many times the distance wanted will not be of use, whatever room it has.
const USELESS: f64 = 1.5;

/// A fit measured to be so many times as far away as it was found to be is none.
const STRAYED: f64 = 1.5;

/// Clearance that further iterations keep where it is at hand, share of half the diagonal.
const REFIT_CLEARANCE: f64 = 0.02;

/// Continues the minimax iteration of a dual torse over samples that may have been added.
pub(crate) fn refit(torse: &DualTorse, samples: &[Sample], options: &RefitOptions) -> Option<Fit> {
    let scale = Scale::of(samples)?;
    let mut planes = torse.planes.clone();
    for c in &mut planes.control {
        *c = scale.plane(c);
    }
    let points: Vec<Vec3> = samples.iter().map(|s| scale.point(&s.x)).collect();
    let (mut family, mut x) = EnvelopeFamily::new(points, None, Pieces::of(&planes)?)?;
    family.control = options.control.clone();
    let all: Vec<usize> = (0..samples.len()).collect();
    let mut residual = Vec::new();
    if !family.residuals(&x, &all, &mut residual) {
        return None;
    }
    family.adopt(&all);
    family.keep_margin(
        &x,
        RegularityMargin { clearance: REFIT_CLEARANCE, bend_radius: options.bend_radius / scale.unit },
    );
    let few = thin(samples, options.max_samples.max(12));
    polished(&mut family, &mut x, &few, &all, GOAL * options.tolerance / scale.unit)?;
    finished(samples, &scale, &family, &x)
}
