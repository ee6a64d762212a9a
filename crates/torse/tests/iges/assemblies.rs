//! Parts, copies, groups and names.

use super::file::{entry, Entry, File};
use super::{area, model};
use torse::io::iges::read;
use torse::io::words;
use torse::io::words::why;

const PART: &str = "00010000";

#[test]
fn copies_of_a_part_are_placed_scaled_and_named() {
    let mut f = File::new();
    f.units = "1.0,10,2HCM".into();
    let s = f.rectangle(Entry { status: PART, ..entry(128) }, 3.0, 2.0);
    let part = f.add(entry(308), &format!("0,4Hwing,1,{s}"));
    f.add(entry(408), &format!("{part},10.,0.,0."));
    let turn = f.add(entry(124), "0.,-1.,0.,0.,1.,0.,0.,0.,0.,0.,1.,7.");
    f.add(Entry { matrix: turn, ..entry(408) }, &format!("{part},1.,0.,0.,2."));
    let m = model(&f);
    assert_eq!(m.faces.len(), 2);
    assert!(m.faces.iter().all(|f| f.part == "wing") && m.products.contains(&"wing".to_string()));
    assert!((area(&m.faces[0]) - 600.0).abs() < 1e-9 && (area(&m.faces[1]) - 2400.0).abs() < 1e-9);
    let corner = |k: usize| m.faces[k].surface.point(1.0, 0.0);
    // (3, 0) doubled and moved by 1 is (7, 0), turned (0, 7), lifted by 7; centimetres.
    assert!((corner(0) - torse::geom::Vec3::new(130.0, 0.0, 0.0)).norm() < 1e-9);
    assert!((corner(1) - torse::geom::Vec3::new(0.0, 70.0, 70.0)).norm() < 1e-9);
    assert_ne!(m.faces[0].body, m.faces[1].body);
    // Of the order of shift and turn programs think differently.
    assert_eq!(
        m.notes.iter().filter(|n| words::note(n).contains("both shifted and turned, D9 first: 1")).count(),
        1,
        "{:?}",
        m.notes
    );
}

#[test]
fn networks_are_copied_like_other_parts() {
    let mut f = File::new();
    let s = f.rectangle(Entry { status: PART, ..entry(128) }, 3.0, 2.0);
    let part = f.add(entry(320), &format!("0,4Hcomb,1,{s},0,0H,0"));
    f.add(entry(420), &format!("{part},10.,20.,30.,1.,1.,1."));
    f.add(entry(420), &format!("{part},-40.,0.,30.,2."));
    let m = model(&f);
    let mut x: Vec<f64> = m.faces.iter().map(|f| f.surface.point(0.0, 0.0).x).collect();
    x.sort_by(f64::total_cmp);
    assert_eq!((x, m.skipped.len()), (vec![-40.0, 10.0], 0));
    f.add(entry(420), &format!("{part},0.,0.,0.,1.,2.,1."));
    let m = read::read(&f.bytes()).expect("a model");
    assert!(m.faces.len() == 2 && m.skipped.iter().any(|s| why(&s.reason).contains("otherwise along each axis")));
}

#[test]
fn one_copy_in_two_groups_is_one_and_two_copies_at_one_place_are_two() {
    for shift in ["0.,0.,0.", "5.,0.,0."] {
        let mut f = File::new();
        let s = f.rectangle(Entry { status: PART, ..entry(128) }, 3.0, 2.0);
        let part = f.add(entry(308), &format!("0,4Hwing,1,{s}"));
        let copy = f.add(entry(408), &format!("{part},{shift}"));
        f.add(Entry { form: 7, ..entry(402) }, &format!("1,{copy}"));
        f.add(Entry { form: 7, ..entry(402) }, &format!("1,{copy}"));
        assert_eq!(model(&f).faces.len(), 1, "{shift}");
        let inner = f.add(Entry { status: PART, ..entry(408) }, &format!("{part},0.,0.,0."));
        let whole = f.add(entry(308), &format!("1,5Hwhole,1,{inner}"));
        f.add(entry(408), &format!("{whole},{shift}"));
        assert_eq!(model(&f).faces.len(), 2, "{shift}");
    }
}

#[test]
fn groups_are_bodies_and_do_not_copy() {
    let mut f = File::new();
    let a = f.rectangle(entry(128), 1.0, 1.0);
    let b = f.rectangle(entry(128), 2.0, 1.0);
    f.rectangle(entry(128), 3.0, 1.0);
    f.add(Entry { form: 7, ..entry(402) }, &format!("2,{a},{b}"));
    let m = model(&f);
    let body = |w: f64| m.faces.iter().find(|f| (area(f) - w).abs() < 1e-9).expect("a face").body;
    assert_eq!(m.faces.len(), 3);
    assert!(body(1.0) == body(2.0) && body(1.0) != body(3.0));
}

/// What a part is made of is where its copies are, also where a group lists it; without copies it is where the group has it.
#[test]
fn members_of_parts_that_groups_list_as_well_are_read_once() {
    for copies in [0, 2] {
        let mut f = File::new();
        let a = f.rectangle(Entry { status: PART, ..entry(128) }, 1.0, 1.0);
        let b = f.rectangle(Entry { status: PART, ..entry(128) }, 2.0, 1.0);
        f.add(Entry { form: 7, ..entry(402) }, &format!("2,{a},{b}"));
        let inner = f.add(Entry { form: 7, status: PART, ..entry(402) }, &format!("2,{a},{b}"));
        let part = f.add(entry(308), &format!("0,4Hwing,3,{a},{b},{inner}"));
        for k in 1..=copies {
            f.add(entry(408), &format!("{part},{k}0.,0.,0."));
        }
        let mut x: Vec<f64> = model(&f).faces.iter().map(|f| f.surface.point(0.0, 0.0).x).collect();
        x.sort_by(f64::total_cmp);
        let expected: &[f64] = if copies == 0 { &[0.0, 0.0] } else { &[10.0, 10.0, 20.0, 20.0] };
        assert_eq!(x, expected);
    }
}

#[test]
fn names_are_properties_or_labels_and_hidden_faces_are_told() {
    let mut f = File::new();
    f.rectangle(Entry { label: "DECK", status: "01000000", ..entry(128) }, 1.0, 1.0);
    let name = f.add(Entry { form: 15, status: "00010300", ..entry(406) }, "1,10Hfore, deck");
    f.add(
        Entry { label: "OTHER", ..entry(128) },
        &format!("1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,3.,0.,0.,0.,2.,0.,3.,2.,0.,0.,1.,0.,1.,0,1,{name}"),
    );
    let m = model(&f);
    assert_eq!((m.faces[0].name.as_str(), m.faces[1].name.as_str()), ("DECK", "fore, deck"));
    assert!(m.notes.iter().any(|n| words::note(n).contains("hidden")), "{:?}", m.notes);
}

#[test]
fn what_is_not_read_is_named() {
    let mut f = File::new();
    f.rectangle(entry(128), 1.0, 1.0);
    let block = f.add(entry(150), "1.,2.,3.");
    f.add(entry(416), "9Hother.igs");
    let m = read::read(&f.bytes()).expect("a model");
    let named: Vec<Option<u64>> = m.skipped.iter().map(|s| s.entity).collect();
    assert_eq!(named, [Some(block), Some(block + 2)]);
    assert!(why(&m.skipped[0].reason).contains("CSG") && why(&m.skipped[1].reason).contains("another file"));
    let mut f = File::new();
    f.add(entry(150), "1.,2.,3.");
    let e = read::read(&f.bytes()).expect_err("no faces");
    assert!(e.to_string().contains("CSG"), "{e}");
}

/// Entities of types that the format does not have may hold faces, and a curve that bounds nothing hides no surface.
#[test]
fn entities_of_unknown_types_are_losses_and_their_surfaces_stay() {
    let mut f = File::new();
    f.rectangle(entry(128), 1.0, 1.0);
    let surface = f.rectangle(entry(128), 2.0, 1.0);
    let c = f.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.]], PART);
    let bound = f.add(entry(142), &format!("0,{surface},0,{c},2"));
    let unknown = f.add(entry(599), &format!("{surface},1,0,{bound}"));
    let m = read::read(&f.bytes()).expect("a model");
    assert_eq!((m.faces.len(), m.skipped.len()), (2, 1), "{:?}", m.skipped);
    assert!(m.skipped[0].entity == Some(unknown) && why(&m.skipped[0].reason).contains("not known"));
    // A part of what is not known has a boundary that is not known.
    let mut f = File::new();
    f.rectangle(entry(128), 1.0, 1.0);
    let part = f.rectangle(Entry { status: PART, ..entry(128) }, 2.0, 1.0);
    f.add(entry(599), &format!("{part},1,0"));
    let m = read::read(&f.bytes()).expect("a model");
    assert_eq!((m.faces.len(), m.skipped.len()), (1, 2), "{:?}", m.skipped);
    // What bounds nothing, though it is a part, has bounded something.
    let mut f = File::new();
    f.rectangle(entry(128), 1.0, 1.0);
    let part = f.rectangle(Entry { status: PART, ..entry(128) }, 2.0, 1.0);
    let c = f.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.]], PART);
    let bound = f.add(Entry { status: PART, ..entry(142) }, &format!("0,{part},0,{c},2"));
    f.add(entry(422), &format!("{part},1,0,{bound}"));
    let m = read::read(&f.bytes()).expect("a model");
    assert_eq!((m.faces.len(), m.skipped.len(), m.skipped[0].entity), (1, 1, Some(bound)));
}

#[test]
fn circles_of_references_end() {
    let mut f = File::new();
    f.rectangle(entry(128), 1.0, 1.0);
    // 3 is a part that holds copies of itself; 7 and 9 are matrices of each other.
    f.add(entry(308), "0,1Hx,2,5,5");
    f.add(entry(408), "3,1.,0.,0.");
    f.add(Entry { matrix: 9, ..entry(124) }, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.");
    f.add(Entry { matrix: 7, ..entry(124) }, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.");
    f.rectangle(Entry { matrix: 7, ..entry(128) }, 1.0, 1.0);
    f.add(entry(408), "3,1.,0.,0.");
    let m = read::read(&f.bytes()).expect("a model");
    assert_eq!(m.faces.len(), 1);
    assert!(m.skipped.iter().any(|s| why(&s.reason).contains("contains itself")), "{:?}", m.skipped);
}

/// Curves and points that nothing is made of stand beside the faces, where copies put them; edges, hidden curves and those of drawings
/// do not.
#[test]
fn curves_that_nothing_is_made_of_stand_beside_the_faces() {
    use torse::brep::free_curve::FreeShape;
    let mut f = File::new();
    f.rectangle(entry(144), 4.0, 3.0);
    f.add(Entry { label: "SCRIBE", ..entry(110) }, "1.,1.,0.,2.,1.,0.");
    f.add(Entry { status: "01000000", ..entry(110) }, "1.,1.,0.,3.,1.,0.");
    f.add(Entry { status: "00000100", ..entry(110) }, "1.,1.,0.,3.,1.,0.");
    f.add(entry(116), "2.,2.,0.,0");
    f.add(Entry { form: 3, ..entry(406) }, "2,0,7HEngrave");
    let note = "1,5,9.,2.5,1,1.5707963,1.5707963,0,0,3.,1.,0.,5HGRAIN";
    f.add(Entry { status: "00000100", ..entry(212) }, note);
    f.add(Entry { status: "00000100", ..entry(214) }, "1,1.,1.,0.,1.,1.,2.,2.");
    let inside = f.add(Entry { status: "00010000", ..entry(110) }, "0.,0.,0.,1.,0.,0.");
    let part = f.add(entry(308), &format!("0,4Hpart,1,{inside}"));
    f.add(entry(408), &format!("{part},10.,0.,0.,2."));
    let model = read::read(&f.bytes()).expect("a model");
    assert_eq!(model.faces.len(), 1);
    let ends: Vec<[f64; 3]> = model
        .curves
        .iter()
        .map(|c| match &c.shape {
            FreeShape::Curve(pieces) => {
                let end = pieces[0].point(pieces[0].knots.domain().1);
                [end[0], end[1], end[2]]
            }
            FreeShape::Point(x) => [x.x, x.y, x.z],
            FreeShape::Text { at, .. } => [at.x, at.y, at.z],
        })
        .collect();
    assert_eq!(ends.len(), 4, "{:?}", model.curves);
    let text = model.curves.iter().find(|c| c.name == "GRAIN").expect("the text of the note");
    let FreeShape::Text { at, along, up } = text.shape else { panic!("{text:?}") };
    assert!((at.x, at.y) == (3.0, 1.0) && along.y > 0.999 && (up.x + 2.5).abs() < 1e-5, "{text:?}");
    assert!(model.curves.iter().all(|c| c.layer == "Engrave"), "{:?}", model.curves);
    let told: Vec<String> = model.notes.iter().map(words::note).collect();
    assert!(told.iter().any(|n| n.contains("1 leader line")), "{told:?}");
    assert!([[12.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 2.0, 0.0]].iter().all(|e| ends.contains(e)), "{ends:?}");
}
