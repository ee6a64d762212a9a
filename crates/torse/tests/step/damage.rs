//! The STEP reader never panics and never hangs, whatever is done to a file.

use super::text::{Step, Unit};
use proptest::prelude::*;
use std::time::{Duration, Instant};
use torse::io::step::read::read;

/// A file with a bit of everything.
fn sample() -> String {
    let mut s = Step::new(Unit::Inch);
    let low = s.circle_loop([0., 0., 0.], [0., 0., 1.], 2.0, true);
    let high = s.circle_loop([0., 0., 5.], [0., 0., 1.], 2.0, false);
    let window = s.cylinder_window(2.0, 1.0, 0.5, 1.0, 2.0);
    let c = s.surface("CYLINDRICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[2.0]);
    s.face("tube", c, &[(low, true), (high, true), (window, true)], true);
    let cap = s.circle_loop([0., 0., 4.], [0., 0., 1.], 3f64.sqrt(), true);
    let sphere = s.surface("SPHERICAL_SURFACE", [0., 0., 3.], [0., 0., 1.], &[2.0]);
    s.face("cap", sphere, &[(cap, true)], true);
    let base = s.circle_loop([0., 0., 0.], [0., 0., 1.], 3.0, false);
    let cone = s.surface("CONICAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[3.0, 0.5]);
    s.face("cone", cone, &[(base, true)], true);
    let ring = s.surface("TOROIDAL_SURFACE", [0., 0., 0.], [0., 0., 1.], &[5.0, 1.0]);
    let (a, b) =
        (s.circle_loop([0., 0., -1.], [0., 0., 1.], 5.0, true), s.circle_loop([0., 0., 1.], [0., 0., 1.], 5.0, false));
    s.face("ring", ring, &[(a, true), (b, true)], false);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    let outer = s.polygon(&[[0., 0., 0.], [9., 0., 0.], [9., 9., 0.]]);
    s.face("flat", plane, &[(outer, true)], true);
    let line = s.line([1., 0., 0.], [1., 0., 1.]);
    let axis = s.axis1([0., 0., 0.], [0., 0., 1.]);
    let turned = s.add(&format!("SURFACE_OF_REVOLUTION('',#{line},#{axis})"));
    let t = s.add(&format!("RECTANGULAR_TRIMMED_SURFACE('',#{turned},0.,1.,0.5,2.,.T.,.T.)"));
    let p: Vec<String> =
        (0..9).map(|i| format!("#{}", s.point([f64::from(i / 3), f64::from(i % 3), f64::from(i * i % 4)]))).collect();
    let patch = s.add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',2,2,(({}),({}),({})),.UNSPECIFIED.,.F.,.F.,.F.,(3,3),(3,3),(0.,1.),(0.,1.),.UNSPECIFIED.)",
        p[0..3].join(","),
        p[3..6].join(","),
        p[6..9].join(",")
    ));
    let off = s.add(&format!("OFFSET_SURFACE('',#{patch},0.05,.F.)"));
    s.geometric_set(&[t, patch, off]);
    s.occurrence([10., 0., 0.], [0., 0., 1.], [0., 1., 0.], false);
    s.occurrence([0., 0., 5.], [0., 0., 1.], [1., 0., 0.], true);
    s.mapped([1., 2., 3.]);
    s.text()
}

/// The models that come with the project, as our own writer writes them.
const MODELS: [&[u8]; 7] = [
    include_bytes!("../../../../data/cone_holes.step"),
    include_bytes!("../../../../data/cylinder_holes.step"),
    include_bytes!("../../../../data/fuselage.step"),
    include_bytes!("../../../../data/half_bowl.step"),
    include_bytes!("../../../../data/hull.step"),
    include_bytes!("../../../../data/torus_piece.step"),
    include_bytes!("../../../../data/wavy_roof.step"),
];

/// Generous on a loaded machine; an undamaged sample takes a few milliseconds.
const LONGEST: Duration = Duration::from_secs(20);

fn survives(bytes: &[u8]) {
    let start = Instant::now();
    // Whatever comes of it, it must come, and soon.
    if let Ok(m) = read(bytes) {
        for f in &m.faces {
            assert!(f.surface.control.iter().flatten().all(|x| x.is_finite()));
            assert!(f.loops.iter().flat_map(|l| &l.points).flatten().all(|x| x.is_finite()));
        }
    }
    assert!(start.elapsed() < LONGEST);
}

#[test]
fn the_sample_is_read_whole() {
    let m = read(sample().as_bytes()).expect("a model");
    assert!(m.skipped.is_empty(), "{:?}", m.skipped);
    // Eight surfaces in two occurrences and one mapped copy.
    assert_eq!(m.faces.len(), 8 * 3);
}

#[test]
fn every_length_of_a_truncated_file() {
    let text = sample();
    // All ends of records, and odd places between.
    for n in (0..text.len()).step_by(97) {
        survives(&text.as_bytes()[..n]);
    }
}

#[test]
fn models_cut_off_anywhere_are_refused() {
    for model in MODELS {
        let text = std::str::from_utf8(model).expect("text");
        // What may be missing: the product's link to its shape, and the last lines.
        let needed = text.find("MANIFOLD_SURFACE_SHAPE_REPRESENTATION").expect("the representation");
        for n in (0..needed).step_by(613) {
            assert!(read(&model[..n]).is_err(), "{n} bytes of {needed}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn models_cut_off_and_with_flipped_bytes(
        model in 0..MODELS.len(),
        end in any::<prop::sample::Index>(),
        whole in any::<bool>(),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
    ) {
        let mut bytes = MODELS[model].to_vec();
        for (i, b) in flips {
            let n = i.index(bytes.len());
            bytes[n] = b;
        }
        if !whole {
            bytes.truncate(end.index(bytes.len()));
        }
        survives(&bytes);
    }

    #[test]
    fn flipped_bytes(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20)) {
        let mut bytes = sample().into_bytes();
        for (i, b) in flips {
            let n = i.index(bytes.len());
            bytes[n] = b;
        }
        survives(&bytes);
    }

    #[test]
    fn exchanged_references(swaps in prop::collection::vec((any::<prop::sample::Index>(), 1_u32..400), 1..12)) {
        let text = sample();
        let data = text.find("DATA;").unwrap_or(0);
        let places: Vec<usize> = text.match_indices('#').map(|m| m.0).filter(|&i| i > data).collect();
        let mut out = text.clone();
        let mut chosen: Vec<(usize, u32)> = swaps.into_iter().map(|(i, n)| (places[i.index(places.len())], n)).collect();
        chosen.sort_unstable();
        chosen.dedup_by_key(|c| c.0);
        for (at, n) in chosen.into_iter().rev() {
            let end = at + 1 + out[at + 1..].bytes().take_while(u8::is_ascii_digit).count();
            out.replace_range(at..end, &format!("#{n}"));
        }
        survives(out.as_bytes());
    }

    #[test]
    fn wild_numbers(
        wild in prop::collection::vec(
            (any::<prop::sample::Index>(), prop::sample::select(vec![
                "1.E308", "-1.E308", "1.E-320", "0.", "-0.", "nan", "inf", "1.E15", "-7.", "1.E-9", "3.14159", "99999999999999999999",
            ])),
            1..8,
        )
    ) {
        let text = sample();
        let data = text.find("DATA;").unwrap_or(0);
        let places: Vec<usize> = text
            .match_indices('.')
            .map(|m| m.0)
            .filter(|&i| i > data && text.as_bytes()[i - 1].is_ascii_digit())
            .collect();
        let mut chosen: Vec<(usize, &str)> = wild.into_iter().map(|(i, n)| (places[i.index(places.len())], n)).collect();
        chosen.sort_unstable();
        chosen.dedup_by_key(|c| c.0);
        let mut out = text.clone();
        let digit = |b: u8| b.is_ascii_digit() || b == b'.' || b == b'-';
        for (at, n) in chosen.into_iter().rev() {
            let start = at - out[..at].bytes().rev().take_while(|b| digit(*b)).count();
            let end = at + out[at..].bytes().take_while(|b| digit(*b)).count();
            out.replace_range(start..end, n);
        }
        survives(out.as_bytes());
    }
}

/// Faces whose kind a damaged letter hides are members of a shell all the same, and what is made of faces is a loss, whatever it
/// is called.
#[test]
fn what_shells_and_representations_list_is_named_where_it_is_not_read() {
    let two = || {
        let mut s = Step::new(Unit::Millimetre);
        let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
        for x in [0., 10.] {
            let square = s.polygon(&[[x, 0., 0.], [x + 9., 0., 0.], [x + 9., 9., 0.], [x, 9., 0.]]);
            s.face("", plane, &[(square, true)], true);
        }
        s
    };
    let whole = two().text();
    let named = |text: &str| {
        let m = read(text.as_bytes()).expect("a model");
        (m.faces.len(), m.skipped.len())
    };
    assert_eq!(named(&whole), (2, 0));
    for other in ["ADVANCED_FACF", "advanced_face", "WRINKLE"] {
        assert_eq!(named(&whole.replacen("ADVANCED_FACE", other, 1)), (1, 1), "{other}");
    }
    for other in
        ["RIGHT_ANGULAR_WEDGE('',$,1.,1.,1.,0.5)", "TETRAHEDRON('',($))", "TRIANGULATED_FACE('',$,0,$,$,(),())"]
    {
        let mut s = two();
        let item = s.add(other);
        s.geometric_set(&[item]);
        let m = read(s.text().as_bytes()).expect("a model");
        assert_eq!((m.faces.len(), m.skipped[0].entity), (2, Some(item)), "{other}");
    }
}
