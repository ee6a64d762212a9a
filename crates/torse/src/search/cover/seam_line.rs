//! Lines on a face that seams must follow (docs/algorithms/cover.md, "Layouts on demand").

use crate::brep::face::Face;
use crate::develop::unfold::region::FlatRegion;
use crate::geom::segment::{foot, segment_distance};
use crate::geom::{Vec2, Vec3};
use crate::spline::surface::Surface;

/// A line on a face that a seam must follow.
#[derive(Clone, Debug, PartialEq)]
pub struct SeamLine {
    /// Points in the parameter plane.
    places: Vec<[f64; 2]>,
    /// The same in space, mm.
    points: Vec<Vec3>,
    /// For every stretch the unit vector square to it in the face, to its left.
    sides: Vec<Vec3>,
}

impl SeamLine {
    /// The line through points of the parameter plane, which may lie beyond the domain.
    pub fn new(surface: &Surface, uv: &[[f64; 2]]) -> Self {
        let at = |p: &[f64; 2]| surface.extended_jet(p[0], p[1]);
        let side = |w: &[[f64; 2]]| {
            let (p, q) = (&w[0], &w[1]);
            let normal = at(&[0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]).normal();
            normal.cross(&(at(q).p - at(p).p)).try_normalize(0.0).unwrap_or_default()
        };
        Self {
            places: uv.to_vec(),
            points: uv.iter().map(|p| at(p).p).collect(),
            sides: uv.windows(2).map(side).collect(),
        }
    }

    /// The point of the line within a face that is farthest (mm) from edges of panels, polylines in space.
    pub fn farthest_from(&self, face: &Face, edges: &[Vec<Vec3>]) -> Option<(f64, Vec3)> {
        let loops = face.loops.iter().map(|l| l.points.iter().map(|p| Vec2::new(p[0], p[1])).collect()).collect();
        let region = FlatRegion::from_loops(loops);
        let off = |x: &Vec3| {
            let stretches = edges.iter().flat_map(|e| e.windows(2));
            stretches.map(|w| segment_distance([x, x], [&w[0], &w[1]])).fold(f64::INFINITY, f64::min)
        };
        let within = self.places.iter().zip(&self.points).filter(|(p, _)| region.contains(&Vec2::new(p[0], p[1])));
        within.map(|(_, x)| (off(x), *x)).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Distance (mm) of a point from the line, negative to its right.
    pub fn height(&self, x: &Vec3) -> f64 {
        let mut best = (f64::INFINITY, 0.0);
        for (w, side) in self.points.windows(2).zip(&self.sides) {
            let off = x - foot(&w[0], &w[1], x);
            if off.norm_squared() < best.0 {
                best = (off.norm_squared(), off.dot(side));
            }
        }
        best.0.sqrt().copysign(best.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;

    #[test]
    fn heights_are_signed_distances_from_the_line() {
        let k = Knots::clamped(1, &[0.0, 10.0]).expect("knots");
        let at = |u: f64, v: f64| Vec3::new(u, v, 0.0);
        let corners = [at(0.0, 0.0), at(0.0, 10.0), at(10.0, 0.0), at(10.0, 10.0)];
        let plane = Surface::new(k.clone(), k, &corners, None).expect("a plane");
        let line = SeamLine::new(&plane, &[[-5.0, 4.0], [5.0, 4.0], [15.0, 4.0]]);
        assert!((line.height(&at(3.0, 6.0)) - 2.0).abs() < 1e-12);
        assert!((line.height(&at(8.0, 1.0)) + 3.0).abs() < 1e-12);
        assert_eq!(line.height(&at(5.0, 4.0)), 0.0);
    }
}
