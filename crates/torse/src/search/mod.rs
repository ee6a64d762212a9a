//! Floor 7: the loops that propose, have judged, and refine. Below the jobs it is the only floor where some propose
//! (`fit`, `design`) and another judges (`certify`): `face` tells the story of one face: [`trims`] says how true its
//! border is, `creased` cuts it at its own sharp edges, `smooth` joins it with its neighbours, [`cover`] covers it with
//! torses, [`build`] makes panels of them, `sheet` and `slivers` keep to what a shop can cut, `stitch` lets
//! neighbouring panels meet; [`strips`] finds the strips of the other jobs.

pub(crate) mod all_met;
pub(crate) mod apex;
pub mod build;
pub mod cover;
pub(crate) mod creased;
pub(crate) mod face;
pub(crate) mod joint;
mod laid;
pub(crate) mod refolded;
pub mod ruled;
mod sheet;
mod slivers;
pub(crate) mod smooth;
pub(crate) mod stitch;
pub mod strips;
pub mod trims;

#[cfg(test)]
mod laws;
