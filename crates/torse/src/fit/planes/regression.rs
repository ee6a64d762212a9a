//! Keeping the regression curve out of a zone: a convex quadratic program \[PW99, 4.4, Lemmas 5 and 6\].
//!
//! *Method.* For type (3) the regression point of ruling t has `x = −u0''/u1''`. It stays off `[a, b]` if the curve
//! `(u0'', u1'')` stays in one of two opposite wedges, `± (u0'' + a u1'') > 0` and `± (u0'' + b u1'') > 0`: both sections
//! x = a and x = b are strictly convex in the same sense. Control points in the wedge suffice (exactly for degree 3);
//! both wedges are tried, the nearer fit is kept.
//!
//! *Departure*: the paper walks along the faces of the polyhedron and never releases a constraint; that is wrong in
//! general (a test shows a counterexample). A dual active-set method for few unknowns and an interior-point method
//! for many take its place. The conditions have a margin, since they are strict.

use super::linear_system::{freedoms, PlanesError};
use super::rulings::{fit_of, normal, slope_fit, system, trusted, SlopeData, SlopeFit, SlopeOptions};
use crate::num::quadratic_program::{Minimum, QuadraticProgram, QuadraticProgramError};
use crate::spline::knots::Knots;
use crate::torse::dual::DualCurve;
use nalgebra::DMatrix;

/// Where the regression curve must not be, in the frame of the fit (type (3): rulings run along x).
#[derive(Clone, Debug, PartialEq)]
pub enum ForbiddenZone {
    /// All points with x in the interval, mm.
    Slab(f64, f64),
    /// A box. Rulings that miss it are free, the others keep off the part of them in it; which ones these are is found
    /// in rounds of fits.
    Box {
        /// Smallest coordinates, mm.
        min: [f64; 3],
        /// Largest coordinates, mm.
        max: [f64; 3],
    },
    /// The panel itself: at parameters t, in increasing order, its extent in x, with a clearance on both sides, mm.
    /// Different rulings then have different intervals.
    Outline {
        /// `(t, smallest x, largest x)`.
        extent: Vec<(f64, f64, f64)>,
        /// Free distance in x beyond the outline, mm.
        clearance: f64,
    },
}

/// The interval of x in which the ruling t of a surface is out of bounds; `None` where it is free.
pub(crate) type Forbidden<'a> = dyn Fn(&DualCurve, f64) -> Option<(f64, f64)> + 'a;

/// Options of [`regression_free`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegressionOptions {
    /// Fit options.
    pub fit: SlopeOptions,
    /// Margin of the conditions in units of the second derivatives; `None`: 1e-6 of the largest of the free fit.
    pub margin: Option<f64>,
    /// Halvings of the spans on which control points of the second derivative are held in the wedge, for degrees
    /// above 3; 0: the control points of its spline.
    pub refinements: usize,
}

/// Why the regression curve cannot be controlled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegressionError {
    /// The fit itself.
    #[error(transparent)]
    Planes(#[from] PlanesError),
    /// A zone without extent or with ends that are not finite.
    #[error("the forbidden zone [{a}, {b}] is not an interval")]
    Zone {
        /// Start.
        a: f64,
        /// End.
        b: f64,
    },
    /// No surface of this spline space and side avoids the zone.
    #[error("no spline over these knots keeps the regression curve out of the zone: {0}; free the conditions or narrow the zone")]
    Infeasible(QuadraticProgramError),
    /// Rulings move so that the zone is met after every round of fits.
    #[error("the regression curve still meets the zone after all rounds of fits: narrow the zone")]
    Rounds,
    /// Degree 1 has no second derivative; a knot where the planes are only continuous has none either.
    #[error("second derivatives are not splines here (degree {degree}, knot {knot}): split the surface there")]
    NoSecondDerivative {
        /// Degree.
        degree: usize,
        /// Knot value.
        knot: f64,
    },
}

/// A fit whose regression curve avoids the zone.
#[derive(Clone, Debug, PartialEq)]
pub struct RegressionFit {
    /// The nearer of the two fits.
    pub fit: SlopeFit,
    /// Its side: +1 if both second derivatives in the wedge are positive, −1 if negative.
    pub side: f64,
    /// `F3` of the fits with positive and negative side; `None` where there is none.
    pub costs: [Option<f64>; 2],
    /// `F3` without the condition.
    pub free_cost: f64,
    /// Margin that was used.
    pub margin: f64,
}

/// The fit of type (3) with least `F3` whose regression curve is outside the zone.
///
/// *Guarantee*: at every ruling the second derivatives lie in one wedge, up to the solver's accuracy against the
/// margin. *Not guaranteed*: that it stays on one side of the zone; it may pass through infinity.
///
/// # Errors
/// See [`RegressionError`].
pub fn regression_free(
    data: &SlopeData,
    knots: &Knots,
    zone: &ForbiddenZone,
    options: &RegressionOptions,
) -> Result<RegressionFit, RegressionError> {
    let program = Program::new(data, knots, options)?;
    if let (ForbiddenZone::Box { min, max }, Some(free)) = (zone, &program.free) {
        zone.over(knots.domain().0, knots.domain().1)?;
        let part = |c: &DualCurve, t: f64| part_in_box(c, t, [min, max]);
        if let Ok(Some(found)) = in_rounds(free, &program, &part) {
            return Ok(found);
        }
    }
    let zones = program.rows.iter().map(|r| zone.over(r.from, r.to).map(Some)).collect::<Result<Vec<_>, _>>()?;
    program.solve(&zones)
}

/// As [`regression_free`] for zones that depend on the rulings: `forbidden` gives the interval of x in which the ruling t
/// of a surface is out of bounds, `None` where it is free. Found in rounds of fits; conditions are never taken back.
/// *Not guaranteed*: rulings between those looked at.
///
/// # Errors
/// See [`RegressionError`]; an unreachable zone if rounds do not end.
pub fn regression_free_where(
    data: &SlopeData,
    knots: &Knots,
    forbidden: &Forbidden,
    options: &RegressionOptions,
) -> Result<RegressionFit, RegressionError> {
    let program = Program::new(data, knots, options)?;
    let start = match &program.free {
        Some(free) => free.clone(),
        // Without a free fit the first round starts from one that any zone allows.
        None => program.solve(&vec![Some((0.0, 0.0)); program.rows.len()])?.fit,
    };
    in_rounds(&start, &program, forbidden)?.ok_or(RegressionError::Rounds)
}

/// The conditions of a fit, made ready.
struct Program<'a> {
    data: std::borrow::Cow<'a, SlopeData>,
    knots: &'a Knots,
    options: &'a RegressionOptions,
    rows: Vec<SecondDerivative>,
    margin: f64,
    free: Option<SlopeFit>,
}

impl<'a> Program<'a> {
    fn new(data: &'a SlopeData, knots: &'a Knots, options: &'a RegressionOptions) -> Result<Self, RegressionError> {
        let free = slope_fit(data, knots, &options.fit);
        // Data that the free fit does not trust do not pull here either.
        let trusted = free.as_ref().ok().filter(|_| options.fit.robust).map(|f| trusted(data, &f.trust));
        let data = trusted.map_or(std::borrow::Cow::Borrowed(data), std::borrow::Cow::Owned);
        let rows = second_derivative_rows(knots, options.refinements)?;
        let margin = match (options.margin, &free) {
            (Some(m), _) => m,
            (None, Ok(fit)) => {
                let control = fit.curve.graphs().control;
                let size = |r: &SecondDerivative| (0..2).map(|d| r.value(&control, d).abs()).fold(0.0, f64::max);
                RELATIVE_MARGIN * rows.iter().map(size).fold(f64::MIN_POSITIVE, f64::max)
            }
            (None, Err(e)) => return Err(e.clone().into()),
        };
        Ok(Self { data, knots, options, rows, margin, free: free.ok() })
    }

    /// The nearer of the fits with both sides, for one interval per condition.
    fn solve(&self, zones: &[Option<(f64, f64)>]) -> Result<RegressionFit, RegressionError> {
        let sides = [1.0, -1.0]
            .map(|side| one_side(&self.data, self.knots, (&self.rows, zones), side, self.margin, self.options));
        let costs = [0, 1].map(|i| sides[i].as_ref().ok().map(|f| f.cost));
        let [plus, minus] = sides;
        let (fit, side) = match (plus, minus) {
            (Ok(p), Ok(m)) if m.cost < p.cost => (m, -1.0),
            (Ok(p), _) => (p, 1.0),
            (Err(_), Ok(m)) => (m, -1.0),
            (Err(e), Err(_)) => return Err(e),
        };
        let free_cost = self.free.as_ref().map_or(f64::NAN, |f| f.cost);
        Ok(RegressionFit { fit, side, costs, free_cost, margin: self.margin })
    }
}

/// Fits in rounds: rulings of the last fit that are somewhere out of bounds keep off that part of them, and no condition
/// is taken back. `None` if regression points are still out of bounds after the last round.
fn in_rounds(
    start: &SlopeFit,
    program: &Program,
    forbidden: &Forbidden,
) -> Result<Option<RegressionFit>, RegressionError> {
    // Few are needed, since the rulings hardly move from one to the next.
    const ROUNDS: usize = 8;
    let mut zones: Vec<Option<(f64, f64)>> = vec![None; program.rows.len()];
    let mut planes = start.curve.clone();
    for _ in 0..ROUNDS {
        for (zone, row) in zones.iter_mut().zip(&program.rows) {
            for k in 0..=RULINGS {
                let t = row.from + (row.to - row.from) * k as f64 / RULINGS as f64;
                if let Some((a, b)) = forbidden(&planes, t) {
                    *zone = Some(zone.map_or((a, b), |(p, q)| (p.min(a), q.max(b))));
                }
            }
        }
        let found = program.solve(&zones)?;
        if !meets(&found.fit.curve, &program.rows, forbidden) {
            return Ok(Some(found));
        }
        planes = found.fit.curve;
    }
    Ok(None)
}

/// Rulings looked at for each condition.
const RULINGS: usize = 16;

/// The interval of x in which the ruling t is inside a box.
fn part_in_box(curve: &DualCurve, t: f64, [min, max]: [&[f64; 3]; 2]) -> Option<(f64, f64)> {
    let [u, d, _] = curve.graph_jet(t);
    // The ruling is y = −(u0' + u1' x), z = u0 + t y + u1 x.
    let (y, z) = ([-d[0], -d[1]], [u[0] - t * d[0], u[1] - t * d[1]]);
    let (mut a, mut b) = (min[0], max[0]);
    for ([c, s], k) in [(y, 1), (z, 2)] {
        let (p, q) = ((min[k] - c) / s, (max[k] - c) / s);
        if p.is_finite() && q.is_finite() {
            (a, b) = (a.max(p.min(q)), b.min(p.max(q)));
        } else if c < min[k] || c > max[k] {
            return None;
        }
    }
    (a <= b).then_some((a, b))
}

/// Whether a regression point at the rulings looked at is out of bounds.
fn meets(curve: &DualCurve, rows: &[SecondDerivative], forbidden: &Forbidden) -> bool {
    rows.iter().any(|row| {
        (0..=RULINGS).any(|k| {
            let t = row.from + (row.to - row.from) * k as f64 / RULINGS as f64;
            let second = curve.graph_jet(t)[2];
            let x = -second[0] / second[1];
            forbidden(curve, t).is_some_and(|(a, b)| x >= a && x <= b)
        })
    })
}

/// Margin as a share of the largest second derivative: the condition is strict, and solvers answer to about 1e-9.
const RELATIVE_MARGIN: f64 = 1e-6;

impl ForbiddenZone {
    /// The zone of a panel: its outline in the ground plan, cut by the rulings of a fit (the free one, say) at `stations`
    /// parameters, with a clearance in x on both sides, mm.
    ///
    /// *Input*: the vertices (x, y) of a polygon in the frame of the fit. *Not guaranteed*: the outline against rulings
    /// of another fit; repeat with it where they differ much.
    ///
    /// # Errors
    /// No ruling meets the outline, or one of its numbers is not finite.
    pub fn of_outline(
        fit: &DualCurve,
        outline: &[[f64; 2]],
        clearance: f64,
        stations: usize,
    ) -> Result<Self, RegressionError> {
        let (from, to) = fit.domain();
        let n = stations.max(2);
        let mut extent = Vec::new();
        for k in 0..n {
            let t = from + (to - from) * k as f64 / (n - 1) as f64;
            let d = fit.graph_jet(t)[1];
            let side = |p: &[f64; 2]| p[1] + d[0] + d[1] * p[0];
            let mut hull = (f64::INFINITY, f64::NEG_INFINITY);
            for (i, p) in outline.iter().enumerate() {
                let q = &outline[(i + 1) % outline.len()];
                let (a, b) = (side(p), side(q));
                if (a <= 0.0) != (b <= 0.0) {
                    let x = p[0] + (q[0] - p[0]) * a / (a - b);
                    hull = (hull.0.min(x), hull.1.max(x));
                }
            }
            if hull.0 <= hull.1 {
                extent.push((t, hull.0, hull.1));
            }
        }
        let usable = extent.iter().all(|e| e.1.is_finite() && e.2.is_finite()) && clearance.is_finite();
        if extent.is_empty() || !usable {
            return Err(RegressionError::Zone { a: f64::NAN, b: f64::NAN });
        }
        Ok(Self::Outline { extent, clearance })
    }

    /// Interval of x that is forbidden to rulings with parameters in `[from, to]`.
    fn over(&self, from: f64, to: f64) -> Result<(f64, f64), RegressionError> {
        let (a, b) = match self {
            Self::Slab(a, b) => (*a, *b),
            Self::Box { min, max } => (min[0], max[0]),
            Self::Outline { extent, clearance } => {
                let mut hull = (f64::INFINITY, f64::NEG_INFINITY);
                // Stations inside, and the ones on both sides.
                for (i, e) in extent.iter().enumerate() {
                    let before = i + 1 < extent.len() && extent[i + 1].0 < from;
                    let after = i > 0 && extent[i - 1].0 > to;
                    if !before && !after {
                        hull = (hull.0.min(e.1), hull.1.max(e.2));
                    }
                }
                (hull.0 - clearance, hull.1 + clearance)
            }
        };
        if a.is_finite() && b.is_finite() && a <= b {
            Ok((a, b))
        } else {
            Err(RegressionError::Zone { a, b })
        }
    }
}

/// One control value of the second derivative as a combination of control values of the function.
struct SecondDerivative {
    first: usize,
    factors: Vec<f64>,
    from: f64,
    to: f64,
}

impl SecondDerivative {
    fn value(&self, control: &[[f64; 3]], d: usize) -> f64 {
        self.factors.iter().zip(&control[self.first..]).map(|(f, c)| f * c[d]).sum()
    }
}

/// Control values of the second derivative: those of its B-spline, or Bernstein coefficients on parts of spans.
fn second_derivative_rows(knots: &Knots, refinements: usize) -> Result<Vec<SecondDerivative>, RegressionError> {
    let (k, v) = (knots.degree(), knots.values());
    if k < 2 {
        return Err(RegressionError::NoSecondDerivative { degree: k, knot: v[0] });
    }
    let (a, b) = knots.domain();
    if let Some((knot, _)) = knots.distinct().into_iter().find(|&(t, m)| t > a && t < b && m >= k) {
        return Err(RegressionError::NoSecondDerivative { degree: k, knot });
    }
    if refinements == 0 {
        let first = |i: usize| k as f64 / (v[i + k + 1] - v[i + 1]);
        let rows = (0..knots.control_count() - 2)
            .filter(|&j| v[j + k + 1] > v[j + 2])
            .map(|j| {
                let f = (k - 1) as f64 / (v[j + k + 1] - v[j + 2]);
                let (p, q) = (first(j), first(j + 1));
                let (from, to) = (v[j + 2].max(a), v[j + k + 1].min(b));
                SecondDerivative { first: j, factors: vec![f * p, -f * (p + q), f * q], from, to }
            })
            .collect();
        return Ok(rows);
    }
    // Values at nodes of each part, turned into Bernstein coefficients by one small inverse.
    let d = k - 2;
    let node = |i: usize| if d == 0 { 0.5 } else { i as f64 / d as f64 };
    let bernstein = DMatrix::from_fn(d + 1, d + 1, |i, j| {
        let x = node(i);
        crate::num::binomial::binomial(d, j) * x.powi(j as i32) * (1.0 - x).powi((d - j) as i32)
    });
    let inverse = bernstein.try_inverse().ok_or(RegressionError::NoSecondDerivative { degree: k, knot: a })?;
    let parts = 1usize << refinements.min(6);
    let mut out = Vec::new();
    for w in knots.breaks().windows(2) {
        let span = knots.span(0.5 * (w[0] + w[1]));
        for part in 0..parts {
            let at = |s: f64| w[0] + (w[1] - w[0]) * (part as f64 + s) / parts as f64;
            let values: Vec<_> = (0..=d).map(|i| knots.basis_on_span(span, at(node(i)), 2).rows[2]).collect();
            for c in 0..=d {
                let factors = (0..=k).map(|j| (0..=d).map(|i| inverse[(c, i)] * values[i][j]).sum()).collect();
                out.push(SecondDerivative { first: span - k, factors, from: at(0.0), to: at(1.0) });
            }
        }
    }
    Ok(out)
}

/// For every row the least and greatest distance of the zone that it must leave; `None` where there is none.
type Zones = [Option<(f64, f64)>];

/// The fit whose regression curve stays on one side of every zone.
fn one_side(
    data: &SlopeData,
    knots: &Knots,
    (rows, zones): (&[SecondDerivative], &Zones),
    side: f64,
    margin: f64,
    options: &RegressionOptions,
) -> Result<SlopeFit, RegressionError> {
    let bound = freedoms(knots, &options.fit.conditions)?;
    let conditions = system(data, knots, &bound, options.fit.smoothing)?;
    let n = conditions.unknowns();
    let form = normal(&conditions);
    let mut program = QuadraticProgram::new(n);
    let width = 2 * (knots.degree() + 1);
    for i in 0..n {
        program.linear[i] = -form.right[i];
        for j in i.saturating_sub(width)..=i {
            program.add_hessian(j, i, form.matrix.entry(i, j));
        }
    }
    for (row, zone) in rows.iter().zip(zones) {
        let Some((a, b)) = *zone else { continue };
        for c in if a < b { vec![a, b] } else { vec![a] } {
            let mut terms: Vec<(usize, f64)> = Vec::new();
            let mut constant = 0.0;
            for (k, f) in row.factors.iter().enumerate() {
                let (t, rest) = conditions.terms(row.first + k, &[side * f, side * f * c]);
                terms.extend(t);
                constant += rest;
            }
            // Rows of unit length, so that the solver's tolerance means the same everywhere.
            let size = terms.iter().map(|t| t.1 * t.1).sum::<f64>().sqrt();
            let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
            program.at_least(terms.into_iter().map(|(i, x)| (i, scale * x)), scale * (margin - constant));
        }
    }
    let Minimum { x, .. } = program.solve().map_err(RegressionError::Infeasible)?;
    Ok(fit_of(data, knots, &conditions.control(&x))?)
}
