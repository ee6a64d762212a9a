//! Two faces with a common side become one.
//!
//! *Method.* Both are turned until the common side is the end of the first in u and the beginning of the second;
//! brought to one degree and one knot vector along it by blossoms \[R89\]; the second then starts with the control
//! points that the first ends with, and u goes on over a knot of full multiplicity. Knots of full multiplicity along
//! the side may be moved without changing the surface: so sides fit that are chains themselves, each with a pace of its
//! own.

use super::options::JoinOptions;
use super::turn::{reversed_u, reversed_v, transposed};
use crate::brep::face::{Face, TrimLoop};
use crate::geom::Vec3;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

/// Knots of both sides count as one within this share of their range: some roundings of an affine map.
const SAME_KNOT: f64 = 64.0 * f64::EPSILON;
/// Different knots nearer than this share of the range are not joined: cells between them would be slivers.
const NEAR_KNOT: f64 = 1e-6;
/// Share of the surface's size that blossoms may move control points by rounding: a few hundred operations.
const ROUNDING: f64 = 4096.0 * f64::EPSILON;
/// Places in each span along the side where normals and speeds are compared.
const SAMPLES: usize = 8;
/// Greatest ratio by which the second face's pace in u is changed.
const MOST_STRETCH: f64 = 1e3;
/// Parametrisations whose normal is shorter than this share of the product of the speeds count as collapsed.
const COLLAPSED: f64 = 1e-7;
/// Sides shorter than this multiple of the greatest mismatch are points.
const POINT: f64 = 10.0;

/// Ends of side `s` (0: u = u0, 1: u = u1, 2: v = v0, 3: v = v1), towards the growing parameter.
pub(super) fn ends(surface: &Surface, side: usize) -> [Vec3; 2] {
    let ((u0, u1), (v0, v1)) = surface.domain();
    match side {
        0 => [surface.point(u0, v0), surface.point(u0, v1)],
        1 => [surface.point(u1, v0), surface.point(u1, v1)],
        2 => [surface.point(u0, v0), surface.point(u1, v0)],
        _ => [surface.point(u0, v1), surface.point(u1, v1)],
    }
}

/// The faces as one, joined along side `s` of the first and `t` of the second (`backwards`: run in opposite directions);
/// u runs across the joint. `None` where they do not fit.
pub(super) fn joined(a: &Face, s: usize, b: &Face, t: usize, backwards: bool, options: &JoinOptions) -> Option<Face> {
    let along_u = |f: &Face, side: usize| if side >= 2 { transposed(f) } else { f.clone() };
    let (mut a, mut b) = (along_u(a, s), along_u(b, t));
    if s.is_multiple_of(2) {
        a = reversed_u(&a);
    }
    if !t.is_multiple_of(2) {
        b = reversed_u(&b);
    }
    if backwards {
        b = reversed_v(&b);
    }
    // One degree.
    let degrees = |f: &Face| [f.surface.knots_u.degree(), f.surface.knots_v.degree()];
    let (of_a, of_b) = (degrees(&a), degrees(&b));
    a.surface = a.surface.elevated_to(of_b).ok()?;
    b.surface = b.surface.elevated_to(of_a).ok()?;
    // One knot vector along the side.
    let pace = pace(&a.surface, &b.surface, options.mismatch)?;
    let range = a.surface.knots_v.domain();
    let scale = range.0.abs().max(range.1.abs()).max(range.1 - range.0);
    let kept: Vec<f64> = a.surface.knots_v.breaks();
    let moved = |v: f64| {
        let x = pace.at(v);
        kept.iter().copied().find(|k| (k - x).abs() <= SAME_KNOT * scale).unwrap_or(x)
    };
    b.surface.knots_v = mapped(&b.surface.knots_v, &moved)?;
    b.loops = b.loops.iter().map(|l| pace.applied(l, &moved)).collect();
    let more_of = |x: &Knots, y: &Knots| -> Vec<f64> {
        let own = x.distinct();
        let count = |value: f64| own.iter().find(|k| k.0.total_cmp(&value).is_eq()).map_or(0, |k| k.1);
        let (lo, hi) = y.domain();
        let inner = y.distinct().into_iter().filter(|k| k.0 > lo && k.0 < hi);
        inner.flat_map(|(value, m)| std::iter::repeat_n(value, m.saturating_sub(count(value)))).collect()
    };
    let (to_a, to_b) =
        (more_of(&a.surface.knots_v, &b.surface.knots_v), more_of(&b.surface.knots_v, &a.surface.knots_v));
    let width = range.1 - range.0;
    if to_a.iter().any(|x| kept.iter().any(|k| k != x && (k - x).abs() <= NEAR_KNOT * width)) {
        return None;
    }
    let size = a.surface.bbox().diagonal() + b.surface.bbox().diagonal();
    if !to_a.is_empty() {
        a.surface = a.surface.with_knots(&[], &to_a).ok()?;
    }
    if !to_b.is_empty() {
        b.surface = b.surface.with_knots(&[], &to_b).ok()?;
    }
    // Smooth, at one speed across.
    let (angle, stretch) = across(&a.surface, &b.surface)?;
    if angle > options.angle {
        return None;
    }
    let start = b.surface.knots_u.domain().0;
    let end = a.surface.knots_u.domain().1;
    let moved = |u: f64| end + (u - start) * stretch;
    b.surface.knots_u = mapped(&b.surface.knots_u, &moved)?;
    for p in b.loops.iter_mut().flat_map(|l| &mut l.points) {
        p[0] = moved(p[0]);
    }
    // One surface.
    let bound = impose_common_end(&a.surface, &mut b.surface)?;
    if bound > options.mismatch {
        return None;
    }
    let surface = glued(&a.surface, &b.surface)?;
    let loops = merged(&a, &b)?;
    let bound = bound + ROUNDING * size;
    let moved = (a.joint_bound() + ROUNDING * size).max(b.joint_bound() + bound);
    let mut out = Face { surface, loops, ..a };
    out.set_joint_bound(moved);
    Some(out)
}

/// Knots under an increasing map.
fn mapped(knots: &Knots, map: &dyn Fn(f64) -> f64) -> Option<Knots> {
    let values = knots.values().iter().map(|&x| map(x)).collect();
    Knots::new(knots.degree(), values, knots.control_count()).ok()
}

/// A piecewise affine map from the second side's parameter to the first's.
struct Pace {
    /// `(from, to)` at the bends and the ends.
    nodes: Vec<[f64; 2]>,
}

impl Pace {
    fn at(&self, x: f64) -> f64 {
        let n = self.nodes.len();
        let k = self.nodes.iter().position(|q| x <= q[0]).unwrap_or(n - 1).max(1);
        let ([a, fa], [b, fb]) = (self.nodes[k - 1], self.nodes[k]);
        if x <= a {
            fa
        } else if x >= b {
            fb
        } else {
            fa + (fb - fa) * ((x - a) / (b - a))
        }
    }

    /// The loop after the map: `map` is this one, apart from rounding. Sides that cross a bend get a corner there.
    fn applied(&self, l: &TrimLoop, map: &dyn Fn(f64) -> f64) -> TrimLoop {
        let bends = &self.nodes[1..self.nodes.len() - 1];
        let mut out = TrimLoop { points: Vec::new(), edge: Vec::new() };
        for (k, p) in l.points.iter().enumerate() {
            let q = l.points[(k + 1) % l.points.len()];
            let mut stops: Vec<f64> = bends.iter().map(|b| (b[0] - p[1]) / (q[1] - p[1])).collect();
            stops.retain(|s| *s > 0.0 && *s < 1.0);
            stops.sort_by(f64::total_cmp);
            out.points.push([p[0], map(p[1])]);
            out.edge.push(l.edge[k]);
            for s in stops {
                out.points.push([p[0] + s * (q[0] - p[0]), map(p[1] + s * (q[1] - p[1]))]);
                out.edge.push(l.edge[k]);
            }
        }
        out
    }
}

/// The map of the second side's parameter that brings corners of both, knots of full multiplicity at one place, together.
fn pace(a: &Surface, b: &Surface, near: f64) -> Option<Pace> {
    let (ua, ub) = (a.knots_u.domain().1, b.knots_u.domain().0);
    let (from, to) = (b.knots_v.domain(), a.knots_v.domain());
    let inner = |k: &Knots| -> Vec<f64> {
        let (lo, hi) = k.domain();
        k.distinct().into_iter().filter(|x| x.0 > lo && x.0 < hi && x.1 == k.degree()).map(|x| x.0).collect()
    };
    let mut nodes = vec![[from.0, to.0]];
    let bends = inner(&a.knots_v);
    for x in inner(&b.knots_v) {
        let p = b.point(ub, x);
        let last = nodes.last().map_or(to.0, |n| n[1]);
        if let Some(&y) = bends.iter().find(|&&y| y > last && (a.point(ua, y) - p).norm() <= near) {
            nodes.push([x, y]);
        }
    }
    nodes.push([from.1, to.1]);
    let straight = |x: f64| to.0 + (to.1 - to.0) * ((x - from.0) / (from.1 - from.0));
    if nodes.iter().all(|n| (straight(n[0]) - n[1]).abs() <= SAME_KNOT * (to.1 - to.0)) {
        nodes.drain(1..nodes.len() - 1);
    }
    let ok = nodes.windows(2).all(|w| w[0][0] < w[1][0] && w[0][1] < w[1][1]);
    // A side without length is a pole, not an edge.
    let chords = |k: usize| a.point(ua, to.0 + (to.1 - to.0) * k as f64 / SAMPLES as f64);
    let length: f64 = (0..SAMPLES).map(|k| (chords(k + 1) - chords(k)).norm()).sum();
    (ok && length > POINT * near).then_some(Pace { nodes })
}

/// Largest angle (rad) between the normals of both at the common side, at samples, and the stretch of the second's u
/// that makes the mean speeds across equal.
fn across(a: &Surface, b: &Surface) -> Option<(f64, f64)> {
    let (ua, ub) = (a.knots_u.domain().1, b.knots_u.domain().0);
    let (mut angle, mut met) = (0.0f64, 0usize);
    let (mut before, mut after) = (0.0, 0.0);
    for w in a.knots_v.breaks().windows(2) {
        for k in 0..SAMPLES {
            let v = w[0] + (w[1] - w[0]) * (k as f64 + 0.5) / SAMPLES as f64;
            let (i, j) = (a.jet(ua, v), b.jet(ub, v));
            before += i.du.norm() * (w[1] - w[0]);
            after += j.du.norm() * (w[1] - w[0]);
            let (m, n) = (i.normal(), j.normal());
            let flat = |n: &Vec3, size: f64| n.norm() <= COLLAPSED * size || size <= 0.0;
            if flat(&m, i.du.norm() * i.dv.norm()) || flat(&n, j.du.norm() * j.dv.norm()) {
                continue;
            }
            met += 1;
            angle = angle.max(m.cross(&n).norm().atan2(m.dot(&n)));
        }
    }
    let stretch = after / before;
    (met > 0 && stretch.is_finite() && stretch > 0.0)
        .then_some((angle, stretch.clamp(1.0 / MOST_STRETCH, MOST_STRETCH)))
}

/// Gives the second surface the end of the first as its beginning. Answers a bound on how far any of its points moves.
///
/// With `Σ N w b` before, `Σ N w' a` after, a point S before moves by
/// `|Σ N (w'(a − b) + (w' − w)(b − S))| / Σ N w'`, and b − S is no longer than the net is wide.
fn impose_common_end(a: &Surface, b: &mut Surface) -> Option<f64> {
    let (row, last) = (a.row(), a.knots_u.control_count() - 1);
    if b.row() != row || a.knots_v != b.knots_v {
        return None;
    }
    let factor = a.control[last * row][3] / b.control[0][3];
    for c in &mut b.control {
        for x in c.iter_mut() {
            *x *= factor;
        }
    }
    let width = b.bbox().diagonal();
    let mut worst: f64 = 0.0;
    for (new, old) in a.control[last * row..].iter().zip(&mut b.control) {
        let (p, q) = (Vec3::new(new[0], new[1], new[2]) / new[3], Vec3::new(old[0], old[1], old[2]) / old[3]);
        worst = worst.max(new[3] * (p - q).norm() + (new[3] - old[3]).abs() * width);
        *old = *new;
    }
    let least = b.control.iter().map(|c| c[3]).fold(f64::INFINITY, f64::min);
    (least > 0.0).then(|| worst / least)
}

/// Both surfaces as one over a knot of full multiplicity: the second begins where the first ends, in knots and control
/// points.
fn glued(a: &Surface, b: &Surface) -> Option<Surface> {
    let p = a.knots_u.degree();
    let first = a.knots_u.values();
    let mut values = first[..first.len() - 1].to_vec();
    values.extend_from_slice(&b.knots_u.values()[p + 1..]);
    let count = a.knots_u.control_count() + b.knots_u.control_count() - 1;
    let mut control = a.control.clone();
    control.extend_from_slice(&b.control[a.row()..]);
    let knots_u = Knots::new(p, values, count).ok()?;
    let rational = control.iter().any(|c| c[3] != 1.0);
    Some(Surface { knots_u, knots_v: a.knots_v.clone(), control, rational })
}

/// The loops of both faces without the common side; edges of the second are numbered after those of the first.
fn merged(a: &Face, b: &Face) -> Option<Vec<TrimLoop>> {
    let end = a.surface.knots_u.domain().1;
    let (v0, v1) = a.surface.knots_v.domain();
    let (outer_a, outer_b) = (a.loops.first()?, b.loops.first()?);
    let (mut points, mut edge) = open_at(outer_a, end, v1, v0)?;
    let (more, more_edges) = open_at(outer_b, end, v0, v1)?;
    let shift = a.loops.iter().flat_map(|l| &l.edge).max().map_or(0, |e| e + 1);
    points.extend_from_slice(&more[1..more.len() - 1]);
    edge.extend(more_edges.iter().map(|e| e + shift));
    let mut loops = vec![TrimLoop { points, edge }];
    loops.extend_from_slice(&a.loops[1..]);
    loops.extend(
        b.loops[1..]
            .iter()
            .map(|l| TrimLoop { points: l.points.clone(), edge: l.edge.iter().map(|e| e + shift).collect() }),
    );
    Some(loops)
}

/// The loop from corner `(u, from)` to corner `(u, to)`, both included, if what it leaves out is the whole side between
/// them; and the edges of its sides.
fn open_at(l: &TrimLoop, u: f64, from: f64, to: f64) -> Option<(Vec<[f64; 2]>, Vec<u32>)> {
    let n = l.points.len();
    let at = |v: f64| l.points.iter().position(|p| *p == [u, v]);
    let (i, j) = (at(from)?, at(to)?);
    let count = (j + n - i) % n;
    let left_out = (0..(i + n - j) % n).all(|k| l.points[(j + k) % n][0] == u);
    let kept: Vec<[f64; 2]> = (0..=count).map(|k| l.points[(i + k) % n]).collect();
    let across = kept.iter().any(|p| p[0] != u);
    (left_out && across).then(|| (kept, (0..count).map(|k| l.edge[(i + k) % n]).collect()))
}
