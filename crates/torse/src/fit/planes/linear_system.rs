//! Developables near given tangent planes: one linear system \[PW99, (9)\].
//!
//! *Method.* `F1 = Σ w_i d(V_i, U(v_i))²` over splines of planes `z = u0 + u1 x + u2 y` (type 2), each distance in the
//! measure of its own region of interest. *Not guaranteed*: anything between the given planes, a regular surface, or
//! distances of points; that is what the judge is for.

use super::functionals::{undetermined, Freedom, Functional, System};
use crate::geom::measure::{Measure, MeasureError};
use crate::spline::knots::Knots;
use crate::torse::dual::{DualCurve, DualError};

/// One given tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneDatum {
    /// Coordinates `(u0, u1, u2)` of `z = u0 + u1 x + u2 y` in the common frame.
    pub plane: [f64; 3],
    /// Parameter on the spline.
    pub parameter: f64,
    /// Region of interest.
    pub measure: Measure,
    /// Weight, not negative.
    pub weight: f64,
}

/// The weight that turns distances measured along z into distances perpendicular to the plane:
/// `sin² γ = 1 / (1 + u1² + u2²)` \[PW99, 4.2\].
pub fn slope_weight(plane: &[f64; 3]) -> f64 {
    1.0 / (1.0 + plane[1] * plane[1] + plane[2] * plane[2])
}

/// Why planes cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanesError {
    /// A number of a datum is not finite, or its weight is negative.
    #[error("{what} {index} has a coordinate, parameter or weight {value} that cannot be used")]
    Datum {
        /// What it is.
        what: &'static str,
        /// Its index.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A parameter outside the domain of the knots.
    #[error("{what} {index} has the parameter {value} outside the knots' domain [{from}, {to}]")]
    Parameter {
        /// What it is.
        what: &'static str,
        /// Its index.
        index: usize,
        /// The parameter.
        value: f64,
        /// Start of the domain.
        from: f64,
        /// End of the domain.
        to: f64,
    },
    /// Parameters that must increase do not.
    #[error("the parameter {value} of plane {index} does not increase: remove the repeated plane or sort the planes")]
    Order {
        /// Index of the plane.
        index: usize,
        /// Its parameter.
        value: f64,
    },
    /// The measure of a datum is concentrated in a line.
    #[error("plane {index}: {reason}")]
    Measure {
        /// Index of the plane.
        index: usize,
        /// What is wrong.
        reason: MeasureError,
    },
    /// The planes do not determine the spline (Schoenberg–Whitney).
    #[error("the data do not determine control plane {control} of {count}: give more planes there, fewer knots, or smoothing above 0")]
    Undetermined {
        /// Index of the control plane.
        control: usize,
        /// Number of control planes.
        count: usize,
    },
    /// A condition on a control plane that does not exist or is not finite.
    #[error("the condition on control plane {control} cannot be used: there are {count} control planes")]
    Condition {
        /// Index of the control plane.
        control: usize,
        /// Number of control planes.
        count: usize,
    },
    /// The result is no spline of planes.
    #[error(transparent)]
    Dual(#[from] DualError),
}

/// Options of [`planes`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanesOptions {
    /// Weight of `∫ |U''|²` as a share of the weight of the data; 0.
    pub smoothing: f64,
    /// Conditions on control planes: fixed ones, or on a pencil; none.
    pub conditions: Vec<(usize, Freedom<3>)>,
    /// Whether planes far from the rest lose their weight (Tukey's biweight); false.
    pub robust: bool,
}

/// A fitted curve of planes.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanesFit {
    /// The surface, of type (2).
    pub curve: DualCurve,
    /// `F1` with the given weights.
    pub cost: f64,
    /// Root mean square distance of the planes over their regions, for each datum, mm.
    pub distances: Vec<f64>,
    /// Factor that the robust iteration gave each weight; 1 without it.
    pub trust: Vec<f64>,
}

/// The condition that the surface starts (or ends) with the ruling whose ground plan is `l0 + l1 x + l2 y = 0` in the
/// plane `end`: the second (or last but one) control plane stays in the pencil of planes through that ruling. Use
/// together with `Freedom::Fixed(end)` for the end plane.
pub fn ruling_condition(end: [f64; 3], ground_plan: [f64; 3]) -> Freedom<3> {
    Freedom::Line { base: end, direction: ground_plan }
}

/// The developable of type (2) over `knots` with least [`F1`](self) to the planes.
///
/// *Input*: finite data, parameters inside the domain in any order, measures that are not concentrated in a line.
/// *Cost*: linear in planes and control planes.
///
/// # Errors
/// See [`PlanesError`].
pub fn planes(data: &[PlaneDatum], knots: &Knots, options: &PlanesOptions) -> Result<PlanesFit, PlanesError> {
    let roots = checked(data, knots)?;
    let freedoms = freedoms(knots, &options.conditions)?;
    if options.smoothing <= 0.0 {
        let parameters: Vec<f64> = data.iter().filter(|d| d.weight > 0.0).map(|d| d.parameter).collect();
        let bound = |i: usize| freedoms[i] != Freedom::Free;
        if let Some(control) = undetermined(knots, &parameters, bound) {
            return Err(PlanesError::Undetermined { control, count: freedoms.len() });
        }
    }
    let mut trust = vec![1.0; data.len()];
    let mut control = solved(data, &roots, knots, &freedoms, options.smoothing, &trust)?;
    if options.robust {
        for round in 0..ROBUST_ROUNDS {
            let distances = distances(data, &roots, knots, &control);
            trust = robust_weights(&distances, round);
            control = solved(data, &roots, knots, &freedoms, options.smoothing, &trust)?;
        }
    }
    fit_of(data, &roots, knots, control, trust)
}

/// Reweightings of a robust fit; the weights settle within a few.
pub(crate) const ROBUST_ROUNDS: usize = 12;

/// The curve with its distances.
pub(crate) fn fit_of(
    data: &[PlaneDatum],
    roots: &[[[f64; 3]; 3]],
    knots: &Knots,
    control: Vec<[f64; 3]>,
    trust: Vec<f64>,
) -> Result<PlanesFit, PlanesError> {
    let distances = distances(data, roots, knots, &control);
    let cost = distances.iter().zip(data).map(|(d, p)| p.weight * d * d * p.measure.mass()).sum();
    let curve = DualCurve::graph(knots.degree(), knots.values().to_vec(), &control)?;
    Ok(PlanesFit { curve, cost, distances, trust })
}

/// Checks the data and returns the roots of their Gram matrices.
pub(crate) fn checked(data: &[PlaneDatum], knots: &Knots) -> Result<Vec<[[f64; 3]; 3]>, PlanesError> {
    let (from, to) = knots.domain();
    data.iter()
        .enumerate()
        .map(|(index, d)| {
            let what = "plane";
            if let Some(&value) = d.plane.iter().chain([&d.parameter, &d.weight]).find(|x| !x.is_finite()) {
                return Err(PlanesError::Datum { what, index, value });
            }
            if d.weight < 0.0 {
                return Err(PlanesError::Datum { what, index, value: d.weight });
            }
            if d.parameter < from || d.parameter > to {
                return Err(PlanesError::Parameter { what, index, value: d.parameter, from, to });
            }
            d.measure.root().map_err(|reason| PlanesError::Measure { index, reason })
        })
        .collect()
}

/// Freedoms of all control planes.
pub(crate) fn freedoms<const D: usize>(
    knots: &Knots,
    conditions: &[(usize, Freedom<D>)],
) -> Result<Vec<Freedom<D>>, PlanesError> {
    let count = knots.control_count();
    let mut out = vec![Freedom::Free; count];
    for &(control, f) in conditions {
        let finite = match f {
            Freedom::Free => true,
            Freedom::Fixed(p) => p.iter().all(|x| x.is_finite()),
            Freedom::Line { base, direction } => {
                base.iter().chain(&direction).all(|x| x.is_finite()) && direction != [0.0; D]
            }
        };
        match out.get_mut(control) {
            Some(slot) if finite => *slot = f,
            _ => return Err(PlanesError::Condition { control, count }),
        }
    }
    Ok(out)
}

fn solved(
    data: &[PlaneDatum],
    roots: &[[[f64; 3]; 3]],
    knots: &Knots,
    freedoms: &[Freedom<3>],
    smoothing: f64,
    trust: &[f64],
) -> Result<Vec<[f64; 3]>, PlanesError> {
    let mut system = system(data, roots, knots, freedoms, trust);
    if let (true, Some(root)) = (smoothing > 0.0, mean_root(data)) {
        system.add_smoothing(smoothing, &root);
    }
    system.solved(0.0).ok_or(PlanesError::Undetermined { control: 0, count: freedoms.len() })
}

/// The conditions of (9), each with its weight and `trust` (1 where that is missing).
pub(crate) fn system<'a>(
    data: &[PlaneDatum],
    roots: &[[[f64; 3]; 3]],
    knots: &'a Knots,
    freedoms: &'a [Freedom<3>],
    trust: &[f64],
) -> System<'a, 3> {
    let mut system = System::new(knots, freedoms);
    let zero = [0.0; 3];
    for ((d, root), factor) in data.iter().zip(roots).zip(trust.iter().chain(std::iter::repeat(&1.0))) {
        for r in root {
            let value = (0..3).map(|i| r[i] * d.plane[i]).sum();
            system.add(&Functional {
                t: d.parameter,
                coefficients: [*r, zero, zero],
                value,
                weight: d.weight * factor,
            });
        }
    }
    system
}

/// Root of the mean Gram matrix: the metric in which bending is measured.
pub(crate) fn mean_root(data: &[PlaneDatum]) -> Option<[[f64; 3]; 3]> {
    let mut sum = data.first()?.measure;
    for d in &data[1..] {
        sum = sum.plus(&d.measure);
    }
    sum.scaled(1.0 / data.len() as f64).root().ok()
}

/// Root mean square distances over the regions.
fn distances(data: &[PlaneDatum], roots: &[[[f64; 3]; 3]], knots: &Knots, control: &[[f64; 3]]) -> Vec<f64> {
    data.iter()
        .zip(roots)
        .map(|(d, root)| {
            let basis = knots.basis(d.parameter, 0);
            let mut e = d.plane.map(|x| -x);
            for j in 0..=knots.degree() {
                for i in 0..3 {
                    e[i] += basis.rows[0][j] * control[basis.first + j][i];
                }
            }
            let sq: f64 = root.iter().map(|r| (0..3).map(|i| r[i] * e[i]).sum::<f64>().powi(2)).sum();
            (sq / d.measure.mass()).sqrt()
        })
        .collect()
}

/// Huber's weights in the first rounds, which cannot be trapped, then Tukey's, which reject.
pub(crate) fn robust_weights(residuals: &[f64], round: usize) -> Vec<f64> {
    // Usual constants: 95 % efficiency for normal noise; 1.4826 turns a median into a standard deviation.
    const HUBER: f64 = 1.345;
    const TUKEY: f64 = 4.685;
    const MEDIAN: f64 = 1.4826;
    let mut sorted: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    let scale = MEDIAN * sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    if scale <= 0.0 {
        return vec![1.0; residuals.len()];
    }
    residuals
        .iter()
        .map(|r| {
            let x = r.abs() / scale;
            if round < ROBUST_ROUNDS / 3 {
                (HUBER / x).min(1.0)
            } else {
                let y = x / TUKEY;
                if y < 1.0 {
                    (1.0 - y * y) * (1.0 - y * y)
                } else {
                    0.0
                }
            }
        })
        .collect()
}

/// The developable of type (2) of the given degree through all planes, knots by averaging the parameters.
///
/// *Input*: parameters increasing, more planes than the degree. *Method*: \[PT97, 9.2.1\] for the coordinates of planes.
///
/// # Errors
/// See [`PlanesError`].
pub fn interpolated(planes_: &[[f64; 3]], parameters: &[f64], degree: usize) -> Result<DualCurve, PlanesError> {
    if let Some(index) = parameters.windows(2).position(|w| w[0].is_nan() || w[1].is_nan() || w[0] >= w[1]) {
        return Err(PlanesError::Order { index: index + 1, value: parameters[index + 1] });
    }
    let n = planes_.len().min(parameters.len());
    if n <= degree || degree == 0 {
        return Err(PlanesError::Undetermined { control: n, count: degree + 1 });
    }
    let mut values = vec![parameters[0]; degree + 1];
    for i in 1..n - degree {
        values.push(parameters[i..i + degree].iter().sum::<f64>() / degree as f64);
    }
    values.extend(vec![parameters[n - 1]; degree + 1]);
    let knots = Knots::new(degree, values, n).map_err(DualError::from)?;
    let disc = Measure::disc([0.0, 0.0], 2.0).map_err(|reason| PlanesError::Measure { index: 0, reason })?;
    let data: Vec<PlaneDatum> = planes_
        .iter()
        .zip(parameters)
        .map(|(&plane, &parameter)| PlaneDatum { plane, parameter, measure: disc, weight: 1.0 })
        .collect();
    Ok(planes(&data, &knots, &PlanesOptions::default())?.curve)
}
