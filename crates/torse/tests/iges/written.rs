//! What is written is read back.

use super::{has_area, model};
use torse::geom::Vec3;
use torse::io::iges::{read, write};
use torse::io::step::write::Header;
use torse::patchwork::panel::{Border, Coedge, Panel, PanelForm, PanelTrim, Patchwork};
use torse::spline::curve::Curve;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::form::{DualTorse, PanelKind, Torse};
use torse::torse::strip::Strip;

fn header() -> Header {
    Header { name: "hull".into(), time: "2026-01-31T12:00:00".into(), uncertainty: 1e-6 }
}

fn knots(degree: usize) -> Knots {
    Knots::clamped(degree, &[0.0, 1.0]).expect("knots")
}

/// Parabolic cylinder (100 t, 200 r, 50 t²).
fn patch() -> Surface {
    let points: Vec<Vec3> = [(0.0, 0.0), (50.0, 0.0), (100.0, 50.0)]
        .iter()
        .flat_map(|&(x, z)| [Vec3::new(x, 0.0, z), Vec3::new(x, 200.0, z)])
        .collect();
    Surface::new(knots(2), knots(1), &points, None).expect("patch")
}

/// A panel of that patch with a hole; with `mirrored` its loops run the other way round.
fn panel(mirrored: bool) -> Panel {
    let side = |a: [f64; 2], b: [f64; 2]| {
        let at = |t: f64, r: f64| [100.0 * t, 200.0 * r, 50.0 * t * t];
        let mut middle = at(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
        middle[2] = 50.0 * a[0] * b[0];
        Coedge {
            border: Border::Trim { edge: 0 },
            vertices: Vec::new(),
            parameters: Vec::new(),
            trim: Curve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![a, b]).expect("trim"),
            edge: Curve { knots: knots(2), control: vec![at(a[0], a[1]), middle, at(b[0], b[1])] },
        }
    };
    let ring = |mut c: Vec<[f64; 2]>| -> Vec<Coedge> {
        if mirrored {
            c.reverse();
        }
        (0..c.len()).map(|i| side(c[i], c[(i + 1) % c.len()])).collect()
    };
    let planes = Curve { knots: knots(1), control: vec![[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 1.0, -50.0]] };
    Panel {
        strip: Strip {
            name: "A-01, a long name with commas; and more of it than one line holds".into(),
            kind: PanelKind::Cylinder,
            patch: patch(),
        },
        trim: Some(PanelTrim {
            face: 0,
            label: 0,
            form: PanelForm::Torse(Torse::Dual(DualTorse { planes })),
            loops: vec![
                ring(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
                ring(vec![[0.3, 0.4], [0.3, 0.7], [0.6, 0.7], [0.6, 0.4]]),
            ],
        }),
        outline: Vec::new(),
    }
}

/// Length of (100 t, 50 t²) between two parameters.
fn length(a: f64, b: f64) -> f64 {
    let at = |t: f64| 50.0 * (t * (1.0 + t * t).sqrt() + t.asinh());
    at(b) - at(a)
}

#[test]
fn panels_with_holes_come_back_bit_for_bit() {
    for mirrored in [false, true] {
        let patchwork = Patchwork { panels: vec![panel(mirrored)], ..Patchwork::default() };
        let bytes = write::panels(&header(), &patchwork, &[]);
        assert!(bytes.split(|b| *b == b'\n').all(|l| l.len() == 80 || l.is_empty()));
        let m = read::read(&bytes).expect("a model");
        assert!(m.skipped.is_empty() && m.faces.len() == 1 && m.unit == "millimetre");
        let face = &m.faces[0];
        assert_eq!(face.name, patchwork.panels[0].strip.name);
        assert_eq!((face.loops.len(), face.reversed), (2, false));
        let surface = if mirrored { face.surface.transposed() } else { face.surface.clone() };
        assert_eq!(surface.control, patch().control);
        has_area(face, 200.0 * (length(0.0, 1.0) - 0.3 * length(0.3, 0.6)));
    }
}

#[test]
fn strips_come_back_and_marked_ones_say_so() {
    let strip = |name: &str| Strip { name: name.into(), kind: PanelKind::Cylinder, patch: patch() };
    let mut pointed = strip("B");
    // A cone: all rulings meet in one point.
    (0..3).for_each(|i| pointed.patch.control[2 * i + 1] = [50.0, 200.0, 90.0, 1.0]);
    let weights = [1.0, 1.0, 0.7, 0.7, 1.0, 1.0];
    let mut rational = strip("C");
    for (h, w) in rational.patch.control.iter_mut().zip(weights) {
        *h = [h[0] * w, h[1] * w, h[2] * w, w];
    }
    rational.patch.rational = true;
    let patchwork = Patchwork::of_strips(vec![strip("A"), pointed, rational]);
    let bytes = write::panels(&header(), &patchwork, &[false, true, false]);
    let m = read::read(&bytes).expect("a model");
    assert!(m.skipped.is_empty(), "{:?}", m.skipped);
    let names: Vec<&str> = m.faces.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["A", "B NOT CERTIFIED", "C"]);
    has_area(&m.faces[0], 200.0 * length(0.0, 1.0));
    for (face, p) in m.faces.iter().zip(&patchwork.panels) {
        let worst = face.surface.control.iter().zip(&p.strip.patch.control);
        let worst =
            worst.flat_map(|(a, b)| (0..4).map(|d| (a[d] - b[d]).abs()).collect::<Vec<_>>()).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{}: {worst}", face.name);
        assert!(face.surface.rational == p.strip.patch.rational);
    }
    let _ = model;
}
