//! Floor 7: the loops that propose, have judged, and refine. The only floor that names both those who propose (`fit`,
//! `design`) and the judge (`certify`): [`cover`] covers a face with torses, [`build`] makes panels of them, [`stitch`]
//! lets neighbouring panels meet, [`strips`] finds the strips of the other jobs.

pub mod build;
pub mod cover;
pub mod stitch;
pub mod strips;
