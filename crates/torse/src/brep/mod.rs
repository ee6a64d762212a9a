//! Floor 3: what CAD files hold. Support surfaces, curves in space, swept and offset surfaces, projection on them,
//! trimmed faces, and faces that go on smoothly joined to one.
//!
//! Nothing is known here of developable surfaces or of panels.

pub mod area;
pub(crate) mod body;
pub(crate) mod boundary_stretch;
pub(crate) mod conic;
pub mod face;
pub mod free_curve;
pub(crate) mod join;
pub(crate) mod meridian;
pub(crate) mod nearest_on_curve;
pub(crate) mod offset;
pub(crate) mod offset_bound;
pub(crate) mod parameter_map;
pub(crate) mod project;
pub mod raw;
pub(crate) mod recast;
pub mod recognised_surface;
pub(crate) mod ruled;
pub(crate) mod rulings;
pub mod space_curve;
pub mod support_surface;
pub(crate) mod swept;
pub(crate) mod trim;
pub(crate) mod unroll;

#[cfg(test)]
mod laws;
