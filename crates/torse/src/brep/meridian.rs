//! Surfaces of revolution among the surfaces of faces, whatever their file called them: the axis, and the curve that is turned about it.
//!
//! Looks at places of the surface; proves nothing.

use super::recognised_surface::frame;
use crate::geom::{Frame, Vec2, Vec3};
use crate::spline::surface::Surface;
use std::f64::consts::TAU;

/// Circles looked at.
const CIRCLES: usize = 17;
/// Places on each of them, ends included.
const PLACES: usize = 13;
/// Circles smaller than this share of the largest say nothing about the axis.
const SMALL: f64 = 0.1;
/// Arcs whose radius is so many times their extent are lines.
const STRAIGHT: f64 = 1e4;
/// A radius below this share of the largest is none: the curve has come to the axis.
const POLE: f64 = 1e-9;

/// The curve of which a surface is made by turning it about an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meridian<'a> {
    surface: &'a Surface,
    /// Axis z; x where the part begins.
    pub frame: Frame,
    /// Angle (rad) of the part about the axis, negative where it is turned the other way; a whole turn at most.
    pub turn: f64,
    /// Range of the curve's parameter.
    pub range: (f64, f64),
    /// Range of the other one.
    around: (f64, f64),
    /// Whether v is the curve's parameter.
    swapped: bool,
}

impl<'a> Meridian<'a> {
    /// The meridian over the box `[u0, u1, v0, v1]` of the domain of a surface that keeps to one of revolution within `slack`
    /// (mm) at samples; parameter lines must be its circles. `None` where there is none, and where it lies in a plane square to the
    /// axis.
    pub fn of(surface: &'a Surface, [u0, u1, v0, v1]: [f64; 4], slack: f64) -> Option<Self> {
        let made = |range: (f64, f64), around: (f64, f64), swapped: bool| {
            let bare = Self { surface, frame: Frame::world(), turn: 0.0, range, around, swapped };
            bare.about_its_axis(slack)
        };
        made((v0, v1), (u0, u1), true).or_else(|| made((u0, u1), (v0, v1), false))
    }

    /// The same with the axis of its circles, if there is one.
    fn about_its_axis(self, slack: f64) -> Option<Self> {
        let at = |k: usize, count: usize, (lo, hi): (f64, f64)| lo + (hi - lo) * k as f64 / (count - 1) as f64;
        let rows: Vec<Vec<Vec3>> = (0..CIRCLES)
            .map(|i| {
                let t = at(i, CIRCLES, self.range);
                (0..PLACES).map(|k| self.point(t, at(k, PLACES, self.around))).collect()
            })
            .collect();
        let circles: Vec<Circle> = rows.iter().filter_map(|r| Circle::through(r)).collect();
        let largest = circles.iter().max_by(|a, b| a.radius.total_cmp(&b.radius))?;
        let far = circles
            .iter()
            .filter(|c| c.radius > SMALL * largest.radius)
            .max_by(|a, b| a.off(largest).total_cmp(&b.off(largest)))?;
        // Centres far apart tell the axis best.
        let between = far.centre - largest.centre;
        let z = if between.norm() > largest.radius {
            between.normalize() * between.dot(&largest.axis).signum()
        } else {
            largest.axis
        };
        let first = rows
            .iter()
            .map(|r| r[0])
            .max_by(|a, b| away(&z, &largest.centre, a).total_cmp(&away(&z, &largest.centre, b)))?;
        let out = first - largest.centre;
        let x = (out - z * out.dot(&z)).try_normalize(0.0)?;
        let frame = Frame { x, y: z.cross(&x), ..frame(largest.centre, z) };
        let heights_and_radii = |p: &Vec3| {
            let q = frame.to_local(p);
            Vec2::new(q.x.hypot(q.y), q.z)
        };
        let holds = rows.iter().all(|r| {
            let reference = heights_and_radii(&r[0]);
            r.iter().all(|p| (heights_and_radii(p) - reference).norm() <= slack)
        });
        if !holds {
            return None;
        }
        // Turns from place to place of the largest circle add up to that of the part.
        let row = rows.iter().max_by(|a, b| heights_and_radii(&a[0]).x.total_cmp(&heights_and_radii(&b[0]).x))?;
        let angle = |p: &Vec3| {
            let q = frame.to_local(p);
            q.y.atan2(q.x)
        };
        let step = |w: &[Vec3]| {
            let d = angle(&w[1]) - angle(&w[0]);
            d - TAU * (d / TAU).round()
        };
        let turn: f64 = row.windows(2).map(step).sum();
        let (whole, radius) = (TAU.copysign(turn), heights_and_radii(&row[0]).x);
        let turn = if (turn - whole).abs() * radius <= slack || turn.abs() > TAU { whole } else { turn };
        let heights = rows.iter().map(|r| heights_and_radii(&r[0]).y);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), z| (a.min(z), b.max(z)));
        (radius > 0.0 && high - low > slack && turn != 0.0).then_some(Self { frame, turn, ..self })
    }

    /// Distance from the axis and height along it (mm) at the parameter `t`, and their derivatives.
    pub fn jet(&self, t: f64) -> [Vec2; 2] {
        let [u, v] = self.place(t, self.around.0);
        let j = self.surface.jet(u, v);
        let (p, d) = (self.frame.to_local(&j.p), if self.swapped { j.dv } else { j.du });
        let d = self.frame.vector_to_local(&d);
        [Vec2::new(p.x, p.z), Vec2::new(d.x, d.z)]
    }

    /// Whether the curve comes to the axis where it begins, and where it ends.
    pub fn ends_on_axis(&self) -> [bool; 2] {
        let at = |k: usize| self.jet(self.range.0 + (self.range.1 - self.range.0) * k as f64 / CIRCLES as f64)[0].x;
        let largest = (0..=CIRCLES).map(at).fold(0.0, f64::max);
        [0, CIRCLES].map(|k| at(k) <= POLE * largest)
    }

    /// Whether it is turned all round.
    pub fn is_whole(&self) -> bool {
        self.turn.abs() == TAU
    }

    /// The other parameter at a share of the turn, above 0 and below 1, in the middle of the curve.
    pub fn around(&self, share: f64) -> f64 {
        let t = 0.5 * (self.range.0 + self.range.1);
        // How far it has turned up to there, rad.
        let turned = |s: f64| {
            let q = self.frame.to_local(&self.point(t, s));
            (q.y.atan2(q.x) * self.turn.signum()).rem_euclid(TAU)
        };
        let (mut lo, mut hi) = self.around;
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (lo + hi);
            *(if turned(middle) < share * self.turn.abs() { &mut lo } else { &mut hi }) = middle;
        }
        0.5 * (lo + hi)
    }

    /// Which parameter of the surface is the curve's: 0 for u, 1 for v.
    pub fn along(&self) -> usize {
        usize::from(self.swapped)
    }

    /// How much of the other parameter a radian takes, in the mean.
    pub fn per_radian(&self) -> f64 {
        (self.around.1 - self.around.0) / self.turn.abs()
    }

    /// Values of u and of v from values of the curve's parameter and of the other one.
    pub fn lines(&self, along: Vec<f64>, around: Vec<f64>) -> [Vec<f64>; 2] {
        if self.swapped {
            [around, along]
        } else {
            [along, around]
        }
    }

    fn place(&self, t: f64, s: f64) -> [f64; 2] {
        if self.swapped {
            [s, t]
        } else {
            [t, s]
        }
    }

    fn point(&self, t: f64, s: f64) -> Vec3 {
        let [u, v] = self.place(t, s);
        self.surface.point(u, v)
    }
}

/// How far a point is from an axis through another one.
fn away(z: &Vec3, centre: &Vec3, p: &Vec3) -> f64 {
    (p - centre).cross(z).norm()
}

/// A circle.
struct Circle {
    centre: Vec3,
    /// Unit normal of its plane; points run about it to the left.
    axis: Vec3,
    radius: f64,
}

impl Circle {
    /// The circle through the first point of an arc, which may be whole, one at a third of it and one at two thirds.
    fn through(arc: &[Vec3]) -> Option<Self> {
        let third = (arc.len() - 1) / 3;
        let [p, q, r] = [arc[0], arc[third], arc[2 * third]];
        let (a, b) = (q - p, r - p);
        let n = a.cross(&b);
        let square = n.norm_squared();
        let centre = p + (n.cross(&a) * b.norm_squared() + b.cross(&n) * a.norm_squared()) / (2.0 * square);
        let circle = Self { centre, axis: n.try_normalize(0.0)?, radius: (p - centre).norm() };
        (circle.radius <= STRAIGHT * a.norm().max(b.norm())).then_some(circle)
    }

    /// Distance between two centres.
    fn off(&self, other: &Self) -> f64 {
        (self.centre - other.centre).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::space_curve::SpaceCurve;
    use crate::brep::swept::{extrude, revolve};
    use crate::spline::curve::Curve;
    use crate::spline::knots::Knots;

    /// A wave of 20 to 50 mm radius about an axis that is aslant, or the same extruded.
    fn wave() -> (SpaceCurve, Frame) {
        let axis = frame(Vec3::new(3.0, -7.0, 11.0), Vec3::new(1.0, 2.0, -2.0).normalize());
        let heights = [(20.0, 0.0), (60.0, 30.0), (10.0, 60.0), (45.0, 100.0)];
        let control = heights.map(|(r, z)| {
            let p = axis.to_world(&Vec3::new(r, 0.0, z));
            [p.x, p.y, p.z, 1.0]
        });
        let curve = Curve { knots: Knots::clamped(3, &[0.0, 1.0]).expect("knots"), control: control.to_vec() };
        (SpaceCurve::Spline(curve), axis)
    }

    #[test]
    fn axes_are_found() {
        let (curve, axis) = wave();
        for (turn, whole) in [(TAU, true), (0.7, false)] {
            let surface = revolve(&curve, &axis, (0.4, 0.4 + turn), (0.0, 1.0)).expect("a surface").0;
            let ((u0, u1), (v0, v1)) = surface.domain();
            let m = Meridian::of(&surface, [u0, u1, v0, v1], 1e-9).expect("a meridian");
            assert!((m.frame.z.dot(&axis.z).abs() - 1.0).abs() < 1e-12, "{:?}", m.frame);
            assert!((m.turn.abs() - turn).abs() < 1e-9 && m.is_whole() == whole, "{}", m.turn);
            assert_eq!(m.ends_on_axis(), [false; 2]);
            let third = m.frame.to_local(&m.point(0.5, m.around(1.0 / 3.0)));
            let turned = (third.y.atan2(third.x) * m.turn.signum()).rem_euclid(TAU);
            assert!((turned - m.turn.abs() / 3.0).abs() < 1e-9, "{turned}");
            let [p, d] = m.jet(0.5);
            let off = 1e-6;
            let difference = (m.jet(0.5 + off)[0] - m.jet(0.5 - off)[0]) / (2.0 * off);
            assert!(p.x > 20.0 && p.x < 50.0 && (difference - d).norm() < 1e-5, "{p} {d}");
        }
    }

    #[test]
    fn other_surfaces_have_none() {
        let (curve, axis) = wave();
        let surface = extrude(&curve, &axis.y, (0.0, 1.0), (0.0, 50.0)).expect("a surface").0;
        assert!(Meridian::of(&surface, [0.0, 1.0, 0.0, 50.0], 1e-3).is_none());
        // Lines are no circles, however large.
        let k = || Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let corners = [(0.0, 0.0, 0.1), (0.0, 70.0, 0.3), (90.0, 0.0, 7.0), (90.0, 70.0, 33.0)];
        let corners = corners.map(|(x, y, z)| Vec3::new(x, y, z));
        let surface = Surface::new(k(), k(), &corners, None).expect("a surface");
        assert!(Meridian::of(&surface, [0.0, 1.0, 0.0, 1.0], 1.0).is_none());
    }
}
