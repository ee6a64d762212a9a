//! What is asked of all regions of a face at once, and cuts through all of them: docs/algorithms/cover.md.

use super::covered_face::{Cover, SAMPLES};
use super::region::axes_of;
use crate::brep::face::Face;
use crate::control::Control;
use crate::fit::near::primal::{primal, PrimalOptions};
use crate::geom::Vec3;
use crate::patchwork::triangulate::TriangulateError;
use std::sync::Arc;

impl Cover {
    /// A face in its connected parts, triangulated finely enough for strips of a tolerance (mm).
    pub(super) fn bare(face: &Face, tolerance: f64) -> Result<Self, TriangulateError> {
        let mut cover = Self::of_face(face, f64::INFINITY)?;
        let strip = cover.typical_strip(tolerance);
        let finer = Self::of_face(face, strip)?;
        if finer.partition.triangles.len() > cover.partition.triangles.len() {
            cover = finer;
        }
        cover.partition.split_components(0);
        Ok(cover)
    }

    /// Labels without a torse.
    pub(super) fn free(&self) -> Vec<u32> {
        let mut labels = self.partition.distinct_labels();
        labels.retain(|l| !self.panels.contains_key(l));
        labels
    }

    /// Whether every region has a torse, which was proven to be within the tolerance unless it was [filled in](Cover::fill).
    pub(in crate::search) fn is_complete(&self) -> bool {
        self.free().is_empty()
    }

    /// Width (mm) of a strip at the 90 % quantile of curvature (B2), endless on planes.
    fn typical_strip(&self, tolerance: f64) -> f64 {
        let mut k: Vec<f64> = self
            .region(0)
            .forms(SAMPLES)
            .iter()
            .map(|f| f.principal().map(f64::abs).into_iter().fold(0.0, f64::max))
            .filter(|k| k.is_finite())
            .collect();
        k.sort_by(f64::total_cmp);
        let high = k.get(k.len() * 9 / 10).copied().unwrap_or(0.0);
        4.0 * (tolerance / high).sqrt()
    }

    /// Principal axes of a face's vertices, longest first.
    pub(crate) fn axes(&self) -> [Vec3; 3] {
        axes_of(&self.jets.iter().map(|j| (j.jet.p, 1.0)).collect::<Vec<_>>()).1
    }

    /// How far a face's vertices reach along an axis, mm.
    pub(crate) fn reach(&self, axis: &Vec3) -> [f64; 2] {
        let along = self.jets.iter().map(|j| axis.dot(&j.jet.p));
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
    }

    /// Gives every region without a torse the nearest one at hand, unproven: the best that a job cut short can offer. The
    /// fits are as good as `control` leaves time for.
    pub(crate) fn fill(&mut self, control: &Control) {
        for label in self.free() {
            let samples = self.region(label).samples();
            let options = PrimalOptions { control: control.clone(), ..PrimalOptions::new(0.0) };
            let fit = primal(&samples, &options).or_else(|| crate::fit::near::plane::plane(&samples));
            self.panels.extend(fit.map(|fit| (label, Arc::new(fit))));
        }
    }

    /// Cuts panels into equal parts: `[along, across]` of each label; all parts keep the torse, which is good for each of
    /// them. A panel that a cut does not separate stays as it is.
    pub(crate) fn cut_large(&self, large: &[(u32, [usize; 2])]) -> Self {
        let mut cover = self.clone();
        for &(label, parts) in large {
            let mut trial = cover.clone();
            let Some(fit) = trial.panels.remove(&label) else { continue };
            let axis = usize::from(parts[0] < 2);
            if let Some(cut) = trial.divide(label, axis, parts[axis]) {
                trial.panels.extend(cut.into_iter().map(|p| (p, Arc::clone(&fit))));
                cover = trial;
            }
        }
        cover
    }

    /// The same regions cut where functions of the parameters are zero; parts keep the torses of what is covered.
    pub(crate) fn cut_where(&self, heights: &[impl Fn([f64; 2]) -> f64]) -> Self {
        let mut cover = self.clone();
        for height in heights {
            for label in cover.partition.distinct_labels() {
                if let Some((cut, _)) = cover.cut_by(label, height) {
                    cover = cut;
                }
            }
        }
        cover
    }

    /// The same with one region cut where a function of the parameters is zero, and the labels of its parts, which keep its torse.
    pub(crate) fn cut_by(&self, label: u32, height: impl Fn([f64; 2]) -> f64) -> Option<(Self, Vec<u32>)> {
        let mut cover = self.clone();
        let fit = cover.panels.remove(&label);
        let parts = cover.parted(label, height)?;
        cover.panels.extend(parts.iter().filter_map(|p| Some((*p, Arc::clone(fit.as_ref()?)))));
        Some((cover, parts))
    }
}
