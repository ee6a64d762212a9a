//! The layout of panels that a user asks for: where strips run, rings, seams that must be kept (B2, B3).
//!
//! *Method.* Directions are wanted of the level lines: the strip potential starts as the one that follows them best and
//! may turn away from them a little only ([`directed_strip_potentials`]). Rings run around the point that is farthest
//! from the region's border; the region is first cut through that point, because no developable closes around it. Planes
//! and curves of user seams cut the region before anything is fitted, and panels on different sides are never merged.
//!
//! Not guaranteed: the direction itself. Where a direction is asymptotic no strip follows it, and where bands fail the
//! usual means (cuts, facets) take over: the tolerance comes first.

use super::covered_face::Cover;
use super::curve_on_face::{carried_on, PanelCurve};
use super::region::Region;
use super::seam_line::SeamLine;
use crate::geom::Vec3;
use crate::num::hash::{HashMap, HashSet};
use crate::patchwork::partition::edges;
use std::sync::Arc;

/// Kinds of layouts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LayoutKind {
    /// As few panels as can be.
    #[default]
    Auto,
    /// Strips from side to side, even where other cuts would need fewer panels.
    Strips,
    /// Strips around the middle of every face.
    Rings,
}

/// What strips run along.
#[derive(Clone, Debug, PartialEq)]
pub enum Guide {
    /// A direction in space, seen on the surface.
    Direction(Vec3),
    /// The tangents of a polyline (mm), each at the points of the surface that are nearest to it.
    Curve(Vec<Vec3>),
}

/// A plane `normal · x = offset` that seams must follow; `normal` of unit length, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamPlane {
    /// Unit normal.
    pub normal: Vec3,
    /// Distance from the origin along the normal, mm.
    pub offset: f64,
}

impl SeamPlane {
    pub(in crate::search) fn height(&self, x: &Vec3) -> f64 {
        self.normal.dot(x) - self.offset
    }
}

/// The layout of panels; default: as few as can be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Kind.
    pub kind: LayoutKind,
    /// What strips run along; not used for rings.
    pub guide: Option<Guide>,
    /// Planes of seams that must be kept.
    pub seams: Vec<SeamPlane>,
    /// Curves of seams that must be kept; those that end on a face go on straight to its border.
    pub seam_curves: Vec<PanelCurve>,
    /// Curves along which panels are laid first; the rest follows from their borders.
    pub curves: Vec<PanelCurve>,
}

/// What strips of one region follow.
#[derive(Clone, Debug)]
pub(super) enum DirectionField<'a> {
    /// Whatever needs the fewest.
    Free,
    /// A guide.
    Along(&'a Guide),
    /// The tangents of polylines (mm), each at the points of the surface that are nearest to it.
    Beside(Vec<Vec<Vec3>>),
    /// A point.
    Around(Vec3),
}

impl DirectionField<'_> {
    /// The direction wanted at a point with a normal; not of unit length.
    pub(super) fn at(&self, x: &Vec3, normal: &Vec3) -> Option<Vec3> {
        match self {
            Self::Free => None,
            Self::Along(Guide::Direction(d)) => Some(*d),
            Self::Along(Guide::Curve(points)) => tangent(std::slice::from_ref(points), x),
            Self::Beside(lines) => tangent(lines, x),
            Self::Around(centre) => Some(normal.cross(&(x - centre))),
        }
    }
}

/// Unit tangent of polylines at their point nearest to `x`.
fn tangent(lines: &[Vec<Vec3>], x: &Vec3) -> Option<Vec3> {
    let mut best: Option<(f64, Vec3)> = None;
    for w in lines.iter().flat_map(|l| l.windows(2)) {
        let d = w[1] - w[0];
        let length = d.norm_squared();
        if length <= 0.0 {
            continue;
        }
        let s = ((x - w[0]).dot(&d) / length).clamp(0.0, 1.0);
        let distance = (x - (w[0] + d * s)).norm_squared();
        if best.as_ref().is_none_or(|b| distance < b.0) {
            best = Some((distance, d / length.sqrt()));
        }
    }
    best.map(|b| b.1)
}

impl Cover {
    /// The lines of curves on a face, as far as these run over it; those that end on it go on straight to its border.
    fn seam_lines_of(&self, curves: &[PanelCurve], tolerance: f64) -> Vec<SeamLine> {
        let bounds = self.bounds();
        let on_face = curves.iter().flat_map(|c| self.lines_of(c, tolerance).unwrap_or_default());
        let line = |uv: Vec<[f64; 2]>| {
            let closed = uv.len() > 2 && uv.first() == uv.last();
            SeamLine::new(&self.face.surface, &if closed { uv } else { carried_on(&uv, bounds) })
        };
        on_face.filter(|l| l.len() > 1).map(line).collect()
    }

    /// Halves the edges of triangles beside a line as long as its height over them is not linear within `allowed` (mm): a loop within a
    /// triangle, or a bow across one of its sides, has no vertex on its other side.
    fn refine_beside(&mut self, line: &SeamLine, allowed: f64) {
        let mut height: HashMap<u32, f64> = HashMap::default();
        let mut linear: HashSet<(u32, u32)> = HashSet::default();
        for _ in 0..HALVINGS {
            for v in 0..self.jets.len() as u32 {
                height.entry(v).or_insert_with(|| line.height(&self.point(v)));
            }
            let mut middle: HashMap<(u32, u32), u32> = HashMap::default();
            for (a, b) in self.partition.triangles.iter().flat_map(|t| edges(*t)) {
                let key = (a.min(b), a.max(b));
                if linear.contains(&key) || middle.contains_key(&key) {
                    continue;
                }
                let [x, y] = [key.0, key.1].map(|v| self.point(v));
                let (h, k, long) = (height[&key.0], height[&key.1], (y - x).norm());
                let [p, q] = [key.0, key.1].map(|v| self.partition.vertices[v as usize]);
                let m = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
                let there = line.height(&self.face.surface.point(m[0], m[1]));
                let is_near = h.abs().min(k.abs()).min(there.abs()) <= long;
                if is_near && long > allowed && (there - 0.5 * (h + k)).abs() > allowed {
                    middle.insert(key, self.partition.vertices.len() as u32);
                    self.partition.vertices.push(m);
                } else {
                    linear.insert(key);
                }
            }
            if middle.is_empty() {
                return;
            }
            self.partition.split_edges(&middle);
            self.update();
        }
    }

    /// Cuts every region along the planes and curves of user seams.
    pub(super) fn cut_along_seams(&mut self, layout: &Layout, tolerance: f64) {
        self.seam_lines = Arc::new(self.seam_lines_of(&layout.seam_curves, tolerance));
        let (face, lines) = (Arc::clone(&self.face), Arc::clone(&self.seam_lines));
        lines.iter().for_each(|l| self.refine_beside(l, BESIDE * tolerance));
        let mut cut = |height: &dyn Fn(&Vec3) -> f64| {
            for label in self.partition.distinct_labels() {
                let fresh = self.partition.fresh_label();
                self.cut(label, fresh, |p| height(&face.surface.point(p[0], p[1])));
            }
        };
        layout.seams.iter().for_each(|s| cut(&|x| s.height(x)));
        lines.iter().for_each(|l| cut(&|x| l.height(x)));
        for label in self.partition.distinct_labels() {
            self.partition.split_components(label);
        }
    }
}

impl Region<'_> {
    /// Whether no user seam runs between this region and another.
    pub(super) fn is_on_same_side_as(&self, other: Region, seams: &[SeamPlane]) -> bool {
        let side = |region: &Region, height: &dyn Fn(&Vec3) -> f64| {
            // The vertex farthest from the plane: those on the plane tell nothing.
            let heights = region.points().into_iter().map(|x| height(&x));
            heights.fold(0.0, |m: f64, h| if h.abs() > m.abs() { h } else { m }) > 0.0
        };
        let same = |height: &dyn Fn(&Vec3) -> f64| side(self, height) == side(&other, height);
        seams.iter().all(|s| same(&|x| s.height(x))) && self.cover.seam_lines.iter().all(|l| same(&|x| l.height(x)))
    }
}

/// Share of the tolerance by which a seam may be cut beside its curve.
const BESIDE: f64 = 0.1;
/// Halvings of the triangles beside a curve at most.
const HALVINGS: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_are_those_of_the_nearest_segment() {
        let line = vec![Vec3::zeros(), Vec3::x(), Vec3::x(), Vec3::new(1.0, 2.0, 0.0)];
        let other = vec![Vec3::new(0.0, 0.0, 9.0), Vec3::new(0.0, 0.0, 8.0)];
        let lines = [line.clone(), other];
        assert_eq!(tangent(&lines, &Vec3::new(0.4, -1.0, 3.0)), Some(Vec3::x()));
        assert_eq!(tangent(&lines, &Vec3::new(1.5, 1.0, 0.0)), Some(Vec3::y()));
        assert_eq!(tangent(&lines, &Vec3::new(1.5, 1.0, 8.5)), Some(-Vec3::z()));
        assert_eq!(tangent(&[line[..1].to_vec()], &Vec3::zeros()), None);
    }
}
