//! Floor 5: rows over unknown points: developability, planarity, lengths, angles, handles, joins, closeness, fairness.
//!
//! Each kind is a block of equations with its derivatives, and knows nothing of the others or of who solves them. Points
//! are three unknowns that follow each other; whatever is asked of curves is asked of linear combinations of their
//! control points, see [`stencil::Stencil`]. Lengths are of the order of one: who sets up a system normalises them.

pub mod angle;
pub mod border;
pub mod coplanarity;
pub mod developability;
pub mod distance;
pub mod fairness;
pub(crate) mod fold;
pub mod handle;
pub(crate) mod join;
pub mod proximity;
pub mod reference;
pub mod stencil;

#[cfg(test)]
mod derivative_check;
#[cfg(test)]
mod laws;
