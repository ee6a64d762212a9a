//! A developable face as a family of rulings, integrated to the plane: docs/algorithms/unroll.md.

use crate::brep::face::Face;
use crate::brep::project::SurfaceProjector;
use crate::brep::recognised_surface::rulings;
use crate::develop::unfold::allowance::Fibre;
use crate::geom::{Vec2, Vec3};
use crate::patchwork::image::MapStrip;
use crate::spline::surface::Surface;

/// Rulings with their places in the plane.
#[derive(Clone, Debug)]
pub(super) struct Ruled {
    pub(super) surface: Surface,
    pub(super) swapped: bool,
    pub(super) reversed: bool,
    pub(super) along: (f64, f64),
    pub(super) fibre: Fibre,
    pub(super) nodes: Vec<(f64, State)>,
    /// Parameters of the knots, and of inflections if they count.
    pub(super) breaks: Vec<f64>,
    /// Edges.
    pub(super) jumps: Vec<Jump>,
    /// By how much (mm) the base points of a step and of its halves may differ.
    slack: f64,
    pub(super) projector: SurfaceProjector,
    pub(super) strips: Vec<MapStrip>,
}

/// An edge about which a face turns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jump {
    /// The node right after it.
    pub(super) node: usize,
    /// By how much (rad) the normal turns there towards `e`.
    pub(super) turn: f64,
    /// Depth (mm) of the neutral fibre there.
    pub(super) depth: f64,
}

/// Turn and base point of a flat ruling.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    pub(super) turn: f64,
    pub(super) base: Vec2,
    /// Turn of the normal so far, whichever way.
    pub(super) bent: f64,
}

impl State {
    /// Beyond an edge about which the face turns, on the neutral surface `depth` (mm) below it.
    pub(super) fn past(self, jump: f64, depth: f64) -> Self {
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

    pub(super) fn signed_radius(&self, p: &Vec2) -> f64 {
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
pub(super) const AT_APEX: f64 = 1e-9;
/// Share of a span by which integration keeps from knots, which have two sides: above rounding, below any effect.
pub(super) const HAIR: f64 = 1e-12;
/// Normals that turn by less (rad) at a knot go on: what ten printed digits lose on short spans.
pub(super) const EDGE: f64 = 1e-6;
/// Steps of the integration on each span between knots, at first.
pub(super) const STEPS: usize = 96;
/// Share of the surface's extent by which the base points of a step and of its halves may differ: above rounding. A cylinder over a
/// Bézier curve of degree 6 that turns within 0.4 mm is 0.013 mm off without halved steps, and within 10⁻⁹ mm with them.
const HALVES_AGREE: f64 = 1e-12;
/// Halvings of a step at most.
const STEP_HALVINGS: usize = 12;
/// Newton's steps to the ruling up to which a face has turned by so much: they begin within the square of a step.
const NEWTON: usize = 3;

/// A ruling with its derivatives in s.
pub(super) struct RulingJet {
    pub(super) p: Vec3,
    pub(super) w: Vec3,
    pub(super) n: Vec3,
    pub(super) dp: Vec3,
    pub(super) dw: Vec3,
    pub(super) dn: Vec3,
}

impl Ruled {
    pub(super) fn new(face: &Face, fibre: &Fibre) -> Option<Self> {
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
            slack: HALVES_AGREE * face.surface.bbox().diagonal(),
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
                state = out.integrate(state, [a, b], [w[0] + hair, w[1] - hair], STEP_HALVINGS)?;
            }
        }
        Some(out)
    }

    pub(super) fn line(&self, s: f64) -> Option<RulingJet> {
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
        Some(RulingJet { p, w, n, dp: ps, dw, dn })
    }

    /// Turn of the normal (rad) towards `e` at a knot, from `hair` before it to `hair` behind. `None` where it goes on within
    /// rounding.
    pub(super) fn jump(&self, at: f64, hair: f64) -> Option<f64> {
        let (before, after) = (self.line(at - hair)?, self.line(at + hair)?);
        let turn = before.n.angle(&after.n).copysign(after.n.dot(&before.n.cross(&before.w)));
        (turn.abs() > EDGE).then_some(turn)
    }

    /// By how much (mm) the neutral surface is shorter by the edge at a knot, 0 where there is none.
    pub(super) fn shortened_at(&self, knot: f64) -> f64 {
        self.jumps.iter().find(|j| self.nodes[j.node].0 == knot).map_or(0.0, |j| j.depth * j.turn)
    }

    /// Steps from one node to the next, halved where the sheet bends too much for one; `within` keeps from the knots.
    fn integrate(&mut self, from: State, [a, b]: [f64; 2], within: [f64; 2], halvings: usize) -> Option<State> {
        let (state, off) = self.step_and_error(from, a.max(within[0]), b.min(within[1]))?;
        if off <= self.slack || halvings == 0 {
            self.nodes.push((b, state));
            return Some(state);
        }
        let m = 0.5 * (a + b);
        let half = self.integrate(from, [a, m], within, halvings - 1)?;
        self.integrate(half, [m, b], within, halvings - 1)
    }

    pub(super) fn step(&self, from: State, a: f64, b: f64) -> Option<State> {
        self.step_and_error(from, a, b).map(|s| s.0)
    }

    /// One step, and by how much (mm) the base point would differ after two halves of it; the turn does not depend on the state, so its
    /// slopes serve for both.
    fn step_and_error(&self, from: State, a: f64, b: f64) -> Option<(State, f64)> {
        let h = b - a;
        let slope = |s: f64| {
            let l = self.line(s)?;
            let e = l.n.cross(&l.w);
            let dq = l.dp - l.dn * self.depth_of(&l);
            Some((l.dw.dot(&e), Vec2::new(dq.dot(&l.w), dq.dot(&e)), l.dn.norm()))
        };
        let f = [slope(a)?, slope(a + 0.25 * h)?, slope(a + 0.5 * h)?, slope(a + 0.75 * h)?, slope(b)?];
        // Turns by Simpson's rule, of quarters by the parabola through three slopes, then the base point with these turns.
        let half = from.turn + h / 12.0 * (f[0].0 + 4.0 * f[1].0 + f[2].0);
        let whole = half + h / 12.0 * (f[2].0 + 4.0 * f[3].0 + f[4].0);
        let quarter = |k: usize| h / 48.0 * (5.0 * f[k].0 + 8.0 * f[k + 1].0 - f[k + 2].0);
        let turns = [from.turn, from.turn + quarter(0), half, half + quarter(2), whole];
        let turned = |k: usize| {
            let (s, c) = turns[k].sin_cos();
            Vec2::new(c * f[k].1.x - s * f[k].1.y, s * f[k].1.x + c * f[k].1.y)
        };
        let v = [turned(0), turned(1), turned(2), turned(3), turned(4)];
        let moved = (v[0] + v[2] * 4.0 + v[4]) * (h / 6.0);
        let by_halves = (v[0] + v[1] * 4.0 + v[2] * 2.0 + v[3] * 4.0 + v[4]) * (h / 12.0);
        let bent = from.bent + h / 6.0 * (f[0].2 + 4.0 * f[2].2 + f[4].2);
        Some((State { turn: whole, base: from.base + moved, bent }, (by_halves - moved).norm()))
    }

    /// The ruling at a share of the turn of the normal.
    pub(super) fn ruling(&self, share: f64, angle: f64) -> Option<FlatRuling> {
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
    pub(super) fn turned(&self, share: f64) -> Option<(usize, f64, State)> {
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
    pub(super) fn edge(&self, edge: usize, angle: f64) -> Option<FlatRuling> {
        let Jump { node: k, turn: jump, depth } = self.jumps[edge];
        let (s, state) = self.nodes[k];
        let way = Vec2::new(state.turn.cos(), state.turn.sin());
        let next = self.breaks.partition_point(|b| *b <= s);
        let ends = [next - 2, next].map(|k| 0.5 * (s + self.breaks[k]));
        let bent = self.state(ends[1]).bent - self.state(ends[0]).bent;
        let (mut radius, mut rise) = (0.0, 0.0);
        for end in ends {
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
    pub(super) fn ruling_ends(&self, s: f64) -> Option<[Vec3; 2]> {
        let at = |r: f64| if self.swapped { self.surface.point(r, s) } else { self.surface.point(s, r) };
        let ends = [at(self.along.0), at(self.along.1)];
        ends.iter().all(|p| p.iter().all(|x| x.is_finite())).then_some(ends)
    }

    /// Parameters of the first and the last ruling.
    fn ends(&self) -> (f64, f64) {
        (self.nodes[0].0, self.nodes[self.nodes.len() - 1].0)
    }

    /// Parameter of the ruling through a place of the parameter plane; the first or the last beyond these.
    pub(super) fn on_face(&self, uv: [f64; 2]) -> f64 {
        let (first, last) = self.ends();
        uv[usize::from(self.swapped)].clamp(first, last)
    }

    /// Parameter of the ruling on which a point lies.
    pub(super) fn parameter(&self, x: &Vec3, uv: [f64; 2]) -> f64 {
        let (first, last) = self.ends();
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

    pub(super) fn flat(&self, x: &Vec3, uv: Option<[f64; 2]>) -> Vec2 {
        self.flat_on(self.parameter(x, uv.unwrap_or_else(|| self.projector.nearest(&self.surface, x).at)), x)
    }

    /// Place in the plane of a point of the ruling at `s`.
    pub(super) fn flat_on(&self, s: f64, x: &Vec3) -> Vec2 {
        let state = self.state(s);
        let reach = self.line(s).map_or(0.0, |l| (x - l.p).dot(&l.w));
        state.base + Vec2::new(state.turn.cos(), state.turn.sin()) * reach
    }

    /// Turn and base point of the ruling at `s`.
    fn state(&self, s: f64) -> State {
        let k = self.nodes.partition_point(|n| n.0 <= s).clamp(1, self.nodes.len() - 1) - 1;
        let (at, before) = self.nodes[k];
        if s > at {
            self.step(before, at, s).unwrap_or(before)
        } else {
            before
        }
    }
}
