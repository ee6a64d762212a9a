//! Chains and trees of developable faces, unfolded to one piece of the plane.

pub mod allowance;
pub mod bends;
pub mod chart;
pub mod joints;
pub(crate) mod outline;
pub mod part;
pub mod placed_face;
pub mod region;
pub(crate) mod sheet;
pub mod tree;

#[cfg(test)]
pub(crate) mod specimens;
