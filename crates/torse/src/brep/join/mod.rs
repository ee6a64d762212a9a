//! Neighbouring faces that go on smoothly become one face, so that panels can run across their common edges.
//!
//! *Method.* Faces whose regions have a whole side of their parameter box in common are joined two by two (`pair`), first
//! into chains, then chains into grids; every common side belongs to one of two families of lines, and a family is joined
//! completely before the other, in both orders; the order that leaves fewer faces wins. Knots and degrees are brought
//! together by blossoms \[R89\].
//!
//! Knows no tolerance of its own: what may be moved is asked for, and what was moved is said
//! ([`Face::joint_bound`]).

mod options;
mod pair;
mod turn;

use super::face::{Face, FacePart};
use super::raw::{SurfaceDeviation, SurfaceKind};
use super::trim::crease::creases;
use crate::geom::Vec3;
pub(crate) use options::JoinOptions;
use std::collections::HashSet;

/// Whether a joined face (first) is better than its two parts.
pub(crate) type Worthwhile<'a> = &'a (dyn Fn(&Face, &Face, &Face) -> bool + Sync);

/// Places in each direction at which the normals of a face are looked at for its turn.
const TURN_SAMPLES: usize = 16;
/// Share of the parameter range within which corners of a trim count as lying on the side of its box: readers'
/// projections are about that exact.
const ON_SIDE: f64 = 1e-8;

/// Joins faces where their surfaces go on smoothly across a common edge.
///
/// *Input*: faces of one model. Two of them are joined if a side of the box around the outer loop of each, followed by
/// the loop over its whole length, is the same curve after changes of degree, knots and direction. *Guarantee*: every
/// point of the answer is within [`Face::joint_bound`] of the point of its part, at most `mismatch` for each joint; holes
/// and the rest of the borders stay. A joined face lists its parts and looks where its first part looks. *Not
/// guaranteed*: the angle is measured at eight places of every span of the edge; edges that are a part of a side, or
/// run differently in the parameter, are not joined. A ring of faces stays open at one edge.
///
/// Faces of different bodies or parts are never joined. Faces with creases of their own, sharper than the angle, take no part. Two faces that fit are joined if `worthwhile`
/// says so. Faces that are not joined are handed back unchanged; order is that of the first parts.
pub fn joined(faces: Vec<Face>, options: &JoinOptions, worthwhile: Worthwhile) -> Vec<Face> {
    if !(options.angle > 0.0 && options.mismatch > 0.0) || faces.len() < 2 {
        return faces;
    }
    let smooth = |f: &Face| {
        let ((u0, u1), (v0, v1)) = f.surface.domain();
        creases(&f.surface, [u0, u1, v0, v1], options.angle).is_empty()
    };
    let boxed: Vec<Option<Face>> = faces.iter().map(|f| boxed(f).filter(smooth)).collect();
    let matches = matches(&boxed, options);
    if matches.is_empty() {
        return faces;
    }
    let families = families(faces.len(), &matches);
    let attempt = |first: bool| grouped(&boxed, &matches, &families, first, options, worthwhile);
    let mut groups = attempt(false);
    if groups.len() > 1 {
        let other = attempt(true);
        if other.len() < groups.len() {
            groups = other;
        }
    }
    groups.into_iter().map(|g| named(g, &faces)).collect()
}

/// Several faces as one.
struct Group {
    /// Indices of the faces, the first one giving the direction of the normal.
    members: Vec<usize>,
    /// The face; `None` if it takes no part in joining.
    face: Option<Face>,
    /// Family of lines that u crosses at the joints: see [`families`].
    family: bool,
}

/// A side that two faces have in common.
struct Match {
    faces: [usize; 2],
    sides: [usize; 2],
}

/// The face with its surface cut off at the box around the outer loop, whose sides the loop meets exactly.
fn boxed(face: &Face) -> Option<Face> {
    let outer = face.loops.first()?;
    let mut out = face.clone();
    let domain = [face.surface.knots_u.domain(), face.surface.knots_v.domain()];
    let mut sides = [(0.0, 0.0); 2];
    for d in 0..2 {
        let along = || outer.points.iter().map(|p| p[d]);
        let (lo, hi) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        let hair = ON_SIDE * (hi - lo);
        let snap = |x: f64, end: f64| if (x - end).abs() <= hair { end } else { x };
        sides[d] = (snap(lo, domain[d].0), snap(hi, domain[d].1));
        for p in out.loops.iter_mut().flat_map(|l| &mut l.points) {
            p[d] = snap(snap(p[d], sides[d].0), sides[d].1) + 0.0;
        }
    }
    // Restriction clamps; it is left out where there is nothing to cut.
    let clamped = [&face.surface.knots_u, &face.surface.knots_v].iter().all(|k| {
        let (v, p, n) = (k.values(), k.degree(), k.control_count());
        v[0] >= v[p] && v[n + p] <= v[n]
    });
    if !clamped || sides != domain {
        out.surface = face.surface.restricted(sides[0], sides[1]).ok()?;
    }
    // Edges that the snapping made empty.
    for l in &mut out.loops {
        let n = l.points.len();
        let keep: Vec<bool> = (0..n).map(|k| l.points[k] != l.points[(k + 1) % n]).collect();
        let mut k = 0..n;
        l.points.retain(|_| k.next().is_some_and(|k| keep[k]));
        let mut k = 0..n;
        l.edge.retain(|_| k.next().is_some_and(|k| keep[k]));
    }
    out.loops.iter().all(|l| l.points.len() >= 3).then_some(out)
}

/// All common sides of single faces that can be joined.
fn matches(faces: &[Option<Face>], options: &JoinOptions) -> Vec<Match> {
    // Sides with a common curve have a common middle of their ends; a sweep along x finds them.
    let mut sides: Vec<(f64, usize, usize, [Vec3; 2])> = Vec::new();
    for (i, f) in faces.iter().enumerate() {
        for s in 0..4 {
            if let Some(f) = f {
                let ends = pair::ends(&f.surface, s);
                sides.push((0.5 * (ends[0].x + ends[1].x), i, s, ends));
            }
        }
    }
    sides.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out = Vec::new();
    for (k, (x, i, s, p)) in sides.iter().enumerate() {
        for (_, j, t, q) in sides[k + 1..].iter().take_while(|o| o.0 - x <= options.mismatch) {
            let (Some(a), Some(b)) = (&faces[*i], &faces[*j]) else { continue };
            if i != j && (a.body, &a.part) == (b.body, &b.part) && fits((a, *s, p), (b, *t, q), options).is_some() {
                out.push(Match { faces: [*i, *j], sides: [*s, *t] });
            }
        }
    }
    out.sort_by_key(|m| (m.faces[0].min(m.faces[1]), m.faces[0].max(m.faces[1]), m.sides));
    out
}

/// A face, the number of one of its sides, and that side's ends, mm.
type EndedSide<'a> = (&'a Face, usize, &'a [Vec3; 2]);

/// Two faces joined at given sides with given ends, in one direction or the other.
fn fits((a, s, p): EndedSide, (b, t, q): EndedSide, options: &JoinOptions) -> Option<Face> {
    let near = |x: &Vec3, y: &Vec3| (x - y).norm() <= options.mismatch;
    let same = near(&p[0], &q[0]) && near(&p[1], &q[1]);
    let opposite = near(&p[0], &q[1]) && near(&p[1], &q[0]);
    let forward = same.then(|| pair::joined(a, s, b, t, false, options)).flatten();
    forward.or_else(|| opposite.then(|| pair::joined(a, s, b, t, true, options)).flatten())
}

/// For each face whether its lines of constant u belong to the second of two families of lines that run on
/// through common sides; where a model has no two such families, something near it.
fn families(count: usize, matches: &[Match]) -> Vec<bool> {
    let mut family = vec![None; count];
    for start in 0..count {
        if family[start].is_some() {
            continue;
        }
        family[start] = Some(false);
        let mut front = vec![start];
        while let Some(i) = front.pop() {
            for m in matches {
                let Some(k) = m.faces.iter().position(|&f| f == i) else { continue };
                let (j, turned) = (m.faces[1 - k], m.sides[k] / 2 != m.sides[1 - k] / 2);
                if family[j].is_none() {
                    family[j] = family[i].map(|f| f != turned);
                    front.push(j);
                }
            }
        }
    }
    family.into_iter().map(|f| f == Some(true)).collect()
}

/// Joins what fits: all joints of one family, all of the other, then whatever is left.
fn grouped(
    faces: &[Option<Face>],
    matches: &[Match],
    families: &[bool],
    first: bool,
    options: &JoinOptions,
    worthwhile: Worthwhile,
) -> Vec<Group> {
    let mut groups: Vec<Option<Group>> = faces
        .iter()
        .enumerate()
        .map(|(i, f)| Some(Group { members: vec![i], face: f.clone(), family: families[i] }))
        .collect();
    let mut owner: Vec<usize> = (0..faces.len()).collect();
    let mut failed: HashSet<(usize, usize, Option<bool>)> = HashSet::new();
    for pass in [Some(first), Some(!first), None] {
        let mut changed = true;
        while changed {
            changed = false;
            for m in matches {
                let (i, j) = (owner[m.faces[0]], owner[m.faces[1]]);
                let (i, j) = (i.min(j), i.max(j));
                if i == j || failed.contains(&(i, j, pass)) {
                    continue;
                }
                let (Some(a), Some(b)) = (&groups[i], &groups[j]) else { continue };
                let Some(next) = together(a, b, pass, options, worthwhile) else {
                    failed.insert((i, j, pass));
                    continue;
                };
                for &k in &next.members {
                    owner[k] = groups.len();
                }
                groups[i] = None;
                groups[j] = None;
                groups.push(Some(next));
                changed = true;
            }
        }
    }
    let mut left: Vec<Group> = groups.into_iter().flatten().collect();
    left.sort_by_key(|g| g.members.iter().copied().min());
    left
}

/// Two groups as one, joined across lines of the family `pass` (`None`: either).
fn together(a: &Group, b: &Group, pass: Option<bool>, options: &JoinOptions, worthwhile: Worthwhile) -> Option<Group> {
    let (f, g) = (a.face.as_ref()?, b.face.as_ref()?);
    // The face that gives the direction of the normal is the first of the file.
    let (a, f, b, g) = if a.members[0] < b.members[0] { (a, f, b, g) } else { (b, g, a, f) };
    for s in 0..4 {
        let family = a.family != (s >= 2);
        if pass.is_some_and(|p| p != family) {
            continue;
        }
        let p = pair::ends(&f.surface, s);
        for t in 0..4 {
            let q = pair::ends(&g.surface, t);
            if let Some(face) = fits((f, s, &p), (g, t, &q), options) {
                if turn(&face) > options.turn || !worthwhile(&face, f, g) {
                    continue;
                }
                let members = a.members.iter().chain(&b.members).copied().collect();
                return Some(Group { members, face: Some(face), family });
            }
        }
    }
    None
}

/// Largest angle (rad) that the normal turns through along a line of constant u or v, estimated at samples.
fn turn(face: &Face) -> f64 {
    let ((u0, u1), (v0, v1)) = face.surface.domain();
    let share = |k: usize| (k as f64 + 0.5) / TURN_SAMPLES as f64;
    let normal = |s: f64, t: f64| {
        let n = face.surface.jet(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t).normal();
        n.try_normalize(f64::MIN_POSITIVE)
    };
    let along = |at: &dyn Fn(usize) -> Option<Vec3>| {
        let normals: Vec<Vec3> = (0..TURN_SAMPLES).filter_map(at).collect();
        normals.windows(2).map(|w| w[0].cross(&w[1]).norm().atan2(w[0].dot(&w[1]))).sum::<f64>()
    };
    let lines = |k: usize| {
        let (over_v, over_u) = (along(&|i| normal(share(k), share(i))), along(&|i| normal(share(i), share(k))));
        over_v.max(over_u)
    };
    (0..TURN_SAMPLES).map(lines).fold(0.0, f64::max)
}

/// The face of a group, with the names of its parts.
fn named(group: Group, faces: &[Face]) -> Face {
    let (Some(mut face), false) = (group.face, group.members.len() == 1) else {
        return faces[group.members[0]].clone();
    };
    let mut members = group.members;
    members.sort_unstable();
    let first = &faces[members[0]];
    (face.entity, face.part) = (first.entity, first.part.clone());
    // Copies of one face in an assembly are told apart by their order.
    let part = |f: &Face| FacePart { entity: f.entity, name: f.name.clone() };
    let parts = |f: &Face| if f.parts.is_empty() { vec![part(f)] } else { f.parts.clone() };
    face.parts = members.iter().flat_map(|&k| parts(&faces[k])).collect();
    let title = |p: &FacePart| if p.name.is_empty() { format!("#{}", p.entity) } else { p.name.clone() };
    face.name = face.parts.iter().map(title).collect::<Vec<_>>().join(" + ");
    if members.iter().any(|&k| faces[k].kind != first.kind) {
        face.kind = SurfaceKind::Spline;
    }
    let worst = |of: &dyn Fn(&Face) -> f64| members.iter().map(|&k| of(&faces[k])).fold(0.0, f64::max);
    face.trim_deviation_estimate = worst(&|f| f.trim_deviation_estimate);
    face.surface_deviation =
        members.iter().map(|&k| faces[k].surface_deviation).fold(SurfaceDeviation::NONE, SurfaceDeviation::max);
    // Joining begins with the polygons: what these miss of the file stays, edges go with the faces of the file.
    face.set_trim_bound(worst(&|f| f.trim_bound()));
    face.boundary = None;
    face
}

#[cfg(test)]
mod tests;
