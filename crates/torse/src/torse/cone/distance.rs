//! Signed distances from cones, cylinders and planes in one closed form \[LP98\]; largest distance along a line.

use super::spline::{ConeSpline, Segment, Shape};
use crate::geom::Vec3;
use crate::torse::g1_element::G1Element;

/// The surface of revolution that carries a segment, as its signed distance along the normals:
/// `distance = rise·z − tilt·(ρ − radius)` with `z = (x − center)·axis` and ρ the distance from the axis.
///
/// Vertices at any distance, cylinders (`rise = 0`) and planes (`tilt = 0`) included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Round {
    /// Point of the axis nearest to the first element's point (that point itself for planes).
    pub center: Vec3,
    /// Unit direction of the axis.
    pub axis: Vec3,
    /// Distance of the first element's point from the axis, mm.
    pub radius: f64,
    /// Sine of the half opening angle.
    pub rise: f64,
    /// Its cosine, with the sign that makes the distance grow along the normal.
    pub tilt: f64,
}

impl Round {
    /// The support of a segment.
    pub fn of(segment: &Segment) -> Self {
        let s = &segment.start;
        match segment.shape {
            Shape::Cone { distance, cos_gamma: c, sin_gamma: k, .. } => {
                let reach = distance * k;
                Self {
                    center: s.point - (s.direction * k - s.normal * c) * reach,
                    axis: segment.axis(),
                    radius: reach.abs(),
                    rise: k,
                    tilt: distance.signum() * c,
                }
            }
            Shape::Cylinder { radius, .. } => Self {
                center: s.point - s.normal * radius,
                axis: s.direction,
                radius: radius.abs(),
                rise: 0.0,
                tilt: -radius.signum(),
            },
            Shape::Flat { .. } => Self { center: s.point, axis: s.normal, radius: 0.0, rise: 1.0, tilt: 0.0 },
        }
    }

    /// Signed distance of `x` from the half cone (cylinder, plane), positive on the side of the normals.
    pub fn distance(&self, x: &Vec3) -> f64 {
        let y = x - self.center;
        let z = y.dot(&self.axis);
        let rho = (y - self.axis * z).norm();
        self.rise * z - self.tilt * (rho - self.radius)
    }

    /// Largest absolute distance along the straight line from `a` to `b`: at an end or at the only stationary point.
    pub fn largest_on_line(&self, a: &Vec3, b: &Vec3) -> f64 {
        let ends = self.distance(a).abs().max(self.distance(b).abs());
        let d = b - a;
        let length = d.norm();
        if length == 0.0 || !length.is_finite() || self.tilt == 0.0 {
            return ends;
        }
        let d = d / length;
        let dw = d.dot(&self.axis);
        let y = a - self.center;
        let y = y - self.axis * y.dot(&self.axis);
        let across = d - self.axis * dw;
        // ρ² = p t² + 2 q t + r; stationary where ρ' = rise dw / tilt.
        let (p, q, r) = (across.norm_squared(), y.dot(&across), y.norm_squared());
        let k = self.rise * dw / self.tilt;
        if p <= k * k || p.is_nan() || k.is_nan() {
            return ends;
        }
        let t = k * ((r - q * q / p).max(0.0) / (p * (p - k * k))).sqrt() - q / p;
        if t > 0.0 && t < length {
            ends.max(self.distance(&(a + d * t)).abs())
        } else {
            ends
        }
    }
}

/// On which side of the normal plane along a ruling a point lies: positive forward. Both neighbours of a junction
/// share this plane, so it parts their wedges.
pub(crate) fn forward_of(ruling: &G1Element, x: &Vec3) -> f64 {
    (x - ruling.point).dot(&ruling.forward)
}

impl ConeSpline {
    /// The segment nearest to `x` and the distance, mm: the perpendicular one where `x` lies in the wedge between the
    /// normal planes of a segment's first and last ruling, otherwise that to a junction line. Rulings count as lines.
    pub fn nearest(&self, x: &Vec3) -> Option<(usize, f64)> {
        let line = |g: &G1Element| {
            let d = x - g.point;
            (d - g.direction * d.dot(&g.direction)).norm()
        };
        let mut best: Option<(usize, f64)> = None;
        for (i, s) in self.segments.iter().enumerate() {
            let end = s.end();
            let inside = forward_of(&s.start, x) >= 0.0 && forward_of(&end, x) <= 0.0;
            let d = if inside { Round::of(s).distance(x).abs() } else { line(&s.start).min(line(&end)) };
            if best.is_none_or(|(_, b)| d < b) {
                best = Some((i, d));
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_that_along_the_normal_and_the_largest_on_a_line_is_found() {
        let g = G1Element::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 0.2, -0.3), Vec3::new(0.3, 0.0, 1.0))
            .expect("element");
        for shape in [
            Shape::Cone { distance: 4.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: 0.7 },
            Shape::Cone { distance: -4.0, cos_gamma: 0.8, sin_gamma: 0.6, angle: -0.7 },
            Shape::Cone { distance: 1e8, cos_gamma: -(1.0f64 - 1e-16).sqrt(), sin_gamma: 1e-8, angle: 0.7 },
            Shape::Cone { distance: 4.0, cos_gamma: 0.0, sin_gamma: 1.0, angle: 0.7 },
            Shape::Cylinder { radius: 2.0, angle: -0.7 },
            Shape::Cylinder { radius: -2.0, angle: 0.7 },
            Shape::Flat { width: 0.7 },
        ] {
            let s = Segment::new(g, shape);
            let round = Round::of(&s);
            let at = |f: f64, r: f64, d: f64| s.point(f, r) + s.element(f).normal * d;
            for (f, r, d) in [(0.0, 0.3, 0.1), (0.6, -0.4, -0.2), (1.0, 0.0, 0.0)] {
                assert!((round.distance(&at(f, r, d)) - d).abs() < 1e-12, "{s:?}");
            }
            let (a, b) = (at(0.1, -0.5, 0.02), at(0.4, 0.7, -0.05));
            let dense =
                (0..=5000).map(|i| round.distance(&(a + (b - a) * (i as f64 / 5000.0))).abs()).fold(0.0, f64::max);
            let exact = round.largest_on_line(&a, &b);
            assert!(exact >= dense - 1e-15 && exact < dense + 1e-6, "{s:?} {exact} {dense}");
        }
    }
}
