//! Floor 5: rows over unknown points: developability, planarity, lengths, handles, joins, closeness, fairness.
//!
//! Each kind is a block of equations with its derivatives, and knows nothing of the others or of who solves them. Points
//! are three unknowns that follow each other; whatever is asked of curves is asked of linear combinations of their
//! control points, see `stencil`. Lengths are of the order of one: who sets up a system normalises them.

pub mod border;
pub(crate) mod coplanarity;
pub(crate) mod developability;
pub(crate) mod distance;
pub(crate) mod fairness;
pub(crate) mod fold;
pub(crate) mod handle;
pub(crate) mod join;
pub mod proximity;
pub mod reference;
pub(crate) mod stencil;

#[cfg(test)]
mod derivative_check;
#[cfg(test)]
mod laws;
