//! The exported trimming curves against the image of the region's boundary.
//!
//! The boundary of a panel's region is a polyline γ of the face's parameter plane; every point of it has a foot on the
//! torse. The exported boundary is another curve θ(s) = (t, r) on the patch. This module bounds, for every s, the
//! length of a path on the torse from the foot of `X = S(γ(s))` to `R(θ(s))` \[certificate, H5\]:
//! first with X fixed and t running from the foot to θ₁, following the foot of the perpendicular on the ruling; then
//! along the ruling. With `Q(s) = E(X, θ₁)` and `p(s) = e(θ₁)·(X − R(θ))` these lengths are at most
//! `|Q|/|E_t| (|G|/|m⊥| + q |n×m'|/|e|)` and `|p|/|e|`, where G = m'·P − k' at the points of the path and q their
//! distance to X across the ruling.
//!
//! *Why lengths suffice*. Moving along these paths is a homotopy from the foot curve to θ in the plane of (t, position
//! along the ruling). A point y of the panel that is not on the paths has equal winding numbers under both curves: not
//! zero for θ means that y is the foot of a point of the region, at most D away. A point on a path is at most δ along the
//! torse from the foot P of some X. Conversely, since the foot map does not fold, the foot of every point of the region
//! is on the panel, or on a path, at most δ along the torse from a point of θ. With κ the curvature of the torse along
//! the paths, the normal turns by at most κ per unit of length, so a way of length δ leads at most κδ²/2 off the
//! tangent plane: the mismatch enters in quadrature, and both directions are bounded by
//! `√((D + κδ²/2)² + δ²)`, plus the rounding η of the patch.
//!
//! *Enclosure*: on [0, 1] a function with derivative in [a, b] differs from its chord by at most (b − a)/4, and a C¹
//! function with |second derivative| ≤ c by at most c/8. Derivatives come from interval jets; as Q and p nearly vanish,
//! so do their second derivatives, and the excess is cubic in the length of the piece. Pieces are halved until it is
//! small; the second bound is used where θ₁ stays in one span of the torse and of the patch.

use super::distance::{key, Feet};
use super::family::{Family, Plane};
use super::local::{Local, Place};
use super::prepared::{BoxNet, Patch, Prepared};
use super::ruled::RuledJets;
use super::vector::{add, cross, dot, exact, length, length_bound, sub, V3};
use crate::geom::Vec3;
use crate::num::bernstein::SplinePiece;
use crate::num::interval::Interval;
use crate::num::jet::Jet;
use crate::patchwork::panel::Coedge;
use crate::reason::LoopFault;
use crate::spline::curve::Curve;

/// Pieces are halved until their enclosures exceed their end values by less than this share of the tolerance, or count
/// less than pieces before.
const EXCESS: f64 = 1e-2;

/// Halvings of a side of the polyline at most.
const DEPTH: usize = 10;

/// Halvings before a piece whose ends seem too far away is given up: the enclosure of the foot function's slope over a
/// long piece makes them seem farther than they are.
const PATIENCE: usize = 5;
/// Parts of an interval of parameters where enclosures over all of it say too little.
const PARTS: usize = 8;
/// Factor that covers the rounding of a sum of a few positive terms, thousands of times over.
const ROUNDED_UP: f64 = 1.0 + 1e-12;

/// What keeps a boundary from being proven.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Obstacle {
    /// Place on the face.
    pub uv: [f64; 2],
    /// What it is.
    pub fault: LoopFault,
}

/// A panel's torse and patch, ready for its boundary.
pub(super) struct Boundary<'a> {
    pub family: &'a Family,
    pub jets: &'a RuledJets,
    pub prepared: &'a Prepared<'a>,
    /// mm.
    pub tolerance: f64,
}

/// A piece of a side: fractions of the side and parameters of the trimming curve at its ends.
#[derive(Clone, Copy)]
struct SidePart {
    f: (f64, f64),
    s: (f64, f64),
    depth: usize,
}

impl Boundary<'_> {
    /// Bounds the length of the paths over a run. `vertices` are the corner points of the face's partition.
    pub fn coedge_bound(&self, run: &Coedge, vertices: &[[f64; 2]]) -> Result<CoedgeBound, Obstacle> {
        let place = |i: usize| run.vertices.get(i).and_then(|&v| vertices.get(v as usize)).copied();
        let first = place(0).unwrap_or([f64::NAN; 2]);
        let refuse = |uv: [f64; 2], fault: LoopFault| Err(Obstacle { uv, fault });
        if !well_formed(run) {
            return refuse(first, LoopFault::Malformed);
        }
        let knots = run.trim.knots.breaks();
        let mut sides = Vec::with_capacity(run.vertices.len() - 1);
        let mut start = None;
        for k in 0..run.vertices.len() - 1 {
            let (Some(a), Some(b)) = (place(k), place(k + 1)) else {
                return refuse(first, LoopFault::NoVertex);
            };
            let Some(patch) = self.prepared.patch_of(&[a, b, b]) else {
                return refuse(a, LoopFault::KnotLine);
            };
            let (mut bound, mut curvature) = (0.0f64, 0.0f64);
            let (s0, s1) = (run.parameters[k], run.parameters[k + 1]);
            let mut cuts = vec![(0.0, s0)];
            cuts.extend(
                knots.iter().filter(|&&t| t > s0 && t < s1).map(|&t| (((t - s0) / (s1 - s0)).clamp(0.0, 1.0), t)),
            );
            cuts.push((1.0, s1));
            let mut open: Vec<SidePart> =
                cuts.windows(2).map(|w| SidePart { f: (w[0].0, w[1].0), s: (w[0].1, w[1].1), depth: 0 }).collect();
            while let Some(piece) = open.pop() {
                let at = |f: f64| {
                    // Rounded by a few ulps at most, which the enlarged boxes pay for.
                    [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])]
                };
                let (ga, gb) =
                    (if piece.f.0 > 0.0 { at(piece.f.0) } else { a }, if piece.f.1 < 1.0 { at(piece.f.1) } else { b });
                let found = self.piece_bound(patch, ga, gb, &run.trim, piece.s);
                if piece.depth >= PATIENCE && found.as_ref().is_some_and(|f| f.at_ends > self.tolerance) {
                    return refuse(ga, LoopFault::TooFar);
                }
                let good = found.as_ref().is_some_and(|f| f.bound <= bound.max(f.at_ends + EXCESS * self.tolerance));
                if !good && piece.depth < DEPTH {
                    let (f, s) = (0.5 * (piece.f.0 + piece.f.1), 0.5 * (piece.s.0 + piece.s.1));
                    let depth = piece.depth + 1;
                    if s > piece.s.0 && s < piece.s.1 {
                        open.push(SidePart { f: (piece.f.0, f), s: (piece.s.0, s), depth });
                        open.push(SidePart { f: (f, piece.f.1), s: (s, piece.s.1), depth });
                        continue;
                    }
                }
                let Some(found) = found else {
                    return refuse(ga, LoopFault::Strays);
                };
                if k == 0 && piece.f.0 <= 0.0 {
                    start = Some((a, found.roots));
                }
                bound = bound.max(found.bound);
                curvature = curvature.max(found.curvature);
            }
            sides.push(Side { ends: [a, b], bound, curvature });
        }
        start.map(|start| CoedgeBound { sides, start }).ok_or(Obstacle { uv: first, fault: LoopFault::Empty })
    }

    fn piece_bound(&self, patch: &Patch, ga: [f64; 2], gb: [f64; 2], trim: &Curve<2>, s: (f64, f64)) -> Option<Found> {
        let family = self.family;
        let theta = trim_piece(trim, s.0, s.1);
        let (t, r) = (Jet::of_bernstein(&theta[0]), Jet::of_bernstein(&theta[1]));
        let (t_lo, t_hi) = self.jets.domain();
        let (f_lo, f_hi) = family.domain();
        if t.v.lo < t_lo.max(f_lo) || t.v.hi > t_hi.min(f_hi) {
            return None;
        }

        // The surface over the side's box: X with derivatives along the side, and X at both ends.
        let BoxNet { net, corners } = patch.over(&[ga, gb, gb]);
        let base = sub(&exact::<Interval>(&patch.centre), &exact(&family.origin));
        let local = Local::new(&net, [0.5, 0.5]);
        let end = |y: &[Interval; 2]| -> V3<Interval> {
            let c = [y[0].mid().clamp(0.0, 1.0), y[1].mid().clamp(0.0, 1.0)];
            let place = Place::of(&net, c);
            // The corner may stick out of [0, 1] by a rounding error only; its width covers the clamping.
            let reach = |i: usize| y[i].rad() + (y[i].mid() - c[i]).abs();
            let off = place.error + local.norms[1] * reach(0) + local.norms[2] * reach(1);
            add(&base, &exact(&Vec3::from(place.z))).map(|c| c.widen(off * ROUNDED_UP))
        };
        let (xa, xb) = (end(&corners[0]), end(&corners[1]));
        let z = add(&base, &exact(&Vec3::from(local.z)));
        let along = [corners[1][0] - corners[0][0], corners[1][1] - corners[0][1]];
        let x: V3<Jet> = [0, 1, 2].map(|d: usize| {
            let mut axis = [Interval::ZERO; 3];
            axis[d] = Interval::ONE;
            let f = local.forms(&axis);
            Jet {
                v: z[d] + f.x,
                d: f.s1 * along[0] + f.s2 * along[1],
                dd: f.s11 * along[0].sqr() + f.s12 * along[0] * along[1] * 2.0 + f.s22 * along[1].sqr(),
            }
        });

        // Q and p at the ends, and how far they may stray from their chords in between.
        let clip = |t: Interval, lo: f64, hi: f64| t.intersect(Interval { lo, hi });
        let (mut q_ends, mut p_ends) = (0.0f64, 0.0f64);
        for (x, k) in [(&xa, 0), (&xb, theta[0].len() - 1)] {
            let here = family.over(clip(theta[0][k], f_lo, f_hi)?);
            let point = self.jets.at(clip(theta[0][k], t_lo, t_hi)?, theta[1][k]);
            q_ends = q_ends.max(here.foot(here.f(x), here.mu(x)).mag());
            p_ends = p_ends.max(dot(&Family::direction(&here), &sub(x, &point)).mag());
        }
        let (plane, rough_plane) = family.along_curve(t);
        let (point, rough_point) = self.jets.along_curve(t, r);
        let off = sub(&x, &point);
        let q_jet = plane.foot(plane.f(&x), plane.mu(&x));
        let p_jet = dot(&Family::direction(&plane), &off);
        let q = q_ends + q_jet.chord_deviation(rough_plane);
        let p = p_ends + p_jet.chord_deviation((Interval::point(rough_plane) + Interval::point(rough_point)).hi);
        let (t, x, w) = (t.v, x.map(|x| x.v), off.map(|x| x.v));
        let slope_e = slope_over(&family.over(t), &x);

        // The path: t between the foot and θ₁, X fixed.
        let (roots, slope_e) = self.foot_between(t, &x, q, slope_e)?;
        let way = self.way_over(roots, &x, q)?;
        let path = |q: f64, p: f64| {
            let across = Interval::point(q) / slope_e.abs() * way.speed;
            let straight = Interval::point(p) / way.ruling + Interval::point(self.skew()) * length(&w);
            ((across + straight) * Interval::point(1.0 + self.skew())).hi
        };
        let bound = path(q, p);
        bound.is_finite().then(|| Found { bound, at_ends: path(q_ends, p_ends), curvature: way.curvature, roots })
    }

    /// Bound of how much the local metric differs from that of space, by rounding of the frame only.
    fn skew(&self) -> f64 {
        (self.family.metric - 1.0) * 16.0
    }

    /// The torse along a path over an interval of parameters, at most at the foot function `q` from its foot; over parts of it
    /// where the enclosure over all says nothing.
    fn way_over(&self, t: Interval, x: &V3<Interval>, q: f64) -> Option<Way> {
        self.way_on(t, x, q).or_else(|| {
            let mut parts = parts(t).map(|t| self.way_on(t, x, q));
            let first = parts.next()??;
            parts.try_fold(first, |all, w| w.map(|w| all.with(&w)))
        })
    }

    fn way_on(&self, t: Interval, x: &V3<Interval>, q: f64) -> Option<Way> {
        let plane = self.family.over(t);
        let e_length = length(&Family::direction(&plane));
        let n_length = plane.nn.sqrt();
        let m_across = e_length / n_length;
        let gradient = plane.gradient();
        let g_length = n_length * e_length; // |M| = |n|² |m⊥| = |n| |e|
        let foot = Interval::symmetric(q);
        let skew = self.skew();
        let turn = dot(&plane.dm, &gradient).widen(skew * length_bound(&plane.dm) * length_bound(&gradient));
        let g = dot(&plane.dm, x) - plane.dk - plane.f(x) * plane.ndm / plane.nn - foot * turn / g_length.sqr();
        let q_across = Interval::point(q) / g_length;
        let speed = g.abs() / m_across + q_across * length(&cross(&plane.n, &plane.dm)) / e_length;
        // κ = |σ| |m⊥|² / (|n| |G|).
        let curvature = (plane.sigma.abs() * m_across.sqr() / (n_length * g.abs())).hi * (1.0 + skew);
        let finite = speed.hi.is_finite() && curvature.is_finite();
        finite.then_some(Way { speed, ruling: e_length, curvature })
    }

    /// An interval around `t` that provably holds a foot for every point of `x`, and E_t over it: with `|E| ≤ q` on t,
    /// E changes its sign within `q/|E_t|` of it, provided that this bounds E_t on the interval that it leads to.
    fn foot_between(&self, t: Interval, x: &V3<Interval>, q: f64, slope: Interval) -> Option<(Interval, Interval)> {
        // The first guess has the slope on t alone; a little more, for slopes that vary, closes the argument.
        const TRIES: usize = 4;
        const MORE: f64 = 1.125;
        let (lo, hi) = self.family.domain();
        let mut reach = (Interval::point(q) / slope.abs()).hi * MORE;
        for _ in 0..TRIES {
            let roots = t.widen(reach);
            if !(roots.lo >= lo && roots.hi <= hi) {
                return None;
            }
            let needed = |slope: &Interval| (Interval::point(q) / slope.abs()).hi;
            let whole = slope_over(&self.family.over(roots), x);
            if whole.sign() != 0 && needed(&whole) <= reach {
                return Some((roots, whole));
            }
            let parts = parts(roots).map(|t| slope_over(&self.family.over(t), x));
            let slope = parts.reduce(Interval::hull).filter(|s| s.sign() != 0)?;
            if needed(&slope) <= reach {
                return Some((roots, slope));
            }
            reach = needed(&slope) * MORE;
        }
        None
    }
}

/// The parts into which an interval of parameters is cut.
fn parts(t: Interval) -> impl Iterator<Item = Interval> {
    let cut = move |k: usize| match k {
        0 => t.lo,
        PARTS => t.hi,
        k => t.lo + (t.hi - t.lo) * (k as f64 / PARTS as f64),
    };
    (0..PARTS).map(move |k| Interval { lo: cut(k), hi: cut(k + 1) })
}

/// A torse along a path.
struct Way {
    /// Length of the path for a unit of the parameter, mm.
    speed: Interval,
    /// Length of the ruling's direction.
    ruling: Interval,
    /// Bound of the curvature, 1/mm.
    curvature: f64,
}

impl Way {
    fn with(self, other: &Self) -> Self {
        Self {
            speed: self.speed.hull(other.speed),
            ruling: self.ruling.hull(other.ruling),
            curvature: self.curvature.max(other.curvature),
        }
    }
}

/// What was shown about a side of the region's boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Side {
    /// Its ends on the face.
    pub ends: [[f64; 2]; 2],
    /// Bound of the paths' length, mm.
    pub bound: f64,
    /// Bound of the torse's curvature along the paths, 1/mm.
    pub curvature: f64,
}

/// What was shown about a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CoedgeBound {
    /// Its sides, in order.
    pub sides: Vec<Side>,
    /// First vertex, and an interval with exactly one foot of it, from which the paths start.
    pub start: ([f64; 2], Interval),
}

impl CoedgeBound {
    /// Whether the paths start at the feet proven inside the region: at one vertex is enough, by continuity.
    pub fn agrees_with(&self, feet: &Feet) -> bool {
        let (vertex, roots) = &self.start;
        feet.get(&key(vertex)).is_some_and(|&(lo, hi)| lo <= roots.hi && roots.lo <= hi)
    }
}

struct Found {
    bound: f64,
    at_ends: f64,
    curvature: f64,
    roots: Interval,
}

/// E_t over intervals of points and parameters.
fn slope_over(p: &Plane<Interval>, x: &V3<Interval>) -> Interval {
    p.foot_slope(p.f(x), p.mu(x), dot(&p.dm, x) - p.dk)
}

/// Whether a run has a clamped cubic trimming curve over [0, 1] and increasing parameters from 0 to 1.
pub(super) fn well_formed(run: &Coedge) -> bool {
    let n = run.vertices.len();
    let p = &run.parameters;
    let ends = |v: &[f64]| {
        v.first().is_some_and(|x| x.to_bits() == 0) && v.last().is_some_and(|x| x.to_bits() == 1.0f64.to_bits())
    };
    n >= 2 && p.len() == n && ends(p) && p.windows(2).all(|w| w[0] < w[1]) && clamped(&run.trim)
}

/// Whether a curve over [0, 1] starts and ends in its first and last control points.
pub(super) fn clamped<const D: usize>(c: &Curve<D>) -> bool {
    let (v, p) = (c.knots.values(), c.knots.degree());
    let n = v.len();
    n >= 2 * p + 2
        && v[..=p].iter().all(|x| x.to_bits() == 0)
        && v[n - 1 - p..].iter().all(|x| x.to_bits() == 1.0f64.to_bits())
}

/// Bernstein coefficients of the components of a curve over `[a, b]` inside one span.
pub(super) fn trim_piece<const D: usize>(trim: &Curve<D>, a: f64, b: f64) -> [Vec<Interval>; D] {
    let (p, v) = (trim.knots.degree(), trim.knots.values());
    let span = trim.knots.span(0.5 * (a + b));
    let piece = SplinePiece::new(p, &v[span + 1 - p..=span + p], a, b);
    std::array::from_fn(|d| {
        let net: Vec<Interval> = trim.control[span - p..=span].iter().map(|c| Interval::point(c[d])).collect();
        piece.coefficients(&net)
    })
}
