//! Parts laid flat as they are written for CAD, read back from each format: no face is lost, and areas stay.

use torse::answer::presentation::present;
use torse::brep::area::area_estimate;
use torse::brep::face::Face;
use torse::brep::support_surface::SupportSurface;
use torse::geom::{Frame, Vec3};
use torse::io::bundle;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::{Control, CurveOptions, Model, Status, UnrollOptions};

/// Parts that are written.
const PARTS: usize = 40;
/// Share by which areas read from the formats may differ, and those of panels from their faces': trims of panels that are to
/// be looked at keep to a hundred thousandth of the size.
const SAME: (f64, f64) = (1e-6, 1e-5);

/// Numbers that look random and are the same every time: the shares that the golden ratio leaves.
fn share(k: usize, kind: usize) -> f64 {
    ((k * 7 + kind + 1) as f64 * 0.618_033_988_749_895).fract()
}

/// A placed plane, cylinder, cone, or general cylinder or cone.
fn face(k: usize) -> Face {
    let of = |kind: usize, lo: f64, hi: f64| lo + (hi - lo) * share(k, kind);
    let z = Vec3::new(of(0, -1.0, 1.0), of(1, -1.0, 1.0), of(2, 0.2, 1.0)).normalize();
    let x = z.cross(&Vec3::new(0.3, -0.8, 0.1)).normalize();
    let frame = Frame { origin: Vec3::new(of(3, -500.0, 500.0), of(4, -500.0, 500.0), 0.0), x, y: z.cross(&x), z };
    let (turn, height) = (of(5, 0.4, 3.0), of(6, 30.0, 300.0));
    let radius = of(1, 40.0, 250.0);
    let support = match k % 4 {
        0 => SupportSurface::Cylinder { frame, radius },
        1 => SupportSurface::Cone { frame, radius, slope: of(2, -0.1, 0.6) },
        2 => SupportSurface::Plane(frame),
        _ => {
            // A parabola and its image moved or drawn together.
            let to_space = |x: f64, y: f64, z: f64| frame.origin + frame.x * x + frame.y * y + frame.z * z;
            let points: Vec<Vec3> = [(0.0, 0.0), (0.5, of(0, 0.2, 0.6)), (1.0, of(1, -0.1, 0.1))]
                .iter()
                .flat_map(|(a, b)| {
                    let (a, b, s) = (a * radius, b * radius, if k % 8 == 3 { 1.0 } else { 0.6 });
                    [to_space(a, b, 0.0), to_space(a * s, b * s, height)]
                })
                .collect();
            let knots = |degree| Knots::clamped(degree, &[0.0, 1.0]).expect("knots");
            return Face::untrimmed(Surface::new(knots(2), knots(1), &points, None).expect("a surface"));
        }
    };
    Face::untrimmed(support.to_spline((0.0, turn), (0.0, height)).expect("a spline").0)
}

#[test]
fn faces_are_read_back_from_every_format_with_their_areas() {
    for k in 0..PARTS {
        let given = face(k);
        let area = area_estimate(&given);
        let model = Model {
            faces: vec![given],
            skipped: Vec::new(),
            notes: Vec::new(),
            unit: String::new(),
            products: Vec::new(),
            curves: Vec::new(),
        };
        let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(0.01) };
        let mut answer = torse::unroll(&model, &options, &Control::default()).expect("a part");
        assert_eq!(answer.status(), Status::Certified, "part {k}: {:?}", answer.claims());
        (answer.cut.iges, answer.cut.threedm) = (true, true);
        let files = bundle::geometry(&answer, &present(&answer), "2026-01-01T00:00:00").expect("files");
        let mut first = None;
        for name in ["panels.step", "panels.igs", "panels.3dm"] {
            let (_, bytes) = files.iter().find(|f| f.0 == name).expect("a file");
            let back = torse::read(bytes).expect("a model");
            assert!(back.skipped.is_empty(), "part {k}, {name}: {:?}", back.skipped);
            assert_eq!(back.faces.len(), answer.patchwork().panels.len(), "part {k}, {name}");
            let read: f64 = back.faces.iter().map(area_estimate).sum();
            assert!((read - area).abs() < SAME.1 * area, "part {k}, {name}: {read} {area}");
            let same = *first.get_or_insert(read);
            assert!((read - same).abs() < SAME.0 * area, "part {k}, {name}: {read} {same}");
        }
    }
}

/// A hull has fans and triangles that end in points. As its IGES file holds them they have sides that are points but for rounding,
/// and are proven as closely as those of its STEP file.
#[test]
fn hulls_are_made_of_cones_from_every_format() {
    let rail = |name: &str, bytes: &[u8]| torse::read_curve(bytes, &CurveOptions::new(name)).expect("a rail").0;
    let square = rail("square", include_bytes!("../../../data/duct_square.dxf"));
    let round = rail("round", include_bytes!("../../../data/duct_round.dxf"));
    let mut hull = torse::hull(&[square, round], &torse::Hull::new(0.1), &Control::default()).expect("a hull");
    (hull.cut.iges, hull.cut.threedm) = (true, true);
    let files = bundle::geometry(&hull, &present(&hull), "2026-01-01T00:00:00").expect("files");
    for name in ["panels.step", "panels.igs", "panels.3dm"] {
        let (_, bytes) = files.iter().find(|f| f.0 == name).expect("a file");
        let back = torse::read(bytes).expect("a model");
        let options = torse::ConesOptions::new(0.5, "hull");
        let cones = torse::cones(&back.faces, &back.skipped, &options, &Control::default()).expect("cones");
        assert_eq!(cones.status(), Status::Certified, "{name}: {:?}", cones.claims());
        assert_eq!(cones.cones().expect("chains").bodies.len(), hull.strips().count(), "{name}");
    }
}
