//! Questions about nets that cannot be asked.

use crate::design::interpolate::InterpolateError;
use crate::geom::coarse::Loose;
use crate::spline::SplineError;
use crate::torse::net::NetError;
use crate::torse::rail::RailError;

/// A question about a net that cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetJobError {
    /// A tolerance larger than the model.
    #[error(transparent)]
    Loose(#[from] Loose),
    /// The curve has corners.
    #[error(
        "{curve} has a corner of {turn_deg:.3}° at {at:.4} of its length; a net needs a smooth curve: split it there"
    )]
    Corner {
        /// Name.
        curve: String,
        /// Share of the length.
        at: f64,
        /// Turn of the tangent, degrees.
        turn_deg: f64,
    },
    /// The rulings given cannot be used.
    #[error("{curve}: {source}")]
    Rulings {
        /// Name.
        curve: String,
        /// What is wrong.
        source: InterpolateError,
    },
    /// The free parameters do not make a net.
    #[error("{curve}, with the parameter running from 0 to 1: {source}")]
    Net {
        /// Name.
        curve: String,
        /// What is wrong.
        source: NetError,
    },
    /// M* in the middle of the curve, or not finite.
    #[error("{curve}: M* = {m_star} cannot be used: it must be finite, and not the middle of the parameter, which runs from 0 to 1; the surface is regular only with M* and L* both before 0 or both beyond 1")]
    Middle {
        /// Name.
        curve: String,
        /// As given.
        m_star: f64,
    },
    /// There are fewer alternatives than asked for.
    #[error("{curve}: alternative {asked} does not exist; there are {count} regular polynomial solutions")]
    NoAlternative {
        /// Name.
        curve: String,
        /// Number asked for, from 1.
        asked: usize,
        /// Number there are.
        count: usize,
    },
    /// A stretch that is none.
    #[error("{curve}: the stretch from {} to {} must run forwards and hold part of the curve, whose parameter runs from 0 to 1", .along[0], .along[1])]
    Along {
        /// Name.
        curve: String,
        /// As given.
        along: [f64; 2],
    },
    /// The continued curve is no rail.
    #[error(transparent)]
    Rail(#[from] RailError),
    /// A tolerance that is not a positive number.
    #[error("the tolerance must be a positive length, not {0} mm")]
    Tolerance(f64),
    /// A strip could not be stored.
    #[error("{curve}: {source}")]
    Spline {
        /// Name.
        curve: String,
        /// What is wrong.
        source: SplineError,
    },
}
