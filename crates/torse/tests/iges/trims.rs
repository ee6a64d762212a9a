//! Trimmed and bounded surfaces.

use super::file::{entry, Entry, File};
use super::{area, has_area, model};
use std::f64::consts::{FRAC_PI_2, PI};
use torse::brep::raw::SurfaceKind;
use torse::certify::trims::trim_proof;
use torse::io::iges::read;
use torse::io::words::why;

const PART: &str = "00010000";
const FLAT: &str = "00010500";

fn part(kind: u32) -> Entry<'static> {
    Entry { status: PART, ..entry(kind) }
}

/// A rectangle of 4 by 3 with a triangle of area 1 and one of area 0.125 inside, in space and on the surface.
fn triangles(f: &mut File, kinds: [bool; 2]) -> (u64, Vec<u64>) {
    let surface = f.rectangle(part(128), 4.0, 3.0);
    let mut boundaries = Vec::new();
    for points in [[[1., 1.], [3., 1.], [3., 2.]], [[2.25, 1.125], [2.75, 1.125], [2.75, 1.625]]] {
        let space = if kinds[0] { f.polygon(&points.map(|p| [p[0], p[1], 0.0]), PART) } else { 0 };
        let plane = if kinds[1] { f.polygon(&points.map(|p| [p[0] / 4.0, p[1] / 3.0, 0.0]), FLAT) } else { 0 };
        let preference = if kinds[0] { 2 } else { 1 };
        boundaries.push(f.add(part(142), &format!("1,{surface},{plane},{space},{preference}")));
    }
    (surface, boundaries)
}

/// An indicator that is no normal may show to the wrong side; edges are on the right one.
#[test]
fn edges_tell_the_side_of_an_offset() {
    for indicator in ["0.,0.,1.", "1.,0.,0.1", "1.,0.,-0.1"] {
        let mut f = File::new();
        let flat = f.rectangle(part(128), 4.0, 3.0);
        let offset = f.add(part(140), &format!("{indicator},0.25,{flat}"));
        let edges = f.polygon(&[[1., 1., 0.25], [3., 1., 0.25], [3., 2., 0.25]], PART);
        let b = f.add(part(142), &format!("1,{offset},0,{edges},2"));
        f.add(entry(144), &format!("{offset},1,0,{b}"));
        let m = model(&f);
        has_area(&m.faces[0], 1.0);
        let bound = trim_proof(&m.faces[0], 1e-9).bound().value();
        assert!(bound < 1e-6, "{indicator}: {bound}");
    }
}

#[test]
fn either_sort_of_curves_bounds_a_surface() {
    for kinds in [[true, true], [true, false], [false, true]] {
        let mut f = File::new();
        let (surface, b) = triangles(&mut f, kinds);
        f.add(Entry { label: "TRIANGLE", ..entry(144) }, &format!("{surface},1,1,{},{}", b[0], b[1]));
        let m = model(&f);
        assert_eq!((m.faces.len(), m.faces[0].loops.len(), m.faces[0].name.as_str()), (1, 2, "TRIANGLE"));
        has_area(&m.faces[0], 0.875);
        // Images of lines on a plane patch are exact: nothing is missed but rounding.
        assert!(trim_proof(&m.faces[0], 1e-9).bound().value() < 1e-6);
    }
}

#[test]
fn the_sides_of_the_surface_are_the_outer_boundary_if_none_is_given() {
    let mut f = File::new();
    let (surface, b) = triangles(&mut f, [true, true]);
    f.add(entry(144), &format!("{surface},0,1,0,{}", b[0]));
    let m = model(&f);
    has_area(&m.faces[0], 11.0);
    assert!(trim_proof(&m.faces[0], 1e-9).bound().value() < 1e-6);
    let mut f = File::new();
    let (surface, _) = triangles(&mut f, [true, true]);
    f.add(entry(144), &format!("{surface},0,0,0"));
    has_area(&model(&f).faces[0], 12.0);
}

#[test]
fn the_preferred_curve_decides_where_both_differ_unless_it_is_far_off() {
    for (preference, y, wanted) in [(1, 2.04, 1.04), (2, 2.04, 1.0), (1, 2.9, 1.0)] {
        let mut f = File::new();
        let surface = f.rectangle(part(128), 4.0, 3.0);
        let space = f.polygon(&[[1., 1., 0.], [3., 1., 0.], [3., 2., 0.]], PART);
        let plane = f.polygon(&[[0.25, 1. / 3., 0.], [0.75, 1. / 3., 0.], [0.75, y / 3., 0.]], FLAT);
        let b = f.add(part(142), &format!("1,{surface},{plane},{space},{preference}"));
        f.add(entry(144), &format!("{surface},1,0,{b}"));
        has_area(&model(&f).faces[0], wanted);
    }
}

/// Curves in space that no side of the surface can be are no reason not to follow those that the file prefers.
#[test]
fn preferred_curves_are_followed_where_those_in_space_are_off_the_surface() {
    let mut f = File::new();
    let surface = f.rectangle(part(128), 4.0, 3.0);
    let space = f.polygon(&[[1., 1., 3.], [3., 1., 3.], [3., 2., 3.]], PART);
    let plane = f.polygon(&[[0.25, 1. / 3., 0.], [0.75, 1. / 3., 0.], [0.75, 2. / 3., 0.]], FLAT);
    let b = f.add(part(142), &format!("1,{surface},{plane},{space},1"));
    f.add(entry(144), &format!("{surface},1,0,{b}"));
    let m = model(&f);
    has_area(&m.faces[0], 1.0);
    assert!(trim_proof(&m.faces[0], 1e-9).bound().value() < 1e-6);
}

/// A side that runs beyond its beginning and back again, all on one line, is the line.
#[test]
fn sides_that_run_to_and_fro_bound_what_their_ends_do() {
    let mut f = File::new();
    let surface = f.rectangle(part(128), 4.0, 3.0);
    let third = "0.333333333333333";
    let flat = |kind: u32| Entry { status: FLAT, ..entry(kind) };
    let points = ["0.25", "0.35", "0.1", "0.75"].map(|u| format!("{u},{third},0.")).join(",");
    let data = format!("3,3,1,0,1,0,0.,0.,0.,0.,1.,1.,1.,1.,1.,1.,1.,1.,{points},0.,1.,0.,0.,1.");
    let first = f.add(flat(126), &data);
    let second = f.add(flat(110), &format!("0.75,{third},0.,0.75,0.666666666666667,0."));
    let last = f.add(flat(110), &format!("0.75,0.666666666666667,0.,0.25,{third},0."));
    let plane = f.add(flat(102), &format!("3,{first},{second},{last}"));
    let b = f.add(part(142), &format!("1,{surface},{plane},0,1"));
    f.add(entry(144), &format!("{surface},1,0,{b}"));
    let m = model(&f);
    has_area(&m.faces[0], 1.0);
    assert!(trim_proof(&m.faces[0], 1e-9).bound().value() < 1e-6);
}

#[test]
fn bounded_surfaces_list_their_curves_with_senses() {
    let mut f = File::new();
    let surface = f.rectangle(part(128), 4.0, 3.0);
    let lines: Vec<u64> =
        ["1.,1.,0.,3.,1.,0.", "3.,2.,0.,3.,1.,0.", "3.,2.,0.,1.,1.,0."].iter().map(|l| f.add(part(110), l)).collect();
    let b = f.add(part(141), &format!("0,1,{surface},3,{},1,0,{},2,0,{},1,0", lines[0], lines[1], lines[2]));
    f.add(entry(143), &format!("0,{surface},1,{b}"));
    has_area(&model(&f).faces[0], 1.0);
}

#[test]
fn a_tube_is_cut_at_its_seam_whatever_the_sense_of_its_circles() {
    for senses in ["2.,0.,2.,0.", "2.,0.,2.,0."] {
        let mut f = File::new();
        let axis = f.add(part(110), "0.,0.,0.,0.,0.,1.");
        let line = f.add(part(110), "2.,0.,-9.,2.,0.,9.");
        let surface = f.add(part(120), &format!("{axis},{line},0.,6.28318530717959"));
        let low = f.add(part(100), &format!("1.,0.,0.,{senses}"));
        let high = f.add(part(100), &format!("4.,0.,0.,{senses}"));
        let [a, b] = [low, high].map(|c| f.add(part(142), &format!("0,{surface},0,{c},2")));
        f.add(entry(144), &format!("{surface},1,1,{a},{b}"));
        let m = model(&f);
        assert_eq!(m.faces[0].kind, SurfaceKind::Cylinder);
        has_area(&m.faces[0], 12.0 * PI);
    }
}

#[test]
fn quarter_spheres_take_the_side_that_the_parameter_plane_says() {
    // The sphere of radius 2 about the origin with a generatrix from pole to pole; a lune of a quarter turn: the side
    // at a pole is left out in the parameter plane.
    for (v0, v1) in [(0.0, FRAC_PI_2), (FRAC_PI_2, 2.0 * PI)] {
        let mut f = File::new();
        let axis = f.add(part(110), "0.,0.,0.,0.,1.,0.");
        let arc = f.add(part(100), "0.,0.,0.,0.,-2.,0.,2.");
        let surface = f.add(part(120), &format!("{axis},{arc},0.,6.28318530717959"));
        let (lo, hi) = (-FRAC_PI_2, FRAC_PI_2);
        let flat: Vec<u64> = [[hi, v1, lo, v1], [lo, v0, hi, v0]]
            .iter()
            .map(|p| {
                f.add(
                    Entry { status: FLAT, ..entry(110) },
                    &format!("{:?},{:?},0.,{:?},{:?},0.", p[0], p[1], p[2], p[3]),
                )
            })
            .collect();
        // Meridians: turned by v about the y axis, down at v1 and up at v0.
        let meridian = |f: &mut File, v: f64, down: bool| {
            // Arcs run counter-clockwise: one that runs down is on the other side before it is turned.
            let (s, c) = if down { v + PI } else { v }.sin_cos();
            let m = f.add(entry(124), &format!("{c:?},0.,{s:?},0.,0.,1.,0.,0.,{:?},0.,{c:?},0.", -s));
            let arc = if down { "0.,0.,0.,0.,2.,0.,-2." } else { "0.,0.,0.,0.,-2.,0.,2." };
            f.add(Entry { matrix: m, ..part(100) }, arc)
        };
        let space = [meridian(&mut f, v1, true), meridian(&mut f, v0, false)];
        let b = f.add(part(102), &format!("2,{},{}", flat[0], flat[1]));
        let c = f.add(part(102), &format!("2,{},{}", space[0], space[1]));
        let b = f.add(part(142), &format!("0,{surface},{b},{c},2"));
        f.add(entry(144), &format!("{surface},1,0,{b}"));
        let m = read::read(&f.bytes()).expect("a model");
        let wanted = 16.0 * PI * (v1 - v0) / (2.0 * PI);
        assert!((area(&m.faces[0]) / wanted - 1.0).abs() < 1e-3, "{} instead of {wanted}", area(&m.faces[0]));
    }
}

/// A curve of the parameter plane and the one of space that goes with it.
type Pair = (u64, u64);

/// A straight piece of a parameter line `from → to` of what `meridian` is turned to about the y axis, and the arc that it is.
fn piece(
    f: &mut File,
    [p, q]: [[f64; 2]; 2],
    meridian: &dyn Fn(&mut File, [f64; 2], u64) -> u64,
    at: [f64; 2],
) -> Pair {
    let flat = format!("{:?},{:?},0.,{:?},{:?},0.", p[0], p[1], q[0], q[1]);
    let flat = f.add(Entry { status: FLAT, ..entry(110) }, &flat);
    if p[1] == q[1] {
        // Arcs run counter-clockwise: one that runs back is turned about the x axis.
        let ((s, c), way) = (p[1].sin_cos(), if p[0] < q[0] { 1.0 } else { -1.0 });
        let turn = format!("{c:?},0.,{:?},0.,0.,{way:?},0.,0.,{:?},0.,{:?},0.", way * s, -s, way * c);
        let turn = f.add(entry(124), &turn);
        return (flat, meridian(f, [way * p[0], way * q[0]], turn));
    }
    let [radius, level] = at;
    let way = if p[1] < q[1] { 1.0 } else { -1.0 };
    let turn = f.add(entry(124), &format!("1.,0.,0.,0.,0.,0.,{way:?},0.,0.,{:?},0.,0.", -way));
    let [(s0, c0), (s1, c1)] = [p, q].map(|x| (way * x[1]).sin_cos());
    let [x0, y0, x1, y1] = [c0, s0, c1, s1].map(|x| radius * x);
    let arc = format!("{:?},0.,0.,{x0:?},{y0:?},{x1:?},{y1:?}", way * level);
    (flat, f.add(Entry { matrix: turn, ..part(100) }, &arc))
}

/// The face inside one boundary of such pieces, of the surface about the y axis.
fn turned_inside(f: &mut File, generatrix: u64, pieces: &[Pair]) -> torse::Model {
    let axis = f.add(part(110), "0.,0.,0.,0.,1.,0.");
    let surface = f.add(part(120), &format!("{axis},{generatrix},0.,6.28318530717959"));
    let list = |one: fn(&Pair) -> u64| pieces.iter().map(|p| format!(",{}", one(p))).collect::<String>();
    let [flat, space] = [list(|p| p.0), list(|p| p.1)].map(|l| f.add(part(102), &format!("{}{l}", pieces.len())));
    let b = f.add(part(142), &format!("0,{surface},{flat},{space},3"));
    f.add(entry(144), &format!("{surface},1,0,{b}"));
    model(f)
}

#[test]
fn of_a_closed_meridian_that_meets_the_axis_the_part_is_turned() {
    // Zone of the spheroid x² + y²/4 + z² = 1 up to y = ±1; all of the ellipse turned covers it twice.
    let mut f = File::new();
    let ellipse = |f: &mut File, [from, to]: [f64; 2], matrix: u64| {
        let [(s0, c0), (s1, c1)] = [from, to].map(f64::sin_cos);
        let data = format!("1.,0.,0.25,0.,0.,-1.,0.,{c0:?},{:?},{c1:?},{:?}", 2.0 * s0, 2.0 * s1);
        f.add(Entry { matrix, form: 1, ..part(104) }, &data)
    };
    let (a, r) = (PI / 6.0, 0.75_f64.sqrt());
    let generatrix = ellipse(&mut f, [-a, a], 0);
    let corners = [[-a, 0.0], [a, 0.0], [a, 2.0 * PI], [-a, 2.0 * PI], [-a, 0.0]];
    let pieces: Vec<Pair> =
        corners.windows(2).map(|w| piece(&mut f, [w[0], w[1]], &ellipse, [r, 2.0 * w[0][0].sin()])).collect();
    let m = turned_inside(&mut f, generatrix, &pieces);
    has_area(&m.faces[0], 2.0 * PI * (0.5 * 3.25_f64.sqrt() + 4.0 / 3.0_f64.sqrt() * (0.25 * 3.0_f64.sqrt()).asin()));
}

#[test]
fn a_hole_at_the_seam_of_a_torus_is_a_hole_though_the_curves_jump_from_corner_to_corner() {
    let mut f = File::new();
    let circle = |f: &mut File, [from, to]: [f64; 2], matrix: u64| {
        let [(s0, c0), (s1, c1)] = [from, to].map(f64::sin_cos);
        f.add(Entry { matrix, ..part(100) }, &format!("0.,5.,0.,{:?},{s0:?},{:?},{s1:?}", 5.0 + c0, 5.0 + c1))
    };
    let generatrix = circle(&mut f, [0.0, 2.0 * PI], 0);
    let (full, w, (a, b)) = (2.0 * PI, 0.3, (2.0, 2.5));
    let runs: [&[[f64; 2]]; 4] = [
        &[[a, full], [0.0, full], [0.0, 0.0]],
        &[[full, full], [b, full], [a, full]],
        &[[a, 0.0], [a, w], [b, w], [b, 0.0], [full, 0.0], [full, full]],
        &[[0.0, 0.0], [a, 0.0]],
    ];
    let mut pieces = Vec::new();
    for pair in runs.iter().flat_map(|r| r.windows(2)) {
        let (s, c) = pair[0][0].sin_cos();
        pieces.push(piece(&mut f, [pair[0], pair[1]], &circle, [5.0 + c, s]));
    }
    let m = turned_inside(&mut f, generatrix, &pieces);
    has_area(&m.faces[0], 20.0 * PI * PI - w * (5.0 * (b - a) + b.sin() - a.sin()));
}

#[test]
fn transformations_move_surface_and_curves_by_themselves() {
    let mut f = File::new();
    // A quarter turn about x that takes y to z, and a shift.
    let turn = f.add(entry(124), "1.,0.,0.,10.,0.,0.,-1.,0.,0.,1.,0.,0.");
    let up = f.add(Entry { matrix: 0, ..entry(124) }, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,100.");
    let surface = f.rectangle(Entry { matrix: turn, ..part(128) }, 4.0, 3.0);
    let c = f.polygon(&[[11., 0., 1.], [13., 0., 1.], [13., 0., 2.]], PART);
    let b = f.add(part(142), &format!("0,{surface},0,{c},2"));
    f.add(Entry { matrix: up, ..entry(144) }, &format!("{surface},1,0,{b}"));
    let m = model(&f);
    has_area(&m.faces[0], 1.0);
    let s = &m.faces[0].surface;
    let p = m.faces[0].loops[0].points[0];
    let x = s.point(p[0], p[1]);
    assert!(x.y.abs() < 1e-12 && x.z > 100.9 && x.z < 102.1 && x.x > 10.9, "{x:?}");
    // A mirror turns the normal round.
    let mut f = File::new();
    let mirror = f.add(Entry { form: 1, ..entry(124) }, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,-1.,0.");
    f.rectangle(Entry { matrix: mirror, ..entry(128) }, 4.0, 3.0);
    let m = model(&f);
    assert!(m.faces[0].reversed);
}

#[test]
fn lost_faces_are_named_with_their_area() {
    let mut f = File::new();
    let (surface, b) = triangles(&mut f, [true, false]);
    f.add(entry(144), &format!("{surface},1,0,{}", b[1]));
    let open = f.add(part(102), "2,3,5");
    let bad = f.add(part(142), &format!("0,{surface},0,{open},2"));
    let lost = f.add(entry(144), &format!("{surface},1,0,{bad}"));
    let m = read::read(&f.bytes()).expect("a model");
    assert_eq!(m.faces.len(), 1);
    assert_eq!(m.skipped.len(), 1);
    assert_eq!(m.skipped[0].entity, Some(lost));
    let reason = why(&m.skipped[0].reason);
    assert!(reason.contains("open"), "{reason}");
    assert!(m.skipped[0].area_estimate.is_some_and(|a| (a - 1.0).abs() < 0.2));
}
