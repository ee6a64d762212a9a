//! Faces as other exporters write them: names left out, bounded surfaces without topology, extruded faces, and what
//! accompanies shapes without being one.

use crate::text::{Step, Unit};
use torse::brep::area::area_estimate;
use torse::geom::Vec3;
use torse::io::step::read::{read, Model};

fn model(s: &Step) -> Model {
    let m = read(s.text().as_bytes()).expect("a model");
    assert!(m.skipped.is_empty(), "{:?}", m.skipped);
    m
}

#[test]
fn names_may_be_left_out() {
    let mut s = Step::new(Unit::Millimetre);
    let p: Vec<u64> = [[0., 0., 0.], [0., 8., 0.], [10., 0., 0.], [10., 8., 0.]].iter().map(|p| s.point(*p)).collect();
    let surface = s.add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS($,1,1,((#{},#{}),(#{},#{})),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),(0.,1.),(0.,1.),\
         .UNSPECIFIED.)",
        p[0], p[1], p[2], p[3]
    ));
    let curve = s.add(&format!(
        "B_SPLINE_CURVE_WITH_KNOTS($,1,(#{},#{}),.UNSPECIFIED.,.F.,.F.,(2,2),(0.,1.),.UNSPECIFIED.)",
        p[0], p[2]
    ));
    let l = s.curve_and_polygon(curve, &[[0., 0., 0.], [10., 0., 0.], [10., 8., 0.], [0., 8., 0.]]);
    s.face("", surface, &[(l, true)], true);
    let m = model(&s);
    assert_eq!(m.faces.len(), 1);
    assert!((area_estimate(&m.faces[0]) - 80.0).abs() < 1e-9);
}

#[test]
fn surfaces_bounded_by_chains_of_curves() {
    let mut s = Step::new(Unit::Millimetre);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    let corners = [[0., 0., 0.], [10., 0., 0.], [10., 8., 0.], [0., 8., 0.]];
    let segments: Vec<String> = (0..4)
        .map(|i| {
            // The third segment is written backwards, whatever its sense says.
            let (mut a, mut b) = (corners[i], corners[(i + 1) % 4]);
            if i == 2 {
                (a, b) = (b, a);
            }
            let line = s.line(a, b);
            let (a, b) = (s.point(a), s.point(b));
            let part = s.add(&format!("TRIMMED_CURVE($,#{line},(#{a}),(#{b}),.T.,.CARTESIAN.)"));
            let curve = s.add(&format!(
                "(BOUNDED_CURVE()CURVE()GEOMETRIC_REPRESENTATION_ITEM()REPRESENTATION_ITEM('')\
                 SURFACE_CURVE(#{part},(#{plane}),.CURVE_3D.))"
            ));
            format!("#{}", s.add(&format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{curve})")))
        })
        .collect();
    let boundary = s.add(&format!("OUTER_BOUNDARY_CURVE('',({}),.F.)", segments.join(",")));
    let face = s.add(&format!("CURVE_BOUNDED_SURFACE('',#{plane},(#{boundary}),.F.)"));
    s.geometric_set(&[face]);
    let m = model(&s);
    assert_eq!(m.faces.len(), 1);
    assert!((area_estimate(&m.faces[0]) - 80.0).abs() < 1e-9);
}

#[test]
fn extruded_faces_are_bounded_by_faces() {
    for up in [1.0, -1.0] {
        let mut s = Step::new(Unit::Millimetre);
        let corners = [[0., 0., 0.], [10., 0., 0.], [10., 8., 0.], [0., 8., 0.]];
        let l = s.polygon(&corners);
        let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
        let bound = s.add(&format!("FACE_OUTER_BOUND('',#{l},.T.)"));
        let base = s.add(&format!("ADVANCED_FACE('base',(#{bound}),#{plane},.T.)"));
        let way = s.add(&format!("DIRECTION('',(0.,0.,{up:?}))"));
        let solid = s.add(&format!("EXTRUDED_FACE_SOLID('prism',#{base},#{way},5.)"));
        s.geometric_set(&[solid]);
        let m = read(s.text().as_bytes()).expect("a model");
        // The base belongs to the solid; on its own no representation leads to it.
        assert!(m.skipped.is_empty(), "{:?}", m.skipped);
        assert_eq!(m.faces.len(), 6);
        let area: f64 = m.faces.iter().map(area_estimate).sum();
        assert!((area - (2.0 * 80.0 + 36.0 * 5.0)).abs() < 1e-9, "{area}");
        let middle = Vec3::new(5.0, 4.0, 2.5 * up);
        for f in &m.faces {
            let l = &f.loops[0].points;
            let n = l.len() as f64;
            let at = [0, 1].map(|k: usize| l.iter().map(|p| p[k]).sum::<f64>() / n);
            let j = f.surface.jet(at[0], at[1]);
            let outward = (j.p - middle).dot(&j.normal()) * if f.reversed { -1.0 } else { 1.0 };
            assert!(outward > 0.0, "{:?}", f.kind);
        }
    }
}

#[test]
fn what_accompanies_shapes_is_no_loss() {
    let mut s = Step::new(Unit::Millimetre);
    let l = s.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    let face = s.face("", plane, &[(l, true)], true);
    let axis = s.axis([0., 0., 0.], [0., 0., 1.], [1., 0., 0.]);
    let camera = s.add(&format!("CAMERA_MODEL_D3('view',#{axis},#{axis})"));
    let mesh = s.add("TESSELLATED_GEOMETRIC_SET('note',())");
    let shell = s.add(&format!("TESSELLATED_SHELL('',(),#{face})"));
    let drawing = s.add(&format!(
        "(DRAUGHTING_MODEL()REPRESENTATION('',(#{mesh}),#1)SHAPE_REPRESENTATION()TESSELLATED_SHAPE_REPRESENTATION())"
    ));
    let map = s.add(&format!("REPRESENTATION_MAP(#{camera},#{drawing})"));
    s.geometric_set(&[mesh, shell]);
    let view = s.add(&format!("MAPPED_ITEM('',#{map},#{axis})"));
    s.add(&format!("SHAPE_REPRESENTATION('',(#{view}),#1)"));
    s.add(&format!("DIMENSIONAL_CHARACTERISTIC_REPRESENTATION(#{face},#{view})"));
    assert_eq!(model(&s).faces.len(), 1);
}
