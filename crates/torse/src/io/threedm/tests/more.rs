//! Blocks, layers, curves and meshes.

use super::super::bytes::checksum;
use super::super::{free_curves, meshes, ReadError};
use super::specimens::*;
use super::{area, corners, model, near, normal, read};
use crate::brep::free_curve::{FreeCurve, FreeShape};
use crate::brep::raw::SurfaceKind;
use crate::geom::Vec3;
use crate::io::words;
use crate::io::words::left_out;
use std::f64::consts::{FRAC_PI_2, PI};

fn quarter(version: u32, id: u128, mode: u8) -> Item {
    let data = quarter_cylinder(version, 2.0, 5.0);
    Item { id, mode, name: "shell", ..Item::new(SURFACE_TYPE, NURBS_SURFACE, data) }
}

/// A use of a block: columns of the map and its shift.
fn reference(version: u32, block: u128, axes: [[f64; 3]; 3], shift: [f64; 3], id: u128, mode: u8) -> Item {
    let mut c = Out::new(version);
    c.u8(0x10).uuid(block);
    for k in 0..3 {
        c.nums(&[axes[0][k], axes[1][k], axes[2][k], shift[k]]);
    }
    c.nums(&[0., 0., 0., 1.]).nums(&[0.0; 6]);
    Item { id, mode, ..Item::new(0x1000, REFERENCE, c) }
}

const AS_IT_IS: [[f64; 3]; 3] = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];

#[test]
fn blocks_put_their_members_where_they_say() {
    for version in [50, 70] {
        let mirror = [[-1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        let double = [[2., 0., 0.], [0., 2., 0.], [0., 0., 2.]];
        let items = vec![
            quarter(version, 11, 3),
            reference(version, 1, mirror, [0.; 3], 12, 3),
            reference(version, 1, AS_IT_IS, [100., 0., 0.], 13, 0),
            reference(version, 2, double, [0., 0., 50.], 14, 0),
        ];
        let blocks = vec![(1, "frame", vec![11]), (2, "pair", vec![11, 12])];
        let m = model(&Specimen { blocks, ..Specimen::new(version, items) }.bytes());
        assert_eq!((m.faces.len(), m.skipped.len()), (3, 0), "{:?}", m.skipped);
        assert!(near(area(&m.faces), (1.0 + 4.0 + 4.0) * 5.0 * PI));
        let parts: Vec<&str> = m.faces.iter().map(|f| f.part.as_str()).collect();
        assert_eq!(parts, ["frame", "pair", "frame"]);
        // Every use is a body of its own.
        assert!(m.faces[0].body != m.faces[1].body && m.faces[1].body != m.faces[2].body);
        let b = corners(&m.faces[1..]);
        assert!((b.min - Vec3::new(-4., 0., 50.)).norm() < 1e-12 && (b.max - Vec3::new(4., 4., 60.)).norm() < 1e-12);
        // A mirror turns the surface over, not the face.
        let n = normal(&m.faces[2]);
        assert!((n - Vec3::new(-1., 1., 0.).normalize() * normal(&m.faces[1]).y.signum()).norm() < 1e-9, "{n}");
    }
}

#[test]
fn uneven_blocks_keep_their_planes_only() {
    let v = [[0., 0.], [4., 0.], [4., 3.], [0., 3.]];
    let face = plane_face(70, &v, &[Ring { corners: &[0, 1, 2, 3], outer: true }], false, false);
    let mut cylinder = Out::new(70);
    cylinder.u8(0x20).nums(&[0., 0., 0., 0., 0., 1.]).nums(&[0., 1.]).nums(&[0., 1.]).nums(&[0.0; 6]).ints(&[0]).u8(1);
    cylinder.line([3., 0., 0.], [3., 0., 5.]);
    let items = vec![
        Item { id: 11, mode: 3, ..Item::new(BREP_TYPE, BREP, face) },
        Item { id: 12, mode: 3, ..Item::new(SURFACE_TYPE, REVOLUTION, cylinder) },
        reference(70, 1, [[2., 0., 0.], [0., 1., 0.], [0., 0., 1.]], [0.; 3], 13, 0),
    ];
    let m = model(&Specimen { blocks: vec![(1, "b", vec![11, 12])], ..Specimen::new(70, items) }.bytes());
    assert_eq!(m.faces.iter().map(|f| f.kind).collect::<Vec<_>>(), [SurfaceKind::Plane, SurfaceKind::Spline]);
    assert!(near(area(&m.faces[..1]), 24.0));
}

#[test]
fn blocks_in_a_circle_and_without_members_are_named() {
    let items = vec![
        quarter(70, 10, 0),
        reference(70, 1, AS_IT_IS, [1.; 3], 11, 3),
        reference(70, 1, AS_IT_IS, [1.; 3], 12, 0),
        reference(70, 9, AS_IT_IS, [1.; 3], 13, 0),
        reference(70, 2, [[0.; 3]; 3], [1.; 3], 14, 0),
        reference(70, 2, AS_IT_IS, [1.; 3], 15, 0),
    ];
    let blocks = vec![(1, "circle", vec![11]), (2, "poor", vec![99])];
    let m = model(&Specimen { blocks, ..Specimen::new(70, items) }.bytes());
    let words: Vec<String> = m.skipped.iter().map(left_out).collect();
    assert_eq!((m.faces.len(), words.len()), (1, 4), "{words:?}");
    for (w, part) in words.iter().zip(["contains itself", "is not defined", "flat", "1 members of its block 'poor'"]) {
        assert!(w.contains(part), "{w}");
    }
}

#[test]
fn blocks_that_double_again_and_again_end() {
    // Thirty levels of two uses each: a thousand million faces from a few kilobytes.
    let mut items = vec![quarter(70, 1000, 3)];
    let mut blocks = vec![(1, "level", vec![1000])];
    for level in 1..30 {
        let ids = [1000 + 2 * level, 1001 + 2 * level];
        items.extend(ids.map(|id| reference(70, level, AS_IT_IS, [1., 0., 0.], id, 3)));
        blocks.push((level + 1, "level", ids.to_vec()));
    }
    items.push(reference(70, 30, AS_IT_IS, [0.; 3], 5, 0));
    let m = model(&Specimen { blocks, ..Specimen::new(70, items) }.bytes());
    assert!(m.faces.len() <= 100_000 && m.skipped.len() < 100, "{}", m.faces.len());
    assert!(m.skipped.iter().any(|s| left_out(s).contains("too much")));
}

#[test]
fn what_is_hidden_is_left_out_and_counted() {
    let items = vec![quarter(70, 1, 0), quarter(70, 2, 1), Item { layer: 1, ..quarter(70, 3, 0) }];
    let m = model(&Specimen::new(70, items).bytes());
    assert_eq!((m.faces.len(), m.skipped.len()), (1, 0));
    assert!(m.notes.iter().any(|n| words::note(n).starts_with("2 objects are hidden")), "{:?}", m.notes);
    assert_eq!(m.products, ["Hull"]);
}

#[test]
fn what_is_no_face_is_named() {
    let mut unknown = Item::new(0x10, 12345, Out::new(70));
    unknown.name = "thing";
    let items = vec![
        quarter(70, 1, 0),
        Item { name: "soft", ..Item::new(0x4_0000, SUBD, Out::new(70)) },
        unknown,
        Item::new(0x200, 54321, Out::new(70)),
        Item::new(CURVE_TYPE, LINE, Out::new(70)),
        Item { name: "torn", ..Item::new(SURFACE_TYPE, NURBS_SURFACE, Out::new(70)) },
    ];
    let m = model(&Specimen::new(70, items).bytes());
    let words: Vec<String> = m.skipped.iter().map(left_out).collect();
    // Texts and curves are no loss.
    assert_eq!((m.faces.len(), words.len()), (1, 3), "{words:?}");
    assert!(words[0].contains("object 2 (SubD 'soft'") && words[0].contains("ToNURBS"), "{}", words[0]);
    assert!(words[1].contains("object 3 (object 'thing'") && words[1].contains("unknown class"), "{}", words[1]);
    assert!(words[2].starts_with("#2: object 6 (surface 'torn'"), "{}", words[2]);
}

#[test]
fn curves_are_read_as_jobs_want_them() {
    let mut poly = Out::new(70);
    poly.u8(0x10).ints(&[2, 0, 0]).nums(&[0.0; 6]).knots(&[0., 2., 5.]);
    poly.line([2., -3., 0.], [2., 0., 0.]).arc([0.0; 3], 2.0, [0.0, FRAC_PI_2]);
    let mut free = Out::new(70);
    free.u8(0x10).ints(&[3, 0, 3, 3, 0, 0]).nums(&[0.0; 6]).knots(&[0., 0., 1., 1.]).ints(&[3]);
    free.nums(&[0., 0., 0., 1., 2., 0., 2., 0., 0.]);
    let items = vec![
        Item { name: "rail", ..Item::new(CURVE_TYPE, POLYCURVE, poly) },
        Item::new(CURVE_TYPE, NURBS_CURVE, free),
        Item { name: "rail", ..Item::new(CURVE_TYPE, LINE, Out::new(70)) },
    ];
    let (found, notes) =
        free_curves::curves(&Specimen { unit: (3, 1.0), ..Specimen::new(70, items) }.bytes()).expect("curves");
    assert_eq!(found.iter().map(|c| (c.label.as_str(), c.curves.len())).collect::<Vec<_>>(), [("rail", 2), ("2", 1)]);
    assert_eq!(found[0].curves[1].point(FRAC_PI_2)[..2].iter().map(|x| x.round()).collect::<Vec<_>>(), [0.0, 20.0]);
    assert_eq!(found[1].curves[0].point(0.5)[..2], [10.0, 10.0]);
    assert!(notes.iter().any(|n| words::note::reader_note(n).starts_with("object 3 (curve 'rail'")), "{notes:?}");
    // Without curves, the edges.
    let v = [[0., 0.], [4., 0.], [4., 3.]];
    let face = plane_face(4, &v, &[Ring { corners: &[0, 1, 2], outer: true }], false, true);
    // Beside faces there are curves, points and dots; those that are damaged are named.
    let mut line = Out::new(4);
    line.u8(0x10).nums(&[0., 1., 0., 4., 3., 0.]).nums(&[0., 1.]).ints(&[3]);
    let (mut point, mut dot) = (Out::new(4), Out::new(4));
    point.u8(0x10).nums(&[1., 2., 0.]);
    dot.u8(0x11).nums(&[3., 1., 0.]).ints(&[14]).text("fold here");
    let beside = vec![
        Item::new(BREP_TYPE, BREP, face.clone()),
        Item::new(CURVE_TYPE, LINE, Out::new(4)),
        Item { name: "cut", ..Item::new(CURVE_TYPE, LINE, line) },
        Item::new(1, POINT, point),
        Item::new(0x2000, DOT, dot),
    ];
    let model = read(&Specimen::new(4, beside).bytes()).expect("a face");
    assert!(model.notes.iter().any(|n| words::note(n).starts_with("object 2 (curve")), "{:?}", model.notes);
    let called: Vec<String> = model.curves.iter().map(FreeCurve::called).collect();
    assert_eq!(called, ["object 3 'cut'", "object 4", "object 5 'fold here'"]);
    assert_eq!(model.curves[1].shape, FreeShape::Point(Vec3::new(1.0, 2.0, 0.0)));
    let FreeShape::Curve(pieces) = &model.curves[0].shape else { panic!("a curve") };
    assert_eq!(pieces[0].point(pieces[0].domain().1)[..2], [4.0, 3.0]);
    let (found, _) =
        free_curves::curves(&Specimen::new(4, vec![Item::new(BREP_TYPE, BREP, face)]).bytes()).expect("edges");
    assert_eq!(found.iter().map(|c| c.label.as_str()).collect::<Vec<_>>(), ["1.1", "1.2", "1.3"]);
    let (a, b) = found[1].curves[0].domain();
    assert!(
        (found[1].curves[0].point(a)[0] - 4.0).abs() < 1e-15 && (found[1].curves[0].point(b)[1] - 3.0).abs() < 1e-15
    );
}

/// A mesh of a triangle and a quadrilateral.
fn mesh(version: u32, raw: bool) -> Out {
    let mut c = Out::new(version);
    let places = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0.5, 2., 0.25f32]];
    let bytes: Vec<u8> = places.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    c.u8(if raw { 0x10 } else { 0x30 }).ints(&[5, 2]).put(&[0; 64 + 16 + 64 + 4]).put(&[0; 5]);
    c.ints(&[1]).put(&[0, 1, 2, 3, 2, 4, 3, 3]);
    if raw {
        c.ints(&[5]).put(&bytes);
    } else {
        let packed = miniz_oxide::deflate::compress_to_vec_zlib(&bytes, 6);
        c.ints(&[60]).put(&checksum(&bytes).to_le_bytes()).u8(1).chunk(0x4000_8000, |z| {
            z.put(&packed);
        });
    }
    c
}

#[test]
fn meshes_are_points_and_triangles() {
    for (version, raw) in [(4, true), (4, false), (70, false)] {
        let items = vec![
            Item { id: 11, mode: 3, ..Item::new(0x20, MESH, mesh(version, raw)) },
            reference(version, 1, AS_IT_IS, [0., 0., 7.], 12, 0),
            Item { id: 13, ..Item::new(0x20, MESH, mesh(version, raw)) },
        ];
        let s = Specimen { unit: (3, 1.0), blocks: vec![(1, "b", vec![11])], ..Specimen::new(version, items) };
        let found = meshes::read(&s.bytes()).expect("a mesh");
        assert_eq!((found.points.len(), found.notes.len(), found.assumes_unit), (10, 0, false));
        assert_eq!(found.faces[..2], [[0, 1, 2, 3], [2, 4, 3, 3]]);
        let cloud = found.into_cloud();
        assert_eq!(cloud.points[4], Vec3::new(5., 20., 72.5));
        assert_eq!(cloud.triangles, [[0, 1, 2], [0, 2, 3], [2, 4, 3], [5, 6, 7], [5, 7, 8], [7, 9, 8]]);
        // A mesh is no face.
        assert!(matches!(read(&s.bytes()), Err(ReadError::NoFaces { objects: 3, .. })));
    }
}

#[test]
fn a_packed_list_that_lies_is_refused() {
    let mut c = mesh(70, false);
    // Five corners become two hundred million: no such memory is taken.
    c.bytes[1..5].copy_from_slice(&200_000_000_i32.to_le_bytes());
    let s = Specimen::new(70, vec![Item::new(0x20, MESH, c)]);
    assert!(matches!(meshes::read(&s.bytes()), Err(ReadError::Nothing { what: "meshes", .. })));
}
