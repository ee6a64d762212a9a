//! A face against the plane, cylinder or cone that it is laid flat as.
//!
//! *Theorem*. Every point of the face's surface within those of its Bézier patches that a box around its trim meets is within the bound
//! of the map surface. *Proof.* The
//! map surface is the zero set of a function of degree 1 or 2 in homogeneous coordinates; put into it, a patch becomes a
//! polynomial whose Bernstein coefficients enclose it, and so does the weight. Divided by the gradient of the function,
//! which is bounded from below, that is a distance. Patches come from knot insertion, whose
//! rounding is added. Where a side of a patch lies in the apex of a cone, the gradient has no bound from below; but patch,
//! function and gradient then have the way from that side as a factor, once, twice and once, and what is left when it is
//! divided out bounds the distance. Of edges the same is true, as patches of degree 0 in one direction.

use super::claim::UpperBound;
use super::strokes::root_between;
use crate::geom::{BBox, Frame, Vec3};
use crate::num::binomial::binomial;
use crate::num::interval::Interval;
use crate::patchwork::image::{ClosedMap, MapStrip};
use crate::spline::bezier::{Bezier, BezierPatch};
use crate::spline::curve::{bezier_pieces, Curve};
use crate::spline::surface::Surface;

/// Share of the size that rounding in knot insertion, in the change of coordinates and in the frame's own axes may move
/// control points: a thousand times what some twenty convex combinations of doubles do.
const ROUNDING: f64 = 1e-12;

/// Bound of the distance (mm) of the points of a surface within parameters `[u0, u1, v0, v1]` from the surface of the map by which it
/// is laid flat; unknown where a weight is not positive, and where no patch lies there. With whether that holds for the whole surface:
/// else places of a face beyond the box, to which its trim was read by chords, may be farther by as much as they are beyond.
pub(crate) fn distance_from_map_surface(surface: &Surface, within: &[f64; 4], map: &ClosedMap) -> (UpperBound, bool) {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let us = finer(&surface.knots_u.breaks(), 1, map, &|u| surface.point(u, 0.5 * (v0 + v1)));
    let vs = finer(&surface.knots_v.breaks(), 1, map, &|v| surface.point(0.5 * (u0 + u1), v));
    let mut patches = surface.bezier_patches_on(&us, &vs);
    let count = patches.len();
    // What only touches the box has a neighbour there.
    patches.retain(|p| p.u.1 > within[0] && p.u.0 < within[1] && p.v.1 > within[2] && p.v.0 < within[3]);
    let bound = match patches.is_empty() {
        true => UpperBound::UNKNOWN,
        false => distance_of_patches(&patches, surface.bbox().diagonal(), map),
    };
    (bound, patches.len() == count)
}

/// Share of a strip's breadth by which places on its rulings may lie beside them: what rounding makes of them.
pub(super) const BESIDE: f64 = 1e-6;

/// The wedge about the axis of a frame between two angles (rad) that differ by less than half a turn.
pub(super) struct Wedge<'a> {
    frame: &'a Frame,
    /// Sine and cosine of both.
    ends: [(f64, f64); 2],
}

impl<'a> Wedge<'a> {
    /// `None` for half a turn and more, which no two half planes have in common.
    pub fn new(frame: &'a Frame, [lo, hi]: [f64; 2]) -> Option<Self> {
        (hi - lo < std::f64::consts::PI).then(|| Self { frame, ends: [lo.sin_cos(), hi.sin_cos()] })
    }

    /// Whether a point (homogeneous) of positive weight lies in it, but for rounding.
    pub fn contains(&self, p: &[f64; 4]) -> bool {
        let at = Vec3::new(p[0], p[1], p[2]);
        let q = self.frame.vector_to_local(&(at - self.frame.origin * p[3]));
        let rounding = ROUNDING * (at.norm() + self.frame.origin.norm() * p[3]);
        let [from, to] = self.ends;
        p[3] > 0.0 && from.1 * q.y - from.0 * q.x >= -rounding && to.0 * q.x - to.1 * q.y >= -rounding
    }
}

/// Whether the outer curves of the patches of a strip are its two rulings.
fn ends_are_rulings(patches: &[BezierPatch], strip: &MapStrip) -> bool {
    let slack = BESIDE * (strip.angles[1] - strip.angles[0]).abs();
    (0..2).all(|end: usize| {
        let angle = strip.angles[end];
        let Some(wedge) = Wedge::new(strip.map.frame(), [angle - slack, angle + slack]) else { return false };
        let at = strip.span[end];
        let outer = |p: &BezierPatch| {
            let [(own, n), (_, m)] = match strip.swapped {
                true => [(p.v, p.degree.1), (p.u, p.degree.0)],
                false => [(p.u, p.degree.0), (p.v, p.degree.1)],
            };
            let k = if end == 0 { 0 } else { n };
            let is_outer = if end == 0 { own.0 == at } else { own.1 == at };
            let index = |l: usize| if strip.swapped { l * (n + 1) + k } else { k * (m + 1) + l };
            !is_outer || (0..=m).all(|l| wedge.contains(&p.control[index(l)]))
        };
        patches.iter().all(outer)
    })
}

/// Pieces along rulings between knots.
const ALONG: usize = 4;

/// The far end of a piece is at most so many times as far from an apex as the near one: a distance is told by the least slope of the cone
/// on it.
const FARTHER: f64 = 2.5;
/// Halvings towards an apex at most.
const PARTINGS: u32 = 30;

/// Places and so many parts between any two, along a curve; on a cone finer and finer towards its apex: fans may begin a hair before it.
fn finer(all: &[f64], parts: usize, map: &ClosedMap, curve: &dyn Fn(f64) -> Vec3) -> Vec<f64> {
    let mut out = vec![all[0]];
    for w in all.windows(2) {
        // To the bit, the knots.
        let at = |k: usize| if k == parts { w[1] } else { w[0] + (w[1] - w[0]) * k as f64 / parts as f64 };
        for k in 0..parts {
            match map {
                ClosedMap::Cone { frame, .. } => {
                    let away = |t: f64| (curve(t) - frame.origin).norm();
                    parted_towards_apex([at(k), at(k + 1)], &away, PARTINGS, &mut out);
                }
                ClosedMap::Plane(_) | ClosedMap::Cylinder { .. } => out.push(at(k + 1)),
            }
        }
    }
    out
}

/// The ends of the parts of a stretch, all but the first, by their distance from an apex.
fn parted_towards_apex([a, b]: [f64; 2], away: &dyn Fn(f64) -> f64, left: u32, out: &mut Vec<f64>) {
    let (near, far) = (away(a).min(away(b)), away(a).max(away(b)));
    if left > 0 && far > FARTHER * near && near > POINT * far {
        let middle = 0.5 * (a + b);
        parted_towards_apex([a, middle], away, left - 1, out);
        parted_towards_apex([middle, b], away, left - 1, out);
    } else {
        out.push(b);
    }
}

/// The same for the part of a surface between two rulings; unknown if these are not at the angles that the strip says.
pub(crate) fn distance_of_strip(surface: &Surface, strip: &MapStrip) -> UpperBound {
    let [a, b] = strip.span;
    let (us, vs) = (surface.knots_u.breaks(), surface.knots_v.breaks());
    let within = |all: &[f64]| {
        let inside = all.iter().copied().filter(|t| *t > a && *t < b);
        std::iter::once(a).chain(inside).chain(std::iter::once(b)).collect::<Vec<f64>>()
    };
    let domain = if strip.swapped { &vs } else { &us };
    let known = a < b && domain.first().is_some_and(|t| *t <= a) && domain.last().is_some_and(|t| *t >= b);
    if !known {
        return UpperBound::UNKNOWN;
    }
    // Along the rulings of a cone, which is less and less curved, in pieces.
    let ruling = 0.5 * (a + b);
    let pieces = |all: &[f64]| match strip.swapped {
        true => finer(all, ALONG, &strip.map, &|t| surface.point(t, ruling)),
        false => finer(all, ALONG, &strip.map, &|t| surface.point(ruling, t)),
    };
    let patches = match strip.swapped {
        true => surface.bezier_patches_on(&pieces(&us), &within(&vs)),
        false => surface.bezier_patches_on(&within(&us), &pieces(&vs)),
    };
    match ends_are_rulings(&patches, strip) {
        true => distance_of_patches(&patches, surface.bbox().diagonal(), &strip.map),
        false => UpperBound::UNKNOWN,
    }
}

/// Sides of a patch within this share of the surface's size of an apex are moved into it, and parts of edges shorter than this
/// share of the edge are points: far above rounding, and the way counts.
const POINT: f64 = 1e-9;

/// Halvings of a piece of an edge until its bound is fine enough, at most.
const HALVINGS: u32 = 8;

/// Bound of the distance (mm) of a part of an edge (homogeneous) from the surface of a map; one that exceeds what is seen on the
/// edge by no more than `aim` (mm) is fine enough.
pub(crate) fn distance_of_edge(edge: &Curve<4>, part: [f64; 2], map: &ClosedMap, aim: f64) -> UpperBound {
    let (a, b) = (part[0].min(part[1]), part[0].max(part[1]));
    let (lo, hi) = edge.domain();
    // Parts end beside the edge's ends by rounding, or are points.
    let pieces: Vec<Bezier<4>> = match edge.extended(a, b) {
        Ok(part) => bezier_pieces(&part).into_iter().map(|p| Bezier::new(p.2)).collect(),
        Err(_) if b - a <= POINT * (hi - lo) => vec![Bezier::new(vec![edge.point(a), edge.point(b)])],
        Err(_) => return UpperBound::UNKNOWN,
    };
    let place = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
    let points: Vec<Vec3> = pieces.iter().flat_map(|p| p.control()).map(place).collect();
    let size = BBox::of(&points).diagonal();
    // What is seen in the middle of pieces is no bound, but none lies below it.
    let mut seen = 0.0;
    let mut of = |p: &Bezier<4>| of_edge(p, size, map, (aim, &mut seen), HALVINGS);
    let worst = pieces.iter().map(&mut of).try_fold(0.0_f64, |m, d| d.map(|d| m.max(d)));
    shown(worst, size)
}

/// Distance of a piece of an edge, halved while that is worth it.
fn of_edge(piece: &Bezier<4>, size: f64, map: &ClosedMap, (aim, seen): (f64, &mut f64), halvings: u32) -> Option<f64> {
    let control = piece.control();
    let net = Net::of(control, (control.len() - 1, 0), map.frame());
    let whole = net.and_then(|net| net.distance(size, map));
    if whole.is_none_or(|d| d > *seen + aim) {
        *seen = seen.max(away(map, &piece.point(0.5)));
    }
    if whole.is_some_and(|d| d <= *seen + aim) || halvings == 0 {
        return whole;
    }
    let (first, second) = piece.split(0.5);
    let halves = [first, second].map(|half| of_edge(&half, size, map, (aim, &mut *seen), halvings - 1));
    match (halves, whole) {
        ([Some(p), Some(q)], Some(d)) => Some(p.max(q).min(d)),
        ([Some(p), Some(q)], None) => Some(p.max(q)),
        (_, whole) => whole,
    }
}

/// Distance of a point (homogeneous) from the surface of a map, in plain arithmetic.
fn away(map: &ClosedMap, p: &[f64; 4]) -> f64 {
    let frame = map.frame();
    let q = frame.vector_to_local(&(Vec3::new(p[0], p[1], p[2]) / p[3] - frame.origin));
    match map {
        ClosedMap::Plane(_) => q.z.abs(),
        ClosedMap::Cylinder { radius, .. } => (q.xy().norm() - radius).abs(),
        ClosedMap::Cone { half_angle, .. } => (q.xy().norm() * half_angle.cos() - q.z * half_angle.sin()).abs(),
    }
}

/// Distance of patches of a surface of this size from the surface of a map.
fn distance_of_patches(patches: &[BezierPatch], size: f64, map: &ClosedMap) -> UpperBound {
    let of = |p: &BezierPatch| Net::of(&p.control, p.degree, map.frame())?.distance(size, map);
    shown(patches.iter().map(of).try_fold(0.0_f64, |m, d| d.map(|d| m.max(d))), size)
}

/// A distance of something of this size as a bound.
fn shown(distance: Option<f64>, size: f64) -> UpperBound {
    match distance {
        // Some slack for the divisions above, which are not rounded outwards.
        Some(d) if d.is_finite() => UpperBound::shown(d * (1.0 + ROUNDING) + ROUNDING * size),
        _ => UpperBound::UNKNOWN,
    }
}

/// A patch in a frame, homogeneous.
struct Net {
    points: Vec<[Interval; 4]>,
    degree: (usize, usize),
    /// Least weight.
    weight: f64,
}

impl Net {
    fn of(control: &[[f64; 4]], degree: (usize, usize), frame: &Frame) -> Option<Self> {
        let weights = || control.iter().map(|p| p[3]);
        let weight = weights().fold(f64::INFINITY, f64::min);
        let heaviest = weights().fold(0.0, f64::max);
        let axis = |a: &Vec3, p: &[f64; 4]| {
            let o = &frame.origin;
            let part = |d: usize| {
                Interval::point(a[d]) * (Interval::point(p[d]) - Interval::point(o[d]) * Interval::point(p[3]))
            };
            part(0) + part(1) + part(2)
        };
        let local = |p: &[f64; 4]| [axis(&frame.x, p), axis(&frame.y, p), axis(&frame.z, p), Interval::point(p[3])];
        (weight > 0.0 && heaviest.is_finite()).then(|| Self {
            points: control.iter().map(local).collect(),
            degree,
            weight,
        })
    }

    /// Distance from the surface of a map in whose frame the net is, of a surface or an edge of this size.
    fn distance(&self, size: f64, map: &ClosedMap) -> Option<f64> {
        match map {
            ClosedMap::Plane(_) => self.hull(|q| q[2]).map(|z| z.mag() / self.weight),
            ClosedMap::Cylinder { radius, .. } => {
                let r = Interval::point(*radius);
                let off = self.quadratic(|a, b| a[0] * b[0] + a[1] * b[1] - r.sqr() * a[3] * b[3]).mag();
                // |ρ² − R²| = |ρ − R| (ρ + R).
                Some(off / (self.weight * root_between(r.abs() * self.weight, off).lo))
            }
            ClosedMap::Cone { half_angle, .. } => {
                let whole = self.distance_from_cone(*half_angle);
                let from_side = |k: usize| {
                    let (rest, moved) = self.without_apex(k, POINT * size)?;
                    Some(rest.distance_from_cone(*half_angle)? + moved)
                };
                let sides = match self.degree {
                    (0, _) => 0..0,
                    (_, 0) => 0..2,
                    _ => 0..4,
                };
                // The apex is a point of the cone.
                let away = |h: &[Interval; 4]| (h[0].sqr() + h[1].sqr() + h[2].sqr()).sqrt();
                let apex = self.hull(away).map(|d| d.hi / self.weight);
                sides.filter_map(from_side).chain(whole).chain(apex).min_by(f64::total_cmp)
            }
        }
    }

    /// Distance from the cone of this half angle about z; `None` beyond the nappe of positive z.
    fn distance_from_cone(&self, half_angle: f64) -> Option<f64> {
        let (s, c) = half_angle.sin_cos();
        let (s, c) = (Interval::point(s), Interval::point(c));
        let off = self.quadratic(|a, b| (a[0] * b[0] + a[1] * b[1]) * c.sqr() - a[2] * b[2] * s.sqr()).mag();
        // |ρ cos − z sin| (ρ cos + z sin).
        let far = self.hull(|q| q[2])?.lo;
        (far > 0.0).then(|| off / (self.weight * root_between(s * far, off).lo))
    }

    /// The patch with one of its four sides moved into the origin, over the way from that side, without weights of its own;
    /// and by how much points were moved at most. `None` if that is more than `most`.
    fn without_apex(&self, side: usize, most: f64) -> Option<(Self, f64)> {
        let (p, q) = self.degree;
        let (n, m) = if side < 2 { (p, q) } else { (q, p) };
        // Points in rows along the side, which is the first.
        let at = |i: usize, j: usize| {
            let i = if side.is_multiple_of(2) { i } else { n - i };
            &self.points[if side < 2 { i * (q + 1) + j } else { j * (q + 1) + i }]
        };
        let away = |h: &[Interval; 4]| (h[0].sqr() + h[1].sqr() + h[2].sqr()).sqrt().hi;
        let moved = (0..=m).map(|j| away(at(0, j))).fold(0.0, f64::max) / self.weight;
        let reduced = |i: usize, j: usize| at(i, j).map(|x| x * Interval::point(n as f64) / Interval::point(i as f64));
        (moved <= most).then(|| {
            let points = (1..=n).flat_map(|i| (0..=m).map(move |j| reduced(i, j))).collect();
            (Self { points, degree: (n - 1, m), weight: self.weight }, moved)
        })
    }

    /// Hull of a linear function over the net.
    fn hull(&self, f: impl Fn(&[Interval; 4]) -> Interval) -> Option<Interval> {
        self.points.iter().map(f).reduce(Interval::hull)
    }

    /// Hull of the Bernstein coefficients of a symmetric bilinear form with the patch in both places.
    fn quadratic(&self, form: impl Fn(&[Interval; 4], &[Interval; 4]) -> Interval) -> Interval {
        let (p, q) = self.degree;
        let at = |i: usize, j: usize| &self.points[i * (q + 1) + j];
        let share = |n: usize, i: usize, k: usize| {
            Interval::point(binomial(n, i) * binomial(n, k - i)) / Interval::point(binomial(2 * n, k))
        };
        let mut hull: Option<Interval> = None;
        for k in 0..=2 * p {
            for l in 0..=2 * q {
                let mut sum = Interval::point(0.0);
                for i in k.saturating_sub(p)..=k.min(p) {
                    for j in l.saturating_sub(q)..=l.min(q) {
                        sum += share(p, i, k) * share(q, j, l) * form(at(i, j), at(k - i, l - j));
                    }
                }
                hull = Some(hull.map_or(sum, |h| h.hull(sum)));
            }
        }
        hull.unwrap_or(Interval::EVERYTHING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::support_surface::SupportSurface;

    /// More than any domain here.
    const ALL: [f64; 4] = [-1e3, 1e3, -1e3, 1e3];

    fn part(s: &SupportSurface) -> Surface {
        s.to_spline((0.2, 2.4), (10.0, 60.0)).expect("a spline").0
    }

    #[test]
    fn exact_cylinders_and_cones_keep_to_themselves_and_others_are_seen() {
        let frame = Frame::world();
        let pipe = part(&SupportSurface::Cylinder { frame, radius: 25.0 });
        let bound = |radius: f64| {
            distance_from_map_surface(&pipe, &ALL, &ClosedMap::Cylinder { frame, radius, reach: radius }).0.value()
        };
        assert!(bound(25.0) < 1e-9, "{}", bound(25.0));
        // Wrong by a hundredth of a millimetre: never less than the truth, and not much more.
        assert!((0.01..0.03).contains(&bound(25.01)), "{}", bound(25.01));
        let moved = Frame { origin: Vec3::new(0.02, 0.0, 0.0), ..frame };
        let off =
            distance_from_map_surface(&pipe, &ALL, &ClosedMap::Cylinder { frame: moved, radius: 25.0, reach: 25.0 });
        assert!((0.0199..0.1).contains(&off.0.value()), "{off:?}");
    }

    #[test]
    fn edges_beside_their_cylinder_cone_or_plane_are_seen() {
        let frame = Frame::world();
        let pipe = ClosedMap::Cylinder { frame, radius: 25.0, reach: 25.0 };
        let cone = ClosedMap::Cone { frame, half_angle: 0.5, behind: 0.0, turn: 0.5_f64.sin() };
        let of = |points: &[[f64; 3]], map: &ClosedMap| {
            let control = points.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
            let knots = [vec![0.0; points.len()], vec![1.0; points.len()]].concat();
            let edge = Curve::new(points.len() - 1, knots, control).expect("an edge");
            distance_of_edge(&edge, [1.0, 0.0], map, 1e-6).value()
        };
        let ruling = |x: f64| [[x, 0.0, 0.0], [x, 0.0, 90.0]];
        assert!(of(&ruling(25.0), &pipe) < 1e-9);
        assert!((0.1..0.101).contains(&of(&ruling(25.1), &pipe)));
        // A bulge in the middle of an edge whose ends lie on the cylinder: three quarters of the 3 mm of its control points.
        let bulge = of(&[[25.0, 0.0, 0.0], [28.0, 0.0, 30.0], [28.0, 0.0, 60.0], [25.0, 0.0, 90.0]], &pipe);
        assert!((2.25..2.5).contains(&bulge), "{bulge}");
        assert!((2.25..2.2501)
            .contains(&of(&[[0.0, 0.0, 0.0], [0.0, 0.0, 4.5], [9.0, 9.0, 0.0]], &ClosedMap::Plane(frame))));
        let (s, c) = 0.5_f64.sin_cos();
        let from_apex = |by: f64| [[0.0; 3], [70.0 * s + by * c, 0.0, 70.0 * c - by * s]];
        assert!(of(&from_apex(0.0), &cone) < 1e-9);
        assert!((0.2..0.21).contains(&of(&from_apex(0.2), &cone)), "{}", of(&from_apex(0.2), &cone));
    }

    #[test]
    fn planes_are_planes_to_rounding_and_bumps_are_not() {
        let frame = Frame::world();
        let knots = || crate::spline::knots::Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let flat = |z: f64| {
            let points = [[0.0, 0.0, 0.0], [0.0, 80.0, z], [90.0, 0.0, 0.0], [90.0, 80.0, 0.0]].map(Vec3::from);
            Surface::new(knots(), knots(), &points, None).expect("a surface")
        };
        let bound = |z: f64| distance_from_map_surface(&flat(z), &ALL, &ClosedMap::Plane(frame)).0.value();
        assert!(bound(0.0) < 1e-9 && bound(0.5) >= 0.5 && bound(0.5) < 0.51);
    }

    /// A profile of three chords, of which the trim uses the middle one.
    #[test]
    fn what_a_surface_is_beyond_its_trim_does_not_matter() {
        let knots = |breaks: &[f64]| crate::spline::knots::Knots::clamped(1, breaks).expect("knots");
        let profile = [[0.0, 4.0], [1.0, 0.0], [16.0, 0.0], [17.0, -1.0]];
        let points: Vec<Vec3> = profile.iter().flat_map(|[x, z]| [0.0, 50.0].map(|y| Vec3::new(*x, y, *z))).collect();
        let surface =
            Surface::new(knots(&[0.0, 1.0, 16.0, 17.0]), knots(&[0.0, 1.0]), &points, None).expect("a surface");
        let bound = |u0: f64, u1: f64| {
            distance_from_map_surface(&surface, &[u0, u1, 0.2, 0.9], &ClosedMap::Plane(Frame::world())).0.value()
        };
        assert!(bound(1.0, 16.0) < 1e-9 && bound(2.0, 9.0) < 1e-9);
        assert!(bound(0.9, 16.0) >= 0.4 && bound(2.0, 16.5) >= 0.5);
        let whole =
            |u: f64| distance_from_map_surface(&surface, &[0.0, u, 0.0, 1.0], &ClosedMap::Plane(Frame::world())).1;
        assert!(whole(17.0) && !whole(16.0));
        assert!(bound(20.0, 30.0).is_infinite() && bound(f64::NAN, 3.0).is_infinite());
    }

    /// A fan that begins a hair before its tip against a cone of another half angle: what is shown of it is what that makes of its far side.
    #[test]
    fn fans_that_begin_a_hair_before_their_apex_are_not_far_from_their_cone() {
        let (frame, half_angle, long) = (Frame::world(), 0.5_f64, 600.0);
        let cone = SupportSurface::Cone { frame, radius: 0.0, slope: half_angle.tan() };
        let bound = |hair: f64, off: f64| {
            let fan = cone.to_spline((0.2, 1.0), (hair, long)).expect("a spline").0;
            let map = ClosedMap::Cone { frame, half_angle: half_angle + off, behind: 0.0, turn: half_angle.sin() };
            let (from, to) = fan.domain().0;
            let (turn, shift) = ([1.0, 0.0], crate::geom::Vec2::zeros());
            let whole = distance_from_map_surface(&fan, &ALL, &map).0.value();
            let strip = MapStrip { map, turn, shift, span: [from, to], swapped: false, angles: [0.2, 1.0] };
            [whole, distance_of_strip(&fan, &strip).value()]
        };
        for hair in [0.0, 1e-9, 1e-6, 1e-4, 1e-2, 1.0] {
            let (exact, found, slant) = (bound(hair, 0.0), bound(hair, 1e-4), long / half_angle.cos());
            assert!(exact.iter().all(|d| *d < 1e-6), "{hair:e}: {exact:?}");
            assert!(found.iter().all(|d| (0.9e-4 * slant..3e-4 * slant).contains(d)), "{hair:e}: {found:?}");
        }
    }
}
