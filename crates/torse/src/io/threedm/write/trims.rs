//! The trims of a shell: its edges in the parameter planes of its surfaces.

use crate::geom::{Frame, Vec3};
use crate::io::step::write::{EdgeUse, Shell, ShellCurve, ShellFace, ShellSurface};
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use std::io;

/// Kinds of trims.
const BOUNDARY: i32 = 1;
const SINGULAR: i32 = 4;
/// Ends in the parameter plane that are farther apart than this share of the domain are joined by a side that is a point.
const APART: f64 = 1e-9;
/// Margin of a plane around its edges, as a share of their extent.
const MARGIN: f64 = 0.1;
/// Parameters nearer than this share of the domain are one for the program, which wants to know of parameter lines.
const SAME_PARAMETER: f64 = 1.19e-7;

/// A trim of a loop, in the direction of the loop.
pub(super) struct Trim {
    pub curve: Curve<2>,
    /// The edge; none for a side that is a point.
    pub edge: Option<usize>,
    /// Whether the loop runs against the edge.
    pub reversed: bool,
    pub vertices: [usize; 2],
    pub kind: i32,
    /// See [`parameter_line`].
    pub side: i32,
    pub in_loop: usize,
}

/// An error that names the shell.
pub(super) fn invalid(s: &Shell, words: impl std::fmt::Display) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("sheet {:?} {words}", s.name))
}

/// The trims of a loop, run with the material on the left in the parameter plane.
pub(super) fn trims_of(s: &Shell, f: &ShellFace, uses: &[EdgeUse], in_loop: usize) -> io::Result<Vec<Trim>> {
    // Loops run about the normal of the face.
    let turned: Vec<(&EdgeUse, bool)> = match f.reversed {
        true => uses.iter().rev().map(|u| (u, !u.forward)).collect(),
        false => uses.iter().map(|u| (u, u.forward)).collect(),
    };
    let ends = domain(s, f)?;
    let mut out: Vec<Trim> = Vec::with_capacity(turned.len());
    for (u, forward) in turned {
        let e = s.edges.get(u.edge).ok_or_else(|| invalid(s, format!("has no edge {}", u.edge)))?;
        let along = edge_trim(s, f, u)?;
        let (curve, vertices) = if forward { (along, [e.start, e.end]) } else { (along.reversed(), [e.end, e.start]) };
        let side = parameter_line(&ends, &curve);
        let curve = straightened(curve, side);
        out.push(Trim { curve, edge: Some(u.edge), reversed: !forward, vertices, kind: BOUNDARY, side, in_loop });
    }
    with_points(&ends, out)
        .ok_or_else(|| invalid(s, "has a loop whose curves in the parameter plane do not meet, away from its corners"))
}

/// The image of an edge in the parameter plane, in the direction of the edge.
pub(super) fn edge_trim(s: &Shell, f: &ShellFace, u: &EdgeUse) -> io::Result<Curve<2>> {
    match &u.trim {
        Some(c) => Ok(c.clone()),
        None => projected(s, f, u),
    }
}

/// The loop with a side wherever the surface ends in a point.
fn with_points(ends: &[[f64; 2]; 2], trims: Vec<Trim>) -> Option<Vec<Trim>> {
    let size = ends.map(|[a, b]| b - a);
    let firsts: Vec<[f64; 2]> = trims.iter().map(|t| t.curve.control[0]).collect();
    let n = trims.len();
    let mut out = Vec::with_capacity(n);
    for (i, t) in trims.into_iter().enumerate() {
        let (p, q) = (t.curve.control[t.curve.control.len() - 1], firsts[(i + 1) % n]);
        let (in_loop, vertex) = (t.in_loop, t.vertices[1]);
        out.push(t);
        if (0..2).all(|k| (p[k] - q[k]).abs() <= APART * size[k]) {
            continue;
        }
        let curve = Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![p, q]).ok()?;
        let side = parameter_line(ends, &curve);
        if side < WEST {
            return None;
        }
        out.push(Trim { curve, edge: None, reversed: false, vertices: [vertex; 2], kind: SINGULAR, side, in_loop });
    }
    Some(out)
}

/// The domain of a face's surface in both parameters: that of a spline, or the extent of the edges in a plane.
pub(super) fn domain(s: &Shell, f: &ShellFace) -> io::Result<[[f64; 2]; 2]> {
    match &f.surface {
        ShellSurface::Spline { surface, .. } => {
            let ((u0, u1), (v0, v1)) = surface.domain();
            Ok([[u0, u1], [v0, v1]])
        }
        ShellSurface::Plane(frame) => {
            let all = s.vertices.iter().copied().chain(control_points(s));
            let b = crate::geom::BBox::of(&all.map(|p| frame.to_local(&p)).collect::<Vec<_>>());
            let pad = MARGIN * b.diagonal();
            Ok([[b.min.x - pad, b.max.x + pad], [b.min.y - pad, b.max.y + pad]])
        }
        _ => Err(invalid(s, format!("has the face {:?} on a cylinder or cone, which is not written", f.name))),
    }
}

/// The least number of a side of the domain.
pub(super) const WEST: i32 = 3;

/// What line of parameters a curve is: 0 for none, 1 and 2 for constant u and v, 3 to 6 for the sides of the domain from
/// the west over the south to the north. A curve that turns back on its way is none.
pub(super) fn parameter_line(ends: &[[f64; 2]; 2], c: &Curve<2>) -> i32 {
    let range =
        |k: usize| c.control.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |r, p| [r[0].min(p[k]), r[1].max(p[k])]);
    let ranges = [range(0), range(1)];
    let width = |k: usize| ranges[k][1] - ranges[k][0];
    let k = usize::from(width(0) * (ends[1][1] - ends[1][0]) > width(1) * (ends[0][1] - ends[0][0]));
    let hair = SAME_PARAMETER * (ends[k][1] - ends[k][0]);
    let middle = 0.5 * (ranges[k][0] + ranges[k][1]);
    let near = |t: f64| (t - middle).abs() <= hair;
    let runs = |sign: f64| c.control.windows(2).all(|w| sign * (w[1][1 - k] - w[0][1 - k]) >= 0.0);
    match k as i32 {
        _ if !(runs(1.0) || runs(-1.0)) => 0,
        _ if !(near(ranges[k][0]) && near(ranges[k][1])) => 0,
        k if near(ends[k as usize][0]) => WEST + k,
        k if near(ends[k as usize][1]) => WEST + 2 + k,
        k => 1 + k,
    }
}

/// A curve along a line of parameters, straight between its ends: the program takes none that wavers for such a line, by
/// however little.
fn straightened(mut c: Curve<2>, side: i32) -> Curve<2> {
    let (Some(&p), Some(&q)) = (c.control.first(), c.control.last()) else { return c };
    // Odd numbers are lines of constant u.
    let across = usize::from(side % 2 == 0);
    let along = 1 - across;
    if side == 0 || p[along].total_cmp(&q[along]).is_eq() {
        return c;
    }
    let inner = 1..c.control.len() - 1;
    for x in &mut c.control[inner] {
        let share = (x[along] - p[along]) / (q[along] - p[along]);
        x[across] = p[across] + share * (q[across] - p[across]);
    }
    c
}

/// The image of an edge in the parameter plane where none is given: exact in a plane; on a spline the line between the
/// corners that it joins.
fn projected(s: &Shell, f: &ShellFace, u: &EdgeUse) -> io::Result<Curve<2>> {
    let e = &s.edges[u.edge];
    let ends = [e.start, e.end].map(|v| s.vertices.get(v).copied());
    let [Some(p), Some(q)] = ends else { return Err(invalid(s, "lacks a vertex")) };
    let flat = |frame: &Frame, p: &Vec3| {
        let q = frame.to_local(p);
        [q.x, q.y]
    };
    let line = |a: [f64; 2], b: [f64; 2]| Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![a, b]);
    let found = match (&f.surface, &e.curve) {
        (ShellSurface::Plane(frame), ShellCurve::Line) => line(flat(frame, &p), flat(frame, &q)).ok(),
        (ShellSurface::Plane(frame), ShellCurve::Spline(c)) => {
            let control = c.control.iter().map(|p| flat(frame, &Vec3::from(*p))).collect();
            Some(Curve { knots: c.knots.clone(), control })
        }
        (ShellSurface::Spline { surface, .. }, _) => {
            let corners = corners(surface);
            let size = surface.bbox().diagonal();
            // Sides of the domain between corners; one that is a point has no edge.
            let sides = [(0, 1), (1, 2), (3, 2), (0, 3)];
            let off = |(a, b): (usize, usize)| (corners[a].1 - p).norm().max((corners[b].1 - q).norm());
            let turned = sides.map(|(a, b)| (b, a));
            let best = sides.into_iter().chain(turned).min_by(|x, y| off(*x).total_cmp(&off(*y)));
            best.filter(|x| off(*x) <= APART * size).and_then(|(a, b)| line(corners[a].0, corners[b].0).ok())
        }
        _ => None,
    };
    found.ok_or_else(|| invalid(s, format!("has edge {} without a curve in the parameter plane", u.edge)))
}

/// Corners of the domain, counter-clockwise, and where they lie.
fn corners(surface: &Surface) -> [([f64; 2], Vec3); 4] {
    let ((u0, u1), (v0, v1)) = surface.domain();
    [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(|q| (q, surface.point(q[0], q[1])))
}

/// Control points of the edges, which enclose these.
fn control_points(s: &Shell) -> impl Iterator<Item = Vec3> + '_ {
    s.edges.iter().flat_map(|e| match &e.curve {
        ShellCurve::Spline(c) => c.control.iter().map(|p| Vec3::from(*p)).collect(),
        ShellCurve::Rational(c) => c.control.iter().map(|h| Vec3::new(h[0], h[1], h[2]) / h[3]).collect(),
        _ => Vec::new(),
    })
}
