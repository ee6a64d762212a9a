//! Floor 5: fitting torses near given data. Never judges itself; see `certify`.

pub mod along;
mod basis;
pub mod boundary;
pub mod centre_line;
pub mod chains;
pub mod cloud;
pub mod cone_trim;
pub mod cones;
pub mod decompose;
mod descent;
mod directions;
pub mod dual;
mod envelope;
mod functionals;
pub mod knot_choice;
pub mod level;
pub mod multiresolution;
pub mod outliers;
pub mod plane;
mod plane_blocks;
pub mod plane_correction;
pub mod plane_estimates;
pub mod plane_frame;
pub mod planes;
pub mod primal;
mod profile;
pub mod reduce;
pub mod regression;
mod regression_room;
pub mod row;
pub mod row_extent;
pub mod ruling_order;
pub mod rulings;
pub mod samples;
pub mod seams;
mod sheet;
pub mod span_series;
pub mod trim;
mod wall;

pub use functionals::Freedom;

pub use dual::{dual, CentrePoint, DualOptions};
pub use plane::plane;
pub use primal::{primal, PrimalOptions};
pub use samples::{beyond, error, thin, Fit, Sample};

use crate::surface::torse::{PanelKind, Torse};

/// Options of [`refit`].
#[derive(Clone, Debug, PartialEq)]
pub struct RefitOptions {
    /// Wanted distance, mm: the iteration ends early below it.
    pub tolerance: f64,
    /// Samples that take part at first; 220.
    pub max_samples: usize,
    /// Wanted radius of curvature at the samples, mm; 0. Kept as far as it is at hand.
    pub bend_radius: f64,
}

impl RefitOptions {
    /// The defaults with a tolerance in mm.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_samples: 220, bend_radius: 0.0 }
    }
}

/// Continues the minimax iteration of a fit, in the same kind of torse and with the same splines, over samples to which
/// witnesses may have been added. `None` if the torse is not regular at them or they have no feet there.
pub fn refit(fit: &Fit, samples: &[Sample], options: &RefitOptions) -> Option<Fit> {
    let again = match &fit.torse {
        _ if fit.kind == PanelKind::Plane => plane(samples),
        Torse::Primal(p) => primal::refit(p, fit.kind, samples, options),
        Torse::Dual(d) => dual::refit(d, samples, options),
    };
    // The old torse may still be the better one.
    match (error(&fit.torse, samples), again) {
        (Some((e, worst)), a) if a.as_ref().is_none_or(|a| a.error > e) => {
            Some(Fit { torse: fit.torse.clone(), kind: fit.kind, error: e, worst })
        }
        (_, a) => a,
    }
}
