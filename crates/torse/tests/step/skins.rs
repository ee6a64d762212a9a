//! Sheets that are drawn as bodies: their skins, and what is no sheet.

use super::text::{Step, Unit, P};
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;
use torse::answer::note::Note;
use torse::develop::unfold::allowance::KFactor;
use torse::io::model::Model;
use torse::io::step::read::read;
use torse::pipeline::deliver::files;
use torse::pipeline::refold::refold;
use torse::pipeline::select::{offers, selected, SelectError, Selection, Skin};
use torse::{Control, Status, UnrollOptions};

/// A body of plane faces: outward normals with corners.
fn body(sides: &[(P, Vec<P>)]) -> Model {
    let mut s = Step::new(Unit::Millimetre);
    for (normal, corners) in sides {
        let l = s.polygon(corners);
        let plane = s.plane(corners[0], *normal);
        s.face("", plane, &[(l, true)], true);
    }
    read(s.text().as_bytes()).expect("a model")
}

/// A block between two corners of a box, each face with its outward normal.
fn block([x, y, z]: P) -> Model {
    body(&[
        ([0., 0., -1.], vec![[0., 0., 0.], [0., y, 0.], [x, y, 0.], [x, 0., 0.]]),
        ([0., 0., 1.], vec![[0., 0., z], [x, 0., z], [x, y, z], [0., y, z]]),
        ([0., -1., 0.], vec![[0., 0., 0.], [x, 0., 0.], [x, 0., z], [0., 0., z]]),
        ([0., 1., 0.], vec![[0., y, 0.], [0., y, z], [x, y, z], [x, y, 0.]]),
        ([-1., 0., 0.], vec![[0., 0., 0.], [0., 0., z], [0., y, z], [0., y, 0.]]),
        ([1., 0., 0.], vec![[x, 0., 0.], [x, y, 0.], [x, y, z], [x, 0., z]]),
    ])
}

/// A base of 40 by 60 mm with a flange up and one down, 40 mm wide and high, of 3 mm and with sharp corners: flush with the ends of
/// the base, so that their outer faces are one with these.
fn bent_both_ways() -> Model {
    let at = |z: f64, xy: &[[f64; 2]]| xy.iter().map(|p| [p[0], p[1], z]).collect::<Vec<P>>();
    let end = |x: f64, yz: &[[f64; 2]]| yz.iter().map(|p| [x, p[0], p[1]]).collect::<Vec<P>>();
    let side = |y: f64, xz: &[[f64; 2]]| xz.iter().map(|p| [p[0], y, p[1]]).collect::<Vec<P>>();
    let notched = [[0., 0.], [40., 0.], [40., 10.], [37., 10.], [37., 50.], [40., 50.], [40., 60.], [0., 60.]];
    let below = [[0., 0.], [0., 10.], [3., 10.], [3., 50.], [0., 50.], [0., 60.], [40., 60.], [40., 0.]];
    let up = [[0., 0.], [60., 0.], [60., 3.], [50., 3.], [50., 43.], [10., 43.], [10., 3.], [0., 3.]];
    let down = [[0., 3.], [60., 3.], [60., 0.], [50., 0.], [50., -40.], [10., -40.], [10., 0.], [0., 0.]];
    body(&[
        ([0., 0., 1.], at(3., &notched)),
        ([0., 0., -1.], at(0., &below)),
        ([1., 0., 0.], end(40., &up)),
        ([-1., 0., 0.], end(0., &down)),
        ([0., -1., 0.], side(0., &[[0., 0.], [40., 0.], [40., 3.], [0., 3.]])),
        ([0., 1., 0.], side(60., &[[0., 0.], [0., 3.], [40., 3.], [40., 0.]])),
        ([-1., 0., 0.], end(37., &[[10., 3.], [10., 43.], [50., 43.], [50., 3.]])),
        ([0., -1., 0.], side(10., &[[37., 3.], [40., 3.], [40., 43.], [37., 43.]])),
        ([0., 1., 0.], side(50., &[[37., 3.], [37., 43.], [40., 43.], [40., 3.]])),
        ([0., 0., 1.], at(43., &[[37., 10.], [40., 10.], [40., 50.], [37., 50.]])),
        ([1., 0., 0.], end(3., &[[10., -40.], [50., -40.], [50., 0.], [10., 0.]])),
        ([0., -1., 0.], side(10., &[[0., -40.], [3., -40.], [3., 0.], [0., 0.]])),
        ([0., 1., 0.], side(50., &[[0., -40.], [0., 0.], [3., 0.], [3., -40.]])),
        ([0., 0., -1.], at(-40., &[[0., 10.], [0., 50.], [3., 50.], [3., 10.]])),
    ])
}

/// Neither skin goes round both of its corners, so one flange is missing whichever is laid flat.
#[test]
fn a_flange_that_neither_skin_reaches_is_named() {
    let sheet = bent_both_ways();
    let flat = torse::unroll(&sheet, &UnrollOptions::new(0.01), &Control::default()).expect("parts");
    let area: f64 = flat.patterns().iter().map(|p| p.area).sum();
    let whole = 40.0 * 60.0 + 2.0 * 40.0 * 40.0;
    assert!((0.5 * whole..0.9 * whole).contains(&area), "{area} of {whole}");
    assert!(flat.status() != Status::Certified && !flat.skipped.is_empty(), "{:?}", flat.claims());
}

/// A profile of a flange down, a base and a flange up, 20, 40 and 20 mm outside, of 3 mm and with sharp corners, 60 mm wide.
fn sharp_step() -> Model {
    let z = [[0., -17.], [3., -17.], [3., 0.], [40., 0.], [40., 20.], [37., 20.], [37., 3.], [0., 3.]];
    let at = |y: f64, p: &[f64; 2]| [p[0], y, p[1]];
    let mut sides = vec![
        ([0., -1., 0.], z.iter().map(|p| at(0., p)).collect()),
        ([0., 1., 0.], z.iter().rev().map(|p| at(60., p)).collect::<Vec<P>>()),
    ];
    for k in 0..z.len() {
        let [p, q] = [z[k], z[(k + 1) % z.len()]];
        let length = (q[0] - p[0]).hypot(q[1] - p[1]);
        let normal = [(q[1] - p[1]) / length, 0., (p[0] - q[0]) / length];
        sides.push((normal, vec![at(0., &q), at(0., &p), at(60., &p), at(60., &q)]));
    }
    body(&sides)
}

/// Outside a sharp bend both faces reach to its edge: they overlap in the plane by what the bend does not take, and are one sheet.
#[test]
fn short_flanges_beyond_sharp_bends_stay_with_their_sheet() {
    let options = UnrollOptions { k: KFactor::Ansi(0.44), ..UnrollOptions::new(0.01) };
    let flat = torse::unroll(&sharp_step(), &options, &Control::default()).expect("parts");
    assert_eq!((flat.patterns().len(), flat.status()), (1, Status::Certified), "{:?}", flat.claims());
    let length = 17.0 + 34.0 + 17.0 + 2.0 * 0.44 * 3.0 * FRAC_PI_2;
    assert!((flat.patterns()[0].length - length).abs() < 1e-6, "{} {length}", flat.patterns()[0].length);
    // The outline goes around once, and nowhere back.
    let v = &flat.patterns()[0].contours[0].vertices;
    let around: f64 = (0..v.len()).map(|k| (v[(k + 1) % v.len()].point - v[k].point).norm()).sum();
    assert!((around - 2.0 * (length + 60.0)).abs() < 1e-6, "{around}");
    // Bent back, its flanges reach to their edges.
    let mut flat = flat;
    let files: HashMap<String, Vec<u8>> = files(&mut flat, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let back = refold(&|name| files.get(name).cloned(), None, &torse::Control::default()).expect("an answer").report();
    assert!(back.parts[0].distance_bound.is_some_and(|d| d < 1e-3), "{:?}", back.parts);
}

/// A tray: a base of 100 by 100 mm and flanges on its four sides that begin 10 mm from the corners, of 2 mm and with sharp corners.
fn tray() -> Model {
    let (w, t, m) = (100., 2., 10.);
    let mut sides = vec![([0., 0., -1.], vec![[0., 0., 0.], [0., w, 0.], [w, w, 0.], [w, 0., 0.]])];
    let mut top: Vec<P> = Vec::new();
    for k in 0..4 {
        let h = 30. + 5. * f64::from(k);
        // About the middle of the base by quarters of a turn.
        let turned = |p: P| (0..k).fold(p, |[x, y, z], _| [w - y, x, z]);
        let mut side = |normal: P, corners: &[P]| {
            let normal = (0..k).fold(normal, |[x, y, z], _| [-y, x, z]);
            sides.push((normal, corners.iter().map(|p| turned(*p)).collect()));
        };
        let e = w - m;
        let front = [[0., 0.], [w, 0.], [w, t], [e, t], [e, h], [m, h], [m, t], [0., t]];
        side([0., -1., 0.], &front.map(|[x, z]| [x, 0., z]));
        side([0., 1., 0.], &[[m, t, t], [m, t, h], [e, t, h], [e, t, t]]);
        side([-1., 0., 0.], &[[m, 0., t], [m, 0., h], [m, t, h], [m, t, t]]);
        side([1., 0., 0.], &[[e, 0., t], [e, t, t], [e, t, h], [e, 0., h]]);
        side([0., 0., 1.], &[[m, 0., h], [e, 0., h], [e, t, h], [m, t, h]]);
        top.extend([[0., 0., t], [m, 0., t], [m, t, t], [e, t, t], [e, 0., t]].map(turned));
    }
    sides.push(([0., 0., 1.], top));
    body(&sides)
}

/// Without relief at the corners the outline runs along itself where a flange is cut off the base.
#[test]
fn flanges_without_relief_are_bent_back_along_their_slits() {
    let options = UnrollOptions { k: KFactor::Ansi(0.44), ..UnrollOptions::new(0.01) };
    let mut flat = torse::unroll(&tray(), &options, &Control::default()).expect("parts");
    assert_eq!((flat.patterns().len(), flat.status()), (1, Status::Certified), "{:?}", flat.claims());
    let files: HashMap<String, Vec<u8>> = files(&mut flat, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let back = refold(&|name| files.get(name).cloned(), None, &torse::Control::default()).expect("an answer").report();
    assert!(back.left.is_empty() && back.parts[0].panels.len() == 5, "{back:?}");
    assert!(back.parts[0].distance_bound.is_some_and(|d| d < 1e-3), "{back:?}");
}

fn skin(skin: Skin) -> Selection {
    Selection { skin: Some(skin), ..Selection::default() }
}

#[test]
fn a_plate_has_two_skins_and_each_can_be_had_alone() {
    let plate = block([200.0, 120.0, 2.0]);
    assert_eq!(plate.faces.len(), 6);
    let middle = |m: &Model| m.faces[0].surface.bbox().min.z;
    let (outer, inner) = (selected(plate.clone(), &skin(Skin::Outer)), selected(plate.clone(), &skin(Skin::Inner)));
    let (outer, inner) = (outer.expect("a skin"), inner.expect("a skin"));
    assert_eq!((outer.faces.len(), inner.faces.len()), (1, 1));
    assert!((middle(&outer) - middle(&inner)).abs() > 1.99);
    // Without a choice everything is covered, and the choice is offered.
    let whole = selected(plate, &Selection::default()).expect("a model");
    let offered = offers(&whole);
    assert_eq!((whole.faces.len(), offered.len()), (6, 1));
    let Note::BothSkins { thickness, faces, .. } = &offered[0] else { panic!("{offered:?}") };
    assert!((thickness - 2.0).abs() < 1e-3 && faces.iter().sum::<usize>() == 6, "{offered:?}");
}

/// What is laid flat as a sheet has skins, also where faces of narrow flanges belong to one and bound the other.
#[test]
fn bodies_with_narrow_flanges_have_two_skins() {
    for (model, count) in [(bent_both_ways(), 3), (tray(), 5)] {
        for side in [Skin::Outer, Skin::Inner] {
            let one = selected(model.clone(), &skin(side)).expect("a skin");
            assert_eq!(one.faces.len(), count, "{side:?} {:?}", one.notes);
        }
    }
}

#[test]
fn a_block_is_no_sheet() {
    let e = selected(block([100.0, 100.0, 90.0]), &skin(Skin::Outer)).expect_err("no sheet");
    assert!(matches!(e, SelectError::NoSheet { bodies: 1 }), "{e}");
}
