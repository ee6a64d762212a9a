//! From regions and torses to panels: borders, trimming curves, exported patches.

pub mod boundary;
pub mod chains;
pub mod cone_trim;
pub(in crate::fit) mod line_intersection;
pub mod trim;
