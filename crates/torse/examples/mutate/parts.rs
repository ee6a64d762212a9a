//! Small STEP files, each with one sort of surface, boundary or assembly, by the writer of the reader's own tests.

#[expect(dead_code, reason = "the reader's own tests write more sorts of records")]
#[path = "../../tests/step/text.rs"]
mod text;

use text::{Step, Unit};

const O: [f64; 3] = [0., 0., 0.];
const Z: [f64; 3] = [0., 0., 1.];
const SQUARE: [[f64; 3]; 4] = [[0., 0., 0.], [10., 0., 0.], [10., 8., 0.], [0., 8., 0.]];

/// All of them.
#[expect(clippy::too_many_lines, reason = "one kind of part after another")]
pub fn all() -> Vec<String> {
    let made: [fn(&mut Step); 26] = [
        |s| {
            let (outer, hole) = (s.polygon(&SQUARE), s.circle_loop([5., 4., 0.], Z, 2., false));
            let plane = s.plane(O, Z);
            s.face("deck", plane, &[(outer, true), (hole, true)], true);
        },
        |s| {
            let window = s.cylinder_window(2., 1., 0.5, 1., 2.);
            round(s, "CYLINDRICAL_SURFACE", &[2.], [(0., 2.), (5., 2.)], Some(window));
        },
        |s| {
            let l = s.seamed_tube(2., 5.);
            let c = s.surface("CYLINDRICAL_SURFACE", O, Z, &[2.]);
            s.face("tube", c, &[(l, true)], true);
        },
        |s| {
            let base = s.circle_loop(O, Z, 3., false);
            let c = s.surface("CONICAL_SURFACE", O, Z, &[3., 0.5]);
            s.face("cone", c, &[(base, true)], true);
        },
        |s| {
            let cap = s.circle_loop([0., 0., 1.], Z, 3f64.sqrt(), true);
            let c = s.surface("SPHERICAL_SURFACE", O, Z, &[2.]);
            s.face("cap", c, &[(cap, true)], true);
        },
        |s| {
            let l = s.octant(O, 2.);
            let c = s.surface("SPHERICAL_SURFACE", O, Z, &[2.]);
            s.face("octant", c, &[(l, true)], true);
        },
        |s| {
            let l = s.vertex_loop([0., 0., 2.]);
            let c = s.surface("SPHERICAL_SURFACE", O, Z, &[2.]);
            s.face("ball", c, &[(l, true)], true);
        },
        |s| round(s, "TOROIDAL_SURFACE", &[5., 1.], [(-1., 5.), (1., 5.)], None),
        |s| {
            let (a, b) = (
                s.circle_loop([5., 0., 0.], [0., -1., 0.], 1.5, false),
                s.circle_loop([0., 5., 0.], [1., 0., 0.], 1.5, true),
            );
            let c = s.surface("TOROIDAL_SURFACE", O, Z, &[5., 1.5]);
            s.face("bend", c, &[(a, true), (b, true)], true);
        },
        |s| {
            let (circle, vector) = (s.circle(O, Z, 2.), s.vector(Z, 1.));
            let c = s.add(&format!("SURFACE_OF_LINEAR_EXTRUSION('',#{circle},#{vector})"));
            between(s, c, [(1., 2.), (4., 2.)]);
        },
        |s| {
            let (line, axis) = (s.line([1., 0., 0.], [2., 0., 1.]), s.axis1(O, Z));
            let c = s.add(&format!("SURFACE_OF_REVOLUTION('',#{line},#{axis})"));
            between(s, c, [(0., 1.), (2., 3.)]);
        },
        |s| {
            let base = s.surface("CYLINDRICAL_SURFACE", O, Z, &[1.5]);
            let c = s.add(&format!("OFFSET_SURFACE('',#{base},0.5,.F.)"));
            between(s, c, [(1., 2.), (4., 2.)]);
        },
        |s| {
            let patch = patch(s);
            let off = s.add(&format!("OFFSET_SURFACE('',#{patch},0.05,.F.)"));
            s.geometric_set(&[patch, off]);
        },
        |s| {
            let patch = patch(s);
            let t = s.add(&format!("RECTANGULAR_TRIMMED_SURFACE('',#{patch},0.1,0.8,0.2,0.9,.T.,.T.)"));
            s.geometric_set(&[t]);
        },
        rational,
        closed,
        |s| {
            let c = s.surface("CYLINDRICAL_SURFACE", O, Z, &[2.]);
            let t = s.add(&format!("RECTANGULAR_TRIMMED_SURFACE('',#{c},5.,1.,0.,3.,.T.,.T.)"));
            s.geometric_set(&[t]);
        },
        chain,
        |s| {
            let axis = s.axis(O, Z, [0., 1., 0.]);
            let parabola = s.add(&format!("PARABOLA('',#{axis},1.)"));
            let l = s.curve_and_chord(parabola, [4., 4., 0.], [-4., 4., 0.], true);
            let plane = s.plane(O, Z);
            s.face("", plane, &[(l, true)], true);
        },
        |s| {
            let axis = s.axis(O, Z, [1., 0., 0.]);
            let hyperbola = s.add(&format!("HYPERBOLA('',#{axis},1.,1.)"));
            let (x, y) = (1f64.cosh(), 1f64.sinh());
            let l = s.curve_and_chord(hyperbola, [x, -y, 0.], [x, y, 0.], true);
            let plane = s.plane(O, Z);
            s.face("", plane, &[(l, true)], true);
        },
        |s| {
            let axis = s.axis(O, Z, [1., 0., 0.]);
            let ellipse = s.add(&format!("ELLIPSE('',#{axis},4.,2.)"));
            let l = s.closed_curve_loop(ellipse, [4., 0., 0.], true);
            let plane = s.plane(O, Z);
            s.face("", plane, &[(l, true)], true);
            s.raw_face_with("CARTESIAN_POINT('',(0.,0.,0.))");
        },
        |s| {
            let l = s.polygon(&SQUARE);
            let plane = s.plane(O, Z);
            s.face("", plane, &[(l, true)], true);
            s.occurrence([10., 0., 0.], Z, [0., 1., 0.], false);
            s.occurrence([0., 0., 5.], Z, [1., 0., 0.], true);
            s.mapped([1., 2., 3.]);
        },
        |s| {
            let l = s.polygon(&SQUARE);
            let plane = s.plane(O, Z);
            let bound = s.add(&format!("FACE_OUTER_BOUND('',#{l},.T.)"));
            let base = s.add(&format!("ADVANCED_FACE('base',(#{bound}),#{plane},.T.)"));
            let way = s.add("DIRECTION('',(0.,0.,1.))");
            let solid = s.add(&format!("EXTRUDED_FACE_SOLID('prism',#{base},#{way},5.)"));
            s.geometric_set(&[solid]);
        },
        pcurve,
        solid,
        free_curves,
    ];
    let units = [Unit::Millimetre, Unit::MillimetreDegree, Unit::Metre, Unit::Inch, Unit::Foot];
    let file = |(k, make): (usize, fn(&mut Step))| {
        // Cones are written with their angle in radians.
        let mut s = Step::new(if k % 3 == 0 { Unit::Millimetre } else { units[(k / 3) % 5] });
        make(&mut s);
        s.text()
    };
    made.into_iter().enumerate().map(file).collect()
}

/// A face between two circles about z, each by its height and radius.
fn between(s: &mut Step, surface: u64, circles: [(f64, f64); 2]) {
    let [low, high] = circles;
    let (a, b) = (s.circle_loop([0., 0., low.0], Z, low.1, true), s.circle_loop([0., 0., high.0], Z, high.1, false));
    s.face("round", surface, &[(a, true), (b, true)], true);
}

fn round(s: &mut Step, kind: &str, sizes: &[f64], circles: [(f64, f64); 2], window: Option<u64>) {
    let c = s.surface(kind, O, Z, sizes);
    between(s, c, circles);
    window.into_iter().for_each(|w| s.add_bound(w));
}

/// A biquadratic patch.
fn patch(s: &mut Step) -> u64 {
    let p: Vec<String> =
        (0..9).map(|i| format!("#{}", s.point([f64::from(i / 3), f64::from(i % 3), f64::from(i * i % 4)]))).collect();
    s.add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',2,2,(({}),({}),({})),.UNSPECIFIED.,.F.,.F.,.F.,(3,3),(3,3),(0.,1.),(0.,1.),\
         .UNSPECIFIED.)",
        p[0..3].join(","),
        p[3..6].join(","),
        p[6..9].join(",")
    ))
}

/// A quarter of a cylinder, rational, trimmed by a polygon with a spline side.
fn rational(s: &mut Step) {
    let w = 0.5f64.sqrt();
    let p = [[2., 0., 0.], [2., 0., 3.], [2., 2., 0.], [2., 2., 3.], [0., 2., 0.], [0., 2., 3.]].map(|p| s.point(p));
    let c = s.add(&format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,((#{},#{}),(#{},#{}),(#{},#{})),.UNSPECIFIED.,.F.,.F.,.F.)\
         B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()\
         RATIONAL_B_SPLINE_SURFACE(((1.,1.),({w},{w}),(1.,1.)))REPRESENTATION_ITEM('')SURFACE())",
        p[0], p[1], p[2], p[3], p[4], p[5]
    ));
    let side = s.add(&format!(
        "(BOUNDED_CURVE()B_SPLINE_CURVE(2,(#{},#{},#{}),.UNSPECIFIED.,.F.,.F.)B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),\
         .UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE((1.,{w},1.))REPRESENTATION_ITEM(''))",
        p[0], p[2], p[4]
    ));
    let l = s.curve_and_polygon(side, &[[2., 0., 0.], [0., 2., 0.], [0., 2., 3.], [2. * w, 2. * w, 3.], [2., 0., 3.]]);
    s.face("quarter", c, &[(l, true)], true);
    s.geometric_set(&[c]);
}

/// A closed rational spline, trimmed by a window across its seam.
fn closed(s: &mut Step) {
    let w = 0.5f64.sqrt();
    let (mut rows, mut weights) = (Vec::new(), Vec::new());
    for i in 0..9 {
        let (a, x) = (f64::from(i) * std::f64::consts::FRAC_PI_4, if i % 2 == 1 { w } else { 1. });
        let ids = [-1., 6.].map(|z| format!("#{}", s.point([2. / x * a.cos(), 2. / x * a.sin(), z])));
        rows.push(format!("({})", ids.join(",")));
        weights.push(format!("({x},{x})"));
    }
    let c = s.add(&format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,({}),.UNSPECIFIED.,.T.,.F.,.F.)B_SPLINE_SURFACE_WITH_KNOTS((3,2,2,2,3),(2,2),\
         (0.,1.,2.,3.,4.),(0.,1.),.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({}))\
         REPRESENTATION_ITEM('')SURFACE())",
        rows.join(","),
        weights.join(",")
    ));
    let l = s.cylinder_window(2., 0., 0.7, 1., 3.);
    s.face("", c, &[(l, false)], true);
}

/// A surface bounded by a chain of trimmed lines.
fn chain(s: &mut Step) {
    let plane = s.plane(O, Z);
    let segments: Vec<String> = (0..4)
        .map(|i| {
            let (p, q) = (SQUARE[i], SQUARE[(i + 1) % 4]);
            let (line, a, b) = (s.line(p, q), s.point(p), s.point(q));
            let part = s.add(&format!("TRIMMED_CURVE($,#{line},(#{a}),(#{b}),.T.,.CARTESIAN.)"));
            format!("#{}", s.add(&format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{part})")))
        })
        .collect();
    let b = s.add(&format!("OUTER_BOUNDARY_CURVE('',({}),.F.)", segments.join(",")));
    let c = s.add(&format!("CURVE_BOUNDED_SURFACE('',#{plane},(#{b}),.F.)"));
    s.geometric_set(&[c]);
}

/// A side in the parameter plane only.
fn pcurve(s: &mut Step) {
    let plane = s.plane(O, Z);
    let (p, d) = (s.add("CARTESIAN_POINT('',(0.,0.))"), s.add("DIRECTION('',(1.,0.))"));
    let v = s.add(&format!("VECTOR('',#{d},10.)"));
    let line = s.add(&format!("LINE('',#{p},#{v})"));
    let part = s.add(&format!("TRIMMED_CURVE('',#{line},(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.)"));
    let flat = s.add(&format!("DEFINITIONAL_REPRESENTATION('',(#{part}),#1)"));
    let pcurve = s.add(&format!("PCURVE('',#{plane},#{flat})"));
    let l = s.curve_and_polygon(pcurve, &SQUARE);
    s.face("", plane, &[(l, true)], true);
}

/// A solid in parts, with triangles.
fn solid(s: &mut Step) {
    let (l, plane) = (s.polygon(&SQUARE), s.plane(O, Z));
    let bound = s.add(&format!("FACE_OUTER_BOUND('',#{l},.T.)"));
    let face = s.add(&format!("ADVANCED_FACE('',(#{bound}),#{plane},.T.)"));
    let shell = s.add(&format!("CLOSED_SHELL('',(#{face}))"));
    let solid = s.add(&format!(
        "(FACETED_BREP()GEOMETRIC_REPRESENTATION_ITEM()MANIFOLD_SOLID_BREP(#{shell})REPRESENTATION_ITEM('')SOLID_MODEL())"
    ));
    let lone = s.add("TRIANGULATED_FACE('',$,3,(),$,(),())");
    let mesh = s.add(&format!("TESSELLATED_SOLID('',(#{lone}),$)"));
    s.geometric_set(&[solid, mesh]);
}

/// Curves without faces.
fn free_curves(s: &mut Step) {
    let p = [[0., 0., 0.], [1., 2., 0.], [3., 2., 1.], [5., 0., 0.], [7., 1., 0.]].map(|p| s.point(p));
    let spline = s.add(&format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',3,(#{},#{},#{},#{},#{}),.UNSPECIFIED.,.F.,.F.,(4,1,4),(0.,0.5,1.),.UNSPECIFIED.)",
        p[0], p[1], p[2], p[3], p[4]
    ));
    let line = s.add(&format!("POLYLINE('',(#{},#{},#{}))", p[0], p[1], p[2]));
    let circle = s.circle(O, Z, 2.);
    let arc =
        s.add(&format!("TRIMMED_CURVE('',#{circle},(PARAMETER_VALUE(0.5)),(PARAMETER_VALUE(2.)),.T.,.PARAMETER.)"));
    s.geometric_set(&[spline, line, arc]);
}
