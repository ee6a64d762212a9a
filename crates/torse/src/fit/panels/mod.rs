//! From regions and torses to panels: borders, trimming curves, exported patches.

pub mod boundary;
pub(crate) mod chains;
pub mod cone_trim;
pub(in crate::fit) mod line_intersection;
pub(crate) mod trim;
