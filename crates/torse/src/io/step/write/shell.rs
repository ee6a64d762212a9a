//! Shells: faces with shared edges and vertices, as a STEP file has them.

use crate::develop::shop::offsets::OffsetPanel;
use crate::draw::scene::titled;
use crate::geom::{Frame, Vec3};
use crate::patchwork::panel::Panel;
use crate::patchwork::shell_surface::{ShellSurface, SurfaceForm};
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;

/// Connected faces with the edges and vertices that they share.
#[derive(Clone, Debug, Default)]
pub struct Shell {
    /// Name of the body.
    pub name: String,
    /// Corner points, mm.
    pub vertices: Vec<Vec3>,
    /// Edges between them.
    pub edges: Vec<ShellEdge>,
    /// Faces.
    pub faces: Vec<ShellFace>,
}

/// An edge: a curve between two vertices (twice the same for a closed edge).
#[derive(Clone, Debug)]
pub struct ShellEdge {
    /// Index of the first vertex.
    pub start: usize,
    /// Index of the last vertex.
    pub end: usize,
    /// Curve from start to end.
    pub curve: ShellCurve,
}

/// Curve of an edge.
#[derive(Clone, Debug)]
pub enum ShellCurve {
    /// The straight line between the vertices.
    Line,
    /// Arc of a circle about the frame's z-axis, run counter-clockwise.
    Circle {
        /// Centre and axes.
        frame: Frame,
        /// Radius, mm.
        radius: f64,
    },
    /// Polynomial spline.
    Spline(Curve<3>),
    /// Rational spline, homogeneous, weight last.
    Rational(Curve<4>),
}

/// A face: a surface and its loops.
#[derive(Clone, Debug)]
pub struct ShellFace {
    /// Name of the face.
    pub name: String,
    /// Surface that carries it.
    pub surface: ShellSurface,
    /// Whether the face's normal is the opposite of the surface's.
    pub reversed: bool,
    /// Loops, outer first, counter-clockwise about the face's normal; holes clockwise.
    pub loops: Vec<Vec<EdgeUse>>,
}

/// An edge as part of a loop.
#[derive(Clone, Debug)]
pub struct EdgeUse {
    /// Index of the edge.
    pub edge: usize,
    /// Whether the loop follows the edge's own direction.
    pub forward: bool,
    /// The edge in the surface's parameter plane, if known: in the edge's own direction and parameter.
    pub trim: Option<Curve<2>>,
}

impl Shell {
    /// The same shell with names that say that it must not be cut.
    pub(crate) fn marked(mut self) -> Self {
        self.name = titled(&self.name, true);
        for face in &mut self.faces {
            face.name = titled(&face.name, true);
        }
        self
    }

    /// One panel: its patch, trimmed by its runs. With `reversed` the normal is turned over (as that of a face
    /// whose normal is −S_u × S_v).
    pub(crate) fn of_panel(panel: &Panel, reversed: bool) -> Self {
        let mut shell = Self { name: panel.strip.name.clone(), ..Self::default() };
        let mut loops = Vec::with_capacity(panel.loops().len());
        for runs in panel.loops() {
            let runs: Vec<_> = runs.iter().filter(|r| !r.is_point()).collect();
            let first = shell.edges.len();
            let mut uses = Vec::with_capacity(runs.len());
            for (i, run) in runs.iter().enumerate() {
                // Edges are clamped: the first control point is where they begin, without rounding.
                shell.vertices.push(Vec3::from(run.edge.control.first().copied().unwrap_or_default()));
                uses.push(EdgeUse { edge: first + i, forward: !reversed, trim: Some(run.trim.clone()) });
                shell.edges.push(ShellEdge {
                    start: first + i,
                    end: first + (i + 1) % runs.len(),
                    curve: ShellCurve::Spline(run.edge.clone()),
                });
            }
            if reversed {
                uses.reverse();
            }
            loops.push(uses);
        }
        shell.faces.push(ShellFace {
            name: panel.strip.name.clone(),
            surface: ShellSurface::Spline { surface: panel.strip.patch.clone(), form: panel.strip.kind.into() },
            reversed: panel.mirrored() != reversed,
            loops,
        });
        shell
    }

    /// The offset of a panel, its normal on the side of that of the panel's face.
    pub(crate) fn of_offset(offset: &OffsetPanel) -> Self {
        let mut shell = Self { name: offset.name.clone(), ..Self::default() };
        // Elementary surfaces have parameters of their own.
        let has_trims = matches!(offset.surface, ShellSurface::Spline { .. } | ShellSurface::Offset { .. });
        let mut loops = Vec::with_capacity(offset.loops.len());
        for runs in &offset.loops {
            let first = shell.edges.len();
            let mut uses = Vec::with_capacity(runs.len());
            for (i, run) in runs.iter().enumerate() {
                shell.vertices.push(Vec3::from(run.edge.control.first().copied().unwrap_or_default()));
                let trim = has_trims.then(|| run.trim.clone());
                uses.push(EdgeUse { edge: first + i, forward: !offset.reversed, trim });
                shell.edges.push(ShellEdge {
                    start: first + i,
                    end: first + (i + 1) % runs.len(),
                    curve: ShellCurve::Spline(run.edge.clone()),
                });
            }
            if offset.reversed {
                uses.reverse();
            }
            loops.push(uses);
        }
        let reversed = (offset.mirrored != offset.reversed) != offset.turned;
        shell.faces.push(ShellFace { name: offset.name.clone(), surface: offset.surface.clone(), reversed, loops });
        shell
    }

    /// An untrimmed strip: one face, bounded by its rails and end rulings; a rail that is a point has no edge. Planes
    /// are written as planes.
    pub(crate) fn of_strip(strip: &Strip) -> Self {
        let mut shell = Self::untrimmed(&strip.name, &strip.patch);
        let points = [strip.is_point(0), strip.is_point(1)];
        let Some(face) = shell.faces.first_mut() else { return shell };
        if let ShellSurface::Spline { form, .. } = &mut face.surface {
            *form = strip.kind.into();
        }
        // Rails are the edges 0 and 2; their ends fall together at a point.
        for (side, edge, keep, lose) in [(0, 0, 0, 1), (1, 2, 3, 2)] {
            if points[side] {
                if let Some(l) = face.loops.first_mut() {
                    l.retain(|u| u.edge != edge);
                }
                for e in &mut shell.edges {
                    for end in [&mut e.start, &mut e.end] {
                        if *end == lose {
                            *end = keep;
                        }
                    }
                }
            }
        }
        let straight = |c: &ShellCurve| matches!(c, ShellCurve::Spline(c) if c.control.len() == 2);
        for e in &mut shell.edges {
            if straight(&e.curve) {
                e.curve = ShellCurve::Line;
            }
        }
        let plane = (strip.kind == PanelKind::Plane).then(|| plane_of(&strip.patch)).flatten();
        if let Some(frame) = plane {
            face.surface = ShellSurface::Plane(frame);
            for u in face.loops.iter_mut().flatten() {
                u.trim = None;
            }
        } else {
            // Lines have their length as parameter; the trims of straight edges would no longer fit.
            let lines: Vec<bool> = shell.edges.iter().map(|e| matches!(e.curve, ShellCurve::Line)).collect();
            for u in face.loops.iter_mut().flatten().filter(|u| lines[u.edge]) {
                u.trim = None;
            }
        }
        // What is no longer used is not written.
        let used: Vec<usize> = face.loops.iter().flatten().map(|u| u.edge).collect();
        let number = |e: usize| used.iter().filter(|&&x| x < e).count();
        for u in face.loops.iter_mut().flatten() {
            u.edge = number(u.edge);
        }
        let mut k = 0;
        shell.edges.retain(|_| {
            k += 1;
            used.contains(&(k - 1))
        });
        shell
    }

    /// The whole of a clamped spline surface, bounded by its four boundary curves.
    pub fn untrimmed(name: &str, surface: &Surface) -> Self {
        let ((u0, u1), (v0, v1)) = surface.domain();
        let (n, row) = (surface.knots_u.control_count(), surface.row());
        let along_u = |j: usize| Curve {
            knots: surface.knots_u.clone(),
            control: (0..n).map(|i| surface.control[i * row + j]).collect(),
        };
        let along_v = |i: usize| Curve {
            knots: surface.knots_v.clone(),
            control: surface.control[i * row..(i + 1) * row].to_vec(),
        };
        let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
        // Edges in the direction of their parameter; the loop runs the last two backwards.
        let sides = [
            (0, 1, along_u(0), true),
            (1, 2, along_v(n - 1), true),
            (3, 2, along_u(row - 1), false),
            (0, 3, along_v(0), false),
        ];
        let mut shell = Self { name: name.into(), ..Self::default() };
        shell.vertices = corners.iter().map(|c| surface.point(c[0], c[1])).collect();
        let mut uses = Vec::new();
        for (edge, (start, end, curve, forward)) in sides.into_iter().enumerate() {
            let (a, b) = curve.domain();
            let trim = Curve::new(1, vec![a, a, b, b], vec![corners[start], corners[end]]).ok();
            uses.push(EdgeUse { edge, forward, trim });
            shell.edges.push(ShellEdge { start, end, curve: edge_of(curve, surface.rational) });
        }
        shell.faces.push(ShellFace {
            name: name.into(),
            surface: ShellSurface::Spline { surface: surface.clone(), form: SurfaceForm::Unspecified },
            reversed: false,
            loops: vec![uses],
        });
        shell
    }
}

/// The plane of a plane patch, its normal on the patch's side; `None` for a patch without area.
fn plane_of(patch: &Surface) -> Option<Frame> {
    let ((u0, u1), (v0, v1)) = patch.domain();
    let j = patch.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1));
    let z = j.normal().try_normalize(0.0)?;
    let x = j.dv.try_normalize(0.0)?;
    Some(Frame { origin: j.p, x, y: z.cross(&x), z })
}

fn edge_of(c: Curve<4>, rational: bool) -> ShellCurve {
    if rational {
        return ShellCurve::Rational(c);
    }
    ShellCurve::Spline(Curve { control: c.control.iter().map(|h| [h[0], h[1], h[2]]).collect(), knots: c.knots })
}
