//! Edges that close: vertices and edges that are one in space are made one, as the format wants them.

use super::trims::{domain, edge_trim, parameter_line, WEST};
use crate::geom::Vec3;
use crate::io::step::write::{EdgeUse, Shell, ShellCurve, ShellEdge, ShellSurface};
use std::collections::{BTreeMap, BTreeSet};
use std::io;

/// Coordinates nearer than this (mm), or than this share of their sizes, are one for the program, which wants closed edges
/// to begin and end in one vertex.
const SAME_PLACE: f64 = 2.3e-10;
const SAME_SHARE: f64 = 2.2e-13;
/// Edges on opposite sides of a surface that are nearer than this (mm) are one seam: the least tolerance with which edges
/// are written.
const SEAM_GAP: f64 = 1e-6;

/// The shell with one vertex where closed edges begin and end.
pub(super) fn closed(s: &Shell) -> Shell {
    let mut same = alias(s);
    for e in &s.edges {
        let (Some(p), Some(q)) = (s.vertices.get(e.start), s.vertices.get(e.end)) else { continue };
        let near = |k: usize| (p[k] - q[k]).abs() <= SAME_PLACE.max(SAME_SHARE * (p[k].abs() + q[k].abs()));
        if e.start != e.end && (0..3).all(near) {
            merge(&mut same, e.start, e.end);
        }
    }
    compact(s.clone(), &same)
}

/// The vertices of edges, each for itself.
fn alias(s: &Shell) -> BTreeMap<usize, usize> {
    s.edges.iter().flat_map(|e| [(e.start, e.start), (e.end, e.end)]).collect()
}

/// Makes two vertices one.
fn merge(same: &mut BTreeMap<usize, usize>, a: usize, b: usize) {
    let (a, b) = (same[&a], same[&b]);
    same.values_mut().filter(|v| **v == a.max(b)).for_each(|v| *v = a.min(b));
}

/// The shell with the vertices that its edges have, under the numbers of those that are the same.
fn compact(mut s: Shell, same: &BTreeMap<usize, usize>) -> Shell {
    let used: BTreeSet<usize> = s.edges.iter().flat_map(|e| [same[&e.start], same[&e.end]]).collect();
    let number: BTreeMap<usize, usize> = used.iter().enumerate().map(|(new, &old)| (old, new)).collect();
    // Numbers that are out of range stay so, and are an error of the writer's.
    let all = used.iter().filter_map(|&v| s.vertices.get(v).copied()).collect();
    for v in s.edges.iter_mut().flat_map(|e| [&mut e.start, &mut e.end]) {
        *v = number[&same[v]];
    }
    s.vertices = all;
    s
}

/// The shell with one edge wherever a face closes: what lay on both sides of its surface's domain is used twice. Sides whose
/// other edges end apart for the program stay two, as these could then not be closed.
///
/// # Errors
/// Those of the curves in the parameter plane.
pub(super) fn joined(s: &Shell) -> io::Result<Shell> {
    let (mut out, mut same_vertex) = (s.clone(), alias(s));
    let mut count: BTreeMap<usize, usize> = BTreeMap::new();
    s.faces.iter().flat_map(|f| f.loops.iter().flatten()).for_each(|u| *count.entry(u.edge).or_default() += 1);
    let mut lost = BTreeSet::new();
    for (k, f) in s.faces.iter().enumerate().filter(|(_, f)| matches!(f.surface, ShellSurface::Spline { .. })) {
        let ends = domain(s, f)?;
        let mut sides = Vec::new();
        for (l, i, u) in f.loops.iter().enumerate().flat_map(|(l, x)| x.iter().enumerate().map(move |(i, u)| (l, i, u)))
        {
            if count.get(&u.edge) != Some(&1) {
                continue;
            }
            let curve = edge_trim(s, f, u)?;
            let side = parameter_line(&ends, &curve);
            if side >= WEST {
                sides.push((side, l, i, curve));
            }
        }
        for (side, l, i, _) in sides.iter().filter(|x| x.0 < WEST + 2) {
            let keep = f.loops[*l][*i].edge;
            let pair = sides.iter().find(|x| {
                let edge = f.loops[x.1][x.2].edge;
                x.0 == side + 2
                    && !lost.contains(&edge)
                    && direction(s, keep, edge).is_some_and(|d| !opens(s, keep, edge, d))
            });
            let Some((_, l, i, curve)) = pair else { continue };
            let was = &f.loops[*l][*i];
            let Some(same) = direction(s, keep, was.edge) else { continue };
            lost.insert(was.edge);
            for [a, b] in ends_of(s, keep, was.edge, same) {
                merge(&mut same_vertex, a, b);
            }
            let trim = Some(if same { curve.clone() } else { curve.reversed() });
            out.faces[k].loops[*l][*i] = EdgeUse { edge: keep, forward: was.forward == same, trim };
        }
    }
    Ok(compact(without(out, &lost), &same_vertex))
}

/// The vertices of two edges that become one; `same` says that these run the same way.
fn ends_of(s: &Shell, a: usize, b: usize, same: bool) -> [[usize; 2]; 2] {
    let (a, b) = (&s.edges[a], &s.edges[b]);
    let [start, end] = if same { [b.start, b.end] } else { [b.end, b.start] };
    [[a.start, start], [a.end, end]]
}

/// Whether an edge whose ends are apart for the program would begin and end in one vertex.
fn opens(s: &Shell, a: usize, b: usize, same: bool) -> bool {
    let pairs = ends_of(s, a, b, same);
    s.edges.iter().any(|e| e.start != e.end && pairs.iter().any(|p| *p == [e.start, e.end] || *p == [e.end, e.start]))
}

/// Whether two edges are one in space, and if so, whether they run the same way.
fn direction(s: &Shell, a: usize, b: usize) -> Option<bool> {
    let [a, b] = [a, b].map(|e| s.edges.get(e));
    let (a, b) = (a?, b?);
    let is = |turned: bool| {
        [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().all(|t| {
            let other = point(s, b, if turned { 1.0 - t } else { t });
            point(s, a, t).zip(other).is_some_and(|(p, q)| (p - q).norm() <= SEAM_GAP)
        })
    };
    [false, true].into_iter().find(|&turned| is(turned)).map(|turned| !turned)
}

/// The point of an edge at a share of its parameters.
fn point(s: &Shell, e: &ShellEdge, t: f64) -> Option<Vec3> {
    let at = |(a, b): (f64, f64)| a + t * (b - a);
    match &e.curve {
        ShellCurve::Line => Some(s.vertices.get(e.start)?.lerp(s.vertices.get(e.end)?, t)),
        ShellCurve::Spline(c) => Some(Vec3::from(c.point(at(c.domain())))),
        ShellCurve::Rational(c) => {
            let h = c.point(at(c.domain()));
            Some(Vec3::new(h[0], h[1], h[2]) / h[3])
        }
        ShellCurve::Circle { .. } => None,
    }
}

/// The shell without some of its edges, which nothing uses.
fn without(mut s: Shell, lost: &BTreeSet<usize>) -> Shell {
    let number = |e: usize| e - lost.range(..e).count();
    for u in s.faces.iter_mut().flat_map(|f| f.loops.iter_mut().flatten()) {
        u.edge = number(u.edge);
    }
    let kept = std::mem::take(&mut s.edges).into_iter().enumerate().filter(|(e, _)| !lost.contains(e));
    s.edges = kept.map(|(_, e)| e).collect();
    s
}
