//! Parts for tests: bent sheets as solids, cell by cell, and faces without thickness.

use crate::brep::face::Face;
use crate::brep::raw::SurfaceKind;
use crate::brep::raw::{RawEdge, RawFace, RawLoop, RawRegion, SurfaceDeviation};
use crate::brep::space_curve::{Arc, SpaceCurve};
use crate::brep::support_surface::SupportSurface;
use crate::brep::trim::faces;
use crate::geom::{Frame, Vec3};
use std::f64::consts::PI;

/// A stretch of a profile.
#[derive(Clone, Copy, Debug)]
pub enum Stretch {
    /// Straight, of a length (mm).
    Line(f64),
    /// Turned by an angle (rad, positive towards the upper side) about an inside radius (mm).
    Bend(f64, f64),
}

/// Where a profile passes: lower and upper corner, heading.
#[derive(Clone, Copy, Debug)]
struct Station {
    lower: Vec3,
    upper: Vec3,
    heading: Vec3,
}

/// A sheet of constant thickness with a profile in the xz plane, extruded along y in strips.
#[derive(Clone, Debug)]
pub(crate) struct BentSheet {
    thickness: f64,
    stretches: Vec<Stretch>,
    stations: Vec<Station>,
    lines: Vec<f64>,
    holes: Vec<[usize; 2]>,
}

fn raw(support: SupportSurface, kind: SurfaceKind, same_sense: bool, loops: Vec<Vec<RawEdge>>) -> Face {
    let loops = loops.into_iter().enumerate().map(|(k, edges)| RawLoop { edges, outer: k == 0 }).collect();
    let face = RawFace {
        entity: 1,
        name: String::new(),
        part: "sheet".into(),
        kind,
        support,
        same_sense,
        region: RawRegion::Loops(loops),
        surface_deviation: SurfaceDeviation::NONE,
        uncertainty: 0.0,
    };
    let mut made = faces(&face, None).expect("a trimmed face");
    assert_eq!(made.len(), 1);
    let mut out = made.remove(0);
    out.body = 1;
    out
}

fn edge(entity: u64, forward: bool, path: Arc) -> RawEdge {
    let path = if forward { path } else { path.reversed() };
    RawEdge { entity, forward, vertices: Some([path.ends().0, path.ends().1]), path: vec![path], trace: None }
}

fn straight(p: Vec3, q: Vec3) -> Arc {
    Arc { curve: SpaceCurve::Line { origin: p, direction: q - p }, from: 0.0, to: 1.0 }
}

impl BentSheet {
    /// A sheet whose strips run between the `lines` (y, rising, mm); cells (stretch, strip) in `holes` are cut out.
    pub fn new(thickness: f64, stretches: &[Stretch], lines: &[f64], holes: &[[usize; 2]]) -> Self {
        let up = |h: Vec3| h.cross(&Vec3::y());
        let (mut at, mut heading) = (Vec3::zeros(), Vec3::x());
        let station = |at: Vec3, heading: Vec3| Station { lower: at, upper: at + up(heading) * thickness, heading };
        let mut stations = vec![station(at, heading)];
        for s in stretches {
            match *s {
                Stretch::Line(length) => at += heading * length,
                Stretch::Bend(angle, inside) => {
                    let radius = if angle > 0.0 { inside + thickness } else { -inside };
                    let centre = at + up(heading) * radius;
                    let (sin, cos) = angle.sin_cos();
                    at = centre - (up(heading) * cos - heading * sin) * radius;
                    heading = heading * cos + up(heading) * sin;
                }
            }
            stations.push(station(at, heading));
        }
        Self { thickness, stretches: stretches.to_vec(), stations, lines: lines.to_vec(), holes: holes.to_vec() }
    }

    fn place(&self, i: usize, j: usize, upper: bool) -> Vec3 {
        let s = &self.stations[i];
        (if upper { s.upper } else { s.lower }) + Vec3::y() * self.lines[j]
    }

    fn number(&self, kind: u64, i: usize, j: usize, upper: bool) -> u64 {
        1000 + ((kind * 64 + i as u64) * 64 + j as u64) * 2 + u64::from(upper)
    }

    /// Along y at station i, over strip j.
    fn rung(&self, i: usize, j: usize, upper: bool, forward: bool) -> RawEdge {
        let path = straight(self.place(i, j, upper), self.place(i, j + 1, upper));
        edge(self.number(0, i, j, upper), forward, path)
    }

    /// From lower to upper side at station i, line j.
    fn post(&self, i: usize, j: usize, forward: bool) -> RawEdge {
        edge(self.number(1, i, j, false), forward, straight(self.place(i, j, false), self.place(i, j, true)))
    }

    /// Along stretch i at line j.
    fn rail(&self, i: usize, j: usize, upper: bool, forward: bool) -> RawEdge {
        let (p, q) = (self.place(i, j, upper), self.place(i + 1, j, upper));
        let path = match self.cylinder(i, upper) {
            None => straight(p, q),
            Some((frame, radius, angle)) => {
                let frame = Frame { origin: frame.origin + Vec3::y() * self.lines[j], ..frame };
                let curve = SpaceCurve::Ellipse { frame, a: radius, b: radius };
                Arc { curve, from: 0.0, to: angle.abs() }
            }
        };
        edge(self.number(2, i, j, upper), forward, path)
    }

    /// Frame (x towards the start, turning towards y to the end), radius and angle of a bend's side.
    fn cylinder(&self, i: usize, upper: bool) -> Option<(Frame, f64, f64)> {
        let Stretch::Bend(angle, inside) = self.stretches[i] else { return None };
        let s = &self.stations[i];
        let up = s.heading.cross(&Vec3::y());
        let to_centre = if angle > 0.0 { inside + self.thickness } else { -inside };
        let origin = s.lower + up * to_centre;
        let outer = (angle > 0.0) != upper;
        let radius = if outer { inside + self.thickness } else { inside };
        let x = if angle > 0.0 { -up } else { up };
        Some((Frame { origin, x, y: s.heading, z: x.cross(&s.heading) }, radius, angle))
    }

    fn is_cell(&self, i: isize, j: isize) -> bool {
        let inside = i >= 0 && j >= 0 && (i as usize) < self.stretches.len() && (j as usize) + 1 < self.lines.len();
        inside && !self.holes.contains(&[i as usize, j as usize])
    }

    fn plane(&self, origin: Vec3, normal: Vec3, edges: Vec<RawEdge>) -> Face {
        let support = SupportSurface::Plane(crate::brep::recognised_surface::frame(origin, normal));
        raw(support, SurfaceKind::Plane, true, vec![edges])
    }

    /// The faces of the solid.
    pub fn faces(&self) -> Vec<Face> {
        let mut out = Vec::new();
        for i in 0..self.stretches.len() {
            for j in 0..self.lines.len() - 1 {
                if self.is_cell(i as isize, j as isize) {
                    out.extend([false, true].map(|upper| self.skin(i, j, upper)));
                    out.extend(self.walls(i, j));
                }
            }
        }
        out
    }

    fn skin(&self, i: usize, j: usize, upper: bool) -> Face {
        // About the upper side's normal: along the profile, along y, back.
        let mut edges = vec![
            self.rail(i, j, upper, true),
            self.rung(i + 1, j, upper, true),
            self.rail(i, j + 1, upper, false),
            self.rung(i, j, upper, false),
        ];
        if !upper {
            edges = edges.iter().rev().map(RawEdge::reversed).collect();
        }
        match self.cylinder(i, upper) {
            None => {
                let up = self.stations[i].heading.cross(&Vec3::y());
                self.plane(self.place(i, j, upper), if upper { up } else { -up }, edges)
            }
            Some((frame, radius, angle)) => {
                let outer = (angle > 0.0) != upper;
                raw(SupportSurface::Cylinder { frame, radius }, SurfaceKind::Cylinder, outer, vec![edges])
            }
        }
    }

    /// Faces between both skins where a cell has no neighbour.
    fn walls(&self, i: usize, j: usize) -> Vec<Face> {
        let (p, q) = (i as isize, j as isize);
        let mut out = Vec::new();
        for (end, neighbour) in [(0, p - 1), (1, p + 1)] {
            if !self.is_cell(neighbour, q) {
                let k = i + end;
                let mut edges = vec![
                    self.rung(k, j, false, true),
                    self.post(k, j + 1, true),
                    self.rung(k, j, true, false),
                    self.post(k, j, false),
                ];
                let mut normal = self.stations[k].heading;
                if end == 0 {
                    edges = edges.iter().rev().map(RawEdge::reversed).collect();
                    normal = -normal;
                }
                out.push(self.plane(self.place(k, j, false), normal, edges));
            }
        }
        for (end, neighbour) in [(0, q - 1), (1, q + 1)] {
            if !self.is_cell(p, neighbour) {
                let k = j + end;
                let mut edges = vec![
                    self.post(i, k, true),
                    self.rail(i, k, true, true),
                    self.post(i + 1, k, false),
                    self.rail(i, k, false, false),
                ];
                let mut normal = Vec3::y();
                if end == 0 {
                    edges = edges.iter().rev().map(RawEdge::reversed).collect();
                    normal = -normal;
                }
                out.push(self.plane(self.place(i, k, false), normal, edges));
            }
        }
        out
    }
}

/// A whole cylinder or cone about z without thickness between two heights; `slope` is the tangent of the half angle.
pub(crate) fn round_surface(radius: f64, slope: f64, heights: (f64, f64)) -> Face {
    let frame = Frame::world();
    let support = match slope == 0.0 {
        true => SupportSurface::Cylinder { frame, radius },
        false => SupportSurface::Cone { frame, radius, slope },
    };
    let kind = if slope == 0.0 { SurfaceKind::Cylinder } else { SurfaceKind::Cone };
    let mut face = raw_rectangle(support, kind, [(0.0, 2.0 * PI), heights]);
    face.body = 1;
    face
}

/// A sheet rolled to a part of a cone about z, as a solid: inner radius at z = 0, tangent of the half angle, height and turn of
/// the inside.
pub(crate) fn rolled_cone(thickness: f64, (radius, slope): (f64, f64), height: f64, turn: f64) -> Vec<Face> {
    let (sin, cos) = slope.atan().sin_cos();
    let (up, out) = ([sin, cos], [cos, -sin]);
    let cone = |z: f64, radius: f64, slope: f64, heights: (f64, f64), same_sense: bool| {
        let frame = Frame { origin: Vec3::z() * z, ..Frame::world() };
        let support = SupportSurface::Cone { frame, radius, slope };
        let mut face = raw_rectangle(support, SurfaceKind::Cone, [(0.0, turn), heights]);
        face.reversed = !same_sense;
        face
    };
    let deep = -thickness * sin;
    let mut all = vec![
        cone(0.0, radius, slope, (0.0, height), false),
        cone(0.0, radius + thickness / cos, slope, (deep, height + deep), true),
        cone(0.0, radius, -1.0 / slope, (deep, 0.0), false),
        cone(height, radius + slope * height, -1.0 / slope, (deep, 0.0), true),
    ];
    for (angle, last) in [(0.0f64, false), (turn, true)] {
        let place = |p: [f64; 2]| Vec3::new(p[0] * angle.cos(), p[0] * angle.sin(), p[1]);
        let (along, across) = (place(up.map(|x| x * height / cos)), place(out.map(|x| x * thickness)));
        let corner = place([radius, 0.0]);
        all.push(if last { rectangle(corner, along, across) } else { rectangle(corner, across, along) });
    }
    all.iter_mut().for_each(|f| f.body = 1);
    all
}

fn raw_rectangle(support: SupportSurface, kind: SurfaceKind, sides: [(f64, f64); 2]) -> Face {
    let face = RawFace {
        entity: 1,
        name: String::new(),
        part: "sheet".into(),
        kind,
        support,
        same_sense: true,
        region: RawRegion::Rectangle(sides),
        surface_deviation: SurfaceDeviation::NONE,
        uncertainty: 0.0,
    };
    faces(&face, None).expect("a face").remove(0)
}

/// A plane rectangle without thickness: a corner and two sides.
pub fn rectangle(corner: Vec3, a: Vec3, b: Vec3) -> Face {
    let frame = Frame { origin: corner, x: a.normalize(), y: b.normalize(), z: a.cross(&b).normalize() };
    let mut out = raw_rectangle(SupportSurface::Plane(frame), SurfaceKind::Plane, [(0.0, a.norm()), (0.0, b.norm())]);
    out.body = 1;
    out
}

/// A quarter of a cylinder without thickness: from `start` on the axis through `origin` along `axis`, of a length.
pub fn quarter(origin: Vec3, axis: Vec3, start: Vec3, length: f64) -> Face {
    let (z, x) = (axis.normalize(), start.normalize());
    let frame = Frame { origin, x, y: z.cross(&x), z };
    let support = SupportSurface::Cylinder { frame, radius: start.norm() };
    let mut out = raw_rectangle(support, SurfaceKind::Cylinder, [(0.0, 0.5 * PI), (0.0, length)]);
    out.body = 1;
    out
}
