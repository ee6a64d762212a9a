//! Regions divided in space (C6).

use super::covered_face::Cover;
use crate::geom::Vec3;
use std::sync::Arc;

impl Cover {
    /// Cuts a region across its `axis`-th principal axis in space (2: the diagonal of the first two) in the middle
    /// of its extent; returns the labels of all parts. `None` if the cut separates nothing.
    pub(super) fn halve(&mut self, label: u32, axis: usize) -> Option<Vec<u32>> {
        self.divide(label, axis, 2)
    }

    /// As [`Cover::halve`], into equal parts of the extent.
    pub(super) fn divide(&mut self, label: u32, axis: usize, parts: usize) -> Option<Vec<u32>> {
        let (mean, axes) = self.region(label).axes();
        let direction = match axis {
            0 | 1 => axes[axis],
            _ => (axes[0] + axes[1]).normalize(),
        };
        let (lo, hi) = self.region(label).extent(&mean, &direction);
        let mut all = vec![label];
        for k in 1..parts {
            let at = lo + (hi - lo) * k as f64 / parts as f64;
            let mut next = Vec::new();
            for l in all {
                match self.cut_across(l, &mean, &direction, at) {
                    Some(cut) => next.extend(cut),
                    None => next.push(l),
                }
            }
            all = next;
        }
        (all.len() > 1).then_some(all)
    }

    pub(super) fn cut_across(&mut self, label: u32, mean: &Vec3, direction: &Vec3, at: f64) -> Option<Vec<u32>> {
        let face = Arc::clone(&self.face);
        self.parted(label, |p| direction.dot(&(face.surface.point(p[0], p[1]) - mean)) - at)
    }

    /// Cuts a region that meets itself along a line of parameters at which the face closes, all round a pole or as a ring, along
    /// the line opposite; the labels of all parts. `None` for others.
    ///
    /// Round a pole a panel without a slit has no border there, and one with it would meet itself.
    pub(super) fn cut_open(&mut self, label: u32) -> Option<Vec<u32>> {
        let (d, middle) = self.region(label).meets_itself()?;
        self.parted(label, |p| p[d] - middle)
    }

    /// Cuts a region where a function of the parameters is zero; the labels of all parts. `None` if that separates nothing.
    pub(super) fn parted(&mut self, label: u32, height: impl Fn([f64; 2]) -> f64) -> Option<Vec<u32>> {
        Some(self.parts(label, height)).filter(|parts| parts.len() > 1)
    }

    /// The same, one label where it separates nothing.
    pub(super) fn parts(&mut self, label: u32, height: impl Fn([f64; 2]) -> f64) -> Vec<u32> {
        let fresh = self.partition.fresh_label();
        self.cut(label, fresh, height);
        let mut parts = self.partition.split_components(label);
        parts.extend(self.partition.split_components(fresh));
        parts.retain(|&p| self.partition.labels.contains(&p));
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::Face;
    use crate::brep::support_surface::SupportSurface;
    use crate::geom::Frame;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn cap(turn: f64, down_to: f64) -> Cover {
        let sphere = SupportSurface::Sphere { frame: Frame::world(), radius: 10.0 };
        let (surface, _) = sphere.to_spline((0.0, turn), (down_to, FRAC_PI_2)).expect("a sphere");
        Cover::of_face(&Face::untrimmed(surface), 1.0).expect("triangles")
    }

    #[test]
    fn caps_round_a_pole_become_two_halves_that_end_on_it() {
        let mut cover = cap(2.0 * PI, 1.2);
        let area = cover.region(0).area();
        let parts = cover.cut_open(0).expect("two halves");
        assert_eq!(parts.len(), 2);
        for l in parts {
            assert!((cover.region(l).area() - 0.5 * area).abs() < 1e-6 * area);
            assert_eq!(cover.cut_open(l), None);
        }
    }

    #[test]
    fn what_does_not_meet_itself_is_left_alone() {
        assert_eq!(cap(1.9 * PI, 1.2).cut_open(0), None);
    }
}
