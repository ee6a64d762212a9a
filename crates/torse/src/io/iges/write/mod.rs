//! IGES writer: panels as trimmed surfaces, millimetres.
//!
//! Every panel is a trimmed surface (144) of its own, named: a rational B-spline surface (128) inside curves on it
//! (142), each given in the parameter plane and in space (126) as chains (102). Surfaces are turned so that their
//! normals are on the side of the input faces' normals. Numbers are written so that they read back bit for bit;
//! rational control points are written divided by their weights, which rounds each coordinate once. The writer neither
//! checks nor repairs geometry.

mod layout;

use self::layout::{real, string, Entity, Layout};
use crate::draw::scene::titled;
use crate::io::step::write::Header;
use crate::patchwork::panel::{Panel, Patchwork};
use crate::spline::curve::Curve;
use crate::spline::surface::Surface;

/// Status of a part of another entity.
const PART: &str = "00010000";
/// Status of a part that lies in a parameter plane.
const FLAT: &str = "00010500";
/// Status of a name.
const NAME: &str = "00010300";
/// Status of an entity that stands for itself.
const OWN: &str = "00000000";
/// Preference of the curve in space: what the panels were judged by.
const SPACE_PREFERRED: i64 = 2;

/// One edge of a boundary in the direction of its loop.
struct Edge {
    /// In the parameter plane.
    flat: Curve<2>,
    /// In space, homogeneous; `None` where it is a point.
    space: Option<Curve<4>>,
}

/// The panels of a patchwork as a file. Names of panels that `marked` holds for say that they must not be cut.
pub fn panels(header: &Header, patchwork: &Patchwork, marked: &[bool]) -> Vec<u8> {
    let mut out = Layout::default();
    let mut largest = 0.0_f64;
    for (k, panel) in patchwork.panels.iter().enumerate() {
        let reversed = patchwork.face_of(panel).is_some_and(|f| f.reversed);
        let name = titled(&panel.strip.name, marked.get(k).copied().unwrap_or(false));
        let (surface, loops) = bounded(panel, reversed);
        largest = surface.control.iter().flat_map(|h| &h[..3]).fold(largest, |m, x| m.max(x.abs()));
        face(&mut out, &name, &surface, &loops);
    }
    out.file("Developable panels", &global(header, largest)).into_bytes()
}

/// The global section.
fn global(header: &Header, largest: f64) -> Vec<String> {
    let program = string(concat!("torse ", env!("CARGO_PKG_VERSION")));
    // 2026-01-31T12:00:00 becomes 20260131.120000.
    let digits = |from: usize| header.time.chars().skip(from).filter(char::is_ascii_digit).collect::<String>();
    let (date, time) = header.time.split_once('T').map_or((String::new(), String::new()), |(d, _)| {
        (d.chars().filter(char::is_ascii_digit).collect(), digits(d.len()))
    });
    let stamp = if date.is_empty() { String::new() } else { string(&format!("{date}.{time}")) };
    let name = string(&header.name);
    let file = string(&format!("{}.igs", header.name));
    let text = |s: &str| s.to_string();
    vec![
        text("1H,"),
        text("1H;"),
        name.clone(),
        file,
        program.clone(),
        program,
        text("32"),
        text("38"),
        text("6"),
        text("308"),
        text("15"),
        name,
        text("1.0"),
        text("2"),
        text("2HMM"),
        text("1"),
        text("0.1"),
        stamp.clone(),
        real(header.uncertainty),
        real(largest),
        String::new(),
        String::new(),
        text("11"),
        text("0"),
        stamp,
    ]
}

/// Surface and loops of a panel, outer first and counter-clockwise, with the surface's normal that of the input face.
fn bounded(panel: &Panel, reversed: bool) -> (Surface, Vec<Vec<Edge>>) {
    let patch = &panel.strip.patch;
    if panel.loops().is_empty() {
        return (patch.clone(), vec![sides(patch)]);
    }
    let homogeneous = |c: &Curve<3>| Curve {
        knots: c.knots.clone(),
        control: c.control.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect(),
    };
    let mut loops: Vec<Vec<Edge>> = panel
        .loops()
        .iter()
        .map(|runs| {
            let edges = runs.iter().filter(|r| !r.is_point());
            edges.map(|r| Edge { flat: r.trim.clone(), space: Some(homogeneous(&r.edge)) }).collect()
        })
        .collect();
    if reversed {
        for edges in &mut loops {
            edges.reverse();
            for e in edges {
                e.flat = e.flat.reversed();
                e.space = e.space.take().map(|c| c.reversed());
            }
        }
    }
    if panel.mirrored() == reversed {
        return (patch.clone(), loops);
    }
    for e in loops.iter_mut().flatten() {
        e.flat.control.iter_mut().for_each(|p| p.swap(0, 1));
    }
    (patch.transposed(), loops)
}

/// The four sides of a whole patch.
fn sides(s: &Surface) -> Vec<Edge> {
    let ((u0, u1), (v0, v1)) = s.domain();
    let (n, row) = (s.knots_u.control_count(), s.row());
    let along_u =
        |j: usize| Curve { knots: s.knots_u.clone(), control: (0..n).map(|i| s.control[i * row + j]).collect() };
    let along_v = |i: usize| Curve { knots: s.knots_v.clone(), control: s.control[i * row..(i + 1) * row].to_vec() };
    let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]];
    let sides =
        [along_u(0), along_v(n - 1), along_u(row - 1).reversed(), along_v(0).reversed()].into_iter().enumerate();
    sides
        .filter_map(|(k, space)| {
            let (a, b) = space.domain();
            let flat = Curve::new(1, vec![a, a, b, b], vec![corners[k], corners[(k + 1) % 4]]).ok()?;
            let affine = |h: &[f64; 4]| [h[0] / h[3], h[1] / h[3], h[2] / h[3]];
            let point = space.control.iter().all(|h| affine(h) == affine(&space.control[0]));
            Some(Edge { flat, space: (!point).then_some(space) })
        })
        .collect()
}

/// One face.
fn face(out: &mut Layout, name: &str, s: &Surface, loops: &[Vec<Edge>]) {
    let number = |n: u64| n.to_string();
    let surface = out.push(Entity { kind: 128, status: PART, label: name, form: 0 }, &surface_fields(s));
    let mut boundaries = Vec::with_capacity(loops.len());
    for edges in loops {
        let flat: Vec<u64> = edges.iter().map(|e| curve(out, &e.flat.lifted(), true)).collect();
        let space: Vec<u64> = edges.iter().filter_map(|e| e.space.as_ref()).map(|c| curve(out, c, false)).collect();
        let [flat, space] = [(flat, FLAT), (space, PART)].map(|(list, status)| {
            let fields: Vec<String> = std::iter::once(list.len() as u64).chain(list).map(number).collect();
            out.push(Entity { kind: 102, status, ..Entity::default() }, &fields)
        });
        let fields = [1, surface, flat, space].map(number).into_iter().chain([SPACE_PREFERRED.to_string()]);
        boundaries.push(out.push(Entity { kind: 142, status: PART, ..Entity::default() }, &fields.collect::<Vec<_>>()));
    }
    let property =
        out.push(Entity { kind: 406, form: 15, status: NAME, ..Entity::default() }, &["1".into(), string(name)]);
    let inner = boundaries.len().saturating_sub(1) as u64;
    let outer = boundaries.first().copied().unwrap_or(0);
    let mut fields = vec![surface, u64::from(outer > 0), inner, outer];
    fields.extend(boundaries.iter().skip(1));
    // No associativity, one property.
    fields.extend([0, 1, property]);
    let fields: Vec<String> = fields.into_iter().map(number).collect();
    out.push(Entity { kind: 144, status: OWN, label: name, form: 0 }, &fields);
}

/// Curves of the parameter plane as curves of space.
trait Lifted {
    fn lifted(&self) -> Curve<4>;
}

impl Lifted for Curve<2> {
    fn lifted(&self) -> Curve<4> {
        Curve { knots: self.knots.clone(), control: self.control.iter().map(|p| [p[0], p[1], 0.0, 1.0]).collect() }
    }
}

fn flag(holds: bool) -> String {
    u8::from(holds).to_string()
}

/// Coordinates divided by the weight.
fn affine(h: &[f64; 4]) -> [String; 3] {
    [0, 1, 2].map(|d| real(h[d] / h[3]))
}

/// A spline curve; `flat` says that it lies in the plane z = 0.
fn curve(out: &mut Layout, c: &Curve<4>, flat: bool) -> u64 {
    let degree = c.knots.degree();
    let polynomial = c.control.iter().all(|h| h[3] == 1.0);
    let closed = c.control.first() == c.control.last();
    let mut fields = vec![(c.control.len() - 1).to_string(), degree.to_string()];
    fields.extend([flag(flat), flag(closed), flag(polynomial), flag(false)]);
    fields.extend(c.knots.values().iter().map(|t| real(*t)));
    fields.extend(c.control.iter().map(|h| real(h[3])));
    fields.extend(c.control.iter().flat_map(affine));
    let (a, b) = c.domain();
    fields.extend([real(a), real(b), real(0.0), real(0.0), real(if flat { 1.0 } else { 0.0 })]);
    let status = if flat { FLAT } else { PART };
    out.push(Entity { kind: 126, status, ..Entity::default() }, &fields)
}

/// Parameter data of a spline surface; the first parameter runs first.
fn surface_fields(s: &Surface) -> Vec<String> {
    let (n, row) = (s.knots_u.control_count(), s.row());
    let order = || (0..row).flat_map(|j| (0..n).map(move |i| i * row + j)).map(|k| &s.control[k]);
    let mut fields: Vec<String> =
        [n - 1, row - 1, s.knots_u.degree(), s.knots_v.degree()].iter().map(usize::to_string).collect();
    fields.extend([flag(false), flag(false), flag(!s.rational), flag(false), flag(false)]);
    fields.extend(s.knots_u.values().iter().chain(s.knots_v.values()).map(|t| real(*t)));
    fields.extend(order().map(|h| real(h[3])));
    fields.extend(order().flat_map(affine));
    let ((u0, u1), (v0, v1)) = s.domain();
    fields.extend([u0, u1, v0, v1].map(real));
    fields
}
