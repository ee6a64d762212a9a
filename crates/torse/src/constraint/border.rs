//! Closeness of border to border: places of a strip's border are held near the border of a surface, and slide along it.
//!
//! Squared distances from a surface say nothing of places along it \[PH03\], so that strips drawn to a surface alone may leave
//! a part of it bare. The squared distance from a line is that from its tangent, to first order.

use super::proximity::Scale;
use super::stencil::{Stencil, Support};
use crate::geom::box_tree::BoxTree;
use crate::geom::{BBox, Vec3};
use crate::num::gauss_newton::Block;
use std::sync::Arc;

/// Lines in space, mm.
pub struct Border {
    segments: Vec<[Vec3; 2]>,
    tree: BoxTree,
}

impl Border {
    /// Straight pieces in any order; those without a length are left out. `None` if nothing remains.
    pub(crate) fn new(segments: Vec<[Vec3; 2]>) -> Option<Self> {
        let segments: Vec<[Vec3; 2]> =
            segments.into_iter().filter(|[p, q]| (q - p).norm() > 0.0 && (q - p).norm().is_finite()).collect();
        let tree = BoxTree::new(segments.len(), &|k| BBox::of(segments[k].iter()));
        (!segments.is_empty()).then_some(Self { segments, tree })
    }

    /// The nearest place and the direction of its segment.
    fn nearest(&self, x: &Vec3) -> Option<(Vec3, Vec3)> {
        let place = |k: usize| {
            let [p, q] = self.segments[k];
            let d = q - p;
            p + d * (d.dot(&(x - p)) / d.norm_squared()).clamp(0.0, 1.0)
        };
        let (k, _) = self.tree.nearest(x, &|k| (place(k) - x).norm_squared())?;
        let [p, q] = self.segments[k];
        Some((place(k), (q - p).normalize()))
    }

    /// How far a place is from it, mm.
    pub(crate) fn distance(&self, x: &Vec3) -> f64 {
        self.nearest(x).map_or(f64::INFINITY, |n| (n.0 - x).norm())
    }
}

/// A place held near a border; it slides along it. Nearest places are renewed with every step.
#[derive(Clone)]
pub(crate) struct AtBorder {
    support: Support,
    border: Arc<Border>,
    scale: Scale,
    /// The place on the border, in the system's units, and the direction there.
    at: Vec3,
    along: Vec3,
}

impl AtBorder {
    /// A place of the system, a border, and how lengths are to be read.
    pub fn new(place: &Stencil, border: Arc<Border>, scale: Scale) -> Self {
        Self { support: Support::new(&[place]), border, scale, at: Vec3::zeros(), along: Vec3::zeros() }
    }
}

impl Block for AtBorder {
    fn unknowns(&self) -> &[u32] {
        self.support.unknowns()
    }

    fn rows(&self) -> usize {
        3
    }

    fn refresh(&mut self, x: &[f64]) {
        let p = self.scale.origin + self.support.vector(0, x) * self.scale.size;
        if let Some((place, along)) = self.border.nearest(&p) {
            self.at = (place - self.scale.origin) / self.scale.size;
            self.along = along;
        }
    }

    fn evaluate(&self, x: &[f64], _: &[f64], residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let off = self.support.vector(0, x) - self.at;
        let across = off - self.along * self.along.dot(&off);
        residual.copy_from_slice(across.as_slice());
        let Some(jacobian) = jacobian else { return };
        jacobian.fill(0.0);
        for (d, row) in jacobian.chunks_exact_mut(x.len()).enumerate() {
            let mut e = Vec3::zeros();
            e[d] = 1.0;
            self.support.spread(0, &(e - self.along * self.along[d]), row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraint::derivative_check::check_at;

    fn corner() -> Arc<Border> {
        let p = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 5.0, 5.0]].map(Vec3::from);
        Arc::new(Border::new(vec![[p[0], p[1]], [p[1], p[2]], [p[2], p[2]]]).expect("a border"))
    }

    fn block() -> AtBorder {
        let scale = Scale { origin: Vec3::new(1.0, 2.0, 3.0), size: 4.0 };
        AtBorder::new(&Stencil::point(0), corner(), scale)
    }

    #[test]
    fn derivatives_are_those_of_the_distance_from_the_tangent() {
        let mut block = block();
        let x = [0.3, 0.1, -0.4];
        block.refresh(&x);
        check_at(&block, &x, &[]);
    }

    #[test]
    fn places_slide_along_and_are_off_across() {
        let mut block = block();
        // (5, 3, 4) mm: over the first segment, (3, 4) off.
        let x = [1.0, 0.25, 0.25];
        block.refresh(&x);
        let mut r = [0.0; 3];
        block.evaluate(&x, &[], &mut r, None);
        assert!(r[0].abs() < 1e-15 && (r[1] - 0.75).abs() < 1e-15 && (r[2] - 1.0).abs() < 1e-15, "{r:?}");
        assert!((corner().distance(&Vec3::new(5.0, 3.0, 4.0)) - 5.0).abs() < 1e-15);
        assert!(Border::new(Vec::new()).is_none());
    }
}
