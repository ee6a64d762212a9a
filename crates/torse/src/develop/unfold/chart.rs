//! The isometric map of one face's neutral surface to the plane, seen from outside.
//!
//! *Method*: planes, circular cylinders and circular cones in closed form. Every other developable is a family of rulings
//! `p(s) + r w(s)` with one normal `n(s)` along each; with the frame `w, e = n × w` the flat ruling turns by
//! `Φ' = w'·e` and its base point moves by `(q'·w, q'·e)` in that frame, where `q = p − δ n` lies in the neutral surface
//! at depth δ below the face. Both are integrated by Runge–Kutta steps of fourth order, knots of the surface among
//! their ends. Where the normal jumps at a knot, the sheet bends about an edge by that angle, and the neutral surface is
//! shorter or longer by δ times it. In a sheet δ follows from K at the inside radius of each ruling, half way along it, and changes
//! sides where the bend does: inflections are ends of steps, too.

mod family;
mod fibre_depth;
mod ruled;
mod strips;

use super::allowance::Fibre;
use crate::brep::face::Face;
use crate::brep::recognised_surface::{bounds, outward, RecognisedSurface};
use crate::geom::{Frame, Vec2, Vec3};
use crate::patchwork::image::{ClosedMap, MapStrip};
pub(super) use fibre_depth::Stretch;
pub use ruled::FlatRuling;
use ruled::Ruled;
use std::f64::consts::{PI, TAU};

/// A face's map to the plane.
#[derive(Clone, Debug)]
pub struct Chart {
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    Plane(Frame),
    Round {
        frame: Frame,
        /// −1 if the outward normal looks to the axis.
        sign: f64,
        angles: Angles,
        /// Half angle; 0 for a cylinder.
        half_angle: f64,
        /// Radius of a cylinder's face, mm.
        radius: f64,
        /// Radius of the neutral cylinder; of a cone, way (mm) by which its neutral cone's apex lies behind.
        neutral: f64,
    },
    Ruled(Box<Ruled>),
}

/// Angles about an axis by the parameter across the rulings: tells turns apart.
#[derive(Clone, Debug)]
struct Angles {
    swapped: bool,
    table: Vec<(f64, f64)>,
    middle: f64,
}

/// Places in the table of angles, enough that turns cannot be mistaken.
const PLACES: usize = 96;
impl Chart {
    /// The map of a face on its surface, `depth` (mm) below its outward side; `None` for faces that are not developable and
    /// where the depth exceeds the radius.
    pub(crate) fn of(face: &Face, recognised: &RecognisedSurface, depth: f64) -> Option<Self> {
        Self::in_sheet(face, recognised, &Fibre::fixed(depth))
    }

    /// The same for the neutral fibre of a sheet; of a cone it has the depth of its middle.
    pub(crate) fn in_sheet(face: &Face, recognised: &RecognisedSurface, fibre: &Fibre) -> Option<Self> {
        let kind = match recognised {
            RecognisedSurface::Plane(frame) => Kind::Plane(*frame),
            RecognisedSurface::Cylinder { frame, radius } => {
                let (sign, angles) = round(face, frame)?;
                let depth = fibre.depth(*radius, sign < 0.0);
                let neutral = radius - sign * depth;
                if neutral < 0.0 {
                    return None;
                }
                Kind::Round { frame: *frame, sign, angles, half_angle: 0.0, radius: *radius, neutral }
            }
            RecognisedSurface::Cone { frame, half_angle } => {
                let (sign, angles) = round(face, frame)?;
                let depth = fibre.depth(middle_radius(face, recognised), sign < 0.0);
                let neutral = -sign * depth / half_angle.tan();
                Kind::Round { frame: *frame, sign, angles, half_angle: *half_angle, radius: 0.0, neutral }
            }
            RecognisedSurface::GeneralCylinder { .. }
            | RecognisedSurface::GeneralCone { .. }
            | RecognisedSurface::TangentSurface => Kind::Ruled(Box::new(Ruled::new(face, fibre)?)),
            RecognisedSurface::Curved(_) => return None,
        };
        Some(Self { kind })
    }

    /// The map with strips in closed form where it has none as a whole, near the face by a small share of `tolerance` (mm).
    pub(crate) fn in_strips(mut self, recognised: &RecognisedSurface, tolerance: f64) -> Self {
        if let Kind::Ruled(r) = &mut self.kind {
            r.strips = strips::strips(r, recognised, tolerance);
        }
        self
    }

    /// Place in the plane of a point of the face; `uv` is its place in the parameter plane, which tells copies on closed
    /// surfaces apart. Without it the copy nearest to the middle of the face is meant.
    pub fn flat(&self, x: &Vec3, uv: Option<[f64; 2]>) -> Vec2 {
        match (&self.kind, self.closed()) {
            (Kind::Ruled(r), _) => r.flat(x, uv),
            (Kind::Round { angles, .. }, Some(map)) => map.flat(x, angles.unwrapped(map.angle(x), uv)),
            (_, Some(map)) => map.flat(x, 0.0),
            (_, None) => Vec2::zeros(),
        }
    }

    /// Place in the plane of the point `x` of the face's surface at the parameters `uv`.
    pub(crate) fn flat_at(&self, uv: [f64; 2], x: &Vec3) -> Vec2 {
        match &self.kind {
            Kind::Ruled(r) => r.flat_on(r.on_face(uv), x),
            Kind::Plane(_) | Kind::Round { .. } => self.flat(x, Some(uv)),
        }
    }

    /// Place in the plane of a point of the ruling at a parameter, on a face without closed form: told apart from others that
    /// pass there, which the nearest place on a surface that meets itself or turns sharply is not.
    pub(super) fn flat_on_ruling(&self, s: f64, x: &Vec3) -> Vec2 {
        match &self.kind {
            Kind::Ruled(r) => r.flat_on(s, x),
            Kind::Plane(_) | Kind::Round { .. } => self.flat(x, None),
        }
    }

    /// The map in closed form; `None` for faces that are neither plane nor circular.
    pub(crate) fn closed(&self) -> Option<ClosedMap> {
        match &self.kind {
            Kind::Plane(frame) => Some(ClosedMap::Plane(*frame)),
            Kind::Round { frame, sign, half_angle, radius, neutral, .. } if *half_angle == 0.0 => {
                Some(ClosedMap::Cylinder { frame: *frame, radius: *radius, reach: sign * neutral })
            }
            Kind::Round { frame, sign, half_angle, neutral, .. } => Some(ClosedMap::Cone {
                frame: *frame,
                half_angle: *half_angle,
                behind: *neutral,
                turn: -sign * half_angle.sin(),
            }),
            Kind::Ruled(_) => None,
        }
    }

    /// Strips in closed form that stand for a face which has none as a whole, in the plane of this map.
    pub(crate) fn strips(&self) -> &[MapStrip] {
        match &self.kind {
            Kind::Ruled(r) => &r.strips,
            Kind::Plane(_) | Kind::Round { .. } => &[],
        }
    }

    /// Parameter of the ruling on which a point of a face without closed form lies; `uv` as of `Self::flat`.
    pub fn ruling_at(&self, x: &Vec3, uv: [f64; 2]) -> f64 {
        match &self.kind {
            Kind::Ruled(r) => r.parameter(x, uv),
            Kind::Plane(_) | Kind::Round { .. } => 0.0,
        }
    }

    /// Both ends of a ruling of a face without closed form, by its parameter.
    pub fn ruling_ends(&self, s: f64) -> Option<[Vec3; 2]> {
        match &self.kind {
            Kind::Ruled(r) => r.ruling_ends(s),
            Kind::Plane(_) | Kind::Round { .. } => None,
        }
    }

    /// Angle (rad) about the axis of a circular face by which a point of it stands.
    pub fn angle(&self, x: &Vec3, uv: Option<[f64; 2]>) -> Option<f64> {
        let Kind::Round { frame, angles, .. } = &self.kind else { return None };
        let q = frame.to_local(x);
        Some(angles.unwrapped(q.y.atan2(q.x), uv))
    }

    /// Radius of the neutral cylinder (mm), 0 for anything else.
    pub fn neutral_radius(&self) -> f64 {
        match &self.kind {
            Kind::Round { half_angle, neutral, .. } if *half_angle == 0.0 => *neutral,
            _ => 0.0,
        }
    }

    /// Whole turn of the normal over the face, rad.
    pub fn turn(&self) -> f64 {
        match &self.kind {
            Kind::Plane(_) => 0.0,
            Kind::Round { angles, half_angle, .. } => angles.width() * half_angle.cos(),
            Kind::Ruled(r) => r.nodes[r.nodes.len() - 1].1.bent,
        }
    }

    /// Rulings half way through `count` equal parts of the turn.
    pub fn rulings(&self, count: usize) -> Vec<FlatRuling> {
        self.rulings_between([0.0, 1.0], count)
    }

    /// The same between two shares of the turn.
    pub(crate) fn rulings_between(&self, [from, to]: [f64; 2], count: usize) -> Vec<FlatRuling> {
        let angle = self.turn() * (to - from) / count as f64;
        let shares = (0..count).map(|k| from + (to - from) * (k as f64 + 0.5) / count as f64);
        match &self.kind {
            Kind::Plane(_) => Vec::new(),
            Kind::Round { sign, angles, half_angle, neutral, radius: own, .. } => {
                let depth =
                    if *half_angle == 0.0 { sign * (own - neutral) } else { -sign * neutral * half_angle.tan() };
                let place = |share: f64| {
                    let theta = angles.table[0].1 + (angles.table[PLACES].1 - angles.table[0].1) * share;
                    if *half_angle == 0.0 {
                        (Vec2::new(sign * neutral * theta, 0.0), Vec2::y())
                    } else {
                        let (s, c) = (-sign * half_angle.sin() * theta).sin_cos();
                        (Vec2::zeros(), Vec2::new(c, s))
                    }
                };
                let (radius, rise) = if *half_angle == 0.0 { (*neutral, 0.0) } else { (0.0, half_angle.tan()) };
                let ruling = |(at, way)| FlatRuling { at, way, angle, hollow: *sign < 0.0, radius, rise, depth };
                shares.map(place).map(ruling).collect()
            }
            Kind::Ruled(r) => shares.filter_map(|s| r.ruling(s, angle)).collect(),
        }
    }

    /// The stretches of the face that are bent one way, in order.
    pub(super) fn stretches(&self) -> Vec<Stretch> {
        match &self.kind {
            Kind::Plane(_) => Vec::new(),
            Kind::Round { sign, .. } => vec![Stretch { turn: [0.0, 1.0], way: 1.0, hollow: *sign < 0.0 }],
            Kind::Ruled(r) => r.stretches(),
        }
    }

    /// Whether the face stands out, seen from outside: +1, −1 if it is hollow, 0 where that is not one answer.
    pub(crate) fn bulge(&self) -> f64 {
        match &self.kind {
            Kind::Round { sign, .. } => *sign,
            _ => 0.0,
        }
    }
}

/// Radius (mm) of a circular face, of a cone in the middle of its parameters; else infinite.
pub(super) fn middle_radius(face: &Face, recognised: &RecognisedSurface) -> f64 {
    match recognised {
        RecognisedSurface::Cylinder { radius, .. } => *radius,
        RecognisedSurface::Cone { half_angle, frame } => {
            let [u0, u1, v0, v1] = bounds(face);
            let p = frame.to_local(&face.surface.point(0.5 * (u0 + u1), 0.5 * (v0 + v1)));
            p.x.hypot(p.y) / half_angle.cos()
        }
        _ => f64::INFINITY,
    }
}

/// Sign and angles of a face on a circular surface.
fn round(face: &Face, frame: &Frame) -> Option<(f64, Angles)> {
    let [u0, u1, v0, v1] = bounds(face);
    let (u, v) = (0.5 * (u0 + u1), 0.5 * (v0 + v1));
    let j = face.surface.jet(u, v);
    let steep = |d: Vec3| d.try_normalize(0.0).map_or(0.0, |d| d.dot(&frame.z).abs());
    let swapped = steep(j.du) > steep(j.dv);
    let q = frame.to_local(&j.p);
    let sign = frame.vector_to_world(&Vec3::new(q.x, q.y, 0.0)).dot(&outward(face, [u, v])?).signum();
    // On closed surfaces trims may touch the ends of the domain.
    let (lo, hi) = if swapped { (v0, v1) } else { (u0, u1) };
    let mut table: Vec<(f64, f64)> = Vec::with_capacity(PLACES + 1);
    for k in 0..=PLACES {
        let s = lo + (hi - lo) * k as f64 / PLACES as f64;
        let p = if swapped { face.surface.point(u, s) } else { face.surface.point(s, v) };
        let q = frame.to_local(&p);
        let a = q.y.atan2(q.x);
        let near = table.last().map_or(a, |t| t.1);
        table.push((s, nearest_turn(a, near)));
    }
    let middle = 0.5 * (table[0].1 + table[PLACES].1);
    Some((sign, Angles { swapped, table, middle }))
}

fn nearest_turn(angle: f64, near: f64) -> f64 {
    angle + TAU * ((near - angle) / TAU).round()
}

impl Angles {
    fn width(&self) -> f64 {
        (self.table[PLACES].1 - self.table[0].1).abs()
    }

    fn unwrapped(&self, angle: f64, uv: Option<[f64; 2]>) -> f64 {
        let Some(uv) = uv else { return self.middle + (angle - self.middle + PI).rem_euclid(TAU) - PI };
        let s = if self.swapped { uv[1] } else { uv[0] };
        let k = self.table.partition_point(|t| t.0 <= s).clamp(1, PLACES);
        let ((a, p), (b, q)) = (self.table[k - 1], self.table[k]);
        nearest_turn(angle, p + (q - p) * ((s - a) / (b - a)).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::recognised_surface::recognise;
    use crate::spline::knots::Knots;
    use crate::spline::surface::Surface;

    /// A profile of 40 chords of 2 mm that turn by 0.4° each about the y axis: a hollow of radius 286 mm, seen from above.
    #[test]
    fn edges_too_blunt_to_be_bends_of_their_own_are_a_roll() {
        let turn = 0.4_f64.to_radians();
        let mut profile = vec![Vec3::zeros()];
        for k in 0..40 {
            let (sin, cos) = (turn * f64::from(k)).sin_cos();
            profile.push(profile[profile.len() - 1] + Vec3::new(cos, 0.0, sin) * 2.0);
        }
        let knots = |n: usize| Knots::clamped(1, &(0..=n).map(|k| k as f64).collect::<Vec<_>>()).expect("knots");
        let points: Vec<Vec3> = profile.iter().flat_map(|p| [*p, p + Vec3::y() * 50.0]).collect();
        let mut face = Face::untrimmed(Surface::new(knots(40), knots(1), &points, None).expect("a surface"));
        let recognised = recognise(&face);
        for (reversed, way) in [(false, 1.0), (true, -1.0)] {
            face.reversed = reversed;
            for depth in [0.0, 1.5] {
                let chart = Chart::of(&face, &recognised, depth).expect("a chart").in_strips(&recognised, 0.01);
                assert!((chart.turn() - 39.0 * turn).abs() < 1e-9);
                let long = 80.0 + way * depth * 39.0 * turn;
                let ends = [0.0, 40.0].map(|u| chart.flat(&face.surface.point(u, 0.0), Some([u, 0.0])));
                assert!(((ends[1] - ends[0]).norm() - long).abs() < 1e-6, "{ends:?} {long}");
                let strips = chart.strips();
                let drawn = [(0, 0), (strips.len() - 1, 1)].map(|(k, end): (usize, usize)| {
                    let ClosedMap::Cylinder { reach, .. } = strips[k].map else { panic!("a cylinder") };
                    strips[k].shift.y - strips[k].angles[end] * reach
                });
                assert!(((drawn[1] - drawn[0]).abs() - long).abs() < 1e-6, "{drawn:?} {long}");
                for r in chart.rulings(6) {
                    assert_eq!(r.hollow, !reversed);
                    assert!((r.radius.abs() - (2.0 / turn + way * depth)).abs() < 1e-6, "{r:?}");
                }
            }
        }
    }

    #[test]
    fn rulings_end_where_neighbours_meet() {
        let ruling = |at: f64, radius: f64| FlatRuling {
            at: Vec2::new(at, 0.0),
            way: Vec2::x(),
            angle: 0.1,
            hollow: false,
            radius,
            rise: 0.6,
            depth: 0.0,
        };
        let stretch = |a: f64, b: f64| [Vec2::new(a, 0.0), Vec2::new(b, 0.0)];
        // Of a cone about the origin that is wider than half a turn, both ends of the line are in the part.
        assert_eq!(ruling(0.0, 0.0).on_own_side(stretch(-90.0, 100.0)), Some(stretch(0.0, 100.0)));
        assert_eq!(ruling(0.0, 0.0).on_own_side(stretch(100.0, -90.0)), Some(stretch(100.0, 0.0)));
        assert_eq!(ruling(0.0, 0.0).on_own_side(stretch(-90.0, -20.0)), None);
        assert_eq!(ruling(50.0, 30.0).on_own_side(stretch(20.0, 80.0)), Some(stretch(20.0, 80.0)));
    }
}
