//! The isometric map of one face's neutral surface to the plane, seen from outside.
//!
//! *Method*: planes, circular cylinders and circular cones in closed form. Every other developable is a family of rulings
//! `p(s) + r w(s)` with one normal `n(s)` along each; with the frame `w, e = n × w` the flat ruling turns by
//! `Φ' = w'·e` and its base point moves by `(q'·w, q'·e)` in that frame, where `q = p − δ n` lies in the neutral surface
//! at depth δ below the face. Both are integrated by Runge–Kutta steps of fourth order, knots of the surface among
//! their ends. Where the normal jumps at a knot, the sheet bends about an edge by that angle, and the neutral surface is
//! shorter or longer by δ times it. In a sheet δ follows from K at the inside radius of each ruling, half way along it, and changes
//! sides where the bend does: inflections are ends of steps, too.

mod along;
mod strips;

use super::allowance::Fibre;
use crate::brep::carrier::{bounds, outward, rulings, Carrier};
use crate::brep::face::Face;
use crate::brep::project::SurfaceProjector;
use crate::geom::{Frame, Vec2, Vec3};
use crate::patchwork::image::{ClosedMap, MapStrip};
use crate::spline::surface::Surface;
pub(super) use along::Stretch;
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

/// Rulings with their places in the plane.
#[derive(Clone, Debug)]
struct Ruled {
    surface: Surface,
    swapped: bool,
    reversed: bool,
    along: (f64, f64),
    fibre: Fibre,
    nodes: Vec<(f64, State)>,
    /// Parameters of the knots, and of inflections if they count.
    breaks: Vec<f64>,
    /// Edges.
    jumps: Vec<Jump>,
    projector: SurfaceProjector,
    strips: Vec<MapStrip>,
}

/// An edge about which a face turns.
#[derive(Clone, Copy, Debug)]
struct Jump {
    /// The node right after it.
    node: usize,
    /// By how much (rad) the normal turns there towards `e`.
    turn: f64,
    /// Depth (mm) of the neutral fibre there.
    depth: f64,
}

/// Turn and base point of a flat ruling.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    turn: f64,
    base: Vec2,
    /// Turn of the normal so far, whichever way.
    bent: f64,
}

impl State {
    /// Beyond an edge about which the face turns, on the neutral surface `depth` (mm) below it.
    fn past(self, jump: f64, depth: f64) -> Self {
        let across = Vec2::new(-self.turn.sin(), self.turn.cos());
        Self { base: self.base - across * (depth * jump), bent: self.bent + jump.abs(), ..self }
    }
}

/// A ruling in the plane, standing for a part of the turn of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatRuling {
    /// A point of it.
    pub at: Vec2,
    /// Unit direction.
    pub way: Vec2,
    /// Turn of the face that it stands for, rad.
    pub angle: f64,
    /// Whether the face is hollow there, seen from outside: the sheet comes up.
    pub hollow: bool,
    /// Radius of curvature of the neutral surface at the point (mm), and by how much it grows per mm along the ruling.
    pub radius: f64,
    /// See `radius`.
    pub rise: f64,
    /// Depth (mm) of the neutral surface below the face.
    pub depth: f64,
}

impl FlatRuling {
    /// Radius of curvature at a point of the ruling, mm.
    pub fn radius_at(&self, p: &Vec2) -> f64 {
        self.signed_radius(p).abs()
    }

    fn signed_radius(&self, p: &Vec2) -> f64 {
        self.radius + self.rise * self.way.dot(&(p - self.at))
    }

    /// The part of a stretch of the ruling that is on the ruling's own side of the point where neighbours meet: a line through
    /// the apex of a fan of more than half a turn comes out on its other side. `None` where nothing is left.
    pub fn on_own_side(&self, stretch: [Vec2; 2]) -> Option<[Vec2; 2]> {
        let own = if self.radius == 0.0 { self.rise.signum() } else { self.radius.signum() };
        let radii = stretch.map(|p| own * self.signed_radius(&p));
        let [a, b] = radii;
        let reach = a.abs().max(b.abs());
        if a.max(b) <= AT_APEX * reach {
            return None;
        }
        let meet = stretch[0] + (stretch[1] - stretch[0]) * (a / (a - b));
        let kept = |k: usize| if radii[k] < -AT_APEX * reach { meet } else { stretch[k] };
        Some([kept(0), kept(1)])
    }
}

/// Radius at an apex, as a share of the greatest along a ruling: rounding.
const AT_APEX: f64 = 1e-9;

/// Angle about an axis from which on places are not told apart: a little less than a whole turn, rad.
const WIDEST: f64 = TAU - 0.01;
/// Places in the table of angles, enough that turns cannot be mistaken.
const PLACES: usize = 96;
/// Share of a span by which integration keeps from knots, which have two sides: above rounding, below any effect.
const HAIR: f64 = 1e-12;
/// Normals that turn by less (rad) at a knot go on: what ten printed digits lose on short spans.
const EDGE: f64 = 1e-6;
/// Steps of the integration on each span between knots.
const STEPS: usize = 96;
/// Newton's steps to the ruling up to which a face has turned by so much: they begin within the square of a step.
const NEWTON: usize = 3;

impl Chart {
    /// The map of a face on its carrier, `depth` (mm) below its outward side; `None` for faces that are not developable and
    /// where the depth exceeds the radius.
    pub fn of(face: &Face, carrier: &Carrier, depth: f64) -> Option<Self> {
        Self::in_sheet(face, carrier, &Fibre::fixed(depth))
    }

    /// The same for the neutral fibre of a sheet; of a cone it has the depth of its middle.
    pub fn in_sheet(face: &Face, carrier: &Carrier, fibre: &Fibre) -> Option<Self> {
        let kind = match carrier {
            Carrier::Plane(frame) => Kind::Plane(*frame),
            Carrier::Cylinder { frame, radius } => {
                let (sign, angles) = round(face, frame)?;
                let depth = fibre.depth(*radius, sign < 0.0);
                let neutral = radius - sign * depth;
                if neutral < 0.0 {
                    return None;
                }
                Kind::Round { frame: *frame, sign, angles, half_angle: 0.0, radius: *radius, neutral }
            }
            Carrier::Cone { frame, half_angle } => {
                let (sign, angles) = round(face, frame)?;
                let depth = fibre.depth(middle_radius(face, carrier), sign < 0.0);
                let neutral = -sign * depth / half_angle.tan();
                Kind::Round { frame: *frame, sign, angles, half_angle: *half_angle, radius: 0.0, neutral }
            }
            Carrier::GeneralCylinder { .. } | Carrier::GeneralCone { .. } | Carrier::TangentSurface => {
                Kind::Ruled(Box::new(Ruled::new(face, fibre)?))
            }
            Carrier::Curved(_) => return None,
        };
        Some(Self { kind })
    }

    /// The map with strips in closed form where it has none as a whole, near the face by a small share of `tolerance` (mm).
    pub fn in_strips(mut self, carrier: &Carrier, tolerance: f64) -> Self {
        if let Kind::Ruled(r) = &mut self.kind {
            r.strips = strips::strips(r, carrier, tolerance);
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

    /// The map in closed form; `None` for faces that are neither plane nor circular.
    pub fn closed(&self) -> Option<ClosedMap> {
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
    pub fn strips(&self) -> &[MapStrip] {
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

    /// Whether the face is so wide that a place in space does not tell on which turn about the axis it is.
    pub fn closes(&self) -> bool {
        match &self.kind {
            Kind::Round { angles, .. } => angles.width() >= WIDEST,
            Kind::Plane(_) | Kind::Ruled(_) => false,
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
    pub fn rulings_between(&self, [from, to]: [f64; 2], count: usize) -> Vec<FlatRuling> {
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
    pub fn bulge(&self) -> f64 {
        match &self.kind {
            Kind::Round { sign, .. } => *sign,
            _ => 0.0,
        }
    }
}

/// Radius (mm) of a circular face, of a cone in the middle of its parameters; else infinite.
pub(super) fn middle_radius(face: &Face, carrier: &Carrier) -> f64 {
    match carrier {
        Carrier::Cylinder { radius, .. } => *radius,
        Carrier::Cone { half_angle, frame } => {
            let [u0, u1, v0, v1] = bounds(face);
            let p = frame.to_local(&face.surface.point(0.5 * (u0 + u1), 0.5 * (v0 + v1)));
            p.x.hypot(p.y) / half_angle.cos()
        }
        _ => f64::INFINITY,
    }
}

/// Sign and angles of a face on a circular carrier.
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

/// A ruling with its derivatives in s.
struct Line {
    p: Vec3,
    w: Vec3,
    n: Vec3,
    dp: Vec3,
    dw: Vec3,
    dn: Vec3,
}

impl Ruled {
    fn new(face: &Face, fibre: &Fibre) -> Option<Self> {
        let rulings = rulings(face)?;
        let mut out = Self {
            surface: face.surface.clone(),
            swapped: rulings.is_swapped(),
            reversed: face.reversed,
            along: rulings.reach(),
            fibre: fibre.clone(),
            nodes: Vec::new(),
            breaks: rulings.breaks(),
            jumps: Vec::new(),
            projector: SurfaceProjector::new(&face.surface),
            strips: Vec::new(),
        };
        if fibre.varies() {
            out.breaks = out.with_inflections();
        }
        let breaks = out.breaks.clone();
        let mut state = State::default();
        out.nodes.push((breaks[0], state));
        for (span, w) in breaks.windows(2).enumerate() {
            let hair = HAIR * (w[1] - w[0]);
            if let Some(turn) = (span > 0).then(|| out.jump(w[0], hair)).flatten() {
                let depth = out.depth_about([breaks[span - 1], w[0], w[1]], turn)?;
                state = state.past(turn, depth);
                out.jumps.push(Jump { node: out.nodes.len(), turn, depth });
                out.nodes.push((w[0], state));
            }
            for k in 0..STEPS {
                // To the bit, the knot.
                let at = |k: usize| if k == STEPS { w[1] } else { w[0] + (w[1] - w[0]) * k as f64 / STEPS as f64 };
                let (a, b) = (at(k), at(k + 1));
                state = out.step(state, a.max(w[0] + hair), b.min(w[1] - hair))?;
                out.nodes.push((b, state));
            }
        }
        Some(out)
    }

    fn line(&self, s: f64) -> Option<Line> {
        let (lo, hi) = self.along;
        let jet = |r: f64| {
            let j = if self.swapped { self.surface.jet(r, s) } else { self.surface.jet(s, r) };
            if self.swapped {
                (j.p, j.dv, j.du, j.dvv, j.duv)
            } else {
                (j.p, j.du, j.dv, j.duu, j.duv)
            }
        };
        let (a, da, ..) = jet(lo);
        let (b, db, ..) = jet(hi);
        let (p, ps, pr, pss, psr) = jet(0.5 * (lo + hi));
        let length = (b - a).norm();
        let w = (b - a).try_normalize(0.0)?;
        let dw = ((db - da) - w * w.dot(&(db - da))) / length;
        // The sense of the normal: that of S_u × S_v, turned if the face is.
        let sense = if self.swapped == self.reversed { 1.0 } else { -1.0 };
        let (big, dbig) = (ps.cross(&pr) * sense, (pss.cross(&pr) + ps.cross(&psr)) * sense);
        let n = big.try_normalize(0.0)?;
        let dn = (dbig - n * n.dot(&dbig)) / big.norm();
        Some(Line { p, w, n, dp: ps, dw, dn })
    }

    /// Turn of the normal (rad) towards `e` at a knot, from `hair` before it to `hair` behind. `None` where it goes on within
    /// rounding.
    fn jump(&self, at: f64, hair: f64) -> Option<f64> {
        let (before, after) = (self.line(at - hair)?, self.line(at + hair)?);
        let turn = before.n.angle(&after.n).copysign(after.n.dot(&before.n.cross(&before.w)));
        (turn.abs() > EDGE).then_some(turn)
    }

    /// By how much (mm) the neutral surface is shorter by the edge at a knot, 0 where there is none.
    fn shortened_at(&self, knot: f64) -> f64 {
        self.jumps.iter().find(|j| self.nodes[j.node].0 == knot).map_or(0.0, |j| j.depth * j.turn)
    }

    /// One Runge–Kutta step; the turn does not depend on the state, so its slopes serve for both.
    fn step(&self, from: State, a: f64, b: f64) -> Option<State> {
        let h = b - a;
        let slope = |s: f64| {
            let l = self.line(s)?;
            let e = l.n.cross(&l.w);
            let dq = l.dp - l.dn * self.depth_of(&l);
            Some((l.dw.dot(&e), Vec2::new(dq.dot(&l.w), dq.dot(&e)), l.dn.norm()))
        };
        let [f0, f1, f2, f3, f4] =
            [slope(a)?, slope(a + 0.25 * h)?, slope(a + 0.5 * h)?, slope(a + 0.75 * h)?, slope(b)?];
        // Turn half way and at the end by Simpson's rule, then the base point with these turns.
        let half = from.turn + h / 12.0 * (f0.0 + 4.0 * f1.0 + f2.0);
        let whole = half + h / 12.0 * (f2.0 + 4.0 * f3.0 + f4.0);
        let turned = |v: Vec2, a: f64| {
            let (s, c) = a.sin_cos();
            Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y)
        };
        let moved = turned(f0.1, from.turn) + turned(f2.1, half) * 4.0 + turned(f4.1, whole);
        let bent = from.bent + h / 6.0 * (f0.2 + 4.0 * f2.2 + f4.2);
        Some(State { turn: whole, base: from.base + moved * (h / 6.0), bent })
    }

    /// The ruling at a share of the turn of the normal.
    fn ruling(&self, share: f64, angle: f64) -> Option<FlatRuling> {
        let (k, s, state) = self.turned(share)?;
        if let Ok(edge) = self.jumps.binary_search_by_key(&k, |j| j.node) {
            return self.edge(edge, angle);
        }
        let l = self.line(s)?;
        let (e, way) = (l.n.cross(&l.w), Vec2::new(state.turn.cos(), state.turn.sin()));
        let hollow = l.curvature() < 0.0;
        let (bent, depth) = (l.dn.norm(), self.depth_of(&l));
        let (radius, rise) = ((l.dp - l.dn * depth).dot(&e) / bent, l.dw.dot(&e) / bent);
        Some(FlatRuling { at: state.base, way, angle, hollow, radius, rise, depth })
    }

    /// The step at whose end a share of the turn of the normal is passed, the parameter of the ruling there, and its state. An edge
    /// is a step of its own.
    fn turned(&self, share: f64) -> Option<(usize, f64, State)> {
        let wanted = share * self.nodes[self.nodes.len() - 1].1.bent;
        let k = self.nodes.partition_point(|n| n.1.bent < wanted).clamp(1, self.nodes.len() - 1);
        let ((a, p), (b, q)) = (self.nodes[k - 1], self.nodes[k]);
        let part = if q.bent > p.bent { (wanted - p.bent) / (q.bent - p.bent) } else { 0.5 };
        let mut s = a + (b - a) * part;
        let mut state = self.step(p, a, s)?;
        // The turn is not even over a step, which would move the ruling by the square of the step.
        for _ in 0..NEWTON {
            let more = (wanted - state.bent) / self.line(s)?.dn.norm();
            if !more.is_finite() || a == b || q.bent <= p.bent {
                break;
            }
            s = (s + more).clamp(a, b);
            state = self.step(p, a, s)?;
        }
        Some((k, s, state))
    }

    /// An edge as a ruling: its radius is that of a sheet which is bent as much between the middles of the spans beside it.
    fn edge(&self, edge: usize, angle: f64) -> Option<FlatRuling> {
        let Jump { node: k, turn: jump, depth } = self.jumps[edge];
        let (s, state) = self.nodes[k];
        let way = Vec2::new(state.turn.cos(), state.turn.sin());
        let half = STEPS / 2;
        let ends = [k - 1 - half, k + half].map(|k| self.nodes[k]);
        let bent = ends[1].1.bent - ends[0].1.bent;
        let (mut radius, mut rise) = (0.0, 0.0);
        for (end, _) in ends {
            let l = self.line(0.5 * (s + end))?;
            let e = l.n.cross(&l.w);
            let span = (end - s).abs();
            radius += l.dp.dot(&e) * span / bent;
            rise += l.dw.dot(&e) * span / bent;
        }
        let hollow = jump * radius < 0.0;
        radius -= depth * jump.signum();
        Some(FlatRuling { at: state.base, way, angle, hollow, radius, rise, depth })
    }

    /// Both ends of a ruling.
    fn ruling_ends(&self, s: f64) -> Option<[Vec3; 2]> {
        let at = |r: f64| if self.swapped { self.surface.point(r, s) } else { self.surface.point(s, r) };
        let ends = [at(self.along.0), at(self.along.1)];
        ends.iter().all(|p| p.iter().all(|x| x.is_finite())).then_some(ends)
    }

    /// Parameter of the ruling on which a point lies.
    fn parameter(&self, x: &Vec3, uv: [f64; 2]) -> f64 {
        let (first, last) = (self.nodes[0].0, self.nodes[self.nodes.len() - 1].0);
        let mut s = if self.swapped { uv[1] } else { uv[0] };
        // The guide keeps near the edge; Newton's steps bring it to the point's own ruling.
        for _ in 0..8 {
            let Some(l) = self.line(s.clamp(first, last)) else { break };
            let e = l.n.cross(&l.w);
            let off = x - l.p;
            let slope = l.dp.dot(&e) + off.dot(&l.w) * l.dw.dot(&e);
            let step = off.dot(&e) / slope;
            if !step.is_finite() {
                break;
            }
            s = (s + step).clamp(first, last);
            if step.abs() <= f64::EPSILON * (last - first) {
                break;
            }
        }
        s
    }

    fn flat(&self, x: &Vec3, uv: Option<[f64; 2]>) -> Vec2 {
        self.flat_on(self.parameter(x, uv.unwrap_or_else(|| self.projector.nearest(&self.surface, x).at)), x)
    }

    /// Place in the plane of a point of the ruling at `s`.
    fn flat_on(&self, s: f64, x: &Vec3) -> Vec2 {
        let k = self.nodes.partition_point(|n| n.0 <= s).clamp(1, self.nodes.len() - 1) - 1;
        let (at, before) = self.nodes[k];
        let state = if s > at { self.step(before, at, s).unwrap_or(before) } else { before };
        let reach = self.line(s).map_or(0.0, |l| (x - l.p).dot(&l.w));
        state.base + Vec2::new(state.turn.cos(), state.turn.sin()) * reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::carrier::carrier;
    use crate::spline::knots::Knots;

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
        let carrier = carrier(&face);
        for (reversed, way) in [(false, 1.0), (true, -1.0)] {
            face.reversed = reversed;
            for depth in [0.0, 1.5] {
                let chart = Chart::of(&face, &carrier, depth).expect("a chart").in_strips(&carrier, 0.01);
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
