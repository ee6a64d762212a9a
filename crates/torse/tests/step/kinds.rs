//! The STEP reader on small files written here: every kind of surface and curve, senses, units, assemblies, damage.
//! Areas are compared with closed forms.

use super::text::{Step, Unit};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use torse::brep::area::area_estimate;
use torse::brep::face::Face;
use torse::brep::raw::SurfaceKind;
use torse::geom::Vec3;
use torse::io::model::Model;
use torse::io::step::read::{read, ReadError};
use torse::io::words;
use torse::io::words::why;

/// Chords of 10⁻⁵ of the extent inside a circle cost less area than this share.
const AREA: f64 = 5e-5;

fn model(s: &Step) -> Model {
    read(s.text().as_bytes()).expect("a model")
}

fn only(s: &Step) -> Face {
    let m = model(s);
    assert!(m.skipped.is_empty(), "{:?}", m.skipped);
    assert_eq!(m.faces.len(), 1);
    let f = m.faces[0].clone();
    well_formed(&f);
    f
}

/// What every face promises: outer loop counter-clockwise, holes clockwise, corners inside the domain.
fn well_formed(f: &Face) {
    let ((u0, u1), (v0, v1)) = f.surface.domain();
    for (i, l) in f.loops.iter().enumerate() {
        assert_eq!(l.points.len(), l.edge.len());
        let n = l.points.len();
        let area: f64 = (0..n)
            .map(|k| {
                let (p, q) = (l.points[k], l.points[(k + 1) % n]);
                p[0] * q[1] - p[1] * q[0]
            })
            .sum();
        assert_eq!(area > 0.0, i == 0, "loop {i} has area {area}");
        for p in &l.points {
            assert!(p[0] >= u0 && p[0] <= u1 && p[1] >= v0 && p[1] <= v1, "{p:?} outside");
        }
    }
}

fn assert_area(f: &Face, expected: f64) {
    let a = area_estimate(f);
    assert!((a - expected).abs() <= AREA * expected, "area {a}, expected {expected}");
}

fn middle_normal(f: &Face) -> Vec3 {
    let l = &f.loops[0].points;
    let n = l.len() as f64;
    let (u, v) = (l.iter().map(|p| p[0]).sum::<f64>() / n, l.iter().map(|p| p[1]).sum::<f64>() / n);
    let normal = f.surface.jet(u, v).normal().normalize();
    if f.reversed {
        -normal
    } else {
        normal
    }
}

#[test]
fn plane_with_a_round_hole() {
    let mut s = Step::new(Unit::Millimetre);
    let outer = s.polygon(&[[0., 0., 0.], [20., 0., 0.], [20., 10., 0.], [0., 10., 0.]]);
    let hole = s.circle_loop([10., 5., 0.], [0., 0., 1.], 3.0, false);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("deck", plane, &[(outer, true), (hole, true)], true);
    let f = only(&s);
    assert_eq!((f.loops.len(), f.kind, f.name.as_str(), f.part.as_str()), (2, SurfaceKind::Plane, "deck", "part"));
    assert_eq!(f.loops[0].points.len(), 4, "straight edges stay single chords");
    assert_area(&f, 200.0 - 9.0 * PI);
    assert!(f.trim_deviation_estimate < 1e-3);
    // The polygon follows the circle within what it states.
    for w in f.loops[1].points.windows(2) {
        let p = f.surface.point(0.5 * (w[0][0] + w[1][0]), 0.5 * (w[0][1] + w[1][1]));
        assert!(((p - Vec3::new(10., 5., 0.)).norm() - 3.0).abs() <= 1.01 * f.trim_deviation_estimate);
    }
}

#[test]
fn senses_do_not_change_the_region_but_the_normal() {
    for (bound, sense) in [(true, true), (false, true), (true, false), (false, false)] {
        let mut s = Step::new(Unit::Millimetre);
        // The file's loop runs about the face's normal.
        let ccw = bound == sense;
        let corners = [[0., 0., 0.], [4., 0., 0.], [4., 3., 0.]];
        let l = if ccw { s.polygon(&corners) } else { s.polygon(&[corners[2], corners[1], corners[0]]) };
        let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
        s.face("", plane, &[(l, bound)], sense);
        let f = only(&s);
        assert_area(&f, 6.0);
        assert_eq!(f.reversed, !sense);
        assert!((middle_normal(&f).z > 0.0) == sense);
    }
}

#[test]
fn cylinders_with_and_without_a_seam() {
    let (r, h) = (2.0, 5.0);
    // Two circles, no seam: the reader cuts.
    let mut s = Step::new(Unit::Millimetre);
    let low = s.circle_loop([0., 0., 0.], [0., 0., 1.], r, true);
    let high = s.circle_loop([0., 0., h], [0., 0., 1.], r, false);
    let c = s.surface("CYLINDRICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[r]);
    s.face("", c, &[(low, true), (high, true)], true);
    let f = only(&s);
    assert_area(&f, TAU * r * h);
    assert_eq!(f.loops.len(), 1);
    // The same with holes all around, so that no straight seam misses them all.
    for k in 0..3 {
        let angle = f64::from(k) * TAU / 3.0;
        let low = 0.5 + 1.5 * f64::from(k);
        let hole = s.cylinder_window(r, angle, 1.2, low, low + 1.0);
        s.add_bound(hole);
    }
    let f = only(&s);
    assert_area(&f, TAU * r * h - 3.0 * 2.4 * r);
    // One loop that runs up and down a seam.
    let mut s = Step::new(Unit::Millimetre);
    let l = s.seamed_tube(r, h);
    let c = s.surface("CYLINDRICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[r]);
    s.face("", c, &[(l, true)], true);
    assert_area(&only(&s), TAU * r * h);
}

#[test]
fn cones_to_the_apex_and_angle_units() {
    // Half angle 45° given in degrees; base circle at v = 0, apex at z = −3.
    let mut s = Step::new(Unit::MillimetreDegree);
    let base = s.circle_loop([0., 0., 0.], [0., 0., 1.], 3.0, false);
    let c = s.surface("CONICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[3.0, 45.0]);
    s.face("", c, &[(base, true)], true);
    let f = only(&s);
    assert_eq!(f.kind, SurfaceKind::Cone);
    assert_area(&f, PI * 3.0 * 3.0 * 2f64.sqrt());
}

#[test]
fn spheres_whole_capped_and_through_the_pole() {
    let r = 2.0;
    let sphere = |s: &mut Step| s.surface("SPHERICAL_SURFACE", [1., 2., 3.], [0., 0., 1.], &[r]);
    // Whole, bounded by a vertex.
    let mut s = Step::new(Unit::Millimetre);
    let l = s.vertex_loop([1., 2., 5.]);
    let c = sphere(&mut s);
    s.face("", c, &[(l, true)], true);
    assert_area(&only(&s), 4.0 * PI * r * r);
    // The small cap above z = 1 (relative to the centre), and the rest.
    let rho = (r * r - 1.0).sqrt();
    for (ccw, area) in [(true, TAU * r * (r - 1.0)), (false, TAU * r * (r + 1.0))] {
        let mut s = Step::new(Unit::Millimetre);
        let l = s.circle_loop([1., 2., 4.], [0., 0., 1.], rho, ccw);
        let c = sphere(&mut s);
        s.face("", c, &[(l, true)], true);
        assert_area(&only(&s), area);
    }
    // An octant with a corner at the pole.
    let mut s = Step::new(Unit::Millimetre);
    let l = s.octant([1., 2., 3.], r);
    let c = sphere(&mut s);
    s.face("", c, &[(l, true)], true);
    assert_area(&only(&s), FRAC_PI_2 * r * r);
}

#[test]
fn tori_between_circles_and_whole() {
    let (major, minor) = (5.0, 1.5);
    // The outer half: between the two circles at v = −90° and v = 90°.
    let mut s = Step::new(Unit::Millimetre);
    let low = s.circle_loop([0., 0., -minor], [0., 0., 1.], major, true);
    let high = s.circle_loop([0., 0., minor], [0., 0., 1.], major, false);
    let c = s.surface("TOROIDAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[major, minor]);
    s.face("", c, &[(low, true), (high, true)], true);
    let outer = TAU * minor * (PI * major + 2.0 * minor);
    assert_area(&only(&s), outer);
    // The other sense is the inner half.
    let mut s = Step::new(Unit::Millimetre);
    let low = s.circle_loop([0., 0., -minor], [0., 0., 1.], major, false);
    let high = s.circle_loop([0., 0., minor], [0., 0., 1.], major, true);
    let c = s.surface("TOROIDAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[major, minor]);
    s.face("", c, &[(low, true), (high, true)], true);
    assert_area(&only(&s), 4.0 * PI * PI * major * minor - outer);
    // Between two circles of the tube: a quarter of the whole.
    let mut s = Step::new(Unit::Millimetre);
    let a = s.circle_loop([major, 0., 0.], [0., -1., 0.], minor, false);
    let b = s.circle_loop([0., major, 0.], [1., 0., 0.], minor, true);
    let c = s.surface("TOROIDAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[major, minor]);
    s.face("", c, &[(a, true), (b, true)], true);
    let f = only(&s);
    assert_area(&f, PI * PI * major * minor);
}

#[test]
fn swept_and_offset_surfaces() {
    let mut s = Step::new(Unit::Millimetre);
    let circle = s.circle([0., 0., 0.], [0., 0., 1.], 2.0);
    let vector = s.vector([0., 0., 1.], 1.0);
    let c = s.add(&format!("SURFACE_OF_LINEAR_EXTRUSION('',#{circle},#{vector})"));
    let low = s.circle_loop([0., 0., 1.], [0., 0., 1.], 2.0, true);
    let high = s.circle_loop([0., 0., 4.], [0., 0., 1.], 2.0, false);
    s.face("", c, &[(low, true), (high, true)], true);
    let f = only(&s);
    assert_eq!(f.kind, SurfaceKind::Extrusion);
    assert_area(&f, TAU * 2.0 * 3.0);
    // A line turned about an axis: a frustum.
    let mut s = Step::new(Unit::Millimetre);
    let line = s.line([1., 0., 0.], [2., 0., 1.]);
    let axis = s.axis1([0., 0., 0.], [0., 0., 1.]);
    let c = s.add(&format!("SURFACE_OF_REVOLUTION('',#{line},#{axis})"));
    let low = s.circle_loop([0., 0., 0.], [0., 0., 1.], 1.0, true);
    let high = s.circle_loop([0., 0., 2.], [0., 0., 1.], 3.0, false);
    s.face("", c, &[(low, true), (high, true)], true);
    let f = only(&s);
    assert_eq!(f.kind, SurfaceKind::Revolution);
    assert_area(&f, PI * (1.0 + 3.0) * 8f64.sqrt());
    // An offset of a cylinder, 0.5 mm outward.
    let mut s = Step::new(Unit::Millimetre);
    let base = s.surface("CYLINDRICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[1.5]);
    let c = s.add(&format!("OFFSET_SURFACE('',#{base},0.5,.F.)"));
    let low = s.circle_loop([0., 0., 1.], [0., 0., 1.], 2.0, true);
    let high = s.circle_loop([0., 0., 4.], [0., 0., 1.], 2.0, false);
    s.face("", c, &[(low, true), (high, true)], true);
    let f = only(&s);
    assert_eq!(f.kind, SurfaceKind::Offset);
    assert_area(&f, TAU * 2.0 * 3.0);
}

#[test]
fn spline_surfaces_in_every_form() {
    let w = FRAC_PI_4.cos();
    // A quarter cylinder of radius 2 and height 3, rational; once with knots, once as a Bézier surface.
    for form in [
        "B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)",
        "BEZIER_SURFACE()",
        "QUASI_UNIFORM_SURFACE()",
    ] {
        let mut s = Step::new(Unit::Millimetre);
        let p: Vec<u64> = [[2., 0., 0.], [2., 0., 3.], [2., 2., 0.], [2., 2., 3.], [0., 2., 0.], [0., 2., 3.]]
            .iter()
            .map(|p| s.point(*p))
            .collect();
        let c = s.add(&format!(
            "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,((#{},#{}),(#{},#{}),(#{},#{})),.UNSPECIFIED.,.F.,.F.,.F.){form}\
             GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(((1.,1.),({w},{w}),(1.,1.)))REPRESENTATION_ITEM('')SURFACE())",
            p[0], p[1], p[2], p[3], p[4], p[5]
        ));
        s.geometric_set(&[c]);
        assert_area(&only(&s), PI * 3.0);
    }
    // A uniform biquadratic patch over the plane z = 0: its domain is the middle of the net.
    let mut s = Step::new(Unit::Millimetre);
    let mut rows = Vec::new();
    for i in 0..3 {
        let row: Vec<String> = (0..3).map(|j| format!("#{}", s.point([f64::from(i), f64::from(j), 0.]))).collect();
        rows.push(format!("({})", row.join(",")));
    }
    let c = s.add(&format!("UNIFORM_SURFACE('',2,2,({}),.UNSPECIFIED.,.F.,.F.,.F.)", rows.join(",")));
    s.geometric_set(&[c]);
    assert_area(&only(&s), 1.0);
}

#[test]
fn a_spline_edge_crosses_the_seam_of_a_closed_spline() {
    // A full cylinder as a closed rational spline, trimmed by a window across its seam (angle 0).
    let w = FRAC_PI_4.cos();
    let mut s = Step::new(Unit::Millimetre);
    let mut rows = Vec::new();
    let mut weights = Vec::new();
    for i in 0..9 {
        let a = f64::from(i) * FRAC_PI_4;
        let k = if i % 2 == 1 { 1.0 / w } else { 1.0 };
        let ids: Vec<String> =
            [-1., 6.].iter().map(|z| format!("#{}", s.point([2.0 * k * a.cos(), 2.0 * k * a.sin(), *z]))).collect();
        rows.push(format!("({})", ids.join(",")));
        let x = if i % 2 == 1 { w } else { 1.0 };
        weights.push(format!("({x},{x})"));
    }
    let c = s.add(&format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,({}),.UNSPECIFIED.,.T.,.F.,.F.)B_SPLINE_SURFACE_WITH_KNOTS((3,2,2,2,3),(2,2),(0.,1.,2.,3.,4.),(0.,1.),.UNSPECIFIED.)\
         GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({}))REPRESENTATION_ITEM('')SURFACE())",
        rows.join(","),
        weights.join(",")
    ));
    let l = s.cylinder_window(2.0, 0.0, 0.7, 1.0, 3.0);
    s.face("", c, &[(l, false)], true);
    let f = only(&s);
    assert_area(&f, 1.4 * 2.0 * 2.0);
    // The same surface between two circles.
    let low = s.circle_loop([0., 0., 0.], [0., 0., 1.], 2.0, true);
    let high = s.circle_loop([0., 0., 5.], [0., 0., 1.], 2.0, false);
    s.clear_faces();
    s.face("", c, &[(low, true), (high, true)], true);
    assert_area(&only(&s), TAU * 2.0 * 5.0);
}

#[test]
fn bounded_surfaces_without_topology() {
    let mut s = Step::new(Unit::Millimetre);
    let c = s.surface("CYLINDRICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[2.0]);
    let t = s.add(&format!("RECTANGULAR_TRIMMED_SURFACE('',#{c},5.,1.,0.,3.,.T.,.T.)"));
    s.geometric_set(&[t]);
    assert_area(&only(&s), 2.0 * (TAU - 4.0) * 3.0);
    let mut s = Step::new(Unit::Millimetre);
    let plane = s.plane([0., 0., 1.], [0., 0., 1.]);
    let corners = [[0., 0., 1.], [4., 0., 1.], [0., 3., 1.]];
    let segments: Vec<String> = (0..3)
        .map(|i| {
            let ids: Vec<String> =
                [corners[i], corners[(i + 1) % 3]].iter().map(|p| format!("#{}", s.point(*p))).collect();
            let line = s.add(&format!("POLYLINE('',({}))", ids.join(",")));
            format!("#{}", s.add(&format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{line})")))
        })
        .collect();
    let b = s.add(&format!("OUTER_BOUNDARY_CURVE('',({}),.F.)", segments.join(",")));
    let c = s.add(&format!("CURVE_BOUNDED_SURFACE('',#{plane},(#{b}),.F.)"));
    s.geometric_set(&[c]);
    assert_area(&only(&s), 6.0);
}

#[test]
fn trimmed_conics_and_poly_loops() {
    // A parabola and a chord: area 2/3 · width · height.
    let mut s = Step::new(Unit::Millimetre);
    let axis = s.axis([0., 0., 0.], [0., 0., 1.], [0., 1., 0.]);
    let parabola = s.add(&format!("PARABOLA('',#{axis},1.)"));
    // y = t², x = −2t (the frame's x is world y, its y is world −x).
    let (a, b) = ([4., 4., 0.], [-4., 4., 0.]);
    let l = s.curve_and_chord(parabola, a, b, true);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    assert_area(&only(&s), 2.0 / 3.0 * 8.0 * 4.0);
    // The branch x² − y² = 1 of a hyperbola cut off at x = cosh 1.
    let mut s = Step::new(Unit::Millimetre);
    let axis = s.axis([0., 0., 0.], [0., 0., 1.], [1., 0., 0.]);
    let hyperbola = s.add(&format!("HYPERBOLA('',#{axis},1.,1.)"));
    let (x, y) = (1f64.cosh(), 1f64.sinh());
    let l = s.curve_and_chord(hyperbola, [x, -y, 0.], [x, y, 0.], true);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    assert_area(&only(&s), x * y - 1.0);
    // An ellipse, whole.
    let mut s = Step::new(Unit::Millimetre);
    let axis = s.axis([0., 0., 0.], [0., 0., 1.], [1., 0., 0.]);
    let ellipse = s.add(&format!("ELLIPSE('',#{axis},4.,2.)"));
    let l = s.closed_curve_loop(ellipse, [4., 0., 0.], true);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    assert_area(&only(&s), 8.0 * PI);
    // A polyhedron's face.
    let mut s = Step::new(Unit::Millimetre);
    let ids: Vec<String> =
        [[0., 0., 0.], [2., 0., 0.], [2., 1., 0.]].iter().map(|p| format!("#{}", s.point(*p))).collect();
    let l = s.add(&format!("POLY_LOOP('',({}))", ids.join(",")));
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    assert_area(&only(&s), 1.0);
}

#[test]
fn units_scale_to_millimetres() {
    for (unit, name, mm) in [
        (Unit::Millimetre, "millimetre", 1.0),
        (Unit::Metre, "metre", 1000.0),
        (Unit::Inch, "inch", 25.4),
        (Unit::Foot, "foot", 304.8),
    ] {
        let mut s = Step::new(unit);
        let l = s.circle_loop([0., 0., 0.], [0., 0., 1.], 2.0, true);
        let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
        s.face("", plane, &[(l, true)], true);
        let m = model(&s);
        assert_eq!(m.unit, name);
        assert_area(&m.faces[0], 4.0 * PI * mm * mm);
    }
}

#[test]
fn bad_faces_are_named_and_the_rest_goes_on() {
    let mut s = Step::new(Unit::Millimetre);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    let good = s.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.]]);
    s.face("good", plane, &[(good, true)], true);
    let bow = s.polygon(&[[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.]]);
    let crossed = s.face("crossed", plane, &[(bow, true)], true);
    let missing = s.face("missing", 99_999, &[(good, true)], true);
    let sphere = s.surface("SPHERICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[-2.0]);
    let negative = s.face("negative", sphere, &[(good, true)], true);
    let far = s.polygon(&[[0., 0., 9.], [1., 0., 9.], [1., 1., 9.]]);
    let off = s.face("off", plane, &[(far, true)], true);
    let nan = s.raw_face_with("CARTESIAN_POINT('',(nan,0.,0.))");
    let m = model(&s);
    assert_eq!(m.faces.len(), 1);
    for (id, word) in [
        (crossed, "crosses"),
        (missing, "not in the file"),
        (negative, "positive"),
        (off, "away from the surface"),
        (nan, "finite"),
    ] {
        let reason = m.skipped.iter().find(|k| k.entity == Some(id)).map(|k| why(&k.reason)).unwrap_or_default();
        assert!(reason.contains(word), "#{id}: {reason}");
    }
}

#[test]
fn weights_must_be_positive() {
    for w in ["0.", "-1.", "nan"] {
        let mut s = Step::new(Unit::Millimetre);
        let p: Vec<u64> =
            [[0., 0., 0.], [0., 1., 0.], [1., 0., 0.], [1., 1., 0.]].iter().map(|p| s.point(*p)).collect();
        let c = s.add(&format!(
            "(BOUNDED_SURFACE()B_SPLINE_SURFACE(1,1,((#{},#{}),(#{},#{})),.UNSPECIFIED.,.F.,.F.,.F.)BEZIER_SURFACE()\
             RATIONAL_B_SPLINE_SURFACE(((1.,1.),(1.,{w})))SURFACE())",
            p[0], p[1], p[2], p[3]
        ));
        s.geometric_set(&[c]);
        match read(s.text().as_bytes()) {
            Err(ReadError::NoUsableFaces { entity, reason, .. }) => {
                assert_eq!(entity, c);
                assert!(reason.contains("weight 4"), "{reason}");
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn files_that_are_nothing_say_so() {
    assert_eq!(read(b"").err(), Some(ReadError::Empty));
    assert_eq!(read(b" \n\0").err(), Some(ReadError::Empty));
    assert!(matches!(read(b"solid cube\nfacet normal"), Err(ReadError::NotStep(s)) if s.contains("STL")));
    assert!(matches!(read(&[0xff, 0xfe, 0x00, 0x41]), Err(ReadError::NotStep(_))));
    assert!(matches!(read(b"ISO-10303-21;\nHEADER;\nFILE_DESC"), Err(ReadError::Truncated(_))));
    assert!(matches!(read(b"ISO-10303-21;HEADER;ENDSEC;DATA;\n#1=CART"), Err(ReadError::Truncated(_))));
    let hull = include_bytes!("../../../../data/hull.step");
    assert!(matches!(read(&hull[..4000]), Err(ReadError::Truncated(s)) if s.contains("line") && s.contains("after #")));
    // Cut between two records, before what says where the faces go.
    let end = hull.windows(5).position(|w| w == b"#164=").expect("the shape representation");
    assert!(matches!(read(&hull[..end]), Err(ReadError::Truncated(s)) if s.contains("#163")));
    // Only the last line is missing: nothing is lost.
    assert!(read(&hull[..hull.len() - b"ENDSEC;\nEND-ISO-10303-21;\n".len()]).is_ok());
    assert!(matches!(
        read(b"ISO-10303-21;DATA;#1=CARTESIAN_POINT('',(0.,0.,0.));ENDSEC;END-ISO-10303-21;"),
        Err(ReadError::NoFaces { records: 1, .. })
    ));
}

#[test]
fn careless_files_are_read() {
    let mut s = Step::new(Unit::Millimetre);
    let l = s.circle_loop([0., 0., 0.], [0., 0., 1.], 2.0, true);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("Körper", plane, &[(l, true)], true);
    let text = s.text();
    // Stray NULs, comments, repeated numbers, unknown records, no end, blanks everywhere, a name in Latin-1.
    let careless = text.replace("ENDSEC;\nEND-ISO-10303-21;", "").replace(";\n", ";\n/* note; #1=X( */ \0").replacen(
        "DATA;\n",
        "DATA;\n#900000=SOMETHING_NEW(1,(2,.X.),$,*);\n#1=OTHER();\n??? what\n",
        1,
    );
    let latin: Vec<u8> = careless.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')).collect();
    let m = read(&latin).expect("a model");
    assert_eq!(m.faces[0].name, "Körper");
    assert!(m.notes.iter().any(|n| words::note(n).contains("truncated")), "{:?}", m.notes);
    assert_eq!((m.faces.len(), m.skipped.len()), (1, 0));
}

#[test]
fn boundaries_that_enclose_nothing_are_no_faces() {
    let hull = include_str!("../../../../data/hull.step");
    let loop_of =
        |edges: &str| hull.replace("EDGE_LOOP('',(#155,#156,#157,#158))", &format!("EDGE_LOOP('',({edges}))"));
    let refused = |text: &str| match read(text.as_bytes()) {
        Err(ReadError::NoUsableFaces { entity: 161, reason, .. }) => reason,
        other => panic!("{other:?}"),
    };
    // One edge there and back.
    let slit =
        loop_of("#155,#999").replace("\nENDSEC;\nEND-ISO", "\n#999=ORIENTED_EDGE('',*,*,#107,.F.);\nENDSEC;\nEND-ISO");
    assert!(refused(&slit).contains("no area"));
    assert!(refused(&loop_of("")).contains("no edges"));
    assert!(refused(&loop_of("#155,#156,#158")).contains("open"));
    assert!(refused(&loop_of("#155,#156,#157,#158,#155,#156,#157,#158")).contains("touches itself"));
    // Weights that are not positive.
    let torus = include_str!("../../../../data/torus_piece.step");
    let at = torus.find("RATIONAL_B_SPLINE_SURFACE(((").expect("weights") + "RATIONAL_B_SPLINE_SURFACE(((".len();
    let end = at + torus[at..].find(',').expect("a list");
    for w in ["0.", "-1.", "NaN"] {
        let text = format!("{}{w}{}", &torus[..at], &torus[end..]);
        assert!(
            matches!(read(text.as_bytes()), Err(ReadError::NoUsableFaces { reason, .. }) if reason.contains("weight 1 "))
        );
    }
}
