//! Planar pieces between ends of curves, and how curves leave them \[W15, section 2B\].

use super::build::Builder;
use super::built::Item;
use super::identify::end;
use super::{Composite, Facet};
use crate::constraint::handle::Vanish;
use crate::constraint::stencil::Stencil;
use crate::geom::Vec3;
use crate::num::gauss_newton::Role;

/// Corners of a facet as ends of curves.
fn corners(c: &Composite, f: &Facet) -> Vec<(usize, usize)> {
    f.corners.iter().filter_map(|p| end(c, p)).collect()
}

impl Builder<'_> {
    /// Rows of a facet: corners and the control points beside them lie in its plane, or follow from the corners.
    pub(super) fn facet(&mut self, k: usize) {
        let composite = self.composite;
        let facet = &composite.facets[k];
        let corners = corners(composite, facet);
        let point = |b: &Self, e: (usize, usize)| b.built.points[e.0][e.1];
        let all: Vec<u32> = corners.iter().map(|&e| point(self, e)).collect();
        // Every end of a curve that is one with a corner.
        let mut ends: Vec<((usize, usize), usize)> = Vec::new();
        for (c, points) in self.built.points.iter().enumerate() {
            for at in [0, points.len() - 1] {
                if let Some(i) = all.iter().position(|p| *p == points[at]) {
                    ends.push(((c, at), i));
                }
            }
        }
        match facet.alpha {
            Some(alpha) => {
                for (e, i) in ends {
                    let (q, r) = (all[(i + 1) % all.len()], all[(i + 2) % all.len()]);
                    let side = Stencil::point(r).minus(&Stencil::point(q));
                    let leg = self.leg(e);
                    let along = |s: &Stencil| s.value(&self.built.start);
                    let way = if along(&leg).dot(&along(&side)) < 0.0 { -alpha } else { alpha };
                    let row = leg.minus(&side.times(way));
                    self.add(Vanish::new(&row, 1.0), Role::Hard, "planar pieces", Item::Facet(k));
                }
            }
            None => {
                let beside = |b: &Self, (c, at): (usize, usize)| b.built.points[c][if at == 0 { 1 } else { at - 1 }];
                let mut points = all.clone();
                points.extend(ends.iter().map(|(e, _)| beside(self, *e)));
                self.plane(points, Item::Facet(k));
            }
        }
    }
}

/// Places of the corners for given control points of every curve.
pub(super) fn places(c: &Composite, f: &Facet, point: impl Fn(usize, usize) -> Vec3) -> Vec<Vec3> {
    corners(c, f).into_iter().map(|(k, i)| point(k, i)).collect()
}
