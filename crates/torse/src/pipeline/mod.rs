//! Floor 10: one readable file per user job.

pub mod approximate;
pub mod cone_shapes;
pub mod cones;
pub mod deliver;
pub mod elements;
pub mod fit;
pub mod hull;
pub mod info;
pub mod loft;
pub mod map_artwork;
pub mod net;
pub(crate) mod part_atlas;
pub mod planarise;
pub mod refold;
pub mod ruled;
pub mod select;
pub mod shape;
pub mod sweep;
pub mod unroll;
pub mod workshop;

#[cfg(test)]
mod laws;
