//! Flat patterns of parts that are chains of strips or of cones, and the file of exact cones: what is as it should be is
//! proven, what is off by little is seen.

use std::collections::HashMap;
use torse::answer::presentation::present;
use torse::answer::Answer;
use torse::brep::face::Face;
use torse::certify::claim::{Evidence, What};
use torse::certify::flat::{cone_parts, strip_parts, FlatCertificate};
use torse::develop::bends::Facets;
use torse::develop::shop::thickness::{Sheet, SheetSide};
use torse::develop::unfold::allowance::KFactor;
use torse::develop::unfold::bends::BendKind;
use torse::geom::{Vec2, Vec3};
use torse::io::bundle::{self, File};
use torse::io::curves::CurveOptions;
use torse::io::words;
use torse::patchwork::pattern::Pattern;
use torse::pipeline::deliver;
use torse::pipeline::refold::refold;
use torse::spline::knots::Knots;
use torse::spline::surface::Surface;
use torse::torse::strip::Strip;
use torse::{ConesOptions, Control, Hull, Loft, Status, UnrollOptions};

const TOLERANCE: f64 = 0.01;

fn rails() -> [torse::torse::rail::Rail; 2] {
    let square = include_bytes!("../../../data/duct_square.dxf").as_slice();
    let round = include_bytes!("../../../data/duct_round.dxf").as_slice();
    [(square, "square"), (round, "round")]
        .map(|(bytes, name)| torse::read_curve(bytes, &CurveOptions::new(name)).expect("a rail").0)
}

fn duct() -> Answer {
    let [a, b] = rails();
    torse::loft(&a, &b, &Loft::new(TOLERANCE), &Control::default()).expect("strips")
}

fn cones(tolerance: f64, bytes: &[u8]) -> Answer {
    let model = torse::read(bytes).expect("a model");
    let options = ConesOptions::new(tolerance, "model");
    torse::cones(&model.faces, &model.skipped, &options, &Control::default()).expect("cones")
}

fn chute() -> Answer {
    cones(0.5, include_bytes!("../../../data/cone_holes.step"))
}

/// A cylinder over a parabola, or a cone where the upper edge is smaller, as a whole face.
fn over_a_parabola(upper: f64) -> Answer {
    let points: Vec<Vec3> = [(0.0, 0.0), (50.0, 40.0), (100.0, 0.0)]
        .iter()
        .flat_map(|&(x, z)| [Vec3::new(x, 0.0, z), Vec3::new(x * upper, 100.0, z * upper)])
        .collect();
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    let face = Face::untrimmed(Surface::new(knots(2), knots(1), &points, None).expect("surface"));
    let options = ConesOptions::new(0.05, "parabola");
    torse::cones(&[face], &[], &options, &Control::default()).expect("cones")
}

fn judged(answer: &Answer, patterns: &[Pattern]) -> Vec<FlatCertificate> {
    let strips: Vec<Strip> = answer.strips().cloned().collect();
    match &answer.cones() {
        Some(c) => cone_parts((&c.bodies, &c.pieces), &strips, &answer.parts, patterns, answer.tolerance()),
        None => strip_parts(&strips, &answer.parts, patterns, answer.tolerance(), &Control::default()),
    }
}

#[test]
fn patterns_of_chains_are_proven_about_as_closely_as_they_are_drawn() {
    let [a, b] = rails();
    let hull = torse::hull(&[a, b], &Hull::new(TOLERANCE), &Control::default()).expect("strips");
    for (name, answer) in [("duct", duct()), ("hopper", hull), ("chute", chute()), ("shell", over_a_parabola(0.6))] {
        assert_eq!(answer.status(), Status::Certified, "{name}: {}", words::reason(answer.claims(), &[]));
        assert!(!answer.flat().is_empty() && answer.flat().len() == answer.patterns().len(), "{name}");
        for (f, p) in answer.flat().iter().zip(answer.patterns()) {
            assert!(f.holds(), "{name}: {:?}", f.reason());
            assert!(f.strain_bound() < 1e-8 && f.gap_bound() < 1e-9, "{name}: {f:?}");
            assert!(f.ruling_bound() < 1e-4 * answer.tolerance().max(1.0) && f.mark_bound() < 1e-6, "{name}: {f:?}");
            let drawn = p.contour_error + 2e-3 * answer.tolerance();
            assert!(f.outline_bound() <= 1.1 * drawn, "{name}: {} {}", f.outline_bound(), p.contour_error);
        }
        for what in [What::LengthError, What::DrawingDistance, What::JointGap] {
            assert_eq!(answer.claim(what).map(|c| c.evidence()), Some(Evidence::Proven), "{name}");
        }
    }
}

#[test]
fn patterns_are_proven_from_either_side() {
    for answer in [duct(), chute(), over_a_parabola(0.6)] {
        let mut turned: Vec<Pattern> = answer.patterns().iter().map(Pattern::turned_over).collect();
        assert!(judged(&answer, &turned).iter().all(FlatCertificate::holds));
        // But not if bend lines keep their senses.
        for (t, p) in turned.iter_mut().zip(answer.patterns()) {
            t.bends.clone_from(&p.bends);
        }
        let bent = answer.patterns().iter().zip(judged(&answer, &turned)).filter(|(p, _)| !p.bends.is_empty());
        assert!(bent.clone().count() > 0 && bent.clone().all(|(_, f)| !f.holds()), "{:?}", bent.collect::<Vec<_>>());
    }
}

/// Four planes and four oblique cones up to their apexes, from the file.
#[test]
fn a_duct_from_square_to_round_is_proven_from_its_file() {
    let duct = duct();
    let area: f64 = duct.patterns().iter().map(|p| p.area).sum();
    let files = written(&duct);
    let step = files.iter().find(|f| f.0 == "panels.step").expect("panels");
    let model = torse::read(&step.1).expect("a model");
    let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(TOLERANCE) };
    let flat = torse::unroll(&model, &options, &Control::default()).expect("parts");
    assert_eq!((model.faces.len(), flat.status()), (8, Status::Certified), "{:?}", flat.claims());
    let laid: f64 = flat.patterns().iter().map(|p| p.area).sum();
    assert!((laid - area).abs() < 1e-5 * area, "{laid} {area}");
}

/// The same duct for a press brake: every fan has as many press lines as are asked for, by number, angle and height of the arcs.
#[test]
fn fans_of_a_duct_get_the_press_lines_that_are_asked_for() {
    let files = written(&duct());
    let step = files.iter().find(|f| f.0 == "panels.step").expect("panels");
    let model = torse::read(&step.1).expect("a model");
    let lines = |facets: Facets| -> Vec<usize> {
        let options = UnrollOptions { surfaces: true, facets: Some(facets), ..UnrollOptions::new(TOLERANCE) };
        let flat = torse::unroll(&model, &options, &Control::default()).expect("parts");
        assert_eq!(flat.status(), Status::Certified, "{facets:?} {:?}", flat.claims());
        let bends = flat.sheets.iter().flat_map(|s| &s.bends);
        bends.filter(|b| b.kind == BendKind::Rolled).map(|b| b.lines.len()).collect()
    };
    assert_eq!(lines(Facets::Count(12)), [12; 4]);
    let [coarse, fine] = [10f64, 5.0].map(|degrees| lines(Facets::Turn(degrees.to_radians())));
    assert!(coarse.len() == 4 && coarse.iter().zip(&fine).all(|(c, f)| *f >= 2 * c - 1), "{coarse:?} {fine:?}");
    // Arcs a quarter as high over the facets take twice as many.
    let [coarse, fine] = [2.0, 0.5].map(|mm| lines(Facets::Chord(mm)));
    assert!(coarse.iter().zip(&fine).all(|(c, f)| *f > c + c / 2), "{coarse:?} {fine:?}");
}

/// A conical skin with cut-outs inside a sheet: laid flat by its neutral fibre, written, read, and bent back.
#[test]
fn a_skin_with_cut_outs_comes_back_from_its_files() {
    let model = torse::read(include_bytes!("../../../data/cone_holes.step")).expect("a model");
    let sheet = Some(Sheet { thickness: 1.6, side: SheetSide::Inside, k: KFactor::Ansi(0.42) });
    let options = UnrollOptions { surfaces: true, sheet, ..UnrollOptions::new(TOLERANCE) };
    let mut flat = torse::unroll(&model, &options, &Control::default()).expect("a part");
    assert_eq!(flat.status(), Status::Certified, "{:?}", flat.claims());
    let surface = UnrollOptions { sheet: None, ..options };
    let surface = torse::unroll(&model, &surface, &Control::default()).expect("a part");
    let [own, drawn] = [&surface, &flat].map(|a| a.patterns().iter().map(|p| p.area).sum::<f64>());
    assert!(drawn > own * (1.0 + 1e-4), "the fibre lies outside the surface: {own} {drawn}");
    let files: HashMap<String, Vec<u8>> =
        torse::files(&mut flat, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let report = refold(&|name| files.get(name).cloned(), None, &Control::default()).expect("an answer").report();
    assert!(report.left.is_empty() && report.parts.len() == 1, "{:?}", report.left);
    let part = &report.parts[0];
    assert!(part.beside > 0.5 && part.distance_estimate < 2.0 * TOLERANCE, "{part:?}");
}

/// A free edge of three metres that bends with radii from 5 m to 0.2 m: few arcs, proven near it.
#[test]
fn a_long_free_edge_is_drawn_in_few_arcs() {
    /// Control points along the edge, and steps between them.
    const POINTS: usize = 60;
    const STEPS: usize = 50;
    let length = 3040.0;
    let (mut angle, mut at) = (0.0_f64, Vec3::zeros());
    let mut points = vec![at];
    for k in 0..POINTS * STEPS {
        let ds = length / (POINTS * STEPS) as f64;
        let s = (k as f64 + 0.5) * ds;
        angle += ds * (1.0 / 5000.0 + (1.0 / 200.0 - 1.0 / 5000.0) * (-((s - 1500.0) / 300.0).powi(2)).exp());
        at += Vec3::new(angle.cos(), angle.sin(), 0.0) * ds;
        if (k + 1) % STEPS == 0 {
            points.push(at);
        }
    }
    // A plane band between the edge and its image drawn together by a tenth towards the middle of its chord.
    let middle = at * 0.5;
    let net: Vec<Vec3> = points.iter().flat_map(|p| [*p, *p + (middle - *p) * 0.1]).collect();
    let breaks: Vec<f64> = (0..=points.len() - 3).map(|k| k as f64).collect();
    let knots = |degree, breaks: &[f64]| Knots::clamped(degree, breaks).expect("knots");
    let surface = Surface::new(knots(3, &breaks), knots(1, &[0.0, 1.0]), &net, None).expect("a surface");
    let model = torse::Model {
        faces: vec![Face::untrimmed(surface)],
        skipped: Vec::new(),
        notes: Vec::new(),
        unit: String::new(),
        products: Vec::new(),
        curves: Vec::new(),
    };
    let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(0.05) };
    let flat = torse::unroll(&model, &options, &Control::default()).expect("a part");
    assert_eq!(flat.status(), Status::Certified, "{:?}", flat.claims());
    let contour = &flat.patterns()[0].contours[0].vertices;
    // Corners begin the four sides.
    let corners: Vec<usize> = (0..contour.len()).filter(|k| contour[*k].corner).collect();
    assert_eq!(corners.len(), 4);
    let sides = (0..4).map(|k| {
        let count = (corners[(k + 1) % 4] + contour.len() - corners[k]) % contour.len();
        let place = |i: usize| &contour[(corners[k] + i) % contour.len()];
        let chords = (0..count).map(|i| (place(i + 1).point - place(i).point).norm()).sum::<f64>();
        (chords, count)
    });
    let (chords, arcs) = sides.max_by(|a, b| a.0.total_cmp(&b.0)).expect("sides");
    assert!(chords > 2990.0 && arcs <= 40, "{arcs} arcs over {chords} mm");
}

#[test]
fn what_is_drawn_wrongly_is_seen() {
    type Damage = fn(&mut Pattern);
    fn turned(p: &mut Pattern, by: f64) {
        // The second half of the outline, turned about its first vertex.
        let v = &mut p.contours[0].vertices;
        let (half, (s, c)) = (v.len() / 2, by.sin_cos());
        let about = v[half].point;
        for v in &mut v[half..] {
            let d = v.point - about;
            v.point = about + Vec2::new(c * d.x - s * d.y, s * d.x + c * d.y);
        }
    }
    let damages: [(&str, Damage); 10] = [
        ("a vertex moved", |p| p.contours[0].vertices[2].point.x += 2.0),
        ("a vertex that is none", |p| p.contours[0].vertices[2].point.x = f64::NAN),
        ("the first vertex moved", |p| p.contours[0].vertices[0].point.y += 2.0),
        ("another bulge", |p| p.contours[0].vertices[1].bulge += 0.05),
        ("a bulge that is none", |p| p.contours[0].vertices[1].bulge = f64::INFINITY),
        ("a strip shifted", |p| {
            let n = p.contours[0].vertices.len();
            p.contours[0].vertices[n / 2..].iter_mut().for_each(|v| v.point.x += 2.0);
        }),
        ("a strip turned", |p| turned(p, 0.01)),
        ("a larger pattern", |p| p.contours[0].vertices.iter_mut().for_each(|v| v.point *= 1.01)),
        ("a vertex missing", |p| {
            let far = |k: usize| p.contours[0].vertices[k].point - p.contours[0].vertices[0].point;
            let k = (1..p.contours[0].vertices.len()).max_by(|a, b| far(*a).norm().total_cmp(&far(*b).norm()));
            p.contours[0].vertices.remove(k.expect("a vertex"));
        }),
        ("no outline", |p| p.contours.clear()),
    ];
    for answer in [duct(), chute()] {
        for (what, damage) in damages {
            let mut bad = answer.patterns().to_vec();
            damage(&mut bad[0]);
            let found = judged(&answer, &bad).swap_remove(0);
            assert!(!found.holds() && found.reason().is_some(), "{what}: {found:?}");
        }
        let mut bad = answer.patterns().to_vec();
        bad[0].rulings.push([Vec2::new(0.0, 0.0), Vec2::new(1.0, 1e6)]);
        assert!(!judged(&answer, &bad)[0].holds(), "a ruling across");
        // Of less than the tolerance leaves, the bound tells.
        let mut bad = answer.patterns().to_vec();
        let by = 0.2 * answer.tolerance();
        bad[0].contours[0].vertices[1].point += Vec2::new(by, by);
        let found = judged(&answer, &bad).swap_remove(0);
        assert!(found.outline_bound() > by && found.outline_bound() > answer.flat()[0].outline_bound(), "{found:?}");
    }
    let duct = duct();
    let mut bad = duct.patterns().to_vec();
    bad[0].marks[3].point.x += 1.0;
    let found = judged(&duct, &bad).swap_remove(0);
    assert!(!found.holds(), "a mark off its rail: {found:?}");
}

#[test]
fn strips_that_are_not_the_drawn_ones_lose_the_proof() {
    let answer = duct();
    type Damage = fn(&mut Vec<Strip>);
    let damages: [(&str, Damage); 4] = [
        ("a strip longer", |s| s[2].patch.control[0][0] += 0.5),
        ("a twist", |s| s[1].patch.control[3][2] += 1.0),
        ("a strip moved in space", |s| s[3].patch.control.iter_mut().for_each(|c| c[2] += 0.5 * c[3])),
        ("strips exchanged", |s| s.swap(1, 2)),
    ];
    for (what, damage) in damages {
        let mut strips: Vec<Strip> = answer.strips().cloned().collect();
        damage(&mut strips);
        let found = strip_parts(&strips, &answer.parts, answer.patterns(), TOLERANCE, &Control::default());
        assert!(!found[0].holds(), "{what}: {:?}", found[0]);
    }
}

fn written(answer: &Answer) -> Vec<File> {
    bundle::geometry(answer, &present(answer), "2026-01-01T00:00:00").expect("files")
}

#[test]
fn exact_cones_are_read_back_and_any_other_face_is_named() {
    for answer in [chute(), over_a_parabola(1.0), over_a_parabola(0.6)] {
        assert_eq!(answer.status(), Status::Certified, "{}", words::reason(answer.claims(), &[]));
        let files = written(&answer);
        let told = |files: &[File]| {
            let mut a = answer.clone();
            deliver::judge(&mut a, files);
            let found = a.written().iter().find(|w| w.0 == "cones.step").map(|w| w.1.clone()).expect("it is read back");
            (a.status(), found, words::reason(a.claims(), &[]))
        };
        let (status, found, reason) = told(&files);
        assert_eq!(status, Status::Certified, "{reason}");
        assert!(found.bound() < 1e-8, "{found:?}");
        let step =
            String::from_utf8(files.iter().find(|f| f.0 == "cones.step").expect("cones").1.clone()).expect("text");
        for (entity, change) in changes(&step) {
            let mut bad = files.clone();
            bad.iter_mut().find(|f| f.0 == "cones.step").expect("cones").1 = change.into_bytes();
            let (status, found, reason) = told(&bad);
            assert!(status == Status::Uncertified && found.bound().is_infinite(), "{entity} changed unseen");
            assert!(reason.contains("cones.step"), "{entity}: {reason}");
        }
    }
}

/// A file with one of its entities changed, for several of them.
fn changes(step: &str) -> Vec<(String, String)> {
    let mut out = Vec::new();
    // The last number of an entity by a little.
    for entity in ["CONICAL_SURFACE(", "CYLINDRICAL_SURFACE(", "VERTEX_POINT", "AXIS2_PLACEMENT_3D"] {
        let Some(at) = step.find(entity) else { continue };
        let end = at + step[at..].find(";\n").expect("an end");
        let number = step[at..end].rfind(',').map(|k| at + k + 1).expect("numbers");
        if entity.ends_with('(') {
            let value: f64 = step[number..end - 1].trim().parse().expect("a number");
            out.push((entity.into(), format!("{}{:?}{}", &step[..number], value * 1.0001, &step[end - 1..])));
        }
    }
    // The axis of the first surface and a vertex by 9 mm: whatever digits stand there.
    for after in [point_of_first_surface(step), "VERTEX_POINT".into()] {
        const POINT: &str = "CARTESIAN_POINT('',(";
        let at = step.find(&after).expect("a record");
        let from = at + step[at..].find(POINT).expect("a point") + POINT.len();
        let end = from + step[from..].find(',').expect("numbers");
        let x: f64 = step[from..end].trim().parse().expect("a number");
        out.push((format!("the point of {after}"), format!("{}{:?}{}", &step[..from], x + 9.0, &step[end..])));
    }
    let mut swap = |after: &str, from: &str, to: &str| {
        let (head, tail) = step.split_at(step.find(after).expect(after));
        assert!(tail.contains(from), "{from}");
        out.push((from.into(), head.to_owned() + &tail.replacen(from, to, 1)));
    };
    // An edge of a loop, a name, the unit, a bound, the side of the normal.
    swap("DATA", "ORIENTED_EDGE('',*,*,#", "ORIENTED_EDGE('',*,*,#1");
    swap("DATA", "ADVANCED_FACE('", "ADVANCED_FACE('X");
    swap("DATA", ".MILLI.", ".CENTI.");
    swap("DATA", "FACE_OUTER_BOUND('',#", "FACE_OUTER_BOUND('',#9");
    let face = step.find("ADVANCED_FACE").expect("a face");
    let end = face + step[face..].find(");").expect("an end");
    let turned = if step[..end].ends_with(".T.") { ".F." } else { ".T." };
    out.push(("the side of the normal".into(), format!("{}{turned}{}", &step[..end - 3], &step[end..])));
    out
}

/// The record of the point on the axis of the first surface.
fn point_of_first_surface(step: &str) -> String {
    let surface =
        ["CONICAL_SURFACE", "CYLINDRICAL_SURFACE"].iter().filter_map(|s| step.find(s)).min().expect("a surface");
    let number = |from: usize| -> String {
        let digits = |c: char| c.is_ascii_digit();
        let at = from + step[from..].find('#').expect("a reference") + 1;
        step[at..].chars().take_while(|c| digits(*c)).collect()
    };
    let placement = step.find(&format!("#{}=", number(surface))).expect("a placement");
    let name = placement + step[placement..].find('(').expect("a record");
    format!("#{}=", number(name))
}
