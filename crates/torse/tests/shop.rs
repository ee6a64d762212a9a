//! What reaches the shop: panels that fit the sheet, marks on joints, numbers along the model, drawings in inches and one
//! for each part.

use std::collections::BTreeMap;
use std::sync::OnceLock;
use torse::certify::claim::Status;
use torse::geom::unit::LengthUnit;
use torse::patchwork::pattern::MarkPlace;
use torse::pipeline::approximate::ApproximateError;
use torse::search::cover::Limits;
use torse::{approximate, files, read_step, Answer, Approximate};

const PIPE: &[u8] = include_bytes!("../../../data/cylinder_holes.step");
const CONE: &[u8] = include_bytes!("../../../data/cone_holes.step");
const BOWL: &[u8] = include_bytes!("../../../data/half_bowl.step");
const TORUS: &[u8] = include_bytes!("../../../data/torus_piece.step");

fn answer(bytes: &[u8], tolerance: f64, limits: Limits) -> Answer {
    let model = read_step(bytes).expect("our own model");
    approximate(&model, &Approximate { limits, ..Approximate::new(tolerance) }).expect("an answer")
}

/// The bowl at 10 mm without limits, which several tests look at.
pub fn bowl() -> &'static Answer {
    static ANSWER: OnceLock<Answer> = OnceLock::new();
    ANSWER.get_or_init(|| answer(BOWL, 10.0, Limits::default()))
}

/// A pipe is cut into equal fields on its flat pattern: the fewest that fit, not halves of halves.
#[test]
fn a_developable_face_is_cut_into_few_fields_that_fit() {
    let sheet = Some([400.0, 500.0]);
    let a = answer(PIPE, 0.5, Limits { sheet, ..Limits::default() });
    assert_eq!(a.status(), Status::Certified);
    assert!(a.patterns().iter().all(|p| p.width <= 400.0 && p.length <= 500.0));
    // 800 mm by 1571 mm less the holes.
    assert!(a.patterns().len() <= 8, "{}", a.patterns().len());
    // A length counts both ways: no pattern is wider than long.
    let a = answer(PIPE, 0.5, Limits { max_length: Some(420.0), ..Limits::default() });
    assert_eq!((a.status(), a.patterns().len()), (Status::Certified, 8));
    assert!(a.patterns().iter().all(|p| p.length <= 420.0));
}

/// Strips that are too long are cut where all of them are, or the face is covered in sections.
#[test]
fn panels_that_are_too_long_are_cut_in_line_or_covered_in_sections() {
    let model = read_step(TORUS).expect("our own model");
    let covered = |max_length: Option<f64>| {
        let limits = Limits { max_length, ..Limits::default() };
        approximate(&model, &Approximate { limits, meet: false, ..Approximate::new(20.0) }).expect("an answer")
    };
    let free = covered(None);
    // Halves of two strips; then three parts of each would be more than there are sections.
    for (most, is_in_line) in [(700.0, true), (600.0, false)] {
        let kept = covered(Some(most));
        let long = free.patterns().iter().map(|p| (p.length / most).ceil() as usize).sum::<usize>();
        assert!(long > free.patterns().len());
        assert_eq!(kept.status(), Status::Certified);
        assert!(kept.patterns().iter().all(|p| p.length <= most));
        assert!(kept.patterns().len() <= long + 1, "{} instead of {long}", kept.patterns().len());
        assert_eq!(kept.patterns().len() == long, is_in_line);
    }
}

#[test]
fn limits_that_nothing_can_keep_are_named_at_once() {
    let model = read_step(BOWL).expect("a model");
    let refused = |limits| approximate(&model, &Approximate { limits, ..Approximate::new(0.1) }).expect_err("refused");
    let e = refused(Limits { sheet: Some([20.0, 10.0]), ..Limits::default() });
    assert!(matches!(e, ApproximateError::TooMany { name: "size of the sheet", .. }), "{e}");
    let e = refused(Limits { min_width: Some(500.0), max_width: Some(100.0), ..Limits::default() });
    assert!(matches!(e, ApproximateError::Widths { .. }), "{e}");
    let e = refused(Limits { min_width: Some(500.0), max_length: Some(500.0), ..Limits::default() });
    assert!(matches!(e, ApproximateError::WiderThanLong { .. }), "{e}");
    let e = refused(Limits { min_width: Some(5000.0), ..Limits::default() });
    assert!(matches!(e, ApproximateError::TooNarrow { .. }), "{e}");
}

/// The panel of a pipe meets itself: both ends carry the same marks, at the same places in space, as those of a seam where they are one
/// edge.
#[test]
fn both_sides_of_a_joint_carry_the_same_marks() {
    let model = read_step(PIPE).expect("our own model");
    for (meet, place) in [(true, MarkPlace::Seam), (false, MarkPlace::Joint)] {
        let a = approximate(&model, &Approximate { meet, ..Approximate::new(0.5) }).expect("an answer");
        assert_eq!((a.status(), a.patterns().len()), (Status::Certified, 1));
        let mut labels: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for m in &a.patterns()[0].marks {
            assert!(m.on == place);
            labels.entry(&m.label).or_default().push(m.point.y.min(m.point.x));
        }
        assert!(labels.len() > 2 && labels.values().all(|v| v.len() == 2), "{labels:?}");
    }
}

#[test]
fn panels_are_numbered_along_the_model() {
    let a = bowl();
    let middle = |k: usize| {
        let points: Vec<_> = (0..=8)
            .map(|i| {
                a.patchwork().panels[k].strip.patch.point(
                    {
                        let b = a.patchwork().panels[k].strip.patch.knots_u.breaks();
                        b[0] + (b[b.len() - 1] - b[0]) * f64::from(i) / 8.0
                    },
                    0.5,
                )
            })
            .collect();
        points.iter().sum::<torse::geom::Vec3>() / points.len() as f64
    };
    let middles: Vec<_> = (0..a.patchwork().panels.len()).map(middle).collect();
    let spread = |d: usize| {
        let all = middles.iter().map(|m| m[d]);
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    };
    let axis = (0..3).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).expect("an axis");
    assert!(middles.windows(2).all(|w| w[1][axis] > w[0][axis]), "{middles:?}");
    assert_eq!(a.patchwork().panels[0].strip.name, "A-01");
}

#[test]
fn the_list_of_parts_says_what_the_model_calls_them() {
    let named = |of: &[(&[u8], &str)]| {
        let mut model = read_step(PIPE).expect("our own model");
        model.faces.clear();
        for (bytes, part) in of {
            let mut face = read_step(bytes).expect("our own model").faces.remove(0);
            face.part = (*part).into();
            model.faces.push(face);
        }
        approximate(&model, &Approximate::new(1.0)).expect("an answer")
    };
    let mut a = named(&[(PIPE, "Salad bowl")]);
    assert_eq!(a.sources_of(0), ["Salad bowl"]);
    let all: BTreeMap<String, Vec<u8>> = files(&mut a, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    let parts = String::from_utf8_lossy(&all["parts.csv"]).into_owned();
    let mut rows = parts.lines();
    assert!(rows.next().is_some_and(|head| head.ends_with(",source")));
    assert!(rows.all(|row| row.ends_with(",\"Salad bowl\"")), "{parts}");
    // The only part of a model is called like the job; of several each has its own name.
    assert!(!a.has_named_parts());
    let two = named(&[(PIPE, "Salad bowl"), (CONE, "Spoon")]);
    assert!(two.has_named_parts() && two.sources_of(0) == ["Salad bowl"]);
}

#[test]
fn drawings_in_inches_and_of_single_parts_hold_what_was_judged() {
    let mut a = bowl().clone();
    a.cut.unit = LengthUnit::Inch;
    a.cut.one_per_part = true;
    let all: BTreeMap<String, Vec<u8>> = files(&mut a, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    assert_eq!(a.status(), Status::Certified);
    let drawings = ["patterns.dxf", "patterns.svg", "part-A-01.dxf", "part-A-04.dxf"];
    for name in drawings {
        assert!(all.contains_key(name), "{name}");
        let written = a.written().iter().find(|w| w.0 == name).expect("read back");
        assert!(written.1.reason().is_none() && written.1.bound() < 1e-6, "{name} {}", written.1.bound());
    }
    let dxf = String::from_utf8_lossy(&all["part-A-01.dxf"]).into_owned();
    assert!(dxf.contains("$INSUNITS\n 70\n     1\n") && dxf.contains("\nSCALE_CHECK\n100\nAcDbPolyline\n"));
    let parts = String::from_utf8_lossy(&all["parts.csv"]).into_owned();
    assert!(parts.starts_with("part,job,quantity,seen_from,thickness_in,length_in,"));
    let length: f64 =
        parts.lines().nth(1).and_then(|l| l.split(',').nth(5)).and_then(|x| x.parse().ok()).expect("inches");
    assert!((length * 25.4 - a.patterns()[0].length).abs() < 0.02);
    // The same in millimetres is another file.
    a.cut.unit = LengthUnit::Millimetre;
    let again: BTreeMap<String, Vec<u8>> = files(&mut a, "2026-01-31T12:00:00").expect("files").into_iter().collect();
    assert_ne!(all["patterns.dxf"], again["patterns.dxf"]);
}
