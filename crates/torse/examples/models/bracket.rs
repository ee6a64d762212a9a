//! A folded sheet, as a CAD program has it: closed, with both skins and all sides.

use super::{uses, Outcome};
use torse::geom::{Frame, Vec3};
use torse::io::step::write::{EdgeUse, Shell, ShellCurve, ShellEdge, ShellFace, ShellSurface};

const THICKNESS: f64 = 2.0;
const INSIDE_RADIUS: f64 = 3.0;
const WIDTH: f64 = 80.0;
/// Length (mm) of flat stretches and turn (degrees, upwards) of bends, one after the other.
const STRETCHES: [(f64, f64); 5] = [(25.0, 0.0), (0.0, -60.0), (70.0, 0.0), (0.0, 90.0), (40.0, 0.0)];
/// Radius of the hole in the middle stretch, mm.
const HOLE: f64 = 12.0;

/// A tab bent down by 60°, a base with a round hole, a wall bent up by 90°.
pub fn bracket() -> Outcome<Shell> {
    let mut sheet = Shell { name: "bracket".into(), ..Shell::default() };
    // The base lies level.
    let mut at = Station { point: Vec3::zeros(), angle: 60.0_f64.to_radians() };
    sheet.vertices.extend(at.corners());
    let mut skins = Vec::new();
    for (length, degrees) in STRETCHES {
        let next = if degrees == 0.0 { at.ahead(length) } else { at.bent(degrees.to_radians()) };
        let first = sheet.vertices.len() - 4;
        sheet.vertices.extend(next.corners());
        for corner in 0..4 {
            let curve = match at.bend(degrees, corner % 2) {
                Some((frame, radius)) if corner < 2 => ShellCurve::Circle { frame, radius },
                Some((frame, radius)) => {
                    ShellCurve::Circle { frame: Frame { origin: frame.origin + Vec3::y() * WIDTH, ..frame }, radius }
                }
                None => ShellCurve::Line,
            };
            sheet.edges.push(ShellEdge { start: first + corner, end: first + 4 + corner, curve });
        }
        skins.push((first, at, degrees));
        at = next;
    }
    let last = sheet.vertices.len() - 4;
    for v in (0..=last).step_by(4).flat_map(|v| [v, v + 1]) {
        sheet.edges.push(ShellEdge { start: v, end: v + 2, curve: ShellCurve::Line });
    }
    for v in [0, 2, last, last + 2] {
        sheet.edges.push(ShellEdge { start: v, end: v + 1, curve: ShellCurve::Line });
    }
    for (first, at, degrees) in &skins {
        for level in 0..2 {
            let (a, b) = (first + level, first + 4 + level);
            let corners = if level == 0 { [a, a + 2, b + 2, b] } else { [a, b, b + 2, a + 2] };
            let outwards = if level == 0 { -at.up() } else { at.up() };
            let (surface, reversed) = match at.bend(*degrees, level) {
                // The inner side of a bend looks to its axis.
                Some((frame, radius)) => (ShellSurface::Cylinder { frame, radius }, radius == INSIDE_RADIUS),
                None => (plane(sheet.vertices[a], at.heading(), outwards), false),
            };
            let loops = vec![around(&sheet, &corners)?];
            sheet.faces.push(ShellFace { name: String::new(), surface, reversed, loops });
        }
    }
    // Both ends, then both sides.
    let start = skins[0].1;
    let ends = [([0, 1, 3, 2], -start.heading()), ([last, last + 2, last + 3, last + 1], at.heading())];
    for (corners, outwards) in ends {
        let surface = plane(sheet.vertices[corners[0]], Vec3::y(), outwards);
        let loops = vec![around(&sheet, &corners)?];
        sheet.faces.push(ShellFace { name: String::new(), surface, reversed: false, loops });
    }
    for side in [0, 2] {
        let below = (side..sheet.vertices.len()).step_by(4);
        let mut corners: Vec<usize> = below.clone().chain(below.rev().map(|v| v + 1)).collect();
        let outwards = if side == 0 { -Vec3::y() } else { Vec3::y() };
        if side == 2 {
            corners.reverse();
        }
        let surface = plane(sheet.vertices[side], Vec3::x(), outwards);
        let loops = vec![around(&sheet, &corners)?];
        sheet.faces.push(ShellFace { name: String::new(), surface, reversed: false, loops });
    }
    // The base is the third stretch: faces 4 (below) and 5 (above).
    bore(&mut sheet, skins[2].1.ahead(0.5 * STRETCHES[2].0), [4, 5]);
    Ok(sheet)
}

/// Where the profile passes: the lower side, and the direction there (rad from x towards z).
#[derive(Clone, Copy)]
struct Station {
    point: Vec3,
    angle: f64,
}

impl Station {
    fn heading(&self) -> Vec3 {
        Vec3::new(self.angle.cos(), 0.0, self.angle.sin())
    }

    fn up(&self) -> Vec3 {
        Vec3::new(-self.angle.sin(), 0.0, self.angle.cos())
    }

    /// Below and above, in front and behind.
    fn corners(&self) -> [Vec3; 4] {
        let (above, behind) = (self.up() * THICKNESS, Vec3::y() * WIDTH);
        [self.point, self.point + above, self.point + behind, self.point + above + behind]
    }

    fn ahead(&self, length: f64) -> Self {
        Self { point: self.point + self.heading() * length, ..*self }
    }

    /// Height of a bend's axis above the lower side, mm.
    fn axis(turn: f64) -> f64 {
        if turn > 0.0 {
            THICKNESS + INSIDE_RADIUS
        } else {
            -INSIDE_RADIUS
        }
    }

    fn bent(&self, turn: f64) -> Self {
        let centre = self.point + self.up() * Self::axis(turn);
        let next = Self { angle: self.angle + turn, ..*self };
        Self { point: centre - next.up() * Self::axis(turn), ..next }
    }

    /// Frame and radius of the lower (0) or upper (1) side of a bend that begins here; `None` if it does not turn.
    fn bend(&self, degrees: f64, level: usize) -> Option<(Frame, f64)> {
        let axis = Self::axis(degrees);
        let side = degrees.signum();
        let (x, z) = (self.up() * -side, Vec3::y() * -side);
        let frame = Frame { origin: self.point + self.up() * axis, x, y: z.cross(&x), z };
        (degrees != 0.0).then_some((frame, (axis - THICKNESS * level as f64).abs()))
    }
}

fn plane(origin: Vec3, x: Vec3, z: Vec3) -> ShellSurface {
    ShellSurface::Plane(Frame { origin, x, y: z.cross(&x), z })
}

/// The loop along edges from vertex to vertex.
fn around(sheet: &Shell, corners: &[usize]) -> Outcome<Vec<EdgeUse>> {
    let way = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        let found = sheet.edges.iter().position(|e| [e.start, e.end] == [a, b] || [e.start, e.end] == [b, a]);
        found.map(|edge| (edge, sheet.edges[edge].start == a)).ok_or("no edge joins two corners of a face")
    };
    Ok(uses(&(0..corners.len()).map(way).collect::<Result<Vec<_>, _>>()?))
}

/// A round hole, square to the sheet, through its lower and upper face.
fn bore(sheet: &mut Shell, at: Station, faces: [usize; 2]) {
    let (up, x) = (at.up(), at.heading());
    let origin = at.point + Vec3::y() * (0.5 * WIDTH);
    let frame = Frame { origin, x, y: up.cross(&x), z: up };
    let (vertex, edge) = (sheet.vertices.len(), sheet.edges.len());
    for level in 0..2 {
        let frame = Frame { origin: origin + up * (THICKNESS * level as f64), ..frame };
        sheet.vertices.push(frame.origin + x * HOLE);
        let curve = ShellCurve::Circle { frame, radius: HOLE };
        sheet.edges.push(ShellEdge { start: vertex + level, end: vertex + level, curve });
    }
    sheet.edges.push(ShellEdge { start: vertex, end: vertex + 1, curve: ShellCurve::Line });
    // A hole is run clockwise, seen from outside; its wall looks to its axis.
    sheet.faces[faces[0]].loops.push(uses(&[(edge, true)]));
    sheet.faces[faces[1]].loops.push(uses(&[(edge + 1, false)]));
    let loops = vec![uses(&[(edge + 2, true), (edge + 1, true), (edge + 2, false), (edge, false)])];
    let surface = ShellSurface::Cylinder { frame, radius: HOLE };
    sheet.faces.push(ShellFace { name: String::new(), surface, reversed: true, loops });
}
