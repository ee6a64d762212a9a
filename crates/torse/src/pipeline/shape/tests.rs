//! Jobs that are met, and what is wrong with others.

use super::*;
use crate::answer::note::SolveReport;
use crate::io::shape::read;
use crate::Status as Certified;

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
    let job = read(text.as_bytes(), "job", None).expect("a job");
    shape(&job, &Options::new(0.05), &|name| Err(format!("{name} is not there")), &Control::default())
}

#[test]
fn a_job_is_certified_and_has_its_files() {
    let mut answer = run(JOB).expect("an answer");
    let reasons: Vec<_> = answer.claims.iter().filter(|c| c.is_broken()).map(|c| c.reason().to_string()).collect();
    assert_eq!(answer.status(), Certified::Certified, "{reasons:?} {:?}", answer.notes);
    let p = answer.patchwork.panels[0].strip.ruling(0.5)[0];
    assert!((p - Vec3::new(470.0, -40.0, 120.0)).norm() < 1e-3, "{p}");
    let files = crate::files(&mut answer, "2026-01-31T12:00:00").expect("files");
    assert!(files.iter().any(|(name, bytes)| name == "panels.step" && bytes.len() > 1000));
    assert_eq!(answer.status(), Certified::Certified);
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
