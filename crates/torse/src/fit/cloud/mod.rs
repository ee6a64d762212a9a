//! Torses near measured points: surface estimates, regions without creases, pieces that one torse follows, and the
//! rulings and lengths that the points cover. Says nothing about how near the points are; the judge does.

mod error;
pub(crate) mod estimates;
pub(crate) mod extent;
pub(crate) mod facets;
mod grid;
mod lines;
pub(crate) mod pieces;
pub(crate) mod regions;

pub use error::CloudError;
pub(crate) use grid::core;
