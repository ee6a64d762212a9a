//! Floor 6: developables from a designer's conditions (curves, rulings, control nets). A sibling of `fit`: neither
//! knows the other, and what both want lies below in `surface`.

pub mod composite;
pub mod cones;
pub mod discrete;
pub mod hull;
pub mod interpolate;
pub mod loft;

#[cfg(test)]
mod laws;
