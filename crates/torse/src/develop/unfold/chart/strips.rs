//! General cylinders and cones in strips that are parts of circular ones.
//!
//! *Method*: the circular cylinder or cone through three rulings stands for the face between the outer two; where it keeps
//! too far from the rulings between, the strip is halved. Neighbours share a ruling, on which both lie, so that they can be
//! laid side by side in the plane as the face lies. Every strip has a map in closed form, which a judge can follow.

use super::Ruled;
use crate::brep::carrier::Carrier;
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
const LOOKED_AT: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// The strips of a face in the plane of its own map, in order of the rulings; none for other carriers, for cones that are
/// laid flat below their face, and where a sheet is thicker than the radius. They keep to their rulings within a share of
/// `tolerance` (mm).
pub(super) fn strips(ruled: &Ruled, carrier: &Carrier, tolerance: f64) -> Vec<MapStrip> {
    let apex = match carrier {
        Carrier::GeneralCylinder { .. } => None,
        Carrier::GeneralCone { apex } if ruled.depth == 0.0 => Some(*apex),
        _ => return Vec::new(),
    };
    let extent = ruled.surface.bbox().diagonal();
    let near = (OF_TOLERANCE * tolerance / extent).clamp(NEAREST, NEAR);
    let mut cutter = Cutter { ruled, apex, extent, near, out: Vec::new(), flat: 0.0 };
    cutter.all().map_or_else(Vec::new, |()| cutter.out)
}

/// Strips so far.
struct Cutter<'a> {
    ruled: &'a Ruled,
    apex: Option<Vec3>,
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
            self.flat += self.ruled.depth * self.ruled.turn_at(w[0]);
            self.divide([w[0], w[1]], DEEPEST)
        })
    }

    /// The first ruling in the plane.
    fn begin(&mut self) -> Option<()> {
        if let Some(apex) = self.apex {
            let first = self.ruled.line(self.ruled.nodes[0].0)?;
            self.flat = if (first.p - apex).dot(&first.w) > 0.0 { 0.0 } else { PI };
        }
        Some(())
    }

    /// Strips between two rulings.
    fn divide(&mut self, [a, b]: [f64; 2], depth: usize) -> Option<()> {
        let (map, angles) = match self.apex {
            None => self.cylinder([a, b])?,
            Some(apex) => self.cone(&apex, [a, b])?,
        };
        let off =
            LOOKED_AT.iter().map(|t| self.distance(&map, a + (b - a) * t)).try_fold(0.0_f64, |m, d| Some(m.max(d?)))?;
        if off > self.near * self.extent && depth > 0 {
            let m = 0.5 * (a + b);
            self.divide([a, m], depth - 1)?;
            return self.divide([m, b], depth - 1);
        }
        let (turn, shift) = match map {
            ClosedMap::Cylinder { reach, .. } => {
                let start = self.flat - angles[0] * reach;
                self.flat += (angles[1] - angles[0]) * reach;
                // The way along rulings comes first in the plane of the face.
                ([0.0, -1.0], Vec2::new(0.0, -start))
            }
            ClosedMap::Cone { turn, frame, .. } => {
                let (sin, cos) = (self.flat - angles[0] * turn).sin_cos();
                self.flat += (angles[1] - angles[0]) * turn;
                let first = self.ruled.line(self.ruled.nodes[0].0)?;
                ([cos, sin], Vec2::new((frame.origin - first.p).dot(&first.w), 0.0))
            }
            ClosedMap::Plane(_) => return None,
        };
        self.out.push(MapStrip { map, turn, shift, span: [a, b], swapped: self.ruled.swapped, angles });
        Some(())
    }

    /// The circular cylinder through three rulings, and the angles of the outer two.
    fn cylinder(&self, [a, b]: [f64; 2]) -> Option<(ClosedMap, [f64; 2])> {
        let first = self.ruled.line(self.ruled.nodes[0].0)?;
        let (z, origin) = (first.w, first.p);
        let across = |s: f64| -> Option<Vec3> {
            let v = self.ruled.ruling_ends(s)?[0] - origin;
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
        let reach = out * radius - self.ruled.depth * turning;
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
        let least = LEAST_BULGE * self.near;
        let flatter = |q: Vec3| (q + n * least).try_normalize(0.0);
        // What is plane has its apex in the plane of the three.
        let bulge = p.cross(&r).try_normalize(0.0)?.dot(&q).abs();
        let z = axis(if bulge < least { flatter(q)? } else { q })?;
        let x = (q - z * z.dot(&q)).try_normalize(0.0)?;
        let frame = Frame { origin: *apex, x, y: z.cross(&x), z };
        let half_angle = (p - z * z.dot(&p)).norm().atan2(z.dot(&p));
        let out = n.dot(&(x * half_angle.cos() - z * half_angle.sin())).signum();
        let angle = |v: Vec3| frame.y.dot(&v).atan2(frame.x.dot(&v));
        let map = ClosedMap::Cone { frame, half_angle, behind: 0.0, turn: -out * half_angle.sin() };
        Some((map, [angle(p), angle(r)]))
    }

    /// Distance of a ruling from the carrier of a map, at its ends.
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
