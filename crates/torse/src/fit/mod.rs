//! Floor 5: fitting torses near given data. Never judges itself; see `certify`.

pub mod level;
pub mod plane;
pub mod samples;
mod sheet;

pub use plane::plane;
pub use samples::{error, thin, Fit, Sample};
