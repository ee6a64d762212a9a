//! Results of the library's own jobs bent back and used to carry artwork.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::OnceLock;
use torse::brep::face::Face;
use torse::brep::support_surface::SupportSurface;
use torse::geom::{Frame, Vec3};
use torse::io::artwork::{read, Artwork};
use torse::io::curves::CurveOptions;
use torse::io::result_folder::FolderError;
use torse::pipeline::approximate::of_faces;
use torse::pipeline::map_artwork::{read_map, Carried, Item, MapError, PlacedShape, Shape, Side, Style, Words};
use torse::pipeline::refold::{refold, RefoldAnswer};
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::rail::Rail;
use torse::{Control, Loft, Status};

type Files = HashMap<String, Vec<u8>>;

/// The files of a quarter of a cone between two arcs, and what bending them back gives; once for all tests.
fn cone() -> &'static (Files, RefoldAnswer) {
    static CONE: OnceLock<(Files, RefoldAnswer)> = OnceLock::new();
    CONE.get_or_init(|| {
        let files = cone_files();
        let answer = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
        (files, answer)
    })
}

fn cone_files() -> Files {
    let arc = |r: f64, z: f64| -> Vec<Vec3> {
        (0..=24).map(|k| f64::from(k) / 24.0 * 1.5).map(|a| Vec3::new(r * a.cos(), r * a.sin(), z)).collect()
    };
    let rail = |name: &str, r: f64, z: f64| Rail::through(name, &arc(r, z)).expect("a rail");
    let mut answer =
        torse::loft(&rail("low", 200.0, 0.0), &rail("high", 120.0, 150.0), &Loft::new(0.1), &Control::default())
            .expect("a strip");
    torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect()
}

fn text(files: &Files, name: &str) -> String {
    String::from_utf8(files[name].clone()).expect("text")
}

fn matched(answer: &RefoldAnswer) -> f64 {
    answer.report().parts.iter().map(|p| p.matched_estimate).fold(0.0, f64::max)
}

#[test]
fn a_cone_is_bent_back_onto_itself_and_written() {
    let (_, answer) = cone();
    let report = answer.report();
    assert_eq!((report.parts.len(), report.left.len()), (1, 0), "{report:?}");
    let p = &report.parts[0];
    assert!(p.distance_estimate <= p.matched_estimate && p.matched_estimate < 0.05, "{p:?}");
    let (bound, printed) = (p.distance_bound.expect("proven"), p.printed_bound.expect("proven"));
    assert!(p.distance_estimate <= bound && bound < 0.2 && printed < 0.3, "{p:?}");
    // Only what is proven within the tolerance certifies; what is measured does not.
    let within = |tolerance: f64| RefoldAnswer { tolerance, ..answer.clone() };
    let certified = |tolerance: f64| within(tolerance).status() == Status::Certified;
    assert_eq!([1.01 * p.distance_estimate, 0.99 * bound, 1.01 * bound].map(certified), [false, false, true]);
    let told = [0.99, 1.01].map(|share| within(share * bound).report());
    assert_eq!(
        told.each_ref().map(|r| (r.status.as_str(), r.parts[0].certified)),
        [("uncertified", false), ("certified", true)]
    );
    assert!(told[0].words().starts_with("NOT CERTIFIED: 1 of 1") && told[1].words().starts_with("certified: 1 of 1"));
    let made = answer.files().expect("files");
    assert!(made.iter().any(|f| f.0 == "refolded.glb" && f.1.starts_with(b"glTF")));
    let json: serde_json::Value = serde_json::from_slice(&made[0].1).expect("a report");
    assert_eq!(json["schema"], "torse-refold/5");
}

/// A face that `unroll` covers with panels has bend lines, but no bends of sheet and so no table of these.
#[test]
fn covers_are_read_without_a_bend_table() {
    let model = torse::read(include_bytes!("../../../data/torus_piece.step")).expect("a model");
    let options = torse::UnrollOptions { surfaces: true, approximate: Some(8.0), ..torse::UnrollOptions::new(0.1) };
    let mut answer = torse::unroll(&model, &options, &Control::default()).expect("an answer");
    let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    assert!(!files.contains_key("bend_table.csv") && files.contains_key("bends.csv"));
    let map = read_map(&|n: &str| files.get(n).cloned(), None, None).expect("a map");
    assert_eq!((map.parts.len(), map.left.len()), (answer.patterns().len(), 0), "{:?}", map.left);
}

/// Cones up to their tips: the tip is a corner of the flat part, about which the sheet turns, or lies a hair inside it where it is
/// flat nearly all round. Rings of cones: their corners lie on circles, and tell where the slit is only together with its sides.
#[test]
fn cones_that_go_all_round_are_proven() {
    for (radius, slope, height) in [(300.0, -0.6, 500.0), (600.0, -3.0, 200.0), (600.0, -3.0, 90.0)] {
        let cone = SupportSurface::Cone { frame: Frame::world(), radius, slope };
        let face = Face::untrimmed(cone.to_spline((0.0, TAU), (0.0, height)).expect("a surface").0);
        let options = torse::Approximate::new(0.5);
        let mut answer = of_faces(vec![face], Vec::new(), &options, &Control::default()).expect("a panel");
        let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
        let answer = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
        let p = &answer.report().parts[0];
        assert!(p.matched_estimate < 0.02, "{p:?}");
        assert!(p.distance_bound.is_some_and(|b| b >= p.distance_estimate && b < 0.1), "{p:?}");
    }
}

/// A pipe with holes and a cone with holes: what is proven is not far above what they are drawn to, though their patches have creases
/// and their bend lines tell of rulings beyond them.
#[test]
fn round_parts_with_holes_are_proven_near_their_tolerance() {
    const TOLERANCE: f64 = 0.05;
    let files: [&[u8]; 2] =
        [include_bytes!("../../../data/cylinder_holes.step"), include_bytes!("../../../data/cone_holes.step")];
    for bytes in files {
        let model = torse::read(bytes).expect("a model");
        let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(TOLERANCE) };
        let mut answer = torse::unroll(&model, &options, &Control::default()).expect("flat parts");
        let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
        let report = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer").report();
        let p = &report.parts[0];
        assert!(p.distance_bound.is_some_and(|b| b >= p.distance_estimate && b < 1.5 * TOLERANCE), "{p:?}");
    }
}

/// Plane quadrilaterals of one strip, which meet in folds, some of them nearly triangles: each is judged with its own part.
#[test]
fn all_quadrilaterals_of_a_strip_are_proven() {
    let strip =
        torse::io::quads::read("hood.csv", include_bytes!("../../../data/hood_strip.csv"), None).expect("a strip");
    let mut answer = torse::planarise(&strip, &torse::Planarise::new(0.01), &Control::default()).expect("plane pieces");
    let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let answer = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
    let report = answer.report();
    assert_eq!(report.parts[0].panels.len(), 10, "{report:?}");
    assert!(report.parts[0].distance_bound.is_some_and(|b| b < 0.003), "{report:?}");
}

/// The same files, the drawing as a program writes it that keeps three decimals.
fn rounded(files: &Files) -> Files {
    let text = String::from_utf8(files["patterns.dxf"].clone()).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    let pair = |w: &[&str]| match (w[0].trim(), w[1].trim().parse::<f64>()) {
        ("10" | "20" | "11" | "21", Ok(x)) => format!("{}\n{x:.3}\n", w[0]),
        _ => format!("{}\n{}\n", w[0], w[1]),
    };
    let drawing = lines.chunks_exact(2).map(pair).collect::<String>().into_bytes();
    files.iter().map(|(n, f)| (n.clone(), if n == "patterns.dxf" { drawing.clone() } else { f.clone() })).collect()
}

/// A duct from square to round, planes and fans that end in points on the outline, as one flat part of the loft and in the parts
/// that `unroll` makes of its panels: fans between planes begin and end at lines that are drawn, which another program may
/// have rounded.
#[test]
fn fans_between_planes_are_proven() {
    let rail = |name: &str, bytes: &[u8]| torse::read_curve(bytes, &CurveOptions::new(name)).expect("a rail").0;
    let square = rail("square", include_bytes!("../../../data/duct_square.dxf"));
    let round = rail("round", include_bytes!("../../../data/duct_round.dxf"));
    let mut lofted = torse::loft(&square, &round, &Loft::new(0.05), &Control::default()).expect("a duct");
    let files: Files = torse::files(&mut lofted, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let model = torse::read(&files["panels.step"]).expect("panels");
    let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.05) };
    let mut flat = torse::unroll(&model, &options, &Control::default()).expect("flat parts");
    let unrolled: Files = torse::files(&mut flat, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    // The hull has fans between triangles, whose rulings leave the part and come back to it.
    let mut hull = torse::hull(&[square, round], &torse::Hull::new(0.05), &Control::default()).expect("a hull");
    let wrapped: Files = torse::files(&mut hull, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let report = refold(&|n| wrapped.get(n).cloned(), None, &Control::default()).expect("an answer").report();
    let proven = report.parts.iter().flat_map(|p| &p.panels).filter(|p| p.distance_bound.is_some_and(|b| b < 0.05));
    assert_eq!(proven.count(), report.parts.iter().map(|p| p.panels.len()).sum::<usize>(), "{report:?}");
    for (files, bound) in [(files, 0.02), (rounded(&unrolled), 0.3), (unrolled, 0.3)] {
        let report = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer").report();
        assert!(report.left.is_empty(), "{report:?}");
        let panels: Vec<_> = report.parts.iter().flat_map(|p| &p.panels).collect();
        assert_eq!(panels.len(), 8, "{report:?}");
        assert!(panels.iter().all(|p| p.distance_bound.is_some_and(|b| b < bound)), "{panels:?}");
        assert!(report.parts.iter().all(|p| p.matched_estimate < 0.01), "{report:?}");
    }
}

/// What `unroll` wrote of a hull whose fans begin a hair before their tips, one of them 600 mm long and 1 mm wide: it comes back, and is
/// laid flat again.
#[test]
fn fans_that_begin_a_hair_before_their_tips_are_laid_flat_again() {
    const TOLERANCE: f64 = 0.05;
    let rail = |name: &str, bytes: &[u8]| torse::read_curve(bytes, &CurveOptions::new(name)).expect("a rail").0;
    let square = rail("square", include_bytes!("../../../data/duct_square.dxf"));
    let round = rail("round", include_bytes!("../../../data/duct_round.dxf"));
    let mut hull = torse::hull(&[square, round], &torse::Hull::new(TOLERANCE), &Control::default()).expect("a hull");
    let mut files: Files = torse::files(&mut hull, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let mut unrolled = Vec::new();
    for _ in 0..2 {
        let model = torse::read(&files["panels.step"]).expect("panels");
        let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(TOLERANCE) };
        let mut flat = torse::unroll(&model, &options, &Control::default()).expect("flat parts");
        files = torse::files(&mut flat, "2026-01-31T12:00:00").expect("files").into_iter().collect();
        assert_eq!(flat.status(), Status::Certified, "{:?}", flat.claims());
        unrolled.push(files.clone());
    }
    // The second time panels begin 0.006 mm before their tips, on sides of 0.0024 mm, in which their bend lines end.
    for files in unrolled {
        let back = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
        assert_eq!(back.status(), Status::Certified, "{:?}", back.report());
    }
}

fn model_of(faces: Vec<Face>) -> torse::Model {
    torse::Model {
        faces,
        skipped: Vec::new(),
        notes: Vec::new(),
        unit: String::new(),
        products: Vec::new(),
        curves: Vec::new(),
    }
}

/// A plane whose parameters run unevenly is proven to a billionth or two of its size, and not to a part of the tolerance.
#[test]
fn a_plane_of_uneven_parameters_is_proven_by_lengths() {
    let knots = || Knots::clamped(2, &[0.0, 0.3, 1.0]).expect("knots");
    let steps = [0.0, 30.0, 500.0, 800.0];
    let at = |x: f64, y: f64| Vec3::new(x + 0.2 * y, y - 0.1 * x, 0.5 * x + 0.2 * y);
    let points: Vec<Vec3> = steps.iter().flat_map(|x| steps.map(|y| at(*x, y))).collect();
    let plate = Face::untrimmed(Surface::new(knots(), knots(), &points, None).expect("a surface"));
    let model = model_of(vec![plate]);
    let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.01) };
    let mut flat = torse::unroll(&model, &options, &Control::default()).expect("a flat part");
    let files: Files = torse::files(&mut flat, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let back = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
    let bound = back.report().parts[0].distance_bound.expect("a bound");
    assert!(bound < 5e-6, "{bound:e}");
}

/// A quarter of a cone and a plane that meets it in a sharp bend along its first ruling: the bend lies on the edge of what is
/// rolled, and is no line of it. Normals of both may look to one side of the sheet or not.
#[test]
fn a_sharp_bend_beside_a_rolled_face_is_proven() {
    let cone = SupportSurface::Cone { frame: Frame::world(), radius: 300.0, slope: -0.6 };
    let fan = cone.to_spline((0.0, TAU / 4.0), (0.0, 450.0)).expect("a surface").0;
    let (rim, end, way) = (Vec3::new(300.0, 0.0, 0.0), Vec3::new(30.0, 0.0, 450.0), Vec3::new(0.0, -200.0, 60.0));
    for corners in [[rim + way, end + way, rim, end], [rim, end, rim + way, end + way]] {
        let knots = || Knots::clamped(1, &[0.0, 1.0]).expect("knots");
        let plane = Surface::new(knots(), knots(), &corners, None).expect("a surface");
        let model = model_of([fan.clone(), plane].map(Face::untrimmed).to_vec());
        let options = torse::UnrollOptions { surfaces: true, ..torse::UnrollOptions::new(0.01) };
        let mut flat = torse::unroll(&model, &options, &Control::default()).expect("a flat part");
        let files: Files = torse::files(&mut flat, "2026-01-31T12:00:00").expect("files").into_iter().collect();
        let report = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer").report();
        assert_eq!((report.parts.len(), report.left.len()), (1, 0), "{report:?}");
        let panels = &report.parts[0].panels;
        assert_eq!(panels.len(), 2, "{report:?}");
        assert!(panels.iter().all(|p| p.distance_bound.is_some_and(|b| b < 0.01)), "{panels:?}");
    }
}

/// Results of cones have their panels in a file of their own, named by their kinds.
#[test]
fn chains_of_cones_are_bent_back_and_carry_points() {
    let model = torse::read(include_bytes!("../../../data/cone_holes.step")).expect("a cone");
    let options = torse::ConesOptions::new(0.1, "hopper");
    let mut answer = torse::cones(&model.faces, &model.skipped, &options, &Control::default()).expect("cones");
    let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let file = |n: &str| files.get(n).cloned();
    let back = refold(&file, None, &Control::default()).expect("an answer");
    let report = back.report();
    assert_eq!((report.parts.len(), report.left.len()), (1, 0), "{report:?}");
    assert!(report.parts[0].matched_estimate < 0.05, "{report:?}");
    let map = read_map(&file, None, None).expect("a map");
    // A corner of its border, there and back.
    let [u, v] = model.faces[0].loops[0].points[0];
    let corner = model.faces[0].surface.point(u, v);
    let flat = map.points(&[(1, corner)], Side::Flat)[0].place.expect("a place");
    let back = map.points(&[(1, flat)], Side::Space)[0].place.expect("a place");
    assert!((back - corner).norm() < 0.2, "{back:?} {corner:?}");
}

/// About the tip of a shallow cone places beyond its patch have the same images as those on it.
#[test]
fn points_beside_the_tip_of_a_shallow_cone_go_there_and_back() {
    let cone = SupportSurface::Cone { frame: Frame::world(), radius: 600.0, slope: -3.0 };
    let face = Face::untrimmed(cone.to_spline((0.0, TAU), (0.0, 200.0)).expect("a surface").0);
    let options = torse::Approximate::new(0.1);
    let mut answer = of_faces(vec![face], Vec::new(), &options, &Control::default()).expect("a panel");
    let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let map = read_map(&|n| files.get(n).cloned(), None, None).expect("a map");
    let around = |r: f64| {
        (0..24)
            .map(f64::from)
            .map(|k| 0.1 + 0.25 * k)
            .map(move |a| Vec3::new(r * a.cos(), r * a.sin(), 200.0 - r / 3.0))
    };
    let space: Vec<(usize, Vec3)> = [5.0, 40.0, 300.0].into_iter().flat_map(around).enumerate().collect();
    let flat: Vec<(usize, Vec3)> =
        map.points(&space, Side::Flat).iter().map(|r| (r.line, r.place.expect("a place"))).collect();
    for (r, x) in map.points(&flat, Side::Space).iter().zip(&space) {
        assert!((r.place.expect("a place") - x.1).norm() < 0.1, "{r:?} {x:?}");
    }
}

/// A bracket has several panels: each has a bound of its own.
#[test]
fn panels_are_proven_one_by_one() {
    let model = torse::read(include_bytes!("../../../data/bracket.step")).expect("a bracket");
    let mut answer = torse::unroll(&model, &torse::UnrollOptions::new(0.05), &Control::default()).expect("a flat part");
    let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let answer = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
    let report = answer.report();
    let part = &report.parts[0];
    assert_eq!(part.panels.len(), 5, "{part:?}");
    let bounds: Vec<f64> = part.panels.iter().filter_map(|p| p.distance_bound).collect();
    // Spans end at the creases of the patches.
    assert!(bounds.len() == 5 && bounds.iter().all(|b| *b < 0.007), "{part:?}");
    assert_eq!(part.distance_bound, bounds.iter().copied().reduce(f64::max));
    let told = report.words();
    assert!(
        told.contains("5 of 5 panels within a proven distance") && told.contains("panel bracket-03: within"),
        "{told}"
    );
}

#[test]
fn a_table_that_bends_otherwise_is_found_out() {
    let right = matched(&cone().1);
    // Smaller angles and larger radii are no part of the panels.
    let mut files = cone().0.clone();
    let rows: Vec<String> = text(&files, "bends.csv")
        .lines()
        .enumerate()
        .map(|(k, l)| {
            let mut c: Vec<String> = l.split(',').map(String::from).collect();
            if k > 0 {
                for (i, f) in [(4, 0.9), (5, 1.0 / 0.9), (6, 1.0 / 0.9), (8, 0.9)] {
                    c[i] = format!("{:.4}", c[i].parse::<f64>().expect("a number") * f);
                }
            }
            c.join(",")
        })
        .collect();
    files.insert("bends.csv".into(), (rows.join("\n") + "\n").into_bytes());
    let answer = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
    assert!(matched(&answer) > right + 1.0);
    // What is proven says so too.
    assert!(answer.report().parts.iter().all(|p| p.distance_bound.is_none_or(|b| b > 1.0)));
}

#[test]
fn damaged_files_are_named_and_drawings_replace_each_other() {
    let whole = cone().0.clone();
    let mut files = whole.clone();
    files.remove("bends.csv");
    let e = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect_err("no table").to_string();
    assert!(e.contains("bends.csv is missing"), "{e}");
    let mut files = whole.clone();
    let cut = files["patterns.dxf"].len() / 2;
    files.get_mut("patterns.dxf").expect("a drawing").truncate(cut);
    let answer = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
    assert!(answer.notes.iter().any(|n| n.contains("patterns.dxf is damaged")), "{:?}", answer.notes);
    assert!(answer.report().parts[0].matched_estimate < 0.05);
    files.remove("patterns.svg");
    assert!(matches!(
        refold(&|n| files.get(n).cloned(), None, &Control::default()),
        Err(FolderError::File { file: "patterns.dxf", .. })
    ));
    let mut files = whole;
    files.remove("panels.step");
    let answer = refold(&|n| files.get(n).cloned(), None, &Control::default()).expect("an answer");
    assert!(answer.report().left[0][1].contains("panels.step is missing"));
}

/// Places on the last ruling of a fan, beside its tip, as a table of nine digits has them.
#[test]
fn rounded_places_on_the_border_beside_a_tip_are_found() {
    let corner = Vec3::new(0.0, 0.0, 0.0);
    let arc: Vec<Vec3> = (0..=24)
        .map(|k| 1.2 * f64::from(k) / 24.0)
        .map(|a| Vec3::new(300.0 * a.cos(), 300.0 * a.sin(), 400.0))
        .collect();
    let low = Rail::polyline("low", &[Vec3::new(-200.0, 0.0, 0.0), corner, Vec3::new(0.0, -200.0, 0.0)]);
    let (low, high) = (low.expect("a rail"), Rail::through("high", &arc).expect("a rail"));
    let mut answer = torse::loft(&low, &high, &Loft::new(0.05), &Control::default()).expect("strips");
    let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let map = read_map(&|n| files.get(n).cloned(), None, None).expect("a map");
    let ends = [arc[0], arc[24]];
    let places: Vec<(usize, Vec3)> =
        (1..=40).map(|k| (k, corner + (ends[k % 2] - corner) * (0.01 * k as f64))).collect();
    let flat = map.points(&places, Side::Flat);
    assert!(flat.iter().all(|r| r.distance < 1e-6), "{flat:?}");
    let rounded = |x: f64| (x * 1e9).round() / 1e9;
    let drawn: Vec<(usize, Vec3)> = flat.iter().map(|r| (r.line, r.place.expect("a place").map(rounded))).collect();
    for (r, x) in map.points(&drawn, Side::Space).iter().zip(&places) {
        let off = r.place.map(|p| (p - x.1).norm());
        assert!(off.is_some_and(|o| o < 1e-6), "{r:?} {off:?}");
    }
}

/// Places on the rim of a cylinder, between the ends of its arcs, are on it and keep their distances.
#[test]
fn places_on_borders_are_on_the_part() {
    let (radius, turn) = (50.0, 2.0);
    let cylinder = SupportSurface::Cylinder { frame: Frame::world(), radius };
    let face = Face::untrimmed(cylinder.to_spline((0.0, turn), (0.0, 80.0)).expect("a surface").0);
    let mut answer =
        of_faces(vec![face], Vec::new(), &torse::Approximate::new(0.01), &Control::default()).expect("a panel");
    let files: Files = torse::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let map = read_map(&|n| files.get(n).cloned(), None, None).expect("a map");
    for z in [0.0, 80.0] {
        let at = |k: usize| 0.017 + (turn - 0.034) * k as f64 / 30.0;
        let rim: Vec<(usize, Vec3)> =
            (0..=30).map(|k| (k, Vec3::new(radius * at(k).cos(), radius * at(k).sin(), z))).collect();
        let flat = map.points(&rim, Side::Flat);
        assert!(flat.iter().all(|r| r.distance < 1e-6), "{flat:?}");
        for w in flat.windows(2) {
            let step = (w[1].place.expect("a place") - w[0].place.expect("a place")).norm();
            assert!((step - radius * (at(1) - at(0))).abs() < 1e-6, "{step}");
        }
    }
}

/// Something of a drawing.
fn drawn(name: &str, shape: Shape) -> Item {
    let style = Style { layer: "logo".into(), colour: Some(3) };
    Item { name: name.into(), style, shape }
}

/// The only polyline that something has become.
fn line(carried: &Carried) -> (Vec<Vec3>, bool) {
    let [one] = &carried.placed[..] else { panic!("{carried:?}") };
    assert_eq!((one.style.layer.as_str(), one.style.colour), ("logo", Some(3)));
    let PlacedShape::Line { points, closed } = &one.shape else { panic!("{carried:?}") };
    (points.clone(), *closed)
}

/// A polyline as a thing of a drawing, closed again.
fn again(points: &[Vec3], closed: bool) -> Item {
    let around: Vec<Vec3> = points.iter().chain(points.first().filter(|_| closed)).copied().collect();
    drawn("POLYLINE", Shape::Curves(Rail::polyline("again", &around).expect("a rail").pieces))
}

/// Distance of a point from the nearest segment of a polyline.
fn off(x: &Vec3, points: &[Vec3]) -> f64 {
    let segment = |w: &[Vec3]| {
        let way = w[1] - w[0];
        let share = ((x - w[0]).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        (w[0] + way * share - x).norm()
    };
    points.windows(2).map(segment).fold(f64::INFINITY, f64::min)
}

#[test]
fn rings_points_and_texts_come_back_as_they_were() {
    let files = &cone().0;
    let map = read_map(&|n: &str| files.get(n).cloned(), None, None).expect("a map");
    // Places on the drawing in the middle of the cone's height.
    let on_cone = |a: f64| Vec3::new(160.0 * a.cos(), 160.0 * a.sin(), 75.0);
    let flat = map.points(&[(1, on_cone(0.4)), (2, on_cone(0.5))], Side::Flat);
    let [at, other] = [0, 1].map(|k: usize| flat[k].place.expect("a place"));
    // A ring with corners and one without.
    let square = [[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0], [-5.0, -5.0]];
    let corners: Vec<Vec3> = square.iter().map(|c| at + Vec3::new(c[0], c[1], 0.0)).collect();
    let circle: Vec<Vec3> = (0..=64)
        .map(|k| std::f64::consts::TAU * f64::from(k) / 64.0)
        .map(|a| at + Vec3::new(6.0 * a.cos(), 6.0 * a.sin(), 0.0))
        .collect();
    for ring in [corners, circle] {
        let there = map.item(&again(&ring, false), Side::Space);
        assert_eq!(there.off, None);
        let (points, closed) = line(&there);
        assert!(closed && points.len() >= 4);
        let (back, closed) = line(&map.item(&again(&points, true), Side::Flat));
        assert!(closed);
        let closed_back: Vec<Vec3> = back.iter().chain(&back[..1]).copied().collect();
        assert!(ring.iter().all(|x| off(x, &closed_back) <= 2.0 * map.chord), "corners stay");
        assert!(back.iter().all(|x| off(x, &ring) <= 2.0 * map.chord), "nothing else is there");
    }
    // A point, and a text with the direction in which it is read.
    let there = map.item(&drawn("POINT", Shape::Point(at)), Side::Space);
    let PlacedShape::Point(x) = there.placed[0].shape else { panic!("{there:?}") };
    let back = map.item(&drawn("POINT", Shape::Point(x)), Side::Flat);
    assert!(matches!(back.placed[0].shape, PlacedShape::Point(p) if (p - at).norm() < 1e-6));
    let way = (other - at).normalize();
    let words =
        Words { text: "7".into(), at, way, normal: Vec3::z(), height: 5.0, stretch: 1.0, slant: 0.0, held: [0; 2] };
    let there = map.item(&drawn("TEXT", Shape::Words(words.clone())), Side::Space);
    let PlacedShape::Words(w) = &there.placed[0].shape else { panic!("{there:?}") };
    // Along the circle of the cone, off its axis or towards it.
    let tangent = Vec3::new(-0.4_f64.sin(), 0.4_f64.cos(), 0.0);
    assert!(w.way.dot(&tangent).abs() > 0.99 && w.normal.dot(&tangent).abs() < 0.1, "{w:?}");
    let back = map.item(&drawn("TEXT", Shape::Words(w.clone())), Side::Flat);
    let PlacedShape::Words(w) = &back.placed[0].shape else { panic!("{back:?}") };
    assert!((w.at - at).norm() < 1e-6 && (w.way - way).norm() < 1e-3 && w.normal == Vec3::z(), "{w:?}");
    let far = map.item(&drawn("POINT", Shape::Point(Vec3::new(-5e3, 0.0, 0.0))), Side::Space);
    assert!(far.placed.is_empty() && far.off.is_some_and(|o| o.length == 0.0 && o.farthest > 1e3));
}

#[test]
fn points_and_curves_go_there_and_back() {
    let files = &cone().0;
    let file = |n: &str| files.get(n).cloned();
    let map = read_map(&file, None, None).expect("a map");
    let space: Vec<(usize, Vec3)> = (1..9)
        .map(|k| {
            // On the cone, in the middle of its height.
            let a = 0.15 * k as f64;
            (k, Vec3::new(160.0 * a.cos(), 160.0 * a.sin(), 75.0))
        })
        .chain([(9, Vec3::new(500.0, 0.0, 0.0))])
        .collect();
    let flat = map.points(&space, Side::Flat);
    assert!(flat[..8].iter().all(|r| r.part == map.parts[0].name && r.distance < 0.1), "{flat:?}");
    assert!(flat[8].place.is_none() && (flat[8].distance - 300.0).abs() < 0.1, "{:?}", flat[8]);
    // Neighbours keep their distance along the cone.
    let slant = 160.0 * 0.15;
    let step = (flat[1].place.expect("a place") - flat[0].place.expect("a place")).norm();
    assert!((step - slant).abs() < 0.1, "{step} {slant}");
    let there: Vec<(usize, Vec3)> = flat[..8].iter().map(|r| (r.line, r.place.expect("a place"))).collect();
    for (r, x) in map.points(&there, Side::Space).iter().zip(&space) {
        assert!((r.place.expect("a place") - x.1).norm() < 0.1);
        assert!(r.distance < 1e-6);
    }
    // A line across the whole drawing leaves the part at its edges.
    let all: Vec<Vec3> = there.iter().map(|p| p.1).collect();
    let way = (all[7] - all[0]).normalize() * 1000.0;
    let rail = Rail::polyline("line", &[all[0] - way, all[0] + way]).expect("a rail");
    let carried = map.item(&drawn("LINE", Shape::Curves(rail.pieces)), Side::Space);
    assert!(!carried.placed.is_empty() && carried.off.is_some_and(|o| o.length > 100.0));
    let written = torse::io::artwork::dxf(&carried.placed, &[], false);
    assert!(
        matches!(read("a.dxf", &written, 1.0), Ok(Artwork::Drawing(s, _)) if s.items.len() == carried.placed.len())
    );
    let unknown = read_map(&file, Some("Z"), None).expect_err("no such part");
    assert!(matches!(&unknown, MapError::Part { known, .. } if *known == map.parts[0].name));
}
