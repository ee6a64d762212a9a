//! A face as the family of its rulings, in the order in which they lie in the plane: where each is in space and in the plane, and how
//! the face is bent there. Places of space do not tell copies on closed faces apart; rulings do.

use super::{Chart, Kind, PLACES};
use crate::geom::{Frame, Vec2, Vec3};

/// How a face is bent along a ruling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RulingBend {
    /// Unit normal, outwards.
    pub normal: Vec3,
    /// Whether the face is hollow there, seen from outside.
    pub hollow: bool,
    /// Depth (mm) of the surface that is laid flat below the face.
    pub depth: f64,
    /// Radius of curvature (mm) of the face at both ends; infinite where it is flat.
    pub radii: [f64; 2],
}

/// By how much rulings are longer at either end than what a face is known to reach, as a share of that: between the points of its
/// border it may reach a little farther.
const LONGER: f64 = 0.01;

impl Chart {
    /// The plane of a plane face, whose coordinates are its map.
    pub(crate) fn plane(&self) -> Option<&Frame> {
        match &self.kind {
            Kind::Plane(frame) => Some(frame),
            Kind::Round { .. } | Kind::Ruled(_) => None,
        }
    }

    /// Parameters of the first and the last ruling and of the knots between, rising: shares of the angle of circular faces. None
    /// for planes.
    pub(crate) fn breaks(&self) -> Vec<f64> {
        match &self.kind {
            Kind::Plane(_) => Vec::new(),
            Kind::Round { .. } => vec![0.0, 1.0],
            Kind::Ruled(r) => r.breaks.clone(),
        }
    }

    /// Between which places (mm) along its rulings a circular face lies whose border runs through these points: heights of a
    /// cylinder, ways from the apex of a cone. Other faces have both ends of theirs.
    pub(crate) fn reach(&self, border: impl Iterator<Item = Vec3>) -> [f64; 2] {
        let Kind::Round { frame, half_angle, .. } = &self.kind else { return [0.0; 2] };
        let (sin, cos) = half_angle.sin_cos();
        let along = |x: Vec3| {
            let q = frame.to_local(&x);
            q.z * cos + q.x.hypot(q.y) * sin
        };
        let (lo, hi) = border.map(along).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let more = LONGER * (hi - lo);
        // Nothing lies beyond an apex.
        let least = if *half_angle == 0.0 { f64::NEG_INFINITY } else { 0.0 };
        [(lo - more).max(least), hi + more]
    }

    /// Both ends of a ruling in space and in the plane; `reach` as [`Self::reach`] tells it. `None` for planes, and where the
    /// surface has no places.
    pub(crate) fn ruling_image(&self, t: f64, reach: [f64; 2]) -> Option<([Vec3; 2], [Vec2; 2])> {
        match &self.kind {
            Kind::Plane(_) => None,
            Kind::Round { frame, angles, half_angle, radius, .. } => {
                let angle = angles.at(t);
                let ((s, c), (sin, cos)) = (angle.sin_cos(), half_angle.sin_cos());
                let place = |x: f64| {
                    let around = if *half_angle == 0.0 { *radius } else { x * sin };
                    frame.to_world(&Vec3::new(around * c, around * s, x * cos))
                };
                let map = self.closed()?;
                let space = reach.map(place);
                Some((space, space.map(|x| map.flat(&x, angle))))
            }
            Kind::Ruled(r) => {
                let space = r.ruling_ends(t)?;
                Some((space, space.map(|x| r.flat_on(t, &x))))
            }
        }
    }

    /// How the face is bent along a ruling; `None` as of [`Self::ruling_image`], and where it has no normal.
    pub(crate) fn bend_at(&self, t: f64, reach: [f64; 2]) -> Option<RulingBend> {
        match &self.kind {
            Kind::Plane(_) => None,
            Kind::Round { frame, angles, half_angle, radius, sign, neutral } => {
                let ((s, c), (sin, cos)) = (angles.at(t).sin_cos(), half_angle.sin_cos());
                let out = frame.vector_to_world(&Vec3::new(c * cos, s * cos, -sin));
                let (radii, depth) = match *half_angle == 0.0 {
                    true => ([*radius; 2], sign * (radius - neutral)),
                    false => (reach.map(|x| x * half_angle.tan()), -sign * neutral * half_angle.tan()),
                };
                Some(RulingBend { normal: out * *sign, hollow: *sign < 0.0, depth, radii })
            }
            Kind::Ruled(r) => {
                let (l, ends) = (r.line(t)?, r.ruling_ends(t)?);
                let e = l.n.cross(&l.w);
                let radius = |x: Vec3| ((l.dp.dot(&e) + l.dw.dot(&e) * (x - l.p).dot(&l.w)) / l.dn.norm()).abs();
                let radii = ends.map(radius).map(|r| if r.is_nan() { f64::INFINITY } else { r });
                Some(RulingBend { normal: l.n, hollow: l.curvature() < 0.0, depth: r.depth_of(&l), radii })
            }
        }
    }
}

impl super::Angles {
    /// The angle at a share of the way from the first to the last.
    fn at(&self, share: f64) -> f64 {
        self.table[0].1 + (self.table[PLACES].1 - self.table[0].1) * share
    }
}
