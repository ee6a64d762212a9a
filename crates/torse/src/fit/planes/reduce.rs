//! Developables near a given developable: fewer knots or a lower degree \[PW99, (10)\].
//!
//! *Method.* `F2 = ∫ d(V(t), U(t))² dt`, by Gauss rules that are exact on the common refinement of both knot vectors.
//! With one metric for all parameters the minimiser does not depend on it; only the value does.

use super::functionals::{Freedom, Functional, System};
use super::linear_system::{freedoms, robust_weights, PlanesError, ROBUST_ROUNDS};
use crate::geom::measure::Measure;
use crate::num::quadrature::gauss_legendre;
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::torse::dual::{DualCurve, DualError, DualKind};

/// Result of [`reduced`].
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    /// The surface over the new knots, of type (2), or of type (3) if the given one is.
    pub curve: DualCurve,
    /// `F2`.
    pub cost: f64,
    /// Root mean square distance in the measure, mm, at the worst quadrature node.
    pub worst_estimate: f64,
}

/// The developable over `knots` with least `F2` to `source` of type (2) or (3) with the same domain.
///
/// *Input*: `measure` gives the region of interest at a parameter; `keep_ends` fixes the first and last plane.
///
/// # Errors
/// A source of type (1), another domain, a measure that is concentrated in a line.
pub fn reduced(
    source: &DualCurve,
    knots: &Knots,
    measure: &dyn Fn(f64) -> Measure,
    keep_ends: bool,
) -> Result<Reduction, PlanesError> {
    reduction(source, knots, measure, keep_ends, 1)
}

/// As [`reduced`], but parts of the source that no spline over `knots` follows as well as the rest (a dent in a fitted
/// surface) lose their weight (Tukey's biweight at the quadrature nodes). The result depends on the measure.
///
/// # Errors
/// As [`reduced`].
pub fn reduced_robustly(
    source: &DualCurve,
    knots: &Knots,
    measure: &dyn Fn(f64) -> Measure,
    keep_ends: bool,
) -> Result<Reduction, PlanesError> {
    reduction(source, knots, measure, keep_ends, 1 + ROBUST_ROUNDS)
}

fn reduction(
    source: &DualCurve,
    knots: &Knots,
    measure: &dyn Fn(f64) -> Measure,
    keep_ends: bool,
    solutions: usize,
) -> Result<Reduction, PlanesError> {
    if source.kind() == DualKind::General {
        return Err(DualError::Kind { wanted: DualKind::Graph, kind: source.kind() }.into());
    }
    let ((a, b), (from, to)) = (source.domain(), knots.domain());
    if a != from || b != to {
        return Err(PlanesError::Parameter {
            what: "end",
            index: 0,
            value: if a != from { from } else { to },
            from: a,
            to: b,
        });
    }
    let graphs = source.graphs();
    let graph = |t: f64| graphs.point(t);
    let ends = [(0, Freedom::Fixed(graph(a))), (knots.control_count() - 1, Freedom::Fixed(graph(b)))];
    let bound = freedoms(knots, if keep_ends { &ends } else { &[] })?;
    let mut breaks = knots.breaks();
    breaks.extend(source.knots().breaks());
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let nodes = gauss_legendre(knots.degree().max(source.knots().degree()) + 1);
    let zero = [0.0; 3];
    let mut samples = Vec::new();
    for w in breaks.windows(2) {
        for (x, weight) in &nodes {
            let t = w[0] + (w[1] - w[0]) * x;
            let measure = measure(t);
            let root = measure.root().map_err(|reason| PlanesError::Measure { index: samples.len(), reason })?;
            let weight = weight * (w[1] - w[0]);
            samples.push((t, weight, graph(t), measure, root));
        }
    }
    let mut trust = vec![1.0; samples.len()];
    let mut control = Vec::new();
    for round in 0..solutions {
        let mut system = System::new(knots, &bound);
        for ((t, weight, v, _, root), trust) in samples.iter().zip(&trust) {
            for r in root {
                let value = (0..3).map(|i| r[i] * v[i]).sum();
                let coefficients = [*r, zero, zero];
                system.add(&Functional { t: *t, coefficients, value, weight: weight * trust });
            }
        }
        control = system.solved(0.0).ok_or(PlanesError::Undetermined { control: 0, count: knots.control_count() })?;
        if round + 1 < solutions {
            let u =
                Curve::<3>::new(knots.degree(), knots.values().to_vec(), control.clone()).map_err(DualError::from)?;
            let off = |(t, _, v, measure, _): &(f64, f64, [f64; 3], Measure, [[f64; 3]; 3])| {
                let p = u.point(*t);
                measure.distance_sq(&[p[0] - v[0], p[1] - v[1], p[2] - v[2]]).max(0.0).sqrt()
            };
            let residuals: Vec<f64> = samples.iter().map(off).collect();
            trust = robust_weights(&residuals, round);
        }
    }
    let values = knots.values().to_vec();
    let curve = if source.kind() == DualKind::Slope {
        let two: Vec<[f64; 2]> = control.iter().map(|c| [c[0], c[1]]).collect();
        DualCurve::slope(knots.degree(), values, &two)?
    } else {
        DualCurve::graph(knots.degree(), values, &control)?
    };
    let (mut cost, mut worst) = (0.0, 0.0f64);
    let found = curve.graphs();
    for (t, weight, v, measure, _) in samples {
        let u = found.point(t);
        let sq = measure.distance_sq(&[u[0] - v[0], u[1] - v[1], u[2] - v[2]]);
        cost += weight * sq;
        worst = worst.max((sq.max(0.0) / measure.mass()).sqrt());
    }
    Ok(Reduction { curve, cost, worst_estimate: worst })
}
