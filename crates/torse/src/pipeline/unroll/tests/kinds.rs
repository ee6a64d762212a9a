//! Which surfaces are taken for developable, whatever file, unit and hand they come in.

use crate::brep::face::Face;
use crate::brep::recognised_surface::{recognise, RecognisedSurface};
use crate::certify::claim::Status;
use crate::control::Control;
use crate::develop::shop::thickness::{Sheet, SheetSide};
use crate::develop::unfold::allowance::KFactor;
use crate::geom::Vec3;
use crate::io::step::write::{self as step, Header, Shell};
use crate::io::{cad, iges, threedm};
use crate::patchwork::panel::Patchwork;
use crate::pipeline::deliver;
use crate::pipeline::refold::refold;
use crate::pipeline::unroll::{unroll, UnrollOptions};
use crate::spline::knots::Knots;
use crate::spline::surface::Surface;
use crate::torse::form::PanelKind;
use crate::torse::strip::Strip;
use std::collections::HashMap;

/// A surface of rulings between two Bézier curves.
fn ruled(rails: [Vec<Vec3>; 2], weights: Option<&[f64]>) -> Surface {
    let points: Vec<Vec3> = rails[0].iter().zip(&rails[1]).flat_map(|(a, b)| [*a, *b]).collect();
    let weights: Option<Vec<f64>> = weights.map(|w| w.iter().flat_map(|w| [*w, *w]).collect());
    let knots = |p| Knots::clamped(p, &[0.0, 1.0]).expect("knots");
    Surface::new(knots(rails[0].len() - 1), knots(1), &points, weights.as_deref()).expect("a surface")
}

/// Surfaces of some 100 mm with what they are.
fn specimens() -> Vec<(&'static str, Surface)> {
    let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
    let arc = |r: f64, up: Vec3| vec![r * x + up, r * (x + y) + up, r * y + up];
    let quarter = [1.0, std::f64::consts::FRAC_1_SQRT_2, 1.0];
    let wave = || vec![Vec3::zeros(), 40.0 * x + 50.0 * z, 70.0 * x - 30.0 * z, 100.0 * x];
    let moved = |all: Vec<Vec3>, by: Vec3| all.into_iter().map(|p| p + by).collect::<Vec<_>>();
    let towards = |all: Vec<Vec3>, apex: Vec3| all.into_iter().map(|p| p + 0.6 * (apex - p)).collect::<Vec<_>>();
    // Along the derivative of (100 t, 60 t², 40 t³).
    let tangent = |k: f64| {
        let at = |a: [f64; 3], d: [f64; 3]| Vec3::from(a) + k * Vec3::from(d);
        vec![
            at([0.0; 3], [100.0, 0.0, 0.0]),
            at([100.0 / 3.0, 0.0, 0.0], [100.0, 40.0, 0.0]),
            at([200.0 / 3.0, 20.0, 0.0], [100.0, 80.0, 40.0]),
            at([100.0, 60.0, 40.0], [100.0, 120.0, 120.0]),
        ]
    };
    // A quarter turn of a screw, as near as a cubic is, and its axis.
    let k = 0.5523;
    let screw =
        vec![50.0 * x, 50.0 * x + 50.0 * k * y + 20.0 * z, 50.0 * k * x + 50.0 * y + 40.0 * z, 50.0 * y + 60.0 * z];
    let axis = vec![Vec3::zeros(), 20.0 * z, 40.0 * z, 60.0 * z];
    vec![
        ("plane", ruled([vec![Vec3::zeros(), 100.0 * x], vec![80.0 * y, 110.0 * x + 90.0 * y]], None)),
        ("cylinder", ruled([arc(60.0, Vec3::zeros()), arc(60.0, 90.0 * z)], Some(&quarter))),
        ("cone", ruled([arc(60.0, Vec3::zeros()), arc(30.0, 90.0 * z)], Some(&quarter))),
        ("general cylinder", ruled([wave(), moved(wave(), 90.0 * y + 5.0 * z)], None)),
        ("general cone", ruled([wave(), towards(wave(), Vec3::new(40.0, 130.0, 10.0))], None)),
        ("tangent surface", ruled([tangent(0.5), tangent(1.5)], None)),
        ("helicoid", ruled([axis, screw], None)),
    ]
}

/// A strip whose tangent plane turns by an angle (rad) along its rulings.
fn twisted(angle: f64) -> Surface {
    let (a, b) = (Vec3::new(-50.0, 0.0, 0.0), Vec3::new(50.0, 0.0, 0.0));
    let turned = |x: f64| Vec3::new(x * angle.cos(), 90.0, x * angle.sin());
    ruled([vec![a, b], vec![turned(-50.0), turned(50.0)]], None)
}

/// A file in bytes: its format and unit, and the surface in it.
type Written = (String, Vec<u8>);

/// A surface, and its mirror image, in files of three formats and in more than one unit.
fn files(surface: &Surface) -> Vec<Written> {
    let header = Header { name: "specimen".into(), time: "2026-01-31T12:00:00".into(), uncertainty: 1e-6 };
    let mut out = Vec::new();
    for hand in [1.0, -1.0] {
        // In mm, and so large in numbers of a metre or an inch that it is as large.
        for (unit, mm) in [("mm", 1.0), ("m", 1e3), ("in", 25.4)] {
            let mut s = surface.clone();
            for h in &mut s.control {
                h[0] *= hand / mm;
                h[1] /= mm;
                h[2] /= mm;
            }
            let strip = Strip { name: "A".into(), kind: PanelKind::Cylinder, patch: s.clone() };
            let flags = match unit {
                "mm" => "2,2HMM",
                "m" => "6,1HM,",
                _ => "1,2HIN",
            };
            let text =
                String::from_utf8(iges::write::panels(&header, &Patchwork::of_strips(vec![strip]), &[])).expect("text");
            let global = text.replacen("2,2HMM,", &format!("{flags}{}", if unit == "m" { " " } else { "," }), 1);
            assert!(unit == "mm" || global != text);
            out.push((format!("IGES {unit} {hand}"), global.into_bytes()));
            let sheets = [Shell::untrimmed("A", &s)];
            let bytes = step::shells(&header, &sheets).expect("a file");
            let text = String::from_utf8(bytes).expect("text");
            match unit {
                "mm" => {
                    out.push((format!("STEP {unit} {hand}"), text.into_bytes()));
                    out.push((format!("3DM {unit} {hand}"), threedm::write::shells(&header, &sheets).expect("a file")));
                }
                "m" => {
                    assert!(text.contains("SI_UNIT(.MILLI.,.METRE.)"));
                    out.push((
                        format!("STEP {unit} {hand}"),
                        text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)").into_bytes(),
                    ));
                }
                _ => {
                    let mm = "(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))";
                    let inch = format!(
                        "(CONVERSION_BASED_UNIT('INCH',#900001) LENGTH_UNIT() NAMED_UNIT(#900003));\n\
                         #900001=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#900002);\n#900002={mm};\n\
                         #900003=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)"
                    );
                    assert_eq!(text.matches(mm).count(), 1);
                    out.push((format!("STEP {unit} {hand}"), text.replace(mm, &inch).into_bytes()));
                }
            }
        }
    }
    out
}

/// What the only face of a file lies on.
fn found((name, bytes): &Written) -> RecognisedSurface {
    let model = cad::read(bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!((model.faces.len(), model.skipped.len()), (1, 0), "{name}");
    let size = model.faces[0].surface.bbox().diagonal();
    assert!((50.0..500.0).contains(&size), "{name}: {size} mm");
    recognise(&model.faces[0])
}

#[test]
fn every_kind_is_known_in_every_format_unit_and_hand() {
    for (kind, surface) in specimens() {
        for file in files(&surface) {
            match found(&file) {
                RecognisedSurface::Curved(defect) => {
                    assert_eq!(kind, "helicoid", "{}", file.0);
                    assert!(defect.twist_estimate > 0.1, "{}: {defect:?}", file.0);
                }
                recognised => assert_eq!(recognised.name(), kind, "{}", file.0),
            }
        }
    }
}

#[test]
fn the_least_twist_is_seen_and_told_as_it_is() {
    let mut last: Vec<f64> = Vec::new();
    for angle in [1e-3, 2e-3, 5e-3, 1e-2, 3e-2, 1e-1] {
        let twists: Vec<f64> = files(&twisted(angle))
            .iter()
            .map(|file| match found(file) {
                RecognisedSurface::Curved(defect) => defect.twist_estimate,
                recognised => panic!("{}: twisted by {angle} and taken for a {}", file.0, recognised.name()),
            })
            .collect();
        for (k, twist) in twists.iter().enumerate() {
            assert!((twist - angle).abs() < 0.01 * angle, "{angle}: {twist}");
            assert!(last.get(k).is_none_or(|l| twist > l));
        }
        last = twists;
    }
}

/// What was laid flat bends back into what it was laid flat from, whatever it lies on.
#[test]
fn every_developable_comes_back_from_its_files() {
    for (kind, surface) in specimens().into_iter().filter(|s| s.0 != "helicoid") {
        let model = super::model_of(vec![Face::untrimmed(surface)]);
        let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(0.01) };
        let mut answer = unroll(&model, &options, &Control::default()).expect("an answer");
        let files: HashMap<String, Vec<u8>> =
            deliver::files(&mut answer, "2026-01-31T12:00:00").expect("files").into_iter().collect();
        let back = refold(&|name| files.get(name).cloned(), None, &Control::default()).expect("an answer");
        let part = &back.report().parts[0];
        assert!(part.distance_estimate < 1e-3, "{kind}: {part:?}");
        assert_eq!(back.status(), Status::Certified, "{kind}: {part:?}");
    }
}

/// What the proof adds where a map has no closed form has room in the tolerance, on either side of a sheet too.
#[test]
fn arcs_leave_room_for_what_maps_are_not_known_by() {
    let all = specimens();
    let (_, surface) = all.iter().find(|s| s.0 == "tangent surface").expect("a tangent surface");
    for side in [SheetSide::Inside, SheetSide::Outside] {
        let sheet = Some(Sheet { thickness: 4.0, side, k: KFactor::Ansi(0.42) });
        let options = UnrollOptions { surfaces: true, sheet, ..UnrollOptions::new(0.01) };
        let model = super::model_of(vec![Face::untrimmed(surface.clone())]);
        let answer = unroll(&model, &options, &Control::default()).expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{side:?}");
    }
}

/// The nearest place says nothing of the ruling where a profile crosses itself, or turns within half a millimetre; and three
/// rulings of a closed profile of one span may be two.
#[test]
fn cylinders_over_curves_that_cross_turn_sharply_or_close_are_laid_flat() {
    let crossing =
        [[162.0, 45.0], [325.0, 22.0], [268.0, 110.0], [29.0, 152.0], [19.0, 130.0], [35.0, 27.0], [212.0, 248.0]];
    let sharp =
        [[98.4, 61.3], [110.2, 68.1], [129.6, 207.8], [312.0, 270.1], [468.5, 296.4], [477.5, 109.4], [478.3, 134.2]];
    let closed = [[0.0, 0.0], [200.0, 0.0], [250.0, 200.0], [50.0, 350.0], [-150.0, 200.0], [-200.0, 0.0], [0.0, 0.0]];
    for profile in [crossing, sharp, closed] {
        let rail = |y: f64| profile.iter().map(|[x, z]| Vec3::new(*x, y, *z)).collect::<Vec<_>>();
        let surface = ruled([rail(0.0), rail(90.0)], None);
        let chord = |k: f64| (surface.point((k + 1.0) / 2e4, 0.0) - surface.point(k / 2e4, 0.0)).norm();
        let length: f64 = (0..20_000).map(|k| chord(f64::from(k))).sum();
        let options = UnrollOptions { surfaces: true, ..UnrollOptions::new(0.01) };
        let model = super::model_of(vec![Face::untrimmed(surface.clone())]);
        let answer = unroll(&model, &options, &Control::default()).expect("an answer");
        assert_eq!(answer.status(), Status::Certified, "{:?}", profile[0]);
        let [pattern] = answer.patterns() else { panic!("one part") };
        assert!((pattern.area - 90.0 * length).abs() < 1e-5 * pattern.area, "{} {length}", pattern.area / 90.0);
    }
}
