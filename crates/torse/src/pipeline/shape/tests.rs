//! Jobs that are met, and what is wrong with others.

use super::*;
use crate::answer::note::SolveReport;
use crate::certify::claim::Status as Certified;
use crate::certify::claim::{Evidence, Subject, What};
use crate::io::shape::read;
use crate::num::gauss_newton::Status;

const JOB: &str = r#"{ "unit": "mm",
    "curves": [
        { "name": "low", "through": [[0, 0, 0], [300, -40, 60], [600, 0, 20], [1000, 40, 0]], "spans": 5 },
        { "name": "high", "through": [[50, 400, 120], [350, 420, 160], [600, 430, 150], [900, 400, 100]], "spans": 5 } ],
    "strips": [ { "name": "A-01", "sides": ["low", "high"] } ],
    "handles": [
        { "curve": "low", "u": 0, "point": [0, 0, 0] }, { "curve": "low", "u": 1, "point": [1000, 40, 0] },
        { "curve": "high", "u": 0, "point": [50, 400, 120] }, { "curve": "high", "u": 1, "point": [900, 400, 100] },
        { "curve": "low", "u": 0.5, "point": [470, -20, 60] } ],
    "moves": [ { "handle": 4, "point": [470, -40, 120], "steps": 4 } ] }"#;

fn run(text: &str) -> Result<Answer, ShapeError> {
    run_with(text, &|name| Err(format!("{name} is not there")))
}

fn run_with(text: &str, load: &dyn Fn(&str) -> Result<Vec<u8>, String>) -> Result<Answer, ShapeError> {
    let job = read(text.as_bytes(), "job", None).expect("a job");
    shape(&job, &Options::new(0.05), load, &Control::default())
}

fn broken(answer: &Answer) -> Vec<String> {
    crate::io::words::objections(&answer.claims, &[])
}

#[test]
fn a_job_is_certified_and_has_its_files() {
    let mut answer = run(JOB).expect("an answer");
    assert_eq!(answer.status(), Certified::Certified, "{:?} {:?}", broken(&answer), answer.notes);
    let p = answer.patchwork.panels[0].strip.ruling(0.5)[0];
    assert!((p - Vec3::new(470.0, -40.0, 120.0)).norm() < 1e-3, "{p}");
    let files = crate::files(&mut answer, "2026-01-31T12:00:00").expect("files");
    assert!(files.iter().any(|(name, bytes)| name == "panels.step" && bytes.len() > 1000));
    assert_eq!(answer.status(), Certified::Certified);
    // The first shape, four steps and the result, as an animation and as pictures.
    assert_eq!(answer.stages.len(), 6);
    let last = answer.stages[5].strips[0].ruling(0.3)[0];
    assert_eq!(last, answer.patchwork.panels[0].strip.ruling(0.3)[0], "the last stage is the result");
    assert!(
        answer.claim(What::CurvesMoved).expect("a figure").value() > 50.0 && answer.claim(What::FromTaken).is_none()
    );
    let glb = &files.iter().find(|f| f.0 == "moves.glb").expect("an animation").1;
    let text = String::from_utf8_lossy(glb);
    assert!(text.contains("\"name\":\"moves\"") && text.contains("\"targets\"") && text.contains("A-01"));
    assert!(files.iter().any(|f| f.0 == "moves.png"));
    // The panels of this result begin the next job.
    let panels = files.iter().find(|f| f.0 == "panels.step").expect("panels").1.clone();
    let next = r#"{ "unit": "mm", "from": [ { "panels": "first/panels.step", "spans": 5 } ],
        "handles": [ { "curve": "A-01/0", "u": 0.5, "point": [470, -40, 130] } ] }"#;
    let load = |name: &str| if name == "first/panels.step" { Ok(panels.clone()) } else { Err("another".into()) };
    let again = run_with(next, &load).expect("an answer");
    assert_eq!(again.status(), Certified::Certified, "{:?} {:?}", broken(&again), again.notes);
    let p = again.patchwork.panels[0].strip.ruling(0.5)[0];
    assert!((p - Vec3::new(470.0, -40.0, 130.0)).norm() < 1e-3, "{p}");
    // How far that is from what was taken over: at least as far as the handle pulled, and proven.
    let apart = again.claim(What::FromTaken).expect("a figure");
    assert!(apart.evidence() == Evidence::Proven && apart.value() > 2.0 && apart.value() < 100.0, "{apart:?}");
    let strip = &answer.patchwork.panels[0].strip;
    let places: Vec<Vec3> = (0..=20).flat_map(|k| strip.ruling(f64::from(k) / 20.0)).collect();
    let seen =
        crate::certify::points::points(&again.strips().cloned().collect::<Vec<_>>(), &places, &Control::default());
    let seen = seen.worst_bound().value();
    assert!(apart.value() >= seen - 1e-6, "{apart:?} {seen}");
    assert!(!again.notes.iter().any(|n| matches!(n, Note::TakenUncertified { .. })));
    // What the file says of a certificate is no part of a name.
    let marked = String::from_utf8(panels.clone()).expect("text").replace("'A-01'", "'A-01 NOT CERTIFIED'");
    let load_marked = |_: &str| Ok(marked.clone().into_bytes());
    let taken = run_with(next, &load_marked).expect("an answer");
    assert_eq!((&taken.patchwork.panels[0].strip.name[..], taken.status()), ("A-01", Certified::Certified));
    assert!(taken.notes.contains(&Note::TakenUncertified { names: vec!["A-01".into()] }), "{:?}", taken.notes);
    let wrong = run_with(&next.replace("\"spans\"", "\"names\": [\"B\"], \"spans\""), &load).expect_err("no B");
    assert_eq!(wrong.to_string(), "$.from[0]: first/panels.step has no panel 'B'; it has A-01");
    assert!(run(next).expect_err("no file").to_string().starts_with("$.from[0]: first/panels.step is not there"));
}

#[test]
fn the_regression_curve_is_proven_to_keep_its_margin() {
    let answer = run(JOB).expect("an answer");
    let of = |what: What| answer.claims.iter().find(|c| c.what() == what && c.subject() == Subject::Panel(0));
    let clearance = of(What::RegressionClearance).expect("a claim");
    let margin = of(What::RegressionMargin).expect("a claim");
    assert!(clearance.evidence() == Evidence::Proven && margin.evidence() == Evidence::Proven);
    // No ruling comes nearer than was proven, and the proof is not far from the nearest.
    let strip = &answer.patchwork.panels[0].strip;
    let (mut least, mut share) = (f64::INFINITY, f64::INFINITY);
    for k in 0..=5000 {
        let [a, b] = strip.ruling(f64::from(k) / 5000.0);
        let c = strip.regression_clearance(f64::from(k) / 5000.0);
        (least, share) = (least.min(c), share.min(c / (b - a).norm()));
    }
    assert!(clearance.value() <= least && clearance.value() >= 0.9 * least, "{clearance:?} {least}");
    assert!(margin.value() <= share && margin.value() >= 0.9 * share.min(10.0), "{margin:?} {share}");
    assert!(margin.value() >= 0.05, "{margin:?}");
    let whole = answer.claim(What::RegressionClearance).expect("a claim");
    assert_eq!(whole.value(), clearance.value());
    // A margin that this shape has not got is no certificate.
    let strips = [strip.clone()];
    let claims = crate::search::strips::regression::claims(&strips, &|_| 2.0 * share);
    let told = crate::io::words::objections(&claims, &[]).join("; ");
    assert!(
        told.contains("strip A-01: the regression curve is shown to keep off by ") && told.contains("margin"),
        "{told}"
    );
}

#[test]
fn strips_are_drawn_to_the_border_of_a_target() {
    // A sheet of 1000 by 400 that bends about the y-axis; the curves begin 30 and 25 short of its borders.
    let at = |x: f64, y: f64| [x, y, 0.0003 * (x - 500.0) * (x - 500.0)];
    let n = 20;
    let points: Vec<[f64; 3]> = (0..=n)
        .flat_map(|i| (0..=4).map(move |j| at(1000.0 * f64::from(i) / f64::from(n), 100.0 * f64::from(j))))
        .collect();
    let cell = |i: u32, j: u32| [[5 * i + j, 5 * i + j + 5, 5 * i + j + 6], [5 * i + j, 5 * i + j + 6, 5 * i + j + 1]];
    let triangles: Vec<[u32; 3]> = (0..n).flat_map(|i| (0..4).flat_map(move |j| cell(i, j))).collect();
    let curve = |name: &str, y: f64| {
        let list: Vec<[f64; 3]> = (0..=8).map(|k| at(30.0 + 940.0 * f64::from(k) / 8.0, y)).collect();
        format!(r#"{{ "name": "{name}", "through": {list:?}, "spans": 4 }}"#)
    };
    let job = |covered: bool| {
        format!(
            r#"{{ "unit": "mm", "curves": [{}, {}, {}],
            "strips": [ {{ "name": "s0", "sides": ["a", "b"] }}, {{ "name": "s1", "sides": ["b", "c"] }} ],
            "targets": [ {{ "points": {points:?}, "triangles": {triangles:?}, "within": 4, "covered": {covered} }} ] }}"#,
            curve("a", 25.0),
            curve("b", 200.0),
            curve("c", 375.0)
        )
    };
    let back = |answer: &Answer| {
        let found = answer.notes.iter().find_map(|n| match n {
            Note::Target { back, .. } => Some(back.value()),
            _ => None,
        });
        found.expect("a note")
    };
    let answer = run(&job(true)).expect("an answer");
    assert_eq!(answer.status(), Certified::Certified, "{:?} {:?}", broken(&answer), answer.notes);
    assert!(back(&answer) < 4.0);
    // Where it need not be covered, nothing draws the strips to its border.
    assert!(back(&run(&job(false)).expect("an answer")) > 20.0);
}

#[test]
fn a_loft_is_where_one_begins() {
    let low = b"x,y,z\n0,0,0\n300,-60,40\n600,-80,50\n1000,0,0\n".to_vec();
    let high = b"x,y,z\n20,300,200\n320,260,230\n620,250,230\n980,300,190\n".to_vec();
    let load = |name: &str| match name {
        "low.csv" => Ok(low.clone()),
        "high.csv" => Ok(high.clone()),
        _ => Err("another".into()),
    };
    let job = r#"{ "unit": "mm", "from": [ { "loft": ["low.csv", "high.csv"], "spans": 8 } ] }"#;
    let answer = run_with(job, &load).expect("an answer");
    assert!(answer.patchwork.panels.iter().all(|p| p.strip.name.starts_with("L1-")));
    // Rulings do not reach both rails all along them: that is told as the loft tells it.
    let told = broken(&answer);
    assert!(told.len() == 1 && told[0].starts_with("certified in part: 71."), "{told:?} {:?}", answer.notes);
    let wrong = run_with(&job.replace("high.csv", "none.csv"), &load).expect_err("no file");
    assert_eq!(wrong.to_string(), "$.from[0]: another");
}

#[test]
fn what_a_loft_leaves_out_of_its_rails_is_told_and_is_no_certificate() {
    // A cylinder; the second rail goes on where the first one ends.
    let rail = |to: u32, y: f64| {
        let place = |k: u32| {
            let (s, c) = (0.01 * f64::from(k)).sin_cos();
            format!("{},{y},{}\n", 500.0 * s, 500.0 * c)
        };
        (0..=to).map(place).collect::<String>()
    };
    let load = |name: &str| {
        Ok(format!("x,y,z\n{}", if name == "a.csv" { rail(60, 0.0) } else { rail(100, 200.0) }).into_bytes())
    };
    let job = r#"{ "unit": "mm", "from": [ { "loft": ["a.csv", "b.csv"] } ] }"#;
    let answer = run_with(job, &load).expect("an answer");
    let told = broken(&answer);
    assert_eq!(answer.status(), Certified::Uncertified, "{told:?}");
    assert!(told.iter().any(|t| t.starts_with("certified in part: ") && t.contains("b.csv")), "{told:?}");
}

#[test]
fn a_curve_that_runs_against_its_direction_is_not_certified() {
    let handle = |x: f64| {
        let held = format!(r#"{{ "curve": "low", "u": 1, "tangent": [{x}, 0.1, 0] }} ],"#);
        JOB.replace(r#"{ "curve": "low", "u": 0.5, "point": [470, -20, 60] } ],"#, &held)
            .replace(r#""moves": [ { "handle": 4, "point": [470, -40, 120], "steps": 4 } ]"#, r#""moves": []"#)
    };
    let along = run(&handle(1.0)).expect("an answer");
    assert_eq!(along.status(), Certified::Certified, "{:?} {:?}", broken(&along), along.notes);
    let against = run(&handle(-1.0).replace("0.1, 0]", "-0.1, 0]")).expect("an answer");
    let told = broken(&against);
    assert!(told.iter().any(|t| t.contains("the curve runs the other way there")), "{told:?}");
    // Nobody knows which way round it should turn.
    let moves = r#""moves": [ { "handle": 4, "tangent": [-10, -1, 0] } ]"#;
    let told = run(&handle(1.0).replace(r#""moves": []"#, moves)).expect_err("no way").to_string();
    assert!(told.starts_with("$.moves[0]: the tangent is to turn to the opposite direction"), "{told}");
}

/// Three ruled arms about a planar triangle.
fn arms(more: &str) -> String {
    let mut curves = Vec::new();
    let (mut strips, mut joins, mut handles) = (Vec::new(), Vec::new(), Vec::new());
    let corner = |i: usize| {
        let a = std::f64::consts::TAU * i as f64 / 3.0;
        Vec3::new(300.0 * a.cos(), 300.0 * a.sin(), 30.0 * (i as f64 - 1.0))
    };
    for i in 0..3 {
        let out = (corner(i) + corner((i + 1) % 3)).normalize();
        for (k, side) in ["a", "b"].iter().enumerate() {
            let end = corner((i + k) % 3);
            let far = end + out * 700.0 + Vec3::new(0.0, 0.0, 270.0 - 180.0 * k as f64);
            let middle = (end + far) * 0.5 + Vec3::z() * 60.0;
            let list: Vec<[f64; 3]> = vec![far.into(), middle.into(), end.into()];
            curves.push(format!(r#"{{ "name": "s{i}{side}", "through": {list:?}, "spans": 4 }}"#));
            let first: [f64; 3] = far.into();
            handles.push(format!(r#"{{ "curve": "s{i}{side}", "u": 0, "point": {first:?} }}"#));
        }
        strips.push(format!(r#"{{ "name": "s{i}", "sides": ["s{i}a", "s{i}b"], "ruled": true }}"#));
        joins.push(format!(
            r#"{{ "ends": [ {{ "curve": "s{i}b", "u": 1 }}, {{ "curve": "s{}a", "u": 1 }} ], "smoothness": "G0" }}"#,
            (i + 1) % 3
        ));
    }
    let corners: Vec<String> = (0..3).map(|i| format!(r#"{{ "curve": "s{i}a", "u": 1 }}"#)).collect();
    format!(
        r#"{{ "unit": "mm", "curves": [{}], "strips": [{}], "joins": [{}], "handles": [{}],
        "facets": [ {{ "name": "middle", "corners": [{}] }} ]{more} }}"#,
        curves.join(", "),
        strips.join(", "),
        joins.join(", "),
        handles.join(", "),
        corners.join(", ")
    )
}

#[test]
fn ruled_strips_about_a_planar_piece_are_certified_with_their_joins() {
    let mut answer = run(&arms("")).expect("an answer");
    assert_eq!(answer.status(), Certified::Certified, "{:?} {:?}", broken(&answer), answer.notes);
    let angles: Vec<_> = answer.claims.iter().filter(|c| matches!(c.what(), What::JoinAngle(_))).collect();
    assert_eq!(angles.len(), 3, "one along every side of the triangle");
    assert!(angles.iter().all(|c| c.value() < 1e-4 && c.evidence() == Evidence::Proven));
    // The triangle is laid flat, the ruled strips are not.
    assert_eq!((answer.patterns.len(), answer.parts.len(), answer.patchwork.panels.len()), (1, 4, 4));
    let files = crate::files(&mut answer, "2026-01-31T12:00:00").expect("files");
    assert_eq!(answer.status(), Certified::Certified, "{:?}", broken(&answer));
    assert!(files.iter().any(|f| f.0 == "report.html") && !files.iter().any(|f| f.0 == "moves.glb"));
    // Corners of a planar piece must be ends.
    let wrong =
        arms("").replace(r#""corners": [{ "curve": "s0a", "u": 1 }"#, r#""corners": [{ "curve": "s0a", "u": 0.5 }"#);
    let m = run(&wrong).expect_err("no end").to_string();
    assert!(m.starts_with("$.facets[0].corners: "), "{m}");
}

#[test]
fn ruled_strips_keep_to_a_target_both_ways() {
    // z = x y / 400 as triangles, and two strips above it whose rulings can be those of the saddle.
    let n = 40;
    let at = |i: usize, j: usize| {
        let (x, y) = (200.0 * i as f64 / n as f64, 120.0 * j as f64 / n as f64);
        [x, y, x * y / 400.0]
    };
    let points: Vec<[f64; 3]> = (0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))).collect();
    let corner = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let cell = |i: usize, j: usize| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles: Vec<[u32; 3]> = (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j))).collect();
    let curve = |k: usize| {
        let y = 60.0 * k as f64;
        let place = |x: f64| [x, y, x * y / 400.0 + 0.4 + 0.2 * (0.05 * x).sin()];
        let list: Vec<[f64; 3]> = [0.0, 50.0, 100.0, 150.0, 200.0].map(place).to_vec();
        format!(r#"{{ "name": "c{k}", "through": {list:?}, "spans": 4 }}"#)
    };
    let job = |within: f64| {
        format!(
            r#"{{ "unit": "mm", "curves": [{}, {}, {}],
            "strips": [ {{ "name": "s0", "sides": ["c0", "c1"], "ruled": true }},
                        {{ "name": "s1", "sides": ["c1", "c2"], "ruled": true }} ],
            "targets": [ {{ "points": {points:?}, "triangles": {triangles:?}, "within": {within} }} ] }}"#,
            curve(0),
            curve(1),
            curve(2)
        )
    };
    let answer = run(&job(0.6)).expect("an answer");
    let distance = answer.claim(What::TargetDistance(0)).expect("a claim");
    assert_eq!(answer.status(), Certified::Certified, "{distance:?} {:?} {:?}", broken(&answer), answer.notes);
    assert!(answer.patterns.is_empty() && !answer.lays_flat());
    // What is out of reach is named, with the place and with what would help.
    let answer = run(&job(1e-4)).expect("an answer");
    let told = broken(&answer).join("; ");
    assert!(
        answer.status() == Certified::Uncertified && told.contains("target 0: ") && told.contains("spans"),
        "{told}"
    );
}

#[test]
fn a_handle_that_pulls_may_give_way() {
    let pulled =
        JOB.replace("\"u\": 0.5, \"point\": [470, -20, 60]", "\"u\": 0.5, \"point\": [470, -20, 600], \"pull\": 0.05");
    let pulled =
        pulled.replace(r#""moves": [ { "handle": 4, "point": [470, -40, 120], "steps": 4 } ]"#, r#""moves": []"#);
    let answer = run(&pulled).expect("an answer");
    assert_eq!(answer.status(), Certified::Certified, "{:?} {:?}", broken(&answer), answer.notes);
    assert!(answer.notes.iter().any(|n| matches!(n, Note::GaveWay { off, .. } if *off > 1.0)), "{:?}", answer.notes);
}

#[test]
fn a_move_that_goes_too_far_keeps_the_last_good_shape() {
    let far = JOB.replace("[470, -40, 120], \"steps\": 4", "[470, -40, 90000], \"steps\": 3");
    let answer = run(&far).expect("an answer");
    assert_eq!(answer.status(), Certified::Uncertified);
    let told = broken(&answer).join("; ");
    assert!(told.contains("move 0 was made to step") && told.contains("more steps"), "{told}");
    // The shape that is kept is a good one.
    let twist = answer.claims_of(Subject::Whole).find(|c| c.what() == What::Twist).expect("a claim");
    assert!(twist.value() < 6e-4 && twist.evidence() == Evidence::Proven, "{twist:?}");
}

#[test]
fn what_is_wrong_is_named_by_its_path() {
    let told = |from: &str, to: &str| run(&JOB.replace(from, to)).expect_err(to).to_string();
    let m = told("\"curve\": \"low\", \"u\": 0.5", "\"curve\": \"middle\", \"u\": 0.5");
    assert!(m.starts_with("$.handles[4].curve: handle 4 ") && m.contains("'middle'"), "{m}");
    assert!(told("\"u\": 0.5", "\"u\": 5").starts_with("$.handles[4].u: "));
    assert!(told("[\"low\", \"high\"]", "[\"low\", \"low\"]").starts_with("$.strips[0].sides: "));
    let m = told("\"moves\"", "\"targets\": [ { \"file\": \"scan.ply\" } ], \"moves\"");
    assert_eq!(m, "$.targets[0]: scan.ply is not there");
    let m = told("\"handle\": 4, \"point\"", "\"handle\": 4, \"tangent\"");
    assert_eq!(m, "$.moves[0]: there is no handle 4 that holds a tangent");
}

#[test]
fn lengths_that_cannot_be_are_named() {
    let apart = r#""lengths": [
        { "between": [{ "curve": "low", "u": 0 }, { "curve": "high", "u": 0 }], "length": 10 } ], "moves""#;
    let wrong = run(&JOB.replace("\"moves\"", apart)).expect_err("two held places").to_string();
    assert!(
        wrong.starts_with("$.lengths[0].length: length 0 asks for 10 mm between two places that are held 420.59"),
        "{wrong}"
    );
    // Two short ways between places that are held far apart.
    let two = r#""lengths": [
        { "between": [{ "curve": "low", "u": 0 }, { "curve": "low", "u": 0.25 }], "length": 100 },
        { "between": [{ "curve": "low", "u": 0.25 }, { "curve": "low", "u": 0.5 }], "length": 100 } ], "moves""#;
    let answer = run(&JOB.replace("\"moves\"", two)).expect("an answer");
    let told = broken(&answer).join("; ");
    assert!(answer.status() == Certified::Uncertified && told.contains("length "), "{told}");
}

#[test]
fn what_cannot_be_held_is_not_certified() {
    // Four corners that are in no plane.
    let answer = run(&JOB.replace("[\"low\", \"high\"]", "[\"low\", \"high\"], \"planar\": true")).expect("an answer");
    assert_eq!(answer.status(), Certified::Uncertified);
    let stalled = |n: &&Note| match n {
        Note::Solved { report: SolveReport { status: Status::Stalled, obstacle: Some((class, _)), .. }, .. } => {
            class == "point handles"
        }
        _ => false,
    };
    let told = answer.notes.iter().filter(stalled).count();
    assert_eq!(told, 2, "the first shape and the move, each once: {:?}", answer.notes);
}

/// Two strips beside a curve that is a crease; `fold` says that they unfold to one sheet.
fn creased(far: [f64; 3], fold: bool) -> String {
    let join = if fold { r#""joins": [ { "curve": "crease", "edge": "fold" } ],"# } else { "" };
    let [y, z, rise] = far;
    format!(
        r#"{{ "unit": "mm",
        "curves": [
            {{ "name": "a", "through": [[0, -300, -120], [500, -330, -60], [1000, -300, -120]], "spans": 6 }},
            {{ "name": "crease", "through": [[0, 0, 0], [500, -60, 60], [1000, 0, 0]], "spans": 6 }},
            {{ "name": "b", "through": [[0, {y}, {z}], [500, {y}, {}], [1000, {y}, {z}]], "spans": 6 }} ],
        "strips": [ {{ "name": "left", "sides": ["a", "crease"] }}, {{ "name": "right", "sides": ["crease", "b"] }} ],
        {join}
        "handles": [ {{ "curve": "a", "u": 0, "point": [0, -300, -120] }}, {{ "curve": "a", "u": 1, "point": [1000, -300, -120] }} ] }}"#,
        z + rise
    )
}

#[test]
fn strips_along_a_fold_are_proven_to_unfold_to_one_sheet() {
    let far = [300.0, -120.0, 30.0];
    let answer = run(&creased(far, true)).expect("an answer");
    assert_eq!(answer.status(), Certified::Certified, "{:?} {:?}", broken(&answer), answer.notes);
    let apart = answer.claim(What::FoldGap(0)).expect("a claim");
    assert!(apart.evidence() == Evidence::Proven && apart.value() < 0.05, "{apart:?}");
    // It is folded, each strip has its own flat part, and the edges of these along the fold have one length.
    let angle = answer.claim(What::JoinAngle(0)).expect("a claim").value();
    assert!(angle > 5.0 && angle < 175.0, "{angle}");
    assert_eq!((answer.patterns.len(), answer.parts.len()), (2, 2));
    // The same strips without a fold need not fit together in the plane, and nobody asks.
    let free = run(&creased(far, false)).expect("an answer");
    assert!(free.claim(What::FoldGap(0)).is_none());
    let strips: Vec<&crate::torse::strip::Strip> = free.patchwork.panels.iter().map(|p| &p.strip).collect();
    let apart = crate::certify::flat::fold::fold_apart((strips[0], 1), (strips[1], 0), 0.05);
    assert!(apart.value() > 1.0, "{apart:?}");
}

#[test]
fn a_fold_that_cannot_be_is_named() {
    // A roof: both slopes fall from a ridge that is held where it rises, so that the sheet would have to stretch there.
    let ridge = creased([300.0, -127.0, 80.0], true).replace("[500, -60, 60]", "[500, 0, 80]");
    let roof = ridge.replace("[500, -330, -60]", "[500, -300, -47]").replace("-120]", "-127]");
    let held = roof.replace(
        r#""handles": ["#,
        r#""handles": [ { "curve": "crease", "u": 0, "point": [0, 0, 0] }, { "curve": "crease", "u": 1, "point": [1000, 0, 0] },
            { "curve": "crease", "u": 0.5, "point": [500, 0, 80] }, { "curve": "b", "u": 0, "point": [0, 300, -127] },
            { "curve": "b", "u": 1, "point": [1000, 300, -127] }, "#,
    );
    let answer = run(&held).expect("an answer");
    let told = broken(&answer).join("; ");
    assert!(answer.status() == Certified::Uncertified && told.contains("unfold to one sheet"), "{told}");
}

/// Strips that go on smoothly are one flat part, in whatever order the job names them.
#[test]
fn a_chain_is_one_part_in_any_order_of_its_strips() {
    let arch = [[0.0, 0.0], [50.0, 20.0], [100.0, 30.0], [150.0, 30.0], [200.0, 22.0], [250.0, 8.0], [300.0, -12.0]];
    let curve = |k: usize, side: usize| {
        let at: Vec<String> =
            arch[2 * k..=2 * k + 2].iter().map(|p| format!("[{}, {}, {}]", p[0], 100 * side, p[1])).collect();
        format!(r#"{{ "name": "{k}-{side}", "through": [{}], "spans": 3 }}"#, at.join(", "))
    };
    let curves: Vec<String> = (0..3).flat_map(|k| [curve(k, 0), curve(k, 1)]).collect();
    let strip = |k: usize| format!(r#"{{ "name": "s{k}", "sides": ["{k}-0", "{k}-1"] }}"#);
    let made = |order: [usize; 3]| {
        let job = format!(
            r#"{{ "unit": "mm", "curves": [{}], "strips": [{}],
                "joins": [ {{ "ruling": ["s0", "s1"] }}, {{ "ruling": ["s1", "s2"] }} ],
                "handles": [ {{ "curve": "0-0", "u": 0, "point": [0, 0, 0] }} ] }}"#,
            curves.join(", "),
            order.map(strip).join(", ")
        );
        run(&job).expect("an answer")
    };
    for order in [[0, 1, 2], [0, 2, 1], [2, 0, 1]] {
        let answer = made(order);
        assert_eq!(answer.status(), Certified::Certified, "{order:?} {:?}", broken(&answer));
        assert_eq!((answer.patterns.len(), answer.parts.len()), (1, 1), "{order:?}");
        let names: Vec<&str> = answer.strips().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["s0", "s1", "s2"], "{order:?}");
    }
}
