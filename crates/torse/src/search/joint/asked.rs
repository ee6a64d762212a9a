//! What is asked of strips that are to meet: docs/algorithms/seams.md, "All strips together".

use crate::geom::Vec3;
use std::collections::BTreeSet;

/// What is asked of strips that are to meet.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    /// Between which labels (left, right) seams must stay where they are.
    pub held: &'a dyn Fn([u32; 2]) -> bool,
    /// Labels whose strips stay as they are, and their borders too.
    pub without: &'a BTreeSet<u32>,
    /// Share of what keeps a strip away from its regression curve that steps may expect to be left: patches need room between
    /// their region and that curve.
    pub regular: f64,
    /// mm.
    pub tolerance: f64,
    /// What distances count at places on the border of the face, where panels are to be nearer there than elsewhere; even a
    /// strip without neighbours is changed then.
    pub borders: Option<&'a BorderCounts<'a>>,
    /// Largest distance (tolerances) of a sample with which what comes out is of use: steps end where it cannot be reached.
    pub most: f64,
}

/// What the distance of a place on the border of a face counts.
pub(crate) type BorderCounts<'a> = dyn Fn(&Vec3) -> f64 + Sync + 'a;
