//! Floor 5: fitting torses near given data. Never judges itself; see `certify`.

pub mod level;
mod descent;
pub mod plane;
pub mod primal;
mod profile;
pub mod samples;
mod sheet;

pub use plane::plane;
pub use primal::{primal, PrimalOptions};
pub use samples::{error, thin, Fit, Sample};
