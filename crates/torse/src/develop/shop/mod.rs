//! What a shop needs to know of flat parts besides their outlines: material and weight, how parts are kinked or rolled, where
//! the sheet lies beside the surface that was given (docs/algorithms/shop.md).

pub mod bevel;
pub mod facets;
pub(crate) mod laid;
pub(crate) mod material;
pub(crate) mod neutral;
pub mod offsets;
pub(crate) mod order;
mod pieces;
pub mod roll;
pub(crate) mod sections;
#[cfg(test)]
mod specimens;
pub mod thickness;
