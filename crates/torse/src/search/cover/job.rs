//! What a cover is asked for, and what does not change while a face is covered.

use super::layout::{DirectionField, Layout};
use super::limits::Limits;
use crate::brep::face::Face;
use crate::certify::Prepared;
use crate::control::Control;
use std::sync::atomic::AtomicUsize;

/// What a cover is asked for.
#[derive(Clone, Debug)]
pub struct CoverOptions {
    /// Deviation bound to reach, mm.
    pub tolerance: f64,
    /// Largest number of panels on one face; `usize::MAX` for no limit.
    pub max_panels: usize,
    /// Plane facets only; default false.
    pub facets: bool,
    /// What sheet and material allow.
    pub limits: Limits,
    /// Where strips and seams run.
    pub layout: Layout,
}

impl CoverOptions {
    /// Any number of panels within a tolerance (mm), without limits, laid freely.
    pub(crate) fn new(tolerance: f64) -> Self {
        let (limits, layout) = (Limits::default(), Layout::default());
        Self { tolerance, max_panels: usize::MAX, facets: false, limits, layout }
    }
}

/// Share of the tolerance that the distance part may use; the rest is for trim curves and rounding.
pub(crate) const DISTANCE_SHARE: f64 = 0.985;
/// Everything that does not change while a face is covered.
pub(crate) struct Job<'a> {
    pub(crate) face: &'a Face,
    pub(crate) prepared: Prepared<'a>,
    pub(crate) options: CoverOptions,
    pub(crate) control: &'a Control,
    pub(crate) proofs: AtomicUsize,
    pub(super) directions: DirectionField<'a>,
}

impl<'a> Job<'a> {
    pub(crate) fn new(face: &'a Face, options: &'a CoverOptions, control: &'a Control) -> Self {
        let (prepared, proofs) = (Prepared::new(&face.surface), AtomicUsize::new(0));
        Self { face, prepared, options: options.clone(), control, proofs, directions: DirectionField::Free }
    }
}
