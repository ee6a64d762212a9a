//! What a developable consists of: runs of tangent planes that are one plane, envelop a cylinder or a cone, or belong
//! to the tangents of a curve (Proposition 1.12 of \[W15\]), with a tolerance for noise.
//!
//! Knows nothing of rulings and boundaries: a sequence of tangent planes says it all. What the choice between the four
//! models costs and why: docs/algorithms/discrete.md.

mod model;

use crate::geom::Vec3;
use crate::torse::kind::{EnvelopePiece, EnvelopeShape, TangentPlane};
use model::{Model, Moment};

/// How [`decompose`] works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecomposeOptions {
    /// Standard deviation of the components of the normals, rad, and of the offsets by `size`; default 1e-7, which is
    /// also the least value used, even for exact data.
    pub noise: f64,
    /// Point near the surface, mm; default the origin. Offsets count from here.
    pub centre: Vec3,
    /// Size of the surface, mm; default 1. Offsets count in this unit.
    pub size: f64,
}

impl Default for DecomposeOptions {
    fn default() -> Self {
        Self { noise: LEAST_NOISE, centre: Vec3::zeros(), size: 1.0 }
    }
}

/// Sequences that cannot be decomposed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DecomposeError {
    /// Fewer planes than the shortest run.
    #[error("{0} tangent planes are too few to tell a shape; give at least {SHORTEST}")]
    TooFew(usize),
    /// A plane that is none.
    #[error("tangent plane {0} (counted from 0) is not finite or has no normal")]
    Plane(usize),
    /// A size or noise that is not a positive finite number.
    #[error("the {what} {value} is not a positive finite number")]
    Option {
        /// What it is.
        what: &'static str,
        /// The value.
        value: f64,
    },
}

/// Least noise: exact data carry rounding of this order once planes have been computed from rulings.
const LEAST_NOISE: f64 = 1e-7;
/// Least number of planes of a run: two more than determine a cone.
const SHORTEST: usize = 6;
/// Planes up to which breaks are looked for everywhere: longer sequences look at every eighth plane first, then near those found.
const ALL_BREAKS: usize = 400;
/// Distance of the breaks tried first in long sequences.
const STRIDE: usize = 8;
/// Places from which on a run of the second search is too long: four runs of the first, so that all of these and some
/// of their unions are found.
const NEAR: usize = 4 * (2 * STRIDE + 1);
/// Parameters of a break between two runs of one shape: keeps a curved piece from being taken for a chain of short
/// cones.
const BREAK: f64 = 1.0;
/// A run whose shape would be another if the noise were greater or smaller by this factor is ambiguous.
const DOUBT: f64 = 2.0;

/// Splits a sequence of tangent planes into planes, cylinders, cones and tangent surfaces.
///
/// *Method.* The cheapest sequence of runs by dynamic programming over all breaks. A run of L planes costs
/// `max(0, χ²/σ² − 1.5 q L) + ln k · f`, where χ² is what the shape leaves of the planes, from the 4 × 4 moment of
/// their coordinates, `q` counts the conditions on each plane and `f` the parameters of the shape with a share per
/// plane for its free function: plane `q = 3, f = 3`, cylinder `1, 2 + L/4`, cone `1, 3 + L/4`, tangents
/// `0, 6 + 3L/8`; a break between two runs of one shape is one parameter more. Neighbours of one shape that fit jointly
/// are merged. Sequences of more than 400 planes are searched with breaks at multiples of eight, then with breaks near
/// those.
///
/// *Guarantee.* Runs cover the sequence without gaps, none is shorter than six planes. *Not guaranteed*: the shapes
/// themselves. From a noise of 1e-4 on, short pieces of tangent surfaces may pass for cones; `ambiguous` warns of some
/// of that.
///
/// *Cost.* O(k²) runs for `k ≤ 400`, O((k/8)²) beyond.
///
/// # Errors
/// Fewer than six planes, planes that are not finite, options that are not positive.
pub fn decompose(planes: &[TangentPlane], options: &DecomposeOptions) -> Result<Vec<EnvelopePiece>, DecomposeError> {
    if planes.len() < SHORTEST {
        return Err(DecomposeError::TooFew(planes.len()));
    }
    for (what, value) in [("noise", options.noise), ("size", options.size)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(DecomposeError::Option { what, value });
        }
    }
    let coordinates = coordinates(planes, options)?;
    let noise = options.noise.max(LEAST_NOISE);
    let scale = Scale { variance: noise * noise, per_parameter: (planes.len() as f64).ln() };
    let found = if planes.len() <= ALL_BREAKS {
        cheapest(&coordinates, &(0..=planes.len()).collect::<Vec<_>>(), usize::MAX, &scale)
    } else {
        let mut places: Vec<usize> = (0..=planes.len() / STRIDE).map(|i| i * STRIDE).collect();
        // The last block takes what is left.
        if let Some(last) = places.last_mut() {
            *last = planes.len();
        }
        let coarse = cheapest(&coordinates, &places, usize::MAX, &scale);
        cheapest(&coordinates, &near(&coarse, planes.len()), NEAR, &scale)
    };
    let mut runs: Vec<(usize, usize, Model)> = Vec::new();
    for (first, end, model) in found {
        // Neighbours of one shape are one run if they fit together no worse than apart.
        if let Some(last) = runs.last_mut().filter(|l| l.2 == model) {
            let joint = Moment::of(&coordinates[last.0..end]);
            if model.fits(&joint, scale.variance) {
                last.1 = end;
                continue;
            }
        }
        runs.push((first, end, model));
    }
    Ok(runs.into_iter().map(|(first, end, model)| run(&coordinates, first, end, model, &scale, options)).collect())
}

/// Unit of data errors and of parameters.
#[derive(Clone, Copy)]
struct Scale {
    variance: f64,
    per_parameter: f64,
}

/// `(n, h)` with unit normals of continuous sense, offsets from the centre in units of the size.
fn coordinates(planes: &[TangentPlane], options: &DecomposeOptions) -> Result<Vec<[f64; 4]>, DecomposeError> {
    let mut out: Vec<[f64; 4]> = Vec::with_capacity(planes.len());
    let mut before = Vec3::zeros();
    for (i, p) in planes.iter().enumerate() {
        let length = p.normal.norm();
        let offset = (p.offset - p.normal.dot(&options.centre)) / options.size;
        if !(length.is_finite() && length > 0.0 && offset.is_finite()) {
            return Err(DecomposeError::Plane(i));
        }
        let sign = if p.normal.dot(&before) < 0.0 { -1.0 / length } else { 1.0 / length };
        before = p.normal * sign;
        out.push([before.x, before.y, before.z, offset * sign]);
    }
    Ok(out)
}

/// The models, the simpler ones last: equal costs decide for them.
const MODELS: [Model; 4] = [Model::Tangent, Model::Cone, Model::Cylinder, Model::Plane];

/// The cheapest model of a run.
fn best(moment: &Moment, scale: &Scale) -> Model {
    let cost = |m: &Model| moment.cost(*m, scale.variance, scale.per_parameter);
    MODELS.iter().rev().min_by(|a, b| cost(a).total_cmp(&cost(b))).copied().unwrap_or(Model::Tangent)
}

/// Runs `(first, end, model)` of the cheapest sequence with breaks at some of `places`, which increase from 0 to the
/// number of planes.
/// `reach` is the greatest number of places from the first to the last of a run.
fn cheapest(x: &[[f64; 4]], places: &[usize], reach: usize, scale: &Scale) -> Vec<(usize, usize, Model)> {
    let blocks: Vec<Moment> = places.windows(2).map(|w| Moment::of(&x[w[0]..w[1]])).collect();
    let n = blocks.len();
    // Least cost of all planes before a place, by the model of the last run; where that begins, and the model before.
    let mut cost = vec![[f64::INFINITY; 4]; n + 1];
    let mut from = vec![[(0, 0); 4]; n + 1];
    for i in 0..n {
        // What comes before a run of each model.
        let before: [(f64, usize); 4] = std::array::from_fn(|m| {
            if i == 0 {
                return (0.0, 0);
            }
            let with = |k: usize| cost[i][k] + if k == m { BREAK * scale.per_parameter } else { 0.0 };
            (0..4).map(|k| (with(k), k)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0))
        });
        if before.iter().all(|b| b.0.is_infinite()) {
            continue;
        }
        let mut moment = Moment::default();
        for j in i..n.min(i.saturating_add(reach)) {
            moment.add(&blocks[j]);
            if places[j + 1] - places[i] < SHORTEST {
                continue;
            }
            for (m, model) in MODELS.into_iter().enumerate() {
                // The parameters alone may cost too much.
                if before[m].0 + moment.least_cost(model, scale.per_parameter) >= cost[j + 1][m] {
                    continue;
                }
                let c = before[m].0 + moment.cost(model, scale.variance, scale.per_parameter);
                if c < cost[j + 1][m] {
                    cost[j + 1][m] = c;
                    from[j + 1][m] = (i, before[m].1);
                }
            }
        }
    }
    let mut out = Vec::new();
    let mut at = n;
    let mut m = (0..4).rev().min_by(|a, b| cost[n][*a].total_cmp(&cost[n][*b])).unwrap_or(0);
    while at > 0 {
        let (i, before) = from[at][m];
        out.push((places[i], places[at], MODELS[m]));
        (at, m) = (i, before);
    }
    out.reverse();
    out
}

/// Every place near the breaks found at multiples of [`STRIDE`].
fn near(runs: &[(usize, usize, Model)], k: usize) -> Vec<usize> {
    let mut out: Vec<usize> =
        runs.iter().flat_map(|r| r.1.saturating_sub(STRIDE)..=(r.1 + STRIDE).min(k)).chain([0, k]).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// A run with the parameters of its shape.
fn run(
    x: &[[f64; 4]],
    first: usize,
    end: usize,
    model: Model,
    scale: &Scale,
    options: &DecomposeOptions,
) -> EnvelopePiece {
    let moment = Moment::of(&x[first..end]);
    let shape = match model {
        Model::Plane => {
            let [a, b, c, d] = moment.mean();
            let length = Vec3::new(a, b, c).norm();
            let normal = Vec3::new(a, b, c) / length;
            EnvelopeShape::Plane {
                plane: TangentPlane { normal, offset: d / length * options.size + normal.dot(&options.centre) },
            }
        }
        Model::Cylinder => EnvelopeShape::Cylinder { direction: moment.axis() },
        Model::Cone => match moment.apex() {
            Some(p) => EnvelopeShape::Cone { apex: options.centre + p * options.size },
            None => EnvelopeShape::Tangent,
        },
        Model::Tangent => EnvelopeShape::Tangent,
    };
    let otherwise = |f: f64| best(&moment, &Scale { variance: scale.variance * f, ..*scale }) != model;
    let ambiguous = otherwise(DOUBT * DOUBT) || otherwise(1.0 / (DOUBT * DOUBT));
    EnvelopePiece { first, end, shape, residual: moment.residual(model), ambiguous }
}

#[cfg(test)]
mod tests;
