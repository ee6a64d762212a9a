//! A cover of one face as panels.

use super::build::{build, Built};
use super::cover::{Cover, CoverOptions, Job, SeamPlane};
use crate::brep::face::Face;
use crate::control::Control;
use crate::torse::form::PanelKind;

/// Round of cutting panels that the judge refuses as built from which they get plane facets only: these can always be built.
const FACET_ROUND: usize = 3;
/// Rounds of that, at most: as many with facets as without.
const ROUNDS: usize = 2 * FACET_ROUND;

/// A face while panels are laid on it.
pub(super) struct Task<'a> {
    pub index: usize,
    pub face: &'a Face,
    /// Tolerance of the proof, mm.
    pub whole: f64,
    /// What covers are asked for.
    pub options: CoverOptions,
    pub control: &'a Control,
}

/// A cover as panels.
#[derive(Clone)]
pub(super) struct Laid {
    pub cover: Cover,
    pub built: Built,
    /// Whether every panel was accepted; else the search is at its end.
    pub accepted: bool,
    /// Planes of seams that were kept besides those of the user.
    pub seams: Vec<SeamPlane>,
}

impl Task<'_> {
    /// What covers are asked for with further seams.
    pub(super) fn options_with(&self, seams: &[SeamPlane]) -> CoverOptions {
        let mut options = self.options.clone();
        options.layout.seams.extend(seams);
        options
    }

    /// Builds a cover; what the judge refuses is cut, and goes round again.
    pub(super) fn laid(&self, mut cover: Cover, seams: Vec<SeamPlane>) -> Laid {
        let mut options = self.options_with(&seams);
        let mut round = 0;
        loop {
            let (built, mut refused) = build(self.index, &cover, self.whole);
            // Both sides of a slit lie on one line of a plane: trims may be told apart by their errors, drawings are not.
            let slit = cover
                .panels
                .iter()
                .filter(|(&l, fit)| fit.kind == PanelKind::Plane && cover.region(l).meets_itself().is_some());
            refused.extend(slit.map(|(&l, _)| l).filter(|l| !refused.contains(l)).collect::<Vec<_>>());
            if refused.is_empty() {
                return Laid { cover, built, accepted: true, seams };
            }
            let panels = built.patchwork.panels.len() + refused.len();
            if self.control.stopped() || round == ROUNDS || panels > options.max_panels {
                return Laid { cover, built, accepted: false, seams };
            }
            options.facets = round >= FACET_ROUND;
            match Job::new(self.face, &options, self.control).cut_refused(&cover, &refused) {
                Some(next) => cover = next,
                None => return Laid { cover, built, accepted: false, seams },
            }
            round += 1;
        }
    }
}
