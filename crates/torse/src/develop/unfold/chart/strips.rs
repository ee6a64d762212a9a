//! General cylinders and cones and tangent surfaces in strips that are parts of circular cylinders and cones.
//!
//! *Method*: the circular cylinder or cone through three rulings stands for the face between the outer two; where it keeps
//! too far from the rulings between, the strip is halved. Neighbours share a ruling, on which both lie, so that they can be
//! laid side by side in the plane as the face lies. Every strip has a map in closed form, which a judge can follow.
//!
//! The rulings of a tangent surface do not meet, but two neighbours at a distance h pass each other by O(h³) only,
//! along the normal of the surface; cones in the place of tangent surfaces are those of \[LP98\]. The apex of the cone of a strip is half way between its outer rulings there;
//! where that is too far off to be reckoned with, rulings are as good as parallel. Such strips are laid as near as can be to where the
//! map of the whole face has their outer rulings. So are general cones below their face, whose offsets are tangent surfaces.

use super::ruled::{Ruled, RulingJet};
use crate::brep::recognised_surface::RecognisedSurface;
use crate::geom::{Frame, Vec2, Vec3};
use crate::patchwork::image::{ClosedMap, MapStrip};
use std::f64::consts::PI;

/// Share of the face's extent within which a strip keeps to its rulings, at most.
const NEAR: f64 = 2e-7;
/// The same at least: no file has more digits, and nearer strips would not be any better.
const NEAREST: f64 = 1e-10;
/// Share of the tolerance within which it does.
const OF_TOLERANCE: f64 = 0.1;
/// Share of that by which a strip is taken to bulge that bulges so little that it would have no axis.
const LEAST_BULGE: f64 = 0.5;
/// Halvings of a strip at most.
const DEEPEST: usize = 10;
/// Rulings looked at in a strip.
const LOOKED_AT: [f64; 6] = [0.0, 0.125, 0.375, 0.625, 0.875, 1.0];
/// Apexes of tangent surfaces farther away than this multiple of the face's extent count as infinitely far: rulings that meet there
/// turn from each other by less than rounding over the length of a strip.
const FAR: f64 = 1e6;

/// The strips of a face in the plane of its own map, in order of the rulings; none for other surfaces and where a sheet is thicker
/// than the radius. They keep to their rulings within a share of `tolerance` (mm).
pub(super) fn strips(ruled: &Ruled, recognised: &RecognisedSurface, tolerance: f64) -> Vec<MapStrip> {
    let meet = match recognised {
        RecognisedSurface::GeneralCylinder { .. } => Meet::Nowhere,
        RecognisedSurface::GeneralCone { apex } if ruled.fibre.is_face() => Meet::At(*apex),
        RecognisedSurface::GeneralCone { .. } | RecognisedSurface::TangentSurface => Meet::Anywhere,
        _ => return Vec::new(),
    };
    let extent = ruled.surface.bbox().diagonal();
    let near = (OF_TOLERANCE * tolerance / extent).clamp(NEAREST, NEAR);
    let mut cutter = Cutter { ruled, meet, extent, near, out: Vec::new(), flat: 0.0 };
    cutter.all().map_or_else(Vec::new, |()| cutter.out)
}

/// Where the rulings of a face meet.
enum Meet {
    /// They are parallel.
    Nowhere,
    /// In one point.
    At(Vec3),
    /// Each with its neighbours, elsewhere.
    Anywhere,
}

/// Strips so far.
struct Cutter<'a> {
    ruled: &'a Ruled,
    meet: Meet,
    extent: f64,
    /// Share of the extent within which strips keep to their rulings.
    near: f64,
    out: Vec<MapStrip>,
    /// Where the last ruling lies in the plane: of cylinders minus the way from the first (mm), of cones its angle (rad).
    flat: f64,
}

impl Cutter<'_> {
    /// All strips, from knot to knot.
    fn all(&mut self) -> Option<()> {
        self.begin()?;
        self.ruled.breaks.windows(2).try_for_each(|w| {
            self.flat += self.ruled.shortened_at(w[0]);
            self.divide([w[0], w[1]], DEEPEST)
        })
    }

    /// The first ruling in the plane.
    fn begin(&mut self) -> Option<()> {
        if let Meet::At(apex) = self.meet {
            let first = self.ruled.line(self.ruled.nodes[0].0)?;
            self.flat = if (first.p - apex).dot(&first.w) > 0.0 { 0.0 } else { PI };
        }
        Some(())
    }

    /// Strips between two rulings.
    fn divide(&mut self, [a, b]: [f64; 2], depth: usize) -> Option<()> {
        // None goes through three rulings of which two are one, as on a closed face of one span.
        let found = self.through([a, b]);
        let distance = |map: &ClosedMap, t: f64| self.distance(map, a + (b - a) * t);
        let farthest =
            |map: &ClosedMap| LOOKED_AT.iter().map(|t| distance(map, *t)).try_fold(0.0_f64, |m, d| Some(m.max(d?)));
        let off = found.and_then(|f| farthest(&f.0));
        let is_near = off.is_some_and(|d| d <= self.near * self.extent);
        if !is_near && depth > 0 {
            let m = 0.5 * (a + b);
            self.divide([a, m], depth - 1)?;
            return self.divide([m, b], depth - 1);
        }
        // Near a regression curve no cone is near, however narrow the strip.
        if !is_near && matches!(self.meet, Meet::Anywhere) {
            return None;
        }
        let (map, angles) = off.and(found)?;
        let (turn, shift) = match (&self.meet, map) {
            (Meet::Anywhere, _) => self.laid(&map, [a, b])?,
            (_, ClosedMap::Cylinder { reach, .. }) => {
                let start = self.flat - angles[0] * reach;
                self.flat += (angles[1] - angles[0]) * reach;
                // The way along rulings comes first in the plane of the face.
                ([0.0, -1.0], Vec2::new(0.0, -start))
            }
            (_, ClosedMap::Cone { turn, frame, .. }) => {
                let (sin, cos) = (self.flat - angles[0] * turn).sin_cos();
                self.flat += (angles[1] - angles[0]) * turn;
                let first = self.ruled.line(self.ruled.nodes[0].0)?;
                ([cos, sin], Vec2::new((frame.origin - first.p).dot(&first.w), 0.0))
            }
            (_, ClosedMap::Plane(_)) => return None,
        };
        self.out.push(MapStrip { map, turn, shift, span: [a, b], swapped: self.ruled.swapped, angles });
        Some(())
    }

    /// The circular cylinder or cone through three rulings from one to another, and the angles of the outer two.
    fn through(&self, [a, b]: [f64; 2]) -> Option<(ClosedMap, [f64; 2])> {
        match self.meet {
            Meet::Nowhere => self.cylinder([a, b], &self.ruled.line(self.ruled.nodes[0].0)?),
            Meet::At(apex) => self.cone(&apex, [a, b]),
            Meet::Anywhere => match self.apex([a, b])? {
                Some(apex) => self.cone(&apex, [a, b]),
                None => self.cylinder([a, b], &self.ruled.line(0.5 * (a + b))?),
            },
        }
    }

    /// Half way between two rulings where they pass each other; inner `None` where that is too far off.
    #[allow(clippy::option_option)]
    fn apex(&self, [a, b]: [f64; 2]) -> Option<Option<Vec3>> {
        let (p, q) = (self.ruled.line(a)?, self.ruled.line(b)?);
        let (between, cos) = (q.p - p.p, p.w.dot(&q.w));
        let sin = p.w.cross(&q.w).norm_squared();
        let along = |w: &Vec3, other: &Vec3| (between.dot(w) - cos * between.dot(other)) / sin;
        let ways = [along(&p.w, &q.w), -along(&q.w, &p.w)];
        let is_near = ways.iter().all(|t| t.abs() <= FAR * self.extent);
        Some(is_near.then(|| 0.5 * (p.p + p.w * ways[0] + q.p + q.w * ways[1])))
    }

    /// Turn and move of the plane after a map that bring the images of a strip's outer rulings to where the map of the face has
    /// them, as near as can be.
    fn laid(&self, map: &ClosedMap, span: [f64; 2]) -> Option<([f64; 2], Vec2)> {
        let (mut from, mut to) = (Vec::new(), Vec::new());
        for s in span {
            for x in self.ruled.ruling_ends(s)? {
                from.push(map.flat(&x, map.angle(&x)));
                to.push(self.ruled.flat_on(s, &x));
            }
        }
        let mean = |all: &[Vec2]| all.iter().sum::<Vec2>() / all.len() as f64;
        let (m, n) = (mean(&from), mean(&to));
        let (mut cos, mut sin) = (0.0, 0.0);
        for (p, q) in from.iter().zip(&to).map(|(p, q)| (p - m, q - n)) {
            cos += p.dot(&q);
            sin += p.perp(&q);
        }
        let [cos, sin] = [cos, sin].map(|x: f64| x / cos.hypot(sin));
        let turned = Vec2::new(cos * m.x - sin * m.y, sin * m.x + cos * m.y);
        Some(([cos, sin], n - turned))
    }

    /// The circular cylinder through three rulings, along one of the face, and the angles of the outer two.
    fn cylinder(&self, [a, b]: [f64; 2], one: &RulingJet) -> Option<(ClosedMap, [f64; 2])> {
        let (z, origin) = (one.w, one.p);
        let across = |s: f64| -> Option<Vec3> {
            let v = self.ruled.line(s)?.p - origin;
            Some(v - z * z.dot(&v))
        };
        let (p, q, r) = (across(a)?, across(0.5 * (a + b))?, across(b)?);
        let chord = (r - p).try_normalize(0.0)?;
        let up = z.cross(&chord);
        let flat = |v: Vec3| Vec2::new(v.dot(&chord), v.dot(&up));
        let (half, mid) = (0.5 * (r - p).norm(), 0.5 * (p + r));
        // The point of the arc above the middle of the chord, from the three points: the circle through (±half, 0).
        let m = flat(q - mid);
        let below = if m.y == 0.0 { f64::INFINITY } else { (half * half - m.norm_squared()) / (2.0 * m.y) };
        let least = LEAST_BULGE * self.near * self.extent;
        let farthest = 0.5 * half * half / least;
        let bulges = below.abs() < farthest;
        let below = if bulges { below } else { farthest.copysign(if m.y < 0.0 { -1.0 } else { 1.0 }) };
        // What is taken to bulge turns by more than it does, and the neutral fibre would be shorter or longer by that.
        let turning = if bulges { 1.0 } else { m.y.abs() / least };
        let centre = mid - up * below;
        let radius = half.hypot(below);
        let x = (q - centre).try_normalize(0.0)?;
        let frame = Frame { origin: origin + centre, x, y: z.cross(&x), z };
        let out = x.dot(&self.ruled.line(0.5 * (a + b))?.n).signum();
        let reach = out * radius - self.ruled.depth_between([a, b]) * turning;
        (out * reach > 0.0).then_some(())?;
        let angle = |v: Vec3| frame.y.dot(&(v - centre)).atan2(frame.x.dot(&(v - centre)));
        Some((ClosedMap::Cylinder { frame, radius, reach }, [angle(p), angle(r)]))
    }

    /// The circular cone through three rulings, and the angles of the outer two.
    fn cone(&self, apex: &Vec3, [a, b]: [f64; 2]) -> Option<(ClosedMap, [f64; 2])> {
        let way = |s: f64| (self.ruled.line(s)?.p - apex).try_normalize(0.0);
        let n = self.ruled.line(0.5 * (a + b))?.n;
        let (p, q, r) = (way(a)?, way(0.5 * (a + b))?, way(b)?);
        let axis = |q: Vec3| {
            let z = (q - p).cross(&(r - p)).try_normalize(0.0)?;
            Some(if z.dot(&p) < 0.0 { -z } else { z })
        };
        let away = (self.ruled.line(0.5 * (a + b))?.p - apex).norm().max(self.extent);
        let least = LEAST_BULGE * self.near * self.extent / away;
        let flatter = |q: Vec3| (q + n * least).try_normalize(0.0);
        // What is plane has its apex in the plane of the three.
        let bulge = p.cross(&r).try_normalize(0.0)?.dot(&q).abs();
        let z = axis(if bulge < least { flatter(q)? } else { q })?;
        let x = (q - z * z.dot(&q)).try_normalize(0.0)?;
        let frame = Frame { origin: *apex, x, y: z.cross(&x), z };
        let half_angle = (p - z * z.dot(&p)).norm().atan2(z.dot(&p));
        let out = n.dot(&(x * half_angle.cos() - z * half_angle.sin())).signum();
        let angle = |v: Vec3| frame.y.dot(&v).atan2(frame.x.dot(&v));
        let depth = self.ruled.depth_between([a, b]);
        let behind = if depth == 0.0 { 0.0 } else { -out * depth / half_angle.tan() };
        let map = ClosedMap::Cone { frame, half_angle, behind, turn: -out * half_angle.sin() };
        Some((map, [angle(p), angle(r)]))
    }

    /// Distance of a ruling from the surface of a map, at its ends.
    fn distance(&self, map: &ClosedMap, s: f64) -> Option<f64> {
        let off = |x: Vec3| {
            let q = map.frame().to_local(&x);
            let across = q.x.hypot(q.y);
            match map {
                ClosedMap::Plane(_) => q.z,
                ClosedMap::Cylinder { radius, .. } => across - radius,
                ClosedMap::Cone { half_angle, .. } => across * half_angle.cos() - q.z * half_angle.sin(),
            }
        };
        let [a, b] = self.ruled.ruling_ends(s)?.map(off);
        Some(a.abs().max(b.abs()))
    }
}
