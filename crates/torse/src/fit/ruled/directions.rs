//! The straightest directions of a surface: where straight lines touch it longest.
//!
//! *Method* \[W15, 2C\]: where the Gauss curvature is negative, the two asymptotic directions, in which the surface's
//! normal curvature is zero. They make the angle φ with the direction of the greater principal curvature k₁, where
//! `tan φ = ±√(−k₁/k₂)`. Departure from the notes: where the Gauss curvature is not negative, the principal direction
//! of the curvature nearer to zero, which both families run into at parabolic curves.

use crate::geom::Vec3;
use crate::spline::surface::SurfaceJet;
use std::collections::VecDeque;

/// Curvatures of a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvatures {
    /// Principal curvatures, the greater one first, 1/mm.
    pub principal: [f64; 2],
    /// Angle of the first principal direction in the frame, rad.
    angle: f64,
    /// Angle of the second parameter line in the frame, rad; the first is its first axis.
    second: f64,
    /// Orthonormal frame of the tangent plane in (u, v): unit vectors in space.
    frame: [[f64; 2]; 2],
}

impl Curvatures {
    /// Of a surface with its second derivatives; `None` where it has no tangent plane.
    pub fn of(jet: &SurfaceJet) -> Option<Self> {
        let (e, f, g) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
        let n = jet.du.cross(&jet.dv).try_normalize(0.0)?;
        let h = (g - f * f / e).max(0.0).sqrt();
        let frame = [[1.0 / e.sqrt(), 0.0], [-f / (e * h), 1.0 / h]];
        let second = |a: [f64; 2], b: [f64; 2]| {
            let mixed = a[0] * b[1] + a[1] * b[0];
            n.dot(&(jet.duu * (a[0] * b[0]) + jet.duv * mixed + jet.dvv * (a[1] * b[1])))
        };
        let (a, b, c) = (second(frame[0], frame[0]), second(frame[0], frame[1]), second(frame[1], frame[1]));
        let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
        let radius = half.hypot(b);
        let known = frame.iter().flatten().chain([&mean, &radius]).all(|x| x.is_finite());
        known.then(|| Self {
            principal: [mean + radius, mean - radius],
            angle: 0.5 * b.atan2(half),
            second: h.atan2(f / e.sqrt()),
            frame,
        })
    }

    /// Gauss curvature, 1/mm².
    pub fn gauss(&self) -> f64 {
        self.principal[0] * self.principal[1]
    }

    /// Positive where every direction bends to the same side: the lesser of both curvatures, 1/mm. Negative on saddles.
    pub fn least_bend(&self) -> f64 {
        self.gauss().signum() * self.principal[0].abs().min(self.principal[1].abs())
    }

    /// The straightest direction of a family and the direction a quarter turn to its left, in (u, v), of unit length in
    /// space.
    pub fn straightest(&self, family: Family) -> [[f64; 2]; 2] {
        let [k1, k2] = self.principal;
        let phi = k1.max(0.0).sqrt().atan2((-k2).max(0.0).sqrt());
        let angle = match family {
            Family::Left => self.angle + phi,
            Family::Right => self.angle - phi,
            Family::AlongU => 0.0,
            Family::AlongV => self.second,
        };
        let (s, c) = angle.sin_cos();
        let turned = |x: f64, y: f64| [0, 1].map(|d: usize| self.frame[0][d] * x + self.frame[1][d] * y);
        [turned(c, s), turned(-s, c)]
    }
}

/// A family of curves for rulings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// The asymptotic curves to the left of the first principal direction, seen from the surface's normal S_u × S_v.
    Left,
    /// Those to its right.
    Right,
    /// Lines of constant v.
    AlongU,
    /// Lines of constant u.
    AlongV,
}

impl Family {
    /// Whether the curves are the asymptotic ones.
    pub fn is_asymptotic(self) -> bool {
        matches!(self, Self::Left | Self::Right)
    }
}

/// A point of a region with its straightest direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// Parameters.
    pub uv: [f64; 2],
    /// Place in space, mm.
    pub place: Vec3,
    /// Straightest direction in (u, v), of unit length in space.
    pub along: [f64; 2],
    /// Direction across it.
    pub across: [f64; 2],
    /// Both in space.
    pub axes: [Vec3; 2],
    /// How much the direction counts, 0 to 1: nothing at planar points, which have none.
    pub weight: f64,
}

/// Curvature below this share of the mean counts less and less: near planar points directions turn fast.
const FLAT: f64 = 0.02;

/// Samples of a family at places of a surface, turned alike along `edges` between neighbours; `None` where a place has no
/// tangent plane.
pub(crate) fn samples(places: &[([f64; 2], SurfaceJet)], edges: &[[usize; 2]], family: Family) -> Option<Vec<Sample>> {
    let all: Vec<Curvatures> = places.iter().map(|p| Curvatures::of(&p.1)).collect::<Option<_>>()?;
    let strength = |c: &Curvatures| c.principal[0] - c.principal[1];
    let mean = all.iter().map(strength).sum::<f64>() / all.len().max(1) as f64;
    let mut out: Vec<Sample> = places
        .iter()
        .zip(&all)
        .map(|((uv, jet), c)| {
            let [along, across] = c.straightest(family);
            let axes = [along, across].map(|a| jet.du * a[0] + jet.dv * a[1]);
            let known = family.is_asymptotic() && mean > 0.0;
            let weight = if known { (strength(c) / (FLAT * mean)).min(1.0) } else { 1.0 };
            Sample { uv: *uv, place: jet.p, along, across, axes, weight }
        })
        .collect();
    let mut around = vec![Vec::new(); out.len()];
    for &[a, b] in edges {
        around[a].push(b);
        around[b].push(a);
    }
    let mut seen = vec![false; out.len()];
    // From the middle of the list's strongest point outwards; planar points last.
    let mut order: Vec<usize> = (0..out.len()).collect();
    order.sort_by(|&a, &b| out[b].weight.total_cmp(&out[a].weight));
    for start in order {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut queue = VecDeque::from([start]);
        while let Some(k) = queue.pop_front() {
            for &n in &around[k] {
                if !std::mem::replace(&mut seen[n], true) {
                    if out[n].axes[0].dot(&out[k].axes[0]) < 0.0 {
                        out[n].along = out[n].along.map(|x| -x);
                        out[n].across = out[n].across.map(|x| -x);
                        out[n].axes = out[n].axes.map(|x| -x);
                    }
                    queue.push_back(n);
                }
            }
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z = (a x² + b y²)/2 at (x, y).
    fn saddle(a: f64, b: f64, x: f64, y: f64) -> SurfaceJet {
        let z = Vec3::z();
        SurfaceJet {
            p: Vec3::new(x, y, 0.5 * (a * x * x + b * y * y)),
            du: Vec3::x() + z * (a * x),
            dv: Vec3::y() + z * (b * y),
            duu: z * a,
            duv: Vec3::zeros(),
            dvv: z * b,
        }
    }

    #[test]
    fn asymptotic_directions_have_no_normal_curvature() {
        for (x, y) in [(0.0, 0.0), (0.4, -0.3), (-0.2, 0.9)] {
            let jet = saddle(2.0, -1.0, x, y);
            let c = Curvatures::of(&jet).expect("curvatures");
            let n = jet.du.cross(&jet.dv).normalize();
            for family in [Family::Left, Family::Right] {
                let [d, e] = c.straightest(family);
                let bend = jet.duu * (d[0] * d[0]) + jet.duv * (2.0 * d[0] * d[1]) + jet.dvv * (d[1] * d[1]);
                assert!(n.dot(&bend).abs() < 1e-14);
                let (d, e) = (jet.du * d[0] + jet.dv * d[1], jet.du * e[0] + jet.dv * e[1]);
                assert!((d.norm() - 1.0).abs() < 1e-14 && d.dot(&e).abs() < 1e-14);
                assert!(d.cross(&e).dot(&n) > 0.99);
            }
        }
        let c = Curvatures::of(&saddle(2.0, -1.0, 0.0, 0.0)).expect("curvatures");
        assert!((c.gauss() + 2.0).abs() < 1e-14 && (c.least_bend() + 1.0).abs() < 1e-14);
        // tan φ = √(2/1) from the x-axis.
        let [d, _] = c.straightest(Family::Left);
        assert!(((d[1] / d[0]).abs() - 2f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn both_families_end_in_the_rulings_of_a_cylinder() {
        for (a, b, ruling) in
            [(2.0, 0.0, [0.0, 1.0]), (-2.0, 0.0, [0.0, 1.0]), (0.0, 3.0, [1.0, 0.0]), (2.0, 0.5, [0.0, 1.0])]
        {
            let c = Curvatures::of(&saddle(a, b, 0.0, 0.0)).expect("curvatures");
            for family in [Family::Left, Family::Right] {
                let [d, _] = c.straightest(family);
                assert!((d[0] * ruling[1] - d[1] * ruling[0]).abs() < 1e-12, "{a} {b} {d:?}");
            }
        }
    }

    #[test]
    fn parameter_lines_are_directions_too() {
        let mut jet = saddle(1.0, -2.0, 0.3, 0.2);
        jet.dv += jet.du * 0.4;
        let c = Curvatures::of(&jet).expect("curvatures");
        for (family, line) in [(Family::AlongU, jet.du), (Family::AlongV, jet.dv)] {
            let [d, e] = c.straightest(family);
            let (d, e) = (jet.du * d[0] + jet.dv * d[1], jet.du * e[0] + jet.dv * e[1]);
            assert!((d - line.normalize()).norm() < 1e-14 && d.dot(&e).abs() < 1e-14);
        }
    }

    #[test]
    fn neighbours_are_turned_alike() {
        let places: Vec<([f64; 2], SurfaceJet)> =
            (0..20).map(|k| 0.3 * f64::from(k)).map(|x| ([x, 0.0], saddle(1.0, -1.0, x, 0.5 * x))).collect();
        let edges: Vec<[usize; 2]> = (1..20).map(|k| [k - 1, k]).collect();
        let s = samples(&places, &edges, Family::Right).expect("samples");
        assert!(s.windows(2).all(|w| w[0].axes[0].dot(&w[1].axes[0]) > 0.5));
    }
}
