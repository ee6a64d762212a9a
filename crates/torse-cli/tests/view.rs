//! `--view` and `--bend-step`: what the files say about the side that is seen and about bend lines.

use std::path::Path;
use std::process::Command;

/// Files of the hopper's patterns, and the first line of the table of its bend lines.
fn patterns(arguments: &[&str]) -> (String, Vec<String>) {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("out");
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cone_holes.step");
    let run = Command::new(env!("CARGO_BIN_EXE_torse"))
        .arg("approximate")
        .arg(model)
        .args(["--tolerance", "0.5mm", "--quiet", "--out"])
        .arg(&out)
        .args(arguments)
        .output()
        .expect("torse runs");
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect("a file");
    assert!(read("report.json").contains(if arguments.is_empty() { "\"outside\"" } else { "\"inside\"" }));
    (read("patterns.dxf"), read("bends.csv").lines().map(String::from).collect())
}

#[test]
fn a_hopper_bends_down_seen_from_outside_and_up_from_inside() {
    let lines = |dxf: &str, layer: &str| dxf.lines().filter(|l| l.trim() == layer).count();
    let (dxf, table) = patterns(&[]);
    assert!(lines(&dxf, "BEND_DOWN") > 40 && lines(&dxf, "BEND_UP") <= 1);
    assert!(table.len() > 40 && table[1..].iter().all(|l| l.contains(",outside,") && l.contains(",down,")));
    let (dxf, table) = patterns(&["--view", "inside", "--bend-step", "10deg"]);
    assert!(lines(&dxf, "BEND_UP") > 18 && lines(&dxf, "BEND_DOWN") <= 1);
    assert!(table[1..].iter().all(|l| l.contains(",inside,") && l.contains(",up,")));
}
