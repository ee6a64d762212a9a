//! Discrete torses: planarisation and subdivision of strips of quadrilaterals.

pub mod planarise;
pub mod subdivide;
