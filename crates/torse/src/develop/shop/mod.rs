//! What a shop needs to know of flat parts besides their outlines: material and weight, how parts are kinked or rolled, where
//! the sheet lies beside the surface that was given (docs/algorithms/shop.md).

pub mod bevel;
pub mod facets;
pub mod laid;
pub mod material;
pub mod neutral;
pub mod order;
pub mod roll;
pub mod sections;
#[cfg(test)]
mod specimens;
pub mod thickness;
