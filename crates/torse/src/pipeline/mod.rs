//! Floor 6: one readable file per user job.

pub mod approximate;
mod cone_outline;
pub mod cone_shapes;
mod cone_strip;
pub mod cones;
mod consensus;
pub mod cover;
pub mod cut;
pub mod exact_strip;
mod fewest;
pub mod fit;
mod given_face;
pub mod hull;
pub mod info;
pub mod judgement;
pub mod loft;
mod loft_ends;
pub mod net;
pub mod outcome;
pub mod planarise;
pub mod presentation;
mod regression;
pub mod row;
mod seams;
pub mod shapes;
pub mod sheets;
pub mod sweep;
