//! Creases of a face: knot lines of full multiplicity, across which a smooth surface may be parametrised at another
//! speed, and an almost smooth one has two normals.

use crate::brep::face::Face;
use crate::geom::Vec3;

/// Part of an edge, or of a knot span, beside a crease at whose end speed and normal of that side are taken.
const BESIDE: f64 = 1e-6;

/// The lines u = const and v = const of a face across which its first derivatives may jump.
pub(super) struct Creases<'a> {
    face: &'a Face,
    lines: [Vec<f64>; 2],
    /// Mean length in space (mm) of the units of u and v.
    scale: [f64; 2],
}

impl<'a> Creases<'a> {
    pub(super) fn new(face: &'a Face, scale: [f64; 2]) -> Self {
        let (u, v) = face.surface.c0_lines();
        Self { face, lines: [u, v], scale }
    }

    /// Direction in which panels of both sides end at a point of the face: its normal, the mean of those on all sides of
    /// creases. Zero where there is none.
    pub(super) fn normal(&self, p: [f64; 2]) -> Vec3 {
        let steps = [0, 1].map(|d: usize| {
            let Some(i) = self.lines[d].iter().position(|l| *l == p[d]) else { return vec![0.0] };
            let knots = if d == 0 { &self.face.surface.knots_u } else { &self.face.surface.knots_v };
            let near = |other: Option<&f64>, end: f64| BESIDE * (other.copied().unwrap_or(end) - p[d]);
            let (a, b) = knots.domain();
            vec![near(i.checked_sub(1).map(|i| &self.lines[d][i]), a), near(self.lines[d].get(i + 1), b)]
        });
        let all = steps[0].iter().flat_map(|u| steps[1].iter().map(move |v| [p[0] + u, p[1] + v]));
        all.map(|q| self.one_sided(q)).sum()
    }

    /// The same at the fraction `l` of an edge from `p` to `q`, steady along the edge.
    pub(super) fn normal_between(&self, p: [f64; 2], q: [f64; 2], l: f64) -> Vec3 {
        let at = |l: f64| [p[0] + (q[0] - p[0]) * l, p[1] + (q[1] - p[1]) * l];
        let mut normal = self.one_sided(at(l.clamp(BESIDE, 1.0 - BESIDE)));
        for (end, share, beside) in [(p, 1.0 - l, at(BESIDE)), (q, l, at(1.0 - BESIDE))] {
            if (0..2).any(|d| self.lines[d].contains(&end[d])) {
                let mean = self.normal(end).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
                normal += (mean - self.one_sided(beside)) * share;
            }
        }
        normal
    }

    fn one_sided(&self, p: [f64; 2]) -> Vec3 {
        self.face.surface.jet(p[0], p[1]).normal().try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    }

    /// Factor by which the length in space per scaled length in the parameter plane jumps at `b` on a way from `a` to
    /// `c`; 1 away from creases and where the surface collapses.
    pub(super) fn gain(&self, [a, b, c]: [[f64; 2]; 3]) -> f64 {
        if !(0..2).any(|d| self.lines[d].contains(&b[d])) {
            return 1.0;
        }
        let speed = |p: [f64; 2]| {
            let d = [p[0] - b[0], p[1] - b[1]];
            let j = self.face.surface.jet(b[0] + BESIDE * d[0], b[1] + BESIDE * d[1]);
            (j.du * d[0] + j.dv * d[1]).norm() / (self.scale[0] * d[0]).hypot(self.scale[1] * d[1])
        };
        let gain = speed(c) / speed(a);
        if gain.is_finite() && gain > 0.0 {
            gain
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    #[test]
    fn speeds_jump_on_full_knots_only() {
        // A plane, three times as fast in u > 1 as before.
        let ku = Knots::new(2, vec![0., 0., 0., 1., 1., 2., 2., 2.], 5).expect("knots");
        let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let points: Vec<Vec3> = [0.0, 5.0, 10.0, 25.0, 40.0]
            .into_iter()
            .flat_map(|x| [Vec3::new(x, 0.0, 0.0), Vec3::new(x, 7.0, 0.0)])
            .collect();
        let face = Face::untrimmed(Surface::new(ku, kv, &points, None).expect("surface"));
        let creases = Creases::new(&face, [20.0, 7.0]);
        let gain = |a, b, c| creases.gain([a, b, c]);
        assert!((gain([0.8, 0.5], [1.0, 0.5], [1.3, 0.5]) - 3.0).abs() < 1e-9);
        assert!((gain([1.3, 0.5], [1.0, 0.5], [0.9, 0.5]) - 1.0 / 3.0).abs() < 1e-9);
        // Along the crease, and away from it.
        assert!((gain([1.0, 0.1], [1.0, 0.2], [1.0, 0.3]) - 1.0).abs() < 1e-12);
        assert!((gain([0.4, 0.5], [0.5, 0.5], [0.9, 0.5]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn normals_turn_steadily_across_a_crease() {
        // Two planes that meet in u = 1 at an angle of 2 · 0.1 rad.
        let ku = Knots::clamped(1, &[0.0, 1.0, 2.0]).expect("knots");
        let kv = Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let slope = 0.1_f64.tan();
        let points: Vec<Vec3> = [(0.0, 0.0), (10.0, 10.0 * slope), (20.0, 0.0)]
            .into_iter()
            .flat_map(|(x, z)| [Vec3::new(x, 0.0, z), Vec3::new(x, 7.0, z)])
            .collect();
        let face = Face::untrimmed(Surface::new(ku, kv, &points, None).expect("surface"));
        let creases = Creases::new(&face, [10.0, 7.0]);
        let turn = |n: Vec3| n.x.atan2(n.z);
        assert!(turn(creases.normal([1.0, 0.4])).abs() < 1e-12);
        assert!((turn(creases.normal([0.5, 0.4])) + 0.1).abs() < 1e-12);
        let along = |p: f64, q: f64, l: f64| turn(creases.normal_between([p, 0.4], [q, 0.4], l));
        assert!(along(0.8, 1.0, 1.0).abs() < 1e-9 && along(1.0, 1.2, 0.0).abs() < 1e-9);
        assert!((along(0.8, 1.0, 0.0) + 0.1).abs() < 1e-9 && (along(1.0, 1.2, 1.0) - 0.1).abs() < 1e-9);
        assert!(along(0.8, 1.0, 0.5) < -0.04 && along(0.8, 1.0, 0.5) > -0.06);
    }
}
