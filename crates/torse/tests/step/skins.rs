//! Sheets that are drawn as bodies: their skins, and what is no sheet.

use super::text::{Step, Unit, P};
use torse::answer::note::Note;
use torse::io::model::Model;
use torse::io::step::read::read;
use torse::pipeline::select::{offers, selected, SelectError, Selection, Skin};

/// A block between two corners of a box, each face with its outward normal.
fn block(size: P) -> Model {
    let mut s = Step::new(Unit::Millimetre);
    let [x, y, z] = size;
    let sides: [(P, [P; 4]); 6] = [
        ([0., 0., -1.], [[0., 0., 0.], [0., y, 0.], [x, y, 0.], [x, 0., 0.]]),
        ([0., 0., 1.], [[0., 0., z], [x, 0., z], [x, y, z], [0., y, z]]),
        ([0., -1., 0.], [[0., 0., 0.], [x, 0., 0.], [x, 0., z], [0., 0., z]]),
        ([0., 1., 0.], [[0., y, 0.], [0., y, z], [x, y, z], [x, y, 0.]]),
        ([-1., 0., 0.], [[0., 0., 0.], [0., 0., z], [0., y, z], [0., y, 0.]]),
        ([1., 0., 0.], [[x, 0., 0.], [x, y, 0.], [x, y, z], [x, 0., z]]),
    ];
    for (normal, corners) in sides {
        let l = s.polygon(&corners);
        let plane = s.plane(corners[0], normal);
        s.face("", plane, &[(l, true)], true);
    }
    read(s.text().as_bytes()).expect("a model")
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

#[test]
fn a_block_is_no_sheet() {
    let e = selected(block([100.0, 100.0, 90.0]), &skin(Skin::Outer)).expect_err("no sheet");
    assert!(matches!(e, SelectError::NoSheet { bodies: 1 }), "{e}");
}
