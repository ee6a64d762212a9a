//! Developables near given planes, rulings and points: type (3), one linear system \[PW99, (13)\].
//!
//! *Method.* The parameter is the slope u2 of the planes, so parameters are not chosen but given. Rulings are compared
//! in their ground plan, `(11)`; points by the distance of their ground plan from that of a ruling, `(12)`.

use super::functionals::{undetermined, Freedom, Functional, Normal, System};
use super::linear_system::{freedoms, robust_weights, PlaneDatum, PlanesError, ROBUST_ROUNDS};
use crate::geom::measure::LineMeasure;
use crate::spline::knots::Knots;
use crate::torse::dual::DualCurve;

/// A given ruling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RulingDatum {
    /// Slope parameter of its tangent plane.
    pub parameter: f64,
    /// Ground plan `h0 + h1 x + y = 0`.
    pub ground_plan: [f64; 2],
    /// Where along x it is compared.
    pub along: LineMeasure,
    /// Weight. Lengths here are y-lengths in the ground plan, those of planes are z-lengths times area: a weight of
    /// area times squared slope makes them comparable.
    pub weight: f64,
}

/// A given surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointDatum {
    /// Slope parameter of its tangent plane.
    pub parameter: f64,
    /// Ground plan (x, y).
    pub ground_plan: [f64; 2],
    /// Weight, as for rulings.
    pub weight: f64,
}

/// Data of a fit of type (3). The parameter of a plane must be its own slope `u2`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SlopeData {
    /// Planes.
    pub planes: Vec<PlaneDatum>,
    /// Rulings.
    pub rulings: Vec<RulingDatum>,
    /// Points.
    pub points: Vec<PointDatum>,
}

/// Options of [`slope_fit`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SlopeOptions {
    /// Weight of `∫ (u0''² + m u1''²)` as a share of the weight of the data, m being the mean x² of the regions; 0.
    pub smoothing: f64,
    /// Conditions on control values of `(u0, u1)`; none.
    pub conditions: Vec<(usize, Freedom<2>)>,
    /// Whether data far from the rest of their kind lose their weight (Tukey's biweight); false.
    pub robust: bool,
}

/// A fit of type (3).
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeFit {
    /// The surface.
    pub curve: DualCurve,
    /// `F3` with the given weights.
    pub cost: f64,
    /// Factors that the robust iteration gave the weights of planes, rulings and points; 1 without it.
    pub trust: Vec<f64>,
}

/// The developable of type (3) over `knots` with least `F3`.
///
/// *Input*: parameters inside the domain; those of planes equal to their slope.
///
/// # Errors
/// See [`PlanesError`].
pub fn slope_fit(data: &SlopeData, knots: &Knots, options: &SlopeOptions) -> Result<SlopeFit, PlanesError> {
    let bound = freedoms(knots, &options.conditions)?;
    let solved = |data: &SlopeData| -> Result<Vec<[f64; 2]>, PlanesError> {
        system(data, knots, &bound, options.smoothing)?
            .solved(0.0)
            .ok_or(PlanesError::Undetermined { control: 0, count: knots.control_count() })
    };
    let mut fit = fit_of(data, knots, &solved(data)?)?;
    if options.robust {
        for round in 0..ROBUST_ROUNDS {
            let trust: Vec<f64> =
                residuals(data, &fit.curve).iter().flat_map(|kind| robust_weights(kind, round)).collect();
            fit = fit_of(data, knots, &solved(&trusted(data, &trust))?)?;
            fit.trust = trust;
        }
    }
    Ok(fit)
}

/// The data with weights times factors.
pub(crate) fn trusted(data: &SlopeData, trust: &[f64]) -> SlopeData {
    let mut out = data.clone();
    let weights = out.planes.iter_mut().map(|d| &mut d.weight);
    let weights = weights.chain(out.rulings.iter_mut().map(|d| &mut d.weight));
    for (w, f) in weights.chain(out.points.iter_mut().map(|d| &mut d.weight)).zip(trust) {
        *w *= f;
    }
    out
}

/// Distances of planes, rulings and points, without weights.
fn residuals(data: &SlopeData, curve: &DualCurve) -> [Vec<f64>; 3] {
    let planes = data.planes.iter().map(|d| {
        let [u, ..] = curve.graph_jet(d.parameter);
        let e = [u[0] - d.plane[0], u[1] - d.plane[1], d.parameter - d.plane[2]];
        (d.measure.distance_sq(&e).max(0.0) / d.measure.mass()).sqrt()
    });
    let rulings = data.rulings.iter().map(|r| {
        let d = curve.graph_jet(r.parameter)[1];
        let (e, g) = ([r.ground_plan[0] - d[0], r.ground_plan[1] - d[1]], r.along.gram);
        (e[0] * (g[0][0] * e[0] + g[0][1] * e[1]) + e[1] * (g[1][0] * e[0] + g[1][1] * e[1])).max(0.0).sqrt()
    });
    let points = data.points.iter().map(|p| {
        let d = curve.graph_jet(p.parameter)[1];
        (d[0] + d[1] * p.ground_plan[0] + p.ground_plan[1]).abs()
    });
    [planes.collect(), rulings.collect(), points.collect()]
}

/// The surface with its cost.
pub(crate) fn fit_of(data: &SlopeData, knots: &Knots, control: &[[f64; 2]]) -> Result<SlopeFit, PlanesError> {
    let curve = DualCurve::slope(knots.degree(), knots.values().to_vec(), control)?;
    let mut cost = 0.0;
    for d in &data.planes {
        let [u, ..] = curve.graph_jet(d.parameter);
        cost += d.weight * d.measure.distance_sq(&[u[0] - d.plane[0], u[1] - d.plane[1], d.parameter - d.plane[2]]);
    }
    for r in &data.rulings {
        let d = curve.graph_jet(r.parameter)[1];
        let (e, g) = ([r.ground_plan[0] - d[0], r.ground_plan[1] - d[1]], r.along.gram);
        cost += r.weight * (e[0] * (g[0][0] * e[0] + g[0][1] * e[1]) + e[1] * (g[1][0] * e[0] + g[1][1] * e[1]));
    }
    for p in &data.points {
        let d = curve.graph_jet(p.parameter)[1];
        cost += p.weight * (d[0] + d[1] * p.ground_plan[0] + p.ground_plan[1]).powi(2);
    }
    let count = data.planes.len() + data.rulings.len() + data.points.len();
    Ok(SlopeFit { curve, cost, trust: vec![1.0; count] })
}

/// The linear conditions of a set of data.
pub(crate) fn system<'a>(
    data: &SlopeData,
    knots: &'a Knots,
    bound: &'a [Freedom<2>],
    smoothing: f64,
) -> Result<System<'a, 2>, PlanesError> {
    check(data, knots)?;
    if smoothing <= 0.0 && data.rulings.is_empty() && data.points.is_empty() {
        let parameters: Vec<f64> = data.planes.iter().filter(|d| d.weight > 0.0).map(|d| d.parameter).collect();
        if let Some(control) = undetermined(knots, &parameters, |i| bound[i] != Freedom::Free) {
            return Err(PlanesError::Undetermined { control, count: bound.len() });
        }
    }
    let mut system = System::new(knots, bound);
    let zero = [0.0; 2];
    let (mut mass, mut xx) = (0.0, 0.0);
    for (index, d) in data.planes.iter().enumerate() {
        let root = d.measure.root().map_err(|reason| PlanesError::Measure { index, reason })?;
        for r in &root[..2] {
            // The third component of the difference vanishes: the parameter is the slope.
            let value = r[0] * d.plane[0] + r[1] * d.plane[1] + r[2] * (d.plane[2] - d.parameter);
            system.add(&Functional {
                t: d.parameter,
                coefficients: [[r[0], r[1]], zero, zero],
                value,
                weight: d.weight,
            });
        }
        mass += d.measure.mass();
        xx += d.measure.gram()[1][1];
    }
    for r in &data.rulings {
        for row in r.along.root() {
            let value = row[0] * r.ground_plan[0] + row[1] * r.ground_plan[1];
            system.add(&Functional { t: r.parameter, coefficients: [zero, row, zero], value, weight: r.weight });
        }
    }
    for p in &data.points {
        let coefficients = [zero, [1.0, p.ground_plan[0]], zero];
        system.add(&Functional { t: p.parameter, coefficients, value: -p.ground_plan[1], weight: p.weight });
    }
    if smoothing > 0.0 {
        let reach = if mass > 0.0 { (xx / mass).sqrt() } else { 1.0 };
        system.add_smoothing(smoothing, &[[1.0, 0.0], [0.0, reach]]);
    }
    Ok(system)
}

/// Normal equations, for programs with further conditions.
pub(crate) fn normal(system: &System<'_, 2>) -> Normal {
    system.normal()
}

fn check(data: &SlopeData, knots: &Knots) -> Result<(), PlanesError> {
    // A plane's parameter is its slope up to rounding of the data, as a share of the domain.
    const SLOPE: f64 = 1e-9;
    let (from, to) = knots.domain();
    crate::fit::planes::linear_system::checked(&data.planes, knots)?;
    for (index, d) in data.planes.iter().enumerate() {
        if (d.parameter - d.plane[2]).abs() > SLOPE * (to - from) {
            return Err(PlanesError::Parameter {
                what: "plane",
                index,
                value: d.parameter,
                from: d.plane[2],
                to: d.plane[2],
            });
        }
    }
    let one = |what: &'static str, index: usize, t: f64, rest: &[f64]| {
        if let Some(&value) = rest.iter().chain([&t]).find(|x| !x.is_finite()) {
            return Err(PlanesError::Datum { what, index, value });
        }
        if t < from || t > to {
            return Err(PlanesError::Parameter { what, index, value: t, from, to });
        }
        Ok(())
    };
    for (i, r) in data.rulings.iter().enumerate() {
        one("ruling", i, r.parameter, &[r.ground_plan[0], r.ground_plan[1], r.weight])?;
        if r.weight < 0.0 {
            return Err(PlanesError::Datum { what: "ruling", index: i, value: r.weight });
        }
    }
    for (i, p) in data.points.iter().enumerate() {
        one("point", i, p.parameter, &[p.ground_plan[0], p.ground_plan[1], p.weight])?;
        if p.weight < 0.0 {
            return Err(PlanesError::Datum { what: "point", index: i, value: p.weight });
        }
    }
    Ok(())
}
