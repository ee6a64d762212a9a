//! Floor 6: fitting torses near given data. Never judges itself; see `certify`.

pub mod cloud;
pub mod elements;
pub(crate) mod height;
pub mod near;
pub mod panels;
pub mod planes;
pub mod ruled;
pub mod strip_potential;

#[cfg(test)]
mod laws;
