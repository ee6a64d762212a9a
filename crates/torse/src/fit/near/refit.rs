//! Going on with a fit over more samples.
//!
//! Method: minimax iterations of the fit's own family (mixed-curvature specification, C1.5), see
//! `docs/algorithms/torses.md`.

use super::descent::RefitOptions;
use super::dual;
use super::plane::plane;
use super::primal;
use super::samples::{error, Fit, Sample};
use crate::torse::form::{PanelKind, Torse};

/// Continues the minimax iteration of a fit, in the same kind of torse and with the same splines, over samples to which
/// witnesses may have been added. `None` if the torse is not regular at them or they have no feet there.
pub fn refit(fit: &Fit, samples: &[Sample], options: &RefitOptions) -> Option<Fit> {
    let again = match &fit.torse {
        _ if fit.kind == PanelKind::Plane => plane(samples),
        Torse::Primal(p) => primal::refit(p, fit.kind, samples, options),
        Torse::Dual(d) => dual::refit(d, samples, options),
        // Cylinders are taken from surfaces as they are.
        Torse::Cylinder(_) => None,
    };
    // The old torse may still be the better one.
    match (error(&fit.torse, samples), again) {
        (Some((e, worst)), a) if a.as_ref().is_none_or(|a| a.error > e) => {
            Some(Fit { torse: fit.torse.clone(), kind: fit.kind, error: e, worst })
        }
        (_, a) => a,
    }
}
