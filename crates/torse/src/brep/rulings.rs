//! Straight parameter lines of a surface along which its tangent plane stays the same: the rulings of planes, cylinders,
//! cones, extrusions and ruled developables, whatever the file called them (docs/algorithms/cover.md).
//!
//! Looks at places of the surface; proves nothing.

use crate::geom::Vec3;
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;

/// Spans are looked at in so many places across the lines …
const ACROSS: usize = 6;
/// … and lines in so many places along them, ends included.
const ALONG: usize = 7;
/// Share of the range beside a knot line at which curvatures of its two sides are compared.
const BESIDE: f64 = 1e-7;
/// Weights that differ by less than this share are one.
const SAME_WEIGHT: f64 = 1e-14;
/// A normal shorter than this share of that in the middle of its line belongs to an apex, where only rounding gives it a
/// direction: next to an apex normals grow in proportion, and no file has more digits than that for points.
const VANISHED: f64 = 1e-9;
/// Extent of an end of the lines, as a share of them, below which it is a point.
const POINT: f64 = 1e-9;
/// Lines looked at for that.
const LOOKED_AT: usize = 33;
/// Turns between so many lines tell how sharply a surface is bent.
const TURNS: usize = 64;
/// Relative difference above which they count as different.
const JUMP: f64 = 1e-3;

/// A parameter line that is straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StraightLine {
    /// A point of it, mm.
    pub point: Vec3,
    /// Unit direction, towards growing parameter along the line.
    pub direction: Vec3,
    /// Unit normal of the surface along it.
    pub normal: Vec3,
    /// Length of its part over the box, mm.
    pub length: f64,
}

/// The straight parameter lines of a part of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Rulings<'a> {
    surface: &'a Surface,
    /// Range of the parameter that selects a line.
    across: (f64, f64),
    /// Range of the parameter along the lines.
    along: (f64, f64),
    /// Whether v selects the line.
    swapped: bool,
}

impl<'a> Rulings<'a> {
    /// The rulings over the box `[u0, u1, v0, v1]` of the domain: lines of constant u or of constant v that are straight
    /// and keep their tangent plane within `slack` (mm), at samples. `None` where neither do.
    pub fn of(surface: &'a Surface, bounds: [f64; 4], slack: f64) -> Option<Self> {
        let [u0, u1, v0, v1] = bounds;
        let one = Self { surface, across: (u0, u1), along: (v0, v1), swapped: false };
        let other = Self { surface, across: (v0, v1), along: (u0, u1), swapped: true };
        [one, other].into_iter().find(|r| r.hold(slack))
    }

    /// Whether v selects the line.
    pub fn is_swapped(&self) -> bool {
        self.swapped
    }

    /// Range of the parameter that selects a line.
    pub fn range(&self) -> (f64, f64) {
        self.across
    }

    /// Ends of the range and the surface's knots between them.
    pub fn breaks(&self) -> Vec<f64> {
        let knots = if self.swapped { &self.surface.knots_v } else { &self.surface.knots_u };
        let (a, b) = self.across;
        let mut out = vec![a];
        out.extend(knots.breaks().into_iter().filter(|&s| s > a && s < b));
        out.push(b);
        out
    }

    /// The line at `s`; `None` where it has no length or the surface no normal.
    pub fn line(&self, s: f64) -> Option<StraightLine> {
        let (lo, hi) = self.along;
        let [p, q] = [lo, hi].map(|r| self.surface.point(self.place(s, r)[0], self.place(s, r)[1]));
        let direction = (q - p).try_normalize(0.0)?;
        let normal = self.normal(s, 0.5 * (lo + hi))?;
        Some(StraightLine { point: 0.5 * (p + q), direction, normal, length: (q - p).norm() })
    }

    /// The curve across the lines through their middles, if its coordinates are polynomials of the parameter across; it may
    /// reach beyond the range.
    pub fn middle(&self) -> Option<Curve<3>> {
        let at = 0.5 * (self.along.0 + self.along.1);
        let Curve { knots, control } =
            if self.swapped { self.surface.curve_at_u(at) } else { self.surface.curve_at_v(at) };
        let weight = control[0][3];
        let polynomial = control.iter().all(|h| (h[3] - weight).abs() <= SAME_WEIGHT * weight.abs());
        polynomial
            .then(|| Curve { knots, control: control.iter().map(|h| [0, 1, 2].map(|k: usize| h[k] / h[3])).collect() })
    }

    /// Lengths (mm) of the derivative across the line at `s`, square to it, at both ends.
    pub fn breadths(&self, s: f64) -> Option<[f64; 2]> {
        let direction = self.line(s)?.direction;
        let (lo, hi) = self.along;
        Some([lo, hi].map(|r| {
            let [u, v] = self.place(s, r);
            let j = self.surface.jet(u, v);
            let across = if self.swapped { j.dv } else { j.du };
            (across - direction * across.dot(&direction)).norm()
        }))
    }

    /// Whether the lines meet in a point at either end, for all that a file can tell.
    pub fn end_in_points(&self) -> [bool; 2] {
        let (a, b) = self.across;
        let (lo, hi) = self.along;
        let point = |k: usize, r: f64| {
            let [u, v] = self.place(a + (b - a) * (k as f64 + 0.5) / LOOKED_AT as f64, r);
            self.surface.point(u, v)
        };
        let length = (0..LOOKED_AT).map(|k| (point(k, hi) - point(k, lo)).norm()).fold(0.0, f64::max);
        [lo, hi].map(|r| (0..LOOKED_AT).all(|k| (point(k, r) - point(0, r)).norm() <= POINT * length))
    }

    /// Least radius of curvature (mm) at one end of the lines, 0 where they begin: from turns between lines; `None` where the
    /// face does not bend.
    pub fn least_radius_estimate(&self, end: usize) -> Option<f64> {
        let (a, b) = self.across;
        let at = |k: usize| a + (b - a) * k as f64 / TURNS as f64;
        let between = |k: usize| {
            let turn = self.line(at(k))?.normal.angle(&self.line(at(k + 1))?.normal);
            let breadth = self.breadths(0.5 * (at(k) + at(k + 1)))?[end] * (at(k + 1) - at(k));
            (turn > 0.0).then(|| breadth / turn)
        };
        (0..TURNS).filter_map(between).reduce(f64::min)
    }

    /// Values of u and of v from values of the parameter across the lines and of that along them.
    pub fn lines(&self, across: Vec<f64>, along: Vec<f64>) -> [Vec<f64>; 2] {
        if self.swapped {
            [along, across]
        } else {
            [across, along]
        }
    }

    /// Range of the parameter along the lines.
    pub fn reach(&self) -> (f64, f64) {
        self.along
    }

    /// The sharpest edge inside, at a break across which the normal turns by more than `least` (rad): its middle, and by how much.
    pub fn kink(&self, least: f64) -> Option<(Vec3, f64)> {
        let (a, b) = self.across;
        let (beside, middle) = (BESIDE * (b - a), 0.5 * (self.along.0 + self.along.1));
        let breaks = self.breaks();
        let turn = |&s: &f64| {
            let [before, after] = [s - beside, s + beside].map(|s| self.normal(s, middle));
            let [u, v] = self.place(s, middle);
            Some((self.surface.point(u, v), before?.angle(&after?)))
        };
        let kinks = breaks[1..breaks.len() - 1].iter().filter_map(turn).filter(|k| k.1 > least);
        kinks.max_by(|p, q| p.1.total_cmp(&q.1))
    }

    /// Whether the normal curvature across the lines jumps at an inner break.
    pub fn bends_anew(&self, s: f64) -> bool {
        let (a, b) = self.across;
        let beside = BESIDE * (b - a);
        let curvature = |s: f64| {
            let [u, v] = self.place(s, 0.5 * (self.along.0 + self.along.1));
            let j = self.surface.jet(u, v);
            let n = j.normal().try_normalize(0.0)?;
            let (across, along, second) = if self.swapped { (j.dv, j.du, j.dvv) } else { (j.du, j.dv, j.duu) };
            let along = along.try_normalize(0.0)?;
            // Along the rulings the second form vanishes, mixed terms included.
            let width = (across - along * across.dot(&along)).norm_squared();
            Some(n.dot(&second) / width)
        };
        match (curvature(s - beside), curvature(s + beside)) {
            (Some(k), Some(l)) => (k - l).abs() > JUMP * k.abs().max(l.abs()),
            _ => true,
        }
    }

    fn place(&self, s: f64, r: f64) -> [f64; 2] {
        if self.swapped {
            [r, s]
        } else {
            [s, r]
        }
    }

    fn normal(&self, s: f64, r: f64) -> Option<Vec3> {
        self.across_both(s, r).try_normalize(0.0)
    }

    /// Product of both derivatives: along the normal, as long as the parameters' net is wide.
    fn across_both(&self, s: f64, r: f64) -> Vec3 {
        let [u, v] = self.place(s, r);
        self.surface.jet(u, v).normal()
    }

    /// Whether lines are straight and keep their tangent planes.
    fn hold(&self, slack: f64) -> bool {
        let at = |(lo, hi): (f64, f64), k: usize, n: usize| lo + (hi - lo) * k as f64 / (n - 1) as f64;
        self.breaks().windows(2).all(|w| {
            (0..ACROSS).all(|k| {
                // Off the knot lines, where normals have two sides.
                let s = w[0] + (w[1] - w[0]) * (k as f64 + 0.5) / ACROSS as f64;
                let Some(line) = self.line(s) else { return false };
                let least = VANISHED * self.across_both(s, 0.5 * (self.along.0 + self.along.1)).norm();
                let mut reach = 0.0_f64;
                let mut turn = 0.0_f64;
                for i in 0..ALONG {
                    let r = at(self.along, i, ALONG);
                    let [u, v] = self.place(s, r);
                    let off = self.surface.point(u, v) - line.point;
                    let along = off.dot(&line.direction);
                    if (off - line.direction * along).norm() > slack {
                        return false;
                    }
                    reach = reach.max(along.abs());
                    // At an apex there is no normal.
                    let n = self.across_both(s, r).try_normalize(least);
                    turn = turn.max(n.map_or(0.0, |n| n.cross(&line.normal).norm()));
                }
                turn * reach <= slack
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SupportSurface;
    use crate::geom::Frame;

    fn spline(c: &SupportSurface) -> Surface {
        c.to_spline((0.2, 2.9), (-1.0, 1.5)).expect("a spline").0
    }

    fn whole(s: &Surface) -> [f64; 4] {
        let ((a, b), (c, d)) = s.domain();
        [a, b, c, d]
    }

    #[test]
    fn cylinders_and_cones_have_rulings_and_spheres_have_none() {
        let frame = Frame::world();
        for c in
            [SupportSurface::Cylinder { frame, radius: 3.0 }, SupportSurface::Cone { frame, radius: 3.0, slope: 0.4 }]
        {
            let s = spline(&c);
            for s in [s.clone(), s.transposed()] {
                let r = Rulings::of(&s, whole(&s), 1e-9).expect("rulings");
                let (a, b) = r.range();
                let l = r.line(0.3 * a + 0.7 * b).expect("a line");
                assert!(l.normal.dot(&l.direction).abs() < 1e-12 && l.direction.z.abs() > 0.9);
                assert!(r.breaks()[1..r.breaks().len() - 1].iter().all(|&s| !r.bends_anew(s)));
            }
        }
        let s = SupportSurface::Sphere { frame, radius: 3.0 }.to_spline((0.2, 2.0), (-1.0, 1.0)).expect("a spline").0;
        assert!(Rulings::of(&s, whole(&s), 1e-3).is_none());
    }

    #[test]
    fn fans_have_rulings_though_only_rounding_gives_their_apex_a_normal() {
        use crate::spline::knots::Knots;
        let (k, l) =
            (Knots::clamped(3, &[0.0, 0.37, 1.0]).expect("knots"), Knots::clamped(1, &[0.0, 1.0]).expect("knots"));
        let apex = Vec3::new(1234.5, -77.7, 0.333_333);
        // Nearly one point, as it comes from files.
        let rim = |i: u32| Vec3::new(f64::from(i) * 90.1, f64::from(i * i) * 31.3, 700.0 - 55.5 * f64::from(i));
        let points: Vec<Vec3> =
            (0..5).flat_map(|i| [apex + Vec3::new(1.0, -1.0, 1.0) * 1e-12 * f64::from(i * i % 3), rim(i)]).collect();
        let s = Surface::new(k, l, &points, None).expect("surface");
        assert!(Rulings::of(&s, whole(&s), 1e-6).is_some());
    }

    #[test]
    fn twisted_ruled_surfaces_are_no_developables() {
        let k = crate::spline::knots::Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let p = [Vec3::zeros(), Vec3::y(), Vec3::x(), Vec3::new(1.0, 1.0, 0.01)];
        let s = Surface::new(k.clone(), k, &p, None).expect("surface");
        assert!(Rulings::of(&s, whole(&s), 1e-4).is_none());
        assert!(Rulings::of(&s, whole(&s), 0.1).is_some());
    }
}
