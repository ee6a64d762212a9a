//! Regions divided in space: principal axes, cuts across them, extents of fields (C6).

use super::state::State;
use crate::geom::Vec3;
use crate::spline::field::Field;
use nalgebra as na;
use std::sync::Arc;

/// Sides of a region within this share of its size are one line of a face that closes.
const CLOSED: f64 = 1e-9;

impl State {
    /// Mean point and principal axes (longest first) of a region's vertices.
    pub(super) fn axes_of_region(&self, label: u32) -> (Vec3, [Vec3; 3]) {
        axes_of(&self.samples(label).iter().map(|s| (s.x, s.weight)).collect::<Vec<_>>())
    }

    /// Cuts a region across its `axis`-th principal axis in space (2: the diagonal of the first two) in the middle
    /// of its extent; returns the labels of all parts. `None` if the cut separates nothing.
    pub(super) fn halve(&mut self, label: u32, axis: usize) -> Option<Vec<u32>> {
        self.divide(label, axis, 2)
    }

    /// As [`State::halve`], into equal parts of the extent.
    pub(super) fn divide(&mut self, label: u32, axis: usize, parts: usize) -> Option<Vec<u32>> {
        let (mean, axes) = self.axes_of_region(label);
        let direction = match axis {
            0 | 1 => axes[axis],
            _ => (axes[0] + axes[1]).normalize(),
        };
        let along: Vec<f64> = self
            .partition
            .region_vertices(label)
            .into_iter()
            .map(|v| direction.dot(&(self.jets[v as usize].jet.p - mean)))
            .collect();
        let (lo, hi) = along.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
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
        let surface = Arc::clone(&self.surface);
        self.parted(label, |p| direction.dot(&(surface.point(p[0], p[1]) - mean)) - at)
    }

    /// Cuts a region that meets itself along a line of parameters at which the face closes, all round a pole or as a ring, along
    /// the line opposite; the labels of all parts. `None` for others.
    ///
    /// Round a pole a panel without a slit has no border there, and one with it would meet itself.
    pub(super) fn cut_open(&mut self, label: u32) -> Option<Vec<u32>> {
        let (d, middle) = self.meets_itself(label)?;
        self.parted(label, |p| p[d] - middle)
    }

    /// The parameter (0: u, 1: v) in which a region goes from one side of a face that closes to the other, and its middle.
    pub(in crate::search) fn meets_itself(&self, label: u32) -> Option<(usize, f64)> {
        let b = self.partition.bounds(label);
        let near = CLOSED * self.bbox(label).diagonal();
        let places: Vec<[f64; 2]> =
            self.partition.region_vertices(label).into_iter().map(|v| self.partition.vertices[v as usize]).collect();
        let closes = |d: usize| {
            let at_end = |p: &[f64; 2], end: f64| if d == 0 { [end, p[1]] } else { [p[0], end] };
            let side: Vec<Vec3> =
                places.iter().filter(|p| p[d] == b[2 * d]).map(|p| self.surface.point(p[0], p[1])).collect();
            let other = places.iter().filter(|p| p[d] == b[2 * d]).map(|p| at_end(p, b[2 * d + 1]));
            let meets = side.iter().zip(other).all(|(x, p)| (self.surface.point(p[0], p[1]) - x).norm() <= near);
            meets && side.iter().any(|x| (x - side[0]).norm() > near)
        };
        let d = (0..2).find(|&d| closes(d))?;
        Some((d, 0.5 * (b[2 * d] + b[2 * d + 1])))
    }

    /// Cuts a region where a function of the parameters is zero; the labels of all parts. `None` if that separates nothing.
    pub(super) fn parted(&mut self, label: u32, height: impl Fn([f64; 2]) -> f64) -> Option<Vec<u32>> {
        let fresh = self.partition.fresh_label();
        self.cut(label, fresh, height);
        let mut parts = self.partition.split_components(label);
        parts.extend(self.partition.split_components(fresh));
        parts.retain(|&p| self.partition.labels.contains(&p));
        (parts.len() > 1).then_some(parts)
    }

    /// Smallest and largest value of a field over a region's vertices.
    pub(super) fn range(&self, label: u32, field: &Field) -> (f64, f64) {
        self.partition
            .region_vertices(label)
            .into_iter()
            .map(|v| field.value(self.partition.vertices[v as usize]))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    }
}

/// Mean point and principal axes (longest first) of weighted points.
pub(super) fn axes_of(points: &[(Vec3, f64)]) -> (Vec3, [Vec3; 3]) {
    let total: f64 = points.iter().map(|p| p.1).sum::<f64>().max(f64::MIN_POSITIVE);
    let mean = points.iter().fold(Vec3::zeros(), |m, (x, w)| m + x * *w) / total;
    let mut c = na::Matrix3::zeros();
    for (x, w) in points {
        let d = x - mean;
        c += d * d.transpose() * *w;
    }
    let e = na::SymmetricEigen::new(c);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| e.eigenvalues[b].total_cmp(&e.eigenvalues[a]));
    (mean, order.map(|k| e.eigenvectors.column(k).into_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::face::Face;
    use crate::brep::support_surface::SupportSurface;
    use crate::geom::Frame;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn cap(turn: f64, down_to: f64) -> State {
        let sphere = SupportSurface::Sphere { frame: Frame::world(), radius: 10.0 };
        let (surface, _) = sphere.to_spline((0.0, turn), (down_to, FRAC_PI_2)).expect("a sphere");
        State::of_face(&Face::untrimmed(surface), 1.0).expect("triangles")
    }

    #[test]
    fn caps_round_a_pole_become_two_halves_that_end_on_it() {
        let mut state = cap(2.0 * PI, 1.2);
        let area = state.area(0);
        let parts = state.cut_open(0).expect("two halves");
        assert_eq!(parts.len(), 2);
        for l in parts {
            assert!((state.area(l) - 0.5 * area).abs() < 1e-6 * area);
            assert_eq!(state.cut_open(l), None);
        }
    }

    #[test]
    fn what_does_not_meet_itself_is_left_alone() {
        assert_eq!(cap(1.9 * PI, 1.2).cut_open(0), None);
    }
}
