//! Faces as other exporters write them: names left out, bounded surfaces without topology, extruded faces, and what
//! accompanies shapes without being one.

use super::text::{Step, Unit};
use torse::brep::area::area_estimate;
use torse::brep::face::Face;
use torse::certify::trims::trim_proof;
use torse::geom::Vec3;
use torse::io::model::Model;
use torse::io::step::read::read;

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

const SQUARE: [[f64; 3]; 4] = [[0., 0., 0.], [10., 0., 0.], [10., 8., 0.], [0., 8., 0.]];

/// The square on its plane with another curve for its first side.
fn square_with(side: impl Fn(&mut Step) -> u64) -> Step {
    let mut s = Step::new(Unit::Millimetre);
    let curve = side(&mut s);
    let l = s.curve_and_polygon(curve, &SQUARE);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    s
}

/// Area, and proven distance between the trim and the file's edges.
fn measured(f: &Face) -> (f64, f64) {
    (area_estimate(f), trim_proof(f, 1e-3).bound().value())
}

#[test]
fn vertices_close_what_curves_leave_open() {
    // The line of the first side runs 0.5 mm beside its vertices, 4 % of the extent.
    let s = square_with(|s| s.line([0., -0.5, 0.], [10., -0.5, 0.]));
    let m = model(&s);
    let (area, bound) = measured(&m.faces[0]);
    assert!((area - 85.0).abs() < 1e-9, "{area}");
    assert!((0.5..0.51).contains(&bound), "the gap is part of the bound: {bound}");
    assert!((m.faces[0].trim_deviation_estimate - 0.5).abs() < 1e-9);
    // Four millimetres are no edge of this square.
    let s = square_with(|s| s.line([0., -4.0, 0.], [10., -4.0, 0.]));
    let e = read(s.text().as_bytes()).expect_err("an open boundary");
    assert!(e.to_string().contains("open"), "{e}");
}

#[test]
fn edges_leave_their_surface_between_vertices_on_it() {
    // An arc from vertex to vertex that stands up from the plane by a millimetre, 8 % of the extent.
    let arc = |rise: f64| {
        move |s: &mut Step| {
            let r = (25.0 + rise * rise) / (2.0 * rise);
            s.circle([5., 0., rise - r], [0., 1., 0.], r)
        }
    };
    let m = model(&square_with(arc(1.0)));
    let (area, bound) = measured(&m.faces[0]);
    assert!((area - 80.0).abs() < 1e-6, "{area}");
    assert!((1.0..1.2).contains(&bound), "the distance is part of the bound: {bound}");
    let e = read(square_with(arc(4.0)).text().as_bytes()).expect_err("another surface's edge");
    assert!(e.to_string().contains("away from the surface"), "{e}");
}

#[test]
fn the_files_uncertainty_closes_gaps() {
    let mut s = Step::new(Unit::Millimetre);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    // Chains without vertices; the last side ends 0.4 mm short, 3 % of the extent.
    let ends = [[0., 0., 0.], [10., 0., 0.], [10., 8., 0.], [0., 8., 0.], [0., 0.4, 0.]];
    let segments: Vec<String> = (0..4)
        .map(|i| {
            let (p, q) = (s.point(ends[i]), s.point(ends[i + 1]));
            let side = s.add(&format!("POLYLINE('',(#{p},#{q}))"));
            format!("#{}", s.add(&format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{side})")))
        })
        .collect();
    let boundary = s.add(&format!("OUTER_BOUNDARY_CURVE('',({}),.F.)", segments.join(",")));
    let face = s.add(&format!("CURVE_BOUNDED_SURFACE('',#{plane},(#{boundary}),.F.)"));
    s.geometric_set(&[face]);
    let stated = |mm: f64| {
        let unit = "#900000=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));";
        let record = format!("#900001=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({mm:?}),#900000,'','');");
        let text = s.text().replacen("DATA;", &format!("DATA;{unit}{record}"), 1);
        let assigned = "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#900001))GLOBAL_UNIT_ASSIGNED_CONTEXT";
        read(text.replace("GLOBAL_UNIT_ASSIGNED_CONTEXT", assigned).as_bytes())
    };
    let (area, bound) = measured(&stated(0.5).expect("a model").faces[0]);
    assert!((area - 80.0).abs() < 1e-9 && (0.4..0.41).contains(&bound), "{area} {bound}");
    let e = stated(0.001).expect_err("an open boundary").to_string();
    // The edges that do not meet are named by numbers of the file.
    let named = [segments[3].as_str(), segments[0].as_str()];
    assert!(named.iter().all(|n| e.contains(&format!("{n} "))), "{e}");
}

#[test]
fn edges_in_the_parameter_plane_only_are_read_and_not_certified() {
    let mut s = Step::new(Unit::Millimetre);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    let p = s.add("CARTESIAN_POINT('',(0.,0.))");
    let d = s.add("DIRECTION('',(1.,0.))");
    let v = s.add(&format!("VECTOR('',#{d},10.)"));
    let line = s.add(&format!("LINE('',#{p},#{v})"));
    let part = s.add(&format!("TRIMMED_CURVE('',#{line},(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.)"));
    let flat = s.add(&format!("DEFINITIONAL_REPRESENTATION('',(#{part}),#1)"));
    let pcurve = s.add(&format!("PCURVE('',#{plane},#{flat})"));
    let l = s.curve_and_polygon(pcurve, &SQUARE);
    s.face("", plane, &[(l, true)], true);
    let m = model(&s);
    let (area, bound) = measured(&m.faces[0]);
    assert!((area - 80.0).abs() < 1e-6, "{area}");
    assert!(bound.is_infinite(), "nothing is known of such edges: {bound}");
}

#[test]
fn offsets_of_sweeps_that_are_cylinders() {
    let mut s = Step::new(Unit::Millimetre);
    let line = s.line([2., 0., 0.], [2., 0., 1.]);
    let axis = s.axis1([0., 0., 0.], [0., 0., 1.]);
    let turned = s.add(&format!("SURFACE_OF_REVOLUTION('',#{line},#{axis})"));
    let surface = s.add(&format!("OFFSET_SURFACE('',#{turned},1.,.F.)"));
    let (low, high) =
        (s.circle_loop([0., 0., 0.], [0., 0., 1.], 3., true), s.circle_loop([0., 0., 5.], [0., 0., 1.], 3., false));
    s.face("", surface, &[(low, true), (high, true)], true);
    let m = model(&s);
    let area = area_estimate(&m.faces[0]);
    assert!((area / (30.0 * std::f64::consts::PI) - 1.0).abs() < 1e-4, "{area}");
}

/// A dish that is turned, from its axis to an upright rim, and 2 mm outwards: the rim is a circle of the file.
#[test]
fn offsets_of_turned_splines_are_turned() {
    let mut s = Step::new(Unit::Millimetre);
    let control = [[0., 0., 0.], [20., 0., 0.], [30., 0., 5.], [30., 0., 20.]];
    let p = control.map(|p| s.point(p));
    let meridian = s.add(&format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',3,(#{},#{},#{},#{}),.UNSPECIFIED.,.F.,.F.,(4,4),(0.,1.),.UNSPECIFIED.)",
        p[0], p[1], p[2], p[3]
    ));
    let axis = s.axis1([0., 0., 0.], [0., 0., 1.]);
    let dish = s.add(&format!("SURFACE_OF_REVOLUTION('',#{meridian},#{axis})"));
    let surface = s.add(&format!("OFFSET_SURFACE('',#{dish},2.,.F.)"));
    let rim = s.circle_loop([0., 0., 20.], [0., 0., 1.], 32., false);
    s.face("", surface, &[(rim, true)], true);
    let m = model(&s);
    let (area, bound) = measured(&m.faces[0]);
    // Guldin's rule on a fine polygon of the offset curve.
    let at = |t: f64| {
        let b = [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
        let d = [-(1.0 - t).powi(2), (1.0 - t) * (1.0 - 3.0 * t), t * (2.0 - 3.0 * t), t * t];
        let sum = |w: &[f64; 4], k: usize| (0..4).map(|i| w[i] * control[i][k]).sum::<f64>();
        let (x, z, dx, dz) = (sum(&b, 0), sum(&b, 2), sum(&d, 0), sum(&d, 2));
        let speed = dx.hypot(dz);
        [x + 2.0 * dz / speed, z - 2.0 * dx / speed]
    };
    let line: Vec<[f64; 2]> = (0..=20_000).map(|k| at(f64::from(k) / 20_000.0)).collect();
    let turned = |w: &[[f64; 2]]| (w[0][0] + w[1][0]) * (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
    let exact = std::f64::consts::PI * line.windows(2).map(turned).sum::<f64>();
    assert!((area / exact - 1.0).abs() < 1e-5, "{area} {exact}");
    assert!(bound < 1e-2, "{bound}");
}

/// A sheet 5 mm inside a parabola of 20 mm focal distance, its edges chords. The rectangle is in parameters that some programs write,
/// 40 times those of the standard.
#[test]
fn offsets_of_extruded_parabolas_go_as_far_as_their_edges() {
    let mut s = Step::new(Unit::Millimetre);
    let axis = s.axis([0., 0., 0.], [0., 1., 0.], [1., 0., 0.]);
    let parabola = s.add(&format!("PARABOLA('',#{axis},20.)"));
    let along = s.vector([0., 1., 0.], 1.);
    let swept = s.add(&format!("SURFACE_OF_LINEAR_EXTRUSION('',#{parabola},#{along})"));
    let cut = s.add(&format!("RECTANGULAR_TRIMMED_SURFACE('',#{swept},-100.,100.,0.,150.,.T.,.T.)"));
    let surface = s.add(&format!("OFFSET_SURFACE('',#{cut},5.,.F.)"));
    let at = |t: f64, y: f64| {
        let inwards = 5.0 / t.hypot(1.0);
        [20.0 * t * t + inwards, y, inwards * t - 40.0 * t]
    };
    let places = |n: i32| (0..=n).map(move |k| 5.0 * f64::from(k) / f64::from(n) - 2.5);
    let corners: Vec<_> = places(40).map(|t| at(t, 0.0)).chain(places(40).map(|t| at(-t, 150.0))).collect();
    let edges = s.polygon(&corners);
    s.face("", surface, &[(edges, true)], true);
    let (area, bound) = measured(&model(&s).faces[0]);
    let line: Vec<_> = places(20_000).map(|t| at(t, 0.0)).collect();
    let length: f64 = line.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][2] - w[0][2])).sum();
    assert!((area / (150.0 * length) - 1.0).abs() < 1e-4, "{area} {length}");
    assert!(bound < 0.2, "{bound}");
}

#[test]
fn bounded_surfaces_are_named_or_read() {
    let mut s = Step::new(Unit::Millimetre);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    let circle = s.circle([0., 0., 0.], [0., 0., 1.], 2.);
    let disc = s.add(&format!("CURVE_BOUNDED_SURFACE('',#{plane},(#{circle}),.F.)"));
    let stray = s.add(&format!("CURVE_BOUNDED_SURFACE('',#{plane},(#{circle}),.F.)"));
    s.geometric_set(&[disc]);
    let m = read(s.text().as_bytes()).expect("a model");
    assert!((area_estimate(&m.faces[0]) / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-4);
    assert_eq!((m.faces.len(), m.skipped.len(), m.skipped[0].entity), (1, 1, Some(stray)));
    // A patch that ends at its own sides, with a hole: the hole must not be taken for the face.
    let mut s = Step::new(Unit::Millimetre);
    let p = [[-5., -5., 0.], [-5., 5., 0.], [5., -5., 0.], [5., 5., 0.]].map(|p| s.point(p));
    let patch = s.add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#{},#{}),(#{},#{})),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),(0.,1.),(0.,1.),\
         .UNSPECIFIED.)",
        p[0], p[1], p[2], p[3]
    ));
    let circle = s.circle([0., 0., 0.], [0., 0., 1.], 2.);
    let segment = s.add(&format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{circle})"));
    let hole = s.add(&format!("BOUNDARY_CURVE('',(#{segment}),.F.)"));
    let face = s.add(&format!("CURVE_BOUNDED_SURFACE('',#{patch},(#{hole}),.T.)"));
    s.geometric_set(&[face]);
    let e = read(s.text().as_bytes()).expect_err("not read").to_string();
    assert!(e.contains("has holes"), "{e}");
}

#[test]
fn solids_in_parts_and_triangles_that_show_faces() {
    let mut s = Step::new(Unit::Millimetre);
    let l = s.polygon(&SQUARE);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    let bound = s.add(&format!("FACE_OUTER_BOUND('',#{l},.T.)"));
    let face = s.add(&format!("ADVANCED_FACE('',(#{bound}),#{plane},.T.)"));
    let shell = s.add(&format!("CLOSED_SHELL('',(#{face}))"));
    let solid = s.add(&format!(
        "(FACETED_BREP()GEOMETRIC_REPRESENTATION_ITEM()MANIFOLD_SOLID_BREP(#{shell})REPRESENTATION_ITEM('')SOLID_MODEL())"
    ));
    let linked = s.add(&format!("TRIANGULATED_FACE('',$,3,(),#{face},(),())"));
    let shown = s.add(&format!("TESSELLATED_SOLID('',(#{linked}),$)"));
    let lone = s.add("TRIANGULATED_FACE('',$,3,(),$,(),())");
    let mesh = s.add(&format!("TESSELLATED_SOLID('',(#{lone}),$)"));
    s.geometric_set(&[solid, shown, mesh]);
    let m = read(s.text().as_bytes()).expect("a model");
    assert_eq!(m.faces.len(), 1);
    assert_eq!(m.skipped.iter().map(|f| f.entity).collect::<Vec<_>>(), [Some(mesh)]);
}
