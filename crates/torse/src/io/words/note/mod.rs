//! Sentences of notes, the same in every report and on the terminal.

mod fit;
mod loft;
mod net;
mod reader;
mod shop;
mod unroll;

pub(in crate::io) use reader::reader_note;

use super::counted;
use super::numbers::{length, number, number_bound, percent};
use super::reason::{name as item_name, out_of_bounds};
use crate::answer::note::{BodyName, Broken, Crowded, LevelReport, Lines, Note, Skin, SolveReport};
use crate::num::gauss_newton::Status;
use crate::torse::zone::RegressionLimits;

/// Joins that are told of one by one; of more, the worst are.
const FEW_JOINS: usize = 3;

/// All notes in words, in their order.
pub fn notes(all: &[Note]) -> Vec<String> {
    let joints = all.iter().filter(|n| matches!(n, Note::Joint { .. })).count();
    let mut told = joints <= FEW_JOINS;
    let mut out = Vec::new();
    for n in all {
        match n {
            Note::Joint { .. } if joints > FEW_JOINS => {
                if !std::mem::replace(&mut told, true) {
                    out.push(worst_joints(all, joints));
                }
            }
            n => out.push(note(n)),
        }
    }
    out
}

/// Faces that are told of by number, at most.
const FEW_FACES: usize = 6;

/// How far panels of different faces are from meeting.
fn apart(joint: &str, [a, b]: &[String; 2], gap_estimate: f64) -> String {
    format!(
        "not all panels that meet along borders of their faces share an edge: along joint {joint} {a} and {b} are up to {} \
         apart at their marks (measured); the report has all joints",
        length(gap_estimate)
    )
}

/// What faces with sharp edges of their own count as.
fn creased(faces: &[u64], pieces: usize) -> String {
    let named: Vec<String> = faces.iter().take(FEW_FACES).map(|f| format!("#{f}")).collect();
    let more = if faces.len() > FEW_FACES { ", …" } else { "" };
    match faces {
        [face] => format!("face #{face} has sharp edges of its own; it counts as {pieces} faces that meet in them"),
        _ => format!(
            "{} faces ({}{more}) have sharp edges of their own; they count as {pieces} faces that meet in them",
            faces.len(),
            named.join(", ")
        ),
    }
}

/// The largest gap and the largest angles of joins.
fn worst_joints(all: &[Note], count: usize) -> String {
    type Worst = Option<(f64, String)>;
    let (mut gap, mut angles): (Worst, [Worst; 2]) = Default::default();
    let larger = |worst: &mut Worst, value: f64, of: String| {
        if worst.as_ref().is_none_or(|w| value > w.0) {
            *worst = Some((value, of));
        }
    };
    for n in all {
        let Note::Joint { index, between: [a, b], gap: g, angle, smooth } = n else { continue };
        let of = || format!(" (join {index}, {a} and {b})");
        larger(&mut gap, g.value(), of());
        larger(&mut angles[usize::from(!smooth)], angle.degrees().value(), of());
    }
    let mut out = format!("{count} joins, all in the report");
    for (worst, unit, words) in [
        (&gap, "mm", " gap"),
        (&angles[0], "°", " where pieces should go on smoothly"),
        (&angles[1], "°", " where they need not"),
    ] {
        if let Some((value, of)) = worst {
            out += &format!("; {}{words}{of}", bounded(*value, unit));
        }
    }
    out
}

/// A note in words.
pub fn note(note: &Note) -> String {
    match note {
        Note::Input(note) => reader_note(note),
        Note::Chosen { count, all } => format!("{count} of the {all} faces of the file, as chosen"),
        Note::BothSkins { body, thickness, faces: [outer, inner, sides] } => format!(
            "{} is a sheet of about {}: its outer skin has {}, its inner {inner}, its sides {sides}; all are \
             covered unless one skin is asked for (--outer, --inner)",
            body_name(body),
            length(*thickness),
            counted(*outer, "face")
        ),
        Note::OneSkin { body, thickness, skin, kept, all } => format!(
            "of {}, a sheet of about {}, the {} skin is taken: {kept} of {all} faces",
            body_name(body),
            length(*thickness),
            match skin {
                Skin::Outer => "outer",
                Skin::Inner => "inner",
            }
        ),
        Note::Creased { faces, pieces } => creased(faces, *pieces),
        Note::Apart { joint, between, gap_estimate } => apart(joint, between, *gap_estimate),
        Note::NoPanelAlong { curve } => format!("no panel along {curve} could be certified; others took its place"),
        Note::DirectionOf { curve } => format!(
            "strips run in the direction of {curve}, which need not lie in the middle of one: laid along it and on from there \
             they would be more"
        ),
        Note::ExactFaces => "Faces of cones.step are exact cones, cylinders and planes.".into(),
        Note::NotDevelopable => {
            "Strips are ruled, not developable: there are no flat patterns. Kinks are measured.".into()
        }
        Note::Unjoined => "Strips are fitted one by one and are not joined to each other.".into(),
        Note::Limits(limits) => asked_of_regression(limits),
        Note::Broken(Broken { strip, at, proven }) => out_of_bounds(strip, at, *proven),
        Note::Crowded(lines) => crowded(lines),
        Note::CutOpen { part: None } => "the strip is closed; its flat part is cut open along the first ruling".into(),
        Note::CutOpen { part: Some(part) } => format!("part {part} is closed; it is cut open along its first ruling"),
        Note::Loft(note) => loft::words(note),
        Note::Lid { curve, whole } => {
            let what = if *whole { "" } else { "a part of " };
            format!("{what}{curve} lies in a plane on which the hull rests; that planar piece is left open")
        }
        Note::Inside { curve } => format!("{curve} bounds no developable strip: it lies inside the hull of the others, or on it"),
        Note::Tips { count, within } => format!(
            "{count} tips are cut off where rulings become short; beyond the last ones the curves lie within {} mm of these \
             (proven, part of the distance from the curves)",
            number(*within)
        ),
        Note::Net(note) => net::words(note),
        Note::Solved { step, report } => solved(*step, report),
        Note::Met { residual } => format!("conditions are met to {} of the size", number(*residual)),
        Note::GaveWay { handle, off } => {
            format!("{} gave way: it is {} from where it pulls to", item_name(handle), length(*off))
        },
        Note::TakenUncertified { names } => uncertified(names),
        Note::RuledStrips { count } => {
            format!("{} not developable: no flat patterns of them", match count {
                1 => "one strip is ruled,".to_owned(),
                n => format!("{n} strips are ruled,"),
            })
        }
        Note::Joint { index, between: [a, b], gap, angle, smooth } => format!(
            "join {index}: {a} and {b}, {} gap, {}{}",
            bounded(gap.value(), "mm"),
            bounded(angle.degrees().value(), "°"),
            if *smooth { " where they should go on smoothly" } else { " between them" }
        ),
        Note::Target { index, back, points: true, .. } => {
            format!("target {index}: points, {} from the strips", bounded(back.value(), "mm"))
        }
        Note::Target { index, there, back, .. } => format!(
            "target {index}: strips {} from it, all of it {} from the strips",
            bounded(there.value(), "mm"),
            bounded(back.value(), "mm")
        ),
        Note::Level { level, report } => planarised(*level, report),
        Note::Unroll(note) => unroll::words(note),
        Note::Shop(note) => shop::words(note),
        Note::Fit(note) => fit::words(note),
    }
}

/// What is said of strips that come from others without a certificate.
fn uncertified(names: &[String]) -> String {
    let them = if names.len() == 1 { "it" } else { "them" };
    format!(
        "{} had no certificate where taken from; all that is said here is said of the strips made of {them}",
        names.join(", ")
    )
}

/// A proven bound with its unit, or that there is none.
fn bounded(bound: f64, unit: &str) -> String {
    let space = if unit == "°" { "" } else { " " };
    match bound {
        b if b.is_finite() => format!("at most {}{space}{unit}", number_bound(b)),
        _ => format!("by no proven number of {}", if unit == "°" { "degrees" } else { unit }),
    }
}

fn body_name(body: &BodyName) -> String {
    match body.part.as_str() {
        "" => format!("the body of face #{}", body.entity),
        part => format!("'{part}'"),
    }
}

fn asked_of_regression(limits: &RegressionLimits) -> String {
    let mut out = if limits.clearance > 0.0 {
        format!("Regression curves were to keep {} mm from their strips", limits.clearance)
    } else {
        "Regression curves were to stay off their strips".to_string()
    };
    if !limits.zones.is_empty() {
        out += &format!(" and out of {}", counted(limits.zones.len(), "zone"));
    }
    out + "; this is proven for every ruling, not only for the given ones."
}

fn crowded(Crowded { lines, asked, least }: &Crowded) -> String {
    let what = match lines {
        Lines::Rulings => "rulings",
        Lines::Marks => "marks",
    };
    format!(
        "{what} every {asked} mm were asked for; on the longest part they are drawn every {}, which is as many as a part \
         has",
        length(*least)
    )
}

fn solved(step: Option<(usize, usize)>, report: &SolveReport) -> String {
    let what = match step {
        None => "the first shape".to_owned(),
        Some((index, step)) => format!("move {index}, step {step}"),
    };
    let residual = number(report.residual);
    let how = match (&report.obstacle, report.status) {
        (_, Status::Converged) => format!("converged in {} iterations", report.iterations),
        (_, Status::Cancelled) => "was stopped early".into(),
        (Some((class, item)), Status::Stalled) => {
            format!("asks for more than there is: {class} keep {residual} of the size, most of it at {item}")
        }
        (Some((class, item)), _) => {
            format!("did not converge in {} iterations: {class}, {residual} of the size at {item}", report.iterations)
        }
        (None, _) => format!("did not converge in {} iterations", report.iterations),
    };
    format!("{what} {how}")
}

fn planarised(level: usize, report: &LevelReport) -> String {
    format!(
        "level {level}: {} quadrilaterals, warp {} before and {} after {} steps, points moved up to {}, bends jump by {} of \
         their mean",
        report.quads,
        number(report.warp_before),
        number(report.warp),
        report.steps,
        length(report.largest_move),
        percent(report.bend_jump)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::note::ReaderNote;
    use crate::answer::note::UnrollNote;
    use crate::answer::note::{Became, FaceNote, FitNote};
    use crate::answer::note::{EndNote, ExactPiece, Leads, LoftNote, NetNote, Outlines, Quality, SplineSize};
    use crate::certify::claim::{Counted, UpperBound};
    use crate::develop::unfold::tree::CutReason;
    use crate::torse::net::Shape;

    #[test]
    fn numbers_have_three_digits_and_a_unit() {
        let used =
            EndNote::Used { rail: "long".into(), from: 0.0, to: 120.004_9, total: 190.123_4, leads: Leads::OtherRail };
        let text = note(&Note::Loft(LoftNote::Ends(used)));
        assert!(text.starts_with("long is used from 0 mm to 120 mm of its length of 190 mm; extend"), "{text}");
        let least = LoftNote::LeastTwistPath { number: 2, bends: 0.012_345_6, twist: 1.234_5e-7, area: 1_234_567.0 };
        let text = note(&Note::Loft(least));
        assert!(
            text.contains("0.707°") && text.contains("7.07e\u{2212}6°") && text.ends_with("area 1.23 m²"),
            "{text}"
        );
        let exact = ExactPiece { strip: "A-01".into(), spans: 12, off_bound: 1.230_1e-4 };
        let text = note(&Note::Loft(LoftNote::Exact(vec![exact])));
        assert!(text.ends_with("A-01 (12 spans, 0.000124 mm)"), "a bound goes up: {text}");
        let lines = Crowded { lines: Lines::Marks, asked: 1e-6, least: 0.123_456 };
        assert!(note(&Note::Crowded(lines)).contains("marks every 0.000001 mm were asked for"));
    }

    #[test]
    fn of_many_joins_the_worst_are_told() {
        let joint = |index: usize, bound: UpperBound, smooth: bool| {
            let between = ["a".to_owned(), format!("b{index}")];
            Note::Joint { index, between, gap: bound, angle: bound, smooth }
        };
        let few = [joint(0, UpperBound::nothing(), false), joint(1, UpperBound::nothing(), true)];
        assert_eq!(notes(&few).len(), 2);
        let mut many = vec![Note::Input(ReaderNote::NoTop)];
        let bound = |k: usize| if k == 4 { UpperBound::UNKNOWN } else { UpperBound::nothing() };
        many.extend((0..5).map(|k| joint(k, bound(k), k == 1)));
        many.push(Note::ExactFaces);
        let told = notes(&many);
        assert!(told.len() == 3 && told[0] == note(&many[0]) && told[2] == note(&Note::ExactFaces), "{told:?}");
        assert!(
            told[1].starts_with("5 joins, all in the report; ") && told[1].contains("(join 4, a and b4)"),
            "{told:?}"
        );
        assert!(told[1].contains("where pieces should go on smoothly (join 1, a and b1)"), "{told:?}");
    }

    #[test]
    fn one_bend_is_one_and_edges_without_numbers_have_none() {
        let sheet = |bends| note(&Note::Unroll(UnrollNote::Sheet { part: "A".into(), thickness: 2.0, bends }));
        let thinned = UnrollNote::Thinned { part: "A".into(), faces: 4, of: 19, local: 0.5, thickness: 1.0 };
        assert_eq!(
            note(&Note::Unroll(thinned)),
            "A: the sheet is not 1 mm thick at 4 of its 19 faces, but 0.5 mm, where it differs most: it must be formed or milled there."
        );
        assert_eq!((sheet(1), sheet(3)), ("A: sheet of 2 mm, 1 bend.".into(), "A: sheet of 2 mm, 3 bends.".into()));
        let cut = |edge| {
            let reason = CutReason::Closes;
            note(&Note::Unroll(UnrollNote::Cut { part: "A".into(), edge, reason }))
        };
        assert!(cut(7).starts_with("A: cut along edge #7, because"), "{}", cut(7));
        assert!(cut(0).starts_with("A: cut along an edge, because"), "{}", cut(0));
    }

    #[test]
    fn fits_and_nets_are_told_in_whole_sentences() {
        let size = |degree: usize, control: usize| SplineSize { degree: [degree, 1], control: [control, 2] };
        let face = |became| Note::Fit(FitNote::Face(FaceNote { face: "F01".into(), given: size(6, 57), became }));
        let strips = Became::Strips(vec![("A-01".into(), size(3, 8)), ("A-02".into(), size(2, 3))]);
        assert_eq!(
            note(&face(strips)),
            "F01 was given with degrees 6 and 1 and 57 × 2 control points; now: A-01 of degree 3 with 8 × 2, A-02 of degree \
             2 with 3 × 2 control points."
        );
        assert!(note(&face(Became::Itself("A-01".into()))).ends_with("simpler was found, it is A-01 as it was."));
        assert!(note(&face(Became::Nothing)).ends_with("control points."));
        let at = note(&Note::Fit(FitNote::At(Counted::TangentPlanes)));
        assert_eq!(at, "Distances are proven at the planes, not between them.");
        let outlines = Outlines { spacing: 2.0, holes: 1, closed: 0, stray: 3 };
        let told =
            note(&Note::Fit(FitNote::Ends { outlines: Some(outlines), whole: vec!["A-02".into()], mesh: false }));
        assert!(
            told.contains("about 2 mm. Proven")
                && told.ends_with("(the points have no single border there), are A-02: how far they reach is proven."),
            "{told}"
        );
        let cone = Shape::new((0.0, 1.0), 0.0, 0.25);
        let net = NetNote::Candidate {
            number: 1,
            shape: cone,
            quality: Quality::Regular,
            clearance_estimate: f64::INFINITY,
            last: 200.0,
        };
        assert_eq!(
            note(&Note::Net(net)),
            "solution 1: m = 0, κ = 0.250000; it is regular; no regression curve, last ruling 200 mm"
        );
    }
}
