//! Cone splines as shells of exact conical, cylindrical and plane faces that share their junction rulings.

use super::shell::{EdgeUse, Shell, ShellCurve, ShellEdge, ShellFace};
use crate::geom::{Frame, Vec3};
use crate::patchwork::shell_surface::ShellSurface;
use crate::spline::curve::Curve;
use crate::torse::cone::distance::Round;
use crate::torse::cone::forms::edge_conic;
use crate::torse::cone::part::{ConePart, PartCurve};
use crate::torse::cone::spline::{ConeSpline, Segment, Shape, ONCE_AROUND};
use std::f64::consts::TAU;

/// Turns beyond this are written as several faces, rad, unless edges are circles: conic edges keep weights above 1/2.
const LARGEST_TURN: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

impl Shell {
    /// A chain: one face for each segment (CONICAL_SURFACE, CYLINDRICAL_SURFACE, PLANE), named `name-01 cone` and so
    /// on, normals on the side of the segments' normals. Lateral edges are circles or conics, the others lines.
    pub(crate) fn of_cones(name: &str, spline: &ConeSpline) -> Self {
        let spline = spline.with_turns_below(LARGEST_TURN, ONCE_AROUND);
        let mut shell = Self { name: name.into(), ..Self::default() };
        let Some(first) = spline.segments.first() else { return shell };
        let mut ends = |s: &Segment, f: f64, k: usize| {
            shell.vertices.extend([0, 1].map(|side| s.point(f, s.edges[side][k])));
        };
        ends(first, 0.0, 0);
        // A full turn ends where it begins: one slit, used there and back.
        let closed = spline.segments.len() == 1 && first.shape.angle().abs() >= 2.0 * TAU - ONCE_AROUND;
        if !closed {
            for s in &spline.segments {
                ends(s, 1.0, 2);
            }
        }
        // Edges 3i: ruling i; 3i + 1 and 3i + 2: lower and upper edge of segment i.
        let ruling = |i: usize| ShellEdge { start: 2 * i, end: 2 * i + 1, curve: ShellCurve::Line };
        let edge_use = |edge: usize, forward: bool| EdgeUse { edge, forward, trim: None };
        for (i, s) in spline.segments.iter().enumerate() {
            shell.edges.push(ruling(i));
            for side in 0..2 {
                let curve = lateral(s, side);
                let end = if closed { side } else { 2 * i + 2 + side };
                shell.edges.push(ShellEdge { start: 2 * i + side, end, curve });
            }
            let (surface, reversed) = support(s);
            shell.faces.push(ShellFace {
                name: format!("{name}-{:02} {}", i + 1, s.shape.name()),
                surface,
                reversed,
                loops: vec![vec![
                    edge_use(3 * i, true),
                    edge_use(3 * i + 2, true),
                    edge_use(if closed { 0 } else { 3 * i + 3 }, false),
                    edge_use(3 * i + 1, false),
                ]],
            });
        }
        if !closed {
            shell.edges.push(ruling(spline.segments.len()));
        }
        shell
    }
}

impl Shell {
    /// A trimmed chain: one face for each piece, named like those of whole chains; joints are shared lines, other
    /// edges splines near the exact surfaces.
    pub(crate) fn of_cone_part(name: &str, part: &ConePart) -> Self {
        let mut shell = Self { name: name.into(), vertices: part.vertices.clone(), ..Self::default() };
        for e in &part.edges {
            let curve = match &e.curve {
                PartCurve::Ruling => ShellCurve::Line,
                PartCurve::Free { space, .. } => ShellCurve::Spline(space.clone()),
            };
            shell.edges.push(ShellEdge { start: e.start, end: e.end, curve });
        }
        for (i, f) in part.faces.iter().enumerate() {
            let (surface, reversed) = support(&f.blank.segment);
            shell.faces.push(ShellFace {
                name: format!("{name}-{:02} {}", i + 1, f.blank.segment.shape.name()),
                surface,
                reversed,
                loops: f
                    .loops
                    .iter()
                    .map(|l| l.iter().map(|&(edge, forward)| EdgeUse { edge, forward, trim: None }).collect())
                    .collect(),
            });
        }
        shell
    }
}

/// Surface of a face, and whether its normal is opposite to the segment's.
fn support(s: &Segment) -> (ShellSurface, bool) {
    let g = &s.start;
    let round = Round::of(s);
    // From the axis to the first point.
    let out = g.point - round.center;
    match s.shape {
        Shape::Cone { distance, cos_gamma, sin_gamma, .. } if !s.shape.is_plane() => {
            // The cone widens away from its vertex.
            let z = round.axis * (distance * cos_gamma).signum();
            let x = (out - z * out.dot(&z)).normalize();
            let frame = Frame { origin: round.center, x, y: z.cross(&x), z };
            let half_angle = sin_gamma.atan2(cos_gamma.abs());
            (ShellSurface::Cone { frame, radius: round.radius, half_angle }, g.normal.dot(&x) < 0.0)
        }
        Shape::Cylinder { radius, .. } => {
            let (z, x) = (g.direction, g.normal * radius.signum());
            let frame = Frame { origin: round.center, x, y: z.cross(&x), z };
            (ShellSurface::Cylinder { frame, radius: round.radius }, radius < 0.0)
        }
        _ => {
            let frame = Frame { origin: g.point, x: g.direction, y: g.forward, z: g.normal };
            (ShellSurface::Plane(frame), false)
        }
    }
}

/// A lateral edge from the first ruling to the last.
fn lateral(s: &Segment, side: usize) -> ShellCurve {
    let [a, m, b] = s.edges[side];
    let same = a.total_cmp(&m).is_eq() && m.total_cmp(&b).is_eq();
    let angle = s.shape.angle();
    if same && angle != 0.0 {
        let start = s.start.at(a);
        let z = s.axis() * angle.signum();
        let axis_point = Round::of(s).center;
        let y = start - axis_point;
        let out = y - z * y.dot(&z);
        let x = out.normalize();
        let frame = Frame { origin: start - out, x, y: z.cross(&x), z };
        return ShellCurve::Circle { frame, radius: out.norm() };
    }
    let conic = edge_conic(s, side);
    if angle == 0.0 && same {
        return ShellCurve::Line;
    }
    let control = conic.iter().map(|(p, w): &(Vec3, f64)| [p.x * w, p.y * w, p.z * w, *w]).collect();
    match Curve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], control) {
        Ok(c) => ShellCurve::Rational(c),
        // Only numbers that are not finite get here; the writer shows them as they are.
        Err(_) => ShellCurve::Line,
    }
}
