//! Floor 5: fitting torses near given data. Never judges itself; see `certify`.

pub mod boundary;
pub mod chains;
pub mod trim;
