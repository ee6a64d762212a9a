//! Floor 6: the independent judge. Imports nothing from `fit`; only this module can make a [`Certificate`].
//!
//! [`distance()`] judges one torse on one region and is what a covering loop calls; [`patchwork()`] proves everything
//! about what will be exported. Theory: certificate \[certificate\]; the primal torse \[mixed, C1.4\]; plane families
//! \[PW99\].

mod boundary;
mod cell;
mod certificate;
pub mod claim;
pub mod cones;
mod coverage;
mod curve_model;
mod developable;
pub mod distance;
mod edges;
pub mod elements;
mod family;
mod fingerprint;
pub mod flat;
mod gap;
pub(crate) mod joints;
mod known;
mod local;
mod map_surface;
mod mismatch;
pub(crate) mod nearness;
mod panel;
pub mod points;
mod polygon;
pub(crate) mod prepared;
mod proof;
mod quadratic;
pub mod quads;
pub(crate) mod rails;
pub(crate) mod refolded;
pub(crate) mod regression;
mod rounding;
mod ruled;
mod ruled_panel;
mod seams;
mod simple;
#[cfg(test)]
mod specimens;
mod strokes;
mod tensor;
pub(crate) mod trimmed;
pub mod trims;
pub(crate) mod unfolded;
mod vector;
mod verdict;
pub mod written;
pub(crate) mod written_cones;
pub(crate) mod written_strips;

pub use certificate::{Certificate, SeamStatus};
pub(crate) use certificate::{PanelCertificate, SeamCertificate};
pub use distance::{distance, DistanceOptions};
pub(crate) use known::Known;
pub(crate) use local::parameters_moved;
pub use prepared::Prepared;
pub use proof::patchwork;
pub(crate) use proof::{join, join_pieces, known_of, patchwork_after};
pub(crate) use verdict::Obstruction;
pub use verdict::Verdict;
