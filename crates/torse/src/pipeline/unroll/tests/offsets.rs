//! The sides of the sheet that surfaces were given, as files that are read back.

use super::{model_of, over_parabola};
use crate::answer::note::{Note, ShopNote};
use crate::answer::shop::OffsetSide;
use crate::answer::Answer;
use crate::brep::area::area_estimate;
use crate::brep::face::Face;
use crate::control::Control;
use crate::develop::shop::thickness::{Sheet, SheetSide};
use crate::develop::unfold::allowance::KFactor;
use crate::develop::unfold::specimens::{quarter, rectangle};
use crate::geom::Vec3;
use crate::pipeline::deliver::files;
use crate::pipeline::unroll::{unroll, UnrollOptions};
use crate::pipeline::workshop::{prepare, WorkshopOptions};
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

const THICKNESS: f64 = 4.0;
const K: f64 = 0.42;

/// The answer for surfaces of a sheet with its sides, and its files.
fn made(faces: Vec<Face>, thickness: f64, side: SheetSide) -> (Answer, HashMap<String, Vec<u8>>) {
    let k = KFactor::Ansi(K);
    let sheet = Some(Sheet { thickness, side, k: k.clone() });
    let options = UnrollOptions { surfaces: true, sheet, ..UnrollOptions::new(0.01) };
    let mut answer = unroll(&model_of(faces), &options, &Control::default()).expect("an answer");
    let asked =
        WorkshopOptions { thickness: Some(thickness), side, k: Some(k), offsets: true, ..WorkshopOptions::default() };
    prepare(&mut answer, &asked).expect("its work");
    let files = files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    (answer, files)
}

#[test]
fn sides_of_a_sheet_are_the_panels_at_its_distances() {
    for (side, radii) in [
        (SheetSide::Inside, [50.0, 50.0 + K * THICKNESS, 54.0]),
        (SheetSide::Middle, [48.0, 48.0 + K * THICKNESS, 52.0]),
        (SheetSide::Outside, [46.0, 46.0 + K * THICKNESS, 50.0]),
    ] {
        let cylinder = quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0);
        let (_, files) = made(vec![cylinder], THICKNESS, side);
        for (of, radius) in OffsetSide::ALL.into_iter().zip(radii) {
            let model = crate::read(&files[of.file()]).expect("a file that can be read");
            let [face] = model.faces.as_slice() else { panic!("one face") };
            let area = radius * FRAC_PI_2 * 30.0;
            assert!((area_estimate(face) - area).abs() < 1e-5 * area, "{side:?} {of:?} {} {area}", area_estimate(face));
        }
    }
}

#[test]
fn offsets_of_other_panels_are_read_as_offsets_of_their_patches() {
    let curved = over_parabola(|p| p + Vec3::new(10.0, 90.0, 5.0));
    let flange = rectangle(Vec3::new(0.0, 200.0, 0.0), 40.0 * Vec3::x(), 30.0 * Vec3::y());
    let (answer, files) = made(vec![curved, flange], THICKNESS, SheetSide::Middle);
    for (side, distance) in [(OffsetSide::Inside, 2.0), (OffsetSide::Outside, 2.0)] {
        let model = crate::read(&files[side.file()]).expect("a file that can be read");
        assert_eq!(model.faces.len(), answer.patchwork.panels.len());
        for (face, panel) in model.faces.iter().zip(&answer.patchwork.panels) {
            let patch = &panel.strip.patch;
            let ((u0, u1), (v0, v1)) = face.surface.domain();
            for [s, t] in [[0.2, 0.3], [0.5, 0.5], [0.9, 0.7]] {
                let p = face.surface.point(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
                let off = nearest(patch, &p);
                assert!((off - distance).abs() < 1e-4, "{side:?} {off}");
            }
        }
    }
}

/// Distance of a point from a patch.
fn nearest(patch: &crate::spline::surface::Surface, p: &Vec3) -> f64 {
    let found = crate::brep::project::SurfaceProjector::new(patch).nearest(patch, p).at;
    (patch.point(found[0], found[1]) - p).norm()
}

#[test]
fn sides_without_room_are_named_with_their_place() {
    let cylinder = quarter(Vec3::zeros(), Vec3::z(), 50.0 * Vec3::x(), 30.0);
    let (answer, files) = made(vec![cylinder], 60.0, SheetSide::Outside);
    assert!(!files.contains_key(OffsetSide::Inside.file()) && files.contains_key(OffsetSide::Outside.file()));
    let told = answer.notes.iter().find_map(|n| match n {
        Note::Shop(ShopNote::NoOffset { side: OffsetSide::Inside, none, .. }) => Some(*none),
        _ => None,
    });
    let none = told.expect("a note");
    assert!((none.radius - 50.0).abs() < 1e-6 && (none.at.x.hypot(none.at.y) - 50.0).abs() < 1e-6, "{none:?}");
}
