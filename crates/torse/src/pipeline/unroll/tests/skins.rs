//! Panels in space of what is laid flat: as large as the faces, up to the apex.

use super::super::{unroll, UnrollOptions};
use super::{model_of, near, over_parabola, TOLERANCE};
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::certify::claim::Status;
use crate::control::Control;
use crate::develop::map::Development;
use crate::develop::outline::FlatCoedge;
use crate::develop::unfold::specimens::{round_surface, BentSheet, Stretch};
use crate::geom::Vec3;
use crate::tessellate::panel::panel_mesh;
use std::f64::consts::PI;

fn answered(faces: Vec<Face>, tolerance: f64) -> Answer {
    let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(tolerance) };
    unroll(&model_of(faces), &options, &Control::default()).expect("an answer")
}

/// Area (mm²) within the trimming curves of all panels.
fn area(answer: &Answer) -> f64 {
    let of = |panel: &crate::patchwork::panel::Panel| {
        let patch = &panel.strip.patch;
        let map = Development::new(patch, 1.0).expect("a map");
        let runs = panel.loops().iter().flatten().map(|r| FlatCoedge::new(&map, patch, r).area_in_space(patch));
        runs.sum::<f64>().abs()
    };
    answer.patchwork.panels.iter().map(of).sum()
}

/// The share of what pictures show, which are made of triangles.
fn shown(answer: &Answer) -> f64 {
    let all = (0..answer.patchwork.panels.len()).map(|k| {
        let mesh = panel_mesh(&answer.patchwork, k);
        assert!(!mesh.triangles.is_empty() && mesh.values.iter().all(|v| v.abs() < 1e-6), "panel {k}");
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        mesh.triangles.iter().map(of).sum::<f64>()
    });
    all.sum::<f64>() / area(answer)
}

#[test]
fn panels_are_as_large_as_their_faces_up_to_the_apex() {
    // What a cone of radius 20 and height 40 needs to end in its apex, and one that ends before it.
    let (radius, h) = (20.0, 40.0);
    for (slope, wanted) in [
        (0.0, 2.0 * PI * radius * h),
        (0.3, PI * h * 1.09_f64.sqrt() * (2.0 * radius + 0.3 * h)),
        (-radius / h, PI * radius * radius.hypot(h)),
    ] {
        let answer = answered(vec![round_surface(radius, slope, (0.0, h))], TOLERANCE);
        assert_eq!(answer.status(), Status::Certified);
        assert_eq!((answer.patchwork.faces.len(), answer.patchwork.panels.len()), (1, 1), "slope {slope}");
        let found = area(&answer);
        assert!((found - wanted).abs() < 1e-7 * wanted, "slope {slope}: {found} {wanted}");
        assert!((shown(&answer) - 1.0).abs() < 2e-3, "slope {slope}: {}", shown(&answer));
    }
}

#[test]
fn panels_follow_the_edges_of_holes() {
    for bytes in [
        &include_bytes!("../../../../../../data/cylinder_holes.step")[..],
        &include_bytes!("../../../../../../data/cone_holes.step")[..],
    ] {
        let faces = crate::read(bytes).expect("a face").faces;
        // The flat part keeps the area, as near as it is drawn.
        let answer = answered(faces, 1e-4);
        let (found, flat) = (area(&answer), answer.patterns[0].area);
        assert!((found - flat).abs() < 1e-7 * flat, "{found} {flat}");
    }
}

#[test]
fn every_kind_of_ruled_face_has_its_panel() {
    let apex = Vec3::new(40.0, 130.0, 10.0);
    for face in [
        over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0)),
        over_parabola(|p| p + (apex - p) * 0.6),
        over_parabola(|_| apex),
    ] {
        for turned in [false, true] {
            let surface = if turned { face.surface.transposed() } else { face.surface.clone() };
            let mut face = Face::untrimmed(surface);
            face.reversed = turned;
            let wanted = crate::brep::area::area_estimate(&face);
            let answer = answered(vec![face], TOLERANCE);
            assert_eq!((answer.patchwork.panels.len(), answer.notes.len()), (1, 0), "{:?}", answer.notes);
            assert!((area(&answer) - wanted).abs() < 1e-5 * wanted, "{} {wanted}", area(&answer));
            near(answer.patchwork.panels[0].face().map_or(9.0, |f| f as f64), 0.0);
        }
    }
}

/// A solid whose faces all look inwards is the same sheet.
#[test]
fn a_solid_that_is_inside_out_is_laid_flat_all_the_same() {
    let stretches = [Stretch::Line(40.0), Stretch::Bend(1.0, 3.0), Stretch::Line(20.0)];
    let mut faces = BentSheet::new(2.0, &stretches, &[0.0, 9.0], &[]).faces();
    let right = super::only(&faces, super::flat(&faces, 0.44));
    faces.iter_mut().for_each(|f| f.reversed = !f.reversed);
    let turned = super::only(&faces, super::flat(&faces, 0.44));
    assert!((turned.pattern.area - right.pattern.area).abs() < 1e-9 * right.pattern.area);
    assert!(turned.sheet.turned.iter().all(|t| *t) && !right.sheet.turned.iter().any(|t| *t));
}
