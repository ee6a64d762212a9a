//! From regions and torses to panels: borders, trimming curves, exported patches.

pub mod boundary;
pub(crate) mod chains;
pub mod cone_trim;
mod cut_off;
pub(crate) mod line_intersection;
pub(crate) mod on_rulings;
pub(crate) mod trim;
