//! What is written is read back.

use super::super::write;
use super::read;
use super::{area, model, near, normal};
use crate::geom::{Frame, Vec3};
use crate::io::step::write::{EdgeUse, Header, Shell, ShellCurve, ShellEdge, ShellFace, ShellSurface, SurfaceForm};
use crate::spline::curve::Curve;
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;

fn header() -> Header {
    Header { name: "test".into(), time: String::new(), uncertainty: 1e-6 }
}

fn knots(p: usize) -> Knots {
    Knots::clamped(p, &[0.0, 1.0]).expect("knots")
}

/// Parabolic cylinder (100 u, 200 v, 50 u²).
fn parabola() -> Surface {
    let row = [(0.0, 0.0), (50.0, 0.0), (100.0, 50.0)];
    let points: Vec<Vec3> = row.iter().flat_map(|&(x, z)| [Vec3::new(x, 0., z), Vec3::new(x, 200., z)]).collect();
    Surface::new(knots(2), knots(1), &points, None).expect("surface")
}

/// A rectangle of the parameter plane of the parabola as a loop, with exact edges.
fn ring(s: &mut Shell, corners: [[f64; 2]; 4]) -> Vec<EdgeUse> {
    let first = s.edges.len();
    let at = |q: [f64; 2]| [100.0 * q[0], 200.0 * q[1], 50.0 * q[0] * q[0]];
    let mut uses = Vec::new();
    for i in 0..4 {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let mut middle = at([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
        middle[2] = 50.0 * a[0] * b[0];
        s.vertices.push(Vec3::from(at(a)));
        let curve = ShellCurve::Spline(Curve { knots: knots(2), control: vec![at(a), middle, at(b)] });
        s.edges.push(ShellEdge { start: first + i, end: first + (i + 1) % 4, curve });
        let trim = Curve::new(1, vec![0., 0., 1., 1.], vec![a, b]).ok();
        uses.push(EdgeUse { edge: first + i, forward: true, trim });
    }
    uses
}

#[test]
fn a_trimmed_panel_keeps_its_numbers() {
    let surface = parabola();
    let mut s = Shell { name: "A-01 'Bügel'".into(), ..Shell::default() };
    let outer = ring(&mut s, [[0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
    let hole = ring(&mut s, [[0.3, 0.4], [0.3, 0.7], [0.6, 0.7], [0.6, 0.4]]);
    let extrusion = ShellSurface::Spline { surface: surface.clone(), form: SurfaceForm::Extrusion };
    s.faces.push(ShellFace { name: String::new(), surface: extrusion, reversed: false, loops: vec![outer, hole] });
    let m = model(&write::shells(&header(), &[s.clone()]).expect("written"));
    assert_eq!((m.faces.len(), m.skipped.len(), m.unit.as_str()), (1, 0, "millimetre"));
    let f = &m.faces[0];
    assert_eq!((f.name.as_str(), f.part.as_str(), f.reversed), ("A-01 'Bügel'", "Panels", false));
    assert_eq!(f.surface, surface);
    assert!(crate::certify::trims::trim_proof(f, 1e-9).bound().value() < 1e-9);
    // Turned over, loops and normal go with the face.
    let face = &mut s.faces[0];
    face.reversed = true;
    for l in &mut face.loops {
        l.reverse();
        l.iter_mut().for_each(|u| u.forward = false);
    }
    let turned = model(&write::shells(&header(), &[s]).expect("written"));
    assert!(near(area(&turned.faces), area(&m.faces)));
    assert!((normal(f) + normal(&turned.faces[0])).norm() < 1e-12);
}

/// A pipe of four quarters; its last ruling is off its first by `slit` shares of the radius.
fn pipe(radius: f64, height: f64, slit: f64) -> Surface {
    let w = 0.5f64.sqrt();
    let around = [(1., 0.), (1., 1.), (0., 1.), (-1., 1.), (-1., 0.), (-1., -1.), (0., -1.), (1., -1.), (1., -slit)];
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (k, (x, y)) in around.into_iter().enumerate() {
        points.extend([0.0, height].map(|z| Vec3::new(radius * x, radius * y, z)));
        weights.extend([if k % 2 == 0 { 1.0 } else { w }; 2]);
    }
    let quarters = Knots::new(2, vec![0., 0., 0., 1., 1., 2., 2., 3., 3., 4., 4., 4.], 9).expect("knots");
    Surface::new(quarters, knots(1), &points, Some(&weights)).expect("a pipe")
}

/// What closes is one edge, used twice by trims of its kind; what is slit by ever so little keeps both.
#[test]
fn a_pipe_that_closes_has_one_seam() {
    let wanted = std::f64::consts::TAU * 50.0 * 80.0;
    for (slit, edges, vertices) in [(0.0, 3, 2), (1e-10, 4, 4), (1e-5, 4, 4)] {
        let mut s = Shell::untrimmed("pipe", &pipe(50.0, 80.0, slit));
        // Straight curves in the parameter plane, then such as waver by less than the program sees.
        for hair in [0.0, 1e-8] {
            for (e, u) in [(1, 4.0), (3, 0.0)] {
                let control = vec![[u, 0.0], [u + hair, 0.3], [u - hair, 0.6], [u, 1.0]];
                s.faces[0].loops[0][e].trim = Some(Curve { knots: knots(3), control });
            }
            let joined = write::seams_of(&s).expect("joined");
            assert_eq!((joined.edges.len(), joined.vertices.len()), (edges, vertices), "{slit:e} {hair:e}");
            let uses = &joined.faces[0].loops[0];
            assert_eq!(uses[1].edge == uses[3].edge, edges == 3, "{slit:e} {hair:e}");
            assert_ne!(uses[1].forward, uses[3].forward);
            let m = model(&write::shells(&header(), &[s.clone()]).expect("written"));
            assert_eq!((m.faces.len(), m.skipped.len()), (1, 0));
            assert!((area(&m.faces) / wanted - 1.0).abs() < 1e-4, "{slit:e} {hair:e} {}", area(&m.faces));
        }
    }
}

/// A pipe whose two ends nearly meet: which of both an edge runs along is told by its curve in the parameter plane.
#[test]
fn a_pipe_slit_along_one_ruling() {
    let (radius, height) = (50.0, 80.0);
    let pipe = pipe(radius, height, 1e-5);
    let m = model(&write::shells(&header(), &[Shell::untrimmed("pipe", &pipe)]).expect("written"));
    assert_eq!((m.faces.len(), m.skipped.len()), (1, 0));
    assert!((area(&m.faces) / (std::f64::consts::TAU * radius * height) - 1.0).abs() < 1e-4, "{}", area(&m.faces));
    assert!(crate::certify::trims::trim_proof(&m.faces[0], 1e-6).bound().value() < 1e-2);
}

#[test]
fn a_strip_that_ends_in_a_point_and_a_plane_one() {
    let r = 0.5f64.sqrt();
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (x, y, w) in [(1.0, 0.0, 1.0), (1.0, 1.0, r), (0.0, 1.0, 1.0)] {
        points.extend([Vec3::new(0., 0., 100.), Vec3::new(50.0 * x, 50.0 * y, 0.)]);
        weights.extend([w, w]);
    }
    let cone = Surface::new(knots(2), knots(1), &points, Some(&weights)).expect("cone");
    let mut s = Shell::untrimmed("cone", &cone);
    // The side v = 0 is the apex: no edge, one vertex.
    s.faces[0].loops[0].retain(|u| u.edge != 0);
    s.faces[0].loops[0].iter_mut().for_each(|u| u.edge -= 1);
    s.edges.remove(0);
    s.edges.iter_mut().flat_map(|e| [&mut e.start, &mut e.end]).filter(|v| **v == 1).for_each(|v| *v = 0);
    let frame = Frame { origin: Vec3::new(10., 0., 200.), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() };
    let corners = [(0., 0.), (30., 0.), (30., 20.), (5., 25.)];
    let plane = Shell {
        name: "plane".into(),
        vertices: corners.iter().map(|c| frame.to_world(&Vec3::new(c.0, c.1, 0.))).collect(),
        edges: (0..4).map(|i| ShellEdge { start: i, end: (i + 1) % 4, curve: ShellCurve::Line }).collect(),
        faces: vec![ShellFace {
            name: String::new(),
            surface: ShellSurface::Plane(frame),
            reversed: false,
            loops: vec![(0..4).map(|edge| EdgeUse { edge, forward: true, trim: None }).collect()],
        }],
    };
    let m = model(&write::shells(&header(), &[s, plane]).expect("written"));
    assert_eq!((m.faces.len(), m.skipped.len()), (2, 0));
    let lateral = 0.25 * std::f64::consts::PI * 50.0 * 50f64.hypot(100.0);
    assert!((area(&m.faces[..1]) / lateral - 1.0).abs() < 1e-5);
    assert!(near(area(&m.faces[1..]), 625.0));
}

#[test]
fn what_cannot_be_written_is_an_error() {
    let mut s = Shell::untrimmed("A", &parabola());
    s.faces[0].loops[0][1].edge = 99;
    let error = write::shells(&header(), &[s.clone()]).expect_err("refused");
    assert!(error.to_string().contains("no edge 99"), "{error}");
    s = Shell::untrimmed("A", &parabola());
    s.faces[0].surface = ShellSurface::Cylinder { frame: Frame::world(), radius: 1.0 };
    let error = write::shells(&header(), &[s.clone()]).expect_err("refused");
    assert!(error.to_string().contains("cylinder"), "{error}");
    s = Shell::untrimmed("A", &parabola());
    s.edges[0].end = 77;
    assert!(write::shells(&header(), &[s]).is_err());
    assert!(read(&write::shells(&header(), &[]).expect("an archive")).is_err());
}
